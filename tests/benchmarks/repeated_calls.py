"""Calls that are made again: a loop over time spans, in all the forms in which users write it, beside heyoka.

    python -m tests.benchmarks.repeated_calls [CALLS]

Each row is the processor time of a call in a loop ``y = P((t, t + 0.1), y, ...).y[:, -1]`` on the rigid body, the least
of some loops. The first calls, which trace and compile, are not counted. heyoka is optional.
"""

import sys
import time
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

import liehom as lh
from liehom.flow.steps import Conserving

RATES = 1 / np.array([1.0, 1.7, 2.9])
START = np.array([0.6, 0.48, 0.64])
SPAN = 0.1
REPEATS = 5

Call = Callable[[float, float, Any], Any]


def body() -> lh.GeneratorField:
    """The free rigid body on the sphere."""
    return lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * RATES)


def energy(m: Any) -> Any:
    """The energy of the body."""
    return (m * m * RATES).sum(axis=-1) / 2


def microseconds(call: Call, calls: int) -> float:
    """Processor time of a call in a loop over time spans, the least of some loops."""
    best = np.inf
    for _ in range(REPEATS):
        y, begin = START, time.process_time()
        for k in range(calls):
            y = call(SPAN * k, SPAN * (k + 1), y)
        best = min(best, (time.process_time() - begin) / calls)
    return 1e6 * float(best)


def variants() -> dict[str, Call]:
    """The calls by name."""
    made: dict[str, Call] = {}

    def add(name: str, step: Any = "taylor", **options: Any) -> None:
        step = lh.Taylor(8) if step == "taylor" else step
        propagator = lh.Propagator(body(), step, engine="llvm")
        made[name] = lambda a, b, y: propagator((a, b), y, **options).y[:, -1]

    add("fixed", dt=0.1)
    add("fixed, dt of numpy", dt=np.float64(0.1))
    add("adapted", rtol=1e-9)
    add("adapted, default step", None, rtol=1e-9)
    taylor = lh.Propagator(body(), lh.Taylor(8), engine="llvm")
    made["fixed, span as a list"] = lambda a, b, y: taylor([a, b], y, dt=0.1).y[:, -1]
    made["fixed, span of numpy"] = lambda a, b, y: taylor(np.array([a, b]), y, dt=0.1).y[:, -1]
    made["fixed, y0 as a list"] = lambda a, b, y: taylor((a, b), list(y), dt=0.1).y[:, -1]
    made["fixed, t_eval"] = lambda a, b, y: taylor((a, b), y, dt=0.1, t_eval=[b]).y[:, -1]
    made["adapted, t_eval"] = lambda a, b, y: taylor((a, b), y, rtol=1e-9, t_eval=np.array([b])).y[:, -1]
    add("fixed, dense output", dt=0.1, dense_output=True)
    add("adapted, dense output", rtol=1e-9, dense_output=True)
    add("Corrected(Euler, 4)", lh.Corrected(lh.Euler(), 4), dt=0.1)
    add("Corrected(Euler, 4), adapted", lh.Corrected(lh.Euler(), 4), rtol=1e-6)
    add("Conserving(LieTaylor(4))", Conserving(lh.LieTaylor(4), energy), dt=0.1)
    add("rk45, adapted", lh.RKMK("rk45"), rtol=1e-6)
    add("rodas4, adapted", "rodas4", rtol=1e-6)
    add("fixed, an event", dt=0.1, events=lambda t, m: m[..., 2])
    add("adapted, an event", rtol=1e-9, events=lambda t, m: m[..., 2])
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m * args["rates"])
    with_args = lh.Propagator(field, lh.Taylor(8), engine="llvm")
    made["fixed, args"] = lambda a, b, y: with_args((a, b), y, dt=0.1, args={"rates": RATES}).y[:, -1]
    return made


def heyoka_call() -> Call | None:
    """The call of heyoka, if it is installed."""
    try:
        import heyoka as hy
    except ImportError:
        return None
    x = hy.make_vars("x", "y", "z")
    w = [float(r) * q for r, q in zip(RATES, x, strict=True)]
    vector = [x[1] * w[2] - x[2] * w[1], x[2] * w[0] - x[0] * w[2], x[0] * w[1] - x[1] * w[0]]
    integrator = hy.taylor_adaptive(list(zip(x, vector, strict=True)), state=START.copy(), tol=1e-9, fast_math=True)

    def call(a: float, b: float, y: Any) -> Any:
        integrator.time = a
        integrator.state[:] = y
        integrator.propagate_until(b)
        return integrator.state.copy()

    return call


def many(lanes: int) -> float:
    """Nanoseconds of a trajectory in a large ensemble, 10 steps."""
    points = np.random.default_rng(0).normal(size=(lanes, 3))
    propagator = lh.Propagator(body(), lh.Taylor(8), engine="llvm")
    best = np.inf
    for k in range(4):
        begin = time.process_time()
        propagator((0.0, 1.0 + k), points, dt=(1.0 + k) / 10, t_eval=[1.0 + k])
        best = min(best, time.process_time() - begin) if k else best
    return 1e9 * float(best) / lanes


def main(calls: int) -> None:
    """Print the table."""
    warnings.simplefilter("ignore")
    for name, call in {**variants(), "heyoka propagate_until": heyoka_call()}.items():
        if call is not None:
            microseconds(call, 3)
            print(f"{name:34s} {microseconds(call, calls):9.1f} us a call", flush=True)
    for lanes in (1_000, 100_000, 1_000_000):
        print(f"{f'{lanes} trajectories':34s} {many(lanes):9.1f} ns each", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 200)
