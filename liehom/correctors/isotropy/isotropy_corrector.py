"""The order-n isotropy corrector: Theorem 5 iterated to any order, with its clock (time reparametrization) tau.

Let the step agree with the reparametrized flow F_tau(t) through order n - 1, with w_l the leading coefficient of the
flow.  Then zeta t^(n-l) in the generator, zeta in g_m, and c t^(n-l+1) in tau change the difference at order n by

    e rho(zeta) w_l - l c w_l,    which is set equal to    r = [t^n] (F_tau - step),

so that the step agrees with the new F_tau through order n.  This is done for n = p + 1, p + 2, ... and raises a step of
order p to any order.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import final

import numpy as np
from numpy.typing import ArrayLike

from liehom.correctors.isotropy.order_by_order import OrderRecursion, Part, norm
from liehom.correctors.isotropy.range_solver import RangeSolver, TightFrameSolver
from liehom.correctors.step import ExponentialLike, Generator, LocalStep, Step
from liehom.errors import InputError
from liehom.homogeneous import Action, GeneratorField
from liehom.homogeneous.fields.field import check_point
from liehom.series.arrays import as_values, is_exact, namespace
from liehom.typing import BooleanArray, IntegerArray, Real, Values


@final
@dataclass(frozen=True, slots=True)
class Correction:
    """Isotropy correction at a point: coefficients, order reached, residual.

    Attributes
    ----------
    zeta : tuple
        Coefficients k = 0, 1, ... of the isotropy correction, shape (..., dim g), or None. They include terms of the
        flow's own generator where isotropy does not enter (see `liehom.correctors.isotropy.completion`).
    clock : tuple
        Coefficients k = 0, 1, ... of tau, shape (...,), or None; clock[1] = 1.
    leading : array of shape (...,)
        l, the order of the first non-zero coefficient of the flow; 0 at an equilibrium.
    reached : array of shape (...,)
        The order to which the corrected step captures the orbit.
    residual : array of shape (...,)
        The largest of the relative residuals of the linear systems.
    defects : tuple
        (k, array): the norm of [t^k] (F_tau - corrected step), for the k at which it need not be 0.
    parts : tuple of Part
        The linear systems, one for each leading order in the ensemble.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(3)), lambda m: m * [1.0, 2.0, 3.0])
    >>> found = lh.correction(field, lh.Euler(), np.array([0.6, 0.0, 0.8]), order=3)
    >>> int(found.reached), bool(found.residual < 1e-10)
    (3, True)
    """

    zeta: tuple[Values | None, ...]
    clock: tuple[Values | None, ...]
    leading: Values
    reached: Values
    residual: Values
    defects: tuple[tuple[int, Values], ...]
    parts: tuple[Part, ...] = field(repr=False)

    @property
    def singular_value(self) -> Values:
        """Smallest singular value that decides the range condition (6.2) at the point, shape (...,).

        It is infinite at an equilibrium.
        """
        return self._of_parts("singular_value", np.inf)

    @property
    def rank(self) -> Values:
        """Rank that must be the dimension of the orbit for (6.2) to hold, shape (...,); 0 at an equilibrium."""
        return self._of_parts("rank", 0)

    @property
    def always_solvable(self) -> bool:
        """Whether every linear system has a solution, because the orbits have a tight frame."""
        return all(isinstance(part.solver, TightFrameSolver) for part in self.parts)

    def near_cone(self, h: Values) -> BooleanArray:
        """Whether the cone on which the range condition fails is within two steps of size h, bool (...,); cf. Notes.

        Parameters
        ----------
        h : array of shape (...,)
            Signed step sizes.

        Notes
        -----
        To first order in h, forwards and backwards: `RangeSolver.is_near_cone` with the change h rho(psi_1) m of the
        velocity. Equilibria, orbits with a tight frame (where there is no cone) and points at which isotropy makes only
        a fraction of the correction count as far from it.

        Examples
        --------
        >>> import numpy as np
        >>> import liehom as lh
        >>> field = lh.GeneratorField(lh.defining(lh.so(2, 1)), ["1", "1/4 + m1", "0"])
        >>> found = lh.correction(field, lh.Euler(), np.array([1.0, 0.0, 0.0]), order=3)
        >>> [bool(found.near_cone(np.array(h))) for h in (0.25, 0.75)]
        [False, True]
        """
        xp = namespace(self.residual)
        near: BooleanArray = xp.zeros(xp.shape(self.residual), dtype=bool)
        for part in self.parts:
            if part.drift is None or not isinstance(part.solver, RangeSolver):
                continue
            found = part.solver.is_near_cone(part.drift * h[..., None])
            if part.fraction is not None:
                found = found & (part.fraction == 1)
            near = near | (found if part.here is None else found & part.here)
        return near

    def _of_parts(self, name: str, otherwise: float) -> Values:
        xp = namespace(self.residual)
        found = xp.full(xp.shape(self.residual), otherwise)
        for part in [part for part in self.parts if part.solver is not None]:
            value = getattr(part.solver, name)
            found = value if part.here is None else xp.where(part.here, value, found)
        made: Values = found
        return made

    def generator(self, h: Values) -> Values | None:
        """The sum of zeta_k h^k for h of shape (..., 1), array or Jet; None if there is no correction."""
        return _polynomial(self.zeta, h)

    def time(self, h: Values) -> Values:
        """Time tau(h) that passes in the step, for h of shape (...,)."""
        made = _polynomial(self.clock, h)
        return h if made is None else made


def _polynomial(coefficients: tuple[Values | None, ...], h: Values) -> Values | None:
    """Value at h of a polynomial, by Horner's rule; coefficients None are 0, coefficient 0 is None."""
    total: Values | None = None
    for x in reversed(coefficients):
        if total is not None:
            total = total * h
        if x is not None:
            total = x if total is None else total + x
    return total


