"""Sections 3 and 4 of the paper as printed: the forms that fail, beside those that hold.

(3.1), condition c) and sigma_ib are in test_sphere.py and test_energy.py.
"""

from typing import Any

import numpy as np

import liehom as lh
from liehom.flow.series.jet import Jet
from liehom.flow.steps.expansion import flow_series
from liehom.flow.steps.order_conditions import chi
from liehom.flow.steps.step import Generator, step_variable
from liehom.studies.rigid_body import RigidBody
from liehom.studies.spheres import Sphere, SphereFrame
from tests.studies.support import rational, unit

QQ = lh.QQ
BODY, POINT = RigidBody([1, 2, 3]), ["2/7", "3/7", "6/7"]


class Formula(lh.steps.OneExponential):
    """A step of which the generator is given as a function of (m, h)."""

    order = 1

    def __init__(self, function: Any) -> None:
        self._function = function

    def generator(self, action: Any, psi: Any, m: Any, t: Any, h: Any) -> Any:
        return self._function(m, h)


def dot(x: Any, y: Any) -> Any:
    return np.sum(x * y, axis=-1, keepdims=True)


def derivatives(kind: str, m: Any) -> list[Any]:
    """omega, omega', omega'', omega''' along the flow."""
    flow = flow_series(BODY.field(kind), m, 4)
    return [flow.psi(j) * f for j, f in enumerate((1, 1, 2, 6))]


def energy(function: Any, m: Any, order: int) -> list[Any]:
    """E_1, ..., E_order with Cayley."""
    result = BODY.energy(lh.Action(BODY.representation, "cayley").act(function(m, step_variable(order, m)), m))
    return [result.coefficient(j)[()] for j in range(1, order + 1)]


def numbers(m: Any) -> tuple[Any, ...]:
    """h, sigma_i, v^2, D, chi."""
    once, x = BODY.apply(m), BODY.vector(m)
    h, v2 = dot(m, once), dot(x, x)
    sigma = dot(x, BODY.apply(x)) / v2 - h
    return h[0], sigma[0], v2[0], dot(x, BODY.apply(once))[0], (sigma * v2)[0]


# -- section 3 -------------------------------------------------------------------------------------------
def test_sign_of_the_third_vector_of_the_frame() -> None:
    """gamma_j belongs to m x omega: with omega x m, as printed, order 2 fails."""
    field = Sphere(3).generator(lambda m: np.cross(m * [1.0, 2.0, 4.0] + m[..., :1], m))
    frame = SphereFrame(field, unit(1, 3))
    alpha = [0.7, 0.0, 0.0, 0.0]
    beta, gamma = frame.conditions(alpha)
    for sign, holds in ((1, True), (-1, False)):
        xi = [np.array([alpha[j], beta[j], sign * gamma[j]]) @ frame.vectors for j in range(2)]
        step = Formula(lambda m, h, xi=xi: h * xi[0] + h * h * (xi[1] / 2))
        assert (np.abs(chi(field, step, frame.point, 2)).max() < 1e-12) == holds


def test_third_order_of_cayley() -> None:
    """(3.3), (3.4): - |xi_1|^2 xi_1 for exp, -(3/2) |xi_1|^2 xi_1 for Cayley."""
    m, rng = unit(2, 3), np.random.default_rng(3)
    xi = rng.normal(size=(3, 3))
    curve = Jet(np.array([0 * m, xi[0], xi[1] / 2, xi[2] / 6]))

    def third(factor: float) -> Any:
        x1, x2, x3 = xi
        total = np.cross(x3 - factor * (x1 @ x1) * x1, m)
        return total + 1.5 * (np.cross(x1, np.cross(x2, m)) + np.cross(x2, np.cross(x1, m)))

    for exponential, factor in (("exp", 1.0), ("cayley", 1.5)):
        result = lh.Action(BODY.representation, exponential).act(curve, m).coefficient(3) * 6
        assert np.allclose(result, third(factor), atol=1e-12)
        assert not np.allclose(result, third(2.5 - factor), atol=1e-2)


def test_clock_has_the_power_n() -> None:
    """tau = t + theta t^n/n!, not t^(n-1)/(n-1)!: lower coefficients of the clock vanish."""
    raised = lh.steps.correction(BODY.field("o"), lh.LieTaylor(3), unit(4, 3), 4)
    assert [x is None or abs(float(x)) < 1e-12 for x in raised.clock[2:4]] == [True, True]
    assert abs(raised.clock[4]) > 1e-4


