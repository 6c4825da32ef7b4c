"""Actions: what they check, and the frame of isotropy and tangent vectors at a point."""

from typing import Any

import numpy as np
import pytest
import scipy.linalg

import liehom as lh
from liehom.base.errors import InputError, ShapeError
from liehom.flow.action.field import check_point
from tests.flow.action.support import BUILDERS, matrix, representation, symmetric, vectors

POSITIVE = [name for name in BUILDERS if name not in ("trivial", "zero")]


def assert_frame(action: lh.Action, m: Any, d: int, frame: Any, tolerance: float) -> None:
    """The columns are what `IsotropyFrame` says, at one point."""
    dim, size = action.dimension, action.representation.size
    gram = action.inner_product.matrix
    basis, tangent, lift = frame
    assert basis.shape[0] == dim and tangent.shape[0] == size and lift.shape[0] == dim
    bound = tolerance * max(1.0, float(np.abs(m).max())) * max(1.0, action.max_norm)

    def move(x: Any) -> Any:
        return action.infinitesimal(x.T, m).T

    assert np.abs(move(basis)).max(initial=0.0) <= bound
    assert np.abs(basis.T @ gram @ basis - np.eye(dim - d)).max(initial=0.0) <= 1e-10
    assert np.abs(tangent.T @ tangent - np.eye(d)).max(initial=0.0) <= 10 * tolerance
    assert np.abs(move(lift) - tangent).max() <= bound * max(1.0, float(np.abs(lift).max()))
    assert np.abs(basis.T @ gram @ lift).max(initial=0.0) <= 1e-9 * max(1.0, float(np.abs(lift).max()))


@pytest.mark.parametrize("name", POSITIVE)
def test_the_frame_of_a_point_and_of_an_ensemble(name: str) -> None:
    rho = representation(name)
    action = lh.Action(rho)
    _, m = vectors(name, 1, (2, 3))
    d = check_point(rho, m)
    frame = action.isotropy_frame(m, d)
    assert frame.basis.shape == (2, 3, action.dimension, action.dimension - d.min())
    assert frame.tangent.shape == (2, 3, rho.size, d.max()) and frame.lift.shape == (2, 3, action.dimension, d.max())
    for index in np.ndindex(2, 3):
        assert d[index] == d.max()
        assert_frame(
            action, m[index], int(d[index]), [a[index] for a in (frame.basis, frame.tangent, frame.lift)], 1e-11
        )
        one = action.isotropy_frame(m[index], int(d[index]))
        assert_frame(action, m[index], int(d[index]), (one.basis, one.tangent, one.lift), 1e-11)


@pytest.mark.parametrize("name", ["so(3)", "Sym(3)", "so(5)", "so(3,1)", "QQ(sqrt 2)", "so(3) tensor", "g2"])
def test_the_frame_in_extended_precision(name: str) -> None:
    rho = representation(name)
    action = lh.Action(rho)
    _, m = vectors(name, 2, (2,))
    wide = m.astype(np.longdouble) / 3
    frame = action.isotropy_frame(wide, check_point(rho, wide))
    eps = float(np.finfo(np.longdouble).eps)
    for i in range(2):
        assert frame.tangent.dtype == frame.basis.dtype == frame.lift.dtype == np.longdouble
        parts = frame.basis[i], frame.tangent[i], frame.lift[i]
        assert_frame(action, wide[i], int(frame.orbit_dimension[i]), parts, 60 * eps)


def test_orbits_of_different_dimension_are_filled_up_with_zeros() -> None:
    action = lh.Action(representation("Sym(3)"))
    points = np.array([[1.0, 0, 0, 1, 0, 2], [1, 0, 0, 2, 0, 3], [1, 0, 0, 1, 0, 1]])
    for dtype in (np.float64, np.longdouble):
        frame = action.isotropy_frame(points.astype(dtype), np.array([2, 3, 0]))
        assert frame.basis.shape == (3, 3, 3) and frame.tangent.shape == (3, 6, 3)
        for i, d in enumerate((2, 3, 0)):
            kept = frame.basis[i][:, np.abs(frame.basis[i]).max(axis=0) > 0]
            assert kept.shape == (3, 3 - d)
            assert_frame(
                action, points[i].astype(dtype), d, (kept, frame.tangent[i][:, :d], frame.lift[i][:, :d]), 1e-11
            ) if d else None
            assert not frame.tangent[i][:, d:].any() and not frame.lift[i][:, d:].any()
    np.testing.assert_array_equal(action.isotropy_frame(points[:2], 2).orbit_dimension, 2)


