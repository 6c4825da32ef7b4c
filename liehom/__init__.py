"""liehom: Lie algebras, isotropy and fullness, exactly. (Docstring to be completed as the layers land.)"""

from liehom.algebra.lie_algebra import LieAlgebra as LieAlgebra
from liehom.algebra.subalgebra import Subalgebra as Subalgebra
from liehom.representations.pair import Pair as Pair
from liehom.representations.representation import Representation as Representation
from liehom.scalars.number_fields import number_field as number_field
from liehom.scalars.rational import QQ as QQ

__version__ = "0.1.0"
