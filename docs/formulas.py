"""Formulas of the pages as MathML, and the faults that the strict build refuses to print.

`translate` adds what the translation by docutils lacks: a prime is raised and not an apostrophe, a pair of bars is one
group, and a named operator keeps its distance. `faults` lists what cannot be guessed.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from xml.etree import ElementTree

from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import accents, tex2mathml

Node = ElementTree.Element
NAMESPACE = ' xmlns="http://www.w3.org/1998/Math/MathML"'
APPLY = "\u2061"  # the invisible sign between a function and its argument
BARS = ("|", "‖")
OPEN, CLOSE = ("(", "[", "{", "⟨", "⌊", "⌈"), (")", "]", "}", "⟩", "⌋", "⌉")
PAIRS = (("left", "right"), ("lvert", "rvert"), ("lVert", "rVert"))
SCRIPTS = ("msub", "msup", "msubsup", "mover", "munder", "munderover")
ATOMS = ("mi", "mn", "mtext", "mfrac", "msqrt", "mroot", "mrow", *SCRIPTS)
THIN = "0.1667em"

GROUP = r"\{(?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*\}"
TEXT = rf"\\(?:text|mbox){GROUP}"
PRIME = re.compile(rf"({TEXT})|('+)(?:\s*\^\s*({GROUP}|\\[A-Za-z]+|\S))?")
FRACTION = re.compile(rf"\\(?:[tdc]?frac|[td]?binom)(?![A-Za-z])(?!\s*{GROUP}\s*\{{)")
DIGITS = re.compile(r"(?:[\^_]|\\(?:sqrt|bar|hat|tilde)) *[0-9]{2}")
APOSTROPHE = re.compile(r"(?<![\w'’‘\"“])([A-Za-z](?:_\w+)?)(['’]{1,3})(?![\w'’])")
"""A letter with primes that are written as apostrophes, in text."""


def translate(formula: str, *, display: bool = False) -> str:
    """MathML of a LaTeX formula; raises docutils' `MathError` if there is no translation."""
    return ElementTree.tostring(repaired(formula, display=display), encoding="unicode").replace(
        "<math", f"<math{NAMESPACE}", 1
    )


def faults(formula: str) -> list[str]:
    """Sentences on the faults of a formula, an empty list for a sound one."""
    found = [f"braces are missing after {m[0].strip()}" for m in FRACTION.finditer(formula)]
    found += [f"braces are missing around the digits of {m[0]}" for m in DIGITS.finditer(formula)]
    for pair in PAIRS:
        left, right = (len(re.findall(rf"\\{name}(?![A-Za-z])", formula)) for name in pair)
        if left != right:
            found.append(f"{left} of \\{pair[0]} and {right} of \\{pair[1]}")
    return found or faults_of_tree(repaired(formula))  # without its braces a formula may have no translation


def faults_of_tree(tree: Node) -> list[str]:
    """The faults that are seen in MathML: lone fences, apostrophes, fractions of signs, names without a space."""
    found = []
    for row in rows(tree):
        texts = [core(child) for child in row]
        opened, closed = (sum(text in fences for text in texts) for fences in (OPEN, CLOSE))
        if opened != closed:
            found.append(f"{opened} fences open and {closed} close in {''.join(row.itertext())!r}")
        for child, after in zip(row, [*row[1:], None], strict=True):
            if core(child) in BARS and base(child).get("form") is None and child.tag != "msub":
                found.append(f"a bar without its partner in {''.join(row.itertext())!r}")
            if child.tag == "mrow" and len(child) == 2 and core(child[0]) in BARS:
                found.append(f"bars with nothing between them in {''.join(row.itertext())!r}")
            if touching(child, after):
                found.append(f"no space in {''.join(child.itertext()) + ''.join(after.itertext())!r}")
    for node in tree.iter():
        if node.tag == "mfrac" and any(part.tag == "mo" for part in node):
            found.append(f"a fraction of a sign: {[*node.itertext()]}")
        if node.tag in ("mi", "mo") and "'" in (node.text or ""):
            found.append("an apostrophe where a prime is meant")
    return found


