"""LaTeX and HTML of every object."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import singledispatch
from html import escape
from itertools import islice
from typing import Any

import numpy as np

from liehom.base.errors import InputError, shown
from liehom.base.objects import SHOWN_LINES, Displayed, DisplayedTable, escaped_latex
from liehom.exact.algebra.constructions.family import LieAlgebraFamily
from liehom.exact.algebra.core.homomorphism import Homomorphism
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.algebra.core.tables import LinearCombination
from liehom.exact.algebra.roots.real_form import RealForm
from liehom.exact.algebra.roots.root_system import RootSystem
from liehom.exact.fullness.certificate import Certificate
from liehom.exact.fullness.classification import Classification
from liehom.exact.fullness.verdict import (
    FailureReport,
    Full,
    NotFull,
    NumericallyFull,
    NumericallyNotFull,
    NumericallyUndecided,
)
from liehom.exact.orbits.cone import RelativeInvariant
from liehom.exact.orbits.strata import Stratum
from liehom.exact.representations.analysis.decomposition import Decomposition
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.core.representation import Representation
from liehom.exact.representations.highest_weight.highest_weight import HighestWeightModule
from liehom.exact.representations.highest_weight.real_modules import RealModule
from liehom.exact.scalars.exact_field import ExactMatrix
from liehom.exact.scalars.field import Field, Matrix, Scalar
from liehom.exact.scalars.floating import RR, FloatField, FloatMatrix
from liehom.exact.scalars.number_fields import AlgebraicNumber, NumberField
from liehom.exact.scalars.rational import QQ
from liehom.exact.scalars.subspaces import Subspace
from liehom.flow.methods.runge_kutta import Tableau
from liehom.flow.run.solution import Solution

# Parts of LaTeX formulas: names, words, numbers, sums of basis elements, matrices and environments of amsmath.

GREEK = re.compile(
    "alpha|beta|gamma|delta|epsilon|zeta|eta|theta|iota|kappa|lambda|mu|nu|xi|pi|rho|sigma|tau|upsilon|phi|chi|psi|"
    "omega|Gamma|Delta|Theta|Lambda|Xi|Pi|Sigma|Upsilon|Phi|Psi|Omega"
)
SIGNIFICANT_DIGITS = 6  # Digits of floats
MAX_PMATRIX_COLUMNS = 10  # A matrix of amsmath has at most this many columns, unless a counter of LaTeX is raised


# -- names and words -----------------------------------------------------------------------------------------
def name_latex(name: str) -> str:
    r"""LaTeX of the name of an algebra or a pair."""
    if not re.fullmatch(r"[A-Za-z0-9(),/+* .-]+", name, re.ASCII) or not re.match("[A-Za-z]+[0-9(*]", name):
        return words(name)

    def factor(match: re.Match[str]) -> str:
        word, index = match[1], match[2]
        letter = rf"\mathbb{{{word}}}" if word in ("R", "C", "H") else rf"\mathfrak{{{word}}}"
        return letter + (f"_{{{index}}}" if index else "")

    return re.sub("([A-Za-z]+)([0-9]*)", factor, name).replace("*", "^{*}")


def structure_latex(name: str) -> str:
    r"""LaTeX of a structure name, whose terms may be powers of R."""

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
    r"""LaTeX of a polynomial."""
    return re.sub(r"\^(\d+)", r"^{\1}", re.sub(r"x(\d+)", r"x_{\1}", text)).replace("*", " ")


def words(text: str) -> str:
    r"""Text of a formula, shortened to a line: \text{...}."""
    return rf"\text{{{escaped_latex(shown(text))}}}"


def dots(count: int, most: int | None) -> list[str]:
    """The line of dots of `aligned` for the lines beyond `most`, a list with at most one string."""
    return [] if most is None or count <= most else [r"&\;\;\vdots"]


# -- matrices and environments -------------------------------------------------------------------------------
def matrix_latex(matrix: Matrix, most: int | None = None) -> str:
    """Matrix in parentheses; with `most`, its upper left corner and dots."""
    nrows, ncols = matrix.shape if most is None else (min(most, n) for n in matrix.shape)
    corner = matrix if most is None else matrix.select(rows=range(nrows), columns=range(ncols))
    more = [r"\cdots"] * (ncols < matrix.ncols)
    rows = [[*(number_latex(matrix.field, x) for x in row), *more] for row in corner.to_rows()]
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
    return signed_sum(
        rf"\left({text}\right) {name}" if " + " in text or " - " in text
        else text[:-1] + name if text in ("1", "-1") else f"{text} {name}"
        for text, name in terms
    )  # fmt: skip


def signed_sum(terms: Iterable[str]) -> str:
    """Sum of terms, of which those with a sign are subtracted; 0 if there are none."""
    first, *others = [*terms] or ["0"]
    return first + "".join(f" - {x[1:]}" if x.startswith("-") else f" + {x}" for x in others)


def number_latex(field: Field, value: Scalar) -> str:
    r"""Number of a field: a fraction, a polynomial in the generator, or a float in six digits."""
    if isinstance(field, FloatField):
        digits, _, exponent = f"{value:.{SIGNIFICANT_DIGITS}g}".partition("e")
        return rf"{digits}\cdot10^{{{int(exponent)}}}" if exponent else digits
    if not isinstance(field, NumberField):
        return _fraction(value)
    symbol = rf"\sqrt{{{field.symbol[5:-1]}}}" if field.symbol.startswith("sqrt(") else symbol_latex(field.symbol)
    powers = ["", symbol, *(f"{symbol}^{{{p}}}" for p in range(2, field.degree))]
    terms = ((_fraction(c * field.leading**p), powers[p]) for p, c in enumerate(field.coordinates(value)) if c != 0)
    return signed_sum(text[:-1] + power if power and text in ("1", "-1") else text + power for text, power in terms)


def _fraction(value: Scalar) -> str:
    exact: Any = value  # an integer or fraction of flint
    if exact.q == 1:
        return str(exact.p)
    sign = "-" if exact < 0 else ""
    return rf"{sign}\frac{{{abs(exact.p)}}}{{{exact.q}}}"


def symbol_latex(name: str) -> str:
    r"""LaTeX of the name of a basis element or of a generator."""
    match = re.fullmatch(r"([A-Za-z]+)_?([0-9]*)", name, re.ASCII)
    if match is None:
        return words(name)
    word, index = match[1], match[2]
    text = f"\\{word}" if GREEK.fullmatch(word) else word if len(word) == 1 else rf"\mathrm{{{word}}}"
    return f"{text}_{{{index}}}" if index else text


# LaTeX of every object that notebooks show, for use in math mode.
# \begin{aligned} [e_0, e_1] &= e_2 \\ ... \end{aligned},      \begin{pmatrix} -2 & 0 \\ 0 & \frac{1}{2} \end{pmatrix}


def latex(obj: object, *, table: bool = False, most: int | None = None) -> str:
    r"""LaTeX of an algebra's brackets, a matrix, a pair, a verdict or another object of the library, as a string.

    Parameters
    ----------
    obj : LieAlgebra, Subalgebra, Representation, Pair, verdict, RootSystem, Matrix, number, ...
        A Killing form, for example, is a matrix: ``latex(g.killing_form())``. An element is what ``g.show(x)``
        returns. A table (`ConvergenceTable`, `Atlas`) becomes an array. An object without a formula, such as a
        `liehom.pauli.DynamicalLieAlgebra`, becomes its `repr` as text.
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
    if table and isinstance(obj, LieAlgebra):
        return _bracket_table(obj)
    formula = _formula(obj, most)
    if formula is not None:
        return formula
    if isinstance(obj, Displayed):
        text = repr(obj).removeprefix("<").removesuffix(">")
        return " ".join(words(line.strip()) for line in text.splitlines()[:1])
    return number_latex(*_with_field(obj))


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


