"""What README and docs promise: names exist, examples run, files parse, public names are explained."""

import ast
import contextlib
import doctest
import importlib
import inspect
import io
import json
import logging
import re
import shlex
import subprocess
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
PACKAGE = Path(str(importlib.import_module("liehom").__file__)).parent
MAPPED = ("paper-map.md", "notation.md")
BUILTIN = {"ArithmeticError", "AttributeError", "TypeError", "ValueError"}


@pytest.fixture(autouse=True)
def quiet_loggers() -> Iterator[None]:
    """Pages switch the log on. Tests behind them run without it, since a message calls the code that formats it."""
    yield
    for name in ("liehom", *(name for name in logging.root.manager.loggerDict if name.startswith("liehom."))):
        logging.getLogger(name).setLevel(logging.NOTSET)


def read(*parts: str) -> str:
    return ROOT.joinpath(*parts).read_text(encoding="utf-8")


def blocks(text: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)


def resolve(dotted: str) -> Any:
    """The object behind a dotted name: attributes first."""
    first, *rest = dotted.split(".")
    found: Any = importlib.import_module(first)
    for length, name in enumerate(rest, 2):
        if not hasattr(found, name):
            with contextlib.suppress(ModuleNotFoundError):
                importlib.import_module(".".join(dotted.split(".")[:length]))
        found = getattr(found, name)
    return found


def dotted_names() -> list[str]:
    names = {name for page in MAPPED for name in re.findall(r"`(liehom(?:\.\w+)+)`", read("docs", page))}
    return sorted(names)


@pytest.mark.parametrize("name", dotted_names())
def test_name_in_the_paper_map_or_the_notation_exists(name: str) -> None:
    assert resolve(name) is not None


def test_resolving_a_name_that_does_not_exist_fails() -> None:
    with pytest.raises(AttributeError):
        resolve("liehom.base.errors.NoSuchThing")


@pytest.mark.parametrize("path", sorted(set(re.findall(r"`(tests/[^`]+)`", read("docs", "paper-map.md")))))
def test_test_in_the_paper_map_exists(path: str) -> None:
    file, _, function = path.partition("::")
    assert (ROOT / file).is_file()
    assert f"def {function}" in read(file)


@pytest.mark.parametrize("name", sorted(set(re.findall(r"`(\w+Error)`", read("docs", "errors.md"))) - BUILTIN))
def test_error_in_the_table_exists(name: str) -> None:
    assert issubclass(resolve(f"liehom.base.errors.{name}"), resolve("liehom.base.errors.LiehomError"))


def test_readme_begins_with_two_commands_of_one_line() -> None:
    demo, tests = blocks(read("README.md"), "sh")[:2]
    for command in (demo, tests):
        assert command.count("\n") == 1
        assert command.startswith("python3 -m venv ")
    assert "'.[plot]'" in demo
    assert demo.rstrip().endswith("liehom demo")
    assert "'.[test]'" in tests
    assert "pytest" in tests


def test_the_picture_of_the_readme_has_both_versions() -> None:
    shown = re.findall(r'(?:src|srcset)="([^"]+)"', read("README.md"))
    assert [Path(file).stem.rpartition("_")[2] for file in shown] == ["dark", "light"]
    assert all((ROOT / file).is_file() for file in shown)


def test_the_picture_of_the_readme_shows_what_its_caption_says(monkeypatch: pytest.MonkeyPatch) -> None:
    """Energies along the drawn orbits: Euler's step loses them, the corrected step does not."""
    import numpy as np

    import liehom as lh

    monkeypatch.syspath_prepend(str(DOCS))
    orbits = importlib.import_module("pictures.orbits")
    drift = {}
    for step in (lh.Euler(), lh.Corrected(lh.Euler(), order=4)):
        y = lh.integrate(orbits.FIELD, (0, 30), orbits.STARTS, step=step, dt=0.25).y
        drift[step.order] = np.ptp(np.sum(y**2 / np.array([1.0, 2.0, 3.0])[:, None], axis=1), axis=-1)
    assert drift[1].min() > 0.05
    assert drift[4].max() < 1e-3


