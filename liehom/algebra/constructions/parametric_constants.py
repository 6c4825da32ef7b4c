"""Structure constants that are rational functions of parameters, from mappings and arrays of symbols and strings."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from math import comb
from typing import Any, SupportsInt

import numpy as np

from liehom.errors import FieldError, InputError, ParseError, ShapeError, StructureError
from liehom.scalars import QQ
from liehom.scalars.fields import grammar
from liehom.typing import Expression, ScalarLike

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
                made = grammar.evaluate(grammar.parse(value, self.names, ()), _integer, self.names, {})
            except ParseError as error:
                raise ParseError(f"{where}: {error}") from None
        elif hasattr(value, "free_symbols"):
            made = value
        else:
            rational = QQ.convert(value)
            made = sympy.Rational(int(rational.p), int(rational.q))
        exact = all(x.is_Symbol or x.is_Rational for x in made.atoms())
        exact = exact and all(power.exp.is_Integer for power in made.atoms(sympy.Pow))
        if not exact or (made.free_symbols and not made.is_rational_function(*made.free_symbols)):
            raise FieldError(f"{where} is {made}, expected a rational function with rational coefficients")
        terms = comb(_degree(made) + len(self.chosen), len(self.chosen))
        if terms > MAX_TERMS:
            raise InputError(
                f"{where} is of degree {_degree(made)}: up to {terms} terms, at most {MAX_TERMS} are handled"
            )
        return sympy.cancel(made)


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
    indices = itertools.product(range(n), repeat=2)
    return {(i, j): {k: array[i, j, k] for k in range(n) if array[i, j, k] != 0} for i, j in indices}, n


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
