"""Costs of the landing of Taylor steps on ten kinds of orbits: `python -m tests.benchmarks.landings`.

The table has the processor time of a compiled step and trajectory, for one trajectory and for a thousand, as the step
lands points and by exponentials, and how far points are from their orbits after 100,000 steps. The size of a step is
0.05, and the generator is affine with random coefficients that depend on the name of the orbit alone.
"""

import argparse
import time
from collections.abc import Iterator
from contextlib import contextmanager
from unittest.mock import patch

import numpy as np

import liehom as lh
from liehom.flow.methods.taylor import InvariantSeries, Taylor
from liehom.flow.steps.step import Generator
from tests.benchmarks.integration_page import table
from tests.flow.propagation import spaces
from tests.flow.propagation.spaces import Space

NAMES = ("CP^2", "Sym(3) at (1,2,3)", "SU(3)/T", "Gr(2,4)", "V_2(R^4)", "H^3", "S^4", "Sym(4)", "SE(3)*", "so(4)*")
DT, REPEATS = 0.05, 3


def orbit(name: str) -> Space:
    """A space of tests/flow/propagation, or one of three others."""
    rng = spaces.seeded(name)
    if name == "Sym(4)":
        rho = lh.sym_conjugation(4)
        return Space(rho, spaces.moved(rho, spaces.symmetric([1, 2, 3, 4]), rng), 6)
    if name in ("SE(3)*", "so(4)*"):
        rho = lh.coadjoint(lh.euclidean(3) if name == "SE(3)*" else lh.so(4))
        return Space(rho, rng.normal(size=(spaces.FIELDS, 6)), 4)
    return spaces.make(name)


def field_on(name: str) -> lh.GeneratorField:
    """An affine generator; on orbits that are not compact one whose trajectories stay in a bounded part."""
    space, rng = orbit(name), spaces.seeded(f"affine on {name}")
    r, n = space.representation.algebra.dimension, space.representation.size
    if name == "SE(3)*":  # a body in a fluid, whose energy bounds the points
        return lh.hamiltonian_field(lh.euclidean(3), lambda m: (m * m * [1, 0.6, 0.4, 0.5, 0.8, 1.1]).sum(-1) / 2)
    linear, constant = 0.3 * rng.normal(size=(n, r)) / np.linalg.norm(space.starts[0]), 0.3 * rng.normal(size=r)
    if name == "H^3":  # rotations only
        turns = [np.array_equal(a.to_numpy(), -a.to_numpy().T) for a in space.representation.matrices]
        linear, constant = linear * turns, constant * turns
    return lh.GeneratorField(space.representation, lambda m: m @ linear + constant)


@contextmanager
def by_exponentials() -> Iterator[None]:
    """Taylor steps without equivariant maps."""
    with patch("liehom.flow.methods.taylor.invariant_landing", return_value=None):
        yield


def cost(name: str, n: int, lanes: int, steps: int) -> float:
    """Processor time (ns) of a step of order n and a trajectory."""
    starts = orbit(name).starts
    start = starts[0] if lanes == 1 else np.resize(starts, (lanes, starts.shape[1]))
    propagator, span = lh.Propagator(field_on(name), step=Taylor(n), engine="llvm"), (0.0, DT * steps)
    times = []
    for _ in range(REPEATS + 1):
        begin = time.process_time()
        assert propagator(span, start, dt=DT, t_eval=[span[1]]).success
        times.append(time.process_time() - begin)
    return 1e9 * min(times[1:]) / (steps * lanes)


def distance(name: str, n: int, steps: int) -> float:
    """The largest change of a point after a run by another landing, relative to the point; NaN without a map."""
    space, field = orbit(name), field_on(name)
    end = lh.integrate(
        field, (0.0, DT * steps), space.starts, step=Taylor(n), dt=DT, t_eval=[DT * steps], engine="llvm"
    )
    action, points = lh.Action(space.representation), end.y[..., 0]
    psi = Generator(field, space.dimension, space.starts)
    local = Taylor(n).at(action, psi, points, np.zeros((len(points), 1)))
    if not isinstance(local, InvariantSeries):
        return np.nan
    return float(np.abs(local.point(np.zeros((len(points), 1))) - points).max() / np.abs(points).max())


def rows(names: tuple[str, ...], n: int, lanes: tuple[int, ...], work: int, steps: int) -> Iterator[list[str]]:
    """The cells of the table."""
    for name in names:
        cells = []
        for count in lanes:
            now = cost(name, n, count, work // count)
            with by_exponentials():
                before = cost(name, n, count, work // count)
            cells += [f"{before:.0f}", f"{now:.0f}"]
        yield [name, *cells, f"{distance(name, n, steps):.1e}"]


def lines(n: int, names: tuple[str, ...] = NAMES, work: int = 100_000, steps: int = 100_000) -> list[str]:
    """The table in Markdown."""
    head = ["orbit", "N = 1, by exponentials (ns)", "N = 1", "N = 1000, by exponentials", "N = 1000", "off the orbit"]
    return [f"Taylor({n})", "", *table(head, rows(names, n, (1, 1000), work, steps))]


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--order", type=int, default=8)
    for line in lines(parser.parse_args().order):
        print(line, flush=True)
