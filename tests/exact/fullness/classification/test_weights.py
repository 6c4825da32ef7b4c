"""Theorem L, compact part, by enumeration: which representations satisfy the conditions on weights in the proof.

The proof in docs/theory/classification.md covers all ranks. Here the root systems of rank at most 10 and the
exceptional ones are enumerated: every dominant weight of dimension at most 2 + 2 |Phi+|, which is all that the
conditions admit.
"""

import re
from functools import cache
from math import comb
from pathlib import Path

import pytest

import liehom as lh

Weight = tuple[int, ...]
PAGE = Path(__file__).resolve().parents[4] / "docs" / "theory" / "classification.md"
TYPES = [
    *(f"A{n}" for n in range(1, 11)),
    *(f"B{n}" for n in range(2, 11)),  # B2 is C2
    *(f"C{n}" for n in range(3, 11)),
    *(f"D{n}" for n in range(4, 11)),
    *("E6", "E7", "E8", "F4", "G2"),
]
REAL, QUATERNIONIC = 1, -1


def fundamental(system: lh.algebra.RootSystem, *nodes: int) -> Weight:
    """The sum of the fundamental weights of these nodes, which count from 1."""
    return tuple(nodes.count(i + 1) for i in range(system.rank))


def lowered(system: lh.algebra.RootSystem, weight: Weight) -> list[Weight]:
    """The lambda - beta for the positive roots beta with <lambda, beta> > 0, in fundamental coordinates."""
    below = [beta for beta in system.positive_roots if any(x and y for x, y in zip(weight, beta, strict=True))]
    return [
        tuple(x - sum(b * row[i] for b, row in zip(beta, system.cartan, strict=True)) for i, x in enumerate(weight))
        for beta in below
    ]


def count(system: lh.algebra.RootSystem, weight: Weight) -> int:
    """r, the number of positive roots beta with <lambda, beta> > 0."""
    return len(lowered(system, weight))


@cache
def small_modules(name: str) -> tuple[tuple[Weight, int, int], ...]:
    """(lambda, dimension, r) for every lambda != 0 with dimension at most 2 + 2 |Phi+|.

    The dimension grows with lambda, so the search starts at 0 and stops at the bound.
    """
    system = lh.root_system(name)
    bound = 2 + 2 * len(system.positive_roots)
    result: dict[Weight, int] = {}
    todo: list[Weight] = [(0,) * system.rank]
    while todo:
        weight = todo.pop()
        for i in range(system.rank):
            larger = (*weight[:i], weight[i] + 1, *weight[i + 1 :])
            if larger not in result and (dimension := lh.weyl_dimension(name, larger)) <= bound:
                result[larger] = dimension
                todo.append(larger)
    return tuple((weight, dimension, count(system, weight)) for weight, dimension in sorted(result.items()))


def vector(name: str) -> set[Weight]:
    """The standard modules of A_n (with the dual) and C_n, where B2 counts as C2."""
    n = int(name[1:])
    ones = {"A": [1, n], "C": [1], "B": [2] if n == 2 else []}.get(name[0], [])
    return {fundamental(lh.root_system(name), i) for i in ones}


def real_modules(name: str) -> set[Weight]:
    """The representations of real type in the theorem: so(d), g2, spin(7), spin(9)."""
    system = lh.root_system(name)
    nodes: dict[str, list[Weight]] = {
        "A1": [(2,)],  # so(3)
        "A3": [(0, 1, 0)],  # so(6)
        "B2": [(1, 0)],  # so(5)
        "B3": [(1, 0, 0), (0, 0, 1)],  # so(7), spin(7)
        "B4": [(1, 0, 0, 0), (0, 0, 0, 1)],  # so(9), spin(9)
        "D4": [(1, 0, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)],  # so(8) three times
        "G2": [(1, 0)],
    }
    return set(nodes.get(name, [fundamental(system, 1)] if name[0] in "BD" else []))


EXCLUDED = {"A2": (1, 1), "C3": (0, 1, 0), "F4": (0, 0, 0, 1)}
"""Modules of real type and small dimension in which the weight 0 has multiplicity 2, of dimensions 8, 14 and 26."""


