"""Numbers and linear algebra over them: QQ, real number fields, float64.

The wings, in reading order: `fields` (numbers and matrices), `spaces` (subspaces and quotients), `modular` (linear
algebra modulo a prime), `functions` (rational functions on a variety), `lattices`, and `roots` (roots of polynomials,
larger number fields). The conventions are in docs/notation.md.
"""

from liehom.scalars.fields import QQ as QQ
from liehom.scalars.fields import RR as RR
from liehom.scalars.fields import AlgebraicNumber as AlgebraicNumber
from liehom.scalars.fields import ExactField as ExactField
from liehom.scalars.fields import ExactMatrix as ExactMatrix
from liehom.scalars.fields import Field as Field
from liehom.scalars.fields import FloatField as FloatField
from liehom.scalars.fields import FloatMatrix as FloatMatrix
from liehom.scalars.fields import Matrix as Matrix
from liehom.scalars.fields import NumberField as NumberField
from liehom.scalars.fields import Polynomial as Polynomial
from liehom.scalars.fields import RankDecision as RankDecision
from liehom.scalars.fields import RationalField as RationalField
from liehom.scalars.fields import Scalar as Scalar
from liehom.scalars.fields import as_exact as as_exact
from liehom.scalars.fields import common_field as common_field
from liehom.scalars.fields import exact_value as exact_value
from liehom.scalars.fields import number_field as number_field
from liehom.scalars.fields.pickling import register as _register
from liehom.scalars.roots import Extension as Extension
from liehom.scalars.roots import RealFactor as RealFactor
from liehom.scalars.roots import adjoin_root as adjoin_root
from liehom.scalars.roots import real_factors as real_factors
from liehom.scalars.spaces import Subspace as Subspace

_register()
