"""The architecture as a test: imports point downwards, the two halves meet at one door, files are chapters."""

from __future__ import annotations

import ast
import importlib
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from itertools import takewhile
from pathlib import Path

import liehom
from liehom.base.objects import providers

PACKAGE = Path(liehom.__file__).resolve().parent  # of the tree, or of an installed wheel
ROOT = PACKAGE.parent

# package -> what stands directly in it, lowest first. A module may import only what is listed before it at the first
# place at which the two dotted names differ: at load time, inside functions and for type checkers alike
ORDER: dict[str, list[str]] = {
    package: names.split()
    for package, names in {
        "liehom": "base exact flow plotting studies io testing cli __main__",
        "liehom.base": "errors budget disk lazy objects store tasks typing pytrees",
        "liehom.cli": "completion guard help inputs atlas_command integration objects plot_command reproduce app",
        "liehom.exact": "scalars algebra representations pauli orbits geometry fullness catalog",
        "liehom.exact.algebra": "core linear roots constructions structure involutions",
        "liehom.exact.algebra.constructions": "classical family sums families low_dimensional",
        "liehom.exact.algebra.core": "structure_constants jacobi tables lie_algebra subalgebra homomorphism",
        "liehom.exact.algebra.involutions": (
            "cartan_involution rational_involution field_involutions cartan_decomposition parabolic"
        ),
        "liehom.exact.algebra.linear": "complex_matrices generated_span closure linear_bases named_matrices",
        "liehom.exact.algebra.roots": "root_system diagrams chevalley real_form real_form_involutions",
        "liehom.exact.algebra.structure": (
            "centroid nilpotent casimirs cohomology derivations ideals levi root_spaces isomorphisms naming "
            "identification"
        ),
        "liehom.exact.catalog": "names algebras pairs",
        "liehom.exact.fullness": (
            "classification_rows isotropy_action certificate certificate_writer checker search verify_classification "
            "classification verdict numerical decide range_classification control_systems"
        ),
        "liehom.exact.fullness.checker": "verify_modular verify_roots verify_pair verify",
        "liehom.exact.fullness.search": "dominance forms witnesses",
        "liehom.exact.geometry": "reductive metrics polynomial_systems einstein forms summary",
        "liehom.exact.orbits": "conjugacy range cone types strata",
        "liehom.exact.pauli": "words span simple_ideals dynamical",
        "liehom.exact.representations": "invariants core rationalization highest_weight constructions analysis",
        "liehom.exact.representations.analysis": (
            "submodules isotypic decomposition symbolic weight_multiplicities branching embeddings "
            "polynomial_invariants"
        ),
        "liehom.exact.representations.core": "coordinates pair representation elements",
        "liehom.exact.representations.highest_weight": "weights characters highest_weight real_modules",
        "liehom.exact.representations.invariants": "intertwiners irreducibility representation_identity",
        "liehom.exact.scalars": (
            "field grammar integer_matrices exact_field rational function_field polynomial modular number_fields "
            "floating complex_parts polynomial_matrix roots extension joint_spectrum sparse "
            "subspaces lattices"
        ),
        "liehom.flow": (
            "door tracing series action steps run methods engines propagation convergence bodies fractional spins "
            "geodesics"
        ),
        "liehom.flow.action": (
            "maps exponential custom_exponential expression components frames field motions invariants space "
            "fingerprint"
        ),
        "liehom.flow.convergence": "reference orders costs",
        "liehom.flow.engines": (
            "engine arguments traced_step lanes compiled_events jax_loops lattice plan llvm_engine "
            "jax_engine auto_engine sensitivity"
        ),
        "liehom.flow.methods": "midpoint composition runge_kutta tableaux rkmk low_order stiff stability taylor named",
        "liehom.flow.propagation": "propagator integration ensemble",
        "liehom.flow.run": "check control records events options solution run",
        "liehom.flow.series": "arrays quadratic node jet jet_functions lie_series",
        "liehom.flow.steps": (
            "implicit range_solver step expansion corrected curvature first_integral conserving symbolic_problem "
            "formulas order_conditions"
        ),
        "liehom.flow.tracing": "graph array llvm_text loop run_text machine python_kernel lattice sweeps",
        "liehom.io": "json_reader object_files files other_programs renderings page solution_file",
        "liehom.plotting": "canvas error_plot phase_plot diagram_plot strata_plot trajectory_plot drift_plot",
        "liehom.studies": "atlas isospectral spheres rigid_body_updates rigid_body instances paper",
        "liehom.studies.atlas": "entry irreducible sweeps symmetric affine subalgebras all_families",
        "liehom.studies.paper": "table kernels plots reproduction energy_errors efficiency trajectories figures",
    }.items()
}

# the class files: a method may delegate to a wing above its class, by an import inside its body, or by the package of
# the wing if this loads its modules when they are first used; nothing else may point upwards
CLASS_FILES = (
    "liehom.exact.algebra.core.lie_algebra",
    "liehom.exact.algebra.core.subalgebra",
    "liehom.exact.representations.core.representation",
    "liehom.exact.representations.core.pair",
    "liehom.exact.geometry.metrics",
)
DOOR = "liehom.flow.door"

