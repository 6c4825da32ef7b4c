"""Conjugacy of isotropy subalgebras: invariants, a search and proofs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import CertificateError
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.representations.analysis.submodules import semisimple_defect
from liehom.exact.representations.core.representation import Representation
from liehom.exact.representations.invariants.intertwiners import InvariantForms, invariant_vectors
from liehom.exact.representations.invariants.irreducibility import combination, trace_form
from liehom.exact.scalars.exact_field import ExactMatrix, as_exact
from liehom.exact.scalars.rational import working_precision
from liehom.exact.scalars.roots import Ball, BallMatrix, ball_matrix, frobenius_bound

# Different invariants under inner automorphisms of g prove that two subalgebras are not conjugate.  An inner
# automorphism maps every ideal of g to itself, acts trivially on the centre and on g/[g, g], and preserves the Killing
# form of g and the forms tr rho(x) rho(y).  Where h has a characteristic line (h itself, its centre, a term of a
# series), the characteristic polynomials on the line are invariants up to the scalings of the line.

Value = tuple[object, ...]
# Coefficients of the combinations of the forms: any fixed numbers give invariants, unequal ones give more of them.
COMBINATIONS = ((1, 3, 7, 19, 31, 43, 61, 83), (2, -3, 5, -11, 13, -17, 23, -29))


@final
@dataclass(frozen=True)
class ConjugacyInvariants:
    """Computes invariants under inner automorphisms of subalgebras of the algebra of one representation.

    Examples
    --------
    >>> import liehom as lh
    >>> rho = lh.defining(lh.so(2, 1))
    >>> of = ConjugacyInvariants(rho)
    >>> spacelike, timelike = (of(rho.isotropy(x)) for x in ([1, 0, 0], [0, 0, 1]))
    >>> [name for name in spacelike if spacelike[name] != timelike[name]][:1]
    ['Killing form of g']
    """

    rho: Representation

    def __call__(self, h: Subalgebra) -> dict[str, Value]:
        """Invariants of a subalgebra, by name; their order and the names depend on the representation only."""
        own = h.as_algebra()
        matrices = [as_exact(self.rho(row)) for row in h.rows()]
        forms = self._forms(h, own, matrices)
        image = h.basis @ self.rho.algebra.derived_subalgebra().subspace.quotient_map()[1]
        return self._dimensions(h, own, matrices) | {
            **{name: form.signature() for name, form in forms.items()},
            "forms together": _pencil(list(forms.values())) if h.dimension else (),
            "invariant forms on fixed vectors": self._on_fixed_vectors(matrices),
            # the canonical basis of the image of h in g/[g, g]
            "place modulo the derived algebra": tuple(map(tuple, image.row_space().to_rows())),
            "characteristic lines": tuple(self._line(line @ as_exact(h.basis)) for line in _lines(own)),
        }

    def _dimensions(self, h: Subalgebra, own: LieAlgebra, matrices: list[ExactMatrix]) -> dict[str, Value]:
        g, field, size = self.rho.algebra, self.rho.field, self.rho.size
        fixed, moved = (stack(matrices, size).rank() for stack in (field.stack_rows, field.stack_columns))
        return {
            "derived series": tuple(term.dimension for term in own.derived_series()),
            "central series": tuple(t.dimension for t in (*own.lower_central_series(), *own.upper_central_series())),
            "normalizer and centralizer": (g.normalizer(h).dimension, g.centralizer(h).dimension),
            "fixed and moved vectors": (size - fixed, moved),
            "ideals": tuple(h.subspace.intersection(ideal.subspace).dimension for ideal in self._ideals),
            "centre": tuple(tuple(r) for r in h.subspace.intersection(g.center().subspace).rows()),
        }

    def _forms(self, h: Subalgebra, own: LieAlgebra, matrices: list[ExactMatrix]) -> dict[str, ExactMatrix]:
        if not h.dimension:
            return {}
        rows = as_exact(h.basis)
        return {
            "Killing form": as_exact(own.killing_form()),
            "Killing form of g": rows @ self._killing @ rows.T,
            "trace form": trace_form(matrices),
            **{f"Killing form of ideal {i}": rows @ form @ rows.T for i, form in enumerate(self._ideal_forms)},
        }

    def _on_fixed_vectors(self, matrices: list[ExactMatrix]) -> Value:
        """Signatures of the invariant forms of V, which the group preserves, on the vectors that h annihilates."""
        fixed = as_exact(invariant_vectors(matrices, self.rho.size, self.rho.field).basis)
        if not 0 < fixed.nrows < self.rho.size:
            return ()
        signatures = ((fixed @ form @ fixed.T).signature() for form in self._invariant_forms.symmetric)
        return (*signatures, *((fixed @ form @ fixed.T).rank() for form in self._invariant_forms.skew))

    def _line(self, x: ExactMatrix) -> Value:
        return _up_to_scale([as_exact(self.rho.algebra.ad(x)), as_exact(self.rho(x.row(0)))])

    @cached_property
    def _invariant_forms(self) -> InvariantForms:
        return self.rho.invariant_forms()

    @cached_property
    def _killing(self) -> ExactMatrix:
        return as_exact(self.rho.algebra.killing_form())

    @cached_property
    def _ideals(self) -> list[Subalgebra]:
        """Ideals that all inner automorphisms preserve: terms of series, the radical, simple ideals over the field."""
        g = self.rho.algebra
        ideals = [g.radical(), *g.derived_series()[1:], *g.lower_central_series()[2:], *g.upper_central_series()]
        return ideals + self._simple

    @cached_property
    def _simple(self) -> list[Subalgebra]:
        g = self.rho.algebra
        return g.direct_sum_decomposition() if g.dimension and g.is_semisimple() else []

    @cached_property
    def _ideal_forms(self) -> list[ExactMatrix]:
        """The Killing forms of the simple ideals as forms on g, if there are several ideals."""
        if len(self._simple) < 2:
            return []
        n, field = self.rho.algebra.dimension, self.rho.field
        coordinates = field.stack_rows([as_exact(ideal.basis) for ideal in self._simple], n).inverse()
        forms, start = [], 0
        for ideal in self._simple:
            places = range(start, start := start + ideal.dimension)
            part = coordinates.select(columns=places) @ as_exact(ideal.basis)  # x -> its component in the ideal
            forms.append(part @ self._killing @ part.T)
        return forms


def _lines(own: LieAlgebra) -> Iterator[ExactMatrix]:
    """Characteristic lines of a Lie algebra, as rows of coordinates; the order depends on invariants only."""
    if own.dimension == 1:
        return iter([as_exact(own.whole().basis)])
    terms = [own.center(), *own.derived_series()[1:], *own.lower_central_series()[2:]]
    return (as_exact(term.basis) for term in terms if term.dimension == 1)


def _pencil(forms: Sequence[ExactMatrix]) -> Value:
    """Signatures of combinations B of forms B_i, and the characteristic polynomials of B^-1 B_i where B is regular."""
    invariants: list[object] = []
    for numbers in COMBINATIONS:
        total = combination(forms, [numbers[i % len(numbers)] + i // len(numbers) for i in range(len(forms))])
        invariants.append(total.signature())
        if not total.signature()[2]:
            inverse = total.inverse()
            invariants += [tuple((inverse @ form).characteristic_coefficients()) for form in forms]
    return tuple(invariants)


def _up_to_scale(matrices: Sequence[ExactMatrix]) -> Value:
    """Invariants of matrices A_i up to conjugation and one common real factor: spectra, and the size of Jordan blocks.

    A factor c multiplies the coefficient v of weight k of a characteristic polynomial by c^k. With the first v_0 != 0,
    of weight k_0, the numbers v^(k_0) / v_0^k are invariant; so are the signs of v for even k, and the products of the
    signs of two v of odd weight.
    """
    sign = matrices[0].field.sign
    ranks = [(*_ranks(a), *_ranks(semisimple_defect(a))) for a in matrices]
    weighted = [(k, v) for a in matrices for k, v in enumerate(a.characteristic_coefficients()[::-1]) if k]
    nonzero = [(k, v) for k, v in weighted if v != 0]
    if not nonzero:
        return tuple(ranks)
    k0, v0 = nonzero[0]
    odd = next((sign(v) for k, v in nonzero if k % 2), 1)
    return (*ranks, *((v**k0 / v0**k, sign(v) * (odd if k % 2 else 1)) for k, v in weighted))


def _ranks(a: ExactMatrix) -> list[int]:
    """The ranks of A, A^2, ..., until they stay equal."""
    ranks, power = [a.nrows, a.rank()], a
    while ranks[-1] != ranks[-2]:
        power = power @ a
        ranks.append(power.rank())
    return ranks


# Let g' be g, or g with the multiplications by scalars, and h' the isotropy of y in g'.  Suppose that every vector of V
# / g'y that h' fixes comes from a vector of V that h' fixes.  Then every point near y whose isotropy in g' has the same
# dimension has an isotropy conjugate to h'.  Proof: let m be a complement of h' in g', and N = N_0 + N_1 a complement
# of g'y in V, where h' annihilates N_0 and N_0 spans the fixed vectors of V / g'y.  By the inverse function theorem a
# point near y is exp(xi) (y + n) with n = n_0 + n_1 in N.  If the isotropy of y + n has the dimension of h', then for
# each eta in h' there is a zeta in m with (eta + zeta)(y + n) = 0, of size O(|n_1|).  Modulo g'y this reads eta n_1 =
# O(|n| |n_1|), but |eta n_1| >= c |n_1| for some eta.  Hence n_1 = 0, and h' is the isotropy of y + n_0.
#
# `verify` computes all constants in ball arithmetic, for a group element given by the search in `conjugacy_search`.

PRECISION = 192
Row = tuple[Fraction, ...]


@final
@dataclass(frozen=True, slots=True, repr=False)
class ConjugacyProof:
    """Evidence that a group element maps the isotropy of `x` to that of `y`.

    Attributes
    ----------
    representation : Representation
    x, y : tuple of field elements
        The points.
    factor : Fraction
        Not zero.
    steps : tuple of tuples of Fraction
        Elements of g. The product of their exponentials, the last one on the left, maps ``factor * x`` close to the
        point ``target``.
    target : tuple of Fraction
        Coordinates in the canonical basis of the space of vectors that the isotropy of y fixes.
    complement : tuple of tuples of int
        Indices of basis elements of g' that span a complement of h', of vectors of that basis that span N_0, and of
        standard basis vectors that span N_1.
    scaled : bool
        Whether g' includes the multiplications by scalars.
    """

    representation: Representation
    x: tuple[Any, ...]
    y: tuple[Any, ...]
    factor: Fraction
    steps: tuple[Row, ...]
    target: Row
    complement: tuple[tuple[int, ...], tuple[int, ...], tuple[int, ...]]
    scaled: bool

    def verify(self) -> bool:
        """True if the isotropy subalgebras of x and y are proved to be conjugate; else raises `CertificateError`."""
        action = ScaledAction(self.representation, scaled=self.scaled)
        dimensions = [action.isotropy(p).nrows for p in (self.x, self.y)]
        if dimensions[0] != dimensions[1]:
            raise CertificateError("dimension", f"the isotropy has dimensions {dimensions[0]} and {dimensions[1]}")
        if self.factor == 0:
            raise CertificateError("factor", "the factor is 0")
        with working_precision(PRECISION):
            try:
                proved = _is_near(self, action)
            except ZeroDivisionError:  # flint: a matrix is singular to this precision
                proved = False
        if not proved:
            raise CertificateError("distance", "the image of x is not close enough to the points fixed by h'")
        return True

    def __repr__(self) -> str:
        return f"<proof in {len(self.steps)} steps that the isotropies of two points are conjugate>"


@final
class ScaledAction:
    """The matrices of g, or of g and the multiplications by scalars, on V."""

    def __init__(self, representation: Representation, *, scaled: bool) -> None:
        self.representation = representation
        self.matrices = [as_exact(a) for a in representation.matrices]
        if scaled:
            self.matrices.append(as_exact(representation.field.identity(representation.size)))

    def isotropy(self, point: Sequence[Any]) -> ExactMatrix:
        """Rows of coordinates of the elements that annihilate a point."""
        return self.moved(point).left_null_space()

    def moved(self, point: Sequence[Any]) -> ExactMatrix:
        """The matrix with rows A_i point."""
        field, size = self.representation.field, self.representation.size
        column = field.matrix([list(point)], (1, size)).T
        return as_exact(field.stack_rows([(a @ column).T for a in self.matrices], size))

    def isotropy_matrices(self, point: Sequence[Any]) -> list[ExactMatrix]:
        """A basis of the matrices of the isotropy h' of a point, without zeros."""
        size = self.representation.size
        flat = self.representation.field.stack_rows([a.reshape(1, size**2) for a in self.matrices], size**2)
        return [as_exact(a) for a in (self.isotropy(point) @ flat).row_space().split_rows(size, size)]

    def fixed(self, point: Sequence[Any]) -> ExactMatrix:
        """The canonical basis of the vectors that the isotropy of a point annihilates."""
        matrices, rho = self.isotropy_matrices(point), self.representation
        return as_exact(rho.field.stack_rows(matrices, rho.size).null_space())


