"""The check of built pages finds dead links, pictures without words and tags that do not match."""

import importlib
import re
from pathlib import Path
from typing import Any

import pytest

from tests.test_docs import DOCS, ROOT

SOUND = """<!DOCTYPE html><html><body><h1 id="top">A page<br></h1><img src="a.svg" alt="a curve"/>
<p><a href="#top">up</a> <a href="sub/other.html#there">other</a> <a href="https://www.sphinx-doc.org/">made by</a>
<svg><path d="M0"/></svg> <a href="sub/other.html?x=1#%74here">again</a> <a href="mailto:a@example.org">mail</a></p>
</body></html>"""


@pytest.fixture
def faults(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Any:
    monkeypatch.syspath_prepend(str(DOCS))
    (tmp_path / "a.svg").touch()
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub/other.html").write_text('<p id="there"><a href="../page.html#top">back</a></p>', encoding="utf-8")

    def of(text: str) -> list[tuple[str, str]]:
        (tmp_path / "page.html").write_text(text, encoding="utf-8")
        return list(importlib.import_module("page_links").faults(tmp_path))

    return of


def test_a_sound_page_has_no_faults(faults: Any) -> None:
    assert faults(SOUND) == []


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ('"#top"', '"#bottom"', "leads to no anchor"),
        ('"sub/other.html#there"', '"other.html"', "leads to no file"),
        ('"sub/other.html#there"', '"sub/other.html#here"', "leads to no anchor"),
        ('src="a.svg"', 'src="b.svg"', "leads to no file"),
        ('alt="a curve"', 'alt=""', "has no alt text"),
        ("https://www.sphinx-doc.org/", "https://sphinx", "is not an address"),
        ("https://www.sphinx-doc.org/", "https://www.sphinx-doc.org/`", "is not an address"),
        ("mailto:", "javascript:", "has an unknown scheme"),
        ("</p>\n", "", "closes ['p']"),
        ("<svg>", '<svg id="top">', "two anchors 'top'"),
    ],
)
def test_a_fault_is_found(faults: Any, old: str, new: str, fault: str) -> None:
    assert old in SOUND
    found = faults(SOUND.replace(old, new, 1))
    assert {page for page, _ in found} <= {"page.html", "sub/other.html"}
    assert any(fault in message for _, message in found)


def test_the_strict_build_checks_links() -> None:
    assert 'app.connect("build-finished", check_links)' in (DOCS / "conf.py").read_text(encoding="utf-8")
    assert "sphinx-build -W" in (ROOT / ".ci/run").read_text(encoding="utf-8")


def test_html_written_in_a_page_has_words_for_its_pictures() -> None:
    for page in [ROOT / "README.md", *sorted(DOCS.rglob("*.md"))]:
        text = page.read_text(encoding="utf-8")
        assert all(re.search(r'\balt="[^"]+"', tag) for tag in re.findall(r"<img[^>]*>", text)), page.name
        directives = re.findall(r"^```\{(?:image|figure|picture)\}.*\n((?::.*\n)*)", text, flags=re.MULTILINE)
        assert all(":alt: " in options for options in directives), page.name
