(** Soundness of the kind commutant: an operator that commutes with rho(h) and has two real parts in its spectrum.

    Source: docs/theory/fullness.md, section 3, "An operator that commutes".

    Over a real closed field R, let rho be full and T commute with rho(h). A matrix S that commutes with rho(h) is 0 or
    invertible, since its kernel is invariant [commuting_unit]. Let v be an eigenvector of T over R[i] for x + iy, and
    S = (T - x)^2 + y^2, or S = T - x if y = 0. S v = 0, so S = 0 [commutant_full]. So T is a scalar or a root of a
    quadratic polynomial of negative discriminant, and all its eigenvalues have the same real part [commutant_full_re].

    Two criteria follow. [commutant_sound] needs no eigenvalue: T is over F, it is not a scalar, and it is no root of
    a quadratic polynomial of negative discriminant; in particular it suffices that 1, T, T^2 are independent.
    [commutant_cut_sound] is the statement of the page: some but not all eigenvalues have real part above the cut. Where
    it applies, so does the first criterion. *)
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp Require Import complex ring.
From Liehom Require Import Sound Pair Certificate FullSound.
Set Implicit Arguments. Unset Strict Implicit. Unset Printing Implicit Defensive.
Import Order.TTheory GRing.Theory Num.Theory. Local Open Scope ring_scope.
(** The real numbers in R[i]. *)
Local Notation inC R := (ComplexField.real_complex_rmorphism R).

