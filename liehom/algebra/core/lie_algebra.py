"""LieAlgebra: a finite-dimensional real Lie algebra given by structure constants.

[e_i, e_j] = sum_k c[i, j, k] e_k.  Antisymmetry and the Jacobi identity are proved at construction.
Elements are coefficient vectors of length `dimension`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, final

import numpy as np

from liehom.algebra.core.jacobi import prove_jacobi
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.algebra.core.structure_verbs import StructureVerbs
from liehom.algebra.core.tables import constants_from, field_of_constants
from liehom.errors import InputError, ShapeError
from liehom.scalars import Field, FloatField, Scalar, Subspace

if TYPE_CHECKING:
    from liehom.algebra.core.subalgebra import Subalgebra

SHOWN_TERMS = 8


@final
class LieAlgebra(StructureVerbs):
    """A real Lie algebra in a basis e_0, ..., e_{n-1}.

    Parameters
    ----------
    constants : array_like, scipy.sparse array, mapping, or StructureConstants
        ``c[i, j, k]`` of shape (n, n, n), or ``{(i, j): {k: value}}`` where i > j is filled in by
        antisymmetry, or a sparse array of shape (n * n, n) with row i * n + j the bracket [e_i, e_j].
    field : Field, optional
        The field of the constants. By default QQ for integers and fractions, a number field for values such
        as 'sqrt(2)/2', float64 for float arrays.
    dimension : int, optional
        Needed with a mapping (elements that appear in no bracket count).
    basis : sequence of str, optional
        Names of the basis elements, by default e0, e1, ...
    name : str, optional
        A name to print, such as 'so(3)'.
    check : bool, optional
        Prove the axioms (default). False is for callers that have proved them.

    Raises
    ------
    StructureError
        If an index is out of range or the table is not antisymmetric.
    JacobiError
        If the Jacobi identity fails; names i, j, k.
    FieldError, ParseError
        If a value is not in the field.

    Notes
    -----
    A Lie algebra is a vector space with a bilinear bracket that is antisymmetric and satisfies
    [[x, y], z] + [[y, z], x] + [[z, x], y] = 0.

    Examples
    --------
    >>> import liehom as lh
    >>> so3 = lh.LieAlgebra({(0, 1): {2: 1}, (1, 2): {0: 1}, (0, 2): {1: -1}}, dimension=3)
    >>> so3.bracket([1, 0, 0], [0, 1, 0])
    array([0, 0, 1], dtype=object)
    >>> so3.killing_signature()
    (0, 3, 0)
    """

    __slots__ = ("_constants", "basis_names", "name")

    def __init__(
        self,
        constants: Any,
        field: Field | None = None,
        *,
        dimension: int | None = None,
        basis: Sequence[str] | None = None,
        name: str | None = None,
        check: bool = True,
    ) -> None:
        if isinstance(constants, StructureConstants):
            if field not in (None, constants.field) or dimension not in (None, constants.dimension):
                found = f"{constants.field.name}, of dimension {constants.dimension}"
                raise InputError(f"the table is over {found}; another field is reached by over()")
            self._constants = constants
        else:
            over = field if field is not None else field_of_constants(constants)
            self._constants = constants_from(constants, over, dimension)
        n = self._constants.dimension
        self.basis_names = tuple(f"e{i}" for i in range(n)) if basis is None else _checked_names(basis, n)
        self.name = name
        if check:
            prove_jacobi(self._constants, self.basis_names)

    # -- constructors ------------------------------------------------------------------------------------
    @classmethod
    def from_matrices(cls, matrices: Any, *, name: str | None = None) -> LieAlgebra:
        """The Lie algebra that matrices span, closing them under commutators first.

        Parameters
        ----------
        matrices : sequence of (N, N) array_like
            Linearly independent. The first basis elements are these, in order; missing brackets follow.

        Returns
        -------
        LieAlgebra
            Its Jacobi identity holds because commutators of matrices satisfy it.

        Raises
        ------
        DependentRowsError, ShapeError
            If the matrices are dependent, or not square of one size.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.LieAlgebra.from_matrices([[[0, 1], [0, 0]], [[0, 0], [1, 0]]]).dimension
        3
        """
        from liehom.algebra.closure.closure import lie_closure

        return lie_closure(matrices, name=name).algebra

    # -- properties --------------------------------------------------------------------------------------
    @property
    def field(self) -> Field:
        """The field of the structure constants."""
        return self._constants.field

    @property
    def dimension(self) -> int:
        """The dimension."""
        return self._constants.dimension

    @property
    def table(self) -> StructureConstants:
        """The sparse bracket table."""
        return self._constants

    def structure_constants(self) -> Iterator[tuple[int, int, int, Scalar]]:
        """The non-zero entries (i, j, k, value) with i < j."""
        return iter(self._constants)

    def is_abelian(self) -> bool:
        """Whether all brackets vanish."""
        return len(self._constants) == 0

    # -- verbs -------------------------------------------------------------------------------------------
    def row(self, x: Any) -> Any:
        """A coefficient vector as a row matrix (1, n); `ShapeError` if its length is not n."""
        matrix = self.field.matrix([x])
        if matrix.ncols != self.dimension:
            raise ShapeError(f"an element has {matrix.ncols} coefficients, expected {self.dimension}")
        return matrix

    def bracket(self, x: Any, y: Any) -> Any:
        """The bracket [x, y] of two coefficient vectors, as a numpy array of field elements.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(3).bracket([1, 0, 0], ["1/2", 1, 0])
        array([0, 0, 1], dtype=object)
        """
        if self.dimension == 0:
            return self._vector([])
        return self._vector((self.row(y) @ self.ad(x).T).row(0))

    def _vector(self, values: list[Scalar]) -> Any:
        if not self.field.exact:
            return np.array(values, dtype=np.float64)
        out = np.empty(len(values), dtype=object)
        out[:] = values
        return out

    def ad(self, x: Any) -> Any:
        """The matrix (n, n) of y -> [x, y], acting on columns of coefficients.

        Examples
        --------
        >>> import liehom as lh
        >>> print(lh.LieAlgebra({(0, 1): {1: 2}}, dimension=2).ad([1, 0]))
        [0, 0]
        [0, 2]
        """
        return self._constants.adjoint(self.field.read(x) if hasattr(x, "nrows") else self.row(x))

    def killing_form(self) -> Any:
        """The matrix (n, n) of the Killing form, tr(ad e_i ad e_j).

        Examples
        --------
        >>> import liehom as lh
        >>> print(lh.so(3).killing_form())
        [-2, 0, 0]
        [0, -2, 0]
        [0, 0, -2]
        """
        from liehom.algebra.core.killing import killing_form

        return killing_form(self._constants)

    def killing_signature(self) -> tuple[int, int, int]:
        """Numbers of (positive, negative, zero) eigenvalues of the Killing form."""
        return self.killing_form().signature()  # type: ignore[no-any-return]

    def subalgebra(self, rows: Any) -> Subalgebra:
        """The subalgebra with these rows of coefficients, shape (k, n), as its basis.

        Raises
        ------
        DependentRowsError
            If the rows are dependent.
        NotASubalgebraError
            If their span is not closed; names the bracket that leaves it.
        ShapeError
            If a row does not have length n.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(3).subalgebra([[1, 0, 0], [0, 1, 0]])
        Traceback (most recent call last):
        ...
        liehom.errors.NotASubalgebraError: the rows do not span a subalgebra: the bracket of rows 0 and 1 is ...
        """
        from liehom.algebra.core.subalgebra import Subalgebra

        return Subalgebra(self, rows)

    def subalgebra_generated_by(self, rows: Any) -> Subalgebra:
        """The least subalgebra that contains the rows."""
        from liehom.algebra.core.subalgebra import generated

        return generated(self, rows)

    def center(self) -> Subalgebra:
        """The centre {x : [x, g] = 0}."""
        from liehom.algebra.core.subalgebra import centralizer

        return centralizer(self, self.field.identity(self.dimension))

    def centralizer(self, rows: Any) -> Subalgebra:
        """The subalgebra {x : [x, r] = 0 for each row r}."""
        from liehom.algebra.core.subalgebra import centralizer

        return centralizer(self, rows)

    def normalizer(self, subalgebra: Any) -> Subalgebra:
        """The subalgebra {x : [x, h] is in h} of a subalgebra h (a `Subalgebra` or rows)."""
        from liehom.algebra.core.subalgebra import normalizer

        return normalizer(self.own(subalgebra))

    def own(self, subalgebra: Any) -> Subalgebra:
        """A subalgebra of this algebra from its rows, or itself; `InputError` if it is that of another algebra."""
        from liehom.algebra.core.subalgebra import Subalgebra

        if not isinstance(subalgebra, Subalgebra):
            return Subalgebra(self, subalgebra)
        if subalgebra.algebra is not self and subalgebra.algebra != self:
            raise InputError(f"{subalgebra!r} is no subalgebra of {self!r}")
        return subalgebra

    def ideal_generated_by(self, rows: Any) -> Subalgebra:
        """The least ideal that contains the rows.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.gl(2).ideal_generated_by([[0, 1, 0, 0]]).dimension
        3
        """
        from liehom.algebra.core.subalgebra import ideal_generated

        return ideal_generated(self, rows)

    def derived_series(self) -> list[Subalgebra]:
        """g, [g, g], [[g, g], [g, g]], ... down to the first term that repeats (which is listed once)."""
        from liehom.algebra.core.subalgebra import derived_series

        return derived_series(self)

    def derived_subalgebra(self) -> Subalgebra:
        """The ideal [g, g].

        Examples
        --------
        >>> import liehom as lh
        >>> lh.gl(2).derived_subalgebra().dimension
        3
        """
        terms = self.derived_series()
        return terms[1] if len(terms) > 1 else terms[0]

    def upper_central_series(self) -> list[Subalgebra]:
        """0, the centre, the preimage of the centre of g modulo the centre, ... up to the first term that repeats."""
        from liehom.algebra.core.subalgebra import upper_central_series

        return upper_central_series(self)

    def lower_central_series(self) -> list[Subalgebra]:
        """g, [g, g], [g, [g, g]], ... down to the first term that repeats (which is listed once)."""
        from liehom.algebra.core.subalgebra import lower_central_series

        return lower_central_series(self)

    def change_of_basis(self, rows: Any, *, name: str | None = None) -> LieAlgebra:
        """The same algebra in the basis given by the rows (n, n), coefficients in the present basis.

        Raises
        ------
        SingularError
            If the rows are dependent.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(3).change_of_basis([[2, 0, 0], [0, 1, 0], [0, 0, 1]]).bracket([1, 0, 0], [0, 1, 0])
        array([0, 0, 2], dtype=object)
        """
        n = self.dimension
        matrix = self.field.read(rows, (n, n))
        if matrix.shape != (n, n):
            raise ShapeError(f"a change of basis has shape {(n, n)}, got {matrix.shape}")
        # An isomorphic copy of a Lie algebra: the axioms hold.
        return LieAlgebra(self._constants.changed(matrix, matrix.inverse()), name=name, check=False)

    def over(self, field: Field) -> LieAlgebra:
        """The same structure constants read in another field that contains them.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(3).over(lh.number_field("sqrt(2)"))
        <Lie algebra so(3) of dimension 3 over QQ(sqrt(2))>
        """
        if not isinstance(field, Field):
            raise InputError(f"expected a field such as lh.QQ, lh.RR or lh.number_field('sqrt(2)'), got {field!r}")
        if isinstance(field, FloatField):
            entries = [(i, j, k, self.field.to_float(v)) for i, j, k, v in self._constants]
        else:
            entries = [(i, j, k, field.convert(v)) for i, j, k, v in self._constants]
        table = StructureConstants(field, self.dimension, entries)
        return LieAlgebra(table, basis=self.basis_names, name=self.name, check=False)  # same identities

    def whole(self) -> Subspace:
        """The algebra as a subspace of itself."""
        return Subspace(self.field, self.field.identity(self.dimension), self.dimension)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, LieAlgebra) and self._constants == other._constants

    __hash__ = None  # type: ignore[assignment]

    # -- printing ----------------------------------------------------------------------------------------
    def __repr__(self) -> str:
        title = f"{self.name} " if self.name else ""
        return f"<Lie algebra {title}of dimension {self.dimension} over {self.field.name}>"

    def __str__(self) -> str:
        names = self.basis_names
        brackets: dict[tuple[int, int], list[str]] = {}
        for i, j, k, v in self._constants:
            text = self.field.format(v)
            factor = "" if text == "1" else "-" if text == "-1" else f"({text})*" if " " in text else f"{text}*"
            brackets.setdefault((i, j), []).append(f"{factor}{names[k]}")
        lines = [f"  [{names[i]}, {names[j]}] = {_sum(terms)}" for (i, j), terms in list(brackets.items())[:8]]
        if len(brackets) > 8:
            lines.append(f"  ... and {len(brackets) - 8} further non-zero brackets")
        head = f"Lie algebra {self.name or ''} over {self.field.name}, dimension {self.dimension}".replace("  ", " ")
        return "\n".join([head, f"  basis {', '.join(names[:12])}{', ...' if len(names) > 12 else ''}", *lines])


def _sum(terms: list[str]) -> str:
    """The first terms of a sum with their signs."""
    shown = terms[0] + "".join(f" - {t[1:]}" if t.startswith("-") else f" + {t}" for t in terms[1:SHOWN_TERMS])
    return shown + (f" + ... ({len(terms)} terms)" if len(terms) > SHOWN_TERMS else "")


def _checked_names(basis: Sequence[str], n: int) -> tuple[str, ...]:
    names = tuple(str(b) for b in basis)
    if len(names) != n:
        raise ShapeError(f"{len(names)} basis names for dimension {n}")
    if len(set(names)) != n:
        raise InputError("basis names must be distinct")
    return names


Constants = Mapping[tuple[int, int], Mapping[int, Any]]
