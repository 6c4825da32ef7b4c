"""Loops over steps under JAX, within a run of numpy and on JAX arrays, and the compiled functions that are kept."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from functools import cache, partial
from importlib import import_module
from importlib.util import find_spec
from typing import Any, ClassVar, NamedTuple, TypeAlias, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import LiehomError, TraceError
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.space import Action
from liehom.flow.engines.traced_step import arg_values
from liehom.flow.run.control import (
    MAX_RATE,
    MAX_SHRINK,
    MIN_RATE,
    SLACK,
    SizeLimits,
    first_size,
    is_admissible,
    judgement,
    tried_size,
    whole_lattice,
)
from liehom.flow.run.options import CLOCK, END, IMPLICIT, NOT_FINITE, TOO_MANY, TOO_SMALL
from liehom.flow.steps.step import Generator, LocalStep, Step
from liehom.flow.tracing.graph import needed
from liehom.flow.tracing.loop import StepGraph
from liehom.flow.tracing.machine import Kernel
from liehom.flow.tracing.run_text import ALIVE, DONE, FAILED, Constant
from liehom.flow.tracing.sweeps import JaxArray, evaluate_with_jax, jax, jnp, lax

# The steps of numpy arrays by JAX within a run: all lanes at once, each with its own sizes and times.

MAX_STORED_STEPS = 256  # steps are stored in blocks of powers of 2, at most this one, so that few codes are compiled
WAITS = 2.0  # what `alive` says of a lane that has reached an output time, until numpy has stored its point


def _fingerprint(graph: StepGraph) -> str:
    """Digest of the operations of a graph; graphs with equal operations share their jitted functions."""
    rows = [(x.op, *[a.index for a in x.args], x.value) for x in needed(graph.outputs)]
    layout = [x.index for x in graph.outputs], graph.size, len(graph.largest), len(graph.constant_functions)
    absent = [x is None for x in (graph.elapsed, graph.ordinary, graph.sizes, graph.tried, graph.reached)]
    return hashlib.sha256(repr((rows, layout, absent)).encode()).hexdigest()


@final
class JaxKernel(Kernel):
    """The run of a traced step as a jitted loop over steps, all lanes at once, each with its own sizes and times."""

    engine = "jax"
    in_lockstep, _has_prologue, cost = False, False, 16  # cost on the CPU
    # XLA compiles operations one by one in a time that grows with the square of their number
    tracing: ClassVar[dict[str, Any]] = {"branching": False, "unrolled": 4000}

    def _build(self, constants: Sequence[Constant]) -> None:
        if find_spec("jax") is None:
            raise TraceError('engine="jax" needs JAX: pip install jax')
        self._constants: Any = constants
        options = {"static_argnames": "stored", **options_of("forward")}
        self._jit: Compiled = _shared(_fingerprint(self.graph), "kernel", self._loop, options)

    def __call__(self, state: npt.NDArray[np.float64], **fields: npt.NDArray[Any] | float | None) -> None:
        known: dict[str, Any] = dict(fields)
        n, k, end, out, path = self.graph.size, known["begin"], known["end"], known["out"], known["path"]
        given = [known["constants" if kind == "run" else "rows"][place] for kind, place in self._constants]
        fixed = given, known["stops"], known["last_stop"], known["origin"]
        alive, stop = (state[self.names.index(name)] for name in ("alive", "stop"))
        with enabled_x64():
            while k < end and np.any(alive == ALIVE):
                stored = 0 if path is None else min(MAX_STORED_STEPS, 1 << (end - k - 1).bit_length())
                steps = min(end - k, stored or end)
                made, new, landed, block = self._jit(np.array(state), fixed, steps, stored=stored)
                state[:] = new
                if path is not None:
                    path[k - known["begin"] :][: int(made)] = block[: int(made)]
                k += int(made)
                waits, ended = alive == WAITS, alive == DONE
                out[stop[waits].astype(int) - 1, :, waits] = np.asarray(landed).T[waits]
                out[stop[ended].astype(int), :, ended] = state[:n, ended].T
                alive[waits] = ALIVE

    def _loop(self, state: JaxArray, fixed: JaxArray, steps: JaxArray, stored: int) -> JaxArray:
        """Number of steps, state, points at stops and rows of the path, after steps of the lanes that do not wait."""
        n, lanes = self.graph.size, state.shape[1]
        s = dict(zip(self.names, state, strict=True))
        if self.graph.first is not None:
            inputs = {**{i: s[f"x{i}"] for i in range(n)}, n: s["t"], **{-1 - i: c for i, c in enumerate(fixed[0])}}
            first = evaluate_with_jax([self.graph.first], inputs)[0]
            s["h"] = jnp.where(jnp.isinf(s["h"]), first, s["h"])

        def body(carried: JaxArray) -> JaxArray:
            k, before, landed, block = carried
            s, new, size = self._step(before, fixed)
            landed = jnp.where((s["alive"] == WAITS) & (before["alive"] == ALIVE), new, landed)
            if stored:
                row = jnp.stack([*[s[f"x{i}"] for i in range(n)], s["t"], size])
                block = lax.dynamic_update_index_in_dim(block, row, k, 0)
            return k + 1, s, landed, block

        start = 0, s, jnp.zeros((n, lanes)), jnp.zeros((stored, n + 2, lanes))
        k, s, landed, block = lax.while_loop(lambda c: (c[0] < steps) & jnp.any(c[1]["alive"] == ALIVE), body, start)
        return k, jnp.stack([s[name] for name in self.names]), landed, block

    def _step(self, s: JaxArray, fixed: JaxArray) -> JaxArray:
        """The state after one step, the point after it or at the stop, and the size, 0 for lanes that do not move."""
        given, stops, last, origin = fixed
        graph, n, sizes, time, h = self.graph, self.graph.size, self.graph.sizes, s["t"], s["h"]
        stop_time = stops[s["stop"].astype(int)]
        inputs = {**{i: s[f"x{i}"] for i in range(n)}, n: time, n + 1: h, n + 2: stop_time}
        numbers = list(graph.recorded)
        wanted = dict(zip(self.names, graph.point, strict=False))
        wanted |= dict(zip(numbers, (*graph.largest.values(), *graph.summed.values()), strict=True))
        more = {"elapsed": graph.elapsed, "ordinary": graph.ordinary, "tried": graph.tried, "reached": graph.reached}
        more |= {} if sizes is None else {"accepted": sizes.accepted, "proposal": sizes.proposal}
        wanted |= {name: x for name, x in more.items() if x is not None}
        results = evaluate_with_jax(list(wanted.values()), inputs | {-1 - i: c for i, c in enumerate(given)})
        new = {name: jnp.broadcast_to(x, time.shape) for name, x in zip(wanted, results, strict=True)}
        points = jnp.stack([new[f"x{i}"] for i in range(n)])
        going = s["alive"] == ALIVE
        valid = going & jnp.all(jnp.isfinite(points), axis=0) & new.get("ordinary", True)
        ends = new["reached"] & (s["stop"] >= last)
        waits = valid & new["reached"] & ~ends
        full = valid & ~waits
        moved = full & new.get("accepted", True)
        done = moved & ends
        new["count"] = s["count"] + 1
        after = time + new["elapsed"] if "elapsed" in new else origin + new["count"] * h
        new["t"], new["kept"] = jnp.where(done, stop_time, after), s["stop"]
        for i, name in enumerate(numbers):
            new[name] = jnp.maximum(s[name], new[name]) if i < len(graph.largest) else s[name] + new[name]
        state = {name: jnp.where(moved, new[name], x) if name in new else x for name, x in s.items()}
        state["stop"] = s["stop"] + waits
        if sizes is not None:
            state["h"], state["tries"] = jnp.where(full, new["proposal"], h), s["tries"] + full
            state["stop"] = jnp.where(full & ~moved, s["kept"], state["stop"])
        alive = jnp.where(done, DONE, jnp.where(waits, WAITS, s["alive"]))
        state["alive"] = jnp.where(going & ~valid, FAILED, alive)
        return state, points, jnp.where(moved, new.get("tried", h), 0.0)


@cache
def options_of(how: str) -> dict[str, Any]:
    """Options of jax.jit on this backend for code that is "forward", "long", or "nested" in a transformation (none). On
    the CPU, fusion emitters compute a number again for each use (without them dop853 takes 1000 times fewer
    operations); for a "long" function LLVM does not optimize (it compiles 3 times faster and runs 1.7 times longer).
    """
    options: dict[str, Any] = {"xla_cpu_use_fusion_emitters": False}
    if how == "long":
        options["xla_backend_optimization_level"] = 0
    wanted: dict[str, Any] = {"compiler_options": options}
    try:
        if how != "nested" and jax.default_backend() == "cpu" and jax.jit(lambda x: x + 1, **wanted)(1) == 2:
            return wanted
    except (TypeError, ValueError, RuntimeError):  # other versions have no such options
        pass
    return {}


def enabled_x64() -> JaxArray:
    """A context in which JAX computes in float64."""
    return jax.enable_x64(True) if hasattr(jax, "enable_x64") else import_module("jax.experimental").enable_x64()


# A step at one point on JAX arrays, in two forms that give the same numbers to round-off.
# * "arrays": the step's own code runs on JAX arrays of shape (..., N). Its operations are as many as those of the numpy
#   code, whatever N and dim g are.  XLA compiles it fast.  psi sees the whole array, and may couple its points.
# * "graph": the scalar graph of the step (`liehom.flow.tracing`), with the trajectories on the last axis. XLA compiles
#   n operations in a time that grows like n^2, but short graphs run several times faster than arrays.

NEWTON_ITERATIONS = 8  # iterations for the step size after which the time reparametrization gives a time
NEWTON_ROUNDOFFS = 1e4  # largest error of that time, in units of round-off


class Moved(NamedTuple):
    """A step of one size."""

    point: JaxArray  # (..., N)
    code: JaxArray  # `END` if the point is finite and the equations of the step are solved, else how it failed
    failed: JaxArray  # 1 if a linear system of the correction had no solution
    near: JaxArray  # 1 if the step came near the cone on which some have none


class LocalOnJax(NamedTuple):
    """A step at one point, as a function of its size s (...,)."""

    moved: Callable[[JaxArray], Moved]
    clock: tuple[tuple[int, JaxArray], ...]  # (k, c_k) of tau(s) = s + sum_k c_k s^k; empty if time is s
    local: LocalStep | None = None  # the step of the library; None for a graph

    def time(self, s: JaxArray) -> JaxArray:
        """Time that passes in a step of size s."""
        return sum((c * s**k for k, c in self.clock), s)

    def runs(self, s: JaxArray) -> JaxArray:
        """Whether tau increases at an admissible rate over a step of size s, as in `liehom.flow.run.control`."""
        return is_admissible(self.clock, s) if self.clock else jnp.ones(jnp.shape(s), dtype=bool)

    def size_for(self, time: JaxArray) -> tuple[JaxArray, JaxArray]:
        """The size s with tau(s) = time, by Newton's method, and whether it converged."""
        if not self.clock:
            return time, jnp.ones(jnp.shape(time), dtype=bool)
        s = time
        for _ in range(NEWTON_ITERATIONS):
            slope = 1 + sum(k * c * s ** (k - 1) for k, c in self.clock)
            s = s + (time - self.time(s)) / jnp.clip(slope, MIN_RATE, MAX_RATE)
        bound = NEWTON_ROUNDOFFS * float(np.finfo(s.dtype).eps) * jnp.abs(time)
        return s, jnp.abs(self.time(s) - time) <= bound


