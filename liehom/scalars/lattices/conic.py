"""A rational zero of a ternary quadratic form, or the proof that no zero exists, by Legendre's theorem.

A diagonal form with squarefree, pairwise coprime a, b, c has a zero if and only if the signs differ and -bc, -ca, -ab
are squares modulo a, b, c. Let r_a, r_b, r_c be the square roots. The vectors with y = r_a z (mod a), z = r_b x
(mod b), x = r_c y (mod c) form a lattice of index abc on which the form is a multiple of abc. Its short vectors have
the value 0 or +-abc (Cremona-Rusin), and an identity of Mordell turns the value -abc into a zero.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from math import gcd, isqrt, lcm

import flint

from liehom.errors import InternalError
from liehom.scalars.fields.exact_field import ExactMatrix
from liehom.scalars.fields.rational import QQ
from liehom.scalars.spaces.forms import orthogonal_basis

Triple = tuple[int, int, int]
# of the combinations of reduced basis vectors that are tried
MAX_COEFFICIENT = 4


def rational_zero(form: ExactMatrix) -> ExactMatrix | None:
    """A row x (1, 3), not zero, with x form x^T = 0 for a symmetric form over QQ; None if no such x exists.

    Parameters
    ----------
    form : ExactMatrix
        Symmetric, (3, 3), over QQ.

    Notes
    -----
    The coefficients of a diagonal form are factored, which limits their size.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> x = rational_zero(QQ.matrix([[2, 0, 0], [0, 3, 0], [0, 0, -5]]))
    >>> (x @ QQ.matrix([[2, 0, 0], [0, 3, 0], [0, 0, -5]]) @ x.T).is_zero(), x.is_zero()
    (True, False)
    >>> rational_zero(QQ.matrix([[1, 0, 0], [0, 1, 0], [0, 0, -3]])) is None
    True
    """
    rows, values = orthogonal_basis(form)
    for row, value in zip(rows, values, strict=True):
        if value == 0:
            zero: ExactMatrix = row
            return zero
    rationals = [QQ.convert(v) for v in values]
    den = lcm(*(int(v.q) for v in rationals))
    a, b, c = (int(v * den) for v in rationals)
    found = legendre_zero((a, b, c))
    if found is None:
        return None
    total: ExactMatrix = form.field.zeros(1, 3)
    for row, x in zip(rows, found, strict=True):
        total = total + row.scale(x)
    return total


def legendre_zero(coefficients: Triple) -> Triple | None:
    """Integers (x, y, z), not all zero, with a x^2 + b y^2 + c z^2 = 0, where a, b, c are not zero; None if none exist.

    Examples
    --------
    >>> x, y, z = legendre_zero((1, 1, -2))
    >>> x * x + y * y == 2 * z * z, legendre_zero((-1, 7, 7)) is None
    (True, True)
    """
    reduced, scale = _reduced(coefficients)
    found = _reduced_zero(reduced)
    if found is None:
        return None
    fractions = [flint.fmpq(x) / s for x, s in zip(found, scale, strict=True)]
    den = lcm(*(int(f.q) for f in fractions))
    x, y, z = (int(f * den) for f in fractions)
    common = gcd(x, y, z)
    a, b, c = coefficients
    if a * x * x + b * y * y + c * z * z or not common:
        raise InternalError(f"{(x, y, z)} is not a zero of the form {coefficients}")
    return x // common, y // common, z // common


def _reduced(coefficients: Triple) -> tuple[Triple, Triple]:
    """Squarefree, pairwise coprime coefficients, and factors s: the old unknowns are the new unknowns divided by s."""
    values, scale = list(coefficients), [1, 1, 1]
    changed = True
    while changed:
        changed = False
        common = gcd(*values)
        values = [v // common for v in values]
        for i in range(3):
            root = _square_part(values[i])
            if root > 1:
                values[i], scale[i], changed = values[i] // root**2, scale[i] * root, True
        for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            g = gcd(values[i], values[j])
            if g > 1:
                # g (a' x^2 + b' y^2) + c z^2 times g: a' (g x)^2 + b' (g y)^2 + g c z^2
                values[i], values[j], values[k] = values[i] // g, values[j] // g, values[k] * g
                scale[i], scale[j], changed = scale[i] * g, scale[j] * g, True
    return (values[0], values[1], values[2]), (scale[0], scale[1], scale[2])


def _square_part(n: int) -> int:
    """The largest s with s^2 dividing n."""
    root = 1
    for p, e in flint.fmpz(n).factor():
        root *= int(p) ** (e // 2)
    return root


def _reduced_zero(coefficients: Triple) -> Triple | None:
    a, b, c = coefficients
    if (a > 0) == (b > 0) == (c > 0):
        return None
    ra, rb, rc = _square_root(-b * c, b, a), _square_root(-c * a, c, b), _square_root(-a * b, a, c)
    if ra is None or rb is None or rc is None:
        return None
    for x, y, z in _short_vectors(coefficients, (ra, rb, rc)):
        value = a * x * x + b * y * y + c * z * z
        if value == 0:
            return x, y, z
        if value == -a * b * c:
            # a x^2 + b y^2 = -c (z^2 + ab), and the left side times (z^2 + ab) is a (xz + by)^2 + b (yz - ax)^2
            found = (x * z + b * y, y * z - a * x, z * z + a * b)
            if any(found):
                return found
    raise InternalError(f"no zero of the form {coefficients} was found, though Legendre's theorem promises one")


def _square_root(square: int, divisor: int, modulus: int) -> int | None:
    """Some r with r^2 = square / divisor^2 modulo a squarefree number coprime to the divisor, or None."""
    m = abs(modulus)
    total, seen = 0, 1
    for p in (int(factor) for factor, _ in flint.fmpz(m).factor()):
        value = square * pow(divisor, -2, p) % p
        if p > 2 and flint.fmpz(value).jacobi(p) < 0:
            return None
        r = value if p == 2 else int(flint.fmpz(value).sqrtmod(p))
        total += seen * ((r - total) * pow(seen, -1, p) % p)
        seen *= p
    return total


def _short_vectors(coefficients: Triple, roots: Triple) -> Iterator[Triple]:
    """Short vectors of the lattice in the norm |a| x^2 + |b| y^2 + |c| z^2, shorter ones earlier."""
    a, b, c = (abs(v) for v in coefficients)
    ra, rb, rc = roots
    index = a * b * c
    # each condition leaves two unknowns free; the Chinese remainder theorem combines those modulo a, b and c
    rows = [[index, 0, 0], [0, index, 0], [0, 0, index]]
    rows += [[_crt(v, (a, b, c)) for v in zip(*images, strict=True)] for images in _local_bases(ra, rb, rc)]
    weights = [isqrt(v << 40) for v in (a, b, c)]
    basis = [row for row in flint.fmpz_mat(rows).hnf().tolist() if any(row)]
    weighed = flint.fmpz_mat([[x * w for x, w in zip(row, weights, strict=True)] for row in basis]).lll().tolist()
    reduced = [[int(x) // w for x, w in zip(row, weights, strict=True)] for row in weighed]
    for k in sorted(product(range(-MAX_COEFFICIENT, MAX_COEFFICIENT + 1), repeat=3), key=lambda k: sum(map(abs, k))):
        if any(k):
            x, y, z = (sum(f * row[i] for f, row in zip(k, reduced, strict=True)) for i in range(3))
            yield x, y, z


def _local_bases(ra: int, rb: int, rc: int) -> list[list[Triple]]:
    """Generators of the lattices modulo a, b and c, each with zeros for the other two moduli."""
    modulo_a = [(1, 0, 0), (0, ra, 1)]  # y = r_a z
    modulo_b = [(0, 1, 0), (1, 0, rb)]  # z = r_b x
    modulo_c = [(0, 0, 1), (rc, 1, 0)]  # x = r_c y
    none = (0, 0, 0)
    found = [[v, none, none] for v in modulo_a]
    found += [[none, v, none] for v in modulo_b]
    found += [[none, none, v] for v in modulo_c]
    return found


def _crt(values: Sequence[int], moduli: Triple) -> int:
    """The residue modulo abc with the given residues modulo a, b and c."""
    total, seen = 0, 1
    for v, m in zip(values, moduli, strict=True):
        total += seen * ((int(v) - total) * pow(seen, -1, m) % m) if m > 1 else 0
        seen *= m
    return total
