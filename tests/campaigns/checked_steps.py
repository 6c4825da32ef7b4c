"""Whether adaptive steps jump over features of psi, counted for the engines of liehom and for other programs.

    python -m tests.campaigns.checked_steps [--engine numpy] [--step default] [--looks 128] [--part 0/4] OUT.json
    python -m tests.campaigns.checked_steps --engine scipy --step DOP853 OUT.json
    python -m tests.campaigns.checked_steps report OUT.json ...
    python -m tests.campaigns.checked_steps table [--only "llvm rk45" ...] [--render]

`table` runs rows of the table of docs/step-sizes.md, each an engine with a step, all of them if none is named. Their
figures are kept in docs/_static/checked_steps.json after every row, and the table of the page is written again.
The fields are those of `checked_fields.py`. A run is wrong if it reports success and its error at the end is above
100 times the larger of the tolerance there, atol sqrt(N) + rtol |m|, and the error of scipy's DOP853 with the same
tolerances and steps of at most twice the narrowest feature; the second bound is for fields that amplify errors.
"DOP853 not" counts those of them for which the error of DOP853 without a bound of its steps is 100 times smaller, too.
The reference is DOP853 at 1e-13 with steps of at most half the narrowest feature. References are stored by the content
of the field (`--references`). Times are processor time, with compilation.

A step is "default", a name of `liehom.methods.step_names`, or "euler:4", a name with the order to reach.
"""

from __future__ import annotations

import argparse
import hashlib
import inspect
import json
import os
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import liehom as lh
from tests.campaigns.checked_fields import BRANCHING, SHAPES, Group, groups

RTOLS = (1e-4, 1e-6, 1e-9)
FACTOR = 100.0
RESOLVED = 1 / 250  # width in units of the span that a checked step is expected to see, counted as "wide"
MOST_STEPS = 20_000
ENGINES = ("numpy", "llvm", "jax")
DATA = Path(__file__).resolve().parents[2] / "docs" / "_static" / "checked_steps.json"
PROGRAMS = {
    'the default, `engine="numpy"`': "numpy default",
    'the default, `engine="llvm"`': "llvm default",
    'the default, `engine="jax"`': "jax default",
    "`LieTaylor(6)`": "llvm lietaylor:6",
    "`Corrected(Euler(), 4)`": "llvm corrected:4",
    **{f'`"{name}"`': f"llvm {name}" for name in ("rk45", "dop853", "rodas4", "radau5")},
    **{f"scipy {name}": f"scipy {name}" for name in ("DOP853", "LSODA", "RK45")},
    "heyoka.py": "heyoka taylor",
}
"""The rows of the table: a program as the page names it, and the engine and the step of its runs."""
Row = dict[str, Any]


def tolerances(rtol: float) -> dict[str, float]:
    return {"rtol": rtol, "atol": 1e-3 * rtol}


def allowed(rtol: float, m: np.ndarray) -> float:
    """2-norm of the error that a step may make at m."""
    return float(1e-3 * rtol * len(m) ** 0.5 + rtol * np.linalg.norm(m))


# -- references ------------------------------------------------------------------------------------------


def key(group: Group, j: int) -> str:
    """Digest of all that the end of a field follows from."""
    values = [(name, np.asarray(x[j]).tolist()) for name, x in sorted(group.args.items())]
    values += [("default", x) for x in group.psi.__defaults__ or ()]
    space, psi = group.space_of, inspect.getsource(SHAPES.get(group.name, group.psi))
    constants = [space.start.tolist(), space.linear.tolist(), space.matrices.tolist()]
    return hashlib.sha256(repr((group.span, psi, values, constants)).encode()).hexdigest()[:20]


