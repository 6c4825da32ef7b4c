"""Numerical answer for pairs over float64: full, not full or undecided, with the numbers that it rests on.

Let T_i be the traceless parts of rho of an orthonormal basis of h, and e the error of all T_i together, propagated from
the error of the data (docs/floats.md). The pair is full if sigma_d(x) > 0 for every x != 0 in V, where sigma_d(x) is
the smallest singular value of the matrix with columns T_i x and x. All sizes are relative to the norm of the data, and
no matrix is normalized, so T_i below e contribute below e to sigma_d.

Full is an open condition, and it is answered if it holds for all data within the error. Singular vectors of the T_i as
vectors, with singular values above e, span L0. `transitive_group` finds an inner product |g x| in which the
skew-symmetric elements of L0 are transitive on the unit sphere (theorem 2 of docs/theory/fullness.md). For an
orthonormal basis K_b of these elements the smallest singular value of the matrix with columns K_b x and x is a constant
v. It is found at one x, so nothing depends on how well a minimum was searched. The K_b are combinations of the g T_i
g^-1 with coefficients of norm 1 / s, so an error e of the T_i changes them by at most e cond(g) / s. Weyl's inequality
for singular values gives: full if v > e cond(g) / s. The answer needs 100 times as much, since errors are propagated to
first order.

Not full is not an open condition: data nearby are full, so no size of an error can exclude it. It is answered for the
data as given, if an x was found with sigma_d(x) at most 2^12 units of round-off. Data that are computed, in a rotated
basis say, are off by a few hundred units; a value above this level is not a zero. The basis elements of g can have
units of very different sizes, so the same must hold after they are rescaled such that all structure constants have
similar sizes. The cases in between are undecided.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from liehom.algebra import LieAlgebra, Subalgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.fullness.least_singular_value import least_singular_value
from liehom.fullness.self_adjoint import TransitiveGroup, orthonormal_span, transitive_group
from liehom.fullness.verdict import NumericallyFull, NumericallyNotFull, NumericallyUndecided
from liehom.representations import Pair
from liehom.scalars import RR, FloatField, FloatMatrix
from liehom.typing import Array

NumericalVerdict: TypeAlias = NumericallyFull | NumericallyNotFull | NumericallyUndecided
"""A result of `decide_numerically`."""

MIN_GAP = 100.0
"""Full is answered if sigma_d is at least so many times its error."""
ROUNDING = 2.0**12 * float(np.finfo(np.float64).eps)
"""Relative size below which sigma_d is zero up to rounding."""

MAX_LOG = 100.0
"""Largest logarithm of the factor of a basis element."""


def decide_numerically(pair: Pair, *, starts: int = 60, seed: int = 0) -> NumericalVerdict:
    """Numerical verdict, with the singular value that it rests on.

    Parameters
    ----------
    pair : Pair
        Exact or over float64; exact numbers are rounded.
    starts : int
        Number of random initial points, in addition to the axes, of the search for an eta that shows 'not full'.
    seed : int
        Seed of the initial points.

    Returns
    -------
    NumericallyFull
        If every pair within the error of the data is full, with a gap of at least 100.
    NumericallyNotFull
        If the rank drops at some eta, up to rounding. Rounding alone can cause it.
    NumericallyUndecided
        In all other cases. ``liehom.rationalize`` leads to exact data, which are always decided.

    Notes
    -----
    The error of the data is `rtol` of the pair's field (1e-9 for exact pairs) relative to their norm. The answer is the
    same if the data are multiplied by a number, or if the basis of g is rotated.

    Examples
    --------
    >>> import liehom as lh
    >>> decide_numerically(lh.pair("so(4)/so(3)")).full
    True
    >>> noise = lh.LieAlgebra({(0, 3): {2: 1.0}, (1, 2): {3: 1e-17}}, dimension=4)
    >>> decide_numerically(lh.Pair(noise, [[1, 0, 0, 0], [0, 1, 0, 0]]))
    <numerically undecided: dimensions 4/2, least singular value ...>
    """
    d = pair.dimension
    rtol = pair.field.rtol if isinstance(pair.field, FloatField) else RR.rtol
    if d <= 1:
        return NumericallyFull(pair, f"dim g/h = {d}, whatever the numbers are", 1.0, 1.0 / rtol)
    action, size = _traceless_action(pair, rtol)
    group = transitive_group(action, rtol * size) if size else None
    if group is not None and _gap(group, rtol * size) >= MIN_GAP:
        return _full(pair, group, rtol * size)
    rounding = min(ROUNDING, rtol)
    value, x = _least(action, size, starts, seed)
    if value > rounding or group is not None:
        return _undecided(pair, group, rtol, size, value, x)
    if _is_above_rounding(_rescaled(pair), rounding, starts, seed):
        reason = (
            f"an eta with sigma_d = {value:.1e} relative to the data was found, but it is not zero up to the rounding "
            f"level {rounding:.1e} after the basis of g is rescaled, and the error of the data is {rtol:.1e}"
        )
        return NumericallyUndecided(pair, reason, value, value / rtol, _eta(pair, x))
    reason = (
        f"an eta with sigma_d = {value:.1e} relative to the data was found, zero up to the rounding level "
        f"{rounding:.1e}; rounding alone can cause it, since data within the error {rtol:.1e} can be full"
    )
    return NumericallyNotFull(pair, reason, value, rtol / max(value, 1e-300), _eta(pair, x))


def _least(action: Array, size: float, starts: int, seed: int) -> tuple[float, Array]:
    """The least sigma_d of [T_i x / size, x / sqrt(d)] that was found, and x."""
    d = action.shape[1]
    values, basis = orthonormal_span(action, 0.0)
    columns = [values[:, None, None] * basis / (size or 1.0), np.eye(d)[None] / d**0.5]
    return least_singular_value(np.concatenate(columns), starts=starts, seed=seed)


def _is_above_rounding(pair: Pair, rounding: float, starts: int, seed: int) -> bool:
    """Whether the data as given are full, or sigma_d is not zero up to rounding."""
    if pair.subalgebra.basis.rank() < pair.subalgebra.dimension:
        return True
    action, size = _traceless_action(pair, RR.rtol)
    group = transitive_group(action, rounding * size) if size else None
    if group is not None and _gap(group, rounding * size) > 1:
        return True
    return _least(action, size, starts, seed)[0] > rounding


def _rescaled(pair: Pair) -> Pair:
    """The pair in the basis exp(l_i) e_i with the least sum of squared logarithms of the structure constants."""
    table, n = pair.algebra.table, pair.algebra.dimension
    values = np.array([pair.field.to_float(v) for v in table.values()])
    index = np.arange(len(values))
    weights = np.zeros((len(values), n))
    for places, sign in ((table.i, 1), (table.j, 1), (table.k, -1)):
        np.add.at(weights, (index, places), sign)
    logs: Array = np.linalg.lstsq(weights, -np.log(np.abs(values)), rcond=None)[0] if len(values) else np.zeros(n)
    logs = np.clip(logs, -MAX_LOG, MAX_LOG)
    values = values * np.exp(weights @ logs)
    entries = zip(table.i.tolist(), table.j.tolist(), table.k.tolist(), values.tolist(), strict=True)
    algebra = LieAlgebra(StructureConstants(RR, n, entries), check=False)  # the same algebra and subspace
    rows = pair.subalgebra.basis.to_numpy() * np.exp(-logs)
    rows = rows / np.linalg.norm(rows, axis=1, keepdims=True)
    return Pair(
        algebra, Subalgebra(algebra, RR.matrix(rows.tolist(), rows.shape), check=False)
    )  # and the same subspace


def _traceless_action(pair: Pair, rtol: float) -> tuple[Array, float]:
    """The T_i, shape (k, d, d), and the number that gives their error if it is multiplied by `rtol`."""
    d = pair.dimension
    made = pair.isotropy_matrices()
    matrices = np.array([a.to_numpy() for a in made]).reshape(-1, d, d)
    errors = [a.error for a in made if isinstance(a, FloatMatrix)]  # blocks of one matrix, each with its whole error
    size = max(errors) / rtol if errors else float(np.linalg.norm(matrices))
    traces = np.trace(matrices, axis1=1, axis2=2) / d
    return matrices - traces[:, None, None] * np.eye(d), size


def _gap(group: TransitiveGroup, error: float) -> float:
    """The value v of the group in units of its error e cond(g) / s."""
    return group.value * group.smallest / (group.condition * max(error, 1e-300))


def _full(pair: Pair, group: TransitiveGroup, error: float) -> NumericallyFull:
    gap = _gap(group, error)
    reason = (
        f"sigma_d = {group.value:.3g} at every eta, {gap:.1e} times its error {group.value / gap:.1e}, since a compact "
        "group of the isotropy is transitive on the directions of g/h"
    )
    return NumericallyFull(pair, reason, group.value, gap, _eta(pair, group.point))


def _undecided(
    pair: Pair, group: TransitiveGroup | None, rtol: float, size: float, value: float, x: Array
) -> NumericallyUndecided:
    if group is not None:
        gap = _gap(group, rtol * size)
        reason = (
            f"sigma_d = {group.value:.3g} at every eta, but its error is {group.value / gap:.1e}, a gap of {gap:.1e} "
            f"where {MIN_GAP:.0f} is needed"
        )
        return NumericallyUndecided(pair, reason, group.value, gap, _eta(pair, group.point))
    gap = value / rtol
    found = f"the least sigma_d found is {value:.1e} relative to the data, {gap:.1e} times their error {rtol:.1e}"
    if gap < MIN_GAP:
        reason = f"{found}: neither zero up to the rounding level {ROUNDING:.1e} nor {MIN_GAP:.0f} times the error"
    else:
        reason = f"{found}, but no compact group was found that is transitive on the directions of g/h"
    return NumericallyUndecided(pair, reason, value, gap, _eta(pair, x))


def _eta(pair: Pair, x: Array) -> list[float]:
    """Coefficients in the basis of g of the element that x represents."""
    return [float(v) for v in x @ pair.subalgebra.quotient().lift.to_numpy()]
