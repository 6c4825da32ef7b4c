"""Homogeneous spaces as numbers: actions with an exponential, generator fields, frames of isotropy.

See docs/api/action.md.
"""

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
