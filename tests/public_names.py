"""The public names of liehom with their parameters, one a line.

Written anew by `python -m tests.public_names > tests/public_names.txt`.
"""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Iterator
from pathlib import Path

FILE = Path(__file__).with_suffix(".txt")
PACKAGES = [
    "liehom",
    "liehom.errors",
    "liehom.scalars",
    "liehom.algebra",
    "liehom.representations",
    "liehom.series",
    "liehom.homogeneous",
    "liehom.fullness",
    "liehom.correctors",
    "liehom.integrators",
    "liehom.instances",
    "liehom.catalog",
    "liehom.atlas",
    "liehom.io",
    "liehom.parallel",
    "liehom.plotting",
    "liehom.pages",
    "liehom.paper",
    "liehom.testing",
    "liehom.tracing",
]


def parameters(thing: object) -> str:
    """Names, kinds and defaults of the parameters; no annotations, which may become more precise."""
    try:
        signature = inspect.signature(thing)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return ""
    bare = [p.replace(annotation=inspect.Parameter.empty) for p in signature.parameters.values()]
    text = str(inspect.Signature(bare))
    return re.sub(r"<(?:function|class|object)? ?'?([\w.]+)'?(?: at 0x[0-9a-f]+)?>", r"\1", text)


def members(name: str, cls: type) -> Iterator[str]:
    for member in sorted({m for base in cls.__mro__ if base.__module__.startswith("liehom") for m in vars(base)}):
        if member.startswith("_"):
            continue
        value = inspect.getattr_static(cls, member)
        if isinstance(value, property) or not (callable(value) or isinstance(value, staticmethod | classmethod)):
            yield f"{name}.{member}"
        else:
            yield f"{name}.{member}{parameters(getattr(cls, member))}"


def exported(package: str) -> list[str]:
    """What a package hands on: every `X as X` of its `__init__`, and what it defines there itself."""
    module = importlib.import_module(package)
    text = Path(str(module.__file__)).read_text(encoding="utf-8")
    handed = set(re.findall(r"import (\w+) as \1\b", text))
    own = {n for n, v in vars(module).items() if getattr(v, "__module__", None) == package and not n.startswith("_")}
    return sorted(handed | own)


def lines() -> Iterator[str]:
    for package in PACKAGES:
        for name in exported(package):
            thing = getattr(importlib.import_module(package), name)
            if inspect.isclass(thing):
                yield f"{package}.{name}{parameters(thing)}"
                if package != "liehom":  # written once, under the package that the class comes from
                    yield from members(f"{package}.{name}", thing)
            elif callable(thing):
                yield f"{package}.{name}{parameters(thing)}"
            else:
                yield f"{package}.{name}"


if __name__ == "__main__":
    print("\n".join(lines()))
