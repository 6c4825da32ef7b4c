"""Numerical verdicts: never wrong on the catalogue in floats, undecided if the error of the data is too large."""

import json
from collections import Counter
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import UndecidedError
from liehom.exact.fullness.numerical import (
    Enclosure,
    float_action,
    least_singular_value,
    orthonormal_span,
    real_parts,
    self_adjoint_position,
    transitive_group,
)
from tests import sampling
from tests.exact.catalog.claims import CLAIMS
from tests.exact.fullness.float_campaign import compared, wrong
from tests.exact.fullness.noise_campaign import KINDS, NAMES as NOISY, answers, noisy, wrong as wrong_answers
from tests.floats import constants_of, pair_of, rotated, rotation

NAMES = [name for name, claim in CLAIMS.items() if 0 < claim.algebra_dimension <= 15]


def table(n: int, *entries: tuple[int, int, int, float]) -> Any:
    constants = np.zeros((n, n, n))
    for i, j, k, value in entries:
        constants[i, j, k] += value
        constants[j, i, k] -= value
    return constants


def axes(n: int, *members: int) -> Any:
    return np.eye(n)[list(members)]


def verdict_of(constants: Any, rows: Any) -> Any:
    return lh.decide_fullness(pair_of(constants, rows))


def plane_turn(t: float) -> Any:
    """h acts on R^2 by [[0, -t], [1, 0]]: full for t > 0, not full for t <= 0."""
    return table(3, (0, 1, 2, 1.0), (0, 2, 1, -t))


# -- the catalogue ------------------------------------------------------------------------------------------
@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e12])
def test_catalogue_in_random_orthogonal_bases_has_no_wrong_answer(scale: float) -> None:
    rng = np.random.default_rng(int(np.log10(scale)) + 20)
    counts: Counter[Any] = Counter()
    for name in NAMES if sampling.whole else NAMES[:: 4 if scale == 1 else 9]:
        constants, rows = constants_of(lh.pair(name))
        verdict = verdict_of(*rotated(constants, rows, rotation(len(constants), rng), scale))
        counts[verdict.full] += 1
        assert verdict.full in (CLAIMS[name].full, None), f"{name}: {verdict}"
    assert counts[None] == 0
    assert min(counts[True], counts[False]) > 3


@pytest.mark.parametrize("name", ["so(4)/so(3)", "sl(3)/P1", "affine(su(2))", "so(3,1)/P"])
def test_a_full_pair_whose_basis_has_units_of_very_different_sizes_is_not_called_not_full(name: str) -> None:
    constants, rows = constants_of(lh.pair(name))
    rng = np.random.default_rng(8)
    for _ in range(3):
        units = 10.0 ** rng.uniform(-3, 3, len(constants))
        scaled = constants * units[:, None, None] * units[:, None] / units
        assert verdict_of(scaled, rows / units).full is not False


def with_noise(name: str, size: float, rng: np.random.Generator) -> Any:
    """The verdict of a pair in a random orthogonal basis, with noise of a size relative to the norm of the table."""
    constants, rows = constants_of(lh.pair(name))
    n = len(constants)
    constants, rows = rotated(constants, rows, rotation(n, rng))
    noise = rng.standard_normal(constants.shape) * (size * np.linalg.norm(constants) / n**1.5)
    return verdict_of(constants + noise - noise.transpose(1, 0, 2), rows)


def test_noise_of_the_size_of_rounding_changes_no_answer() -> None:
    rng = np.random.default_rng(9)
    for name in NAMES if sampling.whole else NAMES[::6]:
        assert with_noise(name, 2e-13, rng).full is CLAIMS[name].full, name


@pytest.mark.parametrize("kind", KINDS)
def test_noise_within_the_declared_error_leaves_few_undecided_and_none_wrong(kind: str) -> None:
    names = NOISY if sampling.whole else NOISY[1::12]
    for size, share in ((1e-6, 0.8 if sampling.whole else 0.75), (0.97e-4, 0.7)):
        counts = answers(names, kind, size, 1e-4)
        assert wrong_answers(counts) == 0
        assert sum(n for (_, full), n in counts.items() if full is not None) >= share * len(names)


