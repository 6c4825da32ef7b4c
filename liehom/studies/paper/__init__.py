"""The figures of the paper, reproduced: tables, claims with their evidence, plots.

See docs/reproduction.md.
"""

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
