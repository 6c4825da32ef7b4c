"""Many rigid bodies and a large grid of spins by JAX, beside the limits of memory and arithmetic.

    python -m tests.benchmarks.gpu                    # 10^6 bodies, 1024 x 1024 spins: on a GPU, if JAX finds one
    python -m tests.benchmarks.gpu --bodies 1000 --grid 16 --steps 8

Memory: a step whose operations are one kernel reads and writes the points once; one that is several reads and writes
what lies between them too.  Arithmetic: the operations of the step, counted in its graph.  What the device can do of
both is measured in the same run, by copying an array and by chains of multiplications and additions.
"""

import argparse
import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import liehom as lh
from liehom.flow.engines.jax_loops import enabled_x64
from liehom.flow.engines.traced_step import traced_step
from liehom.flow.tracing.graph import needed
from tests.benchmarks.integration_methods import jitted

H = 0.01
CHAIN = 256


def taken(run: Callable[[], Any], rounds: int = 3) -> float:
    """Seconds on the clock, the least of some rounds after a first one: a GPU does not use the processor's time."""
    run().block_until_ready()
    found = []
    for _ in range(rounds):
        begin = time.perf_counter()
        run().block_until_ready()
        found.append(time.perf_counter() - begin)
    return min(found)


def per_step(run: Callable[[int], Any], steps: int) -> float:
    """Seconds for a step: the difference of a long and a short run."""
    short = max(1, steps // 4)
    return max(taken(lambda: run(steps)) - taken(lambda: run(short)), 1e-12) / (steps - short)


def limits(size: int) -> dict[str, float]:
    """Bytes and operations in a second on arrays of `size` numbers."""
    import jax
    import jax.numpy as jnp

    x = jnp.linspace(0.0, 1.0, size)
    copy = jax.jit(lambda x, n: jax.lax.fori_loop(0, n, lambda _, y: y + 1.0, x))

    def chain(x: Any, n: Any) -> Any:
        def body(_: Any, y: Any) -> Any:
            for _ in range(CHAIN):
                y = y * 0.5 + 0.25
            return y

        return jax.lax.fori_loop(0, n, body, x)

    chained = jax.jit(chain)
    return {
        "bytes": 16 * size / per_step(lambda n: copy(x, n), 16),
        "operations": 2 * CHAIN * size / per_step(lambda n: chained(x, n), 8),
    }


def bodies(count: int, steps: int, methods: tuple[lh.Step, ...]) -> list[dict[str, Any]]:
    """Rigid bodies: a propagator on a JAX array, and the step itself under jax.jit."""
    import jax.numpy as jnp

    weights = [1.0, 0.5, 0.25]
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * np.array(weights))
    m = np.random.default_rng(0).normal(size=(count, 3))
    start = m / np.linalg.norm(m, axis=-1, keepdims=True)
    y0, rows = jnp.asarray(start), []
    for step in methods:
        graph = traced_step(lh.Action(field.representation), field, step, start[:8], 2, nominal=True)
        operations = sum(x.op not in ("const", "input", "get") for x in needed(graph.outputs))

        loop = jitted(field, step, 2)
        integrated = _integrated(field, step)
        for name, run in (("a propagator", integrated), ("the step in jax.jit", lambda m, n, loop=loop: loop(m, H, n))):
            time_of_step = per_step(lambda n, run=run: run(y0, n), steps)
            error = float(np.abs(np.linalg.norm(np.asarray(run(y0, steps)).reshape(count, 3), axis=-1) - 1).max())
            rows.append(_row(f"{count} rigid bodies, {step!r}, {name}", count, time_of_step, operations, error))
    return rows


def _integrated(field: lh.GeneratorField, step: Any) -> Callable[[Any, int], Any]:
    """A propagator, of which the loop is compiled once for each rounded number of steps."""
    propagator = lh.Propagator(field, step, engine="jax", clock="nominal")
    return lambda m, n: propagator((0.0, n * H), m, dt=H, t_eval=[n * H]).y


def grid(size: int, steps: int, methods: tuple[lh.Step, ...]) -> list[dict[str, Any]]:
    """Landau-Lifshitz spins on a square grid, coupled: a propagator, by array code for the whole grid."""
    import jax.numpy as jnp

    llg = lh.LandauLifshitz((size, size), exchange=1.0, anisotropy=0.1, damping=0.05)
    m = np.random.default_rng(0).normal(size=(size, size, 3))
    m0 = jnp.asarray(m / np.linalg.norm(m, axis=-1, keepdims=True))
    rows = []
    for step in methods:
        loop, propagated = jitted(llg.field, step, 2), _integrated(llg.field, step)
        time_of_step = per_step(lambda n, run=propagated: run(m0, n), steps)
        end = np.asarray(propagated(m0, steps))[..., -1]
        assert float(llg.energy(end)) < float(llg.energy(np.asarray(m0)))
        error = float(np.abs(np.linalg.norm(end, axis=-1) - 1).max())
        operations = _operations(loop, m0) / size**2
        rows.append(_row(f"{size} x {size} spins, {step!r}", size**2, time_of_step, operations, error))
    return rows


def _operations(loop: Any, m: Any) -> float:
    """Floating-point operations of one step, as the compiler counts them."""
    cost = loop.lower(m, H, 1).compile().cost_analysis()
    cost = cost[0] if isinstance(cost, list) else cost
    return float((cost or {}).get("flops", math.nan))


def _row(name: str, count: int, seconds: float, operations: float, error: float) -> dict[str, Any]:
    return {"name": name, "count": count, "seconds": seconds, "operations": operations, "norm": error}


def lines(rows: list[dict[str, Any]], device: dict[str, float]) -> list[str]:
    """Of each row the time of a step beside the least that memory and arithmetic allow."""
    head = f"memory {device['bytes'] / 1e9:.1f} GB/s, arithmetic {device['operations'] / 1e9:.1f} GFLOP/s, as measured"
    made = [head]
    for row in rows:
        memory = row["count"] * 2 * 3 * 8 / device["bytes"]
        arithmetic = row["count"] * row["operations"] / device["operations"]
        floor = max(memory, 0.0 if math.isnan(arithmetic) else arithmetic)
        each = row["seconds"] / row["count"] * 1e9
        made.append(
            f"{row['name']}: {row['seconds'] * 1e6:.1f} us for a step, {each:.3f} ns for each; "
            f"least by memory {memory * 1e6:.1f} us, by {row['operations']:.0f} operations {arithmetic * 1e6:.1f} us; "
            f"{row['seconds'] / floor:.1f} times the larger; norms to {row['norm']:.0e}"
        )
    return made


def measured(
    count: int, size: int, steps: int, of_bodies: tuple[lh.Step, ...], of_spins: tuple[lh.Step, ...]
) -> list[str]:
    """The report for so many bodies, a grid of size x size, loops of so many steps, and the methods for both."""
    import jax

    with enabled_x64():
        device = limits(max(3 * count, 1000))
        rows = bodies(count, steps, of_bodies) + grid(size, steps, of_spins)
        return [f"JAX {jax.__version__} on {jax.devices()[0].device_kind}", *lines(rows, device)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bodies", type=int, default=10**6)
    parser.add_argument("--grid", type=int, default=1024)
    parser.add_argument("--steps", type=int, default=64)
    options = parser.parse_args()
    methods = (lh.Corrected(lh.Euler(), 2), lh.LieTaylor(4)), (lh.Heun(), lh.RKMK("rk4"), lh.LieTaylor(4))
    print("\n".join(measured(options.bodies, options.grid, options.steps, *methods)))


if __name__ == "__main__":
    main()
