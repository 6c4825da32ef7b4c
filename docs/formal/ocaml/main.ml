(* liehom-check PAIR.json CERTIFICATE.json: the outcome of the check.
   liehom-check --coq PAIR.json CERTIFICATE.json: a Coq file that proves it without the translation to OCaml.
   liehom-check --lines: the outcomes for JSON lines with the keys pair and certificate. *)

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
    [Checker.DominanceCertificate (Dominance.certificate t isotropies element cut eps)]

(* The outcome that [finish] finds for the pair, the coordinates and the certificates to check. *)
let run finish pair_json certificate_json =
  try
    let pair = Reader.pair pair_json in
    let coordinates = Propose.coordinates pair in
    let given = Certificates.certificate pair.Checker.dimension coordinates.Checker.codimension certificate_json in
    finish pair coordinates (proposed pair coordinates given)
  with
  | Reader.Malformed s -> Malformed s
  | Reader.Unsupported s -> Unsupported s
  | Propose.Impossible s -> Rejected s
  | Halfplane.Symmetric -> Rejected "two eigenvalues are symmetric about the cut"

let outcome pair coordinates certificates =
  if List.for_all (Checker.check Propose.oracle pair coordinates) certificates then
    Accepted (if Checker.claims_full (List.hd certificates) then "full" else "not full")
  else Rejected "a check fails"

let coq_file pair coordinates certificates =
  match Coq_file.file Propose.oracle pair coordinates (List.hd certificates) with
  | Some text -> print_string text; Accepted ""
  | None -> Rejected "a check fails"

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
        | Ok (`Assoc members) -> run outcome (List.assoc "pair" members) (List.assoc "certificate" members)
        | Ok _ -> Malformed "a line is not an object"
        | Error e -> e
      in
      print_endline (sentence outcome)
    done
  with End_of_file -> ()

let files finish pair certificate =
  let file name = read (fun () -> Yojson.Safe.from_file name) in
  match file pair, file certificate with Ok p, Ok c -> run finish p c | Error e, _ | _, Error e -> e

let main () =
  match Array.to_list Sys.argv with
  | [_; "--lines"] -> lines ()
  | [_; "--coq"; pair; certificate] ->
    let found = files coq_file pair certificate in
    if code found > 0 then prerr_endline (sentence found);
    exit (code found)
  | [_; pair; certificate] ->
    let found = files outcome pair certificate in
    print_endline (sentence found);
    exit (code found)
  | _ ->
    prerr_endline "usage: liehom-check [--coq] PAIR.json CERTIFICATE.json | liehom-check --lines";
    exit 2

let () =
  try main ()
  with Sys_error s ->
    prerr_endline s;
    exit 2
