"""The proofs modulo primes: the primes, the bound, and that as many primes are used as the bound asks for."""

import itertools
import random
from collections.abc import Callable
from fractions import Fraction
from math import isqrt, prod
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import CertificateError, LimitError
from liehom.exact.fullness.checker import verify_modular, verify_pair
from liehom.exact.fullness.checker.verify_modular import IntegralPair
from liehom.exact.fullness.checker.verify_pair import check_pair
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.rational import QQ
from tests.exact.fullness.checker.test_verify import GOOD, Pair, make, moved, orthogonal

ROOT2 = NumberField("a", [-2, 0, 1], (1, 2))
HALF_ROOT = NumberField("b", [-3, 0, 2], (1, 2))  # 2 b^2 = 3: the integral generator is 2 b
CUBIC = NumberField("c", [1, -3, 0, 1], (1, 2))  # three real roots
MIXED = NumberField("d", [1, 0, -10, 0, 1], (3, 4))  # sqrt(2) + sqrt(3)
FIELDS = [QQ, ROOT2, HALF_ROOT, CUBIC, MIXED]
BY_NAME = {"ids": lambda field: field.name}
H2 = [[1, 0, 0, 0], [0, 1, 0, 0]]


@pytest.fixture(params=[True, False], ids=["dense", "sparse"])
def both_ways(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> bool:
    monkeypatch.setattr(verify_modular, "_is_dense", lambda n, number: request.param)
    return bool(request.param)


def failed(pair: Pair) -> str | None:
    """The name of the check that the pair fails, or None."""
    try:
        check_pair(pair)
    except CertificateError as error:
        return error.check
    return None


def integral(pair: Pair) -> IntegralPair:
    """The pair as `check_pair` hands it to the proof modulo primes."""
    result: list[IntegralPair] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(verify_pair, "check_representation", result.append)
        check_pair(pair)
    return result[0]


def bound_of(data: IntegralPair) -> int:
    numbers = map(verify_modular._Numbers, (data.constants, data.quotient, data.isotropy))
    return verify_modular._bound(data, *numbers)


def first_primes(field: Any, count: int, n: int = 4) -> list[int]:
    return [p for p, _ in itertools.islice(verify_modular._primes(field, n), count)]


# -- the primes --------------------------------------------------------------------------------------------
def is_prime(p: int) -> bool:
    return p > 1 and all(p % f for f in range(2, isqrt(p) + 1))


@pytest.mark.parametrize("n", [1, 64, 300, 3000])
@pytest.mark.parametrize("field", FIELDS, **BY_NAME)
def test_every_prime_is_a_prime_with_a_root_and_small_enough_for_floats(field: Any, n: int) -> None:
    pairs = list(itertools.islice(verify_modular._primes(field, n), 12))
    assert len(pairs) == len({p for p, _ in pairs}) == 12
    modulus = [int(c) for c in field.modulus.coeffs()] if field is not QQ else [0, 1]
    for p, root in pairs:
        assert is_prime(p)
        assert 0 <= root < p
        assert sum(c * root**k for k, c in enumerate(modulus)) % p == 0
        assert n * p * p < 2**53
        assert p > 1 << 10


def test_few_primes_are_skipped() -> None:
    """Over QQ no prime is left out; over a number field those without a root are."""
    for n, limit in ((10, 11863283), (70, 11343468), (75, 10958831)):
        assert limit == isqrt((1 << 53) // max(n, 64))
        assert first_primes(QQ, 30, n) == [p for p in range(limit, limit - 1000, -1) if is_prime(p)][:30]
    roots = [p for p in range(1 << 15, (1 << 15) + 2000) if is_prime(p) and any((x * x - 2) % p == 0 for x in range(p))]
    assert first_primes(ROOT2, 30, 10) == roots[:30]


@pytest.mark.parametrize(
    ("modulus", "p", "root"),
    [((-2, 0, 0, 1), 5, 3), ((-2, 0, 0, 1), 7, None), ((-1, 0, 1), 7, 1), ((6, -5, 1), 101, 2)],
)
def test_the_smallest_root_modulo_a_prime(modulus: tuple[int, ...], p: int, root: int | None) -> None:
    assert verify_modular._root(modulus, p) == root


@pytest.mark.parametrize("candidate", [*range(3, 200), 32783, 32783**2, 11863279, 2**23 - 1, 4093 * 4099, 8191**2])
def test_primality_by_trial_division(candidate: int) -> None:
    assert verify_modular._is_prime(candidate) is (is_prime(candidate) and candidate > 2)


# -- residues ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("field", FIELDS, **BY_NAME)
def test_images_are_those_of_a_ring_homomorphism(field: Any) -> None:
    """Sums and products of the images are the images, for numbers below and above 2^62, of both signs."""
    rng = random.Random(3)
    degree = field.degree
    for size in (9, 10**12, 10**40):
        entries = [field.from_coordinates([QQ.convert(rng.randint(-size, size)) for _ in range(degree)])
                   if degree > 1 else QQ.convert(rng.randint(-size, size)) for _ in range(4)]  # fmt: skip
        matrix = field.matrix([entries[:2], entries[2:]])
        square = matrix @ matrix
        for p, root in itertools.islice(verify_modular._primes(field, 4), 5):
            images = []
            for m in (matrix, square, matrix + square):
                image = verify_modular._Numbers(m).image(p, root)
                assert image.dtype == np.int64 and image.min() >= 0 and image.max() < p
                images.append(image.astype(object) * pow(int(m.cleared().den), -1, p) % p)
            assert np.array_equal(images[1], images[0] @ images[0] % p)
            assert np.array_equal(images[2], (images[0] + images[1]) % p)


@pytest.mark.parametrize("value", [2**62 - 1, 2**62, -(2**62), 2**63, 2**64 + 5, -(10**30), 0, -1])
def test_integers_near_the_end_of_the_machine_are_not_wrapped(value: int) -> None:
    assert [int(x) for x in verify_modular._integers([value, 1])] == [value, 1]
    p = first_primes(QQ, 1)[0]
    assert verify_modular._Numbers(QQ.matrix([[value]])).image(p, 0)[0, 0] == value % p


def test_reduction_is_exact_up_to_two_to_the_53() -> None:
    rng = np.random.default_rng(0)
    for p in (*first_primes(QQ, 2), 32783, 5):
        values = np.concatenate([rng.integers(-(2**53) + 1, 2**53, 1000), p * rng.integers(-1000, 1000, 200)])
        values = np.concatenate([values, np.array([2**53 - 1, 1 - 2**53, (2**53 // p) * p, p, -p, 1, 0])])
        result = verify_modular._reduced(p, values.astype(np.float64))
        assert np.array_equal(result.astype(np.int64) % p, values % p)
        assert np.abs(result).max() < 0.51 * p + 1
        assert np.array_equal(result == 0, values % p == 0)


# -- the bound ---------------------------------------------------------------------------------------------
def conjugates(field: Any, entries: list[Any]) -> float:
    """The largest absolute value of all conjugates of elements, in floats."""
    if field is QQ:
        return max(float(abs(x)) for x in entries)
    roots = np.roots([float(c) for c in reversed(field.minpoly)])
    coordinates = np.array([[float(c) for c in field.coordinates(x)] for x in entries])
    return float(np.abs(coordinates @ roots[None, :] ** np.arange(field.degree)[:, None] * 1.0).max())


def compared(data: IntegralPair) -> list[Any]:
    """All elements that must be 0, by the definitions of `_bound`, in exact arithmetic."""
    field, n, d = data.field, data.dimension, len(data.free)
    k = len(data.pivots)
    table = [field.zeros(n, n).to_rows() for _ in range(n)]  # table[m][i][j]
    for (i, j, m), c in zip(data.places.tolist(), data.constants.entries(), strict=True):
        table[m][i][j], table[m][j][i] = c, -c
    tables = [field.matrix(t, (n, n)) for t in table]
    q = field.convert(data.scale)
    rows = []
    for p in data.pivots:
        lift = dict(zip(data.free, data.quotient.row(p), strict=True))
        rows.append([q if j == p else -lift.get(j, field.zero) for j in range(n)])
    h = field.matrix(rows, (k, n))

    def bracket(x: Any, y: Any) -> Any:
        return field.matrix([[(x @ t @ y.T)[0, 0] for t in tables]])

    rho = [data.isotropy.select(rows=[p]).reshape(d, d) for p in range(k)]
    out = []
    for p in range(k):
        x = h.select(rows=[p])
        for j in range(n):
            first = bracket(x, field.unit(n, j)) @ data.quotient
            out += (first.scale(q) - data.quotient.select(rows=[j]) @ rho[p]).entries()
        for r in range(k):
            inner = bracket(x, h.select(rows=[r]))
            left = sum((rho[t].scale(inner[0, m]) for t, m in enumerate(data.pivots)), field.zeros(d, d))
            out += (left - (rho[r] @ rho[p] - rho[p] @ rho[r])).entries()
    return out


def random_table(field: Any, rng: random.Random, n: int, k: int, size: int) -> Pair:
    """A table and rows of h without any law."""

    def number() -> Any:
        value = QQ.convert(Fraction(rng.randint(-size, size), rng.choice([1, 1, 2, 3])))
        if field is QQ:
            return value
        return field.convert(value) + field.generator * rng.randint(-size, size)

    places = [(i, j, m) for i in range(n) for j in range(i + 1, n) for m in range(n)]
    brackets = {place: number() for place in rng.sample(places, rng.randint(1, len(places)))}
    rows = [
        [field.one if c == r else field.zero for c in range(k)] + [number() for _ in range(n - k)] for r in range(k)
    ]
    return make(n, brackets, rows, field)


@pytest.mark.parametrize("field", FIELDS, **BY_NAME)
def test_all_conjugates_of_the_compared_elements_are_within_the_bound(field: Any) -> None:
    rng, tightest = random.Random(5), 0.0
    for _ in range(25):
        n = rng.randint(2, 4)
        data = integral(random_table(field, rng, n, rng.randint(1, n - 1), rng.choice([1, 5, 1000])))
        bound = bound_of(data)
        largest = conjugates(field, [*compared(data), field.zero])
        assert largest <= bound * (1 + 1e-9)
        tightest = max(tightest, largest / max(bound, 1))
    assert tightest > (0.2 if field is QQ else 0.001)


@pytest.mark.parametrize(
    ("brackets", "rows", "expected"),
    [
        # g = |[e_0, e_1]'| = 7, q = 1, l = 1, m = 1, d = 1, R' = 7
        ({(0, 1, 1): 7}, [[1, 0]], max(1 * 7 * 1 * 1 + 1 * 1 * 7, 7 * 7 + 2 * 49)),
        # q = 3, h' = (3, 1), Q' = (-1, 3)^T, l = 4, g = 5 + 2, R' = 3 (2 * 3 - 5)
        ({(0, 1, 0): 5, (0, 1, 1): 2}, [[3, 1]], max(3 * 7 * 4 * 3 + 3 * 3, 7 * 16 * 3 + 2 * 9)),
        # the same with R' = 0, and with d = 2, l = 51, m = 50, R' = 1: the first sum is the larger one
        ({(0, 1, 0): 3, (0, 1, 1): 1}, [[3, 1]], 3 * 4 * 4 * 3),
        ({(0, 2, 2): 1}, [[1, -50, 0]], 51 * 50 + 2 * 50),
        # d = 2: the second term of each sum has the factor d
        ({(0, 1, 2): 3, (0, 2, 1): 5}, [[1, 0, 0]], max(5 + 2 * 5, 5 * 5 + 4 * 25)),
    ],
)  # fmt: skip
def test_the_bound_by_hand(brackets: Any, rows: Any, expected: int) -> None:
    assert bound_of(integral(make(len(rows[0]), brackets, rows))) == expected


@pytest.mark.parametrize("field", FIELDS[1:], **BY_NAME)
def test_the_bound_is_that_of_all_conjugates(field: Any) -> None:
    """Numbers that are small in the chosen embedding and large in another one count with the large value."""
    small = field.generator - field.convert(Fraction(round(field.to_float(field.generator) * 1000), 1000))
    data = integral(make(2, {(0, 1, 1): small}, [[1, 0]], field))
    assert bound_of(data) >= 3 * conjugates(field, data.isotropy.entries()) ** 2 * 0.999


def test_the_bound_counts_a_root_that_is_larger_than_all_coefficients() -> None:
    golden = NumberField("g", [-1, -1, 1], (1, 2))
    data = integral(make(2, {(0, 1, 1): golden.generator * 1000}, [[1, 0]], golden))
    assert bound_of(data) >= 3 * 1618**2


# -- as many primes as needed ------------------------------------------------------------------------------
def primes_used(pair: Pair, monkeypatch: pytest.MonkeyPatch) -> tuple[list[int], int]:
    """The primes modulo which the pair is checked, and the bound that their product must exceed."""
    used: list[int] = []
    with monkeypatch.context() as patch:
        for name in ("_check_dense", "check_sparse"):
            check: Callable[..., None] = getattr(verify_modular, name)
            patch.setattr(verify_modular, name, lambda p, *rest, check=check: (used.append(p), check(p, *rest)))
        check_pair(pair)
    data = integral(pair)
    return used, bound_of(data) ** data.field.degree


def rotations(factor: int, field: Any = QQ) -> Pair:
    """h = <e_0, e_1> acts on the plane by two multiples of a rotation, which commute."""
    return make(4, {(0, 2, 3): 1, (0, 3, 2): -1, (1, 2, 3): factor, (1, 3, 2): -factor}, H2, field)


@pytest.mark.parametrize("digits", [0, 3, 10, 30, 100])
@pytest.mark.parametrize("field", [QQ, ROOT2, CUBIC], **BY_NAME)
def test_the_product_of_the_primes_exceeds_the_bound(
    field: Any, digits: int, both_ways: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    used, bound = primes_used(rotations(10**digits, field), monkeypatch)
    assert len(set(used)) == len(used)
    assert prod(used[:-1]) <= bound < prod(used)
    assert used == first_primes(field, len(used))


def commutator(multiple: Any, field: Any = QQ) -> Pair:
    """[e_0, e_2] = e_3, [e_1, e_3] = c e_2: rho(e_0) and rho(e_1) do not commute, though [e_0, e_1] = 0."""
    return make(4, {(0, 2, 3): 1, (1, 3, 2): multiple}, H2, field)


@pytest.mark.parametrize("count", [1, 2, 3, 5])
@pytest.mark.parametrize("field", FIELDS, **BY_NAME)
def test_an_error_that_vanishes_modulo_the_first_primes_is_seen(field: Any, count: int, both_ways: bool) -> None:
    multiple = prod(first_primes(field, count))
    assert failed(commutator(multiple, field)) == "homomorphism"
    if field is not QQ:
        assert failed(commutator(field.generator * multiple, field)) == "homomorphism"


def test_an_error_that_vanishes_modulo_the_first_prime_of_its_field_is_seen(both_ways: bool) -> None:
    assert failed(commutator(11863279)) == "homomorphism"
    assert failed(commutator(ROOT2.generator * 32783, ROOT2)) == "homomorphism"
    assert first_primes(QQ, 1) == [11863279]
    assert 32783 in first_primes(ROOT2, 5)


@pytest.mark.parametrize("field", FIELDS[1:], **BY_NAME)
def test_an_error_in_the_kernel_of_a_residue_map_is_seen(field: Any, both_ways: bool) -> None:
    """b - root maps to 0 modulo the first prime, though no rational prime divides it."""
    _, root = next(verify_modular._primes(field, 4))
    error = field.generator * field.leading - root
    assert failed(commutator(error, field)) == "homomorphism"
    assert failed(commutator(error**3, field)) == "homomorphism"


@pytest.mark.parametrize("count", [0, 1, 2, 4])
def test_a_subalgebra_that_is_closed_modulo_the_first_primes_only(count: int, both_ways: bool) -> None:
    multiple = prod(first_primes(QQ, count))
    rows = [[1, 0, 1, 0], [0, 1, 0, 0]]
    assert failed(make(4, {(0, 1, 3): multiple}, rows)) == "closed"
    assert failed(make(4, {(0, 1, 3): ROOT2.generator * multiple}, rows, ROOT2)) == "closed"
    assert failed(make(4, {(1, 2, 3): multiple}, rows)) == "closed"
    assert failed(make(4, {(0, 1, 1): multiple}, rows)) is None


def test_denominators_need_several_primes_and_get_them(both_ways: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    big = 10**60 + 7
    brackets = {(0, 2, 3): Fraction(1, big), (0, 3, 2): -big, (1, 2, 3): 1, (1, 3, 2): -(big**2)}
    used, bound = primes_used(make(4, brackets, H2), monkeypatch)
    assert len(used) > 50 and prod(used) > bound
    for count in (0, 1, 5, 20):
        wrong = brackets | {(1, 3, 2): -(big**2) - prod(first_primes(QQ, count))}
        assert failed(make(4, wrong, H2)) == "homomorphism"


def test_a_pair_for_which_the_primes_do_not_suffice_is_not_accepted(monkeypatch: pytest.MonkeyPatch) -> None:
    primes = list(itertools.islice(verify_modular._primes(QQ, 4), 2))
    monkeypatch.setattr(verify_modular, "_primes", lambda *_: iter(primes))
    assert failed(rotations(1)) is None
    assert failed(rotations(10**20)) == "pair"


def test_a_long_proof_ends_with_the_time_that_is_allowed() -> None:
    data = integral(rotations(1))
    with lh.limits(seconds=0), pytest.raises(LimitError):
        verify_modular.check_representation(data)


# -- dense and sparse --------------------------------------------------------------------------------------
@pytest.mark.parametrize("size", [1, 1000, 10**6, 10**7, 10**9])
def test_large_constants_are_read_as_they_are(size: int, both_ways: bool) -> None:
    """so(5)/so(4) with each basis element times another number of this size; then one constant is changed."""
    rng, pair = random.Random(size), orthogonal(5)
    scales = [rng.randint(size, 2 * size) for _ in range(10)]
    entries = {(i, j, k): c * scales[i] * scales[j] / scales[k] for i, j, k, c in pair.algebra.entries}
    basis = pair.subalgebra.basis.to_rows()
    assert failed(make(10, entries, basis)) is None
    lift = [[x + (scales[r] if j == r else 0) for j, x in enumerate(row)] for r, row in enumerate(basis)]
    assert failed(make(10, entries, lift)) == "closed"
    in_h = [(key, c) for key, c in entries.items() if min(key) >= 4]
    for key, c in in_h:
        assert failed(make(10, entries | {key: entries[key] + c / size}, basis)) == "homomorphism"


@pytest.mark.parametrize(("n", "number", "dense"), [
    (80, 1, True), (81, 13286, False), (81, 13287, True), (300, 675_000, False), (300, 675_001, True),
    (301, 10**7, False),
])  # fmt: skip
def test_dense_matrices_serve_small_and_full_tables(n: int, number: int, dense: bool) -> None:
    assert verify_modular._is_dense(n, number) is dense


@pytest.mark.parametrize("entries", [1, 200, 10**9])
def test_blocks_of_any_size_check_the_same(entries: int, monkeypatch: pytest.MonkeyPatch) -> None:
    from liehom.exact.fullness.checker import verify_modular as verify_sparse

    monkeypatch.setattr(verify_modular, "_BLOCK_ENTRIES", entries)
    monkeypatch.setattr(verify_sparse, "_BLOCK", max(1, entries // 100))
    for dense in (True, False):
        monkeypatch.setattr(verify_modular, "_is_dense", lambda n, number, dense=dense: dense)
        pair = orthogonal(6)
        assert failed(pair) is None
        brackets = {(i, j, k): c for i, j, k, c in pair.algebra.entries}
        basis = pair.subalgebra.basis.to_rows()
        for key in brackets:
            changed = failed(make(15, brackets | {key: brackets[key] * 2}, basis))
            assert (changed is None) is (key[0] < 5 and key[1] < 5), key  # brackets of two elements of V


@pytest.mark.parametrize("name", ["sphere", "disc", "affine plane", "cone", "borel", "so(6)/so(5)"])
def test_dense_and_sparse_agree_in_any_basis(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """h is spanned by rows in general position, so that its complement enters all products; one constant is changed."""
    rng = random.Random(name)
    for seed in range(3):
        pair, _ = moved(*GOOD[name], seed)
        n, rows = pair.algebra.dimension, pair.subalgebra.basis.to_rows()
        brackets = {(i, j, k): c for i, j, k, c in pair.algebra.entries}
        i, j, k = rng.choice([key for key in itertools.product(range(n), repeat=3) if key[0] < key[1]])
        wrong = make(n, brackets | {(i, j, k): brackets.get((i, j, k), QQ.zero) + rng.choice([1, -2, 10**7])}, rows)
        answers = []
        for dense in (True, False):
            monkeypatch.setattr(verify_modular, "_is_dense", lambda n, number, dense=dense: dense)
            assert failed(pair) is None
            answers.append(failed(wrong))
        assert answers[0] == answers[1]


def test_catalogue_pairs_pass_both_ways(both_ways: bool) -> None:
    for name in ("so(4)/so(3)", "sl(3)/P1", "affine(sp(4,R))", "su(3)/u(2)"):
        pair = lh.pair(name)
        assert failed(pair) is None  # type: ignore[arg-type]
