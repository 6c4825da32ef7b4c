"""Every script of examples/ runs, and its files are what the committed script writes."""

import json
import runpy
from pathlib import Path

import pytest

import liehom as lh

EXAMPLES = Path(__file__).resolve().parent.parent / "examples"
SCRIPTS = sorted(path.name for path in EXAMPLES.glob("[0-9]*.py"))
FILES = sorted(path.stem for path in EXAMPLES.glob("*.json"))

VERDICTS = {
    "anisotropic": False,
    "driven_spin": True,
    "ellipsoid_sqrt2": True,
    "g2_su3": True,
    "rigid_body": True,
    "sl3_P1": True,
    "so31_so21": False,
    "so4_so3": True,
    "so4_so3_float": True,
    "so5_so4_scrambled": True,
    "sym3": True,
    "sym3_flow": True,
    "sym3_generic": False,
    "vector_field": True,
}


def test_there_are_scripts() -> None:
    assert len(SCRIPTS) >= 5


@pytest.mark.parametrize("script", SCRIPTS)
def test_script_runs_and_its_assertions_hold(script: str, capsys: pytest.CaptureFixture[str]) -> None:
    source = (EXAMPLES / script).read_text(encoding="utf-8")
    assert "assert " in source, "an example asserts the numbers it promises"
    runpy.run_path(str(EXAMPLES / script), run_name="__main__")
    assert capsys.readouterr().out


def test_every_file_has_an_expected_verdict() -> None:
    assert set(FILES) == set(VERDICTS)


@pytest.mark.parametrize("name", FILES)
def test_file_is_decided_as_expected(name: str) -> None:
    pair = lh.load(EXAMPLES / f"{name}.json")
    verdict = lh.decide_fullness(pair)
    assert verdict.full == VERDICTS[name]
    if pair.field.exact:
        assert verdict.verify()


def test_the_files_are_what_the_script_writes() -> None:
    made = runpy.run_path(str(EXAMPLES / "make_files.py"))["files"]()
    assert set(made) == set(FILES)
    for name, data in made.items():
        there = json.loads((EXAMPLES / f"{name}.json").read_text(encoding="utf-8"))
        assert there == json.loads(json.dumps(data)), name
