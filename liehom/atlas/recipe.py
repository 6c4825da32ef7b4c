"""Recipes: pairs described by a function and its arguments, so that a worker constructs them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import final

from liehom.errors import InputError, shown
from liehom.representations import Pair


@final
@dataclass(frozen=True, slots=True)
class Recipe:
    """One pair of a family: its name, and the function call that constructs it.

    A recipe is small and can be pickled. A family of thousands of pairs is therefore a generator of recipes, and each
    pair is constructed in the process that decides it.

    Attributes
    ----------
    name : str
        The pair in the notation of the field, such as ``"su(3)/so(3)"``; unique in its family. If it is a catalogue
        name, the pair is the one of the catalogue.
    family : str
        Name of the family.
    make : callable
        A function at the level of a module; ``make(*arguments)`` returns the pair.
    arguments : tuple
        Values with a `repr` that determines them: strings, numbers, and tuples of these.
    known : mapping
        Facts known from the construction by name, booleans, integers or strings: ``{"rank": 1}`` for a symmetric pair.

    Raises
    ------
    InputError
        If `make` is not a function at the level of a module, or a name is empty.

    Examples
    --------
    >>> import liehom as lh
    >>> recipe = lh.atlas.Recipe("so(4)/so(3)", "spheres", lh.pair, ("so(4)/so(3)",), {"rank": 1})
    >>> recipe.pair()
    pair('so(4)/so(3)')
    >>> recipe.key
    "liehom.catalog.pairs.pair('so(4)/so(3)')"
    """

    name: str
    family: str
    make: Callable[..., Pair]
    arguments: tuple[object, ...] = ()
    known: Mapping[str, bool | int | str] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        if not self.name or not self.family:
            raise InputError(f"a recipe has a name and a family; found {self.name!r} and {self.family!r}")
        if not getattr(self.make, "__qualname__", "").isidentifier():
            raise InputError(
                f"make is {shown(repr(self.make))}, expected a function at the level of a module; "
                "values that it needs are given in `arguments`"
            )

    @property
    def key(self) -> str:
        """The function call as a string; equal for two recipes of the same pair by the same function."""
        called = ", ".join(repr(value) for value in self.arguments)
        return f"{self.make.__module__}.{self.make.__qualname__}({called})"

    def pair(self) -> Pair:
        """The pair, constructed at each call.

        Raises
        ------
        InputError
            If `make` returns an object that is not a `Pair`.
        """
        made = self.make(*self.arguments)
        if not isinstance(made, Pair):
            raise InputError(f"{self.key} returned {shown(repr(made))}, expected a Pair")
        return made