@final
@dataclass(frozen=True, slots=True, eq=False)
class ArrayStep:
    """The step's own code on JAX arrays."""

    action: Action
    step: Step
    orbit_dimension: int
    nominal: bool
    error_terms: int = 0  # see `Step.at`

    def at(self, field: GeneratorField, m: JaxArray, t: JaxArray, start: JaxArray) -> LocalOnJax:
        """The step at the points m (..., N) and times t (...,) of trajectories that begin at `start`."""
        psi = Generator(field, self.orbit_dimension, start)
        local = self.step.at(self.action, psi, m, t[..., None], error_terms=self.error_terms)
        clock: Any = () if self.nominal else local.clock
        return LocalOnJax(partial(_moved, local, m, t), clock, local)


def _moved(local: LocalStep, m: JaxArray, t: JaxArray, s: JaxArray) -> Moved:
    moved: Any = local.point(s[..., None])
    point = jnp.broadcast_to(moved, m.shape).astype(m.dtype)
    zero = jnp.zeros(t.shape, t.dtype)
    diagnostics: Any = local.diagnostics(s[..., None])
    names = ("failed", "near")
    failed, near = (jnp.where(diagnostics[x][0], 1.0, zero) if "failed" in diagnostics else zero for x in names)
    valid: Any = local.valid(s[..., None])
    code = _code(point)
    return Moved(point, code if valid is True else jnp.where(valid, code, np.int32(IMPLICIT)), failed, near)


