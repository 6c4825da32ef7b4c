"""Irreducibility over the reals, and isotropy of points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Literal, final

from liehom.base.errors import InputError, InternalError, ShapeError
from liehom.base.typing import ScalarLike, VectorLike
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.representations.invariants.intertwiners import commutant
from liehom.exact.scalars.exact_field import ExactMatrix
from liehom.exact.scalars.field import Field, Matrix, Scalar
from liehom.exact.scalars.floating import FloatMatrix
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.roots import real_part_cut
from liehom.exact.scalars.subspaces import orthogonal_basis


def moved_point(algebra: LieAlgebra, matrices: Sequence[Matrix], size: int, point: VectorLike) -> Matrix:
    """The matrix (dim g, N) with rows rho(e_i) point."""
    values = list(point)
    if len(values) != size:
        raise ShapeError(f"the point has {len(values)} coordinates, the representation acts on {size}")
    symbols = sorted({str(s) for v in values for s in getattr(v, "free_symbols", ())})
    if symbols:
        raise InputError(f"the point has the free symbols {', '.join(symbols)}; use Representation.symbolic_isotropy")
    column = algebra.field.matrix([values], (1, size)).T
    return algebra.field.stack_rows([(a @ column).T for a in matrices], size)


def stabilizer(algebra: LieAlgebra, matrices: Sequence[Matrix], size: int, point: VectorLike) -> Subalgebra:
    """The subalgebra {x : rho(x) point = 0}."""
    moved = moved_point(algebra, matrices, size, point)
    _require_clear(moved, "the isotropy at the point")
    # closed: rho([x, y]) p = rho(x) rho(y) p - rho(y) rho(x) p = 0
    return Subalgebra(algebra, moved.left_null_space(), check=False)


def orbit_dimension(algebra: LieAlgebra, matrices: Sequence[Matrix], size: int, point: VectorLike) -> int:
    """Dimension of the orbit of a point: the rank of x -> rho(x) point."""
    moved = moved_point(algebra, matrices, size, point)
    _require_clear(moved, "the orbit dimension of the point")
    return int(moved.rank())


def _require_clear(moved: Matrix, question: str) -> None:
    """Over floats, raise `UndecidedError` if a singular value is within a factor 100 of the error."""
    if isinstance(moved, FloatMatrix):
        moved.rank_decision().require_clear(question)


# A linear Lie algebra L is irreducible over the reals if and only if (1) the ideal [R, L] is zero, R the radical of the
# trace form on L, which acts nilpotently, and (2) the commutant of L is a division algebra over the reals.  Proof of
# "if": let S be the solvable radical of L.  [S, L] acts as 0 on the composition factors, so it lies in R, which is
# central as [R, L] = 0.  So [S, L] lies in the commutant and is nilpotent, hence 0: L is reductive.  Its centre lies in
# the commutant, so it consists of semisimple operators, and L acts completely reducibly.  (The trace form may be
# degenerate: L = R (1 + J), J^2 = -1.)

MAX_EIGENVALUE_DEGREE = 8


@final
@dataclass(frozen=True, slots=True)
class Reduction:
    """The reason why an action is reducible over the reals: a matrix that determines an invariant subspace.

    For 'kernel', the kernel of `matrix` is invariant, proper and not zero. For 'eigenvalue', `matrix` commutes with the
    action and `polynomial`, its irreducible minimal polynomial, has a real root. For 'cut', `matrix` commutes with the
    action and has eigenvalues with real parts on both sides of `cut`.
    """

    kind: Literal["kernel", "eigenvalue", "cut"]
    matrix: ExactMatrix
    polynomial: Polynomial | None = None
    cut: Scalar | None = None


def reduction(
    matrices: Sequence[ExactMatrix],
    size: int,
    over: Field,
    generating: Sequence[ExactMatrix] | None = None,
    *,
    semisimple: bool = False,
) -> Reduction | None:
    """A `Reduction` that splits the action of a linear Lie algebra on R^N, or None if it is irreducible."""
    if not semisimple and (nilpotent := nilpotent_ideal_rows(matrices, size, over)).nrows:
        return Reduction("kernel", nilpotent)
    commuting = commutant(matrices if generating is None else generating, size, over)
    return split_by_commutant(traceless(commuting, size, over), size, over)


def is_irreducible(
    matrices: Sequence[ExactMatrix],
    size: int,
    over: Field,
    generating: Sequence[ExactMatrix] | None = None,
    *,
    semisimple: bool = False,
) -> bool:
    """Whether the action of `reduction` on R^N is irreducible; the zero space is not."""
    return size > 0 and reduction(matrices, size, over, generating, semisimple=semisimple) is None


def trace_form(matrices: Sequence[ExactMatrix]) -> ExactMatrix:
    """The Gram matrix of the trace form, tr(A_i A_j), for at least one matrix."""
    field, size = matrices[0].field, matrices[0].nrows ** 2
    flat: ExactMatrix = field.stack_rows([a.reshape(1, size) for a in matrices], size)
    return flat @ field.stack_rows([a.T.reshape(1, size) for a in matrices], size).T


def trace_radical(matrices: Sequence[ExactMatrix]) -> list[ExactMatrix]:
    """A basis of the radical of the trace form on the span of matrices; often a rank modulo a prime shows it is 0."""
    if not matrices or int((gram := trace_form(matrices)).modulo().rank()) == len(matrices):
        return []
    radical = gram.null_space()
    return [combination(matrices, radical.row(i)) for i in range(radical.nrows)]


def nilpotent_ideal_rows(matrices: Sequence[ExactMatrix], size: int, over: Field) -> ExactMatrix:
    """Rows that span the row spaces of [R, L]; the common kernel is invariant, and not zero by Engel's theorem."""
    rows: ExactMatrix = over.zeros(0, size)
    for r in trace_radical(matrices):
        if kept := [c for c in (r @ a - a @ r for a in matrices) if not c.is_zero()]:
            rows = over.stack_rows([rows, *kept], size).row_space()
    if 0 < size == rows.nrows:
        raise InternalError("the ideal [R, L] has no common kernel")
    return rows


