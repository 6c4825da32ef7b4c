"""A graph as LLVM assembly for vectors of W lanes: straight-line code, one instruction per operation.

`Body` writes the operations of a graph inside a function.  Operations that need branches or loops become separate
functions, which branch for all lanes of a block together: sin(r)/r near 0 and far from 0, exp(A) m by a series.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence
from typing import final

from liehom.errors import TraceError
from liehom.tracing.expr import Expr

FLAGS = "contract"
LIBM = {
    "sin": "sin", "cos": "cos", "tan": "tan", "exp": "exp", "log": "log", "sinh": "sinh", "cosh": "cosh",
    "tanh": "tanh", "arcsin": "asin", "arccos": "acos", "arctan": "atan", "arcsinh": "asinh", "arccosh": "acosh",
    "arctanh": "atanh", "expm1": "expm1", "log1p": "log1p", "log2": "log2", "log10": "log10", "exp2": "exp2",
    "cbrt": "cbrt", "arctan2": "atan2", "pow": "pow",
}  # fmt: skip
COMPARED = {"lt": "olt", "le": "ole", "eq": "oeq", "ne": "une"}
SHORT_SERIES_REACH, LONG_SERIES_REACH = 0.25, 4.0
"""Largest |q| for which sin(r)/r and cos(r), r^2 = q, are a short and a long polynomial in q; above, libm is used."""
MAX_SUBSTEPS = 16.0
"""Largest number of substeps of exp(A) m; for |A| above twice this number the result is NaN."""


def number(x: float) -> str:
    """A float in LLVM's hexadecimal notation, exactly.

    Examples
    --------
    >>> number(1.0)
    '0x3FF0000000000000'
    """
    return f"0x{struct.unpack('>Q', struct.pack('>d', x))[0]:016X}"


@final
class Writer:
    """Lines of a function in LLVM assembly, and the functions that it calls.

    Parameters
    ----------
    width : int
        W; 1 for scalar code.

    Attributes
    ----------
    label : str
        The basic block of the traced step in which lines are written at the moment.
    """

    width: int
    label: str
    vector: str
    mask: str
    suffix: str

    def __init__(self, width: int) -> None:
        self.width, self.label = width, "step"
        self.vector = "double" if width == 1 else f"<{width} x double>"
        self.mask = "i1" if width == 1 else f"<{width} x i1>"
        self.suffix = "f64" if width == 1 else f"v{width}f64"
        self.lines: list[str] = []
        self.declared: dict[str, str] = {}
        self.functions: dict[str, str] = {}
        self._count = 0

    def fresh(self) -> str:
        """A new name for a value, "%v1", "%v2", ..."""
        self._count += 1
        return f"%v{self._count}"

    def emit(self, text: str) -> str:
        """Name of the value of a line that is appended."""
        name = self.fresh()
        self.lines.append(f"  {name} = {text}")
        return name

    def splat(self, x: float | bool) -> str:
        """Vector constant with x in all lanes."""
        if isinstance(x, bool):
            one = "true" if x else "false"
            return one if self.width == 1 else "<" + ", ".join([f"i1 {one}"] * self.width) + ">"
        one = number(float(x))
        return one if self.width == 1 else "<" + ", ".join([f"double {one}"] * self.width) + ">"

    def binary(self, op: str, a: str, b: str) -> str:
        """Name of a op b, for op = "fadd", "fsub", "fmul", "fdiv"."""
        return self.emit(f"{op} {FLAGS} {self.vector} {a}, {b}")

    def polynomial(self, coefficients: Sequence[float], x: str) -> str:
        """Name of the polynomial with these coefficients, constant term first; even and odd terms run in parallel."""
        if len(coefficients) > 3:
            square = self.binary("fmul", x, x)
            odd = self.binary("fmul", self.polynomial_in(coefficients[1::2], square), x)
            return self.binary("fadd", self.polynomial_in(coefficients[::2], square), odd)
        return self.polynomial_in(coefficients, x)

    def polynomial_in(self, coefficients: Sequence[float], x: str) -> str:
        """Name of the polynomial with these coefficients, by Horner's rule."""
        total = self.splat(coefficients[-1])
        for c in reversed(coefficients[:-1]):
            total = self.binary("fadd", self.binary("fmul", total, x), self.splat(c))
        return total

    def intrinsic(self, name: str, *args: str) -> str:
        """Name of an intrinsic function such as llvm.sqrt on all lanes."""
        full = f"llvm.{name}.{self.suffix}"
        self.declared[full] = f"declare {self.vector} @{full}({', '.join([self.vector] * len(args))})"
        return self.emit(f"call {self.vector} @{full}({', '.join(f'{self.vector} {a}' for a in args)})")

    def library(self, name: str, *args: str) -> str:
        """Name of a function of libm, called lane by lane."""
        self.declared[name] = f"declare double @{name}({', '.join(['double'] * len(args))}) memory(none)"
        if self.width == 1:
            return self.emit(f"call double @{name}({', '.join(f'double {a}' for a in args)})")
        made = "poison"
        for lane in range(self.width):
            one = [self.emit(f"extractelement {self.vector} {a}, i32 {lane}") for a in args]
            found = self.emit(f"call double @{name}({', '.join(f'double {x}' for x in one)})")
            made = self.emit(f"insertelement {self.vector} {made}, double {found}, i32 {lane}")
        return made

    def any(self, mask: str) -> str:
        """Name of the i1 that is true if a mask holds in some lane."""
        if self.width == 1:
            return mask
        self.declared[f"any{self.width}"] = f"declare i1 @llvm.vector.reduce.or.v{self.width}i1({self.mask})"
        return self.emit(f"call i1 @llvm.vector.reduce.or.v{self.width}i1({self.mask} {mask})")

    def all(self, mask: str) -> str:
        """Name of the i1 that is true if a mask holds in all lanes."""
        if self.width == 1:
            return mask
        self.declared[f"all{self.width}"] = f"declare i1 @llvm.vector.reduce.and.v{self.width}i1({self.mask})"
        return self.emit(f"call i1 @llvm.vector.reduce.and.v{self.width}i1({self.mask} {mask})")

    def maximum(self, x: str) -> str:
        """Name of the maximum over the lanes, a double."""
        if self.width == 1:
            return x
        name = f"llvm.vector.reduce.fmax.{self.suffix}"
        self.declared[name] = f"declare double @{name}({self.vector})"
        return self.emit(f"call double @{name}({self.vector} {x})")

    def spread(self, x: str) -> str:
        """Name of the vector with the double x in all lanes."""
        if self.width == 1:
            return x
        first = self.emit(f"insertelement {self.vector} poison, double {x}, i32 0")
        zeros = f"<{self.width} x i32> zeroinitializer"
        return self.emit(f"shufflevector {self.vector} {first}, {self.vector} poison, {zeros}")


