(** The checker as an OCaml program, checker.ml.

    Integers of Coq (Z) become integers of zarith, which have any number of digits; integer.ml says how. Indices
    and lengths (nat) become OCaml's int, of 63 bits: they count entries of lists that are in memory, and are only
    compared, added once, and increased by one. Booleans, lists and pairs are those of OCaml. *)
From Coq Require Import ZArith Extraction.
From mathcomp Require Import all_ssreflect.
From Liehom Require Import CheckerAlgebra CheckerPair CheckerWitness CheckerFull CheckerCommutant CheckerDominance Checker.

Extraction Language OCaml.

Extract Inductive bool => "bool" ["true" "false"].
Extract Inductive list => "list" ["[]" "(::)"].
Extract Inductive prod => "( * )" ["(,)"].
Extract Inlined Constant andb => "(&&)".
Extract Inlined Constant orb => "(||)".
Extract Inlined Constant negb => "not".

Extract Inductive nat => "int" ["0" "succ"] "(fun zero next n -> if n = 0 then zero () else next (n - 1))".
Extract Inlined Constant Nat.eqb => "((=) : int -> int -> bool)".
Extract Inlined Constant Nat.leb => "((<=) : int -> int -> bool)".
Extract Inlined Constant Nat.ltb => "((<) : int -> int -> bool)".
Extract Inlined Constant addn => "(+)".

Extract Inductive positive => "Integer.t" ["Integer.twice_plus_one" "Integer.twice" "Integer.one"]
  "Integer.match_positive".
Extract Inductive Z => "Integer.t" ["Integer.zero" "Integer.positive" "Integer.neg"] "Integer.match_integer".
Extract Inlined Constant Z.add => "Integer.add".
Extract Inlined Constant Z.mul => "Integer.mul".
Extract Inlined Constant Z.opp => "Integer.neg".
Extract Inlined Constant Z.eqb => "Integer.equal".
Extract Inlined Constant Z.leb => "Integer.leq".
Extract Inlined Constant Z.ltb => "Integer.lt".

Extraction "checker.ml" check claims_full metric motions.
