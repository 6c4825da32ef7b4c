"""Exponentials: analytic maps Exp from g to the group with Exp(x) = 1 + x + x^2/2 + ..., acting on V.

`Exponential` is the interface: the action on a vector and, for the expansion of steps, on Jets.  This module has the
true exponential by its Taylor series on the vector and by the matrix exponential.  Rodrigues' formula is in
`rodrigues`, the Cayley transform in `cayley`, user-defined maps in `custom_exponential`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from math import ceil, sqrt
from typing import Any, cast, final, overload

import numpy as np

from liehom.errors import FieldError, InputError
from liehom.homogeneous.exponentials.matrix_functions import expm1, norms, series_terms
from liehom.homogeneous.maps import FieldMap, action_map, bracket_map
from liehom.representations import Representation
from liehom.series import recurrences
from liehom.series.arrays import as_values, in_lanes, is_exact, is_jax
from liehom.series.jet import Jet
from liehom.series.lie_series import dexp, dexp_inverse, magnus, without_constant
from liehom.series.node import Node
from liehom.tracing.array import Traced
from liehom.tracing.exponentials import exponential_action
from liehom.typing import Array, BooleanArray, Values, ValuesLike

# up to this norm of rho(x) the series on the vector is cheaper than a matrix exponential of the same precision
MAX_NORM = 8.0
MAX_NORM_EXTENDED = 64.0
# largest Frobenius norm of rho(x) in a substep: larger terms of the series would cancel
SUBSTEP = 2.0
DIFFERENCE = 2.0**-26
"""Size of a difference that replaces a derivative, the root of the round-off of float64."""
DEXP_TERMS = 14
"""Terms of the series of dexp in `TrueExponential.tangent`."""
TRACED_DEXP_TERMS = 5
"""Terms in compiled code, where Newton's method makes another iteration rather than the code longer."""
MAX_DEXP = 2.0
"""Coordinates of x up to which that series is summed."""


class Exponential(ABC):
    """An analytic map Exp: g -> G that agrees with exp through order 2, acting on V.

    Notes
    -----
    A subclass defines `name` and `act`. The default `series` calls `act`, which must then run on Jets. Define
    `differential_inverse` and `logarithmic_series` where they are known. Coefficient 0 of the Jet x is zero:
    x(t) = x_1 t + x_2 t^2 + .... An instance can be passed wherever "exp" can; the agreement with exp through order 2
    is then checked.

    Examples
    --------
    A symmetric product of two exponentials, as in splitting methods:

    >>> import numpy as np
    >>> import liehom as lh
    >>> rho = lh.defining(lh.so(3))
    >>> class Split(lh.Exponential):
    ...     name = "split"
    ...     exp = SeriesExponential(rho)
    ...     def act(self, x, m):
    ...         first, last = x * [0.5, 0, 0], x * [0, 1, 1]
    ...         return self.exp(first, self.exp(last, self.exp(first, m)))
    ...
    >>> lh.Action(rho, Split())
    <action by split of <representation 'defining' of <Lie algebra so(3) of dimension 3 over QQ> on QQ^3>>
    """

    @property
    @abstractmethod
    def name(self) -> str:
        """Name in reports, a string."""

    @abstractmethod
    def act(self, x: Values, m: Values) -> Values:
        """Exp(x) m for arrays x (..., dim) and m (..., N)."""

    def series(self, x: Jet, m: Values) -> Jet:
        """The Jet Exp(x(t)) m(t), for x(0) = 0."""
        return cast(Jet, self.act(x, m))  # functions of a Jet return Jets

    def tangent(self, x: Values, v: Values, m: Values) -> Values:
        """The vector d/dt Exp(x + t v) m at t = 0, for arrays; Newton's method in implicit steps uses it.

        By default a difference quotient, which has half of the digits.

        Examples
        --------
        >>> import numpy as np
        >>> import liehom as lh
        >>> exp = lh.Action(lh.defining(lh.so(2))).exponential
        >>> exp.tangent(np.array([0.0]), np.array([1.0]), np.array([1.0, 0.0])).round(6).tolist()
        [0.0, 1.0]
        """
        ahead: Any = self.act(x + DIFFERENCE * v, m)
        quotient: Values = (ahead - self.act(x, m)) / DIFFERENCE
        return quotient

    def differential_inverse(self, x: Values, y: Values, terms: int) -> Values:
        """The value dExp^-1_x y, with `terms` terms of its series; Runge-Kutta-Munthe-Kaas steps need it.

        Raises
        ------
        InputError
            If it is not known (default).
        """
        raise InputError(f"the inverse differential of {self.name} is not known, so RKMK steps cannot use it")

    def logarithmic_series(self, a: Jet) -> Jet | None:
        """The Jet x(t) with Exp(x(t))' = a(t) Exp(x(t)), x(0) = 0, or None if it is not known (default)."""
        return None

    @overload
    def __call__(self, x: Jet, m: ValuesLike) -> Jet: ...
    @overload
    def __call__(self, x: ValuesLike, m: Jet) -> Jet: ...
    @overload
    def __call__(self, x: ValuesLike, m: ValuesLike) -> Values: ...
    def __call__(self, x: ValuesLike, m: ValuesLike) -> Values:
        """Exp(x) m for arrays or Jets."""
        if isinstance(x, Jet):
            if x.order == 1 and not isinstance(m, Jet) and x.node.known[0] is not None:
                return self._linearized(x, as_values(m))
            return self.series(x, m if isinstance(m, Jet) else as_values(m))
        values: Values = as_values(x)
        if isinstance(m, Jet):  # Exp(x) is one linear map of V
            return Jet.from_node(recurrences.linear(lambda v: self.act(values, v), [m.node]))
        with np.errstate(over="ignore", invalid="ignore"):  # too large an x gives inf or nan, for that trajectory
            return self.act(values, as_values(m))

    def _linearized(self, x: Jet, m: Values) -> Jet:
        """Exp(x(t)) m to order 1, where x(0) need not be 0."""
        value, slope = x.value, x.node.coefficient(1)
        if type(value) is np.ndarray and value.ndim > 1 and value.strides[0] == 0:
            value = value[0]  # many directions at one point
        made: Any = None if slope is None else self.tangent(value, slope, m)
        point: Any = self.act(value, m)
        if made is not None and made.shape != point.shape:
            point = np.broadcast_to(point, made.shape)
        return Jet.from_node(Node(1, point, [point, made]))

    def __repr__(self) -> str:
        return f"<exponential {self.name}>"