def reference(group: Group, j: int) -> Row:
    """The end of a field, and the errors of DOP853 at the tolerances, without and with bounded steps."""
    rhs, start = group.rhs(j), group.space_of.start
    length = abs(group.span[1] - group.span[0])
    most = min(length / 20, group.widths[j] * length / 2)
    with np.errstate(all="ignore"):
        whole = solve_ivp(rhs, group.span, start, method="DOP853", rtol=1e-13, atol=1e-15, max_step=most)
        if not whole.success:
            raise RuntimeError(f"no reference for {group.names[j]}: {whole.message}")
        plain, bounded = (
            [
                solve_ivp(rhs, group.span, start, method="DOP853", max_step=h, **tolerances(rtol)).y[:, -1]
                for rtol in RTOLS
            ]
            for h in (np.inf, 4 * most)
        )
    end = whole.y[:, -1]
    errors = {"dop853": plain, "resolved": bounded}
    return {"end": end.tolist()} | {
        name: [float(np.linalg.norm(x - end)) for x in ends] for name, ends in errors.items()
    }


class References:
    """References by key, in a file that grows."""

    def __init__(self, path: Path | None) -> None:
        self.path = path
        self.known: dict[str, Row] = json.loads(path.read_text()) if path is not None and path.exists() else {}

    def of(self, group: Group) -> list[Row]:
        for j in range(len(group.widths)):
            if key(group, j) not in self.known:
                self.known[key(group, j)] = reference(group, j)
        return [self.known[key(group, j)] for j in range(len(group.widths))]

    def write(self) -> None:
        if self.path is not None:
            self.path.write_text(json.dumps(self.known))


# -- runs: for each field of a group (end or None, success, steps, message) --------------------------------------------

Run = tuple[np.ndarray | None, bool, int, str]


def step_of(text: str) -> lh.Step | None:
    name, _, order = text.partition(":")
    if name.startswith("corrected"):  # corrected:4 of Euler, corrected-heun:4 of another base
        return lh.Corrected(lh.methods.step_named(name.partition("-")[2] or "euler"), int(order))
    return None if text == "default" else lh.methods.step_named(name, int(order) if order else None)


def of_liehom(group: Group, engine: str, step: str, rtol: float, options: dict[str, Any]) -> list[Run]:
    """All fields of a group as one ensemble."""
    field = lh.GeneratorField(group.space_of.rho, group.psi)
    args = {name: lh.PerTrajectory(x) for name, x in group.args.items()} or None
    count = len(group.widths)
    start = np.tile(group.space_of.start, (count, 1)) if group.args else group.space_of.start
    with np.errstate(all="ignore"):
        solution = lh.integrate(
            field, group.span, start, args=args, engine=engine, step=step_of(step),
            max_steps=MOST_STEPS, **tolerances(rtol), **options,
        )  # fmt: skip
    y, steps = solution.y.reshape(count, -1, solution.y.shape[-1]), np.reshape(solution.n_steps, -1)
    statuses = np.reshape(solution.statuses, -1)
    return [(y[j, :, steps[j]], bool(statuses[j] >= 0), int(steps[j]), solution.message) for j in range(count)]


def of_scipy(group: Group, engine: str, step: str, rtol: float, options: dict[str, Any]) -> list[Run]:
    runs: list[Run] = []
    for j in range(len(group.widths)):
        with np.errstate(all="ignore"):
            found = solve_ivp(group.rhs(j), group.span, group.space_of.start, method=step, **tolerances(rtol))
        runs.append((found.y[:, -1], found.success, len(found.t) - 1, found.message))
    return runs


class Symbol:
    """An expression of heyoka on which functions of numpy run, as an object in arrays."""

    def __init__(self, expression: Any) -> None:
        self.expression = expression

    def __getitem__(self, index: object) -> np.ndarray:
        return np.array([self], dtype=object)


def _symbol_methods() -> None:
    import heyoka as hy

    def operator(name: str) -> Callable[[Symbol, Any], Any]:
        def apply(x: Symbol, y: Any) -> Any:
            if isinstance(y, np.ndarray):
                return NotImplemented
            return Symbol(
                getattr(x.expression, name)(y.expression if isinstance(y, Symbol) else hy.expression(float(y)))
            )

        return apply

    for name in ("add", "sub", "mul", "truediv"):
        setattr(Symbol, f"__{name}__", operator(f"__{name}__"))
    Symbol.__radd__, Symbol.__rmul__ = Symbol.__add__, Symbol.__mul__  # type: ignore[attr-defined]
    Symbol.__rsub__ = lambda x, y: Symbol(hy.expression(float(y))) - x  # type: ignore[attr-defined]
    Symbol.__rtruediv__ = lambda x, y: Symbol(hy.expression(float(y))) / x  # type: ignore[attr-defined]
    Symbol.__neg__ = lambda x: x * -1.0  # type: ignore[attr-defined]
    Symbol.__pow__ = lambda x, n: Symbol(x.expression ** float(n))  # type: ignore[attr-defined]
    for name in ("exp", "log", "sin", "cos", "tanh", "cosh", "sqrt", "arctan"):
        function = getattr(hy, {"arctan": "atan"}.get(name, name))
        setattr(Symbol, name, lambda x, f=function: Symbol(f(x.expression)))


