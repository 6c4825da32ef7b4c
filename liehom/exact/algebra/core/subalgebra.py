"""Subalgebra: a subspace of a Lie algebra that is closed under the bracket.

`basis` is the basis as given, `subspace` has the canonical one. The functions below the class implement the methods of
`LieAlgebra` that return subalgebras.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeVar, cast, final

import numpy as np

from liehom.base.errors import (
    DependentRowsError,
    InputError,
    NotAnIdealError,
    NotASubalgebraError,
    ShapeError,
    displayed,
    shown,
)
from liehom.base.objects import Displayed, Immutable
from liehom.base.typing import VectorLike
from liehom.exact.algebra import structure
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.tables import RowsLike, coefficients
from liehom.exact.scalars.exact_field import ExactMatrix
from liehom.exact.scalars.field import Field, Matrix, Scalar, rows_of
from liehom.exact.scalars.floating import FloatMatrix
from liehom.exact.scalars.modular import independent_columns, invariant_hull_rank
from liehom.exact.scalars.subspaces import Quotient, Subspace, echelon_quotient, quotient

if TYPE_CHECKING:
    from liehom.exact.algebra.structure.ideals import Place

M = TypeVar("M", bound=Matrix)

SAMPLES = 3  # random combinations that are tried in place of all rows
SHOWN_ROWS = 8
WELL_SPANNED = 10.0  # least singular value of rows over floats, in units of their error, with which closure is tested
GENERATED = "the dimension of a generated subalgebra or ideal"


@final
class Subalgebra(Displayed, Immutable):
    """A subalgebra h of g, given by the rows of a basis.

    Parameters
    ----------
    algebra : LieAlgebra
        The algebra g that contains h.
    rows : sequence of rows, or a matrix
        Coefficients in the basis of g, shape (k, n), linearly independent; a row may be the name of a basis element or
        {name: coefficient}. No rows give the zero subalgebra.
    check : bool, optional
        Prove closure (default). Pass False only if it is proved already.

    Raises
    ------
    DependentRowsError
        If the rows are dependent.
    NotASubalgebraError
        If their span is not closed; names the bracket that leaves it.

    Notes
    -----
    Two subalgebras of equal algebras are equal (``==``), and hash equal, if they are the same subspace, in whatever
    basis.

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

    def __init__(self, algebra: LieAlgebra, rows: RowsLike, *, check: bool = True) -> None:
        self.algebra: LieAlgebra = algebra
        self.basis: Matrix = _matrix(algebra, rows)
        self._subspace: Subspace | None = None
        self._quotient: Quotient | None = None
        if self.basis.ncols != algebra.dimension:
            raise ShapeError(f"rows of length {self.basis.ncols} in an algebra of dimension {algebra.dimension}")
        if check:
            self._prove()

    def _prove(self) -> None:
        rank = self.basis.rank()
        if rank < self.basis.nrows:
            dependent = sorted(set(range(self.basis.nrows)) - set(independent_rows(self.basis)))
            raise DependentRowsError(rank, dependent, "rows of the subalgebra")
        # otherwise all brackets of rows vanish
        if rank > 1 and len(self.algebra.table) and (failure := self._not_closed()) is not None:
            a, b = failure
            bracket = self.algebra.bracket(self.basis.row(a), self.basis.row(b))
            values = ", ".join(shown(self.algebra.field.show(x)) for x in bracket)
            raise NotASubalgebraError((a, b), f"({values})")

    def _not_closed(self) -> tuple[int, int] | None:
        """The first two rows (over floats, the two with the largest part outside) whose bracket leaves the span."""
        table, projection = self.algebra.table, self._projection()
        if not isinstance(self.basis, FloatMatrix) or not self.dimension:
            return table.first_nonzero(self.basis, self.basis, projection)
        decision = self.basis.rank_decision()
        if decision.kept < WELL_SPANNED * decision.error:
            decision.require_clear("the span of the rows of the subalgebra")
        rows = self._rows()  # orthonormal: how long the given rows are, and their angles, do not matter
        if table.first_nonzero(rows, rows, projection) is None:
            return None
        outside = [block.to_numpy() for block in table.contract(self.basis, self.basis, projection)]
        return divmod(int(np.linalg.norm(outside, axis=2).argmax()), self.dimension)

    # -- properties --------------------------------------------------------------------------------------
    @property
    def dimension(self) -> int:
        """The dimension k, an int."""
        return int(self.basis.nrows)

    @property
    def codimension(self) -> int:
        """The codimension dim g - dim h, an int."""
        return self.algebra.dimension - self.dimension

    @property
    def subspace(self) -> Subspace:
        """The subspace of g with its canonical basis."""
        self._subspace = self._subspace or Subspace(self.algebra.field, self.basis, self.algebra.dimension)
        return self._subspace

    def quotient(self) -> Quotient:
        """Coordinates on g/h (cached): a basis of h, a complement and the projection, chosen with small entries."""
        self._quotient = self._quotient or quotient(self.basis)
        return self._quotient

    def _projection(self) -> Matrix:
        """A matrix (n, d) of rank d = dim g/h that maps h to 0, by the fastest method; `quotient` has a smaller one."""
        if self._quotient is None and isinstance(self.basis, ExactMatrix):
            return echelon_quotient(self.basis).projection
        return self.quotient().projection

    def rows(self) -> list[list[Scalar]]:
        """The basis as lists of field elements."""
        return self.basis.to_rows()

    def __contains__(self, x: VectorLike) -> bool:
        return bool((self.algebra.row(x) @ self._projection()).is_zero())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Subalgebra) and self.algebra == other.algebra and self.subspace == other.subspace

    def __hash__(self) -> int:
        return hash((self.algebra, self.subspace))

    # -- ideals, quotients, images -------------------------------------------------------------------------
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
        # The intersection of two closed subspaces is closed.
        return Subalgebra(self.algebra, self.subspace.intersection(other.subspace).basis, check=False)

    def includes(self, other: Subalgebra) -> bool:
        """Whether another subalgebra of the same algebra is contained in this one."""
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
        # A closed subspace of a Lie algebra: the axioms hold.
        return LieAlgebra(self.algebra.table.changed(self.basis, self._coordinates()), name=name, check=False)

    def _coordinates(self) -> Matrix:
        """A matrix (n, k) that reads the coordinates, in the basis, of the rows that are in h."""
        basis = self.basis
        if not isinstance(basis, ExactMatrix):
            return basis.solve(self.algebra.field.identity(self.dimension))
        columns = independent_columns(basis)
        units = basis.field.identity(basis.ncols).select(columns=columns)
        return units @ basis.select(columns=columns).inverse()

    def is_ideal(self) -> bool:
        """Whether [g, h] lies in h."""
        return self._leaving() is None

    def _leaving(self) -> tuple[int, int] | None:
        """The first (a, b) with [row a of the basis, e_b] not in h, or None."""
        one = self.algebra.field.identity(self.algebra.dimension)
        return self.algebra.table.first_nonzero(self._rows(), one, self._projection())

    def _rows(self) -> Matrix:
        """The basis, over floats an orthonormal one."""
        return self.quotient().subspace if isinstance(self.basis, FloatMatrix) else self.basis

    def quotient_algebra(self, name: str | None = None) -> LieAlgebra:
        """The Lie algebra g/h of an ideal h, in the basis of the complement of `quotient`.

        Raises
        ------
        NotAnIdealError
            If [g, h] does not lie in h.
        """
        if (leaving := self._leaving()) is not None:
            other = self.algebra.basis_names[leaving[1]]
            raise NotAnIdealError(
                f"a quotient algebra needs an ideal, but the bracket of row {leaving[0]} with {other} is not in it"
            )
        data = self.quotient()
        # The bracket of g descends to the quotient by an ideal.
        return LieAlgebra(self.algebra.table.changed(data.lift, data.projection), name=name, check=False)

    def conjugated(self, matrix: Matrix) -> Subalgebra:
        """The image of h under an automorphism of g, given by its matrix (n, n) on columns; closure is proved."""
        return Subalgebra(self.algebra, self.basis @ matrix.T)

    # -- over the reals ----------------------------------------------------------------------------------
    def places(self) -> list[Place]:
        """The places of the centroid of a subalgebra that is simple over its field: its simple ideals over the reals.

        The real places come first, by increasing root, then the complex ones. The dimensions add up to `dimension`.

        No field is extended, because only signatures of forms over the given field are computed.

        Examples
        --------
        >>> import liehom as lh
        >>> (ideal,) = lh.so(3, 1).direct_sum_decomposition()
        >>> [(p.kind, p.killing_signature) for p in ideal.places()]
        [('complex', (3, 3))]
        """
        return structure.ideals.places(self)

    def real_ideals(self) -> list[Subalgebra]:
        """The simple ideals over the reals of a subalgebra that is simple over its field F, over extensions of F.

        They are in the order of `places`. Each is contained in the given ideal over its own real number field. For a
        real root theta_v of the polynomial f of the centroid this is F(theta_v), for a pair of complex roots the field
        of the coefficients of the quadratic factor of f.

        Raises
        ------
        FieldError
            If the degree of such a field could exceed 36; `places` needs no field.

        Examples
        --------
        >>> import liehom as lh
        >>> (ideal,) = lh.so(3, 1).direct_sum_decomposition()
        >>> ideal.real_ideals()
        [<subalgebra of dimension 6 in so(3,1) over QQ>]
        """
        return structure.ideals.real_ideals(self)

    # -- printing ----------------------------------------------------------------------------------------
    def __repr__(self) -> str:
        return f"<{self._title()}>"

    def _title(self) -> str:
        around = self.algebra.name or f"a Lie algebra of dimension {self.algebra.dimension}"
        return f"subalgebra of dimension {self.dimension} in {around} over {self.algebra.field.name}"

    def __str__(self) -> str:
        rows = self.basis.select(rows=range(min(self.dimension, SHOWN_ROWS)))
        lines = [f"  ({', '.join(map(self.algebra.field.show, row))})" for row in rows]
        if self.dimension > SHOWN_ROWS:
            lines.append(f"  ... and {self.dimension - SHOWN_ROWS} further rows")
        return "\n".join([self._title(), *lines])


