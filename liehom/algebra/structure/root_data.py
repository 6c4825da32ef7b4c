"""The roots of a semisimple algebra on a Cartan subalgebra in rigorous enclosures, and their exact Cartan integers.

The Cartan subalgebra h need not split.  ad h acts on g/h with the roots as joint eigenvalues.  The ball arithmetic of
flint encloses the eigenvalues and eigenvectors of one generic element, and with them all alpha(h_j), in balls that are
proved to contain them.  The Cartan integers <alpha, beta^vee> = 2 (alpha, beta) / (beta, beta), in the dual of the
Killing form on h, lie in balls that contain exactly one integer each, so they are exact.  So is the permutation of the
roots by complex conjugation.  If the balls are too wide the precision is doubled.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass
from typing import final

import numpy as np

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.subalgebra import Subalgebra
from liehom.algebra.roots.dynkin import CartanMatrix
from liehom.algebra.roots.root_system import RootSystem
from liehom.algebra.structure.cartan_subalgebra import cartan_subalgebra, is_self_normalizing
from liehom.algebra.structure.exact_field import exact_field
from liehom.errors import InputError, InternalError
from liehom.scalars import ExactMatrix, as_exact
from liehom.scalars.roots.joint_spectrum import Balls, JointSpectrum, joint_spectrum
from liehom.scalars.spaces.quotient import echelon_quotient
from liehom.typing import IntegerArray

FIRST_PRECISION = 64  # in bits
LAST_PRECISION = 4096  # in bits, if the entries are small
MARGIN = 64  # largest precision in units of the bits of the largest entry
WEIGHT = 99_999  # bound on the coefficients of the generic element
HEIGHT = 10**6  # bound on the coefficients of the generic linear form that orders the roots


@final
@dataclass(frozen=True, slots=True)
class RootData:
    """The roots of a semisimple algebra with respect to a Cartan subalgebra over its field.

    Attributes
    ----------
    algebra : LieAlgebra
    cartan : Subalgebra
        The Cartan subalgebra h, with basis h_1, ..., h_r.
    root_system : RootSystem
        The root system of the complexification, for some choice of simple roots.
    roots : tuple of tuples of int
        The coefficients of the roots in these simple roots, in the order of `spectrum.values`.
    spectrum : JointSpectrum
        The joint eigenvalues, with `values` the alpha_i(h_j) as balls (``flint.acb``).
    """

    algebra: LieAlgebra
    cartan: Subalgebra
    root_system: RootSystem
    roots: tuple[tuple[int, ...], ...]
    spectrum: JointSpectrum

    @property
    def conjugation(self) -> tuple[int, ...]:
        """The permutation of the roots by complex conjugation: root i is mapped to root ``conjugation[i]``."""
        return self.spectrum.conjugation

    @property
    def is_split(self) -> bool:
        """Whether all roots are real on h."""
        return all(i == j for i, j in enumerate(self.conjugation))

    @property
    def is_compact(self) -> bool:
        """Whether all roots are imaginary on h."""
        negative = [tuple(-x for x in self.roots[j]) for j in self.conjugation]
        return all(a == b for a, b in zip(self.roots, negative, strict=True))

    def simple_values(self) -> list[Balls]:
        """The values of the simple roots on the basis of h as balls, in the order of the root system."""
        index = {root: i for i, root in enumerate(self.roots)}
        return [self.spectrum.values[index[root]] for root in self.root_system.simple_roots]


def root_data(algebra: LieAlgebra, cartan: Subalgebra | None = None) -> RootData:
    """The roots of a semisimple algebra on a Cartan subalgebra, by default on the one of `cartan_subalgebra`.

    Raises
    ------
    UndecidedError
        Over float64.
    InputError
        If the algebra is not semisimple.

    Examples
    --------
    >>> import liehom as lh
    >>> data = root_data(lh.so(3))
    >>> data.root_system.type, data.is_compact
    ('A1', True)
    """
    exact_field(algebra, "roots")
    killing = as_exact(algebra.killing_form())
    if killing.rank() < algebra.dimension:
        raise InputError("only a semisimple algebra has a root system; take the Levi factor of levi_decomposition()")
    h = cartan_subalgebra(algebra) if cartan is None else cartan
    if algebra.dimension == 0:
        return RootData(algebra, h, RootSystem(()), (), JointSpectrum((), (), 0))
    actions = _actions(algebra, h)
    basis = as_exact(h.basis)
    form = (basis @ killing @ basis.T).inverse()
    rng = random.Random(algebra.dimension)
    for precision in _precisions(actions):
        spectrum = joint_spectrum(actions, [rng.randint(-WEIGHT, WEIGHT) for _ in actions], precision)
        pairing = None if spectrum is None else spectrum.cartan_integers(form)
        if spectrum is not None and pairing is not None:
            cartan_matrix, roots = _in_simple_roots(pairing)
            return RootData(algebra, h, RootSystem(cartan_matrix), roots, spectrum)
    raise InternalError("the roots could not be separated; please report this algebra")


def _precisions(actions: list[ExactMatrix]) -> Iterator[int]:
    """The precisions to try, in bits: at least three times the bits of the largest entry, which is mostly enough."""
    bits = max(int(abs(x)).bit_length() for a in actions for part in a.parts for x in part.entries())
    precision = FIRST_PRECISION
    while precision <= max(LAST_PRECISION, MARGIN * bits):
        if precision >= 3 * bits:
            yield precision
        precision *= 2


def _actions(algebra: LieAlgebra, h: Subalgebra) -> list[ExactMatrix]:
    """The matrices of ad h_j on g/h, acting on rows."""
    if not is_self_normalizing(h) or not h.as_algebra().is_abelian():
        raise InputError("a Cartan subalgebra of a semisimple algebra is abelian and its own normalizer")
    basis = as_exact(h.basis)
    coordinates = echelon_quotient(basis)
    return algebra.table.contract(basis, coordinates.lift, coordinates.projection)


def _in_simple_roots(pairing: IntegerArray) -> tuple[CartanMatrix, tuple[tuple[int, ...], ...]]:
    """The Cartan matrix for a choice of simple roots and all roots in these, from the Cartan integers alone."""
    m = len(pairing)
    rng = random.Random(m)
    heights = np.zeros(m, dtype=np.int64)
    while not heights.all():
        heights = pairing @ np.array([rng.randint(-HEIGHT, HEIGHT) for _ in range(m)], dtype=np.int64)
    positive = [int(i) for i in np.argsort(heights, kind="stable") if heights[i] > 0]
    simple: list[int] = []
    for i in positive:  # a positive root that is not simple pairs positively with a lower simple one
        if all(pairing[i, j] <= 0 for j in simple):
            simple.append(i)
    cartan = pairing[np.ix_(simple, simple)]
    solved = np.rint(np.linalg.solve(cartan.T.astype(float), pairing[:, simple].T.astype(float)).T).astype(np.int64)
    if (solved @ cartan != pairing[:, simple]).any():
        raise InternalError("the Cartan integers are not those of a root system")
    return tuple(map(tuple, cartan.tolist())), tuple(tuple(row) for row in solved.tolist())
