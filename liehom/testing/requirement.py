"""The condition of a check, with the error that names the check."""

from __future__ import annotations

from liehom.errors import ConformanceError


def require(holds: object, check: str, message: str) -> None:
    """Raise `ConformanceError` with the name of the check and the message if the condition is false."""
    if not bool(holds):
        raise ConformanceError(check, message)
