(** The theorem about the checker for the real numbers of Coq's standard library. Their construction assumes axioms, and
    the instance of a real closed field is that of MathComp Analysis; check.sh compiles this file if it is installed. *)
From Coq Require Import Reals.
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.analysis Require Import Rstruct.
From Liehom Require Import CheckerPair CheckerWitness Checker.

Theorem check_sound_reals (o : oracle) (p : pair_data) (t : coordinates_hint) (c : certificate) :
  check o p t c ->
  pair_is_valid [rcfType of R] p /\ if claims_full c then pair_is_full [rcfType of R] p else ~ pair_is_full [rcfType of R] p.
Proof. exact: check_sound. Qed.

Print Assumptions check_sound_reals.
