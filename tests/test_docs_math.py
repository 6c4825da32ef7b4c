"""Formulas of the pages: what the translation must keep, and what the strict build must refuse."""

import importlib.util
import re
from pathlib import Path
from typing import Any

import pytest

DOCS = Path(__file__).resolve().parent.parent / "docs"


def load(name: str) -> Any:
    spec = importlib.util.spec_from_file_location(name, DOCS / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


formulas = load("formulas")

SOUND = [
    r"\tfrac{1}{2}(x + y)",
    r"\frac{1}{12}",
    r"\frac{\frac{a}{b^{2}}}{c_{12}}",
    r"10^{-15} \le 12",
    r"|Y|^2 + \lvert Z\rvert_\infty",
    r"A|_W + |x|",
    r"\left(\frac{1}{2}\right)^2",
    r"[0, 1)",
    r"\{x \mid |x| < \|y\|\}",
    r"x'_i + X'^* y''",
    r"\operatorname{tr}(\operatorname{ad} x \operatorname{ad} y)",
    r"\dim_{\mathbb R} V",
]
FAULTY = {
    r"\tfrac12(x + y)": "braces are missing after",
    r"\frac12": "braces are missing after",
    r"\frac{1}2": "braces are missing after",
    r"\tfrac i2": "braces are missing after",
    r"x^12": "around the digits",
    r"\sqrt12": "around the digits",
    r"|Y^2": "a bar without its partner",
    r"\|Y|": "a bar without its partner",
    r"||x| - |y||": "nothing between",
    r"\lvert Y": "1 of",
    r"(x + \langle y, z)": "fences open",
    r"\frac{(}{2}": "a fraction of a sign",
}


def inner(formula: str) -> str:
    return re.sub(
        r"</?math[^>]*>| (stretchy|form|lspace|rspace|mathvariant|class)=\"\w*\"", "", formulas.translate(formula)
    )


@pytest.mark.parametrize("formula", SOUND)
def test_sound_formula_has_no_fault(formula: str) -> None:
    assert formulas.faults(formula) == []


@pytest.mark.parametrize("formula", FAULTY)
def test_faulty_formula_is_refused_with_its_reason(formula: str) -> None:
    assert any(FAULTY[formula] in fault for fault in formulas.faults(formula))


def test_bars_and_their_exponent_are_one_group() -> None:
    assert inner("2|Y|^2") == "<mn>2</mn><msup><mrow><mo>|</mo><mi>Y</mi><mo>|</mo></mrow><mn>2</mn></msup>"


def test_prime_is_a_superscript_together_with_the_exponent_that_follows() -> None:
    assert inner("x'") == "<msup><mi>x</mi><mi>′</mi></msup>"
    assert inner("x''^*").count("′") == 2 and inner("x'^*").startswith("<msup><mi>x</mi><mrow><mi>′</mi>")
    assert inner(r"\text{it's}") == "<mtext>it's</mtext>"


def test_index_of_a_letter_with_an_accent_is_at_its_lower_right() -> None:
    found = re.sub(r" \w+=\"\w*\"", "", inner(r"\tilde K_{n}"))
    assert found == "<msub><mover><mi>K</mi><mo>~</mo></mover><mi>n</mi></msub>"
    assert "munderover" in inner(r"\sum_{i}^n x") or "msubsup" in inner(r"\sum_{i}^n x")


def test_named_operator_is_set_apart_but_not_from_its_parenthesis() -> None:
    space = '<mspace width="0.1667em" />'
    assert inner(r"\operatorname{ad} x\operatorname{ad} y") == space.join(
        ["<mi>ad</mi>", "<mi>x</mi>", "<mi>ad</mi>", "<mi>y</mi>"]
    )
    assert "mspace" not in inner(r"\operatorname{tr}(x)")


def test_translation_without_repair_shows_the_faults_of_the_tree() -> None:
    tree = formulas.translated(r"\operatorname{tr}(\mathrm{ad} x)")
    assert any("no space" in fault for fault in formulas.faults_of_tree(tree))
    tree = formulas.ElementTree.fromstring("<math><mi>x</mi><mo>'</mo></math>")
    assert formulas.faults_of_tree(tree) == ["an apostrophe where a prime is meant"]


@pytest.mark.parametrize("text", ["m' = f(m)", "the curve m_k’ of", "y'' + y"])
def test_apostrophe_of_a_single_letter_is_a_missing_prime(text: str) -> None:
    assert formulas.APOSTROPHE.search(text)


@pytest.mark.parametrize("text", ["Lie's theorem", "the algebras' names", "the key 'x' of", "m′ = f(m)", "‘x’"])
def test_apostrophe_of_a_word_is_left_alone(text: str) -> None:
    assert not formulas.APOSTROPHE.search(text)


def test_pages_have_a_font_for_formulas_with_its_licence() -> None:
    static = DOCS / "_static"
    style = (static / "liehom.css").read_text(encoding="utf-8")
    file = re.search(r'@font-face \{[^}]*"STIX Two Math"[^}]*url\("([^"]+)"\)', style)
    assert file is not None and 'math { font-family: "STIX Two Math"' in style
    assert (static / file[1]).read_bytes()[:4] == b"wOF2"
    assert "SIL OPEN FONT LICENSE" in (static / "stix-two-math-LICENSE.txt").read_text(encoding="utf-8")
