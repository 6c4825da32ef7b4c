"""Submodules modulo large primes: invariant, isotropic, and found."""

import numpy as np
import pytest

from liehom.exact.scalars.modular import isotropic_submodules


@pytest.mark.parametrize("p", [1009, 10**9 + 7, 15816027105855133])
@pytest.mark.parametrize("seed", [0, 1])
def test_the_submodules_of_a_hidden_block_form_are_found(p: int, seed: int) -> None:
    """Block triangular matrices with irreducible diagonal blocks have one proper submodule, here in a random basis."""
    rng = np.random.default_rng(seed)
    natural = [[[int(x) for x in row] for row in rng.integers(-9, 10, (5, 5))] for _ in range(3)]
    lower = np.array(
        [[[0 if i < 2 <= j else m[i][j] for j in range(5)] for i in range(5)] for m in natural], dtype=object
    )
    weights = rng.integers(1, 8, (5, 5))
    one = np.array(np.eye(5, dtype=int), dtype=object)
    change, inverse = one, one  # products of shears, so that the inverse is integral
    for i, j in ((0, 3), (1, 4), (3, 2), (4, 0), (2, 1)):
        shear = one.copy()
        shear[i, j] = int(weights[i, j])
        undo = one.copy()
        undo[i, j] = -shear[i, j]
        change, inverse = shear.dot(change), inverse.dot(undo)
    maps = [change.dot(m).dot(inverse) for m in lower]
    entries = [int(x) for m in maps for x in m.ravel()]
    result = list(isotropic_submodules(entries, [0] * 25, p, 3))
    assert [len(x) for x in result] == [2]
    rows = np.array(result[0], dtype=object)
    pivots = [next(j for j in range(5) if row[j]) for row in result[0]]
    for m in maps:
        images = rows.dot(m) % p
        assert not ((images - images[:, pivots].dot(rows)) % p).any()
    assert not list(isotropic_submodules(entries, [int(x) for x in one.ravel()], p, 3))  # only 0 is isotropic
