"""Dynkin, Satake and Vogan diagrams and bracket tables: what is drawn, and on whose axes."""

import numpy as np
import pytest

import liehom as lh

pytest.importorskip("matplotlib")

from matplotlib.colors import to_hex
from matplotlib.text import Text

from liehom.plotting.canvas import COLOURS, new_figure
from liehom.plotting.diagram_plot import (
    NODE,
    _label_shift,
    node_places,
    plot_bracket_table,
    plot_dynkin,
    plot_satake,
    plot_vogan,
)

KINDS = ["A1", "A5", "B2", "B4", "C4", "D2", "D3", "D5", "E6", "E7", "E8", "F4", "G2", "A2 + G2", "D4 + E6", "0"]


def centers(ax):
    return np.array([patch.center for patch in ax.patches]).reshape(-1, 2)


def full_nodes(ax):
    """Black nodes; the others are white, in light and in dark pictures."""
    assert {patch.get_facecolor() for patch in ax.patches} <= {(0.0, 0.0, 0.0, 1.0), (1.0, 1.0, 1.0, 1.0)}
    return tuple(i for i, patch in enumerate(ax.patches) if patch.get_facecolor()[:3] == (0.0, 0.0, 0.0))


def arrows(ax):
    """Pairs of nodes that arrows join, by the places at their ends."""
    places = centers(ax)

    def node(point):
        return int(np.argmin(np.linalg.norm(places - point, axis=1)))

    return tuple((node(text.xyann), node(text.xy)) for text in ax.texts if getattr(text, "arrow_patch", None))


def bonds(ax):
    """{(i, j): lines} by the rims at which lines end, and {(i, j)} with an arrow head from i to j."""
    places, lines, heads = centers(ax), {}, set()
    for x in (np.array(line.get_data()).T for line in ax.lines):
        if len(x) == 2:
            ends = tuple(sorted(int(np.argmin(np.linalg.norm(places - end, axis=1))) for end in x))
            assert np.allclose([np.linalg.norm(places - end, axis=1).min() for end in x], NODE)
            lines[ends] = lines.get(ends, 0) + 1
        elif len(x) == 3:
            along = x[1] - (x[0] + x[2]) / 2
            ahead = [i for i, p in enumerate(places) if (p - x[1]) @ along > 0]
            nearest = np.argsort(np.linalg.norm(places - x[1], axis=1))[:2]
            heads.add(next((int(j), int(i)) for i in nearest for j in nearest if i in ahead and i != j))
    return lines, heads


@pytest.mark.parametrize("kind", KINDS)
def test_bonds_are_those_of_the_cartan_matrix_and_point_to_shorter_roots(kind):
    system = lh.root_system(kind)
    lines, heads = bonds(plot_dynkin(kind))
    a = np.array(system.cartan).reshape(system.rank, system.rank)
    expected = {(i, j): a[i, j] * a[j, i] for i in range(system.rank) for j in range(i + 1, system.rank) if a[i, j]}
    assert lines == expected
    assert heads == {(i, j) for i, j in np.argwhere(a < -1).tolist()}
    assert all(system.norms[i] > system.norms[j] for i, j in heads)


@pytest.mark.parametrize("kind", KINDS)
def test_nodes_are_apart(kind):
    places = node_places(kind)
    assert (np.linalg.norm(places[:, None] - places, axis=2) + 10 * np.eye(len(places)) > 0.8).all()


