"""liehom on the same problems: without compilation, and with engine="llvm" and engine="jax".

Each method is a `Propagator` that is made once for a problem and called again and again, as the other programs are.
Points of a compiled run are those of the run on numpy arrays to round-off (which tests hold), so that errors are
measured once.  Spins that act on each other are not compiled by `integrate`; there a step under ``jax.jit`` stands for
it, made of the public pieces of the library.
"""

from functools import cache
from typing import Any

import numpy as np

import liehom as lh
from liehom.flow.steps.conserving import Conserving
from liehom.flow.steps.step import Generator, apply_factors
from liehom.studies.rigid_body_updates import ExactOrbit
from tests.benchmarks.integration_peers import LADDER, Solve, Solver, sample_times
from tests.benchmarks.integration_problems import Problem, rigid_body

EULER2, EULER4, EULER6 = (lh.Corrected(lh.Euler(), n) for n in (2, 4, 6))
STEPS: dict[str, tuple[Any, str]] = {
    "E2": (EULER2, "exp"),
    "E2 cay": (EULER2, "cayley"),
    "E4": (EULER4, "exp"),
    "E6": (EULER6, "exp"),
    "T4": (lh.LieTaylor(4), "exp"),
    "T6": (lh.LieTaylor(6), "exp"),
    "T8": (lh.LieTaylor(8), "exp"),
    "T12": (lh.LieTaylor(12), "exp"),
    "S4": (lh.Taylor(4), "exp"),
    "S8": (lh.Taylor(8), "exp"),
    "S12": (lh.Taylor(12), "exp"),
    "S16": (lh.Taylor(16), "exp"),
    "S20": (lh.Taylor(20), "exp"),
    "RK4": (lh.RKMK("rk4"), "exp"),
}
KEEPING = {"C2": lh.LieTaylor(2), "C4": lh.LieTaylor(4)}
SHORT = {
    "E2": "Corrected 2",
    "E2 cay": "Corrected 2, Cayley",
    "E4": "Corrected 4",
    "E6": "Corrected 6",
    "T4": "LieTaylor 4",
    "T6": "LieTaylor 6",
    "T8": "LieTaylor 8",
    "T12": "LieTaylor 12",
    "S4": "Taylor 4",
    "S8": "Taylor 8",
    "S12": "Taylor 12",
    "S16": "Taylor 16",
    "S20": "Taylor 20",
    "C2": "Conserving 2",
    "C4": "Conserving 4",
    "adaptive": "default",
}
"""Names of methods in the cells of tables, where they are not their labels."""


def _shaped(problem: Problem, starts: Any) -> Any:
    """One trajectory without a leading axis, as a user would give it."""
    points = starts.reshape(-1, *problem.shape)
    return points[0] if len(points) == 1 else points


def _flat(problem: Problem, y: Any, samples: int) -> Any:
    """(..., *shape, samples) to (samples, L, n)."""
    if np.ndim(y) == 2:
        return y.T[:, None]
    y = np.asarray(y)  # quicker than np.moveaxis: the call of liehom is what is measured
    return y.transpose(y.ndim - 1, *range(y.ndim - 1)).reshape(samples, -1, problem.size)


def step_of(name: str, problem: Problem) -> tuple[Any, str]:
    if name in KEEPING:
        return Conserving(KEEPING[name], problem.energy), "exp"
    return STEPS[name]


@cache
def propagator(problem: Problem, name: str, engine: str) -> lh.Propagator:
    if name == "adaptive":
        return lh.Propagator(problem.field, engine=engine)
    if name == "DOP853":
        return lh.Propagator(problem.field, lh.RKMK("dop853"), engine=engine)
    if name == "exact orbit":
        body = lh.RigidBody([1, 2, 3])
        step = ExactOrbit(body)
        return lh.Propagator(body.field("o"), step, exponential="cayley", engine=engine, clock="nominal")
    step, exponential = step_of(name, problem)
    return lh.Propagator(problem.field, step, exponential=exponential, engine=engine)


def integrate(name: str, engine: str) -> Solve:
    def solve(problem: Problem, starts: Any, span: float, setting: float, samples: int) -> Any:
        run = propagator(problem, name, engine)
        sol = run((0.0, span), _shaped(problem, starts), dt=setting, t_eval=sample_times(span, samples))
        return _flat(problem, sol.y, samples)

    return solve


def adaptive(name: str, engine: str) -> Solve:
    def solve(problem: Problem, starts: Any, span: float, setting: float, samples: int) -> Any:
        run, times = propagator(problem, name, engine), sample_times(span, samples)
        sol = run((0.0, span), _shaped(problem, starts), rtol=setting, atol=setting, t_eval=times)
        return _flat(problem, sol.y, samples)

    return solve


