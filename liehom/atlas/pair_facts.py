"""Facts about one decided pair: its row if it is full, the range condition for generic eta, orbits of the isotropy.

A fact is exact, or it is missing and the reason is stated.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

from liehom.budget import in_time, limits
from liehom.errors import FieldError, LimitError, UndecidedError
from liehom.fullness import Full, Verdict, classify
from liehom.homogeneous.range import invariant_degree, open_orbit_count, orbit_dimension
from liehom.representations import Pair

Fact: TypeAlias = bool | int | str | list[int | str | None] | dict[str, str] | None
"""A fact as a JSON value."""

SECONDS = 60.0
"""Default limit for each fact."""


def facts(pair: Pair, verdict: Verdict, *, seconds: float = SECONDS) -> dict[str, Fact]:
    """Facts about a decided pair, a JSON object.

    Parameters
    ----------
    pair : Pair
    verdict : Full, NotFull or another verdict
        Of `liehom.decide_fullness` for this pair.
    seconds : float
        Limit for each fact. One that takes longer is missing.

    Returns
    -------
    dict
        ``"key"``, ``"row"`` and ``"space"``: key, name and space of the row of a full pair in the classification, see
        `liehom.classify`; None for other pairs.
        ``"range_condition"``: whether [h, eta] + R eta + h = g for generic eta.
        ``"orbit_dimension"``: the dimension of [h, eta] + R eta in g/h for generic eta, see `liehom.orbit_dimension`.
        ``"invariant_degree"``: see `liehom.invariant_degree`; None if the range condition holds for no eta.
        ``"open_orbits"``: the number of open orbits on g/h, see `liehom.open_orbit_count`.
        ``"missing"``: the reasons why facts are missing, by their names. The missing facts are None.

    Examples
    --------
    >>> import liehom as lh
    >>> pair = lh.pair("so(3,1)/so(2,1)")
    >>> found = facts(pair, lh.decide_fullness(pair))
    >>> found["range_condition"], found["orbit_dimension"], found["invariant_degree"], found["open_orbits"]
    (True, 3, 2, 3)
    """
    d, full = pair.dimension, isinstance(verdict, Full)
    missing: dict[str, str] = {}

    def fact(name: str, compute: Callable[[Pair], int | None]) -> int | None:
        try:
            return _in(seconds, compute, pair)
        except (FieldError, UndecidedError) as error:
            missing[name] = str(error)
        return None

    dimension = d if full else fact("orbit_dimension", orbit_dimension)
    holds = None if dimension is None else dimension == d
    degree = fact("invariant_degree", invariant_degree) if holds else None
    if full:
        orbits: int | None = 2 if d == 1 else 1  # the connected group is transitive on rays
    else:
        orbits = fact("open_orbits", open_orbit_count) if holds else None if holds is None else 0
    if holds is None:
        missing |= dict.fromkeys(("range_condition", "invariant_degree", "open_orbits"), missing["orbit_dimension"])
    return _row(pair, verdict) | {
        "range_condition": holds,
        "orbit_dimension": dimension,
        "invariant_degree": degree,
        "open_orbits": orbits,
        "missing": missing,
    }


def _row(pair: Pair, verdict: Verdict) -> dict[str, Fact]:
    if not isinstance(verdict, Full):
        return {"key": None, "row": None, "space": None}
    found = classify(pair, verdict)
    key = [value if isinstance(value, int | str) or value is None else str(value) for value in found.key]
    return {"key": key, "row": found.name, "space": found.space}


def _in(seconds: float, compute: Callable[[Pair], int | None], pair: Pair) -> int | None:
    """The value; `UndecidedError` if it takes longer, or is larger than another limit allows."""
    try:
        with limits(seconds=seconds):
            return compute(pair)
    except LimitError as error:
        if error.limit != "seconds":
            raise UndecidedError(str(error)) from None
    in_time()  # a limit of the caller has passed
    raise UndecidedError(f"not computed within {seconds:g} seconds")
