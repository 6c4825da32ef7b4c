"""Work and precision: errors are those of observed_order, work is counted, and no run is lost."""

import csv
import io
import math
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import FormatError, InputError, LimitError, ShapeError
from liehom.flow.convergence.costs import (
    Compared,
    Outcome,
    Setting,
    WorkPrecisionRow,
    WorkPrecisionTable,
    step_method,
    timed_run,
    work_precision,
    work_precision as module_of_function,
)
from liehom.flow.convergence.reference import Reference

START = np.array([0.6, 0.0, 0.8])
MOMENTS = np.array([1.0, 2.0, 3.0])
SIZES = (0.5, 0.25, 0.125)


def body(psi: Callable[[Any], Any] = lambda m: -m / MOMENTS) -> lh.GeneratorField:
    return lh.GeneratorField(lh.adjoint(lh.so(3)), psi)


def study(methods: Any = ("heun", "rk4"), field: lh.GeneratorField | None = None, **options: Any) -> WorkPrecisionTable:
    given = {"dts": SIZES, "repeats": 1, **options}
    return work_precision(field or body(), methods, (0, 4), given.pop("y0", START), **given)


def of(table: WorkPrecisionTable, method: str) -> list[WorkPrecisionRow]:
    return [row for row in table.rows if row.method == method]


def test_errors_are_those_of_observed_order() -> None:
    table, step = study(["heun"]), lh.Heun()
    orders = lh.observed_order(body(), START, step, SIZES, t_span=(0, 4))
    np.testing.assert_array_equal([row.error for row in table.rows], orders.trajectory_errors)
    np.testing.assert_array_equal([row.orbit_error for row in table.rows], orders.orbit_errors)
    assert [row.floor for row in table.rows] == list(orders.floors)
    assert table.reference_accuracy == orders.reference_accuracy


@pytest.mark.parametrize(("step", "order", "stages"), [("euler", 1, 1), ("heun", 2, 2), ("rk4", 4, 4)])
def test_errors_fall_with_the_order_and_work_grows_with_the_steps(step: str, order: int, stages: int) -> None:
    rows = study([step], dts=(0.1, 0.05)).rows
    assert abs(math.log2(rows[0].error / rows[1].error) - order) < 0.2
    assert [row.steps for row in rows] == [40, 80]
    assert [row.calls for row in rows] == pytest.approx([40 * stages, 80 * stages], abs=2 * stages)
    assert all(row.cpu_time > 0 and row.wall_time > 0 for row in rows)


def test_an_ensemble_has_the_root_mean_square_of_its_errors() -> None:
    starts = np.array([START, [0.0, 0.6, 0.8]])
    both = study(["rk4"], y0=starts)
    single = [study(["rk4"], y0=start) for start in starts]
    assert both.trajectories == 2
    for k, row in enumerate(both.rows):
        assert row.error == pytest.approx(math.hypot(*(table.rows[k].error for table in single)) / math.sqrt(2))


def test_adaptive_runs_and_methods_of_scipy_meet_tolerances() -> None:
    table = study([None, "scipy dop853"], dts=(), tolerances=(1e-4, 1e-8))
    assert table.methods == ("default", "scipy DOP853")
    for row in table.rows:
        assert row.dt is None and row.tolerance is not None and row.error < 30 * row.tolerance
    coarse, fine = of(table, "scipy DOP853")
    assert fine.error < coarse.error / 100
    assert fine.calls is not None and coarse.calls is not None and fine.calls > coarse.calls


def test_methods_of_scipy_integrate_ensembles_and_fields_that_depend_on_time() -> None:
    field = lh.GeneratorField(lh.defining(lh.so(2)), lambda m, t: np.cos(t)[..., None])
    starts = np.array([[1.0, 0.0], [0.0, 2.0]])
    table = work_precision(field, ["scipy RK45", "rk4"], (0, 2), starts, tolerances=[1e-9], repeats=1)
    assert all(row.error < 1e-7 for row in table.rows)


def test_warnings_of_scipy_are_messages_of_rows() -> None:
    (row,) = study(["scipy RK45"], dts=(), tolerances=[1e-14]).rows
    assert not row.failed and "`rtol` is too small" in row.message


