"""Certificates from invariant symmetric forms of L0, which decide compact and indefinite isotropy.

If L0 preserves a definite form, the pair is full if and only if the rank is d at one point. If L0 preserves any other
form P != 0, then P(Lx, x) = 0 on the null cone of P, and P x = 0 implies that L x lies in ker P: a null vector is a
witness.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

from liehom.errors import FieldError
from liehom.fullness.certificates import certificate_writer
from liehom.fullness.certificates.certificate import Certificate
from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction
from liehom.scalars import ExactField, ExactMatrix, Scalar
from liehom.scalars.spaces.forms import orthogonal_basis


def decide_by_forms(action: TracelessIsotropyAction, symmetric: Sequence[ExactMatrix], x: ExactMatrix) -> Certificate:
    """Certificate for an L0 that preserves a symmetric form.

    Parameters
    ----------
    action : TracelessIsotropyAction
    symmetric : sequence of ExactMatrix
        A basis, not empty, of the invariant symmetric forms.
    x : ExactMatrix
        A column of V at which the rank is d.
    """
    for form in symmetric:
        positive, negative, _ = form.signature()
        if max(positive, negative) < action.size:
            return null_witness(action, form)
    if len(symmetric) > 1:
        # The eigenvalues of P1^-1 P2 are real and not all equal, so their mean lies strictly between two.
        first, second = symmetric[:2]
        mean = (first.inverse() @ second).trace() / action.size
        return null_witness(action, second - first.scale(mean))
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
    for i, j, k in product(picked, picked, picked):
        if not i < j < k:
            continue
        for a, b, c in product(range(1, bound + 1), repeat=3):
            if values[i] * (a * a) + values[j] * (b * b) + values[k] * (c * c) == 0:
                return rows[i].scale(a) + rows[j].scale(b) + rows[k].scale(c)
    return None
