"""The decision over floats."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeAlias, final

import numpy as np

from liehom.base.typing import Array
from liehom.exact.algebra.core.jacobi import failure_over_floats
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.fullness.verdict import NumericallyFull, NumericallyNotFull, NumericallyUndecided
from liehom.exact.representations.core.pair import Pair
from liehom.exact.scalars.floating import RR, FloatField

# Bounds of the isotropy of all pairs within the error of the data, proved in section 9 of docs/theory/fullness.md. The
# z_i are an orthonormal basis of h as given, and W is its orthogonal complement. The subalgebra that is meant has the
# basis z_i + G z_i with a map G from h to W, |G| <= y. In this basis, and with the coordinates of W on g/h, rho and ad
# change by linear functions of G and by at most e. G has three bounds, since h is closed and may be conjugated.

MAX_MOVES = 3 * 10**6  # numbers in the array of closure conditions up to which they are used


@final
@dataclass(frozen=True, slots=True)
class Enclosure:
    """Stacks of matrices `center` + E + sum_s y_s `moves[s]` with |y| <= 1.

    The E_i x together, for one unit vector x, and the combinations of the E_i by one unit vector, are at most `error`.
    """

    center: Array  # (k, d, d)
    error: float
    moves: Array  # (s, k, d, d)

    def element(self, x: Array, factor: complex) -> Enclosure:
        """The combination of the matrices by a unit vector x, times a complex factor of modulus 1."""
        f: Any = factor
        return Enclosure(f * np.tensordot(x, self.center, 1), self.error, f * np.tensordot(x, self.moves, (0, 1)))

    def span(self) -> tuple[Array, int]:
        """Left singular vectors (k, k) of the flat matrices, and the number of singular values above all errors."""
        k, square = len(self.center), self.center[0].size
        left, values, _ = np.linalg.svd(self.center.reshape(k, square), full_matrices=k > square)
        return left, int((values > self.error + spectral_norm(self.moves, 1)).sum())


@final
@dataclass(frozen=True, slots=True)
class FloatAction:
    """The isotropy of a pair over floats, and of all pairs within its error."""

    rho: Enclosure  # traceless parts of rho(z_i), (k, d, d)
    ad: Enclosure  # ad z_i on h, (k, k, k)
    lift: Array  # (d, n), orthonormal rows: the coordinates on g/h
    size: float  # number by which rounding errors are multiplied in rho
    defect: float  # relative error of the data within which they can satisfy the axioms

    def columns(self) -> Array:
        """Matrices A_a, rho relative to the data and a multiple of 1, such that sigma_d(x) is that of the A_a x."""
        d = len(self.lift)
        values, basis = orthonormal_span(self.rho.center, 0.0)
        return np.concatenate([values[:, None, None] * basis / (self.size or 1.0), np.eye(d)[None] / d**0.5])


def spectral_norm(array: Array, axes: int) -> float:
    """Largest singular value of an array as a matrix, with its first axes as rows; 0 if it is empty."""
    rows = int(np.prod(array.shape[:axes]))
    return float(np.linalg.norm(array.reshape(rows, -1), 2)) if array.size else 0.0


def float_action(pair: Pair, *, rtol: float | None = None, conjugated: bool = False) -> FloatAction:
    """`FloatAction` with the error of the data or another relative one; `conjugated` uses all three bounds on G."""
    n, d, k = pair.algebra.dimension, pair.dimension, pair.subalgebra.dimension
    constants = (pair.algebra.over(RR) if pair.field.exact else pair.algebra).table
    table: Any = constants.flat()
    rows: Any = RR.matrix(pair.subalgebra.basis.to_numpy(), (k, n)) if pair.field.exact else pair.subalgebra.basis
    _, values, both = np.linalg.svd(rows.array)
    least = float(values[-1]) if k else 1.0
    e, r = (max(x.error, LEAST * x.norm) if rtol is None else rtol * x.norm for x in (table, rows))
    r = r / least
    y = r / (1 - r) if r < 1 else 1.0
    c = np.einsum("ai,bj,ijl,cl->abc", both, both, table.array.reshape(n, n, n), both, optimize=True)
    h, w = slice(0, k), slice(k, n)
    across, inside, twice = (spectral_norm(c[w, x, z], 1) for x, z in ((w, w), (h, h), (w, h)))
    own, outside = (1 + y * y) * e / 2**0.5 + y * y * twice, spectral_norm(c[h, h, w], 0)
    error = own + y * (across + spectral_norm(c[h, w, h], 2)) if r < 1 else np.inf
    ad_error, moves = own + 2 * y * inside if r < 1 else np.inf, np.zeros((0, k, d))
    if conjugated and 0 < error < np.inf and (k * d) * k * k * d <= MAX_MOVES:
        closing = outside + (1 + y * y) ** 1.5 * e + y * y * (across + 2 * inside + y * twice)
        moves = _least_graphs(c, k, closing, y * error, y)
        error = ad_error = own
    leaving = np.einsum("sia,ajl->silj", moves, c[w, w, w]) - np.einsum("ijb,sbl->silj", c[h, w, h], moves)
    turned = np.einsum("sia,ajl->silj", moves, c[w, h, h]) - np.einsum("sja,ail->silj", moves, c[w, h, h])
    stacks = np.concatenate([c[h, w, w].transpose(0, 2, 1)[None], leaving])
    stacks = stacks - (np.trace(stacks, axis1=2, axis2=3) / d)[..., None, None] * np.eye(d)
    rho = Enclosure(stacks[0], error, stacks[1:])
    ad = Enclosure(c[h, h, h].transpose(0, 2, 1), ad_error, turned)
    size = table.norm * (1 + 2 * rows.norm / least)
    return FloatAction(rho, ad, both[k:], size, max(failure_over_floats(constants)[0], outside / (size or 1.0)))


def _least_graphs(c: Array, k: int, closing: float, orthogonal: float, y: float) -> Array:
    """Maps G_s, shape (s, k, d), such that every G within the three bounds is sum_s y_s G_s with |y| <= 1."""
    h, w = slice(0, k), slice(k, len(c))
    d = len(c) - k
    maps = np.eye(k * d).reshape(k * d, k, d)
    moved = np.einsum("sia,ajl->sijl", maps, c[w, h, w])
    closed = moved - moved.transpose(0, 2, 1, 3) - np.einsum("ijb,sbl->sijl", c[h, h, h], maps)
    turned = np.einsum("sjl,jal->sa", maps, c[h, w, w])
    bounds = [closed.reshape(k * d, -1) / closing, turned / orthogonal, np.eye(k * d) / y]
    left, values, _ = np.linalg.svd(np.concatenate(bounds, axis=1), full_matrices=False)
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
# With inexact matrices this only proposes skew-symmetric matrices K_b that are orthonormal. The proof that data within
# the error are full (section 9) needs the sizes of the parts of [K_a, K_b] outside of their span, and of the difference
# from combinations of g rho g^-1.

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


def transitive_group(rho: Enclosure) -> TransitiveGroup | None:
    """`TransitiveGroup` of the isotropy, or None if none was found."""
    matrices, d, (left, rank) = rho.center, rho.center.shape[1], rho.span()
    if rank + 1 < d:
        return None
    basis = np.tensordot(left[:, :rank].T, matrices, 1)
    g = self_adjoint_position(basis / np.linalg.norm(basis, axis=(1, 2), keepdims=True))
    condition = float(np.linalg.cond(g))
    if not condition < MAX_CONDITION:
        return None
    inverse, members = np.linalg.inv(g), left[:, :rank].T
    moved = (g @ basis @ inverse).reshape(rank, d * d)
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
    moves = g @ np.tensordot(members, rho.moves, (1, 1)).swapaxes(0, 1) @ inverse
    error = condition * spectral_norm(members, 1) * rho.error + spectral_norm(moves, 1)
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


# Dominance (theorem 4 of docs/theory/fullness.md) for all data within the error, by real parts (f = 1) or by absolute
# values of imaginary parts (f = -i): section 9. X in h is proposed by iterations: the trace form of the next X is that
# of the projection to the eigenspaces of X at the largest real part. Its limits are dual to highest weights. Then an
# element that acts by 0 on g/h is added, with the largest trace of ad on such elements, so that few of them count.

ATTEMPTS, ITERATIONS, SHIFTS = 6, 4, (0.0, 2.0, 8.0)
CLUSTER = 1e-2  # real parts that differ by less, relative to the largest modulus, are enclosed together

Interval: TypeAlias = tuple[float, float, int]  # bounds, and the number of eigenvalues between them


def real_parts(element: Enclosure) -> list[Interval]:
    """Intervals that contain the real parts of the eigenvalues of all matrices (d, d) of an element."""
    matrix = element.center
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
    radius = condition * element.error + spectral_norm(inverse @ element.moves @ basis, 1) + spectral_norm(outside, 1)
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
    """Whether the element with the coefficients x shows that no pair within the error is full."""
    x = x / np.linalg.norm(x)
    parts = _disjoint(real_parts(action.rho.element(x, f)), folded=f != 1)
    roots = _disjoint(real_parts(action.ad.element(x, -f)), folded=f != 1) if len(parts) > 1 else []
    above = 0
    for (low, _, number), (_, high, _) in pairwise(parts):
        above += number
        if above + sum(n for _, top, n in roots if top >= low - high) < len(action.lift):
            return True
    return False


def dominated_vector(action: FloatAction) -> Array | None:
    """A vector of W of an element that shows that no pair within the error is full, or None if none was found."""
    matrices, rng, (left, rank) = action.rho.center, np.random.default_rng(0), action.rho.span()
    acting, still = left[:, :rank], left[:, rank:]
    traces = np.einsum("ia,ijl,lb,jb->a", still, action.ad.center, still, still, optimize=True)
    length = float(np.linalg.norm(traces))
    shifts = SHIFTS if length > CLUSTER * float(np.linalg.norm(action.ad.center)) else SHIFTS[:1]
    shift = still @ traces / (length or 1.0)
    dual = np.linalg.pinv(np.einsum("aij,bji->ab", matrices, matrices), rcond=1e-4, hermitian=True)
    for f in (1.0, -1j) * ATTEMPTS if rank else ():
        x = acting @ rng.standard_normal(rank)
        for i in range(ITERATIONS):
            if not (length := float(np.linalg.norm(x))) > 0:
                break
            x = x / length
            values, vectors = np.linalg.eig(f * np.tensordot(x, matrices, 1))
            top = values.real >= values.real.max() - CLUSTER * np.abs(values).max()
            if any(_dominates(action, x + s * shift, f) for s in shifts):
                vector = vectors[:, top][:, 0]
                vector = np.asarray((vector / vector[np.abs(vector).argmax()]).real)
                return vector / np.linalg.norm(vector)
            projection = vectors[:, top] @ np.linalg.pinv(vectors)[top]
            x = (f * np.einsum("aij,ji->a", matrices, projection)).real
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
# Not full is also answered for the data as given, if an x was found with sigma_d(x) at most 2^12 units of round-off,
# relative to the norm of the data. Data that are computed, in a rotated basis say, are off by a few hundred units; a
# value above this level is not a zero. The basis elements of g can have units of very different sizes, so the same must
# hold after they are rescaled such that all structure constants have similar sizes.

NumericalVerdict: TypeAlias = NumericallyFull | NumericallyNotFull | NumericallyUndecided
"""A result of `decide_numerically`."""

MIN_GAP = 1.5  # least ratio of sigma_d and its error for the answer full, which leaves room for rounding
LEAST = 2.0**-46  # least relative error of data, for the same reason
ROUNDING = 2.0**12 * float(np.finfo(np.float64).eps)
"""Relative size below which sigma_d is zero up to rounding."""
MAX_LOG = 100.0  # largest logarithm of the factor of a basis element


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
        If every pair within the error of the data is full, with a gap of at least 1.5.
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
        return _not_full(pair, action, rtol, np.eye(d)[0], 0.0, reason)
    for conjugated in (False, True):
        action = float_action(pair, conjugated=True) if conjugated else action
        group = transitive_group(action.rho)
        if group is not None and group.value >= MIN_GAP * group.error:
            return _full(pair, group, action)
        if (x := dominated_vector(action)) is not None:
            value, _ = smallest(action.columns(), x)
            reason = (
                f"sigma_d = {value:.1e} relative to the data at an eta, and the eigenvalues of an element of h show a "
                f"rank below {d} for all data within the error {rtol:.1e}"
            )
            return _not_full(pair, action, rtol, x, value, reason)
    value, x = least_singular_value(action.columns(), starts=starts, seed=seed)
    rounding = min(ROUNDING, rtol)
    if group is not None and not group.value * rtol > group.error * rounding:
        group = None  # rounding alone can cause it
    if max(value, action.defect) > rounding or group or _is_above_rounding(_rescaled(pair), rounding, starts, seed):
        return _undecided(pair, group, rtol, action, value, x)
    reason = (
        f"an eta with sigma_d = {value:.1e} relative to the data was found, zero up to the rounding level "
        f"{rounding:.1e}; rounding alone can cause it, since data within the error {rtol:.1e} can be full"
    )
    return _not_full(pair, action, rtol, x, value, reason)


def _is_above_rounding(pair: Pair, rounding: float, starts: int, seed: int) -> bool:
    """Whether the data as given are full, or sigma_d is not zero up to rounding."""
    if pair.subalgebra.basis.rank() < pair.subalgebra.dimension:
        return True
    action = float_action(pair, rtol=rounding)
    group = transitive_group(action.rho)
    is_full = group is not None and group.value > group.error
    return is_full or least_singular_value(action.columns(), starts=starts, seed=seed)[0] > rounding


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


def _not_full(pair: Pair, action: FloatAction, rtol: float, x: Array, value: float, reason: str) -> NumericallyNotFull:
    return NumericallyNotFull(pair, reason, value, rtol / max(value, 1e-300), _eta(action, x))


def _undecided(
    pair: Pair, group: TransitiveGroup | None, rtol: float, action: FloatAction, value: float, x: Array
) -> NumericallyUndecided:
    if group is not None:
        gap = group.value / group.error
        reason = (
            f"sigma_d = {group.value:.3g} at every eta, but its error is {group.error:.1e}, a gap of {gap:.1e} "
            f"where {MIN_GAP:g} is needed"
        )
        return NumericallyUndecided(pair, reason, group.value, gap, _eta(action, group.point))
    reason = (
        f"the least sigma_d found is {value:.1e} relative to the data, which satisfy the axioms up to "
        f"{action.defect:.1e}: not both zero up to the rounding level {ROUNDING:.1e} in all units of the basis of g; "
        f"and nothing was found that holds for all data within the error {rtol:.1e}"
    )
    return NumericallyUndecided(pair, reason, value, value / rtol, _eta(action, x))


def _eta(action: FloatAction, x: Array) -> list[float]:
    """Coefficients in the basis of g of the element that x represents."""
    return [float(v) for v in x @ action.lift]
