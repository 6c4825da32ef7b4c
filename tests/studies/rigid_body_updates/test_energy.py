"""Section 4 of the paper: energy errors of the updates as exact identities, their orders in steps and runs."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.series.jet import Jet
from liehom.flow.steps.step import Generator, step_variable
from liehom.studies.rigid_body import RigidBody
from liehom.studies.rigid_body_updates import ORDERS, scheme, update_names
from liehom.studies.spheres import Sphere
from tests.studies.support import rational, slopes, unit

QQ = lh.QQ
UNIMPROVED = [name for name in update_names() if "_i" not in name]
EXPONENTIALS = ("cayley", "exp")
LONG = np.finfo(np.longdouble).eps < 1e-18

# three bodies with points of the unit sphere, all rational
EXACT = [
    ([1, 2, 3], ["2/7", "3/7", "6/7"]),
    (["1/2", "5/3", "2/5"], ["2/3", "-1/3", "2/3"]),
    ([[2, "1/3", 0], ["1/3", 1, "-1/4"], [0, "-1/4", "3/2"]], ["-4/9", "7/9", "4/9"]),
]


def energy_series(body: RigidBody, step: Any, kind: str, m: Any, order: int, exponential: str) -> Jet:
    """H(step of size t) as a series; exact at exact points."""
    action = lh.Action(body.representation, exponential)
    (xi,) = step.at(action, Generator(body.field(kind), 2), m, 0 * m[..., :1]).factors(step_variable(order, m))
    return body.energy(action.act(xi, m))  # type: ignore[no-any-return]


class Exactly:
    """h, k, v^2, ... at an exact point of the unit sphere."""

    def __init__(self, body: RigidBody, m: Any) -> None:
        self.m = m
        once = body.apply(m)
        twice, x = body.apply(once), body.vector(m)
        self.h, self.k = sum(m * once), sum(m * twice)
        self.v2, self.D = sum(x * x), sum(x * twice)
        self.R = sum(x * body.apply(x)) / self.v2
        om = body._inverse
        self.e1, self.e3 = om.trace(), om.determinant()
        self.e2 = (om.trace() ** 2 - (om @ om).trace()) / 2
        self.chi = self.h**3 - self.e1 * self.h**2 + self.e2 * self.h - self.e3
        self.slope = 3 * self.h**2 - 2 * self.e1 * self.h + self.e2


def expected(name: str, exponential: str, at: Exactly) -> tuple[int, Any]:
    """(n, E_n): the first coefficient of the energy that need not vanish."""
    h, k, v2, D, e1, e2, e3, chi = at.h, at.k, at.v2, at.D, at.e1, at.e2, at.e3, at.chi
    exp = exponential == "exp"
    results: dict[str, tuple[int, Any]] = {
        "eul_b": (2, (at.R - h + h) * v2 / 2),
        "eul_o": (2, (at.R - h) * v2 / 2),
        "rk2_b": (4, (e2 * chi + (e2 * h - e3) * v2) / 8),
        "rk2_o": (4, (3 * v2 + at.slope) * chi / 8),
        "sy4_b": (5, D * (3 * e1 * h**2 - 2 * e2 * h + e3 - 3 * h * k) / 48),
        "sy4_o": (5, -D * chi / 16),
        "rk4_b": (5, -D * (4 * e1 * h**2 - 3 * e2 * h + e3 - 5 * h * k) / 96),
        "rk4_o": (5, -D * chi / 32),
    }
    if exp and name == "sy4_b":
        return 5, D * (5 * e1 * h**2 - 4 * e2 * h + 3 * e3 - 6 * h * k) / 48
    if exp and name == "rk4_b":
        return 5, D * (55 * h * k - 48 * e1 * h**2 + 36 * e2 * h - 12 * e3) / 1152
    return results[name]


@pytest.mark.parametrize("exponential", EXPONENTIALS)
@pytest.mark.parametrize("name", [name for name in UNIMPROVED if name != "sy4_o"])
def test_energy_of_unimproved_updates(name: str, exponential: str) -> None:
    """E_2, ..., E_(n-1) = 0 and E_n as it is, exactly."""
    kind, step = scheme(name, cayley=exponential == "cayley")
    for inertia, point in EXACT:
        body, m = RigidBody(inertia), rational(point)
        n, value = expected(name, exponential, Exactly(body, m))
        energy = energy_series(body, step, kind, m, n, exponential)
        assert [energy.coefficient(j)[()] for j in range(1, n)] == [0] * (n - 1)
        assert energy.coefficient(n)[()] == value != 0


@pytest.mark.parametrize("exponential", EXPONENTIALS)
def test_energy_of_sy4_o(exponential: str) -> None:
    """As the test above, in floats: the generic step with Cayley solves a linear system."""
    kind, step = scheme("sy4_o", cayley=exponential == "cayley")
    for inertia, point in EXACT:
        body, exact = RigidBody(inertia), rational(point)
        energy = energy_series(body, step, kind, np.array([float(Fraction(x)) for x in point]), 5, exponential)
        n, value = expected("sy4_o", exponential, Exactly(body, exact))
        assert np.allclose([energy.coefficient(j) for j in range(1, n)], 0, atol=1e-13)
        assert np.isclose(energy.coefficient(n), float(Fraction(int(value.p), int(value.q))), rtol=0, atol=1e-13)


class Isotropic(lh.steps.OneExponential):
    """A step with sigma m t^p added to its generator."""

    def __init__(self, step: Any, power: int, sigma: Any) -> None:
        self._step, self._power, self._sigma = step, power, sigma

    @property
    def order(self) -> int:
        return int(self._step.order)

    def generator(self, action: Any, psi: Any, m: Any, t: Any, h: Any) -> Any:
        (xi,) = self._step.factors(action, psi, m, t, h)
        power = h
        for _ in range(self._power - 1):
            power = power * h
        return xi + power * (self._sigma * m)


@pytest.mark.parametrize("exponential", EXPONENTIALS)
@pytest.mark.parametrize("name", [name for name in UNIMPROVED if name != "sy4_o"])
def test_isotropy_in_the_energy(name: str, exponential: str) -> None:
    """t^(n-1) sigma m changes E_n by -sigma v^2/2, exactly, so that sigma = 2 E_n/v^2 improves by one order."""
    kind, step = scheme(name, cayley=exponential == "cayley")
    for inertia, point in EXACT:
        body, m = RigidBody(inertia), rational(point)
        at = Exactly(body, m)
        n, value = expected(name, exponential, at)
        for sigma, left in ((QQ.convert("3/7"), value - QQ.convert("3/14") * at.v2), (2 * value / at.v2, 0)):
            energy = energy_series(body, Isotropic(step, n - 1, sigma), kind, m, n, exponential)
            assert [energy.coefficient(j)[()] for j in range(1, n)] == [0] * (n - 1)
            assert energy.coefficient(n)[()] == left


def test_formula_of_sigma_ib_in_the_coordinates() -> None:
    """sum J^n_j u_j / (4 sum J^d_j u_j) with J^n_j = + I_j (I_k + I_l)(I_k - I_l)^2: (e_2 R - e_3)/4; - is printed."""
    moments = [Fraction(x) for x in ("1/2", "5/3", "2/5")]
    body, m = RigidBody(moments), rational(["2/3", "-1/3", "2/3"])
    at = Exactly(body, m)
    top, bottom = QQ.convert(0), QQ.convert(0)
    for j in range(3):
        ij, ik, il = (QQ.convert(moments[(j + s) % 3]) for s in range(3))
        u = (m[(j + 1) % 3] * m[(j + 2) % 3]) ** 2
        top += ij * (ik + il) * (ik - il) ** 2 * u
        bottom += ij**2 * (ik - il) ** 2 * u
    assert top / (4 * QQ.convert(moments[0] * moments[1] * moments[2]) * bottom) == (at.e2 * at.R - at.e3) / 4 != 0


def test_heun_with_any_invariant_isotropy() -> None:
    """Heun's step for omega + f m with X.grad f = 0 has a one-step energy error O(dt^4); for other f O(dt^3)."""
    for inertia, point in EXACT:
        body, m = RigidBody(inertia), rational(point)
        for exponential in EXPONENTIALS:
            for invariant in (True, False):

                def psi(m: Any, body: RigidBody = body, invariant: bool = invariant) -> Any:
                    h, r = np.sum(m * body.apply(m), -1, keepdims=True), np.sum(m * m, -1, keepdims=True)
                    return (2 * h * h - 3 * h * r if invariant else m[..., :1]) * m - body.apply(m)

                field = lh.GeneratorField(body.representation, psi)
                action = lh.Action(body.representation, exponential)
                local = lh.Heun().at(action, Generator(field, 2), m, 0 * m[:1])
                energy = body.energy(action.act(local.factors(step_variable(4, m))[0], m))
                assert energy.coefficient(1)[()] == energy.coefficient(2)[()] == 0
                assert (energy.coefficient(3)[()] == 0) == invariant
                assert energy.coefficient(4)[()] != 0


