"""Simplified expressions have the values of the plain ones: every operation on pairs of small expressions."""

from itertools import product
from typing import Any

import numpy as np
import pytest

from liehom.flow.tracing.graph import Expr, Tape, needed

POINTS = np.array(list(product((-2.0, -0.5, 0.0, 1.0, 3.0), repeat=2))).T
SQUARE = {"add": np.add, "sub": np.subtract, "mul": np.multiply, "div": np.divide, "pow": np.power}
COMPARED = {"lt": np.less, "le": np.less_equal, "eq": np.equal, "ne": np.not_equal}
UNARY = {"neg": np.negative, "sqrt": np.sqrt, "abs": np.abs, "exp": np.exp, "not": np.logical_not}


def value(x: Expr) -> Any:
    """The values of an expression at the points."""
    if x.constant:
        return np.full(POINTS.shape[1], x.value)
    if x.op == "input":
        return POINTS[int(x.value)]  # type: ignore[arg-type]
    args = [value(arg) for arg in x.args]
    if x.op == "select":
        return np.where(*args)
    return {**SQUARE, **COMPARED, **UNARY, "and": np.logical_and}[x.op](*args)


def small(tape: Tape) -> list[Expr]:
    """Numbers of all shapes that are simplified: constants, signs, multiples, sums, squares, roots."""
    constants = [tape.constant(c) for c in (0.0, 1.0, -1.0, 2.5, 2.0, 3.0, -3.0)][:4]  # before the inputs, and so first
    x, y = tape.input(0), tape.input(1)
    sums = [x + y, x - y, 2.0 * x, -3.0 * y, 2.0 * x + y, x - 2.0 * y, x * y, -(x * y), x / y]
    squares = [tape.call("sqrt", x * x + y * y), tape.call("abs", x), tape.call("sqrt", x), 2.0 * tape.call("abs", y)]
    return [*constants, x, y, -x, *(tape.of(s) for s in sums), *squares]


@pytest.mark.parametrize("op", ["add", "sub", "mul", "div", *COMPARED, "largest", "least"])
@np.errstate(all="ignore")
def test_two_numbers(op: str) -> None:
    tape = Tape()
    plain = {**SQUARE, **COMPARED, "largest": np.maximum, "least": np.minimum}[op]
    for a, b in product(small(tape), repeat=2):
        if op in COMPARED:
            made = tape.compare(op, a, b)
        else:
            made = tape.largest(a, b, least=op == "least") if op[0] == "l" else getattr(tape, op)(a, b)
        wanted, values = plain(value(a), value(b)), value(made)
        good = np.isfinite(value(a)) & np.isfinite(value(b)) & np.isfinite(wanted)
        np.testing.assert_allclose(values[good], wanted[good], rtol=1e-13, atol=1e-13, err_msg=f"{op} {a} {b}")


@np.errstate(all="ignore")
def test_roots_and_signs_of_one_number() -> None:
    tape = Tape()
    for a in small(tape):
        assert np.allclose(value(tape.neg(a)), -value(a), equal_nan=True)
        assert np.allclose(value(tape.call("abs", a)), abs(value(a)), equal_nan=True)
        for p in (0, 1, 2, 3, 5, 0.5, 1.5, -1, -2, -0.5, 32):
            wanted, made = value(a) ** p, value(tape.power(a, tape.constant(p)))
            good = np.isfinite(wanted) & np.isfinite(value(a)) & (value(a) != 0)
            assert np.allclose(made[good], wanted[good], rtol=1e-12)


@np.errstate(all="ignore")
def test_truth_values() -> None:
    tape = Tape()
    x, y = tape.input(0), tape.input(1)
    truths = [
        tape.true,
        tape.false,
        tape.compare("lt", x, y),
        tape.compare("eq", x, y),
        tape.negated(tape.compare("le", x, y)),
    ]
    for a, b in product(truths, repeat=2):
        assert np.array_equal(value(tape.both(a, b)), value(a) & value(b))
        assert np.array_equal(value(tape.either(a, b)), value(a) | value(b))
        assert np.array_equal(value(tape.negated(a)), ~value(a).astype(bool))
        for one, other in ((x, y), (x, x), (a, b)):
            assert np.array_equal(value(tape.select(a, one, other)), np.where(value(a), value(one), value(other)))


def operations(x: Expr) -> list[str]:
    return sorted(y.op for y in needed([x]) if y.op not in ("input", "const", "constant"))


def test_simplifications_leave_few_operations() -> None:
    tape = Tape()
    for c in (2.0, 3.0):
        tape.constant(c)
    x, y = tape.input(0), tape.input(1)
    root, other = tape.call("sqrt", x * x + y * y), tape.call("sqrt", y * y)
    lengths = {
        "x + y - y": ((x + y) - y, 0), "x - x": (x - x, 0), "x / x": (x / x, 0), "-(-x)": (tape.neg(-x), 0),
        "0 * x": (0.0 * x, 0), "1 * x": (1.0 * x, 0), "x + 0": (x + 0.0, 0), "0 - x": (0.0 - x, 1), "x + x": (x + x, 1),
        "-(x - y)": (-(x - y), 1), "x + -y": (x + -y, 1), "2 (3 x)": (2.0 * (3.0 * x), 1), "(-x)(-y)": (-x * -y, 1),
        "(2 x)(3 y)": ((2.0 * x) * (3.0 * y), 2), "2 x + y - 2 x": (2.0 * x + y - 2.0 * x, 0), "x / 2": (x / 2.0, 1),
        "x / -y": (x / -y, 3),
        "x**8": (tape.power(x, tape.constant(8)), 3), "x**-1": (tape.power(x, tape.constant(-1)), 1),
        "sqrt < sqrt": (tape.compare("lt", root, other), 4),
        "sqrt < 2": (tape.compare("lt", root, tape.constant(2.0)), 4),
        "sqrt < -2": (tape.compare("lt", root, tape.constant(-2.0)), 5),
        "|x| < |y|": (tape.compare("lt", tape.call("abs", x), tape.call("abs", y)), 3),
        "x < x": (tape.compare("lt", x, x), 0),
    }  # fmt: skip
    found = {name: len(operations(tape.of(made))) for name, (made, _) in lengths.items()}
    assert found == {name: count for name, (_, count) in lengths.items()}
