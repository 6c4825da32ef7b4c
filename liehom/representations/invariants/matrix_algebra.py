"""MatrixAlgebra: an associative algebra of matrices with 1, given by a basis, with its centre and generators of it.

Coordinates in the span of k matrices are read from k entries that determine them.  Over QQ the basis is an LLL-reduced
basis of the integer matrices of the span, so that its first members are small.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import final

from liehom.errors import InternalError
from liehom.scalars import ExactField, ExactMatrix, Polynomial
from liehom.scalars.spaces.integral_basis import integral_basis
from liehom.typing import ScalarLike

MAX_PAIRS = 60
MAX_REDUCED = 40


@final
class MatrixAlgebra:
    """The span of matrices that is closed under products, with a reduced basis.

    Parameters
    ----------
    field : Field
        Exact.
    size : int
        N for matrices (N, N).
    matrices : sequence of Matrix
        They span the algebra and may be dependent. Closure under products is not checked.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> units = [QQ.unit(2, i).T @ QQ.unit(2, j) for i in range(2) for j in range(2)]
    >>> algebra = MatrixAlgebra(QQ, 2, units)
    >>> algebra.dimension, algebra.center().dimension
    (4, 1)
    """

    field: ExactField
    size: int

    __slots__ = ("_flat", "_inverse", "_places", "basis", "field", "size")

    def __init__(self, field: ExactField, size: int, matrices: Sequence[ExactMatrix]) -> None:
        self.field, self.size = field, size
        flat = field.stack_rows([m.reshape(1, size * size) for m in matrices], size * size)
        reducible = field.degree == 1 and len(matrices) <= MAX_REDUCED
        self._flat = integral_basis(flat) if reducible else flat.row_space()
        self.basis: tuple[ExactMatrix, ...] = tuple(self._flat.split_rows(size, size))
        self._places = self._flat.echelon()[1]
        self._inverse = self._flat.select(columns=self._places).inverse()

    @property
    def dimension(self) -> int:
        """Dimension of the algebra, an int."""
        return len(self.basis)

    def coordinates(self, matrices: Sequence[ExactMatrix]) -> ExactMatrix:
        """The matrix (k, dimension) of coefficients of k elements in the basis."""
        n = self.size
        flat = self.field.stack_rows([m.reshape(1, n * n) for m in matrices], n * n)
        return flat.select(columns=self._places) @ self._inverse

    def element(self, coefficients: Sequence[ScalarLike]) -> ExactMatrix:
        """The element with these coefficients in the basis."""
        row = self.field.matrix([coefficients], (1, self.dimension))
        return (row @ self._flat).reshape(self.size, self.size)

    def multiplication(self, element: ExactMatrix) -> ExactMatrix:
        """The matrix (k, k) of x -> element x in the basis, acting on columns."""
        return self.coordinates([element @ t for t in self.basis]).T

    def center(self) -> MatrixAlgebra:
        """The centre: the elements that commute with a few random elements, verified against the basis."""
        k = self.dimension
        rng = random.Random(k)
        tests = [self.element([rng.randint(-3, 3) for _ in range(k)]) for _ in range(2)]
        for _ in range(k + 2):
            blocks = [self.coordinates([t @ s - s @ t for t in self.basis]) for s in tests]
            rows = self.field.stack_columns(blocks, k).left_null_space()
            found = (rows @ self._flat).split_rows(self.size, self.size)
            failing = next((t for t in self.basis for z in found if not (t @ z - z @ t).is_zero()), None)
            if failing is None:
                return MatrixAlgebra(self.field, self.size, found)
            tests.append(failing)
        raise InternalError("the centre of a matrix algebra was not found")

    def elements(self) -> Iterator[ExactMatrix]:
        """Candidate elements, without end: the basis, sums and differences of two, then random combinations."""
        yield from self.basis
        for s, t in list(combinations(self.basis, 2))[:MAX_PAIRS]:
            yield s + t
            yield s - t
        rng, bound = random.Random(self.dimension), 1
        while True:
            yield self.element([rng.randint(-bound, bound) for _ in self.basis])
            bound += 1

    def minimal_polynomial_power(self, element: ExactMatrix) -> Polynomial:
        """A characteristic polynomial, with the irreducible factors of the minimal polynomial of an element."""
        matrix = self.multiplication(element) if self.dimension < self.size else element
        return Polynomial(self.field, matrix.characteristic_coefficients())

    def generator(self) -> tuple[ExactMatrix, Polynomial]:
        """A generator of a commutative algebra without nilpotent elements, and its squarefree minimal polynomial."""
        for tried, element in enumerate(self.elements()):
            polynomial = Polynomial(self.field, self.multiplication(element).characteristic_coefficients())
            if polynomial.gcd(polynomial.derivative()).degree == 0:
                return element, polynomial
            if tried > 2 * MAX_PAIRS + self.dimension + 40:
                break
        raise InternalError("a commutative algebra without nilpotents has no generator")
