(* Proposals for a certificate of kind dominance: forms that count eigenvalues. Untrusted. *)

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

(* The checks of the certificate, see halfplane.ml. *)
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
  require (top + lowering < d) "too many directions leave the top space"

exception No_form

(* A solution H of S H + H S^T = 1 in floats, rounded to integers after scaling; S is divided by its size. *)
let lyapunov (s : Q.t array array) =
  let d = Array.length s in
  let size = Array.fold_left (Array.fold_left (fun m x -> Q.max m (Q.abs x))) Q.one s in
  let a = Array.map (Array.map (fun x -> Q.to_float (Q.div x size))) s in
  let place i j = let i, j = max i j, min i j in (i * (i + 1) / 2) + j in
  let count = d * (d + 1) / 2 in
  let rows = Array.init count (fun _ -> Array.make (count + 1) 0.) in
  for i = 0 to d - 1 do
    for j = 0 to i do
      let row = rows.(place i j) in
      for k = 0 to d - 1 do
        row.(place k j) <- row.(place k j) +. a.(i).(k);
        row.(place i k) <- row.(place i k) +. a.(j).(k)
      done;
      if i = j then row.(count) <- 1.
    done
  done;
  for column = 0 to count - 1 do
    let best = ref column in
    for i = column + 1 to count - 1 do
      if abs_float rows.(i).(column) > abs_float rows.(!best).(column) then best := i
    done;
    let row = rows.(!best) in
    rows.(!best) <- rows.(column);
    rows.(column) <- row;
    for i = column + 1 to count - 1 do
      let factor = rows.(i).(column) /. row.(column) in
      if factor <> 0. then
        for j = column to count do
          rows.(i).(j) <- rows.(i).(j) -. (factor *. row.(j))
        done
    done
  done;
  let h = Array.make count 0. in
  for i = count - 1 downto 0 do
    let total = ref rows.(i).(count) in
    for j = i + 1 to count - 1 do
      total := !total -. (rows.(i).(j) *. h.(j))
    done;
    h.(i) <- !total /. rows.(i).(i)
  done;
  let scale = 1e12 /. Array.fold_left (fun m x -> max m (abs_float x)) 1e-300 h in
  let rounded x =
    let y = Float.round (x *. scale) in
    if Float.is_nan y || Float.is_integer y = false then raise No_form
    else Q.of_float y
  in
  Array.init d (fun i -> Array.init d (fun j -> rounded h.(place i j)))

(* The number of eigenvalues of A with real part above c, and what proves it. *)
let counted a c =
  let d = Array.length a in
  let s = minus a (scaled_by c (identity d)) in
  match triangular_factors (fun sign -> sign <> 0) (lyapunov s) with
  | None -> raise No_form
  | Some found ->
    let f = integral_factors found in
    let frame = of_matrix d f.upper in
    let signs = Array.of_list (List.map Q.of_bigint f.pivots) in
    let h = product (Array.map (Array.mapi (fun j x -> Q.mul signs.(j) x)) frame) (transpose frame) in
    let half = product s h in
    let positive = minus half (scaled_by Q.minus_one (transpose half)) in
    (List.length (List.filter (fun x -> Z.sign x > 0) f.pivots),
     { frame = f.upper; frame_inverse = f.upper_inverse; frame_factor = f.upper_factor; signature = f.pivots;
       positivity = (try definite_factors positive with Impossible _ -> raise No_form) })

(* Coordinates of columns in a basis of columns, which come first. *)
let in_basis basis columns =
  let size = List.length basis in
  let reduced, _, _ = echelon (transpose (Array.of_list (basis @ columns))) (size + List.length columns) in
  transpose (Array.map (fun row -> Array.sub row size (List.length columns)) (Array.sub reduced 0 size))

let certificate (t : coordinates_hint) isotropies given cut eps : dominance =
  let d = t.codimension in
  let isotropy = Array.of_list (List.map (of_matrix d) isotropies) in
  checked t isotropy given cut eps;
  let flat a = Array.concat (Array.to_list a) in
  let all = List.map flat (Array.to_list isotropy) in
  let _, _, family = if all = [] then ([||], [||], []) else echelon (transpose (Array.of_list all)) (List.length all) in
  let basis = List.map (fun j -> isotropy.(j)) family in
  let family_coordinates, family_factor = integral (in_basis (List.map flat basis) all) in
  (* the element z with integral isotropy K; K is a multiple of rho(X) *)
  let row, multiple = integral [| Array.of_list given |] in
  let k = of_matrix d (isotropy_of t isotropies (List.hd row)) in
  let unit = Q.of_bigint (Z.mul multiple (Z.mul t.scale (Z.mul t.denominator t.denominator))) in
  let shift = Q.div (trace k) (Q.of_int d) and cut = Q.mul unit cut and eps = Q.mul unit eps in
  let bracket = in_basis (List.map flat basis) (List.map (fun b -> flat (minus (product b k) (product k b))) basis) in
  let propose cut eps =
    let more = Z.lcm (common_factor bracket) (common_factor [| [| shift; cut; eps |] |]) in
    let times x = Q.mul (Q.of_bigint more) x in
    let shift = times shift and cut = times cut and eps = times eps in
    let a = minus (scaled_by (Q.of_bigint more) k) (scaled_by shift (identity d)) in
    let bracket = scaled_by (Q.of_bigint more) bracket in
    let top_count, at_cut = counted a cut in
    let _, below_cut = counted a (Q.sub cut eps) in
    let high_count, on_image = counted bracket (Q.neg eps) in
    if top_count + Array.length bracket - high_count >= d then raise No_form;
    { element = vscale more (List.hd row); shift = shift.Q.num; cut = cut.Q.num; eps = eps.Q.num; family;
      family_coordinates; family_factor; bracket_matrix = fst (integral bracket); top_count; high_count; at_cut;
      below_cut; on_image }
  in
  (* there may be no form if two eigenvalues are mirror images in a line; then the gap is made smaller *)
  let rec first = function
    | [] -> raise (Reader.Unsupported "a count of eigenvalues")
    | (u, v) :: rest ->
      let part x = if x = 0 then Q.zero else Q.div eps (Q.of_int x) in
      (try propose (Q.sub cut (part u)) (Q.sub eps (Q.add (part u) (part v))) with No_form -> first rest)
  in
  first [(0, 0); (1009, 1013); (101, 103); (11, 13)]
