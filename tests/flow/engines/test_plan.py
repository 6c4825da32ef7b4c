"""Calls of a propagator that differ in the points only."""

import pickle
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError
from liehom.flow.engines import llvm_engine, plan
from liehom.flow.engines.llvm_engine import LlvmEngine
from liehom.flow.steps import Conserving
from tests.benchmarks.integration_problems import grassmannian, projective_plane, symmetric4, underwater_body
from tests.flow.engines.test_compiled import BODY, START, sphere

pytest.importorskip("llvmlite")
SPAN = (0.0, 3.0)


class Watched(LlvmEngine):
    """The engine, which counts the calls that are made from the beginning."""

    def __init__(self) -> None:
        super().__init__()
        self.solved = 0

    def solve(self, problem: Any) -> Any:
        self.solved += 1
        return super().solve(problem)


def propagator(field: lh.GeneratorField = BODY, step: Any = None) -> tuple[lh.Propagator, Watched]:
    engine = Watched()
    return lh.Propagator(field, step, engine=engine), engine


@pytest.mark.parametrize("options", [{}, {"t_eval": [0.0, 0.55, 3.0]}, {"t_eval": [3.0]}], ids=str)
@pytest.mark.parametrize("count", [1, 2, 7, 100])
def test_a_second_call_is_that_of_numpy(count: int, options: dict[str, Any]) -> None:
    made, engine = propagator(step=lh.LieTaylor(4))
    starts = sphere(2 * count).reshape(2, count, 3)
    points = starts if count > 1 else starts[:, 0]
    for y0 in points:
        sol, plain = (
            made(SPAN, y0, dt=0.1, **options),
            lh.integrate(BODY, SPAN, y0, step=made.step, dt=0.1, engine="numpy", **options),
        )
        np.testing.assert_allclose(sol.y, plain.y, rtol=0, atol=1e-14)
        np.testing.assert_array_equal(sol.t, plain.t)
        np.testing.assert_array_equal(sol.n_steps, plain.n_steps)
        np.testing.assert_array_equal(sol.statuses, plain.statuses)
        assert (sol.nfev, sol.status, sol.message, sol.report) == (plain.nfev, 0, plain.message, plain.report)
    assert engine.solved == 1


def test_a_result_is_not_that_of_the_next_call() -> None:
    made, _ = propagator(step=lh.RKMK("rk4"))
    made(SPAN, START, dt=0.1)
    first, second = (made(SPAN, y0, dt=0.1) for y0 in (START, -START))
    kept = second.y.copy()
    first.y[:], first.t[:] = 7.0, 7.0
    np.testing.assert_array_equal(second.y, kept)
    assert made(SPAN, START, dt=0.1).t[-1] == 3.0


@pytest.mark.parametrize("bad", [[np.nan, 0.0, 1.0], [np.inf, 0.0, 1.0]])
@pytest.mark.parametrize("count", [1, 100])
def test_points_are_checked_in_every_call(bad: list[float], count: int) -> None:
    made, _ = propagator(step=lh.RKMK("rk4"))
    points = sphere(count) if count > 1 else START
    made(SPAN, points, dt=0.1)
    wrong = points.copy()
    wrong[-1 if count > 1 else slice(None)] = bad
    with pytest.raises(InputError, match="not finite"):
        made(SPAN, wrong, dt=0.1)


@pytest.mark.parametrize("count", [1, 100])
def test_points_that_the_group_fixes_are_found_in_every_call(count: int) -> None:
    made, engine = propagator(step=lh.RKMK("rk4"))
    points = sphere(count) if count > 1 else START
    made(SPAN, points, dt=0.1)
    fixed = points.copy()
    fixed[-1 if count > 1 else slice(None)] = 0.0
    sol = made(SPAN, fixed, dt=0.1)
    plain = lh.integrate(BODY, SPAN, fixed, step=made.step, dt=0.1, engine="numpy")
    np.testing.assert_allclose(sol.y, plain.y, rtol=0, atol=1e-14)
    assert sol.report == plain.report and engine.solved == 1  # numpy makes it


@pytest.mark.filterwarnings("ignore:status -1")
def test_a_trajectory_that_fails_is_made_from_the_beginning() -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: np.sqrt(m[..., :1] + 0.5) * [0.01, 0, 0] + [0, 0.5, 1.0])
    made, engine = propagator(field, lh.RKMK("rk4"))
    good, bad = np.array([0.0, 0.45, 0.9]), np.array([0.4, -0.8, 0.1])
    assert made(SPAN, good, dt=0.1).status == 0 and made(SPAN, good, dt=0.1).status == 0 and engine.solved == 1
    failed, plain = made(SPAN, bad, dt=0.1), lh.integrate(field, SPAN, bad, step=made.step, dt=0.1)
    assert engine.solved == 2 and failed.status == plain.status == -1 and failed.message == plain.message


