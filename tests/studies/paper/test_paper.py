"""Section 4 of the paper done again: orders, zeros, misprints, costs; tables and files; the command."""

import csv
import io
import re
from functools import cache, partial
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from liehom.base.errors import FormatError, InputError
from liehom.studies.paper import efficiency
from liehom.studies.paper.efficiency import Cost, accuracy, measured_orders, operations, own_consistency
from liehom.studies.paper.energy_errors import energy_errors, largest_energy_error, random_bodies, scale
from liehom.studies.paper.figures import NAMES, reproduce
from liehom.studies.paper.kernels import MISPRINTS, Body, kernel
from liehom.studies.paper.plots import draw_spheres
from liehom.studies.paper.reproduction import Check, Reproduction, stored
from liehom.studies.paper.table import CROSSOVER, FIGURE_3, FIGURE_4, FIGURE_5, FIGURE_6, UPDATES, Table
from liehom.studies.paper.trajectories import separatrix_sample, trajectory
from liehom.studies.rigid_body import RigidBody
from tests.plotting.looks import described
from tests.plotting.test_looks import differences
from tests.studies.paper.small import small

ROOT = Path(__file__).resolve().parent.parent.parent.parent
LOOKS = Path(__file__).with_name("looks.txt")
quick = cache(partial(reproduce, quick=True))
"""Reproduction of a figure on few bodies, computed once for all tests."""


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
    done = quick(name)
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
    assert abs(np.log10(FIGURE_5["axisymmetric", 1.0, "sy4_o"] / FIGURE_5["axisymmetric", 0.1, "sy4_o"]) - 3) < 0.01
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
        assert len(timed) == (name != "lines")  # the fits are over operations
        rows = zip(table.rows, second["tables"][name].rows, strict=True)
        assert not timed or any(a[timed[0]] != b[timed[0]] for a, b in rows)
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
    return quick(name).tables[table].rows


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
    assert done.caption() == "X. Claims that fail: 1 = 2 (found: 1)."
    assert not Reproduction("x", "X", "none", {}, (Check("1 = 1", "1", True),)).failures()


@pytest.mark.parametrize(
    ("name", "failing"),
    [
        ("fig4", ["triaxial rk2_b: the formula as printed", "triaxial rk2_ib: the formula as printed"]),
        ("fig5", ["triaxial sy4_o: the formula as printed", "the errors of xi_o^sy4 and xi_io^sy4 have slope 3"]),
        pytest.param("fig6", ["xi_io^RK2 costs 17.14 steps of xi_b^Eul (found: 3.52"], marks=pytest.mark.slow),
        ("fig7", ["xi_o^sy4 is the most efficient update for high accuracy", "xi_ib^RK2 is the most efficient of"]),
    ],
)
def test_captions_name_the_claims_of_the_paper_that_fail(name: str, failing: list[str]) -> None:
    done = quick(name)
    page, tex, shown = done.markdown("plot.svg"), done.latex(), [done.caption(key) for key in done.tables]
    for text in failing:
        assert text in done.caption()
        assert page.count(text) == 2  # below the plot and below the table that refutes it
        assert sum(text in caption for caption in shown) == 1
    assert tex.count("Claims that fail:") == sum("Claims that fail" in caption for caption in shown) > 0
    assert "Claims that fail" not in quick("fig3").caption()


def test_files_are_in_their_format_and_the_same_again() -> None:
    done = small("fig4")
    files = done.files()
    assert files == small("fig4").files()
    assert {name[5:] for name in files} == {"md", "tex", "csv", "png", "svg", "pdf", "json"}
    assert files["fig4.png"].startswith(b"\x89PNG")
    assert files["fig4.pdf"].startswith(b"%PDF")
    assert files["fig4.pdf"].rstrip().endswith(b"%%EOF")
    assert b"/Subject (" + done.caption().encode() in files["fig4.pdf"].replace(b"\\", b"")
    assert not any(b"CreationDate" in files[name] or b"dc:date" in files[name] for name in ("fig4.pdf", "fig4.svg"))
    width, height = int.from_bytes(files["fig4.png"][16:20]), int.from_bytes(files["fig4.png"][20:24])
    root = ElementTree.fromstring(files["fig4.svg"])
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    points = [float(size.removesuffix("pt")) for size in (root.attrib["width"], root.attrib["height"])]
    assert [width, height] == pytest.approx([x * 160 / 72 for x in points], abs=1)
    assert [element.text for element in root.iter() if element.tag.endswith("description")] == [done.caption()]
    with pytest.raises(InputError, match="png, svg, pdf"):
        done.files(("bmp",))
    with pytest.raises(InputError, match="table in the paper"):
        quick("fig2").plot()