@pytest.mark.parametrize(("bonds", "shift"), [
    ([], (0, -1)), ([(1, 0)], (0, -1)), ([(0, -2)], (0, 1)), ([(0, -1), (0, 1)], (1, 0)),
    ([(0, -1), (0, 1), (3, 0)], (-1, 0)), ([(1, 0), (-1, 0), (0, 1), (0, -1)], (-0.75, -0.75)),
    ([(0, -1), (0, 1), (1, 0), (-1, 0.5)], (-0.75, -0.75)), ([(0.3, -1)], (0, 1)), ([(0.5, -0.2)], (0, -1)),
    ([(1, 0), (-1, 0), (0, 1), (0, -1), (-1, -1)], (-0.75, 0.75)), ([(0, -0.3)], (0, 1)),
    # bonds at 45, 157 and 293 degrees leave no axis free, and the diagonal by 68 degrees
    ([(0.707, 0.707), (-0.921, 0.391), (0.391, -0.921)], (-0.75, -0.75)),
])  # fmt: skip
def test_labels_are_beside_nodes_where_no_bond_is(bonds, shift):
    found = _label_shift(np.array(bonds, dtype=float).reshape(-1, 2))
    assert np.allclose(found, 0.4 * np.array(shift))


@pytest.mark.parametrize("kind", [k for k in KINDS if k != "0"])
def test_no_label_lies_on_another_or_on_a_node(kind):
    ax = plot_dynkin(kind)
    texts = np.array([text.get_position() for text in ax.texts if text.get_text()])
    places = np.concatenate([texts, centers(ax)])
    apart = np.linalg.norm(places[:, None] - places[None], axis=2) + 9 * np.eye(len(places))
    assert apart.min() > 0.3


def test_labels_replace_the_numbers_of_nodes():
    marks = lh.root_system("E8").highest_roots[0]
    assert [text.get_text() for text in plot_dynkin("E8", labels=marks).texts] == [str(x) for x in marks]
    assert [text.get_text() for text in plot_dynkin("A3").texts] == ["1", "2", "3"]
    with pytest.raises(lh.ShapeError, match="8 nodes, got 2"):
        plot_dynkin("E8", labels=(1, 2))
    with pytest.raises(lh.CatalogError):
        plot_dynkin("H3")


FEW = [form.name for form in lh.algebra.simple_real_forms(10)]
FEW += ["su(3,2)", "su(3,3)", "so(5,3)", "so(8,C)", "so*(10)", "sp(2,1)", "e6(2)", "e6(-14)", "f4(-20)", "e7(-25)"]
MORE = [form.name for form in lh.algebra.simple_real_forms(80) if form.name not in FEW]


@pytest.mark.parametrize("name", [*FEW, *(pytest.param(name, marks=pytest.mark.slow) for name in MORE)])
def test_diagrams_of_simple_real_forms(name):
    """Black nodes, painted nodes and arrows are read off the picture."""
    form = lh.RealForm.of_name(name)
    satake, vogan = plot_satake(form), plot_vogan(name)
    assert (full_nodes(satake), arrows(satake)) == (form.satake.black, form.satake.arrows)
    pairs = tuple((i, j) for i, j in enumerate(form.vogan.automorphism) if i < j)
    assert (full_nodes(vogan), arrows(vogan)) == (form.vogan.painted, pairs)
    assert bonds(satake)[0] == bonds(vogan)[0]
    assert satake.get_title(loc="left").startswith(f"{form.name}: ")
    legends = [ax.get_legend() for ax in (satake, vogan)]
    assert [legend is not None for legend in legends] == [bool(form.satake.black), bool(form.vogan.painted)]


@pytest.mark.parametrize("name", ["su(3,2)", "e6(2)", "so(8,C)", "so(5,3)", "su(2,1)", "e6(C)"])
def test_straight_arrows_cross_no_node(name):
    ax = plot_satake(name)
    places = centers(ax)
    for text in (text for text in ax.texts if getattr(text, "arrow_patch", None)):
        if text.arrowprops["connectionstyle"] == "arc3,rad=0.0":
            near = np.linalg.norm(places[:, None] - np.linspace(text.xyann, text.xy, 50), axis=2).min(axis=1) < NODE
            assert near.sum() == 2


def test_diagrams_without_a_name_are_drawn():
    assert full_nodes(plot_satake(lh.algebra.SatakeDiagram("B2", black=(1,)))) == (1,)
    assert full_nodes(plot_vogan(lh.algebra.VoganDiagram("G2", painted=(1,)))) == (1,)


