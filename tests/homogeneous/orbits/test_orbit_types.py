"""Orbit types of a list of points."""

from __future__ import annotations

import liehom as lh
from liehom.representations import symmetric_to_vector


def test_symmetric_matrices() -> None:
    """Spectra of Sym(3): scalar, two equal, three different eigenvalues."""
    diagonals = [[1, 1, 1], [1, 1, 2], [0, 5, 5], [1, 2, 3], [0, 0, 0]]
    points = [symmetric_to_vector([[d[i] if i == j else 0 for j in range(3)] for i in range(3)]) for d in diagonals]
    types = lh.orbit_types(lh.sym_conjugation(3), points)
    assert [(t.orbit_dimension, t.isotropy_dimension, t.points) for t in types] == [
        (3, 0, (3,)),
        (2, 1, (1, 2)),
        (0, 3, (0, 4)),
    ]
    assert types[2].killing == (0, 3, 0)


def test_isotropy_of_equal_dimension_is_told_apart() -> None:
    """On Minkowski space time-like, space-like and light-like points have so(3), so(2,1) and e(2)."""
    types = lh.orbit_types(lh.defining("so(3,1)"), [[0, 0, 0, 1], [1, 0, 0, 0], [1, 0, 0, 1], [0, 1, 0, 2]])
    assert {t.points: (t.killing, t.derived) for t in types} == {
        (0, 3): ((0, 3, 0), (3,)),
        (1,): ((2, 1, 0), (3,)),
        (2,): ((0, 1, 2), (3, 2, 0)),
    }


def test_no_points() -> None:
    assert lh.orbit_types(lh.defining("so(3)"), []) == []