@final
@dataclass(frozen=True, slots=True, eq=False)
class GraphStep:
    """The scalar graph of a step, with the trajectories on the last axis."""

    graph: StepGraph

    def at(self, field: GeneratorField, m: JaxArray, t: JaxArray, start: JaxArray) -> LocalOnJax:
        """The step as for `ArrayStep`; the field is that of the graph, with other args."""
        graph, inputs = self.graph, {**dict(enumerate(jnp.moveaxis(m, -1, 0))), self.graph.size: t}
        known = arg_values(field.args, m.ndim - 1)
        for i, function in enumerate(graph.constant_functions):
            name = getattr(function, "name", None)
            value = known[name] if name in known else function(start)
            inputs[-1 - i] = jnp.asarray(value, m.dtype).reshape(t.shape if np.ndim(value) else ())
        coefficients = evaluate_with_jax([c for _, c in graph.clock], inputs, differentiable=True)
        clock = tuple((k, jnp.broadcast_to(c, t.shape)) for (k, _), c in zip(graph.clock, coefficients, strict=True))
        return LocalOnJax(partial(self._moved, inputs, m, t), clock)

    def _moved(self, inputs: dict[int, JaxArray], m: JaxArray, t: JaxArray, s: JaxArray) -> Moved:
        graph = self.graph
        numbers = [graph.summed[name] for name in ("failed", "near") if name in graph.summed]
        solved = [] if graph.solved is None else [graph.solved]
        outputs = [*graph.point, *numbers, *solved]
        results = evaluate_with_jax(outputs, {**inputs, graph.size + 1: s}, differentiable=True)
        results = [jnp.broadcast_to(x, t.shape) for x in results]
        point = jnp.stack(results[: graph.size], axis=-1).astype(m.dtype)
        code = jnp.where(results[-1], _code(point), np.int32(IMPLICIT)) if solved else _code(point)
        zero = jnp.zeros(t.shape, t.dtype)
        failed, near = results[graph.size : graph.size + 2] if numbers else (zero, zero)
        return Moved(point, code, failed.astype(t.dtype), near.astype(t.dtype))


