"""Certificates of NOT FULL from ideals, commutants and eigenvectors."""

from __future__ import annotations

import random
from collections.abc import Iterator

from liehom.exact.fullness import certificate_writer
from liehom.exact.fullness.certificate import Certificate
from liehom.exact.fullness.isotropy_action import TracelessIsotropyAction
from liehom.exact.representations.invariants.irreducibility import Reduction, combination
from liehom.exact.scalars.exact_field import ExactMatrix
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.rational import QQ
from liehom.exact.scalars.roots import largest_real_root_interval


def certificate_of_reduction(action: TracelessIsotropyAction, reduction: Reduction) -> Certificate:
    """Certificate from a reduction of L0: a kernel, a cut or an eigenvalue."""
    match reduction.kind:
        case "kernel":
            return kernel_witness(action, reduction.matrix)
        case "cut" if reduction.cut is not None:
            return certificate_writer.commutant_cut(action, reduction.matrix, reduction.cut)
    polynomial = reduction.polynomial
    if polynomial is None:
        raise TypeError(f"a reduction of kind {reduction.kind!r} carries its cut or its polynomial")
    return commuting_eigenvector_witness(action, reduction.matrix, polynomial)


def kernel_witness(action: TracelessIsotropyAction, matrix: ExactMatrix) -> Certificate:
    """Witness x in the kernel of a matrix with invariant kernel; phi is a row of the matrix."""
    rows = (matrix.select(rows=[i]) for i in range(matrix.nrows))
    phi = next(row for row in rows if not row.is_zero())
    return certificate_writer.rational_witness(action, matrix.null_space().select(rows=[0]).T, phi)


def commuting_eigenvector_witness(action: TracelessIsotropyAction, t: ExactMatrix, f: Polynomial) -> Certificate:
    """Witness x in ker(T - theta), phi a row of T - theta, for a real root theta of the irreducible f."""
    field, size, m = action.field, action.size, f.degree
    powers = [field.identity(size)]
    for _ in range(m - 1):
        powers.append(powers[-1] @ t)
    # f(T)/(T - theta) = sum_i h_i(theta) T^i with h_i = sum_{l > i} f_l theta^(l - i - 1), by synthetic
    # division; its columns lie in ker(T - theta). Collected by powers of theta:
    terms = [[powers[i].scale(f.coefficients[i + j + 1]) for i in range(m - j)] for j in range(m)]
    parts = [sum(row, field.zeros(size, size)) for row in terms]
    column = next(c for c in range(size) if any(not p.select(columns=[c]).is_zero() for p in parts))
    xs = [p.select(columns=[column]) for p in parts]
    shift = [t, -field.identity(size), *[field.zeros(size, size)] * (m - 2)]
    phis = [s.select(rows=[0]) for s in shift]
    return certificate_writer.algebraic_witness(action, f.coefficients, largest_real_root_interval(f), xs, phis)


# Witnesses from top eigenvectors of elements of L0, over the input field or over QQ(theta). The decision looks for one
# after dominance has proved that the pair is not full, so the verdict does not need it.

MAX_DEGREE = 6
"""Largest degree of an eigenvalue whose eigenvectors are tried."""


def eigenvector_witness(
    action: TracelessIsotropyAction, extra: list[list[Scalar]], tries: int = 30
) -> Certificate | None:
    """A witness x in ker(X - theta), theta a largest real eigenvalue, of degree at most 6, of some X in L0; or None."""
    pending: list[tuple[ExactMatrix, Polynomial]] = []
    for x in _elements(action, extra, tries):
        for f, _ in Polynomial(action.field, x.characteristic_coefficients()).factor():
            if f.degree == 1:
                witness = _rational(action, x, -f.coefficients[0])
                if witness is not None:
                    return witness
            elif f.degree <= MAX_DEGREE and action.field == QQ and f.count_real_roots():
                pending.append((x, f))
    shortest = sorted(pending, key=lambda pair: pair[1].degree)[:20]
    return next((w for w in (_algebraic(action, x, f) for x, f in shortest) if w is not None), None)


def _elements(action: TracelessIsotropyAction, extra: list[list[Scalar]], tries: int) -> Iterator[ExactMatrix]:
    basis = action.traceless
    yield from basis
    for coefficients in extra:
        yield combination(basis, coefficients)
    rng = random.Random(3)
    for _ in range(tries):
        a, b = rng.choice(basis), rng.choice(basis)
        bracket = a @ b - b @ a
        yield bracket if not bracket.is_zero() else a + b
        yield a + b.scale(rng.choice((-1, 1, 2)))


def _rational(action: TracelessIsotropyAction, x: ExactMatrix, value: Scalar) -> Certificate | None:
    kernel = (x - action.field.identity(action.size).scale(value)).null_space()
    for i in range(min(kernel.nrows, 6)):
        v = kernel.select(rows=[i]).T
        if action.rank_at(v) < action.size:
            return certificate_writer.rational_witness(action, v, action.action_rows(v).null_space().select(rows=[0]))
    return None


def _algebraic(action: TracelessIsotropyAction, x: ExactMatrix, f: Polynomial) -> Certificate | None:
    interval = largest_real_root_interval(f)
    extension = NumberField("theta", f.coefficients, interval)
    lifted = extension.matrix(x.to_rows())
    kernel = (lifted - extension.identity(action.size).scale(extension.generator)).null_space()
    for i in range(min(kernel.nrows, 3)):
        v = kernel.select(rows=[i])
        moved = [v, *[v @ extension.matrix(a.T.to_rows()) for a in action.matrices]]
        annihilator = extension.stack_rows(moved, action.size).null_space()
        if annihilator.nrows:
            xs = [part.T for part in _powers(action, extension, v)]
            phis = _powers(action, extension, annihilator.select(rows=[0]))
            return certificate_writer.algebraic_witness(action, f.coefficients, interval, xs, phis)
    return None


def _powers(action: TracelessIsotropyAction, extension: NumberField, row: ExactMatrix) -> list[ExactMatrix]:
    """Rational rows r_j with row = sum theta^j r_j, for a row over QQ(theta)."""
    coordinates = [extension.coordinates(v) for v in row.row(0)]
    return [action.field.matrix([[c[j] * extension.leading**j for c in coordinates]]) for j in range(extension.degree)]
