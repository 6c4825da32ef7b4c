"""LLVM assembly of a graph: operations, exponentials and rotations."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Sequence
from itertools import count
from typing import TypeAlias, final

import numpy as np

from liehom.base.errors import TraceError
from liehom.base.typing import Array, IntegerArray
from liehom.flow.tracing.graph import BEND, LARGEST_EXPONENT, MIDDLE, Expr

FLAGS = "contract"
LIBM = {
    "sin": "sin", "cos": "cos", "tan": "tan", "exp": "exp", "log": "log", "sinh": "sinh", "cosh": "cosh",
    "tanh": "tanh", "arcsin": "asin", "arccos": "acos", "arctan": "atan", "arcsinh": "asinh", "arccosh": "acosh",
    "arctanh": "atanh", "expm1": "expm1", "log1p": "log1p", "log2": "log2", "log10": "log10", "exp2": "exp2",
    "cbrt": "cbrt", "arctan2": "atan2", "pow": "pow",
}  # fmt: skip


def number(x: float) -> str:
    """A float in LLVM's hexadecimal notation, exactly."""
    return f"0x{struct.unpack('>Q', struct.pack('>d', x))[0]:016X}"


@final
class Writer:
    """Lines of a function in LLVM assembly, for vectors of `width` lanes, and the functions that it calls; `label` is
    the basic block."""

    def __init__(self, width: int) -> None:
        self.width, self.label = width, "step"
        self.vector = "double" if width == 1 else f"<{width} x double>"
        self.mask = "i1" if width == 1 else f"<{width} x i1>"
        self.suffix = "f64" if width == 1 else f"v{width}f64"
        self.lines: list[str] = []
        self.declared: dict[str, str] = {}
        self.functions: dict[str, str] = {}
        self.tables: dict[tuple[str, bytes], str] = {}
        self.loops: dict[str, str] = {}  # names of functions by their code
        self.slots = 0
        self._count = 0

    def emit(self, text: str) -> str:
        """Name of the value of a line that is appended."""
        self._count += 1
        self.lines.append(f"  %v{self._count} = {text}")
        return f"%v{self._count}"

    def begun(self, name: str, by: str = "br label") -> str:
        """Label of a basic block that begins here, to which the last one branches."""
        self._count += 1
        self.label = f"{name}{self._count}"
        self.lines += [f"  {by} %{self.label}", f"{self.label}:"]
        return self.label

    def table(self, values: Array | IntegerArray) -> str:
        """Name of a constant array of doubles or of 32-bit integers."""
        kind = "double" if values.dtype == np.float64 else "i32"
        key = kind, values.tobytes()
        if key not in self.tables:
            self.tables[key] = f"@table{len(self.tables)}"
        return self.tables[key]

    def constants(self) -> list[str]:
        """Definitions of the constant arrays."""
        return [
            f"{name} = internal constant [{len(x)} x {kind}] ["
            + ", ".join(f"{kind} {number(v) if kind == 'double' else v}" for v in x)
            + "], align 64"
            for (kind, content), name in self.tables.items()
            if len(x := np.frombuffer(content, dtype=np.float64 if kind == "double" else np.int64).tolist())
        ]

    def reserve(self, count: int) -> int:
        """Place of `count` numbers of the lanes of a block in %memory, which the function must have."""
        self.slots += count
        return self.slots - count

    def slot(self, place: str | int) -> str:
        """Pointer to a number in %memory."""
        return self.emit(f"getelementptr {self.vector}, ptr %memory, i64 {place}")

    def splat(self, x: float | bool) -> str:
        """Vector constant with x in all lanes."""
        kind, one = ("i1", "true" if x else "false") if isinstance(x, bool) else ("double", number(float(x)))
        return one if self.width == 1 else "<" + ", ".join([f"{kind} {one}"] * self.width) + ">"

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
        vector = "poison"
        for lane in range(self.width):
            one = [self.emit(f"extractelement {self.vector} {a}, i32 {lane}") for a in args]
            value = self.emit(f"call double @{name}({', '.join(f'double {x}' for x in one)})")
            vector = self.emit(f"insertelement {self.vector} {vector}, double {value}, i32 {lane}")
        return vector

    def coarse_log2(self, x: str) -> str:
        """Name of `liehom.flow.tracing.graph.coarse_log2`: the bits of a float, as an integer, are its logarithm."""
        kind = self.integers
        bits = self.emit(f"sub {kind} {self.emit(f'bitcast {self.vector} {x} to {kind}')}, {self._whole(1023 << 52)}")
        scaled = self.binary("fmul", self.emit(f"sitofp {kind} {bits} to {self.vector}"), self.splat(2.0**-52))
        return self.binary("fadd", scaled, self.splat(MIDDLE))

    def coarse_exp2(self, x: str) -> str:
        """Name of `liehom.flow.tracing.graph.coarse_exp2`."""
        kind = self.integers
        # the lower bound first, which is taken for NaN too, so that no step is made
        for bound, op in ((self.splat(-LARGEST_EXPONENT), "ogt"), (self.splat(LARGEST_EXPONENT), "olt")):
            inside = self.emit(f"fcmp {op} {self.vector} {x}, {bound}")
            x = self.emit(f"select {self.mask} {inside}, {self.vector} {x}, {self.vector} {bound}")
        whole = self.intrinsic("floor", x)
        rest = self.binary("fsub", x, whole)
        slope = self.binary("fadd", self.binary("fmul", rest, self.splat(BEND)), self.splat(1.0 - BEND))
        mantissa = self.binary("fadd", self.binary("fmul", rest, slope), self.splat(1.0))
        power = self.emit(f"shl {kind} {self.emit(f'fptosi {self.vector} {whole} to {kind}')}, {self._whole(52)}")
        bits = self.emit(f"add {kind} {self.emit(f'bitcast {self.vector} {mantissa} to {kind}')}, {power}")
        return self.emit(f"bitcast {kind} {bits} to {self.vector}")

    @property
    def integers(self) -> str:
        """The type of an integer of 64 bits for each lane."""
        return "i64" if self.width == 1 else f"<{self.width} x i64>"

    def _whole(self, x: int) -> str:
        return str(x) if self.width == 1 else "<" + ", ".join([f"i64 {x}"] * self.width) + ">"

    def any(self, mask: str, op: str = "or") -> str:
        """Name of the i1 that is true if a mask holds in some lane."""
        if self.width == 1:
            return mask
        function = f"i1 @llvm.vector.reduce.{op}.v{self.width}i1"
        self.declared[function] = f"declare {function}({self.mask})"
        return self.emit(f"call {function}({self.mask} {mask})")

    def all(self, mask: str) -> str:
        """Name of the i1 that is true if a mask holds in all lanes."""
        return self.any(mask, "and")

    def structure(self, values: Sequence[str]) -> str:
        """Name of a structure of vectors."""
        result = "poison"
        for i, x in enumerate(values):
            result = self.emit(f"insertvalue {struct_of(self, len(values))} {result}, {self.vector} {x}, {i}")
        return result

    def spread(self, x: str) -> str:
        """Name of the vector with the double x in all lanes."""
        if self.width == 1:
            return x
        first = self.emit(f"insertelement {self.vector} poison, double {x}, i32 0")
        zeros = f"<{self.width} x i32> zeroinitializer"
        return self.emit(f"shufflevector {self.vector} {first}, {self.vector} poison, {zeros}")


