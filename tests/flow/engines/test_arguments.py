"""What a corrected step may use of the orbits of a call, and what a call refuses of psi."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import ShapeError
from liehom.flow.engines.arguments import with_tight_frame
from liehom.flow.propagation.propagator import Propagator

STARTS = np.array([[1.0, 0.0, 0.0], [0.0, 0.6, 0.8]])


def action() -> Any:
    return Propagator(lh.GeneratorField(lh.adjoint(lh.so(3)), [0, 0, 1]))._action


def test_orbits_of_one_dimension_share_a_tight_frame() -> None:
    plain, step = action(), lh.Corrected(lh.Euler(), 3)
    assert with_tight_frame(plain, step, STARTS, np.array([2, 2])) is not plain
    assert with_tight_frame(plain, step, STARTS, 2) is not plain


@pytest.mark.parametrize(
    ("step", "start", "dimension"),
    [
        (lh.Corrected(lh.Euler(), 3), STARTS, np.array([0, 2])),
        (lh.Corrected(lh.Euler(), 3), STARTS.astype(np.longdouble), 2),
        (lh.Euler(), STARTS, 2),
    ],
)
def test_other_calls_have_none(step: Any, start: Any, dimension: Any) -> None:
    plain = action()
    assert with_tight_frame(plain, step, start, dimension) is plain


@pytest.mark.parametrize("engine", ["auto", "numpy"])
@pytest.mark.parametrize(
    "psi",
    [
        lambda m, t: -m + np.sin(3 * t) * np.array([0.3, 0.0, 0.1]),
        lambda m, t: np.stack([m[..., 0], m[..., 1], m[..., 2] * t[-1]], axis=-1),
    ],
    ids=["component by component", "one time for all"],
)
def test_as_many_trajectories_as_components_do_not_share_their_times(psi: Any, engine: Any) -> None:
    """All initial times are equal, so that only another time shows which trajectory a component belongs to."""
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), psi)
    with pytest.raises(ShapeError, match=r"times of other ones: write np.sin\(t\)\[\.\.\., None\]"):
        lh.integrate(field, (0, 2), np.full((3, 3), 3**-0.5), engine=engine)


def test_parameters_and_times_of_as_many_trajectories_as_components_are_accepted() -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t: -m * np.array([[1], [2], [3]]) + np.sin(t)[..., None])
    assert lh.integrate(field, (0, 1), np.eye(3)[::-1]).success


@pytest.mark.parametrize("engine", ["numpy", "auto"])
@pytest.mark.parametrize("wrap", [lambda x: x, lh.PerTrajectory], ids=["shared", "per trajectory"])
def test_args_that_jax_traces_need_its_engine(engine: str, wrap: Any) -> None:
    jax = pytest.importorskip("jax")
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m * args["rate"])

    def end(rate: Any) -> Any:
        start = np.array([[0.6, 0.48, 0.64]])
        return lh.integrate(field, (0, 1), start, dt=0.1, args={"rate": wrap(rate)}, engine=engine).y

    with pytest.raises(lh.errors.InputError, match=r"JAX traces.*rate"):
        jax.jit(end)(np.ones((1, 3)))
