"""``python -m liehom`` is the command ``liehom``."""

from __future__ import annotations

from liehom.cli import main

if __name__ == "__main__":
    main()
