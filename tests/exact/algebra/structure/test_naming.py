"""Every row of the tables is found in scrambled bases, with its map, and different rows are told apart."""

import itertools
import random

import pytest

import liehom as lh
from liehom.base.errors import InputError, UndecidedError
from liehom.exact.algebra.constructions.low_dimensional import Row, rows
from liehom.exact.algebra.structure.identification import FAMILIAR, familiar_name
from liehom.testing import random_unimodular

FIELDS = [lh.QQ, lh.QQ, lh.QQ, lh.number_field("sqrt(2)"), lh.number_field([-2, 0, 0, 1], (1, 2))]
ROWS = {f"A{n},{k}": row for (n, k), row in rows().items()}
VALUES, BASES = 20, 5

# The nilpotent algebras of dimension 5 and 6 of Cicalo, de Graaf and Schneider, in the list of the GAP package LieAlgDB
# (manual, "Description of the solvable and nilpotent Lie algebras"): ij,k stands for [x_i, x_j] = x_k.
DE_GRAAF = {
    "N5,4": "12,5 34,5", "N5,5": "12,3 13,5 24,5", "N5,6": "12,3 13,4 14,5 23,5", "N5,7": "12,3 13,4 14,5",
    "N5,8": "12,4 13,5", "N5,9": "12,3 13,4 23,5", "N6,10": "12,3 13,6 45,6", "N6,11": "12,3 13,4 14,6 23,6 25,6",
    "N6,12": "12,3 13,4 14,6 25,6", "N6,13": "12,3 13,5 15,6 24,5 34,6", "N6,14": "12,3 13,4 14,5 23,5 25,6 34,-6",
    "N6,15": "12,3 13,4 14,5 15,6 23,5 24,6", "N6,16": "12,3 13,4 14,5 25,6 34,-6", "N6,17": "12,3 13,4 14,5 15,6 23,6",
    "N6,18": "12,3 13,4 14,5 15,6", "N6,19(1)": "12,4 13,5 15,6 24,6 35,6", "N6,19(-1)": "12,4 13,5 15,6 24,6 35,-6",
    "N6,20": "12,4 13,5 15,6 24,6", "N6,21(1)": "12,3 13,4 14,6 23,5 25,6", "N6,21(-1)": "12,3 13,4 14,6 23,5 25,-6",
    "N6,22(0)": "12,5 13,6 34,5", "N6,22(-1)": "12,5 13,6 24,-6 34,5", "N6,23": "12,3 13,5 14,6 24,5",
    "N6,24(0)": "12,3 13,5 23,6 24,5", "N6,24(1)": "12,3 13,5 14,6 23,6 24,5", "N6,24(-1)": "12,3 13,5 14,-6 23,6 24,5",
    "N6,25": "12,3 13,5 14,6", "N6,26": "12,4 13,5 23,6", "N6,27": "12,3 13,5 24,6", "N6,28": "12,3 13,4 14,5 23,6",
}  # fmt: skip


def de_graaf(name: str) -> lh.LieAlgebra:
    table: dict[tuple[int, int], dict[int, int]] = {}
    for word in DE_GRAAF[name].split():
        pair, k = word.split(",")
        table.setdefault((int(pair[0]) - 1, int(pair[1]) - 1), {})[abs(int(k)) - 1] = -1 if k[0] == "-" else 1
    return lh.LieAlgebra(table, dimension=int(name[1]))


def scrambled(g: lh.LieAlgebra, seed: int) -> lh.LieAlgebra:
    return g.change_of_basis(random_unimodular(g.dimension, random.Random(seed), 3 * g.dimension))


def member(row: Row, seed: int) -> lh.LieAlgebra:
    """An algebra of a row with random parameters, rational or algebraic."""
    rng = random.Random(f"{row.dimension},{row.number},{seed}")
    while True:
        field = rng.choice(FIELDS) if row.dimension < 6 else lh.QQ
        irrational = field.generator if field.degree > 1 else field.zero
        values = [
            field.convert(rng.randint(-3, 3)) / rng.randint(1, 3) + irrational * rng.randint(-1, 1)
            for _ in row.parameters
        ]
        if row.holds(values):
            return row.algebra(values, field)


