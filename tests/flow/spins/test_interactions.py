"""Fields of the interactions of spins are minus the gradients of their energies; ground states that are known."""

from typing import Any

import numpy as np
import pytest
from scipy.stats import special_ortho_group

import liehom as lh
from liehom.flow.spins import LandauLifshitz, SpinLattice
from tests.studies.support import on_sphere


def gradient(energy: Any, m: Any) -> Any:
    """Central differences of a polynomial of degree at most 4, exact to h^2 of its third derivatives."""
    h, out = 1e-4, np.zeros(m.shape)
    for index in np.ndindex(*m.shape):
        step = np.zeros(m.shape)
        step[index] = h
        out[index] = (energy(m + step) - energy(m - step)) / (2 * h)
    return out


AXES = special_ortho_group.rvs(3, random_state=3)


@pytest.mark.parametrize(("shape", "options"), [
    ((4,), {"dmi": 0.7}), ((3, 4), {"dmi": 0.7, "dmi_kind": "interfacial"}),
    ((3, 4), {"dmi": -0.4, "exchange": 1.0, "periodic": (True, False)}),
    ((2, 3, 3), {"dmi": 0.5, "periodic": (False, True, True)}), ((3,), {"cubic": 0.8, "cubic_axes": AXES}),
    ((3,), {"cubic": [0.8, -0.3, 0.1], "anisotropy": 0.2, "axis": [1.0, 2.0, 0.5], "exchange": 0.3}),
    ((1, 4), {"dmi": 0.5, "exchange": 0.5, "periodic": (False, True)}),
])  # fmt: skip
def test_fields_are_minus_the_gradients_of_the_energies(shape: Any, options: Any) -> None:
    model, m = LandauLifshitz(shape, applied=[0.1, -0.2, 0.3], **options), on_sphere(1, *shape)
    assert np.abs(model.effective_field(m) + gradient(model.energy, m)).max() < 1e-7


def test_energy_rate_holds_with_all_interactions() -> None:
    model = LandauLifshitz((4, 3), exchange=1.0, dmi=0.5, cubic=0.3, anisotropy=0.2, damping=0.2, applied=[0, 0, 0.1])
    m = on_sphere(2, 4, 3)
    sols = [model.integrate((0, t), m, dt=1e-3).y[..., -1] for t in (1e-3, -1e-3)]
    rate = (model.energy(sols[0]) - model.energy(sols[1])) / 2e-3
    assert abs(rate - model.energy_rate(m)) < 1e-4 * abs(rate)


@pytest.mark.parametrize(("kind", "plane"), [("bulk", (1, 2)), ("interfacial", (0, 2))])
def test_spirals_are_equilibria_of_a_chain(kind: str, plane: tuple[int, int]) -> None:
    """The angle between neighbours is arctan(D/J); the sense of rotation is that of the sign of D."""
    n, d = 12, np.tan(2 * np.pi / 12)
    model = LandauLifshitz((n,), exchange=1.0, dmi=d, dmi_kind=kind, damping=0.5)
    energies = []
    for sign in (1, -1):
        angle = sign * 2 * np.pi / n * np.arange(n)
        m = np.zeros((n, 3))
        m[:, plane[0]], m[:, plane[1]] = np.cos(angle), np.sin(angle)
        assert np.abs(np.cross(m, model.effective_field(m))).max() < 1e-14
        energies.append(model.energy(m))
    assert np.allclose(sorted(energies), [-n * np.sqrt(1 + d**2), -n * np.cos(np.pi / 6) * (1 - d**2)], atol=1e-12)
    assert np.allclose(model.energy(np.tile([1.0, 0, 0], (n, 1))), -n)


def test_cubic_anisotropy_has_its_easy_axes() -> None:
    for strength, easy in ((1.0, [1.0, 0, 0]), (-1.0, np.ones(3) / np.sqrt(3))):
        model = LandauLifshitz(cubic=strength, cubic_axes=AXES, damping=0.5)
        m = AXES @ easy
        assert np.abs(np.cross(m, model.effective_field(m))).max() < 1e-15
        near = m + 0.1 * on_sphere(4)
        assert np.abs(model.integrate((0, 60), near / np.linalg.norm(near)).y[:, -1] - m).max() < 1e-3


def test_spin_torque_turns_a_spin_against_the_damping() -> None:
    """A field a m x p gives h_parallel alpha + a: it overcomes the damping at a = -alpha H for p along H."""
    for torque, end in ((-0.05, 1.0), (-0.2, -1.0)):
        spin = LandauLifshitz(applied=[0, 0, 1.0], damping=0.1, spin_torque=torque, polarization=[0, 0, 1.0])
        assert abs(spin.integrate((0, 200), [0.6, 0.0, 0.8]).y[2, -1] - end) < 1e-3
        assert np.allclose(spin.effective_field([0.6, 0.0, 0.8]), [0, 0, 1.0])


def test_all_interactions_compile() -> None:
    pytest.importorskip("llvmlite")
    model = LandauLifshitz(
        (5, 4), exchange=1.0, dmi=0.5, dmi_kind="interfacial", cubic=0.3, cubic_axes=AXES, anisotropy=0.2, damping=0.1,
        spin_torque=0.2, applied=lambda t: [np.cos(t), 0 * t, 0 * t], periodic=(True, False),
    )  # fmt: skip
    m = on_sphere(5, 5, 4)
    options: dict[str, Any] = {"step": lh.RKMK("rk4"), "dt": 0.05, "t_eval": [1.0]}
    plain, sol = model.integrate((0, 1), m, **options), model.integrate((0, 1), m, engine="llvm", **options)
    assert np.abs(plain.y - sol.y).max() < 1e-13


def test_arguments_that_are_refused() -> None:
    for options, message in (
        ({"dmi": 1.0, "dmi_kind": "twisted"}, "dmi_kind"),
        ({"cubic": 1.0, "cubic_axes": np.ones((3, 3))}, "orthonormal"),
        ({"temperature": -1.0}, "temperature"),
        ({"temperature": 1.0}, "damping"),
    ):
        with pytest.raises(lh.errors.InputError, match=message):
            LandauLifshitz((3,), **options)
    with pytest.raises(lh.errors.InputError, match="at most 3"):
        LandauLifshitz((3, 3, 3, 3), dmi=1.0)


def test_the_shape_of_a_lattice_is_a_tuple_of_int() -> None:
    lattice = SpinLattice((np.int64(3), np.int64(4)), (np.bool_(True), np.bool_(False)))  # type: ignore[arg-type]
    assert (lattice.shape, lattice.periodic) == ((3, 4), (True, False))
    assert {type(x) for x in lattice.shape} == {int} and {type(x) for x in lattice.periodic} == {bool}
