"""Spheres and other quadrics with curves on them, and phase portraits."""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, final

import numpy as np

from liehom.base.errors import InputError, displayed
from liehom.base.typing import Array, BooleanArray
from liehom.flow.action.field import GeneratorField
from liehom.flow.engines.arguments import positive
from liehom.flow.propagation.integration import integrate
from liehom.flow.steps.first_integral import FirstIntegral, IntegralSource
from liehom.plotting.canvas import (
    GREY,
    check_straight,
    current_colours,
    matplotlib_module,
    new_figure,
    pale_colour,
    paper_colour,
    style_unless,
    written,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Quadrics in space as line drawings, and curves on them whose hidden parts are faint. A quadric m^T Q m = c is drawn by
# circles and meridians, its outline, and the edges of the part that is drawn. A point m of it is hidden if the ray from
# m towards the eye e meets the surface again. On the ray m + s e the equation is s (2 <e, Q m> + s <e, Q e>) = 0, so
# that the other point has s = -2 <e, Q m> / <e, Q e>. All views are orthographic.

AnyAxes: TypeAlias = Any  # Axes of matplotlib in the plane or in space; those in space have no types

ELEVATION, AZIMUTH = 22.0, 35.0
FAINT = 0.3  # Opacity of hidden curves
ROUND_OFF = 1e-9  # Eigenvalues and levels count as 0 up to this fraction of the largest
GRAZING = 2e-3  # Distance of a second point of the surface, relative to its size, up to which a point is on the outline
HEIGHTS, ANGLES = 121, 241  # Points of the grid on the surface


def space_axes(ax: Axes | None, size: float = 5.6) -> AnyAxes:
    """Axes for a drawing of a surface: new ones in space, or those of the caller, in space or in the plane."""
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
    """Axes on which things in space are drawn; `eye` points to the viewer, the rows of `screen` to the right and up."""

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
        """The ends of the coordinate axes, outside of a surface of this reach or `whole` from 0 on, and their names."""
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
    return np.where(kept | np.r_[kept[1:], False], points, np.nan)


@final
class Quadric:
    """The surface m^T Q m = c in space, as far from its middle as given points."""

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
            data = f"eigenvalues {sizes.tolist()} and c = {level:.6g}"
            raise InputError(
                f"m^T Q m = c with {data} is not drawn: expected an ellipsoid, a hyperboloid, a cone or a cylinder"
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
        least = {"cone": 0.0, "cylinder": self._half[0], "hyperboloid of one sheet": self._half[2]}.get(
            self.kind, 1.6 * self._half[2]
        )
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
        behind: BooleanArray = np.isfinite(distance) & (distance > GRAZING * size)
        if not self.closed:
            behind &= np.abs(other) <= self._height * (1 + ROUND_OFF)
        if self.kind in _SHEETS:
            behind &= np.isin(np.sign(other), self._sheets)
        return behind

    def contours(self, values: Callable[[Array], Array], levels: Sequence[float]) -> Iterator[tuple[float, Array]]:
        """The curves on which a function of points (..., 3) has given values, as pairs (value, points (3, k))."""
        u, v = self.parameters
        heights, angles = np.meshgrid(u, v, indexing="ij")
        for sheet in self._sheets:
            heights_of = values(np.moveaxis(self.at(heights, angles, sheet), 0, -1))
            inside = sorted({x for x in levels if heights_of.min() < x < heights_of.max()})
            if not inside:
                continue
            drawn = matplotlib_module("figure").Figure().add_subplot().contour(v, u, heights_of, levels=inside)
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


# By the numbers of positive and negative eigenvalues of Q / c, and whether c is not 0
_KINDS = {
    (3, 0, 1): "ellipsoid",
    (2, 1, 1): "hyperboloid of one sheet",
    (1, 2, 1): "hyperboloid of two sheets",
    (2, 1, 0): "cone",
    (2, 0, 1): "cylinder",
}
_SHEETS = ("hyperboloid of two sheets", "cone")


def sphere(radius: float) -> Quadric:
    """The sphere of this radius about 0."""
    return Quadric(np.eye(3), radius**2, radius * np.eye(3))


# Phase portraits on spheres: level sets of an energy or trajectories, equilibria by their type, and separatrices.

STARTS = 200  # Points from which equilibria are searched
ITERATIONS = 30
DIFFERENCE = 1e-4  # Step of the central differences of the field, relative to the radius
AT_REST = 1e-9  # Size of the field at an equilibrium, relative to its largest
SAME = 1e-3  # Equilibria closer than this, relative to the radius, count as one
NEAR = 1e-2  # Distance from saddles at which separatrices without an energy begin, relative to the radius
DEGENERATE = 1e-4  # An eigenvalue of the linearization counts as 0 up to this fraction of the other or of the field's
TANGENT = 1e-8  # Largest admissible normal component of a field, relative to the field
CONSERVED = 1e-6  # Largest admissible derivative of an energy along the field, relative to the product of their sizes
# Number of trajectories of a field without an energy, and their typical length in radians
TRAJECTORIES, LENGTH = 60, 1.2
# Marker and number of the color of each type of equilibrium
MARKERS = {
    "center": ("o", 2),
    "saddle": ("X", 1),
    "stable focus": ("v", 3),
    "unstable focus": ("^", 3),
    "stable node": ("s", 4),
    "unstable node": ("D", 4),
    "not isolated": (".", 6),
}


class Equilibrium(NamedTuple):
    """An equilibrium on a sphere; of a saddle the unstable and stable eigenvectors and the smaller rate."""

    point: Array
    kind: str
    directions: tuple[Array, ...] = ()
    rate: float = 0.0


def plot_phase_portrait(
    field: GeneratorField | IntegralSource,
    ax: Axes | None = None,
    *,
    energy: IntegralSource | None = None,
    radius: float = 1.0,
    levels: int = 5,
    path: str | os.PathLike[str] | None = None,
) -> Axes:
    """Draw the phase portrait of a field on a sphere: level sets of its energy, equilibria by type, and separatrices.

    Parameters
    ----------
    field : GeneratorField, callable, str or sympy expression
        A field on space whose orbits are the spheres, or an energy H(m), for which the field is m' = m x grad H(m). H
        is written with numpy functions for m of shape (..., 3), or is an expression in m0, m1, m2.
    ax : matplotlib.axes.Axes, optional
        Axes in space or in the plane; by default new ones in space.
    energy : callable, str or sympy expression, optional
        A first integral of the field. Without it, trajectories from 60 points are drawn instead of level sets.
    radius : float, optional
        Radius of the sphere.
    levels : int, optional
        Number of level sets between two critical values of the energy.
    path : path, optional
        A file to write the picture to.

    Returns
    -------
    matplotlib.axes.Axes

    Notes
    -----
    Equilibria are found by Newton's method from 200 points, so that some may be missed if there are many. Their types
    are those of the linearization. Separatrices are the level sets through saddles, or the trajectories from and to
    saddles. Colors tell the regions between critical values apart, and arrows show the direction of the motion. The
    far side of the sphere is faint.

    Examples
    --------
    The energy of a free rigid body with moments of inertia 1, 2 and 3:

    >>> import liehom as lh
    >>> ax = lh.plotting.plot_phase_portrait("m0**2/2 + m1**2/4 + m2**2/6")  # doctest: +SKIP
    """
    if isinstance(levels, bool) or not isinstance(levels, int | np.integer) or levels < 0:
        raise InputError(f"levels is {displayed(levels)}, expected an integer at least 0")
    flow = flow_of(field, energy, radius)
    radius = flow.radius
    with style_unless(ax), np.errstate(all="ignore"):
        points = equilibria(flow)
        scene = Scene(space_axes(ax))
        surface = sphere(radius)
        surface.draw(scene)
        draw = _draw_trajectories if flow.energy is None else _draw_levels
        draw(scene, surface, flow, points, levels)
        _mark(scene, surface, points)
        scene.frame(radius, ("$m_0$", "$m_1$", "$m_2$"))
        scene.limit(radius, zoom=1.15)
    return written(scene.axes, path)


class Flow(NamedTuple):
    """A field on a sphere, and its energy if it has one, as functions of points (..., 3).

    Attributes
    ----------
    vector, energy : callable
    radius, speed : float
        Of the sphere, and the largest size of the field.
    field : GeneratorField, or None
        If there is no energy.
    """

    vector: Callable[[Array], Array]
    energy: Callable[[Array], Array] | None
    radius: float
    speed: float
    field: GeneratorField | None


def flow_of(field: GeneratorField | IntegralSource, energy: IntegralSource | None, radius: float) -> Flow:
    """The arguments of `plot_phase_portrait`, checked."""
    radius = positive("radius", radius)
    if isinstance(field, GeneratorField):
        if field.representation.size != 3 or field.time_dependent:
            size = field.representation.size
            actual = "depends on time" if size == 3 else f"has {size} coordinates"
            raise InputError(f"a phase portrait is drawn for fields on space without time; this one {actual}")
        generator = field
        integral = None if energy is None else FirstIntegral(energy, 3)

        def vector(m: Array) -> Array:
            return np.asarray(generator.vector(m), dtype=float)

    else:
        if energy is not None:
            raise InputError("energy= belongs to a GeneratorField; an energy alone is the first argument")
        integral = known = FirstIntegral(field, 3)

        def vector(m: Array) -> Array:
            return np.cross(m, np.asarray(known.gradient(m)[1], dtype=float)[..., 0, :])

    starts = radius * _starts()
    with np.errstate(all="ignore"):
        vectors = vector(starts)
    if not np.isfinite(vectors).all():
        where = starts[np.argmin(np.isfinite(vectors).all(axis=-1))]
        raise InputError(f"the field is not finite on the sphere, as at the point {where}")
    speed = float(np.linalg.norm(vectors, axis=-1).max())
    if not np.abs((vectors * starts).sum(axis=-1)).max() <= TANGENT * radius * speed:
        raise InputError("the field is not tangent to spheres: phase portraits are drawn on spheres about 0")
    if integral is not None:
        _check_energy(integral, starts, vectors)
    elif speed == 0:
        raise InputError("the field is 0 on the sphere, so that all points are equilibria")
    value = None if integral is None else lambda m: np.asarray(integral(m), dtype=float)[..., 0]
    return Flow(vector, value, float(radius), speed, field if isinstance(field, GeneratorField) else None)


def _check_energy(energy: FirstIntegral, starts: Array, vectors: Array) -> None:
    """Check that an energy is one function, is not constant on the sphere, and is a first integral of the field."""
    count = np.shape(energy(starts))[-1]
    if count != 1:
        raise InputError(f"expected one energy, got {count}: their level sets are drawn in a picture each")
    slopes = np.asarray(energy.gradient(starts)[1], dtype=float)[..., 0, :]
    steepest, speeds = (np.linalg.norm(x, axis=-1).max() for x in (slopes, vectors))
    across = np.linalg.norm(np.cross(starts, slopes), axis=-1).max()
    if across <= TANGENT * np.linalg.norm(starts[0]) * steepest:
        raise InputError("the energy is constant on the sphere, so that it has no level sets there")
    if not np.abs((slopes * vectors).sum(axis=-1)).max() <= CONSERVED * steepest * speeds:
        raise InputError("the energy is not a first integral of the field: it changes along trajectories")


def _starts() -> Array:
    """Points of the unit sphere from which equilibria are searched."""
    return np.concatenate([spread_points(STARTS), np.eye(3), -np.eye(3)])


def spread_points(count: int) -> Array:
    """Points spread evenly over the unit sphere, on a spiral, shape (count, 3)."""
    k = np.arange(count) + 0.5
    height, angle = 1 - 2 * k / count, np.pi * (1 + np.sqrt(5)) * k
    return np.stack([*(np.sqrt(1 - height**2) * f(angle) for f in (np.cos, np.sin)), height], axis=-1)


# -- equilibria ------------------------------------------------------------------------------------------
def equilibria(flow: Flow) -> list[Equilibrium]:
    """The equilibria that Newton's method finds, each once."""
    points = flow.radius * _starts()
    for _ in range(ITERATIONS):
        frames, slopes, values = _linearized(flow, points)
        there = np.isfinite(slopes).all(axis=(1, 2)) & np.isfinite(values).all(axis=1)
        points, frames, slopes, values = (x[there] for x in (points, frames, slopes, values))
        moves = -(np.linalg.pinv(slopes, rcond=1e-8) @ values[..., None])[..., 0]
        sizes = np.linalg.norm(moves, axis=-1, keepdims=True)
        moves *= np.minimum(1.0, 0.3 * flow.radius / np.maximum(sizes, 1e-300))
        points = _moved(flow, points, (frames @ moves[..., None])[..., 0])
    points = points[np.linalg.norm(flow.vector(points), axis=-1) <= AT_REST * flow.speed]
    at_rest: list[Equilibrium] = []
    for point, frame, slope in zip(points, *_linearized(flow, points)[:2], strict=True):
        if all(np.linalg.norm(point - other.point) > SAME * flow.radius for other in at_rest):
            at_rest.append(_typed(flow, point, frame, slope))
    return at_rest


def _moved(flow: Flow, points: Array, moves: Array) -> Array:
    moved = points + moves
    moved *= flow.radius / np.linalg.norm(moved, axis=-1, keepdims=True)
    return moved


def _linearized(flow: Flow, points: Array) -> tuple[Array, Array, Array]:
    """Tangent frames (n, 3, 2) at points, and in them the derivative (n, 2, 2) and the value (n, 2) of the field."""
    first = np.cross(points, np.eye(3)[np.abs(points).argmin(axis=-1)])
    first /= np.linalg.norm(first, axis=-1, keepdims=True)
    frames = np.stack([first, np.cross(points, first) / flow.radius], axis=-1)
    step = DIFFERENCE * flow.radius
    columns = []
    for j in (0, 1):
        ahead, behind = (flow.vector(_moved(flow, points, sign * step * frames[..., j])) for sign in (1, -1))
        columns.append((ahead - behind) / (2 * step))
    across = np.swapaxes(frames, -1, -2)
    return frames, across @ np.stack(columns, axis=-1), (across @ flow.vector(points)[..., None])[..., 0]


def _typed(flow: Flow, point: Array, frame: Array, slope: Array) -> Equilibrium:
    """An equilibrium with its type, by the eigenvalues of the linearization."""
    rates, vectors = np.linalg.eig(slope)
    low, high = sorted(np.abs(rates))
    if low <= DEGENERATE * max(high, flow.speed / flow.radius):
        return Equilibrium(point, "not isolated")
    if abs(rates[0].imag) > DEGENERATE * high:
        growth = rates[0].real / high
        kind = "center" if abs(growth) < DEGENERATE else "unstable focus" if growth > 0 else "stable focus"
        return Equilibrium(point, kind)
    rates, vectors = rates.real, vectors.real
    if rates.prod() > 0:
        return Equilibrium(point, "unstable node" if rates[0] > 0 else "stable node")
    order = np.argsort(-rates)
    return Equilibrium(point, "saddle", tuple(frame @ vectors[:, i] for i in order), float(low))


def _mark(scene: Scene, surface: Quadric, points: Sequence[Equilibrium]) -> None:
    """Mark equilibria by their type, with a legend."""
    colours = current_colours()
    for kind, (marker, number) in MARKERS.items():
        of_kind = [equilibrium.point for equilibrium in points if equilibrium.kind == kind]
        look = {"color": colours[number], "markersize": 4 if marker == "." else 9, "markeredgecolor": paper_colour()}
        for point in of_kind:
            scene.mark(surface, point, marker, **look)
        if of_kind:
            label = f"{kind} ({len(of_kind)})" if kind != "not isolated" else "equilibria, not isolated"
            scene.plot(np.full((3, 1), np.nan), marker, label=label, **look)
    if scene.axes.get_legend_handles_labels()[0]:
        place = ("lower center", (0.5, -0.01)) if scene.solid else ("upper center", (0.5, 0.0))
        legend = scene.axes.legend(loc=place[0], bbox_to_anchor=place[1], ncols=2)
        legend.set_in_layout(not scene.solid)


# -- curves ----------------------------------------------------------------------------------------------
def _draw_levels(scene: Scene, surface: Quadric, flow: Flow, points: Sequence[Equilibrium], count: int) -> None:
    """Level sets of the energy, in one colour for each region between critical values, and those through saddles."""
    energy: Any = flow.energy
    colours = [colour for i, colour in enumerate(current_colours()) if i in (0, 2, 4, 3)]
    sampled = energy(flow.radius * spread_points(40 * STARTS))
    values = [(float(energy(equilibrium.point)), equilibrium.kind) for equilibrium in points]
    low, high = (f([*sampled, *(value for value, _ in values)]) for f in (min, max))
    saddles = distinct([value for value, kind in values if kind == "saddle"], SAME * (high - low))
    inner = distinct([low, high, *(value for value, _ in values)], SAME * (high - low))
    for k, (below, above) in enumerate(itertools.pairwise(inner)):
        bands = between(below, above, below in saddles, above in saddles, count)
        for _, curve in surface.contours(energy, bands):
            scene.curve(surface, curve, color=colours[k % len(colours)], linewidth=1.0)
            _arrow(scene, surface, flow, curve, colours[k % len(colours)])
    for _, curve in surface.contours(energy, saddles):
        _separatrix(scene, surface, curve)


def distinct(values: Sequence[float], tolerance: float) -> list[float]:
    """Values in increasing order, without those that are within the tolerance of the one before."""
    apart: list[float] = []
    for value in sorted(values):
        if not apart or value > apart[-1] + tolerance:
            apart.append(value)
    return apart


def between(low: float, high: float, saddle_below: bool, saddle_above: bool, count: int) -> list[float]:
    """Levels between critical values at about equal distances: quadratic at a center, linear at a saddle."""
    t = (np.arange(count) + 0.5) / count
    if saddle_below == saddle_above:
        shares = t if saddle_below else np.sin(np.pi * t / 2) ** 2
    else:
        shares = t**2 if saddle_above else 1 - t[::-1] ** 2
    return [low + (high - low) * float(share) for share in shares]


def _draw_trajectories(scene: Scene, surface: Quadric, flow: Flow, points: Sequence[Equilibrium], count: int) -> None:
    """Trajectories from points spread over the sphere, and from and to saddles."""
    colour = current_colours()[0]
    starts = flow.radius * spread_points(TRAJECTORIES)
    typical = float(np.median(np.linalg.norm(flow.vector(starts), axis=-1))) or 1.0
    for curve in trajectories(flow, starts, LENGTH * flow.radius / typical):
        scene.curve(surface, curve, color=colour, linewidth=1.0)
        _arrow(scene, surface, flow, curve, colour)
    saddles = [point for point in points if point.kind == "saddle"]
    for i, sign in enumerate((1, -1) if saddles else ()):  # from the saddles, and to them
        ends = [s.point + side * NEAR * flow.radius * s.directions[i] for s in saddles for side in (1, -1)]
        for curve in trajectories(flow, np.array(ends), sign * 9.0 / min(s.rate for s in saddles)):
            _separatrix(scene, surface, curve)


def trajectories(flow: Flow, starts: Array, time: float) -> Iterator[Array]:
    """Curves (3, k) through points (n, 3) of the sphere."""
    field: Any = flow.field
    times = np.linspace(0.0, time, 240)
    yield from integrate(field, (0.0, time), starts, t_eval=times, rtol=1e-5, atol=1e-7).y


def _separatrix(scene: Scene, surface: Quadric, curve: Array) -> None:
    named = any(line.get_label() == "separatrix" for line in scene.axes.lines)
    colour = current_colours()[1]
    scene.curve(surface, curve, color=colour, linewidth=1.8)
    if not named:
        scene.plot(np.full((3, 1), np.nan), color=colour, linewidth=1.8, label="separatrix")


def _arrow(scene: Scene, surface: Quadric, flow: Flow, curve: Array, colour: str) -> None:
    """An arrowhead in the direction of the field, where the curve is nearest to the viewer."""
    point = curve[:, int(np.argmax(scene.eye @ curve))]
    vector = flow.vector(point)
    speed = float(np.linalg.norm(vector))
    short = float(np.ptp(curve, axis=1).max()) < 0.4 * flow.radius
    if short or speed <= SAME * flow.speed or surface.hidden(point[:, None], scene.eye)[0]:
        return
    ahead = 0.045 * flow.radius * vector / speed
    aside = 0.5 * np.cross(point, ahead) / flow.radius
    head = np.stack([point - ahead + aside, point, point - ahead - aside], axis=1)
    scene.plot(head, color=colour, linewidth=1.2, zorder=3.5)