(** T acts on V and commutes with every rho_p. *)
Definition commutes (F : fieldType) k d (rho : 'I_k -> 'M[F]_d) (T : 'M[F]_d) := forall p, T *m rho p = rho p *m T.

(** Neither a scalar nor a root of a quadratic polynomial of negative discriminant. *)
Definition splitting (F : realFieldType) d (T : 'M[F]_d) :=
  (forall a, T != a%:M) /\ (forall a b, T *m T = a *: T + b%:M -> 0 <= a ^+ 2 + 4%:R * b).

(** Two quadratic equations of a matrix that is not a scalar are equal, so [splitting] is decided by one candidate. *)
Lemma quadratic_unique (F : fieldType) d (T : 'M[F]_d) a b a' b' : (forall s, T != s%:M) ->
  T *m T = a *: T + b%:M -> T *m T = a' *: T + b'%:M -> a = a' /\ b = b'.
Proof.
move=> nos -> e; have d0 : (0 < d)%N.
  by case: posnP => // d0; case/negP: (nos 0); apply/eqP/matrixP => -[i lt]; have := lt; rewrite {1}d0.
have ea : a = a'.
  apply/eqP; apply: contraT => ne; case/negP: (nos ((b' - b) / (a - a'))).
  have na : a - a' != 0 by rewrite subr_eq0.
  apply/eqP/(scalerI na); rewrite scale_scalar_mx mulrC divfK // scalerBl raddfB /=.
  by apply/eqP; rewrite subr_eq addrAC eq_sym subr_eq e addrC.
split=> //; move: e; rewrite ea => /addrI /(congr1 (fun M : 'M_d => M (Ordinal d0) (Ordinal d0))).
by rewrite !mxE eqxx !mulr1n.
Qed.

Lemma splitting_quadratic (F : realFieldType) d (T : 'M[F]_d) a b : (forall s, T != s%:M) ->
  T *m T = a *: T + b%:M -> 0 <= a ^+ 2 + 4%:R * b -> splitting T.
Proof. by move=> nos e pos; split=> // a' b' e'; have [<- <-] := quadratic_unique nos e e'. Qed.

Section Schur.
Variables (F : fieldType) (k d : nat) (rho : 'I_k -> 'M[F]_d).
Hypothesis full_rho : full rho.

Lemma commuting_unit (S : 'M[F]_d) : commutes rho S -> S \notin unitmx -> S = 0.
Proof.
move=> com sing; apply/eqP; apply: contraT => S0; exfalso.
have K0 : kermx S != 0 by rewrite kermx_eq0 row_free_unit.
apply: (invariant_sound K0 _ _ full_rho).
  by rewrite mxrank_ker ltn_subrL lt0n mxrank_eq0 S0 /= (leq_trans _ (rank_leq_col S)) // lt0n mxrank_eq0.
by move=> p; apply/sub_kermxP; rewrite -mulmxA -com mulmxA mulmx_ker mul0mx.
Qed.
End Schur.

Section RealClosed.
Variables (R : rcfType) (k d : nat) (rho : 'I_k -> 'M[R]_d).
Hypothesis full_rho : full rho.
Local Notation toC := (inC R).

(** A real polynomial in T that annihilates a complex vector is singular. *)
Lemma complex_singular (S : 'M[R]_d) (v : 'rV[R[i]]_d) : v != 0 -> v *m map_mx toC S = 0 -> S \notin unitmx.
Proof.
move=> v0 vS; apply: contra v0 => Su; have CSu : map_mx toC S \in unitmx by rewrite map_unitmx.
by rewrite -[v](mulmxK CSu) vS mul0mx.
Qed.

Theorem commutant_full (T : 'M[R]_d) : (0 < d)%N -> commutes rho T ->
  (exists a, T = a%:M) \/ (exists a b, T *m T = a *: T + b%:M /\ a ^+ 2 + 4%:R * b < 0).
Proof.
move=> d0 com; pose TC := map_mx toC T.
have /closed_rootP [l] : size (char_poly TC) != 1%N by rewrite size_char_poly; case: (d) d0.
rewrite -eigenvalue_root_char => /eigenvalueP [v vT v0].
case: l vT => x y vT; have [y0 | y0] := eqVneq y 0.
  left; exists x; apply/eqP; rewrite -subr_eq0; apply/eqP; apply: (commuting_unit full_rho).
    by move=> p; rewrite mulmxBl mulmxBr com scalar_mxC.
  apply: (complex_singular v0); rewrite map_mxB map_scalar_mx mulmxBr vT mul_mx_scalar y0.
  by rewrite subrr.
right; exists (x *+ 2), (- (x ^+ 2 + y ^+ 2)); split; last first.
  rewrite mulrN exprMn_n -mulr_natl -mulrBr.
  by rewrite opprD addrA subrr add0r mulrN oppr_lt0 mulr_gt0 ?ltr0n // lt_def sqr_ge0 sqrf_eq0 y0.
apply/eqP; rewrite -subr_eq0; apply/eqP; apply: (commuting_unit full_rho).
  move=> p; rewrite mulmxBl mulmxBr mulmxDl mulmxDr -scalemxAl -scalemxAr com scalar_mxC.
  by rewrite -mulmxA com !mulmxA com.
apply: (complex_singular v0); rewrite map_mxB map_mxM map_mxD map_mxZ map_scalar_mx mulmxBr mulmxA vT mulmxDr.
rewrite -scalemxAl vT -scalemxAr vT mul_mx_scalar !scalerA -scalerDl -scalerBl.
apply/eqP; rewrite scaler_eq0 eq_complex; simpc; apply/orP; left.
by apply/andP; split; apply/eqP => /=; ring.
Qed.

(** An eigenvalue of T satisfies every quadratic equation of T. *)
Lemma eigenvalue_square (T : 'M[R]_d) a b (l : R[i]) :
  T *m T = a *: T + b%:M -> root (char_poly (map_mx toC T)) l -> l * l = toC a * l + toC b.
Proof.
move=> eT; rewrite -eigenvalue_root_char => /eigenvalueP [v vT v0].
have := congr1 (fun M => v *m map_mx toC M) eT; rewrite /= map_mxM map_mxD map_mxZ map_scalar_mx.
rewrite mulmxA vT mulmxDr -scalemxAl -scalemxAr vT mul_mx_scalar !scalerA -scalerDl => /eqP.
by rewrite -subr_eq0 -scalerBl scaler_eq0 (negPf v0) orbF subr_eq0 => /eqP.
Qed.

(** All eigenvalues of T have the same real part. *)
Theorem commutant_full_re (T : 'M[R]_d) (l m : R[i]) : (0 < d)%N -> commutes rho T ->
  root (char_poly (map_mx toC T)) l -> root (char_poly (map_mx toC T)) m -> complex.Re l = complex.Re m.
Proof.
move=> d0 com rl rm; have [[a eT] | [a [b [eT disc]]]] := commutant_full d0 com.
  have ev z : root (char_poly (map_mx toC T)) z -> z = toC a.
    rewrite -eigenvalue_root_char => /eigenvalueP [v].
    rewrite eT map_scalar_mx mul_mx_scalar => /eqP; rewrite -subr_eq0 -scalerBl scaler_eq0 => /orP [|/eqP -> /eqP //].
    by rewrite subr_eq0 => /eqP.
  by rewrite (ev l) // (ev m).
have half z : root (char_poly (map_mx toC T)) z -> complex.Re z *+ 2 = a.
  move/(eigenvalue_square eT); case: z => x y /= /eqP; rewrite eq_complex; simpc => /= /andP [/eqP re /eqP im].
  have [y0 | y0] := eqVneq y 0.
    have : 0 <= (x *+ 2 - a) ^+ 2 by apply: sqr_ge0.
    suff -> : (x *+ 2 - a) ^+ 2 = a ^+ 2 + 4%:R * b by rewrite leNgt disc.
    have -> : b = (a * x + b) - a * x by ring.
    by rewrite -re y0; ring.
  apply: (mulIf y0); rewrite -im; by ring.
by apply/eqP; rewrite -(eqr_pmuln2r (isT : 0 < 2)%N) half // half.
Qed.
End RealClosed.

(** Kind commutant without eigenvalues: T over F commutes with rho(h) and splits V over every real closed R. *)
Theorem commutant_sound (F : realFieldType) (R : rcfType) (f : {rmorphism F -> R}) n k d (c : 'I_n -> 'M[F]_n)
    (h : 'M[F]_(k, n)) (Q : 'M[F]_(n, d)) (E : 'M[F]_(d, n)) (T : 'M[F]_d) :
  increasing f -> valid_pair c h Q E -> commutes (rho c h Q E) T -> splitting T ->
  ~ full_pair (map_pair f c) (map_mx f h).
Proof.
move=> inc ok com [noscalar nosquare]; have okR := map_valid_pair f ok; have [clR coR _] := okR.
move/(full_pairP clR coR) => full_rho.
have d0 : (0 < d)%N.
  by case: posnP => // d0; case/negP: (noscalar 0); apply/eqP/matrixP => -[i lt]; have := lt; rewrite {1}d0.
have comR : commutes (rho (map_pair f c) (map_mx f h) (map_mx f Q) (map_mx f E)) (map_mx f T).
  by move=> p; rewrite -map_rho -!map_mxM com.
have not_scalar a : map_mx f T != a%:M.
  apply/negP => /eqP eT; pose i0 := Ordinal d0; case/negP: (noscalar (T i0 i0)); apply/eqP/matrixP => i j.
  apply: (fmorph_inj f); have := congr1 (fun M : 'M_d => M i j) eT; have := congr1 (fun M : 'M_d => M i0 i0) eT.
  by rewrite !mxE eqxx mulr1n => <- ->; rewrite rmorphMn.
have [[a eT] | [a [b [eT disc]]]] := commutant_full full_rho d0 comR; first by case/negP: (not_scalar a); apply/eqP.
have : (mxvec (T *m T) <= col_mx (mxvec T) (mxvec 1%:M))%MS.
  rewrite -(map_submx f) map_col_mx !map_mxvec map_mx1 map_mxM eT linearD linearZ /= -scalemx1 linearZ /=.
  by rewrite -addsmxE addmx_sub_adds ?scalemx_sub.
case/submxP => u; rewrite -[u]hsubmxK mul_row_col => eu.
have {eu} eTF : T *m T = (lsubmx u) 0 0 *: T + ((rsubmx u) 0 0)%:M.
  apply: (can_inj mxvecK); rewrite eu linearD linearZ /= -[(rsubmx u 0 0)%:M]scalemx1 linearZ /=.
  by rewrite -!mul_scalar_mx -!mx11_scalar.
set a' := _ 0 0 in eTF; set b' := rsubmx u 0 0 in eTF.
have := nosquare _ _ eTF; have := congr1 (map_mx f) eTF.
rewrite map_mxM map_mxD map_mxZ map_scalar_mx => e.
have [ea eb] : a = f a' /\ b = f b' by apply: (quadratic_unique not_scalar _ e); rewrite eT.
rewrite le_eqVlt => /orP [/eqP z0 | /inc].
  by move: disc; rewrite ea eb -rmorphX -(rmorph_nat f) -rmorphM -rmorphD -z0 rmorph0 ltxx.
by rewrite rmorphD rmorphM rmorph_nat rmorphX -ea -eb ltNge (ltW disc).
Qed.

(** Kind commutant: the eigenvalues of T over R[i] are the terms of s, with multiplicity, and some but not all of them
    have real part above the cut. *)
Theorem commutant_cut_sound (F : realFieldType) (R : rcfType) (f : {rmorphism F -> R}) n k d (c : 'I_n -> 'M[F]_n)
    (h : 'M[F]_(k, n)) (Q : 'M[F]_(n, d)) (E : 'M[F]_(d, n)) (T : 'M[F]_d) (cut : R) (s : seq R[i]) :
  valid_pair c h Q E -> commutes (rho c h Q E) T ->
  char_poly (map_mx (inC R) (map_mx f T)) = \prod_(z <- s) ('X - z%:P) ->
  (0 < count (fun z => (cut < complex.Re z)%R) s < d)%N ->
  ~ full_pair (map_pair f c) (map_mx f h).
Proof.
move=> ok com eig /andP [pos lt]; have [clR coR _] := map_valid_pair f ok.
move/(full_pairP clR coR) => full_rho.
have comR : commutes (rho (map_pair f c) (map_mx f h) (map_mx f Q) (map_mx f E)) (map_mx f T).
  by move=> p; rewrite -map_rho -!map_mxM com.
have d0 : (0 < d)%N := leq_ltn_trans (leq0n _) lt.
have sz : size s = d.
  have := size_char_poly (map_mx (inC R) (map_mx f T)).
  by rewrite eig size_prod_XsubC => -[].
have rt z : z \in s -> root (char_poly (map_mx (inC R) (map_mx f T))) z.
  by rewrite eig root_prod_XsubC.
have /hasP [z zs cz] : has (fun z => cut < complex.Re z) s by rewrite has_count.
have /allPn [w ws cw] : ~~ all (fun z => cut < complex.Re z) s by rewrite all_count sz neq_ltn lt.
by move: cw; rewrite (commutant_full_re full_rho d0 comR (rt w ws) (rt z zs)) cz.
Qed.
