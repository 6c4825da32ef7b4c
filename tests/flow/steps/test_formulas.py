"""The order conditions of sections 3, 5 and 6 of the paper, as corrected, against the expansions: exactly over QQ."""

from math import factorial
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.action.maps import action_map, bracket_map
from liehom.flow.series.jet import Jet
from liehom.flow.series.lie_series import bch
from liehom.flow.steps.expansion import flow_series
from liehom.flow.steps.order_conditions import chi
from liehom.flow.steps.step import OneExponential, Step, step_variable
from tests.flow.steps.support import spin, unit

QQ = lh.QQ
SPHERE = lh.defining(lh.so(4))
QUADRATIC = ["m0*m1 + 1/2", "m2**2 - m3", "2*m0 - m1*m3", "1 + m3*m2/3", "m1**2 - m0/5", "m2 + m0*m3"]
POINT = ["1/2", "1/2", "-1/2", "1/2"]


def exact(values: Any) -> Any:
    out = np.empty(len(values), dtype=object)
    for i, x in enumerate(values):
        out[i] = QQ.convert(x)
    return out


def in_isotropy(rho: lh.Representation, m: Any, seed: int) -> Any:
    rng = np.random.default_rng(seed)
    rows = rho.isotropy(m).rows()
    return sum(exact(row) * QQ.convert(f"{rng.integers(-5, 6)}/{rng.integers(1, 4)}") for row in rows)


def polynomial(derivatives: list[Any]) -> Jet:
    """sum xi_j t^j / j!, j >= 1."""
    known = [x / factorial(j + 1) for j, x in enumerate(derivatives)]
    return Jet([0 * known[0], *known])


def updates(rho: lh.Representation, w: list[Any], s: list[Any]) -> list[Any]:
    """xi_1, ..., xi_4 for exp, with w^(j) = w[j] and sigma_j = s[j]."""
    b = bracket_map(rho)
    s1, s2, s3, s4 = s
    w0, w1, w2, w3 = w
    two = (b(w1, w0) + b(s1, b(s1, w0)) + b(w0, b(w0, s1)) + 3 * b(w0, s2) + 3 * b(w1, s1)) / 2
    last = w3 + b(w2, w0) + 2 * b(w0, s3) + 3 * b(w1, s2) + 2 * b(w2 + b(w1, w0) / 2, s1)
    last = last + b(w0, b(w0, s2)) + b(w0, b(w1, s1)) + b(w1, b(w0, s1))
    last = last + b(s1, b(s1, w1)) + b(s1, b(s2, w0)) + b(s2, b(s1, w0)) - b(s1, b(w0, b(w0, s1))) + s4
    return [w0 + s1, w1 + b(w0, s1) + s2, w2 + two + s3, last]


def cayley_updates(rho: lh.Representation, xi: list[Any]) -> list[Any]:
    """The same for cay: xi - xi^3/12 in matrices."""
    matrices = [np.array(a.to_rows(), dtype=object) for a in rho.matrices]
    x1, x2 = (sum(c * a for c, a in zip(x, matrices, strict=True)) for x in xi[:2])

    def coefficients(matrix: Any) -> Any:  # tr(a_i^T a_j) = 2 delta_ij
        return exact([sum((a * matrix).flat) / QQ.convert(2) for a in matrices])

    cubes = x1 @ x1 @ x2 + x1 @ x2 @ x1 + x2 @ x1 @ x1
    return [xi[0], xi[1], xi[2] - coefficients(x1 @ x1 @ x1) / 2, xi[3] - coefficients(cubes)]


def setting(seed: int) -> tuple[Any, Any, list[Any], list[Any]]:
    m = exact(POINT)
    flow = flow_series(lh.GeneratorField(SPHERE, QUADRATIC), m, 5)
    w = [flow.psi(k) * factorial(k) for k in range(4)]
    return m, flow, w, [in_isotropy(SPHERE, m, 10 * seed + j) for j in range(4)]


@pytest.mark.parametrize("exponential", ["exp", "cayley"])
@pytest.mark.parametrize("seed", range(3))
def test_generic_order_conditions_hold_exactly(exponential: str, seed: int) -> None:
    m, flow, w, s = setting(seed)
    xi = updates(SPHERE, w, s)
    if exponential == "cayley":
        xi = cayley_updates(SPHERE, xi)
    z = lh.Action(SPHERE, exponential).act(polynomial(xi), m)
    for k in range(5):
        assert (z.coefficient(k) == flow.point(k)).all(), k
    wrong = [*xi[:3], xi[3] + exact([1, 0, 0, 0, 0, 0])]  # a control: e_1 does not fix m
    z = lh.Action(SPHERE, exponential).act(polynomial(wrong), m)
    assert (z.coefficient(3) == flow.point(3)).all()
    assert (z.coefficient(4) != flow.point(4)).any()


def test_generic_order_conditions_are_the_series_of_baker_campbell_hausdorff() -> None:
    _, _, w, s = setting(7)
    result = bch(bracket_map(SPHERE), polynomial(updates(SPHERE, w, [0 * x for x in s])), polynomial(s))
    for j, x in enumerate(updates(SPHERE, w, s), start=1):
        assert (result.coefficient(j) * factorial(j) == x).all(), j


