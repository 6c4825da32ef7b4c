"""The architecture as a test: imports point downward, files and functions are short, nothing asserts."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "liehom"

# layer -> the layers directly below it; a layer may import whatever can be reached downward
BELOW: dict[str, tuple[str, ...]] = {
    "errors": (),
    "parallel": ("errors",),
    "scalars": ("errors",),
    "algebra": ("scalars",),
    "representations": ("algebra",),
    "tracing": ("errors",),
    "series": ("scalars", "tracing"),
    "homogeneous": ("representations", "series"),
    "fullness": ("homogeneous",),
    "correctors": ("homogeneous", "series"),
    "integrators": ("correctors", "parallel"),
    "instances": ("integrators",),
    "catalog": ("homogeneous",),
    "atlas": ("catalog", "fullness", "parallel"),
    "io": ("catalog", "fullness", "integrators"),
    "plotting": ("io",),
    "paper": ("plotting", "instances"),
    "testing": ("catalog", "fullness", "integrators", "io"),
    "cli": ("io", "atlas", "paper", "testing"),
    "__main__": ("cli",),
    "": ("cli",),  # liehom/__init__.py, which everybody below must leave alone
}

# libraries behind one door: only modules that start with one of these names may import them
DOORS: dict[str, tuple[str, ...]] = {
    "flint": ("liehom.scalars", "liehom.series"),  # series: recognises its numbers
    # points with symbols in them: linear algebra over a field of rational functions, by DomainMatrix
    "sympy.polys": ("liehom.scalars", "liehom.representations.symbolic"),
    "networkx": ("liehom.algebra",),
    "matplotlib": ("liehom.plotting", "liehom.paper"),
    "jax": ("liehom.integrators", "liehom.series", "liehom.tracing"),
    "numba": ("liehom.integrators",),
    "llvmlite": ("liehom.tracing",),
    "zarr": ("liehom.parallel",),
    "typer": ("liehom.cli",),
    "rich": ("liehom.cli", "liehom.integrators.progress"),
}

# what the independent checker of certificates may import of liehom
CHECKER = ("liehom.fullness.certificate", "liehom.fullness.verif", "liehom.fullness.check")
CHECKER_MAY_IMPORT = (*CHECKER, "liehom.scalars", "liehom.errors")

MAX_FILE_LINES = 450
MAX_FUNCTION_LINES = 60


@cache
def modules() -> dict[str, Path]:
    found = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


@cache
def tree(module: str) -> ast.Module:
    return ast.parse(modules()[module].read_text(encoding="utf-8"))


def layer(module: str) -> str:
    parts = module.split(".")
    return parts[1] if len(parts) > 1 else ""


@cache
def reachable(name: str) -> frozenset[str]:
    return frozenset({name}).union(*(reachable(below) for below in BELOW[name]))


def is_under(module: str, prefixes: tuple[str, ...]) -> bool:
    """Whether the dotted name begins with one of the prefixes (`liehom.cli` covers `liehom.cli_demo` too)."""
    return module.startswith(prefixes)


def base_of(module: str, node: ast.ImportFrom) -> str:
    """The absolute dotted name on the left of `import` in a from-import."""
    if node.level == 0:
        return node.module or ""
    package = module.split(".") if modules()[module].name == "__init__.py" else module.split(".")[:-1]
    package = package[: len(package) - node.level + 1]
    return ".".join([*package, node.module] if node.module else package)


def targets(module: str, node: ast.AST) -> Iterator[str]:
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    elif isinstance(node, ast.ImportFrom):
        base = base_of(module, node)
        for alias in node.names:
            dotted = f"{base}.{alias.name}"
            yield dotted if dotted in modules() or not base.startswith("liehom") else base


def is_type_checking(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)


def imports(module: str, *, typing: bool = True, local: bool = True) -> Iterator[tuple[str, int]]:
    """All (imported name, line); `typing`: those under TYPE_CHECKING too, `local`: those in functions too."""
    stack: list[ast.AST] = [tree(module)]
    while stack:
        node = stack.pop()
        yield from ((name, node.lineno) for name in targets(module, node) if hasattr(node, "lineno"))
        for child in ast.iter_child_nodes(node):
            is_function = isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
            if (typing or not is_type_checking(child)) and (local or not is_function):
                stack.append(child)


def internal(module: str, **options: bool) -> set[str]:
    return {name for name, _ in imports(module, **options) if name.split(".")[0] == "liehom"}


def where(module: str, line: int) -> str:
    return f"{modules()[module].relative_to(ROOT)}:{line}"


def test_the_package_is_there() -> None:
    assert "liehom.errors" in modules()


def test_every_module_belongs_to_a_layer() -> None:
    unknown = {module for module in modules() if layer(module) not in BELOW}
    assert not unknown, f"not in the list of layers: {sorted(unknown)}"


def test_imports_point_downward() -> None:
    wrong = [
        f"{where(module, line)}: {layer(module)} imports {name}"
        for module in modules()
        for name, line in imports(module)
        if name.split(".")[0] == "liehom" and layer(name) not in reachable(layer(module))
    ]
    assert not wrong, "\n".join(wrong)


def test_only_the_scalars_and_the_command_line_know_their_libraries() -> None:
    wrong = [
        f"{where(module, line)}: {name} belongs to {', '.join(doors)}"
        for module in modules()
        for name, line in imports(module)
        for library, doors in DOORS.items()
        if (name == library or name.startswith(library + ".")) and not is_under(module, doors)
    ]
    assert not wrong, "\n".join(wrong)


def test_no_import_cycle() -> None:
    """Among the imports that run when a module is loaded."""
    graph = {module: internal(module, typing=False, local=False) & modules().keys() for module in modules()}
    done: set[str] = set()

    def visit(module: str, path: tuple[str, ...]) -> None:
        assert module not in path, "import cycle: " + " -> ".join([*path[path.index(module) :], module])
        if module not in done:
            for name in sorted(graph[module]):
                visit(name, (*path, module))
            done.add(module)

    for module in graph:
        visit(module, ())


def test_the_checker_of_certificates_imports_only_arithmetic() -> None:
    start = [module for module in modules() if is_under(module, CHECKER)]
    assert start, "no module of the checker found: has it been renamed?"
    wrong = [
        f"{where(module, line)}: {name}"
        for module in start
        for name, line in imports(module, typing=False)
        if name.split(".")[0] == "liehom" and not is_under(name, CHECKER_MAY_IMPORT)
    ]
    assert not wrong, "\n".join(wrong)


def test_no_assert_in_the_library() -> None:
    wrong = [
        where(module, node.lineno)
        for module in modules()
        for node in ast.walk(tree(module))
        if isinstance(node, ast.Assert)
    ]
    assert not wrong, f"raise instead: {wrong}"


def is_data(path: Path) -> bool:
    return path.stem.endswith("_data") or "data" in path.parts


def code_lines(node: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """The length of a function without its docstring."""
    lines = (node.end_lineno or node.lineno) - node.lineno + 1
    if ast.get_docstring(node) is not None:
        doc = node.body[0]
        lines -= (doc.end_lineno or doc.lineno) - doc.lineno + 1
    return lines


def test_files_are_short() -> None:
    sizes = {
        path: len(path.read_text(encoding="utf-8").splitlines()) for path in modules().values() if not is_data(path)
    }
    long = {str(path.relative_to(ROOT)): size for path, size in sizes.items() if size > MAX_FILE_LINES}
    assert not long, f"more than {MAX_FILE_LINES} lines (one notion per file?): {long}"


def test_functions_are_short() -> None:
    long = {
        f"{where(module, node.lineno)} {node.name}": code_lines(node)
        for module, path in modules().items()
        if not is_data(path)
        for node in ast.walk(tree(module))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and code_lines(node) > MAX_FUNCTION_LINES
    }
    assert not long, f"more than {MAX_FUNCTION_LINES} lines: {long}"


@pytest.mark.parametrize(
    ("lower", "upper"),
    [
        ("errors", "scalars"),
        ("algebra", "representations"),
        ("fullness", "catalog"),
        ("series", "correctors"),
    ],
)
def test_the_list_of_layers_forbids_what_it_should(lower: str, upper: str) -> None:
    """A control: the checks above can fail."""
    assert upper not in reachable(lower)
    assert upper in reachable("")
