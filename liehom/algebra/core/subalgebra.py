"""Subalgebra: a subspace of a Lie algebra that is closed under the bracket; and the standard ones.

Closure is proved at construction.  The basis is kept as given; `subspace` is canonical.
"""

from __future__ import annotations

import random
from typing import Any, final

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.errors import DependentRowsError, InputError, NotAnIdealError, NotASubalgebraError, ShapeError, shown
from liehom.scalars import Scalar, Subspace
from liehom.scalars.fields.field import rows_of
from liehom.scalars.spaces.quotient import Quotient, echelon_quotient, quotient

SAMPLES = 3


@final
class Subalgebra:
    """A subalgebra h of g, given by the rows of a basis.

    Parameters
    ----------
    algebra : LieAlgebra
        The algebra g around.
    rows : sequence of rows, or a matrix
        Coefficients in the basis of g, shape (k, n), independent. No rows: the zero subalgebra.
    check : bool, optional
        Prove closure (default). False is for callers that have proved it.

    Raises
    ------
    DependentRowsError, NotASubalgebraError, ShapeError

    Examples
    --------
    >>> import liehom as lh
    >>> h = lh.so(3).subalgebra([[0, 0, 1]])
    >>> h.dimension, [0, 0, 5] in h, h.is_ideal()
    (1, True, False)
    >>> print(h)
    subalgebra of dimension 1 in so(3) over QQ
      (0, 0, 1)
    """

    __slots__ = ("_quotient", "_subspace", "algebra", "basis")

    def __init__(self, algebra: LieAlgebra, rows: Any, *, check: bool = True) -> None:
        self.algebra = algebra
        self.basis = _matrix(algebra, rows)
        self._subspace: Subspace | None = None
        self._quotient: Quotient | None = None
        if self.basis.ncols != algebra.dimension:
            raise ShapeError(f"rows of length {self.basis.ncols} in an algebra of dimension {algebra.dimension}")
        if check:
            self._prove()

    def _prove(self) -> None:
        rank = self.basis.rank()
        if rank < self.basis.nrows:
            raise DependentRowsError(rank, _dependent(self.basis), "rows of the subalgebra")
        failure = self.algebra.table.first_nonzero(self.basis, self.basis, self._projection())
        if failure is not None:
            a, b = failure
            bracket = self.algebra.bracket(self.basis.row(a), self.basis.row(b))
            values = ", ".join(shown(self.algebra.field.format(x)) for x in bracket)
            raise NotASubalgebraError((a, b), f"({values})")

    # -- properties --------------------------------------------------------------------------------------
    @property
    def dimension(self) -> int:
        """The dimension."""
        return int(self.basis.nrows)

    @property
    def codimension(self) -> int:
        """dim g - dim h."""
        return self.algebra.dimension - self.dimension

    @property
    def subspace(self) -> Subspace:
        """The subspace of g with its canonical basis."""
        if self._subspace is None:
            self._subspace = Subspace(self.algebra.field, self.basis, self.algebra.dimension)
        return self._subspace

    def quotient(self) -> Quotient:
        """Coordinates on g/h (cached): a basis of h, a complement, and the projection, with small numbers."""
        if self._quotient is None:
            self._quotient = quotient(self.basis)
        return self._quotient

    def _projection(self) -> Any:
        """Some matrix (n, d) of rank d that kills h: for questions that are asked once."""
        if self._quotient is not None or not self.algebra.field.exact:
            return self.quotient().projection
        return echelon_quotient(self.basis).projection

    def rows(self) -> list[list[Scalar]]:
        """The basis as lists of field elements."""
        return self.basis.to_rows()  # type: ignore[no-any-return]

    def __contains__(self, x: Any) -> bool:
        return bool((self.algebra.row(x) @ self._projection()).is_zero())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Subalgebra) and self.algebra == other.algebra and self.subspace == other.subspace

    __hash__ = None  # type: ignore[assignment]

    # -- verbs -------------------------------------------------------------------------------------------
    def intersection(self, other: Subalgebra) -> Subalgebra:
        """The intersection with another subalgebra of the same algebra.

        Examples
        --------
        >>> import liehom as lh
        >>> g = lh.gl(2)
        >>> g.center().intersection(g.derived_series()[1]).dimension
        0
        """
        require_inside(self.algebra, other)
        # What lies in two closed subspaces is closed.
        return Subalgebra(self.algebra, self.subspace.intersection(other.subspace).basis, check=False)

    def includes(self, other: Subalgebra) -> bool:
        """Whether another subalgebra of the same algebra lies in this one."""
        require_inside(self.algebra, other)
        return self.subspace.includes(other.subspace)

    def as_algebra(self, name: str | None = None) -> LieAlgebra:
        """The subalgebra as a Lie algebra in its own basis.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.gl(2).subalgebra([[0, 1, 0, 0], [1, 0, 0, -1]]).as_algebra().dimension
        2
        """
        k = self.dimension
        whole = self.algebra.field.identity(self.algebra.dimension)
        blocks = []
        for block in self.algebra.table.contract(self.basis, self.basis, whole):
            blocks.append(self.basis.T.solve(block.T).T)
        # A closed subspace of a Lie algebra: the axioms hold.
        return LieAlgebra(StructureConstants.from_blocks(self.algebra.field, k, blocks), name=name, check=False)

    def is_ideal(self) -> bool:
        """Whether [g, h] lies in h."""
        return self._leaving() is None

    def _leaving(self) -> tuple[int, int] | None:
        """A row a of the basis and b with [row a, e_b] not in h, or None."""
        whole = self.algebra.field.identity(self.algebra.dimension)
        return self.algebra.table.first_nonzero(self.basis, whole, self._projection())

    def quotient_algebra(self, name: str | None = None) -> LieAlgebra:
        """g/h for an ideal h, in the basis of the complement of `quotient`; `NotAnIdealError` otherwise."""
        leaving = self._leaving()
        if leaving is not None:
            other = self.algebra.basis_names[leaving[1]]
            raise NotAnIdealError(
                f"a quotient algebra needs an ideal, but the bracket of row {leaving[0]} with {other} is not in it"
            )
        data = self.quotient()
        blocks = self.algebra.table.contract(data.lift, data.lift, data.projection)
        # The bracket of g descends to the quotient by an ideal.
        return LieAlgebra(
            StructureConstants.from_blocks(self.algebra.field, self.codimension, blocks), name=name, check=False
        )

    def conjugated(self, matrix: Any) -> Subalgebra:
        """The image under an automorphism of g, given by its matrix (n, n) on columns; closure is proved."""
        return Subalgebra(self.algebra, self.basis @ matrix.T)

    def __repr__(self) -> str:
        around = self.algebra.name or f"a Lie algebra of dimension {self.algebra.dimension}"
        return f"<subalgebra of dimension {self.dimension} in {around} over {self.algebra.field.name}>"

    def __str__(self) -> str:
        around = self.algebra.name or f"a Lie algebra of dimension {self.algebra.dimension}"
        head = f"subalgebra of dimension {self.dimension} in {around} over {self.algebra.field.name}"
        shown = self.basis.select(rows=range(min(self.dimension, 8)))
        lines = [f"  ({', '.join(row)})" for row in shown.to_strings()]
        if self.dimension > 8:
            lines.append(f"  ... and {self.dimension - 8} further rows")
        return "\n".join([head, *lines])


