"""Matrices of polynomials (generic rank, minors, where the rank drops), and polynomials that linear fields annihilate.

Minors are computed without division, by expansion along columns, one subset of rows after another. M(x) = x_0 M_0 + ...
+ x_{m-1} M_{m-1} is a matrix of linear forms over QQ or a real number field, whose generator is one more variable
modulo its minimal polynomial.
"""

from __future__ import annotations

import functools
import random
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from itertools import chain, combinations, combinations_with_replacement, islice, product
from math import comb, gcd, lcm, prod
from operator import mul
from typing import NamedTuple, TypeAlias, cast, final

import flint
import numpy as np

from liehom.base.budget import in_time, within
from liehom.base.errors import FieldError, InputError, InternalError, ShapeError
from liehom.base.typing import Expression, IntegerArray, ScalarLike
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.function_field import common_divisor, content
from liehom.exact.scalars.modular import (
    left_kernel,
    null_rows,
    pivot_columns,
    rational_lifts,
    residue_matrix,
    row_basis,
    splitting_primes,
)
from liehom.exact.scalars.polynomial import Polynomial, horner
from liehom.exact.scalars.rational import QQ

Table = Sequence[Sequence[flint.fmpq_mpoly]]


def expanded_minors(
    table: Table,
    rows: Sequence[int],
    columns: Sequence[int],
    one: flint.fmpq_mpoly,
    reduced: Callable[[flint.fmpq_mpoly], flint.fmpq_mpoly] | None = None,
) -> dict[tuple[int, ...], flint.fmpq_mpoly]:
    """The non-zero minors with all of the given columns, by their rows: expansion along one column after another."""
    minors: dict[tuple[int, ...], flint.fmpq_mpoly] = {(): one}
    for size, column in enumerate(columns, start=1):
        grown: dict[tuple[int, ...], flint.fmpq_mpoly] = {}
        for chosen in combinations(rows, size):
            in_time()
            total = 0 * one
            for place, row in enumerate(chosen):
                rest = minors.get(chosen[:place] + chosen[place + 1 :])
                entry = table[row][column]
                if rest is not None and not entry.is_zero():
                    term = entry * rest
                    total = total - term if (size - 1 - place) % 2 else total + term
            if reduced is not None:
                total = reduced(total)
            if not total.is_zero():
                grown[chosen] = total
        minors = grown
    return minors


@final
class LinearForms:
    """A matrix of linear forms M(x) = sum_i x_i M_i."""

    __slots__ = ("_context", "_modulus", "_table", "_zero", "field", "parts", "shape")

    def __init__(self, parts: Sequence[ExactMatrix]) -> None:
        if not parts or any(part.shape != parts[0].shape for part in parts):
            raise ShapeError("a matrix of linear forms needs matrices of one shape, at least one")
        self.parts: tuple[ExactMatrix, ...] = tuple(parts)
        self.field: ExactField = parts[0].field
        self.shape: tuple[int, int] = parts[0].shape
        names = [f"x{i}" for i in range(len(parts))] + ["b"] * (self.field.degree > 1)
        self._context = flint.fmpq_mpoly_ctx.get(names, "degrevlex")
        generators = self._context.gens()
        self._zero = 0 * generators[0]
        self._modulus: flint.fmpq_mpoly | None = None
        if self.field.degree > 1:
            self._modulus = horner(self.field.modulus_coefficients(), generators[-1], self._zero)
        self._table = self._forms(generators)

    def _forms(self, generators: Sequence[flint.fmpq_mpoly]) -> list[list[flint.fmpq_mpoly]]:
        nrows, ncols = self.shape
        table = [[self._zero] * ncols for _ in range(nrows)]
        for x, part in zip(generators, self.parts, strict=False):
            for s, numerators in enumerate(part.parts):
                unit = x * generators[-1] ** s if s else x
                for place, v in enumerate(numerators.entries()):
                    if v:
                        i, j = divmod(place, ncols)
                        table[i][j] = table[i][j] + unit * flint.fmpq(v, part.den)
        return table

    def at(self, values: Sequence[ScalarLike]) -> ExactMatrix:
        """The matrix M(x) for field elements x, an `ExactMatrix`."""
        pairs = zip(values, self.parts, strict=True)
        return sum((part.scale(value) for value, part in pairs), self.field.zeros(*self.shape))

    def times(self, right: ExactMatrix) -> LinearForms:
        """The `LinearForms` M(x) T for a constant matrix T."""
        return LinearForms([part @ right for part in self.parts])

    # -- minors ------------------------------------------------------------------------------------------
    def minor(self, rows: Sequence[int], columns: Sequence[int]) -> flint.fmpq_mpoly:
        """Determinant of the given rows and columns, a ``flint.fmpq_mpoly``; over QQ(b) in the variable b too."""
        modulus = self._modulus
        reduced = None if modulus is None else lambda polynomial: divmod(polynomial, modulus)[1]
        minors = expanded_minors(self._table, rows, columns, self._zero + 1, reduced)
        return minors.get(tuple(rows), self._zero)

    # -- proofs ------------------------------------------------------------------------------------------
    def invariant_factors(
        self, first: flint.fmpq_mpoly, second: flint.fmpq_mpoly, fields: Sequence[ExactMatrix]
    ) -> list[flint.fmpq_mpoly]:
        """The irreducible common factors p of two polynomials with grad p . A x a multiple of p for all A."""
        if self._modulus is not None:
            raise FieldError(f"polynomials in several variables are factored over QQ only, not over {self.field.name}")
        common = first.gcd(second)
        if common.is_constant():
            return []
        flows = [[linear_form(self._context.gens(), row) for row in a.to_rows()] for a in fields]
        return [p for p, _ in common.factor()[1] if all(self._is_semi_invariant(p, flow) for flow in flows)]

    def _is_semi_invariant(self, polynomial: flint.fmpq_mpoly, flow: list[flint.fmpq_mpoly]) -> bool:
        along = sum((polynomial.derivative(i) * component for i, component in enumerate(flow)), self._zero)
        return bool(divmod(along, polynomial)[1].is_zero())


