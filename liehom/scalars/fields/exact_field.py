"""ExactField: what QQ and the real number fields have in common.

Elements have coordinates over QQ in powers of an integral generator b (QQ is degree 1); matrices are made of
integer coefficient matrices over a common denominator.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable, Sequence
from math import lcm
from typing import Any

import flint

from liehom.errors import ShapeError
from liehom.scalars.fields.exact_matrix import ExactMatrix
from liehom.scalars.fields.field import Field, Scalar, rows_of


class ExactField(Field):
    """What QQ and the real number fields have in common: coordinates over QQ in powers of an integral generator."""

    __slots__ = ()

    @property
    def exact(self) -> bool:
        return True

    @property
    @abstractmethod
    def degree(self) -> int:
        """The degree over QQ."""

    @abstractmethod
    def coordinates(self, value: Scalar) -> list[Any]:
        """The coordinates (``flint.fmpq``) of an element in powers of the integral generator."""

    @abstractmethod
    def from_coordinates(self, coordinates: Sequence[Any]) -> Scalar:
        """The element with these coordinates."""

    @abstractmethod
    def power_coordinates(self, exponent: int) -> list[int]:
        """The integer coordinates of a power (degree <= exponent <= 2 degree - 2) of the integral generator."""

    @abstractmethod
    def modulus_coefficients(self) -> list[int]:
        """The ascending integer coefficients of the monic minimal polynomial of the integral generator."""

    @abstractmethod
    def residue(self, attempt: int = 0) -> tuple[int, int]:
        """A prime p and the image of the integral generator in F_p; other `attempt`, other prime."""

    def matrix(self, rows: Iterable[Iterable[Any]], shape: tuple[int, int] | None = None) -> ExactMatrix:
        table = [[self.convert(x) for x in row] for row in rows_of(rows)]
        nrows, ncols = shape if shape is not None else (len(table), len(table[0]) if table else 0)
        if len(table) != nrows or any(len(row) != ncols for row in table):
            lengths = sorted({len(row) for row in table})
            raise ShapeError(f"expected {nrows} rows of length {ncols}, got {len(table)} rows of lengths {lengths}")
        return self.from_entries([x for row in table for x in row], nrows, ncols)

    def from_entries(self, entries: Sequence[Scalar], nrows: int, ncols: int) -> ExactMatrix:
        """The matrix with these field elements, row after row."""
        if self.degree == 1:
            numerators, common = flint.fmpq_mat(nrows, ncols, list(entries)).numer_denom()
            return ExactMatrix(self, (numerators,), int(common))
        parts = list(zip(*map(self.coordinates, entries), strict=True)) or [()] * self.degree
        split = [flint.fmpq_mat(nrows, ncols, list(part)).numer_denom() for part in parts]
        den: int = lcm(*(int(d) for _, d in split))
        return ExactMatrix(self, tuple(a * (den // int(d)) for a, d in split), den)

    def from_integers(self, entries: Sequence[Any], nrows: int, ncols: int, den: int = 1) -> ExactMatrix:
        """The matrix with these integers over a common denominator, row after row."""
        first = flint.fmpz_mat(nrows, ncols, entries if isinstance(entries, list) else list(entries))
        rest = tuple(flint.fmpz_mat(nrows, ncols) for _ in range(self.degree - 1))
        return ExactMatrix(self, (first, *rest), den).normalized()

    def from_parts(self, parts: Sequence[Sequence[int]], nrows: int, ncols: int, den: int = 1) -> ExactMatrix:
        """The matrix with these integer coordinates (one list per power of the generator) over a denominator."""
        made = tuple(flint.fmpz_mat(nrows, ncols, p if isinstance(p, list) else list(p)) for p in parts)
        return ExactMatrix(self, made, den).normalized()

    def from_integer_coordinates(self, coordinates: Sequence[int], den: int = 1) -> Scalar:
        """The element with these integer coordinates over a denominator."""
        return self.from_coordinates([flint.fmpq(c, den) for c in coordinates])

    def zeros(self, nrows: int, ncols: int) -> ExactMatrix:
        return ExactMatrix(self, tuple(flint.fmpz_mat(nrows, ncols) for _ in range(self.degree)), 1)

    def identity(self, n: int) -> ExactMatrix:
        one = flint.fmpz_mat(n, n)
        for i in range(n):
            one[i, i] = 1
        return ExactMatrix(self, (one, *(flint.fmpz_mat(n, n) for _ in range(self.degree - 1))), 1)

    def stack_rows(self, blocks: Sequence[ExactMatrix], ncols: int) -> ExactMatrix:
        blocks = [b for b in blocks if b.nrows]
        if len(blocks) == 1:
            return blocks[0]
        den = lcm(*(b.den for b in blocks)) if blocks else 1
        nrows = sum(b.nrows for b in blocks)
        parts = []
        for s in range(self.degree):
            entries: list[Any] = []
            for b in blocks:
                entries += (b.parts[s] if b.den == den else b.parts[s] * (den // b.den)).entries()
            parts.append(flint.fmpz_mat(nrows, ncols, entries))
        return ExactMatrix(self, tuple(parts), den)
