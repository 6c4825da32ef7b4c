"""Symmetric matrices under conjugation, and isospectral flows on them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import ceil
from typing import Any, TypeAlias, final, overload

import numpy as np
import numpy.typing as npt

from liehom.base.errors import InputError, ShapeError, checked_integer, displayed
from liehom.base.typing import Array, IntegerArray, Real, ScalarLike, Values
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.algebra.linear.closure import square_matrices
from liehom.exact.representations.constructions import sym_conjugation
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.core.representation import Representation
from liehom.exact.scalars.exact_field import ExactMatrix
from liehom.exact.scalars.field import MatrixLike
from liehom.exact.scalars.polynomial import Polynomial
from liehom.flow.action.components import joined, takes_time
from liehom.flow.action.field import GeneratorField
from liehom.flow.series.jet import Jet

# SymmetricMatrices(k): SO(k) on Sym(k) by S -> Q S Q^T, whose orbits are the matrices with given eigenvalues.
#     rho(A) S = A S - S A,    g_S = so(m_1) + ... + so(m_r)  for eigenvalues of multiplicities m_1, ..., m_r
# The isotropy of S is full if and only if one eigenvalue is simple and the others are equal (projective space), or all
# are equal (a point): the paper's remark on Sym(k) in section 6. Every field on an orbit is S' = [A(S), S] with A(S)
# skew-symmetric, an isospectral flow.

ArrayOrJet: TypeAlias = npt.ArrayLike | Jet  # points or matrices as an array, as lists, or as a Taylor series

RTOL = 1e-10  # relative tolerance for symmetry, and default tolerance for equal eigenvalues


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

    Examples
    --------
    >>> space = SymmetricMatrices(4)
    >>> space.isotropy((2, 2)).dimension, space.is_full((2, 2)), space.is_full((3, 1))
    (2, False, True)
    >>> space.to_matrix(SymmetricMatrices(2).to_vector([[1.0, 2.0], [2.0, 3.0]]))
    Traceback (most recent call last):
    ...
    liehom.base.errors.ShapeError: a point of Sym(4) has 10 coordinates on its last axis, got shape (3,)
    """

    __slots__ = ("_columns", "_place", "_rows", "k", "representation")

    def __init__(self, k: int) -> None:
        self.k: int = checked_integer(k, "the size of the matrices", 2)
        self.representation: Representation = sym_conjugation(self.k)
        # standard basis of so(k): for i < j the matrix with entry 1 at (j, i)
        self._columns, self._rows = (x.copy() for x in np.triu_indices(self.k, 1))
        upper = np.triu_indices(self.k)
        index: IntegerArray = np.zeros((self.k, self.k), dtype=int)
        index[upper] = np.arange(upper[0].size)
        # the index of the coordinate that is the entry (i, j); pickles refer to it by this name
        self._place: IntegerArray = np.maximum(index, index.T)

    @overload
    def to_matrix(self, m: Jet) -> Jet: ...
    @overload
    def to_matrix(self, m: npt.ArrayLike) -> npt.NDArray[Any]: ...
    def to_matrix(self, m: ArrayOrJet) -> Any:
        """Matrices (..., k, k) of points (..., k (k + 1) / 2), arrays or Jets.

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

    def point(self, multiplicities: Sequence[int], eigenvalues: Sequence[ScalarLike] | None = None) -> list[ScalarLike]:
        """The diagonal matrix with eigenvalues of given multiplicities, as a point, a list of coordinates.

        Parameters
        ----------
        multiplicities : sequence of int
            Positive, with sum k.
        eigenvalues : sequence, optional
            One for each multiplicity, all different (default: 1, 2, ..., exact).

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
        """The isotropy subalgebra so(m_1) + ... + so(m_r) of `point`, exact."""
        return self.representation.isotropy(self.point(multiplicities))

    def pair(self, multiplicities: Sequence[int]) -> Pair:
        """The pair (so(k), isotropy), which `liehom.decide_fullness` decides."""
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
        (square,) = square_matrices([matrix])
        if square.nrows != self.k:
            raise ShapeError(f"expected a matrix of size {self.k}, got one of size {square.nrows}")
        if not isinstance(square, ExactMatrix):
            values = np.linalg.eigvalsh(self.to_matrix(self.to_vector(square.to_numpy())))
            far = np.diff(values) > rtol * np.abs(values).max(initial=0.0)
            return tuple(sorted(map(int, np.diff(np.r_[0, np.flatnonzero(far) + 1, self.k])), reverse=True))
        if not (square - square.T).is_zero():
            raise InputError(f"the matrix is not symmetric: {matrix}")
        parts = Polynomial(square.field, square.characteristic_coefficients()).squarefree_parts()
        return tuple(sorted((count for part, count in parts for _ in range(part.degree)), reverse=True))

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

    def _square(self, matrix: ArrayOrJet) -> Any:
        square: Any = matrix if hasattr(matrix, "shape") else np.asarray(matrix)
        if square.shape[-2:] != (self.k, self.k):
            raise ShapeError(f"expected matrices of shape (..., {self.k}, {self.k}), got shape {square.shape}")
        return square

    def _parts(self, multiplicities: Sequence[int]) -> tuple[int, ...]:
        parts = list(multiplicities)
        if any(isinstance(x, bool) or not isinstance(x, int | np.integer) or x < 1 for x in parts) or (
            sum(parts) != self.k
        ):
            raise InputError(f"multiplicities are positive integers with sum {self.k}, got {tuple(parts)}")
        return tuple(int(x) for x in parts)

    def __repr__(self) -> str:
        return f"SymmetricMatrices({self.k})"


