"""How cost grows: exponents of the cost of a step against order, dim g and the number of trajectories.

Of compiled steps the time of the machine code alone is taken, and the number of operations in it, which is no matter of
the machine; of steps on numpy arrays what `integrate` takes for each step.
"""

import math
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

import liehom as lh
from liehom.flow.engines.traced_step import traced_step
from liehom.flow.tracing.graph import needed
from liehom.flow.tracing.machine import Kernel
from tests.benchmarks.integration_problems import Problem, rigid_body, sphere4

WIDTH, LANES = 16, 1024


def affine(k: int) -> tuple[lh.GeneratorField, Any]:
    """A generator of so(k) that is affine in the point of S^(k-1), and points."""
    rng, rho = np.random.default_rng(k), lh.defining(lh.so(k))
    constant, linear = rng.normal(size=rho.algebra.dimension), rng.normal(size=(k, rho.algebra.dimension)) / k
    m = rng.normal(size=(LANES, k))
    return lh.GeneratorField(rho, lambda m: constant + m @ linear), m / np.linalg.norm(m, axis=-1, keepdims=True)


def compiled_step(field: lh.GeneratorField, step: Any, m: Any, dimension: int, rounds: int = 5) -> tuple[float, int]:
    """(nanoseconds of a lane and step, operations of a step)."""
    graph = traced_step(lh.Action(field.representation), field, step, m, dimension, nominal=False)
    kernel, lanes = Kernel(graph, WIDTH), len(m)
    operations = sum(x.op not in ("const", "input", "get") for x in needed(graph.outputs))
    one, zero = np.ones(lanes), np.zeros(lanes)
    constants = np.array(graph.constants(m)) if graph.constant_functions else None

    def run(steps: int) -> float:
        arrays = [np.ascontiguousarray(m.T), zero.copy(), 0.01 * one, 1e15 * one, zero.copy(), one.copy()]
        arrays += [np.zeros((4, lanes)), constants, None, None]
        begin = time.thread_time()
        kernel(arrays, lanes, (0, lanes // WIDTH), steps, (0.0, 1.0))
        return time.thread_time() - begin

    steps = 4
    while run(steps) < 0.01:
        steps *= 4
    return min(run(steps) for _ in range(rounds)) / steps / lanes * 1e9, operations


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
