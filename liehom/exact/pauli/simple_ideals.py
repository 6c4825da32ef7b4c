"""The simple ideals of a dynamical Lie algebra by a Cartan subalgebra modulo a prime."""

from __future__ import annotations

from itertools import islice

import numpy as np

from liehom.base.budget import in_time
from liehom.exact.algebra.structure.identification import types_of
from liehom.exact.pauli.span import LiftedRows, WordSpan
from liehom.exact.scalars.modular import (
    ModularSpan,
    Residues,
    eigenvalues,
    invariant_span,
    left_kernel,
    product,
    remainders,
    residues,
    splitting_primes,
)

# Proof and notation: docs/theory/structure.md, "Compact algebras modulo a prime". Every condition is checked; where one
# fails, the next prime is taken.

PRIMES = 40  # that are tried
TESTS = 2  # pairs a, b
DUAL_COXETER = {"B": (2, -1), "C": (1, 1), "E": (0, 12)}  # a rank + b, for E6

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
    if len(types) == 1:
        return types
    most = 8**qubits // 6  # of the Dynkin index: the sum of n (n^2 - 1) / 6 over the n of a partition of 2^qubits
    numbers = {t: a * rank + b for t in types for a, b in [DUAL_COXETER[t[0]]]}
    return [t for t in types if 0 < 2 * numbers[t] * ratio % p <= most]


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
            conditions.append(self._double(cartan, a, x, b) + self._double(cartan, b, x, a))
        space = self._kernel(cartan, remainders(np.hstack(conditions), p))
        (u,) = self._random(space, 1)
        one, other = self._double(space, a, x, b), self._double(space, a, u, b)
        span = ModularSpan(p, self.span.size)
        if len(span.extend(one)) < len(space):
            return []
        values = eigenvalues(other[:, span.pivots], one[:, span.pivots], p)
        return [self._kernel(space, remainders(other - c * one, p))[0] for c in values]

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

    def _double(self, rows: Residues, a: Residues, y: Residues, b: Residues) -> Residues:
        """[[u, a], [y, b]] for the rows u."""
        (bracket,) = product(b[None], self._ad(y), self.p)
        return product(product(rows, self._ad(a), self.p), self._ad(bracket), self.p)

    def _random(self, rows: Residues, count: int) -> Residues:
        return product(self.rng.integers(self.p, size=(count, len(rows))).astype(np.float64), rows, self.p)

    def _kernel(self, rows: Residues, images: Residues) -> Residues:
        """A basis of the combinations of rows for which the same combination of images is 0."""
        return product(left_kernel(images, self.p).astype(np.float64), rows, self.p)

    def _is_nondegenerate(self, rows: Residues) -> bool:
        """Whether the dot product is not degenerate on the span of independent rows."""
        return len(ModularSpan(self.p, len(rows)).extend(product(rows, rows.T, self.p))) == len(rows)
