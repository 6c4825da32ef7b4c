"""Problem of a file with the options that override it, and the check of plot files, for `integrate` and `order`."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.util import find_spec
from types import MappingProxyType
from typing import Any, final

from liehom.cli.inputs import PROBLEM_HINT, number_value, pointing_to, problem_argument
from liehom.disk import check_target
from liehom.errors import FormatError, InputError
from liehom.io import Problem
from liehom.io.problem_file import read_options

PLOT_SUFFIXES = (".png", ".pdf", ".svg")


@final
@dataclass(frozen=True, slots=True)
class ProblemOptions:
    """Options of the command line that override the problem of a file, as typed.

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
        """Options that were given, checked in the same way as the options of a file.

        Raises
        ------
        FormatError, ParseError
            If an option is not of its type; names the option.
        """
        given: dict[str, Any] = {
            "t_span": None if self.t_span is None else [number_value(t) for t in self.t_span],
            **{key: _number(getattr(self, key)) for key in ("dt", "rtol", "atol")},
            **{key: getattr(self, key) for key in ("base", "order", "exponential", "clock")},
        }
        return read_options({key: value for key, value in given.items() if value is not None})


def _number(text: str | None) -> float | str | None:
    return None if text is None else number_value(text)


def problem_of(file: str, given: ProblemOptions) -> Problem:
    """Problem of a file, overridden by the options of the command line.

    A tolerance removes the file's `dt` and so selects adaptive steps; a time span removes its `t_eval`.

    Raises
    ------
    FormatError, InputError
        As `load_problem`; if a step size and a tolerance are both given; and, before any computation, if the vector
        field, the point or t_span is missing.
    """
    options = given.values()
    problem = problem_argument(file)
    tolerances = {"rtol", "atol"} & options.keys()
    if "dt" in options and tolerances:
        raise InputError("--dt fixes the step size, --rtol and --atol adapt it: give the one or the others")
    dropped = ({"dt"} if tolerances else set()) | ({"t_eval"} if "t_span" in options else set())
    kept: Mapping[str, Any] = {key: x for key, x in problem.options.items() if key not in dropped}
    made = replace(problem, options=MappingProxyType({**kept, **options}))
    with pointing_to(PROBLEM_HINT):
        made.field()
        if "t_span" not in made.options:
            raise FormatError("the file has no 't_span': add \"t_span\": [start, end], or give --t-span START END")
        made.checked_start(made.options["t_span"][0])
    return made


def check_plot_file(path: str | None, suffixes: Sequence[str] = PLOT_SUFFIXES) -> None:
    """Raise an error if a plot cannot be drawn or written; called before the work.

    Raises
    ------
    InputError
        If matplotlib is not installed; names the extra that installs it.
    FormatError
        If the folder does not exist, or the name does not end in one of the suffixes.
    """
    if path is None:
        return
    if os.path.splitext(path)[1].lower() not in suffixes:
        raise FormatError(f"{path!r} is not the name of a plot: it must end in {', '.join(suffixes)}")
    check_target(path, force=True)
    if not can_plot():
        raise InputError("plots need matplotlib: install it with  pip install 'liehom[plot]'")


def can_plot() -> bool:
    """Whether matplotlib is installed.

    Examples
    --------
    >>> isinstance(can_plot(), bool)
    True
    """
    return find_spec("matplotlib") is not None