def linear_form(generators: Sequence[flint.fmpq_mpoly], coefficients: Sequence[Scalar]) -> flint.fmpq_mpoly:
    """The linear form with these rational coefficients of the first generators."""
    terms = (x * QQ.convert(c) for x, c in zip(generators, coefficients, strict=False) if c != 0)
    return sum(terms, 0 * generators[0])


# Where M loses rank on a line x + t y, over the complex numbers. If M(y) has full row rank d, the determinant of (M(x)
# + t M(y)) T for a constant matrix T is, up to a factor, the characteristic polynomial of -(M(y) T)^-1 M(x) T. The
# roots of the greatest common divisor of a few of them contain all t at which the rank is less than d. At a root of an
# irreducible factor f the rank is computed over QQ(t) by its companion matrix C: it is the rank of M(x) (x) 1 + M(y)
# (x) C over QQ divided by the degree of f.

SAMPLES = 3


class RankLoss(NamedTuple):
    """Conjugate points x + t y of a line at which the rank is less than the number of rows d."""

    degree: int  # the number of points
    rank: int  # at each of them
    transversal: bool  # whether the direction y of the line is outside the column space there


def rank_losses_on_line(
    forms: LinearForms, start: Sequence[ScalarLike], direction: Sequence[ScalarLike]
) -> list[RankLoss]:
    """The points of a line x + t y over the complex numbers at which the rank is less than the number of rows."""
    if forms.field != QQ:
        raise FieldError(f"polynomials are factored over QQ only, not over {forms.field.name}")
    d = forms.shape[0]
    first, last = forms.at(start), forms.at(direction)
    if last.rank() < d:
        raise InputError(f"the matrix has rank {last.rank()} < {d} at the direction of the line")
    column = QQ.matrix([list(direction)]).T
    rng = random.Random(d)
    common = flint.fmpq_poly([0])
    for _ in range(SAMPLES):
        common = common.gcd(_minor(first, last, rng))
    losses = []
    for factor, _ in common.factor()[1]:
        e = factor.degree()
        companion = _companion(factor)
        at = _kronecker(first, QQ.identity(e)) + _kronecker(last, companion)
        rank = at.rank() // e
        if rank < d:
            more = QQ.stack_rows([at.T, _kronecker(column, QQ.identity(e)).T], d * e).rank() // e
            losses.append(RankLoss(e, rank, more == rank + 1))
    return losses


def _minor(first: ExactMatrix, last: ExactMatrix, rng: random.Random) -> flint.fmpq_poly:
    """det((M(x) + t M(y)) T) for a random constant T with det(M(y) T) != 0, divided by the leading coefficient."""
    d, m = last.shape
    while True:
        mix = QQ.matrix([[rng.randint(-2, 2) for _ in range(d)] for _ in range(m)])
        square = last @ mix
        if square.rank() == d:
            # -(M(y) T)^-1 M(x) T has the eigenvalues t
            coefficients = (-square.solve(first @ mix)).characteristic_coefficients()
            return flint.fmpq_poly(cast(list[flint.fmpq], coefficients))


def _companion(factor: flint.fmpq_poly) -> ExactMatrix:
    e = factor.degree()
    lead = flint.fmpq(factor[e])
    rows = [[flint.fmpq(int(i == j + 1)) for j in range(e - 1)] + [-flint.fmpq(factor[i]) / lead] for i in range(e)]
    return QQ.matrix(rows)


def _kronecker(left: ExactMatrix, right: ExactMatrix) -> ExactMatrix:
    """The matrix whose (i, j) block is left[i, j] times the right matrix."""
    rows = [QQ.stack_rows([right.scale(c).T for c in row], right.nrows).T for row in left.to_rows()]
    return QQ.stack_rows(rows, left.ncols * right.ncols)


