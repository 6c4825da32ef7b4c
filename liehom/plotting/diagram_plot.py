"""Plots of Dynkin, Satake and Vogan diagrams, and of bracket tables.

Nodes are in Bourbaki's order, numbered from 0. Several lines in a bond are an angle of 135 or 150 degrees between the
simple roots, and its arrow points to the shorter root.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, TypeAlias, TypeVar

import numpy as np

from liehom.algebra import LieAlgebra
from liehom.algebra.roots.dynkin import cartan_matrix, parse_type
from liehom.algebra.roots.real_form import RealForm
from liehom.algebra.roots.satake import SatakeDiagram
from liehom.algebra.roots.vogan import VoganDiagram
from liehom.errors import InputError, ShapeError, displayed
from liehom.plotting.canvas import (
    GREY,
    current_colours,
    matplotlib_module,
    new_figure,
    paper_colour,
    plain,
    style_unless,
)
from liehom.typing import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TITLE_INCHES = 0.09
"""Width of a character of a title, at most on average."""
Strip: TypeAlias = tuple[float, float, float, int]
"""Center, width and basis element of the part of a cell that shows one term of a bracket."""

Diagram = TypeVar("Diagram", SatakeDiagram, VoganDiagram)

NODE = 0.17
"""The radius of a node, at which its bonds end; neighbours are at distance 1."""
MAX_WIDTH = 12.0
MAX_BRACKETS = 60


def plot_dynkin(kind: str, ax: Axes | None = None, *, labels: Sequence[object] | None = None) -> Axes:
    """Draw the Dynkin diagram of a type.

    Parameters
    ----------
    kind : str
        'A4', 'E8', or a sum such as 'A2 + G2', whose diagrams are drawn below one another.
    ax : matplotlib.axes.Axes, optional
        Axes in the plane; by default new ones.
    labels : sequence, optional
        What to write at the nodes: coefficients of a highest weight or of the highest root. By default the numbers of
        the simple roots.

    Returns
    -------
    matplotlib.axes.Axes
        With a circle in ``ax.patches`` for each node, in Bourbaki's order.

    Raises
    ------
    CatalogError
        If there is no such type.
    InputError, ShapeError
        If matplotlib is not installed, or there is not one label for each node.

    Examples
    --------
    >>> import liehom as lh
    >>> ax = lh.plotting.plot_dynkin("F4")  # doctest: +SKIP

    The coefficients of the highest root:

    >>> ax = lh.plotting.plot_dynkin("E8", labels=lh.root_system("E8").highest_roots[0])  # doctest: +SKIP
    """
    cartan = cartan_matrix(kind)
    names = list(range(len(cartan))) if labels is None else list(labels)
    if len(names) != len(cartan):
        raise ShapeError(f"{kind} has {len(cartan)} nodes, got {len(names)} labels")
    with style_unless(ax):
        return _draw_diagram(ax, kind, kind, names)


def plot_satake(form: str | RealForm | SatakeDiagram, ax: Axes | None = None) -> Axes:
    """Draw the Satake diagram of a simple real Lie algebra.

    Parameters
    ----------
    form : str, RealForm or SatakeDiagram
        'su(3,2)', 'e6(-26)', 'sl(3,C)', ...
    ax : matplotlib.axes.Axes, optional
        Axes in the plane; by default new ones.

    Returns
    -------
    matplotlib.axes.Axes
        With a circle in ``ax.patches`` for each node: full for black nodes, whose simple roots vanish on the split part
        of the Cartan subalgebra. Arrows join white nodes with the same restricted root.

    Raises
    ------
    CatalogError
        If there is no such algebra, or it is not simple.
    InputError
        If matplotlib is not installed, or `form` is none of these.

    Examples
    --------
    >>> import liehom as lh
    >>> ax = lh.plotting.plot_satake("su(3,2)")  # doctest: +SKIP
    >>> ax = lh.plotting.plot_satake(lh.sl(2, "H").real_forms()[0])  # doctest: +SKIP
    """
    name, diagram = _named(form, SatakeDiagram)
    satake = diagram.satake if isinstance(diagram, RealForm) else diagram
    split = f"restricted roots {satake.restricted_type}, real rank {satake.real_rank}"
    title = name + (split if satake.real_rank else "compact")
    with style_unless(ax):
        return _draw_diagram(ax, satake.type, title, full=satake.black, arrows=satake.arrows, meaning="compact")


def plot_vogan(form: str | RealForm | VoganDiagram, ax: Axes | None = None) -> Axes:
    """Draw the Vogan diagram of a simple real Lie algebra.

    Parameters
    ----------
    form : str, RealForm or VoganDiagram
        'su(3,2)', 'e6(-26)', 'sl(3,C)', ...
    ax : matplotlib.axes.Axes, optional
        Axes in the plane; by default new ones.

    Returns
    -------
    matplotlib.axes.Axes
        With a circle in ``ax.patches`` for each node: full for painted nodes, whose roots are noncompact. Arrows join
        nodes that the Cartan involution exchanges.

    Raises
    ------
    CatalogError
        If there is no such algebra, or it is not simple.
    InputError
        If matplotlib is not installed, or `form` is none of these.

    Examples
    --------
    >>> import liehom as lh
    >>> ax = lh.plotting.plot_vogan("e7(-25)")  # doctest: +SKIP
    """
    name, diagram = _named(form, VoganDiagram)
    vogan = diagram.vogan if isinstance(diagram, RealForm) else diagram
    arrows = [(i, j) for i, j in enumerate(vogan.automorphism) if i < j]
    title = f"{name}dim k = {vogan.compact_dimension}, character {vogan.character}"
    with style_unless(ax):
        return _draw_diagram(ax, vogan.type, title, full=vogan.painted, arrows=arrows, meaning="noncompact")


def plot_bracket_table(algebra: LieAlgebra, ax: Axes | None = None) -> Axes:
    """Draw which basis elements appear in the brackets of basis elements, and with which sign.

    Parameters
    ----------
    algebra : LieAlgebra
        Of dimension at most 60; pictures are easy to read up to dimension 30.
    ax : matplotlib.axes.Axes, optional
        Axes in the plane; by default new ones.

    Returns
    -------
    matplotlib.axes.Axes
        The cell in row i and column j has a strip for each term of [e_i, e_j], in the colour that e_k has at the margin
        and with the sign of the coefficient. Its name, and the coefficient if not 1, are written where there is room.

    Raises
    ------
    InputError
        If matplotlib is not installed, `algebra` is not a Lie algebra, or its dimension is 0 or above 60.

    Examples
    --------
    >>> import liehom as lh
    >>> ax = lh.plotting.plot_bracket_table(lh.so(4))  # doctest: +SKIP
    """
    if not isinstance(algebra, LieAlgebra) or not 0 < algebra.dimension <= MAX_BRACKETS:
        found = f"dimension {algebra.dimension}" if isinstance(algebra, LieAlgebra) else displayed(algebra)
        raise InputError(f"a bracket table is drawn for a Lie algebra of dimension 1 to {MAX_BRACKETS}; got {found}")
    n = algebra.dimension
    side = float(np.clip(1.6 + 0.32 * n, 3.2, 9.0))
    with style_unless(ax):
        ax = new_figure(side, side).add_subplot() if ax is None else ax
        colours = _element_colours(n)
        # the margin, which says what each colour means
        ends = [(-1.5, float(k), 1.0, k) for k in range(n)] + [(float(k), -1.5, 1.0, k) for k in range(n)]
        strips, signs = _strips(algebra)
        rectangle, collection = matplotlib_module("patches").Rectangle, matplotlib_module("collections").PatchCollection
        for cells in (ends, strips):
            boxes = [rectangle((x - width / 2, y - 0.5), width, 1.0) for x, y, width, _ in cells]
            filled = [colours[k] for *_, k in cells]
            ax.add_collection(collection(boxes, facecolor=filled, edgecolor=paper_colour(), linewidth=0.4))
        points = 72 / ax.figure.dpi * min(ax.bbox.width, ax.bbox.height) / (n + 2)  # the side of a cell
        for sign, marker in ((1, "+"), (-1, "_")):
            chosen = [strip for strip, s in zip(strips, signs, strict=True) if s == sign]
            places = np.array([(x, y - 0.16) for x, y, _, _ in chosen]).reshape(-1, 2)
            sizes = [(points * min(0.4, 0.8 * width)) ** 2 for _, _, width, _ in chosen]
            inks = [_ink(colours[k]) for *_, k in chosen] or None
            ax.scatter(
                places[:, 0], places[:, 1], s=sizes, marker=marker, c=inks, linewidth=max(0.7, points / 16), zorder=3
            )
        _write_terms(ax, algebra, strips, colours, points)
        ax.set(aspect="equal", xlim=(-2.1, n - 0.4), ylim=(n - 0.4, -2.1))
        names = [plain(name) for name in algebra.basis_names]
        ax.set_xticks(range(n), names, rotation=90 if max(map(len, names)) > 2 else 0)
        ax.set_yticks(range(n), names)
        ax.tick_params(length=0, labelsize=float(np.clip(200 / n, 5, 9)), labeltop=True, labelbottom=False)
        ax.grid(visible=False)
        ax.spines[:].set_visible(False)
        ax.set_title(f"{plain(algebra.name or 'Lie algebra')}: [row, column]", loc="left")
    return ax


def node_places(kind: str, arrows: Iterable[tuple[int, int]] = ()) -> Array:
    """The places (r, 2) of the nodes of a diagram, simple components below one another.

    Components of type A and E6 are folded in two lines if arrows join their nodes. If arrows join two components, the
    second is the mirror image of the first.

    Examples
    --------
    >>> node_places("D4").tolist()
    [[0.0, 0.0], [1.0, 0.0], [2.0, 0.5], [2.0, -0.5]]
    >>> node_places("A3", [(0, 2)]).tolist()
    [[0.0, 0.5], [1.0, 0.0], [0.0, -0.5]]
    """
    places: list[Array] = []
    base, start = 0.0, 0
    joined = list(arrows)
    for letter, rank in parse_type(kind):
        nodes = range(start, start + rank)
        folded = any(i in nodes and j in nodes for i, j in joined)
        part = np.array([_place(letter, rank, i, folded) for i in range(rank)])
        if any(i < start <= j for i, j in joined):
            part[:, 1] *= -1
        if places:
            base -= 1.3 + part[:, 1].max()
        places.append(part + np.array([0.0, base]))
        base += part[:, 1].min()
        start += rank
    return np.concatenate(places) if places else np.zeros((0, 2))


def _place(letter: str, rank: int, i: int, folded: bool) -> tuple[float, float]:
    """The place of node i of a simple type."""
    if letter == "A" and folded:
        return float(min(i, rank - 1 - i)), 0.5 * float(np.sign(rank - 1 - 2 * i))
    if letter == "D" and i >= rank - 2:
        return float(rank - 2), 0.5 if i == rank - 2 else -0.5
    if letter != "E":
        return float(i), 0.0
    if folded:
        return ((0.0, 0.5), (3.0, 0.0), (1.0, 0.5), (2.0, 0.0), (1.0, -0.5), (0.0, -0.5))[i]
    return (2.0, 0.85) if i == 1 else (float(max(i - 1, 0)), 0.0)


def _draw_diagram(
    ax: Axes | None,
    kind: str,
    title: str,
    labels: Sequence[object] | None = None,
    *,
    full: Sequence[int] = (),
    arrows: Sequence[tuple[int, int]] = (),
    meaning: str = "",
) -> Axes:
    cartan = cartan_matrix(kind)
    places = node_places(kind, arrows)
    low, high = (places.min(axis=0), places.max(axis=0)) if len(places) else (np.zeros(2), np.zeros(2))
    width, height = high - low
    unit = min(0.62, MAX_WIDTH / (width + 1.4))
    if ax is None:
        across = max(unit * (width + 1.4), 3.6, TITLE_INCHES * len(title))
        ax = new_figure(across, unit * (height + 1.5) + (0.75 if full else 0.4)).add_subplot(anchor="W")
    ink = current_colours()[6]
    for i, row in enumerate(cartan):
        for j in range(i):
            if row[j]:
                longer, shorter = (i, j) if row[j] < -1 else (j, i)
                _draw_bond(ax, places[longer], places[shorter], row[j] * cartan[j][i])
    circle = matplotlib_module("patches").Circle
    for i, place in enumerate(places):
        face = ink if i in full else "none"
        ax.add_patch(circle(tuple(place), NODE, facecolor=face, edgecolor=ink, linewidth=1.3, zorder=3))
    for i, j in arrows:
        _draw_arrow(ax, places, i, j, bool(cartan[i][j]))
    size = float(np.clip(20 * unit, 4, 9))
    for i, label in enumerate(range(len(places)) if labels is None else labels):
        # no label towards bonds, arrows, and the other line of a folded diagram
        facing = (places[:, 0] == places[i, 0]) & (abs(places[:, 1] - places[i, 1]) <= 1)
        joined = [(i, j) in arrows or (j, i) in arrows or cartan[i][j] != 0 for j in range(len(places))]
        near = (facing | np.array(joined)) & (np.arange(len(places)) != i)
        x, y = places[i] + _label_shift(places[near] - places[i])
        ax.text(x, y, str(label), ha="center", va="center", fontsize=size)
    if full:
        ax.plot([], [], "o", color=ink, markersize=8, label=f"{meaning} root")
        ax.legend(loc="upper left", bbox_to_anchor=(0.0, 0.02), borderaxespad=0.0)
    ax.set(aspect="equal", xlim=(low[0] - 0.7, high[0] + 0.7), ylim=(low[1] - 0.75, high[1] + 0.7))
    ax.set_axis_off()
    ax.set_title(title, loc="left")
    return ax


def _draw_bond(ax: Axes, longer: Array, shorter: Array, lines: int) -> None:
    """One, two or three lines between the rims of two nodes; for several, an arrow head towards the shorter root."""
    along = (shorter - longer) / np.linalg.norm(shorter - longer)
    across = np.array([-along[1], along[0]])
    for shift in 0.065 * np.arange(1 - lines, lines, 2):
        rim = np.sqrt(NODE**2 - shift**2)
        ends = np.array([longer + rim * along, shorter - rim * along]) + shift * across
        ax.plot(*ends.T, color=GREY, linewidth=1.2, zorder=1)
    if lines > 1:
        tip = (longer + shorter) / 2 + 0.08 * along
        head = [tip - 0.16 * along + 0.17 * across, tip, tip - 0.16 * along - 0.17 * across]
        ax.plot(*np.array(head).T, color=GREY, linewidth=1.4, zorder=1)


def _draw_arrow(ax: Axes, places: Array, i: int, j: int, bonded: bool) -> None:
    """A double arrow between two nodes, bent if it would lie on a bond or on another node."""
    start, end = places[i], places[j]
    along = (end - start) / np.linalg.norm(end - start)
    across = np.array([along[1], -along[0]])
    between = [
        k for k, p in enumerate(places - start) if abs(p @ across) < NODE and 0 < p @ along < (end - start) @ along
    ]
    bent = bonded or any(k not in (i, j) for k in between)
    options = {"arrowstyle": "<->", "color": current_colours()[1], "linewidth": 1.3, "shrinkA": 1, "shrinkB": 1}
    options |= {"connectionstyle": f"arc3,rad={-0.45 if bent else 0.0}", "mutation_scale": 9}
    ax.annotate("", end, start, arrowprops={**options, "patchA": ax.patches[i], "patchB": ax.patches[j]})


def _label_shift(neighbours: Array) -> Array:
    """The place of a label relative to its node, (2,): below, unless a bond or arrow is there."""
    unit = neighbours / np.linalg.norm(neighbours, axis=1)[:, None]
    directions = np.array([(0, -1), (0, 1), (1, 0), (-1, 0), (-0.75, -0.75), (-0.75, 0.75)], dtype=float)
    nearness = (unit @ (directions / np.linalg.norm(directions, axis=1)[:, None]).T).max(axis=0, initial=-1.0)
    free = nearness < 0.4
    shift: Array = 0.4 * directions[int(np.argmax(free) if free.any() else np.argmin(nearness.round(6)))]
    return shift


def _named(form: object, data: type[Diagram]) -> tuple[str, RealForm | Diagram]:
    """The prefix of the title and the real form; a diagram, which has no name, as it is."""
    if isinstance(form, data):
        return "", form
    found = RealForm.of_name(form) if isinstance(form, str) else form
    if not isinstance(found, RealForm):
        raise InputError(f"expected the name of a real form, a RealForm or a {data.__name__}, got {displayed(form)}")
    return f"{found.name}: ", found


def _element_colours(n: int) -> list[str]:
    """A colour for each of n basis elements: those of the style, or a scale from dark to light."""
    few = current_colours()[:6]
    if n <= len(few):
        return list(few[:n])
    ends = (0.2, 1.0) if paper_colour() == "black" else (0.0, 0.93)
    scale = matplotlib_module("").colormaps["viridis"]
    return [matplotlib_module("colors").to_hex(scale(x)) for x in np.linspace(*ends, n)]


def _ink(colour: str) -> str:
    """Black or white, whichever is read on this colour."""
    red, green, blue = matplotlib_module("colors").to_rgb(colour)
    return "black" if 0.3 * red + 0.59 * green + 0.11 * blue > 0.5 else "white"


def _strips(algebra: LieAlgebra) -> tuple[list[Strip], list[int]]:
    """The terms of all brackets as strips (x, y, width, k), and the signs of their coefficients."""
    cells: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for i, j, k, value in algebra.structure_constants():
        sign = algebra.field.sign(value)
        cells.setdefault((i, j), []).append((k, sign))
        cells.setdefault((j, i), []).append((k, -sign))
    strips, signs = [], []
    for (i, j), terms in cells.items():
        for t, (k, sign) in enumerate(sorted(terms)):
            strips.append((j - 0.5 + (t + 0.5) / len(terms), float(i), 1 / len(terms), k))
            signs.append(sign)
    return strips, signs


def _write_terms(ax: Axes, algebra: LieAlgebra, strips: Sequence[Strip], colours: Sequence[str], points: float) -> None:
    """The terms without their signs, such as e2 or 3·e2, in the strips that have room for them."""
    constants = {(i, j, k): value for i, j, k, value in algebra.structure_constants()}
    size = float(np.clip(0.28 * points, 0, 9))
    for x, y, width, k in strips:
        i, j = int(y), round(x)
        value, name = constants[min(i, j), max(i, j), k], plain(algebra.basis_names[k])
        one = abs(algebra.field.to_float(value)) == 1.0
        text = name if one else f"{algebra.field.show(value).lstrip('-')}·{name}"
        if size >= 4 and 0.62 * size * len(text) < width * points:
            ax.text(x, y + 0.27, text, color=_ink(colours[k]), fontsize=size, ha="center", va="center", zorder=4)
