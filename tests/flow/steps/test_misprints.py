"""Sections 5 and 6 of the paper as printed: the forms that fail, beside those that hold; exact, over QQ."""

import random
from math import factorial
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.steps.expansion import Clock, flow_series, step_series
from liehom.flow.steps.order_conditions import chi
from liehom.flow.steps.step import LocalStep

QQ = lh.QQ
ACTION = lh.Action(lh.defining(lh.so(4)))
FIELD = lh.GeneratorField(ACTION.representation, ["m0*m1", "1", "m2 - m3/2", "m3**2", "1/3 + m0", "m1*m2"])
POINT = np.array([QQ.convert(x) for x in ("1/2", "1/3", "-1/5", "2/3")])


def isotropy(rng: random.Random) -> Any:
    """A random element of g_m."""
    rows = ACTION.representation.isotropy(POINT.tolist()).rows()
    return sum(QQ.convert(rng.randint(-3, 3) or 1) * np.array(row) for row in rows)


def order_two(bracket_sign: int, rng: random.Random) -> tuple[Any, Any, Any, Any]:
    """w_2 and z_2 of xi_1 = w + sigma_1, xi_2 = w' +- [w, sigma_1] + sigma_2; sigma_1 and xi_2."""
    flow = flow_series(FIELD, POINT, 2)
    first, second = isotropy(rng), isotropy(rng)
    x2 = flow.psi(1) + bracket_sign * ACTION.bracket(flow.psi(0), first) + second
    local = LocalStep(ACTION, POINT, lambda h: (h * (flow.psi(0) + first) + h * h * x2 / 2,))
    return flow.point(2), step_series(ACTION, local, POINT, 2).coefficient(2), first, x2


@pytest.mark.parametrize("seed", range(3))
def test_sign_of_the_bracket_in_the_condition_of_order_2(seed: int) -> None:
    """xi_2 = omega' + [omega, sigma_1] + sigma_2; with [sigma_1, omega], as printed, order 2 fails."""
    wanted, values, _, _ = order_two(1, random.Random(seed))
    assert (values == wanted).all()
    wanted, values, _, _ = order_two(-1, random.Random(seed))
    assert (values != wanted).any()


@pytest.mark.parametrize("seed", range(3))
def test_local_error_of_a_method_of_order_1(seed: int) -> None:
    """(t/2)(sigma_1 omega + xi_2 - omega') m, not (t/2)(xi_1 omega + xi_2 - omega') m."""
    flow = flow_series(FIELD, POINT, 2)
    wanted, values, first, x2 = order_two(-1, random.Random(seed))
    act = ACTION.infinitesimal
    velocity = act(flow.psi(0), POINT)
    rest = act(x2, POINT) - act(flow.psi(1), POINT)
    assert (values - wanted == (act(first, velocity) + rest) / 2).all()
    assert (values - wanted != (act(flow.psi(0) + first, velocity) + rest) / 2).any()  # as printed


@pytest.mark.parametrize("n", [2, 3])
def test_chi_has_the_factor_one_half(n: int) -> None:
    """chi(zeta) = n! (rho(zeta) w_1 / 2 + z_n - w_n); the printed chi has no 1/2."""
    step, rng = lh.LieTaylor(n - 1), random.Random(n)
    zeta = isotropy(rng)
    result = np.asarray(chi(FIELD, step, POINT, n, ([np.array([QQ.zero] * 6)] * (n - 2) + [zeta])))
    base = np.asarray(chi(FIELD, step, POINT, n))
    moved = ACTION.infinitesimal(zeta, flow_series(FIELD, POINT, 1).point(1))
    assert (result - base == factorial(n) * moved / 2).all()
    assert (result - base != factorial(n) * moved).any()  # as printed


@pytest.mark.parametrize("l", [1, 2, 3])
def test_the_clock_has_the_factor_l(l: int) -> None:
    """tau = t + c t^(n-l+1) changes [t^n] F_tau by l c w_l; c w_l, as in the printed proof, is right for l = 1."""
    field = lh.GeneratorField(ACTION.representation, [f"t**{l - 1}*(1 + m{k % 4})" for k in range(6)])
    n, c = l + 2, QQ.convert("2/7")
    flow = flow_series(field, POINT, n, QQ.convert(0))
    assert all((flow.point(k) == 0).all() for k in range(1, l)) and (flow.point(l) != 0).any()
    plain, turned = Clock(flow, n, ()), Clock(flow, n, ())
    turned.set(n - l + 1, np.array(c, dtype=object))
    change = turned.point(n) - plain.point(n)
    assert (change == l * c * flow.point(l)).all()
    assert (change == c * flow.point(l)).all() == (l == 1)  # as printed


def test_the_sphere_in_r_k_has_dimension_k_minus_1() -> None:
    """The example of section 6 has M = S^(k-1) in R^k, not S^k."""
    for k in (3, 4, 5):
        assert lh.defining(lh.so(k)).orbit_dimension([1] + [0] * (k - 1)) == k - 1
