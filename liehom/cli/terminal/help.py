"""Help pages at the width of the terminal, with examples; messages about wrong arguments that show a correct one."""

from __future__ import annotations

import re
import shutil
import sys
from collections.abc import Iterable, MutableMapping, Sequence
from contextlib import AbstractContextManager
from functools import partial
from typing import Any, Protocol

import typer
from typer.core import TyperCommand, TyperGroup
from typer.main import get_command

from liehom.cli.guard import BAD_INPUT, INTERRUPTED, say

COMPLETE = "_LIEHOM_COMPLETE"
"""Environment variable in which the script of a shell asks for completions."""
UsageError: type[Any] = typer.BadParameter.__base__ or typer.BadParameter  # typer does not hand this class on


class Formatter(Protocol):
    """Writer of a help page; typer's own class has no public name."""

    width: int

    def write(self, string: str, /) -> None: ...
    def write_dl(self, rows: Sequence[tuple[str, str]], col_max: int = 30) -> None: ...
    def section(self, name: str) -> AbstractContextManager[None]: ...


def examples(*lines: str) -> str:
    """Epilog of a command: commands to copy, one a line, which tests run.

    Examples
    --------
    >>> examples("liehom catalog", "liehom demo")
    'liehom catalog\\nliehom demo'
    """
    return "\n".join(lines)


def first_sentence(text: str) -> str:
    """First sentence of a help text, in one line.

    Examples
    --------
    >>> first_sentence("Decide whether a pair is full.  The exit code\\nis 0 if it is.")
    'Decide whether a pair is full.'
    """
    return " ".join(text.split("\f")[0].split()).partition(". ")[0].rstrip(".") + "."


class _WrongUsage(Protocol):
    """An error in the arguments, of a class that typer has no public name for."""

    ctx: Any

    def format_message(self) -> str: ...


class _Page:
    """Help page of a command or a group."""

    params: Any
    epilog: str | None

    def get_help(self, ctx: typer.Context) -> str:
        # the terminal's width, not more than 80 columns as by default; the formatter would subtract 2 from it
        ctx.terminal_width = max(shutil.get_terminal_size().columns, 20)
        return str(super().get_help(ctx))  # type: ignore[misc]

    def collect_usage_pieces(self, ctx: typer.Context) -> list[str]:
        pieces: list[str] = super().collect_usage_pieces(ctx)  # type: ignore[misc]
        # some versions of typer write {PAIR}, and [[NAME]] if the metavar has brackets already
        return [re.sub("[{}]", "", piece).replace("[[", "[").replace("]]", "]") for piece in pieces]

    def _write_parameters(self, ctx: object, formatter: Formatter) -> None:
        rows: dict[str, list[tuple[str, str]]] = {"Arguments": [], "Options": []}
        for parameter in self.get_params(ctx):  # type: ignore[attr-defined]
            record = parameter.get_help_record(ctx)
            if record is not None:  # of the record only the name: the help has the default in words
                argument = parameter.param_type_name == "argument"
                name = str(parameter.metavar or parameter.name).strip("[]") if argument else record[0]
                rows["Arguments" if argument else "Options"].append((name, parameter.help or ""))
        for name, records in rows.items():
            _write_list(formatter, name, records)

    def format_epilog(self, ctx: object, formatter: Formatter) -> None:
        del ctx
        if self.epilog:
            formatter.write("\nExamples:\n")
            formatter.write("".join(f"  {line}\n" for line in self.epilog.splitlines()))  # not wrapped: to be copied


def _write_list(formatter: Formatter, name: str, rows: Sequence[tuple[str, str]]) -> None:
    if rows:
        with formatter.section(name):
            formatter.write_dl(rows, col_max=min(30, formatter.width // 3))


class Command(_Page, TyperCommand):  # type: ignore[misc]
    """Command whose help page has examples."""

    def format_options(self, ctx: object, formatter: Formatter) -> None:
        self._write_parameters(ctx, formatter)


class Group(_Page, TyperGroup):  # type: ignore[misc]
    """Group of commands, listed with whole sentences; its commands are of class `Command`."""

    def parse_args(self, ctx: typer.Context, args: list[str]) -> list[str]:  # type: ignore[override]
        if not args and self.no_args_is_help and not ctx.resilient_parsing:
            typer.echo(self.get_help(ctx))
            raise typer.Exit
        return list(super().parse_args(ctx, args))

    def format_options(self, ctx: object, formatter: Formatter) -> None:
        self._write_parameters(ctx, formatter)
        _write_list(formatter, "Commands", list(self.summaries()))

    def summaries(self) -> Iterable[tuple[str, str]]:
        """Name and first sentence of each command."""
        return ((name, first_sentence(command.help or "")) for name, command in self.commands.items())

    def main(  # type: ignore[override]
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        **extra: object,
    ) -> object:
        """Run a command; a wrong argument ends with exit code 2 and a message with an example of the command."""
        run = partial(super().main, args, prog_name, complete_var or COMPLETE, standalone_mode=False, **extra)  # type: ignore[arg-type]
        if not standalone_mode:
            return run()
        try:
            code: object = run()
        except UsageError as error:
            code = say(f"error: {_usage(error)}", BAD_INPUT)
        except typer.Abort:
            code = INTERRUPTED
        sys.exit(code if isinstance(code, int) else 0)


class LateGroup(Group):
    """Group whose commands are declared when they are asked for, so that other commands start without them."""

    _declared: MutableMapping[str, Any] | None

    def declared(self) -> typer.Typer:
        """App with the commands of the group."""
        raise NotImplementedError

    @property
    def commands(self) -> MutableMapping[str, Any]:
        """The commands by name."""
        if self._declared is None:
            made = get_command(self.declared())
            self._declared = made.commands if isinstance(made, Group) else {}
        return self._declared

    @commands.setter
    def commands(self, given: object) -> None:
        del given  # the constructor knows of none
        self._declared = None


def _usage(error: _WrongUsage) -> str:
    """Message of an error in the arguments, with an example and where to read more."""
    text = str(error.format_message()).strip().rstrip(".")
    text = text[:1].lower() + text[1:]
    if error.ctx is None:
        return text
    command = error.ctx.command
    if isinstance(command, Group):
        known = "" if text.endswith("?") else f"; known: {', '.join(command.list_commands(error.ctx))}; "
        return f"{text}{known or ' '}`{error.ctx.command_path} --help` lists the commands"
    shown = (command.epilog or "").splitlines()[:1]
    more = f"`{error.ctx.command_path} --help` says more"
    return "; ".join([text, *(f"for example: `{line}`" for line in shown), more])
