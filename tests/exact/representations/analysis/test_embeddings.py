"""Rules from algebras in scrambled bases beside restricted matrices, rules by name, and maximal subalgebras."""

import random
from collections import Counter
from fractions import Fraction
from itertools import combinations

import pytest

import liehom as lh
from liehom.base.errors import CatalogError, InputError, ShapeError, UndecidedError
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.representations.core.representation import Representation

REGULAR = ["A1", "A2", "B2", "G2", "A3", "B3", "C3"]
SPECIAL = [  # of sl(N) by a module, of so(n) in another representation
    ("A1", [2]), ("A1", [3]), ("A1", [4]), ("B2", [0, 1]), ("A2", [2, 0]), ("B2", [1, 0]), ("A3", [0, 1, 0]), ("C3", [1, 0, 0]),
    ("A1 + A1", [1, 1]), ("A1 + A2", [1, 1, 0]), ("G2", [1, 0]),
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
    """The table of the rule beside the highest weights of the restricted matrices."""
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
