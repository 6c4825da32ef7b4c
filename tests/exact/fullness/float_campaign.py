"""Random exact pairs as floats: numerical verdicts compared with proved ones, in the given basis and in rotated ones.

    python -m tests.exact.fullness.float_campaign FIRST LAST

prints each wrong answer and each undecided one, and a table of counts. Pair number i is the same in every run.
"""

import random
import sys
from collections import Counter

import numpy as np

import liehom as lh
from tests.exact.fullness.test_random_pairs import random_pair
from tests.floats import constants_of, pair_of, rotated, rotation


def compared(numbers: range) -> Counter[tuple[str, bool | None, bool | None]]:
    """Counts of (kind of basis, proved answer, numerical answer)."""
    counts: Counter[tuple[str, bool | None, bool | None]] = Counter()
    for number in numbers:
        pair = random_pair(random.Random(f"floats {number}"))
        proved = lh.decide_fullness(pair).full
        constants, rows = constants_of(pair)
        rng = np.random.default_rng(number)
        turned = rotated(constants, rows, rotation(len(constants), rng), 10.0 ** rng.uniform(-12, 12))
        for kind, data in (("given", (constants, rows)), ("rotated", turned)):
            verdict = lh.decide_fullness(pair_of(*data))
            counts[kind, proved, verdict.full] += 1
            if verdict.full is not proved:
                print(f"number {number}, {kind} basis, proved {proved}: {verdict}")
    return counts


def wrong(counts: Counter[tuple[str, bool | None, bool | None]]) -> int:
    """Number of answers that contradict the proved one."""
    return sum(n for (_, proved, result), n in counts.items() if result is not None and result is not proved)


if __name__ == "__main__":
    table = compared(range(int(sys.argv[1]), int(sys.argv[2])))
    for key, count in sorted(table.items(), key=str):
        print(*key, count)
    sys.exit(bool(wrong(table)))
