(** Sparse vectors and matrices of integers, as lists, and the matrices over a field that they stand for.

    A vector is a list of entries (index, integer), of which those with equal indices add up; a matrix is the list of
    its rows. Nothing is supposed of the order of entries or of the lengths of lists, except where a lemma says so:
    the functions keep vectors sorted, but no proof needs it.

    [num] is the ring morphism from Coq's integers to a field of characteristic 0, [coef v j] the entry of v at j,
    [vec n v] and [mat m n M] the vector and the matrix over the field. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra zify.ssrZ.
Set Implicit Arguments. Unset Strict Implicit. Unset Printing Implicit Defensive.
Import GRing.Theory Num.Theory. Local Open Scope ring_scope.

(** ** Functions *)

Definition vector := seq (nat * Z).
Definition matrix := seq vector.

Fixpoint vscale (a : Z) (v : vector) : vector :=
  if v is (i, x) :: v' then (i, Z.mul a x) :: vscale a v' else [::].

(** Sum, by merging; entries that become 0 are left out. *)
Fixpoint vadd (v : vector) : vector -> vector :=
  if v is (i, x) :: v' then
    fix add w := if w is (j, y) :: w' then
        if Nat.eqb i j then
          let s := Z.add x y in if Z.eqb s Z0 then vadd v' w' else (i, s) :: vadd v' w'
        else if Nat.ltb i j then (i, x) :: vadd v' w else (j, y) :: add w'
      else v
  else id.

Definition vzero (v : vector) : bool := all (fun p => Z.eqb p.2 Z0) v.

(** Entry at an index, and scalar product. *)
Fixpoint vget (v : vector) (j : nat) : Z :=
  if v is (i, x) :: v' then if Nat.eqb i j then Z.add x (vget v' j) else vget v' j else Z0.
Fixpoint vdot (v w : vector) : Z :=
  if v is (i, x) :: v' then Z.add (Z.mul x (vget w i)) (vdot v' w) else Z0.

Fixpoint madd (A B : matrix) : matrix :=
  match A, B with
  | [::], _ => B
  | _, [::] => A
  | a :: A', b :: B' => vadd a b :: madd A' B'
  end.
Definition mscale (a : Z) (A : matrix) : matrix := map (vscale a) A.
Definition mzero (A : matrix) : bool := all vzero A.
Definition msame (A B : matrix) : bool := mzero (madd A (mscale (Zneg xH) B)).

(** Row vector times matrix, product, transpose of a matrix with m rows and n columns, a times the identity. *)
Fixpoint vmul (v : vector) (A : matrix) : vector :=
  if v is (i, x) :: v' then vadd (vscale x (nth [::] A i)) (vmul v' A) else [::].
Definition mmul (A B : matrix) : matrix := map (vmul^~ B) A.
Definition mtranspose (m n : nat) (A : matrix) : matrix :=
  [seq [seq (i, vget (nth [::] A i) j) | i <- iota 0 m] | j <- iota 0 n].
Definition mid (a : Z) (n : nat) : matrix := [seq [:: (i, a)] | i <- iota 0 n].

(** The combination of matrices with the coefficients v. *)
Fixpoint combine (v : vector) (As : seq matrix) : matrix :=
  if v is (i, x) :: v' then madd (mscale x (nth [::] As i)) (combine v' As) else [::].

(** The vector of a list of all its entries. *)
Fixpoint sparse_from (i : nat) (l : seq Z) : vector :=
  if l is x :: l' then if Z.eqb x Z0 then sparse_from i.+1 l' else (i, x) :: sparse_from i.+1 l' else [::].
Definition sparse (l : seq Z) : vector := sparse_from 0 l.

(** ** What they compute *)

Section Meaning.
Variable F : numFieldType.

