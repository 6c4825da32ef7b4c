(** Soundness of the kind witness: a covector that vanishes on h, eta and [h, eta] refutes fullness.

    Source: docs/theory/fullness.md, section 3. The coordinates of eta and phi may lie in any field K between the field
    F of the pair and a field R; the pair is then not full over R, and not full over K. *)
From mathcomp Require Import all_ssreflect all_algebra.
From Liehom Require Import Sound Pair Certificate FullSound.
Set Implicit Arguments. Unset Strict Implicit. Unset Printing Implicit Defensive.
Import GRing.Theory. Local Open Scope ring_scope.

(** phi vanishes on the left side of (6.4) for this eta. Nothing is supposed of the structure constants. *)
Theorem witness_pair_sound (F : fieldType) n k (c : 'I_n -> 'M[F]_n) (h : 'M[F]_(k, n)) (eta : 'rV[F]_n)
    (phi : 'cV[F]_n) : witness_certificate c h eta phi -> ~ full_pair c h.
Proof.
move=> [eh p0 hp ep bp] full; move/eqP: p0; apply; apply/row_matrixP => i; rewrite row0 rowE.
have inh u : (u <= h)%MS -> u *m phi = 0 by case/submxP => w ->; rewrite -mulmxA hp mulmx0.
have [u [z [t [uh zh ->]]]] := full _ eh (delta_mx 0 i).
rewrite !mulmxDl inh // -scalemxAl ep scaler0 addr0 add0r.
case/submxP: zh => w ->; rewrite /bracket ad_h mulmx_sumr mulmx_suml big1 // => p _.
by rewrite -scalemxAr -scalemxAl [eta *m _ *m _]bp scaler0.
Qed.

Lemma map_witness (K R : fieldType) (g : {rmorphism K -> R}) n k (c : 'I_n -> 'M[K]_n) (h : 'M[K]_(k, n))
    (eta : 'rV[K]_n) (phi : 'cV[K]_n) : witness_certificate c h eta phi ->
  witness_certificate (map_pair g c) (map_mx g h) (map_mx g eta) (map_mx g phi).
Proof.
move=> [eh p0 hp ep bp]; split.
- by rewrite map_submx.
- by rewrite map_mx_eq0.
- by rewrite -map_mxM hp map_mx0.
- by rewrite -map_mxM ep map_mx0.
by move=> p; rewrite -map_row -map_bracket -map_mxM bp map_mx0.
Qed.

(** The pair is over F, the witness over K, and K lies in R: the pair is not full over R. *)
Theorem witness_sound_ext (F K R : fieldType) (e : {rmorphism F -> K}) (g : {rmorphism K -> R}) n k
    (c : 'I_n -> 'M[F]_n) (h : 'M[F]_(k, n)) (eta : 'rV[K]_n) (phi : 'cV[K]_n) :
  witness_certificate (map_pair e c) (map_mx e h) eta phi ->
  ~ full_pair (map_pair g (map_pair e c)) (map_mx g (map_mx e h)).
Proof. by move/(map_witness g)/witness_pair_sound. Qed.
