"""Fields on lattices: one site traced, all sites compiled."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from itertools import count
from typing import Any, TypeAlias, final

import numpy as np
import numpy.typing as npt
from numpy.lib.mixins import NDArrayOperatorsMixin

from liehom.base.errors import TraceError
from liehom.base.typing import Array, IntegerArray, Key
from liehom.flow.tracing.array import Operand, Traced, expr_array
from liehom.flow.tracing.graph import Expr, Tape, needed
from liehom.flow.tracing.llvm_text import Body, Writer
from liehom.flow.tracing.machine import engine_of, lanes_per_register

# LatticeTraced: values at one site of a lattice, on which numpy code for the whole lattice runs.
#
# Its shape is (n_1, ..., n_L, ...) as for arrays of values at all sites, but it holds one site only. Functions of the
# last axes run on that site. np.roll along an axis of the lattice shifts the sites at which numbers are loaded, and
# arrays of numbers over the lattice become loads too.

Offset = tuple[int, ...]  # a shift of sites, one integer for each axis of the lattice

MATRIX_PRODUCTS = frozenset(["matmul", "matvec", "vecmat"])
REDUCTIONS = frozenset(["sum", "max", "min", "amax", "amin", "prod", "mean", "all", "any", "norm", "cumsum"])


@final
class SiteInputs:
    """The inputs of a graph that are loaded at a site of the lattice or at a shifted one."""

    def __init__(self, tape: Tape, sites: tuple[int, ...]) -> None:
        self.tape, self.sites = tape, sites
        self.loads: dict[int, tuple[tuple[str, int, int], Offset]] = {}  # by the index of an input
        self.arrays: list[Array] = []  # over the lattice: the planes ("array", number, 0)
        self._known: dict[tuple[tuple[str, int, int], Offset], Expr] = {}
        self._numbers = count()

    def fresh(self) -> Expr:
        """A new input that is not loaded, such as the time."""
        return self.tape.input(next(self._numbers))

    def load(self, plane: tuple[str, int, int], offset: Offset) -> Expr:
        """The number of a plane at a shifted site."""
        if (plane, offset) not in self._known:
            self._known[plane, offset] = self.fresh()
            self.loads[self._known[plane, offset].value] = plane, offset
        return self._known[plane, offset]

    def array(self, values: Array) -> Expr:
        """The number of an array over the lattice at the site; arrays that are equal everywhere are constants."""
        first = float(values.flat[0])
        if bool((values == first).all()):
            return self.tape.constant(first)
        number = next((i for i, a in enumerate(self.arrays) if np.array_equal(a, values)), None)
        if number is None:
            number = len(self.arrays)
            self.arrays.append(np.array(values, dtype=np.float64))
        return self.load(("array", number, 0), (0,) * len(self.sites))

    def shifted(self, x: Expr, offset: Offset) -> Expr:
        """A number at the site that is shifted by an offset."""
        known: dict[int, Expr] = {}

        def moved(y: Expr) -> Expr:
            if y.index not in known:
                if y.op == "input" and y.value in self.loads:
                    plane, own = self.loads[y.value]
                    known[y.index] = self.load(plane, tuple(a + b for a, b in zip(own, offset, strict=True)))
                elif not y.args:
                    known[y.index] = y
                else:
                    known[y.index] = self.tape.again(y, tuple(moved(a) for a in y.args))
            return known[y.index]

        return moved(x)


@final
class LatticeTraced(NDArrayOperatorsMixin):
    """Values at one site of a lattice, with the shape of an array over the lattice."""

    inner: Traced
    inputs: SiteInputs

    __slots__ = ("inner", "inputs")
    __array_priority__: float = 200.0
    __hash__ = object.__hash__

    def __init__(self, inputs: SiteInputs, inner: Traced) -> None:
        if inner.shape[: len(inputs.sites)] != (1,) * len(inputs.sites):
            raise TraceError("psi mixes sites of the lattice other than by np.roll, which is not compiled")
        self.inputs, self.inner = inputs, inner

    @property
    def shape(self) -> tuple[int, ...]:
        """Tuple of axis lengths, as for arrays over the lattice."""
        return (*self.inputs.sites, *self.inner.shape[len(self.inputs.sites) :])

    @property
    def ndim(self) -> int:
        """Number of axes."""
        return self.inner.ndim

    @property
    def size(self) -> int:
        """Number of entries of the whole lattice."""
        return int(np.prod(self.shape, dtype=int))

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of the entries, float64 or bool."""
        return self.inner.dtype

    def __getitem__(self, key: Key) -> LatticeTraced:
        parts = key if isinstance(key, tuple) else (key,)
        if parts[:1] != (Ellipsis,) and any(part != slice(None) for part in parts[: len(self.inputs.sites)]):
            raise TraceError("sites of the lattice are picked by an index, which is not compiled: write np.roll")
        return LatticeTraced(self.inputs, self.inner[key])

    def __len__(self) -> int:
        return self.shape[0]

    def reshape(self, *shape: Operand) -> LatticeTraced:
        """Array with other last axes."""
        wanted = tuple(shape[0]) if len(shape) == 1 and not isinstance(shape[0], int) else shape
        lattice = len(self.inputs.sites)
        if wanted[:lattice] != self.inputs.sites:
            raise TraceError("psi reshapes the axes of the lattice, which is not compiled")
        return LatticeTraced(self.inputs, self.inner.reshape((1,) * lattice + wanted[lattice:]))

    def __bool__(self) -> bool:
        return bool(self.inner)

    # -- numpy's protocols -------------------------------------------------------------------------------
    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> npt.NDArray[Any]:
        raise TraceError(
            "psi makes an array of numbers of values on the lattice, which compiled code does not know yet"
        )

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: object, **options: Operand) -> Operand:
        if any(type(x).__name__ == "Jet" for x in inputs):
            return NotImplemented
        out = options.pop("out", None)
        if method != "__call__":
            raise TraceError(f"np.{ufunc.__name__}.{method} cannot be compiled on a lattice")
        inner = max(x.ndim for x in inputs if isinstance(x, LatticeTraced))
        # a matrix has two axes of its own
        matrices = ufunc.__name__ in MATRIX_PRODUCTS
        values = [
            x if matrices and isinstance(x, np.ndarray) and x.ndim == 2 else self._at_site(x, inner) for x in inputs
        ]
        result = LatticeTraced(self.inputs, ufunc(*values, **options))
        if out is None:
            return result
        if not isinstance(out[0], LatticeTraced):
            raise TraceError(f"np.{ufunc.__name__} writes into an array of floats: use x = x + y in place of x += y")
        out[0].inner.entries[...] = result.inner.entries
        return out[0]

    def __array_function__(
        self, function: Callable[..., Any], types: Iterable[type], args: tuple[Operand, ...],
        options: dict[str, Operand],
    ) -> Operand:  # fmt: skip
        name, sites = function.__name__, self.inputs.sites
        first = args[0] if args else None
        if name == "roll":
            return self._rolled(*args, **options)
        if name in ("shape", "ndim") and isinstance(first, LatticeTraced):
            return getattr(first, name)
        if name == "broadcast_to" and isinstance(first, LatticeTraced):
            shape = (1,) * len(sites) + tuple(args[1])[len(sites) :]
            return LatticeTraced(self.inputs, Traced(self.inputs.tape, np.broadcast_to(first.inner.entries, shape)))
        if name in REDUCTIONS and isinstance(first, LatticeTraced):
            axis = args[1] if len(args) > 1 and name != "norm" else options.get("axis")
            axes = (axis,) if isinstance(axis, int) else tuple(axis or ())
            if not axes or any(a % first.ndim < len(sites) for a in axes):
                raise TraceError(
                    f"np.{name} over the sites of the lattice is not compiled: sum over the last axes only"
                )
        inner = max(_dimensions(args), _dimensions(tuple(options.values())))
        result = function(*self._at_sites(args, inner), **{k: self._at_sites(v, inner) for k, v in options.items()})
        if isinstance(result, list | tuple):
            return type(result)(LatticeTraced(self.inputs, x) for x in result)
        return LatticeTraced(self.inputs, result) if isinstance(result, Traced) else result

    def _rolled(self, x: Operand, shift: Operand, axis: Operand = None) -> LatticeTraced:
        lattice = len(self.inputs.sites)
        if axis is None or not isinstance(x, LatticeTraced):
            raise TraceError("np.roll without an axis is not compiled on a lattice")
        rolled, offset = x.inner.entries, [0] * lattice
        for number, place in np.broadcast(shift, axis):
            if int(place) % x.ndim < lattice:
                offset[int(place) % x.ndim] -= int(number)
            else:
                rolled = np.roll(rolled, int(number), axis=int(place))
        entries = np.empty(rolled.shape, dtype=object)
        for index, entry in np.ndenumerate(rolled):
            entries[index] = self.inputs.shifted(entry, tuple(offset))
        return LatticeTraced(self.inputs, Traced(self.inputs.tape, entries))

    def _at_sites(self, x: Operand, inner: int) -> Operand:
        if isinstance(x, list | tuple) and any(isinstance(e, LatticeTraced | np.ndarray | list | tuple) for e in x):
            return type(x)(self._at_sites(e, inner) for e in x)
        return self._at_site(x, inner)

    def _at_site(self, x: Operand, ndim: int) -> Operand:
        """A value at the site; an array with the axes of the lattice becomes one load for each of its last entries."""
        if isinstance(x, LatticeTraced):
            return x.inner
        lattice = len(self.inputs.sites)
        inner = ndim - lattice
        if not isinstance(x, np.ndarray) or x.ndim <= inner or x.dtype.kind not in "biuf":
            return x
        own = x.reshape((1,) * (ndim - x.ndim) + x.shape)
        if own.shape[:lattice] == (1,) * lattice:
            return own
        everywhere = np.broadcast_to(own, (*self.inputs.sites, *own.shape[lattice:]))
        entries = np.empty(own.shape[lattice:], dtype=object)
        for index in np.ndindex(entries.shape):
            load = self.inputs.array(everywhere[(slice(None),) * lattice + index])
            entries[index] = self.inputs.tape.truth(load) if x.dtype.kind == "b" else load
        return Traced(self.inputs.tape, expr_array(self.inputs.tape, entries.reshape((1,) * lattice + entries.shape)))


