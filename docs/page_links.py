"""Faults of built pages: links and anchors that lead nowhere, pictures without words, tags that do not match."""

from __future__ import annotations

import os
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

ALONE = {"area", "base", "br", "col", "embed", "hr", "img", "input", "link", "meta", "source", "track", "wbr"}
"""The tags without an end."""


class Page(HTMLParser):
    """The anchors and the links of a page, and what is wrong with its tags."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: dict[str, None] = {}
        self.faults: list[str] = []
        self.open: list[str] = []
        self.feed(text)
        self.close()
        self.faults += [f"<{tag}> is not closed" for tag in self.open]

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note an anchor, a link, a picture."""
        found = dict(attrs)
        anchor = found.get("id")
        if anchor and anchor in self.anchors:
            self.faults.append(f"two anchors {anchor!r}")
        self.anchors |= {anchor} if anchor else set()
        self.links |= {link: None for link in (found.get("href"), found.get("src")) if link}
        if tag == "img" and not found.get("alt"):
            self.faults.append(f"the picture {found.get('src')!r} has no alt text")
        if tag not in ALONE:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """A tag such as <path/>, which is closed where it begins."""
        self.handle_starttag(tag, attrs)
        if tag not in ALONE:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        """Close the innermost tag, which must be this one."""
        if self.open[-1:] == [tag]:
            self.open.pop()
        else:
            self.faults.append(f"</{tag}> closes {self.open[-1:]} in line {self.getpos()[0]}")


def dead(link: str, page: Path, pages: dict[Path, Page]) -> str | None:
    """The fault of a link of a page, or None; a link to the outside must have a host."""
    parts = urlsplit(link)
    if parts.scheme in ("http", "https") or parts.netloc:
        return None if "." in parts.netloc and not set(link) & set(" <>\"'`\\") else f"{link!r} is not an address"
    if parts.scheme:
        return None if parts.scheme in ("mailto", "data") else f"{link!r} has an unknown scheme"
    target = Path(os.path.normpath(page.parent / unquote(parts.path))) if parts.path else page
    if not target.exists():
        return f"{link!r} leads to no file"
    if parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors:
        return f"{link!r} leads to no anchor"
    return None


def faults(folder: Path) -> Iterator[tuple[str, str]]:
    """The faults of all pages of a folder, each with the name of its page."""
    paths = (path for path in sorted(folder.rglob("*.html")) if "_static" not in path.relative_to(folder).parts)
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in paths}
    for path, page in pages.items():
        found = [*page.faults, *(dead(link, path, pages) for link in page.links)]
        yield from ((path.relative_to(folder).as_posix(), fault) for fault in found if fault)
