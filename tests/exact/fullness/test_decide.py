"""The decision on all pairs of the catalogue and on families, in scrambled bases; every step of it is exercised."""

import collections
import random
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import UndecidedError
from liehom.exact.fullness import decide
from liehom.exact.scalars import rational
from liehom.exact.scalars.rational import QQ
from liehom.testing import random_unimodular
from tests.exact.catalog.claims import CLAIMS
from tests.exact.fullness.support import (
    affine,
    companion,
    enlarged,
    fraction,
    in_basis,
    over,
    proved,
    random_invertible,
    scrambled,
    turned,
    without_cheap_points,
)

ALL = pytest.mark.parametrize("name", list(CLAIMS))
MERSENNE = 2**61 - 1  # the first prime that linear algebra modulo primes uses


def in_bases(name: str, full: bool, seeds: range) -> None:
    pair = lh.pair(name)
    for seed in seeds:
        print(f"{name}: seed {seed}")
        proved(scrambled(pair, random.Random(f"{name} {seed}")), full)


# -- the catalogue -----------------------------------------------------------------------------------------
@ALL
def test_catalogue_in_random_bases(name: str) -> None:
    in_bases(name, CLAIMS[name].full, range(2 if CLAIMS[name].algebra_dimension <= 30 else 1))


@pytest.mark.slow
@ALL
def test_catalogue_in_more_random_bases(name: str) -> None:
    in_bases(name, CLAIMS[name].full, range(2, 8))


def smaller(limit: int) -> list[str]:
    return [name for name, claim in CLAIMS.items() if claim.algebra_dimension <= limit]


@pytest.mark.parametrize("name", smaller(30))
def test_catalogue_in_dense_rational_bases(name: str) -> None:
    rng = random.Random(name)
    pair = lh.pair(name)
    rows = random_invertible(QQ, pair.algebra.dimension, lambda: fraction(rng, 5))
    proved(in_basis(pair, rows), CLAIMS[name].full)


def linear(limit: int) -> list[str]:
    names = [name for name in CLAIMS if name.startswith("affine(")]
    return [n for n in names if CLAIMS[n].algebra_dimension - CLAIMS[n].isotropy_dimension <= limit]


@pytest.mark.parametrize("name", linear(8))
def test_linear_algebras_conjugated_by_rational_matrices(name: str) -> None:
    rng = random.Random(name)
    pair = lh.pair(name)
    proved(turned(pair, random_invertible(QQ, pair.dimension, lambda: fraction(rng, 9))), CLAIMS[name].full)


@pytest.mark.slow
@pytest.mark.parametrize("name", linear(16))
def test_linear_algebras_conjugated_by_larger_rational_matrices(name: str) -> None:
    rng = random.Random(name)
    pair = lh.pair(name)
    proved(turned(pair, random_invertible(QQ, pair.dimension, lambda: fraction(rng, 20))), CLAIMS[name].full)


