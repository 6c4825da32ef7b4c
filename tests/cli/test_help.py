"""Help pages fit the terminal, say whole sentences and have examples that run; wrong arguments show a right one."""

import importlib
import os
import re
import shlex
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.core import TyperCommand
from typer.main import get_command
from typer.testing import CliRunner, Result

from liehom.cli import guard
from liehom.cli.app import TRY_FIRST, app
from liehom.cli.help import Group, examples_in

SLOW = ("plot", "show", "reproduce", "atlas build", "atlas families", "demo", "integrate", "order")
"""Commands whose examples are parsed here and not run: their own tests run them."""


def liehom(*words: str, text: str | None = None) -> Result:
    return CliRunner().invoke(app, list(words), input=text)


def commands(group: Group, prefix: str = "") -> Iterator[tuple[str, TyperCommand]]:
    for name, command in group.commands.items():
        if isinstance(command, Group):
            yield from commands(command, f"{prefix}{name} ")
        else:
            assert isinstance(command, TyperCommand), name
            yield prefix + name, command


def root() -> Group:
    group = get_command(app)
    assert isinstance(group, Group)
    return group


COMMANDS = dict(commands(root()))
EXAMPLES = [
    *(line for command in COMMANDS.values() for line in examples_in(command.epilog)),
    *examples_in(root().epilog),
]


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_an_example_of_itself(name: str) -> None:
    assert any(f"liehom {name} " in f"{line} " for line in examples_in(COMMANDS[name].epilog))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the certificate that an example checks and the entries that another searches."""
    made = tmp_path_factory.mktemp("examples")
    assert liehom("fullness", "so(3,1)/so(2,1)", "--certificate", str(made / "certificate.json")).exit_code == 1
    entries = importlib.import_module("liehom.studies.atlas")
    entries.write_entries(made / "atlas.jsonl", iter([next(entries.build(["parabolic"]))]))
    return made


@pytest.mark.parametrize("line", EXAMPLES)
def test_examples_run(line: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A pipe hands the output of one command on."""
    monkeypatch.chdir(folder)
    text: str | None = None
    for part in line.split(" | "):
        program, *words = shlex.split(part.split(" > ")[0])
        assert program == "liehom"
        if any(f"{part} ".startswith(f"liehom {name} ") for name in SLOW):
            *path, name = " ".join(words[:2]).split() if words[0] in ("atlas", "plot") else words[:1]
            COMMANDS[" ".join([*path, name])].make_context(name, words[len(path) + 1 :])
            return
        result = liehom(*words, text=text)
        assert result.exit_code in (0, 1), result.output
        assert result.stderr == ""
        text = result.stdout