# The minors of size r of a matrix M of polynomials over QQ, of generic rank r, are products mu a_I b_J. Here mu is
# their greatest common divisor, and the a_I and the b_J are the coprime Pluecker coordinates of the column space and of
# the null space. At real points the rank is less than r exactly where the sum of the squares of the minors is 0, a
# coefficient of the characteristic polynomial of M M^T. Ranks modulo a prime choose rows and columns; null vectors are
# verified, which proves the rank.

PRIME = (1 << 61) - 1
POINTS = 3  # random points of a hypersurface, modulo the prime
MAX_TERMS = 150_000  # of all squares of minors together
MAX_UNKNOWNS = 400  # of a combination of null vectors
ATTEMPTS = 5
Exponents = tuple[int, ...]
Terms = Mapping[Exponents, ScalarLike]
Poly = flint.fmpq_mpoly
Vector = list[flint.fmpq_mpoly]


@final
class PolynomialMatrix:
    """A matrix with entries in QQ[x0, x1, ...]."""

    def __init__(
        self,
        variables: int,
        table: Sequence[Sequence[Terms]],
        shape: tuple[int, int],
        weights: ExactMatrix | None = None,
    ) -> None:
        names = [f"x{i}" for i in range(max(variables, 1))]
        self.context: flint.fmpq_mpoly_ctx = flint.fmpq_mpoly_ctx.get(names, flint.Ordering.degrevlex)
        self.zero: Poly = self.context.constant(0)
        self.one: Poly = self.context.constant(1)
        self.table: list[Vector] = [[self._polynomial(terms) for terms in row] for row in table]
        self.shape = shape
        self.weights: ExactMatrix = QQ.identity(shape[1]) if weights is None else weights

    def _polynomial(self, terms: Terms) -> Poly:
        return self.context.from_dict({e or (0,): QQ.convert(c) for e, c in terms.items()})

    # -- the generic rank --------------------------------------------------------------------------------
    @cached_property
    def blocks(self) -> list[_Block]:
        """The blocks of the matrix, which is block diagonal after permutations of rows and columns."""
        blocks, left, unseen = [], set(range(self.shape[1])), set(range(self.shape[0]))
        while left:
            columns, rows = [min(left)], set[int]()
            left -= {*columns}
            for column in columns:  # which grows
                new = {i for i in unseen if not self.table[i][column].is_zero()}
                unseen -= new
                rows |= new
                more = {j for j in left if any(not self.table[i][j].is_zero() for i in new)}
                left -= more
                columns += more
            blocks.append(_Block(self, _distinct(self.table, sorted(rows)), sorted(columns)))
        return blocks

    @property
    def rank(self) -> int:
        """The generic rank, which no values of the variables exceed, an int."""
        return sum(block.rank for block in self.blocks)

    @cached_property
    def null_space(self) -> tuple[list[Vector], list[Poly]]:
        """Vectors annihilated at all values of the variables, and irreducible polynomials.

        The vectors are a basis wherever the rank is generic and none of the polynomials is 0.
        """
        pairs = sorted((column, row) for block in self.blocks for column, row in block.null_rows().items())
        rows = [row for _, row in pairs]
        counted: dict[str, list[Poly]] = {}
        for column, row in pairs:  # the minor of the free columns is the product of these entries
            for p, multiplicity in row[column].factor()[1]:
                counted.setdefault(str(p), []).extend([p] * multiplicity)
        left = []
        for p, *more in counted.values():
            multiplicity = 1 + len(more)
            while multiplicity and (better := self._saturated(rows, p)) is not None:
                rows, multiplicity = better, multiplicity - 1
            if multiplicity and not _is_definite(p) and not _stays_independent(rows, p):
                left.append(p)
        return rows, left

    # -- where the rank drops ----------------------------------------------------------------------------
    def rank_conditions(self) -> tuple[list[Poly], bool]:
        """Polynomials such that the rank is generic where none is 0, and whether the rank drops at all real zeros.

        They are irreducible over QQ. A form whose real zeros are a subspace is replaced by a sum of squares of linear
        forms, and left out if another polynomial is 0 on the subspace.
        """
        pairs = [block.rank_polynomial() for block in self.blocks]
        factors = (f for p, _ in pairs if not p.is_constant() for f, _ in p.factor()[1] if not _is_definite(f))
        known = {str(p): p for p in map(_squares, factors)}
        shown = [known[key] for key in sorted(known, key=lambda k: (len(k), k))]
        sharp = all(exact for _, exact in pairs)
        return [p for p in shown if not any(p != q and self._is_inside(p, q) for q in shown)], sharp

    def _is_inside(self, p: Poly, q: Poly) -> bool:
        """Whether the real zeros of p are a subspace on which q is 0."""
        gram = _quadratic_form(p)
        if gram is None or min(gram.signature()[:2]):
            return False
        kernel = gram.null_space()
        if not kernel.nrows:
            return q.to_dict().get((0,) * self.context.nvars(), 0) == 0
        images = [linear_form(self.context.gens(), column) for column in kernel.T]
        return bool(q.compose(*images, ctx=self.context).is_zero())

    def minors(self, limit: int) -> list[list[Poly]] | int:
        """The non-zero minors of size `rank` by their irreducible factors, each once; their number above the limit."""
        count = prod(comb(len(b.rows), b.rank) * comb(len(b.columns), b.rank) for b in self.blocks)
        if count > limit:
            return count
        products = [self.one]
        for block in self.blocks:
            products = [p * m for p in products for m in block.minors()]
        known: dict[tuple[str, ...], list[Poly]] = {}
        for p in products:
            factors = [] if p.is_constant() else [f for f, _ in p.factor()[1]]
            known.setdefault(tuple(sorted(map(str, factors))), factors)
        return list(known.values())

    def _saturated(self, rows: list[Vector], p: Poly) -> list[Vector] | None:
        """The vectors with one of them plus multiples of others, which is 0 modulo p, divided by p; None if none is."""
        degrees = [max(v.total_degree() for v in row) for row in rows]
        for t in sorted(range(len(rows)), key=lambda i: -degrees[i]):
            others = [i for i in range(len(rows)) if i != t and degrees[t] >= degrees[i]]
            terms = [(t, self.one), *((i, m) for i in others for m in self._monomials(degrees[t] - degrees[i]))]
            total = self._combination(rows, terms, p) if len(terms) <= MAX_UNKNOWNS else None
            if total is not None:
                return [*rows[:t], integral([divmod(v, p)[0] for v in total]), *rows[t + 1 :]]
        return None

    def _combination(self, rows: list[Vector], terms: list[tuple[int, Poly]], p: Poly) -> Vector | None:
        """The first of the given multiples of vectors plus numbers times the other ones that is 0 modulo p."""
        keys: dict[tuple[int, Exponents], int] = {}
        remainders = []
        for i, m in terms:
            entries = {(j, e): c for j, v in enumerate(rows[i]) for e, c in divmod(v * m, p)[1].to_dict().items()}
            remainders.append({keys.setdefault(key, len(keys)): c for key, c in entries.items()})
        table = QQ.matrix([[r.get(i, 0) for i in range(len(keys))] for r in remainders], (len(terms), len(keys)))
        c = next((row for row in table.left_null_space().to_rows() if row[0] != 0), None)
        if c is None:
            return None
        used = [(rows[i], m * QQ.convert(x)) for (i, m), x in zip(terms, c, strict=True) if x != 0]
        return [sum((row[j] * m for row, m in used), self.zero) for j in range(self.shape[1])]

    def _monomials(self, degree: int) -> list[Poly]:
        """The monomials of a degree."""
        choices = combinations_with_replacement(self.context.gens(), degree)
        return [prod(chosen, start=self.one) for chosen in choices]


