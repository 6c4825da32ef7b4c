"""Parabolic subalgebras of semisimple real algebras, by subsets of the simple restricted roots.

`split_torus` finds a maximal split torus over the field of the algebra and proves that it is maximal over the reals.
`restricted_root_spaces` decomposes the algebra under it and numbers the simple restricted roots as the Satake diagram
does. `parabolic_subalgebra` sums root spaces. Users call `LieAlgebra.parabolic_subalgebra`. The algorithms are
explained in docs/theory/structure.md.
"""
