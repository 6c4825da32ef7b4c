"""Numbers of a field as sympy numbers."""

from __future__ import annotations

from typing import Any

from liehom.scalars.fields.field import Field, Scalar
from liehom.scalars.fields.floating import FloatField
from liehom.scalars.fields.number_field import NumberField
from liehom.scalars.fields.rational import QQ
from liehom.typing import Expression


def sympy_number(field: Field, value: Scalar) -> Expression:
    """The sympy number equal to an element of a field.

    Elements of a number field become expressions in square roots, or in ``CRootOf`` if the generator is not a square
    root.

    Examples
    --------
    >>> from liehom.scalars import number_field
    >>> K = number_field("sqrt(2)")
    >>> sympy_number(QQ, QQ.convert("1/2")), sympy_number(K, K.convert("1/2 - sqrt(2)"))
    (1/2, 1/2 - sqrt(2))
    """
    import sympy

    if isinstance(field, FloatField):
        return sympy.Float(value)
    if not isinstance(field, NumberField):
        rational: Any = value
        return sympy.Rational(int(rational.p), int(rational.q))
    if field.symbol.startswith("sqrt("):
        root = sympy.sqrt(int(field.symbol[5:-1]))
    else:
        t = sympy.Symbol("t")
        # Real roots come first and in order, in sympy too.
        root = sympy.CRootOf(sympy.Add(*(c * t**p for p, c in enumerate(field.minpoly))), field.root_index)
    terms = (sympy_number(QQ, c) * (field.leading * root) ** p for p, c in enumerate(field.coordinates(value)))
    return sympy.Add(*terms)
