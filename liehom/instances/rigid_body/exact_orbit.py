"""The step that stays on the orbit: xi = t (omega_o + s m) with the Cayley transform and s that conserves the energy.

At unit vectors, with sigma_i and R, h, v as in `closed_forms`, w = omega_o, rho = <X, Om w>/v^2, b = <w, Om w>/v^2,

    H(cay(xi) m) - H(m) = (t^2 v^2 / (2 d^2)) f(s),   d = 1 + t^2 (v^2 + s^2)/4,
    f(s) = sigma_i + (t rho - 1 + t^2 v^2/4) s + (t^2/4)(b - h) s^2 - (t^2/4) s^3,

a cubic that always has a real root. For small t its root is sigma_i (1 + t rho + ...).
"""

from __future__ import annotations

from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.correctors.implicit import solve_implicitly
from liehom.correctors.step import Factors, Generator, LocalStep, OneExponential
from liehom.errors import InputError
from liehom.homogeneous import Action
from liehom.instances.rigid_body.closed_forms import Ingredients
from liehom.instances.rigid_body.free_body import FreeBody
from liehom.instances.rigid_body.updates import step_sizes
from liehom.instances.spheres.sphere import dot
from liehom.integrators.points import points_of
from liehom.series.jet import Jet
from liehom.tracing import Traced
from liehom.typing import Array, BooleanArray, Values

NEWTON_ITERATIONS = 8
MIN_SLOPE = 0.1
"""|f'| at a root below which another root is near."""
MAX_HALVINGS = 12


@final
class ExactOrbit(OneExponential):
    """A step of the rigid body that stays on the orbit to round-off, for `liehom.integrate` with exponential="cayley".

    Parameters
    ----------
    body : RigidBody
        The field to integrate is ``body.field("o")``.

    Notes
    -----
    Its time reparametrization is τ(t) = t (1 + t rho / 2), with which trajectories have order 2. With the true
    exponential the energy has order 2 only.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> body, m = lh.instances.RigidBody([1, 2, 3]), np.array([0.6, 0.48, 0.64])
    >>> step = ExactOrbit(body)
    >>> sol = lh.integrate(body.field("o"), (0, 50), m, step=step, dt=1.0, exponential="cayley")
    >>> bool(np.abs(body.energy(sol.y.T) - body.energy(m)).max() < 3e-15)
    True
    """

    def __init__(self, body: FreeBody) -> None:
        self.body = body

    @property
    def order(self) -> int:
        return 2

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> OrbitStep:
        return OrbitStep(self.body, action, m)

    def __repr__(self) -> str:
        return f"ExactOrbit({self.body!r})"


