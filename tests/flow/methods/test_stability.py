"""What isotropy does to Euler's step for damping: no gain below a full turn, a small basin and order 0 beyond it."""

import numpy as np
import pytest

import liehom as lh
from liehom.flow.methods.stability import amplification, stability_limit

UP = np.array([0.0, 0.0, 1.0])


def beyond_a_turn(x: float) -> float:
    """s = 2 (pi + e) with tan e = (pi + e) / x, for x = K h, by fixed-point iteration of e = atan((pi + e) / x)."""
    e = 0.0
    for _ in range(200):
        e = np.arctan((np.pi + e) / x)
    return float(2 * (np.pi + e))


@pytest.mark.parametrize(("base", "signs"), [(lh.Euler(), 1.0), (lh.BackwardEuler(), -1.0)])
def test_limits_of_corrected_steps_are_those_of_their_clocks(base: lh.Step, signs: float) -> None:
    """tau = K h + signs (K h)^2/2 + ... to order n: up to K h = 2 for Euler, while tau' is between 1/5 and 5."""
    for n in (2, 3, 4):
        tau = np.polynomial.Polynomial([0, *(signs ** (k - 1) / k for k in range(1, n + 1))])
        x = np.linspace(0, 2 if signs > 0 else 10, 100_001)
        rates = tau.deriv()(x)
        wrong = np.flatnonzero((rates < 0.2) | (rates > 5))
        last = x[wrong[0]] if wrong.size else x[-1]
        assert stability_limit(lh.Corrected(base, n)) == pytest.approx(tau(last), abs=2e-3)


@pytest.mark.parametrize("x", [2.05, 3.0, 10.0, 100.0])
def test_isotropy_of_less_than_a_turn_does_not_stabilize_damping(x: float) -> None:
    assert min(float(amplification(lh.Euler(), -x, isotropy=s)) for s in np.linspace(-6.28, 6.28, 41)) > 1


@pytest.mark.parametrize("x", [2.05, 3.0, 10.0, 100.0])
def test_isotropy_of_more_than_a_turn_stabilizes_damping(x: float) -> None:
    s = beyond_a_turn(x)
    assert float(amplification(lh.Euler(), -x, isotropy=s)) == pytest.approx(np.sin(s / 2 - np.pi), abs=1e-6)


@pytest.mark.parametrize("x", [10.0, 30.0, 100.0])
def test_the_basin_beyond_a_turn_shrinks_with_the_power_three_halves(x: float) -> None:
    """Starts at up to 0.99 of 2 sqrt(2) pi (K h)^(-3/2) approach the equilibrium; some at 1.2 of it do not."""
    s, radius = beyond_a_turn(x), 2 * np.sqrt(2) * np.pi * x**-1.5
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: x * np.cross(m, UP) + s * m)
    angles, distances = np.arange(8) * np.pi / 4, radius * np.array([0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1.2])[:, None]
    across = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=-1) * np.sin(distances)[..., None]
    starts = across + np.cos(distances)[..., None] * UP
    sol = lh.integrate(field, (0, 100), starts, step=lh.Euler(), dt=1.0, t_eval=[0.0, 100.0])
    close = np.linalg.norm(sol.y[..., -1] - UP, axis=-1) < 1e-3 * radius
    assert close.all(axis=-1).tolist() == [True] * 6 + [False]


def errors_towards_a_moving_equilibrium(rate: float, sizes: list[float], *, turn: bool) -> list[float]:
    """Errors of Euler's step at t = 1 for m' = K (e - <m, e> m), e a circle with the angular velocity 1."""

    def e(t: object) -> np.ndarray:
        return np.stack([np.cos(t), np.sin(t), 0 * np.asarray(t)], axis=-1)  # type: ignore[call-overload]

    rho, errors = lh.adjoint(lh.so(3)), []
    lag = np.arcsin(1 / rate)  # m(t) = e(t - lag): the tangential velocity K sin(lag) is 1
    for h in sizes:
        sigma = beyond_a_turn(rate * h) / h if turn else 0.0
        field = lh.GeneratorField(rho, lambda m, t, sigma=sigma: rate * np.cross(m, e(t)) + sigma * m)
        sol = lh.integrate(field, (0, 1), e(-lag), step=lh.Euler(), dt=h)
        errors.append(float(np.linalg.norm(sol.y[:, -1] - e(1 - lag))))
    return errors


def test_beyond_a_turn_errors_are_of_size_h_and_do_not_vanish_with_h() -> None:
    large = errors_towards_a_moving_equilibrium(1000, [1 / 25, 1 / 50, 1 / 100], turn=True)
    assert np.allclose(np.array(large) * [25, 50, 100], 1, atol=0.1)  # the step lags by h |e'| = h
    small = errors_towards_a_moving_equilibrium(1000, [1 / 1000, 1 / 4000], turn=True)
    assert small[1] > 0.9 * small[0] > 4e-3
    plain = errors_towards_a_moving_equilibrium(1000, [1 / 1000, 1 / 4000], turn=False)
    assert plain[1] < 1e-6


def test_limits_of_stability_are_found_to_a_ten_thousandth() -> None:
    zeros = {lh.Euler(): 2.0, lh.RKMK("rk4"): 2.785293563405282, lh.LieTaylor(3): 2.5127453266183286}
    for step, zero in zeros.items():
        assert 0 <= zero - stability_limit(step) < 1.01e-4
