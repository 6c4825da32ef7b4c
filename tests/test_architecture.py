"""docs/architecture.md against the code: paths exist, wings are listed, calls take the walks of the page."""

import re
import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType

import numpy as np
import pytest

import liehom as lh

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = Path(lh.__file__).resolve().parent
PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")


def steps(start: str, end: str) -> list[tuple[str, str]]:
    """The (file, function) of the numbered steps between two places of the page."""
    part = PAGE[PAGE.index(start) :]
    return re.findall(r"^\d+\. `(liehom/[\w/]+\.py)` `([\w.]+)`", part[: part.index(end)], flags=re.MULTILINE)


def called(run: Callable[[], object]) -> list[tuple[str, str]]:
    """The (file, function) of liehom that a call enters, in the order of their first calls."""
    seen: dict[tuple[str, str], None] = {}

    def note(frame: FrameType, event: str, arg: object) -> None:
        if event == "call" and frame.f_code.co_filename.startswith(str(PACKAGE)):
            path = Path(frame.f_code.co_filename).relative_to(PACKAGE.parent).as_posix()
            seen.setdefault((path, frame.f_code.co_qualname))

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        run()
    finally:
        sys.setprofile(before)
    return list(seen)


PAIR = lh.pair("so(4,1)/so(4)")
FIELD = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / np.array([1.0, 2.0, 3.0]))


def integrate() -> object:
    return lh.integrate(FIELD, (0, 1), [0.6, 0, 0.8], step=lh.Corrected(lh.Euler(), order=3), dt=0.5)


@pytest.mark.parametrize(
    ("start", "end", "run"),
    [
        ("## A pair through", "Pairs without an invariant form", lambda: str(lh.decide_fullness(PAIR))),
        ("starts from the pair and the certificate", "## A point through", lambda: lh.decide_fullness(PAIR).verify()),
        ("## A point through", "Options lead to neighbours", integrate),
    ],
    ids=["decide_fullness", "verify", "integrate"],
)
def test_a_call_takes_the_steps_of_the_page_in_their_order(start: str, end: str, run: Callable[[], object]) -> None:
    promised = steps(start, end)
    assert len(promised) >= 4
    run()  # the second call meets no class body and no lazy import on its way
    found = called(run)
    missing = [step for step in promised if step not in found]
    assert not missing, f"not called: {missing}"
    assert [found.index(step) for step in promised] == sorted(found.index(step) for step in promised)


def test_a_step_that_is_not_taken_is_seen() -> None:
    """A control."""
    assert ("liehom/exact/fullness/search/dominance.py", "find_dominant") not in called(
        lambda: lh.decide_fullness(PAIR)
    )


def test_every_path_on_the_page_exists() -> None:
    paths = set(re.findall(r"`((?:liehom|tests|docs)/[\w/.]+?)/?`", PAGE))
    assert len(paths) > 20
    assert [path for path in paths if not (ROOT / path).exists() and not (PACKAGE.parent / path).exists()] == []


def test_the_table_lists_every_folder_with_its_files() -> None:
    rows = dict(
        re.findall(r"^\| `([\w/]+)/` \| .+ \| (.*) \|$", PAGE[: PAGE.index("## A pair through")], flags=re.MULTILINE)
    )
    there = {
        init.parent.relative_to(PACKAGE).as_posix(): {path.stem for path in init.parent.glob("*.py")} - {"__init__"}
        for init in PACKAGE.rglob("*/__init__.py")
    }
    assert {folder: set(re.findall(r"\w+", files)) for folder, files in rows.items()} == there
