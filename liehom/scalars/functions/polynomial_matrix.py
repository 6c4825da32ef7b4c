"""Matrices of polynomials over QQ: generic rank, null space, and where the rank drops.

The minors of size r of a matrix M of generic rank r are products mu a_I b_J, where mu is their greatest common divisor,
and the a_I and the b_J are the coprime Pluecker coordinates of the column space and of the null space.  At real points
the rank is less than r exactly where the sum of the squares of the minors is 0, a coefficient of the characteristic
polynomial of M M^T.  Ranks modulo a prime choose rows and columns; null vectors are verified, which proves the rank.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from functools import cached_property
from itertools import combinations, combinations_with_replacement
from math import comb, prod
from typing import final

import flint

from liehom.errors import InternalError
from liehom.scalars.fields.exact_field import ExactMatrix
from liehom.scalars.fields.polynomial import Polynomial
from liehom.scalars.fields.rational import QQ
from liehom.scalars.spaces.minors import expanded_minors
from liehom.typing import ScalarLike

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
    """A matrix with entries in QQ[x0, x1, ...].

    Parameters
    ----------
    variables : int
        The number of variables.
    table : sequence of sequences of mappings from exponents (tuples) to rational numbers
        The entries, row by row.
    shape : pair of int
    weights : ExactMatrix, optional
        A positive definite form G on the columns: the rank polynomial is made from M G^-1 M^T, which has simpler
        eigenvalues than M M^T if G fits the symmetry of M.

    Examples
    --------
    >>> x, y = {(1, 0): 1}, {(0, 1): 1}
    >>> M = PolynomialMatrix(2, [[x, y], [y, x]], (2, 2))
    >>> M.rank, M.rank_conditions()
    (2, ([x0 + x1, x0 - x1], True))
    """

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
        found, left, unseen = [], set(range(self.shape[1])), set(range(self.shape[0]))
        while left:
            frontier = [min(left)]
            left -= set(frontier)
            rows: set[int] = set()
            columns: set[int] = set()
            while frontier:
                column = frontier.pop()
                columns.add(column)
                new = {i for i in unseen if not self.table[i][column].is_zero()}
                unseen -= new
                rows |= new
                more = {j for j in left if any(not self.table[i][j].is_zero() for i in new)}
                left -= more
                frontier += more
            found.append(_Block(self, _distinct(self.table, sorted(rows)), sorted(columns)))
        return found

    @property
    def rank(self) -> int:
        """The generic rank, which no values of the variables exceed, an int."""
        return sum(block.rank for block in self.blocks)

    @cached_property
    def null_space(self) -> tuple[list[Vector], list[Poly]]:
        """A basis of the null space over the rational functions, and irreducible polynomials.

        The basis consists of vectors of polynomials that are annihilated at all values of the variables. If the rank is
        generic and none of the polynomials is 0, these vectors are independent.
        """
        found = sorted((column, row) for block in self.blocks for column, row in block.null_rows().items())
        rows = [row for _, row in found]
        counted: dict[str, list[Poly]] = {}
        for column, row in found:  # the minor of the free columns is the product of these entries
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
        found: dict[str, Poly] = {}
        sharp = True
        for block in self.blocks:
            polynomial, exact = block.rank_polynomial()
            sharp = sharp and exact
            factors = [] if polynomial.is_constant() else [p for p, _ in polynomial.factor()[1] if not _is_definite(p)]
            found |= {str(p): p for p in map(_squares, factors)}
        shown = [found[key] for key in sorted(found, key=lambda k: (len(k), k))]
        return [p for p in shown if not any(p != q and self._is_inside(p, q) for q in shown)], sharp

    def _is_inside(self, p: Poly, q: Poly) -> bool:
        """Whether the real zeros of p are a subspace on which q is 0."""
        gram = _quadratic_form(p)
        if gram is None or min(gram.signature()[:2]):
            return False
        kernel = gram.null_space()
        if not kernel.nrows:
            return q.to_dict().get((0,) * self.context.nvars(), 0) == 0
        generators = self.context.gens()
        images = [
            sum((generators[k] * QQ.convert(kernel[k, i]) for k in range(kernel.nrows)), self.zero)
            for i in range(kernel.ncols)
        ]
        return bool(q.compose(*images, ctx=self.context).is_zero())

    def minors(self, limit: int) -> list[list[Poly]] | int:
        """The non-zero minors of size `rank` by their irreducible factors, each once; their number above the limit."""
        count = 1
        for block in self.blocks:
            count *= comb(len(block.rows), block.rank) * comb(len(block.columns), block.rank)
        if count > limit:
            return count
        products = [self.one]
        for block in self.blocks:
            products = [p * m for p in products for m in block.minors()]
        found: dict[tuple[str, ...], list[Poly]] = {}
        for p in products:
            factors = [] if p.is_constant() else [f for f, _ in p.factor()[1]]
            found.setdefault(tuple(sorted(map(str, factors))), factors)
        return list(found.values())

    def _saturated(self, rows: list[Vector], p: Poly) -> list[Vector] | None:
        """The vectors with one of them plus multiples of others, which is 0 modulo p, divided by p; None if none is."""
        degrees = [max(v.total_degree() for v in row) for row in rows]
        for t in sorted(range(len(rows)), key=lambda i: -degrees[i]):
            terms = [(t, self.one)]
            for i in range(len(rows)):
                if i != t and degrees[t] >= degrees[i]:
                    terms += [(i, m) for m in self._monomials(degrees[t] - degrees[i])]
            if len(terms) > MAX_UNKNOWNS:
                continue
            total = self._combination(rows, terms, p)
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
        relations = table.left_null_space()
        c = next((row for row in relations.to_rows() if row[0] != 0), None)
        if c is None:
            return None
        used = [(rows[i], m * QQ.convert(x)) for (i, m), x in zip(terms, c, strict=True) if x != 0]
        return [sum((row[j] * m for row, m in used), self.zero) for j in range(self.shape[1])]

    def _monomials(self, degree: int) -> list[Poly]:
        """The monomials of a degree."""
        generators = self.context.gens()
        return [prod(chosen, start=self.one) for chosen in combinations_with_replacement(generators, degree)]


@final
class _Block:
    """A block: rows and columns of a matrix of polynomials, with its rank."""

    def __init__(self, whole: PolynomialMatrix, rows: list[int], columns: list[int]) -> None:
        self.whole, self.rows, self.columns = whole, rows, columns
        self.table = [[whole.table[i][j] for j in columns] for i in rows]
        self._seed = 0
        self._choose()

    def _choose(self) -> None:
        """Pivots at a random point modulo the prime: the first independent columns, and short independent rows."""
        rng = random.Random(self._seed)
        self._seed += 1
        values = [rng.randrange(PRIME) for _ in range(self.whole.context.nvars())]
        self.pivots = _pivots(evaluated(self.table, values))
        order = sorted(range(len(self.rows)), key=lambda i: sum(len(v.to_dict()) for v in self.table[i]))
        turned = [[self.table[i][j] for i in order] for j in self.pivots]
        self.chosen = sorted(order[k] for k in _pivots(evaluated(turned, values)))
        self.rank = len(self.pivots)
        self.free = [j for j in range(len(self.columns)) if j not in set(self.pivots)]

    def null_rows(self) -> dict[int, Vector]:
        """For each free column a null vector of the whole matrix, by Cramer's rule."""
        for _ in range(ATTEMPTS):
            found = {self.columns[j]: self._null_row(j) for j in self.free}
            if all(self._is_null(row) for row in found.values()):
                return found
            self._choose()  # the rank at the random point was too small
        raise InternalError("no random point modulo a prime has the generic rank")

    def _null_row(self, free: int) -> Vector:
        zero, ncols = self.whole.zero, self.whole.shape[1]
        places = sorted([*self.pivots, free])
        turned = list(zip(*self.table, strict=True)) if self.table else [()] * len(self.columns)
        minors = expanded_minors(turned, places, self.chosen, self.whole.one)
        row = [zero] * ncols
        for k, j in enumerate(places):
            value = minors.get((*places[:k], *places[k + 1 :]), zero)
            row[self.columns[j]] = -value if k % 2 else value
        made = primitive(row, zero)
        return made if made[self.columns[free]].leading_coefficient() > 0 else [-v for v in made]

    def _is_null(self, row: Vector) -> bool:
        zero = self.whole.zero
        return all(
            sum((a * row[c] for a, c in zip(entries, self.columns, strict=True) if not a.is_zero()), zero).is_zero()
            for entries in self.table
        )

    def minors(self) -> list[Poly]:
        """All non-zero minors of the size of the rank."""
        found: list[Poly] = []
        for columns in combinations(range(len(self.columns)), self.rank):
            found += expanded_minors(self.table, range(len(self.rows)), columns, self.whole.one).values()
        return found

    def rank_polynomial(self) -> tuple[Poly, bool]:
        """A polynomial that is 0 where the rank is not generic, and whether it has no other real zeros."""
        r, shape = self.rank, (len(self.rows), len(self.columns))
        if r == 0:
            return self.whole.one, True
        if shape != (r, r):
            content = _common_divisor([v for row in self.table for v in row], self.whole.zero)
            gram = self._gram(content)
            total = sum((gram[i][i] for i in range(len(gram))), self.whole.zero)
            if self._is_multiple_of_projection(gram, total * flint.fmpq(1, r)):
                return total * content, True
            if comb(len(gram), r) * self._terms(2 * r) <= MAX_TERMS:
                minors = [expanded_minors(gram, c, c, self.whole.one) for c in combinations(range(len(gram)), r)]
                return sum((m for found in minors for m in found.values()), self.whole.zero) * content, True
        minor = expanded_minors(self.table, self.chosen, self.pivots, self.whole.one)
        return next(iter(minor.values())), shape == (r, r)

    def _gram(self, content: Poly) -> list[Vector]:
        """M G^-1 M^T with the weights G, or M^T M if it is smaller, of the matrix M divided by its content."""
        table = [[divmod(v, content)[0] for v in row] for row in self.table]
        zero = self.whole.zero
        if len(self.rows) > len(self.columns):
            table = list(map(list, zip(*table, strict=True)))
            return [[sum((x * y for x, y in zip(a, b, strict=True)), zero) for b in table] for a in table]
        form = self.whole.weights.select(rows=self.columns, columns=self.columns).inverse().to_rows()
        weighted = [
            [sum((x * QQ.convert(c) for x, c in zip(row, column, strict=True) if c != 0), zero) for column in form]
            for row in table
        ]
        return [[sum((x * y for x, y in zip(a, b, strict=True)), zero) for b in table] for a in weighted]

    def _is_multiple_of_projection(self, gram: Sequence[Vector], q: Poly) -> bool:
        """Whether X^2 = q X: then the non-zero eigenvalues of X are q, and the sum of its principal minors is q^r."""
        zero, n = self.whole.zero, len(gram)
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
        homogeneous = all(sum(e) == v.total_degree() for v in entries for e in v.to_dict())
        return comb(len(used) + degree - (1 if homogeneous else 0), degree)


