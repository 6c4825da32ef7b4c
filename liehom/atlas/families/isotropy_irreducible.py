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
from typing import NamedTuple

import numpy as np

from liehom.atlas.families.irreducible_subalgebras import (
    complexified,
    hull_pair,
    linear_pair,
    module_pair,
    principal_pair,
)
from liehom.atlas.recipe import Recipe
from liehom.catalog import pair as named_pair
from liehom.catalog.linear import linear_matrices
from liehom.catalog.names import parse_expression
from liehom.errors import CatalogError, InputError
from liehom.representations import Pair

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
    return row.build(name, row.argument)


def _of_catalogue(_: str, name: str) -> Pair:
    return named_pair(name)


def _of_module(name: str, argument: str) -> Pair:
    """The pair of a module, given as 'form: weight', in its classical hull."""
    form, weight = argument.split(": ")
    return module_pair(name, form, tuple(int(x) for x in weight.split(",")))


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
    return hull_pair(name, matrices)


def _named(names: str) -> tuple[tuple[str, str], ...]:
    """Names whose part after the slash is the argument: 'g/name' gives ('g/name', 'name')."""
    return tuple((name, name.partition("/")[2]) for name in names.split())


def _rows() -> Iterator[_Row]:
    """The rows of the list; the first of each group is compact unless the group consists of complex algebras."""
    groups: list[tuple[int, Callable[[str, str], Pair], tuple[tuple[str, str], ...]]] = [
        (6, _of_catalogue, (("g2/su(3)", "g2/su(3)"), ("g2(2)/su(2,1)", "g2(2)/su(2,1)"))),
        (7, _of_module, (("sp(2)/S3(su(2))", "so(3): 3"), ("sp(4,R)/S3(sl(2))", "sl(2,R): 3"))),
        (7, _of_catalogue, (("so(7)/g2", "so(7)/g2"), ("spin(4,3)/g2(2)", "spin(4,3)/g2(2)"))),
        (11, principal_pair, (("g2/principal(so(3))", "so(3)"), ("g2(2)/principal(sl(2))", "sl(2,R)"))),
        (15, linear_pair, _named("sp(3)/tensor(sp(1),so(3)) sp(2,1)/tensor(sp(1),so(2,1))")),
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
            linear_pair,
            _named("sp(4)/tensor(sp(1),so(4)) sp(3,1)/tensor(sp(1),so(3,1)) sp(2,2)/tensor(sp(1),so(2,2))"),
        ),
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
