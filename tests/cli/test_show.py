"""Results on terminals of several widths: words and numbers are never cut."""

import os
import re
import sys

import pytest

from liehom.cli import guard as show

NAMES = ["t", "m0", "drift of invariants"]
ROWS = [["0", " 0.60000000", "< 1e-13"], ["1.00198", "-0.57953430", "2.1e-12"]]


def plain(text: str) -> str:
    return re.sub(r"\x1b\[[0-9;]*m", "", text)


@pytest.mark.parametrize("width", [20, 30, 36, 40, 50, 80, 200])
def test_tables_keep_their_numbers_at_any_width(
    width: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    monkeypatch.setattr(show, "get_terminal_size", lambda: os.terminal_size((width, 24)))
    monkeypatch.setenv("COLUMNS", str(width))
    show.show_table(NAMES, ROWS)
    shown = plain(capsys.readouterr().out)
    for row in ROWS:
        assert all(word in shown for cell in row for word in cell.split())
    assert "…" not in shown
    framed = "│" in shown or "|" in shown
    assert framed == (width >= 40), "lines around cells, where there is room"
    if framed:
        assert all(len(line) <= width for line in shown.splitlines())


def test_wrapped_lines_keep_their_indent(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    monkeypatch.setenv("COLUMNS", "40")
    show.show_lines(["so(4,1)", "  simple, real form so(4,1), rank 2, real rank 1, maximal compact so(4)"])
    inside = [line[2:-2] for line in plain(capsys.readouterr().out).splitlines()[2:-1]]
    assert [line[: len(line) - len(line.lstrip())] for line in inside] == ["  ", "    ", "    "]
