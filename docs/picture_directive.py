"""The directive ``picture`` of the pages, apart from docs/pictures, so that pictures can be drawn without Sphinx."""

from __future__ import annotations

from typing import ClassVar

import pictures
from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.util.docutils import SphinxDirective


class Picture(SphinxDirective):
    """The directive ``picture``: both versions of a picture, of which the page shows one."""

    required_arguments = 1
    option_spec: ClassVar = {"alt": directives.unchanged_required, "width": directives.unchanged}

    def run(self) -> list[nodes.Node]:
        name = self.arguments[0]
        if name not in pictures.DRAWN or not self.options.get("alt"):
            raise self.error(f"{name!r} is not a function of docs/pictures, or has no alt text")
        return [
            nodes.image(
                uri=f"/_pictures/{name}_{kind}.svg",
                alt=self.options["alt"],
                classes=[f"only-{kind}"],
                **({"width": self.options["width"]} if "width" in self.options else {}),
            )
            for kind in ("light", "dark")
        ]
