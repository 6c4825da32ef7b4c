"""The atlas: tables of pairs that are decided one by one, each with a certificate.

`recipe` and `families` describe pairs, which workers construct. `entry`, `facts` and `table` hold what is known of a
decided pair. `sweep` decides pairs on any executor and stores the entries. `build` does so for all families.
"""

from liehom.atlas.build import FAMILIES as FAMILIES
from liehom.atlas.build import build as build
from liehom.atlas.build import recipes as recipes
from liehom.atlas.entry import Atlas as Atlas
from liehom.atlas.entry import Entry as Entry
from liehom.atlas.facts import facts as facts
from liehom.atlas.recipe import Recipe as Recipe
from liehom.atlas.sweep import iter_sweep as iter_sweep
from liehom.atlas.sweep import sweep as sweep
from liehom.atlas.table import read_entries as read_entries
from liehom.atlas.table import table as table
from liehom.atlas.table import write_entries as write_entries
from liehom.atlas.table import write_table as write_table
