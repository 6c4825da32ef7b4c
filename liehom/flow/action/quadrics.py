"""Orbits in closed form: products of quadrics, and orbits with equal singular values, their inverses and frames."""

from __future__ import annotations

from fractions import Fraction
from typing import Any, NamedTuple, cast, final

import numpy as np

from liehom.base.typing import Array, BooleanArray, IntegerArray, Values
from liehom.flow.action.frames import TightFrame
from liehom.flow.action.invariants import (
    DENOMINATOR,
    FORM_RTOL,
    GRADIENT_RTOL,
    invariant_polynomials,
    monomials,
    times,
)
from liehom.flow.action.maps import connected, matrices_of
from liehom.flow.action.space import Action
from liehom.flow.door import Representation
from liehom.flow.series.arrays import namespace
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.loop import while_loop

# Orbits that are open in a product of quadrics and affine spaces, and the projection onto them.
#
# Spheres, hyperboloids, light cones and products of them are orbits of this kind. The coordinates of V fall into blocks
# such that rho(x) maps V to a sum over the blocks. If a block V_b of dimension n_b has an invariant symmetric form Q_b,
# all orbits lie on its level sets m^T Q_b m = c_b, of dimension n_b - 1. An orbit whose dimension is that of the
# product of these level sets is open in it, so that a point of the product near the orbit is a point of the orbit.

MAX_BLOCK = 24
"""Largest block of which forms other than the scalar product are sought: their equations are n^2 by n (n + 1) / 2."""


class Block(NamedTuple):
    """Coordinates on which the group preserves a symmetric form."""

    indices: tuple[int, ...]
    form: Array | None  # Q, (n, n); None for the scalar product


@final
class Quadrics:
    """Level sets of invariant forms of a representation, and the projection onto them."""

    blocks: tuple[Block, ...]

    __slots__ = ("blocks", "size")

    def __init__(self, size: int, blocks: tuple[Block, ...]) -> None:
        self.size: int = size
        self.blocks = blocks

    def levels(self, m: Values) -> Values:
        """The values m^T Q_b m of the forms, shape (..., number of blocks)."""
        return namespace(m).stack([self._value(block, self._part(block, m)) for block in self.blocks], axis=-1)

    def project(self, m: Values, levels: Values) -> Values:
        """The point m + lambda Q m of the level sets with the smallest |lambda|, for m (..., N) near them.

        On a sphere it is the multiple of m that has the right norm.
        """
        parts = [self._projected(block, self._part(block, m), levels[..., b]) for b, block in enumerate(self.blocks)]
        if len(parts) == 1 and len(self.blocks[0].indices) == self.size:
            return parts[0]
        columns: list[Any] = [m[..., i] for i in range(self.size)]
        for block, part in zip(self.blocks, parts, strict=True):
            for j, i in enumerate(block.indices):
                columns[i] = part[..., j]
        return namespace(m).stack(columns, axis=-1)

    def _part(self, block: Block, m: Values) -> Values:
        if len(block.indices) == self.size:
            return m
        return namespace(m).stack([m[..., i] for i in block.indices], axis=-1)

    @staticmethod
    def _value(block: Block, m: Values) -> Values:
        return (m * (m if block.form is None else times(m, block.form))).sum(axis=-1)

    def _projected(self, block: Block, m: Values, level: Values) -> Values:
        if block.form is None:
            return cast(Values, m * _to_level((m * m).sum(axis=-1), level)[..., None])
        gradient = times(m, block.form)
        square, missing = (gradient * gradient).sum(axis=-1), level - (m * gradient).sum(axis=-1)
        # (m + x g)^T Q (m + x g) = level is a quadratic equation in x
        share, curvature = missing / square, self._value(block, gradient) / square
        return m + (share / (1 + namespace(m).sqrt(1 + share * curvature)))[..., None] * gradient


NEAR_LEVEL = 4e-3
"""Relative distance of |m|^2 to its level up to which the root of their quotient is a polynomial of degree 6."""
ROOT_SERIES = (-1 / 2, 3 / 8, -5 / 16, 35 / 128, -63 / 256, 231 / 1024)
"""Taylor coefficients of (1 + r)^(-1/2)."""


