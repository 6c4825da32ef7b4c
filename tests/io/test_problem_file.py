"""Problems of representation files: the field, the step, the integration; solutions as files."""

import copy
import json
import os
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom import io
from liehom.base import errors
from liehom.flow.run.solution import Solution
from liehom.io.solution_file import report_json, save_solution

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
SPHERE: dict[str, Any] = {
    "matrices": [
        [["0", "-1", "0"], ["1", "0", "0"], ["0", "0", "0"]],
        [["0", "0", "-1"], ["0", "0", "0"], ["1", "0", "0"]],
        [["0", "0", "0"], ["0", "0", "-1"], ["0", "1", "0"]],
    ],
    "point": ["3/5", 0, "4/5"],
    "generator": ["-m2/3", "m1/2", "-m0"],
    "t_span": [0, 1],
}


def problem(**keys: Any) -> io.Problem:
    """The sphere with some keys changed; a key that is None is left out."""
    data = {**copy.deepcopy(SPHERE), **keys}
    return io.loads(json.dumps({key: x for key, x in data.items() if x is not None}), problem=True)


def refuses(error: type[Exception], *named: str) -> Any:
    return pytest.raises(error, match=r"(?s)" + "".join(f"(?=.*{word})" for word in named))


def final(solution: Any) -> Any:
    return solution.y[:, -1]


# -- the field -------------------------------------------------------------------------------------------
def test_the_generator_means_what_it_says() -> None:
    field = problem(generator=["-m2/3 + t", "m1**2/2", "sin(m0)"]).field()
    m = np.array([0.3, -0.2, 0.9])
    psi = [-0.3 + 0.5, 0.02, np.sin(0.3)]
    assert np.allclose(field.psi(m, 0.5), psi, rtol=1e-15)
    a, b, c = psi
    assert np.allclose(field.vector(m, 0.5), [-a * m[1] - b * m[2], a * m[0] - c * m[2], b * m[0] + c * m[1]])
    assert field.time_dependent


def test_a_vector_field_is_an_alternative_to_a_generator() -> None:
    by_generator = problem()
    by_field = problem(generator=None, vector_field=["m2*m1/3 - m1*m2/2", "-m2*m0/3 + m0*m2", "m1*m0/2 - m0*m1"])
    m = np.array([0.3, -0.2, 0.9])
    assert np.allclose(by_field.field().vector(m), by_generator.field().vector(m), atol=1e-14)
    assert by_field.generator is None
    # LieTaylor takes other generators, so it is the trajectories that agree
    assert np.allclose(final(by_field.integrate()), final(by_generator.integrate()), atol=1e-5)


def test_fewer_matrices_than_dimensions_take_fewer_coefficients() -> None:
    found = problem(matrices=SPHERE["matrices"][:2], generator=["1", "m0"])
    assert found.representation.algebra.dimension == 3
    assert found.field().psi(np.array([2.0, 0.0, 0.0])).tolist() == [1.0, 2.0, 0.0]


@pytest.mark.parametrize(
    ("keys", "error", "named"),
    [
        ({"vector_field": ["0", "0", "0"]}, errors.FormatError, ("generator", "vector_field")),
        ({"generator": None, "vector_field": ["0", "0"]}, errors.FormatError, ("vector_field", "coordinate, 3")),
        ({"generator": None, "vector_field": "0"}, errors.FormatError, ("vector_field", "list")),
        ({"generator": None, "vector_field": ["0", 1, "0"]}, errors.FormatError, (r"vector_field\[1\]",)),
        ({"generator": None, "vector_field": ["m3", "0", "0"]}, errors.ParseError, (r"vector_field\[0\]", "m3")),
        ({"generator": ["m0", "m0"]}, errors.FormatError, ("generator", "matrix, 3")),
    ],
)
def test_fields_of_the_wrong_form(keys: dict[str, Any], error: type[Exception], named: tuple[str, ...]) -> None:
    with refuses(error, *named):
        problem(**keys)


def test_a_vector_field_that_is_not_tangent() -> None:
    with refuses(errors.TangencyError, "normal component"):
        problem(generator=None, vector_field=["m0", "m1", "m2"]).integrate()


# -- what is missing -------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("keys", "named"),
    [
        ({"generator": None}, "'generator' nor 'vector_field'"),
        ({"point": None}, "'point'"),
        ({"t_span": None}, "'t_span'"),
    ],
)
def test_what_is_missing_is_named(keys: dict[str, Any], named: str) -> None:
    with refuses(errors.FormatError, named):
        problem(**keys).integrate()


def test_what_is_missing_may_be_given() -> None:
    found = problem(t_span=None, point=None).integrate(t_span=(0, 1), y0=[0.6, 0, 0.8])
    assert np.array_equal(found.y, problem().integrate().y)


