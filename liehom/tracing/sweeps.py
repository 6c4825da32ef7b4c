"""A recorded graph on arrays: its values in one forward sweep, its derivatives in one backward sweep per output.

All operations run on arrays of one entry per lane.  A backward sweep multiplies given weights of the outputs by the
derivatives of the graph, from the outputs to the inputs, at a few times the cost of the forward one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import ceil, log2
from typing import Any, final

import numpy as np

from liehom.errors import TraceError
from liehom.tracing.expr import Expr
from liehom.tracing.gradient import Number, partials, rotation
from liehom.tracing.graph import needed
from liehom.typing import Array

EXP_TERMS = 18
"""Terms of exp(A) for |A| <= 1, to double precision."""


@final
class Sweeps:
    """The values of a graph at given inputs, and its derivatives there.

    Parameters
    ----------
    outputs : sequence of Expr
        Numbers, not booleans.
    inputs : dict
        Arrays of shape (L,), or numbers, by the index of the input.
    lanes : int
        L.

    Raises
    ------
    TraceError
        If the graph has a loop, or an operation without a derivative.

    Examples
    --------
    >>> from liehom.tracing import Tape
    >>> tape = Tape()
    >>> x, y = tape.input(0), tape.input(1)
    >>> made = Sweeps([x * y, x + y], {0: np.array([2.0, 3.0]), 1: 5.0}, 2)
    >>> made.values[0].tolist(), made.pulled([1.0, 0.0])[0].tolist(), made.pulled([1.0, 0.0])[1].tolist()
    ([10.0, 15.0], [5.0, 5.0], [2.0, 3.0])
    """

    def __init__(self, outputs: Sequence[Expr], inputs: Mapping[int, Array | float], lanes: int) -> None:
        self.lanes = lanes
        self._outputs = list(outputs)
        self._order = needed(outputs)
        self._values: dict[int, Any] = {}
        with np.errstate(all="ignore"):
            for x in self._order:
                self._values[x.index] = self._value(x, inputs)
        self.values: list[Array] = [np.broadcast_to(self._values[x.index], (lanes,)) for x in outputs]

    def _value(self, x: Expr, inputs: Mapping[int, Array | float]) -> Number:
        if x.constant:
            return x.value
        if x.op == "input":
            return inputs[x.value]
        args = [self._values[a.index] for a in x.args]
        if x.op == "get":
            return args[0][x.value]
        if x.op == "expv":
            return self._moved(x.value, args)
        function = _OPERATIONS.get(x.op) or getattr(np, x.op, None)
        if function is None:
            raise TraceError(
                f"the derivative of a step with {'an iteration' if x.op == 'loop' else f'the operation {x.op}'} is "
                "not known: take an explicit method, or differentiate with JAX (engine='jax')"
            )
        return function(*args)

    def _moved(self, places: tuple[tuple[int, int], ...], args: list[Any]) -> Array:
        """exp(A) v, shape (n, L), of the entries of A and v."""
        matrix, vector = self._parts(places, args)
        made: Array = np.moveaxis((exponentials(matrix) @ vector[..., None])[..., 0], -1, 0)
        return made

    def _parts(self, places: tuple[tuple[int, int], ...], args: list[Any]) -> tuple[Array, Array]:
        n = len(args) - len(places)
        matrix = np.zeros((self.lanes, n, n))
        for (i, j), value in zip(places, args, strict=False):
            matrix[:, i, j] = value
        vector = np.stack([np.broadcast_to(v, (self.lanes,)) for v in args[len(places) :]], axis=-1)
        return matrix, vector

    def pulled(self, weights: Sequence[Array | float]) -> dict[int, Array]:
        """The sums of weight times derivative over the outputs, by the index of the input; each of shape (L,).

        Parameters
        ----------
        weights : sequence
            One number, or one array of shape (L,), for each output.
        """
        seeds: dict[int, Any] = {}
        found: dict[int, Array] = {}
        for output, weight in zip(self._outputs, weights, strict=True):
            if np.any(weight):
                seeds[output.index] = seeds.get(output.index, 0.0) + weight
        blocks: dict[int, dict[int, Any]] = {}
        with np.errstate(all="ignore"):
            for x in reversed(self._order):
                if x.index in blocks:
                    parts = self._through_exponential(x, blocks.pop(x.index))
                elif x.constant or x.index not in seeds:
                    continue
                elif x.op == "input":
                    found[x.value] = np.broadcast_to(seeds.pop(x.index), (self.lanes,))
                    continue
                elif x.op == "get":
                    blocks.setdefault(x.args[0].index, {})[x.value] = seeds.pop(x.index)
                    continue
                else:
                    parts = self._through(x, seeds.pop(x.index))
                for argument, part in parts:
                    seeds[argument.index] = seeds[argument.index] + part if argument.index in seeds else part
        return found

    def _through(self, x: Expr, seed: Number) -> list[tuple[Expr, Any]]:
        """The weights of the arguments of an operation, from the weight of its result."""
        args = [self._values[a.index] for a in x.args]
        if x.op == "select":
            where = np.broadcast_to(args[0], (self.lanes,))
            made = [None, np.where(where, seed, 0.0), np.where(where, 0.0, seed)]
        else:
            fixed = x.op == "pow" and x.args[1].constant
            slopes = partials(_NUMBERS, x.op, args, self._values[x.index], fixed_exponent=fixed)
            made = [np.where(seed == 0, 0.0, seed * p) for p in slopes]  # also where a branch not taken is infinite
        return [(a, p) for a, p in zip(x.args, made, strict=True) if not (a.constant or a.boolean)]

    def _through_exponential(self, x: Expr, seeds: dict[int, Any]) -> list[tuple[Expr, Any]]:
        """The weights of A and v, from the weights w of exp(A) v.

        They are exp(A)^T w for v, and for A the block (1, 2) of exp of ((A^T, w v^T), (0, A^T)).
        """
        matrix, vector = self._parts(x.value, [self._values[a.index] for a in x.args])
        n = vector.shape[-1]
        weight = np.stack([np.broadcast_to(seeds.get(i, 0.0), (self.lanes,)) for i in range(n)], axis=-1)
        double = np.zeros((self.lanes, 2 * n, 2 * n))
        double[:, :n, :n] = double[:, n:, n:] = np.swapaxes(matrix, 1, 2)
        double[:, :n, n:] = weight[:, :, None] * vector[:, None, :]
        made = exponentials(double)
        by_matrix, by_vector = made[:, :n, n:], (made[:, :n, :n] @ weight[..., None])[..., 0]
        parts = [by_matrix[:, i, j] for i, j in x.value] + [by_vector[:, i] for i in range(n)]
        return [(a, p) for a, p in zip(x.args, parts, strict=True) if not a.constant]


def exponentials(matrices: Array) -> Array:
    """exp of matrices (L, n, n), by its series after scaling, and squaring.

    Examples
    --------
    >>> exponentials(np.array([[[0.0, -np.pi / 2], [np.pi / 2, 0.0]]])).round(12).tolist()
    [[[0.0, -1.0], [1.0, 0.0]]]
    """
    norms = np.abs(matrices).sum(axis=-1).max(axis=-1, initial=0.0)
    largest = float(np.max(norms, initial=0.0, where=np.isfinite(norms)))
    squarings = max(0, ceil(log2(largest))) if largest > 0 else 0
    scaled = matrices / 2**squarings
    one = np.eye(matrices.shape[-1])
    made: Array = one + scaled / EXP_TERMS
    for k in range(EXP_TERMS - 1, 0, -1):
        made = one + scaled @ made / k
    for _ in range(squarings):
        made = made @ made
    return made


_OPERATIONS: dict[str, Callable[..., Any]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
    "pow": lambda a, b: np.power(a, b),
    "lt": lambda a, b: a < b,
    "le": lambda a, b: a <= b,
    "eq": lambda a, b: a == b,
    "ne": lambda a, b: a != b,
    "and": np.logical_and,
    "not": np.logical_not,
    "select": np.where,
    "abs": np.abs,
    "sinq": lambda q: rotation(q, 1),
    "cosq": lambda q: rotation(q, 0),
}


@final
class _Numbers:
    """The methods of `Tape` that derivatives use, on arrays."""

    one, zero = 1.0, 0.0

    def __getattr__(self, name: str) -> Callable[..., Any]:
        if name not in _OPERATIONS:
            raise AttributeError(name)
        return _OPERATIONS[name]

    def power(self, a: Number, b: Number) -> Number:
        return np.power(a, b)

    def compare(self, name: str, a: Number, b: Number) -> Number:
        return _OPERATIONS[name](a, b)

    def call(self, name: str, a: Number) -> Number:
        return (_OPERATIONS.get(name) or getattr(np, name))(a)

    def constant(self, value: float) -> float:
        return value


_NUMBERS = _Numbers()
