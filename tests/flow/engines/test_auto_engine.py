"""engine="auto": Python written from the trace against numpy, when which code is taken, and what stays with numpy."""

import pickle
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.engines import auto_engine, llvm_engine
from liehom.flow.engines.auto_engine import FEW, PYTHON_STEPS, AutoEngine
from liehom.flow.engines.llvm_engine import CodeStore
from liehom.flow.run.run import Run
from liehom.flow.steps.step import OneExponential
from liehom.flow.tracing.machine import Kernel
from tests.flow.engines.test_compiled import BODY, SPACES, START, STEPS, a_field, assert_same, sphere
from tests.flow.propagation import spaces

RHO = lh.adjoint(lh.so(3))
TURNING = lh.GeneratorField(RHO, lambda m, t: np.stack([np.cos(3 * t), m[..., 0], 1.0 + 0 * m[..., 1]], axis=-1))
WITH_ARGS = lh.GeneratorField(RHO, lambda m, t, args: -m / args["inertia"])


@pytest.fixture(autouse=True, scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LIEHOM_CACHE_DIR", str(tmp_path_factory.mktemp("code")))
        yield


def python() -> AutoEngine:
    """An engine that writes Python from the first step on, and no machine code."""
    engine = AutoEngine()
    engine.made["numpy"] = 10**6
    engine.refused.add(Kernel)
    return engine


def both(field: Any, span: Any, y0: Any, *, kind: str = "python", **options: Any) -> tuple[Any, Any]:
    plain = lh.integrate(field, span, y0, engine="numpy", **options)
    made = lh.integrate(field, span, y0, engine=python(), **options)
    assert plain.report.engine == "numpy" and made.report.engine == kind
    for entry in ("order", "failed_steps", "near_steps", "looks", "cuts", "step"):
        assert getattr(made.report, entry) == getattr(plain.report, entry)
    assert np.array_equal(made.n_steps, plain.n_steps)
    return plain, made


# of more than 28,000 operations, which are recorded as loops over entries, and those have no Python code
LONG = [("RK4 to 5", "CP^2")]


@pytest.mark.filterwarnings("ignore::liehom.OrderWarning")
@pytest.mark.parametrize("name", SPACES)
@pytest.mark.parametrize("step", ["Euler", "Taylor 5", "RK4 to 5"])
def test_python_is_numpy_on_the_spaces(name: str, step: str) -> None:
    space = spaces.make(name)
    span, options = (0.0, 0.4), {"step": STEPS[step], "dt": 0.05}
    kind = "numpy" if (step, name) in LONG else "python"
    assert_same(*both(a_field(name, space), span, np.asarray(space.starts)[:2], kind=kind, **options))


OPTIONS: list[dict[str, Any]] = [
    {"dt": 0.1, "t_eval": [0.0, 0.25, 0.3, 2.0]},
    {"dt": 0.3},
    {},
    {"t_eval": [0.1, 0.11, 1.7]},
    {"rtol": 1e-9, "atol": 1e-10, "dense_output": True},
    {"step": "rk45"},
    {"step": "rk45", "t_eval": [0.0, 0.5, 2.0]},
    {"step": lh.Corrected(lh.Euler(), 3), "t_eval": [0.5, 2.0]},
    {"step": lh.Corrected(lh.Heun(), 3), "dt": 0.1},
    {"step": lh.RKMK("gauss2"), "dt": 0.1},
    {"step": lh.methods.StiffRKMK("radau3"), "rtol": 1e-5},
    {"step": "rodas4"},
]


@pytest.mark.parametrize("options", OPTIONS, ids=str)
@pytest.mark.parametrize("end", [2.0, -2.0])
def test_python_is_numpy_with_every_kind_of_option(options: dict[str, Any], end: float) -> None:
    options = {**options, "t_eval": np.sign(end) * np.array(options["t_eval"])} if "t_eval" in options else options
    plain, made = both(TURNING, (0, end), sphere(2, 1), **options)
    assert np.abs(made.y - plain.y)[np.isfinite(plain.y)].max() < 1e-11 and made.t.shape == plain.t.shape
    np.testing.assert_allclose(made.t, plain.t, rtol=0, atol=1e-11)
    # of the trajectory with the most of them; numpy iterates until the equations of all trajectories are solved
    assert plain.nfev >= made.nfev > (0.8 if "StiffRKMK" in repr(options) else 0.9) * plain.nfev
    if plain.sol is not None:
        assert np.abs(made.sol(1.3 * np.sign(end)) - plain.sol(1.3 * np.sign(end))).max() < 1e-11


def test_numbers_in_args_differ_from_call_to_call_and_trajectory() -> None:
    propagator = lh.Propagator(WITH_ARGS, engine=python())
    inertia = 1.0 + np.arange(6.0).reshape(2, 3)
    for args in ({"inertia": inertia[0]}, {"inertia": inertia[1]}, {"inertia": lh.PerTrajectory(inertia)}):
        made = propagator((0, 5), sphere(2), args=args)
        plain = lh.integrate(WITH_ARGS, (0, 5), sphere(2), args=args, engine="numpy")
        assert made.report.engine == "python" and np.abs(made.y - plain.y)[np.isfinite(plain.y)].max() < 1e-13


def test_a_branch_that_is_not_taken_may_divide_by_zero() -> None:
    def psi(m: Any, t: Any) -> Any:
        return np.where((t > 10)[..., None], m / (t - t)[..., None], m * [1.0, 2.0, 3.0])

    plain, made = both(lh.GeneratorField(RHO, psi), (0, 1), START, step="rk4", dt=0.1)
    assert_same(plain, made)


def test_a_psi_that_ends_has_the_same_message() -> None:
    field = lh.GeneratorField(RHO, lambda m, t: m * [1.0, 2.0, 3.0] / np.sqrt(0.55 - t)[..., None])
    for options in ({"dt": 0.1}, {}):
        with pytest.warns(RuntimeWarning, match="status -1"):
            plain = lh.integrate(field, (0, 1), START, step="rk4" if options else None, engine="numpy", **options)
        with pytest.warns(RuntimeWarning, match="status -1"):
            made = lh.integrate(field, (0, 1), START, step="rk4" if options else None, engine=python(), **options)
        assert made.message == plain.message and made.report.engine == "python, numpy"
        np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=1e-12)


