(** Fullness of a family of matrices, and what is linear algebra alone in the certificates that a pair is not full.

    Source: docs/theory/fullness.md, sections 1 and 3 (soundness of witness, commutant, dominance).

    V = F^d is the space of row vectors, and a matrix acts from the right: x *m rho i is rho(z_i) x. [full rho] says
    that rho(h) x + F x = V for every x != 0. *)
From mathcomp Require Import all_ssreflect all_algebra.
Set Implicit Arguments. Unset Strict Implicit. Unset Printing Implicit Defensive.
Import GRing.Theory. Local Open Scope ring_scope.

Section Sound.
Variables (F : fieldType) (d k : nat) (rho : 'I_k -> 'M[F]_d).
Definition span_at (x : 'rV[F]_d) : 'M[F]_d := (x + \sum_i <<x *m rho i>>)%MS.
Definition full := forall x : 'rV[F]_d, x != 0 -> row_full (span_at x).

(** The space rho(h) x + F x, with coefficients. *)
Lemma span_atP (x v : 'rV[F]_d) :
  reflect (exists s t, v = x *m (\sum_i s i *: rho i) + t *: x) (v <= span_at x)%MS.
Proof.
apply: (iffP idP) => [|[s [t ->]]]; last first.
  apply: addmx_sub; last by apply: scalemx_sub; apply: addsmxSl.
  rewrite mulmx_sumr; apply: summx_sub => p _; rewrite -scalemxAr; apply: scalemx_sub.
  by apply: submx_trans (addsmxSr _ _); apply: (sumsmx_sup p) => //; rewrite genmxE.
case/sub_addsmxP => [[a b]] /= eqa.
have := submxMl b (\sum_i <<x *m rho i>>)%MS; case/sub_sumsmxP => w eqw.
have coef i : exists s, w i *m <<x *m rho i>>%MS = s *: (x *m rho i).
  apply/sub_rVP; apply: submx_trans (submxMl _ _) _; by rewrite genmxE.
have [s es] := fin_all_exists coef; exists s, (a 0 0).
rewrite eqa eqw addrC [in RHS]mulmx_sumr; congr (_ + _).
  by apply: eq_bigr => i _; rewrite es scalemxAr.
by rewrite [in LHS](mx11_scalar a) mul_scalar_mx.
Qed.

(** rho(h) x + F x is the least subspace that contains its generators. *)
Lemma span_sub (x : 'rV[F]_d) m (U : 'M[F]_(m, d)) :
  (x <= U)%MS -> (forall i, (x *m rho i <= U)%MS) -> (span_at x <= U)%MS.
Proof.
move=> xU rU; rewrite addsmx_sub xU /=; apply/sumsmx_subP=> i _.
by rewrite genmxE.
Qed.

(** Kind witness: x and rho(h) x lie in the kernel of a covector phi != 0. *)
Lemma witness_sound (x : 'rV[F]_d) (phi : 'cV[F]_d) :
  x != 0 -> phi != 0 -> x *m phi = 0 -> (forall i, x *m rho i *m phi = 0) -> ~ full.
Proof.
move=> x0 p0 xp rp /(_ _ x0) fx.
have s : (span_at x <= kermx phi)%MS.
  apply: span_sub; first by apply/sub_kermxP.
  by move=> i; apply/sub_kermxP.
have : (1%:M <= kermx phi)%MS by apply: submx_trans s; rewrite sub1mx.
by move/sub_kermxP; rewrite mul1mx => pz; rewrite pz eqxx in p0.
Qed.

(** A subspace that is not 0 contains a vector that is not 0. *)
Lemma nonzero_row m (W : 'M[F]_(m, d)) : W != 0 -> exists2 x : 'rV[F]_d, (x <= W)%MS & x != 0.
Proof.
move/eqP=> W0; case: (pickP (fun i => row i W != 0)) => [i Wi|h].
  by exists (row i W) => //; apply: row_sub.
by case: W0; apply/row_matrixP=> i; rewrite row0; apply/eqP; move/negbFE: (h i).
Qed.

(** Kind commutant, once its subspace is given: a proper invariant subspace W. *)
Lemma invariant_sound m (W : 'M[F]_(m, d)) :
  W != 0 -> (\rank W < d)%N -> (forall i, (W *m rho i <= W)%MS) -> ~ full.
Proof.
move=> W0 Wd inv f.
have [x xW x0] := nonzero_row W0.
have : (span_at x <= W)%MS.
  apply: span_sub => // i; apply: submx_trans (inv i); exact: submxMr.
move/mxrankS; have := f x x0; rewrite /row_full => /eqP -> h.
by move: Wd; rewrite ltnNge h.
Qed.

(** Kind dominance, its linear algebra: W is invariant under all rho i except those in C, and dim W + #C < d. Then every
    x in W is a witness. *)
Lemma dominance_at m (W : 'M[F]_(m, d)) (C : {set 'I_k}) (x : 'rV[F]_d) :
  (x <= W)%MS -> (forall i, i \notin C -> (W *m rho i <= W)%MS) -> (\rank W + #|C| < d)%N -> ~~ row_full (span_at x).
Proof.
move=> xW inv lt; set U := (W + \sum_(i in C) <<x *m rho i>>)%MS.
have sU : (span_at x <= U)%MS.
  apply: span_sub; first exact: submx_trans xW (addsmxSl _ _).
  move=> i; case iC: (i \in C).
    apply: submx_trans (addsmxSr _ _); apply: submx_trans (sumsmx_sup i _ (submx_refl _)) => //.
    by rewrite genmxE.
  apply: submx_trans (addsmxSl _ _); apply: submx_trans (inv i _); last by rewrite iC.
  exact: submxMr.
have rU : (\rank U <= \rank W + #|C|)%N.
  apply: leq_trans (mxrank_adds_leqif _ _) _; rewrite leq_add2l.
  rewrite -sum1_card; apply: (big_ind2 (fun (A : 'M[F]_d) n => (\rank A <= n)%N)).
  - by rewrite mxrank0.
  - move=> A a B b Aa Bb; apply: leq_trans (mxrank_adds_leqif _ _) _; exact: leq_add.
  - by move=> i _; rewrite genmxE; apply: rank_leq_row.
apply/negP; rewrite /row_full => /eqP r; have := mxrankS sU; rewrite r => dU.
by move: (leq_trans dU rU); rewrite leqNgt lt.
Qed.

Lemma dominance_sound m (W : 'M[F]_(m, d)) (C : {set 'I_k}) :
  W != 0 -> (forall i, i \notin C -> (W *m rho i <= W)%MS) -> (\rank W + #|C| < d)%N -> ~ full.
Proof.
move=> W0 inv lt f; have [x xW x0] := nonzero_row W0.
by case/negP: (dominance_at xW inv lt); apply: f.
Qed.
End Sound.
