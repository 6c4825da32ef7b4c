"""VariationalMidpoint: the Lie-Poisson step of the discrete Hamilton-Pontryagin principle, for any Lie algebra.

    p = int_0^1 exp(s x) m ds,    x = h psi(p),    m -> exp(x) m

On the dual of a Lie algebra, with rho = ad* and psi = dH, p satisfies m = (dexp^-1)^* p: these are the discrete
Euler-Poincare equations of the group difference exp(x) (N. Bou-Rabee and J. E. Marsden, Hamilton-Pontryagin integrators
on Lie groups, Found. Comput. Math. 9, 2009), without a Lagrangian.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from liehom.correctors.implicit import reach_of, solve_implicitly
from liehom.correctors.step import Generator, OneExponential
from liehom.errors import ConvergenceError, InputError
from liehom.homogeneous import Action, TrueExponential
from liehom.series.arrays import is_jax, zeros
from liehom.series.jet import Jet
from liehom.tracing import Traced
from liehom.typing import Values

SERIES_TERMS = 24
"""Terms of the series of the mean."""
MAX_NORM = 4.0
"""Largest Frobenius norm of rho(x): the rest of the series is then below round-off, in so(3) up to 2.8 radian."""


@final
@dataclass(frozen=True)
class VariationalMidpoint(OneExponential):
    """The Lie-Poisson midpoint step of a Hamiltonian field on the dual of any Lie algebra: order 2, symmetric.

    Notes
    -----
    It is a Poisson map if the field is a `liehom.hamiltonian_field`, and then coadjoint orbits and Casimir functions
    are conserved to round-off, as exp(x) acts on the point. Each step solves one implicit equation for x in g.

    psi is evaluated at the mean p of the arc from m to exp(x) m, which is not on the orbit of m. On other
    representations the step has order 2 and stays on the orbits.

    Raises
    ------
    InputError
        In a step, if the exponential is not the exponential map.
    ConvergenceError
        In a step, if the step size is too large: the equation is not solved, or |rho(x)| is above 4.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> H = "m0**2/2 + m1**2/4 + m2**2/6"
    >>> field = lh.hamiltonian_field(lh.so(3), H, sign=-1)
    >>> sol = lh.integrate(field, (0, 50), [0.6, 0.48, 0.64], step=lh.VariationalMidpoint(), dt=0.1)
    >>> energy = np.array([1/2, 1/4, 1/6]) @ sol.y**2
    >>> bool(np.ptp(energy) < 1e-4), bool(np.abs(np.sum(sol.y**2, axis=0) - 1).max() < 1e-14)
    (True, True)
    """

    @property
    def order(self) -> int:
        return 2

    @property
    def symmetric(self) -> bool:
        """Whether a step of size -h is the inverse of a step of size h: True."""
        return True

    def generator(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Values:
        require_exponential(action, "VariationalMidpoint")
        start = zeros_of(m, (*np.shape(m)[:-1], action.dimension))
        terms = h.order if isinstance(h, Jet) else SERIES_TERMS
        x = solve_implicitly(
            lambda x: h * psi(mean_of_arc(action, x, m, terms), t + h / 2), start, h, reach=reach_of(action)
        )
        _check_size(action, x)
        return x


def _check_size(action: Action, x: Values) -> None:
    """Require that the series of the mean has converged; compiled code leaves other steps to numpy."""
    if isinstance(x, Jet) or is_jax(x):
        return
    matrix = action.infinitesimal.left(x)
    small = np.sum(matrix * matrix, axis=(-2, -1)) <= MAX_NORM**2
    if type(small) is Traced:
        small.tape.required.append(small.entry)
    elif not np.all(small):
        raise ConvergenceError(
            f"VariationalMidpoint moves a point by exp(x) with |rho(x)| up to {MAX_NORM:g}: take a smaller step size"
        )


def mean_of_arc(action: Action, x: Values, m: Values, terms: int = SERIES_TERMS) -> Values:
    """The mean of exp(s x) m over 0 <= s <= 1, the sum of rho(x)^k m / (k + 1)! up to k = terms, shape (..., N).

    Examples
    --------
    Of a quarter of a circle:

    >>> import numpy as np
    >>> import liehom as lh
    >>> action = lh.Action(lh.defining(lh.so(2)))
    >>> (mean_of_arc(action, np.array([np.pi / 2]), np.array([1.0, 0.0])) * np.pi / 2).round(12).tolist()
    [1.0, 1.0]
    """
    total = m
    for k in range(terms, 0, -1):  # Horner's rule
        total = m + action.infinitesimal(x, total) * (1 / (k + 1))
    return total


def zeros_of(m: Values, shape: tuple[int, ...]) -> Values:
    """Zeros of a shape, of the kind of numbers in m: where an iteration starts.

    Examples
    --------
    >>> import liehom as lh
    >>> zeros_of(lh.Jet([[1.0, 2.0], [3.0, 4.0]]), (3,)).tolist()
    [0.0, 0.0, 0.0]
    """
    return zeros(m.value if isinstance(m, Jet) else m, shape)


def require_exponential(action: Action, name: str) -> None:
    """Raise InputError if Exp of an action is not the exponential map.

    Examples
    --------
    >>> import liehom as lh
    >>> require_exponential(lh.Action(lh.defining(lh.so(3)), "cayley"), "Splitting")
    Traceback (most recent call last):
    ...
    liehom.errors.InputError: Splitting needs the exponential map, got 'Cayley': leave out exponential=
    """
    if not isinstance(action.exponential, TrueExponential):
        raise InputError(f"{name} needs the exponential map, got {action.exponential.name!r}: leave out exponential=")
