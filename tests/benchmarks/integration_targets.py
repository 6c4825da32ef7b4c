"""Targets for compiled integration, measured in one run.

(a) the compiled step against a kernel in C, (b) numpy arrays against numpy by hand, (c) compile time, (d) one
trajectory.
"""

import os
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import liehom as lh
from liehom.flow.engines.traced_step import traced_step
from liehom.flow.tracing.machine import Kernel, padded
from tests.benchmarks import test_compiled as by_hand


def kernels(*, tiny: bool = False) -> dict[str, Any]:
    """(a) to (d)."""
    rounds = 1 if tiny else 30
    found: dict[str, Any] = {}
    m = by_hand.starts(padded(by_hand.LANES, 16))
    x, steps = np.ascontiguousarray(m.T), 2 if tiny else by_hand.STEPS
    with tempfile.TemporaryDirectory() as folder:
        hand = _c_kernel(Path(folder))
        for nominal in (True, False) if hand else ():
            made = by_hand.compiled(lh.Corrected(lh.Euler(), 2), 16, nominal=nominal, points=m[:8])
            floor, ours = by_hand.in_turns(
                lambda: by_hand.least(hand, x, steps), lambda made=made: by_hand.least(made, x, steps), rounds
            )  # type: ignore[misc]
            found["nominal" if nominal else "corrected"] = {"C": floor, "compiled": ours, "ratio": ours / floor}
    found["arrays"] = _arrays(by_hand.starts(100 if tiny else 10_000), 2 if tiny else 20, 1 if tiny else 8)
    found["compile"] = compile_time(2 if tiny else 6)
    one = np.ascontiguousarray(by_hand.starts(1).T)
    for name, step in (("Euler", lh.Euler()), ("corrected", lh.Corrected(lh.Euler(), 2))):
        made = by_hand.compiled(step, 1, nominal=False, points=one.T)
        count = 100 if tiny else 200_000
        found[f"one {name}"] = min(by_hand.least(made, one, count) for _ in range(1 if tiny else 10))
    return found


def _c_kernel(folder: Path) -> Callable[[Any, int], None] | None:
    import pytest

    try:
        return by_hand.by_c(folder)
    except pytest.skip.Exception:
        return None


def _arrays(m: Any, count: int, rounds: int) -> dict[str, float]:
    step, end = lh.Corrected(lh.Euler(), 2), count * by_hand.H

    def ours() -> float:
        begin = time.process_time()
        lh.integrate(by_hand.FIELD, (0, end), m, step=step, dt=by_hand.H, clock="nominal", t_eval=[end])
        return time.process_time() - begin

    def hand() -> float:
        begin = time.process_time()
        by_hand.by_numpy(m.T, count)
        return time.process_time() - begin

    floor, taken = by_hand.in_turns(hand, ours, rounds)
    return {"numpy": floor / count, "liehom": taken / count, "ratio": taken / floor}


def compile_time(order: int) -> dict[str, float]:
    """Seconds for a corrected step on S^4, with an empty cache and then with what it has kept."""
    a, b = np.random.default_rng(1).normal(size=(2, 5, 10))
    field = lh.GeneratorField(lh.defining(lh.so(5)), lambda m: m @ a + (m * m) @ b)
    before = os.environ.get("LIEHOM_CACHE_DIR")

    def made() -> float:
        begin = time.process_time()
        step = lh.Corrected(lh.Euler(), order)
        Kernel(traced_step(lh.Action(field.representation), field, step, np.eye(5), 4, nominal=False), 8)
        return time.process_time() - begin

    with tempfile.TemporaryDirectory() as folder:
        os.environ["LIEHOM_CACHE_DIR"] = folder
        try:
            return {"first": made(), "again": made()}
        finally:
            os.environ.pop("LIEHOM_CACHE_DIR")
            if before is not None:
                os.environ["LIEHOM_CACHE_DIR"] = before
