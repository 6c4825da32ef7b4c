"""Conserving steps along runs: first integrals to round-off, what `integrate` offers with them, honest refusals."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import liehom as lh
from liehom.base.errors import InputError
from liehom.flow.steps.conserving import Conserving
from liehom.flow.steps.first_integral import combination, conservation_map
from liehom.flow.steps.step import Generator
from liehom.io.solution_file import save_solution
from tests.flow.steps.support import OMEGA, exact_flow, quadratic, rigid_body, slopes, spin, unit
from tests.flow.steps.test_conservation import energy, quadratic_energy, quartic, spin_energy, spin_start, spins

BASES: dict[str, lh.Step] = {
    "Euler": lh.Euler(), "Heun": lh.Heun(), "RKMK4": lh.RKMK("rk4"), "LieTaylor": lh.LieTaylor(4),
}  # fmt: skip
START = unit(3, 3)


def drift(F: Any, solution: Any, start: Any) -> Any:
    """The largest |F(t) - F(0)|, of every integral."""
    return np.nanmax(np.abs(F(np.moveaxis(solution.y, -2, -1)) - F(np.asarray(start))[..., None]), axis=-1)


# -- to round-off ----------------------------------------------------------------------------------------
@pytest.mark.parametrize("base", BASES)
def test_the_energy_of_the_rigid_body_stays_within_1e_14(base: str) -> None:
    steps = 10_000 if base == "Heun" else 3000
    check_long_run(base, steps)


@pytest.mark.slow
@pytest.mark.parametrize("base", BASES)
def test_the_energy_of_the_rigid_body_stays_within_1e_14_over_a_million_steps(base: str) -> None:
    check_long_run(base, 1_000_000)


def check_long_run(base: str, steps: int) -> None:
    end = 0.1 * steps
    step = Conserving(BASES[base], energy)
    sol = lh.integrate(rigid_body(), (0, end), START, step=step, dt=0.1, t_eval=np.linspace(0, end, 501))
    report = sol.report.conservation
    assert sol.success and sol.n_steps == steps
    assert report.defect < 1e-14 and report.missed_steps == 0 and report.rank == report.wanted == 1  # at every step
    assert drift(energy, sol, START) < 1e-14
    sizes = np.abs(np.linalg.norm(sol.y, axis=0) - 1).max()
    print(
        f"{base}: energy {report.defect:.2g}, |m| - 1 {sizes:.2g} after {steps} steps; {report.iterations} iterations"
    )
    assert sizes < 1e-15 * steps**0.5 + 1e-14


def test_without_conservation_the_energy_is_lost() -> None:
    """The control of the test before."""
    sol = lh.integrate(rigid_body(), (0, 200), START, step=lh.Heun(), dt=0.1)
    assert drift(energy, sol, START) > 1e-6


def walk(steps: int, aim: str) -> float:
    end = 0.1 * steps
    step = Conserving(lh.Heun(), energy, aim=aim)
    sol = lh.integrate(rigid_body(), (0, end), START, step=step, dt=0.1, t_eval=np.linspace(0, end, 501))
    return float(drift(energy, sol, START))


@pytest.mark.slow
def test_aiming_at_the_previous_point_lets_round_off_walk() -> None:
    aimed, walked = walk(100_000, "start"), walk(100_000, "previous")
    print(f"after 10^5 steps: aiming at the start {aimed:.2g}, at the previous point {walked:.2g}")
    assert aimed < 1e-15 and 5 * aimed < walked < 1e-12


def test_aiming_at_the_previous_point_is_local() -> None:
    assert walk(300, "previous") < 1e-13
    field, step = rigid_body(), Conserving(lh.Euler(), energy, aim="previous")
    psi, m = Generator(field, 2, np.array([1.0, 0, 0])), START
    local = step.at(lh.Action(field.representation), psi, m, np.zeros(1))
    z = local.found.action.act(local.factors(np.array([0.1]))[0], m)
    assert abs(energy(z) - energy(m)) < 1e-15  # not the energy of the start


@pytest.mark.parametrize("base", [lh.Euler(), lh.Heun(), lh.methods.CrouchGrossman3(), lh.BackwardEuler()])
def test_an_integral_that_is_no_quadratic_form(base: Any) -> None:
    m = unit(8, 3)
    sol = lh.integrate(quadratic_energy(), (0, 20), m, step=Conserving(base, quartic), dt=0.1)
    plain = lh.integrate(quadratic_energy(), (0, 20), m, step=base, dt=0.1)
    assert drift(quartic, sol, m) < 2e-15 and sol.report.conservation.missed_steps == 0
    assert drift(quartic, plain, m) > 1e-7


@pytest.mark.parametrize("base", [lh.Euler(), lh.Heun(), lh.LieTaylor(3)])
def test_the_order_of_the_base_is_kept(base: Any) -> None:
    field, m, sizes = rigid_body(), START, np.array([0.2, 0.1, 0.05])
    wanted = exact_flow(field, m, 4.0)
    errors = []
    for dt in sizes:
        y = lh.integrate(field, (0, 4), m, step=Conserving(base, energy), dt=dt).y[:, -1]
        errors.append(np.linalg.norm(y - wanted))
    assert np.all(slopes(sizes, errors) > base.order - 0.3)


# -- any representation ----------------------------------------------------------------------------------
def symmetric(*eigenvalues: float) -> Any:
    return [float(x) for x in lh.representations.symmetric_to_vector(np.diag(eigenvalues).tolist())]


SPACES: dict[str, tuple[Any, Any]] = {
    "so(5) on S^4": (lambda: lh.defining(lh.so(5)), [0.6, 0, 0.8, 0, 0]),
    "so(3) on Sym(3) at (1, 1, 2)": (lambda: lh.sym_conjugation(3), symmetric(1, 1, 2)),
    "so(4) on Sym(4) at (1, 1, 2, 2)": (lambda: lh.sym_conjugation(4), symmetric(1, 1, 2, 2)),
    "g2 on S^6": (lambda: lh.defining("g2"), None),
    "sl(2) on a hyperboloid": (lambda: lh.adjoint(lh.sl(2)), [1.0, 0.3, 0.2]),
    "coadjoint su(3)": (lambda: lh.coadjoint(lh.su(3)), [0.3, -0.2, 0.5, 0.1, 0.4, -0.3, 0.2, 0.6]),
}


def conservative(rho: lh.Representation, seed: int) -> tuple[lh.GeneratorField, Any]:
    """A field with a random cubic first integral: psi = K v with K antisymmetric and v_i = DF(m) rho(e_i) m."""
    rng, n, d = np.random.default_rng(seed), rho.size, rho.algebra.dimension
    a, b, c, k = rng.normal(size=(n, n)), rng.normal(size=n), rng.normal(size=n), rng.normal(size=(d, d))
    tensor = np.array([x.to_numpy() for x in rho.matrices])

    def F(m: Any) -> Any:
        return np.einsum("...i,ij,...j->...", m, a, m) / n + (m @ b) ** 3 / (3 * n) + m @ c

    def psi(m: Any) -> Any:
        slope = m @ (a + a.T) / n + np.einsum("...,i->...i", (m @ b) ** 2, b) / n + c
        return np.einsum("...i,aij,...j->...a", slope, tensor, m) @ (k - k.T) / d

    return lh.GeneratorField(rho, psi), F


@pytest.mark.parametrize("base", [lh.Heun(), lh.methods.CrouchGrossman3()])
@pytest.mark.parametrize("space", SPACES)
def test_any_integral_of_any_representation(space: str, base: Any) -> None:
    make, m = SPACES[space]
    rho = make()
    m = np.eye(rho.size)[0] if m is None else np.array(m)
    field, F = conservative(rho, len(space))
    dt = 0.03 / np.linalg.norm(field.psi(m))
    end = (10 if "hyperboloid" in space else 20) * dt  # later it meets chi = 0, as indefinite forms allow
    sol = lh.integrate(field, (0, end), m, step=Conserving(base, F), dt=dt)
    plain = lh.integrate(field, (0, end), m, step=base, dt=dt)
    report = sol.report.conservation
    assert sol.success and (report.rank, report.wanted, report.missed_steps) == (1, 1, 0)
    assert drift(F, sol, m) < 1e-14 * max(1, abs(F(m))) and drift(F, plain, m) > 10 * drift(F, sol, m)


# -- several integrals -----------------------------------------------------------------------------------
MASSES = np.array([1.0, 1.7, 2.3, 3.1])
PLACES = [(i, j) for i in range(4) for j in range(i + 1, 4)]
TOP = np.array([1 / (MASSES[i] + MASSES[j]) for i, j in PLACES])
SECOND = np.array([MASSES[i] ** 2 + MASSES[j] ** 2 for i, j in PLACES])


def top_integrals(m: Any) -> Any:
    """Of Manakov's top on so(4): the energy, and the integral that makes it integrable."""
    return np.stack([np.sum(m * m * TOP, axis=-1), np.sum(m * m * SECOND, axis=-1)], axis=-1) / 2


