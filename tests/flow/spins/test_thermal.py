"""Thermal noise: orders on paths, the diffusion on the sphere, Boltzmann's distribution, and seeds."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.spins import Increments, LandauLifshitz


def final(model: Any, step: Any, noise: Any, end: float, m0: Any) -> Any:
    result = model.thermal_step(step, noise)
    return lh.integrate(model.field, (0, end), m0, step=result, dt=noise.size, t_eval=[end]).y[..., 0]


def test_increments_have_the_moments_of_a_wiener_process() -> None:
    noise = Increments((20000, 3), 0.25, 3)
    x, y = noise(0), noise(1)
    assert abs(x.mean()) < 4 * 0.5 / np.sqrt(60000)
    assert abs(x.var() - 0.25) < 4 * 0.25 * np.sqrt(2 / 60000)
    for a, b in ((x, y), (x[:, 0], x[:, 1]), (x[1:], x[:-1])):
        assert abs(np.mean(a * b)) < 4 * 0.25 / np.sqrt(a.size)
    assert np.array_equal(x, Increments((20000, 3), 0.25, 3)(0))
    assert not np.array_equal(x, Increments((20000, 3), 0.25, 4)(0))


class ItoEuler(lh.steps.Step):
    """m + h psi x m, with all noise at the initial point."""

    order = 1

    def factors(self, action: Any, psi: Any, m: Any, t: Any, h: Any) -> Any:
        raise NotImplementedError

    def at(self, action: Any, psi: Any, m: Any, t: Any, *, error_terms: int = 0) -> Any:
        velocity = np.cross(psi(m, t), m)
        return lh.steps.LocalStep(action, m, point=lambda h: m + h * velocity)


def strong_errors(step: Any, alpha: float, *, seeds: int = 400) -> Any:
    """Root mean square distances at time 1 from the path with steps 64 times smaller."""
    model = LandauLifshitz(damping=alpha, temperature=0.4 / alpha, applied=[0.3, 0, 0.8])
    m0, finest = np.tile([1.0, 0, 0], (seeds, 1)), 1 / 512
    exact = final(model, lh.Heun(), model.noise((seeds, 3), finest, 5), 1.0, m0)
    errors = []
    for parts in (16, 32, 64):
        result = final(model, step, model.noise((seeds, 3), parts * finest, 5, parts), 1.0, m0)
        errors.append(np.sqrt(np.mean(np.sum((result - exact) ** 2, axis=-1))))
    return np.array(errors)


def test_strong_order_is_one_half() -> None:
    """Noise in three directions, which do not commute."""
    errors = strong_errors(lh.Heun(), 0.5)
    assert 0.35 < np.log2(errors[2] / errors[0]) / 2 < 0.75


def test_eulers_exponential_step_needs_no_drift() -> None:
    """The drift that a step at the initial point misses is along m, as the noise is the same in all directions."""
    errors = strong_errors(lh.Euler(), 0.5)
    assert 0.35 < np.log2(errors[2] / errors[0]) / 2 < 0.75


def test_ito_euler_without_the_drift_does_not_converge() -> None:
    """A control: a straight step solves the equation in the sense of Ito, whose solution leaves the sphere."""
    errors = strong_errors(ItoEuler(), 0.5)
    assert errors.min() > 0.5
    assert np.log2(errors[2] / errors[0]) / 2 < 0.2


def test_strong_order_is_one_for_one_source_of_noise() -> None:
    """Noise along the field only: rotations about one axis and towards it."""
    model = LandauLifshitz(damping=0.5, temperature=0.8, applied=[0.3, 0, 0.8])
    m0, finest, errors = np.tile([1.0, 0, 0], (400, 1)), 1 / 512, []

    def along(step: Any, parts: int) -> Any:
        noise = Increments((400, 1), parts * finest, 5, parts)
        result = model.thermal_step(step, noise)
        plain = result.response
        result.response = lambda m, w: plain(m, w * np.array([0.0, 0, 1.0]))
        return lh.integrate(model.field, (0, 1), m0, step=result, dt=noise.size, t_eval=[1.0]).y[..., 0]

    exact = along(lh.Heun(), 1)
    for parts in (16, 32, 64):
        errors.append(np.sqrt(np.mean(np.sum((along(lh.Heun(), parts) - exact) ** 2, axis=-1))))
    assert 0.85 < np.log2(errors[2] / errors[0]) / 2 < 1.3


@pytest.mark.slow
def test_weak_order_is_one_on_the_sphere() -> None:
    """Without a field a spin diffuses: E m = exp(-2 g gamma a T t) m_0, g = 1/(1 + a^2), which is known exactly."""
    alpha, temperature, count = 0.5, 1.0, 400_000
    model = LandauLifshitz(damping=alpha, temperature=temperature)
    exact = np.exp(-2 * alpha * temperature / (1 + alpha**2))
    m0 = np.tile([0, 0, 1.0], (count, 1))
    spread = 1 / np.sqrt(3 * count)
    results = {}
    for name, step, sizes in (
        ("heun", lh.Heun(), (1 / 8, 1 / 16)),
        ("euler", lh.Euler(), (1 / 2, 1 / 4)),
        ("ito", ItoEuler(), (1 / 8, 1 / 16)),
    ):
        results[name] = [
            abs(final(model, step, model.noise(m0.shape, h, 11), 1.0, m0)[:, 2].mean() - exact) for h in sizes
        ]
        assert min(results[name]) > 3 * spread  # the differences are not those of samples
    assert 0.5 < np.log2(results["heun"][0] / results["heun"][1]) < 1.5
    assert 0.8 < np.log2(results["euler"][0] / results["euler"][1]) < 1.3
    assert min(results["ito"]) > 0.3


@pytest.mark.parametrize("ratio", [0.5, 3.0])
def test_a_spin_has_boltzmanns_distribution(ratio: float) -> None:
    """E m_z = coth x - 1/x and E m_z^2 = 1 - 2 (coth x - 1/x)/x for x = H/T, within four standard errors."""
    temperature, count = 1 / ratio, 3000
    model = LandauLifshitz(damping=0.8, temperature=temperature, applied=[0, 0, 1.0])
    m0 = np.random.default_rng(0).normal(size=(count, 3))
    m0 /= np.linalg.norm(m0, axis=-1, keepdims=True)
    sol = model.integrate((0, 8 * max(ratio, 1)), m0, dt=0.05 * min(ratio, 1), seed=2, t_eval=[8 * max(ratio, 1)])
    z = sol.y[:, 2, -1]
    langevin = 1 / np.tanh(ratio) - 1 / ratio
    second = 1 - 2 * langevin / ratio
    assert abs(z.mean() - langevin) < 4 * np.sqrt((second - langevin**2) / count)
    assert abs((z**2).mean() - second) < 4 * (z**2).std() / np.sqrt(count)
    assert abs(sol.y[:, 0, -1].mean()) < 4 / np.sqrt(count)
    wrong = 1 / np.tanh(2 * ratio) - 1 / (2 * ratio)  # of half the temperature
    assert abs(z.mean() - wrong) > 8 * z.std() / np.sqrt(count)
    assert np.abs(np.linalg.norm(sol.y[..., -1], axis=-1) - 1).max() < 1e-13


def test_two_coupled_spins_have_boltzmanns_distribution() -> None:
    """E <m_1, m_2> is Langevin's function of J/T; noise at the two sites is independent."""
    model, count = LandauLifshitz((2,), exchange=2.0, damping=0.8, temperature=1.0, periodic=False), 3000
    m = model.integrate((0, 10), np.tile([0, 0, 1.0], (count, 2, 1)), dt=0.05, seed=5, t_eval=[10.0]).y[..., -1]
    c = np.sum(m[:, 0] * m[:, 1], axis=-1)
    assert abs(c.mean() - (1 / np.tanh(2.0) - 1 / 2.0)) < 4 * c.std() / np.sqrt(count)
    assert np.abs(m[:, 0].mean(axis=0)).max() < 4 / np.sqrt(3 * count)


