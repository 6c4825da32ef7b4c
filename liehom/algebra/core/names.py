"""Brackets and elements by the names of basis elements: {("x", "y"): {"z": 1}}, {"x": 2, "z": -1}, "x"."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from typing import Any, TypeAlias

from liehom.display import Typeset
from liehom.errors import InputError, ShapeError, StructureError, displayed
from liehom.scalars import Field, Scalar
from liehom.scalars.fields.field import MatrixLike
from liehom.typing import ElementLike, ScalarLike

NamedConstants: TypeAlias = Mapping[tuple[str, str], Mapping[str, ScalarLike]]
"""Structure constants as ``{(name, name): {name: value}}``."""

RowsLike: TypeAlias = MatrixLike | Sequence[ElementLike]
"""Input that a Lie algebra reads as several elements: rows of coefficients, names, {name: coefficient}."""

SHOWN_NAMES = 12


def is_named(constants: object) -> bool:
    """Whether a mapping of brackets has names for basis elements; `StructureError` if some are names, some indices.

    Examples
    --------
    >>> is_named({("x", "y"): {"z": 1}}), is_named({(0, 1): {2: 1}}), is_named({})
    (True, False, False)
    """
    if not isinstance(constants, Mapping):
        return False
    found = list(_labels(constants))
    named = [isinstance(x, str) for x in found]
    if any(named) and not all(named):
        name, index = found[named.index(True)], found[named.index(False)]
        raise StructureError(
            "brackets have names or indices for basis elements, not both; got the name "
            f"{displayed(name)} and {displayed(index)}"
        )
    return any(named)


def _labels(constants: Mapping[Any, Any]) -> Iterable[Any]:
    """The basis elements of a mapping of brackets in order of first appearance, perhaps repeated."""
    for pair, row in constants.items():
        if isinstance(pair, tuple) and len(pair) == 2 and isinstance(row, Mapping):
            yield from (*pair, *row)
        elif isinstance(pair, str):
            raise StructureError(
                f"{displayed(pair)}: {displayed(row)} is not a bracket; write {{('x', 'y'): {{'z': value}}}}"
            )


def by_index(
    constants: Mapping[Any, Any], basis: Sequence[str] | None
) -> tuple[dict[tuple[int, int], dict[int, Any]], tuple[str, ...]]:
    """Brackets by name as brackets by index, and the names: those given, else in order of first appearance.

    Raises
    ------
    StructureError
        If a name is not in the given basis; lists the nearest names.

    Examples
    --------
    >>> by_index({("h", "e"): {"e": 2}, ("h", "f"): {"f": -2}, ("e", "f"): {"h": 1}}, None)
    ({(0, 1): {1: 2}, (0, 2): {2: -2}, (1, 2): {0: 1}}, ('h', 'e', 'f'))
    """
    names = tuple(dict.fromkeys(_labels(constants))) if basis is None else tuple(map(str, basis))
    made = {}
    for pair, row in constants.items():
        if not (isinstance(pair, tuple) and len(pair) == 2 and isinstance(row, Mapping)):
            raise StructureError(
                f"{displayed(pair)}: {displayed(row)} is not a bracket; write {{('x', 'y'): {{'z': value}}}}"
            )
        i, j = (index_of(names, x, StructureError) for x in pair)
        made[i, j] = {index_of(names, x, StructureError): value for x, value in row.items()}
    return made, names


def index_of(names: Sequence[str], name: str, error: type[InputError] = InputError) -> int:
    """The index of a basis element; raises `error` with the nearest names if there is none of this name.

    Examples
    --------
    >>> index_of(("x1", "y1", "z"), "y")
    Traceback (most recent call last):
    ...
    liehom.errors.InputError: no basis element is named 'y'; the nearest is y1
    """
    if name in names:
        return names.index(name)
    near = get_close_matches(str(name), names, n=3, cutoff=0.4)
    shown = ", ".join(names[:SHOWN_NAMES]) + (", ..." if len(names) > SHOWN_NAMES else "")
    hint = f"the nearest {'is' if len(near) == 1 else 'are'} {', '.join(near)}" if near else f"the names are {shown}"
    raise error(f"no basis element is named {displayed(name)}; {hint}")


def coefficients(names: Sequence[str], x: str | Mapping[str, ScalarLike]) -> list[ScalarLike]:
    """The coefficient vector of a basis element by its name, or of a linear combination {name: coefficient}.

    Examples
    --------
    >>> coefficients(("x", "y", "z"), "y"), coefficients(("x", "y", "z"), {"z": "1/2", "x": -1})
    ([0, 1, 0], [-1, 0, '1/2'])
    """
    given = {x: 1} if isinstance(x, str) else x
    made: list[ScalarLike] = [0] * len(names)
    for name, value in given.items():
        if not isinstance(name, str):
            raise ShapeError(
                f"an element is given by names of basis elements or by a sequence, got the key {displayed(name)}"
            )
        made[index_of(names, name)] = value
    return made


def linear_combination(field: Field, names: Sequence[str], values: Iterable[Scalar]) -> list[str]:
    """The terms of a linear combination of names, such as ['x', '-y', '(1 + sqrt(2))*z'].

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> linear_combination(QQ, ["x", "y"], [QQ.convert(-1), QQ.convert("1/2")])
    ['-x', '1/2*y']
    """
    terms = []
    for name, v in zip(names, values, strict=True):
        if v != 0:
            value = field.show(v)
            sign = "" if value == "1" else "-" if value == "-1" else f"({value})*" if " " in value else f"{value}*"
            terms.append(f"{sign}{name}")
    return terms


class LinearCombination(Typeset, str):
    """String of an element as a linear combination of names, which a notebook shows as a formula.

    Elements themselves are numpy arrays, so that they can be used everywhere; an array does not know the names.

    Attributes
    ----------
    field : Field
    names : sequence of str
    values : sequence of scalars

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> LinearCombination(QQ, ["x", "y"], [QQ.convert(1), QQ.convert("-1/2")])
    'x - 1/2*y'
    """

    field: Field
    names: Sequence[str]
    values: Sequence[Scalar]

    def __new__(cls, field: Field, names: Sequence[str], values: Sequence[Scalar]) -> LinearCombination:
        text = " + ".join(linear_combination(field, names, values)).replace("+ -", "- ") or "0"
        made = super().__new__(cls, text)
        made.field, made.names, made.values = field, names, values
        return made

    def __getnewargs__(self) -> tuple[Field, Sequence[str], Sequence[Scalar]]:  # type: ignore[override]
        return self.field, self.names, self.values
