"""Three solvers of the linear system of Theorem 5, in floats, in QQ and over rational functions: the same solutions.

    e rho(zeta) w - l c w = r,    zeta in g_m

The points and right-hand sides are polynomials in s; the floating and the exact solver get their values at one s.
"""

from typing import Any, NamedTuple

import numpy as np
import pytest

import liehom as lh
from liehom.exact.scalars.function_field import FunctionField
from liehom.flow.steps.range_solver import RangeSolver
from liehom.flow.steps.symbolic_problem import SymbolicRange, object_array, solve_exactly
from tests.flow.steps.support import spin

QQ = lh.QQ
S = QQ.convert("1/3")

REPRESENTATIONS = {
    "so(3) on R^3": spin, "so(2) on R^2": lambda: lh.defining(lh.so(2)), "so(4) on R^4": lambda: lh.defining(lh.so(4)),
    "so(3) on symmetric matrices": lambda: lh.sym_conjugation(3),
    "so(2) on symmetric matrices": lambda: lh.sym_conjugation(2), "sl(2) on R^2": lambda: lh.defining(lh.sl(2)),
    "gl(2) on R^2": lambda: lh.defining(lh.gl(2)), "so(2,1) on R^3": lambda: lh.defining(lh.so(2, 1)),
}  # fmt: skip


class System(NamedTuple):
    """A linear system with coefficients in QQ[s], and the field of its functions of s."""

    representation: Any
    field: FunctionField
    point: Any
    velocity: Any
    right: Any
    leading: int
    factor: Any


def random_rational(rng: np.random.Generator, count: int) -> list[Any]:
    return [QQ.convert(f"{rng.integers(-9, 10)}/{rng.integers(1, 4)}") for _ in range(count)]


def system(name: str, seed: int, *, leading: int, factor: str, solvable: bool) -> System:
    rng = np.random.default_rng(seed)
    representation = REPRESENTATIONS[name]()
    field = FunctionField(["s"])
    s, action = field.variables[0], lh.Action(representation)

    def line(count: int) -> Any:
        a, b = (object_array([field.convert(x) for x in random_rational(rng, count)]) for _ in range(2))
        return a + s * b

    dimension = representation.algebra.dimension
    point = line(representation.size)
    velocity = action.infinitesimal(line(dimension), point)
    e = QQ.convert(factor)
    if solvable:
        isotropy = SymbolicRange(action, field, point).projector @ line(dimension)
        right = field.convert(e) * action.infinitesimal(isotropy, velocity) - 2 * leading * velocity
    else:
        right = action.infinitesimal(line(dimension), point)
    return System(representation, field, point, velocity, right, leading, e)


def at(field: FunctionField, x: Any) -> Any:
    """The value of a rational function at s = S, in QQ."""
    value = x.numerator(S)
    for i, power in x.powers:
        value = value / field.atoms[i](S) ** power
    return QQ.convert(value)


def solutions(given: System) -> dict[str, tuple[list[float], float]]:
    """(zeta, c) by each of the solvers."""
    representation, field = given.representation, given.field
    action = lh.Action(representation)
    point, velocity, right = ([at(field, x) for x in row] for row in (given.point, given.velocity, given.right))
    exact = solve_exactly(representation, point, velocity, right, given.leading, given.factor)

    symbolic = SymbolicRange(action, field, given.point)
    symbolic.prepare(given.velocity, given.leading, field.convert(given.factor))
    zeta, c = symbolic.solve(given.right)
    zeta = zeta if symbolic.row is None else zeta[0] * symbolic.row

    m, w, r = (np.array([float(x) for x in row]) for row in (point, velocity, right))
    floating = RangeSolver(action, action.isotropy_frame(m, exact.dimension), w, given.leading, float(given.factor))
    numbers, clock, residual = floating.solve(r)

    assert exact.rank == int(floating.rank) == symbolic.rank
    assert exact.dimension == symbolic.orbit_dimension
    assert exact.solvable is bool(np.abs(residual).max() < 1e-9 * max(1.0, np.abs(r).max()))
    assert np.allclose([float(x) for x in exact.residual], residual, rtol=0, atol=1e-9 * max(1.0, np.abs(r).max()))
    return {
        "exact": ([float(x) for x in exact.zeta], float(exact.c)),
        "symbolic": ([float(at(field, x)) for x in zeta], float(at(field, c))),
        "floating": (numbers.tolist(), float(clock)),
    }


