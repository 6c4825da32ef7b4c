"""Write both versions of a picture into a folder: `python -m pictures NAME FOLDER`."""

from __future__ import annotations

import sys
from pathlib import Path

from liehom.plotting.canvas import COLOURS, DARK_COLOURS
from pictures import load, write

if __name__ == "__main__":
    name, folder = sys.argv[1:]
    load()
    for kind, colours in (("light", COLOURS), ("dark", DARK_COLOURS)):
        write(name, Path(folder) / f"{name}_{kind}.svg", colours, dark=kind == "dark")
