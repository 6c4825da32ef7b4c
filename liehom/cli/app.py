"""Commands of ``liehom``: each reads its input, calls one function of the library, and prints the result."""

from __future__ import annotations

import shutil
import sys
from typing import TYPE_CHECKING, Annotated, Any

import typer

from liehom.base.budget import limits, parsed_limits
from liehom.base.errors import FormatError
from liehom.cli import (
    completion,
    integration as numerical_commands,
    objects as classify_commands,
    objects as describe_command,
    objects as fullness_commands,
    objects as page_command,
    reproduce,
)
from liehom.cli.guard import NUMERICAL, YES, guarded, short_vector, show_json, show_result, show_rows, step
from liehom.cli.help import Group, LateGroup, examples
from liehom.cli.inputs import FileArgument, JsonOption, PairArgument, command, run

if TYPE_CHECKING:
    from liehom.exact.scalars.field import Field

HELP = """Lie algebras, isotropy and fullness: exact answers with proofs; integration on homogeneous spaces.

Exit codes: 0 yes or done, 1 no, 2 malformed input, 3 numerical or undecided, 70 a bug, 74 no output, 130 interrupted.
"""
# Commands that ``liehom`` without arguments suggests
TRY_FIRST = (
    ('liehom fullness "so(4)/so(3)"', "Is this pair full, and why?"),
    ('liehom describe "so(4,1)"', "What is this Lie algebra?"),
    ("liehom integrate examples/rigid_body.json", "Integrate an orbit."),
    ("liehom plot dynkin E6 --output e6.png", "Draw a picture."),
    ("liehom demo", "Take a tour of a few seconds."),
    ("liehom --help", "List all commands."),
)


class LimitsFirst(Group):
    """The group of commands; ``--limit NAME=NUMBER`` is read before and after the name of the command."""

    def parse_args(self, ctx: typer.Context, args: list[str]) -> list[str]:  # type: ignore[override]
        return list(super().parse_args(ctx, limits_first(args)))


class Pictures(LateGroup):
    """The group `plot`."""

    def declared(self) -> typer.Typer:
        from liehom.cli.plot_command import pictures

        return pictures()


class Atlas(LateGroup):
    """The group `atlas`."""

    def declared(self) -> typer.Typer:
        from liehom.cli.atlas_command import atlas

        return atlas


def limits_first(args: list[str]) -> list[str]:
    """The arguments with all ``--limit`` in front."""
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
    epilog=examples(*(line for line, _ in TRY_FIRST[:-1])),
    invoke_without_command=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def _version(wanted: bool) -> None:
    if wanted:
        package = sys.modules["liehom"]  # loaded before this module; layers do not import upward
        typer.echo(f"liehom {package.__version__}")
        raise typer.Exit


@app.callback()
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
    if context.invoked_subcommand is None:
        run(try_first)


def try_first() -> int:
    """Print the commands to begin with; returns the exit code."""
    left = max(len(line) for line, _ in TRY_FIRST)
    wide = left + max(len(says) for _, says in TRY_FIRST) + 4 <= shutil.get_terminal_size().columns
    print("Lie algebras, homogeneous spaces and isotropy, with proofs. Try first:\n")
    for line, says in TRY_FIRST:
        print(f"  {line:<{left}}  {says}" if wide else f"  {line}\n      {says}")
    print("\nliehom COMMAND --help explains a command, with examples.")
    return YES


command(
    app,
    'liehom fullness "so(4)/so(3)"',
    'liehom fullness "so(3,1)/so(2,1)" --certificate certificate.json',
    "liehom fullness examples/g2_su3.json --json",
    'liehom catalog "sl(3)/P1" | liehom fullness -',
)(fullness_commands.fullness)
command(app, 'liehom verify "so(3,1)/so(2,1)" certificate.json')(fullness_commands.verify)


@command(app, "liehom isotropy examples/sym3.json", "liehom isotropy examples/sym3.json --point '-1,0,0,-1,0,sqrt(2)'")
def isotropy(
    file: FileArgument,
    point: Annotated[
        str | None, typer.Option(metavar="ROW", help="Point, e.g. '1,0,-2/3' (default: the file's point).")
    ] = None,
    json: JsonOption = False,
) -> None:
    """Compute the isotropy subalgebra and the orbit dimension of a representation at a point."""
    run(lambda: _isotropy(file, point, json))


