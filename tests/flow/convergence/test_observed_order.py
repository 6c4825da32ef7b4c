"""The measured orders: right where a method is, lower where something is broken on purpose, none at round-off."""

import csv
import dataclasses
import io
import json
import math
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

import liehom as lh
from liehom.base.errors import ConvergenceError, InputError, ShapeError
from liehom.flow.convergence.orders import ConvergenceTable, observed_order
from liehom.flow.convergence.reference import Reference
from liehom.flow.steps.step import LocalStep
from tests.flow.propagation import spaces

WINDOW = 0.15
SIZES = (0.1, 0.05, 0.025, 0.0125)
START = np.array([0.6, 0.0, 0.8])


def rigid_body() -> lh.GeneratorField:
    return lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / [1.0, 2.0, 3.0])


@cache
def problem(name: str = "S^2", timed: bool = False) -> tuple[lh.GeneratorField, Any, Reference]:
    """Eight random quadratic fields, each with its start, and their solution."""
    space = spaces.make(name)
    psi = spaces.quadratic(space, spaces.seeded(f"fields on {name}"), timed=timed)
    field = lh.GeneratorField(space.representation, psi)
    starts = space.starts.astype(np.longdouble)
    return field, starts, Reference(field, starts)


def measured(step: lh.Step, sizes: Any = SIZES, *, timed: bool = False, **options: Any) -> ConvergenceTable:
    field, starts, reference = problem(timed=timed)
    return observed_order(field, starts, step, sizes, reference=reference, **options)


class Broken(lh.Step):
    """A corrected step whose isotropy part is multiplied by a wrong factor, or whose clock is."""

    def __init__(self, order: int, factor: float, clock: float = 1.0) -> None:
        self.right = lh.Corrected(lh.Euler(), order)
        self.factor, self.clock = factor, clock

    @property
    def order(self) -> int:
        return self.right.order

    def at(self, action: Any, psi: Any, m: Any, t: Any, *, error_terms: int = 0) -> LocalStep:
        return BrokenLocal(self, self.right.at(action, psi, m, t))


class BrokenLocal(LocalStep):
    def __init__(self, step: Broken, local: Any) -> None:
        clock = tuple((k, step.clock * c) for k, c in local.clock)
        super().__init__(local.action, local.m, clock=clock)
        self.step, self.local = step, local

    def factors(self, h: Any) -> tuple[Any, ...]:
        return (self.local.base.factors(h)[0] + self.step.factor * self.local.correction.generator(h),)


# -- orders that are right -------------------------------------------------------------------------------
def test_plain_euler_has_order_one() -> None:
    assert measured(lh.Euler()).orders == pytest.approx((1, 1), abs=WINDOW)


@pytest.mark.parametrize("order", [2, 3, 4, 5, 6])
def test_corrected_euler_has_its_order_on_orbits_and_trajectories(order: int) -> None:
    table = measured(lh.Corrected(lh.Euler(), order=order))
    assert table.orders == pytest.approx((order, order), abs=WINDOW)
    assert table.order == order and table.trajectories == 8
    assert all(o <= t for o, t in zip(table.orbit_errors, table.trajectory_errors, strict=True))


@pytest.mark.parametrize("order", [2, 4])
def test_under_the_nominal_clock_only_orbits_have_the_order(order: int) -> None:
    table = measured(lh.Corrected(lh.Euler(), order=order), clock="nominal")
    assert table.orders == pytest.approx((order, 1), abs=WINDOW)


def test_compiled_steps_have_the_same_errors() -> None:
    sizes, start = [0.2, 0.1, 0.05], [0.6, 0.0, 0.8]
    plain, made = (
        observed_order(rigid_body(), start, lh.Corrected(lh.Euler(), 3), sizes, engine=c) for c in ("numpy", "llvm")
    )
    np.testing.assert_allclose(made.orbit_errors, plain.orbit_errors, rtol=1e-4)
    np.testing.assert_allclose(made.trajectory_errors, plain.trajectory_errors, rtol=1e-4)


@pytest.mark.parametrize("step", [lh.Heun(), lh.LieTaylor(3), lh.RKMK("rk4")], ids=repr)
def test_other_steps(step: lh.Step) -> None:
    # random phases may make an orbit error small by chance, but not its order low
    assert measured(step).orders == pytest.approx((step.order, step.order), abs=2 * WINDOW)


def test_time_dependent_fields() -> None:
    step = lh.Corrected(lh.Euler(), order=4)
    assert measured(step, timed=True).orders == pytest.approx((4, 4), abs=WINDOW)
    table = measured(step, timed=True, clock="nominal")
    assert math.isnan(table.orders[0]) and table.orders[1] == pytest.approx(1, abs=WINDOW)
    assert "no orbit errors" in str(table)


def test_backwards_in_time() -> None:
    table = measured(lh.Corrected(lh.Euler(), order=3), t_span=(0, -1))
    assert table.orders == pytest.approx((3, 3), abs=WINDOW)
    assert table.t_span == (0.0, -1.0)


