"""Laws of all symplectic steps: Poisson maps, orders, symmetry, Casimir functions, energies, compiled runs."""

from functools import cache
from typing import Any

import numpy as np
import pytest

import liehom as lh
from tests.flow.methods.spaces import moved, poisson_defect, system

SPHERICAL, VARIATIONAL, ISOSPECTRAL = (
    lh.SphericalMidpoint(), lh.methods.VariationalMidpoint(), lh.methods.IsospectralMidpoint(),
)  # fmt: skip
MOSER, SPLITTING = lh.methods.MoserVeselov(), lh.methods.Splitting()
STEPS = [
    (SPHERICAL, "so(3)"), (SPHERICAL, "three spins"), (VARIATIONAL, "so(3)"), (VARIATIONAL, "three spins"),
    (VARIATIONAL, "heavy top"), (VARIATIONAL, "sp(4,R)"), (ISOSPECTRAL, "so(3)"), (ISOSPECTRAL, "body in R^4"),
    (ISOSPECTRAL, "su(3)"), (ISOSPECTRAL, "sp(4,R)"), (MOSER, "body"), (MOSER, "body in R^4"), (SPLITTING, "body"),
    (SPLITTING, "heavy top"), (SPLITTING, "su(3)"),
]  # fmt: skip
COMPOSED = [
    (lh.methods.Composition(SPHERICAL, 4), "three spins"),
    (lh.methods.Composition(ISOSPECTRAL, 4, "yoshida"), "body in R^4"),
    (lh.methods.Composition(MOSER, 4), "body"),
    (lh.methods.Composition(SPLITTING, 6), "heavy top"),
]
ALL = [*STEPS, *COMPOSED]
IDS = [f"{step} on {name}" for step, name in ALL]


@pytest.mark.parametrize(("step", "name"), ALL, ids=IDS)
def test_step_is_a_poisson_map(step: lh.Step, name: str) -> None:
    assert poisson_defect(step, system(name), 0.2) < 1e-9


@pytest.mark.parametrize("step", [lh.RKMK("rk4"), lh.Heun(), lh.LieTaylor(3)], ids=str)
@pytest.mark.parametrize("name", ["so(3)", "body in R^4", "heavy top"])
def test_rkmk_and_taylor_steps_are_not_poisson_maps(step: lh.Step, name: str) -> None:
    """A control, of orders up to 4."""
    assert poisson_defect(step, system(name), 0.5) > 3e-8


@pytest.mark.parametrize(("step", "name"), ALL, ids=IDS)
def test_step_backwards_is_the_inverse(step: lh.Step, name: str) -> None:
    data = system(name)
    there = moved(step, data, data.start, 0.2)
    assert np.abs(there - data.start).max() > 1e-3
    assert np.abs(moved(step, data, there, -0.2) - data.start).max() < 1e-13


def test_heun_backwards_is_not_the_inverse() -> None:
    """A control."""
    data = system("so(3)")
    there = moved(lh.Heun(), data, data.start, 0.2)
    assert np.abs(moved(lh.Heun(), data, there, -0.2) - data.start).max() > 1e-6


@cache
def reference(name: str) -> Any:
    data = system(name)
    return lh.integrate(data.field, (0, 0.5), data.start, step=lh.LieTaylor(12), dt=1 / 40).y[:, -1]


@pytest.mark.parametrize(("step", "name"), ALL, ids=IDS)
def test_order_is_the_one_promised_and_not_more(step: lh.Step, name: str) -> None:
    data = system(name)
    sizes = np.array([1 / 8, 1 / 16] if step.order == 6 else [1 / 16, 1 / 32])
    ends = [lh.integrate(data.field, (0, 0.5), data.start, step=step, dt=h).y[:, -1] for h in sizes]
    errors = [np.abs(end - reference(name)).max() for end in ends]
    assert abs(np.log2(errors[0] / errors[1]) - step.order) < 0.15