def test_two_integrals_on_the_coadjoint_orbits_of_so4() -> None:
    field = lh.GeneratorField(lh.coadjoint(lh.so(4)), lambda m: m * TOP)
    m = np.random.default_rng(1).normal(size=6)
    sol = lh.integrate(field, (0, 10), m, step=Conserving(lh.Heun(), top_integrals), dt=0.05)
    plain = lh.integrate(field, (0, 10), m, step=lh.Heun(), dt=0.05)
    lost = np.abs(top_integrals(sol.y.T) - top_integrals(m)).max(axis=0) / np.abs(top_integrals(m))
    assert np.all(lost < 1e-14) and np.all(np.abs(top_integrals(plain.y.T) - top_integrals(m)).max(axis=0) > 1e-8)
    report = sol.report.conservation
    assert report.rank == report.wanted == 2 and report.missed_steps == report.short_steps == 0


def spin_integrals(m: Any) -> Any:
    """Energy and the z-component of the total spin."""
    return np.stack([spin_energy(m, 0.4), m[..., 2] + m[..., 5]], axis=-1)


@pytest.mark.parametrize("base", [lh.Heun(), lh.RKMK("rk4"), lh.methods.CommutatorFree4()])
def test_two_coupled_spins_keep_energy_and_one_component(base: Any) -> None:
    m = spin_start(4, 3)
    sol = lh.integrate(spins(0.4), (0, 5), m, step=Conserving(base, spin_integrals), dt=0.05)
    y = np.moveaxis(sol.y, -2, -1)
    assert np.abs(spin_integrals(y) - spin_integrals(m)[:, None]).max() < 4e-15
    assert np.abs(np.linalg.norm(y.reshape(3, -1, 2, 3), axis=-1) - 1).max() < 1e-13
    assert sol.report.conservation.rank == 2 and sol.report.conservation.missed_steps == 0


