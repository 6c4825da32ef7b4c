"""The updates of Figure 6 for the rigid body, each a base scheme on a generator, with or without a correction.

    name = scheme_variant: scheme eul, rk2, sy4, rk4; variant b or o (the generator omega_b or omega_o), preceded by i
    if isotropy raises the order of the energy by one (eul_i: on omega_o)

Time is nominal: the correction raises the order of energy and orbits, and trajectories have the order of the base.
"""

from __future__ import annotations

from typing import Any, NamedTuple, final

import numpy as np
import numpy.typing as npt

from liehom.correctors.isotropy.corrected import Corrected
from liehom.correctors.step import ExponentialLike, Generator, Step
from liehom.errors import InputError, ShapeError
from liehom.homogeneous import Action, GeneratorField
from liehom.instances.rigid_body.free_body import FreeBody
from liehom.instances.rigid_body.nominal_time_corrected import GeneratorTaylor, NominalTimeCorrected
from liehom.integrators.methods.rkmk import RKMK
from liehom.integrators.methods.steps import Euler, Heun, LieTaylor
from liehom.integrators.points import points_of
from liehom.typing import Array


class Orders(NamedTuple):
    """Global orders of the energy and of the solution on a triaxial body."""

    energy: int
    solution: int


ORDERS: dict[str, Orders] = {
    "eul_b": Orders(1, 1),
    "eul_o": Orders(1, 1),
    "eul_i": Orders(2, 1),
    "rk2_b": Orders(3, 2),
    "rk2_o": Orders(3, 2),
    "rk2_ib": Orders(4, 2),
    "rk2_io": Orders(4, 2),
    "sy4_b": Orders(4, 4),
    "sy4_o": Orders(4, 4),
    "sy4_ib": Orders(5, 4),
    "sy4_io": Orders(5, 4),
    "rk4_b": Orders(4, 4),
    "rk4_o": Orders(4, 4),
    "rk4_ib": Orders(5, 4),
    "rk4_io": Orders(5, 4),
}


def update_names() -> tuple[str, ...]:
    """Names of the updates, a tuple of strings: the 13 of Figure 6, then rk4_ib and rk4_io.

    Examples
    --------
    >>> update_names()[:3], len(update_names())
    (('eul_b', 'eul_o', 'eul_i'), 15)
    """
    return tuple(ORDERS)


def checked_name(name: str) -> str:
    """The name, if an update has this name.

    Raises
    ------
    InputError
        If no update has this name.

    Examples
    --------
    >>> checked_name("rk5")
    Traceback (most recent call last):
    ...
    liehom.errors.InputError: no update is called 'rk5', expected one of eul_b, eul_o, eul_i, rk2_b, ...
    """
    if name not in ORDERS:
        raise InputError(f"no update is called {name!r}, expected one of {', '.join(ORDERS)}")
    return name


def scheme(name: str, *, cayley: bool = True) -> tuple[str, Step]:
    """The generator ("b" or "o") and the step of an update.

    With the true exponential sy4_o is LieTaylor(4) on omega_o. With Cayley the paper chooses another isotropy, for
    which the conditions of order 4 hold with xi_4 = omega''' + 3 <omega', omega> omega (`NominalTimeCorrected`).

    Examples
    --------
    >>> scheme("sy4_ib"), scheme("sy4_o")
    (('b', Corrected(LieTaylor(n=4), order=5)), ('o', NominalTimeCorrected(GeneratorTaylor(n=4), order=4)))
    """
    method, variant = checked_name(name).split("_")
    kind = "b" if variant.endswith("b") else "o"
    bases: dict[str, Step] = {"eul": Euler(), "rk2": Heun(), "sy4": LieTaylor(4), "rk4": RKMK("rk4")}
    base = (
        NominalTimeCorrected(GeneratorTaylor(4), 4) if (method, kind, cayley) == ("sy4", "o", True) else bases[method]
    )
    # corrected to capture orbits to the order of the energy
    return kind, Corrected(base, ORDERS[name].energy) if "i" in variant else base


@final
class Update:
    """An update m -> Exp(xi(m, dt)) m of the rigid body by the generic code, called as update(m, dt).

    Parameters
    ----------
    body : RigidBody
    name : str
        See `update_names`.
    exponential : str, Exponential or callable
        "cayley" or "exp": see `liehom.homogeneous.exponential_of`.

    Attributes
    ----------
    name : str
    step : Step
        The base scheme, or `Corrected` of it.
    field : GeneratorField
        The field with the generator omega_b or omega_o.
    orders : (energy, solution)
        Global orders on a triaxial body.

    Raises
    ------
    InputError
        If no update has this name; in a call, at m = 0.

    Notes
    -----
    Figure 6 and section 4 of the paper. The correction needs sigma at t^(n-1), the highest power that matters. At lower
    powers sigma is zero up to round-off, because the energy of the base is right there.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> update = lh.instances.RigidBody([1, 2, 3]).update("eul_i")
    >>> update.orders, update(np.array([[0.6, 0.0, 0.8], [0.0, 0.6, 0.8]]), [0.1, 0.2]).shape
    (Orders(energy=2, solution=1), (2, 3))
    """

    body: FreeBody
    name: str
    step: Step
    orders: Orders

    def __init__(self, body: FreeBody, name: str, exponential: ExponentialLike = "cayley") -> None:
        self.body, self.name = body, checked_name(name)
        self._action = Action(body.representation, exponential)
        kind, self.step = scheme(name, cayley=self._action.exponential.name.startswith("Cayley"))
        self.field: GeneratorField = body.field(kind)
        self.orders = ORDERS[name]

    def __call__(self, m: npt.ArrayLike, dt: npt.ArrayLike) -> Array:
        """The next point, shape (..., 3), for m (..., 3) and step sizes dt (...,)."""
        point = _off_the_origin(points_of(m))
        after: Any = self._action.act(self._generator(point, dt), point)
        new: Array = after
        return new

    def generator(self, m: npt.ArrayLike, dt: npt.ArrayLike) -> Array:
        """xi(m, dt), shape (..., 3)."""
        return self._generator(_off_the_origin(points_of(m)), dt)

    def _generator(self, m: Array, dt: npt.ArrayLike) -> Array:
        h = step_sizes(dt, m)
        local = self.step.at(self._action, Generator(self.field, 2), m, np.zeros_like(h))
        found: Any = local.factors(h)[0]
        xi: Array = found
        return xi

    def __repr__(self) -> str:
        return f"<update {self.name} with {self._action.exponential.name}: {self.step!r}>"


def step_sizes(dt: npt.ArrayLike, m: Array) -> Array:
    """Step sizes (..., 1) in the floating type of the points m (..., 3).

    Examples
    --------
    >>> import numpy as np
    >>> step_sizes(0.1, np.zeros((2, 3))).shape
    (2, 1)
    """
    sizes = np.asarray(dt, dtype=m.dtype)
    try:
        return np.broadcast_to(sizes, m.shape[:-1])[..., None].copy()
    except ValueError:
        raise ShapeError(
            f"dt has shape {sizes.shape}, expected that of the leading axes of m, {m.shape[:-1]}"
        ) from None


def _off_the_origin(m: Array) -> Array:
    """The points, if none of them is 0."""
    if not bool(np.all(np.any(m != 0, axis=-1))):
        raise InputError("the group leaves m = 0 fixed: leave such points out, they do not move")
    return m
