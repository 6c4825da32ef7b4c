"""Commands `fullness` and `verify`: the decision of a pair with its certificate, and the check of a certificate."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from liehom.cli.guard import NO, NUMERICAL, YES
from liehom.cli.options import JsonOption, PairArgument, run
from liehom.cli.terminal import completion
from liehom.cli.terminal.steps import step

if TYPE_CHECKING:
    from liehom.fullness import Verdict
    from liehom.scalars import Field


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
    from liehom.cli.show import show_answer, show_json
    from liehom.errors import InputError
    from liehom.fullness.decide import decide_fullness
    from liehom.io import dump

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
        dump(verdict.certificate, out)
    if as_json:
        show_json({**verdict.to_json(), "pair": pair_facts(text, pair)})
        return code
    rows = [("pair", pair_line(text, pair)), *_evidence(verdict)]
    if out is not None:
        rows.append(("written to", out))
    show_answer(str(verdict), rows, code)
    return code


def _evidence(verdict: Verdict) -> list[tuple[str, str]]:
    """Labels and values of the evidence for a verdict."""
    from liehom.cli.show import short_vector

    data = verdict.to_json()
    rows = []
    if data.get("eta") is not None:
        rows.append(("eta", short_vector(data["eta"])))
        definition = _definition(getattr(verdict, "eta_field", None))
        if definition:
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
    from liehom.scalars import NumberField

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
            metavar="CERT",
            help="Certificate file, or - for standard input.",
            autocompletion=completion.files(".json"),
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
    from liehom.cli.show import show_answer, show_json
    from liehom.errors import CertificateError, CertificateFormatError
    from liehom.fullness.certificates.certificate import Certificate
    from liehom.fullness.checker.verify import verify_certificate
    from liehom.io import read_object

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
    if as_json:
        data = {"verified": failure is None, "full": certificate.full, "kind": certificate.kind, "failure": failure}
        show_json({**data, "pair": pair_facts(text, pair)})
    else:
        rows = [("pair", pair_line(text, pair)), ("certificate", f"{shown_name(file)}, kind {certificate.kind}")]
        show_answer(f"verified: the certificate proves that the pair is {claim}", rows)
    return YES if failure is None else NO
