"""Simple algebras over QQ, seen over the reals: one real simple ideal for each place of the centroid.

The centroid of a simple algebra I is a number field K = QQ(theta), theta a matrix with the irreducible minimal
polynomial f.  I (x) R is the sum of ideals I_v, one for each real root of f (absolutely simple, of dimension
dim I / deg f) and one for each pair of complex roots (a complex simple algebra seen as a real one).  With kappa the
Killing form, kappa((theta - c) x, y) is (theta_v - c) kappa_v on a real I_v and has signature 0 on a complex one: its
signature drops by twice that of kappa_v where c passes theta_v, so exact signatures over the base field give them all.
"""

from __future__ import annotations

import itertools
import random
from dataclasses import dataclass
from math import gcd, lcm
from typing import Any, Literal, final

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.algebra.core.subalgebra import Subalgebra
from liehom.algebra.structure.centroid import centroid
from liehom.algebra.structure.commuting_maps import combinations, minimal_polynomial
from liehom.errors import FieldError, InputError, InternalError
from liehom.scalars import QQ, Polynomial
from liehom.scalars.roots.extension import RealFactor, real_factors

CANDIDATES = 12
FACTORED_BITS = 160
LARGEST_DEGREE = 36


@final
@dataclass(frozen=True, slots=True)
class Place:
    """A real simple ideal of I (x) R, by the root of the centroid's polynomial that it belongs to.

    Attributes
    ----------
    kind : 'real' or 'complex'
        'real': the ideal is absolutely simple. 'complex': it is a complex simple algebra seen as a real one.
    polynomial : Polynomial
        The minimal polynomial f of the generator theta of the centroid; of degree 1 where the centroid is the field.
    root : pair of rationals, or None
        Ends of an interval that holds this real root of f and no other; None at a complex place.
    killing_signature : (int, int)
        Numbers of positive and negative squares of the Killing form of the ideal (as a real algebra): in a Cartan
        decomposition dim p and dim k.
    dimension : int
        The real dimension of the ideal.
    """

    kind: Literal["real", "complex"]
    polynomial: Polynomial
    root: tuple[Any, Any] | None
    killing_signature: tuple[int, int]
    dimension: int


@final
@dataclass(frozen=True, slots=True)
class CentroidField:
    """The centroid of a simple algebra as a field.

    Attributes
    ----------
    algebra : LieAlgebra
        The algebra in the basis of the ideal that was given.
    generator : Matrix
        theta, shape (n, n), on columns in that basis; the identity where the centroid is the base field.
    polynomial : Polynomial
        Its minimal polynomial f over the base field, irreducible, of degree dim K.
    """

    algebra: LieAlgebra
    generator: Any
    polynomial: Polynomial

    @property
    def degree(self) -> int:
        """The degree of the centroid over the base field."""
        return self.polynomial.degree


def centroid_field(ideal: Subalgebra) -> CentroidField:
    """The centroid of a subalgebra that is simple over its field.

    Raises
    ------
    InputError
        If the subalgebra is not simple: its Killing form is degenerate, or it is a sum of ideals.
    FieldError
        Over float64.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.so(3, 1)
    >>> centroid_field(g.subalgebra(g.whole().basis)).polynomial
    (1)*t**0 + (1)*t**2
    """
    algebra = _own_algebra(ideal)
    if algebra.dimension == 0 or algebra.killing_form().rank() < algebra.dimension:
        raise InputError(f"the Killing form of {ideal!r} is degenerate; expected a simple ideal")
    maps = centroid(algebra)
    degree = len(maps)
    start = algebra.field.unit(algebra.dimension, 0)
    found: list[tuple[Any, Polynomial]] = []
    for theta in combinations(maps, random.Random(degree)):
        f = minimal_polynomial(theta, start)
        if len(f.factor()) > 1:
            raise InputError(f"{ideal!r} is a sum of ideals; take one of its direct_sum_decomposition")
        if f.degree == degree:
            found.append(_simplified(theta, f))
        if len(found) == (CANDIDATES if degree > 2 else 1):
            break
    if not found:
        raise InternalError("no element of the centroid generates it")
    theta, f = min(found, key=lambda pair: _height(pair[1]))
    return CentroidField(algebra, theta, f)


