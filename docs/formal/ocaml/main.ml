(* liehom-check PAIR.json CERTIFICATE.json, or liehom-check --lines: JSON lines with the keys pair and certificate. *)

type outcome =
  | Accepted of string
  | Rejected of string
  | Malformed of string
  | Unsupported of string

let run pair_json certificate_json =
  try
    let pair = Reader.pair pair_json in
    let given = Certificates.certificate pair.Checker.dimension certificate_json in
    let coordinates = Propose.coordinates pair in
    let certificate, note =
      match given with
      | Certificates.Trivial -> (Checker.TrivialCertificate, "")
      | Certificates.Full f -> (Checker.FullCertificate (f, Propose.full_hint pair coordinates f), "")
      | Certificates.Witness (w, also) ->
        (Checker.WitnessCertificate w, if also = None then "" else ", not checked: also")
      | Certificates.Other kind -> Reader.unsupported "the kind %s" kind
    in
    if Checker.check Propose.oracle pair coordinates certificate then
      Accepted ((if Checker.claims_full certificate then "full" else "not full") ^ note)
    else Rejected "a check fails"
  with
  | Reader.Malformed s -> Malformed s
  | Reader.Unsupported s -> Unsupported s
  | Propose.Impossible s -> Rejected s
  | Stack_overflow -> Unsupported "too large"

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
