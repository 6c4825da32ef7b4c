"""Pairs in which h acts irreducibly, on the defining module or on g/h."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import product
from typing import NamedTuple

import numpy as np

from liehom.base.errors import CatalogError, InputError
from liehom.base.typing import IntegerArray
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.algebra.linear.linear_bases import exterior_power, null_space
from liehom.exact.algebra.linear.named_matrices import classical_matrices, linear_lie_algebra
from liehom.exact.catalog.algebras import linear_matrices
from liehom.exact.catalog.names import parse_expression
from liehom.exact.catalog.pairs import coordinates, pair as named_pair, preserving
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.core.representation import Representation
from liehom.exact.representations.highest_weight.real_modules import real_module
from liehom.exact.scalars.exact_field import as_exact
from liehom.exact.scalars.field import Matrix
from liehom.exact.scalars.rational import QQ
from liehom.studies.atlas.entry import Recipe

# The classical hull of an irreducible linear algebra is the largest linear algebra with the same commutant and the same
# invariant form: so, sp, su or sl over the reals, the complex numbers or the quaternions. For h of type A1 on R^7, the
# stabilizer of the invariant three-form is g2 or g2(2). Everything is linear algebra over QQ.


def module_pair(name: str, form: str, weight: tuple[int, ...]) -> Pair:
    """The pair of the classical hull of an irreducible real module, and the algebra that acts."""
    return hull_pair(name, np.stack([integers(m) for m in real_module(form, weight).representation.matrices]))


def linear_pair(name: str, linear: str) -> Pair:
    """The pair of the classical hull of an irreducible linear Lie algebra of the catalogue, and this algebra."""
    return hull_pair(name, linear_matrices(parse_expression(linear)))


def principal_pair(name: str, form: str) -> Pair:
    """The pair of g2 or g2(2) and its principal three-dimensional subalgebra, for the form so(3) or sl(2,R)."""
    matrices = np.stack([integers(m) for m in real_module(form, (6,)).representation.matrices])
    invariant = null_space(exterior_power(matrices, 3).reshape(-1, 35))  # unique up to a factor
    linear = classical_matrices("gl", 7, "R")
    rows = preserving(exterior_power(linear, 3), points=list(invariant))
    return _of_matrices(name, np.tensordot(rows, linear, axes=1), matrices)


def hull_pair(name: str, matrices: IntegerArray) -> Pair:
    """The pair of the classical hull of an irreducible linear Lie algebra with this basis, and the algebra itself."""
    return _of_matrices(name, classical_hull(matrices), matrices)


def classical_hull(matrices: IntegerArray) -> IntegerArray:
    """The classical linear Lie algebra of an irreducible representation, as a matrix basis."""
    size = matrices.shape[1]
    representation = Representation(linear_lie_algebra(matrices), list(matrices), check=False)
    commutant = [integers(c) for c in representation.commutant()]
    forms = representation.invariant_forms()
    form = [integers(p) for p in (*forms.symmetric, *forms.skew)][:1]
    linear = classical_matrices("gl", size, "R")
    hull = np.tensordot(preserving(linear, commuting=commutant, forms=form), linear, axes=1)
    scalars = commutant if len(commutant) == 2 else [np.eye(size, dtype=np.int64)]
    return np.tensordot(null_space(np.stack([np.einsum("aij,ji->a", hull, c) for c in scalars])), hull, axes=1)


def complexified(pair: Pair, name: str) -> Pair:
    """The complexification of a real pair, as a pair of real algebras with the bases x, i x."""
    algebra = pair.algebra.complexification(name=name.partition("/")[0]).algebra
    rows = as_exact(pair.subalgebra.basis)
    none = rows.field.zeros(*rows.shape)
    blocks = [rows.field.stack_columns([rows, none], rows.nrows), rows.field.stack_columns([none, rows], rows.nrows)]
    # no check: x and i x for the basis elements x of a subalgebra
    return Pair(algebra, Subalgebra(algebra, rows.field.stack_rows(blocks, algebra.dimension), check=False), name=name)


def integers(matrix: Matrix) -> IntegerArray:
    """The primitive integer multiple of a rational matrix, as an array."""
    entries = as_exact(matrix).reshape(1, matrix.nrows * matrix.ncols).primitive().parts[0].entries()
    return np.array([int(x) for x in entries], dtype=np.int64).reshape(matrix.shape)


def _of_matrices(name: str, matrices: IntegerArray, part: IntegerArray) -> Pair:
    """The pair of two linear Lie algebras, the second in the first."""
    algebra = linear_lie_algebra(matrices, name.partition("/")[0])
    rows = coordinates(matrices, part)
    if rows is None:
        raise InputError(f"{name}: the matrices of h are not in the span of the matrices of g")
    subalgebra = Subalgebra(algebra, QQ.from_integers(rows.ravel().tolist(), len(rows), len(matrices)))
    return Pair(algebra, subalgebra, name=name)


# The compact isotropy-irreducible pairs that are not symmetric are those of the lists of Manturov (1961), Wolf (1968)
# and Kramer (1975), which are complete. But for g2/su(3), so(7)/g2 and g2/so(3), h acts irreducibly by a representation
# V whose image preserves a form, and g is the classical algebra of V: so, su or sp. Every pair (g, h) with reductive h
# has a Cartan involution that preserves h (Mostow), and a compact dual pair. If g/h stays irreducible over C, the dual
# is in the lists, and (g, h) is given by an involution of it: these real forms and the complexifications are listed. If
# g/h becomes a sum of two conjugate modules, the dual may be reducible. Of these pairs the module has the real forms
# g2(2)/su(2,1) and so(4,4)/su(2,1) of g2/su(3) and so(8)/su(3), and so(3,C) in so(6,3) by Hermitian matrices, H -> X H
# + H X*, with the dual so(9)/so(3)+so(3). It is not claimed that these are all. The other real forms g2(2)/sl(3) and
# so(5,3)/sl(3) and the complexifications of these pairs are reducible.

LARGEST = 34
"""Largest dimension of g/h up to which the compact list is complete; the next are so(10)/sp(2) and f4/so(3)+g2."""


class _Row(NamedTuple):
    dimension: int
    name: str
    build: Callable[[str, str], Pair]
    argument: str
    compact: bool


def isotropy_irreducible_pairs(max_dimension: int = 30) -> Iterator[Recipe]:
    """Isotropy-irreducible pairs that are not symmetric, by the dimension of g/h.

    The dimension is at most 34. The fact known is ``compact``, whether g is compact.

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
    """The isotropy-irreducible pair with a name in `isotropy_irreducible_pairs`."""
    row = _ROWS.get(name)
    if row is None:
        raise CatalogError(f"{name!r} is not in the list of isotropy-irreducible pairs: {', '.join(_ROWS)}")
    return row.build(name, row.argument)


