"""How the decision writes certificates: from vectors and matrices on V to the fields that a checker reads."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from liehom.fullness.certificates.certificate import Certificate
from liehom.fullness.traceless_isotropy_action import IsotropyAlgebra

RATIONAL_MINPOLY, RATIONAL_INTERVAL = ["0", "1"], ["-1", "1"]


def _texts(action: IsotropyAlgebra, row: Any) -> list[str]:
    return [action.field.format(v) for v in row.row(0)]


def trivial(action_field: Any) -> Certificate:
    """FULL because dim g/h <= 1."""
    return Certificate("trivial", {}, action_field)


def rational_witness(action: IsotropyAlgebra, x: Any, phi: Any) -> Certificate:
    """NOT FULL: a column x of V over the input field and a row phi with phi(L x) = 0; both made primitive."""
    x, phi = x.primitive(), phi.primitive()
    return Certificate(
        "witness",
        {
            "minpoly": RATIONAL_MINPOLY,
            "interval": RATIONAL_INTERVAL,
            "eta": _texts(action, action.lifted(x)),
            "phi": _texts(action, action.covector(phi)),
        },
        action.field,
    )


def algebraic_witness(
    action: IsotropyAlgebra, minpoly: Sequence[Any], interval: tuple[Any, Any], xs: Sequence[Any], phis: Sequence[Any]
) -> Certificate:
    """NOT FULL: x = sum theta^j xs[j] (columns) and phi = sum theta^j phis[j] (rows), theta a root of minpoly."""

    def coordinates(rows: list[Any]) -> list[list[str]]:
        columns = [_texts(action, row) for row in rows]
        out = []
        for values in zip(*columns, strict=True):
            kept = list(values)
            while len(kept) > 1 and kept[-1] == "0":
                kept.pop()
            out.append(kept)
        return out

    return Certificate(
        "witness",
        {
            "minpoly": [action.field.format(c) for c in minpoly],
            "interval": [action.field.format(action.field.convert(c)) for c in interval],
            "eta": coordinates([action.lifted(x) for x in xs]),
            "phi": coordinates([action.covector(phi) for phi in phis]),
        },
        action.field,
    )


def full(action: IsotropyAlgebra, form: Any, elements: Any, x: Any) -> Certificate:
    """FULL: a definite form on V, rows of h acting conformally skew, and a point where they span."""
    projection = action.quotient.projection
    lifted = projection @ form @ projection.T
    entries = lifted.to_strings()
    sparse = [[i, j, v] for i, row in enumerate(entries) for j, v in enumerate(row) if v != "0"]
    dense = len(sparse) * 2 > lifted.nrows**2
    return Certificate(
        "full",
        {
            "form": entries if dense else sparse,
            "elements": elements.to_strings(),
            "eta": _texts(action, action.lifted(x)),
        },
        action.field,
    )


def commutant_cut(action: IsotropyAlgebra, matrix: Any, cut: Any) -> Certificate:
    """NOT FULL: a matrix that commutes with rho(h) and has eigenvalues on both sides of the cut."""
    return Certificate.over(action.field, "commutant", matrix=matrix, complement=action.quotient.lift, cut=cut)


def dominance(action: IsotropyAlgebra, element: Any, cut: Any, eps: Any) -> Certificate:
    """NOT FULL: an element of h whose top eigenspace moves in too few directions."""
    return Certificate.over(action.field, "dominance", element=element.row(0), cut=cut, eps=eps)
