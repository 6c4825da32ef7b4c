"""A check of the key of a full pair that shares only scalars and the bracket table with its computation.

The entries of the key are checked by other definitions. The ideal is largest if the covectors that vanish on h generate
a space of dimension dim g - dim n under the coadjoint action. S is spanned by the brackets of h. A map T that commutes
with S is determined by y = T x at a point x that S moves in enough directions. Elements of S that annihilate x
annihilate y. The centre of rho(h) consists of elements z of h with rho([z, h]) = 0. The letter A is shown by an abelian
ideal that complements h, the others by a Killing form that is regular modulo a prime.
"""

from __future__ import annotations

import random
from collections.abc import Sequence

from liehom.base.errors import CertificateError, InputError, InternalError, displayed
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.fullness.classification_rows import Key, row_of
from liehom.exact.representations.core.pair import Pair
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix, as_exact
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.modular import invariant_hull_rank
from liehom.exact.scalars.subspaces import Subspace, echelon_quotient

PRIME = 5
"""Number of the prime, which is not the one of the computation."""
TRIES = 5
"""Random choices before a check fails."""


def verify_key(pair: Pair, key: Key, ideal: Subspace) -> None:
    """Raise `CertificateError` unless the ideal and the key are those of the full pair."""
    if not isinstance(pair, Pair) or not isinstance(pair.field, ExactField):
        raise InputError(f"expected a pair over an exact field, got {displayed(pair)}")
    if ideal.field != pair.field or ideal.ambient != pair.algebra.dimension:
        raise CertificateError("ideal", "it is a subspace of another algebra, or over another field")
    if row_of(key) is None:
        raise CertificateError("key", f"{displayed(tuple(key))} is in no row of the classification")
    _check_ideal(pair, ideal)
    effective = _Effective(pair, ideal)
    _agree("d", key.d, effective.d)
    _agree("s", key.s, len(effective.derived))
    _agree("e", key.e, effective.commutant_dimension())
    centre, square = effective.centre()
    _agree("centre", key.centre, centre)
    letter, sign = effective.letter()
    _agree("letter", key.letter, letter)
    _agree("parameter", key.parameter, sign if square is None else square)


def _agree(what: str, said: object, actual: object) -> None:
    if said != actual:
        raise CertificateError(what, f"the key says {displayed(said)}, the pair has {displayed(actual)}")


def _check_ideal(pair: Pair, ideal: Subspace) -> None:
    """The subspace is an ideal, lies in h, and no larger ideal does."""
    g, h = pair.algebra, pair.subalgebra
    field: ExactField = ideal.field  # type: ignore[assignment]
    if not h.subspace.includes(ideal):
        raise CertificateError("ideal", "it is not contained in h")
    across = ideal.basis.null_space().T
    if g.table.first_nonzero(ideal.basis, field.identity(g.dimension), across) is not None:
        raise CertificateError("ideal", "the subspace is not an ideal of g")
    rng, covectors = random.Random(3), as_exact(h.basis).null_space()
    some = [g.table.adjoint(_random_row(field, g.dimension, rng)) for _ in range(min(3, g.dimension))]
    if invariant_hull_rank(covectors, some) == g.dimension - ideal.dimension:
        return
    every = [g.table.adjoint(field.unit(g.dimension, i)) for i in range(g.dimension)]
    if invariant_hull_rank(covectors, every) != g.dimension - ideal.dimension:
        raise CertificateError("ideal", "h contains a larger ideal of g")


def _random_row(field: ExactField, n: int, rng: random.Random) -> ExactMatrix:
    return field.from_integers([rng.randint(-9, 9) for _ in range(n)], 1, n)


def _flat(field: ExactField, matrices: Sequence[ExactMatrix], d: int) -> ExactMatrix:
    return field.stack_rows([a.reshape(1, d * d) for a in matrices], d * d)


