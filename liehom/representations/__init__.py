"""Representations by matrices, pairs (g, h), and the isotropy of a point."""

from liehom.representations.pair import Pair as Pair
from liehom.representations.representation import Representation as Representation
