"""Commands about pairs and algebras: `fullness`, `verify`, `classify`, `full-pairs`, `show`, `describe`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer

from liehom.base.errors import (
    CertificateError,
    CertificateFormatError,
    FormatError,
    InputError,
    NotCompletelyReducibleError,
    UndecidedError,
)
from liehom.cli import completion
from liehom.cli.guard import NO, NUMERICAL, YES, short_vector, show_json, show_lines, show_result, show_rows, step
from liehom.cli.inputs import JsonOption, PairArgument, run

if TYPE_CHECKING:
    from liehom.exact.algebra.core.lie_algebra import LieAlgebra
    from liehom.exact.fullness.classification import Classification
    from liehom.exact.fullness.classification_rows import Row
    from liehom.exact.fullness.verdict import Verdict
    from liehom.exact.representations.core.pair import Pair
    from liehom.exact.representations.core.representation import Representation
    from liehom.exact.scalars.field import Field

# Commands `fullness` and `verify`: the decision of a pair with its certificate, and the check of a certificate.


def fullness(
    pair: PairArgument,
    certificate: Annotated[
        str | None, typer.Option(metavar="OUT", help="File for the certificate (default: none).")
    ] = None,
    json: JsonOption = False,
) -> None:
    """Decide whether a pair is full, and say why.

    The exit code is 0 if the pair is full, 1 if it is not, and 3 if the answer is numerical or undecided.
    """
    run(lambda: _fullness(pair, certificate, json))


def _fullness(text: str, out: str | None, as_json: bool) -> int:
    from liehom.cli.inputs import check_output, pair_argument, pair_facts, pair_line
    from liehom.exact.fullness.decide import decide_fullness

    pair = pair_argument(text)
    if out is not None and not pair.field.exact:
        raise InputError("a numerical answer has no certificate; give exact numbers, or leave --certificate out")
    if out is not None:
        check_output(out, text)
    step("isotropy representation")
    verdict = decide_fullness(pair, progress=step)
    proved = verdict.certificate is not None
    if proved:
        step("check of the certificate")
        verdict.verify()
    code = NUMERICAL if not proved else YES if verdict.full else NO
    if out is not None:
        from liehom.io.files import dump

        dump(verdict.certificate, out)
    rows = [("pair", pair_line(text, pair)), *_evidence(verdict), *([] if out is None else [("written to", out)])]
    return show_result(as_json, {**verdict.to_json(), "pair": pair_facts(text, pair)}, str(verdict), rows, code)


def _evidence(verdict: Verdict) -> list[tuple[str, str]]:
    """Labels and values of the evidence for a verdict."""
    data = verdict.to_json()
    rows = []
    if data.get("eta") is not None:
        rows.append(("eta", short_vector(data["eta"])))
        if definition := _definition(getattr(verdict, "eta_field", None)):
            rows.append(("where", definition))
        rows.append(("rank at eta", f"{data['rank']}, short of dim g/h by {data['rank_defect']}"))
    elif data.get("eta_numerical"):
        rows.append(("eta, numerically", short_vector([f"{x:.6g}" for x in data["eta_numerical"]])))
    if verdict.certificate is None:
        rows.append(
            ("least singular value", f"{data['smallest_singular_value']:.3g}, tolerance {data['tolerance']:.3g}")
        )
        rows.append(("gap", f"{data['gap']:.3g}"))
    else:
        rows.append(("certificate", f"{verdict.certificate.kind}, verified by the independent checker"))
    return rows


def _definition(field: Field | None) -> str:
    """Definition of the generator of a number field, in words; an empty string for other fields."""
    from liehom.exact.scalars.number_fields import NumberField

    if not isinstance(field, NumberField):
        return ""
    terms = [f"{c} {field.symbol}^{i}" if i else str(c) for i, c in enumerate(field.minpoly) if c]
    low, high = field.interval
    equation = " + ".join(reversed(terms)).replace("+ -", "- ")
    return f"{field.symbol} = {field.to_float(field.generator):.6g}... is the root of {equation} in [{low}, {high}]"


def verify(
    pair: PairArgument,
    certificate: Annotated[
        str,
        typer.Argument(
            metavar="CERT", help="Certificate file, or - for standard input.", autocompletion=completion.files(".json")
        ),
    ],
    json: JsonOption = False,
) -> None:
    """Check that a certificate proves its verdict for a pair.

    `liehom fullness PAIR --certificate CERT` writes a certificate. The exit code is 0 if the certificate proves the
    verdict, and 1 if a check fails.
    """
    run(lambda: _verify(pair, certificate, json))


def _verify(text: str, file: str, as_json: bool) -> int:
    from liehom.cli.inputs import (
        check_one_standard_input,
        file_argument,
        pair_argument,
        pair_facts,
        pair_line,
        pointing_to,
        shown_name,
    )
    from liehom.exact.fullness.certificate import Certificate
    from liehom.exact.fullness.checker.verify import verify_certificate
    from liehom.io.json_reader import read_object

    check_one_standard_input(text, file)
    pair = pair_argument(text)
    with pointing_to("`liehom fullness PAIR --certificate CERT` writes a certificate file"):
        certificate = Certificate.from_json(read_object(file_argument(file)))
    failure = None
    step("check of the certificate")
    try:
        verify_certificate(pair, certificate)
    except CertificateFormatError:
        raise
    except CertificateError as error:
        if not as_json:
            raise
        failure = {"check": error.check, "message": str(error)}
    claim = "full" if certificate.full else "not full"
    data = {"verified": failure is None, "full": certificate.full, "kind": certificate.kind, "failure": failure}
    rows = [("pair", pair_line(text, pair)), ("certificate", f"{shown_name(file)}, kind {certificate.kind}")]
    sentence = f"verified: the certificate proves that the pair is {claim}"
    code = YES if failure is None else NO
    return show_result(as_json, {**data, "pair": pair_facts(text, pair)}, sentence, rows, code)


# Commands `classify` and `full-pairs`: the row of a full pair in the classification, and all rows of a dimension.


def classify(pair: PairArgument, json: JsonOption = False) -> None:
    """Find the row of a full pair in the classification.

    The exit code is 1 if the pair is not full, and 3 if the answer is numerical or undecided.
    """
    run(lambda: _classify(pair, json))


def _classify(text: str, as_json: bool) -> int:
    from liehom.cli.inputs import pair_argument, pair_facts, pair_line
    from liehom.exact.fullness.decide import classify as classification_of, decide_fullness

    pair = pair_argument(text)
    step("isotropy representation")
    verdict = decide_fullness(pair, progress=step)
    data, rows = {**verdict.to_json(), "pair": pair_facts(text, pair)}, [("pair", pair_line(text, pair))]
    if verdict.certificate is None or not verdict.full:
        code = NUMERICAL if verdict.certificate is None else NO
        rows.append(("row", "none: only full pairs have one"))
        return show_result(as_json, {**data, "classification": None}, str(verdict), rows, code)
    step("row of the classification")
    row = classification_of(pair, verdict)
    step("check of the certificate and of the row")
    verdict.verify()
    row.verify(pair)
    return show_result(as_json, {**data, "classification": row.to_json()}, str(row), [*rows, *_row_evidence(row, pair)])


def _row_evidence(classification: Classification, pair: Pair) -> list[tuple[str, str]]:
    """Labels and values below the name of the row."""
    key, write = classification.key, pair.field.format
    row = f"{key.letter}, d = {key.d}, s = {key.s}, e = {key.e}, centre {key.centre or '0'}"
    if key.centre == "J+c":
        row += f", c^2 = {key.parameter}"
    elif key.parameter is not None:
        row += ", compact" if key.parameter == 1 else ", non-compact"
    rows = [("key", row), ("isotropy", classification.row.isotropy)]
    ideal = [[write(x) for x in vector] for vector in classification.ideal.rows()]
    rows += [("ideal inside h" if i == 0 else "", short_vector(vector)) for i, vector in enumerate(ideal[:6])]
    if len(ideal) > 6:
        rows.append(("", f"... and {len(ideal) - 6} more rows"))
    return [*rows, ("checked", "certificate of fullness and key, each by independent code")]


def full_pairs(
    d: Annotated[int, typer.Argument(metavar="D", min=0, help="Dimension of g/h.")], json: JsonOption = False
) -> None:
    """List all full pairs of a dimension, one for each row of the classification.

    In the name of a family of spirals, c stands for a positive number.
    """

    def action() -> int:
        from liehom.exact.fullness.classification_rows import rows

        pairs = rows(d)
        data = {"dimension": d, "count": len(pairs), "pairs": [_row_json(row) for row in pairs]}
        return show_rows(json, data, ["name", "space"], [[row.name, row.space] for row in pairs])

    run(action)


def _row_json(row: Row) -> dict[str, Any]:
    data = {"name": row.name, "space": row.space, "isotropy": row.isotropy, "family": row.is_family}
    return {**data, "key": row.key._asdict()}


# Command `show`: a page for the browser about a pair.


def show(
    pair: PairArgument,
    output: Annotated[
        str | None,
        typer.Option("--output", "-o", metavar="OUT.html", help="File (default: in a new temporary folder)."),
    ] = None,
    certificate: Annotated[
        str | None,
        typer.Option(
            metavar="CERT",
            help="Certificate to verify and show, or - for standard input (default: decide the pair).",
            autocompletion=completion.files(".json"),
        ),
    ] = None,
    open_: Annotated[bool, typer.Option("--open", help="Open the page in the browser.")] = False,
    json: JsonOption = False,
) -> None:
    """Write a page for the browser about a pair: verdict, proof, failure cone, diagrams, isotropy, brackets.

    The page is one file that needs no network. PAIR may also be a file with a verdict, which `liehom fullness --json`
    prints. The exit code is 0 if the page is written, whatever the verdict.
    """
    run(lambda: _show(pair, output, certificate, open_, json))


def _show(text: str, output: str | None, certificate: str | None, opened: bool, as_json: bool) -> int:
    import tempfile
    import webbrowser
    from pathlib import Path

    from liehom.cli.inputs import check_one_standard_input, check_output, pair_line, shown_name
    from liehom.exact.fullness.decide import decide_fullness
    from liehom.io.page import pair_page

    check_one_standard_input(text, certificate)
    if output is not None:
        check_output(output, text, *([certificate] if certificate else []))
    stated = _verdict(text, certificate)
    verdict = decide_fullness(_pair(text), progress=step) if stated is None else stated
    step("page")
    file = Path(tempfile.mkdtemp(prefix="liehom-")) / "pair.html" if output is None else Path(output)
    size = len(pair_page(verdict, file).encode())
    if opened and not webbrowser.open(file.resolve().as_uri()):
        raise InputError(f"no browser was found; the page is in {str(file)!r}")
    pair = verdict.pair
    data = {"page": str(file), "bytes": size, "full": verdict.full, "proved": verdict.certificate is not None}
    rows = [("pair", pair_line(pair.name or shown_name(text), pair)), ("verdict", str(verdict))]
    return show_result(as_json, data, f"page written to {file}", rows)


def _pair(text: str) -> Pair:
    """The pair that an argument denotes; one without a name has the argument as its name."""
    from liehom.cli.inputs import STANDARD_INPUT, pair_argument
    from liehom.exact.representations.core.pair import Pair

    pair = pair_argument(text)
    return pair if pair.name or text == STANDARD_INPUT else Pair(pair.algebra, pair.subalgebra, name=text)


def _verdict(text: str, file: str | None) -> Verdict | None:
    """The verdict of a given certificate, or of a file that `liehom fullness --json` wrote; None if there is none."""
    from liehom.cli.inputs import STANDARD_INPUT, file_argument, is_file, shown_name
    from liehom.exact.fullness.certificate import Certificate
    from liehom.exact.fullness.verdict import Full, NotFull
    from liehom.io.json_reader import read_object

    if file is None and (text == STANDARD_INPUT or not is_file(text)):
        return None
    data = read_object(file_argument(text if file is None else file))
    name: object = text
    if file is None:
        if not {"full", "proved"} <= data.keys():
            return None
        file, named = text, data.get("pair")
        name = named.get("name") if isinstance(named, dict) else None
    if not isinstance(name, str):
        raise FormatError(f"{file!r} is a verdict that names no pair: give the pair, and this file with --certificate")
    if data.get("proved") is False:
        raise FormatError(f"{file!r} is a numerical verdict, which has no certificate: give the pair instead")
    proof = Certificate.from_json(data["certificate"] if isinstance(data.get("certificate"), dict) else data)
    if proof.full:
        return Full(_pair(name), proof)
    return NotFull(_pair(name), proof, f"proved by the certificate in {shown_name(file)}")


# Command `describe`: the structure of the object that a file or a name denotes, as a summary or as JSON.

ObjectArgument: TypeAlias = Annotated[
    str,
    typer.Argument(
        metavar="FILE|NAME",
        help="Name such as 'so(4,1)', 'e(3)/so(3)' or E8, file of an algebra, a pair or a representation (.json, GAP's "
        ".g, Sage's .sage), or - for a JSON file on standard input.",
        autocompletion=completion.anything,
    ),
]


def describe(name: ObjectArgument, json: JsonOption = False) -> None:
    """Describe the structure of a Lie algebra, a pair or a representation.

    The exit code is 3 if the input has floats, so that the answer is only numerical.
    """
    run(lambda: run_describe(name, json))


def run_describe(text: str, as_json: bool) -> int:
    """Print the summary or the JSON object; returns the exit code."""
    from liehom.cli.inputs import object_argument, shown_name
    from liehom.exact.algebra.core.lie_algebra import LieAlgebra
    from liehom.exact.representations.core.pair import Pair

    described = object_argument(text)
    step("structure of the object")
    if isinstance(described, LieAlgebra):
        data, lines = (algebra_facts(described), []) if as_json else ({}, described.describe().splitlines())
    elif isinstance(described, Pair):
        data, lines = (pair_facts(described), []) if as_json else ({}, pair_summary(described))
    else:
        data, lines = (representation_facts(described), []) if as_json else ({}, representation_summary(described))
    if as_json:
        show_json({"input": shown_name(text), **data})
    else:
        show_lines(lines)
    return YES if described.field.exact else NUMERICAL


# -- summaries -------------------------------------------------------------------------------------------------
def pair_summary(pair: Pair) -> list[str]:
    """Lines about a pair: both algebras and the isotropy representation."""
    g, h = pair.algebra, pair.subalgebra
    name = f"pair {pair.name}" if pair.name else "pair"
    lines = [f"{name}: dim g = {g.dimension}, dim h = {h.dimension}, dim g/h = {pair.dimension}, over {g.field.name}"]
    lines += _part("g", g) + _part("h", h.as_algebra())
    if pair.dimension and g.field.exact:
        lines.append(f"  isotropy representation on g/h: {_decomposed(pair.isotropy_representation())}")
    return lines


def representation_summary(rho: Representation) -> list[str]:
    """Lines about a representation: its algebra and the decomposition of its space."""
    title = f"representation {rho.name}" if rho.name else "representation"
    head = f"{title} on {rho.field.name}^{rho.size}"
    summary = f": {_decomposed(rho)}" if rho.field.exact and rho.size else ""
    return [head + summary, *_part("g", rho.algebra)]


def _part(label: str, algebra: LieAlgebra) -> list[str]:
    first, *rest = algebra.describe().splitlines()
    return [f"  {label}: {first}", *(f"  {line}" for line in rest)]


def _decomposed(rho: Representation) -> str:
    """Decomposition in words: irreducible, a sum, or not completely reducible."""
    facts = _decomposition(rho)
    if facts is None:
        return f"not completely reducible, with socle of dimension {rho.socle().dimension}"
    if len(facts) == 1 and facts[0]["multiplicity"] == 1:
        return f"irreducible, of type {facts[0]['type']}"
    terms = [
        (f"{x['multiplicity']} x " if x["multiplicity"] > 1 else "") + f"{x['dimension']} (type {x['type']})"
        for x in facts
    ]
    return "a sum of irreducible ones of dimensions " + " + ".join(terms)


# -- facts -------------------------------------------------------------------------------------------------
def algebra_facts(g: LieAlgebra) -> dict[str, Any]:
    """JSON object of an algebra; entries about its structure only if the algebra is exact."""
    facts: dict[str, Any] = {
        "kind": "algebra",
        "name": g.name,
        "dimension": g.dimension,
        "field": g.field.name,
        "proved": g.field.exact,
        "killing_signature": list(g.killing_signature()),
        "center": g.center().dimension,
        "derived_series": [h.dimension for h in g.derived_series()],
        "lower_central_series": [h.dimension for h in g.lower_central_series()],
    }
    return {**facts, **_structure(g)} if g.field.exact else facts


def _structure(g: LieAlgebra) -> dict[str, Any]:
    from liehom.exact.algebra.roots.real_form import join_real_forms

    decomposition = g.levi_decomposition()
    levi = decomposition.levi.as_algebra()
    facts: dict[str, Any] = {
        "radical": decomposition.radical.dimension,
        "nilradical": g.nilradical().dimension,
        "levi": levi.dimension,
        "semisimple_type": levi.semisimple_type(),
        "cartan_subalgebra": g.cartan_subalgebra().dimension,
        "abelian": g.is_abelian(),
        "nilpotent": g.is_nilpotent(),
        "solvable": levi.dimension == 0,
        "semisimple": levi.dimension == g.dimension,
    }
    try:
        forms = levi.real_forms()
    except UndecidedError as undecided:
        return {**facts, "real_form": None, "undecided": str(undecided)}
    return {
        **facts,
        "simple": facts["semisimple"] and len(forms) == 1,
        "real_form": join_real_forms(form.name for form in forms),
        "rank": sum(form.rank for form in forms),
        "real_rank": sum(form.real_rank for form in forms),
        "maximal_compact": [form.maximal_compact for form in forms],
    }


def pair_facts(pair: Pair) -> dict[str, Any]:
    """JSON object of a pair."""
    facts: dict[str, Any] = {"kind": "pair", "name": pair.name, "dimension": pair.dimension, "proved": pair.field.exact}
    facts |= {"algebra": algebra_facts(pair.algebra), "subalgebra": algebra_facts(pair.subalgebra.as_algebra())}
    if pair.dimension and pair.field.exact:
        facts["isotropy_representation"] = _decomposition(pair.isotropy_representation())
    return facts


def representation_facts(rho: Representation) -> dict[str, Any]:
    """JSON object of a representation."""
    facts: dict[str, Any] = {"kind": "representation", "name": rho.name, "size": rho.size, "proved": rho.field.exact}
    facts["algebra"] = algebra_facts(rho.algebra)
    if rho.field.exact and rho.size:
        facts["decomposition"] = _decomposition(rho)
    return facts


def _decomposition(rho: Representation) -> list[dict[str, Any]] | None:
    """Dimension, multiplicity and type of each isotypic component; None if rho is not completely reducible."""
    try:
        parts = rho.decomposition().isotypic
    except NotCompletelyReducibleError:
        return None
    return [{"dimension": x.irreducible_dimension, "multiplicity": x.multiplicity, "type": x.type} for x in parts]