def test_the_isotropy_of_eigenvalues_with_multiplicity() -> None:
    """The stabilizer of diag(1, 1, 2) conjugated by g is so(2) conjugated by g."""
    action = lh.Action(representation("Sym(3)"))
    x = vectors("Sym(3)", 3)[0]
    m = action.act(x, np.array([1.0, 0, 0, 1, 0, 2]))
    frame = action.isotropy_frame(m, 2)
    s = symmetric(m, 3)
    a = np.einsum("a,aij->ij", frame.basis[:, 0], np.array([b.to_numpy() for b in lh.defining(lh.so(3)).matrices]))
    np.testing.assert_allclose(a @ s, s @ a, atol=1e-13)
    g = scipy.linalg.expm(np.einsum("a,aij->ij", x, np.array([b.to_numpy() for b in lh.defining(lh.so(3)).matrices])))
    np.testing.assert_allclose(np.abs((g.T @ a @ g)[0, 1]), np.linalg.norm(a) / np.sqrt(2), rtol=1e-12)


def test_tiny_and_huge_points_have_the_same_isotropy() -> None:
    action = lh.Action(representation("so(5)"))
    _, m = vectors("so(5)", 4)
    plain = action.isotropy_frame(m, 4)
    for factor in (1e-150, 1e-8, 1e100):
        frame = action.isotropy_frame(factor * m, 4)
        projectors = [f.basis @ f.basis.T for f in (plain, frame)]
        np.testing.assert_allclose(projectors[0], projectors[1], atol=1e-13)
        np.testing.assert_allclose(frame.lift * factor @ frame.tangent.T, plain.lift @ plain.tangent.T, atol=1e-12)


def test_actions_check_their_arguments() -> None:
    rho = representation("so(3)")
    action = lh.Action(rho)
    assert (action.dimension, repr(action)) == (3, f"<action by exp (Rodrigues) of {rho!r}>")
    with pytest.raises(InputError, match="expected a Representation"):
        lh.Action(lh.so(3))  # type: ignore[arg-type]
    for x, m in ((np.zeros(2), np.zeros(3)), (np.zeros(3), np.zeros(4)), (0.5, np.zeros(3)), (np.zeros(3), 1.0)):
        with pytest.raises(ShapeError, match=r"expected \(\.\.\., 3\) and \(\.\.\., 3\)"):
            action.act(x, m)
        with pytest.raises(ShapeError):
            action.infinitesimal(x, m)
    np.testing.assert_array_equal(action.act([0, 0, 0], [1, 2, 3]), [1.0, 2.0, 3.0])


@pytest.mark.parametrize("name", BUILDERS)
def test_the_infinitesimal_action_and_the_bracket(name: str) -> None:
    rho = representation(name)
    action = lh.Action(rho)
    x, m = vectors(name, 5, (4,))
    y, _ = vectors(name, 6, (4,))
    np.testing.assert_allclose(action.infinitesimal(x, m), (matrix(name, x) @ m[..., None])[..., 0], atol=1e-13)
    a, b = matrix(name, x), matrix(name, y)
    np.testing.assert_allclose(matrix(name, action.bracket(x, y)), a @ b - b @ a, atol=1e-12)
    np.testing.assert_allclose(action.infinitesimal.left(x), a, atol=1e-15)
    moved = (action.infinitesimal.right(m) @ x[..., None])[..., 0]
    np.testing.assert_allclose(moved, action.infinitesimal(x, m), atol=1e-13)
    if rho.algebra.dimension:
        basis = action.inner_product.orthonormal_basis()
        assert action.max_norm == pytest.approx(max(np.linalg.norm(matrix(name, c)) for c in basis.T), abs=1e-12)


def test_maps_on_series_exact_numbers_and_mixed_leading_axes() -> None:
    action = lh.Action(representation("so(5)"))
    rng = np.random.default_rng(7)
    xs, ms = rng.normal(size=(3, 2, 10)), rng.normal(size=(3, 2, 5))
    product = action.infinitesimal(lh.Jet(xs), lh.Jet(ms))
    for k in range(3):
        wanted = sum(action.infinitesimal(xs[i], ms[k - i]) for i in range(k + 1))
        np.testing.assert_allclose(product.coefficient(k), wanted, atol=1e-13)
    left, right = action.infinitesimal(xs[0], lh.Jet(ms)), action.infinitesimal(lh.Jet(xs), ms[0])
    np.testing.assert_allclose(left.coefficient(2), action.infinitesimal(xs[0], ms[2]), atol=1e-13)
    np.testing.assert_allclose(right.coefficient(2), action.infinitesimal(xs[2], ms[0]), atol=1e-13)
    assert action.infinitesimal(xs[0][:, None], ms[0]).shape == (2, 2, 5)
    whole = np.array([lh.QQ.convert(int(v)) for v in range(10)])
    made = action.infinitesimal(whole, whole[:5])
    np.testing.assert_array_equal(made.astype(float), action.infinitesimal(np.arange(10), np.arange(5)))
    big = lh.Action(lh.adjoint(lh.so(8)))  # 28^3 coefficients, few of them not 0
    x, m = rng.normal(size=(2, 28))
    ad = np.array([a.to_numpy() for a in big.representation.matrices])
    np.testing.assert_allclose(big.infinitesimal(x, m), np.einsum("a,aij,j", x, ad, m), atol=1e-12)
