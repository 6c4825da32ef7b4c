"""The public names and their parameters change only on purpose: the file is written anew and the changelog says it."""

from difflib import unified_diff

from tests import public_names


def test_public_names_and_parameters_are_those_of_the_snapshot() -> None:
    recorded = public_names.FILE.read_text(encoding="utf-8").splitlines()
    found = list(public_names.lines())
    difference = "\n".join(unified_diff(recorded, found, "tests/public_names.txt", "liehom", lineterm="", n=0))
    assert not difference, f"{difference}\nrun: python -m tests.public_names > tests/public_names.txt"


def test_a_changed_parameter_is_seen() -> None:
    """A control."""

    def changed(x: int, *, tolerance: float = 1e-9) -> None: ...

    assert public_names.parameters(changed) == "(x, *, tolerance=1e-09)"
