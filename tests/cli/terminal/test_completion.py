"""Completion in real shells: commands, options, names with parentheses, files; without the layers of mathematics."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

import liehom as lh
from liehom.cli.app import app
from liehom.cli.terminal import completion
from liehom.homogeneous import exponential_of
from liehom.integrators import step_named
from liehom.paper import NAMES

ROOT = Path(__file__).resolve().parents[3]


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
    """What bash puts in the place of the last word."""
    script = """
        eval "$(liehom completion bash)"
        COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
        compopt() { :; }
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
@pytest.mark.parametrize(
    ("typed", "found"),
    [
        (["liehom", "fullness", "so\\(12"], ["so\\(12\\)/so\\(11\\)"]),
        (["liehom", "fullness", '"so(12'], ["so(12)/so(11)"]),
    ],
)
def test_bash_completes_names_with_parentheses(
    typed: list[str], found: list[str], shell_environment: dict[str, str], folder: Path
) -> None:
    assert completed(typed, shell_environment, folder) == found


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
        (["liehom", "completion", ""], ["bash", "zsh", "fish"]),
    ],
)
def test_words_are_completed(typed: list[str], found: list[str], folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    completion.enable()
    asked = {"COMP_WORDS": "\n".join(typed), "COMP_CWORD": str(len(typed) - 1), "_LIEHOM_COMPLETE": "complete_bash"}
    result = CliRunner().invoke(app, [], env=asked)
    assert result.exit_code == 0
    assert result.stdout.split() == found


@pytest.mark.parametrize("shell", completion.SHELLS)
def test_scripts_have_the_syntax_of_their_shell(shell: str) -> None:
    result = CliRunner().invoke(app, ["completion", shell])
    assert (result.exit_code, result.stderr) == (0, "")
    assert "_LIEHOM_COMPLETE" in result.stdout
    if shutil.which(shell) is None:
        pytest.skip(f"{shell} is not installed")
    subprocess.run([shell, "-n"], input=result.stdout, text=True, check=True, timeout=60)


def test_an_unknown_shell_is_an_error() -> None:
    result = CliRunner().invoke(app, ["completion", "tcsh"])
    assert (result.exit_code, result.stdout) == (2, "")
    assert "bash, zsh, fish" in result.stderr


def test_completion_is_quick_and_imports_no_mathematics(shell_environment: dict[str, str]) -> None:
    words = {"COMP_WORDS": "liehom\nfullness\nso", "COMP_CWORD": "2"}
    asked = {**shell_environment, "_LIEHOM_COMPLETE": "complete_bash", **words}
    code = (
        "import sys, time, contextlib\n"
        "from liehom.cli import main\n"
        "with contextlib.suppress(SystemExit):\n    main()\n"
        "heavy = {name.partition('.')[0] for name in sys.modules} & {'flint', 'scipy', 'sympy', 'matplotlib', 'rich'}\n"
        "print(sorted(heavy), time.process_time(), file=sys.stderr)\n"
    )
    best = float("inf")
    for _ in range(2):
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