def test_an_orbit_that_is_not_full_keeps_order_one() -> None:
    field, starts, reference = problem("Sym(3) at (1,2,3)")
    table = observed_order(field, starts.astype(float), lh.Corrected(lh.Euler(), order=3), SIZES, reference=reference)
    assert table.orders == pytest.approx((1, 1), abs=WINDOW)


# -- what is broken on purpose ---------------------------------------------------------------------------
@pytest.mark.parametrize("factor", [-1.0, 0.0, 0.5, 2.0])
@pytest.mark.parametrize("order", [2, 4])
def test_a_wrong_factor_of_the_correction_is_seen(order: int, factor: float) -> None:
    """With 1/2 missing or the sign wrong, the orbit has order 1 again."""
    assert measured(Broken(order, factor)).orders == pytest.approx((1, 1), abs=WINDOW)


def test_the_right_factor_is_seen_too() -> None:
    assert measured(Broken(4, 1.0)).orders == pytest.approx((4, 4), abs=WINDOW)


@pytest.mark.parametrize("clock", [-1.0, 0.0, 0.99])
def test_a_wrong_clock_is_seen_in_trajectories_and_not_in_orbits(clock: float) -> None:
    assert measured(Broken(4, 1.0, clock)).orders == pytest.approx((4, 1), abs=WINDOW)


# -- round-off -------------------------------------------------------------------------------------------
def test_extended_precision_shows_errors_below_those_of_floats() -> None:
    field, step = rigid_body(), lh.Corrected(lh.Euler(), order=8)
    table = observed_order(field, START.astype(np.longdouble), step, [0.4, 0.2, 0.1])
    assert table.precision == "longdouble" and ", longdouble" in str(table)
    assert table.trajectory_errors[-1] < 1e-15
    assert table.orders[1] == pytest.approx(8, abs=0.3)
    plain = observed_order(field, START, step, [0.4, 0.2, 0.1])
    assert plain.precision == "float64"
    assert math.isnan(plain.trajectory_slopes[-1])
    assert plain.orders[1] == plain.trajectory_slopes[1]
    assert plain.floors[-1] > 10 * np.finfo(float).eps


def test_errors_at_round_off_have_no_order() -> None:
    """A constant generator is integrated exactly: all that is left is round-off, marked as such."""
    field = lh.GeneratorField(lh.defining(lh.so(3)), [1, 2, 3])
    table = observed_order(field, START, lh.Euler(), [0.1, 0.05, 0.025])
    assert all(map(math.isnan, (*table.orders, *table.orbit_slopes, *table.trajectory_slopes)))
    assert str(table).count("*") == 7
    assert "round-off" in str(table)


def test_a_rough_reference_is_seen() -> None:
    field = rigid_body()
    rough = Reference(field, START, order=6, tolerance=1e-5)
    step = lh.Corrected(lh.Euler(), order=4)
    table = observed_order(field, START, step, [0.1, 0.05, 0.025], reference=rough)
    assert table.reference_accuracy > 1e-9
    assert math.isnan(table.orders[1])
    assert "*" in str(table)


def test_the_reference_of_floats_is_extended() -> None:
    table = observed_order(rigid_body(), START, lh.Euler(), [0.1, 0.05])
    assert table.reference_accuracy < 20 * np.finfo(np.longdouble).eps


# -- the table -------------------------------------------------------------------------------------------
def table_of(dts: Any, orbit: Any, trajectory: Any, floor: float = 1e-14, **changes: Any) -> ConvergenceTable:
    count = len(dts)
    made = ConvergenceTable(
        "Method", "exp", "corrected", 2, (0.0, 1.0), 1, "float64", tuple(dts), tuple(orbit), tuple(trajectory),
        (floor,) * count, floor / 10, ("",) * count,
    )  # fmt: skip
    return dataclasses.replace(made, **changes)


@given(st.floats(0.5, 8), st.floats(0.5, 8), st.floats(0.3, 0.9), st.integers(2, 6))
def test_slopes_of_pure_powers(p: float, q: float, ratio: float, count: int) -> None:
    dts = [ratio**i for i in range(count)]
    table = table_of(dts, [3 * h**p for h in dts], [h**q for h in dts], floor=1e-30)
    assert table.orders == pytest.approx((p, q), rel=1e-9)
    assert np.allclose(table.orbit_slopes[1:], p) and math.isnan(table.orbit_slopes[0])


def test_a_slope_needs_both_errors_above_the_floor() -> None:
    table = table_of([0.4, 0.2, 0.1], [1e-8, 1e-12, 1e-15], [1e-8, 2e-15, 1e-12])
    assert table.orders[0] == pytest.approx(math.log2(1e4))
    assert all(map(math.isnan, table.trajectory_slopes))
    lines = str(table).splitlines()
    assert lines[4].split() == ["0.1", "1.00e-15", "*", "1.00e-12"]
    assert lines[-1].startswith("* within a factor 10")


def test_zero_errors_are_no_order() -> None:
    assert all(map(math.isnan, table_of([0.2, 0.1], [0.0, 0.0], [0.0, 0.0], floor=0.0).orders))


