"""Compiled steps that keep a first integral: the same points, values and reports as on arrays."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError, TraceError
from liehom.flow.steps.conserving import Conserving
from liehom.studies.rigid_body_updates import ExactOrbit
from tests.flow.engines.test_compiled import EPS, ULPS, both, cache, sphere

__all__ = ["cache"]

W = np.array([1.0, 0.5, 0.25])
BODY = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * W)
BASES = {"Euler": lh.Euler(), "Heun": lh.Heun(), "Taylor": lh.LieTaylor(3), "corrected": lh.Corrected(lh.Euler(), 2)}


def energy(m: Any) -> Any:
    return np.sum(m * m * W, axis=-1) / 2


def starts() -> Any:
    """An equilibrium, a point next to one, and seventeen others."""
    return np.concatenate([[[0.0, 0.0, 1.0], [1e-9, 0.0, 1.0]], sphere(17)])


@pytest.mark.parametrize("aim", ["start", "previous"])
@pytest.mark.parametrize("base", BASES)
def test_points_values_and_reports_agree(base: str, aim: str) -> None:
    step = Conserving(BASES[base], energy, aim=aim)
    plain, made = both(BODY, (0, 3), starts(), step=step, dt=0.1, clock="nominal")
    # both keep the energy to round-off, of which the iteration stops at another multiple
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=16 * ULPS * EPS)
    drift = np.abs(energy(np.moveaxis(made.y, 1, -1)) - energy(starts())[:, None]).max()
    assert drift <= (1 if aim == "start" else 30) * 4 * EPS
    first, second = plain.report.conservation, made.report.conservation
    names = ("rank", "wanted", "missed_steps", "left_steps", "short_steps")
    assert [getattr(first, x) for x in names] == [getattr(second, x) for x in names]
    assert second.left_steps == 60 and 1 <= second.iterations <= first.iterations + 2
    assert second.defect <= 4 * EPS


@pytest.mark.parametrize("engine", ["numpy", "llvm", "jax"])
@pytest.mark.parametrize("base", [lh.Heun(), lh.Corrected("euler", 2), lh.RKMK("rk45")], ids=str)
def test_events_of_some_trajectories_of_an_ensemble(base: lh.Step, engine: str) -> None:
    """Steps with a zero in them are made again for the trajectories that have one: each has its own energy."""

    def height(t: Any, y: Any) -> Any:
        return y[..., 0]

    height.terminal = 2  # type: ignore[attr-defined]
    step, points = Conserving(base, energy), sphere(4)
    options: dict[str, Any] = {"step": step, "dt": 0.1, "events": height, "engine": engine}
    if engine == "jax":
        with pytest.raises(InputError, match="events"):
            lh.integrate(BODY, (0, 10), points, **options)
        return
    together = lh.integrate(BODY, (0, 10), points, **options)
    assert len({len(t) for t in together.t_events[0]}) > 1
    for i, point in enumerate(points):
        alone = lh.integrate(BODY, (0, 10), point, **{**options, "engine": "numpy"})
        np.testing.assert_allclose(together.t_events[0][i], alone.t_events[0], rtol=0, atol=1e-12)
        assert np.abs(energy(together.y_events[0][i]) - energy(point)).max(initial=0.0) <= 32 * EPS


def test_without_the_correction_it_drifts() -> None:
    made = lh.integrate(BODY, (0, 3), starts(), step=lh.Heun(), dt=0.1, engine="llvm")
    assert np.abs(energy(np.moveaxis(made.y, 1, -1)) - energy(starts())[:, None]).max() > 1e-6


def test_a_clock_of_the_base_and_a_given_value() -> None:
    step = Conserving(lh.Corrected(lh.Euler(), 2), energy)
    plain, made = both(BODY, (0, 3), sphere(5), step=step, dt=0.1, t_eval=[1.0, 3.0])
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=16 * ULPS * EPS)
    start, value = np.array([0.6, 0.48, 0.64]), float(energy(np.array([0.6, 0.48, 0.64]))) + 1e-6
    made = lh.integrate(BODY, (0, 1), start, step=Conserving(lh.Heun(), energy, value=value), dt=0.1, engine="llvm")
    assert np.abs(energy(made.y[:, 1:].T) - value).max() <= 4 * EPS


@pytest.mark.parametrize("representation", ["so(4)", "so(3,1)"])
def test_isotropy_of_larger_dimension(representation: str) -> None:
    """Rotations of a rotor on S^3 and on hyperbolic space: a height is kept by isotropy of dimension three."""
    algebra = lh.so(4) if representation == "so(4)" else lh.so(3, 1)
    rho = lh.defining(algebra)
    count, n = algebra.dimension, rho.size
    matrices = np.array([a.to_numpy() for a in rho.matrices], dtype=float)
    gradient = np.array([1.0, 0.3, 0.0, 0.0])

    def psi(m: Any) -> Any:
        # the commuting part of F's gradient is taken out, so that F is a first integral
        columns = np.stack([(m @ matrices[a].T) @ gradient for a in range(count)], axis=-1)
        weights = np.arange(1.0, count + 1)
        square = np.sum(columns * columns, axis=-1, keepdims=True)
        return weights - columns * np.sum(weights * columns, axis=-1, keepdims=True) / (square + 1e-300)

    field = lh.GeneratorField(rho, psi)
    point = np.zeros(n)
    point[-1] = 1.0
    y0 = lh.Action(rho).act(0.3 * np.random.default_rng(0).normal(size=(5, count)), np.broadcast_to(point, (5, n)))
    plain, made = both(field, (0, 1), y0, step=Conserving(lh.Heun(), lambda m: m @ gradient), dt=0.05)
    scale = float(np.abs(plain.y).max())
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=64 * ULPS * EPS * scale)
    assert np.abs(np.moveaxis(made.y, 1, -1) @ gradient - (y0 @ gradient)[:, None]).max() <= 32 * EPS * scale


def test_a_field_that_vanishes_at_a_time() -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t: -m * W * np.asarray(t)[..., None])
    plain, made = both(field, (-1, 1), sphere(4), step=Conserving(lh.Heun(), energy), dt=0.125)
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=16 * ULPS * EPS)
    assert made.report.conservation.missed_steps == plain.report.conservation.missed_steps == 0


def test_jax_gives_the_same() -> None:
    step = Conserving(lh.Heun(), energy)
    plain = lh.integrate(BODY, (0, 2), sphere(3), step=step, dt=0.1, engine="numpy")
    made = lh.integrate(BODY, (0, 2), sphere(3), step=step, dt=0.1, engine="jax")
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=16 * ULPS * EPS)
    assert made.report.conservation.defect <= 4 * EPS


def test_several_integrals_are_not_compiled() -> None:
    step = Conserving(lh.Heun(), ["m0**2 + m1**2/2 + m2**2/4", "m0**2 + m1**2 + m2**2"])
    with pytest.raises(TraceError, match="compiled"):
        lh.integrate(BODY, (0, 1), sphere(1)[0], step=step, dt=0.1, engine="llvm")


@pytest.mark.parametrize("dt", [0.2, 1.0, 2.5])
def test_the_step_of_the_rigid_body_on_its_orbit(dt: float) -> None:
    """Also where the root of its cubic is lost: such steps are made on arrays."""
    body = lh.instances.RigidBody([1, 2, 3])
    options: dict[str, Any] = {"step": ExactOrbit(body), "dt": dt, "exponential": "cayley"}
    plain, made = both(body.field("o"), (0, 20), sphere(13), clock="nominal", **options)
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=200 * ULPS * EPS)
    assert np.abs(body.energy(np.moveaxis(made.y, 1, -1)) - body.energy(sphere(13))[:, None]).max() < 4e-15


@pytest.mark.parametrize("base", [lh.Euler(), lh.Heun()], ids=["Euler", "Heun"])
def test_adapted_sizes_know_what_isotropy_does_to_the_error(base: Any) -> None:
    """The correction removes a part of the error of Euler's step, which then takes a third of the steps."""
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * [1.0, 0.5, 0.25])
    starts = np.random.default_rng(0).normal(size=(6, 3))
    starts /= np.linalg.norm(starts, axis=-1, keepdims=True)
    step = lh.Conserving(base, lambda m: np.sum(m * m * [1.0, 0.5, 0.25], axis=-1) / 2)
    options: dict[str, Any] = {"step": step, "rtol": 1e-5, "t_eval": [2.0]}
    plain = lh.integrate(field, (0, 2), starts, **options, engine="numpy")
    made = lh.integrate(field, (0, 2), starts, engine="llvm", **options)
    np.testing.assert_array_equal(made.n_steps, plain.n_steps)
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=1e-10)


