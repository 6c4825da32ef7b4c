"""Print the lowest versions that pyproject.toml admits, as requirements: `python lowest.py [EXTRA ...]`."""

from __future__ import annotations

import re
import sys
import tomllib
from pathlib import Path

project = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]
wanted = project["dependencies"] + [r for extra in sys.argv[1:] for r in project["optional-dependencies"][extra]]
for requirement in wanted:
    bound = re.fullmatch(r"([\w.-]+)>=([\w.]+)(,.*)?", requirement)
    if bound is None:
        sys.exit(f"pyproject.toml: {requirement!r} states no lowest version (NAME>=VERSION)")
    print(f"{bound[1]}=={bound[2]}")