def test_factor_of_heun() -> None:
    """alpha_2 with 1/v^2; with 1/v, as printed, the orbit has order 2."""
    a = np.random.default_rng(5).normal(size=(3, 3))
    field = Sphere(3).generator(lambda m: np.cross(m @ a + m * m, m))
    m = unit(6, 3)
    w0, w1, w2 = (flow_series(field, m, 3).psi(j) * (1, 1, 2)[j] for j in range(3))
    derivative = field.psi(Jet([m, np.cross(w1, m)])).coefficient(1)
    v = np.linalg.norm(w0)
    inner = (derivative - w2 / 3) @ np.cross(m, w0)
    raised = 2 * lh.steps.correction(field, lh.Heun(), m, 3).zeta[2] @ m
    assert np.isclose(raised, inner / v**2)
    assert abs(raised - inner / v) > 1e-2


# -- section 4 -------------------------------------------------------------------------------------------
def test_numerator_of_4_3() -> None:
    """<m', m x m'> is identically 0; sigma_i = <m'', m x m'>/|m'|^2."""
    m = rational(POINT)
    x = BODY.vector(m)
    second = np.cross(x, BODY.apply(m)) + np.cross(m, BODY.apply(x))
    assert dot(x, np.cross(m, x))[0] == 0
    assert (dot(second, np.cross(m, x)) / dot(x, x))[0] == numbers(m)[1] != 0


def test_second_term_of_the_euler_step_and_of_its_energy() -> None:
    """m_2 = (-Om m + (sigma + 2H) m) x X and E_2 = (sigma_i - sigma) v^2/2, X = omega x m."""
    m, sigma = rational(POINT), QQ.convert("3/5")
    h, sigma_i, v2, _, _ = numbers(m)
    x, once = BODY.vector(m), BODY.apply(m)

    def step(m: Any, t: Any) -> Any:
        return t * (BODY.field("o").psi(m) + sigma * m)

    after = lh.Action(BODY.representation).act(step(m, step_variable(2, m)), m).coefficient(2) * 2
    assert (after == np.cross((sigma + h) * m - once, x)).all()
    assert (after != np.cross(once + (sigma - h) * m, x)).any()  # as printed
    value = energy(step, m, 2)[1]
    assert value == (sigma_i - sigma) * v2 / 2
    assert value != (sigma - sigma_i) * v2 / 2
    bracket = dot(x, BODY.apply(x))[0] - (sigma + h) * v2
    assert value == bracket / 2 != (dot(x, BODY.apply(x))[0] + (sigma - h) * v2) / 2


def test_isotropy_of_the_body_generator() -> None:
    """omega_b = omega_o - h m, so sigma_b = -2H, and omega_o = -P Om m."""
    m = rational(POINT)
    h = numbers(m)[0]
    b, o = BODY.field("b").psi(m), BODY.field("o").psi(m)
    assert (b == o - h * m).all()
    assert (np.cross(o, m) == BODY.vector(m)).all()
    assert (np.cross(-o, m) != BODY.vector(m)).any()  # omega = P Om m
    assert (np.cross(-b, m) != BODY.vector(m)).any()  # omega_b = Om m


def test_runge_kutta_2_as_printed() -> None:
    """With a minus, as printed, it is not consistent; (dt/2)(omega(m) + omega(cay(dt omega) m)) has order 2."""
    m, field = unit(7, 3), BODY.field("o")
    action = lh.Action(BODY.representation, "cayley")
    for sign, order in ((-1, 0), (1, 2)):

        def step(m: Any, h: Any, sign: int = sign) -> Any:
            first = h * field.psi(m)
            return (first + sign * h * field.psi(action.act(first, m))) / 2

        results = [float(np.abs(chi(field, Formula(step), m, n, exponential="cayley")).max()) for n in (1, 2, 3)]
        assert [x < 1e-12 for x in results] == [n <= order for n in (1, 2, 3)]


def sum_of_derivatives(w: list[Any], h: Any) -> Any:
    return h * w[0] + h**2 / 2 * w[1] + h**3 / 6 * w[2] + h**4 / 24 * w[3]


def test_sy4_o_as_printed() -> None:
    """<omega', m> = 0 for <omega'', m>: order 3 and E_4 = chi v^2/24, as an axisymmetric column of Figure 5."""
    m = rational(POINT)
    w = derivatives("o", m)
    _, _, v2, D, chi_h = numbers(m)
    assert dot(w[1], m)[0] == 0

    def step(m: Any, h: Any, right: bool) -> Any:
        third = dot(w[0], w[0]) * w[0] + (dot(w[2] if right else w[1], m) * m)
        return sum_of_derivatives(w, h) + h**3 / 12 * third + h**4 / 8 * (dot(w[1], w[0]) * w[0])

    assert energy(lambda m, h: step(m, h, True), m, 5) == [0, 0, 0, 0, -D * chi_h / 16]
    assert energy(lambda m, h: step(m, h, False), m, 4) == [0, 0, 0, chi_h * v2 / 24]
    field = BODY.field("o")
    for right, order in ((True, 4), (False, 3)):
        after = [chi(field, Formula(lambda m, h, r=right: step(m, h, r)), m, n, exponential="cayley") for n in (3, 4)]
        assert [all(x == 0 for x in value) for value in after] == [True, order == 4]


