"""The API pages: every public name has one entry, a summary in tables, and is reached by links."""

from __future__ import annotations

import ast
import collections
import importlib
import importlib.util
import inspect
import posixpath
import re
import sys
from typing import Any

from tests.test_docs import DOCS, PACKAGE, public_names, read, resolve


def load(name: str) -> Any:
    """A module of the documentation, which is no package."""
    spec = importlib.util.spec_from_file_location(name, DOCS / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


api_pages = load("api_pages")


def entries() -> list[tuple[str, str, object]]:
    """Page, dotted name and object of each entry of the API pages."""
    return [
        (block.page, f"{block.module}.{name}", api_pages.find(block.module, name))
        for block in api_pages.blocks()
        for name in block.names
    ]


def exports(layer: str) -> list[str]:
    """What a package hands on: every `X as X` of its `__init__`, less what `__all__` leaves out."""
    tree = ast.parse((PACKAGE / layer / "__init__.py").read_text(encoding="utf-8"))
    imported = [alias.asname for node in tree.body if isinstance(node, ast.ImportFrom) for alias in node.names]
    names = [name for name in imported if name is not None and not name.startswith("_")]
    listed = getattr(importlib.import_module(f"liehom.{layer}"), "__all__", names)
    return [name for name in names if name in listed]


def test_every_public_name_of_a_layer_has_its_entry_on_one_api_page() -> None:
    """On a page of the layer, or of another layer from which it has the name."""
    seen = collections.Counter(name for _, name, _ in entries())
    assert [name for name, count in seen.items() if count > 1] == []
    there = {id(thing) for _, _, thing in entries()}
    layers = [
        path.parent.name
        for path in PACKAGE.glob("*/__init__.py")
        if (DOCS / "api" / f"{path.parent.name}.md").is_file()
    ]
    assert len(layers) >= 15
    missing = [
        f"liehom.{layer}.{name}"
        for layer in layers
        for name in exports(layer)
        if id(getattr(importlib.import_module(f"liehom.{layer}"), name)) not in there
    ]
    assert missing == [], "write them into an {entries} block of a page below docs/api"


def test_entries_stand_on_the_pages_of_their_package_and_have_a_summary() -> None:
    for page, name, _ in entries():
        assert page.split("/")[1] in (name.split(".")[1], "typing")
        module, _, last = name.rpartition(".")
        if inspect.isclass(resolve(module)):
            module, _, owner = module.rpartition(".")
            last = f"{owner}.{last}"
        assert len(api_pages.summary(module, last)) > 10, name


def test_every_api_page_begins_with_its_purpose_and_a_table() -> None:
    pages = sorted((DOCS / "api").rglob("*.md"))
    assert len(pages) >= 60
    for page in pages:
        text = page.read_text(encoding="utf-8")
        title, purpose, *_ = text.split("\n\n")
        assert re.fullmatch(r"# .+", title), page
        assert re.match(r"[A-Z`]", purpose), page
        assert api_pages.BLOCK.search(text), page


def test_every_page_of_the_api_is_in_one_list_of_contents() -> None:
    listed = [
        posixpath.normpath(f"{page.parent.relative_to(DOCS).as_posix()}/{name}")
        for page in (DOCS / "api").rglob("*.md")
        for match in api_pages.BLOCK.finditer(page.read_text(encoding="utf-8"))
        if match[1] in ("pages", "summary")
        for name in match[3].split()
    ]
    there = {page.relative_to(DOCS).with_suffix("").as_posix() for page in (DOCS / "api").rglob("*.md")}
    assert sorted(listed) == sorted(there - {"api/index"} | {"errors"})


def test_methods_of_a_class_whose_entry_is_divided_are_all_listed() -> None:
    """The entry of a class shows the methods that no block names; a divided class leaves none to chance."""
    for module, cls in (("liehom.algebra", "LieAlgebra"), ("liehom.representations", "Representation")):
        assert set(api_pages.placed(module, cls)) == set(api_pages.member_names(api_pages.find(module, cls)))
        tables = "\n".join(api_pages.members(module, cls, str))
        assert all(f"<{module}.{cls}.{name}>" in tables for name in api_pages.placed(module, cls))


def test_blocks_are_written_out_with_links_and_summaries() -> None:
    made = api_pages.expand("api/pauli", "# P\n\n```{entries} liehom.pauli\nclosure PauliSums\n```\n", str)
    assert ":py:obj:`closure <liehom.pauli.closure>`" in made
    assert api_pages.summary("liehom.pauli", "closure") in made
    assert ".. autofunction:: liehom.pauli.closure" in made
    assert ".. autoclass:: liehom.pauli.PauliSums" in made
    above = api_pages.expand("api/algebra", read("docs", "api", "algebra.md"), str)
    assert ":py:obj:`so <liehom.algebra.so>`" in above and "autofunction" not in above
    top = api_pages.expand("api/top-level", read("docs", "api", "top-level.md"), str)
    for name in public_names():
        thing = resolve(f"liehom.{name}")
        assert inspect.ismodule(thing) or f":py:obj:`lh.{name} <" in top, name
    assert len(re.findall(r":py:obj:`lh\.", top)) == sum(
        not inspect.ismodule(resolve(f"liehom.{n}")) for n in public_names()
    )