def _code(point: JaxArray) -> JaxArray:
    return jnp.where(jnp.all(jnp.isfinite(point), axis=-1), np.int32(END), np.int32(NOT_FINITE))


# Functions compiled by JAX that are kept: by an engine for its calls, and between engines for equal functions. A
# function is traced once. Its arrays that are not arguments (numbers that psi closes over, tables) become inputs of the
# compiled code, so that functions which differ in such numbers alone share it.

Jaxpr: TypeAlias = Any  # a jaxpr, one of its operations or of their parameters; JAX has no public types for them
Leaves: TypeAlias = list[JaxArray]  # a flat list of JAX arrays
Compiled: TypeAlias = Callable[..., Any]  # a function that jax.jit compiles
MAX_SHARED = 128  # number of compiled functions that engines share
LONG_EQUATIONS = 150  # from which on XLA compiles gradients without its optimizations by LLVM, which take longest
_SHARED: dict[tuple[str, Hashable], Any] = {}


@final
class Program(NamedTuple):
    """A traced function."""

    jaxpr: Any  # its inputs are the constants and then the arguments
    constants: Leaves
    digest: str | None  # equal for equal operations; None if that cannot be told

    @classmethod
    def of(cls, function: Callable[..., Sequence[JaxArray]], arguments: Leaves) -> Program:
        """The trace of a function of arrays that returns a sequence of arrays."""
        try:
            closed = jax.make_jaxpr(function)(*arguments)
        except LiehomError:
            raise
        except (TypeError, AttributeError, ValueError, IndexError, NotImplementedError) as error:
            raise TraceError(
                f"the step cannot be traced by JAX ({type(error).__name__}: {str(error).splitlines()[0]}): write psi "
                "with numpy functions, or take engine='numpy'"
            ) from error
        return cls(closed.jaxpr, list(closed.consts), _digest(closed.jaxpr))

    def __call__(self, constants: Leaves, arguments: Leaves) -> Leaves:
        """The results; JAX traces through this call."""
        return jax.core.eval_jaxpr(self.jaxpr, constants, *arguments)

    def compiled(self, how: str = "nested") -> Callable[[Leaves, Leaves], Leaves]:
        """The function of (constants, arguments) compiled."""
        return _shared(self.digest, how, self.__call__, options_of(how))

    def pullback(
        self, differentiable: Sequence[bool], *, nested: bool
    ) -> Callable[[Leaves, Leaves, JaxArray], tuple[Leaves, Leaves]]:
        """The compiled function (constants, arguments, cotangent of the first result) -> cotangents of both."""

        def pulled(constants: Leaves, arguments: Leaves, cotangent: JaxArray) -> tuple[Leaves, Leaves]:
            moving = [is_float(c) for c in constants]

            def first(some: Leaves, others: Leaves) -> JaxArray:
                return self(merged(moving, some, constants), merged(differentiable, others, arguments))[0]

            parts = chosen(moving, constants), chosen(differentiable, arguments)
            return jax.vjp(first, *parts)[1](cotangent)

        how = "nested" if nested else "long" if _number_of_equations(self.jaxpr) > LONG_EQUATIONS else "forward"
        return _shared(self.digest, ("pullback", how, *differentiable), pulled, options_of(how))


