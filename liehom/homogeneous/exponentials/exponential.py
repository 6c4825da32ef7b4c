"""Exponentials: analytic maps Exp from g to the group with Exp(x) = 1 + x + x^2/2 + ..., acting on V.

`Exponential` is the interface: the action on a vector and, for the expansion of steps, on Jets.  Here are the true
exponential by its series on the vector and by the matrix exponential; Rodrigues' formula is in `rodrigues.py`, the
Cayley transform in `cayley.py`, a user's own map in `custom_exponential.py`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from math import ceil, sqrt
from typing import Any, final

import numpy as np

from liehom.errors import FieldError, InputError
from liehom.homogeneous.exponentials.matrix_functions import expm1, norms, series_terms
from liehom.homogeneous.maps import FieldMap, action_map, bracket_map
from liehom.representations import Representation
from liehom.series import recurrences
from liehom.series.arrays import as_values, in_lanes, is_exact, is_jax
from liehom.series.jet import Jet
from liehom.series.lie_series import dexp_inverse, magnus, without_constant
from liehom.tracing.array import Traced
from liehom.tracing.exponentials import exponential_action

# up to this norm of rho(x) the series on the vector is cheaper than a matrix exponential of its precision
MAX_NORM = 8.0
MAX_NORM_EXTENDED = 64.0
# the Frobenius norm; where it is this, the terms of the series do not exceed the vector by much
SUBSTEP = 2.0


class Exponential(ABC):
    """An analytic map Exp: g -> G that agrees with exp through order 2, acting on V.

    Notes
    -----
    A new one needs a name and `act`. `series` has a default for functions `act` that run on Jets;
    `differential_inverse` and `logarithmic_series` may be given where they are known. Coefficient 0 of the Jet x is
    zero: x(t) = x_1 t + x_2 t^2 + .... Pass an instance wherever "exp" may stand; that it agrees with exp through
    order 2 is then checked.

    Examples
    --------
    A product of two exponentials that is symmetric, as splitting methods have it:

    >>> import numpy as np
    >>> import liehom as lh
    >>> rho = lh.defining(lh.so(3))
    >>> class Split(lh.Exponential):
    ...     name = "split"
    ...     exp = SeriesExponential(rho)
    ...     def act(self, x, m):
    ...         first, last = x * [0.5, 0, 0], x * [0, 1, 1]
    ...         return self.exp(first, self.exp(last, self.exp(first, m)))
    >>> lh.Action(rho, Split())
    <action by split of <representation 'defining' of <Lie algebra so(3) of dimension 3 over QQ> on QQ^3>>
    """

    @property
    @abstractmethod
    def name(self) -> str:
        """What reports call it."""

    @abstractmethod
    def act(self, x: Any, m: Any) -> Any:
        """Exp(x) m for arrays x (..., dim) and m (..., N)."""

    def series(self, x: Jet, m: Any) -> Jet:
        """Exp(x(t)) m(t) as a Jet, for x(0) = 0."""
        return self.act(x, m)  # type: ignore[no-any-return]

    def differential_inverse(self, x: Any, y: Any, terms: int) -> Any:
        """dExp^-1_x y, by `terms` terms where it is a series; needed by Runge-Kutta-Munthe-Kaas steps."""
        raise InputError(f"the inverse differential of {self.name} is not known, so RKMK steps cannot use it")

    def logarithmic_series(self, a: Jet) -> Jet | None:
        """x(t) with Exp(x(t))' = a(t) Exp(x(t)), x(0) = 0; None if it is not known."""
        return None

    def __call__(self, x: Any, m: Any) -> Any:
        """Exp(x) m for arrays or Jets."""
        if isinstance(x, Jet):
            return self.series(x, m if isinstance(m, Jet) else as_values(m))
        x = as_values(x)
        if isinstance(m, Jet):  # Exp(x) is one linear map of V
            return Jet.from_node(recurrences.linear(lambda v: self.act(x, v), [m.node]))
        with np.errstate(over="ignore", invalid="ignore"):  # too large an x gives inf or nan, for that trajectory
            return self.act(x, as_values(m))

    def __repr__(self) -> str:
        return f"<exponential {self.name}>"


