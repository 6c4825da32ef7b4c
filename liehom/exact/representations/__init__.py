"""Representations by matrices, pairs (g, h), isotropy of a point, highest weight modules, decompositions."""

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
