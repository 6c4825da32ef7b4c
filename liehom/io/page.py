"""The page of a pair for the browser."""

from __future__ import annotations

import base64
import hashlib
import json
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from liehom.base.disk import check_target, write_file
from liehom.base.errors import InputError, LiehomError, displayed
from liehom.base.typing import Array
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.tables import linear_combination
from liehom.exact.algebra.roots.real_form import RealForm
from liehom.exact.fullness.certificate import Certificate
from liehom.exact.fullness.checker.verify_roots import characteristic_polynomial, count_right_of, trimmed
from liehom.exact.fullness.decide import decide_fullness
from liehom.exact.fullness.verdict import (
    FailureReport,
    Full,
    NotFull,
    NumericallyFull,
    NumericallyNotFull,
    NumericallyUndecided,
    Verdict,
    failure_report,
)
from liehom.exact.geometry.summary import geometry_facts
from liehom.exact.representations.core.pair import Pair
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix, as_exact
from liehom.exact.scalars.field import Matrix, Scalar
from liehom.io import renderings
from liehom.io.files import to_json
from liehom.io.renderings import MOST_CHARACTERS, card_of, row, shortened, text
from liehom.plotting.canvas import Drawing, inline_svg, matplotlib_module
from liehom.plotting.diagram_plot import plot_bracket_table, plot_satake
from liehom.plotting.strata_plot import failure_curves, plot_failure_cone

# Elements of HTML as strings. Arguments named `content` are elements; all other arguments are text and are escaped.

MOST_ROWS = 12  # Rows and columns of matrices, and rows of most tables, that are shown
MOST_IN_BLOCK = 4000  # Characters of a block of lines


def paragraph(words: object, kind: str = "") -> str:
    """A paragraph of text, with a class of the style sheet."""
    return f'<p class="{kind}">{text(words)}</p>' if kind else f"<p>{text(words)}</p>"


def code_block(lines: object) -> str:
    """Lines of code or of a summary, which scroll sideways in their box."""
    return f"<pre>{text(lines, MOST_IN_BLOCK)}</pre>"


def items(lines: Iterable[object]) -> str:
    """A list of short strings."""
    return f"<ul>{''.join(f'<li>{text(line)}</li>' for line in lines)}</ul>"


def section(name: str, heading: str, *content: str, unfolded: bool = False) -> str:
    """A section that unfolds, with a heading that links point to as ``#name``."""
    start = f'<section id="{text(name)}"><details class="part"{" open" if unfolded else ""}>'
    return f"{start}<summary><h2>{text(heading)}</h2></summary><div>{''.join(content)}</div></details></section>"


def details(summary: str, *content: str) -> str:
    """Content that unfolds."""
    return renderings.details(summary, f"<div>{''.join(content)}</div>")


def facts(rows: Iterable[tuple[str, object]], most: int = 1000) -> str:
    """A table of names and values; values that are None are left out."""
    body = "".join(
        f'<tr><th scope="row">{text(name)}</th><td>{text(value, most)}</td></tr>'
        for name, value in rows
        if value is not None
    )
    return f'<div class="box"><table class="facts">{body}</table></div>'


def table(head: Sequence[str], rows: Sequence[Sequence[object]], what: str, most: int = MOST_ROWS) -> str:
    """A table; below it, if it is cut to `most` rows, how many of `what` there are."""
    top = row('th scope="col"', map(text, head))
    body = "".join(row("td", (text(x, MOST_CHARACTERS) for x in cells)) for cells in rows[:most])
    cut = f'<div class="box"><table><thead>{top}</thead><tbody>{body}</tbody></table></div>'
    return cut + (paragraph(f"The first {most} of {len(rows):,} {what}.", "note") if len(rows) > most else "")


def number(matrix: Matrix, value: Scalar) -> str:
    """Text of an entry of a matrix: exact, or a float with six digits."""
    return matrix.field.show(value) if matrix.field.exact else f"{float(value):.6g}"


def matrix_table(matrix: Matrix, label: str) -> str:
    """A matrix with its name before it; of a large one the first entries that are not 0."""
    if max(matrix.shape) > MOST_ROWS:
        places = [(i, j) for i, row in enumerate(matrix) for j, x in enumerate(row) if x != 0]
        entries = "; ".join(f"({i}, {j}): {number(matrix, matrix[i, j])}" for i, j in places[:MOST_ROWS])
        words = f"{label} is {matrix.nrows} x {matrix.ncols} with {len(places)} entries that are not 0"
        return paragraph(f"{words}{', first' if len(places) > MOST_ROWS else ''}: {entries}", "note")
    rows = [f"<tr>{''.join(_cell(matrix, i, j) for j in range(matrix.ncols))}</tr>" for i in range(matrix.nrows)]
    grid = f'<table class="matrix" aria-label="{text(label)}">{"".join(rows)}</table>' if rows else "empty"
    return f'<div class="box equation"><span>{text(label)} =</span>{grid}</div>'


