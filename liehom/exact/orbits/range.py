"""The range condition at a generator, and generic ranks."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import comb
from typing import NamedTuple, final

import numpy as np
import numpy.typing as npt

from liehom.base.budget import in_time
from liehom.base.errors import InputError, ShapeError, UndecidedError, displayed
from liehom.base.typing import Array, IntegerArray, Values, VectorLike
from liehom.exact.representations.core.pair import Pair
from liehom.exact.scalars.exact_field import ExactMatrix
from liehom.exact.scalars.field import Matrix, Scalar
from liehom.exact.scalars.floating import FloatMatrix, RankDecision
from liehom.exact.scalars.polynomial_matrix import LinearForms

# below this number of matrices the singular values are computed; larger batches are split into blocks for the cache
MIN_BATCH, BLOCK = 64, 2048
# relative margin for round-off in both bounds
MARGIN = 1e-6


def batched_ranks(matrices: Values, bounds: npt.ArrayLike) -> IntegerArray:
    """Numbers of singular values above a bound, shape (...,), mostly without an SVD.

    Orthogonalization with pivoting runs on all matrices at once. After k steps the remainder R and the length r of the
    last pivot bound the singular values on either side of k, and the rank is k if the bound is between them:

        s_(k+1) <= |R|_F,    s_k >= 3 r / (4^k + 6 k - 1)^(1/2)

    The former is the distance to a matrix of rank k. The latter follows from the bound for the inverse of a triangular
    factor with pivoting: Higham, Accuracy and Stability of Numerical Algorithms, theorem 8.14.
    """
    lead, (p, q) = matrices.shape[:-2], matrices.shape[-2:]
    limits: Array = np.broadcast_to(bounds, lead)
    count = limits.size
    if count < MIN_BATCH or not p or not q:
        return _by_values(matrices, limits)
    if p < q:
        matrices, p, q = np.swapaxes(matrices, -1, -2), q, p
    batch: Array = matrices.reshape(count, p, q)
    limits = limits.reshape(count)
    ranks = np.empty(count, dtype=int)
    for first in range(0, count, BLOCK):
        here = slice(first, first + BLOCK)
        ranks[here] = _by_pivots(np.array(batch[here].transpose(2, 1, 0), order="C"), limits[here])
    if len(left := np.flatnonzero(ranks < 0)):
        ranks[left] = _by_values(batch[left], limits[left])
    return ranks.reshape(lead)


def _by_values(matrices: Values, bounds: Array) -> IntegerArray:
    return (np.linalg.svd(np.asarray(matrices), compute_uv=False) > bounds[..., None]).sum(axis=-1)


def _by_pivots(columns: Array, bounds: Array) -> IntegerArray:
    """Ranks of L matrices given by their columns (q, p, L), which are overwritten; -1 for undecided ones."""
    ranks, lanes = np.full(bounds.shape, -1), np.arange(len(bounds))
    lowest = np.full(bounds.shape, np.inf)
    for k in range(len(columns) + 1):
        squares = np.einsum("cpl,cpl->cl", columns, columns)
        rest = np.sqrt(squares.sum(axis=0))
        ranks[(ranks < 0) & (rest <= (1 - MARGIN) * bounds) & (lowest > (1 + MARGIN) * bounds)] = k
        if k == len(columns) or bool((rest <= bounds).all()):
            break
        pivot = np.argmax(squares, axis=0)
        size = np.sqrt(squares[pivot, lanes])
        lowest = 3 * size / np.sqrt(4.0 ** (k + 1) + 6 * (k + 1) - 1)
        unit = columns[pivot, :, lanes].T / np.where(size > 0, size, 1.0)
        columns -= np.einsum("cpl,pl->cl", columns, unit)[:, None] * unit
    return ranks


# The generic rank of x -> [A_1 x, ..., A_m x] for a Lie algebra L of matrices that is spanned by A_i: the orbit
# dimension.
#
# One x with a large rank is a lower bound.  The upper bound comes from a slice.  Let W be a complement of L x0 in V.
# The map (g, w) -> g (x0 + w) has the differential L + W -> V, (A, w) -> A x0 + w, at (1, 0), which is onto.  So the
# orbits of the points x0 + w contain a neighborhood of x0, and the rank is constant on orbits.  Hence a bound of the
# rank at x0 + w for all w in W is a bound everywhere.
#
# Let k independent combinations of the A_i annihilate x0 and W.  Then the rank is at most m - k at x0 + w.  With x0 =
# 0, W = V and the combinations that are zero this bound is dim L.  With all combinations that annihilate a generic x0
# it is the rank r at x0, if the vectors that they annihilate contain a complement W.  This is so if the group of L is
# reductive and its generic orbits are closed, in particular if it preserves a definite form up to scale, and for
# symmetric pairs.
#
# In other cases, the minors of order r + 1 are polynomials of degree at most r + 1 in the d - r coordinates of w.  They
# vanish if they vanish at the points whose coordinates are the nodes t_i with indices of sum at most r + 1, which are
# finitely many.

MAX_POINTS = 20_000


class RankProof(NamedTuple):
    """A proof that no x has a rank above `rank`: a slice x0 + W, with `directions` a basis of W in its rows.

    The rows of `stabilizer` are coefficients over the A_i of combinations that annihilate x0 and W; None stands for
    ranks at the points of a lattice.
    """

    rank: int
    point: list[Scalar]
    directions: ExactMatrix
    stabilizer: ExactMatrix | None


def generic_rank(
    forms: LinearForms, point: Sequence[Scalar], enough: int = 0
) -> tuple[list[Scalar], int, RankProof | None]:
    """A point, its rank, and the proof that no rank is above it; None if the rank is d or reaches `enough`.

    With `enough` above 0 a proof that no rank reaches it is sufficient, so the rank of the proof may be above the one
    at the point.
    """
    d, m = forms.shape
    point, field = list(point), forms.field
    if enough:
        flat = field.stack_columns([part.T for part in forms.parts], m)  # row j holds the entries of A_j
        if int(flat.modulo().rank()) < enough and flat.rank() < enough:
            zero = flat.left_null_space()
            return point, forms.at(point).rank(), RankProof(m - zero.nrows, [field.zero] * d, field.identity(d), zero)
    while True:
        matrix = forms.at(point)
        rank = matrix.rank()
        if rank == d or (enough and rank >= enough):
            return point, rank, None
        if (proof := _slice(forms, matrix, point, rank)) is not None:
            return point, rank, proof
        pivots = set(matrix.T.echelon()[1])
        free = [i for i in range(d) if i not in pivots]  # unit vectors that span a complement of L x0
        if (higher := _higher_point(forms, point, rank, free)) is None:
            return point, rank, RankProof(rank, point, field.identity(d).select(rows=free), None)
        point = higher


def _higher_point(forms: LinearForms, point: Sequence[Scalar], rank: int, free: Sequence[int]) -> list[Scalar] | None:
    """A point of the slice along the unit vectors `free` with a higher rank; None proves that there is none."""
    if (points := number_of_points(rank, len(point))) > MAX_POINTS:
        raise UndecidedError(
            f"the largest dimension found is {rank}; a proof that it is the generic one takes {points} ranks, the "
            f"limit is {MAX_POINTS}"
        )
    nodes = [(k + 1) // 2 if k % 2 else -(k // 2) for k in range(rank + 2)]  # 0, 1, -1, 2, -2, ...
    for offset in _lattice(nodes, len(free), rank + 1):
        in_time()
        moved = list(point)
        for i, step in zip(free, offset, strict=True):
            moved[i] = moved[i] + step
        if forms.at(moved).rank() > rank:
            return moved
    return None


def number_of_points(rank: int, dimension: int) -> int:
    """The number of points of a lattice at which ranks prove that the generic rank is this one."""
    return comb(dimension + 1, rank + 1)


def _slice(forms: LinearForms, matrix: ExactMatrix, point: list[Scalar], rank: int) -> RankProof | None:
    """The proof by the stabilizer of a point, from the matrix at the point; None if it fixes no complement."""
    d, field = matrix.nrows, forms.field
    stabilizer = matrix.null_space()
    # column i of an element of the stabilizer is its value at the unit vector e_i
    images = [(part @ stabilizer.T).T.reshape(1, stabilizer.nrows * d) for part in forms.parts]
    fixed = field.stack_rows(images, stabilizer.nrows * d).T.null_space()
    reached = matrix.T.row_space()
    chosen = field.stack_rows([reached, fixed], d).T.echelon()[1]
    if len(chosen) < d:
        return None
    return RankProof(rank, point, fixed.select(rows=[i - rank for i in chosen[rank:]]), stabilizer)


def _lattice(nodes: Sequence[int], variables: int, degree: int) -> Iterator[tuple[int, ...]]:
    """The points (t_i, t_j, ...) with i + j + ... <= degree, at which only the polynomial 0 of this degree vanishes."""
    if variables == 0:
        yield ()
    for i in range(degree + 1 if variables else 0):
        for rest in _lattice(nodes, variables - 1, degree - i):
            yield (nodes[i], *rest)


# With x = psi mod h in V = g/h the condition is rank [rho(z_1) x, ..., rho(z_k) x, x] = d = dim V.  For one psi it is
# decided by this rank.  It holds for generic psi if and only if it holds for one psi.  The proof that it never holds is
# the generic rank of this matrix.

SAMPLES = 6


@final
@dataclass(frozen=True, slots=True, repr=False)
class RangeCondition:
    """Whether [h, psi] + R psi + h = g, for one psi or for a generic one.

    Attributes
    ----------
    holds : bool or None
        For one psi: whether the condition holds at psi; None if floats do not decide it. For generic psi: True if it
        holds for all psi outside a proper closed cone, False if it holds for no psi, None if that could not be proved.
    rank : int
        The rank of [rho(h) x, x] at `psi`.
    dimension : int
        d = dim g/h, the required rank.
    psi : list
        The tested element: the given psi, or the sample that decided.
    missing : list or None
        A covector on g that vanishes on h, on psi and on [h, psi], if the rank at `psi` is less than d.
    equilibrium : bool
        Whether psi lies in h; the condition then fails except for h = g.
    generic : bool
        Whether the question was about generic psi.
    message : str
        The reason, a sentence.
    numerical : RankDecision or None
        The singular values that decided the rank at `psi`, over floats.

    Examples
    --------
    >>> import liehom as lh
    >>> pair = lh.defining(lh.so(3)).pair([0, 0, 1])
    >>> bool(range_condition(pair))
    True
    """

    holds: bool | None
    rank: int
    dimension: int
    psi: list[Scalar]
    missing: list[Scalar] | None
    equilibrium: bool
    generic: bool
    message: str
    numerical: RankDecision | None = None

    def __bool__(self) -> bool:
        if self.holds is None:
            raise UndecidedError(f"the range condition is not decided: {self.message}; ask for .holds")
        return self.holds

    def __str__(self) -> str:
        state = {True: "holds", False: "fails", None: "is not decided"}[self.holds]
        return f"the range condition {state} {'for generic psi' if self.generic else 'at psi'}: {self.message}"

    def __repr__(self) -> str:
        where = "generically" if self.generic else "at psi"
        state = {True: f"holds {where}", False: f"fails {where}", None: "undecided"}[self.holds]
        return f"<range condition: {state}, rank {self.rank} of {self.dimension}>"


def range_condition(pair: Pair, psi: VectorLike | None = None) -> RangeCondition:
    """Decide the range condition [h, psi] + R psi + h = g, at one psi or for generic psi.

    The answer is exact over an exact field. Over floats it has the singular values that decided the rank, and it is
    undecided if one of them is within a factor 100 of the error.

    Parameters
    ----------
    pair : Pair
    psi : sequence of n coefficients, optional
        An element of g. Without it the condition is decided for generic psi.

    Notes
    -----
    One psi with rank d proves that the rank is d on a dense open cone. The proof that the rank is less than d
    everywhere is dim(rho(h) + R) < d, or the rank over the field of rational functions in x. The latter follows from
    the stabilizer of one point, or from ranks at finitely many points of a slice. `holds` is None if these would be
    more than 20,000. If h acts on g/h as on the tangent spaces of so(p, q)/so(p', q') with both signs, the condition
    holds generically although the pair is not full.

    Examples
    --------
    >>> import liehom as lh
    >>> sphere = lh.Pair(lh.so(3), [[1, 0, 0]])
    >>> range_condition(sphere, [1, 0, 0]).message
    'psi lies in h: an equilibrium'
    >>> print(range_condition(sphere, [1, 1, 0]))
    the range condition holds at psi: [h, psi] + R psi has rank 2 of 2 in g/h
    >>> range_condition(lh.Pair(lh.abelian(2), []))
    <range condition: fails generically, rank 1 of 2>
    """
    if not isinstance(pair, Pair):
        raise InputError(f"expected a Pair, got {displayed(pair)}; liehom.pair reads names, liehom.load files")
    if psi is not None:
        return _at(pair, pair.algebra.row(psi), generic=False)
    if pair.dimension == 0:
        return _at(pair, pair.algebra.field.zeros(1, pair.algebra.dimension), generic=True)
    try:
        best, proof = largest_rank(pair, enough=pair.dimension)
    except UndecidedError as error:
        best = _best_sample(pair)
        return _decided(best, None, f"it fails at {SAMPLES} random points; not proved for all psi: {error}")
    if proof is None:
        return best
    message = f"it never holds: the rank over the rational functions of psi is {best.rank}"
    if not any(proof.point):
        message = f"it never holds: rho(h) + R has dimension {proof.rank} < {pair.dimension}"
    return _decided(best, False, message)


def orbit_dimension(pair: Pair) -> int:
    """The dimension of the orbits of generic points of g/h under the group of rho(h) + R, over an exact field.

    It is the rank of [h, psi] + R psi in g/h for generic psi, and dim g/h if the range condition holds generically.

    Raises
    ------
    UndecidedError
        If the proof that the largest known rank is generic would take ranks at too many points.

    Examples
    --------
    The orbits of so(3) + R on symmetric matrices of trace 0 are given by the ratio of two eigenvalues:

    >>> import liehom as lh
    >>> orbit_dimension(lh.pair("sl(3)/so(3)")), orbit_dimension(lh.pair("so(3,1)/so(2,1)"))
    (4, 3)
    """
    if not pair.field.exact:
        raise UndecidedError(
            "the dimension of generic orbits is computed over exact fields only: go to exact numbers by "
            "lh.rationalize(pair, max_denominator=...)"
        )
    if pair.dimension == 0:
        return 0
    return largest_rank(pair)[0].rank


def largest_rank(pair: Pair, enough: int = 0) -> tuple[RangeCondition, RankProof | None]:
    """The answer at a point of the largest rank, and the proof that no rank is above it or, with `enough`, reaches it.

    The columns of the proof are those of 1 and of rho of the rows of ``subalgebra.quotient().subspace``. There is none
    if the rank is d, or over floats.
    """
    best = _best_sample(pair)
    if best.holds or not pair.field.exact:
        return best, None
    data = pair.subalgebra.quotient()
    forms = _forms(pair, [pair.field.identity(pair.dimension), *pair.isotropy_matrices()])
    start = (pair.algebra.row(best.psi) @ data.projection).row(0)
    point, rank, proof = generic_rank(forms, start, enough)
    if rank > best.rank:
        best = _at(pair, pair.field.matrix([point]) @ data.lift, generic=True)
    return (_decided(best, True, "one psi at which it holds proves it") if best.holds else best), proof


def pencil(pair: Pair) -> LinearForms:
    """The matrix of linear forms x -> [A_1 x, ..., A_m x], A_i a basis of rho(h) + R, over an exact field.

    x are the coordinates of ``pair.coordinates``, at least one (d >= 1).
    """
    d = pair.dimension
    if d < 1:
        raise ShapeError("g/h is zero: there is no matrix of linear forms")
    matrices = [pair.field.identity(d), *pair.isotropy_matrices()]
    flat = pair.field.stack_rows([a.reshape(1, d * d) for a in matrices], d * d)
    chosen = [matrices[i] for i in flat.T.echelon()[1]]
    return _forms(pair, chosen)


def _forms(pair: Pair, matrices: Sequence[Matrix]) -> LinearForms:
    """The matrix [A_1 x, ..., A_m x]: column j of part i is A_j e_i."""
    d = pair.dimension
    return LinearForms([pair.field.stack_columns([a.select(columns=[i]) for a in matrices], d) for i in range(d)])


def _at(pair: Pair, row: Matrix, *, generic: bool) -> RangeCondition:
    d, field = pair.dimension, pair.field
    psi = row.row(0)
    if d == 0:
        return RangeCondition(True, 0, 0, psi, None, not generic, generic, "h = g: nothing to reach")
    x = row @ pair.subalgebra.quotient().projection
    equilibrium = x.is_zero()  # over floats, up to the error of the projection to g/h
    images = field.stack_rows([(a @ x.T).T for a in pair.isotropy_matrices()], d)
    table = field.stack_rows([_of_the_size_of(images, x), images], d)
    numerical = None
    if equilibrium:
        rank, kernel = 0, field.unit(d, 0)
    elif isinstance(table, FloatMatrix):
        numerical = table.rank_decision()
        if not numerical.clear:
            message = (
                f"a singular value of relative size {numerical.kept:.2g} counts and {numerical.dropped:.2g} does not, "
                f"too near to the error {numerical.error:.2g}; more accurate or exact numbers decide it, see "
                "liehom.rationalize"
            )
            return RangeCondition(None, numerical.rank, d, psi, None, False, generic, message, numerical)
        rank, kernel = numerical.rank, table.null_space()
    else:
        kernel = table.null_space()
        rank = d - kernel.nrows
    missing = None if rank == d else (kernel.select(rows=[0]) @ pair.subalgebra.quotient().projection.T).row(0)
    message = "psi lies in h: an equilibrium" if equilibrium else f"[h, psi] + R psi has rank {rank} of {d} in g/h"
    return RangeCondition(rank == d, rank, d, psi, missing, equilibrium, generic, message, numerical)


def _of_the_size_of(images: Matrix, x: Matrix) -> Matrix:
    """Over floats a multiple of x as long as all images together, so that no rank depends on the scale of brackets."""
    if not isinstance(images, FloatMatrix) or not isinstance(x, FloatMatrix) or images.is_zero() or x.norm == 0:
        return x
    return x.scale(images.norm / x.norm)


def _best_sample(pair: Pair) -> RangeCondition:
    """The answer at the first of a few random points with the largest rank."""
    rng = random.Random(pair.algebra.dimension)
    samples: list[RangeCondition] = []
    lift = pair.subalgebra.quotient().lift
    for size in range(SAMPLES):
        values = [[rng.randint(-3 - 4 * size, 3 + 4 * size) or 1 for _ in range(pair.dimension)]]
        samples.append(_at(pair, pair.field.matrix(values) @ lift, generic=True))
        if samples[-1].holds:
            return _decided(samples[-1], True, "one psi at which it holds proves it")
    unclear = [sample for sample in samples if sample.holds is None]
    if unclear:
        return unclear[-1]
    best = max(samples, key=lambda sample: sample.rank)
    return _decided(best, False, f"the numerical rank is at most {best.rank} of {best.dimension} at {SAMPLES} points")


def _decided(best: RangeCondition, holds: bool | None, message: str) -> RangeCondition:
    return RangeCondition(
        holds, best.rank, best.dimension, best.psi, best.missing, best.equilibrium, True, message, best.numerical
    )
