(* From a certificate of kind dominance to a witness: every vector of the top space of the element is one. An eigenvector
   for a real eigenvalue above the cut is taken, over the field Q(theta) that the eigenvalue generates. Untrusted: the
   checker verifies the witness. The counts of the certificate are compared as well, see halfplane.ml. *)

module Big = Z
open Checker
module Z = Big
open Propose

let identity d = Array.init d (fun i -> Array.init d (fun j -> if i = j then Q.one else Q.zero))
let scaled_by c = Array.map (Array.map (Q.mul c))
let minus = Array.map2 (Array.map2 Q.sub)

let trace a =
  let total = ref Q.zero in
  Array.iteri (fun i row -> total := Q.add !total row.(i)) a;
  !total

(* The matrix of ad rho(X) on the space spanned by the isotropy matrices. *)
let adjoint_on_image d isotropy rho =
  let flat = Array.map (fun a -> Array.concat (Array.to_list a)) isotropy in
  let basis, _, places = echelon flat (d * d) in
  Array.map
    (fun row ->
      let b = Array.init d (fun i -> Array.sub row (i * d) d) in
      let bracket = Array.concat (Array.to_list (minus (product b rho) (product rho b))) in
      Array.of_list (List.map (fun place -> bracket.(place)) places))
    basis

(* The element as a matrix on V, after the checks of the certificate. *)
let checked (t : coordinates_hint) isotropy element cut eps =
  let d = t.codimension in
  let require holds what = if not holds then impossible what in
  let zero = Array.for_all (fun x -> Q.sign x = 0) in
  let row = [| Array.of_list element |] in
  require (Q.sign eps > 0) "eps is not positive";
  require (zero (product row (of_matrix d t.quotient)).(0)) "the element is not in h";
  require (d > 0) "g/h = 0 has no eigenvalues";
  let k = Array.length isotropy in
  let coordinates = (product row (of_matrix k t.dual)).(0) in
  let rho = ref (Array.make_matrix d d Q.zero) in
  let q = Q.of_bigint t.denominator in
  let unit = Q.inv (Q.mul q (Q.mul q (Q.of_bigint t.scale))) in
  Array.iteri (fun r c -> rho := minus !rho (scaled_by (Q.neg (Q.mul unit c)) isotropy.(r))) coordinates;
  let rho = !rho in
  let traceless = minus rho (scaled_by (Q.div (trace rho) (Q.of_int d)) (identity d)) in
  let spectrum = Halfplane.characteristic traceless in
  let top = Halfplane.count spectrum cut in
  require (top > 0) "no eigenvalue is above the cut";
  require (Halfplane.count spectrum (Q.sub cut eps) = top) "an eigenvalue is between cut - eps and cut";
  let adjoint = adjoint_on_image d isotropy rho in
  let lowering = Array.length adjoint - Halfplane.(count (characteristic adjoint) (Q.neg eps)) in
  require (top + lowering < d) "too many directions leave the top space";
  (traceless, spectrum)

let value f x = Array.fold_right (fun c total -> Q.add c (Q.mul x total)) f Q.zero

(* Number of distinct real roots in (low, high), ends that are no roots (Sturm). *)
let real_roots f =
  let rec chain a b = if b = [||] then [a] else a :: chain b (Array.map Q.neg (snd (Poly.divide a b))) in
  let all = chain f (Halfplane.derivative f) in
  let changes x = Halfplane.variations (List.map (fun p -> Q.sign (value p x)) all) in
  fun low high -> changes low - changes high

(* An interval of at most this width with the largest real root of a squarefree f, if that is above the cut. *)
let largest_root f cut width =
  let count = real_roots f in
  let lead = f.(Array.length f - 1) in
  let bound = Array.fold_left (fun b c -> Q.max b (Q.abs (Q.div c lead))) Q.one f in
  let rec narrow low high =
    if count low high = 1 && Q.leq (Q.sub high low) width then Some (low, high)
    else
      let rec middle a b = (* a number between a and b that is not a root *)
        let m = Q.div (Q.add a b) (Q.of_int 2) in
        if Q.sign (value f m) = 0 then middle a m else m
      in
      let m = middle low high in
      if count m high > 0 then narrow m high else narrow low m
  in
  let high = Q.add bound (Q.of_int 2) in
  if Q.lt high cut || count cut high = 0 then None else narrow cut high

(* Arithmetic modulo f; a zero divisor splits f. *)
exception Split of Q.t array

type modulus = { f : Q.t array }