def test_steps_that_miss_are_counted() -> None:
    """chi of two integrals loses rank on the way; the corrections of a first-order base are too large for that."""
    m = spin_start(4, 3)[0]
    sol = lh.integrate(spins(0.4), (0, 5), m, step=Conserving(lh.Euler(), spin_integrals), dt=0.05)
    lost = np.abs(spin_integrals(sol.y.T) - spin_integrals(m)).max(axis=-1)
    report = sol.report.conservation
    assert sol.success and report.missed_steps == np.sum(lost > 1e-14) > 0
    assert np.isclose(report.defect, lost.max()) and f"NOT to round-off after {report.missed_steps}" in str(report)


def test_an_integral_that_isotropy_does_not_reach_is_refused_by_name() -> None:
    m = spin_start(2)
    normal = np.cross(m[:3], m[3:])
    z = normal / normal[np.abs(normal).argmax()]
    with pytest.raises(
        InputError, match=r"isotropy does not reach .* rank 2, and 3 integrals are independent"
    ) as error:
        lh.integrate(spins(0.0), (0, 1), m, step=Conserving(lh.Heun(), lambda m: m[..., :3] + m[..., 3:]), dt=0.1)
    for i, x in enumerate(z):
        assert ("" if abs(x) == 1 else f"{abs(x):.6g} ") + f"F[{i}]" in str(error.value)


