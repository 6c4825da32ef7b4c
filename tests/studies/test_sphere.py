"""Section 3 of the paper: spheres in every dimension, generators, geodesic curvature, the frame and its conditions."""

from math import factorial
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.series.jet import Jet
from liehom.flow.steps.order_conditions import chi
from liehom.studies.rigid_body import RigidBody
from liehom.studies.spheres import Sphere, SphereFrame
from tests.studies.support import rational, unit

DIMENSIONS = (2, 3, 4, 5, 7)


def quadratic(k: int, seed: int) -> Any:
    """A random quadratic field X(m) on R^k, tangent after projection."""
    rng = np.random.default_rng(seed)
    a, b, c = rng.normal(size=(k, k, k)), rng.normal(size=(k, k)), rng.normal(size=k)

    def field(m: Any) -> Any:
        raw = np.einsum("aij,...i,...j->...a", a, m, m) / 2 + np.einsum("ai,...i->...a", b, m) + c
        return raw - (np.sum(raw * m, axis=-1, keepdims=True) / np.sum(m * m, axis=-1, keepdims=True)) * m

    return field


@pytest.mark.parametrize("k", DIMENSIONS)
def test_wedge(k: int) -> None:
    sphere = Sphere(k)
    x, y, z = unit(1, 3, 6, k)
    result = lh.Action(sphere.representation).infinitesimal(sphere.wedge(x, y), z)
    wanted = np.sum(x * z, axis=-1, keepdims=True) * y - np.sum(y * z, axis=-1, keepdims=True) * x
    assert np.allclose(result, wanted, rtol=0, atol=1e-15)
    assert sphere.representation.algebra.dimension - sphere.isotropy_dimension == k - 1


@pytest.mark.parametrize("k", DIMENSIONS)
@pytest.mark.parametrize("radius", [1.0, 2.5])
def test_generators(k: int, radius: float) -> None:
    """Both give X; the orthogonal one is orthogonal to g_m, the other one has the given isotropy."""
    sphere, x = Sphere(k, radius), quadratic(k, 2)
    m = sphere.project(unit(3, 5, k))
    assert np.allclose(np.linalg.norm(m, axis=-1), radius)
    eta = np.random.default_rng(4).normal(size=sphere.representation.algebra.dimension)
    plain, turned = sphere.generator(x), sphere.generator(x, lambda m: 0 * m[..., :1] + eta)
    for field in (plain, turned, sphere.orthogonal(turned)):
        assert np.allclose(field.vector(m), x(m), rtol=0, atol=1e-13)
    assert np.allclose(sphere.orthogonal(turned).psi(m), plain.psi(m), rtol=0, atol=1e-13)
    action = lh.Action(sphere.representation)
    basis = action.isotropy_frame(m, k - 1).basis
    product = action.inner_product.matrix
    assert np.abs(np.swapaxes(basis, -1, -2) @ product @ plain.psi(m)[..., None]).max(initial=0) < 1e-13
    more = turned.psi(m) - plain.psi(m)
    assert np.allclose(action.infinitesimal(more, m), 0, atol=1e-13)
    assert np.abs(np.swapaxes(basis, -1, -2) @ product @ (eta - more)[..., None]).max(initial=0) < 1e-13


def test_generators_in_other_forms() -> None:
    sphere, m = Sphere(3), unit(5, 3)
    field = sphere.generator(["-m1*t", "m0*t", "0"])
    assert field.time_dependent
    assert np.allclose(field.vector(m, 2.0), [-2 * m[1], 2 * m[0], 0])
    assert sphere.orthogonal(field).time_dependent
    exact = rational(["2/3", "1/3", "2/3"])
    generator = sphere.generator(["-m1", "m0", "0"], ["m0", "1", "m2"])
    assert generator.vector(exact).tolist() == rational(["-1/3", "2/3", "0"]).tolist()


