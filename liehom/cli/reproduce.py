"""``liehom reproduce``: the figures of the paper, written into a folder."""

from __future__ import annotations

import sys
import time
from typing import Annotated, Any

import typer

from liehom.cli.guard import NO, YES, guarded

ALL = "all"
FOLDER = "reproduction"


def reproduce(
    name: Annotated[str, typer.Argument(metavar="NAME", help="fig1, ..., fig7, separatrix, or all.")],
    out: Annotated[str, typer.Option(metavar="DIR", help="The folder for tables and pictures.")] = FOLDER,
    quick: Annotated[bool, typer.Option("--quick", help="Few bodies, short runs: seconds instead of minutes.")] = False,
    seed: Annotated[int | None, typer.Option(metavar="N", help="The seed of the random bodies.")] = None,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead.")] = False,
) -> None:
    """Do figures of the paper again: tables, pictures, claims.  Exit code 0: all claims hold, 1: one does not."""
    raise typer.Exit(guarded(lambda: run_reproduce(name, out, quick, seed, json)))


def run_reproduce(name: str, out: str, quick: bool, seed: int | None, as_json: bool) -> int:
    """Make the tables, write them, print what was found."""
    from liehom.cli.problem_options import can_draw
    from liehom.cli.show import show_json
    from liehom.errors import InputError
    from liehom.paper import NAMES, reproduce

    if name != ALL and name not in NAMES:
        raise InputError(f"there is no figure {name!r} to reproduce, expected one of {', '.join(NAMES)}, {ALL}")
    done, pictures = [], can_draw()
    for one in NAMES if name == ALL else (name,):
        begin = time.perf_counter()
        found = reproduce(one, quick=quick, seed=seed)
        files = [str(path) for path in found.write(out, picture=pictures)]
        done.append((found, files, time.perf_counter() - begin))
        if name == ALL and sys.stderr.isatty():
            print(f"{one}: {done[-1][2]:.0f} s", file=sys.stderr)
    holds = all(found.holds for found, _, _ in done)
    if as_json:
        figures = [{**found.to_json(), "holds": found.holds, "files": files} for found, files, _ in done]
        show_json({"holds": holds, "quick": quick, "figures": figures})
    else:
        _show(done, out, pictures)
    return YES if holds else NO


def _show(done: list[tuple[Any, list[str], float]], out: str, pictures: bool) -> None:
    from liehom.cli.show import show_table

    rows = [
        (found.name, "holds" if check.holds else "FAILS", check.claim, _short(check.found))
        for found, _, _ in done
        for check in found.checks
    ]
    show_table(("figure", "", "claim", "found"), rows)
    count = sum(len(files) for _, files, _ in done)
    print(f"\n{count} files in {out}" + ("" if pictures else "; no pictures: matplotlib is missing"))


def _short(text: str, limit: int = 70) -> str:
    return text if len(text) <= limit else text[: limit - 4] + " ..."
