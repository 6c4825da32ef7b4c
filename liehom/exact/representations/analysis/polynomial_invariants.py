"""Invariant polynomials of a representation, and the Hilbert series of their ring as a rational function."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations
from math import comb, lcm
from typing import Any, final

import numpy as np

from liehom.base.budget import in_time, within
from liehom.base.errors import FieldError, InputError, ParseError
from liehom.base.typing import Array, Expression
from liehom.exact.algebra.linear.linear_bases import require_size
from liehom.exact.algebra.roots.root_system import RootSystem, cartan_matrix
from liehom.exact.representations.analysis.weight_multiplicities import ChargedWeight
from liehom.exact.representations.core.representation import Representation
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.polynomial_matrix import as_fraction, expression_of_terms, invariant_polynomials
from liehom.exact.scalars.rational import QQ

# The ring R of invariant polynomials of a reductive algebra. By Weyl's integral formula dim R_d is the coefficient of
# z^0 t^d in prod_(a > 0) (1 - z^a) / prod_w (1 - t z^w), the a roots and the w weights. The solutions n >= 0 of
# sum_w n_w w = 0 are a monoid, and the Hilbert series of a module over its ring has poles only at t with t^e = 1 for
# the degree e of an extreme ray (Stanley, Enumerative Combinatorics I, 4.6.11). R is Cohen-Macaulay (Hochster and
# Roberts), so no pole has a higher order than dim R, which is at most dim V minus the dimension of an orbit. The degree
# of the series is at most 0 (Kempf, Michigan Math. J. 26 (1979), 19-32). Finitely many coefficients determine it.

MAX_SUPPORTS = 50_000  # sets of weights that are looked through for extreme rays
LARGE = 1000

Weight = tuple[int, ...]


@final
@dataclass(frozen=True, slots=True)
class HilbertSeries:
    """The series sum dim R_d t^d of the ring R of invariant polynomials, the result of `hilbert_series`.

    Attributes
    ----------
    numerator : tuple of int
        The coefficients, from t^0 on, of the numerator.
    denominator : tuple of int
        The d for which 1 - t^d is a factor of the denominator, increasing.

    Examples
    --------
    >>> import liehom as lh
    >>> series = lh.adjoint(lh.sl(3)).hilbert_series()
    >>> series, series.dimensions(6), series.degrees
    (1/((1 - t^2)*(1 - t^3)), [1, 0, 1, 1, 1, 1, 2], (2, 3))
    """

    numerator: tuple[int, ...]
    denominator: tuple[int, ...]

    @property
    def degrees(self) -> tuple[int, ...] | None:
        """The degrees of the generators if R is a polynomial ring; None if the series is not that of one."""
        return self.denominator if self.numerator == (1,) else None

    @property
    def expression(self) -> Expression:
        """The rational function of the symbol t, a sympy expression."""
        import sympy

        t = sympy.Symbol("t")
        below = sympy.Mul(*(1 - t**d for d in self.denominator))
        return sympy.Add(*(c * t**d for d, c in enumerate(self.numerator))) / below

    def dimensions(self, degree: int) -> list[int]:
        """The dimensions of the spaces of invariants of degree 0, 1, ..., `degree`, a list of int."""
        require_size("degree", degree, 0)
        row = [*self.numerator, *[0] * (degree + 1)][: degree + 1]
        for d in self.denominator:
            for i in range(d, degree + 1):
                row[i] += row[i - d]
        return row

    def __repr__(self) -> str:
        terms = ((c, f"t^{d}" if d > 1 else "t" * d) for d, c in enumerate(self.numerator) if c)
        shown = [f"{c}*{t}" if t and abs(c) > 1 else t if c == 1 and t else f"-{t}" if c == -1 and t else str(c)
                 for c, t in terms]  # fmt: skip
        above = " + ".join(shown).replace("+ -", "- ")
        if not self.denominator:
            return above
        below = "*".join(f"(1 - t^{d})" if d > 1 else "(1 - t)" for d in self.denominator)
        above = f"({above})" if len(shown) > 1 else above
        return f"{above}/({below})" if len(self.denominator) > 1 else f"{above}/{below}"


def invariants(rho: Representation, degree: int) -> list[Expression]:
    """Implements `Representation.invariants`."""
    require_size("degree", degree, 1)
    if rho.field != QQ:
        raise InputError(f"invariant polynomials are computed over QQ; this representation is over {rho.field.name}")
    # (x f)(v) = -df(rho(x) v): x_j is mapped to the row j of rho(x), up to the sign
    found = invariant_polynomials(rho._generating() if rho.algebra.dimension else (), rho.size, degree)
    return [expression_of_terms(terms, [f"x{j}" for j in range(rho.size)]) for terms in found]


def hilbert_series(rho: Representation) -> HilbertSeries:
    """Implements `Representation.hilbert_series`."""
    weights = _integral_weights(rho)
    orders = {d: 0 for degree in _ray_degrees(list(weights)) for d in range(1, degree + 1) if degree % d == 0}
    rng = random.Random(rho.size)
    points = ([rng.randint(-LARGE, LARGE) for _ in range(rho.size)] for _ in range(3))
    k = rho.size - max(rho.orbit_dimension(point) for point in points)
    count = 1 + k * sum(sum(1 for i in range(1, d + 1) if np.gcd(i, d) == 1) for d in orders)
    series = _dimensions(weights, _weyl_denominator(rho, len(next(iter(weights), ()))), count)
    numerator, denominator = as_fraction(series, dict.fromkeys(orders, k))
    return HilbertSeries(tuple(numerator), tuple(denominator))


def _integral_weights(rho: Representation) -> dict[Weight, int]:
    """The weights with multiplicities as tuples of int, charges of a centre last."""
    weights: Counter[tuple[Any, ...]] = Counter()
    for weight, multiplicity in rho.weights().items():
        if isinstance(weight, ChargedWeight):
            parts = [x for charge in weight.charges for x in (charge.real, charge.imaginary)]
            weights[(*weight.weight, *(_fraction(x) for x in parts))] += multiplicity
        else:
            weights[tuple(weight)] += multiplicity
    den = lcm(*(Fraction(x).denominator for weight in weights for x in weight))
    return {tuple(int(x * den) for x in weight): m for weight, m in weights.items()}


def _fraction(value: Scalar) -> Fraction:
    try:
        return Fraction(str(QQ.convert(value)))
    except (FieldError, ParseError):
        raise InputError(f"the charge {value} of the centre is not rational; a Hilbert series needs integers") from None


def _ray_degrees(weights: Sequence[Weight]) -> set[int]:
    """The degrees of the extreme rays of {n >= 0 : sum n_w w = 0}, each the sum of its coprime coordinates."""
    rank = int(QQ.matrix([list(w) for w in weights], (len(weights), len(weights[0]) if weights else 0)).rank())
    supports = sum(comb(len(weights), s) for s in range(1, rank + 2))
    if supports > MAX_SUPPORTS:
        raise InputError(
            f"the {len(weights)} different weights of rank {rank} have {supports} supports of extreme rays, more "
            f"than {MAX_SUPPORTS}; invariants(degree) finds the invariants of one degree"
        )
    degrees = set()
    for size in range(1, rank + 2):
        for support in combinations(weights, size):
            in_time()
            relations = QQ.matrix([list(w) for w in support], (size, len(support[0]))).left_null_space()
            if relations.nrows == 1:
                values = [int(x) for x in relations.primitive().parts[0].entries()]
                if all(x > 0 for x in values) or all(x < 0 for x in values):
                    degrees.add(abs(sum(values)))
    return degrees


def _weyl_denominator(rho: Representation, length: int) -> dict[Weight, int]:
    """The coefficients of prod_(a > 0) (1 - z^a), by exponents of this length."""
    kind = rho.algebra.semisimple_type()
    system = RootSystem(() if kind == "0" else cartan_matrix(kind.replace(" ", "")))
    cartan = np.array(system.cartan, dtype=np.int64).reshape(system.rank, system.rank)
    product: Counter[Weight] = Counter({(0,) * length: 1})
    for root in system.positive_roots:
        in_time()
        shift = (*map(int, np.array(root) @ cartan), *[0] * (length - system.rank))
        for exponent, c in list(product.items()):
            product[tuple(x + y for x, y in zip(exponent, shift, strict=True))] -= c
    return {exponent: c for exponent, c in product.items() if c}


def _dimensions(weights: Mapping[Weight, int], denominator: Mapping[Weight, int], count: int) -> list[int]:
    """The first `count` coefficients of z^0 in the product of the denominator and all 1 / (1 - t z^w)."""
    size = sum(weights.values())
    columns = zip(zip(*weights, strict=True), zip(*denominator, strict=True), strict=True)
    reach = [max(map(abs, own)) * count + max(map(abs, shifts)) for own, shifts in columns]
    shape = tuple(2 * r + 1 for r in reach)
    within("memory", 8 * count * int(np.prod(shape)), "the power series of the weights needs {} bytes")
    exact = comb(size + count, count) < 1 << 62
    series: Array = np.zeros((count, *shape), dtype=np.int64 if exact else object)
    series[(0, *reach)] = 1
    for weight, multiplicity in weights.items():
        source = tuple(slice(max(0, -x), side - max(0, x)) for x, side in zip(weight, shape, strict=True))
        target = tuple(slice(max(0, x), side - max(0, -x)) for x, side in zip(weight, shape, strict=True))
        for _ in range(multiplicity):
            in_time()
            for d in range(1, count):
                series[d][target] += series[d - 1][source]
    return [
        int(sum(c * series[(d, *(r - x for r, x in zip(reach, e, strict=True)))] for e, c in denominator.items()))
        for d in range(count)
    ]