def _is_near(proof: ConjugacyProof, action: ScaledAction) -> bool:
    """Whether the image of x lies in the neighbourhood of the target that the theorem above gives."""
    rho = proof.representation
    balls = [ball_matrix(a, PRECISION) for a in action.matrices]
    fixed = action.fixed(proof.y)
    y = ball_matrix(as_exact(rho.field.matrix([list(proof.target)], (1, fixed.nrows))) @ fixed, PRECISION).transpose()
    z = ball_matrix(as_exact(rho.field.matrix([list(proof.x)], (1, rho.size)).T).scale(proof.factor), PRECISION)
    for step in proof.steps:
        z = ball_matrix(as_exact(rho(step)), PRECISION).exp() * z
    moving, n_0, n_1 = proof.complement
    standard = as_exact(rho.field.identity(rho.size))
    parts = [ball_matrix(fixed.select(rows=n_0), PRECISION), ball_matrix(standard.select(rows=n_1), PRECISION)]
    frame = [(balls[i] * y).entries() for i in moving] + [row for part in parts for row in part.tolist()]
    if len(moving) + action.isotropy(proof.y).nrows != len(action.matrices) or len(frame) != rho.size:
        return False
    inverse = type(y)(frame).transpose().inv()
    isotropy = [ball_matrix(a, PRECISION) for a in action.isotropy_matrices(proof.y)]
    kappa, epsilon, size = frobenius_bound(inverse), frobenius_bound(z - y), frobenius_bound(y)
    alpha = _norm([balls[i] for i in moving])
    beta, nu, nu_1 = _norm(isotropy), _norm(parts), frobenius_bound(parts[1])
    delta = 2 * kappa * epsilon  # |(c, p, q)| <= delta, where z = exp(sum c_i A_i) (y + n(p, q))
    growth = (alpha * delta).exp()
    lipschitz = alpha * (growth - 1) * size + alpha * growth * nu * delta + (growth - 1) * nu
    s = nu * delta  # at least |n_0| + |n_1|
    gap = 1 / kappa - alpha * s
    if not (2 * kappa * lipschitz < 1 and gap > 0):
        return False
    if not n_1 or not isotropy:
        return not n_1
    return bool(_slope(inverse, isotropy, parts[1], len(moving)) * kappa * alpha * s * beta * nu_1 < gap)


