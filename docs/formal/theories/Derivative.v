(** Derivatives of determinants, and where a solution of p' q = p n can vanish.

    Source: docs/theory/fullness.md, section 2; used by FullSound.v for polynomials along a line. *)
From mathcomp Require Import all_ssreflect all_algebra.
Set Implicit Arguments. Unset Strict Implicit. Unset Printing Implicit Defensive.
Import GRing.Theory. Local Open Scope ring_scope.

Section Derivative.
Variable F : comRingType.

(** The entrywise derivative of a matrix of polynomials. *)
Definition dmx m n (M : 'M[{poly F}]_(m, n)) : 'M[{poly F}]_(m, n) := map_mx (@deriv F) M.

Lemma dmxD m n (M N : 'M[{poly F}]_(m, n)) : dmx (M + N) = dmx M + dmx N.
Proof. by apply/matrixP => i j; rewrite !mxE derivD. Qed.

Lemma dmxM m n p (M : 'M[{poly F}]_(m, n)) (N : 'M[{poly F}]_(n, p)) :
  dmx (M *m N) = dmx M *m N + M *m dmx N.
Proof.
apply/matrixP => i j; rewrite !mxE (raddf_sum (@deriv_additive F)) -big_split /=; apply: eq_bigr => l _.
by rewrite derivM !mxE.
Qed.

Lemma dmxT m n (M : 'M[{poly F}]_(m, n)) : dmx M^T = (dmx M)^T.
Proof. by apply/matrixP => i j; rewrite !mxE. Qed.

Lemma dmxC m n (M : 'M[F]_(m, n)) : dmx (map_mx polyC M) = 0.
Proof. by apply/matrixP => i j; rewrite !mxE derivC. Qed.

(** Leibniz' rule: replace one factor after the other by its derivative. *)
Lemma deriv_prod n (f : 'I_n -> {poly F}) :
  (\prod_i f i)^`() = \sum_j \prod_i (if i == j then (f i)^`() else f i).
Proof.
elim: n f => [|n IH] f; first by rewrite !big_ord0 derivC.
rewrite big_ord_recl derivM IH big_ord_recl big_ord_recl eqxx; congr (_ * _ + _).
rewrite big_distrr /=; apply: eq_bigr => j _; rewrite big_ord_recl eq_sym.
by congr (_ * _); apply: eq_bigr => i _; rewrite (inj_eq (@lift_inj _ _)).
Qed.

(** Jacobi's formula. *)
Lemma deriv_det n (M : 'M[{poly F}]_n) : (\det M)^`() = \tr (\adj M *m dmx M).
Proof.
pose Mj j := \matrix_(i, k) (if i == j then (M i k)^`() else M i k).
have -> : (\det M)^`() = \sum_j \det (Mj j).
  rewrite /determinant (raddf_sum (@deriv_additive F)) [RHS]exchange_big /=; apply: eq_bigr => s _.
  rewrite -mulr_sumr mulr_sign (fun_if (@deriv F)) derivN deriv_prod -mulr_sign.
  by congr (_ * _); apply: eq_bigr => j _; apply: eq_bigr => i _; rewrite mxE.
rewrite /mxtrace; under [RHS]eq_bigr do rewrite mxE.
rewrite [RHS]exchange_big /=; apply: eq_bigr => j _; rewrite (expand_det_row _ j); apply: eq_bigr => k _.
rewrite !mxE eqxx mulrC /cofactor; congr (_ * \det _ * _).
by apply/matrixP => a b; rewrite !mxE eq_sym (negPf (neq_lift _ _)).
Qed.
End Derivative.

(** In characteristic 0 a polynomial p != 0 with p' q = p n does not vanish where q does not: if p = (t - a)^k u with
    u(a) != 0 and k > 0, then k u(a) q(a) = 0. *)
Lemma ode_nonzero (F : fieldType) (p q n : {poly F}) (a : F) :
  [char F] =i pred0 -> p != 0 -> p^`() * q = p * n -> q.[a] != 0 -> p.[a] != 0.
Proof.
move=> char0 p0 ode qa; case: (multiplicity_XsubC p a) => k [u]; rewrite p0 /= => ua defp.
case: k defp => [|k] defp; first by rewrite defp expr0 mulr1; apply: contra ua.
have u_a : u.[a] != 0 by [].
have X0 : ('X - a%:P) ^+ k != 0 by rewrite expf_neq0 // polyXsubC_eq0.
move: ode; rewrite defp derivM deriv_exp derivXsubC mul1r -pred_Sn exprS.
set Y := 'X - a%:P; rewrite -/Y in X0; set Z := Y ^+ k in X0 *.
have -> : (u^`() * (Y * Z) + u * (Z *+ k.+1)) * q = Z * ((u^`() * Y + u *+ k.+1) * q).
  rewrite [RHS]mulrA mulrDr; congr ((_ + _) * q); first by rewrite mulrA mulrC.
  by rewrite !mulrnAr mulrC.
have -> : u * (Y * Z) * n = Z * (u * Y * n) by rewrite mulrA [_ * Z]mulrC -!mulrA.
move=> /(mulfI X0) E.
have : u.[a] *+ k.+1 * q.[a] == 0.
  move: (congr1 (horner^~ a) E); rewrite /= !hornerM hornerD hornerMn hornerM /Y hornerXsubC.
  by rewrite subrr !mulr0 add0r mul0r => ->.
by rewrite -mulr_natl !mulf_eq0 (negPf u_a) (negPf qa) !orbF; move/charf0P: char0 => ->.
Qed.