def _cell(matrix: Matrix, i: int, j: int) -> str:
    value = matrix[i, j]
    return "<td class=z>0</td>" if value == 0 else f"<td>{text(number(matrix, value), MOST_CHARACTERS)}</td>"


def figure(content: str, caption: str) -> str:
    """A picture with its caption, which is also its description for readers of screens."""
    return f"<figure>{content}<figcaption>{text(caption)}</figcaption></figure>"


def download(data: Mapping[str, Any], file: str, most: int) -> str | None:
    """A link that saves a JSON object, which the link itself contains, as a file; None if it has over `most` bytes."""
    content = json.dumps(data, allow_nan=False).encode()
    if len(content) > most:
        return None
    size = f"{len(content):,} bytes" if len(content) < 10_000 else f"{len(content) / 1000:,.0f} kB"
    link = f"data:application/json;base64,{base64.b64encode(content).decode()}"
    return f'<a download="{text(file)}" href="{link}">{text(file)}</a> ({size})'


def json_script(name: str, data: object) -> str:
    """Data for a script of the page; no string in them can end the element."""
    content = json.dumps(data, allow_nan=False, separators=(",", ":"))
    for character in "<>&":
        content = content.replace(character, f"\\u{ord(character):04x}")
    return f'<script type="application/json" id="{text(name)}">{content}</script>'


# Pictures of a page: the failure cone, diagrams of simple factors, the pattern of the brackets.

MAX_PATTERN = 12  # Largest dimension for which the pattern of the brackets is drawn
MOST_DIAGRAMS = 4
MOST_POINTS = 200  # Points of a curve of the cone that can be turned


def picture(draw: Drawing, name: str, caption: str, kinds: Sequence[str] = ("light", "dark")) -> str:
    """A figure with a light and a dark version of a picture; without matplotlib, a sentence about it."""
    if (missing := without_matplotlib()) is not None:
        return missing
    drawn = {kind: inline_svg(draw, f"{name}-{kind}", dark=kind == "dark") for kind in kinds}
    return figure("".join(f'<div class="{kind}">{svg}</div>' for kind, svg in drawn.items()), caption)


def without_matplotlib() -> str | None:
    """The sentence that replaces a picture, or None if matplotlib is installed."""
    try:
        matplotlib_module("")
    except InputError as missing:
        return paragraph(f"No picture: when this page was written, {missing}", "note")
    return None


def bracket_picture(algebra: LieAlgebra) -> str:
    """The pattern of the brackets, for small algebras."""
    if not 0 < algebra.dimension <= MAX_PATTERN:
        return ""
    caption = (
        "Brackets [row, column]: each basis element has its colour at the margin, and each term of a bracket is a "
        "strip in the colour of its basis element, with its sign. The table has the same content."
    )
    return picture(lambda: plot_bracket_table(algebra), "pattern", caption)


def diagrams(parts: Mapping[str, LieAlgebra]) -> str:
    """Satake diagrams of the simple factors of algebras, or why there are none."""
    factors: dict[str, list[str]] = {}
    absent = []
    for name, algebra in parts.items():
        if not algebra.dimension:
            continue
        try:
            levi = algebra.levi_decomposition().levi.as_algebra()
            forms = [form.name for form in levi.real_forms()] if levi.dimension else []
        except LiehomError as unknown:  # floats, or real forms that are not decided
            absent.append(f"No Satake diagram of {name}: {unknown}.")
            continue
        for form in forms:
            factors.setdefault(form, []).append(name)
        if not forms:
            absent.append(f"{name} is solvable, so it has no Satake diagram.")
    drawn = [
        picture(lambda form=form: plot_satake(form), f"satake{i}", _satake_caption(form, names))  # type: ignore[misc]
        for i, (form, names) in enumerate(list(factors.items())[:MOST_DIAGRAMS])
    ]
    if len(factors) > MOST_DIAGRAMS:
        absent.append(f"The first {MOST_DIAGRAMS} of {len(factors)} Satake diagrams are drawn.")
    return f'<div class="diagrams">{"".join(drawn)}</div>' + "".join(paragraph(words, "note") for words in absent)


