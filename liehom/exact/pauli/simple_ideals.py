"""The simple ideals of a dynamical Lie algebra by a Cartan subalgebra modulo a prime."""

from __future__ import annotations

from itertools import islice

import flint
import numpy as np

from liehom.base.budget import in_time
from liehom.exact.algebra.structure.identification import types_of
from liehom.exact.pauli.span import LiftedRows, WordSpan
from liehom.exact.scalars.modular import (
    ModularSpan,
    Residues,
    invariant_span,
    left_kernel,
    product,
    remainders,
    residue_matrix,
    residues,
    splitting_primes,
)
from liehom.exact.scalars.polynomial import linear_roots

# Let s be the derived algebra of a dynamical Lie algebra, which is compact and semisimple, and S its reduction modulo a
# prime p, of the same dimension. The trace form of the representation is the dot product of coefficients of words.
#
# 1. Let x in S be random and h its centralizer. If h is abelian and the trace form is not degenerate on h, then
#    dim h = rank s. For h is the reduction of the Fitting null component of ad x for a lift of x. If that were larger
#    than a Cartan subalgebra, it would contain a root vector e, and some f with tr(ef) a unit. Modulo p both commute, and
#    e is nilpotent, so that tr(ef) = 0.
# 2. The projections of x to the simple ideals satisfy [[u, a], [x, b]] = [[x, a], [u, b]] for all a, b in S, and so
#    does the image of x under every map of the centroid. The u in h that satisfy these equations for some a and b form
#    a space U. It is closed under the product u * v with [[u * v, a], [x, b]] = [[u, a], [v, b]]. If the product by some
#    u has distinct eigenvalues in F_p, let x_1, ..., x_k be its eigenvectors and I_j the ideal that x_j generates.
# 3. If S is the direct sum of the I_j, the centroid of I_j is F_p, as it maps x_j into the intersection of U with I_j.
#    If the trace form is not degenerate on I_j, the Killing form is therefore a multiple of it, and I_j is absolutely
#    simple if tr (ad x_j)^2 is not 0 on it. An algebra with such a Killing form is rigid (its second cohomology with
#    values in itself vanishes, as the Casimir operator is 1), so that s has simple ideals of the dimensions of the I_j.
#    Their ranks are at most the dimensions of the centralizers of x_j in I_j, with the sum rank s.
#
# 4. Dimension and rank leave open B_n or C_n, n >= 3, or E6 with n = 6. The Dynkin index of the representation is twice
#    the dual Coxeter number times the trace form over the Killing form, a positive integer with a known bound. The
#    residue excludes a type for which it is not.
#
# Every condition is checked. A prime for which one fails is left for the next one. The eigenvalues are in F_p for the
# primes that split the centroid, one of m! on average at worst if m ideals are conjugate over the field.

PRIMES = 40  # that are tried
TESTS = 2  # pairs a, b
DUAL_COXETER = {"B": lambda rank: 2 * rank - 1, "C": lambda rank: rank + 1, "E": lambda rank: 12}  # E6

Ideal = tuple[int, int, int]
"""Dimension, rank, and the trace form divided by the Killing form modulo a prime."""


def simple_types(span: WordSpan, derived: LiftedRows | None) -> list[str] | None:
    """The types of the complexified simple ideals, or None if no prime shows them or a type remains open.

    The derived algebra is not zero and given by its basis; None stands for all words.
    """
    for p, roots in islice(splitting_primes(span.field), PRIMES):
        if derived is None or derived.den % p:
            rows = np.eye(span.size) if derived is None else derived.modulo(p, roots[0])
            if (ideals := _Reduction(span, rows, p, roots[0]).ideals()) is not None:
                types = [_types(ideal, span.qubits, p) for ideal in ideals]
                return [kinds[0] for kinds in types] if all(len(kinds) == 1 for kinds in types) else None
    return None


def _types(ideal: Ideal, qubits: int, p: int) -> list[str]:
    """The types that an ideal may have."""
    dimension, rank, ratio = ideal
    types = types_of(dimension, rank)
    most = 8**qubits // 6  # of the Dynkin index: the sum of n (n^2 - 1) / 6 over the n of a partition of 2^qubits
    return [t for t in types if len(types) == 1 or 0 < 2 * DUAL_COXETER[t[0]](rank) * ratio % p <= most]


