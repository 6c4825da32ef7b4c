"""Matrices of rational functions of parameters, with coefficients in QQ: generic ranks and where they hold.

The functions are sympy expressions, and linear algebra over their field of fractions uses sympy's DomainMatrix.
"""

from __future__ import annotations

from collections.abc import Sequence

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


def generic_rank(rows: Sequence[Sequence[Expression]], parameters: Sequence[Expression]) -> tuple[int, Expression]:
    """The rank over the field of fractions, and a polynomial such that the rank is the same wherever it is not zero.

    No value of the parameters at which the entries are defined has a larger rank. The polynomial is the squarefree
    numerator of one maximal minor, so the rank may be the same at some of its zeros.

    Examples
    --------
    >>> import sympy
    >>> a = sympy.Symbol("a")
    >>> generic_rank([[a, 1], [a**2, a], [0, a]], [a])
    (2, a)
    """
    import sympy
    from sympy.polys.matrices import DomainMatrix

    matrix = sympy.Matrix([list(row) for row in rows])
    if matrix.is_zero_matrix or 0 in matrix.shape:
        return 0, sympy.Integer(1)
    over = DomainMatrix.from_Matrix(matrix).to_field()
    columns, chosen = list(over.rref()[1]), list(over.transpose().rref()[1])
    minor = over.domain.to_sympy(over.extract(chosen, columns).to_dense().det())
    return len(columns), sympy.Mul(*factors(minor, parameters))
