"""Lattices in QQ^n, rational points of conics, and fixed-point arithmetic.

Reduced bases keep exact numbers small, and the search for rational Cartan involutions looks among short vectors. Used
by `liehom.algebra.involutions` and by whatever needs a basis with small entries; see docs/theory/structure.md.
"""