def test_the_columns_are_aligned() -> None:
    table = measured(lh.Corrected(lh.Euler(), order=4))
    head, *rows = str(table).splitlines()[1:6]
    ends = [head.index(name) + len(name) for name in ("orbit error", "trajectory error")]
    for row in (line.ljust(len(head)) for line in rows):
        assert all(row[end - 1].isdigit() and row[end] == " " for end in ends)
    assert repr(table) == str(table)


def test_as_csv_and_markdown() -> None:
    table = table_of([0.2, 0.1], [4e-3, 1e-3], [8e-3, math.nan], messages=("", "no luck"))
    first, second = csv.DictReader(io.StringIO(table.to_csv()))
    assert float(second["orbit_slope"]) == 2.0 and first["orbit_slope"] == ""
    assert second["trajectory_error"] == ""
    lines = table.to_markdown().splitlines()
    assert [line.count("|") for line in lines[:4]] == [6] * 4
    assert lines[3] == "| 0.1 | 1.00e-03 | 2.00 |  |  |"
    assert "dt = 0.1 failed: no luck" in lines[-1]
    assert table.rows[1].orbit_slope == 2.0


def test_the_fields_are_plain() -> None:
    table = observed_order(rigid_body(), START, lh.Euler(), [0.1, 0.05])
    data = json.loads(json.dumps(dataclasses.asdict(table)))
    assert data["dts"] == [0.1, 0.05] and len(data["orbit_slopes"]) == 2
    assert table.step == "Euler()" and "corrected" in table.clock


# -- what is refused, and what fails ---------------------------------------------------------------------
def test_step_sizes_are_sorted() -> None:
    assert observed_order(rigid_body(), START, lh.Euler(), [0.05, 0.1, 0.1]).dts == (0.1, 0.05)


@pytest.mark.parametrize("dts", [[0.1], [], [0.1, 0.1], [0.1, -0.1], [0.1, math.nan], [0.1, math.inf], "ab", 0.1, None])
def test_wrong_step_sizes(dts: Any) -> None:
    with pytest.raises(InputError, match="dts"):
        observed_order(rigid_body(), START, lh.Euler(), dts)


@pytest.mark.parametrize("t_span", [(0, 0.05), (1, 1), (0,), "ab", (0, math.nan), (0, math.inf), 3])
def test_wrong_spans(t_span: Any) -> None:
    with pytest.raises(InputError, match="t_span"):
        observed_order(rigid_body(), START, lh.Euler(), [0.1, 0.05], t_span=t_span)


def test_other_wrong_arguments() -> None:
    field = rigid_body()
    with pytest.raises(ShapeError):
        observed_order(field, [1.0, 0.0], lh.Euler(), [0.1, 0.05])
    with pytest.raises(InputError, match="clock"):
        observed_order(field, START, lh.Euler(), [0.1, 0.05], clock="cuckoo")
    for other in (Reference(field, -START), Reference(field, START, 0.5)):
        with pytest.raises(InputError, match="another"):
            observed_order(field, START, lh.Euler(), [0.1, 0.05], reference=other)
    with pytest.raises(InputError, match="Reference"):
        observed_order(field, START, lh.Euler(), [0.1, 0.05], reference=lambda t: START)  # type: ignore[arg-type]


def blows_up() -> lh.GeneratorField:
    return lh.GeneratorField(lh.defining(lh.gl(1)), ["m0"])


def test_a_run_that_fails_is_a_row_that_says_so() -> None:
    """Large steps of backward Euler for m' = m^2 have no solution."""
    table = observed_order(blows_up(), [1.0], lh.BackwardEuler(), [0.5, 0.01, 0.005], t_span=(0, 0.5))
    assert math.isnan(table.trajectory_errors[0]) and table.messages[0]
    assert "dt = 0.5 failed: " in str(table)
    assert table.orders[1] == pytest.approx(1, abs=WINDOW)


def test_no_run_comes_through() -> None:
    with pytest.raises(ConvergenceError, match=r"came through to t = 0.9; end t_span before"):
        observed_order(blows_up(), [1.0], lh.BackwardEuler(), [0.5, 0.25], t_span=(0, 0.9))


def test_no_solution_until_the_end() -> None:
    with pytest.raises(ConvergenceError, match="cannot be continued"):
        observed_order(blows_up(), [1.0], lh.Euler(), [0.5, 0.25], t_span=(0, 2))


BODY = """Heun() with exp (Rodrigues), clock corrected, t = 0 to 1
    dt  orbit error  order  trajectory error  order
  0.25     1.54e-05                 2.41e-04
 0.125     1.93e-06   3.00          5.96e-05   2.02
0.0625     2.42e-07   3.00          1.48e-05   2.01
reference accurate to 1e-19"""


def test_the_text_of_a_table() -> None:
    field = lh.hamiltonian_field(lh.so(3), "m0**2/4 + m1**2/6 + m2**2/8", sign=-1)
    table = lh.observed_order(field, [0.48, 0.6, 0.64], "heun", [0.25, 0.125, 0.0625])
    assert str(table) == repr(table) == BODY
