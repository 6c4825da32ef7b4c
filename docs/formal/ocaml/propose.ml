(* What the checker wants proposed: coordinates, factorizations, inverses. Untrusted: the checker verifies all of it. *)

module Big = Z
open Checker
module Z = Big

exception Impossible of string

let impossible s = raise (Impossible s)
let fractions = List.map (fun (a, b) -> Q.make a b)

(* A common positive factor that makes rational numbers integers, and the integers. *)
let cleared (xs : Q.t list) =
  let s = List.fold_left (fun s (x : Q.t) -> Z.lcm s x.den) Z.one xs in
  (s, List.map (fun (x : Q.t) -> Z.divexact (Z.mul s x.num) x.den) xs)

let sparse_row (row : Q.t array) factor : vector =
  let entries = ref [] in
  for j = Array.length row - 1 downto 0 do
    if Q.sign row.(j) <> 0 then
      entries := (j, Z.divexact (Z.mul factor row.(j).Q.num) row.(j).Q.den) :: !entries
  done;
  !entries

let common_factor rows =
  Array.fold_left (Array.fold_left (fun s (x : Q.t) -> Z.lcm s x.den)) Z.one rows

(* A matrix of integers, and the factor that it has been multiplied by. *)
let integral rows =
  let s = common_factor rows in
  (Array.to_list (Array.map (fun row -> sparse_row row s) rows), s)

(* Reduced row echelon form of [rows | identity]: the form, the multipliers, and the pivot columns. *)
let echelon (rows : Q.t array array) columns =
  let m = Array.length rows in
  let a = Array.mapi (fun i row -> Array.append row (Array.init m (fun j -> if i = j then Q.one else Q.zero))) rows in
  let width = columns + m in
  let rank = ref 0 and pivots = ref [] in
  for column = 0 to columns - 1 do
    let chosen = ref (-1) in
    for i = m - 1 downto !rank do
      if Q.sign a.(i).(column) <> 0 then chosen := i
    done;
    if !chosen >= 0 then begin
      let row = a.(!chosen) in
      a.(!chosen) <- a.(!rank);
      a.(!rank) <- row;
      let inverse = Q.inv row.(column) in
      for j = 0 to width - 1 do
        if Q.sign row.(j) <> 0 then row.(j) <- Q.mul inverse row.(j)
      done;
      for i = 0 to m - 1 do
        let factor = a.(i).(column) in
        if i <> !rank && Q.sign factor <> 0 then
          for j = 0 to width - 1 do
            if Q.sign row.(j) <> 0 then a.(i).(j) <- Q.sub a.(i).(j) (Q.mul factor row.(j))
          done
      done;
      pivots := column :: !pivots;
      incr rank
    end
  done;
  let part start length = Array.map (fun row -> Array.sub row start length) (Array.sub a 0 !rank) in
  (part 0 columns, part columns m, List.rev !pivots)

let dense columns (row : Z.t list) = Array.append (Array.of_list (List.map Q.of_bigint row))
    (Array.make (max 0 (columns - List.length row)) Q.zero)

(* Coordinates on g/h: pivots and free indices of the echelon form of h. *)
let coordinates (p : pair_data) : coordinates_hint =
  let n = p.dimension and k = List.length p.rows in
  if List.exists (fun row -> List.length row <> n) p.rows then impossible "a row of h has the wrong length";
  let scale, integers = cleared (fractions (List.map snd p.constants)) in
  let subalgebra = List.map (fun row -> cleared (fractions row)) p.rows in
  let rows = Array.of_list (List.map (fun (_, row) -> dense n row) subalgebra) in
  let reduced, multipliers, pivots = echelon rows n in
  if List.length pivots < k then impossible "the rows of h are linearly dependent";
  let free = List.filter (fun j -> not (List.mem j pivots)) (List.init n Fun.id) in
  let basis, q = integral reduced in
  let change, factor = integral (Array.map (Array.map (fun x -> Q.mul (Q.of_bigint q) x)) multipliers) in
  let quotient = Array.make n [] and dual = Array.make n [] in
  List.iteri (fun r pivot -> dual.(pivot) <- [(r, Z.one)]) pivots;
  List.iteri (fun u j -> quotient.(j) <- [(u, q)]) free;
  List.iteri
    (fun r pivot ->
      let row = Array.of_list (List.map (fun j -> Q.neg reduced.(r).(j)) free) in
      quotient.(pivot) <- sparse_row row q)
    pivots;
  { codimension = List.length free; scale; integers; subalgebra; basis; change; factor;
    quotient = Array.to_list quotient; section = List.map (fun j -> [(j, Z.one)]) free; dual = Array.to_list dual;
    denominator = q }

