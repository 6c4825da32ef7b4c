"""Single steps against formulas written down directly, relations between steps, and refused inputs."""

import time
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

import liehom as lh
from liehom.base.errors import InputError
from liehom.flow.methods.midpoint import MatrixCoordinates
from liehom.flow.steps.step import Generator
from tests.flow.methods.spaces import System, moved, poisson_defect, quadratic, system


def test_spherical_midpoint_satisfies_its_equation_on_spheres_of_three_radii() -> None:
    data = system("three spins")
    h, m = 0.3, data.start
    after = moved(lh.SphericalMidpoint(), data, m, h)
    before, end = m.reshape(3, 3), after.reshape(3, 3)
    middle = before + end
    middle *= np.linalg.norm(before, axis=1, keepdims=True) / np.linalg.norm(middle, axis=1, keepdims=True)
    assert np.abs(after - m - h * data.field.vector(middle.ravel())).max() < 1e-14


def test_spherical_midpoint_is_the_step_of_joint_spins() -> None:
    spins = lh.LandauLifshitz((3,), exchange=1.0, damping=0.0).joint()
    sol = lh.integrate(spins.field, (0, 1), spins.point(np.eye(3)), step=lh.SphericalMidpoint(), dt=0.1)
    assert np.abs(np.sum(spins.spins(sol.y.T) ** 2, axis=-1) - 1).max() < 1e-14


def test_lattices_of_spins_take_no_time_to_recognize() -> None:
    """100 spins: one step costs a few evaluations of psi, and no look at the 300 matrices of the representation."""
    spins = lh.LandauLifshitz((10, 10), exchange=1.0, damping=0.0).joint()
    start = spins.point(np.random.default_rng(0).normal(size=(10, 10, 3)))
    begin = time.process_time()
    sol = lh.integrate(spins.field, (0, 0.1), start, step=lh.SphericalMidpoint(), dt=0.02)
    assert time.process_time() - begin < 10
    assert np.allclose(np.linalg.norm(spins.spins(sol.y[:, -1]), axis=-1), np.linalg.norm(spins.spins(start), axis=-1))


def test_heavy_tops_keep_their_energy_by_the_variational_midpoint() -> None:
    """`HeavyTop` is on the dual of se(3): the error of the energy does not grow, that of Heun's step does."""
    top = lh.bodies.HeavyTop([1, 1.5, 2], centre=[0, 0, 1], weight=1.0)
    start = top.start(momentum=[0.3, 0.1, 4.0], vertical=[0.6, 0, 0.8])
    for step, grows in ((lh.methods.VariationalMidpoint(), False), (lh.methods.Splitting(), False), (lh.Heun(), True)):
        energy = top.energy(top.integrate((0, 300), start, step=step, dt=0.05, engine="llvm"))
        error = np.abs(energy - energy[0])
        assert bool(error.max() > 2 * error[:600].max()) is grows


def test_isospectral_midpoint_satisfies_its_equations() -> None:
    data = system("body in R^4")
    coordinates = MatrixCoordinates(lh.defining(data.algebra))
    h = 0.3
    after = moved(lh.methods.IsospectralMidpoint(), data, data.start, h)
    w, end = coordinates.form(data.start), coordinates.form(after)
    p = (w + end) / 2 + 0.0
    for _ in range(100):  # P of the first equation
        b = coordinates.element(data.field.psi(coordinates.point(p)))
        left, right = np.eye(4) - h / 2 * b, np.eye(4) + h / 2 * b
        p = np.linalg.solve(left, w) @ np.linalg.inv(right)
    assert np.abs(right @ p @ left - end).max() < 1e-14
    assert np.allclose(np.poly(w), np.poly(end), rtol=0, atol=1e-14)


def test_isospectral_midpoint_by_the_spin_representation_is_another_poisson_map() -> None:
    """The collective integrator through the Hopf map: 2 x 2 complex matrices in place of 3 x 3 real ones."""
    data = system("so(3)")
    collective = lh.methods.IsospectralMidpoint(lh.spin_representation(3))
    assert poisson_defect(collective, data, 0.3) < 1e-9
    ends = [moved(step, data, data.start, 0.3) for step in (collective, lh.methods.IsospectralMidpoint())]
    assert np.abs(ends[0] - ends[1]).max() > 1e-6


