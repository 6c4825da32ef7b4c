"""Lie algebras whose structure constants are rational functions of parameters."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import comb
from typing import Any, NoReturn, SupportsInt, final

import numpy as np

from liehom.base.errors import (
    FieldError,
    InputError,
    JacobiError,
    ParseError,
    ShapeError,
    StructureError,
    UndecidedError,
)
from liehom.base.objects import Displayed, Immutable
from liehom.base.typing import Expression, ScalarLike
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.tables import ConstantsLike, by_index, field_of_values, is_named
from liehom.exact.scalars import grammar
from liehom.exact.scalars.field import Field, Scalar
from liehom.exact.scalars.polynomial_matrix import factors, generic_rank
from liehom.exact.scalars.rational import QQ

# Structure constants that are rational functions of parameters, from mappings and arrays of symbols and strings.

MAX_TERMS = 10_000
"""Terms that a polynomial of the degree and the number of parameters of a structure constant may have."""
Brackets = dict[tuple[int, int], dict[int, Expression]]


class Parameters:
    """The parameters of a family, and the reader of its values."""

    def __init__(self, constants: Mapping[Any, Any], parameters: Sequence[str | Expression] | None) -> None:
        import sympy

        rows = [row for row in constants.values() if isinstance(row, Mapping)]
        free = {s for row in rows for v in row.values() for s in getattr(v, "free_symbols", ())}
        by_name = {str(s): s for s in free}
        if len(by_name) < len(free):
            raise InputError("two symbols of one name, with other assumptions, are two parameters; use one of them")
        wanted = sorted(by_name) if parameters is None else list(map(str, parameters))
        if missing := sorted(set(by_name) - set(wanted)):
            raise InputError(f"the constants have the symbols {', '.join(missing)}, which are not parameters")
        self.chosen = tuple(by_name.get(name, sympy.Symbol(name)) for name in wanted)
        self.names = dict(zip(wanted, self.chosen, strict=True))

    def read(self, value: ScalarLike | Expression, where: str) -> Expression:
        """The rational function that a value denotes, cancelled."""
        import sympy

        if isinstance(value, str):
            try:
                function = grammar.evaluate(grammar.parse(value, self.names, ()), _integer, self.names, {})
            except ParseError as error:
                raise ParseError(f"{where}: {error}") from None
        elif hasattr(value, "free_symbols"):
            function = value
        else:
            rational = QQ.convert(value)
            function = sympy.Rational(int(rational.p), int(rational.q))
        exact = all(x.is_Symbol or x.is_Rational for x in function.atoms())
        exact = exact and all(power.exp.is_Integer for power in function.atoms(sympy.Pow))
        if not exact or (function.free_symbols and not function.is_rational_function(*function.free_symbols)):
            raise FieldError(f"{where} is {function}, expected a rational function with rational coefficients")
        degree = _degree(function)
        terms = comb(degree + len(self.chosen), len(self.chosen))
        if terms > MAX_TERMS:
            raise InputError(f"{where} is of degree {degree}: up to {terms} terms, at most {MAX_TERMS} are handled")
        return sympy.cancel(function)


def _degree(expression: Expression) -> int:
    """An upper bound for the degree of numerator and denominator of a rational function."""
    import sympy

    if expression.is_Symbol:
        return 1
    if expression.is_Pow:
        return abs(int(expression.exp)) * _degree(expression.base)
    degrees = [_degree(x) for x in expression.args]
    fractions = any(power.exp.is_negative for power in expression.atoms(sympy.Pow))
    return max(degrees) if expression.is_Add and not fractions else sum(degrees)


def _integer(value: SupportsInt) -> Expression:
    import sympy

    return sympy.Integer(int(value))


def from_array(constants: object) -> tuple[dict[tuple[int, int], dict[int, Any]], int]:
    """Brackets from an array of shape (n, n, n), and n; `ShapeError` for another shape."""
    array = np.array(constants, dtype=object)
    n = len(array) if array.ndim else 0
    if array.shape != (n, n, n):
        raise ShapeError(f"structure constants have shape (n, n, n), got {array.shape}")
    return {(i, j): {k: array[i, j, k] for k in range(n) if array[i, j, k] != 0} for i, j in np.ndindex(n, n)}, n


def antisymmetric(constants: Mapping[Any, Any], symbols: Parameters) -> Brackets:
    """The brackets with i < j, without zeros; `StructureError` if [e_i, e_j] + [e_j, e_i] is not 0."""
    read: dict[tuple[int, int, int], Expression] = {}
    for pair, row in constants.items():
        if not (isinstance(pair, tuple) and len(pair) == 2 and isinstance(row, Mapping)):
            raise StructureError(f"{pair!r}: {row!r} is not a bracket; write {{(i, j): {{k: value}}}}")
        for k, value in row.items():
            if not all(isinstance(x, (int, np.integer)) and x >= 0 for x in (*pair, k)):
                raise StructureError(f"the indices of {pair!r}: {dict(row)!r} are not all integers from 0")
            read[int(pair[0]), int(pair[1]), int(k)] = symbols.read(value, f"c[{pair[0]}, {pair[1]}, {k}]")
    brackets: Brackets = {}
    for (i, j, k), value in read.items():
        other = read.get((j, i, k), 0 if (j, i) in constants else -value)
        if (value + other).cancel() != 0:
            raise StructureError(
                f"the bracket is not antisymmetric: c[{i}, {j}, {k}] = {value}, c[{j}, {i}, {k}] = {other}"
            )
        if value != 0:
            brackets.setdefault((min(i, j), max(i, j)), {})[k] = value if i < j else -value
    return brackets


# LieAlgebraFamily: Lie algebras whose structure constants are rational functions of parameters.
# A statement for all values of the parameters is proved as an identity of rational functions; a generic one comes with
# the polynomial whose zeros it leaves out.

SAMPLES = (2, 3, 5, 7, 1, -1, 0, -2)
"""Values of parameters that messages propose."""


@final
@dataclass(frozen=True, slots=True, repr=False)
class Generic:
    """A number that holds at all values of the parameters except at zeros of a polynomial.

    Attributes
    ----------
    value : int
    nonvanishing : sympy expression
        At parameters where it is not zero, the number is `value`.
    sharp : bool
        Whether the number is another one at all real zeros of `nonvanishing` at which the algebra is defined.
    """

    value: int
    nonvanishing: Expression
    sharp: bool

    def __repr__(self) -> str:
        return str(self.value) + (f" where {self.nonvanishing} != 0" if self.nonvanishing.free_symbols else "")


@final
class LieAlgebraFamily(Displayed, Immutable):
    """Lie algebras of one dimension whose structure constants are rational functions of parameters, over QQ.

    Parameters
    ----------
    constants : mapping or array_like of shape (n, n, n)
        As for `LieAlgebra`, with sympy expressions or strings as values; names of basis elements are allowed.
    parameters : sequence of str or sympy symbols, optional
        In the order of printing; needed if values are strings. By default the free symbols, sorted by name.
    dimension : int, optional
    basis : sequence of str, optional
    name : str, optional

    Attributes
    ----------
    parameters : tuple of sympy symbols
    conditions : tuple of sympy expressions
        The Jacobi identity holds exactly at those values of the parameters at which all these polynomials vanish. If
        there are none, it holds everywhere.
    denominator : sympy expression
        The polynomial whose zeros are left out because a structure constant is not defined there.

    Raises
    ------
    StructureError
        If the table is not antisymmetric, or the Jacobi identity fails for all values of the parameters.
    FieldError
        If a value is not a rational function with rational coefficients.

    Examples
    --------
    >>> import liehom as lh, sympy
    >>> a, b = sympy.symbols("a b")
    >>> family = lh.algebra.LieAlgebraFamily({("x", "y"): {"z": a}, ("y", "z"): {"x": b}, ("z", "x"): {"y": 1}})
    >>> family, family.conditions, family.killing_determinant()
    (<family of Lie algebras of dimension 3 with parameters a, b>, (), -8*a**2*b**2)
    >>> family.derived_dimension(), family.at(a=1, b=-1).real_form()
    (3 where a*b != 0, 'sl(2,R)')
    """

    __slots__ = ("_brackets", "basis_names", "conditions", "denominator", "dimension", "name", "parameters")

    def __init__(
        self,
        constants: ConstantsLike,
        parameters: Sequence[str | Expression] | None = None,
        *,
        dimension: int | None = None,
        basis: Sequence[str] | None = None,
        name: str | None = None,
    ) -> None:
        import sympy

        table: Any = constants
        if is_named(table):
            table, basis = by_index(table, basis)
        names = tuple(map(str, basis)) if basis is not None else None
        if not isinstance(table, Mapping):
            table, dimension = from_array(table)
        symbols = Parameters(table, parameters)
        self.parameters: tuple[Expression, ...] = symbols.chosen
        self._brackets: Brackets = antisymmetric(table, symbols)
        least = 1 + max((x for (i, j), row in self._brackets.items() for x in (i, j, *row)), default=-1)
        self.dimension: int = dimension if dimension is not None else len(names) if names is not None else least
        if self.dimension < least or (names is not None and len(names) != self.dimension):
            raise ShapeError(f"brackets of dimension {least} and {names} do not fit the dimension {self.dimension}")
        self.basis_names: tuple[str, ...] = names or tuple(f"e{i}" for i in range(self.dimension))
        self.name: str | None = name
        denominators = (sympy.fraction(v)[1] for row in self._brackets.values() for v in row.values())
        bottoms = dict.fromkeys(f for d in denominators for f in factors(d, self.parameters))
        self.denominator: Expression = sympy.Mul(*bottoms)
        self.conditions: tuple[Expression, ...] = self._jacobi()

    def _jacobi(self) -> tuple[Expression, ...]:
        """The squarefree numerators of all coefficients of cyclic sums that are not identically zero."""
        import sympy

        conditions: dict[Expression, None] = {}
        for i, j, k in itertools.combinations(range(self.dimension), 3):
            total: dict[int, Expression] = {}
            for a, b, c in ((i, j, k), (j, k, i), (k, i, j)):
                for middle, v in self._row(a, b).items():
                    for m, w in self._row(middle, c).items():
                        total[m] = total.get(m, 0) + v * w
            for m, value in total.items():
                if (value := sympy.cancel(value)) == 0:
                    continue
                if not (needed := factors(value, self.parameters)):
                    labels = (self.basis_names[i], self.basis_names[j], self.basis_names[k])
                    raise JacobiError((i, j, k), {m: str(value)}, labels, self.basis_names)
                conditions[sympy.Mul(*needed)] = None
        return tuple(conditions)

    def _row(self, i: int, j: int) -> dict[int, Expression]:
        """The coefficients of [e_i, e_j]."""
        row = self._brackets.get((min(i, j), max(i, j)), {})
        return row if i < j else {k: -v for k, v in row.items()}

    # -- members of the family ---------------------------------------------------------------------------
    def at(self, values: Mapping[str, ScalarLike] | None = None, **named: ScalarLike) -> LieAlgebra:
        """The Lie algebra at values of all parameters, over the field that the values determine.

        Raises
        ------
        JacobiError
            If the Jacobi identity does not hold there.

        Examples
        --------
        >>> import liehom as lh
        >>> family = lh.algebra.LieAlgebraFamily({("x", "t"): {"x": "1"}, ("y", "t"): {"y": "a"}}, ["a"], name="g")
        >>> family.at(a="sqrt(2)"), family.at(a=-1).killing_signature()
        (<Lie algebra g(sqrt(2)) of dimension 3 over QQ(sqrt(2))>, (1, 0, 2))
        """
        by_name = {str(key): value for key, value in {**(values or {}), **named}.items()}
        known = [str(p) for p in self.parameters]
        if unknown := sorted(set(by_name) - set(known)):
            raise InputError(f"{', '.join(unknown)}: the parameters are {', '.join(known) or 'none'}")
        if missing := [p for p in known if p not in by_name]:
            raise InputError(f"the parameter(s) {', '.join(missing)} have no value: {self._proposal()}")
        field = field_of_values(by_name.values())
        point = [field.convert(by_name[p]) for p in known]
        brackets = {
            pair: {k: self._value(v, field, point) for k, v in row.items()} for pair, row in self._brackets.items()
        }
        name = f"{self.name}({','.join(map(field.show, point))})" if self.name else None
        return LieAlgebra(brackets, field, dimension=self.dimension, basis=self.basis_names, name=name)

    def _value(self, expression: Expression, field: Field, point: Sequence[Scalar]) -> Scalar:
        import sympy

        parts = []
        for part in sympy.fraction(expression):
            total = field.zero
            for exponents, c in sympy.Poly(part, *self.parameters, domain="QQ").terms() if point else [((), part)]:
                powers = (value ** int(exponent) for value, exponent in zip(point, exponents, strict=True))
                total = total + math.prod(powers, start=field.convert(c))
            parts.append(total)
        if parts[1] == 0:
            raise InputError(f"the structure constant {expression} is not defined there: its denominator vanishes")
        return parts[0] / parts[1]

    def sample(self) -> dict[str, int] | None:
        """Small values of the parameters at which there is a Lie algebra, or None if none of those tried is one."""
        for point in itertools.islice(itertools.product(SAMPLES, repeat=len(self.parameters)), 4096):
            there = dict(zip(self.parameters, point, strict=True))
            if self.denominator.subs(there) != 0 and all(p.subs(there) == 0 for p in self.conditions):
                return {str(p): value for p, value in there.items()}
        return None

    def _proposal(self) -> str:
        sample = self.sample() or {}
        values = ", ".join(f"{p}={sample.get(str(p), '...')}" for p in self.parameters)
        return f"choose values, for example .at({values})"

    # -- generic statements ------------------------------------------------------------------------------
    def killing_form(self) -> Expression:
        """The Killing form as a sympy matrix (n, n) of rational functions of the parameters."""
        import sympy

        n = self.dimension
        adjoint = [sympy.Matrix(n, n, lambda k, j, i=i: self._row(i, j).get(k, 0)) for i in self._proved(n)]
        return sympy.Matrix(n, n, lambda i, j: sympy.cancel((adjoint[i] * adjoint[j]).trace()))

    def killing_determinant(self) -> Expression:
        """The determinant of the Killing form, factored: the algebra is semisimple if and only if it is not zero."""
        import sympy

        return sympy.factor(self.killing_form().det(method="berkowitz"))

    def killing_rank(self) -> Generic:
        """The generic rank of the Killing form."""
        return self._generic(self.killing_form().tolist())

    def derived_dimension(self) -> Generic:
        """The generic dimension of [g, g]."""
        columns = self._proved(self.dimension)
        return self._generic([[row.get(k, 0) for k in columns] for row in self._brackets.values()])

    def center_dimension(self) -> Generic:
        """The generic dimension of the centre."""
        n = self.dimension
        rank = self._generic([[self._row(i, j).get(k, 0) for i in range(n)] for j in self._proved(n) for k in range(n)])
        return Generic(n - rank.value, rank.nonvanishing, rank.sharp)

    def is_semisimple(self) -> bool:
        """Whether all algebras of the family are semisimple (True) or none is (False).

        Raises
        ------
        UndecidedError
            If some are semisimple and some are not; the message names the polynomial that decides.
        """
        determinant = self.killing_determinant()
        if determinant != 0 and (deciding := factors(determinant, self.parameters)):
            product = "*".join(f"({f})" for f in deciding)
            raise UndecidedError(f"semisimple if and only if {product} != 0; {self._proposal()}.is_semisimple()")
        return bool(determinant != 0)

    def _generic(self, rows: Sequence[Sequence[Expression]]) -> Generic:
        import sympy

        rank, conditions, sharp = generic_rank(rows, self.parameters)
        conditions += factors(self.denominator, self.parameters)
        return Generic(rank, sympy.Mul(*dict.fromkeys(conditions)), sharp)

    def _proved(self, n: int) -> range:
        """range(n), if the Jacobi identity is an identity in the parameters."""
        if self.conditions:
            conditions = ", ".join(f"{p} = 0" for p in self.conditions)
            raise StructureError(f"there is a Lie algebra only where {conditions}; {self._proposal()}")
        return range(n)

    def __getattr__(self, name: str) -> NoReturn:
        if name.startswith("_") or not hasattr(LieAlgebra, name):
            raise AttributeError(f"a LieAlgebraFamily has no attribute {name!r}")
        raise AttributeError(f"{name!r} depends on the parameters; {self._proposal()}.{name}")

    # -- comparison and printing -------------------------------------------------------------------------
    def __eq__(self, other: object) -> bool:
        return isinstance(other, LieAlgebraFamily) and self._content() == other._content()

    def __hash__(self) -> int:
        return hash(self._content())

    def _content(self) -> tuple[Any, ...]:
        entries = {(i, j, k): v for (i, j), row in self._brackets.items() for k, v in row.items()}
        return self.dimension, self.parameters, frozenset(entries.items())

    def __repr__(self) -> str:
        title = f"{self.name} " if self.name else ""
        parameters = ", ".join(map(str, self.parameters))
        return f"<family {title}of Lie algebras of dimension {self.dimension} with parameters {parameters}>"

    def __str__(self) -> str:
        import sympy

        x = [sympy.Symbol(name) for name in self.basis_names]
        sums = [(pair, sympy.Add(*(v * x[k] for k, v in row.items()))) for pair, row in sorted(self._brackets.items())]
        lines = [f"family of Lie algebras with parameters {', '.join(map(str, self.parameters))}"]
        lines += [f"  basis {', '.join(self.basis_names)}", *(f"  [{x[i]}, {x[j]}] = {v}" for (i, j), v in sums)]
        return "\n".join([*lines, *(f"  only where {p} = 0" for p in self.conditions)])
