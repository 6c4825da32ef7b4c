"""Section 4 of the paper done again: orders, zeros, misprints, costs; tables and files; the command."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import liehom.paper
from liehom.cli.app import app
from liehom.errors import FormatError, InputError
from liehom.instances import RigidBody
from liehom.paper import NAMES, Check, Reproduction, Table, efficiency, reproduce
from liehom.paper.costs import Cost, operations
from liehom.paper.efficiency import accuracy, own_consistency
from liehom.paper.energy_errors import energy_errors, scale
from liehom.paper.kernels import MISPRINTS, Body, kernel
from liehom.paper.orders import measured_orders
from liehom.paper.plots import draw_spheres
from liehom.paper.printed_data import CROSSOVER, FIGURE_3, FIGURE_4, FIGURE_5, FIGURE_6, UPDATES
from liehom.paper.samples import largest_energy_error, random_bodies
from liehom.paper.separatrices import separatrix_sample
from liehom.paper.trajectories import trajectory


# -- the formulas ----------------------------------------------------------------------------------------
@pytest.mark.parametrize("kind", ["triaxial", "axisymmetric"])
@pytest.mark.parametrize("name", UPDATES)
def test_kernel_is_the_base_scheme_with_the_generic_corrector(name: str, kind: str) -> None:
    sample = random_bodies(kind, 4, seed=3)
    after = np.stack(kernel(name, sample.body)(sample.points, 0.8), axis=-1)
    for i in range(4):
        body = RigidBody(sample.moments[:, i])
        start = sample.start[:, i]
        assert np.abs(after[i] - body.update(name)(start, 0.8)).max() < 1e-14
        assert np.abs(after[i] - body.closed_form(name)(start, 0.8)).max() < 1e-14


@pytest.mark.parametrize("name", UPDATES)
def test_kernel_fixes_equilibria_and_keeps_precision(name: str) -> None:
    body = Body(tuple(np.array([1.0, 0.5, 0.25], dtype=np.longdouble)))  # type: ignore[arg-type]
    poles = np.eye(3, dtype=np.longdouble)
    after = np.stack(kernel(name, body)((poles[0], poles[1], poles[2]), 2.0))
    assert np.array_equal(after, poles)
    assert after.dtype == np.longdouble


@pytest.mark.parametrize("name", MISPRINTS)
def test_kernel_of_a_misprint_is_another_update(name: str) -> None:
    sample = random_bodies("triaxial", 4)
    steps = [np.stack(kernel(name, sample.body, printed=flag)(sample.points, 2.0)) for flag in (False, True)]
    assert np.abs(steps[0] - steps[1]).max() > 1e-8


def test_kernels_have_the_names_of_figure_6_only() -> None:
    body = Body((1.0, 0.5, 0.25))
    with pytest.raises(InputError, match="eul_b, eul_o"):
        kernel("euler", body)
    with pytest.raises(InputError, match="rk2_b, rk2_ib"):
        kernel("eul_b", body, printed=True)


# -- orders, zeros, misprints ----------------------------------------------------------------------------
@pytest.mark.parametrize("name", NAMES)
def test_all_claims_hold(name: str) -> None:
    done = reproduce(name, quick=True)
    assert done.checks
    assert [check for check in done.checks if not check.holds] == []


def test_orders_are_those_of_figure_6() -> None:
    orders = measured_orders()
    for name in UPDATES:
        assert abs(orders[name].solution - FIGURE_6[name][0]) < 0.15, name
        assert abs(orders[name].energy - FIGURE_6[name][1]) < 0.15, name


@pytest.mark.parametrize(("name", "order"), [("eul_i", 2), ("rk2_b", 3), ("rk2_o", 3), ("sy4_ib", 5), ("sy4_io", 5)])
def test_slopes_over_long_runs(name: str, order: int) -> None:
    rows = {(row[0], row[1]): row for fig in ("fig3", "fig4", "fig5") for row in _rows(fig, "slopes")}
    assert abs(rows["triaxial", name][4] - order) < 0.1


@pytest.mark.parametrize("dt", [10.0, 1.0, 0.1])
def test_axisymmetric_zeros(dt: float) -> None:
    """Exact orbits with xi_i^Eul; a body without symmetry is the control."""
    assert energy_errors(scale(True), "axisymmetric", "eul_i", dt).max() < 2e-15
    assert energy_errors(scale(True), "triaxial", "eul_i", dt).max() > 1e-6


def test_improvements_of_order_four_vanish_for_axisymmetric_bodies() -> None:
    for g in "bo":
        errors = [energy_errors(scale(True), "axisymmetric", name, 1.0) for name in (f"sy4_{g}", f"sy4_i{g}")]
        assert np.abs(errors[0] - errors[1]).max() < 1e-15


def test_figure_5_contradicts_itself_where_the_improvements_vanish() -> None:
    assert FIGURE_5["axisymmetric", 10.0, "sy4_o"] != FIGURE_5["axisymmetric", 10.0, "sy4_io"]
    errors = [energy_errors(scale(True), "axisymmetric", name, 10.0) for name in ("sy4_o", "sy4_io")]
    assert np.allclose(*errors, rtol=1e-9, atol=1e-12)


def test_the_misprinted_xi_o_sy4_has_slope_3_as_the_paper_in_figure_5() -> None:
    rows = [row for row in _rows("fig5", "printed") if row[0] == "axisymmetric"]
    assert len(rows) == 1
    printed, corrected = rows[0][5], rows[0][7]
    paper = np.log10(FIGURE_5["axisymmetric", 1.0, "sy4_o"] / FIGURE_5["axisymmetric", 0.1, "sy4_o"])
    assert abs(paper - 3) < 0.01
    assert abs(printed - 3) < 0.05
    assert abs(corrected - 5) < 0.05


def test_the_separatrix_is_kept_by_two_of_three() -> None:
    sample = separatrix_sample(20)
    found = {
        name: largest_energy_error(kernel(name, sample.body), sample.body, sample.points, 0.5, 50.0)
        for name in ("eul_b", "eul_o", "eul_i")
    }
    assert max(found["eul_o"].max(), found["eul_i"].max()) < 1e-14
    assert found["eul_b"].min() > 1e-8


# -- costs -----------------------------------------------------------------------------------------------
def test_the_improved_heun_method_costs_less_than_four_steps_of_euler() -> None:
    """17.14 in the paper."""
    assert operations("rk2_io") < 4 * operations("eul_b")
    assert operations("rk2_io") < 1.7 * operations("rk2_b")


def test_the_last_column_follows_from_the_errors_of_the_paper() -> None:
    rows = {row[0]: row[1:] for row in own_consistency().rows}
    for name in ("eul_b", "eul_i", "rk2_ib", "rk2_io"):
        own, printed, implied, cost = rows[name]
        assert abs(own - printed) < 0.003, name
        assert abs(implied / cost - 1) < 0.06, name


def test_printed_costs_within_a_class_are_those_of_the_column_before() -> None:
    for order in (1, 2, 4):
        costs = {name: row for name, row in FIGURE_6.items() if row[0] == order}
        least = min(row[2] for row in costs.values())
        assert all(abs(row[2] / least - row[3]) < 0.02 for row in costs.values())


def test_tables_of_the_paper_are_complete() -> None:
    assert [len(table) for table in (FIGURE_3, FIGURE_4, FIGURE_5, FIGURE_6)] == [24, 32, 36, 13]


@pytest.mark.slow
def test_the_crossover_of_the_paper_lies_in_the_range() -> None:
    rows = {row[0]: row for row in reproduce("fig6").tables["crossover"].rows}
    _, _, low, high, paper = rows["the paper's CPU times"]
    assert paper == CROSSOVER
    assert low < paper < high


def test_conclusions_do_not_depend_on_measured_times(monkeypatch: pytest.MonkeyPatch) -> None:
    """With other times only the columns of times differ."""
    fields = ("checks", "tables", "sample")
    found = []
    for factor in (1.0, 30.0):
        costs = {n: Cost(operations(n), factor ** (-1.0) ** k, 1.0) for k, n in enumerate(UPDATES)}
        monkeypatch.setattr(efficiency, "measured_costs", lambda quick, costs=costs: costs)
        done = reproduce("fig7", quick=True)
        found.append({field: getattr(done, field) for field in fields})
        assert done.holds
    first, second = found
    assert first["checks"] == second["checks"]
    for name, table in first["tables"].items():
        timed = [i for i, column in enumerate(table.columns) if "time" in column]
        assert len(timed) == 1
        rows = zip(table.rows, second["tables"][name].rows, strict=True)
        assert any(a[timed[0]] != b[timed[0]] for a, b in rows)
        for a, b in zip(table.rows, second["tables"][name].rows, strict=True):
            assert [x for i, x in enumerate(a) if i not in timed] == [x for i, x in enumerate(b) if i not in timed]


@pytest.mark.slow
def test_fig6_fits_are_in_operations(monkeypatch: pytest.MonkeyPatch) -> None:
    found = []
    for time in (1.0, 7.0):
        costs = {n: Cost(operations(n), time, time) for n in UPDATES}
        monkeypatch.setattr(efficiency, "measured_costs", lambda quick, costs=costs: costs)
        done = reproduce("fig6", quick=True)
        found.append((done.tables["fits"].csv(), done.checks))
    assert found[0] == found[1]


def test_fits_are_least_squares() -> None:
    found = accuracy(scale(True), "rk2_o", True)
    x, y = -np.log(found.errors[:, 1]), np.log(2.5 * found.steps)
    assert np.allclose(found.fits(2.5)[:, 1], np.polyfit(x, y, 1))


# -- tables, files ---------------------------------------------------------------------------------------
def _rows(name: str, table: str) -> Any:
    return reproduce(name, quick=True).tables[table].rows


def test_a_table_as_csv_and_markdown() -> None:
    table = Table("t", ("a", "b|c", "d"), [("x|y", 1 / 3, None), ("z", float("nan"), 7)])
    assert list(csv.reader(io.StringIO(table.csv()))) == [["a", "b|c", "d"], ["x|y", repr(1 / 3), ""], ["z", "", "7"]]
    assert table.markdown().splitlines()[2:] == ["| x\\|y | 0.333 |  |", "| z |  | 7 |"]
    with pytest.raises(InputError, match="expected 2"):
        Table("t", ("a", "b"), [(1,)])


def test_a_claim_that_fails_is_said_to_fail() -> None:
    done = Reproduction("x", "X", "none", {}, (Check("1 = 1", "1", True), Check("1 = 2", "1", False)))
    assert not done.holds
    assert "| 1 = 2 | 1 | NO |" in done.markdown()


def test_files_of_a_figure(tmp_path: Path) -> None:
    done = reproduce("fig1", quick=True)
    names = sorted(path.name for path in done.write(tmp_path / "new"))
    assert names == ["fig1.csv", "fig1.md", "fig1.png", "fig1_bodies.csv"]
    rows = list(csv.DictReader(io.StringIO((tmp_path / "new" / "fig1.csv").read_text(encoding="utf-8"))))
    m = np.array([[float(row[f"m{k}"]) for k in (1, 2, 3)] for row in rows])
    assert np.abs((m**2).sum(axis=1) - 1).max() < 1e-13
    with pytest.raises(FormatError):
        done.write(tmp_path / "new" / "fig1.md")


def test_the_same_seed_gives_the_same_tables() -> None:
    first, again, other = (reproduce("fig2", quick=True, seed=seed).tables[""].csv() for seed in (1, 1, 2))
    assert first == again != other


def test_names_and_seeds_are_checked() -> None:
    with pytest.raises(InputError, match="fig1, fig2"):
        reproduce("fig8")
    for seed in (-1, True, 1.5):
        with pytest.raises(InputError, match="seed"):
            reproduce("fig1", quick=True, seed=seed)  # type: ignore[arg-type]


def test_a_panel_for_every_body_and_update() -> None:
    curves = {("triaxial", name): trajectory(name, random_bodies("triaxial", 2), 1.0) for name in ("eul_b", "eul_i")}
    figure = draw_spheres(curves)
    assert [axes.get_title(loc="center") for axes in figure.axes] == [
        r"$\xi_{b}^{\mathrm{Eul}}$",
        r"$\xi_{i}^{\mathrm{Eul}}$",
    ]


# -- the command -----------------------------------------------------------------------------------------
def liehom_(*words: str) -> Result:
    return CliRunner().invoke(app, list(words))


def test_reproduce_all_writes_every_table(tmp_path: Path) -> None:
    result = liehom_("reproduce", "all", "--quick", "--out", str(tmp_path))
    assert result.exit_code == 0, result.stdout
    assert "FAILS" not in result.stdout
    assert {f"{name}.{end}" for name in NAMES for end in ("md", "csv")} | {"fig1.png", "fig7.png"} <= {
        path.name for path in tmp_path.iterdir()
    }


def test_reproduce_prints_one_object(tmp_path: Path) -> None:
    result = liehom_("reproduce", "fig2", "--quick", "--seed", "5", "--out", str(tmp_path), "--json")
    data = json.loads(result.stdout)
    assert data["holds"] is True
    assert data["figures"][0]["name"] == "fig2"
    assert len(data["figures"][0]["tables"]["table"]["rows"]) == 6
    assert all(Path(file).is_file() for file in data["figures"][0]["files"])


def test_reproduce_lists_the_known_names(tmp_path: Path) -> None:
    result = liehom_("reproduce", "fig8", "--out", str(tmp_path))
    assert result.exit_code == 2
    assert result.stdout == ""
    assert "separatrix, all" in result.stderr


def test_reproduce_exits_with_1_where_a_claim_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = Reproduction("fig2", "X", "none", {}, (Check("1 = 2", "1", False),))
    monkeypatch.setattr(liehom.paper, "reproduce", lambda *args, **options: wrong)
    result = liehom_("reproduce", "fig2", "--out", str(tmp_path))
    assert result.exit_code == 1
    assert "FAILS" in result.stdout
