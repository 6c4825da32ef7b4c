"""Commands `integrate` and `order` with their options; `run_integrate` and `run_order` do the work."""

from __future__ import annotations

from typing import Annotated, TypeAlias

import typer

from liehom.cli.options import JsonOption, run
from liehom.cli.terminal import completion

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
        str | None,
        typer.Option(metavar="OUT.npz", help="File for t, y and the report (default: none)."),
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
            "--engine",
            "--compile",
            metavar="NAME",
            help="Engine that makes the steps: numpy, llvm or jax (default: numpy).",
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
        from liehom.cli.integration.run_integrate import Output, run_integrate
        from liehom.cli.problem_options import ProblemOptions

        given = ProblemOptions(t_span, dt, base, order, rtol, atol, exponential, clock)
        return run_integrate(file, given, Output(out, plot, checkpoint, force, json, progress, max_steps, engine))

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
        from liehom.cli.integration.run_order import run_order
        from liehom.cli.problem_options import ProblemOptions

        given = ProblemOptions(t_span, None, base, order, None, None, exponential, clock)
        return run_order(file, given, dt, plot, json)

    run(action)
