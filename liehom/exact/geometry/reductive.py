"""Reductive complements: the pair (g, h) in a basis of h and of an invariant complement m.

Rows w_j of any complement become invariant by a correction: w_j - phi_j with phi: V -> h linear. The condition that
[h, m] lies in m is a linear system for phi, and a system without a solution has a combination of its equations that
reads 0 = 1. All invariant complements are the graphs of Hom_h(m, h) over one of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias, final

import numpy as np
import numpy.typing as npt

from liehom.base.budget import within
from liehom.base.errors import InputError, NotReductiveError, SingularError, UndecidedError, displayed
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.invariants.intertwiners import intertwiners
from liehom.exact.representations.invariants.irreducibility import evaluated
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix, as_exact
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.function_field import RationalFunction
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.subspaces import Subspace

ObjectArray: TypeAlias = npt.NDArray[np.object_]
"""Array of exact numbers: ``flint.fmpq``, `AlgebraicNumber` or `RationalFunction`."""

Value: TypeAlias = Scalar | RationalFunction
"""An exact number, or a rational function of the parameters of a metric."""


@final
@dataclass(frozen=True, slots=True, eq=False)
class ReductiveSplit:
    """The brackets of g = h + m in the bases of h and m, with V = m.

    `horizontal[i]`, shape (d, d), and `vertical[i]`, shape (d, k), have as row j the parts of [m_i, m_j] in m and h.
    `isotropy[z]`, shape (d, d), and `adjoint[z]`, shape (k, k), act on columns.
    """

    pair: Pair
    field: ExactField
    lower: ExactMatrix
    complement: ExactMatrix
    horizontal: tuple[ExactMatrix, ...]
    vertical: tuple[ExactMatrix, ...]
    isotropy: tuple[ExactMatrix, ...]
    adjoint: tuple[ExactMatrix, ...]
    coordinates: ExactMatrix
    """Shape (n, d): the coordinates in m of the unit vectors of g, modulo h."""

    @property
    def dimension(self) -> int:
        """Dimension d of V."""
        return self.complement.nrows

    def brackets(self) -> ObjectArray:
        """The array (d, d, d) of the coefficients of [m_i, m_j] on m_l, in this order of indices."""
        d = self.dimension
        return np.array([np.asarray(b) for b in self.horizontal], dtype=object).reshape(d, d, d)

    def traces(self) -> list[ExactMatrix]:
        """The row (1, d) of the traces of ad m_i in a list, which is empty if they vanish."""
        g = self.pair.algebra
        table = [g.ad(self.complement.select(rows=[i])).trace() for i in range(self.dimension)]
        return [self.field.matrix([table])] if any(t != 0 for t in table) else []

    def killing(self) -> ExactMatrix:
        """The Killing form of g on m, shape (d, d)."""
        return as_exact(self.complement @ as_exact(self.pair.algebra.killing_form()) @ self.complement.T)

    def corrections(self) -> list[ExactMatrix]:
        """A basis of Hom_h(m, h), matrices (k, d): the differences between invariant complements."""
        shape = (self.lower.nrows, self.dimension)
        return intertwiners(self.isotropy, self.adjoint, shape, self.field)

    def corrected(self, phi: ExactMatrix) -> ObjectArray:
        """The array (d, d, d) of [phi m_i, m_j] + [m_i, phi m_j], the change of `brackets` by a correction."""
        d = self.dimension
        table = np.array([np.asarray(a.T) for a in self.isotropy], dtype=object).reshape(-1, d, d)
        moved: ObjectArray = np.tensordot(np.asarray(phi.T), table, 1)
        return moved - moved.transpose(1, 0, 2)


def require_exact(pair: Pair) -> ExactField:
    """The field of a pair; `UndecidedError` over floats, which names the way out."""
    if not isinstance(pair.field, ExactField):
        raise UndecidedError(
            f"{displayed(pair)} has floats, and rounding decides its geometry; make it exact by lh.rationalize"
        )
    return pair.field


@lru_cache(maxsize=16)
def reductive_split(pair: Pair) -> ReductiveSplit:
    """The pair in bases of h and of an invariant complement; `NotReductiveError` if no such complement exists."""
    field = require_exact(pair)
    if pair.dimension == 0:
        raise InputError("h is the whole algebra, so G/H is a point, which has no geometry")
    within("dimension", pair.algebra.dimension, "the algebra has dimension {}")
    lower = as_exact(pair.subalgebra.basis)
    complement = _killing_complement(pair, lower)
    if complement is None:
        complement = _corrected_complement(pair, lower)
    complement = complement.row_space()
    k, n, table = lower.nrows, pair.algebra.dimension, pair.algebra.table
    inverse = as_exact(field.stack_rows([lower, complement], n)).inverse()
    on_h, on_m = (inverse.select(columns=c) for c in (range(k), range(k, n)))
    return ReductiveSplit(
        pair,
        field,
        lower,
        complement,
        tuple(table.contract(complement, complement, on_m)),
        tuple(table.contract(complement, complement, on_h)),
        tuple(b.T for b in table.contract(lower, complement, on_m)),
        tuple(b.T for b in table.contract(lower, lower, on_h)),
        on_m,
    )


def _killing_complement(pair: Pair, lower: ExactMatrix) -> ExactMatrix | None:
    """The orthogonal complement of h for the Killing form, if that is not degenerate on h; else None."""
    against = lower @ as_exact(pair.algebra.killing_form())
    return against.null_space() if (against @ lower.T).rank() == lower.nrows else None


def _corrected_complement(pair: Pair, lower: ExactMatrix) -> ExactMatrix:
    """An invariant complement from a solution of the linear system; `NotReductiveError` if it has none."""
    field, n, k = lower.field, pair.algebra.dimension, lower.nrows
    lift, on_m = pair.subalgebra.subspace.quotient_map()
    d, table = lift.nrows, pair.algebra.table
    on_h = as_exact(field.stack_rows([lower, as_exact(lift)], n)).inverse().select(columns=range(k))
    acting = [as_exact(b) for b in table.contract(lower, lift, on_m)]  # rows: [z, w_j] in V
    leaving = [as_exact(b) for b in table.contract(lower, lift, on_h)]  # rows: the part in h
    inner = [as_exact(b) for b in table.contract(lower, lower, on_h)]
    # leaving_z - phi ad_z + acting_z phi = 0 for phi with rows phi_j, shape (d, k)
    blocks = []
    for z in range(k):
        columns = []
        for j in range(d):
            for a in range(k):
                unit = field.unit(d, j).T @ field.unit(k, a)
                columns.append((unit @ inner[z] - acting[z] @ unit).reshape(1, d * k))
        blocks.append(field.stack_rows(columns, d * k).T)
    system = field.stack_rows(blocks, d * k)
    right = field.stack_rows([b.reshape(d * k, 1) for b in leaving], 1)
    try:
        phi = system.solve(right).reshape(d, k)
    except SingularError:
        raise _without_complement(pair, system, right, (d, k)) from None
    return as_exact(lift) - phi @ lower


def _without_complement(
    pair: Pair, system: ExactMatrix, right: ExactMatrix, shape: tuple[int, int]
) -> NotReductiveError:
    """The error with the combination of equations that reads 0 = 1."""
    combinations = system.left_null_space()
    values = combinations @ right
    at = next(i for i in range(values.nrows) if values[i, 0] != 0)
    row = combinations.select(rows=[at]) / values[at, 0]
    d, k = shape
    proof = {(x // (d * k), x // k % d, x % k): v for x, v in enumerate(row.entries()) if v != 0}
    return NotReductiveError(
        {index: system.field.format(value) for index, value in proof.items()},
        f"{displayed(pair)} is not reductive: h has no ad(h)-invariant complement. The equations for one, combined by "
        f"the {len(proof)} coefficients of `proof`, read 0 = 1; metrics and connections of G/H need a complement here",
    )


def reductive_complement(pair: Pair) -> Subspace:
    """Implements `Pair.reductive_complement`."""
    return Subspace(pair.field, reductive_split(pair).complement, pair.algebra.dimension)


def is_reductive(pair: Pair) -> bool:
    """Implements `Pair.is_reductive`."""
    require_exact(pair)
    try:
        return pair.dimension == 0 or reductive_split(pair).dimension > 0
    except NotReductiveError:
        return False


def is_symmetric(pair: Pair) -> bool:
    """Implements `Pair.is_symmetric`: [m, m] lies in h for the graph of some phi, a linear system for phi."""
    if pair.dimension == 0 or not is_reductive(pair):
        return pair.dimension == 0
    split = reductive_split(pair)
    return has_solution(split.field, -split.brackets(), [split.corrected(phi) for phi in split.corrections()])


def has_solution(field: ExactField, right: ObjectArray, columns: list[ObjectArray]) -> bool:
    """Whether a combination of the arrays `columns` equals `right`."""
    size = right.size
    rows = [field.matrix([list(c.reshape(-1))], (1, size)) for c in (*columns, right)]
    return bool(field.stack_rows(rows, size).rank() == field.stack_rows(rows[:-1], size).rank())


def kernel_projector(generator: ExactMatrix, polynomial: Polynomial, factor: Polynomial) -> ExactMatrix:
    """The projector onto the kernel of a factor of the squarefree minimal polynomial at a matrix, on columns."""
    if polynomial.degree == factor.degree:
        return generator.field.identity(generator.nrows)
    kernel, other = (evaluated(f, generator).null_space() for f in (factor, polynomial // factor))
    basis = generator.field.stack_rows([kernel, other], generator.nrows)
    return (basis.inverse().select(columns=range(kernel.nrows)) @ kernel).T
