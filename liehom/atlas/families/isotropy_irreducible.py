"""Isotropy-irreducible pairs that are not symmetric: h acts irreducibly on g/h, of dimension at most 30.

The compact pairs are those of the lists of Manturov (1961), Wolf (1968) and Kramer (1975), which are complete. With one
exception they are the pairs (g, h) in which h acts on V irreducibly by a representation V whose image preserves a form,
and g is the whole classical algebra of V: so, su or sp. The others are g2/su(3), so(7)/g2 and g2/so(3).

Every pair (g, h) with reductive h has a Cartan involution that preserves h (Mostow), and a compact dual pair. If g/h
stays irreducible over C, the dual is in the lists, and (g, h) is given by an involution of it: these real forms and the
complexifications are listed. If g/h becomes a sum of two conjugate modules, the dual may be reducible. Of these pairs
the module has the real forms g2(2)/su(2,1) and so(4,4)/su(2,1) of g2/su(3) and so(8)/su(3), and so(3,C) in so(6,3) by
Hermitian matrices, H -> X H + H X*, with the dual so(9)/so(3)+so(3). It is not claimed that these are all. The other
real forms g2(2)/sl(3) and so(5,3)/sl(3) and the complexifications of these pairs are reducible.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import combinations
from typing import NamedTuple

import numpy as np

from liehom.algebra import LieAlgebra, Subalgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.algebra.matrices.matrix_basis import null_space
from liehom.algebra.matrices.named_matrices import linear_lie_algebra
from liehom.atlas.recipe import Recipe
from liehom.catalog import pair as named_pair
from liehom.catalog.linear import linear_matrices
from liehom.catalog.names import parse_expression
from liehom.catalog.subalgebras import coordinates, preserving
from liehom.errors import CatalogError, InputError
from liehom.representations import Pair, Representation
from liehom.representations.highest_weight.real_form_module import real_module
from liehom.scalars import QQ, Matrix
from liehom.scalars.fields.exact_field import as_exact
from liehom.typing import IntegerArray

LARGEST = 34
"""Largest dimension of g/h up to which the compact list is complete; the next are so(10)/sp(2) and f4/so(3)+g2."""


class _Row(NamedTuple):
    dimension: int
    name: str
    build: Callable[[str], Pair]
    argument: str
    compact: bool


def isotropy_irreducible_pairs(max_dimension: int = 30) -> Iterator[Recipe]:
    """Isotropy-irreducible pairs that are not symmetric, by the dimension of g/h.

    Parameters
    ----------
    max_dimension : int
        The largest dimension of g/h, at most 34.

    Yields
    ------
    Recipe
        Of the family "isotropy-irreducible". The fact known is ``compact``, whether g is compact.

    Raises
    ------
    InputError
        If `max_dimension` is larger.

    Notes
    -----
    Names say how h is embedded: by the adjoint representation (ad), a symmetric power (S2, S3), a tensor product,
    Hermitian matrices (herm), or as the principal three-dimensional subalgebra.

    Examples
    --------
    >>> [recipe.name for recipe in isotropy_irreducible_pairs(7)]
    ['g2/su(3)', 'g2(2)/su(2,1)', 'sp(2)/S3(su(2))', 'sp(4,R)/S3(sl(2))', 'so(7)/g2', 'spin(4,3)/g2(2)']
    """
    if max_dimension > LARGEST:
        raise InputError(f"the pairs are listed up to dimension {LARGEST}; found max_dimension = {max_dimension}")
    for row in _ROWS.values():
        if row.dimension <= max_dimension:
            known = {"compact": row.compact}
            yield Recipe(row.name, "isotropy-irreducible", isotropy_irreducible_pair, (row.name,), known)


def isotropy_irreducible_pair(name: str) -> Pair:
    """The isotropy-irreducible pair with a name in `isotropy_irreducible_pairs`.

    Raises
    ------
    CatalogError
        If there is no such name.

    Examples
    --------
    >>> pair = isotropy_irreducible_pair("so(4,4)/ad(su(2,1))")
    >>> pair.dimension, pair.algebra.killing_signature(), pair.isotropy_representation().is_irreducible()
    (20, (16, 12, 0), True)
    """
    row = _ROWS.get(name)
    if row is None:
        raise CatalogError(f"{name!r} is not in the list of isotropy-irreducible pairs: {', '.join(_ROWS)}")
    made = row.build(row.argument)
    return made if made.name == name else Pair(made.algebra, made.subalgebra, name=name)


def classical_hull(matrices: IntegerArray) -> IntegerArray:
    """The classical linear Lie algebra of an irreducible representation, as a matrix basis.

    Parameters
    ----------
    matrices : (k, N, N) integers
        A basis of the image of a semisimple algebra.

    Returns
    -------
    (m, N, N) integers
        All matrices without trace that commute with the commutant, preserve the invariant form if there is one, and if
        the commutant is C have no trace over C.

    Examples
    --------
    The adjoint representation of so(3) has so(3), and su(2) on R^4 has sp(1):

    >>> from liehom.algebra.matrices import so, su
    >>> len(classical_hull(so(3))), len(classical_hull(su(2)))
    (3, 3)
    """
    size = matrices.shape[1]
    algebra = linear_lie_algebra(matrices)
    representation = Representation(algebra, list(matrices), check=False)
    commutant = [_integers(c) for c in representation.commutant()]
    forms = representation.invariant_forms()
    form = [*forms.symmetric, *forms.skew][:1]
    whole = np.eye(size * size, dtype=np.int64).reshape(-1, size, size)
    rows = preserving(whole, commuting=commutant, forms=[_integers(p) for p in form])
    found = rows.reshape(-1, size, size)
    scalars = commutant if len(commutant) == 2 else [np.eye(size, dtype=np.int64)]
    traces = np.stack([np.einsum("aij,ji->a", found, c) for c in scalars])
    kept: IntegerArray = np.tensordot(null_space(traces), found, axes=1)
    return kept


def _integers(matrix: Matrix) -> IntegerArray:
    """A primitive integer multiple of a rational matrix."""
    flat = as_exact(matrix).reshape(1, matrix.nrows * matrix.ncols).primitive()
    entries: IntegerArray = np.array([int(x) for x in flat.parts[0].entries()], dtype=np.int64).reshape(matrix.shape)
    return entries


def _inside(whole: IntegerArray, part: IntegerArray) -> Pair:
    """The pair of two linear Lie algebras, the second in the first."""
    algebra = linear_lie_algebra(whole)
    rows = coordinates(whole, part)
    if rows is None:
        raise InputError("the matrices of h are not in the span of the matrices of g")
    matrix = QQ.from_integers(rows.ravel().tolist(), len(rows), len(whole))
    return Pair(algebra, Subalgebra(algebra, matrix))


def _in_hull(matrices: IntegerArray) -> Pair:
    return _inside(classical_hull(matrices), matrices)


def _of_catalogue(name: str) -> Pair:
    return named_pair(name)


def _of_linear_name(name: str) -> Pair:
    """The pair of a linear Lie algebra of the catalogue in its classical hull."""
    return _in_hull(linear_matrices(parse_expression(name)))


def _of_module(argument: str) -> Pair:
    """The pair of a module, given as 'form: weight', in its classical hull."""
    form, weight = argument.split(": ")
    representation = real_module(form, [int(x) for x in weight.split(",")]).representation
    return _in_hull(np.stack([_integers(m) for m in representation.matrices]))


def _of_complex_tensor(argument: str) -> Pair:
    """The pair of the tensor product over C of two unitary algebras, in its classical hull."""
    first, second = (linear_matrices(parse_expression(name)) for name in argument.split(" "))
    m, n = first.shape[1] // 2, second.shape[1] // 2
    left = np.einsum("aicjd,kl->aikcjld", first.reshape(-1, m, 2, m, 2), np.eye(n, dtype=np.int64))
    right = np.einsum("akcld,ij->aikcjld", second.reshape(-1, n, 2, n, 2), np.eye(m, dtype=np.int64))
    return _in_hull(np.concatenate([x.reshape(-1, 2 * m * n, 2 * m * n) for x in (left, right)]))


def _of_principal(form: str) -> Pair:
    """The principal three-dimensional subalgebra of g2 or g2(2), which is the stabilizer of a three-form on R^7."""
    matrices = np.stack([_integers(m) for m in real_module(form, [6]).representation.matrices])
    return _inside(_stabilizer_of_three_form(matrices), matrices)


def _stabilizer_of_three_form(matrices: IntegerArray) -> IntegerArray:
    """All matrices that annihilate the three-form that the given matrices annihilate, which is unique up to scale."""
    size = matrices.shape[1]
    triples = list(combinations(range(size), 3))
    forms = np.zeros((len(triples), size, size, size), dtype=np.int64)
    for t, (i, j, k) in enumerate(triples):
        for a, b, c in ((i, j, k), (j, k, i), (k, i, j)):
            forms[t, a, b, c], forms[t, b, a, c] = 1, -1
    index = tuple(np.array(triples).T)

    def moved(form: IntegerArray, matrix: IntegerArray) -> IntegerArray:
        """(X phi)(u, v, w) = phi(X u, v, w) + phi(u, X v, w) + phi(u, v, X w), on the triples."""
        total = np.einsum("xa,xbc->abc", matrix, form) + np.einsum("xb,axc->abc", matrix, form)
        total = total + np.einsum("xc,abx->abc", matrix, form)
        chosen: IntegerArray = total[index]
        return chosen

    conditions = np.stack([np.concatenate([moved(f, m) for m in matrices]) for f in forms], axis=1)
    (coefficients,) = null_space(conditions)
    form = np.tensordot(coefficients, forms, axes=1)
    whole = np.eye(size * size, dtype=np.int64).reshape(-1, size, size)
    found: IntegerArray = null_space(np.stack([moved(form, x) for x in whole], axis=1)).reshape(-1, size, size)
    return found


def _of_complexification(name: str) -> Pair:
    """The complexification of a pair in the list, as a pair of real algebras: bases x and i x."""
    real = isotropy_irreducible_pair(name)
    n, table = real.algebra.dimension, real.algebra.table
    i, j, k, values = table.i, table.j, table.k, [int(v) for v in table.parts[0]]
    opposite = [-v for v in values]
    # [x, y], [x, i y] = i [x, y], [y, i x] = -i [x, y], [i x, i y] = -[x, y]
    parts = [(i, j, k, values), (i, j + n, k + n, values), (j, i + n, k + n, opposite), (i + n, j + n, k, opposite)]
    first, second, third = (np.concatenate([part[axis] for part in parts]) for axis in range(3))
    entries = [v for part in parts for v in part[3]]
    constants = StructureConstants.from_integers(QQ, 2 * n, first, second, third, entries, table.den)
    algebra = LieAlgebra(constants, check=False)  # the complexification of a Lie algebra
    rows = _integers(real.subalgebra.basis)
    both = np.kron(np.eye(2, dtype=np.int64), rows)
    return Pair(algebra, Subalgebra(algebra, QQ.from_integers(both.ravel().tolist(), *both.shape)))


def _of_hermitian_matrices(_: str) -> Pair:
    """so(3,C) on Hermitian matrices of size 3 by H -> X H + H X*, in so(6,3)."""
    skew = list(linear_matrices(parse_expression("so(3)")))
    pairs = [(a, b) for a in range(3) for b in range(3)]
    basis = []
    for a, b in pairs:
        unit = np.zeros((3, 3), dtype=complex)
        unit[a, b], unit[b, a] = (1, 1) if a <= b else (1j, -1j)
        basis.append(unit)
    matrices = np.zeros((6, 9, 9), dtype=np.int64)
    for row, x in enumerate([*skew, *(1j * s for s in skew)]):
        for column, h in enumerate(basis):
            image = x @ h + h @ x.conj().T
            matrices[row, :, column] = [int(image[a, b].real) if a <= b else int(image[a, b].imag) for a, b in pairs]
    return _in_hull(matrices)


def _named(names: str) -> tuple[tuple[str, str], ...]:
    """Names whose part after the slash is the argument: 'g/name' gives ('g/name', 'name')."""
    return tuple((name, name.partition("/")[2]) for name in names.split())


def _rows() -> Iterator[_Row]:
    """The rows of the list; the first of each group is compact unless the group consists of complex algebras."""
    groups: list[tuple[int, Callable[[str], Pair], tuple[tuple[str, str], ...]]] = [
        (6, _of_catalogue, (("g2/su(3)", "g2/su(3)"), ("g2(2)/su(2,1)", "g2(2)/su(2,1)"))),
        (7, _of_module, (("sp(2)/S3(su(2))", "so(3): 3"), ("sp(4,R)/S3(sl(2))", "sl(2,R): 3"))),
        (7, _of_catalogue, (("so(7)/g2", "so(7)/g2"), ("spin(4,3)/g2(2)", "spin(4,3)/g2(2)"))),
        (11, _of_principal, (("g2/principal(so(3))", "so(3)"), ("g2(2)/principal(sl(2))", "sl(2,R)"))),
        (15, _of_linear_name, _named("sp(3)/tensor(sp(1),so(3)) sp(2,1)/tensor(sp(1),so(2,1))")),
        (20, _of_module, (("so(8)/ad(su(3))", "su(3): 1,1"), ("so(4,4)/ad(su(2,1))", "su(2,1): 1,1"))),
        (
            24,
            _of_complex_tensor,
            (
                ("su(6)/tensor(su(2),su(3))", "su(2) su(3)"),
                ("su(4,2)/tensor(su(2),su(2,1))", "su(2) su(2,1)"),
                ("su(3,3)/tensor(su(1,1),su(3))", "su(1,1) su(3)"),
                ("su(3,3)/tensor(su(1,1),su(2,1))", "su(1,1) su(2,1)"),
            ),
        ),
        (
            27,
            _of_linear_name,
            _named("sp(4)/tensor(sp(1),so(4)) sp(3,1)/tensor(sp(1),so(3,1)) sp(2,2)/tensor(sp(1),so(2,2))"),
        ),
        (27, _of_module, (("su(6)/S2(su(3))", "su(3): 2,0"), ("su(4,2)/S2(su(2,1))", "su(2,1): 2,0"))),
    ]
    for dimension, build, named in groups:
        yield from (_Row(dimension, name, build, argument, i == 0) for i, (name, argument) in enumerate(named))
    for dimension, build, names in (
        (15, _of_catalogue, "sp(6,R)/tensor(sl(2),so(3))"),
        (15, _of_linear_name, "sp(6,R)/tensor(sl(2),so(2,1))"),
        (24, _of_catalogue, "sl(6)/tensor(sl(2),sl(3))"),
        (24, _of_linear_name, "sl(3,H)/tensor(sp(1),sl(3))"),
        (27, _of_catalogue, "sp(8,R)/tensor(sl(2),so(4))"),
        (27, _of_linear_name, "sp(8,R)/tensor(sl(2),so(3,1)) sp(8,R)/tensor(sl(2),so(2,2))"),
        (27, _of_catalogue, "sl(6)/S2(sl(3))"),
        (30, _of_hermitian_matrices, "so(6,3)/herm(so(3,C))"),
    ):
        for name, argument in _named(names):
            yield _Row(dimension, name, build, name if build is _of_catalogue else argument, False)
    for dimension, name, real in (
        (14, "sp(4,C)/S3(sl(2,C))", "sp(4,R)/S3(sl(2))"),
        (14, "so(7,C)/g2(C)", "spin(4,3)/g2(2)"),
        (22, "g2(C)/principal(sl(2,C))", "g2(2)/principal(sl(2))"),
        (30, "sp(6,C)/tensor(sl(2,C),so(3,C))", "sp(6,R)/tensor(sl(2),so(2,1))"),
    ):
        yield _Row(dimension, name, _of_complexification, real, False)


_ROWS = {row.name: row for row in sorted(_rows(), key=lambda row: row.dimension)}
