"""Collocation methods (Gauss, Radau IIA, the trapezoidal rule), computed from their nodes alone.

The polynomial u of degree s with u(t) = y and u'(t + c_i h) = f(t + c_i h, u(t + c_i h)) for i = 1, ..., s gives
the Runge-Kutta method with a_ij = int_0^{c_i} l_j and b_j = int_0^1 l_j, l_j the Lagrange polynomials of c
(E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration, theorem II.1.4).  Written with the matrix
W_ik = c_i^(k-1): a = (c_i^k / k) W^(-1), b = (1/k) W^(-1).
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import comb

import numpy as np
import numpy.typing as npt

from liehom.errors import InputError
from liehom.integrators.tableaux.rooted_trees import MAX_ORDER
from liehom.integrators.tableaux.tableau import Tableau
from liehom.scalars import QQ, RR, Field, Scalar, common_field
from liehom.typing import ScalarLike

GAUSS_DIGITS = 60
"""Correct decimal digits of the nodes of Gauss methods with 4 and more stages, before they are rounded to float64."""


def collocation(name: str, nodes: Sequence[ScalarLike], order: int, *, field: Field | None = None) -> Tableau:
    """The `Tableau` of the collocation method with given nodes.

    Parameters
    ----------
    name : str
    nodes : sequence of length s
        Different numbers: strings, integers, fractions.
    order : int
        The claimed order: s, or more if the nodes are those of a quadrature formula of higher order.
    field : Field, optional
        An exact field that contains the nodes (default: the smallest such field).

    Raises
    ------
    InputError
        If nodes coincide, or the order is not reached.
    FieldError, ParseError
        If a node is not in an exact field.

    Examples
    --------
    >>> collocation("equal steps", [0, "1/2", 1], order=4)
    <tableau 'equal steps' of order 4, 3 stages, over QQ>
    """
    texts = [x if isinstance(x, str) else str(x) for x in nodes]
    numbers = common_field(texts) if field is None else field
    if not numbers.exact:
        raise InputError("collocation solves for its coefficients exactly; give nodes in an exact field")
    c = [numbers.convert(x) for x in (texts if field is None else nodes)]
    if len(set(c)) != len(c):
        raise InputError(f"the nodes of a collocation method are different numbers, got {', '.join(texts)}")
    *a, b = _coefficients(c, numbers)
    return Tableau(name, a, b, order, c=c, field=numbers)


def _coefficients(c: list[Scalar], field: Field) -> list[list[Scalar]]:
    """Rows of a, and b as a last row (the integrals to 1)."""
    powers = field.matrix([[x**k for k in range(len(c))] for x in c])
    ends = [*c, field.one]
    integrals = field.matrix([[x ** (k + 1) / (k + 1) for k in range(len(c))] for x in ends])
    rows: list[list[Scalar]] = (integrals @ powers.inverse()).to_rows()
    return rows


def gauss(stages: int) -> Tableau:
    """The Gauss method with s stages, of order 2 s: collocation at the zeros of the Legendre polynomial.

    Up to 3 stages it is exact, over QQ, QQ(sqrt(3)) and QQ(sqrt(15)). For 4 and more stages, the nodes are computed
    with 60 digits, and the coefficients are rounded to float64.

    Parameters
    ----------
    stages : int
        From 1 to 7.

    Raises
    ------
    InputError
        If the number of stages is not an integer from 1 to 7.

    Examples
    --------
    >>> gauss(2)
    <tableau 'gauss2' of order 4, 2 stages, over QQ(sqrt(3))>
    >>> gauss(4).order, gauss(4).residual < 1e-15
    (8, True)
    """
    if isinstance(stages, bool) or not isinstance(stages, int) or not 1 <= stages <= MAX_ORDER // 2:
        raise InputError(f"a Gauss method has 1 to {MAX_ORDER // 2} stages here, got {stages!r}")
    exact = {
        1: ["1/2"],
        2: ["1/2 - sqrt(3)/6", "1/2 + sqrt(3)/6"],
        3: ["1/2 - sqrt(15)/10", "1/2", "1/2 + sqrt(15)/10"],
    }
    name = f"gauss{stages}"
    if stages in exact:
        return collocation(name, exact[stages], 2 * stages)
    return _in_floats(name, _legendre_zeros(stages), 2 * stages)


def radau(stages: int) -> Tableau:
    """The Radau IIA method with s stages, of order 2 s - 1, in float64; it is L-stable.

    Parameters
    ----------
    stages : int
        From 2 to 7.

    Raises
    ------
    InputError
        If the number of stages is not an integer from 2 to 7.

    Examples
    --------
    >>> radau(5).order, radau(5).residual < 1e-13, radau(5).c[-1]
    (9, True, 1.0)
    """
    if isinstance(stages, bool) or not isinstance(stages, int) or not 2 <= stages <= MAX_ORDER // 2:
        raise InputError(f"a Radau IIA method has 2 to {MAX_ORDER // 2} stages here, got {stages!r}")
    # the nodes are 1 and the zeros of P_s - P_(s-1), divided by x - 1
    high, low = _legendre(stages), [*_legendre(stages - 1), 0]
    difference = [a - b for a, b in zip(high, low, strict=True)]
    starts = np.sort(np.polynomial.polynomial.polyroots([float(c) for c in difference]).real)[:-1]
    return _in_floats(f"radau{2 * stages - 1}", [*_refined(difference, starts), QQ.one], 2 * stages - 1)


def _in_floats(name: str, c: list[Scalar], order: int) -> Tableau:
    *a, b = [[QQ.to_float(x) for x in row] for row in _coefficients(c, QQ)]
    return Tableau(name, a, b, order, c=[QQ.to_float(x) for x in c], field=RR)


def _legendre(n: int) -> list[int]:
    """Coefficients of the Legendre polynomial on [0, 1], with value 1 at 1, from the constant one on."""
    return [(-1) ** (n - k) * comb(n, k) * comb(n + k, k) for k in range(n + 1)]


def _legendre_zeros(n: int) -> list[Scalar]:
    """The zeros of the Legendre polynomial on [0, 1], as rational numbers with `GAUSS_DIGITS` correct digits."""
    return _refined(_legendre(n), (1 + np.polynomial.legendre.leggauss(n)[0]) / 2)


def _refined(ascending: list[int], starts: npt.NDArray[np.float64]) -> list[Scalar]:
    """Zeros of a polynomial near the starts, as rational numbers with `GAUSS_DIGITS` correct digits."""
    scale = 10 ** (GAUSS_DIGITS + 5)
    zeros: list[Scalar] = []
    for start in starts:
        x = Fraction(float(start))
        for _ in range(4):  # Newton, from 8 digits on
            value = sum(c * x**k for k, c in enumerate(ascending))
            slope = sum(k * c * x ** (k - 1) for k, c in enumerate(ascending) if k)
            x = Fraction(round((x - value / slope) * scale), scale)
        zeros.append(QQ.convert(x))
    return zeros
