"""TracelessIsotropyAction: what the decision works on, the matrices of h on V = g/h, made traceless, with their lifts.

L0 = {rho(z) - (tr rho(z)/d) 1}; a pair is full iff rank [L0 x, x] = d for every x != 0 in V.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from typing import Any, cast, final

from liehom.representations import Pair
from liehom.scalars import ExactField, ExactMatrix
from liehom.scalars.modular.modular import independent_columns, independent_rows, pivot_columns


@final
class TracelessIsotropyAction:
    """The isotropy representation of an exact pair, prepared for the decision.

    Attributes
    ----------
    pair : Pair
    field : ExactField
    size : int
        d = dim g/h.
    matrices : list of ExactMatrix
        rho of the rows of ``quotient.subspace``, (d, d), acting on columns.
    members : list of int
        Indices of matrices whose traceless parts are a basis of L0.
    traceless : list of ExactMatrix
        That basis of L0.
    """

    __slots__ = ("_columns", "field", "matrices", "members", "pair", "quotient", "size", "traceless")

    def __init__(self, pair: Pair) -> None:
        if not isinstance(pair.field, ExactField):
            raise TypeError("the exact decision needs an exact field")
        self.pair = pair
        self.field = pair.field
        self.size = pair.dimension
        self.quotient = pair.subalgebra.quotient()
        self.matrices = cast("list[ExactMatrix]", pair.isotropy_matrices())  # the field is exact
        reduced = [self._traceless(a) for a in self.matrices]
        square = self.size * self.size
        flat = self.field.stack_rows([a.reshape(1, square) for a in reduced], square)
        self.members = independent_rows(flat) if reduced else []
        self.traceless = [reduced[i] for i in self.members]
        self._columns: dict[int, Any] = {}

    def _traceless(self, matrix: Any) -> Any:
        trace = matrix.trace()
        return matrix if trace == 0 else matrix - self.field.identity(self.size).scale(trace / self.size)

    @property
    def dimension(self) -> int:
        """dim L0."""
        return len(self.traceless)

    # -- between V and g ---------------------------------------------------------------------------------
    def lifted(self, x: Any) -> Any:
        """The row in g (1, n) of a column x of V."""
        return x.T @ self.quotient.lift

    def covector(self, phi: Any) -> Any:
        """The covector on g (1, n) of a row phi on V; it vanishes on h."""
        return phi @ self.quotient.projection.T

    def element(self, coefficients: Sequence[Any]) -> Any:
        """The row in g (1, n) of the combination of L0's basis members with these coefficients."""
        row = self.field.matrix([list(coefficients)], (1, len(self.members)))
        return row @ self.quotient.subspace.select(rows=self.members)

    # -- ranks -------------------------------------------------------------------------------------------
    def action_rows(self, x: Any, indices: Sequence[int] | None = None) -> Any:
        """Rows x, rho(z_1) x, ... (as rows of V) for the given indices, all by default."""
        chosen = list(range(len(self.matrices))) if indices is None else list(indices)
        if not chosen:
            return x.T
        moved = (self._on_columns(chosen) @ x).reshape(len(chosen), self.size)
        return self.field.stack_rows([x.T, moved], self.size)

    def _on_columns(self, indices: list[int]) -> Any:
        """The matrices below each other, so that one product moves a point by all; kept for each batch."""
        count = len(indices)
        if count not in self._columns or self._columns[count][0] != indices:
            stacked = self.field.stack_rows([self.matrices[i] for i in indices], self.size)
            self._columns[count] = indices, stacked
        return self._columns[count][1]

    def rank_at(self, x: Any) -> int:
        """The exact rank of [rho(h) x, x]; stops as soon as d is reached modulo a prime, which proves d."""
        for indices in self._batches():
            if int(self.action_rows(x, indices).modulo().rank()) == self.size:
                return self.size
        return int(self.action_rows(x).rank())

    def spanning_members(self, x: Any) -> list[int] | None:
        """d - 1 indices with rho(z_i) x and x a basis of V, or None."""
        for indices in self._batches():
            found = pivot_columns(self.action_rows(x, indices).T.modulo())
            if len(found) == self.size and found[0] == 0:
                return [indices[i - 1] for i in found[1:]]
        found = independent_columns(self.action_rows(x).T)
        return [i - 1 for i in found[1:]] if len(found) == self.size else None

    def _batches(self) -> Iterator[list[int]]:
        """A first batch of 4 d matrices spread over h, then all."""
        total = len(self.matrices)
        if total > 4 * self.size:
            step = total / (4 * self.size)
            yield sorted({int(i * step) for i in range(4 * self.size)})
        yield list(range(total))

    def random_point(self, rng: random.Random) -> Any:
        """A non-zero column with small integer entries."""
        while True:
            entries = [rng.randint(-4, 4) for _ in range(self.size)]
            if any(entries):
                return self.field.from_integers(entries, self.size, 1)
