"""The commands `integrate` and `order`: their options; the work is in `integration` and `convergence`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import typer

from liehom.cli.guard import guarded

FileArgument = Annotated[
    str, typer.Argument(metavar="FILE", help="A representation file with a point and a generator or vector field.")
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print one JSON object instead.")]
SpanOption = Annotated[tuple[str, str] | None, typer.Option(metavar="START END", help="The time span.")]
BaseOption = Annotated[
    str | None, typer.Option(metavar="NAME", help="The step: euler, heun, rk4, lietaylor, cg3, cf4, gauss2, ...")
]
OrderOption = Annotated[int | None, typer.Option(metavar="N", help="The order to which the step is corrected.")]
ExponentialOption = Annotated[str | None, typer.Option(metavar="NAME", help="exp, cayley, expm, series or rodrigues.")]
ClockOption = Annotated[str | None, typer.Option(metavar="NAME", help="corrected or nominal.")]
PlotOption = Annotated[str | None, typer.Option(metavar="OUT.png", help="Draw a picture (.png, .pdf or .svg).")]


def integrate(
    file: FileArgument,
    out: Annotated[
        str | None,
        typer.Option(metavar="OUT.npz", help="Where t, y and the report go; default: the name of FILE with .npz."),
    ] = None,
    plot: PlotOption = None,
    t_span: SpanOption = None,
    dt: Annotated[str | None, typer.Option(metavar="H", help="A fixed step size; adapted without it.")] = None,
    base: BaseOption = None,
    order: OrderOption = None,
    rtol: Annotated[str | None, typer.Option(metavar="X", help="Relative tolerance, for adapted steps.")] = None,
    atol: Annotated[str | None, typer.Option(metavar="X", help="Absolute tolerance, for adapted steps.")] = None,
    exponential: ExponentialOption = None,
    clock: ClockOption = None,
    progress: Annotated[bool | None, typer.Option(help="A progress bar; default: on a terminal.")] = None,
    checkpoint: Annotated[
        str | None, typer.Option(metavar="PATH", help="Keep the state in this file; an interrupted run continues.")
    ] = None,
    max_steps: Annotated[int | None, typer.Option(metavar="N", help="Stop after so many steps.")] = None,
    compile: Annotated[str | None, typer.Option(metavar="NAME", help="Compile the step: llvm or jax.")] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace the .npz file if it is there.")] = False,
    json: JsonOption = False,
) -> None:
    """Integrate the problem of a file.  Exit code 0: the end was reached, 1: the run stopped before it."""

    def action() -> int:
        from liehom.cli.problem_options import ProblemOptions
        from liehom.cli.run_integrate import Output, run_integrate

        given = ProblemOptions(t_span, dt, base, order, rtol, atol, exponential, clock)
        return run_integrate(file, given, Output(out, plot, checkpoint, force, json, progress, max_steps, compile))

    _run(action)


def order(
    file: FileArgument,
    dt: Annotated[
        str | None, typer.Option(metavar="H,H,...", help="Step sizes; default: 0.1,0.05,0.025,0.0125.")
    ] = None,
    plot: PlotOption = None,
    t_span: SpanOption = None,
    base: BaseOption = None,
    order: OrderOption = None,
    exponential: ExponentialOption = None,
    clock: ClockOption = None,
    json: JsonOption = False,
) -> None:
    """Measure the order of convergence on the problem of a file: orbit and trajectory error for several step sizes."""

    def action() -> int:
        from liehom.cli.problem_options import ProblemOptions
        from liehom.cli.run_order import run_order

        given = ProblemOptions(t_span, None, base, order, None, None, exponential, clock)
        return run_order(file, given, dt, plot, json)

    _run(action)


def _run(action: Callable[[], int]) -> None:
    raise typer.Exit(guarded(action))
