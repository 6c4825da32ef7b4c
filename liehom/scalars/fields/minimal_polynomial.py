"""Checks of the two things that define a number field: a minimal polynomial and an interval."""

from __future__ import annotations

from collections.abc import Sequence

import flint

from liehom.budget import within
from liehom.errors import FieldError, displayed, shown
from liehom.scalars.fields.rational import QQ
from liehom.typing import ScalarLike


def irreducible_polynomial(minpoly: Sequence[ScalarLike]) -> flint.fmpz_poly:
    """The primitive integer polynomial with these ascending rational coefficients, up to a factor.

    Raises
    ------
    FieldError
        If its degree is less than 2, or it is reducible.
    LimitError
        If its degree or its coefficients are too large.

    Examples
    --------
    >>> irreducible_polynomial(["-1/2", 0, "1/4"])
    x^2 + (-2)
    """
    within("minpoly_degree", len(minpoly) - 1, "the minimal polynomial has degree {}")
    polynomial = flint.fmpq_poly([QQ.convert(c) for c in minpoly])
    if polynomial.degree() < 2:
        raise FieldError("the minimal polynomial of a number field must have degree at least 2")
    integral = polynomial.numer()
    bits = int(integral.height_bits()) * polynomial.degree()
    within("coefficient_bits", bits, "the minimal polynomial has coefficients of {} bits together")
    integral = integral // integral.content() * (1 if integral[integral.degree()] > 0 else -1)
    factors = integral.factor()[1]
    if len(factors) != 1 or factors[0][1] != 1:
        found = shown(", ".join(str(f) for f, _ in factors))
        raise FieldError(f"the minimal polynomial {shown(str(integral))} is reducible: factors {found}; use one")
    return integral


def rational_ends(interval: object) -> tuple[flint.fmpq, flint.fmpq]:
    """The two rational ends of an interval; `FieldError` if it is not a pair of rational numbers."""
    if not isinstance(interval, (tuple, list)) or len(interval) != 2:
        raise FieldError(f"the interval is {displayed(interval)}, expected its two rational ends")
    return QQ.convert(interval[0]), QQ.convert(interval[1])