@pytest.mark.parametrize("exponential", EXPONENTIALS)
@pytest.mark.parametrize("name", [name for name in update_names() if "_i" in name])
def test_energy_of_improved_updates(name: str, exponential: str) -> None:
    """All coefficients up to the order vanish, the next one does not: sharp."""
    body, m = RigidBody([1.0, 0.55, 0.3]), unit(3, 10, 3)
    kind, step = scheme(name, cayley=exponential == "cayley")
    p = ORDERS[name].energy
    energy = energy_series(body, step, kind, m, p + 1, exponential)
    for j in range(1, p + 1):
        assert np.abs(energy.coefficient(j)).max() < 1e-10, j
    assert np.abs(energy.coefficient(p + 1)).max() > 1e-3


@pytest.mark.parametrize("exponential", EXPONENTIALS)
@pytest.mark.parametrize("name", update_names())
def test_energy_of_axisymmetric_bodies(name: str, exponential: str) -> None:
    """Coefficients of odd order vanish by symmetry: RK2_i, sy4 and RK4 have one-step errors O(dt^6), Eul_i has none."""
    body, m = RigidBody([1.0, 1.0, 0.4]), unit(4, 10, 3)
    kind, step = scheme(name, cayley=exponential == "cayley")
    energy = energy_series(body, step, kind, m, 6, exponential)
    sizes = [float(np.abs(energy.coefficient(j)).max()) for j in range(7)]
    first = {"eul_b": 2, "eul_o": 2, "eul_i": 7, "rk2_b": 4, "rk2_o": 4}.get(name, 6)
    assert max(sizes[1:first]) < 1e-11
    assert first == 7 or sizes[first] > 1e-4


