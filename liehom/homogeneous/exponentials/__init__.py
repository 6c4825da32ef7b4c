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
from liehom.homogeneous.exponentials.rodrigues import Rodrigues as Rodrigues