def _matrix(algebra: LieAlgebra, rows: RowsLike) -> Matrix:
    """The rows as a matrix (k, n) over the field of the algebra; `ShapeError` if a row does not have length n."""
    field: Field[Matrix] = algebra.field
    if isinstance(rows, Matrix):
        return field.read(rows)
    table: Any = rows
    if isinstance(rows, Sequence) and not isinstance(rows, str):
        table = [coefficients(algebra.basis_names, x) if isinstance(x, (str, Mapping)) else x for x in rows]
    table = rows_of(table)
    for i, row in enumerate(table):
        if len(row) != algebra.dimension:
            raise ShapeError(f"row {i} of the subalgebra has length {len(row)}, expected {algebra.dimension}")
    return field.matrix(table, (len(table), algebra.dimension))


def independent_rows(matrix: Matrix) -> list[int]:
    """Indices of the rows that are not in the span of the earlier ones."""
    if isinstance(matrix, ExactMatrix):
        return list(matrix.T.echelon()[1])
    ranks = [matrix.select(rows=range(i)).rank() for i in range(matrix.nrows + 1)]
    return [i for i in range(matrix.nrows) if ranks[i + 1] > ranks[i]]


def complement_rows(space: ExactMatrix, part: ExactMatrix) -> ExactMatrix:
    """The first rows of `space` that are a basis modulo the span of the independent rows of `part`."""
    stacked = space.field.stack_rows([part, space], space.ncols)
    return space.select(rows=[i - part.nrows for i in independent_rows(stacked) if i >= part.nrows])


