"""Symplectic steps on coadjoint orbits: midpoints and the discrete rigid body."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar, NamedTuple, final

import numpy as np

from liehom.base.errors import ConvergenceError, InputError
from liehom.base.typing import Array, Values
from liehom.flow.action.exponential import TrueExponential
from liehom.flow.action.space import Action
from liehom.flow.door import Representation, adjoint, coadjoint, copies_of, defining, so
from liehom.flow.series.arrays import is_jax, norm, zeros
from liehom.flow.series.jet import Jet
from liehom.flow.steps.implicit import reach_of, solve_implicitly
from liehom.flow.steps.step import Generator, LocalStep, OneExponential, Step
from liehom.flow.tracing.array import Traced

# MatrixCoordinates: linear forms on a matrix Lie algebra as matrices, by its trace form. <m, x> = tr(W D(x)) for all x,
# W in D(g), m -> -(ad x)^T m corresponds to W -> [D(x), W]

TOLERANCE = 1e-10  # relative size up to which a number counts as zero when a representation is recognized


@final
class MatrixCoordinates:
    """The matrices W of the points of the dual of a matrix Lie algebra, and the matrices of its elements."""

    __slots__ = ("_elements", "_forms", "_points", "basis", "size")

    def __init__(self, matrices: Representation) -> None:
        self.size = n = matrices.size
        r = matrices.algebra.dimension
        self.basis: Array = np.array([a.to_numpy() for a in matrices.matrices]).reshape(r, n, n)  # D of the basis
        self._elements = self.basis.reshape(r, n * n)
        self._points = self.basis.transpose(0, 2, 1).reshape(r, n * n).T  # tr(W E_a) = sum_ij W_ij (E_a)_ji
        gram = self._elements @ self._points
        sizes = np.linalg.svd(gram, compute_uv=False)
        if sizes[-1] <= TOLERANCE * sizes[0]:
            raise InputError(f"the trace form of {matrices!r} is degenerate: give another representation by matrices")
        self._forms = np.linalg.inv(gram).T @ self._elements

    def element(self, x: Values) -> Values:
        """The matrices D(x) for x (..., r), shape (..., n, n)."""
        return self._matrix(x @ self._elements)

    def form(self, m: Values) -> Values:
        """The matrices W of points m (..., r), shape (..., n, n)."""
        return self._matrix(m @ self._forms)

    def point(self, w: Values) -> Values:
        """The points m (..., r) of matrices W (..., n, n): m_a = tr(W D(e_a))."""
        return w.reshape((*w.shape[:-2], self.size**2)) @ self._points

    def _matrix(self, flat: Values) -> Values:
        return flat.reshape((*flat.shape[:-1], self.size, self.size))


@lru_cache(maxsize=32)
def coordinates_on_dual(
    representation: Representation, matrices: Representation | None, name: str
) -> MatrixCoordinates:
    """The matrix coordinates on the dual of a quadratic matrix Lie algebra, after a check."""
    algebra = representation.algebra
    images = [a.to_numpy() for a in representation.matrices]
    dual = [a.to_numpy() for a in coadjoint(algebra).matrices]
    if representation.size != algebra.dimension or not np.allclose(images, dual, rtol=TOLERANCE, atol=TOLERANCE):
        raise InputError(
            f"{name} is a step on the dual of a Lie algebra, got {representation!r}: take liehom.hamiltonian_field, or "
            "liehom.coadjoint(algebra)"
        )
    if matrices is None:
        try:
            matrices = defining(algebra)
        except InputError as error:
            raise InputError(f"{name} needs the matrices of {algebra!r}: give matrices=, a Representation") from error
    elif matrices.algebra != algebra:
        raise InputError(f"the matrices of {name} represent {matrices.algebra!r}, not {algebra!r}")
    coordinates = MatrixCoordinates(matrices)
    _check_quadratic(coordinates, matrices, name)
    return coordinates


def _check_quadratic(space: MatrixCoordinates, matrices: Representation, name: str) -> None:
    """Check that x y x is in D(g) for all x, y in D(g), up to matrices that commute with D(g), at two samples."""
    r = len(space.basis)
    for k in (1, 2):
        x, y = (space.element(np.cos(k * shift + np.arange(r))) for shift in (1.0, 2.0))
        product = x @ y @ x
        rest = product - space.form(space.point(product))
        wrong = rest @ space.basis - space.basis @ rest
        if np.abs(wrong).max() > TOLERANCE * max(np.abs(product).max(), 1.0) * max(np.abs(space.basis).max(), 1.0):
            raise InputError(
                f"{name} needs a quadratic group, such as SO(n), SU(n) or Sp(n): products x y x of elements of "
                f"{matrices!r} are not in the algebra. liehom.methods.VariationalMidpoint works for every algebra"
            )


# VariationalMidpoint is the Lie-Poisson step of the discrete Hamilton-Pontryagin principle, for any algebra.
#     p = int_0^1 exp(s x) m ds,    x = h psi(p),    m -> exp(x) m
# On the dual of a Lie algebra, with rho = ad* and psi = dH, p satisfies m = (dexp^-1)^* p. These are the discrete
# Euler-Poincare equations of the group difference exp(x) (N. Bou-Rabee and J. E. Marsden, Hamilton-Pontryagin
# integrators on Lie groups, Found. Comput. Math. 9, 2009), without a Lagrangian.

SERIES_TERMS = 24  # terms of the series of the mean
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
    ConvergenceError
        In a step, if the step size is too large: the equation is not solved, or |rho(x)| is above 4.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> H = "m0**2/2 + m1**2/4 + m2**2/6"
    >>> field = lh.hamiltonian_field(lh.so(3), H, sign=-1)
    >>> sol = lh.integrate(field, (0, 50), [0.6, 0.48, 0.64], step=lh.methods.VariationalMidpoint(), dt=0.1)
    >>> energy = np.array([1/2, 1/4, 1/6]) @ sol.y**2
    >>> bool(np.ptp(energy) < 1e-4), bool(np.abs(np.sum(sol.y**2, axis=0) - 1).max() < 1e-14)
    (True, True)
    """

    order = 2
    symmetric = True

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
    """The mean of exp(s x) m over 0 <= s <= 1, the sum of rho(x)^k m / (k + 1)! up to k = terms, shape (..., N)."""
    total = m
    for k in range(terms, 0, -1):  # Horner's rule
        total = m + action.infinitesimal(x, total) * (1 / (k + 1))
    return total


