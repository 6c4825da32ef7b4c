"""The generator of a moving frame: isotropy chosen so that the generator carries the tangent lines of the orbits.

Let g(t) be a curve in the group with g(t) m(0) = m(t) along an orbit of the flow.  Its generator g' g^-1 = psi + zeta
is determined up to zeta in g_m.  A frame that is adapted to the curve, one with g(t) [m'(0)] = [m'(t)], asks in
addition for

    rho(psi + zeta) m' = m'' mod m'.

This is the condition (*) of order 2 for Euler's step, solvable if the range condition holds.  On S^2 the frame is
{m, m'/|m'|, m x m'/|m'|}, and zeta = sigma_i m with the geodesic curvature sigma_i of the orbit.
"""

from __future__ import annotations

import numpy as np

from liehom.correctors.isotropy.isotropy_corrector import correct
from liehom.correctors.step import LocalStep
from liehom.errors import InputError
from liehom.homogeneous import Action, GeneratorField
from liehom.homogeneous.fields.field import check_point
from liehom.series.arrays import is_exact, is_lazy
from liehom.series.jet import Jet
from liehom.typing import IntegerArray, Real, Values


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

    Raises
    ------
    InputError
        On evaluation on series and exact numbers: the frame is computed in floats.

    Notes
    -----
    Section 8 of the paper. Euler's step with this generator captures orbits to order 2, and exactly if they are orbits
    of one-parameter subgroups. The isotropy type is constant along an orbit, so psi is chosen stratum by stratum. It is
    smooth along each orbit on which the range condition holds, and not across strata in general.

    If the inner product on g is Ad-invariant, the choice is equivariant: psi(g m) = Ad_g psi(m) for every symmetry g of
    the vector field in the group. It depends on psi only through the vector field if zeta is determined by (*), as on
    S^2.

    Examples
    --------
    The free rigid body, (4.3): both generators of the paper get the same moving frame.

    >>> import numpy as np
    >>> import liehom as lh
    >>> body, m = lh.RigidBody([1, 2, 3]), np.array([0.6, 0.48, 0.64])
    >>> basic, orthogonal = (lh.moving_frame_field(body.field(kind)).psi(m) for kind in "bo")
    >>> bool(np.allclose(basic, orthogonal)), bool(np.allclose(basic, body.field("b").psi(m)))
    (True, False)
    """
    action = Action(field.representation)

    def psi(m: Values, t: Real = 0.0) -> Values:
        if isinstance(m, Jet) or is_exact(m):
            raise InputError(
                "the generator of a moving frame is computed in floats, not on series: take liehom.Corrected(step, n)"
            )
        given = field.psi(m, t)
        dimension: int | IntegerArray | None = orbit_dimension
        if dimension is None:
            if is_lazy(m):
                raise InputError("compiled code needs orbit_dimension= of the moving frame")
            dimension = check_point(field.representation, m)
        local = LocalStep(action, m, lambda h: (h * given,))
        found = correct(action, field, local, m, t, base_order=1, order=2, orbit_dimension=dimension)
        zeta = found.zeta[1]
        if zeta is None:
            return given
        solved = (found.reached >= 2) & (found.leading == 1)
        made: Values = np.where(np.asarray(solved)[..., None], given + zeta, given)
        return made

    if field.time_dependent:
        return GeneratorField(field.representation, psi, time_dependent=True)
    return GeneratorField(field.representation, lambda m: psi(m), time_dependent=False)
