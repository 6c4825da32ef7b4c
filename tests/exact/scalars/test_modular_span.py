"""Spaces of rows modulo primes, against exact ranks and products, and fractions from their residues."""

import random
from math import gcd, isqrt
from typing import Any

import flint
import numpy as np
import pytest
from scipy import sparse

from liehom.exact.scalars import modular as modular_maps, modular as modular_span
from liehom.exact.scalars.modular import (
    ROWS_AT_ONCE,
    ModularSpan,
    eigenvalues,
    extending_rows,
    independent_columns,
    independent_rows,
    interpolated,
    invariant_hull_rank,
    invariant_span,
    left_kernel,
    lifted,
    norm_bound,
    primitive_residues,
    product,
    rational_lifts,
    remainders,
    residue_map,
    residues,
    small_residues,
    splitting_primes,
)
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.rational import QQ

ROOT2 = NumberField("a", [-2, 0, 1], (1, 2))
CUBIC = NumberField("c", [1, -3, 0, 1], (1, 2))
PRIMES = [2, 5, 101, 4194301]


def rank_modulo(rows: Any, p: int) -> int:
    table = np.asarray(rows, dtype=np.int64)
    return int(flint.nmod_mat(*table.shape, [int(x) % p for x in table.ravel()], p).rank())


@pytest.mark.parametrize("p", PRIMES)
def test_a_span_grows_by_the_rows_that_are_independent_of_the_earlier_ones(p: int) -> None:
    rng = np.random.default_rng(p)
    for n in (1, 3, 7):
        span, seen = ModularSpan(p, n), np.zeros((0, n), dtype=np.int64)
        for _ in range(4):
            rows = rng.integers(-2, 3, (rng.integers(1, 4), n)) * rng.integers(0, 2, (1, n))
            ranks = [rank_modulo(np.concatenate([seen, rows[:i]]), p) for i in range(len(rows) + 1)]
            assert span.extend(rows) == [i for i in range(len(rows)) if ranks[i + 1] > ranks[i]]
            seen = np.concatenate([seen, rows])
            assert span.rank == rank_modulo(seen, p) == rank_modulo(np.concatenate([seen, span.rows.astype(int)]), p)
            basis, pivots = span.echelon()
            assert pivots == sorted(pivots) and np.array_equal(basis[:, pivots], np.eye(span.rank))
            assert (basis >= 0).all() and (basis < p).all()


@pytest.mark.parametrize("p", PRIMES[1:])
def test_the_invariant_span_is_that_of_all_words(p: int) -> None:
    rng = np.random.default_rng(p)
    for n in (2, 4, 6):
        maps = [np.triu(rng.integers(-1, 2, (n, n)), 1), np.triu(rng.integers(-1, 2, (n, n)))]
        rows = rng.integers(-1, 2, (1, n))
        words, layer = [rows], [rows]
        for _ in range(n):
            layer = [w @ a % p for w in layer for a in maps]
            words += layer
        span = invariant_span(maps, rows, p)
        assert span.rank == rank_modulo(np.concatenate(words), p)
        assert rank_modulo(np.concatenate([span.rows.astype(int), *words]), p) == span.rank
        assert invariant_hull_rank(QQ.matrix(rows.tolist()), [QQ.matrix(a.tolist()) for a in maps]) >= span.rank


@pytest.mark.parametrize("p", PRIMES)
def test_the_left_kernel_is_the_whole_kernel(p: int) -> None:
    rng = np.random.default_rng(p + 1)
    for shape in ((1, 1), (5, 3), (3, 5), (6, 6)):
        matrix = rng.integers(-2, 3, shape)
        matrix[-1] = matrix[0]
        kernel = left_kernel(matrix, p)
        assert not (kernel @ matrix % p).any()
        assert len(kernel) == shape[0] - rank_modulo(matrix, p)
        assert len(kernel) == 0 or rank_modulo(kernel, p) == len(kernel)


def test_remainders_and_products_are_exact() -> None:
    rng = np.random.default_rng(0)
    for p in PRIMES:
        values = np.concatenate(
            [rng.integers(-(2**52), 2**52, 1000), p * rng.integers(-1000, 1000, 100), [2**53 - p, 0]]
        )
        assert np.array_equal(remainders(values.astype(float), p), values % p)
    p = 4194301
    for n in (1, 511, 512, 513, 1500):
        left, right = rng.integers(p - 50, p, (2, n)), rng.integers(p - 50, p, (n, 3))
        expected = (left.astype(object) @ right.astype(object)) % p
        assert np.array_equal(product(left.astype(float), right.astype(float), p), expected.astype(float))


