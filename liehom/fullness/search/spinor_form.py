"""The definite form of spin(9,1) on R^16, from the vector representation inside Sym^2 of the dual.

Under so(10, C) the symmetric forms on a half-spin module are 10 + 126, and the Casimir operator of the trace form
distinguishes the two parts. On the 10 the algebra preserves one form. If its signature is (9,1), a timelike vector is a
definite form on V. The half-spin module of so(5,5) has the same dimensions and signature (5,5), so it gives no form.
"""

from __future__ import annotations

import random
from collections.abc import Iterator

from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction
from liehom.representations.invariants.intertwiners import invariant_forms
from liehom.representations.invariants.irreducibility import combination, trace_form
from liehom.scalars import ExactField, ExactMatrix, Scalar
from liehom.scalars.spaces.forms import orthogonal_basis


def vector_module_form(action: TracelessIsotropyAction) -> ExactMatrix | None:
    """Definite symmetric form on V = K^16 whose stabilizer in L0 is so(9), or None if L0 is not spin(9,1)."""
    module = _small_module(action)
    if module is None:
        return None
    field, d = action.field, action.size
    flat = field.stack_rows([p.reshape(1, d * d) for p in module], d * d)
    matrices = []
    for a in action.traceless:
        images = field.stack_rows([_moved(a, p).reshape(1, d * d) for p in module], d * d)
        matrices.append(flat.T.solve(images.T))
    symmetric = invariant_forms(matrices, len(module), field).symmetric
    if len(symmetric) != 1:
        return None
    form = symmetric[0]
    positive, negative, _ = form.signature()
    if {positive, negative} != {1, 9}:
        return None
    sign = 1 if positive == 1 else -1
    rows, values = orthogonal_basis(form)
    timelike = next(r for r, v in zip(rows, values, strict=True) if field.sign(v) == sign)
    candidate: ExactMatrix = combination(module, timelike.row(0))
    return candidate if candidate.signature()[0] == d else -candidate


def _moved(a: ExactMatrix, p: ExactMatrix) -> ExactMatrix:
    return a.T @ p + p @ a


def _small_module(action: TracelessIsotropyAction) -> list[ExactMatrix] | None:
    """Basis of the ten-dimensional invariant space of symmetric forms, or None."""
    field, d = action.field, action.size
    basis = action.traceless
    gram = trace_form(basis)
    if gram.rank() < len(basis):
        return None
    flat = field.stack_rows([a.reshape(1, d * d) for a in basis], d * d)
    duals = (gram.inverse() @ flat).split_rows(d, d)

    def casimir(p: ExactMatrix) -> ExactMatrix:
        total = field.zeros(d, d)
        for a, b in zip(basis, duals, strict=True):
            total = total + _moved(a, _moved(b, p))
        return total

    for start in _starts(field, d):
        once = casimir(start)
        if _dependent(start, once):
            continue
        values = _two_eigenvalues(start, once, casimir(once))
        if values is None:
            return None
        # The Casimir of the trace form is smaller on the vector representation than on the 126.
        return _spanned(action, once - start.scale(values[1]))
    return None


def _starts(field: ExactField, d: int) -> Iterator[ExactMatrix]:
    """Symmetric forms, one of which has components in both parts if the forms on V have two parts.

    A random form has both nearly always. If no form E_ij + E_ji has, some lie in the part of the first one and some
    in the other part, so that its sum with one of them has both.
    """
    rng = random.Random(10)
    half = field.from_integers([rng.randint(-3, 3) for _ in range(d * d)], d, d)
    yield half + half.T
    units = [field.unit(d, i).T @ field.unit(d, j) for i in range(d) for j in range(i + 1)]
    basis = [unit + unit.T for unit in units]
    yield from basis
    yield from (basis[0] + other for other in basis[1:])


def _dependent(start: ExactMatrix, once: ExactMatrix) -> bool:
    """Whether the Casimir operator maps a form to a multiple of it: the form lies in one part."""
    i, j = next((i, j) for i in range(start.nrows) for j in range(i + 1) if start[i, j] != 0)
    return bool(once == start.scale(once[i, j] / start[i, j]))


def _two_eigenvalues(start: ExactMatrix, once: ExactMatrix, twice: ExactMatrix) -> tuple[Scalar, Scalar] | None:
    """Pair low < high with twice = (low + high) once - low high start, or None if the field does not contain it."""
    field, d = start.field, start.nrows
    table = field.stack_rows([m.reshape(1, d * d) for m in (once, start, twice)], d * d)
    relation = table.left_null_space()
    if relation.nrows != 1:
        return None
    total, product = -relation[0, 0] / relation[0, 2], relation[0, 1] / relation[0, 2]
    try:
        root = field.sqrt(total * total - product * 4)
    except ValueError:
        return None
    return (total - root) / 2, (total + root) / 2


def _spanned(action: TracelessIsotropyAction, seed: ExactMatrix) -> list[ExactMatrix] | None:
    """Basis of the submodule that a form generates, or None if its dimension is not 10."""
    field, d = action.field, action.size
    span, before = seed.reshape(1, d * d), 0
    while before < span.nrows:
        before = span.nrows
        forms = span.split_rows(d, d)
        images = [_moved(a, p).reshape(1, d * d) for p in forms for a in action.traceless]
        span = field.stack_rows([span, *images], d * d).row_space()
        if span.nrows > 10:
            return None
    return span.split_rows(d, d) if span.nrows == 10 else None
