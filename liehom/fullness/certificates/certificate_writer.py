"""How the decision writes certificates: from vectors and matrices on V to numbers in g."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from liehom.fullness.certificates.certificate import Certificate
from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction

RATIONAL_MINPOLY, RATIONAL_INTERVAL = (0, 1), (-1, 1)
"""t and an interval around its root 0: for a witness over the field itself."""


def trivial(action_field: Any) -> Certificate:
    """FULL because dim g/h <= 1."""
    return Certificate("trivial", {}, action_field)


def rational_witness(action: TracelessIsotropyAction, x: Any, phi: Any) -> Certificate:
    """NOT FULL: a column x of V over the input field and a row phi with phi(L x) = 0; both made primitive."""
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
    minpoly: Sequence[Any],
    interval: tuple[Any, Any],
    xs: Sequence[Any],
    phis: Sequence[Any],
) -> Certificate:
    """NOT FULL: x = sum theta^j xs[j] (columns) and phi = sum theta^j phis[j] (rows), theta a root of minpoly."""

    return Certificate.over(
        action.field,
        "witness",
        minpoly=minpoly,
        interval=interval,
        eta=_polynomials([action.lifted(x) for x in xs]),
        phi=_polynomials([action.covector(phi) for phi in phis]),
    )


def _polynomials(rows: Sequence[Any]) -> list[list[Any]]:
    """For each coordinate of sum theta^j rows[j] its coefficients, without leading (last) zeros but at least one."""
    out = []
    for coefficients in zip(*(row.row(0) for row in rows), strict=True):
        degree = max((j for j, c in enumerate(coefficients) if c != 0), default=0)
        out.append(list(coefficients[: degree + 1]))
    return out


def full(action: TracelessIsotropyAction, form: Any, elements: Any, x: Any) -> Certificate:
    """FULL: a definite form on V, rows of h acting conformally skew, and a point where they span."""
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


def commutant_cut(action: TracelessIsotropyAction, matrix: Any, cut: Any) -> Certificate:
    """NOT FULL: a matrix that commutes with rho(h) and has eigenvalues on both sides of the cut."""
    return Certificate.over(action.field, "commutant", matrix=matrix, complement=action.quotient.lift, cut=cut)


def dominance(action: TracelessIsotropyAction, element: Any, cut: Any, eps: Any) -> Certificate:
    """NOT FULL: an element of h whose top eigenspace moves in too few directions."""
    return Certificate.over(action.field, "dominance", element=element.row(0), cut=cut, eps=eps)
