"""From names in prose to entries of the API: what ``lh.integrate``, `Pair.is_primitive` or `where_it_fails` denotes.

A name in code markup is linked only if it denotes one entry:

* a dotted path from `lh` or `liehom`,
* a class and its member, or a variable such as `g` or `rho` and a member of its class,
* a short name that one entry has and no parameter, or in a docstring a member of the same class.

A path from `lh` or `liehom` that leads nowhere is an error of the page. The module needs no Sphinx.
"""

from __future__ import annotations

import functools
import importlib
import inspect
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator
from typing import Any

OURS = re.compile(r"(?<![\w./])(?:lh|liehom)((?:\.[A-Za-z_]\w*)+)")
NAME = re.compile(r"([A-Za-z]\w*(?:\.[A-Za-z]\w*)*)(\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*\))?")
VARIABLES = {
    "g": ["liehom.exact.algebra.LieAlgebra"],
    "algebra": ["liehom.exact.algebra.LieAlgebra"],
    "h": ["liehom.exact.algebra.Subalgebra"],
    "subalgebra": ["liehom.exact.algebra.Subalgebra"],
    "family": ["liehom.exact.algebra.LieAlgebraFamily"],
    "form": ["liehom.exact.algebra.RealForm"],
    "rho": ["liehom.exact.representations.Representation"],
    "representation": ["liehom.exact.representations.Representation"],
    "pair": ["liehom.exact.representations.Pair"],
    "verdict": [
        "liehom.exact.fullness.NotFull",
        "liehom.exact.fullness.Full",
        "liehom.exact.fullness.NumericallyNotFull",
    ],
    "certificate": ["liehom.exact.fullness.Certificate"],
    "sol": ["liehom.flow.run.Solution"],
    "solution": ["liehom.flow.run.Solution"],
    "report": ["liehom.flow.run.Report"],
    "propagator": ["liehom.flow.propagation.Propagator"],
    "field": ["liehom.flow.action.GeneratorField", "liehom.exact.scalars.Field"],
    "step": ["liehom.flow.steps.Step"],
    "table": ["liehom.flow.convergence.ConvergenceTable"],
    "action": ["liehom.flow.action.Action"],
    "module": ["liehom.exact.representations.HighestWeightModule"],
    "body": ["liehom.studies.rigid_body.RigidBody"],
}
"""The classes of variables by their names, as the pages use them."""

WORDS = frozenset(["abelian", "adjoint", "affine", "character", "conformal", "defining", "limits", "simple", "trivial"])
"""Names of functions that pages use as values and adjectives; they are linked with `lh.` or arguments only."""


def object_at(path: str) -> Any:
    """The object of a dotted path from `liehom`, and None if there is none; modules are imported on the way."""
    names = path.split(".")
    thing: Any = importlib.import_module(names[0])
    for i, name in enumerate(names[1:], 2):
        try:
            thing = getattr(thing, name)
        except AttributeError:
            try:
                thing = importlib.import_module(".".join(names[:i]))
            except ImportError:
                return None
    return thing


@functools.cache
def parameters(path: str) -> frozenset[str]:
    """Names of the parameters of an entry."""
    try:
        return frozenset(inspect.signature(object_at(path)).parameters)
    except (TypeError, ValueError):
        return frozenset()


