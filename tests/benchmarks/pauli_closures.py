"""Closures of spin models beside PennyLane's `lie_closure`, in one run.

    python -m tests.benchmarks.pauli_closures

Both get the same Hamiltonians as single Pauli words: liehom as strings, PennyLane as its own `PauliWord` objects, which
are made outside of the timed part. Times are processor time, the smallest of several runs. PennyLane belongs to the
dependency group `bench`; without it its column is empty. A second table has sums of words, for liehom alone.
"""

import time
from collections.abc import Callable
from importlib import import_module
from typing import Any

import liehom as lh

RUNS = 3
MODELS = {"TFIM": lh.pauli.ising, "XY": lh.pauli.xy, "Heisenberg": lh.pauli.heisenberg}
SITES = range(2, 7)


def neighbours(word: str, n: int) -> str:
    return " + ".join("I" * i + word + "I" * (n - len(word) - i) for i in range(n - len(word) + 1))


def controls(n: int, field: str, coupling: str = "") -> list[str]:
    return [neighbours("ZZ", n) + coupling, neighbours("X", n), field]


def graded(n: int) -> str:
    return " + ".join(f"{i + 1}*Z({i})" for i in range(n))


SUMS = {
    "graded field, 4 qubits": controls(4, graded(4)),
    "graded field, next neighbours / 64, 4 qubits": controls(4, graded(4), " + 1/64*ZIZI + 1/64*IZIZ"),
    "uniform field, 4 qubits": controls(4, neighbours("Z", 4)),
    "graded field, 5 qubits": controls(5, graded(5)),
    "uniform field, 5 qubits": controls(5, neighbours("Z", 5)),
}


def seconds(action: Callable[[], Any]) -> tuple[float, Any]:
    best, found = float("inf"), None
    for _ in range(RUNS):
        begin = time.process_time()
        found = action()
        best = min(best, time.process_time() - begin)
    return best, found


def peer(words: list[str]) -> Callable[[], int] | None:
    try:
        pennylane = import_module("pennylane")
    except ImportError:
        return None
    made = [pennylane.pauli.PauliWord({q: letter for q, letter in enumerate(w) if letter != "I"}) for w in words]
    return lambda: len(pennylane.lie_closure(made, pauli=True))


def rows() -> list[tuple[str, int, int, float, float | None]]:
    found = []
    for name, model in MODELS.items():
        for sites in SITES:
            words = model(lh.pauli.chain(sites))
            here, dimension = seconds(lambda words=words: lh.pauli.closure(words).dimension)  # type: ignore[misc]
            other = peer(words)
            there, theirs = (None, dimension) if other is None else seconds(other)
            if theirs != dimension:
                raise SystemExit(f"{name} on {sites} sites: dimension {dimension} here, {theirs} there")
            found.append((name, sites, dimension, here, there))
    return found


def main() -> None:
    print("| model | sites | dimension | liehom, ms | PennyLane, ms | ratio |")
    print("|---|---|---|---|---|---|")
    for name, sites, dimension, here, there in rows():
        other, ratio = ("", "") if there is None else (f"{1000 * there:.2f}", f"{there / here:.0f}")
        print(f"| {name} | {sites} | {dimension} | {1000 * here:.2f} | {other} | {ratio} |")
    print("\n| sums | words | dimension | closure, s | summary, s |")
    print("|---|---|---|---|---|")
    for name, sums in SUMS.items():
        made = lh.pauli.closure(sums)
        begin = time.process_time()
        dimension = made.dimension
        middle = time.process_time()
        made.describe()
        end = time.process_time()
        print(f"| {name} | {len(made.words)} | {dimension} | {middle - begin:.1f} | {end - middle:.1f} |")


if __name__ == "__main__":
    main()
