(** The kind commutant: a matrix T that commutes with rho(h), in integers.

    By Commutant.v the pair is not full if T is not a multiple of 1, and 1, T, T^2 are linearly independent, or
    T^2 = x T + y with x^2 + 4 y >= 0. [check_commutant] verifies this at two or three entries of T that somebody
    proposes. A matrix with eigenvalues on both sides of a line Re = cut is of this kind, whatever the cut. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra zify.ssrZ ring.
From Liehom Require Import Sound Pair Commutant CheckerAlgebra CheckerPair.
Set Implicit Arguments. Unset Strict Implicit. Unset Printing Implicit Defensive.
Import Order.TTheory GRing.Theory Num.Theory. Local Open Scope ring_scope.

(** ** Functions *)

(** An operator, two or three positions in it, and s, x, y with s T^2 = x T + y, or s = 0. *)
Record commutant := Commutant {operator : matrix; positions : seq (nat * nat); relation : Z * Z * Z}.

Definition unit_entry (at_ : nat * nat) : Z := if Nat.eqb at_.1 at_.2 then Zpos xH else Z0.
Definition operator_entry (T : matrix) (at_ : nat * nat) : Z := vget (nth [::] T at_.1) at_.2.

Definition det2 (a b c d : Z) : Z := Z.add (Z.mul a d) (Z.opp (Z.mul b c)).
Definition det3 (a b c d e f g h i : Z) : Z :=
  Z.add (Z.mul a (det2 e f h i)) (Z.add (Z.opp (Z.mul b (det2 d f g i))) (Z.mul c (det2 d e g h))).

Section Check.
Variables (t : coordinates_hint) (isos : seq matrix) (w : commutant).
Let d := codimension t.
Let T := operator w.

Definition not_scalar (p q : nat * nat) : bool :=
  ~~ Z.eqb (det2 (unit_entry p) (operator_entry T p) (unit_entry q) (operator_entry T q)) Z0.

Definition independent (p q r : nat * nat) : bool :=
  let TT := mmul T T in
  ~~ Z.eqb (det3 (unit_entry p) (operator_entry T p) (operator_entry TT p)
                 (unit_entry q) (operator_entry T q) (operator_entry TT q)
                 (unit_entry r) (operator_entry T r) (operator_entry TT r)) Z0.

Definition inside (p : nat * nat) : bool := Nat.ltb p.1 d && Nat.ltb p.2 d.

Definition real_roots : bool :=
  let: (s, x, y) := relation w in
  [&& Z.ltb Z0 s, msame (mscale s (mmul T T)) (madd (mscale x T) (mid y d))
    & Z.leb Z0 (Z.add (Z.mul x x) (Z.mul (Zpos (xO (xO xH))) (Z.mul s y)))].

Definition check_commutant : bool :=
  [&& Nat.ltb 0 d, Nat.eqb (size T) d, all (fun R => msame (mmul T R) (mmul R T)) isos, all inside (positions w)
    & match positions w with
      | [:: p; q] => not_scalar p q && real_roots
      | [:: p; q; r] => independent p q r
      | _ => false
      end].
End Check.

(** ** Soundness *)
Lemma relation_unique (F : fieldType) (s x y x' y' a1 a2 e1 e2 : F) :
  s * (x' * a1 + y' * e1) = x * a1 + y * e1 -> s * (x' * a2 + y' * e2) = x * a2 + y * e2 ->
  e1 * a2 - a1 * e2 != 0 -> x = s * x' /\ y = s * y'.
Proof.
move=> r1 r2 det; have solve z : z * (e1 * a2 - a1 * e2) = 0 -> z = 0.
  by move/eqP; rewrite mulf_eq0 (negbTE det) orbF => /eqP.
split; apply/eqP; rewrite -subr_eq0; apply/eqP; apply: solve.
  transitivity (e1 * (x * a2 + y * e2) - e2 * (x * a1 + y * e1)
    - (e1 * (s * (x' * a2 + y' * e2)) - e2 * (s * (x' * a1 + y' * e1)))); first by ring.
  by rewrite -r1 -r2; ring.
transitivity (a2 * (x * a1 + y * e1) - a1 * (x * a2 + y * e2)
  - (a2 * (s * (x' * a1 + y' * e1)) - a1 * (s * (x' * a2 + y' * e2)))); first by ring.
by rewrite -r1 -r2; ring.
Qed.

Lemma relation_negative (F : realFieldType) (s x y : F) : 0 < s -> x ^+ 2 + 4%:R * y < 0 ->
  s * x * (s * x) + 4%:R * (s * (s * y)) < 0.
Proof.
move=> s0 neg; have -> : s * x * (s * x) + 4%:R * (s * (s * y)) = s * s * (x ^+ 2 + 4%:R * y) by ring.
by rewrite pmulr_rlt0 // mulr_gt0.
Qed.

Section Sound.
Variables (R : rcfType) (p : pair_data) (t : coordinates_hint) (w : commutant).
Local Notation num := (num R). Local Notation d := (codimension t).
Local Notation ads := (adjoint p t). Local Notation isos := (isotropies t ads).
Local Notation T := (mat R d d (operator w)).

Lemma unit_entry_sound i j : num (unit_entry (nat_of_ord i, nat_of_ord j)) = (1%:M : 'M[R]_d) i j.
Proof. by rewrite /unit_entry /= eqbE mxE (inj_eq val_inj); case: eqP. Qed.
Lemma operator_entry_sound A (i j : 'I_d) : num (operator_entry A (nat_of_ord i, nat_of_ord j)) = mat R d d A i j.
Proof. by rewrite /operator_entry /= num_get mxE. Qed.

Theorem check_commutant_sound :
  check_coordinates p t ads isos -> check_commutant t isos w -> ~ pair_is_full R p.
Proof.
move=> cc; have [[cl co rp] <-] := check_coordinates_sound R cc.
have sp : check_spaces p t by case/and3P: cc.
case/and5P => /Nat.ltb_lt/ssrnat.ltP d0 /Nat.eqb_eq sT comm inside_d rest /(full_pairP cl co) fr.
have sT' : (size (operator w) <= d)%N by rewrite sT.
have commT r : T *m rho (c_of R p) (G_of R p t) (Q_of R p t) (E_of R p t) r
    = rho (c_of R p) (G_of R p t) (Q_of R p t) (E_of R p t) r *m T.
  move/(all_nthP [::]): comm => /(_ r); rewrite (size_isos sp) ltn_ord => /(_ isT) /(@mat_same R d d).
  rewrite (mat_mul _ _ _ _ (size_isotropy sp r)) (mat_mul _ _ _ _ sT') isos_sound //.
  by rewrite -scalemxAl -scalemxAr => /(scalerI (size_of_neq0 R sp)).
have entries q : inside t q -> exists i j : 'I_d, q = (nat_of_ord i, nat_of_ord j).
  case: q => i j /andP [/Nat.ltb_lt/ssrnat.ltP li /Nat.ltb_lt/ssrnat.ltP lj].
  by exists (Ordinal li), (Ordinal lj).
have numN z : num (Z.opp z) = - num z by apply/eqP; rewrite -addr_eq0 -numD Z.add_opp_diag_l.
have TT : mat R d d (mmul (operator w) (operator w)) = T *m T by rewrite (mat_mul _ _ _ _ sT').
have scalar a i j : T = a%:M -> T i j = a * (1%:M : 'M[R]_d) i j by move=> ->; rewrite !mxE mulr_natr.
have quadratic x y i j : T *m T = x *: T + y%:M -> (T *m T) i j = x * T i j + y * (1%:M : 'M[R]_d) i j.
  by move=> ->; rewrite !mxE mulr_natr.
case: (positions w) inside_d rest => [|q1 [|q2 [|q3 [|]]]] //=.
  case/and3P => /entries [i [j ->]] /entries [i' [j' ->]] _ /andP [].
  rewrite /not_scalar -(num_eq0 R) /det2 numD numN !numM !unit_entry_sound !operator_entry_sound.
  case: (commutant_full fr d0 commT) => [[a Ta]|[x' [y' [e neg]]]].
    by rewrite !(scalar a) // => /eqP []; ring.
  move=> det; rewrite /real_roots; case: (relation w) => [[s x] y] /and3P [s0 /(@mat_same R d d) rel disc].
  have {}rel l m : num s * (x' * T l m + y' * (1%:M : 'M[R]_d) l m) = num x * T l m + num y * (1%:M : 'M[R]_d) l m.
    have := congr1 (fun M : 'M_d => M l m) rel.
    rewrite mat_scale mat_add mat_scale mat_id TT mxE (quadratic x' y') // => ->.
    by rewrite !mxE mulr_natr.
  have [ex ey] := relation_unique (rel i j) (rel i' j') det.
  have s1 : 0 < num s by rewrite num_gt0.
  move: disc; rewrite -(num_ge0 R) !(numD, numM) ex ey; have -> : num (Zpos (xO (xO xH))) = 4%:R by [].
  by rewrite leNgt (relation_negative s1 neg).
case/and4P => /entries [i [j ->]] /entries [i' [j' ->]] /entries [l [m ->]] _.
rewrite /independent -(num_eq0 R) /det3 /det2 !(numD, numN, numM) !unit_entry_sound !operator_entry_sound TT.
case: (commutant_full fr d0 commT) => [[a Ta]|[x' [y' [e neg]]]].
  by rewrite !(scalar a) // => /eqP []; ring.
by rewrite !(quadratic x' y') // => /eqP []; ring.
Qed.
End Sound.
