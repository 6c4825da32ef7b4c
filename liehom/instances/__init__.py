"""Systems of the paper and beside it, as instances of the generic code: nothing here re-implements it."""

from liehom.instances.isospectral import double_bracket_flow as double_bracket_flow
from liehom.instances.isospectral import qr_flow as qr_flow
from liehom.instances.isospectral import qr_solution as qr_solution
from liehom.instances.isospectral import toda_flow as toda_flow
from liehom.instances.sym_conjugation import SymmetricMatrices as SymmetricMatrices
