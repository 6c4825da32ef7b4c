"""Checkpoints: the whole state of a run in one .npz file, from which it continues bit for bit.

Written to a temporary file first, so that an interruption leaves the older one whole; read without pickles.
Imports errors.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from liehom.errors import FormatError, InputError

FORMAT = "liehom-checkpoint 1"


def save(path: str | os.PathLike[str], fingerprint: str, state: Mapping[str, Any]) -> None:
    """Write the arrays of a state.

    Examples
    --------
    >>> import os, tempfile
    >>> path = os.path.join(tempfile.mkdtemp(), "run.npz")
    >>> save(path, "abc", {"t": np.array([0.5])})
    >>> load(path, "abc")["t"]
    array([0.5])
    """
    target = Path(path)
    temporary = target.with_name(f".{target.name}.{os.getpid()}.part")
    try:
        with open(temporary, "wb") as file:
            np.savez(file, format=np.array(FORMAT), fingerprint=np.array(fingerprint), **dict(state))
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, target)
    except OSError as error:
        with contextlib.suppress(OSError):
            temporary.unlink()
        raise InputError(f"the checkpoint {os.fspath(path)!r} cannot be written: {error.strerror}") from None


def load(path: str | os.PathLike[str], fingerprint: str) -> dict[str, Any]:
    """Read the arrays of a state.

    Raises
    ------
    FormatError
        If the file is not a checkpoint.
    InputError
        If it belongs to another problem.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            state = {name: file[name] for name in file.files}
    except (OSError, ValueError, zipfile.BadZipFile, EOFError) as error:
        raise FormatError(f"{os.fspath(path)!r} is not a checkpoint of liehom: {error}") from None
    if str(state.pop("format", "")) != FORMAT:
        raise FormatError(f"{os.fspath(path)!r} is not a checkpoint of liehom")
    if str(state.pop("fingerprint", "")) != fingerprint:
        raise InputError(
            f"the checkpoint {os.fspath(path)!r} belongs to another problem (field, start, time span, step or options "
            "differ): delete it, or give another path"
        )
    return state


def digest(*parts: Any) -> str:
    """A fingerprint of arrays and texts.

    Examples
    --------
    >>> digest("a", np.zeros(2)) == digest("a", np.zeros(2)), len(digest())
    (True, 64)
    """
    found = hashlib.sha256()
    for part in parts:
        array = np.asarray(part)
        found.update(f"{array.dtype}{array.shape}".encode())
        found.update(np.ascontiguousarray(array).tobytes() if array.dtype.kind != "O" else repr(part).encode())
    return found.hexdigest()