def test_a_plot_has_its_caption_inside() -> None:
    drawn = " ".join(quick("fig4").plot().get_supxlabel().split())
    assert drawn.startswith("Figure 4: energy errors of the Heun method")
    assert r"triaxial $\xi_{ib}^{\mathrm{RK2}}$: the formula as printed has energy order 4 (found: 3.00" in drawn


def test_panels_of_figures_3_to_5_show_both_the_errors_here_and_those_of_the_paper() -> None:
    assert len(quick("fig7").plot().axes) == 4
    assert len(quick("separatrix").plot().axes) == 3
    for name, rows, columns in (("fig3", 1, 6), ("fig4", 2, 4), ("fig5", 2, 6)):
        done = quick(name)
        figure = done.plot()
        assert len(figure.axes) == rows * columns
        table = [dict(zip(done.tables[""].columns, row, strict=True)) for row in done.tables[""].rows]
        for axes, key in zip(figure.axes, dict.fromkeys((row["body"], row["update"]) for row in table), strict=True):
            mine = [row for row in table if (row["body"], row["update"]) == key]
            middle = max(axes.get_lines(), key=lambda line: len(line.get_xdata()) if line.get_linestyle() == "-" else 0)
            assert list(middle.get_ydata()) == [max(row["average error"], 3e-17) for row in mine]
            marks = [line for line in axes.get_lines() if line.get_linestyle() == "None"]
            points = [point for line in marks for point in np.transpose(line.get_data()).tolist()]
            assert all([row["dt"], max(row["paper"], 3e-17)] in points for row in mine)
            assert axes.get_title(loc="right") == key[0]


DRAWN = ("fig4", "fig7", "separatrix")


def drawn(name: str) -> list[str]:
    """The figure as text, without errors that are round-off."""
    return [re.sub(r"-?\d[\d.]*e-1[2-9]", "0", line) for line in described(quick(name).plot())]


@pytest.mark.parametrize("name", DRAWN)
def test_a_figure_looks_as_it_is_recorded(name: str) -> None:
    """`python -m tests.studies.paper.test_paper > tests/studies/paper/looks.txt` records them again."""
    recorded = dict(block.split("\n", 1) for block in LOOKS.read_text(encoding="utf-8").split("# ")[1:])
    found = differences(recorded[name].splitlines(), drawn(name))
    assert not found, "\n".join(found)


def test_tables_in_latex_compile_as_text() -> None:
    text = Table("a & b", ("x_1", "update"), [("|m| < 1", "sy4_io"), (2.5e-7, "10 %")]).latex("Claims: xi_o^sy4 50%")
    assert r"\caption{Claims: $\xi_{o}^{\mathrm{sy4}}$ 50\%}" in text
    assert r"x\_1 & update \\" in text
    assert r"$|$m$|$ $<$ 1 & $\xi_{io}^{\mathrm{sy4}}$ \\" in text
    assert r"$2.5\cdot10^{-7}$ & 10 \% \\" in text


def test_cells_in_json_are_numbers_and_texts() -> None:
    cells = [None, float("nan"), "x_1", 3, np.float64(0.25)]
    rows = Table("a", ("k", "v"), [(i, x) for i, x in enumerate(cells)]).to_json()["rows"]
    assert [row[1] for row in rows] == [None, None, "x_1", 3, 0.25]


