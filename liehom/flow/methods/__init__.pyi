from liehom.flow.methods.composition import Composition as Composition, Splitting as Splitting
from liehom.flow.methods.low_order import (
    BackwardEuler as BackwardEuler,
    CommutatorFree4 as CommutatorFree4,
    CrouchGrossman3 as CrouchGrossman3,
    Euler as Euler,
    Heun as Heun,
    LieTaylor as LieTaylor,
    ProductStep as ProductStep,
    Scheme as Scheme,
)
from liehom.flow.methods.midpoint import (
    IsospectralMidpoint as IsospectralMidpoint,
    MoserVeselov as MoserVeselov,
    SphericalMidpoint as SphericalMidpoint,
    VariationalMidpoint as VariationalMidpoint,
)
from liehom.flow.methods.named import step_named as step_named, step_names as step_names
from liehom.flow.methods.rkmk import RKMK as RKMK
from liehom.flow.methods.runge_kutta import (
    Tableau as Tableau,
    Violation as Violation,
)
from liehom.flow.methods.stability import amplification as amplification, stability_limit as stability_limit
from liehom.flow.methods.stiff import (
    ExponentialRosenbrock as ExponentialRosenbrock,
    Rosenbrock as Rosenbrock,
    StiffRKMK as StiffRKMK,
)
from liehom.flow.methods.tableaux import (
    collocation as collocation,
    tableau as tableau,
    tableau_names as tableau_names,
)
from liehom.flow.methods.taylor import Taylor as Taylor
