from liehom.flow.action.custom_exponential import (
    CustomExponential as CustomExponential,
    exponential_of as exponential_of,
)
from liehom.flow.action.exponential import (
    Cayley as Cayley,
    Exponential as Exponential,
    MatrixExponential as MatrixExponential,
    Rodrigues as Rodrigues,
    SeriesExponential as SeriesExponential,
    TrueExponential as TrueExponential,
)
from liehom.flow.action.field import (
    GeneratorField as GeneratorField,
    hamiltonian_field as hamiltonian_field,
    lie_poisson_tensor as lie_poisson_tensor,
)
from liehom.flow.action.frames import InnerProduct as InnerProduct, inner_product as inner_product
from liehom.flow.action.motions import SE3 as SE3, SO3 as SO3
from liehom.flow.action.rigid_motions import (
    matrix_to_quaternion as matrix_to_quaternion,
    quaternion_exp as quaternion_exp,
    quaternion_log as quaternion_log,
    quaternion_product as quaternion_product,
    quaternion_to_matrix as quaternion_to_matrix,
    se3_bracket as se3_bracket,
    se3_dexp as se3_dexp,
    se3_dexp_inverse as se3_dexp_inverse,
    se3_exp as se3_exp,
    se3_log as se3_log,
    so3_dexp as so3_dexp,
    so3_dexp_inverse as so3_dexp_inverse,
    so3_exp as so3_exp,
    so3_log as so3_log,
)
from liehom.flow.action.space import Action as Action, IsotropyFrame as IsotropyFrame
