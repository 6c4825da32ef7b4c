"""What the tests of correctors share: fields, a plain driver, orders from errors."""

from typing import Any

import numpy as np

import liehom as lh
from liehom.flow.steps.step import Generator

HAT = [[[0, 0, 0], [0, 0, -1], [0, 1, 0]], [[0, 0, 1], [0, 0, 0], [-1, 0, 0]], [[0, -1, 0], [1, 0, 0], [0, 0, 0]]]
OMEGA = np.array([1.0, 0.55, 0.3])  # 1 / I_j


def spin() -> lh.Representation:
    """so(3) in the basis in which rho(x) m is the cross product."""
    return lh.Representation.from_matrices(HAT)


def rigid_body(rho: lh.Representation | None = None, omega: Any = OMEGA, shift: Any = 0.0) -> lh.GeneratorField:
    """m' = m x Om m with the orthogonal generator plus shift times m."""

    def psi(m: Any) -> Any:
        return -m * omega + (np.sum(m * m * omega, axis=-1, keepdims=True) + shift) * m

    return lh.GeneratorField(rho or spin(), psi)


def quadratic(rho: lh.Representation, seed: int, scale: float = 1.0) -> lh.GeneratorField:
    """A random quadratic generator."""
    rng = np.random.default_rng(seed)
    n, d = rho.size, rho.algebra.dimension
    a, b, c = rng.normal(size=(d, n, n)), rng.normal(size=(d, n)), rng.normal(size=d)

    def psi(m: Any) -> Any:
        return scale * (np.einsum("aij,...i,...j->...a", a, m, m) / 2 + np.einsum("ai,...i->...a", b, m) + c)

    return lh.GeneratorField(rho, psi)


def unit(seed: int, *shape: int) -> Any:
    """Random unit vectors."""
    m = np.random.default_rng(seed).normal(size=shape)
    return m / np.linalg.norm(m, axis=-1, keepdims=True)


def psi_of(field: lh.GeneratorField, m: Any) -> Generator:
    """The generator as steps call it."""
    from liehom.flow.action.field import check_point

    return Generator(field, check_point(field.representation, m))


def one_step(field: lh.GeneratorField, step: Any, m: Any, h: Any, t: Any = 0.0, exponential: Any = "exp") -> Any:
    """(the next point, the time that has passed) for h of the shape of the leading axes."""
    m = np.asarray(m)
    action = lh.Action(field.representation, exponential)
    h = np.zeros(m.shape[:-1], dtype=m.dtype) + h
    t = np.zeros(m.shape[:-1], dtype=m.dtype) + t
    local = step.at(action, psi_of(field, m), m, t[..., None])
    return local.point(h[..., None]), local.time(h)


def exact_flow(field: lh.GeneratorField, m: Any, span: Any, t: Any = 0.0, steps: int = 60) -> Any:
    """F_span(m) from time t, by Taylor steps of order 14; spans of the shape of the leading axes."""
    step = lh.LieTaylor(14)
    m = np.asarray(m)
    h = (np.zeros(m.shape[:-1], dtype=m.dtype) + span) / steps
    t = np.zeros(m.shape[:-1], dtype=m.dtype) + t
    for k in range(steps):
        m, _ = one_step(field, step, m, h, t + k * h)
    return m


def run(
    field: lh.GeneratorField, step: Any, m: Any, dt: float, count: int, exponential: Any = "exp", t: Any = 0.0
) -> Any:
    """The last point and time after `count` steps."""
    m = np.asarray(m)
    action = lh.Action(field.representation, exponential)
    psi = psi_of(field, m)
    h = np.zeros(m.shape[:-1], dtype=m.dtype) + dt
    time = np.zeros(m.shape[:-1], dtype=m.dtype) + t
    for _ in range(count):
        local = step.at(action, psi, m, time[..., None])
        m, time = local.point(h[..., None]), time + local.time(h)
    return m, time


def slopes(sizes: Any, errors: Any) -> Any:
    """Observed orders between neighbouring step sizes."""
    sizes, errors = np.asarray(sizes, dtype=float), np.asarray(errors, dtype=float)
    return np.diff(np.log(errors)) / np.diff(np.log(sizes))
