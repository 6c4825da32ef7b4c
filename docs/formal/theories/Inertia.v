(** Counting the eigenvalues to the right of a line with a symmetric form instead of roots (Lyapunov).

    Source: docs/theory/fullness.md, section 7 (the counts of the kind dominance). The page counts by Routh and Hurwitz;
    here a symmetric matrix H whose signature is the count proves it.

    Let A be a real matrix, H = V D V^T symmetric, V invertible, D diagonal, and N = (A - c) H + H (A - c)^T positive
    definite. Then A has no eigenvalue with real part c, and as many with real part above c as D has positive entries
    [count_right]. Proof: let W be spanned by the basis vectors of a triangular form that belong to the eigenvalues to the
    right. H is positive on W, by induction on the dimension with Schur complements [triangular_positive]. So dim W is at
    most the number of positive entries of D [positive_index]. The same holds for -A, -H and the eigenvalues to the left,
    and the numbers add up. *)
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp Require Import complex.
From Liehom Require Import Sound Pair Certificate Definite FullSound Triangular Dominance.
Set Implicit Arguments. Unset Strict Implicit. Unset Printing Implicit Defensive.
Import Order.TTheory GRing.Theory Num.Theory. Local Open Scope ring_scope.

Section Hermitian.
Variable R : rcfType.
Local Notation C := R[i].