def assert_alike(found: dict[str, tuple[list[float], float]]) -> None:
    zeta, c = found["exact"]
    size = max(1.0, np.abs(zeta).max(), abs(c))
    for name, (other, clock) in found.items():
        assert np.allclose(other, zeta, rtol=0, atol=1e-9 * size), (name, other, zeta)
        assert abs(clock - c) <= 1e-9 * size, (name, clock, c)


@pytest.mark.parametrize("leading", [1, 2])
@pytest.mark.parametrize("factor", ["1/2", "1"])
@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_a_system_that_has_solutions_has_the_same_in_all_solvers(name: str, factor: str, leading: int) -> None:
    for seed in range(2):
        assert_alike(solutions(system(name, seed, leading=leading, factor=factor, solvable=True)))


@pytest.mark.parametrize("name", [n for n in REPRESENTATIONS if n.startswith("so(") and "R^" in n and "," not in n])
def test_a_right_hand_side_tangent_to_the_orbit_has_the_same_least_squares_solution(name: str) -> None:
    """The metric of the symbolic solver is the Euclidean one if rho is by skew-symmetric matrices."""
    for seed in range(3):
        assert_alike(solutions(system(name, seed, leading=1, factor="1/2", solvable=False)))


def test_the_solution_found_solves_the_system() -> None:
    """A control: c = 2 and zeta are those that the right-hand side was made from, as the solution is unique."""
    result = solutions(system("so(3) on R^3", 0, leading=1, factor="1/2", solvable=True))
    assert all(abs(c - 2) < 1e-9 for _, c in result.values())


@pytest.mark.parametrize("name", ["so(3) on R^3", "so(4) on R^4", "sl(2) on R^2", "gl(2) on R^2", "so(2,1) on R^3"])
def test_the_cone_is_near_where_the_ratio_of_determinants_is_small(name: str) -> None:
    """The ratio in full for A(w) = |w| [e rho(g_m) u, u], and the bound of |A^+| that compiled code tests first."""
    representation = REPRESENTATIONS[name]()
    action, rng = lh.Action(representation), np.random.default_rng(7)
    seen = []
    for _ in range(30):
        m = rng.normal(size=representation.size)
        w, change = (action.infinitesimal(rng.normal(size=representation.algebra.dimension), m) for _ in range(2))
        change = change * 10 ** rng.uniform(-1, 1)
        frame = action.isotropy_frame(m, representation.orbit_dimension(m))

        def full(velocity: Any, frame: Any = frame) -> Any:
            return np.linalg.norm(velocity) * RangeSolver(action, frame, velocity, 1, 0.5).matrix

        solver, across = RangeSolver(action, frame, w, 1, 0.5), change - (change @ w) / (w @ w) * w
        ratios = [
            np.linalg.det(full(w + s * across) @ full(w).T @ np.linalg.inv(full(w) @ full(w).T)) for s in (-2, -1, 1, 2)
        ]
        if abs(min(ratios) - 1 / 8) > 1e-6:
            assert solver.is_near_cone(change) == (min(ratios) < 1 / 8)
            seen.append(min(ratios) < 1 / 8)
        assert solver._inverse_square() >= (1 - 1e-9) / np.linalg.svd(solver.matrix)[1][-1] ** 2

    compact = name.startswith(("so(3)", "so(4)"))  # no tangent vector of a sphere is in the cone
    assert len(seen) > 20 and set(seen) == ({False} if compact else {False, True})
