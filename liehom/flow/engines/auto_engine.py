"""AutoEngine: steps by numpy at first, then by Python or machine code written from the trace, as soon as that pays.

The steps made before and those ahead decide, by their number and not by their time, so that a script gives the same
numbers again. A number of steps ahead follows from the step size, or from the first steps of adaptive sizes.

* The first steps are those of numpy. A trace costs about as much as `NUMPY_STEPS` of them.
* Then a few trajectories are stepped by straight-line Python (`PythonKernel`), if the step can be traced.
* Then by machine code, if llvmlite can be imported, as soon as it would have been made for this number of steps.

Fields on lattices, extended precision, events, and checkpoints, which go on bit for bit, stay with numpy. So do a psi
that changes its own state or does not repeat its value, and a step that a user has written, which may do so.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib.util import find_spec
from typing import final

import numpy as np

from liehom.base.errors import LiehomError, TraceError
from liehom.base.typing import Values
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.fingerprint import Watch
from liehom.flow.engines.engine import NumpyEngine, Problem, executed
from liehom.flow.engines.llvm_engine import CodeStore, CompiledRun, LlvmEngine
from liehom.flow.run.run import Run
from liehom.flow.run.solution import Solution
from liehom.flow.steps.step import Step
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import Tape
from liehom.flow.tracing.machine import Kernel
from liehom.flow.tracing.python_kernel import PythonKernel

FEW = 8  # trajectories, at most, that Python makes faster than numpy, one after the other
# Numbers of steps, and what is added to them for each entry of the matrices of an action, in which traces grow.
NUMPY_STEPS = 32, 0.5  # of numpy before a step is traced
MANY_NUMPY_STEPS = 64, 4.0  # the same for more than FEW trajectories, which only machine code makes faster
NUMBERS_OF_A_STEP = 2000  # coordinates of all points that cost numpy as much as a step does by itself
CALLS_OF_A_STEP = 4, 2  # of psi, and for each order; with more of them, as for implicit methods, a step counts more
FIRST_STEPS = 8  # of adaptive sizes, after which their number to the end is estimated
FORESIGHT = 10  # of adaptive sizes, which may grow, the largest estimate in units of the steps made
PYTHON_STEPS = 2000, 10.0  # of trajectories in Python before machine code is made
STEPS_OF_A_CALL = 100  # steps in Python that cost as much as a call
PLAIN = ("liehom.flow.methods.", "liehom.flow.steps.")  # modules with steps that are functions of point, time and size
STEPS_AT_ONCE = 500  # between two looks at these numbers
NONE = {"numpy": 0.0, "python": 0.0}  # steps by numpy and by Python


@final
class AutoEngine:
    """The engine "auto", the default: numpy, Python or machine code, whatever is quick for the calls that are made."""

    name = "auto"

    def __init__(self) -> None:
        self._generators = 0
        self._begin()

    def _begin(self) -> None:
        """Forget all code."""
        self._watch: Watch | None = None
        self.made = NONE.copy()
        self.refused = set[type[Kernel]]() if find_spec("llvmlite") else {Kernel}
        python = CodeStore(PythonKernel)
        self.stores = {PythonKernel: python, Kernel: CodeStore(Kernel, python.graphs)}
        self._take(LlvmEngine())

    def _take(self, machine: LlvmEngine) -> None:
        """Leave calls like one before to an engine."""
        self._machine, self.again = machine, machine.again

    def __reduce__(self) -> tuple[type[AutoEngine], tuple[()]]:
        return type(self), ()  # code belongs to a process

    def solve(self, problem: Problem) -> Solution:
        """The solution of a problem."""
        if not _is_compiled(problem):
            return NumpyEngine().solve(problem)
        self._generators = problem.action.dimension
        if self._watch is not None and self._watch.changed():
            self._begin()
        if self.stores[Kernel].kernels and self.kind(problem.start) is Kernel:
            try:
                return self._machine.solve(problem)
            except TraceError:  # another kind of call than those before
                self.refused.add(Kernel)
        self.made["python"] += STEPS_OF_A_CALL
        return executed(problem, lambda _: _Ladder(problem, self))

    def repeats(self, problem: Problem) -> bool:
        """Whether psi is a function of its arguments alone, as far as can be seen; it is watched from now on."""
        if self._watch is None:
            self._watch = watch = Watch(problem.bound, problem.start, problem.span[0])
            self._take(LlvmEngine(self.stores[Kernel], watch))
            if not (watch.steady and _repeats(problem.bound, problem.start.shape[-1])):
                self.refused |= self.stores.keys()
        return not self.refused >= self.stores.keys()

    def kind(self, start: Values, ahead: Mapping[str, float] = NONE) -> type[Kernel] | None:
        """The kind of code for initial points (..., N), from the steps made and those ahead; None for numpy."""
        *lead, n = np.shape(start)
        few, size = int(np.prod(lead, dtype=int)) <= FEW and PythonKernel not in self.refused, n * self._generators

        def is_paid(what: str, price: tuple[int, float]) -> bool:
            return self.made[what] + ahead[what] >= price[0] + price[1] * size

        if not is_paid("numpy", NUMPY_STEPS if few else MANY_NUMPY_STEPS):
            return None
        wanted = [Kernel] if not few or is_paid("python", PYTHON_STEPS) else []
        return next((kind for kind in [*wanted, *[PythonKernel] * few] if kind not in self.refused), None)


@final
class _Ladder:
    """The steps of a run, by the code that pays."""

    def __init__(self, problem: Problem, engine: AutoEngine) -> None:
        self._problem, self._engine = problem, engine
        self._compiled: dict[type[Kernel], CompiledRun] = {}
        self._passed, self._ahead = (0, 0.0), 0.0

    def __call__(self, run: Run) -> bool:
        """Make steps; whether there are more to be made."""
        engine, ahead = self._engine, _counted(run, self._steps_ahead(run))
        while (kind := engine.kind(run.start, ahead)) is not None:
            if kind not in self._compiled:
                if not self._begin(run, kind):
                    engine.refused.add(kind)
                    continue
                engine.made["numpy"] += ahead["numpy"]
                engine.made["python"] += ahead["python"] if kind is Kernel else 0
            taken = int(np.sum(run.state.taken))
            more = self._compiled[kind](run)
            if kind is PythonKernel:
                engine.made["python"] += int(np.sum(run.state.taken)) - taken
            return more
        engine.made["numpy"] += _counted(run, 1)["numpy"]
        return False

    def _steps_ahead(self, run: Run) -> float:
        """The number of steps to the end, of the last size, as far as it is known; 0 before the first ones."""
        taken = int(np.max(run.state.taken))
        if run.total is not None:
            return float(np.max(run.total)) - taken if taken else 0.0
        (before, begin), now = self._passed, run.fraction()
        if now > begin:
            self._passed, self._ahead = (taken, now), (taken - before) * (1 - now) / (now - begin)
        return min(self._ahead, FORESIGHT * taken) if taken >= FIRST_STEPS else 0.0

    def _begin(self, run: Run, kind: type[Kernel]) -> bool:
        """Trace and write the code of a run, if that is possible; numpy makes the steps of all others."""
        store = self._engine.stores[kind]
        try:
            with np.errstate(all="ignore"):  # unlike warnings.catch_warnings, it does not touch other threads
                if not self._engine.repeats(self._problem):
                    return False
                compiled = CompiledRun(self._problem, run, store, most=STEPS_AT_ONCE)
                for lanes, key, graph in compiled.groups:
                    store.kernel(key, graph, len(lanes))
        except (LiehomError, ArithmeticError, LookupError, RuntimeError, ImportError, OSError):
            return False  # no others: those of psi on tracers are `TraceError`, and a fault of the library is seen
        self._compiled[kind] = compiled
        return True


def _counted(run: Run, steps: float) -> dict[str, float]:
    """A number of steps of a run: those of numpy by what they cost, those of Python for all trajectories."""
    calls = run.state.calls / max(1, int(np.max(run.state.taken)))
    usual = CALLS_OF_A_STEP[0] + CALLS_OF_A_STEP[1] * run.step.order
    cost = max(1.0, calls / usual) * (1 + run.start.size / NUMBERS_OF_A_STEP)
    return {"numpy": steps * cost, "python": steps * run.start.size / run.start.shape[-1]}


def _is_compiled(problem: Problem) -> bool:
    """Whether code may be written for a problem: nothing of the user's but psi takes part in the steps."""
    return (
        not problem.field.sites
        and problem.options.checkpoint is None
        and problem.options.events is None
        and np.asarray(problem.start).dtype == np.float64
        and _is_ours(problem.step)
    )


def _is_ours(part: object) -> bool:
    """Whether a step and those within it are of the library, and without noise."""
    if isinstance(part, list | tuple):
        return all(map(_is_ours, part))
    parts = list(getattr(part, "__dict__", {}).values()) + [
        getattr(part, n, None) for n in getattr(part, "__slots__", ())
    ]
    return not isinstance(part, Step) or (type(part).__module__.startswith(PLAIN) and _is_ours(parts))


def _repeats(field: GeneratorField, n: int) -> bool:
    """Whether psi gives the same expressions when it is traced twice: not if it draws random numbers."""
    tape = Tape()
    m, t = Traced.inputs(tape, 0, n), Traced(tape, tape.input(n))
    try:
        first, second = (Traced(tape, field.psi(m, t)).entries.tolist() for _ in range(2))
    except Exception:  # noqa: BLE001 - of the user's function, which was not written for tracers
        return False
    return bool(first == second)