@singledispatch
def _formula(obj: object, most: int | None) -> str | None:
    """LaTeX of an object that has a formula or a short statement; None for other objects."""
    formula = next((formula for kind, formula in _SHORT.items() if isinstance(obj, kind)), None)
    return None if formula is None else formula(obj, most)


@_formula.register
def _(obj: FailureReport, most: int | None) -> str:
    if obj.generic.holds is False:
        return words("(6.3) holds for no ") + r"\psi"
    if not (obj.parts or obj.not_searched):
        return words("(6.3) holds for every ") + r"\psi"
    parts = [
        f"{polynomial_latex(str(x.data))} = 0" if isinstance(x.data, RelativeInvariant) else words(x.description)
        for x in obj.parts
    ]
    lines = [f"&{part}" for part in parts[:most]] or [f"&{words('a cone')}"]
    return words("(6.3) fails on ") + r"\;" + aligned([*lines, *dots(len(parts), most)])


@_formula.register
def _(obj: Stratum, most: int | None) -> str:
    label = words(f"({', '.join(map(str, obj.label))})")
    isotropy = rf"\mathfrak{{g}}_{{m}} \cong {structure_latex(obj.structure)}"
    return rf"{label} \colon\; \dim G m = {obj.orbit_dimension}, \; {isotropy}"


