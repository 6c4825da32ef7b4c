"""Step sizes as functions of the error: at the tolerance, at their bounds, for NaN, and which steps are unsolvable."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import ConvergenceError
from liehom.flow.run import control
from liehom.flow.run.control import allowed_error, is_large_enough, judged, largest_size, length, next_size, unsolvable
from liehom.flow.steps.step import SERIES_FRACTION, LocalStep, size_from_defects

EPS = np.finfo(np.float64).eps


def test_the_allowed_error_is_a_root_mean_square_and_never_below_round_off() -> None:
    m = np.array([[3.0, 4.0], [0.0, 0.0]])
    assert np.allclose(allowed_error(1e-3, 0.0, m), [5e-3, 0.0])
    assert np.allclose(allowed_error(0.0, 1e-3, m), [np.sqrt(2) * 1e-3 + 50 * EPS, np.sqrt(2) * 1e-3], rtol=1e-12)
    assert allowed_error(1e-300, 0.0, m)[0] == pytest.approx(50 * EPS)
    single = allowed_error(1e-300, 0.0, m.astype(np.float32))
    assert single[0] == pytest.approx(50 * np.finfo(np.float32).eps)


def random_clocks(degree: int, count: int) -> tuple[list[tuple[int, Any]], Any, Any]:
    """Clocks and sizes, some negative, and the rates at 401 points of the steps."""
    rng = np.random.default_rng(degree)
    scale = 10 ** rng.uniform(-1.5, 1, size=count)
    clock = [(k, rng.normal(size=count) * scale) for k in range(2, degree + 1)]
    h = rng.choice([-1, 1], count) * 10 ** rng.uniform(-0.3, 0.3, count)
    s = np.linspace(0, 1, 401)[:, None] * h
    return clock, h, sum((k * c * s ** (k - 1) for k, c in clock), np.ones_like(s))


@pytest.mark.parametrize("degree", range(2, 9))
def test_an_admissible_clock_keeps_its_rate_over_the_whole_step(degree: int) -> None:
    clock, h, rates = random_clocks(degree, 3000)
    found = control.is_admissible(clock, h)
    assert rates[:, found].min() > control.MIN_RATE
    assert rates[:, found].max() < control.MAX_RATE
    within = ((rates > control.MIN_RATE) & (rates < control.MAX_RATE)).all(axis=0)
    assert 1000 < found.sum() > 0.99 * within.sum()


def test_a_clock_that_runs_backwards_between_samples_is_not_admissible() -> None:
    """tau' = 1 + h - 2.1 h^2 is -0.1 at h = 1, and its mean over each quarter of [0, 1] is above 1/4."""
    tau = np.polynomial.Polynomial([0, 1, 0.5, -0.7])
    assert (4 * np.diff(tau(np.arange(5) / 4)) > 0.25).all()
    m = np.array([1.0, 0.0])
    local = LocalStep(lh.Action(lh.defining(lh.so(2))), m, lambda h: (h,), clock=((2, 0.5), (3, -0.7)))
    assert [bool(control.clock_at(local, np.array(h))[0]) for h in (0.0, 0.5, 0.85, 1.0, -1.0)] == [
        True, True, True, False, False,
    ]  # fmt: skip


def test_lengths_are_2_norms_in_float64() -> None:
    x = np.array([[3, 4], [5, 12], [0, 0]], dtype=np.float32)
    assert length(x).dtype == np.float64
    assert length(x).tolist() == [5, 13, 0]
    assert float(length([3.0, -4.0])) == 5


@pytest.mark.parametrize("order", [1, 2, 5])
def test_the_next_size_meets_the_tolerance_up_to_safety(order: int) -> None:
    """The error is C h^order: at the next size it is SAFETY^order times the tolerance."""
    h = np.array(0.25)
    for ratio in (0.9, 1.0, 1.1, 2.0):
        size = float(next_size(h, np.array(ratio), order))
        assert ratio * (size / 0.25) ** order == pytest.approx(control.SAFETY**order)


def test_sizes_grow_and_shrink_within_their_bounds() -> None:
    sizes = next_size(np.full(4, 2.0), np.array([0.0, 1e-30, 1e30, 1.0]), 3)
    assert sizes.tolist() == [10.0, 10.0, pytest.approx(0.4), pytest.approx(1.8)]
    assert (np.diff(next_size(np.ones(50), np.logspace(-6, 6, 50), 2)) <= 0).all()


def test_an_estimate_is_accepted_up_to_the_tolerance() -> None:
    allowed = np.full(4, 5.0)
    error = np.array([[3.0, 4.0], [3.0, 4.1], [np.nan, 0.0], [np.inf, 0.0]])
    accepted, size = judged(error, allowed, np.array([0.1, -0.1, 0.1, -0.1]), 2)
    assert accepted.tolist() == [True, False, False, False]
    assert size.tolist() == pytest.approx([0.09, 0.09 / np.sqrt(length(error[1]) / 5), 0.02, 0.02])


def test_the_size_from_defects_is_the_largest_within_all_bounds() -> None:
    one = np.array(1.0)
    for k, defect, allowed in ((2, 3.0, 1e-4), (3, 0.5, 1e-6), (5, 7.0, 1e-9)):
        found = float(size_from_defects(((k, np.array(defect)),), np.array(allowed), np.array(0.0), one))
        assert found == pytest.approx(control.SAFETY * (allowed / defect) ** (1 / k))
    both = ((2, one), (3, np.array(100.0)))
    each = [float(size_from_defects((d,), np.array(1e-4), np.array(0.0), one)) for d in both]
    assert float(size_from_defects(both, np.array(1e-4), np.array(0.0), one)) == min(each)
    assert float(size_from_defects((), np.array(1e-4), one, np.array(0.125))) == 0.125


