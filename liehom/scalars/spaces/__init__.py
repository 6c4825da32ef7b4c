"""Linear subspaces, quotients, symmetric forms and sparse matrices over one field.

`Subspace` (canonical basis) and `quotient` (coordinates on K^n / U) serve every layer above; `sparse` multiplies
integer matrices without overflow; `linear_forms` proves ranks of matrices of linear forms. The use of these in proofs
is on the page docs/theory/fullness.md.
"""

from liehom.scalars.spaces.subspace import Subspace as Subspace
