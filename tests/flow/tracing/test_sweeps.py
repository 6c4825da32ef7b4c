"""Sweeps over a recorded graph: values as numpy's, derivatives as differences and as the symbolic gradient."""

from typing import Any

import numpy as np
import pytest

from liehom.base.errors import TraceError
from liehom.flow.tracing.array import Traced, entire_function, exponential_action
from liehom.flow.tracing.graph import Tape
from liehom.flow.tracing.loop import while_loop
from liehom.flow.tracing.sweeps import Sweeps, exponentials

RNG = np.random.default_rng(5)


def several(m: Any) -> Any:
    """A function with every kind of operation."""
    first = np.sin(m[0]) * np.exp(-m[1]) + m[2] ** 3 / (1 + m[0] ** 2)
    second = np.sqrt(1 + m[1] * m[1]) - np.arctan(m[2]) + np.tanh(m[0] - m[1]) + m[2] ** 0.3
    third = np.where(m[0] > m[1], m[0] * m[2], np.abs(m[1])) + np.log(1 + m[2]) * np.cosh(m[0])
    return np.stack([first, second, third, -first * second])


def recorded(function: Any, n: int) -> list[Any]:
    tape = Tape()
    made = function(Traced.inputs(tape, 0, n))
    return [Traced(tape, made[i]).entry for i in range(made.shape[0])]


def by_differences(function: Any, point: Any, h: float = 1e-6) -> Any:
    """The Jacobian (outputs, inputs, lanes), by the extrapolated central difference."""
    columns = []
    for j in range(len(point)):
        e = np.zeros_like(point)
        e[j] = h
        near = (function(point + e) - function(point - e)) / (2 * h)
        far = (function(point + 2 * e) - function(point - 2 * e)) / (4 * h)
        columns.append((4 * near - far) / 3)
    return np.stack(columns, axis=1)


def jacobian(function: Any, point: Any) -> tuple[Any, Any]:
    n, lanes = point.shape
    sweeps = Sweeps(recorded(function, n), dict(enumerate(point)), lanes)
    rows = []
    for i in range(len(sweeps.values)):
        found = sweeps.pulled([1.0 if k == i else 0.0 for k in range(len(sweeps.values))])
        rows.append(np.stack([found.get(j, np.zeros(lanes)) for j in range(n)]))
    return np.array(sweeps.values), np.stack(rows)


def test_values_and_derivatives_of_all_operations() -> None:
    point = RNG.uniform(0.1, 1.5, size=(3, 7))
    values, slopes = jacobian(several, point)
    assert np.abs(values - several(point)).max() < 1e-14
    assert np.abs(slopes - by_differences(several, point)).max() < 1e-8


@pytest.mark.parametrize("size", [1e-6, 0.3, 5.0])
def test_matrix_exponential(size: float) -> None:
    def moved(m: Any) -> Any:
        if isinstance(m, Traced):
            return exponential_action(m[:9].reshape(3, 3), m[9:])
        return (exponentials(np.moveaxis(m[:9], 0, -1).reshape(-1, 3, 3)) @ m[9:].T[..., None])[..., 0].T

    point = np.concatenate([size * RNG.normal(size=(9, 5)) / 3, RNG.normal(size=(3, 5))])
    values, slopes = jacobian(moved, point)
    assert np.abs(values - moved(point)).max() < 1e-13 * np.abs(values).max()
    assert np.abs(slopes - by_differences(moved, point, 1e-4)).max() < 1e-8 * np.abs(slopes).max()


@pytest.mark.parametrize("name", ["sinq", "cosq"])
def test_functions_of_the_square_of_an_angle(name: str) -> None:
    point = np.array([[-30.0, -1.01, -0.99, -1e-9, 0.0, 1e-9, 0.99, 1.01, 30.0]])

    def function(m: Any) -> Any:
        if isinstance(m, Traced):
            return entire_function(name, m)
        r = np.sqrt(m.astype(complex))
        safe = np.where(r == 0, 1, r)
        return (np.cos(r) if name == "cosq" else np.where(r == 0, 1, np.sin(safe) / safe)).real

    values, slopes = jacobian(function, point)
    assert np.abs(values / function(point) - 1).max() < 1e-13
    expected = by_differences(function, point, 1e-4)
    assert np.abs(slopes - expected).max() < 1e-10 * np.abs(expected).max()
    zero = -0.5 if name == "cosq" else -1 / 6
    assert abs(slopes[0, 0, 4] - zero) < 1e-15


def test_weights_of_lanes_are_combined() -> None:
    point = RNG.uniform(0.1, 1.5, size=(3, 4))
    sweeps = Sweeps(recorded(several, 3), dict(enumerate(point)), 4)
    weights = RNG.normal(size=(4, 4))
    found = sweeps.pulled(list(weights))
    slopes = jacobian(several, point)[1]
    assert np.abs(np.stack([found[j] for j in range(3)]) - np.einsum("il,ijl->jl", weights, slopes)).max() < 1e-12


def test_iterations_are_refused_with_the_remedy() -> None:
    tape = Tape()
    (x,) = while_loop(lambda x: ([np.cos(x)], np.any(x > 0)), [Traced.inputs(tape, 0, 1)], tape, 10)
    with pytest.raises(TraceError, match=r"with an iteration is not known: .*engine='jax'"):
        Sweeps([x[0].entry], {0: np.ones(2)}, 2)
