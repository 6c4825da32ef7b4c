"""Mutants of a module: its syntax tree with one change inside a function, compiled to the code of its functions."""

import ast
import copy
import gc
import tomllib
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import CodeType, FunctionType

from tests.record import ROOT, functions

COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In,
}  # fmt: skip
OPERATIONS: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Add, ast.Div: ast.Mult, ast.FloorDiv: ast.Mult,
    ast.Mod: ast.FloorDiv, ast.Pow: ast.Mult, ast.LShift: ast.RShift, ast.RShift: ast.LShift, ast.MatMult: ast.Add,
    ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd,
}  # fmt: skip
SKIPPED = {"annotation", "returns", "type_params", "exc"}
Codes = dict[tuple[str, int], CodeType]
"""The code of each function of a module by its qualified name and first line."""


@dataclass(frozen=True)
class Mutant:
    """One change of one function."""

    module: str
    function: str
    line: int
    change: str
    compiled: Callable[[], CodeType]

    @property
    def codes(self) -> Codes:
        """The code of the functions of the changed module."""
        return codes_of(self.compiled())

    @property
    def key(self) -> str:
        """Name of the change that does not depend on the line, as in equivalent.toml."""
        return f"{self.function.partition(':')[2]}: {self.change}"

    def __str__(self) -> str:
        return f"{self.module}:{self.line} {self.key}"


def changes(node: ast.AST) -> Iterator[ast.AST]:
    """The nodes that may take the place of a node; Pass leaves a statement out."""
    match node:
        case ast.Compare(ops=operators):
            for i, operator in enumerate(operators):
                if type(operator) in COMPARISONS:
                    yield _with(node, ops=[*operators[:i], COMPARISONS[type(operator)](), *operators[i + 1 :]])
        case ast.BinOp() if type(node.op) in OPERATIONS and not _is_text(node):
            yield _with(node, op=OPERATIONS[type(node.op)]())
        case ast.BoolOp():
            yield _with(node, op=ast.Or() if isinstance(node.op, ast.And) else ast.And())
        case ast.UnaryOp(op=ast.Not() | ast.USub(), operand=operand) if not isinstance(operand, ast.Constant):
            yield operand
        case ast.Constant(value=bool(value)):
            yield ast.Constant(not value)
        case ast.Constant(value=int(value)):
            yield ast.Constant(value + 1)
            yield ast.Constant(value - 1)
        case ast.Return(value=ast.expr() as value) if not (isinstance(value, ast.Constant) and value.value is None):
            yield ast.Return(ast.Constant(None))
        case ast.AugAssign() | ast.Raise() | ast.Continue() | ast.Break() | ast.Expr(value=ast.Call()):
            yield ast.Pass()


def _with(node: ast.AST, **fields: object) -> ast.AST:
    other = copy.copy(node)
    for name, value in fields.items():
        setattr(other, name, value)
    return other


def _is_text(node: ast.BinOp) -> bool:
    sides = (node.left, node.right)
    return any(isinstance(s, (ast.JoinedStr, ast.List)) or isinstance(getattr(s, "value", 0), str) for s in sides)


def _places(node: ast.AST) -> Iterator[tuple[ast.AST, str, int | None]]:
    """All (parent, field, index) of nodes below a node that may be changed."""
    for name, value in ast.iter_fields(node):
        if name in SKIPPED:
            continue
        for index, child in enumerate(value) if isinstance(value, list) else [(None, value)]:
            if not isinstance(child, ast.AST) or isinstance(child, ast.JoinedStr):
                continue
            if isinstance(child, ast.keyword) and child.arg == "strict":  # the own check of zip
                continue
            yield node, name, index
            yield from _places(child)


def codes_of(code: CodeType) -> Codes:
    """The code objects inside a code object."""
    found: Codes = {}
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            found |= {(inner.co_qualname, inner.co_firstlineno): inner} | codes_of(inner)
    return found


def mutants(module: str, lines: set[int] | None = None) -> Iterator[Mutant]:
    """The mutants of the functions of a module, a path below the root; only those of given lines."""
    path = ROOT / module
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for function, body in functions(tree, f"{module}:"):
        seen: dict[str, int] = {}
        for parent, name, index in (place for statement in body.body for place in _places(_Body(statement))):
            holder = getattr(parent, name)
            before = holder if index is None else holder[index]
            for after in changes(before):
                change = f"`{_text(before)}` -> `{_text(after)}`"
                seen[change] = seen.get(change, 0) + 1
                if lines is not None and before.lineno not in lines:
                    continue
                for part in ast.walk(after):
                    if not hasattr(part, "lineno"):
                        ast.copy_location(part, before)
                owner, field, place = (body, "body", body.body.index(before)) if isinstance(parent, _Body) else (
                    parent, name, index)  # fmt: skip
                compiled = partial(_compiled, tree, path, owner, field, place, after)
                number = f" ({seen[change]})" if seen[change] > 1 else ""
                yield Mutant(module, function, before.lineno, change + number, compiled)


class _Body(ast.AST):
    """The place of one statement of a function."""

    _fields = ("statement",)


def _compiled(tree: ast.Module, path: Path, owner: ast.AST, field: str, place: int | None, after: ast.AST) -> CodeType:
    """The module with one node exchanged; the tree is as before afterwards."""
    holder = getattr(owner, field)
    before = holder if place is None else holder[place]
    try:
        if place is None:
            setattr(owner, field, after)
        else:
            holder[place] = after
        return compile(tree, str(path), "exec", dont_inherit=True)
    finally:
        if place is None:
            setattr(owner, field, before)
        else:
            holder[place] = before


def _text(node: ast.AST) -> str:
    return "pass" if isinstance(node, ast.Pass) else ast.unparse(node).splitlines()[0]


def equivalent() -> dict[str, dict[str, str]]:
    """For each module the keys of the mutants that change no result, with the reason."""
    return tomllib.loads(Path(__file__).with_name("equivalent.toml").read_text(encoding="utf-8"))


def live_functions(modules: Collection[str]) -> list[FunctionType]:
    """All functions of modules, methods and closures included."""
    paths = {str(ROOT / module) for module in modules}
    return [f for f in gc.get_objects() if isinstance(f, FunctionType) and f.__code__.co_filename in paths]


def exchange(functions: Iterable[FunctionType], module: str, codes: Codes) -> None:
    """Give functions of a module the code of other functions with their names and lines."""
    path = str(ROOT / module)
    for function in functions:
        code = function.__code__
        if code.co_filename == path:
            other = codes.get((code.co_qualname, code.co_firstlineno), code)
            if other != code:
                function.__code__ = other
