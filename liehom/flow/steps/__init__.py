"""A step as a function of its size, its Taylor series, and what isotropy makes of it: correctors.

Theorem 5 of the paper is in `corrected` and `range_solver`, section 7 in `first_integral` and `conserving`, formulas in
`closed_form`. See docs/theory/correctors.md.
"""

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
