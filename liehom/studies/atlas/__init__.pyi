from liehom.studies.atlas.affine import affine_pairs as affine_pairs
from liehom.studies.atlas.all_families import FAMILIES as FAMILIES, build as build, recipes as recipes
from liehom.studies.atlas.entry import Atlas as Atlas, Entry as Entry, Recipe as Recipe, facts as facts
from liehom.studies.atlas.irreducible import isotropy_irreducible_pairs as isotropy_irreducible_pairs
from liehom.studies.atlas.sweeps import (
    iter_sweep as iter_sweep,
    read_entries as read_entries,
    sweep as sweep,
    table as table,
    write_entries as write_entries,
    write_table as write_table,
)
from liehom.studies.atlas.symmetric import (
    group_pairs as group_pairs,
    symmetric_pairs as symmetric_pairs,
    symmetric_rank as symmetric_rank,
)