def test_variational_midpoint_satisfies_the_discrete_euler_poincare_equations() -> None:
    """m = int_0^1 Ad*: p is the mean of the arc, m' = exp(h dH(p)) m."""
    data = system("heavy top")
    h, m = 0.3, data.start
    after = moved(lh.methods.VariationalMidpoint(), data, m, h)
    field = data.field
    rho = np.array([a.to_numpy() for a in field.representation.matrices])
    nodes, weights = np.polynomial.legendre.leggauss(12)
    p = m
    for _ in range(100):
        a = h * np.tensordot(field.psi(p), rho, 1)
        p = sum(w / 2 * expm((x + 1) / 2 * a) @ m for x, w in zip(nodes, weights, strict=True))
    assert np.abs(expm(a) @ m - after).max() < 1e-13


# -- splitting -------------------------------------------------------------------------------------------
def test_splitting_by_given_linear_functions() -> None:
    """H = sum of f(<m, a_i>) for directions that are not those of the basis."""
    rows = np.array([[1.0, 1.0, 0.0], [0.0, 1.0, -1.0], [1.0, 0.0, 2.0]])
    values = System(lh.so(3), lambda m: np.sum(np.cos(m @ rows.T), axis=-1), 1, np.array([0.6, 0.48, 0.64]))
    parts = [lambda m, a=a: -np.sin(m @ a)[..., None] * a for a in rows]
    assert poisson_defect(lh.methods.Splitting(parts), values, 0.3) < 1e-9
    with pytest.raises(InputError, match="changes along its flow"):
        moved(lh.methods.Splitting(), values, values.start, 0.1)
    with pytest.raises(InputError, match="add up to"):
        moved(lh.methods.Splitting(parts[:2]), values, values.start, 0.1)


def test_splitting_is_explicit() -> None:
    """Each part is evaluated twice in a step, the last one once."""
    data, calls = system("body"), [0]

    def psi(m: Any) -> Any:
        calls[0] += 1
        return data.field.psi(m)

    field = lh.GeneratorField(data.field.representation, psi)
    local = lh.methods.Splitting().at(lh.Action(field.representation), Generator(field, 2), data.start, np.zeros(1))
    calls[0] = 0
    local.point(np.array([0.1]))
    assert calls == [5]


def test_factors_of_a_splitting_move_the_point_to_its_end() -> None:
    data = system("body")
    action = lh.Action(data.field.representation)
    local = lh.methods.Splitting().at(action, Generator(data.field, 2), data.start, np.zeros(1))
    m, h = data.start, np.array([0.3])
    for x in local.factors(h):
        m = action.act(x, m)
    np.testing.assert_allclose(m, local.point(h), rtol=0, atol=1e-15)
    assert np.abs(m - data.start).max() > 0.01


def test_a_step_without_an_estimate_says_so_and_has_no_cone() -> None:
    data = system("body")
    local = lh.Euler().at(lh.Action(data.field.representation), Generator(data.field, 2), data.start, np.zeros(1))
    assert local.estimate_order is None and not local.is_near_cone(np.array([0.1, 2.0])).any()
    with pytest.raises(InputError, match="no estimate"):
        local.estimate(np.array([0.1]))


