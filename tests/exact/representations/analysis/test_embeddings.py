"""Rules from algebras in scrambled bases and restricted matrices, rules by name, and maximal subalgebras."""

import random
from collections import Counter

import pytest

import liehom as lh
from liehom.base.errors import InputError, UndecidedError
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.representations.core.representation import Representation

REGULAR = ["A1", "A2", "B2", "G2", "A3", "B3", "C3"]
SPECIAL = [  # of sl(N) by a module, of so(n) in another representation
    ("A1", [2]), ("A1", [3]), ("A1", [4]), ("B2", [0, 1]), ("A2", [2, 0]), ("B2", [1, 0]), ("A3", [0, 1, 0]),
    ("C3", [1, 0, 0]),    ("A1 + A1", [1, 1]), ("A1 + A2", [1, 1, 0]), ("G2", [1, 0]),
]  # fmt: skip


def scrambled(seed: int, rho: Representation, rows: list[list[object]]) -> tuple[Representation, Subalgebra]:
    """The representation and the span of the rows in a random basis of the algebra."""
    rng, n, field = random.Random(seed), rho.algebra.dimension, rho.algebra.field
    lower = [[rng.randint(-1, 1) if j < i else int(i == j) for j in range(n)] for i in range(n)]
    order = rng.sample(range(n), n)
    basis = field.matrix([lower[i] for i in order])
    g = rho.algebra.change_of_basis(basis)
    moved = Representation(g, [rho(row) for row in basis.to_rows()], check=False)
    k = len(rows)
    mixing = [[rng.choice((1, 2, -1)) if i == j else rng.randint(-1, 1) * (j < i) for j in range(k)] for i in range(k)]
    mixed = field.matrix(mixing, (k, k)) @ field.matrix(rows, (k, n))
    return moved, g.subalgebra(mixed @ basis.inverse())


def regular_case(seed: int) -> tuple[Representation, Subalgebra]:
    """A regular subalgebra: random roots closed under addition and negation, and part of the Cartan subalgebra."""
    rng = random.Random(seed)
    kind = REGULAR[seed % len(REGULAR)]
    system, g = lh.root_system(kind), lh.chevalley(kind)
    weight = [0] * system.rank
    weight[rng.randrange(system.rank)] = 1
    unit = [[int(i == j) for j in range(g.dimension)] for i in range(g.dimension)]
    torus = [unit[i] for i in range(system.rank)]
    roots = [unit[system.rank + system.index(a)] for a in rng.sample(system.roots, rng.randint(0, 2))]
    roots += [unit[system.rank + (system.index([-x for x in a]))] for a in system.roots
              if unit[system.rank + system.index(a)] in roots]  # fmt: skip
    if rng.random() < 0.3 and system.rank > 1:
        torus = torus[:1] if rng.random() < 0.5 else []
    rows = [*torus, *roots]
    if not rows:
        rows = [unit[0]]
    h = g.subalgebra_generated_by(rows)
    return scrambled(seed, lh.highest_weight_module(kind, weight).representation, h.rows())


def special_case(seed: int) -> tuple[Representation, Subalgebra]:
    """The image of an irreducible module in sl(N), and the adjoint or the defining representation of sl(N)."""
    kind, weight = SPECIAL[seed % len(SPECIAL)]
    module = lh.highest_weight_module(kind, weight).representation
    defining = lh.defining(lh.sl(module.size))
    h = defining.subalgebra([m.to_rows() for m in module])
    return scrambled(seed, lh.adjoint(defining.algebra) if seed % 3 == 0 and module.size < 5 else defining, h.rows())


