"""Spheres, and the frame of section 3 of the paper on S^2."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import factorial
from typing import Any, TypeAlias, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import InputError, ShapeError
from liehom.base.typing import Array, Real, Values
from liehom.exact.algebra.constructions.classical import so
from liehom.exact.representations.constructions import adjoint, defining
from liehom.exact.representations.core.representation import Representation
from liehom.flow.action.components import Components
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.maps import FieldMap
from liehom.flow.action.space import Action
from liehom.flow.run.options import points_of
from liehom.flow.series.jet import Jet
from liehom.flow.steps.curvature import Submanifold, geodesic_curvature
from liehom.flow.steps.expansion import flow_series, step_series
from liehom.flow.steps.step import ExponentialLike, Generator, OneExponential, Step, step_variable

# Sphere: SO(k) on the sphere of any radius in R^k, with generators of vector fields and geodesic curvatures.
#     (x ^ y) z = <x, z> y - <y, z> x,   omega(m) = m ^ X(m) / |m|^2 is the generator of X orthogonal to g_m,
#     g_m = {eta : eta m = 0}, spanned by x ^ y with x, y orthogonal to m.
# For k = 3 generators are vectors that act by the cross product, x ^ y = x x y. Let u = X/|X|, and let K be the
# curvature vector of the orbit (tangential, orthogonal to u). Euler's step with |X| u ^ K added to its generator moves
# on the circle that osculates the orbit: (3.7) of the paper, in any dimension.

VectorField: TypeAlias = Callable[..., Any] | Sequence[Any]
"""Components of a vector field or of a generator, in one of the forms that a `GeneratorField` takes."""


@final
class Sphere:
    """The sphere in R^k under SO(k).

    Parameters
    ----------
    k : int
        The dimension of the surrounding space, at least 2.
    radius : float

    Attributes
    ----------
    representation : Representation
        so(k) on R^k; for k = 3 with the cross product, else the defining one.

    Notes
    -----
    Section 3 of the paper for k = 3; the example of section 6 for all k.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> sphere = Sphere(4)
    >>> field = sphere.generator(lambda m: np.stack([-m[..., 1], m[..., 0], 0 * m[..., 0], 0 * m[..., 0]], axis=-1))
    >>> m = np.array([0.5, 0.5, 0.5, 0.5])
    >>> field.vector(m).tolist(), sphere.isotropy_dimension
    ([-0.5, 0.5, 0.0, 0.0], 3)
    """

    def __init__(self, k: int, radius: float = 1.0) -> None:
        if isinstance(k, bool) or not isinstance(k, int | np.integer) or k < 2:
            raise InputError(f"k is {k!r}, expected an integer at least 2: the sphere lies in R^k")
        if not 0 < radius < np.inf:
            raise InputError(f"the radius is {radius!r}, expected a positive number")
        self.k, self.radius = int(k), float(radius)
        self.representation: Representation = adjoint(so(3)) if k == 3 else defining(so(self.k))
        self._wedge = _wedge(self.representation)

    @property
    def isotropy_dimension(self) -> int:
        """The dimension of g_m = so(k - 1)."""
        return (self.k - 1) * (self.k - 2) // 2

    def wedge(self, x: npt.ArrayLike | Values, y: npt.ArrayLike | Values) -> Any:
        """x ^ y in so(k), shape (..., dim so(k)), for x and y (..., k): arrays, Jets or exact numbers."""
        return self._wedge(x, y)

    def project(self, m: npt.ArrayLike) -> Array:
        """The points radius m / |m| of the sphere, shape (..., k)."""
        point = points_of(m)
        return self.radius * point / np.linalg.norm(point, axis=-1, keepdims=True)

    def generator(self, field: VectorField, isotropy: VectorField | None = None) -> GeneratorField:
        """The vector field X as a GeneratorField, with the orthogonal generator or with isotropy added to it.

        Parameters
        ----------
        field : callable or sequence
            X(m) or X(m, t) in one of the forms that a `GeneratorField` takes, with k components. The component along m
            has no effect.
        isotropy : callable or sequence, optional
            eta(m) or eta(m, t) in so(k); its part in g_m, eta - m ^ eta m / |m|^2, is added.

        Examples
        --------
        >>> import numpy as np
        >>> sphere, m = Sphere(3), np.array([0.6, 0.0, 0.8])
        >>> turn = lambda m: np.cross([0.0, 0.0, 1.0], m)
        >>> sphere.generator(turn).psi(m).round(12).tolist()
        [-0.48, 0.0, 0.36]
        >>> sphere.generator(turn, lambda m: 0 * m + [0.0, 0.0, 1.0]).psi(m).round(12).tolist()
        [0.0, 0.0, 1.0]
        """
        vector = Components(field, self.k, (self.k,), "X")
        dimension = self.representation.algebra.dimension
        eta = None if isotropy is None else Components(isotropy, self.k, (dimension,), "the isotropy")
        timed = vector.time_dependent or (eta is not None and eta.time_dependent)
        action = Action(self.representation).infinitesimal

        def psi(m: Values, t: Real) -> Any:
            x: Any = vector(m, t)
            if eta is None:
                return self.wedge(m, x) / dot(m, m)
            more = eta(m, t)
            return more + self.wedge(m, x - action(more, m)) / dot(m, m)

        return GeneratorField(self.representation, psi if timed else lambda m: psi(m, 0.0), time_dependent=timed)

    def orthogonal(self, field: GeneratorField) -> GeneratorField:
        """The vector field of `field` as a GeneratorField with the orthogonal generator."""
        return self.generator((lambda m, t: field.vector(m, t)) if field.time_dependent else lambda m: field.vector(m))

    def curvature_of_flow(self, field: GeneratorField, m: npt.ArrayLike, t: Real = 0.0) -> Array:
        """Geodesic curvature of the orbit through m, (3.8).

        Parameters
        ----------
        field : GeneratorField
        m : array_like of shape (..., k)
        t : float

        Returns
        -------
        array
            For k = 3 the signed curvature, shape (...,), positive for curves to the left seen from outside. For other k
            the curvature vector, tangential and orthogonal to X, shape (..., k). It is 0 where X = 0.

        Examples
        --------
        A circle of latitude at height 0.8:

        >>> import numpy as np
        >>> sphere = Sphere(3)
        >>> field = sphere.generator(lambda m: np.cross([0.0, 0.0, 1.0], m))
        >>> round(float(sphere.curvature_of_flow(field, [0.6, 0.0, 0.8])), 12)  # 0.8 / 0.6
        1.333333333333
        """
        return self._curvature(flow_series(field, points_of(m), 2, t).points)

    def curvature_of_step(
        self, field: GeneratorField, step: Step, m: npt.ArrayLike, exponential: ExponentialLike = "exp"
    ) -> Array:
        """Geodesic curvature at m of the curve dt -> step of size dt, in the form of `curvature_of_flow`."""
        return self._curvature(self.step_curve(field, step, m, 2, exponential))

    def step_curve(
        self, field: GeneratorField, step: Step, m: npt.ArrayLike, order: int, exponential: ExponentialLike = "exp"
    ) -> Jet:
        """Taylor series of dt -> step of size dt at m, a Jet with values of shape (..., k)."""
        point = points_of(m)
        action = Action(self.representation, exponential)
        local = step.at(action, Generator(field, self.k - 1), point, np.zeros((*point.shape[:-1], 1)))
        return step_series(action, local, point, order)

    def curvature_series(self, curve: Jet) -> Jet:
        """Geodesic curvature along a curve of order n, a Jet of order n - 2 (of numbers for k = 3, else of vectors).

        Parameters
        ----------
        curve : Jet
            Values of shape (..., k), of order at least 2, with velocity not 0.

        Notes
        -----
        Lemma 2 and (3.10) of the paper: the curvatures of two curves that agree to order n - 1 differ first in the
        derivative of order n - 2, by the difference of the n-th derivatives along N x X, divided by |X|^3.

        Examples
        --------
        >>> import numpy as np
        >>> import liehom as lh
        >>> sphere = Sphere(3)
        >>> field = sphere.generator(lambda m: np.cross([0.0, 0.0, 1.0], m))
        >>> curve = lh.steps.flow_series(field, np.array([0.6, 0.0, 0.8]), 4).points
        >>> (sphere.curvature_series(curve).coefficients.round(12) + 0.0).tolist()
        [1.333333333333, 0.0, 0.0]
        """
        vectors = geodesic_curvature(curve, Submanifold.level_set(lambda m: np.sum(m * m, axis=-1), self.k))
        if self.k != 3:
            return vectors
        y, n = curve.coefficients, vectors.order
        m: Any = Jet(y[: n + 1])
        velocity: Any = Jet(np.arange(1, n + 2).reshape(-1, *[1] * (y.ndim - 1)) * y[1 : n + 2])
        left: Any = np.cross(m, velocity)
        return np.sum(vectors * left, axis=-1) / np.sqrt(np.sum(left * left, axis=-1))

    def improvement(self, field: GeneratorField, m: npt.ArrayLike, t: Real = 0.0) -> Array:
        """Isotropy with which Euler's step with the orthogonal generator follows the osculating circle: (3.7).

        It is |X| u ^ K in g_m, K the curvature vector of the orbit; for k = 3, sigma_i m/|m| with sigma_i = k_g |X|.

        Returns
        -------
        array of shape (..., dim so(k))

        Examples
        --------
        >>> import numpy as np
        >>> import liehom as lh
        >>> sphere, m = Sphere(4), np.array([0.5, 0.5, 0.5, 0.5])
        >>> field = sphere.generator(lambda m: np.roll(m, 1, -1) * [1.0, 2.0, -1.0, 0.0])
        >>> raised = lh.steps.correction(field, lh.Euler(), m, 2)
        >>> bool(np.allclose(sphere.improvement(field, m), raised.zeta[1], rtol=0, atol=1e-14))
        True
        """
        vector, unit, speed = _curvature_vector(flow_series(field, points_of(m), 2, t).points)
        return speed * self.wedge(unit, vector)

    def _curvature(self, curve: Jet) -> Array:
        m, (vector, unit, _) = curve.coefficient(0), _curvature_vector(curve)
        if self.k != 3:
            return vector
        return np.sum(vector * np.cross(m / np.sqrt(dot(m, m)), unit), axis=-1)

    def __repr__(self) -> str:
        return f"Sphere({self.k})" if self.radius == 1 else f"Sphere({self.k}, radius={self.radius})"


def dot(x: Values, y: Values) -> Any:
    """<x, y> over the last axis, shape (..., 1), for arrays and Jets."""
    return np.sum(x * y, axis=-1, keepdims=True)


def _curvature_vector(curve: Jet) -> tuple[Array, Array, Array]:
    """K = (tangential acceleration across x) / |x|^2, the unit vector along x = m', and |x|; K = 0 where x = 0."""
    m, x, acceleration = (curve.coefficient(j) * (j or 1) for j in range(3))
    speed = np.sqrt(dot(x, x))
    moves = speed > 0
    unit = np.where(moves, x / np.where(moves, speed, 1), 0)
    across = acceleration - m * (dot(acceleration, m) / dot(m, m))
    across = across - unit * dot(across, unit)
    return np.where(moves, across / np.where(moves, speed, 1) ** 2, 0), unit, speed


