"""Failure cones, eigenvalues by stratum, Weyl chambers: what is drawn, and on whose axes."""

import numpy as np
import pytest

import liehom as lh

pytest.importorskip("matplotlib")

from matplotlib.colors import to_hex

from liehom.plotting.canvas import new_figure
from liehom.plotting.strata_plot import failure_curves, plot_eigenvalues, plot_failure_cone, plot_weyl_chamber


@pytest.mark.parametrize(
    ("name", "lines"),
    [("sl(2)/so(1,1)", 4), ("affine(diag(1,-1))", 4), ("affine(upper(2))", 2), ("so(3)/so(2)", 0), ("R^2/0", 0)],
)
def test_directions_in_the_plane_on_which_the_condition_fails(name, lines):
    """Zeros of the invariant and invariant lines, which agree; every direction that is drawn fails, others do not."""
    pair = lh.pair(name)
    drawn = [np.array(line.get_data()) for line in plot_failure_cone(pair).lines[1:]]
    assert len(drawn) == lines
    rows = np.array([[float(x) for x in m.entries()] for m in pair.isotropy_matrices()]).reshape(-1, 2, 2)
    for direction in [d[:, 1] for d in drawn]:
        assert np.linalg.svd(np.array([direction, *(rows @ direction)]))[1][1] < 1e-12
    if lines:
        generic = np.array([0.3, 0.7])
        assert np.linalg.svd(np.array([generic, *(rows @ generic)]))[1][1] > 0.1


def test_the_null_cone_is_drawn_as_two_circles_on_the_sphere():
    ax = plot_failure_cone(lh.pair("so(3,1)/so(2,1)"))
    curves = [np.array(line.get_data_3d()) for line in ax.lines if line.get_color() == "#0072B2"]
    assert len(curves) == 2
    for x in curves:
        assert abs(x[0] ** 2 + x[1] ** 2 - x[2] ** 2).max() < 1e-3
        assert abs((x**2).sum(axis=0) - 1).max() < 1e-6


def test_titles_say_what_is_known():
    assert "full" in plot_failure_cone(lh.pair("so(4)/so(3)")).get_title(loc="left")
    assert "no ψ" in plot_failure_cone(lh.pair("su(2)/0")).get_title(loc="left")


def test_given_axes_are_used_and_must_have_the_dimension():
    flat = new_figure(3, 3).add_subplot()
    assert plot_failure_cone(lh.pair("sl(2)/so(1,1)"), flat) is flat
    with pytest.raises(lh.InputError, match="in space"):
        plot_failure_cone(lh.pair("so(4)/so(3)"), flat)
    for draw in (plot_eigenvalues, lambda ax: plot_weyl_chamber("A2", ax)):
        with pytest.raises(lh.InputError, match="axes of matplotlib"):
            draw("axes")


@pytest.mark.parametrize("pair", ["so(4)/so(3)", None, lh.pair("so(5)/so(4)"), lh.pair("so(2)/so(1)")])
def test_other_pairs_are_refused(pair):
    with pytest.raises(lh.InputError, match="dim g/h = 2 or 3"):
        plot_failure_cone(pair)


def test_eigenvalues_are_marked_at_their_barycentric_coordinates():
    ax = plot_eigenvalues(points=[(2, 2, 2), (5, 0, 0)])
    assert np.allclose(np.array(ax.lines[-1].get_data()).T, [[0, 0], [0, 1]])
    labels = [text.get_text() for text in ax.get_legend().get_texts()]
    assert any("isotropy so(3), orbits of dimension 0" in text for text in labels)
    with pytest.raises(lh.InputError, match="positive sum"):
        plot_eigenvalues(points=[(1, -1, 0)])


