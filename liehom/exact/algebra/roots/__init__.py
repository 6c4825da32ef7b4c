"""Root systems, Chevalley bases, and the real forms of simple algebras by Vogan and Satake diagrams.

Roots are in coordinates of the simple ones, in the numbering of Bourbaki; see docs/theory/structure.md.
"""