def require_named(name: str, seed: int, bases: int) -> None:
    g = member(ROWS[name], seed)
    found = [scrambled(g, base).identify() for base in range(bases)]
    assert len({(f.name, f.parameters) for f in found}) == 1
    assert found[0].name.split("(")[0] == ("R" if name == "A1,1" else name)
    for f in found:
        assert f.homomorphism.is_isomorphism() and f.homomorphism.source.name == f.name
        lh.algebra.Homomorphism(f.homomorphism.source, f.homomorphism.target, f.homomorphism.matrix)  # checks brackets


@pytest.mark.parametrize("name", ROWS)
def test_a_row_is_named_in_a_scrambled_basis(name: str) -> None:
    require_named(name, 0, 1)


@pytest.mark.parametrize(("name", "base"), [("A3,9", 41), ("A3,9", 47), ("A5,37", 7), ("A5,39", 90), ("A5,40", 60)])
def test_bases_with_large_fields_negative_lengths_or_weights_that_meet(name: str, base: int) -> None:
    assert scrambled(member(ROWS[name], 0), base).identify().name == name


@pytest.mark.slow
@pytest.mark.parametrize("name", ROWS)
def test_a_row_is_named_for_all_sampled_parameters(name: str) -> None:
    row = ROWS[name]
    for seed in range(VALUES if row.parameters else 1):
        require_named(name, seed, BASES if row.parameters else VALUES * BASES)


@pytest.mark.parametrize("name", ["N5,6", "N6,13", "N6,22(-1)", "N6,24(-1)"])
def test_nilpotent_algebras_of_de_graaf_have_names(name: str) -> None:
    assert scrambled(de_graaf(name), 1).identify().homomorphism.is_isomorphism()


@pytest.mark.slow
def test_nilpotent_rows_are_those_of_de_graaf() -> None:
    found = {name: scrambled(de_graaf(name), 1).identify().name for name in DE_GRAAF}
    assert len(set(found.values())) == len(found)
    nilpotent = {name for name, row in ROWS.items() if row.dimension > 4 and member(row, 0).is_nilpotent()}
    assert {name.split("(")[0] for name in found.values()} == nilpotent
    split = lh.LieAlgebra({(0, 1): {4: 1}, (0, 2): {5: 1}, (1, 3): {5: 1}, (2, 3): {4: 1}})  # N6,22(1)
    assert split.identify().name == "A3,1+A3,1"


@pytest.mark.parametrize("seed", [1, 2, pytest.param(0, marks=pytest.mark.slow)])
def test_random_semidirect_sums_of_dimension_5_are_in_the_table(seed: int) -> None:
    rng = random.Random(seed)
    nilradicals = [lh.abelian(4), lh.direct_sum(lh.heisenberg(1), lh.abelian(1)), lh.low_dimensional(4, 1)]
    for ideal in nilradicals:
        matrices = ideal.derivations().matrices
        action = sum((m.scale(rng.randint(-1, 1)) for m in matrices), ideal.field.zeros(4, 4))
        g = lh.semidirect_sum(lh.abelian(1), [action], ideal)
        try:
            assert scrambled(g, seed).identify().homomorphism.is_isomorphism()
        except UndecidedError as undecided:
            assert "degree" in str(undecided)


@pytest.mark.parametrize("block", [range(k, k + 50) for k in range(0, 10_000, 50)], ids=lambda block: str(block[0]))
def test_pairs_of_different_rows_of_one_dimension_are_told_apart(block: range) -> None:
    pairs = [pair for pair in itertools.combinations(ROWS.values(), 2) if pair[0].dimension == pair[1].dimension]
    for seed in block:
        chosen = random.Random(seed).choice(pairs)
        one, two = (member(row, seed) for row in chosen)
        if one.field != two.field:
            one, two = (row.algebra(row_values(row), lh.QQ) for row in chosen)
        two = scrambled(two, seed)
        assert one.differing_invariant(two) is not None and not one.is_isomorphic(two)


def row_values(row: Row) -> list[object]:
    small = [lh.QQ.convert(x) for x in ("1/3", 1, -1, 0, 3)]
    return next(list(v) for v in itertools.product(small, repeat=len(row.parameters)) if row.holds(v))


