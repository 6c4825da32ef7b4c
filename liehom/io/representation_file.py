"""Format of a representation file: matrices, optionally a point and the options of a numerical problem.

The matrices are the first basis elements of the algebra; missing brackets are appended in lexicographic order.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

from liehom.algebra.closure.closure import lie_closure
from liehom.algebra.closure.complex_matrices import real_matrices
from liehom.errors import FieldError, FormatError, InputError, ParseError, ShapeError
from liehom.io.algebra_file import read_dimension
from liehom.io.json_reader import as_list, check_header, check_keys, is_float64, shown
from liehom.io.number_lists import RawList, field_for, table_of_rows, vector, write_field, write_number
from liehom.io.problem_file import NUMERICAL, Problem, read_fields, read_options
from liehom.representations.core.coordinates import KINDS, Coordinates, require_coordinates
from liehom.representations.core.pair import Pair
from liehom.representations.core.representation import Representation
from liehom.scalars import RR, Field, Matrix, Scalar
from liehom.scalars.fields.complex_parts import UNITS, complex_parts
from liehom.scalars.fields.field import MatrixLike
from liehom.typing import VectorLike

FORMAT = "liehom-representation"
OPTIONAL = ("format", "version", "field", "arithmetic", "tolerance", "coordinates", "dimension", "point", *NUMERICAL)


def read_problem(data: Mapping[str, Any]) -> Problem:
    """Problem that the parsed JSON object of a representation file states, after a check of all keys.

    Raises
    ------
    FormatError, ParseError, ShapeError
        If the object is malformed; names the key and the index.
    DependentRowsError, NotClosedError
        If the matrices are dependent, or generate another dimension than the file states.
    """
    check_header(data, FORMAT)
    check_keys(data, ("matrices",), OPTIONAL, "a representation file")
    numerical = is_float64(data)
    tables, size = _read_matrices(data["matrices"], numerical)
    is_complex = any(raw.has_complex() for raw in tables) and not _is_generator_called_i(data)
    point = vector(data["point"], "point", floats=True) if "point" in data else None
    size = 2 * size if is_complex else size
    coordinates = _coordinates(data, is_complex)
    if point is not None and len(point.values) not in (size, size // 2 if coordinates == "complex" else size):
        what = f"{size // 2} complex or {size} real coordinates" if coordinates == "complex" else f"{size}"
        raise ShapeError(f"point has {len(point.values)} coordinates, the matrices act on {what}")
    in_field = point is not None and (numerical or float not in set(map(type, point.values)))
    field: Field = field_for(data, [*tables, point] if point is not None and in_field else tables, numerical)
    fields = read_fields(data, len(tables), size)
    options = read_options(data)
    if is_complex:
        matrices = [_complex_matrix(raw, field, size // 2, a) for a, raw in enumerate(tables)]
    else:
        matrices = [raw.matrix(field, size, size) for raw in tables]
    exact_point = tuple(_real_numbers(point, field, size)) if point is not None and in_field else None
    if exact_point is not None:
        start: tuple[float, ...] | None = tuple(field.to_float(x) for x in exact_point)
    else:
        start = None if point is None else tuple(map(RR.convert, _real_numbers(point, RR, size)))
    representation = _closed(matrices, data, coordinates)
    return Problem(
        representation,
        exact_point,
        start,
        fields.get("generator"),
        MappingProxyType(options),
        fields.get("vector_field"),
    )


def read_representation(data: Mapping[str, Any]) -> Pair | Representation:
    """Representation of a file, or the pair that its point determines.

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


def _read_matrices(value: object, floats: bool) -> tuple[list[RawList], int]:
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


def _is_generator_called_i(data: Mapping[str, Any]) -> bool:
    """Whether the file states a number field whose generator is called i or I: the letter is then a real number."""
    field = data.get("field")
    return isinstance(field, Mapping) and field.get("name") in UNITS


def _complex_matrix(raw: RawList, field: Field, n: int, index: int) -> Matrix:
    """Real matrix (2n, 2n) of n rows of n complex values."""
    try:
        return real_matrices([[raw.values[i * n : (i + 1) * n] for i in range(n)]], field, start=index)[0]
    except FieldError as error:
        raise FormatError(str(error)) from None


def _real_numbers(point: RawList, field: Field, size: int) -> list[Scalar]:
    """Real coordinates of a point with `size` real or half as many complex values."""
    if len(point.values) == size:
        return point.numbers(field)
    found: list[Scalar] = []
    for x, value in enumerate(point.values):
        try:
            found += map(field.convert, complex_parts(value, field))
        except ParseError as error:
            raise ParseError(f"{point.where(x)}: {error}") from None
        except FieldError as error:
            raise FormatError(f"{point.where(x)}: {error}") from None
    return found


def _coordinates(data: Mapping[str, Any], is_complex: bool) -> Coordinates:
    """Kind of the coordinates: complex if the matrices are complex, else the value of the key `coordinates`."""
    found = data.get("coordinates", "complex" if is_complex else "real")
    for kind in KINDS:
        if found == kind and (kind == "complex" or not is_complex):
            return kind
    known = "'complex', since the matrices are" if is_complex else ", ".join(map(repr, KINDS))
    raise FormatError(f"coordinates is {shown(found)}, expected {known}")


def _closed(matrices: Sequence[Matrix], data: Mapping[str, Any], coordinates: Coordinates) -> Representation:
    """Representation that the matrices generate; a dimension that the file states must be right."""
    if "dimension" in data:
        dimension = read_dimension(data["dimension"])
        made = lie_closure(matrices, close=dimension > len(matrices), limit=dimension)
        if made.algebra.dimension != dimension:
            raise FormatError(f"the matrices generate dimension {made.algebra.dimension}, the file says {dimension}")
    rho = Representation.from_matrices(matrices, independent=False)
    if coordinates == "real":
        return rho
    try:
        require_coordinates(coordinates, rho.matrices, rho.size)
    except InputError as error:
        raise FormatError(f"coordinates: {error}") from None
    # the same matrices, which act on such vectors
    return Representation(
        rho.algebra,
        rho.matrices,
        size=rho.size,
        given=rho.given,
        appended=rho.appended,
        coordinates=coordinates,
        check=False,
    )


def write_representation(
    representation: Representation, point: VectorLike | MatrixLike | None = None
) -> dict[str, Any]:
    """JSON object of a representation by real matrices, with a point if one is given.

    Examples
    --------
    >>> import liehom as lh
    >>> write_representation(lh.Representation.from_matrices([[[0, -1], [1, 0]]]), [1, 0])["point"]
    ['1', '0']
    """
    field = representation.field
    out: dict[str, Any] = {"format": FORMAT, "version": 1, **write_field(field)}
    given = representation.matrices[: representation.given]
    if representation.coordinates != "real":
        out["coordinates"] = representation.coordinates
    out["matrices"] = [[[write_number(field, x) for x in row] for row in a.to_rows()] for a in given]
    if point is not None:
        out["point"] = [write_number(field, field.convert(x)) for x in representation.real_point(point)]
    return out
