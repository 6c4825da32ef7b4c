"""Other programs on the same problems: scipy's DOP853, heyoka.py, diffrax, and a Runge-Kutta step in numba by hand.

Each is used as its documentation advises for ensembles: scipy with all trajectories in one system, heyoka in batches of
the width of the processor's vectors, diffrax through vmap, numba over blocks of lanes.  Compilation is not timed.
"""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np

from tests.benchmarks import straight_line
from tests.benchmarks.integration_problems import Problem

Tolerances = tuple[float, ...]
Solve = Callable[[Problem, Any, float, float, int], Any]
"""(problem, starts (L, n), span, setting, samples) to points (samples, L, n) at equal distances up to the end."""
LANES, BATCH = 16, 8
LADDER = tuple(1.6 * 2.0**-k for k in range(12))


@dataclass(frozen=True)
class Solver:
    """A row of the tables."""

    group: str  # rows of one group are one program; the best of them stands in the tables
    label: str  # the method, in few letters
    solve: Solve
    settings: Tolerances
    needs: str = "numpy"  # a module that must be there
    fixed: bool = False  # whether the settings are step sizes, so that the cost is that of a call and of so many steps
    accuracy: Solver | None = None  # whose errors are those of this one, where they make the same steps
    fits: Callable[[Problem], bool] = field(default=lambda problem: True)
    counts: tuple[int, ...] = (1, 10, 10_000)  # the sizes of ensembles it is measured on
    lanes: int = 10**9  # how many trajectories are taken for 10^4 of them, where more take longer each
    sample: int = 64  # errors are measured on so many at most
    varying: bool = False  # whether a step of another size costs something else, as it iterates

    @property
    def installed(self) -> bool:
        return importlib.util.find_spec(self.needs) is not None

    @property
    def name(self) -> str:
        return f"{self.group}, {self.label}" if self.label else self.group


def sample_times(span: float, samples: int) -> Any:
    return span * np.arange(1, samples + 1) / samples


# -- scipy -----------------------------------------------------------------------------------------------
def _scipy(problem: Problem, starts: Any, span: float, setting: float, samples: int) -> Any:
    from scipy.integrate import solve_ivp

    count, n = starts.shape
    times = sample_times(span, samples)

    def slope(_: float, y: Any) -> Any:
        return problem.rows(np, y.reshape(n, count)).ravel()

    start = np.ascontiguousarray(starts.T).ravel()
    made = solve_ivp(slope, (0, span), start, method="DOP853", rtol=setting, atol=setting, t_eval=times)
    assert made.success, made.message
    return np.moveaxis(made.y.reshape(n, count, samples), (0, 1, 2), (2, 1, 0))


# -- heyoka ----------------------------------------------------------------------------------------------
@cache
def _taylor(problem: Problem, batch: int, tolerance: float, extended: bool = False) -> Any:
    import heyoka

    variables = heyoka.make_vars(*[f"x{i}" for i in range(problem.size)])
    system = list(zip(variables, problem.rates(list(variables)), strict=True))
    options: dict[str, Any] = {} if extended else {"tol": tolerance, "fast_math": True}
    if problem.size > 10:
        options["compact_mode"] = True
    if extended:
        return heyoka.taylor_adaptive(system, np.zeros(problem.size, np.longdouble), fp_type=np.longdouble, **options)
    if batch == 1:
        return heyoka.taylor_adaptive(system, np.zeros(problem.size), **options)
    return heyoka.taylor_adaptive_batch(system, np.zeros((problem.size, batch)), **options)


def _heyoka(problem: Problem, starts: Any, span: float, setting: float, samples: int) -> Any:
    count, n = starts.shape
    batch = 1 if count == 1 else BATCH
    ta = _taylor(problem, batch, setting)
    made = np.empty((samples, count, n))
    times = sample_times(span, samples)
    columns = np.ascontiguousarray(starts.T)
    if batch == 1:
        ta.time, ta.state[:] = 0.0, columns[:, 0]
        for j, time in enumerate(times):
            ta.propagate_until(time)
            made[j, 0] = ta.state
        return made
    for first in range(0, count, batch):
        block = columns[:, first : first + batch]
        ta.set_time(0.0)
        ta.state[:, : block.shape[1]] = block
        ta.state[:, block.shape[1] :] = block[:, :1]
        for j, time in enumerate(times):
            ta.propagate_until(time)
            made[j, first : first + batch] = ta.state[:, : block.shape[1]].T
    return made


def extended_reference(problem: Problem, starts: Any, times: Any) -> Any:
    """Points (k, L, n) by heyoka in extended precision."""
    ta = _taylor(problem, 1, 0.0, extended=True)
    made = np.empty((len(times), *starts.shape), np.longdouble)
    for i, m in enumerate(starts):
        ta.time, ta.state[:] = np.longdouble(0), m.astype(np.longdouble)
        for j, time in enumerate(times):
            ta.propagate_until(np.longdouble(time))
            made[j, i] = ta.state
    return made


