"""Points of an exact ensemble are read one by one."""

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError
from liehom.flow.steps.step import read_point


def test_each_point_of_an_exact_ensemble_has_its_orbit_dimension() -> None:
    rho = lh.defining(lh.sl(2)).direct_sum(lh.defining(lh.sl(2)))
    points = np.array([[[1, 0, 0, 1], [1, 2, 2, 4]]], dtype=object)
    read, dimensions = read_point(rho, points)
    assert read.shape == points.shape and dimensions.tolist() == [[3, 2]]
    with pytest.raises(InputError, match="fixed"):
        read_point(rho, np.array([[1, 0, 0, 1], [0, 0, 0, 0]], dtype=object))
