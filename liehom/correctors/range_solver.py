"""The linear system of Theorem 5 at a point, solved for any right-hand side.

    e rho(zeta) w_l - l c w_l = r,    zeta in g_m, c real,    e = 1/2 (1 where the correction is a factor of its own)

Scaled by |w_l|, so that it is well posed next to equilibria; in least squares where it has no solution; of several
solutions that of least |c| and then of least |zeta|, or that of least |zeta|^2 + weight^2 c^2.
Imports homogeneous, series.
"""

from __future__ import annotations

from typing import Any, final

import numpy as np

from liehom.homogeneous import Action, IsotropyFrame
from liehom.series.arrays import namespace

RANK_RTOL = 1e-8
REFINEMENTS = 2


@final
class RangeSolver:
    """The map r -> (zeta, c) at a point with a given w_l.

    Parameters
    ----------
    action : Action
    frame : IsotropyFrame
        At m.
    velocity : array of shape (..., N)
        w_l; it must not vanish where `solve` is used.
    leading : int
        l.
    factor : float
        e.
    weight : float, optional
        Relative weight of c; None is infinite: least |c| first.

    Attributes
    ----------
    singular_value : array of shape (...,)
        The d-th singular value of [e rho(g_m) w, w] / |w|: the range condition (6.2) holds where it is not 0.
    rank : array of shape (...,)
        The rank of this matrix; the range condition asks for d.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> action, m = lh.Action(lh.defining(lh.so(3))), np.array([0, 0, 1.0])
    >>> solver = RangeSolver(action, action.isotropy_frame(m, 2), np.array([1.0, 0, 0]), 1, 0.5)
    >>> zeta, c, residual = solver.solve(np.array([0.25, 0.5, 0.0]))
    >>> float(c), np.abs(zeta).round(12).tolist(), bool(abs(residual).max() < 1e-12)
    (-0.25, [1.0, 0.0, 0.0], True)
    """

    def __init__(
        self,
        action: Action,
        frame: IsotropyFrame,
        velocity: Any,
        leading: int,
        factor: float,
        weight: float | None = None,
    ) -> None:
        xp = self._xp = namespace(velocity)
        self._frame, self._leading, self._weight = frame, leading, weight
        size = xp.sqrt(xp.sum(velocity * velocity, axis=-1, keepdims=True))
        self._size = xp.where(size > 0, size, 1.0)
        unit = velocity / self._size
        down = xp.swapaxes(frame.tangent, -1, -2)
        moved = action.infinitesimal(xp.swapaxes(frame.basis, -1, -2), unit[..., None, :])
        self._moves = factor * (down @ xp.swapaxes(moved, -1, -2))
        self._unit = (down @ unit[..., None])[..., 0]
        self._down = down
        scale = factor * RANK_RTOL * action.size
        self._prepare(xp, _single(self._moves), _single(self._unit), scale)

    def _prepare(self, xp: Any, moves: Any, unit: Any, scale: float) -> None:
        full = xp.concatenate([moves, unit[..., None]], axis=-1)
        values = xp.linalg.svd(full, compute_uv=False)
        self.rank = (values > scale).sum(axis=-1)
        self.singular_value = _entry(xp, values, self._frame.orbit_dimension)
        if self._weight is not None:
            full = xp.concatenate([moves, -self._leading * unit[..., None] / self._weight], axis=-1)
            self._inverse = _pseudo_inverse(xp, full, scale)
            return
        left, values, right = xp.linalg.svd(moves, full_matrices=False)
        kept = values > scale
        left = left * kept[..., None, :]
        inverse = xp.where(kept, 1 / xp.where(kept, values, 1.0), 0.0)
        self._inverse = xp.swapaxes(right, -1, -2) @ (inverse[..., :, None] * xp.swapaxes(left, -1, -2))
        rest = unit - (left @ (xp.swapaxes(left, -1, -2) @ unit[..., None]))[..., 0]
        square = xp.sum(rest * rest, axis=-1, keepdims=True)
        seen = square > RANK_RTOL
        self._rest = xp.where(seen, rest / xp.where(seen, square, 1.0), 0.0)

    def solve(self, right: Any) -> tuple[Any, Any, Any]:
        """zeta (..., dim g), c (...,) and the residual r - (e rho(zeta) w - l c w), tangential, shape (..., N)."""
        target = (self._down @ (right / self._size)[..., None])[..., 0]
        zeta, c, residual = self._once(target)
        for _ in range(REFINEMENTS if target.dtype == np.longdouble else 0):
            more, extra, residual = self._once(residual)
            zeta, c = zeta + more, c + extra
        lifted = (self._frame.tangent @ (residual * self._size)[..., None])[..., 0]
        return (self._frame.basis @ zeta[..., None])[..., 0], c, lifted

    def _once(self, target: Any) -> tuple[Any, Any, Any]:
        if self._weight is None:
            c = -self._xp.sum(self._rest * target, axis=-1) / self._leading
            moved = target + self._leading * c[..., None] * self._unit
            zeta = (self._inverse @ moved[..., None])[..., 0]
        else:
            both = (self._inverse @ target[..., None])[..., 0]
            zeta, c = both[..., :-1], both[..., -1] / self._weight
            moved = target + self._leading * c[..., None] * self._unit
        return zeta, c, moved - (self._moves @ zeta[..., None])[..., 0]


def _entry(xp: Any, values: Any, d: Any) -> Any:
    """values[d - 1], 0 where there are fewer."""
    wide = xp.concatenate([0 * values[..., :1], values], axis=-1)
    index = np.where(d <= values.shape[-1], d, 0)
    return xp.take_along_axis(wide, np.broadcast_to(index, wide.shape[:-1])[..., None], axis=-1)[..., 0]


def _single(x: Any) -> Any:
    """The precision in which linear algebra is available."""
    return x.astype(np.float64) if x.dtype == np.longdouble else x


def _pseudo_inverse(xp: Any, a: Any, cutoff: float) -> Any:
    left, values, right = xp.linalg.svd(a, full_matrices=False)
    kept = values > cutoff
    inverse = xp.where(kept, 1 / xp.where(kept, values, 1.0), 0.0)
    return xp.swapaxes(right, -1, -2) @ (inverse[..., :, None] * xp.swapaxes(left, -1, -2))
