"""The public names of liehom with their parameters, one a line.

Written anew by `python -m tests.public_names > tests/public_names.txt`.
"""

import importlib
import inspect
import re
from collections.abc import Iterator
from pathlib import Path

from liehom.base.lazy import stub_names

FILE = Path(__file__).with_suffix(".txt")
PACKAGES = [
    "liehom",
    *(f"liehom.base.{module}" for module in ("budget", "errors", "pytrees", "store", "tasks")),
    *(
        f"liehom.exact.{package}"
        for package in ("scalars", "algebra", "representations", "orbits", "fullness", "pauli", "catalog")
    ),
    *(
        f"liehom.flow.{package}"
        for package in (
            "tracing",
            "series",
            "action",
            "steps",
            "methods",
            "run",
            "engines",
            "propagation",
            "convergence",
            "bodies",
            "spins",
        )
    ),
    *(f"liehom.studies.{package}" for package in ("instances", "paper", "atlas")),
    "liehom.io",
    "liehom.plotting",
    "liehom.testing",
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
    """The names of the stub of a package, those of `__all__`, or those that a module defines itself."""
    module = importlib.import_module(package)
    stub = Path(str(module.__file__)).with_suffix(".pyi")
    if stub.exists():
        return sorted(stub_names(stub))
    own = [n for n, v in vars(module).items() if getattr(v, "__module__", None) == package and not n.startswith("_")]
    return sorted(getattr(module, "__all__", own))


def lines() -> Iterator[str]:
    written = set()
    for package in PACKAGES:
        for name in exported(package):
            thing = getattr(importlib.import_module(package), name)
            if inspect.isclass(thing):
                yield f"{package}.{name}{parameters(thing)}"
                if package != "liehom" and thing not in written:  # once, under the first package that lists the class
                    written.add(thing)
                    yield from members(f"{package}.{name}", thing)
            elif callable(thing):
                yield f"{package}.{name}{parameters(thing)}"
            else:
                yield f"{package}.{name}"


if __name__ == "__main__":
    print("\n".join(lines()))
