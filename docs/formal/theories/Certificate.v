(** The certificates of the kinds trivial, full and witness, as conditions on matrices.

    Source: docs/theory/fullness.md, section 7. The theorems that each of them proves its verdict are in
    FullSound.v and WitnessSound.v, over the given field and over every real field that extends it. *)
From mathcomp Require Import all_ssreflect all_algebra.
From Liehom Require Import Sound Pair.
Set Implicit Arguments. Unset Strict Implicit. Unset Printing Implicit Defensive.
Import Order.TTheory GRing.Theory Num.Theory. Local Open Scope ring_scope.

Section Full.
Variables (F : realFieldType) (d : nat).

Definition positive_definite (P : 'M[F]_d) := forall x : 'rV[F]_d, x != 0 -> 0 < (x *m P *m x^T) 0 0.

(** P = U D U^T with U invertible and D diagonal with positive entries: what elimination with positive pivots shows. *)
Definition positive_factors (P : 'M[F]_d) (U : 'M[F]_d) (D : 'rV[F]_d) :=
  [/\ U \in unitmx, forall i, 0 < D 0 i & P = U *m diag_mx D *m U^T].

(** K preserves the form P up to the factor a: P(Kx, y) + P(x, Ky) = a P(x, y). *)
Definition conformal (P K : 'M[F]_d) := exists a, K *m P + P *m K^T = a *: P.

(** Kind full, on V: K_j lie in the span of the rho_i and preserve P up to factors; x and the x K_j span V. *)
Definition full_matrices k (rho : 'I_k -> 'M[F]_d) s (P : 'M[F]_d) (K : 'I_s -> 'M[F]_d) (x : 'rV[F]_d) :=
  [/\ P^T = P, positive_definite P, forall j, exists u : 'I_k -> F, K j = \sum_i u i *: rho i,
      forall j, conformal P (K j) & row_full (span_at K x)].
End Full.

(** Kind full, for a pair: the form on V, the elements (rows of z) and eta, as in the certificate. *)
Definition full_certificate (F : realFieldType) n k d (c : 'I_n -> 'M[F]_n) (h : 'M[F]_(k, n)) (Q : 'M[F]_(n, d))
    (E : 'M[F]_(d, n)) s (P : 'M[F]_d) (z : 'M[F]_(s, n)) (eta : 'rV[F]_n) :=
  [/\ P^T = P, positive_definite P, (z <= h)%MS, forall j, conformal P (isotropy c Q E (row j z))
    & row_full (span_at (fun j => isotropy c Q E (row j z)) (eta *m Q))].

(** Kind witness, over the field of its coordinates. *)
Definition witness_certificate (F : fieldType) n k (c : 'I_n -> 'M[F]_n) (h : 'M[F]_(k, n)) (eta : 'rV[F]_n)
    (phi : 'cV[F]_n) :=
  [/\ ~~ (eta <= h)%MS, phi != 0, h *m phi = 0, eta *m phi = 0 & forall p, bracket c (row p h) eta *m phi = 0].

(** The same pair over a larger field. *)
Definition map_pair (F R : fieldType) (f : {rmorphism F -> R}) n (c : 'I_n -> 'M[F]_n) : 'I_n -> 'M[R]_n :=
  fun i => map_mx f (c i).

(** A morphism of ordered fields. *)
Definition increasing (F R : realFieldType) (f : F -> R) := forall x, 0 < x -> 0 < f x.