def _satake_caption(name: str, inside: Sequence[str]) -> str:
    satake = RealForm.of_name(name).satake
    times = {part: f" ({inside.count(part)} times)" if inside.count(part) > 1 else "" for part in dict.fromkeys(inside)}
    factor = " and ".join(part + often for part, often in times.items())
    black = f"{len(satake.black)} black" if satake.black else "no black nodes"
    arrows = f", {len(satake.arrows)} arrow{'s' if len(satake.arrows) > 1 else ''}" if satake.arrows else ""
    split = (
        f"restricted roots {satake.restricted_type}, real rank {satake.real_rank}" if satake.real_rank else "compact"
    )
    return f"Satake diagram of {name}, a simple factor of {factor}: type {satake.type}, {black}{arrows}; {split}"


def cone_picture(pair: Pair, report: FailureReport) -> str:
    """The cone in g/h of dimension 2, or the cone of dimension 3 that can be turned."""
    if pair.dimension not in (2, 3):
        return paragraph(f"The cone is drawn for dim g/h = 2 or 3; here dim g/h = {pair.dimension}.", "note")
    if (missing := without_matplotlib()) is not None:
        return missing
    curves = failure_curves(report, pair.dimension)
    if not curves:
        return paragraph("No part of it is a curve or surface over the reals that could be drawn.", "note")
    caption = "The cone on which (6.3) fails, cut off at the unit "
    if pair.dimension == 2:
        return picture(lambda: plot_failure_cone(pair), "cone", f"{caption}circle.")
    # shown where no script runs, on white
    still = picture(lambda: plot_failure_cone(pair), "cone", f"{caption}sphere.", ["still"])
    points = [np.round(_thinned(curve.T), 4).tolist() for curve in curves]
    help_ = "Drag it, or use the arrow keys or the buttons, to turn it."
    return (
        f'<div class="turn" hidden>{figure("<div></div>", f"{caption}sphere. {help_}")}</div>'
        f'<div class="unturned">{still}</div>' + json_script("cone", points)
    )


def _thinned(points: Array) -> Array:
    """At most `MOST_POINTS` of the points of a curve, its ends among them."""
    kept = np.linspace(0, len(points) - 1, min(len(points), MOST_POINTS)).round().astype(int)
    return points[kept]


# The steps of a proof in words, each with its numbers, for each kind of certificate. The steps are those of the
# independent checker, in its order; docs/theory/fullness.md proves that they suffice. V = g/h has the coordinates x of
# ``pair.coordinates``, and rho is the action of h on V. The caller has verified the certificate: that a number shown
# here is 0, or a matrix commutes, is not computed a second time.

MAX_CHARACTERISTIC = 60  # Largest matrix whose eigenvalues are counted once more for the page
MOST_EIGENVALUES = 30


def certificate_steps(pair: Pair, certificate: Certificate) -> list[str]:
    """Steps of the proof as elements of HTML that unfold."""
    return KINDS[certificate.kind](pair, certificate)


# -- full ----------------------------------------------------------------------------------------------------
def _trivial(pair: Pair, certificate: Certificate) -> list[str]:
    reason = (
        "h = g, so there is no η outside h, and nothing has to be checked."
        if pair.dimension == 0
        else "Every η outside h spans g/h already, so η and h span g."
    )
    return [details(f"g/h has dimension {pair.dimension}", paragraph(reason))]


