from liehom.exact.catalog.algebras import algebra as algebra, representation as representation
from liehom.exact.catalog.names import parse as parse
from liehom.exact.catalog.pairs import (
    SpiralFamily as SpiralFamily,
    full_pairs as full_pairs,
    pair as pair,
    pair_names as pair_names,
)
