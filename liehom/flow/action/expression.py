"""Expressions as functions of a point and a time: compilation and evaluation."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from operator import add, mul, sub, truediv
from typing import Any, Literal, TypeAlias, final

import numpy as np

from liehom.base.errors import FieldError, InputError, ParseError, displayed
from liehom.base.typing import Expression, Real, ScalarLike, Values
from liehom.flow.action.maps import remainder
from liehom.flow.door import AlgebraicNumber, Call, Name, Node, Number, Operation, parse
from liehom.flow.series.arrays import elementary, is_exact
from liehom.flow.series.jet import Jet

# Evaluation of expressions at a point and a time in the arithmetic of the point, and the nodes of expressions.
#
# A compiled expression is a function of an `Evaluation`, that is of m and t.  Its constants are numbers of the
# arithmetic of m: float64, extended precision, exact numbers, or Jets of these.

Value: TypeAlias = Any
"""A value of an expression: a float, an exact number, an array or a Jet."""


@final
class Evaluation:
    """The coordinates of a point m, the time t, and constants as numbers of the arithmetic of m."""

    _zero: Value
    t: Real

    __slots__ = ("_coordinates", "_m", "_zero", "kind", "t")

    def __init__(self, m: Values, t: Real) -> None:
        value: Any = m.value if isinstance(m, Jet) else m
        self._m, self.t, self._zero = m, t, 0.0
        self._coordinates: dict[int, Value] = {}
        self.kind: Literal["float", "extended", "exact"] = "float"
        if is_exact(value):
            self.kind, self._zero = "exact", 0 * value.flat[0] if value.size else Fraction(0)
        elif value.dtype == np.longdouble:
            self.kind, self._zero = "extended", np.longdouble(0)

    def coordinate(self, i: int) -> Value:
        """The coordinate m_i, of shape (...,)."""
        if i not in self._coordinates:
            self._coordinates[i] = self._m[..., i]
        return self._coordinates[i]

    def rational(self, value: Fraction) -> Value:
        """A rational number in the arithmetic of m."""
        try:
            if self.kind == "float":
                return value.numerator / value.denominator
            return (self._zero + value.numerator) / value.denominator
        except OverflowError:
            raise FieldError("a number of the generator leaves the range of floats") from None

    def irrational(self, value: float, digits: str) -> Value:
        """An irrational number such as pi in the arithmetic of m, given by its float and by a string of digits."""
        if self.kind == "exact":
            raise FieldError(f"{value!r} stands next to exact numbers: write a fraction, or use floats throughout")
        return value if self.kind == "float" else np.longdouble(digits)

    def algebraic(self, value: AlgebraicNumber) -> Value:
        """An element of a number field in the arithmetic of m."""
        if self.kind == "exact":
            return self._zero + value
        near = value.field.to_float(value)
        return (
            near if self.kind == "float" else np.longdouble(near) + np.longdouble(remainder(value.field, value, near))
        )


Compiled = Callable[[Evaluation], Value]
"""A compiled expression."""


def constant(inner: Compiled) -> Compiled:
    """The node of a constant, computed once for each arithmetic of floats."""
    known: dict[str, Value] = {}

    def value(at: Evaluation) -> Value:
        if at.kind == "exact":
            return inner(at)
        if at.kind not in known:
            known[at.kind] = inner(at)
        return known[at.kind]

    return value


OPERATORS: dict[str, Callable[[Any, Any], Any]] = {"+": add, "-": sub, "*": mul, "/": truediv}


def chain(first: Compiled, steps: list[tuple[str, Compiled]]) -> Compiled:
    """The node of a + b - c ... or a * b / c ..., evaluated from left to right."""

    def value(at: Evaluation) -> Value:
        total = first(at)
        try:
            for operator, part in steps:
                total = OPERATORS[operator](total, part(at))
        except ZeroDivisionError:
            raise ParseError("division by zero in a value") from None
        return total

    return value


def power(base: Compiled, exponent: int) -> Compiled:
    """The node of a power with a constant integer exponent."""

    def value(at: Evaluation) -> Value:
        try:
            return base(at) ** exponent
        except ZeroDivisionError:
            raise ParseError("a negative power of zero in a value") from None

    return value


def applied(name: str, argument: Compiled) -> Compiled:
    """The node of a function of one argument, given by its numpy name."""

    def value(at: Evaluation) -> Value:
        x = argument(at)
        if isinstance(x, Jet):
            return getattr(np, name)(x)
        if name == "sqrt" and at.kind == "exact":
            return np.vectorize(_exact_root, otypes=[object])(x) if np.ndim(x) else _exact_root(np.asarray(x).item())
        return elementary(name, x)

    return value


def _exact_root(x: Value) -> Value:
    return x.field.sqrt(x) if isinstance(x, AlgebraicNumber) else elementary("sqrt", x)


# Compilation of one component of a generator, a string, sympy expression or number, to a function of (m, t) on arrays
# of any precision, exact numbers and Jets, with constants in the arithmetic of m. Expressions that are not translated
# (Piecewise, Abs, special functions) are compiled by `sympy.lambdify`.

# functions that a string may call, by their names in sympy
FUNCTIONS = ("sqrt", "sin", "cos", "tan", "exp", "log", "sinh", "cosh", "tanh", "atan", "asin", "asinh", "atanh")
_NUMPY = {"atan": "arctan", "asin": "arcsin", "asinh": "arcsinh", "atanh": "arctanh"}
TREES = (Number, Name, Call, Operation)

ComponentLike: TypeAlias = ScalarLike | Node | Expression
"""What is read as one component of a generator: a number, a string, a parsed string or a sympy expression."""


def compiled(part: ComponentLike, size: int, what: str) -> tuple[Compiled, bool]:
    """One component as a function of an `Evaluation`, and whether it depends on t."""
    if isinstance(part, str):
        try:
            part = parse(part, frozenset([*(f"m{i}" for i in range(size)), "t", "pi"]), FUNCTIONS)
        except ParseError as error:
            raise ParseError(f"{what}: {error}") from None
    if isinstance(part, TREES):
        return _of_tree(part), "t" in _names(part)
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
                number = Fraction(part) if isinstance(part, Fraction) else Fraction(int(part))
                return lambda s: s.rational(number)
            wide = part if isinstance(part, np.longdouble) else float(part)
            ratio, near, digits = Fraction(*wide.as_integer_ratio()), float(part), str(np.longdouble(wide))
            return (lambda s: s.rational(ratio)) if ratio.denominator == 1 else (lambda s: s.irrational(near, digits))
        except (TypeError, ValueError, OverflowError):
            pass
    raise InputError(f"{what} is {displayed(part)}: expected a finite real number, a string or a sympy expression")


# -- strings -----------------------------------------------------------------------------------------------
def _names(tree: Node) -> set[str]:
    names, stack = set(), [tree]
    while stack:
        match stack.pop():
            case Name(name):
                names.add(name)
            case Call(_, argument):
                stack.append(argument)
            case Operation(_, operands):
                stack.extend(operands)
    return names


def _of_tree(tree: Node) -> Compiled:
    if isinstance(tree, Number):
        number = Fraction(int(tree.value))
        return lambda s: s.rational(number)
    return _combined(tree) if _names(tree) - {"pi"} else constant(_combined(tree))


def _combined(tree: Node) -> Compiled:
    steps: list[tuple[str, Compiled]] = []
    while isinstance(tree, Operation) and len(tree.operands) == 2 and tree.operator != "**":
        steps.append((tree.operator, _of_tree(tree.operands[1])))  # chains may be longer than the stack
        tree = tree.operands[0]
    if steps:
        return chain(_of_tree(tree), steps[::-1])
    match tree:
        case Name("t"):
            return lambda s: s.t
        case Name("pi"):
            return lambda s: s.irrational(np.pi, "3.14159265358979323846264338327950288")
        case Name(name):
            index = int(name[1:])
            return lambda s: s.coordinate(index)
        case Call(function, argument):
            return applied(_NUMPY.get(function, function), _of_tree(argument))
        case Operation("**", (base, Operation("neg", (Number(value),)))):
            return power(_of_tree(base), -int(value))
        case Operation("**", (base, Number(value))):
            return power(_of_tree(base), int(value))
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
    operation = _operation(part)
    return constant(operation) if operation is not None and not part.free_symbols else operation


def _operation(part: Expression) -> Compiled | None:
    import sympy

    if part.is_Mul or part.is_Add:
        above = [a for a in part.args if part.is_Add or not _is_divisor(a)]
        below = [1 / a for a in part.args if part.is_Mul and _is_divisor(a)]
        operands = [_translated(a) for a in [*(above or [sympy.S.One]), *below]]
        known = [f for f in operands if f is not None]
        operators = ["+" if part.is_Add else "*"] * (len(above) - 1 if above else 0) + ["/"] * len(below)
        return chain(known[0], list(zip(operators, known[1:], strict=True))) if len(known) == len(operands) else None
    if part.is_Pow:
        return _sympy_power(*part.args)
    name = part.func.__name__
    inner = _translated(part.args[0]) if name in FUNCTIONS and len(part.args) == 1 else None
    return None if inner is None else applied(_NUMPY.get(name, name), inner)


def _is_divisor(part: Expression) -> bool:
    return bool(part.is_Pow and part.exp.is_Rational and part.exp.is_negative)


def _sympy_power(base: Expression, exponent: Expression) -> Compiled | None:
    inner = _translated(base)
    if inner is None:
        return None
    if exponent.is_Integer:
        return power(inner, int(exponent))
    if exponent.is_Rational and exponent.q == 2:
        root = applied("sqrt", inner)
        return root if exponent.p == 1 else power(root, int(exponent.p))
    above = _translated(exponent)
    return None if above is None else lambda s: inner(s) ** above(s)


def _numpy_code(part: Expression, size: int) -> Compiled:
    import sympy

    by_name = {str(s): s for s in part.free_symbols}
    symbols = [by_name.get(name, sympy.Symbol(name)) for name in (*(f"m{i}" for i in range(size)), "t")]
    function = sympy.lambdify(symbols, part, modules="numpy", cse=True)
    return lambda s: function(*[s.coordinate(i) for i in range(size)], s.t)
