"""Command `reproduce`: the figures of the paper, printed as tables, or written into a folder."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, final

import typer

from liehom.cli.guard import NO, YES
from liehom.cli.options import JsonOption, run
from liehom.cli.terminal import completion
from liehom.cli.terminal.steps import step

if TYPE_CHECKING:
    from liehom.paper import Reproduction

ALL = "all"


@final
@dataclass(frozen=True, slots=True)
class Wanted:
    """Options of the command."""

    out: str | None = None
    formats: str | None = None
    dark: bool = False
    resume: bool = False
    quick: bool = False
    seed: int | None = None
    as_json: bool = False


def reproduce(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME",
            help="Figure: fig1, ..., fig7, separatrix, or all.",
            autocompletion=completion.words(*completion.FIGURES),
        ),
    ],
    out: Annotated[
        str | None, typer.Option(metavar="DIR", help="Folder for tables and plots (default: print the tables).")
    ] = None,
    format_: Annotated[
        str | None,
        typer.Option("--format", metavar="F,F,...", help="Formats of the plots (default: png,svg,pdf), or none."),
    ] = None,
    dark: Annotated[bool, typer.Option("--dark", help="Draw the plots for a dark page.")] = False,
    resume: Annotated[
        bool, typer.Option("--resume", help="Skip figures that an earlier run has written with the same options.")
    ] = False,
    quick: Annotated[
        bool, typer.Option("--quick", help="Use few bodies and short runs: seconds instead of a minute.")
    ] = False,
    seed: Annotated[
        int | None, typer.Option(metavar="N", help="Seed of the random bodies (default: the figure's).")
    ] = None,
    json: JsonOption = False,
) -> None:
    """Reproduce figures of the paper: tables, plots, claims.

    The exit code is 0 if all claims hold, and 1 if one does not.
    """
    run(lambda: run_reproduce(name, Wanted(out, format_, dark, resume, quick, seed, json)))


def run_reproduce(name: str, wanted: Wanted) -> int:
    """Compute the tables, write or print them, and print the claims; returns the exit code."""
    from liehom.cli.show import show_json
    from liehom.errors import InputError
    from liehom.paper import NAMES

    if name != ALL and name not in NAMES:
        raise InputError(f"there is no figure {name!r} to reproduce, expected one of {', '.join(NAMES)}, {ALL}")
    formats = _checked_formats(wanted)
    names = NAMES if name == ALL else (name,)
    done: list[dict[str, Any]] = []
    try:
        for k, one in enumerate(names):
            step(f"{one}, {k + 1} of {len(names)}")
            done.append(_figure(one, formats, wanted))
    except KeyboardInterrupt:
        if wanted.out is None:
            raise KeyboardInterrupt(_not_written([data["name"] for data in done])) from None
        written = [one for one in names if _stored(one, formats, wanted) is not None]
        raise KeyboardInterrupt(_how_to_continue(written, wanted.out)) from None
    holds = all(data["holds"] for data in done)
    if wanted.as_json:
        figures = [{key: value for key, value in data.items() if key != "lines"} for data in done]
        show_json({"holds": holds, "quick": wanted.quick, "figures": figures})
    else:
        _show(done, formats, wanted.out)
    return YES if holds else NO


def _checked_formats(wanted: Wanted) -> tuple[str, ...]:
    """Formats of the plots; raises an error if the files could not be written later."""
    from liehom.cli.problem_options import can_plot
    from liehom.errors import InputError
    from liehom.paper import FORMATS

    if wanted.out is None:
        if wanted.formats is not None or wanted.dark or wanted.resume:
            raise InputError("--format, --dark and --resume are about files: name their folder with --out DIR")
        return ()
    _check_folder(wanted.out)
    if wanted.formats is None:
        return FORMATS if can_plot() else ()
    formats = tuple(part.strip() for part in wanted.formats.split(","))
    if formats == ("none",):
        return ()
    wrong = [part for part in formats if part not in FORMATS]
    if wrong:
        raise InputError(f"plots have no format {wrong[0]!r}, expected some of {','.join(FORMATS)}, or none")
    if not can_plot():
        raise InputError("plots need matplotlib: install it with  pip install 'liehom[plot]',  or use --format none")
    return tuple(dict.fromkeys(formats))


def _check_folder(out: str) -> None:
    """Raise an error if a folder neither exists nor can be made, or is not writable."""
    from liehom.errors import FormatError

    folder = Path(os.path.abspath(out))
    there = next(path for path in (folder, *folder.parents) if path.exists())
    if not out or not there.is_dir() or not os.access(there, os.W_OK):
        raise FormatError(f"{out!r} cannot be written: {str(there)!r} is not a writable folder")


def _stored(name: str, formats: Sequence[str], wanted: Wanted) -> dict[str, Any] | None:
    """JSON object of a figure that is complete in the folder, with the paths of its files; None if it is not."""
    from liehom.paper import stored

    folder = str(wanted.out)
    found = stored(folder, name, {"quick": wanted.quick, "seed": wanted.seed}, formats, dark=wanted.dark)
    if found is None:
        return None
    files = [str(Path(folder) / file) for file in (*found.pop("files"), f"{name}.json")]
    return {key: value for key, value in found.items() if key not in ("formats", "dark", "liehom")} | {"files": files}


def _figure(name: str, formats: Sequence[str], wanted: Wanted) -> dict[str, Any]:
    """JSON object of a figure with the paths of its files, after it is written, or read with --resume."""
    from liehom.paper import reproduce

    if wanted.resume and (found := _stored(name, formats, wanted)) is not None:
        return found
    done = reproduce(name, quick=wanted.quick, seed=wanted.seed)
    if wanted.out is None:
        return done.to_json() | {"files": [], "lines": _lines(done)}
    return done.to_json() | {"files": [str(path) for path in done.write(wanted.out, formats, dark=wanted.dark)]}


def _not_written(names: Sequence[str]) -> str:
    return f"; finished, but not written without --out: {', '.join(names)}" if names else ""


def _how_to_continue(names: Sequence[str], out: str) -> str:
    if not names:
        return "; no figure is finished"
    return f"; finished in {out}: {', '.join(names)}; the same command with --resume does the others"


# -- printing --------------------------------------------------------------------------------------------
def _lines(done: Reproduction) -> list[tuple[str, Sequence[str], list[list[str]]]]:
    """Captions, columns and rows of the tables of a figure."""
    from liehom.paper.table import shown_rows

    return [(done.caption(key), table.columns, shown_rows(table)) for key, table in done.tables.items()
            if table.in_markdown]  # fmt: skip


def _show(done: list[dict[str, Any]], formats: Sequence[str], out: str | None) -> None:
    from liehom.cli.show import show_table

    for data in done:
        if out is None:
            print(f"{data['title']}\n{data['sample']}\n")
        for caption, columns, rows in data.get("lines", ()):
            print(caption)
            show_table(columns, rows)
            print()
    rows = [
        (data["name"], "holds" if check["holds"] else "FAILS", check["claim"], _short(check["found"]))
        for data in done
        for check in data["checks"]
    ]
    show_table(("figure", "", "claim", "found"), rows)
    if out is None:
        print("\nno files are written: --out DIR writes tables and plots")
    else:
        count = sum(len(data["files"]) for data in done)
        print(f"\n{count} files in {out}" + ("" if formats else "; no plots"))


def _short(text: str, limit: int = 70) -> str:
    return text if len(text) <= limit else text[: limit - 4] + " ..."