# Isospectral flows on Sym(k): the double bracket flow, the Toda flow, and QR flows with their solution.
#     S' = [S, [S, N]]                                              double bracket flow: sorts as N is sorted
#     S' = [S, P(f(S))],  P(X) = L - L^T, L the part of X below the diagonal            f(x) = x: Toda flow
# (R. W. Brockett, Linear Algebra Appl. 146, 1991; W. W. Symes, Physica D 4, 1982). With exp(t f(S_0)) = Q(t) R(t), R
# upper triangular with positive diagonal, S(t) = Q(t)^T S_0 Q(t) solves the second equation. At integer times S(t) is
# an iterate of the QR algorithm for exp(f(S_0)), and for f = log of the QR algorithm for S_0 itself.

SpectralFunction: TypeAlias = Callable[[Any], Any]
"""A function of an array of eigenvalues, entry by entry, such as `numpy.log`."""

MAX_SPREAD = 4.0  # exp(X) is factorized for eigenvalues of X at most this far apart, so for condition numbers up to e^4
SPECTRUM_RTOL = 1e-6
"""Relative tolerance for the invariants of a point, which must be those of the matrix that a QR flow is made for."""


def double_bracket_flow(n: npt.ArrayLike) -> GeneratorField:
    """The field S' = [S, [S, N]], the gradient flow of tr(S N) on the orbit, with A(S) = [N, S].

    Parameters
    ----------
    n : (..., k, k) array_like
        Symmetric. For a diagonal N with different entries, S tends to the diagonal matrix whose entries are sorted as
        those of N (except for initial points on lower-dimensional sets). Leading axes: one N for each trajectory.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = double_bracket_flow(np.diag([1.0, 3.0, 2.0]))
    >>> space = SymmetricMatrices(3)
    >>> start = space.to_vector([[2.0, 1.0, 0.0], [1.0, 2.0, 1.0], [0.0, 1.0, 2.0]])
    >>> end = space.to_matrix(lh.integrate(field, (0, 30), start).y[:, -1])
    >>> np.diag(end).round(6).tolist()
    [0.585786, 3.414214, 2.0]
    """
    space, matrix = _space(n)
    space.to_vector(matrix)  # raises unless it is symmetric
    return space.flow(lambda s: matrix @ s - s @ matrix)