# -- geodesic curvature ----------------------------------------------------------------------------------
@pytest.mark.parametrize("k", DIMENSIONS)
@pytest.mark.parametrize("radius", [1.0, 1.7])
def test_improvement_is_what_the_corrector_finds(k: int, radius: float) -> None:
    """(3.7): isotropy that makes the geodesic curvatures of step and orbit equal, in any dimension and radius."""
    sphere = Sphere(k, radius)
    m = sphere.project(unit(6, 5, k))
    field = sphere.generator(quadratic(k, 7))
    raised = lh.steps.correction(field, lh.Euler(), m, 2)
    zeta = raised.zeta[1] if raised.zeta[1] is not None else 0 * sphere.improvement(field, m)
    assert np.allclose(sphere.improvement(field, m), zeta, rtol=0, atol=1e-11)
    orbit = sphere.curvature_of_flow(field, m)
    for exponential in ("exp", "cayley"):
        for step in (lh.Corrected(lh.Euler(), 2), lh.Corrected(lh.BackwardEuler(), 2), lh.Heun()):
            assert np.allclose(sphere.curvature_of_step(field, step, m, exponential), orbit, rtol=0, atol=1e-10)
    if k > 2:  # on a circle every curve is geodesic
        assert np.abs(sphere.curvature_of_step(field, lh.Euler(), m)).max() < 1e-13
        assert np.abs(orbit).max() > 0.1


def test_sigma_i_of_the_rigid_body_is_a_curvature() -> None:
    """(3.8), (4.3): sigma_i = k_g |X|."""
    body, m, sphere = RigidBody([1, 2, 3]), unit(8, 20, 3), Sphere(3)
    x = body.vector(m)
    speed = np.linalg.norm(x, axis=-1)
    curvature = sphere.curvature_of_flow(body.field("b"), m)
    sigma = np.sum(x * body.apply(x), axis=-1) / speed**2 - body.rayleigh(m)
    assert np.allclose(curvature * speed, sigma, rtol=0, atol=1e-13)
    # the circle of exp(t (omega + sigma m)) has the curvature sigma/|X|
    field = sphere.generator(body.vector, lambda m: 0.7 * m)
    assert np.allclose(sphere.curvature_of_step(field, lh.Euler(), m) * speed, 0.7, rtol=0, atol=1e-13)


@pytest.mark.parametrize("k", [3, 4, 6])
def test_circular_orbits_are_captured_exactly(k: int) -> None:
    """Small circles run through at varying speed: the improved Euler step with exp stays on them, for any step size."""
    p, q = np.linalg.qr(np.random.default_rng(9).normal(size=(k, 2)))[0].T

    def field(m: Any) -> Any:
        speed = 1 + m[..., :1] ** 2 + m[..., 1:2]
        return speed * (np.sum(m * p, -1, keepdims=True) * q - np.sum(m * q, -1, keepdims=True) * p)

    sphere, m = Sphere(k, 1.3), 1.3 * unit(10, 8, k)
    generator = sphere.generator(field)
    for dt in (0.1, 1.0):
        run = lh.integrate(generator, (0, 3 * dt), m, step=lh.Corrected(lh.Euler(), 2), dt=dt, clock="nominal").y[
            ..., -1
        ]
        fixed = np.eye(k) - np.outer(p, p) - np.outer(q, q)
        assert np.abs((run - m) @ fixed).max() < 1e-14
        plain = lh.integrate(generator, (0, 3 * dt), m, step=lh.Euler(), dt=dt).y[..., -1]
        assert np.abs((plain - m) @ fixed).max() > 1e-3


@pytest.mark.parametrize("n", [2, 3, 4, 5])
@pytest.mark.parametrize("k", [3, 4])
def test_lemma_2(k: int, n: int) -> None:
    """(3.10): curvatures along flow and step of order n - 1 differ first at the derivative n - 2, and by how much."""
    sphere, m = Sphere(k), unit(11, k)
    field = sphere.generator(quadratic(k, 12))
    step = lh.LieTaylor(n - 1)
    flow, curve = lh.steps.flow_series(field, m, n).points, sphere.step_curve(field, step, m, n)
    difference = (curve.coefficient(n) - flow.coefficient(n)) * factorial(n)
    ours, theirs = sphere.curvature_series(curve), sphere.curvature_series(flow)
    for j in range(n - 2):
        assert np.abs(ours.coefficient(j) - theirs.coefficient(j)).max() < 1e-11
    gap = (ours.coefficient(n - 2) - theirs.coefficient(n - 2)) * factorial(n - 2)
    x = field.vector(m)
    speed = np.linalg.norm(x)
    if k == 3:
        wanted = difference @ np.cross(m, x) / speed**3
    else:
        u = x / speed
        wanted = (difference - m * (m @ difference) - u * (u @ difference)) / speed**2
    assert np.abs(gap).max() > 1e-3
    assert np.allclose(gap, wanted, rtol=1e-9, atol=1e-9)
    there = sphere.curvature_series(sphere.step_curve(field, lh.Corrected(step, n), m, n))
    assert np.allclose(there.coefficient(n - 2), theirs.coefficient(n - 2), rtol=1e-9, atol=1e-9)