@final
class _Block:
    """A block: rows and columns of a matrix of polynomials, with its rank."""

    def __init__(self, matrix: PolynomialMatrix, rows: list[int], columns: list[int]) -> None:
        self.matrix, self.rows, self.columns = matrix, rows, columns
        self.table = [[matrix.table[i][j] for j in columns] for i in rows]
        self._seed = 0
        self._choose()

    def _choose(self) -> None:
        """Pivots at a random point modulo the prime: the first independent columns, and short independent rows."""
        rng = random.Random(self._seed)
        self._seed += 1
        values = [rng.randrange(PRIME) for _ in range(self.matrix.context.nvars())]
        self.pivots = pivot_columns(evaluated(self.table, values))
        order = sorted(range(len(self.rows)), key=lambda i: sum(len(v.to_dict()) for v in self.table[i]))
        turned = [[self.table[i][j] for i in order] for j in self.pivots]
        self.chosen = sorted(order[k] for k in pivot_columns(evaluated(turned, values)))
        self.rank = len(self.pivots)
        self.free = [j for j in range(len(self.columns)) if j not in self.pivots]

    def null_rows(self) -> dict[int, Vector]:
        """For each free column a null vector of the full matrix, by Cramer's rule."""
        for _ in range(ATTEMPTS):
            rows = {self.columns[j]: self._null_row(j) for j in self.free}
            if all(map(self._is_null, rows.values())):
                return rows
            self._choose()  # the rank at the random point was too small
        raise InternalError("no random point modulo a prime has the generic rank")

    def _null_row(self, free: int) -> Vector:
        zero, ncols = self.matrix.zero, self.matrix.shape[1]
        places = sorted([*self.pivots, free])
        turned = list(zip(*self.table, strict=True)) if self.table else [()] * len(self.columns)
        minors = expanded_minors(turned, places, self.chosen, self.matrix.one)
        row = [zero] * ncols
        for k, j in enumerate(places):
            value = minors.get((*places[:k], *places[k + 1 :]), zero)
            row[self.columns[j]] = -value if k % 2 else value
        row = primitive(row, zero)
        return row if row[self.columns[free]].leading_coefficient() > 0 else [-v for v in row]

    def _is_null(self, row: Vector) -> bool:
        zero = self.matrix.zero
        return all(
            sum((a * row[c] for a, c in zip(entries, self.columns, strict=True) if not a.is_zero()), zero).is_zero()
            for entries in self.table
        )

    def minors(self) -> list[Poly]:
        """All non-zero minors of the size of the rank."""
        rows, choices = range(len(self.rows)), combinations(range(len(self.columns)), self.rank)
        return [m for c in choices for m in expanded_minors(self.table, rows, c, self.matrix.one).values()]

    def rank_polynomial(self) -> tuple[Poly, bool]:
        """A polynomial that is 0 where the rank is not generic, and whether it has no other real zeros."""
        r, shape = self.rank, (len(self.rows), len(self.columns))
        if r == 0:
            return self.matrix.one, True
        if shape != (r, r):
            common = common_divisor((v for row in self.table for v in row), self.matrix.zero)
            gram = self._gram(common)
            total = sum((gram[i][i] for i in range(len(gram))), self.matrix.zero)
            if self._is_multiple_of_projection(gram, total * flint.fmpq(1, r)):
                return total * common, True
            if comb(len(gram), r) * self._terms(2 * r) <= MAX_TERMS:
                minors = (expanded_minors(gram, c, c, self.matrix.one) for c in combinations(range(len(gram)), r))
                return sum((m for known in minors for m in known.values()), self.matrix.zero) * common, True
        minor = expanded_minors(self.table, self.chosen, self.pivots, self.matrix.one)
        return next(iter(minor.values())), shape == (r, r)

    def _gram(self, common: Poly) -> list[Vector]:
        """M G^-1 M^T with the weights G, or M^T M if it is smaller, of the matrix M divided by a common divisor."""
        table, zero = [[divmod(v, common)[0] for v in row] for row in self.table], self.matrix.zero
        if len(self.rows) > len(self.columns):
            table = weighted = list(map(list, zip(*table, strict=True)))
        else:
            form = self.matrix.weights.select(rows=self.columns, columns=self.columns).inverse()
            weighted = [[linear_form(row, column) for column in form] for row in table]
        return [[sum((x * y for x, y in zip(a, b, strict=True)), zero) for b in table] for a in weighted]

    def _is_multiple_of_projection(self, gram: Sequence[Vector], q: Poly) -> bool:
        """Whether X^2 = q X: then the non-zero eigenvalues of X are q, and the sum of its principal minors is q^r."""
        zero, n = self.matrix.zero, len(gram)
        return all(
            sum((gram[i][k] * gram[k][j] for k in range(n)), zero) == q * gram[i][j]
            for i in range(n)
            for j in range(i + 1)
        )

    def _terms(self, factors: int) -> int:
        """Bound of the number of terms of a product of entries."""
        entries = [v for row in self.table for v in row if not v.is_zero()]
        used = {i for v in entries for i, d in enumerate(v.degrees()) if d}
        degree = factors * max(v.total_degree() for v in entries)
        homogeneous = bool(used) and all(sum(e) == v.total_degree() for v in entries for e in v.to_dict())
        return comb(len(used) + degree - homogeneous, degree)


