"""Root systems and Dynkin diagrams: counts, reflections, names, refusals."""

import random
from math import factorial

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.exact.algebra.roots.root_system import RootSystem, diagram_components, isomorphisms, root_system
from tests.clock import seconds
from tests.sampling import examples

CONNECTED = [
    *(f"A{n}" for n in range(1, 9)), *(f"B{n}" for n in range(2, 9)), *(f"C{n}" for n in range(3, 9)),
    *(f"D{n}" for n in range(4, 9)), "E6", "E7", "E8", "F4", "G2",
]  # fmt: skip
EXCEPTIONAL = {"E6": (36, 51840), "E7": (63, 2903040), "E8": (120, 696729600), "F4": (24, 1152), "G2": (6, 12)}


def counts(name):
    """Positive roots and order of the Weyl group, from the textbook."""
    if name in EXCEPTIONAL:
        return EXCEPTIONAL[name]
    letter, n = name[0], int(name[1:])
    if letter == "A":
        return n * (n + 1) // 2, factorial(n + 1)
    if letter == "D":
        return n * (n - 1), 2 ** (n - 1) * factorial(n)
    return n * n, 2**n * factorial(n)


@pytest.mark.parametrize("name", CONNECTED)
def test_counts_and_orders(name):
    roots = root_system(name)
    assert (len(roots.positive_roots), roots.weyl_group_order()) == counts(name)
    assert roots.number_of_roots == len(set(roots.roots)) == 2 * len(roots.positive_roots)
    assert roots.type == name
    heights = [(sum(a), tuple(-x for x in a)) for a in roots.positive_roots]
    assert heights == sorted(heights)
    assert roots.roots[len(heights) :] == tuple(tuple(-x for x in a) for a in roots.positive_roots)


@pytest.mark.parametrize("name", ["A4", "B4", "C4", "D5", "E6", "F4", "G2", "A1 + B2"])
def test_roots_satisfy_the_axioms_of_a_root_system(name):
    """Reflections permute the roots, pairings are integers, and the norms are those of the reflections."""
    system = root_system(name)
    roots = set(system.roots)
    for beta in system.positive_roots:
        assert {system.reflection(alpha, beta) for alpha in roots} == roots
        assert system.norm(beta) in (2, 4, 6)
        assert system.pairing(beta, beta) == 2
        assert sum(c * system.pairing(s, beta) for c, s in zip(beta, system.simple_roots, strict=True)) == 2
        coroot = system.coroot(beta)
        for alpha in system.simple_roots:
            by_coroot = sum(c * system.pairing(alpha, s) for c, s in zip(coroot, system.simple_roots, strict=True))
            assert system.pairing(alpha, beta) == by_coroot
    for highest in system.highest_roots:
        assert not any(tuple(np.add(highest, s)) in roots for s in system.simple_roots)


def test_weyl_group_order_by_generating_the_group():
    for name in ("A3", "B3", "C3", "D4", "G2", "A1 + B2"):
        system = root_system(name)
        start = tuple(range(1, system.rank + 1))  # regular: the orbit of a regular weight is the group
        seen, stack = {start}, [start]
        while stack:
            weight = stack.pop()
            for i, row in enumerate(system.cartan):
                moved = tuple(x - weight[i] * a for x, a in zip(weight, row, strict=True))
                if moved not in seen:
                    seen.add(moved)
                    stack.append(moved)
        assert len(seen) == system.weyl_group_order()
        assert {system.dominant(w) for w in seen} == {start}


@pytest.mark.parametrize("name", ["A3", "B4", "C5", "D6", "E7", "F4", "G2"])
def test_fundamental_weights_pair_to_the_identity(name):
    system = root_system(name)
    rows = system.fundamental_weights()
    for i, row in enumerate(rows):
        pairings = [sum(x * a[j] for x, a in zip(row, system.cartan, strict=True)) for j in range(system.rank)]
        assert pairings == [int(i == j) for j in range(system.rank)]


SUMS = st.lists(st.sampled_from(["A1", "A2", "A4", "B2", "B3", "C3", "D4", "E6", "F4", "G2"]), min_size=1, max_size=3)


@settings(deadline=None, max_examples=examples(25))
@given(SUMS, st.randoms(use_true_random=False))
def test_the_type_does_not_depend_on_the_numbering(names, randomness):
    matrix = lh.algebra.cartan_matrix("+".join(names))
    order = list(range(len(matrix)))
    randomness.shuffle(order)
    shuffled = [[matrix[i][j] for j in order] for i in order]
    assert RootSystem(shuffled).type == " + ".join(sorted(names))
    components = diagram_components(shuffled)
    assert sorted(i for _, nodes in components for i in nodes) == sorted(order)
    for name, nodes in components:
        assert tuple(tuple(shuffled[i][j] for j in nodes) for i in nodes) == lh.algebra.cartan_matrix(name)


