"""Certificates from vectors and matrices on V = g/h, as the decision has them, and the eta of a witness."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from liehom.base.typing import Array
from liehom.exact.fullness.certificate import Certificate
from liehom.exact.fullness.isotropy_action import TracelessIsotropyAction
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.field import Field, Scalar
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.polynomial import horner
from liehom.exact.scalars.rational import QQ


def eta_of_witness(
    action: TracelessIsotropyAction, certificate: Certificate
) -> tuple[list[Scalar] | None, Field | None, int | None]:
    """(eta, its field, exact rank of [rho(h) eta, eta]); all None if eta is in k(theta), k != QQ, theta outside k."""
    coordinates = certificate.fields["eta"]
    if all(not isinstance(c, tuple) or len(c) == 1 for c in coordinates):
        values = [c[0] if isinstance(c, tuple) else c for c in coordinates]
        row = action.field.matrix([values]) @ action.quotient.projection
        return values, action.field, action.rank_at(row.T)
    if action.field != QQ:
        return None, None, None
    low, high = certificate.vector("interval", 2)
    extension = NumberField("theta", certificate.vector("minpoly"), (low, high))
    polynomials = [c if isinstance(c, tuple) else (c,) for c in coordinates]
    values = [horner([*map(extension.convert, c)], extension.generator, extension.zero) for c in polynomials]
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


RATIONAL_MINPOLY, RATIONAL_INTERVAL = (0, 1), (-1, 1)
"""t and an interval around its root 0: for a witness over the field itself."""


def trivial(field: ExactField) -> Certificate:
    """Certificate of FULL for dim g/h <= 1."""
    return Certificate("trivial", {}, field)


def rational_witness(action: TracelessIsotropyAction, x: ExactMatrix, phi: ExactMatrix) -> Certificate:
    """Certificate of NOT FULL: a column x of V over the input field and a row phi with phi(L x) = 0, made primitive."""
    x, phi = x.primitive(), phi.primitive()
    return Certificate.over(
        action.field,
        "witness",
        minpoly=RATIONAL_MINPOLY,
        interval=RATIONAL_INTERVAL,
        eta=action.lifted(x).row(0),
        phi=action.covector(phi).row(0),
    )


def algebraic_witness(
    action: TracelessIsotropyAction,
    minpoly: Sequence[Scalar],
    interval: tuple[Scalar, Scalar],
    xs: Sequence[ExactMatrix],
    phis: Sequence[ExactMatrix],
) -> Certificate:
    """Certificate of NOT FULL: x = sum theta^j xs[j], phi = sum theta^j phis[j], theta a root of minpoly."""
    return Certificate.over(
        action.field,
        "witness",
        minpoly=minpoly,
        interval=interval,
        eta=_polynomials([action.lifted(x) for x in xs]),
        phi=_polynomials([action.covector(phi) for phi in phis]),
    )


def _polynomials(rows: Sequence[ExactMatrix]) -> list[list[Scalar]]:
    """Coefficients of each coordinate of sum theta^j rows[j]: at least one, and no further leading (last) zeros."""
    columns = zip(*(row.row(0) for row in rows), strict=True)
    return [list(column[: 1 + max((j for j, c in enumerate(column) if c != 0), default=0)]) for column in columns]


def full(action: TracelessIsotropyAction, form: ExactMatrix, elements: ExactMatrix, x: ExactMatrix) -> Certificate:
    """Certificate of FULL: a definite form on V, elements of h that preserve it up to scale, and a point."""
    projection = action.quotient.projection
    lifted = projection @ form @ projection.T
    rows = lifted.to_rows()
    entries = [(i, j, v) for i, row in enumerate(rows) for j, v in enumerate(row) if v != 0]
    form_field = rows if len(entries) * 2 > lifted.nrows**2 else entries
    fields = {"form": form_field, "elements": elements.to_rows(), "eta": action.lifted(x).row(0)}
    return Certificate("full", fields, action.field)


def commutant_cut(action: TracelessIsotropyAction, matrix: ExactMatrix, cut: Scalar) -> Certificate:
    """Certificate of NOT FULL: a matrix that commutes with rho(h), with eigenvalues on both sides of the cut."""
    return Certificate.over(action.field, "commutant", matrix=matrix, complement=action.quotient.lift, cut=cut)


def dominance(action: TracelessIsotropyAction, element: ExactMatrix, cut: Scalar, eps: Scalar) -> Certificate:
    """Certificate of NOT FULL: an element of h whose top eigenspace moves in too few directions."""
    return Certificate.over(action.field, "dominance", element=element.row(0), cut=cut, eps=eps)
