"""Jordan decompositions and sl2-triples by their defining relations; nilpotent orbits against known numbers."""

import random

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import CatalogError, InputError, LimitError, UndecidedError
from liehom.exact.algebra.structure.centroid import evaluate
from liehom.exact.algebra.structure.nilpotent import _real_diagrams
from liehom.exact.scalars.exact_field import as_exact
from liehom.exact.scalars.polynomial import Polynomial
from liehom.testing import random_unimodular

orbits = lh.algebra.nilpotent_orbits
SEMISIMPLE = [lh.sl(3), lh.so(3, 2), lh.su(2, 1), lh.simple("G2"), lh.sl(2).over(lh.number_field("sqrt(2)"))]
SIMPLE_TYPES = ["A1", "A2", "A4", "A7", "B2", "B3", "B5", "C3", "C4", "D4", "D5", "D6", "G2", "F4", "E6", "E7", "E8"]
# dual Coxeter numbers h: the minimal orbit has dimension 2 h - 2
DUAL_COXETER = {"A": lambda r: r + 1, "B": lambda r: 2 * r - 1, "C": lambda r: r + 1, "D": lambda r: 2 * r - 2}
DUAL_COXETER |= {"E": lambda r: {6: 12, 7: 18, 8: 30}[r], "F": lambda r: 9, "G": lambda r: 4}
elements = st.lists(st.integers(-2, 2), min_size=14, max_size=14)
seeds = st.integers(0, 99)


def scrambled(g: lh.LieAlgebra, seed: int) -> lh.LieAlgebra:
    return g.change_of_basis(random_unimodular(g.dimension, random.Random(seed)))


def power(g: lh.LieAlgebra, x: object, n: int) -> np.ndarray:
    return np.linalg.matrix_power(np.array(g.ad(x).to_rows(), dtype=object), n)


def is_semisimple(g: lh.LieAlgebra, x: object) -> bool:
    """Whether the product of the irreducible factors of the characteristic polynomial annihilates ad x."""
    action = as_exact(g.ad(x))
    product = g.field.identity(g.dimension)
    for f, _ in Polynomial(g.field, action.characteristic_coefficients()).factor():
        product = product @ evaluate(f, action)
    return product.is_zero()


# -- Jordan decompositions -------------------------------------------------------------------------------------------
@settings(max_examples=25)
@given(st.sampled_from([*SEMISIMPLE, lh.gl(3)]), seeds, elements)
def test_jordan_parts_commute_and_are_semisimple_and_nilpotent(g: lh.LieAlgebra, seed: int, x: list[int]) -> None:
    g = scrambled(g, seed)
    y = g.row(x[: g.dimension]).row(0)
    s, n = g.jordan_decomposition(y)
    assert list(s + n) == y and not any(g.bracket(s, n))
    assert not power(g, n, g.dimension).any() and n in g.derived_subalgebra()
    assert is_semisimple(g, s)


@settings(max_examples=15)
@given(seeds, st.sampled_from([(1, 1, 2), (2, 2, 2), (3, 3, -1), (0, 0, 0)]))
def test_parts_of_a_matrix_with_jordan_blocks_are_those_of_the_matrix(seed: int, values: tuple[int, ...]) -> None:
    g = lh.gl(3)  # e_(3 i + j) has the one entry (i, j)
    basis = random_unimodular(9, random.Random(seed))
    k = g.change_of_basis(basis)
    back = lh.QQ.matrix(basis).inverse()
    diagonal, block = np.zeros(9, dtype=int), np.zeros(9, dtype=int)
    diagonal[[0, 4, 8]], block[1] = values, 5
    parts = k.jordan_decomposition((lh.QQ.matrix([(diagonal + block).tolist()]) @ back).row(0))
    assert [(lh.QQ.matrix([list(x)]) @ lh.QQ.matrix(basis)).row(0) for x in parts] == [list(diagonal), list(block)]


def test_decompositions_that_do_not_exist_or_are_not_unique_raise() -> None:
    with pytest.raises(InputError, match="derivation that is not inner"):
        lh.low_dimensional(3, 2).jordan_decomposition([0, 0, 1])
    with pytest.raises(InputError, match="not reductive and has a centre"):
        lh.heisenberg(1).jordan_decomposition([1, 0, 0])
    with pytest.raises(UndecidedError):
        lh.sl(2).over(lh.RR).jordan_decomposition([1, 0, 0])
    s, n = lh.algebra.affine(1).jordan_decomposition([1, 1])  # centre 0, and not reductive
    assert list(s + n) == [1, 1] and not n.any()


