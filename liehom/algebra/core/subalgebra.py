"""Subalgebra: a subspace of a Lie algebra that is closed under the bracket.

Closure is proved at construction.  `basis` is the basis as given, `subspace` has the canonical one.  The functions
below the class implement the methods of `LieAlgebra` that return subalgebras.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeVar, final

import numpy as np

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.names import RowsLike, coefficients
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.display import Displayed
from liehom.errors import (
    DependentRowsError,
    InputError,
    NotAnIdealError,
    NotASubalgebraError,
    ShapeError,
    displayed,
    shown,
)
from liehom.immutable import Immutable
from liehom.scalars import ExactMatrix, FloatMatrix, Matrix, Scalar, Subspace
from liehom.scalars.fields.field import rows_of
from liehom.scalars.spaces.quotient import Quotient, echelon_quotient, quotient
from liehom.typing import VectorLike

if TYPE_CHECKING:
    from liehom.algebra.structure.real_splitting import Place

M = TypeVar("M", bound=Matrix)

SAMPLES = 3  # random combinations that are tried in place of all rows
SHOWN_ROWS = 8
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
    ShapeError
        If a row does not have length n.

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
            independent = set(independent_rows(self.basis))
            dependent = [i for i in range(self.basis.nrows) if i not in independent]
            raise DependentRowsError(rank, dependent, "rows of the subalgebra")
        if rank <= 1 or not len(self.algebra.table):
            return  # all brackets of rows vanish
        failure = self._not_closed()
        if failure is not None:
            a, b = failure
            bracket = self.algebra.bracket(self.basis.row(a), self.basis.row(b))
            values = ", ".join(shown(self.algebra.field.show(x)) for x in bracket)
            raise NotASubalgebraError((a, b), f"({values})")

    def _not_closed(self) -> tuple[int, int] | None:
        """The first two rows (over floats, the two with the largest part outside) whose bracket leaves the span."""
        table: StructureConstants = self.algebra.table
        projection: Any = self._projection()
        if not isinstance(self.basis, FloatMatrix) or not self.dimension:
            return table.first_nonzero(self.basis, self.basis, projection)
        self.basis.rank_decision().require_clear("the span of the rows of the subalgebra")
        rows = self.quotient().subspace  # orthonormal: how long the given rows are, and their angles, do not matter
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
        if self._subspace is None:
            self._subspace = Subspace(self.algebra.field, self.basis, self.algebra.dimension)
        return self._subspace

    def quotient(self) -> Quotient:
        """Coordinates on g/h (cached): a basis of h, a complement and the projection, chosen with small entries."""
        if self._quotient is None:
            self._quotient = quotient(self.basis)
        return self._quotient

    def _projection(self) -> Matrix:
        """A matrix (n, d) of rank d = dim g/h that maps h to 0, by the fastest method; `quotient` has a smaller one."""
        basis = self.basis
        found = (
            echelon_quotient(basis) if self._quotient is None and isinstance(basis, ExactMatrix) else self.quotient()
        )
        projection: Matrix = found.projection
        return projection

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
        k, field = self.dimension, self.algebra.field
        if isinstance(self.basis, FloatMatrix):
            coordinates = self.basis.solve(field.identity(k))
            # A closed subspace of a Lie algebra: the axioms hold.
            return LieAlgebra(self.algebra.table.changed(self.basis, coordinates), name=name, check=False)
        whole = field.identity(self.algebra.dimension)
        blocks = []
        for block in self.algebra.table.contract(self.basis, self.basis, whole):
            blocks.append(self.basis.T.solve(block.T).T)
        # A closed subspace of a Lie algebra: the axioms hold.
        return LieAlgebra(StructureConstants.from_blocks(field, k, blocks), name=name, check=False)

    def is_ideal(self) -> bool:
        """Whether [g, h] lies in h."""
        return self._leaving() is None

    def _leaving(self) -> tuple[int, int] | None:
        """The first (a, b) with [row a of the basis, e_b] not in h, or None."""
        whole = self.algebra.field.identity(self.algebra.dimension)
        rows = self.quotient().subspace if isinstance(self.basis, FloatMatrix) else self.basis
        return self.algebra.table.first_nonzero(rows, whole, self._projection())

    def quotient_algebra(self, name: str | None = None) -> LieAlgebra:
        """The Lie algebra g/h of an ideal h, in the basis of the complement of `quotient`.

        Raises
        ------
        NotAnIdealError
            If [g, h] does not lie in h.
        """
        leaving = self._leaving()
        if leaving is not None:
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

        Returns
        -------
        list of Place
            The real places by increasing root, then the complex ones. The dimensions add up to `dimension`.

        Raises
        ------
        InputError
            If the subalgebra is not simple over its field.
        UndecidedError
            Over float64.

        Notes
        -----
        No field is extended, because only signatures of forms over the given field are computed.

        Examples
        --------
        >>> import liehom as lh
        >>> (ideal,) = lh.so(3, 1).direct_sum_decomposition()
        >>> [(p.kind, p.killing_signature) for p in ideal.places()]
        [('complex', (3, 3))]
        """
        from liehom.algebra.structure.real_splitting import places

        return places(self)

    def real_ideals(self) -> list[Subalgebra]:
        """The simple ideals over the reals of a subalgebra that is simple over its field F, over extensions of F.

        Returns
        -------
        list of Subalgebra
            In the order of `places`. Each is contained in the given ideal over its own real number field. For a real
            root theta_v of the polynomial f of the centroid this is F(theta_v), for a pair of complex roots the field
            of the coefficients of the quadratic factor of f.

        Raises
        ------
        InputError
            If the subalgebra is not simple over its field.
        UndecidedError
            Over float64.
        FieldError
            If the degree of such a field could exceed 36; `places` needs no field.

        Examples
        --------
        >>> import liehom as lh
        >>> (ideal,) = lh.so(3, 1).direct_sum_decomposition()
        >>> ideal.real_ideals()
        [<subalgebra of dimension 6 in so(3,1) over QQ>]
        """
        from liehom.algebra.structure.real_splitting import real_ideals

        return real_ideals(self)

    # -- printing ----------------------------------------------------------------------------------------
    def __repr__(self) -> str:
        around = self.algebra.name or f"a Lie algebra of dimension {self.algebra.dimension}"
        return f"<subalgebra of dimension {self.dimension} in {around} over {self.algebra.field.name}>"

    def __str__(self) -> str:
        around = self.algebra.name or f"a Lie algebra of dimension {self.algebra.dimension}"
        head = f"subalgebra of dimension {self.dimension} in {around} over {self.algebra.field.name}"
        shown = self.basis.select(rows=range(min(self.dimension, SHOWN_ROWS)))
        lines = [f"  ({', '.join(map(self.algebra.field.show, row))})" for row in shown]
        if self.dimension > SHOWN_ROWS:
            lines.append(f"  ... and {self.dimension - SHOWN_ROWS} further rows")
        return "\n".join([head, *lines])


