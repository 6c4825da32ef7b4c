(** Skew matrices that are transitive on one sphere at one point are so at every point.

    Source: docs/theory/fullness.md, section 2. No topology is used: the proof holds over every ordered field.

    Let P be positive definite on V = F^d, and A_1, ..., A_r a basis of a Lie algebra m of P-skew matrices. Let G be the
    inverse of the Gram matrix -tr(A_a A_b), which is positive definite. For a vector y let B(y) be the matrix with the
    rows y A_a, and

      phi(y) = B(y)^T G B(y) + y^T y.

    (1) m y + F y = V if and only if det phi(y) != 0 [span_phi].
    (2) The derivative of phi along y X, X in m, is X^T phi + phi X [dphi_along]: G is m-invariant.
    (3) On the line y = x + t (y1 - x), p(t) = det phi(y) and q(t) = P(y, y) are polynomials. Expand p y' in the y A_a
        and y. Jacobi's formula, tr A_a = 0 and P(y A_a, y) = 0 give p' q = p n for a polynomial n [det_phi_ode].
    (4) p(0) != 0, so p is not 0, so p(1) = 0 would contradict q(1) = P(y1, y1) != 0 [skew_full]. *)
From mathcomp Require Import all_ssreflect all_algebra.
From Liehom Require Import Sound Pair Certificate Derivative Definite.
Set Implicit Arguments. Unset Strict Implicit. Unset Printing Implicit Defensive.
Import Order.TTheory GRing.Theory Num.Theory. Local Open Scope ring_scope.