def test_both_kinds_of_settings_are_sorted_by_method() -> None:
    table = study({"a": "rk4", "b": "scipy RK45"}, dts=(0.25, 0.5), tolerances=(1e-6, 1e-3))
    assert [(row.method, row.setting) for row in table.rows] == [
        ("a", "dt 0.5"), ("a", "dt 0.25"), ("a", "tol 0.001"), ("a", "tol 1e-06"), ("b", "tol 0.001"),
        ("b", "tol 1e-06"),
    ]  # fmt: skip


# -- failures ------------------------------------------------------------------------------------------------
def test_a_run_that_fails_is_a_row_that_says_why() -> None:
    table = study(["rk4"], max_steps=10)
    assert [row.failed for row in table.rows] == [False, True, True]
    assert all("max_steps" in row.message for row in table.rows[1:])
    assert str(table).count("failed") == 4  # the cell and the note of each
    assert table.rows[1].calls is None and math.isnan(table.rows[1].cpu_time)


def branching(m: Any) -> Any:
    return -m / MOMENTS if np.all(m[..., 0] > -2) else m


def test_a_step_that_cannot_expand_the_field_fails_alone_and_the_reference_is_one_of_scipy() -> None:
    table = study(["rk4", lh.LieTaylor(4)], body(branching))
    assert "DOP853" in table.reference and 1e-16 < table.reference_accuracy < 1e-8
    assert not any(row.failed for row in of(table, "rk4"))
    assert all(row.failed and row.message for row in of(table, repr(lh.LieTaylor(4))))
    smooth = study(["rk4"])
    assert "no orbit errors" in str(table) and "no orbit errors" not in str(smooth)
    for row, wanted in zip(of(table, "rk4"), smooth.rows, strict=True):
        assert math.isnan(row.orbit_error) and row.error == pytest.approx(wanted.error, rel=1e-4)


def test_errors_that_the_field_raises_are_rows_unless_they_are_mistakes() -> None:
    def far(m: Any) -> Any:
        if np.any(np.abs(m[..., 1]) > 0.3):
            raise ValueError("too far")
        return -m / MOMENTS

    exact = (Reference(body(), START)(4.0), 1e-15)
    assert all(row.message == "too far" for row in study(["rk4"], body(far), reference=exact).rows)
    calls = []

    def mistaken(m: Any) -> Any:
        calls.append(1)
        return -m / MOMENTS if len(calls) < 5 else missing  # type: ignore[name-defined] # noqa: F821

    with pytest.raises(NameError):
        study(["rk4"], body(mistaken), reference=exact)


@pytest.mark.parametrize("stop", [KeyboardInterrupt(), LimitError("seconds", 2, 1, "a study")], ids=repr)
def test_an_interrupted_study_keeps_what_is_finished(stop: BaseException) -> None:
    calls = []

    def psi(m: Any) -> Any:
        calls.append(1)
        if len(calls) > limit:
            raise stop
        return -m / MOMENTS

    exact, whole = (Reference(body(), START)(4.0), 1e-15), study()
    limit = 80
    table = study(field=body(psi), reference=exact)
    assert 0 < len(table.rows) < table.planned == 6
    assert f"interrupted: {len(table.rows)} of 6 runs" in str(table)
    known = {(row.method, row.dt): row.error for row in whole.rows}
    assert all(row.error == pytest.approx(known[row.method, row.dt]) for row in table.rows)
    calls.clear()
    limit = 5
    with pytest.raises(type(stop)):
        study(field=body(psi), reference=exact)


# -- references ----------------------------------------------------------------------------------------------
def test_errors_below_the_accuracy_of_the_reference_are_marked() -> None:
    exact = Reference(body(), START)(4.0)
    rough, sharp = study(["rk4"], reference=(exact, 1e-4)), study(["rk4"], reference=(exact, 1e-15))
    assert [row.error < row.floor for row in rough.rows] == [row.error < 1e-3 for row in sharp.rows]
    assert any(row.error < row.floor for row in rough.rows)
    assert "e-05*" in str(rough) and "* not resolved" in str(rough)
    assert "*" not in str(sharp)


