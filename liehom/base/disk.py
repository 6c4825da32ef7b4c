"""Files that are written whole or not at all, archives of arrays and JSON objects with checksums of their contents."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import json
import math
import os
import secrets
import signal
import stat
import struct
import threading
import zipfile
import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import numpy.typing as npt

from liehom.base.budget import within
from liehom.base.errors import FormatError, LimitError

LONGEST_STEM = 200  # characters of a file name that its temporary name repeats; file systems allow 255 bytes
MARK = "checksum"  # Name of the checksum in archives and JSON objects
# The exceptions that reading a damaged file may raise
DAMAGED = (
    *(OSError, ValueError, TypeError, LookupError, EOFError, RuntimeError, AttributeError, ArithmeticError),
    *(MemoryError, zipfile.BadZipFile, zlib.error, struct.error),
)


def write_atomically(path: str | os.PathLike[str], content: bytes | memoryview | Callable[[BinaryIO], object]) -> None:
    """Write a file so that any reader, and any interruption, finds the old file or the new one, never a part.

    The content goes to a temporary file in the same folder, with a name that no other thread or process uses. It is
    flushed to the disk and then renamed.
    """
    target = Path(os.path.realpath(path))
    try:
        mode = target.stat().st_mode
    except OSError:
        mode = None
    if mode is not None and not stat.S_ISREG(mode):
        with open(target, "wb") as file:
            _fill(file, content)
        return
    temporary = target.with_name(f".{target.name[:LONGEST_STEM]}.{secrets.token_hex(8)}.part")
    handle = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o666)
    try:
        with os.fdopen(handle, "wb") as file:
            _fill(file, content)
            file.flush()
            os.fsync(file.fileno())
        if mode is not None:
            os.chmod(temporary, stat.S_IMODE(mode))
        os.replace(temporary, target)
    except BaseException:
        with contextlib.suppress(OSError):
            temporary.unlink()
        raise
    _flush_folder(target.parent)


def write_together(folder: str | os.PathLike[str], contents: Mapping[str, bytes]) -> list[Path]:
    """Paths of several files in a folder, written one after another; Ctrl-C waits until the last one is written."""
    paths = [Path(folder) / name for name in contents]
    with _interrupt_afterwards():
        for path, content in zip(paths, contents.values(), strict=True):
            write_atomically(path, content)
    return paths


@contextlib.contextmanager
def _interrupt_afterwards() -> Iterator[None]:
    """Delay Ctrl-C, which only the main thread receives, to the end of the block."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    caught: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, frame: caught.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        if caught:
            signal.raise_signal(signal.SIGINT)


def _fill(file: BinaryIO, content: bytes | memoryview | Callable[[BinaryIO], object]) -> None:
    if callable(content):
        content(file)
    else:
        file.write(content)


def _flush_folder(folder: Path) -> None:
    """Flush the new name to the disk, on systems on which a folder can be opened."""
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def write_file(path: str | os.PathLike[str], content: bytes | memoryview | Callable[[BinaryIO], object]) -> None:
    """`write_atomically` for the files that a caller names."""
    try:
        write_atomically(path, content)
    except OSError as error:
        raise FormatError(f"{os.fspath(path)!r} cannot be written: {error.strerror or error}") from None


def check_target(path: str | os.PathLike[str], *, force: bool = False) -> None:
    """Raise `FormatError` if a file cannot be written; called before the work."""
    text = os.fspath(path)
    if not text or "\0" in text:
        raise FormatError(f"{text!r} is not the name of a file")
    target = Path(text)
    folder = target.parent
    try:
        target.lstat()
    except OSError as error:
        if error.errno == errno.ENAMETOOLONG:
            raise FormatError(f"{text!r} cannot be written: {error.strerror}") from None
    if not folder.is_dir():
        raise FormatError(f"{text!r} cannot be written: the folder {str(folder)!r} does not exist")
    if target.is_dir():
        raise FormatError(f"{text!r} cannot be written: it is a folder")
    if not os.access(folder, os.W_OK) and not (target.exists() and os.access(target, os.W_OK)):
        raise FormatError(f"{text!r} cannot be written: the folder {str(folder)!r} is not writable")
    if target.exists() and not force:
        raise FormatError(f"{text!r} is there already and is not overwritten: give another name, or force it")


def digest(*parts: npt.ArrayLike) -> str:
    """SHA-256 fingerprint of arrays and strings, 64 hexadecimal digits."""
    state = hashlib.sha256()
    for part in parts:
        array = np.asarray(part)
        state.update(f"{array.dtype}{array.shape}".encode())
        if array.dtype == np.longdouble:  # its padding bytes are arbitrary
            array = np.stack([array.astype(np.float64), (array - array.astype(np.float64)).astype(np.float64)])
        state.update(np.ascontiguousarray(array).tobytes() if array.dtype.kind != "O" else repr(part).encode())
    return state.hexdigest()


