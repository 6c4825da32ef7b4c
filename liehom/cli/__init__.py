"""The command line: every command parses its options, calls the library, and prints the result.

`app` has the group of commands and the short ones; modules that end in `_command` or `_commands`, `reproduce` and the
wing `integration` hold the others, `demo` the tour. `inputs` reads files, pairs, points and numbers from arguments,
`problem_options` overrides the problem of a file. `show` prints results, `options` are shared options, and `guard` maps
exceptions to exit codes. The wing `terminal` has help, completion and the steps of long commands. Only `guard` is
imported before a command runs. docs/command-line.md describes the commands.
"""

from __future__ import annotations

import errno
import sys


def main() -> None:
    """Run the command ``liehom``; exits with one of the documented codes."""
    from liehom.cli.guard import INTERRUPTED, close_output, repair_streams

    repair_streams()
    output = sys.stdout
    try:
        for stream in (sys.stdout, sys.stderr):
            if hasattr(stream, "reconfigure"):
                stream.reconfigure(errors="backslashreplace")
        from liehom.cli.app import app

        try:
            app()
        finally:
            if sys.stdout is not output:  # typer replaces it if the reader of a pipe is gone, and exits with 1
                raise BrokenPipeError(errno.EPIPE, "")
            output.flush()
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)
    except OSError as error:
        if error.filename is not None:
            raise
        sys.exit(close_output(error))
