"""What a compiled step costs, as ratios in one process: to a kernel in C written by hand, and to numpy by hand.

In the ordinary run each benchmark is executed once, as a test. For figures:

    python -m pytest tests/benchmarks/test_compiled.py -n 0 --benchmark-enable

Processor times of both sides are taken in turns and the least are compared, on one thread.
"""

import ctypes
import shutil
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.engines.traced_step import traced_step
from liehom.flow.tracing.machine import Kernel, padded
from tests.benchmarks import whole_call

LANES, STEPS, H = 10_000, 200, 0.01
INERTIA = np.array([1.0, 0.5, 0.25])
FIELD = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * [1.0, 0.5, 0.25])


def starts(count: int = LANES) -> Any:
    m = np.random.default_rng(0).normal(size=(count, 3))
    return m / np.linalg.norm(m, axis=-1, keepdims=True)


def by_c(folder: Path) -> Callable[[Any, int], None]:
    """x (3, lanes) after so many steps of the kernel in C, in place."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler")
    library = folder / "xi_euler.so"
    source = Path(__file__).with_name("xi_euler.c")
    options = ["-O3", "-march=native", "-ffast-math", "-mprefer-vector-width=512", "-fPIC"]
    made = folder / "xi_euler.o"
    subprocess.run([compiler, *options, "-c", str(source), "-o", str(made)], check=True)
    # linked without -ffast-math: a library linked with it turns subnormal numbers off in the whole process
    subprocess.run([compiler, "-shared", str(made), "-o", str(library)], check=True)
    steps = ctypes.CDLL(str(library)).steps
    if np.float64(2.0**-1074) * np.float64(0.5 + 0.5) == 0.0:
        raise RuntimeError("the library has turned subnormal numbers off")
    steps.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_long] + [ctypes.c_double] * 4

    def run(x: Any, count: int) -> None:
        steps(x.ctypes.data, x.shape[1], count, H, *INERTIA)

    return run


def compiled(step: Any, width: int, *, nominal: bool, points: Any) -> Callable[[Any, int], None]:
    """The same with the kernel that is derived; x must have whole blocks of lanes."""
    graph = traced_step(lh.Action(FIELD.representation), FIELD, step, points, 2, nominal=nominal, stops=not nominal)
    kernel, values = Kernel(graph, width), {"direction": 1.0, "tiny": 0.0, "latest": 1e15}

    def run(x: Any, count: int) -> None:
        fields: dict[str, Any] = {"start": x.copy(), "constants": kernel.run_values(values), "end": count}
        fields |= {"stops": np.full(2, 1e15), "last_stop": 0, "out": np.empty((3, *x.shape))}
        if nominal:
            fields |= {"step_size": H, "total": count}
        state = kernel.packed(x.shape[1], {"x": x, "alive": 1.0} | ({} if nominal else {"h": H}))
        kernel(state, **fields)
        x[:] = state[: len(x)]

    return run


def least(run: Callable[[Any, int], None], x: Any, count: int) -> float:
    x = x.copy()
    begin = time.thread_time()
    run(x, count)
    return (time.thread_time() - begin) / count / x.shape[1] * 1e9


def in_turns(first: Callable[[], float], second: Callable[[], float], rounds: int) -> tuple[float, float]:
    times = [(first(), second()) for _ in range(rounds)]
    return min(a for a, _ in times), min(b for _, b in times)


@pytest.mark.parametrize("clock", ["nominal", "corrected"])
@pytest.mark.benchmark(group="10^4 rigid bodies, Euler corrected to order 2: ns per lane and step")
def test_ensemble_against_c(benchmark: Any, tmp_path: Path, clock: str) -> None:
    m = starts(padded(LANES, 16))
    x = np.ascontiguousarray(m.T)
    hand = by_c(tmp_path)
    made = compiled(lh.Corrected(lh.Euler(), 2), 16, nominal=clock == "nominal", points=m[:8])
    a, b = x.copy(), x.copy()
    hand(a, STEPS)
    made(b, STEPS)
    np.testing.assert_allclose(a, b, rtol=0, atol=1e-13)  # the clock changes the times, not the points
    rounds = 30 if benchmark.enabled else 1
    floor, ours = in_turns(lambda: least(hand, x, STEPS), lambda: least(made, x, STEPS), rounds)
    benchmark.extra_info |= {"C": floor, "compiled": ours, "ratio": ours / floor}
    benchmark.pedantic(made, (x.copy(), STEPS), rounds=1)


@pytest.mark.parametrize("step", [lh.Euler(), lh.Corrected(lh.Euler(), 2)], ids=["Euler", "corrected"])
@pytest.mark.benchmark(group="one rigid body: ns per step")
def test_one_trajectory(benchmark: Any, step: Any) -> None:
    m = starts(1)
    made = compiled(step, 1, nominal=False, points=m)
    x = np.ascontiguousarray(m.T)
    count = 200_000 if benchmark.enabled else 1000
    benchmark.extra_info["ns"] = min(least(made, x, count) for _ in range(10 if benchmark.enabled else 1))
    benchmark.pedantic(made, (x.copy(), count), rounds=1)


def by_numpy(m: Any, count: int) -> Any:
    """The corrected step by hand, on arrays (3, lanes)."""
    inertia = INERTIA[:, None]
    for _ in range(count):
        w = inertia * m
        x = np.stack([m[1] * w[2] - m[2] * w[1], m[2] * w[0] - m[0] * w[2], m[0] * w[1] - m[1] * w[0]])
        xi = H * ((inertia * x * x).sum(0) / (x * x).sum(0) * m - w)
        q = (xi * xi).sum(0)
        r = np.sqrt(q)
        y = H * x
        z = np.stack([xi[1] * y[2] - xi[2] * y[1], xi[2] * y[0] - xi[0] * y[2], xi[0] * y[1] - xi[1] * y[0]])
        m = m + np.sin(r) / r * y + (1 - np.cos(r)) / q * z
    return m


@pytest.mark.benchmark(group="10^4 rigid bodies without compilation, against numpy by hand")
def test_eager_ensemble_against_numpy_by_hand(benchmark: Any) -> None:
    m, count = starts(), 20 if benchmark.enabled else 3
    step = lh.Corrected(lh.Euler(), 2)

    def ours() -> float:
        begin = time.process_time()
        lh.integrate(FIELD, (0, count * H), m, step=step, dt=H, clock="nominal", t_eval=[count * H])
        return time.process_time() - begin

    def hand() -> float:
        begin = time.process_time()
        by_numpy(m.T, count)
        return time.process_time() - begin

    end = lh.integrate(FIELD, (0, count * H), m, step=step, dt=H, clock="nominal", t_eval=[count * H]).y[..., -1]
    np.testing.assert_allclose(by_numpy(m.T, count).T, end, rtol=0, atol=1e-9)
    floor, time_of_ours = in_turns(hand, ours, 8 if benchmark.enabled else 1)
    benchmark.extra_info |= {"numpy": floor / count, "eager": time_of_ours / count, "ratio": time_of_ours / floor}
    benchmark.pedantic(hand, rounds=1)


@pytest.mark.benchmark(group="tracing and compiling order 6 on S^4: seconds")
def test_compile_time(benchmark: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LIEHOM_CACHE_DIR", str(tmp_path))
    a, b = np.random.default_rng(1).normal(size=(2, 5, 10))
    field = lh.GeneratorField(lh.defining(lh.so(5)), lambda m: m @ a + (m * m) @ b)
    order = 6 if benchmark.enabled else 2

    def made() -> bool:
        step = lh.Corrected(lh.Euler(), order)
        graph = traced_step(lh.Action(field.representation), field, step, np.eye(5), 4, nominal=False)
        return Kernel(graph, 8).cached

    begin = time.perf_counter()
    assert not made()
    first = time.perf_counter()
    assert made()
    benchmark.extra_info |= {"first": first - begin, "cached": time.perf_counter() - first}
    benchmark.pedantic(made, rounds=1)


def test_whole_calls_are_measured() -> None:
    found = whole_call.row(whole_call.CASES[1], lanes=20, rounds=1)
    assert all(cost > 0 and error < 1e-5 for cost, error in found.values())
