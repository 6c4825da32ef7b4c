"""A formula as a polynomial in named functions, and as a numpy function.

    f = sum of c_i * (product of named functions),   c_i rational,

The coefficients c_i are found by linear algebra on normal forms.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import combinations_with_replacement
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liehom.correctors.symbolic.symbolic_problem import FieldPolynomial, Symbols
from liehom.errors import InputError, ShapeError, SingularError
from liehom.scalars import QQ
from liehom.scalars.functions.function_field import RationalFunction
from liehom.series.arrays import as_values, is_jax, namespace
from liehom.typing import Expression, Real, Values

TERMS_PER_CHUNK = 100


# -- matching --------------------------------------------------------------------------------------------
def ansatz(symbols: Symbols, invariants: Mapping[Any, Any], target: RationalFunction, degree: int) -> Expression:
    """The polynomial in the invariants, with rational coefficients, that equals the target, a sympy expression.

    Terms whose degree in the parameters cannot occur are omitted. Of several polynomials one with terms of low degree
    is returned.

    Raises
    ------
    InputError
        If there is none.

    Examples
    --------
    >>> import liehom as lh
    >>> from liehom.correctors.symbolic.symbolic_problem import read_symbols
    >>> symbols, _ = read_symbols(lh.defining(lh.so(2)), ["a*m0"], None, None)
    >>> ansatz(symbols, {"s": "m1**2", "a": "a"}, symbols.element("a*m0**2 - 1"), 2)
    -a*s + a - 1
    """
    import sympy

    names = [key if hasattr(key, "free_symbols") else sympy.Symbol(str(key)) for key in invariants]
    values = [symbols.element(x) for x in invariants.values()]
    terms: list[tuple[Any, RationalFunction]] = []
    for d in range(degree + 1):
        for chosen in combinations_with_replacement(range(len(values)), d):
            made = symbols.field.one
            for i in chosen:
                made = made * values[i]
            terms.append((sympy.Mul(*(names[i] for i in chosen)), made.cancelled()))
    wanted = _degrees(symbols, target)
    terms = [(e, x) for e, x in terms if wanted is None or _degrees(symbols, x) in (wanted, None)]
    solution = _combination([x for _, x in terms], target)
    if solution is None:
        raise InputError(
            f"the coefficient is not a polynomial of degree {degree} in {', '.join(map(str, names))} with rational "
            "coefficients: allow a higher degree, or name more functions (its denominator, for example)"
        )
    return sympy.Add(*(sympy.Rational(str(c)) * e for (e, _), c in zip(terms, solution, strict=True)))


def _degrees(symbols: Symbols, x: RationalFunction) -> int | None:
    """The degree in the parameters if all terms have the same, else None."""
    first = symbols.size + 1

    def of(p: FieldPolynomial) -> set[int]:
        return {sum(map(int, m[first:])) for m in p.monoms()}

    parts = [(of(x.numerator), 1)] + [(of(symbols.field.atoms[i]), -k) for i, k in x.powers]
    if any(len(found) != 1 for found, _ in parts):
        return None
    return sum(k * next(iter(found)) for found, k in parts)


def _combination(elements: list[RationalFunction], target: RationalFunction) -> list[Any] | None:
    """List of rational numbers c with target = sum c_i elements_i, or None."""
    if not elements:
        return None
    powers: dict[int, int] = {}
    for x in (*elements, target):
        for i, k in x.powers:
            powers[i] = max(k, powers.get(i, 0))
    common = tuple(sorted(powers.items()))
    tops = [{tuple(map(int, e)): c for e, c in x.over(common).terms()} for x in (*elements, target)]
    monomials = sorted({e for top in tops for e in top})
    if not monomials:
        return [QQ.zero] * len(elements)
    rows = [[top.get(e, QQ.zero) for top in tops] for e in monomials]
    left = QQ.matrix([row[:-1] for row in rows], (len(rows), len(elements)))
    try:
        found = left.solve(QQ.matrix([[row[-1]] for row in rows], (len(rows), 1)))
    except SingularError:
        return None
    return [row[0] for row in found.to_rows()]


# -- compiled --------------------------------------------------------------------------------------------
def compiled_function(symbols: Symbols, elements: Sequence[RationalFunction]) -> Callable[..., Any]:
    """Function (m, t=0, **parameters) -> values of the elements, array of shape (..., number of elements).

    Examples
    --------
    >>> import liehom as lh
    >>> from liehom.correctors.symbolic.symbolic_problem import read_symbols
    >>> symbols, _ = read_symbols(lh.defining(lh.so(2)), ["a*m0"], None, None)
    >>> f = compiled_function(symbols, [symbols.element("a*m0/m1")])
    >>> f([[3.0, 4.0], [1.0, 0.0]], a=2.0).tolist()
    [[1.5], [0.0]]
    """
    import sympy

    order = [symbols.symbols[name] for name in symbols.names]
    parts: list[Any] = []  # sums of at most TERMS_PER_CHUNK terms, as a compiler reads a long sum as a deep tree
    plans: list[tuple[tuple[int, int], list[tuple[list[int], int]]]] = []
    for element in elements:
        content, factors = symbols.factors(element)
        plan = []
        for p, k in factors:
            chunks = symbols.chunks(p, TERMS_PER_CHUNK)
            plan.append((list(range(len(parts), len(parts) + len(chunks))), k))
            parts += chunks
        plans.append(((int(content.p), int(content.q)), plan))
    run = sympy.lambdify(order, parts, modules="numpy", cse=True)

    def function(m: ArrayLike, t: Real = 0.0, **parameters: Real) -> Values:
        point = as_values(m)
        if point.ndim == 0 or point.shape[-1] != symbols.size:
            raise ShapeError(f"a point has {symbols.size} coordinates (on its last axis), got shape {point.shape}")
        if set(parameters) != set(symbols.parameters):
            raise InputError(f"the parameters are {list(symbols.parameters)}, got {sorted(parameters)}")
        values: list[Any] = (
            [point[..., i] for i in range(symbols.size)] + [t] + [parameters[name] for name in symbols.parameters]
        )
        values = [v if is_jax(v) else np.asarray(v) for v in values]
        xp = namespace(*values)
        shape = np.broadcast_shapes(*(v.shape for v in values))
        found = run(*values)
        made = []
        for (above, below), plan in plans:
            top, bottom = xp.ones(shape) * above, xp.ones(shape) * below
            for chunks, k in plan:
                base = sum(found[i] for i in chunks)
                top, bottom = (top * base**k, bottom) if k > 0 else (top, bottom * base**-k)
            defined = bottom != 0
            made.append(xp.where(defined, top / xp.where(defined, bottom, 1), 0 * top))
        result: Values = xp.stack(made, axis=-1)
        return result

    return function