def primitive(row: Vector, zero: Poly) -> Vector:
    """A vector of polynomials divided by its greatest common divisor, with coprime integer coefficients."""
    in_time()
    common = common_divisor(row, zero)
    return integral([divmod(v, common)[0] for v in row])


def integral(row: Vector) -> Vector:
    """A multiple, by a positive number, of a vector of polynomials that is not 0: with coprime integer coefficients."""
    factor = 1 / content(row)
    return [v * factor for v in row]


def evaluated(table: Sequence[Sequence[Poly]], values: Sequence[int]) -> flint.nmod_mat:
    """The matrix of the values of polynomials at a point modulo the prime."""
    ncols = len(table[0]) if table else 0
    return flint.nmod_mat(len(table), ncols, [_value(v, values) for row in table for v in row], PRIME)


def zero_modulo(p: Poly, rng: random.Random) -> list[int] | None:
    """A point modulo the prime at which p is 0, random in all coordinates except one; None if none was found."""
    used = [i for i, d in enumerate(p.degrees()) if d]
    for _ in range(4 * POINTS):
        place = rng.choice(used)
        values = [rng.randrange(PRIME) for _ in p.degrees()]
        coefficients = [0] * (p.degrees()[place] + 1)
        for exponents, c in p.to_dict().items():
            rest = (*exponents[:place], 0, *exponents[place + 1 :])
            coefficients[exponents[place]] += _term(rest, c, values)
        for factor, _ in flint.nmod_poly([c % PRIME for c in coefficients], PRIME).factor()[1]:
            if factor.degree() == 1:
                values[place] = int(-factor[0] / factor[1])
                return values
    return None


def _stays_independent(rows: Sequence[Vector], p: Poly) -> bool:
    """Whether vectors are independent at a point modulo the prime at which p is 0: then they are at generic zeros."""
    rng = random.Random(0)
    points = (zero_modulo(p, rng) for _ in range(POINTS))
    return any(point is not None and evaluated(rows, point).rank() == len(rows) for point in points)


