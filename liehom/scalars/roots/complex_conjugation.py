"""Decision whether complex conjugation is the same automorphism of a number field in all its embeddings.

Let K = QQ(theta) for a root theta of f, integral and irreducible. Interpolation gives one polynomial c of degree
< deg f with real coefficients and c(r) = conj(r) for every root r of f. The question is whether its coefficients are
rational. In this case disc(f) c has integer coefficients, so balls decide.
"""

from __future__ import annotations

from typing import Any

import flint

from liehom.errors import InputError, InternalError
from liehom.scalars.fields.balls import working_precision
from liehom.scalars.fields.polynomial import Polynomial
from liehom.scalars.fields.rational import QQ

# working precision beyond the bits of the discriminant
EXTRA_BITS = 64
# of the working precision
MAX_DOUBLINGS = 12


def complex_conjugation(f: Polynomial) -> Polynomial | None:
    """The polynomial c over QQ with c(r) = conj(r) for every complex root r of f; None if it is proved not to exist.

    Parameters
    ----------
    f : Polynomial
        Over QQ, monic, irreducible, with integer coefficients.

    Raises
    ------
    InputError
        If f is not monic with integer coefficients.

    Notes
    -----
    The polynomial exists if and only if the field of f is totally real (then c = t) or a CM field.

    Examples
    --------
    >>> complex_conjugation(Polynomial(QQ, [1, 1, 1, 1, 1]))
    (-1)*t**0 + (-1)*t**1 + (-1)*t**2 + (-1)*t**3
    >>> complex_conjugation(Polynomial(QQ, [-2, 0, 0, 1])), complex_conjugation(Polynomial(QQ, [-2, 0, 1]))
    (None, (1)*t**1)
    """
    coefficients = [QQ.convert(c) for c in f.coefficients] if f.field is QQ else []
    if f.leading != 1 or any(c.q != 1 for c in coefficients) or not coefficients:
        raise InputError(f"conjugation is decided for monic polynomials with integer coefficients; got {f!r}")
    integral = flint.fmpz_poly([int(c.p) for c in coefficients])
    discriminant = int(integral.discriminant())
    bits = EXTRA_BITS + discriminant.bit_length()
    for _ in range(MAX_DOUBLINGS):
        with working_precision(bits):
            found = _integers([discriminant * x for x in _interpolated(integral)])
        if found is not None:
            candidate = Polynomial(QQ, [QQ.convert(x) / discriminant for x in found])
            return candidate if found and _composed(f, candidate).degree < 0 else None
        bits *= 2
    raise InternalError(f"the conjugates of the roots of {f!r} were not distinguished with {bits // 2} bits")


def _interpolated(f: flint.fmpz_poly) -> list[flint.acb]:
    """Balls around the coefficients of the sum of conj(r) f / (t - r) / f'(r) over the roots r."""
    n, derivative = f.degree(), flint.acb_poly(f.derivative())
    total = [flint.acb(0)] * n
    roots: Any = f.complex_roots()  # pairs of a root and its multiplicity
    for r, _ in roots:
        root = flint.acb(r)
        quotient, carry = [flint.acb(0)] * n, flint.acb(0)
        for i in range(n, 0, -1):
            carry = carry * root + flint.acb(int(f[i]))
            quotient[i - 1] = carry
        weight = flint.acb(root.real, -root.imag) / derivative(root)
        total = [x + weight * y for x, y in zip(total, quotient, strict=True)]
    return total


def _integers(balls: list[flint.acb]) -> list[int] | None:
    """The integers in the balls; [] if some ball contains no integer, None if some ball is too wide."""
    found = []
    for ball in balls:
        value = ball.real
        if not value.rad() < 0.25:
            return None
        nearest = (value.mid() + flint.arb("0.5")).floor()
        whole = nearest.unique_fmpz()
        if whole is None or not value.contains(flint.arb(whole)):
            return [] if whole is not None else None
        found.append(int(whole))
    return found


def _composed(f: Polynomial, inner: Polynomial) -> Polynomial:
    """The polynomial f(inner) modulo f."""
    total = Polynomial(QQ, [])
    for c in reversed(f.coefficients):
        total = (total * inner + Polynomial(QQ, [c])) % f
    return total
