"""Sphere: SO(k) on the sphere of any radius in R^k, with generators of vector fields and geodesic curvatures.

    (x ^ y) z = <x, z> y - <y, z> x,   omega(m) = m ^ X(m) / |m|^2 is the generator of X orthogonal to g_m,
    g_m = {eta : eta m = 0}, spanned by x ^ y with x, y orthogonal to m.

For k = 3 generators are vectors that act by the cross product, x ^ y = x x y. Let u = X/|X|, and let K be the
curvature vector of the orbit (tangential, orthogonal to u). Euler's step with |X| u ^ K added to its generator moves on
the circle that osculates the orbit: (3.7) of the paper, in any dimension.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias, final

import numpy as np
import numpy.typing as npt

from liehom.algebra import so
from liehom.correctors.curvature import Submanifold, geodesic_curvature
from liehom.correctors.expansion import flow_series, step_series
from liehom.correctors.step import ExponentialLike, Generator, Step
from liehom.errors import InputError
from liehom.homogeneous import Action, GeneratorField
from liehom.homogeneous.fields.components import Components
from liehom.homogeneous.maps import FieldMap
from liehom.integrators.points import points_of
from liehom.representations import Representation, adjoint, defining
from liehom.series.jet import Jet
from liehom.typing import Array, Real, Values

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

    Raises
    ------
    InputError
        If k or the radius is not right.

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

    k: int
    radius: float

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
        """x ^ y in so(k), shape (..., dim so(k)), for x and y (..., k): arrays, Jets or exact numbers.

        Examples
        --------
        >>> Sphere(3).wedge([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).tolist()
        [0.0, 0.0, 1.0]
        """
        return self._wedge(x, y)

    def project(self, m: npt.ArrayLike) -> Array:
        """The points radius m / |m| of the sphere, shape (..., k).

        Examples
        --------
        >>> Sphere(3, 2.0).project([0.0, 3.0, 0.0]).tolist()
        [0.0, 2.0, 0.0]
        """
        point = points_of(m)
        projected: Array = self.radius * point / np.linalg.norm(point, axis=-1, keepdims=True)
        return projected

    # -- generators --------------------------------------------------------------------------------------
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
        times = vector.time_dependent or (eta is not None and eta.time_dependent)
        action = Action(self.representation).infinitesimal

        def psi(m: Values, t: Real) -> Any:
            x: Any = vector(m, t)
            if eta is None:
                return self.wedge(m, x) / dot(m, m)
            more = eta(m, t)
            return more + self.wedge(m, x - action(more, m)) / dot(m, m)

        if times:
            return GeneratorField(self.representation, psi, time_dependent=True)
        return GeneratorField(self.representation, lambda m: psi(m, 0.0), time_dependent=False)

    def orthogonal(self, field: GeneratorField) -> GeneratorField:
        """The vector field of `field` as a GeneratorField with the orthogonal generator.

        Examples
        --------
        >>> import numpy as np
        >>> import liehom as lh
        >>> sphere = Sphere(3)
        >>> field = sphere.orthogonal(lh.GeneratorField(sphere.representation, lambda m: m * [1.0, 2.0, 3.0]))
        >>> bool(abs(field.psi(np.array([0.6, 0.0, 0.8])) @ [0.6, 0.0, 0.8]) < 1e-15)
        True
        """
        if field.time_dependent:
            return self.generator(lambda m, t: field.vector(m, t))
        return self.generator(lambda m: field.vector(m))

    # -- geodesic curvature ------------------------------------------------------------------------------
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
        """Geodesic curvature at m of the curve dt -> step of size dt, in the form of `curvature_of_flow`.

        Examples
        --------
        Great circles for Euler's step with the orthogonal generator:

        >>> import numpy as np
        >>> import liehom as lh
        >>> sphere = Sphere(3)
        >>> field = sphere.generator(lambda m: np.cross([0.0, 0.0, 1.0], m))
        >>> bool(abs(sphere.curvature_of_step(field, lh.Euler(), [0.6, 0.0, 0.8])) < 1e-15)
        True
        """
        return self._curvature(self.step_curve(field, step, m, 2, exponential))

    def step_curve(
        self, field: GeneratorField, step: Step, m: npt.ArrayLike, order: int, exponential: ExponentialLike = "exp"
    ) -> Jet:
        """Taylor series of dt -> step of size dt at m, a Jet with values of shape (..., k).

        Examples
        --------
        >>> import numpy as np
        >>> import liehom as lh
        >>> sphere = Sphere(2)
        >>> field = sphere.generator(lambda m: np.stack([-m[..., 1], m[..., 0]], axis=-1))
        >>> sphere.step_curve(field, lh.Euler(), [1.0, 0.0], 2).coefficients.tolist()
        [[1.0, 0.0], [0.0, 1.0], [-0.5, 0.0]]
        """
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

        Raises
        ------
        InputError
            If the order is less than 2.

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
        >>> curve = lh.flow_series(field, np.array([0.6, 0.0, 0.8]), 4).points
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
        signed: Jet = np.sum(vectors * left, axis=-1) / np.sqrt(np.sum(left * left, axis=-1))
        return signed

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
        >>> found = lh.correction(field, lh.Euler(), m, 2)
        >>> bool(np.allclose(sphere.improvement(field, m), found.zeta[1], rtol=0, atol=1e-14))
        True
        """
        points = flow_series(field, points_of(m), 2, t).points
        point, x, acceleration = (points.coefficient(j) * (j or 1) for j in range(3))
        vector, unit, speed = _curvature_vector(point, x, acceleration)
        isotropy: Array = speed * self.wedge(unit, vector)
        return isotropy

    def _curvature(self, curve: Jet) -> Array:
        m, x, acceleration = (curve.coefficient(j) * (j or 1) for j in range(3))
        vector, unit, _ = _curvature_vector(m, x, acceleration)
        if self.k != 3:
            return vector
        signed: Array = np.sum(vector * np.cross(m / np.sqrt(dot(m, m)), unit), axis=-1)
        return signed

    def __repr__(self) -> str:
        return f"Sphere({self.k})" if self.radius == 1 else f"Sphere({self.k}, radius={self.radius})"


def dot(x: Values, y: Values) -> Any:
    """<x, y> over the last axis, shape (..., 1), for arrays and Jets.

    Examples
    --------
    >>> dot(np.ones(3), np.ones(3)).tolist()
    [3.0]
    """
    return np.sum(x * y, axis=-1, keepdims=True)


def _curvature_vector(m: Values, x: Values, acceleration: Values) -> tuple[Array, Array, Array]:
    """K = (tangential acceleration across x) / |x|^2, the unit vector along x, and |x|; K = 0 where x = 0."""
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
