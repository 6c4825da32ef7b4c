"""The checks of actions and steps: they pass what is right and catch what is wrong."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import ConformanceError
from liehom.flow.series.jet import Jet
from liehom.testing import check_order, check_space

ACTIONS = {
    "rotations": lambda: lh.Action(lh.defining(lh.so(3))),
    "rotations, Cayley": lambda: lh.Action(lh.defining(lh.so(4)), "cayley"),
    "boosts": lambda: lh.Action(lh.defining(lh.so(3, 1)), "expm"),
    "symmetric matrices": lambda: lh.Action(lh.sym_conjugation(3)),
    "symmetric matrices, Cayley": lambda: lh.Action(lh.sym_conjugation(3), "cayley"),
    "g2": lambda: lh.Action(lh.defining("g2")),
    "adjoint": lambda: lh.Action(lh.adjoint(lh.sl(3))),
    "nilpotent": lambda: lh.Action(lh.adjoint(lh.heisenberg(1))),
}
STEPS = [
    lh.Euler(),
    lh.BackwardEuler(),
    lh.Heun(),
    lh.LieTaylor(1),
    lh.LieTaylor(4),
    lh.RKMK("rk4"),
    lh.RKMK("gauss2"),
    lh.RKMK("rk45"),
    lh.methods.CrouchGrossman3(),
    lh.methods.CommutatorFree4(),
]


@pytest.mark.parametrize("name", ACTIONS)
def test_actions_conform(name: str) -> None:
    check_space(ACTIONS[name]())


def test_an_action_that_leaves_the_orbit_is_caught() -> None:
    """The rational map without the group: the eigenvalues of the matrix move."""
    rho = lh.sym_conjugation(3)
    turn = lh.Action(rho).infinitesimal

    def naive(x: Any, m: Any) -> Any:
        once = turn(x, m)
        twice = turn(x, once)
        return m + once + twice / 2 + turn(x, twice) / 4

    with pytest.raises(ConformanceError) as caught:
        check_space(lh.Action(rho, naive))
    assert caught.value.check in ("inverse", "orbit")


def test_each_refusal_of_an_action_has_one_that_only_it_stops(monkeypatch: pytest.MonkeyPatch) -> None:
    rho = lh.defining(lh.so(3))
    action, act = lh.Action(rho), lh.Action(rho).act
    for check, words, wrong in (
        ("inverse", "is not m", lambda x, m: act(x, m) * (1 + 1e-6 * x[..., :1] ** 4)),
        ("order 2", r"at t\^0", lambda x, m: -act(x, m)),
        ("order 2", r"at t\^1", lambda x, m: act(2 * x, m)),
        ("order 2", r"at t\^2", lambda x, m: act(x, m) * (1 + 4e-10 * (x**2).sum(axis=-1, keepdims=True))),
        ("orbit", "leaves the orbit", lambda x, m: act(x, m) * np.exp(100 * x[..., :1] ** 3)),
    ):
        monkeypatch.setattr(lh.Action, "act", lambda _, x, m, wrong=wrong: wrong(x, m))
        with pytest.raises(ConformanceError, match=words) as caught:
            check_space(action)
        assert caught.value.check == check


def test_an_action_that_is_another_one_on_series_is_caught() -> None:
    exact = lh.Action(lh.adjoint(lh.so(3)))

    def slower(x: Any, m: Any) -> Any:
        once = exact.infinitesimal(x, m)
        twice = exact.infinitesimal(x, once)
        return m + once + twice / 2 if isinstance(x, Jet) else exact.act(x, m)

    with pytest.raises(ConformanceError) as caught:
        check_space(lh.Action(lh.adjoint(lh.so(3)), slower))
    assert caught.value.check == "series"


@pytest.mark.parametrize("step", STEPS, ids=repr)
def test_steps_have_their_order(step: lh.Step) -> None:
    check_order(step)


@pytest.mark.parametrize("step", STEPS, ids=repr)
def test_no_step_has_more(step: lh.Step) -> None:
    with pytest.raises(ConformanceError) as caught:
        check_order(step, step.order + 1)
    assert caught.value.check == "order"


def test_modesty_is_caught_too() -> None:
    with pytest.raises(ConformanceError) as caught:
        check_order(lh.Heun(), 1)
    assert caught.value.check == "sharpness"


def test_a_step_of_the_user() -> None:
    class Midpoint(lh.steps.OneExponential):
        order = 2

        def generator(self, action: Any, psi: Any, m: Any, t: Any, h: Any) -> Any:
            return h * psi(action.act(h / 2 * psi(m, t), m), t + h / 2)

    class Late(Midpoint):
        def generator(self, action: Any, psi: Any, m: Any, t: Any, h: Any) -> Any:
            return h * psi(action.act(h / 2 * psi(m, t), m), t + h)

    check_order(Midpoint())
    with pytest.raises(ConformanceError):
        check_order(Late())


def test_corrected_steps_with_their_clock() -> None:
    check_order(lh.Corrected(lh.Euler(), order=3), rng=np.random.default_rng(5))
