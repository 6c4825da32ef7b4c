"""Equations of implicit steps: fixed point, Newton's method, Krylov spaces, and the independence of trajectories."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st
from scipy.optimize import brentq

import liehom as lh
from liehom.base.errors import ConvergenceError
from liehom.flow.steps import implicit as newton_module
from liehom.flow.steps.implicit import Equation, gmres, solve_implicitly
from tests.sampling import examples

RHO = lh.adjoint(lh.so(3))
NORTH = np.array([0.0, 0.0, 1.0])


def relaxing(rate: float) -> lh.GeneratorField:
    """m' = rate (e - <m, e> m): every point but -e goes to e."""
    return lh.GeneratorField(RHO, lambda m: rate * np.cross(m, NORTH))


def sphere(n: int, seed: int = 0) -> Any:
    m = np.random.default_rng(seed).normal(size=(n, 3))
    return m / np.linalg.norm(m, axis=-1, keepdims=True)


# -- the solutions -------------------------------------------------------------------------------------------
def angle_after(theta: float, z: float) -> float:
    """The angle from e after a step of backward Euler with K dt = z: theta - x, x = z sin(theta - x)."""
    grid = np.linspace(0.0, theta, 400)
    last = int(np.flatnonzero((z * np.sin(theta - grid) - grid) >= 0)[-1])
    return theta - float(brentq(lambda x: z * np.sin(theta - x) - x, grid[last], min(grid[last] + np.pi / 400, theta)))


@settings(max_examples=examples(60), deadline=None)
@given(st.floats(0.01, 3.1), st.sampled_from([0.3, 1.0, 3.0, 10.0, 100.0, 1000.0, 1e6]))
@example(3.0625, 10.0)  # a short step of Newton's method leads against the flow, to another solution
@example(3.0941, 1e6)
def test_backward_euler_ends_at_the_angle_where_the_pseudo_transient_ends(theta: float, z: float) -> None:
    if 1 < z * np.sin(theta) / theta < 1.01:
        return  # next to a double root
    start = np.array([np.sin(theta), 0.0, np.cos(theta)])
    end = lh.integrate(relaxing(z), (0, 1), start, step=lh.BackwardEuler(), dt=1.0).y[:, -1]
    assert abs(np.arctan2(end[0], end[2]) - angle_after(theta, z)) < 1e-11
    assert abs(end @ end - 1) < 1e-13


@pytest.mark.parametrize("z", [10.0, 100.0])
def test_compiled_steps_leave_the_choice_of_the_solution_to_numpy(z: float) -> None:
    angles = np.array([3.0625, 3.0743, 2.0, 3.09, 1.0])
    starts = np.stack([np.sin(angles), 0 * angles, np.cos(angles)], axis=-1)
    sol = lh.integrate(relaxing(z), (0, 3), starts, step=lh.BackwardEuler(), dt=1.0, t_eval=[1.0, 3.0], engine="llvm")
    wanted = [angle_after(theta, z) for theta in angles]
    np.testing.assert_allclose(np.arctan2(sol.y[:, 0, 0], sol.y[:, 2, 0]), wanted, rtol=0, atol=1e-11)


@pytest.mark.parametrize("z", [1.0, 10.0, 1000.0])
@pytest.mark.parametrize("name", ["radau2a", "radau2a3", "gauss2", "sdirk2", "lobatto3c", "trapezoidal"])
def test_stages_are_solved_to_round_off_however_stiff(name: str, z: float) -> None:
    step = lh.RKMK(name)
    starts = sphere(30)
    starts = starts[starts[:, 2] > -0.5]
    sol = lh.integrate(relaxing(10 * z), (0, 0.1), starts, step=step, dt=0.1)
    assert (sol.statuses == 0).all()
    action, psi = lh.Action(RHO), lh.steps.Generator(relaxing(10 * z), 2)
    h = np.full((len(starts), 1), 0.1)
    xi = step.at(action, psi, starts, np.zeros((len(starts), 1))).factors(h)[0]
    if name.startswith("radau") or name == "lobatto3c":  # stiffly accurate: xi is the generator of the last stage
        k = h * psi(action.act(xi, starts), h)
        rest = xi - step.at(action, psi, starts, 0 * h).factors(h)[0]
        assert np.isfinite(k).all() and not rest.any()
    np.testing.assert_allclose(np.linalg.norm(sol.y[..., -1], axis=-1), 1.0, rtol=0, atol=1e-13)


