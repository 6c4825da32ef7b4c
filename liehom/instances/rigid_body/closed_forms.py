"""Updates of the rigid body in closed form: the base schemes and corrections as formulas.

At n = m/|m| with the step size |m| dt (the field is quadratic), X = n x Om n, v = |X|, h = <n, Om n>, k = <n, Om^2 n>,

    R = <X, Om X>/v^2,   D = <X, Om^2 n>,   q = D/v^2,   sigma_i = R - h = det(h - Om)/v^2

and e_1, e_2, e_3 the elementary symmetric functions of Om. At X = 0, R = h and q = 0.
"""

from __future__ import annotations

from math import factorial
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.errors import InputError
from liehom.homogeneous import Action
from liehom.instances.rigid_body.free_body import FreeBody
from liehom.instances.rigid_body.updates import checked_name, scheme, step_sizes
from liehom.instances.spheres.sphere import dot
from liehom.integrators.points import points_of
from liehom.typing import Array, Values


@final
class Ingredients:
    """The numbers in the closed forms, at unit vectors n (..., 3).

    Attributes
    ----------
    h, k, v2, R, D, q : arrays of shape (..., 1)
        See the formulas of this module; v2 is v^2.
    X : array of shape (..., 3)
    e : (e_1, e_2, e_3)

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> found = Ingredients(lh.instances.RigidBody([1, 2, 3]), np.array([0.6, 0.48, 0.64]))
    >>> bool(np.allclose(found.sigma_i, found.R - found.h))
    True
    """

    body: FreeBody
    n: Values
    h: Values
    v2: Values
    k: Values
    q: Values
    e: tuple[Any, Any, Any]

    def __init__(self, body: FreeBody, n: Values) -> None:
        self.body, self.n = body, n
        once = body.apply(n)
        self.h = dot(n, once)
        orthogonal = once - self.h * n  # X and D are then relatively accurate next to equilibria
        self.X = np.cross(n, orthogonal)
        self.v2 = dot(self.X, self.X)
        twice = body.apply(once)
        self.k = dot(n, twice)
        self.D = dot(self.X, twice - self.k * n)
        moves = self.v2 > 0
        below = np.where(moves, self.v2, 1)
        self.R = np.where(moves, dot(self.X, body.apply(self.X)) / below, self.h)
        self.q = np.where(moves, self.D / below, 0)
        self.e = body.invariants(n.dtype.type)

    @property
    def sigma_i(self) -> Any:
        """R - h, (4.3), shape (..., 1)."""
        return self.R - self.h

    def derivatives(self, kind: str, count: int) -> list[Any]:
        """The first `count` of omega, omega', ... along the flow, for omega_b ("b") or omega_o ("o").

        Examples
        --------
        >>> import numpy as np
        >>> import liehom as lh
        >>> found = Ingredients(lh.instances.RigidBody([1, 2, 4]), np.array([0.6, 0.0, 0.8]))
        >>> found.derivatives("b", 2)[1].tolist()
        [0.0, -0.18, 0.0]
        """
        points: list[Any] = [self.n]
        for n in range(count - 1):
            total = sum(
                factorial(n) // (factorial(i) * factorial(n - i)) * np.cross(points[i], self.body.apply(points[n - i]))
                for i in range(n + 1)
            )
            points.append(total)
        return [-self.body.apply(x) + (self.h * x if kind == "o" else 0) for x in points]


def improvement(name: str, exponential: str, at: Ingredients) -> tuple[int, Any]:
    """(p, sigma), where dt^p sigma m is the difference of an update with i from its base (section 4 of the paper).

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> at = Ingredients(lh.instances.RigidBody([1, 2, 3]), np.array([0.6, 0.48, 0.64]))
    >>> power, sigma = improvement("rk2_ib", "cayley", at)
    >>> power, bool(np.allclose(sigma, (at.e[1] * at.R - at.e[2]) / 4))
    (3, True)
    """
    e1, e2, e3 = at.e
    h, k, v2, q, D, sigma_i = at.h, at.k, at.v2, at.q, at.D, at.sigma_i
    exp = exponential == "exp"
    if name == "eul_i":
        return 1, sigma_i
    if name == "rk2_ib":
        return 3, (e2 * at.R - e3) / 4
    if name == "rk2_io":
        return 3, (3 * v2 + 3 * h**2 - 2 * e1 * h + e2) * sigma_i / 4
    if name == "sy4_ib":
        if exp:
            return 4, q * (5 * e1 * h**2 - 4 * e2 * h + 3 * e3 - 6 * h * k) / 24
        return 4, q * (3 * e1 * h**2 - 2 * e2 * h + e3 - 3 * h * k) / 24
    if name == "sy4_io":
        return 4, -D * sigma_i / 8
    if name == "rk4_ib":
        if exp:
            return 4, q * (55 * h * k - 48 * e1 * h**2 + 36 * e2 * h - 12 * e3) / 576
        return 4, q * (5 * h * k - 4 * e1 * h**2 + 3 * e2 * h - e3) / 48
    return 4, -D * sigma_i / 16


