"""Steps by name: every name is a step of the order it should have, unknown ones are refused with the list."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

import liehom as lh
from liehom.base.errors import InputError
from liehom.flow.methods.low_order import LieTaylor
from liehom.flow.methods.named import step_named, step_names
from liehom.flow.methods.tableaux import tableau, tableau_names

ORDERS = {"euler": 1, "backward euler": 1, "heun": 2, "taylor": 6, "lietaylor": 6, "cg3": 3, "cf4": 4}
SYMPLECTIC = ["spherical midpoint", "isospectral midpoint", "variational midpoint", "moser-veselov", "splitting"]
ORDERS |= dict.fromkeys(SYMPLECTIC, 2) | {"ros2": 2, "rodas3": 3, "rodas4": 4, "exprb2": 2, "exprb3": 3, "exprb4": 4}


@pytest.mark.parametrize("name", step_names())
def test_every_name_is_a_step_that_steps(name: str) -> None:
    step = step_named(name)
    assert step.order == (ORDERS[name] if name in ORDERS else tableau(name).order)
    field = lh.GeneratorField(lh.defining(lh.so(3)), ["m0", "2*m1", "1 + m2"])
    if name in SYMPLECTIC:  # on the dual of the algebra
        field = lh.hamiltonian_field(lh.so(3), "m0**2/4 + m1**2/6 + m2**2/8", sign=-1)
    action, psi = lh.Action(field.representation), lh.steps.Generator(field, 2)
    m, h = np.array([0.6, 0.0, 0.8]), np.array([0.01])
    point = step.at(action, psi, m, np.array([0.0])).point(h)
    assert np.linalg.norm(point) == pytest.approx(1, abs=1e-14)
    assert np.abs((point - m) / 0.01 - field.vector(m)).max() < 0.05


@pytest.mark.parametrize("name", tableau_names())
def test_every_tableau_has_a_step(name: str) -> None:
    assert step_named(name).order == tableau(name).order


@pytest.mark.parametrize(("name", "order", "shown"), [
    ("euler", 4, "Corrected(Euler(), order=4)"), ("Euler", 1, "Euler()"), ("forward-euler", None, "Euler()"),
    ("implicit euler", 2, "Corrected(BackwardEuler(), order=2)"), ("HEUN", 1, "Heun()"),
    ("taylor", None, "Taylor(n=6)"), ("Taylor", 12, "Taylor(n=12)"), ("taylor16", None, "Taylor(n=16)"),
    ("lietaylor", None, "LieTaylor(n=6)"), ("Lie Taylor", 3, "LieTaylor(n=3)"),
    ("Spherical_Midpoint", None, "SphericalMidpoint()"),
    ("moser veselov", 6, "Composition(step=MoserVeselov(), order=6, scheme='suzuki')"),
    ("lietaylor2", None, "LieTaylor(n=2)"), ("lietaylor2", 5, "Corrected(LieTaylor(n=2), order=5)"),
    ("rk4", 4, "RKMK('rk4')"), ("RK_4", 5, "Corrected(RKMK('rk4'), order=5)"), ("dormand prince", None, "RKMK('rk45')"),
])  # fmt: skip
def test_names_and_orders(name: str, order: int | None, shown: str) -> None:
    assert repr(step_named(name, order)) == shown


def test_names_are_distinct() -> None:
    names = step_names()
    assert len(set(names)) == len(names)
    assert len({repr(step_named(name)) for name in names}) == len(names)


@pytest.mark.parametrize("name", ["", "eulr", "rk", "lietaylor0", "lietaylor9999", "gauss99", "x" * 500, "\0"])
def test_unknown_names_list_the_known_ones(name: str) -> None:
    with pytest.raises(InputError) as caught:
        step_named(name)
    if name != "lietaylor0":
        assert "lietaylor" in str(caught.value)
        assert "rk4" in str(caught.value)
    assert len(str(caught.value)) < 1000


def test_a_near_name_is_suggested() -> None:
    with pytest.raises(InputError, match="did you mean 'euler'"):
        step_named("eulr")
    with pytest.raises(InputError, match=r"liehom\.Corrected takes a step"):
        step_named("corrected")


@pytest.mark.parametrize("order", [0, -1, True, 2.0, "3", float("nan")])
@pytest.mark.parametrize("base", ["euler", "lietaylor", "rk4"])
def test_orders_are_positive_integers(base: str, order: Any) -> None:
    with pytest.raises(InputError, match="order"):
        step_named(base, order)


@pytest.mark.parametrize("base", [None, 3, b"euler", ["euler"]])
def test_a_base_is_a_text(base: Any) -> None:
    with pytest.raises(InputError, match="name"):
        step_named(base)


@given(st.text(max_size=20))
def test_any_text_is_a_step_or_an_input_error(text: str) -> None:
    try:
        assert isinstance(step_named(text, 2), lh.Step)
    except InputError:
        return


def test_numpy_integers_are_orders() -> None:
    assert step_named("lietaylor", np.int64(5)) == LieTaylor(5)
