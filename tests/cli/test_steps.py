"""Long commands show their step on a terminal after a second, and nothing in a pipe; Ctrl-C says what is finished."""

import io
import sys
import time

import pytest
from typer.testing import CliRunner, Result

import liehom as lh
from liehom.cli import guard as steps
from liehom.cli.app import app
from liehom.cli.guard import INTERRUPTED, Steps, guarded, rename_step, step


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def terminal_of(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    """A terminal as standard error; no fixture, since pytest sets the streams again before the test itself."""
    made = Terminal()
    monkeypatch.setattr(sys, "stderr", made)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(steps, "DELAY", 0.01)
    return made


def wait_for(text: str, shown: Terminal) -> None:
    end = time.monotonic() + 30
    while text not in shown.getvalue():
        assert time.monotonic() < end, shown.getvalue()
        time.sleep(0.01)


def test_a_long_step_is_shown_on_a_terminal_and_erased_before_the_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = terminal_of(monkeypatch)
    with Steps():
        step("invariant forms")
        wait_for("invariant forms", terminal)
        step("commutant")
        wait_for("commutant", terminal)
        rename_step("commutant, 50%")
        wait_for("commutant, 50%", terminal)
        step("")
        before = terminal.getvalue()
        assert before.endswith("\x1b[2K"), "the line is erased"
        time.sleep(0.15)
        assert terminal.getvalue() == before


def test_a_short_command_shows_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = terminal_of(monkeypatch)
    monkeypatch.setattr(steps, "DELAY", 60.0)
    with Steps() as running:
        step("invariant forms")
        step("commutant")
    assert [name for name, _ in running.finished] == ["invariant forms"]
    assert terminal.getvalue() == ""


def test_nothing_is_shown_in_a_pipe(monkeypatch: pytest.MonkeyPatch) -> None:
    piped = io.StringIO()
    monkeypatch.setattr(sys, "stderr", piped)
    monkeypatch.setattr(steps, "DELAY", 0.0)
    with Steps():
        step("invariant forms")
        time.sleep(0.1)
    assert piped.getvalue() == ""


def test_steps_outside_a_command_do_nothing() -> None:
    step("invariant forms")
    rename_step("commutant")


def test_an_interrupted_command_says_what_is_finished(capsys: pytest.CaptureFixture[str]) -> None:
    def action() -> int:
        with Steps() as running:
            step("construction of the pair")
            step("rank at sample points")
            running.finished[0] = ("construction of the pair", 14.2)
            step("invariant forms")
            raise KeyboardInterrupt

    assert guarded(action) == INTERRUPTED
    said = capsys.readouterr().err
    assert said.startswith("liehom: interrupted in the step: invariant forms (0 s); finished: construction of the pair")
    assert "(14 s)" in said
    assert "rank at sample points" not in said, "a step of no time is not worth a word"
    assert "begins again" in said
    assert said.count("\n") == 1


def interrupted(words: list[str], where: str, monkeypatch: pytest.MonkeyPatch) -> Result:
    def stop(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(where, stop)
        return CliRunner().invoke(app, words)


@pytest.mark.parametrize(
    ("words", "where", "named"),
    [
        (["fullness", "so(3)/so(2)"], "liehom.exact.fullness.decide._sample", "in the step: rank at sample points"),
        (["classify", "so(3)/so(2)"], "liehom.exact.fullness.decide._sample", "in the step: rank at sample points"),
        (["describe", "so(3)"], "liehom.algebra.LieAlgebra.describe", "in the step: structure of the object"),
        (["atlas", "families"], "liehom.studies.atlas.all_families.recipes", "in the step: pairs of the family"),
    ],
)
def test_commands_name_their_steps(words: list[str], where: str, named: str, monkeypatch: pytest.MonkeyPatch) -> None:
    result = interrupted(words, where, monkeypatch)
    assert (result.exit_code, result.stdout) == (INTERRUPTED, "")
    assert named in result.stderr
    assert result.stderr.count("\n") == 1


@pytest.mark.parametrize(("store", "named"), [([], "--store DIR"), (["--store", "parts"], "in parts")])
def test_an_interrupted_atlas_says_where_its_pairs_are(
    store: list[str], named: str, monkeypatch: pytest.MonkeyPatch, tmp_path: object
) -> None:
    monkeypatch.chdir(str(tmp_path))

    def stop(entry: object, /) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(lh.atlas.Entry, "to_json", stop)
    result = CliRunner().invoke(app, ["atlas", "build", "atlas.jsonl", "--family", "parabolic", *store])
    assert (result.exit_code, result.stdout) == (INTERRUPTED, "")
    assert named in result.stderr
    assert "atlas.jsonl is not written" in result.stderr
