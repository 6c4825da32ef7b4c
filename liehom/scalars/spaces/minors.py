"""Minors of a matrix of polynomials, computed without division."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import combinations

import flint

Table = Sequence[Sequence[flint.fmpq_mpoly]]


def expanded_minors(
    table: Table,
    rows: Sequence[int],
    columns: Sequence[int],
    one: flint.fmpq_mpoly,
    reduced: Callable[[flint.fmpq_mpoly], flint.fmpq_mpoly] | None = None,
) -> dict[tuple[int, ...], flint.fmpq_mpoly]:
    """The non-zero minors with all of the given columns, by their rows: expansion along one column after another.

    Parameters
    ----------
    table : sequence of sequences of flint.fmpq_mpoly
    rows, columns : sequences of int
        In increasing order.
    one : flint.fmpq_mpoly
        The polynomial 1.
    reduced : callable, optional
        Normal form of a polynomial, applied after each column.

    Examples
    --------
    >>> x, y = flint.fmpq_mpoly_ctx.get(["x", "y"]).gens()
    >>> expanded_minors([[x, y], [y, x], [x, y]], [0, 1, 2], [0, 1], x**0)
    {(0, 1): x^2 - y^2, (1, 2): -x^2 + y^2}
    """
    minors: dict[tuple[int, ...], flint.fmpq_mpoly] = {(): one}
    for size, column in enumerate(columns, start=1):
        grown: dict[tuple[int, ...], flint.fmpq_mpoly] = {}
        for chosen in combinations(rows, size):
            total = 0 * one
            for place, row in enumerate(chosen):
                rest = minors.get(chosen[:place] + chosen[place + 1 :])
                entry = table[row][column]
                if rest is not None and not entry.is_zero():
                    term = entry * rest
                    total = total - term if (size - 1 - place) % 2 else total + term
            if reduced is not None:
                total = reduced(total)
            if not total.is_zero():
                grown[chosen] = total
        minors = grown
    return minors
