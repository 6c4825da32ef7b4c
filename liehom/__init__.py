"""liehom: Lie algebras and isotropy analysis, exact where the input is exact.

The layers, in reading order; each imports only those above it in this list:

`errors`           exceptions, with what was found, what was expected and a remedy.
`immutable`        classes whose attributes are set once.
`display`          classes that notebooks show as formulas, cards and tables.
`budget`           how large an input may be, how long a computation may take.
`disk`             files that are written whole, checksums.
`pytrees`          numbers and arrays in nested containers.
`parallel`         many tasks on any executor, and their results on disk.
`scalars`          QQ, real number fields, float64, and linear algebra over them.
`algebra`          Lie algebras by structure constants, subalgebras, homomorphisms, constructions.
`representations`  representations by matrices, pairs (g, h), isotropy of a point, intertwiners.
`pauli`            dynamical Lie algebras of Pauli words.
`tracing`          a computation recorded as a graph, and machine code of it.
`series`           truncated Taylor series on which numpy code runs, series in Lie algebras.
`homogeneous`      actions with an exponential, generator fields, the range condition, orbit types.
`correctors`       expansions of flow and step, the order-n isotropy corrector and its time reparametrization.
`integrators`      steps, tableaux, `integrate`, measured orders.
`instances`        the paper's systems: spheres, the rigid body, isospectral flows, Landau-Lifshitz spins.
`fullness`         full pairs: the decision, its certificates and the independent checker.
`catalog`          names that parse: "so(4)/so(3)", "g2/su(3)", "sl(3)/P1".
`atlas`            sweeps over families of pairs, every entry decided.
`io`               JSON files in and out.
`paper`            the figures of the paper, reproduced.
`plotting`         plots of trajectories and of measured orders.
`pages`            a page for the browser about a pair.
`testing`          a public conformance suite.
`cli`              the command line.
"""

from __future__ import annotations

import importlib
import logging
import sys
from typing import TYPE_CHECKING, Any

from liehom import errors as errors
from liehom.compatibility import OldModules

