"""The command line: every command parses its options, calls the library, and prints the result.

`app` has the group of commands and the short ones; `objects`, `integration`, `reproduce`, `plot_command` and
`atlas_command` hold the others. `inputs` reads files, pairs, points and numbers from arguments and has the shared
options, `guard` maps exceptions to exit codes, prints results and the steps of long commands. A command imports the
mathematics that it needs when it runs. docs/command-line.md describes the commands.
"""

from __future__ import annotations

import errno
import gc
import sys


def main() -> None:
    """Run the command ``liehom``; exits with one of the documented codes."""
    from liehom.cli.guard import INTERRUPTED, close_output, repair_streams

    repair_streams()
    output = sys.stdout
    gc.disable()  # until a command runs: loading makes many objects, none of them garbage
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
    finally:
        gc.enable()