def test_a_given_series_is_used() -> None:
    table = study(["rk4"], reference=Reference(body(), START, order=8, tolerance=1e-6))
    assert table.reference == "given series" and table.reference_accuracy > 1e-12
    with pytest.raises(InputError, match="another point"):
        study(["rk4"], reference=Reference(body(), START[::-1]))


@pytest.mark.parametrize(("changes", "error", "message"), [
    ({"dts": ()}, InputError, "tolerances="), ({"dts": [0.1, -1]}, InputError, "dts is"),
    ({"tolerances": ["x"]}, InputError, "tolerances is"),
    ({"methods": []}, InputError, "methods with different labels"),
    ({"methods": ["rk4", "rk4"]}, InputError, "different labels"),
    ({"methods": ["rk5"]}, InputError, "no step is called 'rk5'"),
    ({"methods": ["scipy rk4"]}, InputError, "no method of scipy is called 'rk4'"),
    ({"methods": ["scipy RK45"]}, InputError, "scipy RK45: methods of scipy have no fixed step sizes"),
    ({"repeats": 0}, InputError, "repeats is 0"), ({"engine": "fortran"}, InputError, "engine is 'fortran'"),
    ({"y0": [1.0, 0.0]}, ShapeError, "3 coordinates"),
    ({"reference": (START[:2], 1e-9)}, ShapeError, r"points of shape \(2,\)"),
    ({"reference": (START,)}, InputError, "expected a Reference or"),
    ({"reference": 3}, InputError, "expected a liehom.convergence.Reference"),
    ({"progress": 3}, InputError, "progress is 3"),
])  # fmt: skip
def test_wrong_arguments_are_refused(changes: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        study(**changes)


def test_a_field_is_needed() -> None:
    with pytest.raises(InputError, match="GeneratorField"):
        work_precision(3, ["rk4"], (0, 1), START, dts=[0.1])  # type: ignore[arg-type]


# -- times ---------------------------------------------------------------------------------------------------
def counted(compiles: bool, seconds: list[float], clock: list[float]) -> Compared:
    """A method without work, whose calls take given seconds."""

    def run(setting: Setting) -> Outcome:
        clock[0] += seconds.pop(0)
        return Outcome(START, 1, 1)

    return Compared("counted", run, compiles)


@pytest.mark.parametrize(
    ("compiles", "seconds", "repeats", "wanted", "left"),
    [
        (False, [0.5, 0.25, 0.375, 9.0], 3, 0.25, 1),  # the fastest of three
        (True, [0.125, 0.5, 0.25, 0.375, 9.0], 3, 0.25, 1),  # the call that compiles is not timed
        (False, [2.0, 9.0], 3, 2.0, 1),  # no second call after more than a second
        (True, [5.0, 2.0, 9.0], 3, 2.0, 1),
        (False, [0.5, 9.0], 1, 0.5, 1),
    ],
)
def test_the_fastest_call_counts(
    monkeypatch: pytest.MonkeyPatch, compiles: bool, seconds: list[float], repeats: int, wanted: float, left: int
) -> None:
    clock = [0.0]
    clocks = SimpleNamespace(process_time=lambda: clock[0], perf_counter=lambda: clock[0])
    monkeypatch.setattr(sys.modules[timed_run.__module__], "time", clocks)
    _, cpu, wall = timed_run(counted(compiles, seconds, clock), Setting(dt=0.1), repeats)
    assert (cpu, wall, len(seconds)) == (wanted, wanted, left)


def test_progress_reaches_the_end() -> None:
    seen: list[float] = []
    study(progress=seen.append)
    assert seen[0] == 0.0 and seen[-1] == 1.0 and seen == sorted(seen)


def test_a_compiled_engine_gives_the_same_errors() -> None:
    pytest.importorskip("llvmlite")
    compiled, plain = study(["rk4"], engine="llvm", dts=[0.25]), study(["rk4"], dts=[0.25])
    assert compiled.engine == "llvm"
    assert compiled.rows[0].error == pytest.approx(plain.rows[0].error, rel=1e-9)


# -- the table -----------------------------------------------------------------------------------------------
def test_comma_separated_values_have_every_digit(tmp_path: Path) -> None:
    table = study(["rk4", lh.Corrected(lh.Euler(), 2)], max_steps=20)
    target = tmp_path / "study.csv"
    text = table.to_csv(target)
    assert target.read_text(encoding="utf-8") == text
    rows = list(csv.DictReader(io.StringIO(text)))
    assert list(rows[0]) == list(WorkPrecisionRow._fields)
    for row, wanted in zip(rows, table.rows, strict=True):
        assert row["method"] == wanted.method and float(row["dt"]) == wanted.dt and row["tolerance"] == ""
        assert row["error"] == ("" if wanted.failed else repr(wanted.error))
        assert row["calls"] == ("" if wanted.failed else str(wanted.calls))
    with pytest.raises(FormatError, match="already"):
        table.to_csv(target)
    table.to_csv(target, force=True)


def test_the_table_is_shown_as_text_markdown_latex_and_html() -> None:
    table = study(["rk4"])
    assert repr(table) == str(table) and table._cells()[1][0] in repr(table)
    assert table.to_markdown().splitlines()[1] == "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |"
    assert lh.latex(table).count(r"\\") == len(table.rows)
    assert table._repr_html_().count("<tr>") == 1 + len(table.rows)


def test_the_function_is_at_the_top() -> None:
    assert lh.work_precision is work_precision is module_of_function


@pytest.mark.parametrize(("y0", "options", "match"), [
    (np.zeros((0, 3)), {}, "empty ensemble"), ([0.6, 0.0, 0.8], {"max_steps": "a"}, "max_steps"),
    ([0.6, 0.0, 0.8], {"max_steps": -1}, "max_steps"),
    ([0.6, 0.0, 0.8], {"reference": ([0.6, 0.0, float("nan")], 1e-3)}, "reference"),
    ([0.6, 0.0, 0.8], {"reference": ([0.6, 0.0, 0.8], -1.0)}, "reference"),
    ([0.6, 0.0, 0.8], {"reference": ([0.6, 0.0, 0.8], 1.0, 2.0)}, "reference"),
])  # fmt: skip
def test_studies_without_a_meaning_are_refused(y0: Any, options: Any, match: str) -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / [1.0, 2.0, 3.0])
    with pytest.raises((InputError, ShapeError), match=match):
        lh.work_precision(field, ["rk4"], (0, 1), y0, dts=[0.5], **options)


