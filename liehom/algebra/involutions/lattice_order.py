"""A large Lie order: a lattice in g that is closed under brackets and that suits g better than the basis does.

For any lattice L the normalizer N(L) = {x : [x, L] in L} is an order.  An order M is enlarged at a number d that
divides the discriminant of its Killing form: the normalizer of an ideal J of M contains M, and for
J = {x in M : K(x, M) = 0 mod d} it is larger for most M that are not maximal (the idea of the round-2 algorithm for
orders in fields and algebras); for primes d < 1000 the {x in M : K(x, M) = 0 mod d^k} + d M and other ideals are
tried too: at larger ones, lattices in special position may stay below a maximal order.  With d M in J and M = N(M),
N(J) lies in M/d, so that linear algebra modulo d finds it; d need not be a prime, and is split where elimination meets
a divisor.  Nothing here is proved to be maximal.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.involutions.ideals_modulo import LARGEST_PRIME, ideals_modulo
from liehom.scalars import QQ
from liehom.scalars.lattices.lattice import integral_preimage, kernel_modulo, pairwise_coprime, reduced_rows
from liehom.scalars.modular.modular_span import ModularSpan

STEPS = 60
SPARE = 20
TRIES = 12
IDEALS = 24


def lie_order(algebra: LieAlgebra, factor: Any, *, thorough: bool = True) -> Any:
    """A basis of a lattice closed under brackets, as rows (n, n) in the basis of a semisimple algebra over QQ.

    Parameters
    ----------
    algebra : LieAlgebra
    factor : (n, n) float array
        A frame: the basis is short and nearly orthogonal for the form factor factor^T.
    thorough : bool, optional
        Whether other ideals than the radical of the Killing form are tried, most of the cost: then the order is larger.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> g = lh.so(3).change_of_basis([[5, 0, 0], [1, 1, 0], [0, 1, 7]])
    >>> order = g.change_of_basis(lie_order(g, np.eye(3)))
    >>> int(g.killing_form().determinant()), int(order.killing_form().determinant())
    (-9800, -8)
    """
    basis = algebra.field.identity(algebra.dimension)
    order = _Order(algebra, basis, factor)
    for _ in range(STEPS):
        larger = order.normalizer()
        if larger is None:
            break
        order = larger
    waiting = pairwise_coprime(order.exponent())
    while waiting:
        d = waiting.pop()
        for _ in range(STEPS):
            found = order.enlarged(d, thorough)
            if isinstance(found, int):
                waiting += pairwise_coprime(found) + pairwise_coprime(d // found)
            if not isinstance(found, _Order):
                break
            order = found
    return order.basis


class _Order:
    """A lattice (rows of `basis`) and the structure constants in its basis."""

    def __init__(self, algebra: LieAlgebra, basis: Any, factor: Any) -> None:
        self.algebra, self.factor = algebra, factor
        self.basis = reduced_rows(basis, factor)
        self.n = algebra.dimension
        self.inner = algebra.change_of_basis(self.basis)

    def exponent(self) -> int:
        """The exponent of M^# / M for the Killing form."""
        return int(self.inner.killing_form().inverse().den)

    def normalizer(self) -> _Order | None:
        rows = integral_preimage(self.inner.table.flat())
        if abs(rows.determinant()) == 1:
            return None
        return _Order(self.algebra, rows @ self.basis, self.factor)

    def enlarged(self, d: int, thorough: bool) -> _Order | int | None:
        """A larger order inside M/d, a divisor of d, or None."""
        for space in self._ideals(d):
            if isinstance(space, int):
                return space
            found = self._normalizer_of(space, d)
            if isinstance(found, int):
                return found
            if found[0]:
                return self._with(found, d)
        return self._enlarged_by_search(d) if thorough and d < LARGEST_PRIME else None

    def _ideals(self, d: int) -> Iterator[Any]:
        """0, the radical of the Killing form over its content, for small primes the images of {x : K(x, M) in d^k}.

        Where d divides the dual Coxeter number the whole form vanishes modulo d.
        """
        killing = self.inner.killing_form()
        yield [], list(range(self.n))
        yield kernel_modulo(killing.primitive(), d)
        power, last = d, self.n
        while d < LARGEST_PRIME:
            rows = integral_preimage(QQ.stack_columns([QQ.identity(self.n), killing.scale(QQ.one / power)], self.n))
            table = np.array([int(x) % d for x in rows.parts[0].entries()], dtype=np.int64).reshape(self.n, self.n)
            span = ModularSpan(d, self.n)
            span.extend(table)
            space, pivots = span.echelon()
            if not pivots:
                return
            if len(pivots) < last:
                yield space.tolist(), [j for j in range(self.n) if j not in pivots]
            power, last = power * d, len(pivots)

    def _enlarged_by_search(self, p: int) -> _Order | None:
        """The largest of the normalizers of some ideals modulo a small prime."""
        n = self.n
        constants = np.array([int(x) % p for x in self.inner.table.dense().parts[0].entries()], dtype=np.int64)
        best: Any = ([], [])
        for space in ideals_modulo(constants.reshape(n, n, n), p, TRIES, IDEALS):
            pivots = [next(j for j in range(n) if row[j]) for row in space.tolist()]
            found = self._normalizer_of((space.tolist(), [j for j in range(n) if j not in pivots]), p)
            if len(found[0]) > len(best[0]):
                best = found
        return self._with(best, p) if best[0] else None

    def _with(self, space: Any, d: int) -> _Order:
        lattice = QQ.from_integers(_flattened(space, d, self.n), self.n, self.n, d)
        return _Order(self.algebra, lattice @ self.basis, self.factor)

    def _normalizer_of(self, space: Any, d: int) -> Any:
        """The y modulo d with [y, J] in d J for an ideal J / d M of M / d M."""
        field, n = QQ, self.n
        ideal = field.from_integers(_flattened(space, d, n), n, n)
        blocks = self.inner.table.contract(field.identity(n), ideal, ideal.inverse())
        flat = field.stack_rows([b.reshape(1, n * n) for b in blocks], n * n)
        count = min(n * n, n + SPARE)
        weights = np.random.default_rng(n).integers(0, min(d, 1 << 30), n * n * count)
        mixing = field.from_integers(weights.tolist(), n * n, count)
        return kernel_modulo(flat @ mixing, d)


def _flattened(space: Any, d: int, n: int) -> list[int]:
    """The lattice of the rows and d Z^n, for rows that are the unit vectors outside the pivots."""
    rows, pivots = space
    units = [d * int(j == i) for i in pivots for j in range(n)]
    return [x for row in rows for x in row] + units