def _value(p: Poly, values: Sequence[int]) -> int:
    return sum(_term(exponents, c, values) for exponents, c in p.to_dict().items()) % PRIME


def _term(exponents: Exponents, c: flint.fmpq, values: Sequence[int]) -> int:
    total = int(c.p) * pow(int(c.q), -1, PRIME)
    for v, e in zip(values, exponents, strict=True):
        if e:
            total = total * pow(v, e, PRIME) % PRIME
    return total


def _distinct(table: Sequence[Vector], rows: Sequence[int]) -> list[int]:
    """The rows without those that are a multiple of an earlier one by a number."""
    first: dict[tuple[str, ...], int] = {}
    for i in rows:
        leading = next(v for v in table[i] if not v.is_zero()).leading_coefficient()
        first.setdefault(tuple(str(v / leading) for v in table[i]), i)
    return sorted(first.values())


def _is_definite(p: Poly) -> bool:
    """Whether p is seen to have no real zeros: in one variable, or 1 + a sum of even monomials, all positive."""
    terms = p.to_dict()
    used = [i for i, d in enumerate(p.degrees()) if d]
    if len(used) == 1:
        coefficients = {exponents[used[0]]: c for exponents, c in terms.items()}
        return Polynomial(QQ, [coefficients.get(k, 0) for k in range(max(coefficients) + 1)]).count_real_roots() == 0
    even = all(e % 2 == 0 for exponents in terms for e in exponents)
    return even and len({c > 0 for c in terms.values()}) == 1 and (0,) * len(p.degrees()) in terms


def _quadratic_form(p: Poly) -> ExactMatrix | None:
    """The symmetric matrix of a quadratic form; None for other polynomials."""
    n, terms = len(p.degrees()), p.to_dict()
    if any(sum(e) != 2 for e in terms):
        return None
    table = [[flint.fmpq(0)] * n for _ in range(n)]
    for exponents, c in terms.items():
        i, j = (k for k, e in enumerate(exponents) for _ in range(e))
        table[i][j] += c / 2
        table[j][i] += c / 2
    return QQ.matrix(table, (n, n))


def _squares(p: Poly) -> Poly:
    """A sum of squares of linear forms with the same real zeros, if p is a semidefinite quadratic form; else p."""
    gram = _quadratic_form(p)
    if gram is None or min(gram.signature()[:2]):
        return p
    return sum((linear_form(p.context().gens(), row) ** 2 for row in gram.row_space().cleared()), 0 * p)


# A matrix of sympy expressions is a `PolynomialMatrix` divided by a common denominator.


def factors(expression: Expression, parameters: Sequence[Expression]) -> list[Expression]:
    """The distinct irreducible factors, over QQ, of the numerator of a rational function, without constants."""
    import sympy

    numerator = sympy.fraction(sympy.cancel(expression))[0]
    if not numerator.free_symbols:
        return []
    pairs = sympy.Poly(numerator, *parameters, domain="QQ").factor_list()[1]
    return sorted((f.as_expr() for f, _ in pairs), key=str)


def generic_rank(
    rows: Sequence[Sequence[Expression]], parameters: Sequence[Expression]
) -> tuple[int, list[Expression], bool]:
    """The rank over the field of fractions, conditions under which it is the rank, and whether they are sharp.

    The rank is the same wherever no condition is zero, and no value of the parameters at which the entries are defined
    has a larger rank. Sharp conditions: at real zeros of one of them the rank is smaller.
    """
    import sympy

    matrix = sympy.Matrix([list(row) for row in rows])
    over = polynomial_matrix(matrix, tuple(parameters))
    if over is None or 0 in matrix.shape:
        return 0, [], True
    conditions, sharp = over.rank_conditions()
    return over.rank, [expression_of(p, parameters) for p in conditions], sharp


def polynomial_matrix(
    matrix: Expression, symbols: Sequence[Expression], weights: ExactMatrix | None = None
) -> PolynomialMatrix | None:
    """A matrix of rational functions times its common denominator; None if a coefficient is not rational."""
    import sympy

    entries = [sympy.fraction(v) for v in matrix]
    if any(not c.is_Rational for pair in entries for v in pair for c in v.atoms(sympy.Number, sympy.AlgebraicNumber)):
        return None
    den = functools.reduce(sympy.lcm, (d for _, d in entries), sympy.Integer(1))
    generators = symbols or (sympy.Dummy(),)
    polys = [sympy.Poly(n * sympy.cancel(den / d), *generators) for n, d in entries]
    if not all(p.domain.is_ZZ or p.domain.is_QQ for p in polys):
        return None
    terms = [{e: Fraction(int(c.p), int(c.q)) for e, c in p.terms() if c} for p in polys]
    nrows, ncols = matrix.shape
    table = [terms[i * ncols : (i + 1) * ncols] for i in range(nrows)]
    return PolynomialMatrix(len(symbols), table, (nrows, ncols), weights)


