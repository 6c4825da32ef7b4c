"""Geodesic curvature in submanifolds, and the generator of a moving frame."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias, final

import numpy as np

from liehom.base.errors import InputError, ShapeError, displayed
from liehom.base.typing import IntegerArray, Real, Values
from liehom.flow.action.field import GeneratorField, check_point, recorded
from liehom.flow.action.maps import action_map
from liehom.flow.action.space import Action
from liehom.flow.door import Representation
from liehom.flow.series.arrays import is_exact, is_lazy
from liehom.flow.series.jet import Jet
from liehom.flow.steps.corrected import OrderRecursion, correct
from liehom.flow.steps.expansion import flow_series
from liehom.flow.steps.step import LocalStep
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import Expr, Tape
from liehom.flow.tracing.sweeps import evaluated, gradient

# Geodesic curvature of curves in submanifolds, and Lemma 2 of the paper on submanifolds of any dimension.
#     K = (m'' tangential, across m') / |m'|^2
# Let two curves agree through order n - 1. Their coefficients z_n, w_n then differ by a tangent vector (Corollary 4),
# and
#     K~_(n-2) - K_(n-2) = n (n - 1) (z_n - w_n, across m') / |m'|^2                                           (3.10)
# is the first difference of their curvatures. It vanishes if and only if the curves agree through order n up to a time
# reparametrization. On oriented surfaces in R^3 with normal N the signed curvature is <K, N x m'>/|m'|.

Columns: TypeAlias = Callable[[Jet], Jet]  # vectors along a curve, (..., N) -> (..., N, k)


@final
class Submanifold:
    """A submanifold of R^N: the orbits of a representation, a level set, or an embedded piece of R^d.

    Make one by `orbits`, `level_set` or `embedded`.

    Examples
    --------
    The circle of latitude at height 0.8 has the curvature 0.8 / 0.6, towards the pole:

    >>> import numpy as np
    >>> import liehom as lh
    >>> from liehom.flow.steps import Submanifold, geodesic_curvature
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), [0, 0, 1])
    >>> curve = lh.steps.flow_series(field, np.array([0.6, 0.0, 0.8]), 2).points
    >>> curvature = geodesic_curvature(curve, Submanifold.orbits(field.representation)).value
    >>> round(float(np.linalg.norm(curvature)), 12), curvature.round(12).tolist()
    (1.333333333333, [-1.066666666667, 0.0, 0.8])
    """

    __slots__ = ("_columns", "_normal", "_place", "_title")

    def __init__(self, columns: Columns, *, normal: bool, place: Columns | None, title: str) -> None:
        self._columns, self._normal, self._place, self._title = columns, normal, place, title

    @classmethod
    def orbits(cls, representation: Representation) -> Submanifold:
        """The orbits of a representation; the tangent space at m is rho(g) m."""
        if not isinstance(representation, Representation):
            raise InputError(f"expected a Representation, got {displayed(representation)}")
        action = action_map(representation)

        def columns(curve: Jet) -> Jet:
            start = np.asarray(curve.value, dtype=float)
            dimension = np.unique(check_point(representation, start))
            if len(dimension) > 1:
                raise InputError(f"the orbits have the dimensions {dimension.tolist()}: take points of one dimension")
            # combinations of generators that are independent at the start, and so next to it
            right = np.linalg.svd(action.right(start), full_matrices=False)[2][..., : int(dimension[0]), :]
            along: Any = action.right(curve)
            return along @ np.swapaxes(right, -1, -2)

        return cls(columns, normal=False, place=None, title=f"orbits of {representation!r}")

    @classmethod
    def level_set(cls, f: Callable[[Any], Any], size: int) -> Submanifold:
        """The level sets of a function on R^N, or of k functions, at points where their gradients are independent.

        Parameters
        ----------
        f : callable
            f(m) of m of shape (..., N), written with numpy functions: (...,), or (..., k) for k functions.
        size : int
            N.

        Examples
        --------
        >>> import numpy as np
        >>> Submanifold.level_set(lambda m: np.sum(m * m * [1.0, 2.0, 3.0], axis=-1), 3)
        <submanifold: level set of <lambda> in R^3>
        """
        slopes = _differentiated(f, size)[1]

        def columns(curve: Jet) -> Jet:
            return _stacked([_stacked(evaluated(row, _inputs(curve))) for row in slopes])

        return cls(columns, normal=True, place=None, title=f"level set of {_name(f)} in R^{size}")

    @classmethod
    def embedded(cls, f: Callable[[Any], Any], dimension: int) -> Submanifold:
        """The image of an immersion f of (a piece of) R^d in R^N; curves are given by their coordinates in R^d.

        Parameters
        ----------
        f : callable
            f(q) of q of shape (..., d), written with numpy functions, of shape (..., N).
        dimension : int
            d.

        Examples
        --------
        >>> import numpy as np
        >>> def torus(q):
        ...     r = 2 + np.cos(q[..., 1])
        ...     return np.stack([r * np.cos(q[..., 0]), r * np.sin(q[..., 0]), np.sin(q[..., 1])], axis=-1)
        ...
        >>> Submanifold.embedded(torus, 2)
        <submanifold: image of torus in R^3>
        """
        values, slopes = _differentiated(f, dimension)

        def place(curve: Jet) -> Jet:
            return _stacked(evaluated(values, _inputs(curve)))

        def columns(curve: Jet) -> Jet:
            rows = [_stacked(evaluated(row, _inputs(curve))) for row in slopes]
            transposed: Any = np.swapaxes(_stacked(rows), -1, -2)
            return transposed

        return cls(columns, normal=False, place=place, title=f"image of {_name(f)} in R^{len(values)}")

    def curve(self, curve: Jet) -> Jet:
        """The curve in R^N of a curve in the coordinates in which the submanifold is given."""
        return curve if self._place is None else self._place(curve)

    def tangential(self, curve: Jet, v: Jet) -> Jet:
        """The orthogonal projections of the vectors v (..., N) onto the tangent spaces along a curve.

        The curve is in the coordinates in which the submanifold is given.
        """
        columns: Any = self._columns(curve)
        transposed = np.swapaxes(columns, -1, -2)
        projected = (columns @ np.linalg.solve(transposed @ columns, transposed @ v[..., None]))[..., 0]
        return v - projected if self._normal else projected

    def __repr__(self) -> str:
        return f"<submanifold: {self._title}>"


def geodesic_curvature(curve: Jet, submanifold: Submanifold) -> Jet:
    """Geodesic curvature vector along a curve of order n, a Jet of order n - 2 with values (..., N).

    Parameters
    ----------
    curve : Jet
        Of order at least 2, with velocity not 0, in the coordinates in which the submanifold is given.
    submanifold : Submanifold

    Notes
    -----
    (3.8) and (3.9) of the paper for any submanifold. The vector is tangent and orthogonal to the curve. It does not
    depend on the parametrization of the curve.

    Examples
    --------
    A meridian of a torus is a geodesic, a circle of latitude is not:

    >>> import numpy as np
    >>> import liehom as lh
    >>> def torus(q):
    ...     r = 2 + np.cos(q[..., 1])
    ...     return np.stack([r * np.cos(q[..., 0]), r * np.sin(q[..., 0]), np.sin(q[..., 1])], axis=-1)
    ...
    >>> surface = Submanifold.embedded(torus, 2)
    >>> start, along = np.array([0.0, np.pi / 2]), np.eye(2)
    >>> curves = [lh.Jet(np.stack([start, direction, 0 * direction])) for direction in along]
    >>> [round(float(np.linalg.norm(geodesic_curvature(c, surface).value)), 12) for c in curves]
    [0.5, 0.0]
    """
    n = curve.order - 2
    if n < 0:
        raise InputError(f"a curve of order {curve.order} has no curvature: take order 2 or more")
    points = submanifold.curve(curve).coefficients
    weights = np.arange(1, n + 3).reshape(-1, *[1] * (points.ndim - 1))
    first = weights * points[1:]
    velocity: Any = Jet(first[: n + 1])
    acceleration = Jet(weights[: n + 1] * first[1:])
    square = np.sum(velocity * velocity, axis=-1)[..., None]
    if not np.all(square.value > 0):
        raise InputError("the velocity of the curve vanishes: take points that are not equilibria")
    tangential: Any = submanifold.tangential(Jet(curve.coefficients[: n + 1]), acceleration)
    along = np.sum(tangential * velocity, axis=-1)[..., None] / square
    return (tangential - along * velocity) / square


def curvature_defect(flow: Jet, step: Jet, submanifold: Submanifold) -> Values:
    """The coefficient n - 2 of the difference of the geodesic curvatures of two curves of order n, shape (..., N).

    If the curves agree through order n - 1, it is 0 if and only if the step captures the orbit to order n: Lemma 2.

    Examples
    --------
    Euler's step has order 1, and captures orbits to order 2 if it is corrected:

    >>> import numpy as np
    >>> import liehom as lh
    >>> from liehom.flow.steps import Generator
    >>> field, m = lh.GeneratorField(lh.defining(lh.so(3)), ["m0", "m1*m2", "1"]), np.array([0.6, 0.48, 0.64])
    >>> flow, action = lh.steps.flow_series(field, m, 2).points, lh.Action(field.representation)
    >>> surface = Submanifold.orbits(field.representation)
    >>> def defect(step):
    ...     local = step.at(action, Generator(field, 2), m, np.zeros(1))
    ...     return float(np.abs(curvature_defect(flow, lh.steps.step_series(action, local, m, 2), surface)).max())
    ...
    >>> defect(lh.Euler()) > 0.1, defect(lh.Corrected(lh.Euler(), 2)) < 1e-13
    (True, True)
    """
    if flow.order != step.order:
        raise InputError(f"the curves have the orders {flow.order} and {step.order}, expected the same order")
    n = flow.order - 2
    first, second = (geodesic_curvature(curve, submanifold) for curve in (flow, step))
    return second.coefficient(n) - first.coefficient(n)


def _differentiated(f: Callable[[Any], Any], size: int) -> tuple[list[Expr], list[list[Expr]]]:
    """The values of a function as a graph, and their partial derivatives."""
    tape = Tape()
    inputs = Traced.inputs(tape, 0, size)
    outputs = recorded(f, _name(f), inputs)
    if np.ndim(outputs) > 1:
        raise ShapeError(f"{_name(f)} has shape {np.shape(outputs)} at a point, expected () or (k,)")
    values = [x.entry for x in np.atleast_1d(Traced(tape, outputs))]
    return values, [gradient(x, [y.entry for y in inputs]) for x in values]


def _inputs(curve: Jet) -> dict[int, Any]:
    return {i: curve[..., i] for i in range(curve.shape[-1])}


def _stacked(parts: list[Any]) -> Jet:
    """Parts, some of which may be numbers, stacked on the last axis."""
    zero: Any = next((0.0 * part for part in parts if isinstance(part, Jet)), None)
    stacked: Any = np.stack(parts if zero is None else [zero + part for part in parts], axis=-1)
    return stacked


def _name(f: Callable[[Any], Any]) -> str:
    return str(getattr(f, "__name__", type(f).__name__))


# The generator of a moving frame: isotropy chosen so that the generator carries the tangent lines of the orbits. Let
# g(t) be a curve in the group with g(t) m(0) = m(t) along an orbit of the flow. Its generator g' g^-1 = psi + zeta is
# determined up to zeta in g_m. A frame that is adapted to the curve, one with g(t) [m'(0)] = [m'(t)], asks in addition
# for
#     rho(psi + zeta) m' = m'' mod m'.
# This is the condition (*) of order 2 for Euler's step, solvable if the range condition holds. On S^2 the frame is {m,
# m'/|m'|, m x m'/|m'|}, and zeta = sigma_i m with the geodesic curvature sigma_i of the orbit.


def moving_frame_field(field: GeneratorField, *, orbit_dimension: int | None = None) -> GeneratorField:
    """The same vector field with the generator of the moving frame that is adapted to its orbits.

    Parameters
    ----------
    field : GeneratorField
    orbit_dimension : int, optional
        The dimension of all orbits on which the field is used; by default the numerical rank at each point.

    Returns
    -------
    GeneratorField
        With the generator psi + zeta, zeta in g_m, wherever (*) of order 2 has a solution, else with psi. It has none
        on strata with too little isotropy and on the cone where the range condition fails.

    Notes
    -----
    Section 8 of the paper. Euler's step with this generator captures orbits to order 2. It captures orbits of
    one-parameter subgroups exactly if (*) determines zeta, as on S^2; on S^3 it does not, and the order is 2. The
    isotropy type is constant along an orbit, so psi is chosen stratum by stratum. It is smooth along each orbit on
    which the range condition holds, and not across strata in general.

    If the inner product on g is Ad-invariant, the choice is equivariant: psi(g m) = Ad_g psi(m) for every symmetry g of
    the vector field in the group. It depends on psi only through the vector field if zeta is determined by (*), as on
    S^2.

    Examples
    --------
    The free rigid body, (4.3): both generators of the paper get the same moving frame.

    >>> import numpy as np
    >>> import liehom as lh
    >>> body, m = lh.RigidBody([1, 2, 3]), np.array([0.6, 0.48, 0.64])
    >>> basic, orthogonal = (lh.steps.moving_frame_field(body.field(kind)).psi(m) for kind in "bo")
    >>> bool(np.allclose(basic, orthogonal)), bool(np.allclose(basic, body.field("b").psi(m)))
    (True, False)
    """
    action = Action(field.representation)

    def psi(m: Values, t: Real = 0.0) -> Values:
        if isinstance(m, Jet) or is_exact(m):
            raise InputError(
                "the generator of a moving frame is computed in floats, not on series: take liehom.Corrected(step, n)"
            )
        generator = field.psi(m, t)
        dimension: int | IntegerArray | None = orbit_dimension
        if dimension is None:
            if is_lazy(m):
                raise InputError("compiled code needs orbit_dimension= of the moving frame")
            dimension = check_point(field.representation, m)
        local = LocalStep(action, m, lambda h: (h * generator,))
        recursion = OrderRecursion(action, flow_series(field, m, 2, t), local, m, orbit_dimension=dimension)
        correction = correct(recursion, 1, 2)
        zeta = correction.zeta[1]
        if zeta is None:
            return generator
        solved = (correction.reached >= 2) & (correction.leading == 1)
        return np.where(np.asarray(solved)[..., None], generator + zeta, generator)

    timed = field.time_dependent
    return GeneratorField(field.representation, psi if timed else lambda m: psi(m), time_dependent=timed)
