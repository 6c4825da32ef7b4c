"""`liehom atlas`: the families, a build, and a search in its file."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from liehom.cli.app import app
from liehom.studies.atlas.all_families import FAMILIES
from liehom.studies.atlas.subalgebras import parabolic_pairs
from liehom.studies.atlas.symmetric import group_pairs

RUN = CliRunner()


@pytest.fixture(autouse=True, scope="module")
def small_families() -> Iterator[None]:
    saved = dict(FAMILIES)
    FAMILIES.clear()
    FAMILIES.update({"group": lambda: group_pairs(2), "parabolic": lambda: parabolic_pairs(8)})
    yield
    FAMILIES.clear()
    FAMILIES.update(saved)


def test_families_are_listed_with_their_numbers_of_pairs() -> None:
    counts = json.loads(RUN.invoke(app, ["atlas", "families", "--json"]).stdout)
    assert counts == {"group": sum(1 for _ in group_pairs(2)), "parabolic": 6}


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("atlas")
    words = ["atlas", "build", str(folder / "atlas.jsonl"), "--family", "group", "--store", str(folder / "store")]
    done = RUN.invoke(app, [*words, "--table", str(folder / "atlas.json")])
    assert done.exit_code == 0, done.output
    assert done.stdout.splitlines()[0].startswith("family  pairs  full")
    return folder


def test_a_second_build_takes_the_entries_from_the_store(built: Path) -> None:
    words = [
        "atlas",
        "build",
        str(built / "atlas.jsonl"),
        "--family",
        "group",
        "--store",
        str(built / "store"),
        "--json",
    ]
    assert RUN.invoke(app, words).exit_code == 2, "the file exists"
    done = RUN.invoke(app, [*words, "--force"])
    assert json.loads(done.stdout) == json.loads((built / "atlas.json").read_text(encoding="utf-8"))["counts"]


def test_rows_are_filtered(built: Path) -> None:
    words = ["atlas", "show", str(built / "atlas.jsonl"), "--json"]

    def shown(*options: str) -> list[str]:
        return [entry["name"] for entry in json.loads(RUN.invoke(app, [*words, *options]).stdout)["entries"]]

    everything = shown()
    assert set(shown("--full")) | set(shown("--not-full")) == set(everything)
    assert shown("--full") == ["so(3)+so(3)/diagonal"]
    assert shown("--search", "G2") == [name for name in everything if "g2" in name]
    assert shown("--family", "parabolic") == []
    assert "dim g/h" in RUN.invoke(app, words[:-1]).stdout


@pytest.mark.parametrize(
    "content", [b"[]\n", b"\xff\xfe\n", b"[" * 100_000, b"{}", b'{"name": 1, "verdict": null}', None]
)
def test_a_file_of_something_else_is_refused_in_one_line(tmp_path: Path, content: bytes | None) -> None:
    if content is not None:
        (tmp_path / "other.jsonl").write_bytes(content)
    done = RUN.invoke(app, ["atlas", "show", str(tmp_path / "other.jsonl")])
    assert done.exit_code == 2
    assert done.stderr.count("\n") == 1
    assert "other.jsonl" in done.stderr


def test_a_folder_is_no_file_of_entries(tmp_path: Path) -> None:
    assert RUN.invoke(app, ["atlas", "show", str(tmp_path)]).exit_code == 2


@pytest.mark.parametrize("options", [["--letter", "Z"], ["--letter", "ab"], ["--family", "nofamily"]])
def test_an_option_that_no_pair_has_is_refused(built: Path, options: list[str]) -> None:
    done = RUN.invoke(app, ["atlas", "show", str(built / "atlas.jsonl"), *options])
    assert done.exit_code == 2
    assert "expected one of" in done.stderr


def test_malformed_facts_are_refused(built: Path, tmp_path: Path) -> None:
    lines = (built / "atlas.jsonl").read_text(encoding="utf-8").splitlines()
    entry = next(made for made in map(json.loads, lines) if made["verdict"]["full"])
    entry["facts"]["key"] = -1
    (tmp_path / "other.jsonl").write_text(json.dumps(entry) + "\n", encoding="utf-8")
    assert RUN.invoke(app, ["atlas", "show", str(tmp_path / "other.jsonl")]).exit_code == 2


@pytest.mark.parametrize(("undecided", "code"), [((0, 0), 0), ((0, 1), 1), ((2, 0), 1)])
def test_the_exit_code_of_a_build_says_whether_pairs_are_undecided(
    undecided: tuple[int, int], code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    counts = {name: {"pairs": 3, "undecided": n} for name, n in zip("ab", undecided, strict=True)}
    monkeypatch.setattr("liehom.studies.atlas.write_entries", lambda *_: {"counts": counts})
    done = RUN.invoke(app, ["atlas", "build", str(tmp_path / "atlas.jsonl"), "--family", "group", "--json"])
    assert done.exit_code == code and json.loads(done.stdout) == counts
