"""Isotropy correctors: steps raised to any order, or made to conserve first integrals, by isotropy.

`step` is the interface of one-step methods and `expansion` their Taylor series.  The wings are `isotropy` (Theorem 5
iterated to any order, in floats), `conserving` (section 7) and `symbolic` (formulas and exact decisions).  See
docs/theory/correctors.md.
"""

from liehom.correctors.conserving import Conservation as Conservation
from liehom.correctors.conserving import Conserved as Conserved
from liehom.correctors.conserving import ConservedOrder as ConservedOrder
from liehom.correctors.conserving import Conserving as Conserving
from liehom.correctors.conserving import ConservingStep as ConservingStep
from liehom.correctors.conserving import FirstIntegral as FirstIntegral
from liehom.correctors.conserving import MomentumMap as MomentumMap
from liehom.correctors.conserving import conservation_map as conservation_map
from liehom.correctors.conserving import conserved_order as conserved_order
from liehom.correctors.conserving import cotangent_momentum as cotangent_momentum
from liehom.correctors.curvature import Submanifold as Submanifold
from liehom.correctors.curvature import curvature_defect as curvature_defect
from liehom.correctors.curvature import geodesic_curvature as geodesic_curvature
from liehom.correctors.expansion import Clock as Clock
from liehom.correctors.expansion import Flow as Flow
from liehom.correctors.expansion import flow_series as flow_series
from liehom.correctors.expansion import leading_order as leading_order
from liehom.correctors.expansion import step_series as step_series
from liehom.correctors.implicit import solve_implicitly as solve_implicitly
from liehom.correctors.isotropy import Corrected as Corrected
from liehom.correctors.isotropy import CorrectedStep as CorrectedStep
from liehom.correctors.isotropy import Correction as Correction
from liehom.correctors.isotropy import RangeSolver as RangeSolver
from liehom.correctors.isotropy import correction as correction
from liehom.correctors.moving_frame import moving_frame_field as moving_frame_field
from liehom.correctors.step import Generator as Generator
from liehom.correctors.step import LocalStep as LocalStep
from liehom.correctors.step import OneExponential as OneExponential
from liehom.correctors.step import Step as Step
from liehom.correctors.step import apply_factors as apply_factors
from liehom.correctors.step import step_variable as step_variable
from liehom.correctors.symbolic import ClosedForm as ClosedForm
from liehom.correctors.symbolic import OrderCondition as OrderCondition
from liehom.correctors.symbolic import chi as chi
from liehom.correctors.symbolic import closed_form as closed_form
from liehom.correctors.symbolic import order_condition as order_condition
