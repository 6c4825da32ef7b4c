"""The updates of Figure 6, and steps of a fixed order at the nominal time."""

from __future__ import annotations

from dataclasses import dataclass
from math import comb, factorial
from typing import Any, NamedTuple, Protocol, TypeAlias, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import InputError, ShapeError
from liehom.base.typing import Array, BooleanArray, Values
from liehom.exact.representations.core.representation import Representation
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.space import Action
from liehom.flow.methods.low_order import Euler, Heun, LieTaylor
from liehom.flow.methods.rkmk import RKMK
from liehom.flow.run.options import points_of
from liehom.flow.series.jet import Jet
from liehom.flow.steps.corrected import Corrected, OrderRecursion, correct
from liehom.flow.steps.expansion import flow_series
from liehom.flow.steps.implicit import solve_implicitly
from liehom.flow.steps.step import (
    Diagnostics,
    ExponentialLike,
    Factors,
    Generator,
    LocalStep,
    OneExponential,
    Step,
    polynomial,
)
from liehom.flow.tracing.array import Traced
from liehom.studies.spheres import dot

# FreeBody: the protocol of a rigid body that its updates use, with the inverse inertia Om and the vector fields. The
# updates are written for this protocol, below `RigidBody`, which satisfies it and whose methods return them.

FloatType: TypeAlias = type[np.floating[Any]]  # numpy.float64 or numpy.longdouble


class FreeBody(Protocol):
    """A free rigid body m' = m x Om m, so(3) on R^3, with the methods that its updates call."""

    representation: Representation

    def apply(self, m: Values) -> Any:
        """Om m for points m (..., 3)."""
        ...

    def invariants(self, dtype: FloatType = np.float64) -> tuple[Any, Any, Any]:
        """e_1, e_2, e_3, the elementary symmetric functions of the inverse moments."""
        ...

    def field(self, kind: str = "o") -> GeneratorField:
        """The vector field with the generator omega_b ("b") or omega_o ("o")."""
        ...


# NominalTimeCorrected(step, n): a step of order n as a trajectory at the nominal time. Isotropy and multiples of psi
# raise its order. The system of Theorem 5, (1/2) rho(zeta) w_1 - c w_1 = w_n - z_n, has two unknowns. In
# `liehom.Corrected`, c changes the time reparametrization τ. Here it changes the generator: adding zeta t^(n-1) - c
# psi(m) t^n changes the coefficient of t^n by (1/2) rho(zeta) w_1 - c w_1, and time is nominal, τ(t) = t. Applied to xi
# = sum psi^(j-1) t^j / j!, this gives the paper's xi_o^sy4.


