"""`liehom describe`: files and names of every kind, cards and JSON, bad input."""

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

import liehom as lh
from liehom.cli.app import app

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def describe(*words: str) -> Result:
    return CliRunner().invoke(app, ["describe", *words])


def facts(*words: str) -> dict[str, Any]:
    result = describe(*words, "--json")
    assert (result.exit_code, result.stderr) == (0, "")
    data = json.loads(result.stdout)
    assert isinstance(data, dict)
    return data


def test_an_algebra_is_described_as_its_method_does() -> None:
    result = describe("so(4,1)")
    assert result.exit_code == 0
    assert result.stdout == lh.so(4, 1).describe() + "\n"
    assert "simple, real form so(4,1), rank 2, real rank 1, maximal compact so(4)" in result.stdout


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("e(3)", "Levi factor: simple, real form so(3)"),
        ("heisenberg(2)", "nilpotent of class 2"),
        ("R^2", "abelian"),
        ("0", "zero algebra"),
        ("so(3)+sl(2)", "so(3) + sl(2,R)"),
        ("g2(2)", "real form g2(2)"),
        ("G2", "complex type G2"),
        ("sp(6,R)", "complex type C3"),
        ("so*(6)", "real form su(3,1)"),
    ],
)
def test_names_of_algebras(name: str, says: str) -> None:
    result = describe(name)
    assert result.exit_code == 0
    assert says in result.stdout


def test_facts_of_an_algebra() -> None:
    data = facts("so(4,1)")
    assert data["killing_signature"] == [4, 6, 0]
    assert (data["simple"], data["semisimple_type"], data["real_form"]) == (True, "B2", "so(4,1)")
    assert (data["rank"], data["real_rank"], data["maximal_compact"]) == (2, 1, ["so(4)"])
    data = facts("e(3)")
    assert (data["radical"], data["nilradical"], data["levi"], data["center"]) == (3, 3, 3, 0)
    assert (data["simple"], data["solvable"], data["real_form"], data["derived_series"]) == (False, False, "so(3)", [6])
    data = facts("heisenberg(1)")
    assert (data["nilpotent"], data["real_form"], data["lower_central_series"]) == (True, "0", [3, 1, 0])


def test_a_pair_by_name_and_by_file(tmp_path: Path) -> None:
    result = describe("so(4)/so(3)")
    assert result.exit_code == 0
    assert result.stdout.startswith("pair so(4)/so(3): dim g = 6, dim h = 3, dim g/h = 3, over QQ\n  g: so(4)")
    assert "isotropy representation on g/h: irreducible, of type R" in result.stdout
    lh.dump(lh.pair("so(4)/so(3)"), tmp_path / "pair.json")
    data = facts(str(tmp_path / "pair.json"))
    assert (data["kind"], data["dimension"]) == ("pair", 3)
    assert data["algebra"]["real_form"] == "so(3) + so(3)"
    assert data["subalgebra"]["dimension"] == 3
    assert data["isotropy_representation"] == [{"dimension": 3, "multiplicity": 1, "type": "R"}]


def test_a_pair_whose_isotropy_is_not_completely_reducible() -> None:
    result = describe("sl(3)/B")
    assert "isotropy representation on g/h: not completely reducible, with socle of dimension 2" in result.stdout
    assert facts("sl(3)/B")["isotropy_representation"] is None


def test_a_pair_with_nothing_left() -> None:
    assert "dim g/h = 0" in describe("so(3)/so(3)").stdout


def test_a_representation(tmp_path: Path) -> None:
    rho = lh.defining(lh.so(3))
    lh.dump(rho.direct_sum(rho), tmp_path / "rho.json")
    result = describe(str(tmp_path / "rho.json"))
    assert result.stdout.startswith("representation on QQ^6: a sum of irreducible ones of dimensions 2 x 3 (type R)\n")
    data = facts(str(tmp_path / "rho.json"))
    assert (data["kind"], data["size"], data["algebra"]["real_form"]) == ("representation", 6, "so(3)")
    assert data["decomposition"] == [{"dimension": 3, "multiplicity": 2, "type": "R"}]


def test_a_representation_with_a_point_is_a_pair() -> None:
    assert describe(str(EXAMPLES / "sym3.json")).stdout.startswith("pair: dim g = 3, dim h = 1")


@pytest.mark.parametrize("suffix", [".json", ".g", ".gap", ".sage"])
def test_files_of_an_algebra(suffix: str, tmp_path: Path) -> None:
    algebra = lh.su(2, 1).change_of_basis([[int(j in (i, i + 1)) for j in range(8)] for i in range(8)])
    path = tmp_path / f"algebra{suffix}"
    if suffix == ".json":
        lh.dump(algebra, path)
    else:
        path.write_text(lh.io.to_sage(algebra) if suffix == ".sage" else lh.io.to_gap(algebra), encoding="utf-8")
    assert facts(str(path))["real_form"] == "su(2,1)"


def test_floats_are_numerical() -> None:
    result = describe(str(EXAMPLES / "so4_so3_float.json"))
    assert result.exit_code == 3
    assert "numerically" in result.stdout
    result = describe(str(EXAMPLES / "so4_so3_float.json"), "--json")
    assert result.exit_code == 3
    assert json.loads(result.stdout)["proved"] is False


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("so(4,", "not a name"),
        ("so4", "not the name of an algebra"),
        ("so(4)/so(9)", "not the name of a pair"),
        ("E9", "not the type of a simple Lie algebra"),
        ("missing.json", "cannot be read"),
        ("missing.g", "cannot be read"),
        ("missing.sage", "cannot be read"),
    ],
)
def test_unknown_names_exit_with_2(name: str, says: str) -> None:
    result = describe(name)
    assert (result.exit_code, result.stdout) == (2, "")
    assert says in result.stderr


@pytest.mark.parametrize(("suffix", "text"), [(".g", "L := 7;"), (".sage", "L = 7"), (".json", "{}"), (".g", "\udcff")])
def test_bad_files(suffix: str, text: str, tmp_path: Path) -> None:
    path = tmp_path / f"bad{suffix}"
    path.write_bytes(text.encode("utf-8", "surrogateescape"))
    result = describe(str(path))
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith("liehom: error: ")


@pytest.mark.slow
def test_an_exceptional_real_form() -> None:
    assert "real form e8(-24), rank 8, real rank 4, maximal compact e7+su(2)" in describe("e8(-24)").stdout


def test_a_file_of_another_tool_is_known_by_its_suffix(tmp_path: Path) -> None:
    text = lh.io.to_gap(lh.so(3))
    for name in ("so3.g", "so3.gap"):
        (tmp_path / name).write_text(text, encoding="utf-8")
        assert "simple, real form so(3)" in describe(str(tmp_path / name)).stdout
    (tmp_path / "so3").write_text(text, encoding="utf-8")
    result = describe(str(tmp_path / "so3"))
    assert result.exit_code == 2
    assert ".g or .gap" in result.stderr
    assert ".sage" in result.stderr


def test_exceptional_real_forms_with_a_capital_letter() -> None:
    assert facts("G2(-14)")["real_form"] == facts("g2")["real_form"] == "g2"
    assert facts("G2")["real_form"] == "g2(2)"


def test_family_with_a_parameter_is_not_a_pair() -> None:
    assert "solvable" in describe("bianchi(VI;2)").stdout