@pytest.mark.parametrize("draw", [plot_satake, plot_vogan])
def test_other_real_forms_are_refused(draw):
    with pytest.raises(lh.InputError, match="real form"):
        draw(7)
    with pytest.raises(lh.CatalogError, match="not simple"):
        draw("so(4)")
    with pytest.raises(lh.InputError, match="axes of matplotlib"):
        draw("su(2,1)", "axes")


def read_table(ax, n):
    """{(i, j): {k: sign}} read from the colours and signs of a picture whose elements have different colours."""
    key, cells = ax.collections[:2]
    colours = [to_hex(c) for c in key.get_facecolor()]
    assert colours[:n] == colours[n:]
    signs = {}
    for sign, marks in zip((1, -1), ax.collections[2:], strict=True):
        signs |= {(round(float(x), 6), round(float(y))): sign for x, y in marks.get_offsets()}
    table = {}
    for path, face in zip(cells.get_paths(), cells.get_facecolor(), strict=True):
        low, high = path.vertices.min(axis=0), path.vertices.max(axis=0)
        x, y = (low + high) / 2
        k = colours.index(to_hex(face))
        table.setdefault((round(y), int(np.floor(low[0] + 0.5 + 1e-9))), {})[k] = signs[round(float(x), 6), round(y)]
    return table


@pytest.mark.parametrize(
    "algebra",
    [lh.sl(2), lh.so(4), lh.sl(3), lh.heisenberg(2), lh.su(4), lh.so(8), lh.LieAlgebra({}, dimension=2)],
    ids=repr,
)
def test_bracket_tables_are_read_off_the_picture(algebra):
    expected = {}
    for i, j, k, value in algebra.structure_constants():
        sign = algebra.field.sign(value)
        expected.setdefault((i, j), {})[k] = sign
        expected.setdefault((j, i), {})[k] = -sign
    assert read_table(plot_bracket_table(algebra), algebra.dimension) == expected


def test_terms_are_written_with_coefficients_and_without_signs():
    assert {text.get_text() for text in plot_bracket_table(lh.sl(2)).texts} == {"e2", "2·e0", "2·e1"}
    assert {text.get_text() for text in plot_bracket_table(lh.heisenberg(2)).texts} == {"z"}


def test_bracket_tables_use_given_axes_and_refuse_other_input():
    flat = new_figure(3, 3).add_subplot()
    assert plot_bracket_table(lh.so(3), flat) is flat
    assert to_hex(flat.collections[0].get_facecolor()[0]).upper() == COLOURS[0]
    for wrong in ("so(3)", lh.LieAlgebra({}, dimension=0), lh.so(12)):
        with pytest.raises(lh.InputError, match="dimension 1 to 60"):
            plot_bracket_table(wrong)


def test_titles_of_narrow_diagrams_are_not_cut() -> None:
    for form in ("su(3,2)", "sp(4,R)", "e6(-26)"):
        ax = plot_satake(form)
        ax.figure.draw_without_rendering()  # type: ignore[union-attr]
        texts = [artist for artist in ax.get_children() if isinstance(artist, Text)]
        assert any("real rank" in text.get_text() for text in texts)
        assert all(text.get_window_extent().x1 <= ax.figure.bbox.x1 for text in texts if text.get_text())


def test_labels_of_long_diagrams_are_small() -> None:
    for rank, size in ((10, 9.0), (40, 20 * 12 / 40.4), (80, 4.0)):
        assert [text.get_fontsize() for text in plot_dynkin(f"A{rank}").texts] == pytest.approx([size] * rank)


def test_the_algebra_0_has_no_nodes() -> None:
    assert node_places("0").shape == (0, 2)


@pytest.mark.parametrize(("dimension", "size"), [(10, 9.0), (30, 200 / 30), (60, 5.0)])
def test_names_of_many_basis_elements_are_small(dimension, size):
    ax = plot_bracket_table(lh.LieAlgebra({}, dimension=dimension))
    assert [label.get_fontsize() for label in ax.get_yticklabels()] == pytest.approx([size] * dimension)
