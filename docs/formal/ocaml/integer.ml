(* The integers of the extracted checker: those of zarith. Trusted; Extraction.v maps Coq's Z to this file.
   The matches on positive and Z occur in code that the checker does not reach, but they are right. *)

type t = Z.t

let zero = Z.zero
let one = Z.one
let neg = Z.neg
let add = Z.add
let mul = Z.mul
let equal = Z.equal
let leq = Z.leq
let lt = Z.lt

(* positive: 2p + 1, 2p, 1 *)
let twice_plus_one p = Z.succ (Z.shift_left p 1)
let twice p = Z.shift_left p 1

let match_positive odd even unit p =
  if Z.equal p Z.one then unit ()
  else if Z.testbit p 0 then odd (Z.shift_right p 1)
  else even (Z.shift_right p 1)

(* Z: 0, a positive number, minus a positive number *)
let positive p = p

let match_integer zero positive negative z =
  if Z.sign z = 0 then zero () else if Z.sign z > 0 then positive z else negative (Z.neg z)