def _to_level(square: Values, level: Values) -> Values:
    """The root of level / square. Compiled code takes a polynomial in blocks of lanes that are all near the level."""
    if not isinstance(square, Traced) or not square.tape.branching:
        return cast(Values, namespace(square).sqrt(level / square))
    r = square / level - 1.0
    a, b, c, d, e, f = ROOT_SERIES
    near = 1.0 + r * ((a + b * r) + (r * r) * ((c + d * r) + (r * r) * (e + f * r)))

    def exact(far: Traced, square: Traced, near: Traced) -> tuple[list[Traced], Values]:
        return [far, square, cast(Traced, np.where(far, np.sqrt(level / square), near))], np.zeros((), bool)

    return while_loop(exact, [~(np.abs(r) <= NEAR_LEVEL), square, near], square.tape, 1, guarded=True)[2]


def quadric_orbits(representation: Representation, dimension: int | IntegerArray, points: Array) -> Quadrics | None:
    """The `Quadrics` in whose level sets the orbits of points are open, or None if there are none."""
    matrices = matrices_of(representation)
    moving = np.abs(matrices).max(axis=(0, 2), initial=0.0) > 0  # the other coordinates are constant
    linked = np.argwhere((np.abs(matrices).max(axis=0, initial=0.0) > 0) & moving & moving[:, None])
    parts = [part for part in connected(linked.tolist(), len(moving)) if moving[part[0]]]
    dimensions = np.unique(np.asarray(dimension))
    if len(dimensions) != 1:
        return None
    missing = int(moving.sum()) - int(dimensions[0])
    if not 0 <= missing <= len(parts):
        return None
    blocks = tuple(block for part in parts if (block := _with_form(matrices, part)) is not None) if missing else ()
    smooth = len(blocks) == missing and _are_smooth(blocks, np.asarray(points, dtype=float))
    return Quadrics(representation.size, blocks) if smooth else None


def _with_form(matrices: Array, indices: list[int]) -> Block | None:
    """The block with an invariant form, or None if it has none or depends on constant coordinates."""
    if np.abs(np.delete(matrices[:, indices], indices, axis=2)).max(initial=0.0) > 0:
        return None
    inside = matrices[:, indices][:, :, indices]
    size = float(np.abs(inside).max(initial=0.0))
    if np.abs(inside + np.swapaxes(inside, 1, 2)).max(initial=0.0) <= FORM_RTOL * size:
        return Block(tuple(indices), None)
    form = invariant_form(inside / size) if len(indices) <= MAX_BLOCK else None
    return None if form is None else Block(tuple(indices), form)


def invariant_form(matrices: Array) -> Array | None:
    """An invariant symmetric form Q, of largest entry 1, by the kernel of Q -> A^T Q + Q A; None if there is none.

    Of several forms it is the one nearest to the scalar product.
    """
    n = matrices.shape[-1]
    basis = invariant_polynomials(matrices, 2)
    if not basis.shape[1]:
        return None
    first, second = monomials(n, 2).T
    nearest = basis @ (basis.T @ (first == second).astype(float))
    if np.abs(nearest).max() <= GRADIENT_RTOL:
        nearest = basis[:, 0]
    form = np.zeros((n, n))
    form[first, second] = nearest
    form = (form + form.T) / np.abs(form + form.T).max()
    near = np.array([float(Fraction(float(x)).limit_denominator(DENOMINATOR)) for x in form.ravel()]).reshape(n, n)
    form = near if np.abs(form - near).max() <= FORM_RTOL else form
    defect = np.abs(np.swapaxes(matrices, 1, 2) @ form + form @ matrices).max()
    return form if defect <= FORM_RTOL else None


def _are_smooth(blocks: tuple[Block, ...], points: Array) -> bool:
    """Whether the gradients Q m of the forms are not near 0 at points (..., N)."""
    for block in blocks:
        part = points[..., list(block.indices)]
        form: Array = np.eye(part.shape[-1]) if block.form is None else block.form
        size = np.linalg.norm(form, 2) * np.linalg.norm(part, axis=-1)
        if not bool((np.linalg.norm(part @ form, axis=-1) > GRADIENT_RTOL * size).all()):
            return False
    return True


# The inverse of x -> rho(x) m in closed form, on orbits on which all its singular values agree.
#
# Let K be an invariant symmetric form on V and G the inner product on g, with A = [rho(e_1) m, ..., rho(e_r) m]. If
#
#     A G^-1 A^T K A = lambda A,      lambda = tr(A G^-1 A^T K) / d,      d the dimension of the orbit,
#
# then B = G^-1 A^T K / lambda is a right inverse of A on the tangent space, and B A is the projector along the isotropy
# algebra. This is so if the isotropy acts irreducibly on the tangent space, as on spheres, projective spaces and other
# irreducible symmetric orbits.

