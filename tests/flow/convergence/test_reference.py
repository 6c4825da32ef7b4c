"""The reference solution against closed forms, scipy and itself; the distance from an orbit against brute force."""

from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar
from scipy.special import ellipj

import liehom as lh
from liehom.base.errors import ConvergenceError, InputError, ShapeError
from liehom.flow.convergence.reference import Reference, orbit_distance
from tests.sampling import examples

INERTIA = np.array([1.0, 2.0, 3.0])
START = np.array([0.6, 0.0, 0.8])
HYPERBOLOID = lh.defining(lh.so(2, 1))


def rigid_body() -> lh.GeneratorField:
    return lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / INERTIA)


def forced() -> lh.GeneratorField:
    return lh.GeneratorField(lh.defining(lh.so(3)), lambda m, t: m * [1.0, 2.0, 3.0] + np.sin(2 * t)[..., None])


def on_hyperboloid() -> lh.GeneratorField:
    return lh.GeneratorField(HYPERBOLOID, ["m0/2", "1/2 - m1/5", "m0*m1/5"])


def scipy_solution(field: lh.GeneratorField, m: Any, t0: float, t: float) -> Any:
    def slope(time: float, y: Any) -> Any:
        return field.vector(y.reshape(m.shape), np.full(m.shape[:-1], time)).ravel()

    return solve_ivp(slope, (t0, t), m.ravel(), method="DOP853", rtol=1e-13, atol=1e-15).y[:, -1].reshape(m.shape)


def sphere(count: int, seed: int = 3) -> Any:
    m = np.random.default_rng(seed).normal(size=(count, 3))
    return m / np.linalg.norm(m, axis=-1, keepdims=True)


# -- the solution ----------------------------------------------------------------------------------------
@pytest.mark.parametrize("t", [0.5, 10.0, -7.0])
def test_rigid_body_in_elliptic_functions(t: float) -> None:
    """Euler's equations from (a, 0, c): m = (a dn, b sn, c cn)(p t)."""
    a, c = START[0], START[2]
    i1, i2, i3 = INERTIA
    b = np.sqrt((1 / i1 - 1 / i3) / (1 / i1 - 1 / i2)) * c
    p = (1 / i1 - 1 / i2) * a * b / c
    modulus = (1 / i2 - 1 / i3) * b * c / (a * p)
    sn, cn, dn, _ = ellipj(p * t, modulus)
    assert np.abs(Reference(rigid_body(), START)(t) - [a * dn, b * sn, c * cn]).max() < 2e-15 * (1 + abs(t))


@pytest.mark.parametrize("dtype", [np.float64, np.longdouble])
@pytest.mark.parametrize("t", [3, -2])
def test_linear_field_is_a_matrix_exponential(t: int, dtype: Any) -> None:
    """In 40 digits: scipy's expm is off by 2e-13 here."""
    rho = lh.defining(lh.sl(3))
    x = np.array([1.0, -0.5, 0.25, 0.125, 0.75, -0.5, 0.5, 0.625])
    start = np.array([[1.0, 0.0, 2.0], [0.0, -1.0, 1.0]])
    matrix = sum(c * a.to_numpy() for c, a in zip(x, rho.matrices, strict=True))
    with mpmath.workdps(40):
        wanted = mpmath.matrix(start.tolist()) * mpmath.expm(t * mpmath.matrix(matrix.tolist()), method="taylor").T
        high = np.array(wanted.tolist(), dtype=float)
        low = np.array((wanted - mpmath.matrix(high.tolist())).tolist(), dtype=float)
    ref = Reference(lh.GeneratorField(rho, x), start.astype(dtype))
    error = np.linalg.norm(ref(t) - high.astype(dtype) - low, axis=-1)
    assert np.all(error < 50 * np.finfo(dtype).eps * np.linalg.norm(high, axis=-1))
    assert np.all(error < 3 * ref.accuracy(t))


@pytest.mark.parametrize("t0", [0.0, 0.75])
@pytest.mark.parametrize("t", [2.0, -1.5])
@pytest.mark.parametrize("make", [rigid_body, forced])
def test_ensembles_agree_with_scipy(make: Any, t: float, t0: float) -> None:
    field, start = make(), sphere(4)
    assert np.abs(Reference(field, start, t0)(t) - scipy_solution(field, start, t0, t)).max() < 1e-12