@pytest.mark.filterwarnings("ignore:status -1")
@pytest.mark.parametrize("change", [{"t_eval": [1.0]}, {"max_steps": 3}, {"dt": None}, {"dense_output": True}], ids=str)
def test_a_call_of_another_form_is_made_from_the_beginning(change: dict[str, Any]) -> None:
    made, engine = propagator(step=lh.RKMK("rk4"))
    made(SPAN, START, dt=0.1)
    options: dict[str, Any] = {"dt": 0.1, **change}
    sol = made(SPAN, START, **options)
    assert engine.solved == 2
    np.testing.assert_allclose(sol.y, lh.integrate(BODY, SPAN, START, step=made.step, **options).y, atol=1e-14)


def test_points_on_smaller_orbits_are_looked_at_closely() -> None:
    field = lh.GeneratorField(lh.sym_conjugation(3), lambda m: np.stack([m[..., 1], m[..., 2], m[..., 4]], axis=-1))
    made, engine = propagator(field, lh.RKMK("rk4"))
    made(SPAN, np.array([1.0, 0.1, 0.2, 2.0, 0.3, 3.0]), dt=0.1)
    small = np.array([1.0, 0.0, 0.0, 1.0, 0.0, 2.0])
    assert made(SPAN, small, dt=0.1).report.orbit_dimension == 2 and engine.solved == 2
    made(SPAN, np.array([1.0, 0.1, 0.3, 2.0, 0.3, 4.0]), dt=0.1)
    assert engine.solved == 2


def test_only_spheres_are_checked_as_spheres() -> None:
    """An orbit of the motions of the plane has codimension 1, too, and translations are on circles."""
    field = lh.GeneratorField(lh.adjoint(lh.euclidean(2)), lambda m: m[..., [1, 2, 0]])
    made, engine = propagator(field, lh.RKMK("rk4"))
    assert made(SPAN, np.array([1.0, 0.5, 0.7]), dt=0.1).report.orbit_dimension == 2
    assert made(SPAN, np.array([0.0, 0.5, 0.7]), dt=0.1).report.orbit_dimension == 1 and engine.solved == 2


RHO4 = lh.sym_conjugation(4)
LINEAR4 = 0.2 * np.random.default_rng(83).normal(size=(RHO4.algebra.dimension, RHO4.size))


def planes(count: int) -> Any:
    """Projectors (count, 10) on random planes of R^4, points of orbits of dimension 4."""
    q = np.linalg.qr(np.random.default_rng(9).normal(size=(count, 4, 4)))[0]
    return lh.instances.SymmetricMatrices(4).to_vector(q[..., :2] @ q[..., :2].swapaxes(1, 2))


