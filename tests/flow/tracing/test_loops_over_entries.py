"""Steps of many operations: machine code with loops over entries gives the numbers of numpy, and stays short."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.engines import jax_loops, llvm_engine
from liehom.flow.engines.traced_step import traced_step
from liehom.flow.tracing.array import Traced, contracted
from liehom.flow.tracing.graph import LongGraphError, Table, Tape, needed
from liehom.flow.tracing.machine import Kernel

pytest.importorskip("llvmlite")

K = 7
RNG = np.random.default_rng(5)
DIM = K * (K - 1) // 2
CONSTANT, LINEAR = RNG.normal(size=DIM), RNG.normal(size=(K, DIM)) / K
FORM, WEIGHTS = RNG.normal(size=(DIM, K, K)) / K**2, RNG.normal(size=(DIM, K)) / K

PSIS: dict[str, Callable[..., Any]] = {
    "matrix product": lambda m: CONSTANT + m @ LINEAR,
    "matrix times vector": lambda m: (WEIGHTS @ m[..., None])[..., 0] - CONSTANT,
    "einsum": lambda m: np.einsum("...i,aij,...j->...a", m, FORM, m) + np.einsum("...i,ai->...a", m, WEIGHTS),
    "elementary functions": lambda m: np.sin(m @ LINEAR) * np.exp(-CONSTANT * 0.1) + np.sqrt(2.0 + np.cos(m @ LINEAR)),
    "sums and quotients": lambda m: (m @ LINEAR) / (2.0 + np.sum(m * m * m, axis=-1, keepdims=True)) / 3.0,
    "sums of functions": lambda m: np.sin(m[..., None] * LINEAR).sum(axis=-2),
    "of parts": lambda m: np.concatenate([m @ LINEAR[:, :10], (m[..., ::-1] ** 2) @ LINEAR[:, 10:]], axis=-1),
    "of time": lambda m, t: CONSTANT * np.cos(t)[..., None] + m @ LINEAR,
}


def _points(count: int) -> Any:
    m = np.random.default_rng(1).normal(size=(count, K))
    return m / np.linalg.norm(m, axis=-1, keepdims=True)


@pytest.mark.parametrize("count", [1, 11])
@pytest.mark.parametrize("sizes", [{"dt": 0.05}, {"rtol": 1e-6, "atol": 1e-6}], ids=["fixed", "adapted"])
@pytest.mark.parametrize("name", PSIS)
def test_loops_give_the_numbers_of_numpy(
    name: str, sizes: dict[str, float], count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(llvm_engine, "UNROLLED_OPERATIONS", 1)
    field = lh.GeneratorField(lh.defining(lh.so(K)), PSIS[name])
    start = _points(count) if count > 1 else _points(1)[0]
    options: dict[str, Any] = {"step": lh.Taylor(6), "t_eval": [0.4, 1.0], **sizes}
    wanted = lh.integrate(field, (0.0, 1.0), start, **options)
    propagator = lh.Propagator(field, step=lh.Taylor(6), engine="llvm")
    options.pop("step")
    solution = propagator((0.0, 1.0), start, **options)
    assert np.array_equal(solution.n_steps, wanted.n_steps)
    assert abs(solution.y - wanted.y).max() < 1e-13


def test_calls_on_spheres_are_made_again_by_a_plan(monkeypatch: pytest.MonkeyPatch) -> None:
    """The check of the initial point is then as short as the point is not 0, and finite."""
    monkeypatch.setattr(llvm_engine, "UNROLLED_OPERATIONS", 1)
    propagator = lh.Propagator(lh.GeneratorField(lh.defining(lh.so(K)), PSIS["einsum"]), lh.Taylor(4), engine="llvm")
    engine: Any = propagator.engine
    first = propagator((0.0, 1.0), _points(1)[0], dt=0.1)
    assert len(engine._plans) == 1
    again = engine.again((0.0, 1.0), _points(1)[0], {"dt": 0.1})
    assert np.array_equal(again.y, first.y)
    assert all(engine.again((0.0, 1.0), x * _points(1)[0], {"dt": 0.1}) is None for x in (0.0, np.nan, np.inf))


@pytest.mark.parametrize("name", ["elementary functions", "einsum", "sums of functions"])
def test_jax_computes_with_arrays_in_place_of_loops(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("jax")
    monkeypatch.setitem(jax_loops.JaxKernel.tracing, "unrolled", 1)
    field, start = lh.GeneratorField(lh.defining(lh.so(K)), PSIS[name]), _points(3)
    options: dict[str, Any] = {"step": lh.Taylor(3), "t_eval": [0.4, 1.0], "dt": 0.05}
    wanted = lh.integrate(field, (0.0, 1.0), start, **options)
    solution = lh.integrate(field, (0.0, 1.0), start, engine="jax", **options)
    assert abs(solution.y - wanted.y).max() < 1e-13


@pytest.mark.parametrize("step", [lh.Corrected(lh.Euler(), 3), lh.RKMK("rk4"), lh.LieTaylor(3), lh.Taylor(4)], ids=repr)
def test_clocks_exponentials_and_landings_in_loops(step: lh.Step, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(llvm_engine, "UNROLLED_OPERATIONS", 1)
    rho = lh.defining(lh.so(5)) if isinstance(step, lh.Corrected) else lh.adjoint(lh.su(3))
    linear = np.random.default_rng(2).normal(size=(rho.size, rho.algebra.dimension)) / 8
    field = lh.GeneratorField(rho, lambda m: m @ linear)
    start = np.random.default_rng(3).normal(size=(3, rho.size))
    options: dict[str, Any] = {"step": step, "t_eval": [0.1, 0.2], "dt": 0.02}
    wanted = lh.integrate(field, (0.0, 0.2), start, **options)
    solution = lh.integrate(field, (0.0, 0.2), start, engine="llvm", **options)
    assert abs(solution.y - wanted.y).max() < 1e-13


def test_args_are_inputs_of_loops(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(llvm_engine, "UNROLLED_OPERATIONS", 1)
    field = lh.GeneratorField(lh.defining(lh.so(K)), lambda m, t, args: m @ args["linear"])
    propagator = lh.Propagator(field, step=lh.Taylor(5), engine="llvm")
    for factor in (1.0, 2.0):
        given: dict[str, Any] = {"args": {"linear": factor * LINEAR}, "dt": 0.1}
        wanted = lh.integrate(field, (0.0, 0.5), _points(3), step=lh.Taylor(5), **given)
        assert abs(propagator((0.0, 0.5), _points(3), **given).y - wanted.y).max() < 1e-13


def test_a_table_adds_up_uneven_rows_and_drops_zeros() -> None:
    tape = Tape(least_loop=2)
    x, y = Traced.inputs(tape, 0, 4), Traced.inputs(tape, 4, 4)
    rows = np.array([2, 0, 2, 2, 0, 1])
    left, right = np.array([0, 1, 2, 3, 0, 0]), np.array([3, 2, 1, 0, 0, 1])
    factors = np.array([2.0, -1.0, 0.5, 1.0, 4.0, 0.0])
    sums = tape.summed(3, rows, factors, (list(x.entries), left), (list(y.entries), right))
    assert sums[1] is tape.zero
    table = sums[0].args[0].value[0]
    assert table.rows == 2 and table.counts.tolist() == [2, 3]
    places, padded = table.padded()
    assert padded.tolist() == [[-1.0, 4.0, 0.0], [2.0, 0.5, 1.0]] and places[0].tolist()[0][2] == 0
    assert table == Table(2, np.repeat([0, 1], [2, 3]), table.places, table.factors)
    assert repr(table) != repr(Table(2, np.repeat([0, 1], [2, 3]), table.places, 2 * table.factors))


def test_operations_with_constants_are_simplified_in_loops_too() -> None:
    tape = Tape(least_loop=2)
    x = Traced.inputs(tape, 0, 4)
    kept = x * np.array([0.0, 1.0, 2.0, 3.0]) + np.array([0.0, 0.0, 0.0, 1.0])
    assert kept.entries[0] is tape.zero and kept.entries[1] is x.entries[1]
    assert kept.entries[2].args[0].op == "map"
    whole = contracted(tape, [x.entries, Traced(tape, np.eye(4)).entries], ["i", "ij"], "j")
    assert all(a is b for a, b in zip(whole.entries, x.entries, strict=True))


def test_a_tape_that_is_full_says_so() -> None:
    tape = Tape(most=8)
    with pytest.raises(LongGraphError):
        Traced.inputs(tape, 0, 9)


def test_a_step_that_is_just_short_enough_has_its_check_of_initial_points(monkeypatch: pytest.MonkeyPatch) -> None:
    field, start = (
        lh.GeneratorField(lh.defining(lh.so(4)), lambda m: m @ np.ones((4, 6))),
        np.array([0.6, 0.0, 0.8, 0.0]),
    )
    graph = traced_step(lh.Action(field.representation), field, lh.Taylor(3), start[None], 3, nominal=False)
    monkeypatch.setattr(llvm_engine, "UNROLLED_OPERATIONS", len(graph.point[0].tape.recorded))  # type: ignore[attr-defined]
    options: dict[str, Any] = {"step": lh.Taylor(3), "dt": 0.1}
    wanted = lh.integrate(field, (0.0, 1.0), start, **options)
    assert abs(lh.integrate(field, (0.0, 1.0), start, engine="llvm", **options).y - wanted.y).max() < 1e-14


def test_the_code_grows_with_the_arrays_and_not_with_their_products() -> None:
    sizes = []
    for k in (6, 24):
        rng, rho = np.random.default_rng(0), lh.defining(lh.so(k))
        linear = rng.normal(size=(k, rho.algebra.dimension))
        field = lh.GeneratorField(rho, lambda m, linear=linear: m @ linear)
        m = rng.normal(size=(2, k))
        graph = traced_step(lh.Action(rho), field, lh.Taylor(4), m, k - 1, nominal=False, unrolled=1)
        sizes.append((len(needed(graph.outputs)), sum(" = " in x for x in Kernel(graph, 8).text.split("\n"))))
    (few, short), (many, long) = sizes
    assert many < 20 * few  # dim g grows by 18, products in the action by 78
    assert long < 4 * short
