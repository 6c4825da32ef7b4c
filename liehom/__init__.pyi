from liehom import io as io, plotting as plotting, testing as testing
from liehom.base import (
    budget as budget,
    errors as errors,
    pytrees as pytrees,
    store as store,
    tasks as tasks,
    typing as typing,
)
from liehom.base.budget import limits as limits
from liehom.base.errors import (
    CatalogError as CatalogError,
    CertificateError as CertificateError,
    ConvergenceError as ConvergenceError,
    DamageWarning as DamageWarning,
    FieldError as FieldError,
    FormatError as FormatError,
    InputError as InputError,
    JacobiError as JacobiError,
    LiehomError as LiehomError,
    LimitError as LimitError,
    NotASubalgebraError as NotASubalgebraError,
    NotFullError as NotFullError,
    NotInSpanError as NotInSpanError,
    OrderWarning as OrderWarning,
    ParseError as ParseError,
    RepresentationError as RepresentationError,
    ShapeError as ShapeError,
    SingularError as SingularError,
    StiffnessWarning as StiffnessWarning,
    StructureError as StructureError,
    TraceError as TraceError,
    UndecidedError as UndecidedError,
)
from liehom.base.pytrees import PerTrajectory as PerTrajectory
from liehom.exact import (
    algebra as algebra,
    catalog as catalog,
    fullness as fullness,
    geometry as geometry,
    orbits as orbits,
    pauli as pauli,
    representations as representations,
    scalars as scalars,
)
from liehom.exact.algebra.constructions.classical import (
    gl as gl,
    simple as simple,
    sl as sl,
    so as so,
    sp as sp,
    su as su,
    u as u,
)
from liehom.exact.algebra.constructions.families import (
    abelian as abelian,
    affine_of as affine_of,
    bianchi as bianchi,
    euclidean as euclidean,
    galilei as galilei,
    heisenberg as heisenberg,
    poincare as poincare,
)
from liehom.exact.algebra.constructions.low_dimensional import low_dimensional as low_dimensional
from liehom.exact.algebra.constructions.sums import direct_sum as direct_sum, semidirect_sum as semidirect_sum
from liehom.exact.algebra.core.lie_algebra import LieAlgebra as LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra as Subalgebra
from liehom.exact.algebra.roots.chevalley import chevalley as chevalley
from liehom.exact.algebra.roots.real_form import (
    RealForm as RealForm,
    canonical_real_form as canonical_real_form,
    real_forms as real_forms,
)
from liehom.exact.algebra.roots.root_system import root_system as root_system
from liehom.exact.catalog.pairs import full_pairs as full_pairs, pair as pair
from liehom.exact.fullness.certificate import Certificate as Certificate
from liehom.exact.fullness.checker.verify import verify_certificate as verify_certificate
from liehom.exact.fullness.control_systems import controllability as controllability
from liehom.exact.fullness.decide import classify as classify, decide_fullness as decide_fullness
from liehom.exact.fullness.range_classification import classify_range as classify_range
from liehom.exact.fullness.verdict import failure_report as failure_report
from liehom.exact.orbits.range import range_condition as range_condition
from liehom.exact.orbits.strata import (
    adjoint_strata as adjoint_strata,
    rectangular_strata as rectangular_strata,
    symmetric_strata as symmetric_strata,
)
from liehom.exact.orbits.types import orbit_types as orbit_types, structure_name as structure_name
from liehom.exact.representations.analysis.embeddings import (
    branching_rule as branching_rule,
    maximal_subalgebras as maximal_subalgebras,
)
from liehom.exact.representations.constructions import (
    adjoint as adjoint,
    coadjoint as coadjoint,
    defining as defining,
    pair_from_matrices as pair_from_matrices,
    sym_conjugation as sym_conjugation,
)
from liehom.exact.representations.core.pair import Pair as Pair
from liehom.exact.representations.core.representation import Representation as Representation
from liehom.exact.representations.highest_weight.characters import (
    tensor_product_decomposition as tensor_product_decomposition,
    weyl_dimension as weyl_dimension,
)
from liehom.exact.representations.highest_weight.highest_weight import highest_weight_module as highest_weight_module
from liehom.exact.representations.highest_weight.real_modules import (
    real_module as real_module,
    spin_representation as spin_representation,
    spinor_type as spinor_type,
)
from liehom.exact.representations.rationalization import rationalize as rationalize
from liehom.exact.scalars.floating import RR as RR, FloatField as FloatField
from liehom.exact.scalars.number_fields import number_field as number_field
from liehom.exact.scalars.rational import QQ as QQ
from liehom.flow import (
    action as action,
    bodies as bodies,
    convergence as convergence,
    engines as engines,
    geodesics as geodesics,
    methods as methods,
    propagation as propagation,
    run as run,
    series as series,
    spins as spins,
    steps as steps,
    tracing as tracing,
)
from liehom.flow.action.field import GeneratorField as GeneratorField, hamiltonian_field as hamiltonian_field
from liehom.flow.action.motions import SE3 as SE3, SO3 as SO3
from liehom.flow.action.space import Action as Action
from liehom.flow.convergence.costs import work_precision as work_precision
from liehom.flow.convergence.orders import observed_order as observed_order
from liehom.flow.fractional import LinearFractional as LinearFractional
from liehom.flow.geodesics import geodesic as geodesic
from liehom.flow.methods.low_order import (
    BackwardEuler as BackwardEuler,
    Euler as Euler,
    Heun as Heun,
    LieTaylor as LieTaylor,
)
from liehom.flow.methods.midpoint import SphericalMidpoint as SphericalMidpoint
from liehom.flow.methods.rkmk import RKMK as RKMK
from liehom.flow.methods.tableaux import tableau as tableau
from liehom.flow.methods.taylor import Taylor as Taylor
from liehom.flow.propagation.ensemble import integrate_ensemble as integrate_ensemble
from liehom.flow.propagation.integration import integrate as integrate
from liehom.flow.propagation.propagator import Propagator as Propagator
from liehom.flow.run.solution import Solution as Solution
from liehom.flow.series.jet import Jet as Jet
from liehom.flow.spins import LandauLifshitz as LandauLifshitz
from liehom.flow.steps.conserving import Conserving as Conserving
from liehom.flow.steps.corrected import Corrected as Corrected
from liehom.flow.steps.formulas import closed_form as closed_form
from liehom.flow.steps.step import Step as Step
from liehom.io.files import dump as dump, from_json as from_json, load as load, loads as loads, to_json as to_json
from liehom.io.page import pair_page as pair_page
from liehom.io.renderings import latex as latex
from liehom.studies import atlas as atlas, instances as instances, paper as paper
from liehom.studies.rigid_body import RigidBody as RigidBody

__version__: str
