"""The restricted root spaces of a semisimple real algebra, with simple roots numbered as in Satake diagrams.

g = z(a) + sum of g_lambda for a maximal split torus a, [x, v] = lambda(x) v for x in a and v in g_lambda.  A root is
positive if its last coordinate that is not 0 is positive, in a basis of restricted roots that is chosen by the basis of
the algebra.  For a basis of root vectors, such as a Chevalley basis or the matrix units of sl(n), these are the usual
positive roots.

The simple roots are numbered by an isomorphism with the restricted root system of the Satake diagram that preserves
multiplicities.  If there are several, the root spaces are numbered in the order of the basis as far as possible.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import final

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.subalgebra import independent_rows
from liehom.algebra.parabolic.split_torus import eigenvalues, maximal_split_torus
from liehom.algebra.roots.dynkin import isomorphisms
from liehom.algebra.roots.real_form import RealForm
from liehom.algebra.roots.root_system import Root
from liehom.algebra.roots.vogan import gram_to_cartan, simple_system
from liehom.algebra.structure.identification import SimplePart, simple_parts
from liehom.errors import InputError, InternalError
from liehom.scalars import ExactMatrix, Scalar, as_exact


@final
@dataclass(frozen=True, slots=True)
class RestrictedRootSpaces:
    """The decomposition of a semisimple algebra under a maximal split torus.

    Attributes
    ----------
    torus : ExactMatrix
        A basis of the torus a, as rows (r, n).
    centralizer : ExactMatrix
        A basis of the centralizer of a, as rows.
    spaces : dict of tuple of int to ExactMatrix
        For each restricted root, by its coefficients in the simple ones, a basis of its root space, as rows.
    """

    torus: ExactMatrix
    centralizer: ExactMatrix
    spaces: dict[Root, ExactMatrix]

    @property
    def rank(self) -> int:
        """The real rank, an int: the number of simple restricted roots."""
        return self.torus.nrows


@lru_cache(maxsize=16)
def restricted_root_spaces(algebra: LieAlgebra) -> RestrictedRootSpaces:
    """The restricted root spaces of a semisimple algebra, the simple ideals in the order of `LieAlgebra.real_forms`.

    Raises
    ------
    InputError
        If the algebra is not semisimple.
    UndecidedError
        If no split torus over the field of the algebra was found that is maximal over the reals.

    Examples
    --------
    >>> import liehom as lh
    >>> found = restricted_root_spaces(lh.su(2, 1))
    >>> {root: space.nrows for root, space in found.spaces.items()}
    {(1,): 2, (-1,): 2, (2,): 1, (-2,): 1}
    """
    if not algebra.is_semisimple():
        raise InputError(
            "only a semisimple algebra has restricted roots and parabolic subalgebras; take the Levi factor of "
            "levi_decomposition()"
        )
    ideals = simple_parts(algebra)
    if len(ideals) == 1:
        return _of_simple(algebra, ideals[0])
    field, n = algebra.field, algebra.dimension
    found = [(as_exact(part.ideal.basis), _of_simple(part.ideal.as_algebra(), part)) for part in ideals]
    rank, start = sum(own.rank for _, own in found), 0
    spaces = {}
    for rows, own in found:
        for root, space in own.spaces.items():
            spaces[(0,) * start + root + (0,) * (rank - start - own.rank)] = space @ rows
        start += own.rank
    torus = field.stack_rows([own.torus @ rows for rows, own in found], n)
    return RestrictedRootSpaces(torus, field.stack_rows([own.centralizer @ rows for rows, own in found], n), spaces)


def _of_simple(algebra: LieAlgebra, part: SimplePart) -> RestrictedRootSpaces:
    """The decomposition of an algebra that is simple over its field."""
    torus = maximal_split_torus(algebra)
    if not torus.nrows:
        return RestrictedRootSpaces(torus, torus.field.identity(algebra.dimension), {})
    weights = _weight_spaces(algebra, torus)
    zero = (torus.field.zero,) * torus.nrows
    values = [value for value in weights if value != zero]
    sizes = [weights[value].nrows for value in values]
    simple = _simple_roots(torus.field.matrix(values))
    chosen = torus.field.matrix([values[i] for i in simple])
    gram = (torus @ as_exact(algebra.killing_form()) @ torus.T).inverse()
    inner = (chosen @ gram @ chosen.T).to_rows()
    cartan = torus.field.matrix([[2 * x / inner[j][j] for j, x in enumerate(row)] for row in inner])
    doubled = [tuple(2 * x for x in values[i]) for i in simple]
    multiplicities = [(sizes[i], weights[v].nrows if v in weights else 0) for i, v in zip(simple, doubled, strict=True)]
    order = _numbering(part.real_forms(), _integers(cartan), multiplicities)
    coefficients = torus.field.matrix(values) @ chosen.select(rows=order).inverse()
    roots = [tuple(row) for row in _integers(coefficients)]
    return RestrictedRootSpaces(
        torus, weights[zero], {root: weights[value] for root, value in zip(roots, values, strict=True)}
    )


def _weight_spaces(algebra: LieAlgebra, torus: ExactMatrix) -> dict[tuple[Scalar, ...], ExactMatrix]:
    """The joint eigenspaces of a split torus, by the eigenvalues of its basis, in the order of their pivots."""
    field, n = torus.field, algebra.dimension
    spaces: dict[tuple[Scalar, ...], ExactMatrix] = {(): field.identity(n)}
    for i in range(torus.nrows):
        x = torus.select(rows=[i])
        action, values = algebra.ad(x).T, eigenvalues(algebra, x)
        if values is None:
            raise InternalError("an element of a split torus is not diagonalizable")
        finer = {}
        for value, space in spaces.items():
            echelon, pivots = space.echelon()
            block = (echelon @ action).select(columns=pivots).T
            left = len(pivots)
            for c in values:
                kernel = (block - field.identity(len(pivots)).scale(c)).null_space() if left else field.zeros(0, 0)
                if kernel.nrows:
                    finer[(*value, c)] = (kernel @ echelon).row_space()
                    left -= kernel.nrows
        spaces = finer
    if sum(space.nrows for space in spaces.values()) < n:
        raise InternalError("the joint eigenspaces of a split torus do not span the algebra")
    pivots_of = {value: space.echelon()[1] for value, space in spaces.items()}
    signs = {value: [-field.sign(x) for x in value] for value in spaces}
    return {value: spaces[value] for value in sorted(spaces, key=lambda value: (pivots_of[value], signs[value]))}


def _simple_roots(values: ExactMatrix) -> list[int]:
    """The indices of the simple ones among the roots with these values (m, r), in the order of the rows."""
    base = values.select(rows=independent_rows(values))
    coordinates = values @ base.inverse()  # rational: fractions with one denominator
    roots = [tuple(int(coordinates.parts[0][i, j]) for j in range(values.ncols)) for i in range(values.nrows)]
    index = {root: i for i, root in enumerate(roots)}
    return sorted(index[root] for root in simple_system(roots, lambda a: a[::-1]))


def _numbering(
    forms: list[RealForm], cartan: list[list[int]], multiplicities: list[tuple[int, int]]
) -> tuple[int, ...]:
    """For each simple restricted root of the Satake diagram in turn, the index of the corresponding simple root."""
    if len(forms) == 1:
        satake = forms[0].satake
        simple, sizes = satake.simple_restricted_roots(), satake.restricted_roots()
        expected = [(sizes[a], sizes.get(tuple(2 * x for x in a), 0)) for a in simple]
        for order in isomorphisms(gram_to_cartan(satake.root_system(), simple), cartan):
            if [multiplicities[i] for i in order] == expected:
                return order
    raise InternalError("the restricted roots are not those of the Satake diagram")


def _integers(matrix: ExactMatrix) -> list[list[int]]:
    """The entries of a matrix whose entries are integers, as ints."""
    found = [[int(matrix.parts[0][i, j]) for j in range(matrix.ncols)] for i in range(matrix.nrows)]
    if matrix.den != 1 or any(not part.is_zero() for part in matrix.parts[1:]):
        raise InternalError(f"expected integers, got {matrix}")
    return found
