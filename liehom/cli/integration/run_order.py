"""Work of the command `order`: the order of convergence on the problem of a file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from liehom.cli.guard import YES
from liehom.cli.inputs import number_value, shown_name
from liehom.cli.problem_options import ProblemOptions, check_plot_file, problem_of
from liehom.cli.show import show_json
from liehom.cli.terminal.steps import step
from liehom.errors import FormatError
from liehom.io.number_lists import vector
from liehom.io.solution_file import plain
from liehom.scalars import RR

if TYPE_CHECKING:
    from liehom.integrators import ConvergenceTable
    from liehom.io import Problem

SIZES = "0.1,0.05,0.025,0.0125"
"""Default step sizes."""


def run_order(file: str, given: ProblemOptions, sizes: str | None, plot: str | None, as_json: bool) -> int:
    """Measure the orders, draw the plot and print the table; returns the exit code."""
    import numpy as np

    check_plot_file(plot)
    dts = step_sizes(SIZES if sizes is None else sizes)
    problem = problem_of(file, given)
    step(f"solution of higher accuracy, and {len(dts)} step sizes")
    with np.errstate(all="ignore"):
        table = measured(problem, dts)
    if plot is not None:
        from liehom.plotting import plot_convergence

        plot_convergence(table, plot)
    if as_json:
        show_json({"file": shown_name(file), "plot": plot, **table_json(table)})
        return YES
    step("")
    print(table)
    if plot is not None:
        print(f"plot: {plot}")
    return YES


def step_sizes(text: str) -> list[float]:
    """Step sizes in descending order from a string such as '0.1,0.05' or '1/10, 1/20'.

    Raises
    ------
    FormatError
        If there are fewer than two sizes, or they are not positive and distinct.

    Examples
    --------
    >>> step_sizes("0.1, 1/20")
    [0.1, 0.05]
    """
    dts = vector([number_value(part) for part in text.split(",")], "dt", floats=True).numbers(RR)
    if len(dts) < 2 or any(not h > 0 for h in dts) or len(set(dts)) < len(dts):
        raise FormatError(f"--dt is {text[:60]!r}, expected two or more different positive step sizes: 0.1,0.05,0.025")
    return sorted(map(RR.convert, dts), reverse=True)


def measured(problem: Problem, dts: Sequence[float]) -> ConvergenceTable:
    """Table of `observed_order` for a problem."""
    from liehom.integrators import observed_order

    options = {key: problem.options[key] for key in ("exponential", "clock") if key in problem.options}
    t_span = problem.options["t_span"]
    start = problem.checked_start(t_span[0])
    return observed_order(problem.field(), start, problem.step(), dts, t_span=t_span, **options)


def table_json(table: ConvergenceTable) -> dict[str, Any]:
    """JSON object of a table of orders; a number that is not finite is null."""
    facts = ("step", "exponential", "clock", "order", "t_span", "reference_accuracy")
    rows = [{**row._asdict(), "message": text} for row, text in zip(table.rows, table.messages, strict=True)]
    orbit, trajectory = table.orders
    made = {"orbit_order": orbit, "trajectory_order": trajectory, **{key: getattr(table, key) for key in facts}}
    return {key: plain(value) for key, value in {**made, "rows": rows}.items()}
