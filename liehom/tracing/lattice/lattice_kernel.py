"""LatticeKernel: machine code of the stages of a step, each of them for all sites of a lattice.

A stage computes psi at a site from the numbers that earlier stages stored there and at shifted sites, and stores the
point at which the next stage needs psi. Numbers are stored in planes, one for each coordinate, with a margin that
repeats the sites on the other side of the lattice; a row of sites is computed W at a time.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TypeAlias, final

import numpy as np

from liehom.tracing.expr import Expr
from liehom.tracing.graph import needed
from liehom.tracing.lattice.lattice_array import SiteInputs
from liehom.tracing.machine_code.body import Body
from liehom.tracing.machine_code.machine import engine_of, lanes_per_register
from liehom.tracing.machine_code.writer import Writer
from liehom.typing import Array, IntegerArray

Plane: TypeAlias = tuple[str, int, int]
"""Plane: "m" the point, "y" points of stages, "f" values of psi, "e" the error, "w" noise, "array" given numbers."""

PAGE, SKEW = 512, 80
"""Planes begin 80 numbers beyond a multiple of 512: planes that begin alike compete for the same cache lines."""
SITES_FOR_THREADS = 20_000
"""Sites from which on threads share the rows of a stage."""
ARGUMENTS = "ptr %planes, ptr %rows, i64 %first, i64 %last, i64 %columns, double %time, double %size"


@final
@dataclass(slots=True)
class Stage:
    """A stage of a step at one site.

    Attributes
    ----------
    values : list of (Expr, Expr)
        Inputs of the graph that stand for values of psi, and their graphs, computed in this stage.
    stores : list of (plane, Expr)
        What the stage stores at the site.
    """

    values: list[tuple[Expr, Expr]] = field(default_factory=list)
    stores: list[tuple[Plane, Expr]] = field(default_factory=list)


@final
class Layout:
    """Positions of the sites of a lattice in a plane.

    Parameters
    ----------
    sites : tuple of int
    reach : tuple of int
        Largest shift along each axis.
    width : int
        Sites that are computed at once.

    Examples
    --------
    >>> layout = Layout((3,), (1,), 4)
    >>> plane = np.zeros(layout.size)
    >>> layout.interior(plane)[...] = [1.0, 2.0, 3.0]
    >>> plane[layout.targets] = plane[layout.sources]
    >>> plane[3:8].tolist()
    [3.0, 1.0, 2.0, 3.0, 1.0]
    """

    def __init__(self, sites: tuple[int, ...], reach: tuple[int, ...], width: int) -> None:
        self.sites, self.reach = sites, reach
        columns = -(-sites[-1] // width) * width
        left = -(-reach[-1] // width) * width  # rows begin at multiples of the width
        row = left + max(columns, sites[-1] + reach[-1])
        self.shape = (*(n + 2 * r for n, r in zip(sites[:-1], reach[:-1], strict=True)), -(-row // width) * width)
        self.first = (*reach[:-1], left)
        self.size = -(-(int(np.prod(self.shape)) + width) // PAGE) * PAGE + SKEW
        self.strides = tuple(int(np.prod(self.shape[k + 1 :])) for k in range(len(sites)))
        starts = [np.arange(n) + a for n, a in zip(sites[:-1], self.first[:-1], strict=True)]
        places = np.zeros((1,) * max(len(starts), 1), dtype=np.int64)
        for k, start in enumerate(starts):
            places = places + (start * self.strides[k]).reshape([-1 if i == k else 1 for i in range(len(starts))])
        self.rows: IntegerArray = (places.reshape(-1) + left).astype(np.int64)
        self.targets, self.sources = self._margins()

    def _margins(self) -> tuple[IntegerArray, IntegerArray]:
        """Positions in the margins, and of the sites that they repeat."""
        ranges = [np.arange(-r, n + r) for n, r in zip(self.sites, self.reach, strict=True)]
        grid = np.stack(np.meshgrid(*ranges, indexing="ij"), axis=-1).reshape(-1, len(self.sites))
        sites = np.array(self.sites)
        outside = ((grid < 0) | (grid >= sites)).any(axis=-1)
        targets, strides = grid[outside], np.array(self.strides)
        return (targets + self.first) @ strides, (targets % sites + self.first) @ strides

    def interior(self, plane: Array) -> Array:
        """A view of the sites of a plane, of the shape of the lattice."""
        whole: Array = plane[: int(np.prod(self.shape))].reshape(self.shape)
        return whole[tuple(slice(a, a + n) for a, n in zip(self.first, self.sites, strict=True))]

    def distance(self, offset: Sequence[int]) -> int:
        """Difference of the positions of a shifted site and the site."""
        return sum(a * b for a, b in zip(offset, self.strides, strict=True))


@final
class LatticeKernel:
    """Machine code of the stages of a step on a lattice, and the planes that it works on.

    Parameters
    ----------
    inputs : SiteInputs
    stages : list of Stage
        The last one stores the planes ("m", 0, c) of the point after the step.
    time, size : Expr
        Inputs of the graph.
    coordinates : int
        N.
    """

    def __init__(self, inputs: SiteInputs, stages: list[Stage], time: Expr, size: Expr, coordinates: int) -> None:
        self.stages, self.coordinates, self._inputs = stages, coordinates, inputs
        self._scalars = {time.value: "%t", size.value: "%h"}
        self._bound = {x.value: (k, graph) for k, stage in enumerate(stages) for x, graph in stage.values}
        self._loads: list[dict[int, tuple[Plane, tuple[int, ...]]]] = [self._loaded(k) for k in range(len(stages))]
        self._store_values()
        reach = np.zeros((1, len(inputs.sites)), dtype=int)
        shifts = [offset for loads in self._loads for _, offset in loads.values()]
        width = lanes_per_register()
        self.layout = Layout(
            inputs.sites, tuple(int(r) for r in np.abs(np.concatenate([reach, np.array(shifts)])).max(axis=0)), width
        )
        # the last stage writes over the point that it reads at the site, unless it reads it at shifted sites too
        self.swaps = any(plane[0] == "m" and any(offset) for plane, offset in self._loads[-1].values())
        names = [plane for loads in self._loads for plane, _ in loads.values()]
        names += [self._target(k, plane) for k, stage in enumerate(stages) for plane, _ in stage.stores]
        names += [("m", 0, c) for c in range(coordinates)]
        self.places = {plane: i for i, plane in enumerate(dict.fromkeys(names))}
        self._shifted = {plane for loads in self._loads for plane, offset in loads.values() if any(offset)}
        self.planes: Array = np.zeros((len(self.places), self.layout.size))
        for plane, i in self.places.items():
            if plane[0] == "array":
                self.layout.interior(self.planes[i])[...] = inputs.arrays[plane[1]]
                self.planes[i][self.layout.targets] = self.planes[i][self.layout.sources]
        step = self.planes.strides[0]
        self._table = (self.planes.ctypes.data + step * np.arange(len(self.planes))).astype(np.uint64)
        self.text: str = self._module(width)
        self._engine, self.cached = engine_of(self.text)
        self._functions = {
            name: ctypes.CFUNCTYPE(None, *kinds)(self._engine.get_function_address(name))
            for name, kinds in self._signatures().items()
        }

    # -- what is loaded and stored -----------------------------------------------------------------------
    def _graphs(self, k: int) -> list[Expr]:
        """All operations of a stage, values of psi that it needs first."""
        stores = needed([x for _, x in self.stages[k].stores])
        here = [graph for x, graph in self.stages[k].values if x in stores or self._later(x, k)]
        return [*needed(here), *stores]

    def _later(self, x: Expr, k: int) -> bool:
        return any(plane[0] == "f" and y.value == x.value for plane, y in self.stages[k].stores)

    def _loaded(self, k: int) -> dict[int, tuple[Plane, tuple[int, ...]]]:
        """(plane, offset) of the inputs that a stage loads."""
        found: dict[int, tuple[Plane, tuple[int, ...]]] = {}
        for x in self._graphs(k):
            if x.op != "input" or x.value in self._scalars:
                continue
            if x.value in self._inputs.loads:
                found[x.value] = self._inputs.loads[x.value]
            elif self._bound[x.value][0] != k:
                found[x.value] = ("f", int(x.value), 0), (0,) * len(self._inputs.sites)
        return found

    def _store_values(self) -> None:
        """Let stages store the values of psi that later stages load."""
        wanted = {plane[1] for loads in self._loads for plane, _ in loads.values() if plane[0] == "f"}
        for stage in self.stages:
            stage.stores += [(("f", int(x.value), 0), x) for x, _ in stage.values if x.value in wanted]
        self._loads = [self._loaded(k) for k in range(len(self.stages))]

    def _target(self, k: int, plane: Plane) -> Plane:
        """The plane to which a stage writes: another one for the point if the stage reads it at shifted sites."""
        return ("out", 0, plane[2]) if plane[0] == "m" and self.swaps else plane

    # -- assembly ----------------------------------------------------------------------------------------
    def _module(self, width: int) -> str:
        declared: dict[str, str] = {}
        functions: dict[str, str] = {}
        stages = []
        for k in range(len(self.stages)):
            w = Writer(width)
            w.label = "column"
            self._write_stage(w, k)
            declared |= w.declared
            functions |= w.functions
            stages.append("\n".join(w.lines))
        attributes = (
            'attributes #0 = { nounwind "prefer-vector-width"="512" }\n!0 = !{!"branch_weights", i32 1, i32 1000}\n'
        )
        parts = ["\n".join(dict.fromkeys(declared.values())), *functions.values(), *stages, _MARGINS, self._loop()]
        return "\n\n".join([*parts, attributes])

    def _write_stage(self, w: Writer, k: int) -> None:
        v, stage, loads = w.vector, self.stages[k], self._loads[k]
        used = dict.fromkeys([*(p for p, _ in loads.values()), *(self._target(k, p) for p, _ in stage.stores)])
        w.lines += [f"define void @stage{k}({ARGUMENTS}) #0 {{", "entry:"]
        for plane in used:
            place = w.emit(f"getelementptr ptr, ptr %planes, i64 {self.places[plane]}")
            w.lines.append(f"  %p{self.places[plane]} = load ptr, ptr {place}")
        w.lines.append(f"  %t = fadd {v} {w.spread('%time')}, {w.splat(-0.0)}")
        w.lines.append(f"  %h = fadd {v} {w.spread('%size')}, {w.splat(-0.0)}")
        w.lines += ["  br label %row", "row:", "  %r = phi i64 [%first, %entry], [%r.next, %row.end]"]
        w.lines += ["  %place = getelementptr i64, ptr %rows, i64 %r", "  %base = load i64, ptr %place"]
        w.lines += ["  br label %column", "column:"]
        w.lines += ["  %c = phi i64 [0, %row], [%c.next, %column.end]", "  %at = add i64 %base, %c"]
        names = dict(self._scalars)
        for index, (plane, offset) in loads.items():
            at = w.emit(f"add i64 %at, {self.layout.distance(offset)}")
            pointer = w.emit(f"getelementptr double, ptr %p{self.places[plane]}, i64 {at}")
            names[index] = w.emit(f"load {v}, ptr {pointer}, align 8")
        body = Body(w, names)
        kept = {x.index for x in self._graphs(k)}
        for x, graph in stage.values:
            if x.index in kept or graph.index in kept:
                body.write(needed([graph]))
                names[x.value] = body.name(graph)
        body.write(needed([x for _, x in stage.stores]))
        for plane, x in stage.stores:
            pointer = w.emit(f"getelementptr double, ptr %p{self.places[self._target(k, plane)]}, i64 %at")
            w.lines.append(f"  store {v} {body.name(x)}, ptr {pointer}, align 8")
        w.lines += ["  br label %column.end", "column.end:", f"  %c.next = add i64 %c, {w.width}"]
        w.lines += ["  %wide = icmp slt i64 %c.next, %columns", "  br i1 %wide, label %column, label %row.end"]
        w.lines += ["row.end:", "  %r.next = add i64 %r, 1", "  %more = icmp slt i64 %r.next, %last"]
        w.lines += ["  br i1 %more, label %row, label %done", "done:", "  ret void", "}"]

    def _loop(self) -> str:
        """The function `run`: all stages of the steps begin, ..., end - 1, margins included."""
        lines = [
            "define void @run(ptr %planes, ptr %rows, i64 %nrows, i64 %columns, ptr %to, ptr %from, i64 %margin, "
            "i64 %begin, i64 %end, double %origin, double %size) #0 {",
            "entry:",
            "  br label %step",
            "step:",
            "  %k = phi i64 [%begin, %entry], [%k.next, %step]",
            "  %count = sitofp i64 %k to double",
            "  %passed = fmul double %count, %size",
            "  %time = fadd double %origin, %passed",
        ]
        for k in range(len(self.stages)):
            lines.append(
                f"  call void @stage{k}(ptr %planes, ptr %rows, i64 0, i64 %nrows, i64 %columns, double %time, "
                "double %size)"
            )
            lines += self._after(k)
        lines += ["  %k.next = add i64 %k, 1", "  %more = icmp slt i64 %k.next, %end"]
        return "\n".join([*lines, "  br i1 %more, label %step, label %done", "done:", "  ret void", "}"])

    def _after(self, k: int) -> list[str]:
        """Calls that fill the margins of the planes that a stage stored, and exchange the point and the new one."""
        lines = []
        for j, (plane, _) in enumerate(self.stages[k].stores):
            name, target = f"s{k}.{j}", self._target(k, plane)
            if plane in self._shifted:
                lines.append(f"  %{name} = getelementptr ptr, ptr %planes, i64 {self.places[target]}")
                lines.append(f"  %{name}.p = load ptr, ptr %{name}")
                lines.append(f"  call void @margins(ptr %{name}.p, ptr %to, ptr %from, i64 %margin)")
            if target != plane:
                lines.append(f"  %{name}.a = getelementptr ptr, ptr %planes, i64 {self.places[plane]}")
                lines.append(f"  %{name}.b = getelementptr ptr, ptr %planes, i64 {self.places[target]}")
                lines.append(f"  %{name}.old = load ptr, ptr %{name}.a")
                lines.append(f"  %{name}.new = load ptr, ptr %{name}.b")
                lines.append(f"  store ptr %{name}.new, ptr %{name}.a")
                lines.append(f"  store ptr %{name}.old, ptr %{name}.b")
        return lines

    # -- steps -------------------------------------------------------------------------------------------
    def _signatures(self) -> dict[str, list[type]]:
        p, i, d = ctypes.c_void_p, ctypes.c_int64, ctypes.c_double
        stages: dict[str, list[type]] = {f"stage{k}": [p, p, i, i, i, d, d] for k in range(len(self.stages))}
        return {**stages, "margins": [p, p, p, i], "run": [p, p, i, i, p, p, i, i, i, d, d]}

    def put(self, m: Array, name: str = "m") -> None:
        """Store numbers (*sites, N) as the point, or as the noise "w"."""
        for c in range(self.coordinates):
            if (name, 0, c) not in self.places:
                continue
            plane = self._plane((name, 0, c))
            self.layout.interior(plane)[...] = m[..., c]
            plane[self.layout.targets] = plane[self.layout.sources]

    def get(self, name: str = "m") -> Array:
        """The point (*sites, N), or the error "e"."""
        return np.stack([self.layout.interior(self._plane((name, 0, c))) for c in range(self.coordinates)], axis=-1)

    def run(self, begin: int, end: int, origin: float, size: float, workers: int = 1) -> None:
        """Make the steps begin, ..., end - 1 of a size; step k begins at the time origin + k size."""
        layout, table = self.layout, self._table.ctypes.data
        rows, columns = layout.rows, layout.sites[-1]
        margins = (layout.targets.ctypes.data, layout.sources.ctypes.data, len(layout.targets))
        if workers <= 1 or layout.size < SITES_FOR_THREADS:
            self._functions["run"](table, rows.ctypes.data, len(rows), columns, *margins, begin, end, origin, size)
            return
        cuts = [(int(a), int(b)) for a, b in pairwise(np.linspace(0, len(rows), workers + 1).astype(int)) if b > a]
        with ThreadPoolExecutor(len(cuts)) as pool:
            for k in range(begin, end):
                for j, stage in enumerate(self.stages):
                    function, time = self._functions[f"stage{j}"], origin + k * size
                    jobs = [pool.submit(function, table, rows.ctypes.data, a, b, columns, time, size) for a, b in cuts]
                    for job in jobs:
                        job.result()
                    for plane, _ in stage.stores:
                        target = self._target(j, plane)
                        if plane in self._shifted:
                            self._functions["margins"](int(self._table[self.places[target]]), *margins)
                        if target != plane:
                            a, b = self.places[plane], self.places[target]
                            self._table[[a, b]] = self._table[[b, a]]

    def _plane(self, plane: Plane) -> Array:
        """The plane of a name: the planes of the point and of the new one change places."""
        offset = int(self._table[self.places[plane]]) - self.planes.ctypes.data
        found: Array = self.planes[offset // self.planes.strides[0]]
        return found


_MARGINS = """define void @margins(ptr %plane, ptr %to, ptr %from, i64 %count) #0 {
entry:
  %some = icmp sgt i64 %count, 0
  br i1 %some, label %next, label %done
next:
  %i = phi i64 [0, %entry], [%i.next, %next]
  %from.i = getelementptr i64, ptr %from, i64 %i
  %to.i = getelementptr i64, ptr %to, i64 %i
  %source = load i64, ptr %from.i
  %target = load i64, ptr %to.i
  %source.p = getelementptr double, ptr %plane, i64 %source
  %target.p = getelementptr double, ptr %plane, i64 %target
  %value = load double, ptr %source.p
  store double %value, ptr %target.p
  %i.next = add i64 %i, 1
  %more = icmp slt i64 %i.next, %count
  br i1 %more, label %next, label %done
done:
  ret void
}"""
