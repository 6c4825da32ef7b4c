"""Representations by matrices and pairs (g, h), checked when they are constructed.

`Representation` and `Pair` delegate their methods to the wings above, which is the only import that points upwards.
Every layer above uses this wing; the conventions are in docs/notation.md.
"""

from liehom.representations.core.pair import Pair as Pair
from liehom.representations.core.representation import Representation as Representation
