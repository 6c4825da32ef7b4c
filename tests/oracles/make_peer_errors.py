"""Write peer_errors.json: wrong or refused answers of other tools, with their inputs.

    python -m tests.oracles.make_peer_errors [PYTHON]            from the root of a checkout, with gap installed

What GAP and sympy say is asked anew, and what SageMath and dgcv say where an interpreter is named that has them.  Of
tools that are not installed the recorded answer is kept, with "reproduced": false.
tests/exact/algebra/structure/test_peer_errors.py asks liehom the same.
"""

import datetime
import json
import random
import subprocess
import sys
from pathlib import Path
from typing import Any

import liehom as lh
from tests.oracles.gap_process import Gap, Refused, Timeout
from tests.oracles.random_algebras import scrambled

HERE = Path(__file__).resolve().parent
LIMIT = 60.0
SCRAMBLED = {  # name: (seed, operations)
    "so(7)": (3, 1.0),
    "so(9)": (4, 1.0),
    "sp(8,R)": (2, 1.0),
    "su(3,1)": (0, 1.0),
    "so(7,2)": (3, 1.0),
}
TYPES = {"so(7)": "B3", "so(9)": "B4", "sp(8,R)": "C4", "su(3,1)": "A3", "so(7,2)": "B4", "so(4,1)": "B2"}
NO_REPRESENTATION = [[[0, -1], [1, 0]], [[0, 1], [1, 0]], [[1, 0], [0, 1]]]
NO_JACOBI = [[0, 1, 2, "3"], [1, 2, 2, "1"], [0, 2, 1, "-1"]]


def in_another_basis(name: str) -> Any:
    """The algebra of a catalogue name in the basis in which the tool fails."""
    seed, operations = SCRAMBLED[name]
    return scrambled(lh.catalog.algebra(name), random.Random(f"{name} {seed}"), operations)


def asked(gap: Gap, question: str) -> str:
    try:
        return gap.ask(question, LIMIT)
    except Refused as error:
        return str(error)
    except Timeout:
        return f"no answer in {LIMIT:.0f} s"


def gap_errors(gap: Gap) -> list[dict[str, Any]]:
    found = []
    for name in SCRAMBLED:
        algebra = in_another_basis(name)
        gap.begin(lh.io.to_gap(algebra))
        entry = {"id": f"GAP type of {name}", "call": "SemiSimpleType( L )", "said": asked(gap, "SemiSimpleType( L )")}
        found.append({**entry, "truth": {"type": TYPES[name], "real_form": name}, "algebra": lh.to_json(algebra)})
    gap.begin(lh.io.to_gap(lh.so(3)))
    said = asked(gap, "RootSystem( L )")
    entry = {"id": "GAP roots of so(3)", "call": "RootSystem( L )", "said": said, "truth": {"type": "A1", "roots": 2}}
    found.append({**entry, "algebra": lh.to_json(lh.so(3))})
    entries = " ".join(f"SetEntrySCTable( T, {i + 1}, {j + 1}, [ {v}, {k + 1} ] );;" for i, j, k, v in NO_JACOBI)
    gap.begin(
        f'T := EmptySCTable( 3, 0, "antisymmetric" );; {entries} L := LieAlgebraByStructureConstants( Rationals, T );;'
    )
    entry = {"id": "GAP Jacobi", "call": "IsLieAlgebra( L )", "said": asked(gap, "IsLieAlgebra( L )")}
    found.append({**entry, "truth": {"jacobi_fails_for": [0, 1, 2]}, "structure_constants": NO_JACOBI})
    gap.begin(
        'x := Indeterminate( Rationals, "x" );; F := AlgebraicExtension( Rationals, x^2 - 2 );; '
        'T := EmptySCTable( 3, Zero( F ), "antisymmetric" );; SetEntrySCTable( T, 1, 2, [ One( F ), 3 ] );; '
        "SetEntrySCTable( T, 2, 3, [ One( F ), 1 ] );; SetEntrySCTable( T, 1, 3, [ -One( F ), 2 ] );; "
        "L := LieAlgebraByStructureConstants( F, T );;"
    )
    entry = {"id": "GAP extension field", "call": "SemiSimpleType( L )", "said": asked(gap, "SemiSimpleType( L )")}
    algebra = lh.so(3).over(lh.number_field("sqrt(2)"))
    found.append({**entry, "truth": {"type": "A1"}, "algebra": lh.to_json(algebra)})
    version = gap.ask("GAPInfo.Version", 30)
    return [{"tool": "GAP", "version": version, "reproduced": True, **entry} for entry in found]


