"""Adaptive steps look at psi before they are taken: pulses, ramps, switches and walls, in every engine."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import liehom as lh
from liehom.base.errors import InputError
from liehom.flow.run.check import LOOKS, MAX_WAY, OFFSET, widest_gap

START = np.array([0.36, 0.48, 0.8])
RHO = lh.adjoint(lh.so(3))
INERTIA = np.array([1.0, 0.5, 0.25])
ENGINES = ["numpy", "llvm", "jax"]


def along(amplitude: Callable[[Any], Any], background: float = 0.0) -> lh.GeneratorField:
    """psi(m, t) = amplitude(t) e_x, plus the free body."""

    def psi(m: Any, t: Any) -> Any:
        a = amplitude(t)
        return np.stack([a + 0 * m[..., 0], 0 * m[..., 0], 0 * m[..., 0]], axis=-1) - background * m * INERTIA

    return lh.GeneratorField(RHO, psi)


def spot(m: Any) -> Any:
    """A turn about one axis, through a spot of another one that is met in each turn, of width |m| / 17."""
    near = np.exp(-((m - [-0.6, 0.0, 0.8]) ** 2).sum(axis=-1) / 0.06**2)
    return np.stack([20 * near, 0 * near, 1 + 0 * near], axis=-1)


def wall(m: Any) -> Any:
    speed = 1 + np.tanh((m[..., 1] - 0.3) / 0.01)
    return np.stack([0 * speed, 0 * speed, speed], axis=-1)


FEATURES: dict[str, lh.GeneratorField] = {
    "NMR pulse": along(lambda t: np.pi / 2 * np.exp(-(((t - 5) / 0.3) ** 2) / 2) / (0.3 * np.sqrt(2 * np.pi)), 1),
    "sech": along(lambda t: 20 / np.cosh(20 * (t - 5)), 1),
    "Gaussian of width span/100": along(lambda t: 10 * np.exp(-(((t - 5) / 0.1) ** 2) / 2), 1),
    "Gaussian at rest": along(lambda t: 10 * np.exp(-(((t - 5.2) / 0.05) ** 2) / 2)),
    "ramp sin^8": along(lambda t: np.sin(np.pi * t / 10) ** 8),
    "t^8": along(lambda t: (t / 10) ** 8),
    "logistic": along(lambda t: 1 / (1 + np.exp(-100 * (t - 5.3)))),
    "wall": lh.GeneratorField(RHO, wall),
    "spot": lh.GeneratorField(RHO, spot),
    "sin^6 from its top": along(lambda t: 2 * np.sin(np.pi * (t + 5) / 10) ** 6),
}
SMOOTH = {
    "body": lh.GeneratorField(RHO, lambda m: -m * INERTIA),
    "cubic": lh.GeneratorField(RHO, lambda m: -(m**3)),
    "turning field": along(lambda t: np.cos(t / 2), 1),
}
SPAN = {"sin^6 from its top": (0.0, 5.0)}


@cache
def reference(name: str) -> Any:
    field, span = FEATURES[name], SPAN.get(name, (0.0, 10.0))
    with np.errstate(all="ignore"):
        found = solve_ivp(
            lambda t, y: field.vector(y, t), span, START, method="DOP853", rtol=1e-11, atol=1e-12, max_step=0.04
        )
    return found.y[:, -1]


def error(name: str, **options: Any) -> tuple[float, lh.Solution]:
    field, span = FEATURES[name], SPAN.get(name, (0.0, 10.0))
    solution = lh.integrate(field, span, START, **options)
    return float(np.linalg.norm(solution.y[:, -1] - reference(name))), solution


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", FEATURES)
def test_the_default_step_sees_features(name: str, engine: str) -> None:
    if engine != "numpy":
        pytest.importorskip("llvmlite" if engine == "llvm" else "jax")
    for rtol in (1e-4, 1e-6) if engine != "jax" else (1e-6,):
        found, solution = error(name, rtol=rtol, atol=1e-3 * rtol, engine=engine)
        assert solution.success and found < 100 * rtol
        assert solution.report.looks >= solution.n_steps


@pytest.mark.filterwarnings("ignore:status -1")
def test_without_looks_they_are_missed_and_the_report_says_so() -> None:
    missed = set()
    for name in FEATURES:
        found, solution = error(name, looks=0)
        assert solution.report.check == "not checked (looks=0)" and solution.report.looks == 0
        if not solution.success or found > 1e-4:
            missed.add(name)
    assert missed == set(FEATURES) - {"NMR pulse", "sech", "wall", "sin^6 from its top"}


@pytest.mark.parametrize(
    "step", ["rk45", "dop853", "radau5", "rodas4", lh.LieTaylor(6), lh.Corrected("euler", 4)], ids=str
)
def test_named_steps_see_features(step: Any) -> None:
    for name in ("Gaussian of width span/100", "Gaussian at rest", "ramp sin^8", "logistic", "wall", "spot"):
        found, solution = error(name, step=step)
        assert solution.success and found < 1e-4, name


@pytest.mark.parametrize("engine", ENGINES)
def test_an_exponential_that_turns_a_point_many_times_looks_on_the_way(engine: str) -> None:
    """Between two looks at psi(m) a point moves by 0.22 |m| at most; 128 looks across the span are enough."""
    if engine != "numpy":
        pytest.importorskip("llvmlite" if engine == "llvm" else "jax")
    found, solution = error("spot", step=lh.LieTaylor(4), engine=engine)
    assert solution.success and found < 1e-4
    still = lh.GeneratorField(RHO, [0, 0, 1])
    for span in (0.3, 3.0, 1e6):  # the start moves by 0.6 |m| in a unit of time
        solution = lh.integrate(still, (0, span), START, step=lh.LieTaylor(4), engine=engine)
        assert solution.n_steps == 1
        assert solution.report.looks == min(int(np.ceil(0.6 * span / MAX_WAY)), LOOKS)


def test_a_pair_asks_psi_as_often_as_a_series() -> None:
    still = lh.GeneratorField(RHO, [0, 0, 1])
    for step in ("rk45", "dop853", "radau5", "rodas4"):
        named = lh.methods.step_named(step)
        local = named.at(lh.Action(RHO), lh.steps.Generator(still, 2), START, np.zeros(1))
        times = lh.integrate(still, (0, 30), START, step=step).t
        assert np.diff(times).max() == pytest.approx(MAX_WAY / local.widest_gap / 0.6)
        times = lh.integrate(along(lambda t: 0.0 * t), (0, 30), START, step=step).t
        longest = 30 if step == "radau5" else 30 / (LOOKS + OFFSET) / local.widest_gap  # its polynomial is looked at
        assert np.diff(times).max() == pytest.approx(longest)


@pytest.mark.parametrize(
    ("name", "engine"),
    [*[(name, "llvm") for name in ("radau3", "radau5", "radau9", "gauss2")], ("radau5", "numpy"), ("radau5", "jax")],
)
def test_a_pulse_within_a_long_step_of_collocation_is_seen(name: str, engine: str) -> None:
    """Of width span/250; without it, or without looks, two steps lead to the end."""
    if engine != "numpy":
        pytest.importorskip("llvmlite" if engine == "llvm" else "jax")
    step, options = lh.methods.StiffRKMK(name), {"engine": engine, "rtol": 1e-5, "atol": 1e-8}
    for middle in np.linspace(2.0, 8.0, 11 if engine == "llvm" else 2):

        def amplitude(t: Any, middle: float = middle) -> Any:
            return 10 * np.exp(-(((t - middle) / 0.04) ** 2) / 2)

        field = along(amplitude)
        turned = lh.Action(RHO).act(np.array([0.4 * np.sqrt(2 * np.pi), 0, 0]), START)
        sol = lh.integrate(field, (0, 10), START, step=step, **options)
        assert sol.success and np.linalg.norm(sol.y[:, -1] - turned) < 100e-5
        assert np.diff(sol.t).max() > 10 / 8
    blind = lh.integrate(field, (0, 10), START, step=step, looks=0, **options)
    assert blind.n_steps < 3 and np.linalg.norm(blind.y[:, -1] - turned) > 0.1


@pytest.mark.parametrize("engine", ["llvm", "jax"])
@pytest.mark.parametrize("step", [None, lh.LieTaylor(4), lh.Corrected("euler", 3), "rk45", "radau5"], ids=str)
def test_engines_take_the_same_steps(step: Any, engine: str) -> None:
    pytest.importorskip("llvmlite" if engine == "llvm" else "jax")
    field, starts = FEATURES["NMR pulse"], np.stack([START, START[::-1], [0.0, 0.6, -0.8]])
    runs = [lh.integrate(field, (0, 10), starts, step=step, engine=e, rtol=1e-5) for e in ("numpy", engine)]
    assert (runs[0].n_steps == runs[1].n_steps).all()
    assert (runs[0].report.looks, runs[0].report.cuts) == (runs[1].report.looks, runs[1].report.cuts)
    ends = [[y[:, n] for y, n in zip(run.y, run.n_steps, strict=True)] for run in runs]
    assert np.allclose(ends[0], ends[1], rtol=0, atol=1e-12)


@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("name", SMOOTH)
def test_smooth_fields_take_the_steps_that_they_took(name: str, rtol: float) -> None:
    runs = [lh.integrate(SMOOTH[name], (0, 10), START, rtol=rtol, atol=1e-3 * rtol, looks=looks) for looks in (0, None)]
    assert runs[1].n_steps == runs[0].n_steps and runs[1].report.cuts == 0
    assert (runs[1].y == runs[0].y).all()
    at_ends = runs[1].n_steps
    looks = at_ends + (LOOKS if SMOOTH[name].time_dependent else 0)
    assert at_ends <= runs[1].report.looks <= looks


def test_the_report_says_how_sizes_were_checked() -> None:
    field = SMOOTH["turning field"]
    text = str(lh.integrate(field, (0, 10), START).report)
    assert "psi looked at in each step and 128 times across the span; " in text and "0 sizes cut" in text
    assert str(lh.integrate(SMOOTH["body"], (0, 10), START, step="rk45").report).endswith("psi looked at in each step")
    assert "looked" not in str(lh.integrate(field, (0, 10), START, dt=0.1).report)
    with pytest.raises(InputError, match="looks is -1, expected an integer"):
        lh.integrate(field, (0, 10), START, looks=-1)
    for wrong in (True, 1.5, "many"):
        with pytest.raises(InputError, match="looks is"):
            lh.integrate(field, (0, 10), START, looks=wrong)  # type: ignore[arg-type]


@pytest.mark.parametrize("span", [(0.0, 10.0), (10.0, 0.0), (3.0, 3.5)])
@pytest.mark.parametrize("step", [None, "rk45", "radau5", lh.LieTaylor(4), lh.Corrected("euler", 3)], ids=str)
def test_psi_is_never_asked_beyond_the_end(span: tuple[float, float], step: Any) -> None:
    low, high = min(span), max(span)

    def amplitude(t: Any) -> Any:
        value = t.value if hasattr(t, "value") else t
        assert low <= np.min(value) and np.max(value) <= high
        return np.cos(t)

    assert lh.integrate(along(amplitude, 1), span, START, step=step).success


def test_looks_are_at_most_a_part_of_the_span_apart() -> None:
    asked: list[float] = []

    def amplitude(t: Any) -> Any:
        if not hasattr(t, "value"):
            asked.extend(np.ravel(t).tolist())
        return 0.0 * t

    for step in (None, "rk45", "dop853", "radau5", lh.LieTaylor(4), lh.Corrected("euler", 3)):
        asked.clear()
        assert lh.integrate(along(amplitude), (2, 5), START, step=step).success
        times = np.unique([2.0, *asked, 5.0])
        assert np.diff(times).max() <= 3 / LOOKS


@pytest.mark.parametrize("unit", [1e-9, 1e9])
def test_units_of_time_do_not_matter(unit: float) -> None:
    field = along(lambda t: 10 / unit * np.exp(-(((t / unit - 5.2) / 0.05) ** 2) / 2))
    end = lh.integrate(field, (0, 10 * unit), START).y[:, -1]
    assert np.linalg.norm(end - reference("Gaussian at rest")) < 1e-4


def test_round_off_of_large_times_is_no_feature() -> None:
    field = along(lambda t: np.cos(t / 2), 1)
    runs = [lh.integrate(field, (1e9, 1e9 + 10), START, rtol=rtol, atol=0) for rtol in (1e-6, 1e-9, 1e-12)]
    assert all(run.success and run.n_steps < 120 and run.report.cuts == 0 for run in runs)


@pytest.mark.parametrize("power", [0.1, 0.5, 1.5])
def test_a_derivative_that_is_not_finite_at_the_start_is_stepped_over(power: float) -> None:
    """psi = sqrt(t) has no Taylor series at 0; the step is by its value there, and as short as the looks ask for."""
    field = along(lambda t: t**power)
    turned = 10 ** (power + 1) / (power + 1)
    for engine in ("numpy", "llvm"):
        solution = lh.integrate(field, (0, 10), [0.0, 1.0, 0.0], engine=engine)
        assert solution.success and solution.report.cuts > 0
        assert np.linalg.norm(solution.y[:, -1] - [0, np.cos(turned), np.sin(turned)]) < 1e-4


@pytest.mark.filterwarnings("ignore:status -1")
def test_psi_that_is_not_finite_ends_the_run_where_it_is() -> None:
    solution = lh.integrate(along(lambda t: 1 / (5 - t)), (0, 10), START)
    assert not solution.success and 4.9 < solution.t[-1] <= 5


def test_max_step_is_how_users_say_what_they_know() -> None:
    """A pulse of width span/5000 lies between two looks; `max_step` of its width shows it."""
    field = along(lambda t: 400 * np.exp(-(((t - 5.0123) / 0.002) ** 2) / 2))
    turned = 400 * 0.002 * np.sqrt(2 * np.pi)
    rotated = lh.Action(RHO).act(np.array([turned, 0, 0]), START)
    assert np.linalg.norm(lh.integrate(field, (0, 10), START).y[:, -1] - rotated) > 0.1
    assert np.linalg.norm(lh.integrate(field, (0, 10), START, max_step=0.005).y[:, -1] - rotated) < 1e-5
    assert np.linalg.norm(lh.integrate(field, (0, 10), START, looks=5000).y[:, -1] - rotated) < 1e-5


@pytest.mark.parametrize(
    ("nodes", "gap"),
    [([0, 0.5, 1], 0.5), ([0.5], 1.0), ([0, 0.3, 0.8, 8 / 9, 1, 1], 0.5), ([0], 1.0), ([0.25, 0.75], 0.5)],
)
def test_the_widest_gap_between_nodes(nodes: list[float], gap: float) -> None:
    assert widest_gap(nodes) == pytest.approx(gap)


def test_ensembles_are_checked_lane_by_lane() -> None:
    field, starts = FEATURES["NMR pulse"], np.stack([START, [0.0, 0.6, -0.8], [1.0, 0.0, 0.0]])
    together = lh.integrate(field, (0, 10), starts)
    for i, start in enumerate(starts):
        alone = lh.integrate(field, (0, 10), start)
        assert alone.n_steps == together.n_steps[i]
        assert np.allclose(alone.y[:, -1], together.y[i, :, alone.n_steps], rtol=0, atol=1e-13)
