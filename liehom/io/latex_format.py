r"""LaTeX of brackets, matrices, subalgebras and numbers, for use in math mode.

\begin{aligned} [e_0, e_1] &= e_2 \\ ... \end{aligned},      \begin{pmatrix} -2 & 0 \\ 0 & \frac{1}{2} \end{pmatrix}
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Any

from liehom.algebra import LieAlgebra, Subalgebra
from liehom.errors import InputError
from liehom.representations.core.representation import Representation
from liehom.scalars import QQ, RR, AlgebraicNumber, Field, FloatField, Matrix, NumberField, Scalar
from liehom.scalars.fields.exact_field import ExactMatrix
from liehom.scalars.fields.floating import FloatMatrix

GREEK = re.compile(
    "alpha|beta|gamma|delta|epsilon|zeta|eta|theta|iota|kappa|lambda|mu|nu|xi|pi|rho|sigma|tau|upsilon|phi|chi|psi|"
    "omega|Gamma|Delta|Theta|Lambda|Xi|Pi|Sigma|Upsilon|Phi|Psi|Omega"
)
SIGNIFICANT_DIGITS = 6
"""Digits of floats."""
MAX_PMATRIX_COLUMNS = 10
"""A matrix of amsmath has at most this many columns, unless a counter of LaTeX is raised."""

_SPECIAL = {"\\": r"\textbackslash{}", "^": r"\textasciicircum{}", "~": r"\textasciitilde{}"}


def latex(obj: object, *, table: bool = False) -> str:
    r"""LaTeX of an algebra's brackets, a matrix, a subalgebra, a representation or a number, as a string.

    Parameters
    ----------
    obj : LieAlgebra, Subalgebra, Representation, Matrix or number
        A Killing form, for example, is a matrix: ``latex(g.killing_form())``.
    table : bool
        For an algebra: the square table of all brackets, instead of the list of nonzero brackets.

    Returns
    -------
    str
        LaTeX for math mode, with environments of amsmath. Basis elements have their names: ``e12`` becomes ``e_{12}``,
        ``alpha`` the Greek letter. Floats have six digits.

    Raises
    ------
    InputError
        If `obj` is of another type.

    Examples
    --------
    >>> import liehom as lh
    >>> print(latex(lh.heisenberg(1)))
    \begin{aligned}
    [x_{1}, y_{1}] &= z
    \end{aligned}
    >>> print(latex(lh.QQ.matrix([["-1/2", 1]])))
    \begin{pmatrix}
    -\frac{1}{2} & 1
    \end{pmatrix}
    """
    if isinstance(obj, LieAlgebra):
        return _bracket_table(obj) if table else _bracket_list(obj)
    if isinstance(obj, ExactMatrix | FloatMatrix):
        return _matrix(obj)
    if isinstance(obj, Subalgebra):
        names = [_symbol(x) for x in obj.algebra.basis_names]
        rows = (_combination(obj.algebra.field, row, names) for row in obj.rows())
        return rf"\left\langle {', '.join(rows)} \right\rangle" if obj.dimension else r"\{0\}"
    if isinstance(obj, Representation):
        names = [_symbol(x) for x in obj.algebra.basis_names]
        lines = [rf"\rho({x}) &= {_matrix(a)}" for x, a in zip(names, obj.matrices, strict=True)]
        return _aligned(lines) if lines else r"\rho = 0"
    return _number(*_with_field(obj))


def _with_field(value: object) -> tuple[Field, Scalar]:
    if isinstance(value, AlgebraicNumber):
        return value.field, value
    if isinstance(value, float):
        return RR, value
    if isinstance(value, int) or type(value) is type(QQ.one):
        return QQ, QQ.convert(value)
    raise InputError(
        f"a {type(value).__name__} has no LaTeX here; expected an algebra, subalgebra, representation, matrix or number"
    )


# -- brackets and matrices -----------------------------------------------------------------------------------
def _bracket_list(algebra: LieAlgebra) -> str:
    names = [_symbol(x) for x in algebra.basis_names]
    lines = [f"[{names[i]}, {names[j]}] &= {text}" for (i, j), text in _brackets(algebra, names).items()]
    return _aligned(lines or [r"[x, y] &= 0 \quad \text{for all } x, y"])


def _bracket_table(algebra: LieAlgebra) -> str:
    names, n = [_symbol(x) for x in algebra.basis_names], algebra.dimension
    found = {(j, i): text for (i, j), text in _brackets(algebra, names, -1).items()} | _brackets(algebra, names)
    lines = [" & ".join(["", *names]) + r" \\ \hline"]
    lines += [" & ".join([names[i], *(found.get((i, j), "0") for j in range(n))]) + r" \\" for i in range(n)]
    return "\n".join([rf"\begin{{array}}{{c|{'c' * n}}}", *lines, r"\end{array}"])


def _brackets(algebra: LieAlgebra, names: Sequence[str], sign: int = 1) -> dict[tuple[int, int], str]:
    rows: dict[tuple[int, int], list[tuple[Scalar, str]]] = {}
    for i, j, k, v in algebra.structure_constants():
        rows.setdefault((i, j), []).append((v if sign == 1 else -v, names[k]))
    return {pair: _sum(algebra.field, terms) for pair, terms in rows.items()}


def _matrix(matrix: Matrix) -> str:
    rows = [" & ".join(_number(matrix.field, x) for x in row) for row in matrix.to_rows()]
    if matrix.ncols <= MAX_PMATRIX_COLUMNS:
        return _environment("pmatrix", rows)
    body = " \\\\\n".join(rows)
    return f"\\left(\\begin{{array}}{{{'r' * matrix.ncols}}}\n{body}\n\\end{{array}}\\right)"


def _aligned(lines: Iterable[str]) -> str:
    return _environment("aligned", lines)


def _environment(name: str, lines: Iterable[str]) -> str:
    body = " \\\\\n".join(lines)
    return f"\\begin{{{name}}}\n{body}\n\\end{{{name}}}"


# -- sums and numbers ----------------------------------------------------------------------------------------
def _combination(field: Field, row: Sequence[Scalar], names: Sequence[str]) -> str:
    return _sum(field, [(v, x) for v, x in zip(row, names, strict=True) if v != 0])


def _sum(field: Field, terms: Sequence[tuple[Scalar, str]]) -> str:
    """LaTeX of a sum of numbers times names; a number with several terms is in parentheses."""
    out = ""
    for value, name in terms:
        text = _number(field, value)
        if " " in text:
            part = rf"\left({text}\right) {name}"
        elif text in ("1", "-1"):
            part = text[:-1] + name
        else:
            part = f"{text} {name}"
        out += part if not out else f" - {part[1:]}" if part.startswith("-") else f" + {part}"
    return out or "0"


def _number(field: Field, value: Scalar) -> str:
    if isinstance(field, FloatField):
        digits, _, exponent = f"{value:.{SIGNIFICANT_DIGITS}g}".partition("e")
        return rf"{digits}\cdot10^{{{int(exponent)}}}" if exponent else digits
    if not isinstance(field, NumberField):
        return _fraction(value)
    symbol = rf"\sqrt{{{field.symbol[5:-1]}}}" if field.symbol.startswith("sqrt(") else _symbol(field.symbol)
    powers = ["", symbol, *(f"{symbol}^{{{p}}}" for p in range(2, field.degree))]
    out = ""
    for p, c in enumerate(field.coordinates(value)):
        c = c * field.leading**p
        if c == 0:
            continue
        text = _fraction(c)
        part = text if not p else text[:-1] + powers[p] if text in ("1", "-1") else text + powers[p]
        out += part if not out else f" - {part[1:]}" if part.startswith("-") else f" + {part}"
    return out or "0"


def _fraction(value: Any) -> str:
    if value.q == 1:
        return str(value.p)
    sign = "-" if value < 0 else ""
    return rf"{sign}\frac{{{abs(value.p)}}}{{{value.q}}}"


def _symbol(name: str) -> str:
    r"""LaTeX of the name of a basis element or of a generator.

    Examples
    --------
    >>> _symbol("e12"), _symbol("alpha_1"), _symbol("height"), _symbol("a&b")
    ('e_{12}', '\\alpha_{1}', '\\mathrm{height}', '\\text{a\\&b}')
    """
    match = re.fullmatch(r"([A-Za-z]+)_?([0-9]*)", name, re.ASCII)
    if match is None:
        escaped = "".join(_SPECIAL.get(c, f"\\{c}" if c in "&%$#_{}" else c) for c in name)
        return rf"\text{{{escaped}}}"
    word, index = match[1], match[2]
    text = f"\\{word}" if GREEK.fullmatch(word) else word if len(word) == 1 else rf"\mathrm{{{word}}}"
    return f"{text}_{{{index}}}" if index else text
