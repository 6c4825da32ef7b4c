"""Command `demo`: a tour through the example files."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

import liehom.io
from liehom.cli.guard import YES
from liehom.cli.inputs import examples_folder
from liehom.cli.integration.run_order import measured, table_json
from liehom.cli.problem_options import check_plot_file
from liehom.cli.show import show_json, show_table
from liehom.fullness.decide import decide_fullness
from liehom.fullness.verdict import NotFull
from liehom.homogeneous.range.range_condition import range_condition
from liehom.representations import Pair

if TYPE_CHECKING:
    from liehom.fullness import Verdict
    from liehom.integrators import ConvergenceTable

PAIRS: tuple[tuple[str, str], ...] = (
    ("so4_so3", "the sphere S^3"),
    ("so5_so4_scrambled", "the sphere S^4 in a random basis"),
    ("g2_su3", "the sphere S^6 under G2"),
    ("sl3_P1", "the projective plane"),
    ("so31_so21", "de Sitter space: the null cone is in the way"),
    ("anisotropic", "so(x^2 + y^2 - 3 z^2) and translations: null vectors only over QQ(sqrt(3))"),
    ("ellipsoid_sqrt2", "the ellipsoid x^2 + y^2 + sqrt(2) z^2 = 1"),
    ("so4_so3_float", "the sphere S^3 in floating point"),
)

RUNS: tuple[tuple[str, int, str], ...] = (
    ("rigid_body", 1, "Euler, rigid body"),
    ("rigid_body", 4, "Euler corrected to order 4, rigid body"),
    ("sym3_generic", 4, "the same, eigenvalues 1, 2, 3"),
)
SPAN, SIZES = (0.0, 2.0), (0.1, 0.05, 0.025, 0.0125)


def run_demo(plot: str | None, as_json: bool) -> int:
    """Decide, verify and integrate the example files, print the results, draw the errors; returns the exit code."""
    check_plot_file(plot)
    folder = examples_folder()
    start = time.perf_counter()
    if as_json:
        verdicts = [{"file": f"{name}.json", **_decided(folder, name)[1].to_json()} for name, _ in PAIRS]
        tables = _convergence(folder)
        integration = [{"file": f"{name}.json", **table_json(table)} for name, table in tables]
        found = {"examples": str(folder), "verdicts": verdicts, "integration": integration}
        _plot([table for _, table in tables], plot)
        show_json({**found, "picture": plot})
        return YES
    print(f"Files from {folder}\n")
    _tour_of_verdicts(folder)
    _tour_of_a_certificate(folder)
    _tour_of_isotropy(folder)
    _tour_of_the_range_condition(folder)
    _tour_of_integration(folder, plot)
    print(f"\nDone in {time.perf_counter() - start:.1f} s. Next: liehom fullness FILE, liehom catalog, liehom --help")
    return YES


def _pair(folder: Path, name: str) -> Pair:
    return liehom.io.load_pair(folder / f"{name}.json")


def _decided(folder: Path, name: str) -> tuple[Pair, Verdict]:
    pair = _pair(folder, name)
    verdict = decide_fullness(pair)
    if verdict.certificate is not None:
        verdict.verify()
    return pair, verdict


def _tour_of_verdicts(folder: Path) -> None:
    print("1. Is h full in g, that is: [h, eta] + R eta + h = g for every eta outside h?\n")
    rows = []
    for name, meaning in PAIRS:
        pair, verdict = _decided(folder, name)
        answer = "full" if verdict.full else "not full"
        kind = f"{verdict.certificate.kind}, verified" if verdict.certificate is not None else "none: numerical"
        dimensions = f"{pair.algebra.dimension}/{pair.subalgebra.dimension}"
        rows.append((f"{name}.json", dimensions, pair.field.name, answer, kind, meaning))
    show_table(("file", "dim g/dim h", "over", "verdict", "certificate", "what it is"), rows)


def _tour_of_a_certificate(folder: Path) -> None:
    print("\n2. Why, in one sentence each\n")
    for name in ("g2_su3", "so31_so21"):
        pair, verdict = _decided(folder, name)
        print(f"  {name}: {verdict}")
        if isinstance(verdict, NotFull) and verdict.eta is not None:
            eta = ", ".join(pair.field.format(x) for x in verdict.eta)
            print(f"    eta = ({eta}): the rank is {verdict.rank} of {pair.dimension} there")


def _tour_of_isotropy(folder: Path) -> None:
    print("\n3. Isotropy at a point: SO(3) conjugates symmetric 3 x 3 matrices (a b c; b d e; c e f)\n")
    rho = liehom.io.load_problem(folder / "sym3.json").representation
    rows = []
    for text, point in (
        ("diag(1, 1, 2)", [1, 0, 0, 1, 0, 2]),
        ("diag(1, 2, 3)", [1, 0, 0, 2, 0, 3]),
        ("the identity", [1, 0, 0, 1, 0, 1]),
    ):
        pair = rho.pair(point)
        answer = "full" if decide_fullness(pair).full else "not full"
        rows.append((text, str(pair.subalgebra.dimension), str(rho.orbit_dimension(point)), answer))
    show_table(("point", "dim isotropy", "dim orbit", "full"), rows)


def _tour_of_the_range_condition(folder: Path) -> None:
    print("\n4. The range condition in de Sitter space: at a generic psi, on the null cone, inside h\n")
    pair, verdict = _decided(folder, "so31_so21")
    for text, psi in (
        ("generic", None),
        ("null", verdict.eta if isinstance(verdict, NotFull) else None),
        ("in h", pair.subalgebra.rows()[0]),
    ):
        found = range_condition(pair, psi)
        state = {True: "holds", False: "fails", None: "not decided"}[found.holds]
        print(f"  {text:<8} {state}: rank {found.rank} of {found.dimension}; {found.message}")


def _convergence(folder: Path) -> list[tuple[str, ConvergenceTable]]:
    """Pairs (name of the file, table of orders) of all runs."""
    tables = []
    for name, order, _ in RUNS:
        problem = liehom.io.load_problem(folder / f"{name}.json")
        options = MappingProxyType({**problem.options, "base": "euler", "order": order, "t_span": SPAN})
        tables.append((name, measured(replace(problem, options=options), SIZES)))
    return tables


def _tour_of_integration(folder: Path, plot: str | None) -> None:
    from liehom.integrators.propagator import without_order_warning

    print(
        "\n5. Integration: a rigid body on the sphere by Euler's step, and by the same step corrected to order 4 along"
    )
    print("   the isotropy of each point, which is full in so(3); the errors are measured\n")
    tables = _convergence(folder)
    for _, table in tables[:-1]:
        _print_indented(str(table))
    print("   Symmetric matrices with eigenvalues 1, 2, 3 have no isotropy and nothing is gained, as the report says\n")
    _print_indented(str(tables[-1][1]))
    problem = liehom.io.load_problem(folder / "sym3_generic.json")
    with without_order_warning():
        report = problem.integrate(t_span=SPAN).report
    _print_indented("\n".join(str(report).splitlines()[1:3]))
    _plot([table for _, table in tables], plot)
    print(f"Plot of these errors: {plot}" if plot else "liehom demo --plot errors.png  draws these errors")


def _print_indented(text: str) -> None:
    print("".join(f"  {line}\n" for line in text.splitlines()))


def _plot(tables: list[ConvergenceTable], path: str | None) -> None:
    """Draw the errors, if there is a path."""
    if path is not None:
        from liehom.plotting import plot_convergence

        plot_convergence(tables, path, labels=[label for _, _, label in RUNS])
