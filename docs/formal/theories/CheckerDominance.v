(** The kind dominance: an element of h with too small a top space, in integers.

    The number of eigenvalues to the right of a line is the number of positive entries of D for a proposed symmetric
    form H = V D V^T with (A - c) H + H (A - c)^T positive definite (Inertia.v). Three such counts are verified: for A, the
    isotropy of the element minus a multiple of 1, at cut and at cut - eps; and for the bracket with the element on a
    family of isotropy matrices that spans rho(h), at -eps. The element is multiplied by a number that makes all
    matrices and numbers integral. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra zify.ssrZ.
From Liehom Require Import Sound Pair Certificate Inertia CheckerAlgebra CheckerPair CheckerFull.
Set Implicit Arguments. Unset Strict Implicit. Unset Printing Implicit Defensive.
Import Order.TTheory GRing.Theory Num.Theory. Local Open Scope ring_scope.

(** ** Functions *)
Record count_hint := CountHint {
  frame : matrix; frame_inverse : matrix; frame_factor : Z; (** V and its inverse *)
  signature : seq Z;                                        (** D *)
  positivity : factors
}.

Record dominance := Dominance {
  element : vector; shift : Z; cut : Z; eps : Z;
  family : seq nat; family_coordinates : matrix; family_factor : Z; (** factor R_p = sum of coordinates R_j, j in family *)
  bracket_matrix : matrix;
  top_count : nat; high_count : nat; at_cut : count_hint; below_cut : count_hint; on_image : count_hint
}.

Definition check_count (d : nat) (A : matrix) (c : Z) (m : nat) (i : count_hint) : bool :=
  let V := frame i in
  let H := mmul (mmul V (diagonal (signature i))) (mtranspose d d V) in
  let half := mmul (madd A (mid (Z.opp c) d)) H in
  [&& Nat.eqb (size V) d, Nat.eqb (size (frame_inverse i)) d, ~~ Z.eqb (frame_factor i) Z0,
      msame (mmul V (frame_inverse i)) (mid (frame_factor i) d)
    & [&& Nat.eqb (size (signature i)) d, Nat.eqb (count (Z.ltb Z0) (signature i)) m
        & check_definite d (positivity i) (madd half (mtranspose d d half))]].

Section Check.
Variables (p : pair_data) (t : coordinates_hint) (isos : seq matrix) (w : dominance).
Let d := codimension t.
Let l := size (family w).

Definition check_dominance : bool :=
  let K := isotropy_of t isos (element w) in
  let A := madd K (mid (Z.opp (shift w)) d) in
  let Bs := [seq nth [::] isos j | j <- family w] in
  [&& vzero (vmul (element w) (quotient t)), Z.ltb Z0 (eps w), ~~ Z.eqb (family_factor w) Z0,
      Nat.eqb (size (family_coordinates w)) (size (rows p)) && Nat.eqb (size (bracket_matrix w)) l
    & [&& all (fun j => Nat.ltb j (size (rows p))) (family w),
          all (fun r => msame (mscale (family_factor w) r.1) (combine r.2 Bs)) (zip isos (family_coordinates w)),
          all (fun r => msame (commutator r.1 K) (combine r.2 Bs)) (zip Bs (bracket_matrix w)),
          Nat.ltb 0 (top_count w) && Nat.ltb (top_count w + (l - high_count w)) d
        & [&& check_count d A (cut w) (top_count w) (at_cut w),
              check_count d A (Z.add (cut w) (Z.opp (eps w))) (top_count w) (below_cut w)
            & check_count l (bracket_matrix w) (Z.opp (eps w)) (high_count w) (on_image w)]]].
End Check.

(** ** Soundness *)
Section Sound.
Variable R : rcfType.
Local Notation num := (num R).

Lemma numN z : num (Z.opp z) = - num z.
Proof. by apply/eqP; rewrite -addr_eq0 -numD Z.add_opp_diag_l. Qed.

Lemma check_count_sound d A c m i : check_count d A c m i -> right_count (mat R d d A) (num c) m.
Proof.
case/and5P => /Nat.eqb_eq sV /Nat.eqb_eq sI f0 VI /and3P [/Nat.eqb_eq sS /Nat.eqb_eq cS pos].
pose V := mat R d d (frame i); pose D : 'rV[R]_d := \row_j num (nth Z0 (signature i) j).
exists (V *m diag_mx D *m V^T), V, D; split=> //.
- by apply: (@mat_unit _ _ _ (frame_inverse i) (frame_factor i)); rewrite ?sI.
- case: (check_definite_sound R pos) => _; rewrite mat_add mat_transpose.
  rewrite (mat_mul (m := d) _ _ _) ?size_map ?size_iota ?sV // (mat_form R sV sS) mat_add mat_id numN -/V -/D.
  by rewrite raddfN !trmx_mul trmxK tr_diag_mx [V *m (_ *m _)]mulmxA; apply.
rewrite -cS -sum1_card -sum1_count (big_nth Z0) sS big_mkord; apply: eq_bigl => j.
by rewrite inE mxE num_gt0.
Qed.

Variables (p : pair_data) (t : coordinates_hint) (w : dominance).
Local Notation d := (codimension t). Local Notation k := (size (rows p)).
Local Notation ads := (adjoint p t). Local Notation isos := (isotropies t ads).
Local Notation l := (size (family w)).

Theorem check_dominance_sound :
  check_coordinates p t ads isos -> check_dominance p t isos w -> ~ pair_is_full R p.
Proof.
move=> cc; have [valid <-] := check_coordinates_sound R cc.
have sp : check_spaces p t by case/and3P: cc.
case/and5P => zh e0 f0 /andP [/Nat.eqb_eq sF /Nat.eqb_eq sM].
case/and5P => inside fam adj /andP [/Nat.ltb_lt/ssrnat.ltP top0 /Nat.ltb_lt/ssrnat.ltP lt] /and3P [c1 c2 c3].
set K := isotropy_of t isos (element w) in adj c1 c2; set Bs := [seq nth [::] isos j | j <- family w] in fam adj.
have sB : size Bs = l by rewrite size_map.
have sBj (j : 'I_l) : (size (nth [::] Bs j) <= d)%N.
  rewrite (nth_map 0%N) //; move/(all_nthP 0%N): inside => /(_ j (ltn_ord j)) /Nat.ltb_lt/ssrnat.ltP jk.
  exact: (size_isotropy sp (Ordinal jk)).
pose g : R := num (denominator t) * size_of R t.
pose X : 'rV[R]_(dimension p) := g *: vec R _ (element w).
have iX : isotropy (c_of R p) (Q_of R p t) (E_of R p t) X = mat R d d K.
  by rewrite /K isotropy_of_sound ?in_h // /X (linearZZ (isotropy_linear _ _ _)).
have {}c1 := check_count_sound c1; have {}c2 := check_count_sound c2; have {}c3 := check_count_sound c3.
move: c1 c2 c3; rewrite !mat_add !mat_id !numN raddfN -iX => c1 c2 c3.
move: c2; rewrite numD numN => c2.
pose B (j : 'I_l) := mat R d d (nth [::] Bs j); pose M := mat R l l (bracket_matrix w).
have rhoB q : exists u : 'I_l -> R, rho (c_of R p) (G_of R p t) (Q_of R p t) (E_of R p t) q = \sum_j u j *: B j.
  move/(all_nthP ([::], [::])): fam => /(_ q); rewrite size_zip (size_isos sp) sF minnn ltn_ord => /(_ isT).
  rewrite nth_zip ?(size_isos sp) ?sF // => /(@mat_same R d d) /=.
  rewrite mat_scale (mat_combine _ _ _ (k := l)) // isos_sound // scalerA => e.
  have x0 : num (family_factor w) * size_of R t != 0 by rewrite mulf_neq0 ?num_eq0 // (size_of_neq0 R sp).
  exists (fun j => (num (family_factor w) * size_of R t)^-1 * coef R (nth [::] (family_coordinates w) q) j).
  apply: (scalerI x0); rewrite e scaler_sumr; apply: eq_bigr => j _.
  by rewrite scalerA mulrA mulfV // mul1r.
have adB j : B j *m isotropy (c_of R p) (Q_of R p t) (E_of R p t) X - isotropy (c_of R p) (Q_of R p t) (E_of R p t) X *m B j
    = \sum_g M j g *: B g.
  move/(all_nthP ([::], [::])): adj => /(_ j); rewrite size_zip sB sM minnn ltn_ord => /(_ isT).
  rewrite nth_zip ?sB ?sM // => /(@mat_same R d d) /=.
  rewrite (mat_combine _ _ _ (k := l)) // mat_add mat_scale numN1 scaleN1r.
  rewrite (mat_mul _ _ _ _ (size_isotropy_of sp _)) (mat_mul _ _ _ _ (sBj j)) -iX => ->.
  by apply: eq_bigr => g' _; rewrite mxE.
have e0' : 0 < num (eps w) by rewrite num_gt0.
have nf := @dominance_count_sound R R [rmorphism of idfun] _ _ _ _ _ _ _ X (num (shift w)) l B M (num (cut w)) (num (eps w))
  (top_count w) (high_count w) (fun x => id) valid e0' rhoB adB c1 c2 c3 top0 lt.
move=> full; apply: nf => eta etah v; have := full eta; rewrite map_mx_id // in etah *.
move=> /(_ etah v) [u [z [s []]]] uh zh' ->; exists u, z, s; split=> //.
congr (_ + _ *m _ + _); apply: eq_bigr => i' _; by rewrite /map_pair map_mx_id.
Qed.
End Sound.
