"""Completion in real shells: commands, options, names with parentheses, files; without the layers of mathematics."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

import liehom as lh
from liehom.cli import completion
from liehom.cli.app import app
from liehom.flow.action.custom_exponential import exponential_of
from liehom.flow.methods.named import step_named
from liehom.studies.paper.figures import NAMES

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def shell_environment(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """An environment in which `liehom` is this tree, whether it is installed or not."""
    folder = tmp_path_factory.mktemp("bin")
    program = folder / "liehom"
    program.write_text(f"#!{sys.executable}\nimport sys\nsys.path.insert(0, {str(ROOT)!r})\nsys.argv[0] = 'liehom'\n"
                       "from liehom.cli import main\nmain()\n")  # fmt: skip
    program.chmod(0o755)
    return {**os.environ, "PATH": f"{folder}{os.pathsep}{os.environ['PATH']}"}


def completed(typed: list[str], environment: dict[str, str], folder: Path) -> list[str]:
    script = """
        eval "$(_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION=1 liehom --show-completion bash)"
        COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
        _liehom_completion liehom
        printf '%s\\n' "${COMPREPLY[@]}"
    """
    done = subprocess.run(
        ["bash", "-c", script, "bash", *typed],
        cwd=folder, env=environment, capture_output=True, text=True, check=True, timeout=60,
    )  # fmt: skip
    assert done.stderr == ""
    return done.stdout.split("\n")[:-1]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "mine.json").touch()
    (tmp_path / "mine.txt").touch()
    (tmp_path / "mine").mkdir()
    return tmp_path


@pytest.mark.skipif(shutil.which("bash") is None, reason="bash is not installed")
def test_bash_completes_names_in_quotes(shell_environment: dict[str, str], folder: Path) -> None:
    assert completed(["liehom", "fullness", '"so(12'], shell_environment, folder) == ["so(12)/so(11)"]


@pytest.mark.parametrize(
    ("typed", "found"),
    [
        (["liehom", "full"], ["fullness", "full-pairs"]),
        (["liehom", "atlas", "b"], ["build"]),
        (["liehom", "integrate", "x.json", "--eng"], ["--engine"]),
        (["liehom", "integrate", "x.json", "--engine", "l"], ["llvm"]),
        (["liehom", "fullness", "'so(12"], ["so(12)/so(11)"]),
        (["liehom", "fullness", "mi"], ["mine/", "mine.json"]),
        (["liehom", "integrate", "examples/rig"], ["examples/rigid_body.json"]),
        (["liehom", "describe", "e8"], ["e8(-24)"]),
    ],
)
def test_words_are_completed(typed: list[str], found: list[str], folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    asked = {"COMP_WORDS": "\n".join(typed), "COMP_CWORD": str(len(typed) - 1), "_LIEHOM_COMPLETE": "complete_bash"}
    result = CliRunner().invoke(app, [], env=asked)
    assert result.exit_code == 0
    assert result.stdout.split() == found


def test_names_are_completed_in_any_letters_and_keep_them() -> None:
    assert completion.pair("SO(12)") == ["SO(12)/so(11)"]
    assert (
        "SU(2,1)" in completion.anything("SU(2")
        and "E8" in completion.anything("E")
        and "e8" not in completion.anything("e")
    )
    for word in completion.pair("SP("):
        lh.pair(word)


def test_completion_is_quick_and_imports_no_mathematics(shell_environment: dict[str, str]) -> None:
    words = {"COMP_WORDS": "liehom\nfullness\nso", "COMP_CWORD": "2"}
    asked = {**shell_environment, "_LIEHOM_COMPLETE": "complete_bash", **words}
    code = (
        "import sys, time, contextlib\nsys.argv = ['liehom']\n"
        "from liehom.cli import main\n"
        "with contextlib.suppress(SystemExit):\n    main()\n"
        "heavy = {name.partition('.')[0] for name in sys.modules} & {'flint', 'scipy', 'sympy', 'matplotlib', 'rich'}\n"
        "print(sorted(heavy), time.process_time(), file=sys.stderr)\n"
    )
    best = float("inf")
    for _ in range(6):
        done = subprocess.run(
            [sys.executable, "-c", code], cwd=ROOT, env=asked, capture_output=True, text=True, check=True, timeout=60
        )
        assert "so(4)/so(3)" in done.stdout.splitlines()
        heavy, seconds = done.stderr.rsplit(maxsplit=1)
        assert heavy == "[]"
        best = min(best, float(seconds))
    assert best < 0.3


def test_the_words_are_those_of_the_library() -> None:
    assert completion.pair_names() == list(lh.catalog.pair_names())
    assert set(completion.FIGURES) == {*NAMES, "all"}
    for name in completion.BASES:
        assert step_named(name) is not None
    for name in completion.EXPONENTIALS:
        assert exponential_of(lh.defining(lh.so(3)), name) is not None
