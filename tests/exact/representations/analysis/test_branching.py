"""Branching rules and published tables, named in tests/oracles/branching_tables.json, and laws of restriction.

The order of equal factors, the direction of a u(1), which of two dual modules of a factor has a bar, and which of the
subalgebras that outer automorphisms map to each other is meant are free. One choice must do for all lines of a rule.
"""

import json
import re
from collections import Counter
from fractions import Fraction
from itertools import permutations, product
from math import comb
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import CatalogError, InputError, ShapeError
from liehom.exact.representations.analysis.branching import module_name, symmetric_images
from liehom.exact.representations.highest_weight.characters import weights_up_to
from liehom.exact.representations.highest_weight.weights import weight_space
from tests.sampling import examples

TABLES = json.loads(
    (Path(__file__).resolve().parents[3] / "oracles" / "branching_tables.json").read_text(encoding="utf-8")
)
R = lh.representations
Line = Counter[tuple[tuple[str, ...], tuple[int, ...]]]


def line(text: str) -> Line:
    """'(3bar,1)(4)+2(8,1)(0)' as a multiset of names and charges."""
    terms: Line = Counter()
    for times, names, charges in re.findall(r"(\d*)(\([^()]*\))((?:\(-?\d+\))*)", text):
        found = tuple(int(x) for x in re.findall(r"-?\d+", charges))
        terms[tuple(names.strip("()").split(",")), found] += int(times or 1)
    return terms


def conventions(rule: lh.representations.BranchingRule) -> list[Any]:
    """The maps of terms that only change conventions."""
    size = len(rule.factors)
    orders = [p for p in permutations(range(size)) if tuple(rule.factors[i] for i in p) == rule.factors]
    bars = list(product((False, True), repeat=size))
    signs = list(product((1, -1), repeat=len(rule.charge_rows)))
    return [(order, bar, sign) for order in orders for bar in bars for sign in signs]


def seen(table: lh.representations.Branching, order: Any, bar: Any, sign: Any) -> Line:
    """The table with another convention."""
    terms: Line = Counter()
    for t in table.terms:
        tops = [
            R.dual_weight(kind, top) if flip else top
            for kind, top, flip in zip(table.rule.factors, t.highest_weights, bar, strict=True)
        ]
        names = [module_name(kind, top) for kind, top in zip(table.rule.factors, tops, strict=True)]
        terms[tuple(names[i] for i in order), tuple(int(c) * s for c, s in zip(t.charges, sign, strict=True))] += (
            t.multiplicity
        )
    return terms


