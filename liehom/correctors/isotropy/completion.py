"""Corrections by terms of the flow's own generator, near zeros of a time-dependent field.

Let w_l be the leading coefficient at (m, t).  At orders n <= l isotropy does not enter.  If w_l is small compared with
the later w_k, as shortly after a time at which the field vanishes, zeta and c are series in h / t_1 with

    t_1 = min over k > l of (l |w_l| / (k |w_k|))^(1/(k-l)),    the time in which the velocity changes by itself,

so they are useful only for steps h << t_1.  Therefore t_1 is compared with the time scale 1/rate of the generator,
rate = max_k |psi_k|^(1/(k+1)).  Isotropy makes the fraction s(rate t_1) of each correction, where s = 0 up to 1/4,
s = 1 from 1/2 on, and s is smooth between.  The rest of the correction at order n is a term x t^n of the generator, as
in a Taylor step, where rho(x) m is the remaining difference.
"""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np

from liehom.correctors.expansion import Flow
from liehom.homogeneous import Action, IsotropyFrame
from liehom.series.arrays import namespace
from liehom.typing import Values

NO_ISOTROPY_UP_TO, ONLY_ISOTROPY_FROM = 1 / 4, 1 / 2
"""Values of rate t_1, without unit, between which the fraction of isotropy grows from 0 to 1."""
REFINEMENTS = 2


def isotropy_fraction(action: Action, flow: Flow, leading: int, order: int) -> Values:
    """Fraction s(rate t_1) of each correction that isotropy makes, shape (...,).

    Parameters
    ----------
    action : Action
    flow : Flow
        At least to this order.
    leading : int
        l >= 1.
    order : int
        The last k.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> from liehom.correctors.expansion import flow_series
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["t"])
    >>> times = np.array([0.0, 0.01, 0.3, 1.0])
    >>> flow = flow_series(field, np.ones((4, 1)) * [1.0, 0.0], 3, times)
    >>> isotropy_fraction(lh.Action(field.representation), flow, 1, 3).round(3).tolist()
    [0.0, 0.0, 0.383, 1.0]
    """
    xp = namespace(flow.points.value)
    first = leading * _norm(xp, flow.point(leading))
    scale: Any = xp.zeros_like(first) + np.inf
    for k in range(leading + 1, order + 1):
        later = k * _norm(xp, flow.point(k))
        ratio = xp.where(later > 0, first / xp.where(later > 0, later, 1.0), np.inf)
        scale = xp.minimum(scale, ratio ** (1 / (k - leading)))
    rate: Any = xp.zeros_like(first)
    for k in range(order):
        rate = xp.maximum(rate, generator_norm(action, flow.psi(k)) ** (1 / (k + 1)))
    product = xp.where(rate > 0, rate * xp.minimum(scale, 1 / xp.where(rate > 0, rate, 1.0)), 1.0)
    x = xp.clip((product - NO_ISOTROPY_UP_TO) / (ONLY_ISOTROPY_FROM - NO_ISOTROPY_UP_TO), 0.0, 1.0)
    found: Values = x * x * (3 - 2 * x)
    return found


def generator_norm(action: Action, x: Values) -> Values:
    """Upper bound of the norm of rho(x) for x (..., dim g), shape (...,).

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> round(float(generator_norm(lh.Action(lh.defining(lh.so(3))), np.array([0.6, 0.0, 0.8]))), 12)
    1.414213562373
    """
    xp = namespace(x)
    square = xp.einsum("...a,ab,...b->...", x, xp.asarray(action.inner_product.matrix), x)
    found: Values = action.max_norm * xp.sqrt(xp.maximum(square, 0.0))
    return found


def lifted(action: Action, frame: IsotropyFrame, m: Values, tangent: Values) -> Values:
    """The smallest generator x with rho(x) m = a given tangent vector, shape (..., dim g).

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> action, m = lh.Action(lh.defining(lh.so(2))), np.array([2.0, 0.0])
    >>> lifted(action, action.isotropy_frame(m, 1), m, np.array([0.0, 1.0])).tolist()
    [0.5]
    """
    xp = namespace(m)
    down = xp.swapaxes(frame.tangent, -1, -2)
    x = (frame.lift @ (down @ tangent[..., None]))[..., 0]
    for _ in range(REFINEMENTS if tangent.dtype == np.longdouble else 0):  # the frame is of double precision
        missing = tangent - action.infinitesimal(x, m)
        x = x + (frame.lift @ (down @ missing[..., None]))[..., 0]
    found: Values = x
    return found


def _norm(xp: ModuleType, x: Values) -> Values:
    found: Values = xp.sqrt(xp.sum(x * x, axis=-1))
    return found
