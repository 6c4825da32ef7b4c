"""FirstIntegral: a map F: M -> W that the flow conserves (Definition 8), with its derivative by Jets.

    F(F_t(m)) = F(m),    so that DF(m) X(m, t) = 0

F is a function written with numpy functions over leading axes, or it is given by strings, sympy expressions or numbers
in the symbols m0, m1, ....
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias, final

import numpy as np

from liehom.correctors.expansion import ROUND_OFF_UNITS, Flow
from liehom.errors import InputError, ShapeError
from liehom.homogeneous.fields.components import Components, joined
from liehom.homogeneous.fields.expression import TREES
from liehom.homogeneous.fields.signature import takes_time
from liehom.series.arrays import as_values, is_exact, zeros
from liehom.series.jet import Jet
from liehom.typing import ScalarLike, Values

IntegralSource: TypeAlias = Callable[[Any], Any] | ScalarLike | Sequence[Callable[[Any], Any] | ScalarLike]
"""A function F(m), a string or sympy expression in m0, m1, ..., or a sequence of these or of numbers."""

RTOL = 1e-8
"""Relative size up to which a Taylor coefficient of F along the flow counts as 0."""


@final
class FirstIntegral:
    """F: M -> W on points, exact points and Jets, always with an axis for the components of W.

    Parameters
    ----------
    source : callable, str, sympy expression, or sequence of these or numbers
        A function F(m) of m of shape (..., N) returns (...,) for a number, or (..., k) for W of dimension k.
    size : int
        N.

    Attributes
    ----------
    scalar : bool or None
        Whether F is one number, not a list of k. None for a function that has not been called.

    Raises
    ------
    InputError
        If the source has none of these forms, or depends on time.
    ShapeError
        On evaluation, if a function returns another shape.

    Notes
    -----
    Definition 8 of the paper, for integrals that do not depend on time.

    Examples
    --------
    >>> import numpy as np
    >>> energy = FirstIntegral(lambda m: np.sum(m * m * [1.0, 2.0, 3.0], axis=-1) / 2, 3)
    >>> energy(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 2.0]])).tolist()
    [[0.5], [6.0]]
    >>> FirstIntegral(["m0*m1", "m2**2"], 3).gradient(np.array([1.0, 2.0, 3.0]))[1].tolist()
    [[2.0, 1.0, 0.0], [0.0, 0.0, 6.0]]
    """

    __slots__ = ("_components", "_source", "scalar", "size")

    def __init__(self, source: IntegralSource, size: int) -> None:
        self.size: int = size
        self._components: Components | None = None
        self._source: Any = source
        self.scalar: bool | None = None
        single = isinstance(source, (str, *TREES)) or hasattr(source, "free_symbols")
        if not single and callable(source):
            if takes_time(source):
                raise InputError("F takes (m, t): a first integral is a function of m alone")
            return
        parts = [source] if single else list(source) if np.iterable(source) else None
        if not parts:
            raise InputError(f"F is {source!r}: expected a function of m, or strings or expressions in m0, m1, ...")
        self.scalar = single
        self._source = parts
        self._components = Components(parts, size, (len(parts),), "F")
        if self._components.time_dependent:
            raise InputError(f"F = {parts} depends on t: a first integral is a function of m alone")

    def __call__(self, m: Values) -> Values:
        """The value F(m) for m (..., N), array or Jet of shape (..., k)."""
        if self._components is not None:
            found: Values = self._components(m)
            return found
        made = self._source(m)
        if not isinstance(made, np.ndarray | Jet):
            made = joined(made, m)
        lead, shape = m.shape[:-1], made.shape
        if shape == lead:
            scalar = True
            # numpy makes a bare number of a 0-dimensional array of exact numbers; np.stack makes an array again
            made = made[..., None] if lead or made.dtype != object else np.stack([made], axis=-1)
        elif len(shape) == len(lead) + 1 and shape[:-1] == lead and shape[-1]:
            scalar = False
        else:
            raise ShapeError(
                f"F has shape {shape} at m of shape {m.shape}, expected {lead} or {(*lead, 'k')}: coordinates are on "
                "the last axis of m (write m[..., 0], and np.stack(..., axis=-1))"
            )
        self.scalar = scalar
        return made if isinstance(made, Jet) or made.dtype.kind == "f" else _real(made, m)

    def gradient(self, m: Values) -> tuple[Values, Values]:
        """(F(m) of shape (..., k), DF(m) of shape (..., k, N)), by series of order 1 in the N directions."""
        m = as_values(m)
        lead, n = m.shape[:-1], m.shape[-1]
        unit = np.eye(n, dtype=m.dtype) if not is_exact(m) else zeros(m, (n, n)) + np.eye(n, dtype=int)
        points = np.broadcast_to(m, (n, *lead, n))
        unit = np.broadcast_to(unit.reshape(n, *[1] * len(lead), n), points.shape)
        made = self(Jet.variable(points, 1, unit))
        if not isinstance(made, Jet):
            return made[0], zeros(m, (*lead, made.shape[-1], n))
        return made.value[0], np.moveaxis(made.coefficient(1), 0, -1)

    def squeezed(self, value: Values) -> Values:
        """Values (..., k) in the shape of the user's F: (...,) if F is a number."""
        return value[..., 0][()] if self.scalar else value

    def check(self, flow: Flow, order: int, scale: Values | None = None) -> None:
        """Check that the Taylor coefficients 1, ..., order of F along the flow vanish.

        Parameters
        ----------
        flow : Flow
            Its expansion at a point or several, at least to this order.
        order : int
        scale : array of shape (..., k), optional
            The size of F to which derivatives are compared; |F| + |DF| |m| if it is not given.

        Raises
        ------
        InputError
            If one does not vanish; the message shows the derivative.

        Examples
        --------
        >>> import numpy as np
        >>> import liehom as lh
        >>> field, m = lh.GeneratorField(lh.defining(lh.so(2)), [1]), np.array([1.0, 0.0])
        >>> FirstIntegral("m0**2 + m1**2", 2).check(lh.flow_series(field, m, 3), 3)
        >>> FirstIntegral("m1", 2).check(lh.flow_series(field, m, 3), 3)
        Traceback (most recent call last):
        ...
        liehom.errors.InputError: F is not a first integral: DF(m) X(m) = [1.] at m = [1. 0.], expected 0
        """
        made = self(flow.points)
        if not isinstance(made, Jet):
            return
        m = flow.point(0)
        exact = is_exact(m)
        if not exact:
            unit = _largest(*self.gradient(m), m) if scale is None else scale
            sizes = [np.linalg.norm(np.asarray(flow.point(k), dtype=float), axis=-1) for k in range(order + 1)]
        rate: Any = 0.0
        turned: Any = 0.0
        for k in range(1, order + 1):
            wrong = np.asarray(made.coefficient(k))
            if exact:
                bad = np.array([x != 0 for x in wrong.flat], dtype=bool).reshape(wrong.shape)
            else:
                rate = np.maximum(rate, (sizes[k] / np.where(sizes[0] > 0, sizes[0], 1.0)) ** (1 / k))
                turned = np.maximum(turned, _rate(flow, k - 1) ** (1 / k))
                noise = ROUND_OFF_UNITS * float(np.finfo(m.dtype).eps) * turned**k  # all that X is at an equilibrium
                bad = ~(np.abs(wrong) <= unit * (RTOL * rate**k + noise)[..., None])
            if bad.any():
                index = tuple(int(i) for i in np.argwhere(bad)[0])[:-1]
                what = "DF(m) X(m)" if k == 1 else f"the coefficient of t^{k} of F along the flow"
                raise InputError(f"F is not a first integral: {what} = {wrong[index]} at m = {m[index]}, expected 0")

    def __repr__(self) -> str:
        if self._components is None:
            return str(getattr(self._source, "__qualname__", type(self._source).__name__))
        return str(self._source[0]) if self.scalar else str([str(x) for x in self._source])


