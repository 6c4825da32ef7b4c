"""What tests of steps share: exact expansions of random problems, smooth fields on curved spaces, observed orders."""

import random
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

import liehom as lh
from liehom.exact.scalars.field import Field
from liehom.exact.scalars.rational import QQ
from liehom.flow.action.field import check_point
from liehom.flow.steps.step import Generator, LocalStep

GROUPS = {
    "so(2)": lambda: lh.defining(lh.so(2)), "so(3)": lambda: lh.defining(lh.so(3)),
    "so(4)": lambda: lh.defining(lh.so(4)), "sl(2)": lambda: lh.defining(lh.sl(2)),
    "Sym(3)": lambda: lh.sym_conjugation(3),
}  # fmt: skip


# -- exact expansions ------------------------------------------------------------------------------------
def polynomial_field(rho: lh.Representation, rng: random.Random, *, timed: bool) -> lh.GeneratorField:
    """A random generator of degree 2 with rational coefficients."""

    def term(*factors: str) -> str:
        return "*".join([f"({rng.choice([-3, -2, -1, 1, 2, 3])}/{rng.randint(1, 3)})", *factors])

    def coordinate() -> str:
        return f"m{rng.randrange(rho.size)}"

    parts = []
    for _ in range(rho.algebra.dimension):
        terms = [term(), term(coordinate()), term(coordinate()), term(coordinate(), coordinate())]
        terms += [term("t"), term("t", coordinate()), term("t", "t")] if timed else []
        parts.append(" + ".join(terms))
    return lh.GeneratorField(rho, parts)


def expansions(
    step: lh.Step, group: str, order: int, *, timed: bool, seed: int, exponential: Any = "exp", field: Field = QQ
) -> list[bool]:
    """Whether coefficient k of the step is that of the flow, k = 0, ..., order: exactly, at a random rational point."""
    rng = random.Random(f"{group} {timed} {seed}")
    rho = GROUPS[group]()
    made = polynomial_field(rho, rng, timed=timed)
    numbers = [field.convert(f"{rng.choice([-3, -1, 1, 2])}/{rng.randint(1, 4)}") for _ in range(rho.size + 1)]
    m, t = np.array(numbers[:-1], dtype=object), np.array(numbers[-1:], dtype=object)
    action = lh.Action(rho, exponential(rho) if callable(exponential) else exponential)
    flow = lh.steps.flow_series(made, m, order, t[0])
    local = step.at(action, Generator(made, rho.size - 1), m, t)
    series = lh.steps.step_series(action, local, m, order)
    return [all(x == y for x, y in zip(series.coefficient(k), flow.point(k), strict=True)) for k in range(order + 1)]


def exact_order(step: lh.Step, group: str, **options: Any) -> int:
    """The order at one point, at most one more than the step claims."""
    same = expansions(step, group, step.order + 1, **options)
    return same.index(False) - 1 if False in same else step.order + 1


# -- trajectories ----------------------------------------------------------------------------------------
def starts(name: str, lead: tuple[int, ...] = (), seed: int = 1) -> tuple[Any, Any]:
    """A representation and points of an ensemble on one of its orbits (or one orbit for each)."""
    rng = np.random.default_rng(seed)
    if name.startswith("Sym"):
        values = np.array([float(x) for x in name[3:]])
        values = values / np.linalg.norm(values)
        turned = np.linalg.qr(rng.normal(size=(*lead, 3, 3)))[0]
        full = (turned * values) @ np.swapaxes(turned, -1, -2)
        return lh.sym_conjugation(3), full[..., [0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]]
    rho = {"S2": lh.so(3), "S3": lh.so(4), "S4": lh.so(5), "plane": lh.sl(2)}[name]
    m = rng.normal(size=(*lead, lh.defining(rho).size))
    return lh.defining(rho), m / np.linalg.norm(m, axis=-1, keepdims=True)