@final
class Body:
    """Writer of the operations of graphs, each of them once.

    Parameters
    ----------
    writer : Writer
    inputs : dict
        Names of the inputs, by their index.
    """

    writer: Writer

    def __init__(self, writer: Writer, inputs: dict[int, str]) -> None:
        self.writer, self._inputs = writer, inputs
        self._names: dict[int, str] = {}
        self._pairs: dict[int, tuple[str, str]] = {}
        self._loops: dict[int, list[str]] = {}

    def write(self, exprs: Sequence[Expr]) -> None:
        """Write operations; each must come after its arguments."""
        for x in exprs:
            if x.index not in self._names:
                self._names[x.index] = self._written(x)

    def name(self, x: Expr) -> str:
        """Name of the value of an operation that was written."""
        return self.writer.splat(x.value) if x.constant else self._names[x.index]

    def _written(self, x: Expr) -> str:
        if x.constant:
            return ""
        if x.op == "loop":
            return self._iterated(x)
        if x.op == "get" and x.args[0].op == "loop":
            return self._loops[x.args[0].index][int(x.value)]
        w, args = self.writer, [self.name(a) for a in x.args]
        if x.op == "input":
            return self._inputs[x.value]
        if x.op in ("add", "sub", "mul", "div"):
            return w.binary("f" + x.op, *args)
        if x.op == "neg":
            return w.emit(f"fneg {w.vector} {args[0]}")
        if x.op in COMPARED:
            return w.emit(f"fcmp {COMPARED[x.op]} {w.vector} {args[0]}, {args[1]}")
        if x.op == "and":
            return w.emit(f"and {w.mask} {args[0]}, {args[1]}")
        if x.op == "not":
            return w.emit(f"xor {w.mask} {args[0]}, {w.splat(True)}")
        if x.op == "select":
            kind = w.mask if x.args[1].boolean else w.vector
            return w.emit(f"select {w.mask} {args[0]}, {kind} {args[1]}, {kind} {args[2]}")
        if x.op in ("sqrt", "abs"):
            return w.intrinsic("fabs" if x.op == "abs" else "sqrt", *args)
        if x.op in ("sinq", "cosq"):
            return self._rotation(x.args[0], args[0])[x.op == "cosq"]
        if x.op == "get":
            return w.emit(f"extractvalue {_struct(w, x.args[0])} {args[0]}, {x.value}")
        if x.op == "expv":
            from liehom.tracing.series_text import call_exponential

            return call_exponential(w, x, args)
        if x.op in LIBM:
            return w.library(LIBM[x.op], *args)
        raise TraceError(f"the operation {x.op} has no machine code here")

    def _iterated(self, x: Expr) -> str:
        """Write a loop as basic blocks; it ends when no lane wants another iteration."""
        w, loop = self.writer, x.value
        name = f"loop{x.index}"
        starts = [self.name(a) for a in x.args[: len(loop.variables)]]
        entry = f"br i1 {w.any(starts[0])}, label %{name}, label %{name}.done" if loop.guarded else f"br label %{name}"
        before = w.label
        w.lines += [f"  {entry}", f"{name}:"]
        w.label, place = name, len(w.lines)  # the first lines need the names of the last
        for i, v in enumerate(loop.variables):
            self._names[v.index] = f"%{name}.{i}"
        self.write(loop.inside)
        new, end = [self.name(y) for y in loop.new], w.label
        phis = [f"  %{name}.k = phi i64 [0, %{before}], [%{name}.next, %{end}]"]
        for i, v in enumerate(loop.variables):
            kind = w.mask if v.boolean else w.vector
            phis.append(f"  %{name}.{i} = phi {kind} [{starts[i]}, %{before}], [{new[i]}, %{end}]")
        w.lines[place:place] = phis
        w.lines.append(f"  %{name}.next = add i64 %{name}.k, 1")
        fewer = w.emit(f"icmp slt i64 %{name}.next, {loop.limit}")
        again = w.emit(f"and i1 {fewer}, {w.any(self.name(loop.again))}")
        w.lines += [f"  br i1 {again}, label %{name}, label %{name}.done", f"{name}.done:"]
        w.label = f"{name}.done"
        if loop.guarded:
            kinds = [w.mask if v.boolean else w.vector for v in loop.variables]
            pairs = zip(kinds, starts, new, strict=True)
            new = [w.emit(f"phi {kind} [{a}, %{before}], [{b}, %{end}]") for kind, a, b in pairs]
        self._loops[x.index] = new
        return ""

    def _rotation(self, q: Expr, name: str) -> tuple[str, str]:
        """Names of sin(r)/r and cos(r), computed together."""
        if q.index not in self._pairs:
            w = self.writer
            _define_rotation(w)
            pair = w.emit(f"call {{{w.vector}, {w.vector}}} @rotation({w.vector} {name})")
            self._pairs[q.index] = (
                w.emit(f"extractvalue {{{w.vector}, {w.vector}}} {pair}, 0"),
                w.emit(f"extractvalue {{{w.vector}, {w.vector}}} {pair}, 1"),
            )
        return self._pairs[q.index]


