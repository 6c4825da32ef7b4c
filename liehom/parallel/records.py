"""Shards without arrays, many in a file: the entries of a sweep, of which there may be millions.

A file ``records-000000.jsonl`` has a line ``{"name": ..., "facts": {...}, "checksum": ...}`` for each shard, and only
grows. Each process that writes begins a file of its own, and the next one after a full file. A line has reached the
operating system when `append` returns, so it survives the end of the process, however sudden. A file is flushed to the
disk when it is full or closed. An interruption may leave half a line at the end of a file; it is ignored.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import warnings
from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import BinaryIO, final

import numpy.typing as npt

from liehom.errors import DamageWarning, FormatError
from liehom.parallel.store import DAMAGED, MARK, Shard, Store, json_object, writing

LINES = 4096
"""Lines of a full file."""
BYTES = 1 << 26
"""Size of a full file with fewer lines."""
OFFSETS = 1 << 40
"""More than the bytes of a file."""
READ_AHEAD = 1 << 16
"""Bytes that are read after a line."""
FILE = re.compile(r"records-(\d{6,})\.jsonl")
NAME = re.compile(rb'\{"name": ("(?:[ !#-\[\]-~]|\\u[0-9a-f]{4}|\\["\\bfnrt])*"), ')
"""Begin of a line, with the name as JSON."""


@final
class Records(Store):
    """A store in which shards without arrays share files; a context manager that closes the file it writes.

    Parameters
    ----------
    store : Store
        The store that holds all other shards, such as those that former versions wrote, one in a file.

    Notes
    -----
    In memory are a digest of 16 bytes and the place of each shard in the files, some 150 bytes for both.

    Examples
    --------
    >>> import tempfile
    >>> from liehom.parallel import open_store
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
        found = (name for number in self._numbers() for _, name in self._names_in(number))
        return self._other_names.union(json.loads(name) for name in found)

    def save(self, name: str, arrays: Mapping[str, npt.ArrayLike], facts: Mapping[str, object]) -> None:
        if arrays:
            self._others.save(name, arrays, facts)
        else:
            self.append([(name, facts)])

    def append(self, shards: Iterable[tuple[str, Mapping[str, object]]]) -> None:
        """Write shards without arrays, by name, which replace those of the same names.

        Raises
        ------
        InputError
            If they cannot be written.
        """
        with writing(self.path):
            for name, facts in shards:
                line = f'{{"name": {json.dumps(name)}, "facts": {json.dumps(facts)}'.encode()
                line += b"}\n" if self._mark is None else self._end(line)
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
            found = json.loads(line.decode())
            if found["name"] != name or (self._mark is not None and not self._is_whole(line)):
                raise ValueError("its checksum does not agree with its contents")
            return {}, json_object(found["facts"])
        except DAMAGED as error:
            raise FormatError(f"the shard {name!r} in {os.fspath(self._file(number))!r} is damaged ({error})") from None

    def _end(self, line: bytes) -> bytes:
        """The end of a line, with the checksum of its begin."""
        return f', "{MARK}": "{hashlib.sha256(f"{self._mark}".encode() + line).hexdigest()}"}}\n'.encode()

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
