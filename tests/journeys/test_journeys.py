"""Every script of this folder runs; each asserts its own numbers. A peer that is not installed is skipped."""

import os
import runpy
from pathlib import Path

import pytest

HERE = Path(__file__).parent
SCRIPTS = sorted(path.name for path in HERE.glob("*.py") if not path.name.startswith("test_"))
OPTIONAL = {"jax", "jaxlie", "diffrax", "pennylane"}


@pytest.mark.parametrize("script", SCRIPTS)
def test_journey_runs_to_its_end(script: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (HERE / script).read_text(encoding="utf-8")
    for package in sorted(OPTIONAL):
        if f"import {package}" in text or f"from {package}" in text:
            pytest.importorskip(package)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.argv", [script])
    runpy.run_path(os.fspath(HERE / script), run_name="__main__")
