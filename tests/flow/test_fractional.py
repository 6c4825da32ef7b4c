"""Linear fractional flows: exact solutions, poles, scipy on Riccati equations, complex maps, and what is refused."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import liehom as lh

numbers = st.floats(-1, 1)


def matrix(n):
    return st.lists(numbers, min_size=n * n, max_size=n * n).map(lambda x: np.array(x).reshape(n, n))


def moved(g, x, p):
    """(a x + b)(c x + d)^-1."""
    top, below = g[:p] @ np.vstack([x, np.eye(x.shape[1])]), g[p:] @ np.vstack([x, np.eye(x.shape[1])])
    return top @ np.linalg.inv(below)


@given(matrix(3), st.sampled_from([(1, 2), (2, 1)]))
def test_constant_generators_are_exponentials(m, sizes):
    p, q = sizes
    x = np.linspace(-0.3, 0.4, p * q).reshape(p, q)
    flow = lh.LinearFractional(p, q, m)
    found = flow.value(flow.integrate((0, 0.5), x, rtol=1e-10, atol=1e-10))
    np.testing.assert_allclose(found[-1], moved(expm(0.5 * m), x, p), rtol=1e-7, atol=1e-7)


def test_a_trajectory_passes_its_poles():
    turn = lh.LinearFractional(1, 1, [[0, 1], [-1, 0]])
    sol = turn.integrate((0, 40), [[0.0]], t_eval=np.linspace(0, 40, 21), rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(np.arctan(turn.value(sol)[:, 0, 0]), np.arctan(np.tan(sol.t)), atol=1e-7)


def test_a_generator_takes_args():
    turn = lh.LinearFractional(1, 1, lambda x, t, args: args * np.array([[0.0, 1.0], [-1.0, 0.0]]) + 0 * x)
    sol = turn.integrate((0, 1), [[0.0]], args=0.5, rtol=1e-10, atol=1e-10)
    assert abs(turn.value(sol)[-1, 0, 0] - np.tan(0.5)) < 1e-8


def test_infinity_is_said():
    turn = lh.LinearFractional(1, 1, [[0, 1], [-1, 0]])
    assert turn.value([1.0, 0.0]).tolist() == [[np.inf]]
    assert lh.LinearFractional(2, 2, np.zeros((4, 4))).value(np.eye(4)[:2].ravel()).tolist() == [[np.inf] * 2] * 2


def test_moebius_maps_of_the_sphere():
    m, x = np.array([[0.1j, 1], [-1, 0.2 - 0.3j]]), 0.3 + 0.1j
    flow = lh.LinearFractional(1, 1, m, over="C")
    sol = flow.integrate((0, 2), [[x]], rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(flow.value(sol)[-1], moved(expm(2 * m), np.array([[x]]), 1), atol=1e-8)
    same = lh.LinearFractional(
        1, 1, lambda z, t: (m.real + 0 * t[..., None, None], m.imag + 0 * t[..., None, None]), over="C"
    )
    again = same.integrate((0, 2), [[x]], rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(same.value(again)[-1], flow.value(sol)[-1], atol=1e-8)


A, B, C = np.array([[0, 1], [-1, -0.1]]), np.eye(2), np.array([[1, 0], [0, 0.5]])


def blocks(x, t):
    drive = (1 + np.sin(t))[..., None, None] * B
    top = np.concatenate([A + 0 * x, drive], axis=-1)
    return np.concatenate([top, np.concatenate([C + 0 * x, -A.T + 0 * x], axis=-1)], axis=-2)


@pytest.mark.parametrize("engine", ["numpy", "llvm"])
def test_a_riccati_equation_is_that_of_scipy(engine):
    flow = lh.LinearFractional(2, 2, blocks)
    sol = flow.integrate((0, 3), np.eye(2), rtol=1e-9, atol=1e-9, engine=engine)

    def right(t, y):
        x = y.reshape(2, 2)
        return (A @ x + (1 + np.sin(t)) * B - x @ C @ x + x @ A.T).ravel()

    peer = solve_ivp(right, (0, 3), np.eye(2).ravel(), rtol=1e-11, atol=1e-11).y[:, -1].reshape(2, 2)
    np.testing.assert_allclose(flow.value(sol)[-1], peer, atol=1e-7)


def test_a_generator_may_depend_on_the_point():
    spin = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 0]])
    flow = lh.LinearFractional(2, 1, lambda x: x[..., :1, :1] * spin)
    sol = flow.integrate((0, 1), [[1.0], [0.5]], rtol=1e-10, atol=1e-10)
    peer = solve_ivp(lambda t, x: x[0] * np.array([-x[1], x[0]]), (0, 1), [1.0, 0.5], rtol=1e-11, atol=1e-11).y[:, -1]
    np.testing.assert_allclose(flow.value(sol)[-1][:, 0], peer, atol=1e-8)


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: lh.LinearFractional(0, 1, np.eye(1)), "at least one each"),
        (lambda: lh.LinearFractional(1, 1, np.eye(3)), r"expected \(2, 2\)"),
        (lambda: lh.LinearFractional(1, 1, 1j * np.eye(2)), "over='C'"),
        (lambda: lh.LinearFractional(1, 1, np.eye(2), over="H"), "'R' or 'C'"),
        (lambda: lh.LinearFractional(2, 1, np.eye(3)).start([1, 2]), r"expected \(..., 2, 1\)"),
        (lambda: lh.LinearFractional(1, 1, np.eye(2)).start([[1j]]), "over='C'"),
    ],
)
def test_refusals(call, says):
    with pytest.raises(lh.InputError, match=says):
        call()


@pytest.mark.parametrize(("p", "q"), [(1, 1), (2, 1), (1, 2), (2, 2)])
def test_generators_are_asked_at_the_matrix_itself(p, q):
    """X' = X X0 X for a constant X0 has the solution X(t) = (1 - t X(0) X0)^-1 X(0)."""
    x, below, asked = np.linspace(-0.3, 0.5, p * q).reshape(p, q), np.linspace(0.2, 0.7, p * q).reshape(q, p), []

    def generator(point):
        asked.append(np.asarray(point))
        return np.block([[np.zeros((p, p)), np.zeros((p, q))], [-below, np.zeros((q, q))]]) + 0 * point[..., :1, :1]

    flow = lh.LinearFractional(p, q, generator)
    found = flow.value(flow.integrate((0, 0.5), x, rtol=1e-10, atol=1e-10, engine="numpy"))
    np.testing.assert_allclose(found[-1], np.linalg.solve(np.eye(p) - 0.5 * x @ below, x), atol=1e-8)
    np.testing.assert_allclose(asked[0].reshape(-1, p, q)[0], x, atol=1e-12)
