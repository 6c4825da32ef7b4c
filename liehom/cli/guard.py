"""Exit codes: every command runs under `guarded`, which maps exceptions to documented codes.

Messages go to standard error. A command prints to standard output only after it has computed its whole answer.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable

from liehom.errors import CertificateError, CertificateFormatError, InternalError, LiehomError

YES, NO, BAD_INPUT, NUMERICAL, INTERNAL, INTERRUPTED, BROKEN_PIPE = 0, 1, 2, 3, 70, 130, 141


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
        return _said(f"error: {error}", BAD_INPUT)
    except CertificateError as error:
        return _said(f"the certificate fails: {error}", NO)
    except InternalError as error:
        return _said(f"internal error: {error}", INTERNAL)
    except LiehomError as error:
        return _said(f"error: {error}", BAD_INPUT)
    except KeyboardInterrupt as interrupt:
        return _said(f"interrupted{interrupt}", INTERRUPTED)
    except BrokenPipeError:
        return close_output()
    except Exception as error:  # noqa: BLE001  the top of the program: any other exception is a bug
        return _said(_bug_report(error), INTERNAL)
    return code


def close_output() -> int:
    """Exit code after the reader of a pipe has closed it; redirects standard output so that no flush fails again."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return BROKEN_PIPE


def _said(message: str, code: int) -> int:
    print(f"liehom: {message}", file=sys.stderr)
    return code


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