def _full(pair: Pair, certificate: Certificate) -> list[str]:
    n, d, data = pair.algebra.dimension, pair.dimension, pair.subalgebra.quotient()
    lift = as_exact(data.lift)
    form = lift @ certificate.matrix("form", n, n) @ lift.T
    elements = [as_exact(pair.algebra.row(row)) for row in certificate.matrix("elements", None, n).to_rows()]
    moves = [_action(pair, z) for z in elements]
    eta = certificate.vector("eta", n)
    at = as_exact(pair.coordinates(eta))
    scales = [m.trace() / pair.field.convert(d) for m in moves]
    rows = [
        [f"z{j}", pair.algebra.show(z.row(0)), number(form, c)]
        for j, (z, c) in enumerate(zip(elements, scales, strict=True))
    ]
    reached = [["η", _row(at)], *([f"[z{j}, η]", _row(at @ m.T)] for j, m in enumerate(moves))]
    first = [matrix_table(m, f"ρ(z{j})") for j, m in enumerate(moves[:3])]
    return [
        details(
            "There is a positive definite form P on g/h",
            paragraph(
                "P is a symmetric matrix in the coordinates x of g/h. Gaussian elimination shows that it is positive "
                "definite."
            ),
            matrix_table(form, "P"),
        ),
        details(
            "1 element z of h preserves P" if len(elements) == 1 else f"{len(elements)} elements z of h preserve P",
            paragraph(
                "Up to a factor, that is, ρ(z)ᵀ P + P ρ(z) = 2c P, where ρ(z) is the matrix of z on g/h. So ρ(z) − c "
                "is skew for P: an infinitesimal rotation."
            ),
            table(["", "element of h", "c"], rows, "elements"),
            *first,
            paragraph(f"Shown are the first 3 of {len(moves)} matrices.", "note") if len(moves) > 3 else "",
        ),
        details(
            f"At one η, these elements and η reach all {d} directions of g/h",
            paragraph(
                f"η = {shortened(pair.algebra.show(eta))}. The vectors below, in the coordinates x, have rank {d}."
            ),
            table(["", "coordinates in g/h"], reached, "vectors"),
        ),
        details(
            "What holds at one η holds at all",
            paragraph(
                "The maps ρ(z) − c are skew for P, so the group that they generate preserves the spheres of P, and "
                "its closure is compact. By the step before, the orbit of η under it has the dimension of the sphere, "
                "so it is the sphere. The rank is the same at all points of an orbit, and at their multiples. Hence "
                "[h, η] + ℝη + h = g for every η outside h."
            ),
            paragraph(
                "A proof without groups is Theorem 2 of the theory of fullness in the documentation; Coq has checked "
                "it."
            ),
        ),
    ]


# -- not full ------------------------------------------------------------------------------------------------
def _witness(pair: Pair, certificate: Certificate) -> list[str]:
    n, g = pair.algebra.dimension, pair.algebra
    minpoly = trimmed(certificate.vector("minpoly"))
    size = len(minpoly) - 1
    eta, phi = (certificate.polynomials(name, n, size) for name in ("eta", "phi"))
    columns = [as_exact(g.row(eta.T.row(s))) for s in range(size)]
    steps = []
    if size > 1:
        low, high = (pair.field.show(x) for x in certificate.vector("interval", 2))
        equation = _polynomial(certificate.field, minpoly)
        steps.append(
            details(
                f"θ is a real number between {shortened(low, 40)} and {shortened(high, 40)}",
                paragraph(f"θ is a root of {shortened(equation)}, which changes its sign between these numbers."),
            )
        )
    names = [f"{x}*" for x in g.basis_names]
    basis = as_exact(pair.subalgebra.basis)
    brackets = [
        [
            g.show(z),
            _vector_in_theta(
                certificate.field, [as_exact(g.row(g.bracket(z, c.row(0)))) for c in columns], g.basis_names
            ),
            "0",
        ]
        for z in basis.select(rows=range(min(basis.nrows, MOST_ROWS))).to_rows()
    ]
    brackets += [["", "", ""]] * (basis.nrows - len(brackets))  # the table counts them and shows none
    form = _vector_in_theta(certificate.field, phi.T.split_rows(1, n) if size else [], names)
    steps += [
        details("η is outside h", paragraph(f"η = {_vector_in_theta(certificate.field, columns, g.basis_names)}")),
        details(
            "φ is a linear form on g that is not 0, but vanishes on h and at η",
            paragraph(f"φ = {form}, where e* is the coordinate of the basis element e."),
        ),
        details(
            "φ also vanishes on [h, η]",
            table(["z in h", "[z, η]", "φ([z, η])"], brackets, "elements of a basis of h")
            if basis.nrows
            else paragraph("h = 0, so there are no brackets."),
        ),
        details("So the pair is not full", paragraph("[h, η] + ℝη + h is in the kernel of φ, which is not g.")),
    ]
    if "also" in certificate.fields:
        also = certificate.fields["also"]
        steps.append(details("A second proof", *certificate_steps(pair, also)))
    return steps


def _commutant(pair: Pair, certificate: Certificate) -> list[str]:
    d, n = pair.dimension, pair.algebra.dimension
    matrix = certificate.matrix("matrix", d, d)
    complement = certificate.matrix("complement", d, n)
    cut = certificate.number("cut")
    basis = [[f"u{j}", pair.algebra.show(row)] for j, row in enumerate(complement.to_rows())]
    return [
        details(
            "T is a map of g/h",
            paragraph("T has the matrix below in a basis u of a complement of h."),
            table(["", "element of g"], basis, "basis elements"),
            matrix_table(matrix, "T"),
        ),
        details("T commutes with h", paragraph("T ρ(z) = ρ(z) T for the matrix ρ(z) on g/h of every z in h.")),
        details(
            f"Some eigenvalues of T, but not all, have a real part above {shortened(pair.field.show(cut), 40)}",
            paragraph(f"Rounded eigenvalues: {_eigenvalues(matrix)}."),
            _counted(matrix, cut, d),
        ),
        details(
            "So the pair is not full",
            paragraph(
                "The sum W of the generalized eigenspaces of T above this number is neither 0 nor g/h. All of ρ(h) "
                "commutes with T, hence preserves W: for η in W, [h, η] and η stay in W."
            ),
        ),
    ]


