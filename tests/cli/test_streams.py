"""The command line with closed and full streams, and its limits: conventional exit codes and messages."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

import liehom as lh
from liehom.cli.app import app

ROOT = Path(__file__).resolve().parent.parent.parent
PAIR = "'so(3)/so(2)'"
WRONG = "'so(3)/so(99)'"


def shell(command: str) -> tuple[int, str, str]:
    """Exit code of the first command of a pipe, standard output and standard error."""
    script = command.replace("liehom ", f"{sys.executable} -m liehom ", 1) + "; exit ${PIPESTATUS[0]}"
    done = subprocess.run(["bash", "-c", script], cwd=ROOT, capture_output=True, text=True, timeout=60, check=False)
    return done.returncode, done.stdout, done.stderr


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="this system has no device that is full")
@pytest.mark.parametrize("command", [f"liehom fullness {PAIR}", "liehom --help"])
@pytest.mark.parametrize(("end", "reason"), [(">&-", "Bad file descriptor"), (">/dev/full", "No space left")])
def test_output_that_cannot_be_written(command: str, end: str, reason: str) -> None:
    code, out, err = shell(f"{command} {end}")
    assert (code, out) == (74, "")
    assert err.startswith("liehom: error: standard output cannot be written: ")
    assert reason in err
    assert err.count("\n") == 1


@pytest.mark.parametrize("command", ["--help", "--version", f"catalog {PAIR}"])
def test_a_reader_that_leaves_is_not_an_error(command: str) -> None:
    code, _, err = shell(f"liehom {command} | (exec <&-; sleep 0.01)")
    assert (code, err) in ((141, ""), (0, ""))
    code, _, err = shell(f"(sleep 0.2; exec liehom {command}) | true")
    assert (code, err) == (141, "")


@pytest.mark.parametrize(("end", "code"), [("2>&-", 2), ("2>/dev/full", 2), (">&- 2>&- <&-", 2)])
def test_messages_to_a_closed_standard_error_are_lost(end: str, code: int) -> None:
    assert shell(f"liehom fullness {WRONG} {end}") == (code, "", "")


def test_limits_stand_before_and_after_a_command() -> None:
    for words in (
        ["--limit", "dimension=2", "fullness", "so(3)/so(2)"],
        ["fullness", "so(3)/so(2)", "--limit=dimension=2"],
    ):
        result = CliRunner().invoke(app, words)
        assert (result.exit_code, result.stdout) == (2, "")
        assert "--limit dimension=3" in result.stderr
    assert lh.budget.current_limits() == lh.budget.Limits()  # those of the process are as before
    assert CliRunner().invoke(app, ["fullness", "so(3)/so(2)", "--limit", "dimension=3"]).exit_code == 0
    for wrong in ("dim=2", "digits", "digits=x", "digits=-1"):
        result = CliRunner().invoke(app, ["fullness", "so(3)/so(2)", "--limit", wrong])
        assert (result.exit_code, result.stdout) == (2, "")
        assert "limit" in result.stderr


def test_a_deadline_on_the_command_line() -> None:
    result = CliRunner().invoke(app, ["fullness", "so(6)/so(5)", "--limit", "seconds=0.0"])
    assert result.exit_code == 2
    assert "seconds" in result.stderr


@pytest.mark.parametrize(
    "name", ["so(" + "9" * 5000 + ")/so(3)", "affine(" * 300, "/dev/full", "so(3000)/so(2999)", "R^" + "1" * 10_000]
)
def test_names_that_are_too_large(name: str) -> None:
    if name.startswith("/dev") and not os.path.exists(name):
        pytest.skip("this system has no such file")
    for command in ("fullness", "describe", "range"):
        result = CliRunner().invoke(app, [command, name, "--limit=file_bytes=1000"])
        assert (result.exit_code, result.stdout) == (2, ""), result.stderr
        assert result.stderr.startswith("liehom: error: ")
        assert "--limit" in result.stderr or "catalogue" in result.stderr
