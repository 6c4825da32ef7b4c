"""Copies: the matrices of the product of n equal representations, made when they are asked for.

    rho(x_1, ..., x_n)(m_1, ..., m_n) = (sigma(x_1) m_1, ..., sigma(x_n) m_n)

n dim g matrices of size n N have n^3 dim g N^2 entries, nearly all of them 0: for 100 spins 27 million.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Protocol, final, overload

from liehom.scalars import Field, Matrix, Scalar


class Single(Protocol):
    """The representation that is copied, by its matrices."""

    @property
    def field(self) -> Field: ...
    @property
    def size(self) -> int: ...
    @property
    def matrices(self) -> tuple[Matrix, ...]: ...


@final
class Copies(Sequence[Matrix]):
    """The matrices of n copies of a representation sigma, on which the n-th direct power of the algebra acts.

    Parameters
    ----------
    single : Representation
        sigma.
    count : int
        n.

    Examples
    --------
    >>> import liehom as lh
    >>> matrices = Copies(lh.defining(lh.so(2)), 2)
    >>> len(matrices), matrices.size, matrices[1].to_numpy()[2:, 2:].tolist()
    (2, 4, [[0.0, -1.0], [1.0, 0.0]])
    >>> matrices.entries()
    [(0, 1, 0, -1), (0, 0, 1, 1), (1, 3, 2, -1), (1, 2, 3, 1)]
    """

    single: Any
    copies: int

    def __init__(self, single: Single, count: int) -> None:
        self.single, self.copies = single, count
        self._made: dict[int, Matrix] = {}

    @property
    def size(self) -> int:
        """n N, the number of coordinates."""
        size: int = self.copies * self.single.size
        return size

    def entries(self) -> list[tuple[int, int, int, Scalar]]:
        """The entries (a, j, i, value) of matrix a in row i and column j that are not 0."""
        own = [
            (a, j, i, value)
            for a, matrix in enumerate(self.single.matrices)
            for i, row in enumerate(matrix.to_rows())
            for j, value in enumerate(row)
            if value != 0
        ]
        d, n = len(self.single.matrices), self.single.size
        return [(a + d * k, j + n * k, i + n * k, value) for k in range(self.copies) for a, j, i, value in own]

    def __len__(self) -> int:
        return self.copies * len(self.single.matrices)

    @overload
    def __getitem__(self, index: int) -> Matrix: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Matrix]: ...
    def __getitem__(self, index: int | slice) -> Matrix | Sequence[Matrix]:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        if not -len(self) <= index < len(self):
            raise IndexError(index)
        place = index % len(self)
        if place not in self._made:
            d, n, field = len(self.single.matrices), self.single.size, self.single.field
            k, a = divmod(place, d)
            rows = [[field.zero] * self.size for _ in range(self.size)]
            for i, row in enumerate(self.single.matrices[a].to_rows()):
                rows[k * n + i][k * n : (k + 1) * n] = row
            self._made[place] = field.matrix(rows, (self.size, self.size))
        return self._made[place]

    def __iter__(self) -> Iterator[Matrix]:
        return (self[i] for i in range(len(self)))

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Copies):
            return self.copies == other.copies and self.single == other.single
        return isinstance(other, tuple) and tuple(self) == other

    def __hash__(self) -> int:
        return hash(tuple(self))


def copies_of(representation: Single) -> Copies | None:
    """The matrices of a representation if they are `Copies`, else None.

    Examples
    --------
    >>> import liehom as lh
    >>> copies_of(lh.defining(lh.so(2))) is None
    True
    """
    matrices: Any = representation.matrices
    return matrices if isinstance(matrices, Copies) else None
