"""The loop over steps: sizes, events, records, and the `Solution`.

`Run` has the transitions that every trajectory makes; see docs/tutorials/integrating.md.
"""

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
