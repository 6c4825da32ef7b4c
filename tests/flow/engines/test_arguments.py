"""What a corrected step may use of the orbits of a call."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.engines.arguments import with_tight_frame
from liehom.flow.propagation.propagator import Propagator

STARTS = np.array([[1.0, 0.0, 0.0], [0.0, 0.6, 0.8]])


def action() -> Any:
    return Propagator(lh.GeneratorField(lh.adjoint(lh.so(3)), [0, 0, 1]))._action


def test_orbits_of_one_dimension_share_a_tight_frame() -> None:
    plain, step = action(), lh.Corrected(lh.Euler(), 3)
    assert with_tight_frame(plain, step, STARTS, np.array([2, 2])) is not plain
    assert with_tight_frame(plain, step, STARTS, 2) is not plain


@pytest.mark.parametrize(
    ("step", "start", "dimension"),
    [
        (lh.Corrected(lh.Euler(), 3), STARTS, np.array([0, 2])),
        (lh.Corrected(lh.Euler(), 3), STARTS.astype(np.longdouble), 2),
        (lh.Euler(), STARTS, 2),
    ],
)
def test_other_calls_have_none(step: Any, start: Any, dimension: Any) -> None:
    plain = action()
    assert with_tight_frame(plain, step, start, dimension) is plain
