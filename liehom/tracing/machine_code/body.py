"""Body: the operations of a graph as LLVM assembly, straight-line code with one instruction per operation.

Operations that need branches or loops become separate functions, which branch for all lanes of a block together:
sin(r)/r near 0 and far from 0, exp(A) m by polynomials.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

from liehom.errors import TraceError
from liehom.tracing.expr import Expr
from liehom.tracing.machine_code.exponential import call_exponential, struct_of
from liehom.tracing.machine_code.rotation import define_rotation
from liehom.tracing.machine_code.writer import LIBM, Writer

COMPARED = {"lt": "olt", "le": "ole", "eq": "oeq", "ne": "une"}


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
            return w.emit(
                f"extractvalue {struct_of(w, len(x.args[0].args) - len(x.args[0].value))} {args[0]}, {x.value}"
            )
        if x.op == "expv":
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
            define_rotation(w)
            pair = w.emit(f"call {{{w.vector}, {w.vector}}} @rotation({w.vector} {name})")
            self._pairs[q.index] = (
                w.emit(f"extractvalue {{{w.vector}, {w.vector}}} {pair}, 0"),
                w.emit(f"extractvalue {{{w.vector}, {w.vector}}} {pair}, 1"),
            )
        return self._pairs[q.index]