def test_a_trivial_isotropy_is_refused() -> None:
    rho = lh.sym_conjugation(3)
    m = np.array([float(x) for x in lh.representations.symmetric_to_vector([[1, 1, 0], [1, 2, 1], [0, 1, 4]])])
    kernel = np.linalg.svd(np.array(rho.matrices[0].to_numpy()))[2][-1]
    with pytest.raises(InputError, match=r"does not reach F: .* rank 0, and 1 integrals"):
        lh.integrate(
            lh.GeneratorField(rho, [1, 0, 0]), (0, 1), m, step=Conserving(lh.Heun(), lambda m: m @ kernel), dt=0.1
        )


def test_what_is_no_first_integral_is_refused_with_its_derivative() -> None:
    field, m = quadratic(spin(), 3), unit(2, 3)
    slope = str(np.array([np.sum(OMEGA * m * field.vector(m))]))
    with pytest.raises(InputError, match="not a first integral: .*" + re.escape(slope[:7])):
        lh.integrate(field, (0, 1), m, step=Conserving(lh.Heun(), energy), dt=0.1)


def degenerate() -> Any:
    """Spins at which chi of energy and S_z has rank 1, between two where its determinant has different signs."""
    ends = spin_start(7, 40)
    values = determinant(ends)
    low, high = ends[np.argmax(values < 0)], ends[np.argmax(values > 0)]

    def between(s: float) -> Any:
        m = ((1 - s) * low + s * high).reshape(2, 3)
        return (m / np.linalg.norm(m, axis=-1, keepdims=True)).reshape(6)

    return between(brentq(lambda s: float(determinant(between(s))), 0.0, 1.0, xtol=1e-15, rtol=1e-15))


def determinant(m: Any) -> Any:
    """Of chi on the basis (m1, 0), (0, m2) of the isotropy."""
    chi = conservation_map(spins(0.4), lh.Heun(), m, spin_integrals)
    zero = np.zeros_like(m[..., :3])
    first, second = np.concatenate([m[..., :3], zero], -1), np.concatenate([zero, m[..., 3:]], -1)
    return np.linalg.det(np.stack([chi(first), chi(second)], axis=-1))


def test_points_where_chi_is_not_onto_are_reported() -> None:
    m = degenerate()
    sol = lh.integrate(spins(0.4), (0, 1), m, step=Conserving(lh.Heun(), spin_integrals), dt=0.01)
    report = sol.report.conservation
    time, point, names = report.short_at
    assert sol.success and report.short_steps == 1 and (report.rank, report.wanted) == (1, 2)
    assert time == 0.0 and point == tuple(m)
    chi = conservation_map(spins(0.4), lh.Heun(), m, spin_integrals)
    z = chi.unreachable()[0]
    assert names == combination(z) and np.abs(z @ chi.matrix).max() < 1e-10 < np.abs(z @ chi.tangential).max()
    assert "chi is NOT onto at 1 steps" in str(sol.report) and f"does not reach {names}" in str(sol.report)
    lost = np.abs(spin_integrals(sol.y.T) - spin_integrals(m)).max(axis=-1)
    # one combination is lost at the first step, and won back later
    assert 1e-14 < lost[1] < 1e-6 and lost[-1] < 1e-14 and report.missed_steps >= 1


