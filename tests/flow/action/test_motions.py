"""Rotations and rigid motions: group laws, scipy's rotations, adjoints, and what is refused."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

import liehom as lh

vectors = st.lists(st.floats(-3, 3), min_size=6, max_size=6).map(np.array)


def near(a, b, tolerance=1e-12):
    return np.abs(np.asarray(a) - np.asarray(b)).max() < tolerance


@given(vectors, vectors)
def test_group_laws(x, y):
    for group, n in ((lh.SO3, 3), (lh.SE3, 6)):
        a, b = group.exp(x[:n]), group.exp(y[-n:])
        assert near((a @ b).inverse().matrix, (b.inverse() @ a.inverse()).matrix)
        assert near((a @ b).apply(y[:3]), a.apply(b.apply(y[:3])))
        assert near(group.exp(a.log()).matrix, a.matrix)
        assert near(group.exp(a.adjoint() @ y[-n:]).matrix, (a @ b @ a.inverse()).matrix, 1e-11)
        assert near((a.inverse() @ a).matrix, group.identity().matrix)


@given(vectors)
def test_rotations_are_those_of_scipy(x):
    peer, own = Rotation.from_rotvec(x[:3]), lh.SO3.exp(x[:3])
    assert near(own.as_matrix(), peer.as_matrix())
    assert near(lh.SO3.from_quaternion_xyzw(peer.as_quat()).matrix, peer.as_matrix())
    assert near(lh.SO3.from_quaternion_wxyz(own.as_quaternion_wxyz()).matrix, own.matrix)
    assert near(Rotation.from_quat(own.as_quaternion_xyzw()).as_matrix(), own.matrix)


@given(vectors)
def test_motions_are_exponentials_of_matrices(x):
    z = np.zeros((4, 4))
    z[:3, :3] = np.cross(x[:3], np.eye(3)).T
    z[:3, 3] = x[3:]
    assert near(lh.SE3.exp(x).matrix, expm(z))


def test_leading_axes_broadcast():
    turns, shifts = lh.SO3.exp(np.ones((5, 1, 3))), np.arange(6.0).reshape(2, 3)
    poses = lh.SE3.from_rotation_and_translation(turns, shifts)
    assert poses.matrix.shape == (5, 2, 4, 4) and poses.adjoint().shape == (5, 2, 6, 6)
    assert near(poses.inverse().apply(poses.apply(np.ones(3))), np.ones((5, 2, 3)))


def test_jax_arrays_and_gradients():
    jax = pytest.importorskip("jax")

    def height(x):
        return lh.SE3.exp(x).apply(np.ones(3))[2]

    x, e = np.array([0.3, -0.2, 0.5, 1.0, 2.0, 3.0]), 1e-6
    slopes = [(height(x + e * d) - height(x - e * d)) / (2 * e) for d in np.eye(6)]
    with jax.enable_x64(True) if hasattr(jax, "enable_x64") else jax.experimental.enable_x64():
        assert near(jax.grad(height)(jax.numpy.asarray(x)), slopes, 1e-6)


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: lh.SO3.exp([1, 2]), r"expected \(..., 3\)"),
        (lambda: lh.SE3.exp([1, 2, 3]), r"expected \(..., 6\)"),
        (lambda: lh.SO3.from_matrix(2 * np.eye(3)), "no rotation"),
        (lambda: lh.SO3.from_matrix(-np.eye(3)), "no rotation"),
        (lambda: lh.SO3.from_matrix(np.full((3, 3), np.nan)), "no rotation"),
        (lambda: lh.SE3.from_matrix(np.diag([1, 1, 1, 2])), "last row"),
        (lambda: lh.SO3.from_quaternion_wxyz([0, 0, 0, 0]), "not 0"),
        (lambda: lh.SO3.from_quaternion_xyzw([1, 0, 0]), r"expected \(..., 4\)"),
    ],
)
def test_refusals(call, says):
    with pytest.raises(lh.InputError, match=says):
        call()


def test_a_product_of_different_groups_is_refused():
    with pytest.raises(TypeError):
        lh.SO3.identity() @ lh.SE3.identity()
