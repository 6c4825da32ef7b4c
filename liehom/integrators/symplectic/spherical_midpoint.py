"""SphericalMidpoint: the symplectic midpoint step on a product of spheres.

    m_i' = m_i + h psi_i(G) x G_i,    G_i = |m_i| (m_i + m_i') / |m_i + m_i'|

for points (m_1, ..., m_n) of n vectors in R^3 (R. I. McLachlan, K. Modin and O. Verdier, A minimal-variable symplectic
integrator on spheres, Math. Comp. 86, 2017).  It is the classical midpoint rule for the vector field that is extended
from the spheres constantly along rays.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np

from liehom.algebra import so
from liehom.correctors.implicit import reach_of, solve_implicitly
from liehom.correctors.step import Generator, LocalStep, Step
from liehom.errors import InputError
from liehom.homogeneous import Action
from liehom.integrators.symplectic.variational_midpoint import zeros_of
from liehom.representations import Representation, adjoint
from liehom.representations.core.copies import copies_of
from liehom.typing import Values


@final
@dataclass(frozen=True)
class SphericalMidpoint(Step):
    """The spherical midpoint step, on products of spheres of any radii: order 2, symmetric.

    Notes
    -----
    It is a Poisson map if the field is a Hamiltonian one, psi = +-dH. A step rotates each vector, m_i' = cay(x_i) m_i,
    so that the radii are conserved to round-off, and psi is evaluated on the spheres only.

    Raises
    ------
    InputError
        In a step, if the representation is not that of so(3)^n on R^(3n) by cross products.
    ConvergenceError
        In a step, if the iteration does not converge because the step size is too large.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> body = lh.RigidBody([1, 2, 3])
    >>> sol = lh.integrate(body.field("b"), (0, 50), [0.6, 0.48, 0.64], step=lh.SphericalMidpoint(), dt=0.1)
    >>> bool(np.ptp(body.energy(sol.y.T)) < 1e-4), bool(np.abs(np.sum(sol.y**2, axis=0) - 1).max() < 1e-14)
    (True, True)
    """

    _checked: ClassVar[bool] = False  # by `prepare`

    @property
    def order(self) -> int:
        return 2

    @property
    def symmetric(self) -> bool:
        """Whether a step of size -h is the inverse of a step of size h: True."""
        return True

    def prepare(self, action: Action, psi: Generator, m: Values, t: Values) -> SphericalMidpoint:
        """The step, after a check of the representation."""
        _require_spheres(action.representation)
        return self.with_prepared(_checked=True)

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        if not self._checked:
            _require_spheres(action.representation)
        return LocalStep(action, m, point=lambda h: _point(psi, m, t, h, reach_of(action)))


def _point(psi: Generator, m: Values, t: Values, h: Values, reach: float) -> Values:
    """The point after a step of size h (..., 1)."""
    whole = m.shape
    spins = m.reshape((*whole[:-1], whole[-1] // 3, 3))
    radii = _length(spins)

    def rotation(x: Values) -> Values:
        doubled = spins + _rotated(x.reshape(spins.shape), spins)
        over = radii / _length(doubled)
        velocity = psi((over * doubled).reshape(whole), t + h / 2)
        found: Values = h * (2 * over * velocity.reshape(spins.shape)).reshape(whole)
        return found

    x = solve_implicitly(rotation, zeros_of(m, whole), h, reach=reach)
    found: Values = _rotated(x.reshape(spins.shape), spins).reshape(whole)
    return found


def _rotated(x: Values, m: Values) -> Values:
    """The vectors cay(x) m for x and m (..., 3)."""
    turned = np.cross(x, m)
    found: Values = m + (turned + np.cross(x, turned) / 2) / (1 + np.sum(x * x, axis=-1, keepdims=True) / 4)
    return found


def _length(m: Values) -> Values:
    found: Values = np.sqrt(np.sum(m * m, axis=-1, keepdims=True))
    return found


def _require_spheres(representation: Representation) -> None:
    copies = copies_of(representation)
    if copies is not None and copies.single == adjoint(so(3)):
        return
    n, r = representation.size, representation.algebra.dimension
    cross = np.cross(np.eye(3)[:, None], np.eye(3)).transpose(0, 2, 1)  # cross[a] m = e_a x m
    fits = n == r and n % 3 == 0
    for i, a in enumerate(representation.matrices if fits else ()):
        expected = np.zeros((n, n))
        block = slice(i - i % 3, i - i % 3 + 3)
        expected[block, block] = cross[i % 3]
        fits = fits and np.array_equal(a.to_numpy(), expected)
    if not fits:
        raise InputError(
            f"SphericalMidpoint is a step on products of spheres, on which so(3)^n acts by cross products, got "
            f"{representation!r}: take liehom.adjoint(liehom.so(3)) or LandauLifshitz(...).joint(), or the step "
            "liehom.VariationalMidpoint"
        )
