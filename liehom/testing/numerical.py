"""Checks of actions and steps: that an exponential is one, and that a step has the order that it states."""

from __future__ import annotations

from typing import Any

import numpy as np

from liehom.correctors.expansion import flow_series, step_series
from liehom.correctors.step import Generator, LocalStep, Step
from liehom.errors import ConformanceError
from liehom.homogeneous import Action, GeneratorField
from liehom.representations.constructions import defining
from liehom.series.jet import Jet
from liehom.series.node import Node

ROUND_OFF = 1e-12
SERIES_ORDER = 6


def check_space(action: Action, *, trials: int = 3, rng: np.random.Generator | None = None) -> None:
    """Check an action: Exp(-x) undoes Exp(x), agrees with exp to order 2, keeps orbits, and expands as it acts.

    Parameters
    ----------
    action : Action
        With an exponential of the library or of one's own.
    trials : int
    rng : numpy.random.Generator, optional

    Raises
    ------
    ConformanceError
        Its attribute `check` is "inverse", "order 2", "orbit" or "series".

    Notes
    -----
    That points stay on their orbit is tested by the dimension of the orbit and by the series of the true exponential:
    Exp(t x) m is exp(y(t)) m for a curve y in g whose coefficients exist, order by order.

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
        _require(np.abs(back - m).max(initial=0.0) < 1e3 * ROUND_OFF * scale, "inverse", "Exp(-x) Exp(x) m is not m")
        ray = Jet.from_node(Node(SERIES_ORDER, 0 * x, [None, x, *[None] * (SERIES_ORDER - 1)]))
        made = action.act(ray, m)
        once = action.infinitesimal(x, m)
        for k, wanted in enumerate((m, once, action.infinitesimal(x, once) / 2)):
            off = np.abs(made.coefficient(k) - wanted).max(initial=0.0)
            _require(off < ROUND_OFF * scale, "order 2", f"Exp(t x) m differs from exp(t x) m at t^{k}")
        _check_tangents(action, made, m, scale)
        for h in (1e-2, 1e-3):
            off = np.abs(made(h) - action.act(h * x, m)).max(initial=0.0)
            _require(
                off < (scale * h ** (SERIES_ORDER + 1) + ROUND_OFF) * scale, "series", "Exp acts otherwise on Jets"
            )


def _check_tangents(action: Action, made: Jet, m: Any, scale: float) -> None:
    """Whether the derivative of the curve is tangent to the orbits along it, as far as the series goes."""
    for h in (1e-2, 2e-2):
        point = made(h)
        speed = sum(k * made.coefficient(k) * h ** (k - 1) for k in range(1, SERIES_ORDER + 1))
        columns = action.infinitesimal.right(point)
        fitted = columns @ np.linalg.lstsq(columns, speed, rcond=1e-6)[0]
        off = float(np.abs(fitted - speed).max(initial=0.0))
        allowed = scale**2 * (1e-6 + SERIES_ORDER * h**SERIES_ORDER)
        _require(off < allowed, "orbit", f"Exp(t x) m leaves the orbit: its velocity is off the tangent by {off:.2g}")


def check_order(
    step: Step, order: int | None = None, *, trials: int = 3, rng: np.random.Generator | None = None
) -> None:
    """Check that a step agrees with the flow through an order, and not beyond it.

    Parameters
    ----------
    step : Step
        Of the library or of one's own.
    order : int, optional
        What to check instead of ``step.order``.
    trials : int
        How many random quadratic, time-dependent generators, on so(3) and on sl(2).
    rng : numpy.random.Generator, optional

    Raises
    ------
    ConformanceError
        Its attribute `check` is "order" (a coefficient up to the order differs) or "sharpness" (the order is more than
        is stated).

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
                _require(off < 1e-9, "order", f"{step!r} differs from the flow at order {k} by {off:.2g}")
            worst = max(worst, found[-1])
    _require(worst > 1e-7, "sharpness", f"{step!r} agrees with the flow at order {claimed + 1} too")


def _differences(step: Step, action: Action, total: int, rng: np.random.Generator) -> list[float]:
    """The relative differences of the coefficients 1 ... total of the flow (with the step's clock) and the step."""
    r, size = action.dimension, action.representation.size
    parts = [rng.normal(size=(r, *(size,) * k)) / 2 for k in range(3)]
    m = rng.normal(size=size)
    m /= np.linalg.norm(m)

    def psi(m: Any, t: Any) -> Any:
        linear = np.einsum("ai,...i->...a", parts[1], m)
        return parts[0] * np.cos(t) + linear + np.einsum("aij,...i,...j->...a", parts[2], m, m)

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


def _clock(local: LocalStep, total: int) -> Any:
    """The Taylor coefficients 0 ... total of tau(t)."""
    t = Jet.variable(0.0, total)
    made: Any = local.time(t)
    return np.asarray(made.coefficients, dtype=float)


def _power(clock: Any, i: int, k: int) -> float:
    """Coefficient k of tau^i."""
    power = np.array([1.0])
    for _ in range(i):
        power = np.convolve(power, clock)
    return float(power[k]) if k < len(power) else 0.0


def _require(holds: Any, check: str, message: str) -> None:
    if not bool(holds):
        raise ConformanceError(check, message)