@_formula.register
def _(obj: HighestWeightModule, most: int | None) -> str:
    weight = ", ".join(map(str, obj.highest_weight))
    return rf"V_{{({weight})}}({type_latex(obj.system.type)}), \quad \dim V = {obj.dimension}"


@_formula.register
def _(obj: RealModule, most: int | None) -> str:
    weight = ", ".join(map(str, obj.highest_weight))
    commutant = rf"\operatorname{{End}} V = \mathbb{{{obj.division_algebra}}}"
    return rf"V_{{({weight})}}({name_latex(obj.form.name)}), \quad \dim V = {obj.dimension}, \quad {commutant}"


@_formula.register
def _(obj: Decomposition, most: int | None) -> str:
    parts = [(x.multiplicity, x.irreducible_dimension) for x in obj.isotypic]
    terms = [(f"{m} \\," if m > 1 else "") + rf"\mathbf{{{d}}}" for m, d in parts[:most]]
    return r" \oplus ".join([*terms, *([r"\dots"] if len(terms) < len(parts) else [])]) or "0"


@_formula.register
def _(obj: Solution, most: int | None) -> str:
    if obj.t.ndim != 1 or not obj.t.size:
        return words(obj.message)
    last = [number_latex(RR, float(x)) for x in obj.y[:most, -1]]
    last += [r"\dots"] * (len(last) < len(obj.y))
    return rf"y({number_latex(RR, float(obj.t[-1]))}) = \left({', '.join(last)}\right)"


def _pair(pair: Pair) -> str:
    if pair.name:
        return name_latex(pair.name)
    dimensions = f"{pair.algebra.dimension}/{pair.subalgebra.dimension}"
    return words(f"pair of dimensions {dimensions}")


def _cells(cells: list[list[str]], most: int | None) -> str:
    head, *body = [" & ".join(map(words, row)) for row in cells]
    lines = [*body[:most], *([r"\vdots"] if most is not None and len(body) > most else [])]
    columns = "l" * len(cells[0])
    rows = " \\\\\n".join(lines)
    return f"\\begin{{array}}{{{columns}}}\n{head} \\\\ \\hline\n{rows}\n\\end{{array}}"


# -- brackets and matrices -----------------------------------------------------------------------------------
@_formula.register
def _(algebra: LieAlgebra, most: int | None) -> str:
    names = [symbol_latex(x) for x in algebra.basis_names]
    return _bracket_lines(names, _brackets(algebra, names, most=most), most)


@_formula.register
def _(family: LieAlgebraFamily, most: int | None) -> str:
    from sympy import latex as sympy_latex

    names = [symbol_latex(x) for x in family.basis_names]
    brackets = {
        pair: sum_latex((sympy_latex(v), names[k]) for k, v in sorted(row.items()))
        for pair, row in sorted(family._brackets.items())
    }
    return _bracket_lines(names, brackets, most)


def _bracket_lines(names: Sequence[str], brackets: Mapping[tuple[int, int], str], most: int | None) -> str:
    lines = [f"[{names[i]}, {names[j]}] &= {text}" for (i, j), text in islice(brackets.items(), most)]
    return aligned([*(lines or [r"[x, y] &= 0 \quad \text{for all } x, y"]), *dots(len(brackets), most)])


@_formula.register
def _(subalgebra: Subalgebra, most: int | None) -> str:
    names = [symbol_latex(x) for x in subalgebra.algebra.basis_names]
    field, basis = subalgebra.algebra.field, subalgebra.basis
    shown_rows = range(subalgebra.dimension if most is None else min(most, subalgebra.dimension))
    rows = [combination(field, basis.row(i), names) for i in shown_rows]
    rows += [r"\dots"] * (len(rows) < subalgebra.dimension)
    return rf"\left\langle {', '.join(rows)} \right\rangle" if rows else r"\{0\}"


