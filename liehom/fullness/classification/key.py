"""The key of a full pair, computed over its field by linear algebra and one sign.

Let L0 be the traceless part of rho(h) on V = g/h. For a full pair of dimension d >= 2 it is reductive and irreducible,
so its commutant is R, C = R + RJ or H, and its centre is 0 or RJ. The centre of L0 is RJ if and only if the commutant
is C and J lies in L0. Then S = [L0, L0] is the orthogonal complement of J in L0 for the trace form; otherwise S = L0.
"""

from __future__ import annotations

from collections.abc import Sequence

from liehom.algebra import Subalgebra
from liehom.errors import SingularError
from liehom.fullness.classification.effective import effective_pair, isotropy_kernel, largest_ideal
from liehom.fullness.classification.rows import SPIRAL, Key
from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction
from liehom.representations import Pair
from liehom.representations.invariants.intertwiners import commutant
from liehom.representations.invariants.irreducibility import combination, traceless
from liehom.scalars import ExactMatrix, Scalar

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
    """The part (s, e, centre, parameter of a spiral) of the key; `dimension` is that of rho(h)."""
    basis, scalars = action.commutant(), dimension > action.dimension
    centre = _central(action, basis) if len(basis) == 2 else None
    if centre is None:
        return action.dimension, len(basis), "R" if scalars else "", None
    j, coefficients = centre
    e = len(commutant(_trace_orthogonal(action.traceless, j), action.size, action.field))
    if scalars:
        return action.dimension - 1, e, "C", None
    # rho(h) has one element whose traceless part is J: its trace is d times the real part
    traces = (action.matrices[i].trace() for i in action.members)
    real = sum((c * t for c, t in zip(coefficients, traces, strict=True)), action.field.zero) / action.size
    if real == 0:
        return action.dimension - 1, e, "J", None
    return action.dimension - 1, e, SPIRAL, -real * real / (j @ j)[0, 0]


def _central(action: TracelessIsotropyAction, basis: Sequence[ExactMatrix]) -> tuple[ExactMatrix, list[Scalar]] | None:
    """J of the commutant R + RJ and its coefficients in the basis of L0, or None if J is not in L0."""
    square = action.size**2
    (j,) = traceless(basis, action.size, action.field)
    row = j.reshape(1, square)
    flat = action.field.stack_rows([a.reshape(1, square) for a in action.traceless], square)
    both = action.field.stack_rows([flat, row], square)
    if int(both.modulo().rank()) > action.dimension:
        return None
    try:
        return j, flat.T.solve(row.T).entries()
    except SingularError:
        return None


def _trace_orthogonal(matrices: Sequence[ExactMatrix], j: ExactMatrix) -> list[ExactMatrix]:
    """The matrices A - (tr(A J) / tr(J J)) J: they span the orthogonal complement of J in a span that contains J."""
    norm = (j @ j).trace()
    return [combination([a, j], [1, -(a @ j).trace() / norm]) for a in matrices]


def _letter(effective: Pair, *, is_faithful: bool) -> tuple[str, int | None]:
    """The letter of an effective pair and, in C, the sign; `is_faithful` says whether its isotropy acts faithfully."""
    form: ExactMatrix = effective.algebra.killing_form()  # type: ignore[assignment]  # the pair is exact
    degenerate = form.rank() < effective.algebra.dimension
    if degenerate or not is_faithful:
        return ("A" if is_faithful else UNKNOWN) if degenerate else "B", None
    # the Killing form is definite on the orthogonal complement of h, so that one vector has its sign
    v = (effective.subalgebra.basis @ form).null_space().select(rows=[0])
    return "C", -effective.field.sign((v @ form @ v.T)[0, 0])
