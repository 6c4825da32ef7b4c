"""Eighteen questions to eleven algebras, here and in GAP in one run.

    OMP_NUM_THREADS=1 python -m tests.benchmarks.structure_grid

Processor seconds on fresh objects. Words in the arguments select questions or algebras; `--here` leaves GAP out, and
`--e8` asks split E8. An answer that differs from GAP's ends the run. GAP is `gap` on the path. `--write FILE` puts the
table of what a run has printed to a file into docs/performance-exact.md.
"""

import random
import re
import statistics
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import liehom as lh
from liehom.exact.algebra.core.jacobi import prove_jacobi
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from tests.benchmarks.peers_gap import seconds_of
from tests.benchmarks.structure_report import PAGE, least, seconds, shown
from tests.benchmarks.structure_tasks import Task, exceptional, fresh, mixed, scrambled
from tests.oracles.gap_process import Gap

BEGIN, END = "<!-- grid: begin -->", "<!-- grid: end -->"
LIMIT = 30.0  # seconds by the clock after which GAP is stopped
QUICK = 0.02  # seconds below which a ratio of one case is not judged
SEMISIMPLE = ("so8", "sl8", "E6", "E7", "so53", "sl6")


@cache
def algebra(name: str) -> LieAlgebra:
    made: dict[str, Callable[[], LieAlgebra]] = {
        "so8": lambda: lh.so(8),
        "sl8": lambda: lh.sl(8),
        "E6": lambda: exceptional("E6"),
        "E7": lambda: exceptional("E7"),
        "E8": lambda: exceptional("E8"),
        "so53": lambda: scrambled(lh.so(5, 3), 53),
        "sl6": lambda: lh.sl(6),
        "b6": lambda: lh.algebra.upper_triangular(6),
        "b8": lambda: lh.algebra.upper_triangular(8),
        "mixed10": lambda: mixed(10),
        "mixed20": lambda: mixed(20),
        "mixed50": lambda: mixed(50),
    }
    return made[name]()


NAMES = ("so8", "sl8", "E6", "E7", "so53", "sl6", "b6", "b8", "mixed10", "mixed20", "mixed50")