@_formula.register
def _(space: Subspace, most: int | None) -> str:
    rows = [", ".join(number_latex(space.field, x) for x in row) for row in space.basis.to_rows()]
    vectors = [f"({row})" for row in rows[:most]]
    vectors += [r"\dots"] * (len(vectors) < len(rows))
    return rf"\left\langle {', '.join(vectors)} \right\rangle" if vectors else r"\{0\}"


@_formula.register
def _(rho: Representation, most: int | None) -> str:
    names = [symbol_latex(x) for x in rho.algebra.basis_names[:most]]
    lines = [rf"\rho({x}) &= {matrix_latex(a, most)}" for x, a in zip(names, rho.matrices, strict=False)]
    return aligned([*lines, *dots(len(rho.matrices), most)]) if lines else r"\rho = 0"


@_formula.register
def _(obj: Tableau, most: int | None) -> str:
    below = [[x if j < i or x != 0 else None for j, x in enumerate(row)] for i, row in enumerate(obj.a)]
    stages = [[c, *row] for c, row in zip(obj.c, below, strict=True)]
    weights = [[None, *row] for row in (obj.b, obj.embedded_b) if row is not None]
    upper, lower = (
        " \\\\\n".join(" & ".join("" if x is None else number_latex(obj.field, x) for x in row) for row in rows)
        for rows in (stages, weights)
    )
    return "\n".join([rf"\begin{{array}}{{c|{'c' * obj.stages}}}", rf"{upper} \\ \hline", lower, r"\end{array}"])


def _bracket_table(algebra: LieAlgebra) -> str:
    names, n = [symbol_latex(x) for x in algebra.basis_names], algebra.dimension
    cells = {(j, i): text for (i, j), text in _brackets(algebra, names, -1).items()} | _brackets(algebra, names)
    lines = [" & ".join(["", *names]) + r" \\ \hline"]
    lines += [" & ".join([names[i], *(cells.get((i, j), "0") for j in range(n))]) + r" \\" for i in range(n)]
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
    return {pair: sum_latex((number_latex(algebra.field, v), x) for v, x in terms) for pair, terms in rows.items()}


# Classes with a short formula
_SHORT: dict[type | tuple[type, ...], Callable[[Any, int | None], str]] = {
    Pair: lambda pair, most: _pair(pair),
    tuple(_ANSWERS): lambda verdict, most: f"{_pair(verdict.pair)} {words(f' {_ANSWERS[type(verdict)]}')}",
    Certificate: lambda proof, most: words(f"certificate of kind '{proof.kind}' over {proof.field.name}"),
    Classification: lambda row, most: rf"{name_latex(row.name or 'no catalogue name')} \colon\; {words(row.space)}",
    RealForm: lambda form, most: name_latex(form.name),
    RootSystem: lambda roots, most: (
        rf"{type_latex(roots.type)} \colon\; {matrix_latex(QQ.matrix(roots.cartan, (roots.rank, roots.rank)), most)}"
    ),
    DisplayedTable: lambda table, most: _cells(table._cells(), most),
    Homomorphism: lambda map_, most: matrix_latex(map_.matrix, most),
    LinearCombination: lambda x, most: combination(x.field, x.values, [symbol_latex(name) for name in x.names]),
    (ExactMatrix, FloatMatrix): matrix_latex,
}


# HTML of objects for notebooks: a card with a title, facts, a table, and details that unfold.
#     <div class="liehom"><p><b>title</b></p><table> facts </table><details> what unfolds </details></div>
# Every text is cut to a few hundred characters and escaped, so that a name with < or & stays text, and one with $ does
# not become a formula. Only data that the object holds, or that take milliseconds to compute, are shown.

SHOWN_TABLE_ROWS = 20
SHOWN_CHARACTERS = 500  # Characters of a title, a fact or a cell; the sentences of verdicts are shorter
SHOWN_DETAILS = 2000  # Characters of the details of a card
MOST_CHARACTERS = 400  # Characters of one number or linear combination


