"""Which numbers, and the linear algebra over them: QQ, real number fields, float64.

In reading order: `field` (the interfaces), `exact` and `exact_matrix` (QQ and QQ(a)), `number_fields` (from
what a user writes), `polynomial` (root counts), `balls` (certain signs), `floating` (float64), `subspace`,
`grammar` (how values are read).
"""

from liehom.scalars.algebraic_number import AlgebraicNumber as AlgebraicNumber
from liehom.scalars.exact import NumberField as NumberField
from liehom.scalars.exact_field import ExactField as ExactField
from liehom.scalars.exact_matrix import ExactMatrix as ExactMatrix
from liehom.scalars.extension import Extension as Extension
from liehom.scalars.extension import RealFactor as RealFactor
from liehom.scalars.extension import adjoin_root as adjoin_root
from liehom.scalars.extension import real_factors as real_factors
from liehom.scalars.field import Field as Field
from liehom.scalars.field import Matrix as Matrix
from liehom.scalars.field import Scalar as Scalar
from liehom.scalars.floating import RR as RR
from liehom.scalars.floating import FloatField as FloatField
from liehom.scalars.floating import FloatMatrix as FloatMatrix
from liehom.scalars.floating import RankDecision as RankDecision
from liehom.scalars.number_fields import common_field as common_field
from liehom.scalars.number_fields import exact_value as exact_value
from liehom.scalars.number_fields import number_field as number_field
from liehom.scalars.pickling import register as _register
from liehom.scalars.polynomial import Polynomial as Polynomial
from liehom.scalars.rational import QQ as QQ
from liehom.scalars.rational import RationalField as RationalField
from liehom.scalars.subspace import Subspace as Subspace

_register()
