"""Commands of ``liehom``: each reads its input, calls one function of the library, and prints the result."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from liehom.budget import limits, parsed_limits
from liehom.cli import atlas_command, classify_commands, describe_command, numerical_commands, reproduce
from liehom.cli.guard import NO, NUMERICAL, YES, guarded
from liehom.cli.options import JsonOption, PairArgument, run

if TYPE_CHECKING:
    from liehom.fullness import Verdict
    from liehom.scalars import Field

HELP = "Lie algebras, isotropy and fullness: exact answers with proofs; integration on homogeneous spaces."


class LimitsFirst(TyperGroup):
    """The group of commands; ``--limit NAME=NUMBER`` is read before and after the name of the command."""

    def parse_args(self, ctx: object, args: list[str]) -> list[str]:
        return list(super().parse_args(ctx, limits_first(args)))  # type: ignore[arg-type]


def limits_first(args: list[str]) -> list[str]:
    """The arguments with all ``--limit`` in front.

    Examples
    --------
    >>> limits_first(["fullness", "--limit", "digits=9", "so(3)/so(2)", "--limit=seconds=1"])
    ['--limit', 'digits=9', '--limit=seconds=1', 'fullness', 'so(3)/so(2)']
    """
    first: list[str] = []
    rest: list[str] = []
    remaining = iter(args)
    for arg in remaining:
        if arg == "--":
            rest += [arg, *remaining]
        elif arg == "--limit":
            value = next(remaining, None)
            first, rest = ([*first, arg, value], rest) if value is not None else (first, [*rest, arg])
        else:
            (first if arg.startswith("--limit=") else rest).append(arg)
    return [*first, *rest]


app: typer.Typer = typer.Typer(
    name="liehom",
    cls=LimitsFirst,
    help=HELP,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def _version(wanted: bool) -> None:
    if wanted:
        package = sys.modules["liehom"]  # loaded before this module; layers do not import upward
        typer.echo(f"liehom {package.__version__}")
        raise typer.Exit


@app.callback(help=HELP)
def _options(
    context: typer.Context,
    limit: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=NUMBER", help="Raise or lower a limit, e.g. digits=100000; may be repeated."),
    ] = None,
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    def enter() -> int:
        context.with_resource(limits(**parsed_limits(",".join(limit or ()))))
        return YES

    if (code := guarded(enter)) != YES:
        raise typer.Exit(code)


@app.command()
def fullness(
    pair: PairArgument,
    certificate: Annotated[
        str | None, typer.Option(metavar="OUT", help="File for the certificate (default: none).")
    ] = None,
    json: JsonOption = False,
) -> None:
    """Decide whether a pair is full, and why.  Exit code 0: full, 1: not full, 3: numerical or undecided."""
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
    verdict = decide_fullness(pair)
    proved = verdict.certificate is not None
    if proved:
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


@app.command()
def verify(
    pair: PairArgument,
    certificate: Annotated[str, typer.Argument(metavar="CERT", help="Certificate file.")],
    json: JsonOption = False,
) -> None:
    """Check that a certificate proves its verdict for a pair.  Exit code 0: proved, 1: a check fails."""
    run(lambda: _verify(pair, certificate, json))


def _verify(text: str, file: str, as_json: bool) -> int:
    from liehom.cli.inputs import file_argument, pair_argument, pair_facts, pair_line
    from liehom.cli.show import show_answer, show_json
    from liehom.errors import CertificateError, CertificateFormatError
    from liehom.fullness.certificates.certificate import Certificate
    from liehom.fullness.checker.verify import verify_certificate
    from liehom.io import read_object

    pair = pair_argument(text)
    certificate = Certificate.from_json(read_object(file_argument(file)))
    failure = None
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
        rows = [("pair", pair_line(text, pair)), ("certificate", f"{file}, kind {certificate.kind}")]
        show_answer(f"verified: the certificate proves that the pair is {claim}", rows)
    return YES if failure is None else NO


@app.command()
def isotropy(
    file: Annotated[str, typer.Argument(metavar="FILE", help="Representation file.")],
    point: Annotated[
        str | None, typer.Option(metavar="ROW", help="Point, e.g. '1,0,-2/3' (default: the file's point).")
    ] = None,
    json: JsonOption = False,
) -> None:
    """Compute the isotropy subalgebra and the orbit dimension of a representation at a point."""
    run(lambda: _isotropy(file, point, json))


def _isotropy(file: str, point: str | None, as_json: bool) -> int:
    from liehom.cli.inputs import file_argument, point_in
    from liehom.cli.show import short_vector, show_answer, show_json
    from liehom.errors import FormatError
    from liehom.io import load_problem
    from liehom.scalars import RR

    problem = load_problem(file_argument(file))
    rho, at = problem.representation, list(problem.point or ())
    if point is not None:
        rho, at = point_in(rho, point)
    elif problem.point is None:
        if problem.start is None:
            raise FormatError("the file has no 'point': give one with --point")
        rho, at = rho.over(RR), list(problem.start)
    isotropy = rho.isotropy(at)
    dimension = rho.algebra.dimension
    write = rho.field.format
    rows = [[write(x) for x in row] for row in isotropy.rows()]
    code = YES if rho.field.exact else NUMERICAL
    if as_json:
        show_json(
            {
                "dimension": dimension,
                "isotropy_dimension": isotropy.dimension,
                "orbit_dimension": dimension - isotropy.dimension,
                "point": [write(x) for x in at],
                "isotropy": rows,
                "appended": [list(pair) for pair in rho.appended],
                "field": rho.field.name,
                "proved": rho.field.exact,
            }
        )
        return code
    facts = [
        ("representation", f"{file}: dim g = {dimension} on {rho.field.name}^{rho.size}"),
        ("point", short_vector([write(x) for x in at])),
    ]
    if rho.appended:
        facts.append(("brackets appended", ", ".join(f"[{i}, {j}]" for i, j in rho.appended[:12])))
    facts += [("isotropy" if i == 0 else "", short_vector(row)) for i, row in enumerate(rows[:12])]
    if len(rows) > 12:
        facts.append(("", f"... and {len(rows) - 12} more rows"))
    label = "" if rho.field.exact else " (numerical)"
    sentence = f"the isotropy subalgebra has dimension {isotropy.dimension}, the orbit {dimension - isotropy.dimension}"
    show_answer(sentence + label, facts, code)
    return code


@app.command(name="range")
def range_(
    pair: PairArgument,
    psi: Annotated[
        str | None, typer.Option(metavar="ROW", help="Element of g, e.g. '1,0,-2/3' (default: a generic one).")
    ] = None,
    json: JsonOption = False,
) -> None:
    """Decide whether the range condition holds, for generic eta or for a given element."""
    run(lambda: _range(pair, psi, json))


def _range(text: str, psi: str | None, as_json: bool) -> int:
    from liehom.cli.inputs import pair_argument, pair_facts, pair_line, row_in
    from liehom.cli.show import short_vector, show_answer, show_json
    from liehom.homogeneous.range.range_condition import range_condition

    pair = pair_argument(text)
    row = None if psi is None else row_in(pair.field, psi, "psi")
    found = range_condition(pair, row)
    exact = pair.field.exact
    write = pair.field.format
    missing = None if found.missing is None else [write(x) for x in found.missing]
    tested = [write(x) for x in found.psi]
    code = YES if exact else NUMERICAL
    if as_json:
        data: dict[str, Any] = {"holds": found.holds, "rank": found.rank, "missing": missing}
        data |= {"equilibrium": found.equilibrium, "psi": tested, "message": found.message}
        show_json({**data, "generic": found.generic, "proved": exact, "pair": pair_facts(text, pair)})
        return code
    sentence = str(found)
    rows = [("pair", pair_line(text, pair)), ("rank", f"{found.rank} of dim g/h = {pair.dimension}")]
    rows.append(("psi" if row is not None else "sample psi", short_vector(tested)))
    if missing is not None:
        rows.append(("missing", f"the covector {short_vector(missing)} vanishes on h, psi and [h, psi]"))
    show_answer(sentence + ("" if exact else " (numerical)"), rows, code)
    return code


app.command()(classify_commands.classify)
app.command()(classify_commands.full_pairs)
app.command()(describe_command.describe)
app.command()(numerical_commands.integrate)
app.command()(numerical_commands.order)
app.command()(reproduce.reproduce)
app.add_typer(atlas_command.atlas, name="atlas")


@app.command()
def catalog(
    name: Annotated[
        str | None, typer.Argument(metavar="[NAME]", help="Pair to print as a pair file (default: list all names).")
    ] = None,
    json: JsonOption = False,
) -> None:
    """List names that other commands accept, one of each kind (sizes are free), or print one pair as a file."""
    run(lambda: _catalog(name, json))


def _catalog(name: str | None, as_json: bool) -> int:
    from liehom.catalog import pair, pair_names
    from liehom.cli.show import show_json, show_table
    from liehom.io import to_json

    if name is not None:
        show_json(to_json(pair(name)))
        return YES
    names = list(pair_names())
    if as_json:
        show_json({"pairs": names})
        return YES
    show_table(["pairs of the catalogue"], [[name] for name in names], header=False)
    return YES


@app.command()
def demo(plot: numerical_commands.PlotOption = None, json: JsonOption = False) -> None:
    """Show a tour: fullness with verified certificates, isotropy, integration."""

    def action() -> int:
        from liehom.cli.demo import run_demo

        return run_demo(plot, json)

    run(action)
