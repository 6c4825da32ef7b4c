"""Irreducibility over the reals, decided exactly; a reducible action comes with a matrix that splits it.

A linear Lie algebra L is irreducible over the reals if and only if (1) the ideal [R, L] is zero, R the radical of
the trace form on L, which acts nilpotently, and (2) the commutant of L is a division algebra over the reals.  Proof of
"if": let S be the solvable radical of L.  [S, L] acts as 0 on the composition factors, so it lies in R, which is
central as [R, L] = 0.  So [S, L] lies in the commutant and is nilpotent, hence 0: L is reductive.  Its centre lies in
the commutant, so it consists of semisimple operators, and L acts completely reducibly.  (The trace form may be
degenerate: L = R (1 + J), J^2 = -1.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, final

from liehom.errors import InternalError
from liehom.representations.invariants.intertwiners import commutant
from liehom.scalars import ExactMatrix, Field, Polynomial, Scalar
from liehom.scalars.roots.roots import real_part_cut
from liehom.scalars.spaces.forms import orthogonal_basis
from liehom.typing import ScalarLike

MAX_EIGENVALUE_DEGREE = 8


@final
@dataclass(frozen=True, slots=True)
class Reduction:
    """The reason why an action is reducible over the reals: a matrix that determines an invariant subspace.

    Attributes
    ----------
    kind : {'kernel', 'eigenvalue', 'cut'}
        'kernel': the kernel of `matrix` is invariant, proper and not zero. 'eigenvalue': `matrix` commutes with
        the action and `polynomial`, its irreducible minimal polynomial, has a real root. 'cut': `matrix`
        commutes with the action and has eigenvalues with real parts on both sides of `cut`.
    matrix : Matrix
    polynomial : Polynomial or None
    cut : scalar or None
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
    """A `Reduction` that splits the action of a linear Lie algebra on R^N, or None: it is irreducible over the reals.

    Parameters
    ----------
    matrices : sequence of Matrix
        A basis of a Lie algebra of matrices (N, N) over an exact field.
    size : int
        N, at least 1.
    over : Field
    generating : sequence of Matrix, optional
        Matrices that generate the Lie algebra (default: the basis).
    semisimple : bool
        Whether the action is known to be completely reducible; the nilpotent ideal is then not computed.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> reduction([QQ.matrix([[0, -1], [1, 0]])], 2, QQ) is None
    True
    >>> reduction([QQ.matrix([[0, 2], [1, 0]])], 2, QQ).kind
    'eigenvalue'
    """
    nilpotent = None if semisimple else nilpotent_ideal_rows(matrices, size, over)
    if nilpotent is not None and nilpotent.nrows:
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
    """Whether a linear Lie algebra acts irreducibly on R^N (N >= 1; the zero space is not irreducible).

    The arguments are those of `reduction`.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> is_irreducible([QQ.matrix([[0, -1], [1, 0]])], 2, QQ)
    True
    """
    return size > 0 and reduction(matrices, size, over, generating, semisimple=semisimple) is None


def trace_form(matrices: Sequence[ExactMatrix]) -> ExactMatrix:
    """The Gram matrix of the trace form, tr(A_i A_j), for at least one matrix."""
    field, size = matrices[0].field, matrices[0].nrows ** 2
    flat: ExactMatrix = field.stack_rows([a.reshape(1, size) for a in matrices], size)
    turned = field.stack_rows([a.T.reshape(1, size) for a in matrices], size)
    return flat @ turned.T


def nilpotent_ideal_rows(matrices: Sequence[ExactMatrix], size: int, over: Field) -> ExactMatrix:
    """Rows that span the row spaces of [R, L]; the common kernel is invariant, and not zero by Engel's theorem."""
    none: ExactMatrix = over.zeros(0, size)
    if not matrices:
        return none
    gram = trace_form(matrices)
    if int(gram.modulo().rank()) == len(matrices):
        return none
    radical = gram.null_space()
    rows = none
    for i in range(radical.nrows):
        r = combination(matrices, radical.row(i))
        kept = [c for c in (r @ a - a @ r for a in matrices) if not c.is_zero()]
        if kept:
            rows = over.stack_rows([rows, *kept], size).row_space()
    if rows.nrows == size:
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
    flat = over.stack_rows([t.reshape(1, size * size) for t in reduced], size * size).row_space()
    return [row.reshape(size, size) for row in (flat.select(rows=[i]) for i in range(flat.nrows))]


def split_by_commutant(imaginary: Sequence[ExactMatrix], size: int, over: Field) -> Reduction | None:
    """A reduction from a basis of the traceless commutant, or None if the commutant is R, C or H over the reals."""
    candidates = [*imaginary, *(s + t for i, s in enumerate(imaginary) for t in imaginary[:i])]
    for t in candidates:
        found = split_by(t)
        if found is not None:
            return found
    gram = anticommutator_gram(imaginary, size, over)
    if gram is None:
        raise InternalError("all sums in the commutant have scalar squares but some anticommutator is not scalar")
    for row, value in zip(*orthogonal_basis(gram), strict=True):
        if over.sign(value) >= 0:
            return split_by(combination(imaginary, row.row(0)))
    return None


def anticommutator_gram(imaginary: Sequence[ExactMatrix], size: int, over: Field) -> ExactMatrix | None:
    """The matrix g with (T_i T_j + T_j T_i)/2 = g_ij, or None if some anticommutator is not scalar."""
    rows: list[list[Scalar]] = []
    for s in imaginary:
        row: list[Scalar] = []
        for t in imaginary:
            both = s @ t + t @ s
            value = both.trace() / size
            if not (both - over.identity(size).scale(value)).is_zero():
                return None
            row.append(value / 2)
        rows.append(row)
    gram: ExactMatrix = over.matrix(rows, (len(imaginary), len(imaginary)))
    return gram


def split_by(t: ExactMatrix) -> Reduction | None:
    """A reduction from one matrix of the commutant, or None if it is scalar or generates a copy of C."""
    f = Polynomial(t.field, t.characteristic_coefficients()).factor()[0][0]
    value = evaluated(f, t)
    if not value.is_zero():
        return Reduction("kernel", value)
    if f.degree == 1:
        return None
    if f.count_real_roots() and f.degree <= MAX_EIGENVALUE_DEGREE:
        return Reduction("eigenvalue", t, polynomial=f)
    if f.degree == 2 and not f.count_real_roots():
        return None
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