@pytest.mark.parametrize("unrolled", [28_000, 1])
def test_all_points_of_a_grassmannian_and_no_others_are_made_again(
    unrolled: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(llvm_engine, "UNROLLED_OPERATIONS", unrolled)
    starts = planes(3000)
    made, engine = propagator(lh.GeneratorField(RHO4, lambda m: m @ LINEAR4.T), lh.Taylor(4))
    for _ in range(2):
        made((0.0, 0.1), starts, dt=0.1)
    assert engine.solved == 1
    made((0.0, 0.1), starts[0], dt=0.1)
    off = np.random.default_rng(3).normal(size=(30, 10))
    for x in starts[:30] + 1e-8 * off:
        assert engine.again((0.0, 0.1), x, {"dt": 0.1}) is None


class Found(Exception):
    """A graph that was traced."""


@pytest.mark.parametrize(
    "make", [projective_plane, grassmannian, symmetric4, underwater_body], ids=lambda f: f.__name__
)
def test_orders_that_tolerances_ask_for_are_compiled_without_loops(
    make: Callable[[], Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    def stop(graph: Any, *_: Any) -> None:
        raise Found(graph)

    monkeypatch.setattr(llvm_engine, "with_guard", stop)
    problem = make()
    with pytest.raises(Found) as found:
        lh.integrate(problem.field, (0.0, 1.0), problem.starts(1)[0], rtol=1e-13, atol=1e-13, engine="llvm")
    assert found.value.args[0].point[0].tape.least_loop is None


@pytest.mark.parametrize("options", [{}, {"rtol": 1e-9}, {"rtol": 1e-4, "atol": 1e-7}], ids=str)
@pytest.mark.parametrize("step", [lh.RKMK("rk45"), lh.Taylor(8)], ids=repr)
@pytest.mark.parametrize("count", [1, 7, 100])
def test_a_second_call_with_adapted_steps_is_that_of_numpy(count: int, step: Any, options: dict[str, Any]) -> None:
    made, engine = propagator(step=step)
    times = np.array([0.0, 0.55, 3.0])
    starts = sphere(2 * count).reshape(2, count, 3)
    for y0 in starts if count > 1 else starts[:, 0]:
        sol = made(SPAN, y0, t_eval=times, **options)
        plain = lh.integrate(BODY, SPAN, y0, step=step, t_eval=times, **options, engine="numpy")
        np.testing.assert_allclose(sol.y, plain.y, rtol=0, atol=1e-9)
        np.testing.assert_array_equal(sol.n_steps, plain.n_steps)
        assert (sol.status, sol.message, sol.report) == (0, plain.message, plain.report)
    assert engine.solved == 1


def test_a_second_call_with_other_args_is_that_of_numpy() -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m / args["inertia"] + args["torque"])
    made, engine = propagator(field, lh.LieTaylor(4))
    for inertia, torque in (([1.0, 2.0, 3.0], 0.1), ([2.0, 2.5, 1.0], -0.3)):
        args = {"inertia": np.array(inertia), "torque": torque}
        sol, plain = (
            go(SPAN, START, dt=0.1, args=args) for go in (made, lh.Propagator(field, made.step, engine="numpy"))
        )
        np.testing.assert_allclose(sol.y, plain.y, rtol=0, atol=1e-14)
    assert engine.solved == 1
    made(SPAN, START, dt=0.1, args={"inertia": np.array(2.0), "torque": 0.1})
    assert engine.solved == 2


def test_a_second_call_with_args_of_each_trajectory_is_that_of_numpy() -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m * args["rate"][..., None])
    made, engine = propagator(field, lh.LieTaylor(4))
    points = sphere(5)
    for scale in (1.0, 2.0):
        args = {"rate": lh.PerTrajectory(scale * np.arange(1.0, 6.0))}
        sol, plain = (
            go(SPAN, points, dt=0.1, args=args) for go in (made, lh.Propagator(field, made.step, engine="numpy"))
        )
        np.testing.assert_allclose(sol.y, plain.y, rtol=0, atol=1e-13)
    assert engine.solved == 1


def test_sizes_of_each_trajectory_are_not_taken_for_one_size() -> None:
    made, _ = propagator(step=lh.RKMK("rk4"))
    points = sphere(2)
    made(SPAN, points, dt=np.array([0.1, 0.2]), t_eval=[3.0])
    assert made(SPAN, points, dt=0.2, t_eval=[3.0]).n_steps.tolist() == [15, 15]


@pytest.mark.parametrize(
    "args", ["3.0", np.complex128(2 + 3j), np.array(2 + 3j), lh.PerTrajectory(np.ones((1, 3)))], ids=repr
)
def test_a_second_call_checks_the_numbers_of_args(args: Any) -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m * args)
    made, starts = lh.Propagator(field, engine="llvm"), sphere(5)
    first = lh.PerTrajectory(np.ones((5, 3))) if isinstance(args, lh.PerTrajectory) else 2.0
    made((0.0, 1.0), starts, args=first, dt=0.1)
    with pytest.raises(lh.errors.LiehomError, match="args"):
        made((0.0, 1.0), starts, args=args, dt=0.1)


def test_a_propagator_that_has_compiled_can_be_pickled() -> None:
    made = lh.Propagator(lh.GeneratorField(lh.adjoint(lh.so(3)), ["-m0", "-m1/2", "-m2/4"]), engine="llvm")
    expected = made(SPAN, START, dt=0.1).y
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(made))(SPAN, START, dt=0.1).y, expected)


# -- one plan for all calls of a form ----------------------------------------------------------------------
RATES = np.array([1.0, 0.5, 0.25])


def energy(m: Any) -> Any:
    return (m * m * RATES).sum(axis=-1)


def kicked(m: Any, t: Any) -> Any:
    return -m * RATES + np.stack([np.sin(3 * t), 0 * t, 0 * t], axis=-1)


KICKED = lh.GeneratorField(lh.adjoint(lh.so(3)), kicked)
VARIANTS: dict[str, tuple[lh.GeneratorField, Any, dict[str, Any]]] = {
    "fixed": (BODY, lh.Taylor(8), {"dt": 0.1}),
    "fixed, forced": (KICKED, lh.RKMK("rk4"), {"dt": 0.07}),
    "fixed, t_eval": (KICKED, lh.Taylor(6), {"dt": 0.1, "t_eval": [0.05, 0.1, 0.77]}),
    "fixed, dense": (BODY, lh.Taylor(8), {"dt": 0.1, "t_eval": [0.77], "dense_output": True}),
    "fixed, default step": (BODY, None, {"dt": 0.2}),
    "adapted": (KICKED, lh.Taylor(8), {"rtol": 1e-9}),
    "adapted, default step": (BODY, None, {}),
    "adapted, dense": (BODY, lh.Taylor(8), {"rtol": 1e-4, "dense_output": True}),
    "adapted, limits": (KICKED, lh.Taylor(8), {"max_step": 0.2, "min_step": 1e-6, "first_step": 0.01, "looks": 20}),
    "adapted, t_eval": (BODY, lh.Taylor(8), {"t_eval": np.array([0.3, 0.7]), "atol": 1e-7}),
    "rk45": (BODY, lh.RKMK("rk45"), {"rtol": 1e-3}),
    "rodas4": (KICKED, "rodas4", {"rtol": 1e-3}),
    "Corrected": (BODY, lh.Corrected(lh.Euler(), 4), {"dt": 0.1}),
    "Corrected, adapted": (BODY, lh.Corrected(lh.Euler(), 4), {"rtol": 1e-5}),
    "Conserving": (BODY, Conserving(lh.LieTaylor(4), energy), {"dt": 0.1}),
    "midpoint": (BODY, "midpoint", {"dt": 0.1}),
}  # fmt: skip


