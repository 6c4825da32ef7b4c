"""Lattices in QQ^n, rational points of conics, and fixed-point arithmetic.

Reduced bases keep exact numbers small, and the search for rational Cartan involutions tries short vectors. The wing is
used by `liehom.algebra.involutions`, `liehom.fullness.search` and other code that needs small entries; see
docs/theory/structure.md.
"""