@final
class ClosedFormUpdate:
    """An update of the rigid body in closed form, called as update(m, dt).

    Parameters
    ----------
    body : RigidBody
    name : str
        See `update_names`.
    exponential : "cayley" or "exp"

    Raises
    ------
    InputError
        If no update has this name, or the exponential is another one.

    Notes
    -----
    The corrected formulas of section 4 of the paper in the convention X = omega x m. The formulas for RK4, and with the
    true exponential all except Euler and Heun, are not in the paper.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> body, m = lh.instances.RigidBody([1, 2, 3]), np.array([[0.6, 0.48, 0.64]])
    >>> bool(np.allclose(ClosedFormUpdate(body, "rk2_io")(m, 0.5), body.update("rk2_io")(m, 0.5), rtol=0, atol=1e-15))
    True
    """

    body: FreeBody
    name: str
    kind: str

    def __init__(self, body: FreeBody, name: str, exponential: str = "cayley") -> None:
        if exponential not in ("cayley", "exp"):
            raise InputError(f"closed forms are known for the exponentials 'cayley' and 'exp', not for {exponential!r}")
        self.body, self.name, self.exponential = body, checked_name(name), exponential
        self.kind = scheme(name)[0]
        self._action = Action(body.representation, exponential)

    def __call__(self, m: npt.ArrayLike, dt: npt.ArrayLike) -> Array:
        """The next point, shape (..., 3), for m (..., 3) and step sizes dt (...,)."""
        point = points_of(m)
        after: Any = self._action.act(self.generator(point, dt), point)
        new: Array = after
        return new

    def generator(self, m: npt.ArrayLike, dt: npt.ArrayLike) -> Array:
        """xi(m, dt), shape (..., 3)."""
        point = points_of(m)
        size = np.sqrt(dot(point, point))
        at = Ingredients(self.body, point / np.where(size > 0, size, 1))
        h = step_sizes(dt, point) * size
        schemes = {"eul": self._eul, "rk2": self._rk2, "sy4": self._sy4, "rk4": self._rk4}
        xi: Array = schemes[self.name[:3]](at, h)
        if "_i" not in self.name:
            return xi
        power, sigma = improvement(self.name, self.exponential, at)
        corrected: Array = xi + h**power * sigma * at.n
        return corrected

    # -- base schemes at unit vectors --------------------------------------------------------------------
    def _omega(self, m: Values) -> Any:
        turned = self.body.apply(m)
        return -turned if self.kind == "b" else dot(m, turned) * m - turned

    def _eul(self, at: Ingredients, h: Array) -> Any:
        return h * self._omega(at.n)

    def _rk2(self, at: Ingredients, h: Array) -> Any:
        first = self._omega(at.n)
        return h / 2 * (first + self._omega(self._action.act(h * first, at.n)))

    def _sy4(self, at: Ingredients, h: Array) -> Any:
        w = at.derivatives(self.kind, 4)
        xi = sum(h ** (j + 1) / factorial(j + 1) * w[j] for j in range(4))
        if self.exponential == "exp":
            return xi + h**3 / 12 * np.cross(w[1], w[0]) + h**4 / 24 * np.cross(w[2], w[0])
        square, half = dot(w[0], w[0]), dot(w[1], w[0])
        if self.kind == "o":
            return xi + h**3 / 12 * (square * w[0] + dot(w[2], at.n) * at.n) + h**4 / 8 * half * w[0]
        third = square * w[0] + np.cross(w[1], w[0])
        return xi + h**3 / 12 * third + h**4 / 24 * (square * w[1] + np.cross(w[2], w[0]) + 2 * half * w[0])

    def _rk4(self, at: Ingredients, h: Array) -> Any:
        def stage(u: Array) -> Any:
            y = h * self._omega(self._action.act(u, at.n))
            once = np.cross(u, y)
            if self.exponential == "cayley":
                return y - once / 2 + dot(u, y) * u / 4
            return y - once / 2 + np.cross(u, once) / 12

        first = h * self._omega(at.n)
        second = stage(first / 2)
        third = stage(second / 2)
        return (first + 2 * second + 2 * third + stage(third)) / 6

    def __repr__(self) -> str:
        return f"<{self.name} in closed form, {self.exponential}>"
