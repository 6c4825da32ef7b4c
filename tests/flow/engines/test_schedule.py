"""Schedules of runs with steps of one size, as the machine code makes them: steps, output times, the end."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from tests.sampling import examples

pytest.importorskip("llvmlite")
TURNING = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t: np.stack([np.cos(t), 0 * t + 1, t], axis=-1))
START = np.array([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0]])
PROPAGATORS = {name: lh.Propagator(TURNING, "rk4", engine=name) for name in ("numpy", "llvm")}


@settings(max_examples=examples(60), deadline=None)
@given(
    steps=st.integers(1, 12),
    shift=st.sampled_from([0.0, 0.3]),
    places=st.lists(st.one_of(st.floats(0, 1), st.integers(0, 12).map(lambda k: k / 12)), max_size=8),
    backwards=st.booleans(),
    dense=st.booleans(),
    lanes=st.integers(1, 2),
)
def test_steps_and_output_times_are_those_of_numpy(
    steps: int, shift: float, places: list[float], backwards: bool, dense: bool, lanes: int
) -> None:
    begin, end = (3.0, 1.0) if backwards else (1.0, 3.0)
    times = np.unique(begin + np.array(places, dtype=float) * (end - begin))[:: -1 if backwards else 1]
    y0 = START if lanes == 2 else START[0]
    options: dict[str, Any] = {"dt": 2.0 / (steps - shift), "dense_output": dense}
    if places:
        options["t_eval"] = times
    plain, made = (PROPAGATORS[name]((begin, end), y0, **options) for name in PROPAGATORS)
    np.testing.assert_array_equal(made.t, plain.t)
    np.testing.assert_array_equal(made.n_steps, plain.n_steps)
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=1e-13)
    if dense:
        np.testing.assert_array_equal(made.sol.steps[0], plain.sol.steps[0])
        np.testing.assert_array_equal(made.sol.steps[2], plain.sol.steps[2])


def test_output_times_have_no_effect_on_steps() -> None:
    go = PROPAGATORS["llvm"]
    wanted = go((1.0, 3.0), START, dt=0.1).y
    some = go((1.0, 3.0), START, dt=0.1, t_eval=[1.05, 1.31, 1.32, 2.0, 2.999999, 3.0]).y
    np.testing.assert_array_equal(some[..., -1], wanted[..., -1])
    np.testing.assert_array_equal(some[..., 3], wanted[..., 10])


@pytest.mark.filterwarnings("ignore:status -1")
@pytest.mark.parametrize("t_eval", [None, [0.5e-11, 3.0]])
def test_a_run_that_is_cut_off_needs_no_more_memory_than_its_steps(t_eval: list[float] | None) -> None:
    field = lh.GeneratorField(lh.defining(lh.so(2)), [1])
    options: dict[str, Any] = {"step": "euler", "dt": 1e-12, "max_steps": 100, "t_eval": t_eval}
    plain, made = (lh.integrate(field, (0, 3), [1.0, 0.0], engine=e, **options) for e in ("numpy", "llvm"))
    assert made.status == plain.status == -1 and made.n_steps == plain.n_steps
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=1e-15)
