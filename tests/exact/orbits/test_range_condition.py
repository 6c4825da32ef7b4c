"""The range condition: at one psi, generically, and where it fails."""

import random
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

import liehom as lh
from liehom.base.errors import FieldError, InputError, ShapeError, UndecidedError
from liehom.exact.algebra import linear as families
from liehom.exact.algebra.linear.named_matrices import linear_lie_algebra
from liehom.exact.scalars.floating import RR
from liehom.exact.scalars.rational import QQ
from liehom.testing import random_unimodular

SQRT2 = lh.number_field("sqrt(2)")


def affine(matrices: Any) -> lh.Pair:
    """(h + V, h) for integer matrices h on V."""
    made = np.asarray(matrices)
    h = linear_lie_algebra(made)
    g = lh.semidirect_sum(h, [m.tolist() for m in made])
    return lh.Pair(g, [[int(i == j) for j in range(g.dimension)] for i in range(h.dimension)])


def blocks(*families_: Any) -> np.ndarray[Any, Any]:
    """The direct sum of algebras on the direct sum of their spaces."""
    total = sum(f.shape[1] for f in families_)
    made, start = [], 0
    for f in families_:
        n = f.shape[1]
        made += list(np.pad(f, ((0, 0), (start, total - start - n), (start, total - start - n))))
        start += n
    return np.array(made)


def scrambled(pair: lh.Pair, seed: int) -> lh.Pair:
    """The same pair in a random unimodular basis."""
    return pair.change_of_basis(random_unimodular(pair.algebra.dimension, random.Random(seed)))


def on_v(pair: lh.Pair, x: list[Any]) -> list[Any]:
    """An element of g over the point x of V, for an affine pair."""
    return [0] * pair.subalgebra.dimension + x


