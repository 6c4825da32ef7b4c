"""Parabolic subalgebras by crossed simple restricted roots: dimensions, laws, bases, fields, and errors."""

import itertools
import random
from typing import Any

import pytest

import liehom as lh
from liehom.base.errors import InputError, UndecidedError
from liehom.exact.algebra.involutions.parabolic import restricted_root_spaces
from liehom.testing import random_unimodular
from tests.exact.algebra.involutions.test_extended_involution import in_dense_basis, orthogonal, unitary

FORMS = (
    *("sl(2,R)", "sl(3,R)", "sl(4,R)", "su(2,1)", "su(2,2)", "su(3,1)", "sl(2,H)", "so(3,2)", "so(4,1)", "so(4,3)"),
    *("sp(6,R)", "sp(2,1)", "so(4,4)", "so(5,3)", "so(6,2)", "so(7,1)", "g2(2)", "sl(2,C)", "sl(3,C)", "so(5,C)"),
)

# codimensions of the maximal parabolic subalgebras, from the homogeneous spaces: dimension of the space of lines, of
# isotropic subspaces, of G2/P1 and G2/P2, of the boundaries of symmetric spaces
CODIMENSIONS = {
    "sl(5,R)": (4, 6, 6, 4), "sl(3,C)": (4, 4), "sl(2,H)": (4,), "sl(3,H)": (8, 8), "su(3,2)": (7, 8),
    "su(2,2)": (5, 4), "so(4,3)": (5, 7, 6), "so(5,2)": (5, 7), "so(6,1)": (5,), "so(4,4)": (6, 9, 6, 6),
    "so(5,3)": (6, 9, 9), "sp(6,R)": (5, 7, 6), "sp(2,1)": (7,), "sp(2,2)": (11, 10), "g2(2)": (5, 5),
    "g2(C)": (10, 10), "f4(-20)": (15,), "f4(4)": (15, 20, 20, 15), "e6(-26)": (16, 16), "e6(-14)": (24, 21),
    "e6(2)": (24, 21, 31, 29), "e7(-25)": (33, 42, 27),
}  # fmt: skip


def parabolics(g: lh.LieAlgebra) -> dict[tuple[int, ...], lh.Subalgebra]:
    nodes = range(g.real_rank())
    subsets = itertools.chain.from_iterable(itertools.combinations(nodes, k) for k in range(len(nodes) + 1))
    return {crossed: g.parabolic_subalgebra(crossed) for crossed in subsets}


def nilradical(h: lh.Subalgebra) -> lh.Subalgebra:
    """The Killing complement of a parabolic subalgebra, proved to be a subalgebra of it."""
    g = h.algebra
    subalgebra = g.subalgebra((g.killing_form() @ h.basis.T).T.null_space())
    assert h.includes(subalgebra)
    return subalgebra


def invariants(h: lh.Subalgebra) -> tuple[Any, ...]:
    """What conjugate parabolic subalgebras have in common: the series of the nilradical and the Levi factor."""
    inner = h.as_algebra()
    series = [part.dimension for part in nilradical(h).as_algebra().lower_central_series()]
    return series, inner.real_form(), h.dimension


@pytest.mark.parametrize("name", FORMS)
def test_each_subset_gives_another_self_normalizing_subalgebra_with_nilpotent_killing_complement(name: str) -> None:
    g = lh.simple(name)
    subalgebras = parabolics(g)
    assert len({h.subspace for h in subalgebras.values()}) == 2 ** g.real_rank()
    for crossed, h in subalgebras.items():
        assert g.subalgebra(h.basis) == h  # closed
        if crossed:
            nil = nilradical(h)
            assert nil.as_algebra().is_nilpotent() and nil.dimension == h.codimension
            assert g.normalizer(nil) == h
    for small, large in itertools.product(subalgebras, repeat=2):
        assert subalgebras[small].includes(subalgebras[large]) == (set(small) <= set(large))


@pytest.mark.parametrize("name", CODIMENSIONS)
def test_codimensions_of_maximal_parabolic_subalgebras(name: str) -> None:
    g = lh.simple(name)
    assert tuple(g.parabolic_subalgebra([i]).codimension for i in range(g.real_rank())) == CODIMENSIONS[name]


@pytest.mark.parametrize("name", FORMS)
def test_minimal_parabolic_subalgebra_has_a_compact_anisotropic_part(name: str) -> None:
    g, form = lh.simple(name), lh.RealForm.of_name(name)
    decomposition = restricted_root_spaces(g)
    assert decomposition.centralizer.nrows == form.satake.anisotropic_dimension + form.real_rank
    h = g.parabolic_subalgebra(range(form.real_rank))
    assert h.codimension == (form.dimension - decomposition.centralizer.nrows) // 2
    assert g.killing_form().signature() == (form.dimension - form.compact_dimension, form.compact_dimension, 0)


@pytest.mark.parametrize("sizes", [(1,), (1, 1), (2, 1), (1, 2, 1), (2, 3), (1, 1, 1, 1)])
def test_crossed_roots_of_sl_are_the_ends_of_blocks(sizes: tuple[int, ...]) -> None:
    n = sum(sizes)
    block = [b for b, size in enumerate(sizes) for _ in range(size)]
    off = [(i, j) for i, j in itertools.product(range(n), repeat=2) if i != j]
    one = lh.QQ.identity(n * n - 1)
    kept = [k for k, (i, j) in enumerate(off) if block[i] <= block[j]] + list(range(len(off), n * n - 1))
    h = lh.algebra.parabolic_subalgebra(*sizes)
    assert h == lh.sl(n).subalgebra(one.select(rows=kept)) and h.basis == one.select(rows=kept)


