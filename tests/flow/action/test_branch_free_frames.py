"""Tight frames: the constant of the isotropy is a number of an orbit, so each orbit is tested."""

from fractions import Fraction
from itertools import permutations
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.action import space
from liehom.flow.action.space import tight_frame


def two_spheres() -> lh.Representation:
    """so(4) on R^4 + R^4, where the second of its ideals su(2) acts trivially on the second R^4."""
    so4 = lh.so(4)
    whole = np.array([a.to_numpy() for a in lh.defining(so4).matrices])
    sign = np.zeros((4,) * 4)
    for p in permutations(range(4)):
        sign[p] = np.linalg.det(np.eye(4)[list(p)])
    half = (2 * whole + np.einsum("abcd,icd->iab", sign, whole)) / 4  # the self-dual part
    both: Any = np.zeros((6, 8, 8))
    both[:, :4, :4], both[:, 4:, 4:] = whole, half
    return lh.Representation(so4, [[[str(Fraction(x)) for x in row] for row in (4 * a).round() / 4] for a in both])


def points_on_two_spheres(count: int) -> Any:
    """`count` points of the first S^3 and one of the second."""
    x = np.random.default_rng(3).normal(size=(count + 1, 4))
    x /= np.linalg.norm(x, axis=-1, keepdims=True)
    m = np.zeros((count + 1, 8))
    m[:-1, :4], m[-1, 4:] = x[:-1], x[-1]
    return m


@pytest.mark.parametrize("count", [1, 60, 5000])
def test_one_orbit_without_the_isotropy_constant_of_the_others_is_noticed_among_any_number(count: int) -> None:
    action, m = lh.Action(two_spheres()), points_on_two_spheres(count)
    assert tight_frame(action, m[:-1], 3) is not None
    assert tight_frame(action, m[-1:], 3) is None
    assert tight_frame(action, m, 3) is None and tight_frame(action, m[::-1], 3) is None


@pytest.mark.parametrize("size", [3, 5])
def test_points_drawn_from_the_same_seed_do_not_spoil_the_test(size: int) -> None:
    action = lh.Action(lh.defining(lh.so(size)))
    for seed in range(3):
        found = tight_frame(action, np.random.default_rng(seed).normal(size=(40, size)), size - 1, seed)
        assert found is not None and abs(found.isotropy - 0.5) < 1e-15


def test_blocks_of_points_give_the_frame_of_all_of_them(monkeypatch: pytest.MonkeyPatch) -> None:
    action = lh.Action(lh.defining(lh.so(4)))
    points = np.random.default_rng(1).normal(size=(23, 4))
    whole: Any = tight_frame(action, points, 3)
    monkeypatch.setattr(space, "POINTS_AT_ONCE", 5)
    parts: Any = tight_frame(action, points, 3)
    assert whole.isotropy == parts.isotropy == 0.5 and whole.symmetric == parts.symmetric
    np.testing.assert_array_equal(whole.trace, parts.trace)


def test_in_scrambled_coordinates_points_are_moved_along_their_orbits() -> None:
    """No matrix is skew-symmetric there, and singular values that agree at one point differ at others."""
    rho = lh.defining(lh.so(3))
    change = np.array([[1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    matrices = [(np.linalg.inv(change) @ a.to_numpy() @ change).round().astype(int).tolist() for a in rho.matrices]
    action = lh.Action(lh.Representation(rho.algebra, matrices))
    assert tight_frame(action, np.array([[0.0, 0.0, 1.0]]), 2) is None