class _Reduction:
    """The algebra S that rows modulo a prime span."""

    def __init__(self, span: WordSpan, rows: Residues, p: int, root: int) -> None:
        self.span, self.rows, self.p = span, rows, p
        self.generators = span.maps(residues(span.generators, p, root), p)
        self.rng = np.random.default_rng(p)

    def ideals(self) -> list[Ideal] | None:
        """The ideals I_j, or None if a condition fails."""
        p, (x,) = self.p, self._random(self.rows, 1)
        cartan = self._kernel(self.rows, product(self.rows, self._ad(x), p))
        if not self._is_nondegenerate(cartan) or any(product(cartan, self._ad(h), p).any() for h in cartan):
            return None
        whole = ModularSpan(p, self.span.size)
        ideals = [self._ideal(y, whole) for y in self._projections(x, cartan)]
        found = [ideal for ideal in ideals if ideal is not None]
        sums = (sum(dimension for dimension, _, _ in found), sum(rank for _, rank, _ in found))
        return found if sums == (len(self.rows), len(cartan)) and whole.rank == len(self.rows) else None

    def _projections(self, x: Residues, cartan: Residues) -> list[Residues]:
        """Multiples of the projections of x to the ideals I_j; fewer if an eigenvalue is not in F_p."""
        p = self.p
        conditions = []
        for _ in range(TESTS):
            a, b = self._random(self.rows, 2)
            left = self._double(cartan, x, a, b)
            right = product(product(cartan, self._ad(b), p), self._ad(self._bracket(x, a)), p)  # -[[x, a], [u, b]]
            conditions.append(left + right)
        space = self._kernel(cartan, remainders(np.hstack(conditions), p))
        (u,) = self._random(space, 1)
        one, other = self._double(space, x, a, b), self._double(space, u, a, b)
        span = ModularSpan(p, self.span.size)
        if len(span.extend(one)) < len(space):
            return []
        by_x, by_u = (self._flint(values[:, span.pivots]) for values in (one, other))
        matrix = by_u * by_x.inv()
        table = np.array([int(v) for v in matrix.entries()], dtype=np.float64).reshape(len(space), len(space))
        values = linear_roots([int(c) for c in matrix.charpoly().coeffs()], p)
        return [self._kernel(space, remainders(table - c * np.eye(len(space)), p))[0] for c in values]

    def _ideal(self, y: Residues, whole: ModularSpan) -> Ideal | None:
        """The ideal that y generates, which is added to a span; None if a condition fails."""
        p = self.p
        echelon, pivots = invariant_span(self.generators, y[None], p).echelon()
        rows = echelon.astype(np.float64)
        whole.extend(rows)
        images = product(rows, self._ad(y), p)
        moved = ModularSpan(p, self.span.size)
        moved.extend(images)
        action = images[:, pivots]
        killing = int(remainders(action * action.T, p).sum()) % p
        if not killing or not self._is_nondegenerate(rows):
            return None
        trace = -(2**self.span.qubits) * int(remainders(y * y, p).sum())
        return len(rows), len(rows) - moved.rank, trace * pow(killing, -1, p) % p

    # -- helpers -----------------------------------------------------------------------------------------
    def _ad(self, y: Residues) -> Residues:
        """The matrix of z -> [y, z], acting on rows z."""
        in_time()
        return self.span.dense_map(y, self.p)

    def _bracket(self, y: Residues, z: Residues) -> Residues:
        return product(z[None], self._ad(y), self.p)[0]

    def _double(self, rows: Residues, y: Residues, a: Residues, b: Residues) -> Residues:
        """[[u, a], [y, b]] for the rows u."""
        return product(product(rows, self._ad(a), self.p), self._ad(self._bracket(y, b)), self.p)

    def _random(self, rows: Residues, count: int) -> Residues:
        return product(self.rng.integers(self.p, size=(count, len(rows))).astype(np.float64), rows, self.p)

    def _kernel(self, rows: Residues, images: Residues) -> Residues:
        """A basis of the combinations of rows for which the same combination of images is 0."""
        return product(left_kernel(images, self.p).astype(np.float64), rows, self.p)

    def _is_nondegenerate(self, rows: Residues) -> bool:
        """Whether the dot product is not degenerate on the span of independent rows."""
        return int(self._flint(product(rows, rows.T, self.p)).rank()) == len(rows)

    def _flint(self, table: Residues) -> flint.nmod_mat:
        return residue_matrix(*table.shape, table.astype(np.int64).ravel().tolist(), self.p)
