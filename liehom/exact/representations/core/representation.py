"""Representation: a homomorphism rho from a Lie algebra to matrices, checked at construction.

rho([x, y]) = rho(x) rho(y) - rho(y) rho(x).  Vectors are columns: rho(x) v.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from math import isqrt
from typing import TYPE_CHECKING, Any, cast, final

import numpy.typing as npt

from liehom.base.errors import InputError, RepresentationError, ShapeError, UndecidedError, displayed
from liehom.base.objects import Displayed, Immutable
from liehom.base.typing import ComplexArray, Expression, ScalarLike, VectorLike
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.algebra.linear.closure import Completion, lie_closure, square_matrices
from liehom.exact.algebra.linear.complex_matrices import as_real_matrices
from liehom.exact.representations import analysis, core
from liehom.exact.representations.core.coordinates import (
    Coordinates,
    Copies,
    complex_matrix,
    has_float,
    real_point,
    require_coordinates,
)
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.invariants.intertwiners import (
    InvariantForms,
    commutant,
    invariant_forms,
    invariant_vectors,
)
from liehom.exact.representations.invariants.irreducibility import is_irreducible, orbit_dimension, stabilizer
from liehom.exact.representations.invariants.representation_identity import (
    EntryMap,
    block_map,
    dual_map,
    exterior_power_map,
    failing_pair,
    hermitian_map,
    left_factor_map,
    right_factor_map,
    symmetric_power_map,
)
from liehom.exact.scalars.exact_field import ExactMatrix
from liehom.exact.scalars.field import Field, Matrix, MatrixLike
from liehom.exact.scalars.floating import RR, FloatField
from liehom.exact.scalars.subspaces import Subspace

if TYPE_CHECKING:
    from liehom.exact.representations.analysis.decomposition import Decomposition, HermitianForms
    from liehom.exact.representations.analysis.isotypic import CommutantType
    from liehom.exact.representations.analysis.polynomial_invariants import HilbertSeries
    from liehom.exact.representations.analysis.submodules import MaximalSubmodules
    from liehom.exact.representations.analysis.symbolic import SymbolicIsotropy


@final
class Representation(Displayed, Immutable):
    """A representation of a Lie algebra on K^N.

    Parameters
    ----------
    algebra : LieAlgebra
    matrices : sequence of (N, N) array_like
        rho(e_i), one per basis element. Complex matrices of size n act on K^(2n), see `complex_size`.
    size : int, optional
        N, needed only for an algebra of dimension 0.
    name : str, optional
    given : int, optional
        Number of basis elements that the user gave (default: all). Lie closure appended the others.
    appended : tuple of (int, int), optional
        The brackets (i, j) that Lie closure appended.
    dropped : tuple of int, optional
        Indices of given matrices that were left out, because they depend on earlier ones.
    coordinates : {'real', 'complex', 'hermitian'}, optional
        What the vectors of K^N are: nothing more (default), complex vectors (Re z_1, Im z_1, ...), or Hermitian
        matrices H by their entries H[i, i], Re H[i, j], Im H[i, j] for i < j, in lexicographic order of (i, j).
    check : bool, optional
        Prove rho([x, y]) = [rho(x), rho(y)] (default). Pass False only after a proof.

    Raises
    ------
    RepresentationError
        If the matrices do not respect the bracket; names i and j.

    Notes
    -----
    Two representations are equal (``==``), and hash equal, if their algebras and matrices are; names, `given`,
    `appended`, `dropped` and `coordinates` are not compared.

    Whatever floats do not decide, from `commutant` to `invariant_complement`, raises `UndecidedError` over float64.

    Examples
    --------
    >>> import liehom as lh
    >>> rho = lh.Representation.from_matrices([[[0, -1], [1, 0]]])
    >>> rho.algebra.dimension, rho.size, rho.isotropy([1, 0]).dimension
    (1, 2, 0)
    """

    __slots__ = ("algebra", "appended", "coordinates", "dropped", "given", "matrices", "name", "size")

    def __init__(
        self,
        algebra: LieAlgebra,
        matrices: Iterable[MatrixLike],
        *,
        size: int | None = None,
        name: str | None = None,
        given: int | None = None,
        appended: tuple[tuple[int, int], ...] = (),
        dropped: tuple[int, ...] = (),
        coordinates: Coordinates = "real",
        check: bool = True,
    ) -> None:
        if isinstance(matrices, Copies):  # a sequence of matrices that are computed when they are asked for
            basis, was_complex, size = cast("tuple[Matrix, ...]", matrices), False, matrices.size
        else:
            real, was_complex = as_real_matrices(matrices, algebra.field)
            basis = tuple(square_matrices(real, algebra.field))
            size = int(basis[0].nrows) if basis else size
        if len(basis) != algebra.dimension:
            raise ShapeError(f"{len(basis)} matrices for an algebra of dimension {algebra.dimension}")
        if not basis and size is None:
            raise ShapeError("a representation of the zero algebra needs its size")
        self.algebra: LieAlgebra = algebra
        self.matrices: tuple[Matrix, ...] = basis
        self.size: int = int(size or 0)
        self.name: str | None = name
        self.given: int = len(basis) if given is None else given
        self.appended: tuple[tuple[int, int], ...] = appended
        self.dropped: tuple[int, ...] = dropped
        self.coordinates: Coordinates = "complex" if was_complex else coordinates
        if check:
            require_coordinates(self.coordinates, basis, self.size)
            if failure := failing_pair(algebra, basis):
                i, j = failure
                raise RepresentationError(
                    failure, f"not a representation: rho([e{i}, e{j}]) differs from [rho(e{i}), rho(e{j})]"
                )

    @classmethod
    def from_matrices(
        cls,
        matrices: Iterable[MatrixLike],
        *,
        field: Field | None = None,
        independent: bool = True,
        hermitian: bool = False,
        name: str | None = None,
        completion: Completion = "auto",
    ) -> Representation:
        """The real Lie algebra generated by real or complex matrices, represented by these matrices.

        The first basis elements are the given matrices in order, without those that depend on earlier ones: `kept`
        lists the indices of these, `dropped` of the others. Missing brackets are appended in lexicographic order of
        (i, j), or reduced matrices where the brackets would give numbers of thousands of digits.

        Parameters
        ----------
        matrices : sequence of (N, N) array_like
            Complex if one entry is: a complex number of Python or numpy, a sympy expression with I, or a string with
            i or I ("1+2i", "-i*sqrt(2)"). Matrices of size n then act on R^(2n), see `complex_size`.
        field : Field, optional
            By default the smallest real field that contains the entries, or their real and imaginary parts (float64
            if one is a float; complex numbers of Python and numpy are floats).
        independent : bool
            Leave out matrices that depend on earlier ones (default). If False they raise `DependentRowsError`.
        hermitian : bool
            The matrices are Hermitian, as observables are in physics: each is multiplied by i.
        name : str, optional
        completion : {'auto', 'commutators', 'reduced'}
            Which matrices are appended; see `liehom.algebra.lie_closure`.

        Raises
        ------
        DependentRowsError
            If the matrices are linearly dependent over the reals and `independent` is False.

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.Representation.from_matrices([[[0, 1], [0, 0]], [[0, 0], [1, 0]]])
        >>> rho.given, rho.algebra.dimension, rho.appended
        (2, 3, ((0, 1),))
        >>> pauli = [[[0, 1], [1, 0]], [[0, "-i"], ["i", 0]], [[1, 0], [0, -1]]]
        >>> rho = lh.Representation.from_matrices(pauli, hermitian=True)
        >>> rho.algebra.dimension, rho.algebra.real_form(), rho.complex_size
        (3, 'so(3)', 2)
        """
        real, was_complex = as_real_matrices(matrices, field, hermitian=hermitian)
        basis = square_matrices(real, field)
        closure = lie_closure(basis, independent=independent, completion=completion)
        # The constants are those of the commutators themselves.
        return cls(
            closure.algebra,
            closure.matrices,
            size=basis[0].nrows,
            name=name,
            given=len(closure.kept),
            appended=closure.appended,
            dropped=tuple(sorted(set(range(len(basis))) - set(closure.kept))),
            coordinates="complex" if was_complex else "real",
            check=False,
        )

    @property
    def kept(self) -> tuple[int, ...]:
        """Indices of the given matrices that are the first `given` basis elements, a tuple of int.

        Dependent matrices are left out by `from_matrices`. A generator psi therefore has one coefficient per matrix in
        `kept`, or one per basis element.

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.Representation.from_matrices([[[0, 1], [0, 0]], [[0, 2], [0, 0]], [[0, 0], [1, 0]]])
        >>> rho.kept, rho.dropped, rho.given
        ((0, 2), (1,), 2)
        """
        return tuple(x for x in range(self.given + len(self.dropped)) if x not in self.dropped)

    # -- complex matrices --------------------------------------------------------------------------------
    @property
    def complex_size(self) -> int | None:
        """The size n of the complex matrices if the representation is on C^n = R^(2n), else None.

        A vector z has the real coordinates (Re z_1, Im z_1, ..., Re z_n, Im z_n), and a complex entry a + ib is the
        real block [[a, -b], [b, a]]. Complex are: representations by complex matrices, `liehom.defining` of su(p,q),
        u(p,q), gl(n,C), sl(n,C), so(n,C), sp(2n,C), and of these `over`, `restriction` and direct sums. Other
        constructions are over the reals and do not carry the complex structure further: the dual of the real space
        has two, with the complex matrices -A^T and the conjugates of these.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.defining("su(3)").complex_size, lh.defining("so(3)").complex_size
        (3, None)
        """
        return self.size // 2 if self.coordinates == "complex" else None

    def complex_structure(self) -> Matrix:
        """The matrix J (2n, 2n) of the multiplication by i, which commutes with all rho(x).

        Examples
        --------
        >>> import liehom as lh
        >>> print(lh.defining("u(1)").complex_structure())
        [0, -1]
        [1, 0]
        """
        from liehom.exact.algebra.linear.linear_bases import complex_structure

        return self.field.matrix(complex_structure(self._complex_size()))

    def complex_matrix(self, x: VectorLike) -> ComplexArray | Expression:
        """The complex matrix (n, n) of an element x, given by its dim g coefficients.

        It is a sympy.Matrix, or an array of complex128 for a representation over floats.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.defining("u(1)").complex_matrix(["1/2"])
        Matrix([[I/2]])
        """
        self._complex_size()
        return complex_matrix(self(x))

    def complex_matrices(self) -> list[ComplexArray | Expression]:
        """The complex matrices (n, n) of the basis elements, as `complex_matrix` returns them.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.Representation.from_matrices([[[0, 1j], [1j, 0]]]).complex_matrices()
        [array([[0.+0.j, 0.+1.j],
               [0.+1.j, 0.+0.j]])]
        """
        self._complex_size()
        return [complex_matrix(a) for a in self.matrices]

    def _complex_size(self) -> int:
        n = self.complex_size
        if n is None:
            raise InputError(f"{displayed(self)} is not on C^n: build it from complex matrices, or with hermitian=True")
        return n

    def real_point(self, point: VectorLike | MatrixLike) -> list[ScalarLike]:
        """The N real coordinates of a point, given by them, on C^n also by n complex numbers, or by a Hermitian matrix.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.defining("su(2)").real_point([1, "i/2"])
        [1, 0, 0, 1/2]
        """
        return real_point(self.coordinates, self.size, self.field, point)

    # -- elements and points -----------------------------------------------------------------------------
    @property
    def field(self) -> Field:
        """The field of the matrices."""
        return self.algebra.field

    def __iter__(self) -> Iterator[Matrix]:
        """The matrices rho(e_i), so that a representation can be passed as a sequence of matrices."""
        return iter(self.matrices)

    def __call__(self, x: VectorLike) -> Matrix:
        """The matrix rho(x) of an element x, given by its dim g coefficients."""
        row = self.algebra.row(x)
        total: Matrix = self.field.zeros(self.size, self.size)
        for i, a in enumerate(self.matrices):
            if (value := row[0, i]) != 0:
                total = total + a.scale(value)
        return total

    def element(self, matrix: MatrixLike, *, hermitian: bool = False) -> npt.NDArray[Any]:
        """The element x of g with rho(x) = matrix, as a numpy array of its dim g coefficients.

        Parameters
        ----------
        matrix : (N, N) array_like
            On C^n also a complex matrix (n, n).
        hermitian : bool
            Multiply the matrix by i, after a check that it is Hermitian.

        Raises
        ------
        NotInSpanError
            If the matrix is not in rho(g); `residual` is its relative distance from rho(g).

        Examples
        --------
        >>> import liehom as lh
        >>> lh.defining("su(2)").element([["i/2", 0], [0, "-i/2"]])
        array([0, 0, 1/2], dtype=object)
        >>> lh.defining("so(3)").element([[0, 0, 0], [0, 0, 2], [0, -2, 0]])
        array([0, 0, -2], dtype=object)
        """
        return self.algebra._vector(core.elements.coordinates_of(self, matrix, hermitian=hermitian).row(0))

    def subalgebra(self, matrices: Iterable[MatrixLike], *, hermitian: bool = False) -> Subalgebra:
        """The subalgebra of g whose elements have these matrices as a basis.

        Parameters
        ----------
        matrices : sequence of (N, N) array_like
            In rho(g), see `element`.
        hermitian : bool
            Multiply the matrices by i, after a check that they are Hermitian.

        Raises
        ------
        NotInSpanError
            If a matrix is not in rho(g); `index` is its index.
        DependentRowsError, NotASubalgebraError
            If the matrices are dependent, or their span is not closed.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.defining("su(2)").subalgebra([[["i", 0], [0, "-i"]]]).rows()
        [[0, 0, 1]]
        """
        return self.algebra.subalgebra(core.elements.rows_of_matrices(self, matrices, hermitian=hermitian))

    def isotropy(self, point: VectorLike | MatrixLike) -> Subalgebra:
        """The isotropy subalgebra {x : rho(x) point = 0}.

        If an entry of the point is a float, the answer is numerical: a subalgebra of ``algebra.over(RR)``.

        Parameters
        ----------
        point : array_like of shape (N,)
            Entries in the representation's field, or floats. Complex vectors and Hermitian matrices where `real_point`
            takes them.

        Raises
        ------
        UndecidedError
            If floats do not decide the dimension: a singular value is within a factor 100 of the error.

        Notes
        -----
        The isotropy is the null space of the (N, dim g) matrix with columns rho(e_i) point.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.defining(lh.so(4)).isotropy([0, 0, 0, 1]).dimension
        3
        >>> lh.defining(lh.so(3)).isotropy([0.6, 0, 0.8])
        <subalgebra of dimension 1 in so(3) over float64>
        """
        rho, values = self._at(point)
        return stabilizer(rho.algebra, rho.matrices, rho.size, values)

    def symbolic_isotropy(self, point: VectorLike | MatrixLike) -> SymbolicIsotropy:
        """The isotropy subalgebra at a point with free symbols, for generic values of the symbols.

        Parameters
        ----------
        point : sequence of sympy expressions or strings, shape (N,)
            Rational functions of free symbols, such as ``"x**2/2"``; their coefficients may be algebraic numbers.
            On C^n the symbols are real, and n coordinates may be complex, such as ``"x + i*y"``.

        Raises
        ------
        FieldError
            If a coefficient of the point is a float.

        Notes
        -----
        The rank of the matrix M with columns rho(e_i) point over the field of fractions is the largest rank at any
        value of the symbols. With pivot columns P and independent rows R the null space has denominators that divide
        det M[R, P] (Cramer's rule), so the answer is right wherever this minor does not vanish.

        Examples
        --------
        >>> import liehom as lh, sympy
        >>> x, y, z = sympy.symbols("x y z")
        >>> generic = lh.defining(lh.so(3)).symbolic_isotropy([x, y, z])
        >>> generic.dimension, generic.basis
        (1, Matrix([[z, -y, x]]))
        >>> lh.defining(lh.so(3)).symbolic_isotropy(["x", 0, 0]).nonvanishing
        x
        """
        return analysis.symbolic.symbolic_isotropy(self, point)

    def orbit_dimension(self, point: VectorLike | MatrixLike) -> int:
        """Dimension of the orbit through a point: dim g minus the dimension of the isotropy subalgebra.

        At a point with floats the dimension is a numerical rank.
        """
        rho, values = self._at(point)
        return orbit_dimension(rho.algebra, rho.matrices, rho.size, values)

    def pair(self, point: VectorLike | MatrixLike) -> Pair:
        """The pair (g, g_point): the homogeneous space of the orbit through a point.

        At a point with floats the pair is numerical: a pair over float64.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.defining(lh.so(4)).pair([0, 0, 0, 1]), lh.defining(lh.so(4)).pair([0.6, 0, 0, 0.8])
        (<pair of dimensions 6/3 over QQ>, <pair of dimensions 6/3 over float64>)
        """
        isotropy = self.isotropy(point)
        return Pair(isotropy.algebra, isotropy)

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
        """The direct sum with another representation of the same algebra, by block matrices with this one first."""
        self._require_same_algebra(other)
        total = self.size + other.size
        return self._joined(
            other,
            block_map(self.size, total, 0),
            block_map(other.size, total, self.size),
            "complex" if self.coordinates == other.coordinates == "complex" else "real",
        )

    def tensor(self, other: Representation) -> Representation:
        """The tensor product rho(x) (x) 1 + 1 (x) sigma(x), basis e_i (x) f_j in lexicographic order of (i, j).

        Examples
        --------
        >>> import liehom as lh
        >>> lh.defining(lh.so(3)).tensor(lh.representations.trivial(lh.so(3), 2)).size
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

    def on_hermitian_matrices(self) -> Representation:
        """The action H -> A H + H A^* on Hermitian matrices (n, n), for a representation by complex matrices A.

        For skew-Hermitian A it is the conjugation [A, H], the action on density matrices and observables.

        Returns
        -------
        Representation
            On K^(n^2). The coordinates are H[i, i], and Re H[i, j], Im H[i, j] for i < j, in lexicographic order of
            (i, j). `isotropy` and the other methods for points also take the matrix H.

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.defining("su(3)").on_hermitian_matrices()
        >>> rho.isotropy([["1/2", 0, 0], [0, "1/2", 0], [0, 0, 0]]).dimension
        4
        """
        # H -> A H + H A^* is the restriction of A (x) 1 + 1 (x) conj(A) to Hermitian matrices
        return self._induced(hermitian_map(self._complex_size()), "hermitian")

    def restriction(self, subalgebra: Subalgebra) -> Representation:
        """The restriction to a subalgebra, as a representation of ``subalgebra.as_algebra()``."""
        if subalgebra.algebra is not self.algebra and subalgebra.algebra != self.algebra:
            raise InputError("the subalgebra belongs to another Lie algebra")
        n = self.size
        flat = self.field.stack_rows([a.reshape(1, n * n) for a in self.matrices], n * n)
        images = (subalgebra.basis @ flat).split_rows(n, n) if self.matrices else []
        # a homomorphism restricted to a subalgebra
        return self._proved(subalgebra.as_algebra(), images, n, coordinates=self.coordinates)

    def over(self, field: Field) -> Representation:
        """The representation over another field that contains the entries of its matrices.

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.defining(lh.so(3)).over(lh.number_field("sqrt(2)"))
        >>> rho.isotropy(["sqrt(2)", 1, 0]).rows()
        [[0, -1/2*sqrt(2), 1]]
        """
        algebra, matrices = self.algebra.over(field), [self._read_in(field, a) for a in self.matrices]
        return self._proved(algebra, matrices, self.size, self.name, self.coordinates)  # the same identities

    # -- commuting matrices, invariant forms and vectors -----------------------------------------------------
    def commutant(self) -> list[ExactMatrix]:
        """A basis of the matrices that commute with all rho(x), proved exactly.

        Examples
        --------
        >>> import liehom as lh
        >>> len(lh.defining(lh.su(2)).commutant())
        4
        """
        return commutant(self._generating(), self.size, self.field)

    def commutant_type(self) -> CommutantType:
        """'R', 'C' or 'H': the algebra of real matrices that commute with an irreducible representation.

        By Schur's lemma and Frobenius' theorem the commutant over R is a division algebra, of dimension 1, 2 or 4.

        Examples
        --------
        >>> import liehom as lh
        >>> [lh.defining(g).commutant_type() for g in (lh.so(3), lh.su(3), lh.su(2))]
        ['R', 'C', 'H']
        """
        return analysis.isotypic.commutant_type(*self._action(), semisimple=self._is_visibly_semisimple())

    def invariant_forms(self) -> InvariantForms:
        """Bases of the symmetric and of the skew-symmetric forms P with rho(x)^T P + P rho(x) = 0 for all x.

        Examples
        --------
        >>> import liehom as lh
        >>> forms = lh.defining(lh.so(3, 1)).invariant_forms()
        >>> len(forms.symmetric), len(forms.skew), forms.symmetric[0].signature()
        (1, 0, (3, 1, 0))
        """
        return invariant_forms(self._generating(), self.size, self.field)

    def hermitian_forms(self, structure: MatrixLike | None = None) -> HermitianForms:
        """The invariant Hermitian forms for a complex structure, or for the commutant of an irreducible representation.

        Parameters
        ----------
        structure : (N, N) array_like, optional
            J with J^2 = -d for a number d > 0, commuting with all rho(x). By default the representation must be
            irreducible of type C (J is in its commutant) or H (three units of its commutant give quaternionic forms).

        Examples
        --------
        >>> import liehom as lh
        >>> forms = lh.defining(lh.sp(2)).hermitian_forms()
        >>> forms.kind, len(forms.hermitian), len(forms.skew_hermitian)
        ('quaternionic', 1, 0)
        >>> forms = lh.defining("so*(6)").hermitian_forms()
        >>> forms.kind, len(forms.skew_hermitian)
        ('quaternionic', 1)
        """
        return analysis.decomposition.hermitian_forms(self._exact(), structure)

    def invariant_vectors(self) -> Subspace:
        """The subspace of vectors v with rho(x) v = 0 for all x.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.adjoint(lh.gl(2)).invariant_vectors().dimension
        1
        """
        return invariant_vectors(self._generating(), self.size, self.field)

    def invariants(self, degree: int) -> list[Expression]:
        """A basis of the homogeneous invariant polynomials of a degree, sympy expressions in x0, x1, ...

        Raises
        ------
        LimitError
            If the monomials of this degree need too much memory.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.defining(lh.so(2, 1)).invariants(2)
        [x0**2 + x1**2 - x2**2]
        >>> len(lh.adjoint(lh.sl(3)).invariants(6))
        2
        """
        return analysis.polynomial_invariants.invariants(self._exact(), degree)

    def hilbert_series(self) -> HilbertSeries:
        """The Hilbert series (Molien series) of the ring of invariant polynomials, as a rational function.

        Raises
        ------
        InputError, NotCompletelyReducibleError
            If the algebra is not reductive, the charges of its centre are not rational, or the weights are too many.

        Notes
        -----
        The coefficients are those of Weyl's integral formula. As many are computed as determine the rational function:
        its poles are roots of unity of orders that the weights bound, their orders as poles are bounded by the
        dimension of an orbit, and its degree is at most 0 (Kempf, Michigan Math. J. 26 (1979), 19-32).

        Examples
        --------
        >>> import liehom as lh
        >>> cubics = lh.highest_weight_module("A1", [3]).representation
        >>> cubics.hilbert_series(), lh.defining(lh.so(5)).hilbert_series().degrees
        (1/(1 - t^4), (2,))
        """
        return analysis.polynomial_invariants.hilbert_series(self._exact())

    # -- irreducible parts -------------------------------------------------------------------------------
    def is_irreducible(self) -> bool:
        """Whether no subspace of R^N except 0 and R^N is invariant, decided exactly over the reals.

        Irreducible over QQ is weaker: a representation with commutant QQ(sqrt(2)) is reducible over the reals. The
        zero space is not irreducible.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.Representation.from_matrices([[[0, -1], [1, 0]]]).is_irreducible()
        True
        >>> lh.Representation.from_matrices([[[0, 2], [1, 0]]]).is_irreducible()
        False
        """
        return is_irreducible(*self._action(), semisimple=self._is_visibly_semisimple())

    def is_completely_reducible(self) -> bool:
        """Whether every invariant subspace has an invariant complement.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.defining(lh.gl(3)).is_completely_reducible(), lh.adjoint(lh.heisenberg(1)).is_completely_reducible()
        (True, False)
        >>> lh.adjoint(lh.so(4)).is_completely_reducible(), lh.adjoint(lh.euclidean(2)).is_completely_reducible()
        (True, False)
        """
        return analysis.submodules.is_completely_reducible(self._exact())

    def socle(self) -> Subspace:
        """The largest completely reducible subspace, the sum of all irreducible ones over the field or the reals.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.adjoint(lh.heisenberg(1)).socle().rows()
        [[0, 0, 1]]
        >>> lh.Representation.from_matrices([[[1, 1], [0, 1]]]).socle().rows()
        [[1, 0]]
        """
        return analysis.submodules.socle(self._exact())

    def maximal_submodules(self) -> MaximalSubmodules:
        """The maximal proper invariant subspaces over the reals, finitely many or in families.

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.adjoint(lh.euclidean(3))
        >>> [space.dimension for space in rho.maximal_submodules().isolated]
        [3]
        """
        return analysis.submodules.maximal_submodules(self._exact())

    def decomposition(self) -> Decomposition:
        """The decomposition into irreducible representations over the reals, exact.

        Each component has its subspace, representation, type and field: QQ, or the real number field that its
        splitting needs.

        Raises
        ------
        NotCompletelyReducibleError
            If the representation is not completely reducible; ``rho.subrepresentation(rho.socle())`` is.

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.defining(lh.so(3, 1))
        >>> [(c.dimension, c.type) for c in rho.tensor(rho).decomposition()]
        [(1, 'R'), (6, 'C'), (9, 'R')]
        >>> lh.adjoint(lh.so(4)).decomposition().dimensions()
        [3, 3]
        """
        return analysis.decomposition.decomposition(self._exact())

    # -- weights -----------------------------------------------------------------------------------------
    def weights(self) -> dict[Any, int]:
        """The weights of a representation of a reductive algebra, in any basis, with their multiplicities.

        {weight: multiplicity}. For a semisimple algebra a weight is a tuple of int, in fundamental coordinates in
        Bourbaki's numbering of ``algebra.semisimple_type()``. If the algebra has a centre, it is a `ChargedWeight`: the
        weight of the derived algebra in this form, and the charges, exact complex numbers, one for each row of
        ``algebra.center()``. These are the weights of the complexification, so that charges that are not real occur in
        conjugate pairs.

        Raises
        ------
        InputError, NotCompletelyReducibleError
            If the algebra is not reductive, or an element of its centre does not act semisimply.

        Notes
        -----
        Where the Dynkin diagram has symmetries (A_n, D_n, E6, equal components) the weights refer to one choice of
        simple roots up to such a symmetry: V and its dual may be exchanged.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.defining(lh.so(3)).weights()
        {(2,): 1, (0,): 1, (-2,): 1}
        >>> for (weight, charges), multiplicity in lh.defining(lh.u(2)).weights().items():
        ...     print(weight, charges, multiplicity)
        (1,) (i,) 1
        (-1,) (i,) 1
        (1,) (-i,) 1
        (-1,) (-i,) 1
        """
        return analysis.weight_multiplicities.weight_multiplicities(self._exact())

    def highest_weights(self) -> dict[Any, int]:
        """The highest weights of the irreducible parts of the complexification, with their multiplicities.

        {highest weight: multiplicity}, in the form and numbering of `weights`.

        Raises
        ------
        InputError, NotCompletelyReducibleError
            If the algebra is not reductive, or an element of its centre does not act semisimply.

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.defining(lh.so(3))
        >>> rho.tensor(rho).highest_weights(), lh.defining(lh.so(3, 1)).highest_weights()
        ({(4,): 1, (2,): 1, (0,): 1}, {(1, 1): 1})
        >>> su3 = lh.defining(lh.su(3))
        >>> su3.highest_weights(), lh.adjoint(su3.algebra).highest_weights()
        ({(1, 0): 1, (0, 1): 1}, {(1, 1): 1})
        >>> lh.defining(lh.gl(3)).highest_weights()
        {ChargedWeight(weight=(1, 0), charges=(1,)): 1}
        """
        return analysis.weight_multiplicities.highest_weights(self._exact())

    def intertwiners(self, other: Representation) -> list[ExactMatrix]:
        """A basis of the maps T, shape (M, N), with T rho(x) = sigma(x) T for all x.

        sigma, on K^M, is a representation of the same algebra over the same field.

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.defining(lh.so(3))
        >>> len(rho.intertwiners(lh.adjoint(lh.so(3)))), len(rho.tensor(rho).intertwiners(lh.adjoint(lh.so(3))))
        (1, 1)
        """
        return analysis.decomposition.intertwining_maps(self, other)

    def equivalence(self, other: Representation) -> ExactMatrix | None:
        """An invertible T with T rho(x) = sigma(x) T for all x, or None: the representations are not equivalent.

        Both answers are proved.

        Raises
        ------
        UndecidedError
            For some representations that are not completely reducible, if neither an invertible map nor a proof that
            there is none was found.

        Examples
        --------
        >>> import liehom as lh
        >>> T = lh.defining(lh.so(3)).equivalence(lh.adjoint(lh.so(3)))
        >>> T.rank()
        3
        >>> rho = lh.defining(lh.sl(2))
        >>> rho.equivalence(rho.dual()) is None, rho.equivalence(lh.representations.trivial(lh.sl(2), 2)) is None
        (False, True)
        """
        return analysis.decomposition.equivalence(self, other)

    def is_equivalent(self, other: Representation) -> bool:
        """Whether two representations are equivalent, over their field or over the reals: both are the same.

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.defining(lh.sl(3))
        >>> rho.is_equivalent(rho.dual()), rho.tensor(rho).is_equivalent(rho.symmetric_power(2).direct_sum(rho.dual()))
        (False, True)
        """
        return self.equivalence(other) is not None

    # -- invariant subspaces -----------------------------------------------------------------------------
    def submodule(self, rows: Subspace | MatrixLike) -> Subspace:
        """The smallest invariant subspace that contains the rows.

        Examples
        --------
        >>> import liehom as lh
        >>> lh.adjoint(lh.so(4)).submodule([[1, 0, 0, 0, 0, 1]]).dimension
        3
        """
        return analysis.submodules.generated_submodule(self._exact(), rows)

    def subrepresentation(self, subspace: Subspace | MatrixLike) -> Representation:
        """The restriction to an invariant subspace, in the basis of the subspace or of independent rows (k, N).

        Raises
        ------
        NotInvariantError
            If the subspace is not invariant; names the row and the basis element that moves it out of the subspace.
        DependentRowsError
            If the rows are dependent.

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.adjoint(lh.euclidean(2))
        >>> rho.subrepresentation(rho.socle()).size
        2
        >>> lh.adjoint(lh.gl(2)).subrepresentation([[1, 0, 0, 1]]).matrices[0].is_zero()
        True
        """
        return analysis.submodules.subrepresentation(self._exact(), subspace)

    def quotient(self, subspace: Subspace | MatrixLike) -> Representation:
        """The representation on the quotient by an invariant subspace, in the basis of `scalars.spaces.quotient`.

        Examples
        --------
        >>> import liehom as lh
        >>> rho = lh.adjoint(lh.euclidean(2))
        >>> rho.quotient(rho.socle()).matrices[0].is_zero()
        True
        >>> lh.adjoint(lh.heisenberg(1)).quotient([[0, 0, 1]]).size
        2
        """
        return analysis.submodules.quotient_representation(self._exact(), subspace)

    def invariant_complement(self, subspace: Subspace | MatrixLike) -> Subspace:
        """An invariant complement of an invariant subspace: the kernel of a projection that commutes with all rho(x).

        Raises
        ------
        NotCompletelyReducibleError
            If no invariant complement exists (proved).

        Examples
        --------
        >>> import liehom as lh
        >>> lh.adjoint(lh.gl(2)).invariant_complement([[1, 0, 0, 1]]).rows()
        [[1, 0, 0, -1], [0, 1, 0, 0], [0, 0, 1, 0]]
        """
        return analysis.submodules.invariant_complement(self._exact(), subspace)

    # -- private helpers -------------------------------------------------------------------
    def _read_in(self, field: Field, matrix: Matrix) -> Matrix:
        if isinstance(field, FloatField):
            return field.from_entries(matrix.to_numpy().ravel().tolist(), self.size, self.size)
        return field.matrix(matrix.to_rows(), (self.size, self.size))

    def _at(self, point: VectorLike | MatrixLike) -> tuple[Representation, list[ScalarLike]]:
        """The representation, over float64 if the point has a float, and the real coordinates of the point."""
        values = self.real_point(point)
        return (self.over(RR) if self.field.exact and has_float(values) else self), values

    def _exact(self) -> Representation:
        """The representation itself; `UndecidedError` over float64."""
        if not self.field.exact:
            raise UndecidedError(
                "floats do not decide this: build the representation over QQ or a number field, or go to exact numbers "
                "by lh.rationalize(rho, max_denominator=...)"
            )
        return self

    def _generating(self) -> tuple[ExactMatrix, ...]:
        """A few matrices with the commutant and invariant subspaces of all rho(x); `UndecidedError` over float64."""
        return core.elements.generating_matrices(self._exact())

    def _action(self) -> tuple[tuple[ExactMatrix, ...], int, Field, tuple[ExactMatrix, ...]]:
        """The matrices rho(e_i), their size and field, and matrices that generate them; exact only."""
        return cast("tuple[ExactMatrix, ...]", self._exact().matrices), self.size, self.field, self._generating()

    def _is_visibly_semisimple(self) -> bool:
        """Whether the algebra is semisimple, where its Killing form costs less than the trace form of the matrices."""
        return 0 < self._exact().algebra.dimension <= self.size and analysis.submodules.is_visibly_semisimple(self)

    def _induced(self, entry_map: EntryMap, coordinates: Coordinates = "real") -> Representation:
        images = [entry_map(a) for a in self.matrices]
        return self._proved(self.algebra, images, entry_map.target, coordinates=coordinates)

    def _joined(
        self, other: Representation, left: EntryMap, right: EntryMap, coordinates: Coordinates = "real"
    ) -> Representation:
        pairs = zip(self.matrices, other.matrices, strict=True)
        # The two summands commute, and each is a representation.
        return self._proved(self.algebra, [left(a) + right(b) for a, b in pairs], left.target, coordinates=coordinates)

    def _proved(
        self,
        algebra: LieAlgebra,
        matrices: Sequence[Matrix],
        size: int,
        name: str | None = None,
        coordinates: Coordinates = "real",
    ) -> Representation:
        """A representation whose identity the caller has proved; a comment there gives the reason."""
        return Representation(algebra, matrices, size=size, name=name, coordinates=coordinates, check=False)

    def _require_same_algebra(self, other: Representation) -> None:
        if not isinstance(other, Representation):
            raise InputError(
                f"expected a Representation of the same algebra, such as lh.adjoint(g); got {displayed(other)}"
            )
        if other.algebra is not self.algebra and other.algebra != self.algebra:
            raise InputError(
                f"representations of two algebras, {displayed(self.algebra)} and {displayed(other.algebra)}"
            )

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Representation):
            return NotImplemented
        return self.algebra == other.algebra and self.matrices == other.matrices and self.size == other.size

    def __hash__(self) -> int:
        return hash((self.algebra, self.size, self.matrices))

    def __repr__(self) -> str:
        title = f"{displayed(self.name)} " if self.name else ""
        space = f"{self.field.name}^{self.size}"
        if self.coordinates != "real":
            n = self.complex_size or isqrt(self.size)
            space += f" = C^{n}" if self.coordinates == "complex" else f", the Hermitian {n} x {n} matrices"
        left_out = f"; dependent matrices left out: {', '.join(map(str, self.dropped))}" if self.dropped else ""
        return f"<representation {title}of {displayed(self.algebra)} on {space}{left_out}>"
