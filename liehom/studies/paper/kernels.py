"""The 13 updates of Figure 6 with as few operations as their formulas need, on the three coordinates one by one.

    m -> cay(xi(m, dt)) m,   cay(x) m = m + (x x m + x x (x x m)/2) / (1 + |x|^2/4)

in principal axes and on the unit sphere, for one body in each lane of the arrays; `liehom.instances.RigidBody` derives
the same updates from base schemes and the generic corrector, and `reproduce` compares the two. Only sums, products and
quotients are used: coordinates may be floats of any precision, arrays, or numbers that count operations.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

from liehom.base.errors import InputError
from liehom.studies.paper.table import UPDATES

# A float of any precision, an array with one entry per body, or a `Counted` number: what + - * / combine
Coordinate: TypeAlias = Any
Vector: TypeAlias = tuple[Coordinate, Coordinate, Coordinate]
Update: TypeAlias = Callable[[Vector, Coordinate], Vector]
"""A step (m, dt) -> m on coordinates."""

# updates that the paper prints with a mistake; the printed form is run too, to show the difference
MISPRINTS = ("rk2_b", "rk2_ib", "sy4_b", "sy4_o")


@dataclass(frozen=True, slots=True)
class Body:
    """One body, or several bodies, in principal axes.

    Parameters
    ----------
    w : three arrays or numbers
        The inverse principal moments, in any order.

    Attributes
    ----------
    e1, e2, e3 : arrays or numbers
        The elementary symmetric functions of w.

    Examples
    --------
    >>> body = Body((1.0, 0.5, 0.25))
    >>> body.e1, body.e2, body.e3
    (1.75, 0.875, 0.125)
    """

    w: Vector
    e1: Coordinate = field(init=False)
    e2: Coordinate = field(init=False)
    e3: Coordinate = field(init=False)

    def __post_init__(self) -> None:
        a, b, c = self.w
        object.__setattr__(self, "e1", a + b + c)
        object.__setattr__(self, "e2", a * b + b * c + c * a)
        object.__setattr__(self, "e3", a * b * c)

    def apply(self, m: Vector) -> Vector:
        """Angular velocity Om m of an angular momentum m."""
        return self.w[0] * m[0], self.w[1] * m[1], self.w[2] * m[2]

    def energy(self, m: Vector) -> Coordinate:
        """Energy H(m) = <m, Om m>/2."""
        return dot(m, self.apply(m)) / 2


def kernel(name: str, body: Body, *, printed: bool = False) -> Update:
    """Update of Figure 6 as a function (m, dt) -> m of coordinates.

    Parameters
    ----------
    name : str
        One of the 13 names of Figure 6: eul_b, ..., rk4_o.
    body : Body
    printed : bool
        Use a formula as printed: for rk2_b (a minus sign between the stages) and sy4_o (<omega', m> for <omega'', m>)
        with its misprint; for rk2_ib and sy4_b with a sign of the paper's other convention, sigma_ib of omega_b =
        +Om m with omega_b = -Om m, and omega_b = +Om m in the formula of omega_b = -Om m.

    Examples
    --------
    >>> body = Body((1.0, 0.5, 0.25))
    >>> m = (0.6, 0.48, 0.64)
    >>> after = kernel("eul_i", body)(m, 0.1)
    >>> abs(body.energy(after) - body.energy(m)) < 1e-5
    True
    """
    if name not in UPDATES or (printed and name not in MISPRINTS):
        raise InputError(
            f"no update is called {name!r}, expected one of {', '.join(MISPRINTS if printed else UPDATES)}"
        )
    scheme, variant = name.split("_")
    sign = -1 if printed else 1
    if name == "eul_i":
        return lambda m, dt: cay(_times(dt, _improved(body, m)), m)
    if scheme == "eul":
        omega = _omega(body, variant)
        return lambda m, dt: cay(_times(dt, omega(m)), m)
    base = _BASES[scheme](body, variant[-1], printed and "i" not in variant)
    if "i" not in variant:
        turn = sign if name == "sy4_b" else 1
        return lambda m, dt: cay(_times(turn, base(m, dt)) if turn < 0 else base(m, dt), m)
    sigma, power = _SIGMAS[name], 3 if scheme == "rk2" else 4

    def improved(m: Vector, dt: Coordinate) -> Vector:
        s = sigma(body, m) * (sign * dt**power)
        x, y, z = base(m, dt)
        return cay((x + s * m[0], y + s * m[1], z + s * m[2]), m)

    return improved


# -- arithmetic ------------------------------------------------------------------------------------------
def dot(a: Vector, b: Vector) -> Coordinate:
    """Inner product <a, b>."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Cross product a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def cay(x: Vector, m: Vector) -> Vector:
    """Point cay(x) m, by the formula of the module's docstring."""
    once = cross(x, m)
    twice = cross(x, once)
    scale = 1 / (1 + dot(x, x) * 0.25)
    half = scale * 0.5
    return (
        m[0] + (scale * once[0] + half * twice[0]),
        m[1] + (scale * once[1] + half * twice[1]),
        m[2] + (scale * once[2] + half * twice[2]),
    )


def _times(c: Coordinate, a: Vector) -> Vector:
    return c * a[0], c * a[1], c * a[2]


def _plus(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _omega(body: Body, kind: str) -> Callable[[Vector], Vector]:
    """Generator omega_b or omega_o as a function of m."""
    w = body.w

    def basic(m: Vector) -> Vector:
        return _times(-1, body.apply(m))

    def orthogonal(m: Vector) -> Vector:
        h = dot(m, body.apply(m))
        return (h - w[0]) * m[0], (h - w[1]) * m[1], (h - w[2]) * m[2]

    return basic if kind == "b" else orthogonal


def _improved(body: Body, m: Vector) -> Vector:
    """Generator omega_o + sigma_i m = (R - Om) m, in which h cancels."""
    r = _quotient(body, m)[2]
    w = body.w
    return (r - w[0]) * m[0], (r - w[1]) * m[1], (r - w[2]) * m[2]


def _quotient(body: Body, m: Vector) -> tuple[Vector, Coordinate, Coordinate]:
    """X = m x Om m, v^2 = |X|^2 and R = <X, Om X>/v^2; at equilibria R = h."""
    turned = body.apply(m)
    x = cross(m, turned)
    v2 = dot(x, x)
    top = dot(x, body.apply(x))
    if isinstance(v2, np.ndarray | np.floating):
        moves = v2 > 0
        if not np.all(moves):
            return x, v2, np.where(moves, top / np.where(moves, v2, 1), dot(m, turned))
    return x, v2, top / v2


# -- base schemes ----------------------------------------------------------------------------------------
def _heun(body: Body, kind: str, printed: bool) -> Update:
    omega = _omega(body, kind)

    def xi(m: Vector, dt: Coordinate) -> Vector:
        first = omega(m)
        second = omega(cay(_times(dt, first), m))
        half = dt * 0.5
        return _plus(_times(half, first), _times(-half if printed else half, second))

    return xi


def _taylor(body: Body, kind: str, printed: bool) -> Update:
    """Generator xi^sy4 of order 4 for the Cayley map, from derivatives of omega along the flow."""

    def derivatives(m: Vector) -> tuple[list[Vector], Coordinate]:
        p0, q0 = m, body.apply(m)
        p1 = cross(p0, q0)
        q1 = body.apply(p1)
        p2 = _plus(cross(p1, q0), cross(p0, q1))
        q2 = body.apply(p2)
        p3 = _plus(_plus(cross(p2, q0), cross(p0, q2)), _times(2, cross(p1, q1)))
        turned = [q0, q1, q2, body.apply(p3)]
        if kind == "b":
            return (turned if printed else [_times(-1, q) for q in turned]), None
        h = dot(p0, q0)
        return [_plus(_times(h, p), _times(-1, q)) for p, q in zip((p0, p1, p2, p3), turned, strict=True)], h

    def xi(m: Vector, dt: Coordinate) -> Vector:
        w, _ = derivatives(m)
        square, half = dot(w[0], w[0]), dot(w[1], w[0])
        third, fourth = dt**3 * (1 / 12), dt**4 * (1 / 24)
        powers = (dt, dt**2 * 0.5, third * 2, fourth)
        if kind == "b":
            factors = (powers[0] + third * square + 2 * fourth * half, powers[1] + fourth * square, *powers[2:])
            turns = _plus(_times(third, cross(w[1], w[0])), _times(fourth, cross(w[2], w[0])))
        else:
            factors = (powers[0] + third * square + 3 * fourth * half, *powers[1:])
            turns = _times(third * dot(w[1 if printed else 2], m), m)
        total = turns
        for factor, part in zip(factors, w, strict=True):
            total = _plus(total, _times(factor, part))
        return total

    return xi


def _munthe_kaas(body: Body, kind: str, printed: bool) -> Update:
    """Generator of RK4 in the algebra, with dcay_u^-1(y) = y - u x y/2 + <u, y> u/4."""
    omega = _omega(body, kind)

    def xi(m: Vector, dt: Coordinate) -> Vector:
        def stage(u: Vector) -> Vector:
            y = _times(dt, omega(cay(u, m)))
            return _plus(_plus(y, _times(-0.5, cross(u, y))), _times(0.25 * dot(u, y), u))

        first = _times(dt, omega(m))
        second = stage(_times(0.5, first))
        third = stage(_times(0.5, second))
        inner = _times(2, _plus(second, third))
        return _times(1 / 6, _plus(_plus(first, inner), stage(third)))

    return xi


_BASES: dict[str, Callable[[Body, str, bool], Update]] = {"rk2": _heun, "sy4": _taylor, "rk4": _munthe_kaas}


# -- improvements: sigma of dt^p sigma m -----------------------------------------------------------------
def _sigma_ib(body: Body, m: Vector) -> Coordinate:
    return (body.e2 * _quotient(body, m)[2] - body.e3) * 0.25


def _sigma_io(body: Body, m: Vector) -> Coordinate:
    _, v2, r = _quotient(body, m)
    h = dot(m, body.apply(m))
    return (3 * (v2 + h * h) - 2 * body.e1 * h + body.e2) * (r - h) * 0.25


def _sigma_ib_sy4(body: Body, m: Vector) -> Coordinate:
    x, v2, r = _quotient(body, m)
    turned = body.apply(m)
    d = dot(x, body.apply(turned))
    q = d / (v2 if not isinstance(v2, np.ndarray) else np.where(v2 > 0, v2, 1))
    return (q * (body.e2 * dot(m, turned) - 2 * body.e3) - 3 * d * r) * (1 / 24)


def _sigma_io_sy4(body: Body, m: Vector) -> Coordinate:
    x, _, r = _quotient(body, m)
    turned = body.apply(m)
    return dot(x, body.apply(turned)) * (dot(m, turned) - r) * 0.125


_SIGMAS: dict[str, Callable[[Body, Vector], Coordinate]] = {
    "rk2_ib": _sigma_ib,
    "rk2_io": _sigma_io,
    "sy4_ib": _sigma_ib_sy4,
    "sy4_io": _sigma_io_sy4,
}
