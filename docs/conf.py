"""Configuration of the documentation; built with `sphinx-build -W -b html docs docs/_build/html`."""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))  # the pages document this tree, whatever is installed

project = "liehom"
author = "liehom authors"
copyright = "liehom authors"
release = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
version = release

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.mathjax"]
myst_enable_extensions = ["dollarmath", "amsmath", "deflist"]
myst_heading_anchors = 3
exclude_patterns = ["_build"]

# a single pair of backticks in a docstring is code
default_role = "code"

autodoc_default_options = {"members": True, "show-inheritance": True, "member-order": "bysource"}
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_type_aliases = {"npt.ArrayLike": "ArrayLike"}  # not the page-long union behind it
python_use_unqualified_type_names = True
napoleon_use_ivar = True  # an attribute described in a section is not described a second time
napoleon_use_rtype = False

# annotations name classes that are documented under the package that exports them; where a short name fits
# two of them sphinx warns about its own guess. Links written by hand are still checked.
suppress_warnings = ["ref.python"]

html_theme = "furo"
html_title = f"liehom {release}"
