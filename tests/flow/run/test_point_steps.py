"""Steps that give their point instead of exponentials: a rotation by cos and sin, which is Euler's step on so(2)."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError
from liehom.flow.steps.conserving import Conserving
from liehom.flow.steps.step import Generator, LocalStep, Step

FIELD = lh.GeneratorField(lh.defining(lh.so(2)), ["1 + m0/2"])
START = np.array([0.6, 0.8])
ENSEMBLE = np.array([[0.6, 0.8], [1.0, 0.0], [0.0, -2.0]])


class Rotation(Step):
    """Euler's step on so(2), written without an exponential."""

    order = 1

    def at(self, action: Any, psi: Generator, m: Any, t: Any, *, error_terms: int = 0) -> LocalStep:
        velocity = psi(m, t)

        def point(h: Any) -> Any:
            c, s = np.cos(h * velocity), np.sin(h * velocity)
            x, y = m[..., :1], m[..., 1:]
            return np.concatenate([c * x - s * y, s * x + c * y], axis=-1)

        return LocalStep(action, m, point=point)


class Nothing(Step):
    order = 1


def agree(options: dict[str, Any], start: Any = START, wrap: Any = lambda step: step) -> tuple[Any, Any]:
    """The solutions by the rotation and by Euler's step, which must agree to round-off."""
    made, wanted = (lh.integrate(FIELD, (0, 2), start, step=wrap(s), **options) for s in (Rotation(), lh.Euler()))
    assert made.t.shape == wanted.t.shape and np.allclose(made.t, wanted.t, rtol=1e-13, atol=1e-13, equal_nan=True)
    assert np.allclose(made.y, wanted.y, rtol=1e-12, atol=1e-12, equal_nan=True)
    return made, wanted


@pytest.mark.parametrize("start", [START, ENSEMBLE], ids=["one", "ensemble"])
@pytest.mark.parametrize("options", [{"dt": 0.1}, {"rtol": 1e-3}, {"dt": 0.1, "t_eval": [0.05, 1.21, 2.0]}])
def test_the_loop_takes_points(options: dict[str, Any], start: Any) -> None:
    agree(options, start)


@pytest.mark.parametrize("options", [{"dt": 0.1}, {"rtol": 1e-3}, {"dt": 0.1, "t_eval": [0.05, 1.21, 2.0]}])
def test_compiled_code_takes_points(options: dict[str, Any]) -> None:
    pytest.importorskip("llvmlite")
    for start in (START, ENSEMBLE):
        made, _ = agree({**options, "engine": "llvm"}, start)
        eager = lh.integrate(FIELD, (0, 2), start, step=Rotation(), **options)
        assert np.allclose(made.y, eager.y, rtol=1e-12, atol=1e-12, equal_nan=True)


def test_jax_takes_points() -> None:
    pytest.importorskip("jax")
    agree({"dt": 0.1, "engine": "jax"}, ENSEMBLE)


def test_dense_output_and_events_take_points() -> None:
    def level(t: Any, y: Any) -> Any:
        return y[..., 0] + 0.3

    made, wanted = agree({"dt": 0.1, "dense_output": True, "events": level})
    assert np.allclose(made.sol([0.33, 1.01, 2.05]), wanted.sol([0.33, 1.01, 2.05]), atol=1e-13)
    assert len(made.t_events[0]) == 1 and np.allclose(made.t_events, wanted.t_events, atol=1e-13)


def test_an_interrupted_run_goes_on(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"

    def run(**options: Any) -> Any:
        return lh.integrate(FIELD, (0, 2), START, step=Rotation(), dt=0.05, **options)

    def interrupted(fraction: float) -> None:
        raise KeyboardInterrupt

    whole = run()
    with pytest.raises(KeyboardInterrupt):
        run(checkpoint=path, progress=interrupted)
    assert path.exists()
    again = run(checkpoint=path)
    assert np.array_equal(again.y, whole.y) and np.array_equal(again.t, whole.t)


@pytest.mark.parametrize("order", [2, 3, 4])
def test_its_correction_is_an_outermost_factor(order: int) -> None:
    """On so(2) isotropy is trivial: the correction is the clock alone, so Exp is the same as for Euler's step."""
    made, _ = agree({"dt": 0.1}, wrap=lambda step: lh.Corrected(step, order))
    assert made.report.base_order == 1 and made.report.order == order


class Scaled(Step):
    """Heun's step in coordinates, scaled back to the sphere: a projection."""

    order = 2

    def at(self, action: Any, psi: Generator, m: Any, t: Any, *, error_terms: int = 0) -> LocalStep:
        field, size = psi.field, np.sqrt(np.sum(m * m, axis=-1, keepdims=True))
        first = field.infinitesimal(psi(m, t), m)

        def point(h: Any) -> Any:
            z = m + h * first
            z = m + h / 2 * (first + field.infinitesimal(psi(z, t + h), z))
            return z * (size / np.sqrt(np.sum(z * z, axis=-1, keepdims=True)))

        return LocalStep(action, m, point=point)


BODY = lh.GeneratorField(lh.adjoint(lh.so(3)), ["-m0", "-m1/2", "-m2/4"])
POINT = np.array([0.6, 0.48, 0.64])


@pytest.mark.parametrize(("step", "order"), [(Scaled(), 2), (lh.Corrected(Scaled(), 4), 4)])
def test_a_projection_has_its_order_and_is_corrected(step: Step, order: int) -> None:
    exact = lh.integrate(BODY, (0, 2), POINT, step=lh.LieTaylor(12), dt=0.1).y[:, -1]
    errors = [
        float(np.linalg.norm(lh.integrate(BODY, (0, 2), POINT, step=step, dt=dt).y[:, -1] - exact))
        for dt in (0.1, 0.05)
    ]
    assert order - 0.4 < np.log2(errors[0] / errors[1]) < order + 0.8


def test_a_projection_conserves_energy_if_it_is_told_to() -> None:
    energy = "m0**2 + m1**2/2 + m2**2/4"
    weights = np.array([1, 0.5, 0.25])
    for step, bound in ((Conserving(Scaled(), energy), 1e-14), (Conserving(lh.Corrected(Scaled(), 3), energy), 1e-14)):
        y = lh.integrate(BODY, (0, 5), POINT, step=step, dt=0.1).y.T
        assert np.abs(y**2 @ weights - POINT**2 @ weights).max() < bound
        assert np.abs(np.linalg.norm(y, axis=-1) - 1).max() < 1e-14
    y = lh.integrate(BODY, (0, 5), POINT, step=Scaled(), dt=0.1).y.T
    assert np.abs(y**2 @ weights - POINT**2 @ weights).max() > 1e-7  # without it


def test_a_step_of_points_has_no_factors() -> None:
    psi, action = Generator(FIELD, 1), lh.Action(FIELD.representation)
    with pytest.raises(InputError, match="no `factors`"):
        Rotation().factors(action, psi, START, np.zeros(1), np.array([0.1]))
    with pytest.raises(InputError, match="Nothing defines no step: write its method `factors`, `generator` or `at`"):
        Nothing().at(action, psi, START, np.zeros(1)).point(np.array([0.1]))