def _dominance(pair: Pair, certificate: Certificate) -> list[str]:
    d = pair.dimension
    row = as_exact(pair.algebra.row(certificate.vector("element", pair.algebra.dimension)))
    cut, eps = certificate.number("cut"), certificate.number("eps")
    rho = _action(pair, row)
    show = pair.field.show
    matrix = rho - rho.field.identity(d).scale(rho.trace() / rho.field.convert(d))
    adjoint = _adjoint(pair, rho)
    counts = ""
    if max(d, adjoint.nrows) <= MAX_CHARACTERISTIC:
        top = count_right_of(matrix.field, characteristic_polynomial(matrix), cut)
        m = adjoint.nrows - count_right_of(matrix.field, characteristic_polynomial(adjoint), -eps)
        counts = paragraph(f"Here dim W = {top} and m = {m}, and {top} + {m} = {top + m} is less than dim g/h = {d}.")
    return [
        details(
            "X is an element of h",
            paragraph(f"X = {shortened(pair.algebra.show(row.row(0)))}"),
            paragraph("A is the matrix of X on g/h, made traceless by a multiple of the identity."),
            matrix_table(matrix, "A"),
        ),
        details(
            "Its top eigenspace W is not 0",
            paragraph(
                f"W is the sum of the generalized eigenspaces of A with real part above {shortened(show(cut), 40)}. "
                f"No real part is between {shortened(show(cut - eps), 40)} and this number."
            ),
            paragraph(f"Rounded eigenvalues of A: {_eigenvalues(matrix)}."),
        ),
        details(
            "Few elements of h can leave W",
            paragraph(
                "m is the number of eigenvalues of ad ρ(X) on ρ(h) with real part at most "
                f"−{shortened(show(eps), 40)}. The elements of the other eigenspaces map W to W."
            ),
            paragraph(f"Rounded eigenvalues of ad ρ(X): {_eigenvalues(adjoint)}."),
        ),
        details("dim W + m is less than dim g/h", counts or paragraph("The checker has counted both exactly.")),
        details(
            "So the pair is not full",
            paragraph("For η in W, [h, η] + ℝη is in W plus a space of dimension m, so it is not g/h."),
        ),
    ]


KINDS = {"trivial": _trivial, "full": _full, "witness": _witness, "commutant": _commutant, "dominance": _dominance}


# -- numbers -------------------------------------------------------------------------------------------------
def _action(pair: Pair, row: ExactMatrix) -> ExactMatrix:
    """The matrix (d, d) of an element of h on g/h, acting on columns."""
    data = pair.subalgebra.quotient()
    return as_exact(pair.algebra.table.contract(row, data.lift, data.projection)[0]).T


def _adjoint(pair: Pair, rho: ExactMatrix) -> ExactMatrix:
    """The matrix of ad rho(X) on rho(h), in an echelon basis of rho(h)."""
    field, d = rho.field, pair.dimension
    flat = field.stack_rows([as_exact(m).reshape(1, d * d) for m in pair.isotropy_matrices()], d * d)
    basis, pivots = flat.echelon()
    maps = [basis.select(rows=[i]).reshape(d, d) for i in range(len(pivots))]
    moved = field.stack_rows([(rho @ b - b @ rho).reshape(1, d * d) for b in maps], d * d)
    return moved.select(columns=pivots)


def _counted(matrix: ExactMatrix, cut: Scalar, d: int) -> str:
    if d > MAX_CHARACTERISTIC:
        return paragraph("The checker has counted them exactly.")
    count = count_right_of(matrix.field, characteristic_polynomial(matrix), cut)
    return paragraph(f"An exact count, with multiplicity: {count} of {d}.")


