"""Inputs and options of commands."""

from __future__ import annotations

import gc
import io
import os
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, BinaryIO, TypeAlias, TypeVar, final

import typer

from liehom.base.budget import current_limits
from liehom.base.errors import CatalogError, FormatError, InputError
from liehom.cli import completion
from liehom.cli.guard import Steps, guarded, step
from liehom.cli.help import examples

if TYPE_CHECKING:
    from liehom.exact.algebra.core.lie_algebra import LieAlgebra
    from liehom.exact.representations.core.pair import Pair
    from liehom.exact.representations.core.representation import Representation
    from liehom.exact.scalars.field import Field, Scalar
    from liehom.io.object_files import Problem

# Files, algebras, pairs, points, rows and numbers from the arguments of a command.

STANDARD_INPUT = "-"  # Argument that denotes the file on standard input
PAIR_HINT = (
    '`liehom catalog` lists names, `liehom catalog "so(4)/so(3)"` prints a pair file, '
    "and `liehom describe` takes an algebra"
)
OBJECT_HINT = '`liehom describe "so(4,1)"` and `liehom describe examples/sym3.json` are examples'
PROBLEM_HINT = "examples/rigid_body.json and examples/sym3.json are files of this kind"
_TYPE = re.compile(r"[A-G][0-9]{1,2}", re.ASCII)
_DECIMAL = re.compile(r"\s*[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?\s*", re.ASCII)


def examples_folder() -> Path:
    """Folder of the example files: in the installed package, or next to it in a checkout."""
    if (folder := completion.examples_folder()) is None:
        raise FormatError(f"the example files are neither in {completion.PACKAGE / 'examples'} nor next to the package")
    return folder


@contextmanager
def pointing_to(hint: str) -> Iterator[None]:
    """Context manager that adds a hint, which the message ends with, to an error about an argument."""
    try:
        yield
    except (CatalogError, FormatError) as error:
        error.add_note(hint)
        raise


@final
class _StandardInput(io.BytesIO):
    """Content of standard input, with the name that messages show."""

    name = "standard input"


def standard_input() -> BinaryIO:
    """File with the content of standard input."""
    if sys.stdin is None:
        raise InputError("- is the file on standard input, which is closed: pipe a file into the command")
    if sys.stdin.isatty():
        raise InputError("- is the file on standard input, which is the terminal: add `< FILE`, or use a pipe")
    content = _StandardInput(sys.stdin.buffer.read(current_limits().file_bytes + 1))
    if not content.getvalue().strip():
        raise InputError("- is the file on standard input, which is empty: has the command before the pipe failed?")
    return content


def check_one_standard_input(*texts: str | None) -> None:
    """Raise `InputError` if more than one argument is '-', since standard input can be read only once."""
    if texts.count(STANDARD_INPUT) > 1:
        raise InputError("- is given twice, but standard input holds one file: give the other file by its name")


def shown_name(text: str) -> str:
    """Name of the file or object that an argument denotes, as results show it."""
    return _StandardInput.name if text == STANDARD_INPUT else text


def file_argument(text: str) -> str | BinaryIO:
    """File that an argument names; '-' is standard input, 'examples/NAME' an installed example if none exists here."""
    return standard_input() if text == STANDARD_INPUT else path_argument(text)


def path_argument(text: str) -> str:
    """Path of the file that an argument names, as `file_argument`."""
    name = text.removeprefix(completion.EXAMPLES)
    if (
        text.startswith(completion.EXAMPLES)
        and name == os.path.basename(name)
        and "\0" not in text
        and not os.path.exists(text)
    ):
        example = examples_folder() / name
        return str(example) if example.is_file() else text
    return text


def is_file(text: str) -> bool:
    """Whether an argument names a file rather than an entry of the catalogue."""
    return text == STANDARD_INPUT or os.path.exists(text) or text.endswith(".json")


def check_output(path: str, *inputs: str) -> None:
    """Raise `FormatError`, before the work, if a file cannot be written or is one of the files that were read."""
    from liehom.base.disk import check_target

    check_target(path, force=True)
    for text in inputs:
        name = path_argument(text)
        if os.path.exists(path) and os.path.exists(name) and os.path.samefile(path, name):
            raise FormatError(f"{path!r} is read by this command, so it is not overwritten: give another name")


