"""Exit codes: every command runs under `guarded`, which maps exceptions to documented codes.

Messages go to standard error. A command prints to standard output only after it has computed its whole answer.
"""

from __future__ import annotations

import errno
import io
import os
import sys
from collections.abc import Callable

from liehom.errors import CertificateError, CertificateFormatError, InternalError, LiehomError, UndecidedError

YES, NO, BAD_INPUT, NUMERICAL, INTERNAL, NOT_WRITTEN, INTERRUPTED, BROKEN_PIPE = 0, 1, 2, 3, 70, 74, 130, 141


def guarded(action: Callable[[], int]) -> int:
    """Exit code of an action, or of the exception that it raises; its message is printed.

    Examples
    --------
    >>> guarded(lambda: 0)
    0
    """
    try:
        code = action()
        sys.stdout.flush()
    except CertificateFormatError as error:
        return say(f"error: {_with_notes(error)}", BAD_INPUT)
    except CertificateError as error:
        return say(f"the certificate fails: {_with_notes(error)}", NO)
    except InternalError as error:
        return say(f"internal error: {error}", INTERNAL)
    except UndecidedError as error:
        return say(f"undecided: {_with_notes(error)}", NUMERICAL)
    except LiehomError as error:
        return say(f"error: {_with_notes(error)}", BAD_INPUT)
    except KeyboardInterrupt as interrupt:
        return say(f"interrupted{interrupt}", INTERRUPTED)
    except OSError as error:
        if error.filename is None and sys.stdout is not None:
            return close_output(error)
        return say(_bug_report(error), INTERNAL)
    except Exception as error:  # noqa: BLE001  the top of the program: any other exception is a bug
        return say(_bug_report(error), INTERNAL)
    return code


def repair_streams() -> None:
    """Open what was closed by the caller: files would get its number, and messages go to standard output.

    A write to a closed standard output fails, as it does in other programs; messages to a closed standard error are
    lost.
    """
    for number, access in ((0, os.O_RDONLY), (1, os.O_RDONLY), (2, os.O_WRONLY)):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, access)  # takes the lowest free number
    if sys.stdout is None:
        sys.stdout = io.TextIOWrapper(io.FileIO(1, "w", closefd=False), encoding="utf-8")
    if sys.stderr is None:
        sys.stderr = io.TextIOWrapper(io.FileIO(2, "w", closefd=False), encoding="utf-8")


def close_output(error: OSError) -> int:
    """Exit code after standard output could not be written; redirects it so that no flush fails again.

    That the reader of a pipe closed it is not worth a message; a full disk is.
    """
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (sys.stdout, sys.__stdout__):
        try:
            os.dup2(nowhere, stream.fileno())  # type: ignore[union-attr]
        except (OSError, ValueError, AttributeError):
            continue
    if error.errno == errno.EPIPE:
        return BROKEN_PIPE
    return say(f"error: standard output cannot be written: {error.strerror or error}", NOT_WRITTEN)


def say(message: str, code: int) -> int:
    """The exit code, after a message on standard error: one line, wrapped between words on a terminal.

    Examples
    --------
    >>> say("error: this name is unknown", 2)
    2
    """
    line = f"liehom: {message}"
    try:
        print(_wrapped(line) if sys.stderr.isatty() else line, file=sys.stderr, flush=True)
    except (OSError, ValueError):  # a full disk: the exit code has to do
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    return code


def _wrapped(line: str) -> str:
    """The line broken between words only, and not within `commands`, so that they can be copied."""
    import re
    import shutil
    import textwrap

    width = max(shutil.get_terminal_size().columns - 1, 20)
    whole = re.sub("`[^`]*`", lambda found: found[0].replace(" ", "\0"), line)
    made = textwrap.fill(whole, width, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)
    return made.replace("\0", " ")


def _with_notes(error: BaseException) -> str:
    """Message of an error and its notes, which name a command that helps."""
    return "; ".join([str(error), *getattr(error, "__notes__", ())])


def _bug_report(error: Exception) -> str:
    if os.environ.get("LIEHOM_TRACEBACK"):
        import traceback

        traceback.print_exc()
    kind = type(error).__name__
    text = str(error)[:500]
    return (
        f"internal error ({kind}: {text}); this is a bug in liehom, please report it with the input "
        "(LIEHOM_TRACEBACK=1 shows where it arose)"
    )