def compared(rho: Representation, h: Subalgebra) -> None:
    """The table of the rule equals the highest weights of the restricted matrices."""
    rule = lh.branching_rule(rho.algebra, h)
    table = rule(rho)
    expected = rho.restriction(h).highest_weights()
    assert table.dimension == rho.size
    flat = Counter({(sum(t.highest_weights, ()), t.charges): t.multiplicity for t in table.terms})
    if not rule.charge_rows:
        assert {weight: m for (weight, _), m in flat.items()} == dict(expected)
        return
    found: dict[object, dict[object, int]] = {}
    known: dict[object, dict[object, int]] = {}
    for (weight, charges), m in flat.items():
        found.setdefault(charges, {})[weight] = m
    for (weight, charges), m in expected.items():
        known.setdefault(charges, {})[tuple(weight)] = m
    assert sorted(map(str, map(sorted, map(dict.items, found.values())))) == sorted(
        map(str, map(sorted, map(dict.items, known.values())))
    )
    if len(rule.charge_rows) == 1:  # the charges are proportional
        integers = sorted(float(c[0]) for c in found)
        exact = sorted(float(c[0].real) + float(c[0].imaginary) for c in known)
        scale = max(map(abs, exact), default=0) / (max(map(abs, integers)) or 1)
        matches = [
            all(
                abs(scale * sign * x - y) < 1e-9
                for x, y in zip(sorted(integers, key=lambda v: sign * v), exact, strict=True)
            )
            for sign in (1, -1)
        ]
        assert any(matches)


@pytest.mark.parametrize("seed", range(120))
def test_rule_of_regular_subalgebra_in_scrambled_basis_is_restriction_of_matrices(seed: int) -> None:
    compared(*regular_case(seed))


@pytest.mark.parametrize("seed", range(120, 200))
def test_rule_of_special_subalgebra_in_scrambled_basis_is_restriction_of_matrices(seed: int) -> None:
    compared(*special_case(seed))


# Every maximal subalgebra to rank 6, and of E7 and E8, by its factors and indices. The types are those of
# maximal_subgroups of Sage, which follows McKay and Patera; A1 + A1 + A1 in D6 is also there, but it is contained in
# A1 + C3. The u(1) belong to the nodes with mark 1 of the highest root. The indices were computed, and the test of sums
# of indices in test_branching.py ties them to the tables of Dynkin indices.
MAXIMAL = {
    "A1": "u(1)", "A2": "A1+u(1) 1; A1 4", "A3": "A2+u(1) 1; A1+A1+u(1) 1 1; A1+A1 2 2; B2 1",
    "A4": "A3+u(1) 1; A1+A2+u(1) 1 1; B2 2",
    "A5": "A4+u(1) 1; A1+A3+u(1) 1 1; A2+A2+u(1) 1 1; A3 2; C3 1; A1+A2 3 2; A2 5",
    "A6": "A5+u(1) 1; A1+A4+u(1) 1 1; A2+A3+u(1) 1 1; B3 2",
    "B2": "A1+A1 1 1; A1+u(1) 2; A1 10", "B3": "A1+A1+A1 1 1 2; A3 1; B2+u(1) 1; G2 1",
    "B4": "A1+A1+B2 1 1 1; A1+A3 2 1; D4 1; B3+u(1) 1; A1+A1 6 6; A1 60",
    "B5": "A1+A1+B3 1 1 1; A3+B2 1 1; A1+D4 2 1; D5 1; B4+u(1) 1; A1 110",
    "B6": "A1+A1+B4 1 1 1; A3+B3 1 1; B2+D4 1 1; A1+D5 2 1; D6 1; B5+u(1) 1; A1 182",
    "C3": "A1+B2 1 1; A2+u(1) 2; A1+A1 3 8; A1 35",
    "C4": "A1+C3 1 1; B2+B2 1 1; A3+u(1) 2; A1+A1+A1 4 4 4; A1 84",
    "C5": "A1+C4 1 1; B2+C3 1 1; A4+u(1) 2; A1+B2 5 4; A1 165",
    "C6": "A1+C5 1 1; B2+C4 1 1; C3+C3 1 1; A5+u(1) 2; A1+A3 6 4; B2+A1 3 16; A1 286",
    "D4": "A1+A1+A1+A1 1 1 1 1; A3+u(1) 1; B3 1; A1+B2 2 1; A2 3",
    "D5": "A1+A1+A3 1 1 1; D4+u(1) 1; A4+u(1) 1; B4 1; A1+B3 2 1; B2+B2 1 1; B2 3",
    "D6": "A1+A1+D4 1 1 1; A3+A3 1 1; D5+u(1) 1; A5+u(1) 1; B5 1; A1+B4 2 1; B2+B3 1 1; A1+C3 3 1",
    "G2": "A2 1; A1+A1 1 3; A1 28", "F4": "A1+C3 1 1; A2+A2 1 2; B4 1; A1 156; A1+G2 8 1",
    "E6": "A1+A5 1 1; A2+A2+A2 1 1 1; D5+u(1) 1; F4 1; C4 1; A2+G2 2 1; G2 3; A2 9",
    "E7": "A1+D6 1 1; A7 1; A2+A5 1 1; E6+u(1) 1; G2+C3 1 1; A1+F4 3 1; A1+G2 7 2; A2 21; A1+A1 24 15; A1 231; A1 399",
    "E8": "D8 1; A8 1; A4+A4 1 1; A2+E6 1 1; A1+E7 1 1; G2+F4 1 1; A1+A2 16 6; B2 12; A1 520; A1 760; A1 1240",
}  # fmt: skip


