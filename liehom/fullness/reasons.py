"""Reasons for verdicts, in one sentence, with the name of the transitive linear Lie algebra.

The name follows from d, dim L0 and the dimension of the commutant; no certificate depends on it.
"""

from __future__ import annotations

from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction


def compact_name(d: int, size: int, commutant: int) -> str:
    """Name of the transitive compact linear Lie algebra on R^d of dimension `size` with this commutant dimension.

    Examples
    --------
    >>> compact_name(6, 8, 2), compact_name(16, 36, 1), compact_name(16, 36, 4)
    ('su(3)', 'spin(9)', 'sp(4)')
    """
    m, q = d // 2, d // 4
    table = {(d * (d - 1) // 2, 2 if d == 2 else 1): f"so({d})"}
    if d % 4 == 0:
        table |= {(q * (2 * q + 1), 4): f"sp({q})", (q * (2 * q + 1) + 1, 2): f"sp({q})+u(1)"}
        table.setdefault((q * (2 * q + 1) + 3, 1), f"sp({q})+sp(1)")
    if d % 2 == 0 and d > 2:
        table |= {(m * m, 2): f"u({m})"}
        table.setdefault((m * m - 1, 2), f"su({m})")
    table |= {(14, 1): "g2"} if d == 7 else {(21, 1): "spin(7)"} if d == 8 else {(36, 1): "spin(9)"} if d == 16 else {}
    return table.get((size, commutant), "a compact algebra")


def noncompact_name(d: int, size: int, commutant: int) -> str:
    """Name of the transitive non-compact linear Lie algebra on R^d of dimension `size` with this commutant dimension.

    Examples
    --------
    >>> noncompact_name(8, 15, 4), noncompact_name(16, 45, 1)
    ('sl(2,H)', 'spin(9,1)')
    """
    m, q = d // 2, d // 4
    table = {(d * d - 1, 1): f"sl({d},R)"}
    table.setdefault((d * (d + 1) // 2, 1), f"sp({d},R)")
    if d % 2 == 0 and m > 1:
        table |= {(2 * m * m - 2, 2): f"sl({m},C)", (2 * m * m - 1, 2): f"sl({m},C)+u(1)"}
    if d % 4 == 0:
        big = 2 * q * (2 * q + 1)
        table.setdefault((big, 2), f"sp({m},C)")
        table.setdefault((big + 1, 2), f"sp({m},C)+u(1)")
        table |= {(4 * q * q - 1, 4): f"sl({q},H)", (4 * q * q + 2, 1): f"sl({q},H)+sp(1)"}
        table.setdefault((4 * q * q, 2), f"sl({q},H)+u(1)")
    if d == 16:
        table[45, 1] = "spin(9,1)"
    return table.get((size, commutant), "a non-compact algebra")


def full_reason(action: TracelessIsotropyAction, commutant: int, compact: bool) -> str:
    """Sentence that says why a pair of codimension at least 2 is full."""
    d, size = action.size, action.dimension
    scalars = " (up to scalars)" if any(a.trace() != 0 for a in action.matrices) else ""
    if compact:
        name = compact_name(d, size, commutant)
        return f"h acts on g/h = R^{d} as {name}{scalars}, compact and transitive on the sphere; checked at one point"
    name = noncompact_name(d, size, commutant)
    return (
        f"h acts on g/h = R^{d} as {name}{scalars}, transitive on the rays already through the elements that preserve "
        "a definite form; checked at one point"
    )
