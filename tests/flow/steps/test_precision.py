"""Extended floats: corrections beyond double precision, and order 6 below it."""

from typing import Any

import flint
import numpy as np
import pytest

import liehom as lh
from liehom.flow.steps.order_conditions import order_condition
from tests.flow.steps.support import exact_flow, one_step, run, slopes

pytestmark = pytest.mark.skipif(
    np.finfo(np.longdouble).eps > 1e-18, reason="this machine has no floats longer than double precision"
)
QQ = lh.QQ
CASES = {
    "S^2": (lh.defining(lh.so(3)), ["m0*m1 + 1", "m2**2 - m0", "m1 + 1/2"], ["3/7", "2/7", "6/7"]),
    "S^3": (lh.defining(lh.so(4)), ["m0*m1", "m2", "2 - m3", "m0", "m3*m3", "1"], ["1/2", "1/10", "-7/10", "1/2"]),
    "SL(3) on R^3": (lh.defining(lh.sl(3)), ["m0", "m1", "1", "m2*m0", "2", "m1", "0", "1/3"], ["1/3", "2/7", "1"]),
    "the cone of so(3,1)": (
        lh.defining(lh.so(3, 1)),
        ["m0", "m1*m0", "1", "m3", "m2 - m0", "2"],
        ["1/3", "2/3", "2/3", "1"],
    ),
}


def long(x: Any) -> Any:
    """A rational number as an extended float."""
    return np.longdouble(int(x.p)) / np.longdouble(int(x.q))


@pytest.mark.parametrize("base", [lh.Euler(), lh.Heun(), lh.LieTaylor(3)], ids=str)
@pytest.mark.parametrize("name", list(CASES))
def test_corrections_against_exact_ones(name: str, base: Any) -> None:
    rho, psi, point = CASES[name]
    field, n = lh.GeneratorField(rho, psi), base.order + 1
    m = np.empty(len(point), dtype=object)
    m[:] = [flint.fmpq(*map(int, x.split("/"))) if "/" in x else flint.fmpq(int(x)) for x in point]
    wanted = order_condition(field, base, m, n)
    raised = lh.steps.correction(field, base, np.array([long(x) for x in m]), n)
    zeta = np.array([long(QQ.convert(x)) for x in wanted.zeta])
    assert raised.zeta[n - 1].dtype == np.longdouble
    assert np.abs(raised.zeta[n - 1] - zeta).max() < 2e-17 * max(np.abs(zeta).max(), 1)
    assert abs(raised.clock[n] - long(QQ.convert(wanted.c))) < 2e-17 * max(abs(raised.clock[n]), 1)
    double = lh.steps.correction(field, base, np.array([float(long(x)) for x in m]), n)
    assert np.abs(double.zeta[n - 1] - zeta).max() < 1e-13


@pytest.mark.parametrize("name", ["S^2", "S^3"])
def test_order_6_below_double_precision(name: str) -> None:
    rho, psi, point = CASES[name]
    field = lh.GeneratorField(rho, psi)
    m = np.array([long(flint.fmpq(*map(int, x.split("/")))) for x in point])
    m = m / np.sqrt(np.sum(m * m))
    errors = []
    for count in (64, 96):
        z, t = run(field, lh.Corrected(lh.Euler(), 6), m, np.longdouble(0.25) / count, count)
        assert z.dtype == t.dtype == np.longdouble
        errors.append(np.linalg.norm((z - exact_flow(field, m, t, steps=12)).astype(float)))
        assert abs(np.sum(z * z) - 1) < 1e-18 * 50
    assert errors[0] < 1e-13
    assert abs(slopes([3, 2], errors)[0] - 6) < 0.3, errors


def test_terms_of_the_flow_in_extended_floats() -> None:
    """Next to a zero in time, order 4 by the flow's own terms."""
    field = lh.GeneratorField(CASES["S^2"][0], ["t*m0", "t*(1 + m1)", "t**2*m2 + t"])
    m = np.array([np.longdouble(3) / 5, np.longdouble(0), np.longdouble(4) / 5])
    errors = []
    for h in (0.002, 0.001):
        z, tau = one_step(field, lh.Corrected(lh.Euler(), 4), m, np.longdouble(h), np.longdouble(0.001))
        errors.append(np.linalg.norm((z - exact_flow(field, m, tau, np.longdouble(0.001), steps=2)).astype(float)))
    assert errors[1] < 1e-15 and slopes([2, 1], errors)[0] > 4.7, errors


@pytest.mark.parametrize("kind", [np.float64, np.longdouble])
def test_a_free_action_is_corrected_by_the_clock_alone(kind: Any) -> None:
    """On the circle there is no isotropy, and none is needed."""
    field = lh.GeneratorField(lh.defining(lh.so(2)), ["1 + m0/3"])
    m = np.array([3, 4], dtype=kind) / 5
    raised = lh.steps.correction(field, lh.Euler(), m, 4)
    assert int(raised.reached) == 4 and int(raised.rank) == 1
    assert all(x is None or np.all(x == 0) for x in raised.zeta)
    errors = []
    for h in (0.1, 0.05):
        z, tau = one_step(field, lh.Corrected(lh.Euler(), 4), m, kind(h))
        errors.append(np.linalg.norm((z - exact_flow(field, m, tau, steps=4)).astype(float)))
    assert slopes([2, 1], errors)[0] > 4.6, errors
