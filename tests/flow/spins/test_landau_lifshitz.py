"""Landau-Lifshitz-Gilbert spins: the physics, exact solutions of one spin and of spirals, orders, conserved energy."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.convergence.reference import Reference
from liehom.flow.spins import LandauLifshitz, SpinLattice, macrospin, switching_time
from liehom.flow.steps.conserving import Conserving
from tests.studies.support import on_sphere

Z = np.array([0.0, 0.0, 1.0])


def turned(m: Any, angle: Any) -> Any:
    """m turned about the z axis."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * m[..., 0] - s * m[..., 1], s * m[..., 0] + c * m[..., 1], m[..., 2] + 0 * c], axis=-1)


def spiral(theta: float, phase: Any) -> Any:
    """Spins at the angle theta to the z axis: a spiral where the phase grows along the lattice."""
    return turned(np.array([np.sin(theta), 0.0, np.cos(theta)]), np.asarray(phase, dtype=float))


def slopes(errors: list[float]) -> Any:
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


MODELS = {
    "chain": LandauLifshitz((6,), exchange=0.7, anisotropy=0.4, axis=[1, 2, 2], applied=[0.3, -0.1, 0.5], damping=0.2),
    "open grid": LandauLifshitz(
        (3, 4), exchange=-1.1, anisotropy=np.linspace(-1, 1, 12).reshape(3, 4), applied=on_sphere(1, 3, 4), damping=0.1,
        axis=on_sphere(2, 3, 4), gyromagnetic=1.7, periodic=(True, False),
    ),
    "single": LandauLifshitz(anisotropy=-0.6, axis=[0, 1, 1], applied=[1.0, 0, 0], damping=0.4),
}  # fmt: skip


# -- the lattice and the equation ------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("shape", "periodic"), [((5,), True), ((3, 4), (False, True)), ((2, 1, 3), False), ((1,), False)]
)
def test_neighbours_are_those_at_distance_one(shape: tuple[int, ...], periodic: Any) -> None:
    lattice, m = SpinLattice(shape, periodic), on_sphere(3, 2, *shape)
    closed = lattice.periodic
    assert isinstance(closed, tuple)
    wanted, bonds = np.zeros_like(m), 0
    for place in np.ndindex(*shape):
        for axis, n in enumerate(shape):
            for side in (-1, 1):
                other = list(place)
                other[axis] += side
                if closed[axis] or 0 <= other[axis] < n:
                    other[axis] %= n
                    wanted[(slice(None), *place)] += m[(slice(None), *other)]
                    bonds += 1
    np.testing.assert_allclose(lattice.neighbour_sum(m), wanted, atol=1e-15)
    assert lattice.bonds == bonds // 2


@pytest.mark.parametrize("name", MODELS)
def test_the_effective_field_is_minus_the_gradient_of_the_energy(name: str) -> None:
    model = MODELS[name]
    m, v = on_sphere(4, 2, *model.lattice.shape), on_sphere(5, 2, *model.lattice.shape)
    along = model.energy(lh.Jet.variable(m, 1, v)).coefficient(1)
    h = model.effective_field(m)
    np.testing.assert_allclose(along, -np.sum(h * v, axis=tuple(range(1, h.ndim))), atol=1e-13)


@pytest.mark.parametrize("name", MODELS)
def test_the_equation_of_gilbert(name: str) -> None:
    model = MODELS[name]
    m = on_sphere(6, *model.lattice.shape)
    rate, h = model.field.vector(m), model.effective_field(m)
    wanted = -model.gyromagnetic * np.cross(m, h) + model.damping * np.cross(m, rate)
    np.testing.assert_allclose(rate, wanted, atol=1e-14)
    along = model.energy(lh.Jet.variable(m, 1, rate)).coefficient(1)
    np.testing.assert_allclose(along, model.energy_rate(m), atol=1e-13)
    assert (model.energy_rate(m) < 0).all()