def _eigenvalues(matrix: ExactMatrix) -> str:
    """Eigenvalues as floats, the largest real part first, or why there are none to show."""
    try:
        values = np.linalg.eigvals(matrix.to_numpy()) if matrix.nrows else np.zeros(0)
    except (LiehomError, OverflowError, np.linalg.LinAlgError):
        return "too large for floats"
    tidy = np.round(np.asarray(values, dtype=complex), 6) + 0.0
    shown = [_complex(x) for x in sorted(tidy, key=lambda x: (-x.real, x.imag))]
    more = f", ... ({len(shown)} in all)" if len(shown) > MOST_EIGENVALUES else ""
    return (", ".join(shown[:MOST_EIGENVALUES]) + more) or "none"


def _complex(x: complex) -> str:
    sign = "−" if x.imag < 0 else "+"
    return f"{x.real:.6g}" + (f" {sign} {abs(x.imag):.6g}i" if x.imag else "")


def _polynomial(field: ExactField, coefficients: Sequence[Scalar]) -> str:
    """A polynomial in theta from its ascending coefficients."""
    terms = []
    for i, c in enumerate(coefficients):
        if c != 0:
            power = "θ" if i == 1 else f"θ^{i}"
            terms += linear_combination(field, [power], [c]) if i else [field.show(c)]
    return " + ".join(reversed(terms)).replace("+ -", "- ") or "0"


def _vector_in_theta(field: ExactField, parts: Sequence[ExactMatrix], names: Sequence[str]) -> str:
    """A linear combination of names with the coefficients sum of theta^s times the rows `parts[s]`."""
    terms = []
    for j, name in enumerate(names):
        value = _polynomial(field, [part[0, j] for part in parts])
        if value != "0":
            factor = {"1": "", "-1": "-"}.get(value, f"({value})*" if " " in value else f"{value}*")
            terms.append(f"{factor}{name}")
    return shortened(" + ".join(terms).replace("+ -", "- ") or "0")


def _row(row: ExactMatrix) -> str:
    return f"({', '.join(number(row, x) for x in row.row(0))})"


# The page of a pair: verdict, certificate, failure cone, structure, isotropy and brackets.

FOLDER = Path(__file__).resolve().parent
VERDICTS = (Full, NotFull, NumericallyFull, NumericallyNotFull, NumericallyUndecided)

MOST_BRACKETS = 60
MOST_MATRICES = 12
MAX_CURVED = 8  # Largest dimension of G/H whose geometry a page describes
MAX_DESCRIBED = 250  # Largest dimension of an algebra whose structure a page describes
MAX_SEARCHED = 60  # Largest dim g for which a page says where (6.3) fails: larger ones can take minutes
MAX_FILE = 1_000_000  # Bytes of a file that a page contains

MEANING = (
    "A pair (g, h) is full if [h, η] + ℝη + h = g for every η outside h (6.4). Then the range condition (6.3), the "
    "same equation with the generator ψ of a vector field in place of η, holds for every ψ outside h, so isotropy can "
    "correct the steps of an integrator to any order."
)


def pair_page(pair: Pair | Verdict, path: str | os.PathLike[str] | None = None) -> str:
    """A page for the browser about a pair: its verdict, the proof step by step, pictures, isotropy and brackets.

    Parameters
    ----------
    pair : Pair or verdict
        A pair is decided first.
    path : path_like, optional
        File to write, such as "pair.html". An existing file is replaced.

    Returns
    -------
    str
        HTML that needs no network and no other file. Equal pairs have equal pages.

    Raises
    ------
    InputError
        If `pair` is neither a pair nor a verdict.
    CertificateError
        If the certificate of the verdict does not prove it.
    FormatError
        If the file cannot be written; an existing file is then unchanged.

    Notes
    -----
    Pictures need matplotlib; without it, the page has a sentence instead of each. Long
    tables are cut, and a line below says so. The files in the page, which its links save, are complete.

    Examples
    --------
    >>> import liehom as lh
    >>> page = pair_page(lh.pair("so(3)/so(2)"))
    >>> page[:15], "The pair so(3)/so(2) is full." in page
    ('<!doctype html>', True)
    """
    if not isinstance(pair, (Pair, *VERDICTS)):
        raise InputError(f"expected a pair or a verdict of decide_fullness, got {displayed(pair)}")
    if path is not None:
        check_target(path, force=True)
    page = _page(decide_fullness(pair) if isinstance(pair, Pair) else pair)
    if path is not None:
        write_file(path, page.encode())
    return page


