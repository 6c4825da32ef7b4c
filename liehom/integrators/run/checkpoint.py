"""Checkpoints: the whole state of a run in one .npz file, from which it continues bit for bit.

A checkpoint is written to a temporary file first, so that an interruption leaves the older one whole, and it is read
without pickles.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import struct
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.errors import FormatError, InputError

FORMAT = "liehom-checkpoint 1"
FORMER_NAMES = {"NominalTimeCorrected(": "OnTime("}
"""Parts of a repr and their spelling in version 0.1.0, whose checkpoints and stores can still be continued."""
UNREADABLE = (OSError, ValueError, TypeError, LookupError, EOFError, RuntimeError, AttributeError, ArithmeticError)
"""Exceptions that reading a damaged archive may raise, besides the errors of zip and zlib."""


def checked_path(path: str | os.PathLike[str]) -> Path:
    """The path of a checkpoint, after a test that a file can be written there.

    Raises
    ------
    InputError
        If the path is not a file name, is a directory, or cannot be written.

    Examples
    --------
    >>> checked_path("no/such/place/run.npz")
    Traceback (most recent call last):
    ...
    liehom.errors.InputError: the checkpoint 'no/such/place/run.npz' cannot be written: No such file or directory
    """
    try:
        target = Path(os.fsdecode(path))
    except TypeError:
        raise InputError(f"checkpoint is {path!r}, expected the path of a file") from None
    if not target.name or os.path.isdir(target):
        raise InputError(f"the checkpoint {os.fsdecode(path)!r} is a directory, expected the path of a file")
    temporary = _temporary(target)
    try:
        with open(temporary, "wb"):
            pass
        temporary.unlink()
    except (OSError, ValueError) as error:
        raise _not_writable(target, error) from None
    return target


def save(path: str | os.PathLike[str], fingerprint: str, state: Mapping[str, npt.ArrayLike]) -> None:
    """Write the arrays of a state to a checkpoint.

    Raises
    ------
    InputError
        If the file cannot be written.

    Examples
    --------
    >>> import os, tempfile
    >>> path = os.path.join(tempfile.mkdtemp(), "run.npz")
    >>> save(path, "abc", {"t": np.array([0.5])})
    >>> load(path, "abc")["t"]
    array([0.5])
    """
    target = Path(path)
    temporary = _temporary(target)
    try:
        with open(temporary, "wb") as file:
            arrays: dict[str, Any] = dict(state)
            np.savez(file, format=np.array(FORMAT), fingerprint=np.array(fingerprint), **arrays)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, target)
    except OSError as error:
        raise _not_writable(target, error) from None
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink()


def load(path: str | os.PathLike[str], fingerprint: str) -> dict[str, npt.NDArray[Any]]:
    """Arrays of the state in a checkpoint, by name.

    Raises
    ------
    FormatError
        If the file is not a checkpoint, or is damaged.
    InputError
        If it belongs to another problem: its fingerprint differs.

    Examples
    --------
    >>> import os, tempfile
    >>> path = os.path.join(tempfile.mkdtemp(), "run.npz")
    >>> save(path, "abc", {"t": np.array([0.5])})
    >>> load(path, "abd")
    Traceback (most recent call last):
    ...
    liehom.errors.InputError: the checkpoint ... belongs to another problem ...
    """
    name = os.fspath(path)
    try:
        with open(path, "rb") as file, np.load(file, allow_pickle=False) as archive:
            state = {key: archive[key] for key in archive.files}
    except (*UNREADABLE, MemoryError, zipfile.BadZipFile, zlib.error, struct.error) as error:
        raise FormatError(f"{name!r} is not a checkpoint of liehom, or is damaged: {error}") from None
    if str(state.pop("format", "")) != FORMAT:
        raise FormatError(f"{name!r} is not a checkpoint of liehom of this version")
    if str(state.pop("fingerprint", "")) != fingerprint:
        raise InputError(
            f"the checkpoint {name!r} belongs to another problem (field, start, time span, step or options "
            "differ): delete it, or give another path"
        )
    return state


def remove(path: str | os.PathLike[str]) -> None:
    """Delete a checkpoint, if there is one.

    Examples
    --------
    >>> remove("there is no such file")
    """
    with contextlib.suppress(FileNotFoundError):
        os.remove(path)


def digest(*parts: npt.ArrayLike) -> str:
    """SHA-256 fingerprint of arrays and strings, 64 hexadecimal digits.

    Examples
    --------
    >>> digest("a", np.zeros(2)) == digest("a", np.zeros(2)), len(digest())
    (True, 64)
    """
    found = hashlib.sha256()
    for part in parts:
        array = np.asarray(part)
        found.update(f"{array.dtype}{array.shape}".encode())
        if array.dtype == np.longdouble:  # its padding bytes are arbitrary
            array = np.stack([array.astype(np.float64), (array - array.astype(np.float64)).astype(np.float64)])
        found.update(np.ascontiguousarray(array).tobytes() if array.dtype.kind != "O" else repr(part).encode())
    return found.hexdigest()


def stable_repr(value: object) -> str:
    """String of a step or an option for fingerprints: its repr without addresses, spelled as in version 0.1.0.

    Examples
    --------
    >>> stable_repr(print), stable_repr([object()])
    ('<built-in function print>', '[<object object>]')
    """
    text = re.sub(" at 0x[0-9a-f]+", "", repr(value))
    for name, former in FORMER_NAMES.items():
        text = text.replace(name, former)
    return text


def _temporary(target: Path) -> Path:
    return target.with_name(f".{target.name}.{os.getpid()}.part")


def _not_writable(target: Path, error: Exception) -> InputError:
    reason = getattr(error, "strerror", None) or error
    return InputError(f"the checkpoint {os.fspath(target)!r} cannot be written: {reason}")
