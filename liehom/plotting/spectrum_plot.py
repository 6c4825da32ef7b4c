"""Plots of the eigenvalues of symmetric matrices over time: isospectral flows have constant ones."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import isqrt
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
import numpy.typing as npt

from liehom.errors import InputError, ShapeError, displayed
from liehom.integrators import Solution
from liehom.plotting.canvas import DASHES, current_colours, plane_axes, style_unless
from liehom.plotting.curves import real_numbers
from liehom.typing import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Trajectory: TypeAlias = Solution | tuple[npt.ArrayLike, npt.ArrayLike]
"""A solution, or times (n,) and points (N, n)."""
ASYMMETRY = 1e-8
"""Distance from symmetric matrices that counts as round-off, relative to the largest entry."""


def plot_spectrum(
    trajectories: Trajectory | Mapping[str, Trajectory],
    ax: Axes | None = None,
    *,
    matrices: Callable[[Array], npt.ArrayLike] | None = None,
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

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    InputError
        If matplotlib is not installed, there is nothing to draw, or matrices are not symmetric or Hermitian.
    ShapeError
        If points do not have the k (k + 1) / 2 coordinates of symmetric matrices, or there are several trajectories in
        one solution.

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
    return ax


def spectrum(trajectory: Trajectory, matrices: Callable[[Array], npt.ArrayLike] | None = None) -> tuple[Array, Array]:
    """Times (n,) and eigenvalues (n, k) in increasing order, at the points that are finite.

    Examples
    --------
    >>> spectrum(([0.0, 1.0], [[1.0, 1.0], [0.0, 2.0], [3.0, 1.0]]))[1].tolist()
    [[1.0, 3.0], [-1.0, 3.0]]
    """
    if isinstance(trajectory, Solution):
        t, y = np.asarray(trajectory.t, dtype=float), np.asarray(trajectory.y, dtype=float)
    elif isinstance(trajectory, Sequence) and len(trajectory) == 2:
        t, y = (real_numbers(part, "times and points") for part in trajectory)
    else:
        raise InputError(f"expected a solution, or times and points, got {displayed(trajectory)}")
    if y.ndim != 2 or t.shape != y.shape[1:]:
        raise ShapeError(f"expected times (n,) and points (N, n) of one trajectory, got {t.shape} and {y.shape}")
    found = np.asarray(_symmetric(y.T) if matrices is None else matrices(y.T))
    if found.ndim != 3 or found.shape[0] != len(t) or found.shape[1] != found.shape[2]:
        raise ShapeError(f"the matrices have shape {found.shape}, expected ({len(t)}, k, k)")
    there = np.isfinite(t) & np.isfinite(found).all(axis=(1, 2))
    t, found = t[there], found[there]
    if not np.allclose(found, np.swapaxes(found, 1, 2).conj(), atol=ASYMMETRY * float(np.abs(found).max(initial=0.0))):
        raise InputError("the matrices are not symmetric or Hermitian: only of such matrices eigenvalues are drawn")
    return t, np.linalg.eigvalsh(found)


def _symmetric(points: Array) -> Array:
    """Symmetric matrices (n, k, k) of points (n, k (k + 1) / 2)."""
    size = points.shape[1]
    k = (isqrt(8 * size + 1) - 1) // 2
    if k * (k + 1) // 2 != size:
        raise ShapeError(f"a point of Sym(k) has k (k + 1) / 2 coordinates, got {size}; for others give matrices=")
    made = np.zeros((len(points), k, k))
    rows, columns = np.triu_indices(k)
    made[:, rows, columns] = points
    made[:, columns, rows] = points
    return made
