"""Irreducible real modules of real forms: commutants, the tables of spinors, invariant forms, stabilisers, refusals."""

from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import CatalogError, InputError, RepresentationError, ShapeError
from liehom.exact.algebra.roots.chevalley import real_form_of
from liehom.exact.algebra.roots.real_form import RealForm, complex_form
from liehom.exact.representations.highest_weight import real_modules as real_structure
from liehom.exact.representations.highest_weight.highest_weight import admissible_lattice
from liehom.exact.representations.invariants.representation_identity import failing_pair
from tests.sampling import examples

COMMUTANT = {"R": 1, "C": 2, "H": 4}
SMALL_TYPES = ("A1", "A2", "A3", "B2", "B3", "C3", "D4", "G2")

# the commutants of the smallest modules, from the tables of real representations
KNOWN = [
    ("so(3)", [1], "H", 4), ("so(3)", [2], "R", 3), ("sl(2,R)", [1], "R", 2), ("sl(2,C)", [1, 0], "C", 4),
    ("sl(2,C)", [1, 1], "R", 4), ("su(3)", [1, 0], "C", 6), ("su(3)", [1, 1], "R", 8), ("sl(3,R)", [1, 0], "R", 3),
    ("su(2,1)", [1, 0], "C", 6), ("sl(2,H)", [1, 0, 0], "H", 8), ("sl(2,H)", [0, 1, 0], "R", 6),
    ("su(2,2)", [0, 1, 0], "R", 6), ("su(3,1)", [0, 1, 0], "H", 12), ("so(4,1)", [1, 0], "R", 5),
    ("so(4,1)", [0, 1], "H", 8), ("so(3,2)", [0, 1], "R", 4), ("sp(2,1)", [1, 0, 0], "H", 12),
    ("sp(6,R)", [1, 0, 0], "R", 6), ("so*(10)", [1, 0, 0, 0, 0], "H", 20), ("so(6,2)", [1, 0, 0, 0], "R", 8),
    ("so(6,2)", [0, 0, 1, 0], "H", 16), ("g2", [1, 0], "R", 7), ("g2(2)", [1, 0], "R", 7),
    ("f4", [0, 0, 0, 1], "R", 26), ("f4(-20)", [0, 0, 0, 1], "R", 26), ("e6", [1, 0, 0, 0, 0, 0], "C", 54),
    ("e6(2)", [0, 0, 0, 0, 0, 1], "C", 54), ("e6(-14)", [1, 0, 0, 0, 0, 0], "C", 54),
    ("e6(-26)", [1, 0, 0, 0, 0, 0], "R", 27), ("e6(6)", [0, 0, 0, 0, 0, 1], "R", 27),
    ("e7", [0, 0, 0, 0, 0, 0, 1], "H", 112), ("e7(-5)", [0, 0, 0, 0, 0, 0, 1], "H", 112),
    ("e7(-25)", [0, 0, 0, 0, 0, 0, 1], "R", 56), ("e7(7)", [0, 0, 0, 0, 0, 0, 1], "R", 56),
]  # fmt: skip


@pytest.mark.parametrize(("name", "weight", "letter", "dimension"), KNOWN, ids=str)
def test_the_smallest_modules_are_those_of_the_tables(
    name: str, weight: list[int], letter: str, dimension: int
) -> None:
    assert lh.representations.real_module_type(name, weight) == letter
    module = lh.real_module(name, weight)
    rho = module.representation
    assert (module.division_algebra, module.dimension, rho.size) == (letter, dimension, dimension)
    assert rho.algebra == real_form_of(RealForm.of_name(name).vogan)
    if dimension <= 30:
        assert len(rho.commutant()) == COMMUTANT[letter] and rho.is_irreducible()
        assert failing_pair(rho.algebra, rho.matrices) is None  # without reliance on generators


@st.composite
def modules(draw: st.DrawFn) -> tuple[RealForm, list[int]]:
    kind = draw(st.sampled_from(SMALL_TYPES))
    form = draw(st.sampled_from([*lh.real_forms(kind), complex_form(kind)]))
    rank = form.root_system().rank
    weight = draw(st.lists(st.integers(0, 2 if rank < 3 else 1), min_size=rank, max_size=rank))
    kept = draw(st.sets(st.integers(0, rank - 1), max_size=2))
    return form, [x if i in kept else 0 for i, x in enumerate(weight)]


@given(module=modules())
@settings(deadline=None, max_examples=examples(25))
def test_the_square_of_the_conjugation_is_the_sign_of_the_formula(module: tuple[RealForm, list[int]]) -> None:
    form, weight = module
    letter = lh.representations.real_module_type(form, weight)
    if letter == "C":
        return
    columns = real_structure.conjugation(form.vogan, admissible_lattice(form.root_system(), weight))
    sign = 1 if letter == "R" else -1
    for b, column in enumerate(columns):
        square: dict[int, int] = {}
        for c, v in column.items():
            for d, w in columns[c].items():
                square[d] = square.get(d, 0) + v * w
        assert {d: v for d, v in square.items() if v} == {b: sign}


