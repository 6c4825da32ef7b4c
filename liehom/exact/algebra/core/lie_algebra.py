"""LieAlgebra: a finite-dimensional real Lie algebra given by structure constants.

[e_i, e_j] = sum_k c[i, j, k] e_k.  Antisymmetry and the Jacobi identity are proved at construction. Elements are
coefficient vectors. The class is the table of contents of the folder: each method documents its operation and names
the module, here or above, that implements it. Modules load when they are first used.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeVar, cast, final, overload

import numpy as np
import numpy.typing as npt

from liehom.base.budget import within
from liehom.base.errors import InputError, ShapeError, displayed
from liehom.base.objects import Displayed, Immutable
from liehom.base.typing import ElementLike
from liehom.exact.algebra import core, involutions, structure
from liehom.exact.algebra.core.jacobi import killing_form, prove_jacobi
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.core.tables import (
    ConstantsLike,
    LinearCombination,
    RowsLike,
    balanced,
    by_index,
    coefficients,
    constants_from,
    field_of_constants,
    is_named,
    linear_combination,
)
from liehom.exact.scalars.exact_field import ExactMatrix
from liehom.exact.scalars.field import Field, Matrix, MatrixLike, Scalar
from liehom.exact.scalars.floating import FloatField
from liehom.exact.scalars.subspaces import Subspace

if TYPE_CHECKING:
    from liehom.exact.algebra.constructions.sums import ComplexLieAlgebra
    from liehom.exact.algebra.core.homomorphism import Homomorphism
    from liehom.exact.algebra.core.subalgebra import Subalgebra
    from liehom.exact.algebra.involutions.cartan_decomposition import CartanDecomposition
    from liehom.exact.algebra.roots.real_form import RealForm
    from liehom.exact.algebra.roots.root_system import RootSystem
    from liehom.exact.algebra.structure.casimirs import Casimirs
    from liehom.exact.algebra.structure.cohomology import Cohomology
    from liehom.exact.algebra.structure.derivations import Derivations
    from liehom.exact.algebra.structure.levi import LeviDecomposition
    from liehom.exact.algebra.structure.naming import Identification
    from liehom.exact.algebra.structure.nilpotent import NilpotentOrbit
    from liehom.exact.algebra.structure.root_spaces import RootSpaceDecomposition

M = TypeVar("M", bound=Matrix)

SHOWN_TERMS = 8


@final
class LieAlgebra(Displayed, Immutable):
    """A real Lie algebra in a basis e_0, ..., e_{n-1}.

    Parameters
    ----------
    constants : array_like, scipy.sparse array, mapping, or StructureConstants
        ``c[i, j, k]`` of shape (n, n, n), or ``{(i, j): {k: value}}`` with missing pairs filled in by
        antisymmetry, or a sparse array of shape (n * n, n) whose row i * n + j is the bracket [e_i, e_j]. A mapping
        may have names of basis elements in place of indices, ``{("x", "y"): {"z": 1}}``.
    field : Field, optional
        The field of the constants. By default QQ for integers and fractions, a number field for values such
        as 'sqrt(2)/2', float64 for float arrays.
    dimension : int, optional
        The dimension n; by default the number of names in `basis`, or the one that `constants` shows. A mapping does
        not show basis elements that appear in no bracket.
    basis : sequence of str, optional
        Names of the basis elements in their order, by default e0, e1, ..., or the names in `constants` in order of
        first appearance.
    name : str, optional
        A name to print, such as 'so(3)'.
    check : bool, optional
        Prove the axioms (default). Pass False only if they are proved already.

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

    Two algebras are equal (``==``), and hash equal, if they have the same field and the same structure constants:
    names are not compared, and another basis makes another algebra (`is_isomorphic` compares up to isomorphism).

    Methods raise `InputError` where an argument does not fit, and `UndecidedError` where float64 decides nothing.

    Examples
    --------
    >>> import liehom as lh
    >>> so3 = lh.LieAlgebra({(0, 1): {2: 1}, (1, 2): {0: 1}, (0, 2): {1: -1}}, dimension=3)
    >>> so3.bracket([1, 0, 0], [0, 1, 0])
    array([0, 0, 1], dtype=object)
    >>> so3.killing_signature()
    (0, 3, 0)
    >>> g = lh.LieAlgebra({("x", "y"): {"z": 1}})
    >>> g.bracket("x", {"y": 2, "z": 5}), g.show([1, -2, 0])
    (array([0, 0, 2], dtype=object), 'x - 2*y')
    """

    __slots__ = ("_constants", "basis_names", "name")

    def __init__(
        self,
        constants: ConstantsLike,
        field: Field | None = None,
        *,
        dimension: int | None = None,
        basis: Sequence[str] | None = None,
        name: str | None = None,
        check: bool = True,
    ) -> None:
        if field is not None:
            _check_field(field)
        if isinstance(constants, StructureConstants):
            if field not in (None, constants.field) or dimension not in (None, constants.dimension):
                raise InputError(
                    f"the table is over {constants.field.name}, of dimension {constants.dimension}; another field is "
                    "reached by over()"
                )
            self._constants = constants
        else:
            if is_named(constants):
                constants, basis = by_index(cast("Mapping[Any, Any]", constants), basis)
            if basis is not None and dimension is None and isinstance(constants, Mapping):
                basis = tuple(basis)
                dimension = len(basis)
            self._constants = constants_from(constants, field or field_of_constants(constants), dimension)
        n = self._constants.dimension
        within("dimension", n, "the algebra has dimension {}")
        self.basis_names: tuple[str, ...] = (
            tuple(f"e{i}" for i in range(n)) if basis is None else _checked_names(basis, n)
        )
        self.name: str | None = name
        if check:
            prove_jacobi(self._constants, self.basis_names)

    # -- constructors ------------------------------------------------------------------------------------
    @classmethod
    def from_matrices(
        cls,
        matrices: Iterable[MatrixLike],
        *,
        field: Field | None = None,
        independent: bool = True,
        hermitian: bool = False,
        name: str | None = None,
    ) -> LieAlgebra:
        """The real Lie algebra generated by real or complex matrices under the commutator.

        Parameters
        ----------
        matrices : sequence of (N, N) array_like
            The first basis elements are these, in order, without those that depend on earlier ones; missing brackets
            follow. `Representation.from_matrices` says which matrices were left out, and what complex matrices are.
        field : Field, optional
            By default the smallest real field that contains the entries, or their real and imaginary parts.
        independent : bool
            Leave out matrices that depend on earlier ones (default). If False they raise `DependentRowsError`.
        hermitian : bool
            The matrices are Hermitian, as observables are in physics: each is multiplied by i.
        name : str, optional

        Examples
        --------
        >>> import liehom as lh
        >>> lh.LieAlgebra.from_matrices([[[0, 1], [0, 0]], [[0, 0], [1, 0]]]).dimension
        3
        >>> lh.LieAlgebra.from_matrices([[["i", 0], [0, "-i"]], [[0, 1], [1, 0]]]).real_form()
        'sl(2,R)'
        """
        from liehom.exact.algebra.linear.closure import lie_closure
        from liehom.exact.algebra.linear.complex_matrices import as_real_matrices

        real = as_real_matrices(matrices, field, hermitian=hermitian)[0]
        return lie_closure(real, field=field, independent=independent, name=name).algebra

    # -- properties --------------------------------------------------------------------------------------
    @property
    def field(self) -> Field:
        """The field of the structure constants."""
        return self._constants.field

    @property
    def dimension(self) -> int:
        """The dimension n, an int."""
        return self._constants.dimension

    @property
    def table(self) -> StructureConstants:
        """The sparse bracket table."""
        return self._constants

    def structure_constants(self) -> Iterator[tuple[int, int, int, Scalar]]:
        """The non-zero entries (i, j, k, value) of the bracket table with i < j."""
        return iter(self._constants)

    # -- elements and the bracket ------------------------------------------------------------------------
    def row(self, x: ElementLike) -> Matrix:
        """An element as a row matrix (1, n) of coefficients; `ShapeError` if there are not n of them.

        An element is given by its coefficients, by the name of a basis element, or as {name: coefficient}.
        """
        matrix: Matrix = self.field.matrix([coefficients(self.basis_names, x) if isinstance(x, (str, Mapping)) else x])
        if matrix.ncols != self.dimension:
            raise ShapeError(f"an element has {matrix.ncols} coefficients, expected {self.dimension}")
        return matrix

    def show(self, x: ElementLike) -> str:
        """An element as a linear combination of the names of basis elements, a string.

        A notebook shows it as a formula, and `liehom.latex` returns the LaTeX.

        Examples
        --------
        >>> import liehom as lh
        >>> g = lh.heisenberg(1)
        >>> g.show(g.bracket("x1", "y1")), g.show([1, 0, "-1/2"]), g.show([0, 0, 0])
        ('z', 'x1 - 1/2*z', '0')
        """
        return LinearCombination(self.field, self.basis_names, self.row(x).row(0))

    def bracket(self, x: ElementLike, y: ElementLike) -> npt.NDArray[Any]:
        """The bracket [x, y] of two elements (see `row`), as a numpy array of field elements.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(3).bracket([1, 0, 0], ["1/2", 1, 0])
        array([0, 0, 1], dtype=object)
        """
        return self._vector((self.row(y) @ self.ad(x).T).row(0) if self.dimension else [])

    def _vector(self, values: list[Scalar]) -> npt.NDArray[Any]:
        return np.fromiter(values, object if self.field.exact else np.float64, len(values))

    @overload
    def ad(self, x: M) -> M: ...

    @overload
    def ad(self, x: ElementLike) -> Matrix: ...

    def ad(self, x: ElementLike | Matrix) -> Matrix:
        """The matrix (n, n) of y -> [x, y], acting on columns of coefficients.

        Examples
        --------
        >>> import liehom as lh
        >>> print(lh.LieAlgebra({(0, 1): {1: 2}}, dimension=2).ad([1, 0]))
        [0, 0]
        [0, 2]
        """
        return self._constants.adjoint(self.field.read(x) if isinstance(x, Matrix) else self.row(x))

    def killing_form(self) -> Matrix:
        """The matrix (n, n) of the Killing form, tr(ad e_i ad e_j).

        Examples
        --------
        >>> import liehom as lh
        >>> print(lh.so(3).killing_form())
        [-2, 0, 0]
        [0, -2, 0]
        [0, 0, -2]
        """
        return killing_form(self._constants)

    def killing_signature(self) -> tuple[int, int, int]:
        """Numbers of (positive, negative, zero) eigenvalues of the Killing form."""
        return self._decided_killing_form().signature()

    def _decided_killing_form(self) -> Matrix:
        """A form with the signature of the Killing form; over floats `UndecidedError` if its rank is not clear."""
        form: Any = killing_form(self._constants)
        if not self.field.exact and ((decision := form.rank_decision()).rank < self.dimension or not decision.clear):
            form = killing_form(balanced(self._constants)[0])
            form.rank_decision().require_clear("the rank of the Killing form")
        return cast(Matrix, form)

    # -- subalgebras and ideals --------------------------------------------------------------------------
    def subalgebra(self, rows: RowsLike) -> Subalgebra:
        """The subalgebra with these rows of coefficients, shape (k, n), or these elements, as its basis.

        Raises
        ------
        DependentRowsError, NotASubalgebraError
            As for `Subalgebra`.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(3).subalgebra([[1, 0, 0], [0, 1, 0]])
        Traceback (most recent call last):
        ...
        liehom.base.errors.NotASubalgebraError: the rows do not span a subalgebra: the bracket of rows 0 and 1 is ...
        >>> lh.heisenberg(1).subalgebra(["x1", "z"]).rows()
        [[1, 0, 0], [0, 0, 1]]
        """
        return core.subalgebra.Subalgebra(self, rows)

    def as_subalgebra(self, subalgebra: Subalgebra | RowsLike) -> Subalgebra:
        """A `Subalgebra` of this algebra, from its rows or unchanged; `InputError` if it belongs to another algebra.

        Examples
        --------
        >>> import liehom as lh
        >>> g = lh.so(3)
        >>> h = g.subalgebra([[0, 0, 1]])
        >>> g.as_subalgebra(h) is h, g.as_subalgebra([[0, 0, 1]]) == h
        (True, True)
        """
        if not isinstance(subalgebra, core.subalgebra.Subalgebra):
            return core.subalgebra.Subalgebra(self, subalgebra)
        core.subalgebra.require_inside(self, subalgebra)
        return subalgebra

    def subalgebra_generated_by(self, rows: Subalgebra | RowsLike) -> Subalgebra:
        """The smallest subalgebra that contains the rows.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(3).subalgebra_generated_by([[1, 0, 0], [0, 1, 0]]).dimension
        3
        """
        return core.subalgebra.generated(self, rows)

    def ideal_generated_by(self, rows: Subalgebra | RowsLike) -> Subalgebra:
        """The smallest ideal that contains the rows.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.gl(2).ideal_generated_by([[0, 1, 0, 0]]).dimension
        3
        >>> lh.gl(2).ideal_generated_by([[1, 0, 0, 0]]).dimension
        4
        """
        return core.subalgebra.generated(self, rows, ideal=True)

    def center(self) -> Subalgebra:
        """The centre {x : [x, g] = 0}."""
        return self.centralizer(self.field.identity(self.dimension))

    def centralizer(self, rows: Subalgebra | RowsLike) -> Subalgebra:
        """The subalgebra {x : [x, r] = 0 for each row r}.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(3).centralizer([[1, 0, 0]]).dimension
        1
        """
        return core.subalgebra.centralizer(self, rows)

    def normalizer(self, subalgebra: Subalgebra | RowsLike) -> Subalgebra:
        """The subalgebra {x : [x, h] is in h} of a subalgebra h (a `Subalgebra` or rows).

        Examples
        --------
        >>> import liehom as lh
        >>> lh.sl(2).normalizer([[0, 0, 1]]).dimension
        1
        """
        return core.subalgebra.normalizer(self.as_subalgebra(subalgebra))

    def whole(self) -> Subspace:
        """The algebra as a subspace of itself."""
        return Subspace(self.field, self.field.identity(self.dimension), self.dimension)

    # -- series ------------------------------------------------------------------------------------------
    def derived_subalgebra(self) -> Subalgebra:
        """The ideal [g, g].

        Examples
        --------
        >>> import liehom as lh
        >>> lh.gl(2).derived_subalgebra().dimension
        3
        """
        rows = core.subalgebra.products(self, *[self.field.identity(self.dimension)] * 2)
        return core.subalgebra.Subalgebra(self, rows, check=False)  # an ideal

    def derived_series(self) -> list[Subalgebra]:
        """The ideals g, [g, g], [[g, g], [g, g]], ... up to the first that repeats, which is listed once.

        Examples
        --------
        >>> import liehom as lh
        >>> [h.dimension for h in lh.gl(2).derived_series()]
        [4, 3]
        """
        return core.subalgebra.descending_series(self)

    def lower_central_series(self) -> list[Subalgebra]:
        """The ideals g, [g, g], [g, [g, g]], ... up to the first that repeats, which is listed once.

        Examples
        --------
        >>> import liehom as lh
        >>> [h.dimension for h in lh.heisenberg(1).lower_central_series()]
        [3, 1, 0]
        """
        return core.subalgebra.descending_series(self, central=True)

    def upper_central_series(self) -> list[Subalgebra]:
        """The ideals 0 = z_0, z_1, z_2, ... with z_(k+1)/z_k the centre of g/z_k, up to the first that repeats.

        Examples
        --------
        >>> import liehom as lh
        >>> [h.dimension for h in lh.heisenberg(1).upper_central_series()]
        [0, 1, 3]
        """
        return core.subalgebra.upper_central_series(self)

    # -- solvable, nilpotent, semisimple -----------------------------------------------------------------
    def is_abelian(self) -> bool:
        """Whether all brackets vanish."""
        return self._constants.is_zero()

    def is_nilpotent(self) -> bool:
        """Whether the lower central series ends in 0.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.heisenberg(2).is_nilpotent(), lh.euclidean(2).is_nilpotent()
        (True, False)
        """
        return self.lower_central_series()[-1].dimension == 0

    def is_solvable(self) -> bool:
        """Whether the derived series ends in 0; equivalently K(g, [g, g]) = 0 for the Killing form K.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.euclidean(2).is_solvable(), lh.so(3).is_solvable()
        (True, False)
        """
        return self.radical().dimension == self.dimension

    def is_unimodular(self) -> bool:
        """Whether tr ad x = 0 for all x; equivalently, a connected group of the algebra has a two-sided Haar measure.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.euclidean(2).is_unimodular(), lh.bianchi("V").is_unimodular()
        (True, False)
        """
        identity = self.field.identity(self.dimension)
        adjoint = (self.ad(identity.select([i])) for i in range(self.dimension))
        # a - (a - t) carries the error of a over floats, where the number tr a / n alone has none
        return all((a - (a - identity.scale(a.trace() / a.nrows))).is_zero() for a in adjoint)

    def is_semisimple(self) -> bool:
        """Whether the Killing form is nondegenerate (Cartan's criterion); the zero algebra is semisimple.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(4).is_semisimple(), lh.gl(2).is_semisimple()
        (True, False)
        """
        return self._decided_killing_form().rank() == self.dimension

    def is_reductive(self) -> bool:
        """Whether the radical is the centre.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.gl(3).is_reductive(), lh.euclidean(3).is_reductive()
        (True, False)
        """
        return self.radical().dimension == self.center().dimension

    def is_simple(self) -> bool:
        """Whether the algebra is simple over the reals: so(3,1) is, so(4) is not.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(3, 1).is_simple(), lh.so(4).is_simple(), lh.abelian(1).is_simple()
        (True, False, False)
        """
        parts = structure.identification.simple_parts(self) if self.dimension and self.is_semisimple() else []
        return sum(len(part.places) for part in parts) == 1

    def radical(self) -> Subalgebra:
        """The solvable radical, the largest solvable ideal.

        rad(g) = {x : K(x, [g, g]) = 0}, K the Killing form.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.euclidean(3).radical().dimension, lh.gl(3).radical().dimension
        (3, 1)
        """
        return structure.levi.radical(self)

    def nilradical(self) -> Subalgebra:
        """The nilradical, the largest nilpotent ideal.

        It contains [g, rad(g)]. On the composition factors of g the radical acts by weights, and the nilradical is
        the common kernel of these. With s the number of distinct non-zero eigenvalues of ad y, y in rad(g), all
        elements of the nilradical satisfy tr(ad x (ad y)^k) = 0 for k = 1, ..., s. For generic y there are no other
        solutions in rad(g), which is checked: each element of a basis of the solutions must be ad-nilpotent.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.euclidean(2).nilradical().dimension, lh.heisenberg(1).nilradical().dimension
        (2, 3)
        """
        return structure.levi.nilradical(self)

    def levi_decomposition(self) -> LeviDecomposition:
        """A Levi factor and the radical; unpacks as ``levi, radical``.

        Examples
        --------
        >>> import liehom as lh
        >>> levi, radical = lh.euclidean(3).levi_decomposition()
        >>> levi.dimension, radical.dimension, levi.as_algebra().killing_signature()
        (3, 3, (0, 3, 0))
        """
        return structure.levi.levi_decomposition(self)

    # -- direct sums of ideals ---------------------------------------------------------------------------
    def direct_sum_decomposition(self) -> list[Subalgebra]:
        """Indecomposable ideals, over the field of the algebra, whose direct sum is the algebra.

        They are ordered by dimension, then by canonical basis, and their bases together are a basis of the algebra.
        There are none in dimension 0. An extension of the field may split them further.

        The summands are unique up to isomorphism, and unique as ideals if the algebra has no centre or is perfect
        (Krull, Remak, Schmidt). The summands of a semisimple algebra are its simple ideals.

        Examples
        --------
        >>> import liehom as lh
        >>> [h.dimension for h in lh.so(4).direct_sum_decomposition()]
        [3, 3]
        >>> [h.dimension for h in lh.gl(3).direct_sum_decomposition()]
        [1, 8]
        >>> [h.dimension for h in lh.direct_sum(lh.gl(2), lh.heisenberg(1)).direct_sum_decomposition()]
        [1, 3, 3]
        """
        return structure.ideals.direct_sum_decomposition(self)

    def simple_ideals(self) -> list[Subalgebra]:
        """The simple ideals over the reals.

        An ideal that is simple over the field but not over the reals gives ideals of ``g.over(K)``, K the real number
        field that contains its coordinates: see ``ideal.algebra.field``.

        Raises
        ------
        FieldError
            If a complex place needs a field of too high a degree.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(4).simple_ideals()
        [<subalgebra of dimension 3 in so(4) over QQ>, <subalgebra of dimension 3 in so(4) over QQ>]
        >>> [h.dimension for h in lh.direct_sum(lh.gl(2), lh.so(3, 1)).simple_ideals()]
        [3, 6]
        """
        return structure.ideals.simple_ideals(self)

    def centroid(self) -> tuple[ExactMatrix, ...]:
        """A basis of the centroid, the matrices phi with phi [x, y] = [phi x, y] for all x, y.

        The matrices (n, n) act on columns of coefficients. Each is verified exactly, and the equations that define the
        space are necessary, so that no other matrix belongs to it.

        The centroid is an associative algebra with one. It is commutative if the algebra is perfect or has no
        centre. For a simple algebra it is a field, the largest one over which the algebra is a Lie algebra.

        Examples
        --------
        >>> import liehom as lh
        >>> len(lh.so(3).centroid()), len(lh.so(4).centroid()), len(lh.so(3, 1).centroid())
        (1, 2, 2)
        >>> print(lh.sl(2).centroid()[0])
        [1, 0, 0]
        [0, 1, 0]
        [0, 0, 1]
        """
        return structure.centroid.centroid(self)

    # -- algebras made of this one -----------------------------------------------------------------------
    def quotient(self, ideal: Subalgebra | RowsLike, *, name: str | None = None) -> LieAlgebra:
        """The quotient g/h by an ideal h, in the basis to which `quotient_map` maps a complement of h.

        Raises
        ------
        NotAnIdealError
            If [g, h] does not lie in h.

        Examples
        --------
        >>> import liehom as lh
        >>> g = lh.heisenberg(1)
        >>> g.quotient(g.center()).is_abelian(), g.quotient([[0, 0, 1]]).is_abelian()
        (True, True)
        """
        return self.as_subalgebra(ideal).quotient_algebra(name)

    def quotient_map(self, ideal: Subalgebra | RowsLike) -> Homomorphism:
        """The projection of g onto its quotient by an ideal, with the arguments and errors of `quotient`.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.gl(2).quotient_map([[1, 0, 0, 1]]).kernel().rows()
        [[1, 0, 0, 1]]
        """
        h = self.as_subalgebra(ideal)
        # The bracket of the quotient is the one that makes this a homomorphism.
        return core.homomorphism.Homomorphism(self, h.quotient_algebra(), h.quotient().projection.T, check=False)

    def complexification(self, *, name: str | None = None) -> ComplexLieAlgebra:
        """The complexification g (x) C as a real Lie algebra of dimension 2n, with its complex structure.

        The basis is x, then ix, for the basis elements x of g; the name is by default that of g followed by _C.

        Examples
        --------
        >>> import liehom as lh
        >>> g = lh.so(3).complexification().algebra
        >>> g.basis_names, g.killing_signature(), g.real_form()
        (('e0', 'e1', 'e2', 'i*e0', 'i*e1', 'i*e2'), (3, 3, 0), 'sl(2,C)')
        """
        from liehom.exact.algebra.constructions.sums import complexification

        return complexification(self, name=name)

    def change_of_basis(self, rows: MatrixLike, *, name: str | None = None) -> LieAlgebra:
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
        """The algebra with the same structure constants over another field that contains them.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(3).over(lh.number_field("sqrt(2)"))
        <Lie algebra so(3) of dimension 3 over QQ(sqrt(2))>
        """
        _check_field(field)
        table = self._constants
        if field != self.field:
            convert = self.field.to_float if isinstance(field, FloatField) else field.convert
            table = StructureConstants(field, self.dimension, [(i, j, k, convert(v)) for i, j, k, v in table])
        return LieAlgebra(table, basis=self.basis_names, name=self.name, check=False)  # same identities

    # -- derivations and cohomology ----------------------------------------------------------------------
    def derivations(self) -> Derivations:
        """The derivations D [x, y] = [D x, y] + [x, D y]: their matrices, and the Lie algebra that they form.

        The matrices are a basis: ad e_i for a complement of the centre, then outer derivations. Over float64 the basis
        is numerical.

        For semisimple g all derivations are inner (Whitehead); that g is semisimple is read from its Killing form.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(4).derivations(), lh.heisenberg(1).derivations(), lh.abelian(2).derivations()
        (<derivations of so(4): dimension 6, 0 outer>, <derivations of heisenberg(1): dimension 6, 4 outer>,
         <derivations of R^2: dimension 4, 4 outer>)
        """
        return structure.derivations.derivations(self)

    def cohomology(
        self, degree: int, matrices: Sequence[MatrixLike] | None = None, *, size: int | None = None
    ) -> Cohomology:
        """The Chevalley-Eilenberg cohomology H^k(g, V), with cocycles that represent a basis of its classes.

        Parameters
        ----------
        degree : int
            k, not negative.
        matrices : sequence of (m, m) array_like, optional
            The representation on V = R^m, one matrix for each basis element of g; by default V = R with the trivial
            action.
        size : int, optional
            m, needed only if g has dimension 0 and matrices are given.

        Raises
        ------
        ShapeError, RepresentationError
            If the matrices do not fit, or are not a representation.

        Notes
        -----
        H^0(g, V) are the invariants of V, H^1(g, R) is dual to g / [g, g], H^1(g, g) are the outer derivations, and
        H^2(g, R) classifies the central extensions by R. For semisimple g and k = 1, 2 the cohomology is 0
        (Whitehead), and nothing is computed. For semisimple g the dimension of H^3(g, R) is the number of simple
        ideals of the complexification.

        Examples
        --------
        >>> import liehom as lh
        >>> [lh.so(3).cohomology(k).dimension for k in range(5)]
        [1, 0, 0, 1, 0]
        >>> [lh.heisenberg(1).cohomology(k).dimension for k in range(4)]
        [1, 2, 2, 1]
        """
        return structure.cohomology.cohomology(self, degree, matrices, size=size)

    # -- invariants of the coadjoint action --------------------------------------------------------------
    def index(self) -> int:
        """The index: the least dimension of a stabilizer in the coadjoint action, an int.

        It is the number of functionally independent invariants of this action, dim g minus the generic rank of the
        matrix of brackets ([e_i, e_j]) (Beltrametti and Blasi, Phys. Lett. 20 (1966), 62-64).

        Raises
        ------
        UndecidedError
            Over float64, and if the rank at a random point is not proved to be the generic one: see `casimirs`.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.sl(3).index(), lh.heisenberg(2).index(), lh.euclidean(2).index(), lh.algebra.affine(1).index()
        (2, 1, 1, 0)
        """
        return structure.casimirs.index(self)

    def casimirs(self, max_degree: int) -> Casimirs:
        """Functionally independent polynomial invariants of the coadjoint action (Casimir operators) up to a degree.

        They are as many independent ones as exist up to this degree, those of low degree first. Rational and
        transcendental invariants are not looked for: see ``.is_complete``.

        Raises
        ------
        LimitError
            If the monomials need too much memory.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.euclidean(3).casimirs(2).degrees, lh.poincare(3).casimirs(4).degrees
        ((2, 2), (2, 4))
        >>> lh.LieAlgebra({("x", "y"): {"y": 1}, ("x", "z"): {"z": 2}}).casimirs(4).is_complete
        False
        """
        return structure.casimirs.casimirs(self, max_degree)

    # -- Jordan decomposition and nilpotent elements -----------------------------------------------------
    def jordan_decomposition(self, x: ElementLike) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
        """The Jordan decomposition (s, n) of an element, two arrays (dimension,) with x = s + n and [s, n] = 0.

        ad s is semisimple, and ad n is nilpotent (Humphreys, Introduction to Lie Algebras, 5.4). In a reductive
        algebra s and n exist, and they are unique with n in [g, g]. In other algebras an `InputError` is raised if they
        do not exist, or if there is a centre, up to which they are not unique.

        Examples
        --------
        >>> import liehom as lh
        >>> g = lh.gl(2)
        >>> [g.show(y) for y in g.jordan_decomposition([3, 1, 0, 3])]
        ['3*e0 + 3*e3', 'e1']
        """
        s, n = structure.nilpotent.jordan_decomposition(self, x)
        return self._vector(s.row(0)), self._vector(n.row(0))

    def sl2_triple(self, e: ElementLike) -> tuple[npt.NDArray[Any], npt.NDArray[Any], npt.NDArray[Any]]:
        """An sl2-triple (h, e, f) through an element, arrays with [h, e] = 2 e, [h, f] = -2 f and [e, f] = h.

        In a semisimple algebra each nilpotent e other than 0 belongs to one, by the theorem of Jacobson and Morozov
        (Collingwood and McGovern, Nilpotent Orbits in Semisimple Lie Algebras, 3.3). Other algebras are searched, too.

        Examples
        --------
        >>> import liehom as lh
        >>> g = lh.chevalley("A2")
        >>> [g.show(y) for y in g.sl2_triple({"e1": 1, "e2": 1})]
        ['2*h1 + 2*h2', 'e1 + e2', '2*f1 + 2*f2']
        """
        triple = structure.nilpotent.sl2_triple(self, e)
        return self._vector(triple.h.row(0)), self._vector(triple.e.row(0)), self._vector(triple.f.row(0))

    def nilpotent_orbits(self) -> list[NilpotentOrbit]:
        """The nilpotent orbits of a simple algebra under its adjoint group, the zero orbit first, by dimension.

        They are those of `liehom.algebra.nilpotent_orbits` for the name of the real form.

        Examples
        --------
        >>> import liehom as lh
        >>> [(orbit.rows, orbit.dimension) for orbit in lh.su(2, 1).nilpotent_orbits()]
        [(('+', '+', '-'), 0), (('+-', '+'), 4), (('-+', '+'), 4), (('+-+',), 6)]
        """
        forms = self.real_forms()
        if len(forms) > 1 or sum(form.dimension for form in forms) != self.dimension:
            raise InputError(f"nilpotent orbits are listed for simple algebras, and {self!r} is not simple")
        return structure.nilpotent.nilpotent_orbits(forms[0].name if forms else "0")

    # -- Cartan subalgebras and roots --------------------------------------------------------------------
    def cartan_subalgebra(self) -> Subalgebra:
        """A Cartan subalgebra, found deterministically and proved to be nilpotent and its own normalizer.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.sl(3).cartan_subalgebra().dimension, lh.heisenberg(1).cartan_subalgebra().dimension
        (2, 3)
        """
        return structure.root_spaces.cartan_subalgebra(self)

    def rank(self) -> int:
        """The rank: the dimension of the Cartan subalgebras.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(5).rank(), lh.gl(3).rank()
        (2, 3)
        """
        return self.cartan_subalgebra().dimension

    def root_space_decomposition(self, cartan: Subalgebra | None = None) -> RootSpaceDecomposition:
        """The root space decomposition of a semisimple algebra: h and the V_alpha with [h, v] = alpha(h) v.

        h is by default `cartan_subalgebra`. Root spaces of roots that are conjugate over the field are not separated:
        their sum is one entry.

        Examples
        --------
        >>> import liehom as lh
        >>> roots = lh.sl(2).root_space_decomposition()
        >>> roots.is_split, [space.values for space in roots.spaces]
        (True, [(-2,), (2,)])
        >>> [space.space.dimension for space in lh.so(3).root_space_decomposition().spaces]
        [2]
        """
        return structure.root_spaces.root_space_decomposition(self, cartan)

    def root_system(self) -> RootSystem:
        """The root system of the complexification of a semisimple algebra.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(3).root_system().type, lh.so(4).root_system().weyl_group_order()
        ('A1', 4)
        """
        return structure.root_spaces.root_data(self).root_system

    def restricted_roots(self) -> list[tuple[str, str, dict[str, int]]]:
        """For each simple ideal over the reals: its name, the type of the restricted roots, and their multiplicities.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.su(2, 1).restricted_roots()
        [('su(2,1)', 'BC1', {'short': 2, 'long': 1})]
        """
        return [(form.name, form.restricted_type, form.multiplicities) for form in self.real_forms()]

    # -- identification ----------------------------------------------------------------------------------
    def semisimple_type(self) -> str:
        """The type of the complexification of a semisimple algebra or of a Levi factor, such as 'A1 + B2'.

        A solvable algebra has the type '0'.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(3, 1).semisimple_type(), lh.gl(3).semisimple_type(), lh.abelian(2).semisimple_type()
        ('A1 + A1', 'A2', '0')
        """
        return structure.identification.semisimple_type(self)

    def real_form(self) -> str:
        """The name, over the reals, of the algebra or of a Levi factor, such as 'so(4,1)' or 'so(3) + sl(2,R)'.

        The name for a solvable algebra is '0'. Each isomorphism class of simple real algebras has one canonical name;
        `canonical_real_form` translates other names into it.

        Raises
        ------
        UndecidedError
            Over float64, and for the few pairs of real forms, of dimension at least 153, with one type and one
            Killing signature.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(1, 4).real_form(), lh.su(2).real_form(), lh.so(2, 2).real_form(), lh.so(3, 1).real_form()
        ('so(4,1)', 'so(3)', 'sl(2,R) + sl(2,R)', 'sl(2,C)')
        """
        return structure.identification.real_form(self)

    def real_forms(self) -> list[RealForm]:
        """The real forms of the simple ideals over the reals of the algebra or of a Levi factor.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(4).real_forms()
        [<real form so(3) of type A1>, <real form so(3) of type A1>]
        >>> [form.satake.black for form in lh.so(4, 1).real_forms()]
        [(1,)]
        """
        return structure.identification.real_forms_of(self)

    def real_rank(self) -> int:
        """The real rank of the algebra or of a Levi factor: the dimension of a maximal split abelian subspace of p.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(4, 1).real_rank(), lh.so(5).real_rank(), lh.sl(3).real_rank()
        (1, 0, 2)
        """
        return sum(form.real_rank for form in self.real_forms())

    def identify(self) -> Identification:
        """The name of the algebra in the tables of small dimension, with an isomorphism from the named algebra.

        The result has ``.name`` as in the catalogue, ``.parameters``, and ``.homomorphism``, over a larger real number
        field if the map or the parameters need one.

        Raises
        ------
        UndecidedError
            If an ideal that is not a direct sum is not in the tables, which hold all real algebras of dimension at most
            5 and all nilpotent ones of dimension 6 (`low_dimensional`), or if a map needs a field of degree above 8.

        Notes
        -----
        The brackets of the map are checked. Parameters are in the range of the table, and are the largest ones among
        those that give isomorphic algebras, in the order of the dictionary.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.bianchi("III").identify().name, lh.euclidean(2).identify().name, lh.gl(2).identify().name
        ('A2,1+R', 'A3,6', 'A3,8+R')
        >>> found = lh.algebra.almost_abelian([[1, 2], [1, 3]]).identify()
        >>> found.name, found.homomorphism.source.field
        ('A3,5(7 - 4*sqrt(3))', QQ(sqrt(3)))
        """
        return structure.naming.identify(self)

    def isomorphism(self, other: LieAlgebra) -> Homomorphism | None:
        """An isomorphism onto another algebra over the reals, or None if there is none.

        It is over the field of the algebras, or over a larger real number field if the map needs one. If the result is
        None, `differing_invariant` says why.

        Raises
        ------
        UndecidedError
            If no map and no invariant that differs was found, or an ideal of dimension above 3 is simple.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.heisenberg(1).isomorphism(lh.bianchi("II")).is_isomorphism()
        True
        >>> lh.heisenberg(1).isomorphism(lh.euclidean(2)) is None
        True
        """
        return structure.naming.isomorphism(self, other)

    def differing_invariant(self, other: LieAlgebra) -> str | None:
        """An invariant that proves that two algebras are not isomorphic over the reals, as a string, or None.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.heisenberg(1).differing_invariant(lh.euclidean(2))
        'derived series: 3 > 1 > 0 and 3 > 2 > 0'
        >>> lh.bianchi("VI", 2).differing_invariant(lh.bianchi("VI", 3))
        'name: A3,5(1/3) and A3,5(1/2)'
        """
        return structure.naming.differing_invariant(self, other)

    def is_isomorphic(self, other: LieAlgebra) -> bool:
        """Whether two algebras are isomorphic over the reals.

        Over QQ isomorphism is finer: two quaternion algebras that are definite at the real place give two algebras
        over QQ that are both so(3) over the reals.

        Raises
        ------
        UndecidedError
            If no isomorphism and no invariant that differs was found; see `isomorphism`.

        Notes
        -----
        Semisimple ideals that are direct summands are compared by their real forms, without a map.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(4, 2).is_isomorphic(lh.su(2, 2)), lh.so(5, 1).is_isomorphic(lh.su(2, 2))
        (True, False)
        >>> lh.heisenberg(1).is_isomorphic(lh.bianchi("II"))
        True
        """
        return structure.naming.is_isomorphic(self, other)

    # -- Cartan decomposition ----------------------------------------------------------------------------
    def cartan_decomposition(self, *, extend: bool = True) -> CartanDecomposition:
        """The decomposition g = k + p of a semisimple algebra for a Cartan involution; unpacks as ``k, p``.

        The involution is ``.theta``, which is proved to be one.

        Parameters
        ----------
        extend : bool, optional
            If no involution over the field of the algebra was found, return one over a larger real number field, the
            default. The field is ``.field`` of the result, and k and p are those of the algebra over that field.

        Raises
        ------
        NoRationalInvolutionError
            If it is proved that no Cartan involution has entries in the field, and none was looked for or found over a
            larger field. For example, of two ideals over the reals that are conjugate over the field one is compact
            and the other is not; or the algebra consists of the elements of trace 0 of a division algebra of degree 3.
        UndecidedError
            If no Cartan involution with small rational entries was found, nor over a larger field if `extend` is
            True. In both cases ``g.over(lh.RR).cartan_decomposition()`` finds one numerically.

        Notes
        -----
        k is a subalgebra, [k, p] lies in p, [p, p] in k, the Killing form is negative definite on k and positive
        definite on p. Over an exact field all this follows from two exact checks: theta is an automorphism with
        theta^2 = 1, and -K(x, theta y) is positive definite.

        Examples
        --------
        >>> import liehom as lh
        >>> k, p = lh.so(4, 1).cartan_decomposition()
        >>> k.dimension, p.dimension, k.as_algebra().real_form()
        (6, 4, 'so(3) + so(3)')

        The brackets [x, y] = sqrt(2) z, [y, z] = x, [z, x] = y over QQ(sqrt(2)), seen over QQ, are so(3) + sl(2,R) over
        the reals; an involution has entries in the larger field only.

        >>> table = {(0, 2): {4: 1}, (2, 4): {1: 1}, (0, 4): {2: -1}, (0, 3): {5: 1}, (1, 2): {5: 1}, (1, 3): {4: 2}}
        >>> table |= {(2, 5): {0: 2}, (3, 4): {0: 2}, (3, 5): {1: 2}, (0, 5): {3: -1}, (1, 4): {3: -1}, (1, 5): {2: -2}}
        >>> cartan = lh.LieAlgebra(table).cartan_decomposition()
        >>> cartan.field, cartan.k.dimension
        (QQ(sqrt(2)), 4)
        """
        return involutions.cartan_decomposition.cartan_decomposition(self, extend=extend)

    def cartan_involution(self) -> Matrix:
        """The matrix (n, n), on columns, of the Cartan involution of `cartan_decomposition`, with entries in its field.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(3).cartan_involution() == lh.QQ.identity(3)
        True
        """
        return self.cartan_decomposition().theta

    def maximal_compact_subalgebra(self, *, extend: bool = True) -> Subalgebra:
        """The fixed points of a Cartan involution (`cartan_decomposition`).

        Parameters
        ----------
        extend : bool, optional
            If no involution over the field of the algebra was found, use one over a larger real number field, the
            default. The result is then a subalgebra of the algebra over that field.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.so(4, 1).maximal_compact_subalgebra().as_algebra().real_form()
        'so(3) + so(3)'
        """
        return self.cartan_decomposition(extend=extend).k

    # -- parabolic subalgebras ---------------------------------------------------------------------------
    def parabolic_subalgebra(self, crossed: Iterable[int]) -> Subalgebra:
        """The standard parabolic subalgebra of a semisimple algebra with a set of crossed simple restricted roots.

        Parameters
        ----------
        crossed : iterable of int
            The numbers, from 0, of the simple restricted roots whose root spaces are in the nilradical. The other ones,
            with their negatives, generate the semisimple part of the Levi factor, up to a compact part. No numbers give
            the whole algebra, one number a maximal parabolic subalgebra, all numbers a minimal one.

        Raises
        ------
        UndecidedError
            If no split torus was found over the field of the algebra that is maximal over the reals. Such a torus may
            exist over a larger real number field only: see `over`. Over float64.

        Notes
        -----
        Simple restricted roots are numbered in the order of the white nodes of the Satake diagram, two nodes joined by
        an arrow counted once (``form.satake.restricted_nodes`` for each ``form`` of `real_forms`). Crossed nodes are
        those of Čap and Slovák, Parabolic Geometries I, 3.2. In the notation of Knapp, Lie Groups Beyond an
        Introduction, VII.7, the set of roots of the Levi factor is the complement.

        Let n_i(lambda) be the coefficients of a restricted root lambda in the simple ones. The result is the sum of the
        centralizer of a maximal split torus and of the root spaces for which the sum of the n_i(lambda) over the
        crossed i is at least 0. Each parabolic subalgebra is conjugate under inner automorphisms to exactly one of
        these. If the diagram has symmetries, the basis of the algebra decides between the numberings.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.sl(3).parabolic_subalgebra([0]) == lh.algebra.parabolic_subalgebra(1, 2)
        True
        >>> g = lh.simple("e6(2)")
        >>> g.real_forms()[0].satake.restricted_nodes
        ((0, 5), (1,), (2, 4), (3,))
        >>> [g.parabolic_subalgebra([i]).codimension for i in range(4)]
        [24, 21, 31, 29]
        """
        from liehom.exact.algebra.involutions.parabolic import parabolic_subalgebra

        return parabolic_subalgebra(self, crossed)

    # -- comparison and printing -------------------------------------------------------------------------
    def describe(self) -> str:
        """A summary: name, kind of algebra, real form, ranks, radical, series, Killing form.

        The first line has the canonical name of the real form, too, if the name of the algebra is another one, as in
        'su(2) = so(3)'. Over float64 only numerical facts are listed: dimensions and the Killing form.

        Examples
        --------
        >>> import liehom as lh
        >>> print(lh.so(4, 1).describe())
        so(4,1), dimension 10 over QQ
          simple, real form so(4,1), rank 2, real rank 1, maximal compact so(4)
          complex type B2, restricted roots A1 with multiplicity 3
          Killing form of signature (4, 6, 0) (positive, negative, zero)
        >>> print(lh.euclidean(2).describe())
        e(2), dimension 3 over QQ
          A3,6 in the tables
          solvable, not nilpotent
          nilradical of dimension 2, centre of dimension 0
          derived series 3 > 2 > 0, lower central series 3 > 2
          Killing form of signature (0, 1, 2) (positive, negative, zero)
        """
        return structure.identification.describe(self)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, LieAlgebra) and self._constants == other._constants

    def __hash__(self) -> int:
        return hash(self._constants)

    def __repr__(self) -> str:
        title = f"{self.name} " if self.name else ""
        return f"<Lie algebra {title}of dimension {self.dimension} over {self.field.name}>"

    def __str__(self) -> str:
        names = self.basis_names
        brackets: dict[tuple[int, int], list[str]] = {}
        for i, j, k, v in self._constants:
            brackets.setdefault((i, j), []).extend(linear_combination(self.field, [names[k]], [v]))
        shown = list(brackets.items())[:SHOWN_TERMS]
        lines = [f"  [{names[i]}, {names[j]}] = {_sum(terms)}" for (i, j), terms in shown]
        if len(brackets) > SHOWN_TERMS:
            lines.append(f"  ... and {len(brackets) - SHOWN_TERMS} further non-zero brackets")
        head = f"Lie algebra {self.name or ''} over {self.field.name}, dimension {self.dimension}".replace("  ", " ")
        return "\n".join([head, f"  basis {', '.join(names[:12])}{', ...' if len(names) > 12 else ''}", *lines])


def _sum(terms: list[str]) -> str:
    """The first terms of a sum with their signs."""
    shown = terms[0] + "".join(f" - {t[1:]}" if t.startswith("-") else f" + {t}" for t in terms[1:SHOWN_TERMS])
    return shown + (f" + ... ({len(terms)} terms)" if len(terms) > SHOWN_TERMS else "")


def _check_field(field: object) -> None:
    if not isinstance(field, Field):
        raise InputError(f"expected a field such as lh.QQ, lh.RR or lh.number_field('sqrt(2)'), got {displayed(field)}")


def _checked_names(basis: Sequence[str], n: int) -> tuple[str, ...]:
    names = tuple(str(b) for b in basis)
    if len(names) != n:
        raise ShapeError(f"{len(names)} basis names for dimension {n}")
    if len(set(names)) != n:
        raise InputError("basis names must be distinct")
    return names