def is_float(x: JaxArray) -> bool:
    """Whether an array has real entries that can be differentiated."""
    return bool(np.issubdtype(x.dtype, np.floating))


def chosen(which: Sequence[bool], values: Leaves) -> Leaves:
    """The values for which a boolean is true."""
    return [v for take, v in zip(which, values, strict=True) if take]


def merged(which: Sequence[bool], some: Leaves, values: Leaves) -> Leaves:
    """The values, those for which a boolean is true replaced by `some`."""
    left = iter(some)
    return [next(left) if take else v for take, v in zip(which, values, strict=True)]


def _shared(digest: str | None, kind: Hashable, function: Compiled, options: dict[str, Any]) -> Compiled:
    """The jitted function of a digest, made if there is none."""
    if digest is None:
        return jax.jit(function, **options)
    key = digest, kind
    if key not in _SHARED:
        if len(_SHARED) >= MAX_SHARED:
            _SHARED.pop(next(iter(_SHARED)))
        _SHARED[key] = jax.jit(function, **options)
    return _SHARED[key]


# -- digests ---------------------------------------------------------------------------------------------
class _UnknownError(Exception):
    """An operation has a parameter, such as a Python function, of which equality cannot be told."""


def _digest(jaxpr: Jaxpr) -> str | None:
    """Digest of all operations, numbers and shapes; None if a parameter cannot be compared."""
    try:
        return hashlib.sha256(repr(_rows(jaxpr)).encode()).hexdigest()
    except _UnknownError:
        return None


def _rows(jaxpr: Jaxpr) -> list[Any]:
    names: dict[Any, int] = {}

    def atom(x: Jaxpr) -> Jaxpr:
        if hasattr(x, "val"):
            value = np.asarray(x.val)
            return str(value.dtype), value.shape, value.tobytes(), bool(getattr(x.aval, "weak_type", False))
        return names.setdefault(x, len(names))

    rows: list[Any] = [[(atom(x), str(x.aval)) for x in (*jaxpr.constvars, *jaxpr.invars)]]
    for equation in jaxpr.eqns:
        parameters = [(k, _parameter(v)) for k, v in sorted(equation.params.items())]
        inputs, outputs = [atom(x) for x in equation.invars], [(atom(x), str(x.aval)) for x in equation.outvars]
        rows.append((equation.primitive.name, parameters, inputs, outputs))
    return [*rows, [atom(x) for x in jaxpr.outvars]]


def _parameter(value: Jaxpr) -> Jaxpr:
    if hasattr(value, "jaxpr") and hasattr(value, "consts"):
        if value.consts:
            raise _UnknownError
        return _rows(value.jaxpr)
    if hasattr(value, "eqns"):
        return _rows(value)
    if isinstance(value, tuple | list):
        return [_parameter(x) for x in value]
    if isinstance(value, np.ndarray):
        return str(value.dtype), value.shape, value.tobytes()
    if " at 0x" in (text := repr(value)):
        raise _UnknownError
    return text


def _number_of_equations(jaxpr: Jaxpr) -> int:
    """Number of all operations, those of loops and branches included."""
    values = (value for equation in jaxpr.eqns for value in equation.params.values())
    parts = (part for value in values for part in (value if isinstance(value, tuple | list) else (value,)))
    inner = (getattr(part, "jaxpr", part) for part in parts)
    return len(jaxpr.eqns) + sum(_number_of_equations(x) for x in inner if hasattr(x, "eqns"))


