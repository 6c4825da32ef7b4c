"""A Cartan subalgebra: nilpotent and its own normalizer.

For x in g let g_0(x) = {y : (ad x)^k y = 0 for some k} be the Fitting null component of ad x, a subalgebra that is its
own normalizer.  The algorithm starts with g.  As long as the subalgebra is not nilpotent, some element of its basis or
some sum of two basis elements has a smaller null component in it (de Graaf, Lie Algebras: Theory and Algorithms, 3.2).
Basis elements are tried first, so that a basis of root vectors gives the split Cartan subalgebra that it contains.
"""

from __future__ import annotations

import random
from collections.abc import Iterator

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.subalgebra import Subalgebra, lower_central_series
from liehom.algebra.structure.exact_field import exact_field
from liehom.errors import InternalError
from liehom.scalars import ExactMatrix, as_exact
from liehom.scalars.spaces.integral_basis import SHORT_BITS, integral_basis
from liehom.scalars.spaces.quotient import echelon_quotient

Entries = tuple[object, ...]  # the integer coordinates of an element


def cartan_subalgebra(algebra: LieAlgebra) -> Subalgebra:
    """Implements `LieAlgebra.cartan_subalgebra`."""
    field, n = exact_field(algebra, "Cartan subalgebras"), algebra.dimension
    rows, pivots = field.identity(n), list(range(n))
    tried: set[Entries] = set()
    while not _is_abelian(algebra, rows):
        smaller = _smaller(algebra, rows, pivots, tried)
        if smaller is None:
            break
        rows, pivots = smaller
    basis = rows.primitive() if rows.nrows else rows
    if any(int(abs(x)).bit_length() > SHORT_BITS for part in basis.parts for x in part.entries()):
        basis = integral_basis(rows)
    abelian = _is_abelian(algebra, basis)
    found = Subalgebra(algebra, basis, check=not abelian)  # echelon rows are independent
    if not abelian and lower_central_series(found.as_algebra())[-1].dimension:
        raise InternalError("no element has a smaller null component, but the subalgebra is not nilpotent")
    if not is_self_normalizing(found):
        raise InternalError("a null component is not its own normalizer")
    return found


def is_self_normalizing(subalgebra: Subalgebra) -> bool:
    """Whether a subalgebra h over an exact field is its own normalizer.

    It is enough that some element of h acts on g/h without a kernel, which is shown modulo a prime.

    Examples
    --------
    >>> import liehom as lh
    >>> is_self_normalizing(lh.sl(2).subalgebra([[0, 0, 1]])), is_self_normalizing(lh.sl(2).subalgebra([[1, 0, 0]]))
    (True, False)
    """
    algebra, basis = subalgebra.algebra, as_exact(subalgebra.basis)
    if 0 < basis.nrows < algebra.dimension:
        rng = random.Random(basis.nrows)
        x = algebra.field.matrix([[rng.randint(-9, 9) for _ in range(basis.nrows)]]) @ basis
        coordinates = echelon_quotient(basis)
        action = coordinates.lift @ algebra.ad(x).T @ coordinates.projection
        if int(action.modulo().rank()) == action.nrows:
            return True
    return algebra.normalizer(subalgebra).dimension == subalgebra.dimension


def _is_abelian(algebra: LieAlgebra, rows: ExactMatrix) -> bool:
    """Whether all rows commute; two random combinations are tried first."""
    if rows.nrows > 2:
        weights = [[i + 1 for i in range(rows.nrows)], [(i + 1) ** 2 % 17 - 8 for i in range(rows.nrows)]]
        pair = rows.field.matrix(weights) @ rows
        if not (pair.select(rows=[0]) @ algebra.ad(pair.select(rows=[1])).T).is_zero():
            return False
    return algebra.table.first_nonzero(rows, rows, algebra.field.identity(algebra.dimension)) is None


def _smaller(
    algebra: LieAlgebra, rows: ExactMatrix, pivots: list[int], tried: set[Entries]
) -> tuple[ExactMatrix, list[int]] | None:
    """A smaller null component in the span of the rows, as an echelon basis with its pivots, or None.

    The rows are an echelon basis of a subalgebra, so the entries of an element at the pivots are its coordinates.
    An element that acts nilpotently on a subalgebra also does on the subalgebras of it, and x acts nilpotently on
    g_0(x). Elements in `tried` are therefore skipped.
    """
    for candidate in _candidates(rows):
        key = tuple(x for part in candidate.parts for x in part.entries())
        if key in tried:
            continue
        tried.add(key)
        action = algebra.ad(candidate).T
        if rows.nrows < algebra.dimension:
            action = (rows @ action).select(columns=pivots)
        step, power = action.modulo(), 1
        # The ranks of the powers are constant from the number of rows on.
        while power < rows.nrows:
            step, power = step * step, 2 * power
        rank = int(step.rank())
        if rank:
            return (_null_component(action, rows.nrows - rank) @ rows).echelon()
    return None


def _null_component(action: ExactMatrix, expected: int) -> ExactMatrix:
    """A basis of the rows that some power of the action annihilates, `expected` many modulo a prime."""
    power = action
    kernel = power.left_null_space()
    while kernel.nrows < expected:
        power = power @ action
        larger = power.left_null_space()
        if larger.nrows == kernel.nrows:
            break
        kernel = larger
    return kernel


def _candidates(rows: ExactMatrix) -> Iterator[ExactMatrix]:
    """The rows, then their pairwise sums."""
    k = rows.nrows
    for i in range(k):
        yield rows.select(rows=[i])
    for i in range(k):
        for j in range(i):
            yield rows.select(rows=[i]) + rows.select(rows=[j])