# -- sl2-triples -----------------------------------------------------------------------------------------------------
@settings(max_examples=25)
@given(st.sampled_from(["A2", "A3", "B2", "B3", "G2"]), seeds, st.lists(st.integers(-2, 2), min_size=9, max_size=9))
def test_triples_satisfy_their_relations(name: str, seed: int, weights: list[int]) -> None:
    natural = lh.chevalley(name)
    count = len(lh.root_system(name).positive_roots)
    x = {f"e{i + 1}": weights[i] for i in range(count)}
    basis = random_unimodular(natural.dimension, random.Random(seed))
    g = natural.change_of_basis(basis)
    row = (natural.row(x) @ lh.QQ.matrix(basis).inverse()).row(0)
    if not any(row):
        return
    h, e, f = g.sl2_triple(row)
    assert list(e) == row and list(g.bracket(e, f)) == list(h)
    assert list(g.bracket(h, e)) == list(2 * e) and list(g.bracket(h, f)) == list(-2 * f)
    assert g.ad(e).rank() in {orbit.dimension for orbit in orbits(name)}


def test_elements_without_a_triple_raise_with_the_reason() -> None:
    g = lh.sl(2)
    for x, why in (([0, 0, 1], "not nilpotent"), ([1, -1, 0], "not nilpotent"), ([0, 0, 0], "it is 0")):
        with pytest.raises(InputError, match=why):
            g.sl2_triple(x)
    with pytest.raises(InputError, match="in a semisimple algebra"):
        lh.euclidean(3).sl2_triple([0, 0, 0, 1, 0, 0])
    with pytest.raises(UndecidedError):
        g.over(lh.RR).sl2_triple([1, 0, 0])
    assert lh.gl(2).sl2_triple([0, 1, 0, 0])[0].tolist() == [1, 0, 0, -1]


# -- complex orbits --------------------------------------------------------------------------------------------------
# Numbers with the zero orbit. In type A they are numbers of partitions, in exceptional types those of Collingwood and
# McGovern, 8.4.
NUMBERS = {"A1": 2, "A2": 3, "A4": 7, "A7": 22, "G2": 5, "F4": 16, "E6": 21, "E7": 45, "E8": 70}


@pytest.mark.parametrize("name", NUMBERS)
def test_number_of_complex_orbits(name: str) -> None:
    assert len(orbits(name)) == NUMBERS[name] == len({orbit.diagram for orbit in orbits(name)})


@pytest.mark.parametrize("name", SIMPLE_TYPES)
def test_minimal_subregular_and_principal_orbits(name: str) -> None:
    system = lh.root_system(name)
    dimensions = [orbit.dimension for orbit in orbits(name)]
    assert dimensions[0] == 0 and dimensions[1] == 2 * DUAL_COXETER[name[0]](system.rank) - 2
    assert dimensions[-1] == system.number_of_roots and orbits(name)[-1].diagram == (2,) * system.rank
    if system.rank > 1:
        assert dimensions[-2] == system.number_of_roots - 2 and dimensions.count(dimensions[-2]) == 1


@pytest.mark.parametrize("name", ["A3", "A6", "B3", "B4", "C3", "C5", "D4", "D6"])
def test_dimensions_by_dual_partitions(name: str) -> None:
    """The centralizer by the columns and the odd rows of the diagram (Collingwood and McGovern, 6.1)."""
    letter, dimension = name[0], lh.root_system(name).number_of_roots + lh.root_system(name).rank
    for orbit in orbits(name):
        p = orbit.partition
        columns = sum(sum(d > i for d in p) ** 2 for i in range(p[0]))
        odd = sum(d % 2 for d in p)
        centralizer = columns - 1 if letter == "A" else (columns + (odd if letter == "C" else -odd)) // 2
        assert orbit.dimension == dimension - centralizer


def test_two_presentations_of_one_type_have_the_same_orbits() -> None:
    assert [x.dimension for x in orbits("D3")] == [x.dimension for x in orbits("A3")]
    assert sorted((x.dimension, x.diagram[::-1]) for x in orbits("C2")) == [
        (x.dimension, x.diagram) for x in orbits("B2")
    ]
    very_even = [x for x in orbits("D4") if x.partition == (2, 2, 2, 2)]
    assert [(x.numeral, x.diagram) for x in very_even] == [("I", (0, 0, 0, 2)), ("II", (0, 0, 2, 0))]


