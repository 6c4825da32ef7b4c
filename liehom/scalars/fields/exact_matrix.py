"""ExactMatrix: matrices over QQ and over real number fields, on python-flint.

A matrix over QQ(b), b an algebraic integer of degree m, is A = (A_0 + A_1 b + ... + A_{m-1} b^(m-1)) / den
with integer matrices A_s; QQ is the case m = 1.  Products are convolutions; echelon forms are taken over QQ
after restriction of scalars (each entry becomes the m x m matrix of multiplication by it), where flint
finds pivots modulo primes and verifies the lifted result exactly.
"""

from __future__ import annotations

import functools
import itertools
import random
from collections.abc import Sequence
from math import gcd, lcm
from typing import TYPE_CHECKING, Any, final

import flint
import numpy as np
import numpy.typing as npt

from liehom.errors import FieldError, ShapeError, SingularError
from liehom.scalars.fields.field import Matrix, Scalar

if TYPE_CHECKING:
    from liehom.scalars.fields.exact_field import ExactField

FIRST_PRIME = (1 << 61) - 1
TALL = 2
GUESSED_INVERSE = 40
SMALL_MATRIX = 64


@final
class ExactMatrix(Matrix):
    """A matrix over an exact field; made by ``field.matrix(rows)``.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> A = QQ.matrix([["1/2", 1], [0, 3]])
    >>> A @ A.inverse() == QQ.identity(2)
    True
    """

    __slots__ = ("_field", "den", "parts")

    def __init__(self, field: ExactField, parts: tuple[Any, ...], den: int) -> None:
        self._field = field
        self.parts = parts
        self.den = den

    # -- shape and entries -------------------------------------------------------------------------------
    @property
    def field(self) -> ExactField:
        return self._field

    @property
    def shape(self) -> tuple[int, int]:
        return self.parts[0].nrows(), self.parts[0].ncols()

    def __getitem__(self, index: tuple[int, int]) -> Scalar:
        if self._field.degree == 1:
            return flint.fmpq(self.parts[0][index], self.den)
        return self._field.from_coordinates([flint.fmpq(a[index], self.den) for a in self.parts])

    def entries(self) -> list[Scalar]:
        if self._field.degree == 1:
            first = self.parts[0]
            return (flint.fmpq_mat(first) / self.den if self.den != 1 else flint.fmpq_mat(first)).entries()
        columns = [a.entries() for a in self.parts]
        den = self.den
        return [self._field.from_coordinates([flint.fmpq(c, den) for c in x]) for x in zip(*columns, strict=True)]

    def to_rows(self) -> list[list[Scalar]]:
        n, entries = self.ncols, self.entries()
        return [entries[i * n : (i + 1) * n] for i in range(self.nrows)]

    def to_numpy(self) -> npt.NDArray[np.float64]:
        values = [self._field.to_float(x) for x in self.entries()]
        return np.array(values, dtype=np.float64).reshape(self.shape)

    def select(self, rows: Sequence[int] | None = None, columns: Sequence[int] | None = None) -> ExactMatrix:
        n = self.ncols
        if columns is None and rows is not None and 8 * len(rows) >= self.nrows:
            places = [i * n + j for i in rows for j in range(n)]
            return self._rearranged(places, len(rows), n)
        rows = range(self.nrows) if rows is None else rows
        columns = range(n) if columns is None else columns
        if 8 * len(rows) * len(columns) < self.nrows * n:
            parts = ([a[i, j] for i in rows for j in columns] for a in self.parts)
            made = tuple(flint.fmpz_mat(len(rows), len(columns), part) for part in parts)
            return ExactMatrix(self._field, made, self.den)
        return self._rearranged([i * n + j for i in rows for j in columns], len(rows), len(columns))

    def reshape(self, nrows: int, ncols: int) -> ExactMatrix:
        parts = tuple(flint.fmpz_mat(nrows, ncols, a.entries()) for a in self.parts)
        return ExactMatrix(self._field, parts, self.den)

    def split_rows(self, nrows: int, ncols: int) -> list[ExactMatrix]:
        size = nrows * ncols
        tables = [a.entries() for a in self.parts]
        blocks = []
        for i in range(self.nrows):
            parts = tuple(flint.fmpz_mat(nrows, ncols, t[i * size : (i + 1) * size]) for t in tables)
            blocks.append(ExactMatrix(self._field, parts, self.den))
        return blocks

    def _rearranged(self, places: list[int], nrows: int, ncols: int) -> ExactMatrix:
        parts = []
        for a in self.parts:
            e = a.entries()
            parts.append(flint.fmpz_mat(nrows, ncols, [e[x] for x in places]))
        return ExactMatrix(self._field, tuple(parts), self.den)

    def normalized(self) -> ExactMatrix:
        """The same matrix with the least positive common denominator."""
        if self.den == 1:
            return self
        common = flint.fmpz(self.den)
        for a in self.parts:
            common = _common_factor(common, a)
            if common == 1:
                return self
        integers = tuple((flint.fmpq_mat(a) / common).numer_denom()[0] for a in self.parts)
        return ExactMatrix(self._field, integers, self.den // int(common))

    def cleared(self) -> ExactMatrix:
        """The matrix times its common denominator."""
        return self if self.den == 1 else ExactMatrix(self._field, self.parts, 1)

    def primitive(self) -> ExactMatrix:
        """The positive multiple with integer coordinates that have no common factor; zero stays zero."""
        common = gcd(*(int(x) for a in self.parts for x in a.entries()))
        if common in (0, 1):
            return self.cleared()
        integers = (flint.fmpq_mat(a) / common for a in self.parts)
        return ExactMatrix(self._field, tuple(a.numer_denom()[0] for a in integers), 1)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, ExactMatrix):
            return NotImplemented
        if self.shape != other.shape or self._field != other._field:
            return False
        return all(a * other.den == b * self.den for a, b in zip(self.parts, other.parts, strict=True))

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"<matrix {self.nrows} x {self.ncols} over {self._field.name}>"

    def __str__(self) -> str:
        return "\n".join("[" + ", ".join(row) + "]" for row in self.to_strings())

    # -- arithmetic --------------------------------------------------------------------------------------
    @property
    def T(self) -> ExactMatrix:
        return ExactMatrix(self._field, tuple(a.transpose() for a in self.parts), self.den)

    def _combined(self, other: ExactMatrix, sign: int) -> ExactMatrix:
        if self.den == other.den:
            pairs = zip(self.parts, other.parts, strict=True)
            return ExactMatrix(self._field, tuple(a + b if sign > 0 else a - b for a, b in pairs), self.den)
        den = lcm(self.den, other.den)
        left, right = den // self.den, sign * (den // other.den)
        pairs = zip(self.parts, other.parts, strict=True)
        return ExactMatrix(self._field, tuple(a * left + b * right for a, b in pairs), den)

    def __add__(self, other: ExactMatrix) -> ExactMatrix:
        return self._combined(other, 1)

    def __sub__(self, other: ExactMatrix) -> ExactMatrix:
        return self._combined(other, -1)

    def __neg__(self) -> ExactMatrix:
        return ExactMatrix(self._field, tuple(-a for a in self.parts), self.den)

    def __matmul__(self, other: ExactMatrix) -> ExactMatrix:
        if self.ncols != other.nrows:
            raise ShapeError(f"matrices of shapes {self.shape} and {other.shape} do not multiply")
        den = self.den * other.den
        if self._field.degree == 1:
            return ExactMatrix(self._field, (self.parts[0] * other.parts[0],), den).normalized()
        m = self._field.degree
        powers: list[Any] = [None] * (2 * m - 1)
        for s, a in enumerate(self.parts):
            for t, b in enumerate(other.parts):
                powers[s + t] = a * b if powers[s + t] is None else powers[s + t] + a * b
        return ExactMatrix(self._field, self._reduced(powers), den).normalized()

    def _reduced(self, powers: list[Any]) -> tuple[Any, ...]:
        """Coefficient matrices of b^0 .. b^(2m-2), rewritten in b^0 .. b^(m-1)."""
        m = self._field.degree
        parts = powers[:m]
        for r in range(m, len(powers)):
            for s, c in enumerate(self._field.power_coordinates(r)):
                if c:
                    parts[s] = parts[s] + powers[r] * c
        return tuple(parts)

    def scale(self, factor: Any) -> ExactMatrix:
        factor = self._field.convert(factor)
        if self._field.degree == 1:
            return ExactMatrix(self._field, (self.parts[0] * factor.p,), self.den * int(factor.q)).normalized()
        coordinates = self._field.coordinates(factor)
        den = lcm(*(int(c.q) for c in coordinates))
        integers = [int(c.p) * (den // int(c.q)) for c in coordinates]
        m = self._field.degree
        powers = [flint.fmpz_mat(*self.shape) for _ in range(2 * m - 1)]
        for s, a in enumerate(self.parts):
            for t, c in enumerate(integers):
                if c:
                    powers[s + t] = powers[s + t] + a * c
        return ExactMatrix(self._field, self._reduced(powers), self.den * den).normalized()

    def is_zero(self) -> bool:
        return all(a.is_zero() for a in self.parts)

    def trace(self) -> Scalar:
        total = [sum((a[i, i] for i in range(self.nrows)), flint.fmpz(0)) for a in self.parts]
        if self._field.degree == 1:
            return flint.fmpq(total[0], self.den)
        return self._field.from_coordinates([flint.fmpq(x, self.den) for x in total])

    # -- linear algebra ----------------------------------------------------------------------------------
    def modulo(self, attempt: int = 0) -> Any:
        """The numerators modulo a prime (``flint.nmod_mat``); its rank is at most the true rank."""
        p, root = self._field.residue(attempt)
        image = flint.nmod_mat(self.parts[0], p)
        power = 1
        for a in self.parts[1:]:
            power = power * root % p
            image += flint.nmod_mat(a, p) * power
        return image

    def _restricted(self) -> Any:
        """The integer matrix (degree * nrows, degree * ncols) of the numerators over QQ."""
        m = self._field.degree
        if m == 1:
            return self.parts[0]
        r, c = self.shape
        out = [0] * (r * m * c * m)
        current = list(self.parts)
        for i in range(m):
            for s, a in enumerate(current):
                for place, x in enumerate(a.entries()):
                    row, column = divmod(place, c)
                    out[(row * m + i) * c * m + column * m + s] = x
            shifted = [flint.fmpz_mat(r, c), *current]
            current = list(self._reduced(shifted)) if m > 1 else shifted[:1]
        return flint.fmpz_mat(r * m, c * m, out)

    def rank(self) -> int:
        if 0 in self.shape:
            return 0
        lower = int(self.modulo().rank())
        if lower == min(self.shape):
            return lower
        return int(self._restricted().rank()) // self._field.degree

    def echelon(self) -> tuple[ExactMatrix, list[int]]:
        """The non-zero rows of the reduced row echelon form, and the pivot columns."""
        m, ncols = self._field.degree, self.ncols
        if 0 in self.shape:
            return self._field.zeros(0, ncols), []
        if self.nrows > TALL * ncols:
            found = self._tall_echelon()
            if found is not None:
                return found
        reduced, den, full_rank = self._restricted().rref()
        rank = full_rank // m
        table = reduced.entries()
        width = ncols * m
        parts = []
        for s in range(m):
            rows = [table[i * m * width + s : (i * m + 1) * width : m] for i in range(rank)]
            parts.append(flint.fmpz_mat(rank, ncols, [x for row in rows for x in row]))
        sign = -1 if den < 0 else 1
        matrix = ExactMatrix(self._field, tuple(a * sign for a in parts), int(den) * sign).normalized()
        return matrix, _pivots(matrix, rank, ncols)

    def _tall_echelon(self) -> tuple[ExactMatrix, list[int]] | None:
        """The echelon form from rows that are independent modulo a prime, if the others are shown to depend on them."""
        image, rank = self.modulo().transpose().rref()
        rows = nmod_pivots(image, int(rank))
        if rank == self.ncols:  # independent modulo a prime, so independent
            return self._field.identity(self.ncols), list(range(self.ncols))
        reduced, pivots = self.select(rows=rows).echelon()
        if self.select(columns=pivots) @ reduced != self:
            return None
        return reduced, pivots

    def row_space(self) -> ExactMatrix:
        return self.echelon()[0]

    def null_space(self) -> ExactMatrix:
        reduced, pivots = self.echelon()
        n = self.ncols
        chosen = set(pivots)
        free = [j for j in range(n) if j not in chosen]
        parts = []
        for s, a in enumerate(reduced.parts):
            out = [0] * (len(free) * n)
            entries = a.entries()
            for f, j in enumerate(free):
                if s == 0:
                    out[f * n + j] = reduced.den
                for i, pivot in enumerate(pivots):
                    out[f * n + pivot] = -entries[i * n + j]
            parts.append(flint.fmpz_mat(len(free), n, out))
        return ExactMatrix(self._field, tuple(parts), reduced.den).normalized()

    def solve(self, right: ExactMatrix) -> ExactMatrix:
        if right.nrows != self.nrows:
            raise ShapeError(f"the right-hand side has {right.nrows} rows, the matrix {self.nrows}")
        n, k = self.ncols, right.ncols
        joined = self._field.stack_columns([self, right], self.nrows)
        reduced, pivots = joined.echelon()
        if pivots and pivots[-1] >= n:
            raise SingularError("the linear system has no solution")
        solution: ExactMatrix = reduced.select(columns=range(n, n + k))
        if len(pivots) == n:
            return solution
        placed = self._field.zeros(n, len(pivots)).T.to_rows()
        for i, pivot in enumerate(pivots):
            placed[i][pivot] = self._field.one
        spread: ExactMatrix = self._field.matrix(placed, (len(pivots), n)).T @ solution
        return spread

    def inverse(self) -> ExactMatrix:
        n = self.nrows
        if n != self.ncols:
            raise ShapeError(f"a matrix of shape {self.shape} has no inverse")
        if self._field.degree == 1 and n >= GUESSED_INVERSE:
            guess = self._integral_inverse()
            if guess is not None:
                return guess
        if self._field.degree == 1 and n:
            try:
                numerators, den = (flint.fmpq_mat(self.parts[0]).inv() * self.den).numer_denom()
            except ZeroDivisionError:
                raise SingularError("the matrix is singular") from None
            return ExactMatrix(self._field, (numerators,), int(den))
        if self.rank() < n:
            raise SingularError("the matrix is singular")
        return self.solve(self._field.identity(n))

    def _integral_inverse(self) -> ExactMatrix | None:
        """The inverse if it is integral up to the denominator, as for unimodular matrices: guessed modulo a prime."""
        p = self._field.residue()[0]
        try:
            entries = flint.nmod_mat(self.parts[0], p).inv().entries()
        except ZeroDivisionError:
            return None
        half = p // 2
        lifted = [x - p if x > half else x for x in map(int, entries)]
        candidate = self._field.from_integers(lifted, *self.shape)
        if self.cleared() @ candidate != self._field.identity(self.nrows):
            return None
        return candidate if self.den == 1 else candidate.scale(self.den)

    def characteristic_coefficients(self) -> list[Scalar]:
        """The coefficients of det(t - A), ascending."""
        n = self.nrows
        if self._field.degree == 1:
            if n == 0:
                return [flint.fmpq(1)]
            integral = self.parts[0].charpoly().coeffs()
            return [flint.fmpq(c) / flint.fmpz(self.den) ** (n - i) for i, c in enumerate(integral)]
        # Faddeev-LeVerrier: only ring operations and divisions by 1, ..., n.
        coefficients, power = [self._field.one], self._field.identity(n)
        for k in range(1, n + 1):
            power = self @ power
            coefficients.append(-power.trace() / k)
            power = power + self._field.identity(n).scale(coefficients[-1])
        return coefficients[::-1]

    def determinant(self) -> Scalar:
        """The determinant."""
        constant = self.characteristic_coefficients()[0]
        return -constant if self.nrows % 2 else constant

    def signature(self) -> tuple[int, int, int]:
        if self != self.T:
            raise FieldError("a signature is asked of a matrix that is not symmetric")
        # All roots are real, so Descartes' rule of signs is exact.
        signs = [self._field.sign(c) for c in self.characteristic_coefficients()]
        zero = next(i for i, s in enumerate(signs) if s)
        positive = _sign_changes(signs)
        return positive, self.nrows - zero - positive, zero


def _common_factor(number: Any, matrix: Any) -> Any:
    """gcd(number, all entries of an integer matrix).

    It divides the gcd with the entries of one combination of rows, and nearly always is it; a quotient shows it.
    """
    nrows, ncols = matrix.nrows(), matrix.ncols()
    if nrows * ncols <= SMALL_MATRIX:
        return _gcd_of(number, matrix.entries())
    one_row = matrix * _weights(ncols).transpose() if nrows < ncols else _weights(nrows) * matrix
    bound = _gcd_of(number, one_row.entries())
    if bound == 1 or (flint.fmpq_mat(matrix) / bound).numer_denom()[1] == 1:
        return bound
    return _gcd_of(bound, matrix.entries())


def _gcd_of(number: Any, entries: Sequence[Any]) -> Any:
    for x in entries:
        number = number.gcd(x)
        if number == 1:
            break
    return number


@functools.cache
def _weights(n: int) -> Any:
    """A row of n fixed integers without pattern."""
    rng = random.Random(n)
    return flint.fmpz_mat(1, n, [rng.randint(1, 1 << 20) for _ in range(n)])


def _sign_changes(signs: Sequence[int]) -> int:
    kept = [s for s in signs if s]
    return sum(1 for a, b in itertools.pairwise(kept) if a != b)


def nmod_pivots(reduced: Any, rank: int) -> list[int]:
    """The pivot columns of a reduced echelon form modulo a prime (``flint.nmod_mat``)."""
    pivots, column = [], 0
    for i in range(rank):
        while int(reduced[i, column]) == 0:
            column += 1
        pivots.append(column)
        column += 1
    return pivots


def _pivots(reduced: ExactMatrix, rank: int, ncols: int) -> list[int]:
    pivots, column = [], 0
    for i in range(rank):
        while all(a[i, column] == 0 for a in reduced.parts):
            column += 1
        pivots.append(column)
        column += 1
    return pivots
