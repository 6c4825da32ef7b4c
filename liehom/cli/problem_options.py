"""What `integrate` and `order` share: the problem of a file, options that override it, where pictures go."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib.util import find_spec
from types import MappingProxyType
from typing import Any, final

from liehom.cli.inputs import file_argument, number_value
from liehom.errors import FormatError, InputError
from liehom.io import Problem, load_problem
from liehom.io.problem_file import read_options
from liehom.io.solution_file import check_target

PICTURES = (".png", ".pdf", ".svg")


@final
@dataclass(frozen=True, slots=True)
class ProblemOptions:
    """The options of the command line that change the problem of a file, as they were typed.

    Examples
    --------
    >>> ProblemOptions(dt="0.1", order=4).values()
    {'dt': 0.1, 'order': 4}
    >>> ProblemOptions(dt="0").values()
    Traceback (most recent call last):
    ...
    liehom.errors.FormatError: dt is '0', expected a positive number
    """

    t_span: tuple[str, str] | None = None
    dt: str | None = None
    base: str | None = None
    order: int | None = None
    rtol: str | None = None
    atol: str | None = None
    exponential: str | None = None
    clock: str | None = None

    def values(self) -> dict[str, Any]:
        """The options that were given, checked as those of a file are.

        Raises
        ------
        FormatError, ParseError
        """
        given: dict[str, Any] = {
            "t_span": None if self.t_span is None else [number_value(t) for t in self.t_span],
            **{key: _number(getattr(self, key)) for key in ("dt", "rtol", "atol")},
            **{key: getattr(self, key) for key in ("base", "order", "exponential", "clock")},
        }
        return read_options({key: value for key, value in given.items() if value is not None})


def _number(text: str | None) -> Any:
    return None if text is None else number_value(text)


def problem_of(file: str, given: ProblemOptions) -> Problem:
    """The problem of a file with the options of the command line in place of those of the file.

    A tolerance without a step size asks for adapted steps, and another time span for other times of output.

    Raises
    ------
    FormatError, InputError
        As `load_problem`; for a step size together with a tolerance; and for a field, point or t_span that is
        missing, so that nothing has been computed when it is noticed.
    """
    options = given.values()
    problem = load_problem(file_argument(file))
    tolerances = {"rtol", "atol"} & options.keys()
    if "dt" in options and tolerances:
        raise InputError("--dt fixes the step size, --rtol and --atol adapt it: give the one or the others")
    dropped = ({"dt"} if tolerances else set()) | ({"t_eval"} if "t_span" in options else set())
    kept: Mapping[str, Any] = {key: x for key, x in problem.options.items() if key not in dropped}
    made = replace(problem, options=MappingProxyType({**kept, **options}))
    made.field()
    if "t_span" not in made.options:
        raise FormatError("the file has no 't_span': add \"t_span\": [start, end], or give --t-span START END")
    made.checked_start(made.options["t_span"][0])
    return made


def check_picture(path: str | None) -> None:
    """Whether a picture can be drawn and written there, asked before the work.

    Raises
    ------
    InputError
        Without matplotlib; names the extra that installs it.
    FormatError
        If the folder does not exist, or the name has the suffix of no picture.
    """
    if path is None:
        return
    if os.path.splitext(path)[1].lower() not in PICTURES:
        raise FormatError(f"{path!r} is not the name of a picture: it must end in {', '.join(PICTURES)}")
    check_target(path, force=True)
    if not can_draw():
        raise InputError("pictures need matplotlib: install it with  pip install 'liehom[plot]',  or leave out --plot")


def can_draw() -> bool:
    """Whether matplotlib is installed.

    Examples
    --------
    >>> isinstance(can_draw(), bool)
    True
    """
    return find_spec("matplotlib") is not None
