"""The cone on which the range condition fails: its equation, certified subsets, and the open orbits around it."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import permutations
from math import comb, isqrt, prod
from typing import Any, Protocol, cast, final

import numpy as np

from liehom.base.errors import FieldError, InputError, ShapeError, UndecidedError
from liehom.base.typing import Array, VectorLike
from liehom.exact.algebra.linear.closure import lie_closure
from liehom.exact.algebra.roots.real_form import RealForm
from liehom.exact.algebra.structure.identification import real_forms_of
from liehom.exact.orbits.range import pencil, range_condition
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.invariants.intertwiners import commutant, invariant_forms
from liehom.exact.representations.invariants.irreducibility import combination, trace_radical, traceless
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.field import Matrix, MatrixLike, Scalar
from liehom.exact.scalars.polynomial_matrix import LinearForms, rank_losses_on_line
from liehom.exact.scalars.rational import QQ

# Let M(x) = [A_1 x, ..., A_m x], A_i a basis of L = rho(h) + R, and let rank M(x) = d for generic x.  An irreducible p
# divides all d x d minors if and only if it divides one of them and is a relative invariant of L.  The connected group
# of L permutes the zeros of a common divisor, so a common divisor is a relative invariant.  Conversely grad p
# annihilates L x on p = 0, so the rank is less than d there.  Hence one minor determines the product below exactly.

MAX_DIMENSION = 8


@final
@dataclass(frozen=True, slots=True, repr=False)
class RelativeInvariant:
    """The product f of the distinct irreducible polynomials over QQ that divide all d x d minors of M(x).

    Attributes
    ----------
    pair : Pair
    factors : tuple of flint.fmpq_mpoly
        In the variables x0, ..., x(d-1), the coordinates of psi mod h by ``pair.coordinates``.

    Notes
    -----
    The range condition fails where f vanishes. The other points where it fails have codimension at least 2 (over the
    complex numbers too). f is the radical of the greatest common divisor of the minors. Its complex zeros are a
    hypersurface. Its real zeros have codimension 1 if and only if f changes sign. For a full pair f may be a definite
    form, whose only real zero is 0.

    Examples
    --------
    >>> import liehom as lh
    >>> print(relative_invariant(lh.Pair(lh.so(3), [[0, 0, 1]])))
    x0^2 + x1^2
    """

    pair: Pair
    factors: tuple[Any, ...]

    @property
    def degree(self) -> int:
        """Degree of f, an int; 0 if all failures, also over the complex numbers, have codimension at least 2."""
        return sum(int(p.total_degree()) for p in self.factors)

    def __call__(self, psi: VectorLike) -> Scalar:
        """The value of f at an element psi of g."""
        x, field = self.pair.coordinates(psi).row(0), self.pair.field
        terms = ([(c, zip(x, powers, strict=True)) for powers, c in p.to_dict().items()] for p in self.factors)
        values = (sum((prod((v**e for v, e in powers), start=c) for c, powers in term), field.zero) for term in terms)
        return prod(values, start=field.one)

    def __str__(self) -> str:
        texts = [str(p) for p in self.factors]
        return texts[0] if len(texts) == 1 else "*".join(f"({t})" for t in texts) or "1"

    def __repr__(self) -> str:
        return f"<relative invariant {self}>"


def relative_invariant(pair: Pair, max_dimension: int = MAX_DIMENSION) -> RelativeInvariant | None:
    """The relative invariant f of a pair; None if the range condition holds nowhere, or d = 0.

    The range condition fails where f = 0, and elsewhere in codimension 2 or more.

    Parameters
    ----------
    pair : Pair
        Over QQ.
    max_dimension : int
        Largest admissible dimension d of g/h: the minors have degree d in d variables.

    Examples
    --------
    The failures of so(3,1)/so(2,1) are the null cone:

    >>> import liehom as lh
    >>> print(relative_invariant(lh.defining(lh.so(3, 1)).pair([1, 0, 0, 0])))
    x0^2 + x1^2 - x2^2
    """
    require_rational(pair)
    d = pair.dimension
    if d > max_dimension:
        raise InputError(f"g/h has dimension {d}; the relative invariant is computed up to {max_dimension}")
    if d == 0 or not range_condition(pair).holds:
        return None
    forms = pencil(pair)
    rng = random.Random(d)
    first, second = (_generic_minor(forms, rng) for _ in range(2))
    factors = forms.invariant_factors(first, second, cast(list[ExactMatrix], pair.isotropy_matrices()))
    return RelativeInvariant(pair, tuple(sorted((p if p.leading_coefficient() > 0 else -p for p in factors), key=str)))


def _generic_minor(forms: LinearForms, rng: random.Random) -> Any:
    """The determinant, a non-zero polynomial, of M(x) T for a random constant T."""
    d, m = forms.shape
    while True:
        mix = QQ.matrix([[rng.randint(-2, 2) for _ in range(d)] for _ in range(m)])
        if not (minor := forms.times(mix).minor(range(d), range(d))).is_zero():
            return minor


def require_rational(pair: Pair) -> None:
    """Raise `FieldError` if a pair is not over QQ."""
    if pair.field != QQ:
        raise FieldError(f"relative invariants are computed over QQ only, not over {pair.field.name}")


# Let f be the relative invariant, and y a point at which the range condition holds, so f(y) != 0 and f(x + t y) has
# the degree of f in t.  Its roots are among the t at which [h, psi] + R psi has a rank
# less than d at psi = x + t y.  If the rank is d - 1 there, the complex orbit of psi is open in a component of f = 0.
# All of the component near psi is this orbit, which is smooth, and f has a simple zero.  If moreover y is not tangent
# to the orbit, t is a simple root of f(x + t y).  If this is so at all t found, the degree of f is their number.  See
# Proposition 6b in docs/theory/fullness.md.

LINES = 3


def invariant_degree(pair: Pair) -> int | None:
    """The degree of `relative_invariant` of a pair over QQ, in any dimension; None if the condition holds for no psi.

    Raises
    ------
    UndecidedError
        If it is not decided whether the range condition holds, or if g/h has dimension above 8 and f = 0 has a complex
        component without an open orbit.

    Examples
    --------
    >>> import liehom as lh
    >>> [invariant_degree(lh.pair(name)) for name in ("so(12)/so(11)", "sl(12)/P1", "affine(S2(gl(4)))")]
    [2, 0, 4]
    """
    require_rational(pair)
    generic = range_condition(pair)
    if pair.dimension == 0 or not generic:
        return None
    forms, d = pencil(pair), pair.dimension
    direction = pair.coordinates(generic.psi).row(0)
    rng = random.Random(d)
    for size in range(LINES):
        losses = rank_losses_on_line(forms, [rng.randint(-2 - size, 2 + size) for _ in range(d)], direction)
        if all(loss.rank == d - 1 and loss.transversal for loss in losses):
            return sum(loss.degree for loss in losses)
    if d <= MAX_DIMENSION:
        invariant = relative_invariant(pair)
        return None if invariant is None else invariant.degree
    raise UndecidedError(
        f"on {LINES} lines the range condition fails at points whose orbits have codimension 2 or more, and the minors "
        f"themselves are computed up to dimension {MAX_DIMENSION} of g/h"
    )


# The cone is Z = {psi in g : [h, psi] + R psi + h is not g}, described in V = g/h.  Each part below is a subset of Z
# for a reason that is checked here; a numerical basis of an eigenspace is only an illustration.


class CertificateLike(Protocol):
    """The part of `liehom.Certificate` that `failure_cone` reads; `Certificate` itself is in a layer above this one."""

    @property
    def kind(self) -> str: ...
    def number(self, name: str, /) -> Scalar: ...
    def vector(self, name: str, length: int, /) -> Sequence[Scalar]: ...
    def matrix(self, name: str, nrows: int, ncols: int, /) -> Matrix: ...


@final
@dataclass(frozen=True, slots=True)
class FailureSet:
    """A subset of the cone on which the range condition fails.

    Attributes
    ----------
    kind : {'hypersurface', 'zeros', 'null cone', 'subspace', 'eigenspace'}
        The zeros of the relative invariant f are a 'hypersurface' if f is shown to change sign, otherwise 'zeros'.
    description : str
        The set as a noun phrase, in the coordinates x of ``pair.coordinates``, with the codimension of 'zeros'.
    data : RelativeInvariant, Matrix or array
        For a hypersurface or zeros f, for a null cone the matrix P of the form, otherwise rows of coordinates x that
        span the subspace (floats for 'eigenspace').
    covers : bool
        Whether Z without this set has codimension at least 2: all components of codimension 1 are in it.
    """

    kind: str
    description: str
    data: RelativeInvariant | Matrix | Array
    covers: bool = False


def failure_cone(
    pair: Pair,
    *,
    forms: Sequence[MatrixLike] = (),
    subspaces: Sequence[MatrixLike] = (),
    certificate: CertificateLike | None = None,
) -> list[FailureSet]:
    """Certified subsets of the cone of psi at which the range condition fails.

    Parameters
    ----------
    pair : Pair
        Over an exact field, with g/h not zero.
    forms : sequence of matrices (d, d)
        Symmetric forms on g/h that h preserves up to scalars, in the coordinates of ``pair.coordinates``.
    subspaces : sequence of matrices or rows (m, d)
        Invariant subspaces of g/h, except 0 and g/h.
    certificate : optional
        A verified certificate of kind 'dominance' or 'commutant'; its eigenspace W is listed with a numerical basis.

    Notes
    -----
    For a full pair with an invariant form the list has the zeros of the form, which is 0 only.

    If A^T P + P A = 2 c P for the A in rho(h) and x^T P x = 0, then P x annihilates rho(h) x and x: the condition
    fails at x if P x is not 0, and if it is 0, x lies in ker P, a proper invariant subspace. On a proper invariant
    subspace rho(h) x and x stay inside.

    Examples
    --------
    >>> import liehom as lh
    >>> [part.description for part in failure_cone(lh.defining(lh.so(3, 1)).pair([1, 0, 0, 0]))]
    ['the zeros of x0^2 + x1^2 - x2^2']
    """
    if not pair.field.exact:
        raise UndecidedError(
            "the cone on which the range condition fails is computed over exact fields only: go to exact numbers by "
            "lh.rationalize(pair, max_denominator=...)"
        )
    invariant = relative_invariant(pair) if has_hypersurfaces_computed(pair) else None
    sets = [_null_cone(pair, form) for form in forms]
    if invariant is not None and invariant.degree:
        sets.insert(0, _zeros(invariant))
    sets += [_subspace(pair, rows) for rows in subspaces]
    if certificate is not None and certificate.kind in ("dominance", "commutant"):
        sets += _eigenspace(pair, certificate)
    return sets


def has_hypersurfaces_computed(pair: Pair) -> bool:
    """Whether `failure_cone` lists all components of codimension 1, if the condition holds for some psi."""
    return 0 < pair.dimension <= MAX_DIMENSION and pair.field == QQ


# A product of distinct irreducible polynomials over QQ has no multiple factor over the reals. Its real zeros have
# codimension 1 if and only if it changes sign: a set of codimension 2 does not separate the two signs, and near a point
# of a part of codimension 1 that no other factor meets, a factor without multiplicity has a regular zero.

SIGNS = 200  # random points at which a form of even degree is evaluated


def _zeros(f: RelativeInvariant) -> FailureSet:
    """The real zeros of f, with what is shown of their codimension."""
    quadratic = [_form(p, f.pair.dimension) if p.total_degree() == 2 else None for p in f.factors]
    if any(map(_changes_sign, f.factors, quadratic)):
        return FailureSet("hypersurface", f"the zeros of {f}", f, covers=True)
    ranks = [form.rank() for form in quadratic if form is not None]  # semidefinite forms vanish on their kernels
    if len(ranks) == len(f.factors):
        codimension = f"of codimension {min(ranks)}"
    elif _is_complex(f.pair):
        codimension = "of codimension at least 2"
    else:
        codimension = "of a codimension that is not decided"
    return FailureSet("zeros", f"the real zeros of {f}, {codimension}", f, covers=True)


def _changes_sign(p: Any, form: ExactMatrix | None) -> bool:
    """Whether a homogeneous polynomial, `form` its matrix if it is quadratic, is shown to have both signs."""
    if form is not None or p.total_degree() % 2:
        return form is None or min(form.signature()[:2]) > 0
    d, rng = len(p.degrees()), random.Random(0)
    values = (p(*(rng.randint(-9, 9) for _ in range(d))) for _ in range(SIGNS))
    return len({v > 0 for v in values if v != 0}) == 2


def _matrix(pair: Pair, rows: MatrixLike) -> Matrix:
    d = pair.dimension
    matrix: Matrix = pair.field.read(rows, None if isinstance(rows, Matrix) else (len(rows), d))
    if matrix.ncols != d:
        raise ShapeError(f"expected rows of length {d} (coordinates on g/h), got {matrix.ncols}")
    return matrix


def _null_cone(pair: Pair, form: MatrixLike) -> FailureSet:
    p = _matrix(pair, form)
    if p.nrows != p.ncols or p != p.T or p.is_zero():
        raise InputError("an invariant form is a symmetric matrix that is not zero")
    i, j = divmod(next(x for x, v in enumerate(p.entries()) if v != 0), p.ncols)
    for a in pair.isotropy_matrices():
        moved = a.T @ p + p @ a
        if moved != p.scale(moved[i, j] / p[i, j]):
            raise InputError("the form is not invariant under h up to scalars")
    return FailureSet("null cone", f"the zeros of the invariant form of signature {p.signature()}", p)


def _subspace(pair: Pair, rows: MatrixLike) -> FailureSet:
    basis = _matrix(pair, rows).row_space()
    m, d = basis.nrows, pair.dimension
    if not 0 < m < d:
        raise InputError(f"a proper subspace of g/h has dimension between 1 and {d - 1}, got {m}")
    if any(pair.field.stack_rows([basis, basis @ a.T], d).rank() != m for a in pair.isotropy_matrices()):
        raise InputError("the subspace is not invariant under h")
    return FailureSet("subspace", f"an invariant subspace of dimension {m} of g/h", basis)


def _eigenspace(pair: Pair, certificate: CertificateLike) -> list[FailureSet]:
    """The sum of the generalized eigenspaces with real part above the cut; none if the numbers overflow floats."""
    from scipy.linalg import schur

    d, data = pair.dimension, pair.subalgebra.quotient()
    cut = pair.field.to_float(certificate.number("cut"))
    if certificate.kind == "dominance":
        row = pair.algebra.row(certificate.vector("element", pair.algebra.dimension))
        operator = pair.algebra.table.contract(row, data.lift, data.projection)[0].T.to_numpy()  # rho(X)
        operator = operator - np.eye(d) * np.trace(operator) / d
        frame, what = np.eye(d), "rho(X) without its trace, X the element of the dominance certificate"
    else:
        operator = certificate.matrix("matrix", d, d).to_numpy()
        frame = (certificate.matrix("complement", d, pair.algebra.dimension) @ data.projection).to_numpy().T
        what = "the commuting matrix of the certificate"
    if not (np.isfinite(operator).all() and np.isfinite(frame).all()):
        return []
    *_, vectors, size = schur(operator, sort=lambda re, im: re > cut)
    basis = (frame @ vectors[:, :size]).T
    text = f"the sum of the eigenspaces of {what} with real part above {cut:g}, of dimension {size} (basis numerical)"
    return [FailureSet("eigenspace", text, basis)]


# The number of open orbits on g/h of the connected group of rho(h) + R.
#
# Where the range condition holds the orbits are open, and each connected component of the set U of these points is one
# orbit (docs/theory/fullness.md, Proposition 6).  Let f be the relative invariant.  The complement of U consists of the
# real zeros of f and a set of codimension at least 2, which separates nothing.  So the number is that of the components
# of f != 0, which is counted if f is a product of linear and quadratic forms in independent variables.
#
# If rho(h) + R is a complex vector space, for a complex structure J of g/h that commutes with h, the complement of U is
# a complex algebraic set, of real codimension at least 2. If rho(h) is one, and its own generic rank is d, such a set
# contains the complement of U. In both cases U is connected.
#
# For an irreducible rho whose commutant is R, or C with a center, the dimension, the degree of f and the simple
# ideals of L0 determine f up to isomorphism in the cases below (docs/theory/range.md), and its components are counted
# there.


class Polynomial(Protocol):
    """The part of ``flint.fmpq_mpoly`` that is used here."""

    def total_degree(self) -> int: ...
    def to_dict(self) -> dict[tuple[int, ...], Scalar]: ...


def open_orbit_count(pair: Pair) -> int:
    """The number of open orbits on g/h of the connected group with the Lie algebra rho(h) + R, for a pair over QQ.

    Raises
    ------
    UndecidedError
        If the components of the complement of the relative invariant are not counted.

    Examples
    --------
    Timelike vectors of two directions, and spacelike vectors; the positive and negative vectors of a form of
    signature (2, 2); no orbit is open:

    >>> import liehom as lh
    >>> [open_orbit_count(lh.pair(name)) for name in ("so(3,1)/so(2,1)", "affine(so(2,2))", "sl(3)/so(3)")]
    [3, 2, 0]
    """
    return counted_open_orbits(pair)[0]


def counted_open_orbits(pair: Pair, generic: bool | None = None) -> tuple[int, str]:
    """The number of open orbits and one sentence that proves it; raises as `open_orbit_count` does.

    `generic` says whether the condition holds for some psi, if that is known.
    """
    require_rational(pair)
    d = pair.dimension
    if d == 0:
        return 1, "g/h is a point"
    if not (range_condition(pair) if generic is None else generic):
        return 0, "no orbit is open"
    if _is_complex(pair):
        return 1, "the complement of the open orbits has real codimension at least 2, as it is a complex set"
    if (degree := invariant_degree(pair) or 0) < 2:
        return 1 + degree, "f is linear" if degree else "the complement of the open orbits has codimension at least 2"
    reduced = traceless(cast(list[ExactMatrix], pair.isotropy_matrices()), d, QQ)
    for form in invariant_forms(reduced, d, QQ).symmetric if degree == 2 else ():
        if form.rank() > 1:  # it divides the relative invariant, and has its degree
            return _components(form), f"f is a quadratic form of signature {form.signature()[:2]}"
    known = _of_irreducible(reduced, d, degree)
    return known or (_of_factors(pair, degree), "the factors of f are eliminated one by one")


def _of_irreducible(reduced: Sequence[ExactMatrix], d: int, degree: int) -> tuple[int, str] | None:
    """The number of open orbits for a known f of degree at least 3, if L0 is irreducible; None if f is not known."""
    commuting = commutant(reduced, d, QQ)
    if len(commuting) == 2 and degree == 4 and _is_norm_of_quadratic_form(reduced, commuting, d):
        return 1, "f = |Q|^2 for a complex quadratic form Q, and Q = 0 has real codimension 2"
    if len(commuting) != 1 or trace_radical(reduced):
        return None
    forms = real_forms_of(lie_closure(reduced, close=False).algebra)
    if len(forms) == 1:
        return _of_simple(forms[0], d, degree)
    for place, form in enumerate(forms):
        rest = [*forms[:place], *forms[place + 1 :]]
        n, dimension = isqrt(form.dimension + 1), sum(other.dimension for other in rest)
        m, compact = d // n, sum(other.compact_dimension for other in rest)
        if form.name == f"sl({n},R)" and d == n * m:
            if degree == n == m:
                return 2, f"f is the determinant of {n} x {n} matrices, and it has two signs"
            signature = SIGNATURES.get((dimension, compact, m)) or next(
                ((p, m - p) for p in range(m, (m - 1) // 2, -1) if comb(p, 2) + comb(m - p, 2) == compact), None
            )
            if degree == 2 * n and signature and (dimension == comb(m, 2) or (dimension, compact, m) in SIGNATURES):
                p, q = signature
                return frames(n, p, q), f"f is the Gram determinant of {n} vectors of R^({p},{q})"
        if form.name == "so(3)" and degree == 4 and (dimension in (comb(d // 2, 2), {16: 21}.get(d))) and d % 4 == 0:
            return 1, f"f = |S|^2 for a skew-Hermitian form S of H^{d // 4}, and S = 0 has codimension at least 2"
        if (form.type, d, degree, [(x.type, x.is_split) for x in rest]) == ("A1", 12, 4, [("B2", True)]):
            count = 1 if form.is_compact else 3
            return count, "f = q(u) for the symplectic products u of three vectors of R^4, in R^3 with its form q"
    return None


SIGNATURES = {(14, 14, 7): (7, 0), (14, 6, 7): (4, 3), (21, 21, 8): (8, 0), (21, 9, 8): (4, 4)}
"""Signatures of the forms that g2 and spin(7) preserve, by (dimension, that of a maximal compact subalgebra, m)."""


def _of_simple(form: RealForm, d: int, degree: int) -> tuple[int, str] | None:
    """The number of open orbits of a simple L0 of this real form with this degree of f, for known f."""
    r, key = degree, (form.name, d)
    jordan = {
        (f"sl({r},R)", r * (r + 1) // 2): "symmetric", (f"sl({r},C)", r * r): "complex Hermitian",
        (f"sl({r},H)", r * (2 * r - 1)): "quaternionic Hermitian", ("e6(-26)", 27): "octonionic Hermitian",
    }.get(key)  # fmt: skip
    if jordan and (r == 3 or form.type != "E6"):
        return r + 1, f"f is the determinant of {jordan} {r} x {r} matrices, and the signatures number the orbits"
    if key == (f"sl({2 * r},R)", comb(2 * r, 2)):
        return 2, f"f is the Pfaffian of skew-symmetric {2 * r} x {2 * r} matrices, and it has two signs"
    if r % 2 == 0 and key == (f"sl({r // 2},H)", comb(r + 1, 2)):
        return 1, "skew-Hermitian forms over H that are not degenerate are equivalent"
    if r == 4 and key == ("sl(2,R)", 4):
        return 2, "f is the discriminant of binary cubics: three real roots or one"
    if r == 4 and key == ("sl(6,R)", 20):
        return 2, "f has two signs on three-forms of R^6, sums of two real or of two conjugate decomposable ones"
    return None


def frames(n: int, p: int, q: int) -> int:
    """The number of components of the frames of n vectors of R^(p,q) whose Gram determinant is not 0.

    The frames whose Gram matrix has the signature (a, b) are one orbit of GL(n) x O(p,q). The stabilizer is
    O(a, b) x O(p - a, q - b). Its components and those of the group are groups of signs (det on R^n, on positive and on
    negative vectors of R^(p,q)), and the orbit has as many components as the quotient has elements.
    """
    count = 0
    for a in range(max(0, n - q), min(n, p) + 1):
        b = n - a
        reached = {0}  # signs as bits
        for generator, occurs in ((0b110, a > 0), (0b101, b > 0), (0b010, p > a), (0b001, q > b)):
            reached |= {x ^ generator for x in reached if occurs}
        count += 2 ** (1 + (p > 0) + (q > 0)) // len(reached)
    return count


def _is_norm_of_quadratic_form(reduced: Sequence[ExactMatrix], commuting: Sequence[ExactMatrix], d: int) -> bool:
    """Whether L0 = S + R J for a complex structure J, and S preserves a complex quadratic form of rank at least 3."""
    (j,) = traceless(commuting, d, QQ)
    norm = (j @ j)[0, 0]
    if norm >= 0 or j @ j != QQ.identity(d).scale(norm) or all((a @ j).trace() == 0 for a in reduced):
        return False
    inside = [combination([a, j], [1, -(a @ j).trace() / (norm * d)]) for a in reduced]
    forms = invariant_forms(inside, d, QQ).symmetric
    return any((c := f @ j + j.T @ f).rank() > 4 and c @ j == j.T @ c for f in forms)


def _is_complex(pair: Pair) -> bool:
    """Whether rho(h) + R, or rho(h) if its generic rank is d, is closed under the multiplication by a J as above."""
    matrices, d = cast(list[ExactMatrix], pair.isotropy_matrices()), pair.dimension
    reduced, rng = traceless(matrices, d, QQ), random.Random(d)
    point = QQ.matrix([[rng.randint(-9, 9) for _ in range(d)]]).T
    spans = [span for span in ([QQ.identity(d), *reduced], matrices) if _rank([m @ point for m in span]) == d]
    return any(
        _rank([*span, *(j @ m for m in span)]) == _rank(span) for j in _complex_structures(reduced, d) for span in spans
    )


def _complex_structures(reduced: Sequence[ExactMatrix], d: int) -> Iterator[ExactMatrix]:
    """Matrices J that commute with L0, J^2 a negative scalar: in the center of L0, or in a commutant of dimension 2."""
    candidates = central_candidates(reduced, d, QQ)
    commuting = commutant(reduced, d, QQ)
    if len(commuting) == 2:
        candidates += [c - QQ.identity(d).scale(c.trace() / d) for c in commuting]
    for j in candidates:
        square = j @ j
        is_structure = square == QQ.identity(d).scale(square[0, 0]) and square[0, 0] < 0
        if is_structure and all(j @ m == m @ j for m in reduced):
            yield j


def central_candidates(reduced: Sequence[ExactMatrix], d: int, over: ExactField) -> list[ExactMatrix]:
    """A basis of the elements of L0 that commute with two random ones; the center is in their span."""
    rng = random.Random(d)
    probes = [combination(reduced, [rng.randint(-9, 9) for _ in reduced]) for _ in range(2)] if reduced else []
    rows = [over.stack_columns([(a @ b - b @ a).reshape(1, d * d) for b in probes], 1) for a in reduced]
    return [combination(reduced, c) for c in over.stack_rows(rows, 2 * d * d).T.null_space().to_rows()]


def _rank(matrices: Sequence[ExactMatrix]) -> int:
    """The dimension of the span."""
    size = matrices[0].nrows * matrices[0].ncols if matrices else 0
    return QQ.stack_rows([m.reshape(1, size) for m in matrices], size).rank()


def _of_factors(pair: Pair, degree: int) -> int:
    if pair.dimension > MAX_COUNTED:
        raise UndecidedError(
            f"the components of the complement of the relative invariant, of degree {degree}, are not counted: it is "
            f"computed up to dimension {MAX_COUNTED} of g/h"
        )
    invariant = relative_invariant(pair, MAX_COUNTED)
    factors = () if invariant is None else invariant.factors
    if (count := _signed_components(factors, pair.dimension)) is None:
        raise UndecidedError(
            f"the components of the complement of the relative invariant are not counted: its irreducible factors have "
            f"the degrees {', '.join(sorted(str(p.total_degree()) for p in factors))}"
        )
    return count


# The components of the set where none of some irreducible polynomials vanishes.  Let Y be a space of directions y
# along which all polynomials but p are constant and p is affine, p(x + y) = p(x) + c(x) y.  On both sides p > 0 and p
# < 0 the fibers over V/Y are half spaces if c is not 0, and all of Y or empty if c is 0.  So the components are twice
# those of the image, and those of the image are those for the other polynomials if c is 0 in codimension 2 only,
# where these are not 0.

MAX_COUNTED = 10  # dimension of g/h for minors in the count of components


def _signed_components(factors: Sequence[Any], d: int) -> int | None:
    """The number of components of the set where no factor vanishes; None if no rule applies."""
    for place, p in enumerate(factors):
        others = [*factors[:place], *factors[place + 1 :]]
        if _is_affine_over(p, others, d) and (count := _signed_components(others, d)) is not None:
            return 2 * count
    if any(int(p.total_degree()) > 2 for p in factors):
        return None
    matrices = [_form(p, d) for p in factors]
    if QQ.stack_rows(matrices, d).rank() == sum(m.rank() for m in matrices):
        return prod(_components(m) if int(p.total_degree()) == 2 else 2 for p, m in zip(factors, matrices, strict=True))
    linear, quadratic = ([m for p, m in zip(factors, matrices, strict=True) if p.total_degree() == k] for k in (1, 2))
    return 2 * _affine_components(linear[0], quadratic[0]) if len(linear) == len(quadratic) == 1 else None


def _is_affine_over(p: Any, others: Sequence[Any], d: int) -> bool:
    """Whether there is a space Y as above."""
    slopes = [
        {(k, *e): c for k, o in enumerate(others) for e, c in o.derivative(i).to_dict().items()} for i in range(d)
    ]
    terms = sorted({term for slope in slopes for term in slope})
    constant = QQ.matrix([[slope.get(term, QQ.zero) for term in terms] for slope in slopes], (d, len(terms)))
    chosen: list[list[Scalar]] = []
    along: list[Any] = []
    for y in constant.left_null_space().to_rows() if terms else QQ.identity(d).to_rows():
        slope = _derivative(p, y)
        if slope.is_zero() or any(not _derivative(slope, z).is_zero() for z in [*chosen, y]):
            continue
        chosen.append(y)
        along.append(slope)
    if not along:
        return False
    common = along[0]
    for slope in along[1:]:
        common = common.gcd(slope)
    units = [o / o.leading_coefficient() for o in others]
    return all(factor / factor.leading_coefficient() in units for factor, _ in common.factor()[1])


def _derivative(p: Any, y: Sequence[Scalar]) -> Any:
    """The derivative of a polynomial in a direction."""
    return sum((c * p.derivative(i) for i, c in enumerate(y) if c != 0), 0 * p)


def _affine_components(linear: ExactMatrix, q: ExactMatrix) -> int:
    """The number of components of q != 0 on the affine hyperplane where a linear form is 1."""
    kernel = linear.null_space()
    v = linear.scale(1 / (linear @ linear.T)[0, 0])  # the linear form is 1 at v
    a, b = kernel @ q @ kernel.T, kernel @ q @ v.T
    if QQ.stack_columns([a, b], a.nrows).rank() > a.rank():
        return 2  # q = 0 is the graph of a function
    center = v - a.solve(b).T @ kernel
    level = (center @ q @ center.T)[0, 0]
    positive, negative, _ = a.signature()
    if level == 0:
        return _components(a)
    return 1 + {0: 0, 1: 2}.get(negative if level > 0 else positive, 1)  # the side of the critical point is star-shaped


def _form(polynomial: Polynomial, d: int) -> ExactMatrix:
    """The coefficients of a linear form as a row, the matrix (d, d) of a quadratic form."""
    linear = int(polynomial.total_degree()) == 1
    entries: list[Scalar] = [QQ.zero] * (d if linear else d * d)
    for exponents, c in polynomial.to_dict().items():
        places = [i for i, e in enumerate(exponents) for _ in range(e)]
        for i, j in permutations(places) if not linear else [(0, places[0])]:
            entries[i * d + j] += c if linear else c / 2
    return QQ.from_entries(entries, 1 if linear else d, d)


def _components(form: ExactMatrix) -> int:
    """The number of components of q != 0 for a quadratic form q: 1 for a sign that occurs p >= 2 times, 2 for p = 1."""
    positive, negative, _ = form.signature()
    return sum({0: 0, 1: 2}.get(count, 1) for count in (positive, negative))
