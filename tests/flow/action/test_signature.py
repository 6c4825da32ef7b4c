"""The order of the parameters of psi and of events: told by their names, and refused where it is the other one."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError
from liehom.flow.action.components import call_form, called_as_event

RHO = lh.adjoint(lh.so(3))
START = [0.6, 0.0, 0.8]
SWAPPED = [lambda t, m: -m, lambda t, y: -y, lambda time, x: -x, lambda t: t, lambda t, m, args: -m]


@pytest.mark.parametrize("psi", SWAPPED)
def test_a_psi_of_time_and_point_is_refused_with_the_order(psi: Any) -> None:
    for make in (lh.GeneratorField, lh.GeneratorField.from_vector_field):
        with pytest.raises(InputError, match=r"expected the point first: \(m, t\)"):
            make(RHO, psi)


@pytest.mark.parametrize("psi", [lambda m, t: -m, lambda y, t: -y, lambda x, s: -x, lambda m: -m, lambda m, *, t: -m])
def test_other_names_are_free(psi: Any) -> None:
    assert lh.integrate(lh.GeneratorField(RHO, psi), (0, 1), START, dt=0.5).success


def test_integrals_of_time_and_point_are_refused() -> None:
    with pytest.raises(InputError, match="point first"):
        lh.steps.FirstIntegral(lambda t, m: np.sum(m, axis=-1), 3)


EVENTS = [
    lambda t, y: y[..., 2] - t, lambda s, y: y[..., 2] - s, lambda m, t: m[..., 2] - t,
    lambda y, time: y[..., 2] - time,
]  # fmt: skip


@pytest.mark.parametrize("g", EVENTS)
@pytest.mark.parametrize("y0", [START, [START, [0.0, 0.6, 0.8]]], ids=["one", "many"])
def test_events_take_either_order(g: Any, y0: Any) -> None:
    field = lh.GeneratorField(RHO, lambda m: -m * [1.0, 0.5, 0.25])
    found = lh.integrate(field, (0, 2), y0, dt=0.1, events=g).t_events
    wanted = lh.integrate(field, (0, 2), y0, dt=0.1, events=EVENTS[0]).t_events
    assert found is not None and wanted is not None
    for a, b in zip(np.ravel(found[0]), np.ravel(wanted[0]), strict=True):
        assert np.size(a) and np.array_equal(a, b)


def test_attributes_of_an_event_stay_when_its_order_is_changed() -> None:
    def height(m: Any, t: Any) -> Any:
        return m[2] - 0.79

    height.terminal = True  # type: ignore[attr-defined]
    field = lh.GeneratorField(RHO, lambda m: -m * [1.0, 0.5, 0.25])
    sol = lh.integrate(field, (0, 5), START, dt=0.1, events=height)
    assert sol.status == 1 and abs(sol.y[2, -1] - 0.79) < 1e-12


@pytest.mark.parametrize("g", [
    lambda t, y, args: y[..., 2] - args["level"], lambda m, t, args: m[..., 2] - args["level"],
    lambda t, y, *, args: y[..., 2] - args["level"], lambda t, y, k: y[..., 2] - k["level"],
])  # fmt: skip
def test_events_with_args(g: Any) -> None:
    field = lh.GeneratorField(RHO, lambda m, t, args: -m * args["rates"])
    args = {"rates": np.array([1.0, 0.5, 0.25]), "level": 0.79}
    sol: Any = lh.integrate(field, (0, 5), START, dt=0.1, events=g, args=args)
    np.testing.assert_allclose(sol.y_events[0][0][2], 0.79, atol=1e-12)
    with pytest.raises(InputError, match=r"events\[0\] takes args"):
        lh.integrate(lh.GeneratorField(RHO, lambda m: -m), (0, 5), START, dt=0.1, events=g)


def test_functions_without_a_signature_are_called_in_the_usual_order() -> None:
    assert called_as_event(np.hypot, None, "g")(3.0, 4.0) == 5.0
    assert call_form(np.sin, "psi").time is None


def test_either_order_is_not_taken_for_args() -> None:
    """A control: names decide, not the number of parameters alone."""
    assert call_form(lambda m, args, t: m, "psi")[:2] == ("t", "args")
    assert call_form(lambda m, t, scale=2.0: m, "psi").args is None
    assert called_as_event(lambda t, y, scale=2.0: t, None, "g")(1, 2) == 1