MAX_MODULES = 18

# libraries behind one door: only modules that start with one of these names may import them
LIBRARIES: dict[str, tuple[str, ...]] = {
    # series: recognises its numbers; polynomial systems: Groebner bases of flint's polynomials
    "flint": ("liehom.exact.scalars", "liehom.flow.series", "liehom.exact.geometry.polynomial_systems"),
    # points with symbols in them: linear algebra over a field of rational functions, by DomainMatrix
    "sympy.polys": ("liehom.exact.scalars", "liehom.exact.representations.analysis.symbolic"),
    "networkx": ("liehom.exact.algebra",),
    # flow.convergence: the type of what `WorkPrecisionTable.plot` returns
    "matplotlib": ("liehom.plotting", "liehom.studies.paper", "liehom.flow.convergence"),
    "jax": ("liehom.flow",),
    "llvmlite": ("liehom.flow.tracing",),
    "zarr": ("liehom.base.store",),
    "typer": ("liehom.cli",),
    "rich": ("liehom.cli", "liehom.flow.run.options"),
}

# what the independent checker of certificates may import of liehom
CHECKER = ("liehom.exact.fullness.certificate", "liehom.exact.fullness.checker")
CHECKER_MAY_IMPORT = (*CHECKER, "liehom.exact.scalars", "liehom.base")

MAX_FILE_LINES = 900
MAX_FUNCTION_LINES = 60


@cache
def modules() -> dict[str, Path]:
    paths = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        if PACKAGE / "examples" in path.parents:  # a wheel holds the scripts of the demo
            continue
        parts = path.relative_to(ROOT).with_suffix("").parts
        paths[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return paths


@cache
def tree(module: str) -> ast.Module:
    return ast.parse(modules()[module].read_text(encoding="utf-8"))


def is_under(module: str, prefixes: tuple[str, ...]) -> bool:
    """Whether the dotted name is one of the prefixes or lies below one."""
    return any(module == prefix or module.startswith(f"{prefix}.") for prefix in prefixes)


def targets(node: ast.AST) -> Iterator[str]:
    """The modules that a statement imports; relative imports do not occur (ruff, TID252)."""
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    elif isinstance(node, ast.ImportFrom):
        for alias in node.names:
            dotted = f"{node.module}.{alias.name}"
            yield dotted if dotted in modules() else str(node.module)


def is_type_checking(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)


@cache
def recorded(module: str) -> tuple[tuple[str, int, bool, bool], ...]:
    """All (imported name, line, for type checkers only, inside a function) of a module."""
    rows = []
    stack: list[tuple[ast.AST, bool, bool]] = [(tree(module), False, False)]
    while stack:
        node, typing, local = stack.pop()
        rows += [(name, node.lineno, typing, local) for name in targets(node) if hasattr(node, "lineno")]
        for child in ast.iter_child_nodes(node):
            if not isinstance(child, ast.expr):  # no import is inside an expression
                function = isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef)
                stack.append((child, typing or is_type_checking(child), local or function))
    return tuple(rows)


def imports(module: str, *, typing: bool = True, local: bool = True) -> Iterator[tuple[str, int]]:
    """All (imported name, line); `typing`: those under TYPE_CHECKING too, `local`: those in functions too."""
    for name, line, is_typing, is_local in recorded(module):
        if (typing or not is_typing) and (local or not is_local):
            yield name, line


def loads_late(module: str) -> bool:
    """Whether an import is of a package that loads none of its modules."""
    package = modules()[module].name == "__init__.py"
    return package and "lazy_modules(__name__)" in modules()[module].read_text(encoding="utf-8")


def edges(module: str) -> Iterator[tuple[str, int]]:
    """The imports of liehom in a module; those by which a class file delegates to a wing are left out."""
    door = module in CLASS_FILES
    for name, line in imports(module, typing=not door, local=not door):
        if is_under(name, ("liehom",)) and name != "liehom" and not (door and loads_late(name)):
            yield name, line


def where(module: str, line: int) -> str:
    return f"{modules()[module].relative_to(ROOT)}:{line}"


def points_down(module: str, name: str) -> bool:
    """Whether an import is of something listed before, or of the importing module's own package."""
    here, there = module.split("."), name.split(".")
    common = len(list(takewhile(lambda pair: pair[0] == pair[1], zip(here, there, strict=False))))
    if common in (len(here), len(there)):  # a package imports what is in it
        return common == len(here)
    order = ORDER[".".join(here[:common])]
    return order.index(there[common]) < order.index(here[common])


def test_the_order_lists_everything_once() -> None:
    for package, names in ORDER.items():
        folder = modules()[package].parent
        there = {path.stem for path in folder.glob("*.py")} | {
            path.parent.name for path in folder.glob("*/__init__.py")
        }
        assert set(names) == there - {"__init__"}, package
        assert len(set(names)) == len(names)
    packages = {module for module, path in modules().items() if path.name == "__init__.py"}
    assert packages == ORDER.keys()