# -- steps and options -----------------------------------------------------------------------------------
def test_the_step_of_a_file() -> None:
    assert repr(problem().step()) == "LieTaylor(n=6)"
    assert repr(problem(order=3).step()) == "LieTaylor(n=3)"
    made = problem(base="euler", order=4)
    assert repr(made.step()) == "Corrected(Euler(), order=4)"
    assert repr(made.step("rk4")) == "RKMK('rk4')"
    assert repr(made.step(order=2)) == "Corrected(Euler(), order=2)"


def test_options_reach_the_integrator() -> None:
    found = problem(base="euler", order=3, dt=0.25, exponential="cayley", clock="nominal").integrate()
    assert found.n_steps == 4
    assert found.t.tolist() == [0, 0.25, 0.5, 0.75, 1]
    assert (found.report.clock, found.report.wanted_order, found.report.base_order) == ("nominal", 3, 1)
    assert "Cayley" in found.report.exponential
    loose, tight = problem(rtol=1e-3).integrate(), problem(rtol=1e-10, atol="1/1000000000000").integrate()
    assert loose.n_steps < tight.n_steps


def test_overrides_take_the_place_of_options() -> None:
    made = problem(dt=0.5, base="euler", order=4)
    assert made.integrate(dt=0.25).n_steps > made.integrate().n_steps
    assert made.integrate(base="heun", order=1).report.step == "Heun()"
    assert made.integrate(step=lh.LieTaylor(3)).report.step == "LieTaylor(n=3)"
    assert made.integrate(t_span=(0, 2)).t[-1] == 2


def test_t_eval_gives_these_times() -> None:
    assert problem(t_eval=[0, "1/3", 0.9]).integrate().t.tolist() == [0, 1 / 3, 0.9]


def test_backwards_undoes_forwards() -> None:
    there = problem(rtol=1e-11, atol=1e-13).integrate()
    back = problem(rtol=1e-11, atol=1e-13, t_span=[1, 0], point=[float(x) for x in final(there)]).integrate()
    assert back.t[-1] == 0
    assert np.allclose(final(back), [0.6, 0, 0.8], atol=1e-9)


def test_equal_ends_are_the_start() -> None:
    found = problem(t_span=[2, 2]).integrate()
    assert found.y[:, -1].tolist() == [0.6, 0.0, 0.8]
    assert found.t[-1] == 2
    assert found.success


@pytest.mark.parametrize(
    ("keys", "named"),
    [
        ({"base": "eulr"}, ("eulr", "did you mean 'euler'", "rk4")),
        ({"exponential": "log"}, ("log", "cayley")),
        ({"clock": "wall"}, ("wall", "nominal")),
        ({"t_eval": [0, 2]}, ("t_eval", "t_span")),
        ({"t_eval": [1, 0]}, ("t_eval", "sorted")),
    ],
)
def test_names_and_values_that_do_not_fit_are_refused_when_used(keys: dict[str, Any], named: tuple[str, ...]) -> None:
    made = problem(**keys)
    with refuses(errors.InputError, *named):
        made.integrate()


@pytest.mark.parametrize(
    ("texts", "index"),
    [
        (["1/m1", "0", "0"], 0),
        (["0", "log(m1)", "0"], 1),
        (["0", "0", "sqrt(m1 - 1)"], 2),
        (["0", "m1**-3", "0"], 1),
        (["0", "exp(2000*m0)", "0"], 1),
        (["0", "log(t)", "0"], 1),
        (["m1/m1", "0", "0"], 0),
    ],
)
def test_a_field_that_is_not_finite_at_the_start(texts: list[str], index: int) -> None:
    for keys in ({"generator": texts}, {"generator": None, "vector_field": texts}):
        name = "vector_field" if "vector_field" in keys else "generator"
        with refuses(errors.InputError, rf"{name}\[{index}\] is -?(inf|nan) at the start"):
            problem(**keys).integrate()


@pytest.mark.parametrize(
    "text", ["1" + "0" * 400, "10**400", "m0/10**400", "0*2**4096", "1/0", "0**-1", "m0*(1/(1 - 1))"]
)
def test_numbers_beyond_floats_and_divisions_by_zero(text: str) -> None:
    with refuses(errors.InputError, r"generator\[2\]"):
        problem(generator=["0", "0", text]).integrate()


@pytest.mark.filterwarnings("ignore:status -1")
def test_a_field_may_leave_the_finite_later() -> None:
    """psi has a pole at t = 1/2: the run ends with a status and a message, and keeps what was reached."""
    found = problem(generator=["1/(1/2 - t)**2", "0", "0"], rtol=1e-3).integrate(max_steps=2000)
    assert not found.success
    assert found.message
    assert np.isfinite(found.y).all()
    assert found.t[-1] < 0.5


