"""A propagator: `integrate` made once and called often, and what an engine may rely on."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError, OrderWarning, ShapeError
from liehom.flow.engines.engine import NumpyEngine, Problem

FIELD = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * [1.0, 0.5, 0.25])
START = np.array([0.6, 0.0, 0.8])


class Recording:
    """The engine "numpy", with the problems that it was given."""

    name = "recording"

    def __init__(self) -> None:
        self.problems: list[Problem] = []

    def solve(self, problem: Problem) -> lh.Solution:
        self.problems.append(problem)
        return NumpyEngine().solve(problem)


@pytest.mark.parametrize("engine", ["numpy", "llvm", "jax"])
@pytest.mark.parametrize("options", [{"dt": 0.1}, {"rtol": 1e-6}, {"dt": 0.1, "t_eval": [0.25, 1.0]}])
def test_a_call_is_integrate_bit_for_bit_and_so_is_the_next(engine: str, options: dict[str, Any]) -> None:
    if engine == "jax":
        pytest.importorskip("jax")
    step = lh.RKMK("rk45")
    propagator = lh.Propagator(FIELD, step, engine=engine)
    for start, end in ((START, 1.0), (np.array([START, [0.0, 1.0, 0.0]]), 2.0), (START, -1.0)):
        given = {**options, "t_eval": np.sign(end) * np.array(options["t_eval"])} if "t_eval" in options else options
        once = lh.integrate(FIELD, (0, end), start, step=step, engine=engine, **given)
        made = propagator((0, end), start, **given)
        np.testing.assert_array_equal(made.y, once.y)
        np.testing.assert_array_equal(made.t, once.t)
        assert (made.status, made.nfev, str(made.report)) == (once.status, once.nfev, str(once.report))


@pytest.mark.parametrize("engine", ["numpy", "llvm"])
def test_the_default_step_follows_the_tolerance_of_the_call(engine: str) -> None:
    propagator = lh.Propagator(FIELD, engine=engine)
    steps = [propagator((0, 1), START, rtol=rtol, atol=0).report.step for rtol in (1e-3, 1e-6, 1e-10, 1e-6)]
    assert steps == ["Taylor(n=5)", "Taylor(n=8)", "Taylor(n=13)", "Taylor(n=8)"]
    assert propagator((0, 1), START, dt=0.1).report.step == "LieTaylor(n=6)"
    ends = [propagator((0, 3), START, rtol=rtol, atol=0, t_eval=[3]).y[:, -1] for rtol in (1e-12, 1e-4, 1e-12)]
    assert np.array_equal(ends[0], ends[2]) and 1e-12 < np.abs(ends[0] - ends[1]).max() < 1e-4


@pytest.mark.parametrize("step", [lh.LieTaylor(4), None], ids=["given", "default"])
def test_an_engine_gets_the_same_field_step_and_exponential_in_all_calls(step: lh.Step | None) -> None:
    engine = Recording()
    propagator = lh.Propagator(FIELD, step, exponential="cayley", clock="nominal", engine=engine)
    assert propagator((0, 1), START, dt=0.5).status == propagator((1, 0), [START, START], rtol=1e-3).status == 0
    first, second = engine.problems
    assert first.field is second.field is FIELD
    assert first.step is second.step and (first.step is propagator.step) is (step is not None)
    assert first.action.exponential is second.action.exponential
    assert first.bound is FIELD and first.args is None
    assert first.options.nominal and second.options.nominal
    assert second.start.shape == (2, 3) and np.array_equal(second.orbit_dimension, [2, 2])
    assert propagator.engine is engine


def test_the_default_step_is_that_of_integrate() -> None:
    assert lh.Propagator(FIELD).step is None and "default step" in repr(lh.Propagator(FIELD))
    assert lh.integrate(FIELD, (0, 1), START).report.step == "Taylor(n=8)"
    np.testing.assert_array_equal(lh.Propagator(FIELD)((0, 1), START).y, lh.integrate(FIELD, (0, 1), START).y)


@pytest.mark.parametrize(("given", "message"), [
    ({"field": 3}, "GeneratorField"), ({"step": 3}, "expected a step"),
    ({"engine": "fortran"}, "'numpy', 'llvm', 'jax'"), ({"engine": 3}, "engine is 3"),
    ({"clock": "wall"}, "'corrected', 'nominal'"),
])  # fmt: skip
def test_what_is_not_right_is_refused_when_the_propagator_is_made(given: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        lh.Propagator(**{"field": FIELD, **given})


def test_a_lost_order_is_warned_of_where_the_call_is() -> None:
    field = lh.GeneratorField(lh.defining(lh.so(2, 1)), ["3/4 + 3*m0/4", "1/2", "-3*m1/4 - m2/4"])
    step = lh.Corrected(lh.Euler(), 4)
    with pytest.warns(OrderWarning) as caught:
        lh.Propagator(field, step)((0, 2), [0.6, 0.8, 0.0], dt=0.03)
        lh.integrate(field, (0, 2), [0.6, 0.8, 0.0], step=step, dt=0.03)
    assert [w.filename for w in caught] == [__file__] * 2


def test_a_call_that_an_engine_repeats_warns_of_where_it_is() -> None:
    """The second call of LLVM code with the same options takes another way than the first."""
    field = lh.GeneratorField(lh.defining(lh.so(2, 1)), ["3/4 + 3*m0/4", "1/2", "-3*m1/4 - m2/4"])
    propagator = lh.Propagator(field, lh.Corrected(lh.Euler(), 4), engine="llvm")
    with pytest.warns(OrderWarning) as caught:
        for _ in range(2):
            propagator((0, 2), [0.6, 0.8, 0.0], dt=0.03)
    assert [w.filename for w in caught] == [__file__] * 2


# -- inspections ---------------------------------------------------------------------------
def test_an_inspection_finds_what_the_report_of_a_run_finds() -> None:
    field = lh.GeneratorField(lh.defining(lh.so(2, 1)), ["3/4 + 3*m0/4", "1/2", "-3*m1/4 - m2/4"])
    points = np.array([[0.6, 0.8, 0.0], [-1.0, 0.0, 0.0]])
    propagator = lh.Propagator(field, lh.Corrected("euler", 4))
    found = propagator.inspect(points)
    assert found.order.tolist() == [4, 4] and found.rank.tolist() == found.orbit_dimension.tolist() == [2, 2]
    for i in range(2):
        report = propagator((0, 1e-6), points[i], dt=1e-6).report
        assert abs(report.singular_value - found.singular_value[i]) < 1e-12
    # the velocity at this point is a null vector: the range condition fails
    null = lh.GeneratorField(lh.defining(lh.so(2, 1)), ["1", "1", "m0"])
    failed = lh.Propagator(null, lh.Corrected("euler", 3)).inspect([1.0, 0.0, 0.0])
    assert failed.order < 3 or failed.singular_value < 1e-12
    plain = lh.Propagator(FIELD, "rk4").inspect([START, START])
    assert plain.order.tolist() == [4, 4] and np.isinf(plain.singular_value).all()
    assert str(plain) == "RKMK('rk4') at 2 points\norder 4"


# -- what a call does not take ---------------------------------------------------------------------------------
@pytest.mark.parametrize("name", ["step", "exponential", "clock", "engine"])
def test_a_call_says_that_a_propagator_has_its_method_from_the_beginning(name: str) -> None:
    with pytest.raises(TypeError, match=rf"^{name} is given once, as in Propagator\(field, {name}=\.\.\.\)"):
        lh.Propagator(FIELD)((0, 1), START, **{name: "rk4"})
    with pytest.raises(TypeError, match="did you mean 'step'"):
        lh.integrate(FIELD, (0, 1), START, stp="rk4")  # type: ignore[call-arg]


@pytest.mark.parametrize("wrong", [np.array([1.0, 2.0]), np.ones((4, 5))], ids=["short", "matrix"])
def test_args_of_a_shape_that_psi_does_not_take_are_named(wrong: Any) -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, args: -m / args["inertia"])
    propagator = lh.Propagator(field, "rk4", engine="llvm")
    message = rf"psi fails with these args \(.*broadcast.*\): args\['inertia'\] has shape \{str(wrong.shape)[:-1]}"
    with pytest.raises(ShapeError, match=message):  # in the first call
        lh.integrate(field, (0, 1), START, args={"inertia": wrong}, step="rk4", dt=0.1)
    good = {"inertia": np.array([1.0, 2.0, 3.0])}
    assert propagator((0, 1), START, args=good, dt=0.1).success
    with pytest.raises(ShapeError, match=message):  # and in a later one
        propagator((0, 1), START, args={"inertia": wrong}, dt=0.1)
    assert propagator((0, 1), START, args=good, dt=0.1).success


MASKED = np.ma.masked_array([0.6, 0.0, 0.8], [False, True, False])
WITH_ARGS = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, args: -m * args)


@pytest.mark.parametrize(
    ("what", "call"),
    [
        ("the start", lambda: lh.integrate(FIELD, (0, 1), MASKED)),
        ("the start", lambda: lh.integrate(FIELD, (0, 1), [START, MASKED])),
        ("the start", lambda: lh.Propagator(FIELD)((0, 1), MASKED)),
        ("the start", lambda: lh.integrate_ensemble(FIELD, (0, 1), [MASKED, START])),
        ("t_eval", lambda: lh.integrate(FIELD, (0, 1), START, t_eval=MASKED)),
        ("dt", lambda: lh.integrate(FIELD, (0, 1), np.eye(3), dt=MASKED + 0.1)),
        ("atol", lambda: lh.integrate(FIELD, (0, 1), START, atol=MASKED)),
        ("args", lambda: lh.integrate(WITH_ARGS, (0, 1), START, args=MASKED)),
        ("args", lambda: lh.integrate(WITH_ARGS, (0, 1), np.eye(3), args=lh.PerTrajectory(MASKED[:, None]))),
        ("psi", lambda: lh.GeneratorField(FIELD.representation, MASKED)),
        ("a value of the field", lambda: lh.GeneratorField(FIELD.representation, lambda m: MASKED).psi(START)),
        ("a point", lambda: FIELD.vector(MASKED)),
        ("a point", lambda: lh.Action(FIELD.representation).act(START, MASKED)),
        ("a point", lambda: lh.steps.correction(FIELD, lh.Euler(), MASKED, 2)),
        ("a point", lambda: lh.Jet(MASKED)),
    ],
)
def test_masked_arrays_are_refused_where_floats_come_in(what: str, call: Any) -> None:
    with pytest.raises(InputError, match=f"^{what} is a masked array, and a masked entry has no number"):
        call()