def _sum(matrices: Sequence[ExactMatrix], weights: Sequence[Scalar]) -> ExactMatrix:
    """The sum of w_i A_i over at least one matrix."""
    first, *rest = (a.scale(w) for a, w in zip(matrices, weights, strict=True))
    return sum(rest, first)


class _Effective:
    """The quotient of a pair by an ideal, in a basis of which the first r elements span h and the other d do not."""

    def __init__(self, pair: Pair, ideal: Subspace) -> None:
        self.field: ExactField = ideal.field  # type: ignore[assignment]
        n, k = pair.algebra.dimension, ideal.dimension
        self.d, self.r = pair.dimension, pair.subalgebra.dimension - k
        over, dual = self._bases(as_exact(ideal.basis), as_exact(pair.subalgebra.basis))
        self.algebra = LieAlgebra(pair.algebra.table.changed(over, dual), check=False)  # n is an ideal
        self.n, self.rng = n - k, random.Random(n)
        one = self.field.identity(self.n)
        self.inner, self.outer = one.select(rows=range(self.r)), one.select(rows=range(self.r, self.n))
        blocks = self.algebra.table.contract(self.inner, self.outer, self.outer.T)
        self.rho: list[ExactMatrix] = [block.T for block in blocks]
        self.flat = _flat(self.field, self.rho, self.d)
        self.derived = self._derived()

    def _bases(self, ideal: ExactMatrix, h: ExactMatrix) -> tuple[ExactMatrix, ExactMatrix]:
        """A basis of a complement of the ideal, first in h, and the coordinates in it; no matrix is inverted.

        In reduced echelon form the pivots of h include those of the ideal; unit vectors complete h to g.
        """
        modulo, outside = echelon_quotient(ideal), echelon_quotient(h)
        free, others = modulo.lift.echelon()[1], set(outside.lift.echelon()[1])  # unit vectors off the pivots
        pivots = [j for j in range(h.ncols) if j not in others]
        inside = outside.subspace.select(rows=[i for i, pivot in enumerate(pivots) if pivot in set(free)])
        coordinates = modulo.projection.select(columns=[i for i, j in enumerate(free) if j not in others])
        return (
            self.field.stack_rows([inside, outside.lift], h.ncols),
            self.field.stack_columns([coordinates, outside.projection], h.ncols),
        )

    def _derived(self) -> list[ExactMatrix]:
        """A basis of S: the images of all brackets of h."""
        rows = self._brackets(self.inner) @ self.inner.T
        return (rows @ self.flat).row_space().split_rows(self.d, self.d) if rows.nrows else []

    def _brackets(self, space: ExactMatrix) -> ExactMatrix:
        """A basis of the span of the brackets of a subalgebra; those with a few random elements may suffice."""
        table, field = self.algebra.table, self.field
        some = field.stack_rows([_random_row(field, space.nrows, self.rng) @ space for _ in range(3)], self.n)
        span = table.bracket_rows(some, space).row_space()
        if table.first_nonzero(space, space, span.null_space().T) is None:
            return span
        return table.bracket_rows(space, space).row_space()

    # -- the commutant of S ------------------------------------------------------------------------------
    def commutant_dimension(self) -> int:
        if not self.derived:
            return self.d**2
        for _ in range(TRIES):
            x = _random_row(self.field, self.d, self.rng).T
            moved = self.field.stack_columns([x, *(a @ x for a in self.derived)], self.d)
            pivots = moved.echelon()[1]
            if len(pivots) == self.d:
                return self._extending(x, moved.select(columns=pivots).inverse(), pivots)
        raise CertificateError("e", "S moves sample points in too few directions")

    def _extending(self, x: ExactMatrix, inverse: ExactMatrix, columns: list[int]) -> int:
        """Number of independent y in V for which x -> y extends to a map that commutes with S."""
        still = self.field.stack_columns([a @ x for a in self.derived], self.d).null_space()
        some = [self._element(still) for _ in range(4)] if still.nrows else []
        fixed = self.field.stack_rows(some, self.d).null_space() if some else self.field.identity(self.d)
        points = [fixed.select(rows=[i]).T for i in range(fixed.nrows)]
        images = [self.field.stack_columns([y, *(a @ y for a in self.derived)], self.d) for y in points]
        maps = [moved.select(columns=columns) @ inverse for moved in images]
        if any(t @ a != a @ t for t in maps for a in self.derived):
            raise CertificateError("e", "a vector fixed by the stabilizer of a point has no map that commutes with S")
        return len(maps)

    def _element(self, rows: ExactMatrix) -> ExactMatrix:
        """A random combination of rows of coefficients, as an element of S."""
        return _sum(self.derived, (_random_row(self.field, rows.nrows, self.rng) @ rows).entries())

    # -- the centre of rho(h) ----------------------------------------------------------------------------
    def centre(self) -> tuple[str, Scalar | None]:
        """The centre of rho(h) as the key names it, and c^2 of a spiral."""
        central = (self._commuting() @ self.flat).row_space()
        matrices = central.split_rows(self.d, self.d) if central.nrows else []
        if len(matrices) != 1:
            return {0: "", 2: "C"}.get(len(matrices), "?"), None
        (z,) = matrices
        t = z.trace() / self.d
        z0 = z - self.field.identity(self.d).scale(t)
        if z0.is_zero():
            return "R", None
        return ("J", None) if t == 0 else ("J+c", -t * t / (z0 @ z0)[0, 0])

    def _commuting(self) -> ExactMatrix:
        """Rows of coefficients z in the basis of h with rho([z, h]) = 0."""
        table, space = self.algebra.table, self.inner
        for _ in range(TRIES):
            other = _random_row(self.field, self.r, self.rng) @ self.inner
            acting = self.field.stack_rows(table.contract(space, other, self.inner.T), self.r) @ self.flat
            space = acting.left_null_space() @ space
        blocks = table.contract(space, self.inner, self.inner.T) if space.nrows else []
        if not all((block @ self.flat).is_zero() for block in blocks):
            raise CertificateError("centre", "elements of h that commute with random ones are not central")
        return space @ self.inner.T

    # -- the letter --------------------------------------------------------------------------------------
    def letter(self) -> tuple[str, int | None]:
        if self._has_flat_complement():
            return "A", None
        form = self._killing_form()
        if int(form.modulo(PRIME).rank()) < self.n:
            return "?", None
        if self.flat.rank() < self.r:
            return "B", None
        across = (form.select(rows=range(self.r))).null_space()
        v = _random_row(self.field, across.nrows, self.rng) @ across
        return "C", -self.field.sign((v @ form @ v.T)[0, 0])

    def _killing_form(self) -> ExactMatrix:
        """The Killing form, which is compared with its definition at random elements."""
        form = as_exact(self.algebra.killing_form())
        x, y = (_random_row(self.field, self.n, self.rng) for _ in range(2))
        if (x @ form @ y.T)[0, 0] != (self.algebra.table.adjoint(x) @ self.algebra.table.adjoint(y)).trace():
            raise InternalError("the Killing form does not agree with its definition; please report this pair")
        return form

    def _has_flat_complement(self) -> bool:
        """Whether [g, rad g] (for g = R, g) is an abelian ideal that complements h; rad g by Cartan's criterion."""
        one, table = self.field.identity(self.n), self.algebra.table
        if self.n == self.d <= 1:
            return True
        radical = (self._brackets(one) @ self._killing_form()).null_space()
        if not radical.nrows:
            return False
        flat = table.bracket_rows(radical, one).row_space()
        return (
            flat.nrows == self.d == int((flat @ self.outer.T).rank())
            and table.first_nonzero(flat, one, flat.null_space().T) is None
            and table.first_nonzero(flat, flat, one) is None
        )