# -- sin(r)/r and cos(r) of r^2 ----------------------------------------------------------------------------
def rotation_series(reach: float, first: int) -> list[float]:
    """Taylor coefficients of sin(r)/r (first = 1) or cos(r) (first = 0) in r^2, enough for double precision to `reach`.

    Examples
    --------
    >>> rotation_series(1e-8, 0)
    [1.0, -0.5]
    """
    made, k = [], 0
    while True:
        made.append((-1) ** k / math.factorial(2 * k + first))
        k += 1
        if reach**k / math.factorial(2 * k + first) < 2e-17:
            return made


def _define_rotation(w: Writer) -> None:
    if "rotation" in w.functions:
        return
    f = Writer(w.width)
    v, pair = f.vector, f"{{{f.vector}, {f.vector}}}"
    size = f.intrinsic("fabs", "%q")
    f.lines.append("  br label %look")
    f.lines.append("look:")
    far = f.any(f.emit(f"fcmp ugt {v} {size}, {f.splat(SHORT_SERIES_REACH)}"))
    f.lines.append(f"  br i1 {far}, label %farther, label %short, !prof !0")
    results = []
    for label, reach in (("short", SHORT_SERIES_REACH), ("long", LONG_SERIES_REACH)):
        f.lines.append(f"{label}:")
        results.append((label, [f.polynomial(rotation_series(reach, 1 - k), "%q") for k in (0, 1)]))
        f.lines.append("  br label %done")
    f.lines.append("farther:")
    out = f.any(f.emit(f"fcmp ugt {v} {size}, {f.splat(LONG_SERIES_REACH)}"))
    f.lines.append(f"  br i1 {out}, label %far, label %long, !prof !0")
    f.lines.append("far:")
    results.append(("far", _by_library(f, size)))
    f.lines += ["  br label %done", "done:"]
    chosen = [f.emit(f"phi {v} " + ", ".join(f"[{made[k]}, %{label}]" for label, made in results)) for k in (0, 1)]
    first = f.emit(f"insertvalue {pair} poison, {v} {chosen[0]}, 0")
    whole = f.emit(f"insertvalue {pair} {first}, {v} {chosen[1]}, 1")
    head = f"define internal {pair} @rotation({v} %q) alwaysinline {{\nentry:"
    w.functions["rotation"] = "\n".join([head, *f.lines, f"  ret {pair} {whole}", "}"])
    w.declared |= f.declared


