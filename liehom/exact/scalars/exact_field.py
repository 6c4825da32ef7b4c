"""ExactField and ExactMatrix: the linear algebra that QQ and the real number fields share, on python-flint.

A number of QQ(b), b an algebraic integer of degree m, has m coordinates over QQ in the powers of b; QQ is the case
m = 1. A matrix is A = (A_0 + A_1 b + ... + A_{m-1} b^(m-1)) / den with integer matrices A_s. Products are
convolutions. Echelon forms are taken over QQ after restriction of scalars (each entry becomes the m x m matrix of
multiplication by it), where flint finds pivots modulo primes and verifies the lifted result exactly.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from math import gcd, lcm
from typing import Any, final

import flint
import numpy as np
import numpy.typing as npt

from liehom.base.errors import FieldError, ShapeError, SingularError, UndecidedError
from liehom.base.objects import Immutable
from liehom.base.typing import ScalarLike
from liehom.exact.scalars.field import Field, Matrix, MatrixLike, Scalar, rows_of
from liehom.exact.scalars.integer_matrices import (
    cancelled,
    characteristic_coefficients,
    echelon_pivots,
    integer_identity,
    interleaved,
    kernel_rows,
    lifted_inverse,
    over_common_denominator,
    selecting,
    separated,
    sign_changes,
    stacked_rows,
    zero_matrix,
)

LARGEST_PRODUCT = 200  # rows or columns up to which a product selects entries faster than a list of them
MIN_GUESSED_SIZE = 40  # from which an integral inverse is guessed modulo a prime
_set = object.__setattr__


class ExactField(Field["ExactMatrix"]):
    """An exact field, QQ or a real number field: elements have coordinates in powers of an integral generator."""

    __slots__ = ()

    @property
    def exact(self) -> bool:
        return True

    @property
    @abstractmethod
    def degree(self) -> int:
        """Degree over QQ."""

    @abstractmethod
    def coordinates(self, value: Scalar) -> list[flint.fmpq]:
        """The coordinates (``flint.fmpq``) of an element in powers of the integral generator."""

    @abstractmethod
    def from_coordinates(self, coordinates: Sequence[flint.fmpq]) -> Scalar:
        """The element with these coordinates."""

    @abstractmethod
    def power_coordinates(self, exponent: int) -> list[int]:
        """The integer coordinates of a power (degree <= exponent <= 2 degree - 2) of the integral generator."""

    @abstractmethod
    def modulus_coefficients(self) -> list[int]:
        """The ascending integer coefficients of the monic minimal polynomial of the integral generator."""

    @abstractmethod
    def residue(self, attempt: int = 0) -> tuple[int, int]:
        """Prime p number `attempt`, and the image of the integral generator in F_p."""

    def matrix(self, rows: MatrixLike, shape: tuple[int, int] | None = None) -> ExactMatrix:
        table = [[self.convert(x) for x in row] for row in rows_of(rows)]
        nrows, ncols = shape if shape is not None else (len(table), len(table[0]) if table else 0)
        if len(table) != nrows or any(len(row) != ncols for row in table):
            lengths = sorted({len(row) for row in table})
            raise ShapeError(f"expected {nrows} rows of length {ncols}, got {len(table)} rows of lengths {lengths}")
        return self.from_entries([x for row in table for x in row], nrows, ncols)

    def from_entries(self, entries: Sequence[Scalar], nrows: int, ncols: int) -> ExactMatrix:
        """The matrix of shape (nrows, ncols) with these field elements, row after row."""
        columns = [entries] if self.degree == 1 else list(zip(*map(self.coordinates, entries), strict=True))
        parts = [flint.fmpq_mat(nrows, ncols, list[Any](x)) for x in columns or [()] * self.degree]
        return ExactMatrix(self, *over_common_denominator(parts))

    def from_integers(self, entries: Sequence[int | flint.fmpz], nrows: int, ncols: int, den: int = 1) -> ExactMatrix:
        """The matrix of shape (nrows, ncols) with these integers, row after row, over a common denominator."""
        first = flint.fmpz_mat(nrows, ncols, entries if isinstance(entries, list) else list(entries))
        zeros = (flint.fmpz_mat(nrows, ncols) for _ in range(1, self.degree))
        return ExactMatrix(self, (first, *zeros), den).normalized()

    def from_parts(
        self, parts: Sequence[Sequence[int | flint.fmpz]], nrows: int, ncols: int, den: int = 1
    ) -> ExactMatrix:
        """The matrix with these integer coordinates, one list per power of the generator, over a common denominator."""
        made = (flint.fmpz_mat(nrows, ncols, p if isinstance(p, list) else list(p)) for p in parts)
        return ExactMatrix(self, tuple(made), den).normalized()

    def from_integer_coordinates(self, coordinates: Sequence[int], den: int = 1) -> Scalar:
        """The element with these integer coordinates over a denominator."""
        return self.from_coordinates([flint.fmpq(c, den) for c in coordinates])

    def zeros(self, nrows: int, ncols: int) -> ExactMatrix:
        return ExactMatrix(self, tuple(zero_matrix(nrows, ncols) for _ in range(self.degree)), 1)

    def identity(self, n: int) -> ExactMatrix:
        return ExactMatrix(self, (integer_identity(n), *(flint.fmpz_mat(n, n) for _ in range(self.degree - 1))), 1)

    def stack_rows(self, blocks: Sequence[ExactMatrix], ncols: int) -> ExactMatrix:
        blocks = [b for b in blocks if b.nrows]
        if len(blocks) == 1:
            return blocks[0]
        den = lcm(*(b.den for b in blocks)) if blocks else 1
        scaled = [b.parts if b.den == den else [a * (den // b.den) for a in b.parts] for b in blocks]
        return ExactMatrix(self, tuple(stacked_rows([b[s] for b in scaled], ncols) for s in range(self.degree)), den)


@final
class ExactMatrix(Matrix, Immutable):
    """A matrix over an exact field; made by ``field.matrix(rows)``.

    Examples
    --------
    >>> from liehom.exact.scalars import QQ
    >>> A = QQ.matrix([["1/2", 1], [0, 3]])
    >>> A @ A.inverse() == QQ.identity(2)
    True
    """

    __slots__ = ("_field", "den", "parts")

    _field: ExactField
    parts: tuple[flint.fmpz_mat, ...]
    den: int

    def __init__(self, field: ExactField, parts: tuple[flint.fmpz_mat, ...], den: int) -> None:
        _set(self, "_field", field)  # object's own method: matrices are made in inner loops
        _set(self, "parts", parts)
        _set(self, "den", den)

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
            whole = flint.fmpq_mat(first) / self.den if self.den != 1 else flint.fmpq_mat(first)
            return list(whole.entries())
        columns = zip(*(a.entries() for a in self.parts), strict=True)
        return [self._field.from_coordinates([flint.fmpq(c, self.den) for c in x]) for x in columns]

    def to_rows(self) -> list[list[Scalar]]:
        n, entries = self.ncols, self.entries()
        return [entries[i * n : (i + 1) * n] for i in range(self.nrows)]

    def to_numpy(self) -> npt.NDArray[np.float64]:
        values = [self._field.to_float(x) for x in self.entries()]
        return np.array(values, dtype=np.float64).reshape(self.shape)

    def select(self, rows: Sequence[int] | None = None, columns: Sequence[int] | None = None) -> ExactMatrix:
        (nrows, ncols), parts = self.shape, self.parts
        few = rows is not None and columns is not None and 8 * len(rows) * len(columns) < nrows * ncols
        if max(self.shape) <= LARGEST_PRODUCT and not few:
            parts = parts if rows is None else tuple(selecting(rows, nrows) * a for a in parts)
            parts = parts if columns is None else tuple(a * selecting(columns, ncols).transpose() for a in parts)
            return ExactMatrix(self._field, parts, self.den).normalized()
        rows, columns = range(nrows) if rows is None else rows, range(ncols) if columns is None else columns
        if few:
            entries = [[a[i, j] for i in rows for j in columns] for a in parts]
        else:
            entries = [[t[i * ncols + j] for i in rows for j in columns] for t in (a.entries() for a in parts)]
        return self._field.from_parts(entries, len(rows), len(columns), self.den)

    def reshape(self, nrows: int, ncols: int) -> ExactMatrix:
        parts = tuple(flint.fmpz_mat(nrows, ncols, a.entries()) for a in self.parts)
        return ExactMatrix(self._field, parts, self.den)

    def split_rows(self, nrows: int, ncols: int) -> list[ExactMatrix]:
        size = nrows * ncols
        tables = [a.entries() for a in self.parts]
        cuts = [slice(i * size, (i + 1) * size) for i in range(self.nrows)]
        parts = (tuple(flint.fmpz_mat(nrows, ncols, t[cut]) for t in tables) for cut in cuts)
        return [ExactMatrix(self._field, part, self.den) for part in parts]

    def normalized(self) -> ExactMatrix:
        """The matrix with its common denominator made as small as possible."""
        parts, den = cancelled(self.parts, self.den)
        return self if den == self.den else ExactMatrix(self._field, parts, den)

    def cleared(self) -> ExactMatrix:
        """The matrix times its common denominator."""
        return self if self.den == 1 else ExactMatrix(self._field, self.parts, 1)

    def primitive(self) -> ExactMatrix:
        """The positive multiple whose integer coordinates have no common factor; zero stays zero."""
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
        if self.den == other.den:
            return self.parts == other.parts
        return all(a * other.den == b * self.den for a, b in zip(self.parts, other.parts, strict=True))

    def __hash__(self) -> int:
        parts, den = cancelled(self.parts, self.den)
        return hash((self._field, self.shape, int(den), tuple(x for a in parts for x in a.entries())))

    def __repr__(self) -> str:
        return f"<matrix {self.nrows} x {self.ncols} over {self._field.name}>"

    def __str__(self) -> str:
        return "\n".join("[" + ", ".join(map(self._field.show, row)) + "]" for row in self.to_rows())

    # -- arithmetic --------------------------------------------------------------------------------------
    @property
    def T(self) -> ExactMatrix:
        return ExactMatrix(self._field, tuple(a.transpose() for a in self.parts), self.den)

    def _combined(self, other: ExactMatrix, sign: int) -> ExactMatrix:
        if self._field is not other._field:
            self._require_field(other)
        den, left, right = self.den, 1, sign
        if den != other.den:
            den = lcm(den, other.den)
            left, right = den // self.den, sign * (den // other.den)
        pairs = zip(self.parts, other.parts, strict=True)
        try:
            if left == 1 and abs(right) == 1:
                return ExactMatrix(self._field, tuple(a + b if right == 1 else a - b for a, b in pairs), den)
            return ExactMatrix(self._field, tuple(a * left + b * right for a, b in pairs), den)
        except ValueError:
            raise ShapeError(f"matrices of shapes {self.shape} and {other.shape} do not add") from None

    def __add__(self, other: ExactMatrix) -> ExactMatrix:
        return self._combined(other, 1) if isinstance(other, ExactMatrix) else self.__radd__(other)

    def __sub__(self, other: ExactMatrix) -> ExactMatrix:
        return self._combined(other, -1) if isinstance(other, ExactMatrix) else self.__radd__(other)

    def __neg__(self) -> ExactMatrix:
        return ExactMatrix(self._field, tuple(-a for a in self.parts), self.den)

    def _require_field(self, other: ExactMatrix) -> None:
        if self._field != other._field:
            raise FieldError(f"matrices over {self._field.name} and {other._field.name}; convert one by field.read()")

    def __matmul__(self, other: ExactMatrix) -> ExactMatrix:
        if not isinstance(other, ExactMatrix):
            return NotImplemented
        if self._field is not other._field:
            self._require_field(other)
        if self.ncols != other.nrows:
            raise ShapeError(f"matrices of shapes {self.shape} and {other.shape} do not multiply")
        den = self.den * other.den
        if self._field.degree == 1:
            return ExactMatrix(self._field, (self.parts[0] * other.parts[0],), den).normalized()
        return ExactMatrix(self._field, self._convolved(other.parts), den).normalized()

    def _convolved(self, factors: Sequence[Any]) -> tuple[flint.fmpz_mat, ...]:
        """Parts of the product with an element or a matrix that has the given integer coordinates."""
        powers: list[Any] = [None] * (2 * self._field.degree - 1)
        for s, a in enumerate(self.parts):
            for t, b in enumerate(factors):
                powers[s + t] = a * b if powers[s + t] is None else powers[s + t] + a * b
        return self._reduced(powers)

    def _reduced(self, powers: list[flint.fmpz_mat]) -> tuple[flint.fmpz_mat, ...]:
        """Coefficient matrices of b^0 .. b^(m-1), from those of b^0 .. b^(2m-2)."""
        m = self._field.degree
        parts = powers[:m]
        for r in range(m, len(powers)):
            for s, c in enumerate(self._field.power_coordinates(r)):
                if c:
                    parts[s] = parts[s] + powers[r] * c
        return tuple(parts)

    def scale(self, factor: ScalarLike) -> ExactMatrix:
        coordinates = self._field.coordinates(self._field.convert(factor))
        den = lcm(*(int(c.q) for c in coordinates))
        integers = [int(c.p) * (den // int(c.q)) for c in coordinates]
        return ExactMatrix(self._field, self._convolved(integers), self.den * den).normalized()

    def is_zero(self) -> bool:
        return all(a.is_zero() for a in self.parts)

    def trace(self) -> Scalar:
        total = [sum((a[i, i] for i in range(self.nrows)), flint.fmpz(0)) for a in self.parts]
        return self._field.from_coordinates([flint.fmpq(x, self.den) for x in total])

    # -- linear algebra ----------------------------------------------------------------------------------
    def modulo(self, attempt: int = 0) -> flint.nmod_mat:
        """The numerators modulo a prime (``flint.nmod_mat``), a matrix of at most the true rank."""
        p, root = self._field.residue(attempt)
        image = flint.nmod_mat(self.parts[0], p)
        power = 1
        for a in self.parts[1:]:
            power = power * root % p
            image += flint.nmod_mat(a, p) * power
        return image

    def _restricted(self) -> flint.fmpz_mat:
        """The integer matrix (degree * nrows, degree * ncols) of the numerators over QQ."""
        multiples = [self.parts]  # by the powers of the generator
        for _ in range(1, self._field.degree):
            multiples.append(self._reduced([flint.fmpz_mat(*self.shape), *multiples[-1]]))
        return interleaved(multiples)

    def rank(self) -> int:
        if 0 in self.shape:
            return 0
        lower = int(self.modulo().rank())
        return lower if lower == min(self.shape) else int(self._restricted().rank()) // self._field.degree

    def echelon(self) -> tuple[ExactMatrix, list[int]]:
        """The non-zero rows of the reduced row echelon form, and the list of pivot columns."""
        m, ncols = self._field.degree, self.ncols
        if 0 in self.shape:
            return self._field.zeros(0, ncols), []
        if self.nrows >= ncols and int(self.modulo().rank()) == ncols:
            return self._field.identity(ncols), list(range(ncols))  # independent modulo a prime, so independent
        reduced, den, full_rank = self._restricted().rref()  # cannot be interrupted
        parts = separated(reduced, m, rank := int(full_rank) // m)
        sign = -1 if den < 0 else 1
        matrix = ExactMatrix(self._field, tuple(a * sign for a in parts), int(den) * sign).normalized()
        return matrix, echelon_pivots(matrix.parts, rank)

    def row_space(self, question: str = "") -> ExactMatrix:
        return self.echelon()[0]

    def null_space(self, question: str = "") -> ExactMatrix:
        reduced, pivots = self.echelon()
        parts = tuple(kernel_rows(a, pivots, 0 if s else reduced.den) for s, a in enumerate(reduced.parts))
        return ExactMatrix(self._field, parts, reduced.den).normalized()

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
        return self._field.matrix(placed, (len(pivots), n)).T @ solution

    def inverse(self) -> ExactMatrix:
        n = self.nrows
        if n != self.ncols:
            raise ShapeError(f"a matrix of shape {self.shape} has no inverse")
        if self._field.degree == 1 and n >= MIN_GUESSED_SIZE:
            guess = self._integral_inverse()
            if guess is not None:
                return guess
        if self.rank() < n:
            raise SingularError("the matrix is singular")
        if self._field.degree > 1 or not n:
            return self.solve(self._field.identity(n))
        numerators, den = (flint.fmpq_mat(self.parts[0]).inv() * self.den).numer_denom()
        return ExactMatrix(self._field, (numerators,), int(den))

    def _integral_inverse(self) -> ExactMatrix | None:
        """The inverse, guessed modulo a prime and verified, or None; it succeeds for unimodular numerators."""
        guess = lifted_inverse(self.parts[0], self._field.residue()[0])
        if guess is None:
            return None
        candidate = ExactMatrix(self._field, (guess,), 1)
        if self.cleared() @ candidate != self._field.identity(self.nrows):
            return None
        return candidate if self.den == 1 else candidate.scale(self.den)

    def characteristic_coefficients(self) -> list[Scalar]:
        """List of the coefficients of det(t - A), in ascending order."""
        n = self.nrows
        if self._field.degree == 1:
            if n == 0:
                return [flint.fmpq(1)]
            integral = characteristic_coefficients(self.parts[0])
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
            raise FieldError("only a symmetric matrix has a signature; this matrix is not symmetric")
        # All roots are real, so Descartes' rule of signs is exact.
        signs = [self._field.sign(c) for c in self.characteristic_coefficients()]
        zero = next(i for i, s in enumerate(signs) if s)
        positive = sign_changes(signs)
        return positive, self.nrows - zero - positive, zero


def as_exact(matrix: Matrix) -> ExactMatrix:
    """The given matrix, typed as an `ExactMatrix`; `UndecidedError` over float64.

    Examples
    --------
    >>> from liehom.exact.scalars import QQ
    >>> as_exact(QQ.matrix([[1, 2]])).shape
    (1, 2)
    """
    if not isinstance(matrix, ExactMatrix):
        raise UndecidedError(f"rounding decides this over {matrix.field.name}; make the object exact by lh.rationalize")
    return matrix
