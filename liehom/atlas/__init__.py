"""Sweeps over families of pairs: every entry is decided, with a certificate, none declared.

In reading order: `entry` (one pair of a table, and the table), `sweep` (many pairs on any executor, kept on disk).
"""

from liehom.atlas.entry import Atlas as Atlas
from liehom.atlas.entry import Entry as Entry
from liehom.atlas.sweep import sweep as sweep
