"""The steps of a proof in words, each with its numbers, for each kind of certificate.

The steps are those of the independent checker, in its order; docs/theory/fullness.md proves that they suffice. V = g/h
has the coordinates x of ``pair.coordinates``, and rho is the action of h on V. The caller has verified the certificate:
that a number shown here is 0, or a matrix commutes, is not computed a second time.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from liehom.algebra.core.names import linear_combination
from liehom.errors import LiehomError
from liehom.fullness import Certificate
from liehom.fullness.checker.verify_roots import characteristic_polynomial, count_right_of, trimmed
from liehom.pages.elements import MOST_CHARACTERS, MOST_ROWS, details, matrix_table, number, paragraph, table
from liehom.representations import Pair
from liehom.scalars import ExactField, ExactMatrix, Scalar, as_exact

MAX_CHARACTERISTIC = 60
"""Largest matrix whose eigenvalues are counted once more for the page."""
MOST_EIGENVALUES = 30


def certificate_steps(pair: Pair, certificate: Certificate) -> list[str]:
    """Steps of the proof as elements of HTML that unfold.

    Parameters
    ----------
    pair : Pair
        Over an exact field.
    certificate : Certificate
        Verified for this pair.

    Examples
    --------
    >>> import liehom as lh
    >>> verdict = lh.decide_fullness(lh.pair("aff(1)/R"))
    >>> certificate_steps(verdict.pair, verdict.certificate)[0].partition("</summary>")[0]
    '<details><summary>g/h has dimension 1'
    """
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
            paragraph(f"η = {_cut(pair.algebra.show(eta))}. The vectors below, in the coordinates x, have rank {d}."),
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
                f"θ is a real number between {_cut(low, 40)} and {_cut(high, 40)}",
                paragraph(f"θ is a root of {_cut(equation)}, which changes its sign between these numbers."),
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
        details(
            "η is outside h",
            paragraph(f"η = {_vector_in_theta(certificate.field, columns, g.basis_names)}"),
        ),
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
        details(
            "So the pair is not full",
            paragraph("[h, η] + ℝη + h is in the kernel of φ, which is not g."),
        ),
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
        details(
            "T commutes with h",
            paragraph("T ρ(z) = ρ(z) T for the matrix ρ(z) on g/h of every z in h."),
        ),
        details(
            f"Some eigenvalues of T, but not all, have a real part above {_cut(pair.field.show(cut), 40)}",
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
            paragraph(f"X = {_cut(pair.algebra.show(row.row(0)))}"),
            paragraph("A is the matrix of X on g/h, made traceless by a multiple of the identity."),
            matrix_table(matrix, "A"),
        ),
        details(
            "Its top eigenspace W is not 0",
            paragraph(
                f"W is the sum of the generalized eigenspaces of A with real part above {_cut(show(cut), 40)}. No real "
                f"part is between {_cut(show(cut - eps), 40)} and this number."
            ),
            paragraph(f"Rounded eigenvalues of A: {_eigenvalues(matrix)}."),
        ),
        details(
            "Few elements of h can leave W",
            paragraph(
                f"m is the number of eigenvalues of ad ρ(X) on ρ(h) with real part at most −{_cut(show(eps), 40)}. The "
                "elements of the other eigenspaces map W to W."
            ),
            paragraph(f"Rounded eigenvalues of ad ρ(X): {_eigenvalues(adjoint)}."),
        ),
        details(
            "dim W + m is less than dim g/h",
            counts or paragraph("The checker has counted both exactly."),
        ),
        details(
            "So the pair is not full",
            paragraph("For η in W, [h, η] + ℝη is in W plus a space of dimension m, so it is not g/h."),
        ),
    ]


KINDS = {
    "trivial": _trivial,
    "full": _full,
    "witness": _witness,
    "commutant": _commutant,
    "dominance": _dominance,
}


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
    return _cut(" + ".join(terms).replace("+ -", "- ") or "0")


def _row(row: ExactMatrix) -> str:
    return f"({', '.join(number(row, x) for x in row.row(0))})"


def _cut(words: str, most: int = MOST_CHARACTERS) -> str:
    return words if len(words) <= most else f"{words[:most]} ..."
