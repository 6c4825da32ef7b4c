"""Parameters of a traced step: the numbers in args, as constants of the run or of a trajectory.

A number is known by its name, such as ``args['inertia'][0]``. So a graph that was traced for some args can be run for
others of the same form, with the values of `arg_values`.
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

import numpy as np

from liehom.pytrees import Leaf, PerTrajectory, leaves, mapped
from liehom.tracing.array import Traced
from liehom.tracing.graph import Tape
from liehom.typing import IntegerArray, Pytree


def traced_args(tape: Tape, args: Pytree, lead: int = 1) -> Pytree:
    """args with tracers for its numbers: `RunConstant` and, for slices of a trajectory, `LaneConstant`.

    Parameters
    ----------
    tape : Tape
    args : pytree
    lead : int
        The number of leading axes of an ensemble in arrays with one slice per trajectory.

    Examples
    --------
    >>> tape = Tape()
    >>> made = traced_args(tape, {"inertia": [1.0, 2.0], "rate": PerTrajectory([5.0, 6.0, 7.0])})
    >>> made["rate"].shape, [constant.name for constant in tape.constant_functions]
    ((), ["args['inertia'][0]", "args['inertia'][1]", "args['rate']"])
    """

    def traced(leaf: Leaf) -> Traced:
        value, shape, varies = _of(leaf, lead)
        made = np.empty(shape, dtype=object)
        for entry in np.ndindex(shape):
            name = _name(leaf.path, entry)
            if varies:
                made[entry] = tape.lane_constant(name, value[(..., *entry)])
            else:
                made[entry] = tape.run_constant(name, value[entry] if entry else value)
        boolean = getattr(value, "dtype", np.dtype(type(value))).kind == "b"
        return Traced(tape, made) != 0 if boolean else Traced(tape, made)

    return mapped(args, traced)


def arg_values(args: Pytree, lead: int) -> dict[str, Any]:
    """The numbers in args by their names: numbers, or arrays (L,) for slices of the trajectories.

    Examples
    --------
    >>> arg_values({"inertia": [1.0, 2.0], "rate": PerTrajectory([[5.0], [6.0]])}, 2)
    {"args['inertia'][0]": 1.0, "args['inertia'][1]": 2.0, "args['rate']": array([5., 6.])}
    """
    found: dict[str, Any] = {}
    for leaf in leaves(args):
        value, shape, varies = _of(leaf, lead)
        for entry in np.ndindex(shape):
            number = value[(..., *entry)].reshape(-1) if varies else value[entry] if entry else value
            found[_name(leaf.path, entry)] = number
    return found


def args_form(args: Pytree, lead: int) -> Hashable:
    """The form that args must share for one graph to serve them: paths and shapes.

    Examples
    --------
    >>> args_form({"gain": 2.0}, 0) == args_form({"gain": 3}, 0) != args_form({"gain": [2.0]}, 0)
    True
    """
    rows = [(leaf.path, *_of(leaf, lead)) for leaf in leaves(args)]
    return tuple(
        (path, shape, varies, getattr(value, "dtype", np.dtype(type(value))).kind == "b")
        for path, value, shape, varies in rows
    )


def args_of_lanes(args: Pytree, lead: tuple[int, ...], lanes: IntegerArray) -> Pytree:
    """args of some trajectories of an ensemble, whose slices per trajectory are then of shape (L, ...).

    Examples
    --------
    >>> args_of_lanes({"rate": PerTrajectory([[5.0], [6.0]])}, (2, 1), np.array([1]))["rate"].value
    array([6.])
    """

    def taken(leaf: Leaf) -> object:
        if not isinstance(leaf.value, PerTrajectory):
            return leaf.value
        value = leaf.value.value
        return PerTrajectory(value.reshape(-1, *value.shape[len(lead) :])[lanes])

    return mapped(args, taken)


def _of(leaf: Leaf, lead: int) -> tuple[Any, tuple[int, ...], bool]:
    """Value of a leaf, its shape for one trajectory, and whether it has one slice per trajectory."""
    varies = isinstance(leaf.value, PerTrajectory)
    value = leaf.value.value if varies else leaf.value
    return value, tuple(np.shape(value))[lead if varies else 0 :], varies


def _name(path: str, entry: tuple[int, ...]) -> str:
    return path + "".join(f"[{i}]" for i in entry)