def sympy_errors() -> list[dict[str, Any]]:
    import sympy
    from sympy.liealgebras.root_system import RootSystem
    from sympy.liealgebras.weyl_group import WeylGroup

    roots = {str(k): [int(x) for x in v] for k, v in RootSystem("G2").all_roots().items()}
    matrix = WeylGroup("E8").matrix_form("r1")
    base = {"tool": "sympy", "version": sympy.__version__, "reproduced": True}
    return [
        {
            **base,
            "id": "sympy roots of G2",
            "call": 'RootSystem("G2").all_roots()',
            "said": roots,
            "note": "sympy#30164: root 4 is not in the plane x + y + z = 0 of the others",
            "truth": {"roots": 12, "sums": 0},
        },
        {
            **base,
            "id": "sympy Weyl group of E8",
            "call": 'WeylGroup("E8").matrix_form("r1")',
            "said": [[str(x) for x in row] for row in matrix.tolist()],
            "note": "sympy#24092: the square of this reflection is not the identity",
            "truth": {"square_is_identity": True, "order": 696729600},
        },
    ]


def recorded() -> list[dict[str, Any]]:
    """Answers of tools that are not installed where this script runs, as they were seen."""
    four_one = scrambled(lh.so(4, 1), random.Random("so(4,1) 0"), 2.0)
    so4, mixed = lh.to_json(lh.so(4)), lh.to_json(lh.direct_sum(lh.so(3), lh.so(5)))
    sage = {"tool": "SageMath", "version": "10.8", "reproduced": False}
    dgcv = {"tool": "dgcv", "version": "0.6.0", "reproduced": False}
    ideals = {"simple": False, "ideals": [3, 3]}
    return [
        {**sage, "id": "Sage centralizer in so(3)", "call": "L.centralizer([x])", "said": 3, "truth": {"dimension": 1}},
        {**sage, "id": "Sage centralizer in E6", "call": "L.centralizer([x])", "said": 78, "truth": {"dimension": 56}},
        {
            **sage,
            "id": "Sage Jacobi",
            "call": "LieAlgebra(QQ, ...)",
            "said": "accepted",
            "truth": {"jacobi_fails_for": [0, 1, 2]},
            "structure_constants": NO_JACOBI,
        },
        {
            **sage,
            "id": "Sage no representation",
            "call": "L.representation(...)",
            "said": "accepted",
            "truth": {"refused": True},
            "matrices": NO_REPRESENTATION,
        },
        {
            "tool": "corelg",
            "version": "with GAP 4.16",
            "reproduced": False,
            "id": "corelg real form of so(4,1)",
            "call": "NameRealForm( L )",
            "said": "refused over all of its fields",
            "truth": {"type": "B2", "real_form": "so(4,1)"},
            "algebra": lh.to_json(four_one),
        },
        {**dgcv, "id": "dgcv so(4)", "call": "is_simple", "said": True, "truth": ideals, "algebra": so4},
        {
            **dgcv,
            "id": "dgcv so(3)+so(5)",
            "call": "is_simple",
            "said": True,
            "truth": {"simple": False, "ideals": [3, 10]},
            "algebra": mixed,
        },
    ]


def asked_elsewhere(python: str, tool: str, data: Any) -> dict[str, Any]:
    """What a tool says in another interpreter."""
    command = [python, str(HERE / "ask_sage_dgcv.py"), tool, json.dumps(data)]
    run = subprocess.run(command, capture_output=True, text=True, check=True, timeout=600)
    found = json.loads(run.stdout.rpartition("\n@")[2])
    assert isinstance(found, dict)
    return found


def reproduced(entries: list[dict[str, Any]], python: str) -> list[dict[str, Any]]:
    algebras = {e["id"]: e["algebra"] for e in entries if e["tool"] == "dgcv"}
    said = {
        "SageMath": asked_elsewhere(python, "sage", NO_REPRESENTATION),
        "dgcv": asked_elsewhere(python, "dgcv", algebras),
    }
    return [
        {**e, "said": said[e["tool"]][e["id"]], "version": said[e["tool"]]["version"], "reproduced": True}
        if e["tool"] in said
        else e
        for e in entries
    ]


def main(python: str | None = None) -> None:
    others = recorded() if python is None else reproduced(recorded(), python)
    with Gap() as gap:
        errors = [*gap_errors(gap), *sympy_errors(), *others]
    head = {
        "tool": "GAP, sympy; recorded answers of SageMath, corelg, dgcv",
        "tool_version": "with each entry",
        "script": "tests/oracles/make_peer_errors.py",
        "date": datetime.datetime.now(tz=datetime.UTC).date().isoformat(),
        "licence": "answers of other tools are quoted as facts; the algebras are made by liehom",
        "limit_seconds": LIMIT,
    }
    body = ",\n".join("  " + json.dumps(entry, separators=(",", ":")) for entry in errors)
    text = f'{{\n "provenance": {json.dumps(head)},\n "errors": [\n{body}\n ]\n}}\n'
    (HERE / "peer_errors.json").write_text(text, encoding="utf-8")
    for entry in errors:
        print(entry["id"], "|", str(entry["said"])[:70])


if __name__ == "__main__":
    main(*sys.argv[1:2])
