"""Laws of the structure theory: what a change of basis leaves alone, and what the parts of an algebra satisfy."""

import random
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import InputError, UndecidedError
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.structure.root_spaces import root_data
from liehom.testing import random_unimodular
from tests.sampling import examples


def with_module(name: str, form: Any) -> LieAlgebra:
    """The semidirect sum of an algebra with its defining module."""
    return lh.semidirect_sum(form, lh.defining(form).matrices, name=name)


ALGEBRAS: dict[str, LieAlgebra] = {
    "R^2": lh.abelian(2), "heisenberg(2)": lh.heisenberg(2), "e(2)": lh.euclidean(2), "e(3)": lh.euclidean(3),
    "gl(2)": lh.gl(2), "gl(3)": lh.gl(3), "so(4)": lh.so(4), "so(3,1)": lh.so(3, 1), "so(4,1)": lh.so(4, 1),
    "su(2,1)": lh.su(2, 1), "sl(2)+R^2": with_module("sl(2)+R^2", lh.sl(2)),
    "sp(4,R)+R^4": with_module("sp(4,R)+R^4", lh.sp(4, "R")),
    "so(3)+heisenberg(1)+R": lh.direct_sum(lh.so(3), lh.heisenberg(1), lh.abelian(1)),
    "sl(2)+so(3)": lh.direct_sum(lh.sl(2), lh.so(3)),
    "so(3) over QQ(sqrt(2))": lh.so(3).over(lh.number_field("sqrt(2)")),
}  # fmt: skip
SEMISIMPLE = {name: g for name, g in ALGEBRAS.items() if g.is_semisimple()}

names = st.sampled_from(sorted(ALGEBRAS))
semisimple = st.sampled_from(sorted(SEMISIMPLE))
seeds = st.integers(0, 10**6)
few = settings(max_examples=examples(25), deadline=None)


def scrambled(algebra: LieAlgebra, seed: int) -> LieAlgebra:
    """The algebra in a random basis with small numbers, one row divided by a small prime."""
    n, rng = algebra.dimension, random.Random(seed)
    rows: list[list[Any]] = [list(row) for row in random_unimodular(n, rng, 2 * n)] if n > 1 else [[1]]
    place, divisor = rng.randrange(n), rng.choice([1, 2, 3])
    rows[place] = [lh.QQ.convert(x) / divisor for x in rows[place]]
    return algebra.change_of_basis(rows)


def invariants(g: LieAlgebra) -> dict[str, Any]:
    levi = g.levi_decomposition()
    return {
        "centre": g.center().dimension,
        "derived": [h.dimension for h in g.derived_series()],
        "lower": [h.dimension for h in g.lower_central_series()],
        "killing": g.killing_signature(),
        "radical": g.radical().dimension,
        "nilradical": g.nilradical().dimension,
        "levi": levi.levi.as_algebra().killing_signature(),
        "cartan": g.cartan_subalgebra().dimension,
        "type": g.semisimple_type(),
        "real form": g.real_form(),
        "ideals": sorted(h.dimension for h in g.direct_sum_decomposition()),
        "kinds": (g.is_solvable(), g.is_nilpotent(), g.is_semisimple(), g.is_simple()),
        "derivations": g.derivations().dimension,
        "cohomology": [g.cohomology(k).dimension for k in range(3)],
        "card": [line for line in g.describe().splitlines()[1:] if not set(line.split()) & {"isomorphic", "tables"}],
    }


@few
@given(names, seeds)
def test_invariants_do_not_depend_on_the_basis(name: str, seed: int) -> None:
    assert invariants(scrambled(ALGEBRAS[name], seed)) == invariants(ALGEBRAS[name])


@few
@given(names, seeds)
def test_levi_factor_and_radical(name: str, seed: int) -> None:
    g = scrambled(ALGEBRAS[name], seed)
    levi, radical = g.levi_decomposition().levi, g.levi_decomposition().radical
    lh.Subalgebra(g, levi.basis)  # proves that it is closed
    assert levi.as_algebra().is_semisimple()
    assert radical.is_ideal() and radical.as_algebra().is_solvable()
    together = g.field.stack_rows([levi.basis, radical.basis], g.dimension)
    assert together.rank() == g.dimension == levi.dimension + radical.dimension


@few
@given(names, seeds)
def test_nilradical_lies_between_its_bounds(name: str, seed: int) -> None:
    g = scrambled(ALGEBRAS[name], seed)
    nilradical, radical = g.nilradical(), g.radical()
    assert nilradical.is_ideal() and nilradical.as_algebra().is_nilpotent()
    assert radical.subspace.includes(nilradical.subspace)
    for x in radical.rows():
        for y in g.field.identity(g.dimension).to_rows():
            assert g.bracket(y, x) in nilradical
    # no ideal between: every element of the radical outside acts with a non-zero eigenvalue
    for x in radical.rows():
        nilpotent = all(c == 0 for c in g.ad(x).characteristic_coefficients()[:-1])
        assert nilpotent == (x in nilradical)


