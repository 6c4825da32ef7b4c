"""Pictures of the pages, drawn when the pages are built: one function for each, in the modules of this folder.

A page shows a picture, in a light and a dark version, by

    ```{picture} name
    :alt: what it shows, for those who do not see it
    ```

where `name` is the name of a function that `picture` decorates. It is called in the style of the version, with the
colours of lines, and returns a figure. The gallery shows the function, with what it uses of its module, as a program
(docs/picture_source.py), and its name as the title. Pictures of the README are files of the repository. From its root
this writes both versions again:

    PYTHONPATH=.:docs python -m pictures orbits_on_the_sphere docs/_static
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from liehom.plotting.canvas import COLOURS, DARK_COLOURS, UNDATED, style

FOLDER = Path(__file__).resolve().parent.parent / "_pictures"
DRAWN: dict[str, Callable[[Sequence[str]], Any]] = {}
"""The functions by name."""


def picture(function: Callable[[Sequence[str]], Any]) -> Callable[[Sequence[str]], Any]:
    """Register a function of the colours that returns a figure."""
    DRAWN[function.__name__] = function
    return function


def load() -> None:
    """Import the modules of this folder, which register their functions."""
    for module in pkgutil.iter_modules([str(Path(__file__).resolve().parent)]):
        if module.name != "__main__":
            importlib.import_module(f"{__name__}.{module.name}")


def draw(app: object = None) -> None:
    """Write each picture that is missing, or older than the module that draws it, in both versions."""
    load()
    FOLDER.mkdir(exist_ok=True)
    for name, function in DRAWN.items():
        source = Path(function.__code__.co_filename).stat().st_mtime
        for kind, colours in (("light", COLOURS), ("dark", DARK_COLOURS)):
            file = FOLDER / f"{name}_{kind}.svg"
            if not file.exists() or file.stat().st_mtime < source:
                write(name, file, colours, dark=kind == "dark")


def write(name: str, file: Path, colours: Sequence[str], *, dark: bool) -> None:
    """Write one version of a picture."""
    with style(dark=dark):
        figure = DRAWN[name](colours)
        figure.patch.set_alpha(0.0)
        figure.savefig(file, metadata=UNDATED[".svg"])
