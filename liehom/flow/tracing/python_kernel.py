"""Python code of a run, for machines without a compiler: straight-line code on floats, a statement for each operation.

A step is one function of numbers. Python raises errors where arithmetic gives inf or NaN (1 / 0, the root of -1); such
a step is made again by the same code on numpy's numbers, which raise none.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from typing import Any, TypeAlias, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import TraceError
from liehom.flow.tracing.graph import COARSE, FOLDED, OPERATORS, Expr, needed
from liehom.flow.tracing.llvm_text import LEVELS, LIBM, LONG_SERIES_REACH, MAX_NORM, rotation_series
from liehom.flow.tracing.machine import Kernel
from liehom.flow.tracing.run_text import DONE, FAILED, Constant

Numbers: TypeAlias = Sequence[Any]  # Python's floats and booleans
SIGNS = {"add": "+", "sub": "-", "mul": "*", "div": "/", "lt": "<", "le": "<=", "eq": "==", "ne": "!=", "and": " and "}
DEEPEST = 20  # operations in one statement, one within the other
TOP = LEVELS[-1][0]


class _Text:
    """Writer of functions that compute expressions; an operation that is needed once is written where it is needed."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self._functions: dict[str, str] = {}
        self._texts: dict[int, tuple[str, int]] = {}
        self._uses: Counter[int] = Counter()
        self._loops: dict[int, list[str]] = {}

    def function(self, name: str, parameters: Sequence[str], outputs: Sequence[Expr | float]) -> None:
        """Write a function of the parameters, "x0" for input 0 and "c1" for input -1, that returns the outputs."""
        exprs = [x for x in outputs if isinstance(x, Expr)]
        self._texts, operations = {}, needed(exprs)
        self._uses = Counter(x.index for x in exprs)
        self._count(operations)
        self.lines.append(f"def {name}({', '.join(parameters)}):")
        self._write(operations, " ")
        values = [self._text(x) if isinstance(x, Expr) else repr(x) for x in outputs]
        self.lines.append(f" return ({''.join(f'{v}, ' for v in values)})")

    def compiled(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """The functions by name, on Python's floats and on numpy's numbers."""
        texts = [*self._functions.values(), _rotation("sinq"), _rotation("cosq"), *self.lines]
        code = compile("\n".join(texts), "a step of liehom", "exec")
        spaces = _spaces()
        for space in spaces:
            exec(code, space)
        return spaces

    def _count(self, operations: Sequence[Expr]) -> None:
        """Count where values are needed: what a loop takes from outside has a name, so that it is computed once."""
        for x in operations:
            self._uses.update(a.index for a in x.args)
            if x.op == "loop":
                self._uses.update(a.index for a in (*x.args, *x.value.new, x.value.again))
                self._count(x.value.inside)

    def _text(self, x: Expr) -> str:
        if x.constant:
            return repr(x.value) if isinstance(x.value, bool) else _literal(x.value)
        return self._texts[x.index][0]

    def _write(self, operations: Sequence[Expr], indent: str) -> None:
        for x in operations:
            if x.constant or x.index in self._texts:
                continue
            if x.op == "loop":
                self._write_loop(x, indent)
                continue
            depth = 1 + max((self._texts[a.index][1] for a in x.args if a.index in self._texts), default=0)
            text, plain = self._expression(x, indent)
            if not plain and (self._uses[x.index] > 1 or depth > DEEPEST):
                self.lines.append(f"{indent}v{x.index}={text}")
                text, plain, depth = f"v{x.index}", True, 0
            self._texts[x.index] = (text if plain else f"({text})"), depth

    def _expression(self, x: Expr, indent: str) -> tuple[str, bool]:
        """The text of an operation, and whether it is a name."""
        args = [self._text(a) for a in x.args if a.op not in ("loop", "expv")]
        match x.op:
            case "input":
                return (f"x{x.value}" if x.value >= 0 else f"c{-x.value}"), True
            case "get":
                block = x.args[0]
                return (self._loops[block.index][x.value] if block.op == "loop" else f"b{block.index}[{x.value}]"), True
            case "expv":
                name = self._exponential(x.value, len(x.args) - len(x.value))
                self.lines.append(f"{indent}b{x.index}={name}({', '.join(args)})")
                return f"b{x.index}", True
            case "neg":
                return f"-{args[0]}", False
            case "not":
                return f"not {args[0]}", False
            case "select":
                return f"{args[1]} if {args[0]} else {args[2]}", False
            case op if op in SIGNS:
                if all(a.constant for a in x.args):  # as 1 / 0, which is not known to the tape
                    with np.errstate(all="ignore"):
                        return _literal(float(OPERATORS[op](*[np.float64(a.value) for a in x.args]))), True
                return SIGNS[op].join(args), False
            case op if op in FOLDED:
                return f"{op}({', '.join(args)})", False
            case op:
                raise TraceError(f"the operation {op} has no Python code here")

    def _write_loop(self, x: Expr, indent: str) -> None:
        loop = x.value
        names = [f"u{x.index}_{i}" for i in range(len(loop.variables))]
        self._loops[x.index] = names
        self._texts |= {v.index: (name, 0) for v, name in zip(loop.variables, names, strict=True)}
        starts = ", ".join(self._text(a) for a in x.args[: len(names)])
        self.lines.append(f"{indent}{', '.join(names)},={starts},")
        limit = f"{loop.limit} if {names[0]} else 0" if loop.guarded else f"{loop.limit}"
        self.lines.append(f"{indent}for _ in range({limit}):")
        self._write(loop.inside, indent + " ")
        new, again = [self._text(y) for y in loop.new], self._text(loop.again)
        last = f"again{x.index}"
        self.lines.append(f"{indent} {last}, {', '.join(names)}={again}, {', '.join(new)}")
        self.lines.append(f"{indent} if not {last}: break")

    def _exponential(self, places: Sequence[tuple[int, int]], n: int) -> str:
        """The name of the function (A, m) -> exp(A) m for the places of the entries of A, by its Taylor polynomial."""
        name = "exponential_" + "_".join(f"{i}_{j}" for i, j in places) + f"_{n}"
        entries = [f"a{p}" for p in range(len(places))]
        point, sums = ([f"{letter}{i}" for i in range(n)] for letter in "vs")
        products = [(i, f"{a}*{sums[j]}") for a, (i, j) in zip(entries, places, strict=True)]
        rows = ["+".join(text for k, text in products if k == i) for i in range(n)]
        terms = [f"{v}+({row})/k" if row else v for v, row in zip(point, rows, strict=True)]
        joined = [", ".join(x) for x in (entries, point, sums, terms)]
        self._functions[name] = f"""\
def {name}({joined[0]}, {joined[1]}):
 q={"+".join(f"{a}*{a}" for a in entries)}
 parts=1
 if not q<={TOP * TOP!r}:
  if not q<={MAX_NORM * MAX_NORM!r}: return ({"nan, " * n})
  parts=int(ceil(sqrt(q)/{TOP!r}))
  w=1.0/parts
  q=q*w*w
  {joined[0]},={", ".join(f"{a}*w" for a in entries)},
 degree={"".join(f"{d} if q<={r * r!r} else " for r, d in LEVELS[:-1])}{LEVELS[-1][1]}
 for _ in range(parts):
  {joined[2]},={joined[1]},
  for k in range(degree, 0, -1):
   {joined[2]},={joined[3]},
  {joined[1]},={joined[2]},
 return ({joined[1]},)"""
        return name


def _literal(x: float) -> str:
    """A number as it is written in Python, in parentheses if it is negative."""
    return f"({x!r})" if x < 0 or math.copysign(1.0, x) < 0 else repr(float(x))


def _rotation(name: str) -> str:
    """The function q -> sin(r)/r or cos(r), r^2 = q: a polynomial near 0."""
    first = int(name == "sinq")
    series = [repr(c) for c in rotation_series(LONG_SERIES_REACH, first)]
    far = ("sin(r)/r if q>0 else sinh(r)/r", "cos(r) if q>0 else cosh(r)")[1 - first]
    horner = "*q+".join(["(" * (len(series) - 1) + series[-1], *(f"{c})" for c in series[-2::-1])])
    return f"""\
def {name}(q):
 if {-LONG_SERIES_REACH}<=q<={LONG_SERIES_REACH}: return {horner}
 r=sqrt(abs(q))
 return {far}"""


def _spaces() -> tuple[dict[str, Any], dict[str, Any]]:
    """The functions that the code names, on Python's floats and on numpy's numbers."""
    names = {"inf": math.inf, "nan": math.nan, "abs": abs}
    in_python = {name: getattr(math, LIBM.get(name, name)) for name in (*LIBM, "sqrt", "ceil")}
    in_numpy = {name: getattr(np, {"pow": "power"}.get(name, name)) for name in (*LIBM, "sqrt", "ceil")}
    return {**names, **in_python, **{name: FOLDED[name] for name in COARSE}}, {**names, **in_numpy, **COARSE}


@final
class PythonKernel(Kernel):
    """The run of a traced step in Python, one lane after the other; attributes and argument are those of `Kernel`."""

    engine, in_lockstep = "python", False

    def _build(self, constants: Sequence[Constant]) -> None:
        graph, n, text = self.graph, self.graph.size, _Text()
        given = [f"c{i + 1}" for i in range(len(constants))]
        starts, own = [f"x{i}" for i in range(n + 1)], [x for x in constants if isinstance(x, Expr)]
        text.function("begin", [*starts[:n], *given], [*own, True if graph.guard is None else graph.guard])
        text.function("first", [*starts, *given], [math.inf if graph.first is None else graph.first])
        sizes = graph.sizes
        outputs: list[Expr | float | None] = [
            graph.elapsed, graph.ordinary, None if sizes is None else sizes.accepted,
            None if sizes is None else sizes.proposal, graph.tried, graph.reached,
            *graph.largest.values(), *graph.summed.values(),
        ]  # fmt: skip
        wanted = [*graph.point, *(True if x is None else x for x in outputs)]
        text.function("step", [*starts, f"x{n + 1}", f"x{n + 2}", *given], wanted)
        self._constants, self._spaces = constants, text.compiled()

    def _called(self, name: str, *args: float) -> Numbers:
        """The values of a function; by numpy where Python has no number."""
        try:
            return self._spaces[0][name](*args)
        except (ArithmeticError, ValueError):
            values: list[float] = np.array(self._spaces[1][name](*map(np.float64, args)), dtype=np.float64).tolist()
            return values

    def __call__(self, state: npt.NDArray[np.float64], **fields: npt.NDArray[Any] | float | None) -> None:
        known: dict[str, Any] = {"first": 0, "last": state.shape[1], **fields}
        for lane in range(known["first"], known["last"]):
            row = dict(zip(self.names, state[:, lane].tolist(), strict=True))
            start: list[float] = known["start"][: self.graph.size, lane].tolist()
            given, may_begin = self._given(start, lane, known)
            if not may_begin:
                row["alive"] = FAILED
            elif row["alive"] > 0:
                self._run(row, given, lane, known)
            state[:, lane] = list(row.values())

    def _given(self, start: list[float], lane: int, fields: dict[str, Any]) -> tuple[list[float], bool]:
        """The values of inputs -1, -2, ... of a lane, and whether it may begin at its point."""
        known = [0.0] * len(self._constants)
        for place, x in enumerate(self._constants):
            if not isinstance(x, Expr):
                known[place] = float(fields["constants"][x[1]] if x[0] == "run" else fields["rows"][x[1], lane])
        *computed, may_begin = self._called("begin", *start, *known)
        own = iter(computed)
        given = [next(own) if isinstance(x, Expr) else y for x, y in zip(self._constants, known, strict=True)]
        return given, bool(may_begin)

    def _record(self, row: dict[str, float], values: Numbers) -> None:
        """Take over the largest and the summed numbers of a step."""
        for i, value in enumerate(values):
            name = f"e{i}"
            if i >= len(self.graph.largest):
                row[name] += value
            elif value > row[name]:
                row[name] = value

    def _run(self, row: dict[str, float], given: list[float], lane: int, fields: dict[str, Any]) -> None:
        """Steps of a lane with its own sizes and times."""
        n, stops, last = self.graph.size, fields["stops"].tolist(), fields["last_stop"]
        out, path, begin = fields["out"], fields["path"], fields["begin"]
        point: Numbers = list(row.values())[:n]
        time, size, stop = row["t"], row["h"], int(row["stop"])
        if size == math.inf:
            size = self._called("first", *point, time, *given)[0]
        adapted, counted = self.graph.sizes is not None, self.graph.elapsed is None
        for k in range(begin, fields["end"]):
            new = self._called("step", *point, time, size, stops[stop], *given)
            total, (elapsed, ordinary, accepted, proposal, tried, reached) = sum(new[:n]), new[n : n + 6]
            if not (ordinary and total - total == 0):
                row["alive"] = FAILED
                break
            ends = reached and stop >= last
            if reached:
                if not ends or accepted:
                    out[stop, :, lane] = new[:n]
                if not ends:
                    stop += 1
                    continue
            if adapted:
                row["tries"] += 1
            if accepted:
                row["count"] += 1
                self._record(row, new[n + 6 :])
                point = new[:n]
                time = stops[stop] if ends else fields["origin"] + row["count"] * size if counted else time + elapsed
                if path is not None:
                    path[k - begin, :, lane] = *point, time, tried if self.graph.tried is not None else size
                if adapted:
                    row["kept"] = stop
            else:
                stop = int(row["kept"])
            size = proposal if adapted else size
            if accepted and ends:
                row["alive"] = DONE
                break
        row.update(zip(self.names, point, strict=False))
        row.update(t=time, h=size, stop=stop)
