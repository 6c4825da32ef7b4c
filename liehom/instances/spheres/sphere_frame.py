"""SphereFrame: the frame {n, omega/v, n x omega/v} of section 3 on S^2, with the order conditions in its coordinates.

    n = m/|m|,  v = |omega|,  omega^(j) = a_j n + b_j omega/v + c_j n x omega/v,  likewise alpha_j, beta_j, gamma_j for
    the coefficients xi_j of a step xi = sum xi_j t^j / j!

The orders determine beta_j and gamma_j; alpha_j, the isotropy, is free. gamma decides whether the orbit is captured,
beta whether the point is reached at the right time.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import factorial
from typing import Any, TypeAlias, final

import numpy as np
import numpy.typing as npt

from liehom.correctors.expansion import flow_series
from liehom.correctors.step import ExponentialLike, Generator, OneExponential, step_variable
from liehom.errors import InputError, ShapeError
from liehom.homogeneous import Action, GeneratorField
from liehom.instances.spheres.sphere import Sphere
from liehom.integrators.points import points_of
from liehom.typing import Array, Values

ORDER = 4

Coordinates: TypeAlias = tuple[Array, ...]
"""One coordinate of four vectors, arrays of shape (...,)."""


@final
class SphereFrame:
    """The frame at points of S^2, and the order conditions in its coordinates.

    Parameters
    ----------
    field : GeneratorField
        On `Sphere(3).representation`, autonomous; its isotropy does not matter.
    m : array_like of shape (..., 3)
        Points other than equilibria.

    Attributes
    ----------
    vectors : array of shape (..., 3, 3)
        The frame, in rows.
    v : array of shape (...,)
        |omega|.
    a, b, c : tuples of four arrays of shape (...,)
        Coordinates of the orthogonal generator and its derivatives along the flow.

    Raises
    ------
    InputError, ShapeError
        If the field depends on time, or m is an equilibrium or not a point of R^3.

    Notes
    -----
    Section 3 of the paper, (3.2)-(3.6), with corrected signs and terms; order 4 is not in the paper.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(Sphere(3).representation, lambda m: m * [1.0, 2.0, 3.0])
    >>> frame = SphereFrame(field, [0.6, 0.48, 0.64])
    >>> sigma = lh.correction(field, lh.Euler(), np.array([0.6, 0.48, 0.64]), 2).zeta[1]
    >>> alpha, _, gamma = frame.coordinates(lh.Euler(), field)
    >>> bool(np.allclose(frame.capturing(2, alpha, gamma), alpha[0] + sigma @ frame.vectors[0]))  # (3.5)
    True
    """

    v: Array
    vectors: Values
    a: Coordinates
    b: Coordinates
    c: Coordinates

    def __init__(self, field: GeneratorField, m: npt.ArrayLike) -> None:
        point = points_of(m)
        if point.shape[-1:] != (3,) or field.representation.size != 3:
            raise ShapeError(f"the frame is one on S^2, got points of shape {point.shape} and {field!r}")
        if field.time_dependent:
            raise InputError("the field depends on time; the order conditions of section 3 are for autonomous fields")
        self.point = point
        flow = flow_series(Sphere(3).orthogonal(field), point, ORDER)
        omega = [flow.psi(j) * factorial(j) for j in range(ORDER)]
        self.v = np.linalg.norm(omega[0], axis=-1)
        if bool(np.any(self.v == 0)):
            raise InputError("there is no frame at an equilibrium: leave such points out")
        n = point / np.linalg.norm(point, axis=-1, keepdims=True)
        along = omega[0] / self.v[..., None]
        self.vectors = np.stack([n, along, np.cross(n, along)], axis=-2)
        self.a, self.b, self.c = self._read(omega)

    def _read(self, vectors: Sequence[Any]) -> tuple[Coordinates, Coordinates, Coordinates]:
        """Coordinates of vectors in the frame: those along n, along omega, and along n x omega."""
        made = [(self.vectors @ x[..., None])[..., 0] for x in vectors]
        along_n, along, across = (tuple(x[..., i] for x in made) for i in range(3))
        return along_n, along, across

    def coordinates(
        self, step: OneExponential, field: GeneratorField, exponential: ExponentialLike = "exp"
    ) -> tuple[Coordinates, Coordinates, Coordinates]:
        """alpha_j, beta_j, gamma_j, j = 1, ..., 4, of a step with one exponential.

        Parameters
        ----------
        step : OneExponential
        field : GeneratorField
            The field with the generator that the step uses.
        exponential : "exp", "cayley", ...

        Returns
        -------
        alpha, beta, gamma : tuples of four arrays of shape (...,)

        Examples
        --------
        >>> import liehom as lh
        >>> field = lh.GeneratorField(Sphere(3).representation, lambda m: m * [1.0, 2.0, 3.0])
        >>> frame = SphereFrame(field, [0.6, 0.48, 0.64])
        >>> _, beta, gamma = frame.coordinates(lh.Heun(), field)
        >>> bool(abs(beta[0] - frame.v) < 1e-15), bool(abs(gamma[0]) < 1e-15)  # order 1
        (True, True)
        """
        action = Action(field.representation, exponential)
        local = step.at(action, Generator(field, 2), self.point, np.zeros((*self.point.shape[:-1], 1)))
        xi: Any
        (xi,) = local.factors(step_variable(ORDER, self.point))
        return self._read([xi.coefficient(j) * factorial(j) for j in range(1, ORDER + 1)])

    def conditions(self, alpha: Sequence[Values], exponential: str = "exp") -> tuple[Coordinates, Coordinates]:
        """beta_1, ..., beta_4 and gamma_1, ..., gamma_4 for the orders 1 to 4, given alpha_1, alpha_2, alpha_3.

        Raises
        ------
        InputError
            If the exponential is neither "exp" nor "cayley".

        Examples
        --------
        >>> import liehom as lh
        >>> field = lh.GeneratorField(Sphere(3).representation, lambda m: m * [1.0, 2.0, 3.0])
        >>> frame = SphereFrame(field, [0.6, 0.48, 0.64])
        >>> alpha, beta, gamma = frame.coordinates(lh.LieTaylor(3), field)
        >>> wanted = frame.conditions(alpha)
        >>> bool(abs(wanted[0][2] - beta[2]) < 1e-13), bool(abs(wanted[1][2] - gamma[2]) < 1e-13)
        (True, True)
        """
        cayley = _is_cayley(exponential)
        v, (_, b1, b2, b3), (_, c1, c2, c3) = self.v, self.b, self.c
        free: Any = alpha
        a1, a2, a3 = free[:3]
        tail = -a1 * v**3 - 2 * a1 * b2 - 3 * a2 * b1 - 2 * a3 * v
        if cayley:
            third = b2 + v**3 / 2 + 1.5 * c1 * a1
            fourth = b3 + 3 * v**2 * b1 + 2 * a1 * c2 + 3 * a2 * c1
            last = c3 + 3 * v**2 * c1 + tail
        else:
            third = b2 - a1**2 * v / 2 + 1.5 * c1 * a1
            fourth = b3 - a1**2 * b1 - 2 * a1 * a2 * v + 2 * a1 * c2 + 3 * a2 * c1
            last = c3 + 2 * v**2 * c1 - a1**2 * c1 + tail
        return (v, b1, third, fourth), (0 * v, c1 - a1 * v, c2 - 1.5 * (a2 * v + a1 * b1), last)

    def capturing(
        self, order: int, alpha: Sequence[Values], gamma: Sequence[Values], exponential: str = "exp"
    ) -> Array:
        """alpha_(n-1), shape (...,), with which a step of order n - 1 captures orbits to order n: (3.5), (3.6).

        Parameters
        ----------
        order : int
            n, one of 2, 3 and 4.
        alpha, gamma : sequences
            The coordinates of the step; alpha up to n - 2 and gamma up to n are used.

        Notes
        -----
        The equation for gamma_n is solved for alpha_(n-1). The equation for beta_n is satisfied by the time
        reparametrization τ = t + theta t^n/n!.

        Raises
        ------
        InputError
            If the order is another one.

        Examples
        --------
        >>> import liehom as lh
        >>> field = lh.GeneratorField(Sphere(3).representation, lambda m: m * [1.0, 2.0, 3.0])
        >>> m = [0.6, 0.48, 0.64]
        >>> frame = SphereFrame(field, m)
        >>> alpha, _, gamma = frame.coordinates(lh.Heun(), field)
        >>> found = lh.correction(field, lh.Heun(), m, 3).zeta[2] @ m  # of t^2, alpha_2 is that of t^2/2
        >>> bool(abs(frame.capturing(3, alpha, gamma) - alpha[1] - 2 * found) < 1e-12)
        True
        """
        v, (_, b1, b2, _), (_, c1, c2, c3) = self.v, self.b, self.c
        free: Any = alpha
        given: Any = gamma
        found: Array
        if order == 2:
            found = (c1 - given[1]) / v
        elif order == 3:
            found = (2 / 3 * (c2 - given[2]) - free[0] * b1) / v
        elif order == 4:
            a1, a2 = free[:2]
            known = 3 * v**2 * c1 if _is_cayley(exponential) else (2 * v**2 - a1**2) * c1
            found = (c3 - given[3] + known - a1 * v**3 - 2 * a1 * b2 - 3 * a2 * b1) / (2 * v)
        else:
            raise InputError(f"the order is {order!r}, expected 2, 3 or 4")
        return found

    def __repr__(self) -> str:
        return f"<frame on S^2 at points of shape {self.point.shape}>"


def _is_cayley(exponential: str) -> bool:
    if exponential not in ("exp", "cayley"):
        raise InputError(f"the order conditions are known for 'exp' and 'cayley', not for {exponential!r}")
    return exponential == "cayley"