@pytest.mark.parametrize("field", [QQ, ROOT2, CUBIC], ids=["QQ", "root", "cubic"])
def test_residues_are_images_under_the_residue_map(field: Any) -> None:
    p, root = residue_map(field)
    assert flint.fmpz(p).is_prime() and p < 1 << 22
    generator = 0 if field is QQ else field.generator * field.leading
    matrix = (
        field.matrix([[generator, 3], [7 * generator - 2, -1]]) if field is not QQ else field.matrix([[0, 3], [-2, -1]])
    )
    assert residues(matrix, p, root).tolist() == [[root, 3], [(7 * root - 2) % p, p - 1]]
    if field is not QQ:
        assert residues(field.matrix([[generator**3]]), p, root)[0, 0] == pow(root, 3, p)


@pytest.mark.parametrize("field", [QQ, ROOT2, CUBIC], ids=["QQ", "root", "cubic"])
@pytest.mark.parametrize("bound", [1, 10**6, 10**30])
def test_enough_residue_maps_recognize_zero(field: Any, bound: int) -> None:
    pairs = list(small_residues(field, bound))
    assert len({p for p, _ in pairs}) == len(pairs)
    total = 1
    modulus = field.modulus_coefficients()
    for p, root in pairs:
        assert flint.fmpz(p).is_prime() and p < 1 << 22
        assert len(modulus) == 2 or sum(c * root**k for k, c in enumerate(modulus)) % p == 0
        total *= p
    assert total > norm_bound(modulus, bound) >= 2 * bound
    # an element of size `bound`, times itself: its norm is below the product of the primes
    if field is not QQ:
        assert norm_bound(modulus, bound) >= 2 * bound**field.degree


def test_the_norm_bound_by_hand() -> None:
    assert norm_bound([0, 1], 7) == 14
    assert norm_bound([-2, 0, 1], 5) == 2 * (5 * (1 + 3) ** 2) ** 2
    assert norm_bound([1, -3, 0, 1], 2) == 2 * (2 * (1 + 4 + 16) ** 2) ** 3


