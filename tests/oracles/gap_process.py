"""One GAP process that answers questions, each with a time limit of its own."""

from __future__ import annotations

import os
import selectors
import subprocess
import time

END = "@END@"
SETUP = "BreakOnError := false;; SizeScreen( [ 4096, 24 ] );; "
# GAP's structure theory makes random choices: for each algebra it begins in the same state.
SEED = "Reset( GlobalMersenneTwister, 1 );; Reset( GlobalRandomSource, 1 );; "


class Timeout(Exception):
    """A question was not answered in time; the process was ended."""


class Refused(Exception):
    """GAP raised an error; the text is its message."""


class Gap:
    """A running `gap`; after a time-out it is started again, and `setup` must be repeated."""

    def __init__(self, command: str = "gap") -> None:
        self.command = [command, "-q", "-r", "-A", "-b"]
        self.process: subprocess.Popen[bytes] | None = None
        self.setup = ""

    def __enter__(self) -> Gap:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def stop(self) -> None:
        if self.process is not None:
            self.process.kill()
            self.process.communicate()
            self.process = None

    def begin(self, setup: str) -> None:
        self.setup = SEED + setup
        if self.process is None:
            self._start()
        else:
            self._send(self.setup, 120)

    def ask(self, expression: str, limit: float) -> str:
        """What GAP prints for an expression.

        Raises
        ------
        Timeout, Refused
        """
        if self.process is None:
            self._start()
        question = f"Unbind( answer_ );; answer_ := {expression};;"
        said = self._send(f'{question}\nif IsBound( answer_ ) then Print( "@=", answer_, "@" ); fi;', limit)
        if "@=" not in said:
            raise Refused(" ".join(said.split())[:200])
        return " ".join(said.partition("@=")[2].partition("@")[0].replace("\\\n", "").split())

    def _start(self) -> None:
        self.process = subprocess.Popen(
            self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
        )
        self._send(SETUP + self.setup, 120)

    def _send(self, statements: str, limit: float) -> str:
        if self.process is None or self.process.stdin is None or self.process.stdout is None:
            raise RuntimeError("GAP is not running")
        self.process.stdin.write(f'{statements}\nPrint( "{END}\\n" );\n'.encode())
        self.process.stdin.flush()
        said, deadline = b"", time.monotonic() + limit
        with selectors.DefaultSelector() as selector:
            selector.register(self.process.stdout, selectors.EVENT_READ)
            while END.encode() not in said:
                if not selector.select(max(deadline - time.monotonic(), 0)):
                    self.stop()
                    raise Timeout
                chunk = os.read(self.process.stdout.fileno(), 1 << 16)
                if not chunk:
                    self.stop()
                    raise Refused("GAP ended: " + " ".join(said.decode(errors="replace").split())[-200:])
                said += chunk
        return said.decode(errors="replace").partition(END)[0]
