"""Rational functions on a variety: the field of fractions of QQ[x_1, ..., x_n] modulo some polynomials, exactly.

An element is numerator / denominator. The numerator is a normal form modulo the constraints (remainder by a Groebner
basis), so that an element is zero exactly if its numerator is; the denominator is a product of powers of known
polynomials ("atoms"), so that fractions with denominators such as |X|^2, |X|^4 are added without a gcd.

Where the only constraint is F = r with F homogeneous and r a number, as |m|^2 = 1, a function whose terms all have
one degree modulo deg F is one homogeneous polynomial (multiply by powers of F/r): these are factorised and cancelled.
Division by a sum a of an even and an odd function on a quadric is division of p a(-x) by a a(-x), which is even.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations_with_replacement, product
from math import comb, prod
from typing import Any, final

import flint

from liehom.errors import FieldError, SingularError
from liehom.scalars.fields.rational import rational_number
from liehom.scalars.functions.rational_function import Powers as Powers
from liehom.scalars.functions.rational_function import RationalFunction as RationalFunction
from liehom.scalars.functions.rational_function import join

# a divisor of more terms is taken as it is, without a search for its factors
MAX_TERMS_TO_FACTOR = 3000
# with several constraints, a quotient is looked for among polynomials of so many coefficients
MAX_UNKNOWNS = 500


@final
class FunctionField:
    """The field of fractions of QQ[names] / (constraints); the constraints should generate a prime ideal.

    Parameters
    ----------
    names : sequence of str
    constraints : sequence of mappings from exponents (tuples) to rational numbers
        Polynomials that vanish.
    graded : sequence of str
        The variables with degree 1 in the grading (the others have degree 0).

    Raises
    ------
    FieldError
        If the constraints contradict each other.

    Notes
    -----
    Equality in the ring is proved, whatever the ideal: an element is 0 if its numerator is in the ideal. Only
    division asks for a prime ideal (a divisor of zero must not be a denominator).

    Examples
    --------
    >>> circle = FunctionField(["x", "y"], [{(2, 0): 1, (0, 2): 1, (0, 0): -1}], ["x", "y"])
    >>> x, y = circle.variables
    >>> x**2 + y**2 == 1, (1 - x**2) / y == y
    (True, True)
    >>> ((1 - x**4) / y**2).cancelled()
    -y^2 + 2
    """

    def __init__(
        self,
        names: Sequence[str],
        constraints: Iterable[Mapping[tuple[int, ...], Any]] = (),
        graded: Sequence[str] = (),
    ) -> None:
        self.names = tuple(names)
        self.ring = flint.fmpq_mpoly_ctx.get(self.names, flint.Ordering.degrevlex)
        given = [self.polynomial(c) for c in constraints]
        given = [c for c in given if not c.is_zero()]
        self.basis = given if len(given) < 2 else self._groebner(given)
        if any(c.is_constant() for c in self.basis):
            raise FieldError("the constraints contradict each other: they have no common zero")
        self.weights = [int(name in graded) for name in self.names]
        self._form = self._homogeneous_form(given)
        self.atoms: list[Any] = []
        self._reduced: list[Any] = []
        self.zero = RationalFunction(self, self.ring.constant(0), ())
        self.one = RationalFunction(self, self.ring.constant(1), ())
        self.variables = tuple(RationalFunction(self, self.reduce(g), ()) for g in self.ring.gens())

    # -- polynomials -------------------------------------------------------------------------------------
    def polynomial(self, terms: Mapping[tuple[int, ...], Any]) -> Any:
        """The polynomial with these terms."""
        return self.ring.from_dict({e: rational_number(c) for e, c in terms.items()})

    def reduce(self, p: Any) -> Any:
        """The normal form of a polynomial modulo the constraints."""
        if len(self.basis) == 1:
            return divmod(p, self.basis[0])[1]
        changed = bool(self.basis)
        while changed:
            changed = False
            for g in self.basis:
                quotient, p = divmod(p, g)
                changed = changed or not quotient.is_zero()
        return p

    def _groebner(self, given: list[Any]) -> list[Any]:
        import sympy

        symbols = sympy.symbols([f"x{i}" for i in range(len(self.names))])
        polys = [
            sympy.Poly.from_dict({e: sympy.Rational(int(c.p), int(c.q)) for e, c in p.terms()}, *symbols) for p in given
        ]
        found = sympy.groebner(polys, *symbols, order="grevlex")
        return [self.polynomial(dict(p.terms())) for p in found.polys]

    # -- the grading -------------------------------------------------------------------------------------
    def _homogeneous_form(self, given: list[Any]) -> tuple[Any, int] | None:
        """F/r and its degree if the only constraint is F - r."""
        if len(given) != 1:
            return None
        parts = self._parts(given[0])
        degrees = sorted(parts)
        if len(degrees) != 2 or degrees[0] != 0 or not parts[0].is_constant():
            return None
        constant = parts[0].leading_coefficient()
        return parts[degrees[1]] / -constant, degrees[1]

    def _parts(self, p: Any) -> dict[int, Any]:
        """The homogeneous parts of a polynomial by degree."""
        terms: dict[int, dict[Any, Any]] = {}
        for e, c in p.terms():
            degree = sum(int(k) for k, w in zip(e, self.weights, strict=True) if w)
            terms.setdefault(degree, {})[e] = c
        return {degree: self.ring.from_dict(part) for degree, part in terms.items()}

    def homogeneous(self, p: Any) -> Any:
        """The homogeneous polynomial that equals p on the variety, not divisible by F; None if there is none."""
        if self._form is None:
            return None if self.basis else p
        form, e = self._form
        parts = self._parts(p)
        if not parts or len({degree % e for degree in parts}) > 1:
            return None
        top = max(parts)
        made = self.ring.constant(0)
        for degree, part in parts.items():
            made += part * form ** ((top - degree) // e)
        return self._without_form(made)

    def _without_form(self, p: Any) -> Any:
        form = self._form[0] if self._form is not None else None
        while form is not None and not p.is_zero():
            quotient, rest = divmod(p, form)
            if not rest.is_zero():
                break
            p = quotient
        return p

    def divide(self, p: Any, q: Any) -> Any:
        """The polynomial p/q in normal form, or None if q is not seen to divide p on the variety.

        Examples
        --------
        >>> circle = FunctionField(["x", "y"], [{(2, 0): 1, (0, 2): 1, (0, 0): -1}], ["x", "y"])
        >>> x, y = circle.variables
        >>> p = ((1 + x) * (x * y + y**2 + x)).numerator
        >>> circle.divide(p, (1 + x).numerator), circle.divide(p, (2 + x).numerator)
        (x*y + y^2 + x, None)
        """
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
        mirrored = sum(((-1) ** degree * part for degree, part in self._parts(q).items()), self.ring.constant(0))
        even = self.homogeneous(self.reduce(q * mirrored))
        return None if even is None else self._divide_parts(self.reduce(p * mirrored), even)

    def _divide_by_ansatz(self, p: Any, q: Any) -> Any:
        """A quotient of low degree by linear algebra: normal forms of degree have no unique factors."""
        least = max(0, int(p.total_degree()) - int(q.total_degree()))
        for degree in (least, least + 1):
            used = [i for i, d in enumerate(p.degrees()) if d]
            count = comb(len(used) + degree, degree)
            if count > MAX_UNKNOWNS:
                return None
            gens = [self.ring.constant(1), *(self.ring.gens()[i] for i in used)]
            monomials = [prod(chosen, start=gens[0]) for chosen in combinations_with_replacement(gens, degree)]
            kept = {str(m): m for m in map(self.reduce, monomials) if len(m) == 1}
            candidates = list(kept.values())
            products = [dict(self.reduce(m * q).terms()) for m in candidates]
            right = dict(p.terms())
            rows = sorted({e for x in (*products, right) for e in x})
            if len(right.keys() - {e for x in products for e in x}):
                continue
            left = flint.fmpq_mat(len(rows), len(candidates), [x.get(e, 0) for e in rows for x in products])
            both = flint.fmpq_mat(
                len(rows), len(candidates) + 1, [x.get(e, 0) for e in rows for x in (*products, right)]
            )
            reduced, rank = both.rref()
            if rank > left.rank():
                continue
            total = self.ring.constant(0)
            for i in range(rank):
                j = next(j for j in range(len(candidates)) if reduced[i, j] != 0)
                total += candidates[j] * reduced[i, len(candidates)]
            return self.reduce(total)
        return None

    def _divide_parts(self, p: Any, divisor: Any) -> Any:
        """Division by a homogeneous polynomial, separately for each class of degrees."""
        e = self._form[1] if self._form is not None else 1
        classes: dict[int, Any] = {}
        for degree, part in self._parts(p).items():
            classes[degree % e] = classes.get(degree % e, self.ring.constant(0)) + part
        total = self.ring.constant(0)
        for part in classes.values():
            quotient, rest = divmod(self.homogeneous(part), divisor)
            if not rest.is_zero():
                return None
            total += quotient
        return self.reduce(total)

    def shortest(self, p: Any) -> Any:
        """Of the polynomials that equal p on the variety and are seen, one with few terms; p if it is as short.

        Examples
        --------
        >>> circle = FunctionField(["x", "y"], [{(2, 0): 1, (0, 2): 1, (0, 0): -1}], ["x", "y"])
        >>> circle.shortest(circle.polynomial({(2, 0): 3, (0, 2): 2}))
        x^2 + 2
        """
        found = [p]
        for name in self.names if self._form is not None and len(p) <= MAX_TERMS_TO_FACTOR else ():
            order = (name, *(other for other in self.names if other != name))
            ring = flint.fmpq_mpoly_ctx.get(order, flint.Ordering.lex)
            divisor = self.basis[0].project_to_context(ring)
            rest = divmod(p.project_to_context(ring), divisor)[1]
            found.append(rest.project_to_context(self.ring))
        return min(found, key=lambda q: (len(q), len(str(q))))

    # -- denominators ------------------------------------------------------------------------------------
    def atom(self, p: Any) -> int:
        """The number of the atom p, which is made one if it is not yet."""
        for i, known in enumerate(self.atoms):
            if known == p:
                return i
        self.atoms.append(p)
        self._reduced.append(self.reduce(p))
        return len(self.atoms) - 1

    def reduced_atom(self, i: int) -> Any:
        """Atom i in normal form."""
        return self._reduced[i]

    def denominator(self, powers: Powers) -> Any:
        """The product of atoms as a polynomial, in normal form."""
        made = self.ring.constant(1)
        for i, k in powers:
            for _ in range(k):
                made = self.reduce(made * self._reduced[i])
        return made

    def inverse(self, p: Any) -> RationalFunction:
        """1 / p for a polynomial that is not zero on the variety."""
        if p.is_zero():
            raise SingularError("division by a function that is zero")
        lifted = self.homogeneous(p)
        powers: dict[int, int] = {}
        if lifted is None:
            for i in range(len(self.atoms)):
                while (quotient := self.divide(p, self._reduced[i])) is not None:
                    p, powers[i] = quotient, powers.get(i, 0) + 1
        source = p if lifted is None else lifted
        content, factors = source.leading_coefficient(), [(source / source.leading_coefficient(), 1)]
        if len(source) <= MAX_TERMS_TO_FACTOR:
            content, factors = source.factor()
        for factor, k in factors:
            if not factor.is_constant():
                i = self.atom(factor)
                powers[i] = powers.get(i, 0) + int(k)
        return RationalFunction(self, self.ring.constant(1) / content, tuple(sorted(powers.items())))

    def primitive(self, vector: Sequence[RationalFunction]) -> list[RationalFunction]:
        """The vector times a function, so that it has no denominators and no common divisor that is seen.

        The leading coefficient of the first component that is not zero is positive.
        """
        common: Powers = ()
        for x in vector:
            common = join(common, x.powers)
        tops = [x.over(common) for x in vector]
        lifted = [None if p.is_zero() else self.homogeneous(p) for p in tops]
        known = [p if q is None else q for p, q in zip(tops, lifted, strict=True)]
        divisor = self.ring.constant(0)
        for p in known:
            divisor = p if divisor.is_zero() else divisor.gcd(p) if not p.is_zero() else divisor
        if divisor.is_zero():
            return [self.zero for _ in vector]
        known = [divmod(p, divisor)[0] for p in known]
        first = next(p for p in known if not p.is_zero())
        scale = _content(known) * (1 if first.leading_coefficient() > 0 else -1)
        return [RationalFunction(self, self.reduce(p / scale), ()) for p in known]

    # -- numbers -----------------------------------------------------------------------------------------
    def convert(self, value: Any) -> RationalFunction:
        """A rational number, or an element, as an element.

        Raises
        ------
        FieldError
            If it is neither.
        """
        if isinstance(value, RationalFunction):
            return value
        number = rational_number(value)
        if number is None:
            raise FieldError(f"{value!r} is not a rational number: write a fraction, or a symbol for it")
        return RationalFunction(self, self.ring.constant(number), ())

    def graded_weights(self, elements: Iterable[RationalFunction], optional: Sequence[str]) -> list[str]:
        """Which of the optional variables have to count with degree 1 for all elements to be graded; [] if none serve.

        Examples
        --------
        >>> circle = FunctionField(["x", "y", "a"], [{(2, 0, 0): 1, (0, 2, 0): 1, (0, 0, 0): -1}], ["x", "y"])
        >>> x, y, a = circle.variables
        >>> circle.graded_weights([x + a, y], ["a"])
        ['a']
        """
        if self._form is None:
            return []
        e = self._form[1]
        chosen = list(elements)
        for bits in product((0, 1), repeat=min(len(optional), 10)):
            extra = [name for name, bit in zip(optional, bits, strict=False) if bit]
            weights = [w or int(name in extra) for w, name in zip(self.weights, self.names, strict=True)]
            if all(_one_degree(x.numerator, weights, e) for x in chosen):
                return extra
        return []


def _content(polynomials: Sequence[Any]) -> Any:
    """The positive rational number by which integer coefficients without common divisor are left."""
    numbers = [c for p in polynomials for c in p.coeffs()]
    top, bottom = flint.fmpz(0), flint.fmpz(1)
    for c in numbers:
        top, bottom = top.gcd(c.p), bottom.lcm(c.q)
    return flint.fmpq(top, bottom)


def _one_degree(p: Any, weights: list[int], e: int) -> bool:
    degrees = {sum(int(k) for k, w in zip(m, weights, strict=True) if w) % e for m in p.monoms()}
    return len(degrees) <= 1
