"""A rational zero of a ternary quadratic form, where there is one. Imports forms; sympy where it is used."""

from __future__ import annotations

from math import gcd, lcm
from typing import Any

from liehom.scalars.exact_matrix import ExactMatrix
from liehom.scalars.forms import orthogonal_basis


def rational_zero(form: ExactMatrix) -> ExactMatrix | None:
    """A row x (1, 3), not zero, with x form x^T = 0 for a symmetric form over QQ, or None: there is none.

    Parameters
    ----------
    form : ExactMatrix
        Symmetric, (3, 3), over QQ.

    Notes
    -----
    The diagonal form a x^2 + b y^2 + c z^2 is solved by descent (Legendre's theorem decides), which factors a, b, c.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> x = rational_zero(QQ.matrix([[2, 0, 0], [0, 3, 0], [0, 0, -5]]))
    >>> (x @ QQ.matrix([[2, 0, 0], [0, 3, 0], [0, 0, -5]]) @ x.T).is_zero(), x.is_zero()
    (True, False)
    >>> rational_zero(QQ.matrix([[1, 0, 0], [0, 1, 0], [0, 0, -3]])) is None
    True
    """
    from sympy import symbols
    from sympy.solvers.diophantine.diophantine import diop_ternary_quadratic_normal

    rows, values = orthogonal_basis(form)
    for row, value in zip(rows, values, strict=True):
        if value == 0:
            zero: ExactMatrix = row
            return zero
    if all(v > 0 for v in values) or all(v < 0 for v in values):
        return None
    integers = _primitive(values)
    found = diop_ternary_quadratic_normal(
        sum(c * x**2 for c, x in zip(integers, symbols("x y z", integer=True), strict=True))
    )
    if found[0] is None:
        return None
    total: ExactMatrix = form.field.zeros(1, 3)
    for row, x in zip(rows, found, strict=True):
        total = total + row.scale(int(x))
    return total


def _primitive(values: list[Any]) -> list[int]:
    den = lcm(*(int(v.q) for v in values))
    integers = [int(v * den) for v in values]
    common = gcd(*integers)
    return [x // common for x in integers]
