"""The navigation in the margin of every page, made from the titles of the pages alone.

Sphinx copies the headings and entries of all pages for the navigation of each page, then drops all but the titles. With
thousands of entries of the API that is half the time of a build. Here the titles are picked out once.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from docutils import nodes
from sphinx import addnodes


def titles(toc: nodes.bullet_list) -> nodes.bullet_list:
    """The contents of a page with its title and its lists of pages, without headings and entries."""
    kept = toc.copy()
    for item in toc.children:
        if not isinstance(item, nodes.list_item):
            kept += item.deepcopy()
            continue
        head = item.copy()
        head += item[0].deepcopy()
        if lists := [tree.deepcopy() for tree in item.findall(addnodes.toctree)]:
            head += nodes.bullet_list("", *lists)
        kept += head
    return kept


class Navigation:
    """Lists pages by `titles` wherever the theme asks for titles only; connected before the theme asks."""

    def __init__(self) -> None:
        self.titles: dict[str, nodes.bullet_list] = {}

    def __call__(self, app: Any, page: str, template: str, context: dict[str, Any], doctree: Any) -> None:
        whole: Callable[..., str] | None = context.get("toctree")
        if whole is None:
            return
        contents = app.env.tocs
        self.titles = self.titles or {name: titles(toc) for name, toc in contents.items()}

        def toctree(**options: Any) -> str:
            app.env.tocs = self.titles if options.get("titles_only") else contents
            try:
                return whole(**options)
            finally:
                app.env.tocs = contents

        context["toctree"] = toctree