@final
@dataclass(frozen=True)
class GeneratorTaylor(OneExponential):
    """The step xi = sum_(j <= n) psi^(j-1) t^j / j!, the series of the integral of psi along the flow: order at most 2.

    Parameters
    ----------
    n : int

    Examples
    --------
    >>> GeneratorTaylor(4).order
    2
    """

    n: int

    @property
    def order(self) -> int:
        return min(self.n, 2)

    def generator(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Values:
        flow = flow_series(psi.field, m, self.n, t[..., 0] if np.ndim(t) else t)
        return polynomial([None, *(flow.psi(j - 1) / j for j in range(1, self.n + 1))], h)


@final
class NominalTimeCorrected(OneExponential):
    """A step whose order is raised by isotropy and by multiples of psi(m), at the nominal time τ(h) = h.

    Parameters
    ----------
    step : OneExponential
    order : int

    Notes
    -----
    For autonomous fields, at points at which the range condition (6.2) holds. At others the order is not reached: the
    run has status -2, and an `OrderWarning` says so.

    Examples
    --------
    >>> import liehom as lh
    >>> NominalTimeCorrected(lh.Euler(), 3)
    NominalTimeCorrected(Euler(), order=3)
    """

    def __init__(self, step: OneExponential, order: int) -> None:
        if not step.one_exponential:
            raise InputError(f"{step!r} has several exponentials, expected one")
        self.step, self._order = step, order

    @property
    def order(self) -> int:
        return max(self._order, self.step.order)

    @property
    def base_order(self) -> int:
        """Order of the base, an int."""
        return self.step.order

    @property
    def uses_isotropy(self) -> bool:
        """Whether the step asks for isotropy frames: True."""
        return True

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        local = self.step.at(action, psi, m, t)
        velocity, time = psi(m, t), t[..., 0] if np.ndim(t) else t
        for n in range(self.step.order + 1, self.order + 1):
            flow = flow_series(psi.field, m, n, time)
            raised = correct(OrderRecursion(action, flow, local, m, orbit_dimension=psi.orbit_dimension), n - 1, n)
            zeta, c = raised.zeta[n - 1], raised.clock[n]
            if zeta is not None and c is not None:  # they are None if no trajectory moves
                short = np.where((raised.leading != 0) & (raised.reached < n), self.order - n + 1, 0)
                local = _Raised(local, n, zeta, -c[..., None] * velocity, short)
        return local

    def __repr__(self) -> str:
        return f"NominalTimeCorrected({self.step!r}, order={self.order})"


@final
class _Raised(LocalStep):
    """The generator xi + zeta h^(n-1) + x h^n."""

    def __init__(self, base: LocalStep, n: int, zeta: Values, x: Values, short: Values) -> None:
        super().__init__(base.action, base.m)
        self.base, self.n, self.zeta, self.x, self.short = base, n, zeta, x, short

    def valid(self, h: Values) -> Values | bool:
        return self.base.valid(h)

    def diagnostics(self, h: Values) -> Diagnostics:
        """Diagnostics of the base, and the orders an unsolvable system lowers, as in `CorrectedStep.diagnostics`."""
        numbers = self.base.diagnostics(h)
        before, _ = numbers.get("short", (0 * self.short, "max"))
        short: Any = np.maximum(before, self.short)
        return {**numbers, "failed": (short > 0, "sum"), "lost": (short > 0, "sum"), "short": (short, "max")}

    def factors(self, h: Values) -> Factors:
        power = h
        for _ in range(self.n - 2):
            power = power * h
        return (self.base.factors(h)[0] + (self.zeta + self.x * h) * power,)


# The updates of Figure 6 for the rigid body, each a base scheme on a generator, with or without a correction.
#     name = scheme_variant: scheme eul, rk2, sy4, rk4; variant b or o (the generator omega_b or omega_o), preceded by i
#     if isotropy raises the order of the energy by one (eul_i: on omega_o)
# Time is nominal: the correction raises the order of energy and orbits, and trajectories have the order of the base.


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
    """The name, if an update has this name."""
    if name not in ORDERS:
        raise InputError(f"no update is called {name!r}, expected one of {', '.join(ORDERS)}")
    return name


def scheme(name: str, *, cayley: bool = True) -> tuple[str, Step]:
    """The generator ("b" or "o") and the step of an update; sy4_o with Cayley has the paper's other isotropy, with xi_4
    = omega''' + 3 <omega', omega> omega (`NominalTimeCorrected`).
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
        "cayley" or "exp": see `liehom.action.exponential_of`.

    Attributes
    ----------
    name : str
    step : Step
        The base scheme, or `Corrected` of it.
    field : GeneratorField
        The field with the generator omega_b or omega_o.
    orders : (energy, solution)
        Global orders on a triaxial body.

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

    def __init__(self, body: FreeBody, name: str, exponential: ExponentialLike = "cayley") -> None:
        self.body, self.name = body, checked_name(name)
        self._action = Action(body.representation, exponential)
        kind, self.step = scheme(name, cayley=self._action.exponential.name.startswith("Cayley"))
        self.field: GeneratorField = body.field(kind)
        self.orders = ORDERS[name]

    def __call__(self, m: npt.ArrayLike, dt: npt.ArrayLike) -> Array:
        """The next point, shape (..., 3), for m (..., 3) and step sizes dt (...,)."""
        point = _off_the_origin(points_of(m))
        return np.asarray(self._action.act(self._generator(point, dt), point))

    def generator(self, m: npt.ArrayLike, dt: npt.ArrayLike) -> Array:
        """xi(m, dt), shape (..., 3)."""
        return self._generator(_off_the_origin(points_of(m)), dt)

    def _generator(self, m: Array, dt: npt.ArrayLike) -> Array:
        h = step_sizes(dt, m)
        local = self.step.at(self._action, Generator(self.field, 2), m, np.zeros_like(h))
        return np.asarray(local.factors(h)[0])

    def __repr__(self) -> str:
        return f"<update {self.name} with {self._action.exponential.name}: {self.step!r}>"


def step_sizes(dt: npt.ArrayLike, m: Array) -> Array:
    """Step sizes (..., 1) in the floating type of the points m (..., 3)."""
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


# Updates of the rigid body in closed form: the base schemes and corrections as formulas. At n = m/|m| with the step
# size |m| dt (the field is quadratic), X = n x Om n, v = |X|, h = <n, Om n>, k = <n, Om^2 n>,
#     R = <X, Om X>/v^2,   D = <X, Om^2 n>,   q = D/v^2,   sigma_i = R - h = det(h - Om)/v^2
# and e_1, e_2, e_3 the elementary symmetric functions of Om. At X = 0, R = h and q = 0.


@final
class Ingredients:
    """The numbers in the closed forms, at unit vectors n (..., 3); v2 is v^2, and e is (e_1, e_2, e_3)."""

    def __init__(self, body: FreeBody, n: Values) -> None:
        self.body, self.n = body, n
        once = body.apply(n)
        self.h: Values = dot(n, once)
        orthogonal = once - self.h * n  # X and D are then relatively accurate next to equilibria
        self.X = np.cross(n, orthogonal)
        self.v2: Values = dot(self.X, self.X)
        twice = body.apply(once)
        self.k: Values = dot(n, twice)
        self.D = dot(self.X, twice - self.k * n)
        moves = self.v2 > 0
        below = np.where(moves, self.v2, 1)
        self.R = np.where(moves, dot(self.X, body.apply(self.X)) / below, self.h)
        self.q: Values = np.where(moves, self.D / below, 0)
        self.e: tuple[Any, Any, Any] = body.invariants(n.dtype.type)

    @property
    def sigma_i(self) -> Any:
        """R - h, (4.3), shape (..., 1)."""
        return self.R - self.h

    def derivatives(self, kind: str, count: int) -> list[Any]:
        """The first `count` of omega, omega', ... along the flow, for omega_b ("b") or omega_o ("o")."""
        points: list[Any] = [self.n]
        for n in range(count - 1):
            terms = (comb(n, i) * np.cross(points[i], self.body.apply(points[n - i])) for i in range(n + 1))
            points.append(sum(terms))
        return [-self.body.apply(x) + (self.h * x if kind == "o" else 0) for x in points]


def improvement(name: str, exponential: str, at: Ingredients) -> tuple[int, Any]:
    """(p, sigma), where dt^p sigma m is the difference of an update with i from its base (section 4 of the paper)."""
    e1, e2, e3 = at.e
    h, k, v2, q, D, sigma_i = at.h, at.k, at.v2, at.q, at.D, at.sigma_i
    if exponential == "exp":
        sy4_ib = 5 * e1 * h**2 - 4 * e2 * h + 3 * e3 - 6 * h * k
        rk4_ib = q * (55 * h * k - 48 * e1 * h**2 + 36 * e2 * h - 12 * e3) / 576
    else:
        sy4_ib = 3 * e1 * h**2 - 2 * e2 * h + e3 - 3 * h * k
        rk4_ib = q * (5 * h * k - 4 * e1 * h**2 + 3 * e2 * h - e3) / 48
    return {
        "eul_i": (1, sigma_i),
        "rk2_ib": (3, (e2 * at.R - e3) / 4),
        "rk2_io": (3, (3 * v2 + 3 * h**2 - 2 * e1 * h + e2) * sigma_i / 4),
        "sy4_ib": (4, q * sy4_ib / 24),
        "sy4_io": (4, -D * sigma_i / 8),
        "rk4_ib": (4, rk4_ib),
        "rk4_io": (4, -D * sigma_i / 16),
    }[name]


@final
class ClosedFormUpdate:
    """An update of the rigid body in closed form, called as update(m, dt).

    Parameters
    ----------
    body : RigidBody
    name : str
        See `update_names`.
    exponential : "cayley" or "exp"

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

    def __init__(self, body: FreeBody, name: str, exponential: str = "cayley") -> None:
        if exponential not in ("cayley", "exp"):
            raise InputError(f"closed forms are known for the exponentials 'cayley' and 'exp', not for {exponential!r}")
        self.body, self.name, self.exponential = body, checked_name(name), exponential
        self.kind = scheme(name)[0]
        self._action = Action(body.representation, exponential)

    def __call__(self, m: npt.ArrayLike, dt: npt.ArrayLike) -> Array:
        """The next point, shape (..., 3), for m (..., 3) and step sizes dt (...,)."""
        point = points_of(m)
        return np.asarray(self._action.act(self.generator(point, dt), point))

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
        return xi + h**power * sigma * at.n

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


# The step that stays on the orbit: xi = t (omega_o + s m) with the Cayley transform and s that conserves the energy. At
# unit vectors, with sigma_i and R, h, v as above, w = omega_o, rho = <X, Om w>/v^2, b = <w, Om w>/v^2,
#     H(cay(xi) m) - H(m) = (t^2 v^2 / (2 d^2)) f(s),   d = 1 + t^2 (v^2 + s^2)/4,
#     f(s) = sigma_i + (t rho - 1 + t^2 v^2/4) s + (t^2/4)(b - h) s^2 - (t^2/4) s^3,
# a cubic that always has a real root. For small t its root is sigma_i (1 + t rho + ...).

NEWTON_ITERATIONS = 8
MIN_SLOPE = 0.1  # |f'| at a root below which another root is near
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
    """The step of `ExactOrbit` at given points, as a function of its size."""

    def __init__(self, body: FreeBody, action: Action, m: Values) -> None:
        size = np.sqrt(dot(m, m))
        self._size: Any = np.where(size > 0, size, 1)
        at = self._at = Ingredients(body, m / self._size)
        self.omega: Values = at.h * at.n - body.apply(at.n)
        moves = at.v2 > 0
        below = np.where(moves, at.v2, 1)
        turned = body.apply(self.omega)
        self.rho: Values = np.where(moves, dot(at.X, turned) / below, 0)
        self._square = np.where(moves, dot(self.omega, turned) / below - at.h, 0)
        super().__init__(action, m, clock=((2, (self._size * self.rho)[..., 0] / 2),))  # tau = t (1 + t rho / 2)

    def factors(self, h: Values) -> Factors:
        t = h * self._size
        return (t * (self.omega + self._root(t) * self._at.n),)

    def root(self, h: Values) -> tuple[Any, Any]:
        """s for h (..., 1), and whether it continues sigma_i: by Newton's method from sigma_i, or, without a root with
        f' < -0.1 (at a double root), the nearest root to sigma_i with f' <= 0.
        """
        t = h * self._size
        start = s = self._at.sigma_i + 0 * t
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
        s = start.copy()
        constant, linear = self._at.sigma_i, t * self.rho - 1 + t * t / 4 * self._at.v2
        square, cube = t * t / 4 * self._square, -t * t / 4
        rows = np.broadcast_arrays(cube, square, linear, constant, s)
        for position in np.argwhere(~np.broadcast_to(kept, s.shape)):
            index = tuple(position)
            *polynomial, near = (float(x[index]) for x in rows)
            roots = np.roots(polynomial)
            real = roots[np.abs(roots.imag) <= 1e-6 * (1 + np.abs(roots))].real
            outer = real[np.polyval(np.polyder(polynomial), real) <= 1e-6]
            s[index] = min(outer if len(outer) else real, key=lambda x: abs(x - near))
        for _ in range(2):
            slope = self._slope(s, t)
            far = np.abs(slope) > 1e-3
            s = s - np.where(far, self._value(s, t) / np.where(far, slope, 1), 0)
        return s


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
        """The next point, shape (..., 3), and the time τ that passes, shape (...,)."""
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
