"""Section 7: steps that conserve first integrals by isotropy, to round-off or to one order higher.

`Conserving` is the step that users wrap around another; `conservation` holds the map chi_m, `level_newton`
Proposition 10. See docs/theory/correctors.md.
"""

from liehom.correctors.conserving.conservation import Conservation as Conservation
from liehom.correctors.conserving.conservation import conservation_map as conservation_map
from liehom.correctors.conserving.conserved_order import ConservedOrder as ConservedOrder
from liehom.correctors.conserving.conserved_order import conserved_order as conserved_order
from liehom.correctors.conserving.conserving import Conserving as Conserving
from liehom.correctors.conserving.conserving_step import Conserved as Conserved
from liehom.correctors.conserving.conserving_step import ConservingStep as ConservingStep
from liehom.correctors.conserving.first_integral import FirstIntegral as FirstIntegral
from liehom.correctors.conserving.momentum_map import MomentumMap as MomentumMap
from liehom.correctors.conserving.momentum_map import cotangent_momentum as cotangent_momentum
