"""Each number of the paper is that of its source, and its citations are in its list of references."""

import re

from paper.numbers import KEYED, PAPER, numbers

BODY = PAPER.read_text(encoding="utf-8").split("---\n", 2)[2]


def test_numbers_of_the_paper_are_those_of_their_sources() -> None:
    values = numbers()
    assert {key: said for said, key in KEYED.findall(BODY)} == {key: values[key] for _, key in KEYED.findall(BODY)}


def test_each_number_of_the_paper_names_its_source() -> None:
    text = KEYED.sub("", BODY)
    for other in (r"\$[^$]+\$", r"`[^`]+`", r"\[[-@].+?\]", r"in 2002", r"\(\w+\.pdf\)"):
        text = re.sub(other, "", text, flags=re.DOTALL)
    assert not re.findall(r".*\d.*", text.replace("RK4", "").replace("DOP853", ""))


def test_citations_of_the_paper_have_references() -> None:
    entries = re.findall(r"^@\w+\{(\w+),", PAPER.with_suffix(".bib").read_text(encoding="utf-8"), re.MULTILINE)
    assert set(re.findall(r"@(\w+)", BODY)) == set(entries)