def primitive(row: Vector, zero: Poly) -> Vector:
    """A vector of polynomials divided by its greatest common divisor, with coprime integer coefficients."""
    common = _common_divisor(row, zero)
    return integral([divmod(v, common)[0] for v in row])


def _common_divisor(polynomials: Sequence[Poly], zero: Poly) -> Poly:
    common = zero
    for v in polynomials:
        common = common.gcd(v)
    return common


def integral(row: Vector) -> Vector:
    """A multiple, by a positive number, of a vector of polynomials that is not 0: with coprime integer coefficients."""
    numbers = [c for v in row for c in v.to_dict().values()]
    den, num = flint.fmpz(1), flint.fmpz(0)
    for c in numbers:
        den = den.lcm(c.q)
    for c in numbers:
        num = num.gcd((c * den).p)
    return [v * flint.fmpq(den, num) for v in row]


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
    for _ in range(POINTS):
        point = zero_modulo(p, rng)
        if point is not None and evaluated(rows, point).rank() == len(rows):
            return True
    return False


def _value(p: Poly, values: Sequence[int]) -> int:
    return sum(_term(exponents, c, values) for exponents, c in p.to_dict().items()) % PRIME


def _term(exponents: Exponents, c: flint.fmpq, values: Sequence[int]) -> int:
    total = int(c.p) * pow(int(c.q), -1, PRIME)
    for v, e in zip(values, exponents, strict=True):
        if e:
            total = total * pow(v, e, PRIME) % PRIME
    return total


