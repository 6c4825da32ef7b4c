"""The page of a pair: verdict, certificate, failure cone, structure, isotropy and brackets."""

from __future__ import annotations

import base64
import hashlib
import os
from pathlib import Path

from liehom.algebra import LieAlgebra
from liehom.algebra.core.names import linear_combination
from liehom.disk import check_target, write_file
from liehom.errors import InputError, LiehomError, displayed
from liehom.fullness import (
    Full,
    NotFull,
    NumericallyFull,
    NumericallyNotFull,
    NumericallyUndecided,
    decide_fullness,
    failure_report,
)
from liehom.fullness.verdict import Verdict
from liehom.io import to_json
from liehom.io.html_format import card_of
from liehom.pages.certificate_steps import certificate_steps
from liehom.pages.elements import (
    MOST_CHARACTERS,
    code_block,
    details,
    download,
    facts,
    items,
    matrix_table,
    paragraph,
    section,
    table,
    text,
)
from liehom.pages.pictures import bracket_picture, cone_picture, diagrams
from liehom.representations import Pair

FOLDER = Path(__file__).resolve().parent
VERDICTS = (Full, NotFull, NumericallyFull, NumericallyNotFull, NumericallyUndecided)

MOST_BRACKETS = 60
MOST_MATRICES = 12
MAX_DESCRIBED = 60
"""Largest dimension of an algebra whose structure a page describes: larger ones can take minutes."""
MAX_FILE = 1_000_000
"""Bytes of a file that a page contains."""

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
    Pictures need matplotlib (the extra `liehom[plot]`); without it, the page has a sentence instead of each. Long
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
    verdict = decide_fullness(pair) if isinstance(pair, Pair) else pair
    page = _page(verdict)
    if path is not None:
        write_file(path, page.encode())
    return page


def _page(verdict: Verdict) -> str:
    title = card_of(verdict).title
    style, script = ((FOLDER / name).read_text(encoding="utf-8") for name in ("page.css", "page.js"))
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    # nothing is loaded from anywhere, and no script runs but this one
    policy = f"default-src 'none'; style-src 'unsafe-inline'; script-src 'sha256-{digest}'; img-src data:"
    pair = verdict.pair
    sections = [
        _proof(verdict),
        _failures(verdict),
        _structure(pair),
        _isotropy(pair),
        _brackets(pair),
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
    return (
        f'<header><h1>{text(card.title, MOST_CHARACTERS)}</h1><p class="verdict {kind}">{text(verdict)}</p>'
        f"{facts(rows)}{paragraph(MEANING, 'meaning')}{_contents()}</header>"
    )


SECTIONS = {
    "proof": "Why",
    "failures": "Where (6.3) fails",
    "structure": "g and h",
    "isotropy": "Isotropy representation",
    "brackets": "Brackets",
    "files": "Check it yourself",
}


def _contents() -> str:
    links = "".join(f'<a href="#{name}">{text(heading)}</a> ' for name, heading in SECTIONS.items())
    return f'<nav aria-label="Sections">{links}</nav>'


def _section(name: str, *content: str) -> str:
    return section(name, SECTIONS[name], *content)


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
    if pair.algebra.dimension > MAX_DESCRIBED:
        words = f"Not computed here, because dim g is above {MAX_DESCRIBED}; call verdict.where_it_fails() for it."
        return _section("failures", paragraph(words))
    try:
        report = failure_report(pair, verdict.certificate)
    except LiehomError as undecided:
        return _section("failures", paragraph(f"Not computed: {undecided}"))
    if report.generic.holds is False:
        return _section("failures", paragraph("Everywhere: (6.3) holds for no ψ outside h."))
    head = "(6.3) holds for generic ψ, and fails on a cone in g/h. In the coordinates x of g/h it contains:"
    if report.generic.holds is None:
        head = "It is not decided whether (6.3) holds for generic ψ. It fails on a cone in g/h, which contains:"
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
    blocks = [matrix_table(matrix, f"ρ({_short(g.show(z))})") for matrix, z in shown]
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


def _short(words: str) -> str:
    return words if len(words) <= 40 else f"{words[:40]} ..."


def _brackets(pair: Pair) -> str:
    g = pair.algebra
    names = g.basis_names
    found: dict[tuple[int, int], list[str]] = {}
    for i, j, k, value in g.structure_constants():
        found.setdefault((i, j), []).extend(linear_combination(g.field, [names[k]], [value]))
    rows = [[f"[{names[i]}, {names[j]}]", " + ".join(x).replace("+ -", "- ")] for (i, j), x in found.items()]
    basis = ", ".join(names[:MOST_BRACKETS]) + (f", ... ({len(names)} in all)" if len(names) > MOST_BRACKETS else "")
    if not rows:
        return _section("brackets", facts([("basis of g", basis or None)]), paragraph("All brackets vanish."))
    shown = table(["bracket", "value"], rows, "brackets; the file of the pair has all", MOST_BRACKETS)
    return _section(
        "brackets",
        facts([("basis of g", basis)]),
        paragraph("All brackets of basis elements that are not 0, up to antisymmetry:"),
        f'<div class="brackets"><div>{shown}</div>{bracket_picture(g)}</div>',
    )


def _term(value: str, name: str) -> str:
    return (
        name
        if value == "1"
        else f"-{name}"
        if value == "-1"
        else f"({value})*{name}"
        if " " in value
        else f"{value}*{name}"
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
