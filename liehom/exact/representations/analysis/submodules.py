"""Invariant subspaces, the socle and complete reducibility, maximal invariant subspaces.

Subspaces are given by rows b, on which a matrix A acts as b A^T.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

from liehom.base.errors import (
    DependentRowsError,
    NotCompletelyReducibleError,
    NotInvariantError,
    ShapeError,
    SingularError,
)
from liehom.exact.representations.core.elements import exact_matrices, generating_matrices
from liehom.exact.representations.core.representation import Representation
from liehom.exact.representations.invariants.intertwiners import intertwiners
from liehom.exact.representations.invariants.irreducibility import combination, evaluated, trace_radical
from liehom.exact.scalars.exact_field import ExactMatrix, as_exact
from liehom.exact.scalars.field import MatrixLike, Scalar
from liehom.exact.scalars.modular import independent_rows
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.subspaces import Subspace, quotient


def generated_submodule(rho: Representation, rows: Subspace | MatrixLike) -> Subspace:
    """Implements `Representation.submodule`."""
    span, before = _rows(rho, rows).row_space(), -1
    turned = [a.T for a in generating_matrices(rho)]
    while before < span.nrows < rho.size:
        before = span.nrows
        span = rho.field.stack_rows([span, *(span @ a for a in turned)], rho.size).row_space()
    return Subspace(rho.field, span, rho.size)


def subrepresentation(rho: Representation, rows: Subspace | MatrixLike) -> Representation:
    """Implements `Representation.subrepresentation`."""
    basis = _independent(rho, rows)
    # A homomorphism followed by restriction to an invariant subspace.
    return Representation(rho.algebra, restricted(exact_matrices(rho), basis), size=basis.nrows, check=False)


def quotient_representation(rho: Representation, rows: Subspace | MatrixLike) -> Representation:
    """Implements `Representation.quotient`."""
    data = quotient(_independent(rho, rows))
    for i, a in enumerate(exact_matrices(rho)):
        moved = data.subspace @ a.T @ data.projection
        if not moved.is_zero():
            restricted(exact_matrices(rho), _independent(rho, rows))  # names a row of the argument
            raise _not_invariant(data.subspace, i, moved)
    matrices = [(data.lift @ a.T @ data.projection).T for a in exact_matrices(rho)]
    # The action descends to the quotient by an invariant subspace.
    return Representation(rho.algebra, matrices, size=data.lift.nrows, check=False)


def invariant_complement(rho: Representation, rows: Subspace | MatrixLike) -> Subspace:
    """Implements `Representation.invariant_complement`."""
    field, size = rho.field, rho.size
    basis = _independent(rho, rows)
    k = basis.nrows
    if not rho.matrices or k in (0, size):
        return Subspace(field, basis, size).complement()
    generating = generating_matrices(rho)
    maps = intertwiners(generating, restricted(generating, basis), (k, size), field)
    flat = field.stack_rows([(t @ basis.T).reshape(1, k * k) for t in maps], k * k)
    try:
        weights = flat.T.solve(field.identity(k).reshape(k * k, 1))
    except SingularError:
        raise NotCompletelyReducibleError(
            "the subspace has no invariant complement: no projection onto it commutes with the action"
        ) from None
    return Subspace(field, combination(maps, weights.entries()).null_space(), size)


def restricted(matrices: Sequence[ExactMatrix], basis: ExactMatrix, *, check: bool = True) -> list[ExactMatrix]:
    """The matrices (k, k), acting on columns, of the restrictions of maps to the span of independent rows (k, N)."""
    field, k = basis.field, basis.nrows
    if k == 0:
        return [field.zeros(0, 0) for _ in matrices]
    places = basis.echelon()[1]
    # basis @ reading = 1
    reading = field.identity(basis.ncols).select(columns=places) @ basis.select(columns=places).inverse()
    restrictions = []
    for i, a in enumerate(matrices):
        moved = basis @ a.T
        inside = moved @ reading
        if check and not (defect := moved - inside @ basis).is_zero():
            raise _not_invariant(basis, i, defect)
        restrictions.append(inside.T)
    return restrictions


def _not_invariant(basis: ExactMatrix, element: int, defect: ExactMatrix) -> NotInvariantError:
    row = next(j for j in range(defect.nrows) if not defect.select(rows=[j]).is_zero())
    shown = ", ".join(basis.select(rows=[row]).to_strings()[0])
    return NotInvariantError(
        row, element, f"the subspace is not invariant: basis element {element} moves row {row}, ({shown}), out of it"
    )


def _rows(rho: Representation, rows: Subspace | MatrixLike) -> ExactMatrix:
    matrix = rows.basis if isinstance(rows, Subspace) else rows
    if not hasattr(matrix, "nrows"):
        table = [list(row) for row in matrix]
        matrix = rho.field.matrix(table, (len(table), rho.size if not table else len(table[0])))
    basis: ExactMatrix = rho.field.read(matrix)
    if basis.ncols != rho.size:
        raise ShapeError(f"rows of length {basis.ncols}, the representation acts on {rho.size} coordinates")
    return basis


def _independent(rho: Representation, rows: Subspace | MatrixLike) -> ExactMatrix:
    matrix = _rows(rho, rows)
    kept = independent_rows(matrix)
    if dependent := sorted(set(range(matrix.nrows)) - set(kept)):
        raise DependentRowsError(len(kept), dependent, "rows of the subspace")
    return matrix


# The socle.  Let L be a Lie algebra of matrices on V.  [L, rad L] acts nilpotently and is the radical of tr(x y) on
# [L, L], because a semisimple linear algebra has a nondegenerate trace form.  The subspace W annihilated by [L, rad L]
# is not zero by Engel's theorem, and contains every irreducible subspace.  On W the radical of L is central and L is
# reductive.  A vector v of W is in the socle if and only if every central z acts on it semisimply: f(z) v = 0, f the
# squarefree part of the characteristic polynomial of z.


def socle(rho: Representation) -> Subspace:
    """Implements `Representation.socle`."""
    field, size = rho.field, rho.size
    if not rho.matrices or size == 0 or is_visibly_semisimple(rho):
        return Subspace(field, field.identity(size), size)
    inside = nilpotent_rows(rho).null_space()
    matrices = restricted(exact_matrices(rho), inside)
    kept = Subspace(field, field.identity(inside.nrows), inside.nrows)
    for x in _central(rho, matrices):
        value = semisimple_defect(combination(matrices, x))
        if not value.is_zero():
            kept = kept.intersection(Subspace(field, value.null_space(), inside.nrows))
    return Subspace(field, kept.basis @ inside, size)


def semisimple_defect(z: ExactMatrix) -> ExactMatrix:
    """f(z), f the squarefree part of the characteristic polynomial: its kernel is the part where z is semisimple."""
    f = Polynomial(z.field, z.characteristic_coefficients())
    return evaluated(f // f.gcd(f.derivative()), z)


def is_completely_reducible(rho: Representation) -> bool:
    """Implements `Representation.is_completely_reducible`."""
    return socle(rho).dimension == rho.size


def is_visibly_semisimple(rho: Representation) -> bool:
    """Whether the Killing form is nondegenerate modulo a prime, which proves complete reducibility (Weyl)."""
    return int(as_exact(rho.algebra.killing_form()).modulo().rank()) == rho.algebra.dimension


def nilpotent_rows(rho: Representation) -> ExactMatrix:
    """Rows that span the row spaces of [L, rad L], L the matrices of a representation."""
    field, size = rho.field, rho.size
    none: ExactMatrix = field.zeros(0, size)
    flat = field.stack_rows([a.reshape(1, size * size) for a in rho.matrices], size * size)
    series = rho.algebra.derived_series()
    derived = series[1].basis if len(series) > 1 else field.identity(rho.algebra.dimension)
    if series[0].dimension == 0 or derived.nrows == 0:
        return none
    radical = trace_radical((derived @ flat).row_space().split_rows(size, size))
    return field.stack_rows(radical, size).row_space() if radical else none


def _central(rho: Representation, matrices: list[ExactMatrix]) -> list[list[Scalar]]:
    """Coefficients of elements of g whose images span the centre of the span of the (restricted) matrices."""
    field, n = rho.field, rho.algebra.dimension
    size = matrices[0].nrows ** 2
    flat = field.stack_rows([a.reshape(1, size) for a in matrices], size)
    brackets = rho.algebra.table.contract(field.identity(n), field.identity(n), flat)
    return field.stack_rows([b.reshape(1, n * size) for b in brackets], n * size).left_null_space().to_rows()


@final
@dataclass(frozen=True, slots=True)
class MaximalSubmodules:
    """The maximal invariant subspaces of a representation over the reals; each proper one is in one of them.

    They are the annihilators of the irreducible subspaces of the dual representation, which lie in its socle. There are
    finitely many if and only if no irreducible representation occurs twice in this socle.

    Attributes
    ----------
    isolated : tuple of Subspace
        Maximal invariant subspaces, each over the smallest real field of its component.
    families : tuple of Subspace
        For each irreducible representation that occurs several times in the socle of the dual: the intersection of the
        infinitely many maximal invariant subspaces that belong to it.

    Examples
    --------
    >>> import liehom as lh
    >>> rho = lh.defining(lh.so(3)).direct_sum(lh.representations.trivial(lh.so(3), 2))
    >>> maximal = rho.maximal_submodules()
    >>> [space.dimension for space in maximal.isolated], [space.dimension for space in maximal.families]
    ([2], [3])
    """

    isolated: tuple[Subspace, ...]
    families: tuple[Subspace, ...]

    @property
    def is_finite(self) -> bool:
        """Whether `isolated` lists all maximal invariant subspaces."""
        return not self.families


def maximal_submodules(rho: Representation) -> MaximalSubmodules:
    """Implements `Representation.maximal_submodules`."""
    dual = rho.dual()
    socle = dual.socle()
    isolated: list[Subspace] = []
    families: list[Subspace] = []
    for part in dual.subrepresentation(socle).decomposition().isotypic if socle.dimension else ():
        rows = as_exact(part.subspace.basis) @ part.extension.matrix(as_exact(socle.basis))
        annihilator = Subspace(part.field, rows.null_space(), rho.size)
        (isolated if part.multiplicity == 1 else families).append(annihilator)
    return MaximalSubmodules(tuple(isolated), tuple(families))