def toda_flow(k: int) -> GeneratorField:
    """The field S' = [S, P(S)], P(S) = L - L^T with the part L of S below the diagonal.

    Notes
    -----
    On tridiagonal S, which stay tridiagonal, it is the Toda lattice of k particles in Flaschka's variables: with
    diagonal a and off-diagonal b, a_i' = 2 (b_i^2 - b_{i-1}^2) and b_i' = b_i (a_{i+1} - a_i). As t tends to infinity,
    S tends to the diagonal matrix of the eigenvalues in decreasing order, for almost all initial points.

    Examples
    --------
    >>> import liehom as lh
    >>> field, space = toda_flow(2), SymmetricMatrices(2)
    >>> space.to_matrix(field.vector([1.0, 3.0, 2.0])).tolist()
    [[18.0, 3.0], [3.0, -18.0]]
    """
    space = SymmetricMatrices(k)
    return space.flow(lambda s: _upper_minus_lower(space, s))


def qr_flow(start: npt.ArrayLike, function: SpectralFunction = np.log) -> GeneratorField:
    """The field S' = [S, P(f(S))] through S_0; for f = log, S(1), S(2), ... are the iterates of the QR algorithm.

    Parameters
    ----------
    start : (..., k, k) array_like
        S_0. The eigenvalues are constant, so f(S) is the polynomial in S that interpolates f at the eigenvalues, and
        the field can be expanded for any f. The field is valid for points with this spectrum only (leading axes: one
        spectrum for each trajectory).
    function : callable
        f, on an array of eigenvalues (default: the logarithm, for positive definite S_0).

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> start, space = np.array([[2.0, 1.0, 0.0], [1.0, 3.0, 1.0], [0.0, 1.0, 4.0]]), SymmetricMatrices(3)
    >>> sol = lh.integrate(qr_flow(start), (0, 1), space.to_vector(start), rtol=1e-12, atol=1e-14)
    >>> q, r = np.linalg.qr(start)
    >>> bool(np.allclose(np.abs(space.to_matrix(sol.y[:, -1])), np.abs(r @ q), atol=1e-10))
    True
    """
    space, initial = _space(start)
    matrix: Any = space.to_matrix(space.to_vector(initial))
    spectrum: Array = np.linalg.eigvalsh(matrix)
    nodes, coefficients = _interpolated(spectrum, _values(function, spectrum))
    sums, squares = spectrum.sum(axis=-1), (spectrum**2).sum(axis=-1)

    def generator(s: Values) -> Values:
        if not isinstance(s, Jet) and s.dtype.kind == "f":
            other: Any = np.abs(np.trace(s, axis1=-2, axis2=-1) - sums) > SPECTRUM_RTOL * np.sqrt(squares)
            other |= np.abs((s * s).sum(axis=(-1, -2)) - squares) > SPECTRUM_RTOL * squares
            if bool(np.any(other)):
                raise InputError("the point has other eigenvalues than the matrix that the QR flow was made for")
        identity = np.eye(space.k)
        total: Values = coefficients[..., -1, None, None] * identity
        for i in range(space.k - 2, -1, -1):
            total = total @ (s - nodes[..., i, None, None] * identity) + coefficients[..., i, None, None] * identity
        return _upper_minus_lower(space, total)

    return space.flow(generator)


def qr_solution(start: npt.ArrayLike, t: npt.ArrayLike, function: SpectralFunction | None = None) -> Array:
    """The solution S(t) = Q^T S_0 Q of `toda_flow` or `qr_flow`, exp(t f(S_0)) = Q R, in closed form.

    Parameters
    ----------
    start : (..., k, k) array_like
        S_0.
    t : float or array_like
        Times: one for all matrices, or of a shape that broadcasts against their leading axes.
    function : callable, optional
        f, on an array of eigenvalues (default: f(x) = x, the Toda flow).

    Returns
    -------
    array of shape (..., k, k)

    Notes
    -----
    exp(t f(S_0)) is factorized in equal parts of t, as many as are needed for condition numbers of at most e^4, so that
    there is no overflow and every column of Q is accurate.

    Examples
    --------
    >>> import numpy as np
    >>> np.round(np.diag(qr_solution([[1.0, 1.0], [1.0, 3.0]], 20.0)) - 2, 9)
    array([ 1.41421356, -1.41421356])
    """
    space, initial = _space(start)
    times = np.asarray(t, dtype=float)
    if not bool(np.isfinite(times).all()):
        raise InputError(f"the time is {times}, expected finite numbers")
    try:
        lead = np.broadcast_shapes(times.shape, initial.shape[:-2])
    except ValueError:
        raise ShapeError(f"times of shape {times.shape} for matrices of shape {initial.shape}") from None
    s: Any = np.broadcast_to(space.to_matrix(space.to_vector(initial)), (*lead, space.k, space.k))
    eigenvalues, vectors = np.linalg.eigh(s)
    exponents = times[..., None] * _values((lambda x: x) if function is None else function, eigenvalues)
    exponents = exponents - exponents.max(axis=-1, keepdims=True)
    parts = max(1, ceil(float(-exponents.min(initial=0.0)) / MAX_SPREAD))
    sizes = np.exp(exponents / parts)[..., None, :]
    for _ in range(parts):
        q, r = np.linalg.qr(vectors * sizes @ np.swapaxes(vectors, -1, -2))
        diagonal = np.diagonal(r, axis1=-2, axis2=-1)
        vectors = np.swapaxes(q * np.where(diagonal < 0, -1.0, 1.0)[..., None, :], -1, -2) @ vectors
    return vectors * eigenvalues[..., None, :] @ np.swapaxes(vectors, -1, -2)


