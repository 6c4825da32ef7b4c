"""Polynomials on a variety: QQ[x_1, ..., x_n] modulo some polynomials, with normal forms, exactly.

An element is given by its normal form, the remainder by a Groebner basis, which is zero if and only if the element is
zero.

If the only constraint is F = r with F homogeneous and r a number, such as |m|^2 = 1, a function whose terms all have
the same degree modulo deg F equals a homogeneous polynomial (multiply by powers of F/r), which can be factorized and
cancelled. Division of p by a sum a of an even and an odd function on a quadric is division of p a(-x) by a a(-x), which
is even.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations_with_replacement, product
from math import comb, prod
from typing import Any, final

import flint

from liehom.errors import FieldError
from liehom.scalars.fields.rational import QQ
from liehom.typing import ScalarLike

# a divisor of more terms is not factorized, and no shorter form of it is sought
MAX_TERMS_TO_FACTOR = 3000
# with several constraints, a quotient is sought among polynomials with at most this number of coefficients
MAX_UNKNOWNS = 500


@final
class CoordinateRing:
    """The ring QQ[names] / (constraints) of polynomial functions on a variety.

    Parameters
    ----------
    names : sequence of str
    constraints : sequence of mappings from exponents (tuples) to rational numbers
        Polynomials that vanish.
    graded : sequence of str
        The variables with degree 1 in the grading (the others have degree 0).

    Attributes
    ----------
    context : flint.fmpq_mpoly_ctx
        The polynomial ring QQ[names].
    basis : list of flint.fmpq_mpoly
        A Groebner basis of the constraints.

    Raises
    ------
    FieldError
        If the constraints contradict each other.

    Examples
    --------
    >>> circle = CoordinateRing(["x", "y"], [{(2, 0): 1, (0, 2): 1, (0, 0): -1}], ["x", "y"])
    >>> circle.reduce(circle.polynomial({(2, 0): 1}))
    -y^2 + 1
    """

    __slots__ = ("_form", "basis", "context", "names", "weights")

    def __init__(
        self,
        names: Sequence[str],
        constraints: Iterable[Mapping[tuple[int, ...], ScalarLike]] = (),
        graded: Sequence[str] = (),
    ) -> None:
        self.names: tuple[str, ...] = tuple(names)
        self.context: flint.fmpq_mpoly_ctx = flint.fmpq_mpoly_ctx.get(self.names, flint.Ordering.degrevlex)
        given = [self.polynomial(c) for c in constraints]
        given = [c for c in given if not c.is_zero()]
        self.basis: list[flint.fmpq_mpoly] = given if len(given) < 2 else self._groebner(given)
        if any(c.is_constant() for c in self.basis):
            raise FieldError("the constraints contradict each other: they have no common zero")
        self.weights: list[int] = [int(name in graded) for name in self.names]
        self._form = self._homogeneous_form(given)

    def polynomial(self, terms: Mapping[tuple[int, ...], ScalarLike]) -> flint.fmpq_mpoly:
        """The polynomial with these terms, a ``flint.fmpq_mpoly``."""
        return self.context.from_dict({e: QQ.convert(c) for e, c in terms.items()})

    def reduce(self, p: flint.fmpq_mpoly) -> flint.fmpq_mpoly:
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

    def _groebner(self, given: list[flint.fmpq_mpoly]) -> list[flint.fmpq_mpoly]:
        import sympy

        symbols = sympy.symbols([f"x{i}" for i in range(len(self.names))])
        polys = [
            sympy.Poly.from_dict({e: sympy.Rational(int(c.p), int(c.q)) for e, c in p.terms()}, *symbols) for p in given
        ]
        found = sympy.groebner(polys, *symbols, order="grevlex")
        return [self.polynomial(dict(p.terms())) for p in found.polys]

    # -- the grading -------------------------------------------------------------------------------------
    def _homogeneous_form(self, given: list[flint.fmpq_mpoly]) -> tuple[flint.fmpq_mpoly, int] | None:
        """F/r and its degree if the only constraint is F - r, else None."""
        if len(given) != 1:
            return None
        parts = self._parts(given[0])
        degrees = sorted(parts)
        if len(degrees) != 2 or degrees[0] != 0 or not parts[0].is_constant():
            return None
        constant = parts[0].leading_coefficient()
        return parts[degrees[1]] / -constant, degrees[1]

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
        top = max(parts)
        made = self.context.constant(0)
        for degree, part in parts.items():
            made += part * form ** ((top - degree) // e)
        return self._without_form(made)

    def _without_form(self, p: flint.fmpq_mpoly) -> flint.fmpq_mpoly:
        form = self._form[0] if self._form is not None else None
        while form is not None and not p.is_zero():
            quotient, rest = divmod(p, form)
            if not rest.is_zero():
                break
            p = quotient
        return p

    def divide(self, p: flint.fmpq_mpoly, q: flint.fmpq_mpoly) -> flint.fmpq_mpoly | None:
        """The polynomial p/q in normal form, or None if no quotient on the variety is found.

        Examples
        --------
        >>> circle = CoordinateRing(["x", "y"], [{(2, 0): 1, (0, 2): 1, (0, 0): -1}], ["x", "y"])
        >>> x, y = circle.context.gens()
        >>> p = circle.reduce((1 + x) * (x * y + y**2 + x))
        >>> circle.divide(p, 1 + x), circle.divide(p, 2 + x)
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
            total = self.context.constant(0)
            for i in range(rank):
                j = next(j for j in range(len(candidates)) if reduced[i, j] != 0)
                total += candidates[j] * reduced[i, len(candidates)]
            return self.reduce(total)
        return None

    def _divide_parts(self, p: flint.fmpq_mpoly, divisor: flint.fmpq_mpoly) -> flint.fmpq_mpoly | None:
        """Quotient by a homogeneous polynomial, one class of degrees after another; None if it is not exact."""
        e = self._form[1] if self._form is not None else 1
        classes: dict[int, flint.fmpq_mpoly] = {}
        for degree, part in self._parts(p).items():
            classes[degree % e] = classes.get(degree % e, self.context.constant(0)) + part
        total = self.context.constant(0)
        for part in classes.values():
            lifted = self.homogeneous(part)
            if lifted is None:
                return None
            quotient, rest = divmod(lifted, divisor)
            if not rest.is_zero():
                return None
            total += quotient
        return self.reduce(total)

    def shortest(self, p: flint.fmpq_mpoly) -> flint.fmpq_mpoly:
        """A polynomial with few terms that equals p on the variety, possibly p itself.

        Examples
        --------
        >>> circle = CoordinateRing(["x", "y"], [{(2, 0): 1, (0, 2): 1, (0, 0): -1}], ["x", "y"])
        >>> circle.shortest(circle.polynomial({(2, 0): 3, (0, 2): 2}))
        x^2 + 2
        """
        found = [p]
        for name in self.names if self._form is not None and len(p) <= MAX_TERMS_TO_FACTOR else ():
            order = (name, *(other for other in self.names if other != name))
            ring = flint.fmpq_mpoly_ctx.get(order, flint.Ordering.lex)
            divisor = self.basis[0].project_to_context(ring)
            rest = divmod(p.project_to_context(ring), divisor)[1]
            found.append(rest.project_to_context(self.context))
        return min(found, key=lambda q: (len(q), len(str(q))))

    def graded_weights(self, polynomials: Iterable[flint.fmpq_mpoly], optional: Sequence[str]) -> list[str]:
        """The optional variables that need degree 1 for all polynomials to be graded; [] if no choice serves.

        Examples
        --------
        >>> circle = CoordinateRing(["x", "y", "a"], [{(2, 0, 0): 1, (0, 2, 0): 1, (0, 0, 0): -1}], ["x", "y"])
        >>> x, y, a = circle.context.gens()
        >>> circle.graded_weights([x + a, y], ["a"])
        ['a']
        """
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
    degrees = {sum(int(k) for k, w in zip(m, weights, strict=True) if w) % e for m in p.monoms()}
    return len(degrees) <= 1
