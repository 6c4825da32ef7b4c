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
Lemma top_conj (A0 : 'M[R]_d) : A = map_mx (ComplexField.real_complex_rmorphism R) A0 ->
  forall i : 'I_d, (i < p)%N -> (map_mx (conjc_rmorphism R) (row i U) <= W)%MS.
Proof.
move=> eA; have A_conj : map_mx (conjc_rmorphism R) A = A.
  by rewrite eA; apply/matrixP => i j; rewrite !mxE /= oppr0.
apply: (@top_family _ (fun i => conjc_rmorphism R s`_i) (fun i l => conjc_rmorphism R (T i l))) => i ip.
  by rewrite /=; case: (s`_i) (s_top ip).
rewrite -{1}A_conj -map_mxM row_A map_mxD map_mxZ (raddf_sum (map_mx_additive _ _ _)) /=.
by under [X in _ + X - _]eq_bigr do rewrite map_mxZ; rewrite subrr sub0mx.
Qed.

Lemma top_real (A0 : 'M[R]_d) : A = map_mx (ComplexField.real_complex_rmorphism R) A0 -> (0 < p <= d)%N ->
  exists2 x : 'rV[R]_d, x != 0 & (map_mx (ComplexField.real_complex_rmorphism R) x <= W)%MS.
Proof.
move=> eA /andP [p0 pd]; pose i0 := Ordinal (leq_trans p0 pd).
have wW := top_row (i := i0) p0; have cW := top_conj eA (i := i0) p0.
set w := row i0 U in wW cW; set w' := map_mx (conjc_rmorphism R) w in cW.
pose x := map_mx (@complex.Re R) w; pose y := map_mx (@complex.Im R) w.
have two : (2%:R : R[i]) != 0 by rewrite pnatr_eq0.
have double (z : 'rV[R]_d) : (map_mx (ComplexField.real_complex_rmorphism R) (z + z) <= W)%MS ->
    (map_mx (ComplexField.real_complex_rmorphism R) z <= W)%MS.
  set f := map_mx _ => zW; have -> : f z = 2%:R^-1 *: f (z + z).
    by rewrite /f map_mxD -[X in _ *: X]mulr2n -scaler_nat scalerK.
  exact: scalemx_sub.
have xW : (map_mx (ComplexField.real_complex_rmorphism R) x <= W)%MS.
  apply: double; suff -> : map_mx (ComplexField.real_complex_rmorphism R) (x + x) = w + w' by apply: addmx_sub.
  apply/rowP => j; rewrite !mxE; case: (U i0 j) => a b /=; apply/eqP; rewrite eq_complex /=.
  by apply/andP; split; apply/eqP; ring.
have yW : (map_mx (ComplexField.real_complex_rmorphism R) y <= W)%MS.
  apply: double; suff -> : map_mx (ComplexField.real_complex_rmorphism R) (y + y) = (0 +i* (-1))%C *: (w - w').
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
move=> [S_low S_diag] adB gap; suff H n (j : 'I_l) : (j < n)%N -> (j < r)%N -> (W *m B j <= W)%MS by move=> j; apply: (H j.+1).
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
