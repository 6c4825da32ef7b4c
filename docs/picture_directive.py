"""The directives ``picture`` and ``gallery`` of the pages, apart from docs/pictures, which is used without Sphinx."""

from __future__ import annotations

import re
from pathlib import Path
from typing import ClassVar

import picture_source
import pictures
from docutils import nodes
from docutils.parsers.rst import directives
from sphinx import addnodes
from sphinx.util.docutils import SphinxDirective

DOCS = Path(__file__).resolve().parent
USE = re.compile(r"^`{3,}\{picture\} (\w+)\n:alt: (.*)$", flags=re.MULTILINE)


def versions(name: str, alt: str, **options: str) -> list[nodes.Node]:
    """Both versions of a picture, of which the page shows one."""
    return [
        nodes.image(uri=f"/_pictures/{name}_{kind}.svg", alt=alt, classes=[f"only-{kind}"], **options)
        for kind in ("light", "dark")
    ]


class Picture(SphinxDirective):
    """The directive ``picture``: a picture in the version that fits the page."""

    required_arguments = 1
    option_spec: ClassVar = {"alt": directives.unchanged_required, "width": directives.unchanged}

    def run(self) -> list[nodes.Node]:
        name = self.arguments[0]
        if not (pictures.FOLDER / f"{name}_light.svg").exists() or not self.options.get("alt"):
            raise self.error(f"{name!r} is not a function of docs/pictures, or has no alt text")
        return versions(name, **self.options)


class Gallery(SphinxDirective):
    """The directive ``gallery``: the named pictures with the pages that use them and their programs, as equal cards."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        self.env.note_reread()  # pictures and pages change without this page
        uses: dict[str, tuple[str, str]] = {}
        for path in sorted(DOCS.rglob("*.md")):
            for name, alt in USE.findall(path.read_text(encoding="utf-8")):
                uses.setdefault(name, (path.relative_to(DOCS).with_suffix("").as_posix(), alt))
        if unknown := [name for name in self.content if name not in uses]:
            raise self.error(f"no page shows {', '.join(unknown)}")
        return [nodes.container("", *(self.item(name, *uses[name]) for name in self.content), classes=["gallery"])]

    def item(self, name: str, page: str, alt: str) -> nodes.Node:
        """One picture, which opens in full size, below it its title, the page and the folded program."""
        program = picture_source.script(pictures.DRAWN[name])
        opened = [
            nodes.reference("", "", image, refuri=f"_images/{name}_{kind}.svg", classes=[f"only-{kind}"])
            for image, kind in zip(versions(name, alt), ("light", "dark"), strict=True)
        ]
        link = addnodes.pending_xref(refdomain="std", reftype="doc", reftarget=f"/{page}", refexplicit=False)
        link += nodes.inline()
        title = nodes.paragraph("", "", nodes.strong("", name.replace("_", " ").capitalize()), nodes.Text(" in "), link)
        folded = nodes.raw("", f"<details><summary>{program.count(chr(10))} lines</summary>", format="html")
        code = nodes.literal_block(program, program, language="python")
        end = nodes.raw("", "</details>", format="html")
        return nodes.container("", nodes.paragraph("", "", *opened), title, folded, code, end, ids=[name])
