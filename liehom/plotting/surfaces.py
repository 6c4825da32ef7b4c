"""Quadrics in space as line drawings, and curves on them whose hidden parts are faint.

A quadric m^T Q m = c is drawn by circles and meridians, its outline, and the edges of the part that is drawn. A point
m of it is hidden if the ray from m towards the eye e meets the surface again. On the ray m + s e the equation is
s (2 <e, Q m> + s <e, Q e>) = 0, so that the other point has s = -2 <e, Q m> / <e, Q e>. All views are orthographic.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias, final

import numpy as np

from liehom.errors import InputError
from liehom.plotting.canvas import GREY, check_straight, matplotlib_module, new_figure, pale_colour
from liehom.typing import Array, BooleanArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

AnyAxes: TypeAlias = Any
"""Axes of matplotlib in the plane or in space; those in space have no types."""

ELEVATION, AZIMUTH = 22.0, 35.0
FAINT = 0.3
"""Opacity of hidden curves."""
ROUND_OFF = 1e-9
"""Eigenvalues and levels count as 0 up to this fraction of the largest."""
GRAZING = 2e-3
"""Distance of a second point of the surface, relative to its size, up to which a point is on the outline."""
HEIGHTS, ANGLES = 121, 241
"""Points of the grid on the surface."""


def space_axes(ax: Axes | None, size: float = 5.6) -> AnyAxes:
    """Axes for a drawing of a surface: new ones in space, or those of the caller, in space or in the plane.

    Raises
    ------
    InputError
        If the given axes have polar coordinates.
    """
    axes: AnyAxes = ax
    if ax is None:
        axes = new_figure(size, size).add_subplot(projection="3d", elev=ELEVATION, azim=AZIMUTH)
    check_straight(axes)
    if axes.name == "3d":
        axes.set_proj_type("ortho")
        axes.computed_zorder = False
    axes.set_axis_off()
    return axes


@final
class Scene:
    """Axes on which things in space are drawn, and the direction from which they are seen.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        In space, or in the plane. In the plane points are projected.
    elevation, azimuth : float
        The direction of the view in degrees, for axes in the plane; axes in space have their own.

    Attributes
    ----------
    eye : array of shape (3,)
        Unit vector towards the viewer.
    screen : array of shape (2, 3)
        Unit vectors to the right and up, as rows.
    """

    def __init__(self, axes: AnyAxes, elevation: float = ELEVATION, azimuth: float = AZIMUTH) -> None:
        self.axes = axes
        self.solid: bool = axes.name == "3d"
        elevation, azimuth = np.radians((axes.elev, axes.azim) if self.solid else (elevation, azimuth))
        level = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        self.eye: Array = np.cos(elevation) * level + np.array([0.0, 0.0, np.sin(elevation)])
        right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
        self.screen: Array = np.stack([right, np.cross(self.eye, right)])

    def plot(self, points: Array, *marks: str, **look: object) -> None:
        """Draw a curve through points (3, k), or (2, k) in the plane."""
        self.axes.plot(*(points if self.solid or len(points) == 2 else self.screen @ points), *marks, **look)

    def move(self, line: AnyAxes, points: Array) -> None:
        """Give a line that `plot` has drawn other points."""
        if self.solid:
            line.set_data_3d(*points)
        else:
            line.set_data(*(points if len(points) == 2 else self.screen @ points))

    def text(self, point: Array, text: str, **look: object) -> None:
        """Write a word at a point."""
        self.axes.text(*(point if self.solid else self.screen @ point), text, ha="center", va="center", **look)

    def curve(self, surface: Quadric | None, points: Array, mark: str = "-", **look: object) -> None:
        """Draw a curve, "-", or markers: the visible parts, and faintly what is hidden by the surface."""
        if surface is None:
            self.plot(points, mark, **look)
            return
        hidden = surface.hidden(points, self.eye)
        if hidden.any():
            self.plot(only(points, hidden), mark, **{**look, "alpha": FAINT, "zorder": 1})
        self.plot(only(points, ~hidden), mark, **{"zorder": 3, **look})

    def mark(self, surface: Quadric | None, point: Array, marker: str, **look: object) -> None:
        """Mark a point, faintly if it is hidden by the surface."""
        hidden = surface is not None and bool(surface.hidden(point[:, None], self.eye)[0])
        self.plot(point[:, None], marker, **look, **({"alpha": FAINT, "zorder": 1.2} if hidden else {"zorder": 5}))

    def frame(self, reach: Array | float, names: Sequence[str], *, whole: bool = False) -> None:
        """The ends of the coordinate axes outside of a surface with the given reach along them, and their names.

        With `whole` the axes are drawn from 0 on.
        """
        reaches = np.broadcast_to(reach, 3)
        gap = 0.15 * float(np.mean(reaches))
        for far, direction, name in zip(reaches, np.eye(3), names, strict=True):
            if whole:
                self.plot(np.outer(direction, np.array([0.0, far])), color=pale_colour(), linewidth=1.0, zorder=0.4)
            self.plot(np.outer(direction, np.array([far, far + gap])), color=GREY, linewidth=1.0, zorder=4)
            self.text((far + 1.7 * gap) * direction, name, zorder=6)

    def limit(self, half: Array | float, middle: Array | float = 0.0, zoom: float = 1.25) -> None:
        """Show the box of this half size about its middle, in equal scales; `zoom` cuts off its corners."""
        halves, center = np.broadcast_to(half, 3), np.broadcast_to(middle, 3)
        if self.solid:
            for name, c, h in zip("xyz", center, halves, strict=True):
                getattr(self.axes, f"set_{name}lim")(c - h, c + h)
            self.axes.set_box_aspect(halves / halves.max(), zoom=zoom)
            return
        corners = self.screen @ (center[:, None] + 1.1 / zoom * halves[:, None] * _CORNERS)
        self.axes.set(xlim=(corners[0].min(), corners[0].max()), ylim=(corners[1].min(), corners[1].max()))
        self.axes.set_aspect("equal")


_CORNERS = np.array(np.meshgrid([-1.0, 1.0], [-1.0, 1.0], [-1.0, 1.0])).reshape(3, -1)


def only(points: Array, kept: BooleanArray) -> Array:
    """Points (3, k) that are kept, and the point before each part, so that the parts of a curve meet; NaN elsewhere."""
    near = kept | np.r_[kept[1:], False]
    return np.where(near, points, np.nan)


@final
class Quadric:
    """The surface m^T Q m = c in space, as far from its middle as given points.

    Parameters
    ----------
    form : array of shape (3, 3)
        Symmetric. Admissible are ellipsoids, hyperboloids, cones and elliptic cylinders.
    level : float
        c.
    points : array of shape (3, k), optional
        Points of the surface. Only the sheets on which they are, and parts of it a little further than they are, are
        drawn.

    Attributes
    ----------
    kind : str
        'sphere', 'ellipsoid', 'hyperboloid of one sheet', ....

    Raises
    ------
    InputError
        If m^T Q m = c is not a surface of one of these kinds.

    Examples
    --------
    >>> Quadric(np.diag([1.0, 1.0, -1.0]), -1.0).kind
    'hyperboloid of two sheets'
    """

    def __init__(self, form: Array, level: float, points: Array | None = None) -> None:
        sizes, axes = np.linalg.eigh(form)
        largest = float(np.abs(sizes).max())
        sizes = np.where(np.abs(sizes) <= ROUND_OFF * largest, 0.0, sizes)
        extent = 1.0 if points is None else float((points**2).sum(axis=0).max())
        if abs(level) <= ROUND_OFF * largest * extent:
            level = 0.0
        scaled = sizes / level if level else sizes * (1 if (sizes > 0).sum() >= (sizes < 0).sum() else -1)
        count = (int((scaled > 0).sum()), int((scaled < 0).sum()), int(level != 0))
        if count not in _KINDS:
            found = f"eigenvalues {sizes.tolist()} and c = {level:.6g}"
            raise InputError(
                f"m^T Q m = c with {found} is not drawn: expected an ellipsoid, a hyperboloid, a cone or a cylinder"
            )
        self.kind: str = _KINDS[count]
        self.form, self.level = form, level
        odd = int(np.argmax(scaled)) if count[0] == 1 else int(np.argmin(scaled))  # the axis unlike the others
        if count[0] == 3:
            odd = int(np.argmax(np.abs(axes[2])))
            self.kind = "sphere" if np.ptp(sizes) <= ROUND_OFF * largest else self.kind
        order = [*(i for i in range(3) if i != odd), odd]
        self._axes = axes[:, order] * np.sign(axes[np.abs(axes).argmax(axis=0), range(3)])[order]
        self._half = 1 / np.sqrt(np.where(scaled == 0, 1.0, np.abs(scaled)))[order]
        along = np.array([0.0]) if points is None else self._axes[:, 2] @ points
        least = {"cone": 0.0, "cylinder": self._half[0]}.get(self.kind, 1.6 * self._half[2])
        if self.kind == "hyperboloid of one sheet":
            least = self._half[2]
        self._height = max(1.15 * float(np.abs(along).max()), least) or 1.0
        signs = (1, -1) if points is None else tuple(sign for sign in (1, -1) if bool((sign * along > 0).any()))
        self._sheets: tuple[int, ...] = (signs or (1, -1)) if self.kind in _SHEETS else (1,)

    @property
    def closed(self) -> bool:
        """Whether the surface is bounded, so that all of it is drawn."""
        return self.kind in ("sphere", "ellipsoid")

    @property
    def parameters(self) -> tuple[Array, Array]:
        """Heights u and angles v of a fine grid, in the parameters of `at`."""
        low, high = self._span()
        return np.linspace(low, high, HEIGHTS), np.linspace(0, 2 * np.pi, ANGLES)

    def _span(self) -> tuple[float, float]:
        high = self._height / self._half[2]
        spans = {
            "hyperboloid of one sheet": (-np.arcsinh(high), np.arcsinh(high)),
            "hyperboloid of two sheets": (0.0, np.arccosh(max(high, 1.0))),
            "cone": (0.0, high),
            "cylinder": (-high, high),
        }
        low, top = spans.get(self.kind, (0.0, np.pi))
        return float(low), float(top)

    def at(self, u: Array, v: Array, sheet: int = 1) -> Array:
        """Points (3, ...) with the parameters u along the axis and v around it."""
        shapes: dict[str, tuple[Callable[[Array], Array], Callable[[Array], Array]]] = {
            "hyperboloid of one sheet": (np.cosh, np.sinh),
            "hyperboloid of two sheets": (np.sinh, np.cosh),
            "cone": (np.abs, np.abs),
            "cylinder": (np.ones_like, np.positive),
        }
        radius, along = shapes.get(self.kind, (np.sin, np.cos))
        local = np.stack([radius(u) * np.cos(v), radius(u) * np.sin(v), sheet * along(u)])
        return np.tensordot(self._axes * self._half, local, axes=1)

    def hidden(self, points: Array, eye: Array) -> BooleanArray:
        """Whether points (3, k) of the surface are behind another part of it that is drawn."""
        slope, bend = 2 * (eye @ self.form @ points), float(eye @ self.form @ eye)
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = -slope / bend
            other = self._axes[:, 2] @ (points + distance * eye[:, None])
        size = float(np.nanmax(np.abs(points), initial=0.0))
        found: BooleanArray = np.isfinite(distance) & (distance > GRAZING * size)
        if not self.closed:
            found &= np.abs(other) <= self._height * (1 + ROUND_OFF)
        if self.kind in _SHEETS:
            found &= np.isin(np.sign(other), self._sheets)
        return found

    def contours(self, values: Callable[[Array], Array], levels: Sequence[float]) -> Iterator[tuple[float, Array]]:
        """The curves on which a function of points (..., 3) has given values, as pairs (value, points (3, k))."""
        u, v = self.parameters
        heights, angles = np.meshgrid(u, v, indexing="ij")
        for sheet in self._sheets:
            found = values(np.moveaxis(self.at(heights, angles, sheet), 0, -1))
            inside = sorted({x for x in levels if found.min() < x < found.max()})
            if not inside:
                continue
            drawn = matplotlib_module("figure").Figure().add_subplot().contour(v, u, found, levels=inside)
            for level, lines in zip(inside, drawn.allsegs, strict=True):
                for line in lines:
                    yield level, self.at(line[:, 1], line[:, 0], sheet)

    def draw(self, scene: Scene) -> None:
        """Draw the outline, the edges, and the visible parts of circles and meridians."""
        u, v = self.parameters
        step = (HEIGHTS - 1) // 12
        rings = u[step:-1:step]
        for sheet in self._sheets:
            lines = [self.at(np.full_like(v, x), v, sheet) for x in rings]
            lines += [self.at(u, np.full_like(u, x), sheet) for x in v[: -1 : (ANGLES - 1) // 12]]
            for line in lines:
                scene.plot(only(line, ~self.hidden(line, scene.eye)), color=pale_colour(), linewidth=0.7, zorder=0.5)
            edges = () if self.closed else (u[-1],) if self.kind in _SHEETS else (u[0], u[-1])
            for line in (self.at(np.full_like(v, x), v, sheet) for x in edges):
                scene.plot(only(line, ~self.hidden(line, scene.eye)), color=GREY, linewidth=0.9, zorder=0.6)
        normal = self.form @ scene.eye
        for _, line in self.contours(lambda m: m @ normal, [0.0]):
            scene.plot(only(line, ~self.hidden(line, scene.eye)), color=GREY, linewidth=0.9, zorder=0.6)

    def bounds(self) -> tuple[Array, Array]:
        """The least and the largest of each coordinate on the part that is drawn, shapes (3,)."""
        u, v = self.parameters
        heights, angles = np.meshgrid(u, v)
        points = np.stack([self.at(heights, angles, sheet) for sheet in self._sheets], axis=-1)
        return points.min(axis=(1, 2, 3)), points.max(axis=(1, 2, 3))


_KINDS = {
    (3, 0, 1): "ellipsoid",
    (2, 1, 1): "hyperboloid of one sheet",
    (1, 2, 1): "hyperboloid of two sheets",
    (2, 1, 0): "cone",
    (2, 0, 1): "cylinder",
}
"""By the numbers of positive and negative eigenvalues of Q / c, and whether c is not 0."""
_SHEETS = ("hyperboloid of two sheets", "cone")


def sphere(radius: float) -> Quadric:
    """The sphere of this radius about 0."""
    return Quadric(np.eye(3), radius**2, radius * np.eye(3))
