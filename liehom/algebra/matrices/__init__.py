"""Integer matrices that are bases of linear Lie algebras, one family per file.

Orthogonal, unitary, symplectic, special linear and spin matrices, the octonions and the Albert algebra, and the table
`classical` of names and parameters. The constructors of `liehom.algebra.constructions` and the catalogue use them;
the bases are described in docs/catalogue.md.
"""
