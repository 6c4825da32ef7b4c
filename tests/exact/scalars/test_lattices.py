"""Arithmetic of integers behind lattices and conics: factors, square parts, residues, kernels modulo a number."""

from itertools import product
from math import gcd

import flint
import numpy as np
import pytest

from liehom.exact.scalars import lattices
from liehom.exact.scalars.exact_field import ExactMatrix
from liehom.exact.scalars.rational import QQ

NUMBERS = range(1, 200)


def test_parts_of_numbers() -> None:
    for n in NUMBERS:
        square = max(s for s in range(1, 15) if n % s**2 == 0)
        assert lattices._square_part(n) == lattices._square_part(-n) == square
        primes = [p for p in range(2, n + 1) if n % p == 0 and all(p % q for q in range(2, p))]
        assert lattices.pairwise_coprime(n) == primes
        assert n == 1 or lattices.smallest_prime(n) == primes[0]
        assert lattices._smallest_root(n) == min(r for r in range(1, n + 1) if n in (r**k for k in range(1, 8)))
    large = 1_000_003
    assert lattices.pairwise_coprime(12 * large**4) == [2, 3, large]


def test_powers_of_two_and_rounding() -> None:
    values = ["0", "1", "3/2", "2", "7", "8", "1/8", "1/9", "3/16"]
    assert [str(lattices.power_of_two(x)) for x in values] == ["1", "1", "1", "2", "4", "8", "1/8", "1/8", "1/8"]
    halves = [lattices._rounded_shift(flint.fmpq(n, 4)) for n in (-3, -2, -1, 0, 1, 2, 3, 5)]
    assert halves == [-1, 0, 0, 0, 0, 1, 1, 1]


def test_a_rounded_frame_has_forty_bits() -> None:
    assert lattices._rounded(np.array([[4.0, 1.0], [0.0, -2.0]])).tolist() == [[2**40, 2**38], [0, -(2**39)]]


def test_residues_combine() -> None:
    for a, b, c in product(range(3), range(5), range(7)):
        combined = lattices._crt((a, b, 0, c), (3, 5, 1, 7))
        assert 0 <= combined < 105 and (combined % 3, combined % 5, combined % 7) == (a, b, c)


@pytest.mark.parametrize("modulus", [2, 3, 7, 15, 21, 35])
def test_square_roots_of_quotients_modulo_a_number(modulus: int) -> None:
    for square, divisor in product(range(-6, 12), (1, 11, 13)):
        roots = [r for r in range(modulus) if (r * r * divisor**2 - square) % modulus == 0]
        assert (root := lattices._square_root(square, divisor, modulus)) in (roots or [None]), (square, root)


def test_reduced_coefficients_are_squarefree_and_coprime_and_have_the_same_zeros() -> None:
    for triple in product((1, -4, 12, 18), (2, -3, 50), (5, -6, 45)):
        (a, b, c), scale = lattices._reduced(triple)
        assert gcd(a, b) == gcd(b, c) == gcd(c, a) == 1
        assert all(lattices._square_part(x) == 1 for x in (a, b, c))
        # the forms in x/s are proportional
        ratios = {flint.fmpq(v * s**2, 1) / w for v, s, w in zip((a, b, c), scale, triple, strict=True)}
        assert len(ratios) == 1


def test_short_vectors_satisfy_the_conditions_of_legendre() -> None:
    a, b, c = 3, 5, -17
    roots = [lattices._square_root(*x) for x in ((-b * c, b, a), (-c * a, c, b), (-a * b, a, c))]
    assert None not in roots
    vectors = list(lattices._short_vectors((a, b, c), tuple(roots)))  # type: ignore[arg-type]
    assert len(vectors) == len(set(vectors)) == 9**3 - 1
    assert all((a * x * x + b * y * y + c * z * z) % (a * b * c) == 0 for x, y, z in vectors)
    shortest = min(a * x * x + b * y * y - c * z * z for x, y, z in vectors)
    assert shortest == min(a * x * x + b * y * y - c * z * z for x, y, z in vectors[:26]) <= 2 * abs(a * b * c)


def test_kernels_modulo_a_number_and_divisors_that_elimination_meets() -> None:
    matrix = QQ.matrix([[1, 2], [2, 4], [3, 1], [0, 0]])
    rows, pivots = lattices.kernel_modulo(matrix, 7)  # type: ignore[misc]
    assert pivots == [0, 2] and rows == [[5, 1, 0, 0], [0, 0, 0, 1]]
    assert lattices.kernel_modulo(QQ.matrix([[0], [3], [1]]), 6) == 3
    assert lattices.kernel_modulo(QQ.matrix([[0], [5], [1]]), 6) == ([[1, 0, 0], [0, 1, 1]], [1])


def test_integral_preimages_are_dual_to_the_columns() -> None:
    matrix = QQ.matrix([["1/2", 0, "1/3"], [0, "3/2", 0]])
    rows = lattices.integral_preimage(matrix)
    assert (rows @ matrix).den == 1
    assert abs(rows.determinant()) == 4
    wide = QQ.matrix([[int(i == j % 2) * (2 + 2 * (j % 3)) for j in range(40)] for i in range(2)])
    preimage = lattices.integral_preimage(wide)
    assert isinstance(preimage, ExactMatrix) and abs(preimage.determinant()) == QQ.one / 4


def test_reduced_bases_are_unimodular_and_short() -> None:
    basis = np.array([[1, 1000], [0, 1]])
    change = lattices.reduced_basis((basis @ basis.T).astype(float))
    assert abs(change.determinant()) == 1 and np.abs(change.to_numpy() @ basis).max() == 1
    rows = lattices.reduced_rows(QQ.matrix([[1, 1000], [0, 1]]).scale(QQ.one / 2), np.eye(2))
    assert sorted(np.abs(rows.to_numpy()).ravel()) == [0, 0, 0.5, 0.5]