def test_on_a_noncompact_space() -> None:
    start = np.array([0.3, -0.2, np.sqrt(1.13)])
    ref = Reference(on_hyperboloid(), start)
    assert np.abs(ref(1.5) - scipy_solution(on_hyperboloid(), start, 0, 1.5)).max() < 1e-11
    assert ref.accuracy(1.5) < 1e-14


def test_extended_precision() -> None:
    field = lh.GeneratorField(lh.defining(lh.so(2)), ["1/3"])
    t = np.longdouble(20)
    found = Reference(field, np.array([1, 0], dtype=np.longdouble))(t)
    assert found.dtype == np.longdouble
    wanted = np.array([np.cos(t / 3), np.sin(t / 3)])
    assert np.abs(found - wanted).max() < 40 * np.finfo(np.longdouble).eps


def test_every_trajectory_at_its_own_time() -> None:
    start, times = sphere(5), np.array([0.0, 3.0, -2.0, 0.5, 1.0])
    ref = Reference(rigid_body(), start)
    made = ref(times)
    assert made.shape == (5, 3)
    for i, (m, t) in enumerate(zip(start, times, strict=True)):
        assert np.abs(made[i] - Reference(rigid_body(), m)(t)).max() < 1e-14
    many = ref(np.linspace(-1, 1, 7)[:, None])
    assert many.shape == (7, 5, 3)
    assert np.array_equal(many[0], ref(-1.0))


def test_it_extends_itself_without_changing() -> None:
    ref = Reference(rigid_body(), START)
    before = ref(1.0)
    ref(30.0), ref(-30.0)
    assert np.array_equal(ref(1.0), before)
    assert np.array_equal(ref(0.0), START)


def test_derivatives() -> None:
    field, times = forced(), np.linspace(-2, 2, 9)
    ref = Reference(field, START)
    assert np.abs(ref.derivative(times) - field.vector(ref(times), times)).max() < 1e-13
    step = 1e-5
    second = (ref.derivative(times + step) - ref.derivative(times - step)) / (2 * step)
    assert np.abs(ref.derivative(times, 2) - second).max() < 1e-8
    assert np.array_equal(ref.derivative(times, 0), ref(times))


def test_longest_pieces_end_where_the_series_does() -> None:
    """m' = m^2 from 1 is 1 / (1 - t): it is followed close to 1 and no further."""
    ref = Reference(lh.GeneratorField(lh.defining(lh.gl(1)), ["m0"]), [1.0])
    assert ref(0.999)[0] == pytest.approx(1000, rel=1e-11)
    assert ref(-5.0)[0] == pytest.approx(1 / 6, rel=1e-14)
    with pytest.raises(ConvergenceError, match="cannot be continued"):
        ref(1.5)
    assert ref(0.5)[0] == pytest.approx(2, rel=1e-14)


@pytest.mark.parametrize("psi", [["m0*m1", "0", "0"], ["t*m0", "0", "0"]])
def test_equilibria_stay(psi: list[str]) -> None:
    ref = Reference(lh.GeneratorField(lh.defining(lh.so(3)), psi), [0.0, 0.0, 1.0])
    assert ref([5.0, -5.0, 1e6]).tolist() == [[0.0, 0.0, 1.0]] * 3


def test_polynomial_solutions() -> None:
    shear = lh.Representation.from_matrices([[[0, 1], [0, 0]]])
    ref = Reference(lh.GeneratorField(shear, ["1"]), [1.0, 2.0])
    assert ref([3.0, 300.0]).tolist() == [[7.0, 2.0], [601.0, 2.0]]


# -- its accuracy ----------------------------------------------------------------------------------------
@pytest.mark.parametrize(("order", "tolerance"), [(4, 1e-7), (6, 1e-6), (8, 1e-7), (10, 1e-10), (12, 1e-12)])
def test_the_stated_accuracy_is_that_of_the_error(order: int, tolerance: float) -> None:
    rough = Reference(rigid_body(), sphere(6), order=order, tolerance=tolerance)
    fine = Reference(rigid_body(), sphere(6))
    for t in (0.3, 4.0, -6.0):
        error = np.linalg.norm(rough(t) - fine(t), axis=-1)
        stated = rough.accuracy(t)
        assert stated.shape == (6,)
        assert np.all(error < 2 * stated + 1e-15)
        assert np.all(stated < 1e3 * tolerance)