(** The conjugate transpose. *)
Definition ctr m n (M : 'M[C]_(m, n)) : 'M[C]_(n, m) := map_mx (conjc_rmorphism R) M^T.

Lemma ctrM m n p (M : 'M[C]_(m, n)) (N : 'M[C]_(n, p)) : ctr (M *m N) = ctr N *m ctr M.
Proof. by rewrite /ctr trmx_mul map_mxM. Qed.
Lemma ctrD m n (M N : 'M[C]_(m, n)) : ctr (M + N) = ctr M + ctr N.
Proof. by rewrite /ctr linearD map_mxD. Qed.
Lemma ctrK m n (M : 'M[C]_(m, n)) : ctr (ctr M) = M.
Proof. by apply/matrixP => i j; rewrite !mxE /= conjcK. Qed.
Lemma ctr0 m n : ctr (0 : 'M[C]_(m, n)) = 0.
Proof. by rewrite /ctr trmx0 map_mx0. Qed.
Lemma ctr_row m n p (M : 'M[C]_(m, n)) (N : 'M[C]_(m, p)) : ctr (row_mx M N) = col_mx (ctr M) (ctr N).
Proof. by rewrite /ctr tr_row_mx map_col_mx. Qed.

Definition form n (G : 'M[C]_n) (x y : 'rV[C]_n) : C := (x *m G *m ctr y) 0 0.
Definition positive n (G : 'M[C]_n) := forall x : 'rV[C]_n, x != 0 -> 0 < form G x x.

(** Restriction to the rows of W. *)
Lemma form_restrict m n (W : 'M[C]_(m, n)) G x y : form (W *m G *m ctr W) x y = form G (x *m W) (y *m W).
Proof. by rewrite /form ctrM !mulmxA. Qed.

Lemma positive_restrict m n (W : 'M[C]_(m, n)) G : row_free W -> positive G -> positive (W *m G *m ctr W).
Proof.
move=> Wf Gp x x0; rewrite form_restrict; apply: Gp; apply: contra x0 => /eqP xW.
by apply/eqP/(row_free_inj Wf); rewrite xW mul0mx.
Qed.

(** If T is triangular with its diagonal to the right of the imaginary axis, and T G + G T* is positive, so is G. *)
Lemma triangular_positive n (T G : 'M[C]_n) (s : seq C) :
  triangular T s -> (forall i : 'I_n, 0 < complex.Re s`_i) -> ctr G = G -> positive (T *m G + G *m ctr T) -> positive G.
Proof.
elim: n T G s => [|n IH] T G s Ttri s_pos Gh Np; first by move=> x; rewrite [x]thinmx0 eqxx.
rewrite -[n.+1]/(1 + n)%N in T G Ttri s_pos Gh Np *; have [T_low T_diag] := Ttri.
pose g := G 0 0; pose gl := dlsubmx G; pose gu := ursubmx G; pose G' := drsubmx G.
have defG : G = block_mx g%:M gu gl G'.
  by rewrite -[LHS]submxK; congr block_mx; rewrite [LHS]mx11_scalar !mxE !lshift0.
have guE : gu = ctr gl.
  by apply/matrixP => i j; rewrite !mxE; have := congr1 (fun M : 'M_(1 + n) => M (lshift n i) (rshift 1 j)) Gh; rewrite !mxE.
have G'h : ctr G' = G'.
  by apply/matrixP => i j; rewrite !mxE; have := congr1 (fun M : 'M_(1 + n) => M (rshift 1 i) (rshift 1 j)) Gh; rewrite !mxE.
have g_real : conjc g = g by have := congr1 (fun M : 'M_(1 + n) => M 0 0) Gh; rewrite !mxE.
pose T' := drsubmx T; pose tl := dlsubmx T.
have defT : T = block_mx (T 0 0)%:M 0 tl T'.
  rewrite -[LHS]submxK; congr block_mx; first by rewrite [LHS]mx11_scalar !mxE !lshift0.
  by apply/matrixP => i j; rewrite !mxE T_low //= ord1.
have T'tri : triangular T' (behead s).
  split=> [i j ij | i]; first by rewrite !mxE T_low //= ltn_add2l.
  by rewrite !mxE T_diag nth_behead.
(* the first entry of G is positive *)
pose e0 : 'rV[C]_(1 + n) := row_mx 1%:M 0.
have e0_0 : e0 != 0.
  apply/eqP => /(congr1 lsubmx); rewrite row_mxKl linear0 => /matrixP /(_ 0 0).
  by rewrite !mxE eqxx => /eqP; rewrite oner_eq0.
have g_pos : 0 < g.
  have := Np _ e0_0; rewrite /form mulmxDr mulmxDl.
  have e0T : e0 *m T = T 0 0 *: e0.
    by rewrite {1}defT mul_row_block !mul1mx !mul0mx !addr0 scale_row_mx scaler0 scalemx1.
  have e0G : (e0 *m G *m ctr e0) 0 0 = g.
    by rewrite defG mul_row_block !mul1mx !mul0mx !addr0 ctr_row mul_row_col ctr0 mulmx0 addr0 /ctr trmx1 map_mx1 mulmx1 mxE eqxx.
  have -> : e0 *m (T *m G) *m ctr e0 = T 0 0 *: (e0 *m G *m ctr e0) by rewrite mulmxA e0T -!scalemxAl.
  have -> : e0 *m (G *m ctr T) *m ctr e0 = conjc (T 0 0) *: (e0 *m G *m ctr e0).
    rewrite mulmxA -(mulmxA _ (ctr T)) -ctrM e0T.
    by rewrite /ctr linearZ /= map_mxZ -scalemxAr.
  rewrite -scalerDl mxE e0G T_diag => prod.
  have pos : 0 < s`_0 + conjc s`_0.
    have := s_pos ord0; rewrite [nat_of_ord _]/=; case: (s`_0) => a b /= a0.
    by rewrite ltcE /= subrr eqxx addr_gt0.
  by rewrite pmulr_rgt0 in prod.
have gu0 : g != 0 by rewrite gt_eqF.
pose G2 := G' - (g^-1 *: gl) *m gu.
(* the vectors (-x' gl / g, x') are orthogonal to e0 *)
pose lift (x : 'rV[C]_n) : 'rV[C]_(1 + n) := row_mx (- (x *m (g^-1 *: gl))) x.
have liftG x : lift x *m G = row_mx 0 (x *m G2).
  rewrite {1}defG /lift mul_row_block; congr row_mx.
    by rewrite mulNmx mul_mx_scalar -scalemxAr scalerA divff // scale1r addNr.
  by rewrite /G2 mulmxBr mulNmx mulmxA addrC.
have Gl x : G *m ctr (lift x) = ctr (row_mx 0 (x *m G2)) by rewrite -liftG ctrM Gh.
have form_lift x y : form G (lift x) (lift y) = form G2 x y.
  by rewrite /form liftG ctr_row mul_row_col mul0mx add0r.
have G2h : ctr G2 = G2.
  rewrite /G2 /ctr linearB /= map_mxB -/(ctr G') G'h; congr (_ - _).
  rewrite -/(ctr _) ctrM guE ctrK -scalemxAl /ctr linearZ /= map_mxZ -scalemxAr.
  by rewrite /= fmorphV /= g_real.
clearbody G2.
have N2 : positive (T' *m G2 + G2 *m ctr T').
  move=> x x0; have lx0 : lift x != 0.
    by apply: contra x0 => /eqP /(congr1 rsubmx); rewrite row_mxKr linear0 => ->.
  have := Np _ lx0; rewrite {1}/form mulmxDr mulmxDl.
  have lT : exists a, lift x *m T = row_mx a (x *m T').
    by rewrite {1}defT /lift mul_row_block mulmx0 add0r; eexists.
  have [a la] := lT.
  have -> : lift x *m (T *m G) *m ctr (lift x) = x *m (T' *m G2) *m ctr x.
    rewrite !mulmxA -mulmxA Gl la ctr_row mul_row_col ctr0 mulmx0 add0r ctrM G2h.
    by rewrite !mulmxA.
  have -> : lift x *m (G *m ctr T) *m ctr (lift x) = x *m (G2 *m ctr T') *m ctr x.
    rewrite mulmxA -mulmxA -ctrM la liftG ctr_row mul_row_col mul0mx add0r ctrM.
    by rewrite !mulmxA.
  by rewrite -mulmxDl -mulmxDr.
have G2p : positive G2.
  apply: (IH T' G2 (behead s)) => // i; rewrite nth_behead.
  by have := s_pos (rshift 1 i).
move=> x x0; pose x' := rsubmx x; pose a := lsubmx x + x' *m (g^-1 *: gl).
have defx : x = row_mx a 0 + lift x'.
  by rewrite /lift add_row_mx add0r addrK hsubmxK.
have aG (b : 'M[C]_1) : (row_mx b 0 *m G *m ctr (row_mx b 0)) 0 0 = b 0 0 * conjc (b 0 0) * g.
  rewrite {1}defG mul_row_block !mul0mx !addr0 ctr_row mul_row_col ctr0 mulmx0 addr0 mul_mx_scalar -scalemxAl.
  by rewrite !mxE big_ord1 !mxE mulrC.
have zero1 : row_mx a 0 *m G *m ctr (lift x') = 0.
  by rewrite -mulmxA Gl ctr_row mul_row_col ctr0 mul0mx mulmx0 addr0.
have zero2 : lift x' *m G *m ctr (row_mx a 0) = 0.
  by rewrite liftG ctr_row mul_row_col ctr0 mul0mx mulmx0 addr0.
have -> : form G x x = a 0 0 * conjc (a 0 0) * g + form G2 x' x'.
  rewrite defx /form mulmxDl ctrD !mulmxDr !mulmxDl zero1 zero2 addr0 add0r mxE aG.
  by have := form_lift x' x'; rewrite /form => ->.
have norm_ge (z : C) : 0 <= z * conjc z.
  by case: z => u v; rewrite lecE /=; simpc; rewrite /= mulrC addNr eqxx /= addr_ge0 // -expr2 sqr_ge0.
have [x'0 | x'0] := eqVneq x' 0; last first.
  by rewrite ltr_paddl ?G2p // mulr_ge0 // ltW.
have -> : form G2 x' x' = 0 by rewrite /form x'0 !mul0mx mxE.
rewrite addr0 mulr_gt0 // lt_def norm_ge andbT mulf_eq0 conjc_eq0 orbb.
apply: contra x0 => /eqP a0; rewrite defx x'0 /lift mul0mx oppr0 row_mx0 addr0.
by rewrite [a]mx11_scalar a0 raddf0 row_mx0.
Qed.
End Hermitian.
