"""Certificates from definite and invariant symmetric forms of L0, which decide compact and indefinite isotropy.

If L0 preserves a definite form, the pair is full if and only if the rank is d at one point. If L0 preserves any other
form P != 0, then P(Lx, x) = 0 on the null cone of P, and P x = 0 implies that L x lies in ker P: a null vector is a
witness.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from itertools import product

from liehom.base.errors import FieldError
from liehom.exact.algebra.linear.closure import lie_closure
from liehom.exact.fullness import certificate_writer
from liehom.exact.fullness.certificate import Certificate
from liehom.exact.fullness.isotropy_action import TracelessIsotropyAction
from liehom.exact.representations.invariants.intertwiners import commutant, invariant_forms
from liehom.exact.representations.invariants.irreducibility import (
    anticommutator_gram,
    combination,
    trace_form,
    traceless,
)
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.modular import independent_columns, independent_rows
from liehom.exact.scalars.subspaces import orthogonal_basis


def decide_by_forms(action: TracelessIsotropyAction, symmetric: Sequence[ExactMatrix], x: ExactMatrix) -> Certificate:
    """Certificate for an L0 that preserves a symmetric form."""
    for form in symmetric:
        if max(form.signature()[:2]) < action.size:
            return null_witness(action, form)
    if len(symmetric) > 1:
        # The eigenvalues of P1^-1 P2 are real and not all equal, so their mean lies strictly between two.
        first, second = symmetric[:2]
        return null_witness(action, second - first.scale((first.inverse() @ second).trace() / action.size))
    form = symmetric[0]
    definite = form if form.signature()[0] == action.size else -form
    members = action.spanning_members(x) or []
    return certificate_writer.full(action, definite, action.quotient.subspace.select(rows=members), x)


def null_witness(action: TracelessIsotropyAction, form: ExactMatrix) -> Certificate:
    """A witness on the null cone of an invariant form that is not definite; over the input field if one is found."""
    field = action.field
    rows, values = orthogonal_basis(form)
    for u, v in zip(rows, values, strict=True):
        if v == 0:
            phi = next(form.select(rows=[i]) for i in range(form.nrows) if not form.select(rows=[i]).is_zero())
            return certificate_writer.rational_witness(action, u.T, phi)
    positive = [(u, v) for u, v in zip(rows, values, strict=True) if field.sign(v) > 0]
    negative = [(u, v) for u, v in zip(rows, values, strict=True) if field.sign(v) < 0]
    for (u, p), (w, n) in product(positive, negative):
        root = _square_root(field, -p / n)
        if root is not None:
            x = (u + w.scale(root)).T
            return certificate_writer.rational_witness(action, x, x.T @ form)
    small = _small_null_vector(rows, values)
    if small is not None:
        return certificate_writer.rational_witness(action, small.T, small @ form)
    (u, p), (w, n) = positive[0], negative[0]
    square = -p / n
    above = 2
    while field.sign(square - above * above) >= 0:
        above *= 2
    return certificate_writer.algebraic_witness(
        action, [-square, field.zero, field.one], (field.zero, field.convert(above)), [u.T, w.T], [u @ form, w @ form]
    )


def _square_root(field: ExactField, value: Scalar) -> Scalar | None:
    try:
        return field.sqrt(value)
    except FieldError:
        return None


def _small_null_vector(
    rows: Sequence[ExactMatrix], values: Sequence[Scalar], size: int = 6, bound: int = 4
) -> ExactMatrix | None:
    """A null vector with coefficients from 1 to `bound` on three of the orthogonal directions, or None."""
    field = rows[0].field
    picked = list(range(min(size, len(rows))))
    picked += [i for i, v in enumerate(values) if field.sign(v) != field.sign(values[0])][:2]
    for i, j, k in (p for p in product(picked, repeat=3) if p[0] < p[1] < p[2]):
        for a, b, c in product(range(1, bound + 1), repeat=3):
            if values[i] * (a * a) + values[j] * (b * b) + values[k] * (c * c) == 0:
                return rows[i].scale(a) + rows[j].scale(b) + rows[k].scale(c)
    return None


# The definite form of spin(9,1) on R^16, from the vector representation inside Sym^2 of the dual: under so(10, C) the
# symmetric forms on a half-spin module are 10 + 126, and the Casimir operator of the trace form distinguishes the two
# parts. On the 10 the algebra preserves one form. If its signature is (9,1), a timelike vector is a definite form on V.
# The half-spin module of so(5,5) has the same dimensions and signature (5,5), so it gives no form.


def vector_module_form(action: TracelessIsotropyAction) -> ExactMatrix | None:
    """Definite symmetric form on V = K^16 whose stabilizer in L0 is so(9), or None if L0 is not spin(9,1)."""
    module = _small_module(action)
    if module is None:
        return None
    field, d, columns = action.field, action.size, action.flat(module).T
    matrices = [columns.solve(action.flat([_moved(a, p) for p in module]).T) for a in action.traceless]
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
    duals = (gram.inverse() @ action.flat(basis)).split_rows(d, d)

    def casimir(p: ExactMatrix) -> ExactMatrix:
        return sum((_moved(a, _moved(b, p)) for a, b in zip(basis, duals, strict=True)), field.zeros(d, d))

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
    relation = field.stack_rows([m.reshape(1, d * d) for m in (once, start, twice)], d * d).left_null_space()
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
        images = action.flat([_moved(a, p) for p in span.split_rows(d, d) for a in action.traceless])
        span = field.stack_rows([span, images], d * d).row_space()
        if span.nrows > 10:
            return None
    return span.split_rows(d, d) if span.nrows == 10 else None


# Definite forms that prove a non-compact L0 transitive, if L0 is one of sl(d,R), sp(d,R), sl(m,C), sp(2m,C), sl(m,H),
# with compact factors, or spin(9,1). The form is constructed over the input field from the commutant and the skew-
# symmetric forms of the sum L1 of the non-compact ideals (docs/theory/fullness.md, construction of P). The recognition
# of L0 only proposes a form; the rank at one point under the elements that preserve the form is the proof.


def full_by_positive_form(action: TracelessIsotropyAction, imaginary: Sequence[ExactMatrix]) -> Certificate | None:
    """Certificate of kind 'full' for a transitive non-compact L0, or None if no form is recognized."""
    form = propose_form(action, imaginary)
    if form is None or form.signature()[0] < action.size:
        return None
    return certify_form(action, form)


def certify_form(action: TracelessIsotropyAction, form: ExactMatrix) -> Certificate | None:
    """Certificate of kind 'full' if the elements of L0 that preserve the form span at one point, else None."""
    field, d = action.field, action.size
    keeping = action.flat([a.T @ form + form @ a for a in action.traceless]).left_null_space()
    x = field.unit(d, 0).T
    moved = field.stack_rows([(a @ x).T for a in action.traceless], d)
    columns = independent_columns(field.stack_rows([x.T, keeping @ moved], d).T)
    if len(columns) < d:
        return None
    chosen = keeping.select(rows=[i - 1 for i in columns[1:]])
    return certificate_writer.full(action, form, chosen @ action.quotient.subspace.select(rows=action.members), x)


def propose_form(action: TracelessIsotropyAction, imaginary: Sequence[ExactMatrix]) -> ExactMatrix | None:
    """Symmetric form on V chosen by d, dim L0 and the dimension of the commutant, or None."""
    d, size, kind = action.size, action.dimension, len(imaginary)
    m = d // 4
    if kind == 3:
        return quaternionic_form(action, imaginary) if size == 4 * m * m - 1 else None
    if kind == 1:
        return _complex_case(action, imaginary, m)
    if kind:
        return None
    if size == d * d - 1:
        return action.field.identity(d)
    if size == d * (d + 1) // 2:
        skew = invariant_forms(action.traceless, d, action.field).skew
        return None if len(skew) != 1 else symplectic_form(skew[0])
    if d == 16 and size == 45:
        return vector_module_form(action)
    if d % 4 == 0 and m >= 2 and size == 4 * m * m + 2:
        return _with_quaternion_factor(action, m)
    return None


def _complex_case(action: TracelessIsotropyAction, imaginary: Sequence[ExactMatrix], m: int) -> ExactMatrix | None:
    d, size = action.size, action.dimension
    half = d // 2
    if size in (2 * half * half - 2, 2 * half * half - 1):
        return quaternionic_form(action, imaginary)  # 1 + J^T J / a, the same sum with one unit
    if d % 4:
        return None
    symplectic = 2 * m * (2 * m + 1)
    if size == 4 * m * m:
        derived = _derived(action)
        units = traceless(commutant(derived, d, action.field), d, action.field)
        return quaternionic_form(action, units) if len(units) == 3 and m >= 2 else None
    if size in (symplectic, symplectic + 1):
        derived = action.traceless if size == symplectic else _derived(action)
        skew = invariant_forms(derived, d, action.field).skew
        return complex_symplectic_form(skew[0], imaginary[0]) if len(skew) == 2 else None
    return None


def _derived(action: TracelessIsotropyAction) -> list[ExactMatrix]:
    """Basis of [L0, L0], as matrices."""
    basis = action.traceless
    table = action.flat([a @ b - b @ a for i, a in enumerate(basis) for b in basis[:i]])
    return table.select(rows=independent_rows(table)).split_rows(action.size, action.size)


def quaternionic_form(action: TracelessIsotropyAction, imaginary: Sequence[ExactMatrix]) -> ExactMatrix | None:
    """Form 1 + sum u^T u / |u|^2, u orthogonal imaginary units of the commutant; None if some u^2 is not negative."""
    gram = anticommutator_gram(imaginary, action.size, action.field)
    if gram is None:
        return None
    field, d = action.field, action.size
    form = field.identity(d)
    for row, value in zip(*orthogonal_basis(gram), strict=True):
        if field.sign(value) >= 0:
            return None
        unit = combination(imaginary, row.row(0))
        form = form + (unit.T @ unit).scale(-1 / value)
    return form


def symplectic_form(skew: ExactMatrix) -> ExactMatrix | None:
    """Form for which a Darboux basis of a skew-symmetric form is orthonormal; None if that form is degenerate."""
    field, d = skew.field, skew.nrows
    rest = [field.unit(d, i) for i in range(d)]
    columns: list[ExactMatrix] = []
    while rest:
        u = rest.pop(0)
        image = u @ skew
        position = next((i for i, r in enumerate(rest) if (image @ r.T)[0, 0] != 0), None)
        if position is None:
            return None
        w = rest.pop(position)
        w = w.scale(1 / (image @ w.T)[0, 0])
        dual = w @ skew
        rest = [r - w.scale((image @ r.T)[0, 0]) + u.scale((dual @ r.T)[0, 0]) for r in rest]
        columns += [u, w]
    basis = field.stack_rows(columns, d)
    return (basis.T @ basis).inverse()


def complex_symplectic_form(skew: ExactMatrix, structure: ExactMatrix) -> ExactMatrix | None:
    """Hermitian form of a Darboux basis of w - (1/a) w(J., .) J over k(J), where J^2 = -a; None if it is degenerate."""
    field, d = skew.field, skew.nrows
    a = -(structure @ structure)[0, 0]
    turned = structure.T

    def omega(u: ExactMatrix, w: ExactMatrix) -> tuple[Scalar, Scalar]:
        image = skew @ w.T
        return (u @ image)[0, 0], -((u @ turned) @ image)[0, 0] / a

    def times(value: tuple[Scalar, Scalar], u: ExactMatrix) -> ExactMatrix:
        return u.scale(value[0]) + (u @ turned).scale(value[1])

    rest = [field.unit(d, i) for i in range(d)]
    kept: list[ExactMatrix] = []
    while rest:
        u = rest.pop(0)
        values = [omega(u, r) for r in rest]
        position = next((i for i, v in enumerate(values) if any(x != 0 for x in v)), None)
        if position is None:
            return None
        w, (p, q) = rest.pop(position), values[position]
        norm = p * p + a * q * q
        w = times((p / norm, -q / norm), w)
        reduced = [r - times(omega(r, w), u) + times(omega(r, u), w) for r in rest]
        span = field.stack_rows(reduced, d).row_space()
        rest = [span.select(rows=[i]) for i in range(span.nrows)]
        kept += [u, w]
    basis = field.stack_rows([*kept, *(u @ turned for u in kept)], d)  # rows b_i, J b_i
    weights = field.stack_rows([field.unit(d, i).scale(field.one if i < len(kept) else a) for i in range(d)], d)
    inverse = basis.inverse()
    return inverse @ weights @ inverse.T


def _with_quaternion_factor(action: TracelessIsotropyAction, m: int) -> ExactMatrix | None:
    """Form for sl(m,H) + sp(1); the units are the 3-dimensional ideal on which the Killing form is (2/m) trace form."""
    field = action.field
    algebra = lie_closure(action.traceless).algebra
    if algebra.dimension != action.dimension:
        return None
    rows = (algebra.killing_form() - trace_form(action.traceless).scale(field.convert(2) / m)).null_space()
    if rows.nrows != 3:
        return None
    return quaternionic_form(action, [combination(action.traceless, rows.row(i)) for i in range(3)])
