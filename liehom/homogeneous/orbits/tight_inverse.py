"""The inverse of x -> rho(x) m in closed form, on orbits on which all its singular values agree.

Let K be an invariant symmetric form on V and G the inner product on g, with A = [rho(e_1) m, ..., rho(e_r) m]. If

    A G^-1 A^T K A = lambda A,      lambda = tr(A G^-1 A^T K) / d,      d the dimension of the orbit,

then B = G^-1 A^T K / lambda is a right inverse of A on the tangent space, and B A is the projector along the isotropy
algebra. This is so if the isotropy acts irreducibly on the tangent space, as on spheres, projective spaces and other
irreducible symmetric orbits.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from liehom.homogeneous.orbits.quadrics import MAX_BLOCK, invariant_form
from liehom.homogeneous.space import Action
from liehom.tracing.array import Traced
from liehom.typing import Array, Values

TIGHT_RTOL = 1e-11
"""Largest defect of the condition, relative to lambda and the largest entry of A."""
SAMPLES = 16
"""Number of points that are moved along their orbits, if the inner product on g is not invariant."""


class TightInverse(NamedTuple):
    """Data of B = G^-1 A^T K / lambda.

    Attributes
    ----------
    form : array of shape (N, N)
        K.
    gram_inverse : array of shape (dim g, dim g)
        G^-1.
    trace : array of shape (N, N)
        The form m -> tr(A G^-1 A^T K) / d, which is lambda.
    constant : bool
        Whether lambda is constant along orbits.
    """

    form: Array
    gram_inverse: Array
    trace: Array
    constant: bool

    def over(self, m: Values) -> Values:
        """1 / lambda at points m (..., N), shape (...,); for a tracer a constant of the trajectory if it is one."""
        trace = self.trace

        def inverse(points: Values) -> Values:
            found: Values = 1.0 / ((points @ trace) * points).sum(axis=-1)
            return found

        if self.constant and isinstance(m, Traced):
            return Traced(m.tape, m.tape.trajectory_constant(inverse))
        return inverse(m)

    def lifted(self, action: Action, m: Values, v: Values, over: Values) -> Values:
        """B v at the point m, shape (..., dim g), for v of shape (..., N) and 1 / lambda of shape (...,)."""
        pulled = action.infinitesimal.right_transposed(m, v @ self.form)
        made: Values = (pulled @ self.gram_inverse) * over[..., None]
        return made


def tight_inverse(action: Action, points: Array, rank: int) -> TightInverse | None:
    """The inverse on the orbits of points, all of one dimension, or None if it has no closed form.

    Parameters
    ----------
    action : Action
    points : array of shape (..., N)
    rank : int
        The dimension of the orbits.

    Examples
    --------
    >>> import liehom as lh
    >>> action, line = lh.Action(lh.sym_conjugation(3)), np.array([[1.0, 0, 0, 1, 0, 2]])  # a projective plane
    >>> made = tight_inverse(action, line, 2)
    >>> x = made.lifted(action, line, action.infinitesimal([[1.0, 2.0, 3.0]], line), made.over(line))
    >>> x.round(12).tolist()  # without the isotropy
    [[0.0, 2.0, 3.0]]
    >>> tight_inverse(action, np.array([[1.0, 0, 0, 2, 0, 3]]), 3) is None
    True
    """
    size = action.representation.size
    flat = points.reshape(-1, size)
    if rank < 1 or not len(flat) or size > MAX_BLOCK:
        return None
    matrices = np.array([a.to_numpy() for a in action.representation.matrices])
    form = invariant_form(matrices / max(float(np.abs(matrices).max(initial=0.0)), 1e-300))
    if form is None:
        return None
    gram_inverse = np.linalg.inv(action.inner_product.matrix).astype(np.float64)
    corners = np.asarray(action.infinitesimal.right(np.eye(size)))
    trace = (corners @ gram_inverse).reshape(size, -1) @ (form.T @ corners).reshape(size, -1).T / rank
    made = TightInverse(form, gram_inverse, (trace + trace.T) / 2, action.inner_product.invariant)
    if not made.constant:
        rows = np.arange(max(len(flat), SAMPLES)) % len(flat)
        x = np.random.default_rng(0).normal(size=(len(rows), action.dimension)) / max(1.0, action.max_norm)
        flat = np.concatenate([flat, np.asarray(action.act(x, flat[rows]))])
    return made if _holds(action, made, flat) else None


def _holds(action: Action, made: TightInverse, points: Array) -> bool:
    """Whether A G^-1 A^T K A = lambda A at points (L, N), to round-off."""
    columns = action.infinitesimal.right(points)
    scale = ((points @ made.trace) * points).sum(axis=-1)[:, None, None]
    twice = columns @ made.gram_inverse @ np.swapaxes(columns, 1, 2) @ made.form @ columns
    defect = np.abs(twice - scale * columns).max(axis=(1, 2), initial=0.0)
    return bool((defect <= TIGHT_RTOL * np.abs(scale[:, 0, 0]) * np.abs(columns).max(axis=(1, 2), initial=0.0)).all())
