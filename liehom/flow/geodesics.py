"""Geodesics of invariant metrics on G/H.

A curve g(t) H with g' = g x, where x is a curve in the complement m, is a geodesic if the momentum mu = <x, .> on m,
extended by 0 on h, satisfies the Euler-Arnold equation mu' = ad(x)^* mu on the dual of g. Both mu and the transpose of
the matrix of g move by the element -x of g, so they are one point of a representation. A step that moves it by the
group conserves the momentum Ad(g)^* mu of each Killing field to round-off. If exp(tX) H is the geodesic, g = exp(tX)
and mu is constant.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Unpack, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import FieldError, InputError, ShapeError, displayed
from liehom.base.typing import Array, VectorLike
from liehom.flow.action.field import GeneratorField
from liehom.flow.door import Field, InvariantMetric, Representation, adjoint, coadjoint, trivial
from liehom.flow.engines.arguments import CallOptions
from liehom.flow.methods.low_order import Euler
from liehom.flow.propagation.integration import integrate
from liehom.flow.run.options import Span, span_of
from liehom.flow.run.solution import Solution
from liehom.flow.steps.step import StepLike

STEPS = 100  # Steps along a homogeneous geodesic


@final
@dataclass(frozen=True, slots=True, eq=False)
class Geodesic:
    """A geodesic g(t) H of an invariant metric, from the base point.

    Attributes
    ----------
    metric : InvariantMetric
    representation : Representation
        The one of the matrices of g(t).
    solution : Solution
        The momentum in the dual of g, followed by the transpose of the matrix of g(t).
    homogeneous : bool
        Whether g(t) = exp(tX) for an element X of g that was found exactly; then the only error is round-off.
    """

    metric: InvariantMetric
    representation: Representation
    solution: Solution
    homogeneous: bool

    @property
    def t(self) -> Array:
        """The times, shape (k,)."""
        return np.asarray(self.solution.t, dtype=float)

    @property
    def momenta(self) -> Array:
        """The values of <x, .> on the basis of g, shape (k, n)."""
        rows: Array = self.solution.y[: self.metric.metrics.pair.algebra.dimension].T
        return rows

    @property
    def velocities(self) -> Array:
        """Coordinates in m of the velocity, moved back to the base point by g(t), shape (k, d)."""
        split = self.metric.metrics.split
        field: Any = self.metric.field
        on_m = self.momenta @ _floats(field, split.complement).T
        return np.asarray(np.linalg.solve(_floats(field, self.metric.matrix()), on_m.T).T, dtype=float)

    @property
    def group(self) -> Array:
        """The matrices of g(t) in the representation, shape (k, N, N)."""
        n, size = self.metric.metrics.pair.algebra.dimension, self.representation.size
        return np.swapaxes(self.solution.y[n:].T.reshape(-1, size, size), 1, 2)

    def points(self, point: npt.ArrayLike) -> Array:
        """The points g(t) p on the orbit of a point p of the representation, shape (k, N); h has to fix p."""
        start, rho = np.asarray(point, dtype=float), self.representation
        if start.shape != (rho.size,):
            raise ShapeError(f"a point has {rho.size} coordinates, got the shape {start.shape}")
        moved = [_floats(rho.field, rho(z)) @ start for z in self.metric.metrics.pair.subalgebra.rows()]
        if any(np.abs(v).max() > 1e-12 * np.abs(start).max() for v in moved):
            raise InputError(f"h does not fix the point {displayed(point)}, so G/H is not its orbit")
        rows: Array = self.group @ start
        return rows

    def speeds(self) -> Array:
        """The lengths of the velocities, shape (k,), which an exact geodesic keeps constant."""
        v = self.velocities
        field: Any = self.metric.field
        squares: Array = np.einsum("ki,ij,kj->k", v, _floats(field, self.metric.matrix()), v)
        return np.sqrt(np.abs(squares))


def _floats(field: Field, table: Iterable[Any]) -> Array:
    """An array of exact numbers in float64."""
    values = np.asarray(table, dtype=object)
    numbers: Array = np.array([field.to_float(field.convert(x)) for x in values.ravel()]).reshape(values.shape)
    return numbers


def geodesic(
    metric: InvariantMetric,
    x: VectorLike,
    t_span: Iterable[float] | Span,
    *,
    representation: Representation | None = None,
    step: StepLike | None = None,
    **options: Unpack[CallOptions],
) -> Geodesic:
    """The geodesic g(t) H of an invariant metric with initial velocity x, a `Geodesic`.

    Parameters
    ----------
    metric : InvariantMetric
        With numbers as parameters.
    x : d numbers
        Coordinates in the basis of ``pair.reductive_complement()``. For exact ones `InvariantMetric.geodesic_vector` is
        asked first.
    t_span : (float, float)
        Initial and final time.
    representation : Representation, optional
        Of g, for the matrices of g(t) (default: the adjoint representation).
    step, **options
        See `integrate`, such as ``dt=0.1`` or ``rtol=1e-10``.

    Examples
    --------
    A great circle:

    >>> import numpy as np
    >>> import liehom as lh
    >>> rho = lh.defining(lh.so(4))
    >>> metric = rho.pair([0, 0, 0, 1]).invariant_metrics()([1])
    >>> curve = lh.geodesic(metric, [1, 0, 0], (0, np.pi), representation=rho, t_eval=[0, np.pi / 2, np.pi])
    >>> curve.homogeneous, np.round(np.abs(curve.points([0, 0, 0, 1])), 12).tolist()
    (True, [[0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
    """
    if not isinstance(metric, InvariantMetric):
        raise InputError(
            f"expected an invariant metric, such as pair.invariant_metrics()([1]), got {displayed(metric)}"
        )
    g, split = metric.metrics.pair.algebra, metric.metrics.split
    rho = adjoint(g) if representation is None else representation
    if rho.algebra != g:
        raise InputError(f"the representation is of {displayed(rho.algebra)}, the metric of {displayed(g)}")
    metric.signature()  # refuses parameters
    field: Any = metric.field
    try:
        exact = metric.geodesic_vector(x)
        velocity = _floats(field, list(x))
    except FieldError:  # floats
        exact = None
        velocity = np.asarray(x, dtype=float)
    form, complement = _floats(field, metric.matrix()), _floats(field, split.complement)
    if velocity.shape != (len(form),):
        raise ShapeError(f"a tangent vector has {len(form)} coordinates, got the shape {velocity.shape}")
    both = coadjoint(g).direct_sum(rho.dual().tensor(trivial(g, rho.size)))
    start = np.concatenate([_floats(field, split.coordinates) @ form @ velocity, np.eye(rho.size).ravel()])
    n, inertia = g.dimension, complement.T @ np.linalg.solve(form, complement)
    psi: Any = (lambda m: -m[..., :n] @ inertia) if exact is None else -_floats(field, exact)
    if exact is not None and step is None and not {"dt", "rtol", "atol"} & options.keys():
        first, last = t_span = span_of(t_span, np.dtype(float))
        step, options["dt"] = Euler(), (last - first) / STEPS  # exp(hX), exactly
    solution = integrate(GeneratorField(both, psi), t_span, start, step=step, **options)
    return Geodesic(metric, rho, solution, exact is not None)
