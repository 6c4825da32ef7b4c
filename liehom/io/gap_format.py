"""Structure constant tables of GAP, where indices count from 1.

    T := EmptySCTable( 3, 0, "antisymmetric" );;
    SetEntrySCTable( T, 1, 2, [ 1, 3 ] );;                     [e_1, e_2] = 1 e_3
    L := LieAlgebraByStructureConstants( Rationals, T );;

GAP prints a table as a list of n rows of n entries [ [ indices ], [ coefficients ] ], followed by the flag -1
(antisymmetric) and the zero 0. `from_gap` reads statements and printed tables with a parser that executes nothing.
"""

from __future__ import annotations

import re
from typing import Any, NoReturn, TypeAlias

from liehom.algebra import LieAlgebra
from liehom.budget import within
from liehom.errors import FormatError
from liehom.io.json_reader import shown
from liehom.scalars import QQ, Scalar

MAX_DEPTH = 8
"""Nesting of the deepest list that is read."""
IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z_0-9]*", re.ASCII)
_TOKEN = re.compile(
    r"""\s*(?:(?P<text>"(?:[^"\\]|\\.)*")|(?P<number>[+-]?[0-9]+(?:/[0-9]+)?)|(?P<name>[A-Za-z_][A-Za-z_0-9.]*)"""
    r"""|(?P<mark>:=|\.\.|[][(),;]))""",
    re.ASCII,
)
_COMMENT = re.compile(r'("(?:[^"\\\n]|\\.)*")|#[^\n]*')

Table: TypeAlias = dict[tuple[int, int], dict[int, Scalar]]
Value: TypeAlias = Any
"""Value of an expression of GAP: a number of QQ, a string, a list, a field or a table."""


def to_gap(algebra: LieAlgebra, name: str = "L") -> str:
    """GAP code that defines an algebra as a variable.

    Parameters
    ----------
    algebra : LieAlgebra
        Over QQ.
    name : str
        Name of the variable; the table gets the name `name` + "_T".

    Returns
    -------
    str
        Statements of GAP. The basis elements have the names `algebra.basis_names`.

    Raises
    ------
    FormatError
        If the algebra is over a number field or float64, or the name is not an identifier.

    Examples
    --------
    >>> import liehom as lh
    >>> print(to_gap(lh.heisenberg(1)), end="")
    L_T := EmptySCTable( 3, 0, "antisymmetric" );;
    SetEntrySCTable( L_T, 1, 2, [ 1, 3 ] );;
    L := LieAlgebraByStructureConstants( Rationals, L_T, [ "x1", "y1", "z" ] );;
    """
    require_rational(algebra, "GAP")
    if not isinstance(name, str) or not IDENTIFIER.fullmatch(name):
        raise FormatError(f"the name of a variable is {shown(name)}, expected letters and digits such as 'L'")
    brackets: dict[tuple[int, int], list[str]] = {}
    for i, j, k, value in algebra.structure_constants():
        brackets.setdefault((i, j), []).append(f"{value}, {k + 1}")
    lines = [f'{name}_T := EmptySCTable( {algebra.dimension}, 0, "antisymmetric" );;']
    for (i, j), terms in brackets.items():
        lines.append(f"SetEntrySCTable( {name}_T, {i + 1}, {j + 1}, [ {', '.join(terms)} ] );;")
    names = ", ".join(map(_quoted, algebra.basis_names))
    lines.append(f"{name} := LieAlgebraByStructureConstants( Rationals, {name}_T, [ {names} ] );;")
    return "\n".join(lines) + "\n"


def from_gap(text: str, *, name: str | None = None) -> LieAlgebra:
    """Lie algebra of a structure constant table of GAP, after a proof of the axioms (GAP does not check them).

    Parameters
    ----------
    text : str
        The nested list that GAP prints for ``StructureConstantsTable( Basis( L ) )``, or statements with
        ``EmptySCTable``, ``SetEntrySCTable`` and ``LieAlgebraByStructureConstants`` such as `to_gap` writes.
    name : str, optional
        Name of the algebra.

    Raises
    ------
    FormatError
        If the string is neither of these; shows the part that could not be read.
    StructureError, JacobiError
        If the table is not antisymmetric, or the Jacobi identity fails.

    Examples
    --------
    >>> print(from_gap("[ [ [ [  ], [  ] ], [ [ 2 ], [ 1/2 ] ] ], [ [ [ 2 ], [ -1/2 ] ], [ [  ], [  ] ] ], -1, 0 ]"))
    Lie algebra over QQ, dimension 2
      basis e0, e1
      [e0, e1] = 1/2*e1
    """
    if not isinstance(text, str):
        raise FormatError(f"a table of GAP is a string, got {shown(text)}")
    n, table, names = _Script(text).result()
    return LieAlgebra(table, QQ, dimension=n, basis=names, name=name)