@pytest.mark.parametrize("kind", MAXIMAL)
def test_maximal_subalgebras_and_their_indices(kind: str) -> None:
    found = [
        " ".join([rule.name.replace(" ", ""), *map(str, rule.embedding_indices)])
        for rule in lh.maximal_subalgebras(kind)
    ]
    assert found == MAXIMAL[kind].split("; ")


@pytest.mark.parametrize("kind", [f"{x}{n}" for n in range(7, 9) for x in "ABCD"] + list(MAXIMAL))
def test_the_centralizer_of_a_maximal_subalgebra_is_its_centre(kind: str) -> None:
    rules = lh.maximal_subalgebras(kind)
    system = lh.root_system(kind)
    for rule in rules:
        size = sum(lh.root_system(x).number_of_roots + lh.root_system(x).rank for x in rule.factors)
        size += len(rule.charge_rows)
        highest = system.highest_roots[0]
        top = [sum(c * row[j] for c, row in zip(highest, system.cartan, strict=True)) for j in range(system.rank)]
        table = rule(top)
        assert table.dimension == system.rank + system.number_of_roots > size
        assert sum(t.multiplicity for t in table.terms if t.dimension == 1 and not any(t.charges)) == len(
            rule.charge_rows
        )


def test_bad_subalgebras_are_refused() -> None:
    g = lh.so(3, 1)
    with pytest.raises(InputError, match="not reductive"):
        lh.branching_rule(g, g.parabolic_subalgebra([0]))
    with pytest.raises(InputError, match="not semisimple"):
        u = lh.u(2)
        lh.branching_rule(u, u.center())
    with pytest.raises(InputError, match="the algebra of"):
        lh.branching_rule("A1", g.center())
    with pytest.raises(InputError, match="not the type of a simple"):
        lh.maximal_subalgebras("A1 + A1")


def test_an_irrational_direction_has_no_integer_charges() -> None:
    g = lh.chevalley("A2").over(lh.number_field("sqrt(2)"))
    with pytest.raises(UndecidedError, match="rational ratios"):
        lh.branching_rule(g, g.subalgebra([[1, "sqrt(2)", 0, 0, 0, 0, 0, 0]]))
    rule = lh.branching_rule(g, g.subalgebra([["sqrt(2)", "2*sqrt(2)", 0, 0, 0, 0, 0, 0]]))
    assert {abs(t.charges[0]) for t in rule([1, 1]).terms} == {0, 3}


def test_a_subalgebra_of_a_sum_has_an_index_in_each_ideal() -> None:
    g = lh.direct_sum(lh.so(3), lh.so(3))
    diagonal = g.subalgebra([[1, 0, 0, 1, 0, 0], [0, 1, 0, 0, 1, 0], [0, 0, 1, 0, 0, 1]])
    rule = lh.branching_rule(g, diagonal)
    assert rule.embedding_indices == ((1, 1),) and str(rule([1, 1])) == "3 + 1"


def test_a_levi_subalgebra_with_two_u1_is_found_by_name() -> None:
    rule = lh.branching_rule("so(10)", "su(3)+su(2)+u(1)+u(1)")
    assert rule.name == "A2 + A1 + u(1) + u(1)" and rule.embedding_indices == (1, 1)
    assert sorted(t.dimension for t in rule("16").terms) == [1, 1, 2, 3, 3, 6]
