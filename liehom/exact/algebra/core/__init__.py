"""`LieAlgebra`, `Subalgebra`, `Homomorphism`, the table of their brackets, and the proofs of their axioms.

`LieAlgebra` and `Subalgebra` are tables of contents. Their methods lead to the other folders of `algebra`, and only
they import upwards. The conventions are in docs/notation.md.
"""

from liehom.base.lazy import lazy_modules

__getattr__ = lazy_modules(__name__)
