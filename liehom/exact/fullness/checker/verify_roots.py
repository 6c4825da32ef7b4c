"""Root counts of the independent checker: Sturm, Routh–Hurwitz and characteristic polynomials, from scratch.

A polynomial is the list of its ascending coefficients, elements of the field, without leading zeros; zero is []. The
procedure that finds certificates counts roots with `liehom.exact.scalars.polynomial`; the checker repeats this code,
so that a mistake there cannot be in both.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from math import isqrt

from liehom.base.errors import CertificateError
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.field import Scalar

Coefficients = list[Scalar]


def trimmed(values: Sequence[Scalar]) -> Coefficients:
    """Polynomial with these ascending coefficients, leading zeros removed."""
    out = list(values)
    while out and out[-1] == 0:
        out.pop()
    return out


def divided(f: Coefficients, g: Coefficients) -> tuple[Coefficients, Coefficients]:
    """Quotient and remainder of f divided by g, for g != 0."""
    rest, gap = list(f), len(g) - 1
    inverse = 1 / g[-1]
    quotient = [g[-1] * 0] * max(0, len(f) - gap)
    for top in range(len(f) - 1, gap - 1, -1):
        factor = rest[top] * inverse
        quotient[top - gap] = factor
        if factor == 0:
            continue
        for j in range(gap):
            rest[top - gap + j] = rest[top - gap + j] - factor * g[j]
    return trimmed(quotient), trimmed(rest[: min(gap, len(f))])


def derivative(f: Coefficients) -> Coefficients:
    """Derivative of a polynomial."""
    return trimmed([c * i for i, c in enumerate(f)][1:])


def value(f: Coefficients, at: Scalar) -> Scalar:
    """Value f(at) of a polynomial."""
    total = at * 0
    for c in reversed(f):
        total = total * at + c
    return total


def gcd(f: Coefficients, g: Coefficients) -> Coefficients:
    """Monic greatest common divisor of two polynomials; zero if both are zero."""
    while g:
        f, g = g, divided(f, g)[1]
        g = [c / g[-1] for c in g]
    return [c / f[-1] for c in f]


def coprime(f: Coefficients, g: Coefficients) -> bool:
    """Whether f and g have no common root in any extension of the field."""
    return len(gcd(f, g)) == 1


def squarefree_parts(f: Coefficients) -> list[tuple[Coefficients, int]]:
    """Pairs (g_m, m), g_m squarefree and pairwise coprime, with f = const * product of g_m^m (Yun)."""
    common = gcd(f, derivative(f))
    rest, slope = divided(f, common)[0], divided(derivative(f), common)[0]
    parts, multiplicity = [], 1
    while len(rest) > 1:
        # rest is the product of the g_i with i >= m, slope the sum of (i - m + 1) g_i' rest/g_i: as long as rest'
        other = trimmed([a - b for a, b in zip(slope, derivative(rest), strict=True)])
        part = gcd(rest, other)
        if len(part) > 1:
            parts.append((part, multiplicity))
        rest, slope = divided(rest, part)[0], divided(other, part)[0]
        multiplicity += 1
    return parts


def signed_remainders(field: ExactField, f: Coefficients, g: Coefficients) -> list[Coefficients]:
    """Chain f, g, -(f mod g), ... of signed remainders, up to positive factors, that ends before zero."""
    chain = [f, g] if g else [f]
    while len(chain) > 1:
        rest = divided(chain[-2], chain[-1])[1]
        if not rest:
            break
        size = rest[-1] if field.sign(rest[-1]) < 0 else -rest[-1]  # minus the absolute value of the lead
        chain.append([c / size for c in rest])
    return chain


def variations(signs: Sequence[int]) -> int:
    """Number of sign changes in a sequence, without its zeros."""
    kept = [s for s in signs if s]
    return sum(a != b for a, b in itertools.pairwise(kept))


def count_real_roots(field: ExactField, f: Coefficients, low: Scalar, high: Scalar) -> int:
    """Number of distinct real roots of f in the open interval (low, high), by Sturm's theorem.

    The ends must not be roots of f. Proof: the number of sign changes of Sturm's chain f, f', ... changes only at roots
    of f, where it drops by one. If the ends are not roots, f need not be squarefree.
    """
    chain = signed_remainders(field, f, derivative(f))
    left, right = ([field.sign(value(p, at)) for p in chain] for at in (low, high))
    return variations(left) - variations(right)


def shifted(f: Coefficients, by: Scalar) -> Coefficients:
    """Polynomial f(t + by)."""
    out = list(f)
    for start in range(len(out) - 1):
        for i in range(len(out) - 2, start - 1, -1):
            out[i] = out[i] + by * out[i + 1]
    return out


def count_right_of(field: ExactField, f: Coefficients, cut: Scalar) -> int:
    """Number of complex roots of f with real part above `cut`, with multiplicity (Routh–Hurwitz).

    A count is returned only if no root has real part equal to `cut`.
    """
    count = _count_right(field, shifted(f, cut))
    if count is not None:
        return count
    total = 0
    for part, multiplicity in squarefree_parts(f):
        count = _count_right(field, shifted(part, cut))
        if count is None:
            raise CertificateError(
                "symmetric-roots",
                f"two roots are symmetric about the line Re = {field.format(cut)}, "
                "where Routh–Hurwitz does not count; move the cut",
            )
        total += multiplicity * count
    return total


def _count_right(field: ExactField, f: Coefficients) -> int | None:
    """Number of roots with positive real part, or None if two roots are symmetric about the imaginary axis.

    Proof. Write f(iy) = p(y) + i q(y). A common root y of p and q, real or not, is f(iy) = 0 = f(-iy)
    conjugated: roots iy and i conj(y) of f, mirror images in the axis; so without such pairs gcd(p, q) = 1 and
    f has no root on the axis. Then arg f(iy) grows by pi (left - right) as y runs over R. The one of p, q
    with the higher degree n is the denominator of tan (n even) or cot (n odd) of the argument, a function that
    vanishes at both ends; so the growth is -pi I(q/p) or +pi I(p/q), I the Cauchy index, which is the loss of
    sign changes of the signed remainders from -infinity to +infinity (Sturm).
    """
    n = len(f) - 1
    real = trimmed([c * (1, 0, -1, 0)[k % 4] for k, c in enumerate(f)])
    imaginary = trimmed([c * (0, 1, 0, -1)[k % 4] for k, c in enumerate(f)])
    first, second = (real, imaginary) if n % 2 == 0 else (imaginary, real)
    chain = signed_remainders(field, first, second)
    if len(chain[-1]) > 1:
        return None
    leads = [(field.sign(p[-1]), len(p) - 1) for p in chain]
    index = variations([s * (-1) ** degree for s, degree in leads]) - variations([s for s, _ in leads])
    left_minus_right = index if n % 2 else -index
    return (n - left_minus_right) // 2


def characteristic_polynomial(matrix: ExactMatrix) -> Coefficients:
    """Coefficients of det(t - A), ascending and monic, from the traces of the powers of A.

    Newton's identities are k e_k = sum_{i=1..k} (-1)^(i-1) e_(k-i) tr A^i. The traces are computed as tr(A^(is) A^j),
    with s about the square root of the size, so that about 2s products of matrices are enough.
    """
    field, n = matrix.field, matrix.nrows
    if n == 0:
        return [field.one]
    step = isqrt(n - 1) + 1
    small = [matrix]
    while len(small) < step:
        small.append(small[-1] @ matrix)
    giant = [field.identity(n)]
    while len(giant) * step < n:
        giant.append(giant[-1] @ small[-1])
    columns = field.stack_rows([a.T.reshape(1, n * n) for a in small], n * n).T
    rows = field.stack_rows([a.reshape(1, n * n) for a in giant], n * n)
    traces = (rows @ columns).entries()[:n]
    signed = [field.one]  # (-1)^k e_k
    for k in range(1, n + 1):
        total = field.zero
        for i in range(1, k + 1):
            total = total + signed[k - i] * traces[i - 1]
        signed.append(total / -k)
    return signed[::-1]
