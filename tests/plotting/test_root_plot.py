"""Root systems and weight diagrams: what is drawn, and on whose axes."""

import numpy as np
import pytest

import liehom as lh

pytest.importorskip("matplotlib")

from liehom.plotting.canvas import COLOURS, DARK_COLOURS, new_figure, style
from liehom.plotting.diagram_plot import plot_root_system, plot_weights, simple_root_coordinates

KINDS = ["A1", "A2", "B2", "C2", "G2", "A1 + A1", "A3", "B3", "C3", "A1 + G2", "A1 + A1 + A1"]


def points_of(line):
    return np.array(line.get_data_3d() if hasattr(line, "get_data_3d") else line.get_data()).T


def drawn(ax):
    """The points with a marker, by their label (the legend's, or matplotlib's own for lines without one)."""
    return {line.get_label(): points_of(line) for line in ax.lines if line.get_marker() not in ("None", None)}


@pytest.mark.parametrize("kind", [*KINDS, "A8", "B6", "F4", "E8"])
def test_coordinates_of_simple_roots_have_the_angles_and_lengths_of_the_system(kind):
    system = lh.root_system(kind)
    simple = simple_root_coordinates(system)
    gram = [[system.inner(a, b) for b in system.simple_roots] for a in system.simple_roots]
    assert np.allclose(simple @ simple.T, gram)
    assert np.allclose(simple, np.tril(simple))


@pytest.mark.parametrize("kind", KINDS)
def test_every_root_is_drawn_once_and_closed_under_reflections(kind):
    system = lh.root_system(kind)
    ax = plot_root_system(kind)
    roots = np.concatenate(list(drawn(ax).values()))
    assert len(roots) == system.number_of_roots
    for a in roots:
        images = roots - 2 * np.outer(roots @ a, a) / (a @ a)
        assert all(np.isclose(roots, b).all(axis=1).sum() == 1 for b in images)
    assert (ax.name == "3d") == (system.rank == 3)
    assert len([text for text in ax.texts if "alpha" in text.get_text()]) == system.rank


def test_legend_counts_roots_by_length():
    texts = [text.get_text() for text in plot_root_system("B3").get_legend().get_texts()]
    assert [text.split()[0] for text in texts] == ["6", "12"]
    assert "= 2" in texts[0]
    assert "= 4" in texts[1]


def test_edges_join_nearest_roots_of_one_length():
    """The 12 roots of A3 are the vertices of a cuboctahedron, which has 24 edges of the length of a root."""
    edges = points_of(plot_root_system("A3").lines[0]).reshape(24, 3, 3)
    assert np.allclose(np.linalg.norm(edges[:, 0] - edges[:, 1], axis=1), np.sqrt(2))
    assert np.isnan(edges[:, 2]).all()


@pytest.mark.parametrize(
    ("kind", "weight"),
    [
        ("A1", (4,)),
        ("A2", (1, 1)),
        ("A2", (3, 1)),
        ("B2", (1, 1)),
        ("G2", (1, 1)),
        ("A3", (1, 0, 1)),
        ("B3", (1, 0, 1)),
    ],
)
def test_weights_are_drawn_with_multiplicities_that_add_up_to_the_dimension(kind, weight):
    ax = plot_weights(kind, weight)
    groups = {int(label.split()[1]): points for label, points in drawn(ax).items()}
    assert sum(k * len(points) for k, points in groups.items()) == lh.weyl_dimension(kind, weight)
    written = [text.get_text() for text in ax.texts if text.get_text().isdigit()]
    assert sorted(written) == sorted(str(k) for k, points in groups.items() if k > 1 for _ in points)
    # one Weyl orbit, that of the highest weight, is furthest from 0
    system = lh.root_system(kind)
    norms = np.linalg.norm(np.concatenate(list(groups.values())), axis=1)
    assert np.isclose(norms, norms.max()).sum() == len(lh.representations.weyl_orbit(system, weight))


def test_adjoint_weights_are_the_roots_and_zero():
    roots = np.concatenate(list(drawn(plot_root_system("G2")).values()))
    groups = drawn(plot_weights("G2", (0, 1)))
    assert np.allclose(groups["multiplicity 2"], 0)
    assert np.allclose(sorted(roots.round(9).tolist()), sorted(groups["multiplicity 1"].round(9).tolist()))


def test_edges_join_weights_that_differ_by_a_short_root():
    ax = plot_weights("A2", (1, 0))
    edges = [points_of(line).reshape(-1, 3, 2) for line in ax.lines if line.get_marker() in ("None", None)]
    assert np.allclose(np.concatenate([np.linalg.norm(e[:, 0] - e[:, 1], axis=1) for e in edges]), [np.sqrt(2)] * 3)


def test_large_modules_show_multiplicities_by_size():
    ax = plot_weights("A2", (14, 8))
    assert not any(text.get_text().isdigit() for text in ax.texts)
    sizes = [line.get_markersize() for line in ax.lines if line.get_marker() == "o"]
    assert sizes == sorted(sizes)
    assert sizes[0] < sizes[-1]
    assert sum(len(line.get_xdata()) for line in ax.lines if line.get_marker() == "o") == 388


def test_root_systems_of_algebras_are_drawn():
    assert plot_root_system(lh.sl(3).root_system()).get_title(loc="left").startswith("A2")


@pytest.mark.parametrize("draw", [plot_root_system, lambda kind, ax=None: plot_weights(kind, (0,) * 4, ax)])
@pytest.mark.parametrize("kind", ["A4", "0"])
def test_other_ranks_are_refused(draw, kind):
    with pytest.raises(lh.InputError, match="rank 1, 2 or 3"):
        draw(kind)


def test_given_axes_are_used_and_must_have_the_dimension():
    figure = new_figure(3, 3)
    flat, solid = figure.add_subplot(1, 2, 1), figure.add_subplot(1, 2, 2, projection="3d")
    assert plot_root_system("A2", flat) is flat
    assert plot_weights("A3", (1, 0, 0), solid) is solid
    with pytest.raises(lh.InputError, match="projection='3d'"):
        plot_root_system("A3", flat)
    with pytest.raises(lh.InputError, match="in the plane"):
        plot_weights("A2", (1, 0), solid)
    with pytest.raises(lh.InputError, match="axes of matplotlib"):
        plot_root_system("A2", "axes")
    with pytest.raises(lh.InputError, match="dominant"):
        plot_weights("A2", (1, -1))
    with pytest.raises(lh.InputError, match="at most 1000000, found 1003003001"):
        plot_weights("A2", (1000, 1000))


@pytest.mark.parametrize(("dark", "colours"), [(False, COLOURS), (True, DARK_COLOURS)])
def test_colours_follow_the_style_of_the_caller(dark, colours):
    with style(dark=dark):
        ax = plot_root_system("A2", new_figure(3, 3).add_subplot())
    assert ax.lines[-1].get_color() == colours[0]
