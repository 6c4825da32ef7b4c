"""The socle of a representation, the largest completely reducible subspace; complete reducibility decided exactly.

Let L be a Lie algebra of matrices on V.  [L, rad L] acts nilpotently and is the radical of tr(x y) on [L, L], because a
semisimple linear algebra has a nondegenerate trace form.  The subspace W annihilated by [L, rad L] is not zero by
Engel's theorem, and contains every irreducible subspace.  On W the radical of L is central and L is reductive.  A
vector v of W is in the socle if and only if every central z acts on it semisimply: f(z) v = 0, f the squarefree part of
the characteristic polynomial of z.
"""

from __future__ import annotations

from liehom.representations.analysis.submodules import restricted
from liehom.representations.core.generating_matrices import exact_matrices
from liehom.representations.core.representation import Representation
from liehom.representations.invariants.irreducibility import combination, evaluated, trace_form
from liehom.scalars import ExactMatrix, Polynomial, Scalar, Subspace, as_exact


def socle(rho: Representation) -> Subspace:
    """Implements `Representation.socle`."""
    field, size = rho.field, rho.size
    whole = field.identity(size)
    if not rho.matrices or size == 0 or is_visibly_semisimple(rho):
        return Subspace(field, whole, size)
    inside = nilpotent_rows(rho).null_space()
    matrices = restricted(exact_matrices(rho), inside)
    kept = field.identity(inside.nrows)
    for x in _central(rho, matrices):
        z = combination(matrices, x)
        f = Polynomial(z.field, z.characteristic_coefficients())
        value = evaluated(f // f.gcd(f.derivative()), z)
        if not value.is_zero():
            kept = (
                Subspace(field, kept, inside.nrows)
                .intersection(Subspace(field, value.null_space(), inside.nrows))
                .basis
            )
    return Subspace(field, kept @ inside, size)


def is_completely_reducible(rho: Representation) -> bool:
    """Implements `Representation.is_completely_reducible`."""
    return socle(rho).dimension == rho.size


def is_visibly_semisimple(rho: Representation) -> bool:
    """Whether the Killing form is nondegenerate modulo a prime, which proves complete reducibility (Weyl).

    Examples
    --------
    >>> import liehom as lh
    >>> is_visibly_semisimple(lh.defining(lh.so(3))), is_visibly_semisimple(lh.defining(lh.gl(2)))
    (True, False)
    """
    return int(as_exact(rho.algebra.killing_form()).modulo().rank()) == rho.algebra.dimension


def nilpotent_rows(rho: Representation) -> ExactMatrix:
    """Rows that span the row spaces of [L, rad L], L the matrices of a representation."""
    field, size = rho.field, rho.size
    none: ExactMatrix = field.zeros(0, size)
    flat = field.stack_rows([a.reshape(1, size * size) for a in rho.matrices], size * size)
    series = rho.algebra.derived_series()
    derived = series[1].basis if len(series) > 1 else field.identity(rho.algebra.dimension)
    if series[0].dimension == 0 or derived.nrows == 0:
        return none
    images = (derived @ flat).row_space().split_rows(size, size)
    if not images:
        return none
    gram = trace_form(images)
    if int(gram.modulo().rank()) == len(images):
        return none
    radical = gram.null_space()
    rows: ExactMatrix = field.stack_rows([combination(images, radical.row(i)) for i in range(radical.nrows)], size)
    return rows.row_space()


def _central(rho: Representation, matrices: list[ExactMatrix]) -> list[list[Scalar]]:
    """Coefficients of elements of g whose images span the centre of the span of the (restricted) matrices."""
    field, n = rho.field, rho.algebra.dimension
    k = matrices[0].nrows
    flat = field.stack_rows([a.reshape(1, k * k) for a in matrices], k * k)
    identity = field.identity(n)
    brackets = rho.algebra.table.contract(identity, identity, flat)
    rows = field.stack_rows([b.reshape(1, n * k * k) for b in brackets], n * k * k).left_null_space()
    return [rows.row(i) for i in range(rows.nrows)]
