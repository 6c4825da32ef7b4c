"""Each row of the theorems is compared with the literature."""

import re
from pathlib import Path

PAGE = Path(__file__).resolve().parents[4] / "docs" / "theory" / "classification.md"
NAME = re.compile(
    r"\\mathfrak\{(?:so|su|sp|sl|spin)\}\([^)$]*\)|\\mathfrak g_2|\\mathfrak u\(1\)|\\mathbb\{[RCHO][PH]\}\^[dm2]|S\^\w"
)


def test_each_linear_algebra_and_space_is_in_the_concordance() -> None:
    text = PAGE.read_text(encoding="utf-8")
    theorem, concordance = text.partition("## 1. The theorem")[2].partition("## 2.")[0], text.partition("## 11.")[2]
    lines = [
        [cell.strip() for cell in line.split("|")[1:-1]] for line in theorem.splitlines() if line.startswith("| $")
    ]
    linear = [row[1] for row in lines if len(row) == 3]
    spaces = [row[3] for row in lines if len(row) == 5]
    assert len(linear) > 10 and len(spaces) > 8
    named = {found for cell in (*linear, *spaces) for found in NAME.findall(cell)}
    assert len(named) > 20 and named <= set(NAME.findall(concordance))
