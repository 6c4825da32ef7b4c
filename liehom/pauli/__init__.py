"""Dynamical Lie algebras of Pauli words, by arithmetic over F_2.

In reading order: `words` (strings to bit vectors), `symplectic` (commutators), `identification` (names of algebras that
words span), `closure` (`DynamicalLieAlgebra`), `chains` (spin models). The page physics.md is the introduction.
"""

from liehom.pauli.chains import chain as chain
from liehom.pauli.chains import heisenberg as heisenberg
from liehom.pauli.chains import ising as ising
from liehom.pauli.chains import kitaev as kitaev
from liehom.pauli.chains import xy as xy
from liehom.pauli.closure import DynamicalLieAlgebra as DynamicalLieAlgebra
from liehom.pauli.closure import closure as closure
from liehom.pauli.identification import WordIdeal as WordIdeal
from liehom.pauli.words import PauliSums as PauliSums
