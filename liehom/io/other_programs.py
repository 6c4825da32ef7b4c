"""Formats of GAP, Sage and sympy."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NoReturn, TypeAlias

from liehom.base.budget import within
from liehom.base.errors import FieldError, FormatError, InputError, ParseError
from liehom.base.typing import ScalarLike
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.representations.core.representation import Representation
from liehom.exact.scalars.complex_parts import sympy_number
from liehom.exact.scalars.exact_field import ExactMatrix
from liehom.exact.scalars.field import Matrix, Scalar
from liehom.exact.scalars.floating import FloatMatrix
from liehom.exact.scalars.function_field import RationalFunction
from liehom.exact.scalars.grammar import evaluate, parse
from liehom.exact.scalars.number_fields import AlgebraicNumber
from liehom.exact.scalars.rational import QQ
from liehom.io.json_reader import shown

# Structure constant tables of GAP, where indices count from 1.
#     T := EmptySCTable( 3, 0, "antisymmetric" );;
#     SetEntrySCTable( T, 1, 2, [ 1, 3 ] );;                     [e_1, e_2] = 1 e_3
#     L := LieAlgebraByStructureConstants( Rationals, T );;
# GAP prints a table as a list of n rows of n entries [ [ indices ], [ coefficients ] ], followed by the flag -1
# (antisymmetric) and the zero 0. `from_gap` reads statements and printed tables with a parser that executes nothing.

MAX_DEPTH = 8  # Nesting of the deepest list that is read
IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z_0-9]*", re.ASCII)
_TOKEN = re.compile(
    r"""\s*(?:(?P<text>"(?:[^"\\]|\\.)*")|(?P<number>[+-]?[0-9]+(?:/[0-9]+)?)|(?P<name>[A-Za-z_][A-Za-z_0-9.]*)"""
    r"""|(?P<mark>:=|\.\.|[][(),;]))""",
    re.ASCII,
)
_COMMENT = re.compile(r'("(?:[^"\\\n]|\\.)*")|#[^\n]*')