@pytest.mark.parametrize(("pair", "crossed"), [
    ("sl(4)/P1", [0]), ("sl(4)/P2", [1]), ("sl(3)/B", [0, 1]), ("sl(3,C)/P1", [0]), ("sl(2,H)/P1", [0]),
    ("so(4,3)/P1", [0]), ("so(4,3)/P2", [1]), ("so(4,3)/P3", [2]), ("so(5,3)/P2", [1]), ("so(4,1)/P1", [0]),
    ("su(2,1)/P1", [0]), ("su(3,2)/P1", [0]), ("su(3,2)/P2", [1]), ("sp(2,1)/P1", [0]), ("sp(2,2)/P2", [1]),
    ("sp(6,R)/P1", [0]), ("sp(6,R)/P2", [1]), ("sp(6,R)/P3", [2]), ("sp(4,R)/P1", [1]), ("sp(4,R)/P2", [0]),
    ("g2(2)/P1", [0]), ("e6(6)/P1", [0]), ("e6(-26)/P1", [0]), ("so(4,4)/P3", [2, 3]),
])  # fmt: skip
def test_parabolic_subalgebras_of_the_catalogue(pair: str, crossed: list[int]) -> None:
    named = lh.pair(pair).subalgebra
    expected = lh.simple(pair.split("/")[0]).parabolic_subalgebra(crossed)
    assert named.dimension == expected.dimension
    if named.dimension < 40:
        assert invariants(named) == invariants(expected)


@pytest.mark.parametrize("name", ["sl(4,R)", "so(3,2)", "so(4,1)", "su(2,1)", "su(2,2)", "g2(2)", "sl(3,C)", "sl(2,H)"])
@pytest.mark.parametrize("dense", [False, True])
def test_other_bases_give_conjugate_subalgebras(name: str, dense: bool) -> None:
    g = lh.simple(name)
    moved = (
        in_dense_basis(g, 1) if dense else g.change_of_basis(random_unimodular(g.dimension, random.Random(g.dimension)))
    )
    own, other = parabolics(g), parabolics(moved)
    assert [invariants(h) for h in own.values()] == [invariants(h) for h in other.values()]
    for h in other.values():
        assert moved.subalgebra(h.basis) == h


def test_summands_are_numbered_one_after_the_other() -> None:
    g = lh.direct_sum(lh.so(3), lh.sl(3), lh.so(4, 1))
    ranks = [form.real_rank for form in g.real_forms()]
    assert sorted(ranks) == [0, 1, 2]
    codimensions = [g.parabolic_subalgebra([i]).codimension for i in range(3)]
    assert codimensions == ([2, 2, 3] if ranks.index(2) < ranks.index(1) else [3, 2, 2])


def test_torus_of_the_field_decides() -> None:
    """x^2 + y^2 + z^2 - 7 w^2 has no rational zeros, as 7 is not a sum of three squares."""
    g = orthogonal(1, 1, 1, -7)
    with pytest.raises(UndecidedError, match="real number field"):
        g.parabolic_subalgebra([0])
    larger = g.over(lh.number_field("sqrt(7)"))
    h = larger.parabolic_subalgebra([0])
    assert h.codimension == 2 and larger.subalgebra(h.basis) == h


@pytest.mark.parametrize(("algebra", "codimension"), [
    (lambda: orthogonal(1, 1, -2, 3, -5), 3), (lambda: unitary(2, 1, 1, -3), 3),
    (lambda: lh.so(3, 2).over(lh.number_field("sqrt(2)")), 3),
])  # fmt: skip
def test_forms_with_rational_tori(algebra: Any, codimension: int) -> None:
    g = algebra()
    h = g.parabolic_subalgebra([0])
    assert h.codimension == codimension and g.subalgebra(h.basis) == h


def test_compact_algebra_is_its_only_parabolic_subalgebra() -> None:
    g = lh.so(5)
    assert g.parabolic_subalgebra([]).dimension == 10
    with pytest.raises(InputError, match="compact"):
        g.parabolic_subalgebra([0])


@pytest.mark.parametrize("crossed", [[2], [-1], [0.5], ["0"], 0, "01", None, [None], [[0]]])
def test_numbers_that_are_not_simple_restricted_roots_raise_input_error(crossed: Any) -> None:
    with pytest.raises(InputError, match="expected the numbers of crossed simple restricted roots"):
        lh.sl(3).parabolic_subalgebra(crossed)


def test_algebras_without_restricted_roots_raise() -> None:
    with pytest.raises(InputError, match="semisimple"):
        lh.gl(2).parabolic_subalgebra([0])
    with pytest.raises(UndecidedError, match="exact fields"):
        lh.sl(2).over(lh.RR).parabolic_subalgebra([0])


def test_nodes_of_one_restricted_root() -> None:
    nodes = {
        name: lh.RealForm.of_name(name).satake.restricted_nodes for name in ("su(3,2)", "sl(3,H)", "sl(2,C)", "g2")
    }
    assert nodes == {"su(3,2)": ((0, 3), (1, 2)), "sl(3,H)": ((1,), (3,)), "sl(2,C)": ((0, 1),), "g2": ()}