def pair_argument(text: str) -> Pair:
    """Pair in a file, or with a name of the catalogue."""
    step("construction of the pair")
    with pointing_to(PAIR_HINT):
        if is_file(text):
            from liehom.io.files import load_pair

            return load_pair(file_argument(text))
        from liehom.exact.catalog.pairs import pair

        return pair(text)


def problem_argument(text: str) -> Problem:
    """Problem in a representation file."""
    from liehom.io.files import load_problem

    step("reading the file")
    with pointing_to(PROBLEM_HINT):
        return load_problem(file_argument(text))


def object_argument(text: str) -> LieAlgebra | Pair | Representation:
    """The object of a file (JSON, .g, .gap, .sage) or a name: of the catalogue, a real form or a type."""
    from liehom.exact.algebra.core.subalgebra import Subalgebra
    from liehom.exact.representations.core.pair import Pair
    from liehom.io.files import load

    if (kind := os.path.splitext(text)[1]) in (".g", ".gap", ".sage"):
        from liehom.io.json_reader import read_text
        from liehom.io.other_programs import from_gap, from_sage

        read = from_sage if kind == ".sage" else from_gap
        return read(read_text(file_argument(text), "a file of GAP or Sage"))
    step("construction of the object")
    with pointing_to(OBJECT_HINT):
        loaded = load(file_argument(text)) if is_file(text) else _named(text)
    return Pair(loaded.algebra, loaded) if isinstance(loaded, Subalgebra) else loaded


def _named(text: str) -> LieAlgebra | Pair:
    from liehom.exact.algebra.roots.chevalley import chevalley
    from liehom.exact.catalog.algebras import algebra
    from liehom.exact.catalog.names import Quotient, Term, parse
    from liehom.exact.catalog.pairs import pair

    tree = parse(text)
    if isinstance(tree, Quotient) or (isinstance(tree, Term) and tree.head == "sym" and tree.after):
        return pair(text)
    return chevalley(text) if _TYPE.fullmatch(text) else algebra(text)


def row_values(text: str, what: str) -> list[Any]:
    """JSON values of a row such as '1, 0, sqrt(2)' or '["1", "0"]'."""
    stripped = text.strip()
    if stripped.startswith("["):
        from liehom.io.json_reader import parse_object

        values = parse_object(f'{{"row": {stripped}}}')["row"]
        if not isinstance(values, list):
            raise FormatError(f"{what} is {text!r}, expected a row such as '1,0,-2/3'")
        return values
    return [part.strip() for part in stripped.split(",")] if stripped else []


def number_value(text: str) -> float | str:
    """JSON value of a number: a decimal becomes a float, anything else stays a string in the grammar of values."""
    stripped = text.strip()
    return float(stripped) if _DECIMAL.fullmatch(stripped) and not stripped.isdigit() else stripped


def row_in(field: Field, text: str, what: str) -> list[Scalar]:
    """Elements of a field from a row on the command line."""
    from liehom.io.json_reader import vector

    return vector(row_values(text, what), what, floats=not field.exact).numbers(field)


def point_in(representation: Representation, text: str) -> tuple[Representation, list[Scalar]]:
    """The representation over a field that contains a point on the command line, float64 for floats, and the point."""
    from liehom.exact.scalars.floating import RR
    from liehom.exact.scalars.number_fields import common_field
    from liehom.io.json_reader import vector

    raw = vector(row_values(text, "point"), "point", floats=True)
    if representation.field.exact and any(type(x) is float for x in raw.values):
        return representation.over(RR), raw.numbers(RR)
    needed = common_field(sorted(raw.radicals())) if representation.field.degree == 1 else None
    if representation.field.exact and needed is not None and needed.degree > 1:
        representation = representation.over(needed)
    return representation, raw.numbers(representation.field)


def pair_facts(text: str, pair: Pair) -> dict[str, Any]:
    """JSON object of the pair that an argument denotes: name, dimensions and field."""
    return {
        "name": shown_name(text),
        "dimension": pair.algebra.dimension,
        "subalgebra_dimension": pair.subalgebra.dimension,
        "field": pair.field.name,
    }


