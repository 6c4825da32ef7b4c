"""Invariant Einstein metrics against the counts of the literature, each verified by two other computations of Ricci."""

import random
from collections.abc import Callable

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.testing import random_unimodular
from tests.exact.geometry.spaces import (
    EINSTEIN,
    aloff_wallach,
    diagonal,
    ledger_obata,
    product_of_spheres,
    stiefel,
    su_flag,
)

DIGITS = 30


def precise(value: object) -> mpmath.mpf:
    """A number of an exact field with 30 digits and some more."""
    with mpmath.workdps(DIGITS + 10):
        if not hasattr(value, "field"):
            return mpmath.mpf(int(value.p)) / int(value.q)  # type: ignore[attr-defined]
        ball = value.field.ball(value, 4 * (DIGITS + 10))
        middle = ball.mid().fmpq()
        return mpmath.mpf(int(middle.p)) / int(middle.q)


def array(table: object) -> np.ndarray:
    source = np.asarray(table, dtype=object)
    out = np.empty(source.shape, dtype=object)
    out.reshape(-1)[:] = [precise(x) for x in source.reshape(-1)]
    return out


def koszul_ricci(metric: object) -> np.ndarray:
    """Ric(e_a, e_a) in an orthonormal frame, as the sum of sectional curvatures of planes by brackets of g.

    <R(X, Y) Y, X> is the sum of -3/4 |[X, Y]_m|^2, -1/2 <[X, [X, Y]]_m, Y>, -1/2 <[Y, [Y, X]]_m, X>, |U(X, Y)|^2 and
    -<U(X, X), U(Y, Y)>.
    """
    pair = metric.metrics.pair
    g, m = pair.algebra, pair.reductive_complement().basis
    h, n, d = pair.subalgebra.basis, g.dimension, pair.dimension
    rows = np.vstack([np.asarray(h).reshape(-1, n), np.asarray(m)])
    inverse = np.asarray(g.field.matrix(rows, (n, n)).inverse())
    table = array(g.table.flat()).reshape(n, n, n)
    with mpmath.workdps(DIGITS + 10):
        lower = mpmath.cholesky(mpmath.matrix(array(metric.matrix()).tolist()))
        frame = np.array((lower**-1).tolist(), dtype=object).reshape(d, d) @ array(m)  # orthonormal rows in g
        dual = array(inverse)[:, n - d :] @ np.array(lower.tolist(), dtype=object).reshape(d, d)  # coordinates mod h
        acting = np.tensordot(frame, table, 1)  # ad of the frame
        brackets = np.array([frame @ a for a in acting])
        inside = brackets @ dual
        twice = np.array([b @ a for a, b in zip(acting, brackets, strict=True)]) @ dual  # [X, [X, Y]]_m
        u = np.array(
            [[[(inside[c, a, b] + inside[c, b, a]) / 2 for c in range(d)] for b in range(d)] for a in range(d)]
        )
        values = []
        for a in range(d):
            total = mpmath.mpf(0)
            for b in range(d):
                total += -mpmath.mpf(3) / 4 * (inside[a, b] @ inside[a, b]) + u[a, b] @ u[a, b] - u[a, a] @ u[b, b]
                total -= (twice[a, b, b] + twice[b, a, a]) / 2
            values.append(total)
    return np.array(values)


@pytest.mark.parametrize(("name", "pair", "count", "kinds", "source"), EINSTEIN, ids=[row[0] for row in EINSTEIN])
def test_counts_of_the_literature_and_three_computations_of_ricci(
    name: str, pair: Callable[[], lh.Pair], count: int, kinds: int, source: str
) -> None:
    found = pair().invariant_metrics().einstein()
    assert found.complete
    assert (len(found), found.kinds) == (count, kinds), source
    for member in found:
        assert member.verify()
        constant = precise(member.constant)
        assert all(
            abs(x - constant) < mpmath.mpf(10) ** -DIGITS * (1 + abs(constant)) for x in koszul_ricci(member.metric)
        )
        assert_critical(member.metric, member.constant)


def test_the_table_has_enough_rows_with_a_source() -> None:
    published = [row for row in EINSTEIN if row[4] != "computed"]
    assert len(published) >= 25
    assert len([row for row in published if row[4] != "Schur"]) >= 15


def assert_critical(metric: object, constant: object) -> None:
    """The derivative of the scalar curvature in the direction F is -<Ric, F>, here by exact central differences."""
    metrics, step = metric.metrics, metric.field.convert("1/1000000000000")
    inverse = np.asarray(metric.field.matrix(metric.matrix(), metric.matrix().shape).inverse())
    for a, form in enumerate(metrics.basis):
        ends = []
        for sign in (1, -1):
            moved = [x + (sign * step if b == a else 0) for b, x in enumerate(metric.parameters)]
            ends.append(metrics(moved).scalar())
        slope = precise((ends[0] - ends[1]) / (2 * step))
        expected = -precise(constant * (inverse * np.asarray(form)).sum())
        assert abs(slope - expected) < 1e-12 * (1 + abs(expected))