def test_the_accuracy_does_not_improve_with_time() -> None:
    stated = Reference(rigid_body(), START, order=6, tolerance=1e-6).accuracy(np.linspace(0, 20, 40))
    assert np.all(stated > 0) and stated[-1] >= 0.5 * np.maximum.accumulate(stated)[-1]


@pytest.mark.parametrize("dtype", [np.float64, np.longdouble])
def test_to_round_off_by_default(dtype: Any) -> None:
    assert Reference(rigid_body(), START.astype(dtype)).accuracy(10.0) < 20 * np.finfo(dtype).eps


def test_a_generator_in_too_low_precision_is_seen() -> None:
    """Round-off of the generator shows as a difference between the two solutions."""
    coarse = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / INERTIA * (1 + 1e-9 * np.sin(1e6 * m[..., :1])))
    assert Reference(coarse, START, tolerance=1e-3, order=4).accuracy(1.0) > 1e-9


# -- what is refused -------------------------------------------------------------------------------------
def test_what_is_refused() -> None:
    field = rigid_body()
    for wrong in ({"order": 3}, {"order": 20.0}, {"order": True}, {"tolerance": 0}, {"tolerance": 2}, {"t0": "now"}):
        with pytest.raises(InputError, match=next(iter(wrong))):
            Reference(field, START, **wrong)
    with pytest.raises(InputError, match="GeneratorField"):
        Reference(lambda m: m, START)  # type: ignore[arg-type]
    with pytest.raises(ShapeError):
        Reference(field, [1.0, 0.0])
    with pytest.raises(InputError, match="start"):
        Reference(field, ["a", "b", "c"])
    with pytest.raises(InputError, match="start"):
        Reference(field, [1j, 0, 0])
    ref = Reference(field, sphere(4))
    with pytest.raises(ShapeError, match="times"):
        ref(np.zeros(3))
    with pytest.raises(InputError, match="finite"):
        ref(np.nan)
    with pytest.raises(InputError, match="number"):
        ref("1")
    with pytest.raises(InputError, match="derivatives"):
        ref.derivative(1.0, -1)
    assert repr(ref).startswith("<reference of order 20, float64")


# -- the distance from an orbit --------------------------------------------------------------------------
def brute_force(ref: Reference, y: Any, low: float, high: float) -> float:
    times = np.linspace(low, high, 2001)
    k = int(np.argmin(np.linalg.norm(ref(times) - y, axis=-1)))
    near = (times[max(k - 1, 0)], times[min(k + 1, 2000)])
    return float(minimize_scalar(lambda s: float(np.linalg.norm(ref(s) - y)), bounds=near, method="bounded").fun)