def _matrix(algebra: LieAlgebra, rows: Any) -> Any:
    if hasattr(rows, "nrows"):
        return algebra.field.read(rows)
    table = rows_of(rows)
    for i, row in enumerate(table):
        if len(row) != algebra.dimension:
            raise ShapeError(f"row {i} of the subalgebra has length {len(row)}, expected {algebra.dimension}")
    return algebra.field.matrix(table, (len(table), algebra.dimension))


def _dependent(basis: Any) -> list[int]:
    """Rows in the span of the earlier ones."""
    if basis.field.exact:
        independent = set(basis.T.echelon()[1])
        return [i for i in range(basis.nrows) if i not in independent]
    ranks = [basis.select(rows=range(i)).rank() for i in range(basis.nrows + 1)]
    return [i for i in range(basis.nrows) if ranks[i + 1] == ranks[i]]


def _span(algebra: LieAlgebra, rows: Any) -> Any:
    if isinstance(rows, Subalgebra):
        require_inside(algebra, rows)
        rows = rows.basis
    return _matrix(algebra, rows).row_space()


def require_inside(algebra: LieAlgebra, subalgebra: Subalgebra) -> None:
    """Raise `InputError` if a subalgebra belongs to another algebra."""
    if subalgebra.algebra is not algebra and subalgebra.algebra != algebra:
        raise InputError(f"{subalgebra!r} is not a subalgebra of {algebra!r}: it belongs to {subalgebra.algebra!r}")


def products(algebra: LieAlgebra, left: Any, right: Any) -> Any:
    """A basis of the span of [left, right]."""
    n, field = algebra.dimension, algebra.field
    if field.exact and left.nrows > SAMPLES:
        found = _sampled_products(algebra, left, right)
        if found is not None:
            return found
    return field.stack_rows(algebra.table.contract(left, right, field.identity(n)), n).row_space()


