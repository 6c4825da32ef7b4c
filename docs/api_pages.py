"""Tables and entries of the API pages, written when the pages are read.

A page of docs/api names what it documents, in reading order; summaries and entries come from the docstrings.

    ```{entries} liehom.exact.algebra
    Subalgebra Homomorphism LieAlgebra.bracket
    ```

becomes a table with one row for each name, and below it the entries. Without names all public names of the module are
taken. Methods that are named (`LieAlgebra.bracket`) are left out of the entry of their class. Three more blocks make
tables only: `{summary} liehom.exact.algebra` for each page that it lists, below the page of the module, `{pages}` with
a row for each page that it lists, and `{names} liehom` for the top level.

The module needs no Sphinx, so that the tests read the pages by it too.
"""

from __future__ import annotations

import ast
import functools
import importlib
import inspect
import posixpath
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

FOLDER = Path(__file__).resolve().parent
BLOCK = re.compile(r"^```\{(entries|summary|pages|names)\} ?([\w.]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
MEMBERS_IN_A_TABLE = 4
"""A class with fewer members has no table of them."""


@dataclass(frozen=True)
class Block:
    """Entries of a page: the page without suffix, the heading above, the module, the names."""

    page: str
    title: str
    module: str
    names: tuple[str, ...]


def documented(thing: object) -> bool:
    return bool(inspect.getdoc(thing))


def member_names(cls: type) -> list[str]:
    """Public methods and properties with a docstring that the class or an inner base of it (_Base) defines."""
    kinds = (property, functools.cached_property, staticmethod, classmethod)
    inner = [base for base in cls.__mro__[1:] if base.__name__.startswith("_")]
    return [
        name
        for name, value in {name: vars(base)[name] for base in (cls, *inner) for name in vars(base)}.items()
        if not name.startswith("_")
        and (inspect.isfunction(value) or isinstance(value, kinds))
        and documented(getattr(cls, name))
    ]


def public_names(module: str) -> list[str]:
    """Names that the stub of a package lists, else `__all__`, else what a module defines, in the order of the file."""
    loaded = importlib.import_module(module)
    stub = Path(str(loaded.__file__)).with_suffix(".pyi")
    tree = ast.parse((stub if stub.is_file() else stub.with_suffix(".py")).read_text(encoding="utf-8"))
    listed: list[str] | None = None if stub.is_file() else getattr(loaded, "__all__", None)
    names: list[str] = []
    for node in tree.body:
        if isinstance(node, ast.ImportFrom) and stub.is_file():
            names += [alias.asname or alias.name for alias in node.names]
        elif isinstance(node, ast.ClassDef | ast.FunctionDef):
            names.append(node.name)
        elif isinstance(node, ast.AnnAssign | ast.Assign):
            target = node.target if isinstance(node, ast.AnnAssign) else node.targets[0]
            names += [target.id] if isinstance(target, ast.Name) and written(loaded, target.id) else []
    return [name for name in listed or dict.fromkeys(names) if not name.startswith("_")]


@functools.cache
def written(module: ModuleType, name: str) -> str:
    """The string below the assignment of a name, in the module or where the module has the name from; "" if none."""
    stub = Path(str(module.__file__)).with_suffix(".pyi")
    body = ast.parse(stub.read_text(encoding="utf-8") if stub.is_file() else inspect.getsource(module)).body
    for node, after in zip(body, [*body[1:], ast.Pass()], strict=True):
        if isinstance(node, ast.ImportFrom) and name in [alias.asname or alias.name for alias in node.names]:
            return written(importlib.import_module(str(node.module)), name)
        target = (
            node.target
            if isinstance(node, ast.AnnAssign)
            else node.targets[0]
            if isinstance(node, ast.Assign)
            else None
        )
        if isinstance(target, ast.Name) and target.id == name and isinstance(after, ast.Expr):
            return inspect.cleandoc(str(ast.literal_eval(after.value))) if isinstance(after.value, ast.Constant) else ""
    return ""


def find(module: str, name: str) -> Any:
    """The object of a dotted name."""
    return functools.reduce(getattr, name.split("."), importlib.import_module(module))


def directive(module: str, name: str) -> str:
    """The directive of autodoc for a name."""
    thing = find(module, name)
    owner, _, member = name.rpartition(".")
    if owner:
        static = inspect.getattr_static(find(module, owner), member)
        return "autoproperty" if isinstance(static, property | functools.cached_property) else "automethod"
    if inspect.isclass(thing):
        return "autoexception" if issubclass(thing, BaseException) else "autoclass"
    return "autofunction" if inspect.isroutine(thing) else "autodata"


def summary(module: str, name: str) -> str:
    """The first paragraph of a docstring, in one line."""
    text = written(importlib.import_module(module), name) if directive(module, name) == "autodata" else ""
    return " ".join((text or inspect.getdoc(find(module, name)) or "").split("\n\n")[0].split())


def order(folder: Path) -> Iterator[Path]:
    """The API pages, each followed by the pages that it lists."""
    for path in sorted((folder / "api").glob("*.md")):
        yield path
        for match in BLOCK.finditer(path.read_text(encoding="utf-8")):
            if match[1] == "summary":
                yield from (folder / "api" / f"{page}.md" for page in match[3].split())


@functools.cache
def blocks(folder: Path = FOLDER) -> tuple[Block, ...]:
    """All entries of docs/api, page after page."""
    listed = []
    for path in order(folder):
        text, page = path.read_text(encoding="utf-8"), path.relative_to(folder).with_suffix("").as_posix()
        for match in BLOCK.finditer(text):
            if match[1] == "entries":
                heading = re.findall(r"^#+ (.*)$", text[: match.start()], flags=re.MULTILINE)[-1]
                names = tuple(match[3].split()) or tuple(public_names(match[2]))
                listed.append(Block(page, heading, match[2], names))
    return tuple(listed)


def entries() -> Iterator[str]:
    """Dotted names of all entries, members of classes included."""
    for block in blocks():
        for name in block.names:
            yield f"{block.module}.{name}"
            if inspect.isclass(find(block.module, name)):
                yield from (f"{block.module}.{name}.{member}" for member in member_names(find(block.module, name)))


def type_aliases() -> dict[str, str]:
    """Names of types that signatures show in place of what they stand for, with their entries."""
    return {name: f"{block.module}.{name}" for block in blocks() if block.page == "api/typing" for name in block.names}


def placed(module: str, cls: str) -> dict[str, Block]:
    """The members of a class that have their entry on another page or in another block, with that block."""
    start = f"{cls}."
    return {
        name.removeprefix(start): block
        for block in blocks()
        for name in block.names
        if block.module == module and name.startswith(start)
    }


Escape = Callable[[str], str]


def table(rows: Iterable[tuple[str, str]], escape: Escape) -> Iterator[str]:
    """A table of rows (link, text)."""
    yield from (".. list-table::", "   :class: api-names", "   :widths: 30 70", "")
    for link, text in rows:
        yield from (f"   * - {link}", f"     - {escape(text)}")
    yield ""


def rows(module: str, names: Iterable[str]) -> Iterator[tuple[str, str]]:
    """For each name a link to its entry, and its summary."""
    for name in names:
        yield f":py:obj:`{name.rpartition('.')[2]} <{module}.{name}>`", summary(module, name)


def entry(module: str, name: str, escape: Escape) -> Iterator[str]:
    """The directive that makes the entry of a name."""
    text = written(importlib.import_module(module), name)
    own = re.search(rf"^{name}\b.*=", inspect.getsource(importlib.import_module(module)), flags=re.MULTILINE)
    if text and not own and directive(module, name) == "autodata":
        yield from (f".. py:data:: {name}", f"   :module: {module}", "")
        yield from (*(f"   {escape(line)}" for line in text.splitlines()), "")
        return
    yield f".. {directive(module, name)}:: {module}.{name}"
    if away := placed(module, name):
        yield f"   :exclude-members: {', '.join(away)}"
    yield ""


def members(module: str, cls: str, escape: Escape) -> Iterator[str]:
    """Tables of the members of a class, for the end of its docstring: one for each block that has their entries."""
    names, away = member_names(find(module, cls)), placed(module, cls)
    if len(names) < MEMBERS_IN_A_TABLE:
        return
    groups: dict[str, list[str]] = {}
    for name in [*away, *(name for name in names if name not in away)]:
        groups.setdefault(away[name].title if name in away else "Methods and properties", []).append(f"{cls}.{name}")
    for title, group in groups.items():
        yield from ("", f".. rubric:: {title}", "")
        yield from table(rows(module, group), escape)


def rst(lines: Iterable[str]) -> str:
    return "\n".join(["```{eval-rst}", *lines, "```", ""])


def title_and_purpose(page: str, folder: str) -> tuple[str, str]:
    """The title of a page and its first sentence, whose links are changed to start from another folder."""
    title, purpose = (FOLDER / f"{page}.md").read_text(encoding="utf-8").split("\n\n")[:2]
    sentence = re.split(r"(?<=\.)\s", purpose)[0].replace("\n", " ")
    here = posixpath.dirname(page)
    moved = re.sub(
        r"\]\(([\w./-]+\.md)", lambda link: "](" + posixpath.relpath(posixpath.join(here, link[1]), folder), sentence
    )
    return title.removeprefix("# "), moved


@functools.cache
def page_module(page: str) -> str:
    """The module that a page is about: that of its first block."""
    text = (FOLDER / f"{page}.md").read_text(encoding="utf-8")
    return match[2] if (match := BLOCK.search(text)) else "liehom.base.errors"


def is_package(module: str) -> bool:
    return hasattr(importlib.import_module(module), "__path__")


class Writer:
    """Writes the blocks of one page out.

    Parameters
    ----------
    page : str
        The page, without suffix, relative to the folder of the documentation.
    escape : function
        Makes one line of a docstring into reStructuredText.
    """

    def __init__(self, page: str, escape: Escape) -> None:
        self.page, self.folder, self.escape = page, page.rpartition("/")[0], escape
        self.declared: set[str] = set()

    def block(self, match: re.Match[str]) -> str:
        """The text that a block becomes; its kind names the method."""
        written_out: str = getattr(self, match[1])(match[2], match[3].split())
        return written_out

    def entries(self, module: str, names: list[str]) -> str:
        """A table and the entries; no table of one name, nor of methods that the class lists on this page."""
        names, lines = names or public_names(module), []
        if module not in self.declared and any(directive(module, name) != "autodata" for name in names):
            if self.folder == "api" or not is_package(module):
                self.declared.add(module)
            if not is_package(module):
                lines += [f".. automodule:: {module}", "   :no-members:", ""]
        owners = {name.rpartition(".")[0] for name in names}
        listed = [block.names for block in blocks() if block.page == self.page and block.module == module]
        if len(names) > 1 and not (owners != {""} and owners < {name for group in listed for name in group}):
            lines += table(rows(module, names), self.escape)
        for name in names:
            lines += entry(module, name, self.escape)
        return rst(lines)

    def summary(self, module: str, pages: list[str]) -> str:
        """For each page below this one its title, its first sentence and a table."""
        self.declared.add(module)
        parts = [self.contents(pages)]
        for page in pages:
            title, purpose = title_and_purpose(f"{self.folder}/{page}", self.folder)
            lines: list[str] = []
            for block in blocks():
                if block.page == f"{self.folder}/{page}":
                    lines += [] if block.title == title else [f".. rubric:: {block.title}", ""]
                    lines += table(rows(block.module, block.names), self.escape)
            parts.append(f"## [{title}]({page}.md)\n\n{purpose}\n\n{rst(lines)}")
        return "\n".join(parts)

    def pages(self, _: str, pages: list[str]) -> str:
        """A row for each page: title, module, and the first line of the module's docstring."""
        lines = []
        for page in pages:
            path = posixpath.normpath(f"{self.folder}/{page}")
            module = page_module(path)
            about = str(importlib.import_module(module).__doc__).splitlines()[0].removeprefix("liehom: ")
            title, _purpose = title_and_purpose(path, self.folder)
            lines.append((f":doc:`{title} </{path}>`", f"``{module}``: {about[0].lower()}{about[1:]}"))
        return self.contents(pages) + rst(table(lines, self.escape))

    def names(self, module: str, _: list[str]) -> str:
        """A row for each name of a package that is not a module; its entry is where its object has one."""
        places = {id(find(block.module, name)): f"{block.module}.{name}" for block in blocks() for name in block.names}
        self.declared.add(module)
        lines = []
        for name in sorted(public_names(module), key=str.lower):
            thing = find(module, name)
            is_error = isinstance(thing, type) and issubclass(thing, BaseException)
            place = f"liehom.base.errors.{name}" if is_error else places.get(id(thing), "")
            home, _, last = place.rpartition(".")
            if last == name:
                lines.append((f":py:obj:`lh.{name} <{place}>`", summary(home, last)))
        return rst(table(lines, self.escape))

    def contents(self, pages: Iterable[str]) -> str:
        return "\n".join(["```{toctree}", ":hidden:", "", *pages, "```", "", ""])


def expand(page: str, text: str, escape: Escape) -> str:
    """The text of a page with its blocks written out; below the title, targets for links to the packages."""
    writer = Writer(page, escape)
    whole = BLOCK.sub(writer.block, text)
    targets = [
        line for module in sorted(writer.declared) if is_package(module) for line in (f".. py:module:: {module}", "")
    ]
    title, rest = whole.split("\n", 1)
    return f"{title}\n\n{rst(targets)}{rest}" if targets else whole