def test_imports_point_downwards() -> None:
    wrong = [
        f"{where(module, line)}: imports {name}"
        for module in modules()
        for name, line in edges(module)
        if name != module and not points_down(module, name)
    ]
    assert not wrong, "\n".join(wrong)


def test_the_two_halves_meet_at_one_door() -> None:
    wrong = [
        where(module, line)
        for module in modules()
        if is_under(module, ("liehom.flow",)) and module != DOOR
        for name, line in imports(module)
        if is_under(name, ("liehom.exact",))
    ]
    assert not wrong, f"import it through {DOOR}: {wrong}"
    assert not [
        m for m in modules() if is_under(m, ("liehom.exact",)) for n, _ in imports(m) if is_under(n, ("liehom.flow",))
    ]


def test_nothing_is_imported_by_a_string() -> None:
    """What a lower floor calls of a higher one is in `liehom.base.objects.providers`, which the top level fills."""
    wrong = [
        where(module, node.lineno)
        for module in modules()
        for node in ast.walk(tree(module))
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith(("import_module", "__import__"))
        if any(isinstance(x, ast.Constant) and str(x.value).startswith("liehom") for x in ast.walk(node))
    ]
    assert not wrong
    for place, name in providers.values():
        assert callable(getattr(importlib.import_module(place), name))


def test_the_order_forbids_what_it_should() -> None:
    """A control: the checks above can fail."""
    assert points_down("liehom.flow.steps.step", "liehom.flow.series.jet")
    assert not points_down("liehom.flow.series.jet", "liehom.flow.steps.step")
    assert not points_down("liehom.exact.fullness.decide", "liehom.flow.series.jet")
    assert not points_down("liehom.exact.scalars.field", "liehom.exact")


def test_only_the_doors_know_their_libraries() -> None:
    wrong = [
        f"{where(module, line)}: {name} belongs to {', '.join(doors)}"
        for module in modules()
        for name, line in imports(module)
        for library, doors in LIBRARIES.items()
        if is_under(name, (library,)) and not is_under(module, doors)
    ]
    assert not wrong, "\n".join(wrong)


def test_the_checker_of_certificates_imports_only_arithmetic() -> None:
    start = [module for module in modules() if is_under(module, CHECKER)]
    assert len(start) > 4, "no module of the checker found: has it been renamed?"
    wrong = [
        f"{where(module, line)}: {name}"
        for module in start
        for name, line in imports(module, typing=False)
        if is_under(name, ("liehom",)) and not is_under(name, CHECKER_MAY_IMPORT)
    ]
    assert not wrong, "\n".join(wrong)


def test_folders_are_small_and_introduced() -> None:
    for module, path in modules().items():
        if path.name == "__init__.py":
            names = [other.name for other in path.parent.glob("*.py") if other.name != "__init__.py"]
            assert len(names) <= MAX_MODULES, f"{module}: {len(names)} modules; a wing of its own?"
            text = ast.get_docstring(tree(module)) or ""
            assert len(text.split()) >= 10, f"{module} does not say what lives there"
            assert module.count(".") < 3 or "docs/" in text, f"{module} names no page of theory"


def test_no_assert_in_the_library() -> None:
    wrong = [
        where(module, node.lineno)
        for module in modules()
        for node in ast.walk(tree(module))
        if isinstance(node, ast.Assert)
    ]
    assert not wrong, f"raise instead: {wrong}"


def code_lines(node: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """The length of a function without its docstring."""
    lines = (node.end_lineno or node.lineno) - node.lineno + 1
    if ast.get_docstring(node) is not None:
        doc = node.body[0]
        lines -= (doc.end_lineno or doc.lineno) - doc.lineno + 1
    return lines


def test_files_are_chapters() -> None:
    sizes = {
        str(path.relative_to(ROOT)): len(path.read_text(encoding="utf-8").splitlines())
        for module, path in modules().items()
        if module not in CLASS_FILES  # a table of contents may be long
    }
    long = {path: size for path, size in sizes.items() if size > MAX_FILE_LINES}
    assert not long, f"more than {MAX_FILE_LINES} lines (two chapters?): {long}"


def test_functions_are_short() -> None:
    long = {
        f"{where(module, node.lineno)} {node.name}": code_lines(node)
        for module in modules()
        for node in ast.walk(tree(module))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and code_lines(node) > MAX_FUNCTION_LINES
    }
    assert not long, f"more than {MAX_FUNCTION_LINES} lines: {long}"


def loaded(code: str) -> set[str]:
    """The modules of liehom that a new interpreter has loaded after some code."""
    program = f"{code}\nimport sys\nprint(*[name for name in sys.modules if name.split('.')[0] == 'liehom'])"
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=ROOT)
    return set(run.stdout.splitlines()[-1].split())


def test_a_decision_loads_the_exact_half_alone() -> None:
    names = loaded("import liehom as lh\nlh.decide_fullness(lh.pair('so(4)/so(3)')).verify()")
    assert len(names) <= 150
    assert not [
        name for name in names if is_under(name, ("liehom.flow", "liehom.plotting", "liehom.studies", "liehom.io"))
    ]
