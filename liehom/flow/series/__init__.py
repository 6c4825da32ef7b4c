"""Truncated Taylor series: `Jet`, on which numpy code runs, and series in Lie algebras.

A node computes the coefficients of a series on demand; see docs/theory/taylor.md.
"""

import liehom.flow.series.jet_functions  # noqa: F401 (enters itself in the table of functions that `Jet` calls)
from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