def _of_catalogue(_: str, name: str) -> Pair:
    return named_pair(name)


def _of_module(name: str, argument: str) -> Pair:
    """The pair of a module, 'form: weight', in its classical hull."""
    form, weight = argument.split(": ")
    return module_pair(name, form, tuple(map(int, weight.split(","))))


def _of_complex_tensor(name: str, argument: str) -> Pair:
    """The pair of the tensor product over C of two unitary algebras, in its classical hull."""
    first, second = (linear_matrices(parse_expression(factor)) for factor in argument.split(" "))
    m, n = first.shape[1] // 2, second.shape[1] // 2
    left = np.einsum("aicjd,kl->aikcjld", first.reshape(-1, m, 2, m, 2), np.eye(n, dtype=np.int64))
    right = np.einsum("akcld,ij->aikcjld", second.reshape(-1, n, 2, n, 2), np.eye(m, dtype=np.int64))
    return hull_pair(name, np.concatenate([x.reshape(-1, 2 * m * n, 2 * m * n) for x in (left, right)]))


def _of_complexification(name: str, real: str) -> Pair:
    """The complexification of a pair in the list."""
    return complexified(isotropy_irreducible_pair(real), name)


def _of_hermitian_matrices(name: str, _: str) -> Pair:
    """so(3,C) on Hermitian matrices of size 3 by H -> X H + H X*, in so(6,3)."""
    skew = list(linear_matrices(parse_expression("so(3)")))
    pairs = list(product(range(3), repeat=2))
    matrices = np.zeros((6, 9, 9), dtype=np.int64)
    for column, (a, b) in enumerate(pairs):
        h = np.zeros((3, 3), dtype=complex)
        h[a, b], h[b, a] = (1, 1) if a <= b else (1j, -1j)
        for row, x in enumerate([*skew, *(1j * s for s in skew)]):
            image = x @ h + h @ x.conj().T
            matrices[row, :, column] = [int(image[i, j].real if i <= j else image[i, j].imag) for i, j in pairs]
    return hull_pair(name, matrices)