def test_noisy_data_near_full_and_not_full_pairs_are_not_called_full() -> None:
    rng = np.random.default_rng(9)
    for _ in range(8):  # here rho(h) is noise only, with eigenvectors or without
        assert with_noise("heisenberg(1)/R", 1e-10, rng).full is not True
    assert with_noise("affine(strict(3))", 5e-10, rng).full is None  # a limit of conjugates of affine(so(3))


def limits(name: str, weights: Any, t: float) -> Any:
    """The table of matrices of g/h, conjugated by diag(t^weights), with the translations of g/h, and the rows of h."""
    pair = lh.pair(name)
    d, power = pair.dimension, t ** np.asarray(weights, dtype=float)
    moved = np.array([a.to_numpy() * power[:, None] / power for a in pair.isotropy_matrices()])
    basis = orthonormal_span(moved / np.linalg.norm(moved, axis=(1, 2), keepdims=True), 1e-13)[1]
    m = len(basis)
    constants = np.zeros((m + d, m + d, m + d))
    products = np.einsum("aij,bjk->abik", basis, basis)
    brackets = (products - products.transpose(1, 0, 2, 3)).reshape(m, m, d * d)
    constants[:m, :m, :m] = brackets @ basis.reshape(m, d * d).T
    constants[:m, m:, m:] = basis.transpose(0, 2, 1)
    constants[m:, :m, m:] = -constants[:m, m:, m:].transpose(1, 0, 2)
    return constants, np.eye(m + d)[:m]


@pytest.mark.parametrize("name", ["so(3)", "so(4)", "su(2)", "u(2)", "so(3)+R"])
def test_a_full_pair_is_undecided_if_a_limit_of_its_conjugates_is_within_the_error(name: str) -> None:
    """Conjugates by diag(t^w) are full for t > 0; limits at t = 0 preserve subspaces, so they are not full."""
    rng, answered, d = np.random.default_rng(len(name)), Counter[Any](), lh.pair(f"affine({name})").dimension
    for _ in range(12 if sampling.whole else 2):
        weights = rng.permutation([0, 1, *rng.integers(0, 2, d - 2)])
        full, rows = limits(f"affine({name})", weights, 10.0 ** rng.uniform(-3, -2))
        limit, k = limits(f"affine({name})", weights, 1e-9)[0], len(rows)
        # the bases of the two spans are independent: take the nearest one of the limit
        left, _, right = np.linalg.svd(np.einsum("ajl,bjl->ab", full[:k, k:, k:], limit[:k, k:, k:]))
        limit = rotated(limit, rows, np.block([[left @ right, np.zeros((k, d))], [np.zeros((d, k)), np.eye(d)]]))[0]
        distance, turn = float(np.linalg.norm(full - limit) / np.linalg.norm(full)), rotation(k + d, rng)
        for share in (1.01, 0.1, 1e-4):
            field = lh.FloatField(max(1e-12, share * distance))
            verdict = lh.decide_fullness(pair_of(*rotated(full, rows, turn), field))
            assert verdict.full is None or (share < 1 if verdict.full else "rounding alone" in verdict.reason), verdict
            answered[share, verdict.full] += 1
            near = lh.decide_fullness(pair_of(*rotated(limit, rows, turn), field))
            assert near.full is None or (not near.full and "rounding alone" in near.reason), near
    assert answered[1e-4, True] > 0


# -- families that degenerate -------------------------------------------------------------------------------
def test_a_full_family_becomes_undecided_before_it_is_called_not_full() -> None:
    turn = rotation(3, np.random.default_rng(4))
    answers = []
    for exponent in range(12):
        verdict = verdict_of(*rotated(plane_turn(10.0**-exponent), axes(3, 0), turn))
        answers.append(verdict.full)
        assert verdict.gap == pytest.approx(verdict.smallest / verdict.tolerance)
        assert (verdict.gap >= 1.5) == (verdict.full is True)
    undecided = answers.index(None)
    assert answers[:undecided] == [True] * undecided
    assert undecided == 9  # t = 1e-9 is the error
    assert answers[undecided:] == [None] * (12 - undecided)


@pytest.mark.parametrize("t", [0.0, -1e-8, -1e-4, -1.0])
def test_a_family_that_is_not_full_is_not_full_at_every_parameter(t: float) -> None:
    rng = np.random.default_rng(5)
    for _ in range(3):
        assert verdict_of(*rotated(plane_turn(t), axes(3, 0), rotation(3, rng))).full is False