def assert_same(sol: Any, fresh: Any) -> None:
    """Bit for bit, with all entries."""
    for name in ("y", "t", "n_steps", "statuses"):
        np.testing.assert_array_equal(sol[name], fresh[name])
    assert (sol.status, sol.message, sol.nfev, sol.report) == (0, fresh.message, fresh.nfev, fresh.report)
    assert (sol.t_events, sol.y_events, sol.njev, sol.nlu) == (None, None, 0, 0)
    assert (sol.sol is None) == (fresh.sol is None)
    if sol.sol is not None:
        places = np.linspace(float(np.min(sol.sol.t_min)), float(np.max(sol.sol.t_max)), 7)
        np.testing.assert_array_equal(sol.sol(places), fresh.sol(places))


@pytest.mark.parametrize("count", [1, 5])
@pytest.mark.parametrize("name", VARIANTS)
def test_calls_of_one_form_are_those_of_a_fresh_propagator(
    name: str, count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    field, step, options = VARIANTS[name]
    counts: list[int] = []
    trace, prepare = llvm_engine.traced_step, type(lh.Taylor(2)).prepare
    monkeypatch.setattr(llvm_engine, "traced_step", lambda *a, **o: counts.append(1) or trace(*a, **o))
    monkeypatch.setattr(type(lh.Taylor(2)), "prepare", lambda *a: counts.append(1) or prepare(*a))
    made, engine = propagator(field, step)
    made((0.0, 1.0), sphere(count)[0] if count == 1 else sphere(count), **options)
    traced = len(counts)
    for k, span in enumerate([(0.0, 1.0), (-0.25, 1.5), (0.0, 0.78)]):
        points = sphere(3 * count)[k * count : (k + 1) * count]
        y0 = points[0] if count == 1 else points
        more = {name: options[name] / (1 + k / 8) for name in ("dt", "rtol") if name in options}
        sol = made(span, y0, **{**options, **more})
        assert (engine.solved, len(counts)) == (1, traced)
        assert_same(sol, propagator(field, step)[0](span, y0, **{**options, **more}))
        counts[traced:] = []


@pytest.mark.parametrize("more", [{}, {"t_eval": [0.0, 0.55, 1.0]}, {"t_eval": [0.55], "dense_output": True}], ids=str)
def test_one_trajectory_with_rejected_steps_takes_the_short_way(
    more: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: Any) -> None:
        raise AssertionError

    options = {"rtol": 1e-9, "first_step": 0.9, **more}
    made, fresh = (propagator(KICKED, lh.Taylor(8))[0] for _ in range(2))
    made((0.0, 1.0), START, **options)
    monkeypatch.setattr(plan.Plan, "_in_pieces", refuse)
    assert_same(made((0.0, 1.0), START, **options), fresh((0.0, 1.0), START, **options))


@pytest.mark.parametrize("count", [1, 20])
def test_threads_may_share_a_propagator(count: int) -> None:
    made, _ = propagator(step=lh.Taylor(8))
    starts = sphere(8 * count).reshape(8, count, 3)[:, slice(None) if count > 1 else 0]
    made((0.0, 40.0), starts[0], dt=0.1)
    wanted = [made((0.0, 40.0), y0, dt=0.1).y for y0 in starts]
    with ThreadPoolExecutor(4) as pool:
        for _ in range(5):
            for y, expected in zip(pool.map(lambda y0: made((0.0, 40.0), y0, dt=0.1).y, starts), wanted, strict=True):
                np.testing.assert_array_equal(y, expected)


@pytest.mark.parametrize(
    "change",
    [
        lambda span, y0, dt: (list(span), y0, dt), lambda span, y0, dt: (np.array(span), y0, dt),
        lambda span, y0, dt: (span, y0.tolist(), dt), lambda span, y0, dt: (span, tuple(y0.tolist()), np.float64(dt)),
        lambda span, y0, dt: ((0, 1), y0, np.array(dt)), lambda span, y0, dt: (map(np.float64, span), y0, dt),
    ],
)  # fmt: skip
def test_lists_and_numbers_of_numpy_are_the_same_call(change: Callable[..., Any]) -> None:
    made, engine = propagator(step=lh.Taylor(8))
    wanted = made((0.0, 1.0), START, dt=0.125)
    span, y0, dt = change((0.0, 1.0), START, 0.125)
    np.testing.assert_array_equal(made(span, y0, dt=dt).y, wanted.y)
    assert engine.solved == 1


@pytest.mark.parametrize("options", [{"dt": 0.125}, {"rtol": 1e-9}])
@pytest.mark.parametrize(
    "view",
    [START[::-1], np.broadcast_to(np.float64(0.5), (3,)), np.arange(6.0)[::2], np.arange(6.0).reshape(3, 2)[:, 1]],
)
def test_points_may_be_views_of_other_arrays(view: Any, options: dict[str, Any]) -> None:
    made, engine = propagator(step=lh.Taylor(8))
    made((0.0, 1.0), START, **options)
    sol = made((0.0, 1.0), view, **options)
    assert engine.solved == 1
    assert_same(sol, propagator(step=lh.Taylor(8))[0]((0.0, 1.0), view.copy(), **options))


def test_points_of_integers_and_lists_of_times_are_the_same_call() -> None:
    made, engine = propagator(step=lh.Taylor(8))
    wanted = made((0.0, 1.0), [0.0, 1.0, 2.0], dt=0.125, t_eval=[0.5, 1])
    for times in ([0.5, 1], (0.5, 1.0), np.array([0.5, 1.0])):
        np.testing.assert_array_equal(made((0, 1), np.array([0, 1, 2]), dt=0.125, t_eval=times).y, wanted.y)
    assert engine.solved == 1


BAD: list[dict[str, Any]] = [
    {"dt": -0.1}, {"dt": np.nan}, {"dt": "x"}, {"dt": 1e-17}, {"dt": [0.1, 0.2]}, {"dt": np.ma.masked_array(0.1)},
    {"dt": 1j}, {"t_eval": [2.0]}, {"t_eval": [0.5, 0.25]}, {"t_eval": [np.nan]}, {"t_eval": 0.5},
    {"dt": None, "rtol": -1.0}, {"dt": None, "rtol": 0.0, "atol": 0.0}, {"max_step": 0.0}, {"max_steps": -1},
    {"min_step": 2.0, "max_step": 1.0}, {"looks": -1}, {"looks": True}, {"first_step": -1.0}, {"span": (0.0, np.inf)},
    {"span": (0.0,)}, {"span": 3.0}, {"span": "01"}, {"y0": [np.nan, 0.0, 1.0]}, {"y0": np.ones(2)}, {"y0": ["a"] * 3},
    {"y0": np.ones(3, dtype=np.float32)}, {"y0": np.ma.masked_array(np.ones(3))}, {"y0": 1j * np.ones(3)},
    {"y0": [1e300, 0.0, 0.0]}, {"steps": 3}, {"rtoll": 1e-3},
]  # fmt: skip


@pytest.mark.parametrize("bad", BAD, ids=str)
def test_bad_input_raises_in_every_call_what_it_raises_in_the_first(bad: dict[str, Any]) -> None:
    made, _ = propagator(step=lh.RKMK("rk45"))
    for options in ({"dt": 0.1}, {"dt": 0.1, "t_eval": [0.5]}, {}, {"t_eval": [0.5]}):
        made((0.0, 1.0), START, **options)
    given = {"dt": 0.1, **bad}
    span, y0 = given.pop("span", (0.0, 1.0)), given.pop("y0", START)
    errors = []
    for go in (made, propagator(step=lh.RKMK("rk45"))[0]):
        with pytest.raises((lh.errors.LiehomError, TypeError)) as caught:
            go(span, y0, **given)
        errors.append((type(caught.value), str(caught.value)))
    assert errors[0] == errors[1]


def test_a_number_is_not_taken_for_one_of_another_type_that_is_equal() -> None:
    made, _ = propagator(step=lh.Taylor(4))
    for _ in range(2):
        made((0.0, 1.0), START, looks=1)
    with pytest.raises(InputError, match="looks is True"):
        made((0.0, 1.0), START, looks=True)
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m * args)
    made, _ = propagator(field, lh.Taylor(4))
    for _ in range(2):
        made((0.0, 1.0), START, args=np.ones(3))
    with pytest.raises(InputError, match="masked"):
        made((0.0, 1.0), START, args=np.ma.masked_array(np.ones(3)))


