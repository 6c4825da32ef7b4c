"""Command `show`: a page for the browser about a pair."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from liehom.cli.guard import YES
from liehom.cli.options import JsonOption, PairArgument, run
from liehom.cli.terminal import completion
from liehom.cli.terminal.steps import step

if TYPE_CHECKING:
    from liehom.fullness import Verdict
    from liehom.representations import Pair


def show(
    pair: PairArgument,
    output: Annotated[
        str | None,
        typer.Option("--output", "-o", metavar="OUT.html", help="File (default: in a new temporary folder)."),
    ] = None,
    certificate: Annotated[
        str | None,
        typer.Option(
            metavar="CERT",
            help="Certificate to verify and show, or - for standard input (default: decide the pair).",
            autocompletion=completion.files(".json"),
        ),
    ] = None,
    open_: Annotated[bool, typer.Option("--open", help="Open the page in the browser.")] = False,
    json: JsonOption = False,
) -> None:
    """Write a page for the browser about a pair: verdict, proof, failure cone, diagrams, isotropy, brackets.

    The page is one file that needs no network. PAIR may also be a file with a verdict, which `liehom fullness --json`
    prints. The exit code is 0 if the page is written, whatever the verdict.
    """
    run(lambda: _show(pair, output, certificate, open_, json))


def _show(text: str, output: str | None, certificate: str | None, opened: bool, as_json: bool) -> int:
    import tempfile
    import webbrowser
    from pathlib import Path

    from liehom.cli.inputs import check_one_standard_input, check_output, pair_line, shown_name
    from liehom.cli.show import show_answer, show_json
    from liehom.errors import InputError
    from liehom.fullness import decide_fullness
    from liehom.pages import pair_page

    check_one_standard_input(text, certificate)
    if output is not None:
        check_output(output, text, *([certificate] if certificate else []))
    given = _verdict(text, certificate)
    verdict = decide_fullness(_pair(text), progress=step) if given is None else given
    step("page")
    file = Path(tempfile.mkdtemp(prefix="liehom-")) / "pair.html" if output is None else Path(output)
    size = len(pair_page(verdict, file).encode())
    if opened and not webbrowser.open(file.resolve().as_uri()):
        raise InputError(f"no browser was found; the page is in {str(file)!r}")
    if as_json:
        proved = verdict.certificate is not None
        show_json({"page": str(file), "bytes": size, "full": verdict.full, "proved": proved})
        return YES
    show_answer(
        f"page written to {file}",
        [("pair", pair_line(verdict.pair.name or shown_name(text), verdict.pair)), ("verdict", str(verdict))],
    )
    return YES


def _pair(text: str) -> Pair:
    """The pair that an argument denotes; one without a name has the argument as its name."""
    from liehom.cli.inputs import STANDARD_INPUT, pair_argument
    from liehom.representations import Pair

    pair = pair_argument(text)
    return pair if pair.name or text == STANDARD_INPUT else Pair(pair.algebra, pair.subalgebra, name=text)


def _verdict(text: str, file: str | None) -> Verdict | None:
    """The verdict of a given certificate, or of a file that `liehom fullness --json` wrote; None if there is none."""
    from liehom.cli.inputs import STANDARD_INPUT, file_argument, is_file, shown_name
    from liehom.errors import FormatError
    from liehom.fullness import Certificate, Full, NotFull
    from liehom.io import read_object

    if file is None and (text == STANDARD_INPUT or not is_file(text)):
        return None
    data = read_object(file_argument(text if file is None else file))
    name: object = text
    if file is None:
        if not {"full", "proved"} <= data.keys():
            return None
        file, named = text, data.get("pair")
        name = named.get("name") if isinstance(named, dict) else None
    if not isinstance(name, str):
        raise FormatError(f"{file!r} is a verdict that names no pair: give the pair, and this file with --certificate")
    if data.get("proved") is False:
        raise FormatError(f"{file!r} is a numerical verdict, which has no certificate: give the pair instead")
    found = Certificate.from_json(data["certificate"] if isinstance(data.get("certificate"), dict) else data)
    if found.full:
        return Full(_pair(name), found)
    return NotFull(_pair(name), found, f"proved by the certificate in {shown_name(file)}")