def expression_of(polynomial: Poly, symbols: Sequence[Expression]) -> Expression:
    """A polynomial of flint as a sympy expression."""
    import sympy

    terms = {e: sympy.Rational(int(c.p), int(c.q)) for e, c in polynomial.to_dict().items()}
    if not symbols or not terms:
        return sympy.Add(*terms.values())
    return sympy.Poly.from_dict(terms, *symbols).as_expr()


# Polynomials with integer coefficients that linear vector fields annihilate.
# A monomial of degree d in x_0, ..., x_(n-1) is the sorted tuple of the indices of its factors. A matrix A acts as the
# derivation with x_j -> sum_k A[j, k] x_k. Matrices that are diagonal give weights, and only monomials of weight 0 are
# unknowns. The kernel of the others is computed modulo a prime, where it is at least as large, lifted to QQ,
# and checked.

Monomial: TypeAlias = tuple[int, ...]
IntegerTerms: TypeAlias = dict[Monomial, int]
"""A polynomial with integer coefficients, by monomials."""

MAX_MULTIPLES = 800  # of the denominator, among which one without negative coefficients above is looked for
ONE_CALL = 1 << 20  # entries of a system of equations up to which flint solves it in one call, which has no deadline
LARGE_POINT = 1 << 40  # bound on the coordinates of a random point


def invariant_polynomials(actions: Sequence[ExactMatrix], variables: int, degree: int) -> list[IntegerTerms]:
    """A basis, over QQ, of the polynomials of a degree that all matrices (n, n) annihilate, primitive ones over Z."""
    count = comb(variables + degree - 1, degree)
    within("memory", 80 * count, f"the {count} monomials of degree {degree} need {{}} bytes")
    images = [_images(a) for a in actions]
    weights = [[dict(row).get(j, 0) for j, row in enumerate(image)] for image in images if _is_diagonal(image)]

    def is_fixed(monomial: Monomial) -> bool:
        in_time()
        return all(sum(w[j] for j in monomial) == 0 for w in weights)

    monomials = [*filter(is_fixed, combinations_with_replacement(range(variables), degree))]
    equations = _equations([image for image in images if not _is_diagonal(image)], monomials)
    basis = [terms for block in _blocks(len(monomials), equations) for terms in _kernel(*block)]
    return [_primitive({monomials[i]: c for i, c in terms.items()}) for terms in basis]


def _blocks(count: int, equations: list[dict[int, int]]) -> list[tuple[list[int], list[dict[int, int]]]]:
    """The unknowns and equations of the finest decomposition of a linear system."""
    parent = list(range(count))

    def root(x: int) -> int:
        while parent[x] != x:
            parent[x] = parent[parent[x]]
            x = parent[x]
        return x

    for equation in equations:
        in_time()
        first, *others = equation
        for x in others:
            parent[root(x)] = root(first)
    blocks: dict[int, tuple[list[int], list[dict[int, int]]]] = {}
    for x in range(count):
        blocks.setdefault(root(x), ([], []))[0].append(x)
    for equation in equations:
        blocks[root(next(iter(equation)))][1].append(equation)
    return list(blocks.values())


def _kernel(unknowns: list[int], equations: list[dict[int, int]]) -> list[dict[int, int]]:
    """A basis of the solutions, each the integers by unknown that are not 0."""
    n = len(unknowns)
    within("memory", 16 * n * len(equations), f"{len(equations)} equations for {n} coefficients need {{}} bytes")
    place = {x: i for i, x in enumerate(unknowns)}

    def table(p: int) -> IntegerArray:
        residues: IntegerArray = np.zeros((n, len(equations)), dtype=np.int64)
        for j, equation in enumerate(equations):
            in_time()
            residues[[place[x] for x in equation], j] = [c % p for c in equation.values()]
        return residues

    def modular(attempt: int) -> flint.nmod_mat:
        p = QQ.residue(attempt)[0]
        return row_basis(null_rows(residue_matrix(n, len(equations), table(p).ravel().tolist(), p)))

    def in_parts(attempt: int) -> flint.nmod_mat:
        """The same modulo a small prime, by an elimination that ends with the deadline."""
        p = next(islice(splitting_primes(QQ), attempt, None))[0]
        kernel = left_kernel(table(p), p)
        return row_basis(residue_matrix(len(kernel), n, kernel.ravel().tolist(), p))

    by_size = [modular] if n * len(equations) < ONE_CALL else [in_parts, modular]
    for proposal in chain.from_iterable(rational_lifts(make, QQ) for make in by_size):
        entries = [int(x) for x in proposal.parts[0].entries()]
        rows = (entries[i * n : (i + 1) * n] for i in range(proposal.nrows))
        solutions = [{x: c for x, c in zip(unknowns, row, strict=True) if c} for row in rows]
        # modulo a prime there are at least as many solutions
        if all(sum(s.get(x, 0) * c for x, c in equation.items()) == 0 for s in solutions for equation in equations):
            return solutions
    raise InternalError("no small fractions solve the equations of invariant polynomials")


