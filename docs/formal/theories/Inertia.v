(** Counting the eigenvalues to the right of a line with a symmetric form instead of roots (Lyapunov).

    Source: docs/theory/fullness.md, section 7 (the counts of the kind dominance). The page counts by Routh and Hurwitz;
    here a symmetric matrix H whose signature is the count proves it.

    Let A be a real matrix, H = V D V^T symmetric, V invertible, D diagonal, and N = (A - c) H + H (A - c)^T positive
    definite. Then A has no eigenvalue with real part c, and as many with real part above c as D has positive entries
    [count_right]. Proof: let W be spanned by the basis vectors of a triangular form that belong to the eigenvalues to
    the right. H is positive on W, by induction on the dimension with Schur complements [triangular_positive]. So dim W
    is at most the number of positive entries of D [positive_index]. The same holds for -A, -H and the eigenvalues to
    the left, and the numbers add up. [dominance_count_sound] is Theorem 4 with three such counts; no eigenvalue appears
    in it.

    Such an H exists whenever A has no eigenvalue on the line. If moreover no two eigenvalues are mirror images in it,
    the equation N = 1 has one solution H. *)
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp Require Import complex.
From Liehom Require Import Sound Pair Certificate Definite FullSound Triangular Dominance.
Set Implicit Arguments. Unset Strict Implicit. Unset Printing Implicit Defensive.
Import Order.TTheory GRing.Theory Num.Theory. Local Open Scope ring_scope.
(** The real numbers in R[i]. *)
Local Notation inC R := (ComplexField.real_complex_rmorphism R).

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
  apply/matrixP => i j; rewrite !mxE.
  by have := congr1 (fun M : 'M_(1 + n) => M (lshift n i) (rshift 1 j)) Gh; rewrite !mxE.
have G'h : ctr G' = G'.
  apply/matrixP => i j; rewrite !mxE.
  by have := congr1 (fun M : 'M_(1 + n) => M (rshift 1 i) (rshift 1 j)) Gh; rewrite !mxE.
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
    rewrite defG mul_row_block !mul1mx !mul0mx !addr0 ctr_row mul_row_col ctr0 mulmx0 addr0.
    by rewrite /ctr trmx1 map_mx1 mulmx1 mxE eqxx.
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

(** The value of a diagonal form. *)
Lemma form_diag n (V : 'M[C]_n) (D : 'rV[R]_n) (x : 'rV[C]_n) :
  form (V *m diag_mx (map_mx (inC R) D) *m ctr V) x x =
  \sum_i (D 0 i)%:C%C * ((x *m V) 0 i * conjc ((x *m V) 0 i)).
Proof.
rewrite form_restrict /form mul_mx_diag mxE; apply: eq_bigr => i _.
by rewrite !mxE mulrAC [RHS]mulrC.
Qed.

Lemma norm_ge0 (z : C) : 0 <= z * conjc z.
Proof. by case: z => u v; rewrite lecE /=; simpc; rewrite /= mulrC addNr eqxx /= addr_ge0 // -expr2 sqr_ge0. Qed.

Lemma norm_eq0 (z : C) : (z * conjc z == 0) = (z == 0).
Proof. by rewrite mulf_eq0 conjc_eq0 orbb. Qed.

(** The rank of a positive form on a subspace is at most the number of positive entries of the diagonal. *)
Lemma positive_index m n (W : 'M[C]_(m, n)) (V : 'M[C]_n) (D : 'rV[R]_n) :
  positive (W *m (V *m diag_mx (map_mx (inC R) D) *m ctr V) *m ctr W) ->
  (m <= #|[pred i | (0 < D 0 i)%R]|)%N.
Proof.
move=> pos; pose K : 'M[C]_n := diag_mx (\row_i (0 < D 0 i)%R%:R).
have rK : (\rank K <= #|[pred i | (0 < D 0 i)%R]|)%N.
  rewrite /K diag_mx_sum_delta -sum1_card [X in (_ <= X)%N]big_mkcond /=.
  apply: (big_ind2 (fun (A : 'M[C]_n) k => (\rank A <= k)%N)).
  - by rewrite mxrank0.
  - by move=> A a B b Aa Bb; apply: leq_trans (mxrank_add _ _) _; apply: leq_add.
  move=> i _; rewrite mxE inE; case: (0 < D 0 i); last by rewrite scale0r mxrank0.
  by rewrite scale1r mxrank_delta.
suff free : row_free (W *m V *m K) by rewrite -(eqP free); apply: leq_trans (mxrankM_maxr _ _) rK.
apply/inj_row_free => x xK; apply/eqP; apply: contraT => /pos; rewrite form_restrict form_diag.
set y := x *m W *m V; have yK i : 0 < D 0 i -> y 0 i = 0.
  move=> Di; have := congr1 (fun v : 'rV_n => v 0 i) xK; rewrite /= !mulmxA -/y mul_mx_diag !mxE Di mulr1.
  by [].
move=> gt0; rewrite -(ltxx (0 : C)); apply: (lt_le_trans gt0).
rewrite -oppr_ge0 -sumrN; apply: sumr_ge0 => i _.
have [Di | Di] := ltP 0 (D 0 i); first by rewrite yK // mul0r mulr0 oppr0.
rewrite -mulNr mulr_ge0 ?norm_ge0 //.
by rewrite lecE /= !oppr0 eqxx /= oppr_ge0.
Qed.

(** A symmetric positive definite matrix is positive on complex vectors. *)
Lemma positive_real n (N : 'M[R]_n) : N^T = N -> positive_definite N ->
  positive (map_mx (inC R) N).
Proof.
move=> Ns Np x x0; have [U [D [Uu D0 ->]]] := definite_factors Ns Np; set toC := inC R.
have -> : map_mx toC (U *m diag_mx D *m U^T) = map_mx toC U *m diag_mx (map_mx toC D) *m ctr (map_mx toC U).
  rewrite !map_mxM map_diag_mx; congr (_ *m _); apply/matrixP => i j; rewrite !mxE /=.
  by rewrite oppr0.
rewrite form_diag; have : x *m map_mx toC U != 0.
  apply: contra x0 => /eqP e; have Cu : map_mx toC U \in unitmx by rewrite map_unitmx.
  by rewrite -[x](mulmxK Cu) e mul0mx.
move: (x *m _) => y y0; have Dc i : 0 < (D 0 i)%:C%C by rewrite ltcE /= eqxx D0.
have ge i : true -> 0 <= (D 0 i)%:C%C * (y 0 i * conjc (y 0 i)) by move=> _; rewrite mulr_ge0 ?norm_ge0 // ltW.
rewrite lt_def sumr_ge0 // andbT psumr_eq0 //; apply: contra y0 => /allP all0.
apply/eqP/rowP => i; rewrite [RHS]mxE; apply/eqP.
by have := all0 i (mem_index_enum i); rewrite /= mulf_eq0 gt_eqF //= norm_eq0.
Qed.

(** The eigenvalues to the right of c are at most as many as the positive entries of D. *)
Lemma right_le d (A U T H V : 'M[C]_d) (D : 'rV[R]_d) (s : seq C) (p : nat) (c : R) :
  U \in unitmx -> U *m A = T *m U -> triangular T s ->
  (p <= d)%N -> (forall i : 'I_d, (i < p)%N -> c < complex.Re s`_i) ->
  H = V *m diag_mx (map_mx (inC R) D) *m ctr V -> ctr H = H ->
  positive ((A - (c%:C%C)%:M) *m H + H *m ctr (A - (c%:C%C)%:M)) ->
  (p <= #|[pred i | (0 < D 0 i)%R]|)%N.
Proof.
move=> Uu UA Ttri pd s_right defH Hh Np; have e := subnKC pd; move: e; move: (d - p)%N => q e.
subst d; have [T_low T_diag] := Ttri; set A' := A - _ in Np; set T' := ulsubmx T - (c%:C%C)%:M.
pose W := usubmx U; have WA : W *m A' = T' *m W.
  have Tur : ursubmx T = 0.
    by apply/matrixP => i j; rewrite !mxE T_low //= (leq_trans (ltn_ord i)) // leq_addr.
  have := congr1 usubmx UA; rewrite -mul_usub_mx /W -/W => WA0.
  rewrite /A' /T' mulmxBr mulmxBl scalar_mxC; congr (_ - _); rewrite WA0.
  by rewrite -{1}[T]submxK -{1}[U]vsubmxK mul_block_col Tur mul0mx addr0 col_mxKu.
have Wf : row_free W.
  apply/row_freeP; exists (lsubmx (invmx U)).
  by rewrite mulmx_lsub /W mul_usub_mx mulmxV // (scalar_mx_block p q) /block_mx col_mxKu row_mxKl.
apply: (@positive_index _ _ W V); rewrite -defH.
apply: (@triangular_positive _ T' _ (mkseq (fun i => s`_i - c%:C%C) p)).
- split=> [i j ij | i]; first by rewrite !mxE T_low // -val_eqE ltn_eqF // subr0.
  by rewrite !mxE T_diag eqxx nth_mkseq.
- move=> i; rewrite nth_mkseq //; have := s_right (lshift q i) (ltn_ord i).
  by case: (s`_ _) => a b /=; rewrite subr_gt0.
- by rewrite !ctrM ctrK Hh mulmxA.
have -> : T' *m (W *m H *m ctr W) + W *m H *m ctr W *m ctr T' =
    W *m (A' *m H + H *m ctr A') *m ctr W; last exact: positive_restrict.
by rewrite mulmxDr mulmxDl !mulmxA WA -!mulmxA -!ctrM WA.
Qed.
End Hermitian.

(** The count: H = V D V^T proves that A has m eigenvalues to the right of c. *)
Definition right_count (F : realFieldType) d (A : 'M[F]_d) (c : F) (m : nat) :=
  exists H V D, [/\ V \in unitmx, H = V *m diag_mx D *m V^T,
    positive_definite ((A - c%:M) *m H + H *m (A - c%:M)^T) & #|[pred i | 0 < (D : 'rV[F]_d) 0 i]| = m].

Theorem count_right (R : rcfType) d (A : 'M[R]_d) (c : R) (m : nat) (s : seq R[i]) : right_count A c m ->
  char_poly (map_mx (inC R) A) = \prod_(z <- s) ('X - z%:P) ->
  count (fun z => (c < complex.Re z)%R) s = m /\ (forall z, z \in s -> complex.Re z != c).
Proof.
move=> [H [V [D [Vu defH Np <-]]]] es; set toC := inC R in es *.
have sz := size_eigenvalues es.
have ctr_real a b (M : 'M[R]_(a, b)) : ctr (map_mx toC M) = map_mx toC M^T.
  by apply/matrixP => i j; rewrite !mxE /= oppr0.
have Hs : H^T = H by rewrite defH !trmx_mul trmxK tr_diag_mx mulmxA.
pose N (A1 H1 : 'M[R]_d) (c1 : R) := (A1 - c1%:M) *m H1 + H1 *m (A1 - c1%:M)^T.
have CN A1 H1 c1 : H1^T = H1 -> positive_definite (N A1 H1 c1) ->
    positive ((map_mx toC A1 - (c1%:C%C)%:M) *m map_mx toC H1 + map_mx toC H1 *m ctr (map_mx toC A1 - (c1%:C%C)%:M)).
  move=> H1s N1p; have -> : (c1%:C%C)%:M = map_mx toC (c1%:M : 'M_d) by rewrite map_scalar_mx.
  rewrite -map_mxB ctr_real -!map_mxM -map_mxD; apply: positive_real N1p.
  by rewrite /N linearD /= !trmx_mul trmxK H1s addrC.
have CH H1 (D1 : 'rV[R]_d) : H1 = V *m diag_mx D1 *m V^T ->
    map_mx toC H1 = map_mx toC V *m diag_mx (map_mx toC D1) *m ctr (map_mx toC V).
  by move=> ->; rewrite ctr_real !map_mxM map_diag_mx.
pose right z := (c < complex.Re z)%R; pose left z := (complex.Re z < c)%R.
have le_right : (count right s <= #|[pred i | (0 < D 0 i)%R]|)%N.
  have [U [T [Uu UA Ttri]]] : exists U T, [/\ U \in unitmx, U *m map_mx toC A = T *m U & triangular T (first right s)].
    by apply: triangular_form; rewrite first_prod.
  apply: (right_le Uu UA Ttri _ _ (CH _ _ defH) _ (CN _ _ _ Hs Np)).
  - by rewrite -sz count_size.
  - move=> i ip; have [|_ e] := @nth_first _ 0 right s i; first by rewrite sz.
    by rewrite -[_ < _]/(right _) e.
  - by rewrite ctr_real Hs.
have le_left : (count left s <= #|[pred i | (D 0 i < 0)%R]|)%N.
  have [U [T [Uu UA [T_low T_diag]]]] : exists U T,
      [/\ U \in unitmx, U *m map_mx toC A = T *m U & triangular T (first left s)].
    by apply: triangular_form; rewrite first_prod.
  have size_first : size (first left s) = d by rewrite /first size_cat !size_filter count_predC.
  have NT : triangular (- T) [seq - z | z <- first left s].
    split=> [i j ij | i]; first by rewrite mxE T_low // oppr0.
    by rewrite mxE T_diag (nth_map 0) // size_first.
  have UA' : U *m map_mx toC (- A) = (- T) *m U by rewrite map_mxN mulmxN UA mulNmx.
  have Hs' : (- H)^T = - H by rewrite linearN /= Hs.
  have defH' : - H = V *m diag_mx (- D) *m V^T by rewrite defH linearN /= mulmxN mulNmx.
  have Np' : positive_definite (N (- A) (- H) (- c)).
    have neg : - A - (- c)%:M = - (A - c%:M).
      by apply/matrixP => i j; rewrite !mxE mulNrn opprB opprK addrC.
    by rewrite /N neg [(- (A - _))^T]linearN /= !mulmxN !mulNmx !opprK.
  rewrite (eq_card (_ : _ =i [pred i | (0 < (- D) 0 i)%R])) => [|i]; last by rewrite !inE mxE oppr_gt0.
  apply: (right_le Uu UA' NT _ _ (CH _ _ defH') _ (CN _ _ _ Hs' Np')).
  - by rewrite -sz count_size.
  - move=> i ip; have [|_ e] := @nth_first _ 0 left s i; first by rewrite sz.
    rewrite (nth_map 0) ?size_first //; have : left (first left s)`_i by rewrite e.
    by rewrite /left; case: (_`_ _) => a b /=; rewrite ltr_opp2.
  - by rewrite ctr_real Hs'.
have on_line z : z \in s -> complex.Re z != c.
  move=> zs; apply/eqP => Rz; have : root (char_poly (map_mx toC A)) z by rewrite es root_prod_XsubC.
  rewrite -eigenvalue_root_char => /eigenvalueP [v vA v0].
  have := CN _ _ _ Hs Np v v0; rewrite /form mulmxDr mulmxDl.
  have vA' : v *m (map_mx toC A - (c%:C%C)%:M) = (z - c%:C%C) *: v by rewrite mulmxBr vA mul_mx_scalar scalerBl.
  rewrite mulmxA vA' -!scalemxAl mulmxA -(mulmxA _ (ctr _)) -ctrM vA'.
  have -> : ctr ((z - c%:C%C) *: v) = - (z - c%:C%C) *: ctr v.
    rewrite /ctr linearZ /= map_mxZ; congr (_ *: _); move: Rz; case: (z) => a b /= ->.
    by apply/eqP; rewrite eq_complex /= !subrr oppr0 !eqxx.
  by rewrite -scalemxAr scaleNr subrr mxE ltxx.
split=> //; apply/eqP; rewrite eqn_leq le_right /=.
have tot : (count right s + count left s = d)%N.
  rewrite -sz -(count_predC right s); congr (_ + _)%N; apply: eq_in_count => z zs.
  by rewrite /= /right /left -leNgt le_eqVlt (negPf (on_line z zs)).
have disj : (#|[pred i | (0 < D 0 i)%R]| + #|[pred i | (D 0 i < 0)%R]| <= d)%N.
  rewrite -cardUI [X in (_ + X)%N]eq_card0 ?addn0; last first.
    by move=> i; rewrite !inE; case: (ltgtP 0 (D 0 i)).
  by rewrite -[X in (_ <= X)%N]card_ord max_card.
rewrite -(leq_add2r (count left s)) tot; apply: leq_trans disj.
by rewrite leq_add2l.
Qed.

(** Change of field. *)
Lemma map_right_count (F R : realFieldType) (f : {rmorphism F -> R}) d (A : 'M[F]_d) c m : increasing f ->
  right_count A c m -> right_count (map_mx f A) (f c) m.
Proof.
move=> inc [H [V [D [Vu defH Np <-]]]]; exists (map_mx f H), (map_mx f V), (map_mx f D); split.
- by rewrite map_unitmx.
- by rewrite defH !map_mxM map_diag_mx map_trmx.
- have Hs : H^T = H by rewrite defH !trmx_mul trmxK tr_diag_mx mulmxA.
  rewrite -map_scalar_mx -map_mxB map_trmx -!map_mxM -map_mxD; apply: definite_map => //.
  by rewrite linearD /= !trmx_mul trmxK Hs addrC.
apply: eq_card => i; rewrite !inE mxE; apply/idP/idP => [|/inc //].
case: (ltgtP 0 (D 0 i)) => // [Di | <-]; last by rewrite rmorph0 ltxx.
by have := inc (- D 0 i); rewrite oppr_gt0 rmorphN oppr_gt0 => /(_ Di) lt0; rewrite ltNge ltW.
Qed.

Lemma eigenvalues_exist (C : closedFieldType) n (A : 'M[C]_n) : exists s, char_poly A = \prod_(z <- s) ('X - z%:P).
Proof.
have [s e] := closed_field_poly_normal (char_poly A); exists s.
by rewrite [LHS]e (eqP (char_poly_monic A)) scale1r.
Qed.

(** Kind dominance with three counts proved by forms, over the field F of the pair: no eigenvalue appears. *)
Theorem dominance_count_sound (F : realFieldType) (R : rcfType) (f : {rmorphism F -> R}) n k d (c : 'I_n -> 'M[F]_n)
    (h : 'M[F]_(k, n)) (Q : 'M[F]_(n, d)) (E : 'M[F]_(d, n)) (X : 'rV[F]_n) (a : F) l (B : 'I_l -> 'M[F]_d)
    (M : 'M[F]_l) (cut eps : F) (top r : nat) :
  increasing f -> valid_pair c h Q E -> 0 < eps ->
  (forall q, exists u : 'I_l -> F, rho c h Q E q = \sum_j u j *: B j) ->
  (forall j, B j *m isotropy c Q E X - isotropy c Q E X *m B j = \sum_g M j g *: B g) ->
  right_count (isotropy c Q E X - a%:M) cut top -> right_count (isotropy c Q E X - a%:M) (cut - eps) top ->
  right_count M (- eps) r -> (0 < top)%N -> (top + (l - r) < d)%N -> ~ full_pair (map_pair f c) (map_mx f h).
Proof.
move=> inc ok eps0 rhoB adB /(map_right_count inc) ct /(map_right_count inc) cg /(map_right_count inc) cM top0 lt.
have [s es] := eigenvalues_exist (map_mx (inC R) (map_mx f (isotropy c Q E X - a%:M))).
have [t et] := eigenvalues_exist (map_mx (inC R) (map_mx f M)).
have [n_top _] := count_right ct es; have [n_gap on_gap] := count_right cg es; have [n_M _] := count_right cM et.
apply: (dominance_pair_sound (a := a) (cut := cut) inc ok eps0 rhoB adB es et) => [z zs||].
- apply/negP => /andP [low high]; have : z \in filter (fun z => (f (cut - eps) < complex.Re z)%R) s.
    by rewrite mem_filter zs andbT lt_neqAle rmorphB low andbT eq_sym -rmorphB on_gap.
  have /allP al : all (fun z => (f cut < complex.Re z)%R) (filter (fun z => (f (cut - eps) < complex.Re z)%R) s).
    rewrite all_count size_filter n_gap -n_top count_filter; apply/eqP; apply: eq_count => w /=.
    by apply/andP/idP => [[] // | lw]; split=> //; apply: lt_trans lw; rewrite rmorphB ltr_subl_addr ltr_addl inc.
  by move/al; rewrite /= ltNge high.
- by move: top0; rewrite -n_top.
suff e : count (fun z => (complex.Re z <= - f eps)%R) t = (l - r)%N by move: lt; rewrite -e -n_top.
rewrite -n_M -(size_eigenvalues et) -(count_predC (fun z => (f (- eps) < complex.Re z)%R) t) addKn.
by apply: eq_count => z /=; rewrite rmorphN -leNgt.
Qed.
