"""Nodes: coefficients on demand, growing series, replaced coefficients, deep and cyclic graphs."""

from math import factorial
from typing import Any

import numpy as np
import pytest

from liehom.base.errors import SeriesError, ShapeError
from liehom.flow.series import node as recurrences
from liehom.flow.series.jet import Jet
from liehom.flow.series.node import Node

ORDER = 8
# f, y(0), Taylor coefficients of the solution of y' = f(y)
EQUATIONS = {
    "exponential": (lambda y: y, 1.0, lambda k: 1 / factorial(k)),
    "geometric": (lambda y: y * y, 1.0, lambda k: 1.0),
    "tangent": (lambda y: 1 + y**2, 0.0, lambda k: np.tan(Jet.variable(0.0, ORDER)).coefficient(k)),
    "logarithm": (lambda y: np.exp(-y), 0.0, lambda k: 0.0 if k == 0 else (-1) ** (k + 1) / k),
    "sine": (lambda y: np.sqrt(1 - y * y), 0.0, lambda k: np.sin(Jet.variable(0.0, ORDER)).coefficient(k)),
    "pendulum": (
        lambda y: np.stack([y[1], -y[0]]),
        [0.0, 1.0],
        lambda k: np.stack([f(Jet.variable(0.0, ORDER)).coefficient(k) for f in (np.sin, np.cos)]),
    ),
    "root": (lambda y: 0.5 / y, 1.0, lambda k: np.sqrt(1 + Jet.variable(0.0, ORDER)).coefficient(k)),
    "power": (lambda y: y**-2 / 3, 1.0, lambda k: np.cbrt(1 + Jet.variable(0.0, ORDER)).coefficient(k)),
    "reciprocal": (lambda y: 1 / (1 + y**2), 0.0, None),
    "mixed": (lambda y: np.cos(y) * np.log(2 + y) - np.arctan(y) / np.cosh(y), 0.3, None),
}  # fmt: skip


@pytest.mark.parametrize("eager", [True, False], ids=["extended", "depending on itself"])
@pytest.mark.parametrize("name", EQUATIONS)
def test_solutions_of_differential_equations(name: str, eager: bool) -> None:
    f, start, expected = EQUATIONS[name]
    y = Jet.growing(start, ORDER)
    slope = f(y)
    if eager:
        for k in range(ORDER):
            y.extend(slope.coefficient(k) / (k + 1))
    else:
        y.node.depends(
            (slope.node, 1), rule=lambda k: None if slope.node.known[k - 1] is None else slope.node.known[k - 1] / k
        )
        y.coefficient(ORDER)
    if expected is not None:
        for k in range(ORDER + 1):
            np.testing.assert_allclose(y.coefficient(k), expected(k), rtol=1e-12, atol=1e-12)
    again = f(Jet(y.coefficients))
    for k in range(ORDER):
        np.testing.assert_allclose((k + 1) * y.coefficient(k + 1), again.coefficient(k), rtol=1e-11, atol=1e-12)


def test_a_solution_costs_quadratically_many_products() -> None:
    calls = 0

    def product(a: Any, b: Any) -> Any:
        nonlocal calls
        calls += 1
        return a * b

    y = Jet.growing(1.0, 20)
    slope = recurrences.multilinear(product, [y.node, y.node])
    y.node.depends((slope, 1), rule=lambda k: slope.known[k - 1] / k)
    np.testing.assert_allclose(y.coefficients, np.ones(21))
    assert calls <= 1 + 20 * 21 // 2


def test_growing_series_say_what_is_missing() -> None:
    y = Jet.growing(1.0, 3)
    with pytest.raises(SeriesError, match="before it is given"):
        (2 * y).coefficient(1)
    with pytest.raises(ShapeError):
        y.extend(np.ones(2))
    for _ in range(3):
        y.extend(None)
    with pytest.raises(SeriesError, match="complete"):
        y.extend(1.0)
    with pytest.raises(SeriesError, match="complete"):
        Jet([1.0, 2.0]).extend(1.0)
    for k in (0, 4, -1):
        with pytest.raises(SeriesError, match="replaced"):
            y.replace(k, 1.0)
    with pytest.raises(SeriesError, match="replaced"):
        (2 * y).replace(1, 1.0)