def test_parts_that_depend_on_args_are_compared_with_psi_in_each_run() -> None:
    """`prepares_by_psi`: what was checked for the args of one run says nothing of those of the next."""
    parts = [lambda m, k=k: -m * np.eye(3)[k] / (k + 1) for k in range(3)]
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m / args)
    step, (first, second) = lh.methods.Splitting(parts), (np.array([1.0, 2.0, 3.0]), np.array([1.0, 2.0, 4.0]))
    assert step.prepares_by_psi and not lh.methods.Splitting().prepares_by_psi
    made = lh.Propagator(field, step)
    for _ in range(2):
        assert made((0, 1), [0.6, 0.48, 0.64], dt=0.1, args=first).status == 0
    with pytest.raises(InputError, match="add up to"):
        made((0, 1), [0.6, 0.48, 0.64], dt=0.1, args=second)


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_taylor_steps_have_their_order_by_an_exponential_of_which_the_action_alone_is_known(n: int) -> None:
    rho, psi = lh.adjoint(lh.so(3)), lambda m: -m / [1.0, 2.0, 3.0]
    turn = lh.Action(rho).infinitesimal

    def cayley(x: Any, m: Any) -> Any:
        once = turn(x, m)
        return m + (once + turn(x, once) / 2) / (1 + (x * x).sum(axis=-1, keepdims=True) / 4)

    options: dict[str, Any] = {"step": lh.LieTaylor(n), "engine": "numpy"}
    start = [0.6, 0.48, 0.64]
    exact = lh.integrate(lh.GeneratorField(rho, psi), (0, 1), start, rtol=1e-13, atol=1e-13).y[:, -1]
    errors = []
    for dt in (0.1, 0.05):
        end = lh.integrate(lh.GeneratorField(rho, psi), (0, 1), start, dt=dt, exponential=cayley, **options).y[:, -1]
        errors.append(np.abs(end - exact).max())
    assert 0.8 * 2**n < errors[0] / errors[1] < 1.35 * 2**n


# -- composition -----------------------------------------------------------------------------------------
@pytest.mark.parametrize("scheme", ["suzuki", "yoshida"])
@pytest.mark.parametrize("order", [2, 4, 6, 8])
def test_substeps_add_up_to_the_step(scheme: str, order: int) -> None:
    sizes = np.array(lh.methods.Composition(lh.SphericalMidpoint(), order, scheme).sizes)
    assert len(sizes) == {"suzuki": 5, "yoshida": 3}[scheme] ** (order // 2 - 1)
    assert abs(sizes.sum() - 1) < 1e-14
    assert np.allclose(sizes, sizes[::-1])
    assert order < 4 or abs((sizes**3).sum()) < 1e-13


def test_compositions_of_other_steps_are_refused() -> None:
    with pytest.raises(InputError, match="symmetric"):
        lh.methods.Composition(lh.Heun(), 4)
    for order in (3, 1, True, 2.0):
        with pytest.raises(InputError, match="even integer"):
            lh.methods.Composition(lh.SphericalMidpoint(), order)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="scheme"):
        lh.methods.Composition(lh.SphericalMidpoint(), 4, "triple")


# -- what is refused -------------------------------------------------------------------------------------
@pytest.mark.parametrize(("step", "representation", "message"), [
    (lh.SphericalMidpoint(), lh.defining(lh.so(4)), "products of spheres"),
    (lh.SphericalMidpoint(), lh.coadjoint(lh.sl(2)), "products of spheres"),
    (lh.methods.IsospectralMidpoint(), lh.defining(lh.so(4)), "dual of a Lie algebra"),
    (lh.methods.IsospectralMidpoint(), lh.coadjoint(lh.euclidean(3)), "matrices"),
    (lh.methods.IsospectralMidpoint(), lh.coadjoint(lh.simple("G2")), "quadratic group"),
    (lh.methods.MoserVeselov(), lh.coadjoint(lh.su(3)), "rigid body"),
])  # fmt: skip
def test_spaces_of_other_steps_are_refused(step: lh.Step, representation: lh.Representation, message: str) -> None:
    field = lh.GeneratorField(representation, np.ones(representation.algebra.dimension))
    m = np.ones(representation.size)
    with pytest.raises(InputError, match=message):
        step.at(lh.Action(representation), Generator(field, 2), m, np.zeros(1))


@pytest.mark.parametrize("step", [lh.methods.VariationalMidpoint(), lh.methods.Splitting()], ids=str)
def test_steps_that_need_the_exponential_map_refuse_the_cayley_transform(step: lh.Step) -> None:
    data = system("body")
    with pytest.raises(InputError, match="exponential map"):
        lh.integrate(data.field, (0, 1), data.start, step=step, dt=0.1, exponential="cayley")


def test_isospectral_midpoint_on_all_matrices() -> None:
    """On the dual of sl(3), whose matrices x y x are multiples of 1 beside those of sl(3)."""
    data = System(lh.sl(3), quadratic(np.arange(1, 9) / 8), 1, np.cos(np.arange(1.0, 9)) / 2)
    assert poisson_defect(lh.methods.IsospectralMidpoint(), data, 0.2) < 1e-9
