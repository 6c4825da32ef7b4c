"""Exit codes, printing of results, and the steps of a running command."""

from __future__ import annotations

import errno
import io
import json
import math
import os
import sys
import textwrap
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextvars import ContextVar, Token
from shutil import get_terminal_size
from typing import TYPE_CHECKING, Any, final

from liehom.base.errors import CertificateError, CertificateFormatError, InternalError, LiehomError, UndecidedError

if TYPE_CHECKING:
    from types import TracebackType

    from rich.progress import Progress

# Exit codes: every command runs under `guarded`, which maps exceptions to documented codes.
#
# Messages go to standard error. A command prints to standard output only after it has computed its whole answer.

YES, NO, BAD_INPUT, NUMERICAL, INTERNAL, NOT_WRITTEN, INTERRUPTED, BROKEN_PIPE = 0, 1, 2, 3, 70, 74, 130, 141

# Classes of errors, what messages about them begin with, and exit codes; the first class that fits counts
OUTCOMES: tuple[tuple[type[LiehomError], str, int], ...] = (
    (CertificateFormatError, "error", BAD_INPUT),
    (CertificateError, "the certificate fails", NO),
    (InternalError, "internal error", INTERNAL),
    (UndecidedError, "undecided", NUMERICAL),
    (LiehomError, "error", BAD_INPUT),
)


def guarded(action: Callable[[], int]) -> int:
    """Exit code of an action, or of the exception that it raises; its message is printed."""
    try:
        code = action()
        sys.stdout.flush()
        return code
    except LiehomError as error:
        words, code = next((words, code) for kind, words, code in OUTCOMES if isinstance(error, kind))
        return say(f"{words}: {_with_notes(error)}", code)
    except KeyboardInterrupt as interrupt:
        return say(f"interrupted{interrupt}", INTERRUPTED)
    except OSError as error:
        if error.filename is None and sys.stdout is not None:
            return close_output(error)
        return say(_bug_report(error), INTERNAL)
    except Exception as error:  # noqa: BLE001  the top of the program: any other exception is a bug
        return say(_bug_report(error), INTERNAL)


def repair_streams() -> None:
    """Open what was closed by the caller: files would get its number, and messages go to standard output."""
    for number, access in ((0, os.O_RDONLY), (1, os.O_RDONLY), (2, os.O_WRONLY)):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, access)  # takes the lowest free number
    if sys.stdout is None:
        sys.stdout = io.TextIOWrapper(io.FileIO(1, "w", closefd=False), encoding="utf-8")
    if sys.stderr is None:
        sys.stderr = io.TextIOWrapper(io.FileIO(2, "w", closefd=False), encoding="utf-8")