Table: TypeAlias = dict[tuple[int, int], dict[int, Scalar]]
Value: TypeAlias = Any  # Value of an expression of GAP: a number of QQ, a string, a list, a field or a table


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
    entries = (
        f"SetEntrySCTable( {name}_T, {i + 1}, {j + 1}, [ {', '.join(terms)} ] );;\n"
        for (i, j), terms in brackets.items()
    )
    return (
        f'{name}_T := EmptySCTable( {algebra.dimension}, 0, "antisymmetric" );;\n{"".join(entries)}'
        f"{name} := LieAlgebraByStructureConstants( Rationals, {name}_T, "
        f"[ {', '.join(map(_quoted, algebra.basis_names))} ] );;\n"
    )


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
        token = self.tokens[self.at] if self.at < len(self.tokens) else ("", "the end")
        if token[0] != kind and token[1] != kind:
            raise FormatError(f"not a table of GAP: expected {kind}, found {shown(token[1])}")
        self.at += 1
        return token[1]

    # -- values ------------------------------------------------------------------------------------------
    def value(self, depth: int = 0) -> Value:
        """List, number, string, value of a variable, or value of a call."""
        if depth > MAX_DEPTH:
            raise FormatError("not a table of GAP: its lists are nested too deeply")
        kind, token = self.tokens[self.at] if self.at < len(self.tokens) else ("", "the end")
        if kind == "number":
            self.at += 1
            return _gap_number(token)
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
        values: list[Any] = []
        while self.peek() != "]":
            values.append(self.value(depth + 1))
            if self.peek() == "..":
                self.at += 1
                integers = _range(values.pop(), self.value(depth + 1))
                self.numbers += len(integers)
                within("entries", self.numbers, "the ranges of the table stand for {} integers")
                values += integers
            if self.peek() != "]":
                self.take(",")
        self.at += 1
        return values

    def call(self, name: str, depth: int) -> Value:
        """Value of a call of one of the three functions."""
        self.take("(")
        values: list[Any] = []
        while self.peek() != ")":
            values.append(self.value(depth + 1))
            if self.peek() != ")":
                self.take(",")
        self.at += 1
        match name, values:
            case "EmptySCTable", [n, zero] | [n, zero, "antisymmetric"] if zero == 0:
                return _Table(_dimension(n), antisymmetric=len(values) == 3)
            case "SetEntrySCTable", [_Table() as table, i, j, list() as terms]:
                return table.set(i, j, terms[1::2], terms[0::2], len(terms) % 2 == 0)
            case "LieAlgebraByStructureConstants", [field, table, *names]:
                if field is not QQ:
                    raise FormatError("not a table of GAP over the Rationals")
                table = _from_lists(table) if isinstance(table, list) else table
                self.names = _gap_names(names, table)
                return table
        raise FormatError(
            f"not a table of GAP: {name} with {len(values)} arguments is not read; expected EmptySCTable, "
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


def _gap_number(token: str) -> Scalar:
    bottom = token.partition("/")[2]
    if bottom and not bottom.strip("0"):
        _refuse_gap(f"the number {token} has the denominator 0")
    return QQ.convert(token.lstrip("+"))


def _range(first: Value, last: Value) -> list[Value]:
    if any(not isinstance(x, type(QQ.one)) or x.q != 1 for x in (first, last)):
        _refuse_gap("a range [ a .. b ] needs two integers")
    within("dimension", int((last - first).p), "a range has {} integers")
    return [QQ.convert(k) for k in range(int(first.p), int(last.p) + 1)]


def _gap_names(strings: list[Value], table: Value) -> tuple[str, ...] | None:
    """Names of basis elements from a list or from separate strings; a single string is a prefix."""
    if not isinstance(table, _Table):
        _refuse_gap("LieAlgebraByStructureConstants needs a table")
    names = strings[0] if len(strings) == 1 and isinstance(strings[0], list) else strings
    if len(names) == 1 and table.dimension != 1 and isinstance(names[0], str):
        names = [f"{names[0]}{k + 1}" for k in range(table.dimension)]
    if not names:
        return None
    if len(names) != table.dimension or not all(isinstance(x, str) for x in names):
        _refuse_gap(f"the names {shown(names)} are not strings, one for each of {table.dimension} basis elements")
    return tuple(names)


def _refuse_gap(what: str) -> NoReturn:
    raise FormatError(f"not a table of GAP: {what}")


# Structure constants in the notation of Sage: dictionaries of brackets, indexed by names.
#     L = LieAlgebra(QQ, {('x', 'y'): {'z': 1}}, names=('x', 'y', 'z'))            [x, y] = z
# `from_sage` reads such dictionaries and calls, and the output of ``L.structure_coefficients()`` in Sage, with a parser
# that executes nothing.

WORD = re.compile(r"[A-Za-z_]\w*", re.ASCII)
VARIABLE = re.compile(r"[A-Za-z][A-Za-z_0-9]*", re.ASCII)
_GENERATORS = re.compile(r"\s*([A-Za-z_]\w*)\s*\.<([^<>=]*)>\s*=(.*)", re.ASCII | re.DOTALL)
_FAMILY = re.compile(r"\s*Finite family\s+(\{.*)", re.ASCII | re.DOTALL)
MAX_LENGTH = 50_000_000  # Characters of the longest string that is read

Brackets: TypeAlias = dict[tuple[str, str], dict[str, Scalar]]


def to_sage(algebra: LieAlgebra, name: str = "L") -> str:
    """Sage statement that defines an algebra as a variable.

    Parameters
    ----------
    algebra : LieAlgebra
        Over QQ.
    name : str
        Name of the variable.

    Returns
    -------
    str
        Basis elements have the names `algebra.basis_names` if Sage accepts all of them, else e0, e1, ....

    Raises
    ------
    FormatError
        If the algebra is over a number field or float64, or the name is not an identifier.

    Examples
    --------
    >>> import liehom as lh
    >>> print(to_sage(lh.heisenberg(1)), end="")
    L = LieAlgebra(QQ, {
        ('x1', 'y1'): {'z': 1},
    }, names=('x1', 'y1', 'z'))
    """
    require_rational(algebra, "Sage")
    if not isinstance(name, str) or not VARIABLE.fullmatch(name):
        raise FormatError(f"the name of a variable is {shown(name)}, expected letters and digits such as 'L'")
    names = algebra.basis_names
    if not all(VARIABLE.fullmatch(x) for x in names):
        names = tuple(f"e{i}" for i in range(algebra.dimension))
    brackets: dict[tuple[int, int], list[str]] = {}
    for i, j, k, value in algebra.structure_constants():
        brackets.setdefault((i, j), []).append(f"{names[k]!r}: {value}")
    if not brackets:
        return f"{name} = LieAlgebra(QQ, abelian=True, names={names!r})\n"
    lines = [f"    ({names[i]!r}, {names[j]!r}): {{{', '.join(terms)}}},\n" for (i, j), terms in brackets.items()]
    return f"{name} = LieAlgebra(QQ, {{\n{''.join(lines)}}}, names={names!r})\n"


def from_sage(
    text: str | Mapping[object, object], names: Sequence[str] | str | None = None, *, name: str | None = None
) -> LieAlgebra:
    """Lie algebra of a dictionary of brackets in Sage, after a proof of the axioms (Sage does not check them).

    Parameters
    ----------
    text : str or mapping
        ``{('x', 'y'): {'z': 1}}``, a call of ``LieAlgebra(QQ, ...)`` with such a dictionary, or the output of
        ``L.structure_coefficients()`` in Sage.
    names : sequence of str, or str with commas, optional
        The basis in order; by default the names of the call, else the names in the dictionary in their order there.
        A basis element that occurs in no bracket must be named here.
    name : str, optional
        Name of the algebra.

    Raises
    ------
    FormatError
        If the input is none of these, or a coefficient is not rational.
    StructureError, JacobiError
        If the brackets are not antisymmetric, or the Jacobi identity fails.

    Examples
    --------
    >>> print(from_sage("Finite family {('x', 'y'): z, ('x', 'z'): 2*x - 1/2*z}", names="x,y,z"))
    Traceback (most recent call last):
    ...
    liehom.base.errors.JacobiError: the Jacobi identity fails for (i, j, k) = (0, 1, 2), that is for x, y, z: ...
    >>> from_sage("LieAlgebra(QQ, {('x', 'y'): {'z': 1}}, names='x,y,z')").basis_names
    ('x', 'y', 'z')
    """
    if isinstance(text, str):
        brackets, stated = _parsed(text)
    elif isinstance(text, Mapping):
        brackets, stated = _of_mapping(text), None
    else:
        raise FormatError(f"brackets of Sage are a string or a mapping, got {shown(text)}")
    basis = _split(names) if names is not None else stated or _in_order(brackets)
    index = {x: i for i, x in enumerate(basis)}
    if len(index) < len(basis):
        raise FormatError(f"the names {shown(basis)} are not distinct")
    missing = [x for x in _in_order(brackets) if x not in index]
    if missing:
        raise FormatError(f"the brackets mention {shown(missing[0])}, which is none of the names {shown(basis)}")
    table = {(index[x], index[y]): {index[z]: v for z, v in row.items()} for (x, y), row in brackets.items()}
    return LieAlgebra(table, QQ, dimension=len(basis), basis=basis, name=name)


def _split(names: Sequence[str] | str) -> tuple[str, ...]:
    parts: Iterable[str] = names.split(",") if isinstance(names, str) else names
    return tuple(x for x in (str(part).strip() for part in parts) if x)


def _in_order(brackets: Brackets) -> tuple[str, ...]:
    """Names in the order of their first occurrence, names in pairs first."""
    pairs = (x for pair in brackets for x in pair)
    return tuple(dict.fromkeys([*pairs, *(z for row in brackets.values() for z in row)]))


def _of_mapping(brackets: Mapping[object, object]) -> Brackets:
    rows: Brackets = {}
    for pair, row in brackets.items():
        if not (isinstance(pair, tuple) and len(pair) == 2 and isinstance(row, Mapping)):
            _refuse_sage(f"{shown(pair)}: {shown(row)} is not a pair of names with a dictionary of coefficients")
        rows[str(pair[0]), str(pair[1])] = {str(z): _rational(value) for z, value in row.items()}
    return rows


def _rational(value: ScalarLike) -> Scalar:
    if isinstance(value, float):
        _refuse_sage(f"the coefficient {value!r} is a float; write a fraction")
    try:
        return QQ.convert(value)
    except (FieldError, ParseError) as error:
        _refuse_sage(f"the coefficient {shown(value)} is not rational: {error}")


# -- strings ---------------------------------------------------------------------------------------------
def _parsed(text: str) -> tuple[Brackets, tuple[str, ...] | None]:
    """Brackets and names in a string."""
    stated: tuple[str, ...] | None = None
    if len(text) > MAX_LENGTH:
        _refuse_sage("the string is too long")
    if match := _GENERATORS.fullmatch(text):
        stated, text = _split(match[2]), match[3]
    if match := _FAMILY.fullmatch(text):
        text = match[1]
    try:
        body = ast.parse(text.strip()).body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        _refuse_sage(f"the string does not parse ({type(error).__name__}: {str(error)[:60]})")
    node = body[0].value if len(body) == 1 and isinstance(body[0], ast.Assign | ast.Expr) else None
    try:
        if isinstance(node, ast.Call):
            return _call(node, stated)
        if isinstance(node, ast.Dict):
            return _brackets(node), stated
    except RecursionError:
        _refuse_sage("the string is nested too deeply")
    _refuse_sage("expected a dictionary {('x', 'y'): {'z': 1}} or LieAlgebra(QQ, {...}, names=...)")


def _call(node: ast.Call, stated: tuple[str, ...] | None) -> tuple[Brackets, tuple[str, ...] | None]:
    """Brackets and names of LieAlgebra(QQ, {...}, names='x,y,z'); the names may be the second argument."""
    if not (isinstance(node.func, ast.Name) and node.func.id == "LieAlgebra" and node.args):
        _refuse_sage(f"{ast.unparse(node.func)[:40]} is not read, expected LieAlgebra(QQ, ...)")
    field, *arguments = node.args
    if not (isinstance(field, ast.Name) and field.id in ("QQ", "ZZ")):
        _refuse_sage(f"the field is {ast.unparse(field)[:40]}, expected QQ")
    brackets: Brackets = {}
    keywords = [k.value for k in node.keywords if k.arg == "names"]
    unknown = [k.arg for k in node.keywords if k.arg not in ("names", "abelian", "nilpotent")]
    if unknown:
        _refuse_sage(f"the argument {unknown[0]} is not read, expected names")
    for argument in arguments:
        if isinstance(argument, ast.Dict):
            brackets = _brackets(argument)
        else:
            keywords.append(argument)
    if keywords:
        stated = _sage_names(keywords[0])
    if stated is None and not brackets:
        _refuse_sage("LieAlgebra(QQ, ...) without brackets needs names")
    return brackets, stated


def _sage_names(node: ast.expr) -> tuple[str, ...]:
    return tuple(_name(x) for x in node.elts) if isinstance(node, ast.Tuple | ast.List) else _split(_name(node))


def _name(node: ast.expr) -> str:
    if isinstance(node, ast.Constant) and type(node.value) in (str, int):
        return str(node.value)
    _refuse_sage(f"{ast.unparse(node)[:40]} is not the name of a basis element")


def _brackets(node: ast.Dict) -> Brackets:
    rows: Brackets = {}
    for key, value in zip(node.keys, node.values, strict=True):
        if not (isinstance(key, ast.Tuple) and len(key.elts) == 2):
            _refuse_sage(f"{ast.unparse(key)[:40] if key else '**'} is not a pair of names")
        pair = (_name(key.elts[0]), _name(key.elts[1]))
        if pair in rows:
            _refuse_sage(f"the bracket of {pair[0]} and {pair[1]} is given twice")
        rows[pair] = _row(value)
    return rows


def _row(node: ast.expr) -> dict[str, Scalar]:
    """Coefficients of {'z': 1}, [('z', 1)] or 2*x - 1/2*z."""
    if isinstance(node, ast.Dict):
        return {_name(k or v): _sage_number(v) for k, v in zip(node.keys, node.values, strict=True)}
    if isinstance(node, ast.List | ast.Tuple):
        pairs = [x.elts for x in node.elts if isinstance(x, ast.Tuple) and len(x.elts) == 2]
        if len(pairs) == len(node.elts):
            return {_name(k): _sage_number(v) for k, v in pairs}
    return _linear(node)


def _linear(node: ast.expr) -> dict[str, Scalar]:
    """Coefficients of a linear combination of names: its values where one name is 1 and the others are 0."""
    text = ast.unparse(node)
    names = list(dict.fromkeys(WORD.findall(text)))
    zero = dict.fromkeys(names, QQ.zero)
    try:
        tree = parse(text, names, ())
        if not _has_powers(node) and evaluate(tree, QQ.convert, zero, {}) == 0:
            values = ((z, evaluate(tree, QQ.convert, {**zero, z: QQ.one}, {})) for z in names)
            return {z: value for z, value in values if value != 0}
    except ParseError:
        pass
    _refuse_sage(f"{text[:40]} is not a linear combination of names")


def _has_powers(node: ast.expr) -> bool:
    """Whether there is a power, a product of names, or a division by one."""
    return any(
        isinstance(x, ast.BinOp)
        and not isinstance(x.op, ast.Add | ast.Sub)
        and (isinstance(x.op, ast.Pow) or (_has_names(x.right) and (isinstance(x.op, ast.Div) or _has_names(x.left))))
        for x in ast.walk(node)
    )


def _has_names(node: ast.expr) -> bool:
    return any(isinstance(x, ast.Name) for x in ast.walk(node))


def _sage_number(node: ast.expr) -> Scalar:
    """Value of an integer or a fraction."""
    text = ast.unparse(node)
    try:
        return QQ.convert(text)
    except (FieldError, ParseError):
        _refuse_sage(f"the coefficient {text[:40]} is not an integer or a fraction")


def _refuse_sage(what: str) -> NoReturn:
    raise FormatError(f"not brackets of Sage: {what}")


# Exact objects as objects of sympy: numbers, matrices, and arrays of structure constants. In the other direction
# nothing is needed: liehom accepts matrices, arrays and numbers of sympy as input.

SympyObject: TypeAlias = Any  # An object of sympy, which has no types


def to_sympy(obj: object) -> SympyObject:
    """Object of sympy with the same entries: an array, a matrix, a list of matrices or a number.

    Parameters
    ----------
    obj : LieAlgebra, Subalgebra, Representation, Matrix or number

    Returns
    -------
    sympy object
        * for an algebra, the sparse array ``c[i, j, k]`` of shape (n, n, n);
        * for a subalgebra, the matrix of its rows, of shape (k, n);
        * for a representation, the list of its matrices;
        * for a matrix, a matrix; for a number, a number.

        Elements of a number field become expressions in square roots, or in ``CRootOf`` if the generator is not a
        square root.

    Examples
    --------
    >>> import liehom as lh
    >>> to_sympy(lh.so(3)).shape, to_sympy(lh.so(3).killing_form())
    ((3, 3, 3), Matrix([
    [-2,  0,  0],
    [ 0, -2,  0],
    [ 0,  0, -2]]))
    >>> to_sympy(lh.number_field("sqrt(2)").convert("1/2 - sqrt(2)"))
    1/2 - sqrt(2)
    """
    if isinstance(obj, LieAlgebra):
        return _array(obj)
    if isinstance(obj, ExactMatrix | FloatMatrix):
        return _matrix(obj)
    if isinstance(obj, Subalgebra):
        return _matrix(obj.basis)
    if isinstance(obj, Representation):
        return [_matrix(a) for a in obj.matrices]
    if isinstance(obj, AlgebraicNumber):
        return sympy_number(obj.field, obj)
    if isinstance(obj, RationalFunction):
        import sympy

        return sympy.sympify(str(obj))
    if isinstance(obj, int | float) or type(obj) is type(QQ.one):
        import sympy

        return sympy.Float(obj) if isinstance(obj, float) else sympy_number(QQ, QQ.convert(obj))
    raise InputError(
        f"a {type(obj).__name__} has no form in sympy; "
        "expected an algebra, subalgebra, representation, matrix or number"
    )


def _matrix(matrix: Matrix) -> SympyObject:
    import sympy

    return sympy.Matrix(*matrix.shape, [sympy_number(matrix.field, x) for row in matrix.to_rows() for x in row])


def _array(algebra: LieAlgebra) -> SympyObject:
    import sympy

    n, entries = algebra.dimension, {}
    for i, j, k, v in algebra.structure_constants():
        value = sympy_number(algebra.field, v)
        entries[(i * n + j) * n + k] = value
        entries[(j * n + i) * n + k] = -value
    return sympy.ImmutableSparseNDimArray(entries, (n, n, n))
