"""Algebras, representations and pairs by name.

In reading order: `names` (the grammar), `linear` (names to matrices), `algebras` (algebras and representations),
`subalgebras` and `special` (the denominator of a name ``G/H``), `pairs`, `full_pairs` (all rows of the classification),
`claims` (the expectations of tests).
The names are listed in docs/catalogue.md.
"""

from liehom.catalog.algebras import algebra as algebra
from liehom.catalog.algebras import representation as representation
from liehom.catalog.claims import CLAIMS as CLAIMS
from liehom.catalog.claims import Claim as Claim
from liehom.catalog.classified_pairs import SpiralFamily as SpiralFamily
from liehom.catalog.classified_pairs import full_pairs as full_pairs
from liehom.catalog.names import parse as parse
from liehom.catalog.pairs import pair as pair
from liehom.catalog.pairs import pair_names as pair_names
