"""A large Lie order in g: a lattice that is closed under brackets, with a short and nearly orthogonal basis.

For any lattice L the normalizer N(L) = {x : [x, L] in L} is an order.  An order M is enlarged at a number d that
divides the discriminant of its Killing form.  The normalizer of an ideal J of M contains M.  For
J = {x in M : K(x, M) = 0 mod d} it is larger than M for most M that are not maximal, as in the round-2 algorithm for
orders in fields and algebras.  For primes d < 1000 the ideals {x in M : K(x, M) = 0 mod d^k} + d M are also tried,
and for primes d < 2^63 other submodules of M / d M.  If d M lies in J and M = N(M), then N(J) lies in M/d and is found
by linear algebra modulo d.  A large number d need not be a prime: it is split if elimination meets a divisor of it.  No
order is proved to be maximal.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

import numpy as np

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.involutions.ideals_modulo import LARGEST_PRIME, ideals_modulo
from liehom.scalars import QQ, ExactMatrix, as_exact
from liehom.scalars.lattices.lattice import (
    integral_preimage,
    kernel_modulo,
    pairwise_coprime,
    reduced_rows,
    smallest_prime,
)
from liehom.scalars.modular.modular_span import ModularSpan
from liehom.scalars.modular.modular_submodules import WORD, isotropic_submodules
from liehom.typing import Array

STEPS = 60  # enlargements at one number d
SPARE = 20  # random equations beyond the n unknowns
TRIES = 12  # random elements by which ideals are sought
SEARCHED = 16  # primes from which ideals come from factors of characteristic polynomials
FACTORED_BITS = 100  # bits of the numbers d that are factored
FACTORED = 3  # random elements whose characteristic polynomials are factored
IDEALS = 24  # ideals that are tried at one prime

Rows: TypeAlias = tuple[list[list[int]], list[int]]
"""A subspace of (Z/d)^n: rows that are unit vectors outside the pivots, and the pivots."""


def lattice_order(algebra: LieAlgebra, frame: Array, *, thorough: bool = True) -> ExactMatrix:
    """A basis of a lattice closed under brackets, as rows (n, n), for a semisimple algebra over QQ.

    Parameters
    ----------
    algebra : LieAlgebra
    frame : (n, n) float array
        A matrix F. The basis is short and nearly orthogonal for the form F F^T.
    thorough : bool, optional
        Try other ideals than the radical of the Killing form too (default). The order may then be larger, at several
        times the cost.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> g = lh.so(3).change_of_basis([[5, 0, 0], [1, 1, 0], [0, 1, 7]])
    >>> order = g.change_of_basis(lattice_order(g, np.eye(3)))
    >>> int(g.killing_form().determinant()), int(order.killing_form().determinant())
    (-9800, -8)
    """
    order = _Order(algebra, QQ.identity(algebra.dimension), frame)
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
    """A lattice with a reduced basis (rows of `basis`) and the algebra in this basis (`inner`)."""

    def __init__(self, algebra: LieAlgebra, basis: ExactMatrix, frame: Array) -> None:
        self.algebra, self.frame = algebra, frame
        self.basis = reduced_rows(basis, frame)
        self.n = algebra.dimension
        self.inner = algebra.change_of_basis(self.basis)

    def exponent(self) -> int:
        """The exponent of M^# / M, M^# the dual lattice for the Killing form."""
        return int(self.killing_form().inverse().den)

    def killing_form(self) -> ExactMatrix:
        """The Killing form in the basis of the lattice."""
        return as_exact(self.inner.killing_form())

    def normalizer(self) -> _Order | None:
        """The normalizer of the lattice, or None if it is the lattice itself."""
        rows = integral_preimage(as_exact(self.inner.table.flat()))
        if abs(rows.determinant()) == 1:
            return None
        return _Order(self.algebra, rows @ self.basis, self.frame)

    def enlarged(self, d: int, thorough: bool) -> _Order | int | None:
        """A larger order inside M/d, or a divisor of d that elimination met, or None if no larger order was found."""
        for space in self._ideals(d):
            if isinstance(space, int):
                return space
            found = self._normalizer_of(space, d)
            if isinstance(found, int):
                return found
            if found[0]:
                return self._with(found, d)
        if not thorough:
            return None
        if d < SEARCHED:
            return self._enlarged_by_search(d)
        if d.bit_length() <= FACTORED_BITS:
            first = smallest_prime(d)
            if first != d:
                return first
        return self._enlarged_by_factors(d) if d < WORD else None

    def _ideals(self, d: int) -> Iterator[Rows | int]:
        """Ideals of M / d M, or a divisor of d that elimination met.

        These are 0, the radical of the Killing form divided by its content (the form itself may vanish modulo d), and
        for small primes the images of {x : K(x, M) in d^k}.
        """
        killing = self.killing_form()
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
        """The largest of the normalizers of some ideals modulo a small prime, or None if none is larger than M."""
        n = self.n
        dense = as_exact(self.inner.table.dense())
        constants = np.array([int(x) % p for x in dense.parts[0].entries()], dtype=np.int64)
        best: Rows = ([], [])
        for space in ideals_modulo(constants.reshape(n, n, n), p, TRIES, IDEALS):
            pivots = [next(j for j in range(n) if row[j]) for row in space.tolist()]
            found = self._normalizer_of((space.tolist(), [j for j in range(n) if j not in pivots]), p)
            if not isinstance(found, int) and len(found[0]) > len(best[0]):
                best = found
        return self._with(best, p) if best[0] else None

    def _enlarged_by_factors(self, p: int) -> _Order | None:
        """The normalizer of an ideal in the radical of the Killing form modulo a prime, or None if none is larger."""
        n = self.n
        constants = [int(x) for x in as_exact(self.inner.table.dense()).parts[0].entries()]
        killing = [int(x) for x in self.killing_form().primitive().parts[0].entries()]
        for space in isotropic_submodules(constants, killing, p, FACTORED):
            pivots = [next(j for j in range(n) if row[j]) for row in space]
            found = self._normalizer_of((space, [j for j in range(n) if j not in pivots]), p)
            if not isinstance(found, int) and found[0]:
                return self._with(found, p)
        return None

    def _with(self, space: Rows, d: int) -> _Order:
        """The order generated by M and the rows divided by d."""
        lattice = QQ.from_integers(_flattened(space, d, self.n), self.n, self.n, d)
        return _Order(self.algebra, lattice @ self.basis, self.frame)

    def _normalizer_of(self, space: Rows, d: int) -> Rows | int:
        """The y modulo d with [y, J] in d J for an ideal J / d M of M / d M, or a divisor of d."""
        field, n = QQ, self.n
        ideal = field.from_integers(_flattened(space, d, n), n, n)
        blocks = self.inner.table.contract(field.identity(n), ideal, ideal.inverse())
        flat = field.stack_rows([b.reshape(1, n * n) for b in blocks], n * n)
        count = min(n * n, n + SPARE)
        weights = np.random.default_rng(n).integers(0, min(d, 1 << 30), n * n * count)
        mixing = field.from_integers(weights.tolist(), n * n, count)
        return kernel_modulo(flat @ mixing, d)


def _flattened(space: Rows, d: int, n: int) -> list[int]:
    """The entries, row after row, of a basis of the lattice that is generated by the rows and d Z^n."""
    rows, pivots = space
    units = [d * int(j == i) for i in pivots for j in range(n)]
    return [x for row in rows for x in row] + units