# -- what integrate offers -------------------------------------------------------------------------------
@pytest.mark.parametrize(
    "base", [lh.RKMK("rk45"), lh.LieTaylor(4), lh.Corrected(lh.Euler(), 4), lh.methods.CommutatorFree4()]
)
def test_adaptive_steps_dense_output_and_events(base: Any) -> None:
    field, step = rigid_body(), Conserving(base, energy)
    sol = lh.integrate(field, (0, 15), START, step=step, rtol=1e-6, dense_output=True, events=lambda t, y: y[..., 1])
    assert sol.success and drift(energy, sol, START) < 1e-15 and len(sol.t_events[0]) > 1
    assert np.abs(energy(sol.y_events[0]) - energy(START)).max() < 1e-15
    times = np.linspace(0, 15, 41)
    assert np.abs(energy(sol.sol(times).T) - energy(START)).max() < 1e-15
    assert np.linalg.norm(sol.y[:, -1] - exact_flow(field, START, 15.0)) < 2e-4
    sampled = lh.integrate(field, (0, 15), START, step=step, rtol=1e-6, t_eval=times)
    assert drift(energy, sampled, START) < 1e-15
    assert np.allclose(sampled.y, sol.sol(times), atol=1e-5)


def test_the_steps_of_an_ensemble_are_those_of_its_members() -> None:
    field, m = rigid_body(), np.concatenate([unit(5, 3, 3), np.eye(3)[1:2]])
    step = Conserving(lh.Heun(), energy)
    sol = lh.integrate(field, (0, 5), m.reshape(2, 2, 3), step=step, dt=0.1)
    for i, start in enumerate(m):
        alone = lh.integrate(field, (0, 5), start, step=step, dt=0.1)
        assert np.allclose(sol.y.reshape(4, 3, -1)[i], alone.y, rtol=0, atol=1e-12)
    assert np.all(drift(energy, sol, m.reshape(2, 2, 3)) < 1e-15)
    assert sol.report.conservation.left_steps == 50 and "left alone at 50 steps" in str(sol.report)


def test_each_trajectory_may_have_parameters_of_its_own() -> None:
    om = np.random.default_rng(1).uniform(0.3, 1.2, size=(5, 3))
    field = lh.GeneratorField(spin(), lambda m: -m * om)
    F = lambda m: np.sum(m * m * om, axis=-1)  # noqa: E731
    m = unit(9, 5, 3)
    y = np.moveaxis(lh.integrate(field, (0, 5), m, step=Conserving(lh.Euler(), F), dt=0.1).y, -1, 0)
    assert np.abs(F(y) - F(m)).max() < 2e-15


def test_trajectories_of_different_lengths_end_each_for_itself() -> None:
    field, m = rigid_body(), unit(5, 4, 3) * [[0.5], [1.0], [2.0], [4.0]]
    sol = lh.integrate(field, (0, 5), m, step=Conserving(lh.RKMK("rk45"), energy), rtol=1e-5)
    assert np.isnan(sol.y).any() and np.all(drift(energy, sol, m) < 1e-15 * np.sum(m * m, axis=-1))


def test_a_run_that_was_interrupted_continues_bit_for_bit(tmp_path: Path) -> None:
    field, m = rigid_body(), unit(5, 2, 3)
    options: dict[str, Any] = {"step": Conserving(lh.Heun(), energy), "dt": 0.1}
    sol = lh.integrate(field, (0, 6), m, **options, engine="numpy")
    path = tmp_path / "state.npz"

    class Interruption(Exception):
        pass

    def stop(fraction: float) -> None:
        if fraction > 0.4:
            raise Interruption

    with pytest.raises(Interruption):
        lh.integrate(field, (0, 6), m, **options, checkpoint=path, progress=stop)
    resumed = lh.integrate(field, (0, 6), m, **options, checkpoint=path)
    assert np.array_equal(sol.y, resumed.y) and sol.report == resumed.report
    assert not path.exists()


