(** The pair: structure constants and a basis of h over the rationals, as lists, and their verification.

    [constants_of] and [rows_of] say what the lists mean over a field: the matrices of ad e_i and the rows of h.
    [check_coordinates] verifies coordinates on V = g/h that somebody proposes, and computes the isotropy
    representation; [check_pair_sound] says that the pair is then valid in the sense of Pair.v. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra zify.ssrZ.
From Liehom Require Import Sound Pair CheckerAlgebra.
Set Implicit Arguments. Unset Strict Implicit. Unset Printing Implicit Defensive.
Import GRing.Theory Num.Theory. Local Open Scope ring_scope.

(** A fraction is a numerator and a denominator. *)
Definition fraction := (Z * Z)%type.
(** A structure constant (i, j, k, x), i < j: the coefficient of e_k in [e_i, e_j] is x. *)
Definition constant A := (nat * nat * nat * A)%type.

Record pair_data := PairData {dimension : nat; constants : seq (constant fraction); rows : seq (seq fraction)}.

(** ** Meaning *)
Section Meaning.
Variable F : numFieldType.

Definition frac (q : fraction) : F := num F q.1 / num F q.2.

Definition entry (i j l : nat) A (value : A -> F) (e : constant A) : F :=
  let: (a, b, k, x) := e in
  value x * (((a == i) && (b == j) && (k == l))%:R - ((b == i) && (a == j) && (k == l))%:R).

(** The matrix of ad e_i on row vectors: row j is [e_i, e_j], antisymmetric in i and j. *)
Definition constants_of n (s : seq (constant fraction)) (i : 'I_n) : 'M[F]_n :=
  \matrix_(j, l) \sum_(e <- s) entry i j l frac e.

Definition dense m n (M : seq (seq fraction)) : 'M[F]_(m, n) :=
  \matrix_(i, j) frac (nth (Z0, Zpos xH) (nth [::] M i) j).

(** The constants are those of a Lie algebra over the field F, and the rows are a basis of a subalgebra. *)
Definition pair_is_valid (p : pair_data) : Prop :=
  let c := constants_of (n := dimension p) (constants p) in
  let h := dense (size (rows p)) (dimension p) (rows p) in
  [/\ lie_algebra c, closed c h & row_free h].

(** The pair is full: (6.4) for g over the field F. *)
Definition pair_is_full (p : pair_data) : Prop :=
  full_pair (constants_of (n := dimension p) (constants p)) (dense (size (rows p)) (dimension p) (rows p)).
End Meaning.

(** ** Functions *)

(** The integers xs are the fractions qs times s. *)
Fixpoint scaled (s : Z) (qs : seq fraction) (xs : seq Z) : bool :=
  match qs, xs with
  | [::], [::] => true
  | (a, b) :: qs', x :: xs' => [&& ~~ Z.eqb b Z0, Z.eqb (Z.mul s a) (Z.mul x b) & scaled s qs' xs']
  | _, _ => false
  end.
Fixpoint scaled_rows (n : nat) (M : seq (seq fraction)) (A : seq (Z * seq Z)) : bool :=
  match M, A with
  | [::], [::] => true
  | row :: M', (s, xs) :: A' =>
      [&& ~~ Z.eqb s Z0, Nat.eqb (size row) n, scaled s row xs & scaled_rows n M' A']
  | _, _ => false
  end.

Definition places_ok (n : nat) (s : seq (constant fraction)) : bool :=
  all (fun e => let: (a, b, k, _) := e in [&& Nat.ltb a b, Nat.ltb b n & Nat.ltb k n]) s.

Fixpoint replaced (s : seq (constant fraction)) (xs : seq Z) : seq (constant Z) :=
  match s, xs with
  | (p, _) :: s', x :: xs' => (p, x) :: replaced s' xs'
  | _, _ => [::]
  end.

(** The constants that concern e_i, as (j, k, x): x is a part of the coefficient of e_k in [e_i, e_j]. *)
Fixpoint concerning (i : nat) (s : seq (constant Z)) : seq (nat * nat * Z) :=
  if s is (a, b, k, x) :: s' then
    let rest := concerning i s' in
    let rest := if Nat.eqb a i then (b, k, x) :: rest else rest in
    if Nat.eqb b i then (a, k, Z.opp x) :: rest else rest
  else [::].
Fixpoint bracket_row (j : nat) (s : seq (nat * nat * Z)) : vector :=
  if s is (b, k, x) :: s' then
    if Nat.eqb b j then vadd [:: (k, x)] (bracket_row j s') else bracket_row j s'
  else [::].
Definition table (n : nat) (s : seq (constant Z)) : seq matrix :=
  [seq let here := concerning i s in [seq bracket_row j here | j <- iota 0 n] | i <- iota 0 n].

(** Proposed coordinates. Nothing is known of them before [check_coordinates]. *)
Record coordinates_hint := Coordinates {
  codimension : nat;
  scale : Z; integers : seq Z;  (** the structure constants times scale *)
  subalgebra : seq (Z * seq Z); (** the rows of h, each times its factor *)
  basis : matrix;               (** G (k x n): another basis of h *)
  change : matrix; factor : Z;  (** change H = factor G *)
  quotient : matrix;            (** Q (n x d): its columns are a basis of the linear forms that vanish on h *)
  section : matrix;             (** E (d x n) with E Q = denominator *)
  dual : matrix;                (** S (n x k) with G S = denominator *)
  denominator : Z
}.

Section Check.
Variables (p : pair_data) (t : coordinates_hint).
Let n := dimension p.
Let k := size (rows p).
Let d := codimension t.

Definition subalgebra_matrix : matrix := [seq sparse r.2 | r <- subalgebra t].

(** ad of the basis elements of g, times scale. *)
Definition tables : seq matrix := table n (replaced (constants p) (integers t)).

Definition commutator (A B : matrix) : matrix := madd (mmul A B) (mscale (Zneg xH) (mmul B A)).

(** The Jacobi identity for e_i, e_j and all other elements, i < j: ad [e_i, e_j] is the commutator of ad e_i and ad e_j,
    reversed as these act on rows. *)
Definition check_jacobi (ads : seq matrix) : bool :=
  all (fun i => let a := nth [::] ads i in
      all (fun b => msame (combine b.1 ads) (commutator b.2 a))
        (zip (drop i.+1 a) (drop i.+1 ads))) (iota 0 n).

(** ad of the rows of G, times scale; the isotropy representation of the rows of G, times scale and denominator. *)
Definition adjoint : seq matrix :=
  let ads := tables in [seq combine g ads | g <- basis t].
Definition isotropies (ads : seq matrix) : seq matrix := [seq mmul (mmul (section t) a) (quotient t) | a <- ads].

Definition check_spaces : bool :=
  [&& places_ok n (constants p), ~~ Z.eqb (scale t) Z0,
      scaled (scale t) (map snd (constants p)) (integers t),
      scaled_rows n (rows p) (subalgebra t)
    & [&& Nat.eqb (k + d) n && Nat.eqb (size (section t)) d, Nat.eqb (size (basis t)) k,
          Nat.eqb (size (quotient t)) n, Nat.eqb (size (dual t)) n
        & [&& ~~ Z.eqb (denominator t) Z0, ~~ Z.eqb (factor t) Z0,
              msame (mmul (change t) subalgebra_matrix) (mscale (factor t) (basis t)),
              mzero (mmul subalgebra_matrix (quotient t))
            & msame (mmul (section t) (quotient t)) (mid (denominator t) d) &&
              msame (mmul (basis t) (dual t)) (mid (denominator t) k)]]].

(** The isotropy of an element of h, times scale and the cube of denominator. *)
Definition isotropy_of (isos : seq matrix) (z : vector) : matrix := combine (vmul z (dual t)) isos.

(** For all j: [h_p, e_j] Q = Q_j R_p, so h is closed. *)
Definition check_closed (ads isos : seq matrix) : bool :=
  all (fun a => msame (mscale (denominator t) (mmul a.1 (quotient t))) (mmul (quotient t) a.2)) (zip ads isos).

(** rho([h_p, h_q]) is the commutator of rho(h_p) and rho(h_q), reversed as these act on rows. *)
Definition check_representation (ads isos : seq matrix) : bool :=
  all (fun a => all (fun b =>
      let w := vmul b.1 a.1 in
      msame (combine (vmul w (dual t)) isos) (commutator b.2 a.2)) (zip (basis t) isos)) (zip ads isos).

Definition check_coordinates (ads isos : seq matrix) : bool :=
  [&& check_spaces, check_closed ads isos, check_representation ads isos & check_jacobi tables].
End Check.

(** ** Soundness *)
Section Lists.
Variable F : numFieldType.
Local Notation num := (num F). Local Notation frac := (frac F).

Lemma coef_bracket_row i j l s :
  coef F (bracket_row j (concerning i s)) l = \sum_(e <- s) entry i j l num e.
Proof.
elim: s => [|[[[a b] k] x] s IH]; first by rewrite big_nil.
rewrite big_cons -IH /= !eqbE.
have H b' k' x' r : coef F (bracket_row j ((b', k', x') :: r)) l
    = num x' * ((b' == j) && (k' == l))%:R + coef F (bracket_row j r) l.
  have -> : bracket_row j ((b', k', x') :: r)
      = if Nat.eqb b' j then vadd [:: (k', x')] (bracket_row j r) else bracket_row j r by [].
  rewrite eqbE; case: (b' =P j) => _; last by rewrite mulr0 add0r.
  by rewrite coef_add /= addr0; case: eqP; rewrite ?mulr1 ?mulr0.
have numN y : num (Z.opp y) = - num y.
  by apply/eqP; rewrite -addr_eq0 -numD Z.add_opp_diag_l.
case: (b =P i) => _; case: (a =P i) => _; rewrite ?H ?numN /= ?subr0 ?sub0r ?mulr0 ?add0r //.
- by rewrite addrA; congr (_ + _); rewrite mulrBr mulNr addrC.
- by rewrite mulrN mulNr.
Qed.

Lemma table_sound n s (i : 'I_n) :
  mat F n n (nth [::] (table n s) i) = \matrix_(j, l) \sum_(e <- s) entry i j l num e.
Proof.
apply/matrixP => j l; rewrite !mxE (nth_map 0%N) ?size_iota // nth_iota // add0n.
by rewrite (nth_map 0%N) ?size_iota // nth_iota // coef_bracket_row.
Qed.

Lemma scaled_frac s q x : num q.2 != 0 -> Z.eqb (Z.mul s q.1) (Z.mul x q.2) -> num x = num s * frac q.
Proof.
move=> q0 /Z.eqb_eq e; rewrite /CheckerPair.frac mulrA -numM e numM mulfK //.
Qed.

Lemma scaled_nth s qs xs j : scaled s qs xs ->
  size qs = size xs /\ num (nth Z0 xs j) = num s * frac (nth (Z0, Zpos xH) qs j).
Proof.
elim: qs xs j => [|[a b] qs IH] [|x xs] j //=.
  by rewrite !nth_nil /CheckerPair.frac /= num0 mul0r mulr0.
case/and3P => b0 e /IH H; split; first by case: (H 0%N) => ->.
case: j => [|j] /=; last by case: (H j).
by apply: scaled_frac => //=; rewrite num_eq0.
Qed.

Lemma replaced_sum s cs xs i j l : scaled s (map snd cs) xs ->
  \sum_(e <- replaced cs xs) entry i j l num e = num s * \sum_(e <- cs) entry i j l frac e.
Proof.
elim: cs xs => [|[[[a b] k] [u v]] cs IH] [|x xs] //=; first by rewrite !big_nil mulr0.
case/and3P => b0 e sc; rewrite !big_cons mulrDr IH //; congr (_ + _).
by rewrite /entry mulrA -(scaled_frac (q := (u, v)) _ e) //= num_eq0.
Qed.

Lemma scaled_rows_nth n M A p : scaled_rows n M A -> (p < size M)%N ->
  exists s, num s != 0 /\ forall j, num (nth Z0 (nth (Z0, [::]) A p).2 j)
    = num s * frac (nth (Z0, Zpos xH) (nth [::] M p) j).
Proof.
elim: M A p => [|r M IH] [|[s xs] A] p //=; case/and4P => s0 _ sc sr.
case: p => [|p] lt; last by apply: (IH A p sr); rewrite -ltnS.
by exists s; split; [rewrite num_eq0 | move=> j; case: (scaled_nth j sc)].
Qed.
Lemma scaled_rows_size n M A : scaled_rows n M A -> size A = size M.
Proof. by elim: M A => [|r M IH] [|[s xs] A] //= /and4P [_ _ _ /IH ->]. Qed.

Lemma scaled_rows_eqmx n M A : scaled_rows n M A ->
  (mat F (size M) n [seq sparse r.2 | r <- A] :=: dense F (size M) n M)%MS.
Proof.
move=> sr; apply/eqmxP/andP.
have H (p : 'I_(size M)) : exists2 s, s != 0 &
    row p (mat F (size M) n [seq sparse r.2 | r <- A]) = s *: row p (dense F (size M) n M).
  have [s [s0 e]] := scaled_rows_nth sr (ltn_ord p); exists (num s) => //; apply/rowP => j.
  by rewrite !mxE (nth_map (Z0, [::])) ?(scaled_rows_size sr) // coef_sparse e.
split; apply/row_subP => p; case: (H p) => s s0 e.
  by rewrite e scalemx_sub ?row_sub.
have -> : row p (dense F (size M) n M) = s^-1 *: row p (mat F (size M) n [seq sparse r.2 | r <- A]).
  by rewrite e scalerA mulVf ?scale1r.
by rewrite scalemx_sub ?row_sub.
Qed.
End Lists.

Section Sound.
Variables (F : numFieldType) (p : pair_data) (t : coordinates_hint).
Local Notation num := (num F).
Local Notation n := (dimension p). Local Notation k := (size (rows p)). Local Notation d := (codimension t).

(** The algebra, h, and the coordinates over F. *)
Definition c_of := constants_of F (n := n) (constants p).
Definition h_of : 'M[F]_(k, n) := dense F k n (rows p).
Definition G_of : 'M[F]_(k, n) := mat F k n (basis t).
Definition Q_of : 'M[F]_(n, d) := mat F n d (quotient t).
Definition E_of : 'M[F]_(d, n) := (num (denominator t))^-1 *: mat F d n (section t).
(** The factor of the integral isotropy. *)
Definition size_of : F := num (scale t) * num (denominator t).

Local Notation ads := (adjoint p t).
Local Notation isos := (isotropies t ads).

Hypothesis spaces : check_spaces p t.

Lemma size_G : size (basis t) = k. Proof. by case/and5P: spaces => _ _ _ _ /and5P [_ /Nat.eqb_eq]. Qed.
Lemma size_Q : (size (quotient t) <= n)%N. Proof. by case/and5P: spaces => _ _ _ _ /and5P [_ _ /Nat.eqb_eq ->]. Qed.
Lemma size_S : (size (dual t) <= n)%N. Proof. by case/and5P: spaces => _ _ _ _ /and5P [_ _ _ /Nat.eqb_eq ->]. Qed.
Lemma size_E : (size (section t) <= d)%N.
Proof. by case/and5P: spaces => _ _ _ _ /and5P [/andP [_ /Nat.eqb_eq ->]]. Qed.
Lemma denominator_neq0 : num (denominator t) != 0.
Proof. by case/and5P: spaces => _ _ _ _ /and5P [_ _ _ _ /and5P [q0 _ _ _ _]]; rewrite num_eq0. Qed.
Lemma scale_neq0 : num (scale t) != 0. Proof. by case/and5P: spaces => _ D0 _ _ _; rewrite num_eq0. Qed.
Lemma size_of_neq0 : size_of != 0. Proof. by rewrite mulf_neq0 ?denominator_neq0 ?scale_neq0. Qed.
Lemma size_ads : size ads = k. Proof. by rewrite size_map size_G. Qed.
Lemma size_isos : size isos = k. Proof. by rewrite size_map size_ads. Qed.

Lemma EQ1 : E_of *m Q_of = 1%:M.
Proof.
case/and5P: spaces => _ _ _ _ /and5P [_ _ _ _ /and5P [_ _ _ _ /andP [e _]]].
move/(@mat_same F d d): e; rewrite mat_id (mat_mul _ _ _ _ size_Q) => e.
by rewrite -scalemxAl e scale_scalar_mx mulVf ?denominator_neq0.
Qed.

Lemma GS : G_of *m mat F n k (dual t) = (num (denominator t))%:M.
Proof.
case/and5P: spaces => _ _ _ _ /and5P [_ _ _ _ /and5P [_ _ _ _ /andP [_ e]]].
by move/(@mat_same F k k): e; rewrite mat_id (mat_mul _ _ _ _ size_S).
Qed.

Lemma rank_G : \rank G_of = k.
Proof.
apply/eqP; rewrite eqn_leq rank_leq_row /=.
have := mxrankM_maxl G_of (mat F n k (dual t)).
by rewrite GS -scalemx1 mxrank_scale_nz ?mxrank1 ?denominator_neq0.
Qed.
Lemma rank_Q : \rank Q_of = d.
Proof.
by apply/eqP; rewrite eqn_leq rank_leq_col /=; have := mxrankM_maxr E_of Q_of; rewrite EQ1 mxrank1.
Qed.

Local Notation Hi := (mat F k n (subalgebra_matrix t)).
Lemma h_integral : (Hi :=: h_of)%MS.
Proof. by case/and5P: spaces => _ _ _ sr _; apply: scaled_rows_eqmx. Qed.

Lemma h_kerQ : (h_of :=: kermx Q_of)%MS /\ (G_of :=: h_of)%MS.
Proof.
case/and5P: spaces => _ _ _ sr /and5P [/andP [/Nat.eqb_eq kd _] _ _ _ /and5P [_ f0 TH HQ _]].
have sH : (size (subalgebra_matrix t) <= k)%N by rewrite size_map (scaled_rows_size sr).
have hQ : (h_of <= kermx Q_of)%MS.
  rewrite -h_integral; apply/sub_kermxP.
  by move/(@mat_zero F k d): HQ; rewrite (mat_mul _ _ _ _ size_Q).
have Gh : (G_of <= h_of)%MS.
  rewrite -h_integral; move/(@mat_same F k n): TH; rewrite (mat_mul _ _ _ _ sH) mat_scale => e.
  have -> : G_of = (num (factor t))^-1 *: (num (factor t) *: mat F k n (basis t)).
    by rewrite scalerA mulVf ?scale1r ?num_eq0.
  by rewrite -e scalemx_sub ?submxMl.
have rk : \rank (kermx Q_of) = k by rewrite mxrank_ker rank_Q -kd addnK.
have rh : \rank h_of = k.
  by apply/eqP; rewrite eqn_leq rank_leq_row -{1}rank_G mxrankS.
split; apply/eqmxP; first by rewrite hQ -(geq_leqif (mxrank_leqif_sup hQ)) rk rh leqnn.
by rewrite Gh -(geq_leqif (mxrank_leqif_sup Gh)) rank_G rh leqnn.
Qed.

Lemma coordinates_G : coordinates G_of Q_of E_of.
Proof.
case: h_kerQ => hk Gh; split; last by rewrite Gh hk.
  by apply/sub_kermxP; rewrite Gh hk.
exact: EQ1.
Qed.

Lemma tables_sound (i : 'I_n) : mat F n n (nth [::] (tables p t) i) = num (scale t) *: c_of i.
Proof.
apply/matrixP => j l; rewrite table_sound !mxE.
by case/and5P: spaces => _ _ sc _ _; apply: replaced_sum.
Qed.

Lemma lie_algebra_c : check_jacobi p (tables p t) -> lie_algebra c_of.
Proof.
move=> jacobi; apply: basis_lie_algebra => [i j | i j lt].
  apply/rowP => l; rewrite !mxE -sumrN; apply: eq_bigr => -[[[a b] x] y] _.
  by rewrite /entry -mulrN opprB (andbC (a == i)) (andbC (b == i)).
have sT : size (tables p t) = n by rewrite size_map size_iota.
have sA (q : 'I_n) : size (nth [::] (tables p t) q) = n by rewrite (nth_map 0%N) ?size_map ?size_iota.
move/(all_nthP 0%N): jacobi => /(_ i); rewrite size_iota ltn_ord => /(_ isT); rewrite nth_iota // add0n.
move/(all_nthP ([::], [::])) => /(_ (j - i.+1)%N); rewrite size_zip !size_drop sT sA minnn.
rewrite (ltn_sub2r (leq_ltn_trans lt (ltn_ord j)) (ltn_ord j)) => /(_ isT).
rewrite nth_zip ?size_drop ?sT ?sA // !nth_drop subnKC //= => /(@mat_same F n n).
rewrite (mat_combine _ _ _ (k := n)) ?sT // mat_add mat_scale numN1 scaleN1r !(mat_mul _ _ _ _ (eq_leq (sA _))) !tables_sound => e.
apply: (scalerI (mulf_neq0 scale_neq0 scale_neq0)).
have -> : num (scale t) * num (scale t) *: (c_of j *m c_of i - c_of i *m c_of j)
    = num (scale t) *: c_of j *m (num (scale t) *: c_of i) - num (scale t) *: c_of i *m (num (scale t) *: c_of j).
  by rewrite -!scalemxAl -!scalemxAr !scalerA scalerBr.
rewrite -e /ad scaler_sumr; apply: eq_bigr => q _; rewrite tables_sound !scalerA; congr (_ *: _).
have := congr1 (fun A : 'M_n => A j q) (tables_sound i); rewrite [LHS]mxE => ->.
by rewrite !mxE mulrAC.
Qed.

Lemma ads_sound (r : 'I_k) : mat F n n (nth [::] ads r) = num (scale t) *: ad c_of (row r G_of).
Proof.
rewrite (nth_map [::]) ?size_G // (mat_combine _ _ _ (k := n)) ?size_map ?size_iota //.
rewrite /ad scaler_sumr; apply: eq_bigr => i _; rewrite !mxE scalerA mulrC -scalerA; congr (_ *: _).
exact: tables_sound.
Qed.

Lemma size_ad (r : 'I_k) : (size (nth [::] ads r) <= n)%N.
Proof.
rewrite (nth_map [::]) ?size_G //; apply: size_combine; apply/allP => a /mapP [i _ ->].
by rewrite size_map size_iota.
Qed.

Lemma isos_sound (r : 'I_k) : mat F d d (nth [::] isos r) = size_of *: rho c_of G_of Q_of E_of r.
Proof.
rewrite (nth_map [::]) ?size_ads // !(mat_mul _ _ _ _ size_Q).
rewrite (mat_mul _ _ _ _ (size_ad r)) ads_sound /rho /isotropy -!scalemxAl -!scalemxAr -!scalemxAl !scalerA.
by rewrite /size_of mulfK ?denominator_neq0.
Qed.

Lemma size_isotropy (r : 'I_k) : (size (nth [::] isos r) <= d)%N.
Proof. by rewrite (nth_map [::]) ?size_ads // !size_map size_E. Qed.

Lemma size_isotropy_of z : (size (isotropy_of t isos z) <= d)%N.
Proof.
apply: size_combine; apply/allP => A /(nthP [::]) [r rk <-].
by rewrite size_isos in rk; apply: (size_isotropy (Ordinal rk)).
Qed.

Lemma isotropy_of_sound z : (vec F n z <= G_of)%MS ->
  mat F d d (isotropy_of t isos z) = (num (denominator t) * size_of) *: isotropy c_of Q_of E_of (vec F n z).
Proof.
case/submxP => u zu; rewrite (mat_combine _ _ _ (k := k)) ?size_isos //.
rewrite zu isotropy_h scaler_sumr; apply: eq_bigr => r _; rewrite isos_sound //.
have <- : vec F k (vmul z (dual t)) 0 r = coef F (vmul z (dual t)) r by rewrite mxE.
rewrite (vec_mul _ _ _ size_S) zu -mulmxA GS // mul_mx_scalar mxE !scalerA.
by congr (_ *: _); rewrite mulrAC.
Qed.

Lemma in_h z : vzero (vmul z (quotient t)) -> (vec F n z <= G_of)%MS.
Proof.
move/(vec_zero F d); rewrite (vec_mul _ _ _ size_Q) => zQ.
by case: h_kerQ => hk Gh; rewrite Gh hk; apply/sub_kermxP.
Qed.

Hypothesis closed_h : check_closed t ads isos.

Lemma ad_Q (r : 'I_k) : ad c_of (row r G_of) *m Q_of = Q_of *m rho c_of G_of Q_of E_of r.
Proof.
move/(all_nthP ([::], [::])): closed_h => /(_ r).
rewrite size_zip size_ads size_isos minnn ltn_ord => /(_ isT).
rewrite nth_zip ?size_ads ?size_isos // => /(@mat_same F n d) /=.
rewrite mat_scale (mat_mul _ _ _ _ size_Q) (mat_mul _ _ _ _ (size_isotropy r)) ads_sound isos_sound.
rewrite -scalemxAl -scalemxAr scalerA mulrC -/size_of => /(congr1 (fun x => size_of^-1 *: x)).
by rewrite !scalerA mulVf ?size_of_neq0 // !scale1r.
Qed.

Lemma closed_G : closed c_of G_of.
Proof.
move=> r s; case: h_kerQ => hk Gh; rewrite Gh hk; apply/sub_kermxP.
have /sub_kermxP GQ : (row s G_of <= kermx Q_of)%MS by rewrite (submx_trans (row_sub _ _)) // Gh hk.
by rewrite /bracket -mulmxA ad_Q mulmxA GQ mul0mx.
Qed.

Hypothesis homomorphism : check_representation t ads isos.

Lemma representation_G : representation c_of G_of Q_of E_of.
Proof.
move=> r s; move/(all_nthP ([::], [::])): homomorphism => /(_ r).
rewrite size_zip size_ads size_isos minnn ltn_ord => /(_ isT) /(all_nthP ([::], [::])) /(_ s).
rewrite size_zip size_G size_isos minnn ltn_ord => /(_ isT).
rewrite !nth_zip ?size_ads ?size_isos ?size_G // => /(@mat_same F d d) /=.
rewrite (mat_combine _ _ _ (k := k)) ?size_isos // mat_add mat_scale numN1 scaleN1r.
rewrite !(mat_mul _ _ _ _ (size_isotropy _)) !isos_sound.
set w := vmul _ _; have [u bu] := submxP (closed_G r s).
have ew : vec F k w = size_of *: u.
  rewrite /w (vec_mul _ _ _ size_S) (vec_mul _ _ _ (size_ad r)).
  rewrite -row_mat -/G_of ads_sound -scalemxAr -/(bracket _ _ _) bu -scalemxAl -mulmxA GS.
  by rewrite mul_mx_scalar scalerA.
have -> : \sum_(q < k) coef F w q *: mat F d d (nth [::] isos q)
    = (size_of * size_of) *: isotropy c_of Q_of E_of (bracket c_of (row r G_of) (row s G_of)).
  rewrite bu isotropy_h scaler_sumr; apply: eq_bigr => q _; rewrite isos_sound.
  have <- : vec F k w 0 q = coef F w q by rewrite mxE.
  by rewrite ew mxE !scalerA mulrC mulrA.
rewrite -!scalemxAl -!scalemxAr !scalerA -scalerBr => e.
exact: (scalerI (mulf_neq0 size_of_neq0 size_of_neq0) e).
Qed.
End Sound.

Arguments c_of : clear implicits.

(** The verified pair is valid, for the basis G of h; (6.4) for G is (6.4) for the rows of h that are given. *)
Theorem check_coordinates_sound (F : numFieldType) (p : pair_data) (t : coordinates_hint) :
  check_coordinates p t (adjoint p t) (isotropies t (adjoint p t)) ->
  valid_pair (c_of F p) (G_of F p t) (Q_of F p t) (E_of F p t) /\
  (full_pair (c_of F p) (G_of F p t) <-> pair_is_full F p).
Proof.
case/and4P => sp cl rp _; split.
  split; [exact: closed_G | exact: coordinates_G | exact: representation_G].
have [_ Gh] := h_kerQ F sp; rewrite /pair_is_full -/(c_of F p) -/(h_of F p).
split=> f eta etah v.
  have [| u [z [s [uh zh ->]]]] := f eta _ v; first by rewrite Gh.
  by exists u, z, s; rewrite -!Gh.
have [| u [z [s [uh zh ->]]]] := f eta _ v; first by rewrite -Gh.
by exists u, z, s; rewrite !Gh.
Qed.

(** The data that the checker accepts are a Lie algebra and a basis of a subalgebra. *)
Theorem check_valid_sound (F : numFieldType) (p : pair_data) (t : coordinates_hint) :
  check_coordinates p t (adjoint p t) (isotropies t (adjoint p t)) -> pair_is_valid F p.
Proof.
case/and4P => sp cl _ jac; have [_ Gh] := h_kerQ F sp; split; first exact: lie_algebra_c jac.
  have cb x y : (x <= h_of F p)%MS -> (y <= h_of F p)%MS -> (bracket (c_of F p) x y <= h_of F p)%MS.
    by rewrite -!Gh; apply: closed_bracket; apply: closed_G.
  by move=> r s; apply: cb; apply: row_sub.
by rewrite /row_free -Gh rank_G.
Qed.