def _dimensions(x: Operand) -> int:
    """The largest number of axes of a lattice array among arguments."""
    if isinstance(x, LatticeTraced):
        return x.ndim
    return max(map(_dimensions, x), default=0) if isinstance(x, list | tuple) else 0


# LatticeKernel: machine code of the stages of a step, each of them for all sites of a lattice.
#
# A stage computes psi at a site from the numbers that earlier stages stored there and at shifted sites, and stores the
# point of the next stage. Numbers are stored in planes, one for each coordinate, with a margin that repeats the sites
# on the other side of the lattice. A stage goes through a plane from the first site to the last, W positions at a time;
# what it stores in the margins between them is replaced.

Plane: TypeAlias = tuple[str, int, int]
"""Plane: "m" the point, "y" points of stages, "f" values of psi, "e" the error, "w" noise, "array" given numbers."""

PAGE, SKEW = 512, 80
"""Planes begin 80 numbers beyond a multiple of 512: planes that begin alike compete for the same cache lines."""
SITES_FOR_THREADS = 20_000  # sites from which on threads share a stage


@final
@dataclass(slots=True)
class Stage:
    """A stage of a step at one site."""

    values: list[tuple[Expr, Expr]] = field(default_factory=list)  # inputs for values of psi, and their graphs
    stores: list[tuple[Plane, Expr]] = field(default_factory=list)  # what is stored at the site


