"""Methods of integration, from their coefficients up.

In reading order: `rooted_trees` and `order_conditions`, `tableau` (a Runge-Kutta method that proves its order),
`collocation` (methods made from their nodes), `tableaux` (the classical ones by name); `steps`, `rkmk`, `products`
(steps of Lie group methods); `integration`; `ensemble` (in chunks, on any executor); `reference`, `orbit_error`,
`convergence` (measured orders).
"""

from liehom.integrators.collocation import collocation as collocation
from liehom.integrators.collocation import gauss as gauss
from liehom.integrators.conservation_account import ConservationReport as ConservationReport
from liehom.integrators.convergence import observed_order as observed_order
from liehom.integrators.convergence_table import ConvergenceTable as ConvergenceTable
from liehom.integrators.dense import DenseSolution as DenseSolution
from liehom.integrators.ensemble import EnsemblePart as EnsemblePart
from liehom.integrators.ensemble import ensemble_parts as ensemble_parts
from liehom.integrators.ensemble import integrate_ensemble as integrate_ensemble
from liehom.integrators.ensemble import stored_parts as stored_parts
from liehom.integrators.integration import integrate as integrate
from liehom.integrators.named import step_named as step_named
from liehom.integrators.named import step_names as step_names
from liehom.integrators.orbit_error import orbit_distance as orbit_distance
from liehom.integrators.order_conditions import Violation as Violation
from liehom.integrators.products import CommutatorFree4 as CommutatorFree4
from liehom.integrators.products import CrouchGrossman3 as CrouchGrossman3
from liehom.integrators.products import ProductStep as ProductStep
from liehom.integrators.products import Scheme as Scheme
from liehom.integrators.reference import Reference as Reference
from liehom.integrators.rkmk import RKMK as RKMK
from liehom.integrators.rkmk import EmbeddedStep as EmbeddedStep
from liehom.integrators.rooted_trees import RootedTree as RootedTree
from liehom.integrators.rooted_trees import elementary_weight as elementary_weight
from liehom.integrators.rooted_trees import rooted_trees as rooted_trees
from liehom.integrators.solution import Report as Report
from liehom.integrators.solution import Solution as Solution
from liehom.integrators.steps import BackwardEuler as BackwardEuler
from liehom.integrators.steps import Euler as Euler
from liehom.integrators.steps import Heun as Heun
from liehom.integrators.steps import LieTaylor as LieTaylor
from liehom.integrators.tableau import Tableau as Tableau
from liehom.integrators.tableaux import tableau as tableau
from liehom.integrators.tableaux import tableau_names as tableau_names