@settings(max_examples=examples(60))
@given(st.floats(0.5, 8), st.floats(-0.4, 0.4), st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
def test_points_next_to_an_orbit(t: float, late: float, a: float, b: float) -> None:
    """y = F_s + a u + b v with u, v orthogonal to F_s': within the radius of curvature, distance and s come back."""
    ref = Reference(rigid_body(), START)
    s = t + late
    point, first = ref(s), ref.derivative(s)
    across = np.linalg.svd(first[None])[2][1:]
    y = point + a * across[0] + b * across[1]
    distance, found = orbit_distance(ref, y, t)
    assert distance == pytest.approx(np.hypot(a, b), rel=1e-9, abs=1e-14)
    assert abs(found - s) < 1e-6


def test_an_ensemble_against_brute_force() -> None:
    ref = Reference(rigid_body(), sphere(6))
    y = ref(2.4) + 0.05 * np.random.default_rng(1).normal(size=(6, 3))
    distance, s = orbit_distance(ref, y, 2.2)
    for i, m in enumerate(sphere(6)):
        single = Reference(rigid_body(), m)
        assert distance[i] == pytest.approx(brute_force(single, y[i], 1.4, 3.0), rel=1e-6)
        assert np.linalg.norm(single(s[i]) - y[i]) == pytest.approx(distance[i], rel=1e-12)
    assert np.all(distance <= np.linalg.norm(y - ref(2.2), axis=-1))


@pytest.mark.parametrize("size", [1e-3, 1e-8, 1e-14, 1e-100, 1e-200])
def test_next_to_an_equilibrium(size: float) -> None:
    """At (0, 1, 0) the rigid body rests, unstably; the orbit next to it is slow."""
    ref = Reference(rigid_body(), np.array([size, np.sqrt(1 - size**2), 0.0]))
    for shift in (np.zeros(3), [0, 0, 1e-3], [1e-3, 0, 0]):
        y = ref(1.0) + shift
        distance, s = orbit_distance(ref, y, 1.25)
        assert np.isfinite(distance) and 0 <= s <= 2.5
        assert distance <= np.linalg.norm(y - ref(1.25)) * (1 + 1e-15)
        assert distance <= brute_force(ref, y, 0, 2.5) + 1e-12


def test_at_an_equilibrium_the_time_stays() -> None:
    distance, s = orbit_distance(Reference(rigid_body(), [0.0, 1.0, 0.0]), [0.0, 1.0, 1e-5], 3.0)
    assert (float(distance), float(s)) == (1e-5, 3.0)


def test_the_search_does_not_pass_the_start() -> None:
    ref = Reference(rigid_body(), START)
    distance, s = orbit_distance(ref, ref(1.0), 0.4)
    assert float(s) == pytest.approx(0.8)
    assert distance == pytest.approx(np.linalg.norm(ref(0.8) - ref(1.0)))
    assert orbit_distance(ref, ref(1.0), 0.8)[0] < 1e-15
    assert orbit_distance(ref, ref(0.1), 0.0)[1] == 0


def test_a_solution_that_ends_within_the_window() -> None:
    """1 / (1 - t), asked for at 0.9: points beyond are far, and the search does not run into the pole."""
    ref = Reference(lh.GeneratorField(lh.defining(lh.gl(1)), ["m0"]), [1.0])
    distance, s = orbit_distance(ref, [50.0], 0.9)
    assert distance < 1e-12 and s == pytest.approx(0.98)
    assert orbit_distance(ref, [-1.0], 0.5)[1] == 0


def test_more_points_than_trajectories() -> None:
    ref = Reference(rigid_body(), START)
    times = np.linspace(1, 2, 5)
    distance, s = orbit_distance(ref, ref(times), times + 0.01)
    assert distance.shape == (5,)
    assert distance.max() < 1e-15 and np.abs(s - times).max() < 1e-9


def test_distances_in_extended_precision() -> None:
    ref = Reference(rigid_body(), START.astype(np.longdouble))
    distance, _ = orbit_distance(ref, ref(2.0), 1.9)
    assert distance < 20 * np.finfo(np.longdouble).eps


def test_what_the_distance_refuses() -> None:
    ref = Reference(rigid_body(), sphere(4))
    with pytest.raises(ShapeError, match="coordinates"):
        orbit_distance(ref, [1.0, 0.0], 1.0)
    with pytest.raises(ShapeError, match="fit together"):
        orbit_distance(ref, np.zeros((3, 3)), 1.0)
    with pytest.raises(InputError, match="finite"):
        orbit_distance(ref, np.full((4, 3), np.nan), 1.0)
    with pytest.raises(InputError, match="expected a number"):
        orbit_distance(ref, sphere(4), "soon")


@pytest.mark.parametrize("width", [0.3, 0.1, 0.05])
def test_a_pulse_is_not_jumped_over(width: float) -> None:
    """psi is 0 before and after the pulse to the last digit, and its integral is known."""
    angle = 3 * width * np.sqrt(2 * np.pi)
    field = lh.GeneratorField(
        lh.defining(lh.so(2)), lambda m, t: 3 * np.exp(-(((t - 5.2) / width) ** 2) / 2)[..., None]
    )
    found = Reference(field, [1.0, 0.0])
    assert np.abs(found(10.0) - [np.cos(angle), np.sin(angle)]).max() < 1e-13
    assert found.accuracy(10.0) < 1e-13
