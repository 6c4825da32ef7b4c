"""Momentum maps: of the action on the cotangent bundle, and of symplectic actions, whose components may be conserved.

On T*M:            J(alpha_m)(eta) = alpha_m(rho(eta) m)
On M, symplectic:  dJ_eta = Omega(rho(eta) m, .)

For a Hamiltonian that a subgroup H leaves invariant the components of J: M -> h* are first integrals (Noether).
"""

from __future__ import annotations

from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike

from liehom.algebra import Subalgebra
from liehom.errors import InputError, ShapeError, displayed
from liehom.homogeneous.maps import action_map
from liehom.representations import Representation, coadjoint
from liehom.series.arrays import as_values
from liehom.typing import Array, Values, ValuesLike

RTOL = 1e-10
"""Relative size up to which a matrix counts as zero."""


def cotangent_momentum(representation: Representation, m: ValuesLike, alpha: ValuesLike) -> Values:
    """The value J(alpha_m) in g* of the momentum map of T*M, by its components alpha(rho(e_a) m), shape (..., dim g).

    Parameters
    ----------
    representation : Representation
    m : array_like of shape (..., N)
    alpha : array_like of shape (..., N)
        A covector at m, such as the gradient of a function.

    Notes
    -----
    The remark after Corollary 11 of the paper: for a first integral F with values in W and z in W*, the map chi_m of
    (7.5) satisfies

        <z, chi_m(zeta)> = -e J(d<z, F>(m))([xi_1, zeta]),

    so chi_m is onto if and only if ad*_(xi_1) J(d<z, F>(m)) does not vanish on g_m for any z other than 0.

    Examples
    --------
    >>> import liehom as lh
    >>> cotangent_momentum(lh.adjoint(lh.so(3)), [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]).tolist()  # m x alpha
    [0.0, 0.0, 2.0]
    """
    point, covector = as_values(m), as_values(alpha)
    size = representation.size
    if point.shape[-1:] != (size,) or covector.shape[-1:] != (size,):
        raise ShapeError(f"m and alpha have shapes {point.shape} and {covector.shape}, expected (..., {size})")
    found: Values = action_map(representation).right_transposed(point, covector)
    return found


