"""Each job of a journey answers what independent programs, tables or hand calculation answer."""

import runpy
from fractions import Fraction
from pathlib import Path

import pytest

from tests.journeys import (
    engineer,
    geometer,
    lecturer,
    particle_physicist,
    physics_student,
    quantum_physicist,
    researcher,
    roboticist,
)


def test_an_arm_moves_as_products_of_matrix_exponentials_do() -> None:
    assert engineer.arm() < 1e-8


def test_a_body_tracks_a_turning_target_with_bounded_torque() -> None:
    errors, beside_scipy = engineer.tracking()
    assert errors == sorted(errors, reverse=True) and errors[0] < 1e-3 and beside_scipy < 1e-7


def test_a_unicycle_is_controllable_and_driving_alone_is_not_a_rotation() -> None:
    assert engineer.unicycle().split(", ")[0].endswith("controllable")


def test_a_driven_end_controls_a_heisenberg_chain() -> None:
    assert quantum_physicist.driven_end() == (63, "su(8)", 63)


def test_a_drag_term_lowers_the_leakage() -> None:
    (without, with_term), beside_scipy = quantum_physicist.transmon()
    assert with_term < without / 4 and beside_scipy < 1e-7


def test_an_echo_refocuses_detuned_spins() -> None:
    free, echo, beside_expm = quantum_physicist.echo()
    assert free < 0.2 and echo > 0.99 and beside_expm < 1e-6


def test_einstein_metrics_of_a_wolf_space_and_of_two_three_spheres() -> None:
    symmetric, kinds, _, float_check = geometer.wolf_space()
    assert (symmetric, kinds, float_check) == ("True, 1 metric", 2, True)


def test_the_heisenberg_group_has_its_known_curvature() -> None:
    name, ricci, betti = geometer.nilmanifold()
    assert name == "A4,2(-2)" and ricci == ["-1/2", "-1/2", "1/2"] and betti == (1, 2, 2, 1)


def test_special_lagrangian_planes_are_a_symmetric_space_with_full_holonomy() -> None:
    symmetric, _, holonomy, verdict = geometer.special_lagrangians()
    assert symmetric and holonomy == "so(3)" and verdict.startswith("not full")


def test_the_16_of_so10_is_a_generation() -> None:
    assert particle_physicist.pati_salam() == ("(4,1,2) + (4bar,2,1)", "10_-1 + 5bar_3 + 1_-5", Fraction(0))


def test_the_standard_model_runs_as_in_the_textbooks() -> None:
    assert particle_physicist.running() == [Fraction(7), Fraction(19, 6)]


def test_cubic_invariants_of_grand_unification() -> None:
    cubic, ten, dimensions = particle_physicist.yukawas()
    assert (cubic, ten) == (1, 1) and sorted(map(int, dimensions)) == [10, 120, 126]


def test_euler_has_order_4_on_cubes_of_linear_forms_and_order_1_on_generic_cubics() -> None:
    researcher.binary_cubics()


def test_a_tableau_and_two_methods_of_the_researcher_have_their_orders() -> None:
    researcher.own_methods()


def test_the_energy_of_two_spins_is_bounded_or_drifts_as_the_step_says() -> None:
    researcher.two_spins()


def test_a_sheet_on_sl3_agrees_with_characters_by_hand(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    lecturer.sheet_on_sl3(tmp_path)


def test_a_body_flips_as_elliptic_integrals_say(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    lecturer.rigid_body_slide(tmp_path)


def test_real_algebras_of_dimension_three_are_found_in_ugly_bases() -> None:
    lecturer.three_dimensional()


def test_the_kepler_problem_has_its_three_symmetries() -> None:
    names, casimirs = zip(*physics_student.hydrogen(), strict=True)
    assert names == ("so(3) + so(3)", "so(3) ⋉ R^3", "sl(2,C)")
    assert all("A1*L1 + A2*L2 + A3*L3" in text for text in casimirs)


def test_a_driven_qubit_turns_over_as_rabi_says() -> None:
    beside_scipy, beside_rabi = physics_student.rabi()
    assert beside_scipy < 1e-7 and 1e-3 < beside_rabi < 0.05


def test_three_quarks_are_the_multiplets_of_the_textbooks() -> None:
    assert physics_student.eightfold_way() == (
        [1, 8, 8, 10],
        "3_0 + 2_1 + 2_-1 + 1_0",
        "4_1 + 3_0 + 2_-1 + 1_-2",
    )


def test_newton_finds_the_joints_of_an_arm() -> None:
    iterations, error = roboticist.inverse_kinematics()
    assert iterations < 8 and error < 1e-12


def test_an_attitude_from_samples_and_a_mean_are_those_of_scipy() -> None:
    attitude, mean = roboticist.attitude_from_samples()
    assert attitude < 1e-6 and mean < 1e-3


def test_what_steers_is_controllable() -> None:
    assert roboticist.steering() == [
        "so(3): controllable",
        "so(3) ⋉ R^3: controllable",
        "so(3) ⋉ R^3: accessible",
    ]


READERS = ["engineer", "quantum_physicist", "geometer", "particle_physicist", "researcher", "lecturer"]


@pytest.mark.parametrize("peer", [f"{reader}_peer" for reader in READERS])
def test_the_way_of_the_peers_runs(peer: str) -> None:
    pytest.importorskip("matplotlib")
    runpy.run_path(str(Path(__file__).with_name(f"{peer}.py")), run_name="__main__")