def require_rational(algebra: LieAlgebra, tool: str) -> None:
    """Raise `FormatError` if an algebra is not over QQ: the formats of other tools have rational numbers only."""
    if algebra.field != QQ:
        raise FormatError(
            f"the format of {tool} has rational structure constants, these are over {algebra.field.name}: "
            "write an algebra file with dump, or find a basis over QQ"
        )


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


class _Script:
    """Parser of statements `name := value;` and `Function( ... );`, or of one value, for three functions."""

    def __init__(self, text: str) -> None:
        # GAP breaks long lines inside numbers, with a backslash
        joined = _COMMENT.sub(lambda found: found[1] or "", text.replace("\\\r\n", "").replace("\\\n", ""))
        self.tokens: list[tuple[str, str]] = []
        self.at = self.numbers = 0  # position; how many integers the ranges before it stand for
        self.variables: dict[str, Value] = {}
        self.names: tuple[str, ...] | None = None
        position, end = 0, len(joined.rstrip())
        while position < end:
            match = _TOKEN.match(joined, position)
            if match is None:
                raise FormatError(f"not a table of GAP: {shown(joined[position : position + 20].strip())} is not read")
            self.tokens.append((str(match.lastgroup), match[match.lastgroup or 0]))
            position = match.end()

    def result(self) -> tuple[int, Table, tuple[str, ...] | None]:
        """Dimension, brackets and names of the last table in the string."""
        last: Value = None
        while self.at < len(self.tokens):
            if self.peek(1) == ":=":
                key = self.take("name")
                self.at += 1
                last = self.variables[key] = self.value()
            else:
                last = self.value()
            while self.peek() == ";":
                self.at += 1
        if isinstance(last, list):
            last = _from_lists(last)
        if not isinstance(last, _Table):
            raise FormatError("not a table of GAP: expected the nested list of a StructureConstantsTable")
        return last.dimension, last.complete(), self.names

    # -- tokens ------------------------------------------------------------------------------------------
    def peek(self, ahead: int = 0) -> str:
        """Token `ahead` positions after the current one, or "" after the end."""
        position = self.at + ahead
        return self.tokens[position][1] if position < len(self.tokens) else ""

    def take(self, kind: str) -> str:
        """Current token, which must be of this kind or this string; moves to the next one."""
        found = self.tokens[self.at] if self.at < len(self.tokens) else ("", "the end")
        if found[0] != kind and found[1] != kind:
            raise FormatError(f"not a table of GAP: expected {kind}, found {shown(found[1])}")
        self.at += 1
        return found[1]

    # -- values ------------------------------------------------------------------------------------------
    def value(self, depth: int = 0) -> Value:
        """List, number, string, value of a variable, or value of a call."""
        if depth > MAX_DEPTH:
            raise FormatError("not a table of GAP: its lists are nested too deeply")
        kind, token = self.tokens[self.at] if self.at < len(self.tokens) else ("", "the end")
        if kind == "number":
            self.at += 1
            return _number(token)
        if kind == "text":
            self.at += 1
            return re.sub(r"\\(.)", r"\1", token[1:-1])
        if token == "[":
            return self.list(depth)
        name = self.take("name")
        if self.peek() == "(":
            return self.call(name, depth)
        if name == "Rationals":
            return QQ
        if name not in self.variables:
            raise FormatError(f"not a table of GAP: {shown(name)} is not read; expected rational numbers and lists")
        return self.variables[name]

    def list(self, depth: int) -> list[Value]:
        """List, in which a range [ a .. b ] stands for its integers."""
        self.take("[")
        found: list[Any] = []
        while self.peek() != "]":
            found.append(self.value(depth + 1))
            if self.peek() == "..":
                self.at += 1
                integers = _range(found.pop(), self.value(depth + 1))
                self.numbers += len(integers)
                within("entries", self.numbers, "the ranges of the table stand for {} integers")
                found += integers
            if self.peek() != "]":
                self.take(",")
        self.at += 1
        return found

    def call(self, name: str, depth: int) -> Value:
        """Value of a call of one of the three functions."""
        self.take("(")
        found: list[Any] = []
        while self.peek() != ")":
            found.append(self.value(depth + 1))
            if self.peek() != ")":
                self.take(",")
        self.at += 1
        match name, found:
            case "EmptySCTable", [n, zero] | [n, zero, "antisymmetric"] if zero == 0:
                return _Table(_dimension(n), antisymmetric=len(found) == 3)
            case "SetEntrySCTable", [_Table() as table, i, j, list() as terms]:
                return table.set(i, j, terms[1::2], terms[0::2], len(terms) % 2 == 0)
            case "LieAlgebraByStructureConstants", [field, table, *names]:
                if field is not QQ:
                    raise FormatError("not a table of GAP over the Rationals")
                table = _from_lists(table) if isinstance(table, list) else table
                self.names = _names(names, table)
                return table
        raise FormatError(
            f"not a table of GAP: {name} with {len(found)} arguments is not read; expected EmptySCTable, "
            "SetEntrySCTable or LieAlgebraByStructureConstants, and rational numbers"
        )