def _sampled_products(algebra: LieAlgebra, left: Any, right: Any) -> Any:
    """The span of [x, right] for a few combinations x of `left`, if all of [left, right] is in it; else None."""
    n = algebra.dimension
    rows = [right @ algebra.ad(x).T for x in _samples(left)]
    span = algebra.field.stack_rows(rows, n).row_space()
    if span.nrows == n or algebra.table.first_nonzero(left, right, echelon_quotient(span).projection) is None:
        return span
    return None


def _samples(rows: Any) -> list[Any]:
    """Random combinations of rows, each (1, n)."""
    rng = random.Random(rows.nrows)
    weights = [[rng.randint(-9, 9) for _ in range(rows.nrows)] for _ in range(SAMPLES)]
    combined = rows.field.matrix(weights) @ rows
    return [combined.select(rows=[i]) for i in range(SAMPLES)]


def generated(algebra: LieAlgebra, rows: Any) -> Subalgebra:
    """Implements `LieAlgebra.subalgebra_generated_by`."""
    n = algebra.dimension
    span, before = _span(algebra, rows), -1
    while before < span.nrows:
        before = span.nrows
        span = algebra.field.stack_rows([span, products(algebra, span, span)], n).row_space()
    return Subalgebra(algebra, span, check=False)  # the loop ends when it is closed


def ideal_generated(algebra: LieAlgebra, rows: Any) -> Subalgebra:
    """Implements `LieAlgebra.ideal_generated_by`."""
    n = algebra.dimension
    whole = algebra.field.identity(n)
    span, before = _span(algebra, rows), -1
    while before < span.nrows:
        before = span.nrows
        span = algebra.field.stack_rows([span, products(algebra, span, whole)], n).row_space()
    return Subalgebra(algebra, span, check=False)  # an ideal is a subalgebra


def centralizer(algebra: LieAlgebra, rows: Any) -> Subalgebra:
    """Implements `LieAlgebra.centralizer`."""
    n, field = algebra.dimension, algebra.field
    span = _span(algebra, rows)
    if field.exact and span.nrows > SAMPLES:
        # what commutes with a few combinations: the centralizer, if it commutes with all
        found = field.stack_rows([algebra.ad(x) for x in _samples(span)], n).null_space()
        if algebra.table.first_nonzero(found, span, field.identity(n)) is None:
            return Subalgebra(algebra, found, check=False)
    blocks = algebra.table.contract(span, field.identity(n), field.identity(n))
    conditions = field.stack_columns(blocks, n) if blocks else field.zeros(n, 0)
    return Subalgebra(algebra, conditions.left_null_space(), check=False)  # closed by the Jacobi identity


def normalizer(subalgebra: Subalgebra) -> Subalgebra:
    """Implements `LieAlgebra.normalizer`."""
    algebra = subalgebra.algebra
    n = algebra.dimension
    blocks = algebra.table.contract(subalgebra.basis, algebra.field.identity(n), subalgebra._projection())
    conditions = algebra.field.stack_columns(blocks, n) if blocks else algebra.field.zeros(n, 0)
    return Subalgebra(algebra, conditions.left_null_space(), check=False)  # closed by the Jacobi identity


def upper_central_series(algebra: LieAlgebra) -> list[Subalgebra]:
    """Implements `LieAlgebra.upper_central_series`."""
    n, field = algebra.dimension, algebra.field
    terms = [Subalgebra(algebra, field.zeros(0, n), check=False)]
    while True:
        whole = field.identity(n)
        blocks = algebra.table.contract(whole, whole, terms[-1]._projection())
        # x with [e_i, x] in the last term for all i
        conditions = field.stack_columns(blocks, n) if blocks else field.zeros(n, 0)
        following = Subalgebra(algebra, conditions.left_null_space(), check=False)  # an ideal, as the last term is
        if following.dimension == terms[-1].dimension:
            return terms
        terms.append(following)


def derived_series(algebra: LieAlgebra) -> list[Subalgebra]:
    """Implements `LieAlgebra.derived_series`."""
    terms = [algebra.field.identity(algebra.dimension)]
    while True:
        following = products(algebra, terms[-1], terms[-1])
        if following.nrows == terms[-1].nrows:
            return [Subalgebra(algebra, t, check=False) for t in terms]  # [I, I] of an ideal is an ideal
        terms.append(following)


def lower_central_series(algebra: LieAlgebra) -> list[Subalgebra]:
    """Implements `LieAlgebra.lower_central_series`."""
    whole = algebra.field.identity(algebra.dimension)
    terms = [whole]
    while True:
        following = products(algebra, whole, terms[-1])
        if following.nrows == terms[-1].nrows:
            return [Subalgebra(algebra, t, check=False) for t in terms]  # [g, I] of an ideal is an ideal
        terms.append(following)
