"""The table of the structure theory beside GAP, Sage and dgcv: `python -m tests.benchmarks.structure_report [--write]`.

Processor seconds, medians of some rounds, on fresh objects.  GAP runs on the same algebras in the same run if it is
installed and `--gap` is given, else its committed figures are shown.  `--write` puts the table into the page.
"""

from __future__ import annotations

import gc
import statistics
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.benchmarks.peers_gap import committed, installed, machine, measured
from tests.benchmarks.structure_tasks import Task, tasks

PAGE = Path(__file__).resolve().parents[2] / "docs" / "performance.md"
BEGIN, END = "<!-- structure: begin -->", "<!-- structure: end -->"
ROUNDS = 5
TIMES_FASTER = 10.0  # than Sage and dgcv


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
    """Two significant digits."""
    return f"{seconds:.2g}" if seconds < 10 else f"{seconds:.0f}"


def least(gap: float | str) -> float:
    """What GAP took at least."""
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
    """The rows in Markdown."""
    head = ["task", "liehom, s", "GAP, s", "GAP / liehom", "Sage / liehom", "dgcv / liehom", "target met"]
    lines = [head, ["---"] * len(head), *(row.cells() for row in rows)]
    return "\n".join([peer, "", *("| " + " | ".join(line) + " |" for line in lines)])


def main() -> None:
    """Measure, print, and write if asked."""
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
        page = PAGE.read_text(encoding="utf-8")
        before, after = page.partition(BEGIN)[0], page.partition(END)[2]
        PAGE.write_text(f"{before}{BEGIN}\n{text}\n{END}{after}", encoding="utf-8")
    if missed := [row.name for row in rows if row.kept is False]:
        print("targets that are missed:", "; ".join(missed))


if __name__ == "__main__":
    main()
