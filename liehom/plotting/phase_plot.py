"""Phase portraits on spheres: level sets of an energy or trajectories, equilibria by their type, and separatrices."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from liehom.correctors.conserving.first_integral import FirstIntegral, IntegralSource
from liehom.errors import InputError, displayed
from liehom.homogeneous import GeneratorField
from liehom.integrators import integrate
from liehom.integrators.arguments import positive
from liehom.plotting.canvas import current_colours, paper_colour, style_unless
from liehom.plotting.surfaces import Quadric, Scene, space_axes, sphere
from liehom.typing import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

STARTS = 200
"""Points from which equilibria are searched."""
ITERATIONS = 30
DIFFERENCE = 1e-4
"""Step of the central differences of the field, relative to the radius."""
AT_REST = 1e-9
"""Size of the field at an equilibrium, relative to its largest."""
SAME = 1e-3
"""Equilibria closer than this, relative to the radius, count as one."""
NEAR = 1e-2
"""Distance from saddles at which separatrices without an energy begin, relative to the radius."""
DEGENERATE = 1e-4
"""An eigenvalue of the linearization counts as 0 up to this fraction of the other or of the field's."""
TANGENT = 1e-8
"""Largest admissible normal component of a field, relative to the field."""
CONSERVED = 1e-6
"""Largest admissible derivative of an energy along the field, relative to the product of their sizes."""
TRAJECTORIES, LENGTH = 60, 1.2
"""Number of trajectories of a field without an energy, and their typical length in radians."""
MARKERS = {
    "center": ("o", 2),
    "saddle": ("X", 1),
    "stable focus": ("v", 3),
    "unstable focus": ("^", 3),
    "stable node": ("s", 4),
    "unstable node": ("D", 4),
    "not isolated": (".", 6),
}
"""Marker and number of the color of each type of equilibrium."""


class Equilibrium(NamedTuple):
    """An equilibrium on a sphere.

    Attributes
    ----------
    point : array of shape (3,)
    kind : str
        'center', 'saddle', 'stable node', ..., or 'not isolated' if the linearization is singular.
    directions : tuple of array of shape (3,)
        Of a saddle, eigenvectors: the unstable and the stable one.
    rate : float
        Of a saddle, the smaller absolute value of the two eigenvalues.
    """

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

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    InputError
        If matplotlib is not installed, the field is not tangent to spheres in space, depends on time, or is 0 or not
        finite on the sphere, or the energy is constant there or not a first integral of the field.

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
    axes: Axes = scene.axes
    return axes


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
            found = "depends on time" if size == 3 else f"has {size} coordinates"
            raise InputError(f"a phase portrait is drawn for fields on space without time; this one {found}")
        given = field
        integral = None if energy is None else FirstIntegral(energy, 3)

        def vector(m: Array) -> Array:
            return np.asarray(given.vector(m), dtype=float)

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
    found: list[Equilibrium] = []
    for point, frame, slope in zip(points, *_linearized(flow, points)[:2], strict=True):
        if all(np.linalg.norm(point - other.point) > SAME * flow.radius for other in found):
            found.append(_typed(flow, point, frame, slope))
    return found


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
        of_kind = [found.point for found in points if found.kind == kind]
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
    values = [(float(energy(found.point)), found.kind) for found in points]
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
    """Values in increasing order, without those that are within the tolerance of the one before.

    Examples
    --------
    >>> distinct([2.0, 1.0, 1.0 + 1e-12], 1e-6)
    [1.0, 2.0]
    """
    found: list[float] = []
    for value in sorted(values):
        if not found or value > found[-1] + tolerance:
            found.append(value)
    return found


def between(low: float, high: float, saddle_below: bool, saddle_above: bool, count: int) -> list[float]:
    """Levels between two critical values whose curves have about equal distances.

    Next to a center the energy is quadratic in the distance; a saddle is approached linearly.
    """
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
    saddles = [found for found in points if found.kind == "saddle"]
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
