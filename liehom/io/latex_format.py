r"""LaTeX of brackets, matrices, numbers, pairs, verdicts and tables, for use in math mode.

\begin{aligned} [e_0, e_1] &= e_2 \\ ... \end{aligned},      \begin{pmatrix} -2 & 0 \\ 0 & \frac{1}{2} \end{pmatrix}
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from itertools import islice
from typing import Any

from liehom.algebra import Homomorphism, LieAlgebra, RealForm, RootSystem, Subalgebra
from liehom.algebra.core.names import LinearCombination
from liehom.display import Displayed, DisplayedTable, escaped_latex
from liehom.errors import InputError, shown
from liehom.fullness import (
    Certificate,
    Classification,
    Full,
    NotFull,
    NumericallyFull,
    NumericallyNotFull,
    NumericallyUndecided,
)
from liehom.integrators import Solution
from liehom.representations import Pair, Representation
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


def latex(obj: object, *, table: bool = False, most: int | None = None) -> str:
    r"""LaTeX of an algebra's brackets, a matrix, a pair, a verdict or another object of the library, as a string.

    Parameters
    ----------
    obj : LieAlgebra, Subalgebra, Representation, Pair, verdict, RootSystem, Matrix, number, ...
        A Killing form, for example, is a matrix: ``latex(g.killing_form())``. An element is what ``g.show(x)``
        returns. A table (`ConvergenceTable`, `Atlas`) becomes an array. An object without a formula, such as a
        `Tableau`, becomes its `repr` as text.
    table : bool
        For an algebra: the square table of all brackets, instead of the list of nonzero brackets.
    most : int, optional
        Lines of brackets, rows of tables, and rows and columns of matrices that are written; dots stand for the others
        (default: all). It does not apply to the square table.

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
    >>> print(latex(lh.heisenberg(1).show([1, 0, "-1/2"])))
    x_{1} - \frac{1}{2} z
    >>> print(latex(lh.decide_fullness(lh.pair("so(4)/so(3)"))))
    \mathfrak{so}(4)/\mathfrak{so}(3) \text{ is full}
    >>> print(latex(lh.so(4), most=1))
    \begin{aligned}
    [e_{0}, e_{1}] &= e_{3} \\
    &\;\;\vdots
    \end{aligned}
    """
    if isinstance(obj, LieAlgebra):
        return _bracket_table(obj) if table else _bracket_list(obj, most)
    if isinstance(obj, ExactMatrix | FloatMatrix):
        return _matrix(obj, most)
    if isinstance(obj, Subalgebra):
        return _span(obj, most)
    if isinstance(obj, LinearCombination):
        return _combination(obj.field, obj.values, [_symbol(x) for x in obj.names])
    if isinstance(obj, Representation):
        names = [_symbol(x) for x in obj.algebra.basis_names[:most]]
        lines = [rf"\rho({x}) &= {_matrix(a, most)}" for x, a in zip(names, obj.matrices, strict=False)]
        return _aligned([*lines, *_dots(len(obj.matrices), most)]) if lines else r"\rho = 0"
    if isinstance(obj, DisplayedTable):
        return _cells(obj._cells(), most)
    found = _statement(obj, most)
    if found is not None:
        return found
    if isinstance(obj, Displayed):
        text = repr(obj).removeprefix("<").removesuffix(">")
        return " ".join(_words(line.strip()) for line in text.splitlines()[:1])
    return _number(*_with_field(obj))


def _with_field(value: object) -> tuple[Field, Scalar]:
    if isinstance(value, AlgebraicNumber):
        return value.field, value
    if isinstance(value, float):
        return RR, value
    if isinstance(value, int) or type(value) is type(QQ.one):
        return QQ, QQ.convert(value)
    raise InputError(
        f"a {type(value).__name__} has no LaTeX here; expected an algebra, subalgebra, representation, pair, verdict, "
        "matrix, table or number"
    )


# -- names and statements ------------------------------------------------------------------------------------
_ANSWERS = {
    Full: "is full",
    NotFull: "is not full",
    NumericallyFull: "is full (numerical, not proved)",
    NumericallyNotFull: "is not full (numerical, not proved)",
    NumericallyUndecided: "is undecided (numerical)",
}


def _statement(obj: object, most: int | None) -> str | None:
    """LaTeX of an object that is shown by its name or as a short statement; None for other objects."""
    if isinstance(obj, Pair):
        return _pair(obj)
    if type(obj) in _ANSWERS:
        verdict: Any = obj
        return f"{_pair(verdict.pair)} {_words(f' {_ANSWERS[type(obj)]}')}"
    if isinstance(obj, Certificate):
        return _words(f"certificate of kind '{obj.kind}' over {obj.field.name}")
    if isinstance(obj, Classification):
        return rf"{_name(obj.name or 'no catalogue name')} \colon\; {_words(obj.space)}"
    if isinstance(obj, RealForm):
        return _name(obj.name)
    if isinstance(obj, Solution):
        return _words(obj.message)
    if isinstance(obj, RootSystem):
        cartan = _matrix(QQ.matrix(obj.cartan, (obj.rank, obj.rank)), most)
        name = re.sub("([A-G])([0-9]+)", r"\1_{\2}", obj.type)
        return rf"{name} \colon\; {cartan}"
    if isinstance(obj, Homomorphism):
        return _matrix(obj.matrix, most)
    return None


def _pair(pair: Pair) -> str:
    if pair.name:
        return _name(pair.name)
    dimensions = f"{pair.algebra.dimension}/{pair.subalgebra.dimension}"
    return _words(f"pair of dimensions {dimensions}")


def _name(name: str) -> str:
    r"""LaTeX of the name of an algebra or a pair.

    Examples
    --------
    >>> _name("so(4,1)/so(4)"), _name("e6(-26) + R"), _name("<&>")
    ('\\mathfrak{so}(4,1)/\\mathfrak{so}(4)', '\\mathfrak{e}_{6}(-26) + \\mathbb{R}', '\\text{<\\&>}')
    """
    if not re.fullmatch(r"[A-Za-z0-9(),/+* .-]+", name, re.ASCII) or not re.match("[A-Za-z]+[0-9(*]", name):
        return _words(name)

    def factor(match: re.Match[str]) -> str:
        word, index = match[1], match[2]
        letter = rf"\mathbb{{{word}}}" if word in ("R", "C", "H") else rf"\mathfrak{{{word}}}"
        return letter + (f"_{{{index}}}" if index else "")

    return re.sub("([A-Za-z]+)([0-9]*)", factor, name).replace("*", "^{*}")


def _cells(cells: list[list[str]], most: int | None) -> str:
    head, *body = [" & ".join(map(_words, row)) for row in cells]
    lines = [*body[:most], *([r"\vdots"] if most is not None and len(body) > most else [])]
    columns = "l" * len(cells[0])
    rows = " \\\\\n".join(lines)
    return f"\\begin{{array}}{{{columns}}}\n{head} \\\\ \\hline\n{rows}\n\\end{{array}}"


def _words(text: str) -> str:
    return rf"\text{{{escaped_latex(shown(text))}}}"


def _dots(found: int, most: int | None) -> list[str]:
    return [] if most is None or found <= most else [r"&\;\;\vdots"]


# -- brackets and matrices -----------------------------------------------------------------------------------
def _bracket_list(algebra: LieAlgebra, most: int | None) -> str:
    names = [_symbol(x) for x in algebra.basis_names]
    found = _brackets(algebra, names, most=most)
    lines = [f"[{names[i]}, {names[j]}] &= {text}" for (i, j), text in islice(found.items(), most)]
    return _aligned([*(lines or [r"[x, y] &= 0 \quad \text{for all } x, y"]), *_dots(len(found), most)])


def _span(subalgebra: Subalgebra, most: int | None) -> str:
    names = [_symbol(x) for x in subalgebra.algebra.basis_names]
    field, basis = subalgebra.algebra.field, subalgebra.basis
    shown_rows = range(subalgebra.dimension if most is None else min(most, subalgebra.dimension))
    rows = [_combination(field, basis.row(i), names) for i in shown_rows]
    rows += [r"\dots"] * (len(rows) < subalgebra.dimension)
    return rf"\left\langle {', '.join(rows)} \right\rangle" if rows else r"\{0\}"


def _bracket_table(algebra: LieAlgebra) -> str:
    names, n = [_symbol(x) for x in algebra.basis_names], algebra.dimension
    found = {(j, i): text for (i, j), text in _brackets(algebra, names, -1).items()} | _brackets(algebra, names)
    lines = [" & ".join(["", *names]) + r" \\ \hline"]
    lines += [" & ".join([names[i], *(found.get((i, j), "0") for j in range(n))]) + r" \\" for i in range(n)]
    return "\n".join([rf"\begin{{array}}{{c|{'c' * n}}}", *lines, r"\end{array}"])


def _brackets(
    algebra: LieAlgebra, names: Sequence[str], sign: int = 1, most: int | None = None
) -> dict[tuple[int, int], str]:
    """LaTeX of the nonzero brackets (i, j); with `most`, of one bracket more than that."""
    rows: dict[tuple[int, int], list[tuple[Scalar, str]]] = {}
    for i, j, k, v in algebra.structure_constants():
        if most is not None and (i, j) not in rows and len(rows) > most:
            break
        rows.setdefault((i, j), []).append((v if sign == 1 else -v, names[k]))
    return {pair: _sum(algebra.field, terms) for pair, terms in rows.items()}


def _matrix(matrix: Matrix, most: int | None = None) -> str:
    nrows, ncols = matrix.shape if most is None else (min(most, n) for n in matrix.shape)
    corner = matrix if most is None else matrix.select(rows=range(nrows), columns=range(ncols))
    rows = [[_number(matrix.field, x) for x in row] for row in corner.to_rows()]
    if ncols < matrix.ncols:
        rows = [[*row, r"\cdots"] for row in rows]
    if nrows < matrix.nrows:
        rows.append([r"\vdots"] * ncols + [r"\ddots"] * (ncols < matrix.ncols))
    lines = [" & ".join(row) for row in rows]
    if ncols + (ncols < matrix.ncols) <= MAX_PMATRIX_COLUMNS:
        return _environment("pmatrix", lines)
    body = " \\\\\n".join(lines)
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
        return _words(name)
    word, index = match[1], match[2]
    text = f"\\{word}" if GREEK.fullmatch(word) else word if len(word) == 1 else rf"\mathrm{{{word}}}"
    return f"{text}_{{{index}}}" if index else text
