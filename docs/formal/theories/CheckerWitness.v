(** The kind witness: eta and phi with coordinates in Z[theta], theta a root of an integral polynomial f in an interval.

    Numbers of a certificate may be multiplied by a common factor, so they are integers here. A polynomial is the list
    of its ascending coefficients; eta and phi are polynomials whose coefficients are vectors. Two functions that
    nothing is known about find the factors of identities, which are then verified: [divide f p] proposes s != 0 and g
    with s p = f g, and [bezout f p] proposes u, v and c != 0 with u f + v p = c. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra zify.ssrZ.
From Liehom Require Import Sound Pair Certificate WitnessSound CheckerAlgebra CheckerPair.
Set Implicit Arguments. Unset Strict Implicit. Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory. Local Open Scope ring_scope.

(** ** Functions *)
Definition polynomial := seq Z.

Fixpoint padd (f g : polynomial) : polynomial :=
  match f, g with
  | [::], _ => g
  | _, [::] => f
  | a :: f', b :: g' => Z.add a b :: padd f' g'
  end.
Definition pscale (a : Z) (f : polynomial) : polynomial := map (Z.mul a) f.
Fixpoint pmul (f g : polynomial) : polynomial :=
  if f is a :: f' then padd (pscale a g) (Z0 :: pmul f' g) else [::].
Definition pzero (f : polynomial) : bool := all (fun a => Z.eqb a Z0) f.
Definition psame (f g : polynomial) : bool := pzero (padd f (pscale (Zneg xH) g)).

(** Derivative: of a + t g it is g + t g'. *)
Fixpoint pderivative (f : polynomial) : polynomial :=
  if f is _ :: g then padd g (Z0 :: pderivative g) else [::].

(** Numerator and denominator, a power of y, of f(x/y). *)
Fixpoint peval (f : polynomial) (x y : Z) : Z * Z :=
  if f is a :: g then
    let: (v, w) := peval g x y in (Z.add (Z.mul a (Z.mul y w)) (Z.mul x v), Z.mul y w)
  else (Z0, Zpos xH).

Record witness := Witness {
  minpoly : polynomial; low : fraction; high : fraction; eta : seq vector; phi : seq vector}.

Record oracle := Oracle {
  divide : polynomial -> polynomial -> Z * polynomial;
  bezout : polynomial -> polynomial -> polynomial * polynomial * Z}.

(** An oracle from lists of questions and answers. *)
Fixpoint find A (none : A) (table : seq (polynomial * polynomial * A)) (f g : polynomial) : A :=
  if table is (a, b, answer) :: rest then
    if psame a f && psame b g then answer else find none rest f g
  else none.
Definition answers (quotients : seq (polynomial * polynomial * (Z * polynomial)))
    (combinations : seq (polynomial * polynomial * (polynomial * polynomial * Z))) : oracle :=
  Oracle (find (Z0, [::]) quotients) (find ([::], [::], Z0) combinations).

(** The scalar product of two polynomials of vectors. *)
Fixpoint product (v w : seq vector) : polynomial :=
  if v is a :: v' then padd (map (vdot a) w) (Z0 :: product v' w) else [::].
Definition coordinate (v : seq vector) (j : nat) : polynomial := map (vget^~ j) v.
Definition bounded (n : nat) (v : vector) : bool := all (fun e => Nat.ltb e.1 n) v.

Section Check.
Variables (o : oracle) (p : pair_data) (t : coordinates_hint) (ads : seq matrix) (w : witness).
Let n := dimension p.
Let d := codimension t.
Let f := minpoly w.

Definition vanishes (g : polynomial) : bool :=
  let: (s, q) := divide o f g in ~~ Z.eqb s Z0 && psame (pscale s g) (pmul f q).
Definition coprime_to (g : polynomial) : bool :=
  let: (u, v, c) := bezout o f g in ~~ Z.eqb c Z0 && psame (padd (pmul u f) (pmul v g)) [:: c].

(** f changes its sign between the ends, or has degree 1 and a root between them, which may be an end. *)
Definition has_root : bool :=
  let: (a, b) := low w in
  let: (x, y) := high w in
  let left := Z.mul a y in
  let right := Z.mul x b in
  let sign := Z.mul (peval f a b).1 (peval f x y).1 in
  [&& Z.ltb Z0 b, Z.ltb Z0 y
    & if Nat.eqb (size f) 2 then Z.leb left right && Z.leb sign Z0 else Z.ltb left right && Z.ltb sign Z0].

Definition check_witness : bool :=
  [&& has_root, coprime_to (pderivative f), all (bounded n) (phi w),
      has (fun j => coprime_to (coordinate (phi w) j)) (iota 0 n)
    & [&& has (fun j => coprime_to (coordinate [seq vmul e (quotient t) | e <- eta w] j)) (iota 0 d),
          all (fun g => all (fun e => Z.eqb (vdot g e) Z0) (phi w)) (basis t),
          vanishes (product (eta w) (phi w))
        & all (fun a => vanishes (product [seq vmul e a | e <- eta w] (phi w))) ads]].
End Check.