@few
@given(names, seeds)
def test_cartan_subalgebra_is_nilpotent_and_its_own_normalizer(name: str, seed: int) -> None:
    g = scrambled(ALGEBRAS[name], seed)
    h = g.cartan_subalgebra()
    assert lh.Subalgebra(g, h.basis).as_algebra().is_nilpotent()
    assert g.normalizer(h) == h


@few
@given(semisimple, seeds)
def test_roots_are_joint_eigenvalues(name: str, seed: int) -> None:
    """Traces of powers of ad h_j are power sums of the alpha(h_j): exact numbers inside narrow balls."""
    g = scrambled(SEMISIMPLE[name], seed)
    data = root_data(g)
    assert len(data.roots) == g.dimension - data.cartan.dimension
    for j, x in enumerate(data.cartan.rows()):
        action = g.ad(x)
        square = action @ action
        for power, matrix in ((1, action), (2, square), (4, square @ square)):
            total = sum(values[j] ** power for values in data.spectrum.values)
            exact = g.field.to_float(matrix.trace())
            size = max(1.0, max(float(abs(values[j]).mid()) for values in data.spectrum.values)) ** power
            assert abs(float(total.real.mid()) - exact) <= float(total.rad()) + 1e-12 * size
            # balls of different roots are disjoint, no more: their sum may be as wide as the largest root
            assert power > 1 or float(total.rad()) <= size
    assert {tuple(-x for x in root) for root in data.roots} == set(data.roots) == set(data.root_system.roots)


@pytest.mark.parametrize("name", ["sl(3)", "sp(4,R)", "g2(2)"])
def test_root_vectors_of_a_split_algebra_are_eigenvectors(name: str) -> None:
    g = {"sl(3)": lh.sl(3), "sp(4,R)": lh.sp(4, "R"), "g2(2)": lh.chevalley("G2")}[name]
    h = g.cartan_subalgebra()
    data = root_data(g, h)
    assert data.spectrum.conjugation == tuple(range(len(data.roots)))  # all roots are real on h
    for values in data.spectrum.values:
        # [h_j, v] = alpha(h_j) v has a solution line, alpha(h_j) the integers in the balls
        labels = [value.real.unique_fmpz() for value in values]
        assert None not in labels
        blocks = [
            (g.ad(x) - g.field.identity(g.dimension).scale(int(c))).T for x, c in zip(h.rows(), labels, strict=True)
        ]
        assert g.field.stack_columns(blocks, g.dimension).left_null_space().nrows == 1


@few
@given(semisimple, seeds)
def test_simple_ideals_are_ideals_and_fill(name: str, seed: int) -> None:
    g = scrambled(SEMISIMPLE[name], seed)
    ideals = g.simple_ideals()
    assert sum(h.dimension for h in ideals) == g.dimension
    for h in ideals:
        assert h.is_ideal()
        assert h.as_algebra().is_simple()


