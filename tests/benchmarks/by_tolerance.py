"""The default step by tolerance alone beside other programs: what a call costs at an error, as multiples of ours.

    python -m tests.benchmarks.by_tolerance [--only NAME ...] [--again] [--render]

Each program gets its tolerance and nothing else, as its objects are made once and called again; methods with fixed
steps get their best step. Errors are those of trajectories, and costs are processor time of whole calls, read off the
curve over the swept settings. The second number of a cell compares with the best of our steps that is set by hand. The
figures are kept in docs/_static/by_tolerance.json, and their tables are in docs/performance.md. A run that was stopped
goes on with the problems that have no figures yet.
"""

import argparse
import json
import math
import os
import time
import warnings
from pathlib import Path
from typing import Any

from tests.benchmarks.integration_measure import TARGETS, accuracy, cost, matched
from tests.benchmarks.integration_methods import LADDER, LLVM, SERIES, adaptive, integrate
from tests.benchmarks.integration_peers import PEERS, Solver
from tests.benchmarks.integration_problems import (
    Problem,
    grassmannian,
    projective_plane,
    quartic,
    rigid_body,
    sphere3,
    sphere4,
    symmetric4,
    underwater_body,
)
from tests.benchmarks.report import conditions

DATA = Path(__file__).resolve().parents[2] / "docs" / "_static" / "by_tolerance.json"
PAGE = DATA.parents[1] / "performance.md"
COUNTS = (1, 10, 1000, 10_000)
BEGIN, END = "<!-- by tolerance: begin -->", "<!-- by tolerance: end -->"
PROBLEMS = (rigid_body, quartic, sphere3, sphere4, projective_plane, underwater_body, grassmannian, symmetric4)
AIMS: dict[str, dict[int, tuple[float, ...]]] = {
    name: {1: one, 10: (2, 2, 0, 0), 1000: many, 10_000: many}
    for names, one, many in (
        (("rigid body", "quartic Hamiltonian"), (2, 2, 0, 0), (2, 2, 1.3, 1.3)),
        (("S³", "S⁴"), (1, 1, 1, 1), (2, 2, 1.3, 1.3)),
        (("CP²", "SE(3)"), (1, 1, 1, 1), (1.5, 1.5, 1.3, 1)),
        (("Gr(2,4)", "Sym(4)"), (1, 1, 1, 1), (1.2, 1.2, 1, 0.8)),
    )
    for name in names
}
"""Peer / ours at the errors of `TARGETS` that calls by tolerance should reach; 0 for none."""
SWEPT = tuple(10.0**-k for k in range(2, 14))
OURS = Solver(LLVM, "default", adaptive("adaptive", "llvm"), SWEPT, "llvmlite", counts=COUNTS)
BY_HAND = [Solver(LLVM, n, integrate(n, "llvm"), LADDER, "llvmlite", fixed=True, counts=COUNTS) for n in SERIES]


def runs(solver: Solver, count: int) -> bool:
    """Whether a program is measured on ensembles of this size; those for 10,000 trajectories take 1,000, too.

    scipy, whose time grows with the number of trajectories from 10 on, is not measured on more.
    """
    if solver.group.startswith("scipy") and count > 10:
        return False
    return (10_000 if count == 1000 else count) in solver.counts


def measured(problem: Problem) -> dict[str, Any]:
    """For each program its errors, and its costs for each size of ensembles."""
    rows: list[dict[str, Any]] = []
    begin = time.process_time()
    for kind, solvers in (("ours", [OURS]), ("by hand", BY_HAND), ("peer", PEERS)):
        for solver in solvers:
            if not solver.installed or not solver.fits(problem):
                continue
            points = accuracy(problem, solver)
            known = {str(n): cost(problem, solver, n, points) for n in COUNTS if points and runs(solver, n)}
            rows.append({"kind": kind, "name": solver.name, "points": points, "costs": known})
            print(f"{problem.name}: {solver.name}, {time.process_time() - begin:.0f} s", flush=True)
    return {"title": problem.title, "rows": rows}


def least(problem: Problem, rows: list[dict[str, Any]], kind: str, count: int, target: float) -> tuple[float, str]:
    """The least cost of the programs of a kind at an error, in microseconds for a trajectory, and whose it is."""
    some = [row for row in rows if row["kind"] == kind and str(count) in row["costs"]]
    found = [
        (
            matched(problem, [tuple(p) for p in row["points"]], row["costs"][str(count)], target, orbit=False),
            row["name"],
        )
        for row in some
    ]
    return min(found, default=(math.inf, "none"))


def tables(data: dict[str, Any]) -> list[str]:
    """For each size of ensembles a table of peer / ours, by tolerance and by hand."""
    lines: list[str] = []
    made = {make().name: make() for make in PROBLEMS}
    for count in COUNTS:
        head = [f"{count} trajector{'y' if count == 1 else 'ies'}", *(f"{x:.0e}" for x in TARGETS), "best peer at 1e-6"]
        lines += ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
        for name, entry in ((name, data["problems"][name]) for name in made if name in data["problems"]):
            cells = [name]
            for target, aim in zip(TARGETS, AIMS[name][count], strict=True):
                peer, _ = least(made[name], entry["rows"], "peer", count, target)
                ours, hand = (least(made[name], entry["rows"], kind, count, target)[0] for kind in ("ours", "by hand"))
                ratios = [peer / x if math.isfinite(x) and math.isfinite(peer) else math.nan for x in (ours, hand)]
                text = " ".join("-" if math.isnan(r) else f"{r:.2g}" for r in ratios)
                cells.append(text if not ratios[0] < aim else f"{text} (aim {aim:g})")
            lines.append("| " + " | ".join([*cells, least(made[name], entry["rows"], "peer", count, 1e-6)[1]]) + " |")
        lines.append("")
    return lines


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--only", nargs="*")
    parser.add_argument("--again", action="store_true", help="measure problems that have figures, too")
    parser.add_argument("--render", action="store_true", help="measure nothing")
    options = parser.parse_args()
    data = json.loads(DATA.read_text(encoding="utf-8")) if DATA.exists() else {"problems": {}}
    if not options.render:
        if hasattr(os, "sched_setaffinity"):  # before any program looks how many cores there are
            os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
        warnings.simplefilter("ignore")
        data["conditions"] = conditions()
        for make in PROBLEMS:
            name = make().name
            if (options.only is None or name in options.only) and (options.again or name not in data["problems"]):
                data["problems"][name] = measured(make())
                DATA.write_text(json.dumps(data, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    found = "\n".join(tables(data))
    print(found)
    before, after = PAGE.read_text(encoding="utf-8").split(BEGIN)[0], PAGE.read_text(encoding="utf-8").split(END)[1]
    PAGE.write_text(f"{before}{BEGIN}\n\n{found}\n{END}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
