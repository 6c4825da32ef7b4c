"""The command line: parses, calls, prints.

guard       exit codes: what an exception becomes
inputs      arguments to files, pairs, points, rows and numbers
show        readable output on a terminal, plain lines in a pipe, one JSON object with --json
app         the commands
numerical   the options of `integrate` and `order`
problem     what these two share: the problem of a file, options that override it, pictures
integration, convergence   their work
demo        the tour over the example files

Only `guard` is imported before a command runs; everything else is loaded when it is needed.
"""

from __future__ import annotations

import sys


def main() -> None:
    """The entry point of the command ``liehom``; exits with one of the documented codes."""
    from liehom.cli.guard import INTERRUPTED, close_output

    try:
        for stream in (sys.stdout, sys.stderr):
            if hasattr(stream, "reconfigure"):
                stream.reconfigure(errors="backslashreplace")
        from liehom.cli.app import app

        app()
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)
    except BrokenPipeError:
        sys.exit(close_output())
