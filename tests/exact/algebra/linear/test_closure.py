"""Lie closure compared with a direct closure by rows, in both completions; errors; the fast paths agree."""

import itertools
import random
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import InputError, NotClosedError
from liehom.exact.algebra import linear as mf
from liehom.exact.algebra.linear.closure import lie_closure
from liehom.exact.algebra.linear.generated_span import (
    _GrowingSpan,
    commutator_pairs,
    generated_span,
    spanning_commutators,
)
from liehom.exact.scalars.floating import RR
from liehom.exact.scalars.modular import ModularSpan, product, rational_lifts
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.rational import QQ
from tests.sampling import examples

ROOT2 = NumberField("a", [-2, 0, 1], (1, 2))


def plain(basis: list[Any]) -> tuple[list[tuple[int, int]], list[Any]]:
    """Commutators in lexicographic order, round after round, with one exact rank for each."""
    size = basis[0].nrows ** 2
    field, closure, pairs = basis[0].field, list(basis), []
    grown = True
    while grown:
        grown, count = False, len(closure)
        for i, j in itertools.combinations(range(count), 2):
            bracket = closure[i] @ closure[j] - closure[j] @ closure[i]
            flat = field.stack_rows([m.reshape(1, size) for m in (*closure, bracket)], size)
            if flat.rank() > len(closure):
                closure.append(bracket)
                pairs.append((i, j))
                grown = True
    return pairs, closure


def is_right(closure: Any) -> bool:
    """The table holds for the matrices, by the constructor's own proof."""
    return lh.Representation(closure.algebra, closure.matrices).algebra is closure.algebra


entries = st.sampled_from([0, 0, 0, 1, -1, 2, "1/2"])


@settings(deadline=None, max_examples=examples(15))
@given(st.data())
def test_against_the_plain_closure(data: st.DataObject) -> None:
    n = data.draw(st.integers(2, 4))
    square = st.lists(st.lists(entries, min_size=n, max_size=n), min_size=n, max_size=n)
    matrices = [QQ.matrix(data.draw(square)) for _ in range(data.draw(st.integers(1, 2)))]
    if QQ.stack_rows([m.reshape(1, n * n) for m in matrices], n * n).rank() < len(matrices):
        return
    pairs, basis = plain(matrices)
    closure = lie_closure(matrices)
    assert closure.appended == tuple(pairs) and list(closure.matrices) == basis and is_right(closure)
    assert lie_closure([ROOT2.matrix(m.to_rows()) for m in matrices]).appended == closure.appended
    reduced = lie_closure(matrices, completion="reduced")
    assert list(reduced.matrices[: len(matrices)]) == matrices and reduced.algebra.dimension == len(basis)
    assert is_right(reduced)


def skew(n: int, seed: int) -> Any:
    a = np.random.default_rng(seed).integers(-3, 4, (n, n))
    return a - a.T


