"""Words that shells complete; `liehom --install-completion` makes the shell ask for them.

A shell asks at every press of the tab key, so nothing here imports the layers of mathematics. Names of pairs are read
from the text of the catalogue's file. The other words are lists, which tests compare with the library.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TypeAlias

# Function of the beginning of a word that returns the words it can become
Completer: TypeAlias = Callable[[str], list[str]]

PACKAGE = Path(__file__).resolve().parents[1]
EXAMPLES = "examples/"
TYPES = ("A2", "A3", "B2", "B3", "C3", "D4", "E6", "E7", "E8", "F4", "G2")
# Names of algebras and real forms, one or two of a family; sizes are free
ALGEBRAS = (
    "so(3)", "so(4)", "so(3,1)", "so(4,1)", "sl(2)", "sl(3)", "sl(2,C)", "su(2)", "su(3)", "su(2,1)", "sp(2)",
    "sp(4,R)", "u(2)", "e(2)", "e(3)", "iso(3,1)", "g2", "f4(-52)", "e6(-26)", "e7(-25)", "e8(-24)",
)  # fmt: skip
REAL_FORMS = ("su(2,1)", "su(3,2)", "so(4,1)", "so(5,3)", "sl(3,C)", "sp(2,1)", "g2(2)", "f4(4)", "e6(-26)", "e7(-25)")
BASES = ("euler", "heun", "rk4", "cg3", "cf4", "gauss2", "lietaylor")
EXPONENTIALS = ("exp", "cayley", "expm", "series", "rodrigues")
CLOCKS = ("corrected", "nominal")
ENGINES = ("numpy", "llvm", "jax")
FIGURES = (*(f"fig{number}" for number in range(1, 8)), "separatrix", "all")


def pair_names() -> list[str]:
    """Names of the catalogue, as `liehom.catalog.pair_names`, without the layers below the catalogue."""
    text = (PACKAGE / "exact" / "catalog" / "pairs.py").read_text(encoding="utf-8")
    return text.partition('NAMES = """')[2].partition('"""')[0].split()


def words(*known: str) -> Completer:
    """Completer of a few known words."""
    return lambda incomplete: _beginning(incomplete, known)


def files(*suffixes: str) -> Completer:
    """Completer of paths with one of these suffixes, of folders, and of the installed examples."""

    def completed(incomplete: str) -> list[str]:
        import glob

        matching = sorted(glob.glob(glob.escape(incomplete) + "*"))
        paths = [f"{path}/" if os.path.isdir(path) else path for path in matching]
        kept = [path for path in paths if path.endswith(("/", *suffixes))]
        return [*kept, *(path for path in _examples(incomplete, suffixes) if path not in kept)]

    return completed


def examples_folder() -> Path | None:
    """Folder of the example files, in the installed package or next to it in a checkout; None if there is none."""
    folders = (PACKAGE / "examples", PACKAGE.parent / "examples")
    return next((folder for folder in folders if (folder / "so4_so3.json").is_file()), None)


def _examples(incomplete: str, suffixes: tuple[str, ...]) -> list[str]:
    """Installed example files; their folder alone until its name is typed."""
    folder = examples_folder()
    if folder is None or not (incomplete.startswith(EXAMPLES) or (incomplete and EXAMPLES.startswith(incomplete))):
        return []
    names = sorted(name for name in os.listdir(folder) if name.endswith(suffixes))
    return _beginning(incomplete, [EXAMPLES + name for name in names])


def pair(incomplete: str) -> list[str]:
    """Pairs: names of the catalogue and JSON files."""
    return [*_named(incomplete, pair_names()), *files(".json")(incomplete)]


def anything(incomplete: str) -> list[str]:
    """Algebras, types, pairs and files that `describe` reads."""
    names = [*_named(incomplete, ALGEBRAS), *_beginning(incomplete, TYPES), *_named(incomplete, pair_names())]
    return [*names, *files(".json", ".g", ".gap", ".sage")(incomplete)]


def _named(incomplete: str, names: Iterable[str]) -> list[str]:
    """Names that begin with a word in any letters, which stay as they are typed."""
    size = len(incomplete)
    return [incomplete + name[size:] for name in names if name[:size].casefold() == incomplete.casefold()]


def _beginning(incomplete: str, known: Iterable[str]) -> list[str]:
    return [word for word in known if word.startswith(incomplete)]
