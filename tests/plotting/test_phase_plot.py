"""Phase portraits: equilibria and their types, level sets, separatrices, and what is refused."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.studies.rigid_body import RigidBody

pytest.importorskip("matplotlib")

from liehom.base.errors import InputError
from liehom.plotting.canvas import COLOURS, DARK_COLOURS, new_figure, style
from liehom.plotting.phase_plot import between, equilibria, flow_of, plot_phase_portrait

ENERGY = "m0**2/2 + m1**2/4 + m2**2/6"
BODY = RigidBody([1, 2, 3])


def kinds(what: Any, **options: Any) -> dict[str, int]:
    found: dict[str, int] = {}
    for equilibrium in equilibria(flow_of(what, options.get("energy"), options.get("radius", 1.0))):
        found[equilibrium.kind] = found.get(equilibrium.kind, 0) + 1
    return found


def drawn(ax: Any, colour: str) -> np.ndarray:
    """The points (k, 3) of the lines of a color in axes in space, without arrowheads and markers."""
    lines = [np.array(line.get_data_3d(), dtype=float).T for line in ax.lines if line.get_color() == colour]
    points = np.concatenate([line for line in lines if len(line) > 3])
    return points[np.isfinite(points).all(axis=1)]


@pytest.mark.parametrize("radius", [1.0, 2.5, 1e3])
def test_equilibria_of_the_rigid_body_are_its_axes(radius: float) -> None:
    found = equilibria(flow_of(ENERGY, None, radius))
    wanted = BODY.equilibria(radius)
    assert len(found) == 6
    for equilibrium in found:
        assert np.abs(equilibrium.point - wanted).max(axis=1).min() < 1e-8 * radius
        assert equilibrium.kind == ("saddle" if (abs(equilibrium.point[1]) > 0.5 * radius) else "center")


@pytest.mark.parametrize(
    ("what", "wanted"),
    [
        ("m2", {"center": 2}),
        ("m0*m1*m2", {"center": 8, "saddle": 6}),
        ("m2**2 + 7*m0/10", {"center": 3, "saddle": 1}),
        ("m0**4 + m1**4 + m2**4", {"center": 14, "saddle": 12}),
        (BODY.energy, {"center": 4, "saddle": 2}),
    ],
)
def test_types_of_equilibria_have_the_index_of_the_sphere(what: Any, wanted: dict[str, int]) -> None:
    assert kinds(what) == wanted
    assert wanted["center"] - wanted.get("saddle", 0) == 2  # Poincare and Hopf


def test_damping_turns_centers_into_foci_and_a_gradient_has_nodes() -> None:
    rho = lh.adjoint(lh.so(3))
    inverse = np.array([1.0, 0.5, 1 / 3])
    damped = lh.GeneratorField(rho, lambda m: -m * inverse - 0.2 * np.cross(m, m * inverse))
    assert kinds(damped) == {"stable focus": 2, "unstable focus": 2, "saddle": 2}
    gradient = lh.GeneratorField(rho, lambda m: np.cross(m, m * inverse))
    assert kinds(gradient) == {"stable node": 2, "unstable node": 2, "saddle": 2}


def test_a_circle_of_equilibria_is_not_isolated() -> None:
    found = kinds("m0**2 + m1**2 + 2*m2**2")
    assert found["center"] == 2 and found["not isolated"] > 20


def test_level_sets_and_separatrices_are_drawn() -> None:
    ax = plot_phase_portrait(ENERGY)
    separatrix = drawn(ax, COLOURS[1])
    saddle = np.abs(np.abs(separatrix[:, 1]) - 1) < 1e-6
    assert np.abs(BODY.energy(separatrix[~saddle]) - 1 / 4).max() < 1e-3
    exact = np.concatenate([BODY.separatrix(np.linspace(0, 2 * np.pi, 90), branch) for branch in (1, -1)])
    assert np.linalg.norm(exact[:, None] - separatrix, axis=-1).min(axis=1).max() < 0.05  # all of both circles
    below, above = drawn(ax, COLOURS[0]), drawn(ax, COLOURS[2])
    assert np.abs(np.linalg.norm(np.concatenate([below, above]), axis=1) - 1).max() < 1e-9
    assert BODY.energy(below).max() < 1 / 4 < BODY.energy(above).min()
    assert len(np.unique((BODY.energy(above) - 1e-3).round(2))) == 5
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["separatrix", "center (4)", "saddle (2)"]


def test_a_field_without_an_energy_is_drawn_by_its_trajectories() -> None:
    field = BODY.field("b")
    separatrix = drawn(plot_phase_portrait(field), COLOURS[1])
    separatrix = separatrix[np.abs(np.abs(separatrix[:, 1]) - 1) > 1e-6]
    assert len(separatrix) > 300 and np.abs(BODY.energy(separatrix) - 1 / 4).max() < 1e-3
    with_energy = plot_phase_portrait(field, energy=BODY.energy)
    assert np.abs(BODY.energy(drawn(with_energy, COLOURS[1])) - 1 / 4).max() < 1e-3


def test_arrows_point_in_the_direction_of_the_field() -> None:
    ax = plot_phase_portrait("m2", new_figure(3, 3).add_subplot(projection="3d", elev=10, azim=0))
    heads = [np.array(line.get_data_3d()).T for line in ax.lines if np.shape(line.get_data_3d()) == (3, 3)]
    assert heads
    for back, tip, _ in heads:
        assert (tip - back) @ np.cross(tip, [0, 0, 1]) > 0


def test_the_far_side_is_faint_and_dark_pages_have_light_lines() -> None:
    with style(dark=True):
        ax = plot_phase_portrait(ENERGY)
    up, around = np.radians(ax.elev), np.radians(ax.azim)
    eye = np.array([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)])
    faint = [line for line in ax.lines if line.get_alpha() == 0.3 and line.get_color() == DARK_COLOURS[1]]
    assert faint
    for line in faint:
        depth = eye @ np.array(line.get_data_3d(), dtype=float)
        assert np.mean(depth[np.isfinite(depth)] < 0) > 0.9


def test_levels_lie_between_critical_values() -> None:
    for ends in ((False, True), (True, False), (True, True), (False, False)):
        found = between(1.0, 3.0, *ends, 5)
        assert found == sorted(found) and found[0] > 1 and found[-1] < 3


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        ((lh.GeneratorField(lh.defining(lh.so(4)), [1, 0, 0, 0, 0, 0]),), "4 coordinates"),
        ((lh.GeneratorField(lh.defining(lh.so(3)), ["t", 0, 0]),), "depends on time"),
        ((lh.GeneratorField(lh.defining(lh.so(2, 1)), [1, 1, 0]),), "tangent"),
        (("m0", None, "m1"), "GeneratorField"),
        (("m0", None, None, -1.0), "radius"),
    ],
)
def test_other_arguments_raise(arguments: tuple[Any, ...], match: str) -> None:
    names = ("field", "ax", "energy", "radius")
    with pytest.raises(lh.InputError, match=match):
        plot_phase_portrait(**dict(zip(names, arguments, strict=False)))


@pytest.mark.parametrize(
    ("field", "options", "match"),
    [
        ("m0**2 + m1**2 + m2**2", {}, "constant on the sphere"),
        ("1 + 0*m0", {}, "constant on the sphere"),
        ("1/m0", {}, r"not finite on the sphere, as at the point \[0\. 1\. 0\.\]"),
        ("log(m0)", {}, "not finite"),
        (["m0", "m1"], {}, "one energy, got 2"),
        (BODY.field(), {"energy": "m0"}, "not a first integral"),
        (lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: m), {}, "the field is 0"),
        (ENERGY, {"radius": "a"}, "radius"),
        (ENERGY, {"levels": 2.5}, "levels"),
        (ENERGY, {"ax": new_figure(2, 2).add_subplot(projection="polar")}, "polar"),
    ],
)
def test_pictures_that_would_not_be_true_are_refused(field: Any, options: Any, match: str) -> None:
    with pytest.raises(InputError, match=match):
        plot_phase_portrait(field, **options)


def test_small_spheres_have_portraits() -> None:
    assert len(equilibria(flow_of(ENERGY, None, 1e-6))) == 6
    assert plot_phase_portrait(ENERGY, radius=1e-6).lines


@pytest.mark.parametrize("radius", [1e-3, 2.5, 1e3])
def test_the_largest_speed_is_that_on_the_sphere(radius: float) -> None:
    assert flow_of(ENERGY, None, radius).speed == pytest.approx(radius**2 * flow_of(ENERGY, None, 1.0).speed)


def test_levels_are_closer_to_saddles_than_to_centers() -> None:
    t = (np.arange(4) + 0.5) / 4
    assert np.allclose(between(0.0, 1.0, False, False, 4), np.sin(np.pi * t / 2) ** 2)
    assert np.allclose(between(0.0, 1.0, True, True, 4), t)
    assert np.allclose(between(0.0, 1.0, False, True, 4), t**2)
    assert np.allclose(between(1.0, 3.0, True, False, 4), 3 - 2 * t[::-1] ** 2)


def test_a_field_at_rest_has_the_level_sets_of_its_energy() -> None:
    still = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: m)
    energy = flow_of(still, "m2", 1.0).energy
    assert energy is not None and energy(np.array([0.6, 0.0, 0.8])) == 0.8


def test_a_portrait_without_level_sets_has_its_separatrices() -> None:
    with style():
        ax = plot_phase_portrait(ENERGY, levels=0)
    assert not {COLOURS[0]} & {line.get_color() for line in ax.lines} and len(drawn(ax, COLOURS[1])) > 100
    with pytest.raises(InputError, match="levels is -1"):
        plot_phase_portrait(ENERGY, levels=-1)
