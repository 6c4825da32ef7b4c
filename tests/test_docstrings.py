"""A page of the API makes a name public: only public names have docstrings with numpydoc sections."""

import ast
import functools
import inspect
import re
from collections.abc import Iterator
from pathlib import Path

import liehom
from tests.test_docs_api import api_pages, entries

PACKAGE = Path(liehom.__file__).resolve().parent
SECTIONS = re.compile(
    r"^\s*(Parameters|Other Parameters|Returns|Yields|Raises|Warns|See Also|Examples)\n\s*-{4,}$", re.MULTILINE
)


def unwrapped(thing: object) -> object:
    """The function of a method or property, and what a decorator wraps."""
    inner = getattr(thing, "__func__", None) or getattr(thing, "fget", None) or getattr(thing, "func", None) or thing
    return inspect.unwrap(inner) if callable(inner) else inner


@functools.cache
def public() -> frozenset[tuple[str, str]]:
    """The (module, qualified name) of every class, function and method that a page shows."""
    things: list[object] = []
    for _page, dotted, thing in entries():
        owner = api_pages.find("liehom", dotted.removeprefix("liehom.").rpartition(".")[0])
        name = dotted.rpartition(".")[2]
        things.append(inspect.getattr_static(owner, name) if inspect.isclass(owner) else thing)
        if inspect.isclass(thing):
            things += [inspect.getattr_static(thing, member) for member in api_pages.member_names(thing)]
    inner = map(unwrapped, things)
    return frozenset((str(getattr(x, "__module__", "")), str(getattr(x, "__qualname__", ""))) for x in inner)


def documented(node: ast.AST, qualified: str = "") -> Iterator[tuple[str, str]]:
    """All (qualified name, docstring) of the classes and functions below a node."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.ClassDef | ast.FunctionDef):
            name = f"{qualified}{child.name}"
            yield name, ast.get_docstring(child) or ""
            yield from documented(child, f"{name}." if isinstance(child, ast.ClassDef) else f"{name}.<locals>.")
        else:
            yield from documented(child, qualified)


def test_inner_names_have_no_sections() -> None:
    wrong = []
    for path in sorted(PACKAGE.rglob("*.py")):
        if PACKAGE / "examples" in path.parents:
            continue
        module = ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")
        tree = ast.parse(path.read_text(encoding="utf-8"))
        wrong += [
            f"{module}.{name}"
            for name, text in documented(tree)
            if SECTIONS.search(text) and (module, name) not in public()
        ]
    assert not wrong, f"on no page of docs/api, so a sentence will do: {wrong}"


def test_public_functions_of_packages_have_examples_that_run() -> None:
    missing = [
        f"{block.module}.{name}"
        for block in api_pages.blocks()
        for name in block.names
        if inspect.isroutine(thing := api_pages.find(block.module, name))
        and "." not in name
        and api_pages.is_package(block.module)
        and ">>>" not in (inspect.getdoc(thing) or "")
    ]
    assert not missing


def test_sections_are_found() -> None:
    """A control."""
    assert SECTIONS.search("Sum.\n\nParameters\n----------\nx : int")
    assert not SECTIONS.search("Sum.\n\nNotes\n-----\nParameters of the form are not read.")
    assert ("liehom.exact.fullness.decide", "decide_fullness") in public()