def test_models_that_make_no_sense_are_refused() -> None:
    with pytest.raises(lh.errors.InputError, match="cannot be periodic"):
        LandauLifshitz((2,), exchange=1.0)
    with pytest.raises(lh.errors.InputError, match="at least 0"):
        LandauLifshitz(damping=-0.1)
    with pytest.raises(lh.errors.InputError, match="other than 0"):
        LandauLifshitz(axis=[0, 0, 0])
    with pytest.raises(lh.errors.ShapeError, match=r"anisotropy has shape \(3,\)"):
        LandauLifshitz((4,), anisotropy=[1, 2, 3])
    with pytest.raises(lh.errors.InputError, match="finite"):
        LandauLifshitz(exchange=np.nan)
    with pytest.raises(lh.errors.InputError, match="positive integers"):
        LandauLifshitz((0,))
    with pytest.raises(lh.errors.InputError, match="for each of 2 axes"):
        SpinLattice((3, 3), (True,))
    with pytest.raises(lh.errors.ShapeError, match=r"the applied field has shape \(2,\)"):
        LandauLifshitz(applied=lambda t: [t, t]).integrate((0, 1), [0, 0, 1.0])
    with pytest.raises(lh.errors.ShapeError, match=r"expected \(\.\.\., 3, 4, 3\)"):
        MODELS["open grid"].energy(on_sphere(0, 3, 5))


# -- one spin --------------------------------------------------------------------------------------------
@pytest.mark.parametrize("damping", [0.0, 0.05, 1.0])
def test_the_macrospin_solves_the_equation(damping: float) -> None:
    model = LandauLifshitz(applied=[0.5, -1.0, 2.0], damping=damping, gyromagnetic=1.3)
    m0, times = on_sphere(7, 4), np.array([-1.0, 0.0, 0.7, 3.0])[:, None]
    exact = macrospin(m0, [0.5, -1.0, 2.0], times, damping=damping, gyromagnetic=1.3)
    assert np.abs(Reference(model.field, m0)(times) - exact).max() < 1e-14
    assert np.abs(np.linalg.norm(exact, axis=-1) - 1).max() < 1e-14


@pytest.mark.parametrize(("m0", "field"), [([1.0, 0.0], Z), (Z, [1.0, 0.0]), (1.0, Z), (Z, np.zeros((3, 2)))])
def test_spins_and_fields_have_three_components(m0: Any, field: Any) -> None:
    with pytest.raises(lh.ShapeError, match="for both"):
        macrospin(m0, field, 1.0)


def test_the_macrospin_at_its_limits() -> None:
    assert np.abs(macrospin([[0.0, 0.6, -0.8], -Z, Z], Z, 1e6, damping=0.5) - [Z, -Z, Z]).max() < 1e-15
    assert np.abs(macrospin(Z[[2, 0, 1]], Z, np.pi / 2, gyromagnetic=-1.0) - [0, -1, 0]).max() < 1e-15
    assert np.array_equal(macrospin([0.0, 0.6, -0.8], np.zeros(3), 5.0, damping=0.5), [0.0, 0.6, -0.8])


@pytest.mark.parametrize(("step", "order"), [(lh.Euler(), 1), *[(lh.Corrected(lh.Euler(), n), n) for n in (2, 3, 4)]])
def test_orders_of_corrected_steps_against_the_macrospin(step: lh.Step, order: int) -> None:
    spin, m0 = LandauLifshitz(applied=2 * Z, damping=0.3), on_sphere(8, 5)
    exact = macrospin(m0, 2 * Z, 2.0, damping=0.3)
    errors = []
    for dt in (0.1, 0.05, 0.025):
        sol = spin.integrate((0, 2), m0, step=step, dt=dt, t_eval=[2.0])
        errors.append(float(np.sqrt(np.mean((sol.y[..., -1] - exact) ** 2))))
        assert sol.report.order == order
    assert np.abs(slopes(errors) - order).max() < 0.2


def test_precession_about_an_easy_axis_is_exact_for_every_step() -> None:
    """alpha = 0, field and easy axis along z: a circle, on which the generator is constant up to isotropy."""
    spin, m0 = LandauLifshitz(anisotropy=0.3, applied=0.8 * Z, gyromagnetic=1.2), on_sphere(9, 5)
    exact = turned(m0, 7.0 * 1.2 * (0.8 + 2 * 0.3 * m0[:, 2]))
    sol = spin.integrate((0, 7), m0, step=lh.Euler(), dt=0.5, t_eval=[7.0])
    assert np.abs(sol.y[..., -1] - exact).max() < 1e-13


