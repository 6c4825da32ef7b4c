"""Quadrics: their points are on them, hidden points are found as by a search along the ray, views are projections."""

import numpy as np
import pytest

import liehom as lh

pytest.importorskip("matplotlib")

from liehom.plotting.phase_plot import Quadric, Scene, sphere

TURN = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))[0]
CASES = {
    "sphere": (np.eye(3), 4.0),
    "ellipsoid": (np.diag([1.0, 2.0, 5.0]), 3.0),
    "hyperboloid of one sheet": (np.diag([1.0, 2.0, -1.0]), 1.5),
    "hyperboloid of two sheets": (np.diag([1.0, 2.0, -1.0]), -1.5),
    "cone": (np.diag([-1.0, -2.0, 1.0]), 0.0),
    "cylinder": (np.diag([0.0, 2.0, 1.0]), 2.0),
}


def grid(surface: Quadric) -> np.ndarray:
    u, v = np.meshgrid(*(x[::7] for x in surface.parameters))
    return np.concatenate([surface.at(u.ravel(), v.ravel(), sheet) for sheet in (1, -1)], axis=1)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("kind", CASES)
def test_points_are_on_the_quadric(kind: str, turned: bool) -> None:
    form, level = CASES[kind]
    form = TURN @ form @ TURN.T if turned else form
    surface = Quadric(form, level)
    assert surface.kind == kind
    points = grid(surface)
    assert np.abs(np.einsum("ik,ij,jk->k", points, form, points) - level).max() < 1e-9 * max(1, (points**2).max())


@pytest.mark.parametrize("kind", ["sphere", "ellipsoid", "hyperboloid of two sheets", "hyperboloid of one sheet"])
def test_hidden_points_have_another_point_of_the_surface_before_them(kind: str) -> None:
    form, level = CASES[kind]
    surface = Quadric(form, level, np.array([[0.0], [0.0], [1.5]]))
    eye = np.array([0.8, 0.5, 0.3]) / np.linalg.norm([0.8, 0.5, 0.3])
    u, v = np.meshgrid(*(x[5:-5:9] for x in surface.parameters))
    points = surface.at(u.ravel(), v.ravel())
    edge = surface.bounds()[1][2]  # where the drawn part ends
    rays = points[:, :, None] + eye[:, None, None] * np.linspace(0.02, 12, 3000)
    value = np.einsum("ikd,ij,jkd->kd", rays, form, rays) - level
    passes = value[:, 1:] * value[:, :-1] < 0
    height = (rays[2, :, 1:] + rays[2, :, :-1]) / 2
    low = 0.0 if kind.endswith("two sheets") else -np.inf
    top = np.inf if surface.closed else edge
    met = (passes & (height > max(low, -top)) & (height < top)).any(axis=1)
    sure = np.abs(eye @ form @ points) > 0.1 * np.abs(form @ points).max()  # not near the outline
    sure &= ~(passes & (np.abs(np.abs(height) - edge) < 0.02)).any(axis=1) | surface.closed
    hidden = surface.hidden(points, eye)
    assert sure.sum() > 60 and 5 < hidden[sure].sum() < sure.sum()
    assert np.array_equal(hidden[sure], met[sure])


def test_contours_have_their_values() -> None:
    found = list(Quadric(np.diag([1.0, 2.0, 5.0]), 3.0).contours(lambda m: m[..., 0] * m[..., 1], [-0.3, 0.4, 99.0]))
    assert {level for level, _ in found} == {-0.3, 0.4}
    for level, points in found:
        assert np.abs(points[0] * points[1] - level).max() < 2e-3
        assert np.abs(points[0] ** 2 + 2 * points[1] ** 2 + 5 * points[2] ** 2 - 3).max() < 1e-9


def test_axes_in_the_plane_show_the_projection() -> None:
    axes = lh.plotting.canvas.new_figure(3, 3).add_subplot()
    scene = Scene(axes)
    assert np.allclose(scene.screen @ scene.eye, 0) and np.allclose(scene.screen @ scene.screen.T, np.eye(2))
    scene.curve(sphere(1.0), np.stack([scene.eye, -scene.eye], axis=1), ".")
    assert [line.get_alpha() for line in axes.lines] == [0.3, None]


@pytest.mark.parametrize("zoom", [1.0, 1.25, 2.0])
def test_axes_in_the_plane_show_a_box_about_its_middle(zoom: float) -> None:
    scene = Scene(lh.plotting.canvas.new_figure(3, 3).add_subplot())
    half, middle = np.array([1.0, 2.0, 0.5]), np.array([0.3, -1.0, 4.0])
    scene.limit(half, middle, zoom)
    window = np.array([scene.axes.get_xlim(), scene.axes.get_ylim()])
    assert np.allclose(window.mean(axis=1), scene.screen @ middle)
    assert np.allclose(window[:, 1] - window[:, 0], 2.2 / zoom * np.abs(scene.screen) @ half)
    assert scene.axes.get_aspect() == 1.0


def test_axes_in_space_show_a_box_in_equal_scales() -> None:
    axes = lh.plotting.canvas.new_figure(3, 3).add_subplot(projection="3d")
    half, middle = np.array([1.0, 2.0, 0.5]), np.array([0.3, -1.0, 4.0])
    Scene(axes).limit(half, middle)
    window = np.array([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()])
    assert np.allclose(window, np.stack([middle - half, middle + half], axis=1))
    assert np.allclose(axes._box_aspect / axes._box_aspect[0], half / half[0])


@pytest.mark.parametrize("form", [np.diag([1.0, 0.0, 0.0]), -np.eye(3), np.zeros((3, 3))])
def test_other_level_sets_raise(form: np.ndarray) -> None:
    with pytest.raises(lh.InputError, match="ellipsoid"):
        Quadric(form, 1.0)


@pytest.mark.parametrize("kind", CASES)
def test_surfaces_without_points_are_symmetric(kind: str) -> None:
    low, high = Quadric(*CASES[kind]).bounds()
    assert np.allclose(low, -high) and (high > 0.5).all()
