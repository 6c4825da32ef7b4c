"""The directive ``pairpage``: the page that `liehom show` writes about a pair, inside a page of the documentation."""

from __future__ import annotations

import os
import re
from html import escape
from pathlib import Path

from docutils import nodes
from sphinx.util.docutils import SphinxDirective

import liehom as lh


class PairPage(SphinxDirective):
    """The page of the pair that the argument names, in a frame, and a link to it."""

    required_arguments = 1
    final_argument_whitespace = True

    def run(self) -> list[nodes.Node]:
        name = self.arguments[0]
        for file in Path(lh.io.__path__[0]).iterdir():
            self.env.note_dependency(str(file))
        target = Path("_static", f"pair_{re.sub('[^a-z0-9]+', '_', name)}.html")
        written = Path(self.env.app.outdir) / target
        written.parent.mkdir(parents=True, exist_ok=True)
        lh.pair_page(lh.pair(name), written)
        link = os.path.relpath(target, Path(self.env.docname).parent).replace(os.sep, "/")
        title = escape(f"The page of the pair {name}")
        frame = f'<iframe class="pair-page" src="{link}" title="{title}"></iframe>'
        alone = f'<p><a href="{link}">{title}, alone in the window</a></p>'
        return [nodes.raw("", frame + alone, format="html")]