def test_a_lost_order_is_a_message_of_the_row() -> None:
    field = lh.GeneratorField(lh.defining(lh.su(3)), [f"{k + 1}*m{k % 6}" for k in range(8)])
    start = np.array([0.6, 0.0, 0.0, 0.48, 0.64, 0.0])
    for step, said in ((lh.Heun(), ""), (lh.Corrected(lh.Euler(), 3), "order 3 was not kept")):
        method = step_method("", lh.Propagator(field, step, engine="numpy"), (0.0, 1.0), start, 100)
        outcome = method.run(Setting(dt=0.25))
        assert (outcome.steps, bool(outcome.message)) == (4, bool(said))
        assert said in outcome.message


ROWS = """
method      setting       error  orbit error  calls  steps
heun        dt 0.25     3.5e-02      1.4e-02     10      4
heun        tol 0.0001  5.7e-04      3.0e-04    318     34
scipy RK45  tol 0.0001  6.9e-04      5.5e-04     38      5
"""


def test_the_text_of_a_table_without_its_times() -> None:
    field = lh.GeneratorField(lh.defining(lh.so(3)), ["1 + m0/2", "2*m1 - m2**2", "sin(t) + m2"])
    options: Any = {"dts": [0.25], "tolerances": [1e-4], "repeats": 1}
    table = lh.work_precision(field, ["heun", "scipy RK45"], (0, 1), [0.48, 0.6, 0.64], **options)
    first, *rows, reference, machine = str(table).splitlines()
    assert first == "errors at t = 1, from t = 0"
    assert [row[:58].rstrip() for row in rows] == [row.rstrip() for row in ROWS.strip().splitlines()]
    assert rows[0][58:].split() == ["CPU", "ms", "wall", "ms"] and all(len(row.split()) >= 8 for row in rows)
    assert reference == "reference: Taylor series in extended precision, accurate to 1e-19"
    assert machine.startswith("times on ") and machine.endswith(", engine numpy, without compilation")
