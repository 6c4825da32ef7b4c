"""The API pages: every public name has one entry, a summary in tables, and is reached by links."""

import collections
import importlib.util
import inspect
import posixpath
import re
import sys
from typing import Any

from tests.test_docs import DOCS, public_names, read, resolve


def load(name: str) -> Any:
    """A module of the documentation, which is no package."""
    spec = importlib.util.spec_from_file_location(name, DOCS / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


api_pages = load("api_pages")
API_PAGES = sorted((DOCS / "api").rglob("*.md"))


def entries() -> list[tuple[str, str, object]]:
    """Page, dotted name and object of each entry of the API pages."""
    return [
        (block.page, f"{block.module}.{name}", api_pages.find(block.module, name))
        for block in api_pages.blocks()
        for name in block.names
    ]


def test_every_public_name_of_a_package_has_its_entry_on_one_api_page() -> None:
    """In a block of the package, or of one from which it has the name."""
    assert [name for name, count in collections.Counter(name for _, name, _ in entries()).items() if count > 1] == []
    there = {id(thing) for _, _, thing in entries()}
    packages = {block.module for block in api_pages.blocks() if api_pages.is_package(block.module)}
    assert len(packages) >= 18
    missing = [
        f"{package}.{name}"
        for package in sorted(packages)
        for name in api_pages.public_names(package)
        if id(resolve(f"{package}.{name}")) not in there
    ]
    assert missing == [], "write them into an {entries} block of a page below docs/api"


def test_every_package_that_users_reach_has_a_page() -> None:
    reached = {thing.__name__ for name in public_names() if inspect.ismodule(thing := resolve(f"liehom.{name}"))}
    about = {api_pages.page_module(page.relative_to(DOCS).with_suffix("").as_posix()) for page in API_PAGES}
    assert reached - about - {block.module for block in api_pages.blocks()} == {"liehom.base.errors"}


def test_entries_stand_on_one_page_of_their_package_and_have_a_summary() -> None:
    pages = collections.defaultdict(set)
    for page, name, _ in entries():
        module, _, last = name.rpartition(".")
        if inspect.isclass(resolve(module)):
            module, _, owner = module.rpartition(".")
            last = f"{owner}.{last}"
        assert len(api_pages.summary(module, last)) > 10, name
        pages[module].add(page.split("/")[1])
    assert {module for module, found in pages.items() if len(found - {"typing"}) > 1} == set()


def test_every_api_page_begins_with_its_purpose_and_a_table() -> None:
    assert len(API_PAGES) >= 55
    for page in API_PAGES:
        text = page.read_text(encoding="utf-8")
        title, purpose, *_ = text.split("\n\n")
        assert re.fullmatch(r"# .+", title), page
        assert re.match(r"[A-Z`]", purpose), page
        assert api_pages.BLOCK.search(text), page


def test_every_page_of_the_api_is_in_one_list_of_contents() -> None:
    listed = [
        posixpath.normpath(f"{page.parent.relative_to(DOCS).as_posix()}/{name}")
        for page in API_PAGES
        for match in api_pages.BLOCK.finditer(page.read_text(encoding="utf-8"))
        if match[1] in ("pages", "summary")
        for name in match[3].split()
    ]
    there = {page.relative_to(DOCS).with_suffix("").as_posix() for page in API_PAGES}
    assert sorted(listed) == sorted(there - {"api/index"} | {"errors"})


def test_methods_of_a_class_whose_entry_is_divided_are_all_listed() -> None:
    """The entry of a class shows the methods that no block names; a divided class leaves none to chance."""
    for module, cls in (("liehom.exact.algebra", "LieAlgebra"), ("liehom.exact.representations", "Representation")):
        assert set(api_pages.placed(module, cls)) == set(api_pages.member_names(api_pages.find(module, cls)))
        tables = "\n".join(api_pages.members(module, cls, str))
        assert all(f"<{module}.{cls}.{name}>" in tables for name in api_pages.placed(module, cls))


def test_blocks_are_written_out_with_links_and_summaries() -> None:
    made = api_pages.expand("api/pauli", "# P\n\n```{entries} liehom.exact.pauli\nclosure PauliSums\n```\n", str)
    assert ":py:obj:`closure <liehom.exact.pauli.closure>`" in made
    assert api_pages.summary("liehom.exact.pauli", "closure") in made
    assert ".. autofunction:: liehom.exact.pauli.closure" in made
    assert ".. autoclass:: liehom.exact.pauli.PauliSums" in made
    above = api_pages.expand("api/algebra", read("docs", "api", "algebra.md"), str)
    assert ":py:obj:`so <liehom.exact.algebra.so>`" in above and "autofunction" not in above
    top = api_pages.expand("api/top-level", read("docs", "api", "top-level.md"), str)
    for name in public_names():
        thing = resolve(f"liehom.{name}")
        assert inspect.ismodule(thing) or f":py:obj:`lh.{name} <" in top, name
    assert len(re.findall(r":py:obj:`lh\.", top)) == sum(
        not inspect.ismodule(resolve(f"liehom.{n}")) for n in public_names()
    )
