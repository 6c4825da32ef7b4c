"""Equations x = F(x) of implicit steps: fixed point iteration, Newton's method, Krylov spaces, compiled loops.

`solve_implicitly` is the entry point; steps call it, and nothing else of this wing. See docs/stiff.md.
"""

from liehom.correctors.implicit.equation import SparseRow as SparseRow
from liehom.correctors.implicit.equation import Stage as Stage
from liehom.correctors.implicit.equation import combined as combined
from liehom.correctors.implicit.solve import reach_of as reach_of
from liehom.correctors.implicit.solve import solve_implicitly as solve_implicitly
