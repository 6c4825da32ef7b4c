from liehom.exact.pauli.dynamical import (
    DynamicalLieAlgebra as DynamicalLieAlgebra,
    WordIdeal as WordIdeal,
    closure as closure,
)
from liehom.exact.pauli.words import (
    PauliSums as PauliSums,
    chain as chain,
    heisenberg as heisenberg,
    ising as ising,
    kitaev as kitaev,
    xy as xy,
)
