"""Plots of Dynkin, Satake and Vogan diagrams, bracket tables, roots and weights."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, TypeAlias, TypeVar

import numpy as np

from liehom.base.errors import InputError, ShapeError, displayed
from liehom.base.typing import Array, IntegerArray
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.roots.diagrams import SatakeDiagram, VoganDiagram
from liehom.exact.algebra.roots.real_form import RealForm
from liehom.exact.algebra.roots.root_system import RootSystem, cartan_matrix, parse_type, root_system
from liehom.exact.representations.highest_weight.characters import character, weyl_dimension
from liehom.plotting.canvas import (
    GREY,
    MARKERS,
    axes_of_dimension,
    current_colours,
    matplotlib_module,
    new_figure,
    paper_colour,
    plain,
    style_unless,
    written,
)
from liehom.plotting.phase_plot import AnyAxes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Plots of Dynkin, Satake and Vogan diagrams, and of bracket tables. Nodes have Bourbaki's numbers, from 1.
# Several lines in a bond are an angle of 135 or 150 degrees between the simple roots, and its arrow points to the
# shorter root.

TITLE_INCHES = 0.09  # Width of a character of a title, at most on average
# Center, width and basis element of the part of a cell that shows one term of a bracket
Strip: TypeAlias = tuple[float, float, float, int]

Diagram = TypeVar("Diagram", SatakeDiagram, VoganDiagram)

NODE = 0.17  # The radius of a node, at which its bonds end; neighbours are at distance 1
MAX_WIDTH = 12.0
MAX_BRACKETS = 60


def plot_dynkin(
    kind: str,
    ax: Axes | None = None,
    *,
    labels: Sequence[object] | None = None,
    path: str | os.PathLike[str] | None = None,
) -> Axes:
    """Draw the Dynkin diagram of a type.

    Parameters
    ----------
    kind : str
        'A4', 'E8', or a sum such as 'A2 + G2', whose diagrams are drawn below one another.
    ax : matplotlib.axes.Axes, optional
        Axes in the plane; by default new ones.
    labels : sequence, optional
        What to write at the nodes: coefficients of a highest weight or of the highest root. By default the numbers of
        the simple roots, from 1 as in Bourbaki.
    path : path, optional
        A file to write the picture to.

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
    names = list(range(1, len(cartan) + 1)) if labels is None else list(labels)
    if len(names) != len(cartan):
        raise ShapeError(f"{kind} has {len(cartan)} nodes, got {len(names)} labels")
    with style_unless(ax):
        return written(_draw_diagram(ax, kind, kind, names), path)


def plot_satake(
    form: str | RealForm | SatakeDiagram, ax: Axes | None = None, *, path: str | os.PathLike[str] | None = None
) -> Axes:
    """Draw the Satake diagram of a simple real Lie algebra.

    Parameters
    ----------
    form : str, RealForm or SatakeDiagram
        'su(3,2)', 'e6(-26)', 'sl(3,C)', ...
    ax : matplotlib.axes.Axes, optional
        Axes in the plane; by default new ones.
    path : path, optional
        A file to write the picture to.

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
        return written(
            _draw_diagram(ax, satake.type, title, full=satake.black, arrows=satake.arrows, meaning="compact"), path
        )


def plot_vogan(
    form: str | RealForm | VoganDiagram, ax: Axes | None = None, *, path: str | os.PathLike[str] | None = None
) -> Axes:
    """Draw the Vogan diagram of a simple real Lie algebra.

    Parameters
    ----------
    form : str, RealForm or VoganDiagram
        'su(3,2)', 'e6(-26)', 'sl(3,C)', ...
    ax : matplotlib.axes.Axes, optional
        Axes in the plane; by default new ones.
    path : path, optional
        A file to write the picture to.

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
        return written(
            _draw_diagram(ax, vogan.type, title, full=vogan.painted, arrows=arrows, meaning="noncompact"), path
        )


