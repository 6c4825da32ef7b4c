"""Fields with features that a method can jump over: pulses, switches, combs, ramps, walls and hot spots, on six spaces.

Fields of one shape, space and direction are a `Group`, whose trajectories are integrated together: one psi, whose
`args` have a slice for each of them. Each field knows the width of its narrowest feature in units of the span.
Named fields have their numbers in the code of psi, as users write them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from scipy.linalg import expm

import liehom as lh

Args = Mapping[str, Any]
Shape = Callable[[Any, Any, Args], Any]
"""The generator (..., dim g) at points m (..., N), times t (...,) and args, without the background."""
SPAN = 10.0


@dataclass(frozen=True)
class Space:
    """A representation with a start, the linear map of its background, and a factor for all psi."""

    rho: lh.Representation
    start: np.ndarray
    linear: np.ndarray
    scale: float

    @property
    def matrices(self) -> np.ndarray:
        return np.array([a.to_numpy() for a in self.rho.matrices], dtype=float)


@cache
def spaces() -> dict[str, Space]:
    """The spaces by name; the orbits are projected onto (the first three and motions), open, or landed on (plane)."""
    turn, right, up = np.zeros((3, 3, 3), dtype=int)
    turn[0, 1], turn[1, 0], right[0, 2], up[1, 2] = -1, 1, 1, 1
    affine = lh.Representation.from_matrices([turn, right, up], name="se(2) on the plane")
    named: dict[str, tuple[lh.Representation, list[float], float]] = {
        "sphere": (lh.adjoint(lh.so(3)), [2 / 3, -1 / 3, 2 / 3], 1.0),
        "glome": (lh.defining(lh.so(4)), [0.4, -0.2, 0.4, 0.8], 1.0),
        "hyperboloid": (lh.adjoint(lh.sl(2)), [0.6, 0.9, -0.3], 0.2),
        "projective": (lh.adjoint(lh.su(3)), [0.3, -0.2, 0.5, 0.4, -0.1, 0.2, 0.6, 0.3], 0.5),
        "motions": (lh.coadjoint(lh.euclidean(3)), [0.3, -0.5, 0.4, 0.5, 0.1, 0.7], 0.6),
        "plane": (affine, [0.7, -0.4, 1.0], 0.6),
    }
    found = {}
    for name, (rho, start, scale) in named.items():
        linear = np.random.default_rng(len(start)).normal(size=(rho.algebra.dimension, rho.size)) * 0.4
        if name == "sphere":
            linear = -np.diag([1, 1 / 2, 1 / 3])
        found[name] = Space(rho, np.array(start), linear, scale)
    return found


# -- shapes ----------------------------------------------------------------------------------------------


def along(x: Any, a: Args) -> Any:
    return x[..., None] * a["e"]


def u(t: Any, a: Args) -> Any:
    return (t - a["c"]) / a["w"]


def distance(m: Any, a: Args) -> Any:
    return ((m * a["v"]).sum(axis=-1) - a["d"]) / a["w"]


def linear(m: Any, matrix: Any) -> Any:
    """m @ matrix for each trajectory with its own matrix."""
    return (m[..., :, None] * matrix).sum(axis=-2)


def bump(x: Any) -> Any:
    """The function of class C-infinity that is not 0 for |x| < 1 only."""
    inside = np.abs(x) < 1
    return np.where(inside, np.exp(1 - 1 / np.where(inside, 1 - x * x, 1.0)), 0.0)


def cutoff(x: Any, w: Any) -> Any:
    """exp(-w/x) for x > 0, else 0."""
    return np.where(x > 0, np.exp(-w / np.where(x > 0, x, 1.0)), 0.0)


SHAPES: dict[str, Shape] = {
    # pulses
    "gauss": lambda m, t, a: along(np.exp(-(u(t, a) ** 2)), a),
    "sech": lambda m, t, a: along(1 / np.cosh(u(t, a)), a),
    "lorentz": lambda m, t, a: along(1 / (1 + u(t, a) ** 2), a),
    "quartic": lambda m, t, a: along(1 / (1 + u(t, a) ** 4), a),
    "flat": lambda m, t, a: along(np.exp(-(u(t, a) ** 8)), a),
    "odd": lambda m, t, a: along(u(t, a) * np.exp(-(u(t, a) ** 2)), a),
    "wavelet": lambda m, t, a: along((1 - 2 * u(t, a) ** 2) * np.exp(-(u(t, a) ** 2)), a),
    "packet": lambda m, t, a: along(np.exp(-(u(t, a) ** 2)) * np.cos(a["om"] * t), a),
    "pair": lambda m, t, a: along(np.exp(-(u(t, a) ** 2)) + np.exp(-((u(t, a) - 2 / a["w"]) ** 2)), a),
    "window": lambda m, t, a: along((np.tanh(u(t, a)) - np.tanh(u(t, a) - 0.7 / a["w"])) / 2, a),
    # switches
    "logistic": lambda m, t, a: along(1 / (1 + np.exp(-u(t, a))), a),
    "tanh": lambda m, t, a: along((1 + np.tanh(u(t, a))) / 2, a),
    "erf": lambda m, t, a: along((1 + np.tanh(u(t, a) * (1.12838 + 0.10277 * u(t, a) ** 2))) / 2, a),
    "arctan": lambda m, t, a: along(0.5 + np.arctan(u(t, a)) / np.pi, a),
    "gompertz": lambda m, t, a: along(np.exp(-np.exp(-u(t, a))), a),
    # periodic ones
    "comb": lambda m, t, a: along(np.exp(a["k"] * (np.cos(a["om"] * t + a["c"]) - 1)), a),
    "poisson": lambda m, t, a: along(
        (1 - a["q"]) ** 2 / (1 - 2 * a["q"] * np.cos(a["om"] * t + a["c"]) + a["q"] ** 2), a
    ),
    "square": lambda m, t, a: along(np.tanh(np.sin(a["om"] * t + a["c"]) / a["w"]), a),
    # ramps
    "power": lambda m, t, a: along(np.exp(a["k"] * np.log((t + 1e-3) / SPAN)), a),
    "sine": lambda m, t, a: along(np.exp(a["k"] * np.log(np.sin(np.pi * (t + 0.001) / (SPAN + 0.002)))), a),
    "rise": lambda m, t, a: along(1 - np.exp(-((t / a["s"]) ** 5)), a),
    "essential": lambda m, t, a: along(np.exp(-a["s"] / (t + 1e-6)), a),
    # chirps
    "chirp": lambda m, t, a: along(np.cos(a["k"] * t**3), a),
    # features of m
    "wall": lambda m, t, a: along(1 + np.tanh(distance(m, a)), a),
    "ridge": lambda m, t, a: along(np.exp(-(distance(m, a) ** 2)), a),
    "spot": lambda m, t, a: along(np.exp(-(((m - a["q"]) ** 2).sum(axis=-1)) / a["w"] ** 2), a),
    "dip": lambda m, t, a: along(1 / (1 + distance(m, a) ** 2), a),
    "swing": lambda m, t, a: along(np.tanh(distance(m, a) - 0.6 * np.sin(t) / a["w"]), a),
    # with branches, which series refuse
    "bump": lambda m, t, a: along(bump(u(t, a)), a),
    "cutoff": lambda m, t, a: along(cutoff(t - a["c"], a["w"]), a),
    # without narrow features
    "smooth body": lambda m, t, a: linear(m, a["B"]) + along(0 * m[..., 0] + 1.0, a),
    "smooth square": lambda m, t, a: linear(m, a["B"]) + linear(m * m, a["C"]),
    "smooth waves": lambda m, t, a: (
        np.sin(a["om"] * t[..., None] + a["p"]) * a["e"] + np.cos(linear(m, a["B"])) * a["s"][..., None]
    ),
    "smooth pulse": lambda m, t, a: along(np.exp(-(u(t, a) ** 2)), a),
}  # fmt: skip
PULSES = ("gauss", "sech", "lorentz", "quartic", "flat", "odd", "wavelet", "packet", "pair", "window")
SWITCHES = ("logistic", "tanh", "erf", "arctan", "gompertz")
WALLS = ("wall", "ridge", "spot", "dip", "swing")
BRANCHING = ("bump", "cutoff")
SMOOTH = ("smooth body", "smooth square", "smooth waves", "smooth pulse")
OVERFLOWS = ("sech", "logistic", "gompertz")  # exp(710) is infinite: for psi too, so these are not narrower than .016


def drawn(rng: np.random.Generator, name: str, space: Space, beta: int) -> tuple[dict[str, Any], float]:
    """Args of a field, and the width of its narrowest feature in units of time; `beta` is 0, 1, 2 for the background
    0, constant, a function of m."""
    r, n = space.linear.shape
    e, b, w = rng.normal(size=r), rng.normal(size=r) * 0.4, float(np.exp(rng.uniform(np.log(0.005), 0)))
    e *= space.scale * rng.uniform(0.5, 4) / np.linalg.norm(e)
    a: dict[str, Any] = {
        "c": rng.uniform(1, 9),
        "w": max(w, 0.016) if name in OVERFLOWS else w,
        "om": rng.uniform(1, 6),
    }
    width = a["w"]
    if name in PULSES or name in BRANCHING:
        e = e / 1.8 / (a["w"] if name not in ("window", "cutoff") else 1)
        if name == "packet":
            a["om"] = 10 ** rng.uniform(0.5, 1.8)
            e, width = e * a["w"] * 3, min(a["w"], 1 / a["om"])
        width = width / 4 if name in ("flat", "bump") else width
    elif name == "comb":
        a["k"] = np.exp(rng.uniform(np.log(3), np.log(300)))
        e, width = e * 0.5, 1 / (a["om"] * a["k"] ** 0.5)
    elif name == "poisson":
        a["q"] = 1 - np.exp(rng.uniform(np.log(0.01), np.log(0.5)))
        width = (1 - a["q"]) / a["om"]
    elif name == "square":
        width = a["w"] / a["om"]
    elif name in ("power", "sine"):
        a["k"] = rng.integers(3, 26) * 1.0
        width = SPAN / a["k"] if name == "power" else SPAN / np.pi / a["k"] ** 0.5
    elif name in ("rise", "essential"):
        a["s"] = rng.uniform(0.5, 6)
        width = a["s"] / 5
    elif name == "chirp":
        a["k"] = rng.uniform(0.01, 0.12)
        width = 1 / (3 * a["k"] * SPAN**2)
    elif name in WALLS:
        v = rng.normal(size=n)
        a |= {"v": v / np.linalg.norm(v), "d": rng.uniform(-0.5, 0.5) * np.linalg.norm(space.start)}
        e *= 0.4 if name != "spot" else 1.0
        # a spot is on the path of the constant background
        a["q"] = expm(rng.uniform(1, 8) * np.einsum("r,rij", b * space.scale, space.matrices)) @ space.start
        width = a["w"] / (np.linalg.norm(e) + np.linalg.norm(b)) / np.linalg.norm(space.start)
    elif name in SMOOTH:
        # on orbits that are not compact, quadratic fields have poles in finite time: they are weak there
        a |= {"B": rng.normal(size=(n, r)) * 0.5 * space.scale**2, "C": rng.normal(size=(n, r)) * 0.3 * space.scale**3}
        a |= {"om": rng.uniform(0.3, 3, size=r), "p": rng.uniform(0, 6, size=r)}
        a |= {"w": rng.uniform(1.5, 4), "s": 0.5 * space.scale**2}
        e, width = e / 3, SPAN / 10
    return {**a, "e": e, "b": b * space.scale * (beta == 1), "beta": 1.0 * (beta == 2) * space.scale**2}, width


# -- groups ----------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Group:
    """Fields with one psi(m, t, args), or psi(m, args); `args` has arrays (K, ...), or is empty for a named field."""

    name: str
    space: str
    psi: Callable[..., Any]
    args: dict[str, np.ndarray]
    widths: np.ndarray  # (K,), in units of the span
    span: tuple[float, float] = (0.0, SPAN)
    autonomous: bool = False

    @property
    def smooth(self) -> bool:
        return self.name.startswith("smooth")

    @property
    def names(self) -> list[str]:
        return [f"{self.name}/{self.space}/{j}" for j in range(len(self.widths))]

    def rhs(self, j: int) -> Callable[[float, np.ndarray], np.ndarray]:
        """X(t, m) of field j, without liehom."""
        flat = self.space_of.matrices.reshape(len(self.space_of.linear), -1)
        n, a = len(self.space_of.start), [{key: x[j] for key, x in self.args.items()}] if self.args else []

        def x(t: float, m: np.ndarray) -> np.ndarray:
            generator = self.psi(m, *a) if self.autonomous else self.psi(m, np.float64(t), *a)
            return (generator @ flat).reshape(n, n) @ m

        return x

    @property
    def space_of(self) -> Space:
        return spaces()[self.space]


def with_background(shape: Shape, matrix: np.ndarray, *, autonomous: bool, rigid: bool) -> Callable[..., Any]:
    """psi of a shape; the background is bounded, or linear as that of a rigid body."""

    def psi(m: Any, t: Any, args: Any) -> Any:
        turned = m @ matrix.T if rigid else np.sin(m @ matrix.T)
        return shape(m, t, args) + args["b"] + args["beta"][..., None] * turned

    def still(m: Any, args: Any) -> Any:
        return psi(m, None, args)

    return still if autonomous else psi


def groups(seed: int) -> list[Group]:
    """All groups of a seed: each shape on the sphere and two other spaces, smooth ones and walls on all; named ones."""
    others = [name for name in spaces() if name != "sphere"]
    found = list(named())
    for i, (name, shape) in enumerate(SHAPES.items()):
        everywhere = name in SMOOTH or name in WALLS
        for k, place in enumerate(("sphere", *(others if everywhere else (others[i % 5], others[(i + 2) % 5])))):
            rng = np.random.default_rng([seed, i, k])
            count = 4 if place == "sphere" else 3
            space, autonomous = spaces()[place], (name in WALLS and name != "swing") or name in SMOOTH[:2]
            fields = [drawn(rng, name, space, j % 3 if name not in WALLS else 1 + j % 2) for j in range(count)]
            args = {key: np.array([a[key] for a, _ in fields]) for key in fields[0][0]}
            psi = with_background(shape, space.linear, autonomous=autonomous, rigid=place == "sphere")
            back = (i + k) % 5 == 4 and name not in ("power", "sine", "rise", "essential")
            span = (SPAN, 0.0) if back else (0.0, SPAN)
            found.append(Group(name, place, psi, args, np.array([x for _, x in fields]) / SPAN, span, autonomous))
    return found


X, Y, Z = np.eye(3)
Q = np.array([-(5**0.5), 0.0, 2.0]) / 3  # on the circle about Z through the start


def body(m: Any) -> Any:
    return -m / np.array([1.0, 2.0, 3.0])


def named() -> Iterator[Group]:
    """Fields on the sphere as they are in textbooks and in reports of wrong results, with widths in units of time."""

    def one(name: str, width: float, psi: Callable[..., Any], span: tuple[float, float] = (0.0, SPAN)) -> Group:
        still = psi.__code__.co_varnames[1:2] != ("t",)
        return Group(name, "sphere", psi, {}, np.array([width / abs(span[1] - span[0])]), span, still)

    def s(x: Any, axis: np.ndarray) -> Any:
        return x[..., None] * axis

    def gauss(t: Any, c: float, w: float) -> Any:
        return np.exp(-(((t - c) / w) ** 2))

    yield one("nmr pulse", 0.3, lambda m, t: s(np.pi**0.5 / 0.6 * gauss(t, 5, 0.3), X) + 0.3 * Z)
    yield one("nmr pulse of 1 percent", 0.1, lambda m, t: s(np.pi**0.5 / 0.2 * gauss(t, 5, 0.1), X) + 0.3 * Z)
    yield one("ramsey", 0.1, lambda m, t: s(8.86 * (gauss(t, 2, 0.1) + gauss(t, 8, 0.1)), X) + 1.1 * Z)
    yield one("spin echo", 0.05, lambda m, t: s(17.7 * gauss(t, 2, 0.05) + 35.4 * gauss(t, 5, 0.05), X) + 0.7 * Z)
    yield one("stirap", 1.0, lambda m, t: s(9 * gauss(t, 5.7, 1), X) + s(9 * gauss(t, 4.3, 1), Y))
    yield one("sech pi", 0.05, lambda m, t: s(20 / np.cosh((t - 5) * 20), X) + 0.3 * Z)
    yield one("hyperbolic secant", 0.1, lambda m, t: s(10 / np.cosh(10 * (t - 4)), X) + s(5 * np.tanh(10 * (t - 4)), Z))
    yield one("landau-zener", 0.5, lambda m, t: s(4 * (t - 5), Z) + 0.8 * X)
    yield one("narrow crossing", 0.02, lambda m, t: s(np.tanh((t - 5) / 0.02) * 3, Z) + 0.8 * X)
    yield one("pulse on a body", 0.1, lambda m, t: body(m) + s(5 * gauss(t, 5.3, 0.1), X))
    yield one("short pulse on a body", 0.01, lambda m, t: body(m) + s(50 * gauss(t, 5.3, 0.01), X))
    yield one("short pulse alone", 0.01, lambda m, t: s(50 * gauss(t, 5.3, 0.01), X))
    yield one("late pulse alone", 0.05, lambda m, t: s(12 * gauss(t, 9.8, 0.05), X))
    yield one("early pulse alone", 0.05, lambda m, t: s(12 * gauss(t, 0.4, 0.05), X))
    yield one("logistic 100", 0.01, lambda m, t: body(m) + s(1 / (1 + np.exp(-100 * (t - 5.3))), X))
    yield one("logistic 10", 0.1, lambda m, t: s(1 / (1 + np.exp(-10 * (t - 5.3))), X))
    yield one("sin 6", 1.0, lambda m, t: s(2 * np.sin(np.pi * t / 10) ** 6, X), (5.0, 10.0))
    yield one("sin 8", 1.0, lambda m, t: s(5 * np.sin(np.pi * t / 10) ** 8, X))
    yield one("sin 16", 0.8, lambda m, t: s(5 * np.sin(np.pi * t / 10) ** 16, X) + 0.2 * Z)
    yield one("sin 40", 0.5, lambda m, t: s(5 * np.sin(np.pi * t / 10) ** 40, X) + s(np.cos(t), Y))
    yield one("t 8", 0.12, lambda m, t: s(9 * t**8, X), (0.0, 1.0))
    yield one("t 20", 0.05, lambda m, t: s(21 * t**20, X) + 0.1 * Y, (0.0, 1.0))
    yield one("t 4 (10 - t) 4", 1.5, lambda m, t: s(t**4 * (10 - t) ** 4 / 2e3, X))
    yield one("exp(-1/t)", 0.2, lambda m, t: s(np.exp(-1 / (t + 1e-9)), X))
    yield one("exp(-1/t) alone", 0.2, lambda m, t: s(5 * np.exp(-1 / (t + 1e-6)), Y) + s(0.2 * t, X))
    yield one("slow start", 0.5, lambda m, t: s(3 * (1 - np.exp(-(t**4))), X))
    yield one("train", 0.016, lambda m, t: s(3 * np.exp(50 * (np.cos(2 * np.pi * t) - 1)), X) + 0.2 * Z)
    yield one("square wave", 0.01, lambda m, t: body(m) + s(np.sin(6 * t) / np.sqrt(np.sin(6 * t) ** 2 + 4e-3), X))
    yield one("fast carrier", 0.005, lambda m, t: body(m) + s(5 * np.sin(200 * t), X))
    yield one("chirp on a body", 0.0033, lambda m, t: body(m) + s(np.sin(t**3), X))
    yield one("late wall", 0.02, lambda m: 0.5 * Z + s(1 + np.tanh((m[..., 1] - 0.3) / 0.01), X))
    yield one(
        "hot spot", 0.1, lambda m: 0.5 * Z + s(20 * np.exp(-(((m - [-0.2, 0.72, 0.667]) ** 2).sum(axis=-1)) / 5e-3), X)
    )
    for w in (0.1, 0.06, 0.04):
        yield one(
            f"hot spot {w} on a circle",
            w,
            lambda m, w=w: Z + s(1.2 / w * np.exp(-((m - Q) ** 2).sum(axis=-1) / w**2), X),
        )
    yield one("saturation", 0.02, lambda m: np.tanh(m / 0.02) * [1, -2, 0.5])
    yield one("reciprocal dip", 0.03, lambda m: body(m) / (1e-3 + m[..., :1] ** 2) * 0.2)
