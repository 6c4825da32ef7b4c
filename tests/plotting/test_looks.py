"""Pictures look as recorded; `python -m tests.plotting.looks > tests/plotting/looks.txt` records them again."""

import re

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from tests.plotting.looks import FILE, PICTURES, described

NUMBER = re.compile(r"(?<![\w#.])-?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w.])")
RECORDED = {
    block.partition("\n")[0]: block.splitlines()[1:]
    for block in FILE.read_text(encoding="utf-8").removeprefix("# ").strip().split("\n\n# ")
}


def differences(recorded: list[str], lines: list[str]) -> list[str]:
    """The lines that differ by more than round-off."""
    if len(recorded) != len(lines):
        return [f"- {line}" for line in recorded if line not in lines] + [f"+ {x}" for x in lines if x not in recorded]
    found = []
    for before, after in zip(recorded, lines, strict=True):
        wanted, seen = (np.array(list(map(float, NUMBER.findall(line)))) for line in (before, after))
        rounding = np.where((wanted == 0) | (abs(wanted) > 1e-2), 6e-5, 0.0)  # four digits after the point
        same = NUMBER.sub("", before) == NUMBER.sub("", after)
        if not same or (abs(seen - wanted) > rounding + 1e-3 * abs(wanted)).any():
            found += [f"- {before}", f"+ {after}"]
    return found


@pytest.mark.parametrize("name", PICTURES)
def test_a_picture_looks_as_it_is_recorded(name: str) -> None:
    found = differences(RECORDED[name], described(PICTURES[name]()))
    assert not found, "\n".join(found)


def test_a_small_change_is_a_difference() -> None:
    lines = RECORDED["dynkin G2 labels dark"]
    assert not differences(lines, [line.replace("0.5 0", "0.49999 0") for line in lines])
    for old, new in (("at 1 -0.4", "at 1 -0.39"), ("3 of 6", "2 of 4"), ("#131416", "#131417"), ("'7'", "'8'")):
        assert len(differences(lines, [line.replace(old, new) for line in lines])) == 2
    assert differences(lines, lines[1:])


def test_nothing_is_recorded_that_is_not_drawn() -> None:
    assert list(RECORDED) == list(PICTURES)
