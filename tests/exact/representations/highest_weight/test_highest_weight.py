"""Irreducible modules by their highest weight: identity, weights, integrality, known orbits; refusals."""

from math import factorial
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import CatalogError, InputError, RepresentationError, ShapeError
from liehom.exact.algebra.roots.root_system import RootSystem
from liehom.exact.representations.highest_weight.highest_weight import _lattice_basis, admissible_lattice
from liehom.exact.representations.invariants.representation_identity import (
    SparseStack,
    failing_generator_pair,
    failing_pair,
)
from liehom.exact.scalars.rational import QQ
from tests.sampling import examples

SMALL = {"A1": 6, "A2": 3, "B2": 2, "G2": 1, "A3": 1, "B3": 1, "C3": 1, "A1 + A2": 1}

NAMED = [
    ("A1", [4]), ("A2", [2, 2]), ("B2", [1, 1]), ("B4", [0, 0, 0, 1]), ("C3", [0, 0, 1]), ("D4", [0, 0, 0, 1]),
    ("D4", [0, 1, 0, 0]), ("G2", [1, 0]), ("G2", [2, 0]), ("F4", [0, 0, 0, 1]), ("E6", [0, 0, 0, 0, 0, 1]),
    ("A1 + G2", [1, 1, 0]),
]  # fmt: skip


@st.composite
def modules(draw: st.DrawFn) -> tuple[str, list[int]]:
    kind = draw(st.sampled_from(sorted(SMALL)))
    rank = lh.root_system(kind).rank
    return kind, draw(st.lists(st.integers(0, SMALL[kind]), min_size=rank, max_size=rank))


def unit(n: int, i: int) -> list[int]:
    return [int(i == k) for k in range(n)]


@pytest.mark.parametrize(("kind", "weight"), NAMED, ids=str)
def test_every_bracket_is_respected(kind: str, weight: list[int]) -> None:
    """By the proof that the library uses for any matrices, which knows nothing of generators."""
    rho = lh.highest_weight_module(kind, weight, check=False).representation
    assert rho.algebra == lh.chevalley(kind) and failing_pair(rho.algebra, rho.matrices) is None


@given(module=modules())
@settings(deadline=None, max_examples=examples(25))
def test_weights_highest_weight_vector_and_integrality(module: tuple[str, list[int]]) -> None:
    kind, weight = module
    made = lh.highest_weight_module(kind, weight)
    rho, system = made.representation, lh.root_system(kind)
    rank, count = system.rank, len(system.positive_roots)
    assert made.dimension == rho.size == lh.weyl_dimension(kind, weight)
    assert made.weights[0] == made.highest_weight == tuple(weight)
    assert made.character() == lh.representations.character(kind, weight)
    for i in range(rank):  # the simple coroots act by the weights
        rows = [[mu[i] * x for x in unit(rho.size, b)] for b, mu in enumerate(made.weights)]
        assert rho.matrices[i] == QQ.matrix(rows)
    first = QQ.matrix([unit(rho.size, 0)]).T
    assert all((a @ first).is_zero() for a in rho.matrices[rank : rank + count])
    for a in rho.matrices[rank:]:  # the lattice is stable under the divided powers of all root vectors
        power, k = a, 1
        while not power.is_zero():
            assert power.scale(QQ.one / factorial(k)).den == 1
            power, k = power @ a, k + 1


