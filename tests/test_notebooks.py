"""The notebooks of the docs as they are stored: valid, without outputs, and with names that exist.

They are executed by the build of the documentation, in which a cell that fails or warns fails the build.
"""

import ast
import builtins
import importlib
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import liehom as lh

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
EVERY = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)


def code_cells(path: Path) -> list[dict[str, Any]]:
    found = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return [cell for cell in found if cell["cell_type"] == "code"]


def cells(path: Path, kind: str) -> list[str]:
    found = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return ["".join(cell["source"]) for cell in found if cell["cell_type"] == kind]


def outputs(notebook: Any) -> list[Any]:
    """Outputs and execution counts of the code cells."""
    code = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    return [cell for cell in code if cell["outputs"] or cell["execution_count"] is not None]


def missing(source: str) -> list[str]:
    """Names that code loads and nobody binds, and attributes of modules of liehom that do not exist."""
    tree = ast.parse(source)
    nodes = list(ast.walk(tree))
    names = [node for node in nodes if isinstance(node, ast.Name)]
    bound = {name.id for name in names if not isinstance(name.ctx, ast.Load)} | set(dir(builtins))
    for node in nodes:
        if isinstance(node, ast.alias):
            bound.add((node.asname or node.name).partition(".")[0])
        elif isinstance(node, ast.arg):
            bound.add(node.arg)
        elif isinstance(node, ast.FunctionDef):
            bound.add(node.name)
    return [name.id for name in names if name.id not in bound] + [name for name in chains(nodes) if not exists(name)]


def chains(nodes: list[ast.AST]) -> Iterator[str]:
    """Dotted names that begin with lh, and names imported from liehom."""
    for node in nodes:
        if isinstance(node, ast.Attribute) and re.fullmatch(r"lh(\.\w+)+", ast.unparse(node)):
            yield ast.unparse(node).partition(".")[2]
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("liehom."):
            yield from (f"{node.module}.{alias.name}".partition(".")[2] for alias in node.names)


def exists(dotted: str) -> bool:
    found: Any = lh
    for name in dotted.split("."):
        if not hasattr(found, name):
            return False
        found = getattr(found, name)
    return True


def test_there_are_notebooks_and_the_page_lists_them() -> None:
    page = (FOLDER / "index.md").read_text(encoding="utf-8")
    assert len(NOTEBOOKS) >= 5
    assert {path.name for path in NOTEBOOKS} == set(re.findall(r"\]\(([\w-]+\.ipynb)\)", page))


@EVERY
def test_a_notebook_is_valid_and_holds_no_outputs(path: Path) -> None:
    nbformat = importlib.import_module("nbformat")
    notebook = nbformat.read(path, as_version=nbformat.NO_CONVERT)
    nbformat.validate(notebook)
    assert not outputs(notebook), "clear the outputs: the build of the pages makes them again"
    assert notebook["metadata"]["kernelspec"]["name"] == "python3"


@EVERY
def test_names_in_a_notebook_exist(path: Path) -> None:
    assert missing("\n".join(cells(path, "code"))) == []


@EVERY
def test_a_notebook_begins_with_its_question_and_ends_with_links_to_files(path: Path) -> None:
    text = cells(path, "markdown")
    assert text[0].startswith("# ")
    assert "?" in text[0]
    assert text[-1].startswith("## Where next")
    links = [link for cell in text for link in re.findall(r"\]\(([^)]+)\)", cell)]
    assert len(links) >= 3
    assert [link for link in links if not (FOLDER / link).is_file()] == []
    assert not [cell for cell in text if "[](" in cell], "Jupyter shows no link without a text"


@EVERY
def test_pictures_of_a_notebook_have_words(path: Path) -> None:
    drawing = [cell for cell in code_cells(path) if re.search(r"\.plot|plt\.", "".join(cell["source"]))]
    drawing = [cell for cell in drawing if "import matplotlib" not in "".join(cell["source"])]
    assert drawing
    assert [cell["source"] for cell in drawing if not cell["metadata"].get("mystnb", {})["image"]["alt"]] == []


def test_the_checks_find_outputs_and_names_that_do_not_exist() -> None:
    assert missing("import liehom as lh\nx = lh.so(3)\nprint([y for y in x])") == []
    assert missing("lh.so(3)") == ["lh"]
    assert missing("import liehom as lh\nlh.plotting.plot_nothing(lh.no_such_name)") == [
        "plotting.plot_nothing",
        "no_such_name",
    ]
    assert missing("from liehom.testing import no_such_name") == ["testing.no_such_name"]
    cell = {"cell_type": "code", "outputs": [], "execution_count": None}
    assert outputs({"cells": [cell]}) == []
    assert len(outputs({"cells": [cell | {"outputs": [1]}, cell | {"execution_count": 1}]})) == 2
