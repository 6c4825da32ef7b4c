"""Work of the command `integrate`: a trajectory as a table, an .npz file and a plot."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, final

from liehom.cli.guard import NO, YES
from liehom.cli.inputs import shown_name
from liehom.cli.problem_options import ProblemOptions, check_plot_file, problem_of
from liehom.cli.show import show_json, show_table
from liehom.cli.terminal.steps import rename_step, step
from liehom.disk import check_target
from liehom.errors import FormatError, InputError
from liehom.io import save_solution
from liehom.io.solution_file import summary_json

if TYPE_CHECKING:
    from liehom.integrators import Solution
    from liehom.representations import Representation
    from liehom.typing import Array

ROWS, COLUMNS = 11, 4
"""Largest number of rows and of coordinates in the printed table."""
ROUND_OFF = 1e-13
"""Drifts up to this are printed as "< 1e-13"."""
FORMS_UP_TO = 50
"""Largest dimension of a representation whose invariant forms are computed."""


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


def run_integrate(file: str, given: ProblemOptions, output: Output) -> int:
    """Integrate, write the files, print the table and the report; returns the exit code."""
    import numpy as np

    from liehom.integrators.propagator import without_order_warning

    output.check(file)
    problem = problem_of(file, given)
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
        save_solution(solution, output.out, force=output.force)
    if output.plot is not None:
        _draw(solution, output.plot)
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


def _draw(solution: Solution, path: str) -> None:
    from liehom.plotting import plot_trajectory

    plot_trajectory(solution, path)


def invariant_drift(representation: Representation, y: Array) -> Array | None:
    """Drift of the invariant quadratic forms from their initial values, relative to |F| |m|^2.

    Parameters
    ----------
    representation : Representation
    y : array of shape (N, n)

    Returns
    -------
    array of shape (n,) or None
        Largest drift over all forms; None if no form is known.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> invariant_drift(lh.defining(lh.so(2)), np.array([[1.0, 0.0], [0.0, 2.0]])).tolist()
    [0.0, 0.75]
    """
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
    if count <= ROWS:
        return list(range(count))
    return [round(i * (count - 1) / (ROWS - 1)) for i in range(ROWS)]


def _print_table(solution: Solution, drift: Array | None, output: Output) -> None:
    n = min(solution.y.shape[0], COLUMNS)
    more = [] if n == solution.y.shape[0] else ["..."]
    columns = ["t", *(f"m{i}" for i in range(n)), *more, *([] if drift is None else ["drift of invariants"])]
    rows = []
    for k in _shown_rows(solution.y.shape[-1]):
        row = [f"{solution.t[k]:.6g}", *(f"{_zero_unsigned(x): .8f}" for x in solution.y[:n, k]), *more]
        rows.append(row if drift is None else [*row, _shown_drift(drift[k])])
    show_table(columns, rows)
    steps = f"{solution.n_steps} step" + ("" if solution.n_steps == 1 else "s")
    print(f"\n{steps}. {solution.message}")
    print(solution.report)
    print(f"t, y and report: {output.out or 'not written, --out OUT.npz writes them'}")
    if output.plot is not None:
        print(f"plot: {output.plot}")


def _shown_drift(x: float) -> str:
    return f"{x:.1e}" if x > ROUND_OFF else f"< {ROUND_OFF:.0e}"


def _zero_unsigned(x: float) -> float:
    """The coordinate, or 0.0 if eight digits show zero, so that no "-0.00000000" is printed."""
    return 0.0 if abs(x) < 5e-9 else x


def _print_json(file: str, solution: Solution, drift: Array | None, output: Output) -> None:
    """Print the rows of the table and the summary as JSON; the .npz file of --out has the whole arrays."""
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
