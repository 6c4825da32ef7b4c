"""Matrices of balls: rigorous enclosures of exact matrices, of their products and exponentials, and of norms."""

from __future__ import annotations

import flint

from liehom.scalars.fields.exact_field import ExactMatrix
from liehom.scalars.fields.field import Scalar
from liehom.scalars.fields.number_field import AlgebraicNumber, NumberField
from liehom.scalars.fields.rational import QQ

Ball = flint.arb
BallMatrix = flint.arb_mat


def ball_matrix(matrix: ExactMatrix, precision: int) -> flint.arb_mat:
    """Enclosure (``flint.arb_mat``) of a matrix over an exact field, with the current working precision.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> ball_matrix(QQ.matrix([["1/2", 0]]), 64)
    [0.500000000000000, 0]
    """
    total = flint.arb_mat(matrix.parts[0])
    if isinstance(matrix.field, NumberField):
        generator = matrix.field.generator_ball(precision)
        power = generator
        for part in matrix.parts[1:]:
            total += flint.arb_mat(part) * power
            power = power * generator
    return total * (flint.arb(1) / matrix.den)


def complex_ball(real: Scalar, imaginary: Scalar, precision: int) -> flint.acb:
    """Ball (``flint.acb``) around a complex number whose parts are rational or in real number fields.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> complex_ball(QQ.one, QQ.convert("1/2"), 64)
    1.00000000000000 + 0.500000000000000j
    """
    parts = [
        x.field.ball(x, precision) if isinstance(x, AlgebraicNumber) else flint.arb(QQ.convert(x))
        for x in (real, imaginary)
    ]
    return flint.acb(*parts)


def frobenius_bound(matrix: flint.arb_mat) -> flint.arb:
    """Upper bound, a number without radius, of the Frobenius norm of every matrix in an enclosure.

    Examples
    --------
    >>> frobenius_bound(flint.arb_mat([[3, 4]]))
    5.00000000000000
    """
    return sum((x * x for x in matrix.entries()), flint.arb(0)).sqrt().upper()