# sin(r)/r and cos(r) of r^2 in LLVM assembly: polynomials near 0, libm far from 0.

SHORT_SERIES_REACH, LONG_SERIES_REACH = 0.25, 4.0
"""Largest |q| for which sin(r)/r and cos(r), r^2 = q, are a short and a long polynomial in q; above, libm is used."""


def rotation_series(reach: float, first: int) -> list[float]:
    """Taylor coefficients of sin(r)/r (first = 1) or cos(r) (first = 0) in r^2, for double precision to `reach`."""
    terms = next(k for k in count(1) if reach**k / math.factorial(2 * k + first) < 2e-17)
    return [(-1) ** k / math.factorial(2 * k + first) for k in range(terms)]


def _rotation(f: Writer) -> list[str]:
    """Write the function q -> (sin(r)/r, cos(r)), r^2 = q; the names of its results."""
    v, size = f.vector, f.intrinsic("fabs", "%x")
    f.lines += ["  br label %look", "look:"]
    far = f.any(f.emit(f"fcmp ugt {v} {size}, {f.splat(SHORT_SERIES_REACH)}"))
    f.lines.append(f"  br i1 {far}, label %farther, label %short, !prof !0")
    results = []
    for label, reach in (("short", SHORT_SERIES_REACH), ("long", LONG_SERIES_REACH)):
        f.lines.append(f"{label}:")
        results.append((label, [f.polynomial(rotation_series(reach, 1 - k), "%x") for k in (0, 1)]))
        f.lines.append("  br label %done")
    f.lines.append("farther:")
    out = f.any(f.emit(f"fcmp ugt {v} {size}, {f.splat(LONG_SERIES_REACH)}"))
    f.lines += [f"  br i1 {out}, label %far, label %long, !prof !0", "far:"]
    results.append(("far", _by_library(f, size)))
    f.lines += ["  br label %done", "done:"]
    return [f.emit(f"phi {v} " + ", ".join(f"[{x[k]}, %{label}]" for label, x in results)) for k in (0, 1)]


# sin(x) and cos(x) in LLVM assembly: x minus the nearest multiple of pi/2, which is subtracted in three parts, and the
# polynomials above. For large x the product of the multiple and the first part is rounded: libm is used.

