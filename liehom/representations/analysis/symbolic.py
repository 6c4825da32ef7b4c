"""Isotropy at points with free symbols: the generic isotropy, and a condition under which it is valid.

The coordinates are rational functions of the symbols.  Over QQ the isotropy is the null space of a matrix of
polynomials (`PolynomialMatrix`).  Over a number field sympy's DomainMatrix computes over the field of fractions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, final

from liehom.algebra import LieAlgebra
from liehom.errors import FieldError, InputError, ShapeError, UndecidedError
from liehom.representations.core.representation import Representation
from liehom.scalars import QQ, ExactMatrix, Matrix, as_exact
from liehom.scalars.fields.sympy_number import sympy_number
from liehom.scalars.functions.parametric import expression_of, polynomial_matrix
from liehom.scalars.functions.polynomial_matrix import PolynomialMatrix
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

    def __setstate__(self, state: Sequence[Any]) -> None:
        # the condition of 0.1.0 was one maximal minor
        for name, value in zip(self.__dataclass_fields__, [*state, state[6], False], strict=False):
            object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        where = "exactly where" if self.sharp else "at least where"
        return f"<isotropy of dimension {self.dimension} at {self.point}, {where} {self.exact_dimension} != 0>"

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
    over = polynomial_matrix(matrix, symbols, _lengths(rho))
    found = _generic(over, symbols) if over else _generic_over_number_field(matrix, symbols)
    basis, nonvanishing, exact_dimension, sharp = found
    n, dimension = len(columns), basis.rows
    return SymbolicIsotropy(
        algebra=rho.algebra,
        point=tuple(values),
        symbols=symbols,
        dimension=dimension,
        orbit_dimension=n - dimension,
        basis=basis,
        nonvanishing=nonvanishing,
        matrix=matrix,
        exact_dimension=exact_dimension,
        sharp=sharp,
    )


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

    size, n = matrix.shape
    over = _over_fractions(matrix, symbols)
    pivots = list(over.rref()[1]) if size and n else []
    rows = list(over.transpose().rref()[1]) if size and n else []
    if len(pivots) < n:
        null = over.nullspace().to_Matrix() if size else sympy.eye(n)
        basis = sympy.Matrix([_cleared(null.row(i), symbols) for i in range(null.rows)])
    else:
        basis = sympy.zeros(0, n)
    minor = over.domain.to_sympy(over.extract(rows, pivots).to_dense().det()) if pivots else sympy.Integer(1)
    numerator = sympy.fraction(sympy.cancel(minor))[0]
    condition = _squarefree(numerator, symbols)
    return basis, condition, condition, not pivots


def _lengths(rho: Representation) -> ExactMatrix | None:
    """The positive definite form tr rho(x)^T rho(y) of a faithful representation over QQ."""
    if rho.field != QQ or not rho.algebra.dimension:
        return None
    size = rho.size**2
    flat = as_exact(rho.field.stack_rows([a.reshape(1, size) for a in rho.matrices], size))
    form = flat @ flat.T
    return form if form.rank() == form.nrows else None


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
            made = sympy_number(rho.field, rho.field.convert(value))
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


def _times(rho: Representation, matrix: Matrix, values: list[Expression]) -> list[Expression]:
    import sympy

    zero = rho.field.zero
    rows = matrix.to_rows()
    return [
        sympy.Add(*(sympy_number(rho.field, c) * v for c, v in zip(row, values, strict=True) if c != zero))
        for row in rows
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