def _matrix(algebra: LieAlgebra, rows: RowsLike) -> Matrix:
    """The rows as a matrix (k, n) over the field of the algebra; `ShapeError` if a row does not have length n."""
    matrix: Matrix
    given: Any = rows
    if hasattr(rows, "nrows"):
        matrix = algebra.field.read(given)
        return matrix
    if isinstance(rows, Sequence) and not isinstance(rows, str):
        given = [coefficients(algebra.basis_names, x) if isinstance(x, (str, Mapping)) else x for x in rows]
    table = rows_of(given)
    for i, row in enumerate(table):
        if len(row) != algebra.dimension:
            raise ShapeError(f"row {i} of the subalgebra has length {len(row)}, expected {algebra.dimension}")
    matrix = algebra.field.matrix(table, (len(table), algebra.dimension))
    return matrix


def independent_rows(matrix: Matrix) -> list[int]:
    """Indices of the rows that are not in the span of the earlier ones.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> independent_rows(QQ.matrix([[1, 2], [2, 4], [0, 1]]))
    [0, 2]
    """
    if isinstance(matrix, ExactMatrix):
        return list(matrix.T.echelon()[1])
    ranks = [matrix.select(rows=range(i)).rank() for i in range(matrix.nrows + 1)]
    return [i for i in range(matrix.nrows) if ranks[i + 1] > ranks[i]]


def complement_rows(space: ExactMatrix, part: ExactMatrix) -> ExactMatrix:
    """The first rows of `space` that are a basis modulo the span of the independent rows of `part`.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> print(complement_rows(QQ.identity(3), QQ.matrix([[1, 1, 0]])))
    [1, 0, 0]
    [0, 0, 1]
    """
    k = part.nrows
    stacked = space.field.stack_rows([part, space], space.ncols)
    return space.select(rows=[i - k for i in independent_rows(stacked) if i >= k])


def _span(algebra: LieAlgebra, rows: Subalgebra | RowsLike) -> Matrix:
    """A basis of the span of the rows or of a subalgebra; over floats each given row has its own uncertainty."""
    if isinstance(rows, Subalgebra):
        require_inside(algebra, rows)
        rows = rows.basis
    matrix = _matrix(algebra, rows)
    if isinstance(matrix, FloatMatrix) and not isinstance(rows, FloatMatrix):
        matrix = matrix.unit_rows()
    span: Matrix = matrix.row_space("the span of the given rows")
    return span


def require_inside(algebra: LieAlgebra, subalgebra: Subalgebra) -> None:
    """Raise `InputError` if a subalgebra belongs to another algebra."""
    if subalgebra.algebra is not algebra and subalgebra.algebra != algebra:
        raise InputError(
            f"{displayed(subalgebra)} is not a subalgebra of {displayed(algebra)}: it belongs to "
            f"{displayed(subalgebra.algebra)}"
        )


def products(algebra: LieAlgebra, left: M, right: M) -> M:
    """A basis, as rows, of the span of the brackets of rows of `left` with rows of `right`."""
    if algebra.field.exact and left.nrows > SAMPLES:
        found = _sampled_products(algebra, left, right)
        if found is not None:
            return found
    return algebra.table.bracket_rows(left, right).row_space("the dimension of a span of brackets")