def zeros_of(m: Values, shape: tuple[int, ...]) -> Values:
    """Zeros of a shape, of the kind of numbers in m: where an iteration starts."""
    return zeros(m.value if isinstance(m, Jet) else m, shape)


def require_exponential(action: Action, name: str) -> None:
    """Raise InputError if Exp of an action is not the exponential map."""
    if not isinstance(action.exponential, TrueExponential):
        raise InputError(f"{name} needs the exponential map, got {action.exponential.name!r}: leave out exponential=")


# SphericalMidpoint: the symplectic midpoint step on a product of spheres.
#     m_i' = m_i + h psi_i(G) x G_i,    G_i = |m_i| (m_i + m_i') / |m_i + m_i'|
# for points (m_1, ..., m_n) of n vectors in R^3 (R. I. McLachlan, K. Modin and O. Verdier, A minimal-variable
# symplectic integrator on spheres, Math. Comp. 86, 2017). It is the classical midpoint rule for the vector field that
# is extended from the spheres constantly along rays.


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

    order = 2
    symmetric = True

    def prepare(self, action: Action, psi: Generator, m: Values, t: Values) -> SphericalMidpoint:
        """The step, after a check of the representation."""
        _require_spheres(action.representation)
        return self.with_prepared(_checked=True)

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        if not self._checked:
            _require_spheres(action.representation)
        return LocalStep(action, m, point=lambda h: _spherical_point(psi, m, t, h, reach_of(action)))


