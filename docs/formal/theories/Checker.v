(** The checker: a pair, a certificate, and what an unproved program proposes for their verification.

    [check_sound] is the theorem about the executable: whatever is proposed, if [check] returns true, then the data are a
    Lie algebra with a basis of a subalgebra, and the pair has the property that the kind of the certificate claims,
    over every real closed field. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra.
From Liehom Require Import Sound Pair Certificate FullSound CheckerAlgebra CheckerPair CheckerWitness CheckerFull CheckerCommutant CheckerDominance.
Set Implicit Arguments. Unset Strict Implicit. Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory. Local Open Scope ring_scope.

(** A certificate of kind full comes with the proposed factors. *)
Inductive certificate :=
  | TrivialCertificate
  | FullCertificate of full_data & full_hint
  | WitnessCertificate of witness
  | CommutantCertificate of commutant
  | DominanceCertificate of dominance.

(** Whether the certificate claims that the pair is full, or else that it is not. *)
Definition claims_full (c : certificate) : bool :=
  match c with
  | TrivialCertificate | FullCertificate _ _ => true
  | WitnessCertificate _ | CommutantCertificate _ | DominanceCertificate _ => false
  end.

Definition check (o : oracle) (p : pair_data) (t : coordinates_hint) (c : certificate) : bool :=
  let ads := adjoint p t in
  let isos := isotropies t ads in
  check_coordinates p t ads isos &&
  match c with
  | TrivialCertificate => Nat.leb (codimension t) 1
  | FullCertificate f i => check_full p t isos f i
  | WitnessCertificate w => check_witness o p t ads w
  | CommutantCertificate w => check_commutant t isos w
  | DominanceCertificate w => check_dominance p t isos w
  end.

Theorem check_sound (o : oracle) (p : pair_data) (t : coordinates_hint) (c : certificate) (R : rcfType) :
  check o p t c -> pair_is_valid R p /\ if claims_full c then pair_is_full R p else ~ pair_is_full R p.
Proof.
move=> ck; split; first by case/andP: ck => cc _; apply: check_valid_sound cc.
move: ck; case: c => [|f i|w|w|w] /andP [cc] /=;
  [| | exact: check_witness_sound | exact: check_commutant_sound | exact: check_dominance_sound].
  move=> /Nat.leb_le/ssrnat.leP d1; have [[cl co _] <-] := check_coordinates_sound R cc.
  by apply/(full_pairP cl co); apply: trivial_sound.
move=> cf; have [valid <-] := check_coordinates_sound R cc.
exact: full_sound_base valid (check_full_certificate R cc cf).
Qed.
