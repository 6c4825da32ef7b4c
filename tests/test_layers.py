"""The architecture as a test: imports point downward, files and functions are short, nothing asserts."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

import liehom

PACKAGE = Path(liehom.__file__).resolve().parent  # of the tree, or of an installed wheel
ROOT = PACKAGE.parent

# layer -> the layers directly below it; a layer may import whatever can be reached downward
BELOW: dict[str, tuple[str, ...]] = {
    "errors": (),
    "typing": (),
    "compatibility": ("errors",),
    "pytrees": ("errors", "typing"),
    "budget": ("errors",),
    "disk": ("errors",),
    "parallel": ("budget", "disk", "typing"),
    "display": (),
    "immutable": (),
    "scalars": ("budget", "display", "errors", "immutable", "typing"),
    "algebra": ("scalars",),
    "representations": ("algebra",),
    "pauli": ("representations",),
    "tracing": ("budget", "disk", "pytrees", "typing"),
    "series": ("scalars", "tracing"),
    "homogeneous": ("representations", "series"),
    "fullness": ("homogeneous",),
    "correctors": ("homogeneous", "series"),
    "integrators": ("correctors", "parallel"),
    "instances": ("integrators",),
    "catalog": ("fullness",),
    "atlas": ("catalog", "fullness", "parallel"),
    "io": ("catalog", "fullness", "integrators"),
    "plotting": ("io",),
    "pages": ("plotting",),
    "paper": ("plotting", "instances"),
    "testing": ("catalog", "fullness", "integrators", "io"),
    "cli": ("io", "atlas", "pages", "paper", "pauli", "testing"),
    "__main__": ("cli",),
    "": ("cli", "compatibility"),  # liehom/__init__.py, which everybody below must leave alone
}

# folder -> its wings and the modules that stand directly in it, lowest first; each may import only what is listed
# before it, at load time, inside functions and for type checkers alike
WINGS: dict[str, tuple[str, ...]] = {
    "scalars": ("fields", "spaces", "modular", "functions", "lattices", "roots"),
    "algebra": (
        "core",
        "closure",
        "roots",
        "matrices",
        "structure",
        "constructions",
        "cohomology",
        "involutions",
        "parabolic",
    ),
    "representations": ("invariants", "core", "rationalization", "highest_weight", "constructions", "analysis"),
    "homogeneous": ("maps", "frames", "exponentials", "range", "space", "fields", "orbits"),
    "fullness": (
        "traceless_isotropy_action",
        "certificates",
        "checker",
        "failure",
        "classification",
        "reasons",
        "verdict",
        "self_adjoint",
        "least_singular_value",
        "numerical",
        "search",
        "decide",
        "classifier",
    ),
    "correctors": (
        "implicit",
        "step_size",
        "local_step",
        "step",
        "expansion",
        "points",
        "curvature",
        "isotropy",
        "moving_frame",
        "conserving",
        "symbolic",
    ),
    "integrators": (
        "tableaux",
        "run",
        "points",
        "methods",
        "implicit",
        "symplectic",
        "named",
        "engine",
        "compiled",
        "sensitivity",
        "arguments",
        "jax_engine",
        "engines",
        "bound_call",
        "inspection",
        "propagator",
        "integration",
        "ensembles",
        "convergence",
    ),
    "atlas": ("recipe", "entry", "pair_facts", "table_rows", "sweep", "families", "all_families"),
    "cli": (
        "guard",
        "terminal",
        "options",
        "inputs",
        "problem_options",
        "show",
        "integration",
        "atlas_command",
        "classify_commands",
        "describe_command",
        "fullness_commands",
        "plot_command",
        "page_command",
        "reproduce",
        "demo",
        "app",
    ),
    "instances": ("spheres", "bodies", "rigid_body", "spins", "sym_conjugation", "isospectral"),
}

# the class files: a method may delegate, inside its body, to a wing above its class; nothing else may point upwards
CLASS_FILES = (
    "liehom.algebra.core.lie_algebra",
    "liehom.algebra.core.subalgebra",
    "liehom.representations.core.representation",
    "liehom.representations.core.pair",
)

# what a notebook or user asks of an object of any layer: its methods import what renders it when they are called
TABLE_WITH_PLOT = "liehom.integrators.convergence.work_precision_table"
RENDERERS = {
    ("liehom.display", "liehom.io.html_format"),
    ("liehom.display", "liehom.io.latex_format"),
    (TABLE_WITH_PLOT, "liehom.plotting.work_precision_plot"),
}

MAX_MODULES = 14

# libraries behind one door: only modules that start with one of these names may import them
DOORS: dict[str, tuple[str, ...]] = {
    "flint": ("liehom.scalars", "liehom.series"),  # series: recognises its numbers
    # points with symbols in them: linear algebra over a field of rational functions, by DomainMatrix
    "sympy.polys": ("liehom.scalars", "liehom.representations.analysis.symbolic"),
    "networkx": ("liehom.algebra",),
    "matplotlib": ("liehom.plotting", "liehom.paper", TABLE_WITH_PLOT),  # the type of what its method returns
    "jax": ("liehom.integrators", "liehom.series", "liehom.tracing"),
    "llvmlite": ("liehom.tracing",),
    "zarr": ("liehom.parallel",),
    "typer": ("liehom.cli",),
    "rich": ("liehom.cli", "liehom.integrators.run.progress"),
}

# what the independent checker of certificates may import of liehom
CHECKER = (
    "liehom.fullness.certificates.certificate",
    "liehom.fullness.certificates.certificate_fields",
    "liehom.fullness.checker",
)
CHECKER_MAY_IMPORT = (*CHECKER, "liehom.scalars", "liehom.errors", "liehom.budget", "liehom.display")

MAX_FILE_LINES = 450
MAX_FUNCTION_LINES = 60


@cache
def modules() -> dict[str, Path]:
    found = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        if PACKAGE / "examples" in path.parents:  # a wheel holds the scripts of the demo
            continue
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
    """Whether the dotted name is one of the prefixes or lies below one."""
    return any(module == prefix or module.startswith(f"{prefix}.") for prefix in prefixes)


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


@cache
def recorded(module: str) -> tuple[tuple[str, int, bool, bool], ...]:
    """All (imported name, line, for type checkers only, inside a function) of a module."""
    found = []
    stack: list[tuple[ast.AST, bool, bool]] = [(tree(module), False, False)]
    while stack:
        node, typing, local = stack.pop()
        found += [(name, node.lineno, typing, local) for name in targets(module, node) if hasattr(node, "lineno")]
        for child in ast.iter_child_nodes(node):
            if not isinstance(child, ast.expr):  # no import is inside an expression
                function = isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef)
                stack.append((child, typing or is_type_checking(child), local or function))
    return tuple(found)


def imports(module: str, *, typing: bool = True, local: bool = True) -> Iterator[tuple[str, int]]:
    """All (imported name, line); `typing`: those under TYPE_CHECKING too, `local`: those in functions too."""
    for name, line, is_typing, is_local in recorded(module):
        if (typing or not is_typing) and (local or not is_local):
            yield name, line


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
        if name.split(".")[0] == "liehom"
        and layer(name) not in reachable(layer(module))
        and (module, name) not in RENDERERS
    ]
    assert not wrong, "\n".join(wrong)


def test_renderers_are_imported_when_they_are_asked_for() -> None:
    found = {(module, name) for module in modules() for name in internal(module) if (module, name) in RENDERERS}
    assert found == RENDERERS
    for module, renderer in RENDERERS:
        assert renderer not in internal(module, typing=False, local=False), "nothing is imported at load time"
    assert not internal("liehom.display", typing=False, local=False)


def test_only_the_scalars_and_the_command_line_know_their_libraries() -> None:
    wrong = [
        f"{where(module, line)}: {name} belongs to {', '.join(doors)}"
        for module in modules()
        for name, line in imports(module)
        for library, doors in DOORS.items()
        if (name == library or name.startswith(library + ".")) and not is_under(module, doors)
    ]
    assert not wrong, "\n".join(wrong)


def place(module: str) -> int | None:
    """The position of a module in the list of its folder, None for the folder's own `__init__`."""
    parts = module.split(".")
    if len(parts) < 3 or parts[1] not in WINGS:
        return None
    return WINGS[parts[1]].index(parts[2])


