"""Files, algebras, pairs, points, rows and numbers from the arguments of a command."""

from __future__ import annotations

import io
import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO, final

from liehom.algebra import LieAlgebra, Subalgebra
from liehom.budget import current_limits
from liehom.cli.terminal.steps import step
from liehom.disk import check_target
from liehom.errors import CatalogError, FormatError, InputError
from liehom.io import Problem, from_gap, from_sage, load, load_pair, load_problem
from liehom.io.json_reader import parse_object, read_text
from liehom.io.number_lists import vector
from liehom.representations import Pair, Representation
from liehom.scalars import RR, Field, Scalar, common_field

EXAMPLES = "examples/"
STANDARD_INPUT = "-"
"""Argument that denotes the file on standard input."""
PAIR_HINT = (
    '`liehom catalog` lists names, `liehom catalog "so(4)/so(3)"` prints a pair file, '
    "and `liehom describe` takes an algebra"
)
OBJECT_HINT = '`liehom describe "so(4,1)"` and `liehom describe examples/sym3.json` are examples'
PROBLEM_HINT = "examples/rigid_body.json and examples/sym3.json are files of this kind"
_TYPE = re.compile(r"[A-G][0-9]{1,2}", re.ASCII)
_DECIMAL = re.compile(r"\s*[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?\s*", re.ASCII)


def examples_folder() -> Path:
    """Folder of the example files: in the installed package, or next to it in a checkout.

    Raises
    ------
    FormatError
        If neither folder has them.
    """
    package = Path(__file__).resolve().parent.parent
    for folder in (package / "examples", package.parent / "examples"):
        if (folder / "so4_so3.json").is_file():
            return folder
    raise FormatError(f"the example files are neither in {package / 'examples'} nor next to the package")


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
    """File with the content of standard input.

    Raises
    ------
    InputError
        If standard input is a terminal, closed or empty.
    """
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
    """File that an argument names; '-' is standard input, 'examples/NAME' an installed example if none exists here.

    Examples
    --------
    >>> os.path.basename(file_argument("examples/sym3.json")), file_argument("mine.json")
    ('sym3.json', 'mine.json')
    """
    return standard_input() if text == STANDARD_INPUT else path_argument(text)


def path_argument(text: str) -> str:
    """Path of the file that an argument names, as `file_argument`."""
    name = text.removeprefix(EXAMPLES)
    if text.startswith(EXAMPLES) and name == os.path.basename(name) and "\0" not in text and not os.path.exists(text):
        found = examples_folder() / name
        return str(found) if found.is_file() else text
    return text


def is_file(text: str) -> bool:
    """Whether an argument names a file rather than an entry of the catalogue."""
    return text == STANDARD_INPUT or os.path.exists(text) or text.endswith(".json")


def check_output(path: str, *inputs: str) -> None:
    """Raise `FormatError`, before the work, if a file cannot be written or is one of the files that were read.

    Examples
    --------
    >>> check_output(__file__, __file__)
    Traceback (most recent call last):
    ...
    liehom.errors.FormatError: ... is read by this command, so it is not overwritten: give another name
    """
    check_target(path, force=True)
    for text in inputs:
        name = path_argument(text)
        if os.path.exists(path) and os.path.exists(name) and os.path.samefile(path, name):
            raise FormatError(f"{path!r} is read by this command, so it is not overwritten: give another name")


def pair_argument(text: str) -> Pair:
    """Pair in a file, or with a name of the catalogue.

    Raises
    ------
    FormatError, CatalogError
        If the file is malformed, or the name is unknown.
    """
    step("construction of the pair")
    with pointing_to(PAIR_HINT):
        if is_file(text):
            return load_pair(file_argument(text))
        from liehom.catalog import pair

        return pair(text)


def problem_argument(text: str) -> Problem:
    """Problem in a representation file."""
    step("reading the file")
    with pointing_to(PROBLEM_HINT):
        return load_problem(file_argument(text))


def object_argument(text: str) -> LieAlgebra | Pair | Representation:
    """Algebra, pair or representation that a file or a name denotes; a subalgebra file denotes a pair.

    A file that ends in .g or .gap is in the format of GAP, a file that ends in .sage in the format of Sage. A name is
    an algebra or pair of the catalogue, a real form such as 'e8(-24)', or a type such as 'E8', which denotes the split
    form in its Chevalley basis.

    Raises
    ------
    FormatError, CatalogError
        If the file is malformed, or the name is unknown.

    Examples
    --------
    >>> object_argument("so(4)/so(3)"), object_argument("so(4,1)"), object_argument("G2")
    (pair('so(4)/so(3)'), <Lie algebra so(4,1) of dimension 10 over QQ>, <Lie algebra G2 of dimension 14 over QQ>)
    """
    kind = os.path.splitext(text)[1]
    if kind in READERS:
        return READERS[kind](read_text(file_argument(text), "a file of GAP or Sage"))
    step("construction of the object")
    with pointing_to(OBJECT_HINT):
        found = load(file_argument(text)) if is_file(text) else _named(text)
    return Pair(found.algebra, found) if isinstance(found, Subalgebra) else found


READERS = {".g": from_gap, ".gap": from_gap, ".sage": from_sage}


def _named(text: str) -> LieAlgebra | Pair:
    from liehom.algebra import RealForm, chevalley, simple
    from liehom.catalog import algebra, pair, parse
    from liehom.catalog.names import Quotient, Term

    tree = parse(text)
    if isinstance(tree, Quotient) or (isinstance(tree, Term) and tree.head == "sym" and tree.after):
        return pair(text)
    try:
        return algebra(text)
    except CatalogError as unknown:
        try:
            if _TYPE.fullmatch(text):
                return chevalley(text)
            form = RealForm.of_name(text)
            return simple(form.type, form.name)
        except CatalogError:
            raise unknown from None


def row_values(text: str, what: str) -> list[Any]:
    """JSON values of a row such as '1, 0, sqrt(2)' or '["1", "0"]'.

    Examples
    --------
    >>> row_values("1, -2/3", "psi")
    ['1', '-2/3']
    """
    stripped = text.strip()
    if stripped.startswith("["):
        values = parse_object(f'{{"row": {stripped}}}')["row"]
        if not isinstance(values, list):
            raise FormatError(f"{what} is {text!r}, expected a row such as '1,0,-2/3'")
        return values
    return [part.strip() for part in stripped.split(",")] if stripped else []


def number_value(text: str) -> float | str:
    """JSON value of a number: a decimal becomes a float, anything else stays a string in the grammar of values.

    Examples
    --------
    >>> number_value("0.1"), number_value("1/10"), number_value("3")
    (0.1, '1/10', '3')
    """
    stripped = text.strip()
    return float(stripped) if _DECIMAL.fullmatch(stripped) and not stripped.isdigit() else stripped


def row_in(field: Field, text: str, what: str) -> list[Scalar]:
    """Elements of a field from a row on the command line."""
    return vector(row_values(text, what), what, floats=not field.exact).numbers(field)


def point_in(representation: Representation, text: str) -> tuple[Representation, list[Scalar]]:
    """The representation over a field that contains a point on the command line, and the point.

    With floats the field is float64; a square root extends QQ.
    """
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