# Loops over steps under JAX: with given sizes, which can be differentiated, and with adaptive sizes. Both go from one
# output time to the next. A trajectory takes ordinary steps until a step would pass that time; the point at that time
# is computed by a step of the size that ends there (it *lands*), and the next ordinary step begins where the last one
# ended. So output times do not change the steps, as in `liehom.flow.run`.

At: TypeAlias = Callable[[JaxArray, JaxArray], LocalOnJax]  # the step at points (..., N) and times (...,)


@final
class State(NamedTuple):
    """Trajectories within a loop; all arrays but `m` and `output` are of shape (...,)."""

    m: JaxArray  # (..., N): points after the ordinary steps so far
    t: JaxArray  # times of these points
    count: JaxArray  # numbers of ordinary steps
    code: JaxArray  # `END` while all is well, or why a trajectory failed
    failed: JaxArray  # sums of the entries of `Moved`
    near: JaxArray
    lost: JaxArray  # time of the first step that did not keep its order; inf times the direction for none
    landed: JaxArray  # whether the next output time is reached
    output: JaxArray  # (..., N): points at that time

    @classmethod
    def initial(cls, m: JaxArray, t0: JaxArray, direction: JaxArray) -> State:
        """The state at the initial points m (..., N)."""
        lead = m.shape[:-1]
        zero, none = jnp.zeros(lead, m.dtype), jnp.zeros(lead, np.int32)
        t = jnp.broadcast_to(t0, lead).astype(m.dtype)
        return cls(m, t, none, none + END, zero, zero, zero + direction * jnp.inf, none > 0, m)

    @property
    def moving(self) -> JaxArray:
        """Whether a trajectory is on its way to the next output time."""
        return ~self.landed & (self.code == END)

    def after(self, moved: Moved, t: JaxArray, commits: JaxArray, lands: JaxArray, direction: JaxArray) -> State:
        """The state after a step: `commits` says where it was an ordinary step, `lands` where it was the last one."""
        took = commits | lands
        lossy = took & ((moved.failed > 0) | (moved.near > 0))
        failed, near = (jnp.where(took, x, 0.0).astype(self.t.dtype) for x in (moved.failed, moved.near))
        return self._replace(
            m=jnp.where(commits[..., None], moved.point, self.m), count=self.count + commits,
            t=jnp.where(commits, t, self.t).astype(self.t.dtype), failed=self.failed + failed, near=self.near + near,
            lost=jnp.where(lossy, direction * jnp.minimum(direction * self.lost, direction * self.t), self.lost),
            landed=self.landed | lands, output=jnp.where(lands[..., None], moved.point, self.output),
        )  # fmt: skip

    def failing(self, where: JaxArray, code: int | JaxArray) -> State:
        """The state in which some trajectories have failed, in a way that is a code of `run.options`."""
        return self._replace(code=jnp.where(where & self.moving, jnp.asarray(code, np.int32), self.code))

    def at_output(self) -> tuple[State, JaxArray]:
        """The state on the way to the next output time, and the points (..., N) at this one, NaN if not reached."""
        done = self.failing(~self.landed, TOO_MANY)
        points = jnp.where(self.landed[..., None], self.output, jnp.nan)
        return done._replace(landed=jnp.zeros_like(self.landed)), points


