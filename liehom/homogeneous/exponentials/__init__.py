"""Maps Exp from g to the group, acting on V: the exponential, the Cayley transform, Rodrigues' formula, custom maps.

`exponential_of` gives the exponential that a name denotes. Actions and integrators use them; see docs/notation.md.
"""

from liehom.homogeneous.exponentials.block_exponential import BlockExponential as BlockExponential
from liehom.homogeneous.exponentials.cayley import Cayley as Cayley
from liehom.homogeneous.exponentials.custom_exponential import CustomExponential as CustomExponential
from liehom.homogeneous.exponentials.custom_exponential import exponential_of as exponential_of
from liehom.homogeneous.exponentials.exponential import Exponential as Exponential
from liehom.homogeneous.exponentials.exponential import MatrixExponential as MatrixExponential
from liehom.homogeneous.exponentials.exponential import SeriesExponential as SeriesExponential
from liehom.homogeneous.exponentials.exponential import TrueExponential as TrueExponential
from liehom.homogeneous.exponentials.quaternions import matrix_to_quaternion as matrix_to_quaternion
from liehom.homogeneous.exponentials.quaternions import quaternion_product as quaternion_product
from liehom.homogeneous.exponentials.quaternions import quaternion_to_matrix as quaternion_to_matrix
from liehom.homogeneous.exponentials.rigid_motions import quaternion_exp as quaternion_exp
from liehom.homogeneous.exponentials.rigid_motions import quaternion_log as quaternion_log
from liehom.homogeneous.exponentials.rigid_motions import se3_bracket as se3_bracket
from liehom.homogeneous.exponentials.rigid_motions import se3_dexp as se3_dexp
from liehom.homogeneous.exponentials.rigid_motions import se3_dexp_inverse as se3_dexp_inverse
from liehom.homogeneous.exponentials.rigid_motions import se3_exp as se3_exp
from liehom.homogeneous.exponentials.rigid_motions import se3_log as se3_log
from liehom.homogeneous.exponentials.rigid_motions import so3_dexp as so3_dexp
from liehom.homogeneous.exponentials.rigid_motions import so3_dexp_inverse as so3_dexp_inverse
from liehom.homogeneous.exponentials.rigid_motions import so3_exp as so3_exp
from liehom.homogeneous.exponentials.rigid_motions import so3_log as so3_log
from liehom.homogeneous.exponentials.rodrigues import Rodrigues as Rodrigues
