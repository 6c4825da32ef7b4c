"""What a step costs in machine code, in nanoseconds per step and lane: of one size, and of sizes by the tolerance.

    python -m tests.benchmarks.adapted_steps [--fields body S3] [--orders 8] [--errors | --looks [--engines numpy]]

What is timed is the difference of two calls of a `Propagator` over spans of which one is longer, so that the call
itself does not count. Processor time of one thread, the best of several calls. The steps of an ensemble are those that
its lanes take together. With `--errors`, whole calls: the time by the tolerance alone in units of that of the best
step of one size and any of the orders 4, 6, 8, 12, 16 with the same median error. With `--looks`, whole calls of
the default step: the time in units of that without looks at psi within the steps, for fields psi(m, t), too.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

import liehom as lh

ROUNDS, RTOL = 7, 1e-7
LANES = (1, 10, 1000)


class Case(NamedTuple):
    """A field, its initial points as a function of (how many, a generator of random numbers), a span and a fixed dt."""

    field: lh.GeneratorField
    start: Callable[[int, np.random.Generator], np.ndarray]
    span: float
    dt: float


def affine(algebra: Any, matrix: np.ndarray, shift: np.ndarray, span: float, dt: float) -> Case:
    n = algebra.size

    def psi(m: Any) -> Any:
        return m @ matrix.T + shift if shift.any() else m @ matrix.T

    def start(count: int, rng: np.random.Generator) -> np.ndarray:
        y = rng.standard_normal((count, n))
        return y / np.linalg.norm(y, axis=1)[:, None]

    return Case(lh.GeneratorField(algebra, psi), start, span, dt)


def body() -> Case:
    return affine(lh.adjoint(lh.so(3)), -np.diag(1 / np.array([1.0, 1.7, 2.9])), np.zeros(3), 100.0, 0.8)


def sphere3() -> Case:
    rng = np.random.default_rng(77)
    return affine(lh.defining(lh.so(4)), rng.standard_normal((6, 4)), rng.standard_normal(6), 20.0, 0.15)


def sphere4() -> Case:
    rng = np.random.default_rng(78)
    matrix, shift = 0.7 * rng.standard_normal((10, 5)), 0.5 * rng.standard_normal(10)
    return affine(lh.defining(lh.so(5)), matrix, shift, 20.0, 0.15)


def quartic() -> Case:
    """x_i' = x_i psi_i with cubic psi, on the positive vectors of dimension 4."""
    n, rng = 4, np.random.default_rng(82)
    rho = lh.Representation(lh.abelian(n), [np.diag(row).astype(int).tolist() for row in np.eye(n)])
    weights = rng.standard_normal((n, n))
    weights = weights - weights.T
    field = lh.GeneratorField(rho, lambda m: (m * m * m - 1.0) @ weights.T)
    return Case(field, lambda count, rng: 1 + 0.3 * rng.uniform(-1, 1, (count, n)), 20.0, 0.02)


def ramp() -> Case:
    """A body with a torque that grows in time."""
    inertia, torque = np.array([1.0, 1.7, 2.9]), np.array([0.02, 0.0, 0.01])
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t: -m / inertia + t[..., None] * torque)
    return Case(field, body().start, 100.0, 0.8)


def driven() -> Case:
    """A body in a field that turns."""
    inertia, x, y = np.array([1.0, 1.7, 2.9]), np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])

    def psi(m: Any, t: Any) -> Any:
        return -m / inertia + np.cos(t)[..., None] * x + np.sin(t)[..., None] * y

    return Case(lh.GeneratorField(lh.adjoint(lh.so(3)), psi), body().start, 100.0, 0.8)


CASES = {"body": body, "S3": sphere3, "S4": sphere4, "quartic": quartic}
TIMED = {"ramp": ramp, "driven": driven}


def least(call: Callable[[], object], rounds: int = ROUNDS) -> float:
    """Processor seconds of a call: the least of several."""
    times = []
    for _ in range(rounds):
        begin = time.process_time_ns()
        call()
        times.append(time.process_time_ns() - begin)
    return min(times) / 1e9


