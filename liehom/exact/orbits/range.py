"""The range condition at a generator, and generic ranks."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import comb
from typing import final

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


# The generic rank of x -> [A_1 x, ..., A_m x] for a Lie algebra L of matrices with basis A_i: the orbit dimension.
#
# One x with a large rank is a lower bound.  The upper bound comes from a slice.  Let the rank be r at x0, and N a
# complement of L x0 in V.  The map (g, n) -> g (x0 + n) has the differential L + N -> V, (A, n) -> A x0 + n, at
# (1, 0), which is onto.  So the orbits of the points x0 + n contain a neighborhood of x0, and the rank is constant on
# orbits.  Hence the generic rank is r if and only if the rank is at most r at x0 + n for all n in N.
#
# Let s be the stabilizer of x0 in L.  If the vectors that s annihilates contain a complement N, the rank at x0 + n is
# at most dim L - dim s = r.  This is so at generic points if the group of L is reductive and its generic orbits are
# closed, in particular if it preserves a definite form up to scale, and for symmetric pairs.
#
# In other cases, the minors of order r + 1 are polynomials of degree at most r + 1 in the d - r coordinates of n.  They
# vanish if they vanish at the points whose coordinates are the nodes t_i with indices of sum at most r + 1, which are
# finitely many.

MAX_POINTS = 20_000


def point_of_higher_rank(forms: LinearForms, point: Sequence[Scalar], rank: int) -> list[Scalar] | None:
    """A point at which the rank is higher than at this one, or None, which proves that the rank is generic."""
    matrix = forms.at(point)
    if rank == min(matrix.shape) or _is_principal(forms, matrix):
        return None
    pivots = set(matrix.T.echelon()[1])
    free = [i for i in range(matrix.nrows) if i not in pivots]  # unit vectors that span a complement of L x0
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
    """The number of points at which `point_of_higher_rank` computes a rank."""
    return comb(dimension + 1, rank + 1)


def _is_principal(forms: LinearForms, matrix: ExactMatrix) -> bool:
    """Whether the stabilizer s of the point x0 annihilates a complement of L x0, from the matrix at x0."""
    stabilizer = matrix.null_space().T
    d = matrix.nrows
    # column i of an element of s is its value at the unit vector e_i
    images = [(part @ stabilizer).T.reshape(1, stabilizer.ncols * d) for part in forms.parts]
    fixed = forms.field.stack_rows(images, stabilizer.ncols * d).T.null_space()
    return forms.field.stack_rows([matrix.T, fixed], d).rank() == d


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

    Parameters
    ----------
    pair : Pair
    psi : sequence of n coefficients, optional
        An element of g. Without it the condition is decided for generic psi.

    Returns
    -------
    RangeCondition
        Exact over an exact field. Over floats it has the singular values that decided the rank, and it is undecided if
        one of them is within a factor 100 of the error.

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
    best = _best_sample(pair)
    if best.holds or not pair.field.exact:
        return best
    forms = pencil(pair)
    if forms.shape[1] < pair.dimension:
        message = f"it never holds: rho(h) + R has dimension {forms.shape[1]} < {pair.dimension}"
        return _decided(best, False, message)
    try:
        best = _raised(pair, forms, best)
    except UndecidedError as error:
        return _decided(best, None, f"it fails at {SAMPLES} random points; not proved for all psi: {error}")
    message = f"it never holds: the rank over the rational functions of psi is {best.rank}"
    return best if best.holds else _decided(best, False, message)


def orbit_dimension(pair: Pair) -> int:
    """The dimension of the orbits of generic points of g/h under the group of rho(h) + R.

    It is the rank of [h, psi] + R psi in g/h for generic psi, and dim g/h if the range condition holds generically.

    Parameters
    ----------
    pair : Pair
        Over an exact field.

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
    return _raised(pair, pencil(pair), _best_sample(pair)).rank


def _raised(pair: Pair, forms: LinearForms, best: RangeCondition) -> RangeCondition:
    """The answer at a point where the rank is proved to be the generic one."""
    data = pair.subalgebra.quotient()
    point = (pair.algebra.row(best.psi) @ data.projection).row(0)
    while (higher := point_of_higher_rank(forms, point, best.rank)) is not None:
        point = higher
        best = _at(pair, pair.field.matrix([point]) @ data.lift, generic=True)
    return _decided(best, True, "one psi at which it holds proves it") if best.holds else best


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
    # Column j of part i is A_j e_i.
    return LinearForms([pair.field.stack_columns([a.select(columns=[i]) for a in chosen], d) for i in range(d)])


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