Definition num (z : Z) : F := (int_of_Z z)%:~R.
Lemma numD x y : num (Z.add x y) = num x + num y.
Proof. by rewrite /num -[Z.add x y]/(x + y) raddfD rmorphD. Qed.
Lemma numM x y : num (Z.mul x y) = num x * num y.
Proof. by rewrite /num -[Z.mul x y]/(x * y) rmorphM rmorphM. Qed.
Lemma num0 : num Z0 = 0. Proof. by []. Qed.
Lemma num1 : num (Zpos xH) = 1. Proof. by []. Qed.
Lemma numN1 : num (Zneg xH) = -1. Proof. by []. Qed.
Lemma num_eq0 x : (num x == 0) = Z.eqb x Z0.
Proof. by rewrite /num intr_eq0 -[0]/(int_of_Z Z0) (inj_eq (can_inj int_of_ZK)). Qed.

Lemma num_gt0 x : (0 < num x) = Z.ltb Z0 x.
Proof. by rewrite /num ltr0z; case: x => //= p; have /ltP := Pos2Nat.is_pos p. Qed.
Lemma num_ge0 x : (0 <= num x) = Z.leb Z0 x.
Proof. by rewrite /num ler0z; case: x. Qed.
Lemma num_le x y : (num x <= num y) = Z.leb x y.
Proof.
have numN z : num (Z.opp z) = - num z by apply/eqP; rewrite -addr_eq0 -numD Z.add_opp_diag_l.
rewrite -subr_ge0 -numN -numD num_ge0; apply/idP/idP => /Z.leb_le h; apply/Z.leb_le; exact/Z.le_0_sub.
Qed.

Fixpoint coef (v : vector) (j : nat) : F :=
  if v is (i, x) :: v' then (if i == j then num x else 0) + coef v' j else 0.
Definition vec n (v : vector) : 'rV[F]_n := \row_j coef v j.
Definition mat m n (M : matrix) : 'M[F]_(m, n) := \matrix_(i, j) coef (nth [::] M i) j.

Lemma eqbE i j : Nat.eqb i j = (i == j).
Proof. by apply/idP/eqP => [/Nat.eqb_eq | ->] //; apply/Nat.eqb_eq. Qed.

Lemma coef_scale a v j : coef (vscale a v) j = num a * coef v j.
Proof.
elim: v => [|[i x] v IH] /=; first by rewrite mulr0.
by rewrite IH mulrDr numM; case: eqP; rewrite ?mulr0.
Qed.

