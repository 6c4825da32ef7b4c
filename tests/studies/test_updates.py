"""The updates of Figure 6: built from base and corrector, in closed form, and the step on the orbit itself."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.convergence.reference import Reference
from liehom.studies.rigid_body import RigidBody
from liehom.studies.rigid_body_updates import Ingredients, OrbitStep, improvement, scheme, update_names
from tests.studies.support import BODIES, slopes, unit

IMPROVED = [name for name in update_names() if "_i" in name]
EXPONENTIALS = ("cayley", "exp")


def orbit_step(body: RigidBody, m: Any) -> OrbitStep:
    return OrbitStep(body, lh.Action(body.representation, "cayley"), m)


def points(body: RigidBody) -> Any:
    """Points of every length, some of them next to equilibria."""
    m = unit(11, 20, 3) * np.random.default_rng(12).uniform(0.2, 2.5, size=(20, 1))
    near = np.concatenate([body.equilibria() + d * unit(13, 6, 3) for d in (1e-3, 1e-7, 1e-12)])
    return np.concatenate([m, near, body.equilibria()])


@pytest.mark.parametrize("exponential", EXPONENTIALS)
@pytest.mark.parametrize("name", update_names())
def test_update_and_closed_form_agree(name: str, exponential: str) -> None:
    for key, body in BODIES.items():
        update, closed, m = body.update(name, exponential), body.closed_form(name, exponential), points(body)
        for dt in (1e-3, 0.05, 0.5):
            assert (np.abs(update(m, dt) - closed(m, dt)) < 4e-15 * np.linalg.norm(m, axis=-1, keepdims=True)).all()
        if key not in ("sphere", "nearly a disc"):  # where nothing moves sigma is arbitrary
            assert np.abs(update.generator(m[:20], 0.3) - closed.generator(m[:20], 0.3)).max() < 2e-14


@pytest.mark.parametrize("exponential", EXPONENTIALS)
@pytest.mark.parametrize("name", IMPROVED)
def test_improvements_are_what_the_corrector_finds(name: str, exponential: str) -> None:
    """The coefficient zeta_p itself, in the order of n = p + 1; lower ones vanish."""
    for body in (BODIES["triaxial"], BODIES["disc"], BODIES["tilted"]):
        m = unit(14, 30, 3)
        power, sigma = improvement(name, exponential, Ingredients(body, m))
        kind, step = scheme(name, cayley=exponential == "cayley")
        assert isinstance(step, lh.Corrected)
        raised = lh.steps.correction(body.field(kind), step.step, m, step.order, exponential=exponential)
        assert np.allclose(raised.zeta[power], sigma * m, rtol=0, atol=1e-13)
        for k in range(1, power):
            assert raised.zeta[k] is None or np.abs(raised.zeta[k]).max() < 1e-13
        assert np.abs(sigma).max() > (1e-5 if body is not BODIES["disc"] or power != 4 else -1)


def test_sigma_i_lies_between_the_inverse_moments() -> None:
    """|sigma_i| <= 1/I_1 - 1/I_3, approached but not attained."""
    body, bound = BODIES["triaxial"], 1 - 1 / 3
    assert np.abs(Ingredients(body, unit(15, 20000, 3)).sigma_i).max() < bound
    near = np.array([[1.0, 1e-5, 0.0], [0.0, 1e-5, 1.0]])  # X is then along the axis across
    near = near / np.linalg.norm(near, axis=-1, keepdims=True)
    assert np.allclose(Ingredients(body, near).sigma_i[:, 0], [-bound, bound], rtol=1e-9)
    assert (np.abs(Ingredients(body, near).sigma_i) < bound).all()


@pytest.mark.parametrize("exponential", EXPONENTIALS)
@pytest.mark.parametrize("name", update_names())
def test_equilibria_are_fixed(name: str, exponential: str) -> None:
    for key in ("triaxial", "disc", "sphere"):
        m = BODIES[key].equilibria(1.3)
        assert np.abs(BODIES[key].update(name, exponential)(m, 0.7) - m).max() < 4e-16


@pytest.mark.parametrize("exponential", EXPONENTIALS)
@pytest.mark.parametrize("name", update_names())
def test_separatrix(name: str, exponential: str) -> None:
    """Kept by all updates with omega_o, and by no other."""
    body = BODIES["triaxial"]
    m = np.concatenate([body.separatrix(np.linspace(0.3, 2.8, 6), branch, 1.2) for branch in (1, -1)])
    drift = np.abs(body.rayleigh(body.update(name, exponential)(m, 0.4)) - 1 / 2).max()
    if name.endswith("o") or name == "eul_i":
        assert drift < 5e-16
    else:
        assert drift > 1e-9


@pytest.mark.parametrize("name", ["eul_i", "rk2_ib", "sy4_io"])
def test_any_length_is_a_change_of_time(name: str) -> None:
    body, m = BODIES["tilted"], unit(16, 10, 3)
    update = body.update(name)
    assert np.allclose(update(2.5 * m, 0.1), 2.5 * update(m, 0.25), rtol=0, atol=2e-15)


def test_discs_are_integrated_exactly() -> None:
    """Axisymmetric bodies: improved Euler with exp is the motion itself, with Cayley its orbit."""
    body, m = BODIES["disc"], unit(17, 20, 3)
    assert np.abs(body.update("eul_i", "exp")(m, 0.8) - body.exact(m, 0.8)).max() < 5e-16
    after = body.update("eul_i")(m, 0.8)
    assert np.abs(body.energy(after) - body.energy(m)).max() < 3e-16
    assert np.abs(after - body.exact(m, 0.8)).max() > 1e-4


def test_refusals() -> None:
    body = BODIES["triaxial"]
    with pytest.raises(lh.errors.InputError, match="rk2_ib"):
        body.update("rk3_b")
    with pytest.raises(lh.errors.InputError, match="closed forms"):
        body.closed_form("eul_b", "series")
    with pytest.raises(lh.errors.InputError, match="m = 0"):
        body.update("eul_i")(np.zeros((2, 3)), 0.1)
    with pytest.raises(lh.errors.InputError, match="several exponentials"):
        lh.instances.NominalTimeCorrected(lh.methods.CommutatorFree4(), 5)  # type: ignore[arg-type]
    with pytest.raises(lh.errors.InputError, match="finite"):
        body.exact_orbit()(unit(1, 3), np.inf)


# -- the step on the orbit itself ------------------------------------------------------------------------
@pytest.mark.parametrize("name", [name for name in BODIES if name != "no triangle"])
@pytest.mark.parametrize("dt", [1.0, 3.0])
def test_energy_stays_to_round_off(name: str, dt: float) -> None:
    body = BODIES[name]
    m = np.concatenate([unit(18, 30, 3), body.equilibria() + 1e-7 * unit(19, 6, 3)])
    m = m / np.linalg.norm(m, axis=-1, keepdims=True)
    update, start, worst = body.exact_orbit(), body.energy(m), 0.0
    circled = np.argmax(np.abs(m @ body.axes), axis=-1)[:, None]
    sides = np.sign(np.take_along_axis(m @ body.axes, circled, -1))
    away = np.abs(np.take_along_axis(m @ body.axes, circled, -1)) > 0.999  # next to an axis
    for _ in range(int(100 / dt)):
        m = update(m, dt)
        worst = max(worst, float(np.abs(body.energy(m) - start).max()))
    assert worst < 4e-15
    assert np.abs(np.sum(m * m, axis=-1) - 1).max() < 1e-14
    here = np.sign(np.take_along_axis(m @ body.axes, circled, -1))
    middle = circled == 1
    assert (here == sides)[away & ~middle].all()


def test_large_steps_stay_on_their_side() -> None:
    """Where the root is lost the step is made in halves: no point changes to the other closed orbit."""
    body, m = BODIES["triaxial"], unit(20, 200, 3)
    axes = body.axes
    a1, _, a3 = body._gaps(np.float64)
    p = m @ axes
    circled = np.where(a1 * p[:, 2] ** 2 > a3 * p[:, 0] ** 2, 2, 0)[:, None]
    side, update, lost = np.sign(np.take_along_axis(p, circled, -1)), body.exact_orbit(), 0
    start = body.energy(m)
    for _ in range(30):
        lost += int((~orbit_step(body, m).root(np.full((200, 1), 6.0))[1]).sum())
        m = update(m, 6.0)
        assert (np.sign(np.take_along_axis(m @ axes, circled, -1)) == side).all()
    assert lost > 100
    assert np.abs(body.energy(m) - start).max() < 4e-15


def test_root_of_the_step() -> None:
    """s = sigma_i (1 + t rho) + O(t^2); the value of the cubic is the change of the energy."""
    body, m = BODIES["tilted"], unit(21, 10, 3)
    local, at = orbit_step(body, m), Ingredients(body, m)
    errors = []
    for h in (0.02, 0.01):
        s, kept = local.root(np.full((10, 1), h))
        assert kept.all()
        errors.append(np.abs(s - at.sigma_i * (1 + h * local.rho)).max())
    assert abs(slopes([2, 1], errors)[0] - 2) < 0.1
    h, s = 0.7, at.sigma_i + 0.3
    after = lh.Action(body.representation, "cayley").act(h * (local.omega + s * m), m)
    wanted = h**2 * at.v2 / (2 * (1 + h**2 * (at.v2 + s**2) / 4) ** 2) * local.value(s, np.full((10, 1), h))
    assert np.allclose(body.energy(after) - body.energy(m), wanted[:, 0], rtol=0, atol=1e-15)


def test_tower_on_euler_is_the_series_of_the_root() -> None:
    """Orbit orders 2, 3, 4: sigma_i (1 + t rho + t^2 (rho^2 + (sigma_i (q - p)/v^2 + v^2)/4)), with Cayley."""
    for body in (BODIES["triaxial"], BODIES["tilted"], BODIES["disc"]):
        m = unit(25, 10, 3)
        at, local = Ingredients(body, m), orbit_step(body, m)
        q = np.sum(local.omega * body.apply(local.omega), axis=-1, keepdims=True)
        last = local.rho**2 + (at.sigma_i * (q / at.v2 - at.R) + at.v2) / 4
        raised = lh.steps.correction(body.field("o"), lh.Euler(), m, 4, exponential="cayley").zeta
        for k, factor in ((1, 1.0), (2, local.rho), (3, last)):
            assert np.allclose(raised[k], at.sigma_i * factor * m, rtol=0, atol=1e-12)


def test_clock_of_the_step_on_the_orbit() -> None:
    body, m = BODIES["triaxial"], 1.4 * unit(22, 5, 3)
    table = lh.observed_order(
        body.field("o"), m, body.exact_orbit().step, [0.1, 0.05, 0.025], t_span=(0, 2), exponential="cayley"
    )
    assert max(table.orbit_errors) < 1e-14
    assert abs(slopes(table.dts, table.trajectory_errors)[-1] - 2) < 0.1
    update, there, passed = body.exact_orbit(), m, np.zeros(5)
    for _ in range(20):
        passed = passed + update.time(there, 0.05)
        there = update(there, 0.05)
    right, nominal = np.abs(there - body.exact(m, passed)).max(), np.abs(there - body.exact(m, 1.0)).max()
    assert 5 * right < nominal


class AsEuler(lh.steps.OneExponential):
    """A step without its clock, to be corrected from order 1 on."""

    order = 1

    def __init__(self, step: lh.steps.OneExponential) -> None:
        self._step = step

    def generator(self, action: Any, psi: Any, m: Any, t: Any, h: Any) -> Any:
        return self._step.generator(action, psi, m, t, h)


def test_series_of_the_step_on_the_orbit() -> None:
    """Expanded in h its orbit is that of the flow: isotropy corrects nothing, the clock begins with t^2 rho/2."""
    body, m = BODIES["triaxial"], unit(23, 3)
    raised = lh.steps.correction(body.field("o"), AsEuler(body.exact_orbit().step), m, 6, exponential="cayley")
    assert max(np.abs(x).max() for x in raised.zeta if x is not None) < 1e-12
    assert np.isclose(raised.clock[2], orbit_step(body, m).rho[0] / 2, rtol=1e-12)
    control = lh.steps.correction(body.field("o"), lh.Euler(), m, 6, exponential="cayley")
    assert max(np.abs(x).max() for x in control.zeta if x is not None) > 1e-2


def test_on_time_is_of_its_order_without_a_clock() -> None:
    body, m = BODIES["triaxial"], unit(24, 3)
    reference = Reference(body.field("o"), m.astype(np.longdouble))
    for order in (2, 3, 4):
        step = lh.instances.NominalTimeCorrected(lh.Euler(), order)
        table = lh.observed_order(body.field("o"), m, step, [0.1, 0.05, 0.025], t_span=(0, 2), reference=reference)
        assert abs(slopes(table.dts, table.trajectory_errors)[-1] - order) < 0.15


def test_steps_in_two_halves_take_the_time_of_both() -> None:
    update, m = BODIES["triaxial"].exact_orbit(), unit(21, 200, 3)
    for dt in (8.0, 16.0):
        kept = orbit_step(BODIES["triaxial"], m).root(np.full((200, 1), dt))[1][..., 0]
        after, passed = update.advance(m, dt)
        between, first = update.advance(m, dt / 2)
        last, second = update.advance(between, dt / 2)
        assert 3 < (~kept).sum() < 197
        assert np.allclose(passed[~kept], (first + second)[~kept]) and np.allclose(after[~kept], last[~kept])