# -- spins that act on each other, under jax.jit ---------------------------------------------------------------
def jitted(field: lh.GeneratorField, step: Any, dimension: int, exponential: str = "exp") -> Any:
    """(m, h, count): so many steps of an autonomous field on a JAX array, the time being nominal."""
    import jax
    import jax.numpy as jnp

    action, psi = lh.Action(field.representation, exponential), Generator(field, dimension)

    def one(m: Any, h: Any) -> Any:
        lead = m.shape[:-1]
        local = step.at(action, psi, m, jnp.zeros((*lead, 1), m.dtype))
        return apply_factors(action, local.factors(jnp.full((*lead, 1), h, m.dtype)), m)

    return jax.jit(lambda m, h, count: jax.lax.fori_loop(0, count, lambda _, x: one(x, h), m))


@cache
def _jitted(problem: Problem, name: str) -> Any:
    step, exponential = STEPS[name]
    return jitted(problem.field, step, 2, exponential)


def under_jit(name: str) -> Solve:
    """A step of the library under ``jax.jit``, for spins that act on each other."""

    def solve(problem: Problem, starts: Any, span: float, setting: float, samples: int) -> Any:
        from liehom.flow.engines.jax_loops import enabled_x64

        steps = max(1, round(span / samples / setting))
        with enabled_x64():
            m, made = starts.reshape(-1, *problem.shape), []
            for _ in range(samples):
                m = _jitted(problem, name)(m, span / samples / steps, steps)
                made.append(np.asarray(m).reshape(len(starts), -1))
        return np.array(made)

    return solve


# -- rows ------------------------------------------------------------------------------------------------
SERIES = ("S4", "S8", "S12", "S16", "S20")
FEW, MANY = ("E4", "RK4", *SERIES), ("E2", "E2 cay", "E4", "E6", "T4", "T6", "T8", "T12", "RK4", *SERIES)
EAGER_TOO = ("E4", "T8", "RK4", "S12")
EAGER, LLVM, JAX = "liehom, numpy", 'liehom, engine="llvm"', 'liehom, engine="jax"'
IN_JIT = "liehom, a step under jax.jit"
ALL, ENDS, LARGE = (1, 10, 10_000), (1, 10_000), (10_000,)


def names_for(problem: Problem) -> list[str]:
    """The steps that are tried: no corrections where isotropy is not full, no high orders that are long to compile."""
    names = [n for n in MANY if problem.full or not n.startswith("E")]
    if problem.size > 3:
        names.remove("T12")
    if problem.size > 10:  # minutes of compilation
        names = [n for n in names if n not in ("T6", "T8", "S12", "S16", "S20")]
    return [n for n in names if problem.size <= 3 or n not in ("E6", "E2 cay")]


def solvers(problem: Problem) -> list[Solver]:
    if problem.coupled:
        return _coupled_solvers()
    rows = []
    for n in names_for(problem):
        made = Solver(LLVM, n, integrate(n, "llvm"), LADDER, "llvmlite", True, counts=ALL if n in FEW else LARGE)
        rows.append(made)
        if n in EAGER_TOO:
            rows.append(Solver(EAGER, n, integrate(n, "numpy"), LADDER, "numpy", True, made, counts=ENDS))
        if (n == "T4" and problem.size <= 10) or (n == "E4" and problem.size == 3):
            rows.append(Solver(JAX, n, integrate(n, "jax"), LADDER, "jax", True, made, counts=ENDS))
    if problem.energy is not None:
        rows += [
            Solver(LLVM, n, integrate(n, "llvm"), LADDER[:6], "llvmlite", True, counts=ENDS, varying=True)
            for n in KEEPING
        ]
    rows += _adaptive_solvers(compiled=problem.size <= 10)
    if problem is rigid_body():
        made = Solver(LLVM, "exact orbit", integrate("exact orbit", "llvm"), LADDER[:6], "llvmlite", True, counts=ENDS)
        rows += [
            made,
            Solver(
                EAGER, "exact orbit", integrate("exact orbit", "numpy"), LADDER[:6], "numpy", True, made, counts=LARGE
            ),
        ]
    return rows


def _adaptive_solvers(*, compiled: bool) -> list[Solver]:
    rows = []
    for label, tolerances in (("adaptive", (1e-3, 1e-6, 1e-9, 1e-12)), ("DOP853", (1e-3, 1e-6, 1e-9, 1e-12))):
        made = Solver(LLVM, label, adaptive(label, "llvm"), tolerances, "llvmlite", counts=ALL, sample=8)
        eager = Solver(EAGER, label, adaptive(label, "numpy"), tolerances, "numpy", False, made if compiled else None,
                       counts=(1,), sample=8)  # fmt: skip
        rows += [made, eager] if compiled else [eager]
    return rows


def _coupled_solvers() -> list[Solver]:
    made = [Solver(IN_JIT, n, under_jit(n), LADDER, "jax", fixed=True, counts=(1, 10)) for n in ("T4", "RK4", "T8")]
    return made + [
        Solver(EAGER, x.label, integrate(x.label, "numpy"), LADDER, "numpy", True, x, counts=(1, 10)) for x in made
    ]
