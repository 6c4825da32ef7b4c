"""SymmetricMatrices(k): SO(k) on Sym(k) by S -> Q S Q^T, whose orbits are the matrices with given eigenvalues.

    rho(A) S = A S - S A,    g_S = so(m_1) + ... + so(m_r)  for eigenvalues of multiplicities m_1, ..., m_r

The isotropy of S is full if and only if one eigenvalue is simple and the others are equal (projective space), or all
are equal (a point): the paper's remark on Sym(k) in section 6. Every field on an orbit is S' = [A(S), S] with A(S)
skew-symmetric, an isospectral flow: see `isospectral`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias, final, overload

import numpy as np
import numpy.typing as npt

from liehom.algebra import Subalgebra
from liehom.algebra.closure.closure import square_matrices
from liehom.errors import InputError, ShapeError
from liehom.homogeneous import GeneratorField
from liehom.homogeneous.fields.components import joined
from liehom.homogeneous.fields.signature import takes_time
from liehom.representations import Pair, Representation, sym_conjugation
from liehom.scalars import ExactMatrix, Polynomial
from liehom.scalars.fields.field import MatrixLike
from liehom.series.jet import Jet
from liehom.typing import IntegerArray, Real, ScalarLike, Values

ArrayOrJet: TypeAlias = npt.ArrayLike | Jet
"""Points or matrices as an array, as lists, or as a Taylor series."""

RTOL = 1e-10
"""Relative tolerance for symmetry, and default tolerance for equal eigenvalues."""


@final
class SymmetricMatrices:
    """SO(k) on the symmetric k x k matrices, with coordinates.

    Parameters
    ----------
    k : int
        Size of the matrices, at least 2.

    Attributes
    ----------
    representation : Representation
        so(k) on the k (k + 1) / 2 entries S[i, j], i <= j, in lexicographic order (`liehom.sym_conjugation`).

    Raises
    ------
    InputError
        If k is not an integer at least 2.

    Examples
    --------
    >>> space = SymmetricMatrices(4)
    >>> space.isotropy((2, 2)).dimension, space.is_full((2, 2)), space.is_full((3, 1))
    (2, False, True)
    >>> space.to_matrix(SymmetricMatrices(2).to_vector([[1.0, 2.0], [2.0, 3.0]]))
    Traceback (most recent call last):
    ...
    liehom.errors.ShapeError: a point of Sym(4) has 10 coordinates on its last axis, got shape (3,)
    """

    __slots__ = ("_columns", "_place", "_rows", "k", "representation")

    def __init__(self, k: int) -> None:
        if isinstance(k, bool) or not isinstance(k, int | np.integer) or k < 2:
            raise InputError(f"the size of the matrices is an integer at least 2, got {k!r}")
        self.k: int = int(k)
        self.representation: Representation = sym_conjugation(self.k)
        # standard basis of so(k): for i < j the matrix with entry 1 at (j, i)
        self._columns, self._rows = (x.copy() for x in np.triu_indices(self.k, 1))
        upper = np.triu_indices(self.k)
        index: IntegerArray = np.zeros((self.k, self.k), dtype=int)
        index[upper] = np.arange(upper[0].size)
        # the index of the coordinate that is the entry (i, j); pickles refer to it by this name
        self._place: IntegerArray = np.maximum(index, index.T)

    # -- coordinates -------------------------------------------------------------------------------------
    @overload
    def to_matrix(self, m: Jet) -> Jet: ...
    @overload
    def to_matrix(self, m: npt.ArrayLike) -> npt.NDArray[Any]: ...
    def to_matrix(self, m: ArrayOrJet) -> Any:
        """Matrices (..., k, k) of points (..., k (k + 1) / 2), arrays or Jets.

        Raises
        ------
        ShapeError
            If the last axis does not have that length.

        Examples
        --------
        >>> SymmetricMatrices(2).to_matrix([1.0, 2.0, 3.0]).tolist()
        [[1.0, 2.0], [2.0, 3.0]]
        """
        point: Any = m if hasattr(m, "shape") else np.asarray(m)
        if point.shape[-1:] != (self.representation.size,):
            raise ShapeError(
                f"a point of Sym({self.k}) has {self.representation.size} coordinates on its last axis, got shape "
                f"{point.shape}"
            )
        return point[..., self._place]

    @overload
    def to_vector(self, matrix: Jet) -> Jet: ...
    @overload
    def to_vector(self, matrix: npt.ArrayLike) -> npt.NDArray[Any]: ...
    def to_vector(self, matrix: ArrayOrJet) -> Any:
        """Points (..., k (k + 1) / 2) of symmetric matrices (..., k, k), arrays or Jets; the upper half is read.

        Raises
        ------
        ShapeError
            If the last two axes are not k and k.
        InputError
            If an array is not symmetric, beyond round-off.

        Examples
        --------
        >>> SymmetricMatrices(2).to_vector([[[1.0, 2.0], [2.0, 3.0]]]).tolist()
        [[1.0, 2.0, 3.0]]
        """
        square = self._square(matrix)
        if not isinstance(square, Jet) and square.dtype.kind in "iuf":
            gap = np.abs(square - np.swapaxes(square, -1, -2)).max(initial=0.0)
            if not gap <= RTOL * np.abs(square).max(initial=0.0):
                raise InputError(f"the matrix is not symmetric: entries differ by {gap:.3g} from their mirror images")
        upper = np.triu_indices(self.k)
        return square[..., upper[0], upper[1]]

    @overload
    def to_generator(self, skew: Jet) -> Jet: ...
    @overload
    def to_generator(self, skew: npt.ArrayLike) -> npt.NDArray[Any]: ...
    def to_generator(self, skew: ArrayOrJet) -> Any:
        """Coefficients (..., k (k - 1) / 2) in so(k) of skew-symmetric matrices (..., k, k); the lower half is read.

        Examples
        --------
        >>> SymmetricMatrices(2).to_generator([[0.0, -2.0], [2.0, 0.0]]).tolist()
        [2.0]
        """
        return self._square(skew)[..., self._rows, self._columns]

    # -- isotropy ----------------------------------------------------------------------------------------
    def point(self, multiplicities: Sequence[int], eigenvalues: Sequence[ScalarLike] | None = None) -> list[ScalarLike]:
        """The diagonal matrix with eigenvalues of given multiplicities, as a point, a list of coordinates.

        Parameters
        ----------
        multiplicities : sequence of int
            Positive, with sum k.
        eigenvalues : sequence, optional
            One for each multiplicity, all different (default: 1, 2, ..., exact).

        Raises
        ------
        InputError
            If the multiplicities do not have the sum k, or the eigenvalues are not different.

        Examples
        --------
        >>> SymmetricMatrices(3).point((2, 1))
        [1, 0, 0, 1, 0, 2]
        """
        parts = self._parts(multiplicities)
        values = list(range(1, len(parts) + 1)) if eigenvalues is None else list(eigenvalues)
        if len(values) != len(parts) or any(x == y for i, x in enumerate(values) for y in values[:i]):
            raise InputError(f"eigenvalues {values}: expected {len(parts)} different ones for multiplicities {parts}")
        diagonal = [x for x, count in zip(values, parts, strict=True) for _ in range(count)]
        return [diagonal[i] if i == j else 0 for i, j in zip(*np.triu_indices(self.k), strict=True)]

    def isotropy(self, multiplicities: Sequence[int]) -> Subalgebra:
        """The isotropy subalgebra so(m_1) + ... + so(m_r) of `point`, exact.

        Examples
        --------
        >>> SymmetricMatrices(5).isotropy((3, 2)).dimension
        4
        """
        return self.representation.isotropy(self.point(multiplicities))

    def pair(self, multiplicities: Sequence[int]) -> Pair:
        """The pair (so(k), isotropy), which `liehom.decide_fullness` decides.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.decide_fullness(SymmetricMatrices(4).pair((2, 1, 1))).full
        False
        """
        return self.representation.pair(self.point(multiplicities))

    def is_full(self, multiplicities: Sequence[int]) -> bool:
        """Whether isotropy and τ raise a step to any order on the orbit: multiplicities (k - 1, 1) or (k,).

        Notes
        -----
        This is a theorem. ``liehom.decide_fullness(space.pair(multiplicities))`` proves it for each k.

        Examples
        --------
        >>> [SymmetricMatrices(3).is_full(p) for p in [(3,), (2, 1), (1, 1, 1)]]
        [True, True, False]
        """
        parts = sorted(self._parts(multiplicities))
        return len(parts) == 1 or (len(parts) == 2 and parts[0] == 1)

    def multiplicities(self, matrix: MatrixLike, *, rtol: float = RTOL) -> tuple[int, ...]:
        """Multiplicities of the eigenvalues of one symmetric matrix, in decreasing order.

        Parameters
        ----------
        matrix : (k, k) array_like
            For exact entries (integers, fractions, ...) the result is exact, by the characteristic polynomial.
        rtol : float
            For floats: eigenvalues closer than this, relative to the largest, count as equal.

        Raises
        ------
        ShapeError, InputError
            If the argument is not one symmetric matrix of size k.

        Examples
        --------
        >>> space = SymmetricMatrices(3)
        >>> space.multiplicities([[2, 1, 1], [1, 2, 1], [1, 1, 2]])
        (2, 1)
        >>> space.multiplicities([[2, 1, 0], [1, 2, 1], [0, 1, 2]])
        (1, 1, 1)
        >>> import numpy as np
        >>> space.multiplicities(np.ones((3, 3)))
        (2, 1)
        """
        (made,) = square_matrices([matrix])
        if made.nrows != self.k:
            raise ShapeError(f"expected a matrix of size {self.k}, got one of size {made.nrows}")
        if not isinstance(made, ExactMatrix):
            values = np.linalg.eigvalsh(self.to_matrix(self.to_vector(made.to_numpy())))
            far = np.diff(values) > rtol * np.abs(values).max(initial=0.0)
            counts = np.diff(np.r_[0, np.flatnonzero(far) + 1, self.k])
            return tuple(sorted(map(int, counts), reverse=True))
        if not (made - made.T).is_zero():
            raise InputError(f"the matrix is not symmetric: {matrix}")
        parts = Polynomial(made.field, made.characteristic_coefficients()).squarefree_parts()
        return tuple(sorted((count for part, count in parts for _ in range(part.degree)), reverse=True))

    # -- fields ------------------------------------------------------------------------------------------
    def flow(self, generator: Callable[..., Any], *, time_dependent: bool | None = None) -> GeneratorField:
        """The isospectral flow S' = [A(S), S] or S' = [A(S, t), S] of a skew-symmetric matrix A, a GeneratorField.

        Parameters
        ----------
        generator : callable
            A(S) or A(S, t), from S (..., k, k) and t (...,) to skew-symmetric matrices (..., k, k), written with numpy
            functions.
        time_dependent : bool, optional
            As for `GeneratorField`.

        Examples
        --------
        >>> import numpy as np
        >>> import liehom as lh
        >>> space = SymmetricMatrices(3)
        >>> a = np.array([[0, -1, 0], [1, 0, -2], [0, 2, 0.0]])
        >>> sol = lh.integrate(space.flow(lambda s: s @ a @ s), (0, 5), space.point((1, 1, 1)), dt=0.1)
        >>> np.linalg.eigvalsh(space.to_matrix(sol.y[:, -1])).round(12)
        array([1., 2., 3.])
        """
        timed = takes_time(generator) if time_dependent is None else bool(time_dependent)

        def psi(m: Values, t: Real) -> Any:
            s = self.to_matrix(m)
            return self.to_generator(joined(generator(s, t) if timed else generator(s), s))

        return GeneratorField(self.representation, psi if timed else lambda m: psi(m, 0.0), time_dependent=timed)

    # -- private -----------------------------------------------------------------------------------------
    def _square(self, matrix: ArrayOrJet) -> Any:
        square: Any = matrix if hasattr(matrix, "shape") else np.asarray(matrix)
        if square.shape[-2:] != (self.k, self.k):
            raise ShapeError(f"expected matrices of shape (..., {self.k}, {self.k}), got shape {square.shape}")
        return square

    def _parts(self, multiplicities: Sequence[int]) -> tuple[int, ...]:
        given = list(multiplicities)
        if any(isinstance(x, bool) or not isinstance(x, int | np.integer) or x < 1 for x in given) or (
            sum(given) != self.k
        ):
            raise InputError(f"multiplicities are positive integers with sum {self.k}, got {tuple(given)}")
        return tuple(int(x) for x in given)

    def __repr__(self) -> str:
        return f"SymmetricMatrices({self.k})"
