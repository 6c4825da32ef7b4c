"""Invariant subspaces: generated submodules, sub- and quotient representations, invariant complements.

Subspaces are given by rows b, on which a matrix A acts as b A^T.
"""

from __future__ import annotations

from collections.abc import Sequence

from liehom.errors import DependentRowsError, NotCompletelyReducibleError, NotInvariantError, ShapeError, SingularError
from liehom.representations.core.generating_matrices import exact_matrices, generating_matrices
from liehom.representations.core.representation import Representation
from liehom.representations.invariants.intertwiners import intertwiners
from liehom.scalars import ExactMatrix, Subspace
from liehom.scalars.fields.field import MatrixLike
from liehom.scalars.modular.modular import independent_rows
from liehom.scalars.spaces.quotient import quotient


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
    made = restricted(exact_matrices(rho), basis)
    # A homomorphism followed by restriction to an invariant subspace.
    return Representation(rho.algebra, made, size=basis.nrows, check=False)


def quotient_representation(rho: Representation, rows: Subspace | MatrixLike) -> Representation:
    """Implements `Representation.quotient`."""
    data = quotient(_independent(rho, rows))
    for i, a in enumerate(exact_matrices(rho)):
        moved = data.subspace @ a.T @ data.projection
        if not moved.is_zero():
            restricted(exact_matrices(rho), _independent(rho, rows))  # names the row as given
            raise _not_invariant(data.subspace, i, moved)
    made = [(data.lift @ a.T @ data.projection).T for a in exact_matrices(rho)]
    # The action descends to the quotient by an invariant subspace.
    return Representation(rho.algebra, made, size=data.lift.nrows, check=False)


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
        message = "the subspace has no invariant complement: no projection onto it commutes with the action"
        raise NotCompletelyReducibleError(message) from None
    total = field.zeros(k, size)
    for t, c in zip(maps, weights.entries(), strict=True):
        total = total + t.scale(c)
    return Subspace(field, total.null_space(), size)


def restricted(matrices: Sequence[ExactMatrix], basis: ExactMatrix, *, check: bool = True) -> list[ExactMatrix]:
    """The matrices (k, k), acting on columns, of the restrictions of maps to the span of independent rows (k, N).

    With ``check=False`` the invariance of the span is not checked.

    Raises
    ------
    NotInvariantError
        If the span is not invariant.
    """
    field, k = basis.field, basis.nrows
    if k == 0:
        return [field.zeros(0, 0) for _ in matrices]
    places = basis.echelon()[1]
    # basis @ reading = 1
    reading = field.identity(basis.ncols).select(columns=places) @ basis.select(columns=places).inverse()
    found = []
    for i, a in enumerate(matrices):
        moved = basis @ a.T
        inside = moved @ reading
        defect = moved - inside @ basis if check else None
        if defect is not None and not defect.is_zero():
            raise _not_invariant(basis, i, defect)
        found.append(inside.T)
    return found


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
    made: ExactMatrix = rho.field.read(matrix)
    if made.ncols != rho.size:
        raise ShapeError(f"rows of length {made.ncols}, the representation acts on {rho.size} coordinates")
    return made


def _independent(rho: Representation, rows: Subspace | MatrixLike) -> ExactMatrix:
    matrix = _rows(rho, rows)
    kept = independent_rows(matrix)
    if len(kept) < matrix.nrows:
        dependent = [i for i in range(matrix.nrows) if i not in set(kept)]
        raise DependentRowsError(len(kept), dependent, "rows of the subspace")
    return matrix