def places(ideal: Subalgebra) -> list[Place]:
    """The simple ideals over the reals of an algebra that is simple over its field, by their places.

    Parameters
    ----------
    ideal : Subalgebra
        Simple over its exact field, such as a simple ideal or a simple Levi factor.

    Returns
    -------
    list of Place
        The real places by increasing root, then the complex ones. The dimensions add up to that of the ideal.

    Raises
    ------
    InputError
        If the subalgebra is not simple over its field.
    FieldError
        Over float64.

    Notes
    -----
    No field is extended: only signatures of forms over the given field are computed.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.so(3, 1)
    >>> [(p.kind, p.killing_signature) for p in places(g.subalgebra(g.whole().basis))]
    [('complex', (3, 3))]
    """
    return field_places(centroid_field(ideal))


def field_places(centre: CentroidField) -> list[Place]:
    """`places` of an algebra whose centroid is known."""
    f, n = centre.polynomial, centre.algebra.dimension
    size = n // f.degree
    intervals = real_root_intervals(f)
    made = []
    for interval, index in zip(intervals, _indices(centre, intervals), strict=True):
        if (size + index) % 2 or abs(index) > size:
            raise InternalError(f"a Killing form of dimension {size} and index {index}")
        made.append(Place("real", f, interval, ((size + index) // 2, (size - index) // 2), size))
    pairs = (f.degree - len(intervals)) // 2
    return made + [Place("complex", f, None, (size, size), 2 * size)] * pairs


def _indices(centre: CentroidField, intervals: list[tuple[Any, Any]]) -> list[int]:
    """Positive minus negative squares of the Killing form at each real root."""
    if not intervals:
        return []
    killing = centre.algebra.killing_form()
    twisted = killing @ centre.generator
    field = centre.algebra.field
    below = _index(killing)
    values = [below]
    for interval in intervals[:-1]:
        values.append(_index(twisted - killing.scale(field.convert(interval[1]))))
    values.append(-below)  # right of all roots the form is negative on what was positive left of them
    return [(a - b) // 2 for a, b in itertools.pairwise(values)]


def _index(form: Any) -> int:
    positive, negative, _ = form.signature()
    return int(positive - negative)


def real_root_intervals(f: Polynomial) -> list[tuple[Any, Any]]:
    """Rational ends of disjoint intervals that hold one real root of a squarefree polynomial each, left to right.

    No end is a root.

    Examples
    --------
    >>> real_root_intervals(Polynomial(QQ, [1, -3, 0, 1]))
    [(-2, 0), (0, 1), (1, 2)]
    """
    count = f.root_counter()
    total, bound = count(None, None), QQ.one
    while count(-bound, bound) < total or f(bound) == 0 or f(-bound) == 0:
        bound = bound * 2
    found: list[tuple[Any, Any]] = []
    rest = [(-bound, bound, total)]
    while rest:
        low, high, inside = rest.pop()
        if inside <= 1:
            found += [(low, high)] * inside
            continue
        middle = (low + high) / 2
        while f(middle) == 0:
            middle = (middle + high) / 2
        left = count(low, middle)
        rest += [(middle, high, inside - left), (low, middle, left)]
    return found


def real_ideals(ideal: Subalgebra) -> list[Subalgebra]:
    """The simple ideals over the reals of an algebra that is simple over its field, each over a field that has it.

    Parameters
    ----------
    ideal : Subalgebra
        Simple over its exact field F.

    Returns
    -------
    list of Subalgebra
        In the order of `places`. Each is an ideal of the given one, in the algebra around read over its own real
        number field: F(theta_v) for a real root theta_v of the polynomial f of the centroid, the field of the
        coefficients of the quadratic factor of f for a pair of complex roots.

    Raises
    ------
    InputError
        If the subalgebra is not simple over its field.
    FieldError
        Over float64, or where the degree of such a field could exceed `LARGEST_DEGREE`; `places` needs no field.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.so(3, 1)
    >>> real_ideals(g.subalgebra(g.whole().basis))
    [<subalgebra of dimension 6 in so(3,1) over QQ>]
    """
    centre = centroid_field(ideal)
    f, m = centre.polynomial, centre.degree
    complex_pairs = (m - f.count_real_roots()) // 2
    if m == 1 or (m == 2 and complex_pairs):
        return [ideal]
    bound = (m * (m - 1) // 2 if complex_pairs else m) * f.field.degree
    if bound > LARGEST_DEGREE:
        raise FieldError(
            f"a simple ideal over the reals may need a number field of degree {bound}, more than {LARGEST_DEGREE}; "
            "places() tells the ideals and their Killing signatures without it"
        )
    krylov = _krylov(centre)
    return [_real_ideal(ideal, factor, f, krylov) for factor in real_factors(f)]


def _krylov(centre: CentroidField) -> list[Any]:
    """For a basis b_1, b_2, ... over the centroid the matrices (m, n) with rows b_i, theta b_i, theta^2 b_i, ..."""
    field, n, m = centre.algebra.field, centre.algebra.dimension, centre.degree
    blocks: list[Any] = []
    for i in range(n):
        rows = [field.unit(n, i)]
        while len(rows) < m:
            rows.append(rows[-1] @ centre.generator.T)
        grown = field.stack_rows([*blocks, *rows], n)
        if grown.rank() == grown.nrows:
            blocks.append(field.stack_rows(rows, n))
        if len(blocks) * m == n:
            break
    return blocks


def _real_ideal(ideal: Subalgebra, factor: RealFactor, f: Polynomial, krylov: list[Any]) -> Subalgebra:
    """The kernel of q(theta) for a factor q of f over a larger field: the image of (f / q)(theta)."""
    up, q = factor.extension, factor.polynomial
    field = up.field
    cofactor = list((up.polynomial(f) // q).coefficients)
    shifts = [[field.zero] * k + cofactor + [field.zero] * (q.degree - 1 - k) for k in range(q.degree)]
    weights = field.matrix(shifts)
    rows = [weights @ up.matrix(block) for block in krylov]
    around = ideal.algebra
    entries = [(i, j, k, up.embed(v)) for i, j, k, v in around.table]
    table = StructureConstants(field, around.dimension, entries)
    larger = LieAlgebra(table, basis=around.basis_names, name=around.name, check=False)  # same identities
    basis = field.stack_rows(rows, rows[0].ncols) @ up.matrix(ideal.basis)
    return Subalgebra(larger, basis.primitive(), check=False)  # the kernel of a map that commutes with the bracket


# -- helpers ---------------------------------------------------------------------------------------------
def _own_algebra(ideal: Subalgebra) -> LieAlgebra:
    algebra = ideal.algebra
    whole = ideal.dimension == algebra.dimension and ideal.basis == algebra.field.identity(algebra.dimension)
    return algebra if whole else ideal.as_algebra()


def _simplified(theta: Any, f: Polynomial) -> tuple[Any, Polynomial]:
    """A generator a theta + b of the same field with trace 0 and, over QQ, an integral polynomial of small height."""
    m, field = f.degree, f.field
    if m == 1:
        return theta.field.identity(theta.nrows), Polynomial(field, [-1, 1])
    centre = -f.coefficients[m - 1] / m
    theta, f = theta - theta.field.identity(theta.nrows).scale(centre), f.shifted(centre)
    if field.degree > 1:
        return theta, f
    factor = _scale(f)
    return theta.scale(factor), Polynomial(field, [c * factor ** (m - i) for i, c in enumerate(f.coefficients)])


def _scale(f: Polynomial) -> Any:
    """The least a > 0 for which a theta is an algebraic integer by its polynomial, theta a root of f over QQ."""
    m = f.degree
    low = [(m - i, c) for i, c in enumerate(f.coefficients[:-1]) if c != 0]
    factor = QQ.one
    for prime in _primes([c for _, c in low]):
        exponent = max(-(_valuation(c, prime) // gap) for gap, c in low)
        factor = factor * QQ.convert(prime) ** exponent if exponent > 0 else factor / QQ.convert(prime) ** -exponent
    return factor


def _primes(values: list[Any]) -> list[int]:
    """Primes in a denominator or in all numerators; none are sought where the numbers are too large to factor."""
    bottom = lcm(*(int(c.q) for c in values))
    common = gcd(*(int(c.p) for c in values))
    found: set[int] = set()
    for number in (bottom, common):
        if number.bit_length() <= FACTORED_BITS:
            found |= {int(p) for p, _ in QQ.convert(number).p.factor()}
    return sorted(found)


def _valuation(value: Any, prime: int) -> int:
    top, bottom, exponent = int(value.p), int(value.q), 0
    while top % prime == 0:
        top, exponent = top // prime, exponent + 1
    while bottom % prime == 0:
        bottom, exponent = bottom // prime, exponent - 1
    return exponent


def _height(f: Polynomial) -> Any:
    """How large the coefficients are over QQ, relative to their degree; 0 over other fields."""
    if f.field.degree > 1:
        return 0
    rationals = map(QQ.convert, f.coefficients[:-1])
    return max((max(abs(int(c.p)), int(c.q)) ** (1 / (f.degree - i)) for i, c in enumerate(rationals)))
