"""A Cartan subalgebra: nilpotent and its own normalizer.

For x in g let g_0(x) be the null component of ad x, {y : (ad x)^k y = 0 for some k}: a subalgebra that is its own
normalizer.  While the subalgebra at hand is not nilpotent, some element of its basis or some sum of two has a
smaller null component in it (de Graaf, Lie Algebras: Theory and Algorithms, 3.2); the basis of g is tried first,
so that a basis of root vectors gives the split Cartan subalgebra that it shows.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from typing import Any

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.subalgebra import Subalgebra, lower_central_series
from liehom.errors import FieldError, InternalError
from liehom.scalars.spaces.quotient import echelon_quotient


def cartan_subalgebra(algebra: LieAlgebra) -> Subalgebra:
    """Implements `LieAlgebra.cartan_subalgebra`."""
    field, n = algebra.field, algebra.dimension
    if not field.exact:
        raise FieldError("a Cartan subalgebra is computed exactly: build the algebra over QQ or a number field")
    rows, pivots = field.identity(n), list(range(n))
    tried: set[tuple[Any, ...]] = set()
    while not _is_abelian(algebra, rows):
        smaller = _smaller(algebra, rows, pivots, tried)
        if smaller is None:
            break
        rows, pivots = smaller
    basis = rows.primitive() if rows.nrows else rows
    abelian = _is_abelian(algebra, basis)
    found = Subalgebra(algebra, basis, check=not abelian)  # echelon rows are independent
    if not abelian and lower_central_series(found.as_algebra())[-1].dimension:
        raise InternalError("no element has a smaller null component, but the subalgebra is not nilpotent")
    if not is_self_normalizing(found):
        raise InternalError("a null component is not its own normalizer")
    return found


def is_self_normalizing(subalgebra: Subalgebra) -> bool:
    """Whether N(h) = h.  It is enough that some element of h acts on g/h without a kernel, shown modulo a prime.

    Examples
    --------
    >>> import liehom as lh
    >>> is_self_normalizing(lh.sl(2).subalgebra([[0, 0, 1]])), is_self_normalizing(lh.sl(2).subalgebra([[1, 0, 0]]))
    (True, False)
    """
    algebra, basis = subalgebra.algebra, subalgebra.basis
    if 0 < basis.nrows < algebra.dimension:
        rng = random.Random(basis.nrows)
        x = algebra.field.matrix([[rng.randint(-9, 9) for _ in range(basis.nrows)]]) @ basis
        coordinates = echelon_quotient(basis)
        action = coordinates.lift @ algebra.ad(x).T @ coordinates.projection
        if int(action.modulo().rank()) == action.nrows:
            return True
    return algebra.normalizer(subalgebra).dimension == subalgebra.dimension


def _is_abelian(algebra: LieAlgebra, rows: Any) -> bool:
    if rows.nrows > 2:
        weights = [[i + 1 for i in range(rows.nrows)], [(i + 1) ** 2 % 17 - 8 for i in range(rows.nrows)]]
        pair = algebra.field.matrix(weights) @ rows
        if not (pair.select(rows=[0]) @ algebra.ad(pair.select(rows=[1])).T).is_zero():
            return False
    return algebra.table.first_nonzero(rows, rows, algebra.field.identity(algebra.dimension)) is None


def _smaller(algebra: LieAlgebra, rows: Any, pivots: list[int], tried: set[tuple[Any, ...]]) -> Any:
    """The null component, in the span of the rows, of the first candidate for which it is smaller; or None.

    The rows are an echelon basis of a subalgebra, so that an element of it has its coordinates at the pivots.
    What acts nilpotently on a subalgebra does so on its subalgebras, and x does on g_0(x): `tried` is not tried again.
    """
    for candidate in _candidates(rows):
        key = tuple(x for part in candidate.parts for x in part.entries())
        if key in tried:
            continue
        tried.add(key)
        action = algebra.ad(candidate).T
        if rows.nrows < algebra.dimension:
            action = (rows @ action).select(columns=pivots)
        step, places = action.modulo(), rows.nrows
        # The rank of a power is constant from the number of rows on.
        power = 1
        while power < places:
            step, power = step * step, 2 * power
        rank = int(step.rank())
        if rank:
            return (_null_component(action, places - rank) @ rows).echelon()
    return None


def _null_component(action: Any, expected: int) -> Any:
    """The rows that some power of the action kills; there are `expected` of them modulo a prime."""
    power = action
    kernel = power.left_null_space()
    while kernel.nrows < expected:
        power = power @ action
        larger = power.left_null_space()
        if larger.nrows == kernel.nrows:
            break
        kernel = larger
    return kernel


def _candidates(rows: Any) -> Iterator[Any]:
    k = rows.nrows
    for i in range(k):
        yield rows.select(rows=[i])
    for i in range(k):
        for j in range(i):
            yield rows.select(rows=[i]) + rows.select(rows=[j])