def combination(matrices: Sequence[ExactMatrix], coefficients: Sequence[ScalarLike]) -> ExactMatrix:
    """The sum of c_i A_i over at least one matrix."""
    total = matrices[0].scale(coefficients[0])
    for a, c in zip(matrices[1:], coefficients[1:], strict=True):
        if c != 0:
            total = total + a.scale(c)
    return total


def traceless(basis: Sequence[ExactMatrix], size: int, over: Field) -> list[ExactMatrix]:
    """A basis of the span of the traceless parts of matrices."""
    if not basis:
        return []
    reduced = [t - over.identity(size).scale(t.trace() / size) for t in basis]
    return over.stack_rows([t.reshape(1, size * size) for t in reduced], size * size).row_space().split_rows(size, size)


def split_by_commutant(imaginary: Sequence[ExactMatrix], size: int, over: Field) -> Reduction | None:
    """A reduction from a basis of the traceless commutant, or None if the commutant is R, C or H over the reals."""
    for t in [*imaginary, *(s + t for i, s in enumerate(imaginary) for t in imaginary[:i])]:
        if split := split_by(t):
            return split
    gram = anticommutator_gram(imaginary, size, over)
    if gram is None:
        raise InternalError("all sums in the commutant have scalar squares but some anticommutator is not scalar")
    for row, value in zip(*orthogonal_basis(gram), strict=True):
        if over.sign(value) >= 0:
            return split_by(combination(imaginary, row.row(0)))
    return None


def anticommutator_gram(imaginary: Sequence[ExactMatrix], size: int, over: Field) -> ExactMatrix | None:
    """The matrix g with (T_i T_j + T_j T_i)/2 = g_ij, or None if some anticommutator is not scalar."""
    values: list[Scalar] = []
    for s, t in product(imaginary, repeat=2):
        both = s @ t + t @ s
        value = both.trace() / size
        if not (both - over.identity(size).scale(value)).is_zero():
            return None
        values.append(value / 2)
    n = len(imaginary)
    return over.matrix([values[i * n : (i + 1) * n] for i in range(n)], (n, n))


def split_by(t: ExactMatrix) -> Reduction | None:
    """A reduction from one matrix of the commutant, or None if it is scalar or generates a copy of C."""
    f = Polynomial(t.field, t.characteristic_coefficients()).factor()[0][0]
    value = evaluated(f, t)
    if not value.is_zero():
        return Reduction("kernel", value)
    real = f.count_real_roots()
    if f.degree == 1 or (f.degree == 2 and not real):
        return None
    if real and f.degree <= MAX_EIGENVALUE_DEGREE:
        return Reduction("eigenvalue", t, polynomial=f)
    cut = real_part_cut(f)
    if cut is not None:
        return Reduction("cut", t, cut=cut)
    # All real parts agree: the centred matrix has imaginary eigenvalues, and its square has real eigenvalues.
    centred = t - t.field.identity(t.nrows).scale(t.trace() / t.nrows)
    return split_by(centred @ centred)


def evaluated(f: Polynomial, t: ExactMatrix) -> ExactMatrix:
    """The matrix f(T)."""
    field, size = t.field, t.nrows
    total = field.zeros(size, size)
    for c in reversed(f.coefficients):
        total = total @ t + field.identity(size).scale(c)
    return total
