"""``liehom integrate`` and ``liehom order``: what they print and write, what they refuse before any work."""

import json
import os
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import liehom as lh
from liehom.cli import inputs as cli_problem
from liehom.cli.app import app
from liehom.cli.inputs import path_argument
from liehom.cli.integration import invariant_drift
from liehom.flow.run.run import Run

RIGID, SYM3, SPIN = "examples/rigid_body.json", "examples/sym3_generic.json", "examples/driven_spin.json"


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In an empty folder: 'examples/...' is found in the package."""
    monkeypatch.chdir(tmp_path)


def liehom(*words: str) -> Result:
    return CliRunner().invoke(app, list(words))


def json_of(result: Result) -> dict[str, Any]:
    assert result.stderr == ""
    data = json.loads(result.stdout)
    assert isinstance(data, dict)
    return data


def written() -> list[str]:
    return sorted(os.listdir("."))


def refused(result: Result, *named: str) -> None:
    """Exit code 2, a message in one line on standard error, nothing on standard output, nothing written."""
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    assert result.stderr.startswith("liehom: error: ")
    assert result.stderr.count("\n") == 1
    for word in named:
        assert word in result.stderr


def variant(**keys: Any) -> str:
    """A file: the rigid body with some keys changed, or left out where None."""
    data = {**json.loads(Path(path_argument(RIGID)).read_text("utf-8")), **keys}
    Path("variant.json").write_text(json.dumps({key: x for key, x in data.items() if x is not None}), "utf-8")
    return "variant.json"


# -- what integrate prints and writes --------------------------------------------------------------------
def test_integrate_prints_a_table_and_the_report() -> None:
    result = liehom("integrate", RIGID, "--base", "euler", "--order", "4")
    assert result.exit_code == 0, result.output
    assert result.stderr == ""
    lines = result.stdout.splitlines()
    assert lines[0].split() == ["t", "m0", "m1", "m2", "drift", "of", "invariants"]
    assert lines[11].split()[0] == "10"
    assert "orbits captured to order 4 at every step (base order 1)" in result.stdout
    assert lines[-1] == "t, y and report: not written, --out OUT.npz writes them"
    assert written() == []
    assert liehom("integrate", RIGID, "--out", "run.npz").stdout.splitlines()[-1] == "t, y and report: run.npz"
    assert written() == ["run.npz"]


def test_the_file_has_what_the_library_computes() -> None:
    assert liehom("integrate", SPIN, "--out", "spin.npz").exit_code == 0
    solution = lh.io.load_problem(path_argument(SPIN)).integrate(engine="numpy")  # the default of the command
    with np.load("spin.npz", allow_pickle=False) as file:
        assert np.array_equal(file["t"], solution.t)
        assert np.array_equal(file["y"], solution.y)
        assert json.loads(str(file["report"]))["report"]["step"] == "Corrected(Heun(), order=4)"


def test_integrate_json_is_one_object() -> None:
    data = json_of(liehom("integrate", RIGID, "--json", "--out", "run.npz"))
    assert data["success"] is True
    assert data["out"] == "run.npz"
    assert json_of(liehom("integrate", RIGID, "--json")) == data | {"out": None}
    assert data["report"]["order"] == 6
    assert (len(data["t"]), len(data["y"]), len(data["y"][0])) == (11, 11, 3)
    assert max(data["drift"]) < 1e-13
    assert written() == ["run.npz"]


def test_a_correction_that_fails_is_said() -> None:
    result = liehom("integrate", SYM3)
    assert result.exit_code == 1 and "but order 4 was not kept" in result.stdout and not result.stderr
    assert "order 4 NOT reached" in result.stdout
    assert "FAILS" in result.stdout
    assert json_of(liehom("integrate", SYM3, "--json", "--force"))["report"]["range_condition"] is False


@pytest.mark.parametrize(
    ("words", "key", "value"),
    [
        (("--base", "heun"), "step", "Heun()"),
        (("--order", "3"), "step", "LieTaylor(n=3)"),
        (("--base", "rk4", "--order", "5"), "step", "Corrected(RKMK('rk4'), order=5)"),
        (("--exponential", "cayley"), "exponential", "Cayley"),
        (("--clock", "nominal"), "clock", "nominal"),
    ],
)
def test_options_override_the_file(words: tuple[str, ...], key: str, value: str) -> None:
    assert json_of(liehom("integrate", RIGID, "--json", *words))["report"][key] == value


def test_steps_are_fixed_or_adapted() -> None:
    counts = {
        words: json_of(liehom("integrate", RIGID, "--json", "--force", *words))["n_steps"]
        for words in [(), ("--dt", "1/4"), ("--dt", "0.5"), ("--rtol", "1e-4"), ("--rtol", "1e-11", "--atol", "1e-13")]
    }
    assert list(counts.values())[:3] == [100, 40, 20]
    assert counts["--rtol", "1e-4"] < counts["--rtol", "1e-11", "--atol", "1e-13"]


def test_time_spans_may_run_backwards_or_stand_still() -> None:
    there = json_of(liehom("integrate", RIGID, "--json", "--rtol", "1e-11", "--atol", "1e-13"))
    file = variant(point=there["y"][-1], dt=None, rtol=1e-11, atol=1e-13)
    back = json_of(liehom("integrate", file, "--json", "--t-span", "10", "-0"))
    assert back["t"][-1] == 0
    assert np.allclose(back["y"][-1], [0.6, 0, 0.8], atol=1e-8)
    assert json_of(liehom("integrate", RIGID, "--json", "--force", "--t-span", "0", "-1.5"))["t"][-1] == -1.5
    still = json_of(liehom("integrate", RIGID, "--json", "--force", "--t-span", "3", "3"))
    assert (still["t"][-1], still["y"][-1], still["n_steps"]) == (3, [0.6, 0, 0.8], 0)


def test_another_span_drops_the_times_of_the_file() -> None:
    assert json_of(liehom("integrate", SPIN, "--json"))["t"] == [0, 1, 2, 3, 4, 5, 6]
    assert json_of(liehom("integrate", SPIN, "--json", "--force", "--t-span", "0", "0.5"))["t"][-1] == 0.5


def test_a_run_that_stops_early_is_exit_1_and_keeps_what_it_has() -> None:
    file = variant(generator=["1/(1/2 - t)", "0", "0"], base="euler", order=3, dt=None)
    result = liehom("integrate", file, "--max-steps", "50")
    assert result.exit_code == 1
    assert "\n50 steps. The end was not reached" in result.stdout
    data = json_of(liehom("integrate", file, "--max-steps", "50", "--json", "--out", "variant.npz"))
    assert (data["success"], data["n_steps"]) == (False, 50)
    with np.load("variant.npz") as kept:
        assert kept["y"].shape == (3, 51)


def test_what_overflows_is_a_message_and_no_warning() -> None:
    result = liehom("integrate", variant(generator=["0", "exp(1000*m0)", "0"]))
    assert result.exit_code == 1
    assert "not finite" in result.stdout
    assert result.stderr == ""


# -- order -----------------------------------------------------------------------------------------------
def test_order_prints_the_table() -> None:
    result = liehom("order", RIGID, "--base", "euler", "--order", "3", "--t-span", "0", "2", "--dt", "0.1,1/20,0.025")
    assert result.exit_code == 0, result.output
    assert result.stderr == ""
    lines = result.stdout.splitlines()
    assert lines[0].startswith("Corrected(Euler(), order=3) with exp (Rodrigues), clock corrected, t = 0 to 2")
    assert [line.split()[0] for line in lines[2:5]] == ["0.1", "0.05", "0.025"]
    assert written() == []


@pytest.mark.parametrize(
    ("file", "words", "orbit", "trajectory"),
    [
        (RIGID, ("--base", "euler"), 1, 1),
        (RIGID, ("--base", "euler", "--order", "4"), 4, 4),
        (RIGID, ("--base", "euler", "--order", "4", "--clock", "nominal"), 4, 1),
        (RIGID, ("--base", "rk4"), 4, 4),
        (RIGID, ("--base", "euler", "--order", "3", "--exponential", "cayley"), 3, 3),
        (SYM3, (), 1, 1),
        ("examples/sym3_flow.json", ("--order", "3"), 3, 3),
        (SPIN, ("--order", "3"), 3, 3),
    ],
)
def test_orders_are_what_they_should_be(file: str, words: tuple[str, ...], orbit: float, trajectory: float) -> None:
    data = json_of(liehom("order", file, "--json", "--t-span", "0", "1", "--dt", "0.05,0.025,0.0125", *words))
    assert data["trajectory_order"] == pytest.approx(trajectory, abs=0.15)
    assert data["orbit_order"] > orbit - 0.15
    if file == RIGID:
        assert data["orbit_order"] == pytest.approx(orbit, abs=0.15)
    assert [row["dt"] for row in data["rows"]] == [0.05, 0.025, 0.0125]
    assert data["rows"][0]["orbit_slope"] is None


@pytest.mark.parametrize(
    "sizes", ["", "0.1", "0.1,0.1", "0.1,0", "0.1,-0.05", "0.1,nan", "0.1,x", "0.1,,0.05", "20,10"]
)
def test_invalid_step_sizes_exit_with_2(sizes: str) -> None:
    refused(liehom("order", RIGID, f"--dt={sizes}"))


def test_the_order_of_a_run_that_stands_still() -> None:
    refused(liehom("order", RIGID, "--t-span", "1", "1"), "t_span")


# -- pictures --------------------------------------------------------------------------------------------
@pytest.mark.parametrize(("suffix", "begins"), [("png", b"\x89PNG"), ("pdf", b"%PDF"), ("svg", b"<?xml")])
def test_plots_are_drawn(suffix: str, begins: bytes) -> None:
    picture = f"picture.{suffix}"
    result = liehom("integrate", RIGID, "--plot", picture)
    assert result.exit_code == 0, result.output
    assert result.stdout.endswith(f"plot: {picture}\n")
    assert Path(picture).read_bytes().startswith(begins)
    result = liehom("order", RIGID, "--plot", picture, "--t-span", "0", "1", "--dt", "0.1,0.05")
    assert result.exit_code == 0, result.output
    assert Path(picture).read_bytes().startswith(begins)
    assert written() == [picture]


@pytest.mark.parametrize("file", [RIGID, SYM3, SPIN])
def test_a_compiled_step_gives_the_same(file: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LIEHOM_CACHE_DIR", str(tmp_path / "code"))
    found = []
    for name, words in (("plain.npz", ()), ("made.npz", ("--engine", "llvm"))):
        result = liehom("integrate", file, "--t-span", "0", "2", "--dt", "0.05", "--out", name, *words)
        assert result.exit_code == (1 if file == SYM3 else 0), result.stderr
        found.append(np.load(name)["y"])
    np.testing.assert_allclose(found[1], found[0], rtol=0, atol=1e-13)
    refused = liehom("integrate", file, "--dt", "0.05", "--engine", "fortran", "--out", "other.npz")
    assert refused.exit_code == 2 and "fortran" in refused.stderr and "other.npz" not in written()


@pytest.mark.parametrize("words", [("--t-span", "3", "3"), ("--dt", "0.1", "--max-steps", "3"), ("--t-span", "2", "0")])
def test_plots_of_unusual_runs(words: tuple[str, ...]) -> None:
    result = liehom("integrate", RIGID, "--plot", "picture.png", "--json", *words)
    assert result.exit_code in (0, 1)
    assert json_of(result)["plot"] == "picture.png"
    assert Path("picture.png").stat().st_size > 1000


# -- files -----------------------------------------------------------------------------------------------
def test_a_file_that_is_there_is_not_overwritten() -> None:
    Path("rigid_body.npz").write_text("mine")
    refused(liehom("integrate", RIGID, "--out", "rigid_body.npz"), "rigid_body.npz", "there already")
    assert Path("rigid_body.npz").read_text() == "mine"
    assert liehom("integrate", RIGID, "--out", "rigid_body.npz", "--force").exit_code == 0
    assert Path("rigid_body.npz").read_bytes()[:2] == b"PK"


@pytest.mark.parametrize(
    "words",
    [
        ("--out", "no/such/folder/out.npz"),
        ("--out", "."),
        ("--plot", "no/such/folder/picture.png"),
        ("--plot", "picture.txt"),
        ("--plot", "picture"),
        ("--checkpoint", "no/such/folder/state.npz"),
        ("--out", "same.png", "--plot", "./same.png"),
        ("--out", "same.npz", "--checkpoint", "./same.npz"),
        ("--out", "variant.json", "--force"),
        ("--max-steps", "0"),
    ],
)
def test_places_where_nothing_can_be_written_are_refused_before_the_work(
    words: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    def works(self: Run, *arguments: Any) -> None:
        raise RuntimeError("it works already")

    monkeypatch.setattr(Run, "execute", works)
    file = variant()
    before = Path(file).read_bytes()
    refused(liehom("integrate", file, *words))
    assert Path(file).read_bytes() == before
    assert written() == [file]


@pytest.mark.parametrize("command", ["integrate", "order"])
def test_without_matplotlib_the_extra_is_named_before_the_work(command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cli_problem, "find_spec", lambda name: None)
    refused(liehom(command, RIGID, "--plot", "picture.png"), "pip install matplotlib")
    assert written() == []


# -- interruption ----------------------------------------------------------------------------------------
def interrupted_after(steps: int, monkeypatch: pytest.MonkeyPatch, *words: str) -> Result:
    plain, count = Run.advance, [0]

    def advance(self: Run, *rest: Any, **more: Any) -> None:
        count[0] += 1
        if count[0] > steps:
            raise KeyboardInterrupt
        plain(self, *rest, **more)

    with monkeypatch.context() as patch:
        patch.setattr(Run, "advance", advance)
        return liehom(*words)


def test_an_interrupted_run_continues_from_its_checkpoint(monkeypatch: pytest.MonkeyPatch) -> None:
    words = ("integrate", RIGID, "--base", "euler", "--order", "3", "--out", "one.npz", "--checkpoint", "state.npz")
    result = interrupted_after(40, monkeypatch, *words)
    assert (result.exit_code, result.stdout) == (130, "")
    assert re.fullmatch(
        r"liehom: interrupted at \d+% of the time span; the state is in state.npz: "
        r"the same command continues from it\n",
        result.stderr,
    )
    assert written() == ["state.npz"]
    assert liehom(*words).exit_code == 0
    assert written() == ["one.npz"]
    assert liehom(*words[:-4], "--out", "whole.npz").exit_code == 0
    with np.load("one.npz") as one, np.load("whole.npz") as other:
        assert np.array_equal(one["t"], other["t"])
        assert np.array_equal(one["y"], other["y"])


def test_an_interrupted_run_without_checkpoint_leaves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    result = interrupted_after(5, monkeypatch, "integrate", RIGID)
    assert (result.exit_code, result.stdout) == (130, "")
    assert re.match(r"liehom: interrupted at \d+% of the time span; nothing is stored", result.stderr)
    assert "--checkpoint" in result.stderr
    assert result.stderr.count("\n") == 1
    assert written() == []


def test_a_checkpoint_of_something_else_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    interrupted_after(5, monkeypatch, "integrate", RIGID, "--checkpoint", "state.npz")
    refused(liehom("integrate", RIGID, "--order", "4", "--checkpoint", "state.npz"), "another problem")
    Path("state.npz").write_text("none")
    refused(liehom("integrate", RIGID, "--checkpoint", "state.npz"), "not a checkpoint")
    assert written() == ["state.npz"]


# -- bad input -------------------------------------------------------------------------------------------
def test_a_point_that_the_group_fixes_stays_and_has_no_order_to_measure() -> None:
    fixed = variant(point=[0, 0, 0])
    assert liehom("integrate", fixed).exit_code == 0
    refused(liehom("order", fixed), "orbit")


@pytest.mark.parametrize("command", ["integrate", "order"])
@pytest.mark.parametrize(
    ("keys", "named"),
    [
        ({"generator": None}, "'generator' nor 'vector_field'"),
        ({"point": None}, "'point'"),
        ({"t_span": None}, "--t-span"),
        ({"generator": ["1/m1", "0", "0"]}, "generator[0] is inf"),
        ({"generator": ["0", "log(m1 - 1)", "0"]}, "generator[1] is nan"),
        ({"generator": ["1", "1", "10**400"]}, "generator[2]"),
        ({"generator": ["1", "1", "1/0"]}, "division by zero"),
        ({"generator": ["1", "1"]}, "generator has 2"),
        ({"generator": None, "vector_field": ["m0", "m1", "m2"]}, "not tangent"),
        ({"generator": None, "vector_field": ["m0", "m1"]}, "vector_field has 2"),
        ({"order": 0}, "order"),
        ({"base": "eulr"}, "did you mean 'euler'"),
        ({"exponential": "log"}, "unknown exponential"),
        ({"clock": "wall"}, "clock"),
    ],
)
def test_malformed_problems_exit_with_2(command: str, keys: dict[str, Any], named: str) -> None:
    refused(liehom(command, variant(**keys)), named)
    assert written() == ["variant.json"]


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("--dt", "0"), "dt"), (("--dt", "-0.1"), "dt"), (("--dt", "nan"), "dt"), (("--dt", "inf"), "dt"),
        (("--dt", "1e999"), "dt"), (("--dt", "x"), "dt"), (("--dt", "__import__('os')"), "dt"),
        (("--rtol", "0"), "rtol"), (("--rtol", "nan"), "rtol"), (("--atol", "-1"), "atol"),
        (("--dt", "0.1", "--rtol", "1e-3"), "--dt fixes"), (("--order", "0"), "order"), (("--order", "-3"), "order"),
        (("--order", "1000"), "order"), (("--t-span", "0", "nan"), "t_span"), (("--t-span", "0", "1e999"), "t_span"),
        (("--t-span", "", "1"), "t_span"), (("--base", ""), "base"), (("--base", "no such base"), "known:"),
        (("--clock", "\n"), "clock"), (("--exponential", "cayleigh"), "cayley"),
    ],
)  # fmt: skip
def test_invalid_options_exit_with_2(words: tuple[str, ...], named: str) -> None:
    refused(liehom("integrate", RIGID, *words), named)
    assert written() == []


@pytest.mark.parametrize(
    "file", ["none.json", "examples/none.json", "examples/../secret.json", "", ".", "examples/so4_so3.json"]
)
def test_files_without_a_problem_exit_with_2(file: str) -> None:
    refused(liehom("integrate", "--", file))
    assert written() == []


def test_a_file_here_comes_before_that_of_the_package() -> None:
    Path("examples").mkdir()
    Path(RIGID).write_text("{}")
    refused(liehom("integrate", RIGID), "pair file")


# -- the drift of invariants -----------------------------------------------------------------------------
def test_the_drift_sees_what_is_not_conserved() -> None:
    rho = lh.sym_conjugation(3)
    start = np.array([1.0, 0, 0, 2.0, 0, 3.0])
    for moved, seen in (([1.1, 0, 0, 2.0, 0, 3.0], True), ([3.0, 0, 0, 1.0, 0, 2.0], False)):
        drift = invariant_drift(rho, np.array([start, moved]).T)
        assert drift[0] == 0
        assert (drift[1] > 1e-3) == seen


def test_the_drift_of_a_representation_in_floats() -> None:
    rotation = lh.Representation.from_matrices([[[0, -1.0], [1.0, 0]]], field=lh.RR)
    assert invariant_drift(rotation, np.array([[1.0, 0.0], [0.0, 1.0]])).tolist() == [0, 0]
    shear = lh.Representation.from_matrices([[[0, 1.0], [0, 0]]], field=lh.RR)
    assert invariant_drift(shear, np.array([[1.0, 0.0], [0.0, 1.0]])) is None
