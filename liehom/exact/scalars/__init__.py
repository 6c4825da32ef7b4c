"""Which numbers, and linear algebra over them: QQ, real number fields QQ(a), float64 with a bound of its error.

Matrices are those of python-flint. Rigorous enclosures locate roots; primes propose ranks and spans that exact
arithmetic proves; fields of rational functions serve points with symbols. See docs/tutorials/number-fields.md.
"""

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
