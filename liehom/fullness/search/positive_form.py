"""Definite forms that prove a non-compact L0 transitive, constructed in the sum L1 of the non-compact ideals.

If L0 is one of sl(d,R), sp(d,R), sl(m,C), sp(2m,C), sl(m,H), with compact factors, or spin(9,1), the form is
constructed over the input field from the commutant and the skew-symmetric forms (docs/theory/fullness.md, construction
of P). The recognition of L0 only proposes a form; the rank at one point under the elements that preserve the form is
the proof.
"""

from __future__ import annotations

from collections.abc import Sequence

from liehom.algebra import lie_closure
from liehom.fullness.certificates import certificate_writer
from liehom.fullness.certificates.certificate import Certificate
from liehom.fullness.search.spinor_form import vector_module_form
from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction
from liehom.representations.invariants.intertwiners import commutant, invariant_forms
from liehom.representations.invariants.irreducibility import anticommutator_gram, combination, trace_form, traceless
from liehom.scalars import ExactMatrix, Scalar
from liehom.scalars.modular.modular import independent_columns, independent_rows
from liehom.scalars.spaces.forms import orthogonal_basis


def full_by_positive_form(action: TracelessIsotropyAction, imaginary: Sequence[ExactMatrix]) -> Certificate | None:
    """Certificate of kind 'full' for a transitive non-compact L0, or None if no form is recognized.

    Parameters
    ----------
    imaginary : sequence of ExactMatrix
        A basis of the traceless commutant of L0: 0, 1 or 3 matrices, as the commutant is a division algebra.
    """
    form = propose_form(action, imaginary)
    if form is None or form.signature()[0] < action.size:
        return None
    return certify_form(action, form)


def certify_form(action: TracelessIsotropyAction, form: ExactMatrix) -> Certificate | None:
    """Certificate of kind 'full' if the elements of L0 that preserve the form span at one point, else None."""
    field, d = action.field, action.size
    rows = [(a.T @ form + form @ a).reshape(1, d * d) for a in action.traceless]
    keeping = field.stack_rows(rows, d * d).left_null_space()
    x = field.unit(d, 0).T
    moved = field.stack_rows([(a @ x).T for a in action.traceless], d)
    found = independent_columns(field.stack_rows([x.T, keeping @ moved], d).T)
    if len(found) < d:
        return None
    chosen = keeping.select(rows=[i - 1 for i in found[1:]])
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
    field, square = action.field, action.size**2
    basis = action.traceless
    rows = [(a @ b - b @ a).reshape(1, square) for i, a in enumerate(basis) for b in basis[:i]]
    table = field.stack_rows(rows, square)
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
            if (u @ field.identity(d)).is_zero() or len(kept) * 2 == d:
                break
            return None
        w, (p, q) = rest.pop(position), values[position]
        norm = p * p + a * q * q
        w = times((p / norm, -q / norm), w)
        reduced = []
        for r in rest:
            along, across = omega(r, w), omega(r, u)
            reduced.append(r - times(along, u) + times(across, w))
        span = field.stack_rows(reduced, d).row_space() if reduced else field.zeros(0, d)
        rest = [span.select(rows=[i]) for i in range(span.nrows)]
        kept += [u, w]
    if len(kept) * 2 != d:
        return None
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
    difference = algebra.killing_form() - trace_form(action.traceless).scale(field.convert(2) / m)
    rows = difference.null_space()
    if rows.nrows != 3:
        return None
    return quaternionic_form(action, [combination(action.traceless, rows.row(i)) for i in range(3)])