def _space(matrix: npt.ArrayLike) -> tuple[SymmetricMatrices, npt.NDArray[Any]]:
    """The space of symmetric matrices of the size of these, and the matrices as an array (..., k, k)."""
    array = np.asarray(matrix)
    if array.ndim < 2 or array.shape[-1] != array.shape[-2] or array.shape[-1] < 2:
        raise ShapeError(f"expected square matrices of size at least 2, got shape {array.shape}")
    if array.dtype.kind not in "iuf" or not bool(np.isfinite(array).all()):
        raise InputError(f"expected a matrix of finite real numbers, got {displayed(array)}")
    return SymmetricMatrices(array.shape[-1]), array


def _upper_minus_lower(space: SymmetricMatrices, x: Values) -> Values:
    """L^T - L for the part L of a symmetric X below the diagonal: S' = [A, S] with A = -P(X)."""
    signs = np.triu(np.ones((space.k, space.k), dtype=int), 1)
    return x * (signs - signs.T)


def _values(function: SpectralFunction, spectrum: Array) -> Array:
    """f at the eigenvalues, checked."""
    with np.errstate(all="ignore"):
        values = np.asarray(function(spectrum), dtype=float)
    if values.shape != spectrum.shape:
        raise ShapeError(f"f returned shape {values.shape} for eigenvalues of shape {spectrum.shape}")
    if not bool(np.isfinite(values).all()):
        bad = np.broadcast_to(spectrum, values.shape)[~np.isfinite(values)]
        raise InputError(f"f is not finite at the eigenvalue {bad[0]:.6g}: it must be defined on the spectrum")
    return values


def _interpolated(spectrum: Array, values: Array) -> tuple[Array, Array]:
    """Nodes in Leja order, equal ones once, and coefficients of Newton's interpolation polynomial, (..., k) each."""
    k = spectrum.shape[-1]
    nodes, coefficients = spectrum.copy(), np.zeros_like(values)
    left, f = spectrum.copy(), values.copy()
    tiny = 64 * k * np.finfo(float).eps * np.abs(spectrum).max(axis=-1)
    products, nearest = np.ones_like(spectrum), np.full_like(spectrum, np.inf)
    for i in range(k):
        measure = np.abs(left) if i == 0 else np.abs(products)
        chosen = np.argmax(np.where(nearest > tiny[..., None], measure, -1.0), axis=-1)[..., None]
        new = np.take_along_axis(nearest, chosen, axis=-1)[..., 0] > tiny
        x, y = (np.take_along_axis(a, chosen, axis=-1)[..., 0] for a in (left, f))
        total, product = np.zeros_like(x), np.ones_like(x)
        for j in range(i):
            total, product = total + coefficients[..., j] * product, product * (x - nodes[..., j])
        coefficients[..., i] = np.where(new, (y - total) / np.where(new, product, 1.0), 0.0)
        nodes[..., i] = x
        products, nearest = products * (left - x[..., None]), np.minimum(nearest, np.abs(left - x[..., None]))
    return nodes, coefficients