def test_medians_of_the_triangle_of_eigenvalues_end_in_the_middle_of_its_sides():
    ax = plot_eigenvalues()
    corners = ax.patches[0].get_xy()[:3]
    outline = np.array(ax.lines[0].get_data()).T
    assert np.allclose(outline, [*corners, corners[0]])
    assert np.allclose(np.linalg.norm(np.diff(outline, axis=0), axis=1), np.sqrt(3))
    for k, line in enumerate(ax.lines[1:4]):
        ends = np.array(line.get_data()).T
        assert np.allclose(ends, [corners[k], (corners[k - 1] + corners[k - 2]) / 2])
    assert np.allclose(ax.lines[4].get_data(), 0)
    window = np.array([ax.get_xlim(), ax.get_ylim()])
    assert sorted(text.get_text() for text in ax.texts) == ["(0, 0, 1)", "(0, 1, 0)", "(1, 0, 0)"]
    for text, corner in zip(ax.texts, corners, strict=True):
        place = np.array(text.get_position())
        assert 0.1 < np.linalg.norm(place - corner) < 0.2 and place @ corner > 1.1
        assert (window[:, 0] < place).all() and (place < window[:, 1]).all()


def test_the_legend_of_eigenvalues_has_the_colors_of_what_is_drawn():
    ax = plot_eigenvalues()
    region, medians, center = ax.patches[0], ax.lines[1:4], ax.lines[4]
    handles = {text.get_text().split(":")[0]: line for text, line in zip(
        ax.get_legend().get_texts(), ax.get_legend().get_lines(), strict=True)}  # fmt: skip
    colors = {name: to_hex(line.get_color()) for name, line in handles.items()}
    assert colors["a > b > c"] == to_hex(region.get_facecolor())
    assert [colors["two equal"]] * 3 == [to_hex(line.get_color()) for line in medians]
    assert colors["a = b = c"] == to_hex(center.get_color())
    assert len(set(colors.values())) == 3
    widths = {name: line.get_linewidth() for name, line in handles.items()}
    assert widths["a > b > c"] > widths["two equal"] == medians[0].get_linewidth()
    texts = [text.get_text() for text in ax.get_legend().get_texts()]
    assert [text.split(" dimension ")[1] for text in texts] == ["3", "2", "0"]


@pytest.mark.parametrize(("kind", "angle"), [("A2", 60), ("B2", 45), ("C2", 45), ("G2", 30), ("A1 + A1", 90)])
def test_the_chamber_has_the_angle_of_the_root_system(kind, angle):
    first, second = plot_weyl_chamber(kind).patches[0].get_xy()[1:3]
    cosine = first @ second / np.linalg.norm(first) / np.linalg.norm(second)
    assert np.degrees(np.arccos(cosine)) == pytest.approx(angle)
    with pytest.raises(lh.InputError, match="rank 3"):
        plot_weyl_chamber("A3")


@pytest.mark.parametrize("name", ["so(3,1)/so(2,1)", "affine(form(1,1,-3))", "sl(3)/B", "sl(2)/so(1,1)"])
def test_the_cone_is_drawn_if_its_numbers_are_beyond_floats(name):
    """A basis scaled by one factor of 400 digits changes only the size of the form, not its zeros."""
    pair, other = lh.pair(name), lh.pair(name)
    n = pair.algebra.dimension
    other = pair.change_of_basis([[10**400 if i == j else 0 for j in range(n)] for i in range(n)])
    first, second = (failure_curves(lh.failure_report(p), p.dimension) for p in (pair, other))
    assert len(first) == len(second) > 0
    for x, y in zip(first, second, strict=True):
        np.testing.assert_allclose(x, y, atol=1e-9)


def test_a_semidefinite_form_is_drawn_as_its_kernel():
    """Of (x0^2 + x1^2) x2 the first factor changes no sign: its zeros are the axis, those of the second a plane."""
    report = lh.failure_report(lh.pair("affine(blocks(so(2),gl(1)))"))
    assert [part.kind for part in report.parts] == ["hypersurface", "subspace", "subspace"]
    axis, circle, plane, line = failure_curves(report, 3)
    assert axis.shape == line.shape == (3, 1)
    np.testing.assert_allclose(abs(axis[:, 0]), [0, 0, 1], atol=1e-12)
    assert abs(circle[2]).max() < 1e-12 > abs(plane[2]).max()
