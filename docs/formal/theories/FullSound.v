(** Soundness of the kinds trivial and full: a certificate over F proves fullness over every real field that extends F.

    Source: docs/theory/fullness.md, section 2 (Theorem 2) and section 7.

    m is the space of P-skew matrices in L = span(rho_i, 1). It is closed under brackets; its basis is the family A of
    Sphere.v. A matrix K of the certificate with K P + P K^T = a P differs from an element of m by the scalar a/2. So
    the rank at one point is a rank for m, hence for m at every point, hence for L. *)
From mathcomp Require Import all_ssreflect all_algebra.
From Liehom Require Import Sound Pair Certificate Derivative Definite Sphere.
Set Implicit Arguments. Unset Strict Implicit. Unset Printing Implicit Defensive.
Import Order.TTheory GRing.Theory Num.Theory. Local Open Scope ring_scope.

(** The span of the rho_i is closed under brackets. *)
Definition bracket_closed (F : fieldType) k d (rho : 'I_k -> 'M[F]_d) :=
  forall i j, exists u : 'I_k -> F, rho i *m rho j - rho j *m rho i = \sum_e u e *: rho e.

Section SkewPart.
Variables (F : realFieldType) (k d : nat) (rho : 'I_k -> 'M[F]_d) (P : 'M[F]_d).

Definition in_L (X : 'M[F]_d) := exists u s, X = \sum_i u i *: rho i + s%:M.
Definition skew_defect (X : 'M[F]_d) := X *m P + P *m X^T.

Lemma skew_defect_is_linear : linear skew_defect.
Proof.
move=> t X Y; rewrite /skew_defect linearP /= mulmxDl mulmxDr -scalemxAl -scalemxAr scalerDr.
by rewrite addrACA.
Qed.
Canonical skew_defect_linear := Linear skew_defect_is_linear.

(** L and m as row spaces of matrices; the rows are flattened matrices. *)
Definition L_mx : 'M[F]_(d * d) := (<<mxvec 1%:M>> + \sum_i <<mxvec (rho i)>>)%MS.
Definition m_mx : 'M[F]_(d * d) := (L_mx :&: kermx (lin_mx skew_defect))%MS.
Definition m_basis (a : 'I_(\rank m_mx)) : 'M[F]_d := vec_mx (row a (row_base m_mx)).

Lemma in_LP X : reflect (in_L X) (mxvec X <= L_mx)%MS.
Proof.
apply: (iffP idP) => [/sub_addsmxP [[a b]] /= e | [u [s ->]]]; last first.
  rewrite linearD /= addmx_sub //; last first.
    rewrite -scalemx1 linearZ /=; apply: scalemx_sub; apply: submx_trans (addsmxSl _ _); by rewrite genmxE.
  rewrite linear_sum; apply: summx_sub => i _; rewrite linearZ /=; apply: scalemx_sub.
  by apply: submx_trans (addsmxSr _ _); apply: (sumsmx_sup i) => //; rewrite genmxE.
have /sub_sumsmxP [w ew] := submxMl b (\sum_i <<mxvec (rho i)>>)%MS.
have coef i : exists s, w i *m <<mxvec (rho i)>>%MS = s *: mxvec (rho i).
  by apply/sub_rVP; apply: submx_trans (submxMl _ _) _; rewrite genmxE.
have [s es] := fin_all_exists coef.
have /sub_rVP [t et] : (a *m <<mxvec 1%:M>> <= mxvec (1%:M : 'M[F]_d))%MS.
  by apply: submx_trans (submxMl _ _) _; rewrite genmxE.
exists s, t; apply: (can_inj mxvecK); rewrite e ew et linearD linear_sum /= addrC -[t%:M]scalemx1 linearZ /=.
by congr (_ + _); apply: eq_bigr => i _; rewrite es linearZ.
Qed.

Lemma in_mP X : reflect (in_L X /\ skew P X) (mxvec X <= m_mx)%MS.
Proof.
rewrite sub_capmx; apply: (iffP andP) => [[/in_LP XL /sub_kermxP sk] | [/in_LP XL sk]]; split=> //.
  move: sk; rewrite mul_vec_lin /= => /(congr1 vec_mx); rewrite mxvecK linear0 => /eqP.
  by rewrite /skew_defect addr_eq0 => /eqP.
by apply/sub_kermxP; rewrite mul_vec_lin /= /skew_defect sk addNr linear0.
Qed.

Lemma m_basisP a : in_L (m_basis a) /\ skew P (m_basis a).
Proof. by apply/in_mP; rewrite vec_mxK -(eq_row_base m_mx) row_sub. Qed.

Lemma m_basis_span X : in_L X -> skew P X -> exists u : 'I_(\rank m_mx) -> F, X = \sum_a u a *: m_basis a.
Proof.
move=> XL sk; have: (mxvec X <= row_base m_mx)%MS by rewrite eq_row_base; apply/in_mP.
case/submxP => u eu; exists (u 0); apply: (can_inj mxvecK); rewrite eu mulmx_sum_row linear_sum.
by apply: eq_bigr => a _; rewrite linearZ /= vec_mxK.
Qed.

Lemma m_basis_free (u : 'rV[F]_(\rank m_mx)) : \sum_a u 0 a *: m_basis a = 0 -> u = 0.
Proof.
move=> e; have: u *m row_base m_mx = 0.
  apply: (can_inj vec_mxK); rewrite mulmx_sum_row linear_sum linear0 -[RHS]e.
  by apply: eq_bigr => a _; rewrite linearZ.
by move=> u0; apply: (row_free_inj (row_base_free m_mx)); rewrite u0 mul0mx.
Qed.

(** A bracket of P-skew matrices is P-skew, and a bracket of elements of L lies in L (scalars are central). *)
Lemma skew_bracket X Y : P^T = P -> skew P X -> skew P Y -> skew P (X *m Y - Y *m X).
Proof.
rewrite /skew => Ps sX sY; rewrite mulmxBl linearB /= mulmxBr !trmx_mul.
rewrite -(mulmxA X) -(mulmxA Y) sX sY !mulmxN !mulmxA sX sY !mulNmx !opprK opprB.
by [].
Qed.

Lemma L_bracket X Y : bracket_closed rho -> in_L X -> in_L Y -> in_L (X *m Y - Y *m X).
Proof.
move=> clos [u [s ->]] [w [t ->]]; set X0 := \sum_i _; set Y0 := \sum_i _.
have -> : (X0 + s%:M) *m (Y0 + t%:M) - (Y0 + t%:M) *m (X0 + s%:M) = X0 *m Y0 - Y0 *m X0.
  pose E := t *: X0 + (s *: Y0 + (s * t)%:M).
  have -> : (X0 + s%:M) *m (Y0 + t%:M) = X0 *m Y0 + E.
    by rewrite mulmxDl !mulmxDr mul_mx_scalar !mul_scalar_mx scale_scalar_mx -addrA.
  have -> : (Y0 + t%:M) *m (X0 + s%:M) = E + Y0 *m X0.
    rewrite mulmxDl !mulmxDr mul_mx_scalar !mul_scalar_mx scale_scalar_mx mulrC /E.
    by rewrite [LHS](AC (2*2) (3*(2*4)*1)).
  by rewrite addrKA.
have -> : X0 *m Y0 - Y0 *m X0 = \sum_i \sum_j (u i * w j) *: (rho i *m rho j - rho j *m rho i).
  rewrite /X0 /Y0 !mulmx_suml.
  rewrite [X in _ - X](eq_bigr (fun j => \sum_i (w j * u i) *: (rho j *m rho i))) => [|j _]; last first.
    by rewrite mulmx_sumr; apply: eq_bigr => i _; rewrite -scalemxAl -scalemxAr scalerA.
  rewrite [X in _ - X]exchange_big -sumrB /=; apply: eq_bigr => i _; rewrite mulmx_sumr -sumrB.
  by apply: eq_bigr => j _; rewrite -scalemxAl -scalemxAr scalerA scalerBr [w j * _]mulrC.
have [c ec] : exists c : 'I_k -> 'I_k -> 'I_k -> F,
    forall i j, rho i *m rho j - rho j *m rho i = \sum_e c i j e *: rho e.
  exact: fin_all_exists (fun i => fin_all_exists (clos i)).
exists (fun e => \sum_i \sum_j u i * w j * c i j e), 0; rewrite (raddf0 (scalar_mx_additive _ _)) addr0.
rewrite [RHS](eq_bigr (fun e => \sum_i \sum_j (u i * w j * c i j e) *: rho e)) => [|e _]; last first.
  by rewrite scaler_suml; apply: eq_bigr => i _; rewrite scaler_suml.
rewrite [RHS]exchange_big /=; apply: eq_bigr => i _; rewrite [RHS]exchange_big /=; apply: eq_bigr => j _.
by rewrite ec scaler_sumr; apply: eq_bigr => e _; rewrite scalerA.
Qed.
End SkewPart.

(** Soundness of `full` on V, over one ordered field. *)
Theorem full_matrices_sound (F : realFieldType) k d (rho : 'I_k -> 'M[F]_d) s (P : 'M[F]_d) (K : 'I_s -> 'M[F]_d)
    (x : 'rV[F]_d) : bracket_closed rho -> full_matrices rho P K x -> full rho.
Proof.
move=> clos [Ps Pp KL Kc rk]; pose A := @m_basis F k d rho P.
have full_x : row_full (span_at A x).
  rewrite -sub1mx; apply: submx_trans (_ : span_at K x <= _)%MS; first by rewrite sub1mx.
  apply: span_sub => [|j]; first exact: addsmxSl.
  have [u eu] := KL j; have [a ea] := Kc j.
  have [||w ew] := @m_basis_span _ _ _ rho P (K j - (a / 2%:R)%:M).
  - by exists u, (- (a / 2%:R)); rewrite eu raddfN.
  - rewrite /skew mulmxBl mul_scalar_mx linearB /= tr_scalar_mx mulmxBr mul_mx_scalar.
    apply/eqP; rewrite -addr_eq0 addrACA ea -opprD -scalerDl -mulr2n -mulr_natr divfK ?pnatr_eq0 //.
    by rewrite subrr.
  apply/span_atP; exists w, (a / 2%:R); rewrite -ew mulmxBr mul_mx_scalar subrK //.
move=> y y0; have fy : row_full (span_at A y).
  apply: (skew_full Ps Pp _ _ _ full_x) => // [a | c a | u].
  - by case: (m_basisP a).
  - by apply: m_basis_span; [apply: L_bracket | apply: skew_bracket] => //; case: (m_basisP a); case: (m_basisP c).
  - exact: m_basis_free.
rewrite -sub1mx; apply: submx_trans (_ : span_at A y <= _)%MS; first by rewrite sub1mx.
apply: span_sub => [|a]; first exact: addsmxSl.
have [[u [t e]] _] := m_basisP a.
by apply/span_atP; exists u, t; rewrite /A e mulmxDr mul_mx_scalar.
Qed.

(** If rho(h) preserves a definite form up to factors, one vector decides: the range condition holds at one x != 0 if
    and only if the pair is full (Proposition 5 of the page). *)
Corollary one_point (F : realFieldType) k d (rho : 'I_k -> 'M[F]_d) (P : 'M[F]_d) (x : 'rV[F]_d) :
  bracket_closed rho -> P^T = P -> positive_definite P -> (forall i, conformal P (rho i)) -> x != 0 ->
  row_full (span_at rho x) <-> full rho.
Proof.
move=> clos Ps Pp Kc x0; split=> [rk | full_rho]; last exact: full_rho.
apply: (full_matrices_sound clos); split; [exact: Ps | exact: Pp | move=> j | exact: Kc | exact: rk].
exists (fun i => (i == j)%:R); rewrite (bigD1 j) //= eqxx scale1r big1 ?addr0 // => i ij.
by rewrite (negPf ij) scale0r.
Qed.

(** Every morphism from the rational numbers is increasing. *)
Lemma rat_increasing (R : realFieldType) (f : {rmorphism rat -> R}) : increasing f.
Proof. by move=> x x0; rewrite (fmorph_eq_rat f) ltr0q. Qed.

(** Change of field. *)
Section Map.
Variables (F R : fieldType) (f : {rmorphism F -> R}) (n k d : nat).
Variables (c : 'I_n -> 'M[F]_n) (h : 'M[F]_(k, n)) (Q : 'M[F]_(n, d)) (E : 'M[F]_(d, n)).

Lemma map_sum m p (I : finType) (M : I -> 'M[F]_(m, p)) : map_mx f (\sum_i M i) = \sum_i map_mx f (M i).
Proof. exact: (raddf_sum (map_mx_additive f m p)). Qed.

Lemma map_ad x : map_mx f (ad c x) = ad (map_pair f c) (map_mx f x).
Proof. by rewrite /ad map_sum; apply: eq_bigr => i _; rewrite map_mxZ mxE. Qed.

Lemma map_bracket x y : map_mx f (bracket c x y) = bracket (map_pair f c) (map_mx f x) (map_mx f y).
Proof. by rewrite /bracket map_mxM map_ad. Qed.

Lemma map_isotropy z :
  map_mx f (isotropy c Q E z) = isotropy (map_pair f c) (map_mx f Q) (map_mx f E) (map_mx f z).
Proof. by rewrite /isotropy !map_mxM map_ad. Qed.

Lemma map_rho p : map_mx f (rho c h Q E p) = rho (map_pair f c) (map_mx f h) (map_mx f Q) (map_mx f E) p.
Proof. by rewrite /rho map_isotropy map_row. Qed.

Lemma map_valid_pair : valid_pair c h Q E -> valid_pair (map_pair f c) (map_mx f h) (map_mx f Q) (map_mx f E).
Proof.
move=> [cl [hQ EQ kQ] rep]; split; [move=> p q | split | move=> p q].
- by rewrite -!map_row -map_bracket map_submx.
- by rewrite -map_mxM hQ map_mx0.
- by rewrite -map_mxM EQ map_mx1.
- by rewrite -map_kermx map_submx.
by rewrite -!map_row -map_bracket -map_isotropy rep map_mxB ![map_mx f (rho _ _ _ _ _ *m _)]map_mxM !map_rho.
Qed.

Lemma map_span_full s (K : 'I_s -> 'M[F]_d) (x : 'rV[F]_d) (K' : 'I_s -> 'M[R]_d) :
  (forall j, K' j = map_mx f (K j)) -> row_full (span_at K x) -> row_full (span_at K' (map_mx f x)).
Proof.
move=> eK; rewrite -!sub1mx => /row_subP full_x; apply/row_subP => i.
have /span_atP [u [t e]] := full_x i; apply/span_atP; exists (fun j => f (u j)), (f t).
rewrite -[1%:M](map_mx1 f) -map_row e map_mxD map_mxM map_sum map_mxZ; congr (_ *m _ + _).
by apply: eq_bigr => j _; rewrite map_mxZ eK.
Qed.
End Map.

(** rho(h) is closed under brackets, since rho is a representation of h. *)
Lemma representation_closed (F : fieldType) n k d (c : 'I_n -> 'M[F]_n) (h : 'M[F]_(k, n)) (Q : 'M[F]_(n, d))
    (E : 'M[F]_(d, n)) : valid_pair c h Q E -> bracket_closed (rho c h Q E).
Proof.
move=> [cl _ rep] i j; have /submxP [u eu] := cl j i.
by exists (u 0); rewrite -rep eu isotropy_h.
Qed.

(** Kind full: a certificate over F proves fullness over every ordered field R that extends F. *)
Theorem full_sound (F R : realFieldType) (f : {rmorphism F -> R}) n k d (c : 'I_n -> 'M[F]_n) (h : 'M[F]_(k, n))
    (Q : 'M[F]_(n, d)) (E : 'M[F]_(d, n)) s (P : 'M[F]_d) (z : 'M[F]_(s, n)) (eta : 'rV[F]_n) :
  increasing f -> valid_pair c h Q E -> full_certificate c h Q E P z eta ->
  full_pair (map_pair f c) (map_mx f h).
Proof.
move=> inc ok [Ps Pp zh Kc rk]; have okR := map_valid_pair f ok; have [clR coR repR] := okR.
apply/(full_pairP clR coR).
apply: (@full_matrices_sound _ _ _ _ s (map_mx f P)
  (fun j => isotropy (map_pair f c) (map_mx f Q) (map_mx f E) (row j (map_mx f z))) (map_mx f (eta *m Q))).
  exact: representation_closed okR.
split.
- by rewrite map_trmx Ps.
- exact: definite_map.
- move=> j; have /submxP [u ->] : (row j (map_mx f z) <= map_mx f h)%MS.
    by rewrite -map_row map_submx; apply: submx_trans (row_sub j z) zh.
  by exists (u 0); rewrite isotropy_h.
- move=> j; have [a ea] := Kc j; exists (f a).
  by rewrite -map_row -map_isotropy map_trmx -!map_mxM -map_mxD ea map_mxZ.
- by apply: map_span_full rk => j; rewrite map_isotropy map_row.
Qed.

(** Kind full over the field of the certificate. *)
Corollary full_sound_base (F : realFieldType) n k d (c : 'I_n -> 'M[F]_n) (h : 'M[F]_(k, n)) (Q : 'M[F]_(n, d))
    (E : 'M[F]_(d, n)) s (P : 'M[F]_d) (z : 'M[F]_(s, n)) (eta : 'rV[F]_n) :
  valid_pair c h Q E -> full_certificate c h Q E P z eta -> full_pair c h.
Proof.
move=> ok cert eta' etah v.
have eb x y : bracket (map_pair [rmorphism of @idfun F] c) x y = bracket c x y.
  by rewrite /bracket /ad /map_pair; congr (_ *m _); apply: eq_bigr => i _; rewrite map_mx_id.
have := @full_sound _ _ [rmorphism of @idfun F] _ _ _ _ _ _ _ _ _ _ _ (fun x => id) ok cert eta'.
rewrite map_mx_id // => /(_ etah v) [w [y [t [wh yh ->]]]]; exists w, y, t; split=> //.
by rewrite eb.
Qed.

(** Kind trivial, over every field that extends F. *)
Theorem trivial_pair_sound (F R : fieldType) (f : {rmorphism F -> R}) n k d (c : 'I_n -> 'M[F]_n) (h : 'M[F]_(k, n))
    (Q : 'M[F]_(n, d)) (E : 'M[F]_(d, n)) :
  valid_pair c h Q E -> (d <= 1)%N -> full_pair (map_pair f c) (map_mx f h).
Proof.
move=> ok d1; have [clR coR _] := map_valid_pair f ok.
by apply/(full_pairP clR coR)/trivial_sound.
Qed.
