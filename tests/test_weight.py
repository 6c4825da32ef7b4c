"""The weight of liehom/: lines, statements and files rise only together with a sentence that says for whom."""

import ast
from pathlib import Path

import liehom

PACKAGE = Path(liehom.__file__).resolve().parent

WEIGHTS: tuple[tuple[int, int, int, str], ...] = (
    (82473, 42777, 280, "two halves with one door, for everybody who reads the code"),
    (
        84245,
        43905,
        284,
        "the check of adaptive steps and one rule for the same psi, for those who integrate pulses or resume runs; "
        "closures of Pauli sums, for quantum control; bounds for measured data; names and matrices that people write",
    ),
    (
        89200,
        46986,
        296,
        "calls in a loop over spans, landings by invariants, Python and loops from traces, for those who integrate "
        "often or large systems; the generic range condition and the invariant geometry of G/H, for pairs",
    ),
    (
        93924,
        49628,
        309,
        "names of algebras with a radical, branching rules and Casimirs, for physicists and Lie theory; names of "
        "spaces and geodesics, for geometers; controllability, rotations and Riccati flows, for engineers",
    ),
    (
        93617,
        49634,
        308,
        "metrics by their matrix, for geometers; is_unimodular, for lecturers; loops of large steps are called again "
        "at once, for integration by tight tolerances; functions of rotations beside SO3 and SE3 left",
    ),
    (
        93731,
        49715,
        308,
        "calls of one trajectory at half the cost, for loops over spans; last points of ensembles, one start for all "
        "slices, functions that branch, names that everybody knows, for those who come from scipy or from textbooks; "
        "chains of branching rules, for physicists; Propagator.bind and the parameters of integrate_ensemble left",
    ),
    (
        91294,
        49073,
        306,
        "for everybody who reads the code: what no page shows and nobody calls left, runs, events, tables and landings "
        "stand once; quaternions for ROS and matrices of Heisenberg algebras, for roboticists and lecturers",
    ),
    (
        91373,
        49119,
        306,
        "stiff collocation steps as long as their error allows, for fields with several time scales; blocks of one "
        "pace, for ensembles; adaptive Corrected runs that keep the tolerance, for those who build correctors; the "
        "linear correction of Conserving, an inverse for a few orbits and a loop of Python left",
    ),
    (
        90872,
        48904,
        306,
        "for everybody who reads the code: one Newton step, one embedded step, one place for the options of a call and "
        "for its defaults; series by columns and constants next to the code, for ensembles on large orbits",
    ),
)
"""Lines, statements (of Python, without docstrings) and files of Python and stubs, the latest last, and for whom."""
SLACK = 0.005  # what has become lighter by more than this share is written down


def is_string(node: ast.AST) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


def statements(text: str) -> int:
    return sum(isinstance(node, ast.stmt) and not is_string(node) for node in ast.walk(ast.parse(text)))


def weight() -> tuple[int, int, int]:
    paths = [path for path in PACKAGE.rglob("*.py*") if path.suffix in (".py", ".pyi")]
    texts = [path.read_text(encoding="utf-8") for path in paths if PACKAGE / "examples" not in path.parents]
    return sum(text.count("\n") for text in texts), sum(map(statements, texts)), len(texts)


def test_weight_is_what_is_written_down() -> None:
    *allowed, reason = WEIGHTS[-1]
    assert len(reason.split()) >= 6, "say who needs what has been added"
    for now, most, what in zip(weight(), allowed, ("lines", "statements", "files"), strict=True):
        assert now <= most, f"{now} {what}, {most} written down: for whom? add a row to WEIGHTS"
        assert now >= (1 - SLACK) * most - 1, f"{now} {what}, {most} written down: lower the last row of WEIGHTS"


def test_docstrings_and_comments_are_not_counted() -> None:
    """A control."""
    assert (
        statements('"""Doc."""\n# a comment\nx = 1\n"""What x is."""\n\n\ndef f():\n    """Doc."""\n    return x\n')
        == 3
    )