def plot_bracket_table(
    algebra: LieAlgebra, ax: Axes | None = None, *, path: str | os.PathLike[str] | None = None
) -> Axes:
    """Draw which basis elements appear in the brackets of basis elements, and with which sign.

    Parameters
    ----------
    algebra : LieAlgebra
        Of dimension at most 60; pictures are easy to read up to dimension 30.
    ax : matplotlib.axes.Axes, optional
        Axes in the plane; by default new ones.
    path : path, optional
        A file to write the picture to.

    Returns
    -------
    matplotlib.axes.Axes
        The cell in row i and column j has a strip for each term of [e_i, e_j], in the colour that e_k has at the margin
        and with the sign of the coefficient. Its name, and the coefficient if not 1, are written where there is room.

    Examples
    --------
    >>> import liehom as lh
    >>> ax = lh.plotting.plot_bracket_table(lh.so(4))  # doctest: +SKIP
    """
    if not isinstance(algebra, LieAlgebra) or not 0 < algebra.dimension <= MAX_BRACKETS:
        actual = f"dimension {algebra.dimension}" if isinstance(algebra, LieAlgebra) else displayed(algebra)
        raise InputError(f"a bracket table is drawn for a Lie algebra of dimension 1 to {MAX_BRACKETS}; got {actual}")
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
    return written(ax, path)


def node_places(kind: str, arrows: Iterable[tuple[int, int]] = ()) -> Array:
    """The places (r, 2) of the nodes: components below one another, folded or mirrored where arrows join nodes."""
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
        face = "black" if i in full else "white"  # in dark pictures too: the convention names these colours
        ax.add_patch(circle(tuple(place), NODE, facecolor=face, edgecolor=ink, linewidth=1.3, zorder=3))
    for i, j in arrows:
        _draw_arrow(ax, places, i, j, bool(cartan[i][j]))
    size = float(np.clip(20 * unit, 4, 9))
    for i, label in enumerate(range(1, len(places) + 1) if labels is None else labels):
        # no label towards bonds, arrows, and the other line of a folded diagram
        facing = (places[:, 0] == places[i, 0]) & (abs(places[:, 1] - places[i, 1]) <= 1)
        joined = [(i, j) in arrows or (j, i) in arrows or cartan[i][j] != 0 for j in range(len(places))]
        near = (facing | np.array(joined)) & (np.arange(len(places)) != i)
        x, y = places[i] + _label_shift(places[near] - places[i])
        ax.text(x, y, str(label), ha="center", va="center", fontsize=size)
    if full:
        ax.plot([], [], "o", color="black", markeredgecolor=ink, markersize=8, label=f"{meaning} root")
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
    return 0.4 * directions[int(np.argmax(free) if free.any() else np.argmin(nearness.round(6)))]


def _named(form: object, data: type[Diagram]) -> tuple[str, RealForm | Diagram]:
    """The prefix of the title and the real form; a diagram, which has no name, as it is."""
    if isinstance(form, data):
        return "", form
    real_form = RealForm.of_name(form) if isinstance(form, str) else form
    if not isinstance(real_form, RealForm):
        raise InputError(f"expected the name of a real form, a RealForm or a {data.__name__}, got {displayed(form)}")
    return f"{real_form.name}: ", real_form


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


# Plots of root systems and of the weights of irreducible modules, for rank 1, 2 and 3. Coordinates are taken in an
# orthonormal basis of the span of the roots, in which the simple roots are the rows of the Cholesky factor of their
# Gram matrix. So the first simple root points along the first axis, and lengths and angles are those of the root
# system, with (a, a) = 2 for the short roots of each component.

# Least diameter, in points, of a point with its multiplicity in it; smaller points show it by their size only
READABLE = 9.0
WIDTH = 230.0  # Width in points of a picture of the default size, from which diameters follow
LEGEND_ROWS = 6
LARGEST = 1_000_000  # Largest dimension of a module whose weights are drawn; they are a few ten thousand points at most
VIEW = (22.0, 72.0)  # Elevation and azimuth, in degrees, from which few roots of A3, B3 and C3 hide one another


