"""Parts of LaTeX formulas: names, words, numbers, sums of basis elements, matrices and environments of amsmath."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Any

from liehom.display import escaped_latex
from liehom.errors import shown
from liehom.scalars import Field, FloatField, Matrix, NumberField, Scalar

GREEK = re.compile(
    "alpha|beta|gamma|delta|epsilon|zeta|eta|theta|iota|kappa|lambda|mu|nu|xi|pi|rho|sigma|tau|upsilon|phi|chi|psi|"
    "omega|Gamma|Delta|Theta|Lambda|Xi|Pi|Sigma|Upsilon|Phi|Psi|Omega"
)
SIGNIFICANT_DIGITS = 6
"""Digits of floats."""
MAX_PMATRIX_COLUMNS = 10
"""A matrix of amsmath has at most this many columns, unless a counter of LaTeX is raised."""


# -- names and words -----------------------------------------------------------------------------------------
def name_latex(name: str) -> str:
    r"""LaTeX of the name of an algebra or a pair.

    Examples
    --------
    >>> name_latex("so(4,1)/so(4)"), name_latex("e6(-26) + R"), name_latex("<&>")
    ('\\mathfrak{so}(4,1)/\\mathfrak{so}(4)', '\\mathfrak{e}_{6}(-26) + \\mathbb{R}', '\\text{<\\&>}')
    """
    if not re.fullmatch(r"[A-Za-z0-9(),/+* .-]+", name, re.ASCII) or not re.match("[A-Za-z]+[0-9(*]", name):
        return words(name)

    def factor(match: re.Match[str]) -> str:
        word, index = match[1], match[2]
        letter = rf"\mathbb{{{word}}}" if word in ("R", "C", "H") else rf"\mathfrak{{{word}}}"
        return letter + (f"_{{{index}}}" if index else "")

    return re.sub("([A-Za-z]+)([0-9]*)", factor, name).replace("*", "^{*}")


def structure_latex(name: str) -> str:
    r"""LaTeX of a structure name, whose terms may be powers of R.

    Examples
    --------
    >>> structure_latex("so(3) + R^2"), structure_latex("R"), structure_latex("0")
    ('\\mathfrak{so}(3) + \\mathbb{R}^{2}', '\\mathbb{R}', '0')
    """

    def term(text: str) -> str:
        power = re.fullmatch(r"R(\^(\d+))?", text)
        if power is None:
            return text if text == "0" else name_latex(text)
        return r"\mathbb{R}" + (f"^{{{power[2]}}}" if power[2] else "")

    return " + ".join(map(term, name.split(" + ")))


def type_latex(name: str) -> str:
    r"""LaTeX of a type such as 'B2 + G2': B_{2} + G_{2}."""
    return re.sub("([A-G])([0-9]+)", r"\1_{\2}", name)


def polynomial_latex(text: str) -> str:
    r"""LaTeX of a polynomial.

    Examples
    --------
    >>> polynomial_latex("(x0)*(2*x1 - x10^2)")
    '(x_{0}) (2 x_{1} - x_{10}^{2})'
    """
    return re.sub(r"\^(\d+)", r"^{\1}", re.sub(r"x(\d+)", r"x_{\1}", text)).replace("*", " ")


def words(text: str) -> str:
    r"""Text of a formula, shortened to a line: \text{...}."""
    return rf"\text{{{escaped_latex(shown(text))}}}"


def dots(found: int, most: int | None) -> list[str]:
    """The line of dots of `aligned` for the lines beyond `most`, a list with at most one string."""
    return [] if most is None or found <= most else [r"&\;\;\vdots"]


# -- matrices and environments -------------------------------------------------------------------------------
def matrix_latex(matrix: Matrix, most: int | None = None) -> str:
    """Matrix in parentheses; with `most`, its upper left corner and dots."""
    nrows, ncols = matrix.shape if most is None else (min(most, n) for n in matrix.shape)
    corner = matrix if most is None else matrix.select(rows=range(nrows), columns=range(ncols))
    rows = [[number_latex(matrix.field, x) for x in row] for row in corner.to_rows()]
    if ncols < matrix.ncols:
        rows = [[*row, r"\cdots"] for row in rows]
    if nrows < matrix.nrows:
        rows.append([r"\vdots"] * ncols + [r"\ddots"] * (ncols < matrix.ncols))
    lines = [" & ".join(row) for row in rows]
    if ncols + (ncols < matrix.ncols) <= MAX_PMATRIX_COLUMNS:
        return environment("pmatrix", lines)
    body = " \\\\\n".join(lines)
    return f"\\left(\\begin{{array}}{{{'r' * matrix.ncols}}}\n{body}\n\\end{{array}}\\right)"


def aligned(lines: Iterable[str]) -> str:
    """Lines aligned at their signs &."""
    return environment("aligned", lines)


def environment(name: str, lines: Iterable[str]) -> str:
    """Environment of amsmath with these lines."""
    body = " \\\\\n".join(lines)
    return f"\\begin{{{name}}}\n{body}\n\\end{{{name}}}"


# -- sums and numbers ----------------------------------------------------------------------------------------
def combination(field: Field, row: Sequence[Scalar], names: Sequence[str]) -> str:
    """Linear combination of names."""
    return sum_latex((number_latex(field, v), x) for v, x in zip(row, names, strict=True) if v != 0)


def sum_latex(terms: Iterable[tuple[str, str]]) -> str:
    """LaTeX of a sum of numbers, which are LaTeX, times names; a number with several terms is in parentheses."""
    out = ""
    for text, name in terms:
        if " + " in text or " - " in text:
            part = rf"\left({text}\right) {name}"
        elif text in ("1", "-1"):
            part = text[:-1] + name
        else:
            part = f"{text} {name}"
        out += part if not out else f" - {part[1:]}" if part.startswith("-") else f" + {part}"
    return out or "0"


def number_latex(field: Field, value: Scalar) -> str:
    r"""Number of a field: a fraction, a polynomial in the generator, or a float in six digits."""
    if isinstance(field, FloatField):
        digits, _, exponent = f"{value:.{SIGNIFICANT_DIGITS}g}".partition("e")
        return rf"{digits}\cdot10^{{{int(exponent)}}}" if exponent else digits
    if not isinstance(field, NumberField):
        return _fraction(value)
    symbol = rf"\sqrt{{{field.symbol[5:-1]}}}" if field.symbol.startswith("sqrt(") else symbol_latex(field.symbol)
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


def _fraction(value: Scalar) -> str:
    exact: Any = value  # an integer or fraction of flint
    if exact.q == 1:
        return str(exact.p)
    sign = "-" if exact < 0 else ""
    return rf"{sign}\frac{{{abs(exact.p)}}}{{{exact.q}}}"


def symbol_latex(name: str) -> str:
    r"""LaTeX of the name of a basis element or of a generator.

    Examples
    --------
    >>> symbol_latex("e12"), symbol_latex("alpha_1"), symbol_latex("height"), symbol_latex("a&b")
    ('e_{12}', '\\alpha_{1}', '\\mathrm{height}', '\\text{a\\&b}')
    """
    match = re.fullmatch(r"([A-Za-z]+)_?([0-9]*)", name, re.ASCII)
    if match is None:
        return words(name)
    word, index = match[1], match[2]
    text = f"\\{word}" if GREEK.fullmatch(word) else word if len(word) == 1 else rf"\mathrm{{{word}}}"
    return f"{text}_{{{index}}}" if index else text
