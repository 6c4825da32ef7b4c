(* Certificates from the JSON that liehom writes, with denominators cleared. A mistake here can make the checker reject
   or accept a certificate that is not the one in the file, but what it accepts proves the verdict all the same. *)

open Reader

type t =
  | Trivial
  | Full of Checker.full_data
  | Witness of Checker.witness * t option
  | Commutant of { matrix : Q.t list list; complement : Q.t list list; cut : Q.t }
  | Dominance of { element : Q.t list; cut : Q.t; eps : Q.t }

let number what (json : Yojson.Safe.t) =
  match json with
  | `String _ -> let a, b = fraction json in Q.make a b
  | _ -> malformed "%s holds something that is not a string" what

let numbers what json = List.map (number what) (list what json)

(* Common factor of all numbers of a list of rows, and the rows of integers. *)
let cleared_rows rows =
  let s = List.fold_left (List.fold_left (fun s (x : Q.t) -> Z.lcm s x.Q.den)) Z.one rows in
  List.map (List.map (fun (x : Q.t) -> Z.divexact (Z.mul s x.Q.num) x.Q.den)) rows

(* Coordinates that are polynomials of at most [size] coefficients, as a polynomial of vectors. *)
let polynomials what n size json =
  let entry : Yojson.Safe.t -> Q.t list = function
    | `List [] -> malformed "%s holds an empty list of coefficients" what
    | `List l -> List.map (number what) l
    | json -> [number what json]
  in
  let coordinates = List.map entry (list what json) in
  if List.length coordinates <> n then raise (Propose.Impossible (what ^ " has the wrong length"));
  if List.exists (fun c -> List.length c > size) coordinates then
    raise (Propose.Impossible (what ^ " has a degree that is not below that of minpoly"));
  let coordinates = cleared_rows coordinates in
  let coefficient s c = match List.nth_opt c s with Some x -> x | None -> Z.zero in
  List.init size (fun s -> Checker.sparse (List.map (coefficient s) coordinates))

(* A matrix, dense or sparse, as rows of numbers; the number of rows is that of the entries if it is not given. *)
let matrix what rows columns (json : Yojson.Safe.t) =
  let wrong () = raise (Propose.Impossible (what ^ " has the wrong size")) in
  match list what json with
  | `List (`Int _ :: _) :: _ as entries ->
    let entry = function
      | `List [i; j; x] -> ((index what i, index what j), number what x)
      | _ -> malformed "%s holds something that is not [i, j, number]" what
    in
    let entries = List.map entry entries in
    let places = List.map fst entries in
    if List.length (List.sort_uniq compare places) < List.length places then malformed "%s gives an entry twice" what;
    let given = List.sort_uniq compare (List.map fst places) in
    let count = match rows with Some r -> r | None -> List.length given in
    if rows = None && List.exists (fun i -> i >= count) given then malformed "%s has a row without entries" what;
    if List.exists (fun (i, j) -> i >= count || j >= columns) places then wrong ();
    let out = Array.make_matrix count columns Q.zero in
    List.iter (fun ((i, j), x) -> out.(i).(j) <- x) entries;
    Array.to_list (Array.map Array.to_list out)
  | dense ->
    let dense = List.map (fun row -> numbers what row) dense in
    (match dense with
     | [] -> ()
     | first :: _ ->
       if List.exists (fun row -> List.length row <> List.length first) dense then
         malformed "the rows of %s have different lengths" what;
       if List.length first <> columns then wrong ());
    (match rows with
     | Some r when dense = [] -> List.init r (fun _ -> List.init columns (fun _ -> Q.zero))
     | Some r when List.length dense <> r -> wrong ()
     | _ -> dense)

let sparse_rows rows = List.map Checker.sparse (cleared_rows rows)

let only_keys what required optional members =
  List.iter
    (fun (name, _) -> if not (List.mem name required || List.mem name optional) then malformed "%s: the key %s" what name)
    members;
  List.iter (fun name -> ignore (member what name members)) required

(* [d] is the codimension of h, and [n] the dimension of g. *)
let rec certificate n d json =
  let what = "the certificate" in
  let members = keys what json in
  (match member what "format" members, member what "version" members with
   | `String "liehom-certificate", `Int 1 -> ()
   | _ -> malformed "%s: another format or version" what);
  if List.mem_assoc "field" members then unsupported "a certificate that is not over the rationals";
  let fields = List.filter (fun (name, _) -> not (List.mem name ["format"; "version"; "kind"])) members in
  match member what "kind" members with
  | `String "trivial" ->
    only_keys what [] [] fields;
    Trivial
  | `String "witness" ->
    only_keys what ["minpoly"; "interval"; "eta"; "phi"] ["also"] fields;
    let get name = member what name fields in
    let minpoly = List.hd (cleared_rows [numbers "minpoly" (get "minpoly")]) in
    let degree = List.length minpoly - 1 in
    if degree < 1 || Z.sign (List.nth minpoly degree) = 0 then malformed "minpoly has no leading coefficient";
    let low, high =
      match numbers "interval" (get "interval") with
      | [a; b] -> ((a.Q.num, a.Q.den), (b.Q.num, b.Q.den))
      | _ -> malformed "interval does not have two ends"
    in
    let eta = polynomials "eta" n degree (get "eta") and phi = polynomials "phi" n degree (get "phi") in
    let also = Option.map (certificate n d) (List.assoc_opt "also" fields) in
    (match also with
     | None | Some (Commutant _ | Dominance _) -> ()
     | Some _ -> malformed "also is neither of kind commutant nor dominance");
    Witness ({ minpoly; low; high; eta; phi }, also)
  | `String "full" ->
    only_keys what ["form"; "elements"; "eta"] [] fields;
    let get name = member what name fields in
    let form = sparse_rows (matrix "form" (Some n) n (get "form")) in
    let elements = sparse_rows (matrix "elements" None n (get "elements")) in
    let eta = numbers "eta" (get "eta") in
    if List.length eta <> n then raise (Propose.Impossible "eta has the wrong length");
    Full { form; elements; point = List.hd (sparse_rows [eta]) }
  | `String "commutant" ->
    only_keys what ["matrix"; "complement"; "cut"] [] fields;
    let get name = member what name fields in
    let matrix_ = matrix "matrix" (Some d) d (get "matrix") in
    let complement = matrix "complement" (Some d) n (get "complement") in
    Commutant { matrix = matrix_; complement; cut = number "cut" (get "cut") }
  | `String "dominance" ->
    only_keys what ["element"; "cut"; "eps"] [] fields;
    let get name = member what name fields in
    let element = numbers "element" (get "element") in
    if List.length element <> n then raise (Propose.Impossible "element has the wrong length");
    Dominance { element; cut = number "cut" (get "cut"); eps = number "eps" (get "eps") }
  | _ -> malformed "%s: an unknown kind" what
