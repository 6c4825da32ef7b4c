(** The main theorems, each with what it assumes; check.sh expects "Closed under the global context" for all. *)
From Liehom Require Import Pair Sphere FullSound WitnessSound Commutant Dominance Inertia CheckerPair Checker.

Print Assumptions full_pairP.
Print Assumptions jacobi_representation.
Print Assumptions basis_lie_algebra.
Print Assumptions trivial_pair_sound.
Print Assumptions witness_pair_sound.
Print Assumptions witness_sound_ext.
Print Assumptions skew_full.
Print Assumptions full_sound.
Print Assumptions one_point.
Print Assumptions commutant_sound.
Print Assumptions commutant_cut_sound.
Print Assumptions dominance_pair_sound.
Print Assumptions count_right.
Print Assumptions dominance_count_sound.
Print Assumptions check_coordinates_sound.
Print Assumptions check_valid_sound.
Print Assumptions check_sound.
