"""Representation: a homomorphism rho from a Lie algebra to matrices, checked at construction.

rho([x, y]) = rho(x) rho(y) - rho(y) rho(x).  Vectors are columns: rho(x) v.  Imports algebra, errors.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, final

from liehom.algebra import LieAlgebra, Subalgebra
from liehom.algebra.closure import lie_closure, square_matrices
from liehom.errors import RepresentationError, ShapeError
from liehom.representations.pair import Pair
from liehom.representations.stabilizer import orbit_dimension, stabilizer
from liehom.scalars import Field


@final
class Representation:
    """A representation of a Lie algebra on K^N.

    Parameters
    ----------
    algebra : LieAlgebra
    matrices : sequence of (N, N) array_like
        rho(e_i), one per basis element.
    size : int, optional
        N, needed only for an algebra of dimension 0.
    name : str, optional
    given : int, optional
        How many of the basis elements the user gave (the others were appended by Lie closure).
    check : bool, optional
        Prove rho([x, y]) = [rho(x), rho(y)] (default). False is for callers that have proved it.

    Raises
    ------
    ShapeError
        If the number of matrices or their shapes do not fit.
    RepresentationError
        If the bracket is not respected; names i and j.

    Examples
    --------
    >>> import liehom as lh
    >>> rho = lh.Representation.from_matrices([[[0, -1], [1, 0]]])
    >>> rho.algebra.dimension, rho.size, rho.isotropy([1, 0]).dimension
    (1, 2, 0)
    """

    __slots__ = ("algebra", "appended", "given", "matrices", "name", "size")

    def __init__(
        self,
        algebra: LieAlgebra,
        matrices: Any,
        *,
        size: int | None = None,
        name: str | None = None,
        given: int | None = None,
        appended: tuple[tuple[int, int], ...] = (),
        check: bool = True,
    ) -> None:
        made = tuple(square_matrices(matrices, algebra.field))
        if len(made) != algebra.dimension:
            raise ShapeError(f"{len(made)} matrices for an algebra of dimension {algebra.dimension}")
        if not made and size is None:
            raise ShapeError("a representation of the zero algebra needs its size")
        self.algebra = algebra
        self.matrices = made
        self.size = int(made[0].nrows) if made else int(size or 0)
        self.name = name
        self.given = len(made) if given is None else given
        self.appended = appended
        if check:
            self._prove()

    @classmethod
    def from_matrices(
        cls, matrices: Any, *, field: Field | None = None, independent: bool = False, name: str | None = None
    ) -> Representation:
        """The Lie algebra that matrices generate, with its defining representation.

        The first basis elements are the given matrices in order; missing brackets are appended in
        lexicographic order of (i, j).

        Parameters
        ----------
        matrices : sequence of (N, N) array_like
        field : Field, optional
            By default the field that the entries call for (float64 if one is a float).
        independent : bool
            Drop matrices that depend on earlier ones; `dropped` of the closure says which (default: refuse).
        name : str, optional

        Raises
        ------
        DependentRowsError, ShapeError, InputError

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.Representation.from_matrices([[[0, 1], [0, 0]], [[0, 0], [1, 0]]])
        >>> rho.given, rho.algebra.dimension, rho.appended
        (2, 3, ((0, 1),))
        """
        made = lie_closure(matrices, field=field, independent=independent)
        size = int(square_matrices(matrices, field)[0].nrows)
        # The constants are those of the commutators themselves.
        return cls(
            made.algebra, made.matrices, size=size, name=name, given=len(made.kept), appended=made.appended, check=False
        )

    # -- properties --------------------------------------------------------------------------------------
    @property
    def field(self) -> Field:
        """The field of the matrices."""
        return self.algebra.field

    # -- verbs -------------------------------------------------------------------------------------------
    def __call__(self, x: Any) -> Any:
        """The matrix rho(x) of a coefficient vector x."""
        row = self.algebra.row(x)
        total = self.field.zeros(self.size, self.size)
        for i, a in enumerate(self.matrices):
            value = row[0, i]
            if value != 0:
                total = total + a.scale(value)
        return total

    def isotropy(self, point: Any) -> Subalgebra:
        """The isotropy subalgebra {x : rho(x) point = 0}.

        Parameters
        ----------
        point : array_like of shape (N,)
            Entries in the representation's field (floats for a float representation).

        Raises
        ------
        ShapeError
            If the point does not have N coordinates.
        FieldError
            If an entry is not in the field.

        Notes
        -----
        One null space of the (N, dim g) matrix with columns rho(e_i) point. For a point whose entries are
        sympy expressions with free symbols use `liehom.symbolic_isotropy`.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.defining(lh.so(4)).isotropy([0, 0, 0, 1]).dimension
        3
        """
        return stabilizer(self.algebra, self.matrices, self.size, point)

    def orbit_dimension(self, point: Any) -> int:
        """The dimension of the orbit through a point: dim g minus that of the isotropy subalgebra."""
        return orbit_dimension(self.algebra, self.matrices, self.size, point)

    def pair(self, point: Any) -> Pair:
        """The pair (g, g_point): the homogeneous space of the orbit through a point.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.defining(lh.so(4)).pair([0, 0, 0, 1])
        <pair of dimensions 6/3 over QQ>
        """
        return Pair(self.algebra, self.isotropy(point))

    def _prove(self) -> None:
        pairs = self.algebra.table.by_pair()
        zero = self.field.zeros(self.size, self.size)
        den = self.algebra.table.den
        for i in range(len(self.matrices)):
            for j in range(i + 1, len(self.matrices)):
                a, b = self.matrices[i], self.matrices[j]
                expected = zero
                for k, v in pairs.get((i, j), ()):
                    expected = expected + self.matrices[k].scale(v)
                if pairs.get((i, j)) and den != 1 and self.field.degree == 1:
                    expected = expected.scale(self.field.one / self.field.convert(den))
                if not (a @ b - b @ a - expected).is_zero():
                    raise RepresentationError(
                        (i, j), f"not a representation: rho([e{i}, e{j}]) differs from [rho(e{i}), rho(e{j})]"
                    )

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Representation):
            return NotImplemented
        return self.algebra == other.algebra and self.matrices == other.matrices and self.size == other.size

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        title = f"{self.name}: " if self.name else ""
        return f"<representation {title}of {self.algebra!r} on {self.field.name}^{self.size}>"


Matrices = Sequence[Any]
