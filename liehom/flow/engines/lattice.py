"""Lattice fields in machine code: the stages of an explicit step, each for all sites, by the engine "llvm".

Every trajectory of the run is a site, and psi couples the sites. It is traced at one site, with np.roll as loads at
shifted sites. The step is cut into stages at the calls of psi, because psi needs the points of a stage at all sites.
"""

from __future__ import annotations

import time as wall
from typing import Any, Protocol, final, runtime_checkable

import numpy as np

from liehom.base.errors import InputError, LiehomError, TraceError
from liehom.base.typing import Array, Values
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.space import Action
from liehom.flow.engines.engine import Problem
from liehom.flow.engines.lanes import cores
from liehom.flow.run.control import SLACK
from liehom.flow.run.run import Run
from liehom.flow.series.jet import Jet
from liehom.flow.steps.step import Generator, LocalStep, Step
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import Expr, Tape, needed
from liehom.flow.tracing.lattice import LatticeKernel, LatticeTraced, SiteInputs, Stage

SECONDS_PER_CALL = 0.5  # seconds of steps in machine code between progress, checkpoints and Ctrl-C


@runtime_checkable
class NoisyStep(Protocol):
    """A step whose psi has a field of noise added, which is constant over the step."""

    step: Step

    def noise(self, t: float) -> Array:
        """The noise of the step at a time, of the shape of the points."""
        ...

    def response(self, m: Values, w: Values) -> Values:
        """The generator of the noise w at m."""
        ...


@final
class LatticeStep(Step):
    """An explicit step of a lattice field in machine code."""

    def __init__(self, problem: Problem) -> None:
        if (kind := problem.start.dtype) != np.float64:
            raise InputError(f"engine='llvm' computes in float64, the start is of type {kind}: take engine='numpy'")
        self.step = step = problem.step
        self._noisy: NoisyStep | None = step if isinstance(step, NoisyStep) else None
        try:
            recorded = _Recorded(step, problem.bound, problem.action, int(np.max(problem.orbit_dimension)))
        except TraceError as error:
            raise TraceError(f"{step!r} cannot be compiled on a lattice: {error}") from error
        except (LiehomError, TypeError, AttributeError, ValueError, IndexError) as error:
            raise TraceError(
                f"{step!r} cannot be compiled on a lattice, because its code does not run on one traced site "
                f"({type(error).__name__}: {error}): write psi with numpy functions of the last axis and np.roll, or "
                "take engine='numpy'"
            ) from error
        self.kernel = LatticeKernel(
            recorded.inputs, recorded.stages, recorded.time, recorded.size, problem.field.representation.size
        )
        self.calls: int = recorded.calls
        self.estimate_order: int | None = recorded.estimate_order
        self.widest_gap: float = recorded.widest_gap

    @property
    def order(self) -> int:
        return self.step.order

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        if isinstance(m, Jet) or not isinstance(m, np.ndarray) or m.dtype != np.float64:
            return self.step.at(action, psi, m, t, error_terms=error_terms)
        if error_terms and self.estimate_order is None:
            raise InputError(
                f"{self.step!r} has no estimate of its error in machine code on a lattice: give dt, take a pair such "
                "as RKMK('rk45'), or engine='numpy'"
            )
        return _LatticeLocal(self, action, m, t)

    def made(self, m: Array, t: Array, h: Array) -> tuple[Array, Array | None]:
        """Points after steps of sizes h from (m, t), and estimates of the error, lattice by lattice."""
        sites = self.kernel.layout.sites
        lead = m.shape[: m.ndim - 1 - len(sites)]
        first = (0,) * len(sites)
        points = np.empty(m.shape)
        errors = None if self.estimate_order is None else np.empty(m.shape)
        for index in np.ndindex(*lead):
            size = float(h[index + first])
            if size == 0:
                points[index] = m[index]
                if errors is not None:
                    errors[index] = 0.0
                continue
            points[index] = self.advance(m[index], index, range(1), float(t[index + first]), size)
            if errors is not None:
                errors[index] = self.kernel.get("e")
        return points, errors

    def advance(self, m: Array, index: tuple[int, ...], steps: range, origin: float, size: float) -> Array:
        """The points of one lattice of an ensemble after steps of a size, step k from origin + k size."""
        self.kernel.put(m)
        if self._noisy is None:
            self.kernel.run(steps.start, steps.stop, origin, size, cores())
            return self.kernel.get()
        for k in steps:
            self.kernel.put(self._noisy.noise(origin + k * size)[index], "w")
            self.kernel.run(k, k + 1, origin, size, cores())
        return self.kernel.get()

    def __repr__(self) -> str:
        return repr(self.step)


@final
class _LatticeLocal(LocalStep):
    """A step from one state of the lattices, by machine code."""

    def __init__(self, step: LatticeStep, action: Action, m: Array, t: Values) -> None:
        super().__init__(action, m, point=self._moved)
        self.estimate_order, self.widest_gap = step.estimate_order, step.widest_gap
        self.step, self.t = step, np.broadcast_to(np.asarray(t)[..., 0], m.shape[:-1])
        self._last: tuple[Array, tuple[Array, Array | None]] | None = None

    def _made(self, h: Values) -> tuple[Array, Array | None]:
        sizes = np.broadcast_to(np.asarray(h)[..., 0], self.m.shape[:-1])
        if self._last is None or not np.array_equal(self._last[0], sizes):
            self._last = sizes.copy(), self.step.made(np.asarray(self.m), self.t, sizes)
        return self._last[1]

    def _moved(self, h: Values) -> Values:
        return self._made(h)[0]

    def estimate(self, h: Values) -> Values:
        """Estimate of the error as a vector in V, shape (..., N)."""
        return np.asarray(self._made(h)[1])


