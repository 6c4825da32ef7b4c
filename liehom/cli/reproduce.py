"""Commands `reproduce` and `demo`."""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, final

import typer

from liehom.base.errors import FormatError, InputError
from liehom.cli import completion
from liehom.cli.guard import NO, YES, show_json, show_table, step
from liehom.cli.inputs import JsonOption, check_plot_file, examples_folder, run
from liehom.cli.integration import measured, table_json

if TYPE_CHECKING:
    from liehom.exact.fullness.verdict import Verdict
    from liehom.exact.representations.core.pair import Pair
    from liehom.flow.convergence.orders import ConvergenceTable
    from liehom.studies.paper.reproduction import Reproduction

# Command `reproduce`: the figures of the paper, printed as tables, or written into a folder.

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
    from liehom.studies.paper.figures import NAMES

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
    from liehom.cli.inputs import can_plot
    from liehom.studies.paper.reproduction import FORMATS

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
        raise InputError("plots need matplotlib: install it with  pip install matplotlib,  or use --format none")
    return tuple(dict.fromkeys(formats))


def _check_folder(out: str) -> None:
    """Raise an error if a folder neither exists nor can be made, or is not writable."""
    folder = Path(os.path.abspath(out))
    there = next(path for path in (folder, *folder.parents) if path.exists())
    if not out or not there.is_dir() or not os.access(there, os.W_OK):
        raise FormatError(f"{out!r} cannot be written: {str(there)!r} is not a writable folder")


def _stored(name: str, formats: Sequence[str], wanted: Wanted) -> dict[str, Any] | None:
    """JSON object of a figure that is complete in the folder, with the paths of its files; None if it is not."""
    from liehom.studies.paper.reproduction import stored

    folder = str(wanted.out)
    figure = stored(folder, name, {"quick": wanted.quick, "seed": wanted.seed}, formats, dark=wanted.dark)
    if figure is None:
        return None
    files = [str(Path(folder) / file) for file in (*figure.pop("files"), f"{name}.json")]
    return {key: value for key, value in figure.items() if key not in ("formats", "dark", "liehom")} | {"files": files}


def _figure(name: str, formats: Sequence[str], wanted: Wanted) -> dict[str, Any]:
    """JSON object of a figure with the paths of its files, after it is written, or read with --resume."""
    from liehom.studies.paper.figures import reproduce

    if wanted.resume and (figure := _stored(name, formats, wanted)) is not None:
        return figure
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
    from liehom.studies.paper.table import shown_rows

    return [(done.caption(key), table.columns, shown_rows(table)) for key, table in done.tables.items()
            if table.in_markdown]  # fmt: skip


def _show(done: list[dict[str, Any]], formats: Sequence[str], out: str | None) -> None:
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


# Command `demo`: a tour through the example files.

PAIRS: tuple[tuple[str, str], ...] = (
    ("so4_so3", "the sphere S^3"),
    ("so5_so4_scrambled", "the sphere S^4 in a random basis"),
    ("g2_su3", "the sphere S^6 under G2"),
    ("sl3_P1", "the projective plane"),
    ("so31_so21", "de Sitter space: the null cone is in the way"),
    ("anisotropic", "so(x^2 + y^2 - 3 z^2) and translations: null vectors only over QQ(sqrt(3))"),
    ("ellipsoid_sqrt2", "the ellipsoid x^2 + y^2 + sqrt(2) z^2 = 1"),
    ("so4_so3_float", "the sphere S^3 in floating point"),
)

RUNS: tuple[tuple[str, int, str], ...] = (
    ("rigid_body", 1, "Euler, rigid body"),
    ("rigid_body", 4, "Euler corrected to order 4, rigid body"),
    ("sym3_generic", 4, "the same, eigenvalues 1, 2, 3"),
)
SPAN, SIZES = (0.0, 2.0), (0.1, 0.05, 0.025, 0.0125)


def run_demo(plot: str | None, as_json: bool) -> int:
    """Decide, verify and integrate the example files, print the results, draw the errors; returns the exit code."""
    check_plot_file(plot)
    folder = examples_folder()
    start = time.perf_counter()
    if as_json:
        verdicts = [{"file": f"{name}.json", **_decided(folder, name)[1].to_json()} for name, _ in PAIRS]
        tables = _convergence(folder)
        integration = [{"file": f"{name}.json", **table_json(table)} for name, table in tables]
        facts = {"examples": str(folder), "verdicts": verdicts, "integration": integration}
        _plot([table for _, table in tables], plot)
        show_json({**facts, "picture": plot})
        return YES
    print(f"Files from {folder}\n")
    _tour_of_verdicts(folder)
    _tour_of_a_certificate(folder)
    _tour_of_isotropy(folder)
    _tour_of_the_range_condition(folder)
    _tour_of_integration(folder, plot)
    print(f"\nDone in {time.perf_counter() - start:.1f} s. Next: liehom fullness FILE, liehom catalog, liehom --help")
    return YES


