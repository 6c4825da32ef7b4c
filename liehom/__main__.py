"""``python -m liehom`` is the command ``liehom``."""

from liehom.cli import main

if __name__ == "__main__":
    main()
