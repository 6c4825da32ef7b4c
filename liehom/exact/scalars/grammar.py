"""The grammar of values: how a string denotes a number, read without executing code.

    value  = term (("+" | "-") term)*          unary = ("+" | "-") unary | power
    term   = unary (("*" | "/") unary)*        power = atom ["**" unary]        (exponents are integers)
    atom   = integer | name | function "(" value ")" | "(" value ")"

`parse` returns a tree of `Number`, `Name`, `Call` and `Operation` nodes, and `evaluate` computes its value with any
objects that have Python arithmetic. The caller chooses the allowed names and functions, by default only ``sqrt``.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from operator import add, mul, sub, truediv
from typing import Any, TypeVar

import flint

from liehom.base.budget import digits_within, in_time, within
from liehom.base.errors import ParseError

T = TypeVar("T")
MAX_BITS = 10**8
"""Numbers that may be larger than this are not computed, even where they would cancel."""
_ARITHMETIC: dict[str, Callable[[Any, Any], Any]] = {"+": add, "-": sub, "*": mul, "/": truediv}
_TOKEN = re.compile(r"\s*(?:([0-9]+)|([A-Za-z_][A-Za-z_0-9]*)|(\*\*|[-+*/()]))", re.ASCII)


@dataclass(frozen=True, slots=True)
class Number:
    """A non-negative integer."""

    value: flint.fmpz


@dataclass(frozen=True, slots=True)
class Name:
    """A name that denotes a number, such as the generator of a number field."""

    name: str


@dataclass(frozen=True, slots=True)
class Call:
    """A function applied to one argument."""

    function: str
    argument: Node


@dataclass(frozen=True, slots=True)
class Operation:
    """An operator (+ - * / ** or the unary 'neg') with its operands."""

    operator: str
    operands: tuple[Node, ...]


Node = Number | Name | Call | Operation


class _Parser:
    """Recursive descent over the tokens of one string."""

    __slots__ = ("functions", "names", "position", "text", "tokens")

    def __init__(self, text: str, names: Collection[str], functions: Collection[str]) -> None:
        within("characters", len(text), "a value has {} characters")
        self.text, self.names, self.functions = text, names, functions
        self.tokens = self._tokenize(text)
        self.position = 0

    def _tokenize(self, text: str) -> list[str]:
        tokens, start, stripped = [], 0, text.rstrip()
        while start < len(stripped):
            match = _TOKEN.match(stripped, start)
            if match is None:
                raise self.error(f"unexpected character {stripped[start]!r}")
            tokens.append(match.group().strip())
            start = match.end()
        return tokens

    def error(self, what: str) -> ParseError:
        shown = self.text if len(self.text) <= 60 else self.text[:57] + "..."
        return ParseError(f"{shown!r} is not a value: {what}; write integers, fractions 'p/q' or such as 'sqrt(2)/2'")

    @property
    def token(self) -> str:
        return self.tokens[self.position] if self.position < len(self.tokens) else ""

    def take(self) -> str:
        token = self.token
        self.position += 1
        return token

    def expression(self, depth: int) -> Node:
        within("nesting", depth, "parentheses or signs of a value are nested {} deep")
        left = self.term(depth)
        while self.token in ("+", "-"):
            left = Operation(self.take(), (left, self.term(depth)))
        return left

    def term(self, depth: int) -> Node:
        left = self.unary(depth)
        while self.token in ("*", "/"):
            left = Operation(self.take(), (left, self.unary(depth)))
        return left

    def unary(self, depth: int) -> Node:
        within("nesting", depth, "parentheses or signs of a value are nested {} deep")
        if self.token in ("+", "-"):
            sign, inside = self.take(), self.unary(depth + 1)
            return Operation("neg", (inside,)) if sign == "-" else inside
        base = self.atom(depth)
        if self.token == "**":
            self.take()
            return Operation("**", (base, self.unary(depth + 1)))
        return base

    def atom(self, depth: int) -> Node:
        token = self.take()
        if not token:
            raise self.error("it ends too early" if self.tokens else "it is empty")
        if token[0].isdigit():
            return Number(read_integer(token))
        if token == "(":
            return self.closed(depth)
        if token in self.functions:
            if self.take() != "(":
                raise self.error(f"{token} needs an argument in parentheses")
            return Call(token, self.closed(depth))
        if token in self.names:
            return Name(token)
        if token[0].isalpha() or token[0] == "_":
            known = ", ".join(sorted([*self.names, *self.functions]))
            raise self.error(f"the name {token!r} is not known here (known: {known})")
        raise self.error(f"unexpected {token!r}")

    def closed(self, depth: int) -> Node:
        inside = self.expression(depth + 1)
        if self.take() != ")":
            raise self.error("a parenthesis is not closed")
        return inside


def parse(text: str, names: Collection[str] = (), functions: Collection[str] = ("sqrt",)) -> Node:
    """The tree of a value."""
    parser = _Parser(text, names, functions)
    try:
        tree = parser.expression(0)
    except RecursionError:  # only if the limit was raised
        raise parser.error("parentheses or signs are nested deeper than Python's stack") from None
    if parser.token:
        raise parser.error(f"unexpected {parser.token!r}")
    if (bits := _bits(tree)) > MAX_BITS:
        digits_within(bits, "the powers in a value make a number of up to {} digits")
    return tree


def read_integer(digits: str) -> flint.fmpz:
    """The integer with these decimal digits, perhaps after a sign; `LimitError` if there are too many."""
    within("digits", len(digits), "the number has {} digits")
    return flint.fmpz(digits)


def _chain(tree: Node) -> tuple[Node, list[tuple[str, Node]]]:
    """The first operand of a chain of + - * /, which may be very long, and the (operator, operand) pairs after it."""
    steps: list[tuple[str, Node]] = []
    while isinstance(tree, Operation) and len(tree.operands) == 2 and tree.operator != "**":
        steps.append((tree.operator, tree.operands[1]))
        tree = tree.operands[0]
    return tree, steps[::-1]


def sqrt_arguments(tree: Node) -> list[Node]:
    """List of the arguments of all ``sqrt`` in a tree, innermost first."""
    first, steps = _chain(tree)
    if steps:
        return [node for operand in (first, *(right for _, right in steps)) for node in sqrt_arguments(operand)]
    match tree:
        case Call(_, argument):
            return [*sqrt_arguments(argument), argument]
        case Operation(_, operands):
            return [node for operand in operands for node in sqrt_arguments(operand)]
    return []


def evaluate(
    tree: Node, number: Callable[[Any], Any], names: Mapping[str, Any], functions: Mapping[str, Callable[[Any], Any]]
) -> Any:
    """The value of a tree, computed with objects that have Python arithmetic."""
    first, steps = _chain(tree)
    if steps:
        total = evaluate(first, number, names, functions)
        for operator, right in steps:
            total = _combined(operator, total, evaluate(right, number, names, functions))
        return total
    match tree:
        case Number(value):
            return number(value)
        case Name(name):
            return names[name]
        case Call(function, argument):
            return functions[function](evaluate(argument, number, names, functions))
        case Operation("**", (base, exponent)):
            return _power(evaluate(base, number, names, functions), _integer_exponent(exponent))
        case Operation(_, operands):
            return -evaluate(operands[0], number, names, functions)


def _combined(operator: str, left: Any, right: Any) -> Any:
    in_time()
    try:
        return checked_size(_ARITHMETIC[operator](left, right))
    except ZeroDivisionError:
        raise ParseError("division by zero in a value") from None


def _power(base: Any, exponent: int) -> Any:
    """The power by repeated squaring, so that no intermediate result is much larger than the limit."""
    if exponent == 0:
        return base**0
    if exponent < 0 and base == 0:
        raise ParseError("a negative power of zero in a value")
    power: Any = None
    square, left = base, abs(exponent)
    while left:
        if left & 1:
            power = square if power is None else checked_size(power * square)
        left >>= 1
        square = checked_size(square * square) if left else square
    return power if exponent > 0 else 1 / power


def checked_size(value: T) -> T:
    """The value; `LimitError` if it is an exact number of more digits than the limit allows."""
    if isinstance(value, flint.fmpq):
        digits_within(max(value.p.bit_length(), value.q.bit_length()))
    elif hasattr(value, "bit_length"):
        digits_within(value.bit_length())
    return value


def _bits(tree: Node) -> int:
    """Upper bound for the bits of the value: towers of powers are rejected before they are computed."""
    first, steps = _chain(tree)
    if steps:
        return _bits(first) + sum(_bits(right) for _, right in steps)
    match tree:
        case Number(value):
            return int(value.bit_length()) + 1
        case Name():
            return 64
        case Call(_, argument):
            return _bits(argument)
        case Operation("**", (base, exponent)):
            return _bits(base) * max(1, abs(_integer_exponent(exponent)))
    return _bits(tree.operands[0])


def _integer_exponent(tree: Node) -> int:
    match tree:
        case Number(value) | Operation("neg", (Number(value),)):
            within("exponent", int(value), "an exponent is {}")
            return int(value) if isinstance(tree, Number) else -int(value)
    raise ParseError("an exponent must be an integer")
