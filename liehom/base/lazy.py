"""Packages whose names are loaded when they are first used; the stub `__init__.pyi` lists them, once."""

from __future__ import annotations

import ast
import importlib
import re
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path


@cache
def stub_names(stub: Path) -> dict[str, tuple[str, str]]:
    """For each name that a stub imports, the module to import it from and its name there."""
    imports = [node for node in ast.parse(stub.read_text(encoding="utf-8")).body if isinstance(node, ast.ImportFrom)]
    return {alias.asname or alias.name: (str(node.module), alias.name) for node in imports for alias in node.names}


def names(package: str) -> dict[str, tuple[str, str]]:
    """The names of a package, by its stub."""
    return stub_names(Path(str(sys.modules[package].__file__)).with_suffix(".pyi"))


def lazy(
    package: str, hint: Callable[[str], str] = lambda name: ""
) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    """The functions `__getattr__` and `__dir__` of a package; `hint` ends the message about a name that it lacks."""

    def load(name: str) -> object:
        if name == "__all__":
            return sorted(names(package))
        if name not in names(package):
            raise AttributeError(f"module {package!r} has no attribute {name!r}{hint(name)}")
        module, attribute = names(package)[name]
        loaded = importlib.import_module(module)
        if module != package and hasattr(loaded, attribute):
            value: object = getattr(loaded, attribute)
        else:
            value = importlib.import_module(f"{module}.{attribute}")
        setattr(sys.modules[package], name, value)
        return value

    def listing() -> list[str]:
        return sorted({name for name in vars(sys.modules[package]) if name.startswith("__")} | names(package).keys())

    return load, listing


def lazy_modules(package: str) -> Callable[[str], object]:
    """The function `__getattr__` of a package whose modules load when they are first used."""

    def load(name: str) -> object:
        try:
            return importlib.import_module(f"{package}.{name}")
        except ModuleNotFoundError as error:
            if error.name != f"{package}.{name}":
                raise
            raise AttributeError(f"module {package!r} has no attribute {name!r}") from None

    return load


def place_of(name: str) -> str:
    """Where a name that is not at the top level may be, for the end of a message; "" for the names of protocols."""
    from difflib import get_close_matches

    if name.startswith("_"):
        return ""
    modules = names("liehom")
    for module, (parent, last) in modules.items():
        folder = Path(__file__).parents[1].joinpath(*parent.split(".")[1:], last)
        stub, file = folder / "__init__.pyi", folder.with_suffix(".py")
        text = file.read_text(encoding="utf-8") if file.exists() else ""
        defined = re.search(rf'^(class |def |    "){name}\b', text, re.MULTILINE)
        if defined or (stub.exists() and name in stub_names(stub)):
            return f"; it is in liehom.{module}: from liehom import {module}"
    near = get_close_matches(name, modules, n=1, cutoff=0.75)
    return f"; did you mean {near[0]!r}?" if near else ""


class Module:
    """A module that is imported when a name of it is first used."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, name: str) -> object:
        value: object = getattr(importlib.import_module(self._name), name)
        setattr(self, name, value)
        return value
