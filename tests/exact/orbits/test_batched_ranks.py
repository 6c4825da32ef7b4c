"""Ranks of many small matrices against their singular values."""

import numpy as np
import pytest

from liehom.exact.orbits.range import batched_ranks


@pytest.mark.parametrize(("p", "q"), [(3, 3), (2, 5), (5, 2), (6, 10), (1, 4)])
def test_as_singular_values_have_it(p: int, q: int) -> None:
    rng = np.random.default_rng(p + 10 * q)
    a = rng.normal(size=(300, p, q))
    ranks = rng.integers(0, min(p, q) + 1, size=300)
    left, sizes, right = np.linalg.svd(a, full_matrices=False)
    kept = sizes * (np.arange(min(p, q)) < ranks[:, None])
    a = (left * kept[:, None, :]) @ right
    np.testing.assert_array_equal(batched_ranks(a, np.full(300, 1e-9)), ranks)
    np.testing.assert_array_equal(batched_ranks(a.reshape(3, 100, p, q), 1e-9), ranks.reshape(3, 100))


def test_next_to_the_bound_singular_values_decide() -> None:
    # the matrix whose last pivot is much larger than its least singular value
    n, c = 12, 0.6
    kahan = np.diag(0.8 ** np.arange(n)) @ (np.eye(n) - c * np.triu(np.ones((n, n)), 1))
    least = np.linalg.svd(kahan, compute_uv=False)[-1]
    for bound, rank in ((0.99 * least, n), (1.01 * least, n - 1)):
        assert set(batched_ranks(np.array([kahan] * 80), bound).tolist()) == {rank}
    near = np.array([np.diag([1.0, 1e-9 * (1 + x)]) for x in np.linspace(-1e-7, 1e-7, 101)])
    found = batched_ranks(near, 1e-9)
    np.testing.assert_array_equal(found, (np.linalg.svd(near, compute_uv=False) > 1e-9).sum(axis=-1))


def test_few_and_none() -> None:
    assert batched_ranks(np.eye(3), 1e-9) == 3 and batched_ranks(np.eye(3)[None], 1e-9).tolist() == [3]
    assert batched_ranks(np.zeros((0, 3, 3)), np.zeros(0)).shape == (0,)
    assert batched_ranks(np.zeros((100, 3, 3)), 1e-9).max() == 0