UPPER = families.gl(3)[[0, 1, 2, 4, 5, 8]]
CASES: dict[str, tuple[Any, bool | None, int | None]] = {
    # pair, whether (6.3) holds generically, degree of the relative invariant
    "so(4)/so(3)": (lh.defining("so(4)").pair([1, 0, 0, 0]), True, 2),
    "so(3,1)/so(2,1)": (lh.defining("so(3,1)").pair([1, 0, 0, 0]), True, 2),
    "g2/su(3)": (lh.defining("g2").pair([1] + [0] * 6), True, 2),
    "binary quadratics": (affine(families.symmetric_power(families.gl(2), 2)), True, 2),
    "binary cubics": (affine(families.symmetric_power(families.gl(2), 3)), True, 4),
    "binary quartics": (affine(families.symmetric_power(families.gl(2), 4)), False, None),
    "ternary quadratics": (affine(families.symmetric_power(families.gl(3), 2)), True, 3),
    "upper triangular": (affine(UPPER), True, 1),
    "sl(3)": (affine(families.sl(3)), True, 0),
    "so(3) + so(3)": (affine(blocks(families.so(3), families.so(3))), False, None),
    "so(4) + so(3)": (affine(blocks(families.so(4), families.so(3))), False, None),
    "sym 2+2": (lh.sym_conjugation(4).pair([1, 0, 0, 0, 1, 0, 0, 2, 0, 2]), False, None),
    "sym 3+1": (lh.sym_conjugation(4).pair([1, 0, 0, 0, 1, 0, 0, 1, 0, 2]), True, 2),
    "h = 0, d = 1": (lh.Pair(lh.abelian(1), []), True, 1),
    "h = 0, d = 2": (lh.Pair(lh.abelian(2), []), False, None),
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("seed", [None, 1, 2])
def test_generic_answers_and_relative_invariants(name: str, seed: int | None) -> None:
    pair, holds, degree = CASES[name]
    pair = pair if seed is None or pair.algebra.dimension < 2 else scrambled(pair, seed)
    condition = lh.range_condition(pair)
    assert condition.generic and not condition.equilibrium and condition.holds is holds
    assert (condition.rank == condition.dimension) is holds and (condition.missing is None) is holds
    invariant = lh.orbits.relative_invariant(pair)
    assert (invariant.degree if invariant is not None else None) == degree
    if condition.missing is not None:
        check_missing(pair, condition.psi, condition.missing)


def check_missing(pair: lh.Pair, psi: list[Any], covector: list[Any]) -> None:
    """Not zero, and zero on h, on psi and on [h, psi]: straight from the structure constants."""
    phi = pair.field.matrix([covector]).T
    assert not phi.is_zero() and (pair.subalgebra.basis @ phi).is_zero() and (pair.algebra.row(psi) @ phi).is_zero()
    for z in pair.subalgebra.rows():
        assert (pair.field.matrix([list(pair.algebra.bracket(z, psi))]) @ phi).is_zero()


@given(data=st.data())
def test_the_relative_invariant_is_where_it_fails(data: st.DataObject) -> None:
    """f(psi) = 0 implies failure; for these pairs failure implies f(psi) = 0, too, but for a cone of codimension 2."""
    name = data.draw(st.sampled_from(["so(3,1)/so(2,1)", "binary quadratics", "binary cubics", "upper triangular"]))
    pair = CASES[name][0]
    psi = data.draw(st.lists(st.integers(-3, 3), min_size=pair.algebra.dimension, max_size=pair.algebra.dimension))
    invariant = lh.orbits.relative_invariant(pair)
    condition = lh.range_condition(pair, psi)
    assert condition.holds is not (invariant(psi) == 0)
    if not condition.holds:
        check_missing(pair, psi, condition.missing)


def test_binary_forms_on_and_off_the_discriminant() -> None:
    quadratics, cubics = CASES["binary quadratics"][0], CASES["binary cubics"][0]
    assert lh.range_condition(quadratics, on_v(quadratics, [1, 0, 1])).holds  # x^2 + y^2
    assert not lh.range_condition(quadratics, on_v(quadratics, [1, 2, 1])).holds  # (x + y)^2
    assert lh.range_condition(cubics, on_v(cubics, [1, 0, -1, 0])).holds  # x (x - y)(x + y)
    assert not lh.range_condition(cubics, on_v(cubics, [0, 1, 0, 0])).holds  # x^2 y
    assert str(lh.orbits.relative_invariant(quadratics)) == "x1^2 - 4*x0*x2"


def test_upper_triangular_matrices() -> None:
    pair = CASES["upper triangular"][0]
    assert str(lh.orbits.relative_invariant(pair)) == "x2" and lh.range_condition(pair, on_v(pair, [0, 0, 1])).holds
    assert not lh.range_condition(pair, on_v(pair, [1, 1, 0])).holds


def test_the_null_cone_of_a_lorentzian_space() -> None:
    pair = CASES["so(3,1)/so(2,1)"][0]
    lift = pair.subalgebra.quotient().lift
    null, space = QQ.matrix([[1, 0, 1]]) @ lift, QQ.matrix([[1, 1, 1]]) @ lift
    assert not lh.range_condition(pair, null.row(0)).holds and lh.range_condition(pair, space.row(0)).holds


def test_psi_in_h_is_an_equilibrium() -> None:
    pair = CASES["so(4)/so(3)"][0]
    condition = lh.range_condition(pair, pair.subalgebra.rows()[1])
    assert condition.equilibrium and condition.holds is False and condition.rank == 0
    assert "equilibrium" in condition.message
    check_missing(pair, condition.psi, condition.missing)
    assert lh.range_condition(pair, [0] * 6).equilibrium


def test_h_equal_to_g() -> None:
    pair = lh.Pair(lh.so(3), [[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    for psi in (None, [1, 2, 3]):
        condition = lh.range_condition(pair, psi)
        assert condition.holds and condition.dimension == 0 and condition.missing is None
    assert lh.range_condition(pair, [1, 2, 3]).equilibrium and lh.orbits.relative_invariant(pair) is None
    assert lh.orbits.failure_cone(pair) == []
    zero = lh.Pair(lh.abelian(0), [])
    assert lh.range_condition(zero).holds and lh.range_condition(zero, []).holds


@given(data=st.data())
def test_one_psi_in_two_bases_and_two_fields(data: st.DataObject) -> None:
    name = data.draw(st.sampled_from(["so(4)/so(3)", "so(3,1)/so(2,1)", "binary quadratics", "sym 2+2"]))
    pair = CASES[name][0]
    n = pair.algebra.dimension
    psi = data.draw(st.lists(st.integers(-3, 3), min_size=n, max_size=n))
    rows = data.draw(st.lists(st.lists(st.integers(-2, 2), min_size=n, max_size=n), min_size=n, max_size=n))
    matrix = QQ.matrix(rows)
    condition = lh.range_condition(pair, psi)
    if matrix.rank() == n:
        moved = lh.range_condition(pair.change_of_basis(matrix), (QQ.matrix([psi]) @ matrix.inverse()).row(0))
        assert (moved.holds, moved.rank, moved.equilibrium) == (condition.holds, condition.rank, condition.equilibrium)
    over = lh.Pair(pair.algebra.over(SQRT2), pair.subalgebra.rows())
    assert lh.range_condition(over, psi).rank == condition.rank
    floats = lh.Pair(pair.algebra.over(RR), pair.subalgebra.basis.to_numpy().tolist())
    numerical = lh.range_condition(floats, [float(v) for v in psi])
    assert (numerical.rank, numerical.equilibrium) == (condition.rank, condition.equilibrium)
    if not numerical.equilibrium:
        assert numerical.numerical is not None and numerical.numerical.gap > 1e3
    if numerical.missing is not None:
        phi = np.array(numerical.missing)
        images = [floats.algebra.bracket(z, [float(v) for v in psi]) for z in floats.subalgebra.rows()]
        assert np.abs(np.array([*floats.subalgebra.rows(), psi, *images], dtype=float) @ phi).max() < 1e-9


@pytest.mark.parametrize("name", CASES)
def test_float_pairs_agree_generically(name: str) -> None:
    pair, holds, _ = CASES[name]
    floats = lh.Pair(
        pair.algebra.over(RR), pair.subalgebra.basis.to_numpy().reshape(-1, pair.algebra.dimension).tolist()
    )
    condition = lh.range_condition(floats)
    assert condition.holds is holds
    with pytest.raises(FieldError):
        lh.orbits.relative_invariant(floats)


def test_never_over_a_number_field_is_proved_too() -> None:
    pair = CASES["so(3) + so(3)"][0]
    over = lh.Pair(pair.algebra.over(SQRT2), pair.subalgebra.rows())
    n = over.algebra.dimension
    rows = [[int(i == j) for j in range(n)] for i in range(n)]
    rows[n - 1][n - 2] = "sqrt(2)"
    rows[n - 3][n - 5] = "1 + sqrt(2)"
    condition = lh.range_condition(over.change_of_basis(rows))
    assert condition.holds is False and "rational functions" in condition.message
    with pytest.raises(FieldError):
        lh.orbits.relative_invariant(over)


@pytest.mark.parametrize(("matrices", "rank"), [
    (blocks(families.so(6), families.so(6)), 11), (blocks(*[families.so(2, 1)] * 8), 17),
], ids=["compact", "not compact"])  # fmt: skip
def test_generic_ranks_in_large_dimensions_are_proved(matrices: Any, rank: int) -> None:
    pair = affine(matrices)
    condition = lh.range_condition(pair)
    assert condition.holds is False and "rational functions" in condition.message
    assert condition.rank == lh.orbits.orbit_dimension(pair) == rank
    check_missing(pair, condition.psi, condition.missing)


def test_what_is_not_proved_is_not_claimed() -> None:
    """Hom(R^8, R^9) on R^17, an abelian algebra whose orbits have dimension 9; with R it is 10."""
    matrices = np.zeros((72, 17, 17), dtype=int)
    for k in range(72):
        matrices[k, k // 8, 9 + k % 8] = 1
    pair = affine(matrices)
    condition = lh.range_condition(pair)
    assert condition.holds is None and "not proved" in condition.message and condition.rank == 10
    with pytest.raises(UndecidedError, match="takes 31824 ranks"):
        lh.orbits.orbit_dimension(pair)
    check_missing(pair, condition.psi, condition.missing)
    with pytest.raises(UndecidedError):
        bool(condition)
    with pytest.raises(InputError):
        lh.orbits.relative_invariant(pair)
    assert "undecided" in repr(condition)


def test_refusals() -> None:
    pair = CASES["so(4)/so(3)"][0]
    with pytest.raises(ShapeError):
        lh.range_condition(pair, [1, 2, 3])
    with pytest.raises(FieldError):
        lh.range_condition(pair, [0.5, 0, 0, 0, 0, 0])


# -- the failure cone ----------------------------------------------------------------------------------------
def test_the_cone_by_an_invariant_form() -> None:
    pair = affine(families.so(3, 1))
    form = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, -1]]
    hypersurface, cone = lh.orbits.failure_cone(pair, forms=[form])
    assert hypersurface.kind == "hypersurface" and hypersurface.covers
    assert cone.kind == "null cone" and "(3, 1, 0)" in cone.description
    for x in ([1, 0, 0, 1], [3, 4, 0, 5]):
        assert not lh.range_condition(pair, on_v(pair, x)).holds and hypersurface.data(on_v(pair, x)) == 0


@pytest.mark.parametrize(("name", "codimension"), [
    ("sl(3,C)/P{1,2}", "2"), ("so(4)/so(3)", "3"), ("affine(form(1,2,5))", "3"),
    ("affine(blocks(gl(1,C),so(3)+R))", "2"), ("affine(so(3,C)+u(1)+R)", "at least 2"),
    ("affine(field(1,1,1,1))", None),
])  # fmt: skip
@pytest.mark.parametrize("seed", [None, 5])
def test_zeros_without_a_change_of_sign_are_not_called_a_hypersurface(
    name: str, codimension: str | None, seed: int | None
) -> None:
    """The zeros of the last two have codimension 2, too: z^2 = 0 in C^3, and two factors over QQ(sqrt(5))."""
    pair = lh.pair(name) if seed is None else scrambled(lh.pair(name), seed)
    (zeros,) = lh.orbits.failure_cone(pair)
    end = f", of codimension {codimension}" if codimension else ", of a codimension that is not decided"
    assert zeros.kind == "zeros" and zeros.description == f"the real zeros of {zeros.data}{end}" and zeros.covers
    rng = random.Random(2)
    values = [zeros.data([rng.randint(-9, 9) for _ in range(pair.algebra.dimension)]) for _ in range(50)]
    assert min(values) >= 0 or max(values) <= 0


@pytest.mark.parametrize("name", [
    "so(3,1)/so(2,1)", "affine(S3(gl(2)))", "affine(upper(3))", "affine(field(-2,0,0))", "affine(field(-2,0,0,0))",
    "R/0", "affine(blocks(gl(1),gl(1,C)))",
])  # fmt: skip
def test_a_hypersurface_has_points_of_both_signs(name: str) -> None:
    pair = lh.pair(name)
    (zeros,) = lh.orbits.failure_cone(pair)
    rng = random.Random(1)
    values = [zeros.data([rng.randint(-9, 9) for _ in range(pair.algebra.dimension)]) for _ in range(400)]
    assert zeros.kind == "hypersurface" and min(values) < 0 < max(values)
    assert zeros.description == f"the zeros of {zeros.data}"


def test_forms_and_subspaces_are_checked() -> None:
    pair = affine(UPPER)
    assert lh.orbits.failure_cone(pair, subspaces=[[[1, 0, 0], [0, 1, 0]]])[-1].kind == "subspace"
    for bad in ([[0, 0, 1]], [[1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 0, 0]]):
        with pytest.raises(InputError):
            lh.orbits.failure_cone(pair, subspaces=[bad])
    for form in ([[1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0] * 3] * 3, [[0, 1, 0], [0, 0, 0], [0, 0, 0]]):
        with pytest.raises(InputError):
            lh.orbits.failure_cone(pair, forms=[form])
    with pytest.raises(ShapeError):
        lh.orbits.failure_cone(pair, forms=[[[1, 0], [0, 1]]])


def test_the_eigenspace_of_a_dominance_certificate() -> None:
    """so(2,2) on R^4: the top eigenspace of a boost is a null line."""
    pair = affine(families.so(2, 2))
    element = [0] * pair.algebra.dimension
    element[1] = 1  # a boost: eigenvalues 1, 0, 0, -1
    certificate = SimpleNamespace(
        kind="dominance", number=lambda name: QQ.convert("1/2"), vector=lambda name, n: element
    )
    part = lh.orbits.failure_cone(pair, certificate=certificate)[-1]
    assert part.kind == "eigenspace" and part.data.shape == (1, 4)
    x = part.data[0]
    floats = lh.Pair(pair.algebra.over(RR), pair.subalgebra.basis.to_numpy().tolist())
    assert lh.range_condition(floats, [0.0] * 6 + x.tolist()).holds is False
