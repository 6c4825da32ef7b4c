"""The door from `liehom.flow` to `liehom.exact`: everything that trajectories need of the exact half.

Nothing else in this half imports `liehom.exact`; tests/test_layers.py holds it.
"""

from liehom.exact.algebra.constructions.classical import so
from liehom.exact.algebra.constructions.families import abelian
from liehom.exact.algebra.constructions.sums import direct_sum
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.geometry.metrics import InvariantMetric
from liehom.exact.orbits.range import batched_ranks
from liehom.exact.representations.constructions import adjoint, coadjoint, defining, trivial
from liehom.exact.representations.core.coordinates import Copies, copies_of
from liehom.exact.representations.core.representation import Representation
from liehom.exact.scalars.exact_field import ExactMatrix
from liehom.exact.scalars.field import Field, Matrix, Scalar
from liehom.exact.scalars.floating import RR, RankDecision
from liehom.exact.scalars.function_field import FunctionField, RationalFunction
from liehom.exact.scalars.grammar import Call, Name, Node, Number, Operation, evaluate, parse
from liehom.exact.scalars.number_fields import AlgebraicNumber, common_field
from liehom.exact.scalars.rational import QQ
