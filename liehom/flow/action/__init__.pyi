from liehom.flow.action.custom_exponential import (
    exponential_of as exponential_of,
)
from liehom.flow.action.exponential import (
    Cayley as Cayley,
    Exponential as Exponential,
    TrueExponential as TrueExponential,
)
from liehom.flow.action.field import (
    GeneratorField as GeneratorField,
    hamiltonian_field as hamiltonian_field,
    lie_poisson_tensor as lie_poisson_tensor,
)
from liehom.flow.action.frames import InnerProduct as InnerProduct, inner_product as inner_product
from liehom.flow.action.motions import SE3 as SE3, SO3 as SO3
from liehom.flow.action.space import Action as Action, IsotropyFrame as IsotropyFrame
