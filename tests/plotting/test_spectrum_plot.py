"""Eigenvalues over time: constant on orbits, as numpy computes them, for other coordinates as well."""

from typing import Any

import numpy as np
import pytest

import liehom as lh

pytest.importorskip("matplotlib")

from liehom.base.errors import InputError
from liehom.plotting.canvas import new_figure
from liehom.plotting.drift_plot import plot_spectrum

SPACE = lh.instances.SymmetricMatrices(3)
FIELD = lh.instances.toda_flow(3)
START = [2.0, 1.0, 0.0, 0.0, 1.0, -1.0]
SOL = lh.integrate(FIELD, (0, 3), START, dt=0.1)


def lines(ax: Any) -> list[np.ndarray]:
    return [np.array(line.get_data()) for line in ax.lines if len(line.get_xdata())]


def test_isospectral_steps_draw_horizontal_lines() -> None:
    ax = plot_spectrum(SOL)
    assert len(lines(ax)) == 3
    for (times, values), wanted in zip(lines(ax), np.linalg.eigvalsh(SPACE.to_matrix(START)), strict=True):
        assert np.array_equal(times, SOL.t)
        assert np.abs(values - wanted).max() < 1e-12
    assert ax.get_legend() is None and ax.get_xlabel() == "time $t$"


def test_euler_in_the_space_of_matrices_drifts_and_has_its_own_dashes() -> None:
    points = [np.array(START)]
    for _ in SOL.t[1:]:
        points.append(points[-1] + 0.1 * FIELD.vector(points[-1]))
    ax = plot_spectrum({"on the orbit": SOL, "Euler": (SOL.t, np.transpose(points))})
    assert len(lines(ax)) == 6
    drift = [np.ptp(values) for _, values in lines(ax)]
    assert max(drift[:3]) < 1e-12 and max(drift[3:]) > 0.05
    assert np.allclose([v[-1] for _, v in lines(ax)[3:]], np.linalg.eigvalsh(SPACE.to_matrix(points[-1])))
    assert [line.get_linestyle() for line in ax.lines if len(line.get_xdata())] == ["-"] * 3 + ["--"] * 3
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["on the orbit", "Euler"]


def test_other_coordinates_by_matrices() -> None:
    """Points of so(3) as Hermitian matrices, whose eigenvalues are 0 and +-|m|."""
    sol = lh.integrate(lh.GeneratorField(lh.adjoint(lh.so(3)), ["m0", "m1/2", "m2/3"]), (0, 2), [0.6, 0.0, 0.8])

    def hermitian(m: np.ndarray) -> np.ndarray:
        return 1j * np.cross(np.eye(3)[None], m[:, None, :])

    values = [v for _, v in lines(plot_spectrum(sol, matrices=hermitian))]
    assert np.abs(np.array(values) - np.array([[-1.0], [0.0], [1.0]])).max() < 1e-12


def test_points_that_are_not_finite_are_left_out() -> None:
    points = np.array([[1.0, np.inf], [0.0, 0.0], [2.0, 1.0]])
    assert [x.shape for x in lines(plot_spectrum(([0.0, 1.0], points)))] == [(2, 1), (2, 1)]


@pytest.mark.parametrize(
    ("trajectories", "error", "match"),
    [
        ({}, lh.InputError, "no trajectory"),
        ("sol", lh.InputError, "expected a solution"),
        (([0.0], np.ones((4, 1))), lh.ShapeError, "got 4"),
        (([0.0, 1.0], np.ones((3, 1))), lh.ShapeError, "one trajectory"),
        (lh.integrate(FIELD, (0, 1), [START, START], dt=0.5), lh.ShapeError, "one trajectory"),
    ],
)
def test_other_input_raises(trajectories: Any, error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=match):
        plot_spectrum(trajectories)


def test_matrices_of_the_wrong_shape_raise() -> None:
    with pytest.raises(lh.ShapeError, match="k, k"):
        plot_spectrum(SOL, matrices=lambda m: m)


@pytest.mark.parametrize(
    ("trajectory", "options", "match"),
    [
        (SOL, {"matrices": lambda y: np.arange(9.0 * len(y)).reshape(-1, 3, 3)}, "not symmetric"),
        (([0, 1], [[1j, 1], [0, 2], [3, 1]]), {}, "real numbers"),
        (("a", "b"), {}, "real numbers"),
        (SOL, {"ax": new_figure(2, 2).add_subplot(projection="3d")}, "axes"),
    ],
)
def test_other_matrices_numbers_and_axes_are_refused(trajectory: Any, options: Any, match: str) -> None:
    with pytest.raises(InputError, match=match):
        plot_spectrum(trajectory, **options)
