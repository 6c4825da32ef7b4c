"""Words that shells complete, and the scripts that make bash, zsh and fish ask for them.

A shell asks at every press of the tab key, so nothing here imports the layers of mathematics. Names of pairs are read
from the one file of the catalogue that lists them. The other words are lists, which tests compare with the library.
"""

from __future__ import annotations

import importlib
import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Annotated, TypeAlias

import typer

from liehom.cli.guard import YES, guarded
from liehom.errors import InputError, displayed

Completer: TypeAlias = Callable[[str], list[str]]
"""Function of the beginning of a word that returns the words it can become."""

PACKAGE = Path(__file__).resolve().parents[2]
EXAMPLES = "examples/"
TYPES = ("A2", "A3", "B2", "B3", "C3", "D4", "E6", "E7", "E8", "F4", "G2")
ALGEBRAS = (
    "so(3)", "so(4)", "so(3,1)", "so(4,1)", "sl(2)", "sl(3)", "sl(2,C)", "su(2)", "su(3)", "su(2,1)", "sp(2)",
    "sp(4,R)", "u(2)", "e(2)", "e(3)", "iso(3,1)", "g2", "f4(-52)", "e6(-26)", "e7(-25)", "e8(-24)",
)  # fmt: skip
"""Names of algebras and real forms, one or two of a family; sizes are free."""
REAL_FORMS = ("su(2,1)", "su(3,2)", "so(4,1)", "so(5,3)", "sl(3,C)", "sp(2,1)", "g2(2)", "f4(4)", "e6(-26)", "e7(-25)")
BASES = ("euler", "heun", "rk4", "cg3", "cf4", "gauss2", "lietaylor")
EXPONENTIALS = ("exp", "cayley", "expm", "series", "rodrigues")
CLOCKS = ("corrected", "nominal")
ENGINES = ("numpy", "llvm", "jax")
FIGURES = (*(f"fig{number}" for number in range(1, 8)), "separatrix", "all")
SHELLS = ("bash", "zsh", "fish")


def pair_names() -> list[str]:
    """Names of the catalogue, as `liehom.catalog.pair_names`, without the layers below the catalogue."""
    import runpy  # of the standard library, but only completion needs it

    return list(runpy.run_path(str(PACKAGE / "catalog" / "claims.py"))["CLAIMS"])


def words(*known: str) -> Completer:
    """Completer of a few known words.

    Examples
    --------
    >>> words("numpy", "llvm", "jax")("n")
    ['numpy']
    """
    return lambda incomplete: _beginning(incomplete, known)


def files(*suffixes: str) -> Completer:
    """Completer of paths with one of these suffixes, of folders, and of the installed examples."""

    def completed(incomplete: str) -> list[str]:
        import glob

        found = sorted(glob.glob(glob.escape(incomplete) + "*"))
        paths = [f"{path}/" if os.path.isdir(path) else path for path in found]
        kept = [path for path in paths if path.endswith(("/", *suffixes))]
        return [*kept, *(path for path in _examples(incomplete, suffixes) if path not in kept)]

    return completed


def _examples(incomplete: str, suffixes: tuple[str, ...]) -> list[str]:
    """Installed example files; their folder alone until its name is typed."""
    folder = next(
        (f for f in (PACKAGE / "examples", PACKAGE.parent / "examples") if (f / "so4_so3.json").is_file()), None
    )
    if folder is None or not (incomplete.startswith(EXAMPLES) or (incomplete and EXAMPLES.startswith(incomplete))):
        return []
    names = sorted(name for name in os.listdir(folder) if name.endswith(suffixes))
    return _beginning(incomplete, [EXAMPLES + name for name in names])


def pair(incomplete: str) -> list[str]:
    """Pairs: names of the catalogue and JSON files."""
    return [*_beginning(incomplete, pair_names()), *files(".json")(incomplete)]


def anything(incomplete: str) -> list[str]:
    """Algebras, types, pairs and files that `describe` reads."""
    names = [*ALGEBRAS, *TYPES, *pair_names()]
    return [*_beginning(incomplete, names), *files(".json", ".g", ".gap", ".sage")(incomplete)]


def _beginning(incomplete: str, known: Iterable[str]) -> list[str]:
    return [word for word in known if word.startswith(incomplete)]


SCRIPTS = {
    "bash": """\
_liehom_completion() {
    local IFS=$'\\n' word="${COMP_WORDS[COMP_CWORD]}" found i
    found=($(COMP_WORDS="${COMP_WORDS[*]}" COMP_CWORD=$COMP_CWORD _LIEHOM_COMPLETE=complete_bash "$1" 2>/dev/null))
    case $word in
        [\\'\\"]*) ;;  # in quotes, parentheses stand for themselves
        *) for i in "${!found[@]}"; do found[i]=$(printf '%q' "${found[i]}"); done ;;
    esac
    COMPREPLY=("${found[@]}")
    [[ ${#found[@]} -eq 1 && ${found[0]} == */ ]] && compopt -o nospace
    return 0
}
complete -o default -F _liehom_completion liehom
""",
    "zsh": """\
#compdef liehom
_liehom_completion() {
    local -a found
    found=("${(@f)$(COMP_WORDS="${(F)words[1,CURRENT]}" COMP_CWORD=$((CURRENT - 1)) _LIEHOM_COMPLETE=complete_bash \\
        ${words[1]} 2>/dev/null)}")
    if [[ -z ${found[1]} ]]; then _files; return; fi
    compadd -S '' -- ${(M)found:#*/}
    compadd -- ${found:#*/}
}
compdef _liehom_completion liehom
""",
    "fish": """\
function __liehom_complete
    set -lx _LIEHOM_COMPLETE complete_fish
    set -lx _TYPER_COMPLETE_FISH_ACTION get-args
    set -lx _TYPER_COMPLETE_ARGS (commandline -cp)
    set -l found (liehom 2>/dev/null)
    if test -n "$found[1]"
        printf '%s\\n' $found
    else
        __fish_complete_path (commandline -ct)
    end
end
complete --command liehom --no-files --arguments '(__liehom_complete)'
""",
}


def completion(
    shell: Annotated[
        str, typer.Argument(metavar="SHELL", help="Shell: bash, zsh or fish.", autocompletion=words(*SHELLS))
    ],
) -> None:
    """Print the script that makes a shell complete commands, options, names of the catalogue and files.

    `eval "$(liehom completion bash)"` in ~/.bashrc switches completion on, and so does the same line with zsh in
    ~/.zshrc, after compinit; for fish it is `liehom completion fish | source` in ~/.config/fish/config.fish.
    """

    def action() -> int:
        if shell not in SCRIPTS:
            raise InputError(
                f"there is no script for the shell {displayed(shell)}, expected one of {', '.join(SCRIPTS)}"
            )
        print(SCRIPTS[shell], end="")
        return YES

    raise typer.Exit(guarded(action))


def enable() -> None:
    """Let typer answer the scripts of `completion`, which it does only after its own classes are registered."""
    importlib.import_module("typer.completion").completion_init()
