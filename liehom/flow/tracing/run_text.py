"""LLVM assembly of a run: all steps of a block of lanes, the first, the last and those at output times included.

A *block* is `width` lanes (trajectories); all steps of a block are made before the next block. There are two loops.

* *In lockstep*: steps of one size without a time reparametrization, the last of them to the end. Where a stop (an
  output time or the end) is within a step, a *micro-step* from the same point goes to the stop first.
* *By itself*: each lane has its own sizes and times. Input N + 2 is the time of the next stop. The graph says whether
  the stop is within the step; the point is then that at the stop.

`stops` are the times of the stops, the last of them the end, and the end again. Row k of `out` is the point at stop k,
row k of `path` is step number `begin` + k.

In a lane whose point is not finite, or whose step is not valid, nothing changes from then on (`alive` is 0).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias, final

from liehom.flow.tracing.graph import Expr, needed
from liehom.flow.tracing.llvm_text import Body, Writer, number
from liehom.flow.tracing.loop import StepGraph

FIELDS = (
    "state", "start", "lanes", "first", "last", "constants", "rows", "out", "path", "stops", "last_stop", "first_stop",
    "begin", "end", "total", "origin", "step_size",
)  # fmt: skip
"""Entries of the argument of `run`, each of 8 bytes. The number of the first stop, the number of steps up to the end,
and the size of a step are for steps in lockstep."""
POINTERS = frozenset(["state", "start", "constants", "rows", "out", "path", "stops"])
FLOATS = frozenset(["origin", "step_size"])
METADATA = """\
attributes #0 = { nounwind "prefer-vector-width"="512" }
!0 = !{!"branch_weights", i32 1, i32 1000}
!1 = !{!"branch_weights", i32 1000, i32 1}
!2 = distinct !{!2, !3}
!3 = !{!"llvm.loop.vectorize.enable", i1 false}
"""
ALIVE, FAILED, DONE = 1.0, 0.0, -1.0
"""What `alive` says of a lane."""

Constant: TypeAlias = tuple[str, int] | Expr
"""Where an input -1, -2, ... comes from: ("run", place), ("lane", row), or an expression of the initial point."""


def state_names(graph: StepGraph) -> list[str]:
    """Names of the numbers of a lane that change from step to step: the rows of the argument `state`."""
    names = [f"x{i}" for i in range(graph.size)] + ["alive", "count"]
    if graph.reached is not None:
        names += ["t", "stop", "h"]
    if graph.sizes is not None:
        names += ["tries", "kept"]
    return [*names, *graph.recorded]


def run_module(graph: StepGraph, constants: Sequence[Constant], width: int) -> str:
    """LLVM assembly of a module with the function `run`, whose argument points to the `FIELDS`."""
    return (_OwnSizes if graph.reached is not None else _Lockstep)(graph, constants, width).module()


class _RunWriter:
    """Writer of the function `run`."""

    def __init__(self, graph: StepGraph, constants: Sequence[Constant], width: int) -> None:
        self.graph, self.w = graph, Writer(width)
        self.v, self.n = self.w.vector, graph.size
        self.names = state_names(graph)
        self.constants = constants
        self.inputs: dict[int, str] = {}

    def module(self) -> str:
        """The module."""
        for part in (self._entry, self._prologue, self._loop, self._block_end):
            part()
        w = self.w
        head = [*dict.fromkeys(w.declared.values()), *w.constants()]
        return "\n\n".join(["\n".join(head), *w.functions.values(), "\n".join(w.lines), METADATA])

    def line(self, *texts: str) -> None:
        """Append instructions."""
        self.w.lines += [f"  {text}" for text in texts]

    def label(self, name: str) -> None:
        """Begin a basic block."""
        self.w.lines.append(f"{name}:")
        self.w.label = name

    # -- blocks of lanes -------------------------------------------------------------------------------------
    def _entry(self) -> None:
        self.w.lines.append("define void @run(ptr noalias %argument) #0 {")
        self.label("entry")
        for place, name in enumerate(FIELDS):
            kind = "ptr" if name in POINTERS else "double" if name in FLOATS else "i64"
            here = self.w.emit(f"getelementptr i64, ptr %argument, i64 {place}")
            self.line(f"%{name} = load {kind}, ptr {here}, align 8")
        self.line(f"%begin.place = getelementptr i64, ptr %argument, i64 {FIELDS.index('begin')}")
        self.entry = len(self.w.lines)
        self.line(
            "%keeps = icmp ne ptr %path, null",
            "%some = icmp slt i64 %first, %last",
            "br i1 %some, label %next, label %done",
        )
        self.label("next")
        self.line(
            "%block = phi i64 [%first, %entry], [%block.next, %block.end]", f"%lane = mul i64 %block, {self.w.width}"
        )

    def _block_end(self) -> None:
        self.label("block.end")
        for row, name in enumerate(self.names):
            self.line(f"store {self.v} %{name}.next, ptr {self._place('%state', row)}, align 8")
        self.line(
            "%block.next = add i64 %block, 1",
            "%again = icmp slt i64 %block.next, %last",
            "br i1 %again, label %next, label %done",
        )
        self.label("done")
        if self.w.slots:
            self.w.lines.append("  call void @free(ptr %own)")
            self._own_memory()
        self.w.lines += ["  ret void", "}"]

    def _own_memory(self) -> None:
        """Allocate %memory for the numbers of loops over entries, from a multiple of 64 bytes on."""
        w = self.w
        w.declared |= {"malloc": "declare noalias ptr @malloc(i64)", "free": "declare void @free(ptr)"}
        w.lines[self.entry : self.entry] = [
            f"  %own = call ptr @malloc(i64 {64 + 8 * w.width * w.slots})",
            "  %own.place = ptrtoint ptr %own to i64",
            "  %own.rest = sub i64 0, %own.place",
            "  %own.gap = and i64 %own.rest, 63",
            "  %memory = getelementptr i8, ptr %own, i64 %own.gap",
        ]

    def _place(self, base: str, row: str | int) -> str:
        """Pointer to the lanes of this block in a row of an array (rows, lanes)."""
        start = self.w.emit(f"mul i64 %lanes, {row}")
        return self.w.emit(f"getelementptr double, ptr {base}, i64 {self.w.emit(f'add i64 {start}, %lane')}")

    def _loaded(self, base: str, row: str | int) -> str:
        return self.w.emit(f"load {self.v}, ptr {self._place(base, row)}, align 8")

    def _shared(self, base: str, place: str | int) -> str:
        """A number of an array, in all lanes."""
        here = self.w.emit(f"getelementptr double, ptr {base}, i64 {place}")
        return self.w.spread(self.w.emit(f"load double, ptr {here}, align 8"))

    # -- before the first step -------------------------------------------------------------------------------
    def _prologue(self) -> None:
        """Load the state of a block, and compute what is constant along its trajectories."""
        w, graph = self.w, self.graph
        state = {name: self._loaded("%state", row) for row, name in enumerate(self.names)}
        traced = [x for x in (*self.constants, graph.guard) if isinstance(x, Expr)]
        start = {i: self._loaded("%start", i) for i in range(self.n)} if traced else {}
        loaded = {-1 - i: self._constant(*x) for i, x in enumerate(self.constants) if not isinstance(x, Expr)}
        body = Body(w, {**start, **loaded})
        body.write(needed(traced))
        self.inputs = loaded | {-1 - i: body.name(x) for i, x in enumerate(self.constants) if isinstance(x, Expr)}
        if graph.guard is not None:
            state["alive"] = self._select(body.name(graph.guard), state["alive"], w.splat(FAILED))
        if graph.first is not None:
            first = Body(w, {**self.inputs, **{i: state[f"x{i}"] for i in range(self.n)}, self.n: state["t"]})
            first.write(needed([graph.first]))
            unknown = w.emit(f"fcmp oeq {self.v} {state['h']}, {w.splat(float('inf'))}")
            state["h"] = self._select(unknown, first.name(graph.first), state["h"])
        self._loop_head(state, w.label)

    def _loop_head(self, state: dict[str, str], before: str) -> None:
        """Begin the loop over steps with a state, from a basic block."""
        self.line("br label %step")
        self.label("step")
        self.line(
            f"%k = phi i64 [%begin, %{before}], [%k.next, %step.end]",
            *[f"%{name} = phi {self.v} [{state[name]}, %{before}], [%{name}.next, %step.end]" for name in self.names],
        )

    def _constant(self, kind: str, number: int) -> str:
        return self._shared("%constants", number) if kind == "run" else self._loaded("%rows", number)

    # -- steps -----------------------------------------------------------------------------------------------
    def _loop(self) -> None:
        raise NotImplementedError

    def _body(self, more: dict[int, str]) -> Body:
        """Write the operations of a step."""
        body = Body(self.w, {i: f"%x{i}" for i in range(self.n)} | self.inputs | more)
        body.write(needed(self.graph.outputs))
        return body

    def _valid(self, body: Body) -> str:
        """Name of the mask of lanes in which the step is valid and the point finite."""
        w, v, graph = self.w, self.v, self.graph
        total = body.name(graph.point[0])
        for x in graph.point[1:]:
            total = w.emit(f"fadd {v} {total}, {body.name(x)}")
        finite = w.emit(f"fcmp oeq {v} {w.emit(f'fsub {v} {total}, {total}')}, {w.splat(0.0)}")
        return finite if graph.ordinary is None else self._and(finite, body.name(graph.ordinary))

    def _and(self, a: str, b: str) -> str:
        return self.w.emit(f"and {self.w.mask} {a}, {b}")

    def _not(self, a: str) -> str:
        return self.w.emit(f"xor {self.w.mask} {a}, {self.w.splat(True)}")

    def _select(self, where: str, a: str, b: str) -> str:
        return self.w.emit(f"select {self.w.mask} {where}, {self.v} {a}, {self.v} {b}")

    def _recorded(self, body: Body) -> dict[str, str]:
        """Names of the largest and the summed numbers after the step."""
        names, graph, w = {}, self.graph, self.w
        for i, x in enumerate((*graph.largest.values(), *graph.summed.values())):
            if i < len(graph.largest):
                names[f"e{i}"] = w.intrinsic("maxnum", f"%e{i}", body.name(x))
            else:
                zero = x.constant and x.value == 0
                names[f"e{i}"] = f"%e{i}" if zero else w.emit(f"fadd {self.v} %e{i}, {body.name(x)}")
        return names

    def _alive(self) -> str:
        return self.w.emit(f"fcmp ogt {self.v} %alive, {self.w.splat(0.0)}")

    def _go_on(self, now: str, end: str, again: str, after: str) -> None:
        """Branch to a block while steps and lanes are left, else to the block after the loop."""
        fewer = self.w.emit(f"icmp slt i64 {now}, {end}")
        self.line(f"br i1 {self.w.emit(f'and i1 %going, {fewer}')}, label %{again}, label %{after}")

    def _store_path(self, kept: str, values: dict[str, str], after: str) -> None:
        """Store the points, the time and the size of step k as a row of `path`, if it is kept, and begin a block."""
        w = self.w
        self.line(f"br i1 {kept}, label %store, label %{after}")
        self.label("store")
        first = w.emit(f"mul i64 {w.emit('sub i64 %k, %begin')}, {self.n + 2}")
        for i, value in enumerate([*[f"%x{i}.next" for i in range(self.n)], values["t"], values["h"]]):
            place = self._place("%path", w.emit(f"add i64 {first}, {i}"))
            self.line(f"store {self.v} {value}, ptr {place}, align 8")
        self.line(f"br label %{after}")
        self.label(after)


@final
class _Lockstep(_RunWriter):
    """Steps number `begin` to `end`, of `size`; step number `total` goes to the end, which is the last of the `stops`.

    Consecutive steps without a stop are a *segment*. A micro-step, a step that ends at a stop, and one that is stored
    are segments of their own. Numbers that depend on the size alone are computed once for a segment. `count` of a lane
    that fails is the step that failed.
    """

    def _time(self, k: str) -> str:
        """The time after k steps, without round-off that adds up."""
        way = self.w.emit(f"fmul double {self.w.emit(f'sitofp i64 {k} to double')}, %step_size")
        return self.w.emit(f"fadd double %origin, {way}")

    def _loop_head(self, state: dict[str, str], before: str) -> None:
        w, v = self.w, self.v
        all_alive = w.all(w.emit(f"fcmp ogt {v} {state['alive']}, {w.splat(0.0)}"))
        self.line("br label %segment")
        self.label("segment")
        self.line(
            f"%segment.k = phi i64 [%begin, %{before}], [%k.after, %segment.end]",
            f"%next.stop = phi i64 [%first_stop, %{before}], [%stop.after, %segment.end]",
            f"%segment.whole = phi i1 [{all_alive}, %{before}], [%whole.made, %segment.end]",
            *[f"%{name}.old = phi {v} [{state[name]}, %{before}], [%{name}.next, %segment.end]" for name in self.names],
            "%more = add i64 %segment.k, 1",
            "%closing = icmp eq i64 %more, %total",
            "%place = getelementptr double, ptr %stops, i64 %next.stop",
            "%wanted = load double, ptr %place, align 8",
            "%place.end = getelementptr double, ptr %stops, i64 %last_stop",
            "%end.time = load double, ptr %place.end, align 8",
        )
        here, there = self._time("%segment.k"), self._time("%more")
        self.line(
            "%upwards = fcmp oge double %step_size, 0.0",
            f"%there = select i1 %closing, double %end.time, double {there}",
            "%earlier = fcmp olt double %wanted, %there",
            "%later = fcmp ogt double %wanted, %there",
            "%within = select i1 %upwards, i1 %earlier, i1 %later",
            "%at = fcmp oeq double %wanted, %there",
            "%stops.here = or i1 %within, %at",
            "%goal = select i1 %within, double %wanted, double %there",
            f"%rest = fsub double %goal, {here}",
            "%odd = or i1 %within, %closing",
            "%segment.size = select i1 %odd, double %rest, double %step_size",
            "%alone = or i1 %stops.here, %odd",
            "%single = or i1 %alone, %keeps",
        )
        # the steps up to the one before the next stop; with fewer of them there are more segments, and the same numbers
        steps = w.emit(f"fdiv double {w.emit('fsub double %wanted, %origin')}, %step_size")
        fewer = w.emit(f"fsub double {steps}, {number(1.0)}")
        last = w.emit("sitofp i64 %end to double")
        capped = w.emit(f"select i1 {w.emit(f'fcmp olt double {fewer}, {last}')}, double {fewer}, double {last}")
        whole = w.emit(f"fptosi double {capped} to i64")
        ahead = w.emit(f"icmp sgt i64 {whole}, %more")
        long = w.emit(f"select i1 {ahead}, i64 {whole}, i64 %more")
        self.line(f"%until = select i1 %single, i64 %more, i64 {long}")
        self.h = w.spread("%segment.size")
        self.line("br label %step")
        self.segment = w.label
        self.label("step")
        self.line(
            f"%k = phi i64 [%segment.k, %{self.segment}], [%k.next, %made]",
            f"%whole = phi i1 [%segment.whole, %{self.segment}], [%whole.made, %made]",
            *[f"%{name} = phi {v} [%{name}.old, %{self.segment}], [%{name}.made, %made]" for name in self.names],
        )

    def _loop(self) -> None:
        w = self.w
        body = self._body({self.n: w.spread(self._time("%k")), self.n + 1: self.h})
        new = {f"x{i}": body.name(x) for i, x in enumerate(self.graph.point)} | self._recorded(body)
        valid, before = self._valid(body), w.label
        # a predicted branch costs nothing; selections would lengthen the dependency chain from step to step
        usual = w.emit(f"and i1 {w.all(valid)}, %whole")
        self.line(f"br i1 {usual}, label %made, label %mixed, !prof !1")
        self._mixed(new, valid)
        self.label("made")
        self.line(
            *[
                f"%{name}.made = phi {self.v} [{new.get(name, f'%{name}')}, %{before}], [%{name}.mixed, %mixed]"
                for name in self.names
            ],
            f"%whole.made = phi i1 [true, %{before}], [%whole.mixed, %mixed]",
            f"%going = phi i1 [true, %{before}], [%going.mixed, %mixed]",
            "%k.next = add i64 %k, 1",
        )
        self._go_on("%k.next", "%until", "step", "ended")
        self._segment_end()

    def _mixed(self, new: dict[str, str], valid: str) -> None:
        w = self.w
        self.label("mixed")
        alive = self._alive()
        go, fails = self._and(valid, alive), self._and(alive, self._not(valid))
        here = w.spread(w.emit("sitofp i64 %k to double"))
        changed = {name: (go, value) for name, value in new.items()}
        changed |= {"alive": (fails, w.splat(FAILED)), "count": (fails, here)}
        for name, (where, value) in changed.items():
            self.line(f"%{name}.mixed = select {w.mask} {where}, {self.v} {value}, {self.v} %{name}")
        self.line(f"%whole.mixed = and i1 {w.all(go)}, true")
        self.line(f"%going.mixed = or i1 {w.any(go)}, false")
        self.line("br label %made")

    def _segment_end(self) -> None:
        """Store the points at a stop, and go there, or back to the points before a micro-step."""
        w = self.w
        self.label("ended")
        self.line("br i1 %stops.here, label %output, label %onwards")
        self.label("output")
        first = w.emit(f"mul i64 %next.stop, {self.n}")
        for i in range(self.n):
            place = self._place("%out", w.emit(f"add i64 {first}, {i}"))
            self.line(f"store {self.v} %x{i}.made, ptr {place}, align 8")
        self.line("br label %onwards")
        self.label("onwards")
        for name in self.names:
            old = f"%{name}.old" if name.startswith(("x", "e")) else f"%{name}.made"
            self.line(f"%{name}.next = select i1 %within, {self.v} {old}, {self.v} %{name}.made")
        passed = w.emit("zext i1 %stops.here to i64")
        self.line(f"%stop.after = add i64 %next.stop, {passed}", "%k.after = select i1 %within, i64 %k, i64 %k.next")
        kept = w.emit(f"and i1 %keeps, {w.emit('xor i1 %within, true')}")
        moved = w.emit(f"fcmp ogt {self.v} %alive.made, {w.splat(0.0)}")
        self._store_path(kept, {"t": w.spread("%there"), "h": self._select(moved, self.h, w.splat(0.0))}, "segment.end")
        self._go_on("%k.after", "%end", "segment", "block.end")


@final
class _OwnSizes(_RunWriter):
    """Steps of each lane's own size: `stops` are the times of its stops, the last of them the end.

    A lane that has reached a stop stores the point there, and goes on to the next stop within the same step; at the
    end it is `DONE`. If a step is rejected, the stops within it are sought again (`kept` is the first of them).
    The number of the next step of the last block is left in `begin`.
    """

    def _loop_head(self, state: dict[str, str], before: str) -> None:
        start = self._at_stops(state["stop"])
        super()._loop_head(state, before)
        self.line(f"%stop.time = phi {self.v} [{start}, %{before}], [%stop.time.next, %step.end]")

    def _at_stops(self, number: str) -> str:
        """The times of the stops of these numbers."""
        places = [self.w.emit(f"getelementptr double, ptr %stops, i64 {i}") for i in self._integers(number)]
        w, vector = self.w, "poison"
        for lane, place in enumerate(places):
            x = w.emit(f"load double, ptr {place}, align 8")
            vector = x if w.width == 1 else w.emit(f"insertelement {self.v} {vector}, double {x}, i32 {lane}")
        return vector

    def _integers(self, number: str) -> list[str]:
        """A vector of doubles as an integer for each lane."""
        w = self.w
        kind = "i64" if w.width == 1 else f"<{w.width} x i64>"
        integers = w.emit(f"fptosi {self.v} {number} to {kind}")
        if w.width == 1:
            return [integers]
        return [w.emit(f"extractelement {kind} {integers}, i32 {i}") for i in range(w.width)]

    def _loop(self) -> None:
        w, v, graph = self.w, self.v, self.graph
        body = self._body({self.n: "%t", self.n + 1: "%h", self.n + 2: "%stop.time"})
        more = w.emit(f"fadd {v} %count, {w.splat(1.0)}")
        new = {f"x{i}": body.name(x) for i, x in enumerate(graph.point)} | self._recorded(body) | {"count": more}
        new["t"] = w.emit(
            f"fadd {v} {w.spread('%origin')}, {w.emit(f'fmul {v} {more}, %h')}"  # so that round-off does not add up
            if graph.elapsed is None
            else f"fadd {v} %t, {body.name(graph.elapsed)}"
        )
        if graph.sizes is not None:
            tries = w.emit(f"fadd {v} %tries, {w.splat(1.0)}")
            new |= {"h": body.name(graph.sizes.proposal), "tries": tries, "kept": "%stop"}
        reached = w.splat(False) if graph.reached is None else body.name(graph.reached)
        valid = self._and(self._valid(body), self._alive())
        accepted = w.splat(True) if graph.sizes is None else body.name(graph.sizes.accepted)
        plain = self._and(self._and(valid, accepted), self._not(reached))
        before = w.label
        self.line(f"br i1 {w.all(plain)}, label %made, label %mixed, !prof !1")
        self._mixed(new, valid, accepted, reached)
        self.label("made")
        size = "%h" if graph.tried is None else body.name(graph.tried)
        self.line(
            *[
                f"%{name}.next = phi {v} [{new.get(name, f'%{name}')}, %{before}], [%{name}.mixed, %mixed.end]"
                for name in self.names
            ],
            f"%stop.time.next = phi {v} [%stop.time, %{before}], [%stop.time.mixed, %mixed.end]",
            f"%moved = phi {w.mask} [{w.splat(True)}, %{before}], [%moved.mixed, %mixed.end]",
            f"%going = phi i1 [true, %{before}], [%going.mixed, %mixed.end]",
        )
        moved = self._select("%moved", size, w.splat(0.0))
        self._store_path("%keeps", {"t": "%t.next", "h": moved}, "step.end")
        self.line("%k.next = add i64 %k, 1", "store i64 %k.next, ptr %begin.place, align 8")
        self._go_on("%k.next", "%end", "step", "block.end")

    def _mixed(self, new: dict[str, str], valid: str, accepted: str, reached: str) -> None:
        """Lanes that do different things: move, reach a stop or the end, try another size, fail."""
        w, v = self.w, self.v
        self.label("mixed")
        last = w.spread(w.emit("sitofp i64 %last_stop to double"))
        ends = self._and(reached, w.emit(f"fcmp oge {v} %stop, {last}"))
        stops = self._and(self._and(valid, reached), self._not(ends))
        full = self._and(valid, self._not(stops))
        moved = self._and(full, accepted)
        done = self._and(moved, ends)
        self.line(f"%moved.mixed = and {w.mask} {moved}, {moved}")
        changed = {name: self._select(moved, value, f"%{name}") for name, value in new.items()}
        changed["t"] = self._select(done, "%stop.time", changed["t"])
        changed["stop"] = self._select(stops, w.emit(f"fadd {v} %stop, {w.splat(1.0)}"), "%stop")
        if self.graph.sizes is not None:
            changed |= {name: self._select(full, new[name], f"%{name}") for name in ("h", "tries")}
            rejected = self._and(full, self._not(accepted))
            changed["stop"] = self._select(rejected, "%kept", changed["stop"])
        changed["alive"] = self._select(valid, w.splat(ALIVE), self._select(self._alive(), w.splat(FAILED), "%alive"))
        changed["alive"] = self._select(done, w.splat(DONE), changed["alive"])
        for name in self.names:
            self.line(f"%{name}.mixed = fadd {v} {changed.get(name, f'%{name}')}, {w.splat(-0.0)}")
        self.line(f"%stop.time.mixed = fadd {v} {self._at_stops(changed['stop'])}, {w.splat(-0.0)}")
        alive = w.emit(f"fcmp ogt {v} %alive.mixed, {w.splat(0.0)}")
        self.line(f"%going.mixed = or i1 {w.any(alive)}, false")
        unused = w.emit(f"fadd {v} {last}, {w.splat(1.0)}")  # a row of `out` that is not read
        some = w.emit(f"or {w.mask} {stops}, {done}")
        row = self._select(some, "%stop", unused)
        self.line(f"br i1 {w.any(some)}, label %output, label %mixed.end")
        self._store(row, new)

    def _store(self, row: str, new: dict[str, str]) -> None:
        """Store the points of the lanes in the rows of these numbers."""
        w = self.w
        self.label("output")
        for lane, place_of in enumerate(self._integers(row)):
            place = w.emit(f"add i64 %lane, {lane}")
            first = w.emit(f"mul i64 {place_of}, {self.n}")
            for i in range(self.n):
                start = w.emit(f"mul i64 {w.emit(f'add i64 {first}, {i}')}, %lanes")
                here = w.emit(f"getelementptr double, ptr %out, i64 {w.emit(f'add i64 {start}, {place}')}")
                x = new[f"x{i}"]
                x = x if w.width == 1 else w.emit(f"extractelement {self.v} {x}, i32 {lane}")
                self.line(f"store double {x}, ptr {here}, align 8")
        self.line("br label %mixed.end")
        self.label("mixed.end")
        self.line("br label %made")
