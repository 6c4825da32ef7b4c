"""Facts about a pair (g, h) that the independent checker verifies before it reads a certificate.

It uses only the structure constants and the basis of h. With V = g/h, d = dim V:

  * the rows of h are linearly independent ("independent"),
  * [h, h] lies in h ("closed"), so that rho(a)(x + h) = [a, x] + h is well defined on V,
  * rho([a, b]) = rho(a) rho(b) - rho(b) rho(a) for all a, b in h ("homomorphism").

Fullness is a statement about the Lie algebra rho(h) of linear maps of V, so it depends on g only through these facts.
The checker therefore does not check the Jacobi identity for three elements outside h.

Coordinates. The columns of Q, shape (n, d), are a basis of the linear forms that vanish on h, normalized to the
identity on d `free` indices: x Q are the coordinates of x mod h in the basis e_free of V. The rows e_p - Q_p e_free,
for the other indices p (`pivots`), are a basis of h, and the pivot entries of an element of h are its coordinates in
this basis. Maps of V act on coordinate rows from the right, v -> v R, so the composition A B (first B) has the matrix
R_B R_A.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from liehom.base.errors import CertificateError, InputError, shown
from liehom.exact.fullness.checker.verify_modular import Integers, IntegralPair, check_representation
from liehom.exact.fullness.checker.verify_roots import count_real_roots, trimmed, value
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.field import Field, Scalar
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.rational import QQ


class AlgebraData(Protocol):
    """Lie algebra, as far as the checker reads it."""

    @property
    def field(self) -> Field:
        """The field of scalars."""

    @property
    def dimension(self) -> int:
        """The dimension n."""

    def structure_constants(self) -> Iterable[tuple[int, int, int, Scalar]]:
        """All (i, j, k, value) with i < j and value != 0: [e_i, e_j] = sum over k of value e_k."""


class SubalgebraData(Protocol):
    """Subalgebra, as far as the checker reads it."""

    @property
    def basis(self) -> object:
        """The matrix (k, n) whose rows are the basis as given."""


class PairData(Protocol):
    """Pair, as far as the checker reads it."""

    @property
    def algebra(self) -> AlgebraData:
        """The algebra g, as `AlgebraData`."""

    @property
    def subalgebra(self) -> SubalgebraData:
        """The subalgebra h, as `SubalgebraData`."""


@dataclass(frozen=True, slots=True)
class CheckedPair:
    """Pair that passed `check_pair`: the coordinates of V = g/h and the isotropy representation."""

    field: ExactField
    dimension: int
    free: tuple[int, ...]
    pivots: tuple[int, ...]
    quotient: ExactMatrix
    """Q, shape (n, d)."""
    isotropy: ExactMatrix
    """Shape (k, d d): row p is the matrix R of rho(e_p - Q_p e_free), row after row."""

    @property
    def codimension(self) -> int:
        """Dimension d of g/h."""
        return len(self.free)

    def in_h(self, rows: ExactMatrix) -> bool:
        """Whether all rows lie in h."""
        return (rows @ self.quotient).is_zero()

    def rho(self, rows: ExactMatrix) -> list[ExactMatrix]:
        """The matrices R of rho(z) for rows z of h."""
        d = self.codimension
        flat = rows.select(columns=self.pivots) @ self.isotropy
        return [flat.select(rows=[i]).reshape(d, d) for i in range(rows.nrows)]


def check_pair(pair: PairData) -> CheckedPair:
    """Verified pair, after a check of the three facts in the module's docstring."""
    field = pair.algebra.field
    if not isinstance(field, ExactField):
        raise CertificateError("exact", f"the pair is over {field.name}; only a pair over an exact field is proved")
    _check_field(field)
    n, basis = int(pair.algebra.dimension), pair.subalgebra.basis
    if not isinstance(basis, ExactMatrix) or basis.ncols != n or basis.field != field:
        raise CertificateError("pair", f"the basis of h is {basis!r}, expected {n} columns over {field.name}")
    places, constants = _checked_constants(field, n, pair.algebra.structure_constants())
    free, pivots, quotient = _quotient(field, basis)
    integral, scale = _integral(field, places, constants, quotient, free, pivots)
    check_representation(integral)
    isotropy = integral.isotropy.scale(field.one / scale)
    return CheckedPair(field, n, free, pivots, quotient, isotropy)


def check_same_field(field: ExactField, other: ExactField) -> None:
    """Check that a certificate is over the field of the pair, with the same real embedding.

    Two isolating intervals of one polynomial contain the same root if and only if their intersection contains a root.
    """
    if not isinstance(field, NumberField) or not isinstance(other, NumberField):
        if field != other:
            raise CertificateError("field", f"the certificate is over {other.name}, the pair over {field.name}")
        return
    _check_field(other)
    low, high = (pick(a, b) for pick, a, b in zip((max, min), field.interval, other.interval, strict=True))
    f: list[Scalar] = [QQ.convert(c) for c in field.minpoly]
    if field.minpoly != other.minpoly or not low < high or count_real_roots(QQ, f, low, high) != 1:
        raise CertificateError(
            "field",
            f"the certificate is over {other.name} with minpoly {_listed(other.minpoly)} on {_listed(other.interval)}, "
            f"the pair over {field.name} with {_listed(field.minpoly)} on {_listed(field.interval)}: not the same "
            "number",
        )