def _slope(inverse: BallMatrix, isotropy: Sequence[BallMatrix], n_1: BallMatrix, start: int) -> Ball:
    """A number c with |q| <= c |(eta_i n_1(q) mod g'y)_i| for all q, and at least one eta_i."""
    quotient = type(inverse)(inverse.tolist()[start:])
    stacked = type(inverse)([row for a in isotropy for row in (quotient * a * n_1.transpose()).tolist()])
    square = stacked.transpose() * stacked
    return frobenius_bound(square.inv() * stacked.transpose())


def _norm(matrices: Sequence[BallMatrix]) -> Ball:
    """Upper bound of the square root of the sum of the squares of Frobenius norms."""
    total: Ball = sum((frobenius_bound(a) ** 2 for a in matrices), Ball(0))
    return total.sqrt().upper()


# Search for a group element that conjugates the isotropy subalgebras of two points, by Gauss-Newton steps in floats.
#
# If g maps h'_x to h'_y, then g x lies in the space W of vectors that h'_y fixes.  The search moves x towards W; what
# it proposes is proved by `ConjugacyProof.verify`.

STARTS = (12, 96)  # at least, and at most
STARTS_TIMES_DIMENSION = 3000
STEPS = 60
STALL = 8  # steps without progress of a percent: a local minimum
RESIDUAL = 1e-13
Array = npt.NDArray[np.float64]


