"""Whether psi is the same as before: fingerprints for what is stored on disk, watches for what was compiled from it.

A function is known by its code (bytecode, constants, nested functions), its defaults, its closure, and the globals that
it names: numbers, arrays by content, functions and objects likewise, installed modules by name and version. A part that
a call of psi changes, such as a counter, is its state and is not compared. An open file or
a function in C has no content, and shows in the values of psi only.
"""

from __future__ import annotations

import dis
import hashlib
import json
import pickle
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cached_property, lru_cache, partial
from types import CodeType, FunctionType, MethodType, ModuleType
from typing import Any, TypeAlias, final

import numpy as np
from numpy import asarray

from liehom.base.disk import digest
from liehom.base.pytrees import numbers_of
from liehom.base.typing import Array, Real, Values
from liehom.flow.action.components import Components
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.space import Action
from liehom.flow.series.arrays import is_jax, is_traced
from liehom.flow.tracing.graph import Expr, needed

# The parts of functions and objects by name, and digests of their contents.

Read: TypeAlias = Callable[[], Any]
"""A function that returns the present value of a part."""
Part: TypeAlias = Any
"""A function, or anything that it names."""

ATOMS = frozenset([int, float, complex, bool, str, bytes, type(None), type(...)])
WRAPPERS = ("__wrapped__", "py_func", "__func__")  # attributes with the function in a decorated one


def stable_repr(value: object) -> str:
    """The repr of a step or an option without addresses, for fingerprints."""
    return re.sub(" at 0x[0-9a-f]+", "", repr(value))


def events_by_name(events: Part) -> dict[str, Part]:
    """Event functions, given as `integrate` takes them, by names such as "event 0"."""
    listed = events if isinstance(events, list | tuple) else [events]
    return {f"event {i}": g for i, g in enumerate(listed)}


def fingerprint(
    action: Action, field: GeneratorField, start: Array, span: tuple[Any, Any], functions: Mapping[str, Part],
    others: Mapping[str, str], events: Callable[[], object] | None,
) -> str:  # fmt: skip
    """The digests of functions part by part, of psi's values and of numbers; "" for a part that a call changes."""
    functions = {"psi": source_of(field), **functions}
    first = _digests(functions)
    if events is not None:
        events()
    values, last = values_of(action, field, start, span), _digests(functions)
    own = {
        "initial points": digest(start),
        "time span": digest(np.array(span)),
        "args": digest(*numbers_of(field.args)),
        "representation": digest(*(a.to_numpy() for a in field.representation.matrices)),
        "values of psi": values,
    }
    state = {label: "" for label, mark in first.items() if mark != last.get(label)}
    return json.dumps({**last, **own, **others, **state}, sort_keys=True)


def parts_of(source: Part) -> Iterator[Part]:
    """A function or an object, and all that it names, however deep."""
    return (value for _, _, value, _ in _walk("", lambda: source, {}))


def _digests(functions: Mapping[str, Part]) -> dict[str, str]:
    seen: dict[int, Part] = {}
    walks = (_walk(label, partial(functions.__getitem__, label), seen) for label in functions)
    return {label: _content(value, {}) for walk in walks for label, _, value, is_leaf in walk if is_leaf}


def _walk(label: str, read: Read, seen: dict[int, Part]) -> Iterator[tuple[str, Read, Part, bool]]:
    """(label, how to read it, value, whether it has no parts) of a value and all its parts, however deep."""
    value = read()
    rows = None if id(value) in seen else _rows(value)
    yield label, read, value, rows is None and id(value) not in seen
    if rows is not None:
        seen[id(value)] = value
        for name, part in rows:
            yield from _walk(f"{label}: {name}", part, seen)


def _content(value: Part, seen: dict[int, tuple[Part, str]]) -> str:
    """Digest of a value by its contents, equal in every process."""
    if type(value) in ATOMS:
        return hashlib.sha256(pickle.dumps(value, 4)).hexdigest()
    if id(value) not in seen:
        seen[id(value)] = value, "within itself"
        try:
            kind, inside = _opened(value, seen)
        except Exception:  # noqa: BLE001 - objects of other libraries raise anything when they are asked for their state
            kind, inside = "opaque", []
        marks = [f"{type(value).__qualname__} {kind}", *(_content(x, seen) for x in inside)]
        seen[id(value)] = value, hashlib.sha256("\n".join(marks).encode()).hexdigest()
    return seen[id(value)][1]


