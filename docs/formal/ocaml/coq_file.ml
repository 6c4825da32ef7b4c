(* A Coq file with a pair, a certificate and the proposals, in which Coq's kernel itself computes the check. *)

module Big = Z
open Checker
module Z = Big

let number z =
  if Z.sign z = 0 then "Z0"
  else Printf.sprintf "(%s %s)" (if Z.sign z > 0 then "Zpos" else "Zneg") (Z.to_string (Z.abs z))

let items f l = "[:: " ^ String.concat "; " (List.map f l) ^ "]"
let items f l = if l = [] then "[::]" else items f l
let both f g (a, b) = Printf.sprintf "(%s, %s)" (f a) (g b)
let index = string_of_int
let polynomial = items number
let vector = items (both index number)
let matrix = items vector
let fraction = both number number
let call name arguments = Printf.sprintf "(%s %s)" name (String.concat "\n    " arguments)

let pair p =
  let constant (((i, j), k), x) = Printf.sprintf "(%d, %d, %d, %s)" i j k (fraction x) in
  call "PairData" [index p.dimension; items constant p.constants; items (items fraction) p.rows]

let coordinates t =
  call "Coordinates"
    [index t.codimension; number t.scale; polynomial t.integers; items (both number polynomial) t.subalgebra;
     matrix t.basis; matrix t.change; number t.factor; matrix t.quotient; matrix t.section; matrix t.dual;
     number t.denominator]

let factors f =
  call "Factors"
    [matrix f.upper; matrix f.upper_inverse; number f.upper_factor; polynomial f.pivots; number f.pivots_factor]

let count c =
  call "CountHint"
    [matrix c.frame; matrix c.frame_inverse; number c.frame_factor; polynomial c.signature; factors c.positivity]

let certificate = function
  | TrivialCertificate -> "TrivialCertificate"
  | FullCertificate (f, h) ->
    call "FullCertificate"
      [call "FullData" [matrix f.form; matrix f.elements; vector f.point];
       call "FullHint"
         [factors h.definite; matrix h.left_inverse; number h.rank_factor]]
  | WitnessCertificate w ->
    call "WitnessCertificate"
      [call "Witness" [polynomial w.minpoly; fraction w.low; fraction w.high; matrix w.eta; matrix w.phi]]
  | CommutantCertificate c ->
    let (s, x), y = c.relation in
    call "CommutantCertificate"
      [call "Commutant"
         [matrix c.operator; items (both index index) c.positions;
          Printf.sprintf "(%s, %s, %s)" (number s) (number x) (number y)]]

  | DominanceCertificate w ->
    call "DominanceCertificate"
      [call "Dominance"
         [vector w.element; number w.shift; number w.cut; number w.eps; items index w.family;
          matrix w.family_coordinates; number w.family_factor; matrix w.bracket_matrix; index w.top_count;
          index w.high_count; count w.at_cut; count w.below_cut; count w.on_image]]

(* The answers of an oracle that a check asks for, as lists of questions and answers. *)
let recorded oracle check =
  let quotients = ref [] and combinations = ref [] in
  let record table answer f g =
    let found = answer f g in
    if not (List.mem_assoc (f, g) !table) then table := ((f, g), found) :: !table;
    found
  in
  let asked = { divide = record quotients oracle.divide; bezout = record combinations oracle.bezout } in
  let accepted = check asked in
  let question = both polynomial polynomial in
  ( accepted,
    call "answers"
      [items (both question (both number polynomial)) !quotients;
       items (both question (fun ((u, v), c) -> Printf.sprintf "(%s, %s, %s)" (polynomial u) (polynomial v) (number c)))
         !combinations] )

(* The file, or None if the check fails. *)
let file oracle p t c =
  let accepted, answers = recorded oracle (fun o -> check o p t c) in
  if not accepted then None
  else
    let claim = "pair_is_valid R pair /\\ " ^ if claims_full c then "pair_is_full R pair" else "~ pair_is_full R pair" in
    Some
      (Printf.sprintf
         "From Coq Require Import ZArith.\nFrom mathcomp Require Import all_ssreflect ssrnum.\n\
          From Liehom Require Import CheckerPair CheckerWitness CheckerFull CheckerCommutant CheckerDominance Checker.\n\
          \nDefinition pair : pair_data := %s.\n\nDefinition coordinates : coordinates_hint := %s.\n\n\
          Definition proof : certificate := %s.\n\nDefinition proposals : oracle := %s.\n\n\
          Lemma accepted : check proposals pair coordinates proof = true.\nProof. vm_compute. reflexivity. Qed.\n\n\
          Theorem verdict (R : rcfType) : %s.\nProof. exact (check_sound R accepted). Qed.\n\n\
          Print Assumptions verdict.\n"
         (pair p) (coordinates t) (certificate c) answers claim)