if TYPE_CHECKING:
    from liehom import algebra as algebra
    from liehom import atlas as atlas
    from liehom import catalog as catalog
    from liehom import correctors as correctors
    from liehom import fullness as fullness
    from liehom import homogeneous as homogeneous
    from liehom import instances as instances
    from liehom import integrators as integrators
    from liehom import io as io
    from liehom import pages as pages
    from liehom import paper as paper
    from liehom import parallel as parallel
    from liehom import pauli as pauli
    from liehom import plotting as plotting
    from liehom import representations as representations
    from liehom import scalars as scalars
    from liehom import series as series
    from liehom import testing as testing
    from liehom.algebra import Homomorphism as Homomorphism
    from liehom.algebra import LieAlgebra as LieAlgebra
    from liehom.algebra import LieAlgebraFamily as LieAlgebraFamily
    from liehom.algebra import RealForm as RealForm
    from liehom.algebra import RootSystem as RootSystem
    from liehom.algebra import Subalgebra as Subalgebra
    from liehom.algebra import abelian as abelian
    from liehom.algebra import affine as affine
    from liehom.algebra import affine_of as affine_of
    from liehom.algebra import almost_abelian as almost_abelian
    from liehom.algebra import bargmann as bargmann
    from liehom.algebra import bianchi as bianchi
    from liehom.algebra import canonical_real_form as canonical_real_form
    from liehom.algebra import cartan_matrix as cartan_matrix
    from liehom.algebra import central_extension as central_extension
    from liehom.algebra import chevalley as chevalley
    from liehom.algebra import conformal as conformal
    from liehom.algebra import dirac_matrices as dirac_matrices
    from liehom.algebra import direct_sum as direct_sum
    from liehom.algebra import dynkin_diagram as dynkin_diagram
    from liehom.algebra import euclidean as euclidean
    from liehom.algebra import filiform as filiform
    from liehom.algebra import free_nilpotent as free_nilpotent
    from liehom.algebra import galilei as galilei
    from liehom.algebra import gell_mann_matrices as gell_mann_matrices
    from liehom.algebra import gl as gl
    from liehom.algebra import heisenberg as heisenberg
    from liehom.algebra import low_dimensional as low_dimensional
    from liehom.algebra import oscillator as oscillator
    from liehom.algebra import parabolic_subalgebra as parabolic_subalgebra
    from liehom.algebra import pauli_matrices as pauli_matrices
    from liehom.algebra import poincare as poincare
    from liehom.algebra import real_forms as real_forms
    from liehom.algebra import realification as realification
    from liehom.algebra import root_system as root_system
    from liehom.algebra import schroedinger as schroedinger
    from liehom.algebra import semidirect_sum as semidirect_sum
    from liehom.algebra import simple as simple
    from liehom.algebra import sl as sl
    from liehom.algebra import so as so
    from liehom.algebra import so_form as so_form
    from liehom.algebra import so_star as so_star
    from liehom.algebra import sp as sp
    from liehom.algebra import sp_form as sp_form
    from liehom.algebra import spin_matrices as spin_matrices
    from liehom.algebra import strictly_upper_triangular as strictly_upper_triangular
    from liehom.algebra import su as su
    from liehom.algebra import u as u
    from liehom.algebra import upper_triangular as upper_triangular
    from liehom.budget import Limits as Limits
    from liehom.budget import current_limits as current_limits
    from liehom.budget import limits as limits
    from liehom.catalog import full_pairs as full_pairs
    from liehom.catalog import pair as pair
    from liehom.correctors import MomentumMap as MomentumMap
    from liehom.correctors import OneExponential as OneExponential
    from liehom.correctors import Step as Step
    from liehom.correctors import chi as chi
    from liehom.correctors import closed_form as closed_form
    from liehom.correctors import correction as correction
    from liehom.correctors import flow_series as flow_series
    from liehom.correctors import moving_frame_field as moving_frame_field
    from liehom.correctors import order_condition as order_condition
    from liehom.correctors import step_series as step_series
    from liehom.errors import CatalogError as CatalogError
    from liehom.errors import CertificateError as CertificateError
    from liehom.errors import ConvergenceError as ConvergenceError
    from liehom.errors import DamageWarning as DamageWarning
    from liehom.errors import FieldError as FieldError
    from liehom.errors import FormatError as FormatError
    from liehom.errors import InputError as InputError
    from liehom.errors import JacobiError as JacobiError
    from liehom.errors import LiehomError as LiehomError
    from liehom.errors import LimitError as LimitError
    from liehom.errors import NotASubalgebraError as NotASubalgebraError
    from liehom.errors import NotFullError as NotFullError
    from liehom.errors import NotInSpanError as NotInSpanError
    from liehom.errors import OrderWarning as OrderWarning
    from liehom.errors import ParseError as ParseError
    from liehom.errors import RepresentationError as RepresentationError
    from liehom.errors import ShapeError as ShapeError
    from liehom.errors import SingularError as SingularError
    from liehom.errors import StiffnessWarning as StiffnessWarning
    from liehom.errors import StructureError as StructureError
    from liehom.errors import TraceError as TraceError
    from liehom.errors import UndecidedError as UndecidedError
    from liehom.fullness import Certificate as Certificate
    from liehom.fullness import Classification as Classification
    from liehom.fullness import Full as Full
    from liehom.fullness import NotFull as NotFull
    from liehom.fullness import NumericallyFull as NumericallyFull
    from liehom.fullness import NumericallyNotFull as NumericallyNotFull
    from liehom.fullness import NumericallyUndecided as NumericallyUndecided
    from liehom.fullness import classify as classify
    from liehom.fullness import decide_fullness as decide_fullness
    from liehom.fullness import decide_numerically as decide_numerically
    from liehom.fullness import failure_report as failure_report
    from liehom.fullness import verify_certificate as verify_certificate
    from liehom.homogeneous import Action as Action
    from liehom.homogeneous import Cayley as Cayley
    from liehom.homogeneous import Exponential as Exponential
    from liehom.homogeneous import GeneratorField as GeneratorField
    from liehom.homogeneous import adjoint_strata as adjoint_strata
    from liehom.homogeneous import binary_form_strata as binary_form_strata
    from liehom.homogeneous import failure_cone as failure_cone
    from liehom.homogeneous import hamiltonian_field as hamiltonian_field
    from liehom.homogeneous import hermitian_strata as hermitian_strata
    from liehom.homogeneous import invariant_degree as invariant_degree
    from liehom.homogeneous import lie_poisson_tensor as lie_poisson_tensor
    from liehom.homogeneous import open_orbit_count as open_orbit_count
    from liehom.homogeneous import orbit_dimension as orbit_dimension
    from liehom.homogeneous import orbit_types as orbit_types
    from liehom.homogeneous import range_condition as range_condition
    from liehom.homogeneous import rectangular_strata as rectangular_strata
    from liehom.homogeneous import relative_invariant as relative_invariant
    from liehom.homogeneous import skew_strata as skew_strata
    from liehom.homogeneous import structure_name as structure_name
    from liehom.homogeneous import symmetric_strata as symmetric_strata
    from liehom.instances import AttitudeBody as AttitudeBody
    from liehom.instances import HeavyTop as HeavyTop
    from liehom.instances import LandauLifshitz as LandauLifshitz
    from liehom.instances import RigidBody as RigidBody
    from liehom.instances import SE3Body as SE3Body
    from liehom.instances import Sphere as Sphere
    from liehom.instances import SymmetricMatrices as SymmetricMatrices
    from liehom.integrators import RKMK as RKMK
    from liehom.integrators import BackwardEuler as BackwardEuler
    from liehom.integrators import CommutatorFree4 as CommutatorFree4
    from liehom.integrators import Composition as Composition
    from liehom.integrators import Conserving as Conserving
    from liehom.integrators import Corrected as Corrected
    from liehom.integrators import CrouchGrossman3 as CrouchGrossman3
    from liehom.integrators import Euler as Euler
    from liehom.integrators import ExponentialRosenbrock as ExponentialRosenbrock
    from liehom.integrators import Heun as Heun
    from liehom.integrators import IsospectralMidpoint as IsospectralMidpoint
    from liehom.integrators import LieTaylor as LieTaylor
    from liehom.integrators import MoserVeselov as MoserVeselov
    from liehom.integrators import Propagator as Propagator
    from liehom.integrators import Rosenbrock as Rosenbrock
    from liehom.integrators import Solution as Solution
    from liehom.integrators import SphericalMidpoint as SphericalMidpoint
    from liehom.integrators import Splitting as Splitting
    from liehom.integrators import StiffRKMK as StiffRKMK
    from liehom.integrators import Tableau as Tableau
    from liehom.integrators import Taylor as Taylor
    from liehom.integrators import VariationalMidpoint as VariationalMidpoint
    from liehom.integrators import integrate as integrate
    from liehom.integrators import integrate_ensemble as integrate_ensemble
    from liehom.integrators import observed_order as observed_order
    from liehom.integrators import tableau as tableau
    from liehom.integrators import work_precision as work_precision
    from liehom.io import dump as dump
    from liehom.io import from_gap as from_gap
    from liehom.io import from_json as from_json
    from liehom.io import from_sage as from_sage
    from liehom.io import latex as latex
    from liehom.io import load as load
    from liehom.io import load_pair as load_pair
    from liehom.io import load_problem as load_problem
    from liehom.io import loads as loads
    from liehom.io import to_gap as to_gap
    from liehom.io import to_json as to_json
    from liehom.io import to_sage as to_sage
    from liehom.io import to_sympy as to_sympy
    from liehom.pages import pair_page as pair_page
    from liehom.pytrees import PerTrajectory as PerTrajectory
    from liehom.representations import Decomposition as Decomposition
    from liehom.representations import HermitianForms as HermitianForms
    from liehom.representations import HighestWeightModule as HighestWeightModule
    from liehom.representations import Pair as Pair
    from liehom.representations import Rationalization as Rationalization
    from liehom.representations import RealModule as RealModule
    from liehom.representations import Representation as Representation
    from liehom.representations import adjoint as adjoint
    from liehom.representations import character as character
    from liehom.representations import coadjoint as coadjoint
    from liehom.representations import decompose_character as decompose_character
    from liehom.representations import defining as defining
    from liehom.representations import dominant_character as dominant_character
    from liehom.representations import dual_weight as dual_weight
    from liehom.representations import frobenius_schur_indicator as frobenius_schur_indicator
    from liehom.representations import hermitian_conjugation as hermitian_conjugation
    from liehom.representations import highest_weight_module as highest_weight_module
    from liehom.representations import pair_from_matrices as pair_from_matrices
    from liehom.representations import rationalize as rationalize
    from liehom.representations import real_module as real_module
    from liehom.representations import real_module_type as real_module_type
    from liehom.representations import spin_representation as spin_representation
    from liehom.representations import spinor_type as spinor_type
    from liehom.representations import sym_conjugation as sym_conjugation
    from liehom.representations import tensor_product_decomposition as tensor_product_decomposition
    from liehom.representations import trivial as trivial
    from liehom.representations import weyl_dimension as weyl_dimension
    from liehom.representations import weyl_orbit as weyl_orbit
    from liehom.scalars import QQ as QQ
    from liehom.scalars import RR as RR
    from liehom.scalars import FloatField as FloatField
    from liehom.scalars import NumberField as NumberField
    from liehom.scalars import Subspace as Subspace
    from liehom.scalars import number_field as number_field
    from liehom.series import Jet as Jet