TIGHT_RTOL = 1e-11
"""Largest defect of the condition, relative to lambda and the largest entry of A."""
SAMPLES = 16
"""Number of points at least that are moved along their orbits; fewer initial points are used several times."""


class TightInverse(NamedTuple):
    """Data of B = G^-1 A^T K / lambda."""

    form: Array  # K, (N, N)
    gram_inverse: Array  # G^-1, (dim g, dim g)
    trace: Array  # (N, N): the form m -> tr(A G^-1 A^T K) / d, which is lambda
    constant: bool  # whether lambda is constant along orbits

    def over(self, m: Values) -> Values:
        """1 / lambda at points m (..., N), shape (...,); for a tracer a constant of the trajectory if it is one."""
        trace = self.trace

        def inverse(points: Values) -> Values:
            return 1.0 / ((points @ trace) * points).sum(axis=-1)

        if self.constant and isinstance(m, Traced):
            return Traced(m.tape, m.tape.trajectory_constant(inverse))
        return inverse(m)

    def lifted(self, action: Action, m: Values, v: Values, over: Values) -> Values:
        """B v at the point m, shape (..., dim g), for v of shape (..., N) and 1 / lambda of shape (...,)."""
        return (action.infinitesimal.right_transposed(m, v @ self.form) @ self.gram_inverse) * over[..., None]


def tight_inverse(action: Action, points: Array, rank: int) -> TightInverse | None:
    """The inverse on the orbits of points, all of one dimension, or None if it has no closed form."""
    size = action.representation.size
    flat = points.reshape(-1, size)
    if rank < 1 or not len(flat) or size > MAX_BLOCK:
        return None
    matrices = matrices_of(action.representation)
    form = invariant_form(matrices / max(float(np.abs(matrices).max(initial=0.0)), 1e-300))
    if form is None:
        return None
    gram_inverse = np.linalg.inv(action.inner_product.matrix).astype(np.float64)
    corners = np.asarray(action.infinitesimal.right(np.eye(size)))
    trace = (corners @ gram_inverse).reshape(size, -1) @ (form.T @ corners).reshape(size, -1).T / rank
    inverse = TightInverse(form, gram_inverse, (trace + trace.T) / 2, action.inner_product.invariant)
    if not inverse.constant:
        rows = np.arange(max(len(flat), SAMPLES)) % len(flat)
        x = np.random.default_rng(0).normal(size=(len(rows), action.dimension)) / max(1.0, action.max_norm)
        flat = np.concatenate([flat, np.asarray(action.act(x, flat[rows]))])
    return inverse if _holds(action, inverse, flat) else None


def _holds(action: Action, inverse: TightInverse, points: Array) -> bool:
    """Whether A G^-1 A^T K A = lambda A with lambda other than 0 at points (L, N), to round-off."""
    points = points / np.abs(points).max(axis=-1, keepdims=True)  # the condition is that of all multiples of a point
    columns = action.infinitesimal.right(points)
    scale = np.abs(over := ((points @ inverse.trace) * points).sum(axis=-1))
    square = columns @ inverse.gram_inverse @ np.swapaxes(columns, 1, 2)
    # lambda is at most |K| |A G^-1 A^T|, and 0 for a form that vanishes on the tangent space
    least = GRADIENT_RTOL * np.linalg.norm(inverse.form, 2) * np.linalg.norm(square, axis=(1, 2))
    defect = np.abs(square @ inverse.form @ columns - over[:, None, None] * columns).max(axis=(1, 2), initial=0.0)
    return bool(
        ((scale > least) & (defect <= TIGHT_RTOL * scale * np.abs(columns).max(axis=(1, 2), initial=0.0))).all()
    )


POINTS_AT_ONCE = 4096
"""Points whose matrices are in memory at once."""
OWN_STREAM = 20011
"""Second word of the seed: points that a caller drew with the same seed must not be the random tangent vectors too."""