# -- families ----------------------------------------------------------------------------------------------
COMPACT = [f"so({n})/so({n - 1})" for n in range(3, 14)]
COMPACT += [f"su({n + 1})/u({n})" for n in range(1, 7)] + [f"sp({n + 1})/sp({n})+sp(1)" for n in range(1, 5)]
HYPERBOLIC = [f"so({n},1)/so({n})" for n in range(2, 10)]
HYPERBOLIC += [f"su({n},1)/u({n})" for n in range(1, 6)] + [f"sp({n},1)/sp({n})+sp(1)" for n in range(1, 4)]
PROJECTIVE = [f"sl({n})/P1" for n in range(2, 8)] + [f"sl({n})/P{n - 1}" for n in range(2, 6)]
PROJECTIVE += [f"sl({n},C)/P1" for n in range(2, 6)] + [f"sl({n},H)/P1" for n in range(2, 5)]
PROJECTIVE += [f"so({n},1)/P" for n in range(2, 10)]
AFFINE = [f"affine(so({n}))" for n in range(2, 9)] + [f"affine(so({n})+R)" for n in range(2, 9)]
AFFINE += [f"affine(su({n}))" for n in range(2, 6)] + [f"affine(u({n}))" for n in range(1, 6)]
AFFINE += [f"affine(sp({n}){s})" for n in range(1, 4) for s in ("", "+u(1)", "+sp(1)", "+R")]
AFFINE += [f"affine({g}({n}))" for g in ("sl", "gl") for n in range(2, 7)]
AFFINE += [f"affine({g}({n},C))" for g in ("sl", "gl") for n in range(2, 5)]
AFFINE += [f"affine(sl({n},C)+u(1))" for n in range(2, 5)]
AFFINE += [f"affine(sl({n},H){s})" for n in (2, 3) for s in ("", "+u(1)", "+sp(1)", "+R", "+sp(1)+R")]
AFFINE += [f"affine(sp({2 * n},R){s})" for n in range(1, 5) for s in ("", "+R")]
AFFINE += [f"affine(sp({2 * n},C){s})" for n in range(1, 4) for s in ("", "+u(1)")]
NOT_FULL = [f"so({p},{q})/so({p - 1},{q})" for p, q in ((2, 1), (2, 2), (3, 1), (4, 1), (3, 2), (5, 3))]
NOT_FULL += [f"sl({n})/P{k}" for n, k in ((4, 2), (5, 2), (5, 3), (6, 3), (7, 2))]
NOT_FULL += [f"sl({n},C)/P2" for n in (4, 5)] + [f"su({n})/s(u({n - 2})+u(2))" for n in (4, 5, 6)]
NOT_FULL += [f"so({n})/so({n - 2})+so(2)" for n in (5, 6, 7)] + [f"so({n})/so({n - 3})+so(3)" for n in (6, 7, 8)]
NOT_FULL += [f"affine(S{k}(sl(2)))" for k in range(2, 9)] + [f"affine(S2(sl({n})))" for n in (3, 4)]
NOT_FULL += [f"affine(L2(sl({n})))" for n in (4, 5, 6)] + ["affine(L3(sl(6)))", "affine(S2(sl(2,C)))"]
NOT_FULL += [f"affine(tensor(sl({a}),sl({b})){s})" for a, b in ((2, 3), (3, 3), (2, 4)) for s in ("", "+R")]
NOT_FULL += [f"affine(so({n},C){s})" for n in (3, 4, 5) for s in ("", "+R")]
NOT_FULL += [f"affine(tensor(sl({n},C),sl(2)))" for n in (2, 3)] + [f"affine(so*({2 * n}))" for n in (2, 3, 4)]
NOT_FULL += [f"affine(S3(so({n})))" for n in (3, 4)] + [f"affine(S2(so({n})))" for n in (3, 4)]


@pytest.mark.parametrize("name", COMPACT + HYPERBOLIC + PROJECTIVE + AFFINE)
def test_transitive_families_are_full(name: str) -> None:
    in_bases(name, True, range(1))


@pytest.mark.parametrize("name", NOT_FULL)
def test_intransitive_families_are_not_full_by_the_expected_certificate(name: str) -> None:
    in_bases(name, False, range(1))


@pytest.mark.parametrize("n", [14, 15, 17])
def test_spheres_in_sparse_random_bases(n: int) -> None:
    in_bases(f"so({n})/so({n - 1})", True, range(1))


@pytest.mark.parametrize("n", [22, 40])
def test_large_spheres_are_full(n: int) -> None:
    proved(lh.pair(f"so({n})/so({n - 1})"), True)


@pytest.mark.slow
@pytest.mark.parametrize("n", range(3, 41))
def test_all_spheres_in_random_bases(n: int) -> None:
    proved(lh.pair(f"so({n})/so({n - 1})"), True)
    in_bases(f"so({n})/so({n - 1})", True, range(1))