@cache
def pair(name: str) -> list[list[int]]:
    """Two elements, with four non-zero coefficients and with a half of all coefficients."""
    n = algebra(name).dimension
    rng = random.Random(n)
    rows = [[0] * n for _ in range(2)]
    for row, count in zip(rows, (4, n // 2), strict=True):
        for j in rng.sample(range(n), count):
            row[j] = rng.choice((-2, -1, 1, 2))
    return rows


@dataclass(frozen=True)
class Question:
    """A question: here to an algebra and two elements, in GAP to L and the two elements P."""

    name: str
    ask: Callable[[LieAlgebra, list[list[int]]], Any]
    in_gap: str
    semisimple: bool = False


def _jacobi(g: LieAlgebra, _: list[list[int]]) -> int:
    prove_jacobi(g.table, g.basis_names)
    return g.dimension


QUESTIONS = [
    Question("Jacobi", _jacobi, "[ TestJacobi( L_T ), Dimension( L ) ][2]"),
    Question("Killing, rank", lambda g, p: g.killing_form().rank(), "RankMat( KillingMatrix( Basis( L ) ) )"),
    Question("centre", lambda g, p: g.center().dimension, "Dimension( LieCentre( L ) )"),
    Question("derived", lambda g, p: g.derived_subalgebra().dimension, "Dimension( LieDerivedSubalgebra( L ) )"),
    Question("lower series", lambda g, p: len(g.lower_central_series()), "Length( LieLowerCentralSeries( L ) )"),
    Question("upper series", lambda g, p: len(g.upper_central_series()), "Length( LieUpperCentralSeries( L ) )"),
    Question("radical", lambda g, p: g.radical().dimension, "Dimension( LieSolvableRadical( L ) )"),
    Question("nilradical", lambda g, p: g.nilradical().dimension, "Dimension( LieNilRadical( L ) )"),
    Question("Levi", lambda g, p: g.levi_decomposition().levi.dimension,
             "Dimension( LeviMalcevDecomposition( L )[1] )"),
    Question("Levi, type", lambda g, p: g.semisimple_type(), "SemiSimpleType( LeviMalcevDecomposition( L )[1] )"),
    Question("Cartan", lambda g, p: g.cartan_subalgebra().dimension, "Dimension( CartanSubalgebra( L ) )"),
    Question("centralizer", lambda g, p: g.centralizer(p[:1]).dimension,
             'Dimension( LieCentralizer( L, Subalgebra( L, P{[1]}, "basis" ) ) )'),
    Question("normalizer", lambda g, p: g.normalizer(p[:1]).dimension,
             'Dimension( LieNormalizer( L, Subalgebra( L, P{[1]}, "basis" ) ) )'),
    Question("closure", lambda g, p: g.subalgebra_generated_by(p).dimension, "Dimension( Subalgebra( L, P ) )"),
    Question("ideal", lambda g, p: g.ideal_generated_by(p[:1]).dimension, "Dimension( Ideal( L, P{[1]} ) )"),
    Question("direct sum", lambda g, p: len(g.direct_sum_decomposition()), "Length( DirectSumDecomposition( L ) )"),
    Question("derivations", lambda g, p: g.derivations().dimension, "Dimension( Derivations( Basis( L ) ) )"),
    Question("root system", lambda g, p: 2 * len(g.root_system().positive_roots),
             "Length( PositiveRoots( RootSystem( L ) ) ) * 2", semisimple=True),
]  # fmt: skip


def task(question: Question, name: str) -> Task:
    g, rows = algebra(name), pair(name)

    def prepare() -> Callable[[], Any]:
        new = fresh(g)
        return lambda: question.ask(new, rows)

    setup = f"{lh.io.to_gap(g)};; R_ := {rows};; A_ := 0;;"
    make = "LieAlgebraByStructureConstants( Rationals, L_T )"
    run = (
        "function( L ) local P; P := List( R_, r -> LinearCombination( Basis( L ), r ) ); "
        f"A_ := {question.in_gap}; return A_; end"
    )
    return Task(f"{question.name}, {name}", prepare, None, (setup, make, run), LIMIT)


def row(question: Question, name: str, gap: Gap | None) -> tuple[float, float | str]:
    """Seconds here and in GAP, of one case; the answers are compared."""
    case = task(question, name)
    here = seconds(case, 3)
    if gap is None:
        return here, "not asked"
    there = seconds_of(gap, case, 3)
    if isinstance(there, float):
        answers = str(case.prepare()()).replace(" + ", " "), gap.ask("A_", LIMIT)
        if answers[0] != answers[1] and sorted(answers[0].split()) != sorted(answers[1].split()):
            raise SystemExit(f"{case.name}: {answers[0]} here, {answers[1]} in GAP")
    return here, there


def table(printed: str) -> str:
    """One row for each question: the geometric mean of the ratios, the smallest one, and the longest time here."""
    lines = re.findall(r"^(.{14}) (\S+) +(\S+)(.*) (\d+\.\d\d)$", printed, re.MULTILINE)
    rows = ["| question | GAP / liehom, mean | smallest | longest here, s |", "|---|---|---|---|"]
    for name in dict.fromkeys(line[0] for line in lines):
        cases = [(float(ratio), algebra, float(here)) for n, algebra, here, _, ratio in lines if n == name]
        judged = [case for case in cases if case[0] > 0]
        (least_ratio, where, _), (_, slow, longest) = min(judged), max(cases, key=lambda case: case[2])
        mean = statistics.geometric_mean(case[0] for case in judged)
        ratio = f"{mean:.1f}" if mean < 10 else f"{mean:.0f}"
        rows.append(f"| {name.strip()} | {ratio} | {least_ratio:.2g} ({where}) | {shown(longest)} ({slow}) |")
    return "\n".join(rows)


def main() -> None:
    if "--write" in sys.argv:
        text, printed = PAGE.read_text(encoding="utf-8"), Path(sys.argv[-1]).read_text(encoding="utf-8")
        before, _, rest = text.partition(BEGIN)
        lines = [line for line in printed.splitlines() if line[15:20] != "mean "]
        new = f"{before}{BEGIN}\n{table(chr(10).join(lines))}\n{END}{rest.partition(END)[2]}"
        PAGE.write_text(new, encoding="utf-8")
        return
    words = [word for word in sys.argv[1:] if not word.startswith("--")]
    algebras = ("E8",) if "--e8" in sys.argv else NAMES
    missed = []
    with Gap() as gap:
        for question in QUESTIONS:
            ratios = []
            for name in algebras:
                if (question.semisimple and name not in (*SEMISIMPLE, "E8")) or (
                    words and question.name not in words and name not in words
                ):
                    continue
                here, there = row(question, name, None if "--here" in sys.argv else gap)
                ratio = least(there) / here
                gap_s = shown(there) if isinstance(there, float) else there[:20]
                print(f"{question.name:14} {name:8} {shown(here):>9} {gap_s:>9} {ratio:8.2f}", flush=True)
                if ratio:
                    ratios.append(ratio)
                    if ratio < 0.5 and here > QUICK:
                        missed.append(f"{question.name}, {name}")
            if ratios:
                print(f"{question.name:14} mean     {statistics.geometric_mean(ratios):28.2f}", flush=True)
    print("below a half above 20 ms:", "; ".join(missed) or "none")


if __name__ == "__main__":
    main()
