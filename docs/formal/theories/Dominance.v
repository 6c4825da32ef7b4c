(** Soundness of the kind dominance: an element of h with too small a top space.

    Source: docs/theory/fullness.md, section 3, Theorem 4, soundness.

    R is a real closed field, and eigenvalues are in R[i]. A is rho(X) up to a scalar, and M is the matrix of
    B -> B A - A B on a family B_1, ..., B_l that spans rho(h). (Row vectors reverse products, so this is ad rho(X).)

    Put A in triangular form with the eigenvalues of real part above the cut first, and let W be the span of their basis
    vectors [top_mx]. By the gap, if v A - z v lies in W for some z with Re z >= cut - eps, then v lies in W [top_back].
    This one property gives the rest:
    - W is closed under conjugation, so it contains a real vector x != 0 [top_real];
    - put M in triangular form with the real parts above -eps first; the combinations of the B_j for these map W into W
      [top_invariant], and the others are as many as the eigenvalues of M with real part at most -eps.
    So rho(h) x + R x has dimension at most dim W + that number [dominance_at in Sound.v]. *)
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp Require Import complex ring.
From Liehom Require Import Sound Pair Certificate FullSound Triangular.
Set Implicit Arguments. Unset Strict Implicit. Unset Printing Implicit Defensive.
Import Order.TTheory GRing.Theory Num.Theory. Local Open Scope ring_scope.
(** The real numbers in R[i]. *)
Local Notation inC R := (ComplexField.real_complex_rmorphism R).

