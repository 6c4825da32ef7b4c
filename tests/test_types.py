"""Signatures name their types: a bare Any is an exception, and the list of exceptions only shrinks."""

import ast
import tomllib
from functools import cache
from pathlib import Path

import pytest

import liehom

PACKAGE = Path(liehom.__file__).resolve().parent
PYPROJECT = Path(__file__).resolve().parent.parent / "pyproject.toml"

MOST_FILES = 55
MOST_ANNOTATIONS = 224
MOST_PARAMETERS = 0.02  # share of the parameters of the library


FILES = [path for path in PACKAGE.rglob("*.py") if PACKAGE / "examples" not in path.parents]


def is_any(annotation: ast.expr | None) -> bool:
    return annotation is not None and ast.unparse(annotation) in ("Any", "typing.Any")


def parameters(node: ast.FunctionDef | ast.AsyncFunctionDef) -> list[ast.arg]:
    a = node.args
    return [
        x for x in (*a.posonlyargs, *a.args, *a.kwonlyargs, a.vararg, a.kwarg) if x and x.arg not in ("self", "cls")
    ]


@cache
def functions(path: Path) -> list[ast.FunctionDef | ast.AsyncFunctionDef]:
    nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
    return [node for node in nodes if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]


def bare(path: Path) -> int:
    """The number of parameters and results of a file that are annotated by a bare Any."""
    return sum(is_any(x) for f in functions(path) for x in (f.returns, *(p.annotation for p in parameters(f))))


def exceptions() -> set[str]:
    ignored = tomllib.loads(PYPROJECT.read_text(encoding="utf-8"))["tool"]["ruff"]["lint"]["per-file-ignores"]
    return {path for path, rules in ignored.items() if "ANN401" in rules and path.startswith("liehom/")}


def test_files_with_a_bare_any_are_listed_and_listed_files_have_one() -> None:
    found = {path.relative_to(PACKAGE.parent).as_posix(): bare(path) for path in FILES}
    with_any = {path for path, count in found.items() if count}
    assert not with_any - exceptions(), "name the type, see liehom/base/typing.py"
    assert not exceptions() - with_any, "no longer an exception: take it off the list in pyproject.toml"


def test_the_list_of_exceptions_only_shrinks() -> None:
    assert len(exceptions()) <= MOST_FILES
    assert sum(bare(path) for path in FILES) <= MOST_ANNOTATIONS


def test_few_parameters_are_a_bare_any() -> None:
    every = [p for path in FILES for f in functions(path) for p in parameters(f)]
    assert sum(is_any(p.annotation) for p in every) < MOST_PARAMETERS * len(every)


@pytest.mark.parametrize(
    ("text", "count"), [("def f(x: Any, *y: int) -> Any: ...", 2), ("def f(x: list[Any]): ...", 0)]
)
def test_a_bare_any_is_counted(text: str, count: int, tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text(text)
    assert bare(tmp_path / "a.py") == count
