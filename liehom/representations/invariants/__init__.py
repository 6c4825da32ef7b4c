"""Intertwiners, invariant forms and vectors, irreducibility, and proofs that matrices respect a bracket.

Exact linear algebra on lists of matrices, without the class `Representation`, which uses it. See
docs/theory/representations.md.
"""

from liehom.representations.invariants.intertwiners import InvariantForms as InvariantForms
