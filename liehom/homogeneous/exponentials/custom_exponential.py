"""Custom exponentials, given as functions, and the exponential that a name denotes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias, final

import numpy as np

from liehom.errors import InputError, SeriesError, ShapeError, displayed
from liehom.homogeneous.exponentials.block_exponential import default_exponential
from liehom.homogeneous.exponentials.cayley import Cayley
from liehom.homogeneous.exponentials.exponential import Exponential, MatrixExponential, SeriesExponential
from liehom.homogeneous.exponentials.rodrigues import Rodrigues
from liehom.homogeneous.maps import action_map
from liehom.representations import Representation
from liehom.series.jet import Jet
from liehom.series.node import Node
from liehom.typing import Values

ExponentialFunction: TypeAlias = Callable[[Any, Any], Any]
"""A function (x, m) -> Exp(x) m of two `Values`."""

ExponentialLike: TypeAlias = "str | Exponential | type[Exponential] | ExponentialFunction"
"""What `exponential_of` reads as an exponential."""

RTOL = 1e-8
STEP = 1e-3


@final
class CustomExponential(Exponential):
    """An exponential given by a function (x, m) -> Exp(x) m that runs on arrays and Jets.

    Parameters
    ----------
    representation : Representation
    function : callable
        (x, m) -> Exp(x) m, x of shape (..., dim), m of shape (..., N), written with numpy functions.
    name : str

    Raises
    ------
    ShapeError
        If the function does not return shape (..., N) for all leading axes.
    InputError
        If Exp(t x) m does not begin with m + t rho(x) m + t^2/2 rho(x)^2 m, as the correctors need, or if the function
        does not run on Jets.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> rho = lh.defining(lh.so(2))
    >>> def tangent(x, m):  # rotation by 2 arctan(x/2)
    ...     turned = x * m[..., ::-1] * [-1, 1]
    ...     return m + (turned - x * x * m / 2) / (1 + x * x / 4)
    ...
    >>> CustomExponential(rho, tangent, "my Cayley").name
    'my Cayley'
    """

    def __init__(self, representation: Representation, function: ExponentialFunction, name: str = "custom") -> None:
        if not callable(function):
            raise InputError(f"an exponential is a function (x, m) -> Exp(x) m, got {displayed(function)}")
        self._function = function
        self._name = name
        check_exponential(representation, self)

    @property
    def name(self) -> str:
        return self._name

    def act(self, x: Values, m: Values) -> Values:
        made: Values = self._function(x, m)
        return made


def check_exponential(representation: Representation, exponential: Exponential) -> None:
    """Check that an exponential belongs to a representation and agrees with exp through order 2.

    Raises
    ------
    ShapeError, InputError
        See `CustomExponential`.

    Examples
    --------
    >>> import liehom as lh
    >>> check_exponential(lh.defining(lh.so(3)), SeriesExponential(lh.defining(lh.so(3))))
    >>> check_exponential(lh.defining(lh.so(3)), SeriesExponential(lh.defining(lh.so(2, 1))))
    Traceback (most recent call last):
    ...
    liehom.errors.InputError: the exponential 'exp (series)' differs from exp at t^1 by ...
    """
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
        made = np.asarray(exponential(STEP * steps, points))
        if made.shape != points.shape:
            raise ShapeError(
                f"{what} returned shape {made.shape} for x of shape {steps.shape} and m of shape {points.shape}, "
                f"expected {points.shape}: write x[..., i] and m[..., i]"
            )
        begin = series(STEP) if points is m else series(STEP)[0]
        if not float(np.abs(made - begin).max(initial=0.0)) <= STEP**3 * (1 + float(np.abs(m).max(initial=0.0))):
            raise InputError(f"{what} has a series that differs from its values on arrays")


def _expanded(what: str, exponential: Exponential, x: Values, m: Values) -> Jet:
    try:
        series = exponential(Jet.from_node(Node(2, 0 * x, [None, x, None])), m)
    except SeriesError as error:
        raise InputError(
            f"{what} cannot be expanded in a series: {error}; or give a subclass of liehom.Exponential with `series`"
        ) from error
    if not isinstance(series, Jet) or series.shape != m.shape:
        raise ShapeError(
            f"{what} returned {displayed(series)} for a series x with values of shape {x.shape} "
            f"and m of shape {m.shape}, "
            f"expected a series with values of shape {m.shape}: write x[..., i] and m[..., i]"
        )
    return series


_BY_NAME: dict[str, Callable[[Representation], Exponential]] = {
    "series": SeriesExponential,
    "expm": MatrixExponential,
    "rodrigues": Rodrigues,
    "cayley": Cayley,
}


def exponential_of(representation: Representation, which: ExponentialLike = "exp") -> Exponential:
    """The exponential that a name, a class, a function or an `Exponential` denotes.

    Parameters
    ----------
    representation : Representation
    which : str, Exponential or callable
        One of the names "exp" (Rodrigues' formula where it applies, to the whole or to each block of coordinates, else
        the series), "series", "expm", "rodrigues" and "cayley"; an `Exponential`; a subclass of `Exponential` whose
        constructor takes a representation; or a function (x, m) -> Exp(x) m.

    Raises
    ------
    ShapeError, InputError
        If the name is unknown, if the representation does not allow it, or if the object is not an exponential of
        this representation that begins with 1 + x + x^2/2.

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
        if which == "exp":
            return default_exponential(representation)
        if which in _BY_NAME:
            return _BY_NAME[which](representation)
    elif callable(which):
        return CustomExponential(representation, which, getattr(which, "__name__", "custom"))
    raise InputError(
        f"unknown exponential {displayed(which)}; known: 'exp', "
        f"{', '.join(map(repr, _BY_NAME))}, an Exponential, or a function "
        "(x, m) -> Exp(x) m"
    )
