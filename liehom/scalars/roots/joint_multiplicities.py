"""Joint eigenvalues of commuting semisimple matrices with multiplicities, and pairings with coroots.

A combination x of the matrices M_j separates the joint eigenspaces if and only if each M_j is a polynomial p_j(x).
These polynomials are found on the Krylov space of one vector and verified exactly on vectors whose Krylov spaces span
the whole space. The joint eigenvalues are then p_j(mu) for the roots mu of the characteristic polynomial of x, enclosed
in balls of any precision. The multiplicities are those of its squarefree parts.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import flint

from liehom.errors import SingularError
from liehom.scalars.fields.balls import working_precision
from liehom.scalars.fields.exact_field import ExactMatrix
from liehom.scalars.fields.number_field import NumberField
from liehom.scalars.fields.polynomial import Polynomial
from liehom.scalars.fields.rational import QQ
from liehom.scalars.roots.joint_spectrum import enclosure, preserved_blocks
from liehom.scalars.roots.roots import complex_root_balls


@final
@dataclass(frozen=True, slots=True)
class Block:
    """A coordinate block that all matrices preserve.

    `parts` are the squarefree factors of the characteristic polynomial of x with multiplicities, `polynomials` the p_j
    with M_j = p_j(x).
    """

    parts: tuple[tuple[Polynomial, int], ...]
    polynomials: tuple[Polynomial, ...]


@final
@dataclass(frozen=True, slots=True)
class JointMultiplicities:
    """The joint eigenvalues of commuting semisimple matrices M_1, ..., M_r, block by block.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> found = joint_multiplicities([QQ.matrix([[0, -1], [1, 0]])], [1])
    >>> [(round(complex(v[0]).imag), m) for v, m in found.values(64)]
    [(1, 1), (-1, 1)]
    """

    blocks: tuple[Block, ...]

    def values(self, precision: int) -> list[tuple[tuple[flint.acb, ...], int]]:
        """Pairs (joint eigenvalue as balls, multiplicity); a joint eigenvalue may occur in several blocks."""
        found = []
        for block in self.blocks:
            for part, multiplicity in block.parts:
                roots = complex_root_balls(part, precision)
                with working_precision(precision):
                    polynomials = [_ball_coefficients(p, precision) for p in block.polynomials]
                    found += [(tuple(_evaluated(p, root) for p in polynomials), multiplicity) for root in roots]
        return found


def joint_multiplicities(
    matrices: Sequence[ExactMatrix], weights: Sequence[int], *, blocks: bool = True
) -> JointMultiplicities | None:
    """`JointMultiplicities` of commuting semisimple matrices; None if the combination does not separate eigenvalues.

    Parameters
    ----------
    matrices : sequence of ExactMatrix
        (N, N), commuting and semisimple, at least one.
    weights : sequence of int
        x is the sum of weights[j] M_j; it must separate the joint eigenvalues in each block that all M_j preserve.
    blocks : bool, optional
        Whether coordinate blocks that all matrices preserve are taken one by one (default).

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> turns = [QQ.matrix([[0, -1], [1, 0]]), QQ.matrix([[0, 2], [-2, 0]])]
    >>> [m for _, m in joint_multiplicities(turns, [1, 1]).values(64)], joint_multiplicities(turns, [2, 1])
    ([1, 1], None)
    """
    found = []
    for places in preserved_blocks(matrices) if blocks else [list(range(matrices[0].nrows))]:
        block = _block([a.select(rows=places, columns=places) for a in matrices], weights)
        if block is None:
            return None
        found.append(block)
    return JointMultiplicities(tuple(found))


def _block(matrices: Sequence[ExactMatrix], weights: Sequence[int]) -> Block | None:
    field, size = matrices[0].field, matrices[0].nrows
    x = field.zeros(size, size)
    for a, w in zip(matrices, weights, strict=True):
        x = x + a.scale(w)
    parts = Polynomial(field, x.characteristic_coefficients()).squarefree_parts()
    degree = sum(part.degree for part, _ in parts)
    starts, spaces = _generating_vectors(x, max(m for _, m in parts), degree)
    images = field.stack_rows([starts[0] @ a.T for a in matrices], size)
    try:
        solution = spaces[0].T.solve(images.T).T
    except SingularError:
        return None
    for start, space in zip(starts[1:], spaces[1:], strict=True):
        if field.stack_rows([start @ a.T for a in matrices], size) != solution @ space:
            return None
    return Block(tuple(parts), tuple(Polynomial(field, row) for row in solution.to_rows()))


def _generating_vectors(x: ExactMatrix, count: int, degree: int) -> tuple[list[ExactMatrix], list[ExactMatrix]]:
    """Rows v whose Krylov spaces together are everything, and for each the rows v, x v, ..., x^(degree - 1) v."""
    field, size = x.field, x.nrows
    rng = random.Random(size)
    starts: list[ExactMatrix] = []
    spaces: list[ExactMatrix] = []
    while True:
        vector = field.matrix([[rng.randint(-999, 999) for _ in range(size)]], (1, size))
        rows = [vector]
        for _ in range(degree - 1):
            rows.append(rows[-1] @ x.T)
        starts.append(vector)
        spaces.append(field.stack_rows(rows, size))
        # ranks modulo a prime prove that the first Krylov space is as large as possible and that all span everything
        if int(spaces[0].modulo().rank()) < degree:
            starts, spaces = [], []
        elif len(starts) >= count and int(field.stack_rows(spaces, size).modulo().rank()) == size:
            return starts, spaces


def _ball_coefficients(polynomial: Polynomial, precision: int) -> list[flint.arb]:
    field = polynomial.field
    if isinstance(field, NumberField):
        return [field.ball(c, precision) for c in polynomial.coefficients]
    return [flint.arb(QQ.convert(c)) for c in polynomial.coefficients]


def _evaluated(coefficients: list[flint.arb], root: flint.acb) -> flint.acb:
    total = flint.acb(0)
    for c in reversed(coefficients):
        total = total * root + c
    return total


def coroot_pairings(
    values: Sequence[Sequence[flint.acb]], simple: Sequence[Sequence[flint.acb]], form: ExactMatrix, precision: int
) -> list[tuple[int, ...]] | None:
    """The integers 2 (v, a_i) / (a_i, a_i) of linear forms v on a Cartan subalgebra with simple roots a_i.

    Parameters
    ----------
    values : sequence of r balls
        The values of each linear form on a basis of the subalgebra.
    simple : sequence of r balls
        The values of the simple roots.
    form : ExactMatrix
        The Gram matrix (r, r) of the invariant form on the dual space, inverse to the form on the subalgebra.
    precision : int

    Returns
    -------
    list of tuple of int, or None
        None if some ball does not contain exactly one integer.
    """
    with working_precision(precision):
        r = len(simple)
        roots = flint.acb_mat(r, r, [x for row in simple for x in row])
        gram = enclosure(form, precision)
        images = gram * roots.transpose()
        norms = [(roots * images)[i, i] for i in range(r)]
        if any(norm.contains(0) for norm in norms):
            return None
        found = []
        for value in values:
            pairings = flint.acb_mat(1, r, list(value)) * images
            integers = [(2 * pairings[0, i] / norms[i]).real.unique_fmpz() for i in range(r)]
            known = tuple(int(n) for n in integers if n is not None)
            if len(known) < r:
                return None
            found.append(known)
        return found