class Names:
    """The entries of the API by every name that denotes them.

    Parameters
    ----------
    entries : iterable of str
        Dotted names of the entries, members of classes included.
    """

    def __init__(self, entries: Iterable[str]) -> None:
        self.entries = frozenset(entries)
        self.by_object: dict[int, str] = {}
        self.top: dict[str, set[str]] = defaultdict(set)
        self.members: dict[str, set[str]] = defaultdict(set)
        self.parameters: set[str] = set()
        for entry in sorted(self.entries):
            owner, _, last = entry.rpartition(".")
            if owner in self.entries:
                self.members[last].add(entry)
            elif "." in entry:
                self.top[last].add(entry)
                thing = object_at(entry)
                if callable(thing) or type(thing).__module__.startswith("liehom"):
                    self.by_object[id(thing)] = entry
            self.parameters |= parameters(entry)
        import liehom

        self.exported = frozenset(dir(liehom))

    def of_path(self, path: str) -> str | None:
        """The entry of a path from `liehom`: itself, another name of the same object, or that of its class.

        Raises
        ------
        LookupError
            If there is no such object. An object without entry gives None.
        """
        if path in self.entries:
            return path
        thing = object_at(path)
        if thing is None:
            raise LookupError(path)
        if inspect.ismodule(thing):
            return None
        owner, _, last = path.rpartition(".")
        return self.by_object.get(id(thing)) or (
            self.of_member(owner, last) if inspect.isclass(object_at(owner)) else None
        )

    def of_member(self, owner: str, last: str) -> str | None:
        """The entry of a member of a class, or of a class from which it has the member; else that of the class."""
        cls = object_at(owner)
        for base in cls.__mro__:
            entry = f"{self.by_object.get(id(base))}.{last}"
            if entry in self.entries:
                return entry
        has = hasattr(cls, last) or last in parameters(owner)
        return self.by_object.get(id(cls)) if has else None

    def paths(self, text: str) -> Iterator[str]:
        """Paths from `lh` or `liehom` in a string."""
        for match in OURS.finditer(text):
            yield f"liehom{match[1]}"

    def meant(self, text: str, within: str = "", *, bare_names_are_keys: bool = False) -> str | None:
        """The entry that a string in code markup denotes, None if it denotes none or several.

        Parameters
        ----------
        text : str
            The text, such as "lh.so(3)" or "g.killing_form()".
        within : str, optional
            The entry in whose docstring the text is, or the package that the page is about.
        bare_names_are_keys : bool, optional
            Whether lower-case words of the page are keys or options, not names of Python.

        Raises
        ------
        LookupError
            If the text has a path from `lh` or `liehom` that leads nowhere.
        """
        if paths := list(dict.fromkeys(self.paths(text))):
            targets = [self.of_path(path) for path in paths]
            return targets[0] if len(set(targets)) == 1 or OURS.match(text) else None
        match = NAME.fullmatch(text)
        if match is None:
            return None
        first, _, rest = match[1].partition(".")
        if rest:
            return self.dotted(first, rest)
        inner = within in self.entries
        if inner and (entry := self.near(first, within)):
            return entry
        if not inner and f"{within}.{first}" in self.entries and not (match[2] and self.is_constructor(first)):
            return f"{within}.{first}"
        return None if bare_names_are_keys and first[0].islower() else self.alone(first, called=match[2] is not None)

    def is_constructor(self, name: str) -> bool:
        """Whether a name with arguments, such as `affine(so(3))`, is rather one of the catalogue."""
        thing = object_at(f"liehom.exact.algebra.{name}")
        return inspect.isroutine(thing) and ".constructions." in thing.__module__

    def dotted(self, first: str, rest: str) -> str | None:
        """The entry of `variable.member`, `Class.member` or `package.name`."""
        last, _, more = rest.partition(".")
        owners = VARIABLES.get(first) or sorted(self.top.get(first, ()))
        if first not in VARIABLES and len(owners) > 1:
            return None
        for owner in owners:
            if not more and inspect.isclass(object_at(owner)) and (entry := self.of_member(owner, last)):
                return entry
        path = f"liehom.{first}.{rest}"
        return None if object_at(path) is None else self.of_path(path)

    def near(self, name: str, within: str) -> str | None:
        """The entry of a name in a docstring: a member of the same class, or a name of the same package."""
        owner = within if inspect.isclass(object_at(within)) else within.rpartition(".")[0]
        if name in parameters(within) or (owner in self.entries and name in parameters(owner)):
            return None
        if f"{owner}.{name}" in self.entries and (owner in self.entries or name not in self.parameters):
            return f"{owner}.{name}"
        package = owner.rpartition(".")[0]
        return f"{package}.{name}" if f"{package}.{name}" in self.entries and name not in self.parameters else None

    def alone(self, name: str, *, called: bool) -> str | None:
        """The entry of a name without a path: a class, a function with more than a word as name, or a method."""
        whole, members = self.top.get(name, set()), self.members.get(name, set())
        if len(whole) == 1:
            [entry] = whole
            if name[0].isupper():
                return entry if len(name) > 1 else None
            word = name in self.parameters or len(name) < 4 or (name not in self.exported and "_" not in name)
            return None if word or (self.is_constructor(name) if called else name in WORDS) else entry
        if not whole and len(members) == 1 and "_" in name and name not in self.parameters:
            [entry] = members
            return entry
        return None
