"""A generator of a real number field with a small minimal polynomial.

The size of an algebraic integer is the sum of the squares of its conjugates (T2-norm). An LLL-reduced basis of a
lattice of algebraic integers starts with small ones, and one of them, or the sum of two, generates the field. Balls
only propose candidates: the chosen generator is exact for any precision.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from math import lcm
from typing import Any

import flint

from liehom.errors import FieldError
from liehom.scalars.fields.balls import real_root_balls, working_precision
from liehom.scalars.fields.number_field import MAX_PRECISION, AlgebraicNumber, NumberField
from liehom.scalars.fields.rational import QQ
from liehom.scalars.roots.roots import bounds, simplest_between
from liehom.typing import ScalarLike

# up to this degree a smaller generator is sought
MAX_REDUCED_DEGREE = 24
# up to this degree sums of two elements are candidates too
MAX_DEGREE_FOR_SUMS = 8
SMALL_PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31)


def field_of_root(f: Sequence[ScalarLike], near: flint.arb, name: str = "a") -> NumberField:
    """The field QQ(alpha) of the real root of an irreducible rational polynomial in a ball.

    Parameters
    ----------
    f : sequence of rationals
        Ascending coefficients, of degree at least 2.
    near : flint.arb
        A ball that meets exactly one real root of f.
    name : str
        The symbol of the generator.

    Examples
    --------
    >>> field_of_root([-2, 0, 0, 1], flint.arb(1.25, 0.1)).minpoly
    (-2, 0, 0, 1)
    """
    integral = flint.fmpq_poly([QQ.convert(c) for c in f]).numer()
    precision = 64
    while precision <= MAX_PRECISION:
        interval = _isolating(integral, near, precision)
        if interval is not None:
            return NumberField(name, [int(c) for c in integral.coeffs()], interval)
        precision *= 2
    raise FieldError(f"the root of {integral} in {near} could not be isolated with {MAX_PRECISION} bits")


def smaller_generator(field: NumberField, integers: Sequence[AlgebraicNumber]) -> tuple[NumberField, AlgebraicNumber]:
    """The field with a generator of small minimal polynomial, and the image in it of the old integral generator.

    Parameters
    ----------
    field : NumberField
    integers : sequence of AlgebraicNumber
        Algebraic integers that span the field over QQ; the generator is sought among their combinations.

    Examples
    --------
    >>> field = field_of_root([1000, -300, 0, 1], flint.arb(15.3, 0.1))
    >>> powers = [field.generator**i for i in range(3)]
    >>> smaller, image = smaller_generator(field, powers)
    >>> smaller.minpoly, image**3 - 300 * image + 1000
    ((1, -3, 0, 1), 0)
    """
    n = field.degree
    whole = flint.fmpq_poly(field.modulus)
    best, chosen = field.modulus, flint.fmpq_poly([0, 1])
    for element in _small(field, integers) if n <= MAX_REDUCED_DEGREE else []:
        polynomial = _minimal_polynomial(element, whole)
        if polynomial.gcd(polynomial.derivative()).degree() > 0:
            continue  # of a proper subfield
        k = _common_scale([polynomial[i] for i in range(n)])
        scaled = flint.fmpz_poly([*(polynomial[i] // flint.fmpz(k) ** (n - i) for i in range(n)), 1])
        if _size(scaled) < _size(best):
            best, chosen = scaled, element / k
    value = AlgebraicNumber(field, chosen)
    precision = 64
    while precision <= MAX_PRECISION:
        interval = _isolating(best, field.ball(value, precision), precision)
        if interval is not None:
            made = NumberField(field.symbol, [int(c) for c in best.coeffs()], interval)
            return made, made.from_coordinates(_generator_in_powers(chosen, whole))
        precision *= 2
    raise FieldError(
        f"a generator of {field.name} could not be distinguished from its conjugates with {MAX_PRECISION} bits"
    )


def _size(polynomial: flint.fmpz_poly) -> tuple[int, int]:
    coefficients = [int(c) for c in polynomial.coeffs()]
    return max(abs(c) for c in coefficients), sum(c != 0 for c in coefficients)


def _small(field: NumberField, integers: Sequence[AlgebraicNumber]) -> list[flint.fmpq_poly]:
    """Elements with small conjugates, as polynomials in the integral generator."""
    n = field.degree
    rows = [x.coordinates for x in integers]
    den = lcm(*(int(c.q) for row in rows for c in row))
    size = max(int(abs(c)).bit_length() for c in field.modulus.coeffs())
    bits = 64 + 4 * n
    with working_precision(2 * bits + 8 * n * size):
        found: Any = field.modulus.complex_roots()  # pairs of a root and its multiplicity
        roots = [r for r, _ in found if r.imag.is_zero() or r.imag > 0]
        table = [[int(c * den) for c in row] + _embedded(row, roots, bits) for row in rows]
    # the coordinates, small compared with the scaled embeddings, record the combination
    reduced = [row[:n] for row in flint.fmpz_mat(table).lll().tolist() if any(row[:n])]
    if n <= MAX_DEGREE_FOR_SUMS:
        pairs = list(combinations(reduced, 2))
        reduced += [[x + sign * y for x, y in zip(p, q, strict=True)] for p, q in pairs for sign in (1, -1)]
    return [flint.fmpq_poly([flint.fmpq(c, den) for c in row]) for row in reduced]


def _embedded(coordinates: list[flint.fmpq], roots: list[flint.acb], bits: int) -> list[int]:
    """Real and imaginary parts of the conjugates, times 2^bits, rounded."""
    found = []
    for root in roots:
        value = root * 0
        for c in reversed(coordinates):
            value = value * root + flint.arb(c)
        parts = (value.real,) if root.imag.is_zero() else (value.real, value.imag)
        found += [int((part * (1 << bits)).mid().floor().fmpz()) for part in parts]
    return found


def _minimal_polynomial(element: flint.fmpq_poly, whole: flint.fmpq_poly) -> flint.fmpz_poly:
    """The characteristic polynomial over QQ of an algebraic integer given in powers of the generator."""
    n = whole.degree()
    rows, current = [], element
    for _ in range(n):
        rows += [current[i] for i in range(n)]
        current = (current * flint.fmpq_poly([0, 1])) % whole
    return flint.fmpq_mat(n, n, rows).charpoly().numer()


def _common_scale(coefficients: list[flint.fmpz]) -> int:
    """The largest k made of small primes with k^(n - i) dividing coefficient i for all i."""
    n, k = len(coefficients), 1
    for p in SMALL_PRIMES:
        while all(c % flint.fmpz(p * k) ** (n - i) == 0 for i, c in enumerate(coefficients)):
            k *= p
    return k


def _isolating(polynomial: flint.fmpz_poly, near: flint.arb, precision: int) -> tuple[flint.fmpq, flint.fmpq] | None:
    """Simple rational ends of an interval around the one real root in a ball, or None if the precision is too low."""
    roots = real_root_balls(polynomial, precision)
    close = [i for i, r in enumerate(roots) if r.overlaps(near)]
    if len(close) != 1:
        return None
    at = close[0]
    low, high = bounds(roots[at])
    floor = bounds(roots[at - 1])[1] if at else low - 1
    ceiling = bounds(roots[at + 1])[0] if at + 1 < len(roots) else high + 1
    return (simplest_between(floor, low), simplest_between(high, ceiling)) if floor < low and high < ceiling else None


def _generator_in_powers(element: flint.fmpq_poly, whole: flint.fmpq_poly) -> list[flint.fmpq]:
    """Coordinates of the integral generator b in powers of an element that is given in powers of b."""
    n = whole.degree()
    rows, power = [], flint.fmpq_poly([1])
    for _ in range(n):
        rows += [power[i] for i in range(n)]
        power = (power * element) % whole
    target = flint.fmpq_mat(n, 1, [int(i == 1) for i in range(n)])
    return list(flint.fmpq_mat(n, n, rows).transpose().solve(target).entries())
