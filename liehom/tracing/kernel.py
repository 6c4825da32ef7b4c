"""Kernel: machine code of a traced step in a loop over steps and lanes.

Blocks of W lanes (trajectories) are stepped together, all steps of a block before the next block.  A lane is masked out
as soon as its next step would not be an ordinary one.  That is the last step before its limit, a step to a point that
is not finite, and a step over which its clock is not increasing at an admissible rate.  With adaptive step sizes, a
step that is not accepted changes only the step size.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy.typing as npt

from liehom.tracing.expr import Expr
from liehom.tracing.graph import TrajectoryConstant, needed
from liehom.tracing.llvm_text import Body, Writer
from liehom.tracing.machine import engine_of

TIME_SLACK = 1e-9
"""A lane stops if less than this fraction of a step is left to its limit."""
ARRAY_ARGUMENTS = 12


@final
@dataclass(frozen=True, slots=True)
class Sizes:
    """Outputs of an adaptive traced step; input N + 1 of its graph is then the proposed size, without sign.

    Attributes
    ----------
    tried : Expr
        Size of the step that was tried, signed.
    accepted : Expr
        Boolean: whether the step is taken.
    proposal : Expr
        Size proposed for the next step, whether this one is taken or not.
    """

    tried: Expr
    accepted: Expr
    proposal: Expr


@final
@dataclass(frozen=True, slots=True)
class StepGraph:
    """Graph of a traced step: inputs 0..N-1 are the point, N the time, N + 1 the step size, -1, -2, ... constants.

    Attributes
    ----------
    point : list of Expr
        Coordinates of the point after the step.
    elapsed : Expr or None
        Time that passes in the step; None if it is the step size.
    ordinary : Expr or None
        Boolean: whether the step is certainly an ordinary one, that is, its clock is increasing at an admissible rate
        and its equations were solved. None if it always is.
    largest, summed : dict of str to Expr
        Numbers by name; the run records their largest value, or their sum, over the steps taken.
    constant_functions : tuple of callable
        Inputs -1, -2, ...: numbers that are constant along a trajectory, as functions of the initial points (L, N).
    clock : tuple of (int, Expr)
        (k, c_k): the time h + c_2 h^2 + ... passes in a step of size h.
    solved : Expr or None
        Boolean: whether all equations of the step were solved (`ordinary` implies it); None if there are none.
    sizes : Sizes or None
        None if the step size is fixed.
    calls : int or None
        Calls of psi in a step. None if their number depends on values; `summed["calls"]` then counts them.
    """

    point: list[Expr]
    elapsed: Expr | None
    ordinary: Expr | None
    largest: dict[str, Expr]
    summed: dict[str, Expr]
    constant_functions: tuple[TrajectoryConstant, ...] = ()
    clock: tuple[tuple[int, Expr], ...] = ()
    solved: Expr | None = None
    sizes: Sizes | None = None
    calls: int | None = 0

    @property
    def size(self) -> int:
        """N, the number of coordinates."""
        return len(self.point)

    def constants(self, points: npt.NDArray[Any]) -> list[npt.NDArray[Any]]:
        """Values of inputs -1, -2, ...: a list of arrays (L,), for initial points (L, N)."""
        return [number(points) for number in self.constant_functions]

    @property
    def outputs(self) -> list[Expr]:
        """All outputs: point, time, booleans, step sizes, recorded numbers."""
        extra = [x for x in (self.elapsed, self.ordinary) if x is not None]
        sizes = self.sizes
        adapted = [] if sizes is None else [sizes.tried, sizes.accepted, sizes.proposal]
        return [*self.point, *extra, *adapted, *self.largest.values(), *self.summed.values()]


def llvm_module(graph: StepGraph, width: int) -> str:
    """LLVM assembly of a module with the function `run`, for blocks of `width` lanes."""
    w = Writer(width)
    v, n = w.vector, graph.size
    _head(w, n)
    kept = _loop_head(w, graph)
    constants = {-1 - i: f"%c{i}" for i in range(len(graph.constant_functions))}
    body = Body(w, {**{i: f"%x{i}" for i in range(n)}, n: "%t", n + 1: "%h", **constants})
    body.write(needed(graph.outputs))
    _loop_end(w, graph, body)
    w.lines.append("block.end:")
    for name, place in kept:
        w.lines.append(f"  store {v} %{name}.next, ptr {place}, align 8")
    w.lines += [
        "  %block.next = add i64 %block, 1",
        "  %again = icmp slt i64 %block.next, %last",
        "  br i1 %again, label %next, label %done",
        "done:",
        "  ret void",
        "}",
    ]
    attributes = "\n".join(
        [
            'attributes #0 = { nounwind "prefer-vector-width"="512" }',
            '!0 = !{!"branch_weights", i32 1, i32 1000}',
            '!1 = !{!"branch_weights", i32 1000, i32 1}',
            "",
        ]
    )
    parts = ["\n".join(dict.fromkeys(w.declared.values())), *w.functions.values(), "\n".join(w.lines), attributes]
    return "\n\n".join(parts)


def _head(w: Writer, n: int) -> None:
    w.lines += [
        "define void @run(ptr noalias %m, ptr noalias %t.in, ptr noalias %h.in, ptr noalias %limit.in,"
        " ptr noalias %count.in, ptr noalias %alive.in, ptr noalias %extra, ptr noalias %constants, ptr noalias %path,"
        " ptr noalias %path.t, ptr noalias %tries.in, ptr noalias %path.h,"
        " i64 %lanes, i64 %first, i64 %last, i64 %steps, double %origin, double %direction) #0 {",
        "entry:",
        "  %stored = icmp ne ptr %path, null",
        "  br label %next",
        "next:",
        "  %block = phi i64 [%first, %entry], [%block.next, %block.end]",
        f"  %lane = mul i64 %block, {w.width}",
    ]


def _pointer(w: Writer, base: str, row: str | int) -> str:
    offset = w.emit(f"mul i64 %lanes, {row}")
    place = w.emit(f"add i64 {offset}, %lane")
    return w.emit(f"getelementptr double, ptr {base}, i64 {place}")


def _loop_head(w: Writer, graph: StepGraph) -> list[tuple[str, str]]:
    """Load the state of a block and begin the loop over steps; (name, pointer) of the state variables."""
    v, n = w.vector, graph.size
    kept = [(f"x{i}", _pointer(w, "%m", i)) for i in range(n)]
    kept += [("t", _pointer(w, "%t.in", 0)), ("count", _pointer(w, "%count.in", 0))]
    kept += [("alive", _pointer(w, "%alive.in", 0))]
    if graph.sizes is not None:
        kept += [("h", _pointer(w, "%h.in", 0)), ("tries", _pointer(w, "%tries.in", 0))]
    kept += [(f"e{i}", _pointer(w, "%extra", i)) for i in range(len(graph.largest) + len(graph.summed))]
    for name, place in kept:
        w.lines.append(f"  %{name}.start = load {v}, ptr {place}, align 8")
    w.lines.append(f"  %limit = load {v}, ptr {_pointer(w, '%limit.in', 0)}, align 8")
    if graph.sizes is None:
        w.lines.append(f"  %h = load {v}, ptr {_pointer(w, '%h.in', 0)}, align 8")
    for i in range(len(graph.constant_functions)):
        w.lines.append(f"  %c{i} = load {v}, ptr {_pointer(w, '%constants', i)}, align 8")
    if graph.sizes is None:
        w.lines.append(f"  %slack = fmul {v} {w.intrinsic('fabs', '%h')}, {w.splat(TIME_SLACK)}")
    w.lines.append(f"  %dir = fadd {v} {w.spread('%direction')}, {w.splat(-0.0)}")
    w.lines.append(f"  %zero.time = fadd {v} {w.spread('%origin')}, {w.splat(-0.0)}")
    w.lines += ["  br label %step", "step:"]
    w.lines.append("  %k = phi i64 [0, %next], [%k.next, %step.end]")
    for name, _ in kept:
        w.lines.append(f"  %{name} = phi {v} [%{name}.start, %next], [%{name}.next, %step.end]")
    return kept


def _loop_end(w: Writer, graph: StepGraph, body: Body) -> None:
    """Decide in which lanes the step is taken, update their state, store it, and continue the loop."""
    v = w.vector
    more = w.emit(f"fadd {v} %count, {w.splat(1.0)}")
    if graph.elapsed is None:  # by counting, so that round-off does not add up; the limit is a number of steps
        after = w.emit(f"fadd {v} %zero.time, {w.emit(f'fmul {v} {more}, %h')}")
        go = w.emit(f"fcmp ole {v} {more}, %limit")
    else:
        after = w.emit(f"fadd {v} %t, {body.name(graph.elapsed)}")
        left = w.emit(f"fmul {v} %dir, {w.emit(f'fsub {v} %limit, {after}')}")
        slack = "%slack"
        if graph.sizes is not None:
            size = w.intrinsic("fabs", body.name(graph.sizes.tried))
            slack = w.emit(f"fmul {v} {size}, {w.splat(TIME_SLACK)}")
        go = w.emit(f"fcmp ogt {v} {left}, {slack}")
    total = body.name(graph.point[0])
    for x in graph.point[1:]:
        total = w.emit(f"fadd {v} {total}, {body.name(x)}")
    finite = w.emit(f"fcmp oeq {v} {w.emit(f'fsub {v} {total}, {total}')}, {w.splat(0.0)}")
    go = w.emit(f"and {w.mask} {go}, {finite}")
    if graph.ordinary is not None:
        go = w.emit(f"and {w.mask} {go}, {body.name(graph.ordinary)}")
    go = w.emit(f"and {w.mask} {go}, {w.emit(f'fcmp ogt {v} %alive, {w.splat(0.0)}')}")
    new = {f"x{i}": body.name(x) for i, x in enumerate(graph.point)}
    new |= {"t": after, "count": more}
    for i, x in enumerate((*graph.largest.values(), *graph.summed.values())):
        if i < len(graph.largest):
            new[f"e{i}"] = w.intrinsic("maxnum", f"%e{i}", body.name(x))
        else:
            zero = x.constant and x.value == 0
            new[f"e{i}"] = f"%e{i}" if zero else w.emit(f"fadd {v} %e{i}, {body.name(x)}")
    tried, old, sizes = go, {}, graph.sizes
    if sizes is not None:
        go = w.emit(f"and {w.mask} {go}, {body.name(sizes.accepted)}")
        new |= {"h": body.name(sizes.proposal), "tries": w.emit(f"fadd {v} %tries, {w.splat(1.0)}")}
        new["size"], old["size"] = body.name(sizes.tried), w.splat(0.0)
    # a predicted branch costs nothing; selections would lengthen the dependency chain from step to step
    w.lines += [f"  br i1 {w.all(go)}, label %made, label %mixed, !prof !1", "mixed:"]
    for name, value in new.items():
        where = tried if name in ("h", "tries") else go
        w.lines.append(f"  %{name}.mixed = select {w.mask} {where}, {v} {value}, {v} {old.get(name, f'%{name}')}")
    go = tried
    w.lines.append(f"  %alive.mixed = select {w.mask} {go}, {v} {w.splat(1.0)}, {v} {w.splat(0.0)}")
    going = w.any(go)
    w.lines += ["  br label %made", "made:"]
    for name, value in {**new, "alive": "%alive"}.items():
        w.lines.append(f"  %{name}.next = phi {v} [{value}, %{w.label}], [%{name}.mixed, %mixed]")
    w.lines.append(f"  %going = phi i1 [true, %{w.label}], [{going}, %mixed]")
    _store_path(w, graph)
    w.lines += ["step.end:", "  %k.next = add i64 %k, 1"]
    fewer = w.emit("icmp slt i64 %k.next, %steps")
    w.lines.append(f"  br i1 {w.emit(f'and i1 %going, {fewer}')}, label %step, label %block.end")


def _store_path(w: Writer, graph: StepGraph) -> None:
    v, n = w.vector, graph.size
    w.lines += ["  br i1 %stored, label %store, label %step.end", "store:"]
    for i in range(n):
        row = w.emit(f"add i64 {w.emit(f'mul i64 %k, {n}')}, {i}")
        w.lines.append(f"  store {v} %x{i}.next, ptr {_pointer(w, '%path', row)}, align 8")
    w.lines.append(f"  store {v} %t.next, ptr {_pointer(w, '%path.t', '%k')}, align 8")
    if graph.sizes is not None:
        w.lines.append(f"  store {v} %size.next, ptr {_pointer(w, '%path.h', '%k')}, align 8")
    w.lines.append("  br label %step.end")


# -- machine code ------------------------------------------------------------------------------------------
@final
class Kernel:
    """Machine code of a traced step for blocks of `width` lanes.

    Parameters
    ----------
    graph : StepGraph
    width : int

    Attributes
    ----------
    cached : bool
        Whether the code was found in the cache.
    cost : int
        Relative time of an operation, 1; the JAX kernel has another.
    """

    graph: StepGraph
    width: int
    text: str
    cached: bool

    cost = 1

    def __init__(self, graph: StepGraph, width: int) -> None:
        self.graph, self.width = graph, width
        self.text = llvm_module(graph, width)
        self._engine, self.cached = engine_of(self.text)
        arguments = [ctypes.c_void_p] * ARRAY_ARGUMENTS + [ctypes.c_int64] * 4 + [ctypes.c_double] * 2
        self._run = ctypes.CFUNCTYPE(None, *arguments)(self._engine.get_function_address("run"))

    def __call__(
        self,
        arrays: Sequence[npt.NDArray[Any] | None],
        lanes: int,
        blocks: tuple[int, int],
        steps: int,
        time: tuple[float, float],
    ) -> None:
        """Take at most `steps` steps in the blocks first..last-1, changing `arrays` in place.

        The arrays are m, t, h, limit, count, alive, extra, constants, path, path_t; for adaptive step sizes also tries
        (the number of steps tried) and path_h. Without a path to store, path and path_t are None.
        """
        places = [None if a is None else a.ctypes.data for a in arrays]
        self._run(*places, *[None] * (ARRAY_ARGUMENTS - len(places)), lanes, *blocks, steps, *time)


def padded(count: int, width: int) -> int:
    """Number of lanes, rounded up to whole blocks.

    Examples
    --------
    >>> padded(10, 8)
    16
    """
    return -(-count // width) * width
