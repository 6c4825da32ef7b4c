"""MoserVeselov: the discrete free rigid body in R^n, an integrable map.

    h M = w^T J - J w,    M' = w M w^T,    w in SO(n) near 1

discretizes M' = [M, Om], M = J Om + Om J (J. Moser and A. P. Veselov, Discrete versions of some classical integrable
systems and factorization of matrix polynomials, Commun. Math. Phys. 139, 1991).  w = J^-1 (X - h M/2) for the symmetric
solution X near J of (X - h M/2)(X + h M/2) = J^2, the factorization of a matrix polynomial.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple, final

import numpy as np

from liehom.correctors.step import Generator, LocalStep, Step, solve_implicitly
from liehom.errors import InputError
from liehom.homogeneous import Action
from liehom.integrators.symplectic.matrix_coordinates import MatrixCoordinates, coordinates_on_dual
from liehom.typing import Array, Values

RTOL = 1e-9
"""Relative size up to which psi may differ from that of a rigid body."""


class Inertia(NamedTuple):
    """J in its principal axes, and the sign of psi = +-Om."""

    moments: Array
    axes: Array
    sign: float


@final
@dataclass(frozen=True)
class MoserVeselov(Step):
    """The Moser-Veselov step of a free rigid body in R^n, n >= 3: order 2, symmetric, symplectic, integrable.

    The field is the Hamiltonian field of H = tr(M^T Om) / 4 on the dual of so(n), M = J Om + Om J; the step finds J
    from psi. For n = 3 the moments of inertia I_1, I_2, I_3 satisfy the triangle inequality strictly, as those of a
    body in space do, since J = diag(I_2 + I_3 - I_1, I_3 + I_1 - I_2, I_1 + I_2 - I_3) / 2 is positive.

    Notes
    -----
    Conserved to round-off are the spectrum of M, and the first integrals of the discrete body, which are close to
    those of the continuous one.

    Raises
    ------
    InputError
        In a step, if psi is not that of such a body.
    ConvergenceError
        In a step, if the iteration does not converge because the step size is too large.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> body = lh.RigidBody([2, 3, 4])
    >>> sol = lh.integrate(body.field("b"), (0, 50), [0.6, 0.48, 0.64], step=lh.MoserVeselov(), dt=0.1)
    >>> bool(np.ptp(body.energy(sol.y.T)) < 1e-4), bool(np.abs(np.sum(sol.y**2, axis=0) - 1).max() < 1e-13)
    (True, True)
    """

    @property
    def order(self) -> int:
        return 2

    @property
    def symmetric(self) -> bool:
        """Whether a step of size -h is the inverse of a step of size h: True."""
        return True

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        coordinates = coordinates_on_dual(action, None, "MoserVeselov")
        inertia = inertia_of(coordinates, psi)
        return LocalStep(action, m, point=lambda h: _point(coordinates, inertia, m, h))


def _point(coordinates: MatrixCoordinates, inertia: Inertia, m: Values, h: Values) -> Values:
    """The point after a step of size h (..., 1)."""
    moments, axes, sign = inertia
    form = axes.T @ (coordinates.form(m) @ axes)
    step: Any = -sign * h[..., None] / 2
    half = step * form  # h M / 2 in the principal axes
    sums = moments[:, None] + moments
    fixed = half @ half

    def deviation(y: Values) -> Values:  # X = J + Y
        turned = half * moments - moments[:, None] * half + half @ y - y @ half
        found: Values = (turned + fixed - y @ y) / sums
        return found

    y = solve_implicitly(deviation, 0.0 * form, h, stacked=True)
    w = (np.diag(moments) + y - half) / moments[:, None]
    w = w + w @ (np.eye(len(moments)) - np.swapaxes(w, -1, -2) @ w) / 2  # orthogonal to round-off
    moved = w @ form @ np.swapaxes(w, -1, -2)
    return coordinates.point(axes @ moved @ axes.T)