let reduce m a = snd (Poly.divide a m.f)
let times m a b = reduce m (Poly.multiply a b)
let inverse m a =
  let g, _, v = Poly.bezout m.f a in
  if Array.length g > 1 then raise (Split g);
  reduce m (Array.map (fun c -> Q.div c g.(0)) v)

(* A nonzero vector v with (row) v = 0 for all rows, over Q[t]/f. *)
let null_vector m rows columns =
  let rows = Array.map Array.copy rows in
  let count = Array.length rows in
  let pivots = ref [] and rank = ref 0 in
  for column = 0 to columns - 1 do
    let chosen = ref (-1) in
    for i = count - 1 downto !rank do
      if rows.(i).(column) <> [||] then chosen := i
    done;
    if !chosen >= 0 then begin
      let row = rows.(!chosen) in
      rows.(!chosen) <- rows.(!rank);
      let factor = inverse m row.(column) in
      let row = Array.map (times m factor) row in
      rows.(!rank) <- row;
      for i = 0 to count - 1 do
        let c = rows.(i).(column) in
        if i <> !rank && c <> [||] then
          rows.(i) <- Array.map2 (fun x y -> Poly.combine x (times m c y) Q.sub) rows.(i) row
      done;
      pivots := column :: !pivots;
      incr rank
    end
  done;
  let pivots = List.rev !pivots in
  match List.find_opt (fun j -> not (List.mem j pivots)) (List.init columns Fun.id) with
  | None -> None
  | Some free ->
    let out = Array.make columns [||] in
    out.(free) <- [| Q.one |];
    List.iteri (fun r pivot -> out.(pivot) <- Array.map Q.neg rows.(r).(free)) pivots;
    Some out

let constant x = if Q.sign x = 0 then [||] else [| x |]

(* Row vector of polynomials times a matrix of numbers. *)
let through row a =
  Array.init (Array.length a.(0)) (fun j ->
      let total = ref [||] in
      Array.iteri (fun i x -> total := Poly.combine !total (Array.map (Q.mul a.(i).(j)) x) Q.add) row;
      Poly.trim !total)

(* Coefficient vectors of integers of a vector of polynomials. *)
let coefficients size row : vector list =
  let s = common_factor row in
  List.init size (fun k ->
      sparse_row (Array.map (fun p -> if k < Array.length p then p.(k) else Q.zero) row) s)

let witness (p : pair_data) (t : coordinates_hint) isotropies element cut eps : witness =
  let d = t.codimension in
  let isotropy = Array.of_list (List.map (of_matrix d) isotropies) in
  let traceless, spectrum = checked t isotropy element cut eps in
  let squarefree = fst (Poly.divide spectrum (Halfplane.gcd spectrum (Halfplane.derivative spectrum))) in
  let s = Q.of_bigint (common_factor traceless) in
  let low, high =
    match largest_root squarefree cut (Q.inv (Q.mul (Q.of_int 2) s)) with
    | Some ends -> ends
    | None -> raise (Reader.Unsupported "a dominance certificate without a real eigenvalue above the cut")
  in
  let rec attempt f =
    let m = { f } in
    let theta = reduce m [| Q.zero; Q.one |] in
    try
      let shifted =
        Array.mapi
          (fun i row -> Array.mapi (fun j x -> Poly.combine (constant x) (if i = j then theta else [||]) Q.sub) row)
          (transpose traceless)
      in
      let x = match null_vector m shifted d with Some x -> x | None -> impossible "no eigenvector" in
      let moved = Array.map (fun a -> Array.map (reduce m) (through x a)) isotropy in
      let psi =
        match null_vector m (Array.append [| x |] moved) d with
        | Some psi -> psi
        | None -> impossible "the rank is full at the eigenvector"
      in
      let size = Array.length f - 1 in
      let ends (e : Q.t) : fraction = (e.Q.num, e.Q.den) in
      { minpoly = snd (cleared (Array.to_list f)); low = ends low; high = ends high;
        eta = coefficients size (through x (of_matrix p.dimension t.section));
        phi = coefficients size (through psi (transpose (of_matrix d t.quotient))) }
    with Split g ->
      let other = fst (Poly.divide f g) in
      attempt (if Q.sign (value g low) * Q.sign (value g high) < 0 then g else other)
  in
  (* an eigenvalue that is rational has the denominator s at most *)
  let candidate = Q.div (Q.of_bigint (Z.fdiv (Q.mul s high).Q.num (Q.mul s high).Q.den)) s in
  let rational = Q.gt candidate low && Q.sign (value squarefree candidate) = 0 in
  attempt (if rational then [| Q.neg candidate; Q.one |] else squarefree)