def _named(names: str) -> tuple[tuple[str, str], ...]:
    """Names whose part after the slash is the argument: 'g/name' gives ('g/name', 'name')."""
    return tuple((name, name.partition("/")[2]) for name in names.split())


def _rows() -> Iterator[_Row]:
    """The rows of the list; the first of each group is compact unless the group consists of complex algebras."""
    tensors = (
        *(("su(6)/tensor(su(2),su(3))", "su(2) su(3)"), ("su(4,2)/tensor(su(2),su(2,1))", "su(2) su(2,1)")),
        *(("su(3,3)/tensor(su(1,1),su(3))", "su(1,1) su(3)"), ("su(3,3)/tensor(su(1,1),su(2,1))", "su(1,1) su(2,1)")),
    )
    groups: list[tuple[int, Callable[[str, str], Pair], tuple[tuple[str, str], ...]]] = [
        (6, _of_catalogue, (("g2/su(3)", "g2/su(3)"), ("g2(2)/su(2,1)", "g2(2)/su(2,1)"))),
        (7, _of_module, (("sp(2)/S3(su(2))", "so(3): 3"), ("sp(4,R)/S3(sl(2))", "sl(2,R): 3"))),
        (7, _of_catalogue, (("so(7)/g2", "so(7)/g2"), ("spin(4,3)/g2(2)", "spin(4,3)/g2(2)"))),
        (11, principal_pair, (("g2/principal(so(3))", "so(3)"), ("g2(2)/principal(sl(2))", "sl(2,R)"))),
        (15, linear_pair, _named("sp(3)/tensor(sp(1),so(3)) sp(2,1)/tensor(sp(1),so(2,1))")),
        (20, _of_module, (("so(8)/ad(su(3))", "su(3): 1,1"), ("so(4,4)/ad(su(2,1))", "su(2,1): 1,1"))),
        (24, _of_complex_tensor, tensors),
        (27, linear_pair, _named(" ".join(f"sp({a})/tensor(sp(1),so({a}))" for a in ("4", "3,1", "2,2")))),
        (27, _of_module, (("su(6)/S2(su(3))", "su(3): 2,0"), ("su(4,2)/S2(su(2,1))", "su(2,1): 2,0"))),
    ]
    for dimension, build, named in groups:
        yield from (_Row(dimension, name, build, argument, i == 0) for i, (name, argument) in enumerate(named))
    for dimension, build, names in (
        (15, _of_catalogue, "sp(6,R)/tensor(sl(2),so(3))"),
        (15, linear_pair, "sp(6,R)/tensor(sl(2),so(2,1))"),
        (24, _of_catalogue, "sl(6)/tensor(sl(2),sl(3))"),
        (24, linear_pair, "sl(3,H)/tensor(sp(1),sl(3))"),
        (27, _of_catalogue, "sp(8,R)/tensor(sl(2),so(4))"),
        (27, linear_pair, "sp(8,R)/tensor(sl(2),so(3,1)) sp(8,R)/tensor(sl(2),so(2,2))"),
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
