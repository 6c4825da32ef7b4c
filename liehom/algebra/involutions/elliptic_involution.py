"""Cartan involutions from elements with a compact centralizer, over the field of the algebra or a larger real one.

Let ad x be semisimple with imaginary eigenvalues i mu, and K negative definite on z(x).  One Cartan involution theta is
1 on z(x).  On the eigenspaces of i mu and -i mu it is 1 where K(v, conj v) < 0, and -1 where K(v, conj v) > 0.  So p is
the kernel of N(ad x), N the product of the t^2 + mu^2 of the second kind.  If the roots of each irreducible factor of
the minimal polynomial are of one kind, theta is over the field of the algebra.  If not, N is over a larger real field:
values mu^2 of the factors with roots of both kinds are adjoined until no such factor is left.

Such x exist if g has a compact Cartan subalgebra, and they form an open set.  The kinds are found in floating point;
callers check that the result is a Cartan involution.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from typing import TypeAlias, final

import numpy as np

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.involutions.approximate_involution import (
    float_constants,
    near_compact,
    orthonormal_frame,
    short_elements,
)
from liehom.algebra.structure.commuting_maps import evaluate
from liehom.algebra.structure.exact_field import exact_field
from liehom.budget import in_time
from liehom.scalars import ExactMatrix, Polynomial, as_exact
from liehom.scalars.lattices.lattice import reduced_rows
from liehom.scalars.roots.extension import Extension, adjoin_root, real_roots, trivial_extension
from liehom.scalars.spaces.integral_basis import integral_basis
from liehom.typing import Array

QUESTION = "Cartan involutions of elliptic elements"
IMAGINARY = 1e-6  # largest real part of an eigenvalue, relative to the largest eigenvalue, that counts as 0
DEFINITE = 1e-6  # smallest eigenvalue of K(v, conj v), relative to -K(v, theta conj v), with which it is definite
BITS = 64  # precision of roots of factors
TRIED = 40  # short elements, and random ones, that are tried
INSIDE = 8  # elements of one centralizer that are tried
FACTORED = 150  # elements whose characteristic polynomial is factored
DEPTH = 2  # centralizers inside one another
DEEPER = 2  # short elements of one centralizer whose centralizers are tried
SHIFT = 5  # of an element of a centralizer, by which no two eigenvalues coincide in most cases

Kinds: TypeAlias = list[tuple[float, bool]]
"""Pairs (mu^2, whether theta is -1 on the eigenspaces of i mu and -i mu)."""


@final
@dataclass(frozen=True, slots=True)
class EllipticElement:
    """An element x with a compact centralizer, (1, n), and the factors of the minimal polynomial of ad x.

    Attributes
    ----------
    element : ExactMatrix
    kinds : list of (float, bool)
    factors : list of Polynomial
        The irreducible factors, over the field of the algebra, of the polynomial with the roots mu^2.
    """

    element: ExactMatrix
    kinds: Kinds
    factors: list[Polynomial]

    @property
    def mixed(self) -> int:
        """The largest degree of a factor with roots of both kinds, 1 if there is none."""
        return max((f.degree for f in self.factors if len(set(_kinds(f, self.kinds))) > 1), default=1)


def elliptic_elements(algebra: LieAlgebra, theta: Array) -> list[EllipticElement]:
    """Elements with a compact centralizer, the best last: theta is over the field if its `mixed` is 1.

    Parameters
    ----------
    algebra : LieAlgebra
        A semisimple algebra, with short vectors of a lattice as its basis.
    theta : (n, n) float array
        A Cartan involution, on rows, approximately.

    Examples
    --------
    >>> import liehom as lh
    >>> from liehom.algebra.involutions.approximate_involution import approximate_involution
    >>> g = lh.sl(2)
    >>> found = elliptic_elements(g, approximate_involution(g, 1))[-1]
    >>> found.element.to_strings(), found.factors, found.mixed
    ([['1', '-1', '0']], [(-4)*t**0 + (1)*t**1], 1)
    """
    field, spectrum = exact_field(algebra, QUESTION), _Spectrum(algebra, theta)
    found: list[EllipticElement] = []
    if spectrum.kinds(near_compact(theta, 0)) is None:
        return found  # no compact Cartan subalgebra
    for x, kinds in islice(_candidates(algebra, theta, spectrum), FACTORED):
        in_time()
        f = Polynomial(field, algebra.ad(x).characteristic_coefficients())
        factors = [g for g, _ in _of_squares(f).factor()]
        if any(g.count_real_roots() < g.degree for g in factors):
            continue  # double precision was not enough
        element = EllipticElement(x, kinds, factors)
        if not found or element.mixed < found[-1].mixed:
            found.append(element)
        if element.mixed == 1:
            break
    return found


def elliptic_involution(
    algebra: LieAlgebra, found: EllipticElement, degree: int
) -> tuple[Extension, ExactMatrix] | None:
    """The map theta, (n, n) on columns, over a field of at most this degree over that of the algebra, or None.

    Examples
    --------
    >>> import liehom as lh
    >>> from liehom.algebra.involutions.approximate_involution import approximate_involution
    >>> g = lh.sl(2)
    >>> up, theta = elliptic_involution(g, elliptic_elements(g, approximate_involution(g, 1))[-1], 1)
    >>> up.field, theta.to_strings()
    (QQ, [['0', '-1', '0'], ['-1', '0', '0'], ['0', '0', '-1']])
    """
    parted = _separated(found, trivial_extension(exact_field(algebra, QUESTION)), degree)
    if parted is None:
        return None
    up, factors = parted
    field, n = up.field, algebra.dimension
    square = up.matrix(algebra.ad(found.element) @ algebra.ad(found.element))
    total = Polynomial(field, [1])
    for f in factors:
        if _kinds(f, found.kinds)[0]:
            total = total * f
    p = evaluate(total, -square).null_space()
    killing = up.matrix(as_exact(algebra.killing_form()))
    form = p @ killing @ p.T
    if form.rank() < p.nrows:
        return None
    return up, field.identity(n) - (p.T @ form.inverse() @ p @ killing).scale(2)


def _separated(found: EllipticElement, up: Extension, degree: int) -> tuple[Extension, list[Polynomial]] | None:
    """Factors with roots of one kind each, over an extension of at most this degree, or None."""
    base, factors = up.field.degree, found.factors
    while True:
        in_time()
        mixed = [(f, kinds) for f in factors if len(set(kinds := _kinds(f, found.kinds))) > 1]
        if not mixed:
            return up, factors
        f, kinds = min(mixed, key=lambda pair: pair[0].degree)
        if up.field.degree * f.degree > base * degree:
            return None
        fewer = 2 * sum(kinds) <= len(kinds)
        larger, _ = adjoin_root(f, kinds.index(fewer))
        up = up.then(larger)
        factors = [g for f in factors for g, _ in larger.polynomial(f).factor()]


def _kinds(f: Polynomial, kinds: Kinds) -> list[bool]:
    """The kinds of the roots of a factor, in increasing order."""
    values = np.array([value for value, _ in kinds])
    return [kinds[int(np.argmin(np.abs(values - float(r.mid()))))][1] for r in real_roots(f, BITS)]


def _of_squares(f: Polynomial) -> Polynomial:
    """The polynomial with the roots -t^2 for the roots t, except 0, of an even or odd polynomial."""
    low = next(i for i, c in enumerate(f.coefficients) if c != 0)
    even = f.coefficients[low::2]
    return Polynomial(f.field, [c if i % 2 == 0 else -c for i, c in enumerate(even)])


def _candidates(algebra: LieAlgebra, theta: Array, spectrum: _Spectrum) -> Iterator[tuple[ExactMatrix, Kinds]]:
    """Short elements with a compact centralizer, elements of the centralizers of others, and elements near k."""
    field, n = exact_field(algebra, QUESTION), algebra.dimension
    for row in short_elements(algebra, theta)[:TRIED]:
        x = field.from_integers([int(v) for v in row], 1, n)
        kinds = spectrum.kinds(row)
        if kinds is not None:
            yield x, kinds
        elif spectrum.is_elliptic(row):
            yield from _inside(algebra, spectrum, x, DEPTH)
    for seed in range(TRIED):
        row = near_compact(theta, seed)
        kinds = spectrum.kinds(row)
        if kinds is not None:
            yield field.from_integers([int(v) for v in row], 1, n), kinds


def _inside(
    algebra: LieAlgebra, spectrum: _Spectrum, x: ExactMatrix, depth: int
) -> Iterator[tuple[ExactMatrix, Kinds]]:
    """Elements with a compact centralizer in z(x), x elliptic, and in the centralizers of short elements of z(x)."""
    in_time()
    field = exact_field(algebra, QUESTION)
    rows = integral_basis(as_exact(algebra.centralizer(x).basis))
    if field.degree == 1:
        form = rows.to_numpy() @ spectrum.frame
        rows = reduced_rows(field.identity(rows.nrows), np.linalg.cholesky(form @ form.T)) @ rows
    rng = np.random.default_rng(rows.nrows)
    for _ in range(INSIDE):
        weights = rng.integers(-1, 2, rows.nrows).tolist()
        y = field.from_integers(weights, 1, rows.nrows) @ rows + x.scale(int(rng.integers(0, 3)))
        kinds = spectrum.kinds(y.to_numpy()[0])
        if kinds is not None:
            yield y, kinds
    if depth == 0:
        return
    lengths = np.linalg.norm(rows.to_numpy() @ spectrum.frame, axis=1)
    deeper = 0
    for i in np.argsort(lengths, kind="stable").tolist():
        y = rows.select(rows=[i])
        joint = y + x.scale(SHIFT)  # commutes with what commutes with x and y
        smaller = (rows @ algebra.ad(y).T).rank() > 0
        if smaller and deeper < DEEPER and spectrum.is_elliptic(joint.to_numpy()[0]):
            deeper += 1
            yield from _inside(algebra, spectrum, joint, depth - 1)


class _Spectrum:
    """The eigenvalues of ad x, and the kinds of the eigenspaces, in floating point."""

    def __init__(self, algebra: LieAlgebra, theta: Array) -> None:
        frame = orthonormal_frame(algebra, theta)
        self.frame, inverse = frame, np.linalg.inv(frame)
        self.constants = float_constants(algebra)
        self.inverse = inverse
        self.killing = inverse @ algebra.killing_form().to_numpy() @ inverse.T

    def is_elliptic(self, x: Array) -> bool:
        """Whether all eigenvalues of ad x are imaginary, and not all are 0."""
        values = np.linalg.eigvals(self._action(x))
        size = float(np.abs(values).max())
        return (
            size > IMAGINARY * float(np.linalg.norm(x @ self.frame))
            and float(np.abs(values.real).max()) < IMAGINARY * size
        )

    def kinds(self, x: Array) -> Kinds | None:
        """The kinds of the eigenspaces for mu > 0, or None if x is not elliptic or its centralizer is not compact."""
        if not self.is_elliptic(x):
            return None
        action = self._action(x)
        values, vectors = np.linalg.eig(action.T)
        size = float(np.abs(values).max())
        found: Kinds = []
        left = np.flatnonzero(values.imag > -IMAGINARY * size)
        while len(left):
            mu = values[left[0]].imag
            chosen = left[np.abs(values[left].imag - mu) < 1e2 * IMAGINARY * size]
            left = np.setdiff1d(left, chosen)
            rows = np.linalg.qr(vectors[:, chosen])[0].T
            signs = np.linalg.eigvalsh(rows @ self.killing @ rows.conj().T)
            if signs[0] < DEFINITE and signs[-1] > -DEFINITE:
                return None
            if mu > 1e2 * IMAGINARY * size:
                found.append((float(mu) ** 2, bool(signs[0] > 0)))
            elif signs[0] > 0:
                return None
        return found

    def _action(self, x: Array) -> Array:
        """The matrix of ad x on rows, in an orthonormal frame."""
        action: Array = self.inverse @ np.einsum("i,ijk->jk", x, self.constants) @ self.frame
        return action
