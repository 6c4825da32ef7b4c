"""Reproduction of a figure: tables, claims with their evidence, a plot, captions, and the files of all these.

A caption names the claims of the paper that fail. The files of a figure are written together when it is finished. The
last of them, NAME.json, lists the others with their fingerprints, so `stored` finds figures that are complete.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import sys
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from liehom.base.disk import check_target, json_object, write_together
from liehom.base.errors import FormatError, InputError
from liehom.plotting.canvas import finished, rendered, style
from liehom.studies.paper.table import Table, mathtext, typeset

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = ("png", "svg", "pdf")
"""Formats of plots."""
# Points, characters and inches of the lines of a caption in a plot
CAPTION_SIZE, CHARACTERS_PER_INCH, LINE_HEIGHT = 8, 16.5, 0.16


@dataclass(frozen=True, slots=True)
class Check:
    """Claim of the paper or of its correction, the evidence, and whether the claim holds.

    Attributes
    ----------
    claim, found : str
    holds : bool
    refutes : str
        Claim of the paper that fails if this claim holds; empty if there is none.
    table : str
        Key of the table that shows the evidence.

    Examples
    --------
    >>> Check("2 > 1", "2 - 1 = 1", True, refutes="1 > 2").failure
    '1 > 2 (found: 2 - 1 = 1)'
    """

    claim: str
    found: str
    holds: bool
    refutes: str = ""
    table: str = ""

    @property
    def failure(self) -> str:
        """Claim that fails with the evidence against it; an empty string if none fails."""
        failing = self.refutes if self.holds else self.claim
        return f"{failing} (found: {self.found})" if failing else ""


@dataclass(frozen=True, slots=True)
class Reproduction:
    """Reproduction of a figure of the paper.

    Attributes
    ----------
    name, title : str
    sample : str
        Sentence on the random data: distribution, numbers, seed.
    tables : dict of str to Table
        Tables by the end of their file names; "" is the main table.
    checks : tuple of Check
    notes : tuple of str
    draw : callable or None
        Makes the plot as a figure of matplotlib; None if there is no plot.
    shows : str
        Sentence that says what the plot shows.
    settings : dict
        Arguments of `reproduce`.

    Examples
    --------
    >>> done = Reproduction("fig0", "Figure 0", "No data.", {}, (Check("1 = 1", "1", True, "1 = 2"),))
    >>> done.holds, done.caption()
    (True, 'Figure 0. Claims that fail: 1 = 2 (found: 1).')
    """

    name: str
    title: str
    sample: str
    tables: dict[str, Table]
    checks: tuple[Check, ...] = ()
    notes: tuple[str, ...] = ()
    draw: Callable[[], Figure] | None = None
    shows: str = ""
    settings: Mapping[str, Any] = field(default_factory=dict)

    @property
    def holds(self) -> bool:
        """Whether all checks hold."""
        return all(check.holds for check in self.checks)

    def failures(self, table: str | None = None) -> list[str]:
        """Claims that fail, with the evidence: those of the paper, and those of the reproduction.

        Parameters
        ----------
        table : str, optional
            Key of a table: only the claims that it refutes (default: all).
        """
        return [c.failure for c in self.checks if c.failure and table in (None, c.table)]

    def caption(self, table: str | None = None) -> str:
        """Caption of the plot, or of a table: its title, what it shows, and the claims that fail.

        Parameters
        ----------
        table : str, optional
            Key of a table (default: the caption of the plot).
        """
        first = [f"{self.title}.", self.shows] if table is None else [f"{self.tables[table].title}."]
        first += [] if table else self.notes
        return " ".join(part for part in (*first, _fails(self.failures(table))) if part)

    def markdown(self, plot: str | None = None) -> str:
        """Page in Markdown with the title, the data, the plot, all tables and the claims.

        Parameters
        ----------
        plot : str, optional
            Name of the file of the plot (default: none).
        """
        parts = [f"# {self.title}", self.sample]
        if plot is not None:
            parts += [f"![{self.title}]({plot})", f"*{self.caption()}*"]
        for key, table in self.tables.items():
            body = table.markdown() if table.in_markdown else f"{len(table.rows)} rows: see the CSV file."
            parts.append(f"## {table.title}\n\n{body}")
            if failing := self.failures(key):
                parts.append(f"*{_fails(failing)}*")
        if self.checks:
            rows = [(c.claim, c.found, "yes" if c.holds else "NO") for c in self.checks]
            parts.append("## Claims\n\n" + Table("claims", ("claim", "found", "holds"), rows).markdown())
        return "\n\n".join([*parts, *self.notes]) + "\n"

    def latex(self) -> str:
        """Tables in LaTeX, for ``\\input``; their captions name the claims that fail."""
        tables = [table.latex(self.caption(key)) for key, table in self.tables.items() if table.in_markdown]
        return "\n\n".join([f"% {typeset(self.title)}", *tables]) + "\n"

    def plot(self, path: str | os.PathLike[str] | None = None, *, dark: bool = False) -> Figure:
        """Plot with its caption as a figure of matplotlib, after it is written to a file if a path is given.

        Parameters
        ----------
        path : path, optional
            File to write: .png, .pdf, .svg, ....
        dark : bool, optional
            Draw for a dark page.

        Raises
        ------
        InputError
            If this figure has no plot, or matplotlib is not installed.
        FormatError
            If the file cannot be written.
        """
        if self.draw is None:
            raise InputError(f"{self.name} is a table in the paper and has no plot: use .tables or .markdown()")
        with style(dark=dark):
            figure = self.draw()
            width, height = figure.get_size_inches()
            lines = [mathtext(line) for line in textwrap.wrap(self.caption(), round(CHARACTERS_PER_INCH * width))]
            figure.set_size_inches(width, height + LINE_HEIGHT * len(lines))
            figure.supxlabel("\n".join(lines), x=0.005, ha="left", fontsize=CAPTION_SIZE)
            return finished(figure, path)

    def files(self, formats: Sequence[str] = FORMATS, *, dark: bool = False) -> dict[str, bytes]:
        """Contents of the files NAME.md, NAME.tex, NAME.csv (one for each table), the plots and NAME.json, by names.

        Parameters
        ----------
        formats : sequence of str, optional
            Formats of the plot, of png, svg and pdf. With none, matplotlib is not needed.
        dark : bool, optional
            Draw for a dark page.
        """
        wrong = [kind for kind in formats if kind not in FORMATS]
        if wrong:
            raise InputError(f"plots have no format {wrong[0]!r}, expected some of {', '.join(FORMATS)}")
        plots: dict[str, bytes] = {}
        if self.draw is not None and formats:
            figure = self.plot(dark=dark)
            with style(dark=dark):
                if (layout := figure.get_layout_engine()) is not None:  # once for all formats
                    layout.execute(figure)
                    figure.set_layout_engine("none")
                plots = {f"{self.name}.{kind}": rendered(figure, kind, self._about(kind)) for kind in formats}
        texts = {f"{self.name}.md": self.markdown(next(iter(plots), None)), f"{self.name}.tex": self.latex()}
        texts |= {f"{self.name}{'_' if end else ''}{end}.csv": table.csv() for end, table in self.tables.items()}
        contents = {name: text.encode() for name, text in texts.items()} | plots
        return contents | {f"{self.name}.json": self._record(contents, formats, dark)}

    def write(
        self, folder: str | os.PathLike[str], formats: Sequence[str] = FORMATS, *, dark: bool = False
    ) -> list[Path]:
        """Paths of the files of `files`, after writing them; an existing figure with this name is replaced.

        Ctrl-C while the files are written waits until they are complete.

        Parameters
        ----------
        folder : path
        formats, dark
            As for `files`.

        Raises
        ------
        FormatError
            If a file cannot be written.
        InputError
            If matplotlib is not installed, or a format is unknown.
        """
        contents = self.files(formats, dark=dark)
        target = Path(os.fspath(folder))
        record = target / f"{self.name}.json"
        try:
            target.mkdir(parents=True, exist_ok=True)
            for name in contents:
                check_target(target / name, force=True)
            for name in set(_read(record).get("files", ())) - contents.keys():
                with contextlib.suppress(FileNotFoundError):
                    (target / Path(name).name).unlink()
            record.unlink(missing_ok=True)
            return write_together(target, contents)
        except OSError as error:
            raise FormatError(f"{os.fspath(folder)!r} cannot be written: {error.strerror or error}") from None

    def to_json(self) -> dict[str, Any]:
        """JSON object of the settings, the tables, the claims and the caption."""
        tables = {end or "table": table.to_json() for end, table in self.tables.items() if table.in_markdown}
        checks = [{"claim": c.claim, "found": c.found, "holds": c.holds, "refutes": c.refutes} for c in self.checks]
        found = {"name": self.name, "title": self.title, "sample": self.sample, "settings": dict(self.settings)}
        return {**found, "tables": tables, "checks": checks, "caption": self.caption(), "holds": self.holds}

    def _about(self, kind: str) -> dict[str, str]:
        return {"Title": self.title, "Subject" if kind == "pdf" else "Description": self.caption()}

    def _record(self, contents: Mapping[str, bytes], formats: Iterable[str], dark: bool) -> bytes:
        files = {name: hashlib.sha256(content).hexdigest() for name, content in contents.items()}
        data = {**self.to_json(), **_drawn(formats, dark), "files": files}
        return (json.dumps(data, indent=1, allow_nan=False) + "\n").encode()


def stored(
    folder: str | os.PathLike[str],
    name: str,
    settings: Mapping[str, Any],
    formats: Iterable[str] = FORMATS,
    *,
    dark: bool = False,
) -> dict[str, Any] | None:
    """JSON object of a figure that was written completely with these settings; None if there is none.

    Parameters
    ----------
    folder : path
    name : str
    settings : dict
        Arguments of `reproduce`: quick and seed.
    formats, dark
        Arguments of `Reproduction.write`.

    Examples
    --------
    >>> stored("no/such/folder", "fig1", {"quick": True, "seed": None}) is None
    True
    """
    record = _read(Path(folder) / f"{name}.json")
    wanted = {"settings": dict(settings), **_drawn(formats, dark)}
    if not isinstance(record.get("files"), dict) or any(record.get(key) != value for key, value in wanted.items()):
        return None
    try:
        is_whole = all(
            hashlib.sha256((Path(folder) / file).read_bytes()).hexdigest() == value
            for file, value in record["files"].items()
        )
    except OSError:
        return None
    return record if is_whole else None


def _drawn(formats: Iterable[str], dark: bool) -> dict[str, Any]:
    """Entries of NAME.json besides the settings that decide the files; the package is loaded before this module."""
    return {"formats": sorted(formats), "dark": dark, "liehom": sys.modules["liehom"].__version__}


def _read(path: Path) -> dict[str, Any]:
    try:
        return json_object(path.read_bytes())
    except (OSError, ValueError):
        return {}


def _fails(failing: Sequence[str]) -> str:
    return f"Claims that fail: {'; '.join(failing)}." if failing else ""