def of_heyoka(group: Group, engine: str, step: str, rtol: float, options: dict[str, Any]) -> list[Run]:
    import heyoka as hy

    if not hasattr(Symbol, "exp"):
        _symbol_methods()
    names = hy.make_vars(*[f"m{i}" for i in range(len(group.space_of.start))])
    args, values = {}, []
    for name, x in sorted(group.args.items()):
        flat = x.reshape(len(x), -1)
        entries = [Symbol(hy.par[len(values) + i]) for i in range(flat.shape[1])]
        args[name] = np.array(entries, dtype=object).reshape(x.shape[1:]) if x.ndim > 1 else entries[0]
        values += list(flat.T)
    m = np.array([Symbol(x) for x in names], dtype=object)
    given = (m,) if group.autonomous else (m, Symbol(hy.time))
    psi = group.psi(*given, *([args] if group.args else []))
    matrices = group.space_of.matrices
    x = [
        sum(psi[r] * matrices[r][i, k] * m[k] for r, i, k in np.argwhere(matrices) if i == row) for row in range(len(m))
    ]
    x = [(e if isinstance(e, Symbol) else 0 * m[0]).expression for e in x]
    ta = hy.taylor_adaptive(list(zip(names, x, strict=True)), [0.0] * len(m), tol=rtol, compact_mode=True)
    runs: list[Run] = []
    for j in range(len(group.widths)):
        ta.time, ta.state[:] = group.span[0], group.space_of.start
        ta.pars[:] = [v[j] for v in values[: len(ta.pars)]]  # those after the last that psi uses are not there
        outcome, _, _, steps, *_ = ta.propagate_until(group.span[1], max_steps=MOST_STEPS)
        runs.append((np.array(ta.state), outcome == hy.taylor_outcome.time_limit, int(steps), str(outcome)))
    return runs


def rows(group: Group, engine: str, step: str, rtol: float, options: dict[str, Any], known: Sequence[Row]) -> list[Row]:
    """The rows of the fields of a group at one tolerance."""
    run = {"scipy": of_scipy, "heyoka": of_heyoka}.get(engine, of_liehom)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        begin = time.process_time()
        try:
            runs = run(group, engine, step, rtol, options)
        except lh.LiehomError as error:
            runs = [(None, False, 0, f"{type(error).__name__}: {error}")] * len(group.widths)
        spent = time.process_time() - begin
    found = []
    for j, (end, success, steps, message) in enumerate(runs):
        ideal = np.array(known[j]["end"])
        error = None if end is None else float(np.linalg.norm(end - ideal))
        found.append({
            "field": group.names[j], "width": float(group.widths[j]), "smooth": group.smooth, "rtol": rtol,
            "success": success, "error": error, "steps": steps, "message": "" if success else message,
            "tolerance": allowed(rtol, ideal),
            **{name: known[j][name][RTOLS.index(rtol)] for name in ("dop853", "resolved")},
            "cpu": spent / len(runs), "warnings": sorted({w.category.__name__ for w in caught}),
        })  # fmt: skip
    return found


# -- the judgement ---------------------------------------------------------------------------------------


def is_wrong(row: Row) -> bool:
    """Whether a run reports success with an error that neither the tolerance nor the field explains."""
    return row["success"] and not row["error"] <= FACTOR * max(row["tolerance"], row["resolved"])


