"""Kernel: machine code of a whole run of a traced step, for blocks of lanes."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.errors import LiehomError
from liehom.tracing.array import Traced
from liehom.tracing.expr import Expr, LaneConstant, RunConstant
from liehom.tracing.graph import TrajectoryConstant
from liehom.tracing.machine_code.machine import engine_of
from liehom.tracing.machine_code.run_text import FIELDS, Constant, run_module, state_names
from liehom.tracing.step_graph import StepGraph

PLACES = {name: place for place, name in enumerate(FIELDS)}


@final
class Kernel:
    """Machine code of a whole run of a traced step, for blocks of `width` lanes.

    Parameters
    ----------
    graph : StepGraph
    width : int

    Attributes
    ----------
    names : list of str
        Rows of the state of a lane.
    run_constants : list of str
        Names of the numbers that a run gives, in their order.
    lane_constants : list of callable
        Functions of the initial points that did not run on tracers, and numbers that trajectories are given: numpy
        computes their values.
    cached : bool
        Whether the code was found in the cache.
    """

    graph: StepGraph
    width: int
    text: str
    cached: bool

    def __init__(self, graph: StepGraph, width: int) -> None:
        self.graph, self.width = graph, width
        self.names: list[str] = state_names(graph)
        self.run_constants: list[str] = []
        self.lane_constants: list[TrajectoryConstant] = []
        self.text = run_module(graph, [self._place(x) for x in graph.constant_functions], width)
        self._engine, self.cached = engine_of(self.text)
        self.run: Any = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(self._engine.get_function_address("run"))

    def _place(self, function: TrajectoryConstant) -> Constant:
        if isinstance(function, RunConstant):
            self.run_constants.append(function.name)
            return "run", len(self.run_constants) - 1
        made = None if isinstance(function, LaneConstant) else _on_tracers(function, self.graph)
        if made is None:
            self.lane_constants.append(function)
            return "lane", len(self.lane_constants) - 1
        return made

    def packed(self, lanes: int, given: Mapping[str, Any]) -> npt.NDArray[np.float64]:
        """Rows (names, lanes in whole blocks) of the state: given values, with "x" for the points (N, L), and else 0.

        The lanes that fill up the last block are at the first point, so that their numbers are not out of bounds.
        """
        state = np.zeros((len(self.names), padded(lanes, self.width)))
        for name, value in given.items():
            if name == "x":
                state[: len(value), :lanes] = value
                state[: len(value), lanes:] = value[:, :1]
            else:
                state[self.names.index(name), :lanes] = value
        return state

    def __call__(self, state: npt.NDArray[np.float64], **fields: npt.NDArray[Any] | float | None) -> None:
        """Make steps of the lanes of a state (names, lanes), in place.

        Parameters
        ----------
        state : array
        **fields : arrays, numbers or None
            Other `FIELDS` of the argument of the machine code; by default all blocks of lanes are run.
        """
        argument = self.argument(state, **fields)  # must live as long as the machine code runs
        self.run(argument.ctypes.data)

    def argument(
        self, state: npt.NDArray[np.float64], **fields: npt.NDArray[Any] | float | None
    ) -> npt.NDArray[np.int64]:
        """The argument of the machine code for a state and other fields, which must outlive it."""
        argument = np.zeros(len(FIELDS), dtype=np.int64)
        count = state.shape[1]
        for name, value in {"state": state, "lanes": count, "last": count // self.width, **fields}.items():
            if isinstance(value, np.ndarray):
                argument[PLACES[name]] = value.ctypes.data
            elif name == "origin":
                argument.view(np.float64)[PLACES[name]] = value
            elif value is not None:
                argument[PLACES[name]] = value
        return argument

    def run_values(self, given: Mapping[str, float]) -> npt.NDArray[np.float64]:
        """The numbers of a run as an array, from their values by name; 0 by default."""
        return np.array([given.get(name, 0.0) for name in self.run_constants] or [0.0])


def _on_tracers(function: TrajectoryConstant, graph: StepGraph) -> Expr | None:
    """A trajectory constant as an expression of inputs 0..N-1; None if the function needs numbers."""
    tape: Any = graph.point[0].tape
    points = Traced(tape, Traced.inputs(tape, 0, graph.size)[None])
    try:
        made = Traced(tape, function(points))
        entry: Expr = made.entries.reshape(-1)[0]
        return entry if made.size == 1 else None
    except (LiehomError, TypeError, ValueError, AttributeError, IndexError):
        return None


def padded(count: int, width: int) -> int:
    """Number of lanes, rounded up to whole blocks.

    Examples
    --------
    >>> padded(10, 8)
    16
    """
    return -(-count // width) * width
