"""Dynamical Lie algebras of qubits, from Pauli words.

Words are bit vectors, commutators symplectic products over F_2; closures of words have their names by linear algebra
over F_2. See docs/physics.md.
"""

from liehom.base.lazy import lazy

__getattr__, __dir__ = lazy(__name__)
