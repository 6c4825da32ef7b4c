(** The kind full: a form F, elements of h that preserve it up to factors, and a point eta, in integers.

    Two facts are verified from factors that somebody proposes: the form is positive definite, by s P = U D U^T with U
    invertible and D diagonal and positive; and x with its images spans V, by a left inverse of these rows. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra zify.ssrZ.
From Liehom Require Import Sound Pair Certificate Definite CheckerAlgebra CheckerPair.
Set Implicit Arguments. Unset Strict Implicit. Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory. Local Open Scope ring_scope.

(** ** Functions *)
Record full_data := FullData {form : matrix; elements : matrix; point : vector}.

Record factors := Factors {
  upper : matrix; upper_inverse : matrix; upper_factor : Z; (** U V = factor *)
  pivots : seq Z; pivots_factor : Z                         (** factor P = U D U^T *)
}.
Record full_hint := FullHint {definite : factors; left_inverse : matrix; rank_factor : Z (** C rows = factor *)}.

Definition diagonal (l : seq Z) : matrix := [seq [:: (j, nth Z0 l j)] | j <- iota 0 (size l)].

(** A matrix of size d is positive definite. *)
Definition check_definite (d : nat) (i : factors) (P : matrix) : bool :=
  [&& Z.ltb Z0 (pivots_factor i), ~~ Z.eqb (upper_factor i) Z0, Nat.eqb (size (pivots i)) d,
      all (Z.ltb Z0) (pivots i)
    & [&& Nat.eqb (size (upper i)) d, Nat.eqb (size (upper_inverse i)) d,
          msame (mmul (upper i) (upper_inverse i)) (mid (upper_factor i) d)
        & msame (mscale (pivots_factor i) P)
            (mmul (mmul (upper i) (diagonal (pivots i))) (mtranspose d d (upper i)))]].

Section Check.
Variables (p : pair_data) (t : coordinates_hint) (isos : seq matrix) (f : full_data) (i : full_hint).
Let n := dimension p.
Let d := codimension t.
Let q := denominator t.

(** The form on V in the coordinates x Q, times the square of the denominator. *)
Definition metric : matrix := mmul (mmul (section t) (form f)) (mtranspose d n (section t)).

(** The isotropy of the elements, times a factor. *)
Definition motions : seq matrix := [seq isotropy_of t isos z | z <- elements f].

(** K P + P K^T is a multiple of P, by comparison with the first entries. *)
Definition check_conformal (P K : matrix) : bool :=
  let half := mmul K P in
  let moved := madd half (mtranspose d d half) in
  let a := vget (nth [::] moved 0) 0 in
  let b := vget (nth [::] P 0) 0 in
  ~~ Z.eqb b Z0 && msame (mscale b moved) (mscale a P).

Definition check_full : bool :=
  let P := metric in
  let Ks := motions in
  let x := vmul (point f) (quotient t) in
  let orbit := x :: [seq vmul x K | K <- Ks] in
  [&& Nat.leb 2 d, Nat.eqb (size (form f)) n, msame (form f) (mtranspose n n (form f)),
      msame (mscale (Z.mul q q) (form f)) (mmul (mmul (quotient t) P) (mtranspose n d (quotient t)))
    & [&& check_definite d (definite i) P, mzero (mmul (elements f) (quotient t)), all (check_conformal P) Ks,
          ~~ Z.eqb (rank_factor i) Z0
        & msame (mmul (left_inverse i) orbit) (mid (rank_factor i) d)]].
End Check.

(** ** Soundness *)
Section Definite.
Variable F : realFieldType.
Local Notation num := (num F).

Lemma mat_diagonal d l : size l = d -> mat F d d (diagonal l) = diag_mx (\row_j num (nth Z0 l j)).
Proof.
move=> sl; apply/matrixP => a b; rewrite !mxE (nth_map 0%N) ?size_iota ?sl // nth_iota ?sl //= addr0.
by case: (a =P b) => [->|ne]; [rewrite eqxx mulr1n | case: eqP => // e; case: ne; apply: val_inj].
Qed.

Lemma mat_unit d (U V : matrix) x : (size V <= d)%N -> ~~ Z.eqb x Z0 -> msame (mmul U V) (mid x d) ->
  mat F d d U \in unitmx.
Proof.
move=> sV x0 /(@mat_same F d d); rewrite mat_id (mat_mul _ _ _ _ sV) => e.
have/mulmx1_unit [] : mat F d d U *m ((num x)^-1 *: mat F d d V) = 1%:M => //.
by rewrite -scalemxAr e scale_scalar_mx mulVf // num_eq0.
Qed.

Lemma mat_form d (U : matrix) l : size U = d -> size l = d ->
  mat F d d (mmul (mmul U (diagonal l)) (mtranspose d d U))
    = mat F d d U *m diag_mx (\row_j num (nth Z0 l j)) *m (mat F d d U)^T.
Proof.
move=> sU sl; rewrite (mat_mul (m := d) _ _ _) ?size_map ?size_iota //.
by rewrite (mat_mul (m := d) _ _ _) ?size_map ?size_iota ?sl // mat_transpose (mat_diagonal sl).
Qed.

Lemma check_definite_sound d i P : check_definite d i P ->
  (mat F d d P)^T = mat F d d P /\ positive_definite (mat F d d P).
Proof.
case/and5P => s0 u0 /Nat.eqb_eq sp pos /and4P [/Nat.eqb_eq sU /Nat.eqb_eq sV UV PD].
set U := mat F d d (upper i); set D : 'rV[F]_d := (num (pivots_factor i))^-1 *: \row_j num (nth Z0 (pivots i) j).
have s0' : 0 < num (pivots_factor i) by rewrite num_gt0.
suff fac : positive_factors (mat F d d P) U D.
  by split; [apply: positive_factors_sym fac | apply: positive_factors_definite fac].
split; first by apply: mat_unit UV => //; rewrite sV.
  move=> j; rewrite !mxE mulr_gt0 ?invr_gt0 // num_gt0.
  by move/(all_nthP Z0): pos; apply; rewrite sp.
move/(@mat_same F d d): PD; rewrite mat_scale (mat_form sU sp) -/U => /(congr1 (fun x => (num (pivots_factor i))^-1 *: x)).
rewrite scalerA mulVf ?gt_eqF // scale1r => ->.
by rewrite /D linearZ /= -scalemxAr -scalemxAl.
Qed.
End Definite.

Section Sound.
Variables (F : realFieldType) (p : pair_data) (t : coordinates_hint) (f : full_data) (i : full_hint).
Local Notation num := (num F).
Local Notation n := (dimension p). Local Notation k := (size (rows p)). Local Notation d := (codimension t).
Local Notation ads := (adjoint p t). Local Notation isos := (isotropies t ads).
Local Notation P := (metric p t f).
Local Notation s := (size (elements f)).
Local Notation c := (c_of F p). Local Notation G := (G_of F p t).
Local Notation Q := (Q_of F p t). Local Notation E := (E_of F p t).

Definition P_of : 'M[F]_d := mat F d d P.
Definition z_of : 'M[F]_(s, n) := mat F s n (elements f).
Definition eta_of : 'rV[F]_n := vec F n (point f).

Lemma size_P : (size (section t) <= d)%N -> (size P <= d)%N. Proof. by rewrite !size_map. Qed.

Hypothesis cc : check_coordinates p t ads isos.
Let sp : check_spaces p t. Proof. by case/and3P: cc. Qed.

Theorem check_full_certificate :
  check_full p t isos f i -> full_certificate c G Q E P_of z_of eta_of.
Proof.
case/and5P => _ _ _ _ /and5P [/(check_definite_sound F) [Psym Ppos] hz conf r0 span].
have zG j : (row j z_of <= G)%MS.
  case: (h_kerQ F sp) => hk Gh; rewrite Gh hk (submx_trans (row_sub _ _)) //; apply/sub_kermxP.
  by move/(@mat_zero F s d): hz; rewrite (mat_mul _ _ _ _ (size_Q sp)).
have motion (j : 'I_s) : mat F d d (nth [::] (motions t isos f) j)
    = (num (denominator t) * size_of F t) *: isotropy c Q E (row j z_of).
  by rewrite (nth_map [::]) // /z_of row_mat isotropy_of_sound // -row_mat.
have factor0 : num (denominator t) * size_of F t != 0.
  by rewrite mulf_neq0 ?(size_of_neq0 F sp) // (denominator_neq0 F sp).
have sm : size (motions t isos f) = s by rewrite size_map.
have size_motion (j : 'I_s) : (size (nth [::] (motions t isos f) j) <= d)%N.
  by rewrite (nth_map [::]) // size_isotropy_of.
split=> //; first by apply/row_subP.
  move=> j; move/(all_nthP [::]): conf => /(_ j); rewrite sm ltn_ord => /(_ isT) /andP [b0 /(@mat_same F d d)].
  rewrite !mat_scale mat_add mat_transpose (mat_mul _ _ _ _ (size_P (size_E sp))) motion -/P_of.
  move: (vget _ _) (vget _ _) b0 => a b b0; set K := isotropy _ _ _ _; set g := _ * size_of F t in factor0 *.
  rewrite -scalemxAl linearZ /= -scalerDr scalerA trmx_mul Psym => e.
  exists ((num b * g)^-1 * num a); rewrite -scalerA -e scalerA mulVf ?scale1r //.
  by rewrite mulf_neq0 // num_eq0.
set x := vmul (point f) (quotient t) in span.
set orbit := x :: _ in span; have so : (size orbit <= s.+1)%N by rewrite /= size_map sm.
have ex : vec F d x = eta_of *m Q by rewrite /x (vec_mul _ _ _ (size_Q sp)).
move/(@mat_same F d d): span; rewrite (mat_mul _ _ _ _ so) mat_id => e.
set S := span_at _ _; have inS : (mat F s.+1 d orbit <= S)%MS.
  apply/row_subP => j; rewrite row_mat; case: (unliftP 0 j) => [j'|] ->; last first.
    by rewrite /= ex addsmxSl.
  rewrite lift0 /= (nth_map [::]) ?sm // (vec_mul _ _ _ (size_motion j')) motion ex -scalemxAr scalemx_sub //; apply: submx_trans (addsmxSr _ _).
  by apply: (sumsmx_sup j') => //; rewrite genmxE.
rewrite -sub1mx; have r0' : num (rank_factor i) != 0 by rewrite num_eq0.
have -> : 1%:M = (num (rank_factor i))^-1 *: (num (rank_factor i))%:M :> 'M[F]_d.
  by rewrite scale_scalar_mx mulVf.
by rewrite -e scalemx_sub // (submx_trans (submxMl _ _)).
Qed.
End Sound.