class TrueExponential(Exponential, ABC):
    """Base class of implementations of the true exponential: the expansion on Jets, and dexp^-1 in the algebra.

    A subclass defines `name` and `act` on arrays.

    Parameters
    ----------
    representation : Representation

    Attributes
    ----------
    infinitesimal, bracket : FieldMap
        (x, m) -> rho(x) m and (x, y) -> [x, y]; ``infinitesimal.left(x)`` is the matrix rho(x).

    Examples
    --------
    >>> import liehom as lh
    >>> exp = SeriesExponential(lh.defining(lh.so(3)))
    >>> exp(lh.Jet([[0.0, 0, 0], [0, 0, 1.0], [0, 0, 0]]), [1.0, 0.0, 0.0]).coefficients.tolist()
    [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
    """

    def __init__(self, representation: Representation) -> None:
        self.infinitesimal: FieldMap = action_map(representation)
        self.bracket: FieldMap = bracket_map(representation)

    def series(self, x: Jet, m: Values) -> Jet:
        """The Jet exp(rho(x(t))) m(t): the sum of the nested products rho(x)^j m / j!."""
        x = without_constant(x, check=True)
        total = m if isinstance(m, Jet) else Jet.constant(m, x.order)
        term = total
        for j in range(1, x.order + 1):
            term = self.infinitesimal(x, term)
            if j > 1:
                term = term / j
            total = total + term
        return total

    def tangent(self, x: Values, v: Values, m: Values) -> Values:
        """The vector d/dt exp(x + t v) m = rho(dexp_x v) exp(x) m, to 7 digits where the norm of ad x is at most 3; in
        compiled code to 3 digits where it is at most 1."""
        if is_exact(x) or is_exact(m):
            raise FieldError("the derivative of exp is computed in floats, got exact numbers")
        if type(x) is np.ndarray and not bool(np.abs(x).max(initial=0.0) <= MAX_DEXP):
            return super().tangent(x, v, m)
        terms = TRACED_DEXP_TERMS if type(x) is Traced else DEXP_TERMS
        return self.infinitesimal(dexp(self.bracket, x, v, terms), self.act(x, m))

    def differential_inverse(self, x: Values, y: Values, terms: int) -> Values:
        made: Values = dexp_inverse(self.bracket, x, y, terms)
        return made

    def logarithmic_series(self, a: Jet) -> Jet:
        return magnus(self.bracket, a)


