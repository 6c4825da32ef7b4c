"""What a whole call costs, in microseconds per trajectory: ours, heyoka's and a Runge-Kutta step in numba by hand.

    python -m tests.benchmarks.whole_call [case ...]

A `Propagator` is made once and called with new points; what is timed is the call. Processor time of one thread, the
best of several calls; peers are called the same way in the same process, where their modules are there. Errors are
medians over some trajectories, at the end, from heyoka in extended precision, or from our Taylor steps without it.
"""

import importlib.util
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

import liehom as lh
from tests.benchmarks import integration_peers as peers
from tests.benchmarks.integration_problems import Problem

LANES, CHECKED, ROUNDS = 10_000, 20, 5
INERTIA = np.array([1.0, 2.0, 3.0])
_RNG = np.random.default_rng(5)
MATRIX, SHIFT = _RNG.standard_normal((6, 4)), _RNG.standard_normal(6)


def _rates(field: lh.GeneratorField, matrix: Any, shift: Any) -> Callable[[Sequence[Any]], Sequence[Any]]:
    """The equation of a field whose generator is psi = matrix m + shift, as terms."""
    actions = [a.to_numpy() for a in field.representation.matrices]

    def rates(x: Sequence[Any]) -> Sequence[Any]:
        psi = [sum((float(c) * v for c, v in zip(row, x, strict=True) if c), float(b)) for row, b in
               zip(matrix, shift, strict=True)]  # fmt: skip
        found: list[Any] = []
        for i in range(len(x)):
            terms = [float(a[i, j]) * psi[k] * x[j] for k, a in enumerate(actions) for j in range(len(x)) if a[i, j]]
            found.append(sum(terms[1:], terms[0]))
        return found

    return rates


def _problem(name: str, field: lh.GeneratorField, matrix: Any, shift: Any, span: float) -> Problem:
    n = field.representation.size

    def start(count: int, rng: Any) -> Any:
        m = rng.normal(size=(count, n))
        return m / np.linalg.norm(m, axis=-1, keepdims=True)

    rates = _rates(field, matrix, shift)
    return Problem(name, name, field, start, rates, lambda xp, m: m, None, lambda m: m, span=span, shape=(n,))


BODY = _problem(
    "body", lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / INERTIA), -np.diag(1 / INERTIA), np.zeros(3), 100.0
)
SPHERE = _problem("S^3", lh.GeneratorField(lh.defining(lh.so(4)), lambda m: m @ MATRIX.T + SHIFT), MATRIX, SHIFT, 20.0)


@dataclass(frozen=True)
class Case:
    """A row: a problem, a step with its options, the number of trajectories, and settings of the peers.

    Attributes
    ----------
    tolerance : float
        That of heyoka.
    by_hand : float
        The step size of the Runge-Kutta step by hand.
    """

    name: str
    problem: Problem
    step: lh.Step
    options: dict[str, Any]
    lanes: int = LANES
    tolerance: float = 1e-10
    by_hand: float = 0.05


CASES = (
    Case("a", BODY, lh.LieTaylor(6), {"dt": 0.4}, 1),
    Case("b", BODY, lh.LieTaylor(6), {"dt": 0.4}),
    Case("c", SPHERE, lh.LieTaylor(4), {"dt": 0.1}, tolerance=1e-9, by_hand=0.01),
    Case("d body", BODY, lh.LieTaylor(6), {"rtol": 1e-6}),
    Case("d S^3", SPHERE, lh.LieTaylor(6), {"rtol": 1e-6}, tolerance=1e-9, by_hand=0.01),
    Case("d body Taylor", BODY, lh.Taylor(16), {"rtol": 1e-6}),
    Case("d S^3 Taylor", SPHERE, lh.Taylor(16), {"rtol": 1e-6}, tolerance=1e-9, by_hand=0.01),
    Case("e body", BODY, lh.Corrected(lh.Euler(), 4), {"dt": 0.1}),
    Case("e S^3", SPHERE, lh.Corrected(lh.Euler(), 4), {"dt": 0.1}, tolerance=1e-9, by_hand=0.01),
)


def best(call: Callable[[], Any], lanes: int, rounds: int) -> tuple[float, Any]:
    """Microseconds per trajectory of the fastest of several calls, and what the last returned."""
    found, made = np.inf, call()
    for _ in range(rounds if lanes > 1 else 40 * rounds):
        begin = time.process_time()
        made = call()
        found = min(found, time.process_time() - begin)
    return found * 1e6 / lanes, made


def row(case: Case, *, lanes: int = LANES, rounds: int = ROUNDS) -> dict[str, tuple[float, float]]:
    """(microseconds per trajectory, median error) of us and of the peers that are there."""
    problem, count = case.problem, min(lanes, case.lanes)
    starts = problem.starts(count)
    y0 = starts if count > 1 else starts[0]
    go = lh.Propagator(problem.field, case.step, engine="llvm")
    found = {"liehom": best(lambda: go((0.0, problem.span), y0, t_eval=[problem.span], **case.options), count, rounds)}
    found["liehom"] = found["liehom"][0], found["liehom"][1].y[..., -1].reshape(count, -1)
    for name, needs, solve, setting in (
        ("heyoka", "heyoka", peers._heyoka, case.tolerance),
        ("RK4 by hand", "numba", peers._rk4(peers.LANES if count > 1 else 1), case.by_hand),
    ):
        if importlib.util.find_spec(needs) is None:
            continue
        cost, made = best(lambda s=solve, h=setting: s(problem, starts, problem.span, h, 1), count, rounds)  # type: ignore[misc]
        found[name] = cost, made[-1]
    exact = _exact(problem, starts[:CHECKED])
    return {
        name: (cost, float(np.median(np.abs(end[:CHECKED] - exact).max(axis=-1))))
        for name, (cost, end) in found.items()
    }


def _exact(problem: Problem, starts: Any) -> Any:
    if importlib.util.find_spec("heyoka") is not None:
        return peers.extended_reference(problem, starts, [problem.span])[-1].astype(float)
    options: dict[str, Any] = {"step": lh.LieTaylor(8), "dt": 0.02, "t_eval": [problem.span], "engine": "llvm"}
    return lh.integrate(problem.field, (0.0, problem.span), starts, **options).y[..., -1]


def main(names: Sequence[str]) -> None:
    for case in CASES:
        if names and not case.name.startswith(tuple(names)):
            continue
        found = row(case)
        ours = found["liehom"][0]
        cells = [f"{name} {cost:8.2f} us, {error:7.1e} ({cost / ours:.2f})" for name, (cost, error) in found.items()]
        print(f"{case.name:13s} {case.step!r:28s} " + "; ".join(cells), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
