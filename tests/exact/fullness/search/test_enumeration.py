"""The deterministic search for dominance: with the random rounds switched off every decision still ends."""

import itertools
import random
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import LimitError
from liehom.exact.fullness import decide
from liehom.exact.fullness.isotropy_action import TracelessIsotropyAction
from liehom.exact.fullness.search import dominance
from liehom.exact.fullness.search.dominance import (
    ExactDominance,
    enumerate_dominant,
    find_dominant,
    integer_vectors,
    number_of_vectors,
    plain_frame,
)
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.rational import QQ
from tests.exact.catalog.claims import CLAIMS
from tests.exact.fullness.support import (
    fraction,
    over,
    proved,
    random_invertible,
    scrambled,
    turned,
    without_cheap_points,
)

ROOT2 = NumberField("a", [-2, 0, 1], (1, 2))
CATALOGUE = ["affine(tensor(sl(2),sl(3)))", "affine(tensor(sl(4),sl(2)))", "affine(sl(2,Q(-1,3))+sl(1,Q(-1,3)))"]
CATALOGUE += ["affine(S3(gl(2)))", "affine(S2(sl(3)))"]
FAMILIES = ["sl(5)/P2", "sl(5)/P3", "sl(6)/P3", "sl(4,C)/P2", "affine(S3(sl(2)))", "affine(S2(sl(4)))"]
FAMILIES += ["affine(L2(sl(5)))", "affine(tensor(sl(2),sl(3))+R)", "affine(tensor(sl(3),sl(3)))"]
FAMILIES += ["affine(tensor(sl(3,C),sl(2)))"]


def irreducible_and_not_compact(name: str) -> bool:
    """Whether the spectral search decides the pair."""
    action = TracelessIsotropyAction(lh.pair(name))
    if lh.decide_fullness(lh.pair(name)).full or decide.invariant_forms(action.traceless, action.size, QQ).symmetric:
        return False
    return bool(lh.pair(name).isotropy_representation().is_irreducible())


def test_the_table_holds_all_small_pairs_of_the_catalogue() -> None:
    small = [name for name, claim in CLAIMS.items() if claim.algebra_dimension <= 40 and not claim.full]
    small = [name for name in small if lh.pair(name).dimension > 1]
    assert {name for name in small if irreducible_and_not_compact(name)} == set(CATALOGUE)


@pytest.fixture
def without_random_rounds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(decide, "_sample", without_cheap_points)
    monkeypatch.setattr(decide, "ROUNDS", 0)


def enumerated(pair: lh.Pair) -> lh.Certificate:
    """The dominance certificate that the enumeration finds."""
    lines: list[str] = []
    certificate = proved(pair, False, progress=lines.append).certificate
    assert lines[-1].startswith("enumeration of L0, height")
    return certificate.fields.get("also", certificate)


@pytest.mark.parametrize("name", CATALOGUE + FAMILIES)
@pytest.mark.usefixtures("without_random_rounds")
def test_every_pair_is_decided_without_random_rounds(name: str) -> None:
    pair, rng = lh.pair(name), random.Random(name)
    assert enumerated(pair).kind == "dominance"
    assert enumerated(scrambled(pair, rng)).kind == "dominance"
    if pair.dimension <= 6:
        change = random_invertible(QQ, pair.dimension, lambda: fraction(rng, 3))
        assert enumerated(turned(pair, change)).kind == "dominance"
        assert enumerated(over(pair, ROOT2)).kind == "dominance"


@pytest.mark.usefixtures("without_random_rounds")
def test_two_runs_find_the_same_certificate() -> None:
    pair = scrambled(lh.pair("affine(L2(sl(5)))"), random.Random(3))
    assert enumerated(pair) == enumerated(pair)


def test_the_enumeration_visits_every_integer_vector_once() -> None:
    for size, height in itertools.product(range(1, 4), range(1, 5)):
        vectors = [tuple(v) for v in integer_vectors(size, height)]
        box = itertools.product(range(-height, height + 1), repeat=size)
        assert sorted(vectors) == [v for v in box if sum(map(abs, v)) == height]
        assert len(vectors) == number_of_vectors(size, height)


def test_more_cuts_prove_elements_whose_eigenvalues_are_symmetric_about_the_first() -> None:
    action = TracelessIsotropyAction(lh.pair("affine(S3(gl(2)))"))
    exact, late = ExactDominance(action), 0
    for vector in integer_vectors(action.dimension, 3):
        coefficients = [QQ.convert(c) for c in vector]
        few, many = exact.certificate(coefficients, 64, 1), exact.certificate(coefficients, 128, 12)
        assert many is not None or few is None
        assert many is None or lh.verify_certificate(action.pair, many)
        late += few is None and many is not None
    assert late > 10


def test_a_search_without_end_is_interrupted_and_reports() -> None:
    """sl(2) on R^2 is full, so no element dominates."""
    action = TracelessIsotropyAction(lh.pair("affine(sl(2))"))
    lines: list[str] = []

    def report(line: str) -> None:
        lines.append(line)
        if len(lines) == 6:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        enumerate_dominant(action, plain_frame(action), report)
    assert lines[0] == "enumeration of L0, height 1, element 1 of 6"
    assert [line.split(",")[1] for line in lines] == [f" height {h}" for h in range(1, 7)]


def test_a_search_without_end_ends_with_the_time_that_is_given() -> None:
    action = TracelessIsotropyAction(lh.pair("affine(sl(2))"))
    with pytest.raises(LimitError, match="seconds"), lh.limits(seconds=0.2):
        enumerate_dominant(action, None, lambda _: None)


@pytest.mark.parametrize("scale", [Fraction(1, 10**400), Fraction(10**400)], ids=["tiny", "huge"])
def test_numbers_beyond_floats_leave_the_decision_to_exact_steps(
    scale: Fraction, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(decide, "_sample", without_cheap_points)
    pair = lh.pair("affine(S3(gl(2)))")
    for chosen in ({0}, {5}, {4, 6}):
        n = pair.algebra.dimension
        rows = [[(scale if i in chosen else 1) if i == j else 0 for j in range(n)] for i in range(n)]
        proved(pair.change_of_basis(rows), False)


def test_projectors_of_random_elements_are_proposed_after_the_basis() -> None:
    action = TracelessIsotropyAction(lh.pair("affine(S3(gl(2)))"))
    frame = plain_frame(action)
    assert frame is not None
    proposed = list(dominance._Search(action, frame).candidates(6, 0))
    d = len(frame.matrices)
    assert np.array_equal(proposed[:d], np.eye(d)) and len(proposed) > d
    elements = np.tensordot(np.array(proposed[d:]), frame.matrices, 1)
    values = np.linalg.eigvals(elements).real
    assert np.isfinite(values).all() and (values.max(axis=1) > 0.1).all()


@pytest.mark.usefixtures("without_random_rounds")
def test_eigenvalue_problems_without_convergence_find_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(_: Any) -> Any:
        raise np.linalg.LinAlgError("Eigenvalues did not converge")

    pair = lh.pair("affine(S2(sl(3)))")
    action = TracelessIsotropyAction(pair)
    frame = plain_frame(action)
    assert frame is not None and find_dominant(action, frame, 1) is not None
    monkeypatch.setattr(dominance.np.linalg, "eig", fails)
    monkeypatch.setattr(dominance.np.linalg, "eigvals", fails)
    assert find_dominant(action, frame, 1) is None
    assert enumerated(pair).kind == "dominance"
