"""Measured orders, errors and costs: `observed_order`, `work_precision`, the reference solution.

See docs/api/integration/accuracy.md.
"""

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