# -- the frame -------------------------------------------------------------------------------------------
class Given(lh.steps.OneExponential):
    """A step with given derivative coefficients xi_1, xi_2, ..."""

    def __init__(self, order: int, derivatives: list[Any]) -> None:
        self._order, self._xi = order, [x / factorial(j + 1) for j, x in enumerate(derivatives)]

    @property
    def order(self) -> int:
        return self._order

    def generator(self, action: Any, psi: Any, m: Any, t: Any, h: Any) -> Any:
        total = self._xi[-1] * h
        for x in reversed(self._xi[:-1]):
            total = (total + x) * h
        return total


def frame_of(seed: int, *, isotropy: bool = True) -> tuple[lh.GeneratorField, SphereFrame]:
    sphere, x = Sphere(3), quadratic(3, seed)
    field = sphere.generator(x, (lambda m: m * (1 + m[..., 1:2])) if isotropy else None)
    return field, SphereFrame(field, unit(seed + 50, 3))


def vectors(frame: SphereFrame, *coordinates: Any) -> list[Any]:
    return [np.array(row, dtype=float) @ frame.vectors for row in zip(*coordinates, strict=True)]


def test_coordinates_of_the_generator() -> None:
    """a_0 = a_1 = 0, b_0 = v, c_0 = 0, a_2 = c_1 v."""
    for seed in range(4):
        _, frame = frame_of(seed)
        assert np.allclose([frame.a[0], frame.a[1], frame.c[0]], 0, atol=1e-13)
        assert np.isclose(frame.b[0], frame.v)
        assert np.isclose(frame.a[2], frame.c[1] * frame.v)
        assert np.allclose(frame.vectors @ frame.vectors.T, np.eye(3), atol=1e-15)
        assert np.isclose(np.linalg.det(frame.vectors), 1)


def test_the_flow_to_order_3() -> None:
    """(3.1) with omega'' in the term of order 3."""
    field, frame = frame_of(20)
    m, flow = frame.point, lh.steps.flow_series(field, frame.point, 3).points
    w, w1, w2 = vectors(frame, frame.a[:3], frame.b[:3], frame.c[:3])
    second = np.cross(w, np.cross(w, m)) + np.cross(w1, m)
    third = np.cross(-(frame.v**2) * w + np.cross(w, w1) + w2, m) + 3 * np.cross(w1, np.cross(w, m))
    assert np.allclose(flow.coefficient(2) * 2, second)
    assert np.allclose(flow.coefficient(3) * 6, third)
    assert not np.allclose(flow.coefficient(3) * 6, third - np.cross(w2, m))  # as printed


@pytest.mark.parametrize("exponential", ["exp", "cayley"])
@pytest.mark.parametrize("seed", range(3))
def test_order_conditions(exponential: str, seed: int) -> None:
    """xi_j with any alpha_j and the beta_j, gamma_j of the conditions: order 4, and not 5."""
    field, frame = frame_of(seed)
    alpha = np.random.default_rng(seed).normal(size=4)
    beta, gamma = frame.conditions(alpha, exponential)
    step = Given(4, vectors(frame, alpha, beta, gamma))
    for n in range(1, 6):
        assert (np.abs(chi(field, step, frame.point, n, exponential=exponential)).max() < 1e-10) == (n < 5), n
    for j in (2, 3):  # each condition is needed
        for name in ("beta", "gamma"):
            b, c = list(beta), list(gamma)
            (b if name == "beta" else c)[j] += 0.1
            other = chi(field, Given(j, vectors(frame, alpha, b, c)), frame.point, j + 1, exponential=exponential)
            assert np.abs(other).max() > 0.01


def test_printed_condition_c_fails() -> None:
    """beta_3 with + alpha_1^2 v / 2, as printed, is of order 2 only (exp)."""
    field, frame = frame_of(5)
    alpha = [0.8, 0.0, 0.0, 0.0]
    beta, gamma = frame.conditions(alpha)
    step = Given(2, vectors(frame, alpha, [*beta[:2], beta[2] + alpha[0] ** 2 * frame.v, beta[3]], gamma))
    assert np.abs(chi(field, step, frame.point, 3)).max() > 0.1


