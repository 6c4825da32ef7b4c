"""What the copy button of a block copies is its code, and it runs when it is pasted into Python or IPython."""

import ast
import codeop
import doctest
import importlib
import inspect
import re
from collections.abc import Iterator
from typing import Any

import pytest
from IPython.core.inputtransformer2 import TransformerManager

from tests.test_docs import DOCS, PACKAGE, blocks, pages_with, public_names, read

PROMPT = ast.literal_eval(
    re.findall(r'^copybutton_prompt_text = (r".*")$', read("docs", "conf.py"), flags=re.MULTILINE)[0]
)


def copied(block: str) -> str:
    """The text that sphinx-copybutton copies: the lines with a prompt, without it, and empty lines."""
    matches = [(re.match(f"({PROMPT})(.*)", line), line) for line in block.rstrip("\n").split("\n")]
    if not any(match for match, _ in matches):
        return block.rstrip("\n")
    return "\n".join(match[2] if match else line for match, line in matches if match or not line.strip())


def code_of(block: str) -> list[str]:
    """The lines of the examples of a block, without empty ones."""
    examples = doctest.DocTestParser().get_examples(block)
    return [line for example in examples for line in example.source.splitlines() if line.strip()]


def faults_of_pasting(text: str) -> list[str]:
    """The lines at which Python's prompt, which compiles line by line, finds a syntax error."""
    compiler, faults = codeop.CommandCompiler(), []
    entered: list[str] = []
    for line in [*text.split("\n"), ""]:
        entered.append(line)
        try:
            if compiler("\n".join(entered), symbol="single") is not None:
                entered = []
        except SyntaxError as error:
            faults.append(f"{error.msg}: {line}")
            entered = []
    return faults + ([f"incomplete: {entered[0]}"] if any(entered) else [])


def docstring_blocks() -> Iterator[tuple[str, str]]:
    """The paragraphs of examples with several lines in the docstrings, which the API pages show."""
    for path in sorted(PACKAGE.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        if re.search(r"^ *\.\.\. ", text, flags=re.MULTILINE):
            found = re.findall(r'^( *)(>>> .*?)(?=\n\s*\n|""")', text, flags=re.MULTILINE | re.DOTALL)
            yield from ((path.name, paragraph.replace(f"\n{indent}", "\n")) for indent, paragraph in found)


@pytest.mark.parametrize("page", pages_with("pycon"))
def test_the_button_copies_the_code_of_examples_and_no_output(page: str) -> None:
    for block in blocks(read(page), "pycon"):
        assert [line for line in copied(block).split("\n") if line.strip()] == code_of(block)


@pytest.mark.parametrize("language", ["python", "pycon"])
def test_copied_blocks_run_when_they_are_pasted(language: str) -> None:
    """A statement of several lines ends with an empty line and has none inside, as Python's prompt wants it."""
    transformer = TransformerManager()
    for page in pages_with(language):
        for block in blocks(read(page), language):
            text = copied(block)
            assert faults_of_pasting(text) == [], f"{page}: a statement of several lines ends with a line '...'"
            assert transformer.check_complete(text + "\n\n")[0] == "complete", page
            assert transformer.transform_cell(text).rstrip() == text.rstrip(), "IPython reads it as one of its commands"


def test_copied_examples_of_docstrings_run_when_they_are_pasted() -> None:
    found = list(docstring_blocks())
    assert len(found) > 100
    faulty = [(name, faults) for name, block in found if (faults := faults_of_pasting(copied(block)))]
    assert faulty == [], "a statement of several lines ends with a line '...'"


@pytest.mark.parametrize(
    "block",
    [
        ">>> def f(x):\n...     return x\n>>> f(1)\n1\n",
        "def f(x):\n    return x\nf(1)\n",
        "class A:\n    x = 1\n\n    y = 2\n",
        "x = (1\n",
    ],
)
def test_a_block_that_cannot_be_pasted_is_found(block: str) -> None:
    assert faults_of_pasting(copied(block))


@pytest.mark.parametrize("page", pages_with("console"))
def test_the_button_copies_commands_without_prompts_and_output(page: str) -> None:
    for block in blocks(read(page), "console"):
        commands = re.findall(r"^\$ (.*)$", block, flags=re.MULTILINE)
        assert commands
        assert copied(block).split() == " ".join(commands).split()


def test_shell_blocks_have_neither_prompts_nor_output() -> None:
    """They are copied whole: a first word is a program, an assignment or a comment."""
    for page in pages_with("sh"):
        for block in blocks(read(page), "sh"):
            for line in re.sub(r"\\\n", "", block).splitlines():
                assert re.match(r"(#|(\w+=\S* )*[.\w/-]+( |$))", line), f"{page}: {line}"


def test_empty_lines_end_statements_when_they_are_copied() -> None:
    block = inspect.cleandoc(
        """
        >>> for k in range(2):
        ...     print(k)
        ...
        0
        1
        >>> k
        1
        """
    )
    assert copied(block) == "for k in range(2):\n    print(k)\n\nk"


@pytest.fixture
def example_imports(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(DOCS))
    return importlib.import_module("example_imports")


def test_examples_of_public_names_have_their_imports_on_the_pages(example_imports: Any) -> None:
    import liehom as lh

    for name in public_names():
        thing = getattr(lh, name)
        lines = (inspect.getdoc(thing) or "").split("\n")
        example_imports.complete(lines, thing)
        assert example_imports.undefined("\n".join(code_of("\n".join(lines)))) == set(), name


def test_an_example_with_its_imports_runs_alone(example_imports: Any) -> None:
    import liehom as lh

    for thing in (lh.tasks.completed, lh.decide_fullness, lh.algebra.RootSystem.dominant, lh.LieAlgebra.is_isomorphic):
        lines = (inspect.getdoc(thing) or "").split("\n")
        example_imports.complete(lines, thing)
        assert sum(line.startswith(">>> ") for line in lines) > 1
        exec("\n".join(code_of("\n".join(lines))), {})


def test_a_name_that_a_program_lacks_is_found(example_imports: Any) -> None:
    assert example_imports.undefined("import numpy as np\nx = np.ones(3) + eye") == {"eye"}
    assert example_imports.undefined("def f(x: Any) -> None:\n    return x\n") == {"Any"}
    assert example_imports.undefined("try:\n    pass\nexcept ValueError as error:\n    print(error)") == set()
