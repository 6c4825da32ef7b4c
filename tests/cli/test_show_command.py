"""`liehom show`: where the page goes, what is printed, files of pairs, verdicts and certificates, bad input."""

import json
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

import liehom as lh
from liehom.cli.app import app
from liehom.io import page as pictures
from tests.html_structure import Balance

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
PAIR = "so(3,1)/so(2,1)"


@pytest.fixture(autouse=True)
def no_pictures(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Pictures take most of the time and are tested with the pages; new folders are made in the folder of the test."""

    def missing(name: str) -> object:
        raise lh.InputError("plots need matplotlib")

    monkeypatch.setattr(pictures, "matplotlib_module", missing)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))


def liehom(*words: object) -> Result:
    return CliRunner().invoke(app, [str(word) for word in words])


def test_the_page_is_written_where_the_option_says(tmp_path: Path) -> None:
    file = tmp_path / "page.html"
    result = liehom("show", PAIR, "-o", file)
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout.splitlines()[0] == f"page written to {file}"
    assert str(lh.decide_fullness(lh.pair(PAIR))) in result.stdout
    assert file.read_text(encoding="utf-8") == lh.pair_page(lh.pair(PAIR))
    assert list(tmp_path.iterdir()) == [file], "and nothing else"


def test_without_the_option_the_page_is_in_a_new_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)
    written = [json.loads(liehom("show", PAIR, "--json").stdout) for _ in range(2)]
    assert written[0]["page"] != written[1]["page"]
    for data in written:
        page = Path(data["page"]).read_bytes()
        assert data == {"page": data["page"], "bytes": len(page), "full": False, "proved": True}
        assert tmp_path in Path(data["page"]).parents
    assert not list(here.iterdir()), "nothing is written to the current folder"


def test_a_pair_of_a_file_has_the_name_of_the_file(tmp_path: Path) -> None:
    file = tmp_path / "page.html"
    assert liehom("show", EXAMPLES / "so4_so3.json", "-o", file).exit_code == 0
    assert re.search(r"The pair .*so4_so3.json is full\.", Balance(file.read_text(encoding="utf-8")).text)


def test_a_pair_on_standard_input() -> None:
    content = json.dumps(lh.io.to_json(lh.pair(PAIR)))
    result = CliRunner().invoke(app, ["show", "-"], input=content)
    assert (result.exit_code, result.stderr) == (0, "")
    assert "standard input: dim g = 6" in result.stdout
    twice = CliRunner().invoke(app, ["show", "-", "--certificate", "-"], input=content)
    assert twice.exit_code == 2
    assert "given twice" in twice.stderr


def test_a_numerical_verdict_has_a_page(tmp_path: Path) -> None:
    lh.dump(lh.Pair(lh.so(3).over(lh.RR), [[0.0, 0.0, 1.0]]), tmp_path / "floats.json")
    data = json.loads(liehom("show", tmp_path / "floats.json", "--json").stdout)
    assert (data["full"], data["proved"]) == (True, False)
    (tmp_path / "verdict.json").write_text(liehom("fullness", tmp_path / "floats.json", "--json").stdout)
    result = liehom("show", tmp_path / "verdict.json")
    assert result.exit_code == 2
    assert "is a numerical verdict, which has no certificate" in result.stderr


@pytest.mark.parametrize("whole", [True, False])
def test_a_given_certificate_is_verified_and_shown(
    tmp_path: Path, whole: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As a file of its own, and inside the verdict that `liehom fullness --json` prints."""
    file, page = tmp_path / "file.json", tmp_path / "page.html"
    if whole:
        file.write_text(liehom("fullness", PAIR, "--json").stdout)
    else:
        liehom("fullness", PAIR, "--certificate", file)
    monkeypatch.setattr("liehom.exact.fullness.decide.decide_fullness", lambda pair: pytest.fail("decided"))
    result = liehom("show", PAIR, "--certificate", file, "-o", page)
    assert (result.exit_code, result.stderr) == (0, "")
    assert f"not full: proved by the certificate in {file}" in Balance(page.read_text(encoding="utf-8")).text
    piped = CliRunner().invoke(app, ["show", PAIR, "--certificate", "-", "-o", str(page)], input=file.read_text())
    assert (piped.exit_code, piped.stderr) == (0, "")
    assert "proved by the certificate in standard input" in piped.stdout
    refused = liehom("show", "so(4)/so(3)", "--certificate", file, "-o", tmp_path / "other.html")
    assert refused.exit_code == 1
    assert refused.stderr.startswith("liehom: the certificate fails: phi-h:")
    assert not (tmp_path / "other.html").exists()


def test_a_verdict_names_its_pair(tmp_path: Path) -> None:
    file, page = tmp_path / "verdict.json", tmp_path / "page.html"
    verdict = json.loads(liehom("fullness", PAIR, "--json").stdout)
    file.write_text(json.dumps(verdict))
    assert liehom("show", file, "-o", page).exit_code == 0
    assert f"The pair {PAIR} is not full." in page.read_text(encoding="utf-8")
    del verdict["pair"]
    file.write_text(json.dumps(verdict))
    result = liehom("show", file)
    assert result.exit_code == 2
    assert "names no pair: give the pair, and this file with --certificate" in result.stderr


def test_input_is_not_overwritten_and_bad_input_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "pair.json"
    lh.dump(lh.pair(PAIR), file)
    before = file.read_bytes()
    for words in ([file, "-o", file], [PAIR, "--certificate", file, "-o", file]):
        result = liehom("show", *words)
        assert result.exit_code == 2
        assert "is read by this command" in result.stderr
    assert file.read_bytes() == before
    assert liehom("show", "no such pair").exit_code == 2
    assert liehom("show", PAIR, "-o", tmp_path / "no" / "page.html").exit_code == 2
    assert liehom("show", PAIR, "--certificate", file).exit_code == 2


def test_the_browser_is_opened(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    opened: list[str] = []
    found = True
    monkeypatch.setattr("webbrowser.open", lambda url: bool(opened.append(url)) or found)
    assert liehom("show", PAIR, "-o", tmp_path / "page.html", "--open").exit_code == 0
    assert opened == [(tmp_path / "page.html").as_uri()]
    found = False
    result = liehom("show", PAIR, "-o", tmp_path / "page.html", "--open")
    assert result.exit_code == 2
    assert "no browser was found; the page is in" in result.stderr
