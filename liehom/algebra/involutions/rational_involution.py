"""The search for a rational Cartan involution of an algebra in the basis of a lattice.

Two steps alternate.  The lattice is LLL-reduced for -K(x, theta y), and theta is replaced by the Cartan involution that
minimizes the sum of -K(v, theta v) over the reduced basis, or over the short vectors of the lattice.  A theta that is
fixed by enough automorphisms of the lattice is such a minimum and is often rational; its entries are then recognized
and it is proved to be a Cartan involution.  If the minimum is not rational, a few random inner automorphisms lead to
another starting point.  All computations except for the proof are in floating point.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import TypeAlias

import numpy as np

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.involutions.approximate_involution import float_constants
from liehom.algebra.involutions.cartan_involution import nearest_cartan_involution, perturbed
from liehom.algebra.structure.exact_field import exact_field
from liehom.errors import ConvergenceError
from liehom.scalars import ExactMatrix
from liehom.scalars.lattices.lattice import reduced_basis
from liehom.typing import Array

DENOMINATOR = 60  # largest denominator of an entry that is recognized
CLOSE = 1e-6  # relative error up to which a float is recognized as a fraction
SHORT = 120  # short vectors that are used at most
SMALL = 40  # dimension up to which sums over short vectors are minimized
STRIDES = 5  # bound on reductions in a row, and on random automorphisms in a row
ACCURATE = 1e-9  # largest entry of theta^2 - 1 with which theta is accurate

State: TypeAlias = tuple[Array, Array, Array, ExactMatrix]  # constants, Killing form, theta, rows


def rational_involution(
    algebra: LieAlgebra, theta: Array, proved: Callable[[ExactMatrix], bool], rounds: int, seed: int = 0
) -> ExactMatrix | None:
    """A matrix over the field near Cartan involutions, (n, n) on columns, that passes a proof, or None.

    Parameters
    ----------
    algebra : LieAlgebra
        A semisimple algebra over an exact field, in the basis of the lattice.
    theta : (n, n) float array
        A Cartan involution, on rows.
    proved : callable
        Maps a matrix over the field, on columns, to whether it is proved to be a Cartan involution.
    rounds : int
        Maximum number of starting points.
    seed : int
        Seed of the random generator that draws the automorphisms.

    Examples
    --------
    >>> import liehom as lh
    >>> from liehom.algebra.involutions.approximate_involution import float_constants
    >>> from liehom.algebra.involutions.cartan_involution import cartan_involution_of_constants
    >>> g = lh.sl(2)
    >>> theta = cartan_involution_of_constants(float_constants(g), g.killing_form().to_numpy(), 1)
    >>> rational_involution(g, theta, lambda candidate: True, 5).to_strings()
    [['0', '-1', '0'], ['-1', '0', '0'], ['0', '0', '-1']]
    """
    search = _Search(algebra, theta)
    accurate = search.state()
    rng = np.random.default_rng(seed)
    for attempt in range(rounds):
        try:
            found = search.minimum(proved)
            if found is not None or attempt == rounds - 1:
                return found
            if search.is_accurate():
                accurate = search.state()
            search.restore(accurate)
            for _ in range(int(rng.integers(1, STRIDES))):
                search.perturb(rng)
        except (ConvergenceError, np.linalg.LinAlgError):
            search.restore(accurate)
    return None


class _Search:
    """A basis of the lattice with the structure constants, the Killing form and theta in it.

    Attributes
    ----------
    rows : ExactMatrix
        The basis, as rows in the given basis of the algebra.
    constants, killing, theta : float arrays
        In this basis, theta on rows.
    """

    def __init__(self, algebra: LieAlgebra, theta: Array) -> None:
        n = algebra.dimension
        self.n = n
        self.field = exact_field(algebra, "rational Cartan involutions")
        self.constants = float_constants(algebra)
        self.killing = algebra.killing_form().to_numpy()
        # Integral constants stay integral: rounding removes the errors of products in floating point.
        self.integral = bool((self.constants == np.rint(self.constants)).all())
        self.theta = theta
        self.rows = self.field.identity(n)

    def reduce(self) -> bool:
        """Reduce the basis by LLL for -K(x, theta y); whether this changed it."""
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

    def state(self) -> State:
        """The basis and all that is expressed in it."""
        return self.constants, self.killing, self.theta, self.rows

    def restore(self, state: State) -> None:
        """Return to an earlier state."""
        self.constants, self.killing, self.theta, self.rows = state

    def is_accurate(self) -> bool:
        """Whether theta is an involution up to rounding errors, which grow with every automorphism."""
        return bool(np.abs(self.theta @ self.theta - np.eye(self.n)).max() < ACCURATE)

    def minimum(self, proved: Callable[[ExactMatrix], bool]) -> ExactMatrix | None:
        """The first candidate that is proved while reductions and minima alternate until nothing changes, or None."""
        for _ in range(STRIDES):
            for short in (False, True) if self.n <= SMALL else (False,):
                found = self.candidate(self.short_vectors() if short else None)
                if found is not None and proved(found):
                    return found
                if self.reduce():
                    break
            else:
                break
        return None

    def candidate(self, gram: Array | None) -> ExactMatrix | None:
        """Replace theta by the minimum; a rational matrix close to it, on columns in the given basis, or None."""
        self.theta = nearest_cartan_involution(self.constants, self.killing, self.theta, gram=gram)
        fractions = [Fraction(x).limit_denominator(DENOMINATOR) for x in self.theta.ravel().tolist()]
        close = np.array([float(x) for x in fractions]).reshape(self.n, self.n)
        if np.abs(close - self.theta).max() > CLOSE * max(1.0, float(np.abs(self.theta).max())):
            return None
        values = [self.field.convert(x) for x in fractions]
        theta = self.field.from_entries(values, self.n, self.n)
        return (self.rows.inverse() @ theta @ self.rows).T

    def short_vectors(self) -> Array:
        """The sum of v^T v over short vectors of the lattice, which are sums and brackets of basis vectors."""
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

    def perturb(self, rng: np.random.Generator) -> None:
        """Replace theta by its image under a random inner automorphism, and reduce the basis."""
        self.theta = perturbed(self.constants, self.killing, self.theta, rng)
        self.reduce()


def _distinct(vectors: Array, form: Array, bound: float) -> Array:
    """The non-zero vectors up to sign whose norm is at most the bound, shortest first, at most `SHORT`."""
    norms = np.einsum("ai,ij,aj->a", vectors, form, vectors, optimize=True)
    kept = (norms <= bound) & (norms > 0)
    vectors, norms = vectors[kept], norms[kept]
    leading = np.take_along_axis(vectors, np.argmax(vectors != 0, axis=1)[:, None], axis=1)
    vectors, index = np.unique(vectors * np.sign(leading), axis=0, return_index=True)
    order = np.argsort(norms[index], kind="stable")[:SHORT]
    return vectors[order]
