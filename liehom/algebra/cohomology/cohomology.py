"""Chevalley-Eilenberg cohomology H^k(g, V) of a Lie algebra, with cocycles that represent its classes.

Ranks modulo a prime bound dim H^k from above, which proves H^k = 0 if the bound is 0. Otherwise a complement of the
coboundaries is computed exactly: the cocycles that vanish at indices where the coboundaries are independent modulo the
prime.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, TypeAlias, final

from liehom.algebra.cohomology.cochain_complex import CochainComplex
from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.matrices.matrix_basis import require_size
from liehom.errors import InputError, InternalError, ShapeError, SingularError
from liehom.immutable import Immutable
from liehom.scalars import Matrix, Subspace, as_exact
from liehom.scalars.fields.field import MatricesLike
from liehom.scalars.modular.modular import pivot_columns
from liehom.typing import ScalarLike, VectorLike

CochainLike: TypeAlias = VectorLike | Matrix
"""A cochain: its coordinates as a sequence of numbers, or a row matrix."""

MAX_PRIMES = 5
"""Number of primes that are tried before the computation fails."""


@final
class Cohomology(Immutable):
    """The cohomology of a Lie algebra in one degree, the result of `LieAlgebra.cohomology`.

    A cochain is a row, as in `liehom.algebra.cohomology.cochain_complex`. `cochain` constructs it from its values on
    basis elements, and `values` returns them.

    Attributes
    ----------
    cochains : CochainComplex
        The complex, with the algebra g and the module V.
    degree : int
        k.
    representatives : Matrix
        Cocycles, one row for each member of a basis of H^k.

    Examples
    --------
    >>> import liehom as lh
    >>> made = lh.heisenberg(1).cohomology(2)
    >>> made.dimension, [made.values(row) for row in made.representatives.to_rows()]
    (2, [{(0, 2): 1}, {(1, 2): 1}])
    >>> made.is_coboundary(made.cochain({(0, 1): 5}))
    True
    """

    __slots__ = ("cochains", "degree", "representatives")

    def __init__(self, cochains: CochainComplex, degree: int, representatives: Matrix) -> None:
        self.cochains: CochainComplex = cochains
        self.degree: int = degree
        self.representatives: Matrix = representatives

    # -- properties --------------------------------------------------------------------------------------
    @property
    def algebra(self) -> LieAlgebra:
        """The Lie algebra g."""
        return self.cochains.algebra

    @property
    def dimension(self) -> int:
        """dim H^k(g, V), an int."""
        return int(self.representatives.nrows)

    # -- verbs -------------------------------------------------------------------------------------------
    def coboundaries(self) -> Subspace:
        """The subspace of coboundaries d w, for cochains w of degree k - 1."""
        return Subspace(self.algebra.field, self.cochains.differential(self.degree - 1), self._length())

    def cocycles(self) -> Subspace:
        """The subspace of cocycles."""
        return self.coboundaries() + Subspace(self.algebra.field, self.representatives, self._length())

    def is_cocycle(self, cochain: CochainLike) -> bool:
        """Whether d w = 0 for a cochain w."""
        return bool((self._row(cochain) @ self.cochains.differential(self.degree)).is_zero())

    def is_coboundary(self, cochain: CochainLike) -> bool:
        """Whether a cochain w is d v for some v."""
        try:
            self.potential(cochain)
        except SingularError:
            return False
        return True

    def potential(self, cochain: CochainLike) -> Matrix:
        """A cochain v with d v = w, as a row matrix; raises `SingularError` if w is not a coboundary."""
        row = self._row(cochain)
        before = self.cochains.differential(self.degree - 1)
        found: Matrix = self.algebra.field.zeros(1, before.nrows)
        if not row.is_zero():
            if 0 in before.shape:
                raise SingularError("the cochain is not zero, and there are no coboundaries")
            found = before.T.solve(row.T).T
        return found

    def coordinates(self, cochain: CochainLike) -> Matrix:
        """The class of a cocycle in the basis of the representatives, as a row matrix (1, dim H^k).

        Raises
        ------
        InputError
            If the cochain is not a cocycle.
        """
        row, field = self._row(cochain), self.algebra.field
        if not self.is_cocycle(row):
            raise InputError("the cochain is not a cocycle: it has no class")
        found: Matrix = field.zeros(1, self.dimension)
        if self.dimension > 0 and not row.is_zero():
            rows = field.stack_rows([self.representatives, self.cochains.differential(self.degree - 1)], self._length())
            found = rows.T.solve(row.T).T.select(columns=range(self.dimension))
        return found

    def cochain(self, values: Mapping[Any, ScalarLike | VectorLike]) -> Matrix:
        """The cochain with given values on basis elements, as a row matrix.

        Parameters
        ----------
        values : mapping
            From k different indices (a tuple, or one index if k = 1) to a number, or to the coordinates of a vector of
            V if dim V is not 1. The order of the indices determines the sign; other values are 0.

        Raises
        ------
        InputError
            If a key is not a tuple of k different indices.
        ShapeError
            If a value does not have dim V coordinates.
        """
        field, m, n = self.algebra.field, self.cochains.size, self.algebra.dimension
        position = {indices: x for x, indices in enumerate(self.cochains.index_tuples(self.degree))}
        entries = [field.zero] * self._length()
        for key, value in values.items():
            indices = tuple(key) if isinstance(key, tuple) else (key,)
            ordered = tuple(sorted(indices)) if all(isinstance(i, int) for i in indices) else indices
            if ordered not in position:
                raise InputError(f"{key!r} is not a tuple of {self.degree} different indices from 0 to {n - 1}")
            given = [value] if isinstance(value, str) or not isinstance(value, Iterable) else list(value)
            if len(given) != m:
                raise ShapeError(f"the value at {key!r} has {len(given)} coordinates, expected {m}")
            odd = sum(a > b for x, a in enumerate(indices) for b in indices[x + 1 :]) % 2
            for u, v in enumerate(map(field.convert, given)):
                entries[position[ordered] * m + u] += -v if odd else v
        row: Matrix = field.from_entries(entries, 1, self._length())
        return row

    def values(self, cochain: CochainLike) -> dict[tuple[int, ...], Any]:
        """The non-zero values by increasing indices: numbers, or lists of coordinates if dim V is not 1."""
        row, m = self._row(cochain).row(0), self.cochains.size
        blocks = {p: row[x * m : (x + 1) * m] for x, p in enumerate(self.cochains.index_tuples(self.degree))}
        return {p: v[0] if m == 1 else v for p, v in blocks.items() if any(x != 0 for x in v)}

    def forms(self) -> list[Matrix]:
        """Antisymmetric matrices of the representatives of degree 2 with values in R, for `central_extension`.

        Raises
        ------
        InputError
            If the degree is not 2, or the module is not R.

        Examples
        --------
        >>> import liehom as lh
        >>> form = lh.abelian(2).cohomology(2).forms()[0]
        >>> lh.central_extension(lh.abelian(2), form) == lh.heisenberg(1)
        True
        """
        if self.degree != 2 or self.cochains.size != 1:
            raise InputError(f"only cochains of degree 2 with values in R are matrices; here k = {self.degree}")
        n, field = self.algebra.dimension, self.algebra.field
        made = []
        for row in self.representatives.to_rows():
            rows = [[field.zero] * n for _ in range(n)]
            for (i, j), v in self.values(row).items():
                rows[i][j], rows[j][i] = v, -v
            made.append(field.matrix(rows, (n, n)))
        return made

    def _length(self) -> int:
        return self.cochains.length(self.degree)

    def _row(self, cochain: CochainLike) -> Matrix:
        field, length = self.algebra.field, self._length()
        row: Matrix = field.read(cochain) if isinstance(cochain, Matrix) else field.matrix([cochain], (1, length))
        if row.shape != (1, length):
            raise ShapeError(f"a cochain of degree {self.degree} is a row of length {length}, got shape {row.shape}")
        return row

    def __repr__(self) -> str:
        g = self.algebra.name or f"a Lie algebra of dimension {self.algebra.dimension}"
        module = "" if self.cochains.matrices is None else f" with values in dimension {self.cochains.size}"
        return f"<H^{self.degree} of {g}{module}: dimension {self.dimension}>"


def cohomology(
    algebra: LieAlgebra, degree: int, matrices: MatricesLike | None = None, *, size: int | None = None
) -> Cohomology:
    """Implements `LieAlgebra.cohomology`."""
    require_size("degree", degree, 0)
    degree = int(degree)
    cochains = CochainComplex(algebra, matrices, size=size)
    field, length = algebra.field, cochains.length(degree)
    if length == 0:
        return Cohomology(cochains, degree, field.zeros(0, 0))
    if not field.exact:
        # cochains in the kernel of d that are orthogonal to the coboundaries
        after, before = cochains.differential(degree), cochains.differential(degree - 1)
        conditions = field.stack_rows([after.T, before], length)
        return Cohomology(cochains, degree, conditions.null_space("the dimension of the cohomology"))
    if degree in (1, 2) and algebra.is_semisimple():
        return Cohomology(cochains, degree, field.zeros(0, length))  # Whitehead's lemmas
    return Cohomology(cochains, degree, _Solver(cochains).complement(degree))


class _Solver:
    """Complements of the coboundaries in the cocycles, degree by degree, over an exact field."""

    def __init__(self, cochains: CochainComplex) -> None:
        self.cochains = cochains
        self.field = cochains.algebra.field
        self._complements: dict[int, Matrix] = {}
        self._images: dict[tuple[int, int], list[int]] = {}

    def rank(self, degree: int) -> int:
        """The exact rank of d on k-cochains, an int."""
        if self.cochains.length(degree) == 0:
            return 0
        matrix = self.cochains.differential(degree)
        if 0 in matrix.shape:
            return 0
        # C^k = coboundaries + complement + (a complement of the kernel of d)
        return int(matrix.nrows) - self.rank(degree - 1) - int(self.complement(degree).nrows)

    def pivots(self, degree: int, attempt: int) -> list[int]:
        """Indices of columns of d that are a basis of its column space modulo a prime."""
        if (degree, attempt) not in self._images:
            matrix = self.cochains.differential(degree)
            image = [] if 0 in matrix.shape else pivot_columns(as_exact(matrix).modulo(attempt))
            self._images[degree, attempt] = image
        return self._images[degree, attempt]

    def complement(self, degree: int) -> Matrix:
        """Cocycles that are a basis of the cocycles modulo the coboundaries, as rows."""
        if degree not in self._complements:
            self._complements[degree] = self._found(degree)
        return self._complements[degree]

    def _found(self, degree: int) -> Matrix:
        length = self.cochains.length(degree)
        rows: Matrix = self.field.zeros(0, length)
        for attempt in range(MAX_PRIMES):
            bounding, needed = self.pivots(degree - 1, attempt), self.pivots(degree, attempt)
            if len(bounding) + len(needed) == length:
                # the ranks modulo a prime are at most the true ones, whose sum is at most the length
                return rows
            if len(bounding) < self.rank(degree - 1):
                continue
            kept = sorted(set(range(length)) - set(bounding))
            after = self.cochains.differential(degree)
            some = after.select(kept, needed)
            solved = some.left_null_space() if needed else self.field.identity(len(kept))
            rows = solved @ self.field.identity(length).select(rows=kept)
            if (rows @ after).is_zero():
                return rows
        raise InternalError(f"no prime was usable for the cohomology of {self.cochains.algebra!r} in degree {degree}")