@pytest.mark.parametrize("name", TYPES)
def test_highest_vector_generates_at_most_the_module(name: str) -> None:
    for _, dimension, r in small_modules(name):
        assert 1 + r <= dimension


@pytest.mark.parametrize("name", TYPES)
def test_complex_modules_of_dimension_one_plus_r_are_the_vectors_of_a_and_c(name: str) -> None:
    assert {weight for weight, dimension, r in small_modules(name) if dimension == 1 + r} == vector(name)


@pytest.mark.parametrize("name", TYPES)
def test_quaternionic_modules_of_dimension_at_most_two_plus_r_are_the_vectors_of_c(name: str) -> None:
    result = {
        weight
        for weight, dimension, r in small_modules(name)
        if dimension <= 2 + r and lh.representations.frobenius_schur_indicator(name, weight) == QUATERNIONIC
    }
    assert result == (vector(name) if name == "A1" or name[0] != "A" else set())


@pytest.mark.parametrize("name", TYPES)
def test_real_modules_of_dimension_at_most_two_plus_two_r_are_the_listed_ones_and_three_more(name: str) -> None:
    result = {
        weight
        for weight, dimension, r in small_modules(name)
        if dimension <= 2 + 2 * r and lh.representations.frobenius_schur_indicator(name, weight) == REAL
    }
    assert result == real_modules(name) | ({EXCLUDED[name]} if name in EXCLUDED else set())


@pytest.mark.parametrize("name", TYPES)
def test_weights_of_the_listed_real_modules_are_lambda_minus_a_root_up_to_sign(name: str) -> None:
    """The equation (*) of the proof, which is also sufficient."""
    system = lh.root_system(name)
    for weight in real_modules(name):
        half = {weight, *lowered(system, weight)}
        character = lh.representations.character(name, weight)
        assert set(character) == half | {tuple(-x for x in mu) for mu in half}
        assert set(character.values()) == {1}


@pytest.mark.parametrize(("name", "weight"), EXCLUDED.items())
def test_weight_zero_excludes_the_three_other_modules(name: str, weight: Weight) -> None:
    assert lh.representations.character(name, weight)[(0,) * len(weight)] == 2


@pytest.mark.parametrize("pair", ["sl(3,C)/su(3)", "sl(3,H)/sp(3)", pytest.param("affine(f4)", marks=pytest.mark.slow)])
def test_the_three_excluded_modules_are_decided_not_full(pair: str) -> None:
    result = lh.pair(pair)
    verdict = lh.decide_fullness(result)
    assert not verdict.full
    assert lh.verify_certificate(result, verdict.certificate)


@pytest.mark.parametrize("name", [n for n in TYPES if n[0] in "BCFG"])
def test_zero_in_the_short_dominant_module_counts_the_short_simple_roots(name: str) -> None:
    system = lh.root_system(name)
    short = max((b for b in system.positive_roots if system.norm(b) == 2), key=sum)
    weight = tuple(sum(b * row[i] for b, row in zip(short, system.cartan, strict=True)) for i in range(system.rank))
    assert lh.representations.dominant_character(name, weight)[(0,) * system.rank] == system.norms.count(2)


@pytest.mark.parametrize("name", TYPES)
def test_self_dual_modules_with_weight_zero_are_of_real_type(name: str) -> None:
    for weight, _, _ in small_modules(name):
        if (0,) * len(weight) in lh.representations.dominant_character(name, weight):
            assert lh.representations.frobenius_schur_indicator(name, weight) in (0, REAL)


