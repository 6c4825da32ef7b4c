"""Stiff fields: steps of liehom against Radau, LSODA and CVODE, at matched errors.

    python -m tests.benchmarks.stiff [--page docs/stiff.md]

prints a table of CPU times; with --page it replaces the table between the markers of the page. For each method the
largest tolerance is taken whose error at the end is at most the target. The right-hand sides of the peers are written
by hand, in plain Python. A propagator of liehom is made once: its first call, with trace and compilation, is a column
of its own. CVODE is measured if scikit-sundae is installed.
"""

import argparse
import math
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

import liehom as lh
from liehom.flow.methods.named import step_named

MARKERS = ("<!-- stiff: begin -->", "<!-- stiff: end -->")
TARGET = 1e-5
TOLERANCES = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9]
ENSEMBLE = 10
REPEATS = 5
METHODS = ("radau5", "rodas4", "exprb4")
ENGINES = ("auto", "llvm")


class System(NamedTuple):
    """A field with its vector field for one point, the final time and the starts."""

    title: str
    field: lh.GeneratorField
    right: Callable[[float, Any], Any]
    end: float
    starts: Any


def systems() -> list[System]:
    """Relaxation to a moving point of S^2, a damped spin in a turning field, and relaxation on S^3, each twice."""
    rng = np.random.default_rng(0)
    rho, four = lh.adjoint(lh.so(3)), lh.defining(lh.so(4))

    def target(t: Any) -> Any:  # not along a one-parameter group, where steps in the algebra would be exact
        angle, height = t + 0.5 * np.sin(2 * t), 0.6 * np.sin(1.3 * t)
        return np.stack([np.cos(angle) * np.cos(height), np.sin(angle) * np.cos(height), np.sin(height)], axis=-1)

    def turning(t: Any) -> Any:
        return 1000.0 * target(t)

    def rotated(t: Any) -> Any:
        tilt = 0.4 * np.sin(0.7 * t)[..., None]
        return np.concatenate([np.cos(tilt) * target(t), np.sin(tilt)], axis=-1)

    def starts(e: Any) -> Any:
        m = np.asarray(e) + 0.4 * rng.uniform(-1, 1, size=(ENSEMBLE, len(e)))
        return m / np.linalg.norm(m, axis=-1, keepdims=True)

    def chase(m: Any, t: Any) -> Any:
        return 1e4 * np.cross(m, target(t))

    llg = lh.LandauLifshitz(applied=turning, damping=1.0)

    def horizontal(m: Any, t: Any) -> Any:  # without the isotropy, which would turn spins about themselves
        psi = llg.generator(m, t)
        return psi - np.sum(psi * m, axis=-1, keepdims=True) * m

    spin = lh.GeneratorField(rho, horizontal)

    matrices = np.array([a.to_numpy() for a in four.matrices])  # <A_a m, e>: the generator of e - <m, e> m

    def relax(m: Any, t: Any) -> Any:
        return 1e3 * np.einsum("aij,...j,...i->...a", matrices, m, rotated(t))

    return [
        System("relaxation on S², rate 10⁴", lh.GeneratorField(rho, chase), chased, 5.0, starts([1.0, 0, 0])),
        System("damped spin, rate 500", spin, damped, 5.0, starts([1.0, 0, 0])),
        System("relaxation on S³, rate 10³", lh.GeneratorField(four, relax), pulled, 5.0, starts([1.0, 0, 0, 0])),
    ]


# The same right-hand sides by hand, as a user of scipy writes them for speed.


def place(t: float) -> tuple[float, float, float]:
    """The moving point of S^2."""
    angle, height = t + 0.5 * math.sin(2 * t), 0.6 * math.sin(1.3 * t)
    c = math.cos(height)
    return math.cos(angle) * c, math.sin(angle) * c, math.sin(height)


def chased(t: float, y: Any) -> list[float]:
    e, (a, b, c) = place(t), y
    p, q, r = 1e4 * (b * e[2] - c * e[1]), 1e4 * (c * e[0] - a * e[2]), 1e4 * (a * e[1] - b * e[0])
    return [q * c - r * b, r * a - p * c, p * b - q * a]


def damped(t: float, y: Any) -> list[float]:
    (e, f, g), (a, b, c) = place(t), y
    inner, square = e * a + f * b + g * c, a * a + b * b + c * c
    return [
        500 * (f * c - g * b + e * square - inner * a),
        500 * (g * a - e * c + f * square - inner * b),
        500 * (e * b - f * a + g * square - inner * c),
    ]


