"""Pairs over real number fields: the embedding decides, and nothing else changes with the field."""

import random
from typing import Any

import pytest

import liehom as lh
from liehom.exact.fullness import decide
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.rational import QQ
from liehom.testing import random_unimodular
from tests.exact.catalog.claims import CLAIMS
from tests.exact.fullness.support import affine, in_basis, over, proved, random_invertible, turned, without_cheap_points

ROOT2 = NumberField("a", [-2, 0, 1], (1, 2))
MINUS_ROOT2 = NumberField("a", [-2, 0, 1], (-2, -1))
CUBIC = NumberField("a", [-2, 0, 0, 1], (1, 2))
HEPTAGON = NumberField("a", [-1, -2, 1, 1], (1, 2))  # 2 cos(2 pi / 7)
NESTED = NumberField("a", [2, 0, -4, 0, 1], (1, 2))  # sqrt(2 + sqrt(2))
FIELDS = {"sqrt(2)": ROOT2, "cube root of 2": CUBIC, "2 cos(2 pi/7)": HEPTAGON, "sqrt(2 + sqrt(2))": NESTED}
fields = pytest.mark.parametrize("field", FIELDS.values(), ids=list(FIELDS))


def element(field: Any, rng: random.Random, bound: int = 2) -> Any:
    return field.from_coordinates([QQ.convert(rng.randint(-bound, bound)) for _ in range(field.degree)])


def mixed(field: Any, n: int, rng: random.Random) -> Any:
    """An invertible matrix over the field: a unimodular one times elementary ones with entries from the field."""
    rows = [[field.convert(x) for x in row] for row in random_unimodular(n, rng)]
    for _ in range(2 * n if n > 1 else 0):
        i, j = rng.sample(range(n), 2)
        factor = element(field, rng, 1)
        rows[i] = [x + factor * y for x, y in zip(rows[i], rows[j], strict=True)]
    return field.matrix(rows, (n, n))


def scrambled(pair: lh.Pair, field: Any, rng: random.Random) -> lh.Pair:
    n, k = pair.algebra.dimension, pair.subalgebra.dimension
    return in_basis(over(pair, field), mixed(field, n, rng), mixed(field, k, rng))


def names(limit: int) -> list[str]:
    return [name for name, claim in CLAIMS.items() if claim.algebra_dimension <= limit]


# -- nothing changes with the field ------------------------------------------------------------------------
@fields
@pytest.mark.parametrize("name", [
    *names(10), *(pytest.param(name, marks=pytest.mark.slow) for name in names(24) if name not in names(10)),
])  # fmt: skip
def test_the_verdict_is_that_over_qq(name: str, field: Any) -> None:
    proved(scrambled(lh.pair(name), field, random.Random(name)), CLAIMS[name].full)


@pytest.mark.parametrize("name", [
    *(name for name in names(30) if name not in names(10)), "affine(spin(9,1))", "affine(spin(5,5))", "e6(-26)/P",
    "f4/spin(9)", "so(12)/so(11)",
])  # fmt: skip
def test_the_verdict_over_root_two(name: str) -> None:
    proved(over(lh.pair(name), ROOT2), CLAIMS[name].full)


# -- the embedding decides ---------------------------------------------------------------------------------
def rotations(field: Any, diagonal: list[Any], extra: list[Any] | None = None) -> lh.Pair:
    """so of a diagonal form F on V: the maps F^-1 S, S skew."""
    d = len(diagonal)
    maps = []
    for i in range(d):
        for j in range(i):
            rows = [[field.zero] * d for _ in range(d)]
            rows[i][j], rows[j][i] = 1 / field.convert(diagonal[i]), -1 / field.convert(diagonal[j])
            maps.append(field.matrix(rows))
    return affine([*maps, *(extra or [])])


@pytest.mark.parametrize("scalars", [False, True], ids=["", "with scalars"])
@pytest.mark.parametrize("size", [2, 3, 4, 5])
def test_a_form_definite_in_one_embedding_only(size: int, scalars: bool) -> None:
    """diag(1, ..., 1, a), a^2 = 2: the sphere for a > 0, hyperbolic for a < 0; same polynomial, other root."""
    for field, full in ((ROOT2, True), (MINUS_ROOT2, False)):
        extra = [field.identity(size)] if scalars else []
        pair = rotations(field, [*[1] * (size - 1), field.generator], extra)
        proved(pair, full)
        proved(turned(pair, mixed(field, size, random.Random(size))), full)
    fields_differ = [lh.decide_fullness(rotations(f, [1, 1, f.generator])).certificate for f in (ROOT2, MINUS_ROOT2)]
    for certificate, field in zip(fields_differ, (MINUS_ROOT2, ROOT2), strict=True):
        with pytest.raises(lh.errors.CertificateError):
            lh.verify_certificate(rotations(field, [1, 1, field.generator]), certificate)


@pytest.mark.parametrize(("interval", "full"), [((1, 2), True), ((-1, 0), False), ((-2, -1), False)])
def test_the_three_embeddings_of_a_cubic_field(interval: tuple[int, int], full: bool) -> None:
    """2 cos(2 pi k/7): diag(1, 1, a) is definite for the positive root only."""
    field = NumberField("a", [-1, -2, 1, 1], interval)
    proved(rotations(field, [1, 1, field.generator]), full)


