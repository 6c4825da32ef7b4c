(** Pairs (g, h) given by structure constants, and fullness (6.4).

    Source: docs/theory/fullness.md, section 1.

    g has the basis e_0, ..., e_(n-1); [c i] is the matrix of ad e_i on row vectors, so its row j is [e_i, e_j]. h is
    the row space of a matrix with k rows. [full_pair] is (6.4) word for word: for eta outside h, every element of g is
    a sum of an element of h, of some [z, eta] with z in h, and of a multiple of eta.

    Coordinates on V = g/h are a matrix Q (n x d) with kernel h and a section E (d x n): x mod h has the coordinates
    x Q, and E Q = 1. In them the isotropy representation is rho_p = E (ad h_p) Q. [full_pairP] is the bridge: the pair
    is full if and only if the matrices rho_p are, in the sense of Sound.v. *)
From mathcomp Require Import all_ssreflect all_algebra.
From Liehom Require Import Sound.
Set Implicit Arguments. Unset Strict Implicit. Unset Printing Implicit Defensive.
Import GRing.Theory. Local Open Scope ring_scope.

Section Definitions.
Variables (F : fieldType) (n k d : nat).
Variables (c : 'I_n -> 'M[F]_n) (h : 'M[F]_(k, n)) (Q : 'M[F]_(n, d)) (E : 'M[F]_(d, n)).

Definition ad (x : 'rV[F]_n) : 'M[F]_n := \sum_i x 0 i *: c i.
Definition bracket (x y : 'rV[F]_n) : 'rV[F]_n := y *m ad x.

(** Antisymmetry and the Jacobi identity. *)
Definition lie_algebra :=
  (forall x, bracket x x = 0) /\
  (forall x y z, bracket x (bracket y z) = bracket (bracket x y) z + bracket y (bracket x z)).

(** (6.4) for every eta outside h. *)
Definition full_pair :=
  forall eta : 'rV[F]_n, ~~ (eta <= h)%MS ->
  forall v : 'rV[F]_n, exists u z t,
    [/\ (u <= h)%MS, (z <= h)%MS & v = u + bracket z eta + t *: eta].

Definition closed := forall p q, (bracket (row p h) (row q h) <= h)%MS.

(** Q has kernel h, and E is a section of Q. *)
Definition coordinates := [/\ h *m Q = 0, E *m Q = 1%:M & (kermx Q <= h)%MS].

(** The isotropy representation of an element of h, and of the rows of h. *)
Definition isotropy (z : 'rV[F]_n) : 'M[F]_d := E *m ad z *m Q.
Definition rho (p : 'I_k) : 'M[F]_d := isotropy (row p h).

(** rho is a representation. Row vectors reverse the order of a product. *)
Definition representation :=
  forall p q, isotropy (bracket (row p h) (row q h)) = rho q *m rho p - rho p *m rho q.

(** What every certificate supposes of its pair; the checker verifies it first. *)
Definition valid_pair := [/\ closed, coordinates & representation].
End Definitions.

Section Bridge.
Variables (F : fieldType) (n k d : nat).
Variables (c : 'I_n -> 'M[F]_n) (h : 'M[F]_(k, n)) (Q : 'M[F]_(n, d)) (E : 'M[F]_(d, n)).
Local Notation ad := (ad c). Local Notation bracket := (bracket c). Local Notation rho := (rho c h Q E).
Local Notation isotropy := (isotropy c Q E).

Lemma ad_is_linear : linear ad.
Proof.
move=> a x y; rewrite /Pair.ad scaler_sumr -big_split /=; apply: eq_bigr => i _.
by rewrite !mxE scalerDl scalerA.
Qed.
Canonical ad_linear := Linear ad_is_linear.

Lemma isotropy_is_linear : linear isotropy.
Proof.
by move=> a x y; rewrite /Pair.isotropy linearP /= mulmxDr mulmxDl -scalemxAr -scalemxAl.
Qed.
Canonical isotropy_linear := Linear isotropy_is_linear.

Lemma bracketDl x y z : bracket (x + y) z = bracket x z + bracket y z.
Proof. by rewrite /Pair.bracket linearD mulmxDr. Qed.
Lemma bracketDr x y z : bracket x (y + z) = bracket x y + bracket x z.
Proof. by rewrite /Pair.bracket mulmxDl. Qed.

(** An element of h is a combination of the rows of h; so are its ad and its isotropy. *)
Lemma ad_h (u : 'rV[F]_k) : ad (u *m h) = \sum_p u 0 p *: ad (row p h).
Proof.
rewrite mulmx_sum_row (linear_sum ad_linear); apply: eq_bigr => p _; exact: (linearZZ ad_linear).
Qed.
Lemma isotropy_h (u : 'rV[F]_k) : isotropy (u *m h) = \sum_p u 0 p *: rho p.
Proof.
rewrite mulmx_sum_row (linear_sum isotropy_linear); apply: eq_bigr => p _; exact: (linearZZ isotropy_linear).
Qed.

Hypothesis (hclosed : closed c h) (hcoord : coordinates h Q E).

Lemma in_h_kerQ (x : 'rV[F]_n) : (x <= h)%MS = (x *m Q == 0).
Proof.
case: hcoord => hQ _ kQ; apply/idP/eqP => [/submxP [u ->] | xQ].
  by rewrite -mulmxA hQ mulmx0.
by apply: submx_trans kQ; apply/sub_kermxP.
Qed.

Lemma closed_bracket x y : (x <= h)%MS -> (y <= h)%MS -> (bracket x y <= h)%MS.
Proof.
move=> /submxP [u ->] /submxP [w ->]; rewrite /Pair.bracket ad_h mulmx_sumr.
apply: summx_sub => p _; rewrite -scalemxAr; apply: scalemx_sub.
rewrite (mulmx_sum_row w) mulmx_suml; apply: summx_sub => q _; rewrite -scalemxAl; apply: scalemx_sub; exact: hclosed.
Qed.

(** Modulo h, bracketing by z in h is the matrix isotropy z. *)
Lemma bracketQ (z x : 'rV[F]_n) : (z <= h)%MS -> bracket z x *m Q = x *m Q *m isotropy z.
Proof.
move=> zh; case: (hcoord) => hQ EQ _.
have rh : (x - x *m Q *m E <= h)%MS by rewrite in_h_kerQ mulmxBl -!mulmxA EQ mulmx1 subrr.
have: (bracket z (x - x *m Q *m E) <= h)%MS by exact: closed_bracket.
rewrite in_h_kerQ /Pair.bracket mulmxBl mulmxBl subr_eq0 => /eqP ->.
by rewrite /Pair.isotropy !mulmxA.
Qed.

Theorem full_pairP : full_pair c h <-> full rho.
Proof.
case: (hcoord) => hQ EQ kQ; split=> [fp x x0 | fr eta etah v].
  have eh : ~~ (x *m E <= h)%MS by rewrite in_h_kerQ -mulmxA EQ mulmx1.
  rewrite -sub1mx; apply/row_subP => i; set e := row i _.
  have [u [z [t [uh zh eq]]]] := fp _ eh (e *m E).
  have {eq} -> : e = x *m isotropy z + t *: x.
    have -> : e = e *m E *m Q by rewrite -mulmxA EQ mulmx1.
    rewrite eq !mulmxDl bracketQ // -scalemxAl -(mulmxA x) EQ mulmx1.
    by move: uh; rewrite in_h_kerQ => /eqP ->; rewrite add0r.
  by case/submxP: zh => w ->; rewrite isotropy_h; apply/span_atP; exists (w 0), t.
have x0 : eta *m Q != 0 by rewrite -in_h_kerQ.
have /span_atP [s [t eqv]] : (v *m Q <= span_at rho (eta *m Q))%MS by apply: submx_full; apply: fr.
pose z : 'rV[F]_n := (\row_i s i) *m h; have zh : (z <= h)%MS := submxMl _ _.
have ez : isotropy z = \sum_i s i *: rho i.
  by rewrite isotropy_h; apply: eq_bigr => p _; rewrite mxE.
exists (v - bracket z eta - t *: eta), z, t; split => //.
  by rewrite in_h_kerQ !mulmxBl bracketQ // ez eqv -scalemxAl addrAC addrK subrr.
by rewrite addrAC !subrK.
Qed.
End Bridge.

(** The Jacobi identity of g gives the representation property, so a Lie algebra and a subalgebra are a valid pair. *)
Lemma jacobi_representation (F : fieldType) (n k d : nat) (c : 'I_n -> 'M[F]_n) (h : 'M[F]_(k, n))
    (Q : 'M[F]_(n, d)) (E : 'M[F]_(d, n)) :
  lie_algebra c -> closed c h -> coordinates h Q E -> valid_pair c h Q E.
Proof.
move=> [_ jac] hc hq; split=> // p q; case: (hq) => hQ EQ kQ.
apply/row_matrixP => i; rewrite [LHS]rowE [RHS]rowE; set x := delta_mx 0 i : 'rV_d; rewrite /rho.
have inh r : (row r h <= h)%MS by apply: row_sub.
have [w ->] : exists w, x = w *m Q by exists (x *m E); rewrite -mulmxA EQ mulmx1.
have act r y : y *m Q *m isotropy c Q E (row r h) = bracket c (row r h) y *m Q by rewrite (bracketQ hc hq) ?inh.
rewrite -[LHS](bracketQ hc hq w (hc p q)) mulmxBr (mulmxA _ (isotropy _ _ _ _)) (act q) (act p).
rewrite [X in _ = _ - X]mulmxA (act p) (act q).
by rewrite -mulmxBl jac addrK.
Qed.

(** Antisymmetry for basis elements, and the Jacobi identity for two of them and all others, make a Lie algebra. *)
Lemma basis_lie_algebra (F : numFieldType) (n : nat) (c : 'I_n -> 'M[F]_n) :
  (forall i j, row j (c i) = - row i (c j)) ->
  (forall i j : 'I_n, (i < j)%N -> ad c (row j (c i)) = c j *m c i - c i *m c j) -> lie_algebra c.
Proof.
move=> anti jac.
have double m (A : 'M[F]_(m, n)) : A = - A -> A = 0.
  by move/eqP; rewrite -addr_eq0 -mulr2n -scaler_nat scaler_eq0 Num.Theory.pnatr_eq0 => /eqP.
have adN x : ad c (- x) = - ad c x := linearN (ad_linear c) x.
have adZ a x : ad c (a *: x) = a *: ad c x by exact: (linearZZ (ad_linear c)).
have ad_sum (f : 'I_n -> 'rV_n) : ad c (\sum_i f i) = \sum_i ad c (f i) by exact: (linear_sum (ad_linear c)).
have jac_all i j : ad c (row j (c i)) = c j *m c i - c i *m c j.
  case: (ltngtP i j) => [|lt|/val_inj <-]; first exact: jac.
    by rewrite anti adN jac // opprB.
  by rewrite (double _ _ (anti i i)) -(scale0r 0) adZ scale0r subrr.
have bracketE x y : bracket c x y = \sum_i \sum_j (x 0 i * y 0 j) *: row j (c i).
  rewrite /bracket /ad mulmx_sumr; apply: eq_bigr => i _.
  by rewrite -scalemxAr mulmx_sum_row scaler_sumr; apply: eq_bigr => j _; rewrite scalerA.
have mulE x y : ad c x *m ad c y = \sum_i \sum_j (x 0 i * y 0 j) *: (c i *m c j).
  rewrite /ad mulmx_suml; apply: eq_bigr => i _; rewrite mulmx_sumr; apply: eq_bigr => j _.
  by rewrite -scalemxAl -scalemxAr scalerA.
have adE x y : ad c (bracket c x y) = ad c y *m ad c x - ad c x *m ad c y.
  rewrite bracketE ad_sum !mulE [X in _ = X - _]exchange_big -sumrB; apply: eq_bigr => i _.
  rewrite ad_sum -sumrB; apply: eq_bigr => j _.
  by rewrite adZ jac_all scalerBr (mulrC (y 0 j)).
split=> [x | x y z].
  apply: double; rewrite !bracketE [LHS]exchange_big -sumrN; apply: eq_bigr => i _.
  by rewrite -sumrN; apply: eq_bigr => j _; rewrite (anti j i) scalerN (mulrC (x 0 j)).
by rewrite /bracket -/(bracket c x y) adE mulmxBr !mulmxA subrK.
Qed.

(** Kind trivial: if g/h has dimension at most one, the pair is full: there is no x != 0, or Rx = V. *)
Theorem trivial_sound (F : fieldType) (d k : nat) (r : 'I_k -> 'M[F]_d) : (d <= 1)%N -> full r.
Proof.
move=> d1 x x0; have: (\rank x <= \rank (span_at r x))%N by apply: mxrankS; apply: addsmxSl.
rewrite rank_rV x0 => le; rewrite /row_full eqn_leq rank_leq_col /=; exact: leq_trans le.
Qed.