def _isotropy(file: str, point: str | None, as_json: bool) -> int:
    from liehom.cli.inputs import point_in, problem_argument, shown_name
    from liehom.exact.scalars.floating import RR

    problem = problem_argument(file)
    rho, at = problem.representation, list(problem.point or ())
    if point is not None:
        rho, at = point_in(rho, point)
    elif problem.point is None:
        if problem.start is None:
            raise FormatError("the file has no 'point': give one with --point")
        rho, at = rho.over(RR), list(problem.start)
    step("isotropy at the point")
    isotropy = rho.isotropy(at)
    dimension = rho.algebra.dimension
    write = rho.field.format
    rows = [[write(x) for x in row] for row in isotropy.rows()]
    data = {
        "dimension": dimension,
        "isotropy_dimension": isotropy.dimension,
        "orbit_dimension": dimension - isotropy.dimension,
        "point": [write(x) for x in at],
        "isotropy": rows,
        "appended": [list(pair) for pair in rho.appended],
        "field": rho.field.name,
        "proved": rho.field.exact,
    }
    facts = [
        ("representation", f"{shown_name(file)}: dim g = {dimension} on {rho.field.name}^{rho.size}"),
        ("point", short_vector([write(x) for x in at])),
    ]
    if rho.appended:
        facts.append(("brackets appended", ", ".join(f"[{i}, {j}]" for i, j in rho.appended[:12])))
    facts += [("isotropy" if i == 0 else "", short_vector(row)) for i, row in enumerate(rows[:12])]
    if len(rows) > 12:
        facts.append(("", f"... and {len(rows) - 12} more rows"))
    sentence = f"the isotropy subalgebra has dimension {isotropy.dimension}, the orbit {dimension - isotropy.dimension}"
    return _shown(as_json, data, sentence, facts, rho.field)


def _shown(as_json: bool, data: dict[str, Any], sentence: str, facts: list[tuple[str, str]], field: Field) -> int:
    """Print an answer, which is numerical over floats; returns the exit code."""
    return show_result(
        as_json, data, *((sentence, facts, YES) if field.exact else (f"{sentence} (numerical)", facts, NUMERICAL))
    )


@command(app, 'liehom range "so(3,1)/so(2,1)"', 'liehom range "so(4)/so(3)" --psi 0,1,0,0,0,1', name="range")
def range_(
    pair: PairArgument,
    psi: Annotated[
        str | None, typer.Option(metavar="ROW", help="Element of g, e.g. '1,0,-2/3' (default: a generic one).")
    ] = None,
    json: JsonOption = False,
) -> None:
    """Decide whether the range condition holds, for generic eta, with the reason, or for a given element."""
    run(lambda: _range(pair, psi, json))


def _range(text: str, psi: str | None, as_json: bool) -> int:
    from liehom.cli.inputs import pair_argument, pair_facts, pair_line, row_in
    from liehom.exact.fullness.range_classification import classify_range
    from liehom.exact.orbits.range import range_condition

    pair = pair_argument(text)
    row = None if psi is None else row_in(pair.field, psi, "psi")
    step("range condition")
    condition = range_condition(pair, row)
    write = pair.field.format
    missing = None if condition.missing is None else [write(x) for x in condition.missing]
    tested = [write(x) for x in condition.psi]
    data: dict[str, Any] = {"holds": condition.holds, "rank": condition.rank, "missing": missing}
    data |= {"equilibrium": condition.equilibrium, "psi": tested, "message": condition.message}
    data |= {"generic": condition.generic, "proved": pair.field.exact, "pair": pair_facts(text, pair)}
    rows = [("pair", pair_line(text, pair)), ("rank", f"{condition.rank} of dim g/h = {pair.dimension}")]
    rows.append(("psi" if row is not None else "sample psi", short_vector(tested)))
    if missing is not None:
        rows.append(("missing", f"the covector {short_vector(missing)} vanishes on h, psi and [h, psi]"))
    if row is None and pair.field.exact:
        result = classify_range(pair)
        data["classification"] = result.to_json()
        count = "not known" if result.open_orbits is None else str(result.open_orbits)
        rows += [("reason", result.reason), ("fails on", result.fails_on)]
        rows.append(("open orbits", f"{count}: {result.open_orbits_reason}"))
        if result.certificate is not None:
            rows.append(("certificate", f"of kind {result.certificate.kind!r}, verified: {result.verify()}"))
    return _shown(as_json, data, str(condition), rows, pair.field)


