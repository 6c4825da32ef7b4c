"""Certificates of reducibility: a witness or a cut from a reduction of the isotropy representation."""

from __future__ import annotations

from liehom.fullness.certificates import certificate_writer
from liehom.fullness.certificates.certificate import Certificate
from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction
from liehom.representations.invariants.irreducibility import Reduction
from liehom.scalars import ExactMatrix, Polynomial
from liehom.scalars.roots.roots import largest_real_root_interval


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
    parts = []
    for j in range(m):
        total = field.zeros(size, size)
        for i in range(m - j):
            total = total + powers[i].scale(f.coefficients[i + j + 1])
        parts.append(total)
    column = next(c for c in range(size) if any(not p.select(columns=[c]).is_zero() for p in parts))
    xs = [p.select(columns=[column]) for p in parts]
    shift = [t, -field.identity(size), *[field.zeros(size, size)] * (m - 2)]
    phis = [s.select(rows=[0]) for s in shift]
    return certificate_writer.algebraic_witness(action, f.coefficients, largest_real_root_interval(f), xs, phis)
