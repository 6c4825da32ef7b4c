"""Command `reproduce`: the figures of the paper, written into a folder."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, Annotated

import typer

from liehom.cli.guard import NO, YES
from liehom.cli.options import JsonOption, run

if TYPE_CHECKING:
    from liehom.paper import Reproduction

ALL = "all"
FOLDER = "reproduction"


def reproduce(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Figure: fig1, ..., fig7, separatrix, or all.")],
    out: Annotated[str, typer.Option(metavar="DIR", help=f"Folder for tables and plots (default: {FOLDER}).")] = FOLDER,
    quick: Annotated[
        bool, typer.Option("--quick", help="Use few bodies and short runs: seconds instead of minutes.")
    ] = False,
    seed: Annotated[
        int | None, typer.Option(metavar="N", help="Seed of the random bodies (default: the figure's).")
    ] = None,
    json: JsonOption = False,
) -> None:
    """Reproduce figures of the paper: tables, plots, claims.  Exit code 0: all claims hold, 1: one does not."""
    run(lambda: run_reproduce(name, out, quick, seed, json))


def run_reproduce(name: str, out: str, quick: bool, seed: int | None, as_json: bool) -> int:
    """Compute the tables, write them, and print the claims; returns the exit code."""
    from liehom.cli.problem_options import can_plot
    from liehom.cli.show import show_json
    from liehom.errors import InputError
    from liehom.paper import NAMES, reproduce

    if name != ALL and name not in NAMES:
        raise InputError(f"there is no figure {name!r} to reproduce, expected one of {', '.join(NAMES)}, {ALL}")
    done, plots = [], can_plot()
    for one in NAMES if name == ALL else (name,):
        begin = time.perf_counter()
        found = reproduce(one, quick=quick, seed=seed)
        files = [str(path) for path in found.write(out, plot=plots)]
        done.append((found, files, time.perf_counter() - begin))
        if name == ALL and sys.stderr.isatty():
            print(f"{one}: {done[-1][2]:.0f} s", file=sys.stderr)
    holds = all(found.holds for found, _, _ in done)
    if as_json:
        figures = [{**found.to_json(), "holds": found.holds, "files": files} for found, files, _ in done]
        show_json({"holds": holds, "quick": quick, "figures": figures})
    else:
        _show(done, out, plots)
    return YES if holds else NO


def _show(done: list[tuple[Reproduction, list[str], float]], out: str, plots: bool) -> None:
    from liehom.cli.show import show_table

    rows = [
        (found.name, "holds" if check.holds else "FAILS", check.claim, _short(check.found))
        for found, _, _ in done
        for check in found.checks
    ]
    show_table(("figure", "", "claim", "found"), rows)
    count = sum(len(files) for _, files, _ in done)
    print(f"\n{count} files in {out}" + ("" if plots else "; no plots: matplotlib is missing"))


def _short(text: str, limit: int = 70) -> str:
    return text if len(text) <= limit else text[: limit - 4] + " ..."