def pulled(t: float, y: Any) -> list[float]:
    tilt = 0.4 * math.sin(0.7 * t)
    c = math.cos(tilt)
    e = (*(c * x for x in place(t)), math.sin(tilt))
    inner = e[0] * y[0] + e[1] * y[1] + e[2] * y[2] + e[3] * y[3]
    return [1e3 * (e[i] - inner * y[i]) for i in range(4)]


def timed(run: Callable[[], Any]) -> tuple[float, Any]:
    best, found = np.inf, None
    for _ in range(REPEATS):
        begin = time.process_time()
        found = run()
        best = min(best, time.process_time() - begin)
        if best > 3:
            break
    return best, found


def matched(run: Callable[[float], Any], end: Any) -> tuple[float, float, float] | None:
    """(tolerance, error, seconds) for the largest tolerance that meets the target."""
    for tolerance in TOLERANCES:
        found = run(tolerance)
        error = float(np.abs(found - end).max())
        if error <= TARGET:
            return tolerance, error, timed(lambda tolerance=tolerance: run(tolerance))[0]
    return None


def peers(system: System) -> dict[str, Callable[[Any, float], Any]]:
    """The solvers of other packages by name, as functions of a start and a tolerance."""

    def scipy(method: str) -> Callable[[Any, float], Any]:
        return lambda y0, tolerance: solve_ivp(
            system.right, (0, system.end), y0, method=method, rtol=tolerance, atol=tolerance
        ).y[:, -1]

    found = {"scipy Radau": scipy("Radau"), "scipy LSODA": scipy("LSODA")}
    try:
        from sksundae.cvode import CVODE
    except ImportError:
        return found

    def rates(t: float, y: Any, out: Any) -> None:
        out[:] = system.right(t, y)

    def cvode(y0: Any, tolerance: float) -> Any:
        solver = CVODE(rates, rtol=tolerance, atol=tolerance, max_num_steps=10**6)
        return solver.solve(np.array([0.0, system.end]), y0).y[-1]

    return {**found, "CVODE": cvode}


def rows(system: System) -> list[str]:
    made = []
    start, many = system.starts[0], system.starts
    exact = solve_ivp(system.right, (0, system.end), start, method="LSODA", rtol=1e-12, atol=1e-13).y[:, -1]
    title = system.title
    for name, solve in peers(system).items():
        one = matched(lambda tolerance, solve=solve: solve(start, tolerance), exact)
        if one is None:
            continue
        spent, few = timed(lambda solve=solve, one=one: [solve(y, one[0]) for y in many])
        made.append(f"| {title} | {name} | {one[1]:.0e} | - | {1e3 * one[2]:.2f} | {1e3 * spent:.1f} |")
        print(made[-1], f"drift {max(abs(float(np.linalg.norm(y)) - 1) for y in few):.1e}", flush=True)
        title = ""
    for name in METHODS:
        for engine in ENGINES:
            propagator = lh.Propagator(system.field, step_named(name), engine=engine)

            def own(tolerance: float, y0: Any = start, propagator: Any = propagator) -> Any:
                sol = propagator((0, system.end), y0, rtol=tolerance, atol=tolerance, t_eval=[system.end])
                return sol.y[..., -1] if sol.success else np.full_like(y0, np.nan)

            begin = time.process_time()
            try:
                own(TOLERANCES[2])
            except lh.TraceError:
                continue
            first = time.process_time() - begin
            one = matched(own, exact)
            if one is None:
                continue
            spent, _ = timed(lambda own=own, one=one: own(one[0], many))
            setting = 1e3 * max(0.0, first - one[2])
            label = f"{name}, {engine}"
            made.append(f"| | {label} | {one[1]:.0e} | {setting:.0f} | {1e3 * one[2]:.2f} | {1e3 * spent:.1f} |")
            print(made[-1], one[0], flush=True)
    return made


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--page", type=Path)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    made = [
        f"| field | method | error | ms, set-up | ms, one trajectory | ms, {ENSEMBLE} trajectories |",
        "|---|---|---|---|---|---|",
        *[row for system in systems() for row in rows(system)],
    ]  # fmt: skip
    print("\n".join(made))
    if given.page is not None:
        before, rest = given.page.read_text(encoding="utf-8").split(MARKERS[0])
        after = rest.split(MARKERS[1])[1]
        given.page.write_text(
            f"{before}{MARKERS[0]}\n\n" + "\n".join(made) + f"\n\n{MARKERS[1]}{after}", encoding="utf-8"
        )


if __name__ == "__main__":
    main()
