"""The grammar of catalogue names: from strings to trees and back.

    pair    =  sum '/' sum  |  term                 so(4)/so(3), sp(3)/sp(2)+sp(1), affine(g2), sym(4;3,1), CP^3
    sum     =  power { ('+' | 'x' | '') power }       ('' after ')' only: Sp(2)Sp(1))
    power   =  term [ '^' digits ]                  Sp(1)^3 for sp(1)+sp(1)+sp(1)
    term    =  head [ '(' items [ ';' values ] ')' ]  |  'A' digit ',' digits [ '(' values ')' ]
    items   =  item { ',' item },   item = value | sum
    values  =  value { ',' value }
    value   =  integer  |  integer '/' integer         (a fraction only in spiral, sqrt, bianchi and A4,2)
    head    =  letters and digits, perhaps a final '*'  |  '0' (not as an item: there it is a number)
            |  letters '^' digits                   R^3, the torus T^2, spaces such as S^4
            |  'P{' digits { ',' digits } '}'

Blanks are ignored, and capitals are not distinguished. Printing a tree and parsing the string gives the same tree.
`parse` drops parameters that are the default, so 'sl(3,R)' prints as 'sl(3)' and 'so(3,0)' as 'so(3)'. It replaces
other spellings: 'schrodinger(3)' prints as 'schroedinger(3)', 'poincare(3)' as 'iso(3,1)', 'SE(3)' as 'e(3)'. The
name of a space is a spelling of the pair that `space_name` says, so 'CP^3' prints as 'su(4)/u(3)'.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from difflib import get_close_matches
from fractions import Fraction
from itertools import pairwise
from math import gcd
from typing import TypeAlias, TypeVar, final

from liehom.base.budget import small_integer, within
from liehom.base.errors import CatalogError, displayed, shown
from liehom.exact.algebra.linear.named_matrices import CLASSICAL_KINDS, SPELLINGS

T = TypeVar("T")

MAX_LIKENESS = 100
"""Characters of the longest name to which similar names are looked for."""
_CAPITALS = re.compile(r"[RCHQBK]|P\d*|[SL]\d+|A\d|[IVX]+", re.IGNORECASE)
_TYPE = re.compile(r"\s*[A-G]\d{1,2}\s*", re.ASCII)
_TIMES = re.compile(r"(?<=[)\s])[xX](?=[A-Za-z\s])|[×⊕]")
_TOKEN = re.compile(r"\s*(?:([A-Za-z]*\^\d+|[Pp]\{[\d\s,]*\})|([A-Za-z]\w*\*?)|(-?\d+)|([/+(),;]))")


@final
@dataclass(frozen=True, slots=True)
class Term:
    """A head and its parameters, ``so(3,1)``, ``g2``, ``sym(4;3,1)``; in `after` those after ";" or as in A4,2(1/2)."""

    head: str
    items: tuple[Item, ...] = ()
    after: tuple[Value, ...] = ()

    def __str__(self) -> str:
        between = "/" if self.head == "dual" and len(self.items) == 2 else ","  # dual(so(3,1)/so(3))
        parts = [by.join(map(str, part)) for by, part in ((between, self.items), (",", self.after)) if part]
        return f"{self.head}({';'.join(parts)})" if parts else self.head

    def integers(self) -> tuple[int, ...]:
        """The parameters as integers; raises `CatalogError` if one is not an integer."""
        values = tuple(x for x in self.items if isinstance(x, int))
        if len(values) != len(self.items):
            raise CatalogError(f"the parameters of {self} must be integers")
        return values


@final
@dataclass(frozen=True, slots=True)
class Sum:
    """Two or more terms: ``sp(2)+sp(1)``."""

    terms: tuple[Term, ...]

    def __str__(self) -> str:
        return "+".join(map(str, self.terms))


@final
@dataclass(frozen=True, slots=True)
class Quotient:
    """An algebra and a subalgebra: ``so(4)/so(3)``."""

    top: Expression
    bottom: Expression

    def __str__(self) -> str:
        return f"{self.top}/{self.bottom}"


Value: TypeAlias = int | Fraction
Expression: TypeAlias = Term | Sum
Item: TypeAlias = int | Fraction | Term | Sum
Name: TypeAlias = Term | Sum | Quotient


def parse(name: str) -> Name:
    """The tree of a catalogue name: a `Term`, `Sum` or `Quotient`.

    Raises
    ------
    CatalogError
        If the string does not follow the grammar; the message gives the position.

    Examples
    --------
    >>> str(parse("so(4, 0) / so(3)"))
    'so(4)/so(3)'
    >>> parse("g2/su(3")
    Traceback (most recent call last):
    ...
    liehom.base.errors.CatalogError: 'g2/su(3' is not a name of the catalogue: expected ')' at position 7
    """
    if not isinstance(name, str):
        raise CatalogError(f"a name is a string such as 'so(4)/so(3)', got {displayed(name)}")
    within("characters", len(name), "the name has {} characters")
    return _Parser(name).name()


def parse_expression(name: str) -> Expression:
    """The tree of a catalogue name without '/': a `Term` or `Sum`."""
    tree = parse(name)
    if isinstance(tree, Quotient):
        raise CatalogError(f"{shown(name)!r} is the name of a pair, not of an algebra")
    if _TYPE.fullmatch(name):
        read = f"read as a type by lh.simple({name.strip()!r})"
        raise CatalogError(f"{name.strip()!r} is {read}, not here; names are such as g2, so(3,2), A4,1")
    return tree


def terms(tree: Expression) -> tuple[Term, ...]:
    """The summands of an expression; for a term, the term alone."""
    return tree.terms if isinstance(tree, Sum) else (tree,)


def unknown(name: str, known: Iterable[str], kind: str) -> CatalogError:
    """The error for a name that follows the grammar but denotes nothing, with the nearest known names."""
    by_folded = {other.casefold(): other for other in known}
    close = get_close_matches(name.casefold(), by_folded, n=3, cutoff=0.5) if len(name) <= MAX_LIKENESS else ()
    near = [by_folded[other] for other in close]
    hint = f"; the nearest are {', '.join(near)}" if near else ""
    article = "an" if kind[0] in "aeiou" else "a"
    return CatalogError(f"{shown(name)!r} is not the name of {article} {kind} in the catalogue{hint}")


def canonical(term: Term) -> Term:
    """The term in its usual spelling, without a second parameter that is the default."""
    if term.head in SPELLINGS:
        added = (1,) if term.head == "poincare" and len(term.items) == 1 else ()
        return canonical(Term(SPELLINGS[term.head], term.items + added, term.after))
    if len(term.items) == 1 and isinstance(size := term.items[0], int) and not term.after:
        if term.head == "abelian":
            return flat(size)
        if term.head in ("affine", "iso"):
            return Term({"affine": "aff", "iso": "e"}[term.head], term.items)
    if len(term.items) == 2 and not term.after:
        silent: Item = Term("R") if term.head in ("gl", "sl") else 0
        if term.items[1] == silent and term.head in CLASSICAL_KINDS:
            return Term(term.head, term.items[:1])
    return term


def flat(n: int) -> Term:
    """The term of R^n."""
    return Term("0" if n == 0 else "R" if n == 1 else f"R^{n}")


# Spaces by the names that geometers write: each is a spelling of a pair. RP^n and oriented and unoriented Grassmannians
# have the pairs of their coverings.

_POWERS = {
    "S": "so({1})/so({0})", "RP": "so({1})/so({0})", "CP": "su({1})/u({0})", "HP": "sp({1})/sp({0})+sp(1)",
    "H": "so({0},1)/so({0})", "RH": "so({0},1)/so({0})", "CH": "su({0},1)/u({0})", "HH": "sp({0},1)/sp({0})+sp(1)",
    "DS": "so({0},1)/so({2},1)", "ADS": "so({2},2)/so({2},1)", "E": "e({0})/so({0})", "T": "R^{0}/0",
}  # fmt: skip
_SINGLE = {
    "OP^2": "f4/spin(9)", "OH^2": "f4(-20)/spin(9)",
    "W^6": "su(3)/T^2", "W^12": "sp(3)/sp(1)+sp(1)+sp(1)", "W^24": "f4/spin(8)",
}  # fmt: skip
_FAMILIES = {"gr": "Gr(2,5), Gr(2,C^5)", "v": "V(2,5), V(2,H^3)", "fl": "Fl(1,2;C^3)", "w": "W(1,2)"}


def space_name(term: Term) -> str | None:
    """The name of the pair that the name of a space denotes, such as S^4 or Gr(2,C^4); None for other names."""
    letters, _, digits = term.head.partition("^")
    if not term.items and digits:
        if term.head in _SINGLE:
            return _SINGLE[term.head]
        n = small_integer(digits)
        if letters not in _POWERS or n < (2 if letters in ("DS", "ADS") else 1):
            return None
        return _POWERS[letters].format(n, n + 1, n - 1)
    family, _, index = term.head.lower().partition("_")
    if family not in _FAMILIES or term.after or (index and not index.isdecimal()):
        return None
    items = ((small_integer(index),) if index else ()) + term.items
    numbers = [x for x in items if isinstance(x, int)]
    if family == "w":
        if len(numbers) == len(items) == 2 and any(numbers):
            k, l = (x // gcd(*numbers) for x in numbers)
            return f"su(3)/u(1;{k},{l},{-k - l})"
    elif items and (text := _subspaces(family, numbers, items[-1], len(items))) is not None:
        return text
    raise CatalogError(f"{term} is not the name of a space; such names are {_FAMILIES[family]}")


def _subspaces(family: str, numbers: list[int], last: Item, count: int) -> str | None:
    """Flags, Grassmannians and Stiefel manifolds of subspaces or frames of the given dimensions in K^n."""
    letter, _, digits = ("R", "", str(last)) if isinstance(last, int) else str(last).partition("^")
    n = small_integer(digits) if digits.isdecimal() else 1
    numbers = numbers[: count - 1]
    if len(numbers) != count - 1 or letter not in ("R", "C", "H") or (family != "fl" and count != 2):
        return None
    ends = [0, *numbers, n + (family == "v")]  # an orthonormal frame may be a basis
    if any(a >= b for a, b in pairwise(ends)):
        return None
    ends[-1] = n
    head, inner = {"R": ("so", "so"), "C": ("su", "u"), "H": ("sp", "sp")}[letter]
    sizes = [b - a for a, b in pairwise(ends)]
    if family == "v":
        rest = f"{head}({sizes[-1]})" if sizes[-1] > (letter != "H") else "0"
        return f"{'u' if letter == 'C' and not sizes[-1] else head}({n})/{rest}"
    blocks = [f"{inner}({size})" for size in sizes if letter != "R" or size > 1]
    total = "+".join(blocks) or "0"
    return f"{head}({n})/{f's({total})' if letter == 'C' else total}"


class _Parser:
    """Recursive descent over the tokens of one string."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens: list[tuple[str, int]] = []
        self.at = self.depth = 0
        position = 0
        text = _TIMES.sub("+", text)
        while text[position:].strip():
            match = _TOKEN.match(text, position)
            if match is None:
                skipped = len(text[position:]) - len(text[position:].lstrip())
                raise self.error(f"unexpected {text[position + skipped]!r}", position + skipped)
            self.tokens.append((match[0].strip(), match.end() - len(match[0].strip())))
            position = match.end()

    def error(self, what: str, position: int) -> CatalogError:
        return CatalogError(f"{shown(self.text)!r} is not a name of the catalogue: {what} at position {position}")

    def peek(self) -> str:
        return self.tokens[self.at][0] if self.at < len(self.tokens) else ""

    def position(self) -> int:
        return self.tokens[self.at][1] if self.at < len(self.tokens) else len(self.text)

    def accept(self, token: str) -> bool:
        accepted = self.peek() == token
        self.at += accepted
        return accepted

    def expect(self, token: str) -> None:
        if not self.accept(token):
            raise self.error(f"expected {token!r}", self.position())

    def separated(self, read: Callable[[], T], by: str = ",") -> tuple[T, ...]:
        values = [read()]
        while self.accept(by):
            values.append(read())
        return tuple(values)

    def name(self) -> Name:
        top = self.sum()
        tree: Name = Quotient(top, self.sum()) if self.accept("/") else top
        if self.peek():
            raise self.error(f"unexpected {self.peek()!r}", self.position())
        spelled = space_name(tree) if isinstance(tree, Term) else None
        return tree if spelled is None else parse(spelled)

    def sum(self) -> Expression:
        summands = [*self.power()]
        while self.accept("+") or (self.peek()[:1].isalpha() and self.follows_a_factor()):
            summands += self.power()
        return Sum(tuple(summands)) if len(summands) > 1 else summands[0]

    def follows_a_factor(self) -> bool:
        """Whether the token directly follows ')' or an exponent."""
        last, start = self.tokens[self.at - 1]
        return last[0] in ")^" and start + len(last) == self.position()

    def power(self) -> tuple[Term, ...]:
        """A term, or several equal ones as in Sp(1)^3."""
        term, exponent = self.term(), self.peek()
        if not exponent.startswith("^"):
            return (term,)
        if (number := small_integer(exponent[1:])) < 1:
            raise self.error("expected a positive number of factors", self.position())
        within("characters", number * len(str(term)), "the sum has {} characters")
        self.at += 1
        return (term,) * number

    def term(self) -> Term:
        head = self.peek()
        head = head.upper() if _CAPITALS.fullmatch(head) or head[1:2] == "{" or "^" in head else head.lower()
        if head == "0":
            self.at += 1
            return Term("0")
        if not head[:1].isalpha():
            raise self.error("expected a name such as so(3)", self.position())
        self.at += 1
        if "^" in head:
            letters, _, digits = head.partition("^")
            n = small_integer(digits)
            circle = letters == "S" and n == 1 and len(self.tokens) > 1
            return flat(n) if letters == "R" else Term("u", (1,)) if circle else Term(f"{letters}^{n}")
        if re.fullmatch(r"A\d", head) and self.accept(","):
            return self.numbered(head)
        if head.startswith("P{"):
            return self.parabolic(head)
        if not self.accept("("):
            return Term(head)
        self.depth += 1
        within("nesting", self.depth, "the parentheses of the name are nested {} deep")
        fractions = head in ("spiral", "sqrt")
        items = self.separated(lambda: self.item(fractions))
        if (head == "dual" and self.accept("/")) or (head == "fl" and self.accept(";")):
            items += (self.item(fractions),)
        after = self.values(fractions=head == "bianchi") if self.accept(";") else ()
        self.expect(")")
        self.depth -= 1
        return canonical(Term(head, items, after))

    def parabolic(self, head: str) -> Term:
        """A name such as P{1,6}, with the numbers in order."""
        numbers = [number.strip() for number in head[2:-1].split(",")]
        if not all(map(str.isdigit, numbers)):
            raise self.error("expected numbers of nodes as in P{1,6}", self.tokens[self.at - 1][1])
        return Term(f"P{{{','.join(map(str, sorted(set(map(small_integer, numbers)))))}}}")

    def numbered(self, head: str) -> Term:
        """A name such as A4,2(1/2) after its first comma."""
        name = f"{head},{self.integer()}"
        if not self.accept("("):
            return Term(name)
        values = self.values(fractions=True)
        self.expect(")")
        return Term(name, (), values)

    def values(self, *, fractions: bool) -> tuple[Value, ...]:
        return self.separated(lambda: self.value(fractions))

    def value(self, fractions: bool) -> Value:
        top = self.integer()
        if not (fractions and self.accept("/")):
            return top
        position, bottom = self.position(), self.integer()
        if bottom <= 0:
            raise self.error("expected a positive denominator", position)
        value = Fraction(top, bottom)
        return value if value.denominator > 1 else int(value)

    def item(self, fractions: bool) -> Item:
        return self.value(fractions) if self.peek().lstrip("-").isdigit() else self.sum()

    def integer(self) -> int:
        token = self.peek()
        if not token.lstrip("-").isdigit():
            raise self.error("expected an integer", self.position())
        self.at += 1
        return small_integer(token)
