"""How cost grows: exponents of the cost of a step against order, dim g and the number of trajectories.

Of compiled steps the time of the machine code alone is taken, and the number of operations in it, which is no matter of
the machine; of steps on numpy arrays what `integrate` takes for each step.
"""

import importlib.util
import json
import math
import os
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

import liehom as lh
from liehom.flow.engines.traced_step import traced_step
from liehom.flow.tracing.graph import needed
from tests.benchmarks.integration_problems import Problem, rigid_body, sphere4

LANES = 1024


def affine(k: int) -> tuple[lh.GeneratorField, Any]:
    """A generator of so(k) that is affine in the point of S^(k-1), and points."""
    rng, rho = np.random.default_rng(k), lh.defining(lh.so(k))
    constant, linear = rng.normal(size=rho.algebra.dimension), rng.normal(size=(k, rho.algebra.dimension)) / k
    m = rng.normal(size=(LANES, k))
    return lh.GeneratorField(rho, lambda m: constant + m @ linear), m / np.linalg.norm(m, axis=-1, keepdims=True)


def compiled_step(field: lh.GeneratorField, step: Any, m: Any, dimension: int, rounds: int = 3) -> tuple[float, int]:
    """(nanoseconds of a lane and step, operations of a step)."""
    graph = traced_step(lh.Action(field.representation), field, step, m, dimension, nominal=False)
    operations = sum(x.op not in ("const", "input", "get") for x in needed(graph.outputs))
    return by_the_step(field, step, m, rounds) / len(m) * 1e9, operations


def by_the_step(field: lh.GeneratorField, step: Any, m: Any, rounds: int = 3) -> float:
    """Seconds of a compiled step of all trajectories, without what a call costs."""
    propagator = lh.Propagator(field, step=step, engine="llvm")

    def run(steps: int) -> float:
        begin = time.process_time()
        propagator((0.0, 0.01 * steps), m, dt=0.01, t_eval=[0.01 * steps], max_steps=10**9)
        return time.process_time() - begin

    few, more = 8, 40
    run(few)
    while run(more) - run(few) < 0.02 and more < 10**6:
        more *= 4
    return min(run(more) - run(few) for _ in range(rounds)) / (more - few)


def first_call(k: int, order: int = 8) -> dict[str, float]:
    """Seconds of the first call of `Taylor` on S^(k-1), megabytes after it, and microseconds of a step."""
    code = (
        "import json, resource, sys, time, liehom as lh; from tests.benchmarks.integration_growth import *\n"
        f"field, m = affine({k}); begin = time.process_time()\n"
        f"lh.integrate(field, (0, 1), m[0], step=lh.Taylor({order}), dt=0.05, t_eval=[1.0], engine='llvm')\n"
        "first = time.process_time() - begin; memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        f"step = by_the_step(field, lh.Taylor({order}), m[0])\n"
        "print(json.dumps({'first': first, 'memory': memory / 1024, 'step': 1e6 * step}))\n"
    )
    return _in_a_process(code)


def heyoka_call(k: int, tolerance: float = 1e-6) -> dict[str, float]:
    """The same for heyoka in compact mode, of order 8 at this tolerance; a step is one with a size of its own."""
    code = (
        "import json, resource, time, heyoka as hy; from tests.benchmarks.integration_growth import *\n"
        f"system, start = sphere_for_heyoka({k}); begin = time.process_time()\n"
        f"ta = hy.taylor_adaptive(system, start, tol={tolerance}, compact_mode=True)\n"
        "first = time.process_time() - begin; memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "begin = time.process_time(); steps = ta.propagate_until(10.0)[3]\n"
        "step = (time.process_time() - begin) / steps\n"
        "print(json.dumps({'first': first, 'memory': memory / 1024, 'step': 1e6 * step}))\n"
    )
    return _in_a_process(code)


def sphere_for_heyoka(k: int) -> tuple[list[Any], list[float]]:
    """The equations of `affine(k)` for heyoka, and a start."""
    import heyoka as hy

    field, m = affine(k)
    dimension = field.representation.algebra.dimension
    constant = field.psi(np.zeros(k))
    linear = field.psi(np.eye(k)) - constant
    x = hy.make_vars(*[f"x{i}" for i in range(k)])
    psi = [hy.sum([hy.expression(constant[a]), *(linear[j, a] * x[j] for j in range(k))]) for a in range(dimension)]
    rates: list[list[Any]] = [[] for _ in range(k)]
    for a, matrix in enumerate(field.representation.matrices):
        dense = matrix.to_numpy()
        for i, j in zip(*np.nonzero(dense), strict=True):
            rates[i].append(dense[i, j] * psi[a] * x[j])
    return [(x[i], hy.sum(rates[i])) for i in range(k)], list(m[0])


def _in_a_process(code: str) -> dict[str, float]:
    found = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True,
        env={**os.environ, "LIEHOM_CACHE_DIR": "", "OMP_NUM_THREADS": "1"},
    )  # fmt: skip
    return dict(json.loads(found.stdout.splitlines()[-1]))


def array_step(field: lh.GeneratorField, step: Any, m: Any, rounds: int = 3) -> float:
    """Microseconds of a step of all trajectories on numpy arrays."""

    def run(steps: int) -> float:
        begin = time.process_time()
        lh.integrate(field, (0.0, 0.01 * steps), m, step=step, dt=0.01, t_eval=[0.01 * steps])
        return time.process_time() - begin

    run(3)
    return min(run(13) - run(3) for _ in range(rounds)) / 10 * 1e6