@pytest.mark.parametrize(("relative", "share"), [(1e-2, 1.0), (1e-4, 0.5), (1e-6, 5e-1 * 10**-0.5), (1e-15, 1 / 32)])
def test_a_term_of_the_error_has_a_share_of_the_tolerance_that_falls_with_it(relative: float, share: float) -> None:
    """5 r^(1/4) for a term of order 5, between 1/32 and 1."""
    zero, one = np.array(0.0), np.array(1.0)
    found = float(size_from_defects(((5, 7 * one),), 1e-6 * one, zero, one, relative=relative * one))
    assert found == pytest.approx(control.SAFETY * (share * 1e-6 / 7) ** (1 / 5))


def test_the_length_of_the_step_bounds_the_terms_above_the_second() -> None:
    """d_k h^k <= SERIES_FRACTION |X| h, except for k = 2, and not if |X| is disregarded."""
    defect, allowed, largest, slow = np.array(4.0), np.array(1e3), np.array(1e3), np.array(1e-6)
    found = float(size_from_defects(((3, defect),), allowed, slow, largest))
    assert 4 * found**3 == pytest.approx(control.SAFETY**2 * SERIES_FRACTION * 1e-6 * found)
    free = float(size_from_defects(((3, defect),), allowed, np.array(0.0), largest))
    assert free == pytest.approx(control.SAFETY * (1e3 / 4) ** (1 / 3))
    second = float(size_from_defects(((2, defect),), allowed, slow, largest))
    assert second == pytest.approx(control.SAFETY * (1e3 / 4) ** 0.5)


def test_defects_that_vanish_or_are_not_numbers() -> None:
    zero, nan = np.array([0.0, np.nan, 1.0]), np.array([1.0, 1.0, 1.0])
    sizes = size_from_defects(((2, zero),), np.full(3, 1e-4), nan, np.full(3, 0.5))
    assert sizes[0] == 0.5 and np.isnan(sizes[1]) and sizes[2] == pytest.approx(0.009)


def test_bounds_of_a_size() -> None:
    assert largest_size(0.3, np.array([0.1, 5.0])).tolist() == [0.2, 0.3]
    assert is_large_enough(np.array([1e-3, 1e-3, np.nan]), np.array([1e-3, 2e-3, 0.0]), 1.0).tolist() == [
        True,
        False,
        False,
    ]
    assert bool(is_large_enough(np.array(1e-5), 1e-3, 1e-6))  # the end is nearer than the smallest size


ACTION = lh.Action(lh.defining(lh.so(2)))


def solvable_below(limits: Any, calls: list[Any]) -> LocalStep:
    def point(h: Any) -> Any:
        calls.append(h)
        if np.any(h[..., 0] > limits):
            raise ConvergenceError("too large")
        return h

    return LocalStep(ACTION, np.zeros(1), point=point)


@pytest.mark.parametrize("shape", [(8,), (2, 4)])
@pytest.mark.parametrize("bad", [[0], [7], [3, 4], [0, 2, 5], list(range(8))])
def test_the_trajectories_that_cannot_be_solved_are_found(bad: list[int], shape: tuple[int, ...]) -> None:
    limits = np.full(8, 2.0)
    limits[bad] = 0.5
    calls: list[Any] = []
    h, where = np.ones(shape), np.ones(shape, dtype=bool)
    found = unsolvable(solvable_below(limits.reshape(shape), calls), h, where)
    assert np.flatnonzero(found).tolist() == bad and found.shape == shape
    assert all(call.shape == (*shape, 1) for call in calls)


def test_only_the_trajectories_asked_for_are_tried() -> None:
    limits, calls = np.array([0.5, 0.5, 2.0, 2.0]), []
    found = unsolvable(solvable_below(limits, calls), np.ones(4), np.array([False, True, True, True]))
    assert found.tolist() == [False, True, False, False]
    assert all(call[0, 0] == 0 for call in calls)


def test_trajectories_that_fail_together_only_are_all_named() -> None:
    def point(h: Any) -> Any:
        if np.count_nonzero(h) > 1:
            raise np.linalg.LinAlgError("singular")
        return h

    where = np.array([True, True, False])
    assert unsolvable(LocalStep(ACTION, np.zeros(1), point=point), np.ones(3), where).tolist() == where.tolist()


def test_the_number_of_trials_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    """After the last trial the groups that are left are named as a whole."""
    monkeypatch.setattr(control, "MAX_TRIALS", 3)
    limits, calls = np.full(16, 0.5), []
    limits[0] = 2.0
    found = unsolvable(solvable_below(limits, calls), np.ones(16), np.ones(16, dtype=bool))
    assert found.all() and len(calls) <= 8


def test_trials_that_succeed_count_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 64 trajectories one fails: halves are tried down to 8, then the 8 that hold it are named."""
    monkeypatch.setattr(control, "MAX_TRIALS", 4)
    limits = np.full(64, 2.0)
    limits[0] = 0.5
    found = unsolvable(solvable_below(limits, []), np.ones(64), np.ones(64, dtype=bool))
    assert np.flatnonzero(found).tolist() == list(range(8))
