"""Ball arithmetic (flint): rigorous enclosures of real roots with any precision, and certified signs.

A ball [m +- r] contains the number that it represents, so a comparison of disjoint balls is a proof. If balls overlap,
the precision is doubled.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import flint

from liehom.budget import within
from liehom.errors import FieldError, shown


@contextmanager
def working_precision(bits: int) -> Iterator[None]:
    """Context manager that sets flint's working precision (bits) for the block and restores it.

    Examples
    --------
    >>> with working_precision(200):
    ...     flint.ctx.prec
    200
    """
    before = flint.ctx.prec
    flint.ctx.prec = bits
    try:
        yield
    finally:
        flint.ctx.prec = before


def real_root_balls(polynomial: flint.fmpz_poly, precision: int) -> list[flint.arb]:
    """Disjoint balls around the real roots of a squarefree integer polynomial, in increasing order.

    Parameters
    ----------
    polynomial : flint.fmpz_poly
        Squarefree.
    precision : int
        Working precision in bits.

    Returns
    -------
    list of flint.arb

    Examples
    --------
    >>> [float(r) for r in real_root_balls(flint.fmpz_poly([-4, 0, 1]), 64)]
    [-2.0, 2.0]
    """
    with working_precision(precision):
        found: Any = polynomial.complex_roots()  # pairs of a root and its multiplicity
        roots = [r.real for r, _ in found if r.imag.is_zero()]
        return sorted(roots, key=lambda ball: ball.mid())


def root_ball(polynomial: flint.fmpz_poly, index: int, precision: int) -> flint.arb:
    """Ball (``flint.arb``) around real root number `index`, from the left, of a squarefree integer polynomial."""
    return real_root_balls(polynomial, precision)[index]


def isolate_real_root(
    polynomial: flint.fmpz_poly, interval: tuple[flint.fmpq, flint.fmpq]
) -> tuple[tuple[flint.fmpq, flint.fmpq], int]:
    """The interval and the index from the left of the one root that it contains.

    Parameters
    ----------
    polynomial : flint.fmpz_poly
        Irreducible of degree at least 2 (so no end is a root).
    interval : pair of flint.fmpq

    Raises
    ------
    FieldError
        If the interval is empty or does not contain exactly one root.

    Examples
    --------
    >>> isolate_real_root(flint.fmpz_poly([-2, 0, 1]), (flint.fmpq(1), flint.fmpq(2)))[1]
    1
    """
    low, high = interval
    if not low < high:
        raise FieldError(f"the interval ({shown(str(low))}, {shown(str(high))}) of a number field is empty")
    precision = 64
    while True:
        bits = precision * polynomial.degree()
        within("coefficient_bits", bits, "an end of the interval is so close to a root that {} bits are needed")
        balls = real_root_balls(polynomial, precision)
        with working_precision(precision):
            left, right = flint.arb(low), flint.arb(high)
            sides = [(b > left, b < left, b < right, b > right) for b in balls]
        if all((s[0] or s[1]) and (s[2] or s[3]) for s in sides):
            inside = [i for i, s in enumerate(sides) if s[0] and s[2]]
            if len(inside) == 1:
                return interval, inside[0]
            raise FieldError(
                f"the interval ({shown(str(low))}, {shown(str(high))}) contains {len(inside)} real roots of "
                f"{shown(str(polynomial))}; "
                f"it must contain exactly one ({len(balls)} real roots in all)"
            )
        precision *= 2
