"""Methods of integration: coefficients, steps, runs, compiled runs, ensembles and measured orders.

In reading order, `tableaux` has Runge-Kutta coefficients that prove their order, `methods` the steps of Lie group
methods, `run` the loop over steps, `engine` says what an engine is, and `compiled` has those that compile. `propagator`
has `Propagator`, `integration` has `integrate`, `ensembles` cuts ensembles into chunks for any executor, and
`convergence` measures orders and costs. See docs/tutorials/integrating.md.
"""

from liehom.correctors import Conserving as Conserving
from liehom.correctors import Corrected as Corrected
from liehom.integrators.convergence import ConvergenceTable as ConvergenceTable
from liehom.integrators.convergence import Reference as Reference
from liehom.integrators.convergence import WorkPrecisionRow as WorkPrecisionRow
from liehom.integrators.convergence import WorkPrecisionTable as WorkPrecisionTable
from liehom.integrators.convergence import observed_order as observed_order
from liehom.integrators.convergence import orbit_distance as orbit_distance
from liehom.integrators.convergence import work_precision as work_precision
from liehom.integrators.engine import Engine as Engine
from liehom.integrators.engine import Problem as Problem
from liehom.integrators.ensembles import EnsemblePart as EnsemblePart
from liehom.integrators.ensembles import ensemble_parts as ensemble_parts
from liehom.integrators.ensembles import integrate_ensemble as integrate_ensemble
from liehom.integrators.ensembles import stored_parts as stored_parts
from liehom.integrators.implicit import ExponentialRosenbrock as ExponentialRosenbrock
from liehom.integrators.implicit import Rosenbrock as Rosenbrock
from liehom.integrators.implicit import StiffRKMK as StiffRKMK
from liehom.integrators.implicit import amplification as amplification
from liehom.integrators.implicit import stability_limit as stability_limit
from liehom.integrators.inspection import Inspection as Inspection
from liehom.integrators.integration import integrate as integrate
from liehom.integrators.methods import RKMK as RKMK
from liehom.integrators.methods import BackwardEuler as BackwardEuler
from liehom.integrators.methods import CommutatorFree4 as CommutatorFree4
from liehom.integrators.methods import CrouchGrossman3 as CrouchGrossman3
from liehom.integrators.methods import EmbeddedStep as EmbeddedStep
from liehom.integrators.methods import Euler as Euler
from liehom.integrators.methods import Heun as Heun
from liehom.integrators.methods import LieTaylor as LieTaylor
from liehom.integrators.methods import ProductStep as ProductStep
from liehom.integrators.methods import Scheme as Scheme
from liehom.integrators.methods import Taylor as Taylor
from liehom.integrators.named import step_named as step_named
from liehom.integrators.named import step_names as step_names
from liehom.integrators.propagator import Propagator as Propagator
from liehom.integrators.run import ConservationReport as ConservationReport
from liehom.integrators.run import DenseSolution as DenseSolution
from liehom.integrators.run import Report as Report
from liehom.integrators.run import Solution as Solution
from liehom.integrators.sensitivity import Gradient as Gradient
from liehom.integrators.sensitivity import Sensitivity as Sensitivity
from liehom.integrators.symplectic import Composition as Composition
from liehom.integrators.symplectic import IsospectralMidpoint as IsospectralMidpoint
from liehom.integrators.symplectic import MoserVeselov as MoserVeselov
from liehom.integrators.symplectic import SphericalMidpoint as SphericalMidpoint
from liehom.integrators.symplectic import Splitting as Splitting
from liehom.integrators.symplectic import VariationalMidpoint as VariationalMidpoint
from liehom.integrators.tableaux import RootedTree as RootedTree
from liehom.integrators.tableaux import Tableau as Tableau
from liehom.integrators.tableaux import Violation as Violation
from liehom.integrators.tableaux import collocation as collocation
from liehom.integrators.tableaux import elementary_weight as elementary_weight
from liehom.integrators.tableaux import gauss as gauss
from liehom.integrators.tableaux import radau as radau
from liehom.integrators.tableaux import rooted_trees as rooted_trees
from liehom.integrators.tableaux import tableau as tableau
from liehom.integrators.tableaux import tableau_names as tableau_names
