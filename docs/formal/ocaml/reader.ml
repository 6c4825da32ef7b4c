(* Pairs from the JSON that liehom writes. Trusted: it determines the pair that a verdict is about. *)

module Big = Z (* zarith's; Checker has a module Z of its own, of Coq's functions *)
open Checker
module Z = Big

exception Malformed of string
exception Unsupported of string

let malformed format = Printf.ksprintf (fun s -> raise (Malformed s)) format
let unsupported format = Printf.ksprintf (fun s -> raise (Unsupported s)) format

let keys what (json : Yojson.Safe.t) =
  match json with
  | `Assoc members ->
    let names = List.map fst members in
    if List.length (List.sort_uniq compare names) < List.length names then malformed "%s: a key is given twice" what;
    members
  | _ -> malformed "%s is not a JSON object" what

let list what (json : Yojson.Safe.t) = match json with `List items -> items | _ -> malformed "%s is not a list" what

let member what name members =
  match List.assoc_opt name members with Some value -> value | None -> malformed "%s: no key %s" what name

(* An index or a dimension. *)
let index what (json : Yojson.Safe.t) = match json with `Int i when i >= 0 -> i | _ -> malformed "%s is not a natural number" what

let is_integer s =
  let start = if s <> "" && s.[0] = '-' then 1 else 0 in
  let digits = String.sub s start (String.length s - start) in
  digits <> "" && String.for_all (fun c -> '0' <= c && c <= '9') digits

(* An integer, or a string "a" or "a/b" with b > 0. *)
let fraction (json : Yojson.Safe.t) : fraction =
  let integer s = if is_integer s then Z.of_string s else unsupported "the number %s" s in
  match json with
  | `Int i -> (Z.of_int i, Z.one)
  | `Intlit s -> (integer s, Z.one)
  | `String s ->
    (match String.split_on_char '/' s with
     | [a] -> (integer a, Z.one)
     | [a; b] ->
       let a, b = integer a, integer b in
       if Z.sign b <= 0 then malformed "the denominator of %s" s else (a, b)
     | _ -> unsupported "the number %s" s)
  | _ -> malformed "a number is neither an integer nor a string"

let constant (json : Yojson.Safe.t) =
  match json with
  | `List [i; j; k; x] -> (((index "i" i, index "j" j), index "k" k), fraction x)
  | _ -> malformed "a structure constant is not [i, j, k, value]"

let largest_dimension = 10000

let pair json : pair_data =
  let what = "the pair" in
  let members = keys what json in
  List.iter
    (fun (name, value) ->
      match name, value with
      | ("dimension" | "structure_constants" | "subalgebra" | "basis" | "checksum"), _ -> ()
      | "format", `String "liehom-pair" | "version", `Int 1 -> ()
      | ("field" | "arithmetic" | "tolerance"), _ -> unsupported "a pair that is not over the rationals"
      | _ -> malformed "%s: unexpected key or value of %s" what name)
    members;
  let dimension = index "dimension" (member what "dimension" members) in
  if dimension > largest_dimension then unsupported "a dimension above %d" largest_dimension;
  let constants = List.map constant (list "structure_constants" (member what "structure_constants" members)) in
  let places = List.map fst constants in
  if List.length (List.sort_uniq compare places) < List.length places then
    malformed "a structure constant is given twice";
  let rows =
    List.map (fun row -> List.map fraction (list "a row of h" row)) (list "subalgebra" (member what "subalgebra" members))
  in
  { dimension; constants; rows }