@pytest.mark.parametrize(
    ("name", "casimirs"),
    [
        ("three spins", lambda y: [np.sum(y[i : i + 3] ** 2, axis=0) for i in (0, 3, 6)]),
        ("heavy top", lambda y: [np.sum(y[3:] ** 2, axis=0), y[0] * y[5] - y[1] * y[4] + y[2] * y[3]]),
        # the sum of squares, and the Pfaffian
        ("body in R^4", lambda y: [np.sum(y**2, axis=0), y[0] * y[5] - y[1] * y[4] + y[2] * y[3]]),
    ],
)
@pytest.mark.parametrize("step", [SPHERICAL, VARIATIONAL, ISOSPECTRAL, MOSER, SPLITTING], ids=str)
def test_casimir_functions_are_conserved_to_round_off(name: str, casimirs: Any, step: lh.Step) -> None:
    if (step, name) not in STEPS:
        pytest.skip("not a step of this system")
    data = system(name)
    sol = lh.integrate(data.field, (0, 10), data.start, step=step, dt=0.1)
    for values in casimirs(sol.y):
        assert np.ptp(values) < 3e-14 * max(1.0, np.abs(values).max())
    assert np.abs(sol.y[:, -1] - sol.y[:, 0]).max() > 0.1


@pytest.mark.parametrize(("step", "name"), [(s, n) for s, n in STEPS if n in ("so(3)", "body", "heavy top")], ids=str)
def test_energy_error_does_not_grow(step: lh.Step, name: str) -> None:
    """In 100 times the time the error of the energy is the same; Heun's grows tenfold at least.

    For free bodies in R^3 the spherical midpoint and the Moser-Veselov step have no error of the energy at all.
    """
    data = system(name)
    spans = []
    for tried in (step, lh.Heun()):
        sol = lh.integrate(data.field, (0, 2000), data.start, step=tried, dt=0.1, engine="llvm")
        error = np.abs(data.energy(sol.y.T) - data.energy(data.start))
        spans.append((error[:200].max(), error.max()))
    (early, full), (early_heun, whole_heun) = spans
    assert full < 2 * early + 1e-14
    assert whole_heun > 10 * early_heun


@pytest.mark.parametrize(("step", "name"), ALL, ids=IDS)
def test_compiled_runs_agree_with_numpy(step: lh.Step, name: str) -> None:
    data = system(name)
    eager, compiled = (
        lh.integrate(data.field, (0, 2), data.start, step=step, dt=0.1, **options).y[:, -1]
        for options in ({}, {"engine": "llvm"})
    )
    assert np.abs(eager - compiled).max() < 1e-13


@pytest.mark.parametrize(("step", "name"), ALL, ids=IDS)
def test_trajectories_of_an_ensemble_do_not_touch(step: lh.Step, name: str) -> None:
    data = system(name)
    starts = data.start * np.array([[1.0], [0.5], [-0.7]])
    together = lh.integrate(data.field, (0, 1), starts, step=step, dt=0.1).y[..., -1]
    for start, end in zip(starts, together, strict=True):
        assert np.abs(lh.integrate(data.field, (0, 1), start, step=step, dt=0.1).y[:, -1] - end).max() < 1e-14


@pytest.mark.parametrize(("step", "name"), [*STEPS, *COMPOSED[:3]], ids=str)
def test_expansion_in_the_step_size_agrees_with_the_flow(step: lh.Step, name: str) -> None:
    """On Jets: equal to order 2, or 4, and different in the next coefficient."""
    data = system(name)
    field = data.field
    action, m, t = lh.Action(field.representation), data.start, np.zeros(1)
    order = step.order + 1
    flow = lh.steps.flow_series(field, m, order, 0.0)
    series = lh.steps.step_series(action, step.at(action, lh.steps.Generator(field, 2), m, t), m, order)
    defects = [np.abs(series.coefficient(k) - flow.point(k)).max() for k in range(order + 1)]
    assert max(defects[:-1]) < 1e-12
    assert defects[-1] > 1e-6


