"""Isotropy representation on V = g/h as traceless matrices, with their lifts to g: the input of the decision.

L0 = {rho(z) - (tr rho(z)/d) 1}; a pair is full iff rank [L0 x, x] = d for every x != 0 in V.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from typing import cast, final

from liehom.base.errors import UndecidedError
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.invariants.intertwiners import commutant
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.modular import independent_columns, independent_rows, pivot_columns
from liehom.exact.scalars.subspaces import Quotient


@final
class TracelessIsotropyAction:
    """The isotropy representation of an exact pair, prepared for the decision.

    `matrices` are rho of the rows of ``quotient.subspace``, (d, d), acting on columns. `members` are the indices of
    the matrices whose traceless parts `traceless` are a basis of L0; `size` is d = dim g/h.
    """

    quotient: Quotient[ExactMatrix]

    __slots__ = ("_columns", "_commutant", "field", "matrices", "members", "pair", "quotient", "size", "traceless")

    def __init__(self, pair: Pair) -> None:
        if not isinstance(pair.field, ExactField):
            raise UndecidedError(
                f"this is decided over exact fields only, and the pair is over {pair.field.name}: make it exact by "
                "lh.rationalize(pair, max_denominator=...)"
            )
        self.pair: Pair = pair
        self.field: ExactField = pair.field
        self.size: int = pair.dimension
        self.quotient = pair.subalgebra.quotient()
        self.matrices: list[ExactMatrix] = cast("list[ExactMatrix]", pair.isotropy_matrices())  # the field is exact
        reduced = [self._traceless(a) for a in self.matrices]
        self.members: list[int] = independent_rows(self.flat(reduced)) if reduced else []
        self.traceless: list[ExactMatrix] = [reduced[i] for i in self.members]
        self._columns: dict[int, tuple[list[int], ExactMatrix]] = {}
        self._commutant: list[ExactMatrix] | None = None

    def _traceless(self, matrix: ExactMatrix) -> ExactMatrix:
        trace = matrix.trace()
        return matrix if trace == 0 else matrix - self.field.identity(self.size).scale(trace / self.size)

    @property
    def dimension(self) -> int:
        """Dimension of L0."""
        return len(self.traceless)

    def commutant(self) -> list[ExactMatrix]:
        """A basis of the matrices that commute with L0 (cached)."""
        if self._commutant is None:
            self._commutant = commutant(self.traceless, self.size, self.field)
        return self._commutant

    def flat(self, matrices: Sequence[ExactMatrix]) -> ExactMatrix:
        """Matrices of V, each as one row of d^2 entries."""
        square = self.size**2
        return self.field.stack_rows([a.reshape(1, square) for a in matrices], square)

    # -- between V and g ---------------------------------------------------------------------------------
    def lifted(self, x: ExactMatrix) -> ExactMatrix:
        """Row (1, n) in g that represents a column x (d, 1) of V."""
        return x.T @ self.quotient.lift

    def covector(self, phi: ExactMatrix) -> ExactMatrix:
        """Covector (1, n) on g, zero on h, of a row phi (1, d) of linear-form coefficients on V."""
        return phi @ self.quotient.projection.T

    def element(self, coefficients: Sequence[Scalar]) -> ExactMatrix:
        """Row (1, n) in g of the element of h with these coefficients in the basis of L0."""
        coordinates = self.field.matrix([list(coefficients)], (1, len(self.members)))
        return coordinates @ self.quotient.subspace.select(rows=self.members)

    # -- ranks -------------------------------------------------------------------------------------------
    def action_rows(self, x: ExactMatrix, indices: Sequence[int] | None = None) -> ExactMatrix:
        """Rows x, rho(z_1) x, ... for a column x of V and the matrices with the given indices (default: all)."""
        chosen = list(range(len(self.matrices))) if indices is None else list(indices)
        if not chosen:
            return x.T
        moved = (self._on_columns(chosen) @ x).reshape(len(chosen), self.size)
        return self.field.stack_rows([x.T, moved], self.size)

    def _on_columns(self, indices: list[int]) -> ExactMatrix:
        """The matrices below each other, so that one product applies all to a point; cached by their number."""
        count = len(indices)
        if count not in self._columns or self._columns[count][0] != indices:
            self._columns[count] = indices, self.field.stack_rows([self.matrices[i] for i in indices], self.size)
        return self._columns[count][1]

    def rank_at(self, x: ExactMatrix) -> int:
        """Exact rank of [rho(h) x, x]. Rank d modulo a prime proves rank d, so the search stops there."""
        if any(self.action_rows(x, indices).modulo().rank() == self.size for indices in self._batches()):
            return self.size
        return self.action_rows(x).rank()

    def spanning_members(self, x: ExactMatrix) -> list[int] | None:
        """Indices i of d - 1 matrices for which x and the rho(z_i) x are a basis of V, or None."""
        for indices in self._batches():
            pivots = pivot_columns(self.action_rows(x, indices).T.modulo())
            if len(pivots) == self.size and pivots[0] == 0:
                return [indices[i - 1] for i in pivots[1:]]
        pivots = independent_columns(self.action_rows(x).T)
        return [i - 1 for i in pivots[1:]] if len(pivots) == self.size else None

    def _batches(self) -> Iterator[list[int]]:
        """Indices of 4 d matrices spread over h, if there are more, then all indices."""
        total = len(self.matrices)
        if total > 4 * self.size:
            step = total / (4 * self.size)
            yield sorted({int(i * step) for i in range(4 * self.size)})
        yield list(range(total))

    def random_point(self, rng: random.Random) -> ExactMatrix:
        """Random nonzero column (d, 1) with integer entries from -4 to 4."""
        while True:
            entries = [rng.randint(-4, 4) for _ in range(self.size)]
            if any(entries):
                return self.field.from_integers(entries, self.size, 1)