SWITCHES = [(1.0, 0.0, (-0.9, 0.95)), (3.0, 1.0, (-0.9, 0.95)), (0.5, 1.0, (-0.3, -0.9)), (-1.0, -0.2, (0.6, -0.8))]


@pytest.mark.parametrize(("field", "anisotropy", "ends"), SWITCHES)
def test_switching_takes_the_time_of_the_formula(field: float, anisotropy: float, ends: tuple[float, float]) -> None:
    time = switching_time(*ends, field=field, anisotropy=anisotropy, damping=0.1, gyromagnetic=1.5)
    assert time > 0
    spin = LandauLifshitz(anisotropy=anisotropy, applied=field * Z, damping=0.1, gyromagnetic=1.5)
    sol = spin.integrate((0, time), [np.sqrt(1 - ends[0] ** 2), 0.0, ends[0]], rtol=1e-10, atol=1e-12)
    assert abs(sol.y[2, -1] - ends[1]) < 1e-8


def test_switching_that_does_not_happen_is_refused() -> None:
    with pytest.raises(lh.errors.InputError, match=r"side of -0\.5"):
        switching_time(-0.9, 0.5, field=1.0, anisotropy=1.0, damping=0.1)
    for ends in ((-1.0, 0.5), (1.0, 0.5), (0.5, -1.0), (0.5, 1.0)):
        with pytest.raises(lh.errors.InputError, match="between -1 and 1"):
            switching_time(*ends, field=1.0, damping=0.1)
    with pytest.raises(lh.errors.InputError, match="no switching without damping"):
        switching_time(-0.5, 0.5, field=1.0, damping=0.0)


def test_resonance_in_a_rotating_field() -> None:
    """A field that depends on time: in the rotating frame it is constant (Rabi)."""
    frequency, drive = 1.1, 0.4
    spin = LandauLifshitz(applied=lambda t: [drive * np.cos(frequency * t), drive * np.sin(frequency * t), 1.5])
    m0 = on_sphere(10, 3)
    exact = turned(macrospin(m0, [drive, 0.0, 1.5 - frequency], 4.0), frequency * 4.0)
    assert np.abs(Reference(spin.field, m0)(4.0) - exact).max() < 1e-14
    sol = spin.integrate((0, 4), m0, step=lh.Corrected(lh.Heun(), 5), dt=0.05, t_eval=[4.0])
    assert np.abs(sol.y[..., -1] - exact).max() < 1e-6
    stacked = LandauLifshitz(
        applied=lambda t: np.stack([drive * np.cos(frequency * t), drive * np.sin(frequency * t), 1.5 + 0 * t], axis=-1)
    )
    again = stacked.integrate((0, 4), m0, step=lh.Corrected(lh.Heun(), 5), dt=0.05, t_eval=[4.0])
    assert np.abs(again.y - sol.y).max() < 1e-14


# -- uncoupled spins -------------------------------------------------------------------------------------
def test_uncoupled_spins_are_corrected_each_by_its_own_clock() -> None:
    fields = np.array([0.5, 1.0, 3.0])[:, None] * Z
    chain, m0 = LandauLifshitz((3,), applied=fields, damping=0.3), on_sphere(11, 2, 3)
    assert not chain.coupled
    exact = macrospin(m0, fields, 2.0, damping=0.3)
    sol = chain.integrate((0, 2), m0, step=lh.Corrected(lh.Euler(), 6), dt=0.05)
    end = np.take_along_axis(sol.y, sol.n_steps[..., None, None], axis=-1)[..., 0]
    assert np.abs(end - exact).max() < 1e-6
    assert np.ptp(sol.t[..., 5]) > 1e-3
    assert sol.report.order == 6
    adapted = chain.integrate((0, 2), m0, step=lh.Corrected(lh.Euler(), 4))
    assert adapted.n_steps[0, 2] > adapted.n_steps[0, 0]


