"""``liehom reproduce``: what it prints and writes, what it refuses, and what an interruption leaves."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from liehom.cli.app import app
from liehom.studies.paper import figures
from liehom.studies.paper.figures import NAMES
from liehom.studies.paper.reproduction import Check, Reproduction, stored
from tests.studies.paper.small import small

ROOT = Path(__file__).resolve().parent.parent.parent


def liehom_(*words: str) -> Result:
    return CliRunner().invoke(app, list(words))


def test_reproduce_all_writes_every_table(tmp_path: Path) -> None:
    result = liehom_("reproduce", "all", "--quick", "--format", "none", "--out", str(tmp_path / "new" / "folder"))
    assert result.exit_code == 0, result.stdout
    assert result.stderr == ""
    assert "FAILS" not in result.stdout
    files = {path.name for path in (tmp_path / "new" / "folder").iterdir()}
    assert {f"{name}.{end}" for name in NAMES for end in ("md", "tex", "csv", "json")} <= files
    assert {name.rpartition(".")[2] for name in files} == {"md", "tex", "csv", "json"}


def test_reproduce_writes_nothing_unasked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = liehom_("reproduce", "fig4", "--quick")
    assert (result.exit_code, result.stderr) == (0, "")
    assert "the formula as printed has energy order 4 (found: 3.00" in result.stdout
    assert "rk2_io" in result.stdout and "slope in the paper" in result.stdout
    assert result.stdout.endswith("no files are written: --out DIR writes tables and plots\n")
    for words in (("--resume",), ("--dark",), ("--format", "svg")):
        refused = liehom_("reproduce", "fig4", "--quick", *words)
        assert (refused.exit_code, refused.stdout) == (2, "")
        assert "--out DIR" in refused.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("--out", "new", "--format", "bmp"), "png,svg,pdf"),
        (("--out", "new", "--format", ""), "png,svg,pdf"),
        (("--out", "file"), "not a writable folder"),
        (("--out", "file/new"), "not a writable folder"),
        (("--out", ""), "not a writable folder"),
    ],
)
def test_reproduce_refuses_before_the_work(
    words: tuple[str, ...], named: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("file").write_text("mine")
    monkeypatch.setattr(figures, "reproduce", lambda *args, **options: pytest.fail("it works already"))
    result = liehom_("reproduce", "fig4", "--quick", *words)
    assert (result.exit_code, result.stdout) == (2, "")
    assert named in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_reproduce_without_matplotlib_writes_the_tables(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("liehom.cli.inputs.can_plot", lambda: False)
    result = liehom_("reproduce", "fig3", "--quick", "--out", str(tmp_path))
    assert (result.exit_code, result.stdout.splitlines()[-1]) == (0, f"5 files in {tmp_path}; no plots")
    asked = liehom_("reproduce", "fig3", "--quick", "--out", str(tmp_path), "--format", "svg")
    assert asked.exit_code == 2 and "pip install matplotlib" in asked.stderr


def test_resume_computes_only_what_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    computed: list[str] = []

    def counted(name: str, **settings: Any) -> Reproduction:
        computed.append(name)
        return small(name, **settings)

    monkeypatch.setattr(figures, "reproduce", counted)
    words = ("reproduce", "all", "--quick", "--format", "none", "--out", str(tmp_path))
    first = liehom_(*words)
    assert computed == list(NAMES)
    (tmp_path / "fig4.csv").unlink()
    again = liehom_(*words, "--resume")
    assert computed == [*NAMES, "fig4"]
    assert (again.exit_code, again.stdout) == (0, first.stdout)
    other = liehom_(*words, "--resume", "--seed", "5", "--json")
    assert computed == [*NAMES, "fig4", *NAMES]
    assert json.loads(liehom_(*words, "--resume", "--seed", "5", "--json").stdout) == json.loads(other.stdout)
    assert computed == [*NAMES, "fig4", *NAMES]


@pytest.mark.skipif(os.name != "posix", reason="another system sends no SIGINT to a process")
def test_an_interrupted_reproduction_leaves_complete_figures_and_says_which(tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = [sys.executable, "-m", "liehom", "reproduce", "all", "--quick", "--format", "none", "--out", str(out)]
    with subprocess.Popen(words, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        end = monotonic() + 60
        while not (out / "fig1.json").exists() and monotonic() < end:
            sleep(0.02)
        process.send_signal(signal.SIGINT)
        stdout, stderr = process.communicate(timeout=60)
    assert (process.returncode, stdout) == (130, "")
    finished = sorted(path.stem for path in out.glob("*.json"))
    assert "fig1" in finished and len(finished) < len(NAMES)
    told = (
        f"liehom: interrupted; finished in {out}: {', '.join(finished)}; the same command with --resume does the others"
    )
    assert stderr == told + "\n"
    listed = [json.loads((out / f"{name}.json").read_text())["files"].keys() | {f"{name}.json"} for name in finished]
    assert {path.name for path in out.iterdir()} == set().union(*listed)
    assert all(stored(out, name, {"quick": True, "seed": None}, ()) for name in finished)


def test_an_interruption_before_the_first_figure_leaves_no_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*args: object, **options: object) -> Reproduction:
        raise KeyboardInterrupt

    monkeypatch.setattr(figures, "reproduce", interrupted)
    result = liehom_("reproduce", "all", "--out", str(tmp_path / "new"))
    assert (result.exit_code, result.stdout) == (130, "")
    assert result.stderr == "liehom: interrupted; no figure is finished\n"
    assert list(tmp_path.iterdir()) == []


def test_each_figure_is_a_step_of_the_progress_shown_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    begun: list[str] = []
    monkeypatch.setattr("liehom.cli.reproduce.step", begun.append)
    monkeypatch.setattr(figures, "reproduce", small)
    assert liehom_("reproduce", "all", "--quick").stderr == ""
    assert begun == [f"{name}, {k} of 8" for k, name in enumerate(NAMES, 1)]


def test_reproduce_prints_one_object(tmp_path: Path) -> None:
    result = liehom_("reproduce", "fig2", "--quick", "--seed", "5", "--out", str(tmp_path), "--json")
    data = json.loads(result.stdout)
    assert data["holds"] is True
    assert data["figures"][0]["name"] == "fig2"
    assert len(data["figures"][0]["tables"]["table"]["rows"]) == 6
    assert all(Path(file).is_file() for file in data["figures"][0]["files"])


def test_reproduce_lists_the_known_names(tmp_path: Path) -> None:
    result = liehom_("reproduce", "fig8", "--out", str(tmp_path))
    assert result.exit_code == 2
    assert result.stdout == ""
    assert "separatrix, all" in result.stderr


def test_reproduce_exits_with_1_where_a_claim_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = Reproduction("fig2", "X", "none", {}, (Check("1 = 2", "1", False),))
    monkeypatch.setattr(figures, "reproduce", lambda *args, **options: wrong)
    result = liehom_("reproduce", "fig2", "--out", str(tmp_path))
    assert result.exit_code == 1
    assert "FAILS" in result.stdout
