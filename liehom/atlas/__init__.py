"""The atlas: tables of pairs that are decided one by one, each with a certificate.

`recipe` and `families` describe pairs, which workers construct. `entry`, `pair_facts` and `table_rows` hold what is
known of a decided pair. `sweep` decides pairs on any executor and stores the entries. `all_families` has `build`, which
does so for the whole atlas.
"""

from liehom.atlas.all_families import FAMILIES as FAMILIES
from liehom.atlas.all_families import build as build
from liehom.atlas.all_families import recipes as recipes
from liehom.atlas.entry import Atlas as Atlas
from liehom.atlas.entry import Entry as Entry
from liehom.atlas.pair_facts import facts as facts
from liehom.atlas.recipe import Recipe as Recipe
from liehom.atlas.sweep import iter_sweep as iter_sweep
from liehom.atlas.sweep import sweep as sweep
from liehom.atlas.table_rows import read_entries as read_entries
from liehom.atlas.table_rows import table as table
from liehom.atlas.table_rows import write_entries as write_entries
from liehom.atlas.table_rows import write_table as write_table