@dataclass(frozen=True, slots=True)
class Card:
    """HTML of an object as plain text: title, facts (None ones are left out), details that unfold."""

    title: str
    facts: Sequence[tuple[str, object]] = ()
    details: Sequence[tuple[str, str]] = ()

    @property
    def known(self) -> list[tuple[str, object]]:
        """The facts that are not None."""
        return [(name, value) for name, value in self.facts if value is not None]


def html(obj: object) -> str:
    """HTML of an object for a notebook, as a string: one element `div`, which needs no script and no style sheet."""
    if isinstance(obj, DisplayedTable):
        content = _table_of(obj)
    else:
        card = card_of(obj)
        facts = (f'<tr><th style="text-align:left">{_plain(n)}</th><td>{_plain(v)}</td></tr>' for n, v in card.known)
        content = f"<p><b>{_plain(card.title)}</b></p>" + (f"<table>{''.join(facts)}</table>" if card.known else "")
        content += "".join(details(n, f"<pre>{text(x, SHOWN_DETAILS, chr(10) + '...')}</pre>") for n, x in card.details)
    return f'<div class="liehom">{content}</div>'


@singledispatch
def card_of(obj: object) -> Card:
    """Content of an object's HTML; by default its `repr`, and its `str` in the details."""
    title, text = repr(obj), str(obj)
    return Card(title.removeprefix("<").removesuffix(">"), (), [] if text == title else [("details", text)])


@card_of.register
def _(obj: LieAlgebra) -> Card:
    names = ", ".join(obj.basis_names[:SHOWN_LINES]) + (", ..." if obj.dimension > SHOWN_LINES else "")
    brackets = str(obj).partition("\n")[2].partition("\n")[2]
    title = " ".join(filter(None, ["Lie algebra", obj.name, f"of dimension {obj.dimension} over {obj.field.name}"]))
    return Card(title, (("basis", names or None),), [("brackets", brackets or "  all brackets vanish")])


@card_of.register
def _(obj: Subalgebra) -> Card:
    rows = obj.basis.select(rows=range(min(obj.dimension, SHOWN_LINES)))
    basis = [obj.algebra.show(row) for row in rows] + ["..."] * (obj.dimension > SHOWN_LINES)
    return Card(_bare(obj), (("basis", ", ".join(basis) or None),))


@card_of.register
def _(obj: Representation) -> Card:
    title = " ".join(filter(None, ["representation", obj.name, f"on {obj.field.name}^{obj.size}"]))
    return Card(title, (("algebra", _bare(obj.algebra)), ("coordinates", obj.coordinates)))


@card_of.register
def _(obj: Pair) -> Card:
    title = f"pair {obj.name or 'g/h'} of dimension {obj.dimension}"
    return Card(title, (("g", _bare(obj.algebra)), ("h", _bare(obj.subalgebra))))


@card_of.register
def _(obj: Homomorphism) -> Card:
    return Card(_bare(obj), (("source", _bare(obj.source)), ("target", _bare(obj.target))))


@card_of.register
def _(obj: RootSystem) -> Card:
    roots = ", ".join(map(str, obj.positive_roots[:SHOWN_LINES]))
    more = f", ... ({len(obj.positive_roots)} in all)" if len(obj.positive_roots) > SHOWN_LINES else ""
    facts = (("type", obj.type), ("rank", obj.rank), ("roots", obj.number_of_roots))
    cartan = "\n".join(" ".join(f"{x:>2}" for x in row) for row in obj.cartan)
    return Card("root system", facts, [("positive roots", roots + more), ("Cartan matrix", cartan)])


@card_of.register
def _(obj: RealForm) -> Card:
    facts = (("type", obj.type), ("dimension", obj.dimension), ("real rank", obj.real_rank))
    return Card(f"real form {obj.name}", (*facts, ("maximal compact", obj.maximal_compact)))


# -- verdicts ------------------------------------------------------------------------------------------------
@card_of.register
def _(obj: Full | NotFull) -> Card:
    defect = obj.rank_defect if isinstance(obj, NotFull) else None
    facts = (("because", obj.reason), ("certificate", f"kind {obj.certificate.kind!r}"), ("rank defect", defect))
    return Card(_sentence(obj.pair, obj.full), facts, [("certificate", str(obj.certificate))])