def _by_library(f: Writer, size: str) -> list[str]:
    """Names of sin(r)/r and cos(r) by libm; lanes with small r use the series."""
    v = f.vector
    r = f.intrinsic("sqrt", size)
    turns = f.emit(f"fcmp ogt {v} %q, {f.splat(0.0)}")
    near = f.emit(f"fcmp olt {v} {size}, {f.splat(SHORT_SERIES_REACH)}")
    # sinh of the large r of a rotation would overflow
    grown = f.emit(f"select {f.mask} {turns}, {v} {f.splat(0.0)}, {v} {r}")
    made = []
    for k, names in ((0, ("sin", "sinh")), (1, ("cos", "cosh"))):
        a, b = f.library(names[0], r), f.library(names[1], grown)
        whole = f.emit(f"select {f.mask} {turns}, {v} {a}, {v} {b}")
        if k == 0:
            whole = f.binary("fdiv", whole, r)
        short = f.polynomial(rotation_series(SHORT_SERIES_REACH, 1 - k), "%q")
        made.append(f.emit(f"select {f.mask} {near}, {v} {short}, {v} {whole}"))
    return made


# -- exp(A) m ----------------------------------------------------------------------------------------------
def _struct(w: Writer, x: Expr) -> str:
    count = len(x.args) - len(x.value)
    return "{" + ", ".join([w.vector] * count) + "}"


def _call_series(w: Writer, x: Expr, args: list[str]) -> str:
    name = "series_" + "_".join(f"{i}.{j}" for i, j in x.value)
    if name not in w.functions:
        _define_series(w, name, x.value, len(args) - len(x.value))
    return w.emit(f'call {_struct(w, x)} @"{name}"({", ".join(f"{w.vector} {a}" for a in args)})')