def test_flag_manifold_has_three_kaehler_metrics_and_the_normal_one() -> None:
    found = su_flag(1, 1, 1).invariant_metrics().einstein()
    shapes = sorted((sorted(map(precise, m.parameters)), m.metric.kaehler_form() is not None) for m in found)
    assert shapes == [([0.5, 0.5, 1], True), ([1, 1, 1], False), ([1, 1, 2], True), ([1, 1, 2], True)]


@pytest.mark.parametrize("pair", [stiefel(4), product_of_spheres(1, 1), product_of_spheres(1, -1)])
def test_gauge_orbits_are_met_in_several_points_of_one_kind(pair: lh.Pair) -> None:
    """V_2(R^4) = S^3 x S^2 has the product metric and Kobayashi's, in each basis; one orbit is met in four points.

    A slice is oblique in the second and third basis: there elimination divides by a parameter that vanishes at
    Kobayashi's metric.
    """
    found = pair.invariant_metrics().einstein()
    assert found.complete
    assert (len(found), found.kinds) == (5, 2)
    assert all(m.verify() for m in found)
    # c^5 det g is 4096/729 for Kobayashi's metric, in units in which it is 8 for the product
    volumes = [float(precise(m.constant) ** 5 * determinant(m.metric)) for m in found]
    assert sorted(v / max(volumes) for v in volumes) == pytest.approx([512 / 729, 1, 1, 1, 1])


def determinant(metric: object) -> mpmath.mpf:
    return precise(metric.field.matrix(metric.matrix(), metric.matrix().shape).determinant())


def test_too_many_parameters_give_a_lower_bound() -> None:
    found = aloff_wallach(1, 1).invariant_metrics().einstein()
    assert not found.complete
    assert len(found) == found.kinds == 2
    assert "parameters" in found.reason
    assert repr(found).startswith("<at least 2")
    assert all(m.verify() for m in found)


def test_limit_of_time_is_an_error() -> None:
    metrics = su_flag(1, 1, 1).invariant_metrics()
    with lh.limits(seconds=0), pytest.raises(lh.LimitError):
        metrics.einstein()


def test_two_parameters_without_a_definite_metric_prove_nothing() -> None:
    sheets = lh.Pair(lh.catalog.algebra("sl(2)+sl(2)"), [[0, 0, 1, 0, 0, 0], [0, 0, 0, 0, 0, 1]])
    found = sheets.invariant_metrics().einstein()
    assert len(found) == 0 and not found.complete
    assert lh.Pair(lh.sl(2), [[0, 0, 1]]).invariant_metrics().einstein().complete


def test_no_einstein_metric_on_the_heisenberg_group() -> None:
    found = lh.Pair(lh.heisenberg(1), []).invariant_metrics().einstein()
    assert len(found) == 0
    assert not found.complete  # the gauge group is not compact


def test_hyperbolic_space_is_einstein_with_a_negative_constant() -> None:
    found = lh.pair("so(3,1)/so(3)").invariant_metrics().einstein()
    assert [m.constant < 0 for m in found] == [True]


def test_pair_without_a_definite_metric() -> None:
    found = lh.pair("iso(3,1)/so(3,1)").invariant_metrics().einstein()
    assert (len(found), found.complete) == (0, True)


def test_products_of_ledger_and_obata_have_a_nearly_kaehler_metric() -> None:
    """Of four metrics one is the Killing form; the other three are permuted by the group S_3 of the factors."""
    found = ledger_obata(3).invariant_metrics().einstein()
    assert sorted([m.kind for m in found].count(k) for k in range(2)) == [1, 3]


def test_pair_over_a_number_field_with_several_metrics_is_refused() -> None:
    pair = su_flag(1, 1, 1)
    over = lh.Pair(pair.algebra.over(lh.number_field("sqrt(2)")), pair.subalgebra.rows())
    with pytest.raises(lh.UndecidedError, match="rational structure constants"):
        over.invariant_metrics().einstein()


def test_number_of_metrics_does_not_depend_on_the_basis() -> None:
    pair = su_flag(1, 1, 2)
    n = pair.algebra.dimension
    rows = [[int(i == j) + int(j == i + 1) - 2 * int(j == i - 3) for j in range(n)] for i in range(n)]
    found = pair.change_of_basis(rows).invariant_metrics().einstein()
    assert (len(found), found.kinds, found.complete) == (4, 3, True)


@settings(max_examples=8, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([(stiefel(4), 2), (product_of_spheres(1, 1), 2), (ledger_obata(3), 2)]))
def test_kinds_do_not_depend_on_the_basis_where_summands_are_equivalent(seed: int, case: tuple[lh.Pair, int]) -> None:
    """The slices of the gauge group are other ones in each basis; a computation that does not end says so."""
    pair, kinds = case
    change = random_unimodular(pair.algebra.dimension, random.Random(seed), 3)
    found = pair.change_of_basis(change).invariant_metrics().einstein()
    assert found.kinds == kinds if found.complete else found.kinds <= kinds
    assert all(m.verify() for m in found)


def test_elements_of_the_torus_are_traceless() -> None:
    """A control of the table: its matrices lie in su(n)."""
    with pytest.raises(lh.errors.NotInSpanError):
        lh.defining(lh.su(2)).element(diagonal([1, 1]))
