"""Homomorphism: a linear map f between Lie algebras with f([x, y]) = [f(x), f(y)], its matrix acting on columns."""

from __future__ import annotations

from typing import Any, final

import numpy.typing as npt

from liehom.base.errors import HomomorphismError, InputError, ShapeError
from liehom.base.objects import Displayed, Immutable
from liehom.base.typing import VectorLike
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.scalars.field import Matrix, MatrixLike


@final
class Homomorphism(Displayed, Immutable):
    """A homomorphism of Lie algebras over the same field.

    Parameters
    ----------
    source, target : LieAlgebra
        Over the same field.
    matrix : array_like of shape (dim target, dim source)
        Column j holds the coefficients of f(e_j).
    check : bool, optional
        Prove that the bracket is respected (default). Pass False only if it is proved already.

    Raises
    ------
    HomomorphismError
        If f([e_i, e_j]) differs from [f(e_i), f(e_j)]; names i and j.

    Examples
    --------
    >>> import liehom as lh
    >>> trace = lh.algebra.Homomorphism(lh.gl(2), lh.abelian(1), [[1, 0, 0, 1]])
    >>> trace.kernel(), trace.is_surjective()
    (<subalgebra of dimension 3 in gl(2) over QQ>, True)
    """

    __slots__ = ("matrix", "source", "target")

    def __init__(self, source: LieAlgebra, target: LieAlgebra, matrix: MatrixLike, *, check: bool = True) -> None:
        if source.field != target.field:
            raise InputError(f"the source is over {source.field.name}, the target over {target.field.name}")
        shape = (target.dimension, source.dimension)
        self.source: LieAlgebra = source
        self.target: LieAlgebra = target
        self.matrix: Matrix = source.field.read(matrix, shape)
        if self.matrix.shape != shape:
            raise ShapeError(f"the matrix of a homomorphism has shape {shape}, got {self.matrix.shape}")
        if check:
            self._prove()

    # -- constructors ------------------------------------------------------------------------------------
    @classmethod
    def identity(cls, algebra: LieAlgebra) -> Homomorphism:
        """The identity map of a Lie algebra."""
        return cls(algebra, algebra, algebra.field.identity(algebra.dimension), check=False)  # by definition

    @classmethod
    def inclusion(cls, subalgebra: Subalgebra) -> Homomorphism:
        """The inclusion of a subalgebra, as an algebra in its own basis, into the algebra that contains it.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.algebra.Homomorphism.inclusion(lh.so(3).subalgebra([[0, 0, 1]])).image().dimension
        1
        """
        # The bracket of `as_algebra` is the restricted one.
        return cls(subalgebra.as_algebra(), subalgebra.algebra, subalgebra.basis.T, check=False)

    def _prove(self) -> None:
        images, field = self.matrix.T, self.source.field
        one = field.identity(self.source.dimension)
        left = self.source.table.contract(one, one, images)
        right = self.target.table.contract(images, images, field.identity(self.target.dimension))
        for i, (a, b) in enumerate(zip(left, right, strict=True)):
            j = (a - b).first_nonzero_row()
            if j is not None:
                x, y = self.source.basis_names[i], self.source.basis_names[j]
                raise HomomorphismError((i, j), f"not a homomorphism: f([{x}, {y}]) differs from [f({x}), f({y})]")

    # -- image, kernel, composition ----------------------------------------------------------------------
    def __call__(self, x: VectorLike) -> npt.NDArray[Any]:
        """The coefficients of f(x), a numpy array, for a coefficient vector x."""
        return self.target._vector((self.source.row(x) @ self.matrix.T).row(0) if self.target.dimension else [])

    def rank(self) -> int:
        """The dimension of the image, an int."""
        return int(self.matrix.rank())

    def kernel(self) -> Subalgebra:
        """The ideal {x : f(x) = 0} of the source."""
        return Subalgebra(self.source, self.matrix.T.left_null_space(), check=False)  # kernels are ideals

    def image(self) -> Subalgebra:
        """The subalgebra f(source) of the target."""
        return Subalgebra(self.target, self.matrix.T.row_space(), check=False)  # [f(x), f(y)] = f([x, y])

    def is_injective(self) -> bool:
        """Whether the kernel is zero."""
        return self.rank() == self.source.dimension

    def is_surjective(self) -> bool:
        """Whether the image is the whole target."""
        return self.rank() == self.target.dimension

    def is_isomorphism(self) -> bool:
        """Whether the map is injective and surjective."""
        return self.source.dimension == self.target.dimension and self.is_injective()

    def compose(self, first: Homomorphism) -> Homomorphism:
        """The composition x -> self(first(x))."""
        if first.target is not self.source and first.target != self.source:
            raise InputError("the target of the first homomorphism is not the source of the second")
        # both respect the bracket
        return Homomorphism(first.source, self.target, self.matrix @ first.matrix, check=False)

    def inverse(self) -> Homomorphism:
        """The inverse of an isomorphism."""
        if not self.is_isomorphism():
            raise InputError(f"only an isomorphism has an inverse; this map of rank {self.rank()} is not one: {self!r}")
        return Homomorphism(self.target, self.source, self.matrix.inverse(), check=False)  # of an isomorphism

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Homomorphism):
            return NotImplemented
        return self.source == other.source and self.target == other.target and bool(self.matrix == other.matrix)

    def __hash__(self) -> int:
        return hash((self.source, self.target, self.matrix))

    def __repr__(self) -> str:
        ends = [g.name or f"a Lie algebra of dimension {g.dimension}" for g in (self.source, self.target)]
        return f"<homomorphism from {ends[0]} to {ends[1]} over {self.source.field.name}>"
