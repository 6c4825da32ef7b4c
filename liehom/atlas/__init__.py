"""The atlas: tables of pairs that are decided one by one, each with a certificate.

In reading order: `recipe` (one pair of a family, constructed by the worker), `families` (generators of recipes),
`entry` (one decided pair, and the table), `facts` (more about a decided pair), `sweep` (decisions on any executor,
stored on disk).
"""

from liehom.atlas.entry import Atlas as Atlas
from liehom.atlas.entry import Entry as Entry
from liehom.atlas.facts import facts as facts
from liehom.atlas.recipe import Recipe as Recipe
from liehom.atlas.sweep import iter_sweep as iter_sweep
from liehom.atlas.sweep import sweep as sweep
