"""LinearForms: matrices of linear forms in several variables, their minors, and proofs about their rank.

M(x) = x_0 M_0 + ... + x_{m-1} M_{m-1} over QQ or a real number field, whose generator is one more variable modulo its
minimal polynomial. Minors are computed without division, by expansion along columns, one subset of rows after another.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

import flint

from liehom.errors import FieldError, ShapeError
from liehom.scalars.fields.exact_field import ExactField, ExactMatrix
from liehom.scalars.fields.rational import QQ
from liehom.scalars.spaces.minors import expanded_minors
from liehom.typing import ScalarLike


@final
class LinearForms:
    """A matrix of linear forms M(x) = sum_i x_i M_i.

    Parameters
    ----------
    parts : sequence of ExactMatrix
        The M_i, at least one, all of one shape and over one field.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> M = LinearForms([QQ.matrix([[1, 0], [0, 1]]), QQ.matrix([[0, 1], [-1, 0]])])
    >>> print(M.minor([0, 1], [0, 1]))
    x0^2 + x1^2
    """

    __slots__ = ("_context", "_modulus", "_table", "field", "parts", "shape")

    def __init__(self, parts: Sequence[ExactMatrix]) -> None:
        if not parts or any(part.shape != parts[0].shape for part in parts):
            raise ShapeError("a matrix of linear forms needs matrices of one shape, at least one")
        self.parts: tuple[ExactMatrix, ...] = tuple(parts)
        self.field: ExactField = parts[0].field
        self.shape: tuple[int, int] = parts[0].shape
        names = [f"x{i}" for i in range(len(parts))]
        if self.field.degree > 1:
            names.append("b")
        self._context = flint.fmpq_mpoly_ctx.get(names, "degrevlex")
        generators = self._context.gens()
        self._modulus: flint.fmpq_mpoly | None = None
        if self.field.degree > 1:
            coefficients = self.field.modulus_coefficients()
            self._modulus = sum((generators[-1] ** k * int(c) for k, c in enumerate(coefficients)), 0 * generators[0])
        self._table = self._forms(generators)

    def _forms(self, generators: Sequence[flint.fmpq_mpoly]) -> list[list[flint.fmpq_mpoly]]:
        nrows, ncols = self.shape
        zero = 0 * generators[0]
        table = [[zero] * ncols for _ in range(nrows)]
        for x, part in zip(generators, self.parts, strict=False):
            for s, numerators in enumerate(part.parts):
                unit = x * generators[-1] ** s if s else x
                for place, v in enumerate(numerators.entries()):
                    if v:
                        i, j = divmod(place, ncols)
                        table[i][j] = table[i][j] + unit * flint.fmpq(v, part.den)
        return table

    @property
    def variables(self) -> int:
        """Number of variables x0, x1, ..., an int."""
        return len(self.parts)

    def at(self, values: Sequence[ScalarLike]) -> ExactMatrix:
        """The matrix M(x) for field elements x, an `ExactMatrix`."""
        total = self.field.zeros(*self.shape)
        for value, part in zip(values, self.parts, strict=True):
            total = total + part.scale(value)
        return total

    def times(self, right: ExactMatrix) -> LinearForms:
        """The `LinearForms` M(x) T for a constant matrix T."""
        return LinearForms([part @ right for part in self.parts])

    # -- minors ------------------------------------------------------------------------------------------
    def minor(self, rows: Sequence[int], columns: Sequence[int]) -> flint.fmpq_mpoly:
        """Determinant of the given rows and columns, a ``flint.fmpq_mpoly``; over QQ(b) in the variable b too."""
        return self._expanded(list(rows), list(columns)).get(tuple(rows), 0 * self._context.gens()[0])

    def _expanded(self, rows: list[int], columns: list[int]) -> dict[tuple[int, ...], flint.fmpq_mpoly]:
        """The non-zero minors with these columns, by their rows."""
        one = 0 * self._context.gens()[0] + 1
        return expanded_minors(self._table, rows, columns, one, None if self._modulus is None else self._reduced)

    def _reduced(self, polynomial: flint.fmpq_mpoly) -> flint.fmpq_mpoly:
        return polynomial if self._modulus is None else divmod(polynomial, self._modulus)[1]

    # -- proofs ------------------------------------------------------------------------------------------
    def invariant_factors(
        self, first: flint.fmpq_mpoly, second: flint.fmpq_mpoly, fields: Sequence[ExactMatrix]
    ) -> list[flint.fmpq_mpoly]:
        """The irreducible common factors p of two polynomials with grad p . A x a multiple of p for all A.

        Parameters
        ----------
        first, second : polynomials from `minor`
        fields : sequence of ExactMatrix
            Matrices A (m, m): linear vector fields x -> A x.

        Raises
        ------
        FieldError
            Over a number field, where polynomials in several variables cannot be factored.
        """
        if self._modulus is not None:
            raise FieldError(f"polynomials in several variables are factored over QQ only, not over {self.field.name}")
        common = first.gcd(second)
        if common.is_constant():
            return []
        flows = [self._flow(a) for a in fields]
        return [p for p, _ in common.factor()[1] if all(self._is_semi_invariant(p, flow) for flow in flows)]

    def _flow(self, matrix: ExactMatrix) -> list[flint.fmpq_mpoly]:
        generators = self._context.gens()
        zero = 0 * generators[0]
        return [
            sum((x * QQ.convert(c) for x, c in zip(generators, row, strict=True) if c != 0), zero)
            for row in matrix.to_rows()
        ]

    def _is_semi_invariant(self, polynomial: flint.fmpq_mpoly, flow: list[flint.fmpq_mpoly]) -> bool:
        total = 0 * polynomial
        for i, component in enumerate(flow):
            total = total + polynomial.derivative(i) * component
        return bool(divmod(total, polynomial)[1].is_zero())
