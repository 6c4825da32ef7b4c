"""Compilation of one component of a generator, a string, sympy expression or number, to a function of (m, t).

The compiled function runs on arrays of any precision, on exact numbers and on Jets.  Its constants are rational
numbers, square roots, pi, ..., evaluated in the arithmetic of m.  Expressions that this module does not translate
(Piecewise, Abs, special functions) are compiled by `sympy.lambdify`.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any, TypeAlias

import numpy as np

from liehom.errors import InputError, ParseError, displayed
from liehom.homogeneous.fields.evaluation import Chain, Compiled, Constant, Function, Power
from liehom.scalars.fields.grammar import Call, Name, Node, Number, Operation, parse
from liehom.scalars.fields.number_field import AlgebraicNumber
from liehom.typing import Expression, ScalarLike

# functions that a string may call, by their names in sympy
FUNCTIONS = ("sqrt", "sin", "cos", "tan", "exp", "log", "sinh", "cosh", "tanh", "atan", "asin", "asinh", "atanh")
_NUMPY = {"atan": "arctan", "asin": "arcsin", "asinh": "arcsinh", "atanh": "arctanh"}
TREES = (Number, Name, Call, Operation)

ComponentLike: TypeAlias = ScalarLike | Node | Expression
"""What is read as one component of a generator: a number, a string, a parsed string or a sympy expression."""


def compiled(part: ComponentLike, size: int, what: str) -> tuple[Compiled, bool]:
    """One component as a function of an `Evaluation`, and whether it depends on t.

    Parameters
    ----------
    part : str, parsed string, sympy expression or real number
    size : int
        N; the symbols are m0, ..., m(N-1) and t.
    what : str
        Name in error messages.

    Raises
    ------
    ParseError
        If a string does not follow the grammar.
    InputError
        If the component is not one of these, is not real and finite, or has unknown symbols.

    Examples
    --------
    >>> from liehom.homogeneous.fields.evaluation import Evaluation
    >>> function, timed = compiled("m0/2 + sin(t)", 1, "psi[0]")
    >>> function(Evaluation(np.array([3.0]), 0.0)), timed
    (np.float64(1.5), True)
    """
    if isinstance(part, str):
        try:
            part = parse(part, frozenset([*(f"m{i}" for i in range(size)), "t", "pi"]), FUNCTIONS)
        except ParseError as error:
            raise ParseError(f"{what}: {error}") from None
    if isinstance(part, TREES):
        names = _names(part)
        return _of_tree(part), "t" in names
    if hasattr(part, "free_symbols"):
        return _of_sympy(part, size, what)
    return _of_number(part, what), False


# -- numbers ---------------------------------------------------------------------------------------------
def _of_number(part: Any, what: str) -> Compiled:
    if isinstance(part, AlgebraicNumber):
        return lambda s: s.algebraic(part)
    if not isinstance(part, bool | np.bool_ | complex | np.complexfloating):
        try:
            if hasattr(part, "p") and hasattr(part, "q"):
                exact = Fraction(int(part.p), int(part.q))
                return lambda s: s.rational(exact)
            if isinstance(part, int | np.integer | Fraction):
                whole = Fraction(part) if isinstance(part, Fraction) else Fraction(int(part))
                return lambda s: s.rational(whole)
            wide = part if isinstance(part, np.longdouble) else float(part)
            ratio, near, digits = Fraction(*wide.as_integer_ratio()), float(part), str(np.longdouble(wide))
            return (lambda s: s.rational(ratio)) if ratio.denominator == 1 else (lambda s: s.irrational(near, digits))
        except (TypeError, ValueError, OverflowError):
            pass
    raise InputError(f"{what} is {displayed(part)}: expected a finite real number, a string or a sympy expression")


# -- strings -----------------------------------------------------------------------------------------------
def _names(tree: Node) -> set[str]:
    found, stack = set(), [tree]
    while stack:
        node = stack.pop()
        match node:
            case Name(name):
                found.add(name)
            case Call(_, argument):
                stack.append(argument)
            case Operation(_, operands):
                stack.extend(operands)
    return found


def _of_tree(tree: Node) -> Compiled:
    names = _names(tree)
    if isinstance(tree, Number):
        whole = Fraction(int(tree.value))
        return lambda s: s.rational(whole)
    if not names - {"pi"}:
        return Constant(_combined(tree))
    return _combined(tree)


def _combined(tree: Node) -> Compiled:
    steps: list[tuple[str, Compiled]] = []
    while isinstance(tree, Operation) and len(tree.operands) == 2 and tree.operator != "**":
        steps.append((tree.operator, _of_tree(tree.operands[1])))  # chains may be longer than the stack
        tree = tree.operands[0]
    if steps:
        return Chain(_of_tree(tree), steps[::-1])
    match tree:
        case Name("t"):
            return lambda s: s.t
        case Name("pi"):
            return lambda s: s.irrational(np.pi, "3.14159265358979323846264338327950288")
        case Name(name):
            index = int(name[1:])
            return lambda s: s.coordinate(index)
        case Call(function, argument):
            return Function(_NUMPY.get(function, function), _of_tree(argument))
        case Operation("**", (base, Operation("neg", (Number(value),)))):
            return Power(_of_tree(base), -int(value))
        case Operation("**", (base, Number(value))):
            return Power(_of_tree(base), int(value))
        case Operation("neg", (operand,)):
            inner = _of_tree(operand)
            return lambda s: -inner(s)
    return _of_tree(tree)


# -- sympy expressions -----------------------------------------------------------------------------------
def _of_sympy(part: Expression, size: int, what: str) -> tuple[Compiled, bool]:
    import sympy
    from sympy.core.function import AppliedUndef

    names = frozenset([*(f"m{i}" for i in range(size)), "t"])
    unknown = sorted(
        {str(s) for s in part.free_symbols if str(s) not in names} | set(map(str, part.atoms(AppliedUndef)))
    )
    if unknown:
        raise InputError(f"{what} has the symbols {', '.join(unknown)}; known are m0 ... m{size - 1} and t")
    if not isinstance(part, sympy.Expr) or part.has(sympy.I, sympy.zoo, sympy.nan, sympy.oo, -sympy.oo):
        raise InputError(f"{what} is {part}: expected a real expression")
    timed = any(str(s) == "t" for s in part.free_symbols)
    return _translated(part) or _numpy_code(part, size), timed


def _translated(part: Expression) -> Compiled | None:
    """The compiled function of an expression, or None if it has an operation that is not translated here."""
    import sympy

    if part.is_Symbol:
        name = str(part)
        return (lambda s: s.t) if name == "t" else _combined(Name(name))
    if isinstance(part, sympy.Rational):
        exact = Fraction(int(part.p), int(part.q))
        return lambda s: s.rational(exact)
    if part.is_Float or part.is_NumberSymbol:
        near, digits = float(part), str(part.evalf(30))
        return lambda s: s.irrational(near, digits)
    made = _operation(part)
    return Constant(made) if made is not None and not part.free_symbols else made


def _operation(part: Expression) -> Compiled | None:
    import sympy

    if part.is_Mul or part.is_Add:
        above = [a for a in part.args if part.is_Add or not _is_divisor(a)]
        below = [1 / a for a in part.args if part.is_Mul and _is_divisor(a)]
        made = [_translated(a) for a in [*(above or [sympy.S.One]), *below]]
        known = [f for f in made if f is not None]
        operators = ["+" if part.is_Add else "*"] * (len(above) - 1 if above else 0) + ["/"] * len(below)
        return Chain(known[0], list(zip(operators, known[1:], strict=True))) if len(known) == len(made) else None
    if part.is_Pow:
        return _sympy_power(*part.args)
    name = part.func.__name__
    inner = _translated(part.args[0]) if name in FUNCTIONS and len(part.args) == 1 else None
    return None if inner is None else Function(_NUMPY.get(name, name), inner)


def _is_divisor(part: Expression) -> bool:
    return bool(part.is_Pow and part.exp.is_Rational and part.exp.is_negative)


def _sympy_power(base: Expression, exponent: Expression) -> Compiled | None:
    inner = _translated(base)
    if inner is None:
        return None
    if exponent.is_Integer:
        return Power(inner, int(exponent))
    if exponent.is_Rational and exponent.q == 2:
        root = Function("sqrt", inner)
        return root if exponent.p == 1 else Power(root, int(exponent.p))
    above = _translated(exponent)
    return None if above is None else lambda s: inner(s) ** above(s)


def _numpy_code(part: Expression, size: int) -> Compiled:
    import sympy

    by_name = {str(s): s for s in part.free_symbols}
    symbols = [by_name.get(name, sympy.Symbol(name)) for name in (*(f"m{i}" for i in range(size)), "t")]
    function = sympy.lambdify(symbols, part, modules="numpy", cse=True)
    return lambda s: function(*[s.coordinate(i) for i in range(size)], s.t)
