"""Der(g): the derivations of a Lie algebra, D [x, y] = [D x, y] + [x, D y], exactly.

The equations are solved modulo a prime for the images of generators (`derivation_equations`), which bounds dim Der(g)
from above. If there are no more solutions than inner derivations, all derivations are inner. Otherwise outer
derivations are proposed and then proved. Proposals come from small fractions that agree modulo the prime, or from the
exact solution of sufficiently many equations.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

import numpy as np

from liehom.algebra.closure.closure import lie_closure
from liehom.algebra.cohomology.derivation_equations import exact_outer, modular_derivations, small_outer
from liehom.algebra.cohomology.word_basis import word_bases
from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.subalgebra import Subalgebra
from liehom.errors import InputError, InternalError
from liehom.immutable import Immutable
from liehom.scalars import FloatField, FloatMatrix, Matrix
from liehom.scalars.fields.field import MatrixLike


@final
class Derivations(Immutable):
    """The Lie algebra of derivations of a Lie algebra, the result of `LieAlgebra.derivations`.

    Attributes
    ----------
    source : LieAlgebra
        g, of dimension n.
    matrices : tuple of Matrix
        A basis of Der(g): matrices (n, n) on columns of coefficients. The first ones are inner, ad e_i.
    inner_dimension : int
        The dimension of ad(g), which is n minus the dimension of the centre.

    Examples
    --------
    >>> import liehom as lh
    >>> made = lh.euclidean(3).derivations()
    >>> made.dimension, made.inner_dimension, made.outer_dimension
    (7, 6, 1)
    >>> print(made.outer_matrices()[0])
    [0, 0, 0, 0, 0, 0]
    [0, 0, 0, 0, 0, 0]
    [0, 0, 0, 0, 0, 0]
    [0, 0, 0, 1, 0, 0]
    [0, 0, 0, 0, 1, 0]
    [0, 0, 0, 0, 0, 1]
    """

    __slots__ = ("_algebra", "_flat", "inner_dimension", "matrices", "source")

    def __init__(self, source: LieAlgebra, matrices: tuple[Matrix, ...], inner_dimension: int) -> None:
        self.source: LieAlgebra = source
        self.matrices: tuple[Matrix, ...] = matrices
        self.inner_dimension: int = inner_dimension
        self._algebra: LieAlgebra | None = None
        self._flat: Matrix | None = None

    # -- properties --------------------------------------------------------------------------------------
    @property
    def dimension(self) -> int:
        """dim Der(g), an int."""
        return len(self.matrices)

    @property
    def outer_dimension(self) -> int:
        """dim Der(g) / ad(g) = dim H^1(g, g), an int."""
        return self.dimension - self.inner_dimension

    # -- verbs -------------------------------------------------------------------------------------------
    def algebra(self) -> LieAlgebra:
        """Der(g) as a Lie algebra in the basis `matrices`, with the commutator as bracket."""
        if self._algebra is None:
            g = self.source
            name = f"Der({g.name})" if g.name else None
            if self.dimension == self.inner_dimension == g.dimension:
                # ad is an isomorphism onto Der(g)
                self._algebra = LieAlgebra(g.table, basis=g.basis_names, name=name, check=False)
            elif self.dimension == 0:
                self._algebra = LieAlgebra({}, g.field, dimension=0, name=name)
            else:
                self._algebra = lie_closure(self.matrices, field=g.field, close=False, name=name).algebra
        return self._algebra

    def inner(self) -> Subalgebra:
        """The ideal ad(g) of `algebra`, spanned by its first `inner_dimension` basis elements."""
        one = self.source.field.identity(self.dimension)
        rows = one.select(rows=range(self.inner_dimension))
        return Subalgebra(self.algebra(), rows, check=False)  # [D, ad x] = ad Dx

    def outer_matrices(self) -> tuple[Matrix, ...]:
        """The last members of `matrices`, a basis of Der(g) modulo ad(g)."""
        return self.matrices[self.inner_dimension :]

    def coordinates(self, matrix: MatrixLike) -> Matrix:
        """The coefficients of a derivation in the basis `matrices`, as a row matrix (1, dim Der).

        Raises
        ------
        InputError
            If the matrix is not a derivation.
        ShapeError
            If its shape is not (n, n).
        """
        n, field = self.source.dimension, self.source.field
        given = field.read(matrix, (n, n))
        if not is_derivation(self.source, given):
            raise InputError("the matrix is not a derivation: D [x, y] differs from [D x, y] + [x, D y] for some x, y")
        row: Matrix = field.zeros(1, 0)
        if self.dimension > 0:
            flat: Matrix | None = self._flat
            if flat is None:
                self._flat = flat = field.stack_rows([m.reshape(1, n * n) for m in self.matrices], n * n)
            row = flat.T.solve(given.reshape(n * n, 1)).T
        return row

    def __repr__(self) -> str:
        of = self.source.name or f"a Lie algebra of dimension {self.source.dimension}"
        return f"<derivations of {of}: dimension {self.dimension}, {self.outer_dimension} outer>"


def derivations(algebra: LieAlgebra) -> Derivations:
    """Implements `LieAlgebra.derivations`."""
    n, field = algebra.dimension, algebra.field
    if algebra.is_abelian():
        return Derivations(algebra, tuple(field.identity(n * n).split_rows(n, n)), 0)
    if algebra.is_semisimple():
        return Derivations(algebra, _inner(algebra, range(n)), n)
    outside = algebra.center().subspace.complement_indices()
    inner = _inner(algebra, outside)
    return Derivations(algebra, inner + (_outer if field.exact else _numerical)(algebra, inner), len(inner))


def is_derivation(algebra: LieAlgebra, matrix: MatrixLike) -> bool:
    """Whether D [x, y] = [D x, y] + [x, D y] for all x, y; D of shape (n, n) acts on columns.

    Examples
    --------
    >>> import liehom as lh
    >>> is_derivation(lh.heisenberg(1), [[1, 0, 0], [0, 1, 0], [0, 0, 2]])
    True
    """
    n, field, table = algebra.dimension, algebra.field, algebra.table
    transposed = field.read(matrix, (n, n)).T
    one = field.identity(n)
    whole = table.contract(one, one, transposed)
    left, right = table.contract(transposed, one, one), table.contract(one, transposed, one)
    return all((a - b - c).is_zero() for a, b, c in zip(whole, left, right, strict=True))


def _inner(algebra: LieAlgebra, indices: Sequence[int]) -> tuple[Matrix, ...]:
    """ad e_i for the basis elements with given indices."""
    one = algebra.field.identity(algebra.dimension)
    return tuple(block.T for block in algebra.table.contract(one.select(rows=indices), one, one))


def _outer(algebra: LieAlgebra, inner: tuple[Matrix, ...]) -> tuple[Matrix, ...]:
    """Derivations that complete the inner ones to a basis, each proved to be a derivation."""
    n, count = algebra.dimension, len(inner)
    for words in word_bases(algebra):
        found = modular_derivations(words)
        if found.dimension == count:
            return ()
        outer = small_outer(algebra, found, count)
        outer = exact_outer(algebra, found, count) if outer is None else outer
        if outer is not None:
            return tuple(outer.split_rows(n, n))
    raise InternalError(f"no prime was usable for the derivations of {algebra!r}")


def _numerical(algebra: LieAlgebra, inner: tuple[Matrix, ...]) -> tuple[Matrix, ...]:
    """Derivations over floats that are orthogonal to the inner ones, by a numerical null space."""
    n, field = algebra.dimension, algebra.field
    if not isinstance(field, FloatField):
        raise TypeError(f"derivations over {field} are not supported")
    c = algebra.table.dense().to_numpy().reshape(n, n, n)
    one = np.eye(n)
    # the coefficient of D_ab in coordinate m of the condition for e_i, e_j
    whole = np.einsum("ijb,am->ijmab", c, one)
    whole -= np.einsum("ajm,bi->ijmab", c, one) + np.einsum("iam,bj->ijmab", c, one)
    conditions = whole[np.triu_indices(n, 1)].reshape(-1, n * n)
    table = np.concatenate([conditions, *(m.to_numpy().reshape(1, n * n) for m in inner)])
    # one table of constants with one relative error
    error = float(np.linalg.norm(table)) * algebra.table.error / algebra.table.norm()
    solutions = FloatMatrix(field, table, error).null_space("the number of outer derivations")
    return tuple(solutions.split_rows(n, n))
