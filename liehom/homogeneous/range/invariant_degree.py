"""The degree of the relative invariant, from one line, in any dimension.

Let f be the reduced equation of the hypersurface where the range condition fails, and y a point at which it holds, so
f(y) != 0 and f(x + t y) has the degree of f in t.  Its roots are among the t at which [h, psi] + R psi has a rank less
than d at psi = x + t y.  If the rank is d - 1 there, the complex orbit of psi is open in a component of f = 0.  All of
the component near psi is this orbit, which is smooth, and f has a simple zero.  If moreover y is not tangent to the
orbit, t is a simple root of f(x + t y).  If this is so at all t found, the degree of f is their number.  See
Proposition 6b in docs/theory/fullness.md.
"""

from __future__ import annotations

import random

from liehom.errors import UndecidedError
from liehom.homogeneous.range.range_condition import pencil, range_condition
from liehom.homogeneous.range.relative_invariant import MAX_DIMENSION, relative_invariant, require_rational
from liehom.representations import Pair
from liehom.scalars.spaces.line_minors import rank_losses_on_line

LINES = 3


def invariant_degree(pair: Pair) -> int | None:
    """The degree of `relative_invariant`, in any dimension of g/h.

    Parameters
    ----------
    pair : Pair
        Over QQ.

    Returns
    -------
    int or None
        None if the range condition holds for no psi, or if h = g.

    Raises
    ------
    FieldError
        Over a number field or floats.
    UndecidedError
        If it is not decided whether the range condition holds, or if g/h has dimension above 8 and the hypersurface has
        a component without an open orbit.

    Examples
    --------
    >>> import liehom as lh
    >>> [invariant_degree(lh.pair(name)) for name in ("so(12)/so(11)", "sl(12)/P1", "affine(S2(gl(4)))")]
    [2, 0, 4]
    """
    require_rational(pair)
    generic = range_condition(pair)
    if pair.dimension == 0 or not generic:
        return None
    forms, d = pencil(pair), pair.dimension
    direction = pair.coordinates(generic.psi).row(0)
    rng = random.Random(d)
    for size in range(LINES):
        start = [rng.randint(-2 - size, 2 + size) for _ in range(d)]
        losses = rank_losses_on_line(forms, start, direction)
        if all(loss.rank == d - 1 and loss.transversal for loss in losses):
            return sum(loss.degree for loss in losses)
    if d <= MAX_DIMENSION:
        invariant = relative_invariant(pair)
        return None if invariant is None else invariant.degree
    raise UndecidedError(
        f"on {LINES} lines the range condition fails at points whose orbits have codimension 2 or more, and the minors "
        f"themselves are computed up to dimension {MAX_DIMENSION} of g/h"
    )
