"""Structure constants in the notation of Sage: dictionaries of brackets, indexed by names.

    L = LieAlgebra(QQ, {('x', 'y'): {'z': 1}}, names=('x', 'y', 'z'))            [x, y] = z

`from_sage` reads such dictionaries and calls, and the output of ``L.structure_coefficients()`` in Sage, with a parser
that executes nothing.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import NoReturn, TypeAlias

from liehom.algebra import LieAlgebra
from liehom.errors import FieldError, FormatError, ParseError
from liehom.io.gap_format import require_rational
from liehom.io.json_reader import shown
from liehom.scalars import QQ, Scalar
from liehom.typing import ScalarLike

VARIABLE = re.compile(r"[A-Za-z][A-Za-z_0-9]*", re.ASCII)
_GENERATORS = re.compile(r"\s*([A-Za-z_]\w*)\s*\.<([^<>=]*)>\s*=(.*)", re.ASCII | re.DOTALL)
_FAMILY = re.compile(r"\s*Finite family\s+(\{.*)", re.ASCII | re.DOTALL)
MAX_LENGTH = 50_000_000
"""Characters of the longest string that is read."""

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
    liehom.errors.JacobiError: the Jacobi identity fails for (i, j, k) = (0, 1, 2), that is for x, y, z: ...
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
    made: Brackets = {}
    for pair, row in brackets.items():
        if not (isinstance(pair, tuple) and len(pair) == 2 and isinstance(row, Mapping)):
            _refuse(f"{shown(pair)}: {shown(row)} is not a pair of names with a dictionary of coefficients")
        made[str(pair[0]), str(pair[1])] = {str(z): _rational(value) for z, value in row.items()}
    return made


def _rational(value: ScalarLike) -> Scalar:
    if isinstance(value, float):
        _refuse(f"the coefficient {value!r} is a float; write a fraction")
    try:
        return QQ.convert(value)
    except (FieldError, ParseError) as error:
        _refuse(f"the coefficient {shown(value)} is not rational: {error}")


# -- strings ---------------------------------------------------------------------------------------------
def _parsed(text: str) -> tuple[Brackets, tuple[str, ...] | None]:
    """Brackets and names in a string."""
    stated: tuple[str, ...] | None = None
    if len(text) > MAX_LENGTH:
        _refuse("the string is too long")
    if match := _GENERATORS.fullmatch(text):
        stated, text = _split(match[2]), match[3]
    if match := _FAMILY.fullmatch(text):
        text = match[1]
    try:
        body = ast.parse(text.strip()).body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        _refuse(f"the string does not parse ({type(error).__name__}: {str(error)[:60]})")
    node = body[0].value if len(body) == 1 and isinstance(body[0], ast.Assign | ast.Expr) else None
    try:
        if isinstance(node, ast.Call):
            return _call(node, stated)
        if isinstance(node, ast.Dict):
            return _brackets(node), stated
    except RecursionError:
        _refuse("the string is nested too deeply")
    _refuse("expected a dictionary {('x', 'y'): {'z': 1}} or LieAlgebra(QQ, {...}, names=...)")


def _call(node: ast.Call, stated: tuple[str, ...] | None) -> tuple[Brackets, tuple[str, ...] | None]:
    """Brackets and names of LieAlgebra(QQ, {...}, names='x,y,z'); the names may be the second argument."""
    if not (isinstance(node.func, ast.Name) and node.func.id == "LieAlgebra" and node.args):
        _refuse(f"{ast.unparse(node.func)[:40]} is not read, expected LieAlgebra(QQ, ...)")
    field, *arguments = node.args
    if not (isinstance(field, ast.Name) and field.id in ("QQ", "ZZ")):
        _refuse(f"the field is {ast.unparse(field)[:40]}, expected QQ")
    brackets: Brackets = {}
    keywords = [k.value for k in node.keywords if k.arg == "names"]
    unknown = [k.arg for k in node.keywords if k.arg not in ("names", "abelian", "nilpotent")]
    if unknown:
        _refuse(f"the argument {unknown[0]} is not read, expected names")
    for argument in arguments:
        if isinstance(argument, ast.Dict):
            brackets = _brackets(argument)
        else:
            keywords.append(argument)
    if keywords:
        stated = _names(keywords[0])
    if stated is None and not brackets:
        _refuse("LieAlgebra(QQ, ...) without brackets needs names")
    return brackets, stated


def _names(node: ast.expr) -> tuple[str, ...]:
    if isinstance(node, ast.Tuple | ast.List):
        return tuple(_name(x) for x in node.elts)
    return _split(_name(node))


def _name(node: ast.expr) -> str:
    if isinstance(node, ast.Constant) and type(node.value) in (str, int):
        return str(node.value)
    _refuse(f"{ast.unparse(node)[:40]} is not the name of a basis element")


def _brackets(node: ast.Dict) -> Brackets:
    made: Brackets = {}
    for key, value in zip(node.keys, node.values, strict=True):
        if not (isinstance(key, ast.Tuple) and len(key.elts) == 2):
            _refuse(f"{ast.unparse(key)[:40] if key else '**'} is not a pair of names")
        pair = (_name(key.elts[0]), _name(key.elts[1]))
        if pair in made:
            _refuse(f"the bracket of {pair[0]} and {pair[1]} is given twice")
        made[pair] = _row(value)
    return made


def _row(node: ast.expr) -> dict[str, Scalar]:
    """Coefficients of {'z': 1}, [('z', 1)] or 2*x - 1/2*z."""
    if isinstance(node, ast.Dict):
        return {_name(k or v): _number(v) for k, v in zip(node.keys, node.values, strict=True)}
    if isinstance(node, ast.List | ast.Tuple):
        pairs = [x.elts for x in node.elts if isinstance(x, ast.Tuple) and len(x.elts) == 2]
        if len(pairs) == len(node.elts):
            return {_name(k): _number(v) for k, v in pairs}
    return {z: v for z, v in _linear(node).items() if v != 0}


def _linear(node: ast.expr) -> dict[str, Scalar]:
    """Coefficients of a linear combination of names."""
    match node:
        case ast.Name(id=z):
            return {z: QQ.one}
        case ast.Constant(value=0):
            return {}
        case ast.UnaryOp(op=ast.USub(), operand=x):
            return {z: -v for z, v in _linear(x).items()}
        case ast.BinOp(left=x, op=ast.Add() | ast.Sub() as op, right=y):
            first, second = _linear(x), _linear(y)
            sign = 1 if isinstance(op, ast.Add) else -1
            zero = QQ.zero
            return {z: first.get(z, zero) + sign * second.get(z, zero) for z in {**first, **second}}
        case ast.BinOp(left=x, op=ast.Mult(), right=y):
            factor = _number(x)
            return {z: factor * v for z, v in _linear(y).items()}
        case ast.BinOp(left=x, op=ast.Div(), right=y):
            factor = _number(ast.BinOp(ast.Constant(1), ast.Div(), y))
            return {z: factor * v for z, v in _linear(x).items()}
    _refuse(f"{ast.unparse(node)[:40]} is not a linear combination of names")


def _number(node: ast.expr) -> Scalar:
    """Value of an integer or a fraction."""
    match node:
        case ast.Constant(value=int() as n) if type(n) is int:
            return QQ.convert(n)
        case ast.UnaryOp(op=ast.USub(), operand=x):
            return -_number(x)
        case ast.BinOp(left=x, op=ast.Div(), right=y):
            top, bottom = _number(x), _number(y)
            if bottom != 0:
                return top / bottom
    _refuse(f"the coefficient {ast.unparse(node)[:40]} is not an integer or a fraction")


def _refuse(what: str) -> NoReturn:
    raise FormatError(f"not brackets of Sage: {what}")
