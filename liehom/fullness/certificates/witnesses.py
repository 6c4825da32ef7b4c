"""The eta of a certificate of NOT FULL: exact with its rank, or rounded to floats."""

from __future__ import annotations

import numpy as np

from liehom.fullness.certificates.certificate import Certificate
from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction
from liehom.scalars import QQ, Field, NumberField, Scalar
from liehom.typing import Array


def eta_of_witness(
    action: TracelessIsotropyAction, certificate: Certificate
) -> tuple[list[Scalar] | None, Field | None, int | None]:
    """The triple (eta, its field, exact rank of [rho(h) eta, eta]); all None if eta is not in QQ(theta) or the field.

    An eta in k(theta), k a number field and theta outside k, would need an extension of k; it is in the certificate
    only.
    """
    coordinates = certificate.fields["eta"]
    if all(not isinstance(c, tuple) or len(c) == 1 for c in coordinates):
        values = [c[0] if isinstance(c, tuple) else c for c in coordinates]
        row = action.field.matrix([values]) @ action.quotient.projection
        return values, action.field, action.rank_at(row.T)
    if action.field != QQ:
        return None, None, None
    low, high = certificate.vector("interval", 2)
    extension = NumberField("theta", certificate.vector("minpoly"), (low, high))
    theta = extension.generator
    values = []
    for c in coordinates:
        total = extension.zero
        for coefficient in reversed(c if isinstance(c, tuple) else (c,)):
            total = total * theta + extension.convert(coefficient)
        values.append(total)
    row = extension.matrix([values]) @ extension.matrix(action.quotient.projection.to_rows())
    moved = [row, *[row @ extension.matrix(a.T.to_rows()) for a in action.matrices]]
    return values, extension, extension.stack_rows(moved, action.size).rank()


def numerical_eta(action: TracelessIsotropyAction, x: Array | None) -> list[float] | None:
    """Element of g, as floats, that represents a vector of V; None if its numbers exceed the range of floats."""
    lift = action.quotient.lift.to_numpy()
    return [float(v) for v in x @ lift] if x is not None and np.isfinite(lift).all() else None


def numerical_eta_of_commutant(action: TracelessIsotropyAction, certificate: Certificate) -> list[float] | None:
    """Element of g, as floats, in the invariant subspace for the largest real parts of the matrix, or None."""
    matrix = certificate.matrix("matrix", action.size, action.size).to_numpy()
    if not np.isfinite(matrix).all():
        return None
    try:
        values, vectors = np.linalg.eig(matrix)
    except np.linalg.LinAlgError:
        return None
    vector = vectors[:, int(values.real.argmax())]
    real = vector.real if np.abs(vector.real).max() > 1e-6 else vector.imag
    return numerical_eta(action, real / np.abs(real).max())