def test_undecided_has_no_boolean_and_says_what_it_rests_on() -> None:
    verdict = verdict_of(plane_turn(1e-9), axes(3, 0))
    assert verdict.full is None
    assert verdict.certificate is None
    assert isinstance(verdict, lh.fullness.NumericallyUndecided)
    assert f"{verdict.tolerance:.1e}" in str(verdict)
    assert f"{verdict.gap:.1e}" in str(verdict)
    assert str(verdict).startswith("undecided (numerical")
    for question in (lambda: bool(verdict), verdict.verify):
        with pytest.raises(UndecidedError, match=r"undecided.*rationalize|no certificate"):
            question()
    data = json.loads(json.dumps(verdict.to_json()))
    assert (data["full"], data["proved"], data["certificate"]) == (None, False, None)
    assert data["gap"] == verdict.gap < 1.5
    assert data["tolerance"] == verdict.tolerance


def test_a_coarse_field_has_a_coarse_answer() -> None:
    coarse = lh.FloatField(rtol=1e-3)
    for t, full in ((1.0, True), (1e-4, None)):
        assert lh.decide_fullness(pair_of(plane_turn(t), axes(3, 0), coarse)).full is full


# -- noise --------------------------------------------------------------------------------------------------
def test_noise_in_place_of_an_isotropy_matrix_is_never_a_reason_for_full() -> None:
    noisy = table(4, (0, 3, 2, 1.0), (1, 2, 3, 1e-17))
    assert verdict_of(noisy, axes(4, 0, 1)).full is not True
    rng = np.random.default_rng(6)
    for _ in range(5):
        assert verdict_of(*rotated(noisy, axes(4, 0, 1), rotation(4, rng))).full is not True


@pytest.mark.parametrize(("constants", "members"), [
    (table(4, (0, 3, 2, 1.0)), (0, 1)),  # a nilpotent element and an ineffective one
    (table(5, (0, 3, 2, 1.0), (0, 4, 3, 1.0)), (0, 1)),
    (table(5, (0, 1, 2, 1.0)), (0, 2)),  # heisenberg + R^2
    (table(5, (0, 1, 0, 1.0)), (0, 1)),  # h acts trivially
    (table(4), (0,)),
])  # fmt: skip
def test_nilpotent_and_ineffective_elements_in_random_bases_are_not_full(constants: Any, members: Any) -> None:
    rng = np.random.default_rng(7)
    n = len(constants)
    for exponent in (-12, -3, 0, 5, 12):
        turned = rotated(constants, axes(n, *members), rotation(n, rng), 10.0**exponent)
        assert verdict_of(*turned).full is False


# -- the parts ----------------------------------------------------------------------------------------------
def acted(table: Any, left: Any, right: Any, projection: Any) -> Any:
    """The matrices of the rows of `left` on the span of the rows of `right`, in the coordinates of a projection."""
    return np.einsum("ai,bj,ijl,lc->acb", left, right, table, projection)


@pytest.mark.parametrize("rtol", [1e-6, 1e-2])
@pytest.mark.parametrize("name", ["sp(2,R)/u(1)", "affine(spiral(1,1))", "so(4)/u(2)", "sl(3)/P1", "su(2,1)/u(1,1)"])
def test_the_isotropy_of_every_pair_within_the_error_is_in_the_enclosure(name: str, rtol: float) -> None:
    rng = np.random.default_rng(len(name))
    constants, rows = constants_of(lh.pair(name))
    meant, largest = rotated(constants, rows, rotation(len(constants), rng)), 0.0
    for _ in range(4):
        measured, given = noisy(*meant, 0.99 * rtol, rng)
        action = float_action(lh.Pair(algebra := lh.LieAlgebra(measured, field=lh.FloatField(rtol)), given.tolist()))
        z, w = algebra.subalgebra(given.tolist()).quotient().subspace.to_numpy(), action.lift
        graph = np.linalg.solve(meant[1] @ z.T, meant[1] @ w.T)  # of the subalgebra that is meant
        basis = z + graph @ w
        of_rho = acted(meant[0], basis, w, w.T - z.T @ graph) - acted(measured, z, w, w.T)
        of_ad = acted(meant[0], basis, basis, z.T) - acted(measured, z, z, z.T)
        units = rng.standard_normal((40, len(w)))
        for x in units / np.linalg.norm(units, axis=1, keepdims=True):
            largest = max(largest, float(np.linalg.norm(of_rho @ x)) / action.rho.error)
        units = rng.standard_normal((40, len(z)))
        for x in units / np.linalg.norm(units, axis=1, keepdims=True):
            largest = max(largest, float(np.linalg.norm(np.tensordot(x, of_rho, 1))) / action.rho.error)
            largest = max(largest, float(np.linalg.norm(np.tensordot(x, of_ad, 1))) / action.ad.error)
    assert 0.05 < largest <= 1