def sy4_b(w: list[Any], h: Any) -> Any:
    square, half = dot(w[0], w[0]), dot(w[1], w[0])
    third = square * w[0] + np.cross(w[1], w[0])
    return (
        sum_of_derivatives(w, h)
        + h**3 / 12 * third
        + h**4 / 24 * (square * w[1] + np.cross(w[2], w[0]) + 2 * half * w[0])
    )


def test_sy4_b_in_the_two_conventions() -> None:
    """With omega_b = -Om m of order 4; with +Om m and m' = m x xi of order 2; with omega_o another step of order 4."""
    m = rational(POINT)
    _, _, _, D, chi_h = numbers(m)
    field = BODY.field("b")
    for sign, order in ((1, 4), (-1, 2)):
        # the other convention: the formula in -w, applied with -xi
        w = [sign * x for x in derivatives("b", m)]
        step = Formula(lambda m, h, w=w, sign=sign: sign * sy4_b(w, h))
        result = [chi(field, step, m, n, exponential="cayley") for n in (2, 3, 4, 5)]
        assert [all(x == 0 for x in value) for value in result] == [n <= order for n in (2, 3, 4, 5)]
    w = derivatives("o", m)
    assert energy(lambda m, h: sy4_b(w, h), m, 5) == [
        0,
        0,
        0,
        0,
        -D * chi_h / 48,
    ]  # so its improvement is -D sigma_i/24
    result = chi(BODY.field("o"), Formula(lambda m, h: sy4_b(w, h)), m, 4, exponential="cayley")
    assert all(x == 0 for x in result)


def test_sign_of_sigma_ib() -> None:
    """-sigma_ib, as printed in the convention X = omega x m, doubles the error of Heun's step instead."""
    m = unit(8, 10, 3)
    update, plain, h = BODY.update("rk2_ib"), BODY.update("rk2_b"), 0.02
    action = lh.Action(BODY.representation, "cayley")
    start = BODY.energy(m)
    wrong = action.act(2 * plain.generator(m, h) - update.generator(m, h), m)
    errors = [np.abs(BODY.energy(x) - start) for x in (update(m, h), plain(m, h), wrong)]
    big = errors[1] > 1e-11
    assert np.median(errors[0][big] / errors[1][big]) < 0.1
    assert np.allclose(errors[2][big] / errors[1][big], 2, atol=0.3)


def test_sigma_ib_as_printed_belongs_to_the_list_of_generators() -> None:
    """With omega_b = Om m and m' = m x xi the energy has E_1 = ... = E_4 = 0; without sigma_ib E_4 is not 0."""
    m, moments = rational(POINT), rational(["1", "2", "3"])
    squares = (np.prod(m) / m) ** 2
    sums, gaps = moments.sum() - moments, np.roll(moments, -1) - np.roll(moments, -2)
    top, bottom = -moments * sums * gaps**2, 4 * np.prod(moments) * moments**2 * gaps**2
    sigma = (top @ squares) / (bottom @ squares)
    action = lh.Action(BODY.representation, "cayley")

    def heun(m: Any, h: Any) -> Any:
        first = BODY.apply(m)
        return h * (first + BODY.apply(action.act(-(h * first), m))) / 2

    for factor, vanishes in ((1, True), (0, False), (-1, False)):
        found = energy(lambda m, h, f=factor: -(heun(m, h) + f * sigma * (h**3 * m)), m, 4)
        assert found[:3] == [0, 0, 0]
        assert (found[3] == 0) == vanishes


def test_dcayley_inverse() -> None:
    """y - u x y/2 + <u, y> u/4, which Runge-Kutta steps with Cayley use."""
    u, y = unit(9, 2, 3)
    result = lh.Action(BODY.representation, "cayley").exponential.differential_inverse(u, y, 1)
    assert np.allclose(result, y - np.cross(u, y) / 2 + (u @ y) * u / 4, atol=1e-15)
    assert Generator(BODY.field("b"), 2)(u, np.zeros(1)).shape == (3,)