class TrueExponential(Exponential, ABC):
    """What all versions of the true exponential share: the series, and dexp^-1 in the algebra.

    Another implementation of exp needs a name and `act` on arrays; everything else is here.

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

    def series(self, x: Jet, m: Any) -> Jet:
        """The sum of the nested products rho(x)^j m / j!."""
        x = without_constant(x, check=True)
        total = m if isinstance(m, Jet) else Jet.constant(m, x.order)
        term = total
        for j in range(1, x.order + 1):
            term = self.infinitesimal(x, term)
            if j > 1:
                term = term / j
            total = total + term
        return total

    def differential_inverse(self, x: Any, y: Any, terms: int) -> Any:
        return dexp_inverse(self.bracket, x, y, terms)

    def logarithmic_series(self, a: Jet) -> Jet:
        return magnus(self.bracket, a)


@final
class SeriesExponential(TrueExponential):
    """exp(rho(x)) m by its Taylor series on the vector, in substeps of norm at most 2.

    The increment is summed apart from m, so that round-off is relative to the increment. For large rho(x), and on
    JAX arrays, exp(rho(x)) - 1 is computed as a matrix, in extended precision where the platform has it. On exact
    numbers it is the finite sum where rho(x) is nilpotent.

    Parameters
    ----------
    representation : Representation

    Raises
    ------
    FieldError
        When it is evaluated on exact numbers where rho(x) is not nilpotent.

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

    def act(self, x: Any, m: Any) -> Any:
        if is_exact(x) or is_exact(m):
            return exact_exponential(self.infinitesimal, x, m)
        if self.infinitesimal.works_by_columns(x, m):  # of a large ensemble no matrices are made
            x = in_lanes(x)
            largest = float(self.infinitesimal.frobenius_norms(x).max(initial=0.0))
            if largest <= SUBSTEP:
                return m + _increment(x, m, largest, self.infinitesimal)
        matrix = self.infinitesimal.left(x)
        if type(matrix) is Traced or type(m) is Traced:
            return exponential_action(matrix, m)
        if is_jax(matrix) or is_jax(m):
            return m + _times(expm1(matrix), m)
        if matrix.ndim == 2 and m.ndim == 1:
            flat = matrix.ravel()
            size = sqrt(flat.dot(flat))
            if size <= SUBSTEP:  # one trajectory and a step of usual size: nothing but the series
                return m + _increment(matrix, m, size, np.dot)
            sizes: Any = np.asarray(size)
        else:
            sizes = norms(matrix)
        limit = MAX_NORM_EXTENDED if matrix.dtype == np.longdouble else MAX_NORM
        far = ~(sizes <= limit)
        if not bool(far.any()):
            return _in_substeps(matrix, m, float(sizes.max(initial=0.0)))
        moved = m + _times(expm1(matrix.astype(np.longdouble)), m)
        moved = moved.astype(np.result_type(matrix, m))
        if bool(far.all()):
            return moved
        near = np.where(far[..., None, None], 0, matrix)
        return np.where(far[..., None], moved, _in_substeps(near, m, float(np.where(far, 0, sizes).max())))


@final
class MatrixExponential(TrueExponential):
    """expm(rho(x)) m, with the matrix exponential of scipy (its own in extended precision and on JAX arrays).

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

    def act(self, x: Any, m: Any) -> Any:
        if is_exact(x) or is_exact(m):
            return exact_exponential(self.infinitesimal, x, m)
        matrix = self.infinitesimal.left(x)
        if type(matrix) is Traced or type(m) is Traced:
            return exponential_action(matrix, m)
        if is_jax(matrix) or is_jax(m) or matrix.dtype == np.longdouble:
            return m + _times(expm1(matrix), m)
        from scipy.linalg import expm

        bad = ~np.isfinite(matrix).all(axis=(-1, -2))
        if not bool(bad.any()):
            return _times(expm(matrix), m)
        made = _times(expm(np.where(bad[..., None, None], 0.0, matrix)), m)
        return np.where(bad[..., None], np.nan, made)


# -- private helpers -------------------------------------------------------------------------------------
def _times(matrix: Any, m: Any) -> Any:
    return (matrix @ m[..., None])[..., 0]


def _in_substeps(matrix: Any, m: Any, size: float) -> Any:
    substeps = max(1, ceil(size / SUBSTEP))
    matrix = matrix / substeps if substeps > 1 else matrix
    single = matrix.ndim == 2 and m.ndim == 1
    for _ in range(substeps):
        m = m + _increment(matrix, m, size / substeps, np.dot if single else _products)
    return m


def _products(matrix: Any, m: Any) -> Any:
    return np.einsum("...ij,...j->...i", matrix, m)


def _increment(matrix: Any, m: Any, size: float, times: Any) -> Any:
    """exp(A) m - m for |A| = size, at most SUBSTEP; times(A, m) is A m."""
    term = times(matrix, m)
    total = term
    for j in range(2, series_terms(size, float(np.finfo(term.dtype).eps)) + 1):
        term = times(matrix, term)
        term /= j
        total = total + term
    return total


def exact_exponential(action: FieldMap, x: Any, m: Any) -> Any:
    """exp(rho(x)) m on exact numbers: a finite sum where rho(x) is nilpotent on m.

    Raises
    ------
    FieldError
        If it is not.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> x = np.array([lh.QQ.convert(v) for v in ("1/2", 1, 0)])
    >>> exact_exponential(action_map(lh.coadjoint(lh.heisenberg(1))), x, x[[2, 2, 1]]).tolist()
    [1, -1/2, 1]
    """
    total, term = m, m
    for j in range(1, action.shape[1] + 1):
        term = action(x, term) / j
        if not bool(np.any(term != 0)):
            return total
        total = total + term
    raise FieldError(
        "exp(rho(x)) m is not in the field of these exact numbers, because rho(x) is not nilpotent: use floats, or "
        "a series x(t) with x(0) = 0, which is expanded exactly"
    )
