"""Isotropy at points with free symbols: the generic isotropy, and a condition under which it is valid.

The coordinates are rational functions of the symbols.  Over QQ the isotropy is the null space of a matrix of
polynomials (`PolynomialMatrix`).  Over a number field sympy's DomainMatrix computes over the field of fractions.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import reduce
from typing import final

from liehom.base.errors import FieldError, InputError, ShapeError, UndecidedError
from liehom.base.typing import Expression, ScalarLike, VectorLike
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.representations.core.representation import Representation
from liehom.exact.scalars import grammar
from liehom.exact.scalars.complex_parts import sympy_number
from liehom.exact.scalars.exact_field import ExactMatrix, as_exact
from liehom.exact.scalars.field import Matrix, MatrixLike
from liehom.exact.scalars.polynomial_matrix import PolynomialMatrix, expression_of, polynomial_matrix
from liehom.exact.scalars.rational import QQ


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
        A polynomial. At real values where it is not zero and the point is defined, the isotropy has exactly `dimension`
        and `basis` is a basis. It is `exact_dimension` times factors on whose zeros the rows of `basis` are dependent:
        often no basis is valid at all points.
    matrix : sympy.Matrix
        The matrix (N, dim g) with columns rho(e_i) point.
    exact_dimension : sympy expression
        A polynomial. At real values where it is not zero and the point is defined, the isotropy has exactly
        `dimension`.
    sharp : bool
        Whether the isotropy is larger at all real zeros of `exact_dimension` at which the point is defined. If False,
        it is one maximal minor, and the isotropy may be larger on a part of its zeros only.
    """

    algebra: LieAlgebra
    point: tuple[Expression, ...]
    symbols: tuple[Expression, ...]
    dimension: int
    orbit_dimension: int
    basis: Expression
    nonvanishing: Expression
    matrix: Expression
    exact_dimension: Expression
    sharp: bool

    def __repr__(self) -> str:
        where = "exactly where" if self.sharp else "at least where"
        return f"<isotropy of dimension {self.dimension} at {self.point}, {where} {self.exact_dimension} != 0>"

    def rank_conditions(self, limit: int = 2000) -> list[Expression]:
        """List of the minors of size `orbit_dimension`; the isotropy is larger exactly at their common zeros.

        They are not zero, squarefree, each once, and at most `limit`; [1] where the orbit dimension is 0.
        """
        import sympy

        over = polynomial_matrix(self.matrix, self.symbols)
        if over is None:
            return self._conditions_over_number_field(limit)
        minors = over.minors(limit)
        if isinstance(minors, int):
            raise InputError(f"there are {minors} minors of size {self.orbit_dimension}, more than {limit}")
        return [sympy.Mul(*(expression_of(f, self.symbols) for f in factors)) for factors in minors]

    def _conditions_over_number_field(self, limit: int) -> list[Expression]:
        from itertools import combinations, product
        from math import comb

        import sympy

        r, (nrows, ncols) = self.orbit_dimension, self.matrix.shape
        if comb(nrows, r) * comb(ncols, r) > limit:
            raise InputError(f"there are {comb(nrows, r) * comb(ncols, r)} minors of size {r}, more than {limit}")
        places = product(combinations(range(nrows), r), combinations(range(ncols), r))
        minors = (
            sympy.cancel(self.matrix.extract(*map(list, place)).det()) if r else sympy.Integer(1) for place in places
        )
        return list(dict.fromkeys(_squarefree(sympy.fraction(m)[0], self.symbols) for m in minors if m != 0))

    def at(self, values: Mapping[Expression, Expression]) -> Expression:
        """The matrix `basis` at given values of the symbols; its rows are a basis where `nonvanishing` is not 0."""
        return self.basis.subs(values)


def symbolic_isotropy(rho: Representation, point: VectorLike | MatrixLike) -> SymbolicIsotropy:
    """Implements `Representation.symbolic_isotropy`."""
    import sympy

    entries: list[Expression] = list(point)
    read = [_read(rho, entry) for entry in entries] if any(isinstance(entry, str) for entry in entries) else point
    values = _coordinates(rho, rho.real_point(read))
    symbols = tuple(sorted({s for v in values for s in v.free_symbols}, key=str))
    columns = [_times(rho, a, values) for a in rho.matrices]
    matrix = sympy.Matrix(rho.size, len(columns), lambda i, j: sympy.cancel(columns[j][i]))
    over = polynomial_matrix(matrix, symbols, _lengths(rho))
    basis, nonvanishing, exact_dimension, sharp = (
        _generic(over, symbols) if over else _generic_over_number_field(matrix, symbols)
    )
    generic = basis.rows, len(columns) - basis.rows, basis, nonvanishing, matrix, exact_dimension, sharp
    return SymbolicIsotropy(rho.algebra, tuple(values), symbols, *generic)


def _generic(
    over: PolynomialMatrix, symbols: tuple[Expression, ...]
) -> tuple[Expression, Expression, Expression, bool]:
    """Basis, condition for the basis, condition for the dimension, and whether that is sharp."""
    import sympy

    rows, dependent = over.null_space
    factors, sharp = over.rank_conditions()
    basis = sympy.Matrix(len(rows), over.shape[1], lambda i, j: expression_of(rows[i][j], symbols))
    exact_dimension = sympy.Mul(*(expression_of(p, symbols) for p in factors))
    more = [expression_of(p, symbols) for p in dependent if p not in factors]
    return basis, sympy.Mul(exact_dimension, *more), exact_dimension, sharp


