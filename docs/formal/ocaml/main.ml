(* liehom-check PAIR.json CERTIFICATE.json, or liehom-check --lines: JSON lines with the keys pair and certificate. *)

type outcome =
  | Accepted of string
  | Rejected of string
  | Malformed of string
  | Unsupported of string

let require holds what = if not holds then raise (Propose.Impossible what)

(* The certificates to check, of which the first gives the verdict. *)
let rec proposed pair (t : Checker.coordinates_hint) certificate =
  match certificate with
  | Certificates.Trivial -> [Checker.TrivialCertificate]
  | Certificates.Full f -> [Checker.FullCertificate (f, Propose.full_hint pair t f)]
  | Certificates.Witness (w, also) ->
    Checker.WitnessCertificate w :: (match also with None -> [] | Some c -> proposed pair t c)
  | Certificates.Commutant { matrix; complement; cut } ->
    let right = Halfplane.(count (characteristic (Array.of_list (List.map Array.of_list matrix))) cut) in
    require (0 < right && right < t.codimension) "the eigenvalues are on one side of the cut";
    [Checker.CommutantCertificate (Propose.commutant t matrix complement)]
  | Certificates.Dominance { element; cut; eps } ->
    let isotropies = Checker.isotropies t (Checker.adjoint pair t) in
    [Checker.WitnessCertificate (Dominance.witness pair t isotropies element cut eps)]

let run pair_json certificate_json =
  try
    let pair = Reader.pair pair_json in
    let coordinates = Propose.coordinates pair in
    let given = Certificates.certificate pair.Checker.dimension coordinates.Checker.codimension certificate_json in
    let all = proposed pair coordinates given in
    if List.for_all (Checker.check Propose.oracle pair coordinates) all then
      Accepted (if Checker.claims_full (List.hd all) then "full" else "not full")
    else Rejected "a check fails"
  with
  | Reader.Malformed s -> Malformed s
  | Reader.Unsupported s -> Unsupported s
  | Propose.Impossible s -> Rejected s
  | Halfplane.Symmetric -> Rejected "two eigenvalues are symmetric about the cut"

let sentence = function
  | Accepted s -> "accepted: " ^ s
  | Rejected s -> "rejected: " ^ s
  | Malformed s -> "malformed: " ^ s
  | Unsupported s -> "unsupported: " ^ s

let code = function Accepted _ -> 0 | Rejected _ | Malformed _ -> 1 | Unsupported _ -> 3

let read parse = try Ok (parse ()) with Yojson.Json_error s -> Error (Malformed s)

let lines () =
  try
    while true do
      let line = input_line stdin in
      let outcome =
        match read (fun () -> Yojson.Safe.from_string line) with
        | Ok (`Assoc members) -> run (List.assoc "pair" members) (List.assoc "certificate" members)
        | Ok _ -> Malformed "a line is not an object"
        | Error e -> e
      in
      print_endline (sentence outcome)
    done
  with End_of_file -> ()

let () =
  match Array.to_list Sys.argv with
  | [_; "--lines"] -> lines ()
  | [_; pair; certificate] ->
    let file name = read (fun () -> Yojson.Safe.from_file name) in
    let outcome =
      match file pair, file certificate with Ok p, Ok c -> run p c | Error e, _ | _, Error e -> e
    in
    print_endline (sentence outcome);
    exit (code outcome)
  | _ ->
    prerr_endline "usage: liehom-check PAIR.json CERTIFICATE.json | liehom-check --lines";
    exit 2
