"""Coarse logarithms and powers of 2: how coarse they are, and that all kinds of numbers give the same."""

import ctypes
from typing import Any

import numpy as np
import pytest

from liehom.flow.engines.jax_loops import enabled_x64
from liehom.flow.series.arrays import coarse
from liehom.flow.tracing.graph import COARSE, FOLDED, MIDDLE
from liehom.flow.tracing.llvm_text import Writer
from liehom.flow.tracing.machine import engine_of

RNG = np.random.default_rng(3)
POSITIVE = np.concatenate([RNG.lognormal(0, 50, 500), [1.0, 2.0, 1e-300, 1e300]])
EXPONENTS = np.concatenate([RNG.uniform(-900, 900, 500), [0.0, 1.0, -0.5, 998.0]])
CASES = [("coarse_log2", POSITIVE), ("coarse_exp2", EXPONENTS)]


def test_how_coarse_they_are() -> None:
    assert np.abs(COARSE["coarse_log2"](POSITIVE) - np.log2(POSITIVE)).max() < MIDDLE + 1e-4
    assert np.abs(COARSE["coarse_exp2"](EXPONENTS) / np.exp2(EXPONENTS) - 1).max() < 4e-3
    assert (np.diff(COARSE["coarse_exp2"](np.linspace(-3, 3, 1000))) > 0).all()


def test_zero_infinity_and_nan() -> None:
    assert COARSE["coarse_log2"](np.array(0.0)) < -1022 and np.isnan(COARSE["coarse_log2"](np.array(np.nan)))
    assert np.isnan(COARSE["coarse_exp2"](np.array(np.nan)))
    assert COARSE["coarse_exp2"](np.array([-np.inf, np.inf])).tolist() == pytest.approx([2.0**-1000, 2.0**1000])


@pytest.mark.parametrize(("name", "values"), CASES)
def test_floats_and_jax_give_the_numbers_of_numpy(name: str, values: Any) -> None:
    expected = COARSE[name](values)
    assert [FOLDED[name](float(x)) for x in values] == expected.tolist()
    assert FOLDED["coarse_log2"](0.0) == COARSE["coarse_log2"](np.array(0.0))
    jax = pytest.importorskip("jax")
    with enabled_x64():
        assert np.array_equal(coarse(name, jax.numpy.asarray(values)), expected)


@pytest.mark.parametrize("width", [1, 8])
@pytest.mark.parametrize(("name", "values"), CASES)
def test_machine_code_gives_them_too(name: str, values: Any, width: int) -> None:
    values = values.copy()
    pytest.importorskip("llvmlite")
    w = Writer(width)
    x = w.emit(f"load {w.vector}, ptr %from, align 8")
    result = w.coarse_log2(x) if name == "coarse_log2" else w.coarse_exp2(x)
    body = "\n".join([*w.lines, f"  store {w.vector} {result}, ptr %to, align 8", "  ret void"])
    engine, _ = engine_of("\n".join([*w.declared.values(), f"define void @run(ptr %from, ptr %to) {{\n{body}\n}}"]))
    run = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)(engine.get_function_address("run"))
    found = np.empty(len(values) // width * width)
    for place in range(0, len(found), width):
        run(values.ctypes.data + 8 * place, found.ctypes.data + 8 * place)
    assert np.allclose(found, COARSE[name](values)[: len(found)], rtol=1e-15, atol=0)  # contracted products
    values[:width] = np.nan
    run(values.ctypes.data, found.ctypes.data)
    assert name == "coarse_log2" or (found[:width] < 1e-300).all()  # sizes that are too small