@card_of.register(NumericallyFull)
@card_of.register(NumericallyNotFull)
@card_of.register(NumericallyUndecided)
def _(obj: NumericallyFull | NumericallyNotFull | NumericallyUndecided) -> Card:
    facts = (
        ("because", obj.reason),
        ("certificate", "none: a numerical verdict is not proved"),
        ("least singular value", f"{obj.smallest:.3g}"),
    )
    return Card(_sentence(obj.pair, obj.full), facts)


def _sentence(pair: Pair, full: bool | None) -> str:
    answer = {True: "is full", False: "is not full", None: "is undecided"}[full]
    return f"The pair {pair.name or f'of dimensions {pair.algebra.dimension}/{pair.subalgebra.dimension}'} {answer}."


@card_of.register
def _(obj: Certificate) -> Card:
    head, _, body = str(obj).partition("\n")
    return Card(head, (), [("fields", body)] if body else [])


@card_of.register
def _(obj: Classification) -> Card:
    facts = (
        ("space", obj.space),
        ("isotropy", obj.row.isotropy),
        ("dimension of the ideal inside h", obj.ideal.dimension or None),
    )
    return Card(f"classification: {obj.name or 'no catalogue name'}", facts)


@card_of.register
def _(obj: FailureReport) -> Card:
    facts = (
        ("fails on", ", and ".join(part.description for part in obj.parts) or None),
        ("complete for", ", ".join(obj.searched) or None),
        ("not searched", ", ".join(obj.not_searched) or None),
    )
    return Card(str(obj).partition(";")[0], facts)


# -- trajectories --------------------------------------------------------------------------------------------
@card_of.register
def _(obj: Solution) -> Card:
    facts: list[tuple[str, object]] = [("status", obj.status)]
    if np.ndim(obj.n_steps) == 0:
        facts.append(("steps", int(obj.n_steps)))
    if obj.t.ndim == 1 and obj.t.size:
        last = ", ".join(f"{x:.6g}" for x in obj.y[:SHOWN_LINES, -1]) + (", ..." if len(obj.y) > SHOWN_LINES else "")
        facts += [("t", f"{obj.t[0]:.6g} to {obj.t[-1]:.6g}, {obj.t.size} points"), ("last point", f"({last})")]
    else:
        facts.append(("y", f"array of shape {obj.y.shape}"))
    return Card(obj.message, facts, [("report", str(obj.report))])


# -- elements of HTML ----------------------------------------------------------------------------------------
# characters that HTML does not allow, and halves of pairs, which UTF-8 cannot write
_NOT_ALLOWED = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")


def shortened(words: str, most: int = MOST_CHARACTERS, end: str = " ...") -> str:
    """A string, cut to `most` characters."""
    return words if len(words) <= most else f"{words[:most]}{end}"


def text(value: object, most: int | None = None, end: str = " ...") -> str:
    """An escaped string, cut to `most` characters."""
    words = str(value)
    return escape(_NOT_ALLOWED.sub("\ufffd", words if most is None else shortened(words, most, end)))


def row(tag: str, cells: Iterable[str]) -> str:
    """A row of a table from elements; `tag` may have attributes."""
    return f"<tr>{''.join(f'<{tag}>{cell}</{tag.split()[0]}>' for cell in cells)}</tr>"


def details(summary: str, content: str) -> str:
    """An element that unfolds."""
    return f"<details><summary>{text(summary)}</summary>{content}</details>"


def _table_of(table: DisplayedTable) -> str:
    head, *body = table._cells()
    rows = [row("th", map(_plain, head)), *(row("td", map(_plain, cells)) for cells in body[:SHOWN_TABLE_ROWS])]
    notes = list(table._notes())
    if len(body) > SHOWN_TABLE_ROWS:
        notes.insert(0, f"... and {len(body) - SHOWN_TABLE_ROWS} further rows")
    caption = f"<p><b>{_plain(table._caption())}</b></p>" if table._caption() else ""
    return f"{caption}<table>{''.join(rows)}</table>" + "".join(
        f"<p>{_plain(note)}</p>" for note in notes[:SHOWN_LINES]
    )


def _plain(value: object) -> str:
    # MathJax reads no formula across elements, so a dollar or backslash that stands alone in one begins none
    return re.sub(r"[$\\]", r"<span>\g<0></span>", text(value, SHOWN_CHARACTERS))


def _bare(obj: object) -> str:
    return repr(obj).removeprefix("<").removesuffix(">")