HALF_PI = (float.fromhex("0x1.921fb544p+0"), float.fromhex("0x1.0b4611a6p-34"), float.fromhex("0x1.3198a2e037073p-69"))
"""pi/2 in parts, of which the first two have 33 bits."""
LARGEST_ANGLE = 1e6


def _turn(f: Writer) -> list[str]:
    """Write the function x -> (sin(x), cos(x)); the names of its results."""
    v = f.vector
    f.lines += ["  br label %start", "start:"]
    quarters = f.intrinsic("rint", f.binary("fmul", "%x", f.splat(2 / math.pi)))
    rest = "%x"
    for part in HALF_PI:
        rest = f.binary("fsub", rest, f.binary("fmul", quarters, f.splat(part)))
    square = f.binary("fmul", rest, rest)
    reach = (math.pi / 4) ** 2
    sine = f.binary("fmul", f.polynomial(rotation_series(reach, 1), square), rest)
    cosine = f.polynomial(rotation_series(reach, 0), square)
    whole = f.intrinsic("rint", f.binary("fmul", quarters, f.splat(0.25)))
    place = f.binary("fsub", quarters, f.binary("fmul", whole, f.splat(4.0)))  # -2, -1, 0, 1 or 2
    odd = f.emit(f"fcmp oeq {v} {f.intrinsic('fabs', place)}, {f.splat(1.0)}")
    half = f.emit(f"fcmp oeq {v} {f.intrinsic('fabs', place)}, {f.splat(2.0)}")
    values = []
    for even_part, odd_part, quarter in ((sine, cosine, -1.0), (cosine, sine, 1.0)):
        value = f.emit(f"select {f.mask} {odd}, {v} {odd_part}, {v} {even_part}")
        turned = f.emit(f"fcmp oeq {v} {place}, {f.splat(quarter)}")
        negative = f.emit(f"or {f.mask} {half}, {turned}")
        values.append(f.emit(f"select {f.mask} {negative}, {v} {f.emit(f'fneg {v} {value}')}, {v} {value}"))
    large = f.emit(f"fcmp ugt {v} {f.intrinsic('fabs', '%x')}, {f.splat(LARGEST_ANGLE)}")
    f.lines += [f"  br i1 {f.any(large)}, label %far, label %done, !prof !0", "far:"]
    far = [
        f.emit(f"select {f.mask} {large}, {v} {f.library(name, '%x')}, {v} {value}")
        for name, value in zip(("sin", "cos"), values, strict=True)
    ]
    f.lines += ["  br label %done", "done:"]
    return [f.emit(f"phi {v} [{a}, %start], [{b}, %far]") for a, b in zip(values, far, strict=True)]


def _by_library(f: Writer, size: str) -> list[str]:
    """Names of sin(r)/r and cos(r) by libm; lanes with small r use the series."""
    v = f.vector
    r = f.intrinsic("sqrt", size)
    turns = f.emit(f"fcmp ogt {v} %x, {f.splat(0.0)}")
    near = f.emit(f"fcmp olt {v} {size}, {f.splat(SHORT_SERIES_REACH)}")
    # sinh of the large r of a rotation would overflow
    grown = f.emit(f"select {f.mask} {turns}, {v} {f.splat(0.0)}, {v} {r}")
    results = []
    for first, names in ((1, ("sin", "sinh")), (0, ("cos", "cosh"))):
        a, b = f.library(names[0], r), f.library(names[1], grown)
        value = f.emit(f"select {f.mask} {turns}, {v} {a}, {v} {b}")
        value = f.binary("fdiv", value, r) if first else value
        short = f.polynomial(rotation_series(SHORT_SERIES_REACH, first), "%x")
        results.append(f.emit(f"select {f.mask} {near}, {v} {short}, {v} {value}"))
    return results


# exp(A) m in LLVM assembly: the Taylor polynomial by Horner's rule, of a degree that follows from the norm of A.
#
# The degrees go up in levels. A block of lanes enters at the level of its largest norm; where the level of a lane
# begins, the lane begins too. So the result of a lane does not depend on the other lanes of the block.

LEVELS = ((0.054, 8), (0.28, 12), (0.72, 16), (1.35, 20), (2.1, 24))
"""Norms up to which a polynomial of a degree leaves out less than 1e-17 of the result."""
MAX_NORM = 32.0  # for |A| above, the result is NaN
STRAIGHT_OPERATIONS = 40  # numbers of A and m, together, up to which the polynomial is written without loops


def struct_of(w: Writer, count: int) -> str:
    """The type of a structure of `count` vectors."""
    return "{" + ", ".join([w.vector] * count) + "}"


def call_exponential(w: Writer, x: Expr, args: list[str]) -> str:
    """Name of exp(A) m for an operation "expv", a structure of vectors."""
    count, skew = len(args) - len(x.value), _is_skew(x)
    name = "exponential_" + "_".join(f"{i}.{j}" for i, j in x.value) + ("_skew" if skew else "")
    if name not in w.functions:
        w.functions[name] = _Exponential(w, name, x.value, count, skew=skew).text()
    return w.emit(f'call {struct_of(w, count)} @"{name}"({", ".join(f"{w.vector} {a}" for a in args)})')


