"""Files of algebras, pairs, representations and problems."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeAlias, final

import numpy as np

from liehom.base.budget import within
from liehom.base.errors import FieldError, FormatError, InputError, ParseError, ShapeError
from liehom.base.typing import Array, IntegerArray, VectorLike
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.algebra.linear.closure import lie_closure
from liehom.exact.algebra.linear.complex_matrices import real_matrices
from liehom.exact.representations.core.coordinates import KINDS, Coordinates, require_coordinates
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.core.representation import Representation
from liehom.exact.scalars.complex_parts import UNITS, complex_parts
from liehom.exact.scalars.exact_field import ExactField
from liehom.exact.scalars.field import Field, Matrix, MatrixLike, Scalar
from liehom.exact.scalars.floating import RR
from liehom.exact.scalars.grammar import Node, parse
from liehom.io.json_reader import (
    RawList,
    as_list,
    check_header,
    check_keys,
    field_for,
    is_float64,
    kind_of,
    shown,
    table_of_rows,
    vector,
    write_field,
    write_number,
)

if TYPE_CHECKING:
    from liehom.flow.action.field import GeneratorField
    from liehom.flow.run.solution import Solution
    from liehom.flow.steps.step import Step

# Format of an algebra file: dimension and structure constants [i, j, k, value] with i < j. A pair file has the same
# keys for its algebra, and its reader uses the functions below.

ALGEBRA_FORMAT = "liehom-algebra"
REQUIRED = ("dimension", "structure_constants")
OPTIONAL = ("format", "version", "name", "basis", "field", "arithmetic", "tolerance")
MAX_NAME = 100  # Characters of the longest name


def read_algebra(data: Mapping[str, Any]) -> LieAlgebra:
    """Lie algebra that a parsed JSON object describes, after a proof of the axioms."""
    check_header(data, ALGEBRA_FORMAT)
    check_keys(data, REQUIRED, OPTIONAL, "an algebra file")
    numerical = is_float64(data)
    n = read_dimension(data["dimension"])
    names = read_names(data["basis"], n) if "basis" in data else None
    name = read_name(data["name"], "name") if "name" in data else None
    index, constants = read_entries(data["structure_constants"], n, numerical)
    field = field_for(data, [constants], numerical)
    return LieAlgebra(made_table(field, n, index, constants), basis=names, name=name)


def write_algebra(algebra: LieAlgebra) -> dict[str, Any]:
    """JSON object of an algebra; a name of more than 100 characters is left out."""
    out: dict[str, Any] = {"format": ALGEBRA_FORMAT, "version": 1}
    if algebra.name and algebra.name.isprintable() and len(algebra.name) <= MAX_NAME:
        out["name"] = algebra.name
    return {**out, **algebra_keys(algebra)}


def algebra_keys(algebra: LieAlgebra) -> dict[str, Any]:
    """Keys of an algebra in every file: its field, dimension, basis names and structure constants."""
    out: dict[str, Any] = {**write_field(algebra.field), "dimension": algebra.dimension}
    if algebra.basis_names != tuple(f"e{i}" for i in range(algebra.dimension)):
        out["basis"] = list(algebra.basis_names)
    field = algebra.field
    out["structure_constants"] = [[i, j, k, write_number(field, v)] for i, j, k, v in algebra.structure_constants()]
    return out


# -- parts of a file ----------------------------------------------------------------------------------------------
def read_dimension(value: object) -> int:
    """Dimension, an integer from 0; `FormatError` if the value is not one, `LimitError` if it is too large."""
    if type(value) is not int or value < 0:
        raise FormatError(f"dimension is {shown(value)}, expected an integer from 0")
    within("dimension", value, "the dimension is {}")
    return value


def read_names(value: object, n: int) -> tuple[str, ...]:
    """Distinct printable names of the n basis elements; `FormatError` if the value is not such a list."""
    names = as_list(value, "basis")
    for i, name in enumerate(names):
        read_name(name, f"basis[{i}]")
    if len(names) != n:
        raise FormatError(f"basis has {len(names)} names, the dimension is {n}")
    if len(set(names)) != n:
        twice = next(name for i, name in enumerate(names) if name in names[:i])
        raise FormatError(f"basis gives the name {shown(twice)} twice")
    return tuple(names)


def read_name(value: object, what: str) -> str:
    """Printable name; `FormatError` names the key `what` if the value is not one."""
    if not isinstance(value, str) or not value or not value.isprintable() or len(value) > MAX_NAME:
        raise FormatError(f"{what} is {shown(value)}, expected a printable name of 1 to {MAX_NAME} characters")
    return value


Index: TypeAlias = tuple[IntegerArray, IntegerArray, IntegerArray]  # The columns i, j, k of structure constants


def read_entries(value: object, n: int, floats: bool) -> tuple[Index, RawList]:
    """Columns i, j, k of the structure constants as arrays, and their values."""
    entries = as_list(value, "structure_constants")
    within("entries", len(entries), "there are {} structure constants")
    if not entries:
        empty = np.zeros(0, dtype=np.int64)
        return (empty, empty, empty), RawList.checked((), str)
    if not set(map(type, entries)) <= {list, tuple} or set(map(len, entries)) != {4}:
        _refuse_entry(entries, n)
    i, j, k, values = zip(*entries, strict=True)
    types = set(map(type, i)) | set(map(type, j)) | set(map(type, k))
    if types != {int} or any(min(x) < 0 or max(x) >= n for x in (i, j, k)):
        _refuse_entry(entries, n)
    index = (np.array(i, dtype=np.int64), np.array(j, dtype=np.int64), np.array(k, dtype=np.int64))
    if (index[0] >= index[1]).any():
        _refuse_entry(entries, n)
    flat = (index[0] * n + index[1]) * n + index[2]
    if len(np.unique(flat)) < len(flat):
        _refuse_duplicate(entries)
    return index, RawList.checked(values, lambda x: _position(entries, x), floats=floats)


def _position(entries: list[Any], x: int) -> str:
    i, j, k = entries[x][:3]
    return f"the value of structure_constants[{x}] (i, j, k = {i}, {j}, {k})"


def _refuse_entry(entries: list[Any], n: int) -> None:
    """Raise for the first entry that is not [i, j, k, value] with 0 <= i < j < n and 0 <= k < n."""
    for x, entry in enumerate(entries):
        position = f"structure_constants[{x}]"
        if not isinstance(entry, (list, tuple)):
            raise FormatError(f"{position} is {kind_of(entry)}, expected [i, j, k, value]")
        if len(entry) != 4:
            raise FormatError(f"{position} has {len(entry)} items, expected [i, j, k, value]")
        for name, index in zip("ijk", entry[:3], strict=True):
            if type(index) is not int:
                raise FormatError(f"{position}: the index {name} is {shown(index)}, expected an integer")
            if not 0 <= index < n:
                raise FormatError(
                    f"{position}: the index {name} = {shown(index)} is out of range, expected 0 to {n - 1}"
                )
        if entry[0] >= entry[1]:
            raise FormatError(
                f"{position} has i = {entry[0]} and j = {entry[1]}: only i < j is listed, "
                "[e_j, e_i] = -[e_i, e_j] is understood"
            )


def _refuse_duplicate(entries: list[Any]) -> None:
    first: dict[tuple[int, int, int], int] = {}
    for x, (i, j, k, _) in enumerate(entries):
        if (i, j, k) in first:
            raise FormatError(
                f"structure_constants[{x}] gives (i, j, k) = ({i}, {j}, {k}) again, after entry {first[i, j, k]}"
            )
        first[i, j, k] = x


def made_table(field: Field, n: int, index: Index, values: RawList) -> StructureConstants:
    """Structure constants from indices and values; zero values are dropped."""
    if isinstance(field, ExactField):
        integers = values.integers()
        if integers is not None:
            return StructureConstants.from_integers(field, n, *index, integers)
    columns = zip(*(column.tolist() for column in index), values.numbers(field), strict=True)
    return StructureConstants(field, n, [entry for entry in columns if entry[3] != 0])


# Formats of a pair and of a subalgebra: dimension, structure constants [i, j, k, value] with i < j, rows of h.

PAIR_FORMAT, SUBALGEBRA = "liehom-pair", "liehom-subalgebra"
PAIR_REQUIRED = ("dimension", "structure_constants", "subalgebra")
PAIR_OPTIONAL = ("format", "version", "basis", "field", "arithmetic", "tolerance")


def read_pair(data: Mapping[str, Any]) -> Pair:
    """Pair that a parsed JSON object describes, after a proof of the axioms."""
    check_header(data, PAIR_FORMAT)
    hint = "" if "subalgebra" in data else f' (the file of an algebra alone has "format": "{ALGEBRA_FORMAT}")'
    check_keys(data, PAIR_REQUIRED, PAIR_OPTIONAL, f"a pair file{hint}")
    subalgebra = _subalgebra(data)
    return Pair(subalgebra.algebra, subalgebra)


def read_subalgebra(data: Mapping[str, Any]) -> Subalgebra:
    """Subalgebra that a parsed JSON object describes, with its algebra, after a proof of the axioms."""
    check_header(data, SUBALGEBRA)
    check_keys(data, PAIR_REQUIRED, (*PAIR_OPTIONAL, "name"), "a subalgebra file")
    return _subalgebra(data)


def _subalgebra(data: Mapping[str, Any]) -> Subalgebra:
    numerical = is_float64(data)
    n = read_dimension(data["dimension"])
    names = read_names(data["basis"], n) if "basis" in data else None
    name = read_name(data["name"], "name") if "name" in data else None
    index, constants = read_entries(data["structure_constants"], n, numerical)
    rows, k, _ = table_of_rows(data["subalgebra"], "subalgebra", n, floats=numerical)
    field = field_for(data, [constants, rows], numerical)
    table = made_table(field, n, index, constants)
    return LieAlgebra(table, basis=names, name=name).subalgebra(rows.matrix(field, k, n))


def write_pair(pair: Pair) -> dict[str, Any]:
    """JSON object of a pair."""
    return {"format": PAIR_FORMAT, "version": 1, **algebra_keys(pair.algebra), **_rows(pair.subalgebra)}


def write_subalgebra(subalgebra: Subalgebra) -> dict[str, Any]:
    """JSON object of a subalgebra, with its algebra."""
    return {**write_algebra(subalgebra.algebra), "format": SUBALGEBRA, **_rows(subalgebra)}


def _rows(subalgebra: Subalgebra) -> dict[str, Any]:
    field = subalgebra.algebra.field
    return {"subalgebra": [[write_number(field, x) for x in row] for row in subalgebra.rows()]}


# Problem of a file: a representation, an initial point, a vector field and the options of an integration. The vector
# field is X(m, t) = rho(psi(m, t)) m with psi from "generator", or X itself from "vector_field". Options are checked
# when the file is read; the names among them (base, exponential, clock) are looked up at the integration.

OPTIONS = ("t_span", "t_eval", "dt", "rtol", "atol", "base", "order", "exponential", "clock")
NUMERICAL = ("generator", "vector_field", *OPTIONS)
FUNCTIONS = ("sqrt", "sin", "cos", "tan", "exp", "log", "sinh", "cosh", "tanh")
MAX_ORDER = 100  # Largest order that a file may ask for
BASE = "lietaylor"


@final
@dataclass(frozen=True, slots=True)
class Problem:
    """Problem of a representation file: the representation, the initial point, the vector field and the options.

    Attributes
    ----------
    representation : Representation
    point : tuple or None
        The point as numbers of the representation's field; None if the file has no point or its numbers are not there.
    start : tuple of float or None
        The initial point: the point rounded to float64.
    generator : tuple of Node or None
        psi: one parsed coefficient per given matrix, in the names m0, m1, ..., t (`liehom.exact.scalars.grammar`).
    options : mapping
        The options of the file, from t_span, t_eval, dt, rtol, atol, base, order, exponential and clock.
    vector_field : tuple of Node or None
        X: one parsed component per coordinate of m, if the file has a vector field instead of a generator.

    Examples
    --------
    >>> import liehom as lh
    >>> text = '{"matrices": [[[0, -1], [1, 0]]], "point": [1, 0], "generator": ["1 + m0**2"], "dt": 0.1}'
    >>> problem = lh.io.loads(text, problem=True)
    >>> problem.start, problem.options["dt"], problem.pair()
    ((1.0, 0.0), 0.1, <pair of dimensions 1/0 over QQ>)
    """

    representation: Representation
    point: tuple[Scalar, ...] | None
    start: tuple[float, ...] | None
    generator: tuple[Node, ...] | None
    options: Mapping[str, Any]
    vector_field: tuple[Node, ...] | None = None

    def pair(self) -> Pair:
        """Pair (algebra, isotropy subalgebra of the point); `FormatError` if no point of the field is given."""
        if self.point is None:
            why = "the file has no 'point'" if self.start is None else "the point has floats, the matrices are exact"
            raise FormatError(f"{why}, so it describes no pair")
        return self.representation.pair(self.point)

    def field(self) -> GeneratorField:
        """Vector field as a GeneratorField; a file's vector field gets the generator of minimal norm.

        Raises
        ------
        FormatError
            If the file states neither a generator nor a vector field.

        Examples
        --------
        >>> import liehom as lh
        >>> text = '{"matrices": [[[0, -1], [1, 0]]], "vector_field": ["-t*m1", "t*m0"]}'
        >>> lh.io.loads(text, problem=True).field()
        <time-dependent generator field of <representation of <Lie algebra of dimension 1 over QQ> on QQ^2>>
        """
        from liehom.flow.action.field import GeneratorField

        if self.generator is not None:
            return GeneratorField(self.representation, self.generator)
        if self.vector_field is not None:
            return GeneratorField.from_vector_field(self.representation, self.vector_field)
        raise FormatError("the file has neither 'generator' nor 'vector_field', so there is no field to integrate")

    def step(self, base: str | None = None, order: int | None = None) -> Step:
        """Step with the given base and order; without them the options of the file, else "lietaylor".

        Examples
        --------
        >>> import liehom as lh
        >>> text = '{"matrices": [[[0, -1], [1, 0]]], "base": "euler", "order": 3}'
        >>> problem = lh.io.loads(text, problem=True)
        >>> problem.step(), problem.step("heun"), problem.step(order=1)
        (Corrected(Euler(), order=3), Corrected(Heun(), order=3), Euler())
        """
        from liehom.flow.methods.named import step_named

        named = self.options.get("base", BASE) if base is None else base
        return step_named(named, self.options.get("order") if order is None else order)

    def integrate(self, *, base: str | None = None, order: int | None = None, **overrides: Any) -> Solution:
        """Solution from the initial point over t_span, with the options of the file.

        Parameters
        ----------
        base, order : optional
            As for `step`.
        **overrides
            Arguments of `liehom.integrate`; each overrides the option of the same name.

        Raises
        ------
        FormatError
            If the vector field, the point or t_span is missing.
        InputError
            If the vector field is not finite at the initial point, and as `liehom.integrate`.

        Examples
        --------
        >>> import liehom as lh
        >>> text = '{"matrices": [[[0, -1], [1, 0]]], "point": [1, 0], "generator": ["1"], "t_span": [0, "1/2"]}'
        >>> solution = lh.io.loads(text, problem=True).integrate()
        >>> solution.y[:, -1].round(6).tolist()
        [0.877583, 0.479426]
        """
        from liehom.flow.propagation.integration import integrate

        field = self.field()
        options = {key: x for key, x in self.options.items() if key not in ("base", "order")} | overrides
        step = options.pop("step", None) or self.step(base, order)
        t_span = options.pop("t_span", None)
        if t_span is None:
            raise FormatError("the file has no 't_span': add \"t_span\": [start, end], or give one")
        start = options.pop("y0", None)
        if start is None:
            start = self.checked_start(float(t_span[0]))
        return integrate(field, t_span, start, step=step, **options)

    def checked_start(self, t: float) -> Array:
        """Initial point as an array of shape (N,), after a check that the vector field is finite there at time t.

        Raises
        ------
        FormatError
            If the file has no point.
        InputError
            If a component of the generator or vector field is not finite at the initial point.

        Examples
        --------
        >>> import liehom as lh
        >>> text = '{"matrices": [[[0, -1], [1, 0]]], "point": [0, 1], "generator": ["1/m0"]}'
        >>> lh.io.loads(text, problem=True).checked_start(0.0)
        Traceback (most recent call last):
        ...
        liehom.base.errors.InputError: generator[0] is inf at the start m = (0.0, 1.0), t = 0.0; ...
        """
        import numpy as np

        if self.start is None:
            raise FormatError("the file has no 'point', so there is no start: add \"point\": [...]")
        for what, trees in (("generator", self.generator), ("vector_field", self.vector_field)):
            for i, tree in enumerate(trees or ()):
                value = _value(tree, np.array(self.start), t, f"{what}[{i}]")
                if not np.isfinite(value):
                    raise InputError(
                        f"{what}[{i}] is {value} at the start m = {shown_point(self.start)}, t = {t}; "
                        "take another point, or a field that is defined there"
                    )
        return np.array(self.start)


def _value(tree: Node, m: Array, t: float, what: str) -> float:
    """Value of one component at a point."""
    import numpy as np

    from liehom.flow.action.components import Components

    try:
        with np.errstate(all="ignore"):
            return float(Components([tree], len(m), (1,), what)(m, np.float64(t))[0])
    except ParseError as error:
        raise ParseError(f"{what}: {error}") from None
    except (FieldError, OverflowError):
        raise InputError(f"{what} has a number beyond the range of float64 (1.8e308)") from None


def shown_point(point: tuple[float, ...], most: int = 8) -> str:
    """String of a point for messages: all coordinates, or the first `most`."""
    return str(point) if len(point) <= most else f"({', '.join(map(repr, point[:most]))}, ...)"


# -- from JSON -------------------------------------------------------------------------------------------
def read_fields(data: Mapping[str, Any], count: int, size: int) -> dict[str, tuple[Node, ...]]:
    """Parsed "generator" (one string per given matrix) or "vector_field" (one string per coordinate)."""
    functions = {key: data[key] for key in ("generator", "vector_field") if key in data}
    if len(functions) == 2:
        raise FormatError("the file has a 'generator' and a 'vector_field', expected one of them")
    wanted = {"generator": (count, "given matrix"), "vector_field": (size, "coordinate")}
    return {key: _read_expressions(key, value, *wanted[key], size) for key, value in functions.items()}


def _read_expressions(key: str, value: object, count: int, per: str, size: int) -> tuple[Node, ...]:
    expressions = as_list(value, key)
    if len(expressions) != count:
        raise FormatError(f"{key} has {len(expressions)} entries, expected one per {per}, {count}")
    names = frozenset([*(f"m{i}" for i in range(size)), "t"])
    trees = []
    for a, text in enumerate(expressions):
        if not isinstance(text, str):
            raise FormatError(f"{key}[{a}] is {shown(text)}, expected a string such as '1 + m0**2'")
        try:
            trees.append(parse(text, names, FUNCTIONS))
        except ParseError as error:
            raise ParseError(f"{key}[{a}]: {error}") from None
    return tuple(trees)


def read_options(data: Mapping[str, Any]) -> dict[str, Any]:
    """Checked options of a JSON object, from those in `OPTIONS`."""
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


# Format of a representation file: matrices, optionally a point and the options of a numerical problem. The matrices are
# the first basis elements of the algebra; missing brackets are appended in lexicographic order.

REPRESENTATION_FORMAT = "liehom-representation"
REPRESENTATION_OPTIONAL = (
    "format",
    "version",
    "field",
    "arithmetic",
    "tolerance",
    "coordinates",
    "dimension",
    "point",
    *NUMERICAL,
)


def read_problem(data: Mapping[str, Any]) -> Problem:
    """Problem that the parsed JSON object of a representation file states, after a check of all keys."""
    check_header(data, REPRESENTATION_FORMAT)
    check_keys(data, ("matrices",), REPRESENTATION_OPTIONAL, "a representation file")
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
    """Representation of a file, or the pair that its point determines."""
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
    matrices = []
    for a, table in enumerate(tables):
        what = f"matrices[{a}]"
        if len(as_list(table, what)) != size:
            raise ShapeError(f"{what} has {len(table)} rows, matrices[0] has {size}: all must have one square shape")
        matrices.append(table_of_rows(table, what, size, floats=floats)[0])
    return matrices, size


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
    numbers: list[Scalar] = []
    for x, value in enumerate(point.values):
        try:
            numbers += map(field.convert, complex_parts(value, field))
        except ParseError as error:
            raise ParseError(f"{point.where(x)}: {error}") from None
        except FieldError as error:
            raise FormatError(f"{point.where(x)}: {error}") from None
    return numbers


def _coordinates(data: Mapping[str, Any], is_complex: bool) -> Coordinates:
    """Kind of the coordinates: complex if the matrices are complex, else the value of the key `coordinates`."""
    coordinates = data.get("coordinates", "complex" if is_complex else "real")
    for kind in KINDS:
        if coordinates == kind and (kind == "complex" or not is_complex):
            return kind
    known = "'complex', since the matrices are" if is_complex else ", ".join(map(repr, KINDS))
    raise FormatError(f"coordinates is {shown(coordinates)}, expected {known}")


def _closed(matrices: Sequence[Matrix], data: Mapping[str, Any], coordinates: Coordinates) -> Representation:
    """Representation that the matrices generate; a dimension that the file states must be right."""
    if "dimension" in data:
        dimension = read_dimension(data["dimension"])
        closure = lie_closure(matrices, close=dimension > len(matrices), limit=dimension)
        if closure.algebra.dimension != dimension:
            raise FormatError(f"the matrices generate dimension {closure.algebra.dimension}, the file says {dimension}")
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
    """JSON object of a representation by real matrices, with a point if one is given."""
    field = representation.field
    out: dict[str, Any] = {"format": REPRESENTATION_FORMAT, "version": 1, **write_field(field)}
    generators = representation.matrices[: representation.given]
    if representation.coordinates != "real":
        out["coordinates"] = representation.coordinates
    out["matrices"] = [[[write_number(field, x) for x in row] for row in a.to_rows()] for a in generators]
    if point is not None:
        out["point"] = [write_number(field, field.convert(x)) for x in representation.real_point(point)]
    return out
