"""The table of the structure theory beside GAP, Sage and dgcv: `python -m tests.benchmarks.structure_report [--write]`.

Processor seconds, medians of some rounds, on fresh objects.  GAP runs on the same algebras in the same run if it is
installed and `--gap` is given, else its committed figures are shown.  `--write` puts the table into
docs/performance-exact.md, and a summary of it into docs/performance.md.
"""

import gc
import re
import statistics
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.benchmarks.peers_gap import committed, installed, machine, measured
from tests.benchmarks.structure_tasks import Task, tasks

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE, SUMMARY = DOCS / "performance-exact.md", DOCS / "performance.md"
BEGIN, END = "<!-- structure: begin -->", "<!-- structure: end -->"
ROUNDS = 5
TIMES_FASTER = 10.0  # than Sage and dgcv
LONGER = 1 / 1.1
"""The ratio of GAP's time to that of liehom below which a summary names a task."""


@dataclass(frozen=True)
class Row:
    """One line: seconds here, those of GAP, how often the others took longer, and whether the demands are kept."""

    name: str
    here: float
    gap: float | str
    others: dict[str, float]
    kept: bool | None

    def cells(self) -> list[str]:
        gap = shown(self.gap) if isinstance(self.gap, float) else self.gap.split(":")[0]
        ratio = least(self.gap) / self.here
        sign = "> " if isinstance(self.gap, str) and self.gap.startswith(">") else ""
        faster = f"{sign}{ratio:.2g}" if ratio < 10 else f"{sign}{ratio:.0f}"
        rest = [f"{self.others[p]:.0f}" if p in self.others else "" for p in ("Sage", "dgcv")]
        verdict = "" if self.kept is None else "yes" if self.kept else "no"
        return [self.name, shown(self.here), gap, faster if ratio else "", *rest, verdict]


def shown(seconds: float) -> str:
    return f"{seconds:.2g}" if seconds < 10 else f"{seconds:.0f}"


def least(gap: float | str) -> float:
    if isinstance(gap, str):
        return float(gap[1:]) if gap.startswith(">") else 0.0
    return gap


def compared(task: Task, here: float, gap: float | str) -> Row:
    """The row of a task; Sage and dgcv by the ratio to GAP that they had on another machine."""
    others = {}
    if isinstance(gap, float):
        others = {program: seconds * gap / beside / here for program, (seconds, beside) in task.others.items()}
    demands = [] if task.factor is None else [here <= task.factor * least(gap)]
    if task.large:
        demands += [ratio >= TIMES_FASTER for ratio in others.values()]
    return Row(task.name, here, gap, others, all(demands) if demands else None)


def seconds(task: Task, rounds: int = ROUNDS) -> float:
    """The median processor seconds of a task, of several calls each where one is short."""
    found: list[float] = []
    while len(found) < rounds and sum(found) < 20:
        actions = [task.prepare()]
        gc.collect()
        found.append(_timed(actions))
        if found[-1] < 0.02:
            actions = [task.prepare() for _ in range(10)]
            found[-1] = _timed(actions) / 10
    return statistics.median(found)


def _timed(actions: Sequence[Callable[[], Any]]) -> float:
    start = time.process_time()
    for action in actions:
        action()
    return time.process_time() - start


def table(rows: list[Row], peer: str) -> str:
    head = ["task", "liehom, s", "GAP, s", "GAP / liehom", "Sage / liehom", "dgcv / liehom", "target met"]
    lines = [head, ["---"] * len(head), *(row.cells() for row in rows)]
    return "\n".join([peer, "", *("| " + " | ".join(line) + " |" for line in lines)])


def summary(text: str) -> str:
    """The paragraph of docs/performance.md on a table, which is all that is kept of liehom's times."""
    lines = [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines() if line.startswith("| ")]
    rows = [line for line in lines if re.match(r"[>\d]", line[3])]
    known = {line[0]: float(line[3].removeprefix("> ")) for line in rows}
    slower = [f"* {name}, {1 / ratio:.1f} times" for name, ratio in known.items() if ratio < LONGER]
    gap, most = text.split(" of ")[0], max(known.values())
    return "\n".join([
        f"{gap} takes {statistics.median(known.values()):.2g} times as long as liehom in the median of {len(known)} "
        f"tasks on E8, on direct sums of dimension 10 to 50 and on modules, and at most {most:.0f} times. liehom takes "
        f"at least a tenth longer than GAP for {len(slower)} of the tasks:",
        "",
        *slower,
    ])  # fmt: skip


def put(page: Path, text: str) -> None:
    old = page.read_text(encoding="utf-8")
    before, after = old.partition(BEGIN)[0], old.partition(END)[2]
    page.write_text(f"{before}{BEGIN}\n{text}\n{END}{after}", encoding="utf-8")


def main() -> None:
    chosen = tasks()
    if "--gap" in sys.argv and installed():
        figures, peer = measured(chosen), f"GAP in the same run, on {machine()}."
    else:
        content = committed()
        figures = content["seconds"]
        peer = f"{content['program']} of {content['date']} on {content['machine']}; liehom on {machine()}."
    rows = [compared(task, seconds(task), figures[task.name]) for task in chosen]
    text = table(rows, peer)
    print(text)
    if "--write" in sys.argv:
        put(PAGE, text)
        put(SUMMARY, summary(text))
    if missed := [row.name for row in rows if row.kept is False]:
        print("targets that are missed:", "; ".join(missed))


if __name__ == "__main__":
    main()