@final
class SeriesExponential(TrueExponential):
    """exp(rho(x)) m by its Taylor series on the vector, in substeps of norm at most 2.

    The increment is summed separately from m, so that round-off is relative to the increment. For large rho(x), and on
    JAX arrays, exp(rho(x)) - 1 is computed as a matrix, in extended precision where the platform has it. On exact
    numbers exp is the finite sum if rho(x) is nilpotent.

    Parameters
    ----------
    representation : Representation

    Raises
    ------
    FieldError
        On evaluation at exact numbers where rho(x) is not nilpotent.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> exp = SeriesExponential(lh.defining(lh.so(2)))
    >>> np.round(exp.act(np.array([np.pi / 2]), np.array([1.0, 0.0])), 12)
    array([0., 1.])
    """

    @property
    def name(self) -> str:
        return "exp (series)"

    def act(self, x: Values, m: Values) -> Values:
        if is_exact(x) or is_exact(m):
            return exact_exponential(self.infinitesimal, x, m)
        if self.infinitesimal.works_by_columns(x, m):  # a large ensemble: without the matrices rho(x)
            x = in_lanes(x)
            largest = float(self.infinitesimal.frobenius_norms(x).max(initial=0.0))
            if largest <= SUBSTEP:
                return m + _increment(x, m, largest, self.infinitesimal)
        matrix: Any = self.infinitesimal.left(x)
        if type(matrix) is Traced or type(m) is Traced:
            return exponential_action(matrix, m)
        if is_jax(matrix) or is_jax(m):
            return m + _times(expm1(matrix), m)
        if matrix.ndim == 2 and m.ndim == 1:
            flat = matrix.ravel()
            size = sqrt(flat.dot(flat))
            if size <= SUBSTEP:  # the usual case: one trajectory, one substep
                return m + _increment(matrix, m, size, np.dot)
            sizes: Any = np.asarray(size)
        else:
            sizes = norms(matrix)
        limit = MAX_NORM_EXTENDED if matrix.dtype == np.longdouble else MAX_NORM
        far = ~(sizes <= limit)
        if not bool(far.any()):
            return _in_substeps(matrix, m, float(sizes.max(initial=0.0)))
        wide = m + _times(expm1(matrix.astype(np.longdouble)), m)
        moved: Values = wide.astype(np.result_type(matrix, m))
        if bool(far.all()):
            return moved
        near = np.where(far[..., None, None], 0, matrix)
        mixed: Values = np.where(far[..., None], moved, _in_substeps(near, m, float(np.where(far, 0, sizes).max())))
        return mixed


@final
class MatrixExponential(TrueExponential):
    """expm(rho(x)) m, with the matrix exponential of scipy (`expm1` in extended precision and on JAX arrays).

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> exp = MatrixExponential(lh.defining(lh.so(2)))
    >>> np.round(exp.act(np.array([np.pi / 2]), np.array([1.0, 0.0])), 12)
    array([0., 1.])
    """

    @property
    def name(self) -> str:
        return "exp (expm)"

    def act(self, x: Values, m: Values) -> Values:
        if is_exact(x) or is_exact(m):
            return exact_exponential(self.infinitesimal, x, m)
        matrix: Any = self.infinitesimal.left(x)
        if type(matrix) is Traced or type(m) is Traced:
            return exponential_action(matrix, m)
        if is_jax(matrix) or is_jax(m) or matrix.dtype == np.longdouble:
            return m + _times(expm1(matrix), m)
        from scipy.linalg import expm

        bad: BooleanArray = ~np.isfinite(matrix).all(axis=(-1, -2))
        if not bool(bad.any()):
            return _times(expm(matrix), m)
        made = _times(expm(np.where(bad[..., None, None], 0.0, matrix)), m)
        marked: Array = np.where(bad[..., None], np.nan, made)
        return marked


# -- private helpers -------------------------------------------------------------------------------------
def _times(matrix: Values, m: Values) -> Values:
    made: Values = (matrix @ m[..., None])[..., 0]
    return made


def _in_substeps(matrix: Values, m: Values, size: float) -> Values:
    substeps = max(1, ceil(size / SUBSTEP))
    matrix = matrix / substeps if substeps > 1 else matrix
    single = matrix.ndim == 2 and m.ndim == 1
    for _ in range(substeps):
        m = m + _increment(matrix, m, size / substeps, np.dot if single else _products)
    return m


def _products(matrix: Values, m: Values) -> Values:
    made: Values = np.einsum("...ij,...j->...i", matrix, m)
    return made


def _increment(matrix: Values, m: Values, size: float, times: Callable[[Any, Any], Any]) -> Values:
    """The vector exp(A) m - m for |A| = size, at most SUBSTEP; times(A, m) is A m."""
    term = times(matrix, m)
    total: Values = term
    for j in range(2, series_terms(size, float(np.finfo(term.dtype).eps)) + 1):
        term = times(matrix, term)
        term /= j
        total = total + term
    return total


def exact_exponential(action: FieldMap, x: Values, m: Values) -> Values:
    """The vector exp(rho(x)) m for exact numbers: a finite sum if rho(x) is nilpotent on m.

    Raises
    ------
    FieldError
        If rho(x) is not nilpotent on m.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> x = np.array([lh.QQ.convert(v) for v in ("1/2", 1, 0)])
    >>> exact_exponential(action_map(lh.coadjoint(lh.heisenberg(1))), x, x[[2, 2, 1]]).tolist()
    [1, -1/2, 1]
    """
    total: Values = m
    term: Any = m
    for j in range(1, action.shape[1] + 1):
        term = action(x, term) / j
        if not bool(np.any(term != 0)):
            return total
        total = total + term
    raise FieldError(
        "exp(rho(x)) m is not in the field of these exact numbers, because rho(x) is not nilpotent: use floats, or "
        "a series x(t) with x(0) = 0, which is expanded exactly"
    )