class _Table:
    """Brackets of an incomplete table; in an antisymmetric table, setting [e_i, e_j] sets [e_j, e_i] too."""

    def __init__(self, dimension: int, *, antisymmetric: bool = False) -> None:
        self.dimension = dimension
        self.antisymmetric = antisymmetric
        self.brackets: Table = {}

    def complete(self) -> Table:
        """All brackets; a bracket that was not set is 0, or follows by antisymmetry."""
        if not self.antisymmetric:
            for i, j in list(self.brackets):
                self.brackets.setdefault((j, i), {})
        return self.brackets

    def set(self, i: Value, j: Value, indices: Value, coefficients: Value, paired: bool = True) -> _Table:
        """Set [e_i, e_j], with indices from 1; returns the table."""
        where = f"entry ({shown(i)}, {shown(j)})"
        if not (paired and isinstance(indices, list) and isinstance(coefficients, list)):
            raise FormatError(f"{where} of the table is not coefficients with indices")
        if len(indices) != len(coefficients) or len({str(k) for k in indices}) < len(indices):
            raise FormatError(f"{where} of the table has {len(indices)} indices, {len(coefficients)} coefficients")
        x, y, *columns = (self.index(k, where) for k in (i, j, *indices))
        for value in coefficients:
            if not isinstance(value, type(QQ.one)):
                raise FormatError(f"{where} of the table has the coefficient {shown(value)}, expected a number")
        if self.antisymmetric:
            self.brackets.pop((y, x), None)
        self.brackets[x, y] = dict(zip(columns, coefficients, strict=True))
        return self

    def index(self, k: Value, where: str) -> int:
        """Index from 0 for an index from 1."""
        if not isinstance(k, type(QQ.one)) or k.q != 1 or not 1 <= k <= self.dimension:
            raise FormatError(f"{where} of the table: the index {k} is out of range, expected 1 to {self.dimension}")
        return int(k.p) - 1


def _from_lists(rows: list[Value]) -> _Table:
    """Table from the nested list: n rows, the flag of symmetry, zero."""
    n = len(rows) - 2
    if n < 0 or isinstance(rows[-2], list) or isinstance(rows[-1], list):
        raise FormatError("a table of GAP ends with the flag -1 and the zero 0 after its rows")
    if rows[-2] == 1:
        raise FormatError("the table is symmetric (flag 1): not one of a Lie algebra")
    table = _Table(_dimension(QQ.convert(n)))
    for i, row in enumerate(rows[:-2], start=1):
        if not isinstance(row, list) or len(row) != n:
            raise FormatError(f"row {i} of the table must have {n} entries, as there are rows")
        for j, entry in enumerate(row, start=1):
            if not isinstance(entry, list) or len(entry) != 2:
                raise FormatError(f"entry ({i}, {j}) of the table is not [ [ indices ], [ coefficients ] ]")
            table.set(QQ.convert(i), QQ.convert(j), *entry)
    return table


def _dimension(n: Value) -> int:
    if not isinstance(n, type(QQ.one)) or n.q != 1 or n < 0:
        raise FormatError(f"the dimension of the table is {shown(n)}, expected an integer from 0")
    within("dimension", int(n.p), "the dimension of the table is {}")
    return int(n.p)


def _number(token: str) -> Scalar:
    bottom = token.partition("/")[2]
    if bottom and not bottom.strip("0"):
        _refuse(f"the number {token} has the denominator 0")
    return QQ.convert(token.lstrip("+"))


def _range(first: Value, last: Value) -> list[Value]:
    if any(not isinstance(x, type(QQ.one)) or x.q != 1 for x in (first, last)):
        _refuse("a range [ a .. b ] needs two integers")
    within("dimension", int((last - first).p), "a range has {} integers")
    return [QQ.convert(k) for k in range(int(first.p), int(last.p) + 1)]


def _names(given: list[Value], table: Value) -> tuple[str, ...] | None:
    """Names of basis elements from a list or from separate strings; a single string is a prefix."""
    if not isinstance(table, _Table):
        _refuse("LieAlgebraByStructureConstants needs a table")
    names = given[0] if len(given) == 1 and isinstance(given[0], list) else given
    if len(names) == 1 and table.dimension != 1 and isinstance(names[0], str):
        names = [f"{names[0]}{k + 1}" for k in range(table.dimension)]
    if not names:
        return None
    if len(names) != table.dimension or not all(isinstance(x, str) for x in names):
        _refuse(f"the names {shown(names)} are not strings, one for each of {table.dimension} basis elements")
    return tuple(names)


def _refuse(what: str) -> NoReturn:
    raise FormatError(f"not a table of GAP: {what}")