def close_output(error: OSError) -> int:
    """Exit code after standard output could not be written, which is redirected; a closed pipe needs no message."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (sys.stdout, sys.__stdout__):
        try:
            os.dup2(nowhere, stream.fileno())  # type: ignore[union-attr]
        except (OSError, ValueError, AttributeError):
            continue
    if error.errno == errno.EPIPE:
        return BROKEN_PIPE
    return say(f"error: standard output cannot be written: {error.strerror or error}", NOT_WRITTEN)


def say(message: str, code: int) -> int:
    """The exit code, after a message on standard error: one line, wrapped between words on a terminal."""
    line = f"liehom: {message}"
    try:
        print(_wrapped(line) if sys.stderr.isatty() else line, file=sys.stderr, flush=True)
    except (OSError, ValueError):  # a full disk: the exit code has to do
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    return code


def _wrapped(line: str) -> str:
    """The line broken between words only, and not within `commands`, so that they can be copied."""
    import re
    import shutil
    import textwrap

    width = max(shutil.get_terminal_size().columns - 1, 20)
    joined = re.sub("`[^`]*`", lambda code: code[0].replace(" ", "\0"), line)
    wrapped = textwrap.fill(joined, width, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)
    return wrapped.replace("\0", " ")


def _with_notes(error: BaseException) -> str:
    """Message of an error and its notes, which name a command that helps."""
    return "; ".join([str(error), *getattr(error, "__notes__", ())])


def _bug_report(error: Exception) -> str:
    if os.environ.get("LIEHOM_TRACEBACK"):
        import traceback

        traceback.print_exc()
    return (
        f"internal error ({type(error).__name__}: {str(error)[:500]}); this is a bug in liehom, please report it with "
        "the input (LIEHOM_TRACEBACK=1 shows where it arose)"
    )


# Steps of a running command: shown on a terminal after one second, and named in the message after Ctrl-C.

DELAY = 1.0  # Seconds after which the step is shown
SHOWN_SECONDS = 0.5  # Finished steps that took less are not listed after Ctrl-C


@final
class Steps:
    """Context manager for the work of a command; `step` names the step that begins.

    The display is on standard error, only if that is a terminal, and is erased at the end. After Ctrl-C the message
    names the step and the finished steps with their times, unless the command has a message of its own.
    """

    def __init__(self) -> None:
        self.finished: list[tuple[str, float]] = []
        self._name = ""
        self._begin = time.monotonic()
        self._lock = threading.Lock()
        self._timer: threading.Timer | None = None
        self._bar: Progress | None = None

    def __enter__(self) -> Steps:
        self._token: Token[Steps | None] = _current.set(self)
        return self

    def begin(self, name: str) -> None:
        """Begin a step; the step before it is finished. An empty name ends the display."""
        now = time.monotonic()
        with self._lock:
            if self._name:
                self.finished.append((self._name, now - self._begin))
            self._name, self._begin = name, now
            if not name:
                self._hide()
            elif self._bar is not None:
                self._bar.reset(self._bar.task_ids[0], description=name)
            elif self._timer is None and sys.stderr is not None and sys.stderr.isatty():
                self._timer = threading.Timer(DELAY, self._show)
                self._timer.daemon = True
                self._timer.start()

    def rename(self, name: str) -> None:
        """Change the name of the current step, as for a counter."""
        with self._lock:
            self._name = name
            if self._bar is not None:
                self._bar.update(self._bar.task_ids[0], description=name)

    def _show(self) -> None:
        from rich.console import Console
        from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

        with self._lock:
            if self._timer is None or not self._name:  # the work has ended meanwhile
                return
            self._bar = Progress(
                SpinnerColumn("line"),
                TextColumn("{task.description}", markup=False),
                TimeElapsedColumn(),
                console=Console(stderr=True),
                transient=True,
                redirect_stdout=False,
                redirect_stderr=False,
            )
            self._bar.add_task(self._name, total=None)
            self._bar.tasks[0].start_time = self._begin
            self._bar.start()

    def _hide(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
        if self._bar is not None:
            self._bar.stop()
        self._timer = self._bar = None

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        _current.reset(self._token)
        with self._lock:
            self._hide()
        if isinstance(error, KeyboardInterrupt) and not error.args and self._name:
            raise KeyboardInterrupt(self._interrupted()) from None

    def _interrupted(self) -> str:
        """Sentence after "interrupted": where, what was finished, and how to go on."""
        long = [f"{name} ({seconds:.0f} s)" for name, seconds in self.finished if seconds >= SHOWN_SECONDS]
        done = f"; finished: {', '.join(long)}" if long else ""
        spent = f" in the step: {self._name} ({time.monotonic() - self._begin:.0f} s)"
        return f"{spent}{done}; nothing is stored, so the same command begins again"


_current: ContextVar[Steps | None] = ContextVar("steps of the command", default=None)


def step(name: str) -> None:
    """Begin a step of the running command; an empty name ends the display, before output or another display."""
    if (steps := _current.get()) is not None:
        steps.begin(name)


def rename_step(name: str) -> None:
    """Change the name of the current step, as for a counter."""
    if (steps := _current.get()) is not None:
        steps.rename(name)


# Printing of results: panels on a terminal, plain lines in a pipe, one object with --json.

STYLES = {0: "green", 1: "red", 3: "yellow"}  # Colour of a panel for each exit code


def show_json(data: Mapping[str, Any]) -> None:
    """Print one JSON object to standard output."""
    step("")
    print(json.dumps(finite(data), allow_nan=False))


def finite(value: Any) -> Any:
    """The value with infinities and NaN as strings, since JSON has no such numbers."""
    if isinstance(value, Mapping):
        return {key: finite(x) for key, x in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(x) for x in value]
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value


def show_answer(sentence: str, rows: Sequence[tuple[str, str]], code: int = 0) -> None:
    """Print a sentence and labelled facts below it."""
    step("")
    if not sys.stdout.isatty():
        width = max((len(name) for name, _ in rows), default=0)
        print(sentence)
        for name, value in rows:
            print(f"  {name:<{width}}  {value}")
        return
    from rich.table import Table
    from rich.text import Text

    table = Table.grid(padding=(0, 2))
    for name, value in rows:
        table.add_row(Text(name, style="dim"), Text(value))
    style = STYLES.get(code, "green")
    _print_panel(style, Text(sentence, style=f"bold {style}"), Text(""), table)


def show_result(
    as_json: bool, data: Mapping[str, Any], sentence: str, rows: Sequence[tuple[str, str]], code: int = 0
) -> int:
    """Print an answer, with --json its JSON object; returns the exit code."""
    if as_json:
        show_json(data)
    else:
        show_answer(sentence, rows, code)
    return code


def show_lines(lines: Sequence[str]) -> None:
    """Print lines, the first of which is the title."""
    step("")
    if not sys.stdout.isatty():
        print("\n".join(lines))
        return
    from rich.text import Text

    width = max(_console().width - 4, 20)
    _print_panel("green", Text(lines[0], style="bold green"), *(Text(_indented(line, width)) for line in lines[1:]))


def _console() -> Any:
    from rich.console import Console

    return Console()


def _print_panel(style: str, *parts: Any) -> None:
    from rich.console import Group
    from rich.panel import Panel

    _console().print(Panel(Group(*parts), border_style=style, expand=False))


def _indented(line: str, width: int) -> str:
    """The line wrapped at a width; the lines below the first are indented by two spaces more."""
    indent = line[: len(line) - len(line.lstrip())]
    return textwrap.fill(line, width, subsequent_indent=f"{indent}  ", break_on_hyphens=False)


def show_table(columns: Sequence[str], rows: Sequence[Sequence[str]], *, header: bool = True) -> None:
    """Print a table; as aligned plain lines in a pipe, or if the terminal is too narrow for the longest words."""
    step("")
    if not sys.stdout.isatty() or _least_width(columns, rows) > get_terminal_size().columns:
        shown = [columns, *rows] if header else list(rows)
        widths = [max(len(row[c]) for row in shown) for c in range(len(columns))] if shown else []
        for row in shown:
            print("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())
        return
    from rich.table import Table
    from rich.text import Text

    table = Table()
    for column, *cells in zip(columns, *rows, strict=True):
        table.add_column(column, no_wrap=not _wraps(cells))
    for row in rows:
        table.add_row(*(Text(cell) for cell in row))
    _console().print(table)


def show_rows(
    as_json: bool,
    data: Mapping[str, Any],
    columns: Sequence[str],
    rows: Sequence[Sequence[str]],
    *,
    header: bool = True,
) -> int:
    """Print a table, with --json its JSON object; returns the exit code 0."""
    if as_json:
        show_json(data)
    else:
        show_table(columns, rows, header=header)
    return 0


def _wraps(cells: Sequence[str]) -> bool:
    """Whether a column has spaces between words, and not only before a number without its sign."""
    return any(" " in cell.strip() for cell in cells)


def _least_width(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> int:
    """Width of a table with lines between its cells, if the cells are wrapped between words wherever possible."""
    width = 1
    for name, *cells in zip(columns, *rows, strict=True):
        parts = [word for cell in cells for word in cell.split()] if _wraps(cells) else cells
        width += 3 + max(len(part) for part in [*parts, *name.split(), ""])
    return width


def short_vector(values: Sequence[str], limit: int = 100) -> str:
    """String of a vector: all entries if it is short, else its nonzero entries, else its length."""
    full = "(" + ", ".join(values) + ")"
    if len(full) <= limit:
        return full
    terms = [f"{v} e{i}" for i, v in enumerate(values) if v != "0"]
    sparse = " + ".join(terms)
    return sparse if len(sparse) <= limit else f"a vector of length {len(values)} with {len(terms)} non-zero entries"
