"""Every door with malformed input: only errors of the library come out, in the time and memory that are stated.

    python -m tests.campaigns.doors --count 100000

Input number i is drawn from the seed and i alone, so `--only i` repeats it. Inputs run in a child process with a bound
on its memory, and each has a deadline; a child that does not answer is ended, and its input is named. The outcome is

  read       a result, whose repr and str work
  refused    a subclass of `LiehomError` other than `InternalError`
  limit      a `LimitError` (among them those of the deadline)
  type       a `TypeError`: the argument is of a Python type that no number, sequence or mapping has

and anything else is an offender: another exception, more time than stated, or more memory. The figures go to
figures/doors.json; a campaign that has figures goes on where it was.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing as mp
import os
import random
import resource
import signal
import sys
import time
import warnings
from collections import Counter, defaultdict
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from types import FrameType
from typing import Any

import liehom as lh
from liehom.base.errors import InternalError, LiehomError, LimitError
from tests.campaigns.door_inputs import DOORS, Call

FIGURES = Path(__file__).with_name("figures") / "doors.json"
SECONDS = 5.0
"""The deadline of each input, as the limit of this name."""
STATED = SECONDS + 5.0
"""Seconds of the processor that an input may take: the deadline, and what a call of compiled code takes after it."""
STUCK = 200.0
"""After this time by the clock a child is ended."""
MEMORY = 6 * 1024**3
BATCH = 500
OUTCOMES = ("read", "refused", "limit", "type", "offenders")


class TooSlowError(BaseException):
    """The alarm; not an Exception, so that nothing catches it."""


def alarm(number: int, frame: FrameType | None) -> None:
    raise TooSlowError


def drawn(seed: int, number: int) -> tuple[str, Call, str]:
    """Name of the door, the call, and a description of input `number`."""
    rng = random.Random(f"{seed}:{number}")
    name = sorted(DOORS)[number % len(DOORS)]
    call, text = DOORS[name](rng)
    return name, call, text


def outcome(call: Call) -> tuple[str, str]:
    """Outcome of a call, and what is wrong for an offender."""
    try:
        with lh.limits(seconds=SECONDS):
            found = call()
            if (
                type(found).__module__ != "builtins"
            ):  # a mapping of the caller may hold integers that Python cannot print
                for written in (repr(found), str(found)):
                    assert isinstance(written, str)
    except InternalError as error:
        return "offenders", f"InternalError: {str(error)[:200]}"
    except LimitError:
        return "limit", ""
    except LiehomError as error:
        return ("refused", "") if str(error) else ("offenders", f"{type(error).__name__} without a message")
    except TypeError:
        return "type", ""
    except TooSlowError:
        return "offenders", f"not done after {STATED} seconds"
    except MemoryError:
        return "offenders", f"more than {MEMORY >> 30} GiB"
    except BaseException as error:  # noqa: BLE001  whatever else comes out is what the campaign looks for
        return "offenders", f"{type(error).__name__}: {str(error)[:200]}"
    return "read", ""


def tried(seed: int, number: int) -> tuple[str, str, str, float]:
    """Door, outcome, fault and seconds of one input; an alarm ends it."""
    name, call, _ = drawn(seed, number)
    before = signal.signal(signal.SIGPROF, alarm)
    signal.setitimer(signal.ITIMER_PROF, STATED)
    start = time.process_time()
    try:
        found, fault = outcome(call)
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)
    spent = time.process_time() - start
    if spent > STATED and found != "offenders":
        found, fault = "offenders", f"{spent:.1f} seconds"
    return name, found, fault, spent


def _child(seed: int, first: int, last: int, pipe: Connection) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    with open(os.devnull, "w", encoding="utf-8") as nowhere:
        os.dup2(nowhere.fileno(), 2)
        warnings.simplefilter("ignore")
        for number in range(first, last):
            pipe.send((number, *tried(seed, number)))
    pipe.close()


@dataclass
class Campaign:
    """Figures so far: inputs 0 to `done` - 1 of a seed."""

    seed: int = 0
    done: int = 0
    seconds: float = 0.0
    slowest: float = 0.0
    figures: Counter[str] = field(default_factory=Counter)  # "door | outcome"
    offenders: list[dict[str, Any]] = field(default_factory=list)

    def record(self, number: int, name: str, found: str, fault: str, spent: float) -> None:
        self.figures[f"{name} | {found}"] += 1
        self.slowest = max(self.slowest, spent)
        if found == "offenders":
            self.offenders.append(
                {"input": number, "door": name, "fault": fault, "text": drawn(self.seed, number)[2][:300]}
            )
        self.done = number + 1

    def run(self, count: int, output: Path | None = None) -> None:
        context = mp.get_context("fork")
        while self.done < count:
            start = time.monotonic()
            here, there = context.Pipe(duplex=False)
            last = min(count, self.done + BATCH)
            child = context.Process(target=_child, args=(self.seed, self.done, last, there), daemon=True)
            child.start()
            there.close()
            try:
                while here.poll(STUCK):
                    self.record(*here.recv())
                fault = f"no answer after {STUCK:.0f} seconds"
            except EOFError:
                fault = "the process died"
            child.kill()
            child.join()
            if self.done < last:
                self.record(self.done, drawn(self.seed, self.done)[0], "offenders", fault, STUCK)
            self.seconds += time.monotonic() - start
            if output is not None:
                output.write_text(json.dumps(self.to_json(), indent=1) + "\n", encoding="utf-8")

    def to_json(self) -> dict[str, Any]:
        rows: dict[str, dict[str, int]] = defaultdict(lambda: dict.fromkeys(OUTCOMES, 0))
        for key, number in sorted(self.figures.items()):
            name, found = key.split(" | ")
            rows[name][found] = number
        return {
            "count": self.done,
            "seed": self.seed,
            "seconds": round(self.seconds),
            "slowest": round(self.slowest, 1),
            "rows": [{"class": name, **row} for name, row in rows.items()],
            "offenders": self.offenders,
        }

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> Campaign:
        figures = Counter({f"{row['class']} | {name}": row[name] for row in data["rows"] for name in OUTCOMES})
        return cls(data["seed"], data["count"], data["seconds"], data["slowest"], figures, data["offenders"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--output", type=Path, default=FIGURES, help="figures as JSON; a file that exists is continued")
    parser.add_argument("--only", type=int, help="run this input alone, with its traceback")
    chosen = parser.parse_args()
    if chosen.only is not None:
        name, call, text = drawn(chosen.seed, chosen.only)
        print(name, text, sep="\n", flush=True)
        with lh.limits(seconds=SECONDS):
            print(repr(call())[:1000])
        return
    campaign = Campaign(chosen.seed)
    if chosen.output.exists():
        campaign = Campaign.from_json(json.loads(chosen.output.read_text(encoding="utf-8")))
    campaign.run(chosen.count, chosen.output)
    print(json.dumps(campaign.to_json(), indent=1))
    sys.exit(1 if campaign.offenders else 0)


if __name__ == "__main__":
    main()
