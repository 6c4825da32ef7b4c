"""Steps for stiff fields: orders, estimates, L-stability, step sizes that stiffness does not limit."""

import warnings
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import liehom as lh
from liehom.base.errors import InputError
from liehom.flow.methods.named import step_named
from liehom.flow.methods.stability import amplification, stability_limit
from liehom.flow.methods.stiff import METHODS, ExponentialRosenbrock, Rosenbrock, StiffRKMK
from liehom.flow.methods.tableaux import radau
from tests.benchmarks.stiff import systems

RHO = lh.adjoint(lh.so(3))
W = np.array([1.0, 0.5, 0.2])
START = np.array([0.6, 0.48, 0.64])
STEPS: list[lh.Step] = [
    StiffRKMK("radau3"), StiffRKMK("radau5"), StiffRKMK("radau9"), StiffRKMK("sdirk4"), StiffRKMK("gauss2"),
    StiffRKMK("gauss3"), Rosenbrock("ros2"), Rosenbrock("rodas3"), Rosenbrock("rodas4"), ExponentialRosenbrock(3),
    ExponentialRosenbrock(4),
]  # fmt: skip
IDS = [repr(step) for step in STEPS]


def body() -> lh.GeneratorField:
    """A rigid body with a torque that depends on time."""
    return lh.GeneratorField(RHO, lambda m, t: -m * W * (1 + 0.3 * np.sin(2 * t)[..., None]))


def chasing(rate: float) -> lh.GeneratorField:
    """Relaxation with a rate to a point that moves on the equator, at unit speed."""

    def psi(m: Any, t: Any) -> Any:
        return rate * np.cross(m, np.stack([np.cos(t), np.sin(t), 0 * t], axis=-1))

    return lh.GeneratorField(RHO, psi)


# -- orders --------------------------------------------------------------------------------------------------
def errors(step: lh.Step, counts: list[int]) -> Any:
    field = body()
    end = lh.integrate(field, (0, 1), START, step=lh.LieTaylor(14), dt=0.05).y[:, -1]
    return np.array(
        [np.abs(lh.integrate(field, (0, 1), START, step=step, dt=1 / n).y[:, -1] - end).max() for n in counts]
    )


@pytest.mark.parametrize("step", [s for s in STEPS if s.order < 7] + [ExponentialRosenbrock(2)], ids=repr)
def test_time_dependent_fields_are_integrated_with_the_order_of_the_step(step: lh.Step) -> None:
    e = errors(step, [8, 16] if step.order > 4 else [16, 32])
    assert abs(np.log2(e[0] / e[1]) - step.order) < 0.35