@pytest.mark.parametrize(("alias", "name"), [
    ("B1", "A1"), ("C1", "A1"), ("C2", "B2"), ("D2", "A1 + A1"), ("D3", "A3"), ("0", "0"),
    ("G2+A10+A9", "A9 + A10 + G2"),
])  # fmt: skip
def test_low_rank_types_have_one_name(alias, name):
    assert root_system(alias).type == name


def test_b_and_c_are_distinguished():
    b, c = lh.algebra.cartan_matrix("B4"), lh.algebra.cartan_matrix("C4")
    assert b == tuple(zip(*c, strict=True))
    assert RootSystem(b).type == "B4"
    assert RootSystem(c).type == "C4"
    assert root_system("B4").highest_roots == ((1, 2, 2, 2),)
    assert root_system("C4").highest_roots == ((2, 2, 2, 1),)


def test_the_simple_root_that_sympy_gets_wrong():
    """The roots of G2 are integral combinations of the simple ones, the highest is 3 a + 2 b."""
    g2 = root_system("G2")
    assert g2.highest_roots == ((3, 2),)
    assert sorted(g2.norm(a) for a in g2.positive_roots) == [2, 2, 2, 6, 6, 6]


def test_automorphisms_of_diagrams():
    sizes = {"A1": 1, "A5": 2, "B3": 1, "D4": 6, "D5": 2, "E6": 2, "E7": 1, "F4": 1, "G2": 1, "A2 + A2": 8}
    for name, size in sizes.items():
        matrix = lh.algebra.cartan_matrix(name)
        automorphisms = isomorphisms(matrix, matrix)
        assert len(automorphisms) == size
        for p in automorphisms:
            assert tuple(tuple(matrix[i][j] for j in p) for i in p) == matrix


def test_the_diagram_is_a_graph_with_weights():
    diagram = lh.algebra.dynkin_diagram(lh.algebra.cartan_matrix("F4"))
    assert sorted(diagram.edges(data="entry")) == [
        *((0, 1, 1), (1, 0, 1), (1, 2, 2), (2, 1, 1)),
        *((2, 3, 1), (3, 2, 1)),
    ]


@pytest.mark.parametrize("matrix", [
    [[2, -2], [-2, 2]],  # affine
    [[2, -1, -1], [-1, 2, -1], [-1, -1, 2]],  # affine triangle
    [[2, -4], [-1, 2]],
    [[2, -1, -1], [-2, 2, -1], [-1, -1, 2]],  # no inner product
    [[2, -1], [0, 2]],
    [[2, 1], [1, 2]],
    [[3]],
    [[2, -1]],
    [[2, -0.5], [-1, 2]],
])  # fmt: skip
def test_invalid_cartan_matrix_raises_input_error(matrix):
    with pytest.raises(lh.errors.InputError):
        RootSystem(matrix)


@pytest.mark.parametrize("name", ["E9", "H3", "A0", "D1", "F5", "", "A", "A2 - A1", "G3"])
def test_unknown_type_raises_catalog_error(name):
    with pytest.raises(lh.errors.CatalogError, match="known: A1"):
        root_system(name)


@pytest.mark.parametrize(
    ("name", "kind"), [("su(4)", "A3"), ("sl(2)", "A1"), ("so(9)", "B4"), ("so(10)", "D5"), ("sp(3)", "C3")]
)
def test_the_name_of_an_algebra_is_not_a_type(name, kind):
    with pytest.raises(lh.errors.CatalogError, match=f"write '{kind}'"):
        root_system(name)
    with pytest.raises(lh.errors.CatalogError, match="known: A1"):
        root_system("so(2)")


def test_vector_of_wrong_length_raises_shape_error():
    system = root_system("B2")
    with pytest.raises(lh.errors.ShapeError):
        system.norm((1, 0, 0))
    with pytest.raises(lh.errors.InputError, match="not a root"):
        system.pairing((1, 0), (5, 1))


def test_empty_root_system_has_rank_0():
    empty = RootSystem(())
    assert (empty.rank, empty.type, empty.roots, empty.weyl_group_order()) == (0, "0", (), 1)


def test_equality_and_hash_are_those_of_the_matrix():
    assert len({root_system("A2"), RootSystem([[2, -1], [-1, 2]]), root_system("B2")}) == 2


def test_e8_is_quick():
    assert seconds(lambda: root_system("E8")) < 0.1


def test_random_weights_become_dominant():
    randomness = random.Random(5)
    system = root_system("E6")
    for _ in range(20):
        weight = [randomness.randint(-5, 5) for _ in range(6)]
        dominant = system.dominant(weight)
        assert min(dominant) >= 0
        # the invariant norm is the same: (w, w) with w = sum of coefficients times fundamental weights
        inverse = np.array(system.fundamental_weights())
        assert np.array(weight) @ inverse @ weight == np.array(dominant) @ inverse @ dominant
