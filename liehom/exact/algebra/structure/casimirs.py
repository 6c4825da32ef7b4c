"""The index of a Lie algebra, and polynomial invariants of its coadjoint action (generalized Casimir operators)."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass
from typing import final

from liehom.base.errors import InputError, UndecidedError
from liehom.base.typing import Expression
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.linear.linear_bases import require_size
from liehom.exact.algebra.structure.centroid import exact_field
from liehom.exact.scalars.exact_field import as_exact
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.polynomial_matrix import (
    IntegerTerms,
    PolynomialMatrix,
    expression_of_terms,
    independent,
    invariant_polynomials,
)

# The functions on the dual of g are the commutative polynomials in a basis of g, on which ad x acts as a derivation.
# The matrix ([e_i, e_j]) of linear forms has a rank r that is generic; there are dim g - r functionally independent
# invariants, local ones in general (Beltrametti and Blasi, Phys. Lett. 20 (1966), 62-64).

LARGE = 1 << 20  # bound on the coordinates of a random point
LARGEST = 14  # dimension up to which the generic rank is proved by vectors of polynomials that the matrix annihilates


@final
@dataclass(frozen=True, slots=True)
class Casimirs:
    """Functionally independent polynomial invariants of the coadjoint action, the result of `LieAlgebra.casimirs`.

    Attributes
    ----------
    polynomials : tuple of sympy expression
        Homogeneous polynomials with integer coefficients in the names of the basis, by degree. In the enveloping
        algebra they become central elements when each monomial is replaced by the mean of its products in all orders.
    degrees : tuple of int
        Their degrees.
    number : int
        How many functionally independent invariants there are, the index of the algebra.

    Examples
    --------
    >>> import liehom as lh
    >>> casimirs = lh.so(3).casimirs(2)
    >>> casimirs.polynomials, casimirs.is_complete
    ((e0**2 + e1**2 + e2**2,), True)
    """

    polynomials: tuple[Expression, ...]
    degrees: tuple[int, ...]
    number: int

    @property
    def is_complete(self) -> bool:
        """Whether every invariant is a function of these; if not, other ones have a higher degree or no polynomials."""
        return len(self.polynomials) == self.number

    def __iter__(self) -> Iterator[Expression]:
        return iter(self.polynomials)

    def __len__(self) -> int:
        return len(self.polynomials)


def index(algebra: LieAlgebra) -> int:
    """Implements `LieAlgebra.index`."""
    # the rank at a point is at most the generic one, which is even
    bound = _corank(algebra)
    if bound <= 1 or _is_proved(algebra, bound):
        return bound
    if algebra.is_reductive():
        return algebra.rank()  # the centralizers of generic elements are the Cartan subalgebras
    raise UndecidedError(
        f"{algebra!r} has at most {bound} functionally independent invariants, the corank at a random point, but that "
        f"no point has a larger rank is proved over QQ to dimension {LARGEST} only, or if casimirs() finds as many"
    )


def casimirs(algebra: LieAlgebra, max_degree: int) -> Casimirs:
    """Implements `LieAlgebra.casimirs`."""
    require_size("max_degree", max_degree, 1)
    if exact_field(algebra, "Casimir operators").degree > 1:
        raise InputError(f"Casimir operators are computed over QQ, and the algebra is over {algebra.field.name}")
    n, bound = algebra.dimension, _corank(algebra)
    actions = [as_exact(algebra.ad(x)).T for x in _generators(algebra)]
    found: list[IntegerTerms] = []
    for degree in range(1, max_degree + 1):
        if len(found) == bound:
            break
        candidates = [*found, *invariant_polynomials(actions, n, degree)]
        found = [candidates[i] for i in independent(candidates, n)]
    # as many independent invariants as the corank at one point: the corank is the generic one
    number = bound if len(found) == bound else index(algebra)
    shown = tuple(expression_of_terms(terms, algebra.basis_names) for terms in found)
    return Casimirs(shown, tuple(len(next(iter(terms))) for terms in found), number)


def _corank(algebra: LieAlgebra) -> int:
    """The dimension of g minus the rank of ([e_i, e_j]) at a random point of the dual."""
    n, field = algebra.dimension, exact_field(algebra, "the index")
    rng = random.Random(n)
    point = field.from_integers([rng.randint(-LARGE, LARGE) for _ in range(n)], n, 1)
    one = field.identity(n)
    return n - (as_exact(field.stack_columns(algebra.table.contract(one, one, point), n)).rank() if n else 0)


def _is_proved(algebra: LieAlgebra, corank: int) -> bool:
    """Whether as many vectors of polynomials as the corank are annihilated by the matrix ([e_i, e_j])."""
    n = algebra.dimension
    if n > LARGEST or exact_field(algebra, "the index").degree > 1:
        return False
    table: list[list[dict[tuple[int, ...], Scalar]]] = [[{} for _ in range(n)] for _ in range(n)]
    for i, j, k, v in algebra.structure_constants():
        exponents = tuple(int(x == k) for x in range(n))
        table[i][j][exponents], table[j][i][exponents] = v, -v
    return len(PolynomialMatrix(n, table, (n, n)).null_space[0]) == corank


def _generators(algebra: LieAlgebra) -> list[list[int]]:
    """The first basis elements that generate the algebra, as rows."""
    n, chosen, closed = algebra.dimension, list[list[int]](), None
    for i in range(n):
        unit = [int(i == j) for j in range(n)]
        if closed is None or unit not in closed:
            chosen.append(unit)
            closed = algebra.subalgebra_generated_by(chosen)
            if closed.dimension == n:
                break
    return chosen
