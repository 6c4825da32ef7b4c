"""Invariant geometry of homogeneous spaces G/H: metrics, curvature, Einstein metrics, forms, connections.

The page docs/theory/geometry.md has the conventions and the theory.
"""

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
