"""Stores of finished results on disk: a folder of .npz files, or a zarr group.

A shard is written under a temporary name and then renamed, so a reader never sees a partial shard. Each shard, and the
description of the store, has a checksum of its contents. A store has the fingerprint of its problem and contains no
pickles. Stores of version 1 (liehom 0.1.0) have no checksums; they are read, and continued without checksums.
"""

from __future__ import annotations

import contextlib
import json
import os
import struct
import warnings
import zipfile
import zlib
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, TypeAlias, TypeVar, final

import numpy as np
import numpy.typing as npt

from liehom.disk import checksum, write_atomically
from liehom.errors import CertificateError, DamageWarning, FormatError, InputError

T = TypeVar("T")

FORMAT = "liehom-store"
VERSION = 2
MARK = "checksum"
ABOUT = "store.json"
"""File in the folder of a store with its format, version and fingerprint."""
UNREADABLE = (OSError, ValueError, TypeError, LookupError, EOFError, RuntimeError, AttributeError, ArithmeticError)
DAMAGED = (*UNREADABLE, MemoryError, zipfile.BadZipFile, zlib.error, struct.error)
"""The exceptions that reading a damaged file may raise."""

Shard: TypeAlias = tuple[dict[str, npt.NDArray[Any]], dict[str, Any]]
"""Arrays by name, and a JSON object of facts."""


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
    _mark: str | None  # what enters the checksums; None in stores of version 1, which have none

    @abstractmethod
    def names(self) -> frozenset[str]:
        """The names of all complete shards."""

    @abstractmethod
    def save(self, name: str, arrays: Mapping[str, npt.ArrayLike], facts: Mapping[str, object]) -> None:
        """Write a shard, replacing a shard of the same name.

        Raises
        ------
        InputError
            If the shard cannot be written.
        """

    @abstractmethod
    def load(self, name: str) -> Shard:
        """The arrays and facts of a shard.

        Raises
        ------
        FormatError
            If the shard does not exist or is damaged.
        """

    @property
    def has_checksums(self) -> bool:
        """Whether damage is always noticed; False for stores that liehom 0.1.0 has made."""
        return self._mark is not None

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
    liehom.errors.InputError: the store ... belongs to another problem ...
    """
    try:
        name = os.fsdecode(path)
    except TypeError:
        raise InputError(f"store is {path!r}, expected the path of a folder") from None
    kind = _Zarr if name.rstrip("/").endswith(".zarr") else _Folder
    return kind(name, fingerprint)


@final
class _Folder(Store):
    """A folder with one .npz file for each shard; former versions wrote those without arrays as .json files."""

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
            found = json.loads(about.read_text(encoding="utf-8"))
        except DAMAGED as error:
            raise FormatError(f"{os.fspath(about)!r} is damaged: {error}") from None
        self._mark = _checked(path, found, fingerprint)

    def names(self) -> frozenset[str]:
        # unfinished files begin with a dot
        files = (f for f in self._folder.iterdir() if f.suffix in (".npz", ".json"))
        return frozenset(f.stem for f in files if f.name != ABOUT and not f.name.startswith("."))

    def save(self, name: str, arrays: Mapping[str, npt.ArrayLike], facts: Mapping[str, object]) -> None:
        text = json.dumps(facts)
        marks = {} if self._mark is None else {MARK: checksum(arrays, self._mark, name, text)}
        from io import BytesIO

        buffer = BytesIO()
        entries: dict[str, Any] = {"facts": np.array(text), **{k: np.array(v) for k, v in marks.items()}, **arrays}
        np.savez(buffer, **entries)
        self._write(f"{name}.npz", buffer.getbuffer())

    def load(self, name: str) -> Shard:
        plain, packed = self._folder / f"{name}.json", self._folder / f"{name}.npz"
        file = plain if plain.exists() else packed
        try:
            if file is plain:
                found = json.loads(plain.read_text(encoding="utf-8"))
                if self._mark is None:
                    return {}, json_object(found)
                facts = json_object(found["facts"])
                _compare(found.get(MARK), checksum({}, self._mark, name, json.dumps(facts)))
                return {}, facts
            with open(packed, "rb") as opened, np.load(opened, allow_pickle=False) as archive:
                arrays = {key: archive[key] for key in archive.files}
            text, mark = str(arrays.pop("facts")), arrays.pop(MARK, None)
            if self._mark is not None:
                _compare(str(mark), checksum(arrays, self._mark, name, text))
            return arrays, json_object(json.loads(text))
        except DAMAGED as error:
            raise _damaged(os.fspath(file), error) from None

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
            raise InputError(
                f"the store {path!r} is a zarr group: install liehom[distributed], or leave .zarr"
            ) from None
        self.path = path
        if fingerprint is None and not os.path.isdir(path):
            raise _no_store(path)
        try:
            self._root: Any = zarr.open_group(path, mode="a")
        except DAMAGED as error:
            raise FormatError(f"{path!r} is not a zarr group: {error}") from None
        found = dict(self._root.attrs)
        if not found:
            if fingerprint is None:
                raise _no_store(path)
            found = _about(fingerprint)
            self._root.attrs.update(found)
        self._mark = _checked(path, found, fingerprint)

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
            marks = {} if self._mark is None else {MARK: checksum(arrays, self._mark, name, text)}
            part.attrs.update({**marks, "facts": text})  # last: a shard without facts is incomplete

    def load(self, name: str) -> Shard:
        try:
            part = self._root[name]
            arrays = {key: np.asarray(part[key][...]) for key in part.array_keys()}
            text = str(part.attrs["facts"])
            if self._mark is not None:
                _compare(part.attrs.get(MARK), checksum(arrays, self._mark, name, text))
            return arrays, json_object(json.loads(text))
        except DAMAGED as error:
            raise _damaged(f"{self.path}/{name}", error) from None


def json_object(found: object) -> dict[str, Any]:
    """The JSON object that a file holds; raises `ValueError` if it holds something else."""
    if not isinstance(found, dict):
        raise ValueError(f"it holds a {type(found).__name__}, expected a JSON object")
    return found


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


def _checked(path: str, found: object, fingerprint: str | None) -> str | None:
    """The fingerprint, which enters the checksums of the shards, or None for a store of version 1."""
    if not isinstance(found, dict) or found.get("format") != FORMAT or found.get("version") not in (1, VERSION):
        raise FormatError(f"{path!r} is not a store of liehom of this version, or is damaged")
    own = str(found.get("fingerprint"))
    if (found["version"] == 1 and MARK in found) or (found["version"] != 1 and found != _about(own)):
        raise FormatError(f"the description of the store {path!r} is damaged: delete the store, or give another path")
    if fingerprint is not None and own != fingerprint:
        raise InputError(
            f"the store {path!r} belongs to another problem (the computation, its numbers, options or chunk differ): "
            "delete it, or give another path"
        )
    return None if found["version"] == 1 else own


def _compare(stored: object, computed: str) -> None:
    if stored != computed:
        raise ValueError("its checksum does not agree with its contents")


def _is_empty(folder: Path) -> bool:
    """Whether a path is a folder without files; unfinished files, which begin with a dot, do not count."""
    return folder.is_dir() and all(file.name.startswith(".") for file in folder.iterdir())


def _no_store(path: str) -> FormatError:
    return FormatError(f"there is no store of liehom at {path!r}")


def _damaged(path: str, error: BaseException) -> FormatError:
    return FormatError(f"the shard {path!r} is missing or damaged ({error}): delete it, and it is computed again")