def _opened(x: Part, seen: dict[int, tuple[Part, str]]) -> tuple[str, list[Part]]:
    """A digest of the kind or the content of a value, and its parts."""
    if isinstance(x, np.ndarray | np.generic) and not x.dtype.hasobject:
        return digest(x), []
    if type(x) is list or type(x) is tuple:
        return "", list(x)
    if type(x) is dict:
        return "", [y for item in x.items() for y in item]
    if isinstance(x, set | frozenset):
        return ",".join(sorted(_content(y, seen) for y in x)), []
    if isinstance(x, CodeType):
        return f"{x.co_code.hex()} {x.co_names} {x.co_varnames} {x.co_freevars} {x.co_flags}", list(x.co_consts)
    if isinstance(x, Expr):
        return "", [(y.op, [z.index for z in y.args], y.value) for y in needed([x])]
    if isinstance(x, ModuleType):
        return _with_version(x.__name__), []
    if (rows := _rows(x)) is not None:
        return "", [y for name, read in rows for y in (name, read())]
    if isinstance(x, type):
        return f"{x.__qualname__} {_with_version(x.__module__)}", []
    if isinstance(x, property):
        return "", [x.fget]
    state = x.__reduce_ex__(4)
    return (state, []) if isinstance(state, str) else ("", [list(y) if isinstance(y, Iterator) else y for y in state])


def _rows(x: Part) -> list[tuple[str, Read]] | None:
    """The named parts of a function, and of a class or an object that is not installed; None for other values."""
    if isinstance(x, partial):
        return [(name, partial(getattr, x, name)) for name in ("func", "args", "keywords")]
    if isinstance(x, MethodType):
        return [(name, partial(getattr, x, name)) for name in ("__self__", "__func__")]
    if isinstance(x, FunctionType):
        return _rows_of_function(x)
    kind = x if isinstance(x, type) else type(x)
    inner = [name for name in WRAPPERS if x is not kind and isinstance(getattr(x, name, None), FunctionType)]
    if inner:
        return [(inner[0], partial(getattr, x, inner[0]))]
    ours = any(c.__module__.startswith("liehom.") for c in kind.__mro__)
    if (_is_installed(kind.__module__) and (x is kind or not ours)) or not (ours or hasattr(x, "__dict__")):
        return None
    if x is kind:
        named = [name for name, y in vars(x).items() if not name.startswith("__") or isinstance(y, FunctionType)]
        return [*((name, partial(vars(x).get, name)) for name in named), ("bases", partial(getattr, x, "__bases__"))]
    slots = [name for c in kind.__mro__ for name in getattr(c, "__slots__", ())]
    names = [*slots, *getattr(x, "__dict__", ())]
    rows = [(n, partial(getattr, x, n, None)) for n in names if not isinstance(getattr(kind, n, None), cached_property)]
    # private attributes of objects of the library are caches, unless they hold what a user gave
    rows = [(n, r) for n, r in rows if not ours or n[0] != "_" or n == "_source" or _is_given(r())]
    return [("class", partial(getattr, x, "__class__")), *rows]


def _rows_of_function(f: FunctionType) -> list[tuple[str, Read]]:
    rows: list[tuple[str, Read]] = [(name, partial(getattr, f, name)) for name in ("__defaults__", "__kwdefaults__")]
    rows += [(n, partial(_in_cell, cell)) for n, cell in zip(f.__code__.co_freevars, f.__closure__ or (), strict=True)]
    if _is_installed(f.__module__):
        return [("function", lambda: _with_version(f"{f.__module__}.{f.__qualname__}")), *rows]
    names, imported, attributes = _names(f.__code__)
    found: list[tuple[str, Read]] = [(name, partial(f.__globals__.get, name)) for name in names]
    found += [(name, partial(sys.modules.get, name)) for name in imported]
    for name, read in found:
        module = read()
        if isinstance(module, ModuleType) and not _is_installed(module.__name__):
            rows += [(f"{name}.{a}", partial(getattr, module, a, None)) for a in attributes if hasattr(module, a)]
        else:
            rows.append((name, read))
    return [("code", partial(getattr, f, "__code__")), *rows]