def slope(x: Sequence[float], y: Sequence[float]) -> float:
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])


def _row(what: str, against: str, x: Sequence[float], y: Sequence[float], unit: str) -> dict[str, Any]:
    half = len(x) // 2
    found = {"what": what, "against": against, "x": list(x), "y": list(y), "unit": unit}
    return found | {"exponent": slope(x, y), "last": slope(x[half:], y[half:]) if len(x) - half > 1 else math.nan}


def _orders(problem: Problem, make: Callable[[int], Any], name: str, orders: Sequence[int]) -> list[dict[str, Any]]:
    m = problem.starts(LANES)
    dimension = problem.size - 1
    found = [compiled_step(problem.field, make(n), m, dimension) for n in orders]
    what = f"{name} on {'S²' if problem.size == 3 else problem.name}"
    return [
        _row(f"{what}, compiled", "order", orders, [t for t, _ in found], "ns"),
        _row(f"{what}, compiled", "order", orders, [float(k) for _, k in found], "operations"),
        _row(
            f"{what}, numpy, N = {LANES}",
            "order",
            orders,
            [array_step(problem.field, make(n), m) / LANES * 1e3 for n in orders],
            "ns",
        ),
    ]


def growth(*, tiny: bool = False) -> list[dict[str, Any]]:
    """The table: rows with `x`, `y`, the exponent over all of them and that over the second half."""
    rows: list[dict[str, Any]] = []
    euler = lambda n: lh.Corrected(lh.Euler(), n)  # noqa: E731
    plan: list[tuple[Problem, Callable[[int], Any], str, Sequence[int]]] = [
        (rigid_body(), lh.LieTaylor, "`LieTaylor(n)`", (2, 4) if tiny else (2, 4, 8, 16)),
        (rigid_body(), euler, "`Corrected(Euler(), n)`", (2, 3) if tiny else (2, 3, 4, 6, 8)),
    ]
    if not tiny:
        plan.append((sphere4(), lh.LieTaylor, "`LieTaylor(n)`", (2, 4, 8)))
        plan.append((sphere4(), euler, "`Corrected(Euler(), n)`", (2, 3, 4, 5)))
    for each in plan:
        rows += _orders(*each)
    rows += _dimensions((3, 4) if tiny else (3, 4, 5, 6, 8))
    rows += _spheres((4, 10) if tiny else (5, 8, 16, 24, 40))
    return rows + _counts((1, 10) if tiny else (1, 10, 100, 1000, 10_000, 100_000))


def _dimensions(sizes: Sequence[int]) -> list[dict[str, Any]]:
    """so(k) on S^(k-1), so that dim g = k (k - 1)/2."""
    rows = []
    given = [affine(k) for k in sizes]
    dims = [field.representation.algebra.dimension for field, _ in given]
    for name, step in (("`LieTaylor(4)`", lh.LieTaylor(4)), ("`Corrected(Euler(), 3)`", lh.Corrected(lh.Euler(), 3))):
        found = [compiled_step(f, step, m, k - 1) for (f, m), k in zip(given, sizes, strict=True)]
        arrays = [array_step(f, step, m) / LANES * 1e3 for f, m in given]
        rows.append(_row(f"{name} on Sᵏ⁻¹, compiled", "dim g", dims, [t for t, _ in found], "ns"))
        rows.append(_row(f"{name} on Sᵏ⁻¹, compiled", "dim g", dims, [float(k) for _, k in found], "operations"))
        rows.append(_row(f"{name} on Sᵏ⁻¹, numpy, N = {LANES}", "dim g", dims, arrays, "ns"))
    return rows


def _spheres(sizes: Sequence[int]) -> list[dict[str, Any]]:
    """The first call of `Taylor(8)` on S^(k-1), its memory, and a step of one trajectory, beside heyoka."""
    rows, dims = [], [k * (k - 1) // 2 for k in sizes]
    for name, call in (("`Taylor(8)`, compiled", first_call), ("heyoka, compact mode", heyoka_call)):
        if call is first_call or importlib.util.find_spec("heyoka"):
            found = [call(k) for k in sizes]
            for key, unit in (("first", "s"), ("memory", "MB"), ("step", "µs")):
                what = f"{name} on Sᵏ⁻¹, {'a step' if key == 'step' else 'first call'}"
                rows.append(_row(what, "dim g", dims, [x[key] for x in found], unit))
    return rows


def _counts(counts: Sequence[int]) -> list[dict[str, Any]]:
    """Trajectories of the rigid body: what a step of all of them takes."""
    from tests.benchmarks.integration_measure import cost
    from tests.benchmarks.integration_methods import LLVM, STEPS, integrate
    from tests.benchmarks.integration_peers import LADDER, Solver

    problem, rows = rigid_body(), []
    for engine in ("numpy", "llvm"):
        solver = Solver(LLVM, "E4", integrate("E4", engine), LADDER, fixed=True, lanes=10**9)
        taken = [cost(problem, solver, n, [], 0.02)["step"] * n for n in counts]
        name = "numpy" if engine == "numpy" else "compiled"
        rows.append(_row(f"{STEPS['E4'][0]!r} on S², {name}", "N", counts, taken, "µs"))
    return rows
