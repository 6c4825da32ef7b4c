"""Inner products in which a span of matrices is self-adjoint, and the test that its compact part is transitive.

Let L0 be a Lie algebra of traceless matrices on V = R^d, d >= 2. The pair is full if and only if, in some inner
product, the skew-symmetric elements K of L0 satisfy dim K x = d - 1 at one x != 0 (theorem 2 of
docs/theory/fullness.md). If L0 is reductive, then L0 is self-adjoint in some inner product (Mostow), and K is as large
as possible there. For an orthonormal basis E_a of the span of g L0 g^-1 the volume of g E_a g^-1 is convex along g =
exp(X), X symmetric, with the gradient M = sum_a [E_a, E_a^T]. The volume is least if and only if the span is
self-adjoint. Newton's method minimizes it.

Let K_b be an orthonormal basis of K. If K is transitive on the unit sphere, then the smallest singular value of the
matrix with columns K_b x and x is the same at every unit vector x, because the group of K acts on K by orthogonal maps.
One x shows its minimum over the sphere.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from liehom.typing import Array

STEPS, CONJUGATE_STEPS, SAMPLES = 80, 60, 8
MAX_CONDITION = 1e9
"""Condition of g beyond which the span has no self-adjoint position that floats can see."""
SELF_ADJOINT = 1e-6
"""Largest part of a transposed unit element outside of a span that is called self-adjoint."""


@final
@dataclass(frozen=True, slots=True)
class TransitiveGroup:
    """An inner product |g x|^2 whose orthogonal group meets the group of L0 in a transitive one.

    Attributes
    ----------
    value : float
        Smallest singular value of [K_b x, x] at every unit vector x, at most 1.
    smallest : float
        An error e of the matrices g A g^-1, with A as given, changes the K_b by at most e / smallest.
    condition : float
        Condition number of g.
    point : Array
        A unit vector, in the given coordinates, at which `value` was computed.
    """

    value: float
    smallest: float
    condition: float
    point: Array


def orthonormal_span(matrices: Array, bound: float) -> tuple[Array, Array]:
    """Singular values above a bound of matrices (k, d, d) as vectors, and an orthonormal basis (m, d, d) of their span.

    Examples
    --------
    >>> values, basis = orthonormal_span(np.array([np.eye(2), 1e-17 * np.ones((2, 2))]), 1e-9)
    >>> np.round(values, 3).tolist(), basis.shape
    ([1.414], (1, 2, 2))
    """
    k, d = len(matrices), matrices.shape[1]
    _, values, right = np.linalg.svd(matrices.reshape(k, d * d), full_matrices=False)
    kept = values > bound
    return values[kept], right[kept].reshape(-1, d, d)


def transitive_group(matrices: Array, bound: float) -> TransitiveGroup | None:
    """`TransitiveGroup` of the Lie algebra that traceless matrices span, or None if none was found.

    Parameters
    ----------
    matrices : Array
        Shape (k, d, d), traceless, d >= 2.
    bound : float
        Singular values up to this bound do not count for the span.

    Examples
    --------
    >>> turn = np.array([[[0.0, -4.0], [1.0, 0.0]]])
    >>> found = transitive_group(turn, 1e-9)
    >>> round(found.value, 4), round(found.smallest, 4), round(found.condition, 4)
    (0.7071, 2.8284, 2.0)
    >>> transitive_group(np.array([[[0.0, 1.0], [0.0, 0.0]]]), 1e-9) is None
    True
    """
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
    """Matrix g, (d, d), such that the span of g A g^-1 is nearly self-adjoint, if there is one.

    Examples
    --------
    >>> g = self_adjoint_position(np.array([[[0.0, -4.0], [1.0, 0.0]]]))
    >>> round(float(g[1, 1] / g[0, 0]), 4)
    2.0
    """
    d = basis.shape[1]
    g, current = np.eye(d), basis
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
