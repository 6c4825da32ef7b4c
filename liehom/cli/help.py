"""Examples of commands, groups of commands, and messages about wrong arguments that show a correct one."""

from __future__ import annotations

import sys
from collections.abc import MutableMapping, Sequence
from functools import partial
from typing import Any, Protocol

import typer
from typer.core import TyperGroup
from typer.main import get_command

from liehom.cli.guard import BAD_INPUT, INTERRUPTED, say

UsageError: type[Any] = typer.BadParameter.__base__ or typer.BadParameter  # typer does not hand this class on


def examples(*lines: str) -> str:
    """Epilog of a command: commands to copy, one a line, which tests run."""
    return "\b\nExamples:\n" + "\n".join(f"  {line}" for line in lines)


def examples_in(epilog: str | None) -> list[str]:
    """The commands in an epilog that `examples` wrote."""
    return [line.strip() for line in (epilog or "").splitlines()[2:]]


class _WrongUsage(Protocol):
    """An error in the arguments, of a class that typer has no public name for."""

    ctx: Any

    def format_message(self) -> str: ...


class Group(TyperGroup):
    """Group of commands, whose messages about wrong arguments show a right one."""

    def parse_args(self, ctx: typer.Context, args: list[str]) -> list[str]:  # type: ignore[override]
        if not args and self.no_args_is_help and not ctx.resilient_parsing:
            typer.echo(self.get_help(ctx))
            raise typer.Exit
        return list(super().parse_args(ctx, args))

    def main(  # type: ignore[override]
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        **extra: object,
    ) -> object:
        """Run a command; a wrong argument ends with exit code 2 and a message with an example of the command."""
        run = partial(super().main, args, prog_name, complete_var, standalone_mode=False, **extra)  # type: ignore[arg-type]
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
            group = get_command(self.declared())
            self._declared = group.commands if isinstance(group, Group) else {}
        return self._declared

    @commands.setter
    def commands(self, known: object) -> None:
        del known  # the constructor knows of none
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
    shown = examples_in(command.epilog)[:1]
    more = f"`{error.ctx.command_path} --help` says more"
    return "; ".join([text, *(f"for example: `{line}`" for line in shown), more])
