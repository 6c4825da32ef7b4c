"""Examples of docstrings with the imports that they need, so that pages show examples that can be pasted.

A docstring uses the names of its module, as `doctest` runs it there. Its page starts the first example with the imports
of these names from where users find them.
"""

from __future__ import annotations

import ast
import builtins
import doctest
import sys
from collections.abc import Iterator
from types import ModuleType
from typing import Any

PARSER = doctest.DocTestParser()
KNOWN = {"__name__", "__file__", "_", *dir(builtins)}


def undefined(program: str) -> set[str]:
    """The names that a program reads and defines nowhere."""
    tree = ast.parse(program)
    defined, used, lazy = set(KNOWN), set(), set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Name):
            (used if isinstance(node.ctx, ast.Load) else defined).add(node.id)
        elif isinstance(node, ast.alias):
            defined.add(node.asname or node.name.partition(".")[0])
        else:
            defined |= {found for found in (getattr(node, "name", None), getattr(node, "arg", None)) if found}
        for note in (getattr(node, "annotation", None), getattr(node, "returns", None)):
            lazy |= {part.id for part in ast.walk(note) if isinstance(part, ast.Name)} if note else set()
    return used - defined - (lazy if "from __future__ import annotations" in program else set())


def origin(name: str, module: ModuleType) -> str:
    """The statement that imports a name of a module: from the first package above it that has the same object."""
    value = getattr(module, name)
    if isinstance(value, ModuleType):
        return f"import {value.__name__}" + f" as {name}" * (value.__name__ != name)
    home = getattr(value, "__module__", None) or module.__name__
    parts = (home if home.startswith("liehom") and hasattr(sys.modules[home], name) else module.__name__).split(".")
    packages = (".".join(parts[: length + 1]) for length in range(len(parts)))
    package = next(package for package in packages if getattr(sys.modules[package], name, None) is value)
    return f"from {package} import {name}"


def imports(lines: list[str], module: ModuleType) -> Iterator[str]:
    """The statements that the examples in the lines of a docstring lack, those of one package together."""
    examples = PARSER.get_examples("\n".join(lines))
    missing = undefined("".join(example.source for example in examples)) if examples else set()
    found: dict[str, str] = {}
    for statement in sorted(origin(name, module) for name in missing if hasattr(module, name)):
        package, _, name = statement.rpartition(" import ")
        found[package or statement] = f"{found[package]}, {name}" if package in found else statement
    yield from found.values()


def complete(lines: list[str], thing: Any) -> None:
    """Put the imports that the examples of an object lack before the first of them."""
    first = next((i for i, line in enumerate(lines) if line.lstrip().startswith(">>> ")), None)
    module = (
        thing if isinstance(thing, ModuleType) else sys.modules.get(getattr(unwrapped(thing), "__module__", None) or "")
    )
    if first is not None and module is not None:
        indent = lines[first][: len(lines[first]) - len(lines[first].lstrip())]
        lines[first:first] = [f"{indent}>>> {statement}" for statement in imports(lines, module)]


def unwrapped(thing: Any) -> Any:
    """The function behind a property or a class method."""
    for attribute in ("fget", "func", "__func__"):
        thing = getattr(thing, attribute, None) or thing
    return thing
