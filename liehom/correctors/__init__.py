"""Isotropy correctors: Theorem 5 at a point, iterated to any order, and what it needs of a step."""

from liehom.correctors.corrected import Corrected as Corrected
from liehom.correctors.corrected import CorrectedStep as CorrectedStep
from liehom.correctors.expansion import Clock as Clock
from liehom.correctors.expansion import Flow as Flow
from liehom.correctors.expansion import flow_series as flow_series
from liehom.correctors.expansion import leading_order as leading_order
from liehom.correctors.expansion import step_series as step_series
from liehom.correctors.order import Correction as Correction
from liehom.correctors.order import correction as correction
from liehom.correctors.order_condition import OrderCondition as OrderCondition
from liehom.correctors.order_condition import chi as chi
from liehom.correctors.order_condition import order_condition as order_condition
from liehom.correctors.range_solver import RangeSolver as RangeSolver
from liehom.correctors.step import Generator as Generator
from liehom.correctors.step import LocalStep as LocalStep
from liehom.correctors.step import OneExponential as OneExponential
from liehom.correctors.step import Step as Step
from liehom.correctors.step import apply_factors as apply_factors
from liehom.correctors.step import solve_implicitly as solve_implicitly
from liehom.correctors.step import step_variable as step_variable