@final
class OrbitStep(LocalStep):
    """The step of `ExactOrbit` at given points, as a function of its size.

    Parameters
    ----------
    body : RigidBody
    action : Action
    m : array of shape (..., 3)

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> body = lh.instances.RigidBody([1, 2, 3])
    >>> local = OrbitStep(body, lh.Action(body.representation, "cayley"), np.array([0.6, 0.48, 0.64]))
    >>> s, kept = local.root(np.array([1.0]))
    >>> bool(abs(local.value(s, np.array([1.0]))[0]) < 1e-15), bool(kept[0])
    (True, True)
    """

    omega: Values
    rho: Values

    def __init__(self, body: FreeBody, action: Action, m: Values) -> None:
        self._size: Any = np.sqrt(dot(m, m))
        self._size = np.where(self._size > 0, self._size, 1)
        at = self._at = Ingredients(body, m / self._size)
        self.omega = at.h * at.n - body.apply(at.n)
        moves = at.v2 > 0
        below = np.where(moves, at.v2, 1)
        turned = body.apply(self.omega)
        self.rho = np.where(moves, dot(at.X, turned) / below, 0)
        self._square = np.where(moves, dot(self.omega, turned) / below - at.h, 0)
        super().__init__(action, m, clock=((2, (self._size * self.rho)[..., 0] / 2),))  # tau = t (1 + t rho / 2)

    def factors(self, h: Values) -> Factors:
        t = h * self._size
        return (t * (self.omega + self._root(t) * self._at.n),)

    def root(self, h: Values) -> tuple[Any, Any]:
        """s for the step sizes h (..., 1), and whether it is the root that continues sigma_i, both of shape (..., 1).

        s is found by Newton's method from sigma_i. If that does not lead to a root with f' < -0.1, the root that
        continues sigma_i is close to a double root or has vanished there, and s is the root with f' <= 0 that is
        nearest to sigma_i.
        """
        t = h * self._size
        start = self._at.sigma_i + 0 * t
        s = start
        for _ in range(NEWTON_ITERATIONS):
            slope = self._slope(s, t)
            s = np.where(slope < -MIN_SLOPE / 2, s - self._value(s, t) / np.where(slope < 0, slope, -1), s)
        eps = float(np.finfo(s.dtype).eps)
        kept = (np.abs(self._value(s, t)) <= 16 * eps * (1 + np.abs(s))) & (self._slope(s, t) < -MIN_SLOPE)
        if isinstance(s, Traced):  # compiled code makes the step only if this holds
            s.tape.required.append(Traced(s.tape, np.all(kept)).entry)
            return s, kept
        if not bool(kept.all()):
            s = np.where(kept, s, self._nearest(start, t, kept))
        return s, kept

    def value(self, s: Values, h: Values) -> Any:
        """f(s) for steps of size h, shape (..., 1)."""
        return self._value(s, h * self._size)

    def _root(self, t: Values) -> Any:
        if not isinstance(t, Jet):
            return self.root(t / self._size)[0]
        at = self._at

        def rest(d: Values) -> Any:
            s = at.sigma_i + d
            return t * s * (self.rho + t / 4 * (at.v2 + s * (self._square - s)))

        return at.sigma_i + solve_implicitly(rest, np.zeros_like(at.h), t)

    def _value(self, s: Values, t: Values) -> Any:
        at = self._at
        return at.sigma_i + s * (t * self.rho - 1 + t * t / 4 * (at.v2 + s * (self._square - s)))

    def _slope(self, s: Values, t: Values) -> Any:
        return t * self.rho - 1 + t * t / 4 * (self._at.v2 + s * (2 * self._square - 3 * s))

    def _nearest(self, start: Array, t: Values, kept: BooleanArray) -> Array:
        """The root with f' <= 0 that is nearest to sigma_i, for entries that are not `kept`."""
        found = start.copy()
        constant, linear = self._at.sigma_i, t * self.rho - 1 + t * t / 4 * self._at.v2
        square, cube = t * t / 4 * self._square, -t * t / 4
        rows = np.broadcast_arrays(cube, square, linear, constant, found)
        for position in np.argwhere(~np.broadcast_to(kept, found.shape)):
            index = tuple(position)
            *polynomial, near = (float(x[index]) for x in rows)
            roots = np.roots(polynomial)
            real = roots[np.abs(roots.imag) <= 1e-6 * (1 + np.abs(roots))].real
            outer = real[np.polyval(np.polyder(polynomial), real) <= 1e-6]
            found[index] = min(outer if len(outer) else real, key=lambda x: abs(x - near))
        for _ in range(2):
            slope = self._slope(found, t)
            far = np.abs(slope) > 1e-3
            found = found - np.where(far, self._value(found, t) / np.where(far, slope, 1), 0)
        return found


@final
class ExactOrbitUpdate:
    """The step of `ExactOrbit` as an update (m, dt) -> m; ``RigidBody.exact_orbit()`` returns it.

    For dt |m| above about 3 times the moments, the root that continues sigma_i may vanish, and the remaining root may
    be on the other of the two closed orbits of the same energy. Then the step is made in two halves.

    Parameters
    ----------
    body : RigidBody
    step : ExactOrbit

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> update = lh.instances.RigidBody([1, 2, 3]).exact_orbit()
    >>> m = np.array([0.6, 0.48, 0.64])
    >>> update(m, 0.5).round(3).tolist(), round(float(update.time(m, 0.5)), 3)
    ([0.572, 0.601, 0.558], 0.514)
    """

    body: FreeBody
    step: ExactOrbit

    def __init__(self, body: FreeBody, step: ExactOrbit) -> None:
        self.body, self.step = body, step
        self._action = Action(body.representation, "cayley")

    def __call__(self, m: npt.ArrayLike, dt: npt.ArrayLike) -> Array:
        """The next point, shape (..., 3)."""
        return self.advance(m, dt)[0]

    def time(self, m: npt.ArrayLike, dt: npt.ArrayLike) -> Array:
        """The time τ that passes, with which trajectories have order 2, shape (...,)."""
        return self.advance(m, dt)[1]

    def advance(self, m: npt.ArrayLike, dt: npt.ArrayLike) -> tuple[Array, Array]:
        """The next point, shape (..., 3), and the time τ that passes, shape (...,).

        Raises
        ------
        InputError
            If a step size is not finite.
        """
        point = points_of(m)
        h = step_sizes(dt, point)
        if not bool(np.isfinite(h).all()):
            raise InputError(f"the step size is {dt!r}, expected finite numbers")
        return self._advance(point, h, MAX_HALVINGS)

    def _advance(self, m: Array, h: Array, halvings: int) -> tuple[Array, Array]:
        local = OrbitStep(self.body, self._action, m)
        after: Any = local.point(h)
        passed: Any = local.time(h[..., 0])
        kept = local.root(h)[1][..., 0]
        if bool(kept.all()) or not halvings:
            return after, passed
        lost = ~kept
        between, first = self._advance(m[lost], h[lost] / 2, halvings - 1)
        last, second = self._advance(between, h[lost] / 2, halvings - 1)
        after, passed = after.copy(), np.asarray(passed).copy()
        after[lost], passed[lost] = last, first + second
        return after, passed

    def __repr__(self) -> str:
        return f"<exact-orbit update of {self.body!r}>"