# -- diffrax ---------------------------------------------------------------------------------------------
@cache
def _diffrax_run(problem: Problem, method: str, samples: int) -> Any:
    import diffrax
    import jax
    import jax.numpy as jnp

    term = diffrax.ODETerm(lambda t, y, args: problem.rows(jnp, y))
    solver = getattr(diffrax, method)()

    def one(y0: Any, times: Any, tolerance: Any) -> Any:
        control = diffrax.PIDController(rtol=tolerance, atol=tolerance)
        saved = diffrax.SaveAt(ts=times)
        return diffrax.diffeqsolve(
            term,
            solver,
            0.0,
            times[-1],
            None,
            y0,
            saveat=saved,
            stepsize_controller=control,
            max_steps=MOST,
            throw=False,
        ).ys

    return jax.jit(jax.vmap(one, in_axes=(0, None, None)))


def _diffrax(method: str) -> Solve:
    def solve(problem: Problem, starts: Any, span: float, setting: float, samples: int) -> Any:
        from liehom.flow.engines.jax_loops import enabled_x64

        with enabled_x64():
            made = _diffrax_run(problem, method, samples)(starts, sample_times(span, samples), setting)
            return np.moveaxis(np.asarray(made), 1, 0)

    return solve


# -- numba, by hand --------------------------------------------------------------------------------------
@cache
def _rk4_kernel(problem: Problem, width: int) -> Any:
    import numba

    options = {"fastmath": True, "error_model": "numpy"}
    space: dict[str, Any] = {"np": np}
    if problem.coupled:
        return numba.njit(**options)(_chain_rk4)
    n = problem.size
    for name, text in (
        ("field", straight_line.source(problem.rates, n)),
        ("step", straight_line.rk4_source(n)),
        ("run", straight_line.loop_source(n, width)),
    ):
        exec(text, space)
        space[name] = numba.njit(**options)(space[name])
    return space["run"]


def _rk4(width: int) -> Solve:
    def solve(problem: Problem, starts: Any, span: float, setting: float, samples: int) -> Any:
        count, n = starts.shape
        run = _rk4_kernel(problem, width)
        steps = max(1, math.ceil(span / samples / setting - 1e-9))
        x = np.empty((n, -(-count // width) * width))
        x[:, :count] = starts.T
        x[:, count:] = starts.T[:, :1]
        made = np.empty((samples, count, n))
        for j in range(samples):
            if problem.coupled:
                run(x, span / samples / steps, steps, 1.0, 0.2)
            else:
                run(x, span / samples / steps, steps)
            made[j] = x[:, :count].T
        return made

    return solve


def _chain_rk4(x: Any, h: float, steps: int, exchange: float, k: float) -> None:
    """The classical method for a closed chain, spins in the rows of (n, 3)."""
    n = x.shape[0] // 3
    y, total, z = np.empty((n, 3)), np.empty((n, 3)), np.empty((n, 3))
    for lane in range(x.shape[1]):
        for i in range(n):
            for j in range(3):
                y[i, j] = x[3 * i + j, lane]
        for _ in range(steps):
            for stage in range(4):
                weight = h / 6 if stage in (0, 3) else h / 3
                ahead = h if stage == 2 else h / 2
                # the point of the stage is in z, but for the first one
                slope = np.empty((n, 3))
                for i in range(n):
                    left, right = (i - 1 if i else n - 1), (i + 1 if i + 1 < n else 0)
                    if stage == 0:
                        m0, m1, m2 = y[i, 0], y[i, 1], y[i, 2]
                        h0 = exchange * (y[left, 0] + y[right, 0])
                        h1 = exchange * (y[left, 1] + y[right, 1])
                        h2 = exchange * (y[left, 2] + y[right, 2]) + 2 * k * m2
                    else:
                        m0, m1, m2 = z[i, 0], z[i, 1], z[i, 2]
                        h0 = exchange * (z[left, 0] + z[right, 0])
                        h1 = exchange * (z[left, 1] + z[right, 1])
                        h2 = exchange * (z[left, 2] + z[right, 2]) + 2 * k * m2
                    slope[i, 0] = h1 * m2 - h2 * m1
                    slope[i, 1] = h2 * m0 - h0 * m2
                    slope[i, 2] = h0 * m1 - h1 * m0
                for i in range(n):
                    for j in range(3):
                        before = y[i, j] if stage == 0 else total[i, j]
                        total[i, j] = before + weight * slope[i, j]
                        z[i, j] = y[i, j] + ahead * slope[i, j]
            for i in range(n):
                for j in range(3):
                    y[i, j] = total[i, j]
        for i in range(n):
            for j in range(3):
                x[3 * i + j, lane] = y[i, j]


def _uncoupled(problem: Problem) -> bool:
    return not problem.coupled


MOST = 100_000  # steps: at a coarse tolerance a trajectory may leave the sphere for good
TOLERANCES, FEWER = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-13), (1e-2, 1e-5, 1e-8, 1e-11)
LANES_ONE, LANES_MANY = (
    Solver("numba RK4 by hand", "one at a time", _rk4(1), LADDER, "numba", fixed=True),
    Solver("numba RK4 by hand", "lanes", _rk4(LANES), LADDER, "numba", True, None, _uncoupled, (10, 10_000)),
)
PEERS = [
    Solver("scipy DOP853", "", _scipy, TOLERANCES, "scipy"),
    Solver("heyoka.py", "", _heyoka, (1e-4, 1e-7, 1e-10, 1e-13, 2.22e-16), "heyoka"),
    Solver("diffrax", "Tsit5", _diffrax("Tsit5"), FEWER[:3], "diffrax", lanes=1000),
    Solver("diffrax", "Dopri8", _diffrax("Dopri8"), FEWER, "diffrax", lanes=1000),
    LANES_ONE,
    LANES_MANY,
]
