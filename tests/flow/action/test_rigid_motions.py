"""exp, log and dexp of rotations, quaternions, rigid motions: matrix functions, extended precision, near 0 and pi."""

from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm, logm
from scipy.spatial.transform import Rotation

from liehom.base.errors import ShapeError
from liehom.flow.action.motions import SE3, SO3, matrix_to_quaternion, quaternion_log, quaternion_to_matrix

so3_dexp, so3_dexp_inverse, se3_dexp, se3_dexp_inverse = SO3.dexp, SO3.dexp_inverse, SE3.dexp, SE3.dexp_inverse

LENGTHS = [0.0, 1e-300, 1e-12, 1e-8, 1e-5, 0.03, 0.5, 0.99999, 1.00001, 2.0, 3.0, np.pi - 1e-6, np.pi - 1e-10]


def so3_exp(x: Any) -> Any:
    return SO3.exp(x).matrix


def so3_log(rotation: Any) -> Any:
    return SO3(rotation).log()


def se3_exp(x: Any) -> Any:
    return SE3.exp(x).matrix


def se3_log(motion: Any) -> Any:
    return SE3(motion).log()


def se3_bracket(x: Any, y: Any) -> Any:
    """[x, y] = (omega x eta, omega x u + v x eta) for x = (omega, v) and y = (eta, u)."""
    return np.concatenate([np.cross(x[:3], y[:3]), np.cross(x[:3], y[3:]) + np.cross(x[3:], y[:3])])


def hat(x: Any) -> Any:
    return np.array([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])


def matrix(x: Any) -> Any:
    made = np.zeros((4, 4))
    made[:3, :3], made[:3, 3] = hat(x[:3]), x[3:]
    return made


def half_turns(x: Any) -> Any:
    """Unit quaternions, scalar part first, of rotation vectors."""
    angle = np.linalg.norm(x, axis=-1, keepdims=True) / 2
    return np.concatenate([np.cos(angle), np.sinc(angle / np.pi) * x / 2], axis=-1)


def adjoint(x: Any) -> Any:
    """The matrix of ad_x on se(3)."""
    return np.stack([se3_bracket(x, e) for e in np.eye(6)], axis=-1)


def vectors(length: float, count: int = 20, size: int = 3) -> Any:
    v = np.random.default_rng(7).normal(size=(count, size))
    v[:, :3] *= length / np.linalg.norm(v[:, :3], axis=-1, keepdims=True)
    return v


def dexp_by_series(ad: Any, y: Any) -> Any:
    """The sum of ad^k y/(k + 1)! in extended precision."""
    term = total = y.astype(np.longdouble)
    for k in range(1, 60):
        term = ad.astype(np.longdouble) @ term / (k + 1)
        total = total + term
    return total


# -- against matrix functions ------------------------------------------------------------------------------
@pytest.mark.parametrize("length", [*LENGTHS, 5.0, 20.0])
def test_exp_is_the_matrix_exponential(length: float) -> None:
    x, z = vectors(length), vectors(length, size=6)
    assert np.abs(so3_exp(x) - np.array([expm(hat(v)) for v in x])).max() < 3e-15 * (1 + length)
    assert np.abs(se3_exp(z) - np.array([expm(matrix(v)) for v in z])).max() < 2e-14 * (1 + length)
    assert np.abs(quaternion_to_matrix(half_turns(x)) - so3_exp(x)).max() < 3e-15


@pytest.mark.parametrize("length", LENGTHS)
def test_log_inverts_exp(length: float) -> None:
    """To round-off of the angle; absolute near pi, where the axis loses nothing, and relative near 0."""
    x, z = vectors(length), vectors(length, size=6)
    scale = max(length, 1e-300)
    assert np.abs(so3_log(so3_exp(x)) - x).max() <= 2e-15 * scale
    assert np.abs(quaternion_log(half_turns(x)) - x).max() <= 2e-15 * scale
    assert np.abs(quaternion_log(-half_turns(x)) - x).max() <= 2e-15 * scale
    assert np.abs(se3_log(se3_exp(z)) - z).max() < 2e-14
    assert np.abs(so3_log(so3_exp(x)) - Rotation.from_matrix(so3_exp(x)).as_rotvec()).max() < 1e-14
    if 0.01 < length < 3:
        assert np.abs(logm(so3_exp(x[0])) - hat(so3_log(so3_exp(x[0])))).max() < 1e-13


def test_rotations_by_pi_have_one_of_two_logarithms() -> None:
    for axis in np.concatenate([np.eye(3), vectors(1.0)]):
        found = so3_log(2 * np.outer(axis, axis) - np.eye(3))
        assert abs(np.linalg.norm(found) - np.pi) < 1e-15
        assert np.abs(np.abs(found @ axis) - np.pi) < 1e-14


