"""The atlas: tables of pairs that are decided one by one, each with a certificate.

In reading order: `recipe` (one pair of a family, constructed by the worker), `entry` (one decided pair, and the list
of them), `facts` (more about a decided pair), `table` (entries as rows, in files), `sweep` (decisions on any executor,
stored on disk), `families` (generators of recipes), `build` (all families).
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