@final
class Layout:
    """Positions of the sites of a lattice in a plane, with margins of given widths."""

    def __init__(self, sites: tuple[int, ...], reach: tuple[int, ...], width: int) -> None:
        self.sites, self.reach = sites, reach
        self.shape = tuple(n + 2 * r for n, r in zip(sites, reach, strict=True))
        self.strides = tuple(int(np.prod(self.shape[k + 1 :])) for k in range(len(sites)))
        self.begin = self.distance(reach)
        self.end = self.begin + self.distance(tuple(n - 1 for n in sites)) + 1
        self.size = -(-(int(np.prod(self.shape)) + width) // PAGE) * PAGE + SKEW
        self.targets, self.sources = self._margins()

    def _margins(self) -> tuple[IntegerArray, IntegerArray]:
        """Positions in the margins, and of the sites that they repeat."""
        ranges = [np.arange(-r, n + r) for n, r in zip(self.sites, self.reach, strict=True)]
        grid = np.stack(np.meshgrid(*ranges, indexing="ij"), axis=-1).reshape(-1, len(self.sites))
        sites, strides = np.array(self.sites), np.array(self.strides)
        targets = grid[((grid < 0) | (grid >= sites)).any(axis=-1)]
        return (targets + self.reach) @ strides, (targets % sites + self.reach) @ strides

    def interior(self, plane: Array) -> Array:
        """A view of the sites of a plane, of the shape of the lattice."""
        numbers = plane[: int(np.prod(self.shape))].reshape(self.shape)
        return numbers[tuple(slice(r, r + n) for r, n in zip(self.reach, self.sites, strict=True))]

    def distance(self, offset: Sequence[int]) -> int:
        """Difference of the positions of a shifted site and the site."""
        return sum(a * b for a, b in zip(offset, self.strides, strict=True))


@final
class LatticeKernel:
    """Machine code of the stages of a step on a lattice, and the planes that it works on."""

    def __init__(self, inputs: SiteInputs, stages: list[Stage], time: Expr, size: Expr, coordinates: int) -> None:
        self.stages, self.coordinates, self._inputs = stages, coordinates, inputs
        self._scalars = time.value, size.value
        self._bound = {x.value: (k, graph) for k, stage in enumerate(stages) for x, graph in stage.values}
        self._loads: list[dict[int, tuple[Plane, tuple[int, ...]]]] = [self._loaded(k) for k in range(len(stages))]
        self._store_values()
        loads = [load for loads in self._loads for load in loads.values()]
        reach = np.abs([(0,) * len(inputs.sites), *[offset for _, offset in loads]]).max(axis=0)
        width = lanes_per_register()
        self.layout = Layout(inputs.sites, tuple(map(int, reach)), width)
        # the last stage writes over the point that it reads at the site, unless it reads it at shifted sites too
        self.swaps = any(plane[0] == "m" and any(offset) for plane, offset in self._loads[-1].values())
        names = [
            *[plane for plane, _ in loads],
            *[self._target(plane) for stage in stages for plane, _ in stage.stores],
            *[("m", 0, c) for c in range(coordinates)],
        ]
        self.places = {plane: i for i, plane in enumerate(dict.fromkeys(names))}
        self._shifted = {plane for plane, offset in loads if any(offset)}
        self.planes: Array = np.zeros((len(self.places), self.layout.size))
        for plane, i in self.places.items():
            if plane[0] == "array":
                self._fill(self.planes[i], inputs.arrays[plane[1]])
        step = self.planes.strides[0]
        self._table = (self.planes.ctypes.data + step * np.arange(len(self.planes))).astype(np.uint64)
        self.text: str = self._module(width)
        self._engine, self.cached = engine_of(self.text)
        kinds = {"run": "piippiiidd"} | {f"{s}{k}": t for k in range(len(stages)) for s, t in _ARGUMENTS.items()}
        address = self._engine.get_function_address
        self._functions = {
            name: ctypes.CFUNCTYPE(None, *map(_KINDS.__getitem__, t))(address(name)) for name, t in kinds.items()
        }

    # -- what is loaded and stored -----------------------------------------------------------------------
    def _graphs(self, k: int) -> list[Expr]:
        """All operations of a stage, values of psi that it needs first."""
        stores = needed([x for _, x in self.stages[k].stores])
        later = {y.value for plane, y in self.stages[k].stores if plane[0] == "f"}
        return [*needed([graph for x, graph in self.stages[k].values if x in stores or x.value in later]), *stores]

    def _loaded(self, k: int) -> dict[int, tuple[Plane, tuple[int, ...]]]:
        """(plane, offset) of the inputs that a stage loads."""
        here = (0,) * len(self._inputs.sites)
        inputs = [x.value for x in self._graphs(k) if x.op == "input" and x.value not in self._scalars]
        return {
            i: self._inputs.loads[i] if i in self._inputs.loads else (("f", int(i), 0), here)
            for i in inputs
            if i in self._inputs.loads or self._bound[i][0] != k
        }

    def _store_values(self) -> None:
        """Let stages store the values of psi that later stages load."""
        wanted = {plane[1] for loads in self._loads for plane, _ in loads.values() if plane[0] == "f"}
        for stage in self.stages:
            stage.stores += [(("f", int(x.value), 0), x) for x, _ in stage.values if x.value in wanted]
        self._loads = [self._loaded(k) for k in range(len(self.stages))]

    def _target(self, plane: Plane) -> Plane:
        """The plane to which a stage writes: another one for the point if the stage reads it at shifted sites."""
        return ("out", 0, plane[2]) if plane[0] == "m" and self.swaps else plane

    # -- assembly ----------------------------------------------------------------------------------------
    def _module(self, width: int) -> str:
        writers = [self._stage(Writer(width), k) for k in range(len(self.stages))]
        declared = dict.fromkeys(text for w in writers for text in w.declared.values())
        functions = {name: text for w in writers for name, text in w.functions.items()}
        stages = ["\n".join(w.lines) for w in writers] + [self._after(k) for k in range(len(self.stages))]
        return "\n\n".join(["\n".join(declared), *functions.values(), *stages, _MARGINS, self._loop(), _ATTRIBUTES])

    def _stage(self, w: Writer, k: int) -> Writer:
        """Write the function of a stage, for the positions begin, ..., end - 1."""
        v, stage, loads, w.label = w.vector, self.stages[k], self._loads[k], "site"
        used = dict.fromkeys([*(p for p, _ in loads.values()), *(self._target(p) for p, _ in stage.stores)])
        w.lines += [
            f"define void @stage{k}(ptr %planes, i64 %begin, i64 %end, double %time, double %size) #0 {{",
            "entry:",
        ]
        for plane in used:
            place = w.emit(f"getelementptr ptr, ptr %planes, i64 {self.places[plane]}")
            w.lines.append(f"  %p{self.places[plane]} = load ptr, ptr {place}")
        names = dict(zip(self._scalars, map(w.spread, ("%time", "%size")), strict=True))
        w.lines += ["  br label %site", "site:", "  %at = phi i64 [%begin, %entry], [%next, %site.end]"]
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
            pointer = w.emit(f"getelementptr double, ptr %p{self.places[self._target(plane)]}, i64 %at")
            w.lines.append(f"  store {v} {body.name(x)}, ptr {pointer}, align 8")
        w.lines += ["  br label %site.end", "site.end:", f"  %next = add i64 %at, {w.width}"]
        w.lines += ["  %more = icmp slt i64 %next, %end", "  br i1 %more, label %site, label %done"]
        w.lines += ["done:", "  ret void", "}"]
        return w

    def _after(self, k: int) -> str:
        """The function that fills the margins of the planes that a stage stored, and exchanges the points."""
        lines = [f"define void @after{k}(ptr %planes, ptr %to, ptr %from, i64 %margin) #0 {{", "entry:"]
        for j, (plane, _) in enumerate(self.stages[k].stores):
            target = self._target(plane)
            if plane in self._shifted or target != plane:
                lines.append(f"  %a{j} = getelementptr ptr, ptr %planes, i64 {self.places[target]}")
                lines.append(f"  %new{j} = load ptr, ptr %a{j}")
            if plane in self._shifted:
                lines.append(f"  call void @margins(ptr %new{j}, ptr %to, ptr %from, i64 %margin)")
            if target != plane:
                lines.append(f"  %b{j} = getelementptr ptr, ptr %planes, i64 {self.places[plane]}")
                lines.append(f"  %old{j} = load ptr, ptr %b{j}")
                lines += [f"  store ptr %new{j}, ptr %b{j}", f"  store ptr %old{j}, ptr %a{j}"]
        return "\n".join([*lines, "  ret void", "}"])

    def _loop(self) -> str:
        """The function `run`: all stages of the steps first, ..., last - 1."""
        calls = [
            f"  call void @stage{k}(ptr %planes, i64 %begin, i64 %end, double %time, double %size)\n"
            f"  call void @after{k}(ptr %planes, ptr %to, ptr %from, i64 %margin)"
            for k in range(len(self.stages))
        ]
        return _RUN.replace("CALLS", "\n".join(calls))

    # -- steps -------------------------------------------------------------------------------------------
    def put(self, m: Array, name: str = "m") -> None:
        """Store numbers (*sites, N) as the point, or as the noise "w"."""
        for c in range(self.coordinates):
            if (name, 0, c) in self.places:
                self._fill(self._plane((name, 0, c)), m[..., c])

    def _fill(self, plane: Array, values: Array) -> None:
        """Store numbers at the sites of a plane and in its margins."""
        self.layout.interior(plane)[...] = values
        plane[self.layout.targets] = plane[self.layout.sources]

    def get(self, name: str = "m") -> Array:
        """The point (*sites, N), or the error "e"."""
        return np.stack([self.layout.interior(self._plane((name, 0, c))) for c in range(self.coordinates)], axis=-1)

    def run(self, first: int, last: int, origin: float, size: float, workers: int = 1) -> None:
        """Make the steps first, ..., last - 1 of a size; step k begins at the time origin + k size."""
        layout, table = self.layout, self._table.ctypes.data
        margins = layout.targets.ctypes.data, layout.sources.ctypes.data, len(layout.targets)
        if workers <= 1 or layout.size < SITES_FOR_THREADS:
            self._functions["run"](table, layout.begin, layout.end, *margins, first, last, origin, size)
            return
        # whole blocks: the positions behind the end of a block are those of another thread
        share = -(-(layout.end - layout.begin) // (workers * lanes_per_register())) * lanes_per_register()
        cuts = [(a, min(a + share, layout.end)) for a in range(layout.begin, layout.end, share)]
        with ThreadPoolExecutor(len(cuts)) as pool:
            for k in range(first, last):
                for j in range(len(self.stages)):
                    stage, time = self._functions[f"stage{j}"], origin + k * size
                    for job in [pool.submit(stage, table, a, b, time, size) for a, b in cuts]:
                        job.result()
                    self._functions[f"after{j}"](table, *margins)

    def _plane(self, plane: Plane) -> Array:
        """The plane of a name: the planes of the point and of the new one change places."""
        offset = int(self._table[self.places[plane]]) - self.planes.ctypes.data
        return self.planes[offset // self.planes.strides[0]]


_KINDS: dict[str, Any] = {"p": ctypes.c_void_p, "i": ctypes.c_int64, "d": ctypes.c_double}
_ARGUMENTS = {"stage": "piidd", "after": "pppi"}  # kinds of arguments, and those of the functions of a stage
_ATTRIBUTES = 'attributes #0 = { nounwind "prefer-vector-width"="512" }\n!0 = !{!"branch_weights", i32 1, i32 1000}\n'
_RUN = """\
define void @run(ptr %planes, i64 %begin, i64 %end, ptr %to, ptr %from, i64 %margin, i64 %first, i64 %last, \
double %origin, double %size) #0 {
entry:
  br label %step
step:
  %k = phi i64 [%first, %entry], [%k.next, %step]
  %count = sitofp i64 %k to double
  %passed = fmul double %count, %size
  %time = fadd double %origin, %passed
CALLS
  %k.next = add i64 %k, 1
  %more = icmp slt i64 %k.next, %last
  br i1 %more, label %step, label %done
done:
  ret void
}"""
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