(** A row of T U for triangular T. *)
Lemma triangular_row (F : fieldType) n m (T : 'M[F]_n) s (U : 'M[F]_(n, m)) (i : 'I_n) : triangular T s ->
  row i (T *m U) = s`_i *: row i U + \sum_(l < n | (l < i)%N) T i l *: row l U.
Proof.
move=> [low diag]; rewrite row_mul mulmx_sum_row (bigD1 i) //= mxE diag; congr (_ + _).
rewrite big_mkcond [RHS]big_mkcond; apply: eq_bigr => l _; rewrite mxE -val_eqE /=.
by case: (ltngtP l i) => //= il; rewrite low // scale0r.
Qed.

Section Top.
Variables (R : rcfType) (d p : nat) (A U T : 'M[R[i]]_d) (s : seq R[i]) (low : R).
Hypotheses (U_unit : U \in unitmx) (UA : U *m A = T *m U) (T_tri : triangular T s).
Hypothesis s_low : forall i : 'I_d, (p <= i)%N -> complex.Re s`_i < low.

Definition top_mx : 'M[R[i]]_d := pid_mx p *m U.
Local Notation W := top_mx.

Lemma row_top i : row i W = (i < p)%:R *: row i U.
Proof.
apply/rowP => j; rewrite !mxE (bigD1 i) //= big1 => [|l li]; last by rewrite !mxE val_eqE eq_sym (negPf li) mul0r.
by rewrite !mxE eqxx addr0.
Qed.

Lemma topP (v : 'rV[R[i]]_d) : reflect (forall j : 'I_d, (p <= j)%N -> (v *m invmx U) 0 j = 0) (v <= W)%MS.
Proof.
apply: (iffP idP) => [/submxP [u ->] j pj | v0].
  rewrite /W !mulmxA mulmxK // mxE big1 // => l _; rewrite !mxE.
  by case: eqP => [-> | _]; rewrite ?(ltnNge, pj) ?andbF mulr0.
rewrite -[v](mulmxKV U_unit) /W; move: (v *m invmx U) v0 => y v0.
have -> : y = y *m pid_mx p.
  apply/rowP => j; rewrite [RHS]mxE (bigD1 j) //= big1 => [|l lj]; last by rewrite !mxE val_eqE (negPf lj) mulr0.
  rewrite !mxE eqxx /= addr0; case: ltnP => pj; rewrite ?mulr1 //.
  by rewrite mulr0 v0.
by rewrite -mulmxA submxMl.
Qed.

Lemma top_row (i : 'I_d) : (i < p)%N -> (row i U <= W)%MS.
Proof. by move=> ip; have := row_sub i W; rewrite row_top ip scale1r. Qed.

Lemma rank_top : (p <= d)%N -> \rank W = p.
Proof. by move=> pd; rewrite mxrankMfree ?row_free_unit // rank_pid_mx. Qed.

(** Induction from the last coordinate down: the entries p, p + 1, ... of v in the basis U vanish. *)
Lemma top_back (v : 'rV[R[i]]_d) z : low <= complex.Re z -> (v *m A - z *: v <= W)%MS -> (v <= W)%MS.
Proof.
move=> lz /topP vW; apply/topP; set y := v *m invmx U.
have yT (j : 'I_d) : (p <= j)%N -> (y *m T) 0 j = z * y 0 j.
  move=> pj; apply/eqP; rewrite -subr_eq0; apply/eqP; rewrite -[RHS](vW j pj) mulmxBl -scalemxAl -/y.
  have vU : v = y *m U by rewrite mulmxKV.
  have -> : v *m A *m invmx U = y *m T by rewrite {1}vU -(mulmxA y) UA mulmxA mulmxK.
  by rewrite !mxE.
have [T_low T_diag] := T_tri.
suff H n (j : 'I_d) : (d - j <= n)%N -> (p <= j)%N -> y 0 j = 0 by move=> j; apply: (H (d - j)%N).
elim: n j => [|n IH] j; first by rewrite leqn0 subn_eq0 leqNgt ltn_ord.
move=> jn pj; have := yT j pj; rewrite mxE (bigD1 j) //= big1 => [|l lj]; last first.
  have [jl | lj'] := ltnP j l; last by rewrite T_low ?mulr0 // ltn_neqAle lj' andbT.
  rewrite IH ?mul0r ?(leq_trans pj (ltnW jl)) //; rewrite -ltnS; apply: leq_trans jn.
  by rewrite ltn_sub2l.
rewrite addr0 T_diag mulrC => /eqP; rewrite -subr_eq0 -mulrBl mulf_eq0 => /orP [|/eqP //].
by rewrite subr_eq0 => /eqP e; move: (s_low pj); rewrite e ltNge lz.
Qed.

(** Vectors g_i, i < p, with g_i A = z_i g_i modulo W and the earlier g_l lie in W. *)
Lemma top_family (g : 'I_d -> 'rV[R[i]]_d) (z : 'I_d -> R[i]) (a : 'I_d -> 'I_d -> R[i]) :
  (forall i : 'I_d, (i < p)%N -> low <= complex.Re (z i)) ->
  (forall i : 'I_d, (i < p)%N -> (g i *m A - (z i *: g i + \sum_(l < d | (l < i)%N) a i l *: g l) <= W)%MS) ->
  forall i : 'I_d, (i < p)%N -> (g i <= W)%MS.
Proof.
move=> z_low step; suff H n (i : 'I_d) : (i < n)%N -> (i < p)%N -> (g i <= W)%MS by move=> i; apply: (H i.+1).
elim: n i => // n IH i; rewrite ltnS => le_in ip; apply: (top_back (z_low i ip)).
set S := \sum_(l < d | (l < i)%N) a i l *: g l.
have -> : g i *m A - z i *: g i = g i *m A - (z i *: g i + S) + S by rewrite opprD addrA subrK.
apply: addmx_sub; first exact: step.
apply: summx_sub => l li; apply: scalemx_sub; apply: IH; first exact: leq_trans li le_in.
exact: ltn_trans li ip.
Qed.

Hypothesis s_top : forall i : 'I_d, (i < p)%N -> low <= complex.Re s`_i.

Lemma row_A (i : 'I_d) : row i U *m A = s`_i *: row i U + \sum_(l < d | (l < i)%N) T i l *: row l U.
Proof. by rewrite -row_mul UA (triangular_row _ _ T_tri). Qed.

(** W contains a real vector, if A is real. *)
Lemma top_conj (A0 : 'M[R]_d) : A = map_mx (inC R) A0 ->
  forall i : 'I_d, (i < p)%N -> (map_mx (conjc_rmorphism R) (row i U) <= W)%MS.
Proof.
move=> eA; have A_conj : map_mx (conjc_rmorphism R) A = A.
  by rewrite eA; apply/matrixP => i j; rewrite !mxE /= oppr0.
apply: (@top_family _ (fun i => conjc_rmorphism R s`_i) (fun i l => conjc_rmorphism R (T i l))) => i ip.
  by rewrite /=; case: (s`_i) (s_top ip).
rewrite -{1}A_conj -map_mxM row_A map_mxD map_mxZ (raddf_sum (map_mx_additive _ _ _)) /=.
by under [X in _ + X - _]eq_bigr do rewrite map_mxZ; rewrite subrr sub0mx.
Qed.

Lemma top_real (A0 : 'M[R]_d) : A = map_mx (inC R) A0 -> (0 < p <= d)%N ->
  exists2 x : 'rV[R]_d, x != 0 & (map_mx (inC R) x <= W)%MS.
Proof.
move=> eA /andP [p0 pd]; pose i0 := Ordinal (leq_trans p0 pd).
have wW := top_row (i := i0) p0; have cW := top_conj eA (i := i0) p0.
set w := row i0 U in wW cW; set w' := map_mx (conjc_rmorphism R) w in cW.
pose x := map_mx (@complex.Re R) w; pose y := map_mx (@complex.Im R) w.
have two : (2%:R : R[i]) != 0 by rewrite pnatr_eq0.
have double (z : 'rV[R]_d) : (map_mx (inC R) (z + z) <= W)%MS ->
    (map_mx (inC R) z <= W)%MS.
  set f := map_mx _ => zW; have -> : f z = 2%:R^-1 *: f (z + z).
    by rewrite /f map_mxD -[X in _ *: X]mulr2n -scaler_nat scalerK.
  exact: scalemx_sub.
have xW : (map_mx (inC R) x <= W)%MS.
  apply: double; suff -> : map_mx (inC R) (x + x) = w + w' by apply: addmx_sub.
  apply/rowP => j; rewrite !mxE; case: (U i0 j) => a b /=; apply/eqP; rewrite eq_complex /=.
  by apply/andP; split; apply/eqP; ring.
have yW : (map_mx (inC R) y <= W)%MS.
  apply: double; suff -> : map_mx (inC R) (y + y) = (0 +i* (-1))%C *: (w - w').
    by apply/scalemx_sub/addmx_sub; rewrite ?eqmx_opp.
  apply/rowP => j; rewrite !mxE; case: (U i0 j) => a b /=; apply/eqP; rewrite eq_complex /=.
  by apply/andP; split; apply/eqP; ring.
have w0 : w != 0.
  apply/eqP => w0; have := congr1 (fun v => v *m invmx U) w0.
  by rewrite /= /w rowE mulmxK // mul0mx => /rowP /(_ i0); rewrite !mxE !eqxx => /eqP; rewrite oner_eq0.
have [x0 | x0] := eqVneq x 0; last by exists x.
exists y => //; apply: contra w0 => /eqP y0; apply/eqP/rowP => j.
have := congr1 (fun v : 'rV_d => v 0 j) x0; have := congr1 (fun v : 'rV_d => v 0 j) y0.
by rewrite !mxE; case: (U i0 j) => a b /= -> ->.
Qed.

(** The combinations of the B_j for the eigenvalues of M with large real part map W into W. *)
Lemma top_invariant l (B : 'I_l -> 'M[R[i]]_d) (S : 'M[R[i]]_l) (t : seq R[i]) (r : nat) :
  triangular S t -> (forall j, B j *m A - A *m B j = \sum_g S j g *: B g) ->
  (forall (i : 'I_d) (j : 'I_l), (i < p)%N -> (j < r)%N -> low <= complex.Re (s`_i + t`_j)) ->
  forall j : 'I_l, (j < r)%N -> (W *m B j <= W)%MS.
Proof.
move=> [S_low S_diag] adB gap.
suff H n (j : 'I_l) : (j < n)%N -> (j < r)%N -> (W *m B j <= W)%MS by move=> j; apply: (H j.+1).
elim: n j => // n IH j; rewrite ltnS => jn jr.
suff rows (i : 'I_d) : (i < p)%N -> (row i U *m B j <= W)%MS.
  apply/row_subP => i; rewrite row_mul row_top -scalemxAl; case: ltnP => ip; last by rewrite scale0r sub0mx.
  by rewrite scale1r rows.
move: i; apply: (@top_family _ (fun i => s`_i + t`_j) (fun i l => T i l)) => i ip; first exact: gap.
have -> : row i U *m B j *m A = row i U *m A *m B j + row i U *m (\sum_g S j g *: B g).
  by rewrite -adB mulmxBr !mulmxA addrC subrK.
rewrite row_A mulmxDl -scalemxAl mulmx_suml (bigD1 j) //= S_diag mulmxDr -scalemxAr scalerDl.
under eq_bigr do rewrite -scalemxAl.
set a := s`_i *: _; set b := \sum_(l0 < d | _) _; set e := t`_j *: _; set f := row i U *m _.
have -> : a + b + (e + f) - (a + e + b) = f by rewrite [a + b + _](AC (2*2) ((1*3*2)*4)) addrC addKr.
rewrite /f mulmx_sumr; apply: summx_sub => g gj; rewrite -scalemxAr; have [lt | ge] := ltnP g j.
  apply: scalemx_sub; apply: submx_trans (IH g (leq_trans lt jn) (ltn_trans lt jr)).
  by apply: submxMr; apply: top_row.
by rewrite S_low ?scale0r ?sub0mx // ltn_neqAle ge andbT eq_sym.
Qed.
End Top.

(** The terms of s that satisfy a come first. *)
Definition first (T : Type) (a : pred T) (s : seq T) : seq T := filter a s ++ filter (predC a) s.

Lemma first_prod (F : fieldType) (a : pred F) (s : seq F) :
  \prod_(z <- first a s) ('X - z%:P) = \prod_(z <- s) ('X - z%:P) :> {poly F}.
Proof. by apply: perm_big; rewrite /first perm_filterC. Qed.

Lemma nth_first (T : eqType) (x0 : T) (a : pred T) (s : seq T) (i : nat) : (i < size s)%N ->
  nth x0 (first a s) i \in s /\ a (nth x0 (first a s) i) = (i < count a s)%N.
Proof.
move=> lt; rewrite /first nth_cat size_filter; case: ltnP => ic.
  have : nth x0 (filter a s) i \in filter a s by rewrite mem_nth // size_filter.
  by rewrite mem_filter => /andP [-> ->].
have : nth x0 (filter (predC a) s) (i - count a s) \in filter (predC a) s.
  by rewrite mem_nth // size_filter ltn_subLR // count_predC.
by rewrite mem_filter => /andP [/negbTE -> ->].
Qed.

Lemma size_eigenvalues (F : fieldType) n (A : 'M[F]_n) (s : seq F) :
  char_poly A = \prod_(z <- s) ('X - z%:P) -> size s = n.
Proof. by move=> e; have := size_char_poly A; rewrite e size_prod_XsubC => -[]. Qed.

(** Theorem 4, soundness, on V. s and t are the eigenvalues of A and of M, with multiplicity. *)
Theorem dominance_matrices_sound (R : rcfType) k d (rho : 'I_k -> 'M[R]_d) (A : 'M[R]_d) l (B : 'I_l -> 'M[R]_d)
    (M : 'M[R]_l) (cut eps : R) (s t : seq R[i]) :
  0 < eps ->
  (forall q, exists u : 'I_l -> R, rho q = \sum_j u j *: B j) ->
  (forall j, B j *m A - A *m B j = \sum_g M j g *: B g) ->
  char_poly (map_mx (inC R) A) = \prod_(z <- s) ('X - z%:P) ->
  char_poly (map_mx (inC R) M) = \prod_(z <- t) ('X - z%:P) ->
  (forall z, z \in s -> ~~ (cut - eps <= complex.Re z <= cut)) ->
  let top := count (fun z => (cut < complex.Re z)%R) s in
  let lowering := count (fun z => (complex.Re z <= - eps)%R) t in
  (0 < top)%N -> (top + lowering < d)%N -> ~ full rho.
Proof.
move=> eps0 rhoB adB es et gap top lowering top0 lt full_rho; set toC := inC R in es et.
pose a z := (cut < complex.Re z)%R; pose b z := (- eps < complex.Re z)%R.
have sz_s := size_eigenvalues es; have sz_t := size_eigenvalues et.
have [U [T [Uu UA T_tri]]] : exists U T, [/\ U \in unitmx, U *m map_mx toC A = T *m U & triangular T (first a s)].
  by apply: triangular_form; rewrite first_prod.
have [Z [S [Zu ZM S_tri]]] : exists Z S, [/\ Z \in unitmx, Z *m map_mx toC M = S *m Z & triangular S (first b t)].
  by apply: triangular_form; rewrite first_prod.
have s_top (i : 'I_d) : (i < top)%N -> cut < complex.Re (first a s)`_i.
  move=> ip; have [|_ e] := @nth_first _ 0 a s i; first by rewrite sz_s.
  by rewrite -[cut < _]/(a _) e.
have s_low (i : 'I_d) : (top <= i)%N -> complex.Re (first a s)`_i < cut - eps.
  move=> pi; have [|mem e] := @nth_first _ 0 a s i; first by rewrite sz_s.
  have le : complex.Re (first a s)`_i <= cut by rewrite leNgt -[cut < _]/(a _) e -leqNgt.
  by have := gap _ mem; rewrite le andbT -ltNge.
have t_high (j : 'I_l) : (j < count b t)%N -> - eps < complex.Re (first b t)`_j.
  move=> jr; have [|_ e] := @nth_first _ 0 b t j; first by rewrite sz_t.
  by rewrite -[_ < _]/(b _) e.
have s_top' (i : 'I_d) : (i < top)%N -> cut - eps <= complex.Re (first a s)`_i.
  by move/s_top => c; rewrite ltW // (lt_trans _ c) // ltr_subl_addr ltr_addl.
have pd : (top <= d)%N by rewrite -sz_s count_size.
have [|x x0 xW] := top_real Uu UA T_tri s_low s_top' (erefl (map_mx toC A)); first by rewrite top0 pd.
pose B' j := \sum_g Z j g *: map_mx toC (B g).
have comb (N : 'M_l) i : \sum_g N i g *: B' g = \sum_g (N *m Z) i g *: map_mx toC (B g).
  rewrite /B'; under eq_bigr do rewrite scaler_sumr; rewrite exchange_big; apply: eq_bigr => g _.
  by rewrite mxE scaler_suml; apply: eq_bigr => e _; rewrite scalerA.
have combB i : map_mx toC (B i) = \sum_g (invmx Z) i g *: B' g.
  rewrite comb mulVmx // (bigD1 i) //= big1 ?addr0 => [|g gi]; first by rewrite mxE eqxx scale1r.
  by rewrite mxE eq_sym (negPf gi) scale0r.
have map_comb (u : 'I_l -> R) : map_mx toC (\sum_j u j *: B j) = \sum_j toC (u j) *: map_mx toC (B j).
  by rewrite (raddf_sum (map_mx_additive toC _ _)); apply: eq_bigr => j _; rewrite /= map_mxZ.
have adB' j : B' j *m map_mx toC A - map_mx toC A *m B' j = \sum_g S j g *: B' g.
  rewrite comb -ZM /B' mulmx_suml mulmx_sumr -sumrB.
  rewrite (eq_bigr (fun g => \sum_e (Z j g * toC (M g e)) *: map_mx toC (B e))) => [|g _]; last first.
    rewrite -scalemxAl -scalemxAr -scalerBr -!map_mxM -map_mxB adB map_comb scaler_sumr.
    by apply: eq_bigr => e _; rewrite scalerA.
  rewrite exchange_big; apply: eq_bigr => g _; rewrite mxE scaler_suml; apply: eq_bigr => e _.
  by rewrite mxE.
have inv := top_invariant Uu UA T_tri s_low S_tri adB'.
pose C := [set j : 'I_l | (count b t <= j)%N].
have card_C : (#|C| = lowering)%N.
  rewrite cardsE -sum1_card; transitivity (\sum_(count b t <= j < l) 1)%N; first by rewrite big_geq_mkord.
  rewrite sum_nat_const_nat muln1 -sz_t -(count_predC b t) addKn.
  by apply: eq_count => z /=; rewrite /b -leNgt.
have bad : ~~ row_full (span_at B' (map_mx toC x)).
  apply: (@dominance_at _ _ _ _ _ (top_mx top U) C) => //.
    move=> j; rewrite inE -ltnNge => jr; apply: (inv (count b t)) => // i j' ip jr'.
    have ReD (x1 x2 : R[i]) : complex.Re (x1 + x2) = complex.Re x1 + complex.Re x2 by case: x1 x2 => ? ? [? ?].
    by rewrite ReD; apply: ltW; apply: ltr_add; [apply: s_top | apply: t_high].
  by rewrite rank_top // card_C.
case/negP: bad; rewrite -sub1mx.
have : row_full (span_at (fun q => map_mx toC (rho q)) (map_mx toC x)) by apply: map_span_full (full_rho x x0).
rewrite -sub1mx => /submx_trans; apply; apply: span_sub => [|q]; first exact: addsmxSl.
have [u ->] := rhoB q; apply/span_atP; exists (fun g => \sum_j toC (u j) * (invmx Z) j g), 0; rewrite scale0r addr0.
congr (_ *m _); rewrite map_comb.
rewrite [RHS](eq_bigr (fun g => \sum_j (toC (u j) * (invmx Z) j g) *: B' g)) => [|g _]; last first.
  by rewrite scaler_suml.
rewrite [RHS]exchange_big; apply: eq_bigr => j _; rewrite combB scaler_sumr.
by apply: eq_bigr => g _; rewrite scalerA.
Qed.

(** Kind dominance for a pair over F, over every real closed R: X in h, and a family B that spans rho(h). *)
Theorem dominance_pair_sound (F : realFieldType) (R : rcfType) (f : {rmorphism F -> R}) n k d (c : 'I_n -> 'M[F]_n)
    (h : 'M[F]_(k, n)) (Q : 'M[F]_(n, d)) (E : 'M[F]_(d, n)) (X : 'rV[F]_n) (a : F) l (B : 'I_l -> 'M[F]_d)
    (M : 'M[F]_l) (cut eps : F) (s t : seq R[i]) :
  increasing f -> valid_pair c h Q E -> 0 < eps ->
  (forall q, exists u : 'I_l -> F, rho c h Q E q = \sum_j u j *: B j) ->
  (forall j, B j *m isotropy c Q E X - isotropy c Q E X *m B j = \sum_g M j g *: B g) ->
  char_poly (map_mx (inC R) (map_mx f (isotropy c Q E X - a%:M))) =
    \prod_(z <- s) ('X - z%:P) ->
  char_poly (map_mx (inC R) (map_mx f M)) = \prod_(z <- t) ('X - z%:P) ->
  (forall z, z \in s -> ~~ (f cut - f eps <= complex.Re z <= f cut)) ->
  let top := count (fun z => (f cut < complex.Re z)%R) s in
  let lowering := count (fun z => (complex.Re z <= - f eps)%R) t in
  (0 < top)%N -> (top + lowering < d)%N -> ~ full_pair (map_pair f c) (map_mx f h).
Proof.
move=> inc ok eps0 rhoB adB es et gap top lowering top0 lt; have [clR coR _] := map_valid_pair f ok.
move/(full_pairP clR coR).
have map_comb (u : 'I_l -> F) : map_mx f (\sum_j u j *: B j) = \sum_j f (u j) *: map_mx f (B j).
  by rewrite (raddf_sum (map_mx_additive f _ _)); apply: eq_bigr => j _; rewrite /= map_mxZ.
apply: (dominance_matrices_sound (inc _ eps0) _ _ es et gap top0 lt) => [q | j].
  have [u eu] := rhoB q; exists (fun j => f (u j)).
  by rewrite -map_rho eu map_comb.
rewrite -!map_mxM -map_mxB mulmxBr mulmxBl scalar_mxC opprB addrA subrK adB.
by rewrite map_comb; apply: eq_bigr => g _; rewrite mxE.
Qed.
