"""Theorem 5: steps raised to any order by isotropy, and the linear systems behind it.

`Corrected` is the step that users wrap around another; `isotropy_corrector` and `order_by_order` compute the
correction at a point, `range_solver` solves for it. See docs/theory/correctors.md.
"""

from liehom.correctors.isotropy.corrected import Corrected as Corrected
from liehom.correctors.isotropy.corrected import CorrectedStep as CorrectedStep
from liehom.correctors.isotropy.isotropy_corrector import Correction as Correction
from liehom.correctors.isotropy.isotropy_corrector import correction as correction
from liehom.correctors.isotropy.range_solver import RangeSolver as RangeSolver