def tight_frame(action: Action, points: Array, rank: int, seed: int = 0) -> TightFrame | None:
    """The tight frame of the orbits of points, all of one dimension, or None if their singular values differ.

    Both conditions, on the singular values of A and on the action of the isotropy on tangent vectors, are identities
    between polynomials. An orbit of a connected group is irreducible, so such an identity holds on all of it if it
    holds at a random point of it. It says nothing about another orbit. Therefore the conditions are checked, to
    round-off, on the orbit of each of the points, and `isotropy` must be one number for all of them. Where the group
    acts by orthogonal matrices on V and on g, both conditions hold on a whole orbit if they hold at one point of it,
    and the points themselves are used. Otherwise they are moved by random elements of the group.
    """
    if rank < 2 or not len(points):
        return None
    points = points / np.abs(points).max(axis=-1, keepdims=True)  # the conditions are of degree 3 in them
    rng = np.random.default_rng((seed, OWN_STREAM))
    basis = action.inner_product.orthonormal_basis()
    rows = np.arange(max(len(points), SAMPLES)) % len(points)
    mu, symmetric, orthogonal = None, True, _acts_orthogonally(action)
    for first in range(0, len(rows), POINTS_AT_ONCE):
        some = points[rows[first : first + POINTS_AT_ONCE]]
        if not bool(is_tight(action.infinitesimal.right(some) @ basis, rank).all()):
            return None
        if not orthogonal:
            x = rng.normal(size=(len(some), action.dimension))
            some = np.asarray(action.act(x / max(1.0, float(action.max_norm)), some))
            if not bool(is_tight(action.infinitesimal.right(some) @ basis, rank).all()):
                return None
        constant = _isotropy_constant(action, some, rank, rng, mu)
        if constant is None:
            return None
        mu, symmetric = constant[0], symmetric and constant[1]
    if mu is None:
        return None
    inverse: Any = np.linalg.inv(action.inner_product.matrix)
    corners = action.infinitesimal.right(np.eye(points.shape[-1]))
    trace = np.einsum("pia,ab,qib->pq", corners, inverse, corners)
    near = float(Fraction(mu).limit_denominator(256))
    return TightFrame(trace, near if abs(near - mu) <= 1e-12 * mu else mu, inverse, symmetric)


def _acts_orthogonally(action: Action) -> bool:
    """Whether the matrices rho(e_i) are skew-symmetric and the inner product on g is Ad-invariant."""
    matrices = action.infinitesimal.right(np.eye(action.infinitesimal.shape[1]))  # [j, :, i]: rho(e_i) e_j
    defect = np.abs(matrices + np.swapaxes(matrices, 0, 1)).max(initial=0.0)
    return action.inner_product.invariant and bool(defect <= TIGHT_RTOL * np.abs(matrices).max(initial=0.0))


def _isotropy_constant(
    action: Action, points: Array, rank: int, rng: np.random.Generator, before: float | None
) -> tuple[float, bool] | None:
    """`isotropy` and `symmetric` of a `TightFrame` at points; None unless `isotropy` is one number (`before`)."""
    basis = action.inner_product.orthonormal_basis()
    columns = action.infinitesimal.right(points) @ basis
    square = np.sum(columns * columns, axis=(-2, -1))[:, None, None] / rank
    tangent = columns @ np.swapaxes(columns, -1, -2) / square
    kernel = np.eye(columns.shape[-1]) - np.swapaxes(columns, -1, -2) @ columns / square
    u = (tangent @ rng.normal(size=(*points.shape, 1)))[..., 0]
    u = u / np.sqrt(np.sum(u * u, axis=-1, keepdims=True))
    across = action.infinitesimal.right(u) @ basis @ kernel
    squares = across @ np.swapaxes(across, -1, -2)
    normal = tangent - u[:, :, None] * u[:, None, :]
    mu = float(np.trace(squares[0]) / (rank - 1)) if before is None else before
    if not (mu > TIGHT_RTOL and float(np.abs(squares - mu * normal).max()) <= TIGHT_RTOL * max(mu, 1.0)):
        return None
    r = (tangent @ rng.normal(size=(*points.shape, 1)))[..., 0]
    turned = np.swapaxes(action.infinitesimal.right(u) @ basis, -1, -2) @ r[..., None]
    outside = np.abs(turned - kernel @ turned).max()
    return mu, bool(outside <= TIGHT_RTOL * max(1.0, float(np.abs(turned).max())))


def is_tight(matrix: Values, rank: int) -> BooleanArray:
    """Mask, shape (...,), of the matrices with A A^T A = lambda A, lambda = tr(A A^T) / rank."""
    a = np.ascontiguousarray(np.moveaxis(np.asarray(matrix), (-2, -1), (0, 1)))  # sums over all matrices at once
    square = np.einsum("pq...,pq...->...", a, a) / rank
    left = np.einsum("pr...,qr...->pq...", a, a)
    defect = np.einsum("pr...,rq...->pq...", left, a) - square * a
    return np.abs(defect).max(axis=(0, 1)) <= TIGHT_RTOL * (square * np.abs(a).max(axis=(0, 1)))