def test_sizes_in_a_list_may_change_in_place_between_calls() -> None:
    made, engine = propagator(step=lh.Taylor(4))
    starts, sizes = sphere(2), [0.1, 0.3]
    for last in (0.3, 0.05, 0.2):
        sizes[1] = last
        assert made((0.0, 3.0), starts, dt=sizes).n_steps.tolist() == [30, round(3 / last)]
    adapted = made((0.0, 3.0), starts).n_steps
    for _ in range(2):
        np.testing.assert_array_equal(made((0.0, 3.0), starts).n_steps, adapted)
        assert made((0.0, 3.0), starts, dt=sizes).n_steps.tolist() == [30, 15]
    assert engine.solved == 2


@pytest.mark.parametrize("shape", [(1,), (2, 3), (1, 1)])
@pytest.mark.parametrize("options", [{"dt": 0.1}, {"rtol": 1e-6}, {"rtol": 1e-6, "t_eval": [0.0, 0.5, 1.0]}], ids=str)
def test_solutions_have_the_axes_of_the_points(options: dict[str, Any], shape: tuple[int, ...]) -> None:
    points = sphere(int(np.prod(shape))).reshape(*shape, 3)
    made, engine = propagator(step=lh.Taylor(8))
    first = made((0.0, 1.0), points, **options)
    again = made((0.0, 1.0), points, **options)
    assert engine.solved == 1 and again.y.shape[:-1] == points.shape and again.n_steps.shape == shape
    assert_same(again, first)