LOOK_ALIKES = [
    ("affine(spin(9,1))", "affine(spin(5,5))"), ("affine(sl(2,H)+sp(1))", "affine(tensor(sl(4),sl(2)))"),
    ("affine(sl(2,H)+sp(1))", "affine(sl(2,Q(-1,3))+sl(1,Q(-1,3)))"), ("affine(sl(2,H))", "affine(sl(2,Q(-1,3)))"),
    ("affine(sl(2,C))", "affine(sl(2,Q(sqrt(2))))"), ("affine(field(1,0))", "affine(field(-2,0))"),
    ("affine(form(1,2,5))", "affine(form(1,1,-3))"), ("e6(-26)/P", "e6(6)/P"), ("affine(spin(7))", "affine(spin(4,3))"),
    ("f4/spin(9)", "f4(4)/spin(5,4)"),
]  # fmt: skip


@pytest.mark.parametrize(("full", "other"), LOOK_ALIKES)
def test_look_alikes_share_their_numbers_and_differ(full: str, other: str) -> None:
    pairs = [lh.pair(name) for name in (full, other)]
    assert len({(p.algebra.dimension, p.subalgebra.dimension) for p in pairs}) == 1
    for pair, verdict in zip(pairs, (True, False), strict=True):
        proved(scrambled(pair, random.Random(1)), verdict)


@pytest.mark.parametrize(("name", "degree"), [
    ("affine(form(1,1,-3))", 2),  # x^2 + y^2 = 3 z^2 has no rational solution but 0
    ("affine(form(1,1,-3)+R)", 2), ("affine(form(1,-2))", 2), ("affine(field(-2,0))", 2), ("affine(field(-2,0,0))", 3),
])  # fmt: skip
def test_not_full_without_a_rational_witness(name: str, degree: int) -> None:
    """The rank drops at irrational directions only: the witness is over a field of this degree."""
    verdict = proved(lh.pair(name), False)
    assert verdict.certificate.kind == "witness"
    assert len(verdict.certificate.fields["minpoly"]) == degree + 1
    assert verdict.eta_field.degree == degree
    for point in np.ndindex(5, 5, 5):
        x = [c - 2 for c in point[: lh.pair(name).dimension]]
        if any(x):
            psi = [0] * lh.pair(name).subalgebra.dimension + x
            assert lh.range_condition(lh.pair(name), psi).holds


# -- every step --------------------------------------------------------------------------------------------
def outcome(verdict: Any) -> str:
    certificate = verdict.certificate
    if certificate.kind != "witness":
        return str(certificate.kind)
    degree = "rational" if len(certificate.fields["minpoly"]) == 2 else "algebraic"
    return f"witness {degree}" + (" with dominance" if "also" in certificate.fields else "")


STEPS = {
    "rank at sample points": {"witness rational"},
    "invariant forms": {"full", "witness rational", "witness algebraic"},
    "nilpotent ideals": {"witness rational"},
    "commutant": {"commutant", "witness algebraic", "witness rational"},
    "definite form": {"full"},
    "spectral search": {"dominance", "witness rational with dominance", "witness algebraic with dominance"},
}