@lru_cache(maxsize=256)
def _names(code: CodeType) -> tuple[list[str], list[str], list[str]]:
    """The globals that code names, the modules that it imports, and all names in it, with those of nested functions."""
    codes = [code]
    for outer in codes:
        codes += [x for x in outer.co_consts if isinstance(x, CodeType)]
    steps = [(step.opname, step.argval) for some in codes for step in dis.get_instructions(some)]
    names = [value for what, value in steps if what in ("LOAD_GLOBAL", "LOAD_NAME")]
    imported = [value for what, value in steps if what == "IMPORT_NAME"]
    every = [name for some in codes for name in some.co_names]
    return list(dict.fromkeys(names)), list(dict.fromkeys(imported)), list(dict.fromkeys(every))


def _in_cell(cell: Part) -> Part:
    try:
        return cell.cell_contents
    except ValueError:  # not assigned yet
        return None


def _is_given(x: Part) -> bool:
    return callable(x) and not (getattr(x, "__module__", None) or "").startswith("liehom.")


@lru_cache(maxsize=1024)
def _is_installed(module: str | None) -> bool:
    """Whether a module comes with Python or from an installed package, which its name and version stand for."""
    top = (module or "").partition(".")[0]
    file = getattr(sys.modules.get(top), "__file__", None) or "" if top != "__main__" else ""  # of python -m
    return top == "liehom" or top in sys.stdlib_module_names or "-packages" in file


def _with_version(name: str) -> str:
    return f"{name} {getattr(sys.modules.get(name.partition('.')[0]), '__version__', '')}"


# Values of psi at times over the whole span: on a polygon of steps of Euler along each trajectory, and at points of the
# orbits all around the initial points.

WINDOWS = 32  # parts of the span, each with a step of the polygon; at least a quarter of them for a large ensemble
SAMPLES = 1024  # points in a window, divided among the trajectories
ALONE = 8  # calls in a window, if psi takes one point only
LONGEST_MOVE = 2.0  # of a step of the polygon, as a generator
FARTHEST = 1e6  # in units of the initial points; a polygon that goes beyond begins again


