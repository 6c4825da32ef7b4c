"""Numbers: the rationals QQ, real number fields QQ(a) and float64, each with its matrices.

`field` has the interfaces `Field` and `Matrix`. `exact_field` has the linear algebra of QQ and the number fields on
python-flint, `rational` and `number_field` their numbers, and `floating` float64. `grammar` and `number_fields` read
user input, and `polynomial` and `balls` count and enclose real roots. Every layer above uses this wing; the conventions
are in docs/notation.md.
"""

from liehom.scalars.fields.exact_field import ExactField as ExactField
from liehom.scalars.fields.exact_field import ExactMatrix as ExactMatrix
from liehom.scalars.fields.exact_field import as_exact as as_exact
from liehom.scalars.fields.field import Field as Field
from liehom.scalars.fields.field import Matrix as Matrix
from liehom.scalars.fields.field import Scalar as Scalar
from liehom.scalars.fields.floating import RR as RR
from liehom.scalars.fields.floating import FloatField as FloatField
from liehom.scalars.fields.floating import FloatMatrix as FloatMatrix
from liehom.scalars.fields.floating import RankDecision as RankDecision
from liehom.scalars.fields.number_field import AlgebraicNumber as AlgebraicNumber
from liehom.scalars.fields.number_field import NumberField as NumberField
from liehom.scalars.fields.number_fields import common_field as common_field
from liehom.scalars.fields.number_fields import exact_value as exact_value
from liehom.scalars.fields.number_fields import number_field as number_field
from liehom.scalars.fields.polynomial import Polynomial as Polynomial
from liehom.scalars.fields.rational import QQ as QQ
from liehom.scalars.fields.rational import RationalField as RationalField