def _pivots(matrix: flint.nmod_mat) -> list[int]:
    """The pivot columns of the reduced echelon form."""
    reduced, rank = matrix.rref()
    return [next(j for j in range(reduced.ncols()) if int(reduced[i, j])) for i in range(rank)]


def _distinct(table: Sequence[Vector], rows: Sequence[int]) -> list[int]:
    """The rows without those that are a multiple of an earlier one by a number."""
    found: dict[tuple[str, ...], int] = {}
    for i in rows:
        leading = next(v for v in table[i] if not v.is_zero()).leading_coefficient()
        found.setdefault(tuple(str(v / leading) for v in table[i]), i)
    return sorted(found.values())


def _is_definite(p: Poly) -> bool:
    """Whether p is seen to have no real zeros: in one variable, or 1 + a sum of even monomials, all positive."""
    terms = p.to_dict()
    used = [i for i, d in enumerate(p.degrees()) if d]
    if len(used) == 1:
        coefficients = [flint.fmpq(0)] * (p.degrees()[used[0]] + 1)
        for exponents, c in terms.items():
            coefficients[exponents[used[0]]] = c
        return Polynomial(QQ, coefficients).count_real_roots() == 0
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
    generators = p.context().gens()
    total = 0 * p
    for row in gram.row_space().cleared().to_rows():
        total += sum((x * QQ.convert(c) for x, c in zip(generators, row, strict=True)), 0 * p) ** 2
    return total