def test_lattices_without_bonds_are_uncoupled() -> None:
    assert not LandauLifshitz((1, 1), exchange=1.0, periodic=False).coupled
    assert LandauLifshitz((2, 1), exchange=1.0, periodic=False).coupled


# -- coupled spins ---------------------------------------------------------------------------------------
@pytest.mark.parametrize("shape", [(8,), (4, 6)])
def test_a_spiral_precesses_as_a_whole(shape: tuple[int, ...]) -> None:
    """An exact solution of the closed lattice: an easy plane K + J sum (1 - cos q) is what the spins feel."""
    model = LandauLifshitz(shape, exchange=1.3, anisotropy=0.2, applied=0.7 * Z, gyromagnetic=1.1)
    q = 2 * np.pi / np.array(shape)
    m0 = spiral(2.0, sum(q[i] * x for i, x in enumerate(np.indices(shape))))
    rate = 1.1 * (0.7 + 2 * (0.2 + 1.3 * np.sum(1 - np.cos(q))) * np.cos(2.0))
    sol = model.integrate((0, 3), m0, step=lh.LieTaylor(6), dt=0.05, t_eval=[3.0])
    assert np.abs(sol.y[..., -1] - turned(m0, 3 * rate)).max() < 1e-9
    open_ended = LandauLifshitz(shape, exchange=1.3, anisotropy=0.2, applied=0.7 * Z, gyromagnetic=1.1, periodic=False)
    sol = open_ended.integrate((0, 3), m0, step=lh.LieTaylor(6), dt=0.05, t_eval=[3.0])
    assert np.abs(sol.y[..., -1] - turned(m0, 3 * rate)).max() > 0.1


def test_a_spiral_switches_as_one_spin_with_another_anisotropy() -> None:
    model = LandauLifshitz((6,), exchange=0.4, anisotropy=0.3, applied=2.0 * Z, damping=0.2)
    time = switching_time(-0.8, 0.9, field=2.0, anisotropy=(0.3 + 0.4 * (1 - np.cos(np.pi / 3))), damping=0.2)
    m0 = spiral(np.arccos(-0.8), np.pi / 3 * np.arange(6))
    errors = []
    for parts in (64, 128, 256):
        sol = model.integrate((0, time), m0, step=lh.RKMK("rk4"), dt=time / parts, t_eval=[time])
        errors.append(float(np.abs(sol.y[:, 2, -1] - 0.9).max()))
    assert np.abs(slopes(errors) - 4).max() < 0.25


PLAIN = [
    (lh.Heun(), 2), (lh.LieTaylor(3), 3), (lh.LieTaylor(5), 5), (lh.RKMK("rk4"), 4), (lh.methods.CommutatorFree4(), 4),
]  # fmt: skip


@pytest.mark.parametrize(("step", "order"), PLAIN)
def test_orders_of_coupled_spins(step: lh.Step, order: int) -> None:
    model = LandauLifshitz(
        (3, 4),
        exchange=0.5,
        anisotropy=0.2,
        applied=lambda t: [np.sin(t), 0 * t, 0.7],
        damping=0.1,
        periodic=(True, False),
    )
    table = lh.observed_order(model.field, on_sphere(12, 3, 4), step, [0.1, 0.05, 0.025])
    assert abs(table.orders[1] - order) < 0.15


def test_coupled_spins_are_not_full() -> None:
    """Two directions of isotropy and the clock are 3, on a product of two spheres, of dimension 4."""
    pair = LandauLifshitz((2,), exchange=1.0, applied=[0.1, 0, 0.5], damping=0.1, periodic=False)
    joint, m0 = pair.joint(), on_sphere(13, 2)
    point = ["0", "0", "1", "0", "3/5", "4/5"]
    exact = lh.range_condition(joint.representation.pair(point), [1, 2, 0, 3, 1, -1])
    assert (exact.holds, exact.rank) == (False, 3)
    assert not lh.decide_fullness(joint.representation.pair(point)).full
    with pytest.warns(lh.OrderWarning, match="LieTaylor"):
        run = lh.integrate(joint.field, (0, 1), joint.point(m0), step=lh.Corrected(lh.Euler(), 3), dt=0.05)
    assert (run.report.order, run.report.rank, run.report.orbit_dimension) == (1, 3, 4)
    with pytest.raises(lh.errors.InputError, match="take LieTaylor"):
        pair.integrate((0, 1), m0, step=lh.Corrected(lh.Euler(), 3), dt=0.05)