def correction(
    field: GeneratorField,
    step: Step,
    m: ArrayLike,
    order: int,
    *,
    t: Real = 0.0,
    exponential: ExponentialLike = "exp",
    weight: float | None = None,
) -> Correction:
    """`Correction` that raises a step to a given order at a point: coefficients of zeta and of the clock tau.

    Parameters
    ----------
    field : GeneratorField
    step : Step
        The base, of order p.
    m : array_like of shape (..., N)
    order : int
    t : float or array of shape (...,)
    exponential : str, Exponential or callable
    weight : float, optional
        See `Corrected`.

    Raises
    ------
    ShapeError, InputError
        If m is not a point on an orbit of positive dimension.

    Notes
    -----
    Theorem 5 of the paper, with the factor 1/2 and the clock of docs/notation.md.

    Examples
    --------
    The correction of Euler's step on the sphere, (3.5) of the paper: sigma_i = <omega', m x omega>/|omega|^2

    >>> import numpy as np
    >>> import liehom as lh
    >>> inertia, m = np.array([1.0, 2.0, 3.0]), np.array([0.6, 0.48, 0.64])
    >>> rho = lh.Representation.from_matrices([[[0, 0, 0], [0, 0, -1], [0, 1, 0]],
    ...     [[0, 0, 1], [0, 0, 0], [-1, 0, 0]], [[0, -1, 0], [1, 0, 0], [0, 0, 0]]])
    >>> field = lh.GeneratorField(rho, lambda m: -m / inertia + np.sum(m * m / inertia, -1, keepdims=True) * m)
    >>> x = np.cross(m, m / inertia)
    >>> sigma = x @ (x / inertia) / (x @ x) - m @ (m / inertia)
    >>> found = correction(field, lh.Euler(), m, 2)
    >>> bool(np.allclose(found.zeta[1], sigma * m))
    True
    """
    point = as_values(m)
    if is_exact(point):
        raise InputError(
            "corrections are computed in floats: give the point in floats, or use liehom.correctors.order_condition"
        )
    dimension = check_point(field.representation, point)
    action = Action(field.representation, exponential)
    local = step.at(action, Generator(field, dimension), point, np.asarray(t)[..., None])
    return correct(
        action,
        field,
        local,
        point,
        t,
        base_order=step.order,
        order=order,
        orbit_dimension=dimension,
        weight=weight,
        one_exponential=step.one_exponential,
    )


def correct(
    action: Action,
    field: GeneratorField,
    local: LocalStep,
    m: Values,
    t: Real,
    *,
    base_order: int,
    order: int,
    orbit_dimension: int | IntegerArray,
    weight: float | None = None,
    one_exponential: bool = True,
    error_terms: int = 0,
) -> Correction:
    """`Correction` that raises a step from `base_order` to `order` at a point.

    Parameters
    ----------
    action, field
    local : LocalStep
        The base step at (m, t).
    m : array of shape (..., N)
    t : float or array of shape (...,)
    base_order, order : int
    orbit_dimension : int or array of shape (...,)
    weight : float, optional
        See `RangeSolver`.
    one_exponential : bool
        Whether the correction is added to the generator (e = 1/2) or is an outermost factor (e = 1).
    error_terms : int
        Number of coefficients beyond `order` to compute for `defects`.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(3)), lambda m: m * [1.0, 2.0, 3.0])
    >>> action, m = lh.Action(field.representation), np.array([0.6, 0.0, 0.8])
    >>> local = lh.Euler().at(action, Generator(field, 2), m, 0.0)
    >>> int(correct(action, field, local, m, 0.0, base_order=1, order=2, orbit_dimension=2).reached)
    2
    """
    recursion = OrderRecursion(
        action,
        field,
        local,
        m,
        t,
        total=order + error_terms,
        orbit_dimension=orbit_dimension,
        one_exponential=one_exponential,
        weight=weight,
    )
    for n in range(base_order + 1, order + 1):
        recursion.level(n)
    for k in range(order + 1, recursion.total + 1):
        recursion.defects.append((k, norm(recursion.xp, recursion.difference(k))))
    reached = recursion.xp.maximum(recursion.levels, base_order)
    leading = recursion.leading if recursion.moving is None else recursion.xp.where(recursion.moving, 1, 0)
    return Correction(
        tuple(recursion.zeta.node.known[: order + 1]),
        tuple(recursion.clock.coefficients[: order + 1]),
        leading,
        recursion.xp.where(leading == 0, order, reached),  # an equilibrium does not move
        recursion.residual,
        tuple(recursion.defects),
        tuple(recursion.parts),
    )