def test_equations_of_stages_are_satisfied() -> None:
    rows = (((0, 0.25), (1, -0.25)), ((0, 0.25), (1, 5 / 12)))

    def function(y: list[Any]) -> list[Any]:
        return [-40 * np.sin(v) + 0.3 for v in y]

    x = solve_implicitly(function, np.zeros((2, 5, 3)), 1.0, rows=rows)
    y = [sum(a * x[j] for j, a in row) for row in rows]
    np.testing.assert_allclose(x, np.stack(function(y)), rtol=0, atol=1e-13)


# -- what a solution does not depend on ----------------------------------------------------------------------
@pytest.mark.parametrize("step", [lh.BackwardEuler(), lh.RKMK("radau2a"), lh.RKMK("gauss3")], ids=repr)
def test_a_trajectory_is_the_same_alone_and_in_an_ensemble(step: lh.steps.Step) -> None:
    def psi(m: Any) -> Any:
        return (1 + 40 * m[..., 1:2] ** 2) * np.cross(m, NORTH) - m * [1.0, 0.5, 0.2]

    starts = sphere(7)
    options: dict[str, Any] = {"step": step, "dt": 0.1}
    field = lh.GeneratorField(RHO, psi)
    many = lh.integrate(field, (0, 0.5), starts, **options)
    for start, y in zip(starts, many.y, strict=True):
        alone = lh.integrate(field, (0, 0.5), start, **options)
        np.testing.assert_allclose(alone.y, y, rtol=0, atol=2e-15)


def test_fast_fixed_points_are_those_of_plain_iteration_bit_for_bit() -> None:
    shift = np.random.default_rng(1).normal(size=(6, 3))

    def function(x: Any) -> Any:
        return 0.1 * np.cos(x + shift)

    x = np.zeros((6, 3))
    for _ in range(60):
        x = function(x)
    np.testing.assert_allclose(solve_implicitly(function, np.zeros((6, 3)), 0.1), x, rtol=0, atol=1e-16)


def test_derivatives_by_differences_give_the_same_solution() -> None:
    """psi with np.where and psi of one trajectory with m[0] do not run on Jets, or not on an axis of directions."""
    plain = lh.GeneratorField(RHO, lambda m: 100 * np.cross(m, NORTH))
    branching = lh.GeneratorField(RHO, lambda m: np.where(m[..., :1] > -2, 100.0, 0.0) * np.cross(m, NORTH))
    single = lh.GeneratorField(RHO, lambda m: 100 * np.array([m[1], -m[0], 0 * m[2]]))
    jets = lh.GeneratorField(RHO, lambda m: 100 * np.stack([m[1], -m[0], 0 * m[2]]))
    wanted = lh.integrate(plain, (0, 1), [0.6, 0.0, 0.8], step=lh.RKMK("radau2a"), dt=0.1)
    for field in (branching, single, jets):
        sol = lh.integrate(field, (0, 1), [0.6, 0.0, 0.8], step=lh.RKMK("radau2a"), dt=0.1)
        np.testing.assert_allclose(sol.y, wanted.y, rtol=0, atol=1e-15)


def test_an_equation_without_solution_is_reported() -> None:
    with pytest.raises(ConvergenceError, match="smaller step size"):
        solve_implicitly(lambda x: 1 + x * x, np.zeros(1), 1.0)


def test_a_branch_that_turns_back_is_not_taken_for_a_solution() -> None:
    """x = s F(x) from x = 0: for F(0) = 0.3 the branch ends at s = 0.94, although x = F(x) has a solution near 9.

    A trajectory is followed to the end only if it is wanted and all its parts are solved; the others stay at 0.
    """
    constants = np.array([0.3, 0.2, 0.2])[None, :, None]
    equation = Equation(lambda y: [constants[0] + y[0] ** 2 - 0.1 * y[0] ** 3], [((0, 1.0),)])
    wanted = np.array([True, True, False])[None, :, None]
    x, reached = newton_module._followed(equation, np.zeros((1, 3, 1)), wanted, 1.0, False)
    assert reached.ravel().tolist() == [False, True, False]
    assert x[0, 2, 0] == 0 and 0 < x[0, 0, 0] < 1
    assert abs(equation.value(x) - x)[0, 1, 0] < 1e-15 and x[0, 1, 0] < 0.5


def test_the_error_names_the_trajectories_without_a_solution() -> None:
    constants = np.array([[[0.1], [1.0]], [[3.0], [0.2]]])  # x = c + x^2 has a solution for c <= 1/4
    with pytest.raises(ConvergenceError) as caught:
        solve_implicitly(lambda x: constants + x * x, np.zeros((2, 2, 1)), 1.0)
    unsolved = caught.value.unsolved
    assert unsolved is not None and unsolved.tolist() == [[False, True], [True, False]]
    copied = pickle.loads(pickle.dumps(caught.value)).unsolved
    assert copied is not None and copied.tolist() == unsolved.tolist()