@pytest.mark.parametrize("options", [{"dt": 0.1}, {"rtol": 1e-6}, {"rtol": 1e-6, "t_eval": [1.0]}], ids=str)
def test_a_first_call_in_pieces_is_the_first_call(options: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    points = sphere(100) * np.linspace(0.5, 3.0, 100)[:, None]
    whole = propagator(step=lh.Taylor(8))[0]((0.0, 1.0), points, **options)
    monkeypatch.setattr(llvm_engine, "CHUNK", 24)
    assert_same(propagator(step=lh.Taylor(8))[0]((0.0, 1.0), points, **options), whole)


@pytest.mark.parametrize("threads", ["1", "3"])
@pytest.mark.parametrize("options", [{"dt": 0.1}, {"dt": 0.1, "t_eval": [0.55, 1.0]}, {"rtol": 1e-9}], ids=str)
def test_an_ensemble_in_pieces_is_the_ensemble(
    options: dict[str, Any], threads: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    points = sphere(1000) * np.linspace(0.5, 3.0, 1000)[:, None]  # which take different numbers of steps
    made, engine = propagator(step=lh.Taylor(8))
    made((0.0, 1.0), points[::-1], **options)
    whole = made((0.0, 1.0), points, **options)
    monkeypatch.setenv("LIEHOM_NUM_THREADS", threads)
    monkeypatch.setattr(plan, "CHUNK", 96)
    assert_same(made((0.0, 1.0), points, **options), whole)
    assert engine.solved == 1


@pytest.mark.parametrize("count", [256, 401])
@pytest.mark.parametrize("span", [(0.0, 9.0), (9.0, 0.0)], ids=str)
def test_lanes_that_are_sorted_by_pace_are_those_in_their_order(
    span: tuple[float, float], count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m * args["rates"] * np.cos(t)[..., None])
    args = {"rates": lh.PerTrajectory(np.random.default_rng(2).uniform(0.3, 9.0, (count, 1)) * [1.0, 2.0, 4.0])}
    made, engine = propagator(field, lh.Taylor(8))
    times = [0.0, 2.0, 2.1, 7.0] if span[1] else [9.0, 7.0, 2.1, 2.0]
    options: dict[str, Any] = {"rtol": 1e-8, "t_eval": times, "args": args}
    points = sphere(count)
    for _ in range(2):  # the second of which says whether the field is stiff
        made(span, points[::-1], **options)
    solved, orders = engine.solved, list[Any]()
    with monkeypatch.context() as m:
        m.setattr(plan, "SORTED", count + 1)
        m.setattr(np, "argsort", lambda *_: orders.append(_))
        plain = made(span, points, **options)
    assert not orders
    monkeypatch.setattr(plan, "MOVED", 0.0)
    argsort = np.argsort
    monkeypatch.setattr(np, "argsort", lambda x: orders.append(argsort(x)) or orders[-1])
    again = made(span, points, **options)
    assert engine.solved == solved and len(orders) > 2 and (orders[0] != np.arange(count)).any()
    assert_same(again, plain)
    monkeypatch.undo()
    with pytest.warns(RuntimeWarning, match="max_steps"):
        made(span, points, max_steps=40, **options)
    assert engine.solved == solved + 1


def test_a_small_ensemble_in_threads_is_the_ensemble(monkeypatch: pytest.MonkeyPatch) -> None:
    made, engine = propagator(step=lh.Taylor(8))
    points = sphere(20)
    made((0.0, 1.0), points, dt=0.1, t_eval=[1.0])
    monkeypatch.setenv("LIEHOM_NUM_THREADS", "1")
    whole = made((0.0, 900.0), points, dt=0.1, t_eval=[900.0])
    monkeypatch.setenv("LIEHOM_NUM_THREADS", "3")
    for _ in range(5):
        np.testing.assert_array_equal(made((0.0, 900.0), points, dt=0.1, t_eval=[900.0]).y, whole.y)
    assert engine.solved == 1


@pytest.mark.parametrize("count", [1, 100])
def test_a_path_that_is_longer_than_its_memory_goes_on(count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plan, "ROOM", 2)
    points = sphere(count) if count > 1 else START
    made, engine = propagator(BODY, lh.RKMK("rk45"))
    made((0.0, 0.1), points, rtol=1e-3)
    sol = made((0.0, 12.0), points, rtol=1e-3)
    assert engine.solved == 1 and np.max(sol.n_steps) > 6
    assert_same(sol, propagator(BODY, lh.RKMK("rk45"))[0]((0.0, 12.0), points, rtol=1e-3))


@pytest.mark.parametrize("count", [1, 3, 100])
def test_runs_that_grow_by_one_step_have_room_for_each(count: int) -> None:
    points = sphere(count) if count > 1 else START
    made, engine = propagator(BODY, lh.RKMK("rk4"))
    for steps in (2, 1, 2, 3, 4, 5, 6, 5, 9, 10):
        sol = made((0.0, 0.1 * steps), points, dt=0.1)
        assert_same(sol, propagator(BODY, lh.RKMK("rk4"))[0]((0.0, 0.1 * steps), points, dt=0.1))
        np.testing.assert_allclose(sol.t, np.broadcast_to(0.1 * np.arange(steps + 1), sol.t.shape), rtol=0, atol=1e-15)
    assert engine.solved == 1


def test_entries_that_are_made_later_do_not_depend_on_what_happens_meanwhile() -> None:
    made, _ = propagator(step=lh.Corrected(lh.Euler(), 4))
    options = {"dt": 0.1, "dense_output": True}
    made((0.0, 1.0), START, **options)
    points = START.copy()
    sol, wanted = made((0.0, 1.0), points, **options), propagator(step=made.step)[0]((0.0, 1.0), START, **options)
    points[:] = [0.0, 0.0, 1.0]
    made((0.0, 2.0), points, dt=0.05, dense_output=True)
    copied = pickle.loads(pickle.dumps(propagator(step=lh.Taylor(8))[0]((0.0, 1.0), START, dt=0.1)))
    assert copied.n_steps == 10 and copied.success
    assert_same(sol, wanted)
    with pytest.raises(AttributeError, match="no entry 'steps'"):
        _ = sol.steps


@pytest.mark.filterwarnings("ignore:status -1")
def test_too_many_steps_are_too_many_in_every_call() -> None:
    for options in ({"dt": 0.1}, {"rtol": 1e-3}):
        made, _ = propagator(step=lh.Taylor(4))
        assert made((0.0, 0.5), START, max_steps=6, **options).status == 0
        failed, plain = (go((0.0, 9.0), START, max_steps=6, **options) for go in (made, propagator(step=made.step)[0]))
        assert failed.status == plain.status == -1 and failed.message == plain.message
        np.testing.assert_array_equal(failed.y, plain.y)


def test_a_stiff_field_is_noticed_in_the_first_call_that_is_long() -> None:
    field = lh.GeneratorField(lh.defining(lh.so(2)), lambda m, t: -300.0 * (m[..., 1:] - np.sin(t)[..., None] / 2))
    made, _ = propagator(field, lh.RKMK("rk45"))
    made((0.0, 0.01), np.array([1.0, 0.0]))
    with pytest.warns(lh.errors.StiffnessWarning):
        made((0.0, 20.0), np.array([1.0, 0.0]))


def test_a_field_whose_globals_change_is_traced_again() -> None:
    made, engine = propagator(lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * SCALE))
    ends = []
    for scale in ([1.0, 0.5, 0.25], [1.0, 2.0, 3.0]):
        globals()["SCALE"] = np.array(scale)
        ends.append(made((0.0, 1.0), START, dt=0.1).y[:, -1])
    assert engine.solved == 2 and np.abs(ends[0] - ends[1]).max() > 0.1


SCALE = RATES


# -- events ------------------------------------------------------------------------------------------------
def height(t: Any, m: Any) -> Any:
    return m[..., 2] - 0.3


def width(t: Any, m: Any) -> Any:
    return m[..., 0] * np.cos(t / 3)


def grazing(t: Any, m: Any) -> Any:
    return m[..., 1] - LEVEL


LEVEL = 0.7


@pytest.mark.parametrize("count", [1, 4])
@pytest.mark.parametrize(
    ("step", "options"),
    [
        (lh.Taylor(8), {"dt": 0.2}), (lh.Taylor(8), {"rtol": 1e-8}), (lh.RKMK("rk4"), {"dt": 0.1, "t_eval": [1.0]}),
        (lh.Corrected(lh.Euler(), 4), {"dt": 0.1}),
    ], ids=str,
)  # fmt: skip
def test_events_of_a_second_call_are_those_of_the_first(step: Any, options: dict[str, Any], count: int) -> None:
    made, engine = propagator(step=step)
    points = sphere(2 * count).reshape(2, count, 3)[:, 0 if count == 1 else slice(None)]
    given = {**options, "events": [height, width, grazing]}
    made((0.0, 1.0), points[0], **given)
    seen = 0
    for span, y0 in (((0.0, 9.0), points[1]), ((1.0, -8.0), points[0])):
        solved, sol = engine.solved, made(span, y0, **given)
        assert engine.solved == solved
        fresh = propagator(step=step)[0](span, y0, **given)
        np.testing.assert_array_equal(sol.y, fresh.y)
        for mine, other in ((sol.t_events, fresh.t_events), (sol.y_events, fresh.y_events)):
            for a, b in zip(mine, other, strict=True):
                assert np.shape(a) == np.shape(b) and a.dtype == b.dtype
                for x, y in zip(np.reshape(a, -1), np.reshape(b, -1), strict=True):
                    np.testing.assert_allclose(x, y, rtol=0, atol=1e-12)
        seen += sum(np.size(np.concatenate(list(np.reshape(t, -1)))) if count > 1 else len(t) for t in sol.t_events)
    assert seen >= 3 * count


@pytest.mark.parametrize("shape", [(4,), (2, 3)])
def test_events_have_the_args_of_their_trajectory(shape: tuple[int, ...]) -> None:
    def level(t: Any, m: Any, args: Any) -> Any:
        return m[..., 1] - args["level"] - args["shift"][1]

    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m / args["inertia"])
    made, _ = propagator(field, lh.Taylor(8))
    count, seen = int(np.prod(shape)), 0
    points = sphere(count).reshape(*shape, 3)
    for scale in (0.1, 0.2, 0.3):
        levels = scale * np.linspace(-1, 1, count).reshape(shape)
        args = {
            "level": lh.PerTrajectory(levels), "shift": np.array([9.0, 0.05]),
            "inertia": lh.PerTrajectory(np.linspace(1, 2, count).reshape(*shape, 1) * [1.0, 2.0, 3.0]),
        }  # fmt: skip
        sol = made((0.0, 20.0), points, dt=0.1, args=args, events=level)
        plain = lh.integrate(
            field, (0.0, 20.0), points, step=made.step, dt=0.1, args=args, events=level, engine="numpy"
        )
        for place in np.ndindex(shape):
            times, wanted = sol.t_events[0][place], plain.t_events[0][place]
            np.testing.assert_allclose(times, wanted, rtol=0, atol=1e-11)
            np.testing.assert_allclose(sol.y_events[0][place][:, 1], levels[place] + 0.05, rtol=0, atol=1e-13)
            seen += len(times)
    assert seen > 3 * count