def rule_of(kind: str, name: str) -> lh.representations.BranchingRule:
    """By name, or 'A1 + A2:3,2' with the index of each factor (or of all), or 'levi 1,3' by nodes without the u(1)."""
    if ":" in name:
        factors, indices = name.split(":")[0].split(" + "), [int(x) for x in name.split(":")[1].split(",")]
        key = (tuple(factors), tuple(indices) * (len(factors) // len(indices)))
        return next(r for r in lh.maximal_subalgebras(kind) if (r.factors, r.embedding_indices) == key)
    if name.startswith("levi"):
        found = lh.branching_rule(kind, [int(x) for x in name.removeprefix("levi ").split(",")])
        return lh.representations.BranchingRule(kind, found.factors, found.kind, found.projection)
    return lh.branching_rule(kind, name)


@pytest.mark.parametrize("entry", TABLES["branching"], ids=lambda entry: f"{entry[1]} to {entry[2]}")
def test_lines_of_published_tables(entry: list[Any]) -> None:
    _, kind, name, lines = entry
    rule = rule_of(kind, name)
    tables = {module: rule(module) for module in lines}
    known = {module: line(text) for module, text in lines.items()}
    assert any(all(seen(tables[m], *c) == known[m] for m in lines) for c in conventions(rule))


@pytest.mark.parametrize("entry", TABLES["highest_weights"], ids=lambda entry: f"{entry[0]} to {entry[2]}")
def test_highest_weights_of_published_examples(entry: list[Any]) -> None:
    kind, name, factors, lines = entry
    rule = rule_of(kind, name)

    def parts(text: str) -> Counter[tuple[tuple[int, ...], ...]]:
        found: Counter[tuple[tuple[int, ...], ...]] = Counter()
        for term in text.split(" + "):
            times, _, weight = term.rpartition("*")
            numbers, tops = [int(x) for x in weight.split(",")], []
            for factor in factors.split():
                rank = int(factor[1:])
                top, numbers = numbers[:rank], numbers[rank:]
                top = top[::-1] if factor == "C2" else [top[1], top[0], top[2]] if factor == "D3" else top
                tops.append(tuple(top))
            found[tuple(tops)] += int(times or 1)
        return found

    known = {tuple(map(int, w.split(","))): parts(text) for w, text in lines.items()}

    def agree(order: Any, symmetries: Any, outer: Any) -> bool:
        for weight, expected in known.items():
            terms: Counter[tuple[tuple[int, ...], ...]] = Counter()
            for t in rule(tuple(weight[i] for i in outer)).terms:
                tops = [tuple(top[i] for i in p) for top, p in zip(t.highest_weights, symmetries, strict=True)]
                terms[tuple(tops[i] for i in order)] += t.multiplicity
            if terms != expected:
                return False
        return True

    diagrams = [lh.root_system(factor).cartan for factor in (kind, *rule.factors)]
    options = product(*(lh.exact.algebra.roots.root_system.isomorphisms(c, c) for c in diagrams))
    orders = list(permutations(range(len(rule.factors))))
    assert any(agree(order, symmetries, outer) for outer, *symmetries in options for order in orders)


# dual Coxeter numbers, Bourbaki's plates with Kac, Infinite-dimensional Lie algebras, table of section 6.1
DUAL_COXETER = {"A1": 2, "A4": 5, "B3": 5, "B5": 9, "C3": 4, "C4": 5, "D4": 6, "D6": 10, "G2": 4, "F4": 9}
DUAL_COXETER |= {"E6": 12, "E7": 18, "E8": 30}


@pytest.mark.parametrize("kind", DUAL_COXETER)
def test_the_index_of_the_adjoint_module_is_twice_the_dual_coxeter_number(kind: str) -> None:
    top = lh.root_system(kind).highest_roots[0]
    cartan = lh.root_system(kind).cartan
    weight = [sum(int(c) * int(cartan[i][j]) for i, c in enumerate(top)) for j in range(len(top))]
    assert lh.weyl_dimension(kind, weight) == len(top) + lh.root_system(kind).number_of_roots
    assert R.dynkin_index(kind, weight) == 2 * DUAL_COXETER[kind]
    assert not any(R.congruency_class(kind, weight) or ())


@pytest.mark.parametrize("kind", ["A2", "A3", "B2", "B3", "C3", "D4", "D5", "G2", "E6"])
def test_index_and_class_of_products(kind: str) -> None:
    """The index is a derivation of products, and the class is constant on their parts."""
    system = lh.root_system(kind)
    left, right = [int(i == 0) for i in range(system.rank)], [int(i == system.rank - 1) for i in range(system.rank)]
    parts = lh.tensor_product_decomposition(kind, left, right)
    sizes, indices = ([f(kind, w) for w in (left, right)] for f in (lh.weyl_dimension, R.dynkin_index))
    total = sum(m * R.dynkin_index(kind, w) for w, m in parts.items())
    assert total == indices[0] * sizes[1] + sizes[0] * indices[1]
    assert len({R.congruency_class(kind, w) for w in parts}) == 1
    for weight in parts:
        casimir = R.casimir_eigenvalue(kind, weight) * lh.weyl_dimension(kind, weight)
        assert casimir == R.dynkin_index(kind, weight) * (system.rank + system.number_of_roots)


TYPES = ["A1", "A2", "A3", "A4", "B2", "B3", "C3", "D4", "D5", "G2", "F4", "E6"]


@st.composite
def rules(draw: st.DrawFn) -> tuple[lh.representations.BranchingRule, list[int]]:
    kind = draw(st.sampled_from(TYPES))
    rank = lh.root_system(kind).rank
    weight = draw(st.lists(st.integers(0, 1), min_size=rank, max_size=rank))
    if lh.weyl_dimension(kind, weight) > 3000:
        weight = [int(i == weight.index(1)) for i in range(rank)]
    if draw(st.booleans()):
        return draw(st.sampled_from(lh.maximal_subalgebras(kind))), weight
    nodes = draw(st.lists(st.integers(0, rank), max_size=rank, unique=True))
    return lh.branching_rule(kind, nodes), weight


@given(case=rules())
@settings(deadline=None, max_examples=examples(60))
def test_dimensions_indices_and_charges_add_up(case: tuple[lh.representations.BranchingRule, list[int]]) -> None:
    rule, weight = case
    table = rule(weight)
    assert table.dimension == lh.weyl_dimension(rule.type, weight)
    index = R.dynkin_index(rule.type, weight)
    for k, embedding in enumerate(rule.embedding_indices):
        total = 0
        for t in table.terms:
            others = t.dimension // lh.weyl_dimension(rule.factors[k], t.highest_weights[k])
            total += t.multiplicity * others * R.dynkin_index(rule.factors[k], t.highest_weights[k])
        assert total == embedding * index
    for k in range(len(rule.charge_rows)):
        assert sum(t.multiplicity * t.dimension * t.charges[k] for t in table.terms) == 0
        assert all(t.charges[k].denominator == 1 for t in table.terms)
    adjoint = lh.root_system(rule.type)
    highest = adjoint.highest_roots[0]
    top = [sum(c * row[j] for c, row in zip(highest, adjoint.cartan, strict=True)) for j in range(adjoint.rank)]
    tops = {t.highest_weights for t in rule(top).terms}
    for k, factor in enumerate(rule.factors):  # the adjoint module contains that of each ideal
        system = lh.root_system(factor)
        own = tuple(sum(c * row[j] for c, row in zip(system.highest_roots[0], system.cartan, strict=True))
                    for j in range(system.rank))  # fmt: skip
        assert tuple(own if i == k else (0,) * int(f[1:]) for i, f in enumerate(rule.factors)) in tops


@given(kind=st.sampled_from(["A1", "A2", "B2", "G2"]), k=st.integers(0, 3), data=st.data())
@settings(deadline=None, max_examples=examples(30))
def test_powers_add_up_to_tensor_powers(kind: str, k: int, data: st.DataObject) -> None:
    rank = lh.root_system(kind).rank
    weight = data.draw(st.lists(st.integers(0, 1), min_size=rank, max_size=rank))
    size = lh.weyl_dimension(kind, weight)
    symmetric, exterior = (
        R.symmetric_power_decomposition(kind, weight, k),
        R.exterior_power_decomposition(kind, weight, k),
    )
    assert (
        sum(m * lh.weyl_dimension(kind, w) for w, m in symmetric.items()) == comb(size + k - 1, k) if k else symmetric
    )
    assert sum(m * lh.weyl_dimension(kind, w) for w, m in exterior.items()) == comb(size, k)
    if k == 2:
        assert Counter(symmetric) + Counter(exterior) == Counter(lh.tensor_product_decomposition(kind, weight, weight))


def test_tables_print_as_physicists_write_them() -> None:
    rule = lh.branching_rule("E6", "so(10)+u(1)")
    assert str(rule("27")) == "16_1 + 10_-2 + 1_4" and str(rule("27bar")) == "16bar_-1 + 10_2 + 1_-4"
    assert rule("27bar").to_latex() == r"\overline{\mathbf{16}}_{-1}+\mathbf{10}_{2}+\mathbf{1}_{-4}"
    hypercharge = lh.branching_rule("A4", [[1, 2], [4]], charges=Fraction(-1, 6))
    assert str(hypercharge("10")) == "(3,2)_1/6 + (3bar,1)_-2/3 + (1,1)_1"
    assert (
        hypercharge("24").to_latex().startswith(r"(\mathbf{8},\mathbf{1})_{0}+(\overline{\mathbf{3}},\mathbf{2})_{5/6}")
    )
    assert str(lh.branching_rule("D5", "su(5)")("45")) == "24 + 10 + 10bar + 1"
    assert str(lh.branching_rule("B3", "A3")("8")) == "4 + 4bar"
    assert str(lh.branching_rule("E8", "E7 + A1")("248")) == "(133,1) + (56,2) + (1,3)"
    two = lh.branching_rule("A2", [], charges=[[1, 0], [1, 1]])
    plain = lh.branching_rule("A2", [])
    assert two.charge_rows == (plain.charge_rows[0], tuple(map(sum, zip(*plain.charge_rows, strict=True))))
    assert rule("78").to_markdown().splitlines()[0] == "| times | module | D5 | charge | dimension |"


def test_the_largest_case_of_the_tables() -> None:
    table = lh.branching_rule("E8", [0, 2, 3, 4, 5, 6, 7, 8])([1, 0, 0, 0, 0, 0, 0, 0])
    assert sorted(t.dimension for t in table.terms) == [135, 1820, 1920]


@pytest.mark.parametrize(("arguments", "error", "match"), [
    (("E6", "so(11)"), CatalogError, "maximal ones: A1 . A5"), (("E8", "A1"), CatalogError, "(?s)several.*520.*1240"),
    (("A2", "su(2)"), CatalogError, r"several.*\(4,\); \(1,\)"),
    (("A4", [1, 2, 2]), InputError, "different nodes"), (("A4", [0, 1, 2, 3, 4]), InputError, "at most 4"),
    (("A4", [1, 7]), InputError, "from 0 to 4"), (("A4", [[1], [2]]), InputError, "edge"),
    (("H3", [1]), CatalogError, None),
    (("A1 + A1", [0, 1]), InputError, "a simple algebra"), ((3, "A1"), InputError, "type"),
])  # fmt: skip
def test_bad_input_is_refused(arguments: tuple[Any, ...], error: type[Exception], match: str | None) -> None:
    with pytest.raises(error, match=match):
        lh.branching_rule(*arguments)


@pytest.mark.parametrize("weight", [[1, 0, 0, 0, 0], [0, 1, 0, 0, 0], [0, 0, 0, 1, 0], [1, 0, 0, 0, 1]])
def test_a_chain_of_rules_is_the_rule_of_the_chain(weight: list[int]) -> None:
    """so(10) > so(9) > so(8) is so(10) > so(8) + u(1) without the charge."""
    chain = lh.branching_rule("B4", "so(8)")(lh.branching_rule("D5", "so(9)")(weight))
    at_once = Counter[Any]()
    for term in lh.branching_rule("D5", "so(8)+u(1)")(weight).terms:
        at_once[term.highest_weights] += term.multiplicity
    # the spinors of so(8) are exchanged by a symmetry of its diagram
    swapped = Counter({(tuple(x[0][i] for i in (0, 1, 3, 2)),): n for x, n in at_once.items()})
    assert Counter({term.highest_weights: term.multiplicity for term in chain.terms}) in (at_once, swapped)
    charged = lh.branching_rule("D5", "su(5)+u(1)")
    with pytest.raises(InputError, match="takes modules of A4, got those of"):
        lh.branching_rule("A4", "su(4)+u(1)")(charged("16"))


def test_bad_calls_of_a_rule_are_refused() -> None:
    rule = lh.branching_rule("A4", "su(3)+su(2)+u(1)")
    with pytest.raises(InputError, match="does not name a module"):
        rule("7")
    with pytest.raises(ShapeError, match="2 coordinates"):
        rule([1, 0])
    with pytest.raises(InputError, match="made from the type"):
        rule(lh.adjoint(lh.su(5)))
    with pytest.raises(InputError, match="of 1 u"):
        lh.branching_rule("A4", [1, 2, 3], charges=[1, 2])
    with pytest.raises(InputError, match="exact numbers"):
        lh.branching_rule("A4", [1, 2, 3], charges=1.5)
    for function in (R.dynkin_index, R.casimir_eigenvalue, R.congruency_class):
        with pytest.raises(InputError, match="not the type of a simple"):
            function("A1 + A1", [1, 0])
    with pytest.raises(InputError, match="degree"):
        R.symmetric_power_decomposition("A1", [1], -1)
    with pytest.raises(InputError, match="names of modules are read by branching rules only"):
        lh.tensor_product_decomposition("D5", "16", "16")


@pytest.mark.parametrize("kind", ["A2", "A3", "A4", "D4", "D5", "D6", "E6"])
def test_names_of_modules_differ_and_those_of_exchanged_ones_only_in_bars_and_letters(kind: str) -> None:
    weights = list(weights_up_to(weight_space(kind), 700))
    names = {mu: module_name(kind, mu) for mu in weights}
    assert len(set(names.values())) == len(weights)
    for mu, name in names.items():
        images, dual = symmetric_images(kind, mu), R.dual_weight(kind, mu)
        assert len({re.sub(r"bar|[vsc]", "", names[image]) for image in images}) == 1
        assert name.startswith(str(R.weyl_dimension(kind, mu)))
        if dual != mu:  # of two dual modules the smaller class has no bar, but for the 6 of SU(3)
            smaller = (R.congruency_class(kind, mu)[::-1], dual) < (R.congruency_class(kind, dual)[::-1], mu)
            assert ("bar" in name) is (smaller is (sorted((mu, dual)) == [(0, 2), (2, 0)] and kind == "A2"))
        else:
            assert "bar" not in name and (name[-1] in "vsc") is (len(images) > 1)


@pytest.mark.parametrize("kind", ["A3", "A4", "B3", "B4", "C3", "C4", "D4", "D5", "D6", "E6", "E7", "E8", "F4", "G2"])
def test_classes_are_those_modulo_the_root_lattice(kind: str) -> None:
    """A root does not change the class, and the fundamental weights have all classes but 0."""
    cartan = np.array(lh.root_system(kind).cartan, dtype=int)
    units = np.eye(len(cartan), dtype=int)
    for root, w in product(cartan, units):
        assert R.congruency_class(kind, (w + 3).tolist()) == R.congruency_class(kind, (w + 3 + root).tolist())
    classes = {R.congruency_class(kind, w.tolist()) for w in (0 * units[0], *units)}
    assert len(classes) == round(abs(np.linalg.det(cartan)))
