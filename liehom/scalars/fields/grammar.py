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
from typing import Any

import flint

from liehom.errors import ParseError

MAX_DEPTH = 100
MAX_EXPONENT = 4096
MAX_BITS = 10**8
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
        self.text, self.names, self.functions = text, names, functions
        self.tokens = self._tokenize(text)
        self.position = 0

    def _tokenize(self, text: str) -> list[str]:
        tokens, start, stripped = [], 0, text.rstrip()
        while start < len(stripped):
            found = _TOKEN.match(stripped, start)
            if found is None:
                raise self.error(f"unexpected character {stripped[start]!r}")
            tokens.append(found.group().strip())
            start = found.end()
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
        if depth > MAX_DEPTH:
            raise self.error(f"parentheses or signs nested deeper than {MAX_DEPTH}")
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
        if depth > MAX_DEPTH:
            raise self.error(f"parentheses or signs nested deeper than {MAX_DEPTH}")
        if self.token == "-":
            self.take()
            return Operation("neg", (self.unary(depth + 1),))
        if self.token == "+":
            self.take()
            return self.unary(depth + 1)
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
            return Number(flint.fmpz(token))
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
    """The tree of a value.

    Parameters
    ----------
    text : str
        The value.
    names, functions : collection of str
        The allowed names and one-argument functions.

    Returns
    -------
    Node
        The tree.

    Raises
    ------
    ParseError
        If the string is not in the grammar; the message says where and why.

    Examples
    --------
    >>> parse("1/2")
    Operation(operator='/', operands=(Number(value=1), Number(value=2)))
    >>> parse("__import__('os')")
    Traceback (most recent call last):
    ...
    liehom.errors.ParseError: "__import__('os')" is not a value: unexpected character "'"; ...
    """
    parser = _Parser(text, names, functions)
    tree = parser.expression(0)
    if parser.token:
        raise parser.error(f"unexpected {parser.token!r}")
    if _bits(tree) > MAX_BITS:
        raise parser.error("its powers make a number too large to hold")
    return tree


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
        return [found for operand in (first, *(right for _, right in steps)) for found in sqrt_arguments(operand)]
    match tree:
        case Call(_, argument):
            return [*sqrt_arguments(argument), argument]
        case Operation(_, operands):
            return [found for operand in operands for found in sqrt_arguments(operand)]
    return []


def evaluate(
    tree: Node,
    number: Callable[[Any], Any],
    names: Mapping[str, Any],
    functions: Mapping[str, Callable[[Any], Any]],
) -> Any:
    """The value of a tree, computed with objects that have Python arithmetic.

    Parameters
    ----------
    tree : Node
        As returned by `parse`.
    number : callable
        Converts an integer (``flint.fmpz``) to an object.
    names, functions : mapping
        The values of the names and functions.

    Raises
    ------
    ParseError
        On division by zero, and for exponents that are not integers or too large.

    Examples
    --------
    >>> import flint
    >>> evaluate(parse("2**3 - 1/2"), flint.fmpq, {}, {})
    15/2
    """
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
    match operator:
        case "+":
            return left + right
        case "-":
            return left - right
        case "*":
            return left * right
    try:
        return left / right
    except ZeroDivisionError:
        raise ParseError("division by zero in a value") from None


def _power(base: Any, exponent: int) -> Any:
    try:
        return base**exponent
    except ZeroDivisionError:
        raise ParseError("a negative power of zero in a value") from None


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
        case Number(value) if value <= MAX_EXPONENT:
            return int(value)
        case Operation("neg", (Number(value),)) if value <= MAX_EXPONENT:
            return -int(value)
    raise ParseError(f"an exponent must be an integer between -{MAX_EXPONENT} and {MAX_EXPONENT}")
