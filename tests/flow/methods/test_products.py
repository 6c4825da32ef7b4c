"""Orders of all steps, exactly; products of exponentials; what corrections make of them; a user's own steps."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError
from liehom.flow.action.exponential import Exponential, SeriesExponential
from liehom.flow.methods.low_order import CommutatorFree4, CrouchGrossman3, ProductStep, Scheme
from liehom.flow.methods.rkmk import RKMK
from liehom.flow.steps.step import Generator
from tests.flow.propagation.support import errors, exact_order, problem, run, slope, smooth_field, starts

STEPS = [lh.Euler(), lh.BackwardEuler(), lh.Heun(), CrouchGrossman3(), CommutatorFree4()]
TAYLOR = [lh.LieTaylor(n) for n in range(1, 7)]


def name_of(value: Any) -> str:
    return repr(value) if isinstance(value, lh.Step) else str(value)


class Naive(ProductStep):
    """Kutta's method of order 3 with one exponential for each entry, as if all commuted."""

    order = 3
    scheme = Scheme(((0, "1/2"), (0, "-1; 0 2"), (0, "1/6; 0 2/3; 0 0 1/6")))


class Classical(ProductStep):
    """The classical method of order 4 with one exponential, as if all commuted."""

    order = 4
    scheme = Scheme(((0, "1/2"), (0, "0 1/2"), (0, "0 0 1"), (0, "1/6 1/3 1/3 1/6")))


class Midpoint(lh.steps.OneExponential):
    """As the documentation has it."""

    order = 2

    def generator(self, action: Any, psi: Any, m: Any, t: Any, h: Any) -> Any:
        return h * psi(action.act(h / 2 * psi(m, t), m), t + h / 2)


class Halves(lh.Step):
    """Half a step with the velocity at the start, half a step with that at the end of an Euler step."""

    order = 2

    def factors(self, action: Any, psi: Any, m: Any, t: Any, h: Any) -> tuple[Any, ...]:
        first = h * psi(m, t)
        return first / 2, h / 2 * psi(action.act(first, m), t + h)


# -- orders, exactly -------------------------------------------------------------------------------------
@pytest.mark.parametrize("timed", [False, True])
@pytest.mark.parametrize("step", [*STEPS, *TAYLOR, Midpoint(), Halves()], ids=name_of)
def test_each_step_proves_its_order(step: lh.Step, timed: bool) -> None:
    """At random rational points it is the flow of a random field through its order, and no further."""
    for group in ("so(3)", "sl(2)", "Sym(3)"):
        assert [exact_order(step, group, timed=timed, seed=seed) for seed in range(3)] == [step.order] * 3


@pytest.mark.parametrize(("step", "order"), [(Naive(), 2), (Classical(), 2)], ids=name_of)
def test_order_conditions_of_commuting_velocities_do_not_suffice(step: lh.Step, order: int) -> None:
    for seed in range(3):
        assert exact_order(step, "so(3)", timed=False, seed=seed) == order
        assert exact_order(step, "so(2)", timed=True, seed=seed) == step.order


def test_of_commuting_velocities_the_commutator_free_method_is_the_classical_one() -> None:
    rho = lh.defining(lh.so(2))
    psi = Generator(lh.GeneratorField(rho, ["m0*m1 + t"]), 1)
    values = (lh.Action(rho), psi, np.array([0.6, 0.8]), np.array([0.3]), np.array([0.2]))
    assert abs(sum(CommutatorFree4().factors(*values)) - RKMK("rk4").factors(*values)[0]).max() < 1e-15


# -- orders, in trajectories -----------------------------------------------------------------------------
@pytest.mark.parametrize("space", ["S2", "S3", "plane", "Sym123"])
@pytest.mark.parametrize("step", [CrouchGrossman3(), CommutatorFree4()], ids=name_of)
def test_observed_order(step: lh.Step, space: str) -> None:
    assert abs(slope(errors(space, step, (48, 96))) - step.order) < 0.15


@pytest.mark.parametrize(("step", "order"), [(Naive(), 2), (Classical(), 2)], ids=name_of)
def test_observed_order_of_what_ignores_commutators(step: lh.Step, order: int) -> None:
    assert abs(slope(errors("S3", step, (48, 96))) - order) < 0.15


# -- corrected -------------------------------------------------------------------------------------------
CORRECTED = [
    (lh.BackwardEuler(), 4), (RKMK("gauss2"), 5), (RKMK("rk4"), 6), (CrouchGrossman3(), 5), (CommutatorFree4(), 5),
    (Midpoint(), 4), (Halves(), 4),
]  # fmt: skip


def corrected_slope(
    base: lh.Step, order: int, count: int, space: str, exponential: str = "exp", *, timed: bool = True
) -> float:
    """From `count` to twice as many steps; the low orders take some more before they show."""
    count = count if order >= 5 else 40
    return slope(errors(space, lh.Corrected(base, order), (count, 2 * count), exponential=exponential, timed=timed))


@pytest.mark.parametrize(("base", "order"), CORRECTED, ids=name_of)
def test_corrected_order(base: lh.Step, order: int) -> None:
    assert abs(corrected_slope(base, order, 16, "S3") - order) < 0.15
    assert abs(slope(errors("S3", base, (40, 80))) - base.order) < 0.15


