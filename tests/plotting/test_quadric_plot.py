"""Orbits on quadrics: the surface is the one of the trajectory, and other forms are refused."""

from typing import Any

import numpy as np
import pytest

import liehom as lh

pytest.importorskip("matplotlib")

from liehom.base.errors import InputError
from liehom.plotting.canvas import COLOURS, GREY, new_figure
from liehom.plotting.trajectory_plot import plot_quadric

RHO = lh.defining(lh.so(2, 1))
FORM = np.diag([1.0, 1.0, -1.0])
FIELD = lh.GeneratorField(RHO, [1.0, 0.3, 0.2])


def points(ax: Any, *colours: str) -> np.ndarray:
    """The points (3, k) of all lines of these colors that have more than one point."""
    lines = [np.array(line.get_data_3d(), dtype=float) for line in ax.lines if line.get_color() in colours]
    found = np.concatenate([line for line in lines if line.shape[1] > 2], axis=1)
    return found[:, np.isfinite(found).all(axis=0)]


@pytest.mark.parametrize(
    ("start", "kind", "level"),
    [
        ([0.5, 0.0, 1.25**0.5], "hyperboloid of two sheets", -1.0),
        ([0.6, 0.8, 1.0], "cone", 0.0),
        ([1.0, 0.5, 0.5], "hyperboloid of one sheet", 1.0),
    ],
)
def test_the_surface_and_the_curve_have_the_level_of_the_trajectory(start: Any, kind: str, level: float) -> None:
    sol = lh.integrate(FIELD, (0, 6), start)
    ax = plot_quadric(RHO, sol)
    assert ax.get_title(loc="left").startswith(kind)
    for colours in ((COLOURS[0],), (GREY, "#d9d9d9")):
        found = points(ax, *colours)
        assert np.abs(np.einsum("ik,ij,jk->k", found, FORM, found) - level).max() < 1e-6 * (found**2).max()
    curve = points(ax, COLOURS[0])
    for point in sol.y.T:
        assert np.linalg.norm(curve - point[:, None], axis=0).min() < 1e-9
    if kind != "hyperboloid of one sheet":  # the other sheet has no point
        assert points(ax, GREY, "#d9d9d9")[2].min() > -1e-9


def test_trajectories_of_an_ensemble_have_a_surface_for_each_level() -> None:
    ax = plot_quadric(RHO, lh.integrate(FIELD, (0, 2), [[0.5, 0.0, 1.25**0.5], [0.0, 0.0, 1.0], [0.0, 0.0, -2.0]]))
    assert ax.get_title(loc="left").count("two sheets") == 2
    assert points(ax, GREY)[2].min() < -2 and points(ax, GREY)[2].max() > 1


def test_points_and_a_matrix_in_axes_in_the_plane() -> None:
    flat = new_figure(3, 3).add_subplot()
    assert plot_quadric(np.diag([1.0, 2.0, 4.0]), [[1.0, 0.0, 0.0], [0.0, 0.0, 0.5]], flat) is flat
    assert "ellipsoid" in flat.get_title(loc="left")
    assert len([line for line in flat.lines if line.get_marker() == "o"]) == 2
    assert plot_quadric(lh.adjoint(lh.so(3)), [0.0, 3.0, 4.0]).get_title(loc="left") == "sphere, $c$ = 25"


@pytest.mark.parametrize(
    ("form", "through", "match"),
    [
        (lh.defining(lh.sl(3)), [1.0, 0.0, 0.0], "0 independent invariant forms"),
        (lh.defining(lh.so(4)), [1.0, 0.0, 0.0], "4 coordinates"),
        (np.eye(2), [1.0, 0.0, 0.0], "symmetric 3 x 3"),
        (np.triu(np.ones((3, 3))), [1.0, 0.0, 0.0], "symmetric 3 x 3"),
        (np.diag([1.0, 0.0, 0.0]), [1.0, 0.0, 0.0], "ellipsoid"),
        (np.eye(3), lh.integrate(FIELD, (0, 2), [0.5, 0.0, 1.25**0.5]), "same value"),
        (np.eye(3), lh.integrate(FIELD, (0, 2), [5e-5, 0.0, 1e-4]), "same value"),
        (np.eye(3), lh.integrate(lh.GeneratorField(lh.defining(lh.so(2)), [1]), (0, 1), [1.0, 0.0]), "2 coordinates"),
    ],
)
def test_other_forms_and_trajectories_raise(form: Any, through: Any, match: str) -> None:
    with pytest.raises(lh.InputError, match=match):
        plot_quadric(form, through)


@pytest.mark.parametrize("through", [[], [1, 2], [np.nan, 0, 0], [1j, 0, 0], "abc", None])
def test_other_points_are_refused(through: Any) -> None:
    with pytest.raises(InputError, match="expected"):
        plot_quadric(FORM, through)


def test_a_picture_has_a_limited_number_of_surfaces() -> None:
    with pytest.raises(InputError, match="60 quadrics"):
        plot_quadric(np.eye(3), np.outer(np.arange(1, 61), [1.0, 0.0, 0.0]))
    ax = plot_quadric(np.eye(3), np.outer(np.arange(1, 6), [1.0, 0.0, 0.0]))
    assert ax.get_title(loc="left").endswith("and 2 more")


def test_three_quadrics_are_all_named() -> None:
    title = plot_quadric(np.eye(3), np.outer([1.0, 2.0, 3.0], [1.0, 0.0, 0.0])).get_title(loc="left")
    assert title == "sphere, $c$ = 1, sphere, $c$ = 4, sphere, $c$ = 9"


def test_a_far_point_of_a_cone_is_on_a_cone() -> None:
    point = 1e8 * np.array([2**0.5, 7**0.5, 3.0])
    assert point[0] ** 2 + point[1] ** 2 != point[2] ** 2  # round-off
    assert plot_quadric(FORM, point).get_title(loc="left") == "cone, $c$ = 0"