def smooth_field(
    rho: Any, lead: tuple[int, ...] = (), *, timed: bool = True, seed: int = 2, scale: float = 1.0
) -> lh.GeneratorField:
    """psi = A sin(B m + w t + phi) with its own parameters for each trajectory: analytic and bounded."""
    rng = np.random.default_rng(seed)
    n, waves = rho.size, 3
    a = scale * rng.normal(size=(*lead, rho.algebra.dimension, waves))
    b, w, phi = (rng.normal(size=(*lead, waves, n)), rng.normal(size=(*lead, waves)), rng.normal(size=(*lead, waves)))
    b, w = b / np.sqrt(n), w / 2

    def autonomous(m: Any) -> Any:
        return np.einsum("...ra,...a->...r", a, np.sin(np.einsum("...ai,...i->...a", b, m) + phi))

    def forced(m: Any, t: Any) -> Any:
        angle = np.einsum("...ai,...i->...a", b, m) + phi + w * t[..., None]
        return np.einsum("...ra,...a->...r", a, np.sin(angle))

    return lh.GeneratorField(rho, forced if timed else autonomous)


def reference(field: lh.GeneratorField, m: Any, end: float) -> Any:
    """The flow from time 0, by the ambient equation."""

    def slope(t: float, y: Any) -> Any:
        return field.vector(y.reshape(m.shape), np.full(m.shape[:-1], t)).ravel()

    return solve_ivp(slope, (0, end), m.ravel(), method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1].reshape(m.shape)


def run(action: lh.Action, field: lh.GeneratorField, step: lh.Step, m: Any, end: float, count: int) -> Any:
    """The points at time `end`, by steps of nominal size end / count; a step with a clock takes what it needs."""
    psi = Generator(field, check_point(field.representation, m))
    size = m.dtype.type(end) / count
    t = np.zeros(m.shape[:-1], dtype=m.dtype)
    for _ in range(4 * count):
        local = step.at(action, psi, m, t[..., None])
        h = np.full(t.shape, size)
        last = t + local.time(h) >= end - 1e-9 * size
        if last.any():
            h = np.where(last, _size_until(local, end - t), h)
        m = local.point(h[..., None])
        t = t + local.time(h)
        if last.all():
            return m
    raise RuntimeError("the clock of the step does not reach the end")


def _size_until(local: LocalStep, wanted: Any) -> Any:
    """h with local.time(h) = wanted; the clock runs at about the rate 1, so that the iteration contracts."""
    h = wanted
    for _ in range(100):
        h = h - (local.time(h) - wanted)
    return h


SCALES = {"S2": 0.4, "S3": 0.5, "plane": 0.4, "Sym123": 0.5, "Sym112": 0.5}
LEAD = (2, 3)


class Problem(NamedTuple):
    """An ensemble of fields and starts on a space, and where the flow takes them in the time 1."""

    field: lh.GeneratorField
    starts: Any
    end: Any


@cache
def problem(space: str, timed: bool = True) -> Problem:
    """In extended precision, by Taylor steps of order 14; scipy confirms it with the digits that it has."""
    rho, m = starts(space, LEAD)
    field = smooth_field(rho, LEAD, timed=timed, scale=SCALES[space], seed=3 if space == "plane" else 2)
    points = m.astype(np.longdouble)
    end = run(lh.Action(rho), field, lh.LieTaylor(14), points, 1.0, 30)
    assert np.abs(end - reference(field, m, 1.0)).max() < 1e-12
    return Problem(field, points, end)


def errors(
    space: str, step: lh.Step, counts: tuple[int, ...], *, exponential: Any = "exp", timed: bool = True
) -> list[float]:
    """The root mean square over the ensemble of the errors at time 1, for each number of steps."""
    given = problem(space, timed)
    action = lh.Action(given.field.representation, exponential)
    made = [run(action, given.field, step, given.starts, 1.0, count) for count in counts]
    return [float(np.sqrt(np.mean(np.sum((x - given.end) ** 2, axis=-1)))) for x in made]


def slope(found: list[float]) -> float:
    """The observed order over the last halving of the step size."""
    return float(np.log2(found[-2] / found[-1]))
