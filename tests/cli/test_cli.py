"""The command line: exit codes, what goes to which stream, one JSON object with --json, time from the shell."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

import liehom as lh
from liehom.base.errors import CertificateError, FormatError, InternalError
from liehom.cli import guard
from liehom.cli.app import app

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
FULL, NOT_FULL, FLOAT = (str(EXAMPLES / f"{name}.json") for name in ("so4_so3", "so31_so21", "so4_so3_float"))
SYM3 = str(EXAMPLES / "sym3.json")
COMMANDS = (
    "fullness", "verify", "isotropy", "range", "geometry", "classify", "full-pairs", "describe", "integrate", "order",
    "reproduce", "catalog", "demo", "atlas",
)  # fmt: skip


def liehom(*words: str) -> Result:
    return CliRunner().invoke(app, list(words))


def shell(*words: str, **options: Any) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "liehom", *words]
    return subprocess.run(
        command, cwd=ROOT, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False, **options
    )


def json_of(result: Result) -> dict[str, Any]:
    data = json.loads(result.stdout)
    assert isinstance(data, dict)
    assert result.stderr == ""
    return data


# -- fullness --------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("file", "code", "says"), [(FULL, 0, "full: S^3 = SO(4)"), (NOT_FULL, 1, "not full: "), (FLOAT, 3, "numerical")]
)
def test_fullness_says_why_and_exits_with_the_verdict(file: str, code: int, says: str) -> None:
    result = liehom("fullness", file)
    assert result.exit_code == code
    assert says in result.stdout
    assert result.stderr == ""


def test_fullness_takes_a_name_of_the_catalogue() -> None:
    result = liehom("fullness", "so(4)/so(3)")
    assert result.exit_code == 0
    assert "so(3)" in result.stdout


def test_fullness_takes_a_representation_file() -> None:
    assert liehom("fullness", SYM3).exit_code == 0


@pytest.mark.parametrize(("file", "code", "full"), [(FULL, 0, True), (NOT_FULL, 1, False), (FLOAT, 3, True)])
def test_fullness_json(file: str, code: int, full: bool) -> None:
    result = liehom("fullness", file, "--json")
    assert result.exit_code == code
    data = json_of(result)
    assert data["full"] is full
    assert (data["certificate"] is None) == (code == 3)
    assert data["reason"]
    assert data["pair"]["dimension"] == 6


def test_fullness_writes_a_certificate_that_verifies(tmp_path: Path) -> None:
    out = tmp_path / "certificate.json"
    assert liehom("fullness", NOT_FULL, "--certificate", str(out)).exit_code == 1
    assert lh.verify_certificate(lh.load(NOT_FULL), json.loads(out.read_text()))
    assert liehom("verify", NOT_FULL, str(out)).exit_code == 0


def test_a_numerical_answer_has_no_certificate_to_write(tmp_path: Path) -> None:
    result = liehom("fullness", FLOAT, "--certificate", str(tmp_path / "c.json"))
    assert (result.exit_code, result.stdout) == (2, "")
    assert list(tmp_path.iterdir()) == []


# -- verify ----------------------------------------------------------------------------------------------
@pytest.fixture
def certificate(tmp_path: Path) -> Path:
    out = tmp_path / "certificate.json"
    assert liehom("fullness", NOT_FULL, "--certificate", str(out)).exit_code == 1
    return out


def test_verify_refuses_the_certificate_of_another_pair(certificate: Path) -> None:
    result = liehom("verify", FULL, str(certificate))
    assert (result.exit_code, result.stdout) == (1, "")
    assert "certificate fails" in result.stderr


def test_verify_json(certificate: Path) -> None:
    good, bad = (
        liehom("verify", NOT_FULL, str(certificate), "--json"),
        liehom("verify", FULL, str(certificate), "--json"),
    )
    assert (good.exit_code, bad.exit_code) == (0, 1)
    assert json_of(good)["verified"] is True
    assert json_of(bad)["verified"] is False
    assert json_of(bad)["failure"]["check"]


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"kind": "full"}', '{"format": "liehom-certificate", "version": 1}'])
def test_verify_malformed_files_are_bad_input(text: str, tmp_path: Path) -> None:
    file = tmp_path / "bad.json"
    file.write_text(text)
    for extra in ([], ["--json"]):
        result = liehom("verify", FULL, str(file), *extra)
        assert (result.exit_code, result.stdout) == (2, "")


# -- isotropy, range, catalog ----------------------------------------------------------------------------
def test_isotropy() -> None:
    result = liehom("isotropy", SYM3)
    assert result.exit_code == 0
    assert "dimension 1, the orbit 2" in result.stdout


@pytest.mark.parametrize(
    ("point", "code", "dimension", "field"),
    [
        ("1,0,0,2,0,3", 0, 0, "QQ"),
        ("[1, 0, 0, 1, 0, 1]", 0, 3, "QQ"),
        ("-1,0,0,-1,0,sqrt(2)", 0, 1, "QQ(sqrt(2))"),
        ("[1.5, 0, 0, 1.5, 0, 1]", 3, 1, "float64"),
    ],
)
def test_isotropy_at_another_point(point: str, code: int, dimension: int, field: str) -> None:
    result = liehom("isotropy", SYM3, "--point", point, "--json")
    assert result.exit_code == code
    data = json_of(result)
    assert (data["isotropy_dimension"], data["orbit_dimension"]) == (dimension, 3 - dimension)
    assert data["field"] == field
    assert len(data["isotropy"]) == dimension


def test_isotropy_reports_appended_brackets(tmp_path: Path) -> None:
    file = tmp_path / "rep.json"
    file.write_text('{"matrices": [[[0, 1], [0, 0]], [[0, 0], [1, 0]]]}')
    assert "[0, 1]" in liehom("isotropy", str(file), "--point", "1,0").stdout
    missing = liehom("isotropy", str(file))
    assert (missing.exit_code, missing.stdout) == (2, "")
    assert "--point" in missing.stderr


@pytest.mark.parametrize(
    ("words", "holds", "rank", "equilibrium"),
    [
        ((), True, 3, False),
        (("--psi", "0,1,0,0,0,1"), False, 2, False),
        (("--psi", '[0, 0, 0, "1", 0, 0]'), True, 3, False),
    ],
)  # fmt: skip
def test_range(words: tuple[str, ...], holds: bool, rank: int, equilibrium: bool) -> None:
    result = liehom("range", NOT_FULL, *words, "--json")
    assert result.exit_code == 0
    data = json_of(result)
    assert (data["holds"], data["rank"], data["equilibrium"]) == (holds, rank, equilibrium)
    assert (data["missing"] is None) == (data["rank"] == 3)
    assert "range condition" in liehom("range", NOT_FULL, *words).stdout


def test_range_at_generic_eta_has_a_reason_and_a_certificate() -> None:
    result = json.loads(liehom("range", "so(3,1)/so(2,1)", "--json").stdout)["classification"]
    assert result["generic"] is True and result["reason"] == "class C, a real form of S^3 = SO(4)/SO(3)"
    assert (result["fails_on"], result["open_orbits"]) == ("exactly B = 0, B of signature (2, 1)", 3)
    assert lh.fullness.verify_range(lh.pair("so(3,1)/so(2,1)"), result["certificate"])
    assert "verified: True" in liehom("range", "sl(3)/so(3)").stdout
    assert "classification" not in json.loads(liehom("range", NOT_FULL, "--psi", "0,0,0,0,0,1", "--json").stdout)


def test_range_in_h_is_an_equilibrium() -> None:
    result = liehom("range", NOT_FULL, "--psi", ",".join(str(x) for x in lh.load(NOT_FULL).subalgebra.rows()[0]))
    assert result.exit_code == 0
    assert "equilibrium" in result.stdout


def test_range_of_floats_is_numerical() -> None:
    assert liehom("range", FLOAT, "--psi", "[0.5, 1, 0, 0, 1, 0]").exit_code == 3


def test_catalog_lists_names_that_parse() -> None:
    names = json_of(liehom("catalog", "--json"))["pairs"]
    assert len(names) > 10
    assert liehom("catalog").stdout.splitlines() == names
    assert isinstance(lh.pair(names[0]), lh.Pair)


def test_catalog_prints_a_pair_as_a_file(tmp_path: Path) -> None:
    file = tmp_path / "pair.json"
    file.write_text(liehom("catalog", "so(4)/so(3)").stdout)
    assert lh.load(file) == lh.pair("so(4)/so(3)")


# -- bad input and other ends ----------------------------------------------------------------------------
@pytest.mark.parametrize(
    "words",
    [
        ("fullness", "none.json"), ("fullness", "no such pair"), ("fullness", "so(4)/so(30)"),
        ("fullness", str(EXAMPLES)), ("fullness", str(EXAMPLES / "make_files.py")), ("fullness", ""),
        ("fullness", "\0"), ("fullness",), ("fullness", FULL, "--certificate", str(EXAMPLES)),
        ("fullness", FULL, "extra"), ("fullness", FULL, "--no-such-option"), ("verify", FULL, "none.json"),
        ("verify", FULL), ("isotropy", FULL), ("isotropy", SYM3, "--point", "1,2"),
        ("isotropy", SYM3, "--point", "1,2,3,4,5,os"), ("isotropy", SYM3, "--point", "[1,2"),
        ("isotropy", SYM3, "--point", ""), ("range", FULL, "--psi", "1"),
        ("range", FULL, "--psi", "1,0,0,0,0,__import__('os')"), ("range", FULL, "--psi", "[0.5,0,0,0,0,0]"),
        ("catalog", "nothing(7)"), ("no-such-command",),
    ],
)  # fmt: skip
def test_bad_input_is_exit_2_with_an_empty_standard_output(words: tuple[str, ...]) -> None:
    result = liehom(*words)
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    assert result.stderr.strip()
    assert "Traceback" not in result.stderr


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (FormatError("x"), 2),
        (CertificateError("rank", "x"), 1),
        (InternalError("x"), 70),
        (ZeroDivisionError("x"), 70),
        (RecursionError(), 70),
        (MemoryError(), 70),
        (KeyboardInterrupt(), 130),
    ],
)
def test_exit_code_of_an_exception(error: BaseException, code: int, capsys: pytest.CaptureFixture[str]) -> None:
    def action() -> int:
        raise error

    assert guard.guarded(action) == code
    streams = capsys.readouterr()
    assert streams.out == ""
    assert streams.err.startswith("liehom: ")
    assert streams.err.count("\n") == 1


def test_interrupt_is_130(tmp_path: Path) -> None:
    """A pair given through a pipe that never ends keeps the command waiting until it is interrupted."""
    pipe = tmp_path / "pipe.json"
    os.mkfifo(pipe)
    process = subprocess.Popen(
        [sys.executable, "-m", "liehom", "fullness", str(pipe)],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        with pipe.open("w"):  # opens when the command has opened it for reading
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=60)
    finally:
        process.kill()
        process.wait()
    assert process.returncode == 130
    assert out == ""
    assert "Traceback" not in err


def test_broken_pipe_is_quiet() -> None:
    command = f"{sys.executable} -m liehom catalog | true"
    run = subprocess.run(["bash", "-c", command], cwd=ROOT, capture_output=True, text=True, check=False)
    assert "Traceback" not in run.stderr
    assert "Exception" not in run.stderr


def test_plain_output_without_a_terminal() -> None:
    run = shell("fullness", FULL, env={**os.environ, "NO_COLOR": "1", "PYTHONIOENCODING": "ascii"})
    assert run.returncode == 0, run.stderr
    assert run.stdout.isascii()
    assert "\x1b" not in run.stdout


def test_help_and_version() -> None:
    listed = liehom("--help")
    assert listed.exit_code == 0
    assert all(word in listed.stdout for word in COMMANDS)
    assert liehom("--version").stdout.strip() == f"liehom {lh.__version__}"


# -- demo ------------------------------------------------------------------------------------------------
@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_demo_runs_on_the_example_files_and_ends_with_a_plot(elsewhere: Path) -> None:
    result = liehom("demo", "--plot", "errors.png")
    assert result.exit_code == 0, result.output
    for expected in ("g2_su3", "not full", "witness, verified", "QQ(sqrt(2))", "equilibrium", "diag(1, 1, 2)"):
        assert expected in result.stdout
    assert "Corrected(Euler(), order=4)" in result.stdout
    assert "order 4 NOT reached: the order stays 1" in result.stdout
    assert "Plot of these errors: errors.png" in result.stdout
    assert (elsewhere / "errors.png").read_bytes().startswith(b"\x89PNG")


def test_demo_says_before_any_work_that_no_plot_can_be_drawn(elsewhere: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert liehom("demo", "--plot", "no/such/folder/errors.png").exit_code == 2
    monkeypatch.setattr("liehom.cli.inputs.can_plot", lambda: False)
    result = liehom("demo", "--plot", "errors.png")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "pip install matplotlib" in result.stderr


def test_demo_json(elsewhere: Path) -> None:
    data = json_of(liehom("demo", "--json"))
    assert {v["file"]: v["full"] for v in data["verdicts"]}["so31_so21.json"] is False
    orders = [(run["file"], run["orbit_order"], run["trajectory_order"]) for run in data["integration"]]
    assert [file for file, *_ in orders] == ["rigid_body.json", "rigid_body.json", "sym3_generic.json"]
    assert [round(orbit) for _, orbit, _ in orders] == [1, 4, 1]
    assert all(abs(orbit - trajectory) < 0.1 for _, orbit, trajectory in orders)
    assert data["picture"] is None
    assert list(elsewhere.iterdir()) == []  # nothing without --plot


# -- time from the shell, interpreter included -----------------------------------------------------------
def seconds(*words: str) -> float:
    """Processor time, the best of three: the others measure what else the machine was doing."""
    best = float("inf")
    for _ in range(3):
        before = os.times()
        shell(*words)
        after = os.times()
        best = min(best, after.children_user + after.children_system - before.children_user - before.children_system)
    return best


@pytest.mark.parametrize("name", ["so4_so3", "g2_su3", "so5_so4_scrambled", "anisotropic", "sl3_P1"])
def test_fullness_of_a_file_takes_less_than_a_second_and_a_half(name: str) -> None:
    assert seconds("fullness", str(EXAMPLES / f"{name}.json")) < 1.5


def test_help_takes_less_than_half_a_second() -> None:
    assert seconds("--help") < 0.5


# -- floats ----------------------------------------------------------------------------------------------
def float_pair(path: Path, turn: float) -> str:
    """h acts on the plane by [[0, -turn], [1, 0]]."""
    constants = [[0, 1, 2, 1.0], [0, 2, 1, -turn]]
    data = {"dimension": 3, "arithmetic": "float64", "structure_constants": constants, "subalgebra": [[1, 0, 0]]}
    path.write_text(json.dumps(data))
    return str(path)


@pytest.mark.parametrize(("turn", "full", "says"), [
    (1.0, True, "full (numerical"), (1e-9, None, "undecided (numerical"), (0.0, False, "not full (numerical"),
])  # fmt: skip
def test_fullness_of_floats_has_three_answers(tmp_path: Path, turn: float, full: bool | None, says: str) -> None:
    file = float_pair(tmp_path / "pair.json", turn)
    shown = liehom("fullness", file)
    assert (shown.exit_code, shown.stderr) == (3, "")
    assert shown.stdout.startswith(says)
    assert all(label in shown.stdout for label in ("least singular value", "tolerance", "gap"))
    data = json_of(liehom("fullness", file, "--json"))
    assert (data["full"], data["proved"], data["certificate"]) == (full, False, None)
    assert {"smallest_singular_value", "tolerance", "gap"} <= data.keys()


def test_range_of_floats_can_be_undecided(tmp_path: Path) -> None:
    file = float_pair(tmp_path / "pair.json", -1.0)  # the condition fails at psi with psi_1 = psi_2
    for near, holds in (("0", False), ("1e-7", None), ("0.1", True)):
        words = ("range", file, "--psi", f"[0, 1, {1 + float(near)!r}]")
        result = liehom(*words)
        assert (result.exit_code, result.stderr) == (3, "")
        assert "(numerical)" in result.stdout
        assert json_of(liehom(*words, "--json"))["holds"] is holds


def test_isotropy_that_floats_do_not_decide_is_said_on_standard_error(tmp_path: Path) -> None:
    turns = [[[0, -1, 0, 0], [1, 0, 0, 0], [0] * 4, [0] * 4], [[0] * 4, [0] * 4, [0, 0, 0, -1], [0, 0, 1, 0]]]
    file = tmp_path / "representation.json"
    file.write_text(json.dumps({"matrices": turns}))
    for near, code in (("0.5", 3), ("1e-8", 3)):
        result = liehom("isotropy", str(file), "--point", f"[1.0, 0, {near}, 0]")
        assert result.exit_code == code
        assert ("(numerical)" in result.stdout) == (near == "0.5")
        assert ("undecided: the isotropy at the point" in result.stderr) == (near == "1e-8")