@pytest.mark.parametrize("n", [4, 6, 8])
def test_skew_matrices_generate_so(n: int) -> None:
    matrices = [skew(n, 1), skew(n, 2)]
    commutators = lie_closure(matrices, completion="commutators")
    reduced = lie_closure(matrices, completion="reduced")
    for closure in (commutators, reduced):
        assert closure.algebra.dimension == n * (n - 1) // 2
        assert closure.algebra.killing_signature() == (0, n * (n - 1) // 2, 0)
        assert is_right(closure)
    assert lie_closure(matrices).appended == commutators.appended and not reduced.appended


def test_large_closures_are_completed_by_reduced_matrices() -> None:
    closure = lie_closure([skew(13, 1), skew(13, 2)])
    assert closure.algebra.dimension == 78 and closure.appended == () and closure.kept == (0, 1)
    assert max(abs(int(x)) for m in closure.matrices[2:] for x in m.entries()) == 1
    assert is_right(closure)


def test_sparse_generators_keep_their_commutators() -> None:
    """Simple rotations: every appended matrix is a rotation again, however many there are."""
    closure = lie_closure(list(mf.so(12)[[11 * i - i * (i - 1) // 2 for i in range(11)]]))
    assert closure.algebra.dimension == 66 and len(closure.appended) == 55
    assert all(sum(1 for x in m.entries() if x) == 2 for m in closure.matrices)


def test_limits_and_refusals() -> None:
    two = [skew(4, 1), skew(4, 2)]
    with pytest.raises(NotClosedError, match="more than 4") as caught:
        lie_closure(two, limit=4)
    assert caught.value.pair in itertools.combinations(range(6), 2)
    assert lie_closure(two, limit=6).algebra.dimension == 6
    with pytest.raises(NotClosedError):
        lie_closure(two, close=False)
    with pytest.raises(InputError, match="completion"):
        lie_closure(two, completion="best")  # type: ignore[arg-type]
    for field in (RR, ROOT2):
        with pytest.raises(InputError, match="over QQ only"):
            lie_closure([field.matrix(m.tolist()) for m in two], completion="reduced")
    rho = lh.Representation.from_matrices(two, completion="reduced")
    assert (rho.given, rho.appended, rho.algebra.dimension) == (2, (), 6)


def test_unlucky_primes() -> None:
    """Matrices that vanish modulo the small prime, or only together with a large one."""
    for p in (4194301, 4194301 * (2**61 - 1)):
        a, b = QQ.matrix([[0, p], [0, 0]]), QQ.matrix([[0, 0], [p + 1, 0]])
        for completion in ("auto", "commutators", "reduced"):
            closure = lie_closure([a, b], completion=completion)  # type: ignore[arg-type]
            assert closure.algebra.dimension == 3 and is_right(closure)


def test_spans_modulo_a_prime() -> None:
    rng = random.Random(3)
    p = 4194301
    rows = [[rng.randrange(p) for _ in range(9)] for _ in range(5)]
    rows.insert(2, [(x + 2 * y) % p for x, y in zip(rows[0], rows[1], strict=True)])
    span = ModularSpan(p, 9)
    assert span.extend(rows[:3]) == [0, 1] and span.extend(rows[2:]) == [1, 2, 3] and span.rank == 5
    assert span.extend(rows) == []
    a, b = np.full((2, 1500), p - 1.0), np.full((1500, 2), p - 2.0)
    assert product(a, b, p).tolist() == [[1500 * 2 % p] * 2] * 2
    words = spanning_commutators([QQ.matrix([[0, 1], [0, 0]]), QQ.matrix([[0, 0], [1, 0]])])
    assert len(words) == 3 and commutator_pairs([QQ.identity(2)], 1) == []


def test_lifts_of_large_fractions() -> None:
    target = QQ.matrix([[1, 0, f"{10**25}/{3**30}"], [0, 1, -(7**40)]])

    def residue(attempt: int) -> Any:
        image = target.modulo(attempt)
        return image * pow(target.den, -1, image.modulus())

    assert target in list(rational_lifts(residue, QQ))
    span = generated_span([QQ.matrix([[10**40, 1], [0, 3]]), QQ.matrix([[1, 0], [0, "1/7"]])])
    assert span is not None and span.rows.nrows == 3


def test_uncertainties_of_commutators_contain_changes_of_their_factors() -> None:
    """A member of the basis has its spectral norm, and the uncertainty of a commutator is reached within a factor 4."""
    rng, span = np.random.default_rng(0), _GrowingSpan(3)
    for error in (1e-6, 3e-6):
        row = span.outside(rng.normal(size=(1, 9)), np.zeros(1))[0][0]
        span.append(row, error * np.linalg.norm(row))
    assert np.allclose(span.spectral, [np.linalg.norm(b.reshape(3, 3), 2) for b in span.basis])
    rows, bounds = span.commutators(1, 2)
    x, y = (b.reshape(3, 3) for b in span.basis)
    assert np.allclose(rows, [(x @ y - y @ x).ravel(), np.zeros(9)])
    largest = np.zeros(2)
    for _ in range(300):
        dx, dy = (d * e / np.linalg.norm(d) for d, e in zip(rng.normal(size=(2, 3, 3)), span.errors, strict=True))
        changes = [dx @ y - y @ dx + x @ dy - dy @ x, dy @ y - y @ dy]
        largest = np.maximum(largest, np.linalg.norm(np.reshape(changes, (2, 9)), axis=1))
    assert largest[0] <= bounds[0] <= 4 * largest[0]
