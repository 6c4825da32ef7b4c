"""One trajectory by tolerance alone without llvmlite, at equal errors: numpy, the default engine, and scipy's DOP853.

    python -m tests.benchmarks.without_llvmlite [--print]

Costs are processor times of whole calls after the first ones, read off the curve over swept tolerances (rtol = atol).
The first call is that of a new propagator at rtol = atol = 1e-6. The table is written into docs/performance.md.
"""

import argparse
import os
import sys
import time
import warnings

import liehom as lh
from tests.benchmarks.by_tolerance import PAGE
from tests.benchmarks.integration_measure import accuracy, cost, matched
from tests.benchmarks.integration_methods import adaptive
from tests.benchmarks.integration_peers import PEERS, Solver
from tests.benchmarks.integration_problems import Problem, rigid_body, sphere3

BEGIN, END = "<!-- without llvmlite: begin -->", "<!-- without llvmlite: end -->"
TARGETS = (1e-3, 1e-6, 1e-9)
SWEPT = tuple(10.0**-k for k in range(3, 13))
WARM = 60  # calls after which the default engine has written its code
SOLVERS = [
    Solver("liehom, numpy", "", adaptive("adaptive", "numpy"), SWEPT, sample=2),
    Solver("liehom, default", "", adaptive("adaptive", "auto"), SWEPT, sample=2),
    next(solver for solver in PEERS if solver.group == "scipy DOP853"),
]


def first_call(problem: Problem) -> float:
    """Milliseconds of the first call of a propagator."""
    begin = time.process_time()
    start = problem.starts(1).reshape(problem.shape)
    lh.Propagator(problem.field)((0.0, problem.span), start, rtol=1e-6, atol=1e-6, t_eval=[problem.span])
    return 1e3 * (time.process_time() - begin)


def rows(problem: Problem) -> list[str]:
    """A row of the table for each error."""
    first, costs = first_call(problem), []
    for solver in SOLVERS:
        points = accuracy(problem, solver)
        if solver.label == "" and "default" in solver.group:
            for _ in range(WARM):
                solver.solve(problem, problem.starts(1).reshape(1, -1), problem.span, 1e-6, 1)
        costs.append((points, cost(problem, solver, 1, points)))
    lines = []
    for target in TARGETS:
        numbers = [matched(problem, points, known, target, orbit=False) / 1e3 for points, known in costs]
        cells = [problem.name, f"{target:.0e}", *(f"{x:.2g}" for x in numbers), f"{numbers[1] / numbers[2]:.2g}"]
        lines.append("| " + " | ".join([*cells, f"{first:.0f}"]) + " |")
    return lines


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--print", action="store_true", help="leave the page as it is")
    options = parser.parse_args()
    sys.modules["llvmlite"] = None  # type: ignore[assignment]  # before liehom looks for it
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    warnings.simplefilter("ignore")
    head = ["field", "error", "numpy", "default", "scipy DOP853", "default / DOP853", "first call, default"]
    table = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    table += [line for problem in (rigid_body(), sphere3()) for line in rows(problem)]
    print("\n".join(table))
    if not options.print:
        before, rest = PAGE.read_text(encoding="utf-8").split(BEGIN)
        text = "\n".join(table)
        PAGE.write_text(f"{before}{BEGIN}\n\n{text}\n\n{END}{rest.split(END)[1]}", encoding="utf-8")


if __name__ == "__main__":
    main()