def summary(found: Iterable[Row]) -> Row:
    """The figures of the rows of one program, step and tolerance."""
    table = list(found)
    smooth = [row for row in table if row["smooth"]]
    ran = [row for row in table if row["error"] is not None]
    wrong = [row for row in ran if is_wrong(row)]
    return {
        "runs": len(table), "refused": len(table) - len(ran), "failed": sum(not row["success"] for row in ran),
        "wrong": len(wrong), "DOP853 not": sum(not row["error"] <= FACTOR * row["dop853"] for row in wrong),
        "wide": sum(row["width"] >= RESOLVED for row in wrong),
        "smooth wrong": sum(row["smooth"] for row in wrong),
        "smooth failed": sum(not row["success"] for row in smooth),
        "smooth steps": sum(row["steps"] for row in smooth),
        "smooth ms": round(1e3 * sum(row["cpu"] for row in smooth)),
        "steps": sum(row["steps"] for row in table), "s": round(sum(row["cpu"] for row in table), 1),
    }  # fmt: skip


def report(paths: Sequence[Path], most: int) -> str:
    """One line for each program, step, looks and tolerance, then the wrong and the failed runs."""
    lines, details = [], []
    tables: dict[tuple[Any, ...], list[Row]] = {}
    for path in paths:
        data = json.loads(path.read_text())
        for row in data["rows"]:
            tables.setdefault((data["engine"], data["step"], data["looks"], row["rtol"]), []).append(row)
    for name, table in tables.items():
        figures = summary(table)
        if not lines:
            lines = [
                "| program | step | looks | rtol | " + " | ".join(figures) + " |",
                "|" + "---|" * (len(figures) + 4),
            ]
        lines.append("| " + " | ".join(map(str, (*name, *figures.values()))) + " |")
        bad = [row for row in table if row["error"] is not None and (is_wrong(row) or not row["success"])]
        for row in sorted(bad, key=lambda row: (row["success"], -row["width"]))[:most]:
            what = "wrong" if row["success"] else f"failed ({row['message'][:60]})"
            errors = f"error {row['error']:.1e}, DOP853 {row['dop853']:.0e}"
            text = f"{what}: width 1/{1 / row['width']:.0f}, {errors}, {row['steps']} steps"
            details.append(f"{' '.join(map(str, name))}: {row['field']} {text}")
        refused = Counter(row["message"][:100] for row in table if row["error"] is None)
        details += [f"{' '.join(map(str, name))}: {n} refused: {text}" for text, n in refused.items()]
        seen = Counter(category for row in table for category in row["warnings"])
        details += [f"{' '.join(map(str, name))}: {n} times {text}" for text, n in seen.items()]
    return "\n".join([*lines, "", *details])


def fits(group: Group, engine: str) -> bool:
    """Whether a program runs the fields of a group; jax compiles for minutes, so it runs those in ensembles only."""
    return not (engine == "heyoka" and group.name in BRANCHING) and not (engine == "jax" and not group.args)


def measured(
    some: Iterable[Group], engine: str, step: str, rtols: Sequence[float], options: dict[str, Any], stored: References
) -> list[Row]:
    """The rows of all fields that the program runs, at all tolerances."""
    if engine == "jax":  # else it compiles for an hour
        os.environ.setdefault("XLA_FLAGS", "--xla_backend_optimization_level=0")
    found: list[Row] = []
    for group in some:
        if fits(group, engine):
            known = stored.of(group)
            stored.write()
            for rtol in rtols:
                found += rows(group, engine, step, rtol, options, known)
    return found


# -- the table of the page -------------------------------------------------------------------------------


def figures(found: Sequence[Row], engine: str) -> Row:
    """What the page needs of a program: numbers by tolerance, and the wide runs of liehom that are wrong."""
    by_rtol = [summary(row for row in found if row["rtol"] == rtol) for rtol in RTOLS]
    smooth = [sum(row["smooth"] for row in found if row["rtol"] == rtol) for rtol in RTOLS]
    return {
        "date": time.strftime("%Y-%m-%d"),
        **{name: [x[name] for x in by_rtol] for name in ("runs", "refused", "failed", "wrong", "wide")},
        "smooth steps": [round(x["smooth steps"] / n, 1) for x, n in zip(by_rtol, smooth, strict=True)],
        "wide runs": [
            [row["field"], row["rtol"], round(1 / row["width"]), round(row["error"] / row["tolerance"]), row["steps"]]
            for row in found
            if engine in ENGINES and row["error"] is not None and is_wrong(row) and row["width"] >= RESOLVED
        ],
    }