def with_given_sizes(
    at: At, m: JaxArray, t0: JaxArray, times: JaxArray, size: Callable[[JaxArray], JaxArray], iterations: int,
    *, end: JaxArray, direction: JaxArray, by_counting: bool,
) -> tuple[JaxArray, State]:  # fmt: skip
    """Points (k, ..., N) at the times, and the last state, in a loop of fixed length that JAX can differentiate."""

    def one(state: State, time: JaxArray) -> State:
        local = at(state.m, state.t)
        h = size(state.count)
        runs = local.runs(h)
        after = state.t + local.time(h)
        if by_counting and not local.clock:
            after = t0 + (state.count + 1) * h
        over = direction * (time - after) <= SLACK * jnp.abs(h)
        over = jnp.where(runs, over, (time == end) & (jnp.abs(time - state.t) <= MAX_RATE * jnp.abs(h)))
        s, solved = local.size_for(jnp.where(over, time - state.t, h)) if local.clock else (time - state.t, True)
        s = jnp.where(over, s, h)
        moved = local.moved(s)
        code = jnp.where(jnp.where(over, local.runs(s) & solved, runs), moved.code, np.int32(CLOCK))
        good = state.moving & (code == END)
        return state.after(moved, after, good & ~over, good & over, direction).failing(code != END, code)

    def body(state: State, time: JaxArray) -> State:
        # where all trajectories have landed, nothing is computed
        return lax.cond(jnp.any(state.moving), one, lambda state, time: state, state, time)

    checkpointed = jax.checkpoint(body, prevent_cse=False)  # derivatives compute steps again from the points before

    def towards(state: State, time: JaxArray) -> tuple[State, JaxArray]:
        state, _ = lax.scan(lambda s, _: (checkpointed(s, time), None), state, None, length=iterations)
        return state.at_output()

    state, points = lax.scan(towards, State.initial(m, t0, direction), times)
    return points, state


def with_adaptive_sizes(
    step: ArrayStep, field: GeneratorField, at: At, m: JaxArray, t0: JaxArray, times: JaxArray, limits: SizeLimits,
    first: JaxArray, most: JaxArray, recorded: int,
) -> tuple[JaxArray, State, JaxArray]:  # fmt: skip
    """Points (k, ..., N) at the times, the last state, and the signed sizes (recorded, ...) of the ordinary steps."""
    lead = m.shape[:-1]
    direction, stop = limits.direction, limits.end
    psi, lanes, axes = Generator(field, step.orbit_dimension), int(np.prod(lead)), len(field.sites)
    places = jnp.arange(lanes)

    def one(carried: tuple[State, Any, Any], time: JaxArray) -> tuple[State, Any, Any]:
        state, proposal, sizes = carried
        local = at(state.m, state.t)
        inner: Any = local.local
        guess = first_size(limits, inner, psi, state.m, state.t)
        if guess is not None:
            proposal = jnp.where(jnp.isinf(proposal), guess, proposal)
        tried = tried_size(limits, step.action, psi, inner, step.step.order, state.m, state.t, proposal, field)
        h = direction * tried.size
        to_end, solved = local.size_for(stop - state.t)
        runs = local.runs(h)
        last = jnp.where(runs, direction * (stop - state.t - local.time(h)) <= SLACK * jnp.abs(h), False)
        h = jnp.where(last & solved, to_end, h)
        accepted, proposal_after = judgement(limits, inner, state.m, h[..., None], axes)
        after = jnp.where(last, stop, state.t + local.time(h))
        over = direction * (time - after) <= SLACK * jnp.abs(h)
        s, solved = local.size_for(jnp.where(over, time - state.t, h))
        moved = local.moved(jnp.where(over, s, h))
        good = ~whole_lattice(~((moved.code == END) & runs & (solved | ~over)), axes)
        moving = state.moving
        took = moving & good & accepted
        index = jnp.minimum(state.count.reshape(-1), recorded - 1)
        before = sizes[index, places]
        kept = jnp.where(took.reshape(-1) & (state.count.reshape(-1) < recorded), h.reshape(-1), before)
        sizes = sizes.at[index, places].set(kept.astype(m.dtype))
        shrunk = jnp.where(good, proposal_after, MAX_SHRINK * jnp.abs(h))
        proposal = jnp.where(moving & ~(took & over), shrunk, proposal).astype(m.dtype)
        after_step = state.after(moved, after, took & ~over, took & over, direction)
        after_step = after_step.failing(moving & ~tried.good, TOO_SMALL)
        return after_step.failing(moving & (after_step.count >= most) & ~over, TOO_MANY), proposal, sizes

    def towards(carried: tuple[State, Any, Any], time: JaxArray) -> tuple[Any, JaxArray]:
        carried = lax.while_loop(lambda c: jnp.any(c[0].moving), lambda c: one(c, time), carried)
        state, points = carried[0].at_output()
        return (state, *carried[1:]), points

    proposal = jnp.broadcast_to(first, lead).astype(m.dtype)
    start = State.initial(m, t0, direction), proposal, jnp.zeros((recorded, lanes), m.dtype)
    (state, _, sizes), points = lax.scan(towards, start, times)
    return points, state, sizes.reshape(recorded, *lead)