def test_a_figure_is_found_again_only_if_it_is_complete_and_the_same(tmp_path: Path) -> None:
    done = small("fig2")
    paths = done.write(tmp_path, ("svg",))
    assert len(paths) == 5
    found = stored(tmp_path, "fig2", done.settings, ("svg",))
    assert found is not None
    assert found["tables"] == done.to_json()["tables"]
    assert stored(tmp_path, "fig2", {"quick": True, "seed": None}, ("svg",)) is None
    assert stored(tmp_path, "fig2", done.settings, ("png",)) is None
    assert stored(tmp_path, "fig2", done.settings, ("svg",), dark=True) is None
    for path in paths:
        before = path.read_bytes()
        path.write_bytes(before[:-3])
        assert stored(tmp_path, "fig2", done.settings, ("svg",)) is None
        path.unlink()
        assert stored(tmp_path, "fig2", done.settings, ("svg",)) is None
        path.write_bytes(before)
    assert stored(tmp_path, "fig2", done.settings, ("svg",)) is not None


def test_a_figure_that_is_written_again_leaves_no_file_of_before(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    small("fig3").write(tmp_path, ("png", "pdf"))
    left = {path.name for path in small("fig3").write(tmp_path, ("svg",))}
    assert {path.name for path in tmp_path.iterdir()} == left | {"mine.txt"}
    assert not any(name.endswith((".png", ".pdf")) for name in left)


def test_files_of_a_figure(tmp_path: Path) -> None:
    done = quick("fig1")
    names = [path.name for path in done.write(tmp_path / "new", ("svg",))]
    assert names == ["fig1.md", "fig1.tex", "fig1.csv", "fig1_bodies.csv", "fig1.svg", "fig1.json"]
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


# -- the pages -------------------------------------------------------------------------------------------
def test_captions_of_the_page_name_the_claims_that_fail() -> None:
    page = (ROOT / "docs" / "reproduction.md").read_text(encoding="utf-8")
    captions = {part[1:9]: part for part in page.split("\n\n") if part.startswith("*Figure")}
    assert list(captions) == [f"Figure {n}" for n in (1, 3, 4, 5, 6, 7)]
    failing = {name for name in captions if "that fail" in captions[name].replace("\n", " ")}
    assert failing == {f"Figure {n}" for n in (4, 5, 6, 7)}
    for n, numbers in {4: ("1.00", "3.00", "4.54"), 5: ("2.26", "4.04", "4.12", "5.00"), 6: ("17.14", "3.52")}.items():
        assert all(number in captions[f"Figure {n}"] for number in numbers)


def test_tables_of_the_page_have_the_columns_of_today_and_the_numbers_of_the_paper() -> None:
    for name, key in stored_tables():
        fresh = quick(name).tables[key]
        head, *rows = csv.reader(stored_table(name, key))
        assert head == list(fresh.columns)
        if "paper" in head:
            printed = {tuple(row[:3]): row[head.index("paper")] for row in map(cells, rows)}
            again = {tuple(row[:3]): row[head.index("paper")] for row in fresh.rows}
            assert {key: printed[key] for key in again} == again


@pytest.mark.slow
def test_tables_of_the_page_are_those_of_the_command() -> None:
    for name, key in stored_tables():
        fresh = reproduce(name).tables[key]
        timed = [i for i, column in enumerate(fresh.columns) if "time" in column]
        rows = list(map(cells, list(csv.reader(stored_table(name, key)))[1:]))
        for mine, row in zip(fresh.rows, rows, strict=True):
            for i, (x, y) in enumerate(zip(mine, row, strict=True)):
                right = float("nan") if x is None else x
                near = right if isinstance(right, str) else pytest.approx(right, rel=1e-3, abs=1e-13, nan_ok=True)
                assert i in timed or y == near, (name, row)


def stored_tables() -> list[tuple[str, str]]:
    """Names of figures and keys of the tables of the page."""
    files = sorted(path.stem.partition("_") for path in (ROOT / "docs" / "_static" / "reproduction").glob("*.csv"))
    assert len(files) == 10
    return [(name, key) for name, _, key in files]


def stored_table(name: str, key: str) -> list[str]:
    file = f"{name}{'_' if key else ''}{key}.csv"
    return (ROOT / "docs" / "_static" / "reproduction" / file).read_text(encoding="utf-8").splitlines()


def cells(row: list[str]) -> list[str | float]:
    numbers = [re.fullmatch(r"-?[0-9.]+(e[+-][0-9]+)?", x) for x in row]
    return [float(x) if number else (float("nan") if x == "" else x) for x, number in zip(row, numbers, strict=True)]


if __name__ == "__main__":
    for name in DRAWN:
        print(f"# {name}", *drawn(name), sep="\n")
