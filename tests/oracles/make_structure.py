"""Write structure_*.json: what GAP says about 200 random Lie algebras.

    python -m tests.oracles.make_structure [FAMILY ...]          from the root of a checkout, with gap installed

GAP reads the structure constants as `liehom.io.to_gap` writes them; before anything else a test of conventions is
made ([e_1, e_2] of the first algebra, by hand).  GAP computes everything except signatures, which it does not have:
they come from GAP's Killing matrix, by Lagrange's diagonalisation over Python's fractions, in this file.
"""

import datetime
import json
import subprocess
import sys
import time
from fractions import Fraction
from pathlib import Path
from typing import Any

import liehom as lh
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from tests.oracles.gap_process import Gap, Refused, Timeout
from tests.oracles.random_algebras import FAMILIES, SEED, random_algebras

HERE = Path(__file__).resolve().parent
LIMIT = 60.0
QUESTIONS = {
    "dimension": "Dimension( L )",
    "center": "Dimension( LieCentre( L ) )",
    "derived_series": "List( LieDerivedSeries( L ), Dimension )",
    "lower_central_series": "List( LieLowerCentralSeries( L ), Dimension )",
    "radical": "Dimension( LieSolvableRadical( L ) )",
    "nilradical": "Dimension( LieNilRadical( L ) )",
    "killing_rank": "RankMat( KillingMatrix( Basis( L ) ) )",
    "cartan_subalgebra": "Dimension( CartanSubalgebra( L ) )",
    "levi": "Dimension( LeviMalcevDecomposition( L )[1] )",
    "type": "SemiSimpleType( LeviMalcevDecomposition( L )[1] )",
    "simple_ideals_over_QQ": (
        "SortedList( List( DirectSumDecomposition( LeviMalcevDecomposition( L )[1] ), Dimension ) )"
    ),
}


def signature(matrix: list[list[Fraction]]) -> tuple[int, int, int]:
    """Numbers of (positive, negative, zero) squares of a symmetric matrix, by Lagrange's method.

    >>> signature([[Fraction(0), Fraction(1)], [Fraction(1), Fraction(0)]])
    (1, 1, 0)
    """
    a = [row[:] for row in matrix]
    signs: list[int] = []
    while a:
        n = len(a)
        pivot = next((i for i in range(n) if a[i][i]), None)
        if pivot is None:
            pair = next(((i, j) for i in range(n) for j in range(i) if a[i][j]), None)
            if pair is None:
                break
            i, j = pair  # the square of x_i + x_j: replace e_i by e_i + e_j
            a[i] = [x + y for x, y in zip(a[i], a[j], strict=True)]
            for row in a:
                row[i] += row[j]
            pivot = i
        p, top = a[pivot][pivot], a[pivot]
        signs.append(1 if p > 0 else -1)
        rest = [i for i in range(n) if i != pivot]
        a = [[a[i][j] - a[i][pivot] * top[j] / p for j in rest] for i in rest]
    return signs.count(1), signs.count(-1), len(matrix) - len(signs)


def answers(gap: Gap, algebra: LieAlgebra) -> tuple[dict[str, Any], dict[str, str]]:
    gap.begin(lh.io.to_gap(algebra))
    found: dict[str, Any] = {}
    refused: dict[str, str] = {}
    for key, question in QUESTIONS.items():
        if key in ("type", "simple_ideals_over_QQ") and not found.get("levi"):
            continue
        try:
            said = gap.ask(question, LIMIT)
            found[key] = said if key == "type" else json.loads(said)
        except Timeout:
            refused[key] = f"no answer in {LIMIT:.0f} s"
        except Refused as error:
            refused[key] = str(error)
    rows = json.loads(gap.ask("List( KillingMatrix( Basis( L ) ), r -> List( r, String ) )", LIMIT).replace("'", '"'))
    found["killing_signature"] = list(signature([[Fraction(x) for x in row] for row in rows]))
    return found, refused


def check_conventions(gap: Gap) -> None:
    """That GAP's e_1, e_2, ... and its bracket are ours: [h, e] = 2 e, [h, f] = -2 f, [e, f] = h."""
    gap.begin(lh.io.to_gap(LieAlgebra({(0, 1): {1: 2}, (0, 2): {2: -2}, (1, 2): {0: 1}}, basis=["h", "e", "f"])))
    products = gap.ask('Concatenation( String( L.1 * L.2 ), ",", String( L.1 * L.3 ), ",", String( L.2 * L.3 ) )', 30)
    if products.replace("(", "").replace(")", "") != "2*e,-2*f,h":
        raise RuntimeError(f"GAP's conventions differ: [h, e], [h, f], [e, f] = {products}")


def provenance(family: str, gap: Gap) -> dict[str, Any]:
    package = subprocess.run(
        ["dpkg-query", "-W", "-f", "${Version}", "gap-core"], capture_output=True, text=True, check=False
    )
    return {
        "tool": "GAP",
        "tool_version": gap.ask("GAPInfo.Version", 30),
        "tool_package": f"gap-core {package.stdout or 'unknown'} of Debian, started with -A: no packages loaded",
        "script": "tests/oracles/make_structure.py",
        "date": datetime.datetime.now(tz=datetime.UTC).date().isoformat(),
        "licence": (
            "GAP is under GPL-2.0-or-later; the numbers are facts that it computed, the algebras are made by liehom"
        ),
        "seed": SEED,
        "family": family,
        "limit_seconds": LIMIT,
        "note": "killing_signature: from GAP's Killing matrix, diagonalised over the fractions by the script",
    }


def write(family: str) -> None:
    lines = []
    with Gap() as gap:
        check_conventions(gap)
        head = provenance(family, gap)
        for index, (label, algebra) in enumerate(random_algebras(family)):
            start = time.monotonic()
            found, refused = answers(gap, algebra)
            entry = {"label": label, "gap": found, **({"refused": refused} if refused else {})}
            entry["algebra"] = lh.to_json(algebra)
            lines.append("  " + json.dumps(entry, separators=(",", ":")))
            print(family, index, label, algebra.dimension, f"{time.monotonic() - start:.1f} s", refused, flush=True)
    body = ",\n".join(lines)
    header = json.dumps(head, indent=1).replace("\n", "\n ")
    (HERE / f"structure_{family}.json").write_text(
        f'{{\n "provenance": {header},\n "algebras": [\n{body}\n ]\n}}\n', encoding="utf-8"
    )


if __name__ == "__main__":
    for name in sys.argv[1:] or FAMILIES:
        write(name)