def test_taylor_steps_are_the_updates_without_isotropy() -> None:
    m, _, w, s = setting(1)
    xi = updates(SPHERE, w, [0 * x for x in s])
    field = lh.GeneratorField(SPHERE, QUADRATIC)
    local = lh.LieTaylor(4).at(lh.Action(SPHERE), lh.steps.Generator(field, 3), m, np.zeros(1))
    factors = local.factors(step_variable(4, m))[0]
    for j, x in enumerate(xi, start=1):
        assert (factors.coefficient(j) * factorial(j) == x).all(), j


# -- the sphere, section 3 -------------------------------------------------------------------------------
class Given(OneExponential):
    """A step with given derivative coefficients xi_1, xi_2, ..."""

    def __init__(self, order: int, derivatives: list[Any]) -> None:
        self._order, self._coefficients = order, [x / factorial(j + 1) for j, x in enumerate(derivatives)]

    @property
    def order(self) -> int:
        return self._order

    def generator(self, action: Any, psi: Any, m: Any, t: Any, h: Any) -> Any:
        total = self._coefficients[-1] * h
        for x in reversed(self._coefficients[:-1]):
            total = (total + x) * h
        return total


class Sphere:
    """omega and its derivatives along the flow in the frame {m, omega/v, m x omega/v}."""

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        a, c = rng.normal(size=(3, 3)), rng.normal(size=3)
        self.m = unit(seed, 3)

        def psi(m: Any) -> Any:  # orthogonal to m
            raw = np.einsum("ij,...j->...i", a, m) + c * m[..., :1] ** 2
            return raw - np.sum(raw * m, axis=-1, keepdims=True) * m

        self.field = lh.GeneratorField(spin(), psi)
        flow = flow_series(self.field, self.m, 5)
        omega = [flow.psi(k) * factorial(k) for k in range(4)]
        self.v = float(np.linalg.norm(omega[0]))
        self.frame = np.array([self.m, omega[0] / self.v, np.cross(self.m, omega[0]) / self.v])
        (_, self.b, self.c) = (self.frame @ np.array(omega).T).tolist()

    def conditions(self, alpha: list[float], cayley: bool) -> tuple[list[float], list[float]]:
        """beta_1..4 and gamma_1..4 for given alpha_1, alpha_2, alpha_3."""
        v, (_, b1, b2, b3), (_, c1, c2, c3) = self.v, self.b, self.c
        a1, a2, a3 = alpha
        gamma = [0.0, c1 - a1 * v, c2 - 1.5 * (a2 * v + a1 * b1)]
        tail = -a1 * v**3 - 2 * a1 * b2 - 3 * a2 * b1 - 2 * a3 * v
        if cayley:
            beta = [v, b1, b2 + v**3 / 2 + 1.5 * c1 * a1, b3 + 3 * v**2 * b1 + 2 * a1 * c2 + 3 * a2 * c1]
            return beta, [*gamma, c3 + 3 * v**2 * c1 + tail]
        beta = [v, b1, b2 - a1**2 * v / 2 + 1.5 * c1 * a1]
        beta.append(b3 - a1**2 * b1 - 2 * a1 * a2 * v + 2 * a1 * c2 + 3 * a2 * c1)
        return beta, [*gamma, c3 + 2 * v**2 * c1 - a1**2 * c1 + tail]

    def vectors(self, alpha: list[float], beta: list[float], gamma: list[float]) -> list[Any]:
        return [np.array(row) @ self.frame for row in zip(alpha, beta, gamma, strict=True)]


@pytest.mark.parametrize("exponential", ["exp", "cayley"])
@pytest.mark.parametrize("seed", range(4))
def test_order_conditions_on_the_sphere(exponential: str, seed: int) -> None:
    sphere, rng = Sphere(seed), np.random.default_rng(seed)
    alpha = rng.normal(size=4).tolist()
    beta, gamma = sphere.conditions(alpha[:3], exponential == "cayley")
    xi = sphere.vectors(alpha, beta, gamma)
    for n in range(1, 6):
        field = chi(sphere.field, Given(4, xi), sphere.m, n, exponential=exponential)
        assert (np.abs(field).max() < 1e-11) == (n < 5), n