def test_an_event_function_that_is_made_in_each_call_is_compiled_once() -> None:
    made, engine = propagator(step=lh.Taylor(8))
    for level in (0.3, 0.3, 0.31):
        sol = made((0.0, 9.0), START, dt=0.1, events=lambda t, m, level=level: m[..., 2] - level)
        np.testing.assert_allclose(sol.y_events[0][:, 2], level, rtol=0, atol=1e-13)
    assert engine.solved in (2, 3)  # 3, if the two numbers 0.3 are different objects


def test_an_event_function_whose_globals_change_is_compiled_again() -> None:
    made, engine = propagator(step=lh.Taylor(8))
    for level, solved in ((0.5, 1), (0.4, 2)):
        globals()["LEVEL"] = level
        for _ in range(2):
            heights = made((0.0, 9.0), START, dt=0.1, events=grazing).y_events[0][:, 1]
            assert len(heights)
            np.testing.assert_allclose(heights, level, rtol=0, atol=1e-13)
            assert engine.solved == solved


def test_terminal_events_and_functions_that_cannot_be_traced_are_made_in_the_ordinary_way() -> None:
    def branching(t: Any, m: Any) -> Any:
        return 1.0 if m[2] > 0.3 else -1.0

    stop = lambda t, m: m[..., 2] - 0.3  # noqa: E731
    stop.terminal = True  # type: ignore[attr-defined]
    for event, status in ((branching, 0), (stop, 1)):
        made, engine = propagator(step=lh.Taylor(8))
        ends = [made((0.0, 9.0), START, dt=0.1, events=event) for _ in range(2)]
        assert engine.solved == 2 and [sol.status for sol in ends] == [status, status]
        np.testing.assert_array_equal(ends[0].y, ends[1].y)
        assert len(ends[1].t_events[0]) == len(ends[0].t_events[0]) > 0
