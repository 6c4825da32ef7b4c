"""The constructors of the top level: classical and simple algebras, sums, families with parameters, solvable algebras.

Each proves the axioms of what it returns; docs/catalogue.md lists the bases.
"""
