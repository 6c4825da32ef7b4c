"""The benchmark of landings once, tiny: both ways are compared, and the points are on their orbits."""

import pytest

from liehom.flow.methods import taylor
from tests.benchmarks.landings import NAMES, by_exponentials, field_on, lines, orbit


def test_the_table_has_a_row_for_each_orbit() -> None:
    pytest.importorskip("llvmlite")
    *_, row, _ = lines(4, ("SE(3)*",), work=2000, steps=20)
    name, *cells = [cell.strip() for cell in row.strip("|").split("|")]
    assert name == "SE(3)*"
    assert len(cells) == 5
    assert all(float(cell) > 0 for cell in cells[:4])
    assert float(cells[4]) < 1e-14


@pytest.mark.parametrize("name", NAMES)
def test_trajectories_stay_in_sight_and_have_one_landing(name: str) -> None:
    space, field = orbit(name), field_on(name)
    assert space.starts.shape[1] == field.representation.size
    landing = taylor.invariant_landing(space.representation, space.dimension, space.starts)
    assert landing is not None
    with by_exponentials():
        assert taylor.invariant_landing(space.representation, space.dimension, space.starts) is None