def _sampled_products(algebra: LieAlgebra, left: M, right: M) -> M | None:
    """The span of [x, right] for a few combinations x of `left`, if all of [left, right] is in it; else None."""
    n = algebra.dimension
    rows = [right @ algebra.ad(x).T for x in _samples(left)]
    span: Any = algebra.field.stack_rows(rows, n).row_space()
    if span.nrows == n or algebra.table.first_nonzero(left, right, echelon_quotient(span).projection) is None:
        found: M = span
        return found
    return None


def _samples(rows: M) -> list[M]:
    """`SAMPLES` random combinations of rows, each (1, n)."""
    rng = random.Random(rows.nrows)
    weights = [[rng.randint(-9, 9) for _ in range(rows.nrows)] for _ in range(SAMPLES)]
    combined = rows.field.matrix(weights) @ rows
    return [combined.select(rows=[i]) for i in range(SAMPLES)]


def generated(algebra: LieAlgebra, rows: Subalgebra | RowsLike) -> Subalgebra:
    """Implements `LieAlgebra.subalgebra_generated_by`."""
    n = algebra.dimension
    span, before = _span(algebra, rows), -1
    while before < span.nrows:
        before = span.nrows
        span = algebra.field.stack_rows([span, products(algebra, span, span)], n).row_space(GENERATED)
    return Subalgebra(algebra, span, check=False)  # the loop ends when it is closed


def ideal_generated(algebra: LieAlgebra, rows: Subalgebra | RowsLike) -> Subalgebra:
    """Implements `LieAlgebra.ideal_generated_by`."""
    n = algebra.dimension
    whole = algebra.field.identity(n)
    span, before = _span(algebra, rows), -1
    while before < span.nrows:
        before = span.nrows
        span = algebra.field.stack_rows([span, products(algebra, span, whole)], n).row_space(GENERATED)
    return Subalgebra(algebra, span, check=False)  # an ideal is a subalgebra


def centralizer(algebra: LieAlgebra, rows: Subalgebra | RowsLike) -> Subalgebra:
    """Implements `LieAlgebra.centralizer`."""
    n, field = algebra.dimension, algebra.field
    span = _span(algebra, rows)
    if isinstance(span, ExactMatrix) and span.nrows > SAMPLES:
        # the space that commutes with a few combinations is the centralizer if it commutes with all rows
        found = field.stack_rows([algebra.ad(x) for x in _samples(span)], n).null_space()
        if algebra.table.first_nonzero(found, span, field.identity(n)) is None:
            return Subalgebra(algebra, found, check=False)
    conditions = algebra.table.bracket_columns(span, field.identity(n))
    found = conditions.left_null_space("the dimension of a centralizer")
    return Subalgebra(algebra, found, check=False)  # closed by the Jacobi identity


def normalizer(subalgebra: Subalgebra) -> Subalgebra:
    """Implements `LieAlgebra.normalizer`."""
    algebra = subalgebra.algebra
    basis = subalgebra.quotient().subspace if isinstance(subalgebra.basis, FloatMatrix) else subalgebra.basis
    conditions = algebra.table.bracket_columns(basis, subalgebra._projection())
    found = conditions.left_null_space("the dimension of a normalizer")
    return Subalgebra(algebra, found, check=False)  # closed by the Jacobi identity


def upper_central_series(algebra: LieAlgebra) -> list[Subalgebra]:
    """Implements `LieAlgebra.upper_central_series`."""
    n, field = algebra.dimension, algebra.field
    terms = [Subalgebra(algebra, field.zeros(0, n), check=False)]
    while True:
        # x with [e_i, x] in the last term for all i
        conditions = algebra.table.bracket_columns(field.identity(n), terms[-1]._projection())
        found = conditions.left_null_space("the upper central series")
        following = Subalgebra(algebra, found, check=False)  # an ideal, as the last term is
        if following.dimension <= terms[-1].dimension:
            return terms
        terms.append(following)


def derived_series(algebra: LieAlgebra) -> list[Subalgebra]:
    """Implements `LieAlgebra.derived_series`."""
    terms = [algebra.field.identity(algebra.dimension)]
    while True:
        following = products(algebra, terms[-1], terms[-1])
        if following.nrows >= terms[-1].nrows:
            return [Subalgebra(algebra, t, check=False) for t in terms]  # [I, I] of an ideal is an ideal
        terms.append(following)


def lower_central_series(algebra: LieAlgebra) -> list[Subalgebra]:
    """Implements `LieAlgebra.lower_central_series`."""
    whole = algebra.field.identity(algebra.dimension)
    terms = [whole]
    while True:
        following = products(algebra, whole, terms[-1])
        if following.nrows >= terms[-1].nrows:
            return [Subalgebra(algebra, t, check=False) for t in terms]  # [g, I] of an ideal is an ideal
        terms.append(following)
