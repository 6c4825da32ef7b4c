"""Finished results on disk: stores of arrays, and many small records in a file."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import warnings
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import lru_cache
from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO, TypeAlias, TypeVar, final

import numpy as np
import numpy.typing as npt

from liehom.base.disk import (
    DAMAGED,
    MARK,
    check_version,
    checksum,
    differing,
    json_object,
    read_arrays,
    write_arrays,
    write_atomically,
)
from liehom.base.errors import CertificateError, DamageWarning, FormatError, InputError, LimitError

# Stores of finished results on disk: a folder of .npz files, or a zarr group.
#
# A shard is written under a temporary name and then renamed, so a reader never sees a partial shard. Each shard, and
# the description of the store, has a checksum of its contents. A store has the fingerprint of its problem and contains
# no pickles.

T = TypeVar("T")

FORMAT = "liehom-store"
VERSION = 2
ABOUT = "store.json"  # File in the folder of a store with its format, version and fingerprint

Shard: TypeAlias = tuple[dict[str, npt.NDArray[Any]], dict[str, Any]]  # Arrays by name, and a JSON object of facts


class Store(ABC):
    """Shards by name on disk, the result of `open_store`.

    Examples
    --------
    >>> import os, tempfile
    >>> store = open_store(os.path.join(tempfile.mkdtemp(), "runs"), "abc")
    >>> store.save("part-0", {"y": np.zeros(3)}, {"status": 0})
    >>> sorted(store.names()), store.load("part-0")[1]
    (['part-0'], {'status': 0})
    """

    path: str
    _mark: str  # the fingerprint, which enters the checksums

    @abstractmethod
    def names(self) -> frozenset[str]:
        """The names of all complete shards."""

    @abstractmethod
    def save(self, name: str, arrays: Mapping[str, npt.ArrayLike], facts: Mapping[str, object]) -> None:
        """Write a shard, replacing a shard of the same name."""

    @abstractmethod
    def load(self, name: str) -> Shard:
        """The arrays and facts of a shard.

        Raises
        ------
        FormatError
            If the shard does not exist or is damaged.
        """

    def restored(self, name: str, read: Callable[[dict[str, npt.NDArray[Any]], dict[str, Any]], T]) -> T | None:
        """The result of `read` for a shard, or None, with a `DamageWarning`, if the shard is damaged.

        Parameters
        ----------
        name : str
        read : callable
            A function of the arrays and the facts, which may raise `FormatError` or `CertificateError`.
        """
        try:
            return read(*self.load(name))
        except (FormatError, CertificateError) as error:
            text = f"the shard {name!r} of the store {self.path!r} is damaged and is computed again: {error}"
            warnings.warn(DamageWarning(text), stacklevel=2)
            return None

    def __repr__(self) -> str:
        return f"<store {self.path!r}>"


def open_store(path: str | os.PathLike[str], fingerprint: str | None = None) -> Store:
    """The store at a path, created if it does not exist.

    Parameters
    ----------
    path : path_like
        A folder, or a zarr group if the path ends in .zarr (extra ``distributed``).
    fingerprint : str, optional
        Identifies the problem; a store with another fingerprint raises `InputError`. None opens an existing store of
        any problem.

    Raises
    ------
    InputError
        If the store belongs to another problem, or cannot be written.
    FormatError
        If the path has other content, or the fingerprint is None and there is no store.

    Examples
    --------
    >>> import os, tempfile
    >>> path = os.path.join(tempfile.mkdtemp(), "runs")
    >>> open_store(path, "abc").names()
    frozenset()
    >>> open_store(path, "abd")  # doctest: +IGNORE_EXCEPTION_DETAIL
    Traceback (most recent call last):
    ...
    liehom.base.errors.InputError: the store ... belongs to another problem ...
    """
    try:
        name = os.fsdecode(path)
    except TypeError:
        raise InputError(f"store is {path!r}, expected the path of a folder") from None
    kind = _Zarr if name.rstrip("/").endswith(".zarr") else _Folder
    return kind(name, fingerprint)


@final
class _Folder(Store):
    """A folder with one .npz file for each shard."""

    def __init__(self, path: str, fingerprint: str | None) -> None:
        self.path = path
        self._folder = Path(path)
        about = self._folder / ABOUT
        if not about.exists():
            if fingerprint is None:
                raise _no_store(path)
            if self._folder.exists() and not _is_empty(self._folder) and not about.exists():  # or just made by another
                raise FormatError(f"{path!r} exists and is not a store of liehom: give the path of a new folder")
            with writing(path):
                self._folder.mkdir(parents=True, exist_ok=True)
            self._write(ABOUT, json.dumps(_about(fingerprint)).encode())
        try:
            description = json_object(about.read_text(encoding="utf-8"))
        except DAMAGED as error:
            raise FormatError(f"{os.fspath(about)!r} is damaged: {error}") from None
        self._mark = _checked(path, description, fingerprint)

    def names(self) -> frozenset[str]:
        # unfinished files begin with a dot
        return frozenset(f.stem for f in self._folder.iterdir() if f.suffix == ".npz" and not f.name.startswith("."))

    def save(self, name: str, arrays: Mapping[str, npt.ArrayLike], facts: Mapping[str, object]) -> None:
        buffer = BytesIO()
        write_arrays(buffer, arrays, {"facts": json.dumps(facts)}, self._mark, name)
        self._write(f"{name}.npz", buffer.getbuffer())

    def load(self, name: str) -> Shard:
        path = self._folder / f"{name}.npz"
        try:
            with open(path, "rb") as file:
                arrays, (facts,), is_whole = read_arrays(file, ["facts"], self._mark, name)
            _require_whole(is_whole)
            return arrays, json_object(facts)
        except LimitError:
            raise
        except DAMAGED as error:
            raise _damaged(os.fspath(path), error) from None

    def _write(self, name: str, data: bytes | memoryview) -> None:
        with writing(self.path):
            write_atomically(self._folder / name, data)


@final
class _Zarr(Store):
    """A zarr group with one group for each shard."""

    def __init__(self, path: str, fingerprint: str | None) -> None:
        try:
            import zarr
        except ImportError:
            raise InputError(f"the store {path!r} is a zarr group: pip install zarr, or leave .zarr") from None
        self.path = path
        if fingerprint is None and not os.path.isdir(path):
            raise _no_store(path)
        try:
            self._root: Any = zarr.open_group(path, mode="a")
        except DAMAGED as error:
            raise FormatError(f"{path!r} is not a zarr group: {error}") from None
        description = dict(self._root.attrs)
        if not description:
            if fingerprint is None:
                raise _no_store(path)
            description = _about(fingerprint)
            self._root.attrs.update(description)
        self._mark = _checked(path, description, fingerprint)

    def names(self) -> frozenset[str]:
        with os.scandir(self.path) as entries:
            return frozenset(entry.name for entry in entries if entry.is_dir() and self._is_complete(entry.name))

    def _is_complete(self, name: str) -> bool:
        """Whether a shard has facts, or is damaged: `load` then says so."""
        try:
            return "facts" in self._root[name].attrs
        except DAMAGED:
            return True

    def save(self, name: str, arrays: Mapping[str, npt.ArrayLike], facts: Mapping[str, object]) -> None:
        text = json.dumps(facts)
        with writing(self.path):
            part = self._root.create_group(name, overwrite=True)
            for key, array in arrays.items():
                part[key] = np.asarray(array)
            mark = checksum(arrays, self._mark, name, text)
            part.attrs.update({MARK: mark, "facts": text})  # last: a shard without facts is incomplete

    def load(self, name: str) -> Shard:
        try:
            part = self._root[name]
            arrays = {key: np.asarray(part[key][...]) for key in part.array_keys()}
            text = str(part.attrs["facts"])
            _require_whole(part.attrs.get(MARK) == checksum(arrays, self._mark, name, text))
            return arrays, json_object(text)
        except DAMAGED as error:
            raise _damaged(f"{self.path}/{name}", error) from None


@contextlib.contextmanager
def writing(path: str) -> Iterator[None]:
    """Context in which errors of the file system become `InputError`."""
    try:
        yield
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"the store {path!r} cannot be written: {reason}") from None


# -- private helpers -------------------------------------------------------------------------------------
def _about(fingerprint: str) -> dict[str, Any]:
    about = {"format": FORMAT, "version": VERSION, "fingerprint": fingerprint}
    return {**about, MARK: checksum({}, json.dumps(about))}


def _checked(path: str, description: dict[str, Any], fingerprint: str | None) -> str:
    """The fingerprint that a store has in its description."""
    check_version(path, "store", f"{description.get('format')} {description.get('version')}", f"{FORMAT} {VERSION}")
    own = str(description.get("fingerprint"))
    if description != _about(own):
        raise FormatError(f"the description of the store {path!r} is damaged: delete the store, or give another path")
    if fingerprint is not None and (different := differing(own, fingerprint)):
        raise InputError(
            f"the store {path!r} belongs to another problem ({different} differ): delete it, or give another path"
        )
    return own


def _require_whole(is_whole: bool) -> None:
    if not is_whole:
        raise ValueError("its checksum does not agree with its contents")


def _is_empty(folder: Path) -> bool:
    """Whether a path is a folder without files; unfinished files, which begin with a dot, do not count."""
    return folder.is_dir() and all(file.name.startswith(".") for file in folder.iterdir())


def _no_store(path: str) -> FormatError:
    return FormatError(f"there is no store of liehom at {path!r}")


def _damaged(path: str, error: BaseException) -> FormatError:
    return FormatError(f"the shard {path!r} is missing or damaged ({error}): delete it, and it is computed again")


# Shards without arrays, many in a file: the entries of a sweep, of which there may be millions.
#
# A file ``records-000000.jsonl`` has a line ``{"name": ..., "facts": {...}, "checksum": ...}`` for each shard, and only
# grows. Each process that writes begins a file of its own, and the next one after a full file. A line has reached the
# operating system when `append` returns, so it survives the end of the process, however sudden. A file is flushed to
# the disk when it is full or closed. An interruption may leave half a line at the end of a file; it is ignored.

LINES = 4096  # Lines of a full file
BYTES = 1 << 26  # Size of a full file with fewer lines
OFFSETS = 1 << 40  # More than the bytes of a file
READ_AHEAD = 1 << 16  # Bytes that are read after a line
FILE = re.compile(r"records-(\d{6,})\.jsonl")
# Begin of a line, with the name as JSON
NAME = re.compile(rb'\{"name": ("(?:[ !#-\[\]-~]|\\u[0-9a-f]{4}|\\["\\bfnrt])*"), ')


@final
class Records(Store):
    """A store in which shards without arrays share files; a context manager that closes the file it writes.

    Parameters
    ----------
    store : Store
        The store that holds all other shards.

    Notes
    -----
    In memory are a digest of 16 bytes and the place of each shard in the files, some 150 bytes for both.

    Examples
    --------
    >>> import tempfile
    >>> from liehom.base.store import open_store
    >>> path = os.path.join(tempfile.mkdtemp(), "runs")
    >>> with Records(open_store(path, "abc")) as records:
    ...     records.append([("so(3)", {"dimension": 3}), ("so(4)", {"dimension": 6})])
    ...
    >>> records = Records(open_store(path, "abc"))
    >>> "so(5)" in records, sorted(records.names()), records.load("so(4)")
    (False, ['so(3)', 'so(4)'], ({}, {'dimension': 6}))
    """

    def __init__(self, store: Store) -> None:
        self.path, self._mark, self._others = store.path, store._mark, store
        self._other_names = store.names()
        self._places: dict[bytes, int] = {}  # by digests of names: OFFSETS * number of the file + offset in it
        self._output: BinaryIO | None = None
        self._number = self._lines = self._size = 0  # of the file that is written
        self._ahead = -1, 0, b""  # a part of the file that was read last: number, offset, content
        for number in self._numbers():
            for offset, name in self._names_in(number):
                self._places[_digest(name)] = OFFSETS * number + offset

    def __contains__(self, name: str) -> bool:
        return _digest_of(name) in self._places or name in self._other_names

    def __enter__(self) -> Records:
        return self

    def __exit__(self, *error: object) -> None:
        self._close()

    def names(self) -> frozenset[str]:
        names = (name for number in self._numbers() for _, name in self._names_in(number))
        return self._other_names.union(json.loads(name) for name in names)

    def save(self, name: str, arrays: Mapping[str, npt.ArrayLike], facts: Mapping[str, object]) -> None:
        if arrays:
            self._others.save(name, arrays, facts)
        else:
            self.append([(name, facts)])

    def append(self, shards: Iterable[tuple[str, Mapping[str, object]]]) -> None:
        """Write shards without arrays, by name, which replace those of the same names."""
        with writing(self.path):
            for name, facts in shards:
                line = f'{{"name": {json.dumps(name)}, "facts": {json.dumps(facts)}'.encode()
                line += self._end(line)
                self._writable().write(line)
                self._places[_digest_of(name)] = OFFSETS * self._number + self._size
                self._size, self._lines = self._size + len(line), self._lines + 1
            if self._output is not None:
                self._output.flush()

    def load(self, name: str) -> Shard:
        place = self._places.get(_digest_of(name))
        if place is None:
            return self._others.load(name)
        number, offset = divmod(place, OFFSETS)
        try:
            line = self._line(number, offset)
            record = json_object(line)
            facts = record["facts"]
            if record["name"] != name or not self._is_whole(line) or not isinstance(facts, dict):
                raise ValueError("its checksum does not agree with its contents")
            return {}, facts
        except DAMAGED as error:
            raise FormatError(f"the shard {name!r} in {os.fspath(self._file(number))!r} is damaged ({error})") from None

    def _end(self, line: bytes) -> bytes:
        """The end of a line, with the checksum of its begin."""
        return f', "{MARK}": "{hashlib.sha256(self._mark.encode() + line).hexdigest()}"}}\n'.encode()

    def _is_whole(self, line: bytes) -> bool:
        begin, comma, _ = line.rpartition(b", ")
        return bool(comma) and begin + self._end(begin) == line

    def _line(self, number: int, offset: int) -> bytes:
        """A line with its end; what follows it is kept, since the next one is often read next."""
        begin = offset - self._ahead[1]
        if number == self._ahead[0] and 0 <= begin < len(self._ahead[2]):
            end = self._ahead[2].find(b"\n", begin) + 1
            if end:
                return self._ahead[2][begin:end]
        with open(self._file(number), "rb") as file:
            file.seek(offset)
            line = file.readline()
            self._ahead = number, offset + len(line), file.read(READ_AHEAD)
            return line

    def _file(self, number: int) -> Path:
        return Path(self.path) / f"records-{number:06d}.jsonl"

    def _numbers(self) -> list[int]:
        return sorted(int(match[1]) for name in os.listdir(self.path) if (match := FILE.fullmatch(name)))

    def _names_in(self, number: int) -> Iterator[tuple[int, bytes]]:
        """Numbers of the first bytes of the lines of a file, and the names as JSON; a damaged name gives a warning."""
        path, offset = os.fspath(self._file(number)), 0
        try:
            file = open(path, "rb")  # noqa: SIM115 - the next statement closes it
        except OSError as error:
            raise FormatError(f"{path!r} cannot be read: {error.strerror}") from None
        with file:
            for count, line in enumerate(file, 1):
                name = NAME.match(line)
                if name is not None and line.endswith(b"\n"):
                    yield offset, name[1]
                elif line.endswith(b"\n"):
                    text = f"line {count} of {path!r} is damaged; its result is computed again"
                    warnings.warn(DamageWarning(text), stacklevel=2)
                offset += len(line)

    def _writable(self) -> BinaryIO:
        """The file that is written, or the next one after a full one."""
        if self._output is not None and self._lines < LINES and self._size < BYTES:
            return self._output
        self._close()
        self._number, self._lines, self._size = max(self._numbers(), default=-1) + 1, 0, 0
        try:
            self._output = open(self._file(self._number), "xb")  # noqa: SIM115 - stays open
        except FileExistsError:  # begun by another process meanwhile
            return self._writable()
        return self._output

    def _close(self) -> None:
        output, self._output = self._output, None
        if output is not None:
            with writing(self.path), output:
                output.flush()
                os.fsync(output.fileno())


def _digest(name: bytes) -> bytes:
    return hashlib.blake2b(name, digest_size=16).digest()


@lru_cache(maxsize=64)  # a name is looked for, and then read
def _digest_of(name: str) -> bytes:
    return _digest(json.dumps(name).encode())