def _page(verdict: Verdict) -> str:
    title = card_of(verdict).title
    style, script = ((FOLDER / name).read_text(encoding="utf-8") for name in ("page.css", "page.js"))
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    # nothing is loaded from anywhere, and no script runs but this one
    policy = f"default-src 'none'; style-src 'unsafe-inline'; script-src 'sha256-{digest}'; img-src data:"
    sections = [
        *(_proof(verdict), _failures(verdict)),
        *(_structure(verdict.pair), _isotropy(verdict.pair), _geometry(verdict.pair), _brackets(verdict.pair)),
        _files(verdict),
    ]
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<meta name="color-scheme" content="light dark"><meta http-equiv="Content-Security-Policy" content="{policy}">'
        f"<title>{text(title, MOST_CHARACTERS)}</title>\n<style>\n{style}</style></head>\n<body>\n"
        + "\n".join([_header(verdict), "<main>", *sections, "</main>"])
        + f"\n<script>{script}</script>\n</body></html>\n"
    )


def _header(verdict: Verdict) -> str:
    pair, card = verdict.pair, card_of(verdict)
    n, k = pair.algebra.dimension, pair.subalgebra.dimension
    kind = {True: "yes", False: "no", None: "open"}[verdict.full]
    rows = [
        ("dimensions", f"dim g = {n}, dim h = {k}, dim g/h = {n - k}, over {pair.field.name}"),
        *((name, value) for name, value in card.facts if name != "because"),
    ]
    links = "".join(f'<a href="#{name}">{text(heading)}</a> ' for name, heading in SECTIONS.items())
    return (
        f'<header><h1>{text(card.title, MOST_CHARACTERS)}</h1><p class="verdict {kind}">{text(verdict)}</p>'
        f'{facts(rows)}{paragraph(MEANING, "meaning")}<nav aria-label="Sections">{links}</nav></header>'
    )


SECTIONS = {
    "proof": "Why",
    "failures": "Where (6.3) fails",
    "structure": "g and h",
    "isotropy": "Isotropy representation",
    "geometry": "Invariant geometry of G/H",
    "brackets": "Brackets",
    "files": "Check it yourself",
}
UNFOLDED = ("proof", "failures")
"""What the page shows of itself; the rest unfolds."""


def _section(name: str, *content: str) -> str:
    return section(name, SECTIONS[name], *content, unfolded=name in UNFOLDED)


# -- verdict -------------------------------------------------------------------------------------------------
def _proof(verdict: Verdict) -> str:
    if verdict.certificate is None:
        return _section(
            "proof",
            paragraph(
                "The pair has floats, so there is no proof. Every pair with exact numbers is decided with one: "
                "liehom.rationalize looks for exact numbers near these."
            ),
            facts(
                [
                    ("least singular value", f"{verdict.smallest:.3g}"),
                    ("error of the data", f"{verdict.tolerance:.3g}"),
                    ("gap, their ratio", f"{verdict.gap:.3g}"),
                ]
            ),
        )
    verdict.verify()
    return _section(
        "proof",
        paragraph(
            f"The certificate, of kind '{verdict.certificate.kind}', was verified by exact arithmetic before this page "
            "was written. Its steps unfold:"
        ),
        '<div class="steps">' + "".join(certificate_steps(verdict.pair, verdict.certificate)) + "</div>",
    )


def _failures(verdict: Verdict) -> str:
    pair = verdict.pair
    if not pair.field.exact:
        return _section("failures", paragraph("The cone on which (6.3) fails is computed for exact pairs only."))
    if isinstance(verdict, Full):
        return _section("failures", paragraph("Nowhere: (6.3) holds for every ψ outside h, since the pair is full."))
    if pair.algebra.dimension > MAX_SEARCHED:
        words = f"Not computed here, because dim g is above {MAX_SEARCHED}; call verdict.where_it_fails() for it."
        return _section("failures", paragraph(words))
    try:
        report = failure_report(pair, verdict.certificate)
    except LiehomError as undecided:
        return _section("failures", paragraph(f"Not computed: {undecided}"))
    if report.generic.holds is False:
        return _section("failures", paragraph("Everywhere: (6.3) holds for no ψ outside h."))
    head = (
        "It is not decided whether (6.3) holds for generic ψ. It fails on a cone in g/h, which contains:"
        if report.generic.holds is None
        else "(6.3) holds for generic ψ, and fails on a cone in g/h. In the coordinates x of g/h it contains:"
    )
    return _section(
        "failures",
        paragraph(head),
        items([part.description for part in report.parts] or ["η of the certificate"]),
        cone_picture(pair, report),
        details(
            "What was searched",
            paragraph("Complete:") + items(report.searched) if report.searched else "",
            paragraph("Not searched:") + items(report.not_searched) if report.not_searched else "",
        ),
    )


