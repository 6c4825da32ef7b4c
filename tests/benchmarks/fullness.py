"""The table of what decisions cost, in a warm process: `python -m tests.benchmarks.fullness [--large]`.

Reading the JSON text and the proofs of the axioms are included; checking the certificate is shown beside.
"""

import statistics
import sys
import time
from collections.abc import Callable
from typing import Any

import flint

import liehom as lh
from tests.benchmarks.test_decision import decided, small, text_of

NAMED = [
    ("g2/su(3)", True), ("sl(4)/P1", True), ("so(8)/so(7)", True), ("affine(tensor(sl(4),sl(2)))", True),
    ("affine(spin(9,1))", True), ("f4/spin(9)", False), ("f4/spin(9)", True), ("e6(-26)/P", False), ("e6(-26)/P", True),
    ("e6(6)/P", True), ("affine(e6(-26))", False), ("so(20)/so(19)", False),
]  # fmt: skip


def seconds(action: Callable[[], Any], rounds: int = 3) -> float:
    found = []
    for _ in range(rounds):
        start = time.perf_counter()
        action()
        found.append(time.perf_counter() - start)
    return min(found)


def line(name: str, *values: float) -> None:
    print(f"{name:46}" + "".join(f"{1000 * v:12.1f}" for v in values))


def floor(n: int, entries: int) -> float:
    """One dense product (n^2 x n)(n x n) of integers of the given size."""
    table = flint.fmpz_mat(n * n, n, [(31 * i) % entries for i in range(n**3)])
    square = flint.fmpz_mat(n, n, [(17 * i) % entries for i in range(n * n)])
    return seconds(lambda: table * square)


def main() -> None:
    print(f"{'milliseconds':46}{'decide':>12}{'check':>12}{'product':>12}")
    for scrambled in (False, True):
        texts = [text_of(name, scrambled) for name in small()]
        decided(texts[0])
        times = [seconds(lambda text=text: decided(text)) for text in texts]  # type: ignore[misc]
        checks = [seconds(decided(text).verify) for text in texts]
        kind = "scrambled" if scrambled else "plain"
        line(f"median of {len(texts)} pairs, dim g <= 30, {kind}", statistics.median(times), statistics.median(checks))
        line(f"the slowest of them ({small()[times.index(max(times))]})", max(times), max(checks))
    for name, scrambled in NAMED + ([("so(40)/so(39)", False)] if "--large" in sys.argv else []):
        text = text_of(name, scrambled)
        verdict = decided(text)
        n = verdict.pair.algebra.dimension
        values = [seconds(lambda text=text: decided(text)), seconds(verdict.verify)]  # type: ignore[misc]
        line(name + (", scrambled" if scrambled else ""), *values, *([floor(n, 10**4)] if n <= 110 else []))


if __name__ == "__main__":
    assert lh.__version__
    main()