def _wedge(representation: Representation) -> FieldMap:
    """The map (x, y) -> x ^ y: components of y x^T - x y^T in the basis, which is orthogonal for the trace form."""
    k, entries = representation.size, []
    for a, matrix in enumerate(representation.matrices):
        rows = matrix.to_rows()
        square = sum(v * v for row in rows for v in row)
        for i in range(k):
            for j in range(k):
                value = (rows[j][i] - rows[i][j]) / square
                if value != 0:
                    entries.append((i, j, a, value))
    return FieldMap(entries, (k, k, representation.algebra.dimension), representation.field)


# SphereFrame: the frame {n, omega/v, n x omega/v} of section 3 on S^2, with the order conditions in its coordinates.
#     n = m/|m|,  v = |omega|,  omega^(j) = a_j n + b_j omega/v + c_j n x omega/v,  likewise alpha_j, beta_j, gamma_j
#     for the coefficients xi_j of a step xi = sum xi_j t^j / j!
# The orders determine beta_j and gamma_j; alpha_j, the isotropy, is free. gamma decides whether the orbit is captured,
# beta whether the point is reached at the right time.

ORDER = 4

Coordinates: TypeAlias = tuple[Array, ...]  # one coordinate of four vectors, arrays of shape (...,)


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

    Notes
    -----
    Section 3 of the paper, (3.2)-(3.6), with corrected signs and terms; order 4 is not in the paper.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(Sphere(3).representation, lambda m: m * [1.0, 2.0, 3.0])
    >>> frame = SphereFrame(field, [0.6, 0.48, 0.64])
    >>> sigma = lh.steps.correction(field, lh.Euler(), np.array([0.6, 0.48, 0.64]), 2).zeta[1]
    >>> alpha, _, gamma = frame.coordinates(lh.Euler(), field)
    >>> bool(np.allclose(frame.capturing(2, alpha, gamma), alpha[0] + sigma @ frame.vectors[0]))  # (3.5)
    True
    """

    def __init__(self, field: GeneratorField, m: npt.ArrayLike) -> None:
        point = points_of(m)
        if point.shape[-1:] != (3,) or field.representation.size != 3:
            raise ShapeError(f"the frame is one on S^2, got points of shape {point.shape} and {field!r}")
        if field.time_dependent:
            raise InputError("the field depends on time; the order conditions of section 3 are for autonomous fields")
        self.point = point
        flow = flow_series(Sphere(3).orthogonal(field), point, ORDER)
        omega = [flow.psi(j) * factorial(j) for j in range(ORDER)]
        self.v: Array = np.linalg.norm(omega[0], axis=-1)
        if bool(np.any(self.v == 0)):
            raise InputError("there is no frame at an equilibrium: leave such points out")
        n = point / np.linalg.norm(point, axis=-1, keepdims=True)
        along = omega[0] / self.v[..., None]
        self.vectors: Values = np.stack([n, along, np.cross(n, along)], axis=-2)
        self.a, self.b, self.c = self._read(omega)

    def _read(self, vectors: Sequence[Any]) -> tuple[Coordinates, Coordinates, Coordinates]:
        """Coordinates of vectors in the frame: those along n, along omega, and along n x omega."""
        coordinates = [(self.vectors @ x[..., None])[..., 0] for x in vectors]
        along_n, along, across = (tuple(x[..., i] for x in coordinates) for i in range(3))
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
        v, (_, b1, b2, b3), (_, c1, c2, c3) = self.v, self.b, self.c
        free: Any = alpha
        a1, a2, a3 = free[:3]
        tail = -a1 * v**3 - 2 * a1 * b2 - 3 * a2 * b1 - 2 * a3 * v
        if _is_cayley(exponential):
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

        Examples
        --------
        >>> import liehom as lh
        >>> field = lh.GeneratorField(Sphere(3).representation, lambda m: m * [1.0, 2.0, 3.0])
        >>> m = [0.6, 0.48, 0.64]
        >>> frame = SphereFrame(field, m)
        >>> alpha, _, gamma = frame.coordinates(lh.Heun(), field)
        >>> alpha2 = lh.steps.correction(field, lh.Heun(), m, 3).zeta[2] @ m  # of t^2, alpha_2 is that of t^2/2
        >>> bool(abs(frame.capturing(3, alpha, gamma) - alpha[1] - 2 * alpha2) < 1e-12)
        True
        """
        v, (_, b1, b2, _), (_, c1, c2, c3) = self.v, self.b, self.c
        free: Any = alpha
        across: Any = gamma
        if order == 2:
            return (c1 - across[1]) / v
        if order == 3:
            return (2 / 3 * (c2 - across[2]) - free[0] * b1) / v
        if order != 4:
            raise InputError(f"the order is {order!r}, expected 2, 3 or 4")
        a1, a2 = free[:2]
        known = 3 * v**2 * c1 if _is_cayley(exponential) else (2 * v**2 - a1**2) * c1
        return (c3 - across[3] + known - a1 * v**3 - 2 * a1 * b2 - 3 * a2 * b1) / (2 * v)

    def __repr__(self) -> str:
        return f"<frame on S^2 at points of shape {self.point.shape}>"


def _is_cayley(exponential: str) -> bool:
    if exponential not in ("exp", "cayley"):
        raise InputError(f"the order conditions are known for 'exp' and 'cayley', not for {exponential!r}")
    return exponential == "cayley"
