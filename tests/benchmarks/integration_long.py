"""Long times and many spins: T = 10^4 on S^2, and a closed chain of 10^4 spins."""

import math
from typing import Any

import numpy as np

from tests.benchmarks.integration_measure import seconds
from tests.benchmarks.integration_methods import EAGER, IN_JIT, LLVM, integrate, under_jit
from tests.benchmarks.integration_peers import LANES_MANY, LANES_ONE, PEERS, Solver
from tests.benchmarks.integration_problems import Problem, chain, quartic, rigid_body

COUNT = 16
SETTINGS = {
    "E4": 0.1, "T8": 0.4, "S16": 0.8, "C2": 0.8, "exact orbit": 0.8, "heyoka.py": 2.22e-16, "scipy DOP853": 1e-11,
    "numba RK4 by hand": 0.02,
}  # fmt: skip


def _one(problem: Problem, solver: Solver, span: float, setting: float, count: int) -> dict[str, Any]:
    """Cost and errors of invariants at the end of a run."""
    starts = problem.starts(count).reshape(count, -1)
    row: dict[str, Any] = {"problem": problem.title, "method": solver.name, "setting": setting, "T": span}
    if not solver.installed:
        return row | {"missing": solver.needs}
    solver.solve(problem, starts, min(span, 20 * setting if solver.fixed else 1.0), setting, 1)
    y: Any = None

    def run() -> None:
        nonlocal y
        y = solver.solve(problem, starts, span, setting, 1)

    taken = seconds(run, 2)
    m = y[0].reshape(count, *problem.shape)
    before = starts.reshape(count, *problem.shape)
    assert problem.energy is not None
    energy = np.abs(problem.energy(m) - problem.energy(before))
    size = np.abs(problem.drift(m) - problem.drift(before))
    found = {"energy": float(np.median(energy)), "norm": float(np.max(size)), "cost": taken / count * 1e6}
    return row | {key: value if math.isfinite(value) else None for key, value in found.items()}


def long_runs(*, span: float = 1e4, spins: int = 10_000) -> list[dict[str, Any]]:
    rows = []
    ours = [Solver(LLVM, n, integrate(n, "llvm"), (), "llvmlite", True) for n in ("E4", "T8", "S16", "C2")]
    own = Solver(LLVM, "exact orbit", integrate("exact orbit", "llvm"), (), "llvmlite", True)
    others = [p for p in PEERS if p.group in ("heyoka.py", "scipy DOP853")]
    for problem in (rigid_body(), quartic()):
        scale = 1.0 if problem is rigid_body() else 0.25
        for solver in [*ours, *([own] if problem is rigid_body() else []), *others, LANES_MANY]:
            setting = SETTINGS[solver.label if solver.group == LLVM else solver.group]
            rows.append(_one(problem, solver, span, setting * (scale if solver.fixed else 1.0), COUNT))
    many, dt = chain(spins), 0.05
    time = max(2 * dt, span / 1e4 * 10)
    rows += [_one(many, Solver(IN_JIT, n, under_jit(n), (), "jax", True), time, dt, 1) for n in ("T4", "RK4")]
    rows += [_one(many, Solver(EAGER, n, integrate(n, "numpy"), (), fixed=True), time, dt, 1) for n in ("T4", "RK4")]
    rows.append(_one(many, LANES_ONE, time, dt / 2, 1))
    return rows