def prove_conjugate(rho: Representation, x: Sequence[Any], y: Sequence[Any]) -> ConjugacyProof | None:
    """Proof that the isotropy subalgebras of two points are conjugate under inner automorphisms, or None."""
    points = [_without_fixed_part(rho, p) for p in (x, y)]
    for scaled in (False, True):
        action = ScaledAction(rho, scaled=scaled)
        if len({action.isotropy(p).nrows for p in points}) == 2:
            continue
        search = _Search(action, points[0], points[1])
        if search.slice_is_fixed() and (proof := search.run()) is not None:
            return proof
    return None


def _without_fixed_part(rho: Representation, point: Sequence[Any]) -> tuple[Any, ...]:
    """The component of a point in g V, which has the same isotropy, if V is the sum of V^g and g V."""
    row = rho.field.matrix([list(point)], (1, rho.size))
    fixed = rho.invariant_vectors().basis
    if fixed.nrows:
        moved = rho.field.stack_rows([a.T for a in rho.matrices], rho.size).row_space()
        both = rho.field.stack_rows([fixed, moved], rho.size)
        if both.rank() == both.nrows:
            row = (row @ both.inverse()).select(columns=range(fixed.nrows, rho.size)) @ moved
    return tuple(row.row(0))


class _Search:
    """Gauss-Newton steps that move x into the space W of the vectors that h'_y fixes."""

    def __init__(self, action: ScaledAction, x: tuple[Any, ...], y: tuple[Any, ...]) -> None:
        self.action, self.x, self.y = action, x, y
        rho = action.representation
        self.matrices = np.array([a.to_numpy() for a in action.matrices]).reshape(-1, rho.size, rho.size)
        self.count = rho.algebra.dimension
        self.basis = action.fixed(y).to_numpy()
        self.isotropy = np.array([a.to_numpy() for a in action.isotropy_matrices(y)]).reshape(-1, rho.size, rho.size)
        frame = np.linalg.qr(self.basis.T)[0]
        self.outside = np.eye(rho.size) - frame @ frame.T
        self.start = np.array([rho.field.to_float(v) for v in x])
        self.goal = np.array([rho.field.to_float(v) for v in y])

    def slice_is_fixed(self) -> bool:
        """Whether (in floats) the vectors of V / g'y that h'_y fixes come from vectors that h'_y fixes."""
        chosen = self.complement(self.goal)
        return chosen is not None and self._slope(self.goal, chosen) > 1e-7

    def run(self) -> ConjugacyProof | None:
        """The first verified proof from a few initial group elements."""
        rng = np.random.default_rng(0)
        for attempt in range(min(max(STARTS[0], STARTS_TIMES_DIMENSION // max(self.count, 1)), STARTS[1])):
            size = 2.0 ** (attempt % 4) / (1 + np.sqrt(self.count))
            proposal = self._descend([rng.normal(size=self.count) * size] if attempt else [])
            with suppress(CertificateError):
                if proposal is not None and proposal.verify():
                    return proposal
        return None

    def _descend(self, steps: list[Array]) -> ConjugacyProof | None:
        from scipy.linalg import expm

        z = self.start / (np.linalg.norm(self.start) or 1.0)
        for step in steps:
            z = expm(np.tensordot(step, self.matrices[: self.count], 1)) @ z
        damping, residual = 1e-3, self._residual(z)
        history = [residual]
        for _ in range(STEPS):
            if residual < RESIDUAL or (len(history) > STALL and residual > 0.99 * history[-STALL]):
                break
            unit = z / np.linalg.norm(z)
            moved = (self.matrices[: self.count] @ unit).T
            jacobian = self.outside @ (moved - np.outer(unit, unit @ moved))  # of P z / |z|
            gram = jacobian.T @ jacobian
            right = -jacobian.T @ (self.outside @ unit)
            step = np.linalg.lstsq(gram + damping * residual * np.eye(self.count), right, rcond=1e-14)[0]
            step *= min(1.0, 1.0 / max(float(np.linalg.norm(step)), 1e-300))
            moved = expm(np.tensordot(step, self.matrices[: self.count], 1)) @ z
            if not np.isfinite(moved).all():
                return None
            if (value := self._residual(moved)) < residual:
                z, residual, damping = moved, value, damping / 5
                steps.append(step)
                history.append(residual)
            elif (damping := damping * 10) > 1e6:
                break
        return self._proposal(z, steps) if residual < 1e-9 else None

    def _residual(self, z: Array) -> float:
        return float(np.linalg.norm(self.outside @ z) / (np.linalg.norm(z) or 1.0))

    def _proposal(self, z: Array, steps: list[Array]) -> ConjugacyProof | None:
        chosen = self.complement(z)
        if chosen is None:
            return None
        target = np.linalg.lstsq(self.basis.T, z, rcond=None)[0]
        return ConjugacyProof(
            self.action.representation,
            self.x,
            self.y,
            Fraction(float(1 / (np.linalg.norm(self.start) or 1.0))),
            tuple(tuple(Fraction(float(c)) for c in step) for step in steps),
            tuple(Fraction(float(c)) for c in target),
            chosen,
            len(self.matrices) > self.count,
        )

    def complement(self, z: Array) -> tuple[tuple[int, ...], tuple[int, ...], tuple[int, ...]] | None:
        """Elements that move z independently, fixed vectors independent modulo these, and standard basis vectors."""
        moved = self.matrices @ z
        moving = _independent(moved, np.zeros((0, z.size)))
        n_0 = _independent(self.basis, moved[moving])
        n_1 = _independent(np.eye(z.size), np.concatenate([moved[moving], self.basis[n_0]]))
        if len(moving) != len(self.matrices) - self.action.isotropy(self.y).nrows:
            return None
        return tuple(moving), tuple(n_0), tuple(n_1)

    def _slope(self, z: Array, chosen: tuple[tuple[int, ...], tuple[int, ...], tuple[int, ...]]) -> float:
        """The least singular value of q -> eta_i n_1(q) modulo g'z, relative to the matrices; inf if N_1 is 0."""
        moving, _, n_1 = (list(places) for places in chosen)
        if not n_1:
            return np.inf
        if not len(self.isotropy):
            return 0.0
        tangent = np.linalg.qr((self.matrices[moving] @ z).T)[0] if moving else np.zeros((z.size, 0))
        images = self.isotropy[:, :, n_1]
        images = images - tangent @ (tangent.T @ images)
        stacked = images.reshape(-1, len(n_1)) if images.size else np.zeros((0, len(n_1)))
        if len(stacked) < len(n_1):
            return 0.0
        return float(np.linalg.svd(stacked, compute_uv=False)[-1] / np.linalg.norm(self.isotropy))


def _independent(rows: Array, others: Array) -> list[int]:
    """Indices of rows, chosen by pivots, that are independent of the others and of each other."""
    left = np.array(rows, dtype=float)
    for row in np.linalg.qr(others.T)[0].T if len(others) else ():
        left -= np.outer(left @ row, row)
    norms = np.linalg.norm(rows, axis=1) if len(rows) else np.zeros(0)
    scale = max(norms.max(initial=0.0), 1e-300)
    chosen: list[int] = []
    while len(left):
        lengths = np.linalg.norm(left, axis=1)
        best = int(np.argmax(lengths))
        if lengths[best] <= 1e-8 * scale:
            break
        chosen.append(best)
        direction = left[best] / lengths[best]
        left -= np.outer(left @ direction, direction)
    return chosen
