"""Vector fields X(m) = rho(psi(m)) m by their generator psi, and how a user may give one.

`generator` and `expression` read functions, strings and sympy expressions; `least_norm` finds the minimal generator
of a tangent vector field. Correctors and integrators start from a `GeneratorField`; see docs/theory/correctors.md.
"""

from liehom.homogeneous.fields.components import Components as Components
from liehom.homogeneous.fields.field import GeneratorField as GeneratorField
from liehom.homogeneous.fields.hamiltonian import hamiltonian_field as hamiltonian_field
from liehom.homogeneous.fields.hamiltonian import lie_poisson_tensor as lie_poisson_tensor
