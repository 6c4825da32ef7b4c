r"""LaTeX of every object that notebooks show, for use in math mode; `latex_parts` has the parts of the formulas.

\begin{aligned} [e_0, e_1] &= e_2 \\ ... \end{aligned},      \begin{pmatrix} -2 & 0 \\ 0 & \frac{1}{2} \end{pmatrix}
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import singledispatch
from itertools import islice

from liehom.algebra import Homomorphism, LieAlgebra, LieAlgebraFamily, RealForm, RootSystem, Subalgebra
from liehom.algebra.core.names import LinearCombination
from liehom.display import Displayed, DisplayedTable
from liehom.errors import InputError
from liehom.fullness import (
    Certificate,
    Classification,
    FailureReport,
    Full,
    NotFull,
    NumericallyFull,
    NumericallyNotFull,
    NumericallyUndecided,
)
from liehom.homogeneous import Stratum
from liehom.integrators import Solution, Tableau
from liehom.io.latex_parts import (
    aligned,
    combination,
    dots,
    matrix_latex,
    name_latex,
    number_latex,
    polynomial_latex,
    structure_latex,
    sum_latex,
    symbol_latex,
    type_latex,
    words,
)
from liehom.representations import Decomposition, HighestWeightModule, Pair, RealModule, Representation
from liehom.scalars import QQ, RR, AlgebraicNumber, Field, Matrix, Scalar, Subspace
from liehom.scalars.fields.exact_field import ExactMatrix
from liehom.scalars.fields.floating import FloatMatrix


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
    if table and isinstance(obj, LieAlgebra):
        return _bracket_table(obj)
    found = _formula(obj, most)
    if found is not None:
        return found
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
    return None


@_formula.register
def _(obj: Pair, most: int | None) -> str:
    return _pair(obj)


@_formula.register
def _(obj: Full | NotFull | NumericallyFull | NumericallyNotFull | NumericallyUndecided, most: int | None) -> str:
    return f"{_pair(obj.pair)} {words(f' {_ANSWERS[type(obj)]}')}"


@_formula.register
def _(obj: Certificate, most: int | None) -> str:
    return words(f"certificate of kind '{obj.kind}' over {obj.field.name}")


@_formula.register
def _(obj: Classification, most: int | None) -> str:
    return rf"{name_latex(obj.name or 'no catalogue name')} \colon\; {words(obj.space)}"


@_formula.register
def _(obj: FailureReport, most: int | None) -> str:
    if obj.generic.holds is False:
        return words("(6.3) holds for no ") + r"\psi"
    parts = [
        f"{polynomial_latex(str(x.data))} = 0" if x.kind == "hypersurface" else words(x.description) for x in obj.parts
    ]
    lines = [f"&{part}" for part in parts[:most]] or [f"&{words('a cone')}"]
    return words("(6.3) fails on ") + r"\;" + aligned([*lines, *dots(len(parts), most)])


@_formula.register
def _(obj: RealForm, most: int | None) -> str:
    return name_latex(obj.name)


@_formula.register
def _(obj: RootSystem, most: int | None) -> str:
    return rf"{type_latex(obj.type)} \colon\; {matrix_latex(QQ.matrix(obj.cartan, (obj.rank, obj.rank)), most)}"


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
    found = [(x.multiplicity, x.irreducible_dimension) for x in obj.isotypic]
    terms = [(f"{m} \\," if m > 1 else "") + rf"\mathbf{{{d}}}" for m, d in found[:most]]
    return r" \oplus ".join([*terms, *([r"\dots"] if len(terms) < len(found) else [])]) or "0"


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


@_formula.register
def _(obj: DisplayedTable, most: int | None) -> str:
    return _cells(obj._cells(), most)


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


def _bracket_lines(names: Sequence[str], found: Mapping[tuple[int, int], str], most: int | None) -> str:
    lines = [f"[{names[i]}, {names[j]}] &= {text}" for (i, j), text in islice(found.items(), most)]
    return aligned([*(lines or [r"[x, y] &= 0 \quad \text{for all } x, y"]), *dots(len(found), most)])


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
def _(obj: Homomorphism, most: int | None) -> str:
    return matrix_latex(obj.matrix, most)


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
    return {pair: sum_latex((number_latex(algebra.field, v), x) for v, x in terms) for pair, terms in rows.items()}


@_formula.register
def _(element: LinearCombination, most: int | None) -> str:
    return combination(element.field, element.values, [symbol_latex(x) for x in element.names])


@_formula.register(ExactMatrix)
@_formula.register(FloatMatrix)
def _(obj: Matrix, most: int | None) -> str:
    return matrix_latex(obj, most)
