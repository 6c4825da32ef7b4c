"""Steps of a running command: shown on a terminal after one second, and named in the message after Ctrl-C."""

from __future__ import annotations

import sys
import threading
import time
from contextvars import ContextVar, Token
from typing import TYPE_CHECKING, final

if TYPE_CHECKING:
    from types import TracebackType

    from rich.progress import Progress

DELAY = 1.0
"""Seconds after which the step is shown."""
SHOWN_SECONDS = 0.5
"""Finished steps that took less are not listed after Ctrl-C."""


@final
class Steps:
    """Context manager for the work of a command; `step` names the step that begins.

    The display is on standard error, only if that is a terminal, and is erased at the end. After Ctrl-C the message
    names the step and the finished steps with their times, unless the command has a message of its own.

    Examples
    --------
    >>> with Steps() as steps:
    ...     step("invariant forms")
    ...     step("commutant")
    ...
    >>> [name for name, _ in steps.finished]
    ['invariant forms']
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
    steps = _current.get()
    if steps is not None:
        steps.begin(name)


def rename_step(name: str) -> None:
    """Change the name of the current step, as for a counter."""
    steps = _current.get()
    if steps is not None:
        steps.rename(name)
