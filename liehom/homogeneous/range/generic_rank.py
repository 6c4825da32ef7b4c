"""The generic rank of x -> [A_1 x, ..., A_m x] for a Lie algebra L of matrices with basis A_i: the orbit dimension.

One x with a large rank is a lower bound.  The upper bound comes from a slice.  Let the rank be r at x0, and N a
complement of L x0 in V.  The map (g, n) -> g (x0 + n) has the differential L + N -> V, (A, n) -> A x0 + n, at
(1, 0), which is onto.  So the orbits of the points x0 + n contain a neighborhood of x0, and the rank is constant on
orbits.  Hence the generic rank is r if and only if the rank is at most r at x0 + n for all n in N.

Let s be the stabilizer of x0 in L.  If the vectors that s annihilates contain a complement N, the rank at x0 + n is at
most dim L - dim s = r.  This is so at generic points if the group of L is reductive and its generic orbits are closed,
in particular if it preserves a definite form up to scale, and for symmetric pairs.

In other cases, the minors of order r + 1 are polynomials of degree at most r + 1 in the d - r coordinates of n.  They
vanish if they vanish at the points whose coordinates are the nodes t_i with indices of sum at most r + 1, which are
finitely many.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import comb

from liehom.budget import in_time
from liehom.errors import UndecidedError
from liehom.scalars import ExactMatrix, Scalar
from liehom.scalars.spaces.linear_forms import LinearForms

MAX_POINTS = 20_000


def point_of_higher_rank(forms: LinearForms, point: Sequence[Scalar], rank: int) -> list[Scalar] | None:
    """A point at which the rank is higher than at the given one, or None, which proves that the rank is generic.

    Parameters
    ----------
    forms : LinearForms
        x -> [A_1 x, ..., A_m x], for a basis A_i of a Lie algebra of matrices.
    point : sequence of d numbers
    rank : int
        The rank at `point`.

    Raises
    ------
    UndecidedError
        If the proof would take too many points.

    Examples
    --------
    The diagonal matrices of trace zero on R^3, at a point with one coordinate zero:

    >>> from liehom.scalars import QQ
    >>> forms = LinearForms([QQ.matrix([[1, 0], [0, 0], [0, 0]]), QQ.matrix([[0, 0], [-1, 1], [0, 0]]),
    ...                      QQ.matrix([[0, 0], [0, 0], [0, -1]])])
    >>> point_of_higher_rank(forms, [1, 0, 0], 1), point_of_higher_rank(forms, [1, 1, 0], 2)
    ([1, 0, 1], None)
    """
    matrix = forms.at(point)
    if rank == min(matrix.shape) or _is_principal(forms, matrix):
        return None
    free = _complement(matrix)
    if (points := number_of_points(rank, len(point))) > MAX_POINTS:
        raise UndecidedError(
            f"the largest dimension found is {rank}; a proof that it is the generic one takes {points} ranks, the "
            f"limit is {MAX_POINTS}"
        )
    for offset in _lattice(_nodes(rank + 2), len(free), rank + 1):
        in_time()
        moved = list(point)
        for i, step in zip(free, offset, strict=True):
            moved[i] = moved[i] + step
        if forms.at(moved).rank() > rank:
            return moved
    return None


def number_of_points(rank: int, dimension: int) -> int:
    """The number of points at which `point_of_higher_rank` computes a rank."""
    return comb(dimension + 1, rank + 1)


def _is_principal(forms: LinearForms, matrix: ExactMatrix) -> bool:
    """Whether the stabilizer s of the point annihilates a complement of L x0, given the matrix at the point."""
    stabilizer = matrix.null_space().T
    d = matrix.nrows
    # column i of an element of s is its value at the unit vector e_i
    images = [(part @ stabilizer).T.reshape(1, stabilizer.ncols * d) for part in forms.parts]
    fixed = forms.field.stack_rows(images, stabilizer.ncols * d).T.null_space()
    return forms.field.stack_rows([matrix.T, fixed], d).rank() == d


def _complement(matrix: ExactMatrix) -> list[int]:
    """Indices of unit vectors that span a complement of the column space."""
    pivots = set(matrix.T.echelon()[1])
    return [i for i in range(matrix.nrows) if i not in pivots]


def _nodes(count: int) -> list[int]:
    """0, 1, -1, 2, -2, ..."""
    return [(k + 1) // 2 if k % 2 else -(k // 2) for k in range(count)]


def _lattice(nodes: Sequence[int], variables: int, degree: int) -> Iterator[tuple[int, ...]]:
    """The points (t_i, t_j, ...) with i + j + ... <= degree, at which only the polynomial 0 of this degree vanishes."""
    if variables == 0:
        yield ()
        return
    for i in range(degree + 1):
        for rest in _lattice(nodes, variables - 1, degree - i):
            yield (nodes[i], *rest)