def test_real_summands_appear_over_a_larger_field() -> None:
    found = lh.catalog.algebra("affine(field(-2,0))").identify()
    assert found.name == "A2,1+A2,1" and found.homomorphism.source.field == lh.number_field("sqrt(2)")
    assert lh.catalog.algebra("affine(field(1,0))").identify().name == "A4,12"


@pytest.mark.parametrize("name", ["A4,5(-1,1/2)", "A3,1+R", "A2,1+A2,1", "R^3", "A5,13(1/2,-1/3,2)", "e(3)", "A3,8+R"])
def test_names_round_trip_through_the_catalogue(name: str) -> None:
    found = scrambled(lh.catalog.algebra(name), 2).identify()
    assert found.name == name and lh.catalog.algebra(found.name) == lh.catalog.algebra(name)
    assert found.homomorphism.source.dimension == found.homomorphism.rank()


@pytest.mark.parametrize("name", FAMILIAR)
def test_familiar_names_are_those_of_the_same_algebras(name: str) -> None:
    other = lh.catalog.algebra(FAMILIAR[name])
    assert lh.catalog.algebra(name).isomorphism(other) is not None
    assert familiar_name(f"{name}+R") == f"{FAMILIAR[name]}+R"
    assert lh.structure_name(lh.catalog.algebra(name)) == FAMILIAR[name]
    if not other.is_semisimple():
        assert f"isomorphic to {FAMILIAR[name]}, {name} in the tables" in scrambled(other, 3).describe()


def test_no_map_is_promised_between_larger_simple_ideals() -> None:
    assert lh.so(3, 1).is_isomorphic(lh.sl(2, "C"))
    with pytest.raises(UndecidedError, match="isomorphic over the reals, both sl"):
        lh.so(3, 1).isomorphism(lh.sl(2, "C"))


def test_isomorphism_is_a_map_or_none() -> None:
    found = lh.heisenberg(1).isomorphism(lh.bianchi("II"))
    assert found is not None and found.is_isomorphism()
    assert found.source == lh.heisenberg(1) and found.target == lh.bianchi("II")
    assert lh.low_dimensional(4, 5, -1, "1/2").isomorphism(lh.low_dimensional(4, 5, -1, "-1/2")) is not None
    assert lh.low_dimensional(4, 5, -1, "1/2").isomorphism(lh.low_dimensional(4, 5, -1, "1/3")) is None
    one, two = lh.low_dimensional(3, 7, "sqrt(2)"), lh.low_dimensional(3, 7, 1)
    assert one.isomorphism(two) is None and two.isomorphism(one) is None
    assert one.differing_invariant(two) == "signature of the Killing form: (1, 0, 2) and (0, 0, 3)"
    three = lh.low_dimensional(4, 5, "1/3", "sqrt(2)/2")
    assert (
        three.differing_invariant(lh.low_dimensional(4, 5, "1/3", "1/2"))
        == "name: A4,5(1/3,1/2*sqrt(2)) and A4,5(1/3,1/2)"
    )


@pytest.mark.parametrize("name", ["e(3)", "iso(2,1)", "schroedinger(1)", "aff(2)"])
def test_sums_with_a_levi_factor_are_named(name: str) -> None:
    assert scrambled(lh.catalog.algebra(name), 1).identify().name == name


def test_algebras_beyond_the_tables_are_undecided_or_searched() -> None:
    with pytest.raises(UndecidedError, match="dimension 7; derived series 7 > 5 > 0"):
        lh.algebra.filiform(7).identify()
    g = lh.algebra.filiform(7)
    found = g.isomorphism(scrambled(g, 4))
    assert found is not None and found.is_isomorphism()


def test_semisimple_ideals_are_compared_by_real_forms() -> None:
    assert lh.u(3).is_isomorphic(lh.catalog.algebra("su(3)+R"))
    assert not lh.u(3).is_isomorphic(lh.catalog.algebra("su(2,1)+R"))


def test_fields_must_be_comparable() -> None:
    one, two = lh.low_dimensional(3, 7, "sqrt(2)"), lh.low_dimensional(3, 7, "sqrt(3)")
    with pytest.raises(InputError, match="bring them to one field"):
        one.isomorphism(two)


def test_a_simple_ideal_without_a_row_is_named_by_the_error() -> None:
    with pytest.raises(UndecidedError, match=r"no map .* the simple ideal sl\(2,C\); use structure_name\(g\)"):
        lh.so(3, 1).identify()