def _is_skew(x: Expr) -> bool:
    """Whether the entries of A are visibly those of a skew-symmetric matrix."""
    entries = dict(zip(x.value, x.args, strict=False))

    def opposite(a: Expr, b: Expr | None) -> bool:
        return b is not None and ((a.op == "neg" and a.args[0] is b) or (b.op == "neg" and b.args[0] is a) or
                                  (a.op == b.op == "sub" and a.args == b.args[::-1]))  # fmt: skip

    return all(opposite(a, entries.get((j, i))) for (i, j), a in entries.items())


@final
class _Exponential:
    """Writer of the function (A, m) -> exp(A) m."""

    def __init__(self, w: Writer, name: str, places: tuple[tuple[int, int], ...], n: int, *, skew: bool) -> None:
        self.f, self.caller = Writer(w.width), w
        self.name, self.places, self.n, self.skew = name, places, n, skew
        self.v = self.f.vector
        self.straight = len(places) + n <= STRAIGHT_OPERATIONS

    def text(self) -> str:
        """The function."""
        f, v, n = self.f, self.v, self.n
        self._begin()
        moved = self._levels()
        f.lines.append(f"  %part.next = fadd {v} %part, {f.splat(1.0)}")
        here = f.emit(f"fcmp olt {v} %part, %parts")
        f.lines += [f"  %m{i}.next = select {f.mask} {here}, {v} {x}, {v} %m{i}" for i, x in enumerate(moved)]
        again = f.any(f.emit(f"fcmp olt {v} %part.next, %parts"))
        f.lines += ["  br label %end", "end:", f"  br i1 {again}, label %substep, label %done, !prof !0", "done:"]
        kind, result = struct_of(f, n), f.structure([f"%m{i}.next" for i in range(n)])
        names = [f"%a{p}" for p in range(len(self.places))] + [f"%vin{i}" for i in range(n)]
        self.caller.declared |= f.declared
        head = f'define internal {kind} @"{self.name}"({", ".join(f"{v} {x}" for x in names)}) {{\nentry:'
        return "\n".join([head, *f.lines, f"  ret {kind} {result}", "}"])

    def _begin(self) -> None:
        """Begin the loop over substeps, of which there is one unless a norm is above the highest level."""
        f, v, top = self.f, self.v, LEVELS[-1][0]
        square = self._square()
        usual = f.all(f.emit(f"fcmp ole {v} {square}, {f.splat(top * top)}"))
        f.lines += [f"  br i1 {usual}, label %substep.first, label %large, !prof !1", "large:"]
        norm = f.intrinsic("sqrt", square)
        parts = f.intrinsic("ceil", f.binary("fmul", norm, f.splat(1 / top)))
        parts = f.intrinsic("minnum", f.intrinsic("maxnum", parts, f.splat(1.0)), f.splat(MAX_NORM))
        share = f.binary("fdiv", f.splat(1.0), parts)
        fine = f.emit(f"fcmp ole {v} {norm}, {f.splat(MAX_NORM)}")  # beyond, and for NaN, the result is NaN
        good = f.emit(f"select {f.mask} {fine}, {v} {share}, {v} {f.splat(math.nan)}")
        scaled = [f.binary("fmul", f"%a{p}", good) for p in range(len(self.places))]
        smaller = f.binary("fmul", square, f.binary("fmul", share, share))
        ways = [("parts", f.splat(1.0), parts), ("square", square, smaller)]
        ways += [(f"b{p}", f"%a{p}", x) for p, x in enumerate(scaled)]
        f.lines += [
            "  br label %substep.first",
            "substep.first:",
            *[f"  %{name} = phi {v} [{plain}, %entry], [{other}, %large]" for name, plain, other in ways],
            "  br label %substep",
            "substep:",
            f"  %part = phi {v} [{f.splat(0.0)}, %substep.first], [%part.next, %end]",
            *[f"  %m{i} = phi {v} [%vin{i}, %substep.first], [%m{i}.next, %end]" for i in range(self.n)],
        ]

    def _square(self) -> str:
        """The square of a bound of the spectral norm: that of the Frobenius norm, half of it if A is skew-symmetric."""
        f, square = self.f, self.f.splat(0.0)
        for p, (i, j) in enumerate(self.places):
            if not self.skew or i < j:
                square = f.binary("fadd", f.binary("fmul", f"%a{p}", f"%a{p}"), square)
        return square

    def _levels(self) -> list[str]:
        """Names of exp(A) m for norms within the highest level."""
        f, v, n = self.f, self.v, self.n
        above = [f.any(f.emit(f"fcmp ogt {v} %square, {f.splat(reach * reach)}")) for reach, _ in LEVELS[:-1]]
        self._enter(above, len(LEVELS) - 1)
        s = [""] * n
        for level in range(len(LEVELS) - 1, -1, -1):
            f.label = f"level{level}"
            f.lines.append(f"{f.label}:")
            if level == len(LEVELS) - 1:
                s = [f"%m{i}" for i in range(n)]
            else:  # lanes of this level begin here
                small = f.emit(f"fcmp ole {v} %square, {f.splat(LEVELS[level][0] ** 2)}")
                started = [f.emit(f"select {f.mask} {small}, {v} %m{i}, {v} {s[i]}") for i in range(n)]
                f.lines += [f"  br label %begin{level}", f"begin{level}:"]
                s = [f.emit(f"phi {v} [{started[i]}, %level{level}], [%m{i}, %enter{level}]") for i in range(n)]
                f.label = f"begin{level}"
            s = self._terms(s, level)
            if level:
                f.lines.append(f"  br label %level{level - 1}")
        return s

    def _enter(self, above: list[str], top: int) -> None:
        """Branch to the level of the largest norm; small norms are the usual ones."""
        f = self.f
        f.lines.append("  br label %enter0.test")
        for level in range(top):
            following = f"enter{level + 1}.test" if level + 1 < top else f"level{top}"
            f.lines += [
                f"enter{level}.test:",
                f"  br i1 {above[level]}, label %{following}, label %enter{level}",
                f"enter{level}:",
                f"  br label %begin{level}",
            ]

    def _terms(self, s: list[str], level: int) -> list[str]:
        """s -> m + A s / k for the k of a level, from the largest to the smallest."""
        f = self.f
        first, last = LEVELS[level][1], LEVELS[level - 1][1] if level else 0
        if self.straight:
            for k in range(first, last, -1):
                s = self._term(s, f.splat(1.0 / k))
            return s
        index, before, here = f"%k{level}", f.label, f"%terms{level}"
        sums = [f"%s{level}.{i}" for i in range(self.n)]
        f.lines += [
            f"  br label {here}",
            f"terms{level}:",
            f"  {index} = phi double [{number(float(first))}, %{before}], [{index}.next, {here}]",
            *[f"  {x} = phi {self.v} [{a}, %{before}], [{x}.next, {here}]" for x, a in zip(sums, s, strict=True)],
        ]
        new = self._term(sums, f.spread(f.emit(f"fdiv double {number(1.0)}, {index}")))
        f.lines += [f"  {x}.next = fadd {self.v} {a}, {f.splat(-0.0)}" for x, a in zip(sums, new, strict=True)]
        f.lines.append(f"  {index}.next = fsub double {index}, {number(1.0)}")
        more = f.emit(f"fcmp ogt double {index}.next, {number(float(last))}")
        f.lines += [f"  br i1 {more}, label {here}, label {here}.end", f"terms{level}.end:"]
        f.label = f"terms{level}.end"
        return [f"{x}.next" for x in sums]

    def _term(self, s: list[str], factor: str) -> list[str]:
        """m + factor A s."""
        f, sums = self.f, []
        for i in range(self.n):
            total = None
            for p, (a, b) in enumerate(self.places):
                if a == i:
                    term = f.binary("fmul", f"%b{p}", s[b])
                    total = term if total is None else f.binary("fadd", term, total)
            sums.append(f"%m{i}" if total is None else f.binary("fadd", f.binary("fmul", total, factor), f"%m{i}"))
        return sums


