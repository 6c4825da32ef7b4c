"""Pictures as text, so that a change of what a reader sees is a difference of lines: `python -m tests.plotting.looks`.

A block is a figure. Its lines are what is drawn, from the back to the front: color, size, place and text. Lines of one
look are one line, with the box around their points and the mean of the points, in inches for the size of a figure and
in the coordinates of the axes otherwise.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.colors import to_hex
from matplotlib.patches import FancyArrowPatch, Polygon

import liehom as lh
from liehom.plotting.canvas import new_figure, style

FILE = Path(__file__).with_name("looks.txt")
SPIN = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / np.array([1.0, 2.0, 3.0]))


def numbers(values: Any) -> str:
    """Numbers with four digits after the point, or with four digits if they are small."""
    flat = np.ravel(np.asarray(values, dtype=float))
    return " ".join(f"{x:.4g}" if 1e-9 < abs(x) < 1e-2 else f"{round(x, 4) + 0.0:g}" for x in flat)


def spread(points: Any) -> str:
    """The number of points (k, d), and the least, the largest and the mean of each coordinate."""
    points = np.asarray(points, dtype=float)
    seen = points[np.isfinite(points).all(axis=1)]
    if len(seen) <= 3:
        return f"at {numbers(seen)}" if len(seen) else "nowhere"
    rows = (seen.min(axis=0), seen.max(axis=0), seen.mean(axis=0))
    return f"{len(seen)} points " + " | ".join(map(numbers, rows))


def color(value: Any) -> str:
    rows = np.atleast_2d(np.asarray(value, dtype=float)) if not isinstance(value, str) else [value]
    return " ".join(dict.fromkeys("none" if str(row) == "none" else to_hex(row, keep_alpha=True) for row in rows))


def of_line(line: Any) -> tuple[str, Any]:
    data = line.get_data_3d() if hasattr(line, "get_data_3d") else line.get_data()
    label = line.get_label()
    parts = [
        f"{line.get_zorder():g} line {to_hex(line.get_color())} {line.get_linestyle()} {line.get_linewidth():g}",
        f"marker {line.get_marker()} {line.get_markersize():g} {color(line.get_markerfacecolor())}",
        f"alpha {line.get_alpha()}" if line.get_alpha() is not None else "",
        f"{label!r}" if not label.startswith("_") else "",
        f"marked {line.get_markevery()}" if line.get_markevery() is not None else "",
    ]
    return ", ".join(filter(None, parts)), np.array(data, dtype=float).T


def of_text(text: Any) -> str:
    place = text.get_position_3d() if hasattr(text, "get_position_3d") else text.get_position()
    line = f"{text.get_zorder():g} text {text.get_text()!r} {to_hex(text.get_color())} {text.get_fontsize():g} "
    line += f"{text.get_ha()} {text.get_va()} at {numbers(place)}"
    if (arrow := getattr(text, "arrow_patch", None)) is not None:
        options = {key: x for key, x in text.arrowprops.items() if not key.startswith("patch")}
        line += f" arrow to {numbers(text.xy)} {options} {color(arrow.get_edgecolor())}"
    elif hasattr(text, "xyann"):
        line += f" {text.anncoords} from {numbers(text.xy)}"
    return line


def of_patch(patch: Any) -> str:
    look = f"{patch.get_zorder():g} {type(patch).__name__} {color(patch.get_facecolor())} {patch.get_linewidth():g}"
    box = (
        patch.get_path().vertices
        if isinstance(patch, Polygon)
        else patch.get_patch_transform().transform([(0, 0), (1, 1)])
    )
    return f"{look} {color(patch.get_edgecolor())} {numbers(box)}"


def of_collection(collection: Any) -> str:
    look = f"{collection.get_zorder():g} {type(collection).__name__} {color(collection.get_facecolor())}"
    look += f" edge {color(collection.get_edgecolor())} {numbers(np.unique(collection.get_linewidth()))}"
    if (array := collection.get_array()) is not None:
        look += (
            f" {collection.get_cmap().name} {numbers(collection.get_clim())} values {spread(np.ravel(array)[:, None])}"
        )
    if hasattr(collection, "get_sizes") and len(collection.get_offsets()):
        look += f" sizes {numbers(np.unique(np.round(collection.get_sizes(), 2)))} {spread(collection.get_offsets())}"
    if type(collection).__name__ == "PatchCollection":
        look += " " + spread(np.concatenate([path.vertices[[0, 2]] for path in collection.get_paths()]))
    if hasattr(collection, "_vec"):
        look += " " + spread(np.asarray(collection._vec)[:3].T)
    return look


def of_legend(legend: Any) -> list[str]:
    if legend is None:
        return []
    frame = legend.axes.transAxes if legend.axes else legend.figure.transFigure
    box = legend.get_bbox_to_anchor().transformed(frame.inverted())
    line = f"legend {legend._loc_real} {legend._ncols} columns {legend.get_texts()[0].get_fontsize():g} "
    line += f"{legend.handlelength:g} {legend.borderaxespad:g} {legend.get_in_layout()} from {numbers(box.extents)}"
    return [line, *(f"    {text.get_text()!r}" for text in legend.get_texts())]


def of_axis(axis: Any) -> str:
    shown = [tick for tick in axis.get_major_ticks() if tick.label1.get_text() or tick.label2.get_text()]
    words = dict.fromkeys(tick.label1.get_text() or tick.label2.get_text() for tick in shown)
    line = f"{axis.axis_name} {axis.get_label_text()!r} ticks {' '.join(words)} "
    if minor := [text.get_text() for text in axis.get_minorticklabels() if text.get_text()]:
        line += f"and {' '.join(minor)} "
    for tick in shown[:1]:
        label, other = tick.label1, tick.label2
        line += f"turned {label.get_rotation():g} size {label.get_fontsize():.4g} length {tick._size:g} "
        line += f"shown {label.get_visible()} {other.get_visible()} grid {tick.gridline.get_visible()}"
    return line


def described(axes: Any) -> list[str]:
    """What the figure of these axes shows."""
    figure = axes.figure.figure
    figure.draw_without_rendering()
    lines = [f"figure {numbers(figure.get_size_inches())} {color(figure.get_facecolor())}"]
    for legend in figure.legends:
        lines += of_legend(legend)
    for ax in figure.axes:
        window = [*ax.get_xlim(), *ax.get_ylim(), *(ax.get_zlim() if ax.name == "3d" else ())]
        on = getattr(ax, "_axis3don", ax.axison)
        lines.append(
            f"axes {ax.name} {ax.get_xscale()} {ax.get_yscale()} aspect {ax.get_aspect()} {ax.get_adjustable()} "
            f"anchor {ax.get_anchor()} {'on' if on else 'off'} window {numbers(window)}"
        )
        if ax.name == "3d":
            lines.append(
                f"view {ax.elev:g} {ax.azim:g} {ax._focal_length} box {numbers(ax._box_aspect)} {ax.computed_zorder}"
            )
        lines += [f"title {where} {ax.get_title(where)!r}" for where in ("left", "center") if ax.get_title(where)]
        if on:
            lines += [f"panes {color(ax.xaxis.pane.get_facecolor())}"] if ax.name == "3d" else []
            lines += [of_axis(axis) for axis in ax._axis_map.values()]
            lines.append(f"spines {' '.join(sorted(name for name in ax.spines if ax.spines[name].get_visible()))}")
        things: list[str] = []
        looks: dict[str, list[Any]] = {}
        for line in ax.lines:
            look, points = of_line(line)
            looks.setdefault(look, []).append(points)
        things += [f"{look}, {len(parts)} of {spread(np.concatenate(parts))}" for look, parts in looks.items()]
        things += [of_text(text) for text in ax.texts if text.get_text() or hasattr(text, "arrow_patch")]
        things += [of_patch(patch) for patch in ax.patches if not isinstance(patch, FancyArrowPatch)]
        things += [of_collection(collection) for collection in ax.collections]
        lines += sorted(things, key=lambda thing: float(thing.split()[0]))
        lines += of_legend(ax.get_legend())
    return lines


def body(*starts: Any, **options: Any) -> lh.Solution:
    """Free rigid bodies from points on the unit sphere."""
    return lh.integrate(SPIN, (0, 6), np.squeeze(np.array(starts)), dt=0.25, engine="numpy", **options)


def turning(size: int, *lead: int, **options: Any) -> lh.Solution:
    """Rotations of R^n, of which `lead` trajectories start from multiples of one point."""
    rho = lh.defining(lh.so(size))
    start = np.linspace(1.0, 2.0, int(np.prod(lead))).reshape(*lead, 1) * np.linspace(0.2, 0.9, size)
    field = lh.GeneratorField(rho, np.linspace(-1.0, 2.0, rho.algebra.dimension))
    return lh.integrate(field, (1, 3), start, dt=0.125, engine="numpy", **options)


def boosted(*starts: Any) -> lh.Solution:
    """Trajectories on hyperboloids."""
    return lh.integrate(BOOST, (0, 2), np.squeeze(np.array(starts)), dt=0.25, engine="numpy")


def convergence(order: float, **changes: Any) -> Any:
    """Errors that are powers of the step size."""
    from liehom.flow.convergence.orders import ConvergenceTable

    sizes = (0.2, 0.1, 0.05, 0.025)
    errors = [tuple(c * h**p for h in sizes) for c, p in ((1e-2, order), (1e-1, max(order - 1, 1)))]
    options = {"trajectories": 1, "floors": (1e-14,) * 4} | changes
    return ConvergenceTable(
        f"Method({order})", "exp", "corrected", 2, (0.0, 1.5), options["trajectories"], "float64", sizes, *errors,
        options["floors"], 1e-15, ("",) * 4,
    )  # fmt: skip


def precision(**changes: Any) -> Any:
    """Runs of two methods, one of them adaptive as well and with a run that failed."""
    from liehom.flow.convergence.costs import WorkPrecisionRow, WorkPrecisionTable

    rows = []
    for name, power, tolerances in (("first", 2, False), ("second", 4, False), ("second", 5, True)):
        for k in range(1, 5):
            h = 0.5**k
            sizes = (None, h) if tolerances else (h, None)
            error = float("nan") if (tolerances and k == 4) else h**power
            costs = (7 * 2**k, 3 * 2**k, 0.002 * power * 2**k, 0.004 * power * 2**k)
            rows.append(WorkPrecisionRow(name, *sizes, error, error / 3, changes.get("floor", 1e-15), *costs))
    return WorkPrecisionTable(
        tuple(rows), (0.5, 4.0), changes.get("trajectories", 1), "numpy", "made up", 1e-16, "no machine", len(rows)
    )


def solid(size: float = 4.0, **view: Any) -> Any:
    return new_figure(size, size).add_subplot(projection="3d", **view)


def first_axes(figure: Any) -> Any:
    return figure.axes[0]


def frame(solution: lh.Solution, share: float, **options: Any) -> Any:
    """A frame of an animation."""
    from liehom.plotting.trajectory_plot import stage

    with style():
        actors = stage(solution, **options)
    for actor in actors:
        actor.move(share)
    return actors[0].scene.axes


def dark(draw: Callable[[], Any]) -> Any:
    with style(dark=True):
        return draw()


P = lh.plotting
A, B = (0.6, 0.0, 0.8), (0.0, 0.8, -0.6)
DAMPED = lh.GeneratorField(
    lh.adjoint(lh.so(3)), lambda m: -m / [1.0, 2.0, 3.0] - 0.2 * np.cross(m, m / [1.0, 2.0, 3.0])
)
CUBIC = "m0**3 + m1**3/2 + m2**3/3 + m0*m1/4"
ENERGY = "m0**2/2 + m1**2/4 + m2**2/6"
TILTED = "(m0 + m1/2)**2/2 + (m1 - m2/5)**2/4 + (m2 - m0/3)**2/6"  # saddles are not on the grid
HYPERBOLIC = lh.defining(lh.so(2, 1))
BOOST = lh.GeneratorField(HYPERBOLIC, [1.0, 0.3, 0.2])

PICTURES: dict[str, Callable[[], Any]] = {
    "dynkin E6 + B3": lambda: P.plot_dynkin("E6 + B3"),
    "dynkin G2 labels dark": lambda: dark(lambda: P.plot_dynkin("G2", labels=("x", 7))),
    "dynkin D4 + A19": lambda: P.plot_dynkin("D4 + A19"),
    "satake su(3,2)": lambda: P.plot_satake("su(3,2)"),
    "satake su(5,1)": lambda: P.plot_satake("su(5,1)"),
    "satake e6(-14)": lambda: P.plot_satake("e6(-14)"),
    "satake so(8,C)": lambda: P.plot_satake("so(8,C)"),
    "satake so(5,3)": lambda: P.plot_satake("so(5,3)"),
    "vogan e6(2)": lambda: P.plot_vogan("e6(2)"),
    "vogan su(2)": lambda: P.plot_vogan("su(2)"),
    "brackets sl(2)": lambda: P.plot_bracket_table(lh.sl(2)),
    "brackets gl(3) dark": lambda: dark(lambda: P.plot_bracket_table(lh.gl(3))),
    "brackets heisenberg(2)": lambda: P.plot_bracket_table(lh.heisenberg(2)),
    "brackets heisenberg(14)": lambda: P.plot_bracket_table(lh.heisenberg(14)),
    "roots A1": lambda: P.plot_root_system("A1"),
    "roots G2": lambda: P.plot_root_system("G2"),
    "roots B3": lambda: P.plot_root_system("B3"),
    "weights A1 (4)": lambda: P.plot_weights("A1", (4,)),
    "weights A2 (2, 2)": lambda: P.plot_weights("A2", (2, 2)),
    "weights A2 (14, 8)": lambda: P.plot_weights("A2", (14, 8)),
    "weights B3 (1, 0, 1)": lambda: P.plot_weights("B3", (1, 0, 1)),
    "weights A2 (0, 0)": lambda: P.plot_weights("A2", (0, 0)),
    "chamber G2": lambda: P.plot_weyl_chamber("G2"),
    "chamber A1 + A1 dark": lambda: dark(lambda: P.plot_weyl_chamber("A1 + A1")),
    "eigenvalues": lambda: P.plot_eigenvalues(points=[(0.6, 0.3, 0.1), (2, 0, 0)]),
    "failure sl(2)/so(1,1)": lambda: P.plot_failure_cone(lh.pair("sl(2)/so(1,1)")),
    "failure so(3,1)/so(2,1)": lambda: P.plot_failure_cone(lh.pair("so(3,1)/so(2,1)")),
    "failure sl(3)/P1": lambda: P.plot_failure_cone(lh.pair("affine(blocks(so(2),gl(1)))")),
    "trajectory in the plane": lambda: first_axes(P.plot_trajectory(turning(2), show="both")),
    "trajectories on a sphere": lambda: first_axes(P.plot_trajectory(body(A, B))),
    "trajectory on a sphere, in the plane": lambda: first_axes(
        P.plot_trajectory(body(A), ax=new_figure(3, 3).add_subplot())
    ),
    "six spheres": lambda: first_axes(P.plot_trajectory(turning(3, 6))),
    "trajectory in space": lambda: first_axes(P.plot_trajectory(boosted([0.5, 0.0, 1.25**0.5]))),
    "coordinates over time": lambda: first_axes(P.plot_trajectory(turning(5), show="both")),
    "coordinates of six over time": lambda: first_axes(
        P.plot_trajectory(turning(3, 6), over_time=True, ax=new_figure(3, 3).add_subplot())
    ),
    "coordinates as colors": lambda: first_axes(P.plot_trajectory(turning(11), show="steps")),
    "quadric of two sheets": lambda: P.plot_quadric(
        HYPERBOLIC,
        lh.integrate(BOOST, (0, 2), [[0.5, 0.0, 1.25**0.5], [0.3, 0.0, -(1.09**0.5)]], dt=0.25, engine="numpy"),
    ),
    "quadrics through points": lambda: P.plot_quadric(
        np.diag([1.0, 2.0, -1.0]), [[1.0, 0.0, 0.2], [0.5, 0.5, 2.0], [1.0, 0.0, -1.0]]
    ),
    "cylinder and point": lambda: P.plot_quadric(np.diag([0.0, 2.0, 1.0]), [[0.7, 1.0, 0.5]]),
    "ellipsoid in the plane": lambda: P.plot_quadric(
        np.diag([3.0, 2.0, 1.0]), [0.5, 0.5, 0.7], new_figure(3, 3).add_subplot()
    ),
    "portrait of a body": lambda: P.plot_phase_portrait(TILTED, solid(elev=20, azim=50), levels=3),
    "portrait of a large body, dark": lambda: dark(lambda: P.plot_phase_portrait(TILTED, radius=2.5)),
    "portrait with damping": lambda: P.plot_phase_portrait(DAMPED, radius=1.5),
    "portrait of a cubic": lambda: P.plot_phase_portrait(CUBIC, levels=1),
    "portrait in the plane": lambda: P.plot_phase_portrait("m2**2 + 7*m0/10", new_figure(3, 3).add_subplot()),
    "portrait of a shear": lambda: P.plot_phase_portrait("m2**2", levels=2),
    "drift": lambda: P.plot_energy_drift(
        {"a": body(A, step="heun"), "two": body(A, B, step="heun")}, ENERGY, largest_so_far=False
    ),
    "drift of long runs": lambda: P.plot_energy_drift(
        [lh.integrate(SPIN, (0, 60), A, step=step, dt=0.25, engine="numpy") for step in ("euler", "heun")], ENERGY
    ),
    "spectrum": lambda: P.plot_spectrum(
        {
            "Toda": lh.integrate(
                lh.instances.toda_flow(3), (0, 3), [2.0, 1.0, 0.0, 0.0, 1.0, -1.0], dt=0.1, engine="numpy"
            ),
            "line": ([0.0, 3.0], [[2.0, 1.0], [1.0, 0.5], [0.0, 0.0], [0.0, 0.5], [1.0, 0.0], [-1.0, 0.0]]),
        }
    ),
    "convergence": lambda: first_axes(P.plot_convergence(convergence(4.1))),
    "convergence near the floor": lambda: first_axes(
        P.plot_convergence(convergence(3, floors=(1e-6,) * 4, trajectories=5))
    ),
    "convergences": lambda: first_axes(
        P.plot_convergence([convergence(k) for k in (1, 2, 3)], labels=["one", "two", "three"])
    ),
    "work and precision": lambda: P.plot_work_precision(precision(floor=2e-4)),
    "calls and precision": lambda: P.plot_work_precision(
        precision(trajectories=3), new_figure(4, 3).add_subplot(), against="calls", error="orbit"
    ),
    "frame on a sphere": lambda: frame(body(A, B), 0.4),
    "frame over time": lambda: frame(turning(4, 2), 0.6, ax=None),
    "frame in the plane": lambda: frame(turning(2), 1.0, ax=new_figure(3, 3).add_subplot()),
}


def main() -> None:
    """Print all pictures."""
    for name, draw in PICTURES.items():
        print(f"# {name}", *described(draw()), "", sep="\n")


if __name__ == "__main__":
    main()
