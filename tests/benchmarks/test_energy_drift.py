"""The benchmark of energies over many steps, with few of them: its table, its page and its plots."""

import json
from pathlib import Path

import pytest

from tests.benchmarks.energy_drift import DATA, MARKERS, body, curves, draw, measured, spin, table

ROOT = Path(__file__).resolve().parents[2]


def test_symplectic_rows_do_not_drift_and_others_do() -> None:
    system, count = spin(), 20_000
    rows = {name: measured(system, name, count) for name in ("Heun", "SphericalMidpoint", "Conserving(Heun)")}
    early = {name: row.energy[row.times <= row.times[-1] / 10].max() for name, row in rows.items()}
    assert rows["SphericalMidpoint"].energy.max() < 1.1 * early["SphericalMidpoint"]
    assert rows["Heun"].energy.max() > 3 * early["Heun"]
    assert rows["Conserving(Heun)"].energy.max() < 1e-14
    assert max(row.casimir for row in rows.values()) < 1e-12
    assert table([(system, list(rows.values()))], count).count("\n| `") == len(rows)


def test_plots_are_drawn_for_both_themes(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    found = [(system, [measured(system, "Heun", 100)]) for system in (spin(), body())]
    draw(curves(found), tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["energy_drift_dark.svg", "energy_drift_light.svg"]


def test_the_page_has_a_row_for_every_step() -> None:
    page = (ROOT / "docs" / "lie-poisson.md").read_text(encoding="utf-8")
    measured_part = page[page.index(MARKERS[0]) : page.index(MARKERS[1])]
    for system in (spin(), body()):
        assert all(f"| `{name}` |" in measured_part for name in system.steps)
        assert list(json.loads(DATA.read_text(encoding="utf-8"))[system.title]) == list(system.steps)