@pytest.mark.parametrize("width", [60, 80])
def test_help_fits_the_terminal(width: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", str(width))
    longest = 0
    for name, command in [("liehom", root()), *COMMANDS.items()]:
        context = command.make_context(f"liehom {name}", [], resilient_parsing=True)
        page = command.get_help(context).split("\n  Examples:\n")[0]  # examples are to be copied, not wrapped
        assert [line for line in page.splitlines() if len(line) > width] == []
        longest = max(longest, *map(len, page.splitlines()))
    assert longest > width - 15, "the width is used"


def test_help_is_whole_sentences() -> None:
    for name, command in COMMANDS.items():
        assert re.fullmatch(r"[A-Z].*\.", (command.help or "").strip(), flags=re.DOTALL), name
        for parameter in command.params:
            text = getattr(parameter, "help", None) or ""
            assert text.endswith("."), (name, parameter.name)
            assert "  " not in text, (name, parameter.name)


@pytest.mark.parametrize("width", [40, 80, 200])
def test_without_arguments_it_says_what_to_try_first(width: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", str(width))
    result = liehom()
    assert (result.exit_code, result.stderr) == (0, "")
    shown = re.findall(r"^  (liehom .*?)(?:  .*)?$", result.stdout, flags=re.MULTILINE)
    assert 'liehom fullness "so(4)/so(3)"' in shown
    assert set(shown) - {"liehom --help"} <= set(EXAMPLES)


def test_commands_to_try_have_their_words_beside_them_if_the_terminal_is_wide(monkeypatch: pytest.MonkeyPatch) -> None:
    left, right = (max(len(row[i]) for row in TRY_FIRST) for i in (0, 1))
    shown = []
    for width in (left + right + 3, left + right + 4):
        monkeypatch.setenv("COLUMNS", str(width))
        shown.append(liehom().stdout.splitlines())
    for line, says in TRY_FIRST:
        assert f"  {line:<{left}}  {says}" in shown[1] and f"      {says}" in shown[0] and f"  {line}" in shown[0]


def test_a_group_without_arguments_shows_its_help() -> None:
    result = liehom("atlas")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout == liehom("atlas", "--help").stdout


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("fulness", "x"), ["did you mean 'fullness'", "--help` lists the commands"]),
        (("fullness",), ["missing argument 'PAIR'", 'for example: `liehom fullness "so(4)/so(3)"`']),
        (("fullness", "x", "--jsn"), ["--jsn", "fullness --help` says more"]),
        (("full-pairs", "x"), ["liehom full-pairs 3"]),
        (("plot", "so(4)/so(3)"), ["known: trajectory, ", "failure-cone", "plot --help` lists the commands"]),
        (("show", "so(4,1)"), ["`liehom describe` takes an algebra"]),
        (("atlas", "buil"), ["'build'", "atlas --help` lists the commands"]),
    ],
)
def test_wrong_arguments_show_a_right_one(words: tuple[str, ...], named: list[str]) -> None:
    result = liehom(*words)
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith("liehom: error: ")
    assert result.stderr.count("\n") == 1
    for text in named:
        assert text.lower() in result.stderr.lower()


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("fullness", "so(4)/so(30)"), "`liehom catalog`"),
        (("range", "none.json"), "liehom catalog"),
        (("describe", "so(4"), "liehom describe"),
        (("integrate", "none.json"), "examples/rigid_body.json"),
        (("isotropy", "examples/so4_so3.json"), "examples/sym3.json"),
        (("verify", "so(4)/so(3)", "examples/so4_so3.json"), "--certificate"),
    ],
)
def test_errors_point_to_a_command(words: tuple[str, ...], named: str) -> None:
    result = liehom(*words)
    assert (result.exit_code, result.stdout) == (2, "")
    assert named in result.stderr
    assert result.stderr.count("\n") == 1


@pytest.mark.parametrize("width", [40, 80, 200])
def test_messages_are_wrapped_between_words_on_a_terminal(
    width: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    message = (
        "error: 'so(4)/so(30)' is unknown; `liehom catalog` lists names of pairs, of every kind one or more of them"
    )
    assert guard.say(message, 2) == 2
    assert capsys.readouterr().err == f"liehom: {message}\n"  # in a pipe one line
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    monkeypatch.setattr("shutil.get_terminal_size", lambda fallback=(80, 24): os.terminal_size((width, 24)))
    guard.say(message, 2)
    lines = capsys.readouterr().err.splitlines()
    assert all(len(line) < width for line in lines)
    assert (len(lines) > 1) == (width < 120)
    assert " ".join(line.strip() for line in lines) == f"liehom: {message}"


PAGE = (Path(__file__).resolve().parents[2] / "docs" / "command-line.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", COMMANDS)
def test_the_page_of_the_command_line_has_every_command_and_option(name: str) -> None:
    first, *rest = name.split()
    assert f"| `liehom {first}" in PAGE
    assert all(re.search(rf"`{word}[ `]", PAGE) for word in rest)
    options = {option for parameter in COMMANDS[name].params for option in parameter.opts if option.startswith("--")}
    assert [option for option in options - {"--json", "--help"} if not re.search(rf"`{option}[ `]", PAGE)] == []
