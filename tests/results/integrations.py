"""60 integrations: t and y to the last bit, counts and messages; eager and compiled, whole and resumed."""

import functools
import os
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import liehom as lh
from liehom.base.errors import InputError
from tests.results.values import Long, Numbers, flat

COMPILED = ({"engine": "llvm"}, {"compile": "numba"})
"""The option for compiled steps: as it is now, and in 0.1.0."""
WEIGHTS = np.array([1.0, 0.5, 0.25])
START = np.array([0.6, 0.0, 0.8])


# -- problems --------------------------------------------------------------------------------------------
def body(m: Any) -> Any:
    return -m * WEIGHTS


def forced(m: Any, t: Any) -> Any:
    return m * [1.0, 2.0, 3.0] + 0.3 + 0.1 * np.sin(t)[..., None]


def energy(m: Any) -> Any:
    return np.sum(m * m * WEIGHTS, axis=-1) / 2


def quadratic(rho: Any, seed: int, speed: float) -> lh.GeneratorField:
    """One random quadratic generator for all trajectories."""
    rng = np.random.default_rng(seed)
    constant = rng.normal(size=rho.algebra.dimension)
    linear, square = rng.normal(size=(2, rho.size, rho.algebra.dimension))
    return lh.GeneratorField(rho, lambda m: speed * (constant + m @ linear + (m * m) @ square))


def sphere(n: int, count: int | None = None, seed: int = 0) -> Any:
    m = np.random.default_rng(seed).normal(size=(n,) if count is None else (count, n))
    return m / np.linalg.norm(m, axis=-1, keepdims=True)


PROBLEMS: dict[str, Callable[[], tuple[Any, Any]]] = {
    "body": lambda: (lh.GeneratorField(lh.adjoint(lh.so(3)), body), START),
    "forced": lambda: (lh.GeneratorField(lh.defining(lh.so(3)), forced), START),
    "strings": lambda: (lh.GeneratorField(lh.adjoint(lh.so(3)), ["-m0", "-m1/2 + sin(t)/5", "-m2/4"]), START),
    "S^4": lambda: (quadratic(lh.defining(lh.so(5)), 4, 0.2), sphere(5)),
    "H^3": lambda: (quadratic(lh.defining(lh.so(3, 1)), 3, 0.02), np.array([0.3, -0.4, 0.5, np.sqrt(1.5)])),
    "CP^2": lambda: (quadratic(lh.adjoint(lh.su(3)), 5, 0.1), sphere(8, seed=3)),
    "plane": lambda: (quadratic(lh.defining(lh.sl(2)), 2, 0.1), np.array([0.8, -0.6])),
    "double bracket": lambda: (
        lh.instances.double_bracket_flow(np.diag([1.0, 3.0, 2.0])),
        lh.instances.SymmetricMatrices(3).to_vector([[2.0, 1.0, 0.0], [1.0, 2.0, 1.0], [0.0, 1.0, 2.0]]),
    ),
    "many bodies": lambda: (lh.GeneratorField(lh.adjoint(lh.so(3)), body), sphere(3, 21)),
    "a hundred bodies": lambda: (lh.GeneratorField(lh.adjoint(lh.so(3)), body), sphere(3, 100, seed=5)),
    "many forced": lambda: (lh.GeneratorField(lh.defining(lh.so(3)), forced), sphere(3, 9, seed=7)),
    "an equilibrium among others": lambda: (
        lh.GeneratorField(lh.adjoint(lh.so(3)), body),
        np.concatenate([[[0.0, 0.0, 1.0], [1e-9, 0.0, 1.0]], sphere(3, 4)]),
    ),
    "singular": lambda: (
        lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t: WEIGHTS / (1 - t)[..., None] ** 2),
        START,
    ),
    "extended precision": lambda: (
        lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * WEIGHTS.astype(np.longdouble)),
        sphere(3).astype(np.longdouble),
    ),
}
STEPS: dict[str, Callable[[], Any]] = {
    "Euler": lh.Euler,
    "Heun": lh.Heun,
    "backward Euler": lh.BackwardEuler,
    "Taylor 3": lambda: lh.LieTaylor(3),
    "Taylor 6": lambda: lh.LieTaylor(6),
    "RK4": lambda: lh.RKMK("rk4"),
    "RK45": lambda: lh.RKMK("rk45"),
    "commutator-free": lh.methods.CommutatorFree4,
    "Crouch-Grossman": lh.methods.CrouchGrossman3,
    "Euler to 3": lambda: lh.Corrected(lh.Euler(), order=3),
    "Euler to 4": lambda: lh.Corrected(lh.Euler(), order=4),
    "Heun to 3": lambda: lh.Corrected(lh.Heun(), order=3),
    "RK4 to 5": lambda: lh.Corrected(lh.RKMK("rk4"), order=5),
    "Heun with energy": lambda: lh.Conserving(lh.Heun(), energy),
    "Euler to 2 with energy": lambda: lh.Conserving(lh.Corrected(lh.Euler(), order=2), energy),
}