(* Polynomials over the rationals: arrays of ascending coefficients without leading zeros. *)
module Poly = struct
  let trim a =
    let size = ref (Array.length a) in
    while !size > 0 && Q.sign a.(!size - 1) = 0 do decr size done;
    Array.sub a 0 !size

  let of_list l = trim (Array.of_list (List.map Q.of_bigint l))

  let divide f g =
    let rest = Array.copy f and size = Array.length g in
    let quotient = Array.make (max 0 (Array.length f - size + 1)) Q.zero in
    for top = Array.length f - 1 downto size - 1 do
      let factor = Q.div rest.(top) g.(size - 1) in
      quotient.(top - size + 1) <- factor;
      for j = 0 to size - 1 do
        let at = top - size + 1 + j in
        rest.(at) <- Q.sub rest.(at) (Q.mul factor g.(j))
      done
    done;
    (trim quotient, trim rest)

  let combine f g operation =
    trim (Array.init (max (Array.length f) (Array.length g)) (fun i ->
        let entry a = if i < Array.length a then a.(i) else Q.zero in
        operation (entry f) (entry g)))

  let multiply f g =
    let out = Array.make (max 0 (Array.length f + Array.length g - 1)) Q.zero in
    Array.iteri (fun i a -> Array.iteri (fun j b -> out.(i + j) <- Q.add out.(i + j) (Q.mul a b)) g) f;
    trim out

  (* g and u, v with u f + v p = g, a greatest common divisor. *)
  let rec bezout f p =
    if p = [||] then (f, [| Q.one |], [||])
    else
      let quotient, rest = divide f p in
      let g, u, v = bezout p rest in
      (g, v, combine u (multiply quotient v) Q.sub)
end

let oracle : oracle =
  let divide f p =
    let f = Poly.of_list f and p = Poly.of_list p in
    if f = [||] then (Z.zero, [])
    else
      let quotient, rest = Poly.divide p f in
      if rest <> [||] then (Z.zero, []) else cleared (Array.to_list quotient)
  and bezout f p =
    let f = Poly.of_list f and p = Poly.of_list p in
    let g, u, v = Poly.bezout f p in
    if Array.length g <> 1 then (([], []), Z.zero)
    else
      let s, all = cleared (g.(0) :: Array.to_list u @ Array.to_list v) in
      ignore s;
      let size = Array.length u in
      ((List.filteri (fun i _ -> 0 < i && i <= size) all, List.filteri (fun i _ -> i > size) all), List.hd all)
  in
  { divide; bezout }

let of_sparse columns (row : vector) =
  let out = Array.make columns Q.zero in
  List.iter (fun (j, x) -> out.(j) <- Q.add out.(j) (Q.of_bigint x)) row;
  out

let of_matrix columns (rows : matrix) = Array.of_list (List.map (of_sparse columns) rows)

(* P = L D L^T with L unit lower triangular and D of accepted signs, or None. *)
let triangular_factors accepted (p : Q.t array array) =
  let d = Array.length p in
  let rest = Array.map Array.copy p in
  let lower = Array.init d (fun i -> Array.init d (fun j -> if i = j then Q.one else Q.zero)) in
  try
    for i = 0 to d - 1 do
      if not (accepted (Q.sign rest.(i).(i))) then raise Exit;
      for a = i + 1 to d - 1 do
        let factor = Q.div rest.(a).(i) rest.(i).(i) in
        lower.(a).(i) <- factor;
        if Q.sign factor <> 0 then
          for b = i to d - 1 do
            rest.(a).(b) <- Q.sub rest.(a).(b) (Q.mul factor rest.(i).(b))
          done
      done
    done;
    Some (lower, Array.init d (fun i -> rest.(i).(i)))
  with Exit -> None