def _decided(folder: Path, name: str) -> tuple[Pair, Verdict]:
    from liehom.exact.fullness.decide import decide_fullness
    from liehom.io.files import load_pair

    pair = load_pair(folder / f"{name}.json")
    verdict = decide_fullness(pair)
    if verdict.certificate is not None:
        verdict.verify()
    return pair, verdict


def _tour_of_verdicts(folder: Path) -> None:
    print("1. Is h full in g, that is: [h, eta] + R eta + h = g for every eta outside h?\n")
    rows = []
    for name, meaning in PAIRS:
        pair, verdict = _decided(folder, name)
        answer = "full" if verdict.full else "not full"
        kind = f"{verdict.certificate.kind}, verified" if verdict.certificate is not None else "none: numerical"
        dimensions = f"{pair.algebra.dimension}/{pair.subalgebra.dimension}"
        rows.append((f"{name}.json", dimensions, pair.field.name, answer, kind, meaning))
    show_table(("file", "dim g/dim h", "over", "verdict", "certificate", "what it is"), rows)


def _tour_of_a_certificate(folder: Path) -> None:
    from liehom.exact.fullness.verdict import NotFull

    print("\n2. Why, in one sentence each\n")
    for name in ("g2_su3", "so31_so21"):
        pair, verdict = _decided(folder, name)
        print(f"  {name}: {verdict}")
        if isinstance(verdict, NotFull) and verdict.eta is not None:
            eta = ", ".join(pair.field.format(x) for x in verdict.eta)
            print(f"    eta = ({eta}): the rank is {verdict.rank} of {pair.dimension} there")


def _tour_of_isotropy(folder: Path) -> None:
    from liehom.exact.fullness.decide import decide_fullness
    from liehom.io.files import load_problem

    print("\n3. Isotropy at a point: SO(3) conjugates symmetric 3 x 3 matrices (a b c; b d e; c e f)\n")
    rho = load_problem(folder / "sym3.json").representation
    rows = []
    for text, point in (
        ("diag(1, 1, 2)", [1, 0, 0, 1, 0, 2]),
        ("diag(1, 2, 3)", [1, 0, 0, 2, 0, 3]),
        ("the identity", [1, 0, 0, 1, 0, 1]),
    ):
        pair = rho.pair(point)
        answer = "full" if decide_fullness(pair).full else "not full"
        rows.append((text, str(pair.subalgebra.dimension), str(rho.orbit_dimension(point)), answer))
    show_table(("point", "dim isotropy", "dim orbit", "full"), rows)


def _tour_of_the_range_condition(folder: Path) -> None:
    from liehom.exact.fullness.verdict import NotFull
    from liehom.exact.orbits.range import range_condition

    print("\n4. The range condition in de Sitter space: at a generic psi, on the null cone, inside h\n")
    pair, verdict = _decided(folder, "so31_so21")
    for text, psi in (
        ("generic", None),
        ("null", verdict.eta if isinstance(verdict, NotFull) else None),
        ("in h", pair.subalgebra.rows()[0]),
    ):
        condition = range_condition(pair, psi)
        state = {True: "holds", False: "fails", None: "not decided"}[condition.holds]
        print(f"  {text:<8} {state}: rank {condition.rank} of {condition.dimension}; {condition.message}")


def _convergence(folder: Path) -> list[tuple[str, ConvergenceTable]]:
    """Pairs (name of the file, table of orders) of all runs."""
    from liehom.io.files import load_problem

    tables = []
    for name, order, _ in RUNS:
        problem = load_problem(folder / f"{name}.json")
        options = MappingProxyType({**problem.options, "base": "euler", "order": order, "t_span": SPAN})
        tables.append((name, measured(replace(problem, options=options), SIZES)))
    return tables


def _tour_of_integration(folder: Path, plot: str | None) -> None:
    from liehom.flow.propagation.propagator import without_order_warning
    from liehom.io.files import load_problem

    print(
        "\n5. Integration: a rigid body on the sphere by Euler's step, and by the same step corrected to order 4 along"
    )
    print("   the isotropy of each point, which is full in so(3); the errors are measured\n")
    tables = _convergence(folder)
    for _, table in tables[:-1]:
        _print_indented(str(table))
    print("   Symmetric matrices with eigenvalues 1, 2, 3 have no isotropy and nothing is gained, as the report says\n")
    _print_indented(str(tables[-1][1]))
    problem = load_problem(folder / "sym3_generic.json")
    with without_order_warning():
        report = problem.integrate(t_span=SPAN).report
    _print_indented("\n".join(str(report).splitlines()[1:3]))
    _plot([table for _, table in tables], plot)
    print(f"Plot of these errors: {plot}" if plot else "liehom demo --plot errors.png  draws these errors")


def _print_indented(text: str) -> None:
    print("".join(f"  {line}\n" for line in text.splitlines()))


def _plot(tables: list[ConvergenceTable], path: str | None) -> None:
    """Draw the errors, if there is a path."""
    if path is not None:
        from liehom.plotting.error_plot import plot_convergence

        plot_convergence(tables, path, labels=[label for _, _, label in RUNS])