def test_a_value_for_each_trajectory_is_refused_with_the_reason() -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), ["-m0", "-m1/2", "-m2/4"])
    step = lh.Conserving(lh.Heun(), "m0**2 + m1**2/2 + m2**2/4", value=[0.5, 0.6])
    with pytest.raises(TraceError, match="for each trajectory"):
        lh.integrate(field, (0, 1), np.eye(3)[:2] + 0.3, step=step, dt=0.1, engine="llvm")


@pytest.mark.parametrize("count", [65, 200])
def test_an_ensemble_larger_than_the_sample_of_ranks(count: int) -> None:
    """Ranks are reported for some of the initial points, and the values to conserve are those of these points."""
    made = lh.integrate(BODY, (0, 1), sphere(count), step=Conserving(lh.Heun(), energy), dt=0.1, engine="llvm")
    drift = np.abs(energy(np.moveaxis(made.y, 1, -1)) - energy(sphere(count))[:, None]).max()
    assert drift <= 4 * EPS and made.report.conservation.rank == 1


@pytest.mark.parametrize("y0", [[0.0, 0.0, 1.0], [0.6, 0.48, 0.64], [[0.0, -2.0, 0.0], [0.6, 0.48, 0.64]]], ids=str)
def test_equilibria_are_left_alone_by_compiled_code_too(y0: list[Any]) -> None:
    sol, plain = (
        lh.integrate(BODY, (0.0, 3.0), y0, step=Conserving(lh.Heun(), energy), dt=0.1, engine=engine)
        for engine in ("llvm", "numpy")
    )
    assert sol.report.engine == "llvm" and sol.report.equilibria == plain.report.equilibria
    np.testing.assert_allclose(sol.y, plain.y, rtol=0, atol=1e-13)