@pytest.mark.parametrize(("step", "name"), [(s, n) for s, n in STEPS if n in ("so(3)", "body", "heavy top")], ids=str)
def test_time_dependent_fields_have_order_two(step: lh.Step, name: str) -> None:
    if step == MOSER:
        pytest.skip("the body of Moser and Veselov is autonomous")
    data = system(name)

    def energy(m: Any, t: Any) -> Any:
        return data.energy(m) * (1 + np.sin(3 * t) / 2)

    field = lh.hamiltonian_field(data.algebra, energy, sign=data.sign)
    fine = lh.integrate(field, (0, 1), data.start, step=lh.LieTaylor(10), dt=1 / 40).y[:, -1]
    errors = [
        np.abs(lh.integrate(field, (0, 1), data.start, step=step, dt=h).y[:, -1] - fine).max() for h in (1 / 16, 1 / 32)
    ]
    assert abs(np.log2(errors[0] / errors[1]) - 2) < 0.15


@pytest.mark.parametrize(("step", "name"), STEPS, ids=str)
def test_extended_precision(step: lh.Step, name: str) -> None:
    data = system(name)
    wide = moved(step, data, data.start.astype(np.longdouble)[None], 0.2)
    assert wide.dtype == np.longdouble
    assert 0 < np.abs(wide - moved(step, data, data.start[None], 0.2)).max() < 1e-14


def test_large_steps_of_the_isospectral_midpoint_are_solved_and_stay_on_the_sphere() -> None:
    data = system("body")
    sol = lh.integrate(data.field, (0, 20), 20 * data.start, step=ISOSPECTRAL, dt=10.0)
    assert sol.success
    np.testing.assert_allclose(np.linalg.norm(sol.y, axis=0), 20 * np.linalg.norm(data.start), rtol=1e-12)


@pytest.mark.filterwarnings("ignore:status -1")
@pytest.mark.parametrize("step", [VARIATIONAL, MOSER], ids=str)
def test_too_large_steps_end_a_run_with_a_message(step: lh.Step) -> None:
    data = system("body")
    sol = lh.integrate(data.field, (0, 1000), 20 * data.start, step=step, dt=10.0)
    assert not sol.success
    assert "smaller step" in sol.message


def test_a_poisson_map_that_is_not_hamiltonian_loses_the_energy_on_cylinders() -> None:
    """On the dual of e(2), J -> J + h^3 is a Poisson map. After the flow of H = J^2/2 the energy grows without bound;
    the variational midpoint for J^2/2 + p_1 keeps its energy, and is a Poisson map as well.
    """
    g, h = lh.euclidean(2), 0.1
    turn = int(np.argmax(np.abs(np.diag(g.killing_form().to_numpy()))))
    p = [k for k in range(3) if k != turn]
    tensor = lh.action.lie_poisson_tensor

    def step(m: Any, shift: float) -> Any:
        angle = h * m[..., turn]
        x, y = m[..., p[0]], m[..., p[1]]
        out = np.array(m)
        out[..., p[0]], out[..., p[1]] = x * np.cos(angle) - y * np.sin(angle), x * np.sin(angle) + y * np.cos(angle)
        out[..., turn] += shift
        return out

    m, eps = np.array([0.7, -0.4, 0.9]), 1e-6
    steps = eps * np.eye(3)
    derivative = ((step(m + steps, h**3) - step(m - steps, h**3)) / (2 * eps)).T
    assert np.allclose(derivative @ tensor(g, m) @ derivative.T, tensor(g, step(m, h**3)), atol=1e-8)
    start = m
    for _ in range(1000):
        m = step(m, h**3)
    assert m[turn] ** 2 / 2 - start[turn] ** 2 / 2 > 0.9
    field = lh.hamiltonian_field(g, lambda m: m[..., turn] ** 2 / 2 + m[..., p[0]])
    y = lh.integrate(field, (0, 100), start, step=lh.methods.VariationalMidpoint(), dt=h).y
    assert np.ptp(y[turn] ** 2 / 2 + y[p[0]]) < 0.01