def _check_field(field: ExactField) -> None:
    """Check that the interval of a number field contains exactly one root of its polynomial (Sturm).

    The arithmetic needs an irreducible polynomial: the constructor of `NumberField`, called again here, factors it.
    """
    if not isinstance(field, NumberField):
        return
    f, (low, high) = trimmed([QQ.convert(c) for c in field.minpoly]), field.interval
    try:
        NumberField(field.symbol, field.minpoly, field.interval)
    except InputError as error:
        raise CertificateError("field", str(error)) from None
    if not low < high or value(f, low) == 0 or value(f, high) == 0 or count_real_roots(QQ, f, low, high) != 1:
        interval = _listed(field.interval)
        raise CertificateError("field", f"the interval {interval} does not hold exactly one root of {_listed(f)}")


def _listed(numbers: Iterable[int | Scalar]) -> str:
    """Rational numbers of any number of digits in a message."""
    return shown(f"({', '.join(QQ.format(QQ.convert(c)) for c in numbers)})")


def _checked_constants(
    field: ExactField, n: int, entries: Iterable[tuple[int, int, int, Scalar]]
) -> tuple[Integers, list[Scalar]]:
    """Distinct indices (i, j, k), i < j < n, as an array of shape (number, 3), and the constants at these indices."""
    places, constants = [], []
    for i, j, k, c in entries:
        places.append((i, j, k))
        constants.append(field.convert(c))
    indices = np.array(places, dtype=np.int64).reshape(-1, 3)
    first, second, third = indices.T
    outside = (first < 0) | (first >= second) | (second >= n) | (third < 0) | (third >= n)
    if np.any(outside) or len(set(places)) < len(places):
        raise CertificateError("pair", "a structure constant is out of range or given twice")
    return indices, constants


def _quotient(field: ExactField, basis: ExactMatrix) -> tuple[tuple[int, ...], tuple[int, ...], ExactMatrix]:
    """Free indices, pivots and Q. The rank of H and H Q = 0 are verified, independently of the way to find Q."""
    k, n = basis.shape
    if basis.rank() != k:
        raise CertificateError("independent", f"the {k} rows of h are linearly dependent")
    reduced, found = basis.echelon()
    pivots = tuple(found)
    free = tuple(j for j in range(n) if j not in set(pivots))
    rows = [[field.zero] * len(free) for _ in range(n)]
    for p, row in zip(pivots, (-reduced.select(columns=free)).to_rows(), strict=True):
        rows[p] = row
    for position, j in enumerate(free):
        rows[j][position] = field.one
    quotient = field.matrix(rows, (n, len(free)))
    if len(free) != n - k or not (basis @ quotient).is_zero():
        raise CertificateError("independent", "no coordinates on g/h were found")
    return free, pivots, quotient


def _integral(
    field: ExactField,
    places: Integers,
    constants: list[Scalar],
    quotient: ExactMatrix,
    free: tuple[int, ...],
    pivots: tuple[int, ...],
) -> tuple[IntegralPair, int]:
    """Pair with denominators cleared, with its isotropy R' = delta q^2 R, and the factor delta q^2.

    Let D[i; u, v] = ([e_i, e_u]' Q')_v, where u counts the free indices. Then R'_p = q D_p - sum over t of Q'_pt D_t.
    """
    n, d = quotient.shape
    row = field.from_entries(constants, 1, len(constants))
    cleared, integral = row.cleared(), quotient.cleared()
    position = {j: u for u, j in enumerate(free)}
    seen = [m for m, entries in enumerate(integral.to_rows()) if any(x != 0 for x in entries)]
    column = {m: place for place, m in enumerate(seen)}
    brackets: dict[tuple[int, int], dict[int, Scalar]] = {}
    for (i, j, m), c in zip(places.tolist(), cleared.entries(), strict=True):
        if m not in column:
            continue
        if j in position:
            brackets.setdefault((i, position[j]), {})[column[m]] = c
        if i in position:
            brackets.setdefault((j, position[i]), {})[column[m]] = -c
    table = [field.zero] * (len(brackets) * len(seen))
    for number, bracket in enumerate(brackets.values()):
        for place, c in bracket.items():
            table[number * len(seen) + place] = c
    values = (field.from_entries(table, len(brackets), len(seen)) @ integral.select(rows=seen)).entries()
    spread = [field.zero] * (n * d * d)
    for number, (i, u) in enumerate(brackets):
        spread[(i * d + u) * d : (i * d + u + 1) * d] = values[number * d : (number + 1) * d]
    action = field.from_entries(spread, n, d * d)
    isotropy = action.select(rows=pivots).scale(quotient.den)
    isotropy = isotropy - integral.select(rows=pivots) @ action.select(rows=free)
    pair = IntegralPair(field, n, free, pivots, places, cleared, integral, quotient.den, isotropy)
    return pair, row.den * quotient.den**2
