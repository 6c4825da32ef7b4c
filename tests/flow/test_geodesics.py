"""Geodesics against closed formulas: great circles, Berger spheres, and what invariance conserves."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.linalg import expm

import liehom as lh
from tests.exact.geometry.spaces import su_flag

TIMES = np.linspace(0, 7, 15)


@pytest.mark.parametrize("n", [2, 3, 4])
@pytest.mark.parametrize("exact", [True, False])
def test_great_circles(n: int, exact: bool) -> None:
    rho = lh.defining(lh.so(n + 1))
    point = [0] * n + [1]
    metric = rho.pair(point).invariant_metrics()([1])
    x = ["3/5", "4/5"] + ["0"] * (n - 2) if exact else [0.6, 0.8] + [0.0] * (n - 2)
    curve = lh.geodesic(metric, x, (0, 7), representation=rho, t_eval=TIMES, rtol=1e-12, atol=1e-12)
    assert curve.homogeneous is exact and np.array_equal(curve.t, TIMES)
    points = curve.points(point)
    start = (points[1] - np.cos(TIMES[1]) * points[0]) / np.sin(TIMES[1])
    assert np.allclose(points, np.outer(np.cos(TIMES), points[0]) + np.outer(np.sin(TIMES), start), atol=1e-10)
    assert np.allclose(np.linalg.norm(start), 1) and np.allclose(curve.speeds(), 1, atol=1e-11)


@pytest.mark.parametrize("parameter", ["1/4", "1", "2", "5"])
def test_berger_spheres(parameter: str) -> None:
    """g(t) = exp(t (x + c x_3 e_3)) exp(-t c x_3 e_3) for lengths |e_1| = |e_2| = 1, |e_3|^2 = 1 + c."""
    su2 = lh.su(2)
    rho = lh.defining(su2)
    metrics = lh.Pair(su2, []).invariant_metrics()
    form = np.diag([lh.QQ.one, lh.QQ.one, lh.QQ.convert(parameter)])
    metric = metrics(metrics.coordinates(form))
    x = np.array([0.3, -0.5, 0.8])
    curve = lh.geodesic(metric, x, (0, 7), representation=rho, t_eval=TIMES, rtol=1e-12, atol=1e-12)
    e = [np.array(m.to_rows(), dtype=float) for m in rho.matrices]
    turn = float(lh.QQ.convert(parameter) - 1) * x[2] * e[2]
    moved = sum(a * b for a, b in zip(x, e, strict=True)) + turn
    expected = [expm(t * moved) @ expm(-t * turn) for t in TIMES]
    assert np.allclose(curve.group, expected, atol=1e-9)


def noether(curve: lh.geodesics.Geodesic) -> np.ndarray:
    """Ad(g)^* mu with g in the adjoint representation."""
    return np.array([np.linalg.solve(g.T, m) for g, m in zip(curve.group, curve.momenta, strict=True)])


def test_momenta_of_killing_fields_are_conserved_to_round_off_and_the_speed_to_the_order() -> None:
    metric = su_flag(1, 1, 1).invariant_metrics()([1, 2, 4])
    ranges = []
    for dt in (0.1, 0.05):
        curve = lh.geodesic(metric, [0.3, 0.4, -0.1, 0.2, 0.5, 0.1], (0, 4), dt=dt, step="rk4")
        assert np.ptp(noether(curve), axis=0).max() < 1e-13
        ranges.append(np.ptp(curve.speeds()))
    assert 1e-10 < ranges[1] < ranges[0] / 10


def test_curve_satisfies_the_geodesic_equation() -> None:
    """x' = -Lambda(x) x with the Levi-Civita connection, by central differences."""
    metric = su_flag(1, 1, 1).invariant_metrics()([1, 2, 4])
    times = np.linspace(0, 2, 2001)
    curve = lh.geodesic(metric, [0.3, 0.4, -0.1, 0.2, 0.5, 0.1], (0, 2), t_eval=times, rtol=1e-12, atol=1e-12)
    x = curve.velocities
    connection = np.array(metric.connection(), dtype=float)
    slope = (x[2:] - x[:-2]) / (times[2] - times[0])
    assert np.allclose(slope, -np.einsum("ki,kj,ijl->kl", x[1:-1], x[1:-1], connection), atol=1e-5)


@settings(max_examples=15, deadline=None)
@given(st.lists(st.integers(-3, 3), min_size=6, max_size=6))
def test_geodesic_vectors_satisfy_their_equation(x: list[int]) -> None:
    """On SU(3)/T^2 every vector has one for the Killing metric; for others X, if found, has <[X, Y]_m, x> = 0."""
    pair = su_flag(1, 1, 1)
    metrics, g, m = pair.invariant_metrics(), pair.algebra, pair.reductive_complement().rows()
    assert metrics([1, 1, 1]).geodesic_vector(x) is not None
    metric = metrics([1, 2, 4])
    vector = metric.geodesic_vector(x)
    velocity = [sum(c * row[i] for c, row in zip(x, m, strict=True)) for i in range(8)]
    on_m = np.asarray(metrics.split.coordinates)
    if vector is None:
        return
    assert not (np.array(vector - velocity) @ on_m).any()
    for y in m:
        assert (np.asarray(g.bracket(vector, y)) @ on_m) @ metric.matrix() @ np.array(x) == 0


def test_metric_without_homogeneous_geodesics_in_general() -> None:
    metric = su_flag(1, 1, 1).invariant_metrics()([1, 2, 4])
    assert metric.geodesic_vector([1, 0, 1, 0, 1, 0]) is None
    assert metric.geodesic_vector([1, 1, 0, 0, 0, 0]) is not None


def test_irrational_metric() -> None:
    metric = lh.pair("su(3)/su(2)").invariant_metrics()([1, "sqrt(2)"])
    assert metric.geodesic_vector([1, 0, "sqrt(2)", 0, 1]) is not None  # naturally reductive for U(3)
    curve = lh.geodesic(metric, [1, 0, 0, 1, 1], (0, 1))
    assert np.ptp(curve.speeds()) < 1e-7


def test_wrong_arguments() -> None:
    rho = lh.defining(lh.so(3))
    metric = rho.pair([0, 0, 1]).invariant_metrics()([1])
    with pytest.raises(lh.InputError, match="invariant metric"):
        lh.geodesic(rho, [1, 0], (0, 1))  # type: ignore[arg-type]
    with pytest.raises(lh.ShapeError, match="2 coordinates"):
        lh.geodesic(metric, [1.0, 0, 0], (0, 1))
    with pytest.raises(lh.ShapeError, match="2 coordinates"):
        lh.geodesic(metric, [1, 0, 0], (0, 1))
    with pytest.raises(lh.InputError, match="the representation is of"):
        lh.geodesic(metric, [1, 0], (0, 1), representation=lh.defining(lh.so(4)))
    curve = lh.geodesic(metric, [1, 0], (0, 1), representation=rho)
    with pytest.raises(lh.InputError, match="does not fix"):
        curve.points([1, 0, 0])
    with pytest.raises(lh.ShapeError, match="3 coordinates"):
        curve.points([1, 0])
    generic = lh.pair("su(3)/su(2)").invariant_metrics().generic()
    with pytest.raises(lh.FieldError, match="give numbers"):
        lh.geodesic(generic, [1, 0, 0, 0, 0], (0, 1))