def test_every_step_and_every_kind_occurs(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the cheap sample points switched off, each step decides some pair, in each way it can."""
    monkeypatch.setattr(decide, "_sample", without_cheap_points)
    seen: dict[str, set[str]] = collections.defaultdict(set)
    rng = random.Random(4)
    names = [*smaller(16), "affine(tensor(sl(4),sl(2)))", "affine(sl(2,Q(-1,3))+sl(1,Q(-1,3)))"]
    for name in names:
        pair = lh.pair(name)
        for moved in (pair, in_basis(pair, random_invertible(QQ, pair.algebra.dimension, lambda: fraction(rng, 5)))):
            lines = ["trivial"]
            verdict = proved(moved, CLAIMS[name].full, progress=lines.append)
            seen[lines[-1].split(",")[0]].add(outcome(verdict))
    lines = []  # twice R^3: a map with a kernel in the commutant
    seen["commutant"].add(outcome(proved(lh.pair("affine(copies(2,sl(3)))"), False, progress=lines.append)))
    assert lines[-1] == "commutant"
    seen.pop("coordinates in which floats see the spectrum", None)
    assert seen.pop("trivial") == {"trivial"}
    assert dict(seen) == STEPS


DOMINATED = ["affine(S3(gl(2)))", "affine(S2(sl(3)))", "affine(tensor(sl(4),sl(2)))"]


@pytest.mark.parametrize("name", DOMINATED)
def test_conjugations_that_hide_the_weights_from_floats(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The search goes on in balanced coordinates, whatever the size of the conjugating matrix."""
    monkeypatch.setattr(decide, "_sample", without_cheap_points)
    monkeypatch.setattr(decide, "plain_frame", lambda _: None)
    rng, pair = random.Random(7), lh.pair(name)
    for operations in (0, 10, 100):
        lines: list[str] = []
        change = QQ.matrix(random_unimodular(pair.dimension, rng, operations * pair.dimension))
        verdict = proved(turned(pair, change), False, progress=lines.append)
        assert "coordinates in which floats see the spectrum" in lines
        assert "dominance" in outcome(verdict)


def test_the_seed_does_not_change_the_verdict() -> None:
    for name in ("affine(L2(sl(4)))", "affine(spin(5,1))", "sl(4)/P2", "affine(so*(6))"):
        for seed in range(5):
            proved(lh.pair(name), CLAIMS[name].full, seed=seed)


# -- large and unlucky numbers -----------------------------------------------------------------------------
SMALL = ["affine(so(2))", "affine(sl(2))", "affine(sl(3))", "affine(so(3,1))", "affine(S2(sl(3)))", "so(5)/so(4)"]
SMALL += ["affine(sp(4,R))", "affine(sl(2,H)+sp(1))", "sl(3)/P1", "affine(field(1,1,1,1))", "affine(upper(3))"]
SMALL += ["affine(sp(4,C))"]  # a symplectic form over C


@pytest.mark.parametrize("factor", [MERSENNE, 10**100, MERSENNE * 10**330], ids=["prime", "googol", "beyond floats"])
@pytest.mark.parametrize("name", SMALL)
def test_bases_with_huge_multiples(name: str, factor: int) -> None:
    """Some basis elements times a huge number, a multiple of the prime of modular linear algebra in particular."""
    pair = lh.pair(name)
    n = pair.algebra.dimension
    for chosen in ({0}, {n - 1}, set(range(0, n, 2)), set(range(1, n, 2))):
        rows = [[(factor if i in chosen else 1) * int(i == j) for j in range(n)] for i in range(n)]
        proved(pair.change_of_basis(rows), CLAIMS[name].full)


@pytest.mark.parametrize("name", SMALL)
def test_a_basis_that_degenerates_modulo_the_prime(name: str) -> None:
    """The new basis is no basis modulo the prime, though no element is a multiple of it."""
    pair = lh.pair(name)
    n = pair.algebra.dimension
    rows = QQ.matrix([[1 if j == 0 else MERSENNE * int(i == j) for j in range(n)] for i in range(n)])
    proved(pair.change_of_basis(rows), CLAIMS[name].full)
    proved(pair.change_of_basis(rows.inverse()), CLAIMS[name].full)


@pytest.mark.parametrize("name", ["so(4)/so(3)", "sl(3)/P1", "affine(so(2,1))", "affine(sl(2,C))", "affine(upper(3))"])
def test_bases_with_hundred_digits(name: str) -> None:
    rng = random.Random(name)
    pair = lh.pair(name)
    rows = random_invertible(QQ, pair.algebra.dimension, lambda: rng.randint(-(10**100), 10**100))
    proved(pair.change_of_basis(rows), CLAIMS[name].full)


@pytest.fixture(params=[2, 3, 5, 7])
def tiny_primes(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """Modular linear algebra modulo 2, 3, 5, 7: the shortcuts fail all the time."""
    primes = [2, 3, 5, 7]
    start = primes.index(request.param)
    monkeypatch.setattr(rational.RationalField, "residue", lambda _, attempt=0: (primes[(start + attempt) % 4], 0))
    yield request.param


def test_unlucky_primes_change_no_verdict(tiny_primes: int) -> None:
    names = [name for name, claim in CLAIMS.items() if claim.algebra_dimension <= 16]
    for name in names:
        print(name, tiny_primes)
        proved(scrambled(lh.pair(name), random.Random(name)), CLAIMS[name].full)


# -- borders -----------------------------------------------------------------------------------------------
@pytest.mark.parametrize(("algebra", "rows", "full"), [
    (lh.abelian(0), [], True), (lh.abelian(1), [], True), (lh.abelian(1), [[1]], True), (lh.abelian(2), [], False),
    (lh.abelian(2), [[1, 1]], True), (lh.abelian(5), [[1, 0, 0, 0, 0]], False),
    (lh.so(3), [[1, 0, 0], [0, 1, 0], [0, 0, 1]], True), (lh.so(3), [], False),
    (lh.heisenberg(2), [[0, 0, 0, 0, 1]], False),
])  # fmt: skip
def test_small_and_trivial_pairs(algebra: lh.LieAlgebra, rows: Any, full: bool) -> None:
    proved(lh.Pair(algebra, rows), full)


@pytest.mark.parametrize("ideal", ["so(3)", "sl(2)", "e(2)"])
@pytest.mark.parametrize(
    "name", ["so(4)/so(3)", "sl(3)/P1", "affine(so(2,1))", "affine(upper(2))", "affine(S3(gl(2)))"]
)
def test_a_kernel_of_the_isotropy_changes_nothing(name: str, ideal: str) -> None:
    """g + k with h + k, k an ideal: the same pair as (g, h)."""
    pair = lh.pair(name)
    joined = enlarged(pair, lh.direct_sum(pair.algebra, lh.catalog.algebra(ideal)))
    proved(scrambled(joined, random.Random(2)), CLAIMS[name].full)


@pytest.mark.parametrize(("matrices", "full"), [
    ([companion([1, 0])], True),  # so(2)
    ([companion([1, 1])], True),  # a spiral: t^2 + t + 1
    ([companion([-2, 0])], False),  # eigenvalues +-sqrt(2)
    ([companion([1, 2])], False),  # a Jordan block
    ([[[0, 1], [0, 0]]], False),
    ([[[1, 0], [0, 1]]], False),  # scalars only
    ([companion([1, 0]), [[0, 1], [1, 0]]], True),  # sl(2)
    ([companion([2, 0, 0])], False), ([companion([1, 1, 1, 1])], False),
    ([companion([5, 0, 0, 0, 0, 0, 0, 0, 0])], False),  # degree 9: no eigenvalue of low degree
    ([companion([3, 0, 0, 0, 0, 0, 0, 0, 0, 0])], False), ([[[1, 1, 0], [0, 1, 1], [0, 0, 1]]], False),
    ([[[0, -1, 1, 0], [1, 0, 0, 1], [0, 0, 0, -1], [0, 0, 1, 0]]], False),  # a complex Jordan block
])  # fmt: skip
def test_algebras_of_few_matrices_are_decided_in_every_basis(matrices: Any, full: bool) -> None:
    proved(affine(matrices), full)
    d = len(matrices[0])
    rng = random.Random(d)
    proved(turned(affine(matrices), random_invertible(QQ, d, lambda: fraction(rng, 4))), full)


def test_a_numerical_pair_gets_a_numerical_verdict() -> None:
    for name, full in (("so(4)/so(3)", True), ("affine(so(2,1))", False), ("sl(3)/P1", True)):
        verdict = lh.decide_fullness(over(lh.pair(name), lh.RR))
        assert verdict.full is full and verdict.certificate is None and verdict.gap > 10
        with pytest.raises(UndecidedError):
            bool(verdict)


def test_progress_names_the_steps() -> None:
    lines: list[str] = []
    lh.decide_fullness(lh.pair("sl(3)/P1"), progress=lines.append)
    assert lines == [
        "rank at sample points", "invariant forms", "nilpotent ideals", "commutant", "definite form",
    ]  # fmt: skip
