"""Checkpoints: the whole state of a run in one .npz file, from which it continues bit for bit.

An interruption leaves the older checkpoint whole. A checksum shows whether a file is damaged, and it is read without
pickles. Checkpoints of liehom 0.1.0 (version 1) have no checksum.
"""

from __future__ import annotations

import contextlib
import os
import re
import struct
import threading
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.disk import checksum, write_atomically
from liehom.errors import FormatError, InputError

FORMAT = "liehom-checkpoint 2"
FORMAT_OF_0_1_0 = "liehom-checkpoint 1"
MARK = "checksum"
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
    trial = target.with_name(f".{target.name}.{os.getpid()}.{threading.get_ident()}.part")
    try:
        write_atomically(trial, b"")
        trial.unlink()
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
    arrays: dict[str, Any] = {"format": np.array(FORMAT), "fingerprint": np.array(fingerprint), **state}
    arrays[MARK] = np.array(checksum(state, FORMAT, fingerprint))
    try:
        write_atomically(path, lambda file: np.savez(file, **arrays))
    except OSError as error:
        raise _not_writable(Path(path), error) from None


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
    version, own, mark = (state.pop(key, None) for key in ("format", "fingerprint", MARK))
    if str(version) not in (FORMAT, FORMAT_OF_0_1_0):
        raise FormatError(f"{name!r} is not a checkpoint of liehom of this version")
    expected = checksum(state, FORMAT, str(own)) if str(version) == FORMAT else None
    if (None if mark is None else str(mark)) != expected:
        raise FormatError(
            f"the checkpoint {name!r} is damaged, its checksum does not agree with its contents: delete it"
        )
    if str(own) != fingerprint:
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


def _not_writable(target: Path, error: Exception) -> InputError:
    reason = getattr(error, "strerror", None) or error
    return InputError(f"the checkpoint {os.fspath(target)!r} cannot be written: {reason}")
