"""What GAP takes for the tasks of `structure_tasks`, here and in one process: `python -m tests.benchmarks.peers_gap`.

Time is processor time, measured inside GAP on objects that were made for this call, so that nothing is cached; what is
too quick for its clock (milliseconds) is repeated on further fresh objects.  Run as a program it writes peers.json, the
table that is shown where GAP is not installed.
"""

import datetime
import json
import platform
import resource
import shutil
import statistics
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tests.benchmarks.structure_tasks import Task, tasks
from tests.oracles.gap_process import Gap, Refused, Timeout

TABLE = Path(__file__).resolve().parent / "peers.json"
ROUNDS = 3
TIMED = """Seconds_ := function( make, run )
  local k, objects, o, t;
  k := 1;
  repeat
    objects := List( [ 1 .. k ], i -> make() );
    t := Runtime();
    for o in objects do run( o ); od;
    t := Runtime() - t;
    if t < 60 then k := 4 * k; fi;
  until t >= 60 or k > 256;
  return t / ( 1000 * Length( objects ) );
end;;
"""


def installed() -> bool:
    return shutil.which("gap") is not None


def seconds_of(gap: Gap, task: Task, rounds: int = ROUNDS) -> float | str:
    """The median seconds of some rounds; '> processor seconds' if it was stopped, 'refused' if GAP raises an error."""
    setup, make, run = task.gap
    found: list[float] = []
    reaped, spent = _reaped(), 0.0
    try:
        gap.begin(f"{TIMED}{setup}")
        spent = float(gap.ask("Float( Runtime() / 1000 )", task.limit))
        while len(found) < rounds:
            found.append(float(gap.ask(f"Float( Seconds_( function() return {make}; end, {run} ) )", task.limit)))
            if found[0] > 5:
                break
    except Timeout:
        # the limit is by the clock: what counts is the processor time that the stopped process has had for it
        return f"> {int(_reaped() - reaped - spent)}"
    except Refused as error:
        return f"refused: {error}"
    return statistics.median(found)


def _reaped() -> float:
    """Processor seconds of the child processes that have ended."""
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime


def measured(rows: Sequence[Task]) -> dict[str, float | str]:
    """{name of the task: seconds} in one process of GAP."""
    with Gap() as gap:
        return {task.name: seconds_of(gap, task) for task in rows}


def committed() -> dict[str, Any]:
    table: dict[str, Any] = json.loads(TABLE.read_text(encoding="utf-8"))
    return table


def machine() -> str:
    names = [line.split(":", 1)[1].strip() for line in _cpu_lines() if line.startswith("model name")]
    return f"{names[0] if names else platform.machine()}, {len(names) or '?'} cores, {platform.system()}"


def _cpu_lines() -> list[str]:
    path = Path("/proc/cpuinfo")
    return path.read_text(encoding="utf-8").splitlines() if path.exists() else []


def main() -> None:
    with Gap() as gap:
        gap.begin("")
        version = gap.ask("GAPInfo.Version", 30).strip()
        table = committed()["seconds"] if TABLE.exists() else {}
        for task in tasks():
            if not sys.argv[1:] or any(part in task.name for part in sys.argv[1:]):
                table[task.name] = seconds_of(gap, task)
                print(f"{task.name:60} {table[task.name]}", flush=True)
    content = {
        "program": f"GAP {version}",
        "date": datetime.date.today().isoformat(),
        "machine": machine(),
        "measure": "processor seconds, median of three, fresh objects",
        "seconds": {task.name: table[task.name] for task in tasks() if task.name in table},
    }
    TABLE.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
