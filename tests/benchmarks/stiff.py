"""Stiff fields: steps of liehom against Radau of scipy, at matched errors.

    python -m tests.benchmarks.stiff [--page docs/stiff.md]

prints a table of CPU times of the whole call; with --page it replaces the table between the markers of the page. For
each method the largest tolerance is taken whose error at the end is at most the target.
"""

import argparse
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
TOLERANCES = [1e-4, 1e-5, 1e-6, 1e-7]
ENSEMBLE = 10
REPEATS = 1
METHODS = ("radau5", "rodas4", "exprb4")


class System(NamedTuple):
    """A field with its vector field for one point, the final time and the starts."""

    title: str
    field: lh.GeneratorField
    right: Callable[[float, Any], Any]
    end: float
    starts: Any


def systems() -> list[System]:
    """Relaxation to a moving point of S^2, a damped spin in a turning field, and relaxation on S^3."""
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

    def pull(t: float, y: Any) -> Any:
        e = rotated(np.asarray(t))
        return 1e3 * (e - (e @ y) * y)

    made = [
        ("relaxation on S², rate 10⁴", lh.GeneratorField(rho, chase), 5.0, starts([1.0, 0, 0])),
        ("damped spin, rate 500", spin, 5.0, starts([1.0, 0, 0])),
        (
            "relaxation on S³, rate 10³", lh.GeneratorField(four, relax), 5.0,
            starts([1.0, 0, 0, 0]),
        ),
    ]  # fmt: skip
    out = []
    for title, field, end, points in made:

        def right(t: float, y: Any, field: Any = field) -> Any:
            return field.vector(y, np.asarray(t))

        out.append(System(title, field, pull if "S³" in title else right, end, points))
    return out


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
        made = run(tolerance)
        if made is None:
            return None
        error = float(np.abs(made - end).max())
        if error <= TARGET:
            seconds, _ = timed(lambda tolerance=tolerance: run(tolerance))
            return tolerance, error, seconds
    return None


def rows(system: System) -> list[str]:
    made = []
    start, many = system.starts[0], system.starts
    exact = solve_ivp(system.right, (0, system.end), start, method="Radau", rtol=1e-9, atol=1e-10).y[:, -1]

    def peer(y0: Any, tolerance: float) -> Any:
        return solve_ivp(system.right, (0, system.end), y0, method="Radau", rtol=tolerance, atol=tolerance).y[:, -1]

    def own(name: str, y0: Any, engine: str, tolerance: float) -> Any:
        try:
            sol = lh.integrate(
                system.field, (0, system.end), y0, step=step_named(name), rtol=tolerance, atol=tolerance,
                t_eval=[system.end], engine=engine,
            )  # fmt: skip
        except lh.TraceError:
            return None
        return sol.y[..., -1] if sol.success else np.full_like(y0, np.nan)

    single = matched(lambda tolerance: peer(start, tolerance), exact)
    few = [peer(y, single[0]) for y in many[:5]] if single else []
    seconds = timed(lambda: [peer(y, single[0]) for y in many[:5]])[0] / 5 * ENSEMBLE if few and single else np.nan
    made.append(f"| {system.title} | scipy Radau | {single[1]:.0e} | {1e3 * single[2]:.0f} | {1e3 * seconds:.0f} |")
    drift = max(abs(float(np.linalg.norm(y)) - 1) for y in few)
    print(made[-1], f"drift {drift:.1e}", flush=True)
    for name in METHODS:
        for engine in ("numpy", "llvm"):
            one = matched(lambda t, name=name, engine=engine: own(name, start, engine, t), exact)
            if one is None:
                continue
            spent, _ = timed(lambda name=name, engine=engine, one=one: own(name, many, engine, one[0]))
            made.append(f"| | {name}, {engine} | {one[1]:.0e} | {1e3 * one[2]:.0f} | {1e3 * spent:.0f} |")
            print(made[-1], one[0], flush=True)
    return made


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--page", type=Path)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    made = [
        f"| field | method | error | ms, one trajectory | ms, {ENSEMBLE} trajectories |", "|---|---|---|---|---|",
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