def test_an_ideal_that_splits_over_the_reals_only() -> None:
    """so(3) for x^2 + y^2 - sqrt(2) z^2, restricted to QQ: simple over QQ, so(3) + sl(2,R) over the reals."""
    r = lh.number_field("sqrt(2)")
    brackets = {(0, 1): {2: 1}, (1, 2): {0: "sqrt(2)"}, (0, 2): {1: "-sqrt(2)"}}
    assert lh.LieAlgebra(brackets, r, dimension=3).real_form() == "so(3)"
    rational: dict[tuple[int, int], dict[int, int]] = {}
    for (i, j), row in brackets.items():
        (k, value), sign = next(iter(row.items())), -1 if str(next(iter(row.values()))).startswith("-") else 1
        for a in range(2):
            for b in range(2):
                power = a + b + ("sqrt" in str(value))  # of sqrt(2)
                rational[(i + 3 * a, j + 3 * b)] = {k + 3 * (power % 2): sign * 2 ** (power // 2)}
    g = lh.LieAlgebra(rational, dimension=6)
    assert [h.dimension for h in g.direct_sum_decomposition()] == [6]
    assert g.real_form() == "so(3) + sl(2,R)" and g.semisimple_type() == "A1 + A1"
    assert not g.is_simple() and g.real_rank() == 1
    first, second = g.simple_ideals()
    assert first.algebra.field.degree == 2 and first.dimension == second.dimension == 3
    assert {h.as_algebra().real_form() for h in (first, second)} == {"so(3)", "sl(2,R)"}


def test_semisimple_methods_raise_on_other_algebras() -> None:
    g = lh.euclidean(3)
    assert not g.is_isomorphic(lh.so(4))
    for question in (g.root_system, g.cartan_decomposition):
        with pytest.raises(InputError, match=r"semisimple|radical"):
            question()
    with pytest.raises(InputError, match="semisimple"):
        root_data(g)


def test_exact_methods_raise_on_floats() -> None:
    g = lh.so(4).over(lh.RR)
    for question in (g.nilradical, g.levi_decomposition, g.cartan_subalgebra, g.real_form, g.semisimple_type):
        with pytest.raises(UndecidedError, match=r"exact.*lh\.rationalize"):
            question()
    assert g.radical().dimension == 0 and g.is_semisimple() and "numerically" in g.describe()


def test_the_zero_algebra_has_answers() -> None:
    g = lh.abelian(0)
    assert g.radical().dimension == g.nilradical().dimension == g.cartan_subalgebra().dimension == 0
    assert g.levi_decomposition().levi.dimension == 0
    assert g.semisimple_type() == g.real_form() == "0"
    assert g.is_semisimple() and g.is_nilpotent() and g.is_solvable() and not g.is_simple()
    assert g.simple_ideals() == [] and g.real_rank() == 0
    assert g.root_system().rank == 0 and "zero" in g.describe()
    k, p = g.cartan_decomposition()
    assert k.dimension == p.dimension == 0


CARDS = {
    "so(4,1)": (lh.so(4, 1), "simple, real form so(4,1), rank 2, real rank 1, maximal compact so(4)"),
    "so(4)": (lh.so(4), "semisimple, real form so(3) + so(3), rank 2, real rank 0, maximal compact so(3)+so(3)"),
    "so(3,1)": (lh.so(3, 1), "simple, real form sl(2,C), rank 2, real rank 1, maximal compact so(3)"),
    "heisenberg": (lh.heisenberg(3), "nilpotent of class 2"),
    "R^3": (lh.abelian(3), "abelian"),
    "gl(2)": (lh.gl(2), "reductive: Levi factor of dimension 3, radical of dimension 1"),
}


@pytest.mark.parametrize("name", sorted(CARDS))
def test_summary_has_the_expected_lines(name: str) -> None:
    algebra, line = CARDS[name]
    assert line in algebra.describe()
    assert line in scrambled(algebra, 5).describe()


@few
@given(semisimple, seeds)
def test_root_spaces_fill_and_are_preserved(name: str, seed: int) -> None:
    g = scrambled(SEMISIMPLE[name], seed)
    decomposition = g.root_space_decomposition()
    assert sum(space.space.dimension for space in decomposition.spaces) + decomposition.cartan.dimension == g.dimension
    for space in decomposition.spaces:
        for j, h in enumerate(decomposition.cartan.rows()):
            moved = space.space.basis @ g.ad(h).T
            if space.values is None:
                assert all(row in space.space for row in moved.to_rows())
            else:
                assert moved == space.space.basis.scale(space.values[j])


def test_the_root_spaces_of_a_split_algebra_multiply() -> None:
    g = lh.chevalley("G2")
    decomposition = g.root_space_decomposition()
    assert decomposition.is_split and len(decomposition.spaces) == 12
    by_values = {space.values: space.space for space in decomposition.spaces}
    for a, space in by_values.items():
        for b, other in by_values.items():
            total = tuple(x + y for x, y in zip(a, b, strict=True))
            bracket = g.bracket(space.rows()[0], other.rows()[0])
            if any(total) and total not in by_values:
                assert not any(bracket)
            elif total in by_values:
                assert list(bracket) in by_values[total] and any(bracket)


def test_subalgebra_of_another_algebra_raises_input_error() -> None:
    g, foreign = lh.so(3), lh.heisenberg(1).subalgebra([[0, 0, 1]])
    for question in (g.normalizer, g.centralizer, g.ideal_generated_by, g.subalgebra_generated_by):
        with pytest.raises(InputError, match="is not a subalgebra of"):
            question(foreign)
    with pytest.raises(InputError, match="belongs to"):
        g.center().intersection(foreign)
    assert g.normalizer([[1, 0, 0]]).dimension == 1


def test_series_and_small_questions() -> None:
    n = lh.algebra.strictly_upper_triangular(4)
    assert [h.dimension for h in n.upper_central_series()] == [0, 1, 3, 6]
    assert lh.gl(3).derived_subalgebra().dimension == 8 and lh.gl(3).rank() == 3
    assert lh.gl(2).is_reductive() and not lh.euclidean(3).is_reductive()
    levi, radical = lh.gl(2).levi_decomposition()
    assert levi.intersection(radical).dimension == 0 and lh.gl(2).derived_subalgebra().includes(levi)
    with pytest.raises(InputError, match="number_field"):
        lh.so(3).over("sqrt(2)")  # type: ignore[arg-type]
    assert lh.semidirect_sum(lh.so(3), lh.defining(lh.so(3))).dimension == 6
    assert lh.so(3).cohomology(0, lh.adjoint(lh.so(3))).dimension == 0
