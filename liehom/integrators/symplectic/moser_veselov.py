"""MoserVeselov: the discrete free rigid body in R^n, an integrable map.

    h M = w^T J - J w,    M' = w M w^T,    w in SO(n) near 1

discretizes M' = [M, Om], M = J Om + Om J (J. Moser and A. P. Veselov, Discrete versions of some classical integrable
systems and factorization of matrix polynomials, Commun. Math. Phys. 139, 1991).  w = J^-1 (X - h M/2) for the symmetric
solution X near J of (X - h M/2)(X + h M/2) = J^2, the factorization of a matrix polynomial.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple, final

import numpy as np

from liehom.correctors.implicit import solve_implicitly
from liehom.correctors.step import Generator, LocalStep, Step
from liehom.errors import InputError
from liehom.homogeneous import Action
from liehom.integrators.symplectic.matrix_coordinates import MatrixCoordinates, coordinates_on_dual
from liehom.integrators.symplectic.variational_midpoint import zeros_of
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
    The spectrum of M is conserved to round-off, and so are the coefficients of det(J^2 + x h M - x^2) in x, the first
    integrals of Moser and Veselov. For n = 3 and n = 4 the energy is a function of these.

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

    _coordinates: ClassVar[MatrixCoordinates | None] = None  # of `prepare`, as is the next one
    _inertia: ClassVar[Inertia | None] = None

    @property
    def order(self) -> int:
        return 2

    @property
    def symmetric(self) -> bool:
        """Whether a step of size -h is the inverse of a step of size h: True."""
        return True

    @property
    def prepares_by_psi(self) -> bool:
        """Whether `prepare` calls psi: True, as it finds J."""
        return True

    @property
    def trace_key(self) -> Hashable:
        """The inertia of a prepared step."""
        return None if self._inertia is None else repr(self._inertia)

    def prepare(self, action: Action, psi: Generator, m: Values, t: Values) -> MoserVeselov:
        """The step with the inertia of the body."""
        coordinates = coordinates_on_dual(action, None, "MoserVeselov")
        return self.with_prepared(_coordinates=coordinates, _inertia=inertia_of(coordinates, psi))

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        coordinates = self._coordinates or coordinates_on_dual(action, None, "MoserVeselov")
        inertia = inertia_of(coordinates, psi) if self._inertia is None else self._inertia
        return LocalStep(action, m, point=lambda h: _point(coordinates, inertia, m, h))


def _point(coordinates: MatrixCoordinates, inertia: Inertia, m: Values, h: Values) -> Values:
    """The point after a step of size h (..., 1)."""
    moments, axes, sign = inertia
    form = -2 * coordinates.form(m)  # M
    step: Any = -sign * h[..., None] / 2
    half = step * (axes.T @ form @ axes)  # h M / 2 in the principal axes
    sums = moments[:, None] + moments
    fixed = half @ half

    flat = (*form.shape[:-2], form.shape[-1] ** 2)

    def deviation(x: Values) -> Values:  # X = J + Y
        y = x.reshape(form.shape)
        turned = half * moments - moments[:, None] * half + half @ y - y @ half
        found: Values = ((turned + fixed - y @ y) / sums).reshape(flat)
        return found

    y = solve_implicitly(deviation, zeros_of(m, flat), h).reshape(form.shape)
    # u = w - 1, without the rounding of 1 + u, which would let the spectrum drift
    u = axes @ ((y - half) / moments[:, None]) @ axes.T
    defect = u + _transposed(u) + _transposed(u) @ u
    u = u - (defect + u @ defect) / 2  # w is orthogonal to round-off
    turned = u @ form
    found: Values = m + coordinates.point((turned - _transposed(turned) + turned @ _transposed(u)) / -2)
    return found


def _transposed(a: Values) -> Values:
    found: Values = np.swapaxes(a, -1, -2)
    return found


def inertia_of(coordinates: MatrixCoordinates, psi: Generator) -> Inertia:
    """The matrix J of the rigid body whose generator is psi = +-Om, J Om + Om J = M, from psi at a basis.

    Raises
    ------
    InputError
        If psi is not linear, if there is no such J, or if J or a sum of two of its eigenvalues vanishes.

    Examples
    --------
    >>> import liehom as lh
    >>> coordinates = MatrixCoordinates(lh.defining(lh.so(3)))
    >>> psi = Generator(lh.RigidBody([2, 3, 4]).field("b"), 2)
    >>> inertia = inertia_of(coordinates, psi)
    >>> inertia.moments.round(12).tolist(), inertia.sign
    ([0.5, 1.5, 2.5], -1.0)
    """
    n, r = coordinates.size, len(coordinates.basis)
    points, time = np.eye(r), np.zeros((r, 1))
    velocity = np.asarray(psi(points, time), dtype=float)
    probe = np.cos(np.arange(1.0, r + 1))
    turned, forms = np.asarray(coordinates.element(velocity)), np.asarray(-2 * coordinates.form(points))
    units = [_symmetric_unit(n, i, j) for i in range(n) for j in range(i, n)]
    columns: Array = np.stack([(u @ turned + turned @ u).ravel() for u in units], axis=-1)
    found = np.linalg.lstsq(columns, forms.ravel(), rcond=None)[0]
    rest = np.abs(columns @ found - forms.ravel()).max()
    linear = np.abs(psi(probe, np.zeros(1)) - probe @ velocity).max() <= RTOL * np.abs(velocity).max()
    if not linear or not rest <= RTOL * np.abs(forms).max():
        raise InputError(
            f"psi is not that of a free rigid body in R^{n}, psi = +-Om with M = J Om + Om J for a symmetric J: take "
            "liehom.IsospectralMidpoint()"
        )
    j = sum(x * u for x, u in zip(found, units, strict=True))
    moments, axes = np.linalg.eigh(j)
    sums = (moments[:, None] + moments)[np.triu_indices(n, 1)]
    sign = float(np.sign(sums[0]))
    size = np.abs(moments).max()
    if np.abs(moments).min() <= RTOL * size or (sign * sums).min() <= RTOL * size:
        raise InputError(
            f"the body has J = {(sign * moments).tolist()} in its principal axes: all J_i must differ from 0, and all "
            "J_i + J_j, i != j, must be positive; take liehom.IsospectralMidpoint()"
        )
    order = np.argsort(sign * moments)
    return Inertia((sign * moments)[order], axes[:, order], sign)


def _symmetric_unit(n: int, i: int, j: int) -> Array:
    made = np.zeros((n, n))
    made[i, j] = made[j, i] = 1.0
    return made