def test_a_structural_zero_has_the_value_zero() -> None:
    x = Jet.growing(np.full(2, 7.0), 2, zero=True)
    assert x.value.tolist() == [0.0, 0.0]
    assert np.exp(x).value.tolist() == [1.0, 1.0]
    x.extend(np.array([1.0, 2.0]))
    np.testing.assert_allclose(np.exp(x).coefficient(1), [1, 2])


def test_a_series_in_itself_through_a_structural_zero() -> None:
    """z = 1 + t z: the product needs z only up to k - 1."""
    t = Jet.from_node(Node(6, np.float64(0), [None, np.float64(1), *[None] * 5]))
    z = Jet.growing(1.0, 6)
    made = 1 + t * z
    z.node.depends((made.node, 0), rule=lambda k: made.node.known[k])
    np.testing.assert_array_equal(z.coefficients, np.ones(7))


FUNCTIONS = {
    "sin": lambda x: np.sin(x) + x, "cos": lambda x: np.cos(x) * x, "quotient": lambda x: x / (1 + x * x),
    "power": lambda x: (2 + x) ** 1.5, "tan": lambda x: np.tan(x) - np.arctan(x),
    "shared": lambda x: (lambda y: y * y + np.exp(y))(np.sin(x) * x),
    "stack": lambda x: np.stack([x, np.cosh(x), x * 0 + 1]),
}  # fmt: skip


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("k", [1, 2, 4])
def test_replaced_coefficients(name: str, k: int) -> None:
    rng = np.random.default_rng(k)
    terms = rng.normal(size=7)
    x = Jet.growing(0.4, 6)
    y = FUNCTIONS[name](x)
    for i, term in enumerate(terms[1:], start=1):
        x.extend(term if i != k else rng.normal())
        y.coefficient(i)
    wrong = y.coefficients
    x.replace(k, terms[k], y)
    expected = FUNCTIONS[name](Jet(np.array([0.4, *terms[1:]]))).coefficients
    assert np.abs(wrong - expected).max() > 1e-6
    np.testing.assert_allclose(y.coefficients, expected, rtol=1e-12, atol=1e-12)


def test_replacing_in_a_solution_that_depends_on_itself() -> None:
    """y' = y + x(t), where x is replaced: only later coefficients of y change."""
    x, y = Jet.growing(0.0, 5), Jet.growing(1.0, 5)
    slope = y + x
    y.node.depends((slope.node, 1), rule=lambda k: slope.node.known[k - 1] / k)
    for _ in range(5):
        x.extend(None)
    before = y.coefficients
    x.replace(2, 6.0, y)
    assert len(y.node.known) == 3
    np.testing.assert_allclose(y.coefficients - before, [0, 0, 0, 2, 0.5, 0.1])


def test_replacing_leaves_other_results_alone() -> None:
    x = Jet.growing(1.0, 2)
    x.extend(1.0)
    y, z = 2 * x, 3 * x
    assert y.coefficient(1) == 2 and z.coefficient(1) == 3
    x.replace(1, 5.0, y)
    assert y.coefficient(1) == 10 and z.coefficient(1) == 3


@pytest.mark.parametrize(
    "step", [lambda x, m: x + m, lambda x, m: 0.5 * x * m, lambda x, m: np.sin(x), lambda x, m: x[::-1] + 0 * m]
)
def test_deep_graphs(step: Any) -> None:
    m = Jet.growing([0.1, 0.2], 2)
    x = m
    for _ in range(5000):
        x = step(x, m)
    m.extend(np.array([1.0, 2.0]))
    m.extend(np.array([0.5, -1.0]))
    assert np.isfinite(x.coefficient(2)).all()
    m.replace(1, np.zeros(2), x)
    assert np.isfinite(x.coefficient(2)).all()
    del x