@pytest.mark.parametrize("length", [*LENGTHS, 4.0, 6.0])
def test_dexp_is_the_series_of_ad(length: float) -> None:
    x, y, z, u = vectors(length), vectors(1.0)[::-1], vectors(length, size=6), vectors(1.0, size=6)[::-1]
    for k in range(len(x)):
        wanted = dexp_by_series(hat(x[k]), y[k])
        assert np.abs(so3_dexp(x[k], y[k]) - wanted).max() < 1e-14
        inverse = np.linalg.solve(np.array([so3_dexp(x[k], e) for e in np.eye(3)]).T, y[k])
        assert np.abs(so3_dexp_inverse(x[k], y[k]) - inverse).max() < 1e-13 * (1 + np.abs(inverse).max())
        wanted = dexp_by_series(adjoint(z[k]), u[k])
        assert np.abs(se3_dexp(z[k], u[k]) - wanted).max() < 5e-14
        back = se3_dexp_inverse(z[k], se3_dexp(z[k], u[k]))
        assert np.abs(back - u[k]).max() < (1e-13 if length < 5 else 1e-10)


def test_extended_precision_has_its_digits() -> None:
    """Coefficients by series and by sines agree where they meet, and log inverts exp, to 1e-17."""
    for length in (1e-9, 0.5, 0.9999, 1.0001, 3.0):
        x = vectors(length, size=6).astype(np.longdouble)
        y = vectors(1.0, size=6)[::-1].astype(np.longdouble)
        assert se3_exp(x).dtype == np.longdouble
        assert np.abs(se3_log(se3_exp(x)) - x).max() < 3e-17
        assert np.abs(se3_dexp_inverse(x, se3_dexp(x, y)) - y).max() < 1e-16
        wanted = np.array(
            [
                dexp_by_series(np.stack([se3_bracket(a, e) for e in np.eye(6)], axis=-1), b)
                for a, b in zip(x, y, strict=True)
            ]
        )
        assert np.abs(se3_dexp(x, y) - wanted).max() < 2e-17


def test_dexp_is_the_derivative_of_exp() -> None:
    """d/dt exp(x + t u) = dexp_x(u) exp(x) by differences, and of log its inverse."""
    h = 1e-5
    for length in (1e-7, 0.4, 2.5):
        x, u = vectors(length, size=6), vectors(1.0, size=6)[::-1]
        slope = (se3_exp(x + h * u) - se3_exp(x - h * u)) / (2 * h)
        wanted = np.array([matrix(v) for v in se3_dexp(x, u)]) @ se3_exp(x)
        assert np.abs(slope - wanted).max() < 1e-9
        moved = [se3_log(se3_exp(s * h * u) @ se3_exp(x)) for s in (1, -1)]
        assert np.abs((moved[0] - moved[1]) / (2 * h) - se3_dexp_inverse(x, u)).max() < 1e-8


def test_leading_axes_broadcast() -> None:
    x, y = np.random.default_rng(0).normal(size=(4, 1, 6)), np.random.default_rng(1).normal(size=(5, 6))
    assert se3_dexp(x, y).shape == se3_dexp_inverse(x, y).shape == (4, 5, 6)
    assert se3_exp(x).shape == (4, 1, 4, 4)
    assert so3_log(so3_exp(x[..., :3])).shape == (4, 1, 3)
    assert matrix_to_quaternion(so3_exp(x[..., :3])).shape == (4, 1, 4)


@pytest.mark.slow
def test_derivatives_by_jax_are_finite_everywhere() -> None:
    jax = pytest.importorskip("jax")
    with jax.enable_x64(True) if hasattr(jax, "enable_x64") else jax.experimental.enable_x64():
        for length in (0.0, 1e-9, 1.0, np.pi - 1e-9):
            x = jax.numpy.asarray(vectors(length, 1, 6)[0])
            slope = np.asarray(jax.jacfwd(lambda z: se3_log(se3_exp(z)))(x))
            assert np.abs(slope - np.eye(6)).max() < 1e-6
            assert np.abs(np.asarray(se3_exp(x)) - se3_exp(np.asarray(x))).max() < 1e-15
            assert np.isfinite(np.asarray(jax.jacfwd(lambda z: se3_dexp_inverse(z, z + 1.0))(x))).all()


def test_differentials_of_the_objects_are_those_of_exp() -> None:
    x, y = vectors(2.0, size=6), vectors(1.0, size=6)[::-1]
    for group, n in ((SO3, 3), (SE3, 6)):
        slope = (group.exp(x[:, :n] + 1e-5 * y[:, :n]).matrix - group.exp(x[:, :n] - 1e-5 * y[:, :n]).matrix) / 2e-5
        generator = [(hat if n == 3 else matrix)(v) for v in group.dexp(x[:, :n], y[:, :n])]
        assert np.abs(slope - np.array(generator) @ group.exp(x[:, :n]).matrix).max() < 1e-9
        assert np.abs(group.dexp_inverse(x[:, :n], group.dexp(x[:, :n], y[:, :n])) - y[:, :n]).max() < 1e-13
        with pytest.raises(ShapeError, match=rf"expected \(..., {n}\)"):
            group.dexp(x[:, :n], y[:, :2])