@pytest.mark.parametrize(("kind", "weight", "generic", "highest"), [
    ("G2", [1, 0], 8, 8), ("F4", [0, 0, 0, 1], 28, 36), ("E6", [1, 0, 0, 0, 0, 0], 52, 61),
    ("E7", [0, 0, 0, 0, 0, 0, 1], 78, 105), ("E6", [0, 1, 0, 0, 0, 0], 6, 56), ("E8", [0, 0, 0, 0, 0, 0, 0, 1], 8, 190),
    ("B4", [0, 0, 0, 1], 21, 25), ("D5", [0, 0, 0, 0, 1], 29, 34),
])  # fmt: skip
def test_stabilisers_of_a_generic_and_of_the_highest_weight_vector(
    kind: str, weight: list[int], generic: int, highest: int
) -> None:
    rho = lh.highest_weight_module(kind, weight).representation
    # a generic vector has the least stabiliser: one with that dimension shows that it is no larger
    point = [(7 * i * i + 3 * i) % 19 - 9 for i in range(rho.size)]
    assert rho.isotropy(point).dimension == generic and rho.isotropy(unit(rho.size, 0)).dimension == highest
    # the weight fixes the latter: all positive roots, those negative ones and coroots that lambda does not see
    system = lh.root_system(kind)
    kept = [i for i, x in enumerate(weight) if x]
    seen = sum(1 for alpha in system.positive_roots if any(alpha[i] for i in kept))
    assert highest == rho.algebra.dimension - seen - 1


@pytest.mark.parametrize(("kind", "weight"), [("A2", [1, 1]), ("B3", [0, 0, 1]), ("G2", [1, 0]), ("C3", [0, 1, 0])])
def test_the_modules_are_irreducible_and_dual_as_they_should(kind: str, weight: list[int]) -> None:
    rho = lh.highest_weight_module(kind, weight).representation
    assert rho.is_irreducible() and len(rho.direct_sum(rho.dual()).commutant()) == 4
    indicator = lh.representations.frobenius_schur_indicator(kind, weight)
    forms = rho.invariant_forms()
    assert (len(forms.symmetric), len(forms.skew)) == ((1, 0) if indicator == 1 else (0, 1))


def test_a_tensor_product_has_the_invariants_that_characters_tell() -> None:
    three = lh.highest_weight_module("A2", [1, 0]).representation
    six = lh.highest_weight_module("A2", [0, 2]).representation
    assert three.tensor(three).tensor(six).invariant_vectors().dimension == 1
    assert lh.tensor_product_decomposition("A2", [1, 0], [1, 0]) == {(2, 0): 1, (0, 1): 1}


def test_another_numbering_of_the_nodes_is_followed() -> None:
    """C2: the short root first."""
    system = RootSystem([[2, -1], [-2, 2]])
    made = [lh.highest_weight_module(system, weight) for weight in ([1, 0], [0, 1])]
    assert [module.dimension for module in made] == [4, 5]
    assert all(failing_pair(m.representation.algebra, m.representation.matrices) is None for m in made)
    assert made[0].representation.algebra != lh.chevalley("B2")


def test_the_trivial_module() -> None:
    made = lh.highest_weight_module("E6", [0] * 6)
    assert made.dimension == 1 and all(a.is_zero() for a in made.representation.matrices)
    assert repr(made) == "<module of highest weight (0, 0, 0, 0, 0, 0) of E6, dimension 1>"


@pytest.mark.parametrize(("kind", "weight"), [
    ("A2", [4, 4]), pytest.param("A2", [10, 10], marks=pytest.mark.slow),
    pytest.param("E8", [1, 0, 0, 0, 0, 0, 0, 0], marks=pytest.mark.slow),
    pytest.param("F4", [0, 0, 1, 1], marks=pytest.mark.slow),
], ids=str)  # fmt: skip
def test_generators_on_the_lattice_satisfy_their_relations(kind: str, weight: list[int]) -> None:
    """[e_i, f_j] = delta_ij h_i, also where the matrices of the whole algebra would not fit."""
    lattice = admissible_lattice(kind, weight)
    n = len(lattice.weights)
    assert n == lh.weyl_dimension(kind, weight)
    for i, e in enumerate(lattice.raising):
        for j, f in enumerate(lattice.lowering):
            for b in range(n):
                rest = combined(f, e[b], -1, combined(e, f[b], 1, {b: -lattice.weights[b][i]} if i == j else {}))
                assert not any(rest.values())


