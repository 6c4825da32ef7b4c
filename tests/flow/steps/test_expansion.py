"""Coefficients of the flow that count as zero, and those that a corrected step does not match."""

import numpy as np
import pytest

import liehom as lh
from liehom.flow.steps.expansion import at_rest, flow_series, leading_order
from liehom.flow.steps.step import Generator

SO2 = lh.defining(lh.so(2))


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_the_leading_order_is_looked_for_up_to_the_order_given(order: int) -> None:
    """psi = t^(l-1) moves the point from order l on."""
    for leading in range(1, 6):
        flow = flow_series(lh.GeneratorField(SO2, [f"t**{leading - 1}"]), np.array([1.0, 0.0]), 6)
        assert int(leading_order(flow, order)) == (leading if leading <= order else 0)


@pytest.mark.parametrize("units", [0.25, 32, 256])
@pytest.mark.parametrize("order", [1, 2])
def test_a_point_is_at_rest_if_psi_is_the_round_off_of_the_point(units: float, order: int) -> None:
    """psi = m1 is as large as the last coordinate, which is round-off of the first one."""
    flow = flow_series(lh.GeneratorField(SO2, ["m1"]), np.array([1.0, units * np.finfo(float).eps]), order)
    assert bool(at_rest(lh.Action(SO2), flow)) == (units < 64)


def test_a_corrected_step_has_one_defect_for_each_order_above_that_of_its_base() -> None:
    """The step size is chosen by them, so that none may be counted twice."""
    field = lh.GeneratorField(lh.defining(lh.so(3)), lambda m: m * [1.0, 2.0, 3.0])
    psi, m = Generator(field, 2), np.array([0.6, 0.0, 0.8])
    local = lh.Corrected(lh.Euler(), 4).at(lh.Action(field.representation), psi, m, np.zeros(1), error_terms=2)
    assert [k for k, _ in local.defects] == [2, 3, 4, 5, 6]
    assert all(float(x) < 1e-12 for k, x in local.defects if k <= 4)
