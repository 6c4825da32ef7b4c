"""Matrices: integer bases of the linear Lie algebras, and the algebra that given matrices generate.

Bases are those of docs/catalogue.md. Closures are exact, over floats with their uncertainty, or of complex matrices.
"""

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