def test_coupled_spins_keep_one_time() -> None:
    model, m0 = LandauLifshitz((3,), exchange=1.0), on_sphere(14, 3)
    with pytest.raises(lh.errors.InputError, match="one number dt"):
        model.integrate((0, 1), m0, dt=[0.1, 0.1, 0.2])
    with pytest.raises(lh.errors.InputError, match="events"):
        model.integrate((0, 1), m0, dt=0.1, events=lambda t, y: y[0])
    with pytest.raises(lh.errors.InputError, match="not of length 1"):
        model.integrate((0, 1), 2 * m0, dt=0.1)
    with pytest.raises(lh.errors.ShapeError, match=r"expected \(\.\.\., 3, 3\)"):
        model.integrate((0, 1), m0[:2], dt=0.1)


def test_joint_spins_are_the_same_system_with_common_step_sizes() -> None:
    model = LandauLifshitz(
        (2, 2), exchange=1.0, applied=lambda t: [np.cos(t), 0 * t, 0 * t], damping=0.2, periodic=False
    )
    m0, joint = on_sphere(15, 3, 2, 2), model.joint()
    assert np.array_equal(joint.spins(joint.point(m0)), m0)
    here = model.field.vector(m0, np.full((3, 2, 2), 0.4))
    assert np.allclose(joint.spins(joint.field.vector(joint.point(m0), np.full(3, 0.4))), here)
    fixed = model.integrate((0, 2), m0, step=lh.LieTaylor(6), dt=0.02, t_eval=[2.0])
    adapted = lh.integrate(joint.field, (0, 2), joint.point(m0), rtol=1e-10, atol=1e-12, t_eval=[2.0])
    assert np.abs(joint.spins(adapted.y[..., -1]) - fixed.y[..., -1]).max() < 1e-8


@pytest.mark.parametrize("step", [lh.LieTaylor(4), lh.RKMK("rk45"), lh.Heun()])
def test_adaptive_steps_of_a_grid_are_those_of_all_spins_as_one_point(step: Any) -> None:
    """One size for each lattice, by the error of all its spins: the lattices of an ensemble have sizes of their own."""
    model = LandauLifshitz(
        (4, 3), exchange=1.0, anisotropy=0.3, applied=lambda t: [np.cos(t), 0 * t, 0 * t], damping=0.1
    )
    joint, m0 = model.joint(), on_sphere(19, 2, 4, 3)
    grid = model.integrate((0, 2), m0, step=step, rtol=1e-5, atol=1e-8)
    point = lh.integrate(joint.field, (0, 2), joint.point(m0), step=step, rtol=1e-5, atol=1e-8)
    assert np.ptp(grid.n_steps, axis=(1, 2)).max() == 0
    assert np.array_equal(grid.n_steps[:, 0, 0], point.n_steps)
    assert np.allclose(np.where(np.isnan(grid.t[:, 0, 0]), 0, grid.t[:, 0, 0] - point.t), 0, rtol=0, atol=1e-12)
    ends = [np.moveaxis(grid.y[k], -1, 0)[point.n_steps[k]] for k in range(2)]
    wanted = [joint.spins(point.y[k, :, point.n_steps[k]]) for k in range(2)]
    assert np.allclose(ends, wanted, rtol=0, atol=1e-12)
    one = model.integrate((0, 2), m0[0], step=step, rtol=1e-5, atol=1e-8)
    assert one.n_steps[0, 0] == grid.n_steps[0, 0, 0]


@pytest.mark.filterwarnings("ignore:status -1")
def test_a_lattice_fails_as_a_whole() -> None:
    model = LandauLifshitz((3,), exchange=1.0, applied=lambda t: [np.where(t > 0.5, np.nan, 0.0) + 0 * t, 0 * t, 0 * t])
    sol = model.integrate((0, 1), on_sphere(20, 3), step=lh.RKMK("rk45"))
    assert sol.status == -1
    assert (sol.statuses == -1).all()


