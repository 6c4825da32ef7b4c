"""Linear subspaces, quotients, symmetric forms and sparse matrices over one field.

`Subspace` (canonical basis) and `quotient` (coordinates on K^n / U) are used by every layer above. `sparse` multiplies
integer matrices without overflow. `linear_forms` and `line_minors` are about the ranks of matrices of linear forms.
Their use in proofs is described in docs/theory/fullness.md.
"""

from liehom.scalars.spaces.subspace import Subspace as Subspace
