(* Numbers of eigenvalues in a half plane, by Routh-Hurwitz. Untrusted: the program rejects a certificate whose cut is
   wrong, as its proof in the file would not hold, but the proof that the checker verifies does not need the numbers. *)

open Propose

exception Symmetric

(* Coefficients of det(t - A), ascending (Faddeev-LeVerrier). *)
let characteristic (a : Q.t array array) =
  let d = Array.length a in
  let coefficients = Array.make (d + 1) Q.one in
  let m = ref (Array.make_matrix d d Q.zero) in
  for k = 1 to d do
    let shift = coefficients.(d - k + 1) in
    let next = Array.mapi (fun i row -> Array.mapi (fun j x -> if i = j then Q.add x shift else x) row) !m in
    m := product a next;
    let trace = ref Q.zero in
    Array.iteri (fun i row -> trace := Q.add !trace row.(i)) !m;
    coefficients.(d - k) <- Q.neg (Q.div !trace (Q.of_int k))
  done;
  coefficients

let shifted f by =
  let out = Array.copy f in
  let size = Array.length out in
  for start = 0 to size - 2 do
    for i = size - 2 downto start do
      out.(i) <- Q.add out.(i) (Q.mul by out.(i + 1))
    done
  done;
  out

let variations signs =
  let rec count = function a :: (b :: _ as rest) -> (if a <> b then 1 else 0) + count rest | _ -> 0 in
  count (List.filter (( <> ) 0) signs)

(* Number of roots with positive real part; no two roots may be mirror images in the imaginary axis. *)
let simple_count f =
  let n = Array.length f - 1 in
  let part signs = Poly.trim (Array.mapi (fun k c -> Q.mul c (Q.of_int signs.(k mod 4))) f) in
  let real = part [| 1; 0; -1; 0 |] and imaginary = part [| 0; 1; 0; -1 |] in
  let first, second = if n mod 2 = 0 then (real, imaginary) else (imaginary, real) in
  let rec chain a b = if b = [||] then [a] else a :: chain b (Array.map Q.neg (snd (Poly.divide a b))) in
  let all = if second = [||] then [first] else chain first second in
  if Array.length (List.nth all (List.length all - 1)) > 1 then raise Symmetric;
  let lead p = Q.sign p.(Array.length p - 1) in
  let left p = if (Array.length p - 1) mod 2 = 0 then lead p else - lead p in
  let index = variations (List.map left all) - variations (List.map lead all) in
  let left_minus_right = if n mod 2 = 1 then index else - index in
  (n - left_minus_right) / 2

let derivative f = Poly.trim (Array.init (max 0 (Array.length f - 1)) (fun i -> Q.mul (Q.of_int (i + 1)) f.(i + 1)))

let gcd f g = let d, _, _ = Poly.bezout f g in d

(* Squarefree parts with their multiplicities (Yun). *)
let squarefree_parts f =
  let common = gcd f (derivative f) in
  let quotient a b = fst (Poly.divide a b) in
  let rec parts rest slope multiplicity =
    if Array.length rest <= 1 then []
    else
      let other = Poly.combine slope (derivative rest) Q.sub in
      let part = gcd rest other in
      (if Array.length part > 1 then [(part, multiplicity)] else [])
      @ parts (quotient rest part) (quotient other part) (multiplicity + 1)
  in
  parts (quotient f common) (quotient (derivative f) common) 1

(* Number of roots with real part above the cut, with multiplicity. *)
let count f cut =
  if Array.length f < 2 then 0
  else
    try simple_count (shifted f cut)
    with Symmetric ->
      List.fold_left (fun total (part, m) -> total + (m * simple_count (shifted part cut))) 0 (squarefree_parts f)
