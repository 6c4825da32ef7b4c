from liehom.exact.algebra.constructions.classical import (
    gl as gl,
    parabolic_subalgebra as parabolic_subalgebra,
    simple as simple,
    sl as sl,
    so as so,
    so_form as so_form,
    so_star as so_star,
    sp as sp,
    sp_form as sp_form,
    su as su,
    u as u,
)
from liehom.exact.algebra.constructions.families import (
    abelian as abelian,
    affine as affine,
    affine_of as affine_of,
    almost_abelian as almost_abelian,
    bargmann as bargmann,
    bianchi as bianchi,
    conformal as conformal,
    euclidean as euclidean,
    filiform as filiform,
    free_nilpotent as free_nilpotent,
    galilei as galilei,
    heisenberg as heisenberg,
    oscillator as oscillator,
    poincare as poincare,
    schroedinger as schroedinger,
    strictly_upper_triangular as strictly_upper_triangular,
    upper_triangular as upper_triangular,
)
from liehom.exact.algebra.constructions.family import Generic as Generic, LieAlgebraFamily as LieAlgebraFamily
from liehom.exact.algebra.constructions.low_dimensional import low_dimensional as low_dimensional
from liehom.exact.algebra.constructions.sums import (
    ComplexLieAlgebra as ComplexLieAlgebra,
    central_extension as central_extension,
    direct_sum as direct_sum,
    realification as realification,
    semidirect_sum as semidirect_sum,
)
from liehom.exact.algebra.core.homomorphism import Homomorphism as Homomorphism
from liehom.exact.algebra.core.lie_algebra import LieAlgebra as LieAlgebra
from liehom.exact.algebra.core.structure_constants import StructureConstants as StructureConstants
from liehom.exact.algebra.core.subalgebra import Subalgebra as Subalgebra
from liehom.exact.algebra.involutions.cartan_decomposition import CartanDecomposition as CartanDecomposition
from liehom.exact.algebra.linear.closure import Closure as Closure, lie_closure as lie_closure
from liehom.exact.algebra.linear.named_matrices import (
    dirac_matrices as dirac_matrices,
    gell_mann_matrices as gell_mann_matrices,
    pauli_matrices as pauli_matrices,
    spin_matrices as spin_matrices,
)
from liehom.exact.algebra.roots.chevalley import (
    chevalley as chevalley,
    compact_form as compact_form,
    real_form_of as real_form_of,
)
from liehom.exact.algebra.roots.diagrams import SatakeDiagram as SatakeDiagram, VoganDiagram as VoganDiagram
from liehom.exact.algebra.roots.real_form import (
    RealForm as RealForm,
    canonical_real_form as canonical_real_form,
    complex_form as complex_form,
    real_forms as real_forms,
    real_forms_with as real_forms_with,
    simple_real_forms as simple_real_forms,
)
from liehom.exact.algebra.roots.root_system import (
    RootSystem as RootSystem,
    cartan_matrix as cartan_matrix,
    dynkin_diagram as dynkin_diagram,
    root_system as root_system,
)
from liehom.exact.algebra.structure.casimirs import Casimirs as Casimirs
from liehom.exact.algebra.structure.cohomology import Cohomology as Cohomology
from liehom.exact.algebra.structure.derivations import Derivations as Derivations
from liehom.exact.algebra.structure.ideals import Place as Place
from liehom.exact.algebra.structure.levi import LeviDecomposition as LeviDecomposition
from liehom.exact.algebra.structure.naming import Identification as Identification
from liehom.exact.algebra.structure.nilpotent import (
    NilpotentOrbit as NilpotentOrbit,
    nilpotent_orbits as nilpotent_orbits,
)
from liehom.exact.algebra.structure.root_spaces import (
    RootSpace as RootSpace,
    RootSpaceDecomposition as RootSpaceDecomposition,
)