# -- the examples ----------------------------------------------------------------------------------------
def test_the_driven_spin_is_the_rotation_in_closed_form() -> None:
    """psi = (1, cos 2t / 2, sin 2t / 2): in the frame that turns by 2t about the first element it is constant."""
    from scipy.linalg import expm

    made = io.load_problem(EXAMPLES / "driven_spin.json")
    first, second, third = (a.to_numpy() for a in made.representation.matrices)
    sign = 1 if np.allclose(expm(-first) @ second @ expm(first), np.cos(1) * second - np.sin(1) * third) else -1
    solution = made.integrate(base="lietaylor", order=8)
    assert solution.t.tolist() == [0, 1, 2, 3, 4, 5, 6]
    for t, y in zip(solution.t, solution.y.T, strict=True):
        exact = expm(2 * sign * t * first) @ expm(t * (first + second / 2 - 2 * sign * first)) @ made.start
        assert np.allclose(y, exact, atol=1e-9)


def test_the_damped_spin_of_the_vector_field_in_closed_form() -> None:
    """m2' = (1 - m2^2)/5, so m2 = tanh(t/5 + artanh m2(0)), and m0 + i m1 turns by -t."""
    solution = io.load_problem(EXAMPLES / "vector_field.json").integrate()
    t, y = solution.t, solution.y
    assert np.allclose(y[2], np.tanh(t / 5 + np.arctanh(-0.8)), atol=1e-6)
    assert np.allclose(y[0] + 1j * y[1], np.exp(-1j * t) * np.sqrt(1 - y[2] ** 2), atol=1e-6)


@pytest.mark.parametrize(("name", "reached"), [("sym3_flow", 4), ("sym3_generic", 1), ("rigid_body", 6)])
def test_the_order_that_the_report_states(name: str, reached: int) -> None:
    made = io.load_problem(EXAMPLES / f"{name}.json")
    with pytest.warns(lh.OrderWarning) if name == "sym3_generic" else nullcontext():
        solution = made.integrate()
    assert solution.report.order == reached
    assert (name == "sym3_generic") == (solution.report.range_condition is False)
    if name != "rigid_body":
        start, end = (np.linalg.eigvalsh(sym3(y)) for y in (solution.y[:, 0], solution.y[:, -1]))
        assert np.allclose(start, end, atol=1e-13)


def sym3(y: Any) -> Any:
    a, b, c, d, e, f = y
    return np.array([[a, b, c], [b, d, e], [c, e, f]])


# -- solutions as files ----------------------------------------------------------------------------------
def test_a_solution_file_has_arrays_and_a_text(tmp_path: Path) -> None:
    solution = problem(base="euler", order=3, dt=0.25).integrate()
    out = tmp_path / "out.npz"
    save_solution(solution, out)
    with np.load(out, allow_pickle=False) as file:
        assert {"report", "t", "y"} <= set(file.files)
        assert np.array_equal(file["t"], solution.t)
        assert np.array_equal(file["y"], solution.y)
        report = json.loads(str(file["report"]))
    assert report["format"] == "liehom-solution"
    assert report["report"]["order"] == 3
    again = Solution.load(out)
    assert again.report == solution.report
    assert np.array_equal(again.y, solution.y)
    assert os.listdir(tmp_path) == ["out.npz"]


def test_a_name_without_suffix_is_kept(tmp_path: Path) -> None:
    save_solution(problem().integrate(), tmp_path / "out")
    assert os.listdir(tmp_path) == ["out"]


def test_a_file_that_is_there_stays(tmp_path: Path) -> None:
    out = tmp_path / "out.npz"
    out.write_text("mine")
    solution = problem().integrate()
    with refuses(errors.FormatError, "out.npz", "there already"):
        save_solution(solution, out)
    assert out.read_text() == "mine"
    save_solution(solution, out, force=True)
    with np.load(out) as file:
        assert file["y"].shape == solution.y.shape


@pytest.mark.parametrize("name", ["no/such/out.npz", "", ".", "a\0b"])
def test_places_where_no_file_can_be(name: str, tmp_path: Path) -> None:
    solution = problem().integrate()
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path)
        with pytest.raises(errors.FormatError):
            save_solution(solution, name)
    assert list(tmp_path.iterdir()) == []


def test_nothing_half_written_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(file: Any, **arrays: Any) -> None:
        file.write(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", fails)
    with refuses(errors.FormatError, "No space left"):
        save_solution(problem().integrate(), tmp_path / "out.npz")
    assert list(tmp_path.iterdir()) == []


def test_a_report_is_json_also_where_nothing_is_finite() -> None:
    made = report_json(problem().integrate().report)
    assert made["singular_value"] is None
    assert json.loads(json.dumps(made, allow_nan=False)) == made