def complex_like(field: Any, square: Any, algebra: str) -> lh.Pair:
    """gl(1) or sl(2) over K(T), T^2 = square, on K^2 or K^4."""
    square = field.convert(square)
    t = field.matrix([[0, square], [1, 0]])
    if algebra == "gl(1)":
        return affine([t, field.identity(2)])
    maps = []
    for rows in ([[0, 1], [0, 0]], [[0, 0], [1, 0]], [[1, 0], [0, -1]]):
        for scalar in (field.identity(2), t):
            blocks = [field.stack_columns([scalar.scale(x) for x in row], 2) for row in rows]
            maps.append(field.stack_rows(blocks, 4))
    return affine(maps)


@pytest.mark.parametrize("algebra", ["gl(1)", "sl(2)"])
def test_a_commutant_that_is_a_field_over_one_embedding_only(algebra: str) -> None:
    """T^2 = a: over Q(sqrt 2) with a > 0 the commutant K(T) splits over the reals, with a < 0 it is C."""
    for field, full in ((ROOT2, False), (MINUS_ROOT2, True)):
        pair = complex_like(field, field.generator, algebra)
        verdict = proved(turned(pair, mixed(field, pair.dimension, random.Random(3))), full)
        if not full:
            assert verdict.certificate.kind in ("witness", "commutant")
    verdict = proved(complex_like(ROOT2, 2, algebra), False)  # 2 is a square in Q(sqrt 2): reducible over K already
    assert len(verdict.certificate.fields["minpoly"]) == 2
    assert len(proved(complex_like(QQ, 2, algebra), False).certificate.fields["minpoly"]) == 3


@pytest.mark.parametrize(("sign", "full"), [(1, False), (-1, True)])
def test_quaternion_algebras_over_a_number_field(sign: int, full: bool) -> None:
    """The units of (-1, +-a) on K^4: a quaternion algebra, definite if and only if its second parameter is negative."""
    for field in (ROOT2, HEPTAGON):
        a, b = field.convert(-1), field.generator * sign
        i = field.matrix([[0, a, 0, 0], [1, 0, 0, 0], [0, 0, 0, a], [0, 0, 1, 0]])
        j = field.matrix([[0, 0, b, 0], [0, 0, 0, -b], [1, 0, 0, 0], [0, -1, 0, 0]])
        proved(turned(affine([i, j]), mixed(field, 4, random.Random(5))), full)


# -- dominance, algebraic witnesses ------------------------------------------------------------------------
@fields
@pytest.mark.parametrize("name", ["affine(S3(gl(2)))", "affine(S2(sl(3)))", "affine(tensor(sl(2),sl(3)))"])
def test_dominance_over_number_fields(name: str, field: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(decide, "_sample", without_cheap_points)
    rng = random.Random(name)
    pair = over(lh.pair(name), field)
    verdict = proved(turned(pair, random_invertible(field, pair.dimension, lambda: element(field, rng))), False)
    assert verdict.certificate.kind == "dominance" or "also" in verdict.certificate.fields


@fields
def test_balanced_coordinates_over_number_fields(field: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(decide, "_sample", without_cheap_points)
    monkeypatch.setattr(decide, "plain_frame", lambda _: None)
    rng = random.Random(1)
    pair = over(lh.pair("affine(S3(gl(2)))"), field)
    verdict = proved(turned(pair, random_invertible(field, 4, lambda: element(field, rng, 10**9))), False)
    assert verdict.certificate.kind == "dominance" or "also" in verdict.certificate.fields


def test_a_witness_in_a_tower_of_fields() -> None:
    """x^2 = a y^2 over Q(sqrt 2), a > 0 no square: the null vector lies in Q(2^(1/4))."""
    verdict = proved(rotations(ROOT2, [1, -ROOT2.generator]), False)
    assert verdict.certificate.kind == "witness" and len(verdict.certificate.fields["minpoly"]) == 3
    assert verdict.certificate.field == ROOT2


@fields
def test_a_root_that_the_field_has(field: Any) -> None:
    """x^2 = a^2 y^2 has solutions over K itself: no extension is made."""
    assert len(proved(rotations(field, [1, -(field.generator**2)]), False).certificate.fields["minpoly"]) == 2


def test_numbers_that_nearly_vanish() -> None:
    """diag(1, 1, e), e = (1 - sqrt 2)^k of the sign (-1)^k: signs are found with as many digits as they need."""
    e = ROOT2.one
    for k in range(1, 200):
        e = e * (1 - ROOT2.generator)
        if k in (1, 2, 51, 52, 198, 199):
            assert abs(float(e)) < 0.415**k * 1.01
            proved(rotations(ROOT2, [1, 1, e]), k % 2 == 0)


def test_field_of_large_height() -> None:
    field = NumberField("a", [-(10**60) - 7, 0, 1], (10**30, 10**30 + 1))
    proved(rotations(field, [1, 1, field.generator - 10**30]), True)
    proved(rotations(field, [1, 1, 10**30 - field.generator]), False)


@fields
@pytest.mark.parametrize("name", ["affine(so(2))", "affine(sl(2))", "sl(3)/P1", "affine(S3(gl(2)))", "affine(so(2,1))"])
def test_multiples_of_a_prime_in_the_kernel_of_the_residue_map(name: str, field: Any) -> None:
    """Modular linear algebra sends b to a root modulo a prime p: b - root and p both go to 0."""
    prime, root = field.residue()
    generator = field.from_coordinates([QQ.convert(int(i == 1)) for i in range(field.degree)])
    pair = over(lh.pair(name), field)
    n = pair.algebra.dimension
    for factor in (generator - root, field.convert(prime)):
        for chosen in ({0}, {n - 1}, set(range(0, n, 2))):
            rows = [[(factor if i in chosen else 1) if i == j else 0 for j in range(n)] for i in range(n)]
            proved(pair.change_of_basis(rows), CLAIMS[name].full)