@pytest.mark.parametrize("p", [101, 4194301, 2**61 - 1])
def test_fractions_are_recognized_up_to_the_bound(p: int) -> None:
    bound, rng = isqrt(p // 2), random.Random(p)
    pairs = [(a, b) for a in (0, 1, -1, bound, -bound) for b in (1, 2, bound)]
    pairs += [(rng.randint(-bound, bound), rng.randint(1, bound)) for _ in range(200)]
    for a, b in pairs:
        if gcd(a, b) == 1:
            assert modular_span._fraction(a * pow(b, -1, p) % p, p, bound) == flint.fmpq(a, b)
    result = [modular_span._fraction(v, p, bound) for v in (rng.randrange(p) for _ in range(200))]
    assert all(f is None or (abs(f.p) <= bound and f.q <= bound) for f in result)


def test_lifts_use_more_primes_until_the_matrix_is_found() -> None:
    wanted = QQ.matrix([[1, f"-{10**30}/7", 0], [0, "5/11", 10**25]])
    result = []
    for proposal in rational_lifts(lambda attempt: modular_maps._split_residue(wanted, attempt), QQ):
        result.append(proposal)
        if proposal == wanted:
            break
    assert result[-1] == wanted
    assert list(rational_lifts(lambda attempt: None, QQ)) == []
    small = QQ.matrix([[1, "2/3"]])
    changing = [modular_maps._split_residue(small, 0), flint.nmod_mat(1, 3, [1, 2, 3], 101)]
    assert list(rational_lifts(lambda attempt: changing[attempt], QQ)) == [small]  # another shape: no more proposals


def test_what_is_not_a_small_fraction_is_not_lifted() -> None:
    p, bound = 101, isqrt(50)
    fractions = {a * pow(b, -1, p) % p for a in range(-bound, bound + 1) for b in range(1, bound + 1)}
    for value in range(p):
        assert (lifted(np.array([[float(value)]]), p, QQ) is None) == (value not in fractions)


def test_independent_rows_are_a_basis_also_modulo_unlucky_primes() -> None:
    prime = 2**61 - 1
    for rows in ([[prime, 0], [0, 1]], [[1, 2], [1, 2 + prime]], [[0, 0], [prime, 0]], [[2, 4], [1, 2], [0, prime]]):
        matrix = QQ.matrix(rows)
        for chosen, side in ((independent_rows(matrix), matrix), (independent_columns(matrix.T), matrix)):
            picked = side.select(rows=chosen)
            assert picked.nrows == picked.rank() == matrix.rank()
    assert independent_columns(QQ.matrix([[prime, 1], [0, 1]])) == [0, 1]
    assert independent_columns(QQ.matrix([[prime, 1]])) == [0]  # column 0 is in the basis unless it is 0
    assert independent_columns(QQ.matrix([[0, 1]])) == [1]


def test_rows_are_made_primitive_before_they_are_reduced() -> None:
    prime = 2**61 - 1
    rows = [QQ.matrix([[prime, 2 * prime]]), QQ.matrix([["1/3", "2/3"]]), QQ.matrix([[0, 0]])]
    image = primitive_residues(rows, 2)
    assert [int(x) for x in image.entries()] == [1, 2, 1, 2, 0, 0]
    assert extending_rows([primitive_residues(rows[:1], 2)], [image]) == []
    assert extending_rows([], [image, flint.nmod_mat(1, 2, [0, 3], image.modulus())]) == [0, 3]


def test_many_rows_extend_a_span_as_they_do_one_by_one() -> None:
    p, rng = 4194301, np.random.default_rng(5)
    rows = rng.integers(0, p, (40, 60)).astype(float)
    rows = product(rng.integers(-1, 2, (3 * ROWS_AT_ONCE, 40)) % p * (rng.random((3 * ROWS_AT_ONCE, 1)) < 0.3), rows, p)
    together, single = ModularSpan(p, 60), ModularSpan(p, 60)
    kept = together.extend(rows)
    assert kept == [i for i, row in enumerate(rows) if single.extend(row)] and len(kept) == 40
    assert all(np.array_equal(a, b) for a, b in zip(together.echelon(), single.echelon(), strict=True))


def test_sparse_maps_and_stacks_of_maps_span_the_same_as_single_arrays() -> None:
    p, rng = 4194301, np.random.default_rng(6)
    maps = [rng.integers(0, 3, (700, 700)) * (rng.random((700, 700)) < 0.003) for _ in range(2)]
    maps = [m.astype(float) for m in maps]
    start = np.eye(700)[:1]
    spans = [
        invariant_span(given, start, p).echelon()
        for given in (maps, [sparse.csr_array(m) for m in maps], [np.array(maps)])
    ]
    assert len(spans[0][1]) > 0 and all(pivots == spans[0][1] for _, pivots in spans)
    assert all(np.array_equal(rows, spans[0][0]) for rows, _ in spans)


def test_splitting_primes_have_all_roots() -> None:
    for field, degree in ((QQ, 1), (ROOT2, 2), (CUBIC, 3)):
        modulus = field.modulus_coefficients()
        for _, (p, roots) in zip(range(4), splitting_primes(field), strict=False):
            assert flint.fmpz(p).is_prime() and p < 1 << 22 and len(set(roots)) == degree
            assert all(sum(c * r**s for s, c in enumerate(modulus)) % p == 0 for r in roots)


def test_interpolated_coefficients_have_the_given_values() -> None:
    p, points = 101, [3, 50, 99]
    values = np.array([[1.0, 2, 0], [7, 100, 0], [55, 3, 1]])
    coefficients = interpolated(values, points, p)
    at_points = [[sum(int(c) * x**s for s, c in enumerate(column)) % p for column in coefficients.T] for x in points]
    assert at_points == values.tolist()


def test_eigenvalues_are_those_in_the_prime_field() -> None:
    change, p = np.array([[1.0, 2, 3], [0, 1, 4], [0, 0, 5]]), 103
    assert sorted(eigenvalues(product(np.diag([7.0, 7, 9]), change, p), change, p)) == [7, 9]
    assert eigenvalues(np.array([[0.0, 1], [102, 0]]), np.eye(2), p) == []  # -1 is not a square modulo 103