def test_links_of_the_readme_lead_to_files() -> None:
    links = re.findall(r"\]\(([^)#]+)\)", read("README.md"))
    assert links
    assert [link for link in links if not (ROOT / link).is_file()] == []


def test_the_gate_runs_the_command_of_the_readme() -> None:
    gate = read(".ci", "run")
    assert "README.md" in gate
    assert "pytest" not in gate, "the gate extracts the command; a second copy would drift"


def expected_value(line: str) -> str | None:
    """The Python literal that a trailing comment begins with, if it does: `# True, or ...` promises True."""
    comment = line.rpartition("#")[2] if "#" in line else ""
    promised = re.split(r"[,:]", comment.strip())[0]
    try:
        ast.literal_eval(promised)
    except (SyntaxError, ValueError):
        return None
    return promised


def run_block(block: str, namespace: dict[str, Any], shown: str = "") -> int:
    """Execute a block, compare values with the comments behind them and prints with `shown`; how many were compared."""
    compared, everything = 0, ""
    lines = block.splitlines()
    for statement in ast.parse(block).body:
        source = textwrap.dedent("\n".join(lines[statement.lineno - 1 : statement.end_lineno]))
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            if isinstance(statement, ast.Expr):
                value = eval(source, namespace)
            else:
                exec(source, namespace)
        everything += printed.getvalue()
        if not isinstance(statement, ast.Expr):
            continue
        promised = expected_value(lines[(statement.end_lineno or statement.lineno) - 1])
        if promised is not None:
            assert (printed.getvalue().strip() or repr(value)) == promised, source
            compared += 1
    if shown:
        assert doctest.OutputChecker().check_output(shown, everything.rstrip() + "\n", doctest.ELLIPSIS), everything
    return compared + bool(shown)


def pages_with(language: str) -> list[str]:
    pages = [ROOT / "README.md", *sorted(DOCS.rglob("*.md"))]
    shown = [path for path in pages if "_build" not in path.parts and blocks(path.read_text("utf-8"), language)]
    return [str(path.relative_to(ROOT)) for path in shown]


@pytest.mark.parametrize("page", pages_with("python"))
def test_python_on_the_page_runs_and_gives_what_it_says(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # pages write files
    namespace: dict[str, Any] = {}
    printing = r"^```python\n(.*?)^```(?:\n+```text\n(.*?)^```)?"  # a text block right behind is what the block prints
    found = re.findall(printing, read(page), flags=re.MULTILINE | re.DOTALL)
    compared = sum(run_block(block, namespace, shown) for block, shown in found)
    assert compared >= {"README.md": 2, "docs/getting-started.md": 2}.get(page, 0)


def test_a_page_leaves_the_log_switched_off() -> None:
    assert not logging.getLogger("liehom.exact.fullness").isEnabledFor(logging.DEBUG)


@pytest.mark.parametrize("page", pages_with("pycon"))
def test_examples_on_the_page_print_what_they_show(page: str) -> None:
    source = "\n\n".join(blocks(read(page), "pycon"))
    examples = doctest.DocTestParser().get_doctest(source, {}, page, page, 0)
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS)
    assert runner.run(examples).failed == 0
    assert examples.examples


@pytest.mark.parametrize("page", pages_with("console"))
def test_commands_on_the_page_print_what_it_shows(page: str, tmp_path: Path) -> None:
    (tmp_path / "sphere.json").write_text(blocks(read("docs", "formats.md"), "json")[0], encoding="utf-8")
    for block in blocks(read(page), "console"):
        for command, shown in re.findall(r"^\$ liehom (.*)\n((?:(?!\$ ).*\n)*)", block, flags=re.MULTILINE):
            words = [sys.executable, "-m", "liehom", *shlex.split(command)]
            done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
            assert done.returncode in (0, 1, 3), done.stderr
            assert done.stdout + done.stderr == shown


