"""Immutable: base of the classes whose public attributes are set once, by their constructor."""

from __future__ import annotations

_UNSET = object()


class Immutable:
    """Objects whose public attributes cannot be changed after construction.

    An attribute is set once: by the constructor, or by pickle, which fills a new object. Attributes whose names begin
    with an underscore are caches of what the public ones determine, and stay assignable.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.so(3).name = "so(4)"
    Traceback (most recent call last):
    ...
    AttributeError: LieAlgebra is immutable: name cannot be assigned; construct another object
    """

    __slots__ = ()

    def __setattr__(self, name: str, value: object) -> None:
        if name[0] != "_" and getattr(self, name, _UNSET) is not _UNSET:
            raise AttributeError(
                f"{type(self).__name__} is immutable: {name} cannot be assigned; construct another object"
            )
        object.__setattr__(self, name, value)

    def __delattr__(self, name: str) -> None:
        if name[:1] != "_":
            raise AttributeError(f"{type(self).__name__} is immutable: {name} cannot be deleted")
        object.__delattr__(self, name)