def _span(algebra: LieAlgebra, rows: Subalgebra | RowsLike) -> Matrix:
    """A basis of the span of the rows or of a subalgebra; over floats each given row has its own uncertainty."""
    if isinstance(rows, Subalgebra):
        require_inside(algebra, rows)
        rows = rows.basis
    matrix = _matrix(algebra, rows)
    if isinstance(matrix, FloatMatrix) and not isinstance(rows, FloatMatrix):
        matrix = matrix.unit_rows()
    return matrix.row_space("the span of the given rows")


def require_inside(algebra: LieAlgebra, subalgebra: Subalgebra) -> None:
    """Raise `InputError` if a subalgebra belongs to another algebra."""
    if subalgebra.algebra is not algebra and subalgebra.algebra != algebra:
        raise InputError(
            f"{displayed(subalgebra)} is not a subalgebra of {displayed(algebra)}: it belongs to "
            f"{displayed(subalgebra.algebra)}"
        )


def products(algebra: LieAlgebra, left: M, right: M) -> M:
    """A basis, as rows, of the span of the brackets of rows of `left` with rows of `right`."""
    n, table = algebra.dimension, algebra.table
    if algebra.field.exact and left.nrows > SAMPLES:
        # the span of [x, right] for a few combinations x of `left`, if all of [left, right] is in it
        span: Any = table.bracket_rows(_samples(left), right).row_space()
        if span.nrows == n or table.first_nonzero(left, right, echelon_quotient(span).projection) is None:
            return cast(M, span)
    return table.bracket_rows(left, right).row_space("the dimension of a span of brackets")