@pytest.mark.parametrize("name", ["A3", "B3", "C3", "D4", "G2", "F4"])
def test_each_diagram_is_that_of_a_triple(name: str) -> None:
    """A generic e in g_2 has a triple, and its dim [e, g] is the dimension of the orbit."""
    g, roots, rng = lh.chevalley(name), lh.root_system(name).root_matrix(), random.Random(name)
    for orbit in orbits(name)[1:]:
        values = [0] * len(orbit.diagram) + (roots @ orbit.diagram).tolist()
        e = [rng.randint(1, 50) if v == 2 else 0 for v in values]
        assert g.ad(e).rank() == orbit.dimension
        h, _, f = g.sl2_triple(e)
        assert list(g.bracket(e, f)) == list(h)


# -- real orbits -----------------------------------------------------------------------------------------------------
def count(kind: str, numbers: tuple[int, ...], letter: str = "") -> int:
    return sum(times for _, _, times in _real_diagrams(kind, numbers, letter))


# algebras in several series: the number of real orbits does not depend on the series
COINCIDENCES = [
    [("so", (2, 1), ""), ("sl", (2,), "R"), ("su", (1, 1), ""), ("sp", (2,), "R")],
    [("so", (3, 2), ""), ("sp", (4,), "R")],
    [("so", (4, 1), ""), ("sp", (1, 1), "")],
    [("so", (3, 3), ""), ("sl", (4,), "R")],
    [("so", (5, 1), ""), ("sl", (2,), "H")],
    [("so", (4, 2), ""), ("su", (2, 2), "")],
    [("so*", (6,), ""), ("su", (3, 1), "")],
    [("so*", (8,), ""), ("so", (6, 2), "")],
]


@pytest.mark.parametrize("names", COINCIDENCES, ids=str)
def test_coincidences_have_equally_many_orbits(names: list[tuple[str, tuple[int, ...], str]]) -> None:
    assert len({count(*name) for name in names}) == 1


def test_numbers_of_small_real_forms() -> None:
    assert count("so", (2, 2)) == 9 and count("so*", (4,)) == 3  # sl(2,R) + sl(2,R), so(3) + sl(2,R)
    assert [len(orbits(name)) for name in ("sl(2,R)", "sl(2,C)", "so(3)", "su(2,1)", "e7", "sl(4,R)")] == [
        3,
        2,
        1,
        4,
        1,
        7,
    ]
    assert orbits("g2(C)")[-1].dimension == 24
    assert [x.numeral for x in orbits("so(4,4)") if x.partition == (4, 4)] == ["I", "II", "III", "IV"]


@pytest.mark.parametrize("name", ["A3", "A4", "A5", "B2", "B4", "C3", "C4", "D4", "D5", "D6"])
def test_complex_orbits_with_real_points_are_those_that_match_the_satake_diagram(name: str) -> None:
    """Zero at black nodes, equal at joined ones (see Okuda, Smallest complex nilpotent orbits with real points)."""
    complex_orbits = {x.diagram: x for x in orbits(name)}
    for form in lh.real_forms(name):
        satake, real = form.satake, orbits(form.name)
        assert {x.diagram for x in real} == {
            d
            for d in complex_orbits
            if not any(d[i] for i in satake.black)
            and all(len({d[i] for i in nodes}) == 1 for nodes in satake.restricted_nodes)
        }
        assert all(x.dimension == complex_orbits[x.diagram].dimension for x in real)


def test_an_algebra_lists_the_orbits_of_its_real_form() -> None:
    assert scrambled(lh.so(1, 3), 1).nilpotent_orbits() == orbits("sl(2,C)")
    assert lh.chevalley("B2").nilpotent_orbits() == orbits("so(3,2)")
    assert [x.dimension for x in lh.abelian(0).nilpotent_orbits()] == [0]
    for g in (lh.so(4), lh.euclidean(3), lh.gl(2), lh.abelian(1)):
        with pytest.raises(InputError, match="is not simple"):
            g.nilpotent_orbits()


def test_names_without_a_list_raise() -> None:
    for name in ("A1 + A2", "D2", "so(4)", "X5", 3):
        with pytest.raises(CatalogError):
            orbits(name)
    with pytest.raises(CatalogError, match="of e7\\(7\\) are not known"):
        orbits("e7(7)")
    with pytest.raises(LimitError):
        orbits("A90")
