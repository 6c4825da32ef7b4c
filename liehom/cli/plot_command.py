"""Command `plot`: one command for each picture of `liehom.plotting`, from one table."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from dataclasses import dataclass
from inspect import Parameter, Signature
from typing import TYPE_CHECKING, Annotated, TypeAlias, final

import typer

from liehom.base.errors import InputError, displayed
from liehom.cli import completion
from liehom.cli.guard import YES, rename_step, step
from liehom.cli.help import Group
from liehom.cli.inputs import command, run

if TYPE_CHECKING:
    from liehom.flow.run.solution import Solution
    from liehom.io.object_files import Problem

Call: TypeAlias = tuple[tuple[object, ...], dict[str, object]]
"""Arguments and named arguments of a function of `liehom.plotting`."""

TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9)  # Tolerances of the runs in a diagram of work and precision
SIZE = re.compile(r"([0-9]+(?:\.[0-9]+)?)x([0-9]+(?:\.[0-9]+)?)", re.ASCII)
MOVING = (".gif", ".html")  # Suffixes of moving pictures
LARGEST = 50.0  # Largest width and height of a picture, in inches


# -- arguments ---------------------------------------------------------------------------------------------
def _text(text: str) -> Call:
    return (text,), {}


def _weights(kind: str, weight: str) -> Call:
    try:
        return (kind, tuple(int(part) for part in weight.split(","))), {}
    except ValueError:
        raise InputError(f"the highest weight is {displayed(weight)}, expected integers such as 3,1") from None


def _algebra(text: str) -> Call:
    from liehom.cli.inputs import object_argument
    from liehom.exact.algebra.core.lie_algebra import LieAlgebra

    loaded = object_argument(text)
    return (loaded if isinstance(loaded, LieAlgebra) else loaded.algebra,), {}


def _pair(text: str) -> Call:
    from liehom.cli.inputs import pair_argument

    return (pair_argument(text),), {}


def _points(points: list[str] | None) -> Call:
    from liehom.cli.inputs import number_value, row_values
    from liehom.exact.scalars.floating import RR
    from liehom.io.json_reader import vector

    rows = [[number_value(str(x)) for x in row_values(text, "point")] for text in points or ()]
    return (), {"points": [vector(row, "point", floats=True).numbers(RR) for row in rows]}


def _solution(file: str) -> Call:
    return (solution_argument(file),), {}


def _energy_drift(file: str, integral: str) -> Call:
    return (solution_argument(file), integral), {}


def _work_precision(file: str, methods: list[str]) -> Call:
    from liehom.cli.inputs import ProblemOptions, problem_of
    from liehom.flow.convergence.costs import work_precision

    problem = problem_of(file, ProblemOptions())
    span = problem.options["t_span"]
    step("work and precision")
    table = work_precision(
        problem.field(),
        methods,
        span,
        problem.checked_start(span[0]),
        tolerances=TOLERANCES,
        progress=lambda done: rename_step(f"work and precision, {done:.0%} of the runs"),
    )
    return (table,), {}


def _quadric(file: str) -> Call:
    from liehom.cli.inputs import ProblemOptions, problem_of

    problem = problem_of(file, ProblemOptions())
    return (problem.representation, _integrated(problem)), {}


def solution_argument(text: str) -> Solution:
    """Solution in an .npz file, or of the problem in a representation file, which is integrated."""
    from liehom.cli.inputs import ProblemOptions, problem_of
    from liehom.flow.run.solution import Solution

    return Solution.load(text) if text.endswith(".npz") else _integrated(problem_of(text, ProblemOptions()))


def _integrated(problem: Problem) -> Solution:
    import numpy as np

    from liehom.flow.propagation.propagator import without_order_warning

    step("integrating")
    with np.errstate(all="ignore"), without_order_warning():
        return problem.integrate(progress=lambda done: rename_step(f"integrating, {done:.0%} of the time span"))


# -- the table of pictures ---------------------------------------------------------------------------------
PROBLEM = Annotated[
    str,
    typer.Argument(
        metavar="FILE",
        help="Representation file with a problem, - for one on standard input, or solution file (.npz).",
        autocompletion=completion.files(".json", ".npz"),
    ),
]
FILE = Annotated[
    str,
    typer.Argument(
        metavar="FILE",
        help="Representation file with a problem, or - for one on standard input.",
        autocompletion=completion.files(".json"),
    ),
]
INTEGRAL = Annotated[str, typer.Argument(metavar="INTEGRAL", help="First integral, e.g. 'm0**2 + m1**2/2'.")]
ENERGY = Annotated[str, typer.Argument(metavar="ENERGY", help="Energy, e.g. 'm0**2/2 + m1**2/4 + m2**2/6'.")]
METHODS = Annotated[
    list[str],
    typer.Argument(
        metavar="METHOD",
        help="Methods: names of base steps, or 'scipy DOP853'.",
        autocompletion=completion.words(*completion.BASES),
    ),
]
PAIR = Annotated[
    str,
    typer.Argument(metavar="PAIR", help="Name, pair file, or -, with dim g/h 2 or 3.", autocompletion=completion.pair),
]
TYPE = Annotated[
    str,
    typer.Argument(
        metavar="TYPE", help="Type such as E6, or 'A1 + A1'.", autocompletion=completion.words(*completion.TYPES)
    ),
]
WEIGHT = Annotated[str, typer.Argument(metavar="WEIGHT", help="Highest weight in fundamental coordinates, e.g. 3,1.")]
FORM = Annotated[
    str,
    typer.Argument(
        metavar="FORM",
        help="Real form such as 'su(3,2)' or 'e6(-26)'.",
        autocompletion=completion.words(*completion.REAL_FORMS),
    ),
]
POINTS = Annotated[
    list[str] | None,
    typer.Argument(metavar="[POINT]", help="Eigenvalues of matrices to mark, e.g. 1,1,2 (default: none)."),
]
OBJECT = Annotated[
    str, typer.Argument(metavar="FILE|NAME", help="Name of an algebra, file, or -.", autocompletion=completion.anything)
]


@final
@dataclass(frozen=True, slots=True)
class Kind:
    """A picture: its name, the function that draws it, its arguments and how they are read, what it shows."""

    name: str
    function: str
    arguments: tuple[object, ...]
    read: Callable[..., Call]
    shows: str
    example: str
    moving: str = ""
    """The function that draws a moving picture, into a file that ends in .gif or .html."""


RIGID = "examples/rigid_body.json"
# All pictures; one more is one more line
KINDS = (
    Kind("trajectory", "plot_trajectory", (PROBLEM,), _solution, "the trajectory of a problem or a solution", RIGID,
         "animate_trajectory"),
    Kind("quadric", "plot_quadric", (FILE,), _quadric, "the quadric in space on which a trajectory is", RIGID),
    Kind("spectrum", "plot_spectrum", (PROBLEM,), _solution,
         "the eigenvalues of a trajectory of symmetric matrices over time", "examples/sym3_generic.json"),
    Kind("phase-portrait", "plot_phase_portrait", (ENERGY,), _text,
         "the phase portrait on the sphere of an energy", '"m0**2/2 + m1**2/4 + m2**2/6"'),
    Kind("energy-drift", "plot_energy_drift", (PROBLEM, INTEGRAL), _energy_drift,
         "the error of a first integral over time", f'{RIGID} "m0**2/2 + m1**2/4 + m2**2/6"'),
    Kind("work-precision", "plot_work_precision", (PROBLEM, METHODS), _work_precision,
         "the errors of methods on a problem over their costs", f"{RIGID} lietaylor rk4"),
    Kind("failure-cone", "plot_failure_cone", (PAIR,), _pair,
         "the cone on which the range condition of a pair fails", '"so(3,1)/so(2,1)"'),
    Kind("dynkin", "plot_dynkin", (TYPE,), _text, "the Dynkin diagram of a type", "E6"),
    Kind("satake", "plot_satake", (FORM,), _text, "the Satake diagram of a real form", '"su(3,2)"'),
    Kind("vogan", "plot_vogan", (FORM,), _text, "the Vogan diagram of a real form", '"su(3,2)"'),
    Kind("roots", "plot_root_system", (TYPE,), _text, "a root system of rank 1, 2 or 3", "G2"),
    Kind("weights", "plot_weights", (TYPE, WEIGHT), _weights,
         "the weights of an irreducible module, for rank 1, 2 or 3", "A2 3,1"),
    Kind("weyl-chamber", "plot_weyl_chamber", (TYPE,), _text, "the Weyl chamber of a type of rank 2", "B2"),
    Kind("eigenvalues", "plot_eigenvalues", (POINTS,), _points,
         "the orbit types of symmetric 3 x 3 matrices by their eigenvalues", "1,1,2 1,2,3"),
    Kind("brackets", "plot_bracket_table", (OBJECT,), _algebra, "the table of brackets of an algebra", '"so(3,1)"'),
)  # fmt: skip

OUTPUT = Annotated[
    str,
    typer.Option(
        "--output",
        "--out",
        "-o",
        metavar="OUT",
        help="File to write (.png, .svg or .pdf, for trajectories also .gif or .html).",
    ),
]
DARK = Annotated[bool, typer.Option("--dark", help="Draw light lines on a dark background.")]
SIZED = Annotated[
    str | None, typer.Option("--size", metavar="WxH", help="Size in inches, e.g. 6x4 (default: depends).")
]


def declared(kind: Kind) -> Callable[..., None]:
    """Function of a command that draws a kind of picture, with the parameters that typer reads."""
    names = [f"argument{i}" for i in range(len(kind.arguments))]

    def draw(output: str, dark: bool = False, size: str | None = None, **words: object) -> None:
        run(lambda: run_plot(kind, [words[name] for name in names], output, dark, size))

    place = Parameter.POSITIONAL_OR_KEYWORD
    parameters = [Parameter("output", place, annotation=OUTPUT)]
    for name, annotation in zip(names, kind.arguments, strict=True):
        default = None if annotation is POINTS else Parameter.empty
        parameters.append(Parameter(name, place, default=default, annotation=annotation))
    parameters.append(Parameter("dark", Parameter.KEYWORD_ONLY, default=False, annotation=DARK))
    parameters.append(Parameter("size", Parameter.KEYWORD_ONLY, default=None, annotation=SIZED))
    draw.__signature__ = Signature(parameters)  # type: ignore[attr-defined]
    draw.__annotations__ = {}
    draw.__doc__ = f"Draw {kind.shows}."
    return draw


def run_plot(kind: Kind, words: list[object], output: str, dark: bool, size: str | None) -> int:
    """Draw a picture and write it; returns the exit code."""
    from liehom import plotting
    from liehom.cli.inputs import PLOT_SUFFIXES, check_plot_file
    from liehom.plotting.canvas import finished, style

    moves = bool(kind.moving) and os.path.splitext(output)[1].lower() in MOVING
    check_plot_file(output, (*PLOT_SUFFIXES, *MOVING) if kind.moving else PLOT_SUFFIXES)
    if moves and size is not None:
        raise InputError("--size is for .png, .svg and .pdf files; moving pictures have one size")
    inches = None if size is None else inches_of(size)
    arguments, named = kind.read(*words)
    step("drawing")
    with style(dark=dark):
        if moves:
            getattr(plotting, kind.moving)(*arguments, output, **named, progress=_drawing)
        else:
            drawn = getattr(plotting, kind.function)(*arguments, **named)
            figure = getattr(drawn, "figure", drawn)
            if inches is not None:
                figure.set_size_inches(*inches)
            finished(figure, output)
    step("")
    print(f"plot: {output}")
    return YES


def _drawing(done: float) -> None:
    rename_step(f"drawing, {done:.0%} of the frames")


def inches_of(size: str) -> tuple[float, float]:
    """Width and height in inches from a string."""
    match = SIZE.fullmatch(size.strip())
    width, height = (float(x) for x in match.groups()) if match else (0.0, 0.0)
    if not (0 < width <= LARGEST and 0 < height <= LARGEST):
        raise InputError(f"--size is {displayed(size)}, expected a width and a height in inches, such as 6x4")
    return width, height


def pictures() -> typer.Typer:
    """All kinds of pictures, each as a command with its example."""
    app = typer.Typer(cls=Group, rich_markup_mode=None)
    for kind in KINDS:
        line = f"liehom plot {kind.name} {kind.example} --output {kind.name}.png"
        command(app, line, name=kind.name)(declared(kind))
    return app