Lemma trace_adj (S : comRingType) n (f X : 'M[S]_n) (a : S) :
  \tr (\adj f *m (X^T *m f + f *m X + a *: f)) = \det f * (\tr X *+ 2 + a *+ n).
Proof.
rewrite !mulmxDr !linearD /= !mulmxA mul_adj_mx mul_scalar_mx linearZ /=.
rewrite mxtrace_mulC mulmxA mul_mx_adj mul_scalar_mx linearZ /= mxtrace_tr mulrDr -mulr2n mulrnAr.
by congr (_ + _); rewrite -scalemxAr mxtraceZ mul_adj_mx mxtrace_scalar !mulrnAr mulrC.
Qed.

Section Algebra.
Variables (S : comRingType) (d r : nat) (A : 'I_r -> 'M[S]_d) (G : 'M[S]_r) (C : 'I_r -> 'M[S]_r).

(** The matrix with the rows y A_a. *)
Definition orbit_mx (y : 'rV[S]_d) : 'M[S]_(r, d) := \matrix_a (y *m A a).
Local Notation B := orbit_mx.

Definition phi (y : 'rV[S]_d) : 'M[S]_d := (B y)^T *m G *m B y + y^T *m y.
(** The derivative of phi at y along v. *)
Definition dphi (y v : 'rV[S]_d) : 'M[S]_d :=
  ((B v)^T *m G *m B y + (B y)^T *m G *m B v) + (v^T *m y + y^T *m v).

Lemma orbit_mx_is_linear : linear B.
Proof. by move=> t x y; apply/row_matrixP => a; rewrite linearP /= !rowK mulmxDl -scalemxAl. Qed.
Canonical orbit_mx_linear := Linear orbit_mx_is_linear.

Lemma mul_orbit (b : 'rV[S]_r) y : b *m B y = y *m \sum_a b 0 a *: A a.
Proof.
rewrite mulmx_sum_row mulmx_sumr; apply: eq_bigr => a _; by rewrite rowK scalemxAr.
Qed.

Hypothesis G_invariant : forall c, G *m C c = - ((C c)^T *m G).
Hypothesis A_closed : forall c a, A c *m A a = A a *m A c + \sum_e C c a e *: A e.
Hypothesis A_traceless : forall a, \tr (A a) = 0.

Lemma orbit_mx_along c y : B (y *m A c) = B y *m A c + C c *m B y.
Proof.
apply/row_matrixP => a; rewrite linearD /= !row_mul !rowK -!mulmxA A_closed.
rewrite mulmxDr mulmx_sumr (mulmx_sum_row (row a (C c))).
by congr (_ + _); apply: eq_bigr => e _; rewrite rowK mxE scalemxAr.
Qed.

Section Along.
Variables (b : 'rV[S]_r) (y : 'rV[S]_d).
Let X := \sum_a b 0 a *: A a.
Let D := \sum_a b 0 a *: C a.

Lemma orbit_mx_comb : B (y *m X) = B y *m X + D *m B y.
Proof.
rewrite /X /D !mulmx_sumr mulmx_suml (linear_sum orbit_mx_linear) -big_split /=; apply: eq_bigr => a _.
by rewrite -!scalemxAr -scalemxAl (linearZZ orbit_mx_linear) /= orbit_mx_along scalerDr.
Qed.

Lemma G_invariant_comb : G *m D + D^T *m G = 0.
Proof.
rewrite /D [_^T]linear_sum /= mulmx_sumr mulmx_suml -big_split /=; apply: big1 => a _.
by rewrite [_^T]linearZ /= -scalemxAr -scalemxAl G_invariant scalerN addNr.
Qed.

Lemma traceless_comb : \tr X = 0.
Proof. by rewrite /X linear_sum big1 // => a _; rewrite linearZ /= A_traceless mulr0. Qed.

Lemma dphiDr u v : dphi y (u + v) = dphi y u + dphi y v.
Proof.
rewrite /dphi (linearD orbit_mx_linear) /= ![(_ + _)^T]linearD /= !mulmxDl !mulmxDr.
by rewrite [LHS](AC ((2*2)*(2*2)) (((1*3)*(5*7))*((2*4)*(6*8)))).
Qed.

Lemma dphiZr t v : dphi y (t *: v) = t *: dphi y v.
Proof.
rewrite /dphi (linearZZ orbit_mx_linear) /= ![(t *: _)^T]linearZ /=.
by rewrite -!scalemxAl -!scalemxAr -!scalerDr.
Qed.

Lemma dphi_along : dphi y (y *m X) = X^T *m phi y + phi y *m X.
Proof.
have inv : (B y)^T *m (G *m D + D^T *m G) *m B y = 0 by rewrite G_invariant_comb mulmx0 mul0mx.
rewrite -[RHS]addr0 -inv /dphi /phi orbit_mx_comb [(_ + _)^T]linearD /= !trmx_mul !(mulmxDl, mulmxDr) !mulmxA.
by rewrite [RHS](AC ((2*2)*2) ((1*6)*(3*5)*(2*4))).
Qed.

(** p v in terms of the y A_a and y, for p = det (phi y). *)
Lemma det_phi_solve v :
  let w := v *m \adj (phi y) in
  \det (phi y) *: v = w *m (B y)^T *m G *m B y + (w *m y^T) 0 0 *: y.
Proof.
move=> w; rewrite -mul_mx_scalar -mul_adj_mx mulmxA -/w /phi mulmxDr !mulmxA; congr (_ + _).
by rewrite -[RHS]mul_scalar_mx -mx11_scalar.
Qed.
End Along.

(** Step (3): p tr(adj phi . dphi v) = 2 d a p for the coefficient a of y in p v. *)
Lemma det_phi_derivative y v :
  let p := \det (phi y) in let a := (v *m \adj (phi y) *m y^T) 0 0 in
  p * \tr (\adj (phi y) *m dphi y v) = p * (a *+ (2 * d)).
Proof.
move=> p a; set b := v *m \adj (phi y) *m (B y)^T *m G.
rewrite -mxtraceZ scalemxAr -dphiZr det_phi_solve -/a -/b mul_orbit dphiDr dphiZr dphi_along.
set X := \sum_a _.
have -> : dphi y y = phi y *+ 2 by rewrite /dphi -!mulr2n -mulrnDl.
by rewrite -scalerMnr scalerMnl trace_adj traceless_comb mul0rn add0r -mulrnA.
Qed.

(** The same, once the form P annihilates all P(y A_a, y): the coefficient a is p P(v, y) / P(y, y). *)
Lemma det_phi_ode (P : 'M[S]_d) y v : (forall a, y *m A a *m P *m y^T = 0) ->
  let p := \det (phi y) in
  p * (\tr (\adj (phi y) *m dphi y v) * (y *m P *m y^T) 0 0) =
  p * (p * ((v *m P *m y^T) 0 0 *+ (2 * d))).
Proof.
move=> orth p; rewrite mulrA det_phi_derivative -/p -mulrA; congr (_ * _).
rewrite mulrnAl mulrnAr; congr (_ *+ _).
have := congr1 (fun x => (x *m P *m y^T) 0 0) (det_phi_solve y v).
rewrite /= mul_orbit !mulmxDl mulmx_sumr !mulmx_suml big1 ?add0r => [|a _]; last first.
  by rewrite -scalemxAr -!scalemxAl orth scaler0.
by rewrite -!scalemxAl !mxE => <-.
Qed.
End Algebra.

Lemma map_phi (S T : comRingType) (f : {rmorphism S -> T}) d r (A : 'I_r -> 'M[S]_d) (G : 'M[S]_r) (y : 'rV[S]_d) :
  map_mx f (phi A G y) = phi (fun a => map_mx f (A a)) (map_mx f G) (map_mx f y).
Proof.
have eB : map_mx f (orbit_mx A y) = orbit_mx (fun a => map_mx f (A a)) (map_mx f y).
  by apply/row_matrixP => a; rewrite -map_row !rowK map_mxM.
by rewrite /phi map_mxD !map_mxM -!map_trmx eB.
Qed.

Lemma eq_phi (S : comRingType) d r (A A' : 'I_r -> 'M[S]_d) (G : 'M[S]_r) (y : 'rV[S]_d) :
  A =1 A' -> phi A G y = phi A' G y.
Proof.
move=> eA; have eB : orbit_mx A y = orbit_mx A' y by apply/row_matrixP => a; rewrite !rowK eA.
by rewrite /phi eB.
Qed.

Lemma dmx_phi (F : comRingType) d r (A : 'I_r -> 'M[F]_d) (G : 'M[F]_r) (y : 'rV[{poly F}]_d) :
  let Ap a := map_mx polyC (A a) in let Gp := map_mx polyC G in
  dmx (phi Ap Gp y) = dphi Ap Gp y (dmx y).
Proof.
move=> Ap Gp; have eB : dmx (orbit_mx Ap y) = orbit_mx Ap (dmx y).
  apply/row_matrixP => a; rewrite rowK; have := dmxM y (Ap a); rewrite dmxC mulmx0 addr0 => <-.
  by apply/rowP => j; rewrite !mxE.
by rewrite /phi /dphi dmxD !dmxM !dmxT eB dmxC mulmx0 addr0.
Qed.

Section Skew.
Variables (F : realFieldType) (d r : nat) (A : 'I_r -> 'M[F]_d) (P : 'M[F]_d).
Hypotheses (P_sym : P^T = P) (P_pos : positive_definite P) (A_skew : forall a, skew P (A a)).
Hypothesis A_bracket : forall c a, exists u : 'I_r -> F, A c *m A a - A a *m A c = \sum_e u e *: A e.
Hypothesis A_free : forall u : 'rV[F]_r, \sum_a u 0 a *: A a = 0 -> u = 0.

Definition gram : 'M[F]_r := \matrix_(a, b) - \tr (A a *m A b).
Definition casimir : 'M[F]_r := invmx gram.

Lemma gram_sym : gram^T = gram.
Proof. by apply/matrixP => a b; rewrite !mxE mxtrace_mulC. Qed.

Lemma gram_value (u w : 'rV[F]_r) :
  (u *m gram *m w^T) 0 0 = - \tr ((\sum_a u 0 a *: A a) *m (\sum_b w 0 b *: A b)).
Proof.
rewrite -mulmxA mxE mulmx_suml linear_sum -sumrN /=; apply: eq_bigr => a _.
rewrite mxE mulmx_sumr linear_sum -sumrN /= mulr_sumr; apply: eq_bigr => b _.
by rewrite !mxE -scalemxAl -scalemxAr !linearZ /= mulNr mulrN [w 0 b * _]mulrC.
Qed.

Lemma gram_pos : positive_definite gram.
Proof.
move=> u u0; rewrite gram_value; apply: (skew_trace P_sym P_pos).
  rewrite /skew mulmx_suml linear_sum mulmx_sumr -sumrN /=; apply: eq_bigr => a _.
  by rewrite -scalemxAl A_skew linearZ /= -scalemxAr scalerN.
by apply: contra u0 => /eqP /A_free ->.
Qed.

Lemma gram_unit : gram \in unitmx.
Proof. exact: definite_unit gram_sym gram_pos. Qed.

Lemma casimir_sym : casimir^T = casimir.
Proof. by rewrite /casimir trmx_inv gram_sym. Qed.

Lemma casimir_pos : positive_definite casimir.
Proof.
move=> u u0; have -> : u *m casimir *m u^T = (u *m casimir) *m gram *m (u *m casimir)^T.
  by rewrite trmx_mul casimir_sym -!mulmxA mulKVmx ?gram_unit.
apply: gram_pos; apply: contra u0 => /eqP u0.
by rewrite -[u](mulmxKV gram_unit) -/casimir u0 mul0mx.
Qed.

(** Step (1), both directions. *)
Lemma span_phi (y : 'rV[F]_d) : row_full (span_at A y) = (\det (phi A casimir y) != 0).
Proof.
apply/idP/idP => [full_y | det0].
  apply/det0P => [[w w0 wphi]].
  have sum0 : (w *m (orbit_mx A y)^T *m casimir *m (w *m (orbit_mx A y)^T)^T) 0 0 + (w *m y^T) 0 0 ^+ 2 = 0.
    have : (w *m phi A casimir y *m w^T) 0 0 = 0 by rewrite wphi mul0mx mxE.
    rewrite /phi mulmxDr mulmxDl mxE => E; rewrite -[RHS]E; congr (_ + _).
      by rewrite trmx_mul trmxK !mulmxA.
    rewrite mulmxA -mulmxA [RHS]mxE big_ord1 expr2; congr (_ * _).
    by rewrite -[y *m w^T]trmxK trmx_mul trmxK [RHS]mxE.
  have wB : w *m (orbit_mx A y)^T = 0.
    apply/eqP; apply: contraT => /casimir_pos pos.
    by have := ltr_spaddl pos (sqr_ge0 ((w *m y^T) 0 0)); rewrite sum0 ltxx.
  move: sum0; rewrite wB !mul0mx mxE add0r => /eqP; rewrite sqrf_eq0 => /eqP wy.
  have : (span_at A y <= kermx w^T)%MS.
    apply: span_sub; first by apply/sub_kermxP/matrixP => i j; rewrite !ord1 -[_ *m _]trmxK trmx_mul trmxK mxE wy mxE.
    move=> a; apply/sub_kermxP; have := congr1 (fun M => row a M^T) wB.
    by rewrite trmx_mul trmxK row_mul rowK => ->; apply/rowP => j; rewrite !mxE.
  move: full_y; rewrite -sub1mx => /submx_trans le /le /sub_kermxP; rewrite mul1mx => /eqP.
  by rewrite trmx_eq0 (negPf w0).
have unit_phi : phi A casimir y \in unitmx by rewrite unitmxE unitfE.
rewrite -sub1mx -[1%:M](mulVmx unit_phi); apply: submx_trans (submxMl _ _) _.
apply/row_subP => i; rewrite rowE; set w := delta_mx 0 i.
rewrite /phi mulmxDr !mulmxA mul_orbit; apply/span_atP.
exists (fun a => (w *m (orbit_mx A y)^T *m casimir) 0 a), ((w *m y^T) 0 0).
by rewrite -[X in _ = _ + X]mul_scalar_mx -mx11_scalar.
Qed.

Lemma structure_constants : exists C : 'I_r -> 'M[F]_r,
  forall c a, A c *m A a = A a *m A c + \sum_e C c a e *: A e.
Proof.
have ex c : exists M : 'M[F]_r, forall a, A c *m A a = A a *m A c + \sum_e M a e *: A e.
  have [u eu] := fin_all_exists (A_bracket c); exists (\matrix_(a, e) u a e) => a.
  apply/eqP; rewrite addrC -subr_eq eu; apply/eqP; by apply: eq_bigr => e _; rewrite mxE.
exact: fin_all_exists ex.
Qed.

Lemma casimir_invariant (C : 'I_r -> 'M[F]_r) :
  (forall c a, A c *m A a = A a *m A c + \sum_e C c a e *: A e) ->
  forall c, casimir *m C c = - ((C c)^T *m casimir).
Proof.
move=> eC c; have gu := gram_unit.
have inv : C c *m gram = - (gram *m (C c)^T).
  apply/matrixP => a b; rewrite !mxE.
  have tr x z : \tr ((A c *m A x - A x *m A c) *m A z) = - \sum_e C c x e * gram e z.
    rewrite eC addrC addKr mulmx_suml linear_sum -sumrN; apply: eq_bigr => e _ /=.
    by rewrite -scalemxAl linearZ /= !mxE mulrN opprK.
  have -> : \sum_j C c a j * gram j b = - \tr ((A c *m A a - A a *m A c) *m A b) by rewrite tr opprK.
  have -> : \sum_j gram a j * (C c)^T j b = - \tr ((A c *m A b - A b *m A c) *m A a).
    rewrite tr opprK; apply: eq_bigr => e _; rewrite mulrC [(C c)^T _ _]mxE; congr (_ * _).
    by rewrite -[in RHS]gram_sym [in RHS]mxE.
  rewrite opprK !mulmxBl !linearB /= opprB; congr (_ - _).
    by rewrite -mulmxA mxtrace_mulC.
  by rewrite mxtrace_mulC mulmxA.
have := congr1 (fun M => casimir *m M *m casimir) inv.
by rewrite mulmxN mulNmx !mulmxA /casimir mulmxK // mulVmx // mul1mx.
Qed.
(** Step (3) along a line, and step (4). *)
Theorem skew_full (x : 'rV[F]_d) : row_full (span_at A x) -> full A.
Proof.
have [C eC] := structure_constants => full_x y y0; rewrite span_phi.
pose Ap a := map_mx polyC (A a); pose Gp := map_mx polyC casimir; pose Cp a := map_mx polyC (C a).
pose Pp := map_mx polyC P; pose v := map_mx polyC (y - x); pose l := map_mx polyC x + 'X *: v.
have at_point t : map_mx (horner_eval t) l = x + t *: (y - x).
  by apply/rowP => j; rewrite !mxE /horner_eval !hornerE.
have evalC m n t (M : 'M[F]_(m, n)) : map_mx (horner_eval t) (map_mx polyC M) = M.
  by apply/matrixP => i j; rewrite !mxE /horner_eval hornerC.
set p := \det (phi Ap Gp l); pose q := (l *m Pp *m l^T) 0 0.
have value_p t : p.[t] = \det (phi A casimir (x + t *: (y - x))).
  rewrite -[p.[t]]/(horner_eval t p) /p -det_map_mx map_phi at_point /Gp evalC; congr (\det _).
  by apply: eq_phi => a; rewrite evalC.
have value_q t : q.[t] = ((x + t *: (y - x)) *m P *m (x + t *: (y - x))^T) 0 0.
  rewrite -[q.[t]]/(horner_eval t q) /q -at_point -(evalC _ _ t P) -/Pp.
  by rewrite map_trmx -!map_mxM [RHS]mxE.
have end1 : x + 1 *: (y - x) = y by rewrite scale1r addrCA subrr addr0.
have char0 : [char F] =i pred0 by exact: char_num.
rewrite -end1 -value_p.
have p0 : p != 0.
  apply: contraTneq full_x => p0; rewrite span_phi negbK.
  by have := value_p 0; rewrite scale0r addr0 p0 horner0 => <-.
apply: (@ode_nonzero _ p q ((v *m Pp *m l^T) 0 0 *+ (2 * d))) => //; last first.
  by rewrite value_q end1 gt_eqF // P_pos.
have Gp_inv c : Gp *m Cp c = - ((Cp c)^T *m Gp).
  by rewrite /Gp /Cp -map_mxM (casimir_invariant eC) map_mxN map_mxM map_trmx.
have Ap_closed c a : Ap c *m Ap a = Ap a *m Ap c + \sum_e Cp c a e *: Ap e.
  rewrite /Ap -!map_mxM eC map_mxD (raddf_sum (map_mx_additive _ _ _)); congr (_ + _).
  by apply: eq_bigr => e _; rewrite /= map_mxZ mxE.
have Ap_traceless a : \tr (Ap a) = 0.
  by rewrite /Ap trace_map_mx (skew_traceless P_sym P_pos (A_skew a)) rmorph0.
have orth a : l *m Ap a *m Pp *m l^T = 0.
  have neg : (l *m Ap a *m Pp *m l^T)^T = - (l *m Ap a *m Pp *m l^T).
    have Pp_sym : Pp^T = Pp by rewrite /Pp map_trmx P_sym.
    have PA : Pp *m (Ap a)^T = - (Ap a *m Pp) by rewrite /Pp /Ap map_trmx -!map_mxM A_skew map_mxN opprK.
    by rewrite !trmx_mul trmxK Pp_sym -!mulmxA (mulmxA Pp) PA mulNmx mulmxN !mulmxA.
  apply/matrixP => i j; rewrite !ord1 [RHS]mxE.
  have := congr1 (fun M : 'M_1 => M 0 0) neg; rewrite /= !mxE => /eqP; rewrite -addr_eq0 -mulr2n.
  by rewrite -mulr_natl mulf_eq0 -(rmorph_nat (polyC_rmorphism F)) polyC_eq0 pnatr_eq0 /= => /eqP.
have := det_phi_ode Gp_inv Ap_closed Ap_traceless v orth.
rewrite -/p -/q => /(mulfI p0).
have dl : dmx l = v.
  by apply/rowP => j; rewrite !mxE !derivE mulr0 add0r addr0 mul1r.
by rewrite -{1}dl -dmx_phi -deriv_det -/p.
Qed.
End Skew.
