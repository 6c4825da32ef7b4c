"""End with an error unless the version is the same in all places: `python version.py` in the root of the project."""

from __future__ import annotations

import re
import sys
import tomllib
from pathlib import Path

version = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
places = {
    "liehom/__init__.py": r'^__version__ = "(.+)"$',
    "CITATION.cff": r"^version: (.+)$",
    "docs/changelog.md": r"^## (\S+)",
}
for place, pattern in places.items():
    found = re.search(pattern, Path(place).read_text(encoding="utf-8"), re.MULTILINE)
    if found is None or found[1] not in (version, "Unreleased" if ".dev" in version else version):
        sys.exit(f"{place} has version {found and found[1]}, pyproject.toml has {version}")
print(version)
