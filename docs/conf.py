"""Configuration of the documentation; built with `sphinx-build -W -b html docs docs/_build/html`."""

from __future__ import annotations

import os
import re
import sys
import tomllib
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.utils.math import MathError
from sphinx import addnodes
from sphinx.util import inspect, logging

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "docs")]  # the pages document this tree, whatever is installed

import api_pages  # noqa: E402 - found by the path that is set above
import example_imports  # noqa: E402
import formulas  # noqa: E402
import page_links  # noqa: E402

LOG = logging.getLogger(__name__)

project = "liehom"
author = "liehom authors"
copyright = "liehom authors"
release = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
version = release

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_copybutton", "search_words"]
myst_enable_extensions = ["dollarmath", "amsmath", "deflist"]
myst_heading_anchors = 3
# Notebooks are stored without outputs, and the build runs them. For a cell that fails or writes to stderr there is a
# warning, which the strict build refuses.
nb_execution_mode = "force"
nb_execution_show_tb = True
nb_execution_timeout = 60
nb_execution_in_temp = True
nb_output_stderr = "remove-warn"
nb_merge_streams = True
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))  # for their kernels

exclude_patterns = ["_build", "pictures"]

# the button of a block copies its code alone, without prompts and output; blocks of output alone have no button
copybutton_prompt_text = r">>> |\.\.\. |\.\.\.$|\$ "
copybutton_prompt_is_regexp = True
copybutton_selector = "div:not(.highlight-text, .highlight-myst-ansi) > div.highlight > pre"

# a single pair of backticks in a docstring is code
default_role = "code"

autodoc_default_options = {"members": True, "member-order": "bysource"}
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
# names, not the unions of half a page behind them
autodoc_type_aliases = {"npt.ArrayLike": "ArrayLike", **api_pages.type_aliases()}
inspect.TypeAliasForwardRef.__repr__ = lambda self: self.name  # type: ignore[method-assign]  # inside unions and tuples
python_use_unqualified_type_names = True
napoleon_use_ivar = True  # an attribute described in a section is not described a second time
napoleon_use_rtype = False

# annotations name classes that are documented under the package that exports them; where a short name fits
# two of them sphinx warns about its own guess. Links written by hand are still checked.
suppress_warnings = ["ref.python"]

html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["liehom.css"]
html_title = f"liehom {release}"
html_search_scorer = str(ROOT / "docs" / "search_scorer.js")


# Formulas become MathML when the pages are built, so that they can be read without a network and without scripts.
html_math_renderer = "mathml"


def mathml(visitor: Any, node: nodes.Element, *, display: bool) -> None:
    """Write a formula as MathML; a fault in it is a warning, which the strict build refuses."""
    formula = node.astext()
    try:
        wrong = formulas.faults(formula)
        visitor.body.append(formulas.translate(formula, display=display))
    except MathError as error:
        wrong = [str(error)]
    for fault in wrong:
        LOG.warning("formula %r: %s", formula, fault, location=node)
    raise nodes.SkipNode


def refuse_apostrophes(app: Any, doctree: nodes.document) -> None:
    """A warning for each letter of the text whose prime is an apostrophe."""
    for text in doctree.findall(nodes.Text):
        if not isinstance(text.parent, (nodes.literal, nodes.math, nodes.raw, nodes.FixedTextElement)):
            for match in formulas.APOSTROPHE.finditer(text.astext()):
                LOG.warning("%s needs a prime: $%s'$, or ′ in text", match[0], match[1], location=text.parent)


def keep_bars(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """In the text of a docstring bars and stars are not markup, and x' has a prime; code is left alone."""
    inside = False
    for i, line in enumerate(lines):
        text = line.strip()
        inside = bool(text) and (inside or text.startswith(">>>"))
        if not inside:
            lines[i] = escaped(line)


def escaped(line: str) -> str:
    """One line of a docstring as reStructuredText."""
    parts = re.split(r"(``[^`]*``|`[^`]*`)", line)
    return "".join(
        part
        if part.startswith("`")
        else re.sub(
            r"\||\*\*(?=\w)|(?<![\w*])\*(?=\w+(?:[^\w*]|$))(?!\S[^*]*\S\*(?!\w))",
            lambda bar: "".join(f"\\{c}" for c in bar[0]),
            formulas.APOSTROPHE.sub(lambda prime: prime[1] + "\u2032" * len(prime[2]), part),
        )
        for part in parts
    )


def complete_examples(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Examples of docstrings begin with the imports that they need."""
    example_imports.complete(lines, thing)


def check_links(app: Any, exception: Exception | None) -> None:
    """A warning for each link of the built pages that leads nowhere, and for each picture without words."""
    if exception is None and app.builder.name == "html":
        for page, fault in page_links.faults(Path(app.outdir)):
            LOG.warning("%s: %s", page, fault)


def link_notebook(app: Any, doctree: nodes.document) -> None:
    """Below the title of a notebook a link that downloads it."""
    source = Path(app.env.doc2path(app.env.docname))
    title = next(doctree.findall(nodes.title), None)
    if source.suffix == ".ipynb" and title is not None:
        link = addnodes.download_reference("", "", reftarget=source.name, refdoc=app.env.docname, classes=["notebook"])
        link += nodes.Text(f"Download {source.name}")
        title.parent.insert(1, nodes.paragraph("", "", link))


def setup(app: Any) -> None:
    """Register the renderer and the treatment of docstrings."""
    app.connect("autodoc-process-docstring", complete_examples, priority=100)
    app.connect("autodoc-process-docstring", keep_bars, priority=900)
    app.connect("doctree-read", refuse_apostrophes)
    app.connect("build-finished", check_links)
    app.connect("doctree-read", link_notebook, priority=400)  # before the files to download are collected
    import name_links  # found by the path that is set above
    import page_tree
    import pair_page_directive
    import picture_directive
    import pictures

    from tests.benchmarks import energy_drift, integration_pictures, stability

    def expand(app: Any, page: str, source: list[str]) -> None:
        source[0] = api_pages.expand(page, source[0], escaped)

    def add_members(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
        if what in ("class", "exception"):
            lines += api_pages.members(*name.rsplit(".", 1), escaped)

    def keep_colon(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
        """Before napoleon, which takes the words before a colon in the first line of a property for its type."""
        if what in ("attribute", "data", "property") and lines and ":" in lines[0]:
            lines.insert(0, "")

    app.connect("source-read", expand)
    app.connect("autodoc-process-docstring", keep_colon, priority=100)
    app.connect("autodoc-process-docstring", add_members, priority=950)
    app.connect("builder-inited", pictures.draw)
    for module in (energy_drift, integration_pictures, stability):
        app.connect("builder-inited", lambda app, draw=module.draw_for_pages: draw(pictures.FOLDER))
    app.connect("html-page-context", page_tree.Navigation(), priority=100)
    app.add_directive("pairpage", pair_page_directive.PairPage)
    linker = name_links.Linker()
    app.connect("doctree-resolved", linker, priority=900)
    app.connect("build-finished", linker.report)
    app.add_directive("picture", picture_directive.Picture)
    app.add_directive("gallery", picture_directive.Gallery)
    app.add_html_math_renderer(
        "mathml",
        (lambda visitor, node: mathml(visitor, node, display=False), None),
        (lambda visitor, node: mathml(visitor, node, display=True), None),
    )