def test_shell_lines_on_the_pages_name_commands_that_exist() -> None:
    from liehom.cli.app import app

    known = {command.name or getattr(command.callback, "__name__", "") for command in app.registered_commands}
    known |= {group.name or "" for group in app.registered_groups}
    known |= {str(group.name) for group in app.registered_groups}
    for page in pages_with("sh"):
        for block in blocks(read(page), "sh"):
            assert set(re.findall(r"(?:^|/)liehom (\w+)", block, flags=re.MULTILINE)) <= known


def test_the_page_of_the_catalogue_lists_its_names() -> None:
    import liehom as lh

    listed = blocks(read("docs", "catalogue.md"), "text")[-1].split()
    assert sorted(listed) == sorted(lh.catalog.pair_names())


def examples_of_the_catalogue(heading: str) -> list[str]:
    section = read("docs", "catalogue.md").split(f"## {heading}")[1].split("##")[0]
    return re.findall(r"\| `([^`]+)` \|$", section, flags=re.MULTILINE)


def test_the_examples_in_the_tables_of_the_catalogue_are_built() -> None:
    import liehom as lh

    linear, pairs = examples_of_the_catalogue("Linear Lie algebras"), examples_of_the_catalogue("Pairs")
    assert len(linear) >= 16
    assert len(pairs) >= 10
    for name in linear:
        assert lh.catalog.representation(name).name == name
    for name in pairs:
        assert lh.pair(name).name == name


@pytest.mark.parametrize("page", ["README.md", "docs/formats.md"])
def test_json_on_the_page_is_read_and_is_full(page: str, tmp_path: Path) -> None:
    import liehom as lh

    pairs = []
    for number, block in enumerate(blocks(read(page), "json")):
        data = json.loads(block)
        if "structure_constants" in data or "point" in data:
            file = tmp_path / f"{number}.json"
            file.write_text(block, encoding="utf-8")
            pairs.append(lh.load(file))
        elif data.get("format") == "liehom-certificate":
            assert lh.verify_certificate(pairs[0], data)
    assert pairs
    assert all(lh.decide_fullness(pair).full for pair in pairs)


def public_names() -> list[str]:
    """The names of the top level, by its stub."""
    from liehom.base.lazy import names

    return sorted(names("liehom"))


def test_there_are_public_names() -> None:
    import liehom

    assert {"LieAlgebra", "Pair", "decide_fullness", "verify_certificate"} <= set(public_names())
    assert all(hasattr(liehom, name) for name in public_names())


@pytest.mark.parametrize("page", ["tasks", "which-step", "coming-from", "faq", "glossary"])
def test_names_in_tables_and_answers_exist(page: str) -> None:
    names = set(re.findall(r"\blh\.((?:[a-zA-Z]\w*\.)*[a-zA-Z]\w*)", read("docs", f"{page}.md")))
    assert names
    for name in names:
        assert resolve(f"liehom.{name}") is not None


def test_names_of_methods_in_the_list_of_tasks_exist() -> None:
    import liehom as lh

    owners = {"g": lh.LieAlgebra, "rho": lh.Representation, "verdict": lh.fullness.NotFull}
    found = re.findall(r"`(g|rho|verdict)\.(\w+)", read("docs", "tasks.md"))
    assert {owner for owner, _ in found} == set(owners)
    assert [f"{o}.{name}" for o, name in found if not hasattr(owners[o], name) and name != "certificate"] == []


def test_public_names_are_explained_with_an_example() -> None:
    """Modules are explained by their contents, exceptions by the sentence that says when they are raised."""
    import liehom

    missing = []
    for name in public_names():
        thing = getattr(liehom, name)
        doc = inspect.getdoc(thing) or ""
        is_exempt = inspect.ismodule(thing) or (inspect.isclass(thing) and issubclass(thing, Exception))
        if not doc or (not is_exempt and not re.search(r"^Examples?:?$", doc, flags=re.MULTILINE)):
            missing.append(name)
    assert not missing, f"no docstring with an Examples section: {missing}"
