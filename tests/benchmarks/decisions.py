"""Milliseconds to read, decide and verify a pair, as rows of the table in docs/performance-exact.md.

python -m tests.benchmarks.decisions [PAIR ...]
"""

import json
import sys
import time

import liehom as lh
from liehom.io import loads, to_json

PAIRS = (
    "so(4)/so(3)", "so(3,1)/so(2,1)", "g2/su(3)", "sl(3,H)/P1", "so(12)/so(11)", "f4/spin(9)", "affine(spin(5,5))",
    "e6(-26)/P", "so(20)/so(19)", "so(40)/so(39)",
)  # fmt: skip


def measured(name: str) -> str:
    """A row of the table: the best of three calls in a warm process."""
    text = json.dumps(to_json(lh.pair(name)))
    best = [float("inf")] * 3
    for _ in range(3):
        start = time.perf_counter()
        pair = loads(text)
        read = time.perf_counter()
        verdict = lh.decide_fullness(pair)
        decided = time.perf_counter()
        verdict.verify()
        verified = time.perf_counter()
        best = list(map(min, best, (read - start, decided - read, verified - decided)))
    n, k = pair.algebra.dimension, pair.subalgebra.dimension
    cells = " | ".join(f"{1000 * seconds:.1f}" for seconds in best)
    return f"| `{name}` | {n} / {k} | `{verdict.certificate.kind}` | {cells} |"


if __name__ == "__main__":
    for pair_name in sys.argv[1:] or PAIRS:
        print(measured(pair_name), flush=True)
