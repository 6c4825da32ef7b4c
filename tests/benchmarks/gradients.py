"""Compile times of the engine "jax", and gradients against differences, on R^13, S^4 and CP^2.

python -m tests.benchmarks.gradients            # all problems, in CPU seconds
python -m tests.benchmarks.gradients attitude   # one of them
"""

import sys
import time
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

import liehom as lh
from tests.benchmarks.integration_problems import Problem, projective_plane, sphere4

LANES, STEPS, H = 100, 100, 0.02


@cache
def attitude() -> tuple[lh.GeneratorField, Callable[[int], Any], int]:
    """A rigid body on R^13: so(3) turns its quaternion, angular velocity, position and velocity."""
    turns = [np.asarray(a.to_numpy(), float) for a in lh.adjoint(lh.so(3)).matrices]
    quaternion = []
    for a in range(3):
        q = np.zeros((4, 4))
        q[0, a + 1], q[a + 1, 0] = -0.5, 0.5
        b, c = (a + 1) % 3 + 1, (a + 2) % 3 + 1
        q[b, c], q[c, b] = -0.5, 0.5
        quaternion.append(q)
    matrices = []
    for turn, q in zip(turns, quaternion, strict=True):
        whole = np.zeros((13, 13))
        whole[:4, :4] = q
        for k in (4, 7, 10):
            whole[k : k + 3, k : k + 3] = turn
        matrices.append(whole)
    field = lh.GeneratorField(
        lh.Representation.from_matrices(matrices),
        lambda m: -m[..., 4:7] / np.array([1.0, 2.0, 3.0]) + 0.1 * np.sin(m[..., 7:10]),
    )

    def starts(count: int) -> Any:
        return np.random.default_rng(0).normal(size=(count, 13))

    return field, starts, 3


def cpu(run: Callable[[], Any]) -> tuple[float, Any]:
    """Processor seconds of a call, and its result."""
    import jax

    begin = time.process_time()
    made = jax.block_until_ready(run())
    return time.process_time() - begin, made


def row(name: str, field: lh.GeneratorField, starts: Any, step: Any) -> str:
    """First and second call, first and second gradient, and the largest error of the gradient against differences."""
    import jax
    import jax.numpy as jnp

    propagator, y0 = lh.Propagator(field, step, engine="jax"), jnp.asarray(starts)

    def end(y: Any) -> Any:
        return propagator((0, STEPS * H), y, dt=H, t_eval=[STEPS * H]).y

    def cost(y: Any) -> Any:
        return jnp.sum(end(y) ** 3)

    first, second = cpu(lambda: end(y0))[0], cpu(lambda: end(y0))[0]
    gradient, again = cpu(lambda: jax.grad(cost)(y0)), cpu(lambda: jax.grad(cost)(y0))[0]
    e, errors = 1e-5, []
    for i in range(min(3, y0.shape[-1])):
        near, far = (float(cost(y0.at[0, i].add(k * e)) - cost(y0.at[0, i].add(-k * e))) for k in (1, 2))
        errors.append(abs((8 * near - far) / (12 * e) - float(gradient[1][0, i])))
    return (
        f"{name}, {step!r}: first {first:.2f} s, second {second:.3f} s; gradient {gradient[0]:.2f} s, "
        f"second {again:.3f} s; error {max(errors):.0e}"
    )


def main(names: list[str]) -> None:
    import jax

    jax.config.update("jax_enable_x64", True)
    jax.block_until_ready(jax.numpy.ones(3) + 1)
    problems: dict[str, Callable[[], tuple[Any, Any]]] = {
        "attitude": lambda: (attitude()[0], attitude()[1](LANES)),
        "S^4": lambda: _of(sphere4()),
        "CP^2": lambda: _of(projective_plane()),
    }
    for name in names or list(problems):
        field, starts = problems[name]()
        for step in (lh.LieTaylor(4), lh.LieTaylor(6)):
            print(row(name, field, starts, step), flush=True)


def _of(problem: Problem) -> tuple[Any, Any]:
    return problem.field, problem.starts(LANES)


if __name__ == "__main__":
    main(sys.argv[1:])