def test_seeds_reproduce_runs_and_distinguish_them() -> None:
    model, m0 = LandauLifshitz((4, 3), exchange=1.0, damping=0.1, temperature=0.5), np.zeros((4, 3, 3))
    m0[..., 2] = 1
    first = model.integrate((0, 1), m0, dt=0.1, seed=1)
    assert np.array_equal(first.y, model.integrate((0, 1), m0, dt=0.1, seed=1).y)
    part = model.integrate((0, 1), m0, dt=0.1, seed=1, t_eval=[0.5, 1.0])
    assert np.allclose(part.y[..., -1], first.y[..., -1], rtol=0, atol=1e-14)
    others = [model.integrate((0, 1), m0, dt=0.1, seed=s).y for s in (2, None, None)]
    assert np.abs(first.y[..., -1] - others[0][..., -1]).max() > 0.01
    assert np.abs(others[1] - others[2]).max() > 0.01
    assert np.unique(first.y[..., 0, -1]).size == 12  # every site has noise of its own


def test_noise_of_a_lattice_is_compiled() -> None:
    pytest.importorskip("llvmlite")
    damping = 0.1 + 0.4 * np.random.default_rng(1).random((5, 4))
    model = LandauLifshitz((5, 4), exchange=1.0, dmi=0.3, damping=damping, temperature=0.5)
    m0 = np.random.default_rng(0).normal(size=(2, 5, 4, 3))
    m0 /= np.linalg.norm(m0, axis=-1, keepdims=True)
    for step in (lh.Heun(), lh.Euler()):
        plain, sol = (
            model.integrate((0, 1), m0, step=step, dt=0.1, seed=3, t_eval=[0.35, 1.0], engine=engine)
            for engine in ("numpy", "llvm")
        )
        assert np.abs(plain.y - sol.y).max() < 1e-13
    cold = LandauLifshitz((5, 4), exchange=1.0, dmi=0.3, damping=damping)
    assert np.abs(cold.integrate((0, 1), m0, dt=0.1, t_eval=[1.0]).y[..., 0] - sol.y[..., -1]).max() > 0.1


def test_what_noise_needs() -> None:
    warm, m = LandauLifshitz(damping=0.1, temperature=0.5), [0, 0, 1.0]
    with pytest.raises(lh.errors.InputError, match="one number dt"):
        warm.integrate((0, 1), m)
    with pytest.raises(lh.errors.InputError, match="seed"):
        warm.integrate((0, 1), m, dt=0.1, seed=-1)
    with pytest.raises(lh.errors.InputError, match="Heun"):
        warm.integrate((0, 1), m, dt=0.1, step=lh.Corrected(lh.Euler(), 3))
    with pytest.raises(lh.errors.InputError, match="engine='numpy'"):
        warm.integrate((0, 1), m, dt=0.1, engine="llvm")
    with pytest.raises(lh.errors.InputError, match="no noise"):
        LandauLifshitz(damping=0.1).integrate((0, 1), m, dt=0.1, seed=3)
