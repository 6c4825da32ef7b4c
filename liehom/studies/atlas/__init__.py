"""Sweeps over families of pairs, every entry decided, with certificates.

A *recipe* is a pair that a worker constructs from a name; each family is a generator of recipes. See docs/atlas.md.
"""

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