def edges(module: str) -> Iterator[tuple[str, int]]:
    """The imports of liehom in a module, lazy ones and those for type checkers included.

    Left out are the two ways upwards: the imports of a class file inside its methods or for type checkers, and the
    renderers of notebooks.
    """
    door = module in CLASS_FILES
    for name, line in imports(module, typing=not door, local=not door):
        if name in modules() and name != "liehom" and (module, name) not in RENDERERS:
            yield name, line


def test_every_module_belongs_to_a_wing() -> None:
    unknown = {
        module
        for module in modules()
        if len(module.split(".")) > 2 and layer(module) in WINGS and module.split(".")[2] not in WINGS[layer(module)]
    }
    assert not unknown, f"not in the list of wings: {sorted(unknown)}"
    assert set(CLASS_FILES) <= modules().keys()


def test_wings_import_downward() -> None:
    wrong = [
        f"{where(module, line)}: {'.'.join(module.split('.')[1:3])} imports {name}"
        for module in modules()
        for name, line in edges(module)
        if layer(name) == layer(module)
        and (here := place(module)) is not None
        and ((there := place(name)) is None or there > here)
    ]
    assert not wrong, "\n".join(wrong)


def circles(graph: dict[str, set[str]]) -> list[set[str]]:
    """The strongly connected components with more than one module (Kosaraju)."""
    order: list[str] = []
    seen: set[str] = set()

    def visit(node: str, towards: dict[str, set[str]], into: list[str]) -> None:
        stack = [(node, iter(sorted(towards[node])))]
        seen.add(node)
        while stack:
            top, rest = stack[-1]
            following = next((name for name in rest if name not in seen), None)
            if following is None:
                into.append(top)
                stack.pop()
            else:
                seen.add(following)
                stack.append((following, iter(sorted(towards[following]))))

    for node in graph:
        if node not in seen:
            visit(node, graph, order)
    back: dict[str, set[str]] = {node: set() for node in graph}
    for node, names in graph.items():
        for name in names:
            back[name].add(node)
    seen.clear()
    found = []
    for node in reversed(order):
        if node not in seen:
            found.append([])
            visit(node, back, found[-1])
    return [set(part) for part in found if len(part) > 1]


