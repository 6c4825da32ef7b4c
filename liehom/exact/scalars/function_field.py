"""Rational functions on a variety: the ring QQ[x_1, ..., x_n] modulo some polynomials, and its field of fractions,
exactly.

A polynomial is given by its normal form, the remainder by a Groebner basis, which is zero if and only if it is zero on
the variety. If the only constraint is F = r with F homogeneous and r a number, such as |m|^2 = 1, a function whose
terms all have the same degree modulo deg F equals a homogeneous polynomial (multiply by powers of F/r), which can be
factorized and cancelled. Division of p by a sum a of an even and an odd function on a quadric is division of p a(-x) by
a a(-x), which is even.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations_with_replacement, product
from math import comb, prod
from typing import Any, ClassVar, final

import flint

from liehom.base.errors import FieldError, SingularError
from liehom.base.typing import Number, ScalarLike
from liehom.exact.scalars.rational import QQ, rational_number

MAX_TERMS_TO_FACTOR = 3000  # a divisor of more terms is not factorized, and no shorter form of it is sought
MAX_UNKNOWNS = 500  # coefficients of the polynomials among which a quotient is sought, with several constraints


@final
class CoordinateRing:
    """The ring QQ[names] / (constraints): `basis` is a Groebner basis of the constraints in the `context` QQ[names]."""

    __slots__ = ("_form", "basis", "context", "names", "weights")

    def __init__(
        self,
        names: Sequence[str],
        constraints: Iterable[Mapping[tuple[int, ...], ScalarLike]] = (),
        graded: Sequence[str] = (),
    ) -> None:
        self.names: tuple[str, ...] = tuple(names)
        self.context: flint.fmpq_mpoly_ctx = flint.fmpq_mpoly_ctx.get(self.names, flint.Ordering.degrevlex)
        equations = [c for c in map(self.polynomial, constraints) if not c.is_zero()]
        self.basis: list[flint.fmpq_mpoly] = equations if len(equations) < 2 else self._groebner(equations)
        if any(c.is_constant() for c in self.basis):
            raise FieldError("the constraints contradict each other: they have no common zero")
        self.weights: list[int] = [int(name in graded) for name in self.names]
        self._form = self._homogeneous_form(equations)

    def polynomial(self, terms: Mapping[tuple[int, ...], ScalarLike]) -> flint.fmpq_mpoly:
        """The polynomial with these terms, a ``flint.fmpq_mpoly``."""
        return self.context.from_dict({e: QQ.convert(c) for e, c in terms.items()})

    def reduce(self, p: flint.fmpq_mpoly) -> flint.fmpq_mpoly:
        """The normal form of a polynomial modulo the constraints."""
        if len(self.basis) == 1:
            return divmod(p, self.basis[0])[1]
        before = None
        while p != before:
            before = p
            for g in self.basis:
                p = divmod(p, g)[1]
        return p

    def _groebner(self, equations: list[flint.fmpq_mpoly]) -> list[flint.fmpq_mpoly]:
        import sympy

        symbols = sympy.symbols([f"x{i}" for i in range(len(self.names))])
        terms = ({e: sympy.Rational(int(c.p), int(c.q)) for e, c in p.terms()} for p in equations)
        polys = [sympy.Poly.from_dict(t, *symbols) for t in terms]
        return [self.polynomial(dict(p.terms())) for p in sympy.groebner(polys, *symbols, order="grevlex").polys]

    # -- the grading -------------------------------------------------------------------------------------
    def _homogeneous_form(self, equations: list[flint.fmpq_mpoly]) -> tuple[flint.fmpq_mpoly, int] | None:
        """F/r and its degree if the only constraint is F - r, else None."""
        if len(equations) != 1:
            return None
        parts = self._parts(equations[0])
        if len(parts) != 2 or 0 not in parts or not parts[0].is_constant():
            return None
        return parts[max(parts)] / -parts[0].leading_coefficient(), max(parts)

    def _parts(self, p: flint.fmpq_mpoly) -> dict[int, flint.fmpq_mpoly]:
        """The homogeneous parts of a polynomial, by degree."""
        terms: dict[int, dict[Any, Any]] = {}
        for e, c in p.terms():
            degree = sum(int(k) for k, w in zip(e, self.weights, strict=True) if w)
            terms.setdefault(degree, {})[e] = c
        return {degree: self.context.from_dict(part) for degree, part in terms.items()}

    def homogeneous(self, p: flint.fmpq_mpoly) -> flint.fmpq_mpoly | None:
        """The homogeneous polynomial, not divisible by F, that equals p on the variety; None if it does not exist."""
        if self._form is None:
            return None if self.basis else p
        form, e = self._form
        parts = self._parts(p)
        if not parts or len({degree % e for degree in parts}) > 1:
            return None
        lifted = (part * form ** ((max(parts) - degree) // e) for degree, part in parts.items())
        total = sum(lifted, self.context.constant(0))
        while not total.is_zero():
            quotient, rest = divmod(total, form)
            if not rest.is_zero():
                break
            total = quotient
        return total

    def divide(self, p: flint.fmpq_mpoly, q: flint.fmpq_mpoly) -> flint.fmpq_mpoly | None:
        """The polynomial p/q in normal form, or None if no quotient on the variety is found."""
        if self._form is None:
            quotient, rest = divmod(p, q)
            if rest.is_zero():
                return self.reduce(quotient)
            return self._divide_by_ansatz(p, q) if len(self.basis) > 1 else None
        divisor = self.homogeneous(q)
        if divisor is not None:
            return self._divide_parts(p, divisor)
        if self._form[1] != 2:
            return None
        mirrored = sum(((-1) ** degree * part for degree, part in self._parts(q).items()), self.context.constant(0))
        even = self.homogeneous(self.reduce(q * mirrored))
        return None if even is None else self._divide_parts(self.reduce(p * mirrored), even)

    def _divide_by_ansatz(self, p: flint.fmpq_mpoly, q: flint.fmpq_mpoly) -> flint.fmpq_mpoly | None:
        """A quotient of low degree, by linear algebra, since normal forms do not factor uniquely; None if not found."""
        least = max(0, int(p.total_degree()) - int(q.total_degree()))
        for degree in (least, least + 1):
            used = [i for i, d in enumerate(p.degrees()) if d]
            count = comb(len(used) + degree, degree)
            if count > MAX_UNKNOWNS:
                return None
            gens = [self.context.constant(1), *(self.context.gens()[i] for i in used)]
            monomials = [prod(chosen, start=gens[0]) for chosen in combinations_with_replacement(gens, degree)]
            candidates = list({str(m): m for m in map(self.reduce, monomials) if len(m) == 1}.values())
            products = [dict(self.reduce(m * q).terms()) for m in candidates]
            right = dict(p.terms())
            rows = sorted({e for x in (*products, right) for e in x})
            n = len(candidates)
            both = flint.fmpq_mat(len(rows), n + 1, [x.get(e, 0) for e in rows for x in (*products, right)])
            reduced, rank = both.rref()
            pivots = [next(j for j in range(n + 1) if reduced[i, j] != 0) for i in range(rank)]
            if n in pivots:
                continue
            terms = (candidates[j] * reduced[i, n] for i, j in enumerate(pivots))
            return self.reduce(sum(terms, self.context.constant(0)))
        return None

    def _divide_parts(self, p: flint.fmpq_mpoly, divisor: flint.fmpq_mpoly) -> flint.fmpq_mpoly | None:
        """Quotient by a homogeneous polynomial, one class of degrees after another; None if it is not exact."""
        e = self._form[1] if self._form is not None else 1
        classes: dict[int, flint.fmpq_mpoly] = {}
        for degree, part in self._parts(p).items():
            classes[degree % e] = classes.get(degree % e, self.context.constant(0)) + part
        lifted = [self.homogeneous(part) for part in classes.values()]
        pairs = [divmod(part, divisor) for part in lifted if part is not None]
        if len(pairs) < len(lifted) or any(not rest.is_zero() for _, rest in pairs):
            return None
        return self.reduce(sum((quotient for quotient, _ in pairs), self.context.constant(0)))

    def shortest(self, p: flint.fmpq_mpoly) -> flint.fmpq_mpoly:
        """A polynomial with few terms that equals p on the variety, possibly p itself."""
        forms = [p]
        for name in self.names if self._form is not None and len(p) <= MAX_TERMS_TO_FACTOR else ():
            order = (name, *(other for other in self.names if other != name))
            ring = flint.fmpq_mpoly_ctx.get(order, flint.Ordering.lex)
            rest = divmod(p.project_to_context(ring), self.basis[0].project_to_context(ring))[1]
            forms.append(rest.project_to_context(self.context))
        return min(forms, key=lambda q: (len(q), len(str(q))))

    def graded_weights(self, polynomials: Iterable[flint.fmpq_mpoly], optional: Sequence[str]) -> list[str]:
        """The optional variables that need degree 1 for all polynomials to be graded; [] if no choice serves."""
        if self._form is None:
            return []
        e = self._form[1]
        chosen = list(polynomials)
        for bits in product((0, 1), repeat=min(len(optional), 10)):
            extra = [name for name, bit in zip(optional, bits, strict=False) if bit]
            weights = [w or int(name in extra) for w, name in zip(self.weights, self.names, strict=True)]
            if all(_one_degree(p, weights, e) for p in chosen):
                return extra
        return []


def _one_degree(p: flint.fmpq_mpoly, weights: list[int], e: int) -> bool:
    return len({sum(int(k) for k, w in zip(m, weights, strict=True) if w) % e for m in p.monoms()}) <= 1


def common_divisor(polynomials: Iterable[flint.fmpq_mpoly], zero: flint.fmpq_mpoly) -> flint.fmpq_mpoly:
    """The greatest common divisor of polynomials; 0 if all are 0."""
    common = zero
    for p in polynomials:
        common = common.gcd(p)
    return common


def content(polynomials: Iterable[flint.fmpq_mpoly]) -> flint.fmpq:
    """The positive rational number after division by which the coefficients are coprime integers."""
    top, bottom = flint.fmpz(0), flint.fmpz(1)
    for c in (c for p in polynomials for c in p.coeffs()):
        top, bottom = top.gcd(c.p), bottom.lcm(c.q)
    return flint.fmpq(top, bottom)


# A fraction has a normal form as numerator, so it is zero if and only if its numerator is. The denominator is a product
# of powers of known polynomials ("atoms"), so fractions with denominators such as |X|^2 and |X|^4 are added without a
# gcd.

Powers = tuple[tuple[int, int], ...]


@final
class FunctionField:
    """The field of fractions of QQ[names] / (constraints); the constraints should generate a prime ideal.

    Equality in the ring is proved for every ideal: an element is 0 if its numerator is in the ideal. Only division
    requires a prime ideal, because a divisor of zero must not be a denominator.
    """

    def __init__(
        self,
        names: Sequence[str],
        constraints: Iterable[Mapping[tuple[int, ...], ScalarLike]] = (),
        graded: Sequence[str] = (),
    ) -> None:
        self.ring: CoordinateRing = CoordinateRing(names, constraints, graded)
        constant = self.ring.context.constant
        self.atoms: list[flint.fmpq_mpoly] = []
        self.reduced: list[flint.fmpq_mpoly] = []  # the normal forms of the atoms
        self.zero: RationalFunction = RationalFunction(self, constant(0), ())
        self.one: RationalFunction = RationalFunction(self, constant(1), ())
        generators = map(self.ring.reduce, self.ring.context.gens())
        self.variables: tuple[RationalFunction, ...] = tuple(RationalFunction(self, g, ()) for g in generators)

    # -- denominators ------------------------------------------------------------------------------------
    def atom(self, p: flint.fmpq_mpoly) -> int:
        """Index of the atom p, which is added if it is new."""
        if p not in self.atoms:
            self.atoms.append(p)
            self.reduced.append(self.ring.reduce(p))
        return self.atoms.index(p)

    def denominator(self, powers: Powers) -> flint.fmpq_mpoly:
        """Normal form of a product of powers of atoms."""
        product = self.ring.context.constant(1)
        for p in (self.reduced[i] for i, k in powers for _ in range(k)):
            product = self.ring.reduce(product * p)
        return product

    def inverse(self, p: flint.fmpq_mpoly) -> RationalFunction:
        """1 / p for a polynomial that is not zero on the variety."""
        if p.is_zero():
            raise SingularError("division by a function that is zero")
        lifted = self.ring.homogeneous(p)
        powers: dict[int, int] = {}
        if lifted is None:
            for i in range(len(self.atoms)):
                while (quotient := self.ring.divide(p, self.reduced[i])) is not None:
                    p, powers[i] = quotient, powers.get(i, 0) + 1
        source = p if lifted is None else lifted
        number, factors = source.leading_coefficient(), [(source / source.leading_coefficient(), 1)]
        if len(source) <= MAX_TERMS_TO_FACTOR:
            number, factors = source.factor()
        for factor, k in factors:
            if not factor.is_constant():
                i = self.atom(factor)
                powers[i] = powers.get(i, 0) + int(k)
        return RationalFunction(self, self.ring.context.constant(1) / number, tuple(sorted(powers.items())))

    def primitive(self, vector: Sequence[RationalFunction]) -> list[RationalFunction]:
        """A multiple of a vector without denominators or known common divisor; its leading coefficient is positive."""
        common: Powers = ()
        for x in vector:
            common = join(common, x.powers)
        tops = [x.over(common) for x in vector]
        lifted = [None if p.is_zero() else self.ring.homogeneous(p) for p in tops]
        known = [p if q is None else q for p, q in zip(tops, lifted, strict=True)]
        divisor = common_divisor(known, self.ring.context.constant(0))
        if divisor.is_zero():
            return [self.zero for _ in vector]
        known = [divmod(p, divisor)[0] for p in known]
        first = next(p for p in known if not p.is_zero())
        scale = content(known) * (1 if first.leading_coefficient() > 0 else -1)
        return [RationalFunction(self, self.ring.reduce(p / scale), ()) for p in known]

    # -- numbers -----------------------------------------------------------------------------------------
    def convert(self, value: RationalFunction | Number | int) -> RationalFunction:
        """The element equal to a rational number or an element."""
        if isinstance(value, RationalFunction):
            return value
        number = rational_number(value)
        if number is None:
            raise FieldError(f"{value!r} is not a rational number: write a fraction, or a symbol for it")
        return RationalFunction(self, self.ring.context.constant(number), ())


@final
class RationalFunction:
    """An element of a `FunctionField`, with arithmetic with rational numbers and elements of the same field."""

    __slots__ = ("field", "numerator", "powers")

    def __init__(self, field: FunctionField, numerator: flint.fmpq_mpoly, powers: Powers) -> None:
        self.field: FunctionField = field
        self.numerator: flint.fmpq_mpoly = numerator
        self.powers: Powers = () if numerator.is_zero() else powers

    def _other(self, value: Any) -> RationalFunction | None:
        if isinstance(value, RationalFunction):
            return value
        number = rational_number(value)
        return None if number is None else RationalFunction(self.field, self.field.ring.context.constant(number), ())

    def __add__(self, other: RationalFunction | Number | int) -> RationalFunction:
        right = self._other(other)
        if right is None:
            return NotImplemented
        if self.powers == right.powers:
            return RationalFunction(self.field, self.numerator + right.numerator, self.powers)
        common = join(self.powers, right.powers)
        return RationalFunction(self.field, self.over(common) + right.over(common), common)

    __radd__ = __add__

    def over(self, common: Powers) -> flint.fmpq_mpoly:
        """The numerator of the function over `common`, a multiple of its denominator."""
        if common == self.powers:
            return self.numerator
        own = dict(self.powers)
        missing = tuple((i, k - own.get(i, 0)) for i, k in common if k > own.get(i, 0))
        return self.field.ring.reduce(self.numerator * self.field.denominator(missing))

    def __neg__(self) -> RationalFunction:
        return RationalFunction(self.field, -self.numerator, self.powers)

    def __sub__(self, other: RationalFunction | Number | int) -> RationalFunction:
        right = self._other(other)
        return NotImplemented if right is None else self + (-right)

    def __rsub__(self, other: RationalFunction | Number | int) -> RationalFunction:
        left = self._other(other)
        return NotImplemented if left is None else left + (-self)

    def __mul__(self, other: RationalFunction | Number | int) -> RationalFunction:
        if not isinstance(other, RationalFunction):
            number = rational_number(other)
            if number is None:
                return NotImplemented
            return RationalFunction(self.field, self.numerator * number, self.powers)
        product = self.field.ring.reduce(self.numerator * other.numerator)
        return RationalFunction(self.field, product, times(self.powers, other.powers))

    __rmul__ = __mul__

    def __truediv__(self, other: RationalFunction | Number | int) -> RationalFunction:
        if not isinstance(other, RationalFunction):
            number = rational_number(other)
            if number is None:
                return NotImplemented
            if number == 0:
                raise SingularError("division by a function that is zero")
            return RationalFunction(self.field, self.numerator / number, self.powers)
        return self * other.inverse()

    def __rtruediv__(self, other: RationalFunction | Number | int) -> RationalFunction:
        left = self._other(other)
        return NotImplemented if left is None else left * self.inverse()

    def inverse(self) -> RationalFunction:
        """The inverse function 1 / f."""
        below = RationalFunction(self.field, self.field.denominator(self.powers), ())
        return self.field.inverse(self.numerator) * below

    def __pow__(self, exponent: int) -> RationalFunction:
        if isinstance(exponent, bool) or not isinstance(exponent, int):
            return NotImplemented
        return prod([self if exponent >= 0 else self.inverse()] * abs(exponent), start=self.field.one)

    def __eq__(self, other: object) -> bool:
        right = self._other(other)
        return NotImplemented if right is None else bool((self - right).numerator.is_zero())

    __hash__: ClassVar[None] = None  # type: ignore[assignment]

    def __bool__(self) -> bool:
        return not self.numerator.is_zero()

    # -- simplification ----------------------------------------------------------------------------------
    def cancelled(self) -> RationalFunction:
        """The function after cancelling the atoms of the denominator that are found to divide the numerator."""
        if not self.powers:
            return self
        top, kept = self.numerator, []
        for i, k in self.powers:
            while k and (quotient := self.field.ring.divide(top, self.field.reduced[i])) is not None:
                top, k = quotient, k - 1
            if k:
                kept.append((i, k))
        return RationalFunction(self.field, top, tuple(kept))

    def factors(self) -> tuple[flint.fmpq, list[tuple[flint.fmpq_mpoly, int]]]:
        """A number and pairs (polynomial, exponent of either sign) whose product equals the function on the variety."""
        lifted = self.field.ring.homogeneous(self.numerator)
        top = self.numerator if lifted is None else lifted
        if top.is_zero():
            return flint.fmpq(0), []
        number, above = top.factor()
        below = [(self.field.atoms[i], -k) for i, k in self.powers]
        return number, [(p, int(k)) for p, k in above] + below

    def __repr__(self) -> str:
        if not self.powers:
            return str(self.numerator)
        below = "*".join(f"({self.field.atoms[i]})" + (f"^{k}" if k > 1 else "") for i, k in self.powers)
        return f"({self.numerator})/({below})"


def join(a: Powers, b: Powers) -> Powers:
    """The least common multiple of two denominators."""
    own = dict(a)
    return tuple(sorted((own | {i: max(k, own.get(i, 0)) for i, k in b}).items()))


def times(a: Powers, b: Powers) -> Powers:
    """The product of two denominators."""
    if not a or not b:
        return a or b
    own = dict(a)
    return tuple(sorted((own | {i: own.get(i, 0) + k for i, k in b}).items()))
