"""The search for a rational Cartan involution of an algebra in the basis of a lattice that suits it.

The lattice is LLL-reduced for -K(x, theta y), and theta is moved to where the sum of -K(v, theta v) over the reduced
basis, or over the short vectors of the lattice, is least; in turn.  A theta that enough automorphisms of the lattice
fix is such a minimum, and often rational: its entries are recognised and it is proved.  From a minimum that is not,
a few random inner automorphisms lead elsewhere, and the search goes on.  All but the proof is floating point.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.involutions.cartan_involution import kicked, nearest_cartan_involution
from liehom.errors import ConvergenceError
from liehom.scalars import RR
from liehom.scalars.lattices.lattice import reduced_basis

Array = npt.NDArray[Any]
DENOMINATOR = 60
CLOSE = 1e-6
SHORT = 120
SMALL = 40
STRIDES = 5
ACCURATE = 1e-9


def rational_involution(
    algebra: LieAlgebra, theta: Array, proved: Callable[[Any], bool], rounds: int, seed: int = 0
) -> Any:
    """A Cartan involution over the field that passes a proof, on columns, or None.

    Parameters
    ----------
    algebra : LieAlgebra
        Semisimple, over an exact field, in the basis of the lattice.
    theta : (n, n) float array
        A Cartan involution, on rows.
    proved : callable
        Whether a matrix over the field, on columns, in the given basis, is a Cartan involution.
    rounds : int
        How many reductions and moves.
    seed : int
        Of the random moves.

    Examples
    --------
    >>> import liehom as lh
    >>> from liehom.algebra.involutions.cartan_involution import cartan_involution_of_constants
    >>> g = lh.sl(2)
    >>> c, K = g.over(lh.RR).table.dense().array.reshape(3, 3, 3), g.killing_form().to_numpy()
    >>> theta = cartan_involution_of_constants(c, K, 1)
    >>> rational_involution(g, theta, lambda candidate: True, 5).to_strings()
    [['0', '-1', '0'], ['-1', '0', '0'], ['0', '0', '-1']]
    """
    search = _Search(algebra, theta)
    home = search.state()
    rng = np.random.default_rng(seed)
    for place in range(rounds):
        try:
            found = search.visited(proved)
            if found is not None or place == rounds - 1:
                return found
            if search.is_accurate():
                home = search.state()
            search.restore(home)
            for _ in range(int(rng.integers(1, STRIDES))):
                search.kick(rng)
        except (ConvergenceError, np.linalg.LinAlgError):
            search.restore(home)
    return None


class _Search:
    """A basis of the lattice (rows in the first one), the constants in it, and theta on its rows."""

    def __init__(self, algebra: LieAlgebra, theta: Array) -> None:
        n = algebra.dimension
        self.n = n
        self.field: Any = algebra.field
        self.constants = algebra.over(RR).table.dense().array.reshape(n, n, n)
        self.killing = algebra.killing_form().to_numpy()
        # Integers stay integers: rounding removes what multiplication in floats leaves.
        self.integral = bool((self.constants == np.rint(self.constants)).all())
        self.theta = theta
        self.rows = algebra.field.identity(n)

    def reduced(self) -> bool:
        """Whether LLL reduction changed the basis."""
        form = -self.killing @ self.theta.T
        change = self.field.from_integers(reduced_basis(form).parts[0].entries(), self.n, self.n)
        if change == self.field.identity(self.n):
            return False
        u, v = change.to_numpy(), change.inverse().to_numpy()
        self.constants = np.einsum("ai,bj,ijk,kc->abc", u, u, self.constants, v, optimize=True)
        self.killing = u @ self.killing @ u.T
        if self.integral:
            self.constants, self.killing = np.rint(self.constants), np.rint(self.killing)
        self.theta = u @ self.theta @ v
        self.rows = change @ self.rows
        return True

    def state(self) -> tuple[Any, ...]:
        return self.constants, self.killing, self.theta, self.rows

    def restore(self, state: tuple[Any, ...]) -> None:
        self.constants, self.killing, self.theta, self.rows = state

    def is_accurate(self) -> bool:
        """Whether theta is an involution up to rounding: errors grow with the way that theta has been moved."""
        return bool(np.abs(self.theta @ self.theta - np.eye(self.n)).max() < ACCURATE)

    def visited(self, proved: Callable[[Any], bool]) -> Any:
        """Reductions and minima in turn until nothing changes; the first candidate that is proved, or None."""
        for _ in range(STRIDES):
            for short in (False, True) if self.n <= SMALL else (False,):
                found = self.settled(self.short_vectors() if short else None)
                if found is not None and proved(found):
                    return found
                if self.reduced():
                    break
            else:
                break
        return None

    def settled(self, gram: Array | None) -> Any:
        """Moves theta to the minimum; a rational matrix close to it, on columns in the first basis, or None."""
        self.theta = nearest_cartan_involution(self.constants, self.killing, self.theta, gram=gram)
        fractions = [Fraction(x).limit_denominator(DENOMINATOR) for x in self.theta.ravel().tolist()]
        close = np.array([float(x) for x in fractions]).reshape(self.n, self.n)
        if np.abs(close - self.theta).max() > CLOSE * max(1.0, float(np.abs(self.theta).max())):
            return None
        values = [self.field.convert(x) for x in fractions]
        theta = self.field.from_entries(values, self.n, self.n)
        return (self.rows.inverse() @ theta @ self.rows).T

    def short_vectors(self) -> Array:
        """The sum of v^T v over short vectors of the lattice: the basis, sums and brackets of two, sums again."""
        form = -self.killing @ self.theta.T
        form = (form + form.T) / 2
        basis = np.eye(self.n)
        bound = float(np.diag(form).max()) * (1 + 1e-6)
        vectors = basis
        if self.integral:
            vectors = np.concatenate([vectors, self.constants.reshape(-1, self.n)])
        for _ in range(2):
            vectors = _distinct(vectors, form, bound)
            i, j = np.triu_indices(len(vectors), 1)
            vectors = np.concatenate([vectors, vectors[i] + vectors[j], vectors[i] - vectors[j]])
        vectors = _distinct(vectors, form, bound)
        return vectors.T @ vectors

    def kick(self, rng: np.random.Generator) -> None:
        self.theta = kicked(self.constants, self.killing, self.theta, rng)
        self.reduced()


def _distinct(vectors: Array, form: Array, bound: float) -> Array:
    """The non-zero vectors up to sign whose norm is at most the bound, shortest first, not too many."""
    norms = np.einsum("ai,ij,aj->a", vectors, form, vectors, optimize=True)
    kept = (norms <= bound) & (norms > 0)
    vectors, norms = vectors[kept], norms[kept]
    leading = np.take_along_axis(vectors, np.argmax(vectors != 0, axis=1)[:, None], axis=1)
    vectors, index = np.unique(vectors * np.sign(leading), axis=0, return_index=True)
    order = np.argsort(norms[index], kind="stable")[:SHORT]
    return vectors[order]