@pytest.mark.slow
@pytest.mark.parametrize("timed", [False, True])
@pytest.mark.parametrize(
    ("space", "exponential"),
    [("S2", "exp"), ("Sym112", "exp"), ("S2", "cayley"), ("S3", "cayley"), ("Sym112", "cayley")],
)
@pytest.mark.parametrize(("base", "order"), CORRECTED, ids=name_of)
def test_corrected_order_everywhere(base: lh.Step, order: int, space: str, exponential: str, timed: bool) -> None:
    # Crouch-Grossman shows its order late: on Sym112 with Cayley 5.21, 5.11, 5.05 from 32, 64, 128 steps
    count = 64 if isinstance(base, CrouchGrossman3) else 32
    assert abs(corrected_slope(base, order, count, space, exponential, timed=timed) - order) < 0.15


@pytest.mark.parametrize("order", [3, 4])
def test_a_product_that_loses_its_order_to_the_exponential_is_raised_from_the_order_it_has(order: int) -> None:
    """Crouch-Grossman with Cayley has order 2 on its own, and is refused; corrected it has any order."""
    assert abs(corrected_slope(CrouchGrossman3(), order, 32, "S2", "cayley", timed=False) - order) < 0.15
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * [1.0, 0.5, 0.25])
    step = lh.Corrected(CrouchGrossman3(), order)
    sol = lh.integrate(field, (0, 1), [0.6, 0.0, 0.8], step=step, dt=0.1, exponential="cayley")
    assert sol.report.order == order and sol.report.base_order == 2
    with pytest.raises(InputError, match=r"or Corrected\(step, 3\), which raises the order 2"):
        lh.integrate(field, (0, 1), [0.6, 0.0, 0.8], step=CrouchGrossman3(), dt=0.1, exponential="cayley")


def test_a_correction_of_a_product_is_one_more_factor() -> None:
    data = problem("S3")
    m, t, h = data.starts.astype(float), np.zeros((2, 3, 1)), np.full((2, 3, 1), 0.1)
    action, psi = lh.Action(data.field.representation), Generator(data.field, 3)
    base = CrouchGrossman3().factors(action, psi, m, t, h)
    local = lh.Corrected(CrouchGrossman3(), 5).at(action, psi, m, t)
    factors = local.factors(h)
    assert len(factors) == 4 and all(np.array_equal(x, y) for x, y in zip(base, factors, strict=False))
    # it lies in the isotropy algebra, so that it leaves m where it is
    assert np.abs(action.infinitesimal(factors[3], m)).max() < 1e-14 < 1e-6 < np.abs(factors[3]).max()
    assert (local.correction.reached == 5).all()


def test_where_isotropy_does_not_reach_the_order_stays() -> None:
    data = problem("Sym123")
    action, step, m = (
        lh.Action(data.field.representation), lh.Corrected(CrouchGrossman3(), 5), data.starts.astype(float),
    )  # fmt: skip
    field = [run(action, data.field, step, m, 1.0, count) for count in (24, 48)]
    assert abs(slope([float(np.sqrt(np.mean((x - data.end) ** 2))) for x in field]) - 3) < 0.15


# -- which exponentials ----------------------------------------------------------------------------------
class Own(Exponential):
    """exp as a user may write it."""

    name = "own"

    def __init__(self, rho: lh.Representation) -> None:
        self.exp = SeriesExponential(rho)

    def act(self, x: Any, m: Any) -> Any:
        return self.exp(x, m)


def test_another_exponential_is_refused_where_it_would_cost_an_order() -> None:
    rho, m = starts("S2", (3,))
    data = (Generator(smooth_field(rho, (3,)), 2), m, np.zeros((3, 1)), np.full((3, 1), 0.1))
    for step in (CrouchGrossman3(), CommutatorFree4()):
        with pytest.raises(InputError, match=r"Cayley differs from exp at h\^3, .* cannot have order"):
            step.factors(lh.Action(rho, "cayley"), *data)
        own = step.factors(lh.Action(rho, Own(rho)), *data)
        assert all(np.allclose(x, y) for x, y in zip(own, step.factors(lh.Action(rho), *data), strict=True))


def test_up_to_order_two_every_exponential_will_do() -> None:
    class Half(ProductStep):
        order = 2
        scheme = Scheme(((0, "1/2"), (0, "0 1/2; 0 1/2")))

    assert abs(slope(errors("S3", Half(), (40, 80), exponential="cayley")) - 2) < 0.15


# -- the data --------------------------------------------------------------------------------------------
def test_schemes_are_exact_data() -> None:
    assert CrouchGrossman3().scheme.nodes == (Fraction(0), Fraction(3, 4), Fraction(17, 24))
    assert CommutatorFree4().scheme.nodes == (Fraction(0), Fraction(1, 2), Fraction(1, 2), Fraction(1))
    assert CrouchGrossman3() == CrouchGrossman3() and repr(CommutatorFree4()) == "CommutatorFree4()"
    for points in (((0, "1/2"),), ((0, "1/2"), (1, "1/2"))):
        with pytest.raises(InputError, match="starts from m"):
            Scheme(points)


def test_extended_precision() -> None:
    data = problem("S2")
    action = lh.Action(data.field.representation)
    field = run(action, data.field, CommutatorFree4(), data.starts, 1.0, 5)
    rough = run(action, data.field, CommutatorFree4(), data.starts.astype(float), 1.0, 5)
    assert field.dtype == np.longdouble and 0 < np.abs(field - rough).max() < 1e-14
    norms = np.sqrt(np.sum(field * field, axis=-1)) / np.sqrt(np.sum(data.starts**2, axis=-1))
    assert np.abs(norms - 1).max() < 100 * np.finfo(np.longdouble).eps