(* U, its inverse with a factor, and D with a factor such that factor P = U D U^T, in integers. *)
let integral_factors (lower, diagonal) =
  let d = Array.length diagonal in
  (* columns of L without denominators: L = L' / m, D = D' / m^2 *)
  let factors = Array.init d (fun j -> common_factor [| Array.map (fun row -> row.(j)) lower |]) in
  let upper = Array.map (Array.mapi (fun j x -> Q.mul (Q.of_bigint factors.(j)) x)) lower in
  let diagonal = Array.to_list (Array.mapi (fun j x -> Q.div x (Q.of_bigint (Z.mul factors.(j) factors.(j)))) diagonal) in
  let pivots_factor, pivots = cleared diagonal in
  let _, inverse, _ = echelon upper d in
  let upper_inverse, upper_factor = integral inverse in
  let upper, _ = integral upper in
  { upper; upper_inverse; upper_factor; pivots; pivots_factor }

let definite_factors form =
  match triangular_factors (fun sign -> sign > 0) form with
  | Some found -> integral_factors found
  | None -> impossible "a form is not positive definite"

let full_hint (p : pair_data) (t : coordinates_hint) (f : full_data) : full_hint =
  let d = t.codimension in
  let definite = definite_factors (of_matrix d (metric p t f)) in
  let x = vmul f.point t.quotient in
  let images = List.map (fun k -> vmul x k) (motions t (isotropies t (adjoint p t)) f) in
  let reduced, multipliers, _ = echelon (of_matrix d (x :: images)) d in
  if Array.length reduced < d then impossible "eta and its images do not span";
  let left_inverse, rank_factor = integral multipliers in
  { definite; left_inverse; rank_factor }

let product (a : Q.t array array) (b : Q.t array array) =
  let columns = if b = [||] then 0 else Array.length b.(0) in
  Array.map
    (fun row ->
      let out = Array.make columns Q.zero in
      Array.iteri
        (fun i x -> if Q.sign x <> 0 then Array.iteri (fun j y -> out.(j) <- Q.add out.(j) (Q.mul x y)) b.(i))
        row;
      out)
    a

let transpose a = if a = [||] then a else Array.init (Array.length a.(0)) (fun j -> Array.map (fun row -> row.(j)) a)

(* The operator in the coordinates of V, from its matrix in the basis of complement; positions and the relation. *)
let commutant (t : coordinates_hint) matrix complement : commutant =
  let d = t.codimension in
  let array rows = Array.of_list (List.map Array.of_list rows) in
  if d = 0 then impossible "g/h = 0";
  let basis = product (array complement) (of_matrix d t.quotient) in
  let reduced, inverse, _ = echelon basis d in
  if Array.length reduced < d then impossible "h and complement are not a basis";
  let operator, factor = integral (product (product inverse (transpose (array matrix))) basis) in
  let a = of_matrix d operator in
  ignore factor;
  let square = product a a in
  let one i j = if i = j then Q.one else Q.zero in
  let positions = List.concat (List.init d (fun i -> List.init d (fun j -> (i, j)))) in
  let corner = a.(0).(0) in
  match List.find_opt (fun (i, j) -> not (Q.equal a.(i).(j) (Q.mul corner (one i j)))) positions with
  | None -> impossible "the matrix is a multiple of the identity"
  | Some (k, l) ->
    (* T^2 = x T + y at the positions (0, 0) and (k, l) *)
    let det = Q.sub a.(k).(l) (Q.mul corner (one k l)) in
    let x = Q.div (Q.sub square.(k).(l) (Q.mul square.(0).(0) (one k l))) det in
    let y = Q.sub square.(0).(0) (Q.mul x corner) in
    let holds (i, j) = Q.equal square.(i).(j) (Q.add (Q.mul x a.(i).(j)) (Q.mul y (one i j))) in
    (match List.find_opt (fun p -> not (holds p)) positions with
     | Some p -> { operator; positions = [(0, 0); (k, l); p]; relation = ((Z.zero, Z.zero), Z.zero) }
     | None ->
       let s, numbers = cleared [x; y] in
       { operator; positions = [(0, 0); (k, l)]; relation = ((s, List.nth numbers 0), List.nth numbers 1) })
