"""Progress of a run: a bar on standard error, or a user's function of the fraction done."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, final

from liehom.budget import in_time
from liehom.errors import InputError, displayed

INTERVAL = 0.1
"""Seconds between two reports."""


@final
class Progress:
    """Reports of the fraction done, at most every tenth of a second and at the end.

    Parameters
    ----------
    show : bool or callable
        True: a bar on standard error. A function is called with the fraction done, from 0 to 1.
    task : str, optional
        The word before the bar.

    Raises
    ------
    InputError
        If it is neither a bool nor a function.

    Examples
    --------
    >>> seen = []
    >>> with Progress(seen.append) as progress:
    ...     progress.update(lambda: 0.5)
    ...     progress.update(lambda: 1.0, last=True)
    ...
    >>> seen[-1]
    1.0
    """

    def __init__(self, show: bool | Callable[[float], object], task: str = "integrating") -> None:
        if not callable(show) and show not in (True, False, None):
            raise InputError(f"progress is {displayed(show)}, expected True, False or a function of the fraction done")
        self._callback = show if callable(show) else None
        self._bar: Any = None
        self._name = task
        self._task: Any = None
        self._silent = not show
        self._last = -INTERVAL

    def __enter__(self) -> Progress:
        if not self._silent and self._callback is None:
            from rich.console import Console
            from rich.progress import Progress as Bar

            self._bar = Bar(console=Console(stderr=True), transient=True)
            self._bar.start()
            self._task = self._bar.add_task(self._name, total=1.0)
        return self

    def update(self, fraction: Callable[[], float], *, last: bool = False) -> None:
        """Report the fraction done; `fraction` is called only if it is shown. Raises `LimitError` after a deadline."""
        in_time()
        if self._silent:
            return
        now = time.monotonic()
        if not last and now - self._last < INTERVAL:
            return
        self._last = now
        done = min(1.0, max(0.0, fraction()))
        if self._callback is not None:
            self._callback(done)
        if self._bar is not None:
            self._bar.update(self._task, completed=done)

    def __exit__(self, *error: object) -> None:
        if self._bar is not None:
            self._bar.stop()