def plot_root_system(
    kind: str | RootSystem, ax: Axes | None = None, *, path: str | os.PathLike[str] | None = None
) -> Axes:
    """Draw the roots of a root system of rank 1, 2 or 3, with the simple roots named.

    Parameters
    ----------
    kind : str or RootSystem
        'A2', 'G2', 'B3', 'A1 + A1', or the result of ``algebra.root_system()``.
    ax : matplotlib.axes.Axes, optional
        Axes to draw in, for rank 3 with ``projection="3d"``; by default new ones.
    path : path, optional
        A file to write the picture to.

    Returns
    -------
    matplotlib.axes.Axes
        With one colour for each length of roots. Negative roots are pale, and gray edges join nearest roots of one
        length.

    Examples
    --------
    >>> import liehom as lh
    >>> ax = lh.plotting.plot_root_system("G2")  # doctest: +SKIP
    >>> ax = lh.plotting.plot_root_system("B3")  # doctest: +SKIP
    """
    system = _of_small_rank(kind, "a root system")
    simple = simple_root_coordinates(system)
    norms = np.array([system.norm(root) for root in system.roots])
    with style_unless(ax):
        ax = axes_of_dimension(ax, system.rank)
        colours = current_colours()
        for k, norm in enumerate(sorted(set(norms.tolist()))):
            roots = _padded(system.root_matrix()[norms == norm] @ simple)
            _plot(ax, _nearest(roots), color=GREY, linewidth=0.6, zorder=1)
            positive, negative = roots[: len(roots) // 2], roots[len(roots) // 2 :]
            for part, alpha in ((negative, 0.4), (positive, 1.0)):
                rays = _segments(0 * part, part)
                _plot(ax, rays, color=colours[k], alpha=alpha, linewidth=1.8, zorder=2)
                text = f"{len(roots)} roots with $(\\alpha, \\alpha) = {norm}$" if part is positive else None
                _plot(ax, part, marker=MARKERS[k], linestyle="", color=colours[k], alpha=alpha, label=text, zorder=3)
        gap = 0.16 * float(np.sqrt(norms.max()))
        for node, root in enumerate(_padded(simple)):
            _write(ax, _beside(root, gap), f"$\\alpha_{node + 1}$")
        _finish(ax, _padded(system.root_matrix() @ simple), f"{system.type}: {system.number_of_roots} roots")
    return written(ax, path)


def plot_weights(
    kind: str | RootSystem,
    highest_weight: Sequence[int],
    ax: Axes | None = None,
    *,
    path: str | os.PathLike[str] | None = None,
) -> Axes:
    """Draw the weights of an irreducible module with their multiplicities, for rank 1, 2 or 3.

    Parameters
    ----------
    kind : str or RootSystem
        'A2', 'G2', 'B3', 'A1 + A1', or the result of ``algebra.root_system()``.
    highest_weight : sequence of int
        Dominant, in fundamental coordinates, in Bourbaki's numbering.
    ax : matplotlib.axes.Axes, optional
        Axes to draw in, for rank 3 with ``projection="3d"``; by default new ones.
    path : path, optional
        A file to write the picture to.

    Returns
    -------
    matplotlib.axes.Axes
        Gray edges join weights that differ by a short root. Multiplicities above 1 are written into their points; in
        diagrams of many weights the points grow with their multiplicity instead.

    Examples
    --------
    The adjoint representation of sl(3), and the 27 of so(7):

    >>> import liehom as lh
    >>> ax = lh.plotting.plot_weights("A2", (1, 1))  # doctest: +SKIP
    >>> ax = lh.plotting.plot_weights("B3", (2, 0, 0))  # doctest: +SKIP
    """
    system = _of_small_rank(kind, "a weight diagram")
    dimension = weyl_dimension(system, highest_weight)
    if dimension > LARGEST:
        raise InputError(f"a picture shows the weights of a module of dimension at most {LARGEST}, found {dimension}")
    weights = character(system, highest_weight)
    cartan = np.array(system.cartan, dtype=float)
    points = _padded(np.array(list(weights), dtype=float) @ np.linalg.inv(cartan) @ simple_root_coordinates(system))
    times = np.array(list(weights.values()))
    with style_unless(ax):
        ax = axes_of_dimension(ax, system.rank)
        index = {weight: i for i, weight in enumerate(weights)}
        for root in np.array([a for a in system.positive_roots if system.norm(a) == 2]) @ np.array(system.cartan):
            lower = [
                (i, index.get(tuple(x - y for x, y in zip(weight, root.tolist(), strict=True))))
                for weight, i in index.items()
            ]
            ends = np.array([pair for pair in lower if pair[1] is not None], dtype=int).reshape(-1, 2)
            _plot(ax, _segments(points[ends[:, 0]], points[ends[:, 1]]), color=GREY, linewidth=0.6, zorder=1)
        _draw_multiplicities(ax, points, times)
        top = tuple(int(x) for x in highest_weight)
        _write(ax, _beside(points[0], 0.14 * max(abs(points).max(), 0.5)), r"$\lambda$")
        where = f"$\\lambda$ = {top if len(top) > 1 else top[0]}"
        _finish(ax, points, f"{system.type}, {where}: dimension {times.sum()}, {len(points)} weights")
    return written(ax, path)


def _draw_multiplicities(ax: Axes, points: Array, times: IntegerArray) -> None:
    """A point for each weight, with its multiplicity in it if there is room between nearest weights."""
    colours = current_colours()
    room = min(13.0, 0.85 * WIDTH * np.sqrt(2) / (2.3 * abs(points).max() + 0.2))
    values = np.unique(times)
    named = values[np.unique(np.linspace(0, len(values) - 1, LEGEND_ROWS).astype(int))]
    for k in values.tolist():
        size = (6.0 if k == 1 else room) if room >= READABLE else room * (0.3 + 0.7 * k / times.max())
        options = {"marker": "o", "linestyle": "", "color": colours[min(k, 2) - 1], "markersize": size, "zorder": 3}
        _plot(ax, points[times == k], label=f"multiplicity {k}" if k in named else None, **options)
        for point in points[times == k] if room >= READABLE and k > 1 else ():
            _write(ax, point, str(k), color=paper_colour(), fontsize=8, zorder=10)


def simple_root_coordinates(system: RootSystem) -> Array:
    """The simple roots as rows of a lower triangular matrix (r, r): coordinates in an orthonormal basis."""
    gram = np.array(system.cartan, dtype=float) * np.array(system.norms, dtype=float) / 2
    return np.asarray(np.linalg.cholesky(gram), dtype=float)


def _of_small_rank(kind: str | RootSystem, what: str) -> RootSystem:
    system = kind if isinstance(kind, RootSystem) else root_system(kind)
    if not 1 <= system.rank <= 3:
        raise InputError(
            f"{what} is drawn for rank 1, 2 or 3; {system.type} has rank {system.rank}: plot_dynkin draws every rank"
        )
    return system


def _padded(points: Array) -> Array:
    """Points (k, 1) on a line as points of the plane; others unchanged."""
    return np.hstack([points, np.zeros_like(points)]) if points.shape[1] == 1 else points


def _segments(starts: Array, ends: Array) -> Array:
    """Segments as one curve with gaps, shape (3 k, d)."""
    gaps = np.full_like(starts, np.nan, dtype=float)
    return np.stack([starts, ends, gaps], axis=1).reshape(-1, starts.shape[1])


def _nearest(points: Array) -> Array:
    """Segments between the pairs of points at the smallest distance."""
    distance = np.linalg.norm(points[:, None] - points, axis=2)
    least = distance[distance > 0].min()
    pairs = np.argwhere(np.triu(abs(distance - least) < 1e-9))
    return _segments(points[pairs[:, 0]], points[pairs[:, 1]])


def _plot(ax: AnyAxes, points: Array, **options: object) -> None:
    ax.plot(*points.T, **options)


def _write(ax: AnyAxes, point: Array, text: str, **options: object) -> None:
    ax.text(*point, text, ha="center", va="center", **options)


def _beside(point: Array, gap: float) -> Array:
    """Place for the name of a point: a little further from 0."""
    size = float(np.linalg.norm(point))
    return point * (1 + gap / size) if size else point + gap


def _finish(ax: AnyAxes, points: Array, title: str) -> None:
    """Equal scales around the points, no frame, title and legend."""
    size = 1.15 * max(float(abs(points).max()), 0.5) + 0.1
    low = size if points[:, 1].any() else 0.2 * size  # less for points on a line
    limits = {"xlim": (-size, size), "ylim": (-low, low)}
    if ax.name == "3d":
        ax.view_init(elev=VIEW[0], azim=VIEW[1])
        ax.set(zlim=(-size, size), **limits)
        ax.set_box_aspect((1, 1, 1), zoom=1.5)
    else:
        ax.set(aspect="equal", **limits)
    ax.set_axis_off()
    ax.set_title(title, loc="left")
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, 0.04), ncols=2, fontsize=8)
