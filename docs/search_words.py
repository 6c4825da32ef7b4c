"""Search finds what readers look for: each word leads to a page that answers it, by the search program of the pages.

`WORDS` has words of six fields, and a page that is to be among the first `PLACES` pages found. It is compared when the
pages have been built; a word that leads elsewhere is a warning, which the strict build refuses.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import quickjs
from sphinx.util import logging

LOG = logging.getLogger(__name__)
PLACES = 3
WORDS = {
    # geometric integration
    "RKMK": "api/integration/methods",
    "Magnus": "api/series/lie-series",
    "Crouch-Grossman": "api/integration/methods",
    "stiff": "stiff",
    "adaptive step size": "step-sizes",
    "order of a method": "tutorials/integrating",
    "first integral": "theory/correctors",
    "rigid body": "bodies",
    "Lie-Poisson": "lie-poisson",
    "ensemble": "tutorials/compiled",
    "solve_ivp": "coming-from",
    # differential geometry
    "Einstein metric": "theory/geometry",
    "geodesic": "theory/geometry",
    "curvature": "theory/geometry",
    "Betti numbers": "theory/geometry",
    "holonomy": "theory/geometry",
    "symmetric space": "theory/geometry",
    "Grassmannian": "catalogue",
    # Lie theory and teaching
    "Dynkin diagram": "api/plotting",
    "Satake diagram": "api/plotting",
    "real form": "tutorials/structure",
    "nilradical": "tutorials/structure",
    "Bianchi": "catalogue",
    "Casimir": "theory/invariants",
    "full pair": "tutorials/is-this-pair-full",
    "range condition": "theory/range",
    # control and robotics
    "controllability": "control",
    "quaternion": "bodies",
    "pose": "control",
    "attitude": "notebooks/attitude-control",
    "inertia": "bodies",
    "Riccati": "projective",
    "inverse kinematics": "control",
    # quantum physics
    "Pauli": "physics",
    "qubit": "physics",
    "pulse": "step-sizes",
    "spin": "spins",
    "dynamical Lie algebra": "physics",
    # particle physics
    "branching rule": "symmetry-breaking",
    "hypercharge": "symmetry-breaking",
    "tensor product": "tutorials/representations",
    "SU(5)": "notebooks/symmetry-breaking",
    "embedding index": "symmetry-breaking",
    "isospin": "symmetry-breaking",
    "Clebsch-Gordan": "tutorials/representations",
    # all
    "parallel": "distributed",
    "logging": "faq",
}
PROGRAMS = ("language_data.js", "searchtools.js")
STUBS = """
const nothing = {children: [], appendChild: () => nothing, dataset: {}};
const document = {getElementById: () => null, documentElement: nothing, body: nothing};
const window = globalThis, console = {warn() {}}, localStorage = {setItem() {}};
const SPHINX_HIGHLIGHT_ENABLED = false, _ready = () => null, _ = (text) => text;
"""


def pages_found(folder: Path, words: list[str]) -> dict[str, list[str]]:
    """The pages, best first, that the search program in a folder of built pages finds for each word."""
    browser = quickjs.Context()
    browser.eval(STUBS)
    for name in PROGRAMS:
        text = (folder / "_static" / name).read_text(encoding="utf-8").replace('"use strict";', "", 1)
        browser.eval(text.replace("const _removeChildren", "var _removeChildren"))
    browser.eval("_removeChildren = () => null;")
    browser.eval((folder / "searchindex.js").read_text(encoding="utf-8"))
    found = {}
    for word in words:
        ask = f"JSON.stringify(Search._performSearch(...Search._parseQuery({json.dumps(word)})).map(x => x[0]))"
        found[word] = list(dict.fromkeys(reversed(json.loads(browser.eval(ask)))))
    return found


def note_whole(app: Any, env: Any, pages: list[str]) -> None:
    """Remember whether all pages are read: Sphinx leaves index entries of other pages out of what search finds."""
    app.all_pages_are_read = set(pages) == env.found_docs


def compare(app: Any, exception: Exception | None) -> None:
    """Warn of each word whose page is not among the first ones, if all pages were read."""
    if exception is None and app.builder.name == "html" and app.all_pages_are_read:
        for word, pages in pages_found(Path(app.outdir), list(WORDS)).items():
            if WORDS[word] not in pages[:PLACES]:
                LOG.warning("search for %r finds %s first, and not %s", word, pages[:PLACES], WORDS[word])


def setup(app: Any) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("env-before-read-docs", note_whole)
    app.connect("build-finished", compare)
    return {"parallel_read_safe": True}
