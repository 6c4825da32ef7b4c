"""Stores of finished results on disk: a folder of .npz and .json files, or a zarr group.

A shard is written under a temporary name and then renamed, so a reader never sees a partial shard. A store has the
fingerprint of its problem and contains no pickles.
"""

from __future__ import annotations

import contextlib
import json
import os
import struct
import zipfile
import zlib
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, TypeAlias, final

import numpy as np
import numpy.typing as npt

from liehom.errors import FormatError, InputError

FORMAT = "liehom-store"
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
    """A folder with one .npz or .json file for each shard."""

    def __init__(self, path: str, fingerprint: str | None) -> None:
        self.path = path
        self._folder = Path(path)
        about = self._folder / ABOUT
        if not about.exists():
            if fingerprint is None:
                raise _no_store(path)
            if self._folder.exists() and not _is_empty(self._folder):
                raise FormatError(f"{path!r} exists and is not a store of liehom: give the path of a new folder")
            with _writing(path):
                self._folder.mkdir(parents=True, exist_ok=True)
            self._write(ABOUT, json.dumps(_about(fingerprint)).encode())
        elif fingerprint is not None:
            try:
                found = json.loads(about.read_text(encoding="utf-8"))
            except (OSError, ValueError) as error:
                raise FormatError(f"{os.fspath(about)!r} is damaged: {error}") from None
            _check(path, found, fingerprint)

    def names(self) -> frozenset[str]:
        # shards end in .npz or .json; unfinished files begin with a dot
        files = (f for f in self._folder.iterdir() if f.suffix in (".npz", ".json"))
        return frozenset(f.stem for f in files if f.name != ABOUT and not f.name.startswith("."))

    def save(self, name: str, arrays: Mapping[str, npt.ArrayLike], facts: Mapping[str, object]) -> None:
        text = json.dumps(facts)
        if not arrays:
            self._write(f"{name}.json", text.encode())
            return
        from io import BytesIO

        buffer = BytesIO()
        entries: dict[str, Any] = {"facts": np.array(text), **arrays}
        np.savez(buffer, **entries)
        self._write(f"{name}.npz", buffer.getbuffer())

    def load(self, name: str) -> Shard:
        plain, packed = self._folder / f"{name}.json", self._folder / f"{name}.npz"
        try:
            if plain.exists():
                return {}, json.loads(plain.read_text(encoding="utf-8"))
            with open(packed, "rb") as file, np.load(file, allow_pickle=False) as archive:
                arrays = {key: archive[key] for key in archive.files}
            return arrays, json.loads(str(arrays.pop("facts")))
        except DAMAGED as error:
            raise _damaged(os.fspath(plain if plain.exists() else packed), error) from None

    def _write(self, name: str, data: bytes | memoryview) -> None:
        target = self._folder / name
        temporary = target.with_name(f".{name}.{os.getpid()}.part")
        try:
            with _writing(self.path):
                with open(temporary, "wb") as file:
                    file.write(data)
                    file.flush()
                    os.fsync(file.fileno())
                os.replace(temporary, target)
        finally:
            with contextlib.suppress(OSError):
                temporary.unlink()


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
        if fingerprint is not None and found:
            _check(path, found, fingerprint)
        elif not found:
            if fingerprint is None:
                raise _no_store(path)
            self._root.attrs.update(_about(fingerprint))

    def names(self) -> frozenset[str]:
        return frozenset(name for name, part in self._root.groups() if "facts" in part.attrs)

    def save(self, name: str, arrays: Mapping[str, npt.ArrayLike], facts: Mapping[str, object]) -> None:
        with _writing(self.path):
            part = self._root.create_group(name, overwrite=True)
            for key, array in arrays.items():
                part[key] = np.asarray(array)
            part.attrs["facts"] = json.dumps(facts)  # last: a shard without facts is incomplete

    def load(self, name: str) -> Shard:
        try:
            part = self._root[name]
            arrays = {key: np.asarray(part[key][...]) for key in part.array_keys()}
            return arrays, json.loads(str(part.attrs["facts"]))
        except DAMAGED as error:
            raise _damaged(f"{self.path}/{name}", error) from None


# -- private helpers -------------------------------------------------------------------------------------
def _about(fingerprint: str) -> dict[str, str | int]:
    return {"format": FORMAT, "version": 1, "fingerprint": fingerprint}


def _check(path: str, found: Mapping[str, object], fingerprint: str) -> None:
    if found.get("format") != FORMAT or found.get("version") != 1:
        raise FormatError(f"{path!r} is not a store of liehom of this version")
    if found.get("fingerprint") != fingerprint:
        raise InputError(
            f"the store {path!r} belongs to another problem (the computation, its numbers, options or chunk differ): "
            "delete it, or give another path"
        )


def _is_empty(folder: Path) -> bool:
    """Whether a path is a folder without files; unfinished files, which begin with a dot, do not count."""
    return folder.is_dir() and all(file.name.startswith(".") for file in folder.iterdir())


@contextlib.contextmanager
def _writing(path: str) -> Iterator[None]:
    """Context in which errors of the file system become `InputError`."""
    try:
        yield
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"the store {path!r} cannot be written: {reason}") from None


def _no_store(path: str) -> FormatError:
    return FormatError(f"there is no store of liehom at {path!r}")


def _damaged(path: str, error: BaseException) -> FormatError:
    return FormatError(f"the shard {path!r} is missing or damaged ({error}): delete it, and it is computed again")