def _spherical_point(psi: Generator, m: Values, t: Values, h: Values, reach: float) -> Values:
    """The point after a step of size h (..., 1)."""
    whole = m.shape
    spins = m.reshape((*whole[:-1], whole[-1] // 3, 3))
    radii = norm(spins)[..., None]

    def rotation(x: Values) -> Values:
        doubled = spins + _rotated(x.reshape(spins.shape), spins)
        over = radii / norm(doubled)[..., None]
        velocity = psi((over * doubled).reshape(whole), t + h / 2)
        return h * (2 * over * velocity.reshape(spins.shape)).reshape(whole)

    x = solve_implicitly(rotation, zeros_of(m, whole), h, reach=reach)
    return _rotated(x.reshape(spins.shape), spins).reshape(whole)


def _rotated(x: Values, m: Values) -> Values:
    """The vectors cay(x) m for x and m (..., 3)."""
    turned = np.cross(x, m)
    return m + (turned + np.cross(x, turned) / 2) / (1 + np.sum(x * x, axis=-1, keepdims=True) / 4)


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
            "liehom.methods.VariationalMidpoint"
        )


# IsospectralMidpoint: the symplectic midpoint step on the dual of a quadratic matrix Lie algebra.
#     W = (1 - h B/2) P (1 + h B/2),    W' = (1 + h B/2) P (1 - h B/2),    B = D(psi(P))
# so that W' = cay(h B) W cay(h B)^-1: the spectrum of W is conserved (K. Modin and M. Viviani, Lie-Poisson methods for
# isospectral flows, Found. Comput. Math. 20, 2020). It is `VariationalMidpoint` with the Cayley transform in place of
# the exponential map, and the midpoint rule on T* GL(n), reduced by the momentum map (Q, P) -> Q P^T of the group.


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
    ConvergenceError
        In a step, if the iteration does not converge because the step size is too large.

    Examples
    --------
    A free rigid body in R^4:

    >>> import numpy as np
    >>> import liehom as lh
    >>> w = np.array([1.0, 0.5, 0.4, 0.3, 0.25, 0.2])
    >>> field = lh.hamiltonian_field(lh.so(4), lambda m: np.sum(w * m * m, axis=-1) / 2, sign=-1)
    >>> step, y0 = lh.methods.IsospectralMidpoint(), [0.5, 0.1, 0.4, 0.3, 0.2, 0.6]
    >>> sol = lh.integrate(field, (0, 20), y0, step=step, dt=0.1)
    >>> bool(np.ptp(np.sum(sol.y**2, axis=0)) < 1e-14)
    True
    """

    matrices: Representation | None = None
    _coordinates: ClassVar[MatrixCoordinates | None] = None  # of `prepare`

    def __post_init__(self) -> None:
        if self.matrices is not None and not isinstance(self.matrices, Representation):
            raise InputError(f"the matrices are a Representation, got {self.matrices!r}")

    order = 2
    symmetric = True

    def prepare(self, action: Action, psi: Generator, m: Values, t: Values) -> IsospectralMidpoint:
        """The step with the matrices of the algebra."""
        return self.with_prepared(
            _coordinates=coordinates_on_dual(action.representation, self.matrices, "IsospectralMidpoint")
        )

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        coordinates = self._coordinates or coordinates_on_dual(
            action.representation, self.matrices, "IsospectralMidpoint"
        )
        return LocalStep(action, m, point=lambda h: _isospectral_point(coordinates, psi, m, t, h))

    def __repr__(self) -> str:
        return "IsospectralMidpoint()" if self.matrices is None else f"IsospectralMidpoint({self.matrices!r})"


def _isospectral_point(coordinates: MatrixCoordinates, psi: Generator, m: Values, t: Values, h: Values) -> Values:
    """The point after a step of size h (..., 1)."""
    w, step = coordinates.form(m), h[..., None]

    def moved(p: Values) -> tuple[Values, Values]:
        """The products h [B, P] and h^2 B P B / 4."""
        b = step * coordinates.element(psi(coordinates.point(p), t + h / 2))
        left = b @ p
        return left - p @ b, left @ b / 4

    flat = (*w.shape[:-2], w.shape[-1] ** 2)

    def middle(x: Values) -> Values:
        turned, square = moved(w + x.reshape(w.shape))
        return (turned / 2 + square).reshape(flat)

    x = solve_implicitly(middle, zeros_of(m, flat), h).reshape(w.shape)
    return m + coordinates.point(moved(w + x)[0])


# MoserVeselov: the discrete free rigid body in R^n, an integrable map.
#     h M = w^T J - J w,    M' = w M w^T,    w in SO(n) near 1
# discretizes M' = [M, Om], M = J Om + Om J (J. Moser and A. P. Veselov, Discrete versions of some classical integrable
# systems and factorization of matrix polynomials, Commun. Math. Phys. 139, 1991). w = J^-1 (X - h M/2) for the
# symmetric solution X near J of (X - h M/2)(X + h M/2) = J^2, the factorization of a matrix polynomial.

RTOL = 1e-9  # relative size up to which psi may differ from that of a rigid body


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
    ConvergenceError
        In a step, if the iteration does not converge because the step size is too large.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> body = lh.RigidBody([2, 3, 4])
    >>> sol = lh.integrate(body.field("b"), (0, 50), [0.6, 0.48, 0.64], step=lh.methods.MoserVeselov(), dt=0.1)
    >>> bool(np.ptp(body.energy(sol.y.T)) < 1e-4), bool(np.abs(np.sum(sol.y**2, axis=0) - 1).max() < 1e-13)
    (True, True)
    """

    _coordinates: ClassVar[MatrixCoordinates | None] = None  # of `prepare`, as is the next one
    _inertia: ClassVar[Inertia | None] = None

    order = 2
    symmetric = True
    prepares_by_psi = True

    @property
    def trace_key(self) -> Hashable:
        """The inertia of a prepared step."""
        return None if self._inertia is None else repr(self._inertia)

    def prepare(self, action: Action, psi: Generator, m: Values, t: Values) -> MoserVeselov:
        """The step with the inertia of the body."""
        coordinates = coordinates_on_dual(action.representation, None, "MoserVeselov")
        return self.with_prepared(_coordinates=coordinates, _inertia=inertia_of(coordinates, psi))

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        coordinates = self._coordinates or coordinates_on_dual(action.representation, None, "MoserVeselov")
        inertia = inertia_of(coordinates, psi) if self._inertia is None else self._inertia
        return LocalStep(action, m, point=lambda h: _discrete_point(coordinates, inertia, m, h))


def _discrete_point(coordinates: MatrixCoordinates, inertia: Inertia, m: Values, h: Values) -> Values:
    """The point after a step of size h (..., 1)."""
    moments, axes, sign = inertia
    form = -2 * coordinates.form(m)  # M
    step: Any = -sign * h[..., None] / 2
    half = step * (axes.T @ form @ axes)  # h M / 2 in the principal axes
    sums, fixed = moments[:, None] + moments, half @ half
    flat = (*form.shape[:-2], form.shape[-1] ** 2)

    def deviation(x: Values) -> Values:  # X = J + Y
        y = x.reshape(form.shape)
        turned = half * moments - moments[:, None] * half + half @ y - y @ half
        return ((turned + fixed - y @ y) / sums).reshape(flat)

    y = solve_implicitly(deviation, zeros_of(m, flat), h).reshape(form.shape)
    # u = w - 1, without the rounding of 1 + u, which would let the spectrum drift
    u = axes @ ((y - half) / moments[:, None]) @ axes.T
    defect = u + _transposed(u) + _transposed(u) @ u
    u = u - (defect + u @ defect) / 2  # w is orthogonal to round-off
    turned = u @ form
    return m + coordinates.point((turned - _transposed(turned) + turned @ _transposed(u)) / -2)


def _transposed(a: Values) -> Values:
    return np.swapaxes(a, -1, -2)


def inertia_of(coordinates: MatrixCoordinates, psi: Generator) -> Inertia:
    """The matrix J of the rigid body whose generator is psi = +-Om, J Om + Om J = M, from psi at a basis."""
    n, r = coordinates.size, len(coordinates.basis)
    points, probe = np.eye(r), np.cos(np.arange(1.0, r + 1))
    velocity = np.asarray(psi(points, np.zeros((r, 1))), dtype=float)
    turned, forms = np.asarray(coordinates.element(velocity)), np.asarray(-2 * coordinates.form(points))
    e = np.eye(n)
    units = [np.maximum(np.outer(e[i], e[j]), np.outer(e[j], e[i])) for i in range(n) for j in range(i, n)]
    columns: Array = np.stack([(u @ turned + turned @ u).ravel() for u in units], axis=-1)
    weights = np.linalg.lstsq(columns, forms.ravel(), rcond=None)[0]
    rest = np.abs(columns @ weights - forms.ravel()).max()
    linear = np.abs(psi(probe, np.zeros(1)) - probe @ velocity).max() <= RTOL * np.abs(velocity).max()
    if not linear or not rest <= RTOL * np.abs(forms).max():
        raise InputError(
            f"psi is not that of a free rigid body in R^{n}, psi = +-Om with M = J Om + Om J for a symmetric J: take "
            "liehom.methods.IsospectralMidpoint()"
        )
    j = sum(x * u for x, u in zip(weights, units, strict=True))
    moments, axes = np.linalg.eigh(j)
    sums = (moments[:, None] + moments)[np.triu_indices(n, 1)]
    sign = float(np.sign(sums[0]))
    size = np.abs(moments).max()
    if np.abs(moments).min() <= RTOL * size or (sign * sums).min() <= RTOL * size:
        raise InputError(
            f"the body has J = {(sign * moments).tolist()} in its principal axes: all J_i must differ from 0, and all "
            "J_i + J_j, i != j, must be positive; take liehom.methods.IsospectralMidpoint()"
        )
    order = np.argsort(sign * moments)
    return Inertia((sign * moments)[order], axes[:, order], sign)
