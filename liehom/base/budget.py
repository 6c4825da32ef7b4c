"""Budgets: how large an input may be, how long a computation may take, and how a caller changes that.

Every door of the library (values, names, files, constructors) asks `within` before it works on something whose size
the caller chose, and long loops call `in_time`. A `LimitError` names the limit that is exceeded. Limits are context
variables: `with limits(...)` changes them for the code inside, in this thread or asynchronous task only.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, fields, replace
from typing import final

from liehom.base.errors import InputError, LimitError

VARIABLE = "LIEHOM_LIMITS"  # Environment variable with other defaults, such as ``digits=100000,seconds=60``
MAX_PARAMETER_DIGITS = 18
DIGITS_PER_BIT = 0.30103


@final
@dataclass(frozen=True, slots=True)
class Limits:
    """The limits in force; `current_limits` returns them, `limits` changes them.

    Attributes
    ----------
    digits : int
        Decimal digits of the numerator or denominator of a number that is read or evaluated.
    characters : int
        Characters of a value, a name or the text of an expression.
    nesting : int
        Depth of parentheses, signs and functions in a value or name.
    exponent : int
        Exponent in a value, in absolute value.
    radicals : int
        Different square roots in the values of one object.
    minpoly_degree : int
        Degree of a minimal polynomial: of a number field, or of the number in a certificate.
    coefficient_bits : int
        Bits of all coefficients together of a minimal polynomial, and of its roots where they are separated.
    dimension : int
        Dimension of an algebra, and with it every parameter of a family.
    entries : int
        Structure constants in a file, integers in the ranges of a table of GAP, entries of a Cartan matrix.
    memory : int
        Bytes of the matrices of an algebra or module, estimated before they are allocated.
    file_bytes : int
        Bytes of a file.
    seconds : float, optional
        Seconds of wall clock from the start of the `with` block, or of the process.

    Examples
    --------
    >>> current_limits().nesting
    100
    """

    digits: int = 10_000
    characters: int = 200_000
    nesting: int = 100
    exponent: int = 4096
    radicals: int = 4
    minpoly_degree: int = 64
    coefficient_bits: int = 500_000
    dimension: int = 4096
    entries: int = 20_000_000
    memory: int = 2 * 1024**3
    file_bytes: int = 64 * 1024**2
    seconds: float | None = None

    def __post_init__(self) -> None:
        for name in NAMES:
            value = getattr(self, name)
            if name == "seconds":
                if value is not None and (type(value) is bool or not isinstance(value, int | float) or not value >= 0):
                    raise InputError(f"the limit seconds is {value!r}, expected a number from 0, or None")
            elif not (type(value) is int and value >= 0):
                raise InputError(f"the limit {name} is {value!r}, expected an integer from 0")


NAMES = tuple(field.name for field in fields(Limits))
"""Names of all limits."""


def parsed_limits(text: str) -> dict[str, int | float]:
    """The limits in a string such as ``digits=100000,seconds=60``."""
    values: dict[str, int | float] = {}
    for part in filter(None, (part.strip() for part in text.split(","))):
        name, _, value = (x.strip() for x in part.partition("="))
        _check_name(name)
        try:
            values[name] = float(value) if name == "seconds" else int(value)
        except ValueError:
            raise InputError(f"the limit {name} is {value[:40]!r}, expected a number, as in 'digits=100000'") from None
    return values


def _check_name(name: str) -> None:
    if name not in NAMES:
        raise InputError(f"there is no limit {name[:40]!r}; expected one of {', '.join(NAMES)}")


@final
@dataclass(frozen=True, slots=True)
class _InForce:
    limits: Limits
    deadline: float | None  # of time.monotonic


def _of_process() -> _InForce:
    """The limits of the environment variable; seconds count from the first question."""
    global _defaults
    if _defaults is None:
        stated = Limits(**parsed_limits(os.environ.get(VARIABLE, "")))  # type: ignore[arg-type]
        _defaults = _InForce(stated, _deadline(stated.seconds))
    return _defaults


_defaults: _InForce | None = None
_in_force: ContextVar[_InForce | None] = ContextVar("liehom limits", default=None)


def _deadline(seconds: float | None) -> float | None:
    return None if seconds is None else time.monotonic() + seconds


def _now() -> _InForce:
    return _in_force.get() or _defaults or _of_process()


def current_limits() -> Limits:
    """The limits in force here.

    Examples
    --------
    >>> with limits(digits=20000):
    ...     current_limits().digits
    20000
    """
    return _now().limits


def remaining_limits() -> Limits:
    """The limits in force, with the seconds that are left: what a task in another process may use."""
    state = _now()
    if state.deadline is None:
        return state.limits
    return replace(state.limits, seconds=max(0.0, state.deadline - time.monotonic()))


@contextmanager
def limits(**changes: float | None) -> Iterator[Limits]:
    """Context manager that changes limits for the code inside; the others stay as they are.

    Parameters
    ----------
    **changes
        New values by name, see `Limits`. With `seconds`, the code inside must end in this time; an outer deadline that
        comes earlier stays in force.

    Notes
    -----
    The limits hold in this thread or asynchronous task. `liehom.base.tasks` hands them to its workers, whatever the
    executor. Other threads and processes start from the defaults, which the environment variable ``LIEHOM_LIMITS``
    changes; to hand limits on, run the work in ``contextvars.copy_context()``, or pass ``current_limits()`` and enter
    ``limits(**dataclasses.asdict(these))`` in the worker.

    Examples
    --------
    >>> from liehom.exact.scalars import QQ
    >>> with limits(digits=3):
    ...     QQ.convert("12345")
    Traceback (most recent call last):
    ...
    liehom.base.errors.LimitError: the number has 5 digits, the limit is 3; raise it by `with ...
    """
    for name in changes:
        _check_name(name)
    outer = _now()
    changed = replace(outer.limits, **changes)  # type: ignore[arg-type]
    ends = [t for t in (outer.deadline, _deadline(changes.get("seconds"))) if t is not None]
    token = _in_force.set(_InForce(changed, min(ends, default=None)))
    try:
        yield changed
    finally:
        _in_force.reset(token)


def within(limit: str, size: int, what: str) -> None:
    """Raise `LimitError` if `size` is more than the limit of this name."""
    allowed: int = getattr(_now().limits, limit)
    if size > allowed:
        raise LimitError(limit, size, allowed, what)


def in_time() -> None:
    """Raise `LimitError` if the seconds in force have passed; long loops call this."""
    state = _in_force.get() or _defaults or _of_process()
    if state.deadline is not None and time.monotonic() > state.deadline:
        allowed = state.limits.seconds or 0.0
        elapsed = time.monotonic() - state.deadline + allowed
        raise LimitError("seconds", elapsed, allowed, "the computation has taken {} seconds")


def small_integer(digits: str) -> int:
    """A parameter of a family from its decimal digits, perhaps after a sign; no parameter exceeds the dimension."""
    allowed = current_limits().dimension
    if len(digits) > MAX_PARAMETER_DIGITS:
        raise LimitError("dimension", 10 ** (len(digits) - 1), allowed, "a parameter is about {}")
    return int(digits)


def digits_within(bits: int, what: str = "the number has {} digits") -> None:
    """Raise `LimitError` if a number of `bits` bits has more decimal digits than are allowed."""
    within("digits", int(bits * DIGITS_PER_BIT) if bits > 64 else 0, what)
