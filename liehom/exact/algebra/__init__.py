"""Lie algebras by structure constants, their subalgebras and homomorphisms, structure theory, and constructions."""

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