# -- global orders ---------------------------------------------------------------------------------------
def measured(body: RigidBody, update: Any) -> tuple[float, float]:
    """The orders of energy and solution over T = 6, between steps 1/32 and 1/64."""
    start = unit(5, 4, 3).astype(np.longdouble)
    sizes, energies, solutions = [1 / 32, 1 / 64], [], []
    for dt in sizes:
        m, worst = start, np.zeros(4, dtype=np.longdouble)
        for _ in range(round(6 / dt)):
            m = update(m, dt)
            worst = np.maximum(worst, np.abs(body.energy(m) - body.energy(start)))
        energies.append(float(np.sqrt(np.mean(worst**2))))
        solutions.append(float(np.linalg.norm(m - body.exact(start, 6.0))))
    return float(slopes(sizes, energies)[0]), float(slopes(sizes, solutions)[0])


@pytest.mark.skipif(not LONG, reason="this machine has no floats longer than double precision")
@pytest.mark.parametrize("name", update_names())
def test_global_orders(name: str) -> None:
    """Figure 6, columns 1 and 2: a triaxial body. In closed form, which is the update (next test)."""
    body = RigidBody([1.0, 1.25, 2.0])
    energy, solution = measured(body, body.closed_form(name))
    assert abs(energy - ORDERS[name].energy) < 0.15, (energy, solution)
    assert abs(solution - ORDERS[name].solution) < 0.15, (energy, solution)


@pytest.mark.slow
@pytest.mark.skipif(not LONG, reason="this machine has no floats longer than double precision")
@pytest.mark.parametrize("name", update_names())
def test_global_orders_of_the_generic_updates(name: str) -> None:
    body = RigidBody([1.0, 1.25, 2.0])
    energy, solution = measured(body, body.update(name))
    assert abs(energy - ORDERS[name].energy) < 0.15, (energy, solution)
    assert abs(solution - ORDERS[name].solution) < 0.15, (energy, solution)


@pytest.mark.skipif(not LONG, reason="this machine has no floats longer than double precision")
@pytest.mark.parametrize("name", update_names())
def test_update_and_closed_form_agree_in_extended_precision(name: str) -> None:
    body, m = RigidBody([1, "5/4", 2]), unit(5, 4, 3).astype(np.longdouble)
    for exponential in EXPONENTIALS:
        gap = body.update(name, exponential)(m, 0.3) - body.closed_form(name, exponential)(m, 0.3)
        assert gap.dtype == np.longdouble
        assert np.abs(gap).max() < 2e-18


def test_zeros_of_figures_2_and_3() -> None:
    """An axisymmetric body over many steps: the energy of Eul_i stays to round-off, with Cayley and exp."""
    body, start = RigidBody([2.0, 2.0, 1.0]), unit(6, 20, 3)
    for exponential in EXPONENTIALS:
        update, m = body.update("eul_i", exponential), start
        for _ in range(100):
            m = update(m, 1.0)
        assert np.abs(body.energy(m) - body.energy(start)).max() < 2e-15


def test_energy_is_the_curvature_defect_of_euler() -> None:
    """E_2 = (sigma_i - sigma) v^2/2 for any sigma, exactly."""
    for inertia, point in EXACT:
        body, m = RigidBody(inertia), rational(point)
        at = Exactly(body, m)
        for sigma in ("1/3", "-2"):
            for exponential in EXPONENTIALS:
                energy = energy_series(body, Isotropic(lh.Euler(), 1, QQ.convert(sigma)), "o", m, 2, exponential)
                assert energy.coefficient(2)[()] == (at.chi / at.v2 - QQ.convert(sigma)) * at.v2 / 2
        assert at.chi / at.v2 == at.R - at.h
    assert Sphere(3).isotropy_dimension == 1
