"""``-`` is the file on standard input, for every command that reads one."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

import liehom as lh
from liehom.base.errors import FormatError
from liehom.cli import inputs
from liehom.cli.app import app
from liehom.cli.inputs import path_argument

PAIR = path_argument("examples/so4_so3.json")
RIGID = path_argument("examples/rigid_body.json")


def liehom(*words: str, text: str | bytes = "") -> Result:
    return CliRunner().invoke(app, list(words), input=text)


@pytest.mark.parametrize(
    ("words", "file"),
    [
        (("fullness", "{}"), PAIR),
        (("range", "{}", "--json"), PAIR),
        (("classify", "{}"), PAIR),
        (("describe", "{}", "--json"), PAIR),
        (("isotropy", "{}"), path_argument("examples/sym3.json")),
        (("integrate", "{}", "--t-span", "0", "1"), RIGID),
        (("order", "{}", "--base", "euler", "--t-span", "0", "1", "--dt", "0.1,0.05", "--json"), RIGID),
    ],
)
def test_standard_input_gives_what_the_file_gives(words: tuple[str, ...], file: str) -> None:
    named = liehom(*(word.replace("{}", file) for word in words))
    piped = liehom(*(word.replace("{}", "-") for word in words), text=Path(file).read_bytes())
    assert (piped.exit_code, piped.stderr) == (named.exit_code, "")
    assert piped.exit_code in (0, 1), piped.output
    assert piped.stdout == named.stdout.replace(file, "standard input")


def test_a_certificate_or_its_pair_may_be_piped_but_not_both() -> None:
    certificate = json.dumps(lh.io.to_json(lh.decide_fullness(lh.pair("so(4)/so(3)")).certificate))
    assert liehom("verify", "so(4)/so(3)", "-", text=certificate).exit_code == 0
    both = liehom("verify", "-", "-", text=certificate)
    assert (both.exit_code, both.stdout) == (2, "")
    assert "twice" in both.stderr


def test_entries_of_the_atlas_may_be_piped(tmp_path: Path) -> None:
    file = tmp_path / "atlas.jsonl"
    lh.atlas.write_entries(file, iter([next(lh.atlas.build(["parabolic"]))]))
    assert liehom("atlas", "show", "-", text=file.read_bytes()).stdout == liehom("atlas", "show", str(file)).stdout


@pytest.mark.parametrize("text", ["", "  \n"])
def test_empty_standard_input_is_an_error(text: str) -> None:
    result = liehom("fullness", "-", text=text)
    assert (result.exit_code, result.stdout) == (2, "")
    assert "standard input, which is empty" in result.stderr


def test_a_terminal_is_not_read(monkeypatch: pytest.MonkeyPatch) -> None:
    class Terminal:
        def isatty(self) -> bool:
            return True

    monkeypatch.setattr(inputs.sys, "stdin", Terminal())
    with pytest.raises(lh.InputError, match="terminal"):
        inputs.standard_input()
    monkeypatch.setattr(inputs.sys, "stdin", None)
    with pytest.raises(lh.InputError, match="closed"):
        inputs.standard_input()


def test_malformed_standard_input_is_named() -> None:
    for text, named in ((b"\xff\xfe", "standard input is not text in UTF-8"), (b"{", "not JSON")):
        result = liehom("fullness", "-", text=text)
        assert (result.exit_code, result.stdout) == (2, "")
        assert named in result.stderr
    limited = liehom("fullness", "-", "--limit", "file_bytes=100", text=Path(PAIR).read_bytes())
    assert limited.exit_code == 2
    assert "--limit file_bytes" in limited.stderr


def test_the_library_reads_files_that_are_open() -> None:
    with open(PAIR, "rb") as file:
        assert lh.load(file) == lh.load(PAIR)
    with open(RIGID, "rb") as file:
        assert lh.io.load_problem(file).options == lh.io.load_problem(RIGID).options
    with open(PAIR, encoding="utf-8") as file, pytest.raises(FormatError, match="binary"):
        lh.load(file)  # type: ignore[arg-type]
    with pytest.raises(FormatError, match="expected the path of a file"):
        lh.load(3)  # type: ignore[arg-type]