# Body: the operations of a graph as LLVM assembly, one instruction each; those that need branches (sin(r)/r, exp(A) m)
# become functions, which branch for all lanes of a block together.

COMPARED = {"lt": "olt", "le": "ole", "eq": "oeq", "ne": "une"}


@final
class Body:
    """Writer of the operations of graphs, each of them once."""

    def __init__(self, writer: Writer, inputs: dict[int, str]) -> None:
        self.writer, self._inputs = writer, inputs
        self._names: dict[int, str] = {}
        self._pairs: dict[tuple[str, int], tuple[str, str]] = {}
        self._loops: dict[int, list[str]] = {}
        self._slots: dict[int, int] = {}  # places in memory

    def write(self, exprs: Sequence[Expr]) -> None:
        """Write operations; each must come after its arguments."""
        for x in exprs:
            if x.op in ("map", "table"):
                if x.index not in self._slots:
                    self._slots[x.index] = self._rolled(x)
            elif x.op == "get" and x.args[0].op in ("map", "table"):
                self._slots[x.index] = self._slots[x.args[0].index] + x.value
            elif x.index not in self._names:
                self._names[x.index] = self._written(x)

    def name(self, x: Expr) -> str:
        """Name of the value of an operation that was written."""
        if x.constant:
            return self.writer.splat(x.value)
        if x.index in self._names:
            return self._names[x.index]
        return self.writer.emit(f"load {self.writer.vector}, ptr {self.writer.slot(self._slots[x.index])}, align 8")

    def _written(self, x: Expr) -> str:
        if x.constant:
            return ""
        if x.op == "loop":
            return self._iterated(x)
        if x.op == "get" and x.args[0].op == "loop":
            return self._loops[x.args[0].index][int(x.value)]
        w, args = self.writer, [self.name(a) for a in x.args]
        match x.op:
            case "input":
                return self._inputs[x.value]
            case "sinq" | "cosq" | "sin" | "cos":
                return self._pair(x.op, x.args[0], args[0])
            case "expv":
                return call_exponential(w, x, args)
            case "and":
                text = f"and {w.mask} {args[0]}, {args[1]}"
            case "not":
                text = f"xor {w.mask} {args[0]}, {w.splat(True)}"
            case "select":
                kind = w.mask if x.args[1].boolean else w.vector
                text = f"select {w.mask} {args[0]}, {kind} {args[1]}, {kind} {args[2]}"
            case "get":
                text = f"extractvalue {struct_of(w, len(x.args[0].args) - len(x.args[0].value))} {args[0]}, {x.value}"
            case op if op in COMPARED:
                text = f"fcmp {COMPARED[op]} {w.vector} {args[0]}, {args[1]}"
            case op:
                return self.elementary(op, args)
        return w.emit(text)

    def elementary(self, op: str, args: Sequence[str]) -> str:
        """Name of the value of an elementary operation."""
        w = self.writer
        match op:
            case "add" | "sub" | "mul" | "div":
                return w.binary("f" + op, *args)
            case "neg":
                return w.emit(f"fneg {w.vector} {args[0]}")
            case "sqrt" | "abs":
                return w.intrinsic("fabs" if op == "abs" else "sqrt", *args)
            case "sinq" | "cosq" | "sin" | "cos":
                return self._both(op, args[0])[op in ("cosq", "cos")]
            case "coarse_log2":
                return w.coarse_log2(args[0])
            case "coarse_exp2":
                return w.coarse_exp2(args[0])
            case _ if op in LIBM:
                return w.library(LIBM[op], *args)
        raise TraceError(f"the operation {op} has no machine code here")

    def _iterated(self, x: Expr) -> str:
        """Write a loop as basic blocks; it ends when no lane wants another iteration."""
        w, loop = self.writer, x.value
        name = f"loop{x.index}"
        starts = [self.name(a) for a in x.args[: len(loop.variables)]]
        entry = f"br i1 {w.any(starts[0])}, label %{name}, label %{name}.done" if loop.guarded else f"br label %{name}"
        before = w.label
        w.lines += [f"  {entry}", f"{name}:"]
        w.label, place = name, len(w.lines)  # the first lines need the names of the last
        self._names |= {v.index: f"%{name}.{i}" for i, v in enumerate(loop.variables)}
        outside = dict(self._slots)
        self.write(loop.inside)
        new, end = [self.name(y) for y in loop.new], w.label
        self._slots = outside  # what was stored in the loop may not be there after it
        kinds = [w.mask if v.boolean else w.vector for v in loop.variables]
        w.lines[place:place] = [
            f"  %{name}.k = phi i64 [0, %{before}], [%{name}.next, %{end}]",
            *[
                f"  %{name}.{i} = phi {kind} [{a}, %{before}], [{b}, %{end}]"
                for i, (kind, a, b) in enumerate(zip(kinds, starts, new, strict=True))
            ],
        ]
        w.lines.append(f"  %{name}.next = add i64 %{name}.k, 1")
        fewer = w.emit(f"icmp slt i64 %{name}.next, {loop.limit}")
        again = w.emit(f"and i1 {fewer}, {w.any(self.name(loop.again))}")
        w.lines += [f"  br i1 {again}, label %{name}, label %{name}.done", f"{name}.done:"]
        w.label = f"{name}.done"
        if loop.guarded:
            phis = zip(kinds, starts, new, strict=True)
            new = [w.emit(f"phi {kind} [{a}, %{before}], [{b}, %{end}]") for kind, a, b in phis]
        self._loops[x.index] = new
        return ""

    def _pair(self, op: str, x: Expr, name: str) -> str:
        """Name of a result of `rotation` or `turn`; both are computed together."""
        key = "q" * op.endswith("q"), x.index
        if key not in self._pairs:
            self._pairs[key] = self._both(op, name)
        return self._pairs[key][op in ("cosq", "cos")]

    def _both(self, op: str, name: str) -> tuple[str, str]:
        """Names of both results of `rotation` or `turn`."""
        w, kind, function = self.writer, struct_of(self.writer, 2), "rotation" if op.endswith("q") else "turn"
        if function not in w.functions:
            f = Writer(w.width)
            pair = f.structure((_rotation if function == "rotation" else _turn)(f))
            head = f"define internal {kind} @{function}({w.vector} %x) alwaysinline {{\nentry:"
            w.functions[function] = "\n".join([head, *f.lines, f"  ret {kind} {pair}", "}"])
            w.declared |= f.declared
        pair = w.emit(f"call {kind} @{function}({w.vector} {name})")
        return w.emit(f"extractvalue {kind} {pair}, 0"), w.emit(f"extractvalue {kind} {pair}, 1")

    # -- loops over entries, on numbers in memory ------------------------------------------------------------
    def _rolled(self, x: Expr) -> int:
        """Write the call of a function for a "map" or a "table"; the place of the results."""
        w = self.writer
        code = _LoopWriter(w)
        if x.op == "map":
            name, rows = x.value
            lists = [x.args[i : i + rows] for i in range(0, len(x.args), rows)]
            values = [self._operand(code, some, np.arange(rows)[:, None]) for some in lists]
            elementary = Body(code.writer, {})
            text = code.text(rows, 1, lambda r, q, p: elementary.elementary(name, [v(r, q, p) for v in values]))
            return self._called(code, text, rows)
        table, first = x.value
        longest = int(table.counts.max())
        uneven = longest * table.rows > PADDING * len(table.factors)
        places, factors = (table.places, table.factors) if uneven else table.padded()
        values = [
            self._operand(code, some, place)
            for some, place in zip((x.args[:first], x.args[first:]), places, strict=False)
        ]
        if not bool((factors == 1).all()):
            values.append(code.numbers(factors))

        def term(r: str, q: str, p: str) -> str:
            product, *others = [v(r, q, p) for v in values]
            for other in others:
                product = code.writer.binary("fmul", product, other)
            return product

        text = code.text(table.rows, np.append(0, np.cumsum(table.counts)) if uneven else longest, term)
        return self._called(code, text, table.rows)

    def _called(self, code: _LoopWriter, text: str, rows: int) -> int:
        """Write the call of a function, which is written once for all calls; the place of its results."""
        w, out = self.writer, self.writer.reserve(rows)
        if text not in w.loops:
            w.loops[text] = f"@loop{len(w.loops)}"
            w.functions[w.loops[text]] = text.replace("@loop", w.loops[text], 1)
        starts = [f"ptr {w.slot(place)}" for place in (out, *code.starts)]
        splats = [f"{w.vector} {w.splat(x)}" for x in code.splats]
        w.lines.append(f"  call void {w.loops[text]}({', '.join([*starts, *splats])})")
        return out

    def _operand(self, code: _LoopWriter, some: Sequence[Expr], places: IntegerArray) -> Value:
        """How the numbers at places (rows, terms) or (all terms,) of a list are loaded."""
        if all(a.constant for a in some):
            return code.numbers(np.array([a.value for a in some], dtype=np.float64)[places])
        return code.loaded(np.array([self._slot(a) for a in some])[places])

    def _slot(self, x: Expr) -> int:
        """Place of a number in memory, to which it is stored if it is not there."""
        if x.index not in self._slots:
            w, name = self.writer, self.name(x)
            place = w.reserve(1)
            w.lines.append(f"  store {w.vector} {name}, ptr {w.slot(place)}, align 8")
            self._slots[x.index] = place
        return self._slots[x.index]