@final
class MomentumMap:
    """The momentum map J: M -> h* of a subalgebra h that acts on a symplectic representation or on coadjoint orbits.

    Parameters
    ----------
    representation : Representation
        The coadjoint representation, or one that preserves the symplectic form.
    subalgebra : Subalgebra, optional
        h, the infinitesimal symmetries; by default all of g.
    form : (N, N) array_like, optional
        The matrix Omega of a symplectic form on V, Omega(u, v) = u^T Omega v. On coadjoint orbits the form of Kirillov,
        Kostant and Souriau is used, and none is given.

    Attributes
    ----------
    dimension : int
        Dimension of h.

    Raises
    ------
    InputError
        If the representation is not the coadjoint one and no form is given, or if the form is not antisymmetric,
        nondegenerate and invariant.
    ShapeError
        If the form has another shape.

    Notes
    -----
    J is linear on coadjoint orbits, J(m) = m restricted to h, and quadratic on V: J(m)(eta) = Omega(rho(eta) m, m) / 2.
    It is equivariant. An instance is a function of m, with values of shape (..., dim h), on arrays, Jets and tracers.
    `Conserving` takes it as an integral. `component` gives one of its components.

    Examples
    --------
    A symmetric top conserves the component of its momentum along its axis. Heun's step does not, unless isotropy
    makes it do so:

    >>> import numpy as np
    >>> import liehom as lh
    >>> g = lh.so(3)
    >>> field = lh.hamiltonian_field(g, "m0**2/2 + m1**2/2 + m2**2/6", sign=-1)
    >>> J = MomentumMap(field.representation, g.subalgebra([[0, 0, 1]]))
    >>> def change(step):
    ...     return float(np.ptp(J(lh.integrate(field, (0, 10), [0.6, 0.48, 0.64], step=step, dt=0.1).y.T)))
    ...
    >>> change(lh.Heun()) > 1e-6, change(lh.Conserving(lh.Heun(), J)) < 1e-14
    (True, True)
    """

    dimension: int
    representation: Representation

    __slots__ = ("_linear", "_quadratic", "dimension", "representation")

    def __init__(
        self, representation: Representation, subalgebra: Subalgebra | None = None, form: ArrayLike | None = None
    ) -> None:
        if not isinstance(representation, Representation):
            raise InputError(f"expected a Representation, got {displayed(representation)}")
        if subalgebra is not None and subalgebra.algebra != representation.algebra:
            raise InputError(f"{displayed(subalgebra)} is not a subalgebra of {displayed(representation.algebra)}")
        self.representation = representation
        r, n = representation.algebra.dimension, representation.size
        rows: Array = np.eye(r) if subalgebra is None else np.asarray(subalgebra.basis.to_numpy()).reshape(-1, r)
        self.dimension: int = len(rows)
        matrices = np.array([a.to_numpy() for a in representation.matrices]).reshape(r, n, n)
        self._linear: Array | None = None
        self._quadratic: Array | None = None
        if form is not None:
            self._quadratic = _quadratic(np.tensordot(rows, matrices, 1), np.asarray(form, dtype=float))
            return
        dual = np.array([a.to_numpy() for a in coadjoint(representation.algebra).matrices]).reshape(r, r, r)
        if n != r or not np.allclose(matrices, dual, rtol=RTOL, atol=RTOL):
            raise InputError(
                f"{displayed(representation)} is not the coadjoint representation: give form=, the matrix of an "
                "invariant symplectic form"
            )
        self._linear = rows.T

    def __call__(self, m: Values) -> Values:
        """The components of J(m) in the dual of the basis of h, array or Jet of shape (..., dim h)."""
        if self._linear is not None:
            linear: Values = m @ self._linear
            return linear
        parts: Any = self._quadratic
        quadratic: Values = np.stack([np.sum(m * (m @ part), axis=-1) for part in parts], axis=-1)
        return quadratic

    def component(self, eta: ArrayLike) -> _Component:
        """The function m -> J(m)(eta), of shape (...,), for the coefficients of eta in the basis of h.

        Examples
        --------
        >>> import liehom as lh
        >>> J = MomentumMap(lh.coadjoint(lh.so(3)))
        >>> float(J.component([0, 0, 1])(np.array([1.0, 2.0, 3.0])))
        3.0
        """
        weights = np.asarray(eta, dtype=float)
        if weights.shape != (self.dimension,):
            raise ShapeError(f"eta has shape {weights.shape}, expected ({self.dimension},)")
        return _Component(self, weights)

    def __repr__(self) -> str:
        return f"<momentum map of an algebra of dimension {self.dimension} on {displayed(self.representation)}>"


class _Component:
    """A component of a momentum map."""

    def __init__(self, momentum: MomentumMap, weights: Array) -> None:
        self.momentum, self.weights = momentum, weights

    def __call__(self, m: Values) -> Values:
        found: Values = self.momentum(m) @ self.weights
        return found


def _quadratic(matrices: Array, form: Array) -> Array:
    """The symmetric matrices of the functions Omega(rho(eta) m, m) / 2, after a check of the form."""
    n = matrices.shape[-1]
    if form.shape != (n, n):
        raise ShapeError(f"the form has shape {form.shape}, expected ({n}, {n})")
    size = np.abs(form).max(initial=0.0)
    if not np.abs(form + form.T).max(initial=0.0) <= RTOL * size:
        raise InputError("the form is not antisymmetric")
    if np.linalg.matrix_rank(form, tol=RTOL * size) < n:
        raise InputError("the form is degenerate: a symplectic form has full rank")
    moved = np.swapaxes(matrices, -1, -2) @ form + form @ matrices
    if not np.abs(moved).max(initial=0.0) <= RTOL * size * max(np.abs(matrices).max(initial=0.0), 1.0):
        raise InputError("the form is not invariant: rho(x)^T Omega + Omega rho(x) is not 0")
    # Omega(rho m, m) / 2 = m^T rho^T Omega m / 2, a symmetric matrix, as the form is invariant
    found: Array = np.swapaxes(matrices, -1, -2) @ form / 2
    return found