Lemma coef_add v w j : coef (vadd v w) j = coef v j + coef w j.
Proof.
elim: v w => [|[i x] v IHv] /=; first by move=> w; rewrite add0r.
elim=> [|[i' y] w IHw] /=; first by rewrite addr0.
rewrite eqbE; case: eqP => [<-|_].
  have e: coef v j + coef w j + (if i == j then num (Z.add x y) else 0)
      = (if i == j then num x else 0) + coef v j + ((if i == j then num y else 0) + coef w j).
    by rewrite addrACA numD addrC; case: eqP; rewrite ?addr0.
  rewrite -e; case z: Z.eqb; rewrite /= IHv; last by rewrite addrC.
  by move: z; rewrite -num_eq0 => /eqP ->; rewrite if_same addr0.
by case: Nat.ltb => /=; [rewrite IHv /= !addrA | rewrite IHw /= addrCA].
Qed.

Lemma coef_zero v j : vzero v -> coef v j = 0.
Proof.
elim: v => [|[i x] v IH] //= /andP [x0 v0].
by rewrite IH // addr0; move: x0; rewrite -num_eq0 => /eqP ->; rewrite if_same.
Qed.

Lemma num_get v j : num (vget v j) = coef v j.
Proof. by elim: v => [|[i x] v IH] //=; rewrite eqbE; case: eqP; rewrite ?numD IH ?add0r. Qed.

(** Sums over the entries of a vector are sums over all indices below a bound, if what is summed is 0 above it. *)
Lemma sum_entries (V : lmodType F) m v (f : nat -> V) :
  (forall i, (m <= i)%N -> f i = 0) ->
  \sum_(i < m) coef v i *: f i = \sum_(p <- v) num p.2 *: f p.1.
Proof.
move=> f0; elim: v => [|[i x] v IH]; first by rewrite big_nil big1 // => i _; rewrite scale0r.
rewrite big_cons -IH /=; under eq_bigr do rewrite scalerDl.
rewrite big_split /=; congr (_ + _); case: (ltnP i m) => [im | mi].
  rewrite (bigD1 (Ordinal im)) //= eqxx big1 ?addr0 // => j ne.
  by case: eqP => [e|_]; [case/eqP: ne; apply: val_inj | rewrite scale0r].
rewrite (f0 i) // scaler0 big1 // => j _; case: eqP => [e|_]; last by rewrite scale0r.
by move: (ltn_ord j); rewrite -e ltnNge mi.
Qed.

Lemma coef_default (m : matrix) i j : (size m <= i)%N -> coef (nth [::] m i) j = 0.
Proof. by move=> le; rewrite nth_default. Qed.

Lemma num_dot n v w : (forall i, (n <= i)%N -> coef w i = 0) -> num (vdot v w) = (vec n v *m (vec n w)^T) 0 0.
Proof.
move=> w0; rewrite mxE; under eq_bigr do rewrite !mxE.
rewrite (sum_entries v (f := fun i => coef w i : F^o)) //.
by elim: v => [|[i x] v IH] /=; rewrite ?big_nil // big_cons numD numM num_get IH.
Qed.

Lemma vec_add n v w : vec n (vadd v w) = vec n v + vec n w.
Proof. by apply/rowP => j; rewrite !mxE coef_add. Qed.
Lemma vec_scale n a v : vec n (vscale a v) = num a *: vec n v.
Proof. by apply/rowP => j; rewrite !mxE coef_scale. Qed.
Lemma vec_zero n v : vzero v -> vec n v = 0.
Proof. by move=> v0; apply/rowP => j; rewrite !mxE coef_zero. Qed.

Lemma row_mat m n M (i : 'I_m) : row i (mat m n M) = vec n (nth [::] M i).
Proof. by apply/rowP => j; rewrite !mxE. Qed.

Lemma mat_add m n A B : mat m n (madd A B) = mat m n A + mat m n B.
Proof.
have H : forall i, nth [::] (madd A B) i = vadd (nth [::] A i) (nth [::] B i) \/
    coef (nth [::] (madd A B) i) =1 (fun j => coef (nth [::] A i) j + coef (nth [::] B i) j).
  elim: A B => [|a A IH] [|b B] i; right => j //=; rewrite ?nth_nil /= ?add0r ?addr0 //.
  by case: i => [|i] /=; [rewrite coef_add | case: (IH B i) => ->; rewrite ?coef_add].
by apply/matrixP => i j; rewrite !mxE; case: (H i) => ->; rewrite ?coef_add.
Qed.
Lemma mat_scale m n a A : mat m n (mscale a A) = num a *: mat m n A.
Proof.
apply/matrixP => i j; rewrite !mxE; case: (ltnP i (size A)) => iA.
  by rewrite (nth_map [::]) // coef_scale.
by rewrite !coef_default ?size_map // mulr0.
Qed.
Lemma mat_zero m n A : mzero A -> mat m n A = 0.
Proof.
move=> /(all_nthP [::]) A0; apply/matrixP => i j; rewrite !mxE.
by case: (ltnP i (size A)) => iA; [apply: coef_zero; apply: A0 | apply: coef_default].
Qed.
Lemma mat_same m n A B : msame A B -> mat m n A = mat m n B.
Proof. by move/(@mat_zero m n)/eqP; rewrite mat_add mat_scale numN1 scaleN1r subr_eq0 => /eqP. Qed.

Lemma vec_mul m n v A : (size A <= m)%N -> vec n (vmul v A) = vec m v *m mat m n A.
Proof.
move=> sA; apply/rowP => j; rewrite !mxE; under eq_bigr do rewrite !mxE.
rewrite (sum_entries v (f := fun i => coef (nth [::] A i) j : F^o)); last first.
  by move=> i le; apply: coef_default; apply: leq_trans sA le.
by elim: v => [|[i x] v IH] /=; rewrite ?big_nil // big_cons coef_add coef_scale IH.
Qed.
Lemma mat_mul l m n A B : (size B <= m)%N -> mat l n (mmul A B) = mat l m A *m mat m n B.
Proof.
move=> sB; apply/row_matrixP => i; rewrite row_mul !row_mat -(vec_mul _ _ sB).
case: (ltnP i (size A)) => iA; first by rewrite (nth_map [::]).
by rewrite !nth_default ?size_map.
Qed.

Lemma coef_map m (f : nat -> Z) j : coef [seq (i, f i) | i <- iota 0 m] j = if (j < m)%N then num (f j) else 0.
Proof.
have H a : coef [seq (i, f i) | i <- iota a m] j = if (a <= j < a + m)%N then num (f j) else 0.
  elim: m a => [|m IH] a /=; first by rewrite addn0 ltnNge andbN.
  rewrite IH addSnnS; case: (ltngtP a j) => //= e; first by rewrite add0r.
    by rewrite add0r.
  by rewrite -e addnS ltnS leq_addr addr0.
by rewrite H.
Qed.
Lemma mat_transpose m n A : mat n m (mtranspose m n A) = (mat m n A)^T.
Proof.
apply/matrixP => j i; rewrite !mxE (nth_map 0%N) ?size_iota // coef_map ltn_ord num_get.
by rewrite nth_iota.
Qed.
Lemma mat_id a n : mat n n (mid a n) = (num a)%:M.
Proof.
apply/matrixP => i j; rewrite !mxE (nth_map 0%N) ?size_iota // nth_iota //= addr0.
by case: (i =P j) => [->|ne]; [rewrite eqxx | case: eqP => // e; case: ne; apply: val_inj].
Qed.

Lemma mat_combine k m n v As : size As = k ->
  mat m n (combine v As) = \sum_(p < k) coef v p *: mat m n (nth [::] As p).
Proof.
move=> sA; rewrite (sum_entries v (f := fun p => mat m n (nth [::] As p))); last first.
  by move=> i le; rewrite nth_default ?sA //; apply: mat_zero.
elim: v => [|[i x] v IH] /=; first by rewrite big_nil; apply: mat_zero.
by rewrite big_cons mat_add mat_scale IH.
Qed.

Lemma size_combine n v As : all (fun A : matrix => size A <= n)%N As -> (size (combine v As) <= n)%N.
Proof.
have size_madd A B : size (madd A B) = maxn (size A) (size B).
  by elim: A B => [|a A IH] [|b B] //=; rewrite ?max0n // IH maxnSS.
move=> /(all_nthP [::]) small; elim: v => [|[i x] v IH] //=; rewrite size_madd geq_max IH andbT size_map.
by case: (ltnP i (size As)) => iA; [apply: small | rewrite nth_default].
Qed.

Lemma coef_sparse l j : coef (sparse l) j = num (nth Z0 l j).
Proof.
have H a : coef (sparse_from a l) j = if (a <= j)%N then num (nth Z0 l (j - a)) else 0.
  elim: l a => [|x l IH] a /=; first by rewrite nth_nil if_same.
  have {}IH : coef (sparse_from a.+1 l) j = if (a < j)%N then num (nth Z0 l (j - a.+1)) else 0 by [].
  have e : coef (if Z.eqb x Z0 then sparse_from a.+1 l else (a, x) :: sparse_from a.+1 l) j
      = (if a == j then num x else 0) + coef (sparse_from a.+1 l) j.
    case z: Z.eqb => //=; move: z; rewrite -num_eq0 => /eqP ->; by rewrite if_same add0r.
  rewrite e IH; case: (ltngtP a j) => [lt|gt|<-].
  - by rewrite add0r -[(j - a)%N](ltn_predK (_ : 0 < _)%N) ?subn_gt0 //= subnS.
  - by rewrite addr0.
  by rewrite subnn addr0.
by rewrite /sparse H subn0.
Qed.
End Meaning.