@pytest.mark.parametrize("exponential", ["exp", "cayley"])
@pytest.mark.parametrize("order", [1, 2, 3])
def test_alpha_on_the_sphere_is_the_correction(exponential: str, order: int) -> None:
    """A method of order 1, 2, 3 with any xi_(n+1): the last alpha solves the gamma equation, the clock the other."""
    sphere, rng = Sphere(order), np.random.default_rng(order)
    cayley = exponential == "cayley"
    v, (_, b1, b2, _), (_, c1, c2, c3) = sphere.v, sphere.b, sphere.c
    alpha = [*rng.normal(size=order - 1), *[0.0] * (5 - order)]
    beta, gamma = sphere.conditions(alpha[:3], cayley)
    beta[order:], gamma[order:] = rng.normal(size=4 - order), rng.normal(size=4 - order)
    a1, a2 = alpha[:2]
    if order == 1:
        wanted = (c1 - gamma[1]) / v
    elif order == 2:
        wanted = (2 / 3 * (c2 - gamma[2]) - b1 / v * (c1 - gamma[1])) / v
    else:
        known = (3 if cayley else 2) * v**2 * c1 - (0 if cayley else a1**2 * c1)
        wanted = (c3 - gamma[3] + known - a1 * v**3 - 2 * a1 * b2 - 3 * a2 * b1) / (2 * v)
    step = Given(order, sphere.vectors(alpha, beta, gamma))
    raised = lh.steps.correction(sphere.field, step, sphere.m, order + 1, exponential=exponential)
    assert np.allclose(raised.zeta[order] * factorial(order), wanted * sphere.m, rtol=1e-11, atol=1e-11)
    corrected, _ = sphere.conditions([*alpha[: order - 1], wanted, *[0.0] * (3 - order)], cayley)
    # tau = t + theta t^n / n!: beta_n is short of what it should be by v theta
    assert np.isclose(raised.clock[order + 1] * factorial(order + 1), (beta[order] - corrected[order]) / v)


# -- the factor 1/2, section 6 ---------------------------------------------------------------------------
def cayley_squared(x: Any, m: Any) -> Any:
    """cay(x/2)^2 on the sphere: another map that agrees with exp to order 2."""
    half = x / 2
    for _ in range(2):
        once = np.cross(half, m)
        m = m + (once + np.cross(half, once) / 2) / (1 + np.sum(half * half, axis=-1, keepdims=True) / 4)
    return m


class InTwo(Step):
    """A Taylor step as two exponentials."""

    def __init__(self, order: int) -> None:
        self._order = order

    @property
    def order(self) -> int:
        return self._order

    def factors(self, action: Any, psi: Any, m: Any, t: Any, h: Any) -> tuple[Any, ...]:
        (x,) = lh.LieTaylor(self._order).factors(action, psi, m, t, h)
        return x / 3, 2 * x / 3


def powers_of_time(l: int) -> lh.GeneratorField:
    return lh.GeneratorField(spin(), lambda m, t: (t ** (l - 1))[..., None] * (m * [1.0, 2.0, -1.0] + [0.3, 0, 1]))


@pytest.mark.parametrize("exponential", ["exp", "series", "cayley", cayley_squared])
@pytest.mark.parametrize("l", [1, 2, 3])
def test_the_factor_is_one_half(exponential: Any, l: int) -> None:
    field, m = powers_of_time(l), unit(4, 3)
    w = flow_series(field, m, l, 0.0).point(l)
    for n in range(l + 1, l + 4):
        zeta = np.zeros((n, 3))
        zeta[n - l - 1] = 0.7 * m
        zeta[n - l :] = 0.3 * m  # they do not enter
        one, two = lh.LieTaylor(l), InTwo(l)
        change = chi(field, one, m, n, zeta, exponential=exponential)
        change = change - chi(field, one, m, n, exponential=exponential)
        assert np.allclose(change, factorial(n) * np.cross(0.7 * m, w) / 2, rtol=1e-12, atol=1e-12)
        change = chi(field, two, m, n, zeta, exponential=exponential)
        change = change - chi(field, two, m, n, exponential=exponential)
        assert np.allclose(change, factorial(n) * np.cross(0.7 * m, w), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("exponential", ["exp", "cayley"])
@pytest.mark.parametrize("n", [2, 3, 4])
def test_chi_is_the_formula_exactly(exponential: str, n: int) -> None:
    """n! (rho(zeta_(n-1)) w_1 / 2 + z_n - w_n) on S^3, where g_m is so(3), with isotropy in the step itself."""
    m, flow, w, s = setting(3)
    xi = updates(SPHERE, w, s)
    if exponential == "cayley":
        xi = cayley_updates(SPHERE, xi)
    step = Given(n - 1, [*xi[: n - 1], *[exact([1, 2, 0, -1, 1, 3])] * (5 - n)])
    field = lh.GeneratorField(SPHERE, QUADRATIC)
    z = lh.Action(SPHERE, exponential).act(step.generator(None, None, m, 0, step_variable(n, m)), m)
    zeta = np.array([0 * s[0]] * (n - 2) + [in_isotropy(SPHERE, m, 5), s[1]], dtype=object)
    half = action_map(SPHERE)(zeta[n - 2], flow.point(1)) / 2
    result = chi(field, step, m, n, zeta, exponential=exponential)
    assert (result == factorial(n) * (half + z.coefficient(n) - flow.point(n))).all()
    # affine: the line through two corrections
    other = np.array([0 * s[0]] * (n - 2) + [in_isotropy(SPHERE, m, 6)], dtype=object)
    middle = chi(field, step, m, n, (2 * zeta[: n - 1] + other) / 3, exponential=exponential)
    assert (3 * middle == 2 * result + chi(field, step, m, n, other, exponential=exponential)).all()
