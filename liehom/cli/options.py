"""Options that several commands have, the declaration of a command, and the call that makes its exit code."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, TypeAlias, TypeVar

import typer

from liehom.cli.guard import guarded
from liehom.cli.terminal import completion
from liehom.cli.terminal.help import Command, examples
from liehom.cli.terminal.steps import Steps

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
    """Decorator that makes a function a command of `app`; `lines` are its examples, which the help shows and tests run.

    Examples
    --------
    >>> app = typer.Typer()
    >>> @command(app, "liehom hello")
    ... def hello() -> None:
    ...     "Greet the world."
    ...
    >>> app.registered_commands[0].epilog
    'liehom hello'
    """
    return app.command(name, cls=Command, epilog=examples(*lines))


def run(action: Callable[[], int]) -> None:
    """Exit with the code of an action, or of the exception that it raises."""

    def work() -> int:
        with Steps():
            return action()

    raise typer.Exit(guarded(work))
