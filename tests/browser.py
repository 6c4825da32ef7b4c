"""A headless browser for tests of pages; tests that need it are skipped without one."""

import shutil
import subprocess
from pathlib import Path

import pytest

BROWSER = shutil.which("chromium") or shutil.which("google-chrome")
needs_browser = pytest.mark.skipif(BROWSER is None, reason="no browser")
FLAGS = (
    "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking "
    "--disable-component-update --disable-sync --virtual-time-budget=8000 --dump-dom"
)


def dom(page: Path, ready: str = "") -> str:
    """The document that a browser makes of a page, after its scripts have run; a busy machine may need another try."""
    words = [str(BROWSER), *FLAGS.split(), f"--user-data-dir={page.parent / 'profile'}", page.as_uri()]
    for _ in range(3):
        text = subprocess.run(words, capture_output=True, text=True, timeout=120, check=True).stdout
        if ready in text:
            break
    return text