def page_table() -> str:
    """One line for each program that has figures; three numbers are for the three tolerances."""
    known = json.loads(DATA.read_text(encoding="utf-8"))
    names = ("runs", "refused", "failed", "wrong", "wide", "smooth steps")
    lines = ["| program | fields | refused | failed | wrong | wide | steps |", "|---|" + "---:|" * len(names)]
    for title, row in ((title, known[row]) for title, row in PROGRAMS.items() if row in known):
        cells = [", ".join(f"{x:.0f}" for x in (row[k][:1] if len(set(row[k])) == 1 else row[k])) for k in names]
        lines.append(f"| {' | '.join([title, *cells])} |")
    return "\n".join(lines)


def table(given: Sequence[str]) -> None:
    """Run rows of the table, and write the file and the page again."""
    from tests.campaigns import report as pages

    parser = argparse.ArgumentParser(description="The table of docs/step-sizes.md.")
    parser.add_argument("--only", nargs="+", choices=PROGRAMS.values(), default=list(PROGRAMS.values()))
    parser.add_argument("--references", type=Path, default=STORED)
    parser.add_argument("--render", action="store_true", help="run nothing")
    chosen = parser.parse_args(given)
    for program in [] if chosen.render else chosen.only:
        engine, step = program.split()
        new = figures(measured(groups(2031), engine, step, RTOLS, {}, References(chosen.references)), engine)
        known = json.loads(DATA.read_text(encoding="utf-8")) if DATA.exists() else {}  # others may have written it
        known = {row: new if row == program else known.get(row) for row in PROGRAMS.values()}
        text = ",\n".join(f'"{row}": {json.dumps(x)}' for row, x in known.items() if x)
        DATA.write_text(f"{{\n{text}\n}}\n", encoding="utf-8")
        pages.main()
        print(program, json.dumps(new), f"{time.process_time():.0f} s", flush=True)
    pages.main()


STORED = Path(tempfile.gettempdir()) / "liehom-checked-references.json"


def main(arguments: Sequence[str] | None = None) -> None:
    given = list(sys.argv[1:] if arguments is None else arguments)
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    if given[:1] == ["table"]:
        table(given[1:])
        return
    if given[:1] == ["report"]:
        parser.add_argument("paths", type=Path, nargs="+")
        parser.add_argument("--most", type=int, default=40, help="wrong and failed runs that are listed of each table")
        chosen = parser.parse_args(given[1:])
        print(report(chosen.paths, chosen.most))
        return
    parser.add_argument("--engine", choices=(*ENGINES, "scipy", "heyoka"), default="numpy")
    parser.add_argument("--step", default="default", help="of liehom, or a method of solve_ivp")
    parser.add_argument("--looks", type=int, help="the option of integrate; by default it is not given")
    parser.add_argument(
        "--fields", default="", help="only groups whose name contains this, such as 'gauss' or 'smooth'"
    )
    parser.add_argument("--rtol", type=float, nargs="+", choices=RTOLS, default=RTOLS)
    parser.add_argument("--seed", type=int, default=2031)
    parser.add_argument("--part", default="0/1", help="k/n: every n-th group from number k on")
    parser.add_argument("--references", type=Path, default=STORED)
    parser.add_argument("output", type=Path)
    chosen = parser.parse_args(given)
    first, parts = map(int, chosen.part.split("/"))
    options = {} if chosen.looks is None else {"looks": chosen.looks}
    some = [group for group in groups(chosen.seed) if chosen.fields in group.name][first::parts]
    found = measured(some, chosen.engine, chosen.step, chosen.rtol, options, References(chosen.references))
    data = {"engine": chosen.engine, "step": chosen.step, "looks": chosen.looks, "seed": chosen.seed, "rows": found}
    chosen.output.write_text(json.dumps(data, indent=0) + "\n", encoding="utf-8")
    print(report([chosen.output], 10))


if __name__ == "__main__":
    main()
