"""A Lie algebra as the direct sum of indecomposable ideals, over its own field.

Central elements outside [g, g] split off as abelian ideals of dimension 1.  The complement then has its centre in
[g, g], and its centroid A is commutative modulo the maps g/[g, g] -> z(g), which are an ideal of square 0.  An element
theta that generates A modulo its radical has a minimal polynomial with one irreducible factor p_i for each field in
A / rad A, so the ideals ker p_i(theta)^k are indecomposable and their sum is direct.
"""

from __future__ import annotations

import random

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.algebra.core.subalgebra import Subalgebra, complement_rows
from liehom.algebra.structure.bracket_seeds import BracketSeeds
from liehom.algebra.structure.centroid import centroid_of
from liehom.algebra.structure.commuting_maps import combinations, evaluate, minimal_polynomial, semisimple_rank
from liehom.errors import InternalError
from liehom.scalars import ExactMatrix, Matrix, Polynomial
from liehom.scalars.spaces.integral_basis import integral_basis


def direct_sum_decomposition(algebra: LieAlgebra) -> list[Subalgebra]:
    """Implements `LieAlgebra.direct_sum_decomposition`."""
    field, n = algebra.field, algebra.dimension
    parts: list[Matrix] = []
    for indices in components(algebra.table):
        if len(indices) == 1:
            parts.append(field.unit(n, indices[0]))
            continue
        whole = field.identity(n).select(rows=indices)
        inner = algebra if len(indices) == n else _restricted(algebra, indices)
        parts += [rows @ whole for rows in _indecomposable(inner)]
    ideals = [Subalgebra(algebra, rows, check=False) for rows in parts]  # ideals by construction
    if len(ideals) == 1:
        return ideals
    return sorted(ideals, key=_order)


def components(table: StructureConstants) -> list[list[int]]:
    """The finest partition of the basis indices into sets that span ideals and are connected by non-zero c[i, j, k].

    Examples
    --------
    >>> import liehom as lh
    >>> components(lh.direct_sum(lh.so(3), lh.abelian(2)).table)
    [[0, 1, 2], [3], [4]]
    """
    parent = list(range(table.dimension))

    def root(x: int) -> int:
        while parent[x] != x:
            parent[x] = parent[parent[x]]
            x = parent[x]
        return x

    for i, j, k in zip(table.i.tolist(), table.j.tolist(), table.k.tolist(), strict=True):
        parent[root(j)] = root(i)
        parent[root(k)] = root(i)
    found: dict[int, list[int]] = {}
    for x in range(table.dimension):
        found.setdefault(root(x), []).append(x)
    return list(found.values())


def _restricted(algebra: LieAlgebra, indices: list[int]) -> LieAlgebra:
    """The ideal spanned by these basis elements, as an algebra."""
    position = {x: i for i, x in enumerate(indices)}
    entries = [(position[i], position[j], position[k], v) for i, j, k, v in algebra.table if i in position]
    # The restriction of a bracket to an ideal.
    return LieAlgebra(StructureConstants(algebra.field, len(indices), entries), check=False)


def _indecomposable(algebra: LieAlgebra) -> list[ExactMatrix]:
    """Bases, as rows, of indecomposable ideals whose direct sum is the algebra."""
    seeds = BracketSeeds(algebra)
    if seeds.is_perfect():
        return _split(seeds, None)
    field, n = seeds.field, algebra.dimension
    center = seeds.center()
    if center.nrows == 0:
        return _split(seeds, None)
    derived = field.stack_rows(seeds.ads(field.identity(n)), n).row_space()
    abelian = complement_rows(center, derived)
    lines = [integral_basis(abelian.select(rows=[i])) for i in range(abelian.nrows)]
    if not lines:
        return _split(seeds, center if derived.nrows == seeds.spanned else None)
    rest = _completed(derived, abelian)
    if rest.nrows == 0:
        return lines
    inner = Subalgebra(algebra, rest, check=False).as_algebra()  # it contains [g, g]
    return lines + [rows @ rest for rows in _indecomposable(inner)]


def _completed(space: ExactMatrix, other: ExactMatrix) -> ExactMatrix:
    """A basis, as rows, of a complement of `other` that contains `space`."""
    n, field = space.ncols, space.field
    k = space.nrows + other.nrows
    stacked = field.stack_rows([space, other, field.identity(n)], n)
    units = [x - k for x in stacked.T.echelon()[1] if x >= k]
    return integral_basis(field.stack_rows([space, field.identity(n).select(rows=units)], n))


def _split(seeds: BracketSeeds, center: ExactMatrix | None) -> list[ExactMatrix]:
    """Bases of the indecomposable ideals of an algebra whose centre lies in [g, g]."""
    field, n = seeds.field, seeds.n
    maps = centroid_of(seeds, center)
    rank = semisimple_rank(maps) if len(maps) > 1 else 1
    if rank == 1:
        return [field.identity(n)]
    rng = random.Random(n)
    for theta in combinations(maps, rng):
        f = minimal_polynomial(theta, seeds.random_rows(1))
        factors = f.factor()
        if sum(p.degree for p, _ in factors) == rank:
            return _kernels(theta, factors)
    raise InternalError("no element generates the centroid modulo its radical")


def _kernels(theta: ExactMatrix, factors: list[tuple[Polynomial, int]]) -> list[ExactMatrix]:
    """Bases of the spaces ker p_i(theta)^k with k so large that their sum is the algebra."""
    n = theta.nrows
    if len(factors) == 1:
        return [theta.field.identity(n)]
    maps = [evaluate(p, theta) for p, _ in factors]
    kernels = [_kernel(m, k) for m, (_, k) in zip(maps, factors, strict=True)]
    if sum(space.nrows for space in kernels) < n:
        kernels = [_kernel(m, n) for m in maps]
    if sum(space.nrows for space in kernels) != n:
        raise InternalError("the primary components do not add up")
    return [integral_basis(space) for space in kernels]


def _kernel(matrix: ExactMatrix, exponent: int) -> ExactMatrix:
    """A basis, as rows, of the null space of a power of the matrix."""
    power = matrix
    for _ in range(exponent - 1):
        power = (power @ matrix).primitive()
    return power.null_space()


def _order(ideal: Subalgebra) -> tuple[int, list[list[str]]]:
    """The key by which ideals are sorted."""
    basis: Matrix = ideal.subspace.basis
    return ideal.dimension, basis.to_strings()
