"""Representation: a homomorphism rho from a Lie algebra to matrices, checked at construction.

rho([x, y]) = rho(x) rho(y) - rho(y) rho(x).  Vectors are columns: rho(x) v.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, final

from liehom.algebra import LieAlgebra, Subalgebra
from liehom.algebra.closure.closure import Completion, lie_closure, square_matrices
from liehom.errors import InputError, RepresentationError, ShapeError
from liehom.representations.core.analysis_verbs import AnalysisVerbs
from liehom.representations.core.pair import Pair
from liehom.representations.invariants.bracket_proof import failing_pair
from liehom.representations.invariants.induced import (
    EntryMap,
    block_map,
    dual_map,
    exterior_power_map,
    left_factor_map,
    right_factor_map,
    symmetric_power_map,
)
from liehom.representations.invariants.stabilizer import orbit_dimension, stabilizer
from liehom.scalars import Field, FloatField


@final
class Representation(AnalysisVerbs):
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
        cls,
        matrices: Any,
        *,
        field: Field | None = None,
        independent: bool = False,
        name: str | None = None,
        completion: Completion = "auto",
    ) -> Representation:
        """The Lie algebra that matrices generate, with its defining representation.

        The first basis elements are the given matrices in order; missing brackets are appended in
        lexicographic order of (i, j), or reduced matrices where the brackets would give numbers of thousands of digits.

        Parameters
        ----------
        matrices : sequence of (N, N) array_like
        field : Field, optional
            By default the field that the entries call for (float64 if one is a float).
        independent : bool
            Drop matrices that depend on earlier ones; `dropped` of the closure says which (default: refuse).
        name : str, optional
        completion : {'auto', 'commutators', 'reduced'}
            What is appended; see `liehom.algebra.lie_closure`.

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
        made = lie_closure(matrices, field=field, independent=independent, completion=completion)
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
    def __iter__(self) -> Iterator[Any]:
        """The matrices rho(e_i), so that a representation may stand where a list of matrices is expected."""
        return iter(self.matrices)

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

    # -- constructions -----------------------------------------------------------------------------------
    def dual(self) -> Representation:
        """The dual representation x -> -rho(x)^T, in the dual basis.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.adjoint(lh.so(3)).dual() == lh.coadjoint(lh.so(3))
        True
        """
        return self._induced(dual_map(self.size))  # -[A, B]^T = [-A^T, -B^T]

    def direct_sum(self, other: Representation) -> Representation:
        """The direct sum with another representation of the same algebra: block matrices, this one first.

        Raises
        ------
        InputError
            If the other is a representation of another algebra.
        """
        self._require_same_algebra(other)
        total = self.size + other.size
        return self._joined(other, block_map(self.size, total, 0), block_map(other.size, total, self.size))

    def tensor(self, other: Representation) -> Representation:
        """The tensor product rho(x) (x) 1 + 1 (x) sigma(x), basis e_i (x) f_j in lexicographic order of (i, j).

        Raises
        ------
        InputError
            If the other is a representation of another algebra.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.defining(lh.so(3)).tensor(lh.trivial(lh.so(3), 2)).size
        6
        """
        self._require_same_algebra(other)
        n, m = self.size, other.size
        return self._joined(other, left_factor_map(n, m), right_factor_map(n, m))

    def symmetric_power(self, k: int) -> Representation:
        """The action on Sym^k by derivations, in monomials x_i1 ... x_ik, i1 <= ... <= ik, in lexicographic order.

        Examples
        --------
        >>> import liehom as lh
        >>> print(lh.defining(lh.sl(2)).symmetric_power(2).matrices[0])  # on x^2, xy, y^2
        [0, 1, 0]
        [0, 0, 2]
        [0, 0, 0]
        """
        return self._induced(symmetric_power_map(self.size, k))  # [D_A, D_B] = D_[A, B] for derivations

    def exterior_power(self, k: int) -> Representation:
        """The action on Lambda^k by derivations, in wedges e_i1 ^ ... ^ e_ik, i1 < ... < ik, lexicographically.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.defining(lh.so(4)).exterior_power(2).size
        6
        """
        return self._induced(exterior_power_map(self.size, k))  # [D_A, D_B] = D_[A, B] for derivations

    def restriction(self, subalgebra: Subalgebra) -> Representation:
        """The restriction to a subalgebra, as a representation of ``subalgebra.as_algebra()``.

        Raises
        ------
        InputError
            If it is a subalgebra of another algebra.
        """
        if subalgebra.algebra is not self.algebra and subalgebra.algebra != self.algebra:
            raise InputError("the subalgebra belongs to another Lie algebra")
        n = self.size
        flat = self.field.stack_rows([a.reshape(1, n * n) for a in self.matrices], n * n)
        made = (subalgebra.basis @ flat).split_rows(n, n) if self.matrices else []
        return self._proved(subalgebra.as_algebra(), made, n)  # a homomorphism restricted to a subalgebra

    def over(self, field: Field) -> Representation:
        """The same matrices read in another field that contains their entries.

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.defining(lh.so(3)).over(lh.number_field("sqrt(2)"))
        >>> rho.isotropy(["sqrt(2)", 1, 0]).rows()
        [[0, -1/2*sqrt(2), 1]]
        """
        made = [self._read_in(field, a) for a in self.matrices]
        return self._proved(self.algebra.over(field), made, self.size, name=self.name)  # the same identities

    def _read_in(self, field: Field, matrix: Any) -> Any:
        if isinstance(field, FloatField):
            return field.from_entries(matrix.to_numpy().ravel().tolist(), self.size, self.size)
        return field.matrix(matrix.to_rows(), (self.size, self.size))

    def _induced(self, entry_map: EntryMap) -> Representation:
        return self._proved(self.algebra, [entry_map(a) for a in self.matrices], entry_map.target)

    def _joined(self, other: Representation, left: EntryMap, right: EntryMap) -> Representation:
        pairs = zip(self.matrices, other.matrices, strict=True)
        # The two summands commute, and each is a representation.
        return self._proved(self.algebra, [left(a) + right(b) for a, b in pairs], left.target)

    def _proved(self, algebra: LieAlgebra, matrices: Any, size: int, name: str | None = None) -> Representation:
        """A representation whose identity the caller has proved (the reason stands where this is called)."""
        return Representation(algebra, matrices, size=size, name=name, check=False)

    def _require_same_algebra(self, other: Representation) -> None:
        if not isinstance(other, Representation):
            raise InputError(f"expected a Representation of the same algebra, such as lh.adjoint(g); got {other!r}")
        if other.algebra is not self.algebra and other.algebra != self.algebra:
            raise InputError(f"representations of two algebras, {self.algebra!r} and {other.algebra!r}")

    def _prove(self) -> None:
        failure = failing_pair(self.algebra, self.matrices)
        if failure is not None:
            i, j = failure
            raise RepresentationError(
                (i, j), f"not a representation: rho([e{i}, e{j}]) differs from [rho(e{i}), rho(e{j})]"
            )

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Representation):
            return NotImplemented
        return self.algebra == other.algebra and self.matrices == other.matrices and self.size == other.size

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        title = f"{self.name!r} " if self.name else ""
        return f"<representation {title}of {self.algebra!r} on {self.field.name}^{self.size}>"


Matrices = Sequence[Any]
