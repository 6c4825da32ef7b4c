"""Characteristic polynomials prime by prime, and matrices that are too large for flint."""

import random

import flint
import pytest

import liehom as lh
from liehom.base.errors import LimitError
from liehom.exact.scalars.integer_matrices import LARGE_SIZE, characteristic_coefficients, require_small_answer
from liehom.exact.scalars.rational import QQ


@pytest.mark.parametrize("size", [0, 1, 10**30])
def test_the_characteristic_polynomial_is_that_of_flint(size: int) -> None:
    rng, n = random.Random(size), LARGE_SIZE + 1
    matrix = flint.fmpz_mat(n, n, [rng.randrange(-size, size + 1) for _ in range(n * n)])
    assert characteristic_coefficients(matrix) == matrix.charpoly().coeffs()
    assert characteristic_coefficients(-matrix.transpose()) == (-matrix).charpoly().coeffs()


def test_a_permutation_has_the_characteristic_polynomial_of_its_cycle() -> None:
    n = LARGE_SIZE
    cycle = flint.fmpz_mat(n, n, [int(j == (i + 1) % n) for i in range(n) for j in range(n)])
    assert characteristic_coefficients(cycle) == [-1, *[0] * (n - 1), 1]


def test_flint_is_not_asked_for_more_memory_than_allowed() -> None:
    for call in (lambda: QQ.zeros(10**6, 10**6), lambda: QQ.identity(10**6)):
        with pytest.raises(LimitError, match="memory"):
            call()


def test_an_echelon_form_of_long_numbers_is_refused_by_its_size() -> None:
    long = flint.fmpz_mat(40, 40, [(1 << 60_000) + x for x in range(1600)])
    with pytest.raises(LimitError, match=r"60\d\d\d bits"):
        require_small_answer(long, 2)
    require_small_answer(long, 1)
    with lh.limits(memory=10**8), pytest.raises(LimitError):
        require_small_answer(long, 1)