@command(app, 'liehom geometry "SU(3)/T^2"', 'liehom geometry "CP^3" --json')
def geometry(pair: PairArgument, json: JsonOption = False) -> None:
    """Describe the invariant geometry of G/H: metrics, Einstein metrics, cohomology, symplectic forms."""
    run(lambda: _geometry(pair, json))


def _geometry(text: str, as_json: bool) -> int:
    from liehom.cli.inputs import pair_argument, pair_facts, pair_line
    from liehom.exact.geometry.summary import geometry_facts

    pair = pair_argument(text)
    rows, data = [("pair", pair_line(text, pair))], {}
    for fact in geometry_facts(pair):
        data[fact.name] = fact.value
        step(fact.name.replace("_", " "))
        rows.append((fact.name.replace("_", " "), fact.words))
    reductive, count = data["reductive"], data.get("metrics")
    many = "1 parameter" if count == 1 else f"{count} parameters"
    sentence = f"G/H has invariant metrics with {many}" if count else "G/H has no invariant metric"
    if not reductive or count is None:
        sentence = "G/H is a point" if reductive else "the pair is not reductive"
    return show_result(as_json, {**data, "pair": pair_facts(text, pair)}, sentence, rows)


command(app, 'liehom classify "so(6)/u(3)"')(classify_commands.classify)
command(app, "liehom full-pairs 3")(classify_commands.full_pairs)
command(app, 'liehom describe "so(4,1)"', 'liehom describe "e(3)/so(3)"', "liehom describe examples/sym3.json")(
    describe_command.describe
)
command(
    app, 'liehom show "so(3,1)/so(2,1)" -o cone.html', 'liehom catalog "sl(2)/so(1,1)" | liehom show - -o lines.html'
)(page_command.show)
command(
    app,
    "liehom integrate examples/rigid_body.json",
    "liehom integrate examples/rigid_body.json --base euler --order 4 --dt 0.05 --out body.npz",
    "liehom integrate examples/rigid_body.json --rtol 1e-8 --plot orbit.png",
)(numerical_commands.integrate)
command(app, "liehom order examples/rigid_body.json --base euler --order 3 --t-span 0 1")(numerical_commands.order)
command(app, "liehom reproduce fig1 --quick --out figures", "liehom reproduce all --out figures")(reproduce.reproduce)
app.add_typer(
    typer.Typer(cls=Pictures, no_args_is_help=True, rich_markup_mode=None),
    name="plot",
    help="Draw a picture into a file: a trajectory, a diagram, roots, weights or a cone.",
)
app.add_typer(
    typer.Typer(cls=Atlas, no_args_is_help=True, rich_markup_mode=None),
    name="atlas",
    help="List, build and search the atlas: families of pairs, each pair decided with a certificate.",
)


@command(app, "liehom catalog", 'liehom catalog "so(4)/so(3)" > pair.json')
def catalog(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="[NAME]",
            help="Pair to print as a pair file (default: list all names).",
            autocompletion=completion.pair,
        ),
    ] = None,
    json: JsonOption = False,
) -> None:
    """List names of pairs that other commands accept, or print one pair as a file.

    The list has one or more names of each kind; sizes are free.
    """
    run(lambda: _catalog(name, json))


def _catalog(name: str | None, as_json: bool) -> int:
    from liehom.exact.catalog.pairs import pair, pair_names
    from liehom.io.files import to_json

    if name is not None:
        show_json(to_json(pair(name)))
        return YES
    names = list(pair_names())
    return show_rows(as_json, {"pairs": names}, ["pairs of the catalogue"], [[name] for name in names], header=False)


@command(app, "liehom demo", "liehom demo --plot errors.png")
def demo(plot: numerical_commands.PlotOption = None, json: JsonOption = False) -> None:
    """Show a tour: fullness with verified certificates, isotropy and integration."""

    def action() -> int:
        from liehom.cli.reproduce import run_demo

        return run_demo(plot, json)

    run(action)
