"""Tensor sums, powers, symmetric matrices and companion matrices act as their definitions say."""

from itertools import combinations
from math import comb

import numpy as np
import pytest

from liehom.exact.algebra import linear as mf


@pytest.mark.parametrize("k", range(5))
def test_powers_are_representations_with_the_right_character(k):
    matrices = mf.gl(3)
    for power, dimension in (
        (mf.symmetric_power(matrices, k), comb(k + 2, k)),
        (mf.exterior_power(matrices, k) if k <= 3 else None, comb(3, k)),
    ):
        if power is None:
            continue
        assert power.shape == (9, dimension, dimension)
        for i, j in combinations(range(9), 2):
            bracket = matrices[i] @ matrices[j] - matrices[j] @ matrices[i]
            image = np.tensordot(bracket.reshape(-1), power, 1)  # gl(3) has the elementary matrices as basis
            assert np.array_equal(image, power[i] @ power[j] - power[j] @ power[i])
        identity = power[0] + power[4] + power[8]
        assert np.array_equal(identity, k * np.eye(dimension))


def test_binary_forms_keep_the_discriminant():
    """a x^2 + b xy + c y^2 has the invariant b^2 - 4 a c under sl(2)."""
    discriminant = np.array([[0, 0, -2], [0, 1, 0], [-2, 0, 0]])
    forms = mf.symmetric_power(mf.sl(2), 2)
    assert not (forms.transpose(0, 2, 1) @ discriminant + discriminant @ forms).any()


def test_congruence_is_conjugation_for_skew_matrices():
    skew, k = mf.so(4), 4
    rows, columns = np.triu_indices(k)
    coordinates = np.random.default_rng(2).integers(-5, 6, len(rows))
    symmetric = np.zeros((k, k), dtype=int)
    symmetric[rows, columns] = symmetric[columns, rows] = coordinates
    for a, action in zip(skew, mf.congruence(skew), strict=True):
        assert np.array_equal((a @ symmetric - symmetric @ a)[rows, columns], action @ coordinates)


def test_tensor_sum_acts_on_matrices_from_both_sides():
    first, second = mf.sl(2), mf.sl(3)
    x = np.arange(6).reshape(2, 3)
    actions = mf.tensor_sum(first, second) @ x.reshape(-1)
    assert np.array_equal(actions[:3].reshape(-1, 2, 3), first @ x)
    assert np.array_equal(actions[3:].reshape(-1, 2, 3), x @ second.transpose(0, 2, 1))


def test_companion_powers_satisfy_the_polynomial():
    powers = mf.companion_powers([-2, 0, 0])
    assert np.array_equal(powers[1] @ powers[2], 2 * np.eye(3))