def pair_line(text: str, pair: Pair) -> str:
    """Line about the pair that an argument denotes: name, dimensions and field."""
    n, k = pair.algebra.dimension, pair.subalgebra.dimension
    return f"{shown_name(text)}: dim g = {n}, dim h = {k}, dim g/h = {n - k}, over {pair.field.name}"


# Options that several commands have, the declaration of a command, and the call that makes its exit code.

Function = TypeVar("Function", bound=Callable[..., object])

PairArgument: TypeAlias = Annotated[
    str,
    typer.Argument(
        metavar="PAIR",
        help="Name such as 'so(4)/so(3)', pair file, or - for a file on standard input.",
        autocompletion=completion.pair,
    ),
]
FileArgument: TypeAlias = Annotated[
    str,
    typer.Argument(
        metavar="FILE",
        help="Representation file, or - for a file on standard input.",
        autocompletion=completion.files(".json"),
    ),
]
JsonOption: TypeAlias = Annotated[bool, typer.Option("--json", help="Print one JSON object.")]


def command(app: typer.Typer, *lines: str, name: str | None = None) -> Callable[[Function], Function]:
    """Decorator that makes a function a command of `app`, with examples that the help shows and tests run."""
    return app.command(name, epilog=examples(*lines))


def run(action: Callable[[], int]) -> None:
    """Exit with the code of an action, or of the exception that it raises."""

    def work() -> int:
        with Steps():
            gc.enable()
            return action()

    raise typer.Exit(guarded(work))


# Problem of a file with the options that override it, and the check of plot files, for `integrate` and `order`.

PLOT_SUFFIXES = (".png", ".pdf", ".svg")


@final
@dataclass(frozen=True, slots=True)
class ProblemOptions:
    """Options of the command line that override the problem of a file, as typed."""

    t_span: tuple[str, str] | None = None
    dt: str | None = None
    base: str | None = None
    order: int | None = None
    rtol: str | None = None
    atol: str | None = None
    exponential: str | None = None
    clock: str | None = None

    def values(self) -> dict[str, Any]:
        """Options that were given, checked in the same way as the options of a file."""
        from liehom.io.object_files import read_options

        values: dict[str, Any] = {
            "t_span": None if self.t_span is None else [number_value(t) for t in self.t_span],
            **{key: number_value(x) for key in ("dt", "rtol", "atol") if (x := getattr(self, key)) is not None},
            **{key: getattr(self, key) for key in ("base", "order", "exponential", "clock")},
        }
        return read_options({key: value for key, value in values.items() if value is not None})


def problem_of(file: str, overriding: ProblemOptions) -> Problem:
    """Problem of a file, overridden by options: a tolerance removes its `dt`, a time span its `t_eval`."""
    options = overriding.values()
    problem = problem_argument(file)
    tolerances = {"rtol", "atol"} & options.keys()
    if "dt" in options and tolerances:
        raise InputError("--dt fixes the step size, --rtol and --atol adapt it: give the one or the others")
    dropped = ({"dt"} if tolerances else set()) | ({"t_eval"} if "t_span" in options else set())
    kept: Mapping[str, Any] = {key: x for key, x in problem.options.items() if key not in dropped}
    changed = replace(problem, options=MappingProxyType({**kept, **options}))
    with pointing_to(PROBLEM_HINT):
        changed.field()
        if "t_span" not in changed.options:
            raise FormatError("the file has no 't_span': add \"t_span\": [start, end], or give --t-span START END")
        changed.checked_start(changed.options["t_span"][0])
    return changed


def check_plot_file(path: str | None, suffixes: Sequence[str] = PLOT_SUFFIXES) -> None:
    """Raise an error if a plot cannot be drawn or written; called before the work."""
    if path is None:
        return
    if os.path.splitext(path)[1].lower() not in suffixes:
        raise FormatError(f"{path!r} is not the name of a plot: it must end in {', '.join(suffixes)}")
    from liehom.base.disk import check_target

    check_target(path, force=True)
    if not can_plot():
        raise InputError("plots need matplotlib: install it with  pip install matplotlib")


def can_plot() -> bool:
    """Whether matplotlib is installed."""
    return find_spec("matplotlib") is not None
