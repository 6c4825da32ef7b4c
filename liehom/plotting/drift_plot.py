"""Energies and eigenvalues over time."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from math import isqrt
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from liehom.base.errors import InputError, ShapeError, displayed
from liehom.base.typing import Array
from liehom.flow.run.solution import Solution
from liehom.flow.steps.first_integral import FirstIntegral, IntegralSource
from liehom.plotting.canvas import DASHES, MARKERS, current_colours, plane_axes, style_unless, written
from liehom.plotting.trajectory_plot import MAX_TRAJECTORIES, real_numbers

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Plots of the error of a first integral over time, for several solutions.
#     error at t = max over the components of |F(y(t)) - F(y(t_0))| / |F(y(t_0))|
# The largest error so far shows whether an error stays bounded or grows. In logarithmic axes a drift proportional to
# time is a line of slope 1.

HAIRLINE = 1e-17  # The error at which exact values are drawn, since a logarithmic axis has no 0
DECADES = 2.0  # Powers of ten between the first and the last time from which on the axis of time is logarithmic
MARKED = 6  # Markers on a curve


class _Values(NamedTuple):
    """Times since the beginning (n,), changes of F (n, k), and the value of F (k,) from which they are counted."""

    times: Array
    changes: Array
    initial: Array


def plot_energy_drift(
    solutions: Solution | Mapping[str, Solution] | Sequence[Solution],
    F: IntegralSource,
    ax: Axes | None = None,
    *,
    labels: Sequence[str] | None = None,
    largest_so_far: bool = True,
    value: npt.ArrayLike | None = None,
    path: str | os.PathLike[str] | None = None,
) -> Axes:
    """Draw the error of an energy or another first integral over time, one curve for each solution.

    Parameters
    ----------
    solutions : Solution, mapping of labels to solutions, or sequence of solutions
        Solutions of `integrate`, of which the stored points are used. Of an ensemble, the first 50 trajectories are
        drawn in one color.
    F : callable, str, sympy expression, or list of these
        The first integral as for `liehom.Conserving`: a function of points of shape (..., N), or a string such as
        ``"m0**2 + m1**2/2"``. Of several integrals the largest error counts.
    ax : matplotlib.axes.Axes, optional
        Axes to draw in; by default new ones.
    labels : sequence of str, optional
        One label for each solution (default: the keys of the mapping, or the steps).
    largest_so_far : bool, optional
        Draw the largest error up to each time (default). False draws the errors themselves, which oscillate.
    value : float or array of shape (k,), optional
        The exact value of F, in place of its value at the first stored point of each trajectory. It is needed if
        `t_eval` did not contain the initial time.
    path : path, optional
        A file to write the picture to.

    Returns
    -------
    matplotlib.axes.Axes
        The axis of errors is logarithmic. The axis of time is logarithmic too if `largest_so_far` is True and the
        stored times span at least two powers of ten. Errors are relative to the initial value of F, or absolute if
        that is 0; the label of the axis says which. A curve without error is drawn at 1e-17.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / [1.0, 2.0, 3.0])
    >>> steps = {"Heun": lh.Heun(), "midpoint": lh.SphericalMidpoint()}
    >>> runs = {name: lh.integrate(field, (0, 50), [0.6, 0.0, 0.8], step=s, dt=0.5) for name, s in steps.items()}
    >>> ax = plot_energy_drift(runs, "m0**2/2 + m1**2/4 + m2**2/6")  # doctest: +SKIP
    """
    named = [(label, _trajectories(solution, F, value)) for label, solution in _named(solutions, labels)]
    relative = all(bool(part.initial.any()) for _, parts in named for part in parts)
    times = [part.times for _, parts in named for part in parts]
    logarithmic = largest_so_far and _decades(times) >= DECADES
    with style_unless(ax):
        ax = plane_axes(ax, 6.4, 4.2)
        colours = current_colours()
        for k, (label, parts) in enumerate(named):
            for i, part in enumerate(parts):
                error = np.maximum(_error(part, relative), HAIRLINE)
                ax.plot(
                    part.times[1:], (np.maximum.accumulate(error) if largest_so_far else error)[1:],
                    color=colours[k % len(colours)], linestyle=DASHES[k % len(DASHES)],
                    marker=MARKERS[k % len(MARKERS)], markersize=5,
                    markevery=_places(part.times[1:], (k + 0.5) / len(named), logarithmic),
                    linewidth=1.5 if len(parts) == 1 else 0.8, label=None if i else label,
                )  # fmt: skip
        what = f"{'largest error so far' if largest_so_far else 'error'}, {'relative' if relative else 'absolute'}"
        scales = {"xscale": "log", "yscale": "log"} if logarithmic else {"yscale": "log"}
        ax.set(**scales, xlabel="time since the initial point", ylabel=what)
        ax.legend(loc="best", handlelength=3.0)
    return written(ax, path)


def _named(
    solutions: Solution | Mapping[str, Solution] | Sequence[Solution], labels: Sequence[str] | None
) -> list[tuple[str, Solution]]:
    """Solutions with their labels."""
    pairs: object = solutions
    if isinstance(solutions, Solution):
        chosen = [solutions]
    elif isinstance(solutions, Mapping):
        chosen, labels = list(solutions.values()), list(solutions) if labels is None else labels
    else:
        chosen = list(solutions) if isinstance(solutions, Sequence) else []
    if not chosen or not all(isinstance(solution, Solution) for solution in chosen):
        raise InputError(f"expected solutions as liehom.integrate returns them, got {displayed(pairs)}")
    if labels is not None and not isinstance(labels, Sequence):
        raise InputError(f"labels are {displayed(labels)}, expected one string for each solution")
    names = [solution.report.step for solution in chosen] if labels is None else [str(label) for label in labels]
    if len(names) != len(chosen):
        raise InputError(f"there are {len(chosen)} solutions and {len(names)} labels")
    return list(zip(names, chosen, strict=True))


def _trajectories(solution: Solution, F: IntegralSource, value: npt.ArrayLike | None) -> list[_Values]:
    """The values of F along each of the first trajectories of a solution."""
    y = np.asarray(solution.y)
    if not y.size:
        raise InputError("a solution has no point to draw: its ensemble or its t_eval is empty")
    exact = None if value is None else real_numbers(value, "value")
    times = np.broadcast_to(np.asarray(solution.t), (*y.shape[:-2], y.shape[-1]))
    integral = FirstIntegral(F, y.shape[-2])
    trajectories = []
    for t, points in zip(times.reshape(-1, y.shape[-1])[:MAX_TRAJECTORIES], y.reshape(-1, *y.shape[-2:]), strict=False):
        there = np.isfinite(t) & np.isfinite(points).all(axis=0)
        with np.errstate(all="ignore"):
            values = np.asarray(integral(np.moveaxis(points[:, there], 0, -1)), dtype=float)
        try:
            initial = values[0] if exact is None else np.broadcast_to(exact, values[0].shape)
        except ValueError:
            raise ShapeError(f"value is {value!r}, F has {values.shape[-1]} components") from None
        if not np.isfinite(initial).all():
            raise InputError(f"F is {initial} at the initial point, expected finite numbers: give value= or another F")
        trajectories.append(_Values(np.abs(t[there] - t[there][0]), values - initial, initial))
    return trajectories


def _error(part: _Values, relative: bool) -> Array:
    """Largest error of the components, (n,); a component that is initially 0 is compared with the largest one."""
    scale = np.abs(part.initial)
    scale = np.where(scale > 0, scale, scale.max()) if relative else np.ones_like(scale)
    return (np.abs(part.changes) / scale).max(axis=-1)


def _decades(times: Sequence[Array]) -> float:
    """Powers of ten between the first and the last time after the initial one."""
    positive = np.concatenate([t[t > 0] for t in times])
    return float(np.log10(positive.max() / positive.min())) if positive.size else 0.0


def _places(t: Array, offset: float, logarithmic: bool) -> list[int]:
    """Indices of markers, evenly spread over the axis of time; offsets keep those of several curves apart."""
    if len(t) < 2:
        return list(range(len(t)))
    low, high = t[0], t[-1]
    shares = (np.arange(MARKED) + offset) / MARKED
    wanted = low * (high / low) ** shares if logarithmic else low + (high - low) * shares
    return sorted({int(i) for i in np.minimum(np.searchsorted(t, wanted), len(t) - 1)})


# Plots of the eigenvalues of symmetric matrices over time: isospectral flows have constant ones.

Trajectory: TypeAlias = Solution | tuple[npt.ArrayLike, npt.ArrayLike]  # A solution, or times (n,) and points (N, n)
ASYMMETRY = 1e-8  # Distance from symmetric matrices that counts as round-off, relative to the largest entry


def plot_spectrum(
    trajectories: Trajectory | Mapping[str, Trajectory],
    ax: Axes | None = None,
    *,
    matrices: Callable[[Array], npt.ArrayLike] | None = None,
    path: str | os.PathLike[str] | None = None,
) -> Axes:
    """Draw the eigenvalues of a trajectory of symmetric matrices over time, one color for each eigenvalue.

    Parameters
    ----------
    trajectories : Solution, pair of arrays, or mapping of labels to these
        A solution in the coordinates S[i, j], i <= j, of Sym(k), as those of `liehom.instances.SymmetricMatrices`; or
        times (n,) and points (N, n) of another method. The trajectories of a mapping differ in their dashes.
    ax : matplotlib.axes.Axes, optional
        Axes in the plane; by default new ones.
    matrices : callable, optional
        Symmetric or Hermitian matrices (n, k, k) of points (n, N), for other coordinates.
    path : path, optional
        A file to write the picture to.

    Returns
    -------
    matplotlib.axes.Axes

    Notes
    -----
    Orbits of SO(k) on Sym(k) are the matrices with given eigenvalues, so that the steps of this library draw horizontal
    lines. Eigenvalues are computed at the points of the steps, by `numpy.linalg.eigvalsh`.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.instances.toda_flow(3)
    >>> sol = lh.integrate(field, (0, 3), [2.0, 1.0, 0.0, 0.0, 1.0, -1.0])
    >>> ax = lh.plotting.plot_spectrum(sol)  # doctest: +SKIP
    """
    named = dict(trajectories) if isinstance(trajectories, Mapping) else {"": trajectories}
    curves = [spectrum(trajectory, matrices) for trajectory in named.values()]
    if not curves:
        raise InputError("there is no trajectory to draw")
    with style_unless(ax):
        ax = plane_axes(ax, 6.0, 3.8)
        colours = current_colours()
        for label, (t, values), dashes in zip(named, curves, DASHES * len(curves), strict=False):
            for i, line in enumerate(values.T):
                ax.plot(t, line, dashes, color=colours[i % 6], linewidth=1.8 if dashes == "-" else 1.4)
            if label:
                ax.plot([], [], dashes, color=colours[6], label=label)
        ax.set(xlabel="time $t$", ylabel="eigenvalues")
        ax.margins(x=0.01)
        if len(named) > 1 or "" not in named:
            ax.legend(loc="upper center", bbox_to_anchor=(0.5, 1.14), ncols=3)
    return written(ax, path)


def spectrum(trajectory: Trajectory, matrices: Callable[[Array], npt.ArrayLike] | None = None) -> tuple[Array, Array]:
    """Times (n,) and eigenvalues (n, k) in increasing order, at the points that are finite."""
    if isinstance(trajectory, Solution):
        t, y = np.asarray(trajectory.t, dtype=float), np.asarray(trajectory.y, dtype=float)
    elif isinstance(trajectory, Sequence) and len(trajectory) == 2:
        t, y = (real_numbers(part, "times and points") for part in trajectory)
    else:
        raise InputError(f"expected a solution, or times and points, got {displayed(trajectory)}")
    if y.ndim != 2 or t.shape != y.shape[1:]:
        raise ShapeError(f"expected times (n,) and points (N, n) of one trajectory, got {t.shape} and {y.shape}")
    matrix = np.asarray(_symmetric(y.T) if matrices is None else matrices(y.T))
    if matrix.ndim != 3 or matrix.shape[0] != len(t) or matrix.shape[1] != matrix.shape[2]:
        raise ShapeError(f"the matrices have shape {matrix.shape}, expected ({len(t)}, k, k)")
    there = np.isfinite(t) & np.isfinite(matrix).all(axis=(1, 2))
    t, matrix = t[there], matrix[there]
    if not np.allclose(
        matrix, np.swapaxes(matrix, 1, 2).conj(), atol=ASYMMETRY * float(np.abs(matrix).max(initial=0.0))
    ):
        raise InputError("the matrices are not symmetric or Hermitian: only of such matrices eigenvalues are drawn")
    return t, np.linalg.eigvalsh(matrix)


def _symmetric(points: Array) -> Array:
    """Symmetric matrices (n, k, k) of points (n, k (k + 1) / 2)."""
    size = points.shape[1]
    k = (isqrt(8 * size + 1) - 1) // 2
    if k * (k + 1) // 2 != size:
        raise ShapeError(f"a point of Sym(k) has k (k + 1) / 2 coordinates, got {size}; for others give matrices=")
    symmetric = np.zeros((len(points), k, k))
    rows, columns = np.triu_indices(k)
    symmetric[:, rows, columns] = points
    symmetric[:, columns, rows] = points
    return symmetric
