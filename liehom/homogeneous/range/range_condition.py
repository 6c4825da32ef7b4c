"""The range condition at a generator: [h, psi] + R psi + h = g.

With x = psi mod h in V = g/h the condition is rank [rho(z_1) x, ..., rho(z_k) x, x] = d = dim V.  For one psi it is
decided by this rank.  It holds for generic psi if and only if it holds for one psi.  The proof that it never holds is
the generic rank of this matrix.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from typing import final

from liehom.errors import InputError, ShapeError, UndecidedError
from liehom.homogeneous.range.generic_rank import point_of_higher_rank
from liehom.representations import Pair
from liehom.scalars import FloatMatrix, Matrix, RankDecision, Scalar
from liehom.scalars.spaces.linear_forms import LinearForms
from liehom.typing import VectorLike

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

    Raises
    ------
    ShapeError
        If psi does not have n coefficients.
    FieldError
        If a coefficient is not in the pair's field.
    InputError
        If `pair` is not a `Pair`.

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
        raise InputError(f"expected a Pair, got {pair!r}; a name is read by liehom.pair, a file by liehom.load")
    if psi is not None:
        return _at(pair, pair.algebra.row(psi), generic=False)
    if pair.dimension == 0:
        return _at(pair, pair.algebra.field.zeros(1, pair.algebra.dimension), generic=True)
    best = _best_sample(pair)
    if best.holds or not pair.field.exact:
        return best
    forms = pencil(pair)
    if forms.shape[1] < pair.dimension:
        return _never(best, f"it never holds: rho(h) + R has dimension {forms.shape[1]} < {pair.dimension}")
    try:
        best = _raised(pair, forms, best)
    except UndecidedError as error:
        return _decided(best, None, f"it fails at {SAMPLES} random points; not proved for all psi: {error}")
    if best.holds:
        return best
    return _never(best, f"it never holds: the rank over the rational functions of psi is {best.rank}")


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
        Over float64, or if the proof that the largest known rank is generic would take ranks at too many points.

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

    Examples
    --------
    >>> import liehom as lh
    >>> pencil(lh.Pair(lh.so(3), [[0, 0, 1]])).shape
    (2, 2)
    """
    d = pair.dimension
    if d < 1:
        raise ShapeError("g/h is zero: there is no matrix of linear forms")
    matrices = [pair.field.identity(d), *pair.isotropy_matrices()]
    flat = pair.field.stack_rows([a.reshape(1, d * d) for a in matrices], d * d)
    chosen = [matrices[i] for i in flat.T.echelon()[1]]
    # Column j of part i is A_j e_i.
    return LinearForms(
        [pair.field.stack_columns([a.select(columns=[i]) for a in chosen], d) for i in range(d)],
    )


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
            return _unclear(numerical, d, psi, generic=generic)
        rank = numerical.rank
        kernel = table.null_space()
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


def _unclear(numerical: RankDecision, d: int, psi: list[Scalar], *, generic: bool) -> RangeCondition:
    message = (
        f"a singular value of relative size {numerical.kept:.2g} counts and {numerical.dropped:.2g} does not, too near "
        f"to the error {numerical.error:.2g}; more accurate or exact numbers decide it, see liehom.rationalize"
    )
    return RangeCondition(None, numerical.rank, d, psi, None, False, generic, message, numerical)


def _best_sample(pair: Pair) -> RangeCondition:
    """The answer at the first of a few random points with the largest rank."""
    rng = random.Random(pair.algebra.dimension)
    best: RangeCondition | None = None
    lift = pair.subalgebra.quotient().lift
    for size in range(SAMPLES):
        values = [[rng.randint(-3 - 4 * size, 3 + 4 * size) or 1 for _ in range(pair.dimension)]]
        found = _at(pair, pair.field.matrix(values) @ lift, generic=True)
        if found.holds:
            return _decided(found, True, "one psi at which it holds proves it")
        unclear = found.holds is None
        best = found if best is None or unclear or (best.holds is False and found.rank > best.rank) else best
    if best is None:
        raise UndecidedError("no sample was taken")
    if best.holds is None:
        return best
    return _decided(best, False, f"the numerical rank is at most {best.rank} of {best.dimension} at {SAMPLES} points")


def _never(best: RangeCondition, message: str) -> RangeCondition:
    return _decided(best, False, message)


def _decided(best: RangeCondition, holds: bool | None, message: str) -> RangeCondition:
    return RangeCondition(
        holds, best.rank, best.dimension, best.psi, best.missing, best.equilibrium, True, message, best.numerical
    )
