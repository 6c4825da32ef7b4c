"""The roots of a semisimple algebra on a rational Cartan subalgebra, as certain balls; their Cartan integers, exactly.

The Cartan subalgebra h need not split.  ad h acts on g/h with the roots as joint eigenvalues; flint encloses the
eigenvalues and eigenvectors of one generic element in balls that are proved to hold them (rigorous ball arithmetic),
and with them all alpha(h_j).  The Cartan integers <alpha, beta^vee> = 2 (alpha, beta) / (beta, beta), in the dual of
the Killing form on h, are integers inside balls that hold one integer each, so they are exact; so is the permutation
of the roots by complex conjugation.  Where balls are too wide the precision is doubled.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.subalgebra import Subalgebra
from liehom.algebra.roots.dynkin import CartanMatrix
from liehom.algebra.roots.root_system import RootSystem
from liehom.algebra.structure.cartan_subalgebra import cartan_subalgebra, is_self_normalizing
from liehom.errors import FieldError, InputError, InternalError
from liehom.scalars.roots.joint_spectrum import JointSpectrum, joint_spectrum
from liehom.scalars.spaces.quotient import echelon_quotient

PRECISIONS = (64, 128, 256, 512, 1024, 2048, 4096)
WEIGHT = 99_999


@final
@dataclass(frozen=True, slots=True)
class RootData:
    """The roots of a semisimple algebra with respect to a Cartan subalgebra over its field.

    Attributes
    ----------
    algebra : LieAlgebra
    cartan : Subalgebra
        h, with basis h_1, ..., h_r.
    root_system : RootSystem
        That of the complexification, for some choice of simple roots.
    roots : tuple of tuples of int
        The roots in these simple roots, in the order of `spectrum.values`.
    spectrum : JointSpectrum
        Its `values` are the alpha_i(h_j) as balls (``flint.acb``).
    """

    algebra: LieAlgebra
    cartan: Subalgebra
    root_system: RootSystem
    roots: tuple[tuple[int, ...], ...]
    spectrum: JointSpectrum

    @property
    def conjugation(self) -> tuple[int, ...]:
        """Root i followed by complex conjugation is root ``conjugation[i]``."""
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

    def simple_values(self) -> list[tuple[Any, ...]]:
        """The balls of the simple roots on the basis of h, in the order of the root system."""
        places = {root: i for i, root in enumerate(self.roots)}
        return [self.spectrum.values[places[root]] for root in self.root_system.simple_roots]


def root_data(algebra: LieAlgebra, cartan: Subalgebra | None = None) -> RootData:
    """The roots of a semisimple algebra on a Cartan subalgebra (by default the one of `cartan_subalgebra`).

    Raises
    ------
    FieldError
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
    if not algebra.field.exact:
        raise FieldError("roots are computed exactly: build the algebra over QQ or a number field")
    killing = algebra.killing_form()
    if killing.rank() < algebra.dimension:
        raise InputError("roots are those of a semisimple algebra; take the Levi factor of levi_decomposition()")
    h = cartan_subalgebra(algebra) if cartan is None else cartan
    if algebra.dimension == 0:
        return RootData(algebra, h, RootSystem(()), (), JointSpectrum((), (), 0))
    actions = _actions(algebra, h)
    form = (h.basis @ killing @ h.basis.T).inverse()
    rng = random.Random(algebra.dimension)
    for precision in _precisions(actions):
        spectrum = joint_spectrum(actions, [rng.randint(-WEIGHT, WEIGHT) for _ in actions], precision)
        pairing = None if spectrum is None else spectrum.cartan_integers(form)
        if spectrum is not None and pairing is not None:
            cartan_matrix, roots = _in_simple_roots(pairing)
            return RootData(algebra, h, RootSystem(cartan_matrix), roots, spectrum)
    raise InternalError(f"the roots could not be told apart with {PRECISIONS[-1]} bits")


def _precisions(actions: list[Any]) -> list[int]:
    """Bits to try: as a rule a little more than three times those of the largest entry separate the eigenvalues."""
    bits = max(int(abs(x)).bit_length() for a in actions for part in a.parts for x in part.entries())
    return [p for p in PRECISIONS if p >= 3 * bits] or [PRECISIONS[-1]]


def _actions(algebra: LieAlgebra, h: Subalgebra) -> list[Any]:
    """The matrices of ad h_j on g/h, acting on rows."""
    if not is_self_normalizing(h) or not h.as_algebra().is_abelian():
        raise InputError("a Cartan subalgebra of a semisimple algebra is abelian and its own normalizer")
    coordinates = echelon_quotient(h.basis)
    blocks = algebra.table.contract(h.basis, coordinates.lift, coordinates.projection)
    return list(blocks)


def _in_simple_roots(pairing: Any) -> tuple[CartanMatrix, tuple[tuple[int, ...], ...]]:
    """The Cartan matrix of a choice of simple roots, and all roots in them; exact, from the Cartan integers alone."""
    m = len(pairing)
    rng = random.Random(m)
    heights = np.zeros(m, dtype=np.int64)
    while not heights.all():
        heights = pairing @ np.array([rng.randint(-(10**6), 10**6) for _ in range(m)], dtype=np.int64)
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
