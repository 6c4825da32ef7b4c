"""The format of a representation: matrices, optionally a point and the options of a numerical problem.

The matrices are the first basis elements of the algebra; missing brackets are appended in lexicographic
order.  Generator strings give one coefficient per matrix in m0, m1, ..., t and elementary functions.
Imports json_text, values, representations.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, final

from liehom.algebra.closure import lie_closure
from liehom.errors import FormatError, ParseError, ShapeError
from liehom.io.json_text import as_list, check_header, check_keys, is_float64, shown
from liehom.io.pair_file import read_dimension
from liehom.io.values import RawList, field_for, table_of_rows, vector, write_field, write_number
from liehom.representations.pair import Pair
from liehom.representations.representation import Representation
from liehom.scalars import RR
from liehom.scalars.grammar import Node, parse

FORMAT = "liehom-representation"
NUMERICAL = ("generator", "t_span", "t_eval", "dt", "rtol", "atol", "base", "order", "exponential", "clock")
OPTIONAL = ("format", "version", "field", "arithmetic", "dimension", "point", *NUMERICAL)
FUNCTIONS = ("sqrt", "sin", "cos", "tan", "exp", "log", "sinh", "cosh", "tanh")
MAX_ORDER = 100


@final
@dataclass(frozen=True, slots=True)
class Problem:
    """What a representation file states: the representation, the start and the options of an integration.

    Attributes
    ----------
    representation : Representation
    point : tuple or None
        The point in the field of the representation, if it is given and lies there.
    start : tuple of float or None
        The point rounded to float64.
    generator : tuple of Node or None
        One parsed coefficient per given matrix, in the names m0, m1, ..., t (`liehom.scalars.grammar`).
    options : mapping
        Those of t_span, t_eval, dt, rtol, atol, base, order, exponential, clock that the file states.

    Examples
    --------
    >>> import liehom as lh
    >>> text = '{"matrices": [[[0, -1], [1, 0]]], "point": [1, 0], "generator": ["1 + m0**2"], "dt": 0.1}'
    >>> problem = lh.io.loads(text, problem=True)
    >>> problem.start, problem.options["dt"], problem.pair()
    ((1.0, 0.0), 0.1, <pair of dimensions 1/0 over QQ>)
    """

    representation: Representation
    point: tuple[Any, ...] | None
    start: tuple[float, ...] | None
    generator: tuple[Node, ...] | None
    options: Mapping[str, Any]

    def pair(self) -> Pair:
        """The pair (algebra, isotropy subalgebra of the point); `FormatError` without a point in the field."""
        if self.point is None:
            why = "the file has no 'point'" if self.start is None else "the point has floats, the matrices are exact"
            raise FormatError(f"{why}, so it describes no pair")
        return self.representation.pair(self.point)


def read_problem(data: Mapping[str, Any]) -> Problem:
    """What a parsed JSON object of a representation file states; everything in it is checked.

    Raises
    ------
    FormatError, ParseError, ShapeError, DependentRowsError, NotClosedError
    """
    check_header(data, FORMAT)
    check_keys(data, ("matrices",), OPTIONAL, "a representation file")
    numerical = is_float64(data)
    tables, size = _read_matrices(data["matrices"], numerical)
    point = vector(data["point"], "point", floats=True) if "point" in data else None
    if point is not None and len(point.values) != size:
        raise ShapeError(f"point has {len(point.values)} coordinates, the matrices act on {size}")
    in_field = point is not None and (numerical or float not in set(map(type, point.values)))
    field: Any = field_for(data, [*tables, point] if point is not None and in_field else tables, numerical)
    generator = _read_generator(data["generator"], len(tables), size) if "generator" in data else None
    options = _read_options(data)
    matrices = [raw.matrix(field, size, size) for raw in tables]
    exact_point = tuple(point.numbers(field)) if point is not None and in_field else None
    if exact_point is not None:
        start: tuple[float, ...] | None = tuple(field.to_float(x) for x in exact_point)
    else:
        start = None if point is None else tuple(point.numbers(RR))
    representation = _closed(matrices, data)
    return Problem(representation, exact_point, start, generator, MappingProxyType(options))


def read_representation(data: Mapping[str, Any]) -> Pair | Representation:
    """The representation of a file, or the pair that it determines where the file has a point.

    Examples
    --------
    >>> read_representation({"matrices": [[[0, 1], [0, 0]], [[0, 0], [1, 0]]], "point": [1, 0]})
    <pair of dimensions 3/1 over QQ>
    """
    problem = read_problem(data)
    if "point" not in data:
        return problem.representation
    if problem.point is None:
        vector(data["point"], "point")  # raises, and shows the fraction to write
    return problem.pair()


def _read_matrices(value: Any, floats: bool) -> tuple[list[RawList], int]:
    tables = as_list(value, "matrices")
    if not tables:
        raise FormatError("matrices is empty, so the space that they act on is not known")
    size = len(as_list(tables[0], "matrices[0]"))
    found = []
    for a, table in enumerate(tables):
        what = f"matrices[{a}]"
        if len(as_list(table, what)) != size:
            raise ShapeError(f"{what} has {len(table)} rows, matrices[0] has {size}: all must have one square shape")
        found.append(table_of_rows(table, what, size, floats=floats)[0])
    return found, size


def _closed(matrices: list[Any], data: Mapping[str, Any]) -> Representation:
    """The representation; with a declared dimension, the matrices must generate just that."""
    if "dimension" in data:
        dimension = read_dimension(data["dimension"])
        made = lie_closure(matrices, close=dimension > len(matrices), limit=dimension)
        if made.algebra.dimension != dimension:
            raise FormatError(f"the matrices generate dimension {made.algebra.dimension}, the file says {dimension}")
    return Representation.from_matrices(matrices)


# -- options of a numerical problem ----------------------------------------------------------------------
def _read_generator(value: Any, count: int, size: int) -> tuple[Node, ...]:
    texts = as_list(value, "generator")
    if len(texts) != count:
        raise FormatError(f"generator has {len(texts)} entries, expected one per given matrix, {count}")
    names = frozenset([*(f"m{i}" for i in range(size)), "t"])
    trees = []
    for a, text in enumerate(texts):
        if not isinstance(text, str):
            raise FormatError(f"generator[{a}] is {shown(text)}, expected a text such as '1 + m0**2'")
        try:
            trees.append(parse(text, names, FUNCTIONS))
        except ParseError as error:
            raise ParseError(f"generator[{a}]: {error}") from None
    return tuple(trees)


def _read_options(data: Mapping[str, Any]) -> dict[str, Any]:
    options: dict[str, Any] = {}
    for key in ("t_span", "t_eval"):
        if key in data:
            options[key] = tuple(vector(data[key], key, floats=True).numbers(RR))
    if "t_span" in options and len(options["t_span"]) != 2:
        raise FormatError(f"t_span has {len(options['t_span'])} entries, expected [start, end]")
    for key in ("dt", "rtol", "atol"):
        if key in data:
            (options[key],) = vector([data[key]], key, floats=True).numbers(RR)
            if options[key] <= 0:
                raise FormatError(f"{key} is {shown(data[key])}, expected a positive number")
    for key in ("base", "exponential", "clock"):
        if key in data:
            if not isinstance(data[key], str) or not data[key].isprintable() or not 0 < len(data[key]) <= 100:
                raise FormatError(f"{key} is {shown(data[key])}, expected a name")
            options[key] = data[key]
    if "order" in data:
        if type(data["order"]) is not int or not 1 <= data["order"] <= MAX_ORDER:
            raise FormatError(f"order is {shown(data['order'])}, expected an integer from 1 to {MAX_ORDER}")
        options["order"] = data["order"]
    return options


def write_representation(representation: Representation, point: Any = None) -> dict[str, Any]:
    """The JSON object of a representation by matrices, with a point where one is given.

    Examples
    --------
    >>> import liehom as lh
    >>> write_representation(lh.Representation.from_matrices([[[0, -1], [1, 0]]]), [1, 0])["point"]
    ['1', '0']
    """
    field = representation.field
    out: dict[str, Any] = {"format": FORMAT, "version": 1, **write_field(field)}
    given = representation.matrices[: representation.given]
    out["matrices"] = [[[write_number(field, x) for x in row] for row in a.to_rows()] for a in given]
    if point is not None:
        out["point"] = [write_number(field, field.convert(x)) for x in point]
    return out
