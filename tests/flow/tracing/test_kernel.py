"""Calls of machine code."""

import ctypes

import numpy as np

from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import Tape
from liehom.flow.tracing.loop import StepGraph
from liehom.flow.tracing.machine import PLACES, Kernel


def test_the_argument_lives_as_long_as_the_code_runs() -> None:
    """Whoever allocates memory meanwhile, as another thread may, does not get that of the argument."""
    tape, seen = Tape(), []
    kernel = Kernel(StepGraph([Traced(tape, tape.input(0)).entries[()]], None, None, {}, {}), 1)

    def run(address: int) -> None:
        others = [np.full(len(PLACES), -1) for _ in range(100)]
        seen.append((ctypes.c_int64 * len(PLACES)).from_address(address)[PLACES["lanes"]])
        del others

    kernel.run = run
    kernel(kernel.packed(3, {"x": np.ones((1, 3))}))
    assert seen == [3]
