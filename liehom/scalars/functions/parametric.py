"""Matrices of rational functions of parameters, with coefficients in QQ, from and to sympy: generic ranks.

A matrix of sympy expressions becomes a `PolynomialMatrix` times its common denominator.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from liehom.scalars.fields.exact_field import ExactMatrix
from liehom.scalars.functions.polynomial_matrix import Poly, PolynomialMatrix
from liehom.typing import Expression


def factors(expression: Expression, parameters: Sequence[Expression]) -> list[Expression]:
    """The distinct irreducible factors, over QQ, of the numerator of a rational function, without constants.

    Examples
    --------
    >>> import sympy
    >>> a, b = sympy.symbols("a b")
    >>> factors((a**3 - a * b**2) / (b + 1), [a, b])
    [a, a + b, a - b]
    """
    import sympy

    numerator = sympy.fraction(sympy.cancel(expression))[0]
    if not numerator.free_symbols:
        return []
    found = (f.as_expr() for f, _ in sympy.Poly(numerator, *parameters, domain="QQ").factor_list()[1])
    return sorted(found, key=str)


def generic_rank(
    rows: Sequence[Sequence[Expression]], parameters: Sequence[Expression]
) -> tuple[int, list[Expression], bool]:
    """The rank over the field of fractions, conditions under which it is the rank, and whether they are sharp.

    The rank is the same wherever no condition is zero, and no value of the parameters at which the entries are defined
    has a larger rank. Sharp conditions: at real zeros of one of them the rank is smaller.

    Examples
    --------
    >>> import sympy
    >>> a = sympy.Symbol("a")
    >>> generic_rank([[a, 1], [a**2, a], [0, a]], [a])
    (2, [a], True)
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
    den = sympy.Integer(1)
    for _, d in entries:
        den = sympy.lcm(den, d)
    generators = symbols or (sympy.Dummy(),)
    terms = []
    for n, d in entries:
        made = sympy.Poly(n * sympy.cancel(den / d), *generators)
        if not (made.domain.is_ZZ or made.domain.is_QQ):
            return None
        terms.append({e: Fraction(int(c.p), int(c.q)) for e, c in made.terms() if c})
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