def test_the_account_of_what_is_not_reached_survives_an_interruption(tmp_path: Path) -> None:
    m = degenerate()
    options: dict[str, Any] = {"step": Conserving(lh.Heun(), spin_integrals), "dt": 0.01}
    path = tmp_path / "state.npz"

    def stop(fraction: float) -> None:
        if fraction > 0.4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        lh.integrate(spins(0.4), (0, 1), m, **options, checkpoint=path, progress=stop)
    resumed = lh.integrate(spins(0.4), (0, 1), m, **options, checkpoint=path)
    assert resumed.report == lh.integrate(spins(0.4), (0, 1), m, **options).report


def test_a_given_value_is_aimed_at() -> None:
    """A second run continues the first one, with its energy."""
    field, step = rigid_body(), Conserving(lh.Heun(), energy)
    first = lh.integrate(field, (0, 5), START, step=step, dt=0.1)
    wanted = float(energy(START)) + 1e-9  # not that of the new start, to see the difference
    second = lh.integrate(field, (5, 10), first.y[:, -1], step=Conserving(lh.Heun(), energy, value=wanted), dt=0.1)
    assert np.abs(energy(second.y[:, 1:].T) - wanted).max() < 1e-15
    with pytest.raises(InputError, match="the value has shape"):
        lh.integrate(field, (0, 1), START, step=Conserving(lh.Heun(), energy, value=[1.0, 2.0]), dt=0.1)


def test_extended_precision_is_kept() -> None:
    m = START.astype(np.longdouble)
    if np.finfo(np.longdouble).eps > 1e-18:
        pytest.skip("the platform has no extended precision")
    om = OMEGA.astype(np.longdouble)
    field = lh.GeneratorField(spin(), lambda m: -m * om)
    F = lambda m: np.sum(m * m * om, axis=-1) / 2  # noqa: E731
    sol = lh.integrate(field, (0, 5), m, step=Conserving(lh.Heun(), F), dt=0.1)
    assert sol.y.dtype == np.longdouble and drift(F, sol, m) < 1e-18
    twice = lh.integrate(
        field, (0, 5), m, step=Conserving(lh.Heun(), lambda m: np.stack([F(m), np.sum(m * m, -1)], -1)), dt=0.1
    )
    assert np.abs(F(twice.y.T) - F(m)).max() < 1e-18


def test_cayley_and_backward_runs() -> None:
    step = Conserving(lh.Heun(), energy)
    sol = lh.integrate(rigid_body(), (5, 0), START, step=step, dt=0.1, exponential="cayley")
    assert sol.t[-1] == 0 and drift(energy, sol, START) < 1e-15


def test_time_dependent_fields_may_have_integrals() -> None:
    """m' = f(t) m x Om m, with an f that vanishes on the way."""
    field = lh.GeneratorField(spin(), lambda m, t: -(1 - t)[..., None] * m * OMEGA)
    step = Conserving(lh.Heun(), energy)
    sol = lh.integrate(field, (0, 3), START, step=step, dt=0.05)
    assert sol.success and drift(energy, sol, START) < 1e-15
    through = lh.integrate(field, (1, 3), START, step=step, dt=0.05)  # begins at the zero
    assert drift(energy, through, START) < 1e-15 and through.report.conservation.missed_steps == 0


def test_solutions_with_a_conservation_report_are_written(tmp_path: Path) -> None:
    sol = lh.integrate(rigid_body(), (0, 1), START, step=Conserving(lh.Heun(), energy), dt=0.1)
    path = tmp_path / "made.npz"
    save_solution(sol, path)
    with np.load(path) as file:
        read = json.loads(str(file["report"]))["report"]["conservation"]
    assert read["rank"] == 1 and read["defect"] == sol.report.conservation.defect
    assert lh.integrate(rigid_body(), (0, 1), START, step=lh.Heun(), dt=0.1).report.conservation is None


