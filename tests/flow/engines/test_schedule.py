"""Schedules of runs with steps of one size."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.flow.engines.plan import schedule
from tests.sampling import examples


@settings(max_examples=examples(60), deadline=None)
@given(
    steps=st.integers(1, 12),
    places=st.lists(st.one_of(st.floats(0, 1), st.integers(0, 12).map(lambda k: k / 12)), max_size=8),
    backwards=st.booleans(),
    keeps=st.booleans(),
)
def test_micro_steps_go_through_all_steps_and_output_times(
    steps: int, places: list[float], backwards: bool, keeps: bool
) -> None:
    begin, end = (3.0, 1.0) if backwards else (1.0, 3.0)
    times = np.unique(begin + np.array(places, dtype=float) * (end - begin))[:: -1 if backwards else 1]
    plan = schedule((begin, end), 2.0 / steps, steps, times, keeps=keeps)
    now, seen, row, ends = begin, [], 0, 0
    for k, (size, time, code) in enumerate(zip(plan.sizes, plan.times, plan.codes, strict=True)):
        assert time == now and plan.first[ends] <= k
        commits, stored = bool(code & 1), code >> 1
        if stored >= 0:
            assert stored == row == plan.rows[k] and plan.ends[row] == commits
            if plan.output[row] >= 0:
                seen.append(int(plan.output[row]))
                np.testing.assert_allclose(now + size, times[seen[-1]], rtol=0, atol=1e-14)
            row += 1
        if commits:
            ends += 1
            now = plan.reached[ends]
    begun = int(len(times) > 0 and times[0] == begin)
    assert (now, ends, plan.steps) == (end, steps, steps) and seen == list(range(begun, len(times)))
    assert (
        row
        == plan.rows[-1]
        == (steps if keeps else 0) + int((~plan.ends).sum()) + (0 if keeps else int(plan.ends.sum()))
    )


def test_equal_micro_steps_are_one_segment() -> None:
    plan = schedule((0.0, 1.0), 0.1, 10, np.array([0.35]), keeps=False)
    assert plan.repeats.tolist() == [3, 3, 3, 4, 10, 10, 10, 10, 10, 10, 11]
    assert set(plan.codes[plan.codes != -1]) == {0}
    assert schedule((0.0, 1.0), 0.25, 4, None, keeps=True).repeats.tolist() == [1, 2, 3, 4]


@pytest.mark.filterwarnings("ignore:status -1")
@pytest.mark.parametrize("t_eval", [None, [0.5e-11, 3.0]])
def test_a_run_that_is_cut_off_needs_no_more_memory_than_its_steps(t_eval: list[float] | None) -> None:
    field = lh.GeneratorField(lh.defining(lh.so(2)), [1])
    options: dict[str, Any] = {"step": "euler", "dt": 1e-12, "max_steps": 100, "t_eval": t_eval}
    plain, made = (lh.integrate(field, (0, 3), [1.0, 0.0], engine=e, **options) for e in ("numpy", "llvm"))
    assert made.status == plain.status == -1 and made.n_steps == plain.n_steps
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=1e-15)