# the library logs under its name, at level DEBUG, and prints nothing by itself
logging.getLogger("liehom").addHandler(logging.NullHandler())

__version__ = "0.1.0"

# Names are loaded on first use, so that `import liehom` costs no more than what is used of it; the lines above
# say the same to type checkers, and a test holds the two together.
_LAYERS = (
    "algebra",
    "atlas",
    "catalog",
    "correctors",
    "fullness",
    "homogeneous",
    "instances",
    "integrators",
    "io",
    "pages",
    "paper",
    "parallel",
    "pauli",
    "plotting",
    "representations",
    "scalars",
    "series",
    "testing",
)
_NAMES = {
    "liehom.algebra": (
        "Homomorphism LieAlgebra LieAlgebraFamily RealForm RootSystem Subalgebra "
        "abelian affine affine_of almost_abelian bargmann bianchi "
        "canonical_real_form cartan_matrix central_extension chevalley conformal dirac_matrices "
        "direct_sum dynkin_diagram euclidean filiform free_nilpotent galilei gell_mann_matrices gl heisenberg "
        "low_dimensional oscillator parabolic_subalgebra pauli_matrices poincare real_forms realification root_system "
        "schroedinger semidirect_sum simple sl so so_form so_star sp sp_form spin_matrices "
        "strictly_upper_triangular su u upper_triangular"
    ),
    "liehom.budget": "Limits current_limits limits",
    "liehom.catalog": "full_pairs pair",
    "liehom.correctors": (
        "MomentumMap OneExponential Step chi closed_form correction flow_series "
        "moving_frame_field order_condition step_series"
    ),
    "liehom.errors": (
        "CatalogError CertificateError ConvergenceError DamageWarning FieldError FormatError InputError JacobiError "
        "LiehomError LimitError NotASubalgebraError NotFullError NotInSpanError OrderWarning ParseError "
        "RepresentationError ShapeError SingularError StiffnessWarning StructureError TraceError UndecidedError"
    ),
    "liehom.fullness": (
        "Certificate Classification classify decide_fullness decide_numerically failure_report Full NotFull "
        "NumericallyFull NumericallyNotFull NumericallyUndecided verify_certificate"
    ),
    "liehom.homogeneous": (
        "Action Cayley Exponential GeneratorField adjoint_strata binary_form_strata failure_cone hamiltonian_field "
        "hermitian_strata invariant_degree lie_poisson_tensor open_orbit_count orbit_dimension orbit_types "
        "range_condition rectangular_strata relative_invariant skew_strata structure_name symmetric_strata"
    ),
    "liehom.integrators": (
        "BackwardEuler CommutatorFree4 Conserving Corrected CrouchGrossman3 Euler Heun LieTaylor Propagator RKMK "
        "Solution Tableau "
        "Taylor integrate integrate_ensemble observed_order tableau Composition IsospectralMidpoint "
        "MoserVeselov SphericalMidpoint Splitting VariationalMidpoint ExponentialRosenbrock Rosenbrock StiffRKMK "
        "work_precision"
    ),
    "liehom.instances": "AttitudeBody HeavyTop LandauLifshitz RigidBody SE3Body Sphere SymmetricMatrices",
    "liehom.io": (
        "dump from_gap from_json from_sage latex load load_pair load_problem loads to_gap to_json to_sage to_sympy"
    ),
    "liehom.pages": "pair_page",
    "liehom.representations": (
        "adjoint character coadjoint decompose_character Decomposition defining dominant_character "
        "dual_weight frobenius_schur_indicator hermitian_conjugation HermitianForms highest_weight_module "
        "HighestWeightModule Pair pair_from_matrices Rationalization rationalize real_module real_module_type "
        "RealModule Representation spin_representation spinor_type sym_conjugation tensor_product_decomposition "
        "trivial weyl_dimension weyl_orbit"
    ),
    "liehom.pytrees": "PerTrajectory",
    "liehom.series": "Jet",
    "liehom.scalars": "QQ RR FloatField NumberField Subspace number_field",
}
_HOME = {name: module for module, names in _NAMES.items() for name in names.split()}


sys.meta_path.append(OldModules())  # asked last: where the modules of 0.1.0 are now, for its pickles


def __getattr__(name: str) -> Any:
    if name in _HOME:
        value = getattr(importlib.import_module(_HOME[name]), name)
    elif name in _LAYERS:
        value = importlib.import_module(f"liehom.{name}")
    else:
        raise AttributeError(f"module 'liehom' has no attribute {name!r}{_hint(name)}")
    globals()[name] = value
    return value


def _hint(name: str) -> str:
    """Where a name that is not here may be; nothing for the names with which tools look for protocols."""
    from difflib import get_close_matches

    if name.startswith("_"):
        return ""
    if name.startswith(("plot_", "animate_")):
        return f"; pictures are in liehom.plotting: liehom.plotting.{name}"
    near = get_close_matches(name, [*_HOME, *_LAYERS], n=1, cutoff=0.75)
    return f"; did you mean {near[0]!r}?" if near else ""


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOME, *_LAYERS})
