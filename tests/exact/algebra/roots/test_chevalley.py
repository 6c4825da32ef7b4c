"""The Chevalley basis of every type: integers, N = +-(p + 1), the Jacobi identity."""

import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.exact.algebra.core.jacobi import prove_jacobi
from liehom.exact.algebra.roots.chevalley import chevalley_constants, root_brackets
from liehom.exact.algebra.roots.root_system import RootSystem, root_system
from tests.clock import seconds
from tests.sampling import examples

SMALL = ["A1", "A2", "A3", "A4", "B2", "B3", "B4", "C3", "C4", "D4", "D5", "F4", "G2", "E6", "A1 + G2", "B2 + C3 + A2"]
LARGE = [f"{x}{n}" for x in "ABCD" for n in range(5, 9)] + ["E7", "E8"]


@pytest.mark.parametrize("name", SMALL + LARGE)
def test_jacobi_identity_and_split_form(name):
    g = lh.chevalley(name)
    prove_jacobi(g.table, g.basis_names)
    system = root_system(name)
    count = len(system.positive_roots)
    assert g.name == system.type
    if g.dimension < 140:
        assert g.killing_signature() == (system.rank + count, count, 0)


@pytest.mark.parametrize("name", [*SMALL, "E7", "E8", "C7", "B6"])
def test_numbers_are_those_of_root_strings(name):
    system = root_system(name)
    roots, half = system.roots, len(system.positive_roots)
    brackets = root_brackets(system)
    numbers = {(a, b): n for a, b, _, n in zip(*(part.tolist() for part in brackets), strict=True)}
    for (a, b), number in numbers.items():
        p, lower = 0, roots[b]
        while system.is_root(lower := tuple(x - y for x, y in zip(lower, roots[a], strict=True))):
            p += 1
        assert abs(number) == p + 1
        assert numbers[b, a] == -number
        assert numbers[(a + half) % (2 * half), (b + half) % (2 * half)] == -number
    pairs = sum(system.is_root([x + y for x, y in zip(a, b, strict=True)]) for a in roots for b in roots)
    assert len(numbers) == pairs


@pytest.mark.parametrize("name", ["A3", "B3", "C3", "G2", "A1 + B2"])
def test_brackets_with_the_cartan_subalgebra_and_coroots(name):
    g, system = lh.chevalley(name), root_system(name)
    rank, count = system.rank, len(system.positive_roots)
    unit = [[int(i == j) for j in range(g.dimension)] for i in range(g.dimension)]
    for place, root in enumerate(system.roots):
        for i, simple in enumerate(system.simple_roots):
            expected = [system.pairing(root, simple) * x for x in unit[rank + place]]
            assert g.bracket(unit[i], unit[rank + place]).tolist() == expected
    for place, root in enumerate(system.positive_roots):
        bracket = g.bracket(unit[rank + place], unit[rank + count + place]).tolist()
        assert bracket == [*system.coroot(root), *[0] * (2 * count)]


@settings(deadline=None, max_examples=examples(10))
@given(st.sampled_from(["B3", "C3", "F4", "A2 + G2", "D4"]), st.randoms(use_true_random=False))
def test_any_numbering_of_the_simple_roots_will_do(name, randomness):
    matrix = root_system(name).cartan
    order = list(range(len(matrix)))
    randomness.shuffle(order)
    table = chevalley_constants(RootSystem([[matrix[i][j] for j in order] for i in order]))
    prove_jacobi(table, tuple(f"e{i}" for i in range(table.dimension)))
    assert table.den == 1


def test_jacobi_identity_detects_a_wrong_sign():
    table = chevalley_constants(root_system("F4"))
    place = next(x for x in range(len(table)) if table.i[x] >= 4)
    table.parts[0][place] *= -1
    with pytest.raises(lh.errors.JacobiError):
        prove_jacobi(table, tuple(f"e{i}" for i in range(52)))


def test_names_of_the_basis():
    assert lh.chevalley("A2").basis_names == ("h1", "h2", "e1", "e2", "e3", "f1", "f2", "f3")
    assert lh.chevalley("0").dimension == 0


def test_e8_is_quick():
    assert seconds(lambda: lh.chevalley("E8")) < 0.3


def test_unknown_type_raises_catalog_error():
    with pytest.raises(lh.errors.CatalogError, match="known: A1"):
        lh.chevalley("E9")
