from liehom.exact.scalars.exact_field import ExactField as ExactField, ExactMatrix as ExactMatrix, as_exact as as_exact
from liehom.exact.scalars.extension import (
    Extension as Extension,
    RealFactor as RealFactor,
    adjoin_root as adjoin_root,
    real_factors as real_factors,
)
from liehom.exact.scalars.field import Field as Field, Matrix as Matrix, Scalar as Scalar
from liehom.exact.scalars.floating import (
    RR as RR,
    FloatField as FloatField,
    FloatMatrix as FloatMatrix,
    RankDecision as RankDecision,
)
from liehom.exact.scalars.number_fields import (
    AlgebraicNumber as AlgebraicNumber,
    NumberField as NumberField,
    common_field as common_field,
    exact_value as exact_value,
    number_field as number_field,
)
from liehom.exact.scalars.polynomial import Polynomial as Polynomial
from liehom.exact.scalars.rational import QQ as QQ, RationalField as RationalField
from liehom.exact.scalars.subspaces import Subspace as Subspace
