(** Triangular form of a matrix over an algebraically closed field, with its eigenvalues in a prescribed order.

    Source: linear algebra behind docs/theory/fullness.md, section 3; used by Dominance.v. *)
From mathcomp Require Import all_ssreflect all_algebra.
Set Implicit Arguments. Unset Strict Implicit. Unset Printing Implicit Defensive.
Import GRing.Theory. Local Open Scope ring_scope.

Section Similar.
Variable F : fieldType.

(** Similar matrices have the same characteristic polynomial. *)
Lemma char_poly_similar n (U A A' : 'M[F]_n) : U \in unitmx -> U *m A = A' *m U -> char_poly A = char_poly A'.
Proof.
move=> Uu e; pose Up := map_mx polyC U.
have Up0 : \det Up != 0 by rewrite det_map_mx polyC_eq0 -unitfE -unitmxE.
apply: (mulIf Up0); rewrite /char_poly mulrC -!det_mulmx; congr (\det _).
by rewrite /char_poly_mx mulmxBl mulmxBr -!map_mxM e scalar_mxC.
Qed.

(** Block triangular: the characteristic polynomials multiply. *)
Lemma char_poly_lblock m n (A : 'M[F]_m) (L : 'M[F]_(n, m)) (B : 'M[F]_n) :
  char_poly (block_mx A 0 L B) = char_poly A * char_poly B.
Proof.
rewrite /char_poly /char_poly_mx map_block_mx (scalar_mx_block m n) opp_block_mx add_block_mx map_mx0 subr0.
by rewrite det_lblock.
Qed.

Lemma char_poly_scalar1 (z : F) : char_poly (z%:M : 'M_1) = 'X - z%:P.
Proof. by rewrite /char_poly det_mx11 !mxE eqxx. Qed.
End Similar.

(** T is lower triangular with the diagonal s. *)
Definition triangular (F : fieldType) n (T : 'M[F]_n) (s : seq F) :=
  (forall i j : 'I_n, (i < j)%N -> T i j = 0) /\ (forall i : 'I_n, T i i = s`_i).

Theorem triangular_form (C : closedFieldType) n (A : 'M[C]_n) (s : seq C) :
  char_poly A = \prod_(z <- s) ('X - z%:P) ->
  exists U T, [/\ U \in unitmx, U *m A = T *m U & triangular T s].
Proof.
elim: n A s => [|n IH] A s eA.
  by exists 1%:M, 0; split; [exact: unitmx1 | apply/matrixP; case | split; case].
rewrite -[n.+1]/(1 + n)%N in A eA *.
case: s eA => [|z s] eA; first by have := size_char_poly A; rewrite eA big_nil size_poly1.
have : root (char_poly A) z by rewrite eA root_prod_XsubC inE eqxx.
rewrite -eigenvalue_root_char => /eigenvalueP [v vA v0].
pose U1 := row_ebase v; have U1u : U1 \in unitmx := row_ebase_unit v.
have [a a0 ev] : exists2 a, a != 0 & v = a *: (row_mx 1%:M 0 *m U1).
  exists (col_ebase v 0 0).
    by apply: contra v0 => /eqP e; rewrite -(mulmx_ebase v) [col_ebase v]mx11_scalar e raddf0 !mul0mx.
  rewrite -{1}(mulmx_ebase v) rank_rV v0 [col_ebase v]mx11_scalar -mulmxA mul_scalar_mx mxE eqxx mulr1n.
  congr (_ *: (_ *m _)); apply/matrixP => i j; rewrite !mxE ord1; case: splitP => j' ej; rewrite !mxE.
    by rewrite ord1 ej ord1.
  by rewrite ej.
pose A1 := U1 *m A *m invmx U1.
have eA1 : U1 *m A = A1 *m U1 by rewrite mulmxKV.
have top : row_mx 1%:M 0 *m A1 = z *: row_mx 1%:M 0 :> 'rV_(1 + n).
  apply: (scalerI a0); apply: (can_inj (mulmxK U1u)); rewrite -scalemxAl -(mulmxA _ A1) -eA1 mulmxA scalemxAl -ev vA.
  by rewrite {1}ev !scalemxAl !scalerA mulrC.
pose l := dlsubmx A1; pose A2 := drsubmx A1.
have bA1 : A1 = block_mx z%:M 0 l A2.
  rewrite -[LHS]submxK; move: top; rewrite -{1}[A1]submxK mul_row_block !mul1mx !mul0mx !addr0 scale_row_mx scaler0.
  by case/eq_row_mx => -> ->; rewrite scalemx1.
have eA2 : char_poly A2 = \prod_(y <- s) ('X - y%:P).
  move: eA; rewrite (char_poly_similar U1u eA1) bA1 char_poly_lblock char_poly_scalar1 big_cons.
  by apply: mulfI; rewrite polyXsubC_eq0.
have [U2 [T2 [U2u e2 [low diag]]]] := IH _ _ eA2.
exists (block_mx 1%:M 0 0 U2 *m U1), (block_mx z%:M 0 (U2 *m l) T2); split.
- by rewrite unitmx_mul U1u andbT unitmxE det_ublock det1 mul1r -unitmxE.
- rewrite -mulmxA eA1 bA1 !mulmxA !mulmx_block; congr (_ *m _).
  by rewrite !mul1mx !mulmx0 !mul0mx !mulmx1 !addr0 !add0r e2.
split=> [i j | i].
  rewrite -[i]splitK -[j]splitK; case: (split i) => i'; case: (split j) => j' /=.
  - by rewrite !ord1.
  - by rewrite block_mxEur mxE.
  - by rewrite ord1.
  by rewrite block_mxEdr ltn_add2l; apply: low.
rewrite -[i]splitK; case: (split i) => i' /=.
  by rewrite block_mxEul ord1 mxE eqxx.
by rewrite block_mxEdr diag.
Qed.