# -- large and coupled systems -------------------------------------------------------------------------------
def wave(n: int) -> Any:
    a = 2 * np.pi * np.arange(n) / n
    m = np.stack([np.cos(a) + 0.2 * np.sin(3 * a), np.sin(a), 0.3 * np.cos(2 * a) + 0.5], axis=-1)
    return m / np.linalg.norm(m, axis=-1, keepdims=True)


def test_coupled_spins_are_solved_as_one_system() -> None:
    """Every spin is a trajectory, and psi couples them: the chain agrees with the product of spheres."""
    chain = lh.LandauLifshitz((8,), exchange=8.0, damping=0.5, anisotropy=0.3)
    sol = chain.integrate((0, 0.2), wave(8), step=lh.BackwardEuler(), dt=0.1)
    assert sol.status == 0
    joint = chain.joint()
    wanted = lh.integrate(joint.field, (0, 0.2), joint.point(wave(8)), step=lh.BackwardEuler(), dt=0.1)
    np.testing.assert_allclose(np.moveaxis(sol.y, -1, 0), joint.spins(wanted.y.T), rtol=0, atol=1e-12)


def test_krylov_spaces_give_the_solution_of_elimination(monkeypatch: pytest.MonkeyPatch) -> None:
    def function(x: Any) -> Any:
        return -50 * np.sin(x) + 5 * np.roll(x, 1, axis=-1) + 0.3

    start = np.zeros((3, 6))
    dense = solve_implicitly(function, start, 1.0)
    monkeypatch.setattr(newton_module, "MAX_DENSE", 0)
    calls: list[int] = []
    monkeypatch.setattr(newton_module, "gmres", lambda *args, **how: calls.append(1) or gmres(*args, **how))
    krylov = solve_implicitly(function, start, 1.0)
    assert calls
    np.testing.assert_allclose(krylov, dense, rtol=0, atol=1e-14)


@settings(max_examples=examples(20), deadline=None)
@given(st.integers(0, 10**6))
def test_gmres_solves_each_system_as_alone(seed: int) -> None:
    rng = np.random.default_rng(seed)
    a = np.eye(5) + 0.3 * rng.normal(size=(4, 5, 5))
    b = rng.normal(size=(4, 5))
    result = gmres(lambda x: np.einsum("kij,kj->ki", a, x), b, (-1,), rtol=1e-13)
    np.testing.assert_allclose(np.einsum("kij,kj->ki", a, result), b, rtol=0, atol=1e-9)
    alone = gmres(lambda x: x @ a[2].T, b[2:3], (-1,), rtol=1e-13)
    np.testing.assert_allclose(alone[0], result[2], rtol=0, atol=1e-8)


# -- derivatives ---------------------------------------------------------------------------------------------
@pytest.mark.parametrize("exponential", ["exp", "series", "expm", "cayley"])
@pytest.mark.parametrize("size", [0.3, 1.5, 5.0])
def test_tangents_of_exponentials_agree_with_central_differences(exponential: str, size: float) -> None:
    action = lh.Action(lh.sym_conjugation(3), exponential)
    rng = np.random.default_rng(2)
    x, v, m = size * rng.uniform(-1, 1, size=(4, 3)), rng.normal(size=(4, 3)), rng.normal(size=(4, 6))
    e = 1e-5
    wanted = (action.act(x + e * v, m) - action.act(x - e * v, m)) / (2 * e)
    result = action.act(lh.Jet(np.stack([x, v])), m)
    np.testing.assert_allclose(result.coefficient(0), action.act(x, m), rtol=0, atol=1e-14)
    np.testing.assert_allclose(result.coefficient(1), wanted, rtol=0, atol=1e-6 * max(1.0, size))


def test_blocks_are_the_derivatives_of_stages() -> None:
    equation = Equation(lambda y: [np.sin(y[0]), y[1] * y[1]], (((0, 0.5),), ((0, 0.25), (1, 0.75))))
    x = np.random.default_rng(3).normal(size=(2, 4, 3))
    y = equation.arguments(x)
    blocks = equation.blocks(x)
    np.testing.assert_allclose(blocks[0], np.cos(y[0])[..., None] * np.eye(3), rtol=0, atol=1e-14)
    np.testing.assert_allclose(blocks[1], 2 * y[1][..., None] * np.eye(3), rtol=0, atol=1e-14)
    v = np.random.default_rng(4).normal(size=x.shape)
    along = np.stack([np.cos(y[0]) * 0.5 * v[0], 2 * y[1] * (0.25 * v[0] + 0.75 * v[1])])
    np.testing.assert_allclose(equation.along(x, v), along, rtol=0, atol=1e-14)