@pytest.mark.parametrize("exponential", ["exp", "cayley"])
@pytest.mark.parametrize("order", [2, 3, 4])
def test_orbits_captured_to_one_order_more(exponential: str, order: int) -> None:
    """(3.5), (3.6) and their sequel: the last alpha is what the corrector adds; the clock takes what beta lacks."""
    field, frame = frame_of(30 + order)
    rng = np.random.default_rng(order)
    alpha = [*rng.normal(size=order - 2), *[0.0] * (6 - order)]
    beta, gamma = (list(x) for x in frame.conditions(alpha, exponential))
    beta[order - 1 :], gamma[order - 1 :] = rng.normal(size=5 - order), rng.normal(size=5 - order)
    wanted = frame.capturing(order, alpha, gamma, exponential)
    step = Given(order - 1, vectors(frame, alpha, beta, gamma))
    raised = lh.steps.correction(field, step, frame.point, order, exponential=exponential)
    zeta = raised.zeta[order - 1] * factorial(order - 1)
    assert np.allclose(zeta, wanted * frame.vectors[0], rtol=1e-10, atol=1e-10)
    full = frame.conditions([*alpha[: order - 2], wanted, *[0.0] * (4 - order)], exponential)[0]
    assert np.isclose(raised.clock[order] * factorial(order), (beta[order - 1] - full[order - 1]) / frame.v)


def test_coordinates_of_steps() -> None:
    """Euler: alpha_1 = c_1/v captures order 2, backward Euler: -c_1/v, Heun: alpha_2 with the factor 1/v^2."""
    field, frame = frame_of(40, isotropy=False)
    for step, sign in ((lh.Euler(), 1), (lh.BackwardEuler(), -1)):
        alpha, _, gamma = frame.coordinates(step, field)
        assert np.isclose(frame.capturing(2, alpha, gamma), sign * frame.c[1] / frame.v)
    alpha, beta, gamma = frame.coordinates(lh.Heun(), field)
    wanted = frame.conditions(alpha)
    assert np.allclose([*beta[:2], *gamma[:2]], [*wanted[0][:2], *wanted[1][:2]], atol=1e-12)
    w, w1, w2 = vectors(frame, frame.a[:3], frame.b[:3], frame.c[:3])
    m = frame.point
    derivative = field.psi(Jet([m, np.cross(w1, m)])).coefficient(1)  # D omega (omega' x m)
    alpha2 = (derivative - w2 / 3) @ np.cross(m, w) / frame.v**2
    raised = lh.steps.correction(field, lh.Heun(), m, 3).zeta[2] @ m * 2
    assert np.isclose(raised, alpha2)
    assert np.isclose(raised, frame.capturing(3, alpha, gamma) - alpha[1])
    taylor = frame.coordinates(lh.LieTaylor(4), field, "cayley")
    wanted = frame.conditions(taylor[0], "cayley")
    assert np.allclose(taylor[1:], wanted, rtol=1e-11, atol=1e-11)


def test_refusals() -> None:
    with pytest.raises(lh.errors.InputError, match="integer at least 2"):
        Sphere(1)
    with pytest.raises(lh.errors.InputError, match="radius"):
        Sphere(3, -1)
    field, frame = frame_of(1)
    with pytest.raises(lh.errors.InputError, match="equilibrium"):
        SphereFrame(RigidBody([1, 2, 3]).field("o"), [1.0, 0, 0])
    with pytest.raises(lh.errors.ShapeError, match="S\\^2"):
        SphereFrame(field, [1.0, 0, 0, 0])
    with pytest.raises(lh.errors.InputError, match="time"):
        SphereFrame(Sphere(3).generator(["-m1*t", "m0*t", "0"]), unit(1, 3))
    with pytest.raises(lh.errors.InputError, match="2, 3 or 4"):
        frame.capturing(5, [0] * 4, [0] * 4)
    with pytest.raises(lh.errors.InputError, match="'series'"):
        frame.conditions([0] * 3, "series")
    with pytest.raises(lh.errors.InputError, match="order 2 or more"):
        Sphere(3).curvature_series(Jet([[1.0, 0, 0], [0, 1.0, 0]]))
