"""Command `atlas`: list the families, decide all their pairs, search the result."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer

from liehom.base.errors import InputError, displayed
from liehom.cli import completion
from liehom.cli.guard import NO, YES, rename_step, show_rows, step
from liehom.cli.help import Group
from liehom.cli.inputs import JsonOption, command, run

if TYPE_CHECKING:
    from liehom.studies.atlas.entry import Entry

FamilyOption: TypeAlias = Annotated[
    list[str] | None, typer.Option(metavar="NAME", help="Family, once or more often (default: all families).")
]

atlas: typer.Typer = typer.Typer(cls=Group, rich_markup_mode=None)


@command(atlas, "liehom atlas families")
def families(json: JsonOption = False) -> None:
    """List the families and their numbers of pairs."""

    def action() -> int:
        from liehom.studies.atlas.all_families import FAMILIES, recipes

        counts = {}
        for name in FAMILIES:
            step(f"pairs of the family {name}")
            counts[name] = sum(1 for _ in recipes([name]))
        return show_rows(json, counts, ["family", "pairs"], [[name, str(count)] for name, count in counts.items()])

    run(action)


@command(atlas, "liehom atlas build atlas.jsonl --family parabolic --store parts")
def build(
    out: Annotated[str, typer.Argument(metavar="OUT.jsonl", help="File for the entries with their certificates.")],
    family: FamilyOption = None,
    table: Annotated[
        str | None, typer.Option(metavar="TABLE.json", help="File for the table without certificates (default: none).")
    ] = None,
    store: Annotated[
        str | None,
        typer.Option(metavar="DIR", help="Folder from which an interrupted build continues (default: none)."),
    ] = None,
    processes: Annotated[int, typer.Option(metavar="N", min=1, help="Number of processes.")] = 1,
    force: Annotated[bool, typer.Option("--force", help="Replace the files if they exist.")] = False,
    json: JsonOption = False,
) -> None:
    """Decide all pairs of the families, verify the certificates, and count.

    The exit code is 0 if all pairs are decided, and 1 if not.
    """
    run(lambda: _build(out, family, table, store, processes, force, json))


def _build(
    out: str, names: list[str] | None, table: str | None, store: str | None, processes: int, force: bool, as_json: bool
) -> int:
    from concurrent.futures import ProcessPoolExecutor
    from functools import partial

    from liehom.base.disk import check_target
    from liehom.studies import atlas as built

    for path in (out, table):
        if path is not None:
            check_target(path, force=force)
    executor = None if processes == 1 else partial(ProcessPoolExecutor, processes)
    done = [0]
    step("first pairs")
    try:
        content = built.write_entries(out, _counted(built.build(names, executor=executor, store=store), done))
    except KeyboardInterrupt:
        kept = f"in {store}: the same command continues" if store else "not stored: with --store DIR they would be"
        raise KeyboardInterrupt(f" after {done[0]} pairs, which are {kept}; {out} is not written") from None
    step("table")
    if table is not None:
        built.write_table(table, content)
    counts: dict[str, dict[str, Any]] = content["counts"]
    heads, rows = next(iter(counts.values()), {}), [[x, *map(str, own.values())] for x, own in counts.items()]
    show_rows(as_json, counts, ["family", *heads], rows)
    return NO if any(own["undecided"] for own in counts.values()) else YES


def _counted(entries: Iterable[Entry], done: list[int]) -> Iterator[Entry]:
    """The entries, while their number is counted and shown."""
    for entry in entries:
        done[0] += 1
        rename_step(f"{done[0]} pairs decided, the last of them {entry.name}")
        yield entry


@command(atlas, "liehom atlas show atlas.jsonl --full --search S^3")
def show(
    file: Annotated[
        str,
        typer.Argument(
            metavar="FILE.jsonl",
            help="File that `liehom atlas build` has written, or - for standard input.",
            autocompletion=completion.files(".jsonl"),
        ),
    ],
    family: FamilyOption = None,
    full: Annotated[bool | None, typer.Option("--full/--not-full", help="Only pairs that are full, or not.")] = None,
    letter: Annotated[
        str | None, typer.Option(metavar="LETTER", help="Only full pairs of the letter A, B or C.")
    ] = None,
    search: Annotated[str, typer.Option(metavar="TEXT", help="Only pairs with this text in a cell.")] = "",
    json: JsonOption = False,
) -> None:
    """Print rows of the table of a file, or with --json the entries with their certificates."""

    def action() -> int:
        from liehom.cli.inputs import file_argument
        from liehom.studies.atlas.all_families import FAMILIES
        from liehom.studies.atlas.sweeps import COLUMNS, read_entries, table_row

        _require("family", family or (), FAMILIES)
        _require("letter", (letter.upper(),) if letter else (), "ABC")
        rows, entries = [], []
        for entry in read_entries(file_argument(file)):
            cells = table_row(entry)
            if (
                (family is None or entry.family in family)
                and (full is None or entry.full is full)
                and (letter is None or cells[COLUMNS.index("letter")] == letter.upper())
                and any(search.lower() in str(cell).lower() for cell in cells)
            ):
                rows.append([_text(cell) for cell in cells])
                entries.append(entry.to_json() if json else None)
        return show_rows(json, {"entries": entries}, COLUMNS, rows)

    run(action)


def _require(what: str, values: Iterable[str], known: Iterable[str]) -> None:
    """Raise `InputError` for a value of an option that nothing has."""
    for value in values:
        if value not in set(known):
            raise InputError(f"there is no {what} {displayed(value)}; expected one of {', '.join(known)}")


def _text(cell: str | int | bool | None) -> str:
    if isinstance(cell, bool):
        return "yes" if cell else "no"
    return "" if cell is None else str(cell)