def test_many_spins_are_joined_without_their_matrices() -> None:
    """100 spins: 300 matrices of size 300, of which none is made."""
    action = lh.Action(LandauLifshitz((10, 10), exchange=1.0).joint().representation)
    assert action.exponential.name == "exp (Rodrigues in blocks)"
    few = LandauLifshitz((4,), exchange=1.0).joint().representation
    explicit = lh.Representation(few.algebra, [a.to_numpy().astype(int) for a in few.matrices])
    assert few == explicit
    x, m = np.random.default_rng(0).normal(size=(2, 12))
    result, wanted = lh.Action(few), lh.Action(explicit)
    assert np.allclose(result.infinitesimal(x, m), wanted.infinitesimal(x, m), atol=1e-15)
    assert np.allclose(result.bracket(x, m), wanted.bracket(x, m), atol=1e-15)
    assert np.allclose(result.inner_product.matrix, wanted.inner_product.matrix, atol=1e-12)
    assert result.inner_product.invariant
    assert abs(result.max_norm - wanted.max_norm) < 1e-12
    assert np.allclose(result.act(x, m), lh.Action(explicit, "expm").act(x, m), atol=1e-13)


# -- energy and length -----------------------------------------------------------------------------------
def test_lengths_and_the_decay_of_energy_on_a_grid() -> None:
    model = LandauLifshitz((20, 20), exchange=1.0, anisotropy=0.2, applied=0.1 * Z, damping=0.3)
    sol = model.integrate((0, 10), on_sphere(16, 20, 20), step=lh.RKMK("rk4"), dt=0.1, t_eval=np.arange(0, 10.5, 0.5))
    m = np.moveaxis(sol.y, -1, 0)
    assert np.abs(np.linalg.norm(m, axis=-1) - 1).max() < 1e-14
    energy = model.energy(m)
    assert (np.diff(energy) < 0).all()
    assert energy[-1] < energy[0] - 100
    assert (energy >= -(800 + 400 * 0.3) - 1e-9).all()


def test_energy_without_damping_is_kept_to_the_order_of_the_method() -> None:
    model, m0 = LandauLifshitz((6,), exchange=1.0, anisotropy=0.3, applied=[0.2, 0, 0.1]), on_sphere(17, 4, 6)
    for step, order in ((lh.Euler(), 1), (lh.LieTaylor(2), 2), (lh.LieTaylor(4), 4)):
        errors = []
        for dt in (0.1, 0.05, 0.025):
            sol = model.integrate((0, 2), m0, step=step, dt=dt, t_eval=[2.0])
            errors.append(float(np.sqrt(np.mean((model.energy(sol.y[..., -1]) - model.energy(m0)) ** 2))))
        assert slopes(errors)[-1] > order - 0.25


def test_isotropy_conserves_energy_and_momentum_of_coupled_spins() -> None:
    """n directions of isotropy, and two integrals: the energy, and the part of the total spin along the axis."""
    model = LandauLifshitz((5,), exchange=1.0, anisotropy=0.3, applied=0.2 * Z)
    joint, m0 = model.joint(), on_sphere(18, 5)

    def integrals(point: Any) -> Any:
        spins = joint.spins(point)
        return np.stack([model.energy(spins), np.sum(spins[..., 2], axis=-1)], axis=-1)

    kept, free = (
        integrals(lh.integrate(joint.field, (0, 10), joint.point(m0), step=step, dt=0.1).y.T)
        for step in (Conserving(lh.Heun(), integrals), lh.Heun())
    )
    assert np.abs(kept - kept[0]).max() < 1e-14
    assert np.abs(free - free[0]).max(axis=0).min() > 1e-5


def test_isotropy_conserves_the_energy_of_each_uncoupled_spin() -> None:
    spin = LandauLifshitz(anisotropy=0.7, axis=[1, 0, 0], applied=[0.2, 0, 0.5])
    sol = spin.integrate((0, 20), on_sphere(19, 4), step=Conserving(lh.Heun(), spin.energy), dt=0.1)
    energy = spin.energy(np.moveaxis(sol.y, -1, 0))
    assert np.abs(energy - energy[0]).max() < 1e-14
