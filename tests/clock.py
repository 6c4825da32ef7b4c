"""Seconds that mean the same on a slow, busy machine: processor time against that of fixed work beside it."""

import time
from collections.abc import Callable

UNIT = 0.002  # seconds of the fixed work on the machine for which the limits were set


def _fixed_work() -> int:
    table = {}
    for x in range(20_000):
        table[x % 977] = x * x % 1009
    return sum(table.values())


def seconds(action: Callable[[], object], tries: int = 5) -> float:
    """Processor time of action, the best of some tries, each in units of fixed work done just before and after it."""
    best = float("inf")
    for _ in range(tries):
        times = []
        for work in (_fixed_work, action, _fixed_work):
            start = time.process_time()
            work()
            times.append(time.process_time() - start)
        best = min(best, times[1] / max(times[0], times[2], UNIT) * UNIT)
    return best