def test_a_clock_is_that_of_the_corrected_base() -> None:
    base = lh.Corrected(lh.Euler(), 4)
    sol = lh.integrate(rigid_body(), (0, 8), START, step=Conserving(base, energy), dt=0.05)
    assert np.linalg.norm(sol.y[:, -1] - exact_flow(rigid_body(), START, 8.0)) < 1e-5
    assert sol.report.base_order == 1 and sol.report.order == 4 and sol.report.conservation.rank == 1
    assert drift(energy, sol, START) < 1e-15


# -- equilibria ------------------------------------------------------------------------------------------
@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("distance", [0.0, 1e-14, 1e-12, 1e-8, 1e-6, 1e-3])
def test_equilibria_stay_and_their_neighbours_are_followed(axis: int, distance: float) -> None:
    e = np.roll(np.eye(3), -axis, axis=0)
    m = e[0] + distance * (e[1] + 0.7 * e[2])
    m /= np.linalg.norm(m)
    field = rigid_body()
    sol = lh.integrate(field, (0, 5), m, step=Conserving(lh.Heun(), energy), dt=0.1)
    plain = lh.integrate(field, (0, 5), m, step=lh.Heun(), dt=0.1)
    assert sol.success and drift(energy, sol, m) < 1e-15
    if distance == 0:
        assert np.all(sol.y == m[:, None])
    wanted = exact_flow(field, m, 5.0)
    lost = [np.linalg.norm(x.y[:, -1] - wanted) for x in (sol, plain)]
    assert lost[0] <= 1.5 * lost[1] + 1e-3 * distance
    report = sol.report.conservation
    assert report.left_steps == (50 if distance < 1e-8 else report.left_steps if distance < 1e-3 else 0)


def test_steps_of_size_zero_and_tiny_ones_change_nothing() -> None:
    field = rigid_body()
    local = Conserving(lh.Heun(), energy).at(
        lh.Action(field.representation), Generator(field, 2, START), START, np.zeros(1)
    )
    for h in (0.0, 1e-300, 1e-16, 1e-8):
        x = local._isotropy(np.array([h]))
        assert x is None or (np.all(np.isfinite(x)) and np.linalg.norm(x) <= h)


# -- arguments -------------------------------------------------------------------------------------------
@pytest.mark.parametrize(("arguments", "options", "message"), [
    ((3, "m0"), {}, "expected a step"), ((Conserving(lh.Euler(), "m0"), "m0"), {}, "a list of all integrals"),
    ((lh.Euler(), "m0"), {"aim": "end"}, "aim is 'end'"),
    ((lh.Euler(), "m0"), {"aim": "previous", "value": 1.0}, "leave out the value"),
])  # fmt: skip
def test_wrong_arguments_are_refused(arguments: Any, options: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Conserving(*arguments, **options)


def test_a_conserving_step_prints_what_it_is() -> None:
    result = Conserving(lh.Heun(), ["m0", "m1"], aim="previous")
    assert repr(result) == "Conserving(Heun(), ['m0', 'm1'], aim='previous')"
    assert repr(Conserving(lh.Heun(), energy, value=0.5)) == "Conserving(Heun(), energy, value=0.5)"
    assert (result.order, result.one_exponential) == (2, True)


def test_exact_points_are_refused() -> None:
    m = np.array([lh.QQ.convert(x) for x in ("3/5", 0, "4/5")])
    field = lh.GeneratorField(spin(), ["m0", 0, 0])
    with pytest.raises(InputError, match="numpy arrays of floats"):
        Conserving(lh.Heun(), "m1**2+m2**2").at(lh.Action(field.representation), Generator(field, 2), m, np.zeros(1))
