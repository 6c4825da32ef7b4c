"""Measured tables as comma-separated values: all digits, empty entries for what was not measured."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence

from liehom.disk import check_target, write_file
from liehom.display import comma_separated


def csv_file(
    columns: Sequence[str],
    rows: Iterable[Sequence[float | int | str | None]],
    path: str | os.PathLike[str] | None = None,
    *,
    force: bool = False,
) -> str:
    """Comma-separated values as a string with a line of names, after they are written to a file if a path is given.

    NaN and None become empty entries.

    Raises
    ------
    FormatError
        If the file exists and `force` is False, or the file cannot be written.

    Examples
    --------
    >>> csv_file(("step", "dt"), [("rk4, adaptive", float("nan")), ("rk4", 0.1)])
    'step,dt\\n"rk4, adaptive",\\nrk4,0.1\\n'
    """
    text = comma_separated([columns, *(["" if x is None or x != x else x for x in row] for row in rows)])
    if path is None:
        return text
    check_target(path, force=force)
    write_file(path, text.encode())
    return text