def differing(own: str, expected: str) -> str:
    """Names of what differs between two fingerprints, JSON objects of digests, of which "" agrees with all."""
    try:
        one, other = json_object(own), json_object(expected)
    except ValueError:
        return "" if own == expected else "the computation, its numbers, options or chunk"
    names = (name for name in {**one, **other} if one.get(name) != other.get(name))
    return ", ".join(sorted(name for name in names if "" not in (one.get(name), other.get(name))))


def checksum(arrays: Mapping[str, npt.ArrayLike], *texts: str) -> str:
    """Digest of named arrays and of strings: names, types, shapes and contents, whatever the order of the names."""
    parts: list[npt.ArrayLike] = [*texts]
    for name in sorted(arrays):
        parts += [name, arrays[name]]
    return digest(*parts)


def write_arrays(file: BinaryIO, arrays: Mapping[str, npt.ArrayLike], texts: Mapping[str, str], *context: str) -> None:
    """Write named arrays and strings to an .npz archive, with a checksum of them and of the context of the file."""
    marks = {**texts, MARK: checksum(arrays, *context, *texts.values())}
    entries: dict[str, Any] = {**{name: np.array(text) for name, text in marks.items()}, **arrays}
    np.savez(file, **entries)


def read_arrays(
    file: BinaryIO, texts: Iterable[str], *context: str
) -> tuple[dict[str, npt.NDArray[Any]], list[str], bool]:
    """Arrays of an .npz archive, its strings ('' if missing), whether the checksum agrees; may raise `DAMAGED`.

    Before memory is allocated, the sizes are compared: those in the headers of the arrays with those in the directory,
    and their sum with the file, which a compressed one may exceed up to the limit `file_bytes`.
    """
    with zipfile.ZipFile(file) as archive:
        entries = archive.infolist()
        unpacked = sum(entry.file_size for entry in entries)
        if unpacked > file.seek(0, os.SEEK_END):
            within("file_bytes", unpacked, "the arrays of an archive have {} bytes")
        arrays = {entry.filename.removesuffix(".npy"): _array(archive, entry) for entry in entries}
    mark, *values = (str(arrays.pop(name, "")) for name in (MARK, *texts))
    return arrays, values, mark == checksum(arrays, *context, *values)


def _array(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> npt.NDArray[Any]:
    """An array of an archive, if its header states the size of its contents."""
    with archive.open(entry) as member:
        first = np.lib.format.read_magic(member) == (1, 0)
        header = (np.lib.format.read_array_header_1_0 if first else np.lib.format.read_array_header_2_0)(member)
        stated, found = math.prod(header[0]) * header[2].itemsize, entry.file_size - member.tell()
    if stated != found or not header[2].itemsize:
        raise ValueError(f"the header of {entry.filename} states {stated} bytes, there are {found}")
    with archive.open(entry) as member:
        array: npt.NDArray[Any] = np.lib.format.read_array(member, allow_pickle=False)
        return array


def load_arrays(path: str | os.PathLike[str], what: str, version: str, text: str) -> tuple[dict[str, Any], str]:
    """The arrays and a string of an .npz file by `write_arrays` with this format and version, or `FormatError`."""
    name = os.fspath(path)
    try:
        with open(path, "rb") as file:
            arrays, (stated, value), is_whole = read_arrays(file, ["format", text])
    except LimitError:
        raise
    except DAMAGED as error:
        raise FormatError(f"{name!r} is not a {what} of liehom, or is damaged: {error}") from None
    check_version(name, what, stated, version)
    if not is_whole:
        raise FormatError(f"the {what} {name!r} is damaged, its checksum does not agree with its contents: delete it")
    return arrays, value


def check_version(name: str, what: str, stated: str, expected: str) -> None:
    """Raise `FormatError`, with both versions, unless a file states the expected format and version."""
    if stated != expected:
        raise FormatError(
            f"{name!r} is not a {what} of liehom of this version, or is damaged: its format is {stated!r}, "
            f"expected {expected!r}"
        )


def json_object(text: str | bytes) -> dict[str, Any]:
    """The JSON object in a file that the library wrote; raises `ValueError` if it is something else."""
    value = json.loads(text)
    if not isinstance(value, dict):
        raise ValueError(f"it holds a {type(value).__name__}, expected a JSON object")
    return value
