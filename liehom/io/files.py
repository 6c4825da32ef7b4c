"""Reading and writing of JSON files: load, load_pair, load_problem, loads, from_json, to_json, dump."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from typing import Any, Literal, overload

from liehom.base.disk import MARK, write_file
from liehom.base.errors import FormatError
from liehom.base.typing import VectorLike
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.core.representation import Representation
from liehom.io import object_files
from liehom.io.json_reader import Source, json_checksum, kind_of, parse_object, read_object, shown
from liehom.io.object_files import Problem

READERS: dict[str, Callable[[Mapping[str, Any]], LieAlgebra | Subalgebra | Pair | Representation]] = {
    object_files.ALGEBRA_FORMAT: object_files.read_algebra,
    object_files.SUBALGEBRA: object_files.read_subalgebra,
    object_files.PAIR_FORMAT: object_files.read_pair,
    object_files.REPRESENTATION_FORMAT: object_files.read_representation,
}
KINDS = {
    object_files.ALGEBRA_FORMAT: "an algebra file",
    object_files.SUBALGEBRA: "a subalgebra file",
    object_files.PAIR_FORMAT: "a pair file",
}


def load(path: Source) -> LieAlgebra | Subalgebra | Pair | Representation:
    """LieAlgebra, Subalgebra, Pair or Representation in a file.

    A representation file with a point gives the Pair that the point determines.

    Parameters
    ----------
    path : path_like or binary file
        A JSON file of a format in docs/formats.md: its path, or the file open in binary mode, as ``sys.stdin.buffer``.

    Raises
    ------
    FormatError, ParseError, ShapeError
        If the file is not of the documented form; names the key and the index.
    JacobiError, NotASubalgebraError, DependentRowsError, NotClosedError
        If the data are not a Lie algebra, a pair or a representation.

    Notes
    -----
    An algebra file must state ``"format": "liehom-algebra"``, a subalgebra file ``"liehom-subalgebra"``. A file
    without `format` is a representation file if it has `matrices`, else a pair file.

    Examples
    --------
    >>> import liehom as lh, tempfile, os
    >>> file = os.path.join(tempfile.mkdtemp(), "pair.json")
    >>> lh.io.dump(lh.Pair(lh.LieAlgebra({}, dimension=2), []), file)
    >>> lh.io.load(file)
    <pair of dimensions 2/0 over QQ>
    """
    return from_json(read_object(path))


def load_pair(path: Source) -> Pair:
    """Pair in a pair or subalgebra file, or in a representation file with a point.

    Raises
    ------
    FormatError
        As `load`, and if the file is an algebra file, or a representation file without a point.

    Examples
    --------
    >>> import os, tempfile
    >>> import liehom as lh
    >>> path = os.path.join(tempfile.mkdtemp(), "sphere.json")
    >>> lh.dump(lh.pair("so(3)/so(2)"), path)
    >>> load_pair(path)
    <pair of dimensions 3/1 over QQ>
    """
    loaded = load(path)
    if isinstance(loaded, LieAlgebra):
        raise FormatError("this is an algebra file, which names no subalgebra, so it describes no pair")
    if isinstance(loaded, Subalgebra):
        return Pair(loaded.algebra, loaded)
    if not isinstance(loaded, Pair):
        raise FormatError("this representation file has no 'point', so it describes no pair")
    return loaded


def load_problem(path: Source) -> Problem:
    """Problem in a representation file, with its point, generator and options; the point may have floats.

    Raises
    ------
    FormatError, ParseError, ShapeError, DependentRowsError, NotClosedError
        As `load`, and if the file is a pair or an algebra file.

    Examples
    --------
    >>> import liehom as lh, tempfile, os
    >>> file = os.path.join(tempfile.mkdtemp(), "rotation.json")
    >>> rotation = {"matrices": [[[0, -1], [1, 0]]], "point": [0.6, 0.8], "generator": ["m0"], "dt": 0.1}
    >>> lh.io.dump(rotation, file)
    >>> problem = load_problem(file)
    >>> problem.start, dict(problem.options)
    ((0.6, 0.8), {'dt': 0.1})
    """
    return _problem(read_object(path))


@overload
def loads(text: str) -> LieAlgebra | Subalgebra | Pair | Representation: ...


@overload
def loads(text: str, *, problem: Literal[True]) -> Problem: ...


def loads(text: str, *, problem: bool = False) -> LieAlgebra | Subalgebra | Pair | Representation | Problem:
    """The object in a JSON string, as `load` reads a file; with `problem`, the Problem.

    Examples
    --------
    >>> loads('{"dimension": 1, "structure_constants": [], "subalgebra": []}')
    <pair of dimensions 1/0 over QQ>
    """
    data = parse_object(text)
    return _problem(data) if problem else from_json(data)


def from_json(data: Mapping[str, Any]) -> LieAlgebra | Subalgebra | Pair | Representation:
    """LieAlgebra, Subalgebra, Pair or Representation in a parsed JSON object, as `load` reads a file.

    Examples
    --------
    >>> from_json({"dimension": 2, "structure_constants": [[0, 1, 2, "1"]], "subalgebra": []})
    Traceback (most recent call last):
    ...
    liehom.base.errors.FormatError: structure_constants[0]: the index k = 2 is out of range, expected 0 to 1
    """
    return READERS[_format(data)](data)


def _problem(data: Mapping[str, Any]) -> Problem:
    if _format(data) in KINDS:
        raise FormatError(f"this is {KINDS[_format(data)]}, expected a representation file, with 'matrices'")
    return object_files.read_problem(data)


def _format(data: object) -> str:
    """The format that the object states; else the representation format if it has matrices, else the pair format."""
    if not isinstance(data, Mapping):
        raise FormatError(f"a file holds one JSON object {{...}}, this is {kind_of(data)}")
    stated = data.get("format")
    if stated == "liehom-classification":
        raise FormatError("this is a classification, not a pair; liehom.fullness.Classification.from_json reads it")
    if stated == "liehom-certificate" or {"full", "proved"} <= data.keys():
        kind = "a certificate" if stated is not None else "a verdict"
        raise FormatError(
            f"this is {kind}, not an algebra, a pair or a representation; `liehom verify` checks a certificate, "
            "liehom.Certificate.from_json reads one"
        )
    if stated is not None and (not isinstance(stated, str) or stated not in READERS):
        *others, last = map(repr, READERS)
        raise FormatError(f"format is {shown(stated)}, expected {', '.join(others)} or {last}")
    if stated is None:
        return object_files.REPRESENTATION_FORMAT if "matrices" in data else object_files.PAIR_FORMAT
    return str(stated)


def to_json(obj: object, *, point: VectorLike | None = None) -> dict[str, Any]:
    """JSON object of an algebra, subalgebra, pair, representation (with a point, if given), certificate or verdict.

    A mapping is returned as it is, as a dict.

    Raises
    ------
    FormatError
        If `obj` is of another type.

    Examples
    --------
    >>> import liehom as lh
    >>> to_json(lh.Pair(lh.LieAlgebra({(0, 1): {1: "1/2"}}), [[1, 0]]))["structure_constants"]
    [[0, 1, 1, '1/2']]
    """
    if isinstance(obj, LieAlgebra):
        return object_files.write_algebra(obj)
    if isinstance(obj, Subalgebra):
        return object_files.write_subalgebra(obj)
    if isinstance(obj, Pair):
        return object_files.write_pair(obj)
    if isinstance(obj, Representation):
        return object_files.write_representation(obj, point)
    if isinstance(obj, Mapping):
        return dict(obj)
    method = getattr(obj, "to_json", None)
    if callable(method):
        return dict(method())
    raise FormatError(
        f"a {type(obj).__name__} has no file format; expected a (sub)algebra, pair, representation or certificate"
    )


def dump(obj: object, path: str | os.PathLike[str], *, point: VectorLike | None = None, checksum: bool = False) -> None:
    """Write the JSON object `to_json(obj)` to a file, with one line per entry or row.

    Parameters
    ----------
    obj : object
        What `to_json` accepts.
    path : path_like
    point : array_like, optional
        The point of a representation file.
    checksum : bool
        Whether the file has a checksum, so that reading it notices every change. The file cannot then be edited
        without deleting the key `checksum`.

    Raises
    ------
    FormatError
        If `obj` has no file format, or the file cannot be written. An existing file is then unchanged.

    Examples
    --------
    >>> import liehom as lh, tempfile, os
    >>> file = os.path.join(tempfile.mkdtemp(), "pair.json")
    >>> dump(lh.Pair(lh.LieAlgebra({(0, 1): {1: 2}}), [[1, 0]]), file)
    >>> with open(file, encoding="utf-8") as written:
    ...     print(written.read())
    {"format": "liehom-pair",
     "version": 1,
     "dimension": 2,
     "structure_constants": [
      [0, 1, 1, "2"]
     ],
     "subalgebra": [
      ["1", "0"]
     ]}
    """
    data = to_json(obj, point=point)
    if checksum:
        data[MARK] = json_checksum(data)
    write_file(path, _laid_out(data).encode())


def _laid_out(data: dict[str, Any]) -> str:
    """JSON with one key per line, and lists of lists with one inner list per line."""
    parts = []
    for key, value in data.items():
        if isinstance(value, list) and value and isinstance(value[0], list):
            inner = ",\n  ".join(json.dumps(x, allow_nan=False) for x in value)
            parts.append(f"{json.dumps(key)}: [\n  {inner}\n ]")
        else:
            parts.append(f"{json.dumps(key)}: {json.dumps(value, allow_nan=False)}")
    return "{" + ",\n ".join(parts) + "}\n"
