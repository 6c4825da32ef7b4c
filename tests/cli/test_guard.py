"""Helpers of the command line: widths of tables, short vectors, streams that the caller closed."""

import errno
import os
import sys
from types import SimpleNamespace

import pytest

from liehom.cli import guard


def test_the_least_width_of_a_table_has_lines_between_its_words() -> None:
    assert guard._least_width(["a", "bb"], [["x", "long word"], ["yy", "z"]]) == 1 + (3 + 2) + (3 + 4)
    assert guard._least_width([], []) == 1 and guard._least_width(["name of two"], []) == 1 + 3 + 4
    assert guard._least_width(["n"], [[" 12"], ["-12"]]) == 1 + 3 + 3  # a space before a number is no word


def test_vectors_are_written_as_short_as_they_are() -> None:
    assert guard.short_vector(["1", "0", "-2/3"]) == "(1, 0, -2/3)"
    assert guard.short_vector(["0"] * 40 + ["7", "0", "-1"]) == "7 e40 + -1 e42"
    assert guard.short_vector(["1"] * 60) == "a vector of length 60 with 60 non-zero entries"
    assert guard.short_vector(["1", "1"], limit=6) == "(1, 1)" and guard.short_vector(["1", "0"], limit=5) == "1 e0"


def test_streams_that_are_missing_are_opened(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", None)
    monkeypatch.setattr(sys, "stderr", None)
    guard.repair_streams()
    assert [(stream.fileno(), stream.encoding) for stream in (sys.stdout, sys.stderr)] == [(1, "utf-8"), (2, "utf-8")]


@pytest.mark.parametrize(("number", "code", "said"), [
    (errno.EPIPE, guard.BROKEN_PIPE, ""),
    (errno.ENOSPC, guard.NOT_WRITTEN, "liehom: error: standard output cannot be written: No space left on device\n"),
])  # fmt: skip
def test_output_that_fails_is_redirected(
    number: int, code: int, said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    duplicated: list[int] = []
    monkeypatch.setattr(sys, "stdout", SimpleNamespace(fileno=lambda: 77))
    monkeypatch.setattr(os, "dup2", lambda old, new: duplicated.append(new))
    assert guard.close_output(OSError(number, os.strerror(number))) == code
    assert 77 in duplicated and capsys.readouterr().err == said
