"""Families of pairs as generators of recipes, one module for each family.

Each generator yields `Recipe` objects; the functions that they name construct one pair from a few numbers and strings.
`build` and users may import from here. The families and their sources are described in docs/atlas.md, the verdicts in
docs/theory/fullness.md.
"""

from liehom.atlas.families.affine import affine_pairs as affine_pairs
from liehom.atlas.families.isotropy_irreducible import isotropy_irreducible_pairs as isotropy_irreducible_pairs
from liehom.atlas.families.symmetric import group_pairs as group_pairs
from liehom.atlas.families.symmetric import symmetric_pairs as symmetric_pairs
from liehom.atlas.families.symmetric import symmetric_rank as symmetric_rank
