(** Positive definite forms over an ordered field.

    Source: docs/theory/fullness.md, sections 2 and 7 (the form of a certificate `full`, and its LDL^T decomposition).

    [definite_factors]: a symmetric positive definite P is U D U^T, D diagonal with positive entries (no square roots
    are needed). Two consequences: [definite_map], positivity goes over to larger fields, and [skew_trace], the trace
    form -tr(XY) is positive definite on the P-skew matrices. *)
From mathcomp Require Import all_ssreflect all_algebra.
From Liehom Require Import Sound Pair Certificate.
Set Implicit Arguments. Unset Strict Implicit. Unset Printing Implicit Defensive.
Import Order.TTheory GRing.Theory Num.Theory. Local Open Scope ring_scope.

Section Factors.
Variable F : realFieldType.

(** The value of a diagonal form. *)
Lemma diag_form d (D x : 'rV[F]_d) : (x *m diag_mx D *m x^T) 0 0 = \sum_i D 0 i * x 0 i ^+ 2.
Proof.
rewrite mxE; apply: eq_bigr => i _; rewrite mul_mx_diag !mxE.
by rewrite mulrAC -expr2 mulrC.
Qed.

Lemma positive_factors_definite d (P U : 'M[F]_d) (D : 'rV[F]_d) :
  positive_factors P U D -> positive_definite P.
Proof.
case=> Uu D0 -> x x0; have -> : x *m (U *m diag_mx D *m U^T) *m x^T = (x *m U) *m diag_mx D *m (x *m U)^T.
  by rewrite trmx_mul !mulmxA.
have: x *m U != 0 by apply: contra x0 => /eqP xU; rewrite -[x](mulmxK Uu) xU mul0mx.
move: (x *m U) => y y0; rewrite diag_form.
have ge i : true -> 0 <= D 0 i * y 0 i ^+ 2 by move=> _; rewrite mulr_ge0 ?sqr_ge0 // ltW.
rewrite lt_def sumr_ge0 // andbT psumr_eq0 //; apply: contra y0 => /allP all0.
apply/eqP/rowP => i; rewrite mxE; apply/eqP.
have /= := all0 i (mem_index_enum i); by rewrite mulf_eq0 gt_eqF ?D0 //= sqrf_eq0.
Qed.

Lemma positive_factors_sym d (P U : 'M[F]_d) (D : 'rV[F]_d) : positive_factors P U D -> P^T = P.
Proof. by case=> _ _ ->; rewrite !trmx_mul trmxK tr_diag_mx mulmxA. Qed.

(** Elimination of the first coordinate: the Schur complement of a positive definite form is positive definite. *)
Lemma definite_factors d (P : 'M[F]_d) :
  P^T = P -> positive_definite P -> exists U D, positive_factors P U D.
Proof.
elim: d P => [|d IH] P Psym Ppos.
  exists 1%:M, 0; split; [exact: unitmx1 | by case | by apply/matrixP; case].
rewrite -[d.+1]/(1 + d)%N in P Psym Ppos *.
pose a := P 0 0; pose b := ursubmx P; pose P' := drsubmx P.
have a11 : ulsubmx P = a%:M by rewrite [LHS]mx11_scalar !mxE !lshift0.
have low : dlsubmx P = b^T by rewrite /b trmx_ursub Psym.
have defP : P = block_mx a%:M b b^T P' by rewrite -a11 -low submxK.
have P'sym : P'^T = P' by rewrite /P' trmx_drsub Psym.
have a0 : 0 < a.
  have e0 : (row_mx 1%:M 0 : 'rV[F]_(1 + d)) != 0.
    apply/eqP => /(congr1 lsubmx); rewrite row_mxKl linear0 => /matrixP /(_ 0 0).
    by rewrite !mxE => /eqP; rewrite oner_eq0.
  have := Ppos _ e0; rewrite defP tr_row_mx mul_row_block mul_row_col trmx0 mulmx0 addr0 trmx1 mulmx1.
  by rewrite !mul1mx !mul0mx addr0 mxE eqxx mulr1n.
have au : a != 0 by rewrite gt_eqF.
pose l : 'cV[F]_d := a^-1 *: b^T; pose S := P' - l *m b.
have Ssym : S^T = S by rewrite /S /l linearB /= P'sym trmx_mul linearZ /= trmxK -scalemxAr -scalemxAl.
have Spos : positive_definite S.
  move=> y y0; pose x := row_mx (- (y *m l)) y : 'rV[F]_(1 + d).
  have x0 : x != 0.
    by apply: contra y0 => /eqP /(congr1 rsubmx); rewrite row_mxKr linear0 => ->.
  have := Ppos _ x0; rewrite defP /x tr_row_mx mul_row_block mul_row_col.
  have -> : - (y *m l) *m a%:M + y *m b^T = 0.
    by rewrite mul_mx_scalar /l -scalemxAr scalerN scalerA divff // scale1r addNr.
  by rewrite mul0mx add0r /S mulmxBr mulNmx addrC mulmxA.
have [U [D [Uu D0 eS]]] := IH _ Ssym Spos.
exists (block_mx 1%:M 0 l U), (row_mx a%:M D : 'rV_(1 + d)); split.
- by rewrite unitmxE det_lblock det1 mul1r -unitmxE.
- move=> i; rewrite mxE; case: splitP => j _; last exact: D0.
  by rewrite ord1 mxE eqxx mulr1n.
have -> : diag_mx (row_mx a%:M D : 'rV_(1 + d)) = block_mx a%:M 0 0 (diag_mx D).
  by rewrite diag_mx_row; congr block_mx; apply/matrixP => i j; rewrite !mxE !ord1 !eqxx.
rewrite tr_block_mx !mulmx_block trmx1 trmx0.
rewrite !(mul1mx, mulmx1, mulmx0, mul0mx, addr0, add0r) -eS.
rewrite defP /S; congr block_mx.
- by rewrite mul_scalar_mx /l linearZ /= trmxK scalerA divff // scale1r.
- by rewrite mul_mx_scalar /l scalerA divff // scale1r.
have -> : l *m a%:M *m l^T = l *m b.
  by rewrite -mulmxA mul_scalar_mx /l [in X in a *: X]linearZ /= trmxK scalerA divff // scale1r.
by rewrite addrC subrK.
Qed.

(** P-skew matrices: P(Xx, y) + P(x, Xy) = 0. *)
Definition skew d (P X : 'M[F]_d) := X *m P = - (P *m X^T).

Lemma definite_unit d (P : 'M[F]_d) : P^T = P -> positive_definite P -> P \in unitmx.
Proof.
move=> Ps Pp; have [U [D [Uu D0 ->]]] := definite_factors Ps Pp.
rewrite !unitmx_mul unitmx_tr Uu /= andbT unitmxE det_diag unitfE.
by apply/prodf_neq0 => i _; rewrite gt_eqF.
Qed.

Lemma skew_traceless d (P X : 'M[F]_d) : P^T = P -> positive_definite P -> skew P X -> \tr X = 0.
Proof.
move=> Ps Pp sk; have Pu := definite_unit Ps Pp.
have : \tr X = - \tr X.
  rewrite -{1}[X](mulmxK Pu) sk mulNmx linearN /= -mulmxA mxtrace_mulC -mulmxA.
  by rewrite mulVmx // mulmx1 mxtrace_tr.
by move/eqP; rewrite -addr_eq0 -mulr2n mulrn_eq0 /= => /eqP.
Qed.

(** In coordinates that diagonalize P, -tr(X X) is the sum of X_ij^2 D_j / D_i. *)
Lemma skew_trace d (P X : 'M[F]_d) :
  P^T = P -> positive_definite P -> skew P X -> X != 0 -> 0 < - \tr (X *m X).
Proof.
move=> Ps Pp sk X0; have [U [D [Uu D0 defP]]] := definite_factors Ps Pp.
have Utu : U^T \in unitmx by rewrite unitmx_tr.
pose Z := invmx U *m X *m U.
have ZD : Z *m diag_mx D = - (diag_mx D *m Z^T).
  rewrite -[LHS](mulmxK Utu) -[RHS](mulmxK Utu); congr (_ *m _).
  rewrite -[LHS](mulKmx Uu) -[RHS](mulKmx Uu); congr (_ *m _).
  move: sk; rewrite /skew defP /Z !trmx_mul trmx_inv mulNmx mulmxN !mulmxA mulmxV // mul1mx => ->.
  by rewrite mulmxKV.
have -> : \tr (X *m X) = \tr (Z *m Z).
  by rewrite /Z !mulmxA mulmxK // [RHS]mxtrace_mulC !mulmxA mulmxV // mul1mx.
have Z0 : Z != 0.
  apply: contra X0 => /eqP ZZ; rewrite -[X](mulmxK Uu) -[X *m U](mulKVmx Uu) (mulmxA _ X) -/Z ZZ.
  by rewrite mulmx0 mul0mx.
have entry i j : Z j i = - (Z i j * D 0 j / D 0 i).
  have := congr1 (fun M : 'M_d => M i j) ZD; rewrite /= mul_mx_diag mul_diag_mx !mxE => ->.
  by rewrite mulNr opprK mulrAC divff ?gt_eqF // mul1r.
have -> : - \tr (Z *m Z) = \sum_i \sum_j Z i j ^+ 2 * (D 0 j / D 0 i).
  rewrite /mxtrace -sumrN; apply: eq_bigr => i _; rewrite mxE -sumrN; apply: eq_bigr => j _.
  by rewrite (entry i j) mulrN opprK expr2 !mulrA.
have ge i j : 0 <= Z i j ^+ 2 * (D 0 j / D 0 i) by rewrite mulr_ge0 ?sqr_ge0 // divr_ge0 // ltW.
rewrite lt_def; apply/andP; split; last by apply: sumr_ge0 => i _; apply: sumr_ge0.
apply: contra Z0; rewrite psumr_eq0 => [/allP a0 | i _]; last exact: sumr_ge0.
apply/eqP/matrixP => i j; rewrite [RHS]mxE; apply/eqP.
have /= := a0 i (mem_index_enum i); rewrite psumr_eq0 // => /allP /(_ j (mem_index_enum j)) /=.
by rewrite mulf_eq0 sqrf_eq0 (gt_eqF (divr_gt0 (D0 j) (D0 i))) orbF.
Qed.
End Factors.

(** Positive definiteness goes over to a larger ordered field. *)
Lemma definite_map (F R : realFieldType) (f : {rmorphism F -> R}) d (P : 'M[F]_d) :
  increasing f -> P^T = P -> positive_definite P -> positive_definite (map_mx f P).
Proof.
move=> inc Ps Pp; have [U [D [Uu D0 ->]]] := definite_factors Ps Pp.
apply: (@positive_factors_definite _ _ _ (map_mx f U) (map_mx f D)); split.
- by rewrite map_unitmx.
- by move=> i; rewrite mxE; apply: inc.
- by rewrite !map_mxM map_diag_mx map_trmx.
Qed.
