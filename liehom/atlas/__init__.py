"""Sweeps: tables of pairs that are decided one by one, each with a certificate.

In reading order: `entry` (one pair of a table, and the table), `sweep` (decisions on any executor, stored on disk).
"""

from liehom.atlas.entry import Atlas as Atlas
from liehom.atlas.entry import Entry as Entry
from liehom.atlas.sweep import sweep as sweep