def test_real_parts_of_all_matrices_within_the_error_are_in_the_intervals() -> None:
    rng = np.random.default_rng(2)
    for _ in range(20):
        change = rng.standard_normal((5, 5)) + 2 * np.eye(5)
        center = change @ np.diag([3.0, 3.0, 1.0, -2.0, -2.0]) @ np.linalg.inv(change)
        moves = 1e-3 * rng.standard_normal((2, 5, 5))
        parts = real_parts(Enclosure(center, 1e-3, moves))
        assert sum(number for _, _, number in parts) == 5
        for _ in range(20):
            error, y = rng.standard_normal((5, 5)), rng.standard_normal(2)
            y = y / np.linalg.norm(y)
            values = np.linalg.eigvals(center + 1e-3 * error / np.linalg.norm(error) + np.tensordot(y, moves, 1))
            for low, high, number in parts:
                assert ((low <= values.real) & (values.real <= high)).sum() >= number
    exact = real_parts(Enclosure(np.diag([3.0, 1.0, 1.0]), 1e-9, np.zeros((0, 3, 3))))
    assert [number for _, _, number in exact] == [2, 1]
    assert exact[0][1] < 1 + 1e-8 and exact[1][0] > 3 - 1e-8


def test_the_span_of_a_conjugated_reductive_algebra_has_a_self_adjoint_position() -> None:
    rng = np.random.default_rng(3)
    skew = np.array([(a := rng.standard_normal((4, 4))) - a.T for _ in range(6)])
    for condition in (10.0, 1e3):
        change = np.diag(np.geomspace(1, condition, 4)) @ rotation(4, rng)
        moved = np.linalg.inv(change) @ skew @ change
        g = self_adjoint_position(moved / np.linalg.norm(moved, axis=(1, 2), keepdims=True))
        assert np.linalg.cond(g @ np.linalg.inv(change)) == pytest.approx(1, rel=1e-6)
        result = transitive_group(Enclosure(moved, 1e-12 * float(np.linalg.norm(moved)), np.zeros((0, *moved.shape))))
        assert result is not None
        assert result.value == pytest.approx(0.5**0.5)


def test_least_singular_value_reaches_rounding_at_simple_and_multiple_zeros() -> None:
    for name in ("affine(S3(gl(2)))", "so(3,1)/so(2,1)", "sl(3)/B", "su(2,1)/P", "affine(strict(3))"):
        pair = lh.pair(name)
        matrices = np.array([np.eye(pair.dimension), *(a.to_numpy() for a in pair.isotropy_matrices())])
        value, x = least_singular_value(matrices, starts=20, seed=1)
        assert value < 1e-14
        assert np.linalg.svd((matrices @ x).T, compute_uv=False)[-1] < 1e-14


def test_random_pairs_have_no_wrong_answer_and_few_undecided_ones() -> None:
    counts = compared(range(8 * (8 if sampling.whole else 1)))
    assert wrong(counts) == 0
    assert sum(n for (_, _, result), n in counts.items() if result is None) <= sum(counts.values()) // 8


@pytest.mark.parametrize("question", [lh.failure_report, lh.orbits.failure_cone])
def test_where_it_fails_is_not_answered_over_floats(question: Any) -> None:
    with pytest.raises(UndecidedError, match="rationalize"):
        question(pair_of(*constants_of(lh.pair("so(3,1)/so(2,1)"))))


def test_the_tolerance_of_a_verdict_is_that_of_the_field() -> None:
    verdict = lh.decide_fullness(lh.Pair(lh.abelian(2).over(lh.RR), []))
    assert verdict.smallest == 0 and verdict.tolerance == pytest.approx(lh.RR.rtol) and verdict.gap > 1e290