def _generic_over_number_field(
    matrix: Expression, symbols: tuple[Expression, ...]
) -> tuple[Expression, Expression, Expression, bool]:
    import sympy
    from sympy.polys.matrices import DomainMatrix

    size, n = matrix.shape
    dense = DomainMatrix.from_Matrix(matrix, extension=True).to_field()
    over = dense.to_sparse() if symbols else dense
    pivots = list(over.rref()[1]) if size and n else []
    rows = list(over.transpose().rref()[1]) if size and n else []
    if len(pivots) < n:
        null = over.nullspace().to_Matrix() if size else sympy.eye(n)
        basis = sympy.Matrix([_cleared(null.row(i)) for i in range(null.rows)])
    else:
        basis = sympy.zeros(0, n)
    minor = over.domain.to_sympy(over.extract(rows, pivots).to_dense().det()) if pivots else sympy.Integer(1)
    condition = _squarefree(sympy.fraction(sympy.cancel(minor))[0], symbols)
    return basis, condition, condition, not pivots


def _lengths(rho: Representation) -> ExactMatrix | None:
    """The positive definite form tr rho(x)^T rho(y) of a faithful representation over QQ."""
    if rho.field != QQ or not rho.algebra.dimension:
        return None
    size = rho.size**2
    flat = as_exact(rho.field.stack_rows([a.reshape(1, size) for a in rho.matrices], size))
    form = flat @ flat.T
    return form if form.rank() == form.nrows else None


_NAME = re.compile(r"[A-Za-z_]\w*", re.ASCII)


def _read(rho: Representation, value: ScalarLike) -> Expression:
    """A coordinate; names in a string are symbols, except for sqrt, the generator of the field, and i on C^n."""
    import sympy

    names, on_complex = {*_NAME.findall(str(value))} - {"sqrt"}, rho.coordinates == "complex"
    if not isinstance(value, str) or ("i" in names and not on_complex):
        return value
    # the parts of a complex coordinate need real symbols
    known = {name: sympy.I if name == "i" else sympy.Symbol(name, real=on_complex or None) for name in names}
    if (generator := getattr(rho.field, "symbol", "")) in known:
        known[generator] = sympy_number(rho.field, rho.field.convert(generator))
    tree = grammar.parse(value, known)
    return grammar.evaluate(tree, lambda n: sympy.Integer(int(n)), known, {"sqrt": sympy.sqrt})


def _coordinates(rho: Representation, point: VectorLike) -> list[Expression]:
    import sympy

    if not rho.field.exact:
        raise UndecidedError(
            "isotropy at symbolic points needs an exact representation: build it over QQ or a number field, or go to "
            "exact numbers by lh.rationalize(rho, max_denominator=...)"
        )
    values: list[Expression] = list(point)
    if len(values) != rho.size:
        raise ShapeError(f"the point has {len(values)} coordinates, the representation acts on {rho.size}")
    for i, value in enumerate(values):
        if not hasattr(value, "free_symbols"):
            values[i] = value = sympy_number(rho.field, rho.field.convert(value))
        if value.has(sympy.Float):
            raise FieldError(f"coordinate {i} of the point has a float: {value}; write a fraction")
        symbols = value.free_symbols
        algebraic = all(a.is_Symbol or a.is_algebraic for a in value.atoms())
        if not algebraic or (symbols and not value.is_rational_function(*symbols)):
            raise InputError(
                f"coordinate {i}, {value}, is not a rational function of its symbols; "
                "parametrize, for example cos and sin by a rational parameter"
            )
    return values


def _times(rho: Representation, matrix: Matrix, values: list[Expression]) -> list[Expression]:
    import sympy

    return [
        sympy.Add(*(sympy_number(rho.field, c) * v for c, v in zip(row, values, strict=True) if c != rho.field.zero))
        for row in matrix.to_rows()
    ]


def _cleared(row: Expression) -> list[Expression]:
    """A multiple of a row of rational functions: polynomials without common divisor."""
    import sympy

    entries = [sympy.fraction(sympy.cancel(v)) for v in row]
    den = reduce(sympy.lcm, (d for _, d in entries), sympy.Integer(1))
    scaled = [sympy.cancel(n * den / d) for n, d in entries]
    common = reduce(sympy.gcd, scaled, sympy.Integer(0))
    return [sympy.expand(sympy.cancel(v / common)) for v in scaled]


def _squarefree(polynomial: Expression, symbols: tuple[Expression, ...]) -> Expression:
    """The product of the distinct factors that contain symbols."""
    import sympy

    if not symbols:
        return sympy.Integer(1)
    f = sympy.Poly(polynomial, *symbols, extension=True)
    if f.domain.is_QQ or f.domain.is_ZZ:
        return sympy.Mul(*(g.as_expr() for g, _ in f.factor_list()[1]))
    return f.sqf_part().as_expr()
