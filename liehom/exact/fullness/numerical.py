"""The decision over floats."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeAlias, final

import numpy as np

from liehom.base.typing import Array
from liehom.exact.algebra.core.jacobi import jacobi_tolerance
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.fullness.verdict import NumericallyFull, NumericallyNotFull, NumericallyUndecided
from liehom.exact.representations.core.pair import Pair
from liehom.exact.scalars.floating import RR, FloatField

# Let z_i be an orthonormal basis of h as given, W its orthogonal complement, and T_i the traceless part of rho(z_i) in
# coordinates on W. The structure constants c and the rows of h have errors, so the pair that is meant has other ones:
# c' with |c' - c| <= e, and h' with the basis z_i + G z_i for a map G from h to W of norm at most y. (If the rows have
# the error e_h and the smallest singular value s, then y = r / (1 - r) with r = e_h / s.) In this basis of h', and on
# g/h' with the coordinates of W, the isotropy is T_i + E_i + L(G)_i up to multiples of 1, where
#     L(G)_i w = [G z_i, w]_W - G [z_i, w]_h,   |(E_i w)_i| <= (1 + y^2) e / sqrt 2 + y^2 |[W, W]_h|   for a unit w;
# sqrt 2 because c is antisymmetric, and brackets are those of c. The same holds for |E_i| of one unit element z_i, and
# for the matrices of ad on h', with [G z_i, z_j]_h + [z_i, G z_j]_h in place of L(G). Nothing is left out.
#
# As h' is closed, and conjugation changes no answer, G is smaller in most directions. Among the limits of conjugates of
# h' under inner automorphisms of c' take the one with the least |G|. A pair is full, or dominated, if a limit is. There
#     D(G)(i, j) = [G z_i, z_j]_W + [z_i, G z_j]_W - G [z_i, z_j]_h   is at most
#     a = |[h, h]_W| + (1 + y^2)^(3/2) e + y^2 (|[W, .]_W| + 2 |[W, h]_h| + y |[W, W]_h|)
# since h' is closed, and the sum of <G z_i, rho(z_i) w> is at most b = y |error of all T_i| for a unit w, since
# conjugation by exp(t ad w) does not decrease |G|. So |D(G)|^2 / a^2 + |D_0(G)|^2 / b^2 + |G|^2 / y^2 <= 3.

MAX_MOVES = 3 * 10**6
"""Numbers in the array of D(G) up to which the conditions on G are used."""


@final
@dataclass(frozen=True, slots=True)
class FloatAction:
    """The isotropy of a pair over floats, and of all pairs within its error.

    Within the error the matrices, as a stack, are `matrices` + sum_s y_s `moves[s]` + E with |y| <= 1 and E at most
    `error` in the sense of the comment above; the matrices of ad on h likewise.
    """

    matrices: Array  # (k, d, d), the T_i
    error: float
    moves: Array  # (s, k, d, d)
    adjoint: Array  # (k, k, k)
    adjoint_error: float
    adjoint_moves: Array  # (s, k, k, k)
    lift: Array  # (d, n), orthonormal rows: the coordinates on g/h
    size: float  # number by which rounding errors are multiplied in the T_i
    defect: float  # relative errors of the data within which they can satisfy the axioms


def spectral_norm(array: Array, axes: int) -> float:
    """Largest singular value of an array as a matrix, with its first axes as rows; 0 if it is empty."""
    rows = int(np.prod(array.shape[:axes]))
    return float(np.linalg.norm(array.reshape(rows, -1), 2)) if array.size else 0.0


def traceless(matrices: Array) -> Array:
    """Matrices (..., d, d) without their traces."""
    d = matrices.shape[-1]
    return np.asarray(matrices - (np.trace(matrices, axis1=-2, axis2=-1) / d)[..., None, None] * np.eye(d))


def float_action(pair: Pair, *, rtol: float | None = None, conjugated: bool = False) -> FloatAction:
    """`FloatAction` with the error of the data, or with another relative one.

    If `conjugated`, G is restricted by the conditions D(G) and D_0(G), which takes more time.
    """
    n, d, k = pair.algebra.dimension, pair.dimension, pair.subalgebra.dimension
    exact = pair.field.exact
    constants = (pair.algebra.over(RR) if exact else pair.algebra).table
    table: Any = constants.flat()
    rows: Any = RR.matrix(pair.subalgebra.basis.to_numpy(), (k, n)) if exact else pair.subalgebra.basis
    _, values, both = np.linalg.svd(rows.array)
    least = float(values[-1]) if k else 1.0
    e = table.error if rtol is None else rtol * table.norm
    r = (rows.error if rtol is None else rtol * rows.norm) / least
    y = r / (1 - r) if r < 1 else 1.0
    c = np.einsum("ai,bj,ijl,cl->abc", both, both, table.array.reshape(n, n, n), both, optimize=True)
    h, w = slice(0, k), slice(k, n)
    across, inside, twice = (spectral_norm(c[w, x, z], 1) for x, z in ((w, w), (h, h), (w, h)))
    own, outside = (1 + y * y) * e / 2**0.5 + y * y * twice, spectral_norm(c[h, h, w], 0)
    error = own + y * (across + spectral_norm(c[h, w, h], 2)) if r < 1 else np.inf
    adjoint_error = own + 2 * y * inside if r < 1 else np.inf
    moves = np.zeros((0, k, d))
    if conjugated and 0 < error < np.inf and (k * d) * k * k * d <= MAX_MOVES:
        closing = outside + (1 + y * y) ** 1.5 * e + y * y * (across + 2 * inside + y * twice)
        moves = _least_graphs(c, k, closing, y * error, y)
        error = adjoint_error = own
    leaving = np.einsum("sia,ajl->silj", moves, c[w, w, w]) - np.einsum("ijb,sbl->silj", c[h, w, h], moves)
    turned = np.einsum("sia,ajl->silj", moves, c[w, h, h]) - np.einsum("sja,ail->silj", moves, c[w, h, h])
    size = table.norm * (1 + 2 * rows.norm / least)
    return FloatAction(
        matrices=traceless(c[h, w, w].transpose(0, 2, 1)),
        error=error,
        moves=traceless(leaving),
        adjoint=c[h, h, h].transpose(0, 2, 1),
        adjoint_error=adjoint_error,
        adjoint_moves=turned,
        lift=both[k:],
        size=size,
        defect=max(jacobi_tolerance(constants), outside / (size or 1.0)),
    )


def _least_graphs(c: Array, k: int, closing: float, orthogonal: float, y: float) -> Array:
    """Maps G_s, shape (s, k, d), such that every G with the three bounds above is sum_s y_s G_s with |y| <= 1."""
    h, w = slice(0, k), slice(k, len(c))
    d = len(c) - k
    maps = np.eye(k * d).reshape(k * d, k, d)
    moved = np.einsum("sia,ajl->sijl", maps, c[w, h, w])
    closed = moved - moved.transpose(0, 2, 1, 3) - np.einsum("ijb,sbl->sijl", c[h, h, h], maps)
    first = closed.reshape(k * d, -1) / closing
    second = np.einsum("sjl,jal->sa", maps, c[h, w, w]) / orthogonal
    left, values, _ = np.linalg.svd(np.concatenate([first, second, np.eye(k * d) / y], axis=1), full_matrices=False)
    return np.asarray((left / np.maximum(values, 1 / y) * 3**0.5).T.reshape(k * d, k, d))


# Inner products in which a span of matrices is self-adjoint, and the test that its compact part is transitive.
#
# Let L0 be a Lie algebra of traceless matrices on V = R^d, d >= 2. The pair is full if and only if, in some inner
# product, the skew-symmetric elements K of L0 satisfy dim K x = d - 1 at one x != 0 (theorem 2 of
# docs/theory/fullness.md). If L0 is reductive, then L0 is self-adjoint in some inner product (Mostow), and K is as
# large as possible there. For an orthonormal basis E_a of the span of g L0 g^-1 the volume of g E_a g^-1 is convex
# along g = exp(X), X symmetric, with the gradient M = sum_a [E_a, E_a^T]. The volume is least if and only if the span
# is self-adjoint. Newton's method minimizes it.
#
# With inexact matrices all of this is approximate, and only proposes skew-symmetric matrices K_b that are orthonormal.
# Whatever they are, let v(x) be the smallest singular value of N(x), the matrix with columns K_b x and x, at a unit
# vector x, and q the Frobenius norm of the parts of all [K_a, K_b] outside of the span. Along x' = A x with A in the
# span, N' = A N + N S + R with S skew-symmetric, since <[A, K_b], K_c> is antisymmetric in b and c, and |R| <= q |A|.
# So |v'| <= q |A|. To move with speed 1 in a given direction, |A| <= 1 / v is enough. Every vector is at most pi / 2
# from x or -x, hence v^2 >= v(x)^2 - pi q on the whole sphere. Let sum_i p_bi g (T_i + E_i + L(G)_i) g^-1 = K_b + R_b
# up to multiples of 1. By Weyl's inequality for singular values the pair is full if v > |(R_b x)_b| for all unit x.

STEPS, CONJUGATE_STEPS, SAMPLES = 80, 60, 8
MAX_CONDITION = 1e9
"""Condition of g beyond which the span has no self-adjoint position that floats can see."""


@final
@dataclass(frozen=True, slots=True)
class TransitiveGroup:
    """Skew-symmetric matrices K_b of g L0 g^-1, for the data as given, that are transitive on the unit sphere."""

    value: float  # the smallest singular value of [K_b x, x] is at least this at every unit vector x
    error: float  # bound on the change of this value within the error of the data
    point: Array  # a unit vector


def orthonormal_span(matrices: Array, bound: float) -> tuple[Array, Array]:
    """Singular values above a bound of matrices (k, d, d) as vectors, and an orthonormal basis (m, d, d)."""
    k, d = len(matrices), matrices.shape[1]
    _, values, right = np.linalg.svd(matrices.reshape(k, d * d), full_matrices=False)
    kept = values > bound
    return values[kept], right[kept].reshape(-1, d, d)


def transitive_group(matrices: Array, error: float, moves: Array) -> TransitiveGroup | None:
    """`TransitiveGroup` of the isotropy `matrices` + E + sum_s y_s `moves[s]`, or None if none was found."""
    d = matrices.shape[1]
    left, values, right = np.linalg.svd(matrices.reshape(len(matrices), d * d), full_matrices=False)
    rank = int((values > error + spectral_norm(moves, 1)).sum())
    if rank + 1 < d:
        return None
    g = self_adjoint_position(right[:rank].reshape(rank, d, d))
    condition = float(np.linalg.cond(g))
    if not condition < MAX_CONDITION:
        return None
    inverse, members = np.linalg.inv(g), left[:, :rank].T
    moved = (g @ np.tensordot(members, matrices, 1) @ inverse).reshape(rank, d * d)
    left, values, right = np.linalg.svd(moved, full_matrices=False)
    turned = right.reshape(rank, d, d)
    skew = (turned - turned.transpose(0, 2, 1)).reshape(rank, d * d) / 2
    weights, parts, compact = np.linalg.svd(skew, full_matrices=False)
    m = int((parts > 0.5).sum())  # the values are 0 and 1
    if m + 1 < d:
        return None
    compact = compact[:m].reshape(m, d, d)
    members = weights[:, :m].T / parts[:m, None] @ (left / values).T @ members  # p_bi
    points = np.random.default_rng(rank).standard_normal((SAMPLES, d))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    values = np.linalg.svd(np.einsum("aij,nj->nia", compact, points), compute_uv=False)[:, d - 2]
    least = float(values.max()) ** 2 - np.pi * _not_closed(compact)
    rest = g @ np.tensordot(members, matrices, 1) @ inverse - compact
    value = max(least, 0.0) ** 0.5 - spectral_norm(rest, 2)
    if not value > 0:
        return None
    moves = g @ np.tensordot(members, moves, (1, 1)).swapaxes(0, 1) @ inverse
    error = condition * spectral_norm(members, 1) * error + spectral_norm(moves, 1)
    point = np.linalg.solve(g, points[values.argmax()])
    return TransitiveGroup(value, error, point / np.linalg.norm(point))


def _not_closed(basis: Array) -> float:
    """Frobenius norm of the parts of all commutators of an orthonormal basis (m, d, d) outside of its span."""
    span, square = basis.reshape(len(basis), -1), 0.0
    for a in basis:
        brackets = (a @ basis - basis @ a).reshape(span.shape)
        square += float(np.sum((brackets - brackets @ span.T @ span) ** 2))
    return square**0.5


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


# Dominance (theorem 4 of docs/theory/fullness.md) for all data within the error. Let X be in h, c > e > 0, W the sum of
# the generalized eigenspaces of rho(X) for eigenvalues with Re > c, and n the number of eigenvalues of ad X on h with
# Re <= -e. If no eigenvalue of rho(X) has Re in [c - e, c], then the eigenspaces of ad X with Re > -e map W to W, so
# dim (rho(h) x + R x) <= dim W + n for every x in W, and the pair is not full if this is less than d. The same is true
# with |Im| in place of Re for rho(X), and |Im| >= e for ad X. These conditions are open. They hold within the error if
# they hold for intervals that contain the real parts of all eigenvalues, multiplied by f = 1 or f = -i.
#
# X is proposed by iterations: the trace form of the next X is that of the projection to the eigenspaces of X at the
# largest real part. Its limits are dual to highest weights. Then an element that acts by 0 on g/h is added to X, with
# the largest trace of ad on all such elements, so that few of them count in n.

ATTEMPTS, ITERATIONS, SHIFTS = 6, 4, (0.0, 2.0, 8.0)
CLUSTER = 1e-2
"""Real parts that differ by less, relative to the largest modulus, are enclosed together."""

Interval: TypeAlias = tuple[float, float, int]
"""Bounds and the number of eigenvalues whose real parts are between them."""


def real_parts(matrix: Array, error: float, moves: Array) -> list[Interval]:
    """Intervals for the real parts of eigenvalues of `matrix` + E + sum_s y_s `moves[s]`, |E| <= `error`, |y| <= 1."""
    values, vectors = np.linalg.eig(matrix)
    order = np.argsort(values.real)
    cuts = np.flatnonzero(np.diff(values.real[order]) > CLUSTER * np.abs(values).max()) + 1
    basis = np.concatenate([np.linalg.svd(vectors[:, i])[0][:, : len(i)] for i in np.split(order, cuts)], axis=1)
    condition = float(np.linalg.cond(basis))
    if not condition < MAX_CONDITION:
        return [(-np.inf, np.inf, len(matrix))]
    inverse = np.linalg.inv(basis)
    outside = inverse @ matrix @ basis
    blocks, parts = [slice(i[0], i[-1] + 1) for i in np.split(np.arange(len(matrix)), cuts)], []
    for block in blocks:
        part = outside[block, block]
        parts.append(np.linalg.eigvalsh((part + part.conj().T) / 2))
        outside[block, block] = 0
    # farther than this from the numerical ranges of the blocks, the blocks minus z are larger than what was left out
    radius = condition * error + spectral_norm(inverse @ moves @ basis, 1) + spectral_norm(outside, 1)
    return [(float(part[0]) - radius, float(part[-1]) + radius, len(part)) for part in parts]


def _disjoint(intervals: list[Interval], *, folded: bool) -> list[Interval]:
    """Unions of intervals that meet, the highest first; if `folded`, of their absolute values."""
    if folded:
        intervals = [(max(low, -high, 0.0), max(high, -low), number) for low, high, number in intervals]
    found: list[Interval] = []
    for low, high, number in sorted(intervals, key=lambda i: -i[1]):
        if found and high >= found[-1][0]:
            before = found.pop()
            low, high, number = min(low, before[0]), before[1], number + before[2]
        found.append((low, high, number))
    return found


def _dominates(action: FloatAction, x: Array, f: complex) -> bool:
    """Whether the element with the coefficients x, |x| = 1, shows that no pair within the error is full."""
    matrix, moves = np.tensordot(x, action.matrices, 1), np.tensordot(x, action.moves, (0, 1))
    intervals = _disjoint(real_parts(f * matrix, action.error, f * moves), folded=f != 1)
    if len(intervals) == 1:
        return False
    matrix, moves = np.tensordot(x, action.adjoint, 1), np.tensordot(x, action.adjoint_moves, (0, 1))
    roots = _disjoint(real_parts(-f * matrix, action.adjoint_error, -f * moves), folded=f != 1)
    above = 0
    for (low, _, number), (_, high, _) in pairwise(intervals):
        above += number
        if above + sum(n for _, top, n in roots if top >= low - high) < action.matrices.shape[1]:
            return True
    return False


def dominated_vector(action: FloatAction) -> Array | None:
    """A vector of W of an element that shows that no pair within the error is full, or None if none was found."""
    (k, d), rng = action.matrices.shape[:2], np.random.default_rng(0)
    flat = action.matrices.reshape(k, d * d)
    left, values, _ = np.linalg.svd(flat, full_matrices=k > d * d)
    rank = int((values > action.error + spectral_norm(action.moves, 1)).sum())
    acting, still = left[:, :rank], left[:, rank:]
    traces = np.einsum("ia,ijl,lb,jb->a", still, action.adjoint, still, still, optimize=True)
    length = float(np.linalg.norm(traces))
    shifts = SHIFTS if length > CLUSTER * float(np.linalg.norm(action.adjoint)) else SHIFTS[:1]
    shift = still @ traces / (length or 1.0)
    dual = np.linalg.pinv(np.einsum("aij,bji->ab", action.matrices, action.matrices), rcond=1e-4, hermitian=True)
    for f in (1.0, -1j) * ATTEMPTS if rank else ():
        x = acting @ rng.standard_normal(rank)
        for i in range(ITERATIONS):
            length = float(np.linalg.norm(x))
            if not length > 0:
                break
            x = x / length
            values, vectors = np.linalg.eig(f * np.tensordot(x, action.matrices, 1))
            top = values.real >= values.real.max() - CLUSTER * np.abs(values).max()
            for s in shifts:
                if _dominates(action, (x + s * shift) / np.linalg.norm(x + s * shift), f):
                    vector = vectors[:, top][:, 0]
                    return np.asarray((vector / vector[np.abs(vector).argmax()]).real)
            projection = vectors[:, top] @ np.linalg.pinv(vectors)[top]
            x = (f * np.einsum("aij,ji->a", action.matrices, projection)).real
            x = dual @ x if i % 2 == 0 else x
    return None


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
# Full and dominated are open conditions, and they are answered if they hold for all data within the error
# (`transitive_group`, `dominated_vector`), whatever has been found by a search. The bounds are those of real numbers;
# a gap of 2 leaves room for rounding.
#
# Not full is not an open condition in general: data nearby may be full, so no size of an error can exclude it. It is
# also answered for the data as given, if an x was found with sigma_d(x) at most 2^12 units of round-off. Here
# sigma_d(x) is the smallest singular value of the matrix with columns T_i x and x, relative to the norm of the data.
# Data that are computed, in a rotated basis say, are off by a few hundred units; a value above this level is not a
# zero. The basis elements of g can have units of very different sizes, so the same must hold after they are rescaled
# such that all structure constants have similar sizes. The cases in between are undecided.

NumericalVerdict: TypeAlias = NumericallyFull | NumericallyNotFull | NumericallyUndecided
"""A result of `decide_numerically`."""

MIN_GAP = 2.0
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
        If every pair within the error of the data is full, with a gap of at least 2.
    NumericallyNotFull
        If no pair within the error of the data is full; or if the rank drops at some eta up to rounding, and the data
        satisfy the axioms up to rounding. Rounding alone can cause the second.
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
    k, action = pair.subalgebra.dimension, float_action(pair)
    if k + 1 < d:
        reason = f"dim h + 1 = {k + 1} is less than dim g/h = {d}, whatever the numbers are"
        return NumericallyNotFull(pair, reason, 0.0, rtol / 1e-300, _eta(action, np.eye(d)[0]))
    for conjugated in (False, True):
        action = float_action(pair, conjugated=True) if conjugated else action
        group = transitive_group(action.matrices, action.error, action.moves)
        if group is not None and group.value >= MIN_GAP * group.error:
            return _full(pair, group, action)
        if (x := dominated_vector(action)) is not None:
            return _not_full(pair, action, rtol, x)
    value, x = _least(action, starts, seed)
    rounding = min(ROUNDING, rtol)
    if group is not None and not group.value * rtol > group.error * rounding:
        group = None  # rounding alone can cause it
    if max(value, action.defect) > rounding or group is not None:
        return _undecided(pair, group, rtol, action, value, x)
    if _is_above_rounding(_rescaled(pair), rounding, starts, seed):
        reason = (
            f"an eta with sigma_d = {value:.1e} relative to the data was found, but it is not zero up to the rounding "
            f"level {rounding:.1e} after the basis of g is rescaled, and the error of the data is {rtol:.1e}"
        )
        return NumericallyUndecided(pair, reason, value, value / rtol, _eta(action, x))
    reason = (
        f"an eta with sigma_d = {value:.1e} relative to the data was found, zero up to the rounding level "
        f"{rounding:.1e}; rounding alone can cause it, since data within the error {rtol:.1e} can be full"
    )
    return NumericallyNotFull(pair, reason, value, rtol / max(value, 1e-300), _eta(action, x))


def _columns(action: FloatAction) -> Array:
    """Matrices A_a, the T_i relative to the data and a multiple of 1, such that sigma_d(x) is that of the A_a x."""
    d = action.matrices.shape[1]
    values, basis = orthonormal_span(action.matrices, 0.0)
    return np.concatenate([values[:, None, None] * basis / (action.size or 1.0), np.eye(d)[None] / d**0.5])


def _least(action: FloatAction, starts: int, seed: int) -> tuple[float, Array]:
    """The least sigma_d that was found, and x."""
    return least_singular_value(_columns(action), starts=starts, seed=seed)


def _is_above_rounding(pair: Pair, rounding: float, starts: int, seed: int) -> bool:
    """Whether the data as given are full, or sigma_d is not zero up to rounding."""
    if pair.subalgebra.basis.rank() < pair.subalgebra.dimension:
        return True
    action = float_action(pair, rtol=rounding)
    group = transitive_group(action.matrices, action.error, action.moves)
    return (group is not None and group.value > group.error) or _least(action, starts, seed)[0] > rounding


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


def _full(pair: Pair, group: TransitiveGroup, action: FloatAction) -> NumericallyFull:
    gap = group.value / max(group.error, 1e-300)
    reason = (
        f"sigma_d = {group.value:.3g} at every eta, {gap:.1e} times its error {group.error:.1e}, since a compact "
        "group of the isotropy is transitive on the directions of g/h"
    )
    return NumericallyFull(pair, reason, group.value, gap, _eta(action, group.point))


def _not_full(pair: Pair, action: FloatAction, rtol: float, x: Array) -> NumericallyNotFull:
    x = x / np.linalg.norm(x)
    value = smallest(_columns(action), x)[0]
    reason = (
        f"sigma_d = {value:.1e} relative to the data at an eta that an element of h contracts, and the eigenvalues of "
        f"this element show rank below {len(x)} for all data within the error {rtol:.1e}"
    )
    return NumericallyNotFull(pair, reason, value, rtol / max(value, 1e-300), _eta(action, x))


def _undecided(
    pair: Pair, group: TransitiveGroup | None, rtol: float, action: FloatAction, value: float, x: Array
) -> NumericallyUndecided:
    if group is not None:
        gap = group.value / group.error
        reason = (
            f"sigma_d = {group.value:.3g} at every eta, but its error is {group.error:.1e}, a gap of {gap:.1e} "
            f"where {MIN_GAP:.0f} is needed"
        )
        return NumericallyUndecided(pair, reason, group.value, gap, _eta(action, group.point))
    gap = value / rtol
    reason = (
        f"nothing was found that holds for all data within the error {rtol:.1e}; for an answer about the numbers as "
        f"given, the least sigma_d found, {value:.1e} relative to the data, and the relative error {action.defect:.1e} "
        f"with which they satisfy the axioms would have to be at most the rounding level {ROUNDING:.1e}"
    )
    return NumericallyUndecided(pair, reason, value, gap, _eta(action, x))


def _eta(action: FloatAction, x: Array) -> list[float]:
    """Coefficients in the basis of g of the element that x represents."""
    return [float(v) for v in x @ action.lift]