@given(module=modules())
@settings(deadline=None, max_examples=examples(15))
def test_every_module_of_every_real_form_is_a_representation(module: tuple[RealForm, list[int]]) -> None:
    """Proved at construction; the compact ones keep a definite form, and the dimension is one or two complex ones."""
    form, weight = module
    complex_dimension = lh.weyl_dimension(form.root_system(), weight)
    if complex_dimension > 150:
        return
    made = lh.real_module(form, weight)
    assert made.dimension == complex_dimension * (1 if made.division_algebra == "R" else 2)
    if made.dimension <= 20 and form.is_compact:
        forms = made.representation.invariant_forms().symmetric
        signatures = {form.signature() for form in forms[:1]} if made.division_algebra == "R" else set()
        assert signatures <= {(made.dimension, 0, 0), (0, made.dimension, 0)}


@pytest.mark.parametrize("n", range(5, 12))
def test_spinors_have_the_commutants_of_the_table_of_clifford_algebras(n: int) -> None:
    """so(p, q) by its Vogan diagram, beside `spinor_type` by p - q modulo 8."""
    for q in range(n // 2 + 1):
        form = RealForm.of_name(f"so({n - q},{q})" if q else f"so({n})")
        rank = n // 2
        for node in {rank - 1, rank - 1 - (n % 2 == 0)}:
            weight = {"A3": ([1, 0, 0], [0, 0, 1])[node - 1] if n == 6 else None}.get(form.type)
            found = lh.representations.real_module_type(form, weight or [int(i == node) for i in range(rank)])
            assert found == lh.spinor_type(n - q, q).division_algebra


def test_the_compact_form_follows_the_indicator() -> None:
    letters = {1: "R", -1: "H", 0: "C"}
    for kind in ("A2", "A3", "B3", "C3", "D4", "G2"):
        compact = lh.real_forms(kind)[-1]
        assert compact.is_compact
        rank = lh.root_system(kind).rank
        for code in range(3**rank):
            weight = [code // 3**i % 3 for i in range(rank)]
            assert (
                lh.representations.real_module_type(compact, weight)
                == letters[lh.representations.frobenius_schur_indicator(kind, weight)]
            )


def test_the_split_form_has_real_modules_only() -> None:
    for kind in ("A1", "A2", "A3", "A4", "B3", "C3", "D4", "D5", "E6", "E7", "F4", "G2"):
        split = lh.real_forms(kind)[0]
        rank = split.rank
        assert split.is_split
        for i in range(rank):
            assert lh.representations.real_module_type(split, [int(i == j) for j in range(rank)]) == "R"


@pytest.mark.parametrize(("name", "weight", "generic"), [
    ("g2", [1, 0], 8), ("f4", [0, 0, 0, 1], 28), ("f4(-20)", [0, 0, 0, 1], 28), ("e6(-26)", [1, 0, 0, 0, 0, 0], 52),
    ("e7(-25)", [0, 0, 0, 0, 0, 0, 1], 78), ("e6(-14)", [0, 1, 0, 0, 0, 0], 6), ("e7(-5)", [1, 0, 0, 0, 0, 0, 0], 7),
])  # fmt: skip
def test_stabilisers_of_a_generic_vector(name: str, weight: list[int], generic: int) -> None:
    rho = lh.real_module(name, weight).representation
    point = [(7 * i * i + 3 * i) % 19 - 9 for i in range(rho.size)]
    assert rho.isotropy(point).dimension == generic


def test_the_algebra_is_the_one_of_simple_where_that_has_no_matrices() -> None:
    module = lh.real_module("e7(-25)", [0, 0, 0, 0, 0, 0, 1])
    assert module.representation.algebra == lh.simple("E7", "e7(-25)")
    assert repr(module) == (
        "<real module of highest weight (0, 0, 0, 0, 0, 0, 1) of e7(-25), dimension 56 over R, commutant R>"
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", ["e8", "e8(-24)", "e8(8)"])
def test_the_adjoint_module_of_e8(name: str) -> None:
    module = lh.real_module(name, [0, 0, 0, 0, 0, 0, 0, 1])
    point = [(7 * i * i + 3 * i) % 19 - 9 for i in range(248)]
    assert module.representation.isotropy(point).dimension == 8


def test_a_program_that_computes_wrong_matrices_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    names = lh.real_module.__globals__
    right = names["chevalley_matrices"]

    def wrong(roots: Any, lattice: Any) -> Any:
        made = [list(columns) for columns in right(roots, lattice)]
        made[-1][0] = {0: 1}
        return made

    monkeypatch.setitem(names, "chevalley_matrices", wrong)
    with pytest.raises(RepresentationError, match="not respected"):
        lh.real_module("su(2,1)", [1, 0])


def test_what_is_no_form_or_no_weight_is_refused() -> None:
    with pytest.raises(CatalogError):
        lh.real_module("so(4)", [1, 0])
    with pytest.raises(InputError, match="real form"):
        lh.real_module(lh.so(3), [1])  # type: ignore[arg-type]
    with pytest.raises(ShapeError):
        lh.real_module("sl(2,C)", [1])
    with pytest.raises(InputError, match="not dominant"):
        lh.representations.real_module_type("g2", [-1, 0])


def test_matrices_that_would_not_fit_are_refused_at_once() -> None:
    with pytest.raises(InputError, match=r"GB; .*admissible_lattice"):
        lh.real_module("e7(-5)", [1, 1, 1, 1, 1, 1, 1])


def test_weights_are_numbered_by_the_canonical_type() -> None:
    assert [lh.real_module("sp(4,R)", weight).dimension for weight in ([1, 0], [0, 1])] == [5, 4]
    for ask in (lh.real_module, lh.representations.real_module_type):
        with pytest.raises(ShapeError, match=r"weights of so\(3,2\) are numbered by its type B2"):
            ask("sp(4,R)", [1, 0, 0])