def _rate(flow: Flow, k: int) -> Values:
    """The norm of rho(psi_k), shape (...,)."""
    columns = flow.field.infinitesimal(flow.psi(k)[..., None, :], np.eye(flow.points.shape[-1]))
    found: Values = np.linalg.norm(np.asarray(columns, dtype=float), axis=(-2, -1))
    return found


def conditioning(value: Values, gradient: Values, m: Values) -> Values:
    """The scale |F| + sum_i |dF/dm_i| |m_i|, shape (..., k); the round-off of F is eps times this.

    Examples
    --------
    >>> import numpy as np
    >>> m = np.array([3.0, 4.0])
    >>> conditioning(*FirstIntegral("m0**2 - m1**2", 2).gradient(m), m).tolist()
    [57.0]
    """
    found: Values = np.abs(value) + (np.abs(gradient) @ np.abs(m)[..., None])[..., 0]
    return found


def _largest(value: Values, gradient: Values, m: Values) -> Values:
    """|F| + |DF| |m|, shape (..., k): at least `conditioning`, and not 0 where m and DF have disjoint coordinates."""
    lengths = np.linalg.norm(gradient, axis=-1) * np.linalg.norm(m, axis=-1)[..., None]
    found: Values = np.abs(value) + lengths
    return found


def _real(made: Values, m: Values) -> Values:
    """Values of F as floats, or as exact numbers at exact points."""
    if made.dtype.kind in "iu":
        found: Values = made.astype(float) if not is_exact(m) else made.astype(object) + zeros(m, ())
        return found
    if made.dtype.kind == "O" and is_exact(m):
        found = as_values(made)
        return found
    raise InputError(f"F returned values of the type {made.dtype}, expected real numbers")