class _Recorded:
    """The stages of a step at one site."""

    def __init__(self, step: Step, field: GeneratorField, action: Action, orbit_dimension: int) -> None:
        self.field, self.calls = field, 0
        self.noisy: NoisyStep | None = step if isinstance(step, NoisyStep) else None
        step = step if self.noisy is None else self.noisy.step
        self.tape = tape = Tape()
        self.inputs = SiteInputs(tape, field.sites)
        self.time, self.size = self.inputs.fresh(), self.inputs.fresh()
        self.stages = [Stage()]
        n = field.representation.size
        self.start = [self.inputs.load(("m", 0, c), self._here) for c in range(n)]
        psi = Generator(GeneratorField(field.representation, self._psi, time_dependent=True), orbit_dimension)
        h: Values = Traced(tape, self.size)[..., None]
        local = step.at(action, psi, Traced(tape, self.start), Traced(tape, self.time)[..., None])
        results: list[tuple[str, Any]] = [("m", local.point(h))]
        self.estimate_order: int | None = local.estimate_order
        self.widest_gap: float = local.widest_gap
        if local.estimate_order is not None:
            results.append(("e", local.estimate(h)))
        if tape.required:
            raise TraceError("an implicit step is solved at all sites together: take an explicit one")
        for name, values in results:
            entries = Traced(tape, values).entries.reshape(n)
            self.stages[-1].stores += [((name, 0, c), x) for c, x in enumerate(entries)]

    @property
    def _here(self) -> tuple[int, ...]:
        return (0,) * len(self.field.sites)

    def _loaded(self, plane: tuple[str, int], count: int) -> LatticeTraced:
        """The numbers of planes at the site."""
        loads = np.array([self.inputs.load((*plane, c), self._here) for c in range(count)], dtype=object)
        return LatticeTraced(self.inputs, Traced(self.tape, loads.reshape((1,) * len(self._here) + loads.shape)))

    def _psi(self, m: Values, t: Values) -> Values:
        """Values of psi at a stage, as inputs that stand for them."""
        if type(m) is not Traced or type(t) is not Traced:
            raise TraceError(
                "it expands psi in a series, which needs derivatives at other sites: take Euler, Heun, RKMK(...) or a "
                "product of exponentials"
            )
        tape, lattice = self.tape, len(self.field.sites)
        entries: list[Expr] = list(m.entries.reshape(-1))
        if any(x.op in ("variable", "flag", "loop") for x in needed(entries)):
            raise TraceError("an implicit step is solved at all sites together: take an explicit one")
        plane = "m", 0
        if any(x is not y for x, y in zip(entries, self.start, strict=True)):
            plane = "y", self.calls
            self.stages[-1].stores += [((*plane, c), x) for c, x in enumerate(entries)]
            self.stages.append(Stage())
        self.calls += 1
        point = self._loaded(plane, len(entries))
        moment = LatticeTraced(self.inputs, Traced(tape, np.broadcast_to(t.entries.reshape(()), (1,) * lattice)))
        generator: Any = self.field.psi(point, moment)  # type: ignore[arg-type]
        if self.noisy is not None:
            noise: Any = self._loaded(("w", 0), len(entries))
            generator = generator + self.noisy.response(point, noise)  # type: ignore[arg-type]
        values = generator.inner.entries if isinstance(generator, LatticeTraced) else Traced(tape, generator).entries
        inputs = np.empty(self.field.representation.algebra.dimension, dtype=object)
        for a, x in enumerate(np.broadcast_to(values, (*(1,) * lattice, len(inputs))).reshape(-1)):
            inputs[a] = x
            if not x.constant:
                inputs[a] = self.inputs.fresh()
                self.stages[-1].values.append((inputs[a], x))
        return Traced(tape, inputs)


@final
class LatticePath:
    """Ordinary steps of a run on lattices: those of fixed size before the last one and before an output time."""

    def __init__(self, step: LatticeStep) -> None:
        self.step = step
        self.stopped = False
        self._per_call = 1

    def __call__(self, run: Run) -> bool:
        """Make steps until the next one is not ordinary or a call is full; whether any was made."""
        now, dt, total = run.state, run.options.dt, run.total
        if self.stopped or dt is None or total is None or run.events is not None or not now.active.all():
            return False
        taken, size = int(np.max(now.taken)), float(run.direction) * float(np.max(dt))
        limit = min(int(np.max(total)) - 1, run.options.max_steps - 1)
        if now.samples is not None:
            done, times = int(np.min(now.samples.done)), now.samples.times
            if done < len(times):
                limit = min(limit, int(np.ceil(abs(times[done] - run.span[0]) / abs(size) - SLACK)) - 1)
        steps = min(int(limit) - taken, 1 if run.keeps else self._per_call)
        if steps < 1 or int(np.min(now.taken)) != taken:
            return False
        run.engines["llvm"] = None
        begin = wall.perf_counter()
        sites = self.step.kernel.layout.sites
        points = np.empty(run.start.shape)
        for index in np.ndindex(*run.shape[: len(run.shape) - len(sites)]):
            points[index] = self.step.advance(
                now.m[index], index, range(taken, taken + steps), float(run.span[0]), size
            )
        if not np.isfinite(points).all():
            self.stopped = True  # from here on the run makes the steps one by one, and finds the one that fails
            return False
        spent = (wall.perf_counter() - begin) / steps
        self._per_call = max(1, int(SECONDS_PER_CALL / max(spent, 1e-7)))
        now.m, now.taken = points, now.taken + steps
        now.t = np.full(run.shape, run.span[0] + (taken + steps) * size)
        now.calls += steps * self.step.calls
        if run.keeps:
            moved = np.ones(run.shape, dtype=bool)
            now.path.add(now.t, now.m, np.full(run.shape, size), moved)
        return True
