"""Isotropy at points with free symbols: the generic isotropy, and a condition under which it is valid.

The coordinates are rational functions of the symbols.  Linear algebra over their field of fractions uses sympy's
DomainMatrix.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, final

from liehom.algebra import LieAlgebra
from liehom.errors import FieldError, InputError, ShapeError, UndecidedError
from liehom.representations.core.representation import Representation
from liehom.scalars import QQ, Field, Matrix, NumberField, Scalar
from liehom.typing import Expression, VectorLike


@final
@dataclass(frozen=True, slots=True, repr=False)
class SymbolicIsotropy:
    """The isotropy at a generic point of a family.

    Attributes
    ----------
    algebra : LieAlgebra
    point : tuple of sympy expressions
    symbols : tuple of sympy symbols
    dimension : int
        Dimension of the isotropy for generic (algebraically independent) symbols.
    orbit_dimension : int
        dim g - dimension: the generic rank of x -> rho(x) point, which no value of the symbols exceeds.
    basis : sympy.Matrix
        Rows (dimension, dim g) of coefficients, polynomials in the symbols without common divisor. Every row lies in
        the isotropy at all values of the symbols at which the point is defined.
    nonvanishing : sympy expression
        A polynomial. At values where it is not zero and the point is defined, the isotropy has exactly `dimension` and
        `basis` is a basis. It is one maximal minor, so not all of its zeros need be exceptional.
    matrix : sympy.Matrix
        The matrix (N, dim g) with columns rho(e_i) point.
    """

    algebra: LieAlgebra
    point: tuple[Expression, ...]
    symbols: tuple[Expression, ...]
    dimension: int
    orbit_dimension: int
    basis: Expression
    nonvanishing: Expression
    matrix: Expression

    def __repr__(self) -> str:
        return f"<isotropy of dimension {self.dimension} at {self.point}, where {self.nonvanishing} != 0>"

    def rank_conditions(self, limit: int = 2000) -> list[Expression]:
        """List of the minors of size `orbit_dimension`; the isotropy is larger exactly at their common zeros.

        Parameters
        ----------
        limit : int
            Largest admissible number of minors.

        Returns
        -------
        list of sympy expressions
            Non-zero, squarefree, each once; [1] where the orbit dimension is 0.

        Raises
        ------
        InputError
            If there are more than `limit` minors.
        """
        from itertools import combinations, product
        from math import comb

        import sympy

        r, (nrows, ncols) = self.orbit_dimension, self.matrix.shape
        if comb(nrows, r) * comb(ncols, r) > limit:
            raise InputError(f"there are {comb(nrows, r) * comb(ncols, r)} minors of size {r}, more than {limit}")
        found: dict[Any, None] = {}
        for rows, columns in product(combinations(range(nrows), r), combinations(range(ncols), r)):
            minor = sympy.cancel(self.matrix.extract(list(rows), list(columns)).det()) if r else sympy.Integer(1)
            if minor != 0:
                found[_squarefree(sympy.fraction(minor)[0], self.symbols)] = None
        return list(found)

    def at(self, values: Mapping[Expression, Expression]) -> Expression:
        """The matrix `basis` at given values of the symbols; its rows are a basis where `nonvanishing` is not 0."""
        return self.basis.subs(values)


def symbolic_isotropy(rho: Representation, point: VectorLike) -> SymbolicIsotropy:
    """Implements `Representation.symbolic_isotropy`."""
    import sympy

    values = _coordinates(rho, point)
    symbols = tuple(sorted({s for v in values for s in v.free_symbols}, key=str))
    columns = [_times(rho, a, values) for a in rho.matrices]
    matrix = sympy.Matrix(rho.size, len(columns), lambda i, j: sympy.cancel(columns[j][i]))
    over = _over_fractions(matrix, symbols)
    n = len(columns)
    pivots = list(over.rref()[1]) if rho.size and n else []
    rows = list(over.transpose().rref()[1]) if rho.size and n else []
    if len(pivots) < n:
        null = over.nullspace().to_Matrix() if rho.size else sympy.eye(n)
        basis = sympy.Matrix([_cleared(null.row(i), symbols) for i in range(null.rows)])
    else:
        basis = sympy.zeros(0, n)
    minor = over.domain.to_sympy(over.extract(rows, pivots).to_dense().det()) if pivots else sympy.Integer(1)
    numerator = sympy.fraction(sympy.cancel(minor))[0]
    return SymbolicIsotropy(
        rho.algebra,
        tuple(values),
        symbols,
        n - len(pivots),
        len(pivots),
        basis,
        _squarefree(numerator, symbols),
        matrix,
    )


def _coordinates(rho: Representation, point: VectorLike) -> list[Expression]:
    import sympy

    if not rho.field.exact:
        raise UndecidedError(
            "isotropy at symbolic points needs an exact representation: build it over QQ or a number field, or go to "
            "exact numbers by lh.rationalize(rho, max_denominator=...)"
        )
    given = list(point)
    if len(given) != rho.size:
        raise ShapeError(f"the point has {len(given)} coordinates, the representation acts on {rho.size}")
    values = []
    for i, value in enumerate(given):
        if hasattr(value, "free_symbols"):
            made = value
        else:
            made = _number(rho.field.convert(value), rho.field)
        if made.has(sympy.Float):
            raise FieldError(f"coordinate {i} of the point has a float: {made}; write a fraction")
        symbols = made.free_symbols
        algebraic = all(a.is_Symbol or a.is_algebraic for a in made.atoms())
        if not algebraic or (symbols and not made.is_rational_function(*symbols)):
            raise InputError(
                f"coordinate {i}, {made}, is not a rational function of its symbols; "
                "parametrize, for example cos and sin by a rational parameter"
            )
        values.append(made)
    return values


def _number(value: Scalar, field: Field) -> Expression:
    """A field element as a sympy number."""
    import sympy

    if not isinstance(field, NumberField):
        rational = QQ.convert(value)
        return sympy.Rational(int(rational.p), int(rational.q))
    if field.symbol.startswith("sqrt("):
        root = sympy.sqrt(int(field.symbol[5:-1]))
    else:
        x = sympy.Dummy("x")
        root = sympy.CRootOf(sympy.Poly(list(field.minpoly)[::-1], x), field.root_index)
    integral = field.leading * root
    terms = [sympy.Rational(int(c.p), int(c.q)) * integral**k for k, c in enumerate(field.coordinates(value))]
    return sympy.Add(*terms)


def _times(rho: Representation, matrix: Matrix, values: list[Expression]) -> list[Expression]:
    import sympy

    zero = rho.field.zero
    rows = matrix.to_rows()
    return [
        sympy.Add(*(_number(c, rho.field) * v for c, v in zip(row, values, strict=True) if c != zero)) for row in rows
    ]


def _over_fractions(matrix: Expression, symbols: tuple[Expression, ...]) -> Any:
    from sympy.polys.matrices import DomainMatrix

    made = DomainMatrix.from_Matrix(matrix, extension=True)
    return made.to_field().to_sparse() if symbols else made.to_field()


def _cleared(row: Expression, symbols: tuple[Expression, ...]) -> list[Expression]:
    """A multiple of a row of rational functions: polynomials without common divisor."""
    import sympy

    entries = [sympy.fraction(sympy.cancel(v)) for v in row]
    den = sympy.Integer(1)
    for _, d in entries:
        den = sympy.lcm(den, d)
    scaled = [sympy.cancel(n * den / d) for n, d in entries]
    common = sympy.Integer(0)
    for v in scaled:
        common = sympy.gcd(common, v)
    return [sympy.expand(sympy.cancel(v / common)) for v in scaled]


def _squarefree(polynomial: Expression, symbols: tuple[Expression, ...]) -> Expression:
    """The product of the distinct factors that contain symbols."""
    import sympy

    if not symbols:
        return sympy.Integer(1)
    made = sympy.Poly(polynomial, *symbols, extension=True)
    if made.domain.is_QQ or made.domain.is_ZZ:
        return sympy.Mul(*(f.as_expr() for f, _ in made.factor_list()[1]))
    return made.sqf_part().as_expr()
