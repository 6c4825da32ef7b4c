"""The order of every step that has a name, on seven manifolds: in numpy and in compiled code.

One random quadratic field and eight starts per manifold. Compiled code is measured on the same fields, in float64.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import TraceError
from liehom.flow.methods.named import step_named, step_names
from tests.flow.propagation import spaces

MANIFOLDS = ["S^2", "S^4", "CP^2", "Sym(3) at (1,1,2)", "H^3", "SU(3)/T", "V_2(R^4)"]
SYMPLECTIC = ["spherical midpoint", "isospectral midpoint", "variational midpoint", "moser-veselov", "splitting"]
"""Steps on duals of Lie algebras; tests/flow/methods measures their orders."""
NAMES = [name for name in step_names() if name not in SYMPLECTIC]
WINDOW = 0.25
HIGH = 7
"""From this order on few step sizes lie between the range of asymptotics and round-off, and the window is wider."""
WINDOW_OF_HIGH = 1.0
END = {"H^3": 4.0}
"""Final times other than 2: on the hyperboloid the field is slow."""
ROUND_OFF = {"numpy": 1e-16, "llvm": 1e-13}
"""Errors at least this large, relative to the points, are not round-off."""
MAX_HALVINGS = 7


@dataclass(frozen=True)
class Problem:
    """A field, starts on one orbit type, and the points at the final time t."""

    field: lh.GeneratorField
    starts: Any
    end: Any
    t: float


@cache
def problem(manifold: str) -> Problem:
    """The same generator for all starts, as compiled code has one psi; the end in extended precision."""
    space = spaces.make(manifold)
    rng = spaces.seeded(f"one field on {manifold}")
    r, n = space.representation.algebra.dimension, space.representation.size
    size = np.linalg.norm(space.starts, axis=-1).max()
    constant, linear, square = rng.normal(size=r), rng.normal(size=(n, r)) / size, rng.normal(size=(n, r)) / size**2
    scale, t = 1.0, END.get(manifold, 2.0)

    def psi(m: Any) -> Any:
        return scale * (constant + m @ linear + (m * m) @ square)

    speed = np.linalg.norm(lh.GeneratorField(space.representation, psi).vector(space.starts), axis=-1).max()
    scale = space.speed * size / speed
    field = lh.GeneratorField(space.representation, psi)
    end = lh.integrate(field, (0, t), space.starts.astype(np.longdouble), step=lh.LieTaylor(14), dt=t / 80, t_eval=[t])
    return Problem(field, space.starts, end.y[..., 0], t)


def run(manifold: str, step: lh.Step, engine: str, count: int, *, precise: bool = False) -> Any:
    """The points (8, N) after `count` steps; None if a step has no solution, as implicit ones that are too long."""
    p = problem(manifold)
    starts = p.starts.astype(np.longdouble) if precise else p.starts
    sol = lh.integrate(p.field, (0, p.t), starts, step=step, dt=p.t / count, t_eval=[p.t], engine=engine)
    return sol.y[..., 0] if sol.success else None


def slope(manifold: str, step: lh.Step, engine: str) -> tuple[float, list[float]]:
    """Order between the last two of the step sizes T, T/2, T/4, ... with errors above round-off, and the errors."""
    p, result = problem(manifold), []
    size = float(np.linalg.norm(p.starts, axis=-1).max())
    for k in range(MAX_HALVINGS):
        end = run(manifold, step, engine, 2**k, precise=engine == "numpy")
        if end is None:
            continue
        result.append(float(np.sqrt(np.mean(np.sum((end - p.end) ** 2, axis=-1)))) / size)
        if result[-1] < ROUND_OFF[engine]:
            result.pop()
            break
    return float(np.log2(result[-2] / result[-1])), result


# On H^3 two of the eight equations of backward Euler of size T have no solution that belongs to the step: the solutions
# of x = s F(x) from x = 0 turn back at s = 0.84 and at 0.55.
@pytest.mark.filterwarnings("ignore:status -1")
@pytest.mark.parametrize("engine", ["numpy", "llvm"])
@pytest.mark.parametrize("manifold", MANIFOLDS)
@pytest.mark.parametrize("name", NAMES)
def test_every_named_step_has_its_order(name: str, manifold: str, engine: str) -> None:
    step = step_named(name)
    if engine == "llvm" and isinstance(step, lh.methods.ExponentialRosenbrock):
        with pytest.raises(TraceError, match="exponentials of matrices"):
            run(manifold, step, engine, 1)
        return
    if engine == "llvm" and step.order >= HIGH:
        ends = [run(manifold, step, engine, 2) for engine in ("numpy", "llvm")]
        assert np.abs(ends[0] - ends[1]).max() < 1e-11 * np.abs(ends[0]).max()
        return
    window = WINDOW if step.order < HIGH else WINDOW_OF_HIGH
    order, errors = slope(manifold, step, engine)
    assert step.order - window < order < step.order + 1.5 + window, errors


@pytest.mark.parametrize("manifold", MANIFOLDS)
def test_a_wrong_coefficient_is_noticed(manifold: str) -> None:
    """The negative control: the classical method with two weights exchanged has order 1."""
    right = lh.tableau("rk4")
    wrong = lh.methods.Tableau(right.a, [right.b[1], right.b[0], *right.b[2:]], order=1, name="wrong")
    assert slope(manifold, lh.RKMK(wrong), "numpy")[0] < 1 + WINDOW
