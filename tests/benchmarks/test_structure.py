"""What the structure theory costs: every row of the table beside GAP, Sage and dgcv, and its demands.

In the ordinary run each row is done once, as a test of its answer.  For figures, and for the ratios to GAP:

    python -m pytest tests/benchmarks/test_structure.py -n 0 --benchmark-enable
    python -m tests.benchmarks.structure_report
"""

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.benchmarks.peers_gap import committed
from tests.benchmarks.structure_report import BEGIN, END, PAGE, SUMMARY, compared, summary
from tests.benchmarks.structure_tasks import Task, tasks

ROWS = tasks()
ROOT = Path(__file__).resolve().parents[2]
MEMORY = """
import liehom as lh
from liehom.exact.algebra.core.jacobi import prove_jacobi
g = lh.chevalley("E8")
prove_jacobi(g.table, g.basis_names)
x = [7 * i % 19 - 9 for i in range(248)]
assert (g.killing_form().rank(), g.centralizer([x]).dimension, g.center().dimension) == (248, 8, 0)
assert (g.semisimple_type(), g.real_form()) == ("E8", "e8(8)")
assert [h.dimension for h in g.derived_series()] == [248] and g.radical().dimension == 0
assert lh.adjoint(g).isotropy(x).dimension == 8
# not ru_maxrss, which begins with the size of the process that started this one
print(next(line.split()[1] for line in open("/proc/self/status") if line.startswith("VmHWM")))
"""


@pytest.mark.parametrize("task", ROWS, ids=lambda task: task.name)
def test_task(benchmark: Any, task: Task) -> None:
    benchmark.group = re.sub(r", dim \d+", "", task.name)
    found = benchmark.pedantic(lambda action: action(), setup=lambda: ((task.prepare(),), {}), rounds=3)
    assert found == task.expected


def test_every_row_has_a_committed_figure_of_gap() -> None:
    table = committed()
    assert set(table["seconds"]) == {task.name for task in ROWS}
    assert table["program"].startswith("GAP 4.") and re.fullmatch(r"20\d\d-\d\d-\d\d", table["date"])


def test_report_shows_every_row() -> None:
    shown = PAGE.read_text(encoding="utf-8").partition(BEGIN)[2].partition(END)[0]
    assert [line.split("|")[1].strip() for line in shown.splitlines() if line.startswith("| ")][2:] == [
        task.name for task in ROWS
    ]


def test_the_first_page_repeats_the_measurements_of_the_other() -> None:
    """The summary of the comparison with GAP, rows of the table of decisions, and the ratios to PennyLane."""
    first, exact = (page.read_text(encoding="utf-8") for page in (SUMMARY, PAGE))
    between = [text.partition(BEGIN)[2].partition(END)[0].strip() for text in (first, exact)]
    assert between[0] == summary(between[1])
    rows = [line for line in first.splitlines() if line.startswith("| `")]
    assert len(rows) >= 3 and all(row in exact.splitlines() for row in rows)
    closures = exact.partition("| model |")[2].partition("\n\n")[0].splitlines()[2:]
    ratios = [int(line.split("|")[-2]) for line in closures]
    assert f"{min(ratios)} to {max(ratios)} times as long" in first


def test_a_summary_names_the_tasks_that_take_longer_here() -> None:
    head = [
        "GAP 4.9 of 2026-01-01 on a machine.",
        "",
        "| task | liehom, s | GAP, s | GAP / liehom |",
        "| - | - | - | - |",
    ]
    rows = ["| a | 1 | 2 | 2 |", "| b | 1 | 0.5 | 0.5 |", "| c | 1 | > 9 | > 9 |", "| d | 1 | failed |  |"]
    text = summary("\n".join([*head, *rows]))
    assert text.startswith("GAP 4.9 takes 2 times as long") and "3 tasks" in text and "at most 9 times" in text
    assert text.endswith("for 1 of the tasks:\n\n* b, 2.0 times")


@pytest.mark.parametrize(
    ("here", "gap", "factor", "kept"), [(1.0, 0.5, 3.0, True), (1.0, 0.3, 3.0, False), (1.0, "> 60", 1 / 5, True)]
)
def test_a_demand_is_a_ratio(here: float, gap: float | str, factor: float, kept: bool) -> None:
    assert compared(Task("row", lambda: lambda: None, None, ("", "", ""), factor=factor), here, gap).kept is kept


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="no file with the memory of a process")
def test_e8_stays_below_one_gigabyte() -> None:
    made = subprocess.run([sys.executable, "-c", MEMORY], cwd=ROOT, capture_output=True, text=True, check=True)
    assert int(made.stdout) / 1e6 < 1  # kilobytes
