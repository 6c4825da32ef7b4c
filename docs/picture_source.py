"""The program that draws a picture of docs/pictures: its function, and what it uses of its module, as one script."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Callable
from typing import Any

COMPOUND = (ast.For, ast.While, ast.If, ast.With, ast.Try, ast.FunctionDef, ast.ClassDef)
IMPORTS = (ast.Import, ast.ImportFrom)


def names(node: ast.AST) -> set[str]:
    """The names in a piece of code, without those of annotations."""
    found = {node.id} if isinstance(node, ast.Name) else set()
    for field, value in ast.iter_fields(node):
        if field not in ("annotation", "returns", "decorator_list"):
            children = value if isinstance(value, list) else [value]
            found = found.union(*(names(child) for child in children if isinstance(child, ast.AST)))
    return found


def annotated(node: ast.AST) -> bool:
    """Whether a piece of code has annotations, the names of which need not be defined."""
    parts = (getattr(part, field, None) for part in ast.walk(node) for field in ("annotation", "returns"))
    return any(part is not None for part in parts)


def bound(node: ast.stmt) -> set[str]:
    """The names that a statement of a module defines."""
    if isinstance(node, IMPORTS):
        return {alias.asname or alias.name.partition(".")[0] for alias in node.names}
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return {node.name}
    targets = node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
    return {name for target in targets for name in names(target)}


def needed(tree: ast.Module, wanted: set[str]) -> list[ast.stmt]:
    """The statements of a module, in its order, that define the wanted names and the names used there."""
    owner = {name: node for node in tree.body for name in bound(node)}
    used: set[ast.stmt] = set()
    todo = set(wanted)
    while todo:
        node = owner.get(todo.pop())
        if node is not None and node not in used:
            used.add(node)
            todo |= set() if isinstance(node, IMPORTS) else names(node)
    return [node for node in tree.body if node in used]


def imported(nodes: list[ast.stmt], used: set[str], more: str) -> list[str]:
    """The imports of used names, sorted, those of liehom.plotting.canvas together with `more`."""
    canvas = ast.parse(f"from liehom.plotting.canvas import {more}").body[0]
    lines = ["import matplotlib"]
    for node in nodes:
        if isinstance(node, IMPORTS):
            node.names = [alias for alias in node.names if (alias.asname or alias.name.partition(".")[0]) in used]
            lines.append(ast.unparse(node))
            if isinstance(node, ast.ImportFrom) and isinstance(canvas, ast.ImportFrom) and node.module == canvas.module:
                canvas.names += node.names
                lines.pop()
    return [*sorted(lines), ast.unparse(canvas) + "\n"]


def text(lines: list[str], node: ast.stmt) -> str:
    """The lines of a statement and the comments above it, so that it can be pasted: an empty line ends it."""
    first = node.lineno - 1
    while lines[first - 1].lstrip().startswith("#"):
        first -= 1
    shown = inspect.cleandoc("\n" + "\n".join(lines[first : node.end_lineno])).split("\n")
    shown = "\n".join(line for line in shown if line.strip())
    return "\n" * isinstance(node, ast.FunctionDef) + shown + "\n" * isinstance(node, COMPOUND)


def script(function: Callable[..., Any]) -> str:
    """The program that draws the light version of a picture and writes it to a file in the current folder."""
    lines = inspect.getsource(inspect.getmodule(function)).split("\n")
    tree = ast.parse("\n".join(lines))
    here = next(node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == function.__name__)
    *body, last = here.body[1:] if ast.get_docstring(here) else here.body
    if not isinstance(last, ast.Return) or last.value is None:
        raise ValueError(f"the picture {here.name} must end with the return of its figure")
    defined = needed(tree, names(here))
    used = names(here).union(*(names(node) for node in defined if not isinstance(node, IMPORTS)))
    program = [
        *["from __future__ import annotations\n"] * any(map(annotated, [*defined, *body])),
        *imported(defined, used, "STYLE, COLOURS as colours" if "colours" in used else "STYLE"),
        "matplotlib.rcParams.update(STYLE)",
        *(text(lines, node) for node in [*defined, *body] if not isinstance(node, IMPORTS)),
        *[f"figure = {ast.unparse(last.value)}"] * (ast.unparse(last.value) != "figure"),
        f'figure.savefig("{here.name}.svg")',
    ]
    return "\n".join(program) + "\n"