def test_no_import_circle() -> None:
    """Among all imports, lazy ones included, except the way upwards in the class files."""
    graph = {module: {name for name, _ in edges(module) if name != module} for module in modules()}
    found = [sorted(part) for part in circles(graph)]
    assert not found, f"import circles: {found}"


def test_no_import_circle_when_modules_are_loaded() -> None:
    """Here the class files count like all others."""
    graph = {module: internal(module, typing=False, local=False) & modules().keys() for module in modules()}
    assert not circles(graph)


def test_circles_are_found() -> None:
    """A control."""
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"b"}, "d": {"a", "c"}}) == [{"b", "c"}]


def test_folders_are_small_and_introduced() -> None:
    for path in sorted(PACKAGE.rglob("__init__.py")):
        names = [other.name for other in path.parent.glob("*.py") if other.name != "__init__.py"]
        assert len(names) <= MAX_MODULES, f"{path.parent}: {len(names)} modules; a wing of its own?"
    for folder, names in WINGS.items():
        for name in names:
            if (PACKAGE / folder / name).is_dir():
                text = ast.get_docstring(tree(f"liehom.{folder}.{name}")) or ""
                assert len(text.split()) >= 20, f"liehom.{folder}.{name} does not say what lives there"
                assert "docs/" in text, f"liehom.{folder}.{name} names no page of theory"


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
        path: len(path.read_text(encoding="utf-8").splitlines())
        for module, path in modules().items()
        if not is_data(path) and module not in CLASS_FILES  # a table of contents may be long
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