def per_step(case: Case, order: int, lanes: int, *, adapted: bool) -> tuple[float, float]:
    """(nanoseconds per step and lane, steps of a lane)."""
    propagator = lh.Propagator(case.field, lh.Taylor(order), engine="llvm")
    y = case.start(lanes, np.random.default_rng(1))
    y = y[0] if lanes == 1 else y
    spent, steps = [], []
    rounds = max(ROUNDS, 1000 // lanes)
    for share in (1, 4):
        end = share * case.span / 4
        options: dict[str, Any] = {"rtol": RTOL, "atol": RTOL} if adapted else {"dt": case.dt}

        def call(end: float = end, options: dict[str, Any] = options) -> lh.Solution:
            return propagator((0.0, end), y, t_eval=np.array([end]), **options)

        steps.append(float(np.sum(np.ones(lanes) * call().n_steps)))
        call()
        spent.append(least(call, rounds))
    count = steps[1] - steps[0]
    return 1e9 * (spent[1] - spent[0]) / count, steps[1] / lanes


def at_equal_error(case: Case, lanes: int, rtol: float) -> tuple[float, float, float]:
    """(error, microseconds per lane by the tolerance, that time in units of the best step of one size)."""
    y = case.start(lanes, np.random.default_rng(5))
    some = slice(0, 20)
    end, at = case.span, np.array([case.span])
    exact = lh.Propagator(case.field, lh.Taylor(18), engine="llvm")((0.0, end), y[some], t_eval=at, dt=case.dt / 4).y

    def measured(order: int, **options: Any) -> tuple[float, float]:
        propagator = lh.Propagator(case.field, lh.Taylor(order), engine="llvm")
        y0 = y[0] if lanes == 1 else y
        found = propagator((0.0, end), y if lanes > 1 else y[:1], t_eval=at, **options).y[some]
        error = float(np.median(np.abs(found - exact[: len(found)]).max(axis=1)))
        propagator((0.0, end), y0, t_eval=at, **options)
        propagator((0.0, end), y0, t_eval=at, **options)
        return error, least(lambda: propagator((0.0, end), y0, t_eval=at, **options)) / lanes

    error, spent = measured(lh.Taylor.for_tolerance(rtol).n, rtol=rtol, atol=rtol)
    best = np.inf
    for order in (4, 6, 8, 12, 16):
        before = None
        for dt in case.dt * 2.0 ** (0.5 * np.arange(3, -9, -1)):
            now = measured(order, dt=float(end / np.ceil(end / dt)))
            if now[0] <= error:
                share = 1.0
                if before is not None and np.isfinite(before[0]) and before[0] > now[0] > 0:
                    share = np.log(before[0] / error) / np.log(before[0] / now[0])
                    best = min(best, before[1] ** (1 - share) * now[1] ** share)
                else:
                    best = min(best, now[1])
                break
            before = now
    return error, 1e6 * spent, spent / best


def with_looks(case: Case, engine: str, lanes: int, rtol: float) -> tuple[float, float, int]:
    """(milliseconds of a call without looks, and with them, steps of the longest trajectory)."""
    propagator, y = lh.Propagator(case.field, engine=engine), case.start(lanes, np.random.default_rng(1))
    spent, steps = [np.inf, np.inf], 0
    for _ in range(3 * ROUNDS):  # by turns, so that another program delays both
        for k, options in enumerate(({"looks": 0}, {})):
            begin = time.process_time_ns()
            found = propagator((0.0, case.span), y, t_eval=[case.span], rtol=rtol, atol=1e-3 * rtol, **options)
            spent[k] = min(spent[k], (time.process_time_ns() - begin) / 1e6)
            steps = int(np.max(found.n_steps))
    return *spent, steps


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--fields", nargs="+", choices=[*CASES, *TIMED])
    parser.add_argument("--orders", nargs="+", type=int, default=(8, 12))
    parser.add_argument("--errors", action="store_true")
    parser.add_argument("--looks", action="store_true")
    parser.add_argument("--engines", nargs="+", default=("llvm", "numpy"), choices=("llvm", "numpy"))
    chosen = parser.parse_args(arguments)
    os.environ["LIEHOM_NUM_THREADS"] = "1"
    for name in chosen.fields or [*CASES, *(TIMED if chosen.looks else [])]:
        case = (CASES | TIMED)[name]()
        if chosen.looks:
            for engine, lanes in ((e, {"llvm": 512, "numpy": 16}[e]) for e in chosen.engines):
                for rtol in (1e-4, 1e-6, 1e-9):
                    without, spent, steps = with_looks(case, engine, lanes, rtol)
                    text = f"{without:7.1f} ms, with looks {spent:7.1f} ms, {spent / without:.2f}; {steps} steps"
                    print(f"{name:8} {engine:5} N {lanes:4} rtol {rtol:g}: {text}", flush=True)
            continue
        if chosen.errors:
            for lanes in (1, 1000):
                for rtol in (1e-3, 1e-6, 1e-9, 1e-12):
                    error, spent, ratio = at_equal_error(case, lanes, rtol)
                    text = f"error {error:.1e}, {spent:8.2f} us, {ratio:.2f} of the best fixed"
                    print(f"{name:8} N {lanes:4} rtol {rtol:g}: {text}", flush=True)
            continue
        for order in chosen.orders:
            for lanes in LANES:
                fixed, _ = per_step(case, order, lanes, adapted=False)
                adapted, steps = per_step(case, order, lanes, adapted=True)
                text = f"fixed {fixed:7.1f} ns, adapted {adapted:7.1f} ns, {adapted / fixed:.2f}; {steps:.0f} steps"
                print(f"{name:8} Taylor({order:2}) N {lanes:4}: {text}", flush=True)


if __name__ == "__main__":
    main()
