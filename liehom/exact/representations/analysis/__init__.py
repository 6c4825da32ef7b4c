"""Decomposition over the reals, equivalence, submodules, Hermitian forms, weights, isotropy at symbolic points.

Answers are exact and in any basis; see docs/theory/representations.md.
"""

from liehom.base.lazy import lazy_modules

__getattr__ = lazy_modules(__name__)