def _define_series(w: Writer, name: str, places: tuple[tuple[int, int], ...], n: int) -> None:
    """exp(A) m by the Taylor series of the increment, in substeps of norm at most 2, until a term is negligible."""
    f = Writer(w.width)
    v, result = f.vector, "{" + ", ".join([f.vector] * n) + "}"
    square = f.splat(0.0)
    for p in range(len(places)):
        square = f.binary("fadd", f.binary("fmul", f"%a{p}", f"%a{p}"), square)
    norm = f.intrinsic("sqrt", square)
    halves = f.emit(f"fmul double {f.maximum(norm)}, {number(0.5)}")
    f.declared["ceil"] = "declare double @llvm.ceil.f64(double)"
    f.declared["maxd"] = "declare double @llvm.maxnum.f64(double, double)"
    f.declared["mind"] = "declare double @llvm.minnum.f64(double, double)"
    up = f.emit(f"call double @llvm.ceil.f64(double {halves})")
    least = f.emit(f"call double @llvm.maxnum.f64(double {up}, double {number(1.0)})")
    parts = f.emit(f"call double @llvm.minnum.f64(double {least}, double {number(MAX_SUBSTEPS)})")
    share = f.spread(f.emit(f"fdiv double {number(1.0)}, {parts}"))
    fine = f.emit(f"fcmp ole {v} {norm}, {f.splat(2 * MAX_SUBSTEPS)}")  # beyond, and for NaN, the result is NaN
    good = f.emit(f"select {f.mask} {fine}, {v} {f.splat(1.0)}, {v} {f.splat(math.nan)}")
    scaled = [f.binary("fmul", f"%a{p}", share) for p in range(len(places))]
    f.lines += ["  br label %substep", "substep:"]
    f.lines.append(f"  %part = phi double [{number(0.0)}, %entry], [%part.next, %substep.end]")
    for i in range(n):
        f.lines.append(f"  %m{i} = phi {v} [%vin{i}, %entry], [%m{i}.next, %substep.end]")
    f.lines += ["  br label %term", "term:"]
    f.lines.append(f"  %j = phi double [{number(1.0)}, %substep], [%j.next, %term]")
    for i in range(n):
        f.lines.append(f"  %t{i} = phi {v} [%m{i}, %substep], [%t{i}.next, %term]")
        f.lines.append(f"  %s{i} = phi {v} [{f.splat(0.0)}, %substep], [%s{i}.next, %term]")
    over = f.spread(f.emit(f"fdiv double {number(1.0)}, %j"))
    largest, whole = f.splat(0.0), f.splat(0.0)
    for i in range(n):
        total = f.splat(0.0)
        for p, (a, b) in enumerate(places):
            if a == i:
                total = f.binary("fadd", f.binary("fmul", scaled[p], f"%t{b}"), total)
        f.lines.append(f"  %t{i}.next = fmul {FLAGS} {v} {total}, {over}")
        f.lines.append(f"  %s{i}.next = fadd {FLAGS} {v} %s{i}, %t{i}.next")
        largest = f.intrinsic("maxnum", largest, f.intrinsic("fabs", f"%t{i}.next"))
        whole = f.intrinsic("maxnum", whole, f.intrinsic("fabs", f"%s{i}.next"))
    felt = f.emit(f"fcmp ogt {v} {largest}, {f.binary('fmul', whole, f.splat(2.8e-17))}")
    f.lines.append(f"  %j.next = fadd double %j, {number(1.0)}")
    more = f.emit(f"and i1 {f.any(felt)}, {f.emit(f'fcmp olt double %j, {number(60.0)}')}")
    f.lines += [f"  br i1 {more}, label %term, label %substep.end", "substep.end:"]
    for i in range(n):
        f.lines.append(f"  %m{i}.next = fadd {FLAGS} {v} %m{i}, %s{i}.next")
    f.lines.append(f"  %part.next = fadd double %part, {number(1.0)}")
    again = f.emit(f"fcmp olt double %part.next, {parts}")
    f.lines += [f"  br i1 {again}, label %substep, label %done", "done:"]
    made = "poison"
    for i in range(n):
        last = f.binary("fmul", f"%m{i}.next", good)
        made = f.emit(f"insertvalue {result} {made}, {v} {last}, {i}")
    names = [f"%a{p}" for p in range(len(places))] + [f"%vin{i}" for i in range(n)]
    head = f'define internal {result} @"{name}"({", ".join(f"{v} {x}" for x in names)}) noinline {{\nentry:'
    w.functions[name] = "\n".join([head, *f.lines, f"  ret {result} {made}", "}"])
    w.declared |= f.declared