def _images(action: ExactMatrix) -> list[list[tuple[int, int]]]:
    """The images of the variables under the derivation, times a common denominator, as (variable, coefficient)."""
    n, entries = action.ncols, action.parts[0].entries()
    rows = (entries[j * n : (j + 1) * n] for j in range(n))
    return [[(k, int(x)) for k, x in enumerate(row) if x] for row in rows]


def _is_diagonal(image: list[list[tuple[int, int]]]) -> bool:
    return all(k == j for j, row in enumerate(image) for k, _ in row)


def _equations(images: list[list[list[tuple[int, int]]]], monomials: list[Monomial]) -> list[dict[int, int]]:
    """The equations for the coefficients of the monomials, as {index of the monomial: coefficient}."""
    rows: dict[tuple[int, Monomial], dict[int, int]] = {}
    for a, image in enumerate(images):
        for i, monomial in enumerate(monomials):
            in_time()
            for t, j in enumerate(monomial):
                for k, c in image[j]:
                    row = rows.setdefault((a, tuple(sorted((*monomial[:t], k, *monomial[t + 1 :])))), {})
                    row[i] = row.get(i, 0) + c
    return list({tuple(row.items()): row for row in rows.values()}.values())


def _primitive(terms: IntegerTerms) -> IntegerTerms:
    """The multiple without a common factor whose first coefficient is positive."""
    common = gcd(*terms.values())
    common = -common if next(iter(terms.values())) < 0 else common
    return {m: c // common for m, c in terms.items()}


def expression_of_terms(terms: IntegerTerms, names: Sequence[str]) -> Expression:
    """A polynomial as a sympy expression in symbols with these names."""
    import sympy

    symbols = [sympy.Symbol(name) for name in names]
    return sympy.Add(*(c * sympy.Mul(*(symbols[j] for j in m)) for m, c in terms.items()))


def independent(polynomials: Sequence[IntegerTerms], variables: int) -> list[int]:
    """Indices of polynomials whose gradients are independent at a random point, each of the earlier ones."""
    p = QQ.residue()[0]
    rng = random.Random(variables)
    point = [rng.randrange(1, LARGE_POINT) for _ in range(variables)]
    rows = [[_derivative(terms, j, point) % p for j in range(variables)] for terms in polynomials]
    chosen: list[int] = []
    for i in range(len(rows)):
        tried = [rows[x] for x in (*chosen, i)]
        if residue_matrix(len(tried), variables, (x for row in tried for x in row), p).rank() == len(tried):
            chosen.append(i)
    return chosen


def _derivative(terms: IntegerTerms, j: int, point: Sequence[int]) -> int:
    """The value of the derivative by variable j at a point."""
    total = 0
    for monomial, c in terms.items():
        if power := monomial.count(j):
            total += c * power * prod(point[k] for k in monomial if k != j) * point[j] ** (power - 1)
    return total


# A power series of which enough coefficients are known as N(t) / D(t), where D is a product of factors 1 - t^d.


def as_fraction(series: Sequence[int], orders: Mapping[int, int]) -> tuple[list[int], list[int]]:
    """N, with no negative coefficients if possible, and the d of D, for H with H prod Phi_n^orders[n] a polynomial.

    Phi_n are the cyclotomic polynomials. The degree of the polynomial is less than the number of known coefficients.
    """
    factors = {n: flint.fmpz_poly.cyclotomic(n) for n in orders}
    whole = prod((factors[n] ** k for n, k in orders.items()), start=flint.fmpz_poly([1]))
    shortest: tuple[list[int], list[int]] | None = None
    top = (flint.fmpz_poly(list(series)) * whole).truncate(len(series))
    left = dict(orders)
    for n, phi in factors.items():
        while left[n]:
            quotient, rest = divmod(top, phi)
            if not rest.is_zero():
                break
            top, left[n] = quotient, left[n] - 1
    below = _degrees(left)
    under = prod((factors[n] ** k for n, k in left.items()), start=flint.fmpz_poly([1]))
    multiples = sorted(product((1, 2, 3), repeat=len(below)), key=lambda m: sum(map(mul, m, below)))
    for factor in multiples[:MAX_MULTIPLES]:
        degrees = sorted(map(mul, factor, below))
        scaled = prod((1 - flint.fmpz_poly([0] * d + [1]) for d in degrees), start=top) // under
        numerator = [int(c) * int(scaled[0]) for c in scaled.coeffs()]  # Phi_1 = t - 1 leaves the sign open; N(0) = 1
        if min(numerator) >= 0:
            return numerator, degrees
        shortest = shortest or (numerator, degrees)
    return shortest or ([1], [])


def _degrees(orders: Mapping[int, int]) -> list[int]:
    """Few numbers such that at least orders[n] of them are divisible by n, for each n."""
    bins = [1] * max(orders.values(), default=0)
    for n in sorted(orders, reverse=True):
        bins.sort(key=lambda d: (lcm(d, n) - d, d))
        bins[: orders[n]] = [lcm(d, n) for d in bins[: orders[n]]]
    return sorted(bins)
