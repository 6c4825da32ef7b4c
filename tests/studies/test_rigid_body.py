"""The rigid body: fields, exact motion against the Taylor reference, separatrix, equilibria, attitude, refusals."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.convergence.reference import Reference
from liehom.studies.rigid_body import RigidBody, jacobi_elliptic
from tests.studies.support import BODIES, rational, rotation, tilted, unit

LONG = np.finfo(np.longdouble).eps < 1e-18


@pytest.mark.parametrize("name", list(BODIES))
def test_both_generators_give_the_field(name: str) -> None:
    body, m = BODIES[name], 1.7 * unit(1, 20, 3)
    wanted = np.cross(m, m @ body.inverse)
    for kind in "bo":
        assert np.allclose(body.field(kind).vector(m), wanted, rtol=0, atol=1e-14)
    assert np.allclose(np.sum(body.field("o").psi(m) * m, axis=-1), 0, atol=1e-14)
    assert np.allclose(body.field("b").psi(m), -m @ body.inverse, rtol=0, atol=1e-15)
    assert np.allclose(body.inverse @ body.inertia, np.eye(3), rtol=0, atol=1e-14)


def test_the_representation_is_the_cross_product() -> None:
    x, m = unit(2, 5, 3), unit(3, 5, 3)
    assert np.allclose(lh.Action(RigidBody([1, 2, 3]).representation).infinitesimal(x, m), np.cross(x, m), atol=1e-16)


def test_the_field_is_exact_at_exact_points() -> None:
    body = RigidBody([["2", "1/3", 0], ["1/3", 1, 0], [0, 0, "1/2"]])
    m = rational(["1/2", "2/3", "-1/5"])
    result = body.vector(m)
    assert (np.cross(m, body.apply(m)) == result).all()
    assert [str(x) for x in (body.apply(m) @ body.inertia.astype(int)[:, 2:] * 0).tolist()] == ["0"]
    assert body.casimir(m) == rational(["661/900"])[0]
    assert sum(m * result) == 0
    assert sum(body.apply(m) * result) == 0


def starts(body: RigidBody) -> Any:
    points = [2 * unit(4, 10, 3), 0.4 * unit(5, 10, 3), body.equilibria(), unit(6, 10, 3) * [1, 1e-9, 1e-4]]
    points.append(points[-1][:, ::-1])
    if np.diff(np.sort(body.moments)).min() > 1e-3:
        points += [body.separatrix(np.linspace(0, 6, 5), branch) for branch in (1, -1)]
    return np.concatenate(points)


@pytest.mark.parametrize("name", [name for name in BODIES if name != "no triangle"])
def test_exact_motion(name: str) -> None:
    """Both regions, separatrix, equilibria, every sign, points next to the axes."""
    body = BODIES[name]
    m = starts(body)
    reference = Reference(body.field("o"), m.astype(np.longdouble))
    for t in (0.0, 1.0, -7.3, 10.0):
        assert np.abs(body.exact(m, t) - reference(t)).max() < 1e-13
    if LONG and name != "tilted":
        assert np.abs(body.exact(m.astype(np.longdouble), np.longdouble(10)) - reference(10)).max() < 1e-16


def test_exact_motion_when_next_to_the_separatrix() -> None:
    """The error grows as the motion itself separates: with extended floats it is as much smaller."""
    body = BODIES["triaxial"]
    angle, gap = np.linspace(0.1, 3, 7), np.array([0.0, 1e-12, -1e-12, 1e-8, -1e-8, 1e-4, -1e-4])
    m = body.separatrix(angle) + gap[:, None] * [0.3, 0.2, 1.0]
    assert np.abs(body.exact(m, 20.0) - Reference(body.field("o"), m.astype(np.longdouble))(20)).max() < 1e-12


def test_exact_motion_has_the_shape_of_points_and_times() -> None:
    body, m = BODIES["triaxial"], unit(7, 4, 3)
    assert body.exact(m, np.zeros((5, 4))).shape == (5, 4, 3)
    assert body.exact(m[0], np.linspace(0, 1, 5)).shape == (5, 3)
    assert np.array_equal(body.exact(m[0], [0.5])[0], body.exact(m, 0.5)[0])


def test_separatrix_is_tanh_and_sech() -> None:
    body = BODIES["triaxial"]
    a1, a2, a3 = 1 / 2, 2 / 3, 1 / 6  # moments 3, 2, 1: w = 1/3, 1/2, 1
    m = body.separatrix(np.pi / 2)
    rate = np.sqrt(a1 * a3)
    exact = body.exact(m, 3.0) @ body.axes
    assert np.allclose(exact[0], m @ body.axes[:, 0] / np.cosh(3 * rate), atol=1e-14)
    assert np.isclose(abs(exact[1]), np.tanh(3 * rate), atol=1e-14)
    assert np.isclose(abs(exact[2] / exact[0]), np.sqrt(a3 / a1), atol=1e-13)
    assert np.isclose(a2, a1 + a3)


@pytest.mark.parametrize("name", list(BODIES))
def test_equilibria_and_moments(name: str) -> None:
    body = BODIES[name]
    assert np.abs(body.vector(body.equilibria(3.0))).max() < 1e-13
    assert np.allclose(body.axes.T @ body.inertia @ body.axes, np.diag(body.moments), atol=1e-13)
    assert np.isclose(np.linalg.det(body.axes), 1)
    assert (np.diff(body.moments) <= 0).all()
    e = body.invariants()
    assert np.allclose(np.poly(1 / body.moments), [1, -e[0], e[1], -e[2]], rtol=1e-12)


def test_motion_turns_with_the_body() -> None:
    q, body = rotation(5), RigidBody([1, 2, 3])
    turned, m = RigidBody(q @ body.inertia @ q.T), unit(8, 6, 3)
    assert np.allclose(turned.exact(m @ q.T, 5.0), body.exact(m, 5.0) @ q.T, rtol=0, atol=1e-13)


def test_attitude() -> None:
    body, m = tilted(1), 1.5 * unit(9, 3, 3)
    start, times = rotation(4), np.linspace(0, 15, 7)
    q = body.attitude(m, times, start)
    assert q.shape == (3, 7, 3, 3)
    assert np.allclose(q[:, 0], start, rtol=0, atol=1e-15)
    assert np.abs(q @ np.swapaxes(q, -1, -2) - np.eye(3)).max() < 1e-13
    space = (q @ body.exact(m[:, None], times)[..., None])[..., 0]
    assert np.abs(space - (m @ start.T)[:, None]).max() < 1e-11  # of two solutions that part next to the separatrix
    # Q' = Q hat(Om m): central differences
    h = 1e-4
    near = body.attitude(m, [5 - h, 5.0, 5 + h], start)
    angular = np.swapaxes(near[:, 1], -1, -2) @ ((near[:, 2] - near[:, 0]) / (2 * h))
    wanted = body.apply(body.exact(m, 5.0))
    assert np.allclose(np.stack([angular[:, 2, 1], angular[:, 0, 2], angular[:, 1, 0]], axis=-1), wanted, atol=1e-6)
    assert np.allclose(body.attitude(m[0], [-2.0, -5.0])[1] @ body.exact(m[0], -5.0), m[0], rtol=0, atol=1e-12)
    assert np.array_equal(body.attitude(m[0], [0.0])[0], np.eye(3))


@pytest.mark.parametrize("square", [0.0, 0.3, 0.5, 0.7, 0.99])
def test_elliptic_functions_against_scipy(square: float) -> None:
    from scipy.special import ellipj

    u = np.linspace(-20, 20, 41)
    assert np.allclose(jacobi_elliptic(u, square, 1 - square), ellipj(u, square)[:3], rtol=0, atol=3e-14)


@pytest.mark.parametrize("complement", [1e-3, 1e-9, 1e-15, 1e-30])
def test_elliptic_functions_next_to_modulus_1(complement: float) -> None:
    """Relative accuracy of cn and dn, which 1 - k^2 in doubles does not allow."""
    import mpmath

    with mpmath.workdps(50):
        for u in (0.3, 4.0, 9.0, -15.0):
            exact = [mpmath.ellipfun(f, mpmath.mpf(u), m=1 - mpmath.mpf(complement)) for f in ("sn", "cn", "dn")]
            for x, wanted in zip(jacobi_elliptic(u, 1 - complement, complement), exact, strict=True):
                assert abs(float(x) - wanted) <= 2e-13 * abs(wanted)


@pytest.mark.parametrize(
    ("inertia", "words"),
    [
        ([1, 2], "shape"),
        ([[1, 2, 3]], "shape"),
        ([1, 2, -3], "positive definite"),
        ([1, 2, 0], "positive definite"),
        ([1, 2, np.nan], "finite real number"),
        ([1, 2, "x"], "finite real number"),
        ([[1, 2, 0], [0, 1, 0], [0, 0, 1]], "not symmetric"),
        ([[1, 2, 0], [2, 1, 0], [0, 0, 1]], "positive definite"),
    ],
)
def test_inertia_that_is_refused(inertia: Any, words: str) -> None:
    with pytest.raises(lh.errors.InputError, match=words):
        RigidBody(inertia)


def test_other_refusals() -> None:
    body = RigidBody([1, 2, 3])
    with pytest.raises(lh.errors.InputError, match="'b'"):
        body.field("i")
    with pytest.raises(lh.errors.InputError, match="three different"):
        BODIES["disc"].separatrix(0.1)
    with pytest.raises(lh.errors.InputError, match="branch"):
        body.separatrix(0.1, branch=2)
    with pytest.raises(lh.errors.ShapeError):
        body.exact([1.0, 0.0], 1.0)
    with pytest.raises(lh.errors.ShapeError, match="sign"):
        body.attitude([1.0, 0, 0], [-1.0, 1.0])
    with pytest.raises(lh.errors.InputError, match="rotation"):
        body.attitude([1.0, 0, 0], [1.0], np.diag([1, 1, -1]))
    with pytest.raises(lh.errors.ShapeError, match="attitude"):
        body.attitude([1.0, 0, 0], [1.0], np.eye(2))


def test_attitudes_of_an_ensemble_at_time_0() -> None:
    body, start = RigidBody([1, 2, 3]), np.diag([1.0, -1.0, -1.0])
    for times in ([0.0], [0.0, 0.0]):
        made = body.attitude(np.eye(3)[[0, 1]] + 0.1, times, start)
        assert made.shape == (2, len(times), 3, 3) and (made == start).all()
