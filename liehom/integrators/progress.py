"""Progress of a run: a bar on standard error, or a user's function of the fraction done.

Imports nothing of liehom.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, final

INTERVAL = 0.1


@final
class Progress:
    """Calls back at most every tenth of a second, and at the end.

    Parameters
    ----------
    show : bool or callable
        True: a bar on standard error; a function: called with the fraction done, from 0 to 1.

    Examples
    --------
    >>> seen = []
    >>> with Progress(seen.append) as progress:
    ...     progress.update(0.5)
    ...     progress.update(1.0)
    >>> seen[-1]
    1.0
    """

    def __init__(self, show: bool | Callable[[float], Any]) -> None:
        self._callback = show if callable(show) else None
        self._bar: Any = None
        self._task: Any = None
        self._show = show is True
        self._last = -INTERVAL

    def __enter__(self) -> Progress:
        if self._show:
            from rich.console import Console
            from rich.progress import Progress as Bar

            self._bar = Bar(console=Console(stderr=True), transient=True)
            self._bar.start()
            self._task = self._bar.add_task("integrating", total=1.0)
        return self

    def update(self, fraction: float) -> None:
        """Report the fraction done."""
        if self._callback is None and self._bar is None:
            return
        now = time.monotonic()
        if fraction < 1 and now - self._last < INTERVAL:
            return
        self._last = now
        if self._callback is not None:
            self._callback(fraction)
        if self._bar is not None:
            self._bar.update(self._task, completed=fraction)

    def __exit__(self, *error: object) -> None:
        if self._bar is not None:
            self._bar.stop()