PADDING = 1.5  # largest ratio of the terms of a table to those it really has, if short rows are filled up with zeros
ROWS_AT_ONCE = 4
LEAST_VECTORS = 16  # terms from which on LLVM may sum them in vectors, where a block has one lane
Value: TypeAlias = Callable[[str, str, str], str]
"""The name of a value, from the names of the row, of the term within it, and of the term within all."""


@final
class _LoopWriter:
    """Writer of a function (results, operands, numbers) with loops over rows and their terms. The operands of its calls
    are at different places in memory; the numbers are constants that are the same for all terms."""

    def __init__(self, caller: Writer) -> None:
        self.writer = w = Writer(caller.width)
        w.tables, w.declared, w.functions, w.label = caller.tables, caller.declared, caller.functions, "entry"
        self.starts: list[int] = []
        self.splats: list[float] = []

    def loaded(self, slots: IntegerArray) -> Value:
        """How numbers at places (rows, terms) or (all terms,) in memory are loaded."""
        w, start = self.writer, int(slots.min())
        slots, base = slots - start, f"%a{len(self.starts)}"
        self.starts.append(start)
        first = int(slots.flat[0])
        down = int(slots[1].flat[0]) - first if len(slots) > 1 else 0
        along = int(slots[0, 1]) - first if slots.ndim == 2 and slots.shape[1] > 1 else 0
        steps = first + down * np.arange(len(slots))[:, None] + along * np.arange(slots.shape[-1])
        straight = slots.ndim == 2 and np.array_equal(slots, steps)

        def value(r: str, q: str, p: str) -> str:
            if straight:
                place = w.emit(f"add i64 {w.emit(f'mul i64 {r}, {down}')}, {w.emit(f'mul i64 {q}, {along}')}")
                place = w.emit(f"add i64 {place}, {first}") if first else place
            else:
                here = w.emit(f"getelementptr i32, ptr {w.table(slots.reshape(-1))}, i64 {p}")
                place = w.emit(f"zext i32 {w.emit(f'load i32, ptr {here}')} to i64")
            here = w.emit(f"getelementptr {w.vector}, ptr {base}, i64 {place}")
            return w.emit(f"load {w.vector}, ptr {here}, align 8")

        return value

    def numbers(self, values: Array) -> Value:
        """How constants are loaded, one for each term."""
        w = self.writer
        if bool((values == values.flat[0]).all()):
            self.splats.append(float(values.flat[0]))
            name = f"%c{len(self.splats) - 1}"
            return lambda r, q, p: name

        def value(r: str, q: str, p: str) -> str:
            here = w.emit(f"getelementptr double, ptr {w.table(values.reshape(-1))}, i64 {p}")
            return w.spread(w.emit(f"load double, ptr {here}, align 8"))

        return value

    def text(self, rows: int, terms: int | IntegerArray, term: Value) -> str:
        """The function that stores the sums of each row, of `terms` terms, or of those from where an array says."""
        w = self.writer
        alone = not isinstance(terms, int) or (terms == 1 and w.width == 1)  # LLVM puts rows of one term into vectors
        whole = 0 if alone else rows - rows % ROWS_AT_ONCE
        for span, step in (((0, whole), ROWS_AT_ONCE), ((whole, rows), 1)):
            if span[0] < span[1]:
                self._rows(span, step, terms, term)
        given = ["ptr noalias %out", *[f"ptr noalias readonly %a{i}" for i in range(len(self.starts))]]
        given += [f"{w.vector} %c{i}" for i in range(len(self.splats))]
        head = f"define internal void @loop({', '.join(given)}) noinline #0 {{\nentry:"
        return "\n".join([head, *w.lines, "  ret void", "}"])

    def _rows(self, span: tuple[int, int], step: int, terms: int | IntegerArray, term: Value) -> None:
        """Write the loop over some rows, several of them at once."""
        w, before = self.writer, self.writer.label
        outer = w.begun("rows")
        place, r = len(w.lines), f"%{outer}.r"
        some = [w.emit(f"add i64 {r}, {i}") for i in range(step)]
        if not isinstance(terms, int):
            ends = [w.emit(f"getelementptr i32, ptr {w.table(terms)}, i64 {i}") for i in (r, w.emit(f"add i64 {r}, 1"))]
            begin, end = (w.emit(f"zext i32 {w.emit(f'load i32, ptr {x}')} to i64") for x in ends)
            totals = self._sums(begin, end, lambda q: [term(r, q, q)])
        elif terms == 1:
            totals = [term(i, "0", i) for i in some]
        else:
            first = [w.emit(f"mul i64 {i}, {terms}") for i in some]
            each = list(zip(some, first, strict=True))
            totals = self._sums("0", terms, lambda q: [term(i, q, w.emit(f"add i64 {a}, {q}")) for i, a in each])
        for i, total in zip(some, totals, strict=True):
            here = w.emit(f"getelementptr {w.vector}, ptr %out, i64 {i}")
            w.lines.append(f"  store {w.vector} {total}, ptr {here}, align 8")
        w.lines += [f"  {r}.next = add i64 {r}, {step}", f"  {r}.more = icmp slt i64 {r}.next, {span[1]}"]
        w.lines.insert(place, f"  {r} = phi i64 [{span[0]}, %{before}], [{r}.next, %{w.label}]")
        w.begun("after", f"br i1 {r}.more, label %{outer}, label")

    def _sums(self, begin: str, end: str | int, terms: Callable[[str], list[str]]) -> list[str]:
        """Write the loop over terms; the names of the sums, which LLVM may sum in another order."""
        w, before = self.writer, self.writer.label
        inner = w.begun("terms")
        place, q = len(w.lines), f"%{inner}.q"
        values = terms(q)
        sums = [f"%{inner}.{i}" for i in range(len(values))]
        w.lines[place:place] = [
            f"  {q} = phi i64 [{begin}, %{before}], [{q}.next, %{inner}]",
            *[f"  {s} = phi {w.vector} [{w.splat(0.0)}, %{before}], [{s}.next, %{inner}]" for s in sums],
        ]
        added = zip(sums, values, strict=True)
        w.lines += [f"  {s}.next = fadd reassoc {FLAGS} {w.vector} {s}, {x}" for s, x in added]
        w.lines += [f"  {q}.next = add i64 {q}, 1", f"  {q}.more = icmp slt i64 {q}.next, {end}"]
        w.begun("summed", f"br i1 {q}.more, label %{inner}, label")
        if isinstance(end, int) and end < LEAST_VECTORS:
            w.lines[-2] += ", !llvm.loop !2"
        return [f"{s}.next" for s in sums]
