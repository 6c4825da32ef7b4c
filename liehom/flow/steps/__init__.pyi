from liehom.flow.steps.conserving import (
    ConservedOrder as ConservedOrder,
    Conserving as Conserving,
    conserved_order as conserved_order,
)
from liehom.flow.steps.corrected import (
    Corrected as Corrected,
    Correction as Correction,
    correction as correction,
)
from liehom.flow.steps.curvature import (
    Submanifold as Submanifold,
    curvature_defect as curvature_defect,
    geodesic_curvature as geodesic_curvature,
    moving_frame_field as moving_frame_field,
)
from liehom.flow.steps.expansion import (
    Flow as Flow,
    flow_series as flow_series,
    step_series as step_series,
)
from liehom.flow.steps.first_integral import (
    Conservation as Conservation,
    FirstIntegral as FirstIntegral,
    MomentumMap as MomentumMap,
    conservation_map as conservation_map,
    cotangent_momentum as cotangent_momentum,
)
from liehom.flow.steps.formulas import ClosedForm as ClosedForm, closed_form as closed_form
from liehom.flow.steps.implicit import solve_implicitly as solve_implicitly
from liehom.flow.steps.order_conditions import (
    OrderCondition as OrderCondition,
    chi as chi,
    order_condition as order_condition,
)
from liehom.flow.steps.range_solver import RangeSolver as RangeSolver
from liehom.flow.steps.step import (
    Generator as Generator,
    LocalStep as LocalStep,
    OneExponential as OneExponential,
    Step as Step,
    apply_factors as apply_factors,
)