def _samples(rows: M) -> M:
    """`SAMPLES` random combinations of rows, as rows."""
    rng = random.Random(rows.nrows)
    field: Any = rows.field
    return cast(
        M, field.from_integers([rng.randint(-9, 9) for _ in range(SAMPLES * rows.nrows)], SAMPLES, rows.nrows) @ rows
    )


def generated(algebra: LieAlgebra, rows: Subalgebra | RowsLike, *, ideal: bool = False) -> Subalgebra:
    """Implements `LieAlgebra.subalgebra_generated_by` and, if `ideal`, `LieAlgebra.ideal_generated_by`."""
    n, field = algebra.dimension, algebra.field
    span = frontier = start = _span(algebra, rows)
    if isinstance(start, ExactMatrix) and not ideal and 1 < start.nrows <= SAMPLES:
        actions = [algebra.ad(start.select(rows=[i])).T for i in range(start.nrows)]
        if invariant_hull_rank(start, actions) == n:  # a lower bound
            return Subalgebra(algebra, field.identity(n), check=False)
    # a space with the start in it that the start, by brackets, maps to itself is a subalgebra (the Jacobi identity)
    while frontier.nrows and span.nrows < n:
        frontier = products(algebra, frontier if ideal else start, field.identity(n) if ideal else frontier)
        before, span = span.nrows, field.stack_rows([span, frontier], n).row_space(GENERATED)
        if span.nrows == before:
            break
    return Subalgebra(algebra, span, check=False)


def centralizer(algebra: LieAlgebra, rows: Subalgebra | RowsLike) -> Subalgebra:
    """Implements `LieAlgebra.centralizer`."""
    span = _span(algebra, rows)
    return _bracketed_into(algebra, span, algebra.field.identity(algebra.dimension), "the dimension of a centralizer")


def _bracketed_into(algebra: LieAlgebra, rows: Matrix, projection: Matrix, question: str) -> Subalgebra:
    """The x with [r, x] in the kernel of a projection for all rows r; it must be known to be closed."""
    table = algebra.table
    if isinstance(rows, ExactMatrix) and rows.nrows > SAMPLES:
        # the solutions for a few combinations are the solutions if they are solutions for all rows
        basis: Matrix = table.bracket_columns(_samples(rows), projection).left_null_space(question)
        if table.first_nonzero(basis, rows, projection) is None:
            return Subalgebra(algebra, basis, check=False)
    return Subalgebra(algebra, table.bracket_columns(rows, projection).left_null_space(question), check=False)


def normalizer(subalgebra: Subalgebra) -> Subalgebra:
    """Implements `LieAlgebra.normalizer`."""
    algebra, rows = subalgebra.algebra, subalgebra._rows()
    if isinstance(rows, ExactMatrix) and (conditions := algebra.table.normalizing_columns(rows)) is not None:
        solutions = conditions.left_null_space().select(columns=range(rows.nrows**2, conditions.nrows))
        return Subalgebra(algebra, solutions, check=False)  # closed by the Jacobi identity
    return _bracketed_into(algebra, rows, subalgebra._projection(), "the dimension of a normalizer")


def upper_central_series(algebra: LieAlgebra) -> list[Subalgebra]:
    """Implements `LieAlgebra.upper_central_series`."""
    one = algebra.field.identity(algebra.dimension)
    terms = [Subalgebra(algebra, algebra.field.zeros(0, algebra.dimension), check=False)]
    while True:
        # an ideal, as the last term is
        following = _bracketed_into(algebra, one, terms[-1]._projection(), "the upper central series")
        if following.dimension <= terms[-1].dimension:
            return terms
        terms.append(following)


def descending_series(algebra: LieAlgebra, *, central: bool = False) -> list[Subalgebra]:
    """Implements `LieAlgebra.derived_series` and, if `central`, `LieAlgebra.lower_central_series`."""
    terms = [algebra.field.identity(algebra.dimension)]
    while (term := products(algebra, terms[0 if central else -1], terms[-1])).nrows < terms[-1].nrows:
        terms.append(term)
    return [Subalgebra(algebra, t, check=False) for t in terms]  # [g, I] and [I, I] of an ideal I are ideals
