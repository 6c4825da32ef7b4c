"""Options that several commands have, and the call that turns a result into an exit code."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, TypeAlias

import typer

from liehom.cli.guard import guarded

PairArgument: TypeAlias = Annotated[
    str, typer.Argument(metavar="PAIR", help="Pair file, or name such as 'so(4)/so(3)'.")
]
JsonOption: TypeAlias = Annotated[bool, typer.Option("--json", help="Print one JSON object.")]


def run(action: Callable[[], int]) -> None:
    """Exit with the code of an action, or of the exception that it raises."""
    raise typer.Exit(guarded(action))
