"""The decision over floats."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias, final

import numpy as np

from liehom.base.typing import Array
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.fullness.verdict import NumericallyFull, NumericallyNotFull, NumericallyUndecided
from liehom.exact.representations.core.pair import Pair
from liehom.exact.scalars.floating import RR, FloatField, FloatMatrix

# Inner products in which a span of matrices is self-adjoint, and the test that its compact part is transitive.
#
# Let L0 be a Lie algebra of traceless matrices on V = R^d, d >= 2. The pair is full if and only if, in some inner
# product, the skew-symmetric elements K of L0 satisfy dim K x = d - 1 at one x != 0 (theorem 2 of
# docs/theory/fullness.md). If L0 is reductive, then L0 is self-adjoint in some inner product (Mostow), and K is as
# large as possible there. For an orthonormal basis E_a of the span of g L0 g^-1 the volume of g E_a g^-1 is convex
# along g = exp(X), X symmetric, with the gradient M = sum_a [E_a, E_a^T]. The volume is least if and only if the span
# is self-adjoint. Newton's method minimizes it.
#
# Let K_b be an orthonormal basis of K. If K is transitive on the unit sphere, then the smallest singular value of the
# matrix with columns K_b x and x is the same at every unit vector x, because the group of K acts on K by orthogonal
# maps. One x shows its minimum over the sphere.

STEPS, CONJUGATE_STEPS, SAMPLES = 80, 60, 8
MAX_CONDITION = 1e9
"""Condition of g beyond which the span has no self-adjoint position that floats can see."""
SELF_ADJOINT = 1e-6
"""Largest part of a transposed unit element outside of a span that is called self-adjoint."""


@final
@dataclass(frozen=True, slots=True)
class TransitiveGroup:
    """An inner product |g x|^2 whose orthogonal group meets the group of L0 in a transitive one."""

    value: float  # smallest singular value of [K_b x, x] at every unit vector x, at most 1
    smallest: float  # an error e of the matrices g A g^-1 changes the K_b by at most e / smallest
    condition: float  # of g
    point: Array  # a unit vector at which value was computed


def orthonormal_span(matrices: Array, bound: float) -> tuple[Array, Array]:
    """Singular values above a bound of matrices (k, d, d) as vectors, and an orthonormal basis (m, d, d)."""
    k, d = len(matrices), matrices.shape[1]
    _, values, right = np.linalg.svd(matrices.reshape(k, d * d), full_matrices=False)
    kept = values > bound
    return values[kept], right[kept].reshape(-1, d, d)


def transitive_group(matrices: Array, bound: float) -> TransitiveGroup | None:
    """`TransitiveGroup` of the Lie algebra that traceless matrices span, or None if none was found."""
    basis = orthonormal_span(matrices, bound)[1]
    d = matrices.shape[1]
    if len(basis) + 1 < d:
        return None
    g = self_adjoint_position(basis)
    condition = float(np.linalg.cond(g))
    if not condition < MAX_CONDITION:
        return None
    span = basis.reshape(-1, d * d)
    counted = (matrices.reshape(-1, d * d) @ span.T @ span).reshape(-1, d, d)
    # the singular values that count are those of the matrices projected to the span, as many as its dimension
    _, values, right = np.linalg.svd((g @ counted @ np.linalg.inv(g)).reshape(-1, d * d), full_matrices=False)
    turned = right[: len(basis)].reshape(-1, d, d)
    if _defect(turned) > SELF_ADJOINT:
        return None
    skew = (turned - turned.transpose(0, 2, 1)).reshape(-1, d * d) / 2
    weights, parts, compact = np.linalg.svd(skew, full_matrices=False)
    compact = compact[parts > 0.5].reshape(-1, d, d)  # the values are 0 and 1
    if len(compact) < d - 1:
        return None
    points = np.random.default_rng(len(basis)).standard_normal((SAMPLES, d))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    least = np.linalg.svd(np.einsum("aij,nj->nia", compact, points), compute_uv=False)[:, d - 2]
    if not SELF_ADJOINT < least.min() > least.max() * (1 - 1e-3):
        return None
    # the basis K_b is the matrix weights^T values^-1 times an isometry times the matrices g A g^-1
    smallest = 1 / float(np.linalg.norm(weights[:, parts > 0.5].T / values[: len(basis)], 2))
    point = np.linalg.solve(g, points[0])
    return TransitiveGroup(float(least.min()), smallest, condition, point / np.linalg.norm(point))


def self_adjoint_position(basis: Array) -> Array:
    """Matrix g, (d, d), such that the span of g A g^-1 is nearly self-adjoint, if there is one."""
    g, current = np.eye(basis.shape[1]), basis
    for _ in range(STEPS):
        _, current = orthonormal_span(current, 0.0)
        gradient = _moment(current, current)
        if np.linalg.norm(gradient) <= 1e-14 * len(current) or not np.linalg.cond(g) < MAX_CONDITION:
            break
        step, current = _descend(current, _newton_direction(current, gradient), gradient)
        g = step @ g
    return g


def _moment(left: Array, right: Array) -> Array:
    """The symmetric part of sum_a (L_a R_a^T - L_a^T R_a)."""
    product = np.einsum("aij,akj->ik", left, right) - np.einsum("aji,ajk->ik", left, right)
    return np.asarray((product + product.T) / 2)


def _newton_direction(basis: Array, gradient: Array) -> Array:
    """Symmetric X with Hessian X = -gradient, by conjugate gradients, shortened to norm 1."""
    span = basis.reshape(len(basis), -1)

    def hessian(x: Array) -> Array:
        moved = (x @ basis - basis @ x).reshape(len(basis), -1)
        return _moment((moved - moved @ span.T @ span).reshape(basis.shape), basis)

    x, rest = np.zeros_like(gradient), -gradient
    direction, size = rest, float((rest * rest).sum())
    goal = size * 1e-4 * min(1.0, size)
    for _ in range(CONJUGATE_STEPS):
        image = hessian(direction)
        curvature = float((direction * image).sum())
        if curvature <= 1e-14 * float((direction * direction).sum()):
            x = x if x.any() else direction
            break
        x = x + size / curvature * direction
        rest = rest - size / curvature * image
        before, size = size, float((rest * rest).sum())
        if size <= goal:
            break
        direction = rest + size / before * direction
    return np.asarray(x / max(1.0, float(np.linalg.norm(x, 2))))


def _descend(basis: Array, x: Array, gradient: Array) -> tuple[Array, Array]:
    """exp(t x) and the basis in its coordinates, with t halved from 1 until the volume decreases enough."""
    slope = 2 * float((x * gradient).sum())
    weights, vectors = np.linalg.eigh(x)
    t = 1.0
    while True:
        step = (vectors * np.exp(t * weights)) @ vectors.T
        moved = step @ basis @ ((vectors * np.exp(-t * weights)) @ vectors.T)
        if _log_volume(moved) <= 1e-4 * t * slope or t < 1e-3:  # the given basis is orthonormal
            return step, moved
        t /= 2


def _log_volume(basis: Array) -> float:
    values = np.linalg.svd(basis.reshape(len(basis), -1), compute_uv=False)
    return 2 * float(np.log(np.maximum(values, 1e-300)).sum())


def _defect(basis: Array) -> float:
    """Frobenius norm of the part of the transposed basis that is outside of its span."""
    span = basis.reshape(len(basis), -1)
    transposed = basis.transpose(0, 2, 1).reshape(len(basis), -1)
    return float(np.linalg.norm(transposed - transposed @ span.T @ span))


# The least sigma_d(x): sigma_d(x)^2 is the minimum over unit vectors u of sum_a (u . A_a x)^2, which is quadratic in u
# and in x. Alternating singular value decompositions decrease it monotonically from many initial points. The best
# points are then improved by Gauss-Newton steps for the bilinear equations u . A_a x = 0, which converge quadratically
# to a simple zero and linearly to a multiple one.

ALTERNATIONS, IMPROVED, DESCENT_STEPS = 30, 8, 100


def least_singular_value(basis: Array, *, starts: int, seed: int) -> tuple[float, Array]:
    """Smallest sigma_d that was found, and the unit vector x at which it was found."""
    m, d = len(basis), basis.shape[1]
    if m < d:
        return 0.0, np.eye(d)[0]
    points = np.concatenate([np.eye(d), np.random.default_rng(seed).standard_normal((starts, d))])
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    for _ in range(ALTERNATIONS):
        left = np.linalg.svd(np.einsum("aij,nj->nia", basis, points), full_matrices=False)[0][:, :, -1]
        points = np.linalg.svd(np.einsum("ni,aij->naj", left, basis), full_matrices=False)[2][:, -1]
    values = np.linalg.svd(np.einsum("aij,nj->nia", basis, points), compute_uv=False)[:, -1]
    return min([_improved(basis, points[i]) for i in np.argsort(values)[:IMPROVED]], key=lambda pair: pair[0])


def smallest(basis: Array, x: Array) -> tuple[float, Array]:
    """The value sigma_d of the matrix with columns A_a x, and its left singular vector; m >= d."""
    left, values, _ = np.linalg.svd((basis @ x).T, full_matrices=False)
    return float(values[-1]), left[:, -1]


def _improved(basis: Array, x: Array) -> tuple[float, Array]:
    """The point after Gauss-Newton steps with the damping, of four, that decreases sigma_d most."""
    d = len(x)
    value, u = smallest(basis, x)
    for _ in range(DESCENT_STEPS):
        rows, columns = np.einsum("i,aij->aj", u, basis), basis @ x
        left, values, right = np.linalg.svd(np.concatenate([rows, columns], axis=1), full_matrices=False)
        residual = left.T @ (columns @ u)
        tries = []
        for damping in (0.0, 1e-3 * value, value, 10 * value**0.5):
            inverse = np.where(values > 1e-13 * values[0], values / (values**2 + damping**2 + 1e-300), 0.0)
            moved = x - (right.T * inverse @ residual)[:d]
            moved = moved / np.linalg.norm(moved)
            tries.append((*smallest(basis, moved), moved))
        best = min(tries, key=lambda triple: triple[0])
        if not best[0] < 0.98 * value:
            break
        value, u, x = best
    return value, x


# Numerical answer for pairs over float64: full, not full or undecided, with the numbers that it rests on.
#
# Let T_i be the traceless parts of rho of an orthonormal basis of h, and e the error of all T_i together, propagated
# from the error of the data (docs/floats.md). The pair is full if sigma_d(x) > 0 for every x != 0 in V, where
# sigma_d(x) is the smallest singular value of the matrix with columns T_i x and x. All sizes are relative to the norm
# of the data, and no matrix is normalized, so T_i below e contribute below e to sigma_d.
#
# Full is an open condition, and it is answered if it holds for all data within the error. Singular vectors of the T_i
# as vectors, with singular values above e, span L0. `transitive_group` finds an inner product |g x| in which the
# skew-symmetric elements of L0 are transitive on the unit sphere (theorem 2 of docs/theory/fullness.md). For an
# orthonormal basis K_b of these elements the smallest singular value of the matrix with columns K_b x and x is a
# constant v. It is found at one x, so nothing depends on how well a minimum was searched. The K_b are combinations of
# the g T_i g^-1 with coefficients of norm 1 / s, so an error e of the T_i changes them by at most e cond(g) / s. Weyl's
# inequality for singular values gives: full if v > e cond(g) / s. The answer needs 100 times as much, since errors are
# propagated to first order.
#
# Not full is not an open condition: data nearby are full, so no size of an error can exclude it. It is answered for the
# data as given, if an x was found with sigma_d(x) at most 2^12 units of round-off. Data that are computed, in a rotated
# basis say, are off by a few hundred units; a value above this level is not a zero. The basis elements of g can have
# units of very different sizes, so the same must hold after they are rescaled such that all structure constants have
# similar sizes. The cases in between are undecided.

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
        If every pair within the error of the data is full, to first order in the error and with a gap of at least 100.
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
    is_full = group is not None and _gap(group, rounding * size) > 1
    return is_full or _least(action, size, starts, seed)[0] > rounding


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
    rows = rows / np.linalg.norm(rows, axis=1, keepdims=True)  # and the same subspace
    return Pair(algebra, Subalgebra(algebra, RR.matrix(rows.tolist(), rows.shape), check=False))


def _traceless_action(pair: Pair, rtol: float) -> tuple[Array, float]:
    """The T_i, shape (k, d, d), and the number that gives their error if it is multiplied by `rtol`."""
    d, images = pair.dimension, pair.isotropy_matrices()
    matrices = np.array([a.to_numpy() for a in images]).reshape(-1, d, d)
    errors = [a.error for a in images if isinstance(a, FloatMatrix)]  # blocks of one matrix, each with its full error
    size = max(errors) / rtol if errors else float(np.linalg.norm(matrices))
    return matrices - (np.trace(matrices, axis1=1, axis2=2) / d)[:, None, None] * np.eye(d), size


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
    reason = f"the least sigma_d found is {value:.1e} relative to the data, {gap:.1e} times their error {rtol:.1e}"
    if gap < MIN_GAP:
        reason += f": neither zero up to the rounding level {ROUNDING:.1e} nor {MIN_GAP:.0f} times the error"
    else:
        reason += ", but no compact group was found that is transitive on the directions of g/h"
    return NumericallyUndecided(pair, reason, value, gap, _eta(pair, x))


def _eta(pair: Pair, x: Array) -> list[float]:
    """Coefficients in the basis of g of the element that x represents."""
    return [float(v) for v in x @ pair.subalgebra.quotient().lift.to_numpy()]
