"""Links from names in prose to the API, and anchors for the addresses that entries had before."""

from __future__ import annotations

from collections import Counter
from typing import Any

import api_pages
from cross_references import Names
from docutils import nodes
from sphinx import addnodes
from sphinx.util import logging

LOG = logging.getLogger(__name__)
UNLINKED = (
    nodes.reference,
    nodes.title,
    addnodes.desc_signature,
    addnodes.pending_xref,
    nodes.FixedTextElement,
    nodes.rubric,
)
PAST = {"changelog"}
"""Pages that name what is gone."""

KEYS = {"formats", "command-line"}
"""Pages on which words in code markup are keys of files, or options."""

ONCE_IN = (nodes.row, nodes.definition, addnodes.desc_content, nodes.section)


class Linker:
    """Links the first mention of a name in each section, row of a table, or entry."""

    def __init__(self) -> None:
        self.names = Names(())
        self.places: dict[str, Any] = {}
        self.counts: Counter[str] = Counter()

    def begin(self, app: Any) -> None:
        """Collect the entries of all pages."""
        objects = app.env.domains["py"].objects
        self.places = {
            name: entry for name, entry in objects.items() if name.startswith("liehom") and not entry.aliased
        }
        self.names = Names(name for name, entry in self.places.items() if entry.objtype != "module")

    def __call__(self, app: Any, doctree: nodes.document, page: str) -> None:
        if not self.places:
            self.begin(app)
        made: set[tuple[int, str]] = set()
        for literal in list(doctree.findall(nodes.literal)):
            self.link(app, page, literal, made)
        for reference in list(doctree.findall(nodes.reference)):
            self.unlink_word(reference)
        if page.startswith("api/") and page.count("/") == 1:
            self.anchor(doctree)

    def link(self, app: Any, page: str, literal: nodes.literal, made: set[tuple[int, str]]) -> None:
        above, within = [], ""
        node = literal.parent
        while node is not None:
            if isinstance(node, UNLINKED):
                return
            above.append(node)
            if isinstance(node, addnodes.desc) and not within and node[0].get("ids"):
                within = node[0]["ids"][0]
            node = node.parent
        try:
            around = within or (api_pages.page_module(page) if page.startswith("api/") else "")
            entry = self.names.meant(literal.astext(), around, bare_names_are_keys=page in KEYS)
        except LookupError as error:
            if page not in PAST:
                LOG.warning("%s: there is no %s", literal.astext(), error, location=literal)
            return
        path = next(self.names.paths(literal.astext()), "")
        entry = entry or (path if path in self.places else None)
        self.counts["linked" if entry else "ours, without entry" if path else "not ours"] += 1
        if entry is None or entry == within or f"{within}.".startswith(f"{entry}."):
            return
        place = next(id(node) for node in above if isinstance(node, (*ONCE_IN, nodes.document)))
        if (place, entry) in made:
            return
        made.add((place, entry))
        self.counts["links"] += 1
        target = self.places[entry]
        uri = app.builder.get_relative_uri(page, target.docname) + "#" + target.node_id
        reference = nodes.reference("", "", internal=True, refuri=uri, reftitle=entry)
        literal.replace_self(reference)
        reference += literal

    def unlink_word(self, reference: nodes.reference) -> None:
        """In the type of a parameter, such as "array of shape (N,)", only types are links, not names of methods."""
        entry = reference.get("refuri", "").rpartition("#")[2] or reference.get("refid", "")
        kind = self.places[entry].objtype if entry in self.places else "class"
        if isinstance(reference[0], nodes.emphasis) and kind not in ("class", "exception", "data", "type"):
            reference.replace_self(reference.children)

    def anchor(self, doctree: nodes.document) -> None:
        """Rows of tables on the page of a package get the addresses that their entries had on this page."""
        rows: dict[str, nodes.Element] = {}
        for table in doctree.findall(nodes.table):
            for row in table.findall(nodes.row) if "api-names" in table["classes"] else ():
                for link in list(row.findall(nodes.reference))[:1]:
                    page, _, entry = link.get("refuri", "").rpartition("#")
                    if page and entry in self.places:
                        rows.setdefault(entry, row[0])
        seen = {name for node in doctree.findall(nodes.Element) for name in node.get("ids", [])}
        for name in sorted(self.places.keys() - seen):
            if cell := rows.get(name) or rows.get(name.rpartition(".")[0]):  # its own row, or that of its class
                cell["ids"].append(name)

    def report(self, app: Any, exception: Exception | None) -> None:
        """Log how many names were linked."""
        LOG.info("names in prose: %s", ", ".join(f"{count} {what}" for what, count in sorted(self.counts.items())))
