"""Custom exponentials, given as functions, and the exponential that a name denotes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias, final

import numpy as np

from liehom.base.errors import InputError, SeriesError, ShapeError, displayed
from liehom.base.typing import Values
from liehom.flow.action.exponential import (
    Cayley,
    Exponential,
    MatrixExponential,
    Rodrigues,
    SeriesExponential,
    default_exponential,
)
from liehom.flow.action.maps import action_map
from liehom.flow.door import Representation
from liehom.flow.series.jet import Jet
from liehom.flow.series.node import Node

ExponentialFunction: TypeAlias = Callable[[Any, Any], Any]
"""A function (x, m) -> Exp(x) m of two `Values`."""

ExponentialLike: TypeAlias = "str | Exponential | type[Exponential] | ExponentialFunction"
"""What `exponential_of` reads as an exponential."""

RTOL = 1e-8
STEP = 1e-3


@final
class CustomExponential(Exponential):
    """An exponential given by a function (x, m) -> Exp(x) m that runs on arrays and Jets."""

    def __init__(self, representation: Representation, function: ExponentialFunction, name: str = "custom") -> None:
        if not callable(function):
            raise InputError(f"an exponential is a function (x, m) -> Exp(x) m, got {displayed(function)}")
        self._function, self._name = function, name
        check_exponential(representation, self)

    @property
    def name(self) -> str:
        return self._name

    def act(self, x: Values, m: Values) -> Values:
        return self._function(x, m)


def check_exponential(representation: Representation, exponential: Exponential) -> None:
    """Check that an exponential belongs to a representation and agrees with exp through order 2."""
    rng = np.random.default_rng(0)
    dimension, size = representation.algebra.dimension, representation.size
    # several trajectories with distinct numbers, so that exchanged axes are found
    count = 2 + max(dimension, size)
    x, m = rng.normal(size=(count, dimension)), rng.normal(size=(count, size))
    a = action_map(representation)
    x = x / max(1.0, float(np.linalg.norm(a.left(x), axis=(-2, -1)).max(initial=0.0)))
    what = f"the exponential {displayed(exponential.name)}"
    series = _expanded(what, exponential, x, m)
    wanted = [m, a(x, m), a(x, a(x, m)) / 2]
    for k in range(3):
        defect = float(np.abs(series.coefficient(k) - wanted[k]).max(initial=0.0))
        if not defect <= RTOL * (1 + float(np.abs(m).max(initial=0.0))):
            raise InputError(
                f"{what} differs from exp at t^{k} by {defect:.2g}: it must be 1 + x + x^2/2 + ... (e_2 = 1/2)"
            )
    for points, steps in ((m, x), (m[0], x[0])):
        moved = np.asarray(exponential(STEP * steps, points))
        if moved.shape != points.shape:
            raise ShapeError(
                f"{what} returned shape {moved.shape} for x of shape {steps.shape} and m of shape {points.shape}, "
                f"expected {points.shape}: write x[..., i] and m[..., i]"
            )
        begin = series(STEP) if points is m else series(STEP)[0]
        if not float(np.abs(moved - begin).max(initial=0.0)) <= STEP**3 * (1 + float(np.abs(m).max(initial=0.0))):
            raise InputError(f"{what} has a series that differs from its values on arrays")


def _expanded(what: str, exponential: Exponential, x: Values, m: Values) -> Jet:
    try:
        series = exponential(Jet.from_node(Node(2, 0 * x, [None, x, None])), m)
    except SeriesError as error:
        raise InputError(
            f"{what} cannot be expanded in a series: {error}; "
            "or give a subclass of liehom.action.Exponential with `series`"
        ) from error
    if not isinstance(series, Jet) or series.shape != m.shape:
        raise ShapeError(
            f"{what} returned {displayed(series)} for a series x with values of shape {x.shape} and m of shape "
            f"{m.shape}, expected a series with values of shape {m.shape}: write x[..., i] and m[..., i]"
        )
    return series


_BY_NAME: dict[str, Callable[[Representation], Exponential]] = {
    "exp": default_exponential, "series": SeriesExponential, "expm": MatrixExponential, "rodrigues": Rodrigues,
    "cayley": Cayley,
}  # fmt: skip


def exponential_of(representation: Representation, which: ExponentialLike = "exp") -> Exponential:
    """The exponential that a name, a class, a function or an `Exponential` denotes.

    Parameters
    ----------
    representation : Representation
    which : str, Exponential or callable
        One of the names "exp" (Rodrigues' formula where it applies, to the whole or to each block of coordinates, else
        the series), "series", "expm", "rodrigues" and "cayley"; an `Exponential`; a subclass of `Exponential` whose
        constructor takes a representation; or a function (x, m) -> Exp(x) m.

    Examples
    --------
    >>> import liehom as lh
    >>> exponential_of(lh.defining(lh.so(4)), "cayley")
    <exponential Cayley>
    """
    if isinstance(which, type) and issubclass(which, Exponential):
        which = which(representation)  # type: ignore[call-arg]
    if isinstance(which, Exponential):
        check_exponential(representation, which)
        return which
    if isinstance(which, str):
        if which in _BY_NAME:
            return _BY_NAME[which](representation)
    elif callable(which):
        return CustomExponential(representation, which, getattr(which, "__name__", "custom"))
    raise InputError(
        f"unknown exponential {displayed(which)}; known: {', '.join(map(repr, _BY_NAME))}, an Exponential, or a "
        "function (x, m) -> Exp(x) m"
    )
