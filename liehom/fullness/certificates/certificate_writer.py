"""Certificates from vectors and matrices on V = g/h, which the steps of the decision find."""

from __future__ import annotations

from collections.abc import Sequence

from liehom.fullness.certificates.certificate import Certificate
from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction
from liehom.scalars import ExactField, ExactMatrix, Scalar

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
    out = []
    for coefficients in zip(*(row.row(0) for row in rows), strict=True):
        degree = max((j for j, c in enumerate(coefficients) if c != 0), default=0)
        out.append(list(coefficients[: degree + 1]))
    return out


def full(action: TracelessIsotropyAction, form: ExactMatrix, elements: ExactMatrix, x: ExactMatrix) -> Certificate:
    """Certificate of FULL: a definite form on V, elements of h that preserve it up to scale, and a point."""
    projection = action.quotient.projection
    lifted = projection @ form @ projection.T
    rows = lifted.to_rows()
    entries = [(i, j, v) for i, row in enumerate(rows) for j, v in enumerate(row) if v != 0]
    is_dense = len(entries) * 2 > lifted.nrows**2
    fields = {
        "form": rows if is_dense else entries,
        "elements": elements.to_rows(),
        "eta": action.lifted(x).row(0),
    }
    return Certificate("full", fields, action.field)


def commutant_cut(action: TracelessIsotropyAction, matrix: ExactMatrix, cut: Scalar) -> Certificate:
    """Certificate of NOT FULL: a matrix that commutes with rho(h), with eigenvalues on both sides of the cut."""
    return Certificate.over(action.field, "commutant", matrix=matrix, complement=action.quotient.lift, cut=cut)


def dominance(action: TracelessIsotropyAction, element: ExactMatrix, cut: Scalar, eps: Scalar) -> Certificate:
    """Certificate of NOT FULL: an element of h whose top eigenspace moves in too few directions."""
    return Certificate.over(action.field, "dominance", element=element.row(0), cut=cut, eps=eps)