def test_long_runs_go_to_machine_code_after_a_step() -> None:
    step, times = lh.RKMK("rk4"), [300.0]
    wanted = lh.integrate(BODY, (0, 300), START, step=step, dt=0.1, t_eval=times, engine="numpy").y
    short = lh.integrate(BODY, (0, 3), START, step=step, dt=0.1)
    assert short.report.engine == "numpy"  # not worth a trace
    propagator = lh.Propagator(BODY, step)
    assert propagator.engine.name == "auto"
    for name in ("numpy, llvm", "llvm", "llvm"):
        sol = propagator((0, 300), START, dt=0.1, t_eval=times)
        assert sol.report.engine == name and np.abs(sol.y - wanted).max() < 1e-11


@pytest.mark.parametrize(("count", "end", "name"), [
    (1, 20.0, "numpy"), (1, 200.0, "numpy, python"), (1, 10000.0, "numpy, python, llvm"), (10, 20.0, "numpy"),
    (10, 200.0, "numpy, llvm"), (3000, 20.0, "numpy, llvm"),
])  # fmt: skip
def test_steps_of_adaptive_sizes_are_foreseen_after_a_few(
    count: int, end: float, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Numpy makes some 8 steps of a run that is worth code, and not as many as the code costs."""
    steps, advance = [0], Run.advance

    def counted(run: Any, now: Any) -> None:
        steps[0] += 1
        advance(run, now)

    monkeypatch.setattr(Run, "advance", counted)
    propagator = lh.Propagator(BODY)
    y0 = START if count == 1 else sphere(count)
    sol = propagator((0, end), y0, t_eval=[end])
    assert sol.report.engine == name and (steps[0] in (8, 9) or name == "numpy")
    if name == "numpy, llvm":
        before = steps[0]
        assert propagator((0, end), y0, t_eval=[end]).report.engine == "llvm" and steps[0] == before


def test_a_step_without_python_code_climbs_to_machine_code(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(llvm_engine, "UNROLLED_OPERATIONS", 1)
    sol = lh.integrate(BODY, (0, 30), START, step="rk4", dt=0.1, t_eval=[30.0])
    wanted = lh.integrate(BODY, (0, 30), START, step="rk4", dt=0.1, t_eval=[30.0], engine="numpy").y
    assert sol.report.engine == "numpy, llvm" and np.abs(sol.y - wanted).max() < 1e-12


def test_short_calls_climb_too() -> None:
    propagator, seen = lh.Propagator(BODY, "rk4"), []
    for k in range(40):
        seen.append(propagator((k, k + 1), START, dt=0.1).report.engine)
    assert seen[0] == "numpy" and seen[5] == "python" and seen[-1] == "llvm"


def test_without_llvmlite_python_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(auto_engine, "find_spec", lambda name: None)
    one = lh.integrate(BODY, (0, 300), START, step="rk4", dt=0.1)
    assert one.n_steps > PYTHON_STEPS[0] and one.report.engine == "numpy, python"
    many = lh.integrate(BODY, (0, 20), sphere(FEW + 1), step="rk4", dt=0.1)
    assert many.report.engine == "numpy"


def test_many_trajectories_go_to_machine_code_at_once() -> None:
    sol = lh.integrate(BODY, (0, 20), sphere(FEW + 1), step="rk4", dt=0.1)
    assert sol.report.engine == "numpy, llvm"
    plain = lh.integrate(BODY, (0, 20), sphere(FEW + 1), step="rk4", dt=0.1, engine="numpy")
    assert np.abs(sol.y - plain.y).max() < 1e-12


@pytest.mark.parametrize(("step", "name"), [("rk4", "numpy"), (lh.RKMK("gauss2"), "numpy, llvm")], ids=repr)
def test_steps_that_iterate_count_by_their_calls_of_psi(step: Any, name: str) -> None:
    assert lh.integrate(BODY, (0, 6), sphere(FEW + 1), step=step, dt=0.1).report.engine == name


class Halves(OneExponential):
    """A step that a user has written."""

    order = 1

    def generator(self, action: Any, psi: Any, m: Any, t: Any, h: Any) -> Any:
        return h * psi(m, t)


def test_what_is_no_function_of_point_and_time_stays_with_numpy() -> None:
    count, drawn = [0], random.Random(0)

    def branches(m: Any, t: Any) -> Any:
        return m * [1.0, 2.0, 3.0] if float(np.max(t)) < 3 else m * [3.0, 2.0, 1.0]

    def counts(m: Any) -> Any:
        count[0] += 1
        return m * [1.0, 2.0, 3.0] + 0.01 * count[0]

    def draws(m: Any) -> Any:
        return m * drawn.random()

    def draws_from_numpy(m: Any) -> Any:
        return m * np.random.normal()

    for psi in (branches, counts, draws, draws_from_numpy):
        sol = lh.integrate(lh.GeneratorField(RHO, psi), (0, 10), START, step="rk4", dt=0.1)
        assert sol.success and sol.report.engine == "numpy", psi
    assert count[0] > 400


@pytest.mark.parametrize(
    "options",
    [
        {"step": Halves()},
        {"step": lh.Corrected(Halves(), 2)},
        {"events": lambda t, y: y[..., 0]},
        {"checkpoint": "run"},
    ],
    ids=["a step", "a base step", "events", "a checkpoint"],
)
def test_steps_and_events_of_users_and_checkpoints_stay_with_numpy(options: Any, tmp_path: Path) -> None:
    if "checkpoint" in options:
        options = {"checkpoint": tmp_path / "run.npz"}
    options = {"step": "rk4", "dt": 0.1, **options}
    made = lh.integrate(BODY, (0, 10), START, **options)
    assert made.report.engine == "numpy"
    assert np.array_equal(made.y, lh.integrate(BODY, (0, 10), START, engine="numpy", **options).y)


class OwnError(Exception):
    """None of those of Python."""


def test_what_psi_raises_on_tracers_leaves_the_run_to_numpy() -> None:
    def psi(m: Any) -> Any:
        if type(m).__name__ == "Traced":
            raise OwnError
        return BODY.psi(m)

    sol = lh.integrate(lh.GeneratorField(BODY.representation, psi), (0, 10), START, dt=0.1, step="rk4")
    assert sol.report.engine == "numpy" and sol.success


def test_a_fault_of_the_library_is_not_taken_for_one_of_psi(monkeypatch: pytest.MonkeyPatch) -> None:
    def faulty(*_: Any) -> None:
        raise AttributeError("a name that is not there")

    monkeypatch.setattr(CodeStore, "kernel", faulty)
    with pytest.raises(AttributeError, match="not there"):
        lh.integrate(BODY, (0, 10), START, dt=0.1, step="rk4")


def test_extended_precision_and_noise_stay_with_numpy() -> None:
    wide = lh.integrate(BODY, (0, 10), START.astype(np.longdouble), step="rk4", dt=0.1)
    assert wide.report.engine == "numpy" and wide.y.dtype == np.longdouble
    warm = lh.LandauLifshitz(damping=0.1, temperature=0.5)
    ends = [warm.integrate((0, 5), START, dt=0.1, seed=3, **how).y for how in ({}, {"engine": "numpy"})]
    assert np.array_equal(*ends)


def test_a_changed_psi_is_noticed() -> None:
    speed = np.ones(1)
    propagator = lh.Propagator(lh.GeneratorField(RHO, lambda m: m * [1.0, 2.0, 3.0] * speed), "rk4", engine=python())
    for value in (1.0, 2.0, 3.0):
        speed[0] = value
        wanted = lh.integrate(propagator.field, (0, 1), START, step="rk4", dt=0.1, engine="numpy").y
        np.testing.assert_allclose(propagator((0, 1), START, dt=0.1).y, wanted, rtol=0, atol=1e-14)


def test_errors_of_psi_are_those_of_numpy() -> None:
    def psi(m: Any, t: Any) -> Any:
        if np.max(np.asarray(t, dtype=float)) > 5:
            raise KeyError("a field that is not there")
        return m * [1.0, 2.0, 3.0]

    with pytest.raises(KeyError, match="a field that is not there"):
        lh.integrate(lh.GeneratorField(RHO, psi), (0, 10), START, step="rk4", dt=0.1)


def test_a_copy_from_another_process_begins_anew() -> None:
    engine = python()
    lh.integrate(BODY, (0, 1), START, dt=0.1, engine=engine)
    copy = pickle.loads(pickle.dumps(engine))
    assert type(copy) is AutoEngine and copy.made == {"numpy": 0, "python": 0}
    assert_same(*(lh.integrate(BODY, (0, 1), START, dt=0.1, engine=e) for e in (copy, "numpy")))
