"""The order condition as a decision, exactly and in floats."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

import liehom as lh
from liehom.base.errors import FieldError, InputError, ShapeError
from liehom.flow.action.frames import exact_gram_matrix
from liehom.flow.steps.order_conditions import OrderCondition, chi, order_condition
from tests.flow.steps.support import quadratic, spin, unit

QQ = lh.QQ
TEXTS = {3: ["m0*m1 + 1", "m2**2 - m0", "m1 + 1/2"], 6: ["m0 + m4", "m1*m5 - m2", "1 - m2*m3"]}


def exact(values: Any, field: Any = QQ) -> Any:
    out = np.empty(len(values), dtype=object)
    for i, x in enumerate(values):
        out[i] = field.convert(x)
    return out


def is_exact(found: OrderCondition) -> bool:
    values = [*found.chi, *found.zeta, *found.residual, found.c]
    return all(not isinstance(x, float | np.floating) for x in values) and found.numerical is None


SPACES = {
    "S^2": (lh.defining(lh.so(3)), TEXTS[3], ["3/5", "0", "4/5"], 2),
    "S^3": (lh.defining(lh.so(4)), ["m0*m1", "m2", "2 - m3", "m0", "m3*m3", "1"], ["1/2", "1/2", "-1/2", "1/2"], 3),
    "Sym(3) at (1,1,2)": (lh.sym_conjugation(3), TEXTS[6], [1, 0, 0, 1, 0, 2], 2),
    "SL(2) on R^2": (lh.defining(lh.sl(2)), ["m0", "m1*m0", "1"], ["1/3", "2"], 2),
    "gl(2) on R^2": (lh.defining(lh.gl(2)), ["m0", "m1*m0", "1", "m1 - 2"], ["1/3", "2"], 2),
    "the cone of so(2,1)": (lh.defining(lh.so(2, 1)), TEXTS[3], ["3/5", "4/5", "1"], 2),
}


@pytest.mark.parametrize("base", [lh.Euler(), lh.Heun()], ids=str)
@pytest.mark.parametrize("name", list(SPACES))
def test_exact_and_numerical_answers_agree(name: str, base: Any) -> None:
    rho, psi, point, dimension = SPACES[name]
    field, m = lh.GeneratorField(rho, psi), exact(point)
    n = base.order + 1
    condition = order_condition(field, base, m, n)
    assert is_exact(condition) and condition.solvable and condition.range_holds and bool(condition)
    assert condition.rank == condition.dimension == dimension and condition.leading == 1
    assert all(x == 0 for x in condition.residual)
    near = order_condition(field, base, np.array([QQ.to_float(x) for x in m]), n)
    assert near.solvable and near.range_holds and (near.rank, near.dimension) == (dimension, dimension)
    assert near.numerical is not None and near.numerical.rank == dimension
    assert near.singular_value is not None and near.singular_value > 1e-3
    for a, b in [(condition.chi, near.chi), (condition.zeta, near.zeta), ([condition.c], [near.c])]:
        assert np.allclose([QQ.to_float(x) for x in a], b, rtol=1e-12, atol=1e-13)
    # the solution solves: chi with zeta is n! c w_1
    zeta = np.array([0 * condition.zeta] * (n - 2) + [condition.zeta], dtype=object)
    w = field.vector(m)
    factorial = 2 if n == 2 else 6
    assert (chi(field, base, m, n, zeta) == factorial * condition.c * w).all()


def test_over_a_number_field() -> None:
    over = lh.number_field("sqrt(2)")
    rho = lh.defining(lh.so(3)).over(over)
    m = exact(["sqrt(2)/2", "0", "sqrt(2)/2"], over)
    condition = order_condition(lh.GeneratorField(rho, TEXTS[3]), lh.Euler(), m, 2)
    assert is_exact(condition) and condition.solvable and condition.rank == 2
    assert condition.c != 0 and "sqrt(2)" in str(condition.c)
    with pytest.raises(FieldError):
        order_condition(lh.GeneratorField(lh.defining(lh.so(3)), TEXTS[3]), lh.Euler(), m, 2)


def test_a_failing_point_exactly() -> None:
    rho = lh.sym_conjugation(3)
    condition = order_condition(lh.GeneratorField(rho, TEXTS[6]), lh.Euler(), exact([1, 0, 0, 2, 0, 3]), 2)
    assert is_exact(condition) and not condition.solvable and not condition.range_holds
    assert (condition.rank, condition.dimension) == (1, 3)
    assert any(x != 0 for x in condition.residual)
    text = str(condition)
    assert text.startswith("order 2 at m (l = 1): (5.5) fails for this step (a residual of size ")
    assert text.endswith("the range condition (6.2) does not hold for every step (rank 1 of 3)")
    # least squares: the residual is orthogonal to w_1, the only column
    w = lh.GeneratorField(rho, TEXTS[6]).vector(exact([1, 0, 0, 2, 0, 3]))
    assert sum(a * b for a, b in zip(condition.residual, w, strict=True)) == 0


@given(st.lists(st.fractions(min_value=-2, max_value=2, max_denominator=4), min_size=2, max_size=2), st.integers(1, 3))
def test_on_spheres_it_always_holds(parameters: list[Any], n: int) -> None:
    """Rational points of S^2 by stereographic projection, for Taylor steps of order n - 1 >= 1."""
    a, b = parameters
    square = a * a + b * b
    m = exact([2 * a / (1 + square), 2 * b / (1 + square), (square - 1) / (1 + square)])
    condition = order_condition(lh.GeneratorField(lh.defining(lh.so(3)), TEXTS[3]), lh.LieTaylor(n), m, n + 1)
    assert condition.solvable and (
        condition.leading == 0 or (condition.rank == condition.dimension == 2 and condition.range_holds)
    )


def test_the_exact_choice_is_the_least() -> None:
    """On the cone g_m is a plane in so(3,1) that acts with a kernel or not; compare with the solver in floats."""
    rho = lh.defining(lh.so(3, 1))
    psi = ["m0", "m1*m0", "1", "m3", "m2 - m0", "2"]
    field, m = lh.GeneratorField(rho, psi), exact(["1/3", "2/3", "2/3", "1"])
    condition = order_condition(field, lh.Euler(), m, 2)
    near = order_condition(field, lh.Euler(), np.array([QQ.to_float(x) for x in m]), 2)
    assert np.allclose([QQ.to_float(x) for x in condition.zeta], near.zeta, rtol=1e-12, atol=1e-13)
    assert np.isclose(QQ.to_float(condition.c), near.c)


@pytest.mark.parametrize("rho", [
    lh.defining(lh.so(4)), lh.defining(lh.so(3, 1)), lh.defining(lh.sl(3)), lh.adjoint(lh.su(2)),
    lh.defining(lh.so(3)).direct_sum(lh.representations.trivial(lh.so(3))), lh.representations.trivial(lh.so(3), 2),
    lh.Representation.from_matrices([[[1, 1], [0, 2]], [[0, 1], [0, 0]]]),
], ids=str)  # fmt: skip
def test_the_exact_inner_product_is_the_numerical_one(rho: Any) -> None:
    assert np.allclose(exact_gram_matrix(rho).to_numpy(), lh.Action(rho).inner_product.matrix)


@pytest.mark.parametrize("kind", [float, "exact"])
def test_leading_orders(kind: Any) -> None:
    """n <= l: isotropy does not enter; n > l: with the leading coefficient w_l, (6.1)."""
    field = lh.GeneratorField(lh.defining(lh.so(3)), ["t*m0 + t", "t*m1", "2*t"])
    m = exact(["3/5", "0", "4/5"]) if kind == "exact" else np.array([0.6, 0.0, 0.8])
    early = order_condition(field, lh.Euler(), m, 2)
    assert early.leading == 2 and not early.solvable and early.range_holds and early.rank == 2
    assert all(x == 0 for x in early.zeta) and early.c == 0
    late = order_condition(field, lh.LieTaylor(2), m, 3)
    assert late.leading == 2 and late.solvable and "(6.1)" in str(late)
    assert (late.numerical is None) == (kind == "exact")


@pytest.mark.parametrize("kind", [float, "exact"])
def test_equilibria(kind: Any) -> None:
    field = lh.GeneratorField(spin(), ["m0", "m1", "m2"])
    m = exact(["3/5", "0", "4/5"]) if kind == "exact" else np.array([0.6, 0.0, 0.8])
    condition = order_condition(field, lh.Euler(), m, 2)
    assert condition.solvable and condition.leading == 0 and not condition.range_holds
    assert str(condition) == "order 2 at m: an equilibrium of the flow, and so is it of the step"

    class Pushed(lh.steps.OneExponential):
        order = 1

        def generator(self, action: Any, psi: Any, m: Any, t: Any, h: Any) -> Any:
            return h * (psi(m, t) + (m[..., ::-1]) * h)

    assert str(order_condition(field, Pushed(), m, 2)).endswith("but the step moves it")


def test_a_corrected_step_is_judged_by_its_clock() -> None:
    field, m = quadratic(spin(), 1), unit(2, 3)
    step = lh.Corrected(lh.Euler(), 3)
    assert np.abs(chi(field, step, m, 3)).max() < 1e-10
    condition = order_condition(field, step, m, 4)
    four = lh.steps.correction(field, lh.Euler(), m, 4)
    assert np.allclose(condition.zeta, four.zeta[3], rtol=1e-9, atol=1e-10)
    assert np.isclose(condition.c, four.clock[4], rtol=1e-9)


def test_with_the_cayley_transform() -> None:
    rho, psi, point, _ = SPACES["S^3"]
    condition = order_condition(lh.GeneratorField(rho, psi), lh.Heun(), exact(point), 3, exponential="cayley")
    assert is_exact(condition) and condition.solvable
    plain = order_condition(lh.GeneratorField(rho, psi), lh.Heun(), exact(point), 3)
    assert any(a != b for a, b in zip(condition.chi, plain.chi, strict=True))


def test_chi_on_an_ensemble() -> None:
    field, m = quadratic(spin(), 1), unit(2, 2, 5, 3)
    result = chi(field, lh.Euler(), m, 2, 0.3 * m[None])
    assert result.shape == m.shape
    for index in np.ndindex(2, 5):
        assert np.allclose(result[index], chi(field, lh.Euler(), m[index], 2, 0.3 * m[index][None]), atol=1e-13)


def test_refusals() -> None:
    field, m = quadratic(spin(), 1), unit(2, 3)
    with pytest.raises(InputError, match="agrees with the flow at m to order 1 only"):
        order_condition(field, lh.Euler(), m, 3)
    with pytest.raises(InputError, match="agrees with the flow at m to order 1 only"):
        rho, psi, point, _ = SPACES["S^3"]
        order_condition(lh.GeneratorField(rho, psi), lh.Euler(), exact(point), 3)
    with pytest.raises(ShapeError, match="one point"):
        order_condition(field, lh.Euler(), unit(2, 2, 3), 2)
    with pytest.raises(ShapeError, match="zeta has shape"):
        chi(field, lh.Euler(), m, 2, m)
    with pytest.raises(InputError, match=r"zeta_2 = .* is not in the isotropy subalgebra"):
        chi(field, lh.Euler(), m, 2, np.array([m, m[::-1]]))
    with pytest.raises(InputError, match="integer at least 1"):
        chi(field, lh.Euler(), m, 0)
    with pytest.raises(ShapeError, match="3 coordinates"):
        order_condition(field, lh.Euler(), exact([1, 2]), 2)
    with pytest.raises(InputError, match="fixed"):
        order_condition(field, lh.Euler(), exact([0, 0, 0]), 2)