def repaired(formula: str, *, display: bool = False) -> Node:
    """The translation by docutils as a tree, with its repairs."""
    tree = translated(formula, display=display)
    for node in [*tree.iter()]:
        if node.tag == "munderover" and node[2].tag == "mo" and node[2].text in accents.values():
            index_beside_accent(node)
        elif node.text == "′":
            node.set("class", "prime")  # larger than other exponents, see the style sheet
    for row in [*rows(tree)]:  # the groups that come in are not looked at again
        pair_bars(row)
    for row in [*rows(tree)]:
        set_operators_apart(row)
    return tree


def translated(formula: str, *, display: bool = False) -> Node:
    """The translation by docutils of a formula with raised primes, as a tree."""
    try:
        markup = tex2mathml(PRIME.sub(raised, formula.replace("\\dots", "\\ldots")), as_block=display)
    except IndexError as error:
        raise MathError("a prime or another script without a base") from error
    # the set difference is missing in common fonts
    markup = markup.replace(NAMESPACE, "").replace("&ApplyFunction;", APPLY).replace("\u29f5", "\\")
    return ElementTree.fromstring(re.sub(r">\s*\n\s*<", "><", markup))


def index_beside_accent(node: Node) -> None:
    """Move an index from below a letter with an accent to its lower right."""
    letter, index, accent = node
    accented = ElementTree.Element("mover", accent="true")
    accented.extend([letter, accent])
    node.tag = "msub"
    node[:] = [accented, index]


def raised(match: re.Match[str]) -> str:
    """The LaTeX of primes and of the exponent that follows them, which is one superscript; text is left alone."""
    text, primes, exponent = match.groups()
    return text or "^{" + "\\prime " * len(primes) + (exponent or "") + "}"


def rows(tree: Node) -> Iterator[Node]:
    """The nodes whose children are a row."""
    return (node for node in tree.iter() if len(node) > 1 and node.tag not in ("mfrac", "mroot", *SCRIPTS))


def base(node: Node) -> Node:
    """The node without its scripts."""
    return base(node[0]) if node.tag in SCRIPTS else node


def core(node: Node) -> str:
    """The operator that a node is, with or without scripts, or an empty string."""
    inner = base(node)
    return (inner.text or "").strip() if inner.tag == "mo" else ""


def pair_bars(row: Node) -> None:
    """Group each pair of bars with what it encloses, so that a script belongs to the group and not to a bar."""
    found: list[Node] = []
    open_at: dict[str, int] = {}
    for child in list(row):
        bar = core(child)
        if bar not in BARS or (bar not in open_at and child.tag in SCRIPTS):  # a restriction to a subspace has one bar
            found.append(child)
        elif bar not in open_at:
            open_at[bar] = len(found)
            found.append(child)
        else:
            start = open_at.pop(bar)
            open_at = {other: at for other, at in open_at.items() if at < start}
            group = ElementTree.Element("mrow")
            group.extend([*found[start:], base(child)])
            for node, form in ((group[0], "prefix"), (group[-1], "postfix")):
                node.attrib.update(form=form, stretchy=node.get("stretchy", "true"), lspace="0", rspace="0")
            del found[start:]
            if child.tag in SCRIPTS:
                child[0] = group
            found.append(child if child.tag in SCRIPTS else group)
    row[:] = found


def named(node: Node) -> bool:
    """Whether a node is an operator with an upright name of several letters, such as ad and tr."""
    text = base(node).text or ""
    return base(node).tag == "mi" and len(text) > 1 and text.isascii() and text.isalpha()


def touching(left: Node, right: Node | None) -> bool:
    """Whether two neighbours of a row would be read as one word."""
    if right is None or right.tag not in ATOMS:
        return False
    before = left.tag in ATOMS or core(left) in CLOSE
    return before and (named(right) or named(left))


def set_operators_apart(row: Node) -> None:
    """A thin space between a named operator and its neighbours, except for fences and signs."""
    found: list[Node] = []
    for child in row:
        if core(child) == APPLY:
            continue
        if found and touching(found[-1], child):
            found.append(ElementTree.Element("mspace", width=THIN))
        found.append(child)
    row[:] = found
