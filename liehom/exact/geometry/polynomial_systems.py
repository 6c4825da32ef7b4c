"""Real solutions of polynomial equations over QQ with finitely many complex ones, each exact in its number field.

A Groebner basis gives the finite-dimensional algebra A of polynomial functions on the solutions. The squarefree parts
of the minimal polynomials of the variables, added to the equations, make A reduced (Seidenberg). A linear form l that
separates the solutions then generates A, the variables are polynomials in l, and the solutions are the roots of the
minimal polynomial of l, whose irreducible factors define the number fields.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import count, product
from math import lcm
from typing import Any, final

import flint

from liehom.base.budget import in_time
from liehom.base.errors import InternalError
from liehom.exact.scalars.exact_field import ExactField
from liehom.exact.scalars.extension import adjoin_root, real_roots
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.polynomial import Polynomial, horner
from liehom.exact.scalars.rational import QQ

# Limits of Buchberger's algorithm: steps, members of the basis, bits of a coefficient.
MAX_STEPS = 2000
MAX_MEMBERS = 150
MAX_BITS = 20_000
MAX_SOLUTIONS = 200
PRECISION = 128

Exponents = tuple[int, ...]
Vector = dict[Exponents, flint.fmpq]


class UnfinishedError(Exception):
    """The solutions were not found: the message says whether there are infinitely many or a limit was reached."""


@final
@dataclass(frozen=True, slots=True)
class RealSolution:
    """A real solution: the values of the variables, in the field that they generate."""

    field: ExactField
    values: tuple[Scalar, ...]


def real_solutions(
    equations: Sequence[flint.fmpq_mpoly],
    nonzero: Sequence[flint.fmpq_mpoly],
    possible: Callable[[Sequence[flint.arb]], bool],
) -> list[RealSolution]:
    """The real solutions at which no polynomial of `nonzero` vanishes; `possible` may rule out enclosures of them.

    Raises `UnfinishedError` if there are infinitely many complex solutions or a limit is reached.
    """
    first = next(iter((*equations, *nonzero)))
    names = tuple(first.context().names())
    if not names:
        zero = all(e.is_zero() for e in equations)
        return [RealSolution(QQ, ())] if zero else []
    ring = flint.fmpz_mpoly_ctx.get(("u_", *names), flint.Ordering.degrevlex)
    known = [_integral(p, ring) for p in nonzero]
    inverted = reduce(lambda a, b: a * b, known, ring.gens()[0]) - 1
    found: list[RealSolution] = []
    start = [_integral(p, ring) for p in equations]
    for branch, excluded in _branches([p for p in start if not p.is_zero()], known, []):
        for solution in _solve([*branch, inverted], possible):
            if not any(_value(p, solution) == 0 for p in excluded):
                found.append(solution)
    return found


def _integral(p: flint.fmpq_mpoly, ring: flint.fmpz_mpoly_ctx) -> flint.fmpz_mpoly:
    """The primitive integer polynomial of a polynomial, in a ring with one more variable in front."""
    den = lcm(1, *(int(c.q) for c in p.coeffs()))
    q = ring.from_dict({(0, *e): int((c * den).p) for e, c in p.terms()})
    return q if q.is_zero() else q.primitive()[1]


def _value(p: flint.fmpz_mpoly, solution: RealSolution) -> Scalar:
    """Value of a polynomial without the auxiliary variable at a solution."""
    total = solution.field.zero
    for exponents, c in p.terms():
        term = solution.field.convert(int(c))
        for x, e in zip(solution.values, exponents[1:], strict=True):
            term = term * x ** int(e) if e else term
        total = total + term
    return total


def _branches(
    equations: list[flint.fmpz_mpoly], nonzero: Sequence[flint.fmpz_mpoly], excluded: list[flint.fmpz_mpoly]
) -> Iterator[tuple[list[flint.fmpz_mpoly], list[flint.fmpz_mpoly]]]:
    """Systems of irreducible equations, by the factors of the given ones, with the factors of earlier branches."""
    in_time()
    equations = sorted(equations, key=len)
    for i, p in enumerate(equations):
        factors = [f for f, _ in p.factor()[1] if not any(f in (q, -q) for q in nonzero)]
        rest = equations[:i] + equations[i + 1 :]
        if not factors:  # a number that is not zero, or a product of polynomials that are not zero
            return
        if len(factors) == 1:
            equations[i] = factors[0]
            continue
        for j, f in enumerate(factors):
            yield from _branches([*rest, f], nonzero, [*excluded, *factors[:j]])
        return
    yield equations, excluded


def _lead(p: flint.fmpz_mpoly) -> Exponents:
    return tuple(map(int, p.monoms()[0]))


def _divides(a: Exponents, b: Exponents) -> bool:
    return all(x <= y for x, y in zip(a, b, strict=True))


def _groebner(equations: list[flint.fmpz_mpoly]) -> list[flint.fmpz_mpoly]:
    """The reduced Groebner basis, with tails reduced at each step, without which coefficients grow fast."""
    ring = equations[0].context()
    basis: dict[Exponents, Any] = {}  # the type stubs of flint lack its S-polynomials
    queue: list[Any] = list(equations)
    pairs: list[tuple[int, Exponents, Exponents]] = []
    for steps in count():
        in_time()
        if queue:
            queue.sort(key=lambda p: (int(p.total_degree()), len(p)), reverse=True)
            p = queue.pop()
        elif pairs:
            pairs.sort(reverse=True)
            _, a, b = pairs.pop()
            p = basis[a].spoly(basis[b])
        else:
            return list(basis.values())
        rest = p.reduction_primitive_part(flint.fmpz_mpoly_vec(list(basis.values()), ring)) if basis else p
        if rest.is_zero():
            continue
        lead = _lead(rest)
        queue += [basis.pop(a) for a in list(basis) if _divides(lead, a)]
        pairs = [(d, a, b) for d, a, b in pairs if a in basis and b in basis]
        for a in basis:  # coprime leading monomials: the pair reduces to zero (Buchberger)
            if any(x and y for x, y in zip(a, lead, strict=True)):
                pairs.append((sum(map(max, a, lead)), a, lead))
        reduced = flint.fmpz_mpoly_vec([*basis.values(), rest], ring).autoreduction()
        basis = {_lead(g): g for g in reduced}
        bits = max(_height(g) for g in basis.values())
        if steps > MAX_STEPS or len(basis) > MAX_MEMBERS or bits > MAX_BITS:
            raise UnfinishedError("a Groebner basis exceeds the limits")
    raise InternalError("a loop without end has ended")


def _height(p: flint.fmpz_mpoly) -> int:
    """Bits of the largest coefficient."""
    return max(int(c).bit_length() for c in p.coeffs())


def _solve(
    equations: list[flint.fmpz_mpoly], possible: Callable[[Sequence[flint.arb]], bool]
) -> Iterator[RealSolution]:
    algebra = _Algebra(_groebner(equations))
    if not algebra.monomials:
        return
    gens = equations[0].context().gens()
    repeated = []
    for i, x in enumerate(gens):
        minimal = Polynomial(QQ, algebra.minimal_polynomial([int(i == j) for j in range(len(gens))])[0])
        parts = [p for p, _ in minimal.squarefree_parts()]
        if sum(p.degree for p in parts) < minimal.degree:
            repeated.append(_integer_value(reduce(lambda a, b: a * b, parts), x))
    if repeated:
        algebra = _Algebra(_groebner([*equations, *repeated]))
    yield from _points(algebra, len(gens), possible)


def _integer_value(p: Polynomial, x: flint.fmpz_mpoly) -> flint.fmpz_mpoly:
    """A rational polynomial in one variable, times its denominator, at a generator."""
    den = lcm(*(int(QQ.convert(c).q) for c in p.coefficients))
    total = x * 0
    for c in reversed(p.coefficients):
        total = total * x + int((QQ.convert(c) * den).p)
    return total


def _points(algebra: _Algebra, size: int, possible: Callable[[Sequence[flint.arb]], bool]) -> Iterator[RealSolution]:
    """The real solutions of a reduced algebra, by a linear form that separates them."""
    rng, degree = random.Random(5), len(algebra.monomials)
    for attempt in range(20):
        weights = [rng.randint(-1 - attempt, 2 + attempt) for _ in range(size)]
        coefficients, powers = algebra.minimal_polynomial(weights)
        if len(coefficients) == degree + 1:
            break
    else:
        raise InternalError("no linear form separates the solutions of polynomial equations")
    columns = [[algebra.vector(algebra.unit(i)).get(m, 0) for m in algebra.monomials] for i in range(1, size)]
    table = flint.fmpq_mat(degree, degree, [p.get(m, 0) for p in powers for m in algebra.monomials]).transpose()
    solved = table.solve(flint.fmpq_mat(columns).transpose()).transpose().tolist() if columns else []
    for factor, _ in Polynomial(QQ, coefficients).factor():
        reduced = [Polynomial(QQ, p) % factor for p in solved]
        for index, ball in enumerate(real_roots(factor, PRECISION)):
            if possible([horner(p.coefficients, ball, flint.arb(0)) for p in reduced]):
                up, root = adjoin_root(factor, index)
                field: ExactField = up.field
                yield RealSolution(field, tuple(horner(p.coefficients, root, field.zero) for p in reduced))


@final
class _Algebra:
    """The quotient of QQ[x] by an ideal with a reduced Groebner basis: `monomials` are a basis."""

    def __init__(self, basis: list[flint.fmpz_mpoly]) -> None:
        self.count: int = len(basis[0].context().names())
        self.tails: dict[Exponents, Vector] = {}
        for p in basis:
            terms = [(tuple(map(int, e)), flint.fmpq(c)) for e, c in p.terms()]
            (lead, top), *rest = terms
            self.tails[lead] = {e: -c / top for e, c in rest}
        pure = {i: max(e) for e in self.tails for i in range(self.count) if sum(e) == e[i]}
        if (0,) * self.count in self.tails:
            self.monomials: list[Exponents] = []
            return
        if len(pure) < self.count:
            raise UnfinishedError("there are infinitely many complex solutions")
        self.known: dict[Exponents, Vector] = {}
        self.monomials = [e for e in product(*(range(pure[i]) for i in range(self.count))) if self.is_standard(e)]
        if len(self.monomials) > MAX_SOLUTIONS:
            raise UnfinishedError(f"there are {len(self.monomials)} complex solutions, more than {MAX_SOLUTIONS}")

    def unit(self, i: int) -> Exponents:
        """Exponents of variable number i."""
        return tuple(int(i == j) for j in range(self.count))

    def is_standard(self, e: Exponents) -> bool:
        """Whether no leading monomial divides a monomial."""
        return not any(all(a >= b for a, b in zip(e, lead, strict=True)) for lead in self.tails)

    def vector(self, e: Exponents) -> Vector:
        """The normal form of a monomial."""
        if e in self.known:
            return self.known[e]
        if self.is_standard(e):
            value: Vector = {e: flint.fmpq(1)}
        elif e in self.tails:
            value = self.tails[e]
        else:
            below = ((i, tuple(a - (i == j) for j, a in enumerate(e))) for i in range(self.count) if e[i])
            i, smaller = next((i, b) for i, b in below if not self.is_standard(b))
            value = self.times(i, self.vector(smaller))
        self.known[e] = value
        return value

    def times(self, i: int, v: Vector) -> Vector:
        """The product of variable number i and an element."""
        total: Vector = {}
        for e, c in v.items():
            for m, x in self.vector(tuple(a + (i == j) for j, a in enumerate(e))).items():
                total[m] = total.get(m, flint.fmpq(0)) + c * x
        return {m: x for m, x in total.items() if x != 0}

    def minimal_polynomial(self, weights: Sequence[int]) -> tuple[list[flint.fmpq], list[Vector]]:
        """Ascending coefficients of the minimal polynomial of a linear form, and its powers below the degree."""
        in_time()
        size = len(self.monomials)
        powers: list[Vector] = [{(0,) * self.count: flint.fmpq(1)}]
        for _ in range(size):
            total: Vector = {}
            for i, w in enumerate(weights):
                for m, x in self.times(i, powers[-1]).items() if w else ():
                    total[m] = total.get(m, flint.fmpq(0)) + w * x
            powers.append(total)
        table = flint.fmpq_mat(size + 1, size, [p.get(m, 0) for p in powers for m in self.monomials]).transpose()
        reduced, rank = table.rref()
        # the powers below the degree are independent, so they are the pivots, and the next column is their combination
        return [*(-reduced[i, rank] for i in range(rank)), flint.fmpq(1)], powers[:rank]