def combined(columns: Any, vector: dict[int, int], sign: int, total: dict[int, int]) -> dict[int, int]:
    for b, v in vector.items():
        for c, w in columns[b].items():
            total[c] = total.get(c, 0) + sign * v * w
    return total


def test_the_proof_by_generators_sees_a_wrong_entry_in_any_matrix() -> None:
    algebra = lh.chevalley("A2")
    rho = lh.highest_weight_module("A2", [1, 1]).representation
    columns = [[{b: int(x) for b, x in enumerate(row) if x != 0} for row in a.T.to_rows()] for a in rho.matrices]
    generators = [2, 3, 5, 6]
    assert failing_generator_pair(algebra.table, SparseStack(8, columns), generators) is None
    for j in range(8):
        wrong = [list(c) for c in columns]
        wrong[j][7] = {**wrong[j][7], 0: 5}
        assert failing_generator_pair(algebra.table, SparseStack(8, wrong), generators) is not None
    huge = [[{b: v * 10**25 for b, v in column.items()} for column in c] for c in columns]
    assert failing_generator_pair(algebra.table, SparseStack(8, huge), generators) is not None


def test_a_program_that_computes_wrong_matrices_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    names = lh.highest_weight_module.__globals__
    right = names["lattice_of"]

    def wrong(space: Any, top: Any) -> Any:
        lattice = right(space, top)
        raising = [list(columns) for columns in lattice.raising]
        raising[0][-1] = {0: 1}
        return type(lattice)(lattice.weights, tuple(map(tuple, raising)), lattice.lowering, lattice.recipes)

    monkeypatch.setitem(names, "lattice_of", wrong)
    with pytest.raises(RepresentationError, match="not a representation"):
        lh.highest_weight_module("A2", [1, 0])


def test_what_is_no_dominant_weight_is_refused() -> None:
    with pytest.raises(ShapeError, match="rank is 2"):
        lh.highest_weight_module("G2", [1])
    with pytest.raises(InputError, match="not dominant"):
        lh.highest_weight_module("G2", [-1, 0])
    with pytest.raises(InputError, match="not integral"):
        lh.highest_weight_module("G2", ["1/2", 0])
    with pytest.raises(CatalogError):
        lh.highest_weight_module("G3", [1, 0, 0])
    with pytest.raises(InputError, match="root system"):
        admissible_lattice(lh.so(3), [1])  # type: ignore[arg-type]


def test_matrices_that_would_not_fit_are_refused_at_once() -> None:
    with pytest.raises(InputError, match=r"GB; .*admissible_lattice"):
        lh.highest_weight_module("E8", [1, 0, 0, 0, 0, 0, 0, 0])


def test_dimensions_beyond_all_floats_are_refused() -> None:
    """rho of B50 has 2^2500 dimensions, that of so(100) 2^2450."""
    with pytest.raises(InputError, match=r"size about 10\^752 are about 10\^15"):
        lh.highest_weight_module("B50", [1] * 50)
    with pytest.raises(InputError, match="GB"):
        lh.real_module("so(100)", [1] * 50)


@settings(max_examples=examples(60))
@given(st.lists(st.lists(st.integers(-9, 9), min_size=2, max_size=2).filter(any), min_size=1, max_size=4))
def test_basis_of_the_lattice_spanned_by_integer_vectors(vectors: list[list[int]]) -> None:
    sparse = [{k: c for k, c in enumerate(vector) if c} for vector in vectors]
    basis, coordinates = _lattice_basis(sparse)
    for vector, combination in zip(sparse, coordinates, strict=True):
        total = [sum(c * basis[k][0].get(i, 0) for k, c in combination.items()) for i in range(2)]
        assert total == [vector.get(i, 0) for i in range(2)]
    for element, combination in basis:
        total = [sum(c * vectors[x][i] for x, c in combination.items()) for i in range(2)]
        assert total == [element.get(i, 0) for i in range(2)]
    assert len(basis) == QQ.matrix(vectors).rank()
