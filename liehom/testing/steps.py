"""Checks of actions and steps: an exponential has the properties of one, and a step has the order that it states."""

from __future__ import annotations

from typing import Any

import numpy as np

from liehom.correctors.expansion import flow_series, step_series
from liehom.correctors.step import Generator, LocalStep, Step
from liehom.homogeneous import Action, GeneratorField
from liehom.representations.constructions import defining
from liehom.series.jet import Jet
from liehom.series.node import Node
from liehom.testing.requirement import require
from liehom.typing import Array, Real, Values

ROUND_OFF = 1e-12
"""Relative difference that counts as round-off."""
SERIES_ORDER = 6
"""Order of the Taylor series on which the exponential is evaluated."""


def check_space(action: Action, *, trials: int = 3, rng: np.random.Generator | None = None) -> None:
    """Check an action: Exp(-x) inverts Exp(x), Exp agrees with exp to order 2, preserves orbits and acts on Jets.

    Parameters
    ----------
    action : Action
        Action with an exponential of the library or a custom one.
    trials : int
        Number of random elements and points.
    rng : numpy.random.Generator, optional

    Raises
    ------
    ConformanceError
        If a check fails; its attribute `check` is "inverse", "order 2", "orbit" or "series".

    Notes
    -----
    The check "orbit" tests, at two small t, that the velocity of the curve Exp(t x) m is tangent to the orbit, as far
    as the Taylor series of the curve is accurate.

    Examples
    --------
    >>> import liehom as lh
    >>> check_space(lh.Action(lh.sym_conjugation(3), "cayley"))
    """
    rng = np.random.default_rng(0) if rng is None else rng
    n, size = action.dimension, action.representation.size
    for _ in range(trials):
        x, m = rng.normal(size=n) / 2, rng.normal(size=size)
        scale = float(np.abs(m).max(initial=1.0)) * float(np.exp(np.linalg.norm(action.infinitesimal.left(x))))
        there = action.act(x, m)
        back = action.act(-x, there)
        require(np.abs(back - m).max(initial=0.0) < 1e3 * ROUND_OFF * scale, "inverse", "Exp(-x) Exp(x) m is not m")
        ray = Jet.from_node(Node(SERIES_ORDER, 0 * x, [None, x, *[None] * (SERIES_ORDER - 1)]))
        made = action.act(ray, m)
        once = action.infinitesimal(x, m)
        for k, wanted in enumerate((m, once, action.infinitesimal(x, once) / 2)):
            off = np.abs(made.coefficient(k) - wanted).max(initial=0.0)
            require(off < ROUND_OFF * scale, "order 2", f"Exp(t x) m differs from exp(t x) m at t^{k}")
        _check_tangents(action, made, scale)
        for h in (1e-2, 1e-3):
            off = np.abs(made(h) - action.act(h * x, m)).max(initial=0.0)
            require(off < (scale * h ** (SERIES_ORDER + 1) + ROUND_OFF) * scale, "series", "Exp acts otherwise on Jets")


def _check_tangents(action: Action, made: Jet, scale: float) -> None:
    """Check that the derivative of the curve is tangent to the orbits along it, as far as the series is accurate."""
    for h in (1e-2, 2e-2):
        point = made(h)
        speed = sum(k * made.coefficient(k) * h ** (k - 1) for k in range(1, SERIES_ORDER + 1))
        columns = action.infinitesimal.right(point)
        fitted = columns @ np.linalg.lstsq(columns, speed, rcond=1e-6)[0]
        off = float(np.abs(fitted - speed).max(initial=0.0))
        allowed = scale**2 * (1e-6 + SERIES_ORDER * h**SERIES_ORDER)
        require(off < allowed, "orbit", f"Exp(t x) m leaves the orbit: its velocity is off the tangent by {off:.2g}")


def check_order(
    step: Step, order: int | None = None, *, trials: int = 3, rng: np.random.Generator | None = None
) -> None:
    """Check that a step agrees with the flow through an order, and not beyond it.

    Parameters
    ----------
    step : Step
        Step of the library or a custom one.
    order : int, optional
        Order to check (default: ``step.order``).
    trials : int
        Number of random quadratic, time-dependent generators for each of so(3) and sl(2).
    rng : numpy.random.Generator, optional

    Raises
    ------
    ConformanceError
        If a check fails; its attribute `check` is "order" (a coefficient up to the order differs) or "sharpness" (the
        order is higher than stated).

    Examples
    --------
    >>> import liehom as lh
    >>> check_order(lh.Heun())
    >>> check_order(lh.Euler(), order=2)
    Traceback (most recent call last):
    ...
    liehom.errors.ConformanceError: order: Euler() differs from the flow at order 2 by ...
    """
    rng = np.random.default_rng(0) if rng is None else rng
    claimed = step.order if order is None else order
    worst = 0.0
    for name in ("so(3)", "sl(2)"):
        action = Action(defining(name))
        for _ in range(trials):
            found = _differences(step, action, claimed + 1, rng)
            for k, off in enumerate(found[:-1], start=1):
                require(off < 1e-9, "order", f"{step!r} differs from the flow at order {k} by {off:.2g}")
            worst = max(worst, found[-1])
    require(worst > 1e-7, "sharpness", f"{step!r} agrees with the flow at order {claimed + 1} too")


def _differences(step: Step, action: Action, total: int, rng: np.random.Generator) -> list[float]:
    """Relative differences of the Taylor coefficients 1 ... total of the step and of the flow at time tau."""
    r, size = action.dimension, action.representation.size
    parts = [rng.normal(size=(r, *(size,) * k)) / 2 for k in range(3)]
    m = rng.normal(size=size)
    m /= np.linalg.norm(m)

    def psi(m: Values, t: Real) -> Values:
        linear = np.einsum("ai,...i->...a", parts[1], m)
        values: Values = parts[0] * np.cos(t) + linear + np.einsum("aij,...i,...j->...a", parts[2], m, m)
        return values

    field = GeneratorField(action.representation, psi)
    dimension = np.linalg.matrix_rank(action.infinitesimal.right(m))
    local = step.at(action, Generator(field, dimension), m, np.array([0.3]))
    flow, made = flow_series(field, m, total, 0.3), step_series(action, local, m, total)
    clock = _clock(local, total)
    found = []
    for k in range(1, total + 1):
        wanted = sum(_power(clock, i, k) * flow.point(i) for i in range(1, k + 1))
        found.append(float(np.abs(wanted - made.coefficient(k)).max()) / (1 + float(np.abs(wanted).max())))
    return found


def _clock(local: LocalStep, total: int) -> Array:
    """Taylor coefficients 0 ... total of the time reparametrization tau(t)."""
    t = Jet.variable(0.0, total)
    made: Any = local.time(t)
    return np.asarray(made.coefficients, dtype=float)


def _power(clock: Array, i: int, k: int) -> float:
    """Taylor coefficient k of tau^i."""
    power = np.array([1.0])
    for _ in range(i):
        power = np.convolve(power, clock)
    return float(power[k]) if k < len(power) else 0.0