def minuscule(name: str) -> dict[Weight, tuple[int, int, int]]:
    """The table of the page: {lambda: (dimension, r, type)}, type 1, -1 or 0 for real, quaternionic or complex."""
    system, n = lh.root_system(name), int(name[1:])

    def row(node: int, dimension: int, r: int, kind: int) -> tuple[Weight, tuple[int, int, int]]:
        return fundamental(system, node), (dimension, r, kind)

    match name[0]:
        case "A":
            return dict(
                row(k, comb(n + 1, k), k * (n + 1 - k), (-1) ** k if n + 1 == 2 * k else 0) for k in range(1, n + 1)
            )
        case "B":
            return dict([row(n, 2**n, n * (n + 1) // 2, 1 if n % 4 in (0, 3) else -1)])
        case "C":
            return dict([row(1, 2 * n, 2 * n - 1, -1)])
        case "D":
            kind = {0: 1, 2: -1}.get(n % 4, 0)
            spins = [row(node, 2 ** (n - 1), n * (n - 1) // 2, kind) for node in (n - 1, n)]
            return dict([row(1, 2 * n, 2 * n - 2, 1), *spins])
    return {"E6": dict([row(1, 27, 16, 0), row(6, 27, 16, 0)]), "E7": dict([row(7, 56, 27, -1)])}.get(name, {})


@pytest.mark.parametrize("name", TYPES)
def test_table_of_minuscule_weights(name: str) -> None:
    system = lh.root_system(name)
    # the highest coroot, the highest root of the dual system, pairs to 1 with a minuscule fundamental weight
    (marks,) = lh.algebra.RootSystem([list(row) for row in zip(*system.cartan, strict=True)]).highest_roots
    expected = {fundamental(system, i + 1) for i, mark in enumerate(marks) if mark == 1}
    table = minuscule(name)
    assert set(table) == expected
    for weight, (dimension, r, kind) in table.items():
        assert lh.weyl_dimension(name, weight) == dimension == len(lh.representations.weyl_orbit(name, weight))
        assert (count(system, weight), lh.representations.frobenius_schur_indicator(name, weight)) == (r, kind)


def test_table_of_the_page_has_the_seven_families() -> None:
    lines = re.findall(r"^\| \$([A-E])_[n67]\$.*", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert sorted(lines[:7]) == ["A", "B", "C", "D", "D", "E", "E"]


# -- nodes of coefficient 1 ------------------------------------------------------------------------------------


def without(system: lh.algebra.RootSystem, node: int) -> str:
    """The type of the diagram without a node, which counts from 1; '0' if nothing is left."""
    rest = [i for i in range(system.rank) if i != node - 1]
    return lh.algebra.RootSystem([[system.cartan[i][j] for j in rest] for i in rest]).type if rest else "0"


def gradings(name: str) -> dict[int, tuple[str, int]]:
    """{node of coefficient 1: (type without it, dimension of g_1)}."""
    system = lh.root_system(name)
    (highest,) = system.highest_roots
    return {
        i + 1: (without(system, i + 1), sum(1 for beta in system.positive_roots if beta[i] == 1))
        for i, mark in enumerate(highest)
        if mark == 1
    }


@pytest.mark.parametrize("name", [t for t in TYPES if t[0] == "A" and t != "A1"])
def test_nodes_of_a_give_the_products_of_two_special_linear_algebras(name: str) -> None:
    n = int(name[1:])
    parts = {k: sorted(f"A{i}" for i in (k - 1, n - k) if i) for k in range(1, n + 1)}
    result = gradings(name)
    assert {k: sorted(kind.split(" + ")) for k, (kind, _) in result.items()} == parts
    assert {k: d for k, (_, d) in result.items()} == {k: k * (n + 1 - k) for k in parts}


@pytest.mark.parametrize(
    ("name", "nodes"),
    [
        *((f"B{n}", {1: (f"B{n - 1}" if n > 2 else "A1", 2 * n - 1)}) for n in range(3, 11)),
        *((f"C{n}", {n: (f"A{n - 1}", n * (n + 1) // 2)}) for n in range(3, 11)),
        *(
            (
                f"D{n}",
                {1: (f"D{n - 1}" if n > 4 else "A3", 2 * n - 2)}
                | dict.fromkeys((n - 1, n), (f"A{n - 1}", n * (n - 1) // 2)),
            )
            for n in range(4, 11)
        ),
        ("E6", {1: ("D5", 16), 6: ("D5", 16)}),
        ("E7", {7: ("E6", 27)}),
        ("E8", {}),
        ("F4", {}),
        ("G2", {}),
    ],
)
def test_nodes_of_coefficient_one(name: str, nodes: dict[int, tuple[str, int]]) -> None:
    assert gradings(name) == nodes
