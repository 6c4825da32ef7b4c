"""exp(A) m in LLVM assembly: the Taylor polynomial by Horner's rule, of a degree that follows from the norm of A.

The degrees go up in levels. A block of lanes enters at the level of its largest norm; where the level of a lane begins,
the lane begins too. So the result of a lane does not depend on the other lanes of the block.
"""

from __future__ import annotations

import math
from typing import final

from liehom.tracing.expr import Expr
from liehom.tracing.machine_code.writer import Writer, number

LEVELS = ((0.054, 8), (0.28, 12), (0.72, 16), (1.35, 20), (2.1, 24))
"""Norms up to which a polynomial of a degree leaves out less than 1e-17 of the result."""
MAX_NORM = 32.0
"""For |A| above, the result is NaN."""
STRAIGHT_OPERATIONS = 40
"""Numbers of A and m, together, up to which the polynomial is written without loops."""


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
        made = self._levels()
        f.lines.append(f"  %part.next = fadd {v} %part, {f.splat(1.0)}")
        here = f.emit(f"fcmp olt {v} %part, %parts")
        for i, x in enumerate(made):
            f.lines.append(f"  %m{i}.next = select {f.mask} {here}, {v} {x}, {v} %m{i}")
        again = f.any(f.emit(f"fcmp olt {v} %part.next, %parts"))
        f.lines += ["  br label %end", "end:", f"  br i1 {again}, label %substep, label %done, !prof !0", "done:"]
        result, whole = struct_of(f, n), "poison"
        for i in range(n):
            whole = f.emit(f"insertvalue {result} {whole}, {v} %m{i}.next, {i}")
        names = [f"%a{p}" for p in range(len(self.places))] + [f"%vin{i}" for i in range(n)]
        self.caller.declared |= f.declared
        head = f'define internal {result} @"{self.name}"({", ".join(f"{v} {x}" for x in names)}) {{\nentry:'
        return "\n".join([head, *f.lines, f"  ret {result} {whole}", "}"])

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
        f.lines += ["  br label %substep.first", "substep.first:"]
        for name, plain, other in [
            ("parts", f.splat(1.0), parts),
            ("square", square, smaller),
            *[(f"b{p}", f"%a{p}", x) for p, x in enumerate(scaled)],
        ]:
            f.lines.append(f"  %{name} = phi {v} [{plain}, %entry], [{other}, %large]")
        f.lines += ["  br label %substep", "substep:"]
        f.lines.append(f"  %part = phi {v} [{f.splat(0.0)}, %substep.first], [%part.next, %end]")
        for i in range(self.n):
            f.lines.append(f"  %m{i} = phi {v} [%vin{i}, %substep.first], [%m{i}.next, %end]")

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
            f.lines.append(f"level{level}:")
            f.label = f"level{level}"
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
            f.lines += [f"enter{level}.test:"]
            following = f"enter{level + 1}.test" if level + 1 < top else f"level{top}"
            f.lines.append(f"  br i1 {above[level]}, label %{following}, label %enter{level}")
            f.lines += [f"enter{level}:", f"  br label %begin{level}"]

    def _terms(self, s: list[str], level: int) -> list[str]:
        """s -> m + A s / k for the k of a level, from the largest to the smallest."""
        f = self.f
        first, last = LEVELS[level][1], LEVELS[level - 1][1] if level else 0
        if self.straight:
            for k in range(first, last, -1):
                s = self._term(s, f.splat(1.0 / k))
            return s
        before = f.label
        f.lines += [f"  br label %terms{level}", f"terms{level}:"]
        f.lines.append(f"  %k{level} = phi double [{number(float(first))}, %{before}], [%k{level}.next, %terms{level}]")
        for i in range(self.n):
            f.lines.append(f"  %s{level}.{i} = phi {self.v} [{s[i]}, %{before}], [%s{level}.{i}.next, %terms{level}]")
        over = f.spread(f.emit(f"fdiv double {number(1.0)}, %k{level}"))
        made = self._term([f"%s{level}.{i}" for i in range(self.n)], over)
        for i, x in enumerate(made):
            f.lines.append(f"  %s{level}.{i}.next = fadd {self.v} {x}, {f.splat(-0.0)}")
        f.lines.append(f"  %k{level}.next = fsub double %k{level}, {number(1.0)}")
        more = f.emit(f"fcmp ogt double %k{level}.next, {number(float(last))}")
        f.lines += [f"  br i1 {more}, label %terms{level}, label %terms{level}.end", f"terms{level}.end:"]
        f.label = f"terms{level}.end"
        return [f"%s{level}.{i}.next" for i in range(self.n)]

    def _term(self, s: list[str], factor: str) -> list[str]:
        """m + factor A s."""
        f, made = self.f, []
        for i in range(self.n):
            total = None
            for p, (a, b) in enumerate(self.places):
                if a == i:
                    term = f.binary("fmul", f"%b{p}", s[b])
                    total = term if total is None else f.binary("fadd", term, total)
            made.append(f"%m{i}" if total is None else f.binary("fadd", f.binary("fmul", total, factor), f"%m{i}"))
        return made