(** ** Soundness *)
Section Polynomials.
Variable (F : numFieldType) (x : F).
Local Notation num := (num F).

Definition value (f : polynomial) : F := (Poly (map num f)).[x].
Definition combination n (v : seq vector) : 'rV[F]_n := foldr (fun a s => vec F n a + x *: s) 0 v.

Lemma value_cons a f : value (a :: f) = num a + x * value f.
Proof. by rewrite /value /= horner_cons addrC mulrC. Qed.
Lemma value_nil : value [::] = 0. Proof. by rewrite /value /= horner0. Qed.

Lemma value_add f g : value (padd f g) = value f + value g.
Proof.
elim: f g => [|a f IH] [|b g]; rewrite ?value_nil ?add0r ?addr0 //.
by rewrite !value_cons IH numD mulrDr addrACA.
Qed.
Lemma value_scale a f : value (pscale a f) = num a * value f.
Proof. by elim: f => [|b f IH]; rewrite ?value_nil ?mulr0 // !value_cons IH numM mulrDr mulrCA. Qed.
Lemma value_mul f g : value (pmul f g) = value f * value g.
Proof.
elim: f => [|a f IH]; first by rewrite value_nil mul0r.
by rewrite value_add value_scale !value_cons IH add0r mulrDl mulrA.
Qed.
Lemma value_zero f : pzero f -> value f = 0.
Proof.
elim: f => [|a f IH] /=; first by rewrite value_nil.
by case/andP; rewrite -(num_eq0 F) value_cons => /eqP -> /IH ->; rewrite mulr0 addr0.
Qed.
Lemma value_same f g : psame f g -> value f = value g.
Proof. by move/value_zero/eqP; rewrite value_add value_scale numN1 mulN1r subr_eq0 => /eqP. Qed.

Lemma combinationE n v j : combination n v 0 j = value (coordinate v j).
Proof.
elim: v => [|a v IH] /=; first by rewrite mxE value_nil.
by rewrite value_cons !mxE IH num_get.
Qed.
Lemma combination_mul m n v A : (size A <= m)%N ->
  combination n [seq vmul e A | e <- v] = combination m v *m mat F m n A.
Proof.
move=> sA; elim: v => [|a v IH] /=; first by rewrite mul0mx.
by rewrite IH (vec_mul _ _ _ sA) mulmxDl -scalemxAl.
Qed.

Lemma coef_bounded n v i : bounded n v -> (n <= i)%N -> coef F v i = 0.
Proof.
elim: v => [|[j y] v IH] //= /andP [/Nat.ltb_lt/ssrnat.ltP jn bv] ni; rewrite IH // addr0.
by case: eqP => // e; move: jn; rewrite e ltnNge ni.
Qed.

Lemma value_dots n a w : all (bounded n) w -> value (map (vdot a) w) = (vec F n a *m (combination n w)^T) 0 0.
Proof.
elim: w => [|b w IH] /=; first by rewrite trmx0 mulmx0 mxE value_nil.
case/andP => bb /IH e; rewrite value_cons e linearD linearZ /= mulmxDr -scalemxAr [RHS]mxE.
rewrite (num_dot (n := n)) => [|i]; last exact: coef_bounded.
by rewrite [X in _ = _ + X]mxE.
Qed.

Lemma value_product n v w : all (bounded n) w ->
  value (product v w) = (combination n v *m (combination n w)^T) 0 0.
Proof.
move=> bw; elim: v => [|a v IH] /=; first by rewrite mul0mx mxE value_nil.
by rewrite value_add (value_dots _ bw) value_cons add0r IH mulmxDl -scalemxAl [RHS]mxE [X in _ = _ + X]mxE.
Qed.
End Polynomials.

Lemma peval_sound (F : numFieldType) f x y : Z.ltb Z0 y ->
  0 < num F (peval f x y).2 /\ value (num F x / num F y) f = num F (peval f x y).1 / num F (peval f x y).2.
Proof.
rewrite -(num_gt0 F) => y0; elim: f => [|a f [w0 IH]] /=; first by rewrite value_nil num0 mul0r num1 ltr01.
rewrite value_cons IH; case: (peval f x y) w0 => v w /= w0; rewrite numM mulr_gt0 //; split => //.
rewrite !numD !numM mulrDl mulfK ?mulf_neq0 ?lt0r_neq0 //; congr (_ + _).
by rewrite invfM mulrACA mulrA.
Qed.

Section Sound.
Variables (R : rcfType) (o : oracle) (p : pair_data) (t : coordinates_hint) (w : witness).
Local Notation num := (num R).
Local Notation n := (dimension p). Local Notation k := (size (rows p)). Local Notation d := (codimension t).
Local Notation ads := (adjoint p t).

Lemma root_exists : has_root w -> exists x : R, value x (minpoly w) = 0.
Proof.
rewrite /has_root; case: (low w) => a b; case: (high w) => x y /and3P [b0 y0 h].
have [lr sg] : Z.leb (Z.mul a y) (Z.mul x b) /\
    Z.leb (Z.mul (peval (minpoly w) a b).1 (peval (minpoly w) x y).1) Z0.
  by case: Nat.eqb h => /andP [] // /Z.ltb_lt/Z.lt_le_incl/Z.leb_le ? /Z.ltb_lt/Z.lt_le_incl/Z.leb_le.