def test_a_rosenbrock_step_without_the_derivative_by_time_loses_its_order(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(METHODS, "rodas4", METHODS["rodas4"]._replace(gammas=(0.0,) * 6))
    e = errors(Rosenbrock("rodas4"), [16, 32])
    assert np.log2(e[0] / e[1]) < 2.5


@pytest.mark.parametrize("step", STEPS, ids=IDS)
def test_estimates_have_their_order(step: lh.Step) -> None:
    action, psi = lh.Action(RHO), lh.steps.Generator(body(), 2)
    local: Any = step.at(action, psi, START, np.array([0.3]))
    sizes = [0.4, 0.2] if step.order > 6 else [0.05, 0.025]
    estimate = [np.linalg.norm(local.estimate(np.array([h]))) for h in sizes]
    assert abs(np.log2(estimate[0] / estimate[1]) - local.estimate_order) < 0.3


def test_radau_nodes_and_weights_integrate_polynomials() -> None:
    for stages in (2, 3, 5, 7):
        t = radau(stages)
        assert t.first_violation(2 * stages - 1) is None
        assert t.first_violation(2 * stages) is not None
        _, b, c, _ = t.to_numpy()
        np.testing.assert_allclose(b @ c ** (2 * stages - 2), 1 / (2 * stages - 1), rtol=1e-13)
    np.testing.assert_allclose(radau(3).to_numpy()[0], lh.tableau("radau5").to_numpy()[0], rtol=0, atol=1e-14)


# -- stiffness -----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("rate", [1e3, 1e6])
@pytest.mark.parametrize("step", [s for s in STEPS if "gauss" not in repr(s)], ids=repr)
def test_one_step_of_a_linear_relaxation_is_damped(step: lh.Step, rate: float) -> None:
    field = lh.GeneratorField(RHO, lambda m: rate * np.cross(m, [0.0, 0.0, 1.0]))
    sol = lh.integrate(field, (0, 1), np.array([1e-3, 0.0, np.sqrt(1 - 1e-6)]), step=step, dt=1.0).y[:, -1]
    assert np.hypot(sol[0], sol[1]) < 1e-3 * (30 / rate) + 1e-8


@cache
def explicit_steps() -> float:
    """Steps of an explicit pair for the same time, from those for a twentieth of it."""
    with pytest.warns(lh.StiffnessWarning):
        sol = lh.integrate(chasing(1e4), (0, 0.1), [1.0, 0.0, 0.0], step=lh.RKMK("rk45"), rtol=1e-4, engine="llvm")
    return 20.0 * int(sol.n_steps)


@pytest.mark.parametrize("step", STEPS, ids=IDS)
def test_the_number_of_steps_does_not_grow_with_the_rate(step: lh.Step) -> None:
    limit = 1e-4 if step.order < 3 else 1e-6
    counts = []
    for rate in (1e2, 1e4):
        sol = lh.integrate(chasing(rate), (0, 2), [1.0, 0.0, 0.0], step=step, rtol=limit, atol=limit)
        assert sol.success
        counts.append(sol.n_steps)
        behind = np.arctan(1 / rate) if rate > 1e3 else np.arcsin(1 / rate)
        end = np.array([np.cos(2 - behind), np.sin(2 - behind), 0.0])
        assert np.abs(sol.y[:, -1] - end).max() < 30 * limit
        np.testing.assert_allclose(np.linalg.norm(sol.y, axis=0), 1, rtol=0, atol=1e-12)
    assert counts[1] < 2.5 * counts[0]
    assert explicit_steps() > 40 * counts[1] or step.order == 2  # 128 looks across the span are 65 to 129 steps


def test_an_ensemble_calls_psi_hardly_more_often_than_its_trajectories() -> None:
    """A step that cannot be solved for one trajectory is not tried again for the others in turn."""
    field, step = chasing(1e4), StiffRKMK("radau5")
    m = np.array([1.0, 0.0, 0.0]) + 0.4 * np.random.default_rng(0).uniform(-1, 1, size=(6, 3))
    m /= np.linalg.norm(m, axis=-1, keepdims=True)

    def run(starts: Any) -> lh.Solution:
        return lh.integrate(field, (0, 5), starts, step=step, rtol=1e-5, atol=1e-5, t_eval=[5.0])

    together, alone = run(m), [run(start) for start in m]
    assert together.nfev <= 2.5 * max(sol.nfev for sol in alone)  # tried in turn, they are the sum of six numbers
    for i, sol in enumerate(alone):
        assert np.allclose(together.y[i], sol.y, rtol=0, atol=1e-12)


@pytest.mark.parametrize("engine", ["numpy", "llvm"])
def test_a_long_step_does_not_end_where_its_field_grows(engine: str) -> None:
    """Without looks steps are so long that their equations have solutions at the antipode too, which L-stable steps
    take for stable: then errors are 2.
    """
    if engine == "llvm":
        pytest.importorskip("llvmlite")
    system = systems()[0]
    ends = [
        lh.integrate(system.field, (0, 5), system.starts, step=StiffRKMK("radau5"), t_eval=[5.0], engine=engine, **how)
        for how in ({"rtol": 1e-6, "atol": 1e-6}, {"rtol": 1e-3, "atol": 1e-3, "looks": 0})
    ]
    assert (ends[1].statuses == 0).all() and ends[1].n_steps.max() < 40
    assert np.abs(ends[0].y - ends[1].y).max() < 1e-3


@pytest.mark.parametrize("name", ["radau5", "rodas4", "exprb4"])
def test_a_stiff_run_agrees_with_radau_of_scipy(name: str) -> None:
    field = chasing(300.0)

    def right(t: float, y: Any) -> Any:
        return field.vector(y, t)

    wanted = solve_ivp(right, (0, 3), START, method="Radau", rtol=1e-10, atol=1e-12).y[:, -1]
    sol = lh.integrate(field, (0, 3), START, step=step_named(name), rtol=1e-8, atol=1e-10).y[:, -1]
    np.testing.assert_allclose(sol, wanted, rtol=0, atol=1e-6)


@pytest.mark.parametrize("name", ["radau3", "rodas4"])
def test_compiled_code_agrees_with_arrays_on_a_stiff_field(name: str) -> None:
    # not opposite to the point of attraction, where a step of this size amplifies round-off
    starts = np.array([1.0, 0.0, 0.0]) + 0.3 * np.random.default_rng(0).normal(size=(5, 3))
    starts /= np.linalg.norm(starts, axis=-1, keepdims=True)
    for how, bound in (({"dt": 0.05}, 1e-12), ({"rtol": 1e-5}, 1e-6)):
        results: dict[str, Any] = {"step": step_named(name), "t_eval": [0.5, 1.0]} | how
        plain = lh.integrate(chasing(100.0), (0, 1), starts, **results)
        sol = lh.integrate(chasing(100.0), (0, 1), starts, engine="llvm", **results)
        np.testing.assert_allclose(sol.y, plain.y, rtol=0, atol=bound)


def test_correction_raises_the_order_of_stiff_steps() -> None:
    field = lh.GeneratorField(RHO, lambda m: -m * W)
    end = lh.integrate(field, (0, 1), START, step=lh.LieTaylor(14), dt=0.05).y[:, -1]
    for base in (Rosenbrock("ros2"), ExponentialRosenbrock(2), StiffRKMK("radau3")):
        step = lh.Corrected(base, base.order + 1)
        e = [np.abs(lh.integrate(field, (0, 1), START, step=step, dt=h).y[:, -1] - end).max() for h in (1 / 8, 1 / 16)]
        assert np.log2(e[0] / e[1]) > base.order + 0.7


# -- stability -----------------------------------------------------------------------------------------------
LIMITS = {
    "euler": 2.0, "heun": 2.0, "rk23": 2.5127, "rk4": 2.7853, "rk45": 3.3066, "dop853": 6.39, "lietaylor6": 3.5534,
}  # fmt: skip


@pytest.mark.parametrize("name", LIMITS)
def test_stability_limits_are_those_of_the_stability_polynomials(name: str) -> None:
    assert abs(stability_limit(step_named(name)) - LIMITS[name]) < 5e-3


@pytest.mark.parametrize("name", ["rk4", "radau5", "sdirk4", "rodas4", "exprb4", "backward euler"])
def test_amplification_without_isotropy_is_the_stability_function(name: str) -> None:
    step = step_named(name)
    x = np.array([0.1, 0.9, 2.0, 7.0])
    if name == "exprb4":
        wanted = np.exp(-x)
    else:
        a, b, _, _ = lh.tableau({"backward euler": "implicit euler", "rodas4": "rk4"}.get(name, name)).to_numpy()
        wanted = np.array([abs(1 - v * b @ np.linalg.solve(np.eye(len(b)) + v * a, np.ones(len(b)))) for v in x])
    factors = amplification(step, -x)
    if name == "rodas4":  # of order 4, and L-stable
        assert abs(factors[0] - np.exp(-0.1)) < 1e-6 and (factors < 1).all()
    else:
        np.testing.assert_allclose(factors, wanted, rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("s", [0.0, 0.5, 2.0])
def test_isotropy_multiplies_the_increment_of_euler_by_phi(s: float) -> None:
    """With isotropy sigma dt = s: |1 + z phi(i s)|, phi(x) = (e^x - 1)/x, so that it helps oscillation, not damping."""
    z = np.array([-0.5, -1.9, -1.0 + 1.0j, 0.7j])
    total = np.full(4, 1j * s)
    wanted = np.abs(1 + z * np.where(total == 0, 1.0, (np.exp(total) - 1) / np.where(total == 0, 1.0, total)))
    np.testing.assert_allclose(amplification(lh.Euler(), z, isotropy=s), wanted, rtol=0, atol=1e-8)


def test_stiffness_is_noticed_and_named() -> None:
    for engine in ("numpy", "llvm"):
        with pytest.warns(lh.StiffnessWarning, match="Rosenbrock") as result:
            lh.integrate(chasing(1000.0), (0, 1), [0.6, 0.64, 0.48], step=lh.RKMK("rk23"), engine=engine)
        assert abs(result[0].message.rate - 1000) < 20
    with pytest.warns(lh.StiffnessWarning):
        starts = np.array([[0.6, 0.64, 0.48], [1.0, 0.0, 0.0]])
        lh.integrate(chasing(1000.0), (0, 0.5), starts, step=lh.RKMK("rk45"), t_eval=[0.2, 0.3, 0.4, 0.5])


@pytest.mark.parametrize("step", [None, lh.RKMK("rk23"), lh.RKMK("dop853")], ids=repr)
@pytest.mark.parametrize("tolerance", [1e-3, 1e-7])
def test_fields_that_are_not_stiff_give_no_warning(step: Any, tolerance: float) -> None:
    turning = lh.GeneratorField(RHO, lambda m: 50.0 * m[..., 2:] * np.array([0.0, 0.0, 1.0]) - m * W)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for field in (lh.GeneratorField(RHO, lambda m: -m * W), body(), turning, chasing(3.0)):
            sol = lh.integrate(field, (0, 10), START, step=step, rtol=tolerance, atol=tolerance)
            assert sol.success


def test_a_stiff_step_gives_no_warning_on_a_stiff_field() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        lh.integrate(chasing(1e5), (0, 5), START, step=Rosenbrock("rodas3"), rtol=1e-7)


# -- errors --------------------------------------------------------------------------------------------------
def test_explicit_tableaux_and_unknown_names_are_rejected() -> None:
    with pytest.raises(InputError, match="explicit"):
        StiffRKMK("rk4")
    with pytest.raises(InputError, match="nodes"):
        StiffRKMK("lobatto3c")
    with pytest.raises(InputError, match="rodas4"):
        Rosenbrock("rodas5")
    with pytest.raises(InputError, match="2, 3 or 4"):
        ExponentialRosenbrock(5)
