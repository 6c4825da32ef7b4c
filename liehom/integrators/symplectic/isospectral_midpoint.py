"""IsospectralMidpoint: the symplectic midpoint step on the dual of a quadratic matrix Lie algebra.

    W = (1 - h B/2) P (1 + h B/2),    W' = (1 + h B/2) P (1 - h B/2),    B = D(psi(P))

so that W' = cay(h B) W cay(h B)^-1: the spectrum of W is conserved (K. Modin and M. Viviani, Lie-Poisson methods for
isospectral flows, Found. Comput. Math. 20, 2020).  It is `VariationalMidpoint` with the Cayley transform in place of
the exponential map, and the midpoint rule on T* GL(n), reduced by the momentum map (Q, P) -> Q P^T of the group.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, final

from liehom.correctors.implicit import solve_implicitly
from liehom.correctors.step import Generator, LocalStep, Step
from liehom.errors import InputError
from liehom.homogeneous import Action
from liehom.integrators.symplectic.matrix_coordinates import MatrixCoordinates, coordinates_on_dual
from liehom.integrators.symplectic.variational_midpoint import zeros_of
from liehom.representations import Representation
from liehom.typing import Values


@final
@dataclass(frozen=True)
class IsospectralMidpoint(Step):
    """The isospectral symplectic midpoint step: order 2, symmetric.

    Parameters
    ----------
    matrices : Representation, optional
        D, the matrices of the algebra, of a group such as SO(n), SO(p, q), SU(n) or Sp(n), or of SL(n). By default
        the defining representation that the algebra's name stands for. The spin representation of so(3) gives the
        collective integrator on the dual of so(3) through the Hopf map.

    Notes
    -----
    It is a Poisson map if the field is a `liehom.hamiltonian_field`. Casimir functions are conserved to round-off. The
    iteration has no linear systems: P = W + h [B, P] / 2 + h^2 B P B / 4.

    Raises
    ------
    InputError
        In a step, if the representation of the field is not the coadjoint one, or the group is not quadratic.
    ConvergenceError
        In a step, if the iteration does not converge because the step size is too large.

    Examples
    --------
    A free rigid body in R^4:

    >>> import numpy as np
    >>> import liehom as lh
    >>> w = np.array([1.0, 0.5, 0.4, 0.3, 0.25, 0.2])
    >>> field = lh.hamiltonian_field(lh.so(4), lambda m: np.sum(w * m * m, axis=-1) / 2, sign=-1)
    >>> sol = lh.integrate(field, (0, 20), [0.5, 0.1, 0.4, 0.3, 0.2, 0.6], step=lh.IsospectralMidpoint(), dt=0.1)
    >>> bool(np.ptp(np.sum(sol.y**2, axis=0)) < 1e-14)
    True
    """

    matrices: Representation | None = None
    _coordinates: ClassVar[MatrixCoordinates | None] = None  # of `prepare`

    def __post_init__(self) -> None:
        if self.matrices is not None and not isinstance(self.matrices, Representation):
            raise InputError(f"the matrices are a Representation, got {self.matrices!r}")

    @property
    def order(self) -> int:
        return 2

    @property
    def symmetric(self) -> bool:
        """Whether a step of size -h is the inverse of a step of size h: True."""
        return True

    def prepare(self, action: Action, psi: Generator, m: Values, t: Values) -> IsospectralMidpoint:
        """The step with the matrices of the algebra."""
        return self.with_prepared(_coordinates=coordinates_on_dual(action, self.matrices, "IsospectralMidpoint"))

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        coordinates = self._coordinates or coordinates_on_dual(action, self.matrices, "IsospectralMidpoint")
        return LocalStep(action, m, point=lambda h: _point(coordinates, psi, m, t, h))

    def __repr__(self) -> str:
        return "IsospectralMidpoint()" if self.matrices is None else f"IsospectralMidpoint({self.matrices!r})"


def _point(coordinates: MatrixCoordinates, psi: Generator, m: Values, t: Values, h: Values) -> Values:
    """The point after a step of size h (..., 1)."""
    w = coordinates.form(m)
    step: Any = h[..., None]

    def moved(p: Values) -> tuple[Values, Values]:
        """The products h [B, P] and h^2 B P B / 4."""
        b = step * coordinates.element(psi(coordinates.point(p), t + h / 2))
        left = b @ p
        return left - p @ b, left @ b / 4

    flat = (*w.shape[:-2], w.shape[-1] ** 2)

    def middle(x: Values) -> Values:
        turned, square = moved(w + x.reshape(w.shape))
        found: Values = (turned / 2 + square).reshape(flat)
        return found

    x = solve_implicitly(middle, zeros_of(m, flat), h).reshape(w.shape)
    found: Values = m + coordinates.point(moved(w + x)[0])
    return found