have [wa va] := peval_sound R (minpoly w) a b0; have [wx vx] := peval_sound R (minpoly w) x y0.
move: sg b0 y0 lr; rewrite -(num_le R) -!(num_gt0 R) -(num_le R) !numM num0 => sg b0 y0 lr.
set l := num a / num b in va; set r := num x / num y in vx.
have le : l <= r by rewrite ler_pdivr_mulr // mulrAC ler_pdivl_mulr.
set P := Poly (map num (minpoly w)); rewrite -/(value _ _) in va vx.
have {}sg : P.[l] * P.[r] <= 0.
  rewrite -/(value l _) -/(value r _) va vx mulrACA -invfM.
  by rewrite pmulr_lle0 // invr_gt0 mulr_gt0.
have [pl|pl] := lerP P.[l] 0; last first.
  have pr : P.[r] <= 0 by move: sg; rewrite pmulr_rle0.
  have /poly_ivt : 0 \in `[(- P).[l], (- P).[r]] by rewrite !hornerN in_itv /= oppr_le0 oppr_ge0 (ltW pl) pr.
  by case/(_ le) => z _ /rootP; rewrite hornerN => /eqP; rewrite oppr_eq0 => /eqP e; exists z.
move: pl; rewrite le_eqVlt => /predU1P [e | pl]; first by exists l.
have pr : 0 <= P.[r] by move: sg; rewrite nmulr_rle0.
have /poly_ivt : 0 \in `[P.[l], P.[r]] by rewrite in_itv /= (ltW pl) pr.
by case/(_ le) => z _ /rootP e; exists z.
Qed.

Lemma vanishes_value (x : R) g : value x (minpoly w) = 0 -> vanishes o w g -> value x g = 0.
Proof.
rewrite /vanishes => fx; case: (divide _ _ _) => s q /andP [s0 /(value_same x)].
rewrite value_scale value_mul fx mul0r => /eqP; rewrite mulf_eq0 num_eq0.
by rewrite (negbTE s0) => /eqP.
Qed.
Lemma coprime_value (x : R) g : value x (minpoly w) = 0 -> coprime_to o w g -> value x g != 0.
Proof.
rewrite /coprime_to => fx; case: (bezout _ _ _) => [[u v] c] /andP [c0 /(value_same x)].
rewrite value_add !value_mul fx mulr0 add0r value_cons value_nil mulr0 addr0 => e.
by apply/eqP => g0; move: e; rewrite g0 mulr0 => /esym/eqP; rewrite num_eq0 (negbTE c0).
Qed.

Theorem check_witness_sound :
  check_coordinates p t ads (isotropies t ads) -> check_witness o p t ads w -> ~ pair_is_full R p.
Proof.
move=> cc; case: (check_coordinates_sound R cc) => [[cl [GQ EQ kQ] rp] <-].
case/and3P: cc => sp _ _.
case/and5P => /root_exists [x fx] _ bphi phi0 /and4P [eta0 hphi ephi bphi'].
pose e := combination x n (eta w); pose f := (combination x n (phi w))^T.
have entry0 (a : 'M[R]_1) : a 0 0 = 0 -> a = 0 by move=> a0; rewrite [a]mx11_scalar a0 raddf0.
apply: (@witness_pair_sound _ _ _ _ _ e f); split.
- apply/negP => /submxP [u eu]; case/hasP: eta0 => j; rewrite mem_iota /= => jd /(coprime_value fx) /eqP; apply.
  rewrite -(combinationE x _ (Ordinal jd)) (combination_mul _ _ _ (size_Q sp)) -/e -/(Q_of R p t).
  by rewrite eu -mulmxA GQ mulmx0 mxE.
- apply/eqP => f0; case/hasP: phi0 => j; rewrite mem_iota /= => jn /(coprime_value fx) /eqP; apply.
  by rewrite -(combinationE x _ (Ordinal jn)) -[combination _ _ _]trmxK -/f f0 !mxE.
- apply/row_matrixP => r; rewrite row_mul row0 row_mat; apply: entry0.
  rewrite -(value_dots _ _ bphi); apply: value_zero.
  move/(all_nthP [::]): hphi => /(_ r); rewrite (size_G sp) ltn_ord => /(_ isT).
  by rewrite /pzero all_map.
- by apply: entry0; rewrite -(value_product _ _ bphi) (vanishes_value fx).
move=> r; apply: entry0; move/(all_nthP [::]): bphi' => /(_ r).
rewrite (size_ads sp) ltn_ord => /(_ isT) /(vanishes_value fx).
rewrite (value_product _ _ bphi) (combination_mul _ _ _ (size_ad sp r)) (ads_sound R sp) -/e -/f.
rewrite -scalemxAr -scalemxAl [LHS]mxE => /eqP; rewrite mulf_eq0 (negbTE (scale_neq0 R sp)) => /eqP //.
Qed.
End Sound.
