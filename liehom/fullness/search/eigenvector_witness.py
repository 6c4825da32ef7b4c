"""Exact witnesses from top eigenvectors of elements of L0, over the input field or over QQ(theta).

The decision looks for one after dominance has proved that the pair is not full, so the verdict does not need it.
"""

from __future__ import annotations

import random
from collections.abc import Iterator

from liehom.fullness.certificates import certificate_writer
from liehom.fullness.certificates.certificate import Certificate
from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction
from liehom.representations.invariants.irreducibility import combination
from liehom.scalars import QQ, ExactMatrix, NumberField, Polynomial, Scalar
from liehom.scalars.roots.roots import largest_real_root_interval

MAX_DEGREE = 6
"""Largest degree of an eigenvalue whose eigenvectors are tried."""


def eigenvector_witness(
    action: TracelessIsotropyAction, extra: list[list[Scalar]], tries: int = 30
) -> Certificate | None:
    """A witness x in ker(X - theta), theta a largest real eigenvalue, of degree at most 6, of some X in L0; or None.

    Parameters
    ----------
    extra : list
        Coefficient lists of elements of L0 to try first.
    """
    pending: list[tuple[ExactMatrix, Polynomial]] = []
    for x in _elements(action, extra, tries):
        for f, _ in Polynomial(action.field, x.characteristic_coefficients()).factor():
            if f.degree == 1:
                found = _rational(action, x, -f.coefficients[0])
                if found is not None:
                    return found
            elif f.degree <= MAX_DEGREE and action.field == QQ and f.count_real_roots():
                pending.append((x, f))
    for x, f in sorted(pending, key=lambda pair: pair[1].degree)[:20]:
        found = _algebraic(action, x, f)
        if found is not None:
            return found
    return None


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