# -- the pair ------------------------------------------------------------------------------------------------
def _structure(pair: Pair) -> str:
    blocks, parts = [], {}
    for name, part in (("g", pair.algebra), ("h", pair.subalgebra)):
        if part.dimension > MAX_DESCRIBED:
            words = f"{name} has dimension {part.dimension}; structure is described here up to {MAX_DESCRIBED}. "
            blocks.append(paragraph(words + "The command `liehom describe` has no such limit."))
            continue
        parts[name] = part if isinstance(part, LieAlgebra) else part.as_algebra()
        try:
            blocks.append(code_block(f"{name}: {parts[name].describe()}"))
        except LiehomError as undecided:
            blocks.append(paragraph(f"The structure of {name} is not described: {undecided}"))
    return _section("structure", *blocks, diagrams(parts))


def _isotropy(pair: Pair) -> str:
    d, k = pair.dimension, pair.subalgebra.dimension
    if d == 0 or k == 0:
        words = "h = g, so g/h = 0." if d == 0 else "h = 0, so nothing acts on g/h = g."
        return _section("isotropy", paragraph(words))
    g, data = pair.algebra, pair.subalgebra.quotient()
    names = [[f"x{i}", g.show(row)] for i, row in enumerate(data.lift.to_rows())]
    shown = zip(pair.isotropy_matrices()[:MOST_MATRICES], data.subspace, strict=False)
    blocks = [matrix_table(matrix, f"ρ({shortened(g.show(z), 40)})") for matrix, z in shown]
    if k > MOST_MATRICES:
        blocks.append(paragraph(f"The first {MOST_MATRICES} of {k} matrices.", "note"))
    return _section(
        "isotropy",
        paragraph(
            f"h acts on g/h, of dimension {d}, by ρ(z) x = [z, x] mod h. One matrix for each element of a basis of h:"
        ),
        f'<div class="matrices">{"".join(blocks)}</div>',
        details("Coordinates of g/h", table(["coordinate", "of the element of g"], names, "coordinates")),
    )


def _geometry(pair: Pair) -> str:
    if not pair.field.exact or pair.dimension > MAX_CURVED:
        words = "of exact pairs" if not pair.field.exact else f"up to dim g/h = {MAX_CURVED}"
        return _section("geometry", paragraph(f"Computed here for metrics and forms {words} only."))
    shown = [(fact.name.replace("_", " "), fact.words) for fact in geometry_facts(pair, einstein=False)]
    command = code_block("liehom geometry pair.json")
    return _section("geometry", facts(shown), paragraph("This command lists the Einstein metrics too:"), command)


def _brackets(pair: Pair) -> str:
    g = pair.algebra
    names = g.basis_names
    terms: dict[tuple[int, int], list[str]] = {}
    for i, j, k, value in g.structure_constants():
        terms.setdefault((i, j), []).extend(linear_combination(g.field, [names[k]], [value]))
    rows = [[f"[{names[i]}, {names[j]}]", " + ".join(x).replace("+ -", "- ")] for (i, j), x in terms.items()]
    basis = ", ".join(names[:MOST_BRACKETS]) + (f", ... ({len(names)} in all)" if len(names) > MOST_BRACKETS else "")
    if not rows:
        return _section("brackets", facts([("basis of g", basis or None)]), paragraph("All brackets vanish."))
    shown = table(["bracket", "value"], rows, "brackets; the file of the pair has all", MOST_BRACKETS)
    return _section(
        "brackets",
        facts([("basis of g", basis)]),
        paragraph("The brackets of basis elements that are not 0, up to antisymmetry:"),
        f'<div class="brackets"><div>{shown}</div>{bracket_picture(g)}</div>',
    )


# -- files ---------------------------------------------------------------------------------------------------
def _files(verdict: Verdict) -> str:
    objects = {"pair.json": to_json(verdict.pair)}
    words = "The pair as a file, for the command below or liehom.load:"
    command = "liehom fullness pair.json"
    if verdict.certificate is not None:
        objects["certificate.json"] = verdict.certificate.to_json()
        words = (
            "Save these files and run the command: it checks the certificate with code that shares only its exact "
            "arithmetic with the decision."
        )
        command = "liehom verify pair.json certificate.json"
    links = {file: download(data, file, MAX_FILE) for file, data in objects.items()}
    large = [file for file, link in links.items() if link is None]
    if large:
        words += f" Too large for this page: {' and '.join(large)}; liehom.dump writes such files."
    return _section(
        "files",
        paragraph(words),
        "<ul>" + "".join(f"<li>{x}</li>" for x in links.values() if x) + "</ul>",
        code_block(command),
    )