# -- events ----------------------------------------------------------------------------------------------
def height(t: Any, y: Any) -> Any:
    return y[..., 1] + 0.1


def stop(t: Any, y: Any) -> Any:
    return y[..., 2] - 0.2


stop.terminal = True  # type: ignore[attr-defined]


# -- runs ------------------------------------------------------------------------------------------------
@functools.cache
def compiler() -> dict[str, str]:
    """The option for compiled steps of this version; their machine code goes to a folder of this run."""
    os.environ["LIEHOM_CACHE_DIR"] = tempfile.mkdtemp()
    field, start = PROBLEMS["body"]()
    for option in COMPILED:
        try:
            lh.integrate(field, (0, 0.2), start, step=lh.Euler(), dt=0.1, **option)
        except (InputError, TypeError):
            continue
        return option
    raise RuntimeError("no compiler of steps has a name that is known here")


def completed(options: dict[str, Any]) -> dict[str, Any]:
    kept = {name: value for name, value in options.items() if name != "compile"}
    return {**kept, **compiler()} if options.get("compile") else kept


def solved(problem: str, step: str, span: tuple[float, float], **options: Any) -> dict[str, Any]:
    field, start = PROBLEMS[problem]()
    return values_of(lh.integrate(field, span, start, step=STEPS[step](), **completed(options)))


def chunked(problem: str, step: str, span: tuple[float, float], **options: Any) -> dict[str, Any]:
    field, start = PROBLEMS[problem]()
    return values_of(lh.integrate_ensemble(field, span, start, step=STEPS[step](), **completed(options)))


class Interrupting:
    """psi of a field, interrupted at a call."""

    def __init__(self, field: lh.GeneratorField, at: float) -> None:
        self.field, self.calls, self.at = field, 0, at

    def __call__(self, m: Any, t: Any = 0.0) -> Any:
        self.calls += 1
        if self.calls == self.at:
            raise KeyboardInterrupt
        return self.field.psi(m, t)


