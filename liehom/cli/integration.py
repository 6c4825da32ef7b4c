"""Commands `integrate` and `order`."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias, final

import typer

from liehom.base.errors import FormatError, InputError
from liehom.cli import completion
from liehom.cli.guard import NO, YES, rename_step, show_json, show_table, step
from liehom.cli.inputs import JsonOption, ProblemOptions, check_plot_file, number_value, problem_of, run, shown_name

if TYPE_CHECKING:
    from liehom.base.typing import Array
    from liehom.exact.representations.core.representation import Representation
    from liehom.flow.convergence.orders import ConvergenceTable
    from liehom.flow.run.solution import Solution
    from liehom.io.object_files import Problem

# Work of the command `integrate`: a trajectory as a table, an .npz file and a plot.

ROWS, COLUMNS = 11, 4  # Largest number of rows and of coordinates in the printed table
ROUND_OFF = 1e-13  # Drifts up to this are printed as "< 1e-13"
FORMS_UP_TO = 50  # Largest dimension of a representation whose invariant forms are computed


@final
@dataclass(frozen=True, slots=True)
class Output:
    """Options for the output: files, whether they may be replaced, progress, and the engine."""

    out: str | None = None
    plot: str | None = None
    checkpoint: str | None = None
    force: bool = False
    as_json: bool = False
    progress: bool | None = None
    max_steps: int | None = None
    engine: str = "numpy"

    def check(self, file: str) -> None:
        """Raise an error if a file could not be written later."""
        from liehom.base.disk import check_target

        if self.out is not None:
            check_target(self.out, force=self.force)
        check_plot_file(self.plot)
        if self.checkpoint is not None:
            check_target(self.checkpoint, force=True)
        targets = [os.path.abspath(path) for path in (self.out, self.plot, self.checkpoint) if path is not None]
        if len(set(targets)) < len(targets) or os.path.abspath(file) in targets:
            raise FormatError("the problem, --out, --plot and --checkpoint must be different files")
        if self.max_steps is not None and self.max_steps < 1:
            raise InputError(f"--max-steps is {self.max_steps}, expected a number from 1")


def run_integrate(file: str, overriding: ProblemOptions, output: Output) -> int:
    """Integrate, write the files, print the table and the report; returns the exit code."""
    import numpy as np

    from liehom.flow.propagation.propagator import without_order_warning

    output.check(file)
    problem = problem_of(file, overriding)
    options: dict[str, Any] = {} if output.max_steps is None else {"max_steps": output.max_steps}
    options["engine"] = output.engine
    options["dense_output"] = output.plot is not None
    done = [0.0]
    options["progress"] = True if output.progress else partial(_report, done)
    step("" if output.progress is not None else "integrating")
    try:
        # a number that is not finite ends the run with a message, and that message also says which order was kept
        with np.errstate(all="ignore"), without_order_warning():
            solution = problem.integrate(checkpoint=output.checkpoint, **options)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f" at {done[0]:.0%} of the time span{_how_to_continue(output.checkpoint)}") from None
    if output.out is not None:
        from liehom.io.solution_file import save_solution

        save_solution(solution, output.out, force=output.force)
    if output.plot is not None:
        from liehom.plotting.trajectory_plot import plot_trajectory

        plot_trajectory(solution, output.plot)
    step("drift of the invariants")
    drift = invariant_drift(problem.representation, solution.y)
    if output.as_json:
        _print_json(file, solution, drift, output)
    else:
        _print_table(solution, drift, output)
    return YES if solution.success else NO


def _report(done: list[float], fraction: float) -> None:
    done[0] = fraction
    rename_step(f"integrating, {fraction:.0%} of the time span")


def _how_to_continue(checkpoint: str | None) -> str:
    if checkpoint is None:
        return "; nothing is stored: with --checkpoint PATH the same command continues"
    if not os.path.exists(checkpoint):
        return "; nothing is stored yet"
    return f"; the state is in {checkpoint}: the same command continues from it"


def invariant_drift(representation: Representation, y: Array) -> Array | None:
    """Drift of the invariant quadratic forms from their initial values, relative to |F| |m|^2."""
    import numpy as np

    forms = _forms(representation)
    if not forms or y.shape[-1] == 0:
        return None
    sizes = np.maximum((y * y).sum(axis=0), (y[:, 0] @ y[:, 0]) or 1.0)
    worst = np.zeros(y.shape[-1])
    for form in forms:
        values = np.einsum("in,ij,jn->n", y, form, y)
        worst = np.maximum(worst, np.abs(values - values[0]) / (np.linalg.norm(form, 2) * sizes))
    return worst


def _forms(representation: Representation) -> list[Array]:
    """Symmetric matrices F with rho(x)^T F + F rho(x) = 0."""
    import numpy as np

    if representation.field.exact:
        if representation.size > FORMS_UP_TO:
            return []
        return [np.asarray(form.to_numpy(), dtype=float) for form in representation.invariant_forms().symmetric]
    matrices = [a.to_numpy() for a in representation.matrices]
    scale = max((float(np.abs(a).max(initial=0.0)) for a in matrices), default=0.0)
    skew = all(np.abs(a + a.T).max(initial=0.0) <= 1e-12 * scale for a in matrices)
    return [np.eye(representation.size)] if skew else []


# -- printing --------------------------------------------------------------------------------------------
def _shown_rows(count: int) -> list[int]:
    """Indices of the points in the table: the first, the last, and evenly spaced ones between them."""
    return list(range(count)) if count <= ROWS else [round(i * (count - 1) / (ROWS - 1)) for i in range(ROWS)]


def _print_table(solution: Solution, drift: Array | None, output: Output) -> None:
    n = min(solution.y.shape[0], COLUMNS)
    more = [] if n == solution.y.shape[0] else ["..."]
    columns = ["t", *(f"m{i}" for i in range(n)), *more, *([] if drift is None else ["drift of invariants"])]
    rows = []
    for k in _shown_rows(solution.y.shape[-1]):
        # zero without a sign: no "-0.00000000"
        row = [f"{solution.t[k]:.6g}", *(f"{0.0 if abs(x) < 5e-9 else x: .8f}" for x in solution.y[:n, k]), *more]
        if drift is not None:
            row.append(f"{drift[k]:.1e}" if drift[k] > ROUND_OFF else f"< {ROUND_OFF:.0e}")
        rows.append(row)
    show_table(columns, rows)
    steps = f"{solution.n_steps} step" + ("" if solution.n_steps == 1 else "s")
    print(f"\n{steps}. {solution.message}")
    print(solution.report)
    print(f"t, y and report: {output.out or 'not written, --out OUT.npz writes them'}")
    if output.plot is not None:
        print(f"plot: {output.plot}")


def _print_json(file: str, solution: Solution, drift: Array | None, output: Output) -> None:
    """Print the rows of the table and the summary as JSON; the .npz file of --out has the whole arrays."""
    from liehom.io.solution_file import summary_json

    rows = _shown_rows(solution.y.shape[-1])
    show_json(
        {
            "file": shown_name(file),
            "out": output.out,
            "plot": output.plot,
            "t": [float(solution.t[k]) for k in rows],
            "y": [[float(x) for x in solution.y[:, k]] for k in rows],
            "drift": None if drift is None else [float(drift[k]) for k in rows],
            **summary_json(solution),
        }
    )


# Work of the command `order`: the order of convergence on the problem of a file.

SIZES = "0.1,0.05,0.025,0.0125"  # Default step sizes


def run_order(file: str, options: ProblemOptions, sizes: str | None, plot: str | None, as_json: bool) -> int:
    """Measure the orders, draw the plot and print the table; returns the exit code."""
    import numpy as np

    check_plot_file(plot)
    dts = step_sizes(SIZES if sizes is None else sizes)
    problem = problem_of(file, options)
    step(f"solution of higher accuracy, and {len(dts)} step sizes")
    with np.errstate(all="ignore"):
        table = measured(problem, dts)
    if plot is not None:
        from liehom.plotting.error_plot import plot_convergence

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
    """Step sizes in descending order from a string such as '0.1,0.05' or '1/10, 1/20'."""
    from liehom.exact.scalars.floating import RR
    from liehom.io.json_reader import vector

    dts = vector([number_value(part) for part in text.split(",")], "dt", floats=True).numbers(RR)
    if len(dts) < 2 or any(not h > 0 for h in dts) or len(set(dts)) < len(dts):
        raise FormatError(f"--dt is {text[:60]!r}, expected two or more different positive step sizes: 0.1,0.05,0.025")
    return sorted(map(RR.convert, dts), reverse=True)


def measured(problem: Problem, dts: Sequence[float]) -> ConvergenceTable:
    """Table of `observed_order` for a problem."""
    from liehom.flow.convergence.orders import observed_order

    options = {key: problem.options[key] for key in ("exponential", "clock") if key in problem.options}
    t_span = problem.options["t_span"]
    start = problem.checked_start(t_span[0])
    return observed_order(problem.field(), start, problem.step(), dts, t_span=t_span, **options)


def table_json(table: ConvergenceTable) -> dict[str, Any]:
    """JSON object of a table of orders; a number that is not finite is null."""
    from liehom.io.solution_file import plain

    facts = ("step", "exponential", "clock", "order", "t_span", "reference_accuracy")
    rows = [{**row._asdict(), "message": text} for row, text in zip(table.rows, table.messages, strict=True)]
    orbit, trajectory = table.orders
    orders = {"orbit_order": orbit, "trajectory_order": trajectory, **{key: getattr(table, key) for key in facts}}
    return {key: plain(value) for key, value in {**orders, "rows": rows}.items()}


# Commands `integrate` and `order` with their options; `run_integrate` and `run_order` do the work.

FileArgument: TypeAlias = Annotated[
    str,
    typer.Argument(
        metavar="FILE",
        help="Representation file with a point and a generator or vector field, or - for a file on standard input.",
        autocompletion=completion.files(".json"),
    ),
]
SpanOption: TypeAlias = Annotated[
    tuple[str, str] | None, typer.Option(metavar="START END", help="Time span (default: the file's).")
]
BaseOption: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="NAME",
        help="Base step: euler, heun, rk4, cg3, cf4, gauss2, ... (default: the file's, else lietaylor).",
        autocompletion=completion.words(*completion.BASES),
    ),
]
OrderOption: TypeAlias = Annotated[
    int | None,
    typer.Option(metavar="N", help="Order to which the step is corrected (default: the file's, else the base's)."),
]
ExponentialOption: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="NAME",
        help="Exponential: exp, cayley, expm, series or rodrigues (default: the file's, else exp).",
        autocompletion=completion.words(*completion.EXPONENTIALS),
    ),
]
ClockOption: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="NAME",
        help="Time reparametrization: corrected or nominal (default: the file's, else corrected).",
        autocompletion=completion.words(*completion.CLOCKS),
    ),
]
PlotOption: TypeAlias = Annotated[
    str | None, typer.Option(metavar="OUT.png", help="File for a plot: .png, .pdf or .svg (default: none).")
]


def integrate(
    file: FileArgument,
    out: Annotated[
        str | None, typer.Option(metavar="OUT.npz", help="File for t, y and the report (default: none).")
    ] = None,
    plot: PlotOption = None,
    t_span: SpanOption = None,
    dt: Annotated[
        str | None, typer.Option(metavar="H", help="Fixed step size (default: the file's, else adaptive).")
    ] = None,
    base: BaseOption = None,
    order: OrderOption = None,
    rtol: Annotated[
        str | None,
        typer.Option(metavar="X", help="Relative tolerance of adaptive steps (default: the file's, else 1e-6)."),
    ] = None,
    atol: Annotated[
        str | None,
        typer.Option(metavar="X", help="Absolute tolerance of adaptive steps (default: the file's, else 1e-9)."),
    ] = None,
    exponential: ExponentialOption = None,
    clock: ClockOption = None,
    progress: Annotated[bool | None, typer.Option(help="Progress bar (default: on a terminal only).")] = None,
    checkpoint: Annotated[
        str | None,
        typer.Option(
            metavar="PATH", help="File for the state, from which an interrupted run continues (default: none)."
        ),
    ] = None,
    max_steps: Annotated[
        int | None, typer.Option(metavar="N", help="Maximum number of steps per trajectory (default: 10000000).")
    ] = None,
    engine: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="Engine that makes the steps: numpy, llvm or jax.",
            autocompletion=completion.words(*completion.ENGINES),
        ),
    ] = "numpy",
    force: Annotated[
        bool, typer.Option("--force", help="Replace the .npz file if it exists (default: an error).")
    ] = False,
    json: JsonOption = False,
) -> None:
    """Integrate the problem of a file, and print points of the trajectory and the report of the corrector.

    The exit code is 0 if the end of the time span is reached, and 1 if the run stops before it or a corrected step
    does not keep its order.
    """

    def action() -> int:
        from liehom.cli.inputs import ProblemOptions

        options = ProblemOptions(t_span, dt, base, order, rtol, atol, exponential, clock)
        return run_integrate(file, options, Output(out, plot, checkpoint, force, json, progress, max_steps, engine))

    run(action)


def order(
    file: FileArgument,
    dt: Annotated[
        str | None, typer.Option(metavar="H,H,...", help="Step sizes (default: 0.1,0.05,0.025,0.0125).")
    ] = None,
    plot: PlotOption = None,
    t_span: SpanOption = None,
    base: BaseOption = None,
    order: OrderOption = None,
    exponential: ExponentialOption = None,
    clock: ClockOption = None,
    json: JsonOption = False,
) -> None:
    """Measure the order of convergence on the problem of a file.

    The table has the errors of orbits and of trajectories for several step sizes, and their slopes.
    """

    def action() -> int:
        from liehom.cli.inputs import ProblemOptions

        options = ProblemOptions(t_span, None, base, order, None, None, exponential, clock)
        return run_order(file, options, dt, plot, json)

    run(action)