def values_of(action: Action, field: GeneratorField, start: Array, span: tuple[Any, Any]) -> str:
    """Digest of psi at times over the whole span and points around the orbits of initial points (..., N)."""
    lead, ones = start.shape[:-1], (1,) * (start.ndim - 1)
    own = lead[: len(lead) - len(field.sites)]  # the sites of a lattice share the times
    places = 0.618033988749895 * np.arange(np.prod(own, dtype=int)).reshape(own + ones[len(own) :]) % 1.0
    lanes = max(1, int(np.prod(lead, dtype=int)))
    rows, windows = max(1, SAMPLES // lanes), max(WINDOWS // 4, min(WINDOWS, WINDOWS * 4 * SAMPLES // lanes))
    numbers, unit = np.arange(rows).reshape(-1, *ones), np.sqrt(2) / (action.max_norm or 1.0)
    x = np.random.default_rng(0).normal(size=(rows, *lead, action.dimension))
    x *= np.pi * unit * (1 - numbers[..., None] / rows) / np.linalg.norm(x, axis=-1, keepdims=True)
    cloud = _moved(action, x, np.broadcast_to(start, (rows, *start.shape)), start)
    m, width, values = start, (span[1] - span[0]) / windows, list[Any]()
    for k in range(windows):
        here = _value(field, m, np.broadcast_to(span[0] + (k + places) * width, lead))
        points = np.where((numbers % 2 == 0)[..., None], m, cloud)
        times = np.broadcast_to(span[0] + (k + (numbers + places) / rows) * width, (rows, *lead))
        several = _value(field, points, times) if rows > 1 else here
        alone = range(0, rows if several.dtype.kind == "U" else 0, -(-rows // ALONE))
        values += [here, several, *(_value(field, points[i], times[i]) for i in alone)]
        if here.dtype.kind != "U":
            size = np.linalg.norm(here * width, axis=-1, keepdims=True) / (LONGEST_MOVE * unit)
            m = _moved(action, here * width / np.maximum(size, 1.0), m, start)
    return digest(*values)


def _value(field: GeneratorField, m: Array, t: Array) -> Array:
    """psi(m, t), or the name of the exception: psi need not be defined off the trajectories."""
    try:
        with np.errstate(all="ignore"):
            return np.asarray(field.psi(m, t[()]))
    except MemoryError:
        raise
    except Exception as error:  # noqa: BLE001 - of the user's function
        return np.array(type(error).__name__)


def _moved(action: Action, x: Array, m: Array, start: Array) -> Array:
    """The points Exp(x) m; the initial points in place of those that are not finite or too far."""
    with np.errstate(all="ignore"):
        points = np.asarray(action.act(x.astype(m.dtype), m))
        bound = FARTHEST * (1 + np.abs(start).max(axis=-1, keepdims=True))
        return np.where(np.abs(points).max(axis=-1, keepdims=True) <= bound, points, start).astype(m.dtype)


# Watches of what was compiled.

LARGEST = 4096  # bytes of a content that is compared in every call; larger arrays are sampled


class Parts:
    """The parts of functions, compared in later calls."""

    def __init__(self, sources: Sequence[Part]) -> None:
        parts = [part for i in range(len(sources)) for part in _walk("", partial(sources.__getitem__, i), {})]
        self._parts: list[tuple[Read, Part]] = [
            (read, x) for label, read, x, _ in parts if label
        ]  # without the sources
        # of those that may change in place: how to read the content, and the content
        self._contents = [looked for _, _, x, is_leaf in parts if is_leaf and (looked := _looked(x)) is not None]

    def changed(self) -> bool:
        """Whether the code of a function, or what it names, is another one than before."""
        for read, x in self._parts:
            if read() is not x and _is_another(read, x):
                return True
        for look, content in self._contents:  # noqa: SIM110 - in every repeated call; a generator costs as much again
            if look() != content:
                return True
        return False


@final
class Watch(Parts):
    """The parts of the psi from which code was compiled, and one value of it, compared in later calls."""

    def __init__(self, field: GeneratorField, start: Values, t: Real | np.floating[Any]) -> None:
        source: Any = source_of(field)
        super().__init__([source])
        self._read: Read = bytes  # returns the value
        if callable(source) and not is_traced(start) and not is_traced(t):
            m = np.array(start if start.size <= LARGEST else start.reshape(-1, start.shape[-1])[0])
            m.flags.writeable = False
            self._read = partial(field._components._function, m, np.full(m.shape[:-1], t)[()])
        self._known: bytes | None = None
        with suppress(Exception):  # of the user's function
            first, second = (np.asarray(self._read()).tobytes() for _ in range(2))
            self._known = first if first == second else None  # a value that varies says nothing
        before = len(self._parts) + len(self._contents)
        # the others are the state of psi
        self._parts = [part for part in self._parts if not _is_another(*part)]
        self._contents = [(look, content) for look, content in self._contents if look() == content]
        # whether psi keeps no state and repeats its value, as far as can be seen
        self.steady: bool = self._known is not None and len(self._parts) + len(self._contents) == before

    def changed(self) -> bool:
        """Whether the code of psi, what it names, or its value at the initial point is another one than before."""
        if Parts.changed(self):  # quicker than super()
            return True
        try:
            return self._known is not None and asarray(self._read()).tobytes() != self._known
        except Exception:  # noqa: BLE001 - of the user's function
            return False


def source_of(field: GeneratorField) -> Part:
    """The function or the expressions given as psi or as a vector field."""
    source: Any = field.source
    while isinstance(source, Components):
        source = source._source
    return source


def _looked(x: Part) -> tuple[Read, object] | None:
    """(how to read the content of a part that may change in place, its content); None if it has none."""
    look: Read = partial(pickle.dumps, x, 5)
    if type(x) in ATOMS or callable(x) or is_jax(x) or isinstance(x, CodeType | ModuleType):
        return None
    if isinstance(x, np.ndarray) and not x.dtype.hasobject:
        entries = x.reshape(-1) if x.flags.c_contiguous else x[tuple(slice(8) for _ in x.shape)]
        look = entries[:: max(1, -(-entries.nbytes // LARGEST))].tobytes
    try:
        return look, look()
    except Exception:  # noqa: BLE001 - what cannot be pickled has no content
        return None


def _is_another(read: Read, x: Part) -> bool:
    """Whether a part is no longer what it was; numbers and strings may be other objects."""
    now = read()
    return now is not x and not (type(now) is type(x) and type(now) in ATOMS and now == x)