def resumed(problem: str, step: str, span: tuple[float, float], **options: Any) -> dict[str, Any]:
    """A run interrupted at two thirds of its calls and continued from its checkpoint."""
    field, start = PROBLEMS[problem]()

    def run(psi: Interrupting, **more: Any) -> Any:
        timed = lh.GeneratorField(field.representation, psi, time_dependent=field.time_dependent)
        return lh.integrate(timed, span, start, step=STEPS[step](), **completed(options), **more)

    whole = run(count := Interrupting(field, np.inf))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.npz"
        try:
            run(Interrupting(field, count.calls * 2 // 3), checkpoint=path)
        except KeyboardInterrupt:
            pass
        else:
            raise RuntimeError("the run was not interrupted")
        again = run(Interrupting(field, np.inf), checkpoint=path)
    same = np.array_equal(again.t, whole.t, equal_nan=True) and np.array_equal(again.y, whole.y, equal_nan=True)
    return {**values_of(again), "as uninterrupted": bool(same)}


def spin(**options: Any) -> dict[str, Any]:
    made = lh.LandauLifshitz(applied=[0.0, 0.3, 1.0], anisotropy=0.2, damping=0.1)
    return values_of(made.integrate((0, 5), [1.0, 0.0, 0.0], **options))


def chain(step: str, **options: Any) -> dict[str, Any]:
    made = lh.LandauLifshitz((8,), exchange=1.0, anisotropy=0.1, damping=0.2)
    return values_of(made.integrate((0, 2), sphere(3, 8, seed=1), step=STEPS[step](), **options))


def updates() -> dict[str, Any]:
    made = lh.RigidBody([1, 2, 3])
    found = {}
    for name in lh.instances.update_names():
        update, m = made.update(name), START
        found[name] = Numbers(np.array([m := update(m, 0.1) for _ in range(50)]).T)
    return found


def values_of(solution: Any) -> dict[str, Any]:
    made: dict[str, Any] = {
        "t": Numbers(solution.t),
        "y": Numbers(solution.y),
        "nfev": int(solution.nfev),
        "n_steps": Numbers(solution.n_steps) if np.ndim(solution.n_steps) else int(solution.n_steps),
        "status": int(solution.status),
        "statuses": Numbers(solution.statuses) if np.ndim(solution.statuses) else int(solution.statuses),
        "message": solution.message,
        "report": Long(list(flat(solution.report))),
    }
    if solution.sol is not None:
        made["dense output"] = Numbers(solution.sol(np.linspace(np.nanmin(solution.t), np.nanmax(solution.t), 23)))
    for name in ("t_events", "y_events"):
        for index, found in enumerate(solution[name] or []):
            arrays = [found] if found.dtype != object else list(found.ravel())
            made[f"{name} {index}"] = Long([list(flat(np.asarray(a))) for a in arrays])
    return made


def _case(kind: Callable[..., Any], problem: str, step: str, span: tuple[float, float], **options: Any) -> Any:
    shown = ", ".join(f"{k}={_shown(v)}" for k, v in options.items())
    return f"{kind.__name__}: {problem}, {step}, {span[0]} to {span[1]}, {shown}", partial(
        kind, problem, step, span, **options
    )


def _shown(value: Any) -> str:
    if callable(value):
        return str(value.__name__)
    if isinstance(value, list) and value and callable(value[0]):
        return "[" + " ".join(x.__name__ for x in value) + "]"
    return f"{len(value)} values" if isinstance(value, np.ndarray) else str(value)


TIMES = np.linspace(0, 3, 7)
SIZES = np.linspace(0.05, 0.2, 21)
CASES: dict[str, Callable[[], dict[str, Any]]] = dict(
    [
        # fixed steps
        _case(solved, "body", "Euler", (0, 3), dt=0.1),
        _case(solved, "body", "Heun", (0, 3), dt=0.1),
        _case(solved, "body", "backward Euler", (0, 3), dt=0.1),
        _case(solved, "forced", "RK4", (0, 3), dt=0.07),
        _case(solved, "forced", "commutator-free", (0, 3), dt=0.07),
        _case(solved, "strings", "Crouch-Grossman", (0, 3), dt=0.1),
        _case(solved, "strings", "Taylor 6", (0, -3), dt=0.3),
        _case(solved, "body", "Euler to 4", (0, 3), dt=0.1),
        _case(solved, "forced", "Heun to 3", (0, 3), dt=0.1),
        _case(solved, "S^4", "Euler to 3", (0, 2), dt=0.1),
        _case(solved, "S^4", "RK4 to 5", (0, 1), dt=0.2),
        _case(solved, "H^3", "Euler to 3", (0, 2), dt=0.1),
        _case(solved, "CP^2", "Heun", (0, 1), dt=0.05),
        _case(solved, "plane", "Euler to 4", (0, 2), dt=0.1),
        _case(solved, "double bracket", "RK4", (0, 2), dt=0.05),
        _case(solved, "double bracket", "Euler to 3", (0, 1), dt=0.05, exponential="cayley"),
        _case(solved, "body", "Euler to 3", (0, 3), dt=0.1, clock="nominal"),
        _case(solved, "body", "Taylor 3", (0, 3), dt=0.1, exponential="cayley"),
        # adaptive steps
        _case(solved, "body", "Taylor 6", (0, 10)),
        _case(solved, "body", "Taylor 6", (0, 5), rtol=1e-10, atol=1e-12),
        _case(solved, "forced", "RK45", (0, 5), rtol=1e-8),
        _case(solved, "forced", "Euler to 3", (0, 3), rtol=1e-5),
        _case(solved, "strings", "RK45", (2, -3), rtol=1e-6, max_step=0.2),
        _case(solved, "S^4", "Euler to 4", (0, 2), rtol=1e-6),
        _case(solved, "H^3", "RK45", (0, 2), rtol=1e-7, first_step=0.01),
        _case(solved, "double bracket", "Taylor 6", (0, 4), rtol=1e-9),
        _case(solved, "extended precision", "Taylor 6", (0, 3), rtol=1e-12, atol=1e-14),
        _case(solved, "extended precision", "Euler to 4", (0, 1), dt=0.1),
        # ends of another kind
        _case(solved, "singular", "RK45", (0, 2), rtol=1e-6, max_steps=200),
        _case(solved, "singular", "Taylor 3", (0, 2), dt=0.1),
        _case(solved, "body", "RK4", (0, 3), dt=0.1, max_steps=12),
        # dense output and events
        _case(solved, "forced", "Euler to 3", (0, 3), dt=0.1, dense_output=True),
        _case(solved, "forced", "RK45", (0, 3), rtol=1e-7, dense_output=True, events=[height, stop]),
        _case(solved, "forced", "Taylor 3", (0, 3), rtol=1e-5, t_eval=TIMES, events=height),
        _case(solved, "many forced", "RK45", (0, 3), rtol=1e-7, dense_output=True, events=[height, stop]),
        _case(solved, "many forced", "Euler to 3", (0, 3), dt=0.1, t_eval=TIMES, events=height),
        # ensembles
        _case(solved, "many bodies", "Taylor 6", (0, 3), rtol=1e-8),
        _case(solved, "many bodies", "Euler to 3", (0, 3), dt=SIZES),
        _case(solved, "an equilibrium among others", "Euler to 3", (0, 3), dt=0.1),
        _case(chunked, "many bodies", "RK4", (0, 3), dt=0.1, chunk=8),
        _case(chunked, "many forced", "RK45", (0, 3), rtol=1e-6, chunk=4, t_eval=TIMES),
        # first integrals
        _case(solved, "body", "Heun with energy", (0, 10), dt=0.1),
        _case(solved, "many bodies", "Euler to 2 with energy", (0, 2), dt=0.1),
        # compiled
        _case(solved, "body", "Euler", (0, 10), dt=0.1, compile=True),
        _case(solved, "body", "RK4", (0, 10), dt=0.1, compile=True),
        _case(solved, "forced", "Taylor 3", (0, 5), dt=0.1, compile=True),
        _case(solved, "body", "Euler to 3", (0, 10), dt=0.1, compile=True),
        _case(solved, "many bodies", "Euler to 3", (0, 5), dt=SIZES, compile=True),
        _case(solved, "a hundred bodies", "RK45", (0, 5), rtol=1e-8, compile=True),
        _case(solved, "body", "Heun with energy", (0, 10), dt=0.1, clock="nominal", compile=True),
        _case(solved, "S^4", "Euler to 3", (0, 2), rtol=1e-6, compile=True),
        _case(chunked, "many forced", "RK4", (0, 3), dt=0.05, chunk=4, t_eval=TIMES, compile=True),
        # resumed from a checkpoint
        _case(resumed, "forced", "Euler to 3", (0, 3), dt=0.1),
        _case(resumed, "forced", "RK45", (0, 3), rtol=1e-7, dense_output=True, events=height),
        _case(resumed, "many forced", "Taylor 3", (0, 3), rtol=1e-5, t_eval=TIMES),
        _case(resumed, "body", "Heun with energy", (0, 5), dt=0.1),
        _case(resumed, "many forced", "RK4", (0, 3), dt=0.05, t_eval=TIMES, compile=True),
    ]
)
CASES |= {
    "a damped spin": partial(spin, rtol=1e-8),
    "a chain of spins": partial(chain, "RK4", dt=0.1),
    "updates of the rigid body": updates,
}
