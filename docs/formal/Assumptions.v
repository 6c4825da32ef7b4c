(** The main theorems, each with what it assumes; check.sh expects "Closed under the global context" for all. *)
From Liehom Require Import Pair Checker.

Print Assumptions full_pairP.
Print Assumptions check_sound.
