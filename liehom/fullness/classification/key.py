"""The key of a full pair, computed over its field by linear algebra and one sign.

Let L0 be the traceless part of rho(h) on V = g/h. For a full pair of dimension d >= 2 it is reductive and irreducible,
so its commutant is R, C = R + RJ or H, and its centre is 0 or RJ. The centre is RJ if and only if the commutant is C
and tr(A J) is not 0 for some A in L0. Then S = [L0, L0] consists of the A in L0 with tr(A J) = 0. Otherwise S = L0.
"""

from __future__ import annotations

from liehom.algebra import Subalgebra
from liehom.fullness.classification.effective import effective_pair, isotropy_kernel, largest_ideal
from liehom.fullness.classification.rows import SPIRAL, Key, rows
from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction
from liehom.representations import Pair
from liehom.representations.invariants.intertwiners import commutant
from liehom.representations.invariants.irreducibility import combination, traceless
from liehom.scalars import ExactMatrix, Scalar
from liehom.scalars.fields.exact_field import as_exact

UNKNOWN = "?"
"""Letter of a pair that no letter describes, which the theorem excludes."""


def key_of(action: TracelessIsotropyAction) -> tuple[Key, Subalgebra]:
    """The key of a full pair, and the largest ideal of g inside h.

    Examples
    --------
    >>> import liehom as lh
    >>> key, ideal = key_of(TracelessIsotropyAction(lh.pair("so(4)/u(2)")))
    >>> tuple(key), ideal.dimension
    (('C', 2, 0, 4, 'J', 1), 3)
    """
    pair = action.pair
    kernel = isotropy_kernel(pair)
    ideal = largest_ideal(pair, kernel)
    if action.size <= 1:
        return _small_key(action.size, pair.algebra.dimension - ideal.dimension), ideal
    s, e, centre, spiral = _isotropy_part(action, len(action.matrices) - kernel.nrows)
    letter, sign = _letter(effective_pair(pair, ideal), is_faithful=kernel.nrows == ideal.dimension)
    return Key(letter, action.size, s, e, centre, sign if spiral is None else spiral), ideal


def _small_key(d: int, dimension: int) -> Key:
    """The key of an effective pair with dim g/h = d <= 1 and this dimension of g."""
    centre = "R" if dimension > d else ""
    letter = "A" if dimension <= 2 * d else "B" if dimension == 3 else UNKNOWN
    return Key(letter, d, 0, d, centre)


def _isotropy_part(action: TracelessIsotropyAction, dimension: int) -> tuple[int, int, str, Scalar | None]:
    """The part (s, e, centre, c^2 of a spiral) of the key; `dimension` is that of rho(h)."""
    basis, scalars = action.commutant(), dimension > action.dimension
    i, weight, j = _central(action) if len(basis) == 2 else (0, action.field.zero, basis[0])
    if weight == 0:
        return action.dimension, len(basis), "R" if scalars else "", None
    s, norm = action.dimension - 1, (j @ j).trace()
    e = _commutant_dimension(action, j)
    if scalars:
        return s, e, "C", None
    # rho(h) has one element J + t. Traces vanish on S, so they are proportional to tr(A J) on L0
    t = action.matrices[action.members[i]].trace() * norm / weight / action.size
    return (s, e, "J", None) if t == 0 else (s, e, SPIRAL, -t * t * action.size / norm)


def _central(action: TracelessIsotropyAction) -> tuple[int, Scalar, ExactMatrix]:
    """An index i with tr(A_i J) != 0, the trace, and J, for a commutant R + RJ; the trace 0 if J is not in L0.

    If the centre of L0 is 0, then L0 = [L0, L0] and all these traces vanish; if it is RJ, then tr(J J) does not.
    """
    (j,) = traceless(action.commutant(), action.size, action.field)
    square = action.size**2
    flat = action.field.stack_rows([a.reshape(1, square) for a in action.traceless], square)
    weights = (flat @ j.T.reshape(square, 1)).entries()
    i = next((i for i, weight in enumerate(weights) if weight != 0), 0)
    return i, weights[i], j


def _commutant_dimension(action: TracelessIsotropyAction, j: ExactMatrix) -> int:
    """Dimension e of the commutant of S = {A in L0 : tr(A J) = 0}, for L0 = S + RJ: 2 or 4."""
    d, s, norm = action.size, action.dimension - 1, (j @ j).trace()
    possible = {row.key.e for row in rows(d) if (row.key.s, row.key.centre) == (s, "J")}
    if len(possible) == 1:
        return possible.pop()
    # su(2m) and sl(m,H)
    inside = [combination([a, j], [1, -(a @ j).trace() / norm]) for a in action.traceless]
    return len(commutant(inside, d, action.field))


def _letter(effective: Pair, *, is_faithful: bool) -> tuple[str, int | None]:
    """The letter of an effective pair and, in C, the sign; `is_faithful` says whether its isotropy acts faithfully."""
    form = as_exact(effective.algebra.killing_form())
    degenerate = form.rank() < effective.algebra.dimension
    if degenerate or not is_faithful:
        return ("A" if is_faithful else UNKNOWN) if degenerate else "B", None
    # the Killing form is definite on the orthogonal complement of h, so that one vector has its sign
    v = (effective.subalgebra.basis @ form).null_space().select(rows=[0])
    return "C", -effective.field.sign((v @ form @ v.T)[0, 0])
